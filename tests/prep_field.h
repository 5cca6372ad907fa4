/* Fields that the tests of preparation share. */
#ifndef DIF_TEST_PREP_FIELD_H
#define DIF_TEST_PREP_FIELD_H

#include <stdbool.h>
#include <string.h>

#include "core/field.h"
#include "core/prep.h"
#include "core/units.h"
#include "near.h"

enum { NX = 61, NY = 47 };

static inline double *at(const dif_field *field, int ix, int iy)
{
    return field->z_um + (size_t)iy * (size_t)field->nx + (size_t)ix;
}

static inline dif_field blank(int nx, int ny, double pitch_x_um, double pitch_y_um)
{
    dif_field field;
    assert_int_equal(dif_field_create(nx, ny, pitch_x_um, pitch_y_um, &field, NULL), DIF_OK);
    return field;
}

static inline dif_field copy(const dif_field *field)
{
    dif_field out = blank(field->nx, field->ny, field->pitch_x_um, field->pitch_y_um);
    memcpy(out.z_um, field->z_um, dif_field_n(field) * sizeof *out.z_um);
    return out;
}

static inline bool is_same(const dif_field *a, const dif_field *b)
{
    return a->nx == b->nx && a->ny == b->ny && memcmp(a->z_um, b->z_um, dif_field_n(a) * sizeof *a->z_um) == 0;
}

/* A sine of period 0.7 um along x and 0.1 um amplitude, sampled at whole periods' distance from nothing. */
static inline dif_field sine(void)
{
    dif_field field = blank(NX, NY, 0.05, 0.04);
    for (int iy = 0; iy < NY; iy++)
        for (int ix = 0; ix < NX; ix++)
            *at(&field, ix, iy) = 0.1 * sin(DIF_TWO_PI * dif_field_x_um(&field, ix) / 0.7 + 0.3);
    return field;
}

#endif
