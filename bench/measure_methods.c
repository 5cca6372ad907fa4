/* The methods that are compared with the sheet: each made ready for a field and a window, then read point by point. */
#include <math.h>

#include "bench/measure_impl.h"
#include "core/response.h"
#include "core/units.h"

/* Wavelengths that nmm samples: the visible ones, or more if asked for more. */
#define VISIBLE_MIN_UM 0.38
#define VISIBLE_MAX_UM 0.78

bool dif_method_has_windows(dif_method method)
{
    return method != DIF_METHOD_THESIS && method != DIF_METHOD_PQ && method != DIF_METHOD_STAM;
}

const char *dif_method_leaves_out(dif_method method)
{
    switch (method) {
    case DIF_METHOD_THESIS:
        return "the factor w of the phase, every gain, and the expectation: one window on the corner of the tiled "
               "patch";
    case DIF_METHOD_NMM:
        return "what lies between the bins of the patch's discrete spectrum";
    case DIF_METHOD_PQ:
        return "everything but one period: its replicas neither vary nor drift";
    case DIF_METHOD_STAM:
        return "the heights: orders have their places but no strengths";
    case DIF_METHOD_SHEET:
    case DIF_METHOD_TAYLOR:
    case DIF_METHOD_DIRECT:
        break;
    }
    return "";
}

/* Gaussian width whose line has the curvature of the window's. */
static double sigma_of(const dif_field *field, const dif_measure_opts *opts)
{
    const double extent_um = fmax(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um);
    return opts->window == DIF_WINDOW_GAUSS ? opts->sigma_um : extent_um / sqrt(12.0);
}

static dif_stam stam_of(const dif_field *field, const dif_measure_opts *opts)
{
    return (dif_stam){opts->period_um, opts->period_across_um, opts->psi_rad, sigma_of(field, opts)};
}

dif_nmm dif_method_nmm(const dif_field *field, const dif_measure_opts *opts, double lambda_min_um, double lambda_max_um)
{
    const double extent_um = fmax(field->nx * field->pitch_x_um, field->ny * field->pitch_y_um);
    return (dif_nmm){.extent_um = opts->nmm_lines ? opts->period_um : extent_um,
                     .lambda_min_um = fmin(lambda_min_um, VISIBLE_MIN_UM),
                     .lambda_max_um = fmax(lambda_max_um, VISIBLE_MAX_UM),
                     .n_fixed = opts->nmm_fixed,
                     .jacobian = opts->nmm_jacobian,
                     /* area of exp(-(2 pi sigma f)^2) */
                     .line_area_per_um = opts->nmm_lines ? 0.5 / (sqrt(DIF_PI) * sigma_of(field, opts)) : 0.0};
}

static dif_status need_period(const dif_measure_opts *opts, dif_error *err)
{
    if (!isnan(opts->period_um))
        return DIF_OK;
    return dif_fail(err, DIF_ERR_ARG, "%s needs the surface's period, and none was given",
                    dif_method_name(opts->method));
}

