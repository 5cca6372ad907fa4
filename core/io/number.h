/* Numbers from and to text, independent of the locale.
 * Internal to core/io. Does not: skip blanks. */
#ifndef DIF_NUMBER_H
#define DIF_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

enum { DIF_NUMBER_SIZE = 32 }; /* room for any double as text */

/* Reads [+-]digits[.digits][e[+-]digits], nan or inf (any case) at text < end.
 * Given     decimal  the decimal sign, '.' or ','
 * Returns   where the number ends, or NULL if there is none; *value correctly rounded */
const char *dif_number_parse(const char *text, const char *end, char decimal, double *value);

/* The whole of text[n], blanks around it allowed, is one number. */
bool dif_number_all(const char *text, size_t n, char decimal, double *value);

/* Prints with n_digit significant digits (17 give the same double back), without trailing zeros.
 * Returns the length; NaN is nan. */
size_t dif_number_print(double value, int n_digit, char out[DIF_NUMBER_SIZE]);

/* The same with the fewest of 15, 16 or 17 digits that give the same double back. */
size_t dif_number_print_short(double value, char out[DIF_NUMBER_SIZE]);

#endif
