#include "core/io/sample.h"

#include <string.h>

size_t dif_sample_size(dif_sample_kind kind)
{
    static const unsigned char SIZES[DIF_SAMPLE_KINDS] = {1, 2, 4, 4, 1, 2, 4, 8};
    return SIZES[kind];
}

static uint64_t little(const unsigned char *byte, size_t n)
{
    uint64_t value = 0;
    for (size_t i = 0; i < n; i++)
        value |= (uint64_t)byte[i] << 8 * i;
    return value;
}

/* An unsigned number of so many bits as two's complement. */
static double signed_of(uint64_t value, int bits)
{
    const uint64_t half = (uint64_t)1 << (bits - 1);
    return (double)((int64_t)(value ^ half) - (int64_t)half);
}

static double sample_of(dif_sample_kind kind, uint64_t value)
{
    const uint32_t low = (uint32_t)value;
    float single;
    double twice;
    switch (kind) {
    case DIF_SAMPLE_F32:
        memcpy(&single, &low, sizeof single);
        return (double)single;
    case DIF_SAMPLE_F64:
        memcpy(&twice, &value, sizeof twice);
        return twice;
    case DIF_SAMPLE_S8:
        return signed_of(value, 8);
    case DIF_SAMPLE_S16:
        return signed_of(value, 16);
    case DIF_SAMPLE_S32:
        return signed_of(value, 32);
    default:
        return (double)low;
    }
}

void dif_sample_read(dif_sample_kind kind, const unsigned char *bytes, size_t n, double *out)
{
    const size_t size = dif_sample_size(kind);
    for (size_t i = 0; i < n; i++)
        out[i] = sample_of(kind, little(bytes + i * size, size));
}
