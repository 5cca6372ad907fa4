/* Tables written and read back, tables as EXR. */
/* mkdtemp */
#define _POSIX_C_SOURCE 200809L

#include "tests/near.h"

#include <float.h>
#include <string.h>
#include <unistd.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "core/io/table_io.h"
#include "core/units.h"
#include "tests/alloc_count.h"

enum { TIDY, MATRIX, EXR, N_LAYOUT };
static const char *const NAMES[N_LAYOUT] = {"t.csv", "m.csv", "t.exr"};
static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/dif-table-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

/* Fails if a test left anything behind. */
static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

/* A table whose axes come from degrees and nanometres, with values of all sizes and a gap. */
static dif_table make_table(int n_angle, int n_lambda, bool fixed_is_wo, double azimuth_deg)
{
    dif_plan plan;
    dif_table table;
    dif_error err;
    uint64_t seed = 17;
    assert_int_equal(dif_plan_create(n_angle, n_lambda, &plan, &err), DIF_OK);
    plan.fixed_is_wo = fixed_is_wo;
    plan.fixed_rad = dif_rad_from_deg(75.0);
    plan.azimuth_rad = dif_rad_from_deg(azimuth_deg);
    for (int i = 0; i < n_angle; i++)
        plan.angle_rad[i] = dif_rad_from_deg(-55.0 + 0.01 * i);
    for (int i = 0; i < n_lambda; i++)
        plan.lambda_um[i] = dif_um_from_nm(380.0 + 0.7 * i);
    assert_int_equal(dif_table_create(&plan, DIF_QUANTITY_BRDF, &table, &err), DIF_OK);
    for (int i = 0; i < n_angle * n_lambda; i++)
        table.value[i] = pow(10.0, test_random(&seed, -12.0, 3.0));
    if (n_angle * n_lambda > 4)
        table.value[4] = NAN;
    dif_plan_free(&plan);
    return table;
}

static void assert_same(const dif_table *got, const dif_table *want, int layout)
{
    const dif_plan *a = &got->plan, *b = &want->plan;
    assert_int_equal(a->n_angle, b->n_angle);
    assert_int_equal(a->n_lambda, b->n_lambda);
    assert_int_equal(a->fixed_is_wo, b->fixed_is_wo);
    assert_int_equal(got->quantity, want->quantity);
    assert_true(a->fixed_rad == b->fixed_rad && a->azimuth_rad == b->azimuth_rad);
    assert_memory_equal(a->angle_rad, b->angle_rad, (size_t)a->n_angle * sizeof(double));
    assert_memory_equal(a->lambda_um, b->lambda_um, (size_t)a->n_lambda * sizeof(double));
    for (int i = 0; i < a->n_angle * a->n_lambda; i++) {
        const double value = layout == EXR ? (double)(float)want->value[i] : want->value[i];
        assert_true(got->value[i] == value || (isnan(got->value[i]) && isnan(value)));
    }
}

static void test_write__comes_back_to_the_last_digit(void **state)
{
    (void)state;
    static const int SIZES[][2] = {{1, 1}, {1, 7}, {9, 1}, {120, 30}};
    static const double AZIMUTHS[] = {0.0, 37.0, 90.0, 270.0};
    for (int i = 0; i < 4; i++) {
        for (int layout = 0; layout < N_LAYOUT; layout++) {
            for (int fixed_is_wo = 0; fixed_is_wo < 2; fixed_is_wo++) {
                char path[128];
                dif_table table = make_table(SIZES[i][0], SIZES[i][1], fixed_is_wo, AZIMUTHS[i]), back;
                dif_manifest manifest = {0}, manifest_back;
                dif_error err;
                assert_int_equal(dif_manifest_set(&manifest, "command", "diffbench table x, 'y: z'", &err), DIF_OK);
                assert_int_equal(dif_manifest_set(&manifest, "tol", "1e-6", &err), DIF_OK);
                snprintf(path, sizeof path, "%s/%s", folder, NAMES[layout]);
                assert_int_equal(dif_table_write(path, &table, layout == MATRIX, &manifest, &err), DIF_OK);
                if (dif_table_read(path, &back, &manifest_back, &err))
                    fail_msg("%s", err.text);
                assert_same(&back, &table, layout);
                assert_int_equal(manifest_back.n, 2);
                for (int k = 0; k < 2; k++) {
                    assert_string_equal(manifest_back.item[k].key, manifest.item[k].key);
                    assert_string_equal(manifest_back.item[k].value, manifest.item[k].value);
                }
                remove(path);
                dif_table_free(&table);
                dif_table_free(&back);
                dif_manifest_free(&manifest);
                dif_manifest_free(&manifest_back);
            }
        }
    }
}

