/* The formats of heightfields, how they are told apart, and which of a file's channels is read. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/exr_io.h"
#include "core/io/field_raw.h"
#include "core/io/image_head.h"
#include "core/io/number.h"
#include "core/io/x3p.h"

static bool is_gsf(const dif_source *source)
{
    static const char MAGIC[] = "Gwyddion Simple Field 1.0\n";
    return dif_source_has(source, 0, MAGIC, sizeof MAGIC - 1);
}

static bool is_image(const dif_source *source)
{
    return dif_image_is(source->data, source->n);
}

static bool is_any(const dif_source *source)
{
    return source->n > 0;
}

/* The first whose `is` holds; text takes what is left. */
static const dif_reader READERS[] = {
    {"gsf", is_gsf, dif_gsf_read, NULL, NULL},
    {"exr", dif_exr_is, NULL, dif_exr_field_list, dif_exr_field_read},
    {"gwy", dif_gwy_is_file, NULL, dif_gwy_list, dif_gwy_read},
    {"nanoscope", dif_nanoscope_is, NULL, dif_nanoscope_list, dif_nanoscope_read},
    {"sdf", dif_sdf_is, dif_sdf_read, NULL, NULL},
    {"x3p", dif_x3p_is, NULL, dif_x3p_list, dif_x3p_read},
    {"image", is_image, dif_image_field_read, NULL, NULL},
    {"text", is_any, dif_text_matrix_read, NULL, NULL},
};

/* Formats that are known and not read. */
static const struct {
    const char *magic, *what;
} UNREADABLE[] = {
    {"\x1f\x8b", "a gzip archive within a gzip archive, unpack it first"},
    {"\xff\xd8\xff", "a JPEG picture, which is lossy"},
    {"\x89HDF", "an HDF5 file"},
    {"CDF", "a netCDF file"},
};

