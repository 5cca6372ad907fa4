/* What main.xml of an x3p file (ISO 25178-72, ISO 5436-2) says, read through expat. Internal to core/io. */
#ifndef DIF_X3P_XML_H
#define DIF_X3P_XML_H

#include "core/io/source.h"

enum { DIF_X3P_TEXT = 200 };

typedef struct dif_x3p_axis {
    char axis_type[DIF_X3P_TEXT]; /* "I" = equal steps, "A" = said for each point */
    char data_type[DIF_X3P_TEXT]; /* "I", "L", "F", "D"                         */
    double increment, offset;     /* metres, NaN = not said                     */
} dif_x3p_axis;

typedef struct dif_x3p_document {
    char revision[DIF_X3P_TEXT], feature[DIF_X3P_TEXT];
    dif_x3p_axis x, y, z;
    double nx, ny, nz;                                   /* NaN = not said                     */
    char points[DIF_X3P_TEXT], points_md5[DIF_X3P_TEXT]; /* path of the samples, empty = none  */
    char valid[DIF_X3P_TEXT], valid_md5[DIF_X3P_TEXT];   /* path of the bitmap of valid points */
    char checksum[DIF_X3P_TEXT];                         /* path of the sum of main.xml        */
    double *value;                                       /* value[n_value] of a DataList, owned, NaN = missing */
    size_t n_value, n_room;
} dif_x3p_document;

typedef struct dif_x3p_parser dif_x3p_parser; /* owns expat's */

/* *document is filled while the text comes in; both must outlive the parser. Status DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_x3p_parser_create(const dif_source *source, dif_x3p_document *document,
                                              dif_x3p_parser **out, dif_error *err);

/* Takes the next piece of the text; `self` is the parser. A document type (and with it every entity) is refused, and so
 * are text of more than 16 MiB + 128 bytes for each of SizeX SizeY SizeZ points, and 1 MiB that is a single token.
 * Status DIF_ERR_FORMAT, DIF_ERR_SIZE, DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_x3p_parser_take(void *self, const unsigned char *text, size_t n, dif_error *err);

/* Says that the text is complete. Status as before. */
DIF_MUST_USE dif_status dif_x3p_parser_end(dif_x3p_parser *parser, dif_error *err);

void dif_x3p_parser_free(dif_x3p_parser *parser);
void dif_x3p_document_free(dif_x3p_document *document);

#endif
