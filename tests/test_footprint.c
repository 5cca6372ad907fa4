#include "core/footprint.h"

#include "near.h"

#define LIMIT 1e3

static void assert_finite(const dif_footprint *f)
{
    assert_true(isfinite(f->w1[0]) && isfinite(f->w1[1]) && isfinite(f->w2[0]) && isfinite(f->w2[1]));
}

static void test_from_screen__inverts_the_jacobian(void **state)
{
    (void)state;
    uint64_t seed = 3;
    for (int i = 0; i < 2000; i++) {
        const double scale = exp(test_random(&seed, -200.0, 200.0));
        double j[4];
        for (int k = 0; k < 4; k++)
            j[k] = scale * test_random(&seed, -1.0, 1.0);
        const dif_footprint f = dif_footprint_from_screen(j[0], j[1], j[2], j[3], (double)INFINITY);
        const double condition = 2.0 / fabs(j[0] / scale * j[3] / scale - j[1] / scale * j[2] / scale);
        assert_false(f.clamped);
        /* da = da_du du + da_dv dv along w1 is 1, along w2 is 0; db likewise */
        assert_near(j[0] * f.w1[0] + j[2] * f.w1[1], 1.0, 0.0, 1e-15 * condition);
        assert_near(j[1] * f.w1[0] + j[3] * f.w1[1], 0.0, 0.0, 1e-15 * condition);
        assert_near(j[0] * f.w2[0] + j[2] * f.w2[1], 0.0, 0.0, 1e-15 * condition);
        assert_near(j[1] * f.w2[0] + j[3] * f.w2[1], 1.0, 0.0, 1e-15 * condition);
    }
}

static void test_from_screen__known_case(void **state)
{
    (void)state;
    /* a = 2u + v, b = 4v: u = a/2 - b/8, v = b/4 */
    const dif_footprint f = dif_footprint_from_screen(2.0, 0.0, 1.0, 4.0, LIMIT);
    assert_near(f.w1[0], 0.5, 1e-15, 0.0);
    assert_near(f.w1[1], 0.0, 0.0, 0.0);
    assert_near(f.w2[0], -0.125, 1e-15, 0.0);
    assert_near(f.w2[1], 0.25, 1e-15, 0.0);
    assert_false(f.clamped);
}

static void test_from_screen__singular_reaches_the_limit_where_it_is_blind(void **state)
{
    (void)state;
    /* a = b = (u + v) / sqrt(2): steps along (1, -1) are not seen */
    const double r = sqrt(0.5);
    const dif_footprint f = dif_footprint_from_screen(r, r, r, r, LIMIT);
    const dif_footprint_ellipse e = dif_footprint_ellipse_of(&f);
    assert_true(f.clamped);
    assert_near(e.major, LIMIT, 1e-14, 0.0);
    assert_near(e.minor, 1.0 / sqrt(2.0), 1e-10, 0.0); /* of 1/sqrt(2) beside 1e3: ten digits are left */
    assert_near(fabs(e.major_axis[0] - e.major_axis[1]), sqrt(2.0), 1e-12, 0.0);
    assert_near(e.major_axis[0] + e.major_axis[1], 0.0, 0.0, 1e-12);
    /* an axis just beyond the limit is cut, the other one stays */
    const dif_footprint g = dif_footprint_from_screen(1.0, 0.0, 0.0, 0.5e-3, LIMIT);
    assert_true(g.clamped);
    assert_near(g.w1[0], 1.0, 1e-14, 0.0);
    assert_near(g.w2[1], LIMIT, 1e-14, 0.0);
    assert_near(fabs(g.w1[1]) + fabs(g.w2[0]), 0.0, 0.0, 1e-12);
}

static void test_from_screen__anything_gives_a_finite_footprint(void **state)
{
    (void)state;
    static const double odd[] = {0.0, -0.0, 1.0, -1.0, 1e-320, 1e-300, 1e300, 1.7e308, INFINITY, -INFINITY, NAN};
    enum { N = sizeof odd / sizeof *odd };
    for (int i = 0; i < N * N * N * N; i++) {
        const double j[4] = {odd[i % N], odd[i / N % N], odd[i / N / N % N], odd[i / N / N / N]};
        const dif_footprint f = dif_footprint_from_screen(j[0], j[1], j[2], j[3], LIMIT);
        const dif_footprint_ellipse e = dif_footprint_ellipse_of(&f);
        const bool finite = isfinite(j[0]) && isfinite(j[1]) && isfinite(j[2]) && isfinite(j[3]);
        assert_finite(&f);
        assert_at_most(e.major, LIMIT * (1.0 + 1e-14));
        assert_at_most(0.0, e.minor);
        if (!finite || (j[0] == 0.0 && j[1] == 0.0 && j[2] == 0.0 && j[3] == 0.0)) {
            assert_true(f.clamped);
            assert_near(e.minor, LIMIT, 1e-14, 0.0);
        }
    }
}

static void test_ellipse_of__is_the_image_of_the_circle(void **state)
{
    (void)state;
    uint64_t seed = 9;
    for (int i = 0; i < 2000; i++) {
        const dif_footprint f = {{test_random(&seed, -1.0, 1.0), test_random(&seed, -1.0, 1.0)},
                                 {test_random(&seed, -1.0, 1.0), test_random(&seed, -1.0, 1.0)},
                                 false};
        const dif_footprint_ellipse e = dif_footprint_ellipse_of(&f);
        const double *a = e.major_axis, *b = e.minor_axis;
        /* W W^T = major^2 a a^T + minor^2 b b^T, whatever the parallelogram */
        const double xx = f.w1[0] * f.w1[0] + f.w2[0] * f.w2[0], yy = f.w1[1] * f.w1[1] + f.w2[1] * f.w2[1];
        const double xy = f.w1[0] * f.w1[1] + f.w2[0] * f.w2[1];
        const double p = e.major * e.major, q = e.minor * e.minor;
        assert_near(p * a[0] * a[0] + q * b[0] * b[0], xx, 0.0, 1e-14);
        assert_near(p * a[1] * a[1] + q * b[1] * b[1], yy, 0.0, 1e-14);
        assert_near(p * a[0] * a[1] + q * b[0] * b[1], xy, 0.0, 1e-14);
        assert_near(e.major * e.minor, fabs(f.w1[0] * f.w2[1] - f.w1[1] * f.w2[0]), 1e-13, 1e-15);
        assert_near(a[0] * b[1] - a[1] * b[0], 1.0, 1e-14, 0.0);
        assert_at_most(e.minor, e.major * (1.0 + 1e-15));
    }
}

