#include "bench/fit_line.h"

#include <math.h>

#include "core/alloc.h"
#include "core/units.h"

enum { N_QUADRATURE = 1024, N_CENTRE_MAX = 4096, NODES_PER_CYCLE = 100, N_WAVE_MAX = 16 };

/* The windows along one axis: their samples at the quadrature points of the patch. */
typedef struct axis {
    double size_um;
    double sin_or_cos; /* share of delta that falls on this axis */
    int n_centre;
    double centre_um[N_CENTRE_MAX];
    dif_window_kind kind;
    double sigma_um;
} axis;

static double window_value(const axis *a, int i_centre, double x_um)
{
    if (a->kind == DIF_WINDOW_FLAT)
        return 1.0;
    const double t = (x_um - a->centre_um[i_centre]) / a->sigma_um;
    return exp(-0.5 * t * t);
}

/* One window's transform at spatial frequency f and its derivative by f, (re, im); midpoint rule over the patch. The
 * wave's phase advances by one multiplication a sample. */
static void transform_at(const axis *a, const double *w, double f_per_um, double value[2], double slope[2])
{
    const double step = a->size_um / N_QUADRATURE, x0 = 0.5 * (step - a->size_um);
    const double turn_re = cos(DIF_TWO_PI * f_per_um * step), turn_im = sin(DIF_TWO_PI * f_per_um * step);
    double re = cos(DIF_TWO_PI * f_per_um * x0), im = sin(DIF_TWO_PI * f_per_um * x0);
    value[0] = value[1] = slope[0] = slope[1] = 0.0;
    for (int i = 0; i < N_QUADRATURE; i++) {
        const double x = x0 + i * step, next = re * turn_re - im * turn_im;
        value[0] += w[i] * re;
        value[1] += w[i] * im;
        slope[0] -= DIF_TWO_PI * x * w[i] * im;
        slope[1] += DIF_TWO_PI * x * w[i] * re;
        im = re * turn_im + im * turn_re;
        re = next;
    }
}

/* Sums over the windows of one axis at one f: |W^|^2, conj(W^) W(edge) exp(2 pi i f edge), and their derivatives. */
static void axis_sums(const axis *a, double (*w)[N_QUADRATURE], double f_per_um, double out[6])
{
    const double edge = 0.5 * a->size_um;
    const double ce = cos(DIF_TWO_PI * f_per_um * edge), se = sin(DIF_TWO_PI * f_per_um * edge);
    for (int i = 0; i < 6; i++)
        out[i] = 0.0;
    for (int s = 0; s < a->n_centre; s++) {
        double v[2], d[2];
        transform_at(a, w[s], f_per_um, v, d);
        const double g = window_value(a, s, edge), omega = DIF_TWO_PI * edge;
        out[0] += v[0] * v[0] + v[1] * v[1];
        out[1] += 2.0 * (v[0] * d[0] + v[1] * d[1]);
        /* conj(v) e^{i omega f} = (v0 c + v1 s) + i (v0 s - v1 c) */
        out[2] += g * (v[0] * ce + v[1] * se);
        out[3] += g * (d[0] * ce + d[1] * se + omega * (v[1] * ce - v[0] * se));
        out[4] += g * (v[0] * se - v[1] * ce);
        out[5] += g * (d[0] * se - d[1] * ce + omega * (v[0] * ce + v[1] * se));
    }
}

/* Distinct centres of the tiling along one axis; the tiling is a product grid. */
static void add_centre(axis *a, double centre_um)
{
    for (int i = 0; i < a->n_centre; i++)
        if (fabs(a->centre_um[i] - centre_um) < 1e-9 * a->size_um)
            return;
    if (a->n_centre < N_CENTRE_MAX)
        a->centre_um[a->n_centre++] = centre_um;
}

static dif_status collect_centres(const dif_fit_line *line, axis *ax, axis *ay, dif_error *err)
{
    /* only the geometry of this field is looked at */
    const dif_field patch = {.nx = N_QUADRATURE,
                             .ny = N_QUADRATURE,
                             .pitch_x_um = line->size_x_um / N_QUADRATURE,
                             .pitch_y_um = line->size_y_um / N_QUADRATURE};
    const dif_window *w = &line->window;
    if (line->average == DIF_AVERAGE_NONE || w->kind == DIF_WINDOW_FLAT) {
        add_centre(ax, w->x_um);
        add_centre(ay, w->y_um);
        return DIF_OK;
    }
    const int n = dif_window_tile_count(w->kind, w->sigma_um, line->average, &patch);
    dif_window *tile = dif_alloc((size_t)n, sizeof *tile);
    if (!tile)
        return dif_fail(err, DIF_ERR_NOMEM, "%d windows of the line shape", n);
    dif_window_tile(w->kind, w->sigma_um, line->average, &patch, tile);
    for (int i = 0; i < n; i++) {
        add_centre(ax, tile[i].x_um);
        add_centre(ay, tile[i].y_um);
    }
    dif_release(tile);
    return DIF_OK;
}

