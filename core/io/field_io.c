#include "core/io/field_io.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/field_raw.h"
#include "core/io/file.h"
#include "core/io/gzip.h"
#include "core/io/unit.h"
#include "core/units.h"

static const size_t FILE_MAX = (size_t)1 << 32;

dif_field_request dif_field_request_default(void)
{
    const dif_field_request request = {.pixel_um = NAN, .size_um = NAN, .height_um = NAN};
    return request;
}

static bool is_said(double value)
{
    return !isnan(value);
}

static dif_status check_request(const dif_source *source, const dif_field_request *request, dif_error *err)
{
    const double said[] = {request->pixel_um, request->size_um, request->height_um};
    static const char *const FLAGS[] = {"--pixel-nm", "--size-um", "--height-um"};
    double unit_um = 0.0;
    for (int i = 0; i < 3; i++) {
        if (is_said(said[i]) && !(said[i] > 0.0 && isfinite(said[i])))
            return dif_fail(err, DIF_ERR_ARG, "%s: %s says %g um, want a finite length > 0", source->name, FLAGS[i],
                            said[i]);
    }
    if (is_said(request->pixel_um) && is_said(request->size_um))
        return dif_fail(err, DIF_ERR_ARG, "%s: --pixel-nm and --size-um both given, want one of them", source->name);
    if (request->z_unit && !dif_unit_parse(request->z_unit, strlen(request->z_unit), &unit_um))
        return dif_fail(err, DIF_ERR_ARG, "%s: --z-unit is '%.20s', want pm, nm, um, mm, m or A", source->name,
                        request->z_unit);
    return DIF_OK;
}

/* Adds a sentence to the warning; what does not fit is left out. */
static void warn(dif_field_file *out, const char *sentence)
{
    const size_t n = strlen(out->warning);
    snprintf(out->warning + n, sizeof out->warning - n, "%s%s", n > 0 ? "; " : "", sentence);
}

/* Heights a number of the file stands for: height = offset + unit z. What the user says wins. */
static void choose_heights(const dif_raw *raw, const dif_field_request *request, dif_field_file *out, double *unit_um,
                           double *offset_um)
{
    *unit_um = raw->unit_um;
    *offset_um = raw->offset_um;
    const bool file_says = is_said(raw->unit_um);
    double said_um = NAN;
    if (raw->bits > 0) {
        if (is_said(request->height_um))
            said_um = request->height_um / (double)((1 << raw->bits) - 1);
        if (request->z_unit)
            warn(out, "--z-unit is not used: an image's heights come from --height-um");
    } else {
        if (request->z_unit)
            (void)dif_unit_parse(request->z_unit, strlen(request->z_unit), &said_um); /* checked before */
        if (is_said(request->height_um))
            warn(out, "--height-um is not used: the file's numbers are heights");
    }
    if (!is_said(said_um))
        return;
    if (file_says && fabs(said_um - raw->unit_um) > 1e-9 * fabs(said_um))
        warn(out, "the file's own height scale is replaced by the one given");
    *unit_um = said_um;
    *offset_um = 0.0;
}

static void choose_pitches(const dif_raw *raw, const dif_field_request *request, double unit_um, dif_field_file *out,
                           double pitch_um[2])
{
    pitch_um[0] = is_said(raw->step_x) ? raw->step_x * unit_um : raw->pitch_x_um;
    pitch_um[1] = is_said(raw->step_y) ? raw->step_y * unit_um : raw->pitch_y_um;
    const double said_um = is_said(request->pixel_um) ? request->pixel_um : request->size_um / raw->nx;
    if (!is_said(said_um))
        return;
    const bool differs = is_said(pitch_um[0]) && fabs(pitch_um[0] - said_um) > 1e-6 * said_um;
    if (differs && !is_said(raw->step_x)) {
        char sentence[100];
        snprintf(sentence, sizeof sentence, "the file's own pitch of %.6g nm is replaced by %.6g nm",
                 dif_nm_from_um(pitch_um[0]), dif_nm_from_um(said_um));
        warn(out, sentence);
    }
    pitch_um[0] = pitch_um[1] = said_um;
}

/* The flags for what neither file nor user said. */
static dif_status check_scale(const dif_source *source, const dif_raw *raw, double unit_um, double pitch_um,
                              dif_error *err)
{
    const bool has_pitch = is_said(pitch_um), has_unit = is_said(unit_um);
    const char *lateral = has_pitch || is_said(raw->step_x) ? "" : "--pixel-nm or --size-um";
    const char *height = has_unit ? "" : raw->bits > 0 ? "--height-um (black to white)" : "--z-unit (nm, um, m)";
    if (has_pitch && has_unit)
        return DIF_OK;
    if (!has_unit && raw->unit[0])
        return dif_fail(err, DIF_ERR_SCALE,
                        "%s: channel '%.40s' is in %s, which is no length; to take its numbers as "
                        "heights give %s%s%s",
                        source->name, raw->title, raw->unit, height, *lateral ? ", and " : "", lateral);
    return dif_fail(err, DIF_ERR_SCALE, "%s: %s has no %s in it, give %s%s%s", source->name, raw->format,
                    has_pitch  ? "height scale"
                    : has_unit ? "lateral scale"
                               : "scale",
                    lateral, *lateral && *height ? ", and " : "", height);
}

