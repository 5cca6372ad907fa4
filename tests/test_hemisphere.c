#include "core/hemisphere.h"

#include <string.h>

#include "alloc_count.h"
#include "core/alloc.h"
#include "core/shadow.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "near.h"
#include "rough.h"

/* A sum whose rounding does not grow with the number of its terms (Kahan). */
typedef struct exact_sum {
    double sum, lost;
} exact_sum;

static void add(exact_sum *to, double value)
{
    const double y = value - to->lost, t = to->sum + y;
    to->lost = (t - to->sum) - y;
    to->sum = t;
}

static void test_solid_angle__quarter_and_symmetry(void **state)
{
    (void)state;
    assert_near(dif_hemisphere_solid_angle_sr(1.0, 1.0), 0.5 * DIF_PI, 1e-15, 0.0);
    assert_near(dif_hemisphere_solid_angle_sr(1.0, 0.0), 0.0, 0.0, 0.0);
    assert_near(dif_hemisphere_solid_angle_sr(0.0, 1.0), 0.0, 0.0, 0.0);
    /* [0, x] x [0, 1]: an orange slice, x pi / 2 */
    assert_near(dif_hemisphere_solid_angle_sr(0.3, 1.0), 0.3 * 0.5 * DIF_PI, 1e-15, 0.0);
    /* a small one is flat */
    assert_near(dif_hemisphere_solid_angle_sr(1e-4, 2e-4), 2e-8 * (1.0 + (1e-8 + 4e-8) / 6.0), 1e-8, 0.0);
    uint64_t seed = 2;
    for (int i = 0; i < 200; i++) {
        const double x = test_random(&seed, 0.0, 1.0), y = test_random(&seed, 0.0, 1.0);
        const double a = dif_hemisphere_solid_angle_sr(x, y);
        assert_near(dif_hemisphere_solid_angle_sr(-x, y), -a, 0.0, 0.0);
        assert_near(dif_hemisphere_solid_angle_sr(x, -y), -a, 0.0, 0.0);
        assert_near(dif_hemisphere_solid_angle_sr(-x, -y), a, 0.0, 0.0);
        assert_near(dif_hemisphere_solid_angle_sr(y, x), a, 1e-15, 1e-15);
    }
}

/* int over x0..x1 of f(x, clipped y0, clipped y1) dx by a rule that bears the root at the rim: x = sin t. */
static dif_hemisphere_texel texel_by_quadrature(double x0, double x1, double y0, double y1)
{
    enum { N = 20000 };
    dif_hemisphere_texel out = {0};
    const double t0 = asin(x0), step = (asin(x1) - t0) / N;
    for (int i = 0; i < N; i++) {
        const double t = t0 + (i + 0.5) * step, c = cos(t), x = sin(t);
        const double low = fmin(fmax(y0, -c), c), high = fmin(fmax(y1, -c), c), dx = c * step;
        out.sr += dx * (asin(high / c) - asin(low / c));
        out.x += dx * x * (asin(high / c) - asin(low / c));
        out.y += dx * (sqrt(fmax(c * c - low * low, 0.0)) - sqrt(fmax(c * c - high * high, 0.0)));
        out.area += dx * (high - low);
    }
    return out;
}

static void test_texel_at__matches_quadrature_also_at_the_rim(void **state)
{
    (void)state;
    enum { N = 9 };
    for (int iy = 0; iy < N; iy++)
        for (int ix = 0; ix < N; ix++) {
            const dif_hemisphere_texel got = dif_hemisphere_texel_at(N, ix, iy);
            const dif_hemisphere_texel want = texel_by_quadrature(2.0 * ix / N - 1.0, 2.0 * (ix + 1) / N - 1.0,
                                                                  1.0 - 2.0 * (iy + 1) / N, 1.0 - 2.0 * iy / N);
            assert_near(got.sr, want.sr, 0.0, 1e-7); /* the sum's own kinks at the rim */
            assert_near(got.x, want.x, 0.0, 1e-7);
            assert_near(got.y, want.y, 0.0, 1e-7);
            assert_near(got.area, want.area, 0.0, 1e-7);
        }
}

static void test_texel_at__hemisphere_adds_up(void **state)
{
    (void)state;
    static const int sizes[] = {1, 2, 7, 8, 33, 256, 1000};
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        exact_sum sr = {0}, x = {0}, y = {0}, area = {0};
        const int n = sizes[k];
        for (int iy = 0; iy < n; iy++)
            for (int ix = 0; ix < n; ix++) {
                const dif_hemisphere_texel t = dif_hemisphere_texel_at(n, ix, iy);
                assert_true(t.sr >= t.area && t.area >= 0.0);
                add(&sr, t.sr);
                add(&x, t.x);
                add(&y, t.y);
                add(&area, t.area);
            }
        assert_near(sr.sum, DIF_TWO_PI, 0.0, 1e-12);
        assert_near(area.sum, DIF_PI, 0.0, 1e-12);
        assert_near(x.sum, 0.0, 0.0, 1e-12);
        assert_near(y.sum, 0.0, 0.0, 1e-12);
    }
}

