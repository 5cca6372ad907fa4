/* Frames: lifetime and exposure. */
#include <math.h>

#include "core/alloc.h"
#include "core/shade.h"

dif_status dif_frame_create(int nx, int ny, dif_frame *out, dif_error *err)
{
    *out = (dif_frame){0};
    if (!(nx >= 1 && ny >= 1 && nx <= DIF_FRAME_SIDE_MAX && ny <= DIF_FRAME_SIDE_MAX))
        return dif_fail(err, DIF_ERR_SIZE, "a picture of %d x %d pixels, want 1 ... %d a side", nx, ny,
                        DIF_FRAME_SIDE_MAX);
    const size_t n = (size_t)nx * (size_t)ny;
    *out = (dif_frame){.nx = nx, .ny = ny};
    out->light = dif_alloc(3 * n, sizeof *out->light);
    out->base = dif_alloc(3 * n, sizeof *out->base);
    out->coverage = dif_alloc(n, sizeof *out->coverage);
    if (out->light && out->base && out->coverage)
        return DIF_OK;
    dif_frame_free(out);
    return dif_fail(err, DIF_ERR_NOMEM, "a picture of %d x %d pixels", nx, ny);
}

void dif_frame_free(dif_frame *frame)
{
    dif_release(frame->light);
    dif_release(frame->base);
    dif_release(frame->coverage);
    *frame = (dif_frame){0};
}

double dif_frame_exposure(const dif_frame *frame, double share)
{
    enum { LEVELS = 8000, PER_E = 100 }; /* of 1 % */
    const size_t n = (size_t)frame->nx * (size_t)frame->ny;
    double n_covered = 0.0, n_lit = 0.0, n_above = 0.0, count[LEVELS] = {0.0};
    for (size_t i = 0; i < n; i++) {
        const float *rgb = frame->light + 3 * i;
        const double level = (double)fmaxf(rgb[0], fmaxf(rgb[1], rgb[2])), bin = PER_E * log(level) + 0.5 * LEVELS;
        n_covered += frame->coverage[i] > 0.0F;
        if (!(level > 0.0 && bin >= 0.0 && bin < LEVELS))
            continue;
        count[(int)bin] += 1.0;
        n_lit += 1.0;
    }
    const double n_white = share * (n_lit < 2.0 * share * n_covered ? n_lit : n_covered);
    int bin = LEVELS;
    while (bin > 0 && n_above <= n_white)
        n_above += count[--bin];
    return n_lit > 0.0 ? exp((0.5 * LEVELS - bin) / PER_E) : 1.0;
}
