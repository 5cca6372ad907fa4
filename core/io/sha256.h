/* SHA-256 of FIPS 180-4, in pieces. Internal to core/io (dif_sha256_hex of manifest.h does it in one go). */
#ifndef DIF_SHA256_H
#define DIF_SHA256_H

#include <stddef.h>
#include <stdint.h>

typedef struct dif_sha256 {
    uint32_t state[8];
    uint64_t n_byte;
    unsigned char block[64]; /* the n_byte % 64 bytes not yet taken in */
} dif_sha256;

dif_sha256 dif_sha256_begin(void);
void dif_sha256_add(dif_sha256 *sha, const void *data, size_t n);
void dif_sha256_end(dif_sha256 *sha, char hex[65]);

#endif
