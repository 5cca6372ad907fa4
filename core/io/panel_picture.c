#include "core/io/panel_picture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/io/image_head.h"
#include "core/units.h"

enum { CAPITAL = 9, SIDE_MIN = 64, SIDE_MAX = 4096, PANEL_MAX = 64, ELLIPSE_LINES = 72 };
enum { LEFT = 52, RIGHT = 14, ABOVE = 26, AXIS = 20, NOTE = 17, HEADING = 30 };

static const uint8_t GROUND[3] = {255, 255, 255}, INK[3] = {30, 30, 30}, EMPTY[3] = {232, 232, 232};
static const uint8_t LINE[3] = {255, 255, 255};

/* A sheet being drawn: where its cells lie. */
typedef struct layout {
    const dif_panel_sheet *sheet;
    int cell_nx, cell_ny, top, nx, ny; /* a panel with its margins; the whole */
    uint8_t (*colour)[3];              /* colour[256]                          */
    uint8_t *rgb;
} layout;

static bool has_axes(const dif_panel *panel)
{
    return panel->x_max > panel->x_min && panel->y_max > panel->y_min;
}

/* Pixels of a panel's picture: the longer side as asked; blocks of whole pixels if they are not smaller than one. */
static void size_of(const dif_panel *panel, int side, int *nx, int *ny)
{
    const int longer = panel->nx > panel->ny ? panel->nx : panel->ny;
    const double scale = longer <= side ? floor((double)side / longer) : (double)side / longer;
    *nx = (int)fmax(floor(panel->nx * scale), 1.0);
    *ny = (int)fmax(floor(panel->ny * scale), 1.0);
}

static int notes_of(const dif_panel_sheet *sheet)
{
    int n = 0;
    for (int i = 0; i < sheet->n_panel; i++)
        for (int k = 0; k < 2; k++)
            n = sheet->panel[i].note[k][0] && n < k + 1 ? k + 1 : n;
    return n;
}

static layout layout_of(const dif_panel_sheet *sheet)
{
    layout out = {.sheet = sheet, .top = sheet->heading ? HEADING : 0};
    for (int i = 0; i < sheet->n_panel; i++) {
        int nx, ny;
        size_of(sheet->panel + i, sheet->side, &nx, &ny);
        out.cell_nx = nx > out.cell_nx ? nx : out.cell_nx;
        out.cell_ny = ny > out.cell_ny ? ny : out.cell_ny;
    }
    const int n_row = (sheet->n_panel + sheet->n_column - 1) / sheet->n_column;
    out.cell_nx += LEFT + RIGHT;
    out.cell_ny += ABOVE + AXIS + NOTE * notes_of(sheet) + 6;
    out.nx = out.cell_nx * sheet->n_column;
    out.ny = out.top + out.cell_ny * n_row;
    return out;
}

