/* The first directory of a TIFF: size, kind of samples, and whether its strips or tiles lie within the file. */
#include <stdint.h>
#include <string.h>

#include "core/io/image_head.h"

enum tiff_tag {
    TAG_WIDTH = 256,
    TAG_HEIGHT = 257,
    TAG_BITS = 258,
    TAG_PHOTOMETRIC = 262,
    TAG_STRIP_OFFSETS = 273,
    TAG_ORIENTATION = 274,
    TAG_SAMPLES = 277,
    TAG_STRIP_BYTES = 279,
    TAG_TILE_OFFSETS = 324,
    TAG_TILE_BYTES = 325,
    TAG_SAMPLE_FORMAT = 339,
};
enum { ENTRY_SIZE = 12, TYPE_SHORT = 3, TYPE_LONG = 4 };

typedef struct tiff {
    const unsigned char *data; /* data[n] */
    size_t n;
    bool big;
    size_t entries; /* offset of the first entry */
    uint32_t n_entry;
} tiff;

static uint32_t number_at(const tiff *file, size_t at, int n_byte)
{
    uint32_t value = 0;
    for (int i = 0; i < n_byte; i++)
        value |= (uint32_t)file->data[at + (size_t)i] << 8 * (file->big ? n_byte - 1 - i : i);
    return value;
}

static bool within(const tiff *file, uint64_t at, uint64_t n_byte)
{
    return at <= file->n && n_byte <= file->n - at;
}

/* Values of a tag: count and where they lie. */
typedef struct tiff_values {
    size_t at;
    uint32_t n;
    int n_byte; /* 2 or 4 */
} tiff_values;

static bool find_tag(const tiff *file, enum tiff_tag tag, tiff_values *values)
{
    for (uint32_t i = 0; i < file->n_entry; i++) {
        const size_t entry = file->entries + (size_t)i * ENTRY_SIZE;
        if (number_at(file, entry, 2) != (uint32_t)tag)
            continue;
        const uint32_t type = number_at(file, entry + 2, 2);
        values->n = number_at(file, entry + 4, 4);
        values->n_byte = type == TYPE_SHORT ? 2 : 4;
        const uint64_t n_byte = (uint64_t)values->n * (uint64_t)values->n_byte;
        values->at = n_byte <= 4 ? entry + 8 : number_at(file, entry + 8, 4);
        return (type == TYPE_SHORT || type == TYPE_LONG) && values->n > 0 && within(file, values->at, n_byte);
    }
    return false;
}

static uint32_t value_of(const tiff *file, enum tiff_tag tag, uint32_t missing)
{
    tiff_values values;
    return find_tag(file, tag, &values) ? number_at(file, values.at, values.n_byte) : missing;
}

static bool blocks_are_within(const tiff *file)
{
    tiff_values at, n_byte;
    const bool strips = find_tag(file, TAG_STRIP_OFFSETS, &at) && find_tag(file, TAG_STRIP_BYTES, &n_byte);
    if (!strips && !(find_tag(file, TAG_TILE_OFFSETS, &at) && find_tag(file, TAG_TILE_BYTES, &n_byte)))
        return false;
    if (at.n != n_byte.n)
        return false;
    for (uint32_t i = 0; i < at.n; i++) {
        const uint64_t start = number_at(file, at.at + (size_t)i * (size_t)at.n_byte, at.n_byte);
        const uint64_t length = number_at(file, n_byte.at + (size_t)i * (size_t)n_byte.n_byte, n_byte.n_byte);
        if (!within(file, start, length))
            return false;
    }
    return true;
}

static dif_status check_kind(const tiff *file, dif_error *err)
{
    static const struct {
        enum tiff_tag tag;
        uint32_t missing;
        uint32_t good[3]; /* 0 ends, if not first */
        const char *what;
    } RULES[] = {
        {TAG_BITS, 1, {8, 16, 0}, "bits a sample, want 8 or 16"},
        {TAG_SAMPLE_FORMAT, 1, {1, 1, 0}, "as sample format (2 signed, 3 float), want unsigned integers"},
        {TAG_PHOTOMETRIC, 0, {1, 2, 3}, "as photometric kind, want 1 (0 is black), 2 (RGB) or 3 (palette)"},
        {TAG_ORIENTATION, 1, {1, 1, 0}, "as orientation, want 1 (row 0 at the top)"},
        {TAG_SAMPLES, 1, {1, 3, 4}, "samples a pixel, want 1, 3 or 4"},
    };
    for (size_t i = 0; i < sizeof RULES / sizeof *RULES; i++) {
        const uint32_t value = value_of(file, RULES[i].tag, RULES[i].missing);
        if (value == 0 || (value != RULES[i].good[0] && value != RULES[i].good[1] && value != RULES[i].good[2]))
            return dif_fail(err, DIF_ERR_UNSUPPORTED, "TIFF has %u %s", value, RULES[i].what);
    }
    return DIF_OK;
}

dif_status dif_tiff_head_read(const unsigned char *data, size_t n, dif_image_head *out, dif_error *err)
{
    tiff file = {.data = data, .n = n, .big = data[0] == 'M'};
    if (data[2] == '+' || data[3] == '+')
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "BigTIFF, want a classic TIFF");
    if (n < 8)
        return dif_fail(err, DIF_ERR_FORMAT, "TIFF of %zu bytes ends within its header (truncated?)", n);
    const size_t start = number_at(&file, 4, 4);
    if (!within(&file, start, 2) || !within(&file, start + 2, (uint64_t)number_at(&file, start, 2) * ENTRY_SIZE))
        return dif_fail(err, DIF_ERR_FORMAT, "TIFF of %zu bytes ends before its directory (truncated?)", n);
    file.n_entry = number_at(&file, start, 2);
    file.entries = start + 2;
    out->nx = value_of(&file, TAG_WIDTH, 0);
    out->ny = value_of(&file, TAG_HEIGHT, 0);
    const dif_status status = check_kind(&file, err);
    if (status)
        return status;
    if (!blocks_are_within(&file))
        return dif_fail(err, DIF_ERR_FORMAT, "TIFF of %zu bytes does not hold all its pixels (truncated?)", n);
    return DIF_OK;
}
