/* The interpolation kernel: exponential of semicircle phi(z) = exp(beta (sqrt(1 - z^2) - 1)), |z| <= 1.
 * Its width follows from a tolerance; its error bound is computed, not assumed.
 * Source: Barnett, Magland, af Klinteberg 2019.
 * Does not: touch data. */
#ifndef DIF_KERNEL_H
#define DIF_KERNEL_H

enum { DIF_KERNEL_WIDTH_MAX = 16, DIF_KERNEL_DEGREE_MAX = 24 };

typedef struct dif_kernel {
    int width;     /* taps w, 2 ... DIF_KERNEL_WIDTH_MAX                                             */
    double sigma;  /* oversampling, > 1                                                              */
    double beta;   /* shape                                                                          */
    double bound;  /* rigorous sup of the relative interpolation error on one axis                   */
    int degree;    /* of the piecewise polynomials                                                   */
    double coef[DIF_KERNEL_DEGREE_MAX + 1][DIF_KERNEL_WIDTH_MAX]; /* power n of t in [-1/2, 1/2], tap i       */
} dif_kernel;

/* The narrowest kernel whose bound is <= tol at oversampling sigma, or the best one if none reaches it. */
dif_kernel dif_kernel_make(double tol, double sigma);

/* Fourier transform int_{-w/2}^{w/2} phi(2 t / w) exp(i xi t) dt at xi rad per sample; even, real. */
double dif_kernel_transform(const dif_kernel *kernel, double xi);

/* Weights of the w taps for a point at fractional offset t in [-1/2, 1/2] from the centre of the tap row. */
void dif_kernel_taps(const dif_kernel *kernel, double t, double *weight);

#endif
