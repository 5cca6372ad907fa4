/* diffbench compare --out DIR [SURFACE...]: the regression report, GPU against CPU. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/compare_job.h"
#include "bench/cli/compare_run.h"
#include "bench/cli/folder.h"
#include "reports/compare.h"

static const dif_cli_help HELP = {
    "[SURFACE ...]",
    "Asks the GPU's shaders and the CPU the same questions and says how far apart the answers are: tables, maps and\n"
    "colours, by every method, by compute and fragment shaders. The CPU reads its sheets in double precision at\n"
    "--tol-reference. Writes DIR/index.html, DIR/compare.json and DIR/junit.xml. Without a SURFACE: a blazed grating "
    "and\n"
    "two snake-like surfaces. Exit 1 if anything is outside its threshold or worse than the baseline, 4 without a "
    "GPU.\n"
    "A pass says that the shaders compute what the CPU computes; it does not say that the physics is right.\n",
    "  diffbench fixture blazed --size-um 20 --pixels 256 --out blazed.gsf\n"
    "  diffbench compare blazed.gsf --sigma-um 5 --methods sheet,stam --lambda-nm 400:700:20 --map-pixels 33 --out "
    "compared\n"
    "  diffbench compare --print-thresholds\n"
    "  diffbench compare --rebuild compared\n",
};

static void add_output_options(dif_cli *cli, dif_compare_args *args)
{
    const dif_opt opts[] = {
        {"Output", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "DIR", "folder to write to, made if it is not there", NULL},
        {"rebuild", DIF_OPT_TEXT, &args->rebuild, NULL, "DIR", "write page and JUnit again from DIR's result files",
         NULL},
        {"print-thresholds", DIF_OPT_FLAG, &args->print_thresholds, NULL, NULL,
         "print the thresholds as JSON, with their reasons", NULL},
        {"Judging", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"thresholds", DIF_OPT_TEXT, &args->thresholds, NULL, "F.json",
         "thresholds that take precedence over the built-in ones", NULL},
        {"baseline", DIF_OPT_TEXT, &args->baseline, NULL, "F.json", "compare.json of an earlier run: shows what moved",
         NULL},
        {"baseline-factor", DIF_OPT_REAL, &args->factor, "[1, inf)", "X",
         "by how much a number must grow to be worse "
         "(default 2)",
         NULL},
        {"Device", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"device", DIF_OPT_CHOICE, &args->device, "gpu|cpu", NULL,
         "what is tested (default gpu); cpu: the reference itself at the device's tolerance", NULL},
        {"require-hardware", DIF_OPT_FLAG, &args->require_hardware, NULL, NULL, "a software renderer is an error",
         NULL},
        {"paths", DIF_OPT_CHOICE, &args->paths, "both|compute|fragment", NULL, "shaders to test (default both)", NULL},
        {"half", DIF_OPT_FLAG, &args->half, NULL, NULL, "lut: half-float texels, as a game would have", NULL},
        {"fault", DIF_OPT_CHOICE, &args->fault, "none|plane|sign|tap", NULL,
         "use deliberately wrong shaders, which must not pass: a plane not read, a wrong sign, a tap not read", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
}

static void add_question_options(dif_cli *cli, dif_compare_args *args)
{
    const dif_opt opts[] = {
        {"Questions", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"methods", DIF_OPT_TEXT, &args->methods, NULL, "LIST",
         "of sheet,nmm,nmm-lines,pq,lut,stam (default all; nmm-lines and pq where a period is known)", NULL},
        {"theta-i-deg", DIF_OPT_REAL, &args->theta_i_deg, "(-90, 90)", "DEG", "tables: incidence (default 75)", NULL},
        {"angle-deg", DIF_OPT_RANGE, &args->angle_deg, "(-90, 90)", "MIN:MAX:STEP",
         "tables: angles of the detector (default -85:85:0.1)", NULL},
        {"lambda-nm", DIF_OPT_RANGE, &args->lambda_nm, "(0, inf)", "MIN:MAX:STEP",
         "tables: wavelengths (default 380:780:4)", NULL},
        {"azimuth-deg", DIF_OPT_REAL, &args->azimuth_deg, "[-360, 360]", "DEG",
         "of the plane of incidence (default: across the strongest structure)", NULL},
        {"map-theta-i-deg", DIF_OPT_REAL, &args->map_theta_deg, "[0, 90)", "DEG", "maps: incidence (default 30)", NULL},
        {"map-pixels", DIF_OPT_INT, &args->n_pixel, "[16, 1024]", "N",
         "maps: pixels across (default 97: odd, so that a row lies in the plane of incidence)", NULL},
        {"map-lambda-nm", DIF_OPT_RANGE, &args->layer_nm, "(0, inf)", "MIN:MAX:STEP",
         "maps: wavelengths (default 450:650:100)", NULL},
        {"colour-lambda-nm", DIF_OPT_RANGE, &args->colour_nm, "(0, inf)", "MIN:MAX:STEP",
         "colours: wavelengths that are summed (default 380:780:10)", NULL},
        {"azimuths", DIF_OPT_INT, &args->n_azimuth, "[16, 16384]", "N", "lut: columns (default 4096)", NULL},
        {"radii", DIF_OPT_INT, &args->n_radius, "[8, 4096]", "N", "lut: rows (default 320)", NULL},
        {"lut-lambda-nm", DIF_OPT_RANGE, &args->full_nm, "(0, inf)", "MIN:MAX:STEP",
         "lut and full sampling: wavelengths (default 380:780:2)", NULL},
        {"no-fit", DIF_OPT_FLAG, &args->no_fit, NULL, NULL, "do not fit periods", NULL},
        {"no-pictures", DIF_OPT_FLAG, &args->no_pictures, NULL, NULL, "numbers alone", NULL},
        {"Sample", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"tol", DIF_OPT_REAL, &args->tol_device, "[1e-14, 1)", "TOL",
         "of the sheets that the device reads (default 1e-7)", NULL},
        {"tol-reference", DIF_OPT_REAL, &args->tol_reference, "[1e-14, 1)", "TOL", "of those of the CPU (default 1e-9)",
         NULL},
        {"window", DIF_OPT_CHOICE, &args->window, "gauss|flat", NULL, "coherence window (default gauss)", NULL},
        {"sigma-um", DIF_OPT_REAL, &args->sigma_um, "(0, inf)", "UM", "its standard deviation (default 16.25)", NULL},
        {"average", DIF_OPT_CHOICE, &args->average, "none|welch", NULL,
         "none: one window at the centre (default); welch: many, with memory for each", NULL},
        {"grating-nm", DIF_OPT_REAL, &args->period_nm, "(0, inf)", "NM",
         "the period (default: known of built-in gratings; stam alone: that of the strongest structure)", NULL},
        {"groove-deg", DIF_OPT_REAL, &args->groove_deg, "[-360, 360]", "DEG", "azimuth of the groove normal", NULL},
        {"shadowing", DIF_OPT_CHOICE, &args->shadowing, "none|vcavity|smith|ndf", NULL,
         "colours: shadowing and masking in rho (default none)", NULL},
        {"n", DIF_OPT_REAL, &args->index_n, "(0, inf)", "N", "refractive index of the sample (default 1.5)", NULL},
        {"kappa", DIF_OPT_REAL, &args->index_kappa, "[0, inf)", "K", "its extinction (default 0)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_surface(cli, &args->surface);
}

static int print_thresholds(const dif_cli *cli, const dif_compare_args *args)
{
    dif_compare_limits limits;
    dif_error err = {0};
    if (dif_compare_limits_load(args->thresholds, &limits, &err) != DIF_OK)
        return dif_cmd_fail(cli->verb, &err);
    const int code = dif_json_print(cli, dif_compare_limits_json(&limits));
    dif_compare_limits_free(&limits);
    return code;
}

/* The last word: where the page lies, and the verdict as exit code. */
static int conclude(const dif_cli *cli, const char *folder, const dif_compare_verdict *verdict)
{
    if (cli->json) {
        char page[4096];
        snprintf(page, sizeof page, "%s/index.html", folder);
        const int code =
            dif_json_print(cli, json_pack("{s:s, s:b, s:i, s:i, s:i}", "page", page, "pass",
                                          (int)(verdict->n_failed == 0 && verdict->n_worse == 0), "cases", verdict->n,
                                          "failed", verdict->n_failed, "worse", verdict->n_worse));
        if (code != DIF_EXIT_DONE)
            return code;
    } else {
        printf("%s/index.html\n", folder);
    }
    if (verdict->n_failed > 0)
        return dif_cmd_outside(cli->verb, "%s: %d of %d cases outside a threshold, first %s", folder, verdict->n_failed,
                               verdict->n, verdict->first_failed);
    if (verdict->n_worse > 0)
        return dif_cmd_outside(cli->verb, "%s: %d numbers worse than the baseline or missing", folder,
                               verdict->n_worse);
    return DIF_EXIT_DONE;
}

