/* Text of a page: escaping, and numbers as a metrologist writes them.
 * Does not: know what is reported. */
#ifndef DIF_HTML_H
#define DIF_HTML_H

#include <stdio.h>

/* Writes text with & < > " ' escaped; control characters other than line end and tab become U+FFFD. */
void dif_html_text(FILE *out, const char *text);

enum { DIF_HTML_NUMBER_SIZE = 96 };

/* "2500.003 &plusmn; 0.012 nm" in UTF-8: the uncertainty to two significant digits, the value to the same place.
 * A value that is not finite gives a dash; an uncertainty that is not finite or <= 0 gives the value alone, to
 * 7 digits. Minus is U+2212. unit may be "". */
void dif_html_uncertain(double value, double uncertainty, const char *unit, char out[DIF_HTML_NUMBER_SIZE]);

/* A number to n significant digits, as 0.00123, 1234 or 1.2 x 10^-9 (with superscript digits); a dash if not finite. */
void dif_html_number(double value, int n_digit, const char *unit, char out[DIF_HTML_NUMBER_SIZE]);

/* A number somebody chose, without trailing zeros: 75, 0.05, 2500. */
void dif_html_plain(double value, const char *unit, char out[DIF_HTML_NUMBER_SIZE]);

#endif
