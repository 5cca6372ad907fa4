/* newlocale, uselocale: numbers must not depend on the locale of the calling program. */
#define _POSIX_C_SOURCE 200809L

#include "core/io/number.h"

#include <locale.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TOKEN_SIZE = 400, DIGITS_EXACT = 19, POWER_EXACT = 22 };
static const uint64_t MANTISSA_EXACT = (uint64_t)1 << 53;

/* Powers of ten that are exact doubles. */
static const double POWER10[POWER_EXACT + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* True if text < end begins with the lower-case word, in any case. */
static bool has_word(const char *text, const char *end, const char *word)
{
    const size_t n = strlen(word);
    if ((size_t)(end - text) < n)
        return false;
    for (size_t i = 0; i < n; i++) {
        if ((text[i] | 0x20) != word[i])
            return false;
    }
    return true;
}

static const char *parse_word(const char *text, const char *end, bool negative, double *value)
{
    static const struct {
        const char *word;
        double value;
    } WORDS[] = {{"nan", NAN}, {"infinity", INFINITY}, {"inf", INFINITY}};
    for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++) {
        if (has_word(text, end, WORDS[i].word)) {
            *value = negative ? -WORDS[i].value : WORDS[i].value;
            return text + strlen(WORDS[i].word);
        }
    }
    return NULL;
}

/* The slow and always right way: a copy with a point, to strtod in the C locale. */
static bool parse_by_strtod(const char *text, size_t n, char decimal, double *value)
{
    char token[TOKEN_SIZE];
    if (n >= sizeof token)
        return false;
    memcpy(token, text, n);
    token[n] = '\0';
    char *comma = decimal == '.' ? NULL : memchr(token, decimal, n);
    if (comma)
        *comma = '.';
    const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!plain)
        return false;
    const locale_t before = uselocale(plain);
    char *stop = NULL;
    *value = strtod(token, &stop);
    uselocale(before);
    freelocale(plain);
    return stop == token + n;
}

/* Reads the exponent at *at, if there is one. */
static int parse_exponent(const char **at, const char *end)
{
    const char *c = *at;
    if (c >= end || (*c | 0x20) != 'e')
        return 0;
    c++;
    const bool negative = c < end && *c == '-';
    if (c < end && (*c == '+' || *c == '-'))
        c++;
    if (c >= end || !is_digit(*c))
        return 0;
    int exponent = 0;
    for (; c < end && is_digit(*c); c++)
        exponent = exponent < 100000 ? exponent * 10 + (*c - '0') : exponent;
    *at = c;
    return negative ? -exponent : exponent;
}

const char *dif_number_parse(const char *text, const char *end, char decimal, double *value)
{
    const char *at = text;
    const bool negative = at < end && *at == '-';
    if (at < end && (*at == '-' || *at == '+'))
        at++;
    uint64_t mantissa = 0;
    int n_digit = 0, n_used = 0, scale = 0;
    for (bool fraction = false; at < end && (is_digit(*at) || (*at == decimal && !fraction)); at++) {
        if (*at == decimal) {
            fraction = true;
            continue;
        }
        n_digit++;
        if (n_used < DIGITS_EXACT) {
            mantissa = mantissa * 10 + (uint64_t)(*at - '0');
            n_used += mantissa != 0;
            scale -= fraction;
        } else {
            n_used++; /* too many digits for this way */
        }
    }
    if (n_digit == 0)
        return at > text && at[-1] == decimal ? NULL : parse_word(at, end, negative, value);
    scale += parse_exponent(&at, end);
    if (n_used <= DIGITS_EXACT && mantissa <= MANTISSA_EXACT && abs(scale) <= POWER_EXACT) {
        /* Both numbers are exact, so one operation rounds once. */
        const double m = (double)mantissa;
        const double magnitude = scale < 0 ? m / POWER10[-scale] : m * POWER10[scale];
        *value = negative ? -magnitude : magnitude;
        return at;
    }
    return parse_by_strtod(text, (size_t)(at - text), decimal, value) ? at : NULL;
}

bool dif_number_all(const char *text, size_t n, char decimal, double *value)
{
    const char *end = text + n;
    while (text < end && (*text == ' ' || *text == '\t'))
        text++;
    while (text < end && (end[-1] == ' ' || end[-1] == '\t'))
        end--;
    return text < end && dif_number_parse(text, end, decimal, value) == end;
}

size_t dif_number_print(double value, int n_digit, char out[DIF_NUMBER_SIZE])
{
    if (isnan(value)) {
        memcpy(out, "nan", 4);
        return 3;
    }
    const locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    const locale_t before = plain ? uselocale(plain) : (locale_t)0;
    const int n = snprintf(out, DIF_NUMBER_SIZE, "%.*g", n_digit, value);
    if (plain) {
        uselocale(before);
        freelocale(plain);
    }
    return (size_t)n;
}

size_t dif_number_print_short(double value, char out[DIF_NUMBER_SIZE])
{
    size_t n = 0;
    for (int n_digit = 15; n_digit <= 17; n_digit++) {
        double back = 0.0;
        n = dif_number_print(value, n_digit, out);
        if (dif_number_all(out, n, '.', &back) && back == value)
            break;
    }
    return n;
}
