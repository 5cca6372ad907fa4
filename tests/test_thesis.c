#include "core/thesis.h"

#include "alloc_count.h"
#include "core/series.h"
#include "core/units.h"
#include "rough.h"

static const dif_thesis_box BOX = {-6.0, 6.0, -5.0, 5.0};

/* What the program stands for: the endlessly tiled patch under a Gaussian about its first sample, phase + k h. */
static void tiled_sum(const dif_field *field, double sigma_um, dif_vec3 kappa, double k, double amp[2])
{
    const double reach_um = 8.0 * sigma_um;
    const int nx = (int)ceil(reach_um / field->pitch_x_um), ny = (int)ceil(reach_um / field->pitch_y_um);
    double total = 0.0, re = 0.0, im = 0.0;
    for (int iy = -ny; iy <= ny; iy++)
        for (int ix = -nx; ix <= nx; ix++) {
            const double x = ix * field->pitch_x_um, y = -iy * field->pitch_y_um;
            const double w = exp(-0.5 * (x * x + y * y) / (sigma_um * sigma_um));
            const int jx = ((ix % field->nx) + field->nx) % field->nx, jy = ((iy % field->ny) + field->ny) % field->ny;
            const double phase = kappa.x * x + kappa.y * y + k * field->z_um[jy * field->nx + jx];
            re += w * cos(phase);
            im += w * sin(phase);
            total += w;
        }
    amp[0] = re / total;
    amp[1] = im / total;
}

static void test_amplitudes__are_those_of_the_endlessly_tiled_patch(void **state)
{
    (void)state;
    dif_field field = test_rough_field(12, 9, 0.1, 0.12, 0.3, 3);
    uint64_t random = 8;
    for (int c = 0; c < 2; c++) {
        const double sigma_um = c ? 0.9 : 0.4; /* several bins a sample, and at most one */
        dif_thesis *thesis;
        assert_int_equal(dif_thesis_create(&field, sigma_um, &BOX, 40, false, &thesis, NULL), DIF_OK);
        for (int i = 0; i < 60; i++) {
            const dif_vec3 kappa = {test_random(&random, -6.0, 6.0), test_random(&random, -5.0, 5.0), 0.0};
            const double k = test_random(&random, 8.0, 16.0);
            double got[2], want[2];
            dif_thesis_amplitudes(thesis, 1, &kappa, &k, (double(*)[2])got);
            tiled_sum(&field, sigma_um, kappa, k, want);
            /* bins beyond four sigma are left out: exp(-8) of each of a few dozen of size 0.1 */
            assert_near(hypot(got[0] - want[0], got[1] - want[1]), 0.0, 0.0, 4e-4);
        }
        dif_thesis_free(thesis);
    }
    dif_field_free(&field);
}

static void test_amplitudes__few_bins_across_equal_many(void **state)
{
    (void)state;
    dif_field field = test_rough_field(40, 37, 0.1, 0.1, 0.3, 5);
    const dif_thesis_box lines[2] = {{-6.0, 6.0, 0.0, 0.0}, {0.0, 0.0, -6.0, 6.0}};
    const dif_thesis_box all = {-6.0, 6.0, -6.0, 6.0};
    dif_thesis *full;
    assert_int_equal(dif_thesis_create(&field, 1.5, &all, 40, false, &full, NULL), DIF_OK);
    for (int c = 0; c < 2; c++) { /* along x, along y: direct sums across, DFTs along */
        dif_thesis *line;
        assert_int_equal(dif_thesis_create(&field, 1.5, lines + c, 40, false, &line, NULL), DIF_OK);
        for (double at = -6.0; at <= 6.0; at += 0.13) {
            const dif_vec3 kappa = {c ? 0.0 : at, c ? at : 0.0, 0.0};
            const double k = 14.0;
            double a[2], b[2];
            dif_thesis_amplitudes(full, 1, &kappa, &k, (double(*)[2])a);
            dif_thesis_amplitudes(line, 1, &kappa, &k, (double(*)[2])b);
            assert_near(a[0], b[0], 0.0, 1e-12);
            assert_near(a[1], b[1], 0.0, 1e-12);
        }
        dif_thesis_free(line);
    }
    dif_thesis_free(full);
    dif_field_free(&field);
}

