/* diffbench fixture KIND --out F: a synthetic surface with a known answer. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "core/units.h"
#include "fixtures/surfaces.h"

static const dif_cli_help HELP = {
    "KIND",
    "Makes a synthetic surface and writes it as .gsf, .exr, .png (16 bit) or .txt, with what it was made from inside.\n"
    "KIND is flat, sine, blazed, lamellar, triangle, crossed, random, elaphe, xenopeltis or cd.\n"
    "Two of --pixels, --pitch-nm and --size-um fix the grid; what is not said has the kind's own value.\n",
    "  diffbench fixture blazed --period-nm 2500 --height-nm 250 --size-um 65 --pixels 512 --out blazed.gsf\n",
};

typedef struct fixture_args {
    double period_nm, height_nm, psi_deg, duty, correlation_um, pitch_nm, size_um;
    int n_pixel, seed;
    const char *out;
} fixture_args;

static void add_options(dif_cli *cli, fixture_args *args)
{
    const dif_opt opts[] = {
        {"Surface", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F", "the file to write, .gsf, .exr, .png or .txt (needed)", NULL},
        {"period-nm", DIF_OPT_REAL, &args->period_nm, "(0, inf)", "NM", "grating period", NULL},
        {"height-nm", DIF_OPT_REAL, &args->height_nm, "[0, inf)", "NM", "peak to valley (random: rms)", NULL},
        {"psi-deg", DIF_OPT_REAL, &args->psi_deg, "[-360, 360]", "DEG", "azimuth of the groove normal (default 0)",
         NULL},
        {"duty", DIF_OPT_REAL, &args->duty, "(0, 1)", "D", "lamellar: share of the period that is high", NULL},
        {"correlation-um", DIF_OPT_REAL, &args->correlation_um, "(0, inf)", "UM", "random: correlation length", NULL},
        {"seed", DIF_OPT_INT, &args->seed, "[0, 2147483647]", "N", "of what is random (default 1)", NULL},
        {"pixels", DIF_OPT_INT, &args->n_pixel, "[2, 32768]", "N", "samples along each side", NULL},
        {"pitch-nm", DIF_OPT_REAL, &args->pitch_nm, "(0, inf)", "NM", "distance of neighbouring samples", NULL},
        {"size-um", DIF_OPT_REAL, &args->size_um, "(0, inf)", "UM", "extent of each side", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

/* Samples and pitch from two of pixels, pitch and size; the kind's own values fill in. */
static int set_grid(const dif_cli *cli, const fixture_args *args, dif_surface *surface)
{
    const bool has_n = args->n_pixel > 0, has_pitch = !isnan(args->pitch_nm), has_size = !isnan(args->size_um);
    if (has_n && has_pitch && has_size)
        return dif_cmd_usage(cli->verb, "--pixels, --pitch-nm and --size-um: expected at most two of them");
    double n = has_n ? args->n_pixel : surface->nx;
    if (has_pitch) {
        surface->pitch_um = dif_um_from_nm(args->pitch_nm);
        n = has_size ? round(args->size_um / surface->pitch_um) : n;
    } else {
        const double own_um = surface->nx * surface->pitch_um;
        surface->pitch_um = (has_size ? args->size_um : own_um) / n;
    }
    if (!(n >= 2.0 && n <= DIF_FIELD_SIDE_MAX))
        return dif_cmd_usage(cli->verb, "--size-um over --pitch-nm gives %.6g samples a side, expected 2 to %d", n,
                             DIF_FIELD_SIDE_MAX);
    surface->nx = surface->ny = (int)n;
    return DIF_CLI_GO;
}

