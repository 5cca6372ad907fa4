#define _POSIX_C_SOURCE 200809L /* clock_gettime */

#include <math.h>
#include <time.h>

#include "bench/cli/report_job.h"
#include "bench/energy.h"
#include "bench/table_cut.h"
#include "core/alloc.h"
#include "core/units.h"

/* Cells compared with the direct sum: this many, less where several windows make the sum dearer. */
enum { CHECK_N = 200, CHECK_N_MIN = 40, CHECK_SEED = 1, LINE_BIN_MAX = 3000 };
static const double fit_angle_max_rad = 75.0 * DIF_PI / 180.0; /* beyond it gains rise too fast for a ridge model */
/* Maxima below this share of the largest value are side lobes of a grating's lines, or a scan's speckle. */
static const double grating_floor = 2e-3, scan_floor = 0.05;

typedef struct clock_pair {
    double wall_s, cpu_s;
} clock_pair;

static clock_pair now(void)
{
    struct timespec wall = {0}, cpu = {0};
    clock_gettime(CLOCK_MONOTONIC, &wall);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
    return (clock_pair){(double)wall.tv_sec + 1e-9 * (double)wall.tv_nsec,
                        (double)cpu.tv_sec + 1e-9 * (double)cpu.tv_nsec};
}

static void add_stage(dif_report_data *data, const char *name, double wall_s, double cpu_s)
{
    if (data->n_stage < DIF_REPORT_STAGE_MAX)
        data->stage[data->n_stage++] = (dif_report_stage){name, wall_s, cpu_s};
}

static void add_stage_since(dif_report_data *data, const char *name, clock_pair start)
{
    const clock_pair end = now();
    add_stage(data, name, end.wall_s - start.wall_s, end.cpu_s - start.cpu_s);
}

/* The normalised power of cell (il, ia): the table's value without its gain. */
static double cell_power(const dif_report_job *job, const dif_report_data *data, int il, int ia)
{
    dif_vec3 wi, wo;
    dif_plan_directions(&data->table.plan, ia, &wi, &wo);
    const double gain = dif_brdf_gain(data->table.quantity, job->opts.index, wi, wo, data->table.plan.lambda_um[il],
                                      data->stats.area_um2);
    return data->table.value[(size_t)il * (size_t)data->table.plan.n_angle + (size_t)ia] / gain;
}

dif_status dif_report_fold(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    const dif_plan *plan = &data->table.plan;
    double f_min = INFINITY, f_max = -INFINITY, sin_sum, cos_sum;
    for (int ia = 0; ia < plan->n_angle; ia++) {
        dif_plan_transfer(plan, ia, &sin_sum, &cos_sum);
        for (int k = 0; k < 2; k++) {
            const double f = sin_sum / plan->lambda_um[k ? plan->n_lambda - 1 : 0];
            f_min = fmin(f_min, f);
            f_max = fmax(f_max, f);
        }
    }
    /* a third of the narrowest line, as far as the number of bins allows */
    const double width = 1.0 / (3.0 * 2.0 * sqrt(2.0) * DIF_PI * job->opts.sigma_um);
    const double wanted = (f_max - f_min) / width;
    const int n = wanted < 1.0 ? 1 : wanted < LINE_BIN_MAX ? (int)wanted : LINE_BIN_MAX;
    double(*line)[3] = dif_alloc((size_t)n, sizeof *line);
    if (!line)
        return dif_fail(err, DIF_ERR_NOMEM, "spectral lines, %d bins", n);
    const double step = f_max > f_min ? (f_max - f_min) / n : 1.0;
    data->p_min = INFINITY;
    for (int ia = 0; ia < plan->n_angle; ia++) {
        dif_plan_transfer(plan, ia, &sin_sum, &cos_sum);
        for (int il = 0; il < plan->n_lambda; il++) {
            const double p = cell_power(job, data, il, ia);
            if (!isfinite(p))
                continue;
            const int bin = (int)((sin_sum / plan->lambda_um[il] - f_min) / step);
            double *at = line[bin < 0 ? 0 : bin >= n ? n - 1 : bin];
            at[1] += p;
            at[2] += 1.0;
            data->n_below += p < job->tol * job->tol;
            data->p_min = fmin(data->p_min, p);
        }
    }
    for (int i = 0; i < n; i++) {
        line[i][0] = f_min + (i + 0.5) * step;
        line[i][1] /= fmax(line[i][2], 1.0);
    }
    data->line = line;
    data->n_line = n;
    return DIF_OK;
}

