/* Heightfields from and to files, recognised by content.
 * In: EXR, PNG/TIFF/BMP, GSF, text matrices.  Out: EXR, GSF.
 * Does not: level, fill or guess a scale. */
#ifndef DIF_FIELD_IO_H
#define DIF_FIELD_IO_H

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
    const char *channel; /* --channel: name of an EXR channel                                 */
} dif_field_request;

dif_field_request dif_field_request_default(void);

typedef struct dif_field_file {
    dif_field field;
    char format[32];   /* "gsf", "exr", "png", "text", ...                                   */
    char title[128];   /* channel or title, may be empty                                    */
    double step_um;    /* height of one quantisation step of an integer image, 0 = none      */
    int bits;          /* of an integer image, 0 = not one                                   */
    char warning[200]; /* one line for the user, or empty                                    */
} dif_field_file;

/* Reads a file. What the request says wins over what the file says of itself, with a warning if they differ.
 *
 * Integer images: values 0 to 2^bits - 1 span height_um. EXR: the channel of the request, else R, else the first. Text: a
 * list of x y z becomes a grid with the largest y at the top, all three in z_unit unless pixel_um or size_um is said.
 * Up to 2^28 samples.
 *
 * Status    DIF_ERR_ARG (the request: a length <= 0, an unknown unit), DIF_ERR_IO, DIF_ERR_FORMAT, DIF_ERR_SCALE (names the flag), DIF_ERR_NONFINITE, DIF_ERR_SIZE,
 *           DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM; the text begins with the path. *out zeroed on failure */
DIF_MUST_USE dif_status dif_field_read(const char *path, const dif_field_request *request, dif_field_file *out,
                                       dif_error *err);

/* The same from memory (for fuzzers); `name` is used in messages. */
DIF_MUST_USE dif_status dif_field_parse(const unsigned char *data, size_t n, const char *name,
                                        const dif_field_request *request, dif_field_file *out, dif_error *err);
void dif_field_file_free(dif_field_file *file);

/* Writes by extension: .exr (float, heights in um, attributes) or .gsf; atomically. DIF_ERR_ARG for another one. */
DIF_MUST_USE dif_status dif_field_write(const char *path, const dif_field *field, const dif_manifest *manifest,
                                        dif_error *err);

#ifdef __cplusplus
}
#endif
#endif
