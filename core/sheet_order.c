#include <math.h>

#include "core/alloc.h"
#include "core/sheet_impl.h"

enum { TILE = 8 }; /* bins on a side: a tile and its tap margin fit the second-level cache */

static int tiles_of(const dif_axis *axis)
{
    return axis->n / TILE + 1;
}

static int tile_of(const dif_axis *axis, double kappa)
{
    double at = kappa / axis->step;
    if (axis->period)
        at -= axis->period * nearbyint(at / axis->period);
    const int tile = (int)floor((at - axis->first) / TILE), last = tiles_of(axis) - 1;
    return tile < 0 ? 0 : (tile > last ? last : tile);
}

static size_t tile_at(const dif_sheet *sheet, dif_vec3 kappa)
{
    return (size_t)tile_of(&sheet->s, kappa.x) * (size_t)tiles_of(&sheet->y) + (size_t)tile_of(&sheet->y, kappa.y);
}

dif_status dif_sheet_order(const dif_sheet *sheet, size_t n, const dif_vec3 *kappa, size_t *order, dif_error *err)
{
    const size_t n_tile = (size_t)tiles_of(&sheet->s) * (size_t)tiles_of(&sheet->y);
    size_t *next = dif_alloc(n_tile + 1, sizeof *next);
    if (!next)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory to order %zu points", n);
    for (size_t i = 0; i < n; i++)
        next[tile_at(sheet, kappa[i]) + 1]++;
    for (size_t t = 0; t < n_tile; t++)
        next[t + 1] += next[t];
    for (size_t i = 0; i < n; i++)
        order[next[tile_at(sheet, kappa[i])]++] = i;
    dif_release(next);
    return DIF_OK;
}
