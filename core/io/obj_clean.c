/* OBJ text made safe for a loader: only v, vn, vt and f lines, every number finite, every index in range and absolute. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"
#include "core/io/number.h"
#include "core/io/obj_tiny.h"
#include "core/io/source.h"

enum { CORNER_MAX = 255, CORNER_BYTES = 40, NUMBER_BYTES = 3 * DIF_NUMBER_SIZE + 8 };
static const double COORDINATE_MAX = 1e15;

typedef enum line_kind { LINE_V, LINE_VT, LINE_VN, LINE_F, LINE_OTHER } line_kind;

typedef struct cleaner {
    const char *name;
    const char *at, *end; /* what is left of the text                          */
    long line;            /* number of the line just taken                     */
    long total[3];        /* v, vt and vn lines of the whole text               */
    long seen[3];         /* of those before this line: negative indices count from here */
    size_t n_triangle;
    char *out;
    size_t n_out, n_room;
    dif_error *err;
} cleaner;

/* The next line without its end; false after the last. */
static bool next_line(cleaner *c, const char **text, const char **end)
{
    if (c->at >= c->end)
        return false;
    const char *stop = memchr(c->at, '\n', (size_t)(c->end - c->at));
    stop = stop ? stop : c->end;
    *text = c->at;
    *end = stop > c->at && stop[-1] == '\r' ? stop - 1 : stop;
    c->at = stop < c->end ? stop + 1 : c->end;
    c->line++;
    return true;
}

static const char *skip_blanks(const char *text, const char *end)
{
    while (text < end && (*text == ' ' || *text == '\t'))
        text++;
    return text;
}

/* The kind of a line; *text moves behind its keyword. */
static line_kind kind_of(const char **text, const char *end)
{
    static const char *const KEYS[] = {"v", "vt", "vn", "f"};
    const char *at = skip_blanks(*text, end), *stop = at;
    while (stop < end && *stop != ' ' && *stop != '\t')
        stop++;
    for (int i = 0; i < LINE_OTHER; i++)
        if ((size_t)(stop - at) == strlen(KEYS[i]) && memcmp(at, KEYS[i], strlen(KEYS[i])) == 0) {
            *text = stop;
            return (line_kind)i;
        }
    return LINE_OTHER;
}

static dif_status put(cleaner *c, const char *text)
{
    const size_t n = strlen(text);
    if (c->n_out + n + 1 > c->n_room) {
        const size_t n_room = 2 * c->n_room + n + 1;
        char *more = dif_alloc(n_room, 1);
        if (!more)
            return dif_fail(c->err, DIF_ERR_NOMEM, "%s: %zu bytes of mesh", c->name, n_room);
        if (c->n_out > 0)
            memcpy(more, c->out, c->n_out);
        dif_release(c->out);
        c->out = more;
        c->n_room = n_room;
    }
    memcpy(c->out + c->n_out, text, n + 1);
    c->n_out += n;
    return DIF_OK;
}

/* Numbers of a v, vt or vn line: the first of them that count. */
static dif_status clean_numbers(cleaner *c, line_kind kind, const char *text, const char *end)
{
    static const int LEAST[] = {3, 1, 3}, MOST[] = {3, 2, 3};
    static const char *const KEYS[] = {"v", "vt", "vn"};
    char line[NUMBER_BYTES];
    size_t n = (size_t)snprintf(line, sizeof line, "%s", KEYS[kind]);
    int count = 0;
    for (text = skip_blanks(text, end); text < end && *text != '#' && count < MOST[kind]; count++) {
        double value = NAN;
        const char *stop = dif_number_parse(text, end, '.', &value);
        if (!stop || (stop < end && *stop != ' ' && *stop != '\t'))
            return dif_fail(c->err, DIF_ERR_FORMAT, "%s: line %ld: a %s line with something that is no number", c->name,
                            c->line, KEYS[kind]);
        if (!(fabs(value) <= COORDINATE_MAX))
            return dif_fail(c->err, DIF_ERR_NONFINITE, "%s: line %ld: a %s of %g, want finite numbers", c->name,
                            c->line,
                            kind == LINE_V    ? "vertex"
                            : kind == LINE_VN ? "normal"
                                              : "texture coordinate",
                            value);
        line[n++] = ' ';
        n += dif_number_print(value, 17, line + n);
        line[n] = '\0';
        text = skip_blanks(stop, end);
    }
    if (count < LEAST[kind])
        return dif_fail(c->err, DIF_ERR_FORMAT, "%s: line %ld: a %s line of %d numbers, want %d", c->name, c->line,
                        KEYS[kind], count, LEAST[kind]);
    c->seen[kind]++;
    if (kind == LINE_VT && count == 1)
        memcpy(line + n, " 0", 3);
    const dif_status status = put(c, line);
    return status ? status : put(c, "\n");
}

