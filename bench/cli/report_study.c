/* The source's studies on a report's surface: wavelength step, coherence, terms of the series, angle of incidence. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/report_job.h"
#include "core/alloc.h"
#include "core/sheet.h"
#include "core/units.h"

enum { SIDE = 145, FINE = 3 }; /* odd: a row of pixels lies in the plane of incidence, where lines are thin */
static const double study_tol = 1e-4, study_theta_deg = 30.0, study_step_nm = 5.0;

/* One picture's conditions. */
typedef struct condition {
    double theta_deg, step_nm, sigma_um;
    int n_terms; /* 0 = the sheet, DIF_TERMS_FROM_TOL, or this many */
} condition;

/* Mean of FINE x FINE pixels each, so that lines thinner than a pixel are not missed. */
static dif_status shrink(dif_map *map, dif_error *err)
{
    float *small = dif_alloc((size_t)SIDE * SIDE, 3 * sizeof *small);
    if (!small)
        return dif_fail(err, DIF_ERR_NOMEM, "picture of %d pixels", SIDE);
    for (int iy = 0; iy < SIDE * FINE; iy++) {
        for (int ix = 0; ix < SIDE * FINE; ix++) {
            const float *from = map->xyz + 3 * ((size_t)iy * SIDE * FINE + (size_t)ix);
            float *to = small + 3 * ((size_t)(iy / FINE) * SIDE + (size_t)(ix / FINE));
            for (int c = 0; c < 3; c++)
                to[c] += from[c] / (FINE * FINE);
        }
    }
    dif_release(map->xyz);
    map->xyz = small;
    map->n_pixel = SIDE;
    return DIF_OK;
}

