#include "core/io/map_io.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/file.h"
#include "core/io/table_impl.h"
#include "core/units.h"

#define ATTRIBUTE(key) DIF_EXR_PREFIX key
#define LAYOUT         "map: x, y = direction cosines"
#define VERSION        "1"
enum { PIXEL_MIN = 16, PIXEL_MAX = 4096, LAYER_NAME_SIZE = 32, FILE_MAX = 1 << 30 };
typedef char layer_name[LAYER_NAME_SIZE];

static size_t pixels_of(const dif_map_image *map)
{
    return (size_t)map->n_pixel * (size_t)map->n_pixel;
}

void dif_map_image_free(dif_map_image *map)
{
    dif_release(map->lambda_um);
    dif_release(map->xyz);
    dif_release(map->layer);
    *map = (dif_map_image){0};
}

/* T.550,000000nm: the comma is the layout's. */
static void name_layer(double lambda_um, layer_name out)
{
    const long long millionth_nm = llround(dif_nm_from_um(lambda_um) * 1e6);
    snprintf(out, LAYER_NAME_SIZE, "T.%lld,%06lldnm", millionth_nm / 1000000, millionth_nm % 1000000);
}

static dif_status name_layers(const dif_map_image *map, layer_name *name, dif_error *err)
{
    for (int i = 0; i < map->n_lambda; i++) {
        name_layer(map->lambda_um[i], name[i]);
        if (i > 0 && strcmp(name[i], name[i - 1]) == 0)
            return dif_fail(err, DIF_ERR_ARG, "two layers at %.9g nm, want wavelengths 1e-6 nm apart",
                            dif_nm_from_um(map->lambda_um[i]));
    }
    return DIF_OK;
}

static void fill_rgb(const dif_map_image *map, float *rgb)
{
    const size_t n = pixels_of(map);
    for (size_t i = 0; i < n; i++) {
        double xyz[3], linear[3];
        for (size_t c = 0; c < 3; c++)
            xyz[c] = (double)map->xyz[3 * i + c];
        dif_colour_rgb_from_xyz(xyz, linear);
        for (size_t c = 0; c < 3; c++)
            rgb[3 * i + c] = (float)linear[c];
    }
}

/* The bytes of a map whose channels lie ready. */
static dif_status encode(const dif_map_image *map, double exposure, const dif_manifest *manifest, int n_layer,
                         const dif_exr_layer *layer, unsigned char **data, size_t *n, dif_error *err)
{
    char *lambdas = dif_axis_print(map->lambda_um, map->n_lambda, dif_table_print_nm);
    char theta[DIF_NUMBER_SIZE], phi[DIF_NUMBER_SIZE], light[DIF_NUMBER_SIZE];
    *data = NULL;
    if (!lambdas)
        return dif_fail(err, DIF_ERR_NOMEM, "map of %d wavelengths", map->n_lambda);
    dif_table_print_deg(map->theta_rad, theta);
    dif_table_print_deg(map->phi_rad, phi);
    dif_number_print(exposure, 9, light);
    const dif_exr_attribute attributes[] = {
        {ATTRIBUTE("layout"), LAYOUT, 0.0},
        {ATTRIBUTE("map_version"), VERSION, 0.0},
        {ATTRIBUTE("map_of"), map->fixed_is_wo ? "theta_i, phi_i" : "theta_r, phi_r", 0.0},
        {ATTRIBUTE("x_axis"), "sin(theta) cos(phi) = (2 ix + 1)/n - 1", 0.0},
        {ATTRIBUTE("y_axis"), "sin(theta) sin(phi) = 1 - (2 iy + 1)/n, row 0 at the top", 0.0},
        {map->fixed_is_wo ? ATTRIBUTE("theta_r_deg") : ATTRIBUTE("theta_i_deg"), theta, 0.0},
        {map->fixed_is_wo ? ATTRIBUTE("phi_r_deg") : ATTRIBUTE("phi_i_deg"), phi, 0.0},
        {ATTRIBUTE("quantity"), dif_quantity_name(map->quantity), 0.0},
        {ATTRIBUTE("quantity_unit"), dif_quantity_unit(map->quantity), 0.0},
        {ATTRIBUTE("wavelengths_nm"), lambdas, 0.0},
        {ATTRIBUTE("colour"), "X, Y, Z: CIE 1931 2 deg, D65, Y = 1 for quantity = 1; R, G, B: linear sRGB, not clipped",
         0.0},
        {ATTRIBUTE("exposure"), light, 0.0},
        {"spectralLayoutVersion", "1.0", 0.0}, /* the last one: only with layers */
    };
    const int n_attribute = sizeof attributes / sizeof *attributes;
    const dif_exr_image image = {.nx = map->n_pixel,
                                 .ny = map->n_pixel,
                                 .layer = layer,
                                 .n_layer = n_layer,
                                 .is_srgb = true,
                                 .attribute = attributes,
                                 .n_attribute = map->layer ? n_attribute : n_attribute - 1,
                                 .manifest = manifest};
    const dif_status status = dif_exr_encode(&image, data, n, err);
    dif_release(lambdas);
    return status;
}