int dif_report_walls(const dif_report_job *job)
{
    return job->grating.profile == DIF_PROFILE_BLAZED ? 1 : job->grating.profile == DIF_PROFILE_LAMELLAR ? 2 : 0;
}

double dif_report_samples_per_period(const dif_report_job *job)
{
    return job->grating.period_um / job->field.pitch_x_um;
}

static bool is_whole(double x)
{
    return fabs(x - rint(x)) < 1e-6;
}

bool dif_report_walls_between(const dif_report_job *job)
{
    const double n = dif_report_samples_per_period(job), c = fabs(cos(job->grating.psi_rad));
    const bool along_x = c > 1.0 - 1e-12, along_y = c < 1e-12;
    /* phase 0 lies on the patch's centre, between two samples if there is an even number of them */
    const bool even = (along_x ? job->field.nx : job->field.ny) % 2 == 0;
    return (along_x || along_y) && even && is_whole(n) &&
           (job->grating.profile != DIF_PROFILE_LAMELLAR || is_whole(n * job->grating.duty));
}

/* How far the sampled power of an order may be from the closed form. Smooth profiles: rounding. Walls between pixels:
 * a sum over N samples in place of the integral over a straight piece makes each amplitude 2 sin(a/2)/a larger by
 * a^2/(24 N^2), so powers by at most 1/(3 N^2) (blazed, one piece as high as the phase asks) or 4/(3 N^2) (lamellar, two
 * levels up to 2 apart); a tenth more for what follows. Walls within pixels: such a pixel has the mean height of both
 * sides, its phase factor lies on the arc between theirs where the true mean lies on the chord, off by at most
 * min(2, phase^2/8); such pixels are walls/samples of a period. */
static double order_limit(const dif_report_job *job, double power, double kw_rad_per_um)
{
    const double n = dif_report_samples_per_period(job), phase_rad = fabs(kw_rad_per_um) * job->grating.height_um;
    const int n_wall = dif_report_walls(job);
    if (n_wall > 0 && dif_report_walls_between(job))
        return 1.1 * n_wall * n_wall / (3.0 * n * n);
    const double off = n_wall * fmin(2.0, phase_rad * phase_rad / 8.0) / n;
    return fmax(1e-6, 2.0 * sqrt(power) * off + off * off);
}

dif_status dif_report_orders(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    const dif_grating *grating = &job->grating;
    const double lambda_um = job->plan.lambda_um[job->plan.n_lambda / 2];
    const dif_vec3 wi = dif_vec3_from_angles_rad(job->plan.fixed_rad, job->plan.azimuth_rad);
    dif_query query[DIF_REPORT_ORDER_MAX];
    dif_sample sample[DIF_REPORT_ORDER_MAX];
    int m_min, m_max, n = 0;
    if (!dif_grating_order_range(wi, grating->period_um, grating->psi_rad, lambda_um, &m_min, &m_max))
        return DIF_OK;
    for (int m = m_min; m <= m_max && n < DIF_REPORT_ORDER_MAX; m++) {
        dif_vec3 wo;
        if (!dif_grating_direction(wi, grating->period_um, grating->psi_rad, lambda_um, m, &wo))
            continue;
        const double along = wo.x * cos(job->plan.azimuth_rad) + wo.y * sin(job->plan.azimuth_rad);
        const double kw = -DIF_TWO_PI / lambda_um * (wi.z + wo.z);
        query[n] = (dif_query){wi, wo, lambda_um};
        const double power = dif_grating_power(grating, m, kw);
        data->order[n++] = (dif_report_order){.order = m,
                                              .angle_rad = copysign(acos(fmin(wo.z, 1.0)), along),
                                              .closed = power,
                                              .efficiency = dif_grating_efficiency(grating, wi, lambda_um, 1.0, m),
                                              .limit = order_limit(job, power, kw)};
    }
    dif_measure_opts opts = job->opts;
    opts.window = DIF_WINDOW_FLAT;
    opts.average = DIF_AVERAGE_NONE;
    const double tol = 1e-9; /* so that what is left is the sampling */
    dif_measure_stats stats;
    const dif_status status = dif_measure_queries(&job->field, (size_t)n, query, tol, &opts, sample, &stats, err);
    if (status != DIF_OK)
        return status;
    for (int i = 0; i < n; i++)
        data->order[i].sampled = sample[i].power;
    data->n_order = n;
    data->order_lambda_um = lambda_um;
    return DIF_OK;
}

