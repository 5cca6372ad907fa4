/* Heightfields from and to files, recognised by content.
 * In: NanoScope, GWY, SDF, x3p, EXR, PNG/TIFF/BMP, GSF, text matrices.  Out: EXR, GSF, PNG, text.
 * Does not: level, fill or guess a scale. */
#ifndef DIF_FIELD_IO_H
#define DIF_FIELD_IO_H

#include <stdbool.h>

#include "core/field.h"
#include "core/io/manifest.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What the user says about a file; NaN / NULL = not said. */
typedef struct dif_field_request {
    double pixel_um;     /* --pixel-nm                                                        */
    double size_um;      /* --size-um: extent along x, square pixels                          */
    double height_um;    /* --height-um: full range of an image's values (black to white)     */
    const char *z_unit;  /* --z-unit: unit of a text's or unitless EXR's numbers ("nm", "um", "m") */
    const char *channel; /* --channel: name or number of one, see dif_channels_find           */
    bool allow_missing;  /* heights that are not finite come as NaN instead of an error           */
} dif_field_request;

dif_field_request dif_field_request_default(void);

typedef struct dif_field_file {
    dif_field field;
    char format[32];    /* "gsf", "exr", "png", "text", ...                                   */
    char title[128];    /* channel or title, may be empty                                    */
    double step_um;     /* height of one quantisation step of an integer image, 0 = none      */
    int bits;           /* of an integer image, 0 = not one                                   */
    int channel;        /* number of the channel that was read, from 1                        */
    int n_channel;      /* that the file has                                                  */
    char warning[200];  /* one line for the user, or empty                                    */
    char history[2048]; /* what was done to the heights since they were read, or empty        */
} dif_field_file;

/* One image of a file. */
enum { DIF_CHANNEL_NAME_SIZE = 128, DIF_CHANNEL_UNIT_SIZE = 24, DIF_CHANNELS_MAX = 1024 };
typedef struct dif_channel {
    char name[DIF_CHANNEL_NAME_SIZE];  /* may be empty, and several may have one name                        */
    char alias[DIF_CHANNEL_NAME_SIZE]; /* a second name, as the instrument's program shows it, may be empty  */
    char note[16];                     /* tells channels of one name apart ("Retrace"), may be empty         */
    char unit[DIF_CHANNEL_UNIT_SIZE];  /* of its values, "nm", "V", "deg" ...; empty = the file does not say */
    int nx, ny;
    bool is_height; /* the unit is a length */
} dif_channel;

typedef struct dif_channels {
    int n;
    dif_channel *channel; /* channel[n], owned; the user's number of channel[i] is i + 1               */
    int preferred;        /* which is read if none is asked for; -1 = none is known to be heights      */
    char format[32];      /* as in dif_field_file                                                      */
} dif_channels;

/* Lists the images of a file, whether or not they have a scale. Files of a format with one image have one channel.
 *
 * Status    as dif_field_read; DIF_ERR_SIZE for more than DIF_CHANNELS_MAX; *out zeroed on failure */
DIF_MUST_USE dif_status dif_field_channels(const char *path, dif_channels *out, dif_error *err);
DIF_MUST_USE dif_status dif_field_channels_parse(const unsigned char *data, size_t n, const char *name,
                                                 dif_channels *out, dif_error *err);
void dif_channels_free(dif_channels *channels);

/* The channel that `which` means: a name or alias (letters may differ in case), else a number from 1, else the only one
 * whose name begins so. NULL is the preferred channel.
 *
 * Status    DIF_ERR_FORMAT if there is none, or several; the text tells which there are, without the file's name */
DIF_MUST_USE dif_status dif_channels_find(const dif_channels *channels, const char *which, int *index, dif_error *err);

/* Reads a file. What the request says wins over what the file says of itself, with a warning if they differ.
 *
 * Integer images: values 0 to 2^bits - 1 span height_um. Of several channels the one of the request is read, else the
 * file's height channel: NanoScope's Height Sensor or else Height, the first in a length of a Gwyddion file, R or else the
 * first of an EXR. Text: a list of x y z becomes a grid with the largest y at the top, all three in z_unit unless pixel_um
 * or size_um is said. Up to 2^28 samples; but for compressed formats memory is asked for only when the file holds as many, at
 * most 4 times its size.
 *
 * Status    DIF_ERR_ARG (the request: a length <= 0, an unknown unit), DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_SCALE (names the flag), DIF_ERR_NONFINITE, DIF_ERR_SIZE,
 *           DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM; the text begins with the path. *out zeroed on failure */
DIF_MUST_USE dif_status dif_field_read(const char *path, const dif_field_request *request, dif_field_file *out,
                                       dif_error *err);

/* The same from memory (for fuzzers); `name` is used in messages. */
DIF_MUST_USE dif_status dif_field_parse(const unsigned char *data, size_t n, const char *name,
                                        const dif_field_request *request, dif_field_file *out, dif_error *err);
void dif_field_file_free(dif_field_file *file);

/* Writes by extension, atomically: .exr (float, heights in um, attributes), .gsf (float), .png (16 bits from the lowest
 * to the highest height, Gwyddion's keys) or .txt (matrix in m under Gwyddion's header, exact). DIF_ERR_ARG for another
 * one, DIF_ERR_NONFINITE for missing points. */
DIF_MUST_USE dif_status dif_field_write(const char *path, const dif_field *field, const dif_manifest *manifest,
                                        dif_error *err);

/* Whether a path's extension is one that dif_field_write knows: DIF_OK or DIF_ERR_ARG. */
DIF_MUST_USE dif_status dif_field_write_check(const char *path, dif_error *err);

/* What the format of a path does to the heights of a valid field. */
typedef struct dif_field_loss {
    double step_um;    /* heights come back to half of it, largest ones of floats; 0 = exact              */
    char warning[160]; /* a line for the user if that is coarse, or empty                                 */
} dif_field_loss;
dif_field_loss dif_field_loss_of(const char *path, const dif_field *field);

#ifdef __cplusplus
}
#endif
#endif