dif_status dif_reader_find(const dif_source *source, const dif_reader **out, dif_error *err)
{
    *out = NULL;
    if (source->n == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: empty file", source->name);
    for (size_t i = 0; i < sizeof UNREADABLE / sizeof *UNREADABLE; i++) {
        if (dif_source_has(source, 0, UNREADABLE[i].magic, strlen(UNREADABLE[i].magic)))
            return dif_fail(err, DIF_ERR_UNSUPPORTED,
                            "%s: %s; want NanoScope, GWY, SDF, x3p, GSF, EXR, PNG, TIFF, BMP or text", source->name,
                            UNREADABLE[i].what);
    }
    size_t i = 0;
    while (!READERS[i].is(source))
        i++;
    *out = &READERS[i];
    return DIF_OK;
}

dif_status dif_channels_add(const dif_source *source, const dif_channel *channel, dif_channels *channels,
                            dif_error *err)
{
    const int n = channels->n;
    if (n == DIF_CHANNELS_MAX)
        return dif_fail(err, DIF_ERR_SIZE, "%s: more than %d channels", source->name, (int)DIF_CHANNELS_MAX);
    if ((n & (n - 1)) == 0) { /* full at the powers of two, and at none */
        dif_channel *grown = dif_alloc(n ? 2 * (size_t)n : 1, sizeof *grown);
        if (!grown)
            return dif_fail(err, DIF_ERR_NOMEM, "%s: list of channels", source->name);
        if (n > 0)
            memcpy(grown, channels->channel, (size_t)n * sizeof *grown);
        dif_release(channels->channel);
        channels->channel = grown;
    }
    channels->channel[channels->n++] = *channel;
    return DIF_OK;
}

void dif_channels_free(dif_channels *channels)
{
    if (!channels)
        return;
    dif_release(channels->channel);
    *channels = (dif_channels){0};
}

static char lower(char c)
{
    return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

/* 2 = the same name, 1 = it begins so, 0 = neither; ASCII letters may differ in case. */
static int likeness(const char *name, const char *which)
{
    size_t i = 0;
    while (which[i] && lower(name[i]) == lower(which[i]))
        i++;
    return which[i] || i == 0 ? 0 : name[i] ? 1 : 2;
}

/* "1 Height (nm), 2 Phase (deg)", as far as it fits. */
static const char *describe(const dif_channels *channels, char text[120])
{
    size_t used = 0;
    text[0] = '\0';
    for (int i = 0; i < channels->n; i++) {
        const dif_channel *channel = &channels->channel[i];
        char one[100];
        const int n = snprintf(one, sizeof one, "%s%d%s%.40s (%s)", i ? ", " : "", i + 1, channel->name[0] ? " " : "",
                               channel->name, channel->unit[0] ? channel->unit : "no unit");
        if (used + (size_t)n + 6 > 120) {
            memcpy(text + used, ", ...", 6);
            break;
        }
        memcpy(text + used, one, (size_t)n + 1);
        used += (size_t)n;
    }
    return text;
}

/* The index that a number means, -1 if `which` is none or there is no such channel. */
static int find_number(const dif_channels *channels, const char *which)
{
    double value = 0.0;
    if (!dif_number_all(which, strlen(which), '.', &value))
        return -1;
    for (int i = 0; i < channels->n; i++) {
        if (value == i + 1)
            return i;
    }
    return -1;
}

dif_status dif_channels_find(const dif_channels *channels, const char *which, int *index, dif_error *err)
{
    char list[120];
    *index = channels->preferred;
    if (!which && *index >= 0)
        return DIF_OK;
    if (!which)
        return dif_fail(err, DIF_ERR_FORMAT, "no channel is known to hold heights: %s; name one with --channel",
                        describe(channels, list));
    for (int want = 2; want > 0; want--) {
        int n_found = 0;
        for (int i = channels->n - 1; i >= 0; i--) {
            const dif_channel *channel = &channels->channel[i];
            if (likeness(channel->name, which) < want && likeness(channel->alias, which) < want)
                continue;
            *index = i;
            n_found++;
        }
        if (n_found == 1)
            return DIF_OK;
        if (n_found > 1)
            return dif_fail(err, DIF_ERR_FORMAT, "%d channels %s '%.30s': %s; give the number to --channel", n_found,
                            want == 2 ? "are called" : "begin with", which, describe(channels, list));
        if (want == 2 && (*index = find_number(channels, which)) >= 0)
            return DIF_OK;
    }
    return dif_fail(err, DIF_ERR_FORMAT, "no channel '%.30s', it has %s", which, describe(channels, list));
}

/* What a format with one image says of it. */
static dif_channel channel_of(const dif_raw *raw)
{
    dif_channel channel = {.nx = raw->nx, .ny = raw->ny, .is_height = !isnan(raw->unit_um)};
    memcpy(channel.name, raw->title, sizeof raw->title);
    if (channel.is_height)
        snprintf(channel.unit, sizeof channel.unit, "%s", "m");
    else
        memcpy(channel.unit, raw->unit, sizeof raw->unit);
    return channel;
}

static dif_status list_by(const dif_reader *reader, const dif_source *source, dif_channels *out, dif_error *err)
{
    dif_status status;
    if (reader->list) {
        status = reader->list(source, out, err);
    } else {
        dif_raw raw;
        status = reader->read(source, &raw, err);
        if (status)
            return status;
        const dif_channel channel = channel_of(&raw);
        status = dif_channels_add(source, &channel, out, err);
        memcpy(out->format, raw.format, sizeof out->format);
        dif_raw_free(&raw);
        return status;
    }
    snprintf(out->format, sizeof out->format, "%s", reader->format);
    return status;
}

dif_status dif_reader_list(const dif_source *source, dif_channels *out, dif_error *err)
{
    const dif_reader *reader = NULL;
    *out = (dif_channels){0};
    dif_status status = dif_reader_find(source, &reader, err);
    if (!status)
        status = list_by(reader, source, out, err);
    if (status)
        dif_channels_free(out);
    return status;
}

/* A file with one image: `which` must mean it. */
static dif_status read_only_one(const dif_reader *reader, const dif_source *source, const char *which, dif_raw *raw,
                                dif_error *err)
{
    int index = 0;
    dif_status status = reader->read(source, raw, err);
    if (status || !which)
        return status;
    dif_channel channel = channel_of(raw);
    const dif_channels channels = {.n = 1, .channel = &channel};
    status = dif_channels_find(&channels, which, &index, err);
    if (status)
        dif_raw_free(raw);
    return status ? dif_fail_named(err, source->name, status) : DIF_OK;
}

dif_status dif_reader_read(const dif_source *source, const char *which, dif_raw *raw, int *index, int *n_channel,
                           dif_error *err)
{
    const dif_reader *reader = NULL;
    dif_channels channels = {0};
    int at = 0;
    *raw = dif_raw_empty("");
    dif_status status = dif_reader_find(source, &reader, err);
    if (status)
        return status;
    *index = *n_channel = 1;
    if (!reader->list)
        return read_only_one(reader, source, which, raw, err);
    status = reader->list(source, &channels, err);
    if (!status && (status = dif_channels_find(&channels, which, &at, err)))
        status = dif_fail_named(err, source->name, status);
    if (!status)
        status = reader->read_channel(source, at, raw, err);
    *index = at + 1;
    *n_channel = channels.n;
    dif_channels_free(&channels);
    return status;
}