/* At normal incidence and at the plan's angle, for a perfect mirror of this shape. */
static dif_status measure_energy(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    const double angles_rad[] = {0.0, job->plan.fixed_rad};
    const double lambda_um = job->plan.lambda_um[job->plan.n_lambda / 2];
    dif_measure_opts opts = job->opts;
    opts.index = (dif_index){1.0, 5e5}; /* R = 1 - 2e-11 */
    opts.average = DIF_AVERAGE_NONE;
    for (size_t i = 0; i < sizeof angles_rad / sizeof *angles_rad; i++) {
        const dif_vec3 wi = dif_vec3_from_angles_rad(angles_rad[i], job->plan.azimuth_rad);
        dif_report_energy *out = &data->energy[data->n_energy];
        *out = (dif_report_energy){angles_rad[i], lambda_um, NAN, NAN};
        const double tol = 1e-5; /* an error of the powers of 1e-10, times the gain of some 1e4: far below the limit */
        const dif_status status = dif_energy_albedo(&job->field, wi, lambda_um, tol, &opts, &out->albedo, err);
        if (status != DIF_OK && status != DIF_ERR_SIZE) /* too many directions: the number stays unknown */
            return status;
        if (status == DIF_ERR_SIZE)
            out->albedo = NAN;
        if (job->has_grating)
            out->reference = dif_energy_order_sum(&job->grating, wi, lambda_um);
        data->n_energy++;
    }
    return DIF_OK;
}

double dif_report_fit_angle_max_rad(void)
{
    return fit_angle_max_rad;
}

/* Distance of the samples along the plane of incidence, NaN where the plane runs askew of the grid. */
static double pitch_along_um(const dif_report_job *job)
{
    const double c = fabs(cos(job->plan.azimuth_rad)), s = fabs(sin(job->plan.azimuth_rad));
    return s < 1e-9 ? job->field.pitch_x_um : c < 1e-9 ? job->field.pitch_y_um : (double)NAN;
}

static dif_status fit_table(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    dif_fit_table_opts opts = dif_fit_table_opts_default();
    opts.line = (dif_fit_line){.known = true,
                               .average = job->opts.average,
                               .pitch_um = pitch_along_um(job),
                               .window = {.kind = job->opts.window, .sigma_um = job->opts.sigma_um},
                               .size_x_um = job->field.nx * job->field.pitch_x_um,
                               .size_y_um = job->field.ny * job->field.pitch_y_um};
    opts.index = job->opts.index;
    opts.common_period = data->common_period = job->is_grating;
    if (job->is_grating)
        opts.n_ridge_max = DIF_FIT_RIDGE_MAX;
    dif_table part;
    dif_status status =
        dif_table_cut(&data->table, job->f_min_per_um, job->f_max_per_um, fit_angle_max_rad, &part, err);
    if (status != DIF_OK)
        return status;
    const clock_pair start = now();
    data->fit_status = dif_fit_table(&part, &opts, &data->fit, &data->fit_error);
    add_stage_since(data, "fit of the table", start);
    dif_table_free(&part);
    return data->fit_status == DIF_ERR_NOMEM ? dif_fail(err, data->fit_status, "%s", data->fit_error.text) : DIF_OK;
}

static dif_status fit_surface(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    const dif_fit_surface_opts surface_opts = dif_fit_surface_opts_default();
    const clock_pair start = now();
    data->surface_status = dif_fit_surface(&job->field, &surface_opts, &data->surface, &data->surface_error);
    add_stage_since(data, "fit of the heights", start);
    if (data->surface_status == DIF_ERR_NOMEM)
        return dif_fail(err, data->surface_status, "%s", data->surface_error.text);
    return DIF_OK;
}

static dif_status measure_table(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    dif_status status =
        dif_measure_table(&job->field, &job->plan, job->tol, &job->opts, &data->table, &data->stats, err);
    if (status != DIF_OK)
        return status;
    add_stage(data, "table: planes and transforms", data->stats.build_wall_s, data->stats.build_cpu_s);
    add_stage(data, "table: samples", data->stats.eval_wall_s, data->stats.eval_cpu_s);
    const int n_window = data->stats.n_window > 0 ? data->stats.n_window : 1;
    const int n_check = CHECK_N / n_window > CHECK_N_MIN ? CHECK_N / n_window : CHECK_N_MIN;
    const clock_pair start = now();
    status = dif_measure_check_table(&job->field, &data->table, &job->opts, n_check, CHECK_SEED, &data->check, err);
    add_stage_since(data, "check against the direct sum", start);
    return status;
}

