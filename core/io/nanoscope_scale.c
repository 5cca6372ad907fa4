#include "core/io/nanoscope_scale.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/io/unit.h"

/* The first section of each kind that has lines. */
void dif_nanoscope_lists_of(const dif_nanoscope_header *header, dif_nanoscope_lists *out)
{
    static const struct {
        const char *name;
        int list; /* 0 scanner, 1 scan, 2 controller */
    } NAMES[] = {{"Scanner list", 0}, {"Microscope list", 0}, {"Ciao scan list", 1}, {"Afm list", 1},
                 {"Stm list", 1},     {"NC Afm list", 1},     {"Controller list", 2}};
    dif_piece found[3] = {{"", 0}, {"", 0}, {"", 0}}, name, lines;
    for (dif_piece left = header->text; dif_nanoscope_next(&left, &name, &lines);) {
        for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
            if (found[NAMES[i].list].n == 0 && dif_piece_is(name, NAMES[i].name))
                found[NAMES[i].list] = lines;
        }
    }
    *out = (dif_nanoscope_lists){header->version, found[0], found[1], found[2]};
}

void dif_nanoscope_text(dif_piece text, char *out, size_t size)
{
    size_t used = 0;
    for (size_t i = 0; i < text.n && used + 3 <= size; i++) {
        const unsigned char c = (unsigned char)text.at[i];
        if (c >= 0x80u) {
            out[used++] = (char)(0xc0u | (c >> 6));
            out[used++] = (char)(0x80u | (c & 0x3fu));
        } else {
            out[used++] = (char)(c < 0x20u || c == 0x7fu ? ' ' : c);
        }
    }
    out[used] = '\0';
}

/* What a prefix multiplies a unit by; 0 = it is none. */
static double prefix_of(char c)
{
    static const struct {
        char name;
        double factor;
    } PREFIXES[] = {{'f', 1e-15},   {'p', 1e-12}, {'n', 1e-9}, {'u', 1e-6}, {'~', 1e-6},
                    {'\xb5', 1e-6}, {'m', 1e-3},  {'k', 1e3},  {'M', 1e6},  {'G', 1e9}};
    for (size_t i = 0; i < sizeof PREFIXES / sizeof *PREFIXES; i++) {
        if (PREFIXES[i].name == c)
            return PREFIXES[i].factor;
    }
    return 0.0;
}

static bool same(dif_piece a, dif_piece b)
{
    return a.n == b.n && (a.n == 0 || memcmp(a.at, b.at, a.n) == 0);
}

/* How many `b` one `a` is, if both are one unit but for their prefixes ("mV", "V"); 0 if they are not. */
static double ratio_of(dif_piece a, dif_piece b)
{
    if (same(a, b))
        return 1.0;
    const double of_a = a.n > 1 ? prefix_of(a.at[0]) : 0.0, of_b = b.n > 1 ? prefix_of(b.at[0]) : 0.0;
    const dif_piece bare_a = {a.at + (a.n > 1), a.n - (a.n > 1)}, bare_b = {b.at + (b.n > 1), b.n - (b.n > 1)};
    if (of_a > 0.0 && same(bare_a, b))
        return of_a;
    if (of_b > 0.0 && same(a, bare_b))
        return 1.0 / of_b;
    return of_a > 0.0 && of_b > 0.0 && same(bare_a, bare_b) ? of_a / of_b : 0.0;
}

static bool find_sensitivity(const dif_nanoscope_lists *lists, dif_piece soft, dif_nanoscope_value *out)
{
    char key[100];
    dif_piece value;
    if (soft.n == 0 || soft.n + 2 > sizeof key)
        return false;
    key[0] = '@';
    memcpy(key + 1, soft.at, soft.n);
    key[soft.n + 1] = '\0';
    if (!dif_nanoscope_find(lists->scanner, key, &value) && !dif_nanoscope_find(lists->scan, key, &value))
        return false;
    return dif_nanoscope_value_parse(value, out) && isfinite(out->number);
}

static void set_unit(dif_nanoscope_scale *scale, dif_piece unit)
{
    const bool is_degree = unit.n == 1 && (unit.at[0] == '\xba' || unit.at[0] == '\xb0');
    if (is_degree)
        unit = (dif_piece){"deg", 3};
    dif_nanoscope_text(unit, scale->unit, sizeof scale->unit);
    if (!dif_unit_parse_si(unit.at, unit.n, &scale->unit_um))
        scale->unit_um = NAN;
}

