/* Filling of missing points: the heights of least bending (or least slope) with the others held.
 *
 *   plate    sum (wx Dxx z)^2 + 2 wx wy (Dxy z)^2 + (wy Dyy z)^2     differences of neighbours, w the inverse squared
 *   laplace  sum wx (Dx z)^2 + wy (Dy z)^2                           pitches; only those that lie inside the field
 *
 * Both are quadratic, so conjugate gradients solve them; the start is the same problem on a grid of half the samples.
 * Heights of a scan are doubles here and stay doubles: an image library's inpainting would round them to floats
 * or integers. */
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "core/alloc.h"
#include "core/prep_impl.h"

enum { SIDE_COARSEST = 8, ITERATIONS_MIN = 200, ITERATIONS_MAX = 5000 };
static const double WORK_MAX = 5e7;         /* iterations times points, some seconds */
static const double RESIDUAL_WANTED = 1e-9; /* relative to that of a constant filling */

typedef struct hole {
    int nx, ny;
    double wx, wy;
    dif_prep_fill_method method;
    size_t n;
    size_t *at; /* places of the unknowns, rising */
} hole;

/* Derivative of the energy (halved) at one place of v, and its own coefficient, the diagonal. */
static double plate_pull(const hole *h, const double *v, size_t at, double *diagonal)
{
    const int nx = h->nx, ny = h->ny, ix = (int)(at % (size_t)nx), iy = (int)(at / (size_t)nx);
    const ptrdiff_t row = nx;
    const double *p = v + at;
    double sum = 0.0, own = 0.0;
    for (int k = -1; k <= 1; k++) { /* second differences centred on the neighbours and on the place itself */
        const double c = k == 0 ? -2.0 : 1.0;
        if (ix + k >= 1 && ix + k < nx - 1) {
            sum += h->wx * h->wx * c * (p[k - 1] - 2.0 * p[k] + p[k + 1]);
            own += h->wx * h->wx * c * c;
        }
        if (iy + k >= 1 && iy + k < ny - 1) {
            sum += h->wy * h->wy * c * (p[(k - 1) * row] - 2.0 * p[k * row] + p[(k + 1) * row]);
            own += h->wy * h->wy * c * c;
        }
    }
    for (int dy = -1; dy <= 0; dy++)
        for (int dx = -1; dx <= 0; dx++) { /* mixed differences of the four cells around it */
            if (ix + dx < 0 || ix + dx + 1 >= nx || iy + dy < 0 || iy + dy + 1 >= ny)
                continue;
            const double *cell = p + dy * row + dx;
            const double mixed = cell[0] - cell[1] - cell[row] + cell[row + 1];
            sum += 2.0 * h->wx * h->wy * (dx == dy ? mixed : -mixed);
            own += 2.0 * h->wx * h->wy;
        }
    *diagonal = own;
    return sum;
}

static double laplace_pull(const hole *h, const double *v, size_t at, double *diagonal)
{
    const int nx = h->nx, ny = h->ny, ix = (int)(at % (size_t)nx), iy = (int)(at / (size_t)nx);
    const ptrdiff_t row = nx;
    const double *p = v + at;
    const bool left = ix > 0, right = ix<nx - 1, up = iy> 0, down = iy < ny - 1;
    double sum = 0.0;
    sum += left ? h->wx * (p[0] - p[-1]) : 0.0;
    sum += right ? h->wx * (p[0] - p[1]) : 0.0;
    sum += up ? h->wy * (p[0] - p[-row]) : 0.0;
    sum += down ? h->wy * (p[0] - p[row]) : 0.0;
    *diagonal = h->wx * (left + right) + h->wy * (up + down);
    return sum;
}

static double pull(const hole *h, const double *v, size_t at, double *diagonal)
{
    return (h->method == DIF_FILL_PLATE ? plate_pull : laplace_pull)(h, v, at, diagonal);
}

