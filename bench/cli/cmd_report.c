/* diffbench report --out DIR [SURFACE...]: everything, one page. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/folder.h"
#include "bench/cli/plane.h"
#include "bench/cli/report_job.h"
#include "bench/scan.h"
#include "core/units.h"
#include "fixtures/surfaces.h"
#include "reports/report.h"
#include "reports/result.h"

static const dif_cli_help HELP = {
    "[SURFACE ...]",
    "Measures surfaces and writes DIR/index.html, one page that needs no other file, DIR/report.json with the same\n"
    "numbers, and the result files that both are made from: heightfields, tables, maxima, lines, fits, checks.\n"
    "Without a SURFACE it measures built-in ones: blazed, sinusoidal and lamellar gratings and two snake-like "
    "surfaces.\n"
    "If SOURCE_DATE_EPOCH is set, outputs are byte-identical from run to run; timings, which are not, are left out.\n",
    "  diffbench fixture sine --pixels 333 --out sine.gsf\n"
    "  diffbench report --out sine-report --angle-deg -80:0:0.1 --lambda-nm 400:700:20 sine.gsf\n"
    "  diffbench report --rebuild sine-report\n",
};

typedef struct report_args {
    dif_cli_surface surface;
    dif_cli_measure measure;
    double theta_i_deg, theta_r_deg, azimuth_deg;
    dif_range angle_deg, lambda_nm;
    bool no_map, no_methods, no_gpu, no_render, no_slopes, study;
    const char *out, *rebuild;
} report_args;

static void add_options(dif_cli *cli, report_args *args)
{
    const dif_opt opts[] = {
        {"Output (exactly one of the two)", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"out", DIF_OPT_TEXT, &args->out, NULL, "DIR", "folder to write to, made if it is not there", NULL},
        {"rebuild", DIF_OPT_TEXT, &args->rebuild, NULL, "DIR", "write the page again from DIR's result files", NULL},
        {"Plan", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"theta-i-deg", DIF_OPT_REAL, &args->theta_i_deg, "(-90, 90)", "DEG", "fixed angle of incidence (default 75)",
         NULL},
        {"theta-r-deg", DIF_OPT_REAL, &args->theta_r_deg, "(-90, 90)", "DEG", "or: fixed angle of the detector", NULL},
        {"angle-deg", DIF_OPT_RANGE, &args->angle_deg, "(-90, 90)", "MIN:MAX:STEP",
         "the other angle (default -85:85:0.05)", NULL},
        {"lambda-nm", DIF_OPT_RANGE, &args->lambda_nm, "(0, inf)", "MIN:MAX:STEP", "wavelengths (default 380:780:4)",
         NULL},
        {"azimuth-deg", DIF_OPT_REAL, &args->azimuth_deg, "[-360, 360]", "DEG",
         "of the plane of incidence (default: across the strongest structure)", NULL},
        {"Parts", DIF_OPT_HEADING, NULL, NULL, NULL, NULL, NULL},
        {"no-map", DIF_OPT_FLAG, &args->no_map, NULL, NULL, "leave out the BRDF maps", NULL},
        {"no-methods", DIF_OPT_FLAG, &args->no_methods, NULL, NULL, "leave out the comparison of methods", NULL},
        {"no-gpu", DIF_OPT_FLAG, &args->no_gpu, NULL, NULL, "leave out the comparison of GPU and CPU", NULL},
        {"no-render", DIF_OPT_FLAG, &args->no_render, NULL, NULL, "leave out the rendering", NULL},
        {"no-slopes", DIF_OPT_FLAG, &args->no_slopes, NULL, NULL, "leave out slopes, normals and views", NULL},
        {"study", DIF_OPT_FLAG, &args->study, NULL, NULL,
         "add studies of wavelength step, coherence, series and incidence, and published periods (minutes)", NULL},
    };
    dif_cli_add(cli, opts, DIF_COUNT(opts));
    dif_cli_add_measure(cli, &args->measure, false);
    dif_cli_add_surface(cli, &args->surface);
}

enum { WALL_SAMPLES = 1300 };

/* The built-in surfaces. */
static const struct {
    dif_surface_kind kind;
    const char *title, *description;
    bool is_grating;
    dif_profile profile;
} FIXTURES[] = {
    {DIF_SURFACE_BLAZED, "Blazed grating", "Built-in synthetic surface: a sawtooth whose steep wall faces the light.",
     true, DIF_PROFILE_BLAZED},
    {DIF_SURFACE_SINE, "Sinusoidal grating", "Built-in synthetic surface: the smooth grating with a closed form.", true,
     DIF_PROFILE_SINE},
    {DIF_SURFACE_LAMELLAR, "Lamellar grating",
     "Built-in synthetic surface: equal lands and grooves with vertical walls.", true, DIF_PROFILE_LAMELLAR},
    {DIF_SURFACE_ELAPHE, "Snake-like surface, corn snake",
     "Built-in synthetic surface: irregular rows of nanostructure like those on the scales of Elaphe guttata.", false,
     0},
    {DIF_SURFACE_XENOPELTIS, "Snake-like surface, sunbeam snake",
     "Built-in synthetic surface: fine, fairly regular ridges like those on the scales of Xenopeltis unicolor.", false,
     0},
};

