#include "bench/cli/view_figure.h"

#include <math.h>
#include <stdio.h>

#include "bench/cli/cli.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/io/image_cv.h"
#include "core/io/image_head.h"
#include "core/io/panel_picture.h"

enum { SIDE_MIN = 330, SIDE_MAX = 1332 };

void dif_view_set_free(dif_view_set *set)
{
    for (int i = 0; i < DIF_VIEW_FILTERS; i++)
        dif_view_free(set->view + i);
}

static dif_status make_views(const dif_field *field, const char *colour_map, const dif_view_plan *plan, unsigned wanted,
                             dif_view_set *set, dif_error *err)
{
    dif_pyramid pyramid;
    dif_transfer transfer = {0};
    /* a flat surface has one colour, that of the map's beginning */
    const double high_um = set->high_um > set->low_um ? set->high_um : set->low_um + 1.0;
    dif_status status = dif_pyramid_create(field, set->low_um, high_um, &pyramid, err);
    if (!status)
        status = dif_view_transfer(colour_map, &transfer, err);
    for (int i = 0; i < DIF_VIEW_FILTERS && !status; i++)
        if (wanted & 1u << i)
            status = dif_view_make(&pyramid, field->pitch_y_um / field->pitch_x_um, &transfer, plan, (dif_view_filter)i,
                                   set->view + i, err);
    dif_transfer_free(&transfer);
    dif_pyramid_free(&pyramid);
    return status;
}

dif_status dif_view_set_make(const dif_field *field, const char *colour_map, const dif_view_plan *plan, unsigned wanted,
                             dif_view_set *out, dif_error *err)
{
    dif_field_stats stats;
    *out = (dif_view_set){.n_sample = plan->n_sample};
    dif_status status = dif_field_stats_of(field, &stats, err);
    if (status)
        return status;
    out->low_um = stats.min_um;
    out->high_um = stats.max_um;
    status = make_views(field, colour_map, plan, wanted, out, err);
    for (int i = 0; i < DIF_VIEW_TRUTH && !status && wanted == DIF_VIEW_ALL; i++)
        status = dif_view_compare(out->view + i, out->view + DIF_VIEW_TRUTH, out->difference + i, err);
    if (status)
        dif_view_set_free(out);
    return status;
}

static uint8_t *encoded(const dif_view *view, dif_error *err)
{
    uint8_t *rgb = dif_alloc((size_t)view->nx * (size_t)view->ny, 3);
    if (rgb)
        dif_view_encode(view, rgb);
    else
        (void)dif_fail(err, DIF_ERR_NOMEM, "picture of %d x %d pixels", view->nx, view->ny);
    return rgb;
}

dif_status dif_view_write_png(const char *path, const dif_view *view, const dif_manifest *manifest, dif_error *err)
{
    uint8_t *rgb = encoded(view, err);
    unsigned char *png = NULL;
    size_t n = 0;
    dif_status status = rgb ? dif_image_encode_png(rgb, view->nx, view->ny, &png, &n, err) : DIF_ERR_NOMEM;
    if (!status)
        status = dif_png_add_texts(manifest, &png, &n, err);
    if (!status)
        status = dif_file_write(path, png, n, err);
    dif_release(rgb);
    dif_release(png);
    return status;
}

dif_status dif_view_set_write_png(const char *path, const dif_view_set *set, double zoom, const dif_manifest *manifest,
                                  dif_error *err)
{
    static const char *const titles[] = {"no filter", "mean height (plain mip-mapping)", "mean and variance of height",
                                         "truth"};
    dif_panel panel[DIF_VIEW_FILTERS];
    uint8_t *rgb[DIF_VIEW_FILTERS] = {NULL};
    char heading[96];
    dif_status status = DIF_OK;
    const int longer = set->view[0].nx > set->view[0].ny ? set->view[0].nx : set->view[0].ny;
    for (int i = 0; i < DIF_VIEW_FILTERS && !status; i++) {
        rgb[i] = encoded(set->view + i, err);
        status = rgb[i] ? DIF_OK : DIF_ERR_NOMEM;
        panel[i] = (dif_panel){.nx = set->view[i].nx, .ny = set->view[i].ny, .rgb = rgb[i], .title = titles[i]};
        if (i < DIF_VIEW_TRUTH)
            snprintf(panel[i].note[0], DIF_PANEL_TEXT, "dE2000 mean %.3g, p95 %.3g, worst %.3g",
                     set->difference[i].de_mean, set->difference[i].de_p95, set->difference[i].de_worst);
        else
            snprintf(panel[i].note[0], DIF_PANEL_TEXT, "%d x %d jittered samples a pixel", set->n_sample,
                     set->n_sample);
    }
    snprintf(heading, sizeof heading, "zoom %.4g (%.4g samples a pixel)", zoom, 1.0 / zoom);
    const dif_panel_sheet sheet = {.n_panel = DIF_VIEW_FILTERS,
                                   .n_column = DIF_VIEW_FILTERS,
                                   .panel = panel,
                                   .heading = heading,
                                   .colour_map = "viridis",
                                   .side = longer < SIDE_MIN   ? SIDE_MIN
                                           : longer > SIDE_MAX ? SIDE_MAX
                                                               : longer};
    if (!status)
        status = dif_panel_write_png(path, &sheet, manifest, err);
    for (int i = 0; i < DIF_VIEW_FILTERS; i++)
        dif_release(rgb[i]);
    return status;
}

json_t *dif_view_difference_json(const dif_view_set *set, int filter)
{
    const dif_view_difference *d = &set->difference[filter];
    return json_pack("{s:I, s:f, s:f, s:f, s:f, s:f, s:f}", "pixels", (json_int_t)d->n, "de_mean", d->de_mean,
                     "de_median", d->de_median, "de_p95", d->de_p95, "de_worst", d->de_worst, "rms", d->rms, "reads",
                     set->view[filter].n_read);
}
