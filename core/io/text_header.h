/* What the lines above the numbers of a text matrix say. Internal to core/io. */
#ifndef DIF_TEXT_HEADER_H
#define DIF_TEXT_HEADER_H

#include <stdbool.h>

#include "core/io/field_raw.h"

typedef struct dif_text_header {
    int n_comment;              /* comment lines seen                                             */
    double width_um, height_um; /* NaN = not said                                                 */
    double pitch_um, unit_um;   /* NaN = not said                                                 */
    double n_row, n_column;     /* as said by h=, w=; NaN = not said                              */
    const char *title;          /* title[n_title], in the text; NULL = none                       */
    size_t n_title;
} dif_text_header;

dif_text_header dif_text_header_empty(void);

/* Takes in one comment line, without its mark. */
void dif_text_header_comment(dif_text_header *header, const char *line, size_t n);

/* Takes in one line of key=value pairs; false if it is none. */
bool dif_text_header_pairs(dif_text_header *header, const char *line, size_t n);

#endif
