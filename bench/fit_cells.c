#include "bench/fit_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"
#include "core/units.h"

double dif_fit_view_power(const dif_fit_view *view, int i_lambda, int i_angle)
{
    const dif_table *t = view->table;
    const double value = t->value[(size_t)i_lambda * (size_t)t->plan.n_angle + (size_t)i_angle];
    const double lambda = t->plan.lambda_um[i_lambda];
    /* the gain of a BRDF goes as 1/lambda^2, the others do not depend on the wavelength */
    return value * view->ungain[i_angle] * (t->quantity == DIF_QUANTITY_BRDF ? lambda * lambda : 1.0) / view->y_max;
}

static void fill_angles(dif_fit_view *view, dif_index index)
{
    const dif_plan *plan = &view->table->plan;
    for (int i = 0; i < plan->n_angle; i++) {
        dif_vec3 wi, wo;
        dif_plan_directions(plan, i, &wi, &wo);
        dif_plan_transfer(plan, i, &view->sin_sum[i], &view->cos_sum[i]);
        view->sin_run[i] = sin(plan->angle_rad[i]);
        view->cos_run[i] = cos(plan->angle_rad[i]);
        /* area and wavelength 1: only the shape over angles matters here */
        view->ungain[i] = 1.0 / dif_brdf_gain(view->table->quantity, index, wi, wo, 1.0, 1.0);
    }
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static dif_status median_step(dif_fit_view *view, dif_error *err)
{
    const dif_plan *plan = &view->table->plan;
    const int n = plan->n_angle - 1;
    double *step = dif_alloc((size_t)n, sizeof *step);
    if (!step)
        return dif_fail(err, DIF_ERR_NOMEM, "steps of %d angles", n);
    for (int i = 0; i < n; i++)
        step[i] = fabs(view->sin_sum[i + 1] - view->sin_sum[i]);
    qsort(step, (size_t)n, sizeof *step, by_value);
    view->f_step = step[n / 2] / plan->lambda_um[plan->n_lambda / 2];
    dif_release(step);
    return DIF_OK;
}

/* Largest power, extent in f, and whether there is anything to see. */
static dif_status survey(dif_fit_view *view, dif_error *err)
{
    const dif_plan *plan = &view->table->plan;
    double low = INFINITY, high = -INFINITY;
    view->f_low = INFINITY;
    view->f_high = -INFINITY;
    view->y_max = 1.0;
    for (int il = 0; il < plan->n_lambda; il++) {
        size_t n_row = 0;
        for (int ia = 0; ia < plan->n_angle; ia++) {
            const double y = dif_fit_view_power(view, il, ia), f = view->sin_sum[ia] / plan->lambda_um[il];
            if (!isfinite(y))
                continue;
            n_row++;
            low = fmin(low, y);
            high = fmax(high, y);
            view->f_low = fmin(view->f_low, f);
            view->f_high = fmax(view->f_high, f);
        }
        view->n_valid += n_row;
        view->n_lambda_valid += n_row > 0;
    }
    if (view->n_valid == 0)
        return dif_fail(err, DIF_ERR_FIT, "the table holds no measured value");
    if (!(high > 0.0))
        return dif_fail(err, DIF_ERR_FIT, "the table holds no positive value");
    if (!(high - low > 1e-12 * high) || !(view->f_high > view->f_low))
        return dif_fail(err, DIF_ERR_FIT, "the table is constant: no ridge to fit");
    view->y_max = high;
    return DIF_OK;
}

static dif_status check_table(const dif_table *table, dif_error *err)
{
    if (!table || !table->value)
        return dif_fail(err, DIF_ERR_ARG, "no table to fit");
    dif_status status = dif_plan_check(&table->plan, err);
    if (status != DIF_OK)
        return status;
    if (table->plan.n_angle < 3)
        return dif_fail(err, DIF_ERR_FIT, "%d angles, want at least 3", table->plan.n_angle);
    for (int i = 1; i < table->plan.n_angle; i++)
        if (!(table->plan.angle_rad[i] > table->plan.angle_rad[i - 1]))
            return dif_fail(err, DIF_ERR_ARG, "angles do not increase at cell %d", i);
    for (int i = 1; i < table->plan.n_lambda; i++)
        if (!(table->plan.lambda_um[i] > table->plan.lambda_um[i - 1]))
            return dif_fail(err, DIF_ERR_ARG, "wavelengths do not increase at row %d", i);
    return DIF_OK;
}

dif_status dif_fit_view_create(const dif_table *table, dif_index index, dif_fit_view *out, dif_error *err)
{
    *out = (dif_fit_view){0};
    dif_status status = check_table(table, err);
    if (status != DIF_OK)
        return status;
    const size_t n = (size_t)table->plan.n_angle;
    double *block = dif_alloc(5 * n, sizeof *block);
    if (!block)
        return dif_fail(err, DIF_ERR_NOMEM, "view of %zu angles", n);
    *out = (dif_fit_view){.table = table, .sin_sum = block, .cos_sum = block + n, .sin_run = block + 2 * n};
    out->cos_run = block + 3 * n;
    out->ungain = block + 4 * n;
    fill_angles(out, index);
    status = survey(out, err);
    if (status == DIF_OK)
        status = median_step(out, err);
    if (status != DIF_OK)
        dif_fit_view_free(out);
    return status;
}

void dif_fit_view_free(dif_fit_view *view)
{
    if (!view)
        return;
    dif_release(view->sin_sum);
    *view = (dif_fit_view){0};
}

enum { N_ROW_MIN = 40 };

/* Cells of one wavelength as they are met. */
typedef struct picker {
    const dif_fit_view *view;
    const dif_fit_selection *s;
    int stride[DIF_FIT_RIDGE_MAX]; /* of the wavelengths, per group */
    dif_fit_cell *out;             /* NULL: only count              */
    int n, n_group[DIF_FIT_RIDGE_MAX];
    int n_row[DIF_FIT_RIDGE_MAX], last_row[DIF_FIT_RIDGE_MAX]; /* wavelengths seen */
} picker;

static int group_of(const dif_fit_selection *s, double f)
{
    for (int g = 0; g < s->n_group; g++)
        if (f >= s->group[g].f_low && f <= s->group[g].f_high)
            return g;
    return -1;
}

static void pick(picker *p, int il, int ia, int group)
{
    if (p->out) {
        const double lambda = p->view->table->plan.lambda_um[il];
        dif_fit_cell *c = &p->out[p->n];
        *c = (dif_fit_cell){.group = group, .i_angle = ia, .i_lambda = il};
        c->f_per_um = p->view->sin_sum[ia] / lambda;
        c->kz_rad_per_um = DIF_TWO_PI * p->view->cos_sum[ia] / lambda;
        c->y = dif_fit_view_power(p->view, il, ia);
        c->turn_s = p->view->sin_run[ia] / lambda;
        c->turn_c = p->view->cos_run[ia] / lambda;
    }
    p->n++;
    p->n_group[group]++;
    p->n_row[group] += p->last_row[group] != il;
    p->last_row[group] = il;
}

/* Takes each cell that is at least a step from the last one taken. The cells "between" are those half a step later. */
static void pick_row(picker *p, int il)
{
    const double lambda = p->view->table->plan.lambda_um[il];
    const int n_angle = p->view->table->plan.n_angle;
    double last = -INFINITY;
    bool half_due = false;
    for (int ia = 0; ia < n_angle; ia++) {
        const double f = p->view->sin_sum[ia] / lambda;
        const int group = group_of(p->s, f);
        /* between: rows half way as well, if rows are left out */
        if (group < 0 || (il + (p->s->between ? p->stride[group] / 2 : 0)) % p->stride[group] != 0)
            continue;
        if (!isfinite(dif_fit_view_power(p->view, il, ia)))
            continue;
        if (f - last >= p->s->step_per_um) {
            last = f;
            half_due = true;
            if (!p->s->between)
                pick(p, il, ia, group);
        } else if (p->s->between && half_due && f - last >= 0.5 * p->s->step_per_um) {
            half_due = false;
            pick(p, il, ia, group);
        }
    }
}

static void pick_all(picker *p)
{
    p->n = 0;
    for (int g = 0; g < p->s->n_group; g++) {
        p->n_group[g] = 0;
        p->n_row[g] = 0;
        p->last_row[g] = -1;
    }
    for (int il = 0; il < p->view->table->plan.n_lambda; il++)
        pick_row(p, il);
}

/* A group that has more than its share of cells gives up wavelengths, but keeps enough of them for its bands. */
static void set_strides(picker *p)
{
    const int share = p->s->n_max / p->s->n_group;
    for (int g = 0; g < p->s->n_group; g++) {
        const int wanted = (p->n_group[g] + share - 1) / share, most = p->n_row[g] / N_ROW_MIN;
        p->stride[g] = wanted < most ? wanted : most;
        p->stride[g] = p->stride[g] > 1 ? p->stride[g] : 1;
    }
}

dif_status dif_fit_view_select(const dif_fit_view *view, const dif_fit_selection *selection, dif_fit_cell **out, int *n,
                               dif_error *err)
{
    picker p = {.view = view, .s = selection};
    *out = NULL;
    *n = 0;
    for (int g = 0; g < selection->n_group; g++)
        p.stride[g] = 1;
    pick_all(&p);
    set_strides(&p);
    pick_all(&p);
    if (p.n == 0)
        return DIF_OK;
    p.out = dif_alloc((size_t)p.n, sizeof *p.out);
    if (!p.out)
        return dif_fail(err, DIF_ERR_NOMEM, "%d cells", p.n);
    pick_all(&p);
    *out = p.out;
    *n = p.n;
    return DIF_OK;
}
