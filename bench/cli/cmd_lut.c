/* diffbench lut: the wavelength-integrated table of a surface, and colours read from one. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/csv_out.h"
#include "bench/lut_check.h"
#include "bench/scan.h"
#include "core/alloc.h"
#include "core/colour.h"
#include "core/io/directions.h"
#include "core/io/file.h"
#include "core/io/lut_io.h"
#include "core/units.h"
#include "gpu/gpu.h"

static const dif_cli_help HELP = {
    "SURFACE|TABLE",
    "Builds the table that makes a surface's colour cheap: XYZ under D65 of every direction pair, the wavelengths "
    "already\n"
    "added up, as a few Chebyshev maps over azimuth and radius in one EXR. With --eval the operand is such a table, "
    "and\n"
    "out come the colours of directions: X, Y, Z (1 = a mirror's luminance) and linear sRGB.\n",
    "  diffbench fixture sine --period-nm 1600 --height-nm 120 --size-um 20 --pixels 128 --out sine.exr\n"
    "  diffbench lut sine.exr --azimuths 256 --radii 64 --sigma-um 4 --out sine.lut.exr\n"
    "  diffbench orders --period-nm 1600 --theta-i-deg 20 --lambda-nm 550 --queries > directions.csv\n"
    "  diffbench lut sine.lut.exr --eval directions.csv\n",
};

enum { DIRECTION_BYTES_MAX = 1 << 30, CHECK_MAX = 100000 };

typedef struct lut_args {
    dif_cli_surface surface;
    dif_cli_measure measure;
    int n_azimuth, n_radius, n_map;
    double source_deg;
    dif_range lambda_nm;
    const char *out, *eval;
} lut_args;

static void add_options(dif_cli *cli, lut_args *args)
{
    const dif_opt opts[] = {
        {"Table (operand a surface)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F", "F.exr to build; with --eval F.csv (default: stdout)", NULL},
        {"azimuths", DIF_OPT_INT, &args->n_azimuth, "[16, 16384]", "N", "columns (default 4096)", NULL},
        {"radii", DIF_OPT_INT, &args->n_radius, "[8, 4096]", "N", "rows (default 320)", NULL},
        {"maps", DIF_OPT_INT, &args->n_map, "[1, 48]", "K", "Chebyshev maps (default: as many as --tol needs)", NULL},
        {"source-deg", DIF_OPT_REAL, &args->source_deg, "[0, 28]", "DEG",
         "angular diameter of the light, which blurs the table (default 0, a point; the sun: 0.53)", NULL},
        {"lambda-nm", DIF_OPT_RANGE, &args->lambda_nm, "(0, inf)", "MIN:MAX:STEP",
         "wavelengths to add up (default 380:780:2; coarser ones are seen one by one between the rows)", NULL},
        {"Colours (operand a table)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"eval", DIF_OPT_TEXT, &args->eval, NULL, "Q.csv",
         "directions: columns theta_i_deg, phi_i_deg, theta_r_deg, phi_r_deg; - is stdin", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_measure(cli, &args->measure, true);
    dif_cli_add_surface(cli, &args->surface);
}

/* Building. */
typedef struct build_run {
    dif_field_file file;
    double *lambda_um;
    dif_lut lut;
    dif_manifest manifest;
    dif_measure_opts opts;
    dif_lut_check check;
    int n_window;
} build_run;

static void build_free(build_run *run)
{
    dif_field_file_free(&run->file);
    dif_release(run->lambda_um);
    dif_lut_free(&run->lut);
    dif_manifest_free(&run->manifest);
}

static dif_status build(const dif_cli *cli, const lut_args *args, build_run *run, dif_error *err)
{
    dif_progress progress = dif_progress_begin(cli->verb, cli->quiet);
    const int n_lambda = args->lambda_nm.n;
    const dif_lut_opts how = {.n_azimuth = args->n_azimuth,
                              .n_radius = args->n_radius,
                              .n_map = args->n_map,
                              .source_diameter_rad = dif_rad_from_deg(args->source_deg),
                              .progress = dif_progress_draw,
                              .progress_self = &progress};
    dif_status status = dif_cli_check_out(args->out, err);
    if (!status)
        status = dif_cli_surface_read(cli, cli->operand[0], &args->surface, &run->file, err);
    if (status)
        return status;
    run->lambda_um = dif_alloc((size_t)n_lambda, sizeof *run->lambda_um);
    if (!run->lambda_um)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d wavelengths", n_lambda);
    for (int i = 0; i < n_lambda; i++)
        run->lambda_um[i] = dif_um_from_nm(dif_range_at(&args->lambda_nm, i));
    run->opts = dif_cli_measure_opts(cli, &args->measure, &run->file, &progress);
    status = dif_lut_measure(&run->file.field, n_lambda, run->lambda_um, args->measure.tol, &run->opts, &how, &run->lut,
                             &run->n_window, err);
    if (!status && args->measure.n_check > 0)
        status = dif_lut_check_random(&run->file.field, &run->lut, n_lambda, run->lambda_um, how.source_diameter_rad,
                                      &run->opts, args->measure.n_check, 1, &run->check, err);
    dif_progress_end(&progress);
    return status;
}

