/* The serialised objects of a Gwyddion file: items of a name, a type and a value, one after the other. An object is its
 * name, its size and its items; nothing here follows an object into itself, so no file makes it go deep.
 * Internal to core/io. Does not: know what objects mean. */
#ifndef DIF_GWY_TREE_H
#define DIF_GWY_TREE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The items of an object that are left. */
typedef struct dif_gwy_items {
    const unsigned char *at, *end;
    bool is_v1; /* of a container of version 1: a number for the type comes first */
    bool broken;
} dif_gwy_items;

typedef struct dif_gwy_item {
    const char *name; /* NUL-terminated                                                                     */
    char type;        /* b c i q d s o; C I Q D S O are arrays                                               */
    uint32_t n;       /* of an array                                                                        */
    const unsigned char *value; /* value[n_byte]; of a string with its NUL, of an object with name and size */
    size_t n_byte;
} dif_gwy_item;

/* The next item; false at the end, and at an item that does not fit (items->broken). */
bool dif_gwy_next(dif_gwy_items *items, dif_gwy_item *out);

/* The name and the items of an object that begins at at[n]; false if it does not fit. Its size is *n_byte. */
bool dif_gwy_object(const unsigned char *at, size_t n, bool is_v1, const char **name, dif_gwy_items *items,
                    size_t *n_byte);

bool dif_gwy_is(const dif_gwy_item *item, const char *name, char type);
int32_t dif_gwy_int(const dif_gwy_item *item);
double dif_gwy_double(const dif_gwy_item *item);

#endif
