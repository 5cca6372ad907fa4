#include "bench/regress.h"

#include <math.h>
#include <stdlib.h>

#include "bench/maxima.h"
#include "core/alloc.h"
#include "core/colour.h"
#include "core/units.h"

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Nearest rank: the smallest value that at least this share of all do not exceed. */
static double quantile(size_t n, const double *sorted, double share)
{
    const double rank = ceil(share * (double)n - 1e-9);
    return sorted[rank > 1.0 ? (size_t)rank - 1 : 0];
}

/* Sorts error[n] and fills the quantiles; the worst is already known. */
static void fill_quantiles(size_t n, double *error, dif_regress_stat *stat)
{
    qsort(error, n, sizeof *error, ascending);
    stat->median = quantile(n, error, 0.5);
    stat->p95 = quantile(n, error, 0.95);
    stat->p99 = quantile(n, error, 0.99);
}

static void note_worst(double error, size_t at, double a, double b, dif_regress_stat *stat)
{
    if (!(error > stat->worst))
        return;
    stat->worst = error;
    stat->worst_at = at;
    stat->worst_a = a;
    stat->worst_b = b;
}

/* Counts what can be compared; false for a place that cannot. */
static bool comparable(double a, double b, size_t at, dif_regress *out)
{
    const bool fine_a = isfinite(a), fine_b = isfinite(b);
    if (fine_a != fine_b || (!fine_a && !(isnan(a) && isnan(b)))) {
        if (out->n_one_sided++ == 0)
            out->one_sided_at = at;
    }
    return fine_a && fine_b;
}

/* One measure: its errors into error[out->n], its worst into *stat. `scale` 0: relative to each place's larger value. */
static void measure(size_t n, const double *a, const double *b, const dif_regress *out, double scale, double *error,
                    dif_regress_stat *stat)
{
    size_t m = 0;
    *stat = (dif_regress_stat){.worst = -1.0};
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(a[i]) || !isfinite(b[i]))
            continue;
        const double larger = fmax(fmax(fabs(a[i]), fabs(b[i])), out->floor);
        const double unit = scale > 0.0 ? scale : larger;
        error[m] = unit > 0.0 ? fabs(a[i] - b[i]) / unit : 0.0;
        note_worst(error[m], i, a[i], b[i], stat);
        m++;
    }
    fill_quantiles(m, error, stat);
}

dif_status dif_regress_values(size_t n, const double *a, const double *b, double floor_share, dif_regress *out,
                              dif_error *err)
{
    *out = (dif_regress){0};
    if (!(floor_share > 0.0 && floor_share <= 1.0))
        return dif_fail(err, DIF_ERR_ARG, "a floor of %g of the maximum, want 0 < share <= 1", floor_share);
    if (n == 0)
        return dif_fail(err, DIF_ERR_ARG, "nothing to compare");
    double *error = dif_alloc(n, sizeof *error);
    if (!error)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to compare %zu numbers", n);
    for (size_t i = 0; i < n; i++)
        if (comparable(a[i], b[i], i, out)) {
            out->n++;
            out->maximum = fmax(out->maximum, fmax(fabs(a[i]), fabs(b[i])));
        }
    out->floor = floor_share * out->maximum;
    if (out->n > 0) {
        measure(n, a, b, out, 0.0, error, &out->relative);
        measure(n, a, b, out, 1.0, error, &out->absolute);
        measure(n, a, b, out, out->maximum > 0.0 ? out->maximum : 1.0, error, &out->of_max);
    }
    dif_release(error);
    return DIF_OK;
}

static dif_status check_axis(const char *name, double unit, int n, const double *a, const double *b, dif_error *err)
{
    for (int i = 0; i < n; i++)
        if (!(fabs(a[i] - b[i]) <= 1e-9))
            return dif_fail(err, DIF_ERR_ARG, "tables differ in their axes: %s %d is %.9g and %.9g", name, i,
                            unit * a[i], unit * b[i]);
    return DIF_OK;
}

static dif_status check_plans(const dif_table *a, const dif_table *b, dif_error *err)
{
    const dif_plan *p = &a->plan, *q = &b->plan;
    if (p->n_angle != q->n_angle || p->n_lambda != q->n_lambda)
        return dif_fail(err, DIF_ERR_SIZE, "tables of %d x %d and %d x %d cells", p->n_angle, p->n_lambda, q->n_angle,
                        q->n_lambda);
    if (a->quantity != b->quantity)
        return dif_fail(err, DIF_ERR_ARG, "tables of %s and %s", dif_quantity_name(a->quantity),
                        dif_quantity_name(b->quantity));
    if (p->fixed_is_wo != q->fixed_is_wo || !(fabs(p->fixed_rad - q->fixed_rad) <= 1e-9) ||
        !(fabs(p->azimuth_rad - q->azimuth_rad) <= 1e-9))
        return dif_fail(err, DIF_ERR_ARG, "tables differ in their planes of incidence or fixed angles");
    const dif_status status = check_axis("angle", dif_deg_from_rad(1.0), p->n_angle, p->angle_rad, q->angle_rad, err);
    return status != DIF_OK ? status : check_axis("wavelength", 1e3, p->n_lambda, p->lambda_um, q->lambda_um, err);
}