static int surface_from_args(const dif_cli *cli, const fixture_args *args, dif_surface *surface)
{
    dif_surface_kind kind;
    if (!dif_surface_kind_from_name(cli->operand[0], &kind))
        return dif_cmd_usage(cli->verb,
                             "%s: unknown kind, expected flat, sine, blazed, lamellar, triangle, crossed, "
                             "random, elaphe, xenopeltis or cd",
                             cli->operand[0]);
    *surface = dif_surface_default(kind);
    if (!isnan(args->period_nm))
        surface->period_um = dif_um_from_nm(args->period_nm);
    if (!isnan(args->height_nm))
        surface->height_um = dif_um_from_nm(args->height_nm);
    if (!isnan(args->psi_deg))
        surface->psi_rad = dif_rad_from_deg(args->psi_deg);
    if (!isnan(args->duty))
        surface->duty = args->duty;
    if (!isnan(args->correlation_um))
        surface->correlation_um = args->correlation_um;
    if (args->seed >= 0)
        surface->seed = (unsigned)args->seed;
    return set_grid(cli, args, surface);
}

static dif_status describe(const dif_cli *cli, const dif_surface *surface, dif_manifest *manifest, dif_error *err)
{
    const char *kind = dif_surface_kind_name(surface->kind);
    dif_status status = dif_cli_manifest(cli, NULL, manifest, err);
    if (status || (status = dif_manifest_setf(manifest, err, "title", "diffbench fixture %s", kind)) ||
        (status = dif_manifest_set(manifest, "fixture", kind, err)) ||
        (status = dif_manifest_setf(manifest, err, "period_nm", "%.12g", dif_nm_from_um(surface->period_um))) ||
        (status = dif_manifest_setf(manifest, err, "height_nm", "%.12g", dif_nm_from_um(surface->height_um))) ||
        (status = dif_manifest_setf(manifest, err, "psi_deg", "%.12g", dif_deg_from_rad(surface->psi_rad))) ||
        (status = dif_manifest_setf(manifest, err, "pitch_nm", "%.12g", dif_nm_from_um(surface->pitch_um))) ||
        (status = dif_manifest_setf(manifest, err, "samples", "%d x %d", surface->nx, surface->ny)) ||
        (status = dif_manifest_setf(manifest, err, "seed", "%u", surface->seed)))
        return status;
    if (surface->kind == DIF_SURFACE_LAMELLAR)
        return dif_manifest_setf(manifest, err, "duty", "%.12g", surface->duty);
    if (surface->kind == DIF_SURFACE_RANDOM)
        return dif_manifest_setf(manifest, err, "correlation_um", "%.12g", surface->correlation_um);
    return DIF_OK;
}

static int make(const dif_cli *cli, const fixture_args *args, const dif_surface *surface)
{
    dif_error err = {0};
    dif_field field = {0};
    dif_manifest manifest = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = describe(cli, surface, &manifest, &err);
    if (!status)
        status = dif_surface_make(surface, &field, &err);
    if (!status)
        status = dif_field_write(args->out, &field, &manifest, &err);
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    else if (cli->json)
        code = dif_json_print(cli, dif_json_manifest(&manifest));
    else
        dif_cli_say(cli, "%s: %s, %d x %d samples, pitch %.6g nm", args->out, dif_surface_kind_name(surface->kind),
                    field.nx, field.ny, dif_nm_from_um(surface->pitch_um));
    dif_field_free(&field);
    dif_manifest_free(&manifest);
    return code;
}

int dif_cmd_fixture(int argc, char **argv)
{
    fixture_args args = {.period_nm = NAN,
                         .height_nm = NAN,
                         .psi_deg = NAN,
                         .duty = NAN,
                         .correlation_um = NAN,
                         .pitch_nm = NAN,
                         .size_um = NAN,
                         .seed = -1};
    dif_cli cli;
    dif_surface surface;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    int code = dif_cli_parse(&cli, 1, 1);
    if (code == DIF_CLI_GO && !args.out)
        code = dif_cmd_usage(cli.verb, "nowhere to write to, expected --out F.gsf or F.exr");
    if (code == DIF_CLI_GO)
        code = surface_from_args(&cli, &args, &surface);
    return code == DIF_CLI_GO ? make(&cli, &args, &surface) : code;
}
