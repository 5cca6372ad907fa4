/* The pictures of one case: what the device answered, what the reference did, and how far apart they are. */
#include <math.h>
#include <stdio.h>

#include "bench/cli/cli.h"
#include "bench/cli/compare_job.h"
#include "core/alloc.h"
#include "core/colour.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/units.h"

enum { COLUMNS_MAX = 640, PATH_SIZE = 4096 };
static const double VALUE_DECADES = 6.0;              /* of values below the largest        */
static const double ABS_LOW = 1e-13, ABS_HIGH = 1e-5; /* of the differences of powers       */
static const double DE_LOW = 1e-6, DE_HIGH = 1e2;     /* of the differences of colours      */
static const uint8_t NOTHING[3] = {214, 214, 214};    /* where there is no number           */

/* A picture in the making: what its pixels stand for. */
typedef struct canvas {
    int nx, ny, block; /* block: table cells that share a pixel along x */
    const char *map;   /* colour map; NULL: `rgb` is filled already     */
    double low, high;  /* of the logarithmic scale                      */
    float *value;      /* value[ny * nx], top row first                 */
    uint8_t *rgb;
    uint8_t colours[256][3];
} canvas;

static dif_status canvas_make(int nx, int ny, canvas *out, dif_error *err)
{
    *out = (canvas){.nx = nx, .ny = ny, .block = 1};
    out->value = dif_alloc((size_t)nx * (size_t)ny, sizeof *out->value);
    out->rgb = dif_alloc((size_t)nx * (size_t)ny, 3);
    return out->value && out->rgb ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "no memory for a picture");
}

static void canvas_free(canvas *c)
{
    dif_release(c->value);
    dif_release(c->rgb);
}

static void paint(canvas *c)
{
    const double decades = log10(c->high / c->low);
    for (size_t i = 0, n = (size_t)c->nx * (size_t)c->ny; i < n; i++) {
        const double value = (double)c->value[i], at = 1.0 + log10(value / c->high) / decades;
        const uint8_t *colour = c->colours[at > 0.0 ? (int)(255.0 * fmin(at, 1.0) + 0.5) : 0];
        for (size_t k = 0; k < 3; k++)
            c->rgb[3 * i + k] = isnan(value) ? NOTHING[k] : colour[k];
    }
}

static dif_status write_canvas(const char *path, canvas *c, dif_error *err)
{
    unsigned char *png = NULL;
    size_t n = 0;
    dif_status status = c->map ? dif_image_colormap(c->map, c->colours, err) : DIF_OK;
    if (status == DIF_OK && c->map)
        paint(c);
    if (status == DIF_OK)
        status = dif_image_encode_png(c->rgb, c->nx, c->ny, &png, &n, err);
    if (status == DIF_OK)
        status = dif_file_write(path, png, n, err);
    dif_release(png);
    return status;
}

/* |a - b|, or the value of `a` where b is NULL; a place with a number on one side only shows the scale's end. */
static double shown(const double *a, const double *b, size_t at)
{
    if (!b)
        return a[at];
    if (isnan(a[at]) && isnan(b[at]))
        return (double)NAN;
    const double off = fabs(a[at] - b[at]);
    return isfinite(off) ? off : ABS_HIGH;
}

/* A table: angles to the right, wavelengths upwards; a pixel shows the largest of its cells. */
static void fill_table(const dif_plan *plan, const double *a, const double *b, canvas *c)
{
    for (int y = 0; y < c->ny; y++)
        for (int x = 0; x < c->nx; x++) {
            double best = (double)NAN;
            for (int i = c->block * x; i < c->block * (x + 1) && i < plan->n_angle; i++)
                best = fmax(best, shown(a, b, (size_t)(c->ny - 1 - y) * (size_t)plan->n_angle + (size_t)i));
            c->value[(size_t)y * (size_t)c->nx + (size_t)x] = (float)best;
        }
}

static void fill_map(const double *a, const double *b, size_t first, canvas *c)
{
    for (size_t i = 0, n = (size_t)c->nx * (size_t)c->ny; i < n; i++)
        c->value[i] = (float)shown(a, b, first + i);
}

static void fill_difference(const double (*a)[3], const double (*b)[3], double exposure, canvas *c)
{
    for (size_t i = 0, n = (size_t)c->nx * (size_t)c->ny; i < n; i++) {
        const bool none = isnan(a[i][1]) && isnan(b[i][1]);
        c->value[i] = none ? NAN : (float)fmin(dif_regress_difference(a[i], b[i], exposure), DE_HIGH);
    }
}

