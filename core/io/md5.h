/* MD5 (RFC 1321), which x3p files carry as a check sum. Internal to core/io. Does not: protect anything. */
#ifndef DIF_MD5_H
#define DIF_MD5_H

#include <stddef.h>
#include <stdint.h>

typedef struct dif_md5 {
    uint32_t state[4];
    unsigned char block[64];
    uint64_t n; /* bytes so far */
} dif_md5;

dif_md5 dif_md5_begin(void);
void dif_md5_add(dif_md5 *sum, const void *data, size_t n);

/* The sum as 32 small hex digits and a NUL. */
void dif_md5_hex(const dif_md5 *sum, char hex[33]);

#endif
