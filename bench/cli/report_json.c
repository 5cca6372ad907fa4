#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "core/units.h"
#include "reports/result.h"

/* How far the integral at normal incidence may be from the closed form: the window gives each order a width, over which
 * the gain is averaged, which is not linear; and pixels that hold a wall scatter light of their own, up to twice their
 * share of the area. At grazing incidence the first is large, so that nothing is judged there. */
static const double energy_limit_window = 0.01;

static json_t *nm(double um)
{
    return dif_json_number(dif_nm_from_um(um));
}

static json_t *degrees(double rad)
{
    return dif_json_number(dif_deg_from_rad(rad));
}

static json_t *surface_json(const dif_report_job *job, const dif_field_stats *stats)
{
    const dif_field *field = &job->field;
    return json_pack("{s:i, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "nx", field->nx, "ny", field->ny,
                     "pitch_x_nm", nm(field->pitch_x_um), "pitch_y_nm", nm(field->pitch_y_um), "size_x_um",
                     dif_json_number(field->nx * field->pitch_x_um), "size_y_um",
                     dif_json_number(field->ny * field->pitch_y_um), "range_nm", nm(stats->max_um - stats->min_um),
                     "rms_nm", nm(stats->rms_um), "slope_x_rms", dif_json_number(stats->slope_x_rms), "slope_y_rms",
                     dif_json_number(stats->slope_y_rms), "slope_max", dif_json_number(stats->slope_max), "step_nm",
                     nm(job->step_um));
}

static void window_text(const dif_report_job *job, const dif_report_data *data, char text[160])
{
    if (job->opts.window == DIF_WINDOW_FLAT)
        snprintf(text, 160, "flat over the whole patch");
    else if (job->opts.average == DIF_AVERAGE_NONE || data->stats.n_window == 1)
        snprintf(text, 160, "Gaussian, σ = %g µm, one at the centre", job->opts.sigma_um);
    else
        snprintf(text, 160, "Gaussian, σ = %g µm, powers of %d windows averaged (Welch)", job->opts.sigma_um,
                 data->stats.n_window);
}

static json_t *plan_json(const dif_report_job *job, const dif_report_data *data)
{
    static const char *const quantity_text[] = {[DIF_QUANTITY_POWER] = "normalised power p",
                                                [DIF_QUANTITY_RHO] = "relative BRDF ρ",
                                                [DIF_QUANTITY_BRDF] = "BRDF, sr⁻¹"};
    const dif_plan *plan = &job->plan;
    const int na = plan->n_angle, nl = plan->n_lambda;
    char window[160];
    window_text(job, data, window);
    json_t *out = json_pack(
        "{s:s, s:o, s:o, s:o, s:o, s:o, s:i, s:o, s:o, s:o, s:i}", "fixed", plan->fixed_is_wo ? "theta_r" : "theta_i",
        "fixed_deg", degrees(plan->fixed_rad), "azimuth_deg", degrees(plan->azimuth_rad), "angle_deg_min",
        degrees(plan->angle_rad[0]), "angle_deg_max", degrees(plan->angle_rad[na - 1]), "angle_deg_step",
        degrees(na > 1 ? (plan->angle_rad[na - 1] - plan->angle_rad[0]) / (na - 1) : 0.0), "n_angle", na,
        "lambda_nm_min", nm(plan->lambda_um[0]), "lambda_nm_max", nm(plan->lambda_um[nl - 1]), "lambda_nm_step",
        nm(nl > 1 ? (plan->lambda_um[nl - 1] - plan->lambda_um[0]) / (nl - 1) : 0.0), "n_lambda", nl);
    json_t *rest = json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:s}", "quantity", dif_quantity_name(job->opts.quantity),
        "quantity_text", quantity_text[job->opts.quantity], "unit", dif_quantity_unit(job->opts.quantity), "window",
        job->opts.window == DIF_WINDOW_FLAT ? "flat" : "gauss", "average",
        job->opts.average == DIF_AVERAGE_NONE ? "none" : "welch", "sigma_um", dif_json_number(job->opts.sigma_um),
        "index_n", dif_json_number(job->opts.index.n), "index_kappa", dif_json_number(job->opts.index.kappa), "tol",
        dif_json_number(job->tol), "window_text", window);
    if (out && rest && json_object_update(out, rest) == 0) {
        json_decref(rest);
        return out;
    }
    json_decref(out);
    json_decref(rest);
    return NULL;
}