static void fill_colours(const double (*a)[3], double exposure, canvas *c)
{
    for (size_t i = 0, n = (size_t)c->nx * (size_t)c->ny; i < n; i++) {
        const bool there = isfinite(a[i][0]) && isfinite(a[i][1]) && isfinite(a[i][2]);
        if (there)
            dif_colour_pixel(a[i], exposure, DIF_GAMUT_DESATURATE, c->rgb + 3 * i);
        for (size_t k = 0; k < 3 && !there; k++)
            c->rgb[3 * i + k] = NOTHING[k];
    }
}

/* One of the three: values of a, or with b the differences. */
static dif_status draw(const char *path, const dif_regress_plan *plan, const dif_regress_case *result, const double *a,
                       const double *b, dif_error *err)
{
    const bool table = result->question == DIF_REGRESS_TABLE, map = result->question == DIF_REGRESS_MAP;
    const bool colours = !table && !map;
    const int block = table ? (plan->table->n_angle + COLUMNS_MAX - 1) / COLUMNS_MAX : 1;
    canvas c;
    dif_status status = canvas_make(table ? (plan->table->n_angle + block - 1) / block : plan->n_pixel,
                                    table ? plan->table->n_lambda : plan->n_pixel, &c, err);
    c.block = block;
    c.map = b ? "inferno" : colours ? NULL : "viridis";
    c.high = b ? (colours ? DE_HIGH : ABS_HIGH) : fmax(result->values.maximum, 1e-300);
    c.low = b ? (colours ? DE_LOW : ABS_LOW) : c.high * pow(10.0, -VALUE_DECADES);
    const size_t n = (size_t)plan->n_pixel * (size_t)plan->n_pixel;
    if (status == DIF_OK && table)
        fill_table(plan->table, a, b, &c);
    else if (status == DIF_OK && map)
        fill_map(a, b, result->values.absolute.worst_at / n * n, &c);
    else if (status == DIF_OK && b)
        fill_difference((const double(*)[3])a, (const double(*)[3])b, result->exposure, &c);
    else if (status == DIF_OK)
        fill_colours((const double(*)[3])a, result->exposure, &c);
    if (status == DIF_OK)
        status = write_canvas(path, &c, err);
    canvas_free(&c);
    return status;
}

/* What the page must know to label them. */
static json_t *pictures_json(const dif_regress_plan *plan, const dif_regress_case *result)
{
    const bool table = result->question == DIF_REGRESS_TABLE, map = result->question == DIF_REGRESS_MAP;
    const dif_plan *t = plan->table;
    json_t *out = json_pack("{s:o, s:o, s:o}", "value_high", dif_json_number(result->values.maximum), "difference_low",
                            dif_json_number(table || map ? ABS_LOW : DE_LOW), "difference_high",
                            dif_json_number(table || map ? ABS_HIGH : DE_HIGH));
    if (table || map)
        json_object_set_new(out, "value_low", dif_json_number(result->values.maximum * pow(10.0, -VALUE_DECADES)));
    if (map)
        json_object_set_new(
            out, "lambda_nm",
            dif_json_number(dif_nm_from_um(
                dif_regress_place_of(plan, DIF_REGRESS_MAP, result->values.absolute.worst_at).lambda_um)));
    if (table)
        json_object_set_new(out, "axes",
                            json_pack("[o, o, o, o]", dif_json_number(dif_deg_from_rad(t->angle_rad[0])),
                                      dif_json_number(dif_deg_from_rad(t->angle_rad[t->n_angle - 1])),
                                      dif_json_number(dif_nm_from_um(t->lambda_um[0])),
                                      dif_json_number(dif_nm_from_um(t->lambda_um[t->n_lambda - 1]))));
    return out;
}

dif_status dif_compare_pictures(const char *folder, const char *slug, const dif_regress_plan *plan,
                                const dif_regress_case *result, const double *device, const double *reference,
                                json_t *json, dif_error *err)
{
    static const char *const names[] = {"device", "reference", "difference"};
    json_t *out = pictures_json(plan, result);
    for (int i = 0; i < 3; i++) {
        char name[160], path[PATH_SIZE];
        snprintf(name, sizeof name, "%s.%s.%s.%s.%s.png", slug, dif_regress_method_name(result->method),
                 dif_regress_question_name(result->question), result->path, names[i]);
        const int n = snprintf(path, sizeof path, "%s/%s", folder, name);
        dif_status status =
            n >= 0 && n < PATH_SIZE ? DIF_OK : dif_fail(err, DIF_ERR_SIZE, "%.100s...: path too long", folder);
        if (status == DIF_OK)
            status = draw(path, plan, result, i == 1 ? reference : device, i == 2 ? reference : NULL, err);
        if (status != DIF_OK) {
            json_decref(out);
            return status;
        }
        json_object_set_new(out, names[i], json_string(name));
    }
    return json_object_set_new(json, "pictures", out) == 0 ? DIF_OK
                                                           : dif_fail(err, DIF_ERR_NOMEM, "pictures of a case");
}
