/* Heightfields as grey PNG of 16 bits, with Gwyddion's keys for the scale. */
#include <math.h>
#include <stdint.h>

#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "core/io/image_cv.h"
#include "core/io/image_head.h"
#include "core/io/number.h"

static const double VALUE_MAX = 65535.0;

/* The keys in metres: XReal and YReal are extents, ZMin and ZMax the heights of black and of white. */
static dif_status add_keys(const dif_field *field, double min_um, double max_um, const dif_manifest *manifest,
                           unsigned char **png, size_t *n, dif_error *err)
{
    const double numbers[4] = {field->nx * field->pitch_x_um / 1e6, field->ny * field->pitch_y_um / 1e6, min_um / 1e6,
                               max_um / 1e6};
    char texts[4][DIF_NUMBER_SIZE];
    for (int i = 0; i < 4; i++)
        dif_number_print_short(numbers[i], texts[i]);
    const dif_png_key keys[] = {{"Title", "height"},      {"Gwy::Title", "height"}, {"Gwy::XReal", texts[0]},
                                {"Gwy::YReal", texts[1]}, {"Gwy::XYUnit", "m"},     {"Gwy::ZUnit", "m"},
                                {"Gwy::ZMin", texts[2]},  {"Gwy::ZMax", texts[3]}};
    return dif_png_add_keys(sizeof keys / sizeof *keys, keys, manifest, png, n, err);
}

dif_status dif_png_field_encode(const dif_field *field, const dif_manifest *manifest, unsigned char **data, size_t *n,
                                dif_error *err)
{
    const size_t n_sample = dif_field_n(field);
    double min_um = field->z_um[0], max_um = field->z_um[0];
    *data = NULL;
    *n = 0;
    uint16_t *value = dif_alloc(n_sample, sizeof *value);
    if (!value)
        return dif_fail(err, DIF_ERR_NOMEM, "PNG of %d x %d samples", field->nx, field->ny);
    for (size_t i = 0; i < n_sample; i++) {
        min_um = fmin(min_um, field->z_um[i]);
        max_um = fmax(max_um, field->z_um[i]);
    }
    const double range_um = max_um - min_um;
    for (size_t i = 0; i < n_sample && range_um > 0.0; i++)
        value[i] = (uint16_t)floor((field->z_um[i] - min_um) / range_um * VALUE_MAX + 0.5);
    dif_status status = dif_image_encode_grey(value, field->nx, field->ny, data, n, err);
    dif_release(value);
    if (!status)
        status = add_keys(field, min_um, max_um, manifest, data, n, err);
    if (status) {
        dif_release(*data);
        *data = NULL;
        *n = 0;
    }
    return status;
}
