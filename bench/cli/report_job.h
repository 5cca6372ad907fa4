/* One surface of a report: what is measured on it, and how that becomes result files.
 * Layout of the files: reports/result.h.
 * Does not: draw or write the page. */
#ifndef DIF_REPORT_JOB_H
#define DIF_REPORT_JOB_H

#include <jansson.h>

#include "bench/cli/report_gpu.h"
#include "bench/cli/report_render.h"
#include "bench/cli/report_slopes.h"
#include "bench/compare_methods.h"
#include "bench/fit.h"
#include "bench/map.h"
#include "bench/maxima.h"
#include "bench/measure.h"
#include "bench/scan.h"
#include "core/colour.h"
#include "core/grating.h"
#include "core/io/manifest.h"

enum { DIF_REPORT_STAGE_MAX = 16, DIF_REPORT_ORDER_MAX = 64, DIF_REPORT_ENERGY_MAX = 4, DIF_REPORT_TEXT = 400 };

/* What is to be measured. */
typedef struct dif_report_job {
    char title[160], slug[64], description[DIF_REPORT_TEXT];
    dif_field field; /* owned                                                                 */
    double step_um;  /* quantisation of an image, 0 = none                                     */
    dif_plan plan;   /* owned                                                                 */
    dif_measure_opts opts;
    double tol;
    double f_min_per_um, f_max_per_um; /* range of |f| that is fitted: below it lies the mirror beam, above it nothing
                                          that would add to what the first orders say; f_max may be infinite          */
    bool is_grating;  /* all ridges are orders of one period; false: each has its own, as on a scan       */
    bool has_grating; /* the surface is this grating: closed forms apply                        */
    dif_grating grating;
    double known_period_um; /* NaN = unknown                                                       */
    bool known_exact;       /* false: a guide only (irregular rows)                                */
    bool want_map, want_methods, want_gpu, want_render, want_slopes, want_study; /* parts that can be left out */
    dif_manifest provenance; /* owned                                                              */
} dif_report_job;

void dif_report_job_free(dif_report_job *job);

typedef struct dif_report_stage {
    const char *name;
    double wall_s, cpu_s;
} dif_report_stage;

typedef struct dif_report_order {
    int order;
    double angle_rad, sampled, closed, efficiency;
    double limit; /* of |sampled - closed|, from the sampling of walls */
} dif_report_order;

typedef struct dif_report_energy {
    double theta_i_rad, lambda_um, albedo, reference; /* reference NaN = none */
} dif_report_energy;

/* The BRDF map; map.n_pixel 0 = not measured. */
typedef struct dif_report_map_data {
    dif_map map; /* owned */
    double theta_i_rad, azimuth_rad, step_nm, tol, bound;
    double exposure; /* XYZ times this is what the picture shows                     */
    dif_gamut gamut;
    double outside_gamut; /* share of the pixels shown whose colour sRGB does not hold */
    int n_window;
} dif_report_map_data;

/* The methods side by side; compare.n 0 = not measured. */
typedef struct dif_report_methods_data {
    dif_compare compare;
    double period_um; /* that pq and stam were given; NaN = none                                          */
    bool first_order; /* the table holds the first order alone, so that plain maxima speak for the period */
    int n_check;
    double n_cell, angle_min_deg, angle_max_deg, colour_max_deg, colour_step_deg, colour_step_nm;
} dif_report_methods_data;

enum { DIF_REPORT_STUDY_ROWS = 4, DIF_REPORT_STUDY_MAX = 6 };

/* One picture of a study; differences NaN = nothing to compare with. */
typedef struct dif_report_study_item {
    char label[48];
    dif_map map; /* owned */
    double exposure, de_median, de_p95, de_worst;
} dif_report_study_item;

typedef struct dif_report_study_row {
    const char *title, *text;
    int n;
    dif_report_study_item item[DIF_REPORT_STUDY_MAX];
} dif_report_study_row;

/* Mean of lambda / |sin sum| at each wavelength's largest value, and standard deviation; NaN = none. */
typedef struct dif_report_period_found {
    double mean_um, sd_um;
} dif_report_period_found;

/* Lit from one side under the source's conditions: by its program, put right, with few wavelengths, replicated. */
typedef struct dif_report_side {
    double azimuth_deg;
    dif_report_period_found thesis, right, nmm, pq;
} dif_report_side;

/* The source's studies; n_row 0 = not made. */
typedef struct dif_report_study {
    int n_row;
    dif_report_study_row row[DIF_REPORT_STUDY_ROWS];
    int n_side;
    dif_report_side side[2];
} dif_report_study;

/* What was measured. */
typedef struct dif_report_data {
    dif_field_stats field;
    dif_table table; /* owned */
    dif_measure_stats stats;
    dif_measure_check check;
    dif_status fit_status, surface_status; /* DIF_OK, or why there is no period */
    dif_error fit_error, surface_error;
    bool common_period;
    dif_fit_result fit;
    dif_fit_surface_result surface;
    dif_maxima maxima;  /* owned */
    dif_maxima on_line; /* those of them that lie on a line of the fitted period; owned */
    int n_line;
    double (*line)[3]; /* line[n_line]: f, mean power, cells; owned */
    size_t n_below;    /* cells with p < tol^2           */
    double p_min;      /* smallest p of the table        */
    int n_order;
    double order_lambda_um;
    dif_report_order order[DIF_REPORT_ORDER_MAX];
    int n_energy;
    dif_report_energy energy[DIF_REPORT_ENERGY_MAX];
    dif_report_map_data map;
    dif_report_methods_data methods;
    dif_report_gpu_data gpu;       /* owned */
    dif_report_render_data render; /* owned */
    dif_report_slopes_data slopes; /* owned */
    dif_report_study study;        /* owned */
    int n_stage;
    dif_report_stage stage[DIF_REPORT_STAGE_MAX];
} dif_report_data;