static dif_status describe_check(build_run *run, dif_error *err)
{
    const dif_lut_check *check = &run->check;
    if (check->n == 0)
        return DIF_OK;
    dif_status status = dif_manifest_setf(&run->manifest, err, "check_directions", "%d", check->n);
    if (status ||
        (status = dif_manifest_setf(&run->manifest, err, "check_of_brightest", "median %.3g, p95 %.3g, worst %.3g",
                                    check->of_peak.median, check->of_peak.p95, check->of_peak.worst)))
        return status;
    return dif_manifest_setf(&run->manifest, err, "check_de2000", "median %.3g, p95 %.3g, worst %.3g", check->de.median,
                             check->de.p95, check->de.worst);
}

static dif_status describe(const dif_cli *cli, const lut_args *args, build_run *run, dif_error *err)
{
    const dif_measure_stats stats = {.bound = run->lut.tail, .n_window = run->n_window};
    dif_manifest *manifest = &run->manifest;
    run->opts.quantity = DIF_QUANTITY_POWER; /* what the table holds */
    dif_status status = dif_cli_manifest(cli, cli->operand[0], manifest, err);
    if (status || (status = dif_cli_manifest_surface(manifest, &run->file, err)) ||
        (status = dif_cli_manifest_measure(manifest, args->measure.tol, &run->opts, &stats, err)) ||
        (status = dif_manifest_setf(manifest, err, "wavelengths_nm", "%.12g:%.12g:%.12g", args->lambda_nm.min,
                                    args->lambda_nm.max, args->lambda_nm.step)) ||
        (status = dif_manifest_setf(manifest, err, "source_diameter_deg", "%.12g", args->source_deg)) ||
        (status = dif_manifest_set(manifest, "colour", "CIE 1931 2 deg, D65, a mirror is (0.95047, 1, 1.08883)", err)))
        return status;
    return describe_check(run, err);
}

static json_t *json_errors(const dif_lut_errors *errors)
{
    return json_pack("{s:o, s:o, s:o}", "median", dif_json_number(errors->median), "p95", dif_json_number(errors->p95),
                     "worst", dif_json_number(errors->worst));
}

/* Reads of a pixel of rho on a GPU. */
static double gpu_reads(const dif_lut *lut)
{
    const dif_model model = {.kind = DIF_MODEL_LUT, .lut = lut, .quantity = DIF_QUANTITY_RHO};
    return dif_gpu_reads_of_colour(&model, 0.0);
}

static json_t *json_build(const lut_args *args, const build_run *run)
{
    json_t *object =
        json_pack("{s:i, s:i, s:i, s:o, s:o, s:s, s:o}", "azimuths", run->lut.n_azimuth, "radii", run->lut.n_radius,
                  "maps", run->lut.n_map, "gpu_reads", dif_json_number(gpu_reads(&run->lut)), "tail",
                  dif_json_number(run->lut.tail), "out", args->out, "provenance", dif_json_manifest(&run->manifest));
    if (run->check.n > 0)
        json_object_set_new(object, "check",
                            json_pack("{s:i, s:o, s:o, s:o, s:o}", "directions", run->check.n, "brightest_Y",
                                      dif_json_number(run->check.brightest), "relative",
                                      json_errors(&run->check.relative), "of_brightest",
                                      json_errors(&run->check.of_peak), "de2000", json_errors(&run->check.de)));
    return object;
}

static void say_errors(const dif_cli *cli, const char *what, const dif_lut_errors *errors)
{
    dif_cli_say(cli, "  %-44s median %.3g, p95 %.3g, worst %.3g", what, errors->median, errors->p95, errors->worst);
}

