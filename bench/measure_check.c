/* A measured table against the direct sum on a random subset. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <time.h>

#include "bench/measure_impl.h"
#include "core/alloc.h"
#include "core/units.h"

/* splitmix64: small, seeded, the same everywhere. */
static unsigned long long random_next(unsigned long long *state)
{
    unsigned long long z = (*state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
}

static void note_cell(const dif_table *table, size_t cell, const dif_measure_opts *opts, double area_um2,
                      const dif_query *query, const dif_sample *direct, dif_measure_check *out)
{
    const dif_plan *plan = &table->plan;
    double gain = 1.0; /* the source's program has none */
    if (opts->method != DIF_METHOD_THESIS)
        gain = dif_brdf_gain(table->quantity, opts->index, query->wi, query->wo, query->lambda_um, area_um2) *
               dif_measure_shadowing(opts, table->quantity, query->wi, query->wo);
    const double amplitude = sqrt(table->value[cell] / gain), error = fabs(amplitude - sqrt(direct->power));
    if (error <= out->worst_amplitude && out->n_sample > 0)
        return;
    out->worst_amplitude = error;
    out->worst_angle_deg = dif_deg_from_rad(plan->angle_rad[cell % (size_t)plan->n_angle]);
    out->worst_lambda_nm = dif_nm_from_um(query->lambda_um);
    out->worst_value = table->value[cell];
    out->worst_direct = gain * direct->power;
}

dif_status dif_measure_check_table(const dif_field *field, const dif_table *table, const dif_measure_opts *opts, int n,
                                   unsigned seed, dif_measure_check *out, dif_error *err)
{
    const dif_plan *plan = &table->plan;
    const size_t n_cell = (size_t)plan->n_angle * (size_t)plan->n_lambda;
    unsigned long long state = seed;
    *out = (dif_measure_check){0};
    if (n < 1)
        return dif_fail(err, DIF_ERR_ARG, "%d cells to check, want >= 1", n);
    size_t *cell = dif_alloc((size_t)n, sizeof *cell);
    dif_query *query = dif_alloc((size_t)n, sizeof *query);
    dif_sample *sample = dif_alloc((size_t)n, sizeof *sample);
    const dif_measure_opts own = opts ? *opts : dif_measure_opts_default();
    dif_measure_opts direct = own;
    dif_measure_stats stats;
    direct.method = DIF_METHOD_DIRECT;
    direct.progress = NULL;
    dif_status status = cell && query && sample ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for %d cells", n);
    for (int i = 0; i < n && status == DIF_OK; i++) {
        cell[i] = (size_t)(random_next(&state) % n_cell);
        dif_plan_directions(plan, (int)(cell[i] % (size_t)plan->n_angle), &query[i].wi, &query[i].wo);
        query[i].lambda_um = plan->lambda_um[cell[i] / (size_t)plan->n_angle];
    }
    if (status == DIF_OK)
        status = dif_measure_queries(field, (size_t)n, query, 0.5, &direct, sample, &stats, err);
    for (int i = 0; i < n && status == DIF_OK; i++, out->n_sample++)
        note_cell(table, cell[i], &own, stats.area_um2, query + i, sample + i, out);
    if (status == DIF_OK)
        out->direct_s_per_sample = stats.eval_wall_s / n;
    dif_release(cell);
    dif_release(query);
    dif_release(sample);
    return status;
}