dif_status dif_regress_tables(const dif_table *a, const dif_table *b, double floor_share, dif_regress *out,
                              dif_error *err)
{
    *out = (dif_regress){0};
    const dif_status status = check_plans(a, b, err);
    if (status != DIF_OK)
        return status;
    return dif_regress_values((size_t)a->plan.n_angle * (size_t)a->plan.n_lambda, a->value, b->value, floor_share, out,
                              err);
}

static bool is_finite_colour(const double xyz[3])
{
    return isfinite(xyz[0]) && isfinite(xyz[1]) && isfinite(xyz[2]);
}

double dif_regress_difference(const double a[3], const double b[3], double exposure)
{
    double scaled_a[3], scaled_b[3], lab_a[3], lab_b[3];
    const bool fine_a = is_finite_colour(a), fine_b = is_finite_colour(b);
    if (!fine_a || !fine_b)
        return fine_a == fine_b ? 0.0 : (double)INFINITY;
    const double brighter = fmax(a[1], b[1]), own = exposure * brighter > 1.0 ? 1.0 / brighter : exposure;
    for (int c = 0; c < 3; c++) {
        scaled_a[c] = own * a[c];
        scaled_b[c] = own * b[c];
    }
    dif_colour_lab_from_xyz(scaled_a, lab_a);
    dif_colour_lab_from_xyz(scaled_b, lab_b);
    return dif_colour_difference_2000(lab_a, lab_b);
}

dif_status dif_regress_colours(size_t n, double (*a)[3], double (*b)[3], double exposure, dif_regress_stat *de,
                               dif_error *err)
{
    *de = (dif_regress_stat){.worst = -1.0};
    if (n == 0)
        return dif_fail(err, DIF_ERR_ARG, "nothing to compare");
    if (!(exposure > 0.0 && isfinite(exposure)))
        return dif_fail(err, DIF_ERR_ARG, "an exposure of %g, want > 0", exposure);
    double *value = dif_alloc(n, sizeof *value);
    if (!value)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to compare %zu colours", n);
    size_t m = 0;
    for (size_t i = 0; i < n; i++) {
        if (isnan(a[i][1]) && isnan(b[i][1]))
            continue;
        value[m] = dif_regress_difference(a[i], b[i], exposure);
        note_worst(value[m], i, a[i][1], b[i][1], de);
        m++;
    }
    if (m > 0)
        fill_quantiles(m, value, de);
    else
        *de = (dif_regress_stat){0};
    dif_release(value);
    return DIF_OK;
}

/* The nearest of the maxima of one wavelength; NULL if there is none. `*from` runs along with the wavelengths. */
static const dif_maximum *nearest(const dif_maxima *maxima, int *from, const dif_maximum *to)
{
    const dif_maximum *best = NULL;
    while (*from < maxima->n && maxima->item[*from].lambda_um < to->lambda_um - 1e-12)
        ++*from;
    for (int i = *from; i < maxima->n && maxima->item[i].lambda_um <= to->lambda_um + 1e-12; i++)
        if (!best || fabs(maxima->item[i].angle_rad - to->angle_rad) < fabs(best->angle_rad - to->angle_rad))
            best = maxima->item + i;
    return best;
}

/* Two steps of the angle axis. */
static double reach_of(const dif_plan *plan)
{
    const int n = plan->n_angle;
    return n > 1 ? 2.0 * fabs(plan->angle_rad[n - 1] - plan->angle_rad[0]) / (n - 1) : 0.0;
}

static void match(const dif_maxima *a, const dif_maxima *b, double reach_rad, dif_regress_peaks *out)
{
    int from = 0;
    for (int i = 0; i < b->n; i++) {
        if (b->item[i].at_edge)
            continue;
        const dif_maximum *found = nearest(a, &from, b->item + i);
        const double shift_rad = found ? fabs(found->angle_rad - b->item[i].angle_rad) : (double)INFINITY;
        out->n++;
        if (!found || !(shift_rad <= reach_rad)) {
            out->n_lost++;
        } else if (shift_rad >= out->worst_shift_rad) {
            out->worst_shift_rad = shift_rad;
            out->lambda_um = b->item[i].lambda_um;
            out->angle_a_rad = found->angle_rad;
            out->angle_b_rad = b->item[i].angle_rad;
        }
    }
}

dif_status dif_regress_peaks_of(const dif_table *a, const dif_table *b, double floor_share, dif_regress_peaks *out,
                                dif_error *err)
{
    dif_maxima_opts opts = dif_maxima_opts_default();
    dif_maxima of_a = {0}, of_b = {0};
    *out = (dif_regress_peaks){0};
    opts.floor_share = floor_share;
    dif_status status = check_plans(a, b, err);
    if (status == DIF_OK)
        status = dif_maxima_find(b, &opts, &of_b, err);
    /* a maximum at b's floor may lie just below a's */
    opts.floor_share = 0.5 * floor_share;
    if (status == DIF_OK)
        status = dif_maxima_find(a, &opts, &of_a, err);
    if (status == DIF_OK)
        match(&of_a, &of_b, reach_of(&b->plan), out);
    dif_maxima_free(&of_a);
    dif_maxima_free(&of_b);
    return status;
}