static void test_row_sr__adds_up_for_images_of_any_size(void **state)
{
    (void)state;
    static const int sizes[] = {7, 8, 9, 16, 100, 255, 256, 1023, 2048, 4096};
    double row[4096], worst = 0.0;
    for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
        exact_sum sum = {0};
        for (int iy = 0; iy < sizes[k]; iy++) {
            dif_hemisphere_row_sr(sizes[k], iy, row);
            for (int ix = 0; ix < sizes[k]; ix++)
                add(&sum, row[ix]);
        }
        assert_near(sum.sum, DIF_TWO_PI, 0.0, 1e-12);
        worst = fmax(worst, fabs(sum.sum - DIF_TWO_PI));
    }
    print_message("hemispheres of 7 ... 4096 texels: 2 pi to %.2g sr\n", worst);
}

static void test_row_sr__is_the_texels(void **state)
{
    (void)state;
    double row[31];
    for (int iy = 0; iy < 31; iy++) {
        dif_hemisphere_row_sr(31, iy, row);
        for (int ix = 0; ix < 31; ix++)
            assert_near(row[ix], dif_hemisphere_texel_at(31, ix, iy).sr, 0.0, 2e-15);
    }
}

static dif_ndf ndf_of(const dif_field *field, int n)
{
    dif_ndf ndf;
    assert_int_equal(dif_hemisphere_ndf_create(field, n, true, &ndf, NULL), DIF_OK);
    return ndf;
}

static void test_ndf_create__projected_area_is_one(void **state)
{
    (void)state;
    const double heights[] = {1e-6, 0.05, 1.0, 50.0};
    for (int i = 0; i < 4; i++) {
        dif_field field = test_rough_field(60, 50, 0.1, 0.1, heights[i], 4);
        const int sizes[] = {3, 16, 65};
        for (int k = 0; k < 3; k++) {
            dif_ndf ndf = ndf_of(&field, sizes[k]);
            assert_near(dif_hemisphere_ndf_projected(&ndf), 1.0, 1e-12, 0.0);
            double area = 0.0; /* the same from the image */
            for (int t = 0; t < sizes[k] * sizes[k]; t++)
                area += ndf.d[t] * dif_hemisphere_texel_at(sizes[k], t % sizes[k], t / sizes[k]).area;
            assert_near(area, 1.0, 1e-12, 0.0);
            dif_hemisphere_ndf_free(&ndf);
        }
        dif_field_free(&field);
    }
}

static void test_ndf_create__normals_lean_against_the_slope(void **state)
{
    (void)state;
    dif_field field;
    dif_ndf ndf;
    assert_int_equal(dif_field_create(8, 8, 1.0, 1.0, &field, NULL), DIF_OK);
    for (int i = 0; i < 64; i++)
        field.z_um[i] = 0.5 * dif_field_x_um(&field, i % 8) - 0.25 * dif_field_y_um(&field, i / 8);
    assert_int_equal(dif_hemisphere_ndf_create(&field, 101, false, &ndf, NULL), DIF_OK);
    double mean[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < 3; c++)
        for (size_t i = 0; i < ndf.n_used; i++)
            mean[c] += ndf.vector[c][i];
    assert_near(mean[0], -0.5, 0.0, 1e-3); /* the area vector is (-s, 1); texels are 0.02 wide, the splat quadratic */
    assert_near(mean[1], 0.25, 0.0, 1e-3);
    assert_near(mean[2], 1.0, 1e-12, 0.0);
    assert_near(ndf.slope_rms, hypot(0.5, 0.25), 1e-12, 0.0);
    dif_hemisphere_ndf_free(&ndf);
    ndf = ndf_of(&field, 101); /* levelled: all normals at the pole */
    assert_near(ndf.slope_rms, 0.0, 0.0, 1e-7);
    assert_near(ndf.vector[2][0] * (double)(ndf.n_used == 1), 1.0, 1e-9, 0.0);
    dif_hemisphere_ndf_free(&ndf);
    dif_field_free(&field);
}

