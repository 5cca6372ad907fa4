/* Maps as pictures. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/io/image_head.h"
#include "core/io/map_io.h"
#include "core/units.h"

dif_map_look dif_map_look_default(void)
{
    return (dif_map_look){.exposure = DIF_EXPOSURE_AUTO, .gamut = DIF_GAMUT_CLIP};
}

static size_t pixels_of(const dif_map_image *map)
{
    return (size_t)map->n_pixel * (size_t)map->n_pixel;
}

static void xyz_at(const dif_map_image *map, size_t pixel, double xyz[3])
{
    for (size_t c = 0; c < 3; c++)
        xyz[c] = (double)map->xyz[3 * pixel + c];
}

/* Light by level, in bins of 1 %: levels are the largest of R, G, B. */
enum { LEVELS = 8000, LEVELS_PER_E = 100 };

typedef struct light_levels {
    double light[LEVELS], sum;
} light_levels;

static void add_light(light_levels *levels, double level)
{
    const double bin = LEVELS_PER_E * log(level) + 0.5 * LEVELS;
    if (!(level > 0.0 && bin >= 0.0 && bin < LEVELS))
        return;
    levels->light[(int)bin] += level;
    levels->sum += level;
}

/* 1 / the level above which a share of the light lies. */
static double exposure_of(const light_levels *levels, double share)
{
    double above = 0.0;
    int bin = LEVELS;
    while (bin > 0 && above <= share * levels->sum)
        above += levels->light[--bin];
    return levels->sum > 0.0 ? exp((0.5 * LEVELS - bin) / LEVELS_PER_E) : 1.0;
}

double dif_map_exposure(const dif_map_image *map)
{
    const double s = sin(map->theta_rad), mirror_x = -s * cos(map->phi_rad), mirror_y = -s * sin(map->phi_rad);
    light_levels all = {.sum = 0.0}, away = {.sum = 0.0};
    const int n = map->n_pixel;
    for (size_t i = 0; i < pixels_of(map); i++) {
        const double x = (2.0 * (double)(i % (size_t)n) + 1.0) / n - 1.0;
        const double y = 1.0 - (2.0 * (double)(i / (size_t)n) + 1.0) / n;
        double xyz[3], rgb[3];
        xyz_at(map, i, xyz);
        dif_colour_rgb_from_xyz(xyz, rgb);
        const double level = fmax(rgb[0], fmax(rgb[1], rgb[2]));
        add_light(&all, level);
        if (hypot(x - mirror_x, y - mirror_y) > DIF_EXPOSURE_AUTO_AWAY)
            add_light(&away, level);
    }
    return exposure_of(away.sum > 1e-3 * all.sum ? &away : &all, DIF_EXPOSURE_AUTO_SHARE);
}

enum { MARK_MAX = 80, TEXT_MAX = 40, TEXT_SIZE = 160, SIDE_MIN = 256 };

/* A picture being made. Lengths in its pixels. */
typedef struct picture {
    const dif_map_image *map;
    int enlarge, side; /* side = enlarge * n_pixel */
    int margin, nx, ny;
    double capital; /* height of capitals */
    int n_mark, n_text;
    dif_mark mark[MARK_MAX];
    char text[TEXT_MAX][TEXT_SIZE];
} picture;

static const uint8_t GROUND = 34, PALE[3] = {225, 225, 225}, RING[3] = {84, 84, 84};
enum { CAPTION_LINES = 3 };

static picture picture_of(const dif_map_image *map)
{
    picture p = {.map = map, .enlarge = (SIDE_MIN + map->n_pixel - 1) / map->n_pixel};
    p.side = p.enlarge * map->n_pixel;
    p.capital = fmax(7.0, p.side / 56.0);
    p.margin = (int)(5.2 * p.capital);
    p.nx = p.side + 2 * p.margin;
    p.ny = p.nx + (int)((1.9 * CAPTION_LINES - 0.9) * p.capital);
    return p;
}

/* Where a direction cosine lies in the picture, in pixel centres. */
static double x_of(const picture *p, double x)
{
    return p->margin + 0.5 * p->side * (1.0 + x) - 0.5;
}

