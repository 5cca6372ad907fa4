/* The page's parts, written in order: head (summary, contents), one section a surface, tail (provenance).
 * Does not: read files. */
#ifndef DIF_PAGE_H
#define DIF_PAGE_H

#include <stdio.h>

#include "reports/result.h"

/* Style sheet of the page, inline. */
const char *dif_page_style(void);

/* docs: array of the surfaces' result objects. */
void dif_page_head(FILE *html, const json_t *list, const json_t *docs);
DIF_MUST_USE dif_status dif_page_surface(FILE *html, int number, const dif_result *result, dif_error *err);
/* Found periods beside the source's; nothing where no surface was studied. */
bool dif_page_has_published(const json_t *docs);
void dif_page_published(FILE *html, const json_t *list, const json_t *docs);
void dif_page_tail(FILE *html, const json_t *list);

/* A table of an object's texts and numbers, key by key. */
void dif_page_provenance(FILE *html, const json_t *provenance);

/* A cell's verdict: mark, word, the number and its limit. */
void dif_page_verdict(FILE *html, const json_t *verdict);

#endif
