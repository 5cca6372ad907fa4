#include "core/kernel.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "core/units.h"

enum { OFFSETS = 16, POSITIONS = 80, CHEB_MAX = 32 };

static double semicircle(double beta, double z)
{
    const double inside = 1.0 - z * z;
    return inside > 0.0 ? exp(beta * (sqrt(inside) - 1.0)) : (inside == 0.0 ? exp(-beta) : 0.0);
}

/* Legendre polynomial P_n(x) and its derivative, by the three-term recurrence. */
static double legendre(int n, double x, double *slope)
{
    double before = 1.0, here = x;
    for (int k = 2; k <= n; k++) {
        const double next = ((2 * k - 1) * x * here - (k - 1) * before) / k;
        before = here;
        here = next;
    }
    *slope = n * (x * here - before) / (x * x - 1.0);
    return here;
}

/* Gauss-Legendre nodes on [0, w/2] with the kernel folded into the weights (twice: the kernel is even). */
static void make_nodes(dif_kernel *kernel)
{
    const int n = DIF_KERNEL_NODES;
    for (int i = 0; i < n; i++) {
        double x = cos(DIF_PI * (i + 0.75) / (n + 0.5)), slope = 1.0;
        for (int round = 0; round < 50; round++) {
            const double step = legendre(n, x, &slope) / slope;
            x -= step;
            if (fabs(step) < 1e-16)
                break;
        }
        const double weight = 2.0 / ((1.0 - x * x) * slope * slope);
        const double z = 0.5 * (1.0 + x); /* in [0, 1] */
        kernel->node[i] = 0.5 * kernel->width * z;
        kernel->node_weight[i] = 0.5 * kernel->width * weight * semicircle(kernel->beta, z);
    }
}

double dif_kernel_transform(const dif_kernel *kernel, double xi)
{
    double sum = 0.0;
    for (int i = 0; i < DIF_KERNEL_NODES; i++)
        sum += kernel->node_weight[i] * cos(xi * kernel->node[i]);
    return sum;
}

/* Monomial coefficients on x in [-1/2, 1/2] of the polynomial through values at n Chebyshev points. */
static void monomials_from_values(int n, const double *value, double *coef)
{
    double cheb[CHEB_MAX], power[CHEB_MAX] = {0}, before[CHEB_MAX] = {0}, here[CHEB_MAX] = {0};
    for (int k = 0; k < n; k++) {
        cheb[k] = 0.0;
        for (int j = 0; j < n; j++)
            cheb[k] += value[j] * cos(DIF_PI * k * (j + 0.5) / n) * (k == 0 ? 1.0 : 2.0) / n;
    }
    before[0] = 1.0; /* T_0 */
    here[1] = 2.0;   /* T_1(2 x) = 2 x */
    for (int k = 0; k < n; k++) {
        const double *now = k == 0 ? before : here;
        for (int i = 0; i <= k; i++)
            power[i] += cheb[k] * now[i];
        if (k == 0)
            continue;
        double next[CHEB_MAX] = {0};
        for (int i = 0; i <= k; i++) {
            if (i + 1 < CHEB_MAX)
                next[i + 1] += 4.0 * here[i];
            next[i] -= before[i];
        }
        memcpy(before, here, sizeof before);
        memcpy(here, next, sizeof here);
    }
    memcpy(coef, power, (size_t)n * sizeof *coef);
}

static double chebyshev_point(int n, int j)
{
    return 0.5 * cos(DIF_PI * (j + 0.5) / n);
}

static void make_polynomials(dif_kernel *kernel, int degree)
{
    const int w = kernel->width, n = degree + 1;
    kernel->degree = degree;
    for (int tap = 0; tap < w; tap++) {
        double value[CHEB_MAX] = {0}, coef[CHEB_MAX];
        for (int j = 0; j < n; j++)
            value[j] = semicircle(kernel->beta, 2.0 / w * (chebyshev_point(n, j) + 0.5 * (w - 1) - tap));
        monomials_from_values(n, value, coef);
        for (int k = 0; k < n; k++)
            kernel->coef[k][tap] = coef[k];
    }
}

void dif_kernel_taps(const dif_kernel *kernel, double t, double *weight)
{
    for (int tap = 0; tap < kernel->width; tap++) {
        double sum = kernel->coef[kernel->degree][tap];
        for (int k = kernel->degree - 1; k >= 0; k--)
            sum = sum * t + kernel->coef[k][tap];
        weight[tap] = sum;
    }
}