static dif_status describe_fixture(const dif_cli *cli, const dif_surface *surface, dif_report_job *job, dif_error *err)
{
    dif_field_file file = {.field = job->field, .format = "built-in fixture"};
    dif_status status = dif_cli_manifest(cli, NULL, &job->provenance, err);
    if (!status)
        status = dif_manifest_set(&job->provenance, "fixture", dif_surface_kind_name(surface->kind), err);
    if (!status)
        status =
            dif_manifest_setf(&job->provenance, err, "fixture_period_nm", "%.12g", dif_nm_from_um(surface->period_um));
    if (!status)
        status =
            dif_manifest_setf(&job->provenance, err, "fixture_height_nm", "%.12g", dif_nm_from_um(surface->height_um));
    if (!status)
        status = dif_manifest_setf(&job->provenance, err, "fixture_seed", "%u", surface->seed);
    return status ? status : dif_cli_manifest_surface(&job->provenance, &file, err);
}

static dif_status load_fixture(const dif_cli *cli, int i, dif_report_job *job, dif_error *err)
{
    dif_surface surface = dif_surface_default(FIXTURES[i].kind);
    if (surface.kind == DIF_SURFACE_BLAZED || surface.kind == DIF_SURFACE_LAMELLAR) {
        surface.nx = surface.ny = WALL_SAMPLES; /* 50 a period: every wall stands between two pixels */
        surface.pitch_um = 65.0 / WALL_SAMPLES;
    }
    snprintf(job->title, sizeof job->title, "%s", FIXTURES[i].title);
    snprintf(job->slug, sizeof job->slug, "%s", dif_surface_kind_name(surface.kind));
    snprintf(job->description, sizeof job->description, "%s", FIXTURES[i].description);
    job->known_period_um = surface.period_um;
    job->known_exact = job->has_grating = job->is_grating = FIXTURES[i].is_grating;
    job->grating =
        (dif_grating){FIXTURES[i].profile, surface.period_um, surface.height_um, surface.duty, surface.psi_rad};
    const dif_status status = dif_surface_make(&surface, &job->field, err);
    return status ? status : describe_fixture(cli, &surface, job, err);
}

/* Is it one of our own gratings? kind is what `fixture` wrote into its file, or NULL. */
static bool is_grating_kind(const char *kind)
{
    dif_profile profile;
    return kind && dif_profile_from_name(kind, &profile);
}

static dif_status load_file(const dif_cli *cli, const report_args *args, int i, dif_report_job *job, dif_error *err)
{
    const char *path = cli->operand[i], *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
    dif_field_file file;
    dif_status status = dif_cli_surface_read(cli, path, &args->surface, &file, err);
    if (status)
        return status;
    dif_progress none = dif_progress_begin("", true);
    job->opts = dif_cli_measure_opts(cli, &args->measure, &file, &none);
    snprintf(job->title, sizeof job->title, "%s", name);
    dif_folder_slug(path, i + 1, cli->n_operand, job->slug);
    snprintf(job->description, sizeof job->description, "Surface read from a %s file%s%s.%s%s", file.format,
             file.title[0] ? ", titled " : "", file.title, file.warning[0] ? " " : "", file.warning);
    job->known_period_um = NAN;
    job->is_grating = is_grating_kind(dif_cli_fixture_kind(file.title));
    job->step_um = file.step_um;
    status = dif_cli_manifest(cli, path, &job->provenance, err);
    if (!status)
        status = dif_cli_manifest_surface(&job->provenance, &file, err);
    job->field = file.field;
    file.field = (dif_field){0};
    dif_field_file_free(&file);
    return status;
}