static int execute(const dif_cli *cli, const dif_compare_args *args)
{
    const char *folder = args->rebuild ? args->rebuild : args->out;
    dif_error err = {0};
    dif_compare_verdict verdict = {0};
    dif_status status = args->rebuild ? DIF_OK : dif_compare_measure(cli, args, &verdict, &err);
    if (!status)
        status = dif_compare_build(folder, &err);
    return status ? dif_cmd_fail(cli->verb, &err) : conclude(cli, folder, &verdict);
}

/* What the options table cannot check. */
static int check_args(const dif_cli *cli, const dif_compare_args *args)
{
    const int n_mode = (args->out != NULL) + (args->rebuild != NULL) + args->print_thresholds;
    char unknown[32];
    if (n_mode != 1)
        return dif_cmd_usage(cli->verb, "expected exactly one of --out DIR, --rebuild DIR and --print-thresholds");
    if (!args->out && cli->n_operand > 0)
        return dif_cmd_usage(cli->verb, "%s compares nothing, expected no SURFACE",
                             args->rebuild ? "--rebuild" : "--print-thresholds");
    if (!dif_compare_methods_parse(args->methods, NULL, unknown))
        return dif_cmd_usage(cli->verb,
                             "--methods '%s': no method '%s', expected some of sheet,nmm,nmm-lines,pq,lut,stam",
                             args->methods, unknown);
    if (args->device == DIF_COMPARE_ON_CPU && (args->fault || args->half || args->require_hardware))
        return dif_cmd_usage(cli->verb, "--device cpu has no shaders: expected neither --fault, --half nor "
                                        "--require-hardware");
    return DIF_CLI_GO;
}

int dif_cmd_compare(int argc, char **argv)
{
    dif_compare_args args = dif_compare_args_default();
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_output_options(&cli, &args);
    add_question_options(&cli, &args);
    int code = dif_cli_parse(&cli, 0, DIF_OPERAND_MAX);
    if (code == DIF_CLI_GO)
        code = check_args(&cli, &args);
    if (code != DIF_CLI_GO)
        return code;
    dif_cli_use_threads(&cli);
    return args.print_thresholds ? print_thresholds(&cli, &args) : execute(&cli, &args);
}