/* Largest difference between float and double sums over a few points, for heights up to height_um. */
static double float_error(double height_um)
{
    dif_field field = test_rough_field(32, 32, 0.1, 0.1, height_um, 11);
    dif_thesis *exact, *shader;
    double worst = 0.0;
    const int n_term = dif_series_taylor_order(17.0 * (height_um + 0.1), 1e-9) + 1;
    assert_int_equal(dif_thesis_create(&field, 1.0, &BOX, n_term, false, &exact, NULL), DIF_OK);
    assert_int_equal(dif_thesis_create(&field, 1.0, &BOX, n_term, true, &shader, NULL), DIF_OK);
    for (double at = -5.0; at <= 5.0; at += 0.21) {
        const dif_vec3 kappa = {at, 0.5 * at, 0.0};
        const double k = 16.5;
        double a[2], b[2];
        dif_thesis_amplitudes(exact, 1, &kappa, &k, (double(*)[2])a);
        dif_thesis_amplitudes(shader, 1, &kappa, &k, (double(*)[2])b);
        worst = fmax(worst, hypot(a[0] - b[0], a[1] - b[1]));
    }
    dif_thesis_free(exact);
    dif_thesis_free(shader);
    dif_field_free(&field);
    return worst;
}

static void test_amplitudes__float_is_lost_on_deep_surfaces(void **state)
{
    (void)state;
    const double shallow = float_error(0.2), deep = float_error(1.3);
    print_message("series in float: error %.2g on heights of 0.3 um, %.2g on 1.4 um\n", shallow, deep);
    /* terms reach e^{k h}: e^5 costs two digits of float's seven, e^23 all of them */
    assert_at_most(shallow, 1e-4);
    assert_true(deep > 1.0);
}

static void test_create__bad_arguments_have_their_codes(void **state)
{
    (void)state;
    dif_field field = test_rough_field(8, 8, 0.1, 0.1, 0.2, 1);
    dif_thesis *thesis;
    dif_error err;
    const dif_thesis_box empty = {1.0, -1.0, 0.0, 0.0}, huge = {-1e9, 1e9, 0.0, 0.0};
    assert_int_equal(dif_thesis_create(&field, 0.0, &BOX, 40, false, &thesis, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "sigma = 0 um, want > 0");
    assert_null(thesis);
    assert_int_equal(dif_thesis_create(&field, 1.0, &BOX, 0, false, &thesis, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "0 terms, want 1 ... 200");
    assert_int_equal(dif_thesis_create(&field, 1.0, &BOX, 201, false, &thesis, &err), DIF_ERR_ARG);
    assert_int_equal(dif_thesis_create(&field, 1.0, &empty, 40, false, &thesis, &err), DIF_ERR_ARG);
    assert_int_equal(dif_thesis_create(&field, 1.0, &huge, 40, false, &thesis, &err), DIF_ERR_SIZE);
    assert_null(thesis);
    dif_thesis_free(NULL);
    dif_field_free(&field);
}

static void test_create__every_failing_allocation_is_reported(void **state)
{
    (void)state;
    dif_field field = test_rough_field(24, 24, 0.1, 0.1, 0.2, 1);
    const dif_thesis_box line = {-6.0, 6.0, 0.0, 0.0};
    const int live = test_alloc_live();
    for (int form = 0; form < 2; form++) {
        int n_failed = 0;
        for (dif_status status = DIF_ERR_NOMEM; status != DIF_OK; n_failed++) {
            dif_thesis *thesis;
            test_alloc_fail_from(n_failed + 1);
            status = dif_thesis_create(&field, 1.0, form ? &line : &BOX, 8, false, &thesis, NULL);
            test_alloc_fail_from(0);
            assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
            dif_thesis_free(thesis);
            assert_int_equal(test_alloc_live(), live);
        }
        assert_true(n_failed > 5);
    }
    dif_field_free(&field);
}

static void test_amplitudes__allocate_nothing(void **state)
{
    (void)state;
    dif_field field = test_rough_field(24, 24, 0.1, 0.1, 0.2, 1);
    dif_thesis *thesis;
    const dif_vec3 kappa = {1.0, 2.0, 0.0};
    const double k = 12.0;
    double amp[2];
    assert_int_equal(dif_thesis_create(&field, 1.0, &BOX, 8, false, &thesis, NULL), DIF_OK);
    test_alloc_fail_from(0);
    dif_thesis_amplitudes(thesis, 1, &kappa, &k, (double(*)[2])amp);
    assert_int_equal(test_alloc_calls(), 0);
    dif_thesis_free(thesis);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_amplitudes__are_those_of_the_endlessly_tiled_patch),
        cmocka_unit_test(test_amplitudes__few_bins_across_equal_many),
        cmocka_unit_test(test_amplitudes__float_is_lost_on_deep_surfaces),
        cmocka_unit_test(test_create__bad_arguments_have_their_codes),
        cmocka_unit_test(test_create__every_failing_allocation_is_reported),
        cmocka_unit_test(test_amplitudes__allocate_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
