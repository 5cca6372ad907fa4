/* diffbench fit TABLE|SURFACE: periods with uncertainties. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/fit_print.h"
#include "bench/fit.h"
#include "bench/scan.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "TABLE|SURFACE",
    "Fits grating periods, to a response table (a ridge for each order: spatial frequency, line shape of the "
    "coherence\n"
    "window) or to the heights of a surface (a harmonic model); which of the two it is, the file's content tells.\n"
    "A period has two standard errors, from the fit's covariance and from the scatter over disjoint parts of the "
    "data;\n"
    "the larger one is stated. A fit that is not believed says why and exits 1; it never prints a period.\n"
    "Of a surface it also tells how the period drifts along the slow scan axis, y.\n"
    "What a table of `diffbench table` says of its window, patch and index is used unless flags say otherwise.\n",
    "  diffbench fixture blazed --pixels 512 --out blazed.gsf\n"
    "  diffbench table blazed.gsf --theta-i-deg 75 --angle-deg -55:-40:0.05 --lambda-nm 380:780:10 --out blazed.csv\n"
    "  diffbench fit blazed.csv\n"
    "  diffbench fit blazed.gsf\n",
};

enum { LINE_AUTO = -1, LINE_KNOWN, LINE_FREE };
enum { PERIODS_AUTO = -1, PERIODS_COMMON, PERIODS_EACH };

typedef struct fit_args {
    dif_cli_surface surface;
    double period_start_nm, sigma_um, patch_x_um, patch_y_um, index_n, index_kappa;
    int line, periods, window, average, quantity; /* -1 = as the table says */
    int n_ridge_max, order, n_part, n_harmonic;
    bool offset, part_given, ridge_given;
} fit_args;

