#include "core/io/unit.h"

#include <string.h>

#include "core/io/number.h"

static const struct {
    const char *name;
    double um;
} UNITS[] = {
    {"m", 1e6},
    {"mm", 1e3},
    {"um", 1.0},
    {"\xc2\xb5m", 1.0}, /* micro sign, UTF-8 */
    {"\xce\xbcm", 1.0}, /* Greek mu, UTF-8 */
    {"\xb5m", 1.0},     /* micro sign, Latin-1 */
    {"~m", 1.0},
    {"nm", 1e-3},
    {"pm", 1e-6},
    {"A", 1e-4},
    {"\xc3\x85", 1e-4},     /* A with ring, UTF-8 */
    {"\xe2\x84\xab", 1e-4}, /* Angstrom sign, UTF-8 */
    {"\xc5", 1e-4},         /* A with ring, Latin-1 */
};

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

bool dif_unit_parse(const char *text, size_t n, double *unit_um)
{
    for (; n > 0 && is_blank(text[0]); text++)
        n--;
    while (n > 0 && is_blank(text[n - 1]))
        n--;
    for (size_t i = 0; i < sizeof UNITS / sizeof *UNITS; i++) {
        if (strlen(UNITS[i].name) == n && memcmp(UNITS[i].name, text, n) == 0) {
            *unit_um = UNITS[i].um;
            return true;
        }
    }
    return false;
}

bool dif_unit_parse_si(const char *text, size_t n, double *unit_um)
{
    for (; n > 0 && is_blank(text[0]); text++)
        n--;
    const bool is_ampere = n > 0 && text[0] == 'A' && (n == 1 || is_blank(text[1]));
    return !is_ampere && dif_unit_parse(text, n, unit_um);
}

bool dif_unit_parse_length(const char *text, size_t n, double *length_um)
{
    const char *end = text + n;
    while (text < end && is_blank(*text))
        text++;
    double value = 0.0, unit_um = 0.0;
    const char *comma = memchr(text, ',', (size_t)(end - text));
    const char *rest = dif_number_parse(text, end, comma ? ',' : '.', &value);
    if (!rest || !dif_unit_parse(rest, (size_t)(end - rest), &unit_um))
        return false;
    *length_um = value * unit_um;
    return true;
}