static void test_masking__at_most_one_and_one_from_above(void **state)
{
    (void)state;
    uint64_t seed = 12;
    const double heights[] = {1e-3, 0.05, 0.5, 20.0};
    for (int i = 0; i < 4; i++) {
        dif_field field = test_rough_field(64, 64, 0.1, 0.1, heights[i], 4);
        dif_ndf ndf = ndf_of(&field, 65);
        assert_near(dif_hemisphere_masking(&ndf, (dif_vec3){0.0, 0.0, 1.0}), 1.0, 1e-12, 0.0);
        for (int k = 0; k < 200; k++) {
            const dif_vec3 w =
                dif_vec3_from_angles_rad(test_random(&seed, 0.0, 0.5 * DIF_PI), test_random(&seed, 0.0, DIF_TWO_PI));
            const double g = dif_hemisphere_masking(&ndf, w);
            assert_true(g >= 0.0 && g <= 1.0);
        }
        assert_near(dif_hemisphere_masking(&ndf, (dif_vec3){1.0, 0.0, 0.0}), 0.0, 0.0, 0.0);
        dif_hemisphere_ndf_free(&ndf);
        dif_field_free(&field);
    }
}

static void test_masking__flat_surface_masks_nothing(void **state)
{
    (void)state;
    dif_field field;
    assert_int_equal(dif_field_create(4, 4, 1.0, 1.0, &field, NULL), DIF_OK);
    dif_ndf ndf = ndf_of(&field, 33);
    for (int i = 0; i < 90; i++)
        assert_near(dif_hemisphere_masking(&ndf, dif_vec3_from_angles_rad(dif_rad_from_deg(i), 0.3 * i)), 1.0, 1e-12,
                    0.0);
    dif_hemisphere_ndf_free(&ndf);
    dif_field_free(&field);
}

static void test_masking__symmetric_ridges_have_a_closed_form(void **state)
{
    (void)state;
    /* slopes +-0.4 along x, half each: visible along x is max(0, c - 0.4 s)/2 + (c + 0.4 s)/2 */
    dif_field field;
    assert_int_equal(dif_field_create(401, 3, 1.0, 1.0, &field, NULL), DIF_OK);
    for (int i = 0; i < 3 * 401; i++)
        field.z_um[i] = 0.4 * (i % 401 % 2);
    dif_ndf ndf = ndf_of(&field, 513);
    for (int deg = 0; deg < 88; deg += 3) {
        const double c = cos(dif_rad_from_deg(deg)), s = sin(dif_rad_from_deg(deg));
        const double want = c / (0.5 * fmax(c - 0.4 * s, 0.0) + 0.5 * (c + 0.4 * s));
        assert_near(dif_hemisphere_masking(&ndf, (dif_vec3){s, 0.0, c}), want, 0.0, 2e-3); /* texels are 0.004 wide */
        assert_near(dif_hemisphere_masking(&ndf, (dif_vec3){0.0, s, c}), 1.0, 0.0, 5e-3);  /* and across */
    }
    dif_hemisphere_ndf_free(&ndf);
    dif_field_free(&field);
}

static void test_masking__gaussian_image_agrees_with_smith(void **state)
{
    (void)state;
    /* D = p(s) / cos^4: the image at texel centres, no surface in between */
    enum { N = 513 };
    double *d = dif_alloc((size_t)N * N, sizeof *d);
    const dif_slope_gauss g = {0.0, 0.0, 0.09, 0.04, 0.02};
    dif_ndf ndf;
    assert_non_null(d);
    for (int i = 0; i < N * N; i++) {
        const double x = (2.0 * (i % N) + 1.0) / N - 1.0, y = 1.0 - (2.0 * (i / N) + 1.0) / N, z2 = 1.0 - x * x - y * y;
        const double slope[2] = {-x / sqrt(fmax(z2, 1e-9)), -y / sqrt(fmax(z2, 1e-9))};
        d[i] = z2 > 0.0 ? dif_slope_density(&g, slope) / (z2 * z2) : 0.0;
    }
    assert_int_equal(dif_hemisphere_ndf_from_image(d, N, &ndf, NULL), DIF_OK);
    double worst = 0.0;
    for (int deg = 0; deg < 90; deg++) {
        const dif_vec3 k = dif_vec3_from_angles_rad(dif_rad_from_deg(deg), 0.1 * deg);
        const double error = dif_hemisphere_masking(&ndf, k) - dif_shadow_smith(&g, k);
        worst = fmax(worst, fabs(error));
    }
    print_message("Gaussian image of %d texels against Smith: %.2g\n", N, worst);
    assert_at_most(worst, 2e-5); /* the midpoint rule on texels of 0.004 */
    dif_hemisphere_ndf_free(&ndf);
    dif_release(d);
}

