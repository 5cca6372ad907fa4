#include "core/shadow.h"

#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/units.h"

static const char *const NAMES[] = {"none", "vcavity", "smith", "ndf"};
enum {
    N_NAME = sizeof NAMES / sizeof *NAMES,
    SMITH_ROWS = 257, /* linear interpolation is then within 2e-5 */
    NDF_ROWS = 129,
    NDF_COLUMNS = 256,
    NDF_TEXELS = 193 /* odd: a flat surface fills one texel, around the pole, and masks nothing */
};

static const double variance_floor = 1e-6; /* slopes of 1e-3: below a texel of the NDF; keeps t defined on a flat one */

const char *dif_shadowing_name(dif_shadowing kind)
{
    return NAMES[kind];
}

bool dif_shadowing_from_name(const char *name, dif_shadowing *out)
{
    for (int i = 0; i < N_NAME; i++)
        if (strcmp(name, NAMES[i]) == 0) {
            *out = (dif_shadowing)i;
            return true;
        }
    return false;
}

/* Variance of the slope along k, times sin^2. */
static double form_of(const dif_slope_gauss *s, dif_vec3 k)
{
    return fmax(s->var_x * k.x * k.x + 2.0 * s->cov_xy * k.x * k.y + s->var_y * k.y * k.y, 0.0);
}

double dif_shadow_smith(const dif_slope_gauss *slopes, dif_vec3 k)
{
    const double spread = sqrt(form_of(slopes, k));
    if (!(spread > 0.0))
        return 1.0;
    if (!(k.z > 0.0))
        return 0.0;
    const double z = k.z / spread;
    return fmin(z / dif_slope_cut_at(z).psi, 1.0);
}

double dif_shadow_vcavity(dif_vec3 wi, dif_vec3 wo)
{
    /* h_n = (i_z + o_z) / |wi + wo|, e.h = |wi + wo| / 2, |wi + wo|^2 = 2 (1 + wi.wo) */
    const double facets = 2.0 * (wi.z + wo.z) * fmin(wi.z, wo.z) / (1.0 + dif_vec3_dot(wi, wo));
    return fmin(facets, 1.0); /* also where both graze in opposite directions: 0 / 0 */
}

static dif_status make_smith(dif_shadow *shadow, dif_error *err)
{
    shadow->n_row = SMITH_ROWS;
    shadow->n_column = 1;
    shadow->g = dif_alloc(SMITH_ROWS, sizeof *shadow->g);
    if (!shadow->g)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a table of shadowing");
    for (int i = 0; i < SMITH_ROWS; i++) {
        const double t = (double)i / (SMITH_ROWS - 1), z = t / (1.0 - t); /* inf at the end, where G is 1 */
        shadow->g[i] = i == SMITH_ROWS - 1 ? 1.0f : (float)fmin(z / dif_slope_cut_at(z).psi, 1.0);
    }
    return DIF_OK;
}

/* Direction of row t along the azimuth (c, s): k.z / sqrt(form) = t / (1 - t). */
static dif_vec3 direction_at(const dif_shadow *shadow, double t, double c, double s)
{
    const double spread = sqrt(form_of(&shadow->slopes, (dif_vec3){c, s, 0.0})); /* of sin = 1 */
    const double up = spread * t, along = 1.0 - t, norm = hypot(up, along);
    return (dif_vec3){along / norm * c, along / norm * s, up / norm};
}

static dif_status make_ndf(const dif_field *field, dif_shadow *shadow, dif_error *err)
{
    dif_ndf ndf;
    const dif_status status = dif_hemisphere_ndf_create(field, NDF_TEXELS, true, &ndf, err);
    if (status)
        return status;
    shadow->n_row = NDF_ROWS;
    shadow->n_column = NDF_COLUMNS;
    shadow->g = dif_alloc((size_t)NDF_ROWS * NDF_COLUMNS, sizeof *shadow->g);
    if (shadow->g) {
#pragma omp parallel for schedule(dynamic)
        for (int row = 0; row < NDF_ROWS; row++)
            for (int column = 0; column < NDF_COLUMNS; column++) {
                const double azimuth_rad = DIF_TWO_PI * column / NDF_COLUMNS;
                const dif_vec3 k =
                    direction_at(shadow, (double)row / (NDF_ROWS - 1), cos(azimuth_rad), sin(azimuth_rad));
                shadow->g[row * NDF_COLUMNS + column] = (float)dif_hemisphere_masking(&ndf, k);
            }
    }
    dif_hemisphere_ndf_free(&ndf);
    return shadow->g ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for a table of shadowing");
}

dif_status dif_shadow_create(dif_shadowing kind, const dif_field *field, dif_shadow *out, dif_error *err)
{
    *out = (dif_shadow){0};
    if (!((unsigned)kind < N_NAME))
        return dif_fail(err, DIF_ERR_ARG, "shadowing %d, want 0 ... %d", (int)kind, N_NAME - 1);
    out->kind = kind;
    if (kind == DIF_SHADOWING_NONE || kind == DIF_SHADOWING_VCAVITY)
        return DIF_OK;
    dif_status status = field ? dif_slope_of_field(field, &out->slopes, err)
                              : dif_fail(err, DIF_ERR_ARG, "%s shadowing needs the surface", NAMES[kind]);
    out->slopes.mean_x = out->slopes.mean_y = 0.0;
    if (status == DIF_OK && kind == DIF_SHADOWING_NDF) {
        out->slopes.var_x += variance_floor;
        out->slopes.var_y += variance_floor;
    }
    if (status == DIF_OK)
        status = kind == DIF_SHADOWING_SMITH ? make_smith(out, err) : make_ndf(field, out, err);
    if (status)
        dif_shadow_free(out);
    return status;
}

void dif_shadow_free(dif_shadow *shadow)
{
    dif_release(shadow->g);
    *shadow = (dif_shadow){0};
}

/* Linear between rows at column j. */
static double read_column(const dif_shadow *shadow, int j, int i, double part)
{
    const float *at = shadow->g + (size_t)i * (size_t)shadow->n_column + j;
    return (1.0 - part) * (double)at[0] + part * (double)at[shadow->n_column];
}

double dif_shadow_masking(const dif_shadow *shadow, dif_vec3 k)
{
    if (shadow->n_row == 0)
        return 1.0;
    const double spread = sqrt(form_of(&shadow->slopes, k)), up = fmax(k.z, 0.0);
    if (!(up + spread > 0.0)) /* grazing along the grooves of a perfect grating */
        return 1.0;
    const double t = up / (up + spread) * (shadow->n_row - 1);
    const int row = t < shadow->n_row - 2 ? (int)t : shadow->n_row - 2;
    if (shadow->n_column == 1)
        return read_column(shadow, 0, row, t - row);
    double turns = atan2(k.y, k.x) / DIF_TWO_PI;
    turns -= floor(turns);
    const double column = turns * shadow->n_column, whole = floor(column);
    const int j = (int)whole % shadow->n_column, next = (j + 1) % shadow->n_column;
    const double part = column - whole;
    return (1.0 - part) * read_column(shadow, j, row, t - row) + part * read_column(shadow, next, row, t - row);
}

double dif_shadow_factor(const dif_shadow *shadow, dif_vec3 wi, dif_vec3 wo)
{
    if (!shadow || shadow->kind == DIF_SHADOWING_NONE)
        return 1.0;
    if (shadow->kind == DIF_SHADOWING_VCAVITY)
        return dif_shadow_vcavity(wi, wo);
    return dif_shadow_masking(shadow, wi) * dif_shadow_masking(shadow, wo);
}
