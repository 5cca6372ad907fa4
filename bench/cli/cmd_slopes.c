/* diffbench slopes SURFACE: slope statistics, what is seen of them from a direction, normals and masking. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/slopes_figure.h"
#include "core/alloc.h"
#include "core/io/hemisphere_io.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "SURFACE",
    "Tells how a surface's slopes are distributed, and which of them are seen from a direction: measured over its "
    "cells\n"
    "(2 x 2 samples each), and as the Gaussian that the surface's mean and covariance alone give in closed form.\n"
    "Facets turned away are not seen, and slopes towards the viewer count more. With --ndf also the distribution of\n"
    "normals over the hemisphere and the masking that follows from it, beside Smith's.\n",
    "  diffbench fixture random --pixels 512 --size-um 25 --height-nm 400 --out rough.gsf\n"
    "  diffbench slopes rough.gsf --theta-deg 70 --phi-deg 30 --png slopes.png --ndf normals.exr --ndf-png "
    "normals.png\n"
    "  diffbench slopes --reference-figure cases.png\n",
};

typedef struct slopes_args {
    dif_cli_surface surface;
    double theta_deg, phi_deg;
    int n_texel;
    const char *png, *ndf, *ndf_png, *cases;
} slopes_args;

static void add_options(dif_cli *cli, slopes_args *args)
{
    const dif_opt opts[] = {
        {"View", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"theta-deg", DIF_OPT_REAL, &args->theta_deg, "[0, 90]", "DEG", "polar angle of the viewer (default 60)", NULL},
        {"phi-deg", DIF_OPT_REAL, &args->phi_deg, "[-360, 360]", "DEG", "and its azimuth (default 0)", NULL},
        {"Output", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"png", DIF_OPT_TEXT, &args->png, NULL, "F.png", "histograms of all slopes and of those seen, and the Gaussian",
         NULL},
        {"ndf", DIF_OPT_TEXT, &args->ndf, NULL, "F.exr",
         "distribution of normals, orthographic, with masking and solid angles", NULL},
        {"ndf-png", DIF_OPT_TEXT, &args->ndf_png, NULL, "F.png", "normals and masking to look at", NULL},
        {"texels", DIF_OPT_INT, &args->n_texel, "[3, 2048]", "N", "texels across the hemisphere (default 257)", NULL},
        {"reference-figure", DIF_OPT_TEXT, &args->cases, NULL, "F.png",
         "five Gaussians of slopes, exact and in closed form; needs no surface", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_surface(cli, &args->surface);
}

typedef struct slopes_run {
    dif_field_file file;
    dif_manifest manifest;
    dif_slopes slopes;
    dif_ndf ndf; /* n = 0: not wanted */
    float *masking;
    double masking_ndf, masking_smith; /* towards the viewer; ndf NaN if not wanted */
    double smith_worst;                /* largest difference up to 85 degrees; NaN without a picture */
} slopes_run;

static void run_free(slopes_run *run)
{
    dif_field_file_free(&run->file);
    dif_manifest_free(&run->manifest);
    dif_slopes_free(&run->slopes);
    dif_hemisphere_ndf_free(&run->ndf);
    dif_release(run->masking);
}

static dif_status check_outputs(const slopes_args *args, dif_error *err)
{
    const char *const paths[] = {args->png, args->ndf, args->ndf_png, args->cases};
    dif_status status = DIF_OK;
    for (int i = 0; i < DIF_COUNT(paths) && !status; i++)
        status = dif_cli_check_out(paths[i], err);
    return status;
}

/* Normals and their masking, relative to the mean plane. */
static dif_status measure_normals(const slopes_args *args, slopes_run *run, dif_error *err)
{
    dif_status status = dif_hemisphere_ndf_create(&run->file.field, args->n_texel, true, &run->ndf, err);
    if (status)
        return status;
    run->masking = dif_alloc((size_t)args->n_texel * (size_t)args->n_texel, sizeof *run->masking);
    if (!run->masking)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d texels across", args->n_texel);
    dif_hemisphere_masking_image(&run->ndf, args->n_texel, run->masking);
    return DIF_OK;
}

