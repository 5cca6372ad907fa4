/* All filters of a rendering against many samples a pixel, from near to far. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/csv_out.h"
#include "bench/cli/render.h"
#include "bench/filter_study.h"
#include "core/alloc.h"
#include "core/io/image_cv.h"

/* Frames are the filters', the truth and the truth again; then come differences of all but the truth. */
enum { ZOOMS = 4, TRUTH = 3, AGAIN = 4, FILTERS = 5, FRAMES = 9, COLUMNS = 8, LABEL = 64 };
static const int SHOWN[COLUMNS] = {0, 1, 2, TRUTH, 5, 6, 7, 8};
static const double ZOOM[ZOOMS] = {1.0, 4.0, 16.0, 64.0};
static const char *const NAMES[FILTERS] = {"none", "mip", "slopes", "supersample", "truth again"};
static const double DE_WHITE = 20.0; /* of the difference pictures */

typedef struct study {
    dif_frame frame[ZOOMS][FRAMES], both; /* both: mean of the truths of a zoom */
    char label[ZOOMS][FRAMES][LABEL], note[ZOOMS][FRAMES][LABEL];
    dif_frame_difference difference[ZOOMS][FILTERS], from_both[ZOOMS][FILTERS];
    dif_shade_reads reads[ZOOMS][FILTERS];
    double seconds[ZOOMS][FILTERS], exposure[ZOOMS];
    float *map;
} study;

static dif_status draw_one(const dif_render_args *args, const dif_render_source *source,
                           const dif_render_engine *engine, const dif_scene *scene, int zoom, int filter, study *s,
                           dif_error *err)
{
    dif_render_args asked = *args;
    dif_meso meso = source->meso;
    asked.filter = filter < TRUTH ? filter : DIF_RENDER_SUPERSAMPLE;
    asked.n_sub = filter < TRUTH ? 1 : args->n_sub;
    meso.tiles *= ZOOM[zoom];
    dif_shade_opts how = dif_render_shade_opts(&asked, source, engine, NULL);
    how.meso = &meso;
    how.seed = filter == AGAIN;
    how.reads = &s->reads[zoom][filter];
    const double since_s = omp_get_wtime();
    const dif_status status = dif_shade_draw(scene, &engine->evaluator, &how, &s->frame[zoom][filter], NULL, err);
    s->seconds[zoom][filter] = omp_get_wtime() - since_s;
    return status;
}

/* A difference as a picture: OpenCV's inferno, 0 ... DE_WHITE. */
static dif_status paint_difference(const float *map, const dif_frame *truth, dif_frame *out, dif_error *err)
{
    uint8_t colours[256][3];
    const size_t n = (size_t)out->nx * (size_t)out->ny;
    const dif_status status = dif_image_colormap("inferno", colours, err);
    for (size_t i = 0; i < n && !status; i++) {
        const int at = (int)(255.0 * fmin((double)map[i] / DE_WHITE, 1.0) + 0.5);
        out->coverage[i] = truth->coverage[i];
        for (size_t c = 0; c < 3; c++)
            out->base[3 * i + c] = out->coverage[i] * (float)dif_colour_decode(colours[at][c] / 255.0);
    }
    return status;
}

static void average(const dif_frame *a, const dif_frame *b, dif_frame *out)
{
    const size_t n = (size_t)out->nx * (size_t)out->ny;
    for (size_t i = 0; i < 3 * n; i++) {
        out->light[i] = 0.5F * (a->light[i] + b->light[i]);
        out->base[i] = 0.5F * (a->base[i] + b->base[i]);
    }
    for (size_t i = 0; i < n; i++)
        out->coverage[i] = fminf(a->coverage[i], b->coverage[i]); /* whole where both are */
}

/* One filter against the truth, as numbers and as a picture. */
static dif_status compare_one(study *s, int zoom, int f, dif_error *err)
{
    const dif_frame *truth = &s->frame[zoom][TRUTH];
    dif_frame_difference *d = &s->difference[zoom][f];
    const dif_shade_reads *reads = &s->reads[zoom][f];
    const int to = FILTERS + (f < TRUTH ? f : f - 1);
    dif_status status =
        dif_frame_differ(&s->frame[zoom][f], &s->both, s->exposure[zoom], NULL, &s->from_both[zoom][f], err);
    if (!status)
        status = dif_frame_differ(&s->frame[zoom][f], truth, s->exposure[zoom], s->map, d, err);
    snprintf(s->label[zoom][f], LABEL, "%s, zoom %g", NAMES[f], ZOOM[zoom]);
    snprintf(s->note[zoom][f], LABEL, "reads %.1f + %.1f places", reads->table / fmax(reads->pixels, 1.0),
             reads->relief / fmax(reads->pixels, 1.0));
    if (f == TRUTH || status)
        return status;
    snprintf(s->label[zoom][to], LABEL, "%s - truth", NAMES[f]);
    snprintf(s->note[zoom][to], LABEL, "dE mean %.1f, p95 %.1f, blurred %.1f", d->mean, d->p95, d->blurred_mean);
    return paint_difference(s->map, truth, &s->frame[zoom][to], err);
}