/* Reading what was written and writing it again gives the same bytes. */
static void test_write__twice_is_the_same_file(void **state)
{
    (void)state;
    for (int layout = 0; layout < N_LAYOUT; layout++) {
        char path[128];
        unsigned char *first = NULL, *second = NULL;
        size_t n_first = 0, n_second = 0;
        dif_table table = make_table(20, 5, false, 30.0), back;
        dif_manifest manifest;
        dif_error err;
        snprintf(path, sizeof path, "%s/%s", folder, NAMES[layout]);
        assert_int_equal(dif_table_write(path, &table, layout == MATRIX, NULL, &err), DIF_OK);
        assert_int_equal(dif_file_read(path, 1u << 20, &first, &n_first, &err), DIF_OK);
        assert_int_equal(dif_table_read(path, &back, &manifest, &err), DIF_OK);
        assert_int_equal(dif_table_write(path, &back, layout == MATRIX, &manifest, &err), DIF_OK);
        assert_int_equal(dif_file_read(path, 1u << 20, &second, &n_second, &err), DIF_OK);
        assert_int_equal(n_first, n_second);
        assert_memory_equal(first, second, n_first);
        remove(path);
        dif_release(first);
        dif_release(second);
        dif_table_free(&table);
        dif_table_free(&back);
        dif_manifest_free(&manifest);
    }
}

static void test_write__header_and_columns_are_those_promised(void **state)
{
    (void)state;
    char path[128];
    unsigned char *text = NULL;
    size_t n = 0;
    dif_table table = make_table(2, 2, false, 90.0);
    dif_error err;
    for (int i = 0; i < 4; i++)
        table.value[i] = 0.25 * i;
    snprintf(path, sizeof path, "%s/t.csv", folder);
    assert_int_equal(dif_table_write(path, &table, DIF_LAYOUT_TIDY, NULL, &err), DIF_OK);
    assert_int_equal(dif_file_read(path, 10000, &text, &n, &err), DIF_OK);
    assert_string_equal(
        (const char *)text,
        "# layout: tidy\n# quantity: brdf\n# quantity_unit: sr^-1\n# fixed_angle: theta_i\n"
        "# fixed_deg: 75\n# azimuth_deg: 90\n"
        "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,value\n"
        "75,90,-55,90,380,0\n75,90,-54.99,90,380,0.25\n75,90,-55,90,380.7,0.5\n75,90,-54.99,90,380.7,0.75\n");
    dif_release(text);
    assert_int_equal(dif_table_write(path, &table, DIF_LAYOUT_MATRIX, NULL, &err), DIF_OK);
    assert_int_equal(dif_file_read(path, 10000, &text, &n, &err), DIF_OK);
    assert_non_null(strstr((const char *)text, "\nlambda_nm\\theta_r_deg,-55,-54.99\n380,0,0.25\n380.7,0.5,0.75\n"));
    dif_release(text);
    remove(path);
    dif_table_free(&table);
}

static void test_write__full_disk_and_bad_places_are_said(void **state)
{
    (void)state;
    dif_table table = make_table(300, 30, false, 0.0);
    dif_error err;
    for (int layout = 0; layout < 2; layout++) {
        assert_int_equal(dif_table_write("/no/such/t.csv", &table, layout, NULL, &err), DIF_ERR_IO);
        assert_string_equal(err.text, "/no/such/t.csv: cannot write: No such file or directory");
        if (access("/dev/full", W_OK) == 0) {
            assert_int_equal(dif_table_write("/dev/full", &table, layout, NULL, &err), DIF_ERR_IO);
            assert_string_equal(err.text, "/dev/full: cannot write: No space left on device");
        }
    }
    assert_int_equal(dif_table_write("/no/such/t.exr", &table, DIF_LAYOUT_TIDY, NULL, &err), DIF_ERR_IO);
    dif_table_free(&table);
}

