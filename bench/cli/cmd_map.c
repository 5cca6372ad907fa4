/* diffbench map SURFACE: every direction for one direction of light (or of the detector), in colour. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/map.h"
#include "bench/scan.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/map_io.h"
#include "core/io/number.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "SURFACE",
    "Measures the BRDF map of a surface: all directions of reflection for one direction of light, or the reverse, as "
    "a\n"
    "disc of direction cosines, x to the right, y up. Azimuths count from x towards y. EXR holds linear numbers: R, G, "
    "B,\n"
    "X, Y, Z and with --spectral one layer a wavelength. PNG is to look at: encoded sRGB, rings every 15 degrees.\n",
    "  diffbench fixture blazed --pixels 512 --out blazed.gsf\n"
    "  diffbench map blazed.gsf --theta-i-deg 30 --pixels 256 --out blazed.exr --png blazed.png\n",
};

typedef struct map_args {
    dif_cli_surface surface;
    dif_cli_measure measure;
    double theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg;
    int n_pixel;
    dif_range lambda_nm;
    const char *out, *png, *exposure;
    bool spectral;
    int gamut;
    double exposure_value; /* of `exposure`, or DIF_EXPOSURE_AUTO */
} map_args;

static void add_options(dif_cli *cli, map_args *args)
{
    const dif_opt opts[] = {
        {"Plan (one of the two directions is fixed)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"theta-i-deg", DIF_OPT_REAL, &args->theta_i_deg, "(-90, 90)", "DEG", "fixed light: angle of incidence", NULL},
        {"phi-i-deg", DIF_OPT_REAL, &args->phi_i_deg, "[-360, 360]", "DEG", "and its azimuth (default 0)", NULL},
        {"theta-r-deg", DIF_OPT_REAL, &args->theta_r_deg, "(-90, 90)", "DEG", "or: fixed detector", NULL},
        {"phi-r-deg", DIF_OPT_REAL, &args->phi_r_deg, "[-360, 360]", "DEG", "and its azimuth (default 0)", NULL},
        {"pixels", DIF_OPT_INT, &args->n_pixel, "[16, 4096]", "N", "pixels across the disc (default 512)", NULL},
        {"lambda-nm", DIF_OPT_RANGE, &args->lambda_nm, "(0, inf)", "MIN:MAX:STEP", "wavelengths (default 380:780:5)",
         NULL},
    };
    const dif_opt output[] = {
        {"Output (at least one)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F", "F.exr or F.png", NULL},
        {"png", DIF_OPT_TEXT, &args->png, NULL, "F.png", "a picture beside it", NULL},
        {"spectral", DIF_OPT_FLAG, &args->spectral, NULL, NULL, "EXR: also a layer for each wavelength", NULL},
        {"exposure", DIF_OPT_TEXT, &args->exposure, NULL, "V",
         "picture: factor on Y, 1 shows a mirror as white; auto (default): the pixels above white carry a tenth of the "
         "light outside the mirror's spot",
         NULL},
        {"gamut", DIF_OPT_CHOICE, &args->gamut, "clip|desaturate", NULL,
         "picture: colours that sRGB lacks are cut off (default), or mixed with the grey of their luminance", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_measure(cli, &args->measure, true);
    dif_cli_add_shadowing(cli, &args->measure);
    dif_cli_add(cli, output, DIF_COUNT(output));
    dif_cli_add_surface(cli, &args->surface);
}

/* Everything that one run makes. */
typedef struct map_run {
    dif_field_file file;
    dif_map_image image; /* owns lambda_um, xyz, layer */
    dif_manifest manifest;
    dif_measure_opts opts;
    dif_measure_stats stats;
    dif_shadow shadow;
    dif_map_check check;
    double exposure;
} map_run;

static void run_free(map_run *run)
{
    dif_field_file_free(&run->file);
    dif_map_image_free(&run->image);
    dif_manifest_free(&run->manifest);
    dif_shadow_free(&run->shadow);
}

static dif_status fill_image(const map_args *args, dif_map_image *image, dif_error *err)
{
    image->fixed_is_wo = isnan(args->theta_i_deg);
    image->theta_rad = dif_rad_from_deg(image->fixed_is_wo ? args->theta_r_deg : args->theta_i_deg);
    image->phi_rad = dif_rad_from_deg(image->fixed_is_wo ? args->phi_r_deg : args->phi_i_deg);
    image->n_pixel = args->n_pixel;
    image->quantity = (dif_quantity)args->measure.quantity;
    image->n_lambda = args->lambda_nm.n;
    image->lambda_um = dif_alloc((size_t)image->n_lambda, sizeof *image->lambda_um);
    if (!image->lambda_um)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d wavelengths", image->n_lambda);
    for (int i = 0; i < image->n_lambda; i++)
        image->lambda_um[i] = dif_um_from_nm(dif_range_at(&args->lambda_nm, i));
    return DIF_OK;
}

static dif_status measure(const dif_cli *cli, const map_args *args, map_run *run, dif_error *err)
{
    dif_progress progress = dif_progress_begin(cli->verb, cli->quiet);
    dif_map_image *image = &run->image;
    dif_map map = {0};
    dif_status status = fill_image(args, image, err);
    if (!status)
        status = dif_cli_check_out(args->out, err);
    if (!status)
        status = dif_cli_check_out(args->png, err);
    if (!status)
        status = dif_cli_surface_read(cli, cli->operand[0], &args->surface, &run->file, err);
    if (status)
        return status;
    const dif_map_plan plan = {.fixed_is_wo = image->fixed_is_wo,
                               .fixed = dif_vec3_from_angles_rad(image->theta_rad, image->phi_rad),
                               .n_pixel = image->n_pixel,
                               .n_lambda = image->n_lambda,
                               .lambda_um = image->lambda_um,
                               .keep_layers = args->spectral || args->measure.n_check > 0};
    run->opts = dif_cli_measure_opts(cli, &args->measure, &run->file, &progress);
    status = dif_cli_measure_period(cli, &run->file, &run->opts, err);
    if (!status)
        status = dif_cli_measure_shadow(cli, &args->measure, &run->file, &run->opts, &run->shadow, err);
    if (!status)
        status = dif_map_measure(&run->file.field, &plan, args->measure.tol, &run->opts, &map, &run->stats, err);
    if (!status && args->measure.n_check > 0)
        status =
            dif_map_check_layers(&run->file.field, &plan, &map, &run->opts, args->measure.n_check, 1, &run->check, err);
    dif_progress_end(&progress);
    image->xyz = map.xyz;
    image->layer = map.layer;
    return status;
}

static dif_status describe_check(map_run *run, dif_error *err)
{
    const dif_map_check *check = &run->check;
    if (check->n_sample == 0)
        return DIF_OK;
    const dif_status status = dif_manifest_setf(&run->manifest, err, "check_samples", "%d", check->n_sample);
    return status
               ? status
               : dif_manifest_setf(&run->manifest, err, "check_worst_amplitude_error", "%.3g", check->worst_amplitude);
}

/* What the EXR says by itself is here for the picture's texts. */
static dif_status describe_map(const map_args *args, map_run *run, dif_error *err)
{
    const dif_map_image *image = &run->image;
    dif_manifest *manifest = &run->manifest;
    const char *side = image->fixed_is_wo ? "r" : "i";
    char theta_key[16], phi_key[16];
    snprintf(theta_key, sizeof theta_key, "theta_%s_deg", side);
    snprintf(phi_key, sizeof phi_key, "phi_%s_deg", side);
    dif_status status = dif_manifest_set(manifest, "quantity", dif_quantity_name(image->quantity), err);
    if (status ||
        (status =
             dif_manifest_set(manifest, "map_of", image->fixed_is_wo ? "theta_i, phi_i" : "theta_r, phi_r", err)) ||
        (status = dif_manifest_setf(manifest, err, theta_key, "%.12g", dif_deg_from_rad(image->theta_rad))) ||
        (status = dif_manifest_setf(manifest, err, phi_key, "%.12g", dif_deg_from_rad(image->phi_rad))) ||
        (status = dif_manifest_setf(manifest, err, "wavelengths_nm", "%.12g:%.12g:%.12g", args->lambda_nm.min,
                                    args->lambda_nm.max, args->lambda_nm.step)) ||
        (status = dif_manifest_setf(manifest, err, "exposure", "%.9g", run->exposure)) ||
        (status = dif_manifest_set(manifest, "exposure_by", args->exposure_value > 0.0 ? "user" : "auto", err)))
        return status;
    return dif_manifest_set(manifest, "gamut", dif_gamut_name((dif_gamut)args->gamut), err);
}

static dif_status describe(const dif_cli *cli, const map_args *args, map_run *run, dif_error *err)
{
    run->exposure = args->exposure_value > 0.0 ? args->exposure_value : dif_map_exposure(&run->image);
    dif_status status = dif_cli_manifest(cli, cli->operand[0], &run->manifest, err);
    if (!status)
        status = dif_cli_manifest_surface(&run->manifest, &run->file, err);
    if (!status)
        status = dif_cli_manifest_measure(&run->manifest, args->measure.tol, &run->opts, &run->stats, err);
    if (!status)
        status = describe_check(run, err);
    return status ? status : describe_map(args, run, err);
}

static dif_status write_one(const map_args *args, map_run *run, const char *path, dif_error *err)
{
    const dif_map_look look = {args->exposure_value, (dif_gamut)args->gamut};
    dif_map_image image = run->image;
    if (!args->spectral)
        image.layer = NULL; /* kept for the check only */
    return dif_file_ends_in(path, ".exr") ? dif_map_write(path, &image, run->exposure, &run->manifest, err)
                                          : dif_map_write_png(path, &image, &look, &run->manifest, err);
}

/* Where the light goes: the brightest pixel, and mean and spread of the luminance over the disc. */
typedef struct map_light {
    double peak_y, peak_theta_deg, peak_phi_deg;
    double mean_x, mean_y, spread_x, spread_y; /* direction cosines; standard deviations */
} map_light;

static map_light light_of(const dif_map_image *image)
{
    const int n = image->n_pixel;
    map_light light = {0};
    double sum = 0.0, xx = 0.0, yy = 0.0;
    for (int iy = 0; iy < n; iy++)
        for (int ix = 0; ix < n; ix++) {
            const double value = (double)image->xyz[3 * ((size_t)iy * (size_t)n + (size_t)ix) + 1];
            dif_vec3 w;
            if (!dif_map_direction(n, ix, iy, &w))
                continue;
            sum += value;
            light.mean_x += value * w.x;
            light.mean_y += value * w.y;
            xx += value * w.x * w.x;
            yy += value * w.y * w.y;
            if (value > light.peak_y) {
                light.peak_y = value;
                light.peak_theta_deg = dif_deg_from_rad(asin(fmin(hypot(w.x, w.y), 1.0)));
                light.peak_phi_deg = dif_deg_from_rad(atan2(w.y, w.x));
            }
        }
    light.mean_x /= sum;
    light.mean_y /= sum;
    light.spread_x = sqrt(fmax(xx / sum - light.mean_x * light.mean_x, 0.0));
    light.spread_y = sqrt(fmax(yy / sum - light.mean_y * light.mean_y, 0.0));
    return light;
}

static json_t *json_map(const map_args *args, const map_run *run)
{
    const map_light light = light_of(&run->image);
    json_t *object = json_pack("{s:s, s:s, s:i, s:i, s:o, s:s, s:o, s:o}", "quantity",
                               dif_quantity_name(run->image.quantity), "unit", dif_quantity_unit(run->image.quantity),
                               "pixels", run->image.n_pixel, "wavelengths", run->image.n_lambda, "exposure",
                               dif_json_number(run->exposure), "gamut", dif_gamut_name((dif_gamut)args->gamut),
                               "provenance", dif_json_manifest(&run->manifest), "cost", dif_json_stats(&run->stats));
    json_object_set_new(object, "light",
                        json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "peak_Y", dif_json_number(light.peak_y),
                                  "peak_theta_deg", dif_json_number(light.peak_theta_deg), "peak_phi_deg",
                                  dif_json_number(light.peak_phi_deg), "mean_x", dif_json_number(light.mean_x),
                                  "mean_y", dif_json_number(light.mean_y), "spread_x", dif_json_number(light.spread_x),
                                  "spread_y", dif_json_number(light.spread_y)));
    if (run->check.n_sample > 0)
        json_object_set_new(object, "check",
                            json_pack("{s:i, s:o}", "samples", run->check.n_sample, "worst_amplitude_error",
                                      dif_json_number(run->check.worst_amplitude)));
    return object;
}

static void say(const dif_cli *cli, const map_args *args, const map_run *run)
{
    const map_light light = light_of(&run->image);
    const dif_map_check *check = &run->check;
    dif_cli_say(cli, "%s, %d pixels across, %d wavelengths; brightest at theta %.4g, azimuth %.4g deg: Y = %.4g",
                dif_quantity_name(run->image.quantity), run->image.n_pixel, run->image.n_lambda, light.peak_theta_deg,
                light.peak_phi_deg, light.peak_y);
    dif_cli_say(cli, "exposure %.4g%s, %s", run->exposure, args->exposure_value > 0.0 ? "" : " (auto)",
                dif_gamut_name((dif_gamut)args->gamut));
    dif_cli_say_stats(cli, &run->stats);
    if (check->n_sample > 0)
        dif_cli_say(cli, "checked %d samples: largest amplitude error %.3g (tol %.3g) at x %.4f, y %.4f, %.6g nm",
                    check->n_sample, check->worst_amplitude, args->measure.tol, check->worst_at.x, check->worst_at.y,
                    dif_nm_from_um(check->worst_lambda_um));
}

static int judge_check(const dif_cli *cli, const map_args *args, const dif_map_check *check)
{
    if (check->n_sample == 0 || check->worst_amplitude <= args->measure.tol)
        return DIF_EXIT_DONE;
    return dif_cmd_outside(cli->verb,
                           "%s: amplitude error %.3g at x %.4f, y %.4f, %.6g nm, expected at most %.3g (--tol)",
                           cli->operand[0], check->worst_amplitude, check->worst_at.x, check->worst_at.y,
                           dif_nm_from_um(check->worst_lambda_um), args->measure.tol);
}

static int execute(const dif_cli *cli, const map_args *args)
{
    dif_error err = {0};
    map_run run = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = measure(cli, args, &run, &err);
    if (!status)
        status = describe(cli, args, &run, &err);
    if (!status)
        say(cli, args, &run);
    if (!status && args->out)
        status = write_one(args, &run, args->out, &err);
    if (!status && args->png)
        status = write_one(args, &run, args->png, &err);
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    else if (cli->json)
        code = dif_json_print(cli, json_map(args, &run));
    if (code == DIF_EXIT_DONE)
        code = judge_check(cli, args, &run.check);
    run_free(&run);
    return code;
}

/* What the options table cannot check. */
static int check_args(const dif_cli *cli, map_args *args)
{
    if (isnan(args->theta_i_deg) == isnan(args->theta_r_deg))
        return dif_cmd_usage(cli->verb, "expected exactly one of --theta-i-deg and --theta-r-deg (the map shows the "
                                        "other side's directions)");
    if (!isnan(args->theta_i_deg) && !isnan(args->phi_r_deg))
        return dif_cmd_usage(cli->verb, "--phi-r-deg with --theta-i-deg, expected --phi-i-deg");
    if (!isnan(args->theta_r_deg) && !isnan(args->phi_i_deg))
        return dif_cmd_usage(cli->verb, "--phi-i-deg with --theta-r-deg, expected --phi-r-deg");
    if (!args->out && !args->png)
        return dif_cmd_usage(cli->verb, "nowhere to put the map, expected --out F.exr, --out F.png or --png F.png");
    if (args->out && !dif_file_ends_in(args->out, ".exr") && !dif_file_ends_in(args->out, ".png"))
        return dif_cmd_usage(cli->verb, "--out '%s': unknown kind of file, expected F.exr or F.png", args->out);
    if (args->png && !dif_file_ends_in(args->png, ".png"))
        return dif_cmd_usage(cli->verb, "--png '%s': expected F.png", args->png);
    if (args->spectral && !(args->out && dif_file_ends_in(args->out, ".exr")))
        return dif_cmd_usage(cli->verb, "--spectral without an EXR to put the layers in, expected --out F.exr");
    if (args->exposure && strcmp(args->exposure, "auto") != 0 &&
        (!dif_number_all(args->exposure, strlen(args->exposure), '.', &args->exposure_value) ||
         !(args->exposure_value > 0.0 && isfinite(args->exposure_value))))
        return dif_cmd_usage(cli->verb, "--exposure '%s': expected a number > 0 or auto", args->exposure);
    return DIF_CLI_GO;
}

int dif_cmd_map(int argc, char **argv)
{
    map_args args = {.surface = dif_cli_surface_default(),
                     .measure = dif_cli_measure_default(),
                     .theta_i_deg = NAN,
                     .phi_i_deg = NAN,
                     .theta_r_deg = NAN,
                     .phi_r_deg = NAN,
                     .n_pixel = 512,
                     .lambda_nm = {380.0, 780.0, 5.0, 81},
                     .exposure_value = DIF_EXPOSURE_AUTO};
    dif_cli cli;
    args.measure.tol = 1e-4;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    int code = dif_cli_parse(&cli, 1, 1);
    if (code == DIF_CLI_GO)
        code = check_args(&cli, &args);
    if (code != DIF_CLI_GO)
        return code;
    args.phi_i_deg = isnan(args.phi_i_deg) ? 0.0 : args.phi_i_deg;
    args.phi_r_deg = isnan(args.phi_r_deg) ? 0.0 : args.phi_r_deg;
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
