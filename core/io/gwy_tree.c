#include "core/io/gwy_tree.h"

#include <string.h>

#include "core/io/sample.h"

static uint32_t u32(const unsigned char *byte)
{
    return (uint32_t)byte[0] | (uint32_t)byte[1] << 8 | (uint32_t)byte[2] << 16 | (uint32_t)byte[3] << 24;
}

/* Bytes of a string with its NUL, 0 if it does not end within n. */
static size_t string_size(const unsigned char *at, size_t n)
{
    const unsigned char *nul = n ? memchr(at, '\0', n) : NULL;
    return nul ? (size_t)(nul - at) + 1 : 0;
}

bool dif_gwy_object(const unsigned char *at, size_t n, bool is_v1, const char **name, dif_gwy_items *items,
                    size_t *n_byte)
{
    const size_t n_name = string_size(at, n);
    if (n_name == 0 || n - n_name < 4 || u32(at + n_name) > n - n_name - 4)
        return false;
    *name = (const char *)at;
    items->at = at + n_name + 4;
    items->end = items->at + u32(at + n_name);
    items->is_v1 = is_v1 && strcmp(*name, "GwyContainer") == 0;
    items->broken = false;
    *n_byte = (size_t)(items->end - at);
    return true;
}

/* Bytes of one value of a type at at[n]; 0 if it does not fit or the type is unknown. */
static size_t value_size(char type, const unsigned char *at, size_t n, bool is_v1)
{
    static const char TYPES[] = "bciqd";
    static const unsigned char SIZES[] = {1, 1, 4, 8, 8};
    const char *simple = strchr(TYPES, type);
    const char *name;
    dif_gwy_items items;
    size_t n_byte = 0;
    if (type && simple)
        return SIZES[simple - TYPES] <= n ? SIZES[simple - TYPES] : 0;
    if (type == 's')
        return string_size(at, n);
    return type == 'o' && dif_gwy_object(at, n, is_v1, &name, &items, &n_byte) ? n_byte : 0;
}

/* An array's values begin at at[n]; *n_byte is their size. Strings and objects are walked over, each at least one byte,
 * so that a count cannot make more steps than there are bytes. */
static bool array_size(char type, uint32_t count, const unsigned char *at, size_t n, size_t *n_byte)
{
    const size_t size = type == 'c' ? 1 : type == 'i' ? 4 : 8;
    *n_byte = 0;
    if (type == 'c' || type == 'i' || type == 'q' || type == 'd') {
        *n_byte = count * size;
        return count <= n / size;
    }
    for (uint32_t i = 0; i < count; i++) {
        const size_t one = value_size(type, at + *n_byte, n - *n_byte, false);
        if (one == 0)
            return false;
        *n_byte += one;
    }
    return true;
}

/* The type that a number stands for in containers of version 1; NUL if it is unknown. */
static char type_of_number(uint32_t number)
{
    static const struct {
        unsigned char number;
        char type;
    } TYPES[] = {{12, 'c'}, {16, 'c'}, {20, 'b'}, {24, 'i'}, {28, 'i'},
                 {40, 'q'}, {44, 'q'}, {60, 'd'}, {64, 's'}, {80, 'o'}};
    for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++) {
        if (TYPES[i].number == number)
            return TYPES[i].type;
    }
    return '\0';
}

static char lower(char type)
{
    return (char)(type >= 'A' && type <= 'Z' ? type - 'A' + 'a' : type);
}

/* Reads name and type; *at is then where the value or an array's count begins. */
static bool read_head(const dif_gwy_items *items, const unsigned char **at, dif_gwy_item *out)
{
    const size_t n_number = items->is_v1 ? 4 : 0;
    if ((size_t)(items->end - items->at) < n_number)
        return false;
    const unsigned char *name = items->at + n_number;
    const size_t n_name = string_size(name, (size_t)(items->end - name));
    if (n_name == 0)
        return false;
    out->name = (const char *)name;
    *at = name + n_name;
    if (items->is_v1)
        out->type = type_of_number(u32(items->at));
    else
        out->type = (char)(*at < items->end ? *(*at)++ : '\0');
    return out->type != '\0';
}

bool dif_gwy_next(dif_gwy_items *items, dif_gwy_item *out)
{
    if (items->at >= items->end || items->broken)
        return false;
    const unsigned char *at = NULL;
    items->broken = true; /* until it is read */
    *out = (dif_gwy_item){0};
    if (!read_head(items, &at, out))
        return false;
    const bool is_array = out->type != lower(out->type);
    size_t n = (size_t)(items->end - at);
    if (is_array && n < 4)
        return false;
    if (is_array) {
        out->n = u32(at);
        at += 4;
        if (!strchr("CIQDSO", out->type) || !array_size(lower(out->type), out->n, at, n - 4, &out->n_byte))
            return false;
    } else {
        out->n_byte = value_size(out->type, at, n, items->is_v1);
        if (out->n_byte == 0)
            return false;
    }
    out->value = at;
    items->at = at + out->n_byte;
    items->broken = false;
    return true;
}

bool dif_gwy_is(const dif_gwy_item *item, const char *name, char type)
{
    return item->type == type && strcmp(item->name, name) == 0;
}

int32_t dif_gwy_int(const dif_gwy_item *item)
{
    double value = 0.0;
    dif_sample_read(DIF_SAMPLE_S32, item->value, 1, &value);
    return (int32_t)value;
}

double dif_gwy_double(const dif_gwy_item *item)
{
    double value = 0.0;
    dif_sample_read(DIF_SAMPLE_F64, item->value, 1, &value);
    return value;
}