static void add_table_options(dif_cli *cli, fit_args *args)
{
    const dif_opt opts[] = {
        {"Tables", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"ridges", DIF_OPT_INT, &args->n_ridge_max, "[1, 16]", "N",
         "ridges to try; an information criterion decides (default 8)", &args->ridge_given},
        {"order", DIF_OPT_INT, &args->order, "[-100000, 100000]", "M",
         "order of the strongest ridge (default: found from the data)", NULL},
        {"periods", DIF_OPT_CHOICE, &args->periods, "common|each", NULL,
         "common: all ridges are orders of one grating; each: every ridge has a period of its own, as on a scan. "
         "Default: common if the table is of a synthetic grating, each otherwise",
         NULL},
        {"offset", DIF_OPT_FLAG, &args->offset, NULL, NULL, "also fit an angular offset of the goniometer", NULL},
        {"line", DIF_OPT_CHOICE, &args->line, "known|free", NULL,
         "line shape: of the window that made the table, or a Gaussian of free width (default: known where the table "
         "tells its window)",
         NULL},
        {"window", DIF_OPT_CHOICE, &args->window, "gauss|flat", NULL, "known line: window", NULL},
        {"sigma-um", DIF_OPT_REAL, &args->sigma_um, "(0, inf)", "UM", "known line: its standard deviation", NULL},
        {"average", DIF_OPT_CHOICE, &args->average, "none|welch", NULL, "known line: how windows were averaged", NULL},
        {"patch-x-um", DIF_OPT_REAL, &args->patch_x_um, "(0, inf)", "UM", "known line: the patch along x", NULL},
        {"patch-y-um", DIF_OPT_REAL, &args->patch_y_um, "(0, inf)", "UM", "known line: the patch along y", NULL},
        {"quantity", DIF_OPT_CHOICE, &args->quantity, "power|rho|brdf", NULL, "what the table's values are", NULL},
        {"n", DIF_OPT_REAL, &args->index_n, "(0, inf)", "N", "refractive index, to divide the gain out", NULL},
        {"kappa", DIF_OPT_REAL, &args->index_kappa, "[0, inf)", "K", "extinction, likewise", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

static void add_options(dif_cli *cli, fit_args *args)
{
    const dif_opt both[] = {
        {"Both", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"period-start-nm", DIF_OPT_REAL, &args->period_start_nm, "(0, inf)", "NM",
         "where to start (default: found from the data)", NULL},
        {"parts", DIF_OPT_INT, &args->n_part, "[2, 100]", "N",
         "disjoint parts for the scatter: bands of wavelengths or of the scan", &args->part_given},
    };
    const dif_opt surface[] = {
        {"Surfaces", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"harmonics", DIF_OPT_INT, &args->n_harmonic, "[1, 32]", "N", "of the period (default: the criterion decides)",
         NULL},
    };
    dif_cli_add(cli, both, DIF_COUNT(both));
    add_table_options(cli, args);
    dif_cli_add(cli, surface, DIF_COUNT(surface));
    dif_cli_add_surface(cli, &args->surface);
}

/* A number of a manifest, or the fallback if the key is missing or no number. */
static double manifest_number(const dif_manifest *manifest, const char *key, double fallback)
{
    const char *text = dif_manifest_get(manifest, key);
    dif_range range;
    return text && dif_range_parse(text, &range, NULL) == DIF_OK && range.n == 1 ? range.min : fallback;
}

/* Index of a manifest's word in a list, or -1. */
static int manifest_choice(const dif_manifest *manifest, const char *key, const char *const word[2])
{
    const char *text = dif_manifest_get(manifest, key);
    for (int i = 0; text && i < 2; i++)
        if (strcmp(text, word[i]) == 0)
            return i;
    return -1;
}

/* Pitch of the samples along a plane that runs along one of the patch's axes, NaN along any other. */
static double pitch_along_um(const dif_manifest *manifest, double azimuth_rad)
{
    const double c = fabs(cos(azimuth_rad)), s = fabs(sin(azimuth_rad));
    const char *key = c > s ? "pitch_x_nm" : "pitch_y_nm";
    return fmin(c, s) < 1e-9 ? manifest_number(manifest, key, NAN) * 1e-3 : (double)NAN;
}

/* The line shape from flags first, then from the table's own words; free if neither tells enough. */
static dif_fit_line line_of(const fit_args *args, const dif_manifest *manifest, double azimuth_rad)
{
    static const char *const windows[2] = {"gauss", "flat"}, *const averages[2] = {"none", "welch"};
    const int window = args->window >= 0 ? args->window : manifest_choice(manifest, "window", windows);
    const int average = args->average >= 0 ? args->average : manifest_choice(manifest, "average", averages);
    dif_fit_line line = {.window = {.kind = window == 1 ? DIF_WINDOW_FLAT : DIF_WINDOW_GAUSS}};
    line.pitch_um = pitch_along_um(manifest, azimuth_rad);
    line.average = average == 1 ? DIF_AVERAGE_WELCH : DIF_AVERAGE_NONE;
    line.window.sigma_um = isnan(args->sigma_um) ? manifest_number(manifest, "sigma_um", NAN) : args->sigma_um;
    line.size_x_um = isnan(args->patch_x_um) ? manifest_number(manifest, "patch_x_um", NAN) : args->patch_x_um;
    line.size_y_um = isnan(args->patch_y_um) ? manifest_number(manifest, "patch_y_um", NAN) : args->patch_y_um;
    const bool has_width = window == 1 || line.window.sigma_um > 0.0;
    line.known = args->line != LINE_FREE && window >= 0 && has_width && line.size_x_um > 0.0 && line.size_y_um > 0.0;
    return line;
}

/* Whether all ridges belong to one grating: as said, or if `fixture` made the table's surface as one. */
static bool has_common_period(const fit_args *args, const dif_manifest *manifest)
{
    static const char *const gratings[] = {"sine", "blazed", "lamellar", "triangle", "crossed"};
    const char *title = dif_manifest_get(manifest, "surface_title");
    const char *kind = title ? dif_cli_fixture_kind(title) : NULL;
    if (args->periods != PERIODS_AUTO)
        return args->periods == PERIODS_COMMON;
    for (int i = 0; kind && i < DIF_COUNT(gratings); i++)
        if (strcmp(kind, gratings[i]) == 0)
            return true;
    return false;
}

static dif_status fit_table(const dif_cli *cli, const fit_args *args, dif_cli_input *input, dif_fit_result *result,
                            dif_error *err)
{
    dif_fit_table_opts opts = dif_fit_table_opts_default();
    opts.line = line_of(args, &input->manifest, input->table.plan.azimuth_rad);
    if (args->line == LINE_KNOWN && !opts.line.known)
        return dif_fail(err, DIF_ERR_ARG,
                        "%s: --line known, but the table does not tell its window, expected --window, --sigma-um, "
                        "--patch-x-um and --patch-y-um",
                        cli->operand[0]);
    opts.index.n = isnan(args->index_n) ? manifest_number(&input->manifest, "index_n", opts.index.n) : args->index_n;
    opts.index.kappa = isnan(args->index_kappa) ? manifest_number(&input->manifest, "index_kappa", opts.index.kappa)
                                                : args->index_kappa;
    if (args->quantity >= 0)
        input->table.quantity = (dif_quantity)args->quantity;
    if (args->ridge_given)
        opts.n_ridge_max = args->n_ridge_max;
    opts.order = args->order;
    opts.offset_free = args->offset;
    opts.common_period = has_common_period(args, &input->manifest);
    opts.period_start_um = args->period_start_nm * 1e-3; /* NaN stays NaN */
    if (args->part_given)
        opts.n_part = args->n_part;
    const char *shadowing = dif_manifest_get(&input->manifest, "shadowing");
    if (shadowing && input->table.quantity != DIF_QUANTITY_POWER)
        dif_cli_say(cli,
                    "the table holds %s shadowing, whose slope across a line the fit takes for the surface's own: "
                    "periods are surer from tables without --shadowing",
                    shadowing);
    return dif_fit_table(&input->table, &opts, result, err);
}

static dif_status fit_surface(const fit_args *args, const dif_cli_input *input, dif_fit_surface_result *result,
                              dif_error *err)
{
    dif_fit_surface_opts opts = dif_fit_surface_opts_default();
    if (args->n_harmonic > 0)
        opts.n_harmonic = args->n_harmonic;
    if (args->part_given)
        opts.n_part = args->n_part;
    opts.period_start_um = args->period_start_nm * 1e-3;
    return dif_fit_surface(&input->file.field, &opts, result, err);
}

/* A fit's reason does not know the file nor the flags; the line must name them. */
static int fail_named(const dif_cli *cli, const fit_args *args, const dif_cli_input *input, const dif_error *err)
{
    dif_error named = {.status = err->status};
    const char *path = cli->operand[0];
    const bool has_name = strncmp(err->text, path, strlen(path)) == 0, is_fit = err->status == DIF_ERR_FIT;
    const bool is_each = is_fit && input->is_table && !has_common_period(args, &input->manifest);
    dif_fail(&named, err->status, "%s%s%s%s%s", has_name ? "" : path, has_name ? "" : ": ", is_fit ? "no period: " : "",
             err->text, is_each ? " (if it is a grating: --periods common)" : "");
    return dif_cmd_fail(cli->verb, &named);
}

static int execute(const dif_cli *cli, const fit_args *args)
{
    dif_error err = {0};
    dif_cli_input input;
    dif_manifest manifest = {0};
    dif_fit_result table = {0};
    dif_fit_surface_result surface = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = dif_cli_input_read(cli, cli->operand[0], &args->surface, &input, &err);
    if (status) {
        code = dif_cmd_fail(cli->verb, &err);
        goto done;
    }
    status = input.is_table ? fit_table(cli, args, &input, &table, &err) : fit_surface(args, &input, &surface, &err);
    if (!status)
        status = dif_cli_manifest(cli, cli->operand[0], &manifest, &err);
    if (!status && !input.is_table)
        status = dif_cli_manifest_surface(&manifest, &input.file, &err);
    const bool is_common = has_common_period(args, &input.manifest);
    if (status)
        code = fail_named(cli, args, &input, &err);
    else if (cli->json)
        code = dif_json_print(cli, input.is_table ? dif_fit_table_json(&table, is_common, &manifest)
                                                  : dif_fit_surface_json(&surface, &manifest));
    else if (input.is_table)
        dif_fit_table_print(&table, is_common);
    else
        dif_fit_surface_print(&surface);
done:
    dif_manifest_free(&manifest);
    dif_cli_input_free(&input);
    return code;
}

int dif_cmd_fit(int argc, char **argv)
{
    const double none = (double)NAN;
    fit_args args = {.surface = dif_cli_surface_default(),
                     .period_start_nm = none,
                     .sigma_um = none,
                     .patch_x_um = none,
                     .patch_y_um = none,
                     .index_n = none,
                     .index_kappa = none,
                     .line = LINE_AUTO,
                     .periods = PERIODS_AUTO,
                     .window = -1,
                     .average = -1,
                     .quantity = -1,
                     .order = DIF_FIT_ORDER_FIND};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    const int code = dif_cli_parse(&cli, 1, 1);
    if (code != DIF_CLI_GO)
        return code;
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