static dif_status choose_plane(const report_args *args, dif_report_job *job, double *azimuth_deg, dif_error *err)
{
    const dif_spectrum_peak known = {.period_um = job->grating.period_um, .psi_rad = job->grating.psi_rad};
    dif_cli_plane plane;
    const dif_status status = dif_cli_plane_choose(&job->field, job->has_grating ? &known : NULL, job->is_grating,
                                                   job->opts.sigma_um, args->azimuth_deg, &plane, err);
    *azimuth_deg = plane.azimuth_deg;
    job->f_min_per_um = plane.f_min_per_um;
    job->f_max_per_um = plane.f_max_per_um;
    return status;
}

static dif_status load(const dif_cli *cli, const report_args *args, int i, dif_report_job *job, dif_error *err)
{
    const bool built_in = cli->n_operand == 0;
    *job = (dif_report_job){.tol = args->measure.tol,
                            .want_map = !args->no_map,
                            .want_methods = !args->no_methods,
                            .want_gpu = !args->no_gpu,
                            .want_render = !args->no_render,
                            .want_slopes = !args->no_slopes,
                            .want_study = args->study};
    dif_status status = built_in ? load_fixture(cli, i, job, err) : load_file(cli, args, i, job, err);
    if (status)
        return status;
    if (built_in) {
        dif_progress none = dif_progress_begin("", true);
        const dif_field_file nothing = {0};
        job->opts = dif_cli_measure_opts(cli, &args->measure, &nothing, &none);
        if (args->measure.average == DIF_AVERAGE_BY_SURFACE) /* a perfect grating has no speckle to average */
            job->opts.average = job->has_grating ? DIF_AVERAGE_NONE : DIF_AVERAGE_WELCH;
    }
    job->opts.progress = NULL;
    job->opts.progress_self = NULL;
    double azimuth_deg;
    status = choose_plane(args, job, &azimuth_deg, err);
    const bool fixed_is_wo = !isnan(args->theta_r_deg);
    const double fixed_deg = fixed_is_wo ? args->theta_r_deg : isnan(args->theta_i_deg) ? 75.0 : args->theta_i_deg;
    if (!status)
        status =
            dif_scan_plan(fixed_is_wo, fixed_deg, azimuth_deg, &args->angle_deg, &args->lambda_nm, &job->plan, err);
    return status;
}

/* Measures surface i and writes its files; its file name goes into the list. */
static dif_status run_surface(const dif_cli *cli, const report_args *args, int i, json_t *names, int *n_outside,
                              dif_error *err)
{
    dif_report_job job;
    dif_report_data data = {0};
    bool outside = false;
    dif_status status = load(cli, args, i, &job, err);
    if (!status) {
        dif_cli_say(cli, "%s: measuring", job.title);
        status = dif_report_measure(&job, &data, err);
    }
    if (!status)
        status = dif_cli_manifest_measure(&job.provenance, job.tol, &job.opts, &data.stats, err);
    if (!status)
        status = dif_report_write(args->out, &job, &data, &outside, err);
    char name[128];
    snprintf(name, sizeof name, "%s.json", job.slug);
    if (!status && json_array_append_new(names, json_string(name)) != 0)
        status = dif_fail(err, DIF_ERR_NOMEM, "list of surfaces");
    *n_outside += outside;
    dif_report_data_free(&data);
    dif_report_job_free(&job);
    return status;
}

