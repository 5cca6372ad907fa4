/* Provenance of every output and its JSON form. */
#include "bench/cli/cli.h"

#include <math.h>
#include <stdio.h>

#include "core/units.h"

dif_status dif_cli_manifest(const dif_cli *cli, const char *path, dif_manifest *out, dif_error *err)
{
    *out = (dif_manifest){0};
    dif_status status = dif_manifest_begin(out, cli->argc, cli->argv, err);
    if (!status && path)
        status = dif_manifest_add_input(out, path, err);
    if (status)
        dif_manifest_free(out);
    return status;
}

dif_status dif_cli_manifest_surface(dif_manifest *manifest, const dif_field_file *file, dif_error *err)
{
    const dif_field *field = &file->field;
    dif_field_stats stats;
    dif_status status = dif_field_stats_of(field, &stats, err);
    if (!status && file->title[0])
        status = dif_manifest_set(manifest, "surface_title", file->title, err);
    if (!status && file->n_channel > 1)
        status = dif_manifest_setf(manifest, err, "surface_channel", "%d of %d", file->channel, file->n_channel);
    if (status || (status = dif_manifest_set(manifest, "surface_format", file->format, err)) ||
        (status = dif_manifest_setf(manifest, err, "surface_samples", "%d x %d", field->nx, field->ny)) ||
        (status = dif_manifest_setf(manifest, err, "pitch_x_nm", "%.12g", dif_nm_from_um(field->pitch_x_um))) ||
        (status = dif_manifest_setf(manifest, err, "pitch_y_nm", "%.12g", dif_nm_from_um(field->pitch_y_um))) ||
        (status = dif_manifest_setf(manifest, err, "patch_x_um", "%.12g", field->nx * field->pitch_x_um)) ||
        (status = dif_manifest_setf(manifest, err, "patch_y_um", "%.12g", field->ny * field->pitch_y_um)))
        return status;
    if (file->history[0] && (status = dif_manifest_set(manifest, "preparation", file->history, err)))
        return status;
    return dif_manifest_setf(manifest, err, "height_range_um", "%.9g", stats.max_um - stats.min_um);
}

/* The normalisation of each quantity, as text. */
static const char *const NORMALISATION[] = {
    [DIF_QUANTITY_POWER] = "p = |P / sum W|^2",
    [DIF_QUANTITY_RHO] = "rho = R(theta_h)/R(0) (1 + wi.wo)^2 / ((cos_i + cos_o)^2 cos_o) p",
    [DIF_QUANTITY_BRDF] = "brdf = R (1 + wi.wo)^2 / (cos_i cos_o w^2) (T^2 sum W)^2 / (lambda^2 T^2 sum W^2) p",
};

static dif_status add_window(dif_manifest *manifest, const dif_measure_opts *opts, const dif_measure_stats *stats,
                             dif_error *err)
{
    const bool is_gauss = opts->window == DIF_WINDOW_GAUSS;
    dif_status status = dif_manifest_set(manifest, "window", is_gauss ? "gauss" : "flat", err);
    if (!status && is_gauss)
        status = dif_manifest_setf(manifest, err, "sigma_um", "%.12g", opts->sigma_um);
    if (status)
        return status;
    const char *average = opts->average == DIF_AVERAGE_WELCH ? "welch" : "none";
    if ((status = dif_manifest_set(manifest, "average", average, err)))
        return status;
    return dif_manifest_setf(manifest, err, "windows", "%d", stats->n_window);
}

/* The bound, or what a method without one leaves out; the grating that pq and stam stand on. */
static dif_status add_bound(dif_manifest *manifest, const dif_measure_opts *opts, const dif_measure_stats *stats,
                            dif_error *err)
{
    const dif_status status =
        isnan(stats->bound) ? dif_manifest_setf(manifest, err, "bound", "none: %s", dif_method_leaves_out(opts->method))
                            : dif_manifest_setf(manifest, err, "bound", "%.3g", stats->bound);
    if (status || isnan(opts->period_um))
        return status;
    return dif_manifest_setf(manifest, err, "grating", "%.9g nm along azimuth %.9g deg, %d x %d replicas",
                             dif_nm_from_um(opts->period_um), dif_deg_from_rad(opts->psi_rad), stats->n_replica_x,
                             stats->n_replica_y);
}

static dif_status add_shadowing(dif_manifest *manifest, const dif_shadow *shadow, dif_error *err)
{
    const dif_status status = dif_manifest_set(manifest, "shadowing", dif_shadowing_name(shadow->kind), err);
    if (status || shadow->n_row == 0)
        return status;
    return dif_manifest_setf(manifest, err, "shadowing_slopes", "variances %.6g, %.6g, covariance %.6g",
                             shadow->slopes.var_x, shadow->slopes.var_y, shadow->slopes.cov_xy);
}

dif_status dif_cli_manifest_measure(dif_manifest *manifest, double tol, const dif_measure_opts *opts,
                                    const dif_measure_stats *stats, dif_error *err)
{
    dif_status status = dif_manifest_set(manifest, "method", dif_method_name(opts->method), err);
    if (status || (status = dif_manifest_setf(manifest, err, "tol", "%.3g", tol)) ||
        (status = add_bound(manifest, opts, stats, err)) || (status = add_window(manifest, opts, stats, err)) ||
        (status = dif_manifest_setf(manifest, err, "index_n", "%.9g", opts->index.n)) ||
        (status = dif_manifest_setf(manifest, err, "index_kappa", "%.9g", opts->index.kappa)))
        return status;
    if (stats->n_plane > 0 && (status = dif_manifest_setf(manifest, err, "planes", "%d", stats->n_plane)))
        return status;
    if (opts->shadow && (status = add_shadowing(manifest, opts->shadow, err)))
        return status;
    return dif_manifest_setf(manifest, err, "normalisation", "%s%s", NORMALISATION[opts->quantity],
                             opts->quantity == DIF_QUANTITY_POWER ? ""
                             : opts->shadow                       ? " S"
                                                                  : ", no shadowing");
}

json_t *dif_json_number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *dif_json_manifest(const dif_manifest *manifest)
{
    json_t *object = json_object();
    for (int i = 0; i < manifest->n; i++)
        json_object_set_new(object, manifest->item[i].key, json_string(manifest->item[i].value));
    return object;
}

json_t *dif_json_stats(const dif_measure_stats *stats)
{
    return json_pack("{s:o, s:f, s:f, s:f, s:f, s:i, s:i, s:i, s:I, s:b}", "bound", dif_json_number(stats->bound),
                     "build_wall_s", stats->build_wall_s, "build_cpu_s", stats->build_cpu_s, "eval_wall_s",
                     stats->eval_wall_s, "eval_cpu_s", stats->eval_cpu_s, "windows", stats->n_window, "planes",
                     stats->n_plane, "taps", stats->n_tap, "samples", (json_int_t)stats->n_sample, "single",
                     stats->single);
}

int dif_json_print(const dif_cli *cli, json_t *value)
{
    const dif_error short_of = {.status = DIF_ERR_NOMEM, .text = "out of memory"};
    const int failed = !value || json_dumpf(value, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(15)) != 0;
    json_decref(value);
    if (failed && !ferror(stdout))
        return dif_cmd_fail(cli->verb, &short_of);
    putchar('\n');
    return DIF_EXIT_DONE;
}