static double y_of(const picture *p, double y)
{
    return p->margin + 0.5 * p->side * (1.0 - y) - 0.5;
}

static int stroke_of(const picture *p)
{
    return p->side < 1400 ? 1 : p->side / 700;
}

static dif_mark *add_mark(picture *p, dif_mark_kind kind, double x, double y, const uint8_t rgb[3])
{
    dif_mark *mark = &p->mark[p->n_mark++];
    *mark = (dif_mark){.kind = kind, .x = x, .y = y, .stroke = stroke_of(p)};
    memcpy(mark->rgb, rgb, 3);
    return mark;
}

static void add_circle(picture *p, double x, double y, double radius, const uint8_t rgb[3])
{
    add_mark(p, DIF_MARK_CIRCLE, x_of(p, x), y_of(p, y), rgb)->size = radius;
}

static void add_line(picture *p, double x, double y, double x1, double y1, const uint8_t rgb[3])
{
    dif_mark *mark = add_mark(p, DIF_MARK_LINE, x, y, rgb);
    mark->x1 = x1;
    mark->y1 = y1;
}

static dif_mark *add_text(picture *p, double x, double y, const char *text)
{
    dif_mark *mark = add_mark(p, DIF_MARK_TEXT, x, y, PALE);
    snprintf(p->text[p->n_text], TEXT_SIZE, "%.*s", TEXT_SIZE - 1, text);
    mark->text = p->text[p->n_text++];
    mark->size = p->capital;
    mark->anchor_x = mark->anchor_y = 0.5;
    return mark;
}

/* Circles of theta with labels where neither axis nor diagonal runs, and the azimuths around. */
static void add_axes(picture *p)
{
    char text[16];
    for (int deg = 15; deg <= 90; deg += 15)
        add_circle(p, 0.0, 0.0, 0.5 * p->side * sin(dif_rad_from_deg(deg)), RING);
    for (int deg = 0; deg < 360; deg += 15) {
        const double x = cos(dif_rad_from_deg(deg)), y = sin(dif_rad_from_deg(deg));
        const double tick = (deg % 45 ? 0.5 : 1.0) * p->capital, far = 0.5 * p->side + 1.5 * p->capital;
        const double x0 = x_of(p, x), y0 = y_of(p, y);
        add_line(p, x0, y0, x0 + tick * x, y0 - tick * y, PALE);
        if (deg % 45)
            continue;
        snprintf(text, sizeof text, "%d°", deg);
        dif_mark *mark = add_text(p, x_of(p, 0.0) + far * x, y_of(p, 0.0) - far * y, text);
        mark->anchor_x = 0.5 - 0.5 * x;
        mark->anchor_y = 0.5 + 0.5 * y;
    }
    for (int deg = 15; deg < 90; deg += 15) {
        const double at = dif_rad_from_deg(292.5), r = 0.5 * p->side * sin(dif_rad_from_deg(deg)) - 0.85 * p->capital;
        snprintf(text, sizeof text, "%d°", deg);
        dif_mark *mark = add_text(p, x_of(p, 0.0) + r * cos(at), y_of(p, 0.0) - r * sin(at), text);
        mark->halo = true;
        mark->size = 0.85 * p->capital;
    }
}

/* A cross at the fixed direction, a circle at the mirror direction. */
static void add_directions(picture *p)
{
    const double s = sin(p->map->theta_rad), half = 0.7 * p->capital;
    const double x = s * cos(p->map->phi_rad), y = s * sin(p->map->phi_rad);
    const double x0 = x_of(p, x), y0 = y_of(p, y);
    add_line(p, x0 - half, y0, x0 + half, y0, PALE);
    add_line(p, x0, y0 - half, x0, y0 + half, PALE);
    add_circle(p, -x, -y, half, PALE);
}