static void fill_axis(const axis *a, double (*w)[N_QUADRATURE])
{
    const double step = a->size_um / N_QUADRATURE, x0 = 0.5 * (step - a->size_um);
    for (int s = 0; s < a->n_centre; s++)
        for (int i = 0; i < N_QUADRATURE; i++)
            w[s][i] = window_value(a, s, x0 + i * step);
}

/* Half width at half maximum of the node table / sqrt(2 ln 2), and the rms width within 5 of those. */
static void measure_widths(dif_fit_lineshape *line)
{
    int i = 0;
    while (i + 1 < line->n_node && line->node[i + 1][0] > 0.5)
        i++;
    const double above = line->node[i][0], below = i + 1 < line->n_node ? line->node[i + 1][0] : 0.0;
    line->sigma_per_um = line->step_per_um * (i + (above - 0.5) / (above - below)) / sqrt(2.0 * log(2.0));
    double s0 = 0.0, s2 = 0.0;
    for (int j = 0; j < line->n_node && j * line->step_per_um < 5.0 * line->sigma_per_um; j++) {
        const double d = j * line->step_per_um, weight = j == 0 ? 0.5 : 1.0;
        s0 += weight * line->node[j][0];
        s2 += weight * line->node[j][0] * d * d;
    }
    line->rms_per_um = sqrt(s2 / s0);
}

/* Fills the node table from the two axes. E belongs to the axis that the plane runs along, if it runs along one. */
static void fill_nodes(dif_fit_lineshape *line, const axis *ax, double (*wx)[N_QUADRATURE], const axis *ay,
                       double (*wy)[N_QUADRATURE])
{
    double x0[6], y0[6], x[6], y[6];
    axis_sums(ax, wx, 0.0, x0);
    axis_sums(ay, wy, 0.0, y0);
    const axis *main_axis = fabs(ax->sin_or_cos) > fabs(ay->sin_or_cos) ? ax : ay;
    for (int i = 0; i < line->n_node; i++) {
        const double delta = i * line->step_per_um;
        axis_sums(ax, wx, delta * ax->sin_or_cos, x);
        axis_sums(ay, wy, delta * ay->sin_or_cos, y);
        double *node = line->node[i];
        node[0] = x[0] * y[0] / (x0[0] * y0[0]);
        node[1] = (x[1] * ax->sin_or_cos * y[0] + x[0] * y[1] * ay->sin_or_cos) / (x0[0] * y0[0]);
        const double *m = main_axis == ax ? x : y, *m0 = main_axis == ax ? x0 : y0;
        for (int j = 2; j < 6; j++)
            node[j] = m0[2] > 0.0 ? m[j] / m0[2] * (j % 2 ? main_axis->sin_or_cos : 1.0) : 0.0;
    }
}

/* Transforms of the single windows along the plane's axis, for the pair terms; none if there are many windows, whose
 * average has no pair terms worth a name. */
static dif_status fill_waves(dif_fit_lineshape *line, const axis *a, double (*w)[N_QUADRATURE], dif_error *err)
{
    if (!line->has_edge || a->n_centre > N_WAVE_MAX)
        return DIF_OK;
    line->wave = dif_alloc((size_t)a->n_centre * (size_t)line->n_node, sizeof *line->wave);
    if (!line->wave)
        return dif_fail(err, DIF_ERR_NOMEM, "line shape of %d nodes", line->n_node);
    line->n_wave = a->n_centre;
    double total = 0.0;
    for (int s = 0; s < a->n_centre; s++)
        for (int i = 0; i < line->n_node; i++) {
            double v[2], d[2], *to = line->wave[(size_t)s * (size_t)line->n_node + (size_t)i];
            transform_at(a, w[s], i * line->step_per_um * a->sin_or_cos, v, d);
            for (int j = 0; j < 2; j++) {
                to[2 * j] = v[j];
                to[2 * j + 1] = d[j] * a->sin_or_cos;
            }
            total += i == 0 ? v[0] * v[0] + v[1] * v[1] : 0.0;
        }
    for (size_t i = 0; i < (size_t)line->n_wave * (size_t)line->n_node; i++)
        for (int j = 0; j < 4; j++)
            line->wave[i][j] /= sqrt(total);
    return DIF_OK;
}

