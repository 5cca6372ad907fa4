#include "core/io/frame_io.h"

#include <math.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/io/image_head.h"

enum { TEXTURE_BYTES_MAX = 1 << 30 };

dif_frame_look dif_frame_look_default(void)
{
    return (dif_frame_look){.exposure = 1.0, .gamut = DIF_GAMUT_DESATURATE, .ground = 0.01};
}

static size_t pixels_of(const dif_frame *frame)
{
    return (size_t)frame->nx * (size_t)frame->ny;
}

dif_status dif_frame_write(const char *path, const dif_frame *frame, const dif_frame_look *look,
                           const dif_manifest *manifest, dif_error *err)
{
    const size_t n = pixels_of(frame);
    unsigned char *data = NULL;
    size_t n_byte = 0;
    float *rgb = dif_alloc(3 * n, sizeof *rgb);
    if (!rgb)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu pixels", path, n);
    for (size_t i = 0; i < 3 * n; i++)
        rgb[i] = (float)look->exposure * frame->light[i] + frame->base[i];
    const dif_exr_layer layer[] = {{"R", rgb, 3}, {"G", rgb + 1, 3}, {"B", rgb + 2, 3}, {"A", frame->coverage, 1}};
    const dif_exr_image image = {
        .nx = frame->nx, .ny = frame->ny, .layer = layer, .n_layer = 4, .is_srgb = true, .manifest = manifest};
    dif_status status = dif_exr_encode(&image, &data, &n_byte, err);
    if (!status)
        status = dif_file_write(path, data, n_byte, err);
    dif_release(rgb);
    dif_release(data);
    return status;
}

void dif_frame_paint(const dif_frame *frame, const dif_frame_look *look, uint8_t *rgb)
{
    for (size_t i = 0; i < pixels_of(frame); i++) {
        double shown[3];
        const double open = 1.0 - fmin((double)frame->coverage[i], 1.0);
        for (size_t c = 0; c < 3; c++)
            shown[c] = look->exposure * (double)frame->light[3 * i + c] + (double)frame->base[3 * i + c];
        dif_colour_fit_gamut(look->gamut, shown);
        for (size_t c = 0; c < 3; c++)
            rgb[3 * i + c] = (uint8_t)(255.0 * dif_colour_encode(fmin(shown[c] + open * look->ground, 1.0)) + 0.5);
    }
}

static dif_status write_png(const char *path, const uint8_t *rgb, int nx, int ny, const dif_manifest *manifest,
                            dif_error *err)
{
    unsigned char *png = NULL;
    size_t n = 0;
    dif_status status = dif_image_encode_png(rgb, nx, ny, &png, &n, err);
    if (!status)
        status = dif_png_add_texts(manifest, &png, &n, err);
    if (!status)
        status = dif_file_write(path, png, n, err);
    dif_release(png);
    return status;
}

dif_status dif_frame_write_png(const char *path, const dif_frame *frame, const dif_frame_look *look,
                               const dif_manifest *manifest, dif_error *err)
{
    uint8_t *rgb = dif_alloc(pixels_of(frame), 3);
    if (!rgb)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %zu pixels", path, pixels_of(frame));
    dif_frame_paint(frame, look, rgb);
    const dif_status status = write_png(path, rgb, frame->nx, frame->ny, manifest, err);
    dif_release(rgb);
    return status;
}

/* Where things are on a contact sheet, in pixels. */
typedef struct layout {
    int nx, ny, gap, capital, caption, column, row; /* column, row: steps of the cells */
} layout;

static layout layout_of(int n_cell, const dif_sheet_cell *cell, int n_column)
{
    const int n_row = (n_cell + n_column - 1) / n_column;
    layout l = {.capital = cell->frame->ny / 30 > 8 ? cell->frame->ny / 30 : 8};
    l.gap = l.capital;
    l.caption = 5 * l.capital;
    l.column = cell->frame->nx + l.gap;
    l.row = cell->frame->ny + l.caption;
    l.nx = n_column * l.column + l.gap;
    l.ny = n_row * l.row + l.gap;
    return l;
}

