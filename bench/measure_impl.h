/* What table and query measurements share: clocks, windows, checks. Not installed. */
#ifndef DIF_MEASURE_IMPL_H
#define DIF_MEASURE_IMPL_H

#include "bench/measure.h"
#include "core/nmm.h"
#include "core/replica.h"
#include "core/sheet.h"
#include "core/stam.h"
#include "core/thesis.h"

/* Double rounding of a direct sum's phases (up to a few thousand radians). */
#define DIF_DIRECT_BOUND 1e-12

/* Wall and processor time, both in seconds. */
typedef struct dif_stopwatch {
    double wall_s, cpu_s;
} dif_stopwatch;

dif_stopwatch dif_stopwatch_start(void);

/* Adds the time since *since to the two sums and restarts. */
void dif_stopwatch_lap(dif_stopwatch *since, double *wall_s, double *cpu_s);

/* The windows of a measurement, and the share that each has in the average. */
typedef struct dif_window_set {
    int n;
    dif_window *window;
    double *share;   /* (sum W_s)^2 / sum_s (sum W_s)^2                                      */
    double area_um2; /* T^2 sum_s (sum W_s)^2 / sum_s sum W_s^2                              */
} dif_window_set;

DIF_MUST_USE dif_status dif_window_set_make(const dif_field *field, const dif_measure_opts *opts, dif_window_set *set,
                                            dif_error *err);
void dif_window_set_free(dif_window_set *set);

/* Field, tolerance and options. */
DIF_MUST_USE dif_status dif_measure_check_opts(const dif_field *field, double tol, const dif_measure_opts *opts,
                                               dif_error *err);

dif_sheet_opts dif_measure_sheet_opts(const dif_measure_opts *opts);

/* Records what a sheet reached. */
void dif_measure_note_sheet(dif_measure_stats *stats, const dif_sheet *sheet);

/* kappa = k (u, v, w) of a query. */
dif_vec3 dif_measure_kappa(const dif_query *query);

/* Sets the number of threads of this call; returns the number to restore. */
int dif_measure_threads(const dif_measure_opts *opts);

void dif_measure_progress(const dif_measure_opts *opts, double share);

/* pq: size of the period patch and its replicas. */
typedef struct dif_cell_layout {
    int nx, ny;              /* samples of the patch                                    */
    double first_x, first_y; /* of its first sample, in samples of the surface         */
    double step_x, step_y;   /* of its samples, in samples of the surface              */
    dif_replica replica;
} dif_cell_layout;

DIF_MUST_USE dif_status dif_cell_layout_make(const dif_field *field, const dif_measure_opts *opts, dif_cell_layout *out,
                                             dif_error *err);

/* True if windows and their average matter: sheet, taylor, direct, nmm. */
bool dif_method_has_windows(dif_method method);

/* Options of the methods beyond sheet, taylor and direct. */
DIF_MUST_USE dif_status dif_method_check_opts(const dif_field *field, const dif_measure_opts *opts, dif_error *err);

/* nmm of a measurement whose wavelengths lie in that range. */
dif_nmm dif_method_nmm(const dif_field *field, const dif_measure_opts *opts, double lambda_min_um,
                       double lambda_max_um);

/* Where a method will be asked: sums over all points at k = 1, and the wavelengths. */
typedef struct dif_reach {
    double s_max, c_min, c_max;        /* of |(u, v)| and -w                                */
    double u_min, u_max, v_min, v_max; /* of u and v                                        */
    double lambda_min_um, lambda_max_um;
    bool is_line; /* all points lie in the plane of this azimuth       */
    double azimuth_rad;
} dif_reach;

dif_reach dif_reach_empty(void);
void dif_reach_add(dif_reach *reach, dif_vec3 uvw, double lambda_um);
dif_reach dif_reach_of_plan(const dif_plan *plan);

/* One method, ready to be read for one window: any but direct. */
typedef struct dif_readout {
    dif_method method;
    bool is_line;
    double cos_azimuth, sin_azimuth;
    dif_sheet *sheet; /* sheet, taylor, nmm, pq */
    dif_field cell;   /* pq */
    dif_replica replica;
    dif_thesis *thesis;
    dif_stam stam;
    dif_nmm nmm;
} dif_readout;

DIF_MUST_USE dif_status dif_readout_open(const dif_field *field, const dif_window *window, const dif_measure_opts *opts,
                                         double tol, const dif_reach *reach, dif_readout *out, dif_measure_stats *stats,
                                         dif_error *err);
void dif_readout_close(dif_readout *reader);

/* Amplitudes at n <= DIF_READ_MAX points (u, v, w), each at its own wavelength, P / sum W (stam: its size alone). nmm is
 * read at the wavelengths asked for if `as_asked`, else at those that stand for them. Allocates nothing. */
enum { DIF_READ_MAX = 256 };
void dif_readout_read(const dif_readout *reader, int n, const dif_vec3 *uvw, const double *lambda_um, bool as_asked,
                      double (*amp)[2]);

/* XYZ of one direction by nmm, added with a share: sum over its wavelengths of weight, power and, for the BRDF
 * (per_lambda2), 1/lambda^2. lambda_um and weight have room for dif_nmm_count_max. */
void dif_readout_add_nmm(const dif_readout *reader, const double scale[3], dif_vec3 uvw, bool per_lambda2, double share,
                         double *lambda_um, double (*weight)[3], double xyz[3]);

/* The powers of a table by such a method, added up over the windows. */
DIF_MUST_USE dif_status dif_table_by_method(const dif_field *field, const dif_plan *plan, double tol,
                                            const dif_measure_opts *opts, const dif_window_set *set, double *value,
                                            dif_measure_stats *stats, dif_error *err);

/* S of a quantity at (wi, wo): 1 for the power. */
double dif_measure_shadowing(const dif_measure_opts *opts, dif_quantity quantity, dif_vec3 wi, dif_vec3 wo);

/* From powers to the wanted quantity at (wi, wo), without the 1/lambda^2 of the BRDF. */
double dif_method_gain(const dif_measure_opts *opts, dif_quantity quantity, dif_vec3 wi, dif_vec3 wo, double area_um2);

#endif
