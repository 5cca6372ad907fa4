#include "bench/cli/cli.h"

#include <math.h>
#include <omp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/sheet.h"
#include "core/units.h"

dif_cli_surface dif_cli_surface_default(void)
{
    return (dif_cli_surface){.pixel_nm = NAN, .size_um = NAN, .height_um = NAN};
}

void dif_cli_add_surface(dif_cli *cli, dif_cli_surface *surface)
{
    const dif_opt opts[] = {
        {"Surface (NanoScope, GWY, GSF, SDF, x3p, EXR, PNG, TIFF, BMP, text; only what the file does not say)",
         DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"pixel-nm", DIF_OPT_REAL, &surface->pixel_nm, "(0, inf)", "NM", "distance of neighbouring samples", NULL},
        {"size-um", DIF_OPT_REAL, &surface->size_um, "(0, inf)", "UM", "or: extent along x", NULL},
        {"height-um", DIF_OPT_REAL, &surface->height_um, "(0, inf)", "UM", "height range of an image, black to white",
         NULL},
        {"z-unit", DIF_OPT_TEXT, &surface->z_unit, NULL, "UNIT",
         "unit of the numbers of a text or of a channel in no length: nm, um, m ...", NULL},
        {"channel", DIF_OPT_TEXT, &surface->channel, NULL, "NAME|N",
         "of a file with several: its name, or its number as `info` lists it (default: the height channel)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_prep(cli, &surface->prep);
}

dif_field_request dif_cli_surface_request(const dif_cli_surface *surface)
{
    dif_field_request request = dif_field_request_default();
    request.pixel_um = surface->pixel_nm * 1e-3; /* NaN stays NaN */
    request.size_um = surface->size_um;
    request.height_um = surface->height_um;
    request.z_unit = surface->z_unit;
    request.channel = surface->channel;
    request.allow_missing = surface->prep.n > 0; /* a step may fill them; what is left is found behind the last */
    return request;
}

dif_cli_measure dif_cli_measure_default(void)
{
    const dif_index index = dif_index_default();
    return (dif_cli_measure){.tol = 1e-6,
                             .method = DIF_METHOD_SHEET,
                             .quantity = DIF_QUANTITY_RHO,
                             .window = DIF_WINDOW_GAUSS,
                             .average = DIF_AVERAGE_BY_SURFACE,
                             .n_terms = DIF_TERMS_FROM_TOL,
                             .period_nm = NAN,
                             .groove_deg = NAN,
                             .n_replica = DIF_REPLICAS_FROM_WINDOW,
                             .sigma_um = DIF_SIGMA_DEFAULT_UM,
                             .index_n = index.n,
                             .index_kappa = index.kappa};
}

void dif_cli_add_measure(dif_cli *cli, dif_cli_measure *measure, bool with_quantity)
{
    const dif_opt for_table[] = {
        {"quantity", DIF_OPT_CHOICE, &measure->quantity, "power|rho|brdf", NULL,
         "power: |P/sum W|^2; rho: relative BRDF (default); brdf: absolute, sr^-1", NULL},
    };
    const dif_opt opts[] = {
        {"Measurement", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"tol", DIF_OPT_REAL, &measure->tol, "[1e-14, 1)", "TOL",
         "wanted amplitude error, relative to the largest possible amplitude (default 1e-6; map and lut: 1e-4)", NULL},
        {"method", DIF_OPT_CHOICE, &measure->method, "sheet|taylor|direct|thesis|nmm|pq|stam", NULL,
         "sheet: fast and exact to --tol (default); taylor: power series; direct: plain sum, slow; for comparison: "
         "thesis (Taylor without w, window on a corner), nmm (few wavelengths), pq (one period replicated), stam "
         "(bumps without a profile)",
         NULL},
        {"terms", DIF_OPT_INT, &measure->n_terms, "[1, 200]", "N",
         "taylor: number of terms (default: from --tol); thesis: 40", NULL},
        {"float", DIF_OPT_FLAG, &measure->single, NULL, NULL,
         "taylor, thesis: sums in float, to show where that breaks", NULL},
        {"grating-nm", DIF_OPT_REAL, &measure->period_nm, "(0, inf)", "NM",
         "pq, stam: the period (default: fitted to the heights)", NULL},
        {"groove-deg", DIF_OPT_REAL, &measure->groove_deg, "[-360, 360]", "DEG",
         "pq, stam: azimuth of the groove normal (default 0, or fitted)", NULL},
        {"replicas", DIF_OPT_INT, &measure->n_replica, "[1, 1000000]", "N",
         "pq: periods in a row (default: as many as fill 4 sigma)", NULL},
        {"no-jacobian", DIF_OPT_FLAG, &measure->no_jacobian, NULL, NULL,
         "nmm: leave the Jacobian out, which turns pictures purple", NULL},
        {"window", DIF_OPT_CHOICE, &measure->window, "gauss|flat", NULL, "coherence window (default gauss)", NULL},
        {"sigma-um", DIF_OPT_REAL, &measure->sigma_um, "(0, inf)", "UM", "its standard deviation (default 16.25)",
         NULL},
        {"average", DIF_OPT_CHOICE, &measure->average, "none|welch", NULL,
         "none: one window at the centre, one speckle realisation; welch: |P|^2 averaged over windows tiled over the "
         "patch, the expectation. Default: none for surfaces that `diffbench fixture` made, welch for all others",
         NULL},
        {"check", DIF_OPT_INT, &measure->n_check, "[1, 1000000]", "N",
         "measure the error on N random samples against the direct sum; exit 1 if it exceeds --tol", NULL},
        {"n", DIF_OPT_REAL, &measure->index_n, "(0, inf)", "N", "refractive index of the sample (default 1.5)", NULL},
        {"kappa", DIF_OPT_REAL, &measure->index_kappa, "[0, inf)", "K", "its extinction (default 0)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    if (with_quantity)
        dif_cli_add(cli, for_table, DIF_COUNT(for_table));
}

void dif_cli_add_shadowing(dif_cli *cli, dif_cli_measure *measure)
{
    const dif_opt opts[] = {
        {"shadowing", DIF_OPT_CHOICE, &measure->shadowing, "none|vcavity|smith|ndf", NULL,
         "factor S in rho and brdf: vcavity (Torrance-Sparrow), smith (Gaussian slopes with the surface's covariance), "
         "ndf (the surface's own normals); default none",
         NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

const char *dif_cli_fixture_kind(const char *title)
{
    static const char mark[] = "diffbench fixture "; /* how `fixture` titles its files */
    return strncmp(title, mark, sizeof mark - 1) == 0 ? title + sizeof mark - 1 : NULL;
}

const char *dif_cli_fixture_name(const dif_field_file *file)
{
    return dif_cli_fixture_kind(file->title);
}

dif_measure_opts dif_cli_measure_opts(const dif_cli *cli, const dif_cli_measure *measure, const dif_field_file *file,
                                      dif_progress *progress)
{
    dif_measure_opts opts = dif_measure_opts_default();
    opts.method = (dif_method)measure->method;
    opts.n_terms = measure->n_terms;
    if (measure->n_terms != DIF_TERMS_FROM_TOL)
        opts.thesis_terms = measure->n_terms;
    opts.single = measure->single;
    opts.nmm_jacobian = !measure->no_jacobian;
    opts.period_um = measure->period_nm * 1e-3; /* NaN stays NaN */
    opts.psi_rad = isnan(measure->groove_deg) ? 0.0 : dif_rad_from_deg(measure->groove_deg);
    opts.n_replica = measure->n_replica;
    opts.window = (dif_window_kind)measure->window;
    opts.sigma_um = measure->sigma_um;
    opts.quantity = (dif_quantity)measure->quantity;
    opts.index = (dif_index){.n = measure->index_n, .kappa = measure->index_kappa};
    opts.n_thread = cli->n_thread;
    opts.progress = dif_progress_draw;
    opts.progress_self = progress;
    if (measure->average == DIF_AVERAGE_BY_SURFACE)
        opts.average = dif_cli_fixture_name(file) ? DIF_AVERAGE_NONE : DIF_AVERAGE_WELCH;
    else
        opts.average = (dif_average)measure->average;
    return opts;
}

dif_status dif_cli_measure_shadow(const dif_cli *cli, const dif_cli_measure *measure, const dif_field_file *file,
                                  dif_measure_opts *opts, dif_shadow *shadow, dif_error *err)
{
    const dif_status status = dif_shadow_create((dif_shadowing)measure->shadowing, &file->field, shadow, err);
    if (status)
        return status;
    if (shadow->kind != DIF_SHADOWING_NONE)
        opts->shadow = shadow;
    if (shadow->n_row > 0)
        dif_cli_say(cli, "%s shadowing: slopes of %.4g rms along x, %.4g along y", dif_shadowing_name(shadow->kind),
                    sqrt(shadow->slopes.var_x), sqrt(shadow->slopes.var_y));
    return DIF_OK;
}

dif_status dif_cli_measure_period(const dif_cli *cli, const dif_field_file *file, dif_measure_opts *opts,
                                  dif_error *err)
{
    if ((opts->method != DIF_METHOD_PQ && opts->method != DIF_METHOD_STAM) || !isnan(opts->period_um))
        return DIF_OK;
    const dif_status status = dif_measure_find_period(&file->field, opts, err);
    if (status)
        return dif_fail(err, status, "%s: %s needs a period, and none could be fitted to the heights (--grating-nm)",
                        cli->operand[0], dif_method_name(opts->method));
    dif_cli_say(cli, "%s: period %.6g nm along azimuth %.4g deg, fitted to the heights", dif_method_name(opts->method),
                dif_nm_from_um(opts->period_um), dif_deg_from_rad(opts->psi_rad));
    return DIF_OK;
}

void dif_cli_use_threads(const dif_cli *cli)
{
    if (cli->n_thread > 0)
        omp_set_num_threads(cli->n_thread);
}

void dif_cli_say(const dif_cli *cli, const char *format, ...)
{
    if (cli->quiet)
        return;
    va_list args;
    va_start(args, format);
    fprintf(stderr, "%s: ", cli->verb);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
}

void dif_cli_say_stats(const dif_cli *cli, const dif_measure_stats *stats)
{
    char planes[80] = "";
    if (stats->n_plane > 0 && isfinite(stats->bound))
        snprintf(planes, sizeof planes, "%d planes, %d taps, %s, amplitude error at most %.2g, ", stats->n_plane,
                 stats->n_tap, stats->single ? "float" : "double", stats->bound);
    else if (isnan(stats->bound))
        snprintf(planes, sizeof planes, "no error bound, ");
    dif_cli_say(cli, "%zu samples, %d window%s, %spreparing %.3g s, sampling %.3g s (%.3g CPU s)", stats->n_sample,
                stats->n_window, stats->n_window == 1 ? "" : "s", planes, stats->build_wall_s, stats->eval_wall_s,
                stats->build_cpu_s + stats->eval_cpu_s);
}
