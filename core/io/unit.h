/* Names of length units as instruments write them.
 * Internal to core/io. Does not: convert angles or anything but lengths. */
#ifndef DIF_UNIT_H
#define DIF_UNIT_H

#include <stdbool.h>
#include <stddef.h>

/* Finds "pm", "nm", "um" (also with a micro sign in UTF-8 or Latin-1, or NanoScope's "~m"), "mm", "m", "A" in text[n],
 * blanks around it allowed; *unit_um is its length. */
bool dif_unit_parse(const char *text, size_t n, double *unit_um);

/* The same for files whose units are those of physics, where "A" is the ampere. */
bool dif_unit_parse_si(const char *text, size_t n, double *unit_um);

/* Reads "number unit" from text[n], with a point or comma; *length_um is the product. */
bool dif_unit_parse_length(const char *text, size_t n, double *length_um);

#endif
