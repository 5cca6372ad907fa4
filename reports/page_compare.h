/* What the files of a comparison's page share. */
#ifndef DIF_PAGE_COMPARE_H
#define DIF_PAGE_COMPARE_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

/* The number at a dotted path to n digits, a dash where there is none. */
void dif_compare_number(FILE *html, const json_t *doc, const char *path, int n_digit, const char *unit);

/* The word pass or fail, marked. */
void dif_compare_mark(FILE *html, bool pass);

#endif