bool dif_report_on_line(const dif_report_data *data, const dif_maximum *maximum)
{
    if (data->fit_status != DIF_OK || maximum->at_edge || !isfinite(maximum->residual_rad))
        return false;
    const double off_per_um = maximum->sin_sum / maximum->lambda_um - maximum->order / data->fit.period_um;
    return fabs(off_per_um) <= 2.0 * data->fit.ridge[0].width_per_um;
}

static dif_status find_maxima(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    dif_table part;
    dif_maxima_opts opts = dif_maxima_opts_default();
    opts.floor_share = job->is_grating ? grating_floor : scan_floor;
    opts.period_um = data->fit_status == DIF_OK ? data->fit.period_um : (double)NAN;
    dif_status status = dif_table_cut(&data->table, job->f_min_per_um, INFINITY, 0.5 * DIF_PI, &part, err);
    if (status != DIF_OK)
        return status;
    status = dif_maxima_find(&part, &opts, &data->maxima, err);
    dif_table_free(&part);
    if (status != DIF_OK)
        return status;
    data->on_line.item = dif_alloc((size_t)data->maxima.n, sizeof(dif_maximum));
    if (!data->on_line.item)
        return dif_fail(err, DIF_ERR_NOMEM, "%d maxima", data->maxima.n);
    for (int i = 0; i < data->maxima.n; i++) {
        if (dif_report_on_line(data, &data->maxima.item[i]))
            data->on_line.item[data->on_line.n++] = data->maxima.item[i];
    }
    return DIF_OK;
}

dif_status dif_report_measure(const dif_report_job *job, dif_report_data *out, dif_error *err)
{
    *out = (dif_report_data){0};
    dif_status status = dif_field_stats_of(&job->field, &out->field, err);
    if (status == DIF_OK)
        status = measure_table(job, out, err);
    if (status == DIF_OK)
        status = fit_table(job, out, err);
    if (status == DIF_OK)
        status = fit_surface(job, out, err);
    if (status == DIF_OK)
        status = find_maxima(job, out, err);
    if (status == DIF_OK)
        status = dif_report_fold(job, out, err);
    clock_pair start = now();
    if (status == DIF_OK)
        status = measure_energy(job, out, err);
    add_stage_since(out, "energy integrals", start);
    start = now();
    if (status == DIF_OK && job->has_grating) {
        status = dif_report_orders(job, out, err);
        add_stage_since(out, "order powers", start);
    }
    start = now();
    if (status == DIF_OK && job->want_map) {
        status = dif_report_map(job, out, err);
        add_stage_since(out, "BRDF map", start);
    }
    start = now();
    if (status == DIF_OK && job->want_methods) {
        status = dif_report_methods(job, out, err);
        add_stage_since(out, "comparison of methods", start);
    }
    start = now();
    if (status == DIF_OK && job->want_gpu) {
        status = dif_report_gpu_make(job, &out->gpu, err);
        add_stage_since(out, "GPU against CPU", start);
    }
    start = now();
    if (status == DIF_OK && job->want_render) {
        status = dif_report_render_make(job, &out->render, err);
        add_stage_since(out, "rendering", start);
    }
    start = now();
    if (status == DIF_OK && job->want_slopes) {
        status = dif_report_slopes_make(job, &out->slopes, err);
        add_stage_since(out, "slopes and views", start);
    }
    start = now();
    if (status == DIF_OK && job->want_study) {
        status = dif_report_study_make(job, out, err);
        add_stage_since(out, "studies", start);
    }
    if (status != DIF_OK)
        dif_report_data_free(out);
    return status;
}

void dif_report_data_free(dif_report_data *data)
{
    if (!data)
        return;
    dif_table_free(&data->table);
    dif_maxima_free(&data->maxima);
    dif_maxima_free(&data->on_line);
    dif_map_free(&data->map.map);
    dif_report_gpu_free(&data->gpu);
    dif_report_render_free(&data->render);
    dif_report_slopes_free(&data->slopes);
    dif_report_study_free(&data->study);
    dif_release(data->line);
    *data = (dif_report_data){0};
}

void dif_report_job_free(dif_report_job *job)
{
    if (!job)
        return;
    dif_field_free(&job->field);
    dif_plan_free(&job->plan);
    dif_manifest_free(&job->provenance);
    *job = (dif_report_job){0};
}
