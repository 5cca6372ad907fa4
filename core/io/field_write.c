/* Heightfields to files: the format follows from the extension. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/field_io.h"
#include "core/io/field_raw.h"
#include "core/io/file.h"
#include "core/units.h"

typedef enum written_kind { WRITTEN_FLOAT, WRITTEN_16_BIT, WRITTEN_TEXT } written_kind;

static const struct {
    const char *extension;
    dif_status (*encode)(const dif_field *field, const dif_manifest *manifest, unsigned char **data, size_t *n,
                         dif_error *err);
    written_kind kind;
} WRITERS[] = {
    {".exr", dif_exr_field_encode, WRITTEN_FLOAT},
    {".gsf", dif_gsf_encode, WRITTEN_FLOAT},
    {".png", dif_png_field_encode, WRITTEN_16_BIT},
    {".txt", dif_text_field_encode, WRITTEN_TEXT},
};
enum { N_WRITER = sizeof WRITERS / sizeof *WRITERS };

static int find_writer(const char *path)
{
    int i = 0;
    while (i < N_WRITER && !dif_file_ends_in(path, WRITERS[i].extension))
        i++;
    return i;
}

dif_status dif_field_write_check(const char *path, dif_error *err)
{
    if (find_writer(path) < N_WRITER)
        return DIF_OK;
    (void)dif_fail(err, DIF_ERR_ARG, "heightfields are written as .exr, .gsf, .png or .txt");
    return dif_fail_named(err, path, DIF_ERR_ARG);
}

dif_status dif_field_write(const char *path, const dif_field *field, const dif_manifest *manifest, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    dif_status status = dif_field_check(field, err);
    if (status)
        return dif_fail_named(err, path, status);
    status = dif_field_write_check(path, err);
    if (status)
        return status;
    status = WRITERS[find_writer(path)].encode(field, manifest, &data, &n, err);
    if (status)
        return dif_fail_named(err, path, status);
    status = dif_file_write(path, data, n, err);
    dif_release(data);
    return status;
}

dif_field_loss dif_field_loss_of(const char *path, const dif_field *field)
{
    dif_field_loss loss = {.step_um = 0.0};
    const int writer = find_writer(path);
    const size_t n = dif_field_n(field);
    double min_um = INFINITY, max_um = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        min_um = fmin(min_um, field->z_um[i]);
        max_um = fmax(max_um, field->z_um[i]);
    }
    if (writer == N_WRITER || WRITERS[writer].kind == WRITTEN_TEXT)
        return loss;
    const double range_um = max_um - min_um, size_um = fmax(fabs(min_um), fabs(max_um));
    if (WRITERS[writer].kind == WRITTEN_16_BIT) {
        loss.step_um = range_um / 65535.0;
        snprintf(loss.warning, sizeof loss.warning, "16-bit heights: one step is %.4g nm",
                 dif_nm_from_um(loss.step_um));
        return loss;
    }
    loss.step_um = size_um * 0x1p-23; /* of the largest height */
    if (loss.step_um > range_um * 1e-5)
        snprintf(loss.warning, sizeof loss.warning,
                 "the heights lie %.4g um from zero, where one step of a float is %.4g nm: level them", size_um,
                 dif_nm_from_um(loss.step_um));
    return loss;
}