static void add_caption(picture *p, double exposure, const dif_map_look *look)
{
    const dif_map_image *map = p->map;
    const char *unit = dif_quantity_unit(map->quantity);
    char text[CAPTION_LINES][TEXT_SIZE];
    const double theta_deg = dif_deg_from_rad(map->theta_rad), phi_deg = dif_deg_from_rad(map->phi_rad);
    const double from_nm = dif_nm_from_um(map->lambda_um[0]), to_nm = dif_nm_from_um(map->lambda_um[map->n_lambda - 1]);
    const bool has_unit = strcmp(unit, "1") != 0 && unit[0];
    snprintf(text[0], TEXT_SIZE, "%s%s%s, %s at theta %.4g°, azimuth %.4g°, all %s", dif_quantity_name(map->quantity),
             has_unit ? " in " : "", has_unit ? unit : "", map->fixed_is_wo ? "detector" : "light", theta_deg, phi_deg,
             map->fixed_is_wo ? "lights" : "detectors");
    snprintf(text[1], TEXT_SIZE, "%.6g-%.6g nm (%d), D65; exposure %.3g%s, %s", from_nm, to_nm, map->n_lambda, exposure,
             look->exposure > 0.0 ? "" : " (auto)", dif_gamut_name(look->gamut));
    snprintf(text[2], TEXT_SIZE, "theta rings every 15°; + %s, o mirror direction",
             map->fixed_is_wo ? "detector" : "light");
    for (int i = 0; i < CAPTION_LINES; i++) {
        dif_mark *mark = add_text(p, 0.8 * p->capital, p->nx + (1.9 * i - 0.9) * p->capital, text[i]);
        mark->anchor_x = 0.0;
        mark->width_max = p->nx - 1.6 * p->capital;
    }
}

static void fill(const picture *p, double exposure, dif_gamut gamut, uint8_t *rgb)
{
    const dif_map_image *map = p->map;
    memset(rgb, GROUND, 3 * (size_t)p->nx * (size_t)p->ny);
    for (int iy = 0; iy < p->side; iy++)
        for (int ix = 0; ix < p->side; ix++) {
            const int mx = ix / p->enlarge, my = iy / p->enlarge, n = map->n_pixel;
            const double x = (2.0 * mx + 1.0) / n - 1.0, y = 1.0 - (2.0 * my + 1.0) / n;
            double xyz[3];
            if (x * x + y * y >= 1.0)
                continue;
            xyz_at(map, (size_t)my * (size_t)n + (size_t)mx, xyz);
            dif_colour_pixel(xyz, exposure, gamut,
                             rgb + 3 * ((size_t)(iy + p->margin) * (size_t)p->nx + (size_t)(ix + p->margin)));
        }
}

dif_status dif_map_draw(const dif_map_image *map, const dif_map_look *look, uint8_t **rgb, int *nx, int *ny,
                        dif_error *err)
{
    picture p = picture_of(map);
    const double exposure = look->exposure > 0.0 ? look->exposure : dif_map_exposure(map);
    *nx = p.nx;
    *ny = p.ny;
    *rgb = dif_alloc(3 * (size_t)p.nx, (size_t)p.ny);
    if (!*rgb)
        return dif_fail(err, DIF_ERR_NOMEM, "picture of %d x %d pixels", p.nx, p.ny);
    fill(&p, exposure, look->gamut, *rgb);
    add_axes(&p);
    add_directions(&p);
    add_caption(&p, exposure, look);
    const dif_status status = dif_image_draw(*rgb, p.nx, p.ny, p.n_mark, p.mark, err);
    if (status) {
        dif_release(*rgb);
        *rgb = NULL;
    }
    return status;
}

dif_status dif_map_write_png(const char *path, const dif_map_image *map, const dif_map_look *look,
                             const dif_manifest *manifest, dif_error *err)
{
    uint8_t *rgb = NULL;
    unsigned char *png = NULL;
    size_t n = 0;
    int nx = 0, ny = 0;
    dif_status status = dif_map_draw(map, look, &rgb, &nx, &ny, err);
    if (!status)
        status = dif_image_encode_png(rgb, nx, ny, &png, &n, err);
    if (!status)
        status = dif_png_add_texts(manifest, &png, &n, err);
    if (!status)
        status = dif_file_write(path, png, n, err);
    dif_release(rgb);
    dif_release(png);
    return status;
}