/* Attributes that a table needs, one after the other missing or wrong. */
static void test_read__exr_that_is_no_table_is_refused(void **state)
{
    (void)state;
    static const dif_exr_attribute GOOD[] = {{"diffbench.quantity", "rho", 0.0},
                                             {"diffbench.fixed_angle", "theta_i", 0.0},
                                             {"diffbench.fixed_deg", "75", 0.0},
                                             {"diffbench.angle_deg", "10 20", 0.0},
                                             {"diffbench.lambda_nm", "500", 0.0}};
    static const struct {
        int at;
        const char *text, *message;
    } CASES[] = {
        {0, NULL, "EXR without diffbench.quantity, fixed_angle and fixed_deg: not a table"},
        {0, "hue", "quantity is 'hue'"},
        {0, "brdf", "no channel 'brdf'"},
        {1, NULL, "not a table"},
        {2, "90", "fixed angle 90 deg, want -90 < angle < 90"},
        {3, NULL, "no attribute diffbench.angle_deg"},
        {3, "10", "diffbench.angle_deg holds less than 2 numbers"},
        {3, "10 20 30", "diffbench.angle_deg holds more than 2 numbers"},
        {3, "10 x", "diffbench.angle_deg holds less than 2 numbers"},
        {3, "10 10", "two angles are the same"},
        {3, "10 95", "angle 1 is 95 deg"},
        {4, "-500", "wavelength 0 is -500 nm, want a finite number > 0"},
    };
    static const float PIXEL[2] = {1.0f, 2.0f};
    for (size_t i = 0; i <= sizeof CASES / sizeof *CASES; i++) {
        dif_exr_attribute attribute[5];
        unsigned char *data = NULL;
        size_t n = 0;
        dif_table table;
        dif_error err = {0};
        memcpy(attribute, GOOD, sizeof GOOD);
        if (i > 0) {
            attribute[CASES[i - 1].at].text = CASES[i - 1].text ? CASES[i - 1].text : "";
            attribute[CASES[i - 1].at].name = CASES[i - 1].text ? GOOD[CASES[i - 1].at].name : "other";
        }
        const dif_exr_layer layer = {"rho", PIXEL, 1};
        const dif_exr_image image = {
            .nx = 2, .ny = 1, .layer = &layer, .n_layer = 1, .attribute = attribute, .n_attribute = 5};
        assert_int_equal(dif_exr_encode(&image, &data, &n, &err), DIF_OK);
        const dif_status status = dif_table_parse(data, n, "f.exr", &table, NULL, &err);
        assert_int_equal(status, i == 0 ? DIF_OK : DIF_ERR_FORMAT);
        if (i > 0 && !strstr(err.text, CASES[i - 1].message))
            fail_msg("'%s' does not hold '%s'", err.text, CASES[i - 1].message);
        dif_table_free(&table);
        dif_release(data);
    }
}

static void test_read__beginnings_never_read_past_their_end(void **state)
{
    (void)state;
    const int n_live = test_alloc_live();
    for (int layout = 0; layout < N_LAYOUT; layout++) {
        char path[128];
        unsigned char *data = NULL;
        size_t n = 0;
        int n_accepted = 0;
        dif_table table = make_table(3, 3, false, 30.0);
        dif_error err;
        snprintf(path, sizeof path, "%s/%s", folder, NAMES[layout]);
        assert_int_equal(dif_table_write(path, &table, layout == MATRIX, NULL, &err), DIF_OK);
        assert_int_equal(dif_file_read(path, 100000, &data, &n, &err), DIF_OK);
        dif_table_free(&table);
        for (size_t k = 0; k < n; k++) {
            unsigned char *part = malloc(k ? k : 1);
            assert_non_null(part);
            memcpy(part, data, k);
            n_accepted += dif_table_parse(part, k, "f", &table, NULL, &err) == DIF_OK;
            dif_table_free(&table);
            free(part);
        }
        assert_true(layout != EXR || n_accepted == 0); /* whole rows of a CSV are a table */
        remove(path);
        dif_release(data);
    }
    assert_int_equal(test_alloc_live(), n_live);
}

static void test_write__failing_heap_leaves_nothing(void **state)
{
    (void)state;
    dif_table table = make_table(5, 5, false, 0.0);
    const int n_live = test_alloc_live();
    for (int layout = 0; layout < N_LAYOUT; layout++) {
        char path[128];
        dif_status status = DIF_ERR_NOMEM;
        snprintf(path, sizeof path, "%s/%s", folder, NAMES[layout]);
        for (int k = 1; status; k++) {
            dif_error err;
            test_alloc_fail_from(k);
            status = dif_table_write(path, &table, layout == MATRIX, NULL, &err);
            test_alloc_fail_from(0);
            assert_true(status == DIF_OK || status == DIF_ERR_NOMEM);
            assert_int_equal(access(path, F_OK) == 0, status == DIF_OK);
            assert_int_equal(test_alloc_live(), n_live);
            assert_true(k < 2000);
        }
        remove(path);
    }
    dif_table_free(&table);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write__comes_back_to_the_last_digit),
        cmocka_unit_test(test_write__twice_is_the_same_file),
        cmocka_unit_test(test_write__header_and_columns_are_those_promised),
        cmocka_unit_test(test_write__full_disk_and_bad_places_are_said),
        cmocka_unit_test(test_read__exr_that_is_no_table_is_refused),
        cmocka_unit_test(test_read__beginnings_never_read_past_their_end),
        cmocka_unit_test(test_write__failing_heap_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
