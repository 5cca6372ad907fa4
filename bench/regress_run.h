/* One surface read by every method on two devices, and what differs: the regression of an evaluator against the
 * reference.
 * Does not: open devices or files; judge (bench/regress_limits.h). */
#ifndef DIF_REGRESS_RUN_H
#define DIF_REGRESS_RUN_H

#include "bench/fit.h"
#include "bench/measure.h"
#include "bench/regress.h"
#include "core/evaluator.h"
#include "core/lut.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum dif_regress_question {
    DIF_REGRESS_TABLE,  /* an in-plane table of the power                                            */
    DIF_REGRESS_MAP,    /* the power in every reflected direction at a few wavelengths               */
    DIF_REGRESS_COLOUR, /* XYZ of rho in every reflected direction                                   */
    DIF_REGRESS_FULL    /* lut alone: its colours against the reference's full spectral sampling     */
} dif_regress_question;

/* "table", "map", "colour", "full". */
const char *dif_regress_question_name(dif_regress_question question);

enum { DIF_REGRESS_METHODS = 6 };

/* "sheet", "nmm", "nmm-lines", "pq", "lut", "stam": 0 ... DIF_REGRESS_METHODS - 1. */
const char *dif_regress_method_name(int method);

/* The device under test. */
typedef struct dif_regress_device {
    void *self;
    int n_path;              /* ways of answering, >= 1         */
    const char *const *path; /* path[n_path]: their names       */
    dif_status (*open)(void *self, int path, const dif_model *model, dif_evaluator *out, dif_error *err);
} dif_regress_device;

/* What is asked. Arrays and structs are borrowed. */
typedef struct dif_regress_plan {
    const dif_plan *table;
    dif_vec3 wi;             /* of maps and colours                                                     */
    int n_pixel;             /* across, as bench/map.h                                                  */
    int n_layer;             /* wavelengths of maps                                                     */
    const double *layer_um;  /* layer_um[n_layer], ascending                                            */
    int n_lambda;            /* wavelengths of colours                                                  */
    const double *lambda_um; /* lambda_um[n_lambda], ascending                                          */
    int n_full;              /* wavelengths of the lut and of full sampling                             */
    const double *full_um;   /* full_um[n_full], ascending                                              */
    dif_lut_opts lut;
    double tol_lut;
    double tol_device, tol_reference;  /* of the sheets that each side reads                                  */
    double floor_share;                /* of relative errors                                                  */
    double peak_floor_share;           /* of maxima                                                           */
    bool method[DIF_REGRESS_METHODS];  /* which of them                                                       */
    bool has_period;                   /* pq and nmm-lines make sense                                         */
    bool is_grating;                   /* all ridges are orders of one period                                 */
    bool full;                         /* lut: also against full sampling                                    */
    bool fit;                          /* fit the period to both sides' sheet tables                          */
    double f_min_per_um, f_max_per_um; /* of |f|: what is fitted                                              */
} dif_regress_plan;

/* Defaults of what has any: 97 pixels, floor 1e-5, peaks 0.01, device 1e-7, reference 1e-9, table 1e-5, all methods, full sampling,
 * fit. */
dif_regress_plan dif_regress_plan_default(void);

/* Periods from either side's table. */
typedef struct dif_regress_fit {
    bool tried;                     /* the other members count                      */
    dif_status device, reference;   /* DIF_OK, or why there is none                 */
    double device_um, reference_um; /* NaN without one                              */
    double device_sd_um, reference_sd_um;
    char text[240]; /* of the first failure, else empty */
} dif_regress_fit;

/* One comparison. */
typedef struct dif_regress_case {
    dif_regress_question question;
    int method;
    const char *path;
    dif_status status; /* DIF_OK, or why there is nothing: the rest is zero then */
    char text[240];
    dif_regress values; /* colours: of X, Y and Z                     */
    bool has_colours;
    dif_regress_stat de;
    double exposure; /* of de                                       */
    bool has_peaks;
    dif_regress_peaks peaks;
    dif_regress_fit fit;
    double bound_device, bound_reference;     /* of the amplitudes, NaN: none          */
    double build_device_s, build_reference_s; /* models, wall                          */
    double first_device_s;                    /* wall of the first call, shaders made  */
    double wall_device_s, wall_reference_s;   /* of the second call; of the only one   */
    dif_eval_cost device;                     /* of the second call                    */
    size_t n_sample;                          /* numbers asked for: cells, queries, directions */
} dif_regress_case;

/* Where a number lies: its place in the arrays that a listener gets. */
typedef struct dif_regress_place {
    double lambda_um; /* NaN: colours            */
    double angle_rad; /* tables, else NaN        */
    dif_vec3 wo;      /* maps and colours        */
    int ix, iy;       /* their pixel             */
    int channel;      /* colours: 0 ... 2 X, Y, Z */
} dif_regress_place;

/* Hears of each case when it is done.
 *
 * `device` and `reference` (NULL if case's status is not DIF_OK) hold  table: [n_lambda][n_angle];  map:
 * [n_layer][n_pixel^2];  colours: [n_pixel^2][3];  NaN outside the disc. A status other than DIF_OK ends the run. */
typedef struct dif_regress_listener {
    void *self;
    void (*begins)(void *self, const char *method, const char *what); /* may be NULL */
    dif_status (*done)(void *self, const dif_regress_plan *plan, const dif_regress_case *result, const double *device,
                       const double *reference, dif_error *err);
} dif_regress_listener;

/* Runs all methods that the plan names, every question, every path of the device.
 *
 * Given     opts  windows, period and index of the surface; its method and quantity are set here
 * Status    DIF_ERR_NOMEM, what the reference fails with, what the listener returns. A device that fails is its case's
 *           status. */
DIF_MUST_USE dif_status dif_regress_run(const dif_field *field, const dif_regress_plan *plan,
                                        const dif_measure_opts *opts, const dif_regress_device *device,
                                        const dif_regress_listener *listener, dif_error *err);

/* The place of number `at` of a case's arrays. */
dif_regress_place dif_regress_place_of(const dif_regress_plan *plan, dif_regress_question question, size_t at);

#ifdef __cplusplus
}
#endif
#endif