/* Room of the solver. */
typedef struct room {
    double *direction;               /* a field, 0 where the height is held */
    double *force, *image, *inverse; /* a number for each unknown          */
} room;

static void room_free(room *r)
{
    dif_release(r->direction);
    dif_release(r->force);
    dif_release(r->image);
    dif_release(r->inverse);
}

static dif_status room_make(const hole *h, room *r, dif_error *err)
{
    *r = (room){.direction = dif_alloc((size_t)h->nx * (size_t)h->ny, sizeof *r->direction),
                .force = dif_alloc(h->n, sizeof *r->force),
                .image = dif_alloc(h->n, sizeof *r->image),
                .inverse = dif_alloc(h->n, sizeof *r->inverse)};
    return r->direction && r->force && r->image && r->inverse
               ? DIF_OK
               : dif_fail(err, DIF_ERR_NOMEM, "solver for %zu missing points", h->n);
}

/* Forces on the unknowns of z, and their sum of squares over the diagonal: the misfit. */
static double find_forces(const hole *h, const double *z, room *r)
{
    double sum = 0.0;
    for (size_t i = 0; i < h->n; i++) {
        double own;
        r->force[i] = -pull(h, z, h->at[i], &own);
        r->inverse[i] = own > 0.0 ? 1.0 / own : 0.0;
        sum += r->force[i] * r->force[i] * r->inverse[i];
    }
    return sum;
}

/* Conjugate gradients with the diagonal as preconditioner, on the unknowns of z; returns the misfit that is left. */
static double relax(const hole *h, double *z, double wanted, room *r)
{
    const double n_most = fmin(fmax(WORK_MAX / (double)h->n, ITERATIONS_MIN), ITERATIONS_MAX);
    double left = find_forces(h, z, r), turn = 0.0;
    for (int k = 0; k < n_most && left > wanted; k++) {
        double bend = 0.0, next = 0.0, own;
        for (size_t i = 0; i < h->n; i++)
            r->direction[h->at[i]] = r->force[i] * r->inverse[i] + turn * r->direction[h->at[i]];
        for (size_t i = 0; i < h->n; i++) {
            r->image[i] = pull(h, r->direction, h->at[i], &own);
            bend += r->image[i] * r->direction[h->at[i]];
        }
        if (!(bend > 0.0)) /* nothing that is held resists */
            break;
        const double step = left / bend;
        for (size_t i = 0; i < h->n; i++) {
            z[h->at[i]] += step * r->direction[h->at[i]];
            r->force[i] -= step * r->image[i];
            next += r->force[i] * r->force[i] * r->inverse[i];
        }
        turn = next / left;
        left = next;
    }
    return left;
}

/* Means of what is there in 2 x 2 samples. */
static void halve(const hole *h, const double *z, hole *half, double *coarse)
{
    for (int iy = 0; iy < half->ny; iy++)
        for (int ix = 0; ix < half->nx; ix++) {
            double sum = 0.0;
            int n = 0;
            for (int y = 2 * iy; y < 2 * iy + 2 && y < h->ny; y++)
                for (int x = 2 * ix; x < 2 * ix + 2 && x < h->nx; x++) {
                    const double value = z[(size_t)y * (size_t)h->nx + (size_t)x];
                    sum += isfinite(value) ? value : 0.0;
                    n += isfinite(value);
                }
            coarse[(size_t)iy * (size_t)half->nx + (size_t)ix] = n ? sum / n : (double)NAN;
        }
}

/* Place of fine sample i between coarse ones: the lower one and the share of the next; at the ends the line goes on. */
static int between(int i, int n, double *share)
{
    const double at = 0.5 * (i - 0.5);
    const int low = n < 2 ? 0 : (int)fmin(fmax(floor(at), 0.0), n - 2.0);
    *share = n < 2 ? 0.0 : at - low;
    return low;
}

