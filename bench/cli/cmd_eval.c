/* diffbench eval SURFACE --queries Q.csv: arbitrary directions and wavelengths. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/csv_out.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/table_io.h"

static const dif_cli_help HELP = {
    "SURFACE",
    "Measures arbitrary directions. The queries are a CSV file with the columns theta_i_deg, phi_i_deg, theta_r_deg,\n"
    "phi_r_deg and lambda_nm; out come the same columns and power, rho and brdf (sr^-1).\n",
    "  diffbench fixture sine --period-nm 1600 --height-nm 120 --size-um 40 --pixels 256 --out sine.exr\n"
    "  diffbench orders --period-nm 1600 --theta-i-deg 20 --lambda-nm 550 --queries > queries.csv\n"
    "  diffbench eval sine.exr --queries queries.csv --tol 1e-9\n",
};

enum { QUERY_BYTES_MAX = 1 << 30 };

typedef struct eval_args {
    dif_cli_surface surface;
    dif_cli_measure measure;
    const char *queries, *out;
    bool amplitude;
} eval_args;

static void add_options(dif_cli *cli, eval_args *args)
{
    const dif_opt opts[] = {
        {"Queries and output", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"queries", DIF_OPT_TEXT, &args->queries, NULL, "Q.csv", "the queries; - is stdin (needed)", NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "F.csv", "where to write (default: stdout)", NULL},
        {"amplitude", DIF_OPT_FLAG, &args->amplitude, NULL, NULL,
         "also amplitude_re and amplitude_im, P/sum W; means --average none", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_measure(cli, &args->measure, false);
    dif_cli_add_shadowing(cli, &args->measure);
    dif_cli_add_surface(cli, &args->surface);
}

typedef struct eval_run {
    dif_field_file file;
    dif_manifest manifest;
    size_t n;
    dif_query *query;
    double (*degrees)[5];
    dif_sample *sample;
    dif_measure_opts opts;
    dif_measure_stats stats;
    dif_shadow shadow;
    int n_checked;
    double worst_error; /* of the amplitude, on the checked queries */
    size_t worst_at;
} eval_run;

static void run_free(eval_run *run)
{
    dif_field_file_free(&run->file);
    dif_manifest_free(&run->manifest);
    dif_shadow_free(&run->shadow);
    dif_release(run->query);
    dif_release(run->degrees);
    dif_release(run->sample);
}