static dif_status measure(const dif_cli *cli, const slopes_args *args, slopes_run *run, dif_error *err)
{
    const double theta_rad = dif_rad_from_deg(args->theta_deg), phi_rad = dif_rad_from_deg(args->phi_deg);
    const dif_vec3 view = dif_vec3_from_angles_rad(theta_rad, phi_rad);
    dif_status status = dif_cli_surface_read(cli, cli->operand[0], &args->surface, &run->file, err);
    if (!status)
        status = dif_slopes_of_field(&run->file.field, run->file.step_um, fmin(theta_rad, 0.5 * DIF_PI), phi_rad,
                                     &run->slopes, err);
    if (!status && (args->ndf || args->ndf_png))
        status = measure_normals(args, run, err);
    if (status)
        return status;
    run->masking_smith = dif_shadow_smith(&run->slopes.surface, view);
    run->masking_ndf = run->ndf.n ? dif_hemisphere_masking(&run->ndf, view) : (double)NAN;
    status = dif_cli_manifest(cli, cli->operand[0], &run->manifest, err);
    if (!status)
        status = dif_cli_manifest_surface(&run->manifest, &run->file, err);
    if (!status)
        status = dif_manifest_setf(&run->manifest, err, "view_theta_deg", "%.12g", args->theta_deg);
    return status ? status : dif_manifest_setf(&run->manifest, err, "view_phi_deg", "%.12g", args->phi_deg);
}

static dif_status write_files(const dif_cli *cli, const slopes_args *args, slopes_run *run, dif_error *err)
{
    const char *path = cli->operand[0], *slash = strrchr(path, '/');
    const char *name = run->file.title[0] ? run->file.title : slash ? slash + 1 : path;
    char heading[200];
    dif_status status = DIF_OK;
    snprintf(heading, sizeof heading, "Slopes of %.120s", name);
    if (args->png)
        status = dif_slopes_write_png(args->png, heading, &run->slopes, &run->manifest, err);
    if (!status && args->ndf)
        status = dif_hemisphere_write(args->ndf, &run->ndf, run->masking, &run->manifest, err);
    snprintf(heading, sizeof heading, "Normals of %.120s", name);
    if (!status && args->ndf_png)
        status = dif_ndf_write_png(args->ndf_png, heading, &run->ndf, run->masking, &run->slopes.surface,
                                   &run->manifest, &run->smith_worst, err);
    return status;
}

static void print_gauss(const char *name, const dif_slope_gauss *g, double norm)
{
    const double sx = sqrt(fmax(g->var_x, 0.0)), sy = sqrt(fmax(g->var_y, 0.0));
    printf("%-22s %10.6f %10.6f %10.6f %10.6f %10.6f", name, g->mean_x, g->mean_y, sx, sy,
           sx > 0.0 && sy > 0.0 ? g->cov_xy / (sx * sy) : 0.0);
    if (isnan(norm))
        printf("\n");
    else
        printf(" %12.6g\n", norm);
}

static void print_run(const slopes_args *args, const slopes_run *run)
{
    const dif_field *field = &run->file.field;
    const dif_slopes *s = &run->slopes;
    printf("slopes of %d x %d cells, seen from theta %.6g deg, azimuth %.6g deg\n", field->nx - 1, field->ny - 1,
           args->theta_deg, args->phi_deg);
    printf("%-22s %10s %10s %10s %10s %10s %12s\n", "", "mean_x", "mean_y", "sd_x", "sd_y", "corr", "visible area");
    print_gauss("surface", &s->surface, NAN);
    print_gauss("seen, measured", &s->seen.gauss, s->seen.norm);
    print_gauss("seen, Gaussian", &s->model.gauss, s->model.norm);
    printf("overlap of histogram and Gaussian %.4f (1 = alike)\n", s->overlap);
    printf("masking towards the viewer, Smith %.6f", run->masking_smith);
    if (run->ndf.n)
        printf(", from the normals %.6f", run->masking_ndf);
    printf("\n");
    if (args->ndf_png)
        printf("largest difference of the two up to 85 deg %.4f\n", run->smith_worst);
}

