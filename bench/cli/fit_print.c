#include "bench/cli/fit_print.h"

#include <math.h>
#include <stdio.h>

#include "bench/cli/cli.h"
#include "core/units.h"

/* Prints value +- error with as many decimals as the error's second digit. */
static void print_pair(double value_nm, double error_nm)
{
    int decimals = error_nm > 0.0 && isfinite(error_nm) ? 1 - (int)floor(log10(error_nm)) : 3;
    decimals = decimals < 0 ? 0 : decimals > 9 ? 9 : decimals;
    printf("%.*f nm +- %.*f nm", decimals, value_nm, decimals, error_nm);
}

static void print_note(const char *note)
{
    if (note[0])
        printf("note       %s\n", note);
}

void dif_fit_table_print(const dif_fit_result *r, bool is_common)
{
    const bool has_many = r->n_ridge > 1 && !is_common;
    printf(has_many ? "strongest  " : "period     ");
    print_pair(dif_nm_from_um(r->period_um), dif_nm_from_um(r->period_uncertainty_um));
    printf(" (one standard error, the largest of these)\n"
           "           covariance %.3g nm, scatter over %d disjoint parts %.3g nm, model %.3g nm\n",
           dif_nm_from_um(r->period_sd_um), r->n_part, dif_nm_from_um(r->period_scatter_um),
           dif_nm_from_um(r->period_model_um));
    if (has_many)
        printf("           of %d ridges, %.0f %% of the power: no single period\n", r->n_ridge,
               100.0 * r->ridge[0].weight);
    if (r->offset_sd_rad > 0.0)
        printf("offset     %.6f deg +- %.2g deg\n", dif_deg_from_rad(r->offset_rad),
               dif_deg_from_rad(r->offset_sd_rad));
    printf("ridges     %5s %12s %12s %12s %8s %14s %12s\n", "order", "period_nm", "covariance", "scatter", "weight",
           "f_per_um", "width_per_um");
    for (int i = 0; i < r->n_ridge; i++) {
        const dif_fit_ridge *ridge = &r->ridge[i];
        printf("           %5d %12.7g %12.3g %12.3g %8.4f %14.8g %12.4g\n", ridge->order,
               dif_nm_from_um(ridge->period_um), dif_nm_from_um(ridge->period_sd_um),
               dif_nm_from_um(ridge->period_scatter_um), ridge->weight, ridge->f_per_um, ridge->width_per_um);
    }
    printf("residuals  rms %.3g, %.3g %% of the data's rms; %d data, %d parameters, %d iterations\n", r->residual_rms,
           100.0 * r->residual_share, r->n_data, r->n_parameter, r->n_iteration);
    print_note(r->note);
}

/* An azimuth of [0, 180) that would be printed as 180 is printed as 0. */
static double printed_azimuth_deg(double psi_rad)
{
    const double deg = dif_deg_from_rad(psi_rad);
    return deg >= 179.99995 ? 0.0 : deg;
}

/* How the period changes along the slow axis: the line, and the bands that it goes through. */
static void print_drift(const dif_fit_drift *drift, double period_um)
{
    if (!isfinite(drift->slope)) {
        printf("drift      not determined: %d bands along y\n", drift->n_band);
        return;
    }
    printf("drift      %+.3g +- %.2g nm per um of y, %+.2g %% over the scan: %s\n", dif_nm_from_um(drift->slope),
           dif_nm_from_um(drift->slope_sd), 100.0 * drift->share,
           drift->is_significant ? "SIGNIFICANT (1 %), no single period" : "not significant (1 %)");
    for (int i = 0; i < drift->n_band; i++)
        printf("%s y %+9.4g um  %+.3g nm\n", i ? "          " : "bands     ", drift->band[i].y_um,
               dif_nm_from_um(drift->band[i].period_um - period_um));
}

void dif_fit_surface_print(const dif_fit_surface_result *r)
{
    printf("period     ");
    print_pair(dif_nm_from_um(r->period_um), dif_nm_from_um(r->period_uncertainty_um));
    printf(" (one standard error, the largest of these)\n"
           "           covariance %.3g nm, scatter over %d bands of the scan %.3g nm, profile %.3g nm\n"
           "           (the bands' own standard deviation is %.3g nm)\n"
           "groove     normal at azimuth %.4f deg +- %.2g deg\n",
           dif_nm_from_um(r->period_sd_um), r->n_part, dif_nm_from_um(r->period_scatter_um),
           dif_nm_from_um(r->period_profile_um), dif_nm_from_um(r->band_sd_um), printed_azimuth_deg(r->psi_rad),
           dif_deg_from_rad(r->psi_sd_rad));
    print_drift(&r->drift, r->period_um);
    printf("harmonics ");
    for (int i = 0; i < r->n_harmonic; i++)
        printf(" %.4g", dif_nm_from_um(r->amplitude_um[i]));
    printf(" nm (amplitudes)\n"
           "residuals  rms %.3g nm, %.3g %% of the heights' rms; %d iterations\n",
           dif_nm_from_um(r->residual_rms_um), 100.0 * r->residual_share, r->n_iteration);
    print_note(r->note);
}