dif_status dif_map_write(const char *path, const dif_map_image *map, double exposure, const dif_manifest *manifest,
                         dif_error *err)
{
    static const char *const NAMES[] = {"R", "G", "B", "X", "Y", "Z"};
    const size_t n = pixels_of(map);
    const int n_layer = 6 + (map->layer ? map->n_lambda : 0);
    float *rgb = dif_alloc(3 * n, sizeof *rgb);
    layer_name *name = dif_alloc((size_t)map->n_lambda, sizeof *name);
    dif_exr_layer *layer = dif_alloc((size_t)n_layer, sizeof *layer);
    unsigned char *data = NULL;
    size_t n_byte = 0;
    dif_status status = DIF_OK;
    if (!rgb || !name || !layer) {
        status = dif_fail(err, DIF_ERR_NOMEM, "map of %d pixels across", map->n_pixel);
        goto cleanup;
    }
    fill_rgb(map, rgb);
    if (map->layer)
        status = name_layers(map, name, err);
    for (int i = 0; i < n_layer; i++)
        layer[i] = i < 6 ? (dif_exr_layer){NAMES[i], (i < 3 ? rgb : map->xyz) + i % 3, 3}
                         : (dif_exr_layer){name[i - 6], map->layer + (size_t)(i - 6) * n, 1};
    if (!status)
        status = encode(map, exposure, manifest, n_layer, layer, &data, &n_byte, err);
    if (!status)
        status = dif_file_write(path, data, n_byte, err);
cleanup:
    dif_release(rgb);
    dif_release(name);
    dif_release(layer);
    dif_release(data);
    return status;
}

/* What the attributes say, checked. */
static dif_status read_head(const dif_source *source, const dif_exr *exr, dif_map_image *map, dif_error *err)
{
    const char *layout = dif_exr_text(exr, ATTRIBUTE("layout")), *version = dif_exr_text(exr, ATTRIBUTE("map_version"));
    const char *quantity = dif_exr_text(exr, ATTRIBUTE("quantity"));
    int nx = 0, ny = 0;
    dif_exr_size(exr, &nx, &ny);
    if (!layout || strcmp(layout, LAYOUT) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: not a map of diffbench (attribute %s)", source->name,
                        ATTRIBUTE("layout"));
    if (!version || strcmp(version, VERSION) != 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: map of version %.20s, want %s", source->name,
                        version ? version : "none", VERSION);
    if (nx != ny || nx < PIXEL_MIN || nx > PIXEL_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%s: map of %d x %d pixels, want a square of %d ... %d", source->name, nx,
                        ny, PIXEL_MIN, PIXEL_MAX);
    map->n_pixel = nx;
    map->fixed_is_wo = dif_exr_text(exr, ATTRIBUTE("theta_r_deg")) != NULL;
    double theta_deg = NAN, phi_deg = NAN;
    const bool said =
        dif_exr_number(exr, map->fixed_is_wo ? ATTRIBUTE("theta_r_deg") : ATTRIBUTE("theta_i_deg"), &theta_deg) &&
        dif_exr_number(exr, map->fixed_is_wo ? ATTRIBUTE("phi_r_deg") : ATTRIBUTE("phi_i_deg"), &phi_deg);
    if (!said || !(fabs(theta_deg) < 90.0) || !isfinite(phi_deg))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: map without a fixed direction", source->name);
    map->theta_rad = dif_rad_from_deg(theta_deg);
    map->phi_rad = dif_rad_from_deg(phi_deg);
    if (!quantity || !dif_quantity_from_name(quantity, &map->quantity))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: map of '%.20s', want power, rho or brdf", source->name,
                        quantity ? quantity : "");
    return DIF_OK;
}

