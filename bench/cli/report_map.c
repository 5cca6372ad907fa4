/* The BRDF map of a report's surface, and the pictures that maps become. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/io/map_io.h"
#include "core/units.h"

enum { MAP_PIXEL = 512, MAP_PIXEL_AVERAGED = 384 };
static const double map_tol = 1e-4, map_theta_deg = 30.0, map_step_nm = 5.0;
static const double mirror_radius = 0.1; /* in direction cosines: the mirror beam and its surroundings        */
static const double white_share = 0.25;  /* of the light beside it lies in pixels that the exposure makes white */
static const double level_decades = 6.0; /* of the luminance picture                                           */

/* 380 nm and up; the caller releases. NULL = out of memory. */
static double *wavelengths(int n, double step_nm)
{
    double *lambda_um = dif_alloc((size_t)n, sizeof *lambda_um);
    for (int i = 0; i < n && lambda_um; i++)
        lambda_um[i] = dif_um_from_nm(380.0 + i * step_nm);
    return lambda_um;
}

dif_status dif_report_map_make(const dif_field *field, const dif_measure_opts *opts, double theta_i_rad,
                               double azimuth_rad, int n_pixel, double step_nm, double tol, dif_map *out,
                               dif_measure_stats *stats, dif_error *err)
{
    const int n_lambda = (int)floor(400.0 / step_nm * (1.0 + 1e-12)) + 1;
    dif_measure_opts own = *opts;
    own.quantity = DIF_QUANTITY_RHO;
    *out = (dif_map){0};
    double *lambda_um = wavelengths(n_lambda, step_nm);
    if (!lambda_um)
        return dif_fail(err, DIF_ERR_NOMEM, "%d wavelengths", n_lambda);
    const dif_map_plan plan = {.fixed = dif_vec3_from_angles_rad(theta_i_rad, azimuth_rad),
                               .n_pixel = n_pixel,
                               .n_lambda = n_lambda,
                               .lambda_um = lambda_um};
    const dif_status status = dif_map_measure(field, &plan, tol, &own, out, stats, err);
    dif_release(lambda_um);
    return status;
}

static int brighter_first(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return (x < y) - (x > y);
}

dif_status dif_report_map_exposure(const dif_map *map, double theta_i_rad, double azimuth_rad, double *exposure,
                                   dif_error *err)
{
    const size_t n = (size_t)map->n_pixel * (size_t)map->n_pixel;
    const dif_vec3 wi = dif_vec3_from_angles_rad(theta_i_rad, azimuth_rad);
    float *y = dif_alloc(n, sizeof *y);
    if (!y)
        return dif_fail(err, DIF_ERR_NOMEM, "exposure of %zu pixels", n);
    size_t m = 0;
    double sum = 0.0, reached = 0.0;
    for (size_t i = 0; i < n; i++) {
        dif_vec3 wo;
        if (!dif_map_direction(map->n_pixel, (int)(i % (size_t)map->n_pixel), (int)(i / (size_t)map->n_pixel), &wo) ||
            hypot(wo.x + wi.x, wo.y + wi.y) < mirror_radius)
            continue;
        y[m] = map->xyz[3 * i + 1];
        sum += (double)y[m++];
    }
    qsort(y, m, sizeof *y, brighter_first);
    size_t i = 0;
    while (i < m && reached < white_share * sum)
        reached += (double)y[i++];
    const double white = i > 0 ? (double)y[i - 1] : 0.0;
    dif_release(y);
    *exposure = white > 0.0 ? 1.0 / white : 1.0;
    return DIF_OK;
}

double dif_report_map_peak(const dif_map *map)
{
    const size_t n = (size_t)map->n_pixel * (size_t)map->n_pixel;
    float peak = 0.0f;
    for (size_t i = 0; i < n; i++)
        peak = fmaxf(peak, map->xyz[3 * i + 1]);
    return (double)peak;
}

/* Share of the shown pixels (a hundredth of white and more) whose colour sRGB does not hold. */
static double outside_gamut(const dif_map *map, double exposure)
{
    const size_t n = (size_t)map->n_pixel * (size_t)map->n_pixel;
    size_t n_shown = 0, n_outside = 0;
    for (size_t i = 0; i < n; i++) {
        const double xyz[3] = {(double)map->xyz[3 * i], (double)map->xyz[3 * i + 1], (double)map->xyz[3 * i + 2]};
        double rgb[3];
        if (!(exposure * xyz[1] > 0.01))
            continue;
        dif_colour_rgb_from_xyz(xyz, rgb);
        n_shown++;
        n_outside += fmin(rgb[0], fmin(rgb[1], rgb[2])) < 0.0;
    }
    return n_shown > 0 ? (double)n_outside / (double)n_shown : 0.0;
}