static void test_ellipse_of__thin_ones_keep_their_short_axis(void **state)
{
    (void)state;
    /* (1, 1), (1, 1 + 1e-12): the area is 1e-12 exactly as stored, the long axis 2 */
    const double next = 1.0 + 1e-12;
    const dif_footprint f = {{1.0, 1.0}, {1.0, next}, false};
    assert_near(dif_footprint_ellipse_of(&f).minor, (next - 1.0) / 2.0, 1e-11, 0.0);
    const dif_footprint none = {{0.0, 0.0}, {0.0, 0.0}, false};
    assert_near(dif_footprint_ellipse_of(&none).major, 0.0, 0.0, 0.0);
    assert_near(dif_footprint_ellipse_of(&none).major_axis[0], 1.0, 0.0, 0.0);
}

static void test_rectangle__has_its_sides_as_axes(void **state)
{
    (void)state;
    const dif_footprint f = dif_footprint_rectangle(0.25, 2.0, LIMIT);
    const dif_footprint_ellipse e = dif_footprint_ellipse_of(&f);
    assert_near(f.w1[0], 0.25, 0.0, 0.0);
    assert_near(f.w2[1], 2.0, 0.0, 0.0);
    assert_near(e.major, 2.0, 1e-15, 0.0);
    assert_near(e.minor, 0.25, 1e-15, 0.0);
    assert_near(fabs(e.major_axis[1]), 1.0, 1e-15, 0.0);
    const dif_footprint same = dif_footprint_from_screen(4.0, 0.0, 0.0, 0.5, LIMIT);
    assert_near(same.w1[0], f.w1[0], 1e-15, 0.0);
    assert_near(same.w2[1], f.w2[1], 1e-15, 0.0);
    const dif_footprint large = dif_footprint_rectangle(-5.0 * LIMIT, 2.0, LIMIT);
    assert_true(large.clamped);
    assert_near(large.w1[0], -LIMIT, 1e-14, 0.0);
    assert_near(large.w2[1], 2.0, 1e-14, 0.0);
    assert_true(dif_footprint_rectangle(NAN, 1.0, LIMIT).clamped);
}

static void test_chain__is_the_jacobian_of_the_whole(void **state)
{
    (void)state;
    uint64_t seed = 17;
    for (int i = 0; i < 500; i++) {
        double j[4], k[4]; /* a, b by u, v;  s, t by u, v */
        for (int n = 0; n < 4; n++) {
            j[n] = test_random(&seed, -1.0, 1.0) + (n % 3 == 0 ? 2.0 : 0.0);
            k[n] = test_random(&seed, -1.0, 1.0) + (n % 3 == 0 ? 2.0 : 0.0);
        }
        const dif_footprint uv = dif_footprint_from_screen(j[0], j[1], j[2], j[3], LIMIT);
        const dif_footprint st = dif_footprint_chain(&uv, k[0], k[1], k[2], k[3], LIMIT);
        /* d(a, b)/d(s, t) = d(a, b)/d(u, v) (d(s, t)/d(u, v))^-1 */
        const double det = k[0] * k[3] - k[1] * k[2];
        const double du_ds = k[3] / det, dv_ds = -k[1] / det, du_dt = -k[2] / det, dv_dt = k[0] / det;
        const dif_footprint want =
            dif_footprint_from_screen(j[0] * du_ds + j[2] * dv_ds, j[1] * du_ds + j[3] * dv_ds,
                                      j[0] * du_dt + j[2] * dv_dt, j[1] * du_dt + j[3] * dv_dt, LIMIT);
        for (int n = 0; n < 2; n++) {
            assert_near(st.w1[n], want.w1[n], 1e-12, 1e-12);
            assert_near(st.w2[n], want.w2[n], 1e-12, 1e-12);
        }
    }
    const dif_footprint uv = dif_footprint_rectangle(1.0, 1.0, LIMIT);
    const dif_footprint odd = dif_footprint_chain(&uv, NAN, 0.0, 0.0, 1.0, LIMIT);
    assert_finite(&odd);
    assert_true(odd.clamped);
    const dif_footprint flat = dif_footprint_chain(&uv, 0.0, 0.0, 0.0, 0.0, LIMIT);
    assert_false(flat.clamped);
    assert_near(dif_footprint_ellipse_of(&flat).major, 0.0, 0.0, 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_from_screen__inverts_the_jacobian),
        cmocka_unit_test(test_from_screen__known_case),
        cmocka_unit_test(test_from_screen__singular_reaches_the_limit_where_it_is_blind),
        cmocka_unit_test(test_from_screen__anything_gives_a_finite_footprint),
        cmocka_unit_test(test_ellipse_of__is_the_image_of_the_circle),
        cmocka_unit_test(test_ellipse_of__thin_ones_keep_their_short_axis),
        cmocka_unit_test(test_rectangle__has_its_sides_as_axes),
        cmocka_unit_test(test_chain__is_the_jacobian_of_the_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
