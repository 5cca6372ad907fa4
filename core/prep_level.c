/* Polynomials in x and y, fitted to the heights that are there by normal equations in Legendre products. */
#include <stdbool.h>
#include <string.h>

#include "core/alloc.h"
#include "core/prep_impl.h"

enum { DEGREES = DIF_LEVEL_DEGREE_MAX + 1, TERMS_MAX = DEGREES * (DEGREES + 1) / 2 };

/* A degree more must take this share of the variance that is left (DIF_LEVEL_AUTO_MAX is the last). */
static const double AUTO_SHARE = 0.05;

typedef struct poly {
    int degree, n_term;
    int a[TERMS_MAX], b[TERMS_MAX];      /* degrees in x and y of each term  */
    double *px, *py;                     /* P_a(x) [nx][DEGREES], P_b(y) [ny][DEGREES] */
    double matrix[TERMS_MAX][TERMS_MAX]; /* lower triangle                   */
    double rhs[TERMS_MAX], coefficient[TERMS_MAX];
} poly;

/* Legendre polynomials of n places from -1 to 1. */
static void legendre(int n, int degree, double sense, double *p)
{
    for (int i = 0; i < n; i++) {
        const double x = n > 1 ? sense * (2.0 * i - (n - 1)) / (n - 1) : 0.0;
        double *row = p + (size_t)i * DEGREES;
        row[0] = 1.0;
        row[1] = x;
        for (int k = 2; k <= degree; k++)
            row[k] = ((2 * k - 1) * x * row[k - 1] - (k - 1) * row[k - 2]) / k;
    }
}

static dif_status poly_make(const dif_field *field, int degree, poly *p, dif_error *err)
{
    *p = (poly){.degree = degree};
    p->px = dif_alloc((size_t)field->nx * DEGREES, sizeof *p->px);
    p->py = dif_alloc((size_t)field->ny * DEGREES, sizeof *p->py);
    if (!p->px || !p->py)
        return dif_fail(err, DIF_ERR_NOMEM, "polynomials of %d x %d places", field->nx, field->ny);
    for (int total = 0; total <= degree; total++)
        for (int b = 0; b <= total; b++) {
            p->a[p->n_term] = total - b;
            p->b[p->n_term++] = b;
        }
    legendre(field->nx, degree, 1.0, p->px);
    legendre(field->ny, degree, -1.0, p->py); /* y is up, rows go down */
    return DIF_OK;
}

static void poly_free(poly *p)
{
    dif_release(p->px);
    dif_release(p->py);
}

/* Adds one row of heights to the normal equations: sums along x first, then the products with the row's P_b(y). */
static void add_row(poly *p, int nx, const double *z, const double *py)
{
    double square[DEGREES][DEGREES] = {{0.0}}, with_z[DEGREES] = {0.0};
    for (int ix = 0; ix < nx; ix++) {
        if (!isfinite(z[ix]))
            continue;
        const double *px = p->px + (size_t)ix * DEGREES;
        for (int a = 0; a <= p->degree; a++) {
            with_z[a] += px[a] * z[ix];
            for (int c = 0; c <= a; c++)
                square[a][c] += px[a] * px[c];
        }
    }
    for (int i = 0; i < p->n_term; i++) {
        p->rhs[i] += with_z[p->a[i]] * py[p->b[i]];
        for (int j = 0; j <= i; j++) {
            const int a = p->a[i], c = p->a[j];
            p->matrix[i][j] += (a >= c ? square[a][c] : square[c][a]) * py[p->b[i]] * py[p->b[j]];
        }
    }
}

/* Cholesky; a term whose pivot is lost to rounding is not determined and gets 0. */
static void solve(poly *p)
{
    const int n = p->n_term;
    bool used[TERMS_MAX] = {false};
    for (int i = 0; i < n; i++) {
        const double own = p->matrix[i][i];
        for (int j = 0; j <= i; j++) {
            double sum = p->matrix[i][j];
            for (int k = 0; k < j; k++)
                sum -= p->matrix[i][k] * p->matrix[j][k];
            if (j < i) {
                p->matrix[i][j] = used[j] ? sum / p->matrix[j][j] : 0.0;
            } else {
                used[i] = own > 0.0 && sum > 1e-11 * own;
                p->matrix[i][i] = used[i] ? sqrt(sum) : 1.0;
            }
        }
        double sum = p->rhs[i];
        for (int k = 0; k < i; k++)
            sum -= p->matrix[i][k] * p->coefficient[k];
        p->coefficient[i] = used[i] ? sum / p->matrix[i][i] : 0.0;
    }
    for (int i = n - 1; i >= 0; i--) {
        double sum = p->coefficient[i];
        for (int k = i + 1; k < n; k++)
            sum -= p->matrix[k][i] * p->coefficient[k];
        p->coefficient[i] = used[i] ? sum / p->matrix[i][i] : 0.0;
    }
}

