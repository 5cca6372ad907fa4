/* A rough random surface for the tests of the transforms: every height differs, nothing is symmetric. */
#ifndef DIF_TEST_ROUGH_H
#define DIF_TEST_ROUGH_H

#include "core/field.h"
#include "near.h"

static inline dif_field test_rough_field(int nx, int ny, double pitch_x_um, double pitch_y_um, double height_um,
                                         uint64_t seed)
{
    dif_field field;
    assert_int_equal(dif_field_create(nx, ny, pitch_x_um, pitch_y_um, &field, NULL), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] = test_random(&seed, 0.1, 0.1 + height_um);
    return field;
}

#endif
