/* BRDF maps: every outgoing direction in direction-cosine space for one incident direction (or the reverse), as colour
 * and, if wanted, as spectral layers.
 * Does not: open files, draw. */
#ifndef DIF_MAP_H
#define DIF_MAP_H

#include "bench/measure.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { DIF_MAP_PIXEL_MIN = 16, DIF_MAP_PIXEL_MAX = 4096 };

typedef struct dif_map_plan {
    bool fixed_is_wo;        /* false: wi is fixed and the map shows wo; true: the reverse                 */
    dif_vec3 fixed;          /* unit, z > 0                                                                */
    int n_pixel;             /* pixels across the unit disc, DIF_MAP_PIXEL_MIN ... DIF_MAP_PIXEL_MAX       */
    int n_lambda;            /* >= 1                                                                       */
    const double *lambda_um; /* ascending; borrowed                                                     */
    bool keep_layers;        /* also keep the value at each wavelength                                     */
} dif_map_plan;

/* Row 0 at the top (y up), x to the right: pixel (ix, iy) looks along
 *   x = (2 ix + 1) / n - 1,  y = 1 - (2 iy + 1) / n;  outside the unit disc everything is 0. */
typedef struct dif_map {
    int n_pixel, n_lambda;
    float *xyz;   /* xyz[n_pixel * n_pixel][3], the spectrum of the quantity under D65 (core/spectrum.h), owned */
    float *layer; /* layer[n_lambda][n_pixel * n_pixel] or NULL, owned                                         */
} dif_map;

/* Measures a map.
 *
 * Given     tol  wanted |amplitude error| / sum W, as for tables
 *           opts any method; sheet is the fast one, the others are read pixel by pixel
 * Status    DIF_ERR_ARG, DIF_ERR_TOL, DIF_ERR_SIZE, DIF_ERR_NOMEM, DIF_ERR_FOREIGN, DIF_ERR_UNSUPPORTED (layers by
 *           nmm, brdf by thesis); *out zeroed on failure
 * Owns      the caller frees with dif_map_free */
DIF_MUST_USE dif_status dif_map_measure(const dif_field *field, const dif_map_plan *plan, double tol,
                                        const dif_measure_opts *opts, dif_map *out, dif_measure_stats *stats,
                                        dif_error *err);
void dif_map_free(dif_map *map);

/* The direction that pixel (ix, iy) looks along; false outside the disc. */
bool dif_map_direction(int n_pixel, int ix, int iy, dif_vec3 *out);

/* A measured map with layers against the direct sum of the surface, whatever the method. */
typedef struct dif_map_check {
    int n_sample;
    double worst_amplitude; /* largest | |P| - |P_direct| | / sum W    */
    dif_vec3 worst_at;      /* where: the direction that the map shows */
    double worst_lambda_um;
    double worst_value, worst_direct; /* both values, in the map's quantity      */
    double direct_s_per_sample;       /* wall seconds                            */
} dif_map_check;

/* Compares n random pixels inside the disc, each at a random wavelength (seeded). Status DIF_ERR_ARG: no layers, n < 1. */
DIF_MUST_USE dif_status dif_map_check_layers(const dif_field *field, const dif_map_plan *plan, const dif_map *map,
                                             const dif_measure_opts *opts, int n, unsigned seed, dif_map_check *out,
                                             dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