static json_t *measure_json(const dif_report_job *job, const dif_report_data *data)
{
    const dif_measure_stats *stats = &data->stats;
    char text[DIF_REPORT_TEXT];
    if (job->opts.method == DIF_METHOD_DIRECT)
        snprintf(text, sizeof text, "Method: direct sum in double precision.");
    else
        snprintf(text, sizeof text, "Method: %s, %d %s%s, stored in %s precision, %d window%s.",
                 dif_method_name(job->opts.method), stats->n_plane,
                 job->opts.method == DIF_METHOD_TAYLOR ? "terms" : "planes of κz",
                 stats->n_tap > 0 ? " with an interpolation kernel" : "", stats->single ? "single" : "double",
                 stats->n_window, stats->n_window == 1 ? "" : "s");
    return json_pack("{s:s, s:s, s:o, s:i, s:i, s:i, s:I, s:b, s:o}", "method", dif_method_name(job->opts.method),
                     "method_text", text, "bound", dif_json_number(stats->bound), "n_window", stats->n_window,
                     "n_plane", stats->n_plane, "n_tap", stats->n_tap, "n_sample", (json_int_t)stats->n_sample,
                     "single", (int)stats->single, "area_um2", dif_json_number(stats->area_um2));
}

static json_t *check_json(const dif_measure_check *check)
{
    return json_pack("{s:i, s:o, s:o, s:o, s:o, s:o}", "n_sample", check->n_sample, "worst_amplitude",
                     dif_json_number(check->worst_amplitude), "worst_angle_deg",
                     dif_json_number(check->worst_angle_deg), "worst_lambda_nm",
                     dif_json_number(check->worst_lambda_nm), "worst_value", dif_json_number(check->worst_value),
                     "worst_direct", dif_json_number(check->worst_direct));
}

static json_t *below_json(const dif_report_data *data)
{
    const double n = (double)data->table.plan.n_angle * data->table.plan.n_lambda;
    return json_pack("{s:I, s:o, s:o}", "n", (json_int_t)data->n_below, "share",
                     dif_json_number((double)data->n_below / n), "p_min", dif_json_number(data->p_min));
}

static json_t *energy_json(const dif_report_job *job, const dif_report_data *data)
{
    json_t *rows = json_array();
    for (int i = 0; rows && i < data->n_energy; i++) {
        const dif_report_energy *energy = &data->energy[i];
        json_t *row = json_pack("{s:o, s:o, s:o, s:o, s:s}", "theta_i_deg", degrees(energy->theta_i_rad), "lambda_nm",
                                nm(energy->lambda_um), "albedo", dif_json_number(energy->albedo), "reference",
                                dif_json_number(energy->reference), "reference_text",
                                job->has_grating ? "sum of the order efficiencies, closed form" : "none known");
        if (json_array_append_new(rows, row) != 0) {
            json_decref(rows);
            rows = NULL;
        }
    }
    return rows ? json_pack(
                      "{s:s, s:o}", "text",
                      "Judged at normal incidence, to 1 % and, where walls stand within pixels, twice the share of "
                      "those. At grazing "
                      "incidence the coherence window spreads the orders over "
                      "directions where the gain changes fast, which the closed form of sharp orders does not know. "
                      "Scalar theory does not conserve energy exactly (0.6 to 1.8 in the hardest cases); the sum is "
                      "reported, never rescaled.",
                      "rows", rows)
                : NULL;
}

/* The order whose difference is largest against its limit: difference and limit; and what sets the limit. */
static void worst_order(const dif_report_job *job, const dif_report_data *data, double *worst, double *limit,
                        char text[DIF_REPORT_TEXT])
{
    double share = -1.0;
    for (int i = 0; i < data->n_order; i++) {
        const double off = fabs(data->order[i].sampled - data->order[i].closed);
        if (off / data->order[i].limit > share) {
            share = off / data->order[i].limit;
            *worst = off;
            *limit = data->order[i].limit;
        }
    }
    const double n = dif_report_samples_per_period(job);
    if (dif_report_walls(job) > 0 && dif_report_walls_between(job))
        snprintf(
            text, DIF_REPORT_TEXT,
            "Every wall stands between two pixels, so the walls cost nothing. What limits the agreement is that %g "
            "samples stand for each period: sums in place of integrals, off by up to %g/(3 N²) of the incident power.",
            n, (double)dif_report_walls(job) * dif_report_walls(job));
    else if (dif_report_walls(job) > 0)
        snprintf(
            text, DIF_REPORT_TEXT,
            "The sampling of the walls limits the agreement: of %.2f samples in a period, %d hold%s a wall and so the "
            "mean height of its two sides, whose phase is not the mean of their phases. The limit of each order "
            "follows from that.",
            n, dif_report_walls(job), dif_report_walls(job) == 1 ? "s" : "");
    else
        snprintf(
            text, DIF_REPORT_TEXT,
            "The profile has no walls and the patch holds %.6g periods, so the sampled powers should agree to 1e-6.",
            job->field.nx / n);
}