static double read_coarse(const hole *half, const double *coarse, int ix, int iy)
{
    double tx, ty;
    const int x = between(ix, half->nx, &tx), y = between(iy, half->ny, &ty);
    const double *p = coarse + (size_t)y * (size_t)half->nx + (size_t)x;
    const size_t dx = half->nx > 1, dy = half->ny > 1 ? (size_t)half->nx : 0;
    return (1.0 - ty) * ((1.0 - tx) * p[0] + tx * p[dx]) + ty * ((1.0 - tx) * p[dy] + tx * p[dy + dx]);
}

/* Lists the missing points. */
static dif_status find_hole(hole *h, const double *z, dif_error *err)
{
    const size_t n = (size_t)h->nx * (size_t)h->ny;
    size_t k = 0;
    h->n = 0;
    for (size_t i = 0; i < n; i++)
        h->n += isfinite(z[i]) ? 0 : 1;
    h->at = dif_alloc(h->n, sizeof *h->at);
    if (!h->at)
        return dif_fail(err, DIF_ERR_NOMEM, "list of %zu missing points", h->n);
    for (size_t i = 0; i < n; i++)
        if (!isfinite(z[i]))
            h->at[k++] = i;
    return DIF_OK;
}

static double mean_of(const double *z, size_t n)
{
    double sum = 0.0, there = 0.0;
    for (size_t i = 0; i < n; i++)
        if (isfinite(z[i])) {
            sum += z[i];
            there += 1.0;
        }
    return sum / there;
}

static dif_status fill(const hole *shape, double *z, double *residual, dif_error *err);

/* Puts first guesses into the unknowns: from the same problem at half the samples, or the mean. */
static dif_status guess(const hole *h, double *z, double mean, dif_error *err)
{
    hole half = *h;
    half.nx = (h->nx + 1) / 2;
    half.ny = (h->ny + 1) / 2;
    half.n = 0;
    half.at = NULL;
    if (half.nx < SIDE_COARSEST || half.ny < SIDE_COARSEST) {
        for (size_t i = 0; i < h->n; i++)
            z[h->at[i]] = mean;
        return DIF_OK;
    }
    double residual;
    double *coarse = dif_alloc((size_t)half.nx * (size_t)half.ny, sizeof *coarse);
    if (!coarse)
        return dif_fail(err, DIF_ERR_NOMEM, "grid of %d x %d samples", half.nx, half.ny);
    halve(h, z, &half, coarse);
    const dif_status status = fill(&half, coarse, &residual, err);
    for (size_t i = 0; i < h->n && !status; i++)
        z[h->at[i]] = read_coarse(&half, coarse, (int)(h->at[i] % (size_t)h->nx), (int)(h->at[i] / (size_t)h->nx));
    dif_release(coarse);
    return status;
}

/* Fills z; as many levels deep as the grid can be halved. */
static dif_status fill(const hole *shape, double *z, double *residual, dif_error *err)
{
    hole h = *shape;
    room r = {0};
    *residual = 0.0;
    dif_status status = find_hole(&h, z, err);
    if (status || h.n == 0)
        goto cleanup;
    status = room_make(&h, &r, err);
    if (status)
        goto cleanup;
    const double mean = mean_of(z, (size_t)h.nx * (size_t)h.ny);
    status = guess(&h, z, mean, err);
    if (status)
        goto cleanup;
    for (size_t i = 0; i < h.n; i++) { /* the guess waits while a constant one sets the scale */
        r.image[i] = z[h.at[i]];
        z[h.at[i]] = mean;
    }
    const double scale = find_forces(&h, z, &r);
    for (size_t i = 0; i < h.n; i++)
        z[h.at[i]] = scale > 0.0 ? r.image[i] : mean;
    if (scale > 0.0)
        *residual = sqrt(relax(&h, z, RESIDUAL_WANTED * RESIDUAL_WANTED * scale, &r) / scale);
cleanup:
    room_free(&r);
    dif_release(h.at);
    return status;
}