dif_status dif_report_map(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    dif_report_map_data *out = &data->map;
    dif_measure_opts opts = job->opts;
    dif_measure_stats stats;
    opts.method = DIF_METHOD_SHEET;
    *out = (dif_report_map_data){.theta_i_rad = dif_rad_from_deg(map_theta_deg),
                                 .azimuth_rad = job->plan.azimuth_rad,
                                 .tol = map_tol,
                                 .step_nm = map_step_nm,
                                 .gamut = DIF_GAMUT_DESATURATE};
    /* averaged speckle is smooth, single windows have sharp lines */
    const int n_pixel = opts.average == DIF_AVERAGE_WELCH ? MAP_PIXEL_AVERAGED : MAP_PIXEL;
    dif_status status = dif_report_map_make(&job->field, &opts, out->theta_i_rad, out->azimuth_rad, n_pixel,
                                            map_step_nm, map_tol, &out->map, &stats, err);
    if (status == DIF_OK)
        status = dif_report_map_exposure(&out->map, out->theta_i_rad, out->azimuth_rad, &out->exposure, err);
    if (status != DIF_OK)
        return status;
    out->bound = stats.bound;
    out->n_window = stats.n_window;
    out->outside_gamut = outside_gamut(&out->map, out->exposure);
    return DIF_OK;
}

/* Colours of a map, encoded. */
static void paint_colours(const dif_map *map, double exposure, dif_gamut gamut, uint8_t *rgb)
{
    const size_t n = (size_t)map->n_pixel * (size_t)map->n_pixel;
    for (size_t i = 0; i < n; i++) {
        const double xyz[3] = {(double)map->xyz[3 * i], (double)map->xyz[3 * i + 1], (double)map->xyz[3 * i + 2]};
        dif_colour_pixel(xyz, exposure, gamut, rgb + 3 * i);
    }
}

/* Luminance on the page's colour map, logarithmic below the brightest pixel. */
static dif_status paint_levels(const dif_map *map, uint8_t *rgb, dif_error *err)
{
    const size_t n = (size_t)map->n_pixel * (size_t)map->n_pixel;
    uint8_t colours[256][3];
    const double peak = dif_report_map_peak(map);
    const dif_status status = dif_image_colormap("viridis", colours, err);
    for (size_t i = 0; i < n && status == DIF_OK; i++) {
        const double decades = log10((double)map->xyz[3 * i + 1] / peak) / level_decades + 1.0;
        const double at = decades > 0.0 ? fmin(decades, 1.0) : 0.0; /* a NaN of a dark map is 0, too */
        for (int c = 0; c < 3; c++)
            rgb[3 * i + (size_t)c] = colours[(int)(255.0 * at + 0.5)][c];
    }
    return status;
}

dif_status dif_report_map_write(const char *path, const dif_map *map, double exposure, dif_gamut gamut, dif_error *err)
{
    const size_t n = (size_t)map->n_pixel * (size_t)map->n_pixel;
    unsigned char *png = NULL;
    size_t n_byte = 0;
    uint8_t *rgb = dif_alloc(n, 3);
    dif_status status = rgb ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "%s: %zu pixels", path, n);
    if (status == DIF_OK && isnan(exposure))
        status = paint_levels(map, rgb, err);
    else if (status == DIF_OK)
        paint_colours(map, exposure, gamut, rgb);
    if (status == DIF_OK)
        status = dif_image_encode_png(rgb, map->n_pixel, map->n_pixel, &png, &n_byte, err);
    if (status == DIF_OK)
        status = dif_file_write(path, png, n_byte, err);
    dif_release(png);
    dif_release(rgb);
    return status;
}

dif_status dif_report_map_write_exr(const char *path, const dif_report_map_data *map, const dif_manifest *provenance,
                                    dif_error *err)
{
    double *lambda_um = wavelengths(map->map.n_lambda, map->step_nm);
    if (!lambda_um)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %d wavelengths", path, map->map.n_lambda);
    const dif_map_image image = {.n_pixel = map->map.n_pixel,
                                 .theta_rad = map->theta_i_rad,
                                 .phi_rad = map->azimuth_rad,
                                 .quantity = DIF_QUANTITY_RHO,
                                 .n_lambda = map->map.n_lambda,
                                 .lambda_um = lambda_um,
                                 .xyz = map->map.xyz};
    const dif_status status = dif_map_write(path, &image, map->exposure, provenance, err);
    dif_release(lambda_um);
    return status;
}

json_t *dif_report_map_json(const dif_report_data *data)
{
    const dif_report_map_data *map = &data->map;
    return json_pack("{s:i, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:i, s:o, s:s, s:o, s:o, s:o, s:o}", "n_pixel",
                     map->map.n_pixel, "n_lambda", map->map.n_lambda, "lambda_nm_min", dif_json_number(380.0),
                     "lambda_nm_max", dif_json_number(780.0), "lambda_nm_step", dif_json_number(map->step_nm),
                     "theta_i_deg", dif_json_number(dif_deg_from_rad(map->theta_i_rad)), "azimuth_deg",
                     dif_json_number(dif_deg_from_rad(map->azimuth_rad)), "tol", dif_json_number(map->tol), "bound",
                     dif_json_number(map->bound), "n_window", map->n_window, "exposure", dif_json_number(map->exposure),
                     "gamut", dif_gamut_name(map->gamut), "outside_gamut", dif_json_number(map->outside_gamut),
                     "luminance_max", dif_json_number(dif_report_map_peak(&map->map)), "level_decades",
                     dif_json_number(level_decades), "white_share", dif_json_number(white_share));
}