static void say(const dif_cli *cli, const lut_args *args, const build_run *run)
{
    const dif_lut_check *check = &run->check;
    dif_cli_say(cli, "%d azimuths x %d radii x %d maps from %d wavelengths, %d window%s%s", run->lut.n_azimuth,
                run->lut.n_radius, run->lut.n_map, args->lambda_nm.n, run->n_window, run->n_window == 1 ? "" : "s",
                args->measure.average == DIF_AVERAGE_BY_SURFACE ? " (by default; --average chooses)" : "");
    dif_cli_say(cli, "further maps would change a colour by at most %.2g (Y = 1 is a mirror)", run->lut.tail);
    if (gpu_reads(&run->lut) > DIF_GPU_READS_WANTED)
        dif_cli_say(cli, "a pixel costs %.0f texture reads on a GPU, more than the %d that real time allows: --maps 16",
                    gpu_reads(&run->lut), DIF_GPU_READS_WANTED);
    if (check->n == 0)
        return;
    dif_cli_say(cli,
                "against full spectral sampling in %d random direction pairs, the brightest of Y = %.4g:", check->n,
                check->brightest);
    say_errors(cli, "share of the brightest", &check->of_peak);
    say_errors(cli, "relative to each direction's Y", &check->relative);
    say_errors(cli, "CIEDE2000, 99th percentile of Y shown white", &check->de);
}

static int execute_build(const dif_cli *cli, const lut_args *args)
{
    dif_error err = {0};
    build_run run = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = build(cli, args, &run, &err);
    if (!status)
        status = describe(cli, args, &run, &err);
    if (!status)
        status = dif_lut_write(args->out, &run.lut, &run.manifest, &err);
    if (status) {
        code = dif_cmd_fail(cli->verb, &err);
    } else {
        say(cli, args, &run);
        code = cli->json ? dif_json_print(cli, json_build(args, &run)) : DIF_EXIT_DONE;
    }
    build_free(&run);
    return code;
}

/* Evaluating. */
typedef struct eval_run {
    dif_lut lut;
    dif_manifest manifest;
    size_t n;
    double (*degrees)[4];
} eval_run;

static dif_status read_directions(const lut_args *args, eval_run *run, dif_error *err)
{
    const bool is_stdin = strcmp(args->eval, "-") == 0;
    const char *name = is_stdin ? "stdin" : args->eval;
    unsigned char *data = NULL;
    size_t n = 0;
    char hex[65];
    dif_status status = dif_file_read(is_stdin ? "/dev/stdin" : name, DIRECTION_BYTES_MAX, &data, &n, err);
    if (status)
        return status;
    dif_sha256_hex(data, n, hex);
    status = dif_directions_parse(data, n, name, &run->n, &run->degrees, err);
    dif_release(data);
    if (!status)
        status = dif_manifest_set(&run->manifest, "directions", name, err);
    return status ? status : dif_manifest_set(&run->manifest, "directions_sha256", hex, err);
}

/* The table's own provenance goes along under "table_KEY". */
static dif_status take_table(eval_run *run, const dif_manifest *table, dif_error *err)
{
    for (int i = 0; i < table->n; i++) {
        char key[128];
        snprintf(key, sizeof key, "table_%.100s", table->item[i].key);
        const dif_status status = dif_manifest_set(&run->manifest, key, table->item[i].value, err);
        if (status)
            return status;
    }
    return DIF_OK;
}

static dif_status prepare(const dif_cli *cli, const lut_args *args, eval_run *run, dif_error *err)
{
    dif_manifest table = {0};
    dif_status status = dif_cli_check_out(args->out, err);
    if (!status)
        status = dif_lut_read(cli->operand[0], &run->lut, &table, err);
    if (!status)
        status = dif_cli_manifest(cli, cli->operand[0], &run->manifest, err);
    if (!status)
        status = read_directions(args, run, err);
    if (!status)
        status =
            dif_manifest_set(&run->manifest, "quantity", dif_quantity_name((dif_quantity)args->measure.quantity), err);
    if (!status)
        status = take_table(run, &table, err);
    dif_manifest_free(&table);
    return status;
}

/* XYZ of one row. */
static void colour_of(const lut_args *args, const eval_run *run, size_t i, double xyz[3])
{
    const double *d = run->degrees[i];
    const dif_vec3 wi = dif_vec3_from_angles_rad(dif_rad_from_deg(d[0]), dif_rad_from_deg(d[1]));
    const dif_vec3 wo = dif_vec3_from_angles_rad(dif_rad_from_deg(d[2]), dif_rad_from_deg(d[3]));
    const dif_vec3 q = dif_vec3_transfer(wi, wo);
    const dif_index index = {.n = args->measure.index_n, .kappa = args->measure.index_kappa};
    const double gain = args->measure.quantity == DIF_QUANTITY_RHO ? dif_brdf_gain_rho(index, wi, wo) : 1.0;
    dif_lut_eval(&run->lut, q.x, q.y, q.z, xyz);
    for (int c = 0; c < 3; c++)
        xyz[c] *= gain;
}

