/* NanoScope images: a text header and little-endian integers, one block a channel, the bottom line first. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/io/field_raw.h"
#include "core/io/nanoscope_header.h"
#include "core/io/nanoscope_scale.h"
#include "core/io/sample.h"
#include "core/io/unit.h"

enum { IMAGES_MAX = 128 }; /* instruments write 16 */

/* One image section with its place in the file. */
typedef struct image_section {
    dif_channel about;
    long long nx, ny; /* as the header says              */
    long long n_valid_y, offset, n_byte;
    int bytes_pixel;             /* the scaling factor, not the samples' size   */
    double scale, unit_um;       /* heights: unit_um NaN for any other quantity */
    double size_x_um, size_y_um; /* NaN or 0 = the file does not say            */
} image_section;

bool dif_nanoscope_is(const dif_source *source)
{
    static const char *const MAGICS[] = {"\\*File list", "\\*EC File list", "\\*Force file list", "?*File list"};
    for (size_t i = 0; i < sizeof MAGICS / sizeof *MAGICS; i++) {
        if (dif_source_has(source, 0, MAGICS[i], strlen(MAGICS[i])))
            return true;
    }
    return false;
}

static bool is_image_list(dif_piece name)
{
    static const char *const NAMES[] = {"Ciao image list", "AFM image list", "STM image list", "NCAFM image list",
                                        "Image list"};
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        if (dif_piece_is(name, NAMES[i]))
            return true;
    }
    return false;
}

/* A whole number of a section: `missing` without such a key, -1 for what is no size and no place in any file. */
static long long count_of(dif_piece lines, const char *key, long long missing)
{
    dif_piece value;
    double number = 0.0;
    if (!dif_nanoscope_find(lines, key, &value))
        return missing;
    if (!dif_piece_number(value, &number, NULL) || number != floor(number) || !(number >= 0.0 && number <= 1e15))
        return -1;
    return (long long)number;
}

/* "Trace" or "Retrace" tells channels of one name apart. */
static void name_image(dif_piece lines, dif_channel *about)
{
    dif_piece value;
    dif_nanoscope_value data;
    if (dif_nanoscope_find(lines, "@?:Image Data", &value) && dif_nanoscope_value_parse(value, &data)) {
        dif_piece shown = data.rest;
        if (shown.n >= 2 && shown.at[0] == '"' && shown.at[shown.n - 1] == '"')
            shown = (dif_piece){shown.at + 1, shown.n - 2};
        dif_nanoscope_text(data.soft.n ? data.soft : shown, about->name, sizeof about->name);
        dif_nanoscope_text(shown, about->alias, sizeof about->alias);
    } else if (dif_nanoscope_find(lines, "Image data", &value)) {
        dif_nanoscope_text(value, about->name, sizeof about->name);
    }
    if (dif_nanoscope_find(lines, "Line direction", &value))
        dif_nanoscope_text(value, about->note, sizeof about->note);
}

/* "10 10 ~m", "2000 nm": *x_um, *y_um stay NaN if it is neither. */
static void size_of(const dif_nanoscope_lists *lists, dif_piece lines, double *x_um, double *y_um)
{
    dif_piece value, rest;
    double x = 0.0, y = 0.0, unit_um = NAN;
    *x_um = *y_um = NAN;
    if (!dif_nanoscope_find(lines, "Scan size", &value) && !dif_nanoscope_find(lists->scan, "Scan size", &value))
        return;
    if (!dif_piece_number(value, &x, &rest))
        return;
    if (!dif_piece_number(rest, &y, &rest))
        y = x;
    if (!dif_unit_parse_si(rest.at, rest.n, &unit_um))
        return;
    *x_um = x * unit_um;
    *y_um = y * unit_um;
}

/* The Y of "Scan size" is that of a square scan; with another aspect ratio the lines are a part of those asked for. */
static void apply_aspect(const dif_nanoscope_lists *lists, dif_piece lines, image_section *image)
{
    dif_piece value;
    double n_line = 0.0;
    const bool has_ratio = dif_nanoscope_find(lines, "Aspect ratio", &value);
    if (!has_ratio || dif_piece_is(value, "1:1") || !dif_nanoscope_find(lists->scan, "Lines", &value))
        return;
    if (dif_piece_number(value, &n_line, NULL) && n_line >= 1.0)
        image->size_y_um *= (double)image->ny / n_line;
}

