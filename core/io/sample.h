/* Little-endian samples of the kinds that surface files hold. Internal to core/io. */
#ifndef DIF_SAMPLE_H
#define DIF_SAMPLE_H

#include <stddef.h>
#include <stdint.h>

/* The numbers are SDF's DataType. */
typedef enum dif_sample_kind {
    DIF_SAMPLE_U8,
    DIF_SAMPLE_U16,
    DIF_SAMPLE_U32,
    DIF_SAMPLE_F32,
    DIF_SAMPLE_S8,
    DIF_SAMPLE_S16,
    DIF_SAMPLE_S32,
    DIF_SAMPLE_F64,
    DIF_SAMPLE_KINDS
} dif_sample_kind;

/* Bytes of one sample: 1, 2, 4 or 8. */
size_t dif_sample_size(dif_sample_kind kind);

/* The n samples at bytes[n * size], exact as doubles. */
void dif_sample_read(dif_sample_kind kind, const unsigned char *bytes, size_t n, double *out);

#endif
