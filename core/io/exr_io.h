/* OpenEXR files in memory: channels of floats with attributes, read and written through OpenEXRCore.
 * Internal to core/io. Does not: know what pixels and attributes mean, read deep or multi-part files. */
#ifndef DIF_EXR_IO_H
#define DIF_EXR_IO_H

#include "core/io/field_raw.h"
#include "core/io/manifest.h"
#include "core/io/source.h"

#define DIF_EXR_PREFIX "diffbench." /* of our own attributes */
enum { DIF_EXR_CHANNEL_SIZE = 64 };

bool dif_exr_is(const dif_source *source);

typedef struct dif_exr dif_exr; /* an opened file; owns the library's context */

/* Opens a file in memory, which must outlive *out.
 * Status DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM; *out NULL on failure */
DIF_MUST_USE dif_status dif_exr_open(const dif_source *source, dif_exr **out, dif_error *err);
void dif_exr_close(dif_exr *exr);

/* Size of the data window. */
void dif_exr_size(const dif_exr *exr, int *nx, int *ny);

/* A string attribute, or NULL; valid until dif_exr_close. */
const char *dif_exr_text(const dif_exr *exr, const char *name);

/* A double, float, int or string attribute that is a number. */
bool dif_exr_number(const dif_exr *exr, const char *name, double *value);

/* Reads a channel: the named one, else "R" if there is one, else the first.
 *
 * Gives     *pixel  pixel[ny*nx], row 0 at the top, freed with dif_release
 *           found   the channel's name
 * Status    DIF_ERR_FORMAT (no such channel, broken data), DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_exr_read_channel(dif_exr *exr, const char *name, float **pixel,
                                             char found[DIF_EXR_CHANNEL_SIZE], dif_error *err);

/* Channels, sorted by name as in the file. A name is valid until dif_exr_close. */
int dif_exr_n_channel(const dif_exr *exr);
const char *dif_exr_channel_name(const dif_exr *exr, int i);

/* Where a channel goes: sample ix of row iy to pixel[(iy*nx + ix) * stride], stride >= 1 in floats. */
typedef struct dif_exr_target {
    const char *name;
    float *pixel; /* not owned */
    int stride;
} dif_exr_target;

/* Checks that all pixels are in the file, before memory is asked for. Status DIF_ERR_FORMAT. */
DIF_MUST_USE dif_status dif_exr_check_pixels(dif_exr *exr, dif_error *err);

/* Reads n named channels in one pass. Status as dif_exr_read_channel. */
DIF_MUST_USE dif_status dif_exr_read_targets(dif_exr *exr, int n, const dif_exr_target *target, dif_error *err);

/* Sets every string attribute "diffbench.KEY" as KEY, but for the names in skip (NULL-terminated). */
DIF_MUST_USE dif_status dif_exr_take_manifest(const dif_exr *exr, const char *const *skip, dif_manifest *manifest,
                                              dif_error *err);

typedef struct dif_exr_attribute {
    const char *name;
    const char *text; /* NULL: a double */
    double number;
} dif_exr_attribute;

typedef struct dif_exr_layer {
    const char *name;   /* no two alike                                                   */
    const float *pixel; /* sample ix of row iy at pixel[(iy*nx + ix) * stride], not owned */
    int stride;         /* >= 1, in floats                                                */
} dif_exr_layer;

typedef struct dif_exr_image {
    int nx, ny;
    const dif_exr_layer *layer; /* layer[n_layer], the channels; any order, the file sorts them */
    int n_layer;
    bool is_srgb;  /* R, G, B have sRGB's primaries and white, which the file then says        */
    bool is_plain; /* no compression: for numbers that ZIP only makes slow                     */
    const dif_exr_attribute *attribute;
    int n_attribute;
    const dif_manifest *manifest; /* becomes "diffbench.KEY", attributes of the same name win; may be NULL */
} dif_exr_image;

/* The bytes of a scanline file, ZIP-compressed unless it is to be plain, freed with dif_release. Status DIF_ERR_FOREIGN, DIF_ERR_NOMEM. */
DIF_MUST_USE dif_status dif_exr_encode(const dif_exr_image *image, unsigned char **data, size_t *n, dif_error *err);

/* A heightfield from and to EXR (exr_field.c). */
DIF_MUST_USE dif_status dif_exr_field_list(const dif_source *source, dif_channels *out, dif_error *err);
DIF_MUST_USE dif_status dif_exr_field_read(const dif_source *source, int index, dif_raw *raw, dif_error *err);
DIF_MUST_USE dif_status dif_exr_field_encode(const dif_field *field, const dif_manifest *manifest, unsigned char **data,
                                             size_t *n, dif_error *err);

/* What both directions share: the library's memory comes from dif_alloc; one block may have at most 1 GiB. */
void *dif_exr_alloc(size_t n_byte);

#endif