/* Reads the queries; their sha256 goes into the provenance, because stdin cannot be read twice. */
static dif_status read_queries(const eval_args *args, eval_run *run, dif_error *err)
{
    const bool is_stdin = strcmp(args->queries, "-") == 0;
    const char *name = is_stdin ? "stdin" : args->queries;
    unsigned char *data = NULL;
    size_t n = 0;
    char hex[65];
    dif_status status = dif_file_read(is_stdin ? "/dev/stdin" : name, QUERY_BYTES_MAX, &data, &n, err);
    if (status)
        return status;
    dif_sha256_hex(data, n, hex);
    status = dif_queries_parse(data, n, name, &run->n, &run->query, &run->degrees, err);
    dif_release(data);
    if (!status && run->n == 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: no queries, expected rows below the column names", name);
    if (!status)
        status = dif_manifest_set(&run->manifest, "queries", name, err);
    return status ? status : dif_manifest_set(&run->manifest, "queries_sha256", hex, err);
}

static dif_status measure(const dif_cli *cli, const eval_args *args, eval_run *run, dif_error *err)
{
    dif_progress progress = dif_progress_begin(cli->verb, cli->quiet);
    dif_status status = dif_cli_check_out(args->out, err);
    if (!status)
        status = dif_cli_surface_read(cli, cli->operand[0], &args->surface, &run->file, err);
    if (!status)
        status = dif_cli_manifest(cli, cli->operand[0], &run->manifest, err);
    if (!status)
        status = dif_cli_manifest_surface(&run->manifest, &run->file, err);
    if (!status)
        status = read_queries(args, run, err);
    if (status)
        return status;
    run->sample = dif_alloc(run->n, sizeof *run->sample);
    if (!run->sample)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu samples", run->n);
    run->opts = dif_cli_measure_opts(cli, &args->measure, &run->file, &progress);
    if (args->amplitude)
        run->opts.average = DIF_AVERAGE_NONE;
    status = dif_cli_measure_period(cli, &run->file, &run->opts, err);
    if (!status)
        status = dif_cli_measure_shadow(cli, &args->measure, &run->file, &run->opts, &run->shadow, err);
    if (!status)
        status = dif_measure_queries(&run->file.field, run->n, run->query, args->measure.tol, &run->opts, run->sample,
                                     &run->stats, err);
    dif_progress_end(&progress);
    run->opts.progress = NULL; /* the bar ends here, the options live on */
    run->opts.progress_self = NULL;
    return status ? status : dif_cli_manifest_measure(&run->manifest, args->measure.tol, &run->opts, &run->stats, err);
}

/* |amplitude error|, or that of its modulus where windows were averaged. */
static double error_of(const dif_sample *got, const dif_sample *want)
{
    if (isnan(got->amp_re))
        return fabs(sqrt(got->power) - sqrt(want->power));
    return hypot(got->amp_re - want->amp_re, got->amp_im - want->amp_im);
}

/* Measures some queries, spread by a golden-section stride, by the direct sum. */
static dif_status check(const eval_args *args, eval_run *run, dif_error *err)
{
    static const double golden = 0.6180339887498949;
    const size_t n_wanted = (size_t)args->measure.n_check, n = n_wanted < run->n ? n_wanted : run->n;
    dif_measure_opts opts = run->opts;
    opts.method = DIF_METHOD_DIRECT;
    for (size_t i = 0; i < n; i++) {
        const double turn = (double)i * golden;
        const size_t at = n == run->n ? i : (size_t)((turn - floor(turn)) * (double)run->n);
        dif_sample direct;
        dif_measure_stats stats;
        const dif_status status =
            dif_measure_queries(&run->file.field, 1, &run->query[at], args->measure.tol, &opts, &direct, &stats, err);
        if (status)
            return status;
        const double error = error_of(&run->sample[at], &direct);
        if (!(error <= run->worst_error)) {
            run->worst_error = error;
            run->worst_at = at;
        }
        run->n_checked++;
    }
    return DIF_OK;
}

static dif_status describe_check(eval_run *run, dif_error *err)
{
    if (run->n_checked == 0)
        return DIF_OK;
    const dif_status status = dif_manifest_setf(&run->manifest, err, "check_samples", "%d", run->n_checked);
    return status ? status
                  : dif_manifest_setf(&run->manifest, err, "check_worst_amplitude_error", "%.3g", run->worst_error);
}

/* Says what the check found; exit 1 if it is over the tolerance. */
static int judge_check(const dif_cli *cli, const eval_args *args, const eval_run *run)
{
    if (run->n_checked == 0)
        return DIF_EXIT_DONE;
    dif_cli_say(cli, "checked %d queries: largest amplitude error %.3g (tol %.3g) at query %zu", run->n_checked,
                run->worst_error, args->measure.tol, run->worst_at + 1);
    if (run->worst_error <= args->measure.tol)
        return DIF_EXIT_DONE;
    return dif_cmd_outside(cli->verb, "%s: amplitude error %.3g at query %zu, expected at most %.3g (--tol)",
                           cli->operand[0], run->worst_error, run->worst_at + 1, args->measure.tol);
}

static void print_csv(FILE *stream, const eval_args *args, const eval_run *run)
{
    dif_csv_out_provenance(stream, &run->manifest);
    fprintf(stream, "theta_i_deg,phi_i_deg,theta_r_deg,phi_r_deg,lambda_nm,power,rho,brdf%s\n",
            args->amplitude ? ",amplitude_re,amplitude_im" : "");
    for (size_t i = 0; i < run->n; i++) {
        const double *d = run->degrees[i];
        const dif_sample *s = &run->sample[i];
        fprintf(stream, "%.12g,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g", d[0], d[1], d[2], d[3], d[4], s->power,
                s->rho, s->brdf_per_sr);
        if (args->amplitude)
            fprintf(stream, ",%.15g,%.15g", s->amp_re, s->amp_im);
        fputc('\n', stream);
    }
}

static json_t *json_sample(const double *degrees, const dif_sample *sample, bool amplitude)
{
    json_t *object = json_pack("{s:f, s:f, s:f, s:f, s:f}", "theta_i_deg", degrees[0], "phi_i_deg", degrees[1],
                               "theta_r_deg", degrees[2], "phi_r_deg", degrees[3], "lambda_nm", degrees[4]);
    json_object_set_new(object, "power", dif_json_number(sample->power));
    json_object_set_new(object, "rho", dif_json_number(sample->rho));
    json_object_set_new(object, "brdf", dif_json_number(sample->brdf_per_sr));
    if (amplitude) {
        json_object_set_new(object, "amplitude_re", dif_json_number(sample->amp_re));
        json_object_set_new(object, "amplitude_im", dif_json_number(sample->amp_im));
    }
    return object;
}

static json_t *json_run(const eval_args *args, const eval_run *run)
{
    json_t *samples = json_array();
    for (size_t i = 0; i < run->n; i++)
        json_array_append_new(samples, json_sample(run->degrees[i], &run->sample[i], args->amplitude));
    return json_pack("{s:o, s:o, s:o}", "provenance", dif_json_manifest(&run->manifest), "cost",
                     dif_json_stats(&run->stats), "samples", samples);
}

static int execute(const dif_cli *cli, const eval_args *args)
{
    dif_error err = {0};
    eval_run run = {0};
    dif_csv_out out = {0};
    int code = DIF_EXIT_DONE;
    dif_status status = measure(cli, args, &run, &err);
    if (!status)
        status = check(args, &run, &err);
    if (!status)
        status = describe_check(&run, &err);
    if (!status && (args->out || !cli->json)) {
        status = dif_csv_out_open(args->out, &out, &err);
        if (!status) {
            print_csv(out.stream, args, &run);
            status = dif_csv_out_close(&out, &err);
        }
    }
    if (status)
        code = dif_cmd_fail(cli->verb, &err);
    else
        dif_cli_say_stats(cli, &run.stats);
    if (!status && cli->json)
        code = dif_json_print(cli, json_run(args, &run));
    if (code == DIF_EXIT_DONE)
        code = judge_check(cli, args, &run);
    run_free(&run);
    return code;
}

int dif_cmd_eval(int argc, char **argv)
{
    eval_args args = {.surface = dif_cli_surface_default(), .measure = dif_cli_measure_default()};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    const int code = dif_cli_parse(&cli, 1, 1);
    if (code != DIF_CLI_GO)
        return code;
    if (!args.queries)
        return dif_cmd_usage(cli.verb, "no queries, expected --queries Q.csv (or - for stdin)");
    if (args.amplitude && args.measure.average == DIF_AVERAGE_WELCH)
        return dif_cmd_usage(cli.verb, "--amplitude with --average welch: an average of powers has no amplitude");
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
