/* The snake-like surfaces against what is known of the measured ones. */
#include "tests/near.h"

#include <string.h>

#include "core/units.h"
#include "fixtures/snake.h"
#include "fixtures/surfaces.h"
#include "tests/rows.h"

/* What the lines along the ridges' normal hold. */
typedef struct ridges {
    double swell_nm, ridges_nm, mean_period_nm, width_per_um, peak_period_nm;
} ridges;

enum { N_LINE_STEP = 9, N_FREQUENCY = 88 }; /* every ninth line; frequencies k / 65 um up to 1.35 per um */

/* Adds one line's power at the frequencies k / (n pitch), Hann window, mean taken off. */
static void add_line(const double *z, size_t stride, int n, double *power)
{
    double mean = 0.0;
    for (int i = 0; i < n; i++)
        mean += z[(size_t)i * stride] / n;
    for (int k = 1; k < N_FREQUENCY; k++) {
        double re = 0.0, im = 0.0;
        for (int i = 0; i < n; i++) {
            const double s = sin(DIF_PI * (i + 0.5) / n), value = (z[(size_t)i * stride] - mean) * s * s;
            re += value * cos(DIF_TWO_PI * k * i / n);
            im += value * sin(DIF_TWO_PI * k * i / n);
        }
        power[k] += (re * re + im * im) * 2.0 / (0.375 * n * n); /* 3/8: mean square of the Hann window */
    }
}

static ridges ridges_of(const dif_field *field, bool along_y)
{
    double power[N_FREQUENCY] = {0.0};
    const size_t nx = (size_t)field->nx;
    int n_line = 0;
    for (int i = 0; i < field->nx; i += N_LINE_STEP, n_line++) {
        if (along_y)
            add_line(field->z_um + i, nx, field->ny, power);
        else
            add_line(field->z_um + (size_t)i * nx, 1, field->nx, power);
    }
    double low = 0.0, sum = 0.0, sum_f = 0.0, sum_f2 = 0.0;
    int top = 0;
    for (int k = 1; k < N_FREQUENCY; k++) {
        const double f = k / (field->nx * field->pitch_x_um), p = power[k] / n_line;
        low += f < 0.35 ? p : 0.0;
        if (f > 0.5 && f < 1.35) {
            sum += p;
            sum_f += p * f;
            sum_f2 += p * f * f;
            top = top == 0 || power[k] > power[top] ? k : top;
        }
    }
    const double mean_f = sum_f / sum;
    return (ridges){1e3 * sqrt(low), 1e3 * sqrt(sum), 1e3 / mean_f, sqrt(sum_f2 / sum - mean_f * mean_f),
                    1e3 * field->nx * field->pitch_x_um / top};
}

static void assert_within_factor(double got, double want, double factor)
{
    assert_at_most(got, want * factor);
    assert_at_most(want / factor, got);
}

/* Alike, not equal: sizes within a factor of 2 (slopes 2.5: a scan's noise has slopes and the synthetic one has little),
 * the mean period within 15 %, and a spread of periods that a regular grating does not have. */
