#include "core/io/nanoscope_header.h"

#include <math.h>
#include <string.h>

#include "core/io/number.h"

enum { HEADER_MAX = 1 << 18 }; /* bytes; real ones have 80 960 */

static const char BINARY[] = "\\*File list", BINARY_EC[] = "\\*EC File list", FORCE[] = "\\*Force file list",
                  TEXT[] = "?*File list";

static char lower(char c)
{
    return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

static bool begins_so(dif_piece piece, const char *word)
{
    const size_t n = strlen(word);
    if (piece.n < n)
        return false;
    for (size_t i = 0; i < n; i++) {
        if (lower(piece.at[i]) != lower(word[i]))
            return false;
    }
    return true;
}

static dif_piece without(dif_piece piece, size_t n)
{
    return (dif_piece){piece.at + n, piece.n - n};
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

bool dif_piece_is(dif_piece piece, const char *word)
{
    return piece.n == strlen(word) && begins_so(piece, word);
}

dif_piece dif_piece_trim(dif_piece piece)
{
    while (piece.n > 0 && is_blank(piece.at[0]))
        piece = without(piece, 1);
    while (piece.n > 0 && is_blank(piece.at[piece.n - 1]))
        piece.n--;
    return piece;
}

bool dif_piece_number(dif_piece piece, double *value, dif_piece *rest)
{
    piece = dif_piece_trim(piece);
    double found = 0.0;
    const char *stop = piece.n ? dif_number_parse(piece.at, piece.at + piece.n, '.', &found) : NULL;
    if (!stop || !isfinite(found))
        return false;
    *value = found;
    if (rest)
        *rest = without(piece, (size_t)(stop - piece.at));
    return true;
}

/* The next line without its end; what `left` holds begins behind it. */
static bool next_line(dif_piece *left, dif_piece *line)
{
    if (left->n == 0)
        return false;
    const char *stop = memchr(left->at, '\n', left->n);
    const size_t n = stop ? (size_t)(stop - left->at) : left->n;
    *line = dif_piece_trim((dif_piece){left->at, n});
    *left = without(*left, stop ? n + 1 : n);
    return true;
}

bool dif_nanoscope_next(dif_piece *left, dif_piece *name, dif_piece *lines)
{
    dif_piece line, ahead;
    do {
        if (!next_line(left, &line))
            return false;
    } while (!begins_so(line, "\\*"));
    *name = dif_piece_trim(without(line, 2));
    *lines = (dif_piece){left->at, 0};
    for (ahead = *left; next_line(&ahead, &line) && !begins_so(line, "\\*"); *left = ahead)
        lines->n = (size_t)(ahead.at - lines->at);
    return true;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Whether a line's "Key" is this one, and where its value begins. */
static bool is_key(dif_piece line, const char *key, dif_piece *value)
{
    if (line.n < 1 || line.at[0] != '\\')
        return false;
    line = without(line, 1);
    const bool has_group = line.n >= 3 && line.at[0] == '@' && is_digit(line.at[1]) && line.at[2] == ':';
    const bool wants_group = strncmp(key, "@?:", 3) == 0;
    if (has_group != wants_group)
        return false;
    if (has_group) { /* its colon does not end the key */
        line = without(line, 3);
        key += 3;
    }
    const char *colon = memchr(line.at, ':', line.n);
    if (!colon || !dif_piece_is(dif_piece_trim((dif_piece){line.at, (size_t)(colon - line.at)}), key))
        return false;
    *value = dif_piece_trim(without(line, (size_t)(colon - line.at) + 1));
    return true;
}

bool dif_nanoscope_find(dif_piece lines, const char *key, dif_piece *value)
{
    dif_piece line;
    while (next_line(&lines, &line)) {
        if (is_key(line, key, value))
            return true;
    }
    return false;
}

/* Cuts "(...)" with its nested parentheses, or "[...]", off the beginning; false if it does not close. */
static bool cut_bracket(dif_piece *text, char open, char close, dif_piece *inside)
{
    int depth = 0;
    *inside = (dif_piece){text->at, 0};
    if (text->n == 0 || text->at[0] != open)
        return true;
    for (size_t i = 0; i < text->n; i++) {
        depth += text->at[i] == open;
        depth -= text->at[i] == close;
        if (depth == 0) {
            *inside = dif_piece_trim((dif_piece){text->at + 1, i - 1});
            *text = dif_piece_trim(without(*text, i + 1));
            return true;
        }
    }
    return false;
}

bool dif_nanoscope_value_parse(dif_piece text, dif_nanoscope_value *out)
{
    dif_piece hard;
    text = dif_piece_trim(text);
    *out = (dif_nanoscope_value){.number = NAN};
    if (text.n < 1 || !strchr("VCS", text.at[0]) || (text.n > 1 && !is_blank(text.at[1])))
        return false;
    out->type = text.at[0];
    text = dif_piece_trim(without(text, 1));
    if (!cut_bracket(&text, '[', ']', &out->soft) || !cut_bracket(&text, '(', ')', &hard))
        return false;
    if (!dif_piece_number(text, &out->number, &out->rest))
        out->rest = text;
    out->rest = dif_piece_trim(out->rest);
    return true;
}

/* Up to the line "\*File list end". */
static bool find_end(dif_piece *text)
{
    static const char *const ENDS[] = {"\\*File list end", "\\*EC File list end"};
    dif_piece left = *text, line;
    for (;;) {
        const char *at = left.at;
        if (!next_line(&left, &line))
            return false;
        for (size_t i = 0; i < sizeof ENDS / sizeof *ENDS; i++) {
            if (!begins_so(line, ENDS[i]))
                continue;
            text->n = (size_t)(at - text->at);
            return true;
        }
    }
}

/* Hexadecimal digits behind "0x"; 0 for anything else. */
static long version_of(dif_piece value)
{
    static const char DIGITS[] = "0123456789abcdef";
    long version = 0;
    if (!begins_so(value, "0x"))
        return 0;
    for (size_t i = 2; i < value.n && i < 10; i++) {
        const char *digit = strchr(DIGITS, lower(value.at[i]));
        if (!digit || !*digit)
            break;
        version = 16 * version + (digit - DIGITS);
    }
    return version;
}

dif_status dif_nanoscope_open(const dif_source *source, dif_nanoscope_header *out, dif_error *err)
{
    *out = (dif_nanoscope_header){.source = source};
    const size_t n_max = source->n < HEADER_MAX ? source->n : HEADER_MAX;
    const dif_piece whole = {(const char *)source->data, n_max};
    dif_piece left, name, lines, value;
    if (begins_so(whole, FORCE))
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: a NanoScope force curve, not an image", source->name);
    if (begins_so(whole, TEXT))
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "%s: a NanoScope image with its samples as text, want binary ones",
                        source->name);
    const size_t n_magic = begins_so(whole, BINARY_EC) ? strlen(BINARY_EC) : strlen(BINARY);
    if (n_max < n_magic + 2 || memcmp(whole.at + n_magic, "\r\n", 2) != 0)
        return dif_fail(err, DIF_ERR_FORMAT,
                        "%s: NanoScope file with changed line ends, so its samples are damaged: transfer it again as a "
                        "binary file",
                        source->name);
    out->text = whole;
    if (!find_end(&out->text))
        return dif_fail(err, DIF_ERR_FORMAT, "%s: the NanoScope header does not end (truncated?)", source->name);
    left = out->text;
    if (dif_nanoscope_next(&left, &name, &lines) && dif_nanoscope_find(lines, "Version", &value))
        out->version = version_of(value);
    return DIF_OK;
}