/* An index of a corner at *text, made absolute; 0 if none stands there; -1 if it names nothing. */
static long index_at(const cleaner *c, int which, const char **text, const char *end)
{
    const bool negative = *text < end && **text == '-';
    const char *at = *text + negative;
    long value = 0;
    while (at < end && *at >= '0' && *at <= '9' && value < 1000000000L)
        value = 10 * value + (*at++ - '0');
    if (at == *text + negative)
        return negative ? -1 : 0;
    *text = at;
    value = negative ? c->seen[which] + 1 - value : value;
    return value >= 1 && value <= c->total[which] ? value : -1;
}

/* One corner v, v/vt, v//vn or v/vt/vn. */
static dif_status clean_corner(cleaner *c, const char **text, const char *end)
{
    long index[3] = {0, 0, 0};
    char corner[CORNER_BYTES];
    for (int i = 0; i < 3; i++) {
        index[i] = index_at(c, i, text, end);
        if (index[i] < 0 || (i == 0 && index[i] == 0))
            return dif_fail(c->err, DIF_ERR_FORMAT, "%s: line %ld: a face names a %s that is not there", c->name,
                            c->line,
                            i == 0   ? "vertex"
                            : i == 1 ? "texture coordinate"
                                     : "normal");
        if (*text == end || **text != '/')
            break;
        (*text)++;
    }
    if (*text < end && **text != ' ' && **text != '\t')
        return dif_fail(c->err, DIF_ERR_FORMAT, "%s: line %ld: a corner of a face that is no v/vt/vn", c->name,
                        c->line);
    if (index[1] && index[2])
        snprintf(corner, sizeof corner, " %ld/%ld/%ld", index[0], index[1], index[2]);
    else if (index[2])
        snprintf(corner, sizeof corner, " %ld//%ld", index[0], index[2]);
    else if (index[1])
        snprintf(corner, sizeof corner, " %ld/%ld", index[0], index[1]);
    else
        snprintf(corner, sizeof corner, " %ld", index[0]);
    return put(c, corner);
}

static dif_status clean_face(cleaner *c, const char *text, const char *end)
{
    int n = 0;
    dif_status status = put(c, "f");
    for (text = skip_blanks(text, end); text < end && *text != '#' && !status; text = skip_blanks(text, end)) {
        if (++n > CORNER_MAX)
            return dif_fail(c->err, DIF_ERR_SIZE, "%s: line %ld: a face of more than %d corners", c->name, c->line,
                            CORNER_MAX);
        status = clean_corner(c, &text, end);
    }
    if (status)
        return status;
    if (n < 3)
        return dif_fail(c->err, DIF_ERR_FORMAT, "%s: line %ld: a face of %d corners, want 3", c->name, c->line, n);
    c->n_triangle += (size_t)n - 2;
    if (c->n_triangle > DIF_MESH_TRIANGLE_MAX)
        return dif_fail(c->err, DIF_ERR_SIZE, "%s: more than %d triangles", c->name, DIF_MESH_TRIANGLE_MAX);
    return put(c, "\n");
}

static void count_lines(cleaner *c)
{
    const char *text = NULL, *end = NULL;
    const char *begin = c->at;
    while (next_line(c, &text, &end)) {
        const line_kind kind = kind_of(&text, end);
        if (kind < LINE_F)
            c->total[kind]++;
    }
    c->at = begin;
    c->line = 0;
}

static dif_status clean(cleaner *c)
{
    const char *text = NULL, *end = NULL;
    count_lines(c);
    for (int i = 0; i < 3; i++)
        if (c->total[i] > DIF_MESH_VERTEX_MAX)
            return dif_fail(c->err, DIF_ERR_SIZE, "%s: more than %d vertices", c->name, DIF_MESH_VERTEX_MAX);
    while (next_line(c, &text, &end)) {
        const line_kind kind = kind_of(&text, end);
        if (end > text && end[-1] == '\\' && kind != LINE_OTHER)
            return dif_fail(c->err, DIF_ERR_UNSUPPORTED, "%s: line %ld goes on in the next one, want whole lines",
                            c->name, c->line);
        const dif_status status = kind < LINE_F    ? clean_numbers(c, kind, text, end)
                                  : kind == LINE_F ? clean_face(c, text, end)
                                                   : DIF_OK;
        if (status)
            return status;
    }
    if (c->n_triangle == 0)
        return dif_fail(c->err, DIF_ERR_FORMAT, "%s: no faces, want an OBJ mesh of v and f lines", c->name);
    return DIF_OK;
}

dif_status dif_obj_clean(const unsigned char *data, size_t n, const char *name, char **text, size_t *n_text,
                         size_t *n_triangle, dif_error *err)
{
    char shown[DIF_NAME_SIZE];
    dif_name_short(name, shown);
    cleaner c = {.name = shown, .at = (const char *)data, .end = (const char *)data + n, .err = err};
    const dif_status status = clean(&c);
    if (status) {
        dif_release(c.out);
        c = (cleaner){0};
    }
    *text = c.out;
    *n_text = c.n_out;
    *n_triangle = c.n_triangle;
    return status;
}
