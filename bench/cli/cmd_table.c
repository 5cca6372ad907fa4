/* diffbench table SURFACE: the angle-wavelength response table. */
#include <math.h>
#include <stdio.h>

#include "bench/cli/cli.h"
#include "bench/scan.h"
#include "core/io/table_io.h"
#include "core/units.h"

static const dif_cli_help HELP = {
    "SURFACE",
    "Measures the angle-wavelength response table of a surface: one of the two angles is fixed, the other one runs in\n"
    "the same plane. Angles are signed: a positive one leans towards the plane's azimuth.\n",
    "  diffbench fixture blazed --pixels 512 --out blazed.gsf\n"
    "  diffbench table blazed.gsf --theta-i-deg 75 --angle-deg -55:-40:0.05 --lambda-nm 380:780:10 --out blazed.csv\n",
};

typedef struct table_args {
    dif_cli_surface surface;
    dif_cli_measure measure;
    double theta_i_deg, theta_r_deg, azimuth_deg;
    dif_range angle_deg, lambda_nm;
    const char *out;
    int layout;
} table_args;

static void add_options(dif_cli *cli, table_args *args)
{
    const dif_opt opts[] = {
        {"Plan (exactly one of the two angles is fixed)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"theta-i-deg", DIF_OPT_REAL, &args->theta_i_deg, "(-90, 90)", "DEG", "fixed angle of incidence", NULL},
        {"theta-r-deg", DIF_OPT_REAL, &args->theta_r_deg, "(-90, 90)", "DEG", "or: fixed angle of the detector", NULL},
        {"angle-deg", DIF_OPT_RANGE, &args->angle_deg, "(-90, 90)", "MIN:MAX:STEP",
         "the other angle (default -85:85:0.1)", NULL},
        {"lambda-nm", DIF_OPT_RANGE, &args->lambda_nm, "(0, inf)", "MIN:MAX:STEP", "wavelengths (default 380:780:5)",
         NULL},
        {"azimuth-deg", DIF_OPT_REAL, &args->azimuth_deg, "[-360, 360]", "DEG", "of the plane (default 0)", NULL},
    };
    const dif_opt output[] = {
        {"Output", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F", "F.csv or F.exr (default: CSV on stdout)", NULL},
        {"layout", DIF_OPT_CHOICE, &args->layout, "tidy|matrix", NULL,
         "CSV: one row a sample (default), or wavelengths down and angles across", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_measure(cli, &args->measure, true);
    dif_cli_add_shadowing(cli, &args->measure);
    dif_cli_add(cli, output, DIF_COUNT(output));
    dif_cli_add_surface(cli, &args->surface);
}

/* Everything that one run makes. */
typedef struct table_run {
    dif_field_file file;
    dif_plan plan;
    dif_table table;
    dif_manifest manifest;
    dif_measure_opts opts;
    dif_measure_stats stats;
    dif_shadow shadow;
    dif_measure_check check;
} table_run;

static void run_free(table_run *run)
{
    dif_field_file_free(&run->file);
    dif_plan_free(&run->plan);
    dif_table_free(&run->table);
    dif_manifest_free(&run->manifest);
    dif_shadow_free(&run->shadow);
}

static dif_status measure(const dif_cli *cli, const table_args *args, table_run *run, dif_error *err)
{
    dif_progress progress = dif_progress_begin(cli->verb, cli->quiet);
    const bool fixed_is_wo = !isnan(args->theta_r_deg);
    const double fixed_deg = fixed_is_wo ? args->theta_r_deg : args->theta_i_deg;
    dif_status status =
        dif_scan_plan(fixed_is_wo, fixed_deg, args->azimuth_deg, &args->angle_deg, &args->lambda_nm, &run->plan, err);
    if (!status)
        status = dif_cli_check_out(args->out, err);
    if (!status)
        status = dif_cli_surface_read(cli, cli->operand[0], &args->surface, &run->file, err);
    if (status)
        return status;
    run->opts = dif_cli_measure_opts(cli, &args->measure, &run->file, &progress);
    status = dif_cli_measure_period(cli, &run->file, &run->opts, err);
    if (!status)
        status = dif_cli_measure_shadow(cli, &args->measure, &run->file, &run->opts, &run->shadow, err);
    if (!status)
        status = dif_measure_table(&run->file.field, &run->plan, args->measure.tol, &run->opts, &run->table,
                                   &run->stats, err);
    if (!status && args->measure.n_check > 0)
        status = dif_measure_check_table(&run->file.field, &run->table, &run->opts, args->measure.n_check, 1,
                                         &run->check, err);
    dif_progress_end(&progress);
    run->opts.progress = NULL; /* the bar ends here, the options live on */
    run->opts.progress_self = NULL;
    return status;
}

static dif_status describe_check(table_run *run, dif_error *err)
{
    const dif_measure_check *check = &run->check;
    dif_status status = dif_manifest_setf(&run->manifest, err, "check_samples", "%d", check->n_sample);
    if (status || (status = dif_manifest_setf(&run->manifest, err, "check_worst_amplitude_error", "%.3g",
                                              check->worst_amplitude)))
        return status;
    return dif_manifest_setf(&run->manifest, err, "check_worst_at", "angle %.9g deg, %.9g nm", check->worst_angle_deg,
                             check->worst_lambda_nm);
}

/* The plan and the quantity are written by core/io/table_io.h itself. */
static dif_status describe(const dif_cli *cli, const table_args *args, table_run *run, dif_error *err)
{
    dif_manifest *manifest = &run->manifest;
    dif_status status = dif_cli_manifest(cli, cli->operand[0], manifest, err);
    if (!status)
        status = dif_cli_manifest_surface(manifest, &run->file, err);
    if (!status)
        status = dif_cli_manifest_measure(manifest, args->measure.tol, &run->opts, &run->stats, err);
    return status || args->measure.n_check == 0 ? status : describe_check(run, err);
}

static json_t *json_axis(const double *value, int n, double (*convert)(double))
{
    json_t *axis = json_array();
    for (int i = 0; i < n; i++)
        json_array_append_new(axis, dif_json_number(convert(value[i])));
    return axis;
}

/* Rows of values, one a wavelength. */
static json_t *json_values(const dif_table *table)
{
    json_t *rows = json_array();
    for (int j = 0; j < table->plan.n_lambda; j++) {
        json_t *row = json_array();
        for (int i = 0; i < table->plan.n_angle; i++)
            json_array_append_new(row,
                                  dif_json_number(table->value[(size_t)j * (size_t)table->plan.n_angle + (size_t)i]));
        json_array_append_new(rows, row);
    }
    return rows;
}

/* The whole table, or only what it is if it went to a file. */
static json_t *json_table(const table_args *args, const table_run *run)
{
    const dif_plan *plan = &run->table.plan;
    json_t *object =
        json_pack("{s:s, s:s, s:s, s:f, s:f}", "quantity", dif_quantity_name(run->table.quantity), "unit",
                  dif_quantity_unit(run->table.quantity), "fixed_angle", plan->fixed_is_wo ? "theta_r" : "theta_i",
                  "fixed_deg", dif_deg_from_rad(plan->fixed_rad), "azimuth_deg", dif_deg_from_rad(plan->azimuth_rad));
    json_object_set_new(object, "provenance", dif_json_manifest(&run->manifest));
    json_object_set_new(object, "cost", dif_json_stats(&run->stats));
    if (args->measure.n_check > 0)
        json_object_set_new(object, "check",
                            json_pack("{s:i, s:f, s:f, s:f, s:f, s:f}", "samples", run->check.n_sample,
                                      "worst_amplitude_error", run->check.worst_amplitude, "angle_deg",
                                      run->check.worst_angle_deg, "lambda_nm", run->check.worst_lambda_nm, "value",
                                      run->check.worst_value, "direct", run->check.worst_direct));
    if (args->out) {
        json_object_set_new(object, "out", json_string(args->out));
        return object;
    }
    json_object_set_new(object, "angle_deg", json_axis(plan->angle_rad, plan->n_angle, dif_deg_from_rad));
    json_object_set_new(object, "lambda_nm", json_axis(plan->lambda_um, plan->n_lambda, dif_nm_from_um));
    json_object_set_new(object, "value", json_values(&run->table));
    return object;
}

static void say(const dif_cli *cli, const table_args *args, const table_run *run)
{
    const char *average = run->opts.average == DIF_AVERAGE_WELCH ? "welch" : "none";
    dif_cli_say(cli, "%s of %d angles x %d wavelengths, average %s%s", dif_quantity_name(run->table.quantity),
                run->plan.n_angle, run->plan.n_lambda, average,
                args->measure.average == DIF_AVERAGE_BY_SURFACE ? " (by default; --average chooses)" : "");
    dif_cli_say_stats(cli, &run->stats);
    if (args->measure.n_check > 0)
        dif_cli_say(cli,
                    "checked %d cells: largest amplitude error %.3g (tol %.3g) at %.6g deg, %.6g nm: %.9g, direct %.9g",
                    run->check.n_sample, run->check.worst_amplitude, args->measure.tol, run->check.worst_angle_deg,
                    run->check.worst_lambda_nm, run->check.worst_value, run->check.worst_direct);
}

static int report_check(const dif_cli *cli, const table_args *args, const dif_measure_check *check)
{
    if (args->measure.n_check == 0 || check->worst_amplitude <= args->measure.tol)
        return DIF_EXIT_DONE;
    return dif_cmd_outside(
        cli->verb, "%s: amplitude error %.3g at angle %.6g deg, %.6g nm, expected at most %.3g (--tol)",
        cli->operand[0], check->worst_amplitude, check->worst_angle_deg, check->worst_lambda_nm, args->measure.tol);
}

static int execute(const dif_cli *cli, const table_args *args)
{
    dif_error err = {0};
    table_run run = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = measure(cli, args, &run, &err);
    if (!status)
        status = describe(cli, args, &run, &err);
    if (!status)
        say(cli, args, &run);
    if (!status && (args->out || !cli->json))
        status = dif_table_write(args->out, &run.table, (dif_layout)args->layout, &run.manifest, &err);
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    else if (cli->json)
        code = dif_json_print(cli, json_table(args, &run));
    if (code == DIF_EXIT_DONE)
        code = report_check(cli, args, &run.check);
    run_free(&run);
    return code;
}

int dif_cmd_table(int argc, char **argv)
{
    table_args args = {.surface = dif_cli_surface_default(),
                       .measure = dif_cli_measure_default(),
                       .theta_i_deg = NAN,
                       .theta_r_deg = NAN,
                       .angle_deg = {-85.0, 85.0, 0.1, 1701},
                       .lambda_nm = {380.0, 780.0, 5.0, 81}};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    const int code = dif_cli_parse(&cli, 1, 1);
    if (code != DIF_CLI_GO)
        return code;
    if (isnan(args.theta_i_deg) == isnan(args.theta_r_deg))
        return dif_cmd_usage(cli.verb, "expected exactly one of --theta-i-deg and --theta-r-deg (the other angle runs, "
                                       "--angle-deg)");
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