static void test_masking__random_surface_agrees_with_smith(void **state)
{
    (void)state;
    /* A Gaussian surface of 512^2 samples holds few independent slopes: with n patches of one correlation length its
     * G scatters by about the spread of a single facet over sqrt(n), which bounds the agreement. */
    dif_surface surface = dif_surface_default(DIF_SURFACE_RANDOM);
    dif_field field;
    dif_slope_gauss g;
    surface.nx = surface.ny = 512;
    surface.pitch_um = 0.05;
    surface.height_um = 0.4;
    assert_int_equal(dif_surface_make(&surface, &field, NULL), DIF_OK);
    assert_int_equal(dif_slope_of_field(&field, &g, NULL), DIF_OK);
    dif_ndf ndf = ndf_of(&field, 257);
    double worst = 0.0;
    for (int deg = 0; deg <= 85; deg++)
        for (int phi = 0; phi < 360; phi += 30) {
            const dif_vec3 k = dif_vec3_from_angles_rad(dif_rad_from_deg(deg), dif_rad_from_deg(phi));
            worst = fmax(worst, fabs(dif_hemisphere_masking(&ndf, k) - dif_shadow_smith(&g, k)));
        }
    print_message("random surface, slopes %.3f rms: G against Smith %.3g up to 85 degrees\n", ndf.slope_rms, worst);
    assert_at_most(worst, 0.02);
    dif_hemisphere_ndf_free(&ndf);
    dif_field_free(&field);
}

static void test_masking_image__is_masking(void **state)
{
    (void)state;
    enum { M = 24 };
    float g[M * M];
    dif_field field = test_rough_field(32, 32, 0.1, 0.1, 0.1, 8);
    dif_ndf ndf = ndf_of(&field, 33);
    dif_hemisphere_masking_image(&ndf, M, g);
    const double x = 7.0 / M - 1.0, y = 1.0 - 21.0 / M;
    const dif_vec3 k = {x, y, sqrt(1.0 - x * x - y * y)};
    assert_near((double)g[10 * M + 3], dif_hemisphere_masking(&ndf, k), 1e-6, 0.0);
    assert_near((double)g[0], 0.0, 0.0, 0.0);
    dif_hemisphere_ndf_free(&ndf);
    dif_field_free(&field);
}

static void test_ndf__bad_input_is_refused(void **state)
{
    (void)state;
    dif_error err;
    dif_ndf ndf;
    dif_field one, field = test_rough_field(8, 8, 0.1, 0.1, 0.1, 8);
    assert_int_equal(dif_field_create(1, 1, 1.0, 1.0, &one, NULL), DIF_OK);
    assert_int_equal(dif_hemisphere_ndf_create(&field, 2, true, &ndf, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "2 texels across, want 3 ... 8192");
    assert_int_equal(dif_hemisphere_ndf_create(&one, 33, true, &ndf, &err), DIF_ERR_SIZE);
    assert_null(ndf.d);
    double d[9] = {0};
    assert_int_equal(dif_hemisphere_ndf_from_image(d, 3, &ndf, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "normals: nothing above the horizon");
    d[4] = -1.0;
    assert_int_equal(dif_hemisphere_ndf_from_image(d, 3, &ndf, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "normals: -1 at texel 4, want a number >= 0");
    d[4] = NAN;
    assert_int_equal(dif_hemisphere_ndf_from_image(d, 3, &ndf, &err), DIF_ERR_ARG);
    for (int k = 1; k <= 2; k++) {
        test_alloc_fail_from(k);
        assert_int_equal(dif_hemisphere_ndf_create(&field, 33, true, &ndf, &err), DIF_ERR_NOMEM);
        test_alloc_fail_from(0);
        assert_null(ndf.d);
    }
    dif_field_free(&one);
    dif_field_free(&field);
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solid_angle__quarter_and_symmetry),
        cmocka_unit_test(test_texel_at__matches_quadrature_also_at_the_rim),
        cmocka_unit_test(test_texel_at__hemisphere_adds_up),
        cmocka_unit_test(test_row_sr__adds_up_for_images_of_any_size),
        cmocka_unit_test(test_row_sr__is_the_texels),
        cmocka_unit_test(test_ndf_create__projected_area_is_one),
        cmocka_unit_test(test_ndf_create__normals_lean_against_the_slope),
        cmocka_unit_test(test_masking__at_most_one_and_one_from_above),
        cmocka_unit_test(test_masking__flat_surface_masks_nothing),
        cmocka_unit_test(test_masking__symmetric_ridges_have_a_closed_form),
        cmocka_unit_test(test_masking__gaussian_image_agrees_with_smith),
        cmocka_unit_test(test_masking__random_surface_agrees_with_smith),
        cmocka_unit_test(test_masking_image__is_masking),
        cmocka_unit_test(test_ndf__bad_input_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
