/* Speed of arbitrary directions: 700 000 random queries through the volume form, against the direct sum.
 * usage: speed_eval [--smallest] */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/speed/speed.h"
#include "core/alloc.h"
#include "core/units.h"
#include "fixtures/surfaces.h"

static double random_unit(unsigned long long *state)
{
    unsigned long long z = (*state += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Directions uniform in the projected hemisphere, wavelengths uniform in 380 ... 780 nm. */
static void fill_queries(size_t n, dif_query *query)
{
    unsigned long long state = 1;
    for (size_t i = 0; i < n; i++) {
        const double ri = asin(0.99 * sqrt(random_unit(&state))), ro = asin(0.99 * sqrt(random_unit(&state)));
        query[i].wi = dif_vec3_from_angles_rad(ri, DIF_TWO_PI * random_unit(&state));
        query[i].wo = dif_vec3_from_angles_rad(ro, DIF_TWO_PI * random_unit(&state));
        query[i].lambda_um = 0.38 + 0.4 * random_unit(&state);
    }
}

/* Largest amplitude difference between the first n samples and the direct sum; seconds per direct sample. */
static double error_of(const dif_field *field, size_t n, const dif_query *query, const dif_sample *sample,
                       const dif_measure_opts *opts, double *direct_s)
{
    dif_sample *truth = dif_alloc(n, sizeof *truth);
    dif_measure_opts direct = *opts;
    dif_measure_stats stats;
    dif_error err;
    double worst = 0.0;
    direct.method = DIF_METHOD_DIRECT;
    dif_speed_must(dif_measure_queries(field, n, query, 0.5, &direct, truth, &stats, &err), &err);
    for (size_t i = 0; i < n; i++)
        worst = fmax(worst, hypot(sample[i].amp_re - truth[i].amp_re, sample[i].amp_im - truth[i].amp_im));
    *direct_s = stats.eval_wall_s / (double)n;
    dif_release(truth);
    return worst;
}

int main(int argc, char **argv)
{
    const bool smallest = argc > 1 && strcmp(argv[1], "--smallest") == 0;
    const size_t n = smallest ? 500 : 700000;
    const double tols[] = {1e-6, 1e-3, 1e-9};
    dif_measure_opts opts = dif_measure_opts_default();
    dif_field field;
    dif_error err;
    dif_query *query = dif_alloc(n, sizeof *query);
    dif_sample *sample = dif_alloc(n, sizeof *sample);
    dif_speed_surface("measured/xenopeltis_65um.png", 0.81869, DIF_SURFACE_XENOPELTIS, smallest ? 64 : 0, &field);
    fill_queries(n, query);
    dif_speed_header();
    for (int t = 0; t < 3; t++) {
        dif_speed speed = {.n = 0};
        dif_measure_stats stats = {0};
        double direct_s;
        for (int i = -1; i < (smallest ? 1 : 5); i++) {
            dif_speed_must(dif_measure_queries(&field, n, query, tols[t], &opts, sample, &stats, &err), &err);
            if (i >= 0)
                dif_speed_add(&speed, &stats);
        }
        const double worst = error_of(&field, smallest ? 20 : 200, query, sample, &opts, &direct_s);
        dif_speed_print(&speed, "xenopeltis queries", n, tols[t], worst, direct_s);
    }
    fprintf(stderr, "peak memory %.0f MiB\n", dif_speed_peak_mib());
    dif_release(query);
    dif_release(sample);
    dif_field_free(&field);
    return 0;
}