/* The wavelengths: as many as the attribute holds. */
static dif_status read_lambdas(const dif_source *source, const dif_exr *exr, dif_map_image *map, dif_error *err)
{
    const char *text = dif_exr_text(exr, ATTRIBUTE("wavelengths_nm"));
    for (const char *at = text; at && *at; at++)
        map->n_lambda += *at != ' ' && (at == text || at[-1] == ' ');
    map->lambda_um = dif_alloc((size_t)map->n_lambda, sizeof *map->lambda_um);
    if (!map->lambda_um)
        return dif_fail(err, DIF_ERR_NOMEM, "%s: %d wavelengths", source->name, map->n_lambda);
    return dif_axis_read(source, exr, ATTRIBUTE("wavelengths_nm"), map->n_lambda, dif_um_from_nm, map->lambda_um, err);
}

static dif_status check_finite(const dif_source *source, const dif_map_image *map, dif_error *err)
{
    const size_t n = pixels_of(map), n_layer = map->layer ? n * (size_t)map->n_lambda : 0;
    for (size_t i = 0; i < 3 * n; i++)
        if (!isfinite(map->xyz[i]))
            return dif_fail(err, DIF_ERR_NONFINITE, "%s: pixel %zu, %zu is not finite", source->name,
                            i / 3 % (size_t)map->n_pixel, i / 3 / (size_t)map->n_pixel);
    for (size_t i = 0; i < n_layer; i++)
        if (!isfinite(map->layer[i]))
            return dif_fail(err, DIF_ERR_NONFINITE, "%s: a layer's pixel %zu, %zu is not finite", source->name,
                            i % n % (size_t)map->n_pixel, i % n / (size_t)map->n_pixel);
    return DIF_OK;
}

static dif_status read_pixels(const dif_source *source, dif_exr *exr, dif_map_image *map, dif_error *err)
{
    static const char *const NAMES[] = {"X", "Y", "Z"};
    const size_t n = pixels_of(map);
    const bool has_layers = dif_exr_text(exr, "spectralLayoutVersion") != NULL;
    const int n_target = 3 + (has_layers ? map->n_lambda : 0);
    dif_status status = dif_exr_check_pixels(exr, err);
    if (status)
        return status;
    map->xyz = dif_alloc(3 * n, sizeof *map->xyz);
    if (has_layers)
        map->layer = dif_alloc(n * (size_t)map->n_lambda, sizeof *map->layer);
    layer_name *name = dif_alloc((size_t)map->n_lambda, sizeof *name);
    dif_exr_target *target = dif_alloc((size_t)n_target, sizeof *target);
    if (!map->xyz || (has_layers && !map->layer) || !name || !target) {
        status = dif_fail(err, DIF_ERR_NOMEM, "%s: map of %d pixels across", source->name, map->n_pixel);
        goto cleanup;
    }
    for (int i = 0; i < map->n_lambda; i++)
        name_layer(map->lambda_um[i], name[i]);
    for (int i = 0; i < n_target; i++)
        target[i] = i < 3 ? (dif_exr_target){NAMES[i], map->xyz + i, 3}
                          : (dif_exr_target){name[i - 3], map->layer + (size_t)(i - 3) * n, 1};
    status = dif_exr_read_targets(exr, n_target, target, err);
    if (!status)
        status = check_finite(source, map, err);
cleanup:
    dif_release(name);
    dif_release(target);
    return status;
}

dif_status dif_map_parse(const unsigned char *data, size_t n, const char *name, dif_map_image *map,
                         dif_manifest *manifest, dif_error *err)
{
    static const char *const SKIP[] = {NULL};
    dif_manifest keys = {0};
    const dif_source source = dif_source_of(data, n, name);
    dif_exr *exr = NULL;
    *map = (dif_map_image){0};
    if (manifest)
        *manifest = keys;
    if (!dif_exr_is(&source))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: not an EXR file, want a map of diffbench", source.name);
    dif_status status = dif_exr_open(&source, &exr, err);
    if (status)
        return status;
    status = read_head(&source, exr, map, err);
    if (!status)
        status = read_lambdas(&source, exr, map, err);
    if (!status)
        status = read_pixels(&source, exr, map, err);
    if (!status && manifest)
        status = dif_exr_take_manifest(exr, SKIP, &keys, err);
    dif_exr_close(exr);
    if (status) {
        dif_map_image_free(map);
        dif_manifest_free(&keys);
    }
    if (manifest)
        *manifest = keys;
    return status;
}

dif_status dif_map_read(const char *path, dif_map_image *map, dif_manifest *manifest, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    *map = (dif_map_image){0};
    if (manifest)
        *manifest = (dif_manifest){0};
    dif_status status = dif_file_read(path, FILE_MAX, &data, &n, err);
    if (!status)
        status = dif_map_parse(data, n, path, map, manifest, err);
    dif_release(data);
    return status;
}