/* |sum_i phi(d_i) exp(i xi d_i) / phi^(xi) - 1|: what interpolation makes of exp(i xi x), over the true value. */
static double error_at(const dif_kernel *kernel, const double *tap, double t, double xi, double gain)
{
    const double start = xi * (t + 0.5 * (kernel->width - 1)), c = cos(xi), s = sin(xi);
    double turn_re = cos(start), turn_im = sin(start), re = 0.0, im = 0.0;
    for (int i = 0; i < kernel->width; i++) {
        re += tap[i] * turn_re;
        im += tap[i] * turn_im;
        const double next = turn_re * c + turn_im * s;
        turn_im = turn_im * c - turn_re * s;
        turn_re = next;
    }
    return hypot(re * gain - 1.0, im * gain);
}

/* The largest error over offsets |t| <= 1/2 and positions |xi| <= pi/sigma; opposite signs give conjugates. The 5 %
 * cover what lies between the points. */
static double measure_bound(const dif_kernel *kernel)
{
    double worst = 0.0, taps[OFFSETS + 1][DIF_KERNEL_WIDTH_MAX];
    for (int i = 0; i <= OFFSETS; i++)
        dif_kernel_taps(kernel, 0.5 * i / OFFSETS, taps[i]);
    for (int j = 0; j <= POSITIONS; j++) {
        const double xi = DIF_PI / kernel->sigma * j / POSITIONS;
        const double gain = 1.0 / dif_kernel_transform(kernel, xi);
        for (int i = 0; i <= OFFSETS; i++)
            worst = fmax(worst, error_at(kernel, taps[i], 0.5 * i / OFFSETS, xi, gain));
    }
    return 1.05 * worst;
}

static dif_kernel make_width(int width, double sigma)
{
    dif_kernel kernel = {.width = width, .sigma = sigma, .beta = 0.98 * DIF_PI * width * (1.0 - 0.5 / sigma)};
    make_nodes(&kernel);
    int degree = width + 2;
    make_polynomials(&kernel, degree);
    kernel.bound = measure_bound(&kernel);
    /* Raise the degree while that helps: then the width, not the polynomial, limits the error. */
    while (degree < DIF_KERNEL_DEGREE_MAX) {
        dif_kernel finer = kernel;
        make_polynomials(&finer, ++degree);
        finer.bound = measure_bound(&finer);
        if (!(finer.bound < 0.8 * kernel.bound))
            break;
        kernel = finer;
    }
    return kernel;
}

dif_kernel dif_kernel_make(double tol, double sigma)
{
    /* Start one tap below the asymptotic rate exp(-pi w sqrt(1 - 1/sigma)). */
    int width = (int)ceil(log(1.0 / tol) / (DIF_PI * sqrt(1.0 - 1.0 / sigma)));
    if (width < 2)
        width = 2;
    dif_kernel best = {.bound = DBL_MAX};
    for (; width <= DIF_KERNEL_WIDTH_MAX; width++) {
        const dif_kernel kernel = make_width(width, sigma);
        if (kernel.bound < best.bound)
            best = kernel;
        if (best.bound <= tol)
            break;
    }
    if (best.bound == DBL_MAX)
        best = make_width(DIF_KERNEL_WIDTH_MAX, sigma);
    return best;
}

dif_reciprocal dif_kernel_reciprocal(const dif_kernel *kernel)
{
    dif_reciprocal reciprocal = {0};
    for (int degree = 6;; degree += 2) {
        const int n = degree + 1;
        double value[CHEB_MAX] = {0};
        for (int j = 0; j < n; j++)
            value[j] = 1.0 / dif_kernel_transform(kernel, DIF_PI / kernel->sigma * sqrt(0.5 + chebyshev_point(n, j)));
        reciprocal.degree = degree;
        monomials_from_values(n, value, reciprocal.coef);
        double worst = 0.0;
        for (int j = 0; j <= POSITIONS; j++) {
            const double share = (double)j / POSITIONS;
            const double want = dif_kernel_transform(kernel, DIF_PI / kernel->sigma * share);
            worst = fmax(worst, fabs(dif_reciprocal_at(&reciprocal, share) * want - 1.0));
        }
        if (worst < 0.02 * kernel->bound || degree + 2 > DIF_KERNEL_RECIPROCAL_MAX)
            return reciprocal;
    }
}

double dif_reciprocal_at(const dif_reciprocal *reciprocal, double share)
{
    const double x = share * share - 0.5;
    double sum = reciprocal->coef[reciprocal->degree];
    for (int k = reciprocal->degree - 1; k >= 0; k--)
        sum = sum * x + reciprocal->coef[k];
    return sum;
}
