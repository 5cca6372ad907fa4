/* The colours of a comparison: CIEDE2000 and chromaticity against full sampling. */
#include <math.h>
#include <stdlib.h>

#include "bench/compare_methods_impl.h"
#include "core/colour.h"
#include "core/units.h"

#define EXPOSED     0.99 /* quantile of luminance that becomes white                     */
#define MIRROR_SINE 0.1  /* |sin theta_i + sin theta_o| of the mirror's neighbourhood    */
#define SHOWN_SHARE 0.01 /* of white: darker angles have no chromaticity to compare      */

dif_status dif_compare_colour_plan(dif_compare_job *j, dif_error *err)
{
    const int half = (int)floor(j->how.colour_max_deg / j->how.colour_step_deg * (1.0 + 1e-12));
    const int n_lambda = (int)floor(400.0 / j->how.colour_step_nm * (1.0 + 1e-12)) + 1;
    const dif_status status = dif_plan_create(2 * half + 1, n_lambda, &j->colour_plan, err);
    if (status != DIF_OK)
        return status;
    j->colour_plan.fixed_is_wo = j->plan->fixed_is_wo;
    j->colour_plan.fixed_rad = j->plan->fixed_rad;
    j->colour_plan.azimuth_rad = j->plan->azimuth_rad;
    for (int i = 0; i <= 2 * half; i++)
        j->colour_plan.angle_rad[i] = dif_rad_from_deg((i - half) * j->how.colour_step_deg);
    for (int i = 0; i < n_lambda; i++)
        j->colour_plan.lambda_um[i] = dif_um_from_nm(380.0 + i * j->how.colour_step_nm);
    return DIF_OK;
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The share's quantile of n values, which are sorted. */
static double quantile(size_t n, double *value, double share)
{
    qsort(value, n, sizeof *value, compare_doubles);
    return value[(size_t)rint(share * (double)(n - 1))];
}

/* Away from the mirror direction, where every surface is white. */
static bool far_from_mirror(const dif_plan *plan, int i_angle)
{
    double sin_sum, cos_sum;
    dif_plan_transfer(plan, i_angle, &sin_sum, &cos_sum);
    return fabs(sin_sum) > MIRROR_SINE;
}

dif_status dif_compare_full_colours(dif_compare_job *j, dif_error *err)
{
    const size_t n_angle = (size_t)j->colour_plan.n_angle;
    dif_measure_opts opts = *j->opts;
    opts.method = DIF_METHOD_SHEET;
    opts.quantity = DIF_QUANTITY_RHO;
    opts.progress = NULL;
    dif_status status = dif_measure_colours(j->field, &j->colour_plan, j->tol, &opts, j->full, NULL, err);
    size_t n = 0;
    for (size_t i = 0; i < n_angle && status == DIF_OK; i++)
        if (far_from_mirror(&j->colour_plan, (int)i))
            j->de[n++] = j->full[i][1];
    const double bright = n > 0 ? quantile(n, j->de, EXPOSED) : 0.0;
    j->exposure = bright > 0.0 ? 1.0 / bright : 1.0;
    return status;
}

/* Brings the colours of a method without a brightness to the mean luminance of full sampling. */
static void match_luminance(const dif_compare_job *j)
{
    double got = 0.0, want = 0.0;
    for (int i = 0; i < j->colour_plan.n_angle; i++)
        if (far_from_mirror(&j->colour_plan, i)) {
            got += j->xyz[i][1];
            want += j->full[i][1];
        }
    for (int i = 0; i < j->colour_plan.n_angle && got > 0.0; i++)
        for (int c = 0; c < 3; c++)
            j->xyz[i][c] *= want / got;
}

/* Adds the difference of two colours' chromaticities. */
static void add_shift(const double a[3], const double b[3], double sum[2])
{
    const double sum_a = a[0] + a[1] + a[2], sum_b = b[0] + b[1] + b[2];
    for (int c = 0; c < 2; c++)
        sum[c] += a[c] / sum_a - b[c] / sum_b;
}

static void note_colours(const dif_compare_job *j, dif_compare_row *row)
{
    const int n = j->colour_plan.n_angle;
    double shift[2] = {0.0, 0.0};
    int n_shown = 0;
    row->de_worst = -1.0;
    for (int i = 0; i < n; i++) {
        double a[3], b[3], lab_a[3], lab_b[3];
        for (int c = 0; c < 3; c++) {
            a[c] = j->exposure * j->xyz[i][c];
            b[c] = j->exposure * j->full[i][c];
        }
        dif_colour_lab_from_xyz(a, lab_a);
        dif_colour_lab_from_xyz(b, lab_b);
        j->de[i] = dif_colour_difference_2000(lab_a, lab_b);
        if (j->de[i] > row->de_worst) {
            row->de_worst = j->de[i];
            row->de_worst_deg = dif_deg_from_rad(j->colour_plan.angle_rad[i]);
        }
        if (far_from_mirror(&j->colour_plan, i) && fmin(a[1], b[1]) > SHOWN_SHARE) {
            add_shift(a, b, shift);
            n_shown++;
        }
    }
    row->de_median = quantile((size_t)n, j->de, 0.5);
    row->de_p95 = quantile((size_t)n, j->de, 0.95);
    if (n_shown > 0) {
        row->shift_x = shift[0] / n_shown;
        row->shift_y = shift[1] / n_shown;
    }
}

dif_status dif_compare_colours(const dif_compare_job *j, const dif_measure_opts *opts, dif_compare_row *row,
                               dif_error *err)
{
    dif_measure_opts own = *opts;
    own.quantity = DIF_QUANTITY_RHO;
    const dif_status status = dif_measure_colours(j->field, &j->colour_plan, j->tol, &own, j->xyz, NULL, err);
    if (status != DIF_OK)
        return status;
    if (opts->method == DIF_METHOD_THESIS || opts->method == DIF_METHOD_STAM)
        match_luminance(j);
    note_colours(j, row);
    return DIF_OK;
}
