/* What the integers of a NanoScope channel stand for. Internal to core/io. */
#ifndef DIF_NANOSCOPE_SCALE_H
#define DIF_NANOSCOPE_SCALE_H

#include "core/io/field_io.h"
#include "core/io/nanoscope_header.h"

/* Sections that hold for all channels; those that a file lacks are empty. */
typedef struct dif_nanoscope_lists {
    long version;
    dif_piece scanner, scan, controller;
} dif_nanoscope_lists;

void dif_nanoscope_lists_of(const dif_nanoscope_header *header, dif_nanoscope_lists *out);

/* value in `unit` = factor * integer */
typedef struct dif_nanoscope_scale {
    double factor;
    double unit_um; /* of a length, NaN for any other unit */
    char unit[DIF_CHANNEL_UNIT_SIZE];
} dif_nanoscope_scale;

/* Of the channel with these lines; bytes_pixel is what the header says of it, 0 = nothing. Without a scale: factor 1, no unit. */
void dif_nanoscope_scale_of(const dif_nanoscope_lists *lists, dif_piece lines, int bytes_pixel,
                            dif_nanoscope_scale *out);

/* Latin-1 text as UTF-8, cut to fit. */
void dif_nanoscope_text(dif_piece text, char *out, size_t size);

#endif