static int add_label(const layout *l, int x, int y, const char *text, int line, int width, dif_mark *mark)
{
    if (!text)
        return 0;
    const double size = line == 0 ? l->capital : 0.75 * l->capital;
    *mark = (dif_mark){.kind = DIF_MARK_TEXT,
                       .x = x,
                       .y = y + (1.5 + 1.9 * line) * l->capital,
                       .size = size,
                       .anchor_y = 0.5,
                       .width_max = width,
                       .stroke = l->capital > 16 ? 2 : 1,
                       .rgb = {225, 225, 225},
                       .text = text};
    return 1;
}

static dif_status paint_sheet(const layout *l, int n_cell, const dif_sheet_cell *cell, int n_column,
                              const dif_frame_look *look, uint8_t *rgb, uint8_t *one, dif_mark *mark, dif_error *err)
{
    int n_mark = 0;
    memset(rgb, 34, 3 * (size_t)l->nx * (size_t)l->ny);
    for (int i = 0; i < n_cell; i++) {
        const dif_frame *frame = cell[i].frame;
        dif_frame_look shown = *look;
        const int x = l->gap + i % n_column * l->column, y = l->gap + i / n_column * l->row;
        shown.exposure = cell[i].exposure;
        dif_frame_paint(frame, &shown, one);
        for (int iy = 0; iy < frame->ny; iy++)
            memcpy(rgb + 3 * ((size_t)(y + iy) * (size_t)l->nx + (size_t)x), one + 3 * (size_t)iy * (size_t)frame->nx,
                   3 * (size_t)frame->nx);
        n_mark += add_label(l, x, y + frame->ny, cell[i].label, 0, frame->nx, mark + n_mark);
        n_mark += add_label(l, x, y + frame->ny, cell[i].note, 1, frame->nx, mark + n_mark);
    }
    return dif_image_draw(rgb, l->nx, l->ny, n_mark, mark, err);
}

dif_status dif_frame_write_sheet(const char *path, int n_cell, const dif_sheet_cell *cell, int n_column,
                                 const dif_frame_look *look, const dif_manifest *manifest, dif_error *err)
{
    if (n_cell < 1 || n_column < 1)
        return dif_fail(err, DIF_ERR_ARG, "%d cells in rows of %d", n_cell, n_column);
    const layout l = layout_of(n_cell, cell, n_column);
    uint8_t *rgb = dif_alloc(3 * (size_t)l.nx, (size_t)l.ny), *one = dif_alloc(pixels_of(cell->frame), 3);
    dif_mark *mark = dif_alloc(2 * (size_t)n_cell, sizeof *mark);
    dif_status status = rgb && one && mark
                            ? paint_sheet(&l, n_cell, cell, n_column, look, rgb, one, mark, err)
                            : dif_fail(err, DIF_ERR_NOMEM, "%s: a sheet of %d x %d pixels", path, l.nx, l.ny);
    if (!status)
        status = write_png(path, rgb, l.nx, l.ny, manifest, err);
    dif_release(rgb);
    dif_release(one);
    dif_release(mark);
    return status;
}

dif_status dif_texture_load(const char *path, dif_texture *out, dif_error *err)
{
    unsigned char *data = NULL;
    uint8_t *rgb = NULL;
    size_t n = 0;
    *out = (dif_texture){0};
    dif_status status = dif_file_read(path, TEXTURE_BYTES_MAX, &data, &n, err);
    if (!status) {
        status = dif_image_decode_rgb(data, n, &rgb, &out->nx, &out->ny, err);
        if (status)
            status = dif_fail_named(err, path, status);
    }
    const size_t n_value = 3 * (size_t)out->nx * (size_t)out->ny;
    if (!status) {
        out->rgb = dif_alloc(n_value, sizeof *out->rgb);
        status = out->rgb ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "%s: %d x %d pixels", path, out->nx, out->ny);
    }
    for (size_t i = 0; i < n_value && !status; i++)
        out->rgb[i] = (float)dif_colour_decode(rgb[i] / 255.0);
    dif_release(data);
    dif_release(rgb);
    if (status)
        *out = (dif_texture){0};
    return status;
}