dif_status dif_method_check_opts(const dif_field *field, const dif_measure_opts *opts, dif_error *err)
{
    dif_status status = DIF_OK;
    if (opts->method == DIF_METHOD_PQ) {
        dif_cell_layout layout;
        return dif_cell_layout_make(field, opts, &layout, err);
    }
    if (opts->method == DIF_METHOD_STAM) {
        const dif_stam stam = stam_of(field, opts);
        status = need_period(opts, err);
        return status == DIF_OK ? dif_stam_check(&stam, err) : status;
    }
    if (opts->method == DIF_METHOD_NMM) {
        const dif_nmm nmm = dif_method_nmm(field, opts, VISIBLE_MIN_UM, VISIBLE_MAX_UM);
        status = opts->nmm_lines ? need_period(opts, err) : DIF_OK;
        return status == DIF_OK ? dif_nmm_check(&nmm, err) : status;
    }
    if (opts->method != DIF_METHOD_THESIS)
        return DIF_OK;
    if (opts->window != DIF_WINDOW_GAUSS)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "the source's program knows no window but the Gaussian");
    if (opts->shadow && opts->shadow->kind != DIF_SHADOWING_NONE)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "the source's program has no %s shadowing: its gain is 1",
                        dif_shadowing_name(opts->shadow->kind));
    if (!(opts->thesis_terms >= 1 && opts->thesis_terms <= DIF_THESIS_TERMS_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d terms, want 1 ... %d", opts->thesis_terms, DIF_THESIS_TERMS_MAX);
    return DIF_OK;
}

dif_reach dif_reach_empty(void)
{
    const double inf = (double)INFINITY;
    return (dif_reach){.c_min = inf,
                       .u_min = inf,
                       .u_max = -inf,
                       .v_min = inf,
                       .v_max = -inf,
                       .lambda_min_um = inf,
                       .lambda_max_um = 0.0};
}

void dif_reach_add(dif_reach *reach, dif_vec3 uvw, double lambda_um)
{
    reach->s_max = fmax(reach->s_max, hypot(uvw.x, uvw.y));
    reach->c_min = fmin(reach->c_min, -uvw.z);
    reach->c_max = fmax(reach->c_max, -uvw.z);
    reach->u_min = fmin(reach->u_min, uvw.x);
    reach->u_max = fmax(reach->u_max, uvw.x);
    reach->v_min = fmin(reach->v_min, uvw.y);
    reach->v_max = fmax(reach->v_max, uvw.y);
    reach->lambda_min_um = fmin(reach->lambda_min_um, lambda_um);
    reach->lambda_max_um = fmax(reach->lambda_max_um, lambda_um);
}

static dif_status open_sheet(const dif_field *field, const dif_window *window, const dif_measure_opts *opts, double tol,
                             const dif_reach *reach, dif_readout *out, dif_measure_stats *stats, dif_error *err)
{
    const bool nmm = opts->method == DIF_METHOD_NMM;
    const double k_max = DIF_TWO_PI / (nmm ? out->nmm.lambda_min_um : reach->lambda_min_um);
    const double k_min = DIF_TWO_PI / (nmm ? out->nmm.lambda_max_um : reach->lambda_max_um);
    const dif_band band = {k_max * reach->s_max * (1.0 + 1e-12), k_min * reach->c_min * (1.0 - 1e-12),
                           k_max * reach->c_max * (1.0 + 1e-12)};
    const dif_sheet_opts how = dif_measure_sheet_opts(opts);
    const dif_status status =
        reach->is_line ? dif_sheet_create_line(field, window, reach->azimuth_rad, &band, tol, &how, &out->sheet, err)
                       : dif_sheet_create_volume(field, window, &band, tol, &how, &out->sheet, err);
    if (status == DIF_OK)
        dif_measure_note_sheet(stats, out->sheet);
    return status;
}

static dif_status open_thesis(const dif_field *field, const dif_measure_opts *opts, const dif_reach *reach,
                              dif_readout *out, dif_error *err)
{
    const double k_max = DIF_TWO_PI / reach->lambda_min_um;
    const dif_thesis_box box = {k_max * fmin(reach->u_min, 0.0), k_max * fmax(reach->u_max, 0.0),
                                k_max * fmin(reach->v_min, 0.0), k_max * fmax(reach->v_max, 0.0)};
    return dif_thesis_create(field, opts->sigma_um, &box, opts->thesis_terms, opts->single, &out->thesis, err);
}

dif_status dif_readout_open(const dif_field *field, const dif_window *window, const dif_measure_opts *opts, double tol,
                            const dif_reach *reach, dif_readout *out, dif_measure_stats *stats, dif_error *err)
{
    const dif_window flat = {.kind = DIF_WINDOW_FLAT};
    dif_status status = DIF_OK;
    *out = (dif_readout){.method = opts->method,
                         .is_line = reach->is_line,
                         .cos_azimuth = cos(reach->azimuth_rad),
                         .sin_azimuth = sin(reach->azimuth_rad),
                         .stam = stam_of(field, opts),
                         .nmm = dif_method_nmm(field, opts, reach->lambda_min_um, reach->lambda_max_um)};
    if (opts->method == DIF_METHOD_PQ) {
        status = dif_measure_cell(field, opts, &out->cell, &out->replica, err);
        if (status == DIF_OK)
            status = open_sheet(&out->cell, &flat, opts, tol, reach, out, stats, err);
        stats->n_replica_x = out->replica.nx;
        stats->n_replica_y = out->replica.ny;
    } else if (opts->method == DIF_METHOD_THESIS) {
        status = open_thesis(field, opts, reach, out, err);
        stats->n_plane = opts->thesis_terms;
        stats->single = opts->single;
    } else if (opts->method != DIF_METHOD_STAM) {
        status = open_sheet(field, window, opts, tol, reach, out, stats, err);
    }
    if (*dif_method_leaves_out(opts->method) && opts->method != DIF_METHOD_PQ)
        stats->bound = (double)NAN;
    if (status != DIF_OK)
        dif_readout_close(out);
    return status;
}

void dif_readout_close(dif_readout *reader)
{
    dif_sheet_free(reader->sheet);
    dif_thesis_free(reader->thesis);
    dif_field_free(&reader->cell);
    *reader = (dif_readout){0};
}

static void read_sheet(const dif_readout *reader, int n, const dif_vec3 *kappa, double (*amp)[2])
{
    double ks[DIF_READ_MAX], kz[DIF_READ_MAX];
    if (!reader->is_line) {
        dif_response_volume(reader->sheet, (size_t)n, kappa, amp);
        return;
    }
    for (int i = 0; i < n; i++) {
        ks[i] = reader->cos_azimuth * kappa[i].x + reader->sin_azimuth * kappa[i].y;
        kz[i] = -kappa[i].z;
    }
    dif_response_line(reader->sheet, (size_t)n, ks, kz, amp);
}

void dif_readout_read(const dif_readout *reader, int n, const dif_vec3 *uvw, const double *lambda_um, bool as_asked,
                      double (*amp)[2])
{
    dif_vec3 kappa[DIF_READ_MAX];
    double k[DIF_READ_MAX];
    const bool nearest = reader->method == DIF_METHOD_NMM && !as_asked;
    if (n < 1)
        return;
    for (int i = 0; i < n; i++) {
        const double at_um =
            nearest ? dif_nmm_nearest_um(&reader->nmm, hypot(uvw[i].x, uvw[i].y), lambda_um[i]) : lambda_um[i];
        k[i] = DIF_TWO_PI / at_um;
        kappa[i] = (dif_vec3){k[i] * uvw[i].x, k[i] * uvw[i].y, k[i] * uvw[i].z};
    }
    if (reader->method == DIF_METHOD_THESIS)
        dif_thesis_amplitudes(reader->thesis, (size_t)n, kappa, k, amp);
    else if (reader->method != DIF_METHOD_STAM)
        read_sheet(reader, n, kappa, amp);
    for (int i = 0; i < n && reader->method == DIF_METHOD_STAM; i++) {
        amp[i][0] = sqrt(dif_stam_power(&reader->stam, kappa[i].x, kappa[i].y));
        amp[i][1] = 0.0;
    }
    for (int i = 0; i < n && reader->method == DIF_METHOD_PQ; i++) {
        const double factor = dif_replica_factor(&reader->replica, kappa[i].x, kappa[i].y);
        amp[i][0] *= factor;
        amp[i][1] *= factor;
    }
}

double dif_method_gain(const dif_measure_opts *opts, dif_quantity quantity, dif_vec3 wi, dif_vec3 wo, double area_um2)
{
    return opts->method == DIF_METHOD_THESIS ? 1.0
                                             : dif_measure_shadowing(opts, quantity, wi, wo) *
                                                   dif_brdf_gain(quantity, opts->index, wi, wo, 1.0, area_um2);
}

/* One wavelength of a table. */
static void add_row(const dif_readout *reader, const dif_plan *plan, double lambda_um, double share, double *value)
{
    const double c = cos(plan->azimuth_rad), s = sin(plan->azimuth_rad);
    dif_vec3 uvw[DIF_READ_MAX];
    double lambda[DIF_READ_MAX], amp[DIF_READ_MAX][2];
    for (int first = 0; first < plan->n_angle; first += DIF_READ_MAX) {
        const int n = plan->n_angle - first < DIF_READ_MAX ? plan->n_angle - first : DIF_READ_MAX;
        for (int i = 0; i < n; i++) {
            double sin_sum, cos_sum;
            dif_plan_transfer(plan, first + i, &sin_sum, &cos_sum);
            uvw[i] = (dif_vec3){-sin_sum * c, -sin_sum * s, -cos_sum};
            lambda[i] = lambda_um;
        }
        dif_readout_read(reader, n, uvw, lambda, false, amp);
        for (int i = 0; i < n; i++)
            value[first + i] += share * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
    }
}

dif_reach dif_reach_of_plan(const dif_plan *plan)
{
    dif_reach reach = dif_reach_empty();
    reach.is_line = true;
    reach.azimuth_rad = plan->azimuth_rad;
    for (int i = 0; i < plan->n_angle; i++) {
        double sin_sum, cos_sum;
        dif_plan_transfer(plan, i, &sin_sum, &cos_sum);
        dif_reach_add(&reach,
                      (dif_vec3){-sin_sum * cos(plan->azimuth_rad), -sin_sum * sin(plan->azimuth_rad), -cos_sum},
                      plan->lambda_um[0]);
    }
    for (int i = 0; i < plan->n_lambda; i++) {
        reach.lambda_min_um = fmin(reach.lambda_min_um, plan->lambda_um[i]);
        reach.lambda_max_um = fmax(reach.lambda_max_um, plan->lambda_um[i]);
    }
    return reach;
}

dif_status dif_table_by_method(const dif_field *field, const dif_plan *plan, double tol, const dif_measure_opts *opts,
                               const dif_window_set *set, double *value, dif_measure_stats *stats, dif_error *err)
{
    const dif_reach reach = dif_reach_of_plan(plan);
    dif_stopwatch watch = dif_stopwatch_start();
    for (int w = 0; w < set->n; w++) {
        dif_readout reader;
        const dif_status status = dif_readout_open(field, set->window + w, opts, tol, &reach, &reader, stats, err);
        if (status != DIF_OK)
            return status;
        dif_stopwatch_lap(&watch, &stats->build_wall_s, &stats->build_cpu_s);
#pragma omp parallel for schedule(static)
        for (int il = 0; il < plan->n_lambda; il++)
            add_row(&reader, plan, plan->lambda_um[il], set->share[w], value + (size_t)il * (size_t)plan->n_angle);
        dif_stopwatch_lap(&watch, &stats->eval_wall_s, &stats->eval_cpu_s);
        dif_readout_close(&reader);
        dif_measure_progress(opts, (w + 1.0) / set->n);
    }
    return DIF_OK;
}