static image_section section_of(const dif_nanoscope_lists *lists, dif_piece lines)
{
    image_section image = {.nx = count_of(lines, "Samps/line", count_of(lists->scan, "Samps/line", 0)),
                           .ny = count_of(lines, "Number of lines", count_of(lists->scan, "Lines", 0)),
                           .n_byte = count_of(lines, "Data length", 0),
                           .offset = count_of(lines, "Data offset", 0)};
    const long long bytes_pixel = count_of(lines, "Bytes/pixel", 2);
    image.bytes_pixel = bytes_pixel == 1 || bytes_pixel == 2 || bytes_pixel == 4 ? (int)bytes_pixel : 0;
    image.n_valid_y = count_of(lines, "Valid data len Y", image.ny);
    name_image(lines, &image.about);
    size_of(lists, lines, &image.size_x_um, &image.size_y_um);
    apply_aspect(lists, lines, &image);
    dif_nanoscope_scale scale;
    dif_nanoscope_scale_of(lists, lines, image.bytes_pixel, &scale);
    image.scale = scale.factor;
    image.unit_um = scale.unit_um;
    memcpy(image.about.unit, scale.unit, sizeof image.about.unit);
    image.about.is_height = !isnan(scale.unit_um);
    return image;
}

/* Bytes of a sample, for a size that was checked. The header's "Bytes/pixel" does not say: files from 9.2 on hold 4 with
 * 2 written there. */
static int sample_bytes(const dif_nanoscope_lists *lists, const image_section *image)
{
    const int by_version = lists->version >= 0x09200000L ? 4 : 2;
    const long long n_sample = image->nx * image->ny;
    /* half of the lines of 4 bytes look like all lines of 2 */
    const bool is_half = by_version == 4 && image->n_valid_y < image->ny;
    if (image->n_byte == 2 * n_sample && !is_half)
        return 2;
    return image->n_byte == 4 * n_sample ? 4 : by_version;
}

static dif_status check_place(const dif_nanoscope_header *header, const image_section *image, int number,
                              dif_error *err)
{
    const dif_source *source = header->source;
    const unsigned long long n = source->n;
    if (image->offset < (long long)header->text.n || image->n_byte < 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: channel %d: Data offset, Data length are %lld, %lld (damaged?)",
                        source->name, number, image->offset, image->n_byte);
    if ((unsigned long long)image->offset > n ||
        (unsigned long long)image->n_byte > n - (unsigned long long)image->offset)
        return dif_fail(err, DIF_ERR_FORMAT,
                        "%s: %llu bytes, but channel %d goes from byte %lld to %lld (truncated or damaged?)",
                        source->name, n, number, image->offset, image->offset + image->n_byte);
    return DIF_OK;
}

/* The lines that are in the file: fewer than the header says if the scan was interrupted. */
static dif_status check_lines(const dif_source *source, const image_section *image, int bytes, dif_raw *raw,
                              long long *ny, dif_error *err)
{
    if (image->bytes_pixel == 0)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: Bytes/pixel is none of 1, 2, 4", source->name);
    *ny = image->n_byte / (image->nx * bytes);
    if (*ny < 1)
        return dif_fail(err, DIF_ERR_FORMAT, "%s: %lld bytes of samples, want %lld for %lld x %lld", source->name,
                        image->n_byte, image->nx * image->ny * bytes, image->nx, image->ny);
    *ny = *ny < image->ny ? *ny : image->ny;
    if (*ny < image->ny)
        snprintf(raw->warning, sizeof raw->warning, "interrupted scan: %lld of %lld lines are in the file", *ny,
                 image->ny);
    else if (image->n_valid_y >= 0 && image->n_valid_y < image->ny)
        snprintf(raw->warning, sizeof raw->warning, "the file calls only %lld of its %lld lines valid",
                 image->n_valid_y, image->ny);
    return DIF_OK;
}