/* Steps along rows and columns to the nearest sample that is there, the largest: two sweeps. */
static dif_status find_reach(const dif_field *field, int *reach, dif_error *err)
{
    const int nx = field->nx, ny = field->ny, far = nx + ny;
    int *steps = dif_alloc(dif_field_n(field), sizeof *steps);
    *reach = 0;
    if (!steps)
        return dif_fail(err, DIF_ERR_NOMEM, "distances of %d x %d samples", nx, ny);
    for (int sweep = 0; sweep < 2; sweep++)
        for (int k = 0; k < nx * ny; k++) {
            const int i = sweep == 0 ? k : nx * ny - 1 - k, ix = i % nx, iy = i / nx;
            const bool has_x = sweep == 0 ? ix > 0 : ix < nx - 1, has_y = sweep == 0 ? iy > 0 : iy < ny - 1;
            const int back = sweep == 0 ? -1 : 1;
            int least = sweep == 0 ? far : steps[i];
            if (isfinite(field->z_um[i]))
                least = 0;
            if (has_x && steps[i + back] + 1 < least)
                least = steps[i + back] + 1;
            if (has_y && steps[i + back * nx] + 1 < least)
                least = steps[i + back * nx] + 1;
            steps[i] = least;
            *reach = sweep == 1 && least > *reach ? least : *reach;
        }
    dif_release(steps);
    return DIF_OK;
}

/* The field's least-squares plane at a sample, without its constant. */
static double plane_at(const dif_field *field, const dif_prep_tilt *tilt, size_t at)
{
    const int ix = (int)(at % (size_t)field->nx), iy = (int)(at / (size_t)field->nx);
    return tilt->slope_x * dif_field_x_um(field, ix) + tilt->slope_y * dif_field_y_um(field, iy);
}

/* Fills a copy: without its tilt, which is the slowest thing to spread into a hole; heights that are there stay as they
 * are to the bit. Least slope knows no tilt. */
static dif_status fill_copy(const dif_field *field, dif_prep_fill_method method, double *z, double *residual,
                            dif_error *err)
{
    const double px2 = field->pitch_x_um * field->pitch_x_um, py2 = field->pitch_y_um * field->pitch_y_um;
    const hole shape = {
        .nx = field->nx, .ny = field->ny, .wx = fmin(px2, py2) / px2, .wy = fmin(px2, py2) / py2, .method = method};
    const size_t n = dif_field_n(field);
    dif_prep_tilt tilt = {0};
    dif_status status = method == DIF_FILL_PLATE ? dif_prep_tilt_of(field, &tilt, err) : DIF_OK;
    for (size_t i = 0; i < n; i++)
        z[i] = field->z_um[i] - plane_at(field, &tilt, i);
    if (!status)
        status = fill(&shape, z, residual, err);
    for (size_t i = 0; i < n; i++)
        z[i] = isfinite(field->z_um[i]) ? field->z_um[i] : z[i] + plane_at(field, &tilt, i);
    return status;
}

dif_status dif_prep_fill(dif_field *field, dif_prep_fill_method method, dif_prep_filled *out, dif_error *err)
{
    dif_prep_filled filled = {0};
    dif_field whole = {0};
    if (out)
        *out = filled;
    dif_status status = dif_prep_check(field, err);
    if (status)
        return status;
    if (method != DIF_FILL_PLATE && method != DIF_FILL_LAPLACE)
        return dif_fail(err, DIF_ERR_ARG, "filling %d, want plate or laplace", (int)method);
    filled.n = dif_prep_state_of(field).n_missing;
    if (filled.n == 0)
        return DIF_OK;
    if (filled.n == dif_field_n(field))
        return dif_fail(err, DIF_ERR_NONFINITE, "all %zu heights are missing: nothing to fill from", filled.n);
    status = find_reach(field, &filled.reach, err);
    if (!status)
        status = dif_field_create(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um, &whole, err);
    if (!status)
        status = fill_copy(field, method, whole.z_um, &filled.residual, err);
    if (!status) {
        dif_prep_replace(field, &whole);
        if (out)
            *out = filled;
    }
    dif_field_free(&whole);
    return status;
}
