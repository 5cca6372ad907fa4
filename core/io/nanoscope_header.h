/* The text before the samples of a NanoScope file: sections of "\Key: value" lines, and the values' grammar.
 * Internal to core/io. Does not: know what sections and keys mean. */
#ifndef DIF_NANOSCOPE_HEADER_H
#define DIF_NANOSCOPE_HEADER_H

#include "core/io/source.h"

/* A piece of a file, not owned. */
typedef struct dif_piece {
    const char *at;
    size_t n;
} dif_piece;

bool dif_piece_is(dif_piece piece, const char *word); /* ASCII letters may differ in case */
dif_piece dif_piece_trim(dif_piece piece);            /* without blanks at its ends       */

/* Reads a finite number at the beginning, blanks before it allowed; *rest (may be NULL) is what follows. */
bool dif_piece_number(dif_piece piece, double *value, dif_piece *rest);

typedef struct dif_nanoscope_header {
    const dif_source *source;
    dif_piece text; /* from the first line on, without the end mark       */
    long version;   /* 0x09700105 = 9.70; 0 = the file does not say       */
} dif_nanoscope_header;

/* Status DIF_ERR_UNSUPPORTED (force curve, samples as text), DIF_ERR_FORMAT (text-mode transfer, no end mark) */
DIF_MUST_USE dif_status dif_nanoscope_open(const dif_source *source, dif_nanoscope_header *out, dif_error *err);

/* Walks over the sections: *left is header->text at first; false at the end. */
bool dif_nanoscope_next(dif_piece *left, dif_piece *name, dif_piece *lines);

/* The value of a key in a section's lines. "@?:" at the beginning of a key stands for any digit. */
bool dif_nanoscope_find(dif_piece lines, const char *key, dif_piece *value);

/* "V [Sens. Zsens] (0.005035400 V/LSB) 2.910461 V", "S [Height] "Height"": brackets and parentheses may be missing. */
typedef struct dif_nanoscope_value {
    char type;      /* 'V', 'C', 'S'              */
    dif_piece soft; /* between the brackets        */
    double number;  /* NaN if there is none        */
    dif_piece rest; /* behind the number: the unit */
} dif_nanoscope_value;

bool dif_nanoscope_value_parse(dif_piece text, dif_nanoscope_value *out);

#endif