static json_t *orders_json(const dif_report_job *job, const dif_report_data *data, double *worst, double *limit)
{
    char text[DIF_REPORT_TEXT] = "";
    *worst = *limit = NAN;
    if (data->n_order > 0)
        worst_order(job, data, worst, limit, text);
    json_t *rows = json_array();
    for (int i = 0; rows && i < data->n_order; i++) {
        const dif_report_order *order = &data->order[i];
        json_t *row =
            json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:o}", "order", order->order, "angle_deg",
                      degrees(order->angle_rad), "sampled", dif_json_number(order->sampled), "closed",
                      dif_json_number(order->closed), "difference", dif_json_number(order->sampled - order->closed),
                      "limit", dif_json_number(order->limit), "efficiency", dif_json_number(order->efficiency));
        if (json_array_append_new(rows, row) != 0) {
            json_decref(rows);
            rows = NULL;
        }
    }
    return rows ? json_pack("{s:o, s:o, s:o, s:s, s:o}", "lambda_nm", nm(data->order_lambda_um), "worst",
                            dif_json_number(*worst), "limit", dif_json_number(*limit), "text", text, "rows", rows)
                : NULL;
}

/* A verdict; pass < 0: nothing to hold the value against. A failed one sets *outside. */
static json_t *verdict(const char *name, int pass, const char *label, double value, double limit, const char *unit,
                       bool *outside)
{
    json_t *mark = pass < 0 ? json_null() : json_boolean(pass);
    if (pass == 0)
        *outside = true;
    return json_pack("{s:s, s:o, s:s, s:o, s:o, s:s}", "name", name, "pass", mark, "label", label, "value",
                     dif_json_number(value), "limit", dif_json_number(limit), "unit", unit);
}

static json_t *period_verdict(const dif_report_job *job, const dif_report_data *data, bool *outside)
{
    if (!job->known_exact)
        return verdict("period", -1, "", NAN, NAN, "nm", outside);
    if (data->fit_status != DIF_OK)
        return verdict("period", 0, "not determined", NAN, NAN, "nm", outside);
    const double off_um = fabs(data->fit.period_um - job->known_period_um);
    const double limit_um = 2.0 * data->fit.period_uncertainty_um;
    return verdict("period", off_um <= limit_um, "", dif_nm_from_um(off_um), dif_nm_from_um(limit_um), "nm", outside);
}

static json_t *energy_verdict(const dif_report_job *job, const dif_report_data *data, bool *outside)
{
    const dif_report_energy *normal = &data->energy[0];
    if (!job->has_grating)
        return verdict("energy", -1, "∫ = ", normal->albedo, NAN, "", outside);
    const double off = fabs(normal->albedo - normal->reference);
    const double limit =
        energy_limit_window +
        (dif_report_walls_between(job) ? 0.0 : 2.0 * dif_report_walls(job) / dif_report_samples_per_period(job));
    return verdict("energy", off <= limit, "", off, limit, "", outside);
}

static json_t *verdicts_json(const dif_report_job *job, const dif_report_data *data, double order_worst,
                             double order_limit, bool *outside)
{
    const double worst = data->check.worst_amplitude;
    return json_pack("[o, o, o, o]", period_verdict(job, data, outside),
                     verdict("error", worst <= job->tol, "", worst, job->tol, "", outside),
                     energy_verdict(job, data, outside),
                     verdict("orders", data->n_order > 0 ? order_worst <= order_limit : -1, "", order_worst,
                             order_limit, "", outside));
}

