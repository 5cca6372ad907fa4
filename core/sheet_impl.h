/* Inside the sheet transform: shared by sheet*.c (which build) and response.c (which reads). Not installed. */
#ifndef DIF_SHEET_IMPL_H
#define DIF_SHEET_IMPL_H

#include "core/kernel.h"
#include "core/sheet.h"

enum {
    DIF_SHEET_BLOCK = 64,       /* pixels that one pass of the plane factors takes    */
    DIF_SHEET_PLANE_BLOCK = 16, /* planes between fresh sines: bounds the recurrence  */
    DIF_SHEET_TAPS = 16,        /* room for the taps of one axis                      */
    DIF_SHEET_PAD = 16          /* planes a tap row may read beyond the last one      */
};

/* One interpolated axis: bins at index * step, indices first ... first + n - 1 stored. */
typedef struct dif_axis {
    dif_kernel kernel;
    double step;     /* rad/um between bins                                                        */
    int first, n;    /* stored bins                                                                */
    int period;      /* bins after which the transform repeats and a point is folded; 0 = never    */
    double shift_um; /* true position minus the whole-pitch one that the DFT used                  */
} dif_axis;

struct dif_sheet {
    dif_sheet_info info;
    dif_basis basis;
    bool is_line;
    dif_axis s, y, z; /* lateral (line: along the azimuth; volume: x), volume's y, planes                */
    double mid_um;    /* height that the planes refer to                                                 */
    double half_um;   /* half-range of the heights about it                                              */
    int stride;       /* complex numbers per bin: planes and the padding that tap rows need              */
    void *planes;     /* [bin s][bin y][stride] complex, plane innermost, / sum W; float or double       */
    float *coef_f;    /* [degree + 1][3 * DIF_SHEET_TAPS]: the axes' tap polynomials side by side        */
    double *coef_d;   /* the same in double; the one that is not used is NULL                            */
    int degree;       /* the highest of the axes' degrees                                                */
};

/* What a pixel contributes to the planes: W exp(-i W_l (h - mid)) gain(h), or W ((h - mid)/half)^l. */
typedef struct dif_plane_factors {
    dif_basis basis;
    double mid_um, half_um;
    int first;                  /* index of plane 0: W_0 = first * step                      */
    double step;                /* rad/um between planes                                     */
    dif_reciprocal height_gain; /* 1/phi^ over the heights                                   */
} dif_plane_factors;

/* Adds the factors of n <= DIF_SHEET_BLOCK pixels, weight[j] * weight_row each, to planes plane0 ... plane0 + n_plane-1
 * (at most DIF_SHEET_PLANE_BLOCK): acc[n_plane][2][DIF_SHEET_BLOCK], real and imaginary parts. */
void dif_plane_factors_add(const dif_plane_factors *factors, int n, const double *z_um, const double *weight,
                           double weight_row, int plane0, int n_plane, double *acc);

/* Checks, kernels, plane range and heights: what the builders share. `n_lateral` lateral kernels share half the tolerance. */
dif_status dif_sheet_begin(const dif_field *field, const dif_window *window, const dif_band *band, double tol,
                           const dif_sheet_opts *opts, int n_lateral, double sigma_lateral, dif_sheet **out,
                           dif_error *err);

/* The plane factors of a sheet; *n_plane is how many planes must be computed: negative ones mirror positive ones. */
dif_plane_factors dif_sheet_factors(const dif_sheet *sheet, int *n_plane);

/* Lays out an axis of n samples of the given pitch for |kappa| <= k_max; returns the DFT size, or 0 if too large. */
int dif_axis_layout(dif_axis *axis, int n, double pitch_um, double k_max);

/* Divides weight[n] by phi^ at the DFT's whole-pitch positions; mirrored: weight i belongs to sample n - 1 - i. */
void dif_axis_correct(const dif_axis *axis, int n, double pitch_um, bool mirrored, double *weight);

/* Window weights over sum W, wx[nx] and wy[ny], which the caller releases; records the sums in the sheet. */
dif_status dif_sheet_window(dif_sheet *sheet, const dif_field *field, const dif_window *window, double **wx,
                            double **wy, dif_error *err);

/* Allocates planes and tap polynomials once the axes are laid out. */
dif_status dif_sheet_allocate(dif_sheet *sheet, dif_error *err);

/* Rounding of one evaluation, as a share of sum W: measured 1e-7 (float) and 2e-15 (double) and doubled. */
double dif_sheet_rounding(bool single);

/* A bin's place in a DFT of size n. */
static inline int dif_bin_wrap(int bin, int n)
{
    const int r = bin % n;
    return r < 0 ? r + n : r;
}

/* Stores one complex number of the planes. */
static inline void dif_sheet_store(dif_sheet *sheet, size_t at, double re, double im)
{
    if (sheet->info.single) {
        ((float *)sheet->planes)[2 * at] = (float)re;
        ((float *)sheet->planes)[2 * at + 1] = (float)im;
    } else {
        ((double *)sheet->planes)[2 * at] = re;
        ((double *)sheet->planes)[2 * at + 1] = im;
    }
}

#endif
