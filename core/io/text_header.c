#include "core/io/text_header.h"

#include <math.h>
#include <string.h>

#include "core/io/number.h"
#include "core/io/unit.h"

dif_text_header dif_text_header_empty(void)
{
    const dif_text_header header = {
        .width_um = NAN, .height_um = NAN, .pitch_um = NAN, .unit_um = NAN, .n_row = NAN, .n_column = NAN};
    return header;
}

static const char *find_text(const char *text, size_t n, const char *word)
{
    const size_t n_word = strlen(word);
    for (size_t i = 0; i + n_word <= n; i++) {
        if (memcmp(text + i, word, n_word) == 0)
            return text + i;
    }
    return NULL;
}

static bool has_any(const char *text, size_t n, const char *const *words)
{
    for (; *words; words++) {
        if (find_text(text, n, *words))
            return true;
    }
    return false;
}

void dif_text_header_comment(dif_text_header *header, const char *line, size_t n)
{
    static const char *const WIDTH[] = {"Width", "Breite", "Largeur", NULL};
    static const char *const HEIGHT[] = {"Height", "H\xc3\xb6he", "H\xf6he", "Hauteur", NULL};
    static const char OURS[] = "diffbench."; /* a line of provenance says nothing of the scale */
    const char *text = line;
    while (text < line + n && (*text == ' ' || *text == '\t'))
        text++;
    if ((size_t)(line + n - text) >= sizeof OURS - 1 && memcmp(text, OURS, sizeof OURS - 1) == 0)
        return;
    const int index = ++header->n_comment;
    size_t n_key = n;
    while (n_key > 0 && line[n_key - 1] != ':')
        n_key--;
    if (n_key == 0)
        return;
    const char *value = line + n_key;
    size_t n_value = n - n_key;
    for (; n_value > 0 && (*value == ' ' || *value == '\t'); value++)
        n_value--;
    double length_um = NAN;
    if (dif_unit_parse_length(value, n_value, &length_um)) {
        const bool is_width = has_any(line, n_key, WIDTH), is_height = has_any(line, n_key, HEIGHT);
        /* Exports in other languages: the second and third line are width and height. */
        if (is_width || (!is_height && index == 2))
            header->width_um = length_um;
        else if (is_height || index == 3)
            header->height_um = length_um;
    } else if (dif_unit_parse(value, n_value, &length_um)) {
        if (index > 1 && isnan(header->unit_um))
            header->unit_um = length_um;
    } else if (index == 1) {
        header->title = value;
        header->n_title = n_value;
    }
}

/* "height conversion factor (-> m)": the length of the unit behind the arrow. */
static bool parse_factor_unit(const char *key, size_t n, double *unit_um)
{
    const char *arrow = find_text(key, n, "->");
    if (!arrow)
        return false;
    arrow += 2;
    const char *stop = memchr(arrow, ')', n - (size_t)(arrow - key));
    return stop && dif_unit_parse(arrow, (size_t)(stop - arrow), unit_um);
}

/* One "key=value"; keys that say nothing of the scale are left alone. */
static void take_pair(dif_text_header *header, const char *key, size_t n_key, const char *value, size_t n_value)
{
    double number = NAN, unit_um = NAN;
    if (n_key == 1 && (*key == 'h' || *key == 'w') && dif_number_all(value, n_value, '.', &number)) {
        *(*key == 'h' ? &header->n_row : &header->n_column) = number;
    } else if (find_text(key, n_key, "pixel size")) {
        if (dif_unit_parse_length(value, n_value, &number))
            header->pitch_um = number;
    } else if (find_text(key, n_key, "height conversion factor") && parse_factor_unit(key, n_key, &unit_um)) {
        if (dif_number_all(value, n_value, '.', &number))
            header->unit_um = number * unit_um;
    }
}

bool dif_text_header_pairs(dif_text_header *header, const char *line, size_t n)
{
    const char *equal = memchr(line, '=', n);
    if (!equal)
        return false;
    const char *end = line + n;
    const char *second = memchr(equal + 1, '=', (size_t)(end - equal - 1));
    if (!second) {
        take_pair(header, line, (size_t)(equal - line), equal + 1, (size_t)(end - equal - 1));
        return true;
    }
    /* several pairs in a line: words without blanks */
    for (const char *word = line; word < end;) {
        const char *stop = memchr(word, ' ', (size_t)(end - word));
        stop = stop ? stop : end;
        equal = memchr(word, '=', (size_t)(stop - word));
        if (equal)
            take_pair(header, word, (size_t)(equal - word), equal + 1, (size_t)(stop - equal - 1));
        word = stop + 1;
    }
    return true;
}
