#include <math.h>
#include <stdlib.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "core/units.h"

static json_t *nm(double um)
{
    return dif_json_number(dif_nm_from_um(um));
}

static json_t *degrees(double rad)
{
    return dif_json_number(dif_deg_from_rad(rad));
}

static json_t *ridges_json(const dif_fit_result *fit)
{
    json_t *list = json_array();
    for (int i = 0; list && i < fit->n_ridge; i++) {
        const dif_fit_ridge *ridge = &fit->ridge[i];
        json_t *item = json_pack("{s:i, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "order", ridge->order, "f_per_um",
                                 dif_json_number(ridge->f_per_um), "u_f_per_um", dif_json_number(ridge->f_sd_per_um),
                                 "period_nm", nm(ridge->period_um), "u_covariance_nm", nm(ridge->period_sd_um),
                                 "u_scatter_nm", nm(ridge->period_scatter_um), "weight", dif_json_number(ridge->weight),
                                 "width_per_um", dif_json_number(ridge->width_per_um));
        if (json_array_append_new(list, item) != 0) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

static json_t *failed_json(const dif_error *error)
{
    return json_pack("{s:b, s:s}", "ok", 0, "text", error->text);
}

/* A believed period with its standard uncertainties: the stated one and what it was chosen from; `rest` is added. */
static json_t *period_json(double period_um, double u_um, double covariance_um, double scatter_um, double model_um,
                           json_t *rest)
{
    json_t *out =
        json_pack("{s:b, s:o, s:o, s:o, s:o, s:o}", "ok", 1, "period_nm", nm(period_um), "u_nm", nm(u_um),
                  "u_covariance_nm", nm(covariance_um), "u_scatter_nm", nm(scatter_um), "u_model_nm", nm(model_um));
    const bool done = out && rest && json_object_update(out, rest) == 0;
    json_decref(rest);
    if (done)
        return out;
    json_decref(out);
    return NULL;
}

json_t *dif_report_fit_table_json(const dif_report_job *job, const dif_report_data *data)
{
    const dif_fit_result *fit = &data->fit;
    if (data->fit_status != DIF_OK)
        return failed_json(&data->fit_error);
    json_t *rest = json_pack(
        "{s:b, s:o, s:o, s:o, s:o, s:o, s:i, s:i, s:i, s:i, s:i, s:s, s:o, s:o, s:o, s:o}", "common_period",
        (int)data->common_period, "offset_deg", degrees(fit->offset_rad), "u_offset_deg", degrees(fit->offset_sd_rad),
        "residual_rms", dif_json_number(fit->residual_rms), "residual_share", dif_json_number(fit->residual_share),
        "criterion", dif_json_number(fit->criterion), "n_data", fit->n_data, "n_parameter", fit->n_parameter,
        "n_iteration", fit->n_iteration, "n_part", fit->n_part, "n_ridge", fit->n_ridge, "note", fit->note, "ridges",
        ridges_json(fit), "f_min_per_um", dif_json_number(job->f_min_per_um), "f_max_per_um",
        dif_json_number(job->f_max_per_um), "angle_max_deg", degrees(dif_report_fit_angle_max_rad()));
    return period_json(fit->period_um, fit->period_uncertainty_um, fit->period_sd_um, fit->period_scatter_um,
                       fit->period_model_um, rest);
}

json_t *dif_report_fit_surface_json(const dif_report_data *data)
{
    const dif_fit_surface_result *fit = &data->surface;
    if (data->surface_status != DIF_OK)
        return failed_json(&data->surface_error);
    json_t *amplitudes = json_array();
    for (int i = 0; amplitudes && i < fit->n_harmonic; i++)
        json_array_append_new(amplitudes, nm(fit->amplitude_um[i]));
    json_t *rest = json_pack("{s:o, s:o, s:o, s:o, s:o, s:i, s:i, s:i, s:s, s:o}", "band_sd_nm", nm(fit->band_sd_um),
                             "psi_deg", degrees(fit->psi_rad), "u_psi_deg", degrees(fit->psi_sd_rad), "residual_rms_nm",
                             nm(fit->residual_rms_um), "residual_share", dif_json_number(fit->residual_share),
                             "n_harmonic", fit->n_harmonic, "n_part", fit->n_part, "n_iteration", fit->n_iteration,
                             "note", fit->note, "amplitudes_nm", amplitudes);
    return period_json(fit->period_um, fit->period_uncertainty_um, fit->period_sd_um, fit->period_scatter_um,
                       fit->period_profile_um, rest);
}

static json_t *order_json(const dif_maxima_order *order)
{
    return json_pack("{s:i, s:i, s:o, s:o, s:o, s:o, s:o}", "order", order->order, "n", order->n, "mean_deg",
                     degrees(order->mean_rad), "rms_deg", degrees(order->rms_rad), "worst_deg",
                     degrees(order->worst_rad), "period_mean_nm", nm(order->period_mean_um), "period_sd_nm",
                     nm(order->period_sd_um));
}

/* The mean period of the largest values, where all of them are of first order; else null, for it would mean nothing. */
static json_t *first_order_json(const dif_maxima *maxima)
{
    int n_global = 0, n_first = 0;
    for (int i = 0; i < maxima->n; i++) {
        n_global += maxima->item[i].is_global;
        n_first += maxima->item[i].is_global && abs(maxima->item[i].order) == 1;
    }
    if (n_first < n_global || n_global == 0)
        return json_null();
    const dif_maxima_period first = dif_maxima_first_order(maxima);
    return json_pack("{s:i, s:i, s:o, s:o, s:o, s:o}", "n", first.n, "order", 1, "mean_nm", nm(first.mean_um), "sd_nm",
                     nm(first.sd_um), "min_nm", nm(first.min_um), "max_nm", nm(first.max_um));
}

json_t *dif_report_maxima_json(const dif_report_data *data)
{
    dif_maxima_order order[DIF_REPORT_ORDER_MAX];
    json_t *orders = json_array();
    int n = data->fit_status == DIF_OK ? dif_maxima_by_order(&data->on_line, DIF_REPORT_ORDER_MAX, order) : 0;
    n = n < DIF_REPORT_ORDER_MAX ? n : DIF_REPORT_ORDER_MAX;
    for (int i = 0; orders && i < n; i++) {
        if (json_array_append_new(orders, order_json(&order[i])) != 0) {
            json_decref(orders);
            orders = NULL;
        }
    }
    return json_pack("{s:i, s:i, s:o, s:o}", "n", data->maxima.n, "n_on_line", data->on_line.n, "first_order",
                     first_order_json(&data->maxima), "orders", orders);
}
