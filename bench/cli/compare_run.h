/* The verb compare: what a user asks for, and one run over all surfaces.
 * Does not: parse the command line, write the page. */
#ifndef DIF_COMPARE_RUN_H
#define DIF_COMPARE_RUN_H

#include "bench/cli/cli.h"
#include "bench/regress_run.h"
#include "bench/scan.h"

enum { DIF_COMPARE_ON_GPU, DIF_COMPARE_ON_CPU };
enum { DIF_COMPARE_PATHS_BOTH, DIF_COMPARE_PATHS_COMPUTE, DIF_COMPARE_PATHS_FRAGMENT };

typedef struct dif_compare_args {
    dif_cli_surface surface;
    const char *out, *rebuild, *thresholds, *baseline, *methods;
    bool print_thresholds, require_hardware, half, no_fit, no_pictures;
    int device, paths, fault; /* the enums above; dif_gpu_fault */
    double factor;
    double theta_i_deg, azimuth_deg, map_theta_deg; /* azimuth NaN = across the strongest structure */
    dif_range angle_deg, lambda_nm, layer_nm, colour_nm, full_nm;
    int n_pixel, n_azimuth, n_radius;
    double tol_device, tol_reference, sigma_um, period_nm, groove_deg, index_n, index_kappa; /* NaN = not said */
    int window, average, shadowing;
} dif_compare_args;

dif_compare_args dif_compare_args_default(void);

/* Which methods a list "sheet,lut" names (NULL = all): method[DIF_REGRESS_METHODS], or NULL to check alone. False with
 * the name that is none. */
bool dif_compare_methods_parse(const char *list, bool *method, char unknown[32]);

typedef struct dif_compare_verdict {
    int n, n_failed, n_worse;
    char first_failed[120];
} dif_compare_verdict;

/* Compares all surfaces and writes DIR/compare.json with its pictures. Status of what failed. */
DIF_MUST_USE dif_status dif_compare_measure(const dif_cli *cli, const dif_compare_args *args,
                                            dif_compare_verdict *verdict, dif_error *err);

#endif