static dif_status check(const dif_panel_sheet *sheet, dif_error *err)
{
    if (!(sheet->n_panel >= 1 && sheet->n_panel <= PANEL_MAX && sheet->n_column >= 1 && sheet->n_column <= PANEL_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d panels in %d columns, want 1 ... %d", sheet->n_panel, sheet->n_column,
                        PANEL_MAX);
    if (!(sheet->side >= SIDE_MIN && sheet->side <= SIDE_MAX))
        return dif_fail(err, DIF_ERR_ARG, "panels of %d pixels, want %d ... %d", sheet->side, SIDE_MIN, SIDE_MAX);
    for (int i = 0; i < sheet->n_panel; i++) {
        const dif_panel *panel = sheet->panel + i;
        if (!(panel->nx >= 1 && panel->ny >= 1 && (panel->value || panel->rgb)))
            return dif_fail(err, DIF_ERR_ARG, "panel %d is empty", i + 1);
        if (panel->value && !(panel->low < panel->high && (!panel->is_log || panel->low > 0.0)))
            return dif_fail(err, DIF_ERR_ARG, "panel %d: colours from %g to %g", i + 1, panel->low, panel->high);
    }
    return DIF_OK;
}

static const uint8_t *colour_of(const layout *sheet, const dif_panel *panel, size_t at)
{
    if (panel->rgb)
        return panel->rgb + 3 * at;
    const double value = (double)panel->value[at];
    if (isnan(value))
        return EMPTY;
    const double share = panel->is_log ? log(fmax(value, panel->low) / panel->low) / log(panel->high / panel->low)
                                       : (value - panel->low) / (panel->high - panel->low);
    return sheet->colour[(int)(255.0 * fmin(fmax(share, 0.0), 1.0) + 0.5)];
}

static void paint(const layout *sheet, const dif_panel *panel, int x0, int y0, int nx, int ny)
{
    for (int iy = 0; iy < ny; iy++)
        for (int ix = 0; ix < nx; ix++) {
            const size_t at =
                (size_t)((long)iy * panel->ny / ny) * (size_t)panel->nx + (size_t)((long)ix * panel->nx / nx);
            memcpy(sheet->rgb + 3 * ((size_t)(y0 + iy) * (size_t)sheet->nx + (size_t)(x0 + ix)),
                   colour_of(sheet, panel, at), 3);
        }
}

static dif_mark text_at(double x, double y, double anchor_x, const char *text)
{
    dif_mark mark = {.kind = DIF_MARK_TEXT,
                     .x = x,
                     .y = y,
                     .size = CAPITAL,
                     .anchor_x = anchor_x,
                     .anchor_y = 0.5,
                     .stroke = 1,
                     .text = text};
    memcpy(mark.rgb, INK, 3);
    return mark;
}

/* The numbers at the ends of both axes, title and notes. */
static dif_status draw_texts(const layout *sheet, const dif_panel *panel, int x0, int y0, int nx, int ny,
                             dif_error *err)
{
    dif_mark mark[8];
    char number[4][24];
    int n = 0;
    if (panel->title)
        mark[n++] = text_at(x0 + 0.5 * nx, y0 - 0.5 * ABOVE, 0.5, panel->title);
    if (has_axes(panel)) {
        const double end[4] = {panel->x_min, panel->x_max, panel->y_min, panel->y_max};
        for (int i = 0; i < 4; i++)
            snprintf(number[i], sizeof number[i], "%.3g", end[i]);
        mark[n++] = text_at(x0, y0 + ny + 0.5 * AXIS, 0.0, number[0]);
        mark[n++] = text_at(x0 + nx, y0 + ny + 0.5 * AXIS, 1.0, number[1]);
        mark[n++] = text_at(x0 - 5.0, y0 + ny - CAPITAL, 1.0, number[2]);
        mark[n++] = text_at(x0 - 5.0, y0 + CAPITAL, 1.0, number[3]);
    }
    for (int k = 0; k < 2; k++)
        if (panel->note[k][0])
            mark[n++] = text_at(x0 + 0.5 * nx, y0 + ny + AXIS + NOTE * (k + 0.5), 0.5, panel->note[k]);
    for (int i = 0; i < n; i++)
        mark[i].width_max = mark[i].anchor_x == 0.5 ? nx + 2.0 * RIGHT - 4.0 : 0.0;
    return dif_image_draw(sheet->rgb, sheet->nx, sheet->ny, n, mark, err);
}

/* One standard deviation of a covariance, as short lines; what leaves the panel is left out. */
static dif_status draw_ellipse(const layout *sheet, const dif_panel *panel, const double e[5], int x0, int y0, int nx,
                               int ny, dif_error *err)
{
    dif_mark mark[ELLIPSE_LINES];
    int n = 0;
    /* the root of the covariance: lower triangle */
    const double a = sqrt(fmax(e[2], 0.0)), b = a > 0.0 ? e[4] / a : 0.0, c = sqrt(fmax(e[3] - b * b, 0.0));
    double px = 0.0, py = 0.0;
    bool was_inside = false;
    for (int i = 0; i <= ELLIPSE_LINES; i++) {
        const double t = DIF_TWO_PI * i / ELLIPSE_LINES;
        const double x = e[0] + a * cos(t), y = e[1] + b * cos(t) + c * sin(t);
        const double qx = x0 + nx * (x - panel->x_min) / (panel->x_max - panel->x_min) - 0.5;
        const double qy = y0 + ny * (panel->y_max - y) / (panel->y_max - panel->y_min) - 0.5;
        const bool inside = qx >= x0 && qx < x0 + nx && qy >= y0 && qy < y0 + ny;
        if (inside && was_inside && n < ELLIPSE_LINES) {
            mark[n] = (dif_mark){.kind = DIF_MARK_LINE, .x = px, .y = py, .x1 = qx, .y1 = qy, .stroke = 1};
            memcpy(mark[n++].rgb, LINE, 3);
        }
        px = qx;
        py = qy;
        was_inside = inside;
    }
    return dif_image_draw(sheet->rgb, sheet->nx, sheet->ny, n, mark, err);
}

static dif_status draw_panel(const layout *sheet, int i, dif_error *err)
{
    const dif_panel *panel = sheet->sheet->panel + i;
    int nx, ny;
    size_of(panel, sheet->sheet->side, &nx, &ny);
    const int x0 = (i % sheet->sheet->n_column) * sheet->cell_nx + LEFT;
    const int y0 = sheet->top + (i / sheet->sheet->n_column) * sheet->cell_ny + ABOVE;
    paint(sheet, panel, x0, y0, nx, ny);
    dif_status status = draw_texts(sheet, panel, x0, y0, nx, ny, err);
    for (int k = 0; k < panel->n_ellipse && !status && has_axes(panel); k++)
        status = draw_ellipse(sheet, panel, panel->ellipse[k], x0, y0, nx, ny, err);
    return status;
}

dif_status dif_panel_draw(const dif_panel_sheet *sheet, uint8_t **rgb, int *nx, int *ny, dif_error *err)
{
    uint8_t colour[256][3];
    *rgb = NULL;
    dif_status status = check(sheet, err);
    if (!status)
        status = dif_image_colormap(sheet->colour_map, colour, err);
    if (status)
        return status;
    layout out = layout_of(sheet);
    out.colour = colour;
    *nx = out.nx;
    *ny = out.ny;
    const size_t n = (size_t)out.nx * (size_t)out.ny;
    out.rgb = dif_alloc(n, 3);
    if (!out.rgb)
        return dif_fail(err, DIF_ERR_NOMEM, "picture of %d x %d pixels", out.nx, out.ny);
    for (size_t i = 0; i < n; i++)
        memcpy(out.rgb + 3 * i, GROUND, 3);
    if (sheet->heading) {
        dif_mark mark = text_at(0.5 * out.nx, 0.5 * HEADING, 0.5, sheet->heading);
        mark.width_max = out.nx - 12.0;
        status = dif_image_draw(out.rgb, out.nx, out.ny, 1, &mark, err);
    }
    for (int i = 0; i < sheet->n_panel && !status; i++)
        status = draw_panel(&out, i, err);
    if (status)
        dif_release(out.rgb);
    else
        *rgb = out.rgb;
    return status;
}

dif_status dif_panel_write_png(const char *path, const dif_panel_sheet *sheet, const dif_manifest *manifest,
                               dif_error *err)
{
    uint8_t *rgb = NULL;
    unsigned char *png = NULL;
    size_t n = 0;
    int nx = 0, ny = 0;
    dif_status status = dif_panel_draw(sheet, &rgb, &nx, &ny, err);
    if (!status)
        status = dif_image_encode_png(rgb, nx, ny, &png, &n, err);
    if (!status && manifest)
        status = dif_png_add_texts(manifest, &png, &n, err);
    if (!status)
        status = dif_file_write(path, png, n, err);
    dif_release(rgb);
    dif_release(png);
    return status;
}
