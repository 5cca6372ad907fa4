/* Small Gwyddion files, put together item by item. */
#ifndef DIF_TEST_GWY_SAMPLE_H
#define DIF_TEST_GWY_SAMPLE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { GWY_MAX = 8192 };

typedef struct gwy_file {
    unsigned char data[GWY_MAX];
    size_t n;
} gwy_file;

static inline void gwy_bytes(gwy_file *file, const void *bytes, size_t n)
{
    if (n > GWY_MAX - file->n)
        abort();
    memcpy(file->data + file->n, bytes, n);
    file->n += n;
}

static inline void gwy_u32(gwy_file *file, uint32_t value)
{
    for (int k = 0; k < 4; k++) {
        const unsigned char byte = (unsigned char)(value >> (8 * k));
        gwy_bytes(file, &byte, 1);
    }
}

static inline void gwy_real(gwy_file *file, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    gwy_u32(file, (uint32_t)bits);
    gwy_u32(file, (uint32_t)(bits >> 32));
}

/* Name and type of an item; a capital letter is an array. In a container of version 1 the type is a number. */
static inline void gwy_key(gwy_file *file, const char *name, char type)
{
    gwy_bytes(file, name, strlen(name) + 1);
    gwy_bytes(file, &type, 1);
}

static inline void gwy_key_v1(gwy_file *file, uint32_t type, const char *name)
{
    gwy_u32(file, type);
    gwy_bytes(file, name, strlen(name) + 1);
}

static inline void gwy_text(gwy_file *file, const char *name, const char *text)
{
    gwy_key(file, name, 's');
    gwy_bytes(file, text, strlen(text) + 1);
}

static inline void gwy_int(gwy_file *file, const char *name, int32_t value)
{
    gwy_key(file, name, 'i');
    gwy_u32(file, (uint32_t)value);
}

static inline void gwy_double(gwy_file *file, const char *name, double value)
{
    gwy_key(file, name, 'd');
    gwy_real(file, value);
}

/* Begins an object; returns where its size stands, for gwy_close. */
static inline size_t gwy_open(gwy_file *file, const char *name)
{
    gwy_bytes(file, name, strlen(name) + 1);
    gwy_u32(file, 0);
    return file->n - 4;
}

static inline void gwy_close(gwy_file *file, size_t at)
{
    const size_t n = file->n, size = n - at - 4;
    file->n = at;
    gwy_u32(file, (uint32_t)size);
    file->n = n;
}

static inline void gwy_unit(gwy_file *file, const char *name, const char *unit)
{
    gwy_key(file, name, 'o');
    const size_t at = gwy_open(file, "GwySIUnit");
    gwy_text(file, "unitstr", unit);
    gwy_close(file, at);
}

/* The object of 3 x 2 samples `first`, first + 1e-9, ... over 3 x 4 (1e-6 of the unit); a NULL unit is left out. */
static inline void gwy_field_object(gwy_file *file, double first, const char *unit_xy, const char *unit_z)
{
    const size_t at = gwy_open(file, "GwyDataField");
    gwy_int(file, "xres", 3);
    gwy_int(file, "yres", 2);
    gwy_double(file, "xreal", 3e-6);
    gwy_double(file, "yreal", 4e-6);
    if (unit_xy)
        gwy_unit(file, "si_unit_xy", unit_xy);
    if (unit_z)
        gwy_unit(file, "si_unit_z", unit_z);
    gwy_key(file, "data", 'D');
    gwy_u32(file, 6);
    for (int i = 0; i < 6; i++)
        gwy_real(file, first + 1e-9 * i);
    gwy_close(file, at);
}

static inline size_t gwy_begin(gwy_file *file, const char *magic)
{
    file->n = 0;
    gwy_bytes(file, magic, 4);
    return gwy_open(file, "GwyContainer");
}

/* Items of every type besides two channels, the second one, with a title, first. */
static inline void gwy_full(gwy_file *file)
{
    const size_t at = gwy_begin(file, "GWYP");
    gwy_key(file, "/0/flag", 'b');
    gwy_bytes(file, "\1", 1);
    gwy_key(file, "/0/letter", 'c');
    gwy_bytes(file, "x", 1);
    gwy_key(file, "/0/long", 'q');
    gwy_real(file, 0.0);
    gwy_key(file, "/letters", 'C');
    gwy_u32(file, 3);
    gwy_bytes(file, "abc", 3);
    gwy_key(file, "/numbers", 'I');
    gwy_u32(file, 1);
    gwy_u32(file, 7);
    gwy_key(file, "/longs", 'Q');
    gwy_u32(file, 1);
    gwy_real(file, 0.0);
    gwy_key(file, "/texts", 'S');
    gwy_u32(file, 2);
    gwy_bytes(file, "one\0two", 8);
    gwy_key(file, "/3/data", 'o');
    gwy_field_object(file, 1e-9, "m", "m");
    gwy_text(file, "/3/data/title", "Height");
    gwy_key(file, "/objects", 'O');
    gwy_u32(file, 2);
    gwy_field_object(file, 0.0, NULL, NULL);
    gwy_close(file, gwy_open(file, "GwyNothing"));
    gwy_key(file, "/3/mask", 'o');
    gwy_field_object(file, 0.0, NULL, NULL);
    gwy_key(file, "/0/data", 'o');
    gwy_field_object(file, 5e-9, "m", "V");
    gwy_close(file, at);
}

#endif
