#include "core/io/lut_io.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "core/io/number.h"

#define ATTRIBUTE(key) DIF_EXR_PREFIX key
#define LAYOUT         "lut: x = azimuth, y = radius"
enum { CHANNEL_MAX = 3 * DIF_LUT_MAP_MAX, CHANNEL_SIZE = 16 };
enum { AZIMUTH_MIN = 16, AZIMUTH_MAX = 16384, RADIUS_MIN = 8, RADIUS_MAX = 4096 };
static const size_t FILE_MAX = (size_t)1 << 33;

typedef struct channel_names {
    char name[CHANNEL_MAX][CHANNEL_SIZE];
} channel_names;

static channel_names names_of(int n_map)
{
    channel_names names = {.name = {{0}}};
    for (int i = 0; i < 3 * n_map; i++)
        snprintf(names.name[i], CHANNEL_SIZE, "c%02d.%c", i / 3 % 100, "XYZ"[i % 3]);
    return names;
}

dif_status dif_lut_write(const char *path, const dif_lut *lut, const dif_manifest *manifest, dif_error *err)
{
    const int n_channel = 3 * lut->n_map;
    const channel_names names = names_of(lut->n_map);
    dif_exr_layer layer[CHANNEL_MAX];
    char n_map[DIF_NUMBER_SIZE], s0[DIF_NUMBER_SIZE], tail[DIF_NUMBER_SIZE];
    for (int i = 0; i < n_channel; i++)
        layer[i] = (dif_exr_layer){names.name[i], lut->coef + i, n_channel};
    dif_number_print(lut->n_map, 3, n_map);
    dif_number_print(lut->s0, 17, s0);
    dif_number_print(lut->tail, 17, tail);
    const dif_exr_attribute attributes[] = {
        {ATTRIBUTE("layout"), LAYOUT, 0.0},
        {ATTRIBUTE("lut_version"), DIF_LUT_VERSION, 0.0},
        {ATTRIBUTE("n_map"), n_map, 0.0},
        {ATTRIBUTE("s0"), s0, 0.0},
        {ATTRIBUTE("tail"), tail, 0.0},
        {ATTRIBUTE("x_axis"), "azimuth of (u, v) = 2 pi ix / nx", 0.0},
        {ATTRIBUTE("y_axis"), "sqrt(u^2 + v^2) = s0 sinh(iy asinh(2 / s0) / (ny - 1)), row 0 at the mirror direction",
         0.0},
        {ATTRIBUTE("value"), "XYZ of the power = sum_n c_n T_n(t), t = 2 |w| / sqrt(4 - u^2 - v^2) - 1", 0.0},
    };
    const dif_exr_image image = {.nx = lut->n_azimuth,
                                 .ny = lut->n_radius,
                                 .layer = layer,
                                 .n_layer = n_channel,
                                 .is_plain = true,
                                 .attribute = attributes,
                                 .n_attribute = sizeof attributes / sizeof *attributes,
                                 .manifest = manifest};
    unsigned char *data = NULL;
    size_t n = 0;
    dif_status status = dif_exr_encode(&image, &data, &n, err);
    if (!status)
        status = dif_file_write(path, data, n, err);
    dif_release(data);
    return status;
}

static bool number_in(const dif_exr *exr, const char *name, double low, double high, double *value)
{
    *value = NAN;
    return dif_exr_number(exr, name, value) && *value >= low && *value <= high;
}