static void set_number(json_t *object, const char *key, double value)
{
    json_object_set_new(object, key, dif_json_number(value));
}

static void set_period(json_t *object, double period_um, double sd_um, double scatter_um)
{
    set_number(object, "period_nm", dif_nm_from_um(period_um));
    set_number(object, "period_sd_nm", dif_nm_from_um(sd_um));
    set_number(object, "period_scatter_nm", dif_nm_from_um(scatter_um));
}

static json_t *json_ridge(const dif_fit_ridge *ridge)
{
    json_t *object = json_pack("{s:i}", "order", ridge->order);
    set_period(object, ridge->period_um, ridge->period_sd_um, ridge->period_scatter_um);
    set_number(object, "weight", ridge->weight);
    set_number(object, "f_per_um", ridge->f_per_um);
    set_number(object, "f_sd_per_um", ridge->f_sd_per_um);
    set_number(object, "width_per_um", ridge->width_per_um);
    return object;
}

json_t *dif_fit_table_json(const dif_fit_result *r, bool is_common, const dif_manifest *manifest)
{
    json_t *object = json_pack("{s:s, s:b}", "kind", "table", "common_period", is_common), *ridges = json_array();
    set_period(object, r->period_um, r->period_sd_um, r->period_scatter_um);
    set_number(object, "period_model_nm", dif_nm_from_um(r->period_model_um));
    set_number(object, "period_uncertainty_nm", dif_nm_from_um(r->period_uncertainty_um));
    set_number(object, "offset_deg", dif_deg_from_rad(r->offset_rad));
    set_number(object, "offset_sd_deg", dif_deg_from_rad(r->offset_sd_rad));
    for (int i = 0; i < r->n_ridge; i++)
        json_array_append_new(ridges, json_ridge(&r->ridge[i]));
    json_object_set_new(object, "ridges", ridges);
    set_number(object, "residual_rms", r->residual_rms);
    set_number(object, "residual_share", r->residual_share);
    set_number(object, "criterion", r->criterion);
    json_object_set_new(object, "n_data", json_integer(r->n_data));
    json_object_set_new(object, "n_parameter", json_integer(r->n_parameter));
    json_object_set_new(object, "n_iteration", json_integer(r->n_iteration));
    json_object_set_new(object, "n_part", json_integer(r->n_part));
    json_object_set_new(object, "note", json_string(r->note));
    json_object_set_new(object, "provenance", dif_json_manifest(manifest));
    return object;
}

static json_t *json_drift(const dif_fit_drift *drift)
{
    json_t *object = json_pack("{s:b}", "significant", drift->is_significant), *bands = json_array();
    set_number(object, "slope_nm_per_um", dif_nm_from_um(drift->slope));
    set_number(object, "slope_sd_nm_per_um", dif_nm_from_um(drift->slope_sd));
    set_number(object, "share", drift->share);
    for (int i = 0; i < drift->n_band; i++) {
        json_t *band = json_object();
        set_number(band, "y_um", drift->band[i].y_um);
        set_number(band, "period_nm", dif_nm_from_um(drift->band[i].period_um));
        set_number(band, "period_sd_nm", dif_nm_from_um(drift->band[i].period_sd_um));
        json_array_append_new(bands, band);
    }
    json_object_set_new(object, "bands", bands);
    return object;
}

json_t *dif_fit_surface_json(const dif_fit_surface_result *r, const dif_manifest *manifest)
{
    json_t *object = json_pack("{s:s}", "kind", "surface"), *harmonics = json_array();
    set_period(object, r->period_um, r->period_sd_um, r->period_scatter_um);
    set_number(object, "period_profile_nm", dif_nm_from_um(r->period_profile_um));
    set_number(object, "period_uncertainty_nm", dif_nm_from_um(r->period_uncertainty_um));
    set_number(object, "band_sd_nm", dif_nm_from_um(r->band_sd_um));
    set_number(object, "psi_deg", dif_deg_from_rad(r->psi_rad));
    set_number(object, "psi_sd_deg", dif_deg_from_rad(r->psi_sd_rad));
    for (int i = 0; i < r->n_harmonic; i++)
        json_array_append_new(harmonics, dif_json_number(dif_nm_from_um(r->amplitude_um[i])));
    json_object_set_new(object, "amplitude_nm", harmonics);
    json_object_set_new(object, "drift", json_drift(&r->drift));
    set_number(object, "residual_rms_nm", dif_nm_from_um(r->residual_rms_um));
    set_number(object, "residual_share", r->residual_share);
    json_object_set_new(object, "n_iteration", json_integer(r->n_iteration));
    json_object_set_new(object, "n_part", json_integer(r->n_part));
    json_object_set_new(object, "note", json_string(r->note));
    json_object_set_new(object, "provenance", dif_json_manifest(manifest));
    return object;
}