static dif_status make(const dif_report_job *job, const condition *at, dif_report_study_item *out, int *n_terms,
                       dif_error *err)
{
    dif_measure_opts opts = job->opts;
    dif_measure_stats stats;
    opts.average = DIF_AVERAGE_NONE; /* as the source */
    opts.sigma_um = at->sigma_um;
    opts.method = at->n_terms != 0 ? DIF_METHOD_TAYLOR : DIF_METHOD_SHEET;
    opts.n_terms = at->n_terms != 0 ? at->n_terms : DIF_TERMS_FROM_TOL;
    const double theta_rad = dif_rad_from_deg(at->theta_deg);
    const int side = at->n_terms != 0 ? SIDE : SIDE * FINE; /* the series is read pixel by pixel, slowly */
    dif_status status = dif_report_map_make(&job->field, &opts, theta_rad, job->plan.azimuth_rad, side, at->step_nm,
                                            study_tol, &out->map, &stats, err);
    if (status == DIF_OK && side != SIDE)
        status = shrink(&out->map, err);
    if (status == DIF_OK)
        status = dif_report_map_exposure(&out->map, theta_rad, job->plan.azimuth_rad, &out->exposure, err);
    if (n_terms)
        *n_terms = stats.n_plane;
    return status;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Differences of a picture's colours from the converged one's. */
static dif_status compare(dif_report_study_item *item, const dif_report_study_item *truth, dif_error *err)
{
    const size_t n = (size_t)SIDE * SIDE;
    size_t m = 0;
    double *de = dif_alloc(n, sizeof *de);
    if (!de)
        return dif_fail(err, DIF_ERR_NOMEM, "%zu colour differences", n);
    for (size_t i = 0; i < n; i++) {
        dif_vec3 wo;
        double a[3], b[3], lab_a[3], lab_b[3];
        if (!dif_map_direction(SIDE, (int)(i % SIDE), (int)(i / SIDE), &wo))
            continue;
        for (size_t c = 0; c < 3; c++) {
            a[c] = item->exposure * (double)item->map.xyz[3 * i + c];
            b[c] = truth->exposure * (double)truth->map.xyz[3 * i + c];
        }
        dif_colour_lab_from_xyz(a, lab_a);
        dif_colour_lab_from_xyz(b, lab_b);
        de[m++] = dif_colour_difference_2000(lab_a, lab_b);
    }
    qsort(de, m, sizeof *de, by_value);
    item->de_median = de[m / 2];
    item->de_p95 = de[(size_t)(0.95 * (double)(m - 1))];
    item->de_worst = de[m - 1];
    dif_release(de);
    return DIF_OK;
}

/* Compares a row with its item `truth`; same_exposure: the row is shown at that one's. */
static dif_status finish_row(dif_report_study_row *row, int truth, bool same_exposure, dif_error *err)
{
    dif_status status = DIF_OK;
    for (int i = 0; i < row->n && status == DIF_OK; i++) {
        if (same_exposure)
            row->item[i].exposure = row->item[truth].exposure;
        status = compare(&row->item[i], &row->item[truth], err);
    }
    return status;
}

static dif_status study_step(const dif_report_job *job, dif_report_study_row *row, dif_error *err)
{
    static const double steps_nm[] = {1.0, 5.0, 10.0, 25.0, 50.0, 100.0};
    dif_status status = DIF_OK;
    row->title = "Wavelength step";
    row->text =
        "Few wavelengths leave gaps in the spectrum of a direction, and lines turn into strings of coloured beads. "
        "Differences from 1 nm.";
    for (int i = 0; i < DIF_COUNT(steps_nm) && status == DIF_OK; i++) {
        const condition at = {study_theta_deg, steps_nm[i], job->opts.sigma_um, 0};
        snprintf(row->item[i].label, sizeof row->item[i].label, "%g nm", steps_nm[i]);
        row->n = i + 1;
        status = make(job, &at, &row->item[i], NULL, err);
    }
    return status == DIF_OK ? finish_row(row, 0, true, err) : status;
}

static dif_status study_sigma(const dif_report_job *job, dif_report_study_row *row, dif_error *err)
{
    static const double sigmas_um[] = {3.25, 6.5, 15.0, 30.0, 45.0, 65.0};
    dif_status status = DIF_OK;
    row->title = "Coherence, σ of the window";
    row->text =
        "A wider window makes lines narrower and, on irregular surfaces, speckle finer. Each picture has its own "
        "exposure. Differences from the widest.";
    for (int i = 0; i < DIF_COUNT(sigmas_um) && status == DIF_OK; i++) {
        const condition at = {study_theta_deg, study_step_nm, sigmas_um[i], 0};
        snprintf(row->item[i].label, sizeof row->item[i].label, "%g µm", sigmas_um[i]);
        row->n = i + 1;
        status = make(job, &at, &row->item[i], NULL, err);
    }
    return status == DIF_OK ? finish_row(row, row->n - 1, false, err) : status;
}

static dif_status study_terms(const dif_report_job *job, dif_report_study_row *row, dif_error *err)
{
    int n_terms = 0;
    condition at = {study_theta_deg, study_step_nm, job->opts.sigma_um, DIF_TERMS_FROM_TOL};
    row->title = "Terms of the Taylor series";
    row->text =
        "The number that is needed grows with the depth of the surface; far below it colours and powers are wrong, "
        "because the largest terms are in the middle of the series. Differences from the converged one, whose "
        "exposure all have.";
    row->n = DIF_REPORT_STUDY_MAX;
    dif_report_study_item *last = &row->item[row->n - 1];
    dif_status status = make(job, &at, last, &n_terms, err);
    snprintf(last->label, sizeof last->label, "%d (converged)", n_terms);
    for (int i = 0; i < row->n - 1 && status == DIF_OK; i++) {
        at.n_terms = (int)rint(pow(n_terms, (double)i / (row->n - 1)));
        snprintf(row->item[i].label, sizeof row->item[i].label, "%d", at.n_terms);
        status = make(job, &at, &row->item[i], NULL, err);
    }
    return status == DIF_OK ? finish_row(row, row->n - 1, true, err) : status;
}

static dif_status study_theta(const dif_report_job *job, dif_report_study_row *row, dif_error *err)
{
    static const double thetas_deg[] = {0.0, 10.0, 20.0};
    dif_status status = DIF_OK;
    row->title = "Angle of incidence";
    row->text = "The pattern moves with the mirror direction and w changes little. Each picture has its own exposure.";
    for (int i = 0; i < DIF_COUNT(thetas_deg) && status == DIF_OK; i++) {
        const condition at = {thetas_deg[i], study_step_nm, job->opts.sigma_um, 0};
        dif_report_study_item *item = &row->item[i];
        snprintf(item->label, sizeof item->label, "%g°", thetas_deg[i]);
        row->n = i + 1;
        item->de_median = item->de_p95 = item->de_worst = NAN; /* nothing to converge to */
        status = make(job, &at, item, NULL, err);
    }
    return status;
}

dif_status dif_report_study_make(const dif_report_job *job, dif_report_data *data, dif_error *err)
{
    dif_report_study *study = &data->study;
    static dif_status (*const studies[DIF_REPORT_STUDY_ROWS])(const dif_report_job *, dif_report_study_row *,
                                                              dif_error *) = {study_step, study_sigma, study_terms,
                                                                              study_theta};
    dif_status status = DIF_OK;
    *study = (dif_report_study){0};
    for (int i = 0; i < DIF_REPORT_STUDY_ROWS && status == DIF_OK; i++) {
        study->n_row = i + 1;
        status = studies[i](job, &study->row[i], err);
    }
    return status == DIF_OK ? dif_report_published(job, data, err) : status;
}

void dif_report_study_free(dif_report_study *study)
{
    for (int i = 0; i < DIF_REPORT_STUDY_ROWS; i++) {
        for (int k = 0; k < DIF_REPORT_STUDY_MAX; k++)
            dif_map_free(&study->row[i].item[k].map);
    }
    *study = (dif_report_study){0};
}

dif_status dif_report_study_write(const char *folder, const dif_report_job *job, const dif_report_study *study,
                                  dif_error *err)
{
    char path[4096];
    dif_status status = DIF_OK;
    for (int i = 0; i < study->n_row && status == DIF_OK; i++) {
        for (int k = 0; k < study->row[i].n && status == DIF_OK; k++) {
            const dif_report_study_item *item = &study->row[i].item[k];
            const int n = snprintf(path, sizeof path, "%s/%s.study-%d-%d.png", folder, job->slug, i + 1, k + 1);
            if (n < 0 || n >= (int)sizeof path)
                return dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
            status = dif_report_map_write(path, &item->map, item->exposure, DIF_GAMUT_DESATURATE, err);
        }
    }
    return status;
}

static json_t *item_json(const dif_report_job *job, const dif_report_study_item *item, int i, int k)
{
    char name[128];
    snprintf(name, sizeof name, "%s.study-%d-%d.png", job->slug, i + 1, k + 1);
    return json_pack("{s:s, s:s, s:o, s:o, s:o, s:o}", "label", item->label, "picture", name, "exposure",
                     dif_json_number(item->exposure), "de_median", dif_json_number(item->de_median), "de_p95",
                     dif_json_number(item->de_p95), "de_worst", dif_json_number(item->de_worst));
}

json_t *dif_report_study_json(const dif_report_job *job, const dif_report_data *data)
{
    const dif_report_study *study = &data->study;
    json_t *rows = json_array();
    for (int i = 0; i < study->n_row; i++) {
        json_t *items = json_array();
        for (int k = 0; k < study->row[i].n; k++)
            json_array_append_new(items, item_json(job, &study->row[i].item[k], i, k));
        json_array_append_new(rows, json_pack("{s:s, s:s, s:o}", "title", study->row[i].title, "text",
                                              study->row[i].text, "items", items));
    }
    return json_pack("{s:o, s:o, s:o, s:o}", "theta_i_deg", dif_json_number(study_theta_deg), "lambda_nm_step",
                     dif_json_number(study_step_nm), "rows", rows, "published", dif_report_published_json(job, data));
}