/* What the attributes say, checked. */
static dif_status read_head(const dif_source *source, const dif_exr *exr, dif_lut *lut, dif_error *err)
{
    const char *layout = dif_exr_text(exr, ATTRIBUTE("layout")), *version = dif_exr_text(exr, ATTRIBUTE("lut_version"));
    double n_map = NAN;
    dif_exr_size(exr, &lut->n_azimuth, &lut->n_radius);
    if (!layout || strcmp(layout, LAYOUT) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: not a table that `lut` writes (attribute %s)", source->name,
                        ATTRIBUTE("layout"));
    if (!version || strcmp(version, DIF_LUT_VERSION) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: table of version %.20s, want %s: build it again", source->name,
                        version ? version : "none", DIF_LUT_VERSION);
    if (lut->n_azimuth < AZIMUTH_MIN || lut->n_azimuth > AZIMUTH_MAX || lut->n_radius < RADIUS_MIN ||
        lut->n_radius > RADIUS_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%s: table of %d azimuths x %d radii, want %d ... %d x %d ... %d",
                        source->name, lut->n_azimuth, lut->n_radius, AZIMUTH_MIN, AZIMUTH_MAX, RADIUS_MIN, RADIUS_MAX);
    if (!number_in(exr, ATTRIBUTE("n_map"), 1.0, DIF_LUT_MAP_MAX, &n_map) || n_map != floor(n_map))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is %g, want 1 ... %d", source->name, ATTRIBUTE("n_map"), n_map,
                        DIF_LUT_MAP_MAX);
    if (!number_in(exr, ATTRIBUTE("s0"), 1e-9, 2.0, &lut->s0))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is %g, want 1e-9 ... 2", source->name, ATTRIBUTE("s0"), lut->s0);
    if (!number_in(exr, ATTRIBUTE("tail"), 0.0, 1e9, &lut->tail))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %s is %g, want >= 0", source->name, ATTRIBUTE("tail"), lut->tail);
    lut->n_map = (int)n_map;
    if (dif_exr_n_channel(exr) != 3 * lut->n_map)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %d channels, want %d for %d maps", source->name,
                        dif_exr_n_channel(exr), 3 * lut->n_map, lut->n_map);
    return DIF_OK;
}

static dif_status check_finite(const dif_source *source, const dif_lut *lut, dif_error *err)
{
    const size_t texel = 3 * (size_t)lut->n_map, n_column = (size_t)lut->n_azimuth;
    const size_t n = texel * n_column * (size_t)lut->n_radius;
    for (size_t i = 0; i < n; i++)
        if (!isfinite(lut->coef[i]))
            return dif_fail(err, DIF_ERR_NONFINITE, "%s: map %zu is not finite at azimuth %zu, radius %zu",
                            source->name, i % texel / 3, i / texel % n_column, i / texel / n_column);
    return DIF_OK;
}

static dif_status read_maps(const dif_source *source, dif_exr *exr, dif_lut *lut, dif_error *err)
{
    const int n_channel = 3 * lut->n_map;
    const channel_names names = names_of(lut->n_map);
    dif_exr_target target[CHANNEL_MAX];
    dif_status status = dif_exr_check_pixels(exr, err);
    if (status)
        return status;
    lut->coef = dif_alloc((size_t)lut->n_azimuth * (size_t)lut->n_radius, (size_t)n_channel * sizeof *lut->coef);
    if (!lut->coef)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: table of %d azimuths x %d radii x %d maps", source->name,
                        lut->n_azimuth, lut->n_radius, lut->n_map);
    for (int i = 0; i < n_channel; i++)
        target[i] = (dif_exr_target){names.name[i], lut->coef + i, n_channel};
    status = dif_exr_read_targets(exr, n_channel, target, err);
    return status ? status : check_finite(source, lut, err);
}

dif_status dif_lut_parse(const unsigned char *data, size_t n, const char *name, dif_lut *lut, dif_manifest *manifest,
                         dif_error *err)
{
    static const char *const SKIP[] = {NULL};
    dif_manifest keys = {0};
    const dif_source source = dif_source_of(data, n, name);
    dif_exr *exr = NULL;
    *lut = (dif_lut){0};
    if (manifest)
        *manifest = keys;
    if (!dif_exr_is(&source))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: not an EXR file, want a table that `lut` writes", source.name);
    dif_status status = dif_exr_open(&source, &exr, err);
    if (status)
        return status;
    status = read_head(&source, exr, lut, err);
    if (!status)
        status = read_maps(&source, exr, lut, err);
    if (!status && manifest)
        status = dif_exr_take_manifest(exr, SKIP, &keys, err);
    dif_exr_close(exr);
    if (status) {
        dif_lut_free(lut);
        dif_manifest_free(&keys);
    }
    if (manifest)
        *manifest = keys;
    return status;
}

dif_status dif_lut_read(const char *path, dif_lut *lut, dif_manifest *manifest, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    *lut = (dif_lut){0};
    if (manifest)
        *manifest = (dif_manifest){0};
    dif_status status = dif_file_read(path, FILE_MAX, &data, &n, err);
    if (!status)
        status = dif_lut_parse(data, n, path, lut, manifest, err);
    dif_release(data);
    return status;
}