static json_t *json_gauss(const dif_slope_gauss *g)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f}", "mean_x", g->mean_x, "mean_y", g->mean_y, "var_x", g->var_x, "var_y",
                     g->var_y, "cov_xy", g->cov_xy);
}

static json_t *json_visible(const dif_slope_visible *v)
{
    json_t *object = json_gauss(&v->gauss);
    json_object_set_new(object, "norm", dif_json_number(v->norm));
    json_object_set_new(object, "ln_norm", dif_json_number(v->ln_norm));
    return object;
}

static json_t *json_run(const slopes_args *args, const slopes_run *run)
{
    const dif_slopes *s = &run->slopes;
    json_t *object = json_pack("{s:i, s:i, s:f, s:f}", "cells_x", run->file.field.nx - 1, "cells_y",
                               run->file.field.ny - 1, "theta_deg", args->theta_deg, "phi_deg", args->phi_deg);
    json_object_set_new(object, "surface", json_gauss(&s->surface));
    json_object_set_new(object, "measured", json_visible(&s->seen));
    json_object_set_new(object, "gaussian", json_visible(&s->model));
    json_object_set_new(object, "overlap", dif_json_number(s->overlap));
    json_object_set_new(object, "masking_smith", dif_json_number(run->masking_smith));
    if (run->ndf.n) {
        json_object_set_new(object, "masking_ndf", dif_json_number(run->masking_ndf));
        json_object_set_new(object, "ndf_projected", dif_json_number(dif_hemisphere_ndf_projected(&run->ndf)));
    }
    if (args->ndf_png)
        json_object_set_new(object, "masking_worst_difference", dif_json_number(run->smith_worst));
    json_object_set_new(object, "provenance", dif_json_manifest(&run->manifest));
    return object;
}

static dif_status write_cases(const dif_cli *cli, const char *path, dif_error *err)
{
    dif_manifest manifest;
    dif_status status = dif_cli_manifest(cli, NULL, &manifest, err);
    if (!status)
        status = dif_slopes_write_cases_png(path, &manifest, err);
    dif_manifest_free(&manifest);
    return status;
}

static int execute(const dif_cli *cli, const slopes_args *args)
{
    dif_error err = {0};
    slopes_run run = {.smith_worst = NAN};
    int code = DIF_EXIT_DONE;
    dif_status status = check_outputs(args, &err);
    if (!status && args->cases)
        status = write_cases(cli, args->cases, &err);
    if (!status && cli->n_operand > 0) {
        status = measure(cli, args, &run, &err);
        if (!status)
            status = write_files(cli, args, &run, &err);
        if (!status && cli->json)
            code = dif_json_print(cli, json_run(args, &run));
        else if (!status)
            print_run(args, &run);
    }
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    run_free(&run);
    return code;
}

int dif_cmd_slopes(int argc, char **argv)
{
    slopes_args args = {.surface = dif_cli_surface_default(), .theta_deg = 60.0, .n_texel = 257};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    const int code = dif_cli_parse(&cli, 0, 1);
    if (code != DIF_CLI_GO)
        return code;
    if (cli.n_operand == 0 && !args.cases)
        return dif_cmd_usage(cli.verb, "expected SURFACE, or --reference-figure F.png");
    if (cli.n_operand == 0 && (args.png || args.ndf || args.ndf_png))
        return dif_cmd_usage(cli.verb, "--png, --ndf and --ndf-png need a SURFACE");
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