static json_t *timings_json(const dif_report_data *data)
{
    json_t *rows = json_array();
    for (int i = 0; rows && i < data->n_stage; i++) {
        json_t *row = json_pack("{s:s, s:f, s:f}", "stage", data->stage[i].name, "wall_s", data->stage[i].wall_s,
                                "cpu_s", data->stage[i].cpu_s);
        if (json_array_append_new(rows, row) != 0) {
            json_decref(rows);
            rows = NULL;
        }
    }
    const double direct_s = data->check.direct_s_per_sample * (double)data->stats.n_sample;
    const double ratio = direct_s / (data->stats.build_wall_s + data->stats.eval_wall_s);
    char text[DIF_REPORT_TEXT];
    snprintf(text, sizeof text,
             "The direct sum took %.3g ms a sample here; all %zu samples of the table would have taken it %.0f s, %.0f "
             "times "
             "as long as the table took.",
             1e3 * data->check.direct_s_per_sample, data->stats.n_sample, direct_s, ratio);
    return rows ? json_pack("{s:o, s:s}", "rows", rows, "text", text) : NULL;
}

static json_t *files_json(const dif_report_job *job, const dif_report_data *data)
{
    static const char *const keys[][2] = {
        {"height", "height.exr"}, {"table", "table.exr"}, {"table_csv", "table.csv"}, {"maxima", "maxima.csv"},
        {"lines", "lines.csv"},   {"map_exr", "map.exr"}, {"map", "map.png"},         {"map_level", "map-level.png"}};
    const size_t n = sizeof keys / sizeof *keys - (data->map.map.n_pixel > 0 ? 0 : 3);
    json_t *files = json_object();
    for (size_t i = 0; files && i < n; i++) {
        char name[128];
        snprintf(name, sizeof name, "%s.%s", job->slug, keys[i][1]);
        if (json_object_set_new(files, keys[i][0], json_string(name)) != 0) {
            json_decref(files);
            files = NULL;
        }
    }
    return files;
}

/* The period the surface was made with, or null. */
static json_t *known_json(const dif_report_job *job)
{
    if (!isfinite(job->known_period_um))
        return json_null();
    if (!job->has_grating)
        return json_pack("{s:o, s:b}", "period_nm", nm(job->known_period_um), "exact", (int)job->known_exact);
    return json_pack("{s:o, s:b, s:s, s:o, s:o, s:o}", "period_nm", nm(job->known_period_um), "exact",
                     (int)job->known_exact, "profile", dif_profile_name(job->grating.profile), "height_nm",
                     nm(job->grating.height_um), "duty", dif_json_number(job->grating.duty), "psi_deg",
                     degrees(job->grating.psi_rad));
}

json_t *dif_report_json(const dif_report_job *job, const dif_report_data *data, bool *outside)
{
    double order_worst, order_limit;
    json_t *orders = orders_json(job, data, &order_worst, &order_limit);
    json_t *out = json_pack(
        "{s:s, s:s, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "schema",
        DIF_RESULT_SCHEMA, "title", job->title, "description", job->description, "files", files_json(job, data),
        "known", known_json(job), "surface", surface_json(job, &data->field), "plan", plan_json(job, data), "measure",
        measure_json(job, data), "check", check_json(&data->check), "below_tol2", below_json(data), "fit_table",
        dif_report_fit_table_json(job, data), "fit_surface", dif_report_fit_surface_json(data), "maxima",
        dif_report_maxima_json(data), "energy", energy_json(job, data), "orders", orders, "domain",
        dif_report_domain(job, data), "verdicts", verdicts_json(job, data, order_worst, order_limit, outside));
    json_t *provenance = dif_json_manifest(&job->provenance);
    bool done = out != NULL;
    if (data->map.map.n_pixel > 0)
        done = done && json_object_set_new(out, "map", dif_report_map_json(data)) == 0;
    if (data->methods.compare.n > 0)
        done = done && json_object_set_new(out, "methods", dif_report_methods_json(data)) == 0;
    if (data->gpu.json)
        done = done && json_object_set(out, "gpu", data->gpu.json) == 0;
    *outside = *outside || data->gpu.n_failed > 0;
    if (data->render.frame.nx > 0)
        done = done && json_object_set_new(out, "render", dif_report_render_json(job, &data->render)) == 0;
    if (data->slopes.slopes.square.n > 0)
        done = done && json_object_set_new(out, "slopes", dif_report_slopes_json(job, &data->slopes)) == 0;
    if (data->study.n_row > 0)
        done = done && json_object_set_new(out, "study", dif_report_study_json(job, data)) == 0;
    if (done && json_object_set_new(out, "provenance", provenance) == 0 &&
        (getenv("SOURCE_DATE_EPOCH") || json_object_set_new(out, "timings", timings_json(data)) == 0))
        return out;
    json_decref(out);
    return NULL;
}
