/* A heightfield as a reader finds it: the file's own numbers and what the file says of their scale.
 * field_io.c turns it into heights. Internal to core/io. */
#ifndef DIF_FIELD_RAW_H
#define DIF_FIELD_RAW_H

#include "core/field.h"
#include "core/io/field_io.h"
#include "core/io/manifest.h"
#include "core/io/source.h"

enum { DIF_FIELD_SAMPLES_MAX = 1 << 28 }; /* 2 GiB of heights */

typedef struct dif_raw {
    int nx, ny;
    double *z;                     /* z[ny*nx], owned, numbers of the file, may be non-finite   */
    double pitch_x_um, pitch_y_um; /* NaN = the file does not say                               */
    double step_x, step_y;         /* pitches in the file's own numbers (x y z list), else NaN  */
    double unit_um, offset_um;     /* height = offset_um + unit_um z; unit NaN = not said       */
    int bits;                      /* of an integer image, else 0                               */
    char format[32], title[128];
    char unit[DIF_CHANNEL_UNIT_SIZE]; /* of z, if the file says one that is no length ("V") */
    char warning[120];                /* one sentence for the user, or empty                */
} dif_raw;

/* Says nothing: NaN everywhere, offset 0. */
dif_raw dif_raw_empty(const char *format);
void dif_raw_free(dif_raw *raw);

/* Allocates z for a size that a file claims.
 * Status DIF_ERR_FORMAT for sides < 1, DIF_ERR_SIZE for sides or products too large, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_raw_allocate(const dif_source *source, long long nx, long long ny, dif_raw *raw,
                                         dif_error *err);

/* Checks a size only, as dif_raw_allocate does. */
DIF_MUST_USE dif_status dif_raw_check_size(const dif_source *source, long long nx, long long ny, dif_error *err);

/* Copies at most sizeof title - 1 bytes of UTF-8 text. */
void dif_raw_set_title(dif_raw *raw, const char *text, size_t n);

/* What a key of a file says, or NULL. */
typedef const char *dif_key_lookup(void *self, const char *key);

/* Takes over extents and height units from the Gwyddion keys Gwy::XReal, YReal, XYUnit, ZUnit, ZMin, ZMax, ZScale, Title.
 * Status DIF_ERR_FORMAT for values that are no positive lengths */
DIF_MUST_USE dif_status dif_raw_take_gwy_keys(const dif_source *source, dif_key_lookup *lookup, void *self,
                                              dif_raw *raw, dif_error *err);

/* A format: one row of the table in field_readers.c. `read` for formats with one image, else `list` and `read_channel`,
 * which gets an index into what `list` gave. On failure *raw is empty and *out holds what dif_channels_free frees. */
typedef struct dif_reader {
    const char *format;
    bool (*is)(const dif_source *source);
    dif_status (*read)(const dif_source *source, dif_raw *raw, dif_error *err);
    dif_status (*list)(const dif_source *source, dif_channels *out, dif_error *err);
    dif_status (*read_channel)(const dif_source *source, int index, dif_raw *raw, dif_error *err);
} dif_reader;

/* The row of a source. Status DIF_ERR_FORMAT (empty file), DIF_ERR_UNSUPPORTED (known and not read) */
DIF_MUST_USE dif_status dif_reader_find(const dif_source *source, const dif_reader **out, dif_error *err);

/* Reads the channel that `which` means (NULL: the preferred one); *index and *n_channel say which of how many. */
DIF_MUST_USE dif_status dif_reader_read(const dif_source *source, const char *which, dif_raw *raw, int *index,
                                        int *n_channel, dif_error *err);

/* Lists the channels of a source of any format. */
DIF_MUST_USE dif_status dif_reader_list(const dif_source *source, dif_channels *out, dif_error *err);

/* Appends a channel. Status DIF_ERR_SIZE over DIF_CHANNELS_MAX, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_channels_add(const dif_source *source, const dif_channel *channel, dif_channels *channels,
                                         dif_error *err);

/* Copies at most size - 1 bytes of UTF-8 text: whole characters, control characters as blanks, bytes that are no UTF-8
 * as '?'. */
void dif_text_copy(char *out, size_t size, const char *text, size_t n);

/* Readers: one a format; *raw is empty on failure. */
DIF_MUST_USE dif_status dif_gsf_read(const dif_source *source, dif_raw *raw, dif_error *err);
bool dif_sdf_is(const dif_source *source);
DIF_MUST_USE dif_status dif_sdf_read(const dif_source *source, dif_raw *raw, dif_error *err);
bool dif_gwy_is_file(const dif_source *source);
DIF_MUST_USE dif_status dif_gwy_list(const dif_source *source, dif_channels *out, dif_error *err);
DIF_MUST_USE dif_status dif_gwy_read(const dif_source *source, int index, dif_raw *raw, dif_error *err);
bool dif_nanoscope_is(const dif_source *source);
DIF_MUST_USE dif_status dif_nanoscope_list(const dif_source *source, dif_channels *out, dif_error *err);
DIF_MUST_USE dif_status dif_nanoscope_read(const dif_source *source, int index, dif_raw *raw, dif_error *err);
DIF_MUST_USE dif_status dif_text_matrix_read(const dif_source *source, dif_raw *raw, dif_error *err);
DIF_MUST_USE dif_status dif_image_field_read(const dif_source *source, dif_raw *raw, dif_error *err);

/* Writers: the file's bytes in a new block, freed with dif_release. */
DIF_MUST_USE dif_status dif_gsf_encode(const dif_field *field, const dif_manifest *manifest, unsigned char **data,
                                       size_t *n, dif_error *err);
DIF_MUST_USE dif_status dif_png_field_encode(const dif_field *field, const dif_manifest *manifest, unsigned char **data,
                                             size_t *n, dif_error *err);
DIF_MUST_USE dif_status dif_text_field_encode(const dif_field *field, const dif_manifest *manifest,
                                              unsigned char **data, size_t *n, dif_error *err);

#endif
