/* All methods side by side on a report's surface. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "bench/scan.h"
#include "core/units.h"

/* The first order's angles in steps of this, up to this: enough for the source's statistic to a tenth of its spread. */
static const double angle_step_deg = 0.01, angle_max_deg = 80.0;
static const double margin = 0.06; /* around the first order, as a share of lambda/d */
enum { CHECK_N = 60 };

bool dif_report_period(const dif_report_job *job, const dif_report_data *data, double *period_um, double *psi_rad)
{
    const bool by_table = data->fit_status == DIF_OK && (job->is_grating || data->surface_status != DIF_OK);
    *psi_rad = job->has_grating                 ? job->grating.psi_rad
               : data->surface_status == DIF_OK ? data->surface.psi_rad
                                                : job->plan.azimuth_rad;
    *period_um = by_table ? data->fit.period_um : data->surface.period_um;
    return (by_table || data->surface_status == DIF_OK) && *period_um > 0.0;
}

bool dif_report_first_order(double fixed_rad, double lambda_min_um, double lambda_max_um, double period_um,
                            double step_deg, dif_range *angle_deg)
{
    const double side = fixed_rad < 0.0 ? -1.0 : 1.0, limit = sin(dif_rad_from_deg(angle_max_deg));
    const double a = (1.0 - margin) * lambda_min_um / period_um - fabs(sin(fixed_rad));
    const double b = (1.0 + margin) * lambda_max_um / period_um - fabs(sin(fixed_rad));
    if (!(a < limit && b > -limit))
        return false;
    const double at[2] = {dif_deg_from_rad(asin(fmax(a, -limit))), dif_deg_from_rad(asin(fmin(b, limit)))};
    const int n = (int)ceil((at[1] - at[0]) / step_deg) + 1;
    const double first = step_deg * floor((side > 0.0 ? at[0] : -at[1]) / step_deg);
    *angle_deg = (dif_range){first, first + (n - 1) * step_deg, step_deg, n};
    return n > 2;
}

dif_status dif_report_methods(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    dif_report_methods_data *out = &data->methods;
    const dif_plan *whole = &job->plan;
    dif_measure_opts opts = job->opts;
    double psi_rad;
    dif_range angle_deg;
    dif_plan plan;
    opts.average = DIF_AVERAGE_NONE; /* as the source; the methods that cannot average stay comparable */
    *out = (dif_report_methods_data){.period_um = NAN};
    if (dif_report_period(job, data, &out->period_um, &psi_rad)) {
        opts.period_um = out->period_um;
        opts.psi_rad = psi_rad;
    } else {
        out->period_um = NAN;
    }
    const double along = isnan(out->period_um) ? 0.0 : fabs(cos(psi_rad - whole->azimuth_rad));
    out->first_order = along > 0.1 && dif_report_first_order(whole->fixed_rad, whole->lambda_um[0],
                                                             whole->lambda_um[whole->n_lambda - 1],
                                                             out->period_um / along, angle_step_deg, &angle_deg);
    dif_status status;
    if (out->first_order) {
        const int nl = whole->n_lambda;
        const double l0 = dif_nm_from_um(whole->lambda_um[0]), l1 = dif_nm_from_um(whole->lambda_um[nl - 1]);
        const dif_range lambda_nm = {l0, l1, nl > 1 ? (l1 - l0) / (nl - 1) : 1.0, nl};
        status = dif_scan_plan(whole->fixed_is_wo, dif_deg_from_rad(whole->fixed_rad),
                               dif_deg_from_rad(whole->azimuth_rad), &angle_deg, &lambda_nm, &plan, err);
    } else {
        status = dif_plan_copy(whole, &plan, err);
    }
    if (status != DIF_OK)
        return status;
    dif_compare_opts how = dif_compare_opts_default();
    how.n_check = CHECK_N;
    how.fit = false; /* the fit of the table above says more */
    out->n_check = how.n_check;
    out->colour_max_deg = how.colour_max_deg;
    out->colour_step_deg = how.colour_step_deg;
    out->colour_step_nm = how.colour_step_nm;
    out->angle_min_deg = dif_deg_from_rad(plan.angle_rad[0]);
    out->angle_max_deg = dif_deg_from_rad(plan.angle_rad[plan.n_angle - 1]);
    out->n_cell = (double)plan.n_angle * plan.n_lambda;
    status = dif_compare_methods(&job->field, &plan, job->tol, &opts, &how, &out->compare, err);
    dif_plan_free(&plan);
    return status;
}

static json_t *row_json(const dif_compare_row *row, bool first_order)
{
    const bool ok = row->status == DIF_OK;
    json_t *out = json_pack("{s:s, s:s, s:b, s:s, s:o, s:o, s:o}", "name", row->name, "leaves_out", row->leaves_out,
                            "ok", (int)ok, "text", row->text, "bound", dif_json_number(row->bound), "error_worst",
                            dif_json_number(row->error_worst), "error_rms", dif_json_number(row->error_rms));
    json_t *rest =
        json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "maxima_nm",
                  dif_json_number(first_order ? dif_nm_from_um(row->argmax_mean_um) : (double)NAN), "maxima_sd_nm",
                  dif_json_number(first_order ? dif_nm_from_um(row->argmax_sd_um) : (double)NAN), "de_median",
                  dif_json_number(row->de_median), "de_p95", dif_json_number(row->de_p95), "de_worst",
                  dif_json_number(row->de_worst), "de_worst_deg", dif_json_number(row->de_worst_deg), "shift_x",
                  dif_json_number(row->shift_x), "shift_y", dif_json_number(row->shift_y));
    bool done = out && rest && json_object_update(out, rest) == 0;
    json_decref(rest);
    if (done && !getenv("SOURCE_DATE_EPOCH"))
        done = json_object_set_new(out, "wall_s", dif_json_number(row->build_s + row->eval_s)) == 0 &&
               json_object_set_new(out, "cpu_s", dif_json_number(row->cpu_s)) == 0;
    if (done)
        return out;
    json_decref(out);
    return NULL;
}

json_t *dif_report_methods_json(const dif_report_data *data)
{
    const dif_report_methods_data *methods = &data->methods;
    json_t *rows = json_array();
    for (int i = 0; rows && i < methods->compare.n; i++) {
        if (json_array_append_new(rows, row_json(&methods->compare.row[i], methods->first_order)) != 0) {
            json_decref(rows);
            rows = NULL;
        }
    }
    return rows ? json_pack("{s:o, s:b, s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "period_nm",
                            dif_json_number(dif_nm_from_um(methods->period_um)), "first_order",
                            (int)methods->first_order, "n_check", methods->n_check, "n_cell",
                            dif_json_number(methods->n_cell), "angle_deg_min", dif_json_number(methods->angle_min_deg),
                            "angle_deg_max", dif_json_number(methods->angle_max_deg), "colour_deg_max",
                            dif_json_number(methods->colour_max_deg), "colour_deg_step",
                            dif_json_number(methods->colour_step_deg), "colour_nm_step",
                            dif_json_number(methods->colour_step_nm), "exposure",
                            dif_json_number(methods->compare.exposure), "rows", rows)
                : NULL;
}