static dif_status check_line(const dif_fit_line *line, dif_error *err)
{
    if (!(line->size_x_um > 0.0 && isfinite(line->size_x_um) && line->size_y_um > 0.0 && isfinite(line->size_y_um)))
        return dif_fail(err, DIF_ERR_ARG, "patch of the line shape is %g um x %g um, want positive sizes",
                        line->size_x_um, line->size_y_um);
    if (line->window.kind == DIF_WINDOW_GAUSS && !(line->window.sigma_um > 0.0 && isfinite(line->window.sigma_um)))
        return dif_fail(err, DIF_ERR_ARG, "window sigma of the line shape is %g um, want it positive",
                        line->window.sigma_um);
    return DIF_OK;
}

/* Width of the narrowest window along the plane, to know how far a table must reach. */
static double rough_sigma_per_um(const dif_fit_line *line, double extent_um)
{
    const double flat = 0.376 / extent_um; /* sinc^2: FWHM 0.886 / D */
    if (line->window.kind == DIF_WINDOW_FLAT)
        return flat;
    return fmax(flat, 1.0 / (2.0 * DIF_PI * sqrt(2.0) * line->window.sigma_um));
}

dif_status dif_fit_line_create(const dif_fit_line *line, double azimuth_rad, dif_fit_lineshape *out, dif_error *err)
{
    *out = (dif_fit_lineshape){0};
    dif_status status = check_line(line, err);
    if (status != DIF_OK)
        return status;
    const double c = cos(azimuth_rad), s = sin(azimuth_rad);
    double(*wx)[N_QUADRATURE] = NULL, (*wy)[N_QUADRATURE] = NULL;
    axis *a = dif_alloc(2, sizeof *a);
    if (!a)
        return dif_fail(err, DIF_ERR_NOMEM, "axes of the line shape");
    a[0] = (axis){.size_um = line->size_x_um, .sin_or_cos = c};
    a[1] = (axis){.size_um = line->size_y_um, .sin_or_cos = s};
    for (int i = 0; i < 2; i++) {
        a[i].kind = line->window.kind;
        a[i].sigma_um = line->window.sigma_um;
    }
    status = collect_centres(line, &a[0], &a[1], err);
    if (status != DIF_OK)
        goto cleanup;
    const double extent_um = line->size_x_um * fabs(c) + line->size_y_um * fabs(s);
    out->extent_um = extent_um;
    out->step_per_um = 1.0 / (NODES_PER_CYCLE * extent_um);
    out->n_node = 2 + (int)ceil(DIF_FIT_LINE_REACH * rough_sigma_per_um(line, extent_um) / out->step_per_um);
    out->node = dif_alloc((size_t)out->n_node, sizeof *out->node);
    wx = dif_alloc((size_t)a[0].n_centre, sizeof *wx);
    wy = dif_alloc((size_t)a[1].n_centre, sizeof *wy);
    if (!out->node || !wx || !wy) {
        status = dif_fail(err, DIF_ERR_NOMEM, "line shape of %d nodes", out->n_node);
        goto cleanup;
    }
    fill_axis(&a[0], wx);
    fill_axis(&a[1], wy);
    fill_nodes(out, &a[0], wx, &a[1], wy);
    measure_widths(out);
    out->known = true;
    out->has_edge = fmin(fabs(c), fabs(s)) < 1e-3;
    status = fabs(c) > fabs(s) ? fill_waves(out, &a[0], wx, err) : fill_waves(out, &a[1], wy, err);
cleanup:
    dif_release(wy);
    dif_release(wx);
    dif_release(a);
    if (status != DIF_OK)
        dif_fit_line_free(out);
    return status;
}

void dif_fit_line_free(dif_fit_lineshape *line)
{
    if (!line)
        return;
    dif_release(line->wave);
    dif_release(line->node);
    *line = (dif_fit_lineshape){0};
}