static dif_status compare(study *s, int zoom, dif_error *err)
{
    const dif_frame *truth = &s->frame[zoom][TRUTH];
    dif_status status = DIF_OK;
    s->exposure[zoom] = dif_frame_exposure(truth, DIF_FRAME_EXPOSURE_SHARE);
    average(truth, &s->frame[zoom][AGAIN], &s->both);
    for (int f = 0; f < FILTERS && !status; f++)
        status = compare_one(s, zoom, f, err);
    return status;
}

static void print_csv(FILE *stream, const study *s, const dif_manifest *manifest)
{
    dif_csv_out_provenance(stream, manifest);
    fprintf(stream,
            "zoom,filter,pixels,de2000_median,de2000_mean,de2000_p95,de2000_worst,de2000_blurred_mean,light_ratio,"
            "de2000_mean_from_both,de2000_blurred_mean_from_both,light_ratio_from_both,"
            "table_places_per_pixel,relief_places_per_pixel,exposure\n");
    for (int z = 0; z < ZOOMS; z++)
        for (int f = 0; f < FILTERS; f++) {
            const dif_frame_difference *d = &s->difference[z][f], *both = &s->from_both[z][f];
            const dif_shade_reads *reads = &s->reads[z][f];
            const double n = fmax(reads->pixels, 1.0);
            fprintf(stream, "%g,%s,%d,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%.4g,%.6g\n", ZOOM[z], NAMES[f],
                    d->n, d->median, d->mean, d->p95, d->worst, d->blurred_mean, d->light_ratio, both->mean,
                    both->blurred_mean, both->light_ratio, reads->table / n, reads->relief / n, s->exposure[z]);
        }
}

static dif_status write_all(const dif_render_args *args, const study *s, const dif_manifest *manifest, dif_error *err)
{
    dif_sheet_cell cell[ZOOMS * COLUMNS];
    char path[4096];
    dif_csv_out out = {0};
    const dif_frame_look look = {.exposure = 1.0, .gamut = (dif_gamut)args->gamut, .ground = args->ground};
    for (int z = 0; z < ZOOMS; z++)
        for (int c = 0; c < COLUMNS; c++)
            cell[z * COLUMNS + c] =
                (dif_sheet_cell){&s->frame[z][SHOWN[c]], s->exposure[z], s->label[z][SHOWN[c]], s->note[z][SHOWN[c]]};
    snprintf(path, sizeof path, "%.4000s/filters.png", args->study);
    dif_status status = dif_frame_write_sheet(path, ZOOMS * COLUMNS, cell, COLUMNS, &look, manifest, err);
    snprintf(path, sizeof path, "%.4000s/filters.csv", args->study);
    if (!status)
        status = dif_csv_out_open(path, &out, err);
    if (status)
        return status;
    print_csv(out.stream, s, manifest);
    return dif_csv_out_close(&out, err);
}

static void say(const dif_cli *cli, const study *s)
{
    for (int z = 0; z < ZOOMS; z++)
        for (int f = 0; f < FILTERS; f++) {
            const dif_frame_difference *d = &s->difference[z][f];
            dif_cli_say(cli,
                        "zoom %2g %-11s dE2000 mean %5.2f p95 %6.2f, blurred %5.2f (of both truths %5.2f, %5.2f); "
                        "light %.3f; %.2f s",
                        ZOOM[z], NAMES[f], d->mean, d->p95, d->blurred_mean, s->from_both[z][f].mean,
                        s->from_both[z][f].blurred_mean, d->light_ratio, s->seconds[z][f]);
        }
}

dif_status dif_render_study(const dif_cli *cli, const dif_render_args *args, const dif_render_source *source,
                            const dif_render_scene *scene, const dif_render_engine *engine,
                            const dif_manifest *manifest, dif_error *err)
{
    dif_progress progress = dif_progress_begin("filters", cli->quiet);
    const size_t n = (size_t)scene->nx * (size_t)scene->ny;
    study *s = dif_alloc(1, sizeof *s);
    if (!s)
        return dif_fail(err, DIF_ERR_NOMEM, "a study of filters");
    s->map = dif_alloc(n, sizeof *s->map);
    dif_status status = s->map ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "%zu pixels", n);
    if (!status)
        status = dif_frame_create(scene->nx, scene->ny, &s->both, err);
    for (int i = 0; i < ZOOMS * FRAMES && !status; i++)
        status = dif_frame_create(scene->nx, scene->ny, &s->frame[i / FRAMES][i % FRAMES], err);
    for (int z = 0; z < ZOOMS && !status; z++) {
        for (int f = 0; f < FILTERS && !status; f++) {
            status = draw_one(args, source, engine, &scene->scene, z, f, s, err);
            dif_progress_draw(&progress, (z + (f + 1.0) / FILTERS) / ZOOMS);
        }
        if (!status)
            status = compare(s, z, err);
    }
    dif_progress_end(&progress);
    if (!status)
        status = write_all(args, s, manifest, err);
    if (!status)
        say(cli, s);
    for (int i = 0; i < ZOOMS * FRAMES; i++)
        dif_frame_free(&s->frame[i / FRAMES][i % FRAMES]);
    dif_frame_free(&s->both);
    dif_release(s->map);
    dif_release(s);
    return status;
}