static dif_status read_image(const dif_nanoscope_lists *lists, const dif_source *source, const image_section *image,
                             dif_raw *raw, dif_error *err)
{
    long long ny = 0;
    dif_status status = dif_raw_check_size(source, image->nx, image->ny, err);
    if (status)
        return status;
    const int bytes = sample_bytes(lists, image);
    status = check_lines(source, image, bytes, raw, &ny, err);
    if (!status)
        status = dif_raw_allocate(source, image->nx, ny, raw, err);
    if (status)
        return status;
    const size_t nx = (size_t)raw->nx, n_line = nx * (size_t)bytes;
    const unsigned char *line = source->data + image->offset;
    for (int iy = raw->ny - 1; iy >= 0; iy--, line += n_line)
        dif_sample_read(bytes == 4 ? DIF_SAMPLE_S32 : DIF_SAMPLE_S16, line, nx, raw->z + (size_t)iy * nx);
    for (size_t i = 0; i < nx * (size_t)raw->ny; i++)
        raw->z[i] *= image->scale;
    raw->unit_um = image->unit_um;
    if (image->size_x_um > 0.0 && image->size_y_um > 0.0) {
        raw->pitch_x_um = image->size_x_um / (double)image->nx;
        raw->pitch_y_um = image->size_y_um / (double)image->ny;
    }
    memcpy(raw->title, image->about.name, sizeof raw->title);
    memcpy(raw->unit, image->about.unit, sizeof raw->unit);
    return DIF_OK;
}

/* 3 = measured height, 2 = height from the piezo, 1 = none that is known to be heights. */
static int rank(const dif_channel *about)
{
    static const struct {
        const char *name;
        int rank;
    } NAMES[] = {{"ZSensor", 3}, {"Height Sensor", 3}, {"Height", 2}, {"Topography", 2}};
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES && about->is_height; i++) {
        const dif_piece name = {about->name, strlen(about->name)}, alias = {about->alias, strlen(about->alias)};
        if (dif_piece_is(name, NAMES[i].name) || dif_piece_is(alias, NAMES[i].name))
            return NAMES[i].rank;
    }
    return 1;
}

dif_status dif_nanoscope_list(const dif_source *source, dif_channels *out, dif_error *err)
{
    dif_nanoscope_header header;
    dif_nanoscope_lists lists;
    dif_piece name, lines;
    int best = 1;
    dif_status status = dif_nanoscope_open(source, &header, err);
    if (status)
        return status;
    dif_nanoscope_lists_of(&header, &lists);
    out->preferred = -1;
    for (dif_piece left = header.text; !status && dif_nanoscope_next(&left, &name, &lines);) {
        if (!is_image_list(name))
            continue;
        if (out->n == IMAGES_MAX)
            return dif_fail(err, DIF_ERR_SIZE, "%s: more than %d images", source->name, (int)IMAGES_MAX);
        image_section image = section_of(&lists, lines);
        image.about.nx = (int)(image.nx >= 0 && image.nx <= DIF_FIELD_SIDE_MAX ? image.nx : 0);
        image.about.ny = (int)(image.ny >= 0 && image.ny <= DIF_FIELD_SIDE_MAX ? image.ny : 0);
        status = dif_channels_add(source, &image.about, out, err);
        if (rank(&image.about) > best) {
            best = rank(&image.about);
            out->preferred = out->n - 1;
        }
    }
    if (!status && out->n == 0)
        status = dif_fail(err, DIF_ERR_FORMAT, "%s: a NanoScope file without images", source->name);
    return status;
}

dif_status dif_nanoscope_read(const dif_source *source, int index, dif_raw *raw, dif_error *err)
{
    dif_nanoscope_header header;
    dif_nanoscope_lists lists;
    image_section wanted = {0};
    dif_piece name, lines;
    int n = 0;
    *raw = dif_raw_empty("nanoscope");
    dif_status status = dif_nanoscope_open(source, &header, err);
    if (status)
        return status;
    dif_nanoscope_lists_of(&header, &lists);
    /* what is missing may be missing in the middle, so one block that is not there spoils all */
    for (dif_piece left = header.text; !status && dif_nanoscope_next(&left, &name, &lines);) {
        if (!is_image_list(name))
            continue;
        const image_section image = section_of(&lists, lines);
        status = check_place(&header, &image, n + 1, err);
        if (n++ == index)
            wanted = image;
    }
    if (!status)
        status = read_image(&lists, source, &wanted, raw, err);
    if (status)
        dif_raw_free(raw);
    return status;
}
