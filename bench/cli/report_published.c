/* A surface's periods as the source's program finds them, and put right, beside what the source published. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "bench/scan.h"
#include "core/units.h"

/* The source's table, and the angles it read each surface at; NaN = not in it. Its column called variance holds standard
 * deviations. */
static const struct {
    const char *name; /* part of the surface's file name */
    double full_nm, full_sd_nm, nmm_nm, pq_nm, angle_min_deg, angle_max_deg;
    double azimuth_deg; /* NaN = across the grooves */
} PUBLISHED[] = {{"blazed", 2499.997, 0.377, (double)NAN, 2502.428, -55.0, -40.0, (double)NAN},
                 {"elaphe", 1144.262, (double)NAN, 1144.179, 1052.308, -40.0, -15.0, 180.0},
                 {"xenopeltis", 1552.27, (double)NAN, (double)NAN, (double)NAN, -50.0, -25.0, 90.0}};

static const double source_sigma_um = 16.25, source_theta_deg = 75.0, step_deg = 0.01;

static int published_of(const dif_report_job *job)
{
    for (int i = 0; i < DIF_COUNT(PUBLISHED); i++) {
        if (strstr(job->slug, PUBLISHED[i].name))
            return i;
    }
    return -1;
}

static const dif_compare_row *row_named(const dif_compare *compare, const char *name)
{
    for (int i = 0; i < compare->n; i++) {
        if (strcmp(compare->row[i].name, name) == 0)
            return &compare->row[i];
    }
    return &compare->row[0];
}

static dif_report_period_found found(const dif_compare *compare, const char *name)
{
    const dif_compare_row *row = row_named(compare, name);
    return (dif_report_period_found){row->argmax_mean_um, row->argmax_sd_um};
}

/* All methods' plain maxima, lit from one azimuth, under the source's conditions. */
static dif_status measure_side(const dif_field *field, double azimuth_deg, const dif_range *angle_deg,
                               const dif_measure_opts *opts, dif_report_side *out, dif_error *err)
{
    const dif_range lambda_nm = {380.0, 780.0, 1.0, 401};
    dif_compare_opts how = dif_compare_opts_default();
    dif_compare compare;
    dif_plan plan;
    how.n_check = 1;
    how.fit = false;
    how.colour_step_deg = 5.0; /* colours are not asked for here */
    how.colour_step_nm = 100.0;
    dif_status status = dif_scan_plan(false, source_theta_deg, azimuth_deg, angle_deg, &lambda_nm, &plan, err);
    if (status != DIF_OK)
        return status;
    status = dif_compare_methods(field, &plan, 1e-6, opts, &how, &compare, err);
    dif_plan_free(&plan);
    if (status != DIF_OK)
        return status;
    *out = (dif_report_side){azimuth_deg, found(&compare, "thesis"), found(&compare, "sheet"), found(&compare, "nmm"),
                             found(&compare, "pq")};
    return DIF_OK;
}

dif_status dif_report_published(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    dif_report_study *study = &data->study;
    dif_measure_opts opts = job->opts;
    dif_range angle_deg;
    double period_um, psi_rad;
    const int known = published_of(job);
    const bool has_period = dif_report_period(job, data, &period_um, &psi_rad);
    if (known < 0 && !has_period)
        return DIF_OK;
    /* the source lights along the axes of its scans */
    double azimuth_deg = known >= 0 ? PUBLISHED[known].azimuth_deg : (double)NAN;
    if (isnan(azimuth_deg))
        azimuth_deg = 90.0 * rint(dif_deg_from_rad(psi_rad) / 90.0);
    if (known >= 0) {
        const double a = PUBLISHED[known].angle_min_deg, b = PUBLISHED[known].angle_max_deg;
        angle_deg = (dif_range){a, b, step_deg, (int)rint((b - a) / step_deg) + 1};
    } else if (!dif_report_first_order(dif_rad_from_deg(source_theta_deg), 0.38, 0.78, period_um, step_deg,
                                       &angle_deg)) {
        return DIF_OK;
    }
    opts.window = DIF_WINDOW_GAUSS;
    opts.average = DIF_AVERAGE_NONE;
    opts.sigma_um = source_sigma_um;
    /* a period across the plane of incidence, of another structure, is none to replicate here */
    const bool along = has_period && fabs(cos(psi_rad - dif_rad_from_deg(azimuth_deg))) > 0.7;
    opts.period_um = along ? period_um : (double)NAN;
    opts.psi_rad = psi_rad;
    opts.progress = NULL;
    dif_status status = DIF_OK;
    for (int i = 0; i < 2 && status == DIF_OK; i++) {
        status = measure_side(&job->field, fmod(azimuth_deg + 180.0 * i + 360.0, 360.0), &angle_deg, &opts,
                              &study->side[i], err);
        study->n_side = i + 1;
    }
    return status;
}

dif_status dif_report_source_bitmap(dif_report_period_found *out, dif_error *err)
{
    dif_field field;
    dif_measure_opts opts = dif_measure_opts_default();
    const dif_range angle_deg = {-55.0, -40.0, step_deg, 1501};
    dif_report_side side;
    dif_status status = dif_field_create(200, 200, 0.0125, 0.0125, &field, err);
    if (status != DIF_OK)
        return status;
    for (int i = 0; i < 200 * 200; i++) /* one period of 2500 nm, 250 nm high, in 8 bits */
        field.z_um[i] = 0.25 * rint(255.0 * (i % 200) / 200.0) / 255.0;
    opts.sigma_um = source_sigma_um;
    status = measure_side(&field, 0.0, &angle_deg, &opts, &side, err);
    dif_field_free(&field);
    if (status == DIF_OK)
        *out = side.thesis;
    return status;
}

static json_t *nm(double um)
{
    return dif_json_number(dif_nm_from_um(um));
}

static json_t *side_json(const dif_report_side *side)
{
    return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "azimuth_deg", dif_json_number(side->azimuth_deg),
                     "thesis_nm", nm(side->thesis.mean_um), "thesis_sd_nm", nm(side->thesis.sd_um), "right_nm",
                     nm(side->right.mean_um), "right_sd_nm", nm(side->right.sd_um), "nmm_nm", nm(side->nmm.mean_um),
                     "nmm_sd_nm", nm(side->nmm.sd_um), "pq_nm", nm(side->pq.mean_um), "pq_sd_nm", nm(side->pq.sd_um));
}

json_t *dif_report_published_json(const dif_report_job *job, const dif_report_data *data)
{
    const int known = published_of(job);
    json_t *sides = json_array();
    for (int i = 0; i < data->study.n_side; i++)
        json_array_append_new(sides, side_json(&data->study.side[i]));
    const bool stand_in = isfinite(job->known_period_um) && !job->has_grating;
    const double none = (double)NAN;
    const bool same_plane = data->study.n_side > 0 &&
                            fabs(cos(dif_rad_from_deg(data->study.side[0].azimuth_deg) - job->plan.azimuth_rad)) > 0.99;
    return json_pack("{s:b, s:b, s:o, s:o, s:o, s:o, s:o}", "stand_in", (int)stand_in, "same_plane", (int)same_plane,
                     "full_nm", dif_json_number(known < 0 ? none : PUBLISHED[known].full_nm), "full_sd_nm",
                     dif_json_number(known < 0 ? none : PUBLISHED[known].full_sd_nm), "nmm_nm",
                     dif_json_number(known < 0 ? none : PUBLISHED[known].nmm_nm), "pq_nm",
                     dif_json_number(known < 0 ? none : PUBLISHED[known].pq_nm), "sides", sides);
}