/* "V [Sens. Zsens] (0.005035400 V/LSB) 2.910461 V" with "@Sens. Zsens: V 20.82646 nm/V". The number per LSB is that of
 * the acquisition; saved samples are rescaled to the full range of their integers, so it is not used. */
static void scale_with_sensitivity(const dif_nanoscope_lists *lists, const dif_nanoscope_value *hard,
                                   dif_nanoscope_scale *out)
{
    dif_nanoscope_value sens;
    out->factor *= hard->number;
    set_unit(out, hard->rest);
    if (!find_sensitivity(lists, hard->soft, &sens)) {
        if (hard->soft.n > 0)
            out->unit_um = NAN; /* the volts of an unknown piezo */
        return;
    }
    out->factor *= sens.number;
    const char *slash = sens.rest.n ? memchr(sens.rest.at, '/', sens.rest.n) : NULL;
    if (!slash) {
        if (dif_piece_is(hard->soft, "Sens. Phase"))
            set_unit(out, (dif_piece){"deg", 3});
        return;
    }
    const dif_piece above = {sens.rest.at, (size_t)(slash - sens.rest.at)};
    const dif_piece below = {slash + 1, sens.rest.n - above.n - 1};
    const double ratio = ratio_of(hard->rest, dif_piece_trim(below));
    if (ratio > 0.0) {
        out->factor *= ratio;
        set_unit(out, dif_piece_trim(above));
        return;
    }
    char hard_unit[DIF_CHANNEL_UNIT_SIZE / 2], sens_unit[DIF_CHANNEL_UNIT_SIZE / 2 - 1];
    dif_nanoscope_text(hard->rest, hard_unit, sizeof hard_unit);
    dif_nanoscope_text(sens.rest, sens_unit, sizeof sens_unit);
    snprintf(out->unit, sizeof out->unit, "%s %s", hard_unit, sens_unit);
    out->unit_um = NAN;
}

static bool number_of(dif_piece lines, dif_piece list, const char *key, double *out)
{
    dif_piece value;
    return (dif_nanoscope_find(lines, key, &value) || dif_nanoscope_find(list, key, &value)) &&
           dif_piece_number(value, out, NULL);
}

/* Before 4.3: "Z scale: 250.0 nm (...)", or, still older, three factors and heights in nm. */
static void scale_of_old(const dif_nanoscope_lists *lists, dif_piece lines, dif_nanoscope_scale *out)
{
    dif_piece value, rest;
    double height = 0.0, z_max = 0.0, sensitivity = 0.0, number = 0.0;
    if (dif_nanoscope_find(lines, "Z scale", &value) && dif_piece_number(value, &number, &rest)) {
        const char *remark = rest.n ? memchr(rest.at, '(', rest.n) : NULL;
        if (remark)
            rest.n = (size_t)(remark - rest.at);
        out->factor = number / 65536.0;
        set_unit(out, dif_piece_trim(rest));
    } else if (dif_nanoscope_find(lines, "Image data", &value) && dif_piece_is(value, "Height") &&
               number_of(lines, lists->scan, "Z scale height", &height) &&
               number_of(lines, lists->controller, "Z max", &z_max) &&
               number_of(lines, lists->scanner, "Z sensitivity", &sensitivity)) {
        out->factor = 2.0 / 65536.0 * height * z_max * sensitivity;
        set_unit(out, (dif_piece){"nm", 2});
    }
}

void dif_nanoscope_scale_of(const dif_nanoscope_lists *lists, dif_piece lines, int bytes_pixel,
                            dif_nanoscope_scale *out)
{
    dif_piece value;
    dif_nanoscope_value hard;
    *out = (dif_nanoscope_scale){.factor = 1.0, .unit_um = NAN};
    if (!dif_nanoscope_find(lines, "@?:Z scale", &value)) {
        scale_of_old(lists, lines, out);
    } else if (dif_nanoscope_value_parse(value, &hard) && isfinite(hard.number)) {
        out->factor = ldexp(1.0, -8 * (bytes_pixel ? bytes_pixel : 2));
        scale_with_sensitivity(lists, &hard, out);
    }
}