static void test_surface__is_like_the_measured_scan(void **state)
{
    (void)state;
    FILE *file = test_rows_open("fixtures/expected", "scans.csv");
    assert_non_null(file);
    test_row row;
    int n_read = 0, n = 0;
    for (; test_row_next(file, &n_read, &row); n++) {
        dif_surface_kind kind;
        assert_true(dif_surface_kind_from_name(row.cell[0], &kind));
        const dif_surface surface = dif_surface_default(kind);
        dif_field field;
        dif_field_stats stats;
        dif_error err;
        assert_int_equal(dif_surface_make(&surface, &field, &err), DIF_OK);
        assert_int_equal(dif_field_stats_of(&field, &stats, &err), DIF_OK);
        const ridges r = ridges_of(&field, kind == DIF_SURFACE_XENOPELTIS);
        dif_field_free(&field);
        print_message("%s: rms %.1f nm, slopes %.3f %.3f, swell %.1f nm, ridges %.1f nm, mean period %.0f nm, width "
                      "%.3f per um, highest at %.0f nm\n",
                      row.cell[0], 1e3 * stats.rms_um, stats.slope_x_rms, stats.slope_y_rms, r.swell_nm, r.ridges_nm,
                      r.mean_period_nm, r.width_per_um, r.peak_period_nm);
        assert_near(stats.min_um, 0.0, 0.0, 0.0);
        assert_near(stats.max_um, surface.height_um, 1e-12, 0.0);
        assert_within_factor(1e3 * stats.rms_um, strtod(row.cell[1], NULL), 2.0);
        assert_within_factor(stats.slope_x_rms, strtod(row.cell[2], NULL), 2.5);
        assert_within_factor(stats.slope_y_rms, strtod(row.cell[3], NULL), 2.5);
        assert_within_factor(r.swell_nm, strtod(row.cell[4], NULL), 2.0);
        assert_within_factor(r.ridges_nm, strtod(row.cell[5], NULL), 2.0);
        assert_near(r.mean_period_nm, strtod(row.cell[6], NULL), 0.15, 0.0);
        assert_within_factor(r.width_per_um, strtod(row.cell[7], NULL), 2.0);
        assert_near(r.peak_period_nm, 1e3 * surface.period_um, 0.12, 0.0);
    }
    fclose(file);
    assert_int_equal(n, 2);
}

/* The pattern has no cracks: a small step changes the height by a bounded slope, except for the seams of elaphe's
 * staggered columns and rows, which are as steep as the measured ones. */
static void test_height__is_finite_and_mostly_gentle(void **state)
{
    (void)state;
    uint64_t random = 8;
    int n_steep[2] = {0, 0};
    for (int i = 0; i < 20000; i++) {
        const double s = test_random(&random, -200.0, 200.0), t = test_random(&random, -200.0, 200.0);
        for (int snake = 0; snake < 2; snake++) {
            double (*const height)(uint64_t, double, double) = snake ? dif_snake_xenopeltis : dif_snake_elaphe;
            const double h = height(3, s, t), there = height(3, s + 1e-4, t + 1e-4);
            assert_in_range((int64_t)(h + 10.0), 0, 30);
            n_steep[snake] += !(fabs(there - h) < 30.0 * 1e-4);
        }
    }
    assert_in_range(n_steep[0], 0, 200); /* 1 % of places */
    assert_in_range(n_steep[1], 0, 200);
}

/* Places depend on coordinates only: a larger patch holds the smaller one, up to the stretch to the height range. */
static void test_surface__does_not_depend_on_the_patch(void **state)
{
    (void)state;
    dif_surface surface = dif_surface_default(DIF_SURFACE_XENOPELTIS);
    surface.nx = surface.ny = 101;
    dif_field inner, outer;
    dif_error err;
    assert_int_equal(dif_surface_make(&surface, &inner, &err), DIF_OK);
    surface.nx = surface.ny = 201;
    assert_int_equal(dif_surface_make(&surface, &outer, &err), DIF_OK);
    const double *a = inner.z_um, *b = outer.z_um + 50 * 201 + 50;
    const double scale = (b[40 * 201 + 60] - b[0]) / (a[40 * 101 + 60] - a[0]);
    for (int iy = 0; iy < 101; iy += 5) {
        for (int ix = 0; ix < 101; ix += 5)
            assert_near(b[iy * 201 + ix] - b[0], scale * (a[iy * 101 + ix] - a[0]), 0.0, 1e-9);
    }
    dif_field_free(&inner);
    dif_field_free(&outer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_surface__is_like_the_measured_scan),
        cmocka_unit_test(test_height__is_finite_and_mostly_gentle),
        cmocka_unit_test(test_surface__does_not_depend_on_the_patch),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