/* Measures everything. A fit that is not believed is a result, not a failure. Status as the functions of bench/. */
DIF_MUST_USE dif_status dif_report_measure(const dif_report_job *job, dif_report_data *out, dif_error *err);
void dif_report_data_free(dif_report_data *data);

/* The table folded to spatial frequency: mean normalised power of the cells whose f falls into one bin. */
DIF_MUST_USE dif_status dif_report_fold(const dif_report_job *job, dif_report_data *data, dif_error *err);

/* Largest |running angle| that takes part in the fit of the table. */
double dif_report_fit_angle_max_rad(void);

/* Closed-form order powers beside those of the sampled surface, at the plan's middle wavelength. */
DIF_MUST_USE dif_status dif_report_orders(const dif_report_job *job, dif_report_data *data, dif_error *err);

/* A colour map of rho, 380 ... 780 nm every step_nm, for light from (theta_i, azimuth). stats may be NULL. */
DIF_MUST_USE dif_status dif_report_map_make(const dif_field *field, const dif_measure_opts *opts, double theta_i_rad,
                                            double azimuth_rad, int n_pixel, double step_nm, double tol, dif_map *out,
                                            dif_measure_stats *stats, dif_error *err);

/* The exposure at which the brightest pixels beside the mirror beam, those that hold a quarter of the light there, are
 * white. */
DIF_MUST_USE dif_status dif_report_map_exposure(const dif_map *map, double theta_i_rad, double azimuth_rad,
                                                double *exposure, dif_error *err);

/* Largest luminance. */
double dif_report_map_peak(const dif_map *map);

/* A map's PNG: its colours; with exposure NaN its luminance on a logarithmic scale. */
DIF_MUST_USE dif_status dif_report_map_write(const char *path, const dif_map *map, double exposure, dif_gamut gamut,
                                             dif_error *err);

/* The measured map's numbers. Status as dif_map_write. */
DIF_MUST_USE dif_status dif_report_map_write_exr(const char *path, const dif_report_map_data *map,
                                                 const dif_manifest *provenance, dif_error *err);

/* The map of the job's surface, and the comparison of methods on it. */
DIF_MUST_USE dif_status dif_report_map(const dif_report_job *job, dif_report_data *data, dif_error *err);
DIF_MUST_USE dif_status dif_report_methods(const dif_report_job *job, dif_report_data *data, dif_error *err);

/* The source's studies: pictures, and periods beside its published ones. */
DIF_MUST_USE dif_status dif_report_study_make(const dif_report_job *job, dif_report_data *data, dif_error *err);
DIF_MUST_USE dif_status dif_report_study_write(const char *folder, const dif_report_job *job,
                                               const dif_report_study *study, dif_error *err);
void dif_report_study_free(dif_report_study *study);
DIF_MUST_USE dif_status dif_report_published(const dif_report_job *job, dif_report_data *data, dif_error *err);

/* The source's program on the source's own blazed bitmap: 200 x 200 samples, one period of 2500 nm. */
DIF_MUST_USE dif_status dif_report_source_bitmap(dif_report_period_found *out, dif_error *err);

/* Angles of the first order of a period between two wavelengths, with a margin; false if it is not seen. */
bool dif_report_first_order(double fixed_rad, double lambda_min_um, double lambda_max_um, double period_um,
                            double step_deg, dif_range *angle_deg);

/* The period that pq and stam are given: of the table's fit for a grating, else of the heights'. False = none. */
bool dif_report_period(const dif_report_job *job, const dif_report_data *data, double *period_um, double *psi_rad);

/* How far scalar theory can be trusted here: a list of {"level", "text"}. NULL = out of memory. */
json_t *dif_report_domain(const dif_report_job *job, const dif_report_data *data);

/* True if a maximum lies within twice the line's rms width of its order, so that it speaks for the fitted period; side
 * lobes, other ridges and the rise towards grazing angles do not. */
bool dif_report_on_line(const dif_report_data *data, const dif_maximum *maximum);

/* Vertical walls in a period of the job's grating, and samples in a period along its normal (axis-parallel). */
int dif_report_walls(const dif_report_job *job);

/* True if every wall stands between two pixels (axis-parallel grating, a whole number of samples on each side). */
bool dif_report_walls_between(const dif_report_job *job);
double dif_report_samples_per_period(const dif_report_job *job);

/* Parts of the result object: the fits, the maxima. NULL = out of memory. */
json_t *dif_report_fit_table_json(const dif_report_job *job, const dif_report_data *data);
json_t *dif_report_fit_surface_json(const dif_report_data *data);
json_t *dif_report_maxima_json(const dif_report_data *data);
json_t *dif_report_map_json(const dif_report_data *data);
json_t *dif_report_methods_json(const dif_report_data *data);
json_t *dif_report_study_json(const dif_report_job *job, const dif_report_data *data);
json_t *dif_report_published_json(const dif_report_job *job, const dif_report_data *data);

/* The surface's result object; timings are left out if SOURCE_DATE_EPOCH is set, because they differ from run to run.
 * *outside is set if a verdict failed. NULL = out of memory. */
json_t *dif_report_json(const dif_report_job *job, const dif_report_data *data, bool *outside);

/* Writes all files of one surface into the folder. Status DIF_ERR_IO, DIF_ERR_NOMEM, DIF_ERR_FOREIGN. */
DIF_MUST_USE dif_status dif_report_write(const char *folder, const dif_report_job *job, dif_report_data *data,
                                         bool *outside, dif_error *err);

/* Writes a JSON value atomically. */
DIF_MUST_USE dif_status dif_report_write_json(const char *folder, const char *name, const json_t *doc, dif_error *err);

#endif