dif_fit_lineshape dif_fit_line_gauss(double sigma_per_um)
{
    return (dif_fit_lineshape){.known = false, .sigma_per_um = sigma_per_um, .rms_per_um = sigma_per_um};
}

/* Cubic Hermite interpolation of a value and its derivative between two nodes; t in [0, 1]. */
static void hermite(const double *p, const double *q, double step, double t, double *value, double *slope)
{
    const double a = q[0] - p[0], m0 = p[1] * step, m1 = q[1] * step;
    const double c2 = 3.0 * a - 2.0 * m0 - m1, c3 = m0 + m1 - 2.0 * a;
    *value = p[0] + t * (m0 + t * (c2 + t * c3));
    *slope = (m0 + t * (2.0 * c2 + 3.0 * t * c3)) / step;
}

dif_fit_shape dif_fit_line_at(const dif_fit_lineshape *line, double delta_per_um, double width_per_um)
{
    dif_fit_shape s = {0};
    if (!line->known) {
        const double t = delta_per_um / width_per_um;
        s.l = exp(-0.5 * t * t);
        s.dl = -s.l * t / width_per_um;
        s.dl_dlog_width = s.l * t * t;
        return s;
    }
    const double place = fabs(delta_per_um) / line->step_per_um;
    if (!(place < line->n_node - 1))
        return s;
    const int i = (int)place;
    const double t = place - i, sign = delta_per_um < 0.0 ? -1.0 : 1.0;
    const double *p = line->node[i], *q = line->node[i + 1];
    hermite(p, q, line->step_per_um, t, &s.l, &s.dl);
    hermite(p + 2, q + 2, line->step_per_um, t, &s.re, &s.dre);
    hermite(p + 4, q + 4, line->step_per_um, t, &s.im, &s.dim);
    /* L and Re E are even in delta, Im E is odd (the tiling is symmetric about the patch's centre) */
    s.dl *= sign;
    s.dre *= sign;
    s.im *= sign;
    return s;
}

/* One window's transform at delta: value and slope of real and imaginary part; false beyond the table. */
static bool wave_at(const dif_fit_lineshape *line, int s, double delta, double v[2], double d[2])
{
    const double place = fabs(delta) / line->step_per_um;
    if (!(place < line->n_node - 1))
        return false;
    const int i = (int)place;
    const double *p = line->wave[(size_t)s * (size_t)line->n_node + (size_t)i], *q = p + 4;
    for (int j = 0; j < 2; j++)
        hermite(p + 2 * j, q + 2 * j, line->step_per_um, place - i, &v[j], &d[j]);
    if (delta < 0.0) { /* the window is real: W^(-delta) = conj W^(delta) */
        d[0] = -d[0];
        v[1] = -v[1];
    }
    return true;
}

double dif_fit_line_amplitude(const dif_fit_lineshape *line, double delta_per_um, double *slope)
{
    double v[2] = {0}, d[2] = {0};
    wave_at(line, 0, delta_per_um, v, d);
    *slope = d[0];
    return v[0];
}

/* The geometric mean sqrt(L(a) L(b)): right for windows whose transform is positive where it matters. */
static dif_fit_pair_shape mean_pair(const dif_fit_lineshape *line, double a, double b, double width)
{
    const dif_fit_shape p = dif_fit_line_at(line, a, width), q = dif_fit_line_at(line, b, width);
    const double floor_value = 1e-6;
    if (!(p.l > floor_value && q.l > floor_value))
        return (dif_fit_pair_shape){0};
    const double s = sqrt(p.l * q.l);
    return (dif_fit_pair_shape){.s = s, .ds_da = 0.5 * s * p.dl / p.l, .ds_db = 0.5 * s * q.dl / q.l};
}

dif_fit_pair_shape dif_fit_line_pair(const dif_fit_lineshape *line, double a_per_um, double b_per_um,
                                     double width_per_um)
{
    dif_fit_pair_shape p = {0};
    double a[2], da[2], b[2], db[2];
    if (line->n_wave == 0)
        return mean_pair(line, a_per_um, b_per_um, width_per_um);
    for (int s = 0; s < line->n_wave; s++) {
        if (!wave_at(line, s, a_per_um, a, da) || !wave_at(line, s, b_per_um, b, db))
            continue;
        p.s += a[0] * b[0] + a[1] * b[1];
        p.ds_da += da[0] * b[0] + da[1] * b[1];
        p.ds_db += a[0] * db[0] + a[1] * db[1];
    }
    return p;
}
