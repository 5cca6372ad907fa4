#include "core/alloc.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { DIF_ALIGN = 64 };

void *dif_alloc(size_t n, size_t size)
{
    if (size != 0 && n > (SIZE_MAX - DIF_ALIGN) / size)
        return NULL;
    size_t n_byte = (n * size + DIF_ALIGN - 1) / DIF_ALIGN * DIF_ALIGN;
    if (n_byte == 0)
        n_byte = DIF_ALIGN;
    void *block = aligned_alloc(DIF_ALIGN, n_byte);
    if (block)
        memset(block, 0, n_byte);
    return block;
}

void dif_release(void *block)
{
    free(block);
}