/* A field whose missing heights are allowed is checked for its shape alone, otherwise the text names the way out. */
static dif_status check_field(const dif_field *field, bool allow_missing, dif_error *err)
{
    dif_error detail;
    const dif_status status = dif_field_check(field, &detail);
    if (!status || (status == DIF_ERR_NONFINITE && allow_missing))
        return DIF_OK;
    return dif_fail(err, status, "%s%s", detail.text,
                    status == DIF_ERR_NONFINITE ? " (missing points: --fill interpolates them)" : "");
}

static dif_status finish(const dif_source *source, dif_raw *raw, const dif_field_request *request, dif_field_file *out,
                         dif_error *err)
{
    double unit_um = NAN, offset_um = 0.0, pitch_um[2];
    choose_heights(raw, request, out, &unit_um, &offset_um);
    choose_pitches(raw, request, unit_um, out, pitch_um);
    dif_status status = check_scale(source, raw, unit_um, pitch_um[0], err);
    if (status)
        return status;
    const size_t n = (size_t)raw->nx * (size_t)raw->ny;
    for (size_t i = 0; i < n; i++) {
        const double z_um = offset_um + unit_um * raw->z[i];
        raw->z[i] = request->allow_missing && !isfinite(z_um) ? (double)NAN : z_um;
    }
    out->field = (dif_field){raw->nx, raw->ny, pitch_um[0], pitch_um[1], raw->z};
    status = check_field(&out->field, request->allow_missing, err);
    if (status)
        return dif_fail_named(err, source->name, status == DIF_ERR_ARG ? DIF_ERR_FORMAT : status);
    memcpy(out->format, raw->format, sizeof out->format);
    memcpy(out->title, raw->title, sizeof out->title);
    if (raw->warning[0])
        warn(out, raw->warning);
    out->bits = raw->bits;
    if (raw->bits > 0)
        out->step_um = fabs(unit_um);
    if (raw->bits == 8) {
        char sentence[60];
        snprintf(sentence, sizeof sentence, "8-bit heights: one step is %.4g nm", dif_nm_from_um(out->step_um));
        warn(out, sentence);
    }
    return DIF_OK;
}

dif_status dif_field_parse(const unsigned char *data, size_t n, const char *name, const dif_field_request *request,
                           dif_field_file *out, dif_error *err)
{
    *out = (dif_field_file){0};
    const dif_field_request nothing = dif_field_request_default();
    if (!request)
        request = &nothing;
    dif_source source = dif_source_of(data, n, name);
    unsigned char *unpacked = NULL;
    dif_raw raw = dif_raw_empty("");
    dif_status status = check_request(&source, request, err);
    if (!status)
        status = dif_gzip_open(&source, &unpacked, err);
    if (!status)
        status = dif_reader_read(&source, request->channel, &raw, &out->channel, &out->n_channel, err);
    if (!status)
        status = finish(&source, &raw, request, out, err);
    dif_release(unpacked);
    if (status) {
        dif_raw_free(&raw);
        *out = (dif_field_file){0};
    }
    return status;
}

dif_status dif_field_channels_parse(const unsigned char *data, size_t n, const char *name, dif_channels *out,
                                    dif_error *err)
{
    dif_source source = dif_source_of(data, n, name);
    unsigned char *unpacked = NULL;
    *out = (dif_channels){0};
    dif_status status = dif_gzip_open(&source, &unpacked, err);
    if (!status)
        status = dif_reader_list(&source, out, err);
    dif_release(unpacked);
    return status;
}

dif_status dif_field_channels(const char *path, dif_channels *out, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    *out = (dif_channels){0};
    dif_status status = dif_file_read(path, FILE_MAX, &data, &n, err);
    if (!status)
        status = dif_field_channels_parse(data, n, path, out, err);
    dif_release(data);
    return status;
}

dif_status dif_field_read(const char *path, const dif_field_request *request, dif_field_file *out, dif_error *err)
{
    unsigned char *data = NULL;
    size_t n = 0;
    *out = (dif_field_file){0};
    dif_status status = dif_file_read(path, FILE_MAX, &data, &n, err);
    if (!status)
        status = dif_field_parse(data, n, path, request, out, err);
    dif_release(data);
    return status;
}

void dif_field_file_free(dif_field_file *file)
{
    if (!file)
        return;
    dif_field_free(&file->field);
    *file = (dif_field_file){0};
}
