/* Speed of colour maps: 512 x 512 directions at 81 wavelengths by the sheet transform, against the direct sum measured on
 * a sample of the same directions in the same run.
 * usage: speed_map [--smallest] */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/map.h"
#include "bench/speed/speed.h"
#include "core/units.h"
#include "fixtures/surfaces.h"

enum { N_LAMBDA = 81 };

/* Pixel at a share of the mirror spot's neighbourhood, where amplitudes, and so their errors, are largest. */
static size_t mirror_pixel(const dif_map_plan *plan, double share)
{
    enum { SIDE = 9 };
    const int n = plan->n_pixel, at = (int)(share * SIDE * SIDE);
    const int ix = (int)(0.5 * n * (1.0 - plan->fixed.x)) + at % SIDE - SIDE / 2;
    const int iy = (int)(0.5 * n * (1.0 + plan->fixed.y)) + at / SIDE - SIDE / 2;
    return (size_t)iy * (size_t)n + (size_t)ix;
}

/* Largest amplitude error of n pixels of kept layers, spread by a golden-section stride over the disc and, every second
 * one, over the mirror spot. */
static double error_of(const dif_field *field, const dif_map_plan *plan, const dif_map *map,
                       const dif_measure_opts *opts, int n, double *direct_s)
{
    const size_t n_pixel = (size_t)plan->n_pixel, n_sample = n_pixel * n_pixel * (size_t)plan->n_lambda;
    dif_measure_opts direct = *opts;
    double worst = 0.0;
    *direct_s = 0.0;
    direct.method = DIF_METHOD_DIRECT;
    for (int i = 0, done = 0; done < n; i++) {
        const double turn = i * 0.6180339887498949;
        const double share = turn - floor(turn);
        const size_t any = (size_t)(share * (double)n_sample), il = any / (n_pixel * n_pixel);
        const size_t pixel = i % 2 ? mirror_pixel(plan, 37.0 * share - floor(37.0 * share)) : any % (n_pixel * n_pixel);
        const size_t at = il * n_pixel * n_pixel + pixel;
        dif_query query = {.wi = plan->fixed, .lambda_um = plan->lambda_um[il]};
        dif_sample truth;
        dif_measure_stats stats;
        dif_error err;
        if (!dif_map_direction(plan->n_pixel, (int)(pixel % n_pixel), (int)(pixel / n_pixel), &query.wo))
            continue;
        dif_speed_must(dif_measure_queries(field, 1, &query, 0.5, &direct, &truth, &stats, &err), &err);
        worst = fmax(worst, fabs(sqrt((double)map->layer[at]) - sqrt(truth.power)));
        *direct_s += stats.eval_wall_s / n;
        done++;
    }
    return worst;
}

static void run(const dif_field *field, dif_map_plan *plan, double tol, bool smallest)
{
    const size_t n = (size_t)plan->n_pixel * (size_t)plan->n_pixel * (size_t)plan->n_lambda;
    dif_measure_opts opts = dif_measure_opts_default();
    dif_measure_stats stats;
    dif_speed speed = {.n = 0};
    dif_error err;
    dif_map map;
    double direct_s;
    opts.quantity = DIF_QUANTITY_POWER;
    for (int i = -1; i < (smallest ? 1 : 5); i++) {
        dif_speed_must(dif_map_measure(field, plan, tol, &opts, &map, &stats, &err), &err);
        if (i >= 0)
            dif_speed_add(&speed, &stats);
        dif_map_free(&map);
    }
    plan->keep_layers = true;
    dif_speed_must(dif_map_measure(field, plan, tol, &opts, &map, &stats, &err), &err);
    const double worst = error_of(field, plan, &map, &opts, smallest ? 10 : 100, &direct_s);
    dif_map_free(&map);
    plan->keep_layers = false;
    dif_speed_print(&speed, "xenopeltis map", n, tol, worst, direct_s);
}

int main(int argc, char **argv)
{
    const bool smallest = argc > 1 && strcmp(argv[1], "--smallest") == 0;
    const double tols[] = {1e-4, 1e-6};
    double lambda_um[N_LAMBDA];
    dif_field field;
    for (int i = 0; i < N_LAMBDA; i++)
        lambda_um[i] = dif_um_from_nm(380.0 + 5.0 * i);
    dif_map_plan plan = {.fixed = dif_vec3_from_angles_rad(dif_rad_from_deg(30.0), dif_rad_from_deg(90.0)),
                         .n_pixel = smallest ? 32 : 512,
                         .n_lambda = smallest ? 5 : N_LAMBDA,
                         .lambda_um = lambda_um};
    dif_speed_surface("measured/xenopeltis_65um.png", 0.81869, DIF_SURFACE_XENOPELTIS, smallest ? 64 : 0, &field);
    dif_speed_header();
    for (int t = 0; t < 2; t++)
        run(&field, &plan, tols[t], smallest);
    fprintf(stderr, "peak memory %.0f MiB\n", dif_speed_peak_mib());
    dif_field_free(&field);
    return 0;
}
