#include "bench/maxima.h"

#include <math.h>

#include "core/alloc.h"

dif_maxima_opts dif_maxima_opts_default(void)
{
    return (dif_maxima_opts){.floor_share = 0.01, .period_um = NAN};
}

/* One wavelength of a table. */
typedef struct row {
    const dif_plan *plan;
    const double *value; /* value[plan->n_angle] */
    double lambda_um;
} row;

/* Order numbers beyond this are no diffraction orders any more, and would not fit an int. */
static const double order_limit = 1e6;

/* sin theta_i + sin theta_o at a running angle that may lie between two cells. */
static double sin_sum_at(const dif_plan *plan, double angle_rad)
{
    return sin(plan->fixed_rad) + sin(angle_rad);
}

/* The nearest order of the given period, how far the maximum is from it, and the period it speaks for. */
static void assign_order(const dif_plan *plan, double period_um, dif_maximum *m)
{
    m->order = 0;
    m->residual_rad = NAN;
    m->period_um = NAN;
    const double place = m->sin_sum * period_um / m->lambda_um;
    if (!(fabs(place) < order_limit))
        return;
    m->order = (int)lround(place);
    const double sin_order = m->order * m->lambda_um / period_um - sin(plan->fixed_rad);
    if (fabs(sin_order) <= 1.0)
        m->residual_rad = m->angle_rad - asin(sin_order);
    if (m->order != 0)
        m->period_um = m->order * m->lambda_um / m->sin_sum;
}

/* Vertex of the parabola through three points of any spacing; the middle point is the highest of them. */
static void parabola_vertex(const double x[3], const double y[3], double *x_top, double *y_top)
{
    const double left = (y[1] - y[0]) / (x[1] - x[0]), right = (y[2] - y[1]) / (x[2] - x[1]);
    const double curvature = (right - left) / (x[2] - x[0]);
    *x_top = x[1];
    *y_top = y[1];
    if (!(curvature < 0.0))
        return;
    /* y = y1 + slope (x - x1) + curvature (x - x1)^2, slope = left + curvature (x1 - x0) */
    const double slope = left + curvature * (x[1] - x[0]);
    *x_top = x[1] - 0.5 * slope / curvature;
    *y_top = y[1] - 0.25 * slope * slope / curvature;
}

/* The maximum on cells first ... last, which hold equal values (a plateau) or are one cell. */
static dif_maximum maximum_of(const row *r, int first, int last, double period_um)
{
    const double *angle = r->plan->angle_rad;
    dif_maximum m = {.lambda_um = r->lambda_um, .value = r->value[first]};
    m.angle_rad = 0.5 * (angle[first] + angle[last]);
    m.at_edge = first == 0 || last == r->plan->n_angle - 1;
    if (first == last && !m.at_edge && isfinite(r->value[first - 1]) && isfinite(r->value[first + 1]))
        parabola_vertex(angle + first - 1, r->value + first - 1, &m.angle_rad, &m.value);
    m.sin_sum = sin_sum_at(r->plan, m.angle_rad);
    assign_order(r->plan, period_um, &m);
    return m;
}

/* Last cell of the run of equal values that begins at i. */
static int plateau_end(const row *r, int i)
{
    while (i + 1 < r->plan->n_angle && r->value[i + 1] == r->value[i])
        i++;
    return i;
}

/* A run is a maximum if both neighbours are lower; a cell that was not measured is no neighbour. */
static bool is_maximum(const row *r, int first, int last)
{
    if (first == 0 || last == r->plan->n_angle - 1)
        return false;
    return r->value[first - 1] < r->value[first] && r->value[last + 1] < r->value[first];
}

/* Index of the largest value of a row, -1 if nothing was measured. */
static int largest_cell(const row *r)
{
    int best = -1;
    for (int i = 0; i < r->plan->n_angle; i++)
        if (isfinite(r->value[i]) && (best < 0 || r->value[i] > r->value[best]))
            best = i;
    return best;
}

/* Appends the maxima of one wavelength; item NULL only counts. The largest value of the wavelength is always kept: if
 * it is no maximum (an edge, a flat row, beside a hole), with at_edge set. */
static int row_maxima(const row *r, double floor_value, double period_um, dif_maximum *item)
{
    const int best = largest_cell(r);
    int n = 0;
    if (best < 0)
        return 0;
    for (int i = 0; i < r->plan->n_angle; i++) {
        if (!isfinite(r->value[i]))
            continue;
        const int last = plateau_end(r, i);
        const bool holds_best = i <= best && best <= last;
        const bool maximum = is_maximum(r, i, last);
        if (holds_best || (maximum && r->value[i] >= floor_value)) {
            if (item) {
                item[n] = maximum_of(r, i, last, period_um);
                item[n].is_global = holds_best;
                item[n].at_edge = !maximum;
            }
            n++;
        }
        i = last;
    }
    return n;
}

static double table_largest(const dif_table *table)
{
    const size_t n = (size_t)table->plan.n_angle * (size_t)table->plan.n_lambda;
    double largest = -INFINITY;
    for (size_t i = 0; i < n; i++)
        if (isfinite(table->value[i]) && table->value[i] > largest)
            largest = table->value[i];
    return largest;
}