static void fit(poly *p, const dif_field *field)
{
    memset(p->matrix, 0, sizeof p->matrix);
    memset(p->rhs, 0, sizeof p->rhs);
    for (int iy = 0; iy < field->ny; iy++)
        add_row(p, field->nx, field->z_um + (size_t)iy * (size_t)field->nx, p->py + (size_t)iy * DEGREES);
    solve(p);
}

static void subtract(const poly *p, dif_field *field)
{
    for (int iy = 0; iy < field->ny; iy++) {
        const double *py = p->py + (size_t)iy * DEGREES;
        double *z = field->z_um + (size_t)iy * (size_t)field->nx, along[DEGREES] = {0.0};
        for (int i = 0; i < p->n_term; i++)
            along[p->a[i]] += p->coefficient[i] * py[p->b[i]];
        for (int ix = 0; ix < field->nx; ix++) {
            const double *px = p->px + (size_t)ix * DEGREES;
            double value = 0.0;
            for (int a = 0; a <= p->degree; a++)
                value += along[a] * px[a];
            z[ix] -= value;
        }
    }
}

static dif_status check(const dif_field *field, dif_error *err)
{
    const dif_status status = dif_prep_check(field, err);
    if (!status && dif_prep_state_of(field).n_missing == dif_field_n(field))
        return dif_fail(err, DIF_ERR_NONFINITE, "all %zu heights are missing", dif_field_n(field));
    return status;
}

dif_status dif_prep_level(dif_field *field, int degree, dif_error *err)
{
    poly p;
    dif_status status = check(field, err);
    if (status)
        return status;
    if (!(degree >= 0 && degree <= DIF_LEVEL_DEGREE_MAX))
        return dif_fail(err, DIF_ERR_ARG, "polynomial of degree %d, want 0 to %d", degree, DIF_LEVEL_DEGREE_MAX);
    status = poly_make(field, degree, &p, err);
    for (int round = 0; round < 2 && !status; round++) { /* the second takes what rounding left */
        fit(&p, field);
        subtract(&p, field);
    }
    poly_free(&p);
    return status;
}

dif_status dif_prep_level_auto(dif_field *field, int *degree, dif_error *err)
{
    dif_field trial = {0};
    *degree = 0;
    dif_status status = dif_prep_level(field, 1, err);
    if (!status)
        status = dif_field_create(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um, &trial, err);
    if (status)
        return status;
    *degree = 1;
    double left = pow(dif_prep_state_of(field).rms_um, 2.0);
    while (*degree < DIF_LEVEL_AUTO_MAX && !status) {
        memcpy(trial.z_um, field->z_um, dif_field_n(field) * sizeof *trial.z_um);
        status = dif_prep_level(&trial, *degree + 1, err);
        const double next = pow(dif_prep_state_of(&trial).rms_um, 2.0);
        if (status || !(left - next > AUTO_SHARE * left))
            break;
        memcpy(field->z_um, trial.z_um, dif_field_n(field) * sizeof *trial.z_um);
        left = next;
        ++*degree;
    }
    dif_field_free(&trial);
    return status;
}

/* Variance of a plane over the heights that are there; its mean is near 0, so that one pass will do. */
static double plane_variance(const dif_field *field, const dif_prep_tilt *tilt)
{
    double n = 0.0, sum = 0.0, sum2 = 0.0;
    for (int iy = 0; iy < field->ny; iy++)
        for (int ix = 0; ix < field->nx; ix++) {
            if (!isfinite(field->z_um[(size_t)iy * (size_t)field->nx + (size_t)ix]))
                continue;
            const double plane = tilt->slope_x * dif_field_x_um(field, ix) + tilt->slope_y * dif_field_y_um(field, iy);
            n += 1.0;
            sum += plane;
            sum2 += plane * plane;
        }
    return fmax(sum2 / n - (sum / n) * (sum / n), 0.0);
}

dif_status dif_prep_tilt_of(const dif_field *field, dif_prep_tilt *out, dif_error *err)
{
    poly p;
    *out = (dif_prep_tilt){0};
    dif_status status = check(field, err);
    if (status)
        return status;
    status = poly_make(field, 1, &p, err);
    if (!status) {
        fit(&p, field);
        /* terms 1 and 2 are x and y from -1 to 1 */
        const double half_x_um = 0.5 * (field->nx - 1) * field->pitch_x_um;
        const double half_y_um = 0.5 * (field->ny - 1) * field->pitch_y_um;
        const double rms_um = dif_prep_state_of(field).rms_um;
        out->slope_x = half_x_um > 0.0 ? p.coefficient[1] / half_x_um : 0.0;
        out->slope_y = half_y_um > 0.0 ? p.coefficient[2] / half_y_um : 0.0;
        out->share = rms_um > 0.0 ? fmin(plane_variance(field, out) / (rms_um * rms_um), 1.0) : 0.0;
    }
    poly_free(&p);
    return status;
}
