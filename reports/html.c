#include "reports/html.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void dif_html_text(FILE *out, const char *text)
{
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        switch (c) {
        case '&':
            fputs("&amp;", out);
            break;
        case '<':
            fputs("&lt;", out);
            break;
        case '>':
            fputs("&gt;", out);
            break;
        case '"':
            fputs("&quot;", out);
            break;
        case '\'':
            fputs("&#39;", out);
            break;
        default:
            if ((c < 0x20 && c != '\n' && c != '\t') || c == 0x7f)
                fputs("\xef\xbf\xbd", out);
            else
                fputc(c, out);
        }
    }
}

/* Between a number and its unit: nothing before a degree sign. */
static const char *gap(const char *unit)
{
    return !*unit || strncmp(unit, "°", strlen("°")) == 0 ? "" : " ";
}

/* Copies printf's number with U+2212 for '-' and superscripts for an exponent, then the unit. */
static void typeset(const char *ascii, const char *unit, char out[DIF_HTML_NUMBER_SIZE])
{
    static const char *const superscript[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    size_t n = 0;
    const size_t room = DIF_HTML_NUMBER_SIZE - 8;
    for (; *ascii && n < room; ascii++) {
        const char *piece = NULL;
        char one[2] = {*ascii, '\0'};
        if (*ascii == '-') {
            piece = "−";
        } else if (*ascii == 'e') {
            const int exponent = atoi(ascii + 1);
            n += (size_t)snprintf(out + n, DIF_HTML_NUMBER_SIZE - n, " × 10%s", exponent < 0 ? "⁻" : "");
            char digits[12];
            snprintf(digits, sizeof digits, "%d", abs(exponent));
            for (const char *d = digits; *d && n < room; d++)
                n += (size_t)snprintf(out + n, DIF_HTML_NUMBER_SIZE - n, "%s", superscript[*d - '0']);
            break;
        } else {
            piece = one;
        }
        n += (size_t)snprintf(out + n, DIF_HTML_NUMBER_SIZE - n, "%s", piece);
    }
    if (*unit && n < DIF_HTML_NUMBER_SIZE)
        snprintf(out + n, DIF_HTML_NUMBER_SIZE - n, "%s%s", gap(unit), unit);
}

void dif_html_number(double value, int n_digit, const char *unit, char out[DIF_HTML_NUMBER_SIZE])
{
    char ascii[64];
    if (!isfinite(value)) {
        snprintf(out, DIF_HTML_NUMBER_SIZE, "–");
        return;
    }
    const double size = fabs(value);
    if (value == 0.0) {
        snprintf(ascii, sizeof ascii, "0");
    } else if (size >= 1e-3 && size < 1e7) {
        /* the place of the last digit, after rounding to n_digit digits */
        snprintf(ascii, sizeof ascii, "%.*e", n_digit - 1, size);
        const int exponent = atoi(strchr(ascii, 'e') + 1);
        const int decimals = n_digit - 1 - exponent;
        snprintf(ascii, sizeof ascii, "%.*f", decimals > 0 ? decimals : 0, value);
    } else {
        snprintf(ascii, sizeof ascii, "%.*e", n_digit - 1, value);
    }
    typeset(ascii, unit, out);
}

void dif_html_plain(double value, const char *unit, char out[DIF_HTML_NUMBER_SIZE])
{
    char ascii[64];
    if (!isfinite(value)) {
        snprintf(out, DIF_HTML_NUMBER_SIZE, "–");
        return;
    }
    snprintf(ascii, sizeof ascii, "%.9g", value);
    typeset(ascii, unit, out);
}

void dif_html_uncertain(double value, double uncertainty, const char *unit, char out[DIF_HTML_NUMBER_SIZE])
{
    if (!isfinite(value) || !isfinite(uncertainty) || uncertainty <= 0.0) {
        dif_html_number(value, 7, unit, out);
        return;
    }
    char ascii[32];
    snprintf(ascii, sizeof ascii, "%.1e", uncertainty);
    int decimals = 1 - atoi(strchr(ascii, 'e') + 1);
    decimals = decimals < 0 ? 0 : decimals > 12 ? 12 : decimals;
    char text[64], right[64];
    snprintf(text, sizeof text, "%.*f", decimals, value);
    typeset(text, "", out);
    const size_t n = strlen(out);
    snprintf(right, sizeof right, "± %.*f", decimals, uncertainty);
    snprintf(out + n, DIF_HTML_NUMBER_SIZE - n, " %s%s%s", right, gap(unit), unit);
}
