/* A measured map against the direct sum on a random subset. */
#include <math.h>

#include "bench/map.h"
#include "bench/measure_impl.h"

/* splitmix64 in [0, n) */
static size_t random_below(unsigned long long *state, size_t n)
{
    unsigned long long z = (*state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return (size_t)((z ^ (z >> 31)) % n);
}

/* One pixel at one wavelength. */
static dif_status check_sample(const dif_field *field, const dif_map_plan *plan, const dif_map *map,
                               const dif_measure_opts *opts, size_t at, int il, dif_vec3 shown, dif_map_check *out,
                               dif_error *err)
{
    const size_t n = (size_t)plan->n_pixel * (size_t)plan->n_pixel;
    const dif_query query = {.wi = plan->fixed_is_wo ? shown : plan->fixed,
                             .wo = plan->fixed_is_wo ? plan->fixed : shown,
                             .lambda_um = plan->lambda_um[il]};
    dif_measure_opts direct = *opts;
    dif_measure_stats stats;
    dif_sample truth;
    direct.method = DIF_METHOD_DIRECT;
    direct.progress = NULL;
    const dif_status status = dif_measure_queries(field, 1, &query, 0.5, &direct, &truth, &stats, err);
    if (status != DIF_OK)
        return status;
    double gain = 1.0; /* the source's program has none */
    if (opts->method != DIF_METHOD_THESIS)
        gain = dif_brdf_gain(opts->quantity, opts->index, query.wi, query.wo, query.lambda_um, stats.area_um2) *
               dif_measure_shadowing(opts, opts->quantity, query.wi, query.wo);
    const double value = (double)map->layer[(size_t)il * n + at], error = fabs(sqrt(value / gain) - sqrt(truth.power));
    out->direct_s_per_sample += stats.eval_wall_s;
    if (out->n_sample++ > 0 && error <= out->worst_amplitude)
        return DIF_OK;
    out->worst_amplitude = error;
    out->worst_at = shown;
    out->worst_lambda_um = query.lambda_um;
    out->worst_value = value;
    out->worst_direct = gain * truth.power;
    return DIF_OK;
}

dif_status dif_map_check_layers(const dif_field *field, const dif_map_plan *plan, const dif_map *map,
                                const dif_measure_opts *opts, int n, unsigned seed, dif_map_check *out, dif_error *err)
{
    unsigned long long state = seed;
    const size_t n_pixel = (size_t)plan->n_pixel;
    *out = (dif_map_check){0};
    if (n < 1)
        return dif_fail(err, DIF_ERR_ARG, "%d samples to check, want >= 1", n);
    if (!map->layer)
        return dif_fail(err, DIF_ERR_ARG, "a map without layers cannot be checked");
    while (out->n_sample < n) {
        const size_t at = random_below(&state, n_pixel * n_pixel);
        const int il = (int)random_below(&state, (size_t)plan->n_lambda);
        dif_vec3 shown;
        if (!dif_map_direction(plan->n_pixel, (int)(at % n_pixel), (int)(at / n_pixel), &shown))
            continue;
        const dif_status status = check_sample(field, plan, map, opts, at, il, shown, out, err);
        if (status != DIF_OK)
            return status;
    }
    out->direct_s_per_sample /= n;
    return DIF_OK;
}