static void print_csv(FILE *stream, const lut_args *args, const eval_run *run)
{
    dif_csv_out_provenance(stream, &run->manifest);
    fprintf(stream, "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,X,Y,Z,R,G,B\n");
    for (size_t i = 0; i < run->n; i++) {
        const double *d = run->degrees[i];
        double xyz[3], rgb[3];
        colour_of(args, run, i, xyz);
        dif_colour_rgb_from_xyz(xyz, rgb);
        fprintf(stream, "%.12g,%.12g,%.12g,%.12g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", d[0], d[1], d[2], d[3], xyz[0],
                xyz[1], xyz[2], rgb[0], rgb[1], rgb[2]);
    }
}

static json_t *json_eval(const lut_args *args, const eval_run *run)
{
    json_t *samples = json_array();
    for (size_t i = 0; i < run->n; i++) {
        const double *d = run->degrees[i];
        double xyz[3];
        colour_of(args, run, i, xyz);
        json_array_append_new(samples,
                              json_pack("{s:f, s:f, s:f, s:f, s:o, s:o, s:o}", "theta_i_deg", d[0], "phi_i_deg", d[1],
                                        "theta_r_deg", d[2], "phi_r_deg", d[3], "X", dif_json_number(xyz[0]), "Y",
                                        dif_json_number(xyz[1]), "Z", dif_json_number(xyz[2])));
    }
    return json_pack("{s:o, s:o}", "provenance", dif_json_manifest(&run->manifest), "samples", samples);
}

static int execute_eval(const dif_cli *cli, const lut_args *args)
{
    dif_error err = {0};
    eval_run run = {0};
    dif_csv_out out = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = prepare(cli, args, &run, &err);
    if (!status && (args->out || !cli->json)) {
        status = dif_csv_out_open(args->out, &out, &err);
        if (!status) {
            print_csv(out.stream, args, &run);
            status = dif_csv_out_close(&out, &err);
        }
    }
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    else if (cli->json)
        code = dif_json_print(cli, json_eval(args, &run));
    dif_lut_free(&run.lut);
    dif_manifest_free(&run.manifest);
    dif_release(run.degrees);
    return code;
}

/* What the options table cannot check. */
static int check_args(const dif_cli *cli, const lut_args *args)
{
    if (args->measure.quantity == DIF_QUANTITY_BRDF)
        return dif_cmd_usage(cli->verb, "--quantity brdf: the table has added up the wavelengths that it depends on, "
                                        "expected power or rho");
    if (args->eval)
        return args->measure.n_check == 0
                   ? DIF_CLI_GO
                   : dif_cmd_usage(cli->verb, "--check with --eval: only the surface knows better, expected --out");
    if (!args->out)
        return dif_cmd_usage(cli->verb, "expected --out F.exr to build a table, or --eval Q.csv to read one");
    if (args->measure.method != DIF_METHOD_SHEET)
        return dif_cmd_usage(cli->verb, "--method %s: tables are built by the sheet transform alone",
                             dif_method_name((dif_method)args->measure.method));
    if (args->measure.tol < 1e-6)
        return dif_cmd_usage(cli->verb, "--tol %g: expected at least 1e-6, the table is stored in float",
                             args->measure.tol);
    if (args->measure.n_check > CHECK_MAX)
        return dif_cmd_usage(cli->verb, "--check %d: expected at most %d directions", args->measure.n_check, CHECK_MAX);
    return DIF_CLI_GO;
}

int dif_cmd_lut(int argc, char **argv)
{
    const dif_lut_opts how = dif_lut_opts_default();
    lut_args args = {.surface = dif_cli_surface_default(),
                     .measure = dif_cli_measure_default(),
                     .n_azimuth = how.n_azimuth,
                     .n_radius = how.n_radius,
                     .n_map = how.n_map,
                     .lambda_nm = {380.0, 780.0, 2.0, 201}};
    dif_cli cli;
    args.measure.tol = 1e-4;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    int code = dif_cli_parse(&cli, 1, 1);
    if (code == DIF_CLI_GO)
        code = check_args(&cli, &args);
    if (code != DIF_CLI_GO)
        return code;
    dif_cli_use_threads(&cli);
    return args.eval ? execute_eval(&cli, &args) : execute_build(&cli, &args);
}
