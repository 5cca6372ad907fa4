/* The interpolation kernel: exponential of semicircle phi(z) = exp(beta (sqrt(1 - z^2) - 1)), |z| <= 1.
 * Its width follows from a tolerance; its error is measured on the kernel as it is evaluated, not assumed.
 * Source: Barnett, Magland, af Klinteberg 2019.
 * Does not: touch data. */
#ifndef DIF_KERNEL_H
#define DIF_KERNEL_H

#ifdef __cplusplus
extern "C" {
#endif

enum {
    DIF_KERNEL_WIDTH_MAX = 16,
    DIF_KERNEL_DEGREE_MAX = 22,
    DIF_KERNEL_NODES = 40, /* quadrature nodes of the transform */
    DIF_KERNEL_RECIPROCAL_MAX = 24
};

typedef struct dif_kernel {
    int width;    /* taps w, 2 ... DIF_KERNEL_WIDTH_MAX                                             */
    double sigma; /* oversampling, > 1                                                              */
    double beta;  /* shape                                                                          */
    double bound; /* sup over offsets and positions of the relative interpolation error on one axis */
    int degree;   /* of the piecewise polynomials                                                   */
    double coef[DIF_KERNEL_DEGREE_MAX + 1][DIF_KERNEL_WIDTH_MAX]; /* power n of t in [-1/2, 1/2], tap i */
    double node[DIF_KERNEL_NODES], node_weight[DIF_KERNEL_NODES]; /* of the transform, t >= 0           */
} dif_kernel;

/* The narrowest kernel whose bound is <= tol at oversampling sigma (1.2 ... 4), or the best one if none reaches it. */
dif_kernel dif_kernel_make(double tol, double sigma);

/* Fourier transform int_{-w/2}^{w/2} phi(2 t / w) exp(i xi t) dt at xi rad per sample; even, real. */
double dif_kernel_transform(const dif_kernel *kernel, double xi);

/* Weights of the w taps for a point at offset t in [-1/2, 1/2] from the centre of the tap row: tap i lies at distance
 * t + (w - 1)/2 - i. */
void dif_kernel_taps(const dif_kernel *kernel, double t, double *weight);

/* 1/phi^(xi) for |xi| <= pi/sigma as a polynomial in xi^2, for per-pixel use. */
typedef struct dif_reciprocal {
    int degree;
    double coef[DIF_KERNEL_RECIPROCAL_MAX + 1]; /* power n of (xi sigma/pi)^2 - 1/2 */
} dif_reciprocal;

/* Accurate to a fiftieth of the kernel's bound (as far as doubles go). */
dif_reciprocal dif_kernel_reciprocal(const dif_kernel *kernel);
double dif_reciprocal_at(const dif_reciprocal *reciprocal, double share); /* share = xi sigma/pi in [-1, 1] */

#ifdef __cplusplus
}
#endif
#endif
