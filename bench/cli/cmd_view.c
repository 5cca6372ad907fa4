/* diffbench view SURFACE: a false-colour picture of the heights that does not alias, from any distance. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/view_figure.h"
#include "core/io/file.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "SURFACE",
    "Draws a surface in false colours by height, from any distance: the colour of a pixel is the mean of the colour "
    "map\n"
    "over a Gaussian of the heights that it covers, read from tables made beforehand, so that nothing aliases and the\n"
    "colours stay right. --compare holds that against 32 x 32 jittered samples a pixel, beside no filtering and "
    "beside\n"
    "plain mip-mapping of the heights.\n",
    "  diffbench fixture elaphe --pixels 666 --out shed.gsf\n"
    "  diffbench view shed.gsf --zoom 0.25 --out shed.png --compare sides.png\n",
};

typedef struct view_args {
    dif_cli_surface surface;
    dif_view_plan plan;
    double theta_deg, phi_deg;
    const char *out, *compare;
    int filter, colour_map;
} view_args;

static const char *const COLOUR_MAPS[] = {"viridis", "inferno", "turbo", "gray"};

static void add_options(dif_cli *cli, view_args *args)
{
    const dif_opt opts[] = {
        {"View", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"zoom", DIF_OPT_REAL, &args->plan.zoom, "(0, 64]", "Z",
         "pixels per sample: 0.0625 shows 16 x 16 samples as one pixel (default 1)", NULL},
        {"theta-deg", DIF_OPT_REAL, &args->theta_deg, "[0, 89]", "DEG", "polar angle of the viewer (default 0)", NULL},
        {"phi-deg", DIF_OPT_REAL, &args->phi_deg, "[-360, 360]", "DEG",
         "and its azimuth (default 270: x to the right, y up)", NULL},
        {"colours", DIF_OPT_CHOICE, &args->colour_map, "viridis|inferno|turbo|gray", NULL,
         "from the lowest to the highest sample (default viridis)", NULL},
        {"filter", DIF_OPT_CHOICE, &args->filter, "point|mean|filtered|truth", NULL,
         "filtered (default): mean and variance of the heights; mean: the colour of the mean height; point: none; "
         "truth: supersampled",
         NULL},
        {"taps", DIF_OPT_INT, &args->plan.n_across, "[2, 16]", "N",
         "places read across a pixel, N x N or more (default 8)", NULL},
        {"Output (at least one)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F.png", "the picture", NULL},
        {"compare", DIF_OPT_TEXT, &args->compare, NULL, "F.png",
         "all four filters side by side, and how far each is from the truth", NULL},
        {"samples", DIF_OPT_INT, &args->plan.n_sample, "[1, 256]", "N",
         "truth: N x N jittered samples a pixel (default 32)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_surface(cli, &args->surface);
}

typedef struct view_run {
    dif_field_file file;
    dif_manifest manifest;
    dif_view_set set;
} view_run;

static void run_free(view_run *run)
{
    dif_field_file_free(&run->file);
    dif_manifest_free(&run->manifest);
    dif_view_set_free(&run->set);
}

static dif_status describe(const dif_cli *cli, const view_args *args, view_run *run, dif_error *err)
{
    static const char *const filters[] = {"point", "mean", "filtered", "truth"};
    dif_status status = dif_cli_manifest(cli, cli->operand[0], &run->manifest, err);
    if (!status)
        status = dif_cli_manifest_surface(&run->manifest, &run->file, err);
    if (!status)
        status = dif_manifest_setf(&run->manifest, err, "zoom", "%.12g pixels per sample", args->plan.zoom);
    if (!status)
        status = dif_manifest_setf(&run->manifest, err, "view", "theta %.12g deg, azimuth %.12g deg", args->theta_deg,
                                   args->phi_deg);
    if (!status)
        status = dif_manifest_set(&run->manifest, "filter", filters[args->filter], err);
    return status ? status
                  : dif_manifest_setf(&run->manifest, err, "colours", "%s, %.9g to %.9g um",
                                      COLOUR_MAPS[args->colour_map], run->set.low_um, run->set.high_um);
}

static dif_status make(const dif_cli *cli, const view_args *args, view_run *run, dif_error *err)
{
    const bool all = args->compare != NULL;
    dif_status status = dif_cli_check_out(args->out, err);
    if (!status)
        status = dif_cli_check_out(args->compare, err);
    if (!status)
        status = dif_cli_surface_read(cli, cli->operand[0], &args->surface, &run->file, err);
    if (!status)
        status = dif_view_set_make(&run->file.field, COLOUR_MAPS[args->colour_map], &args->plan,
                                   all ? DIF_VIEW_ALL : 1u << args->filter, &run->set, err);
    if (!status)
        status = describe(cli, args, run, err);
    if (!status && args->out)
        status = dif_view_write_png(args->out, &run->set.view[args->filter], &run->manifest, err);
    if (!status && args->compare)
        status = dif_view_set_write_png(args->compare, &run->set, args->plan.zoom, &run->manifest, err);
    return status;
}

static json_t *json_run(const view_args *args, const view_run *run)
{
    static const char *const names[] = {"point", "mean", "filtered"};
    const dif_view *view = &run->set.view[args->filter];
    json_t *object =
        json_pack("{s:f, s:i, s:i, s:f, s:f, s:f}", "zoom", args->plan.zoom, "nx", view->nx, "ny", view->ny, "low_um",
                  run->set.low_um, "high_um", run->set.high_um, "reads_per_pixel", run->set.view[args->filter].n_read);
    for (int i = 0; i < DIF_COUNT(names) && args->compare; i++)
        json_object_set_new(object, names[i], dif_view_difference_json(&run->set, i));
    json_object_set_new(object, "provenance", dif_json_manifest(&run->manifest));
    return object;
}

static void print_run(const view_args *args, const view_run *run)
{
    static const char *const names[] = {"point", "mean", "filtered"};
    const dif_view *view = &run->set.view[args->filter];
    if (!args->compare) {
        printf("%d x %d pixels, %.4g places read a pixel\n", view->nx, view->ny, view->n_read);
        return;
    }
    printf("against %d x %d samples a pixel, over %zu pixels:\n%-10s %10s %10s %10s %10s %10s %8s\n",
           args->plan.n_sample, args->plan.n_sample, run->set.difference[0].n, "filter", "dE2000 mean", "median", "p95",
           "worst", "rms", "reads");
    for (int i = 0; i < DIF_COUNT(names); i++) {
        const dif_view_difference *d = &run->set.difference[i];
        printf("%-10s %10.4f %10.4f %10.4f %10.4f %10.5f %8.4g\n", names[i], d->de_mean, d->de_median, d->de_p95,
               d->de_worst, d->rms, run->set.view[i].n_read);
    }
}

static int execute(const dif_cli *cli, const view_args *args)
{
    dif_error err = {0};
    view_run run = {0};
    int code = DIF_EXIT_DONE;
    if (make(cli, args, &run, &err))
        code = dif_cmd_fail(cli->verb, &err);
    else if (cli->json)
        code = dif_json_print(cli, json_run(args, &run));
    else
        print_run(args, &run);
    run_free(&run);
    return code;
}

static bool is_png(const char *path)
{
    return !path || dif_file_ends_in(path, ".png");
}

int dif_cmd_view(int argc, char **argv)
{
    view_args args = {.surface = dif_cli_surface_default(),
                      .plan = dif_view_plan_default(),
                      .phi_deg = 270.0,
                      .filter = DIF_VIEW_FILTERED};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    const int code = dif_cli_parse(&cli, 1, 1);
    if (code != DIF_CLI_GO)
        return code;
    if (!args.out && !args.compare)
        return dif_cmd_usage(cli.verb, "nowhere to put the picture, expected --out F.png or --compare F.png");
    if (!is_png(args.out) || !is_png(args.compare))
        return dif_cmd_usage(cli.verb, "%s '%s': expected F.png", is_png(args.out) ? "--compare" : "--out",
                             is_png(args.out) ? args.compare : args.out);
    args.plan.theta_rad = dif_rad_from_deg(args.theta_deg);
    args.plan.phi_rad = dif_rad_from_deg(args.phi_deg);
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