static dif_status write_list(const dif_cli *cli, const report_args *args, json_t *names, dif_error *err)
{
    dif_manifest manifest;
    dif_status status = dif_cli_manifest(cli, NULL, &manifest, err);
    if (status)
        return status;
    dif_report_period_found bitmap = {0};
    if (args->study)
        status = dif_report_source_bitmap(&bitmap, err);
    if (status) {
        dif_manifest_free(&manifest);
        return status;
    }
    json_t *list = json_pack("{s:s, s:s, s:o, s:O}", "schema", DIF_RESULT_LIST_SCHEMA, "title",
                             "Diffraction bench report", "provenance", dif_json_manifest(&manifest), "surfaces", names);
    if (list && args->study)
        json_object_set_new(list, "source_bitmap",
                            json_pack("{s:f, s:f, s:o, s:o}", "full_nm", 2499.997, "full_sd_nm", 0.377, "thesis_nm",
                                      dif_json_number(dif_nm_from_um(bitmap.mean_um)), "thesis_sd_nm",
                                      dif_json_number(dif_nm_from_um(bitmap.sd_um))));
    status = list ? dif_report_write_json(args->out, "results.json", list, err)
                  : dif_fail(err, DIF_ERR_NOMEM, "list of surfaces");
    json_decref(list);
    dif_manifest_free(&manifest);
    return status;
}

static dif_status measure_all(const dif_cli *cli, const report_args *args, int *n_outside, dif_error *err)
{
    const int n = cli->n_operand > 0 ? cli->n_operand : DIF_COUNT(FIXTURES);
    json_t *names = json_array();
    dif_status status = names ? dif_folder_make(args->out, err) : dif_fail(err, DIF_ERR_NOMEM, "list of surfaces");
    for (int i = 0; !status && i < n; i++)
        status = run_surface(cli, args, i, names, n_outside, err);
    if (!status)
        status = write_list(cli, args, names, err);
    json_decref(names);
    return status;
}

static int execute(const dif_cli *cli, const report_args *args)
{
    const char *folder = args->rebuild ? args->rebuild : args->out;
    dif_error err = {0};
    int n_outside = 0;
    dif_status status = args->rebuild ? DIF_OK : measure_all(cli, args, &n_outside, &err);
    if (!status)
        status = dif_report_build(folder, &err);
    if (status)
        return dif_cmd_fail(cli->verb, &err);
    if (cli->json) {
        char page[4096], report[4096];
        snprintf(page, sizeof page, "%s/index.html", folder);
        snprintf(report, sizeof report, "%s/report.json", folder);
        const int code = dif_json_print(
            cli, json_pack("{s:s, s:s, s:i}", "page", page, "report", report, "surfaces_outside", n_outside));
        if (code != DIF_EXIT_DONE)
            return code;
    } else {
        printf("%s/index.html\n", folder);
    }
    if (n_outside > 0)
        return dif_cmd_outside(cli->verb, "%s: %d of %d surfaces outside a limit; the page's summary says which",
                               folder, n_outside, cli->n_operand > 0 ? cli->n_operand : DIF_COUNT(FIXTURES));
    return DIF_EXIT_DONE;
}

int dif_cmd_report(int argc, char **argv)
{
    report_args args = {.surface = dif_cli_surface_default(),
                        .measure = dif_cli_measure_default(),
                        .theta_i_deg = NAN,
                        .theta_r_deg = NAN,
                        .azimuth_deg = NAN,
                        .angle_deg = {-85.0, 85.0, 0.05, 3401},
                        .lambda_nm = {380.0, 780.0, 4.0, 101}};
    dif_cli cli;
    dif_cli_begin(&cli, argc, argv, &HELP);
    add_options(&cli, &args);
    const int code = dif_cli_parse(&cli, 0, DIF_OPERAND_MAX);
    if (code != DIF_CLI_GO)
        return code;
    if (!args.out == !args.rebuild)
        return dif_cmd_usage(cli.verb, "expected exactly one of --out DIR and --rebuild DIR");
    if (args.rebuild && cli.n_operand > 0)
        return dif_cmd_usage(cli.verb, "--rebuild measures nothing, expected no SURFACE");
    if (!isnan(args.theta_i_deg) && !isnan(args.theta_r_deg))
        return dif_cmd_usage(cli.verb, "expected at most one of --theta-i-deg and --theta-r-deg");
    dif_cli_use_threads(&cli);
    return execute(&cli, &args);
}