/* All rows; item NULL only counts. */
static size_t table_maxima(const dif_table *table, const dif_maxima_opts *opts, dif_maximum *item)
{
    const double floor_value = opts->floor_share * table_largest(table);
    size_t n = 0;
    for (int il = 0; il < table->plan.n_lambda; il++) {
        const row r = {.plan = &table->plan,
                       .value = table->value + (size_t)il * (size_t)table->plan.n_angle,
                       .lambda_um = table->plan.lambda_um[il]};
        n += (size_t)row_maxima(&r, floor_value, opts->period_um, item ? item + n : NULL);
    }
    return n;
}

dif_status dif_maxima_find(const dif_table *table, const dif_maxima_opts *opts, dif_maxima *out, dif_error *err)
{
    const dif_maxima_opts o = opts ? *opts : dif_maxima_opts_default();
    *out = (dif_maxima){0};
    if (!table || !table->value)
        return dif_fail(err, DIF_ERR_ARG, "no table to look for maxima in");
    if (!(o.floor_share >= 0.0 && o.floor_share < 1.0))
        return dif_fail(err, DIF_ERR_ARG, "floor_share = %g, want 0 <= floor_share < 1", o.floor_share);
    if (!isnan(o.period_um) && !(o.period_um > 0.0 && isfinite(o.period_um)))
        return dif_fail(err, DIF_ERR_ARG, "period = %g um, want a positive number", o.period_um);
    for (int i = 1; i < table->plan.n_angle; i++)
        if (!(table->plan.angle_rad[i] > table->plan.angle_rad[i - 1]))
            return dif_fail(err, DIF_ERR_ARG, "angles do not increase at cell %d", i);
    const size_t n = table_maxima(table, &o, NULL);
    if (n > (size_t)1 << 30)
        return dif_fail(err, DIF_ERR_ARG, "more maxima than an int counts");
    dif_maximum *item = dif_alloc(n, sizeof *item);
    if (!item)
        return dif_fail(err, DIF_ERR_NOMEM, "%zu maxima", n);
    table_maxima(table, &o, item);
    *out = (dif_maxima){.n = (int)n, .item = item};
    return DIF_OK;
}

void dif_maxima_free(dif_maxima *maxima)
{
    if (!maxima)
        return;
    dif_release(maxima->item);
    *maxima = (dif_maxima){0};
}

/* Mean and standard deviation as they come, without a second pass (Welford). */
typedef struct running {
    int n;
    double mean, m2;
} running;

static void running_add(running *r, double x)
{
    r->n++;
    const double step = x - r->mean;
    r->mean += step / r->n;
    r->m2 += step * (x - r->mean);
}

static double running_sd(const running *r)
{
    return r->n > 1 ? sqrt(r->m2 / (r->n - 1)) : (double)NAN;
}

dif_maxima_period dif_maxima_first_order(const dif_maxima *maxima)
{
    dif_maxima_period p = {.mean_um = NAN, .sd_um = NAN, .min_um = NAN, .max_um = NAN};
    running r = {0};
    for (int i = 0; i < maxima->n; i++) {
        const dif_maximum *m = &maxima->item[i];
        if (!m->is_global || m->sin_sum == 0.0)
            continue;
        const double period_um = m->lambda_um / fabs(m->sin_sum);
        running_add(&r, period_um);
        p.min_um = fmin(p.min_um, period_um);
        p.max_um = fmax(p.max_um, period_um);
    }
    if (r.n == 0)
        return p;
    p.n = r.n;
    p.mean_um = r.mean;
    p.sd_um = running_sd(&r);
    return p;
}

/* Statistics of one order over the maxima that have a residual; edges are not maxima. */
static dif_maxima_order order_statistics(const dif_maxima *maxima, int order)
{
    dif_maxima_order s = {.order = order, .period_mean_um = NAN, .period_sd_um = NAN};
    running residual = {0}, period = {0};
    double sum_squares = 0.0;
    for (int i = 0; i < maxima->n; i++) {
        const dif_maximum *m = &maxima->item[i];
        if (m->order != order || m->at_edge || isnan(m->residual_rad))
            continue;
        running_add(&residual, m->residual_rad);
        sum_squares += m->residual_rad * m->residual_rad;
        if (fabs(m->residual_rad) > fabs(s.worst_rad))
            s.worst_rad = m->residual_rad;
        if (order != 0)
            running_add(&period, m->period_um);
    }
    s.n = residual.n;
    if (s.n == 0)
        return s;
    s.mean_rad = residual.mean;
    s.rms_rad = sqrt(sum_squares / s.n);
    if (order != 0) {
        s.period_mean_um = period.mean;
        s.period_sd_um = running_sd(&period);
    }
    return s;
}

/* Smallest order above `below` that some maximum has; false if there is none. */
static bool next_order(const dif_maxima *maxima, bool any, int below, int *order)
{
    bool found = false;
    for (int i = 0; i < maxima->n; i++) {
        const dif_maximum *m = &maxima->item[i];
        if (m->at_edge || isnan(m->residual_rad) || (any && m->order <= below))
            continue;
        if (!found || m->order < *order)
            *order = m->order;
        found = true;
    }
    return found;
}

int dif_maxima_by_order(const dif_maxima *maxima, int n_out_max, dif_maxima_order *out)
{
    int n = 0, last = 0, order = 0;
    while (next_order(maxima, n > 0, last, &order)) {
        if (n < n_out_max)
            out[n] = order_statistics(maxima, order);
        last = order;
        n++;
    }
    return n;
}
