#define _DEFAULT_SOURCE /* madvise */
#include "core/alloc.h"

#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>

/* A block is calloc's, so that large ones are fresh pages that nobody has to clear; the pointer that free wants lies just
 * below the aligned block. */
enum { DIF_ALIGN = 64, DIF_HEAD = DIF_ALIGN + sizeof(void *) };
static const size_t HUGE_FROM = (size_t)8 << 20; /* from here on huge pages are worth asking for */
static const uintptr_t PAGE = 4096;

/* Asks for huge pages: planes are read all over, and small pages miss the address cache. A refusal costs nothing. */
static void prefer_huge_pages(void *block, size_t n_byte)
{
#ifdef MADV_HUGEPAGE
    const uintptr_t first = ((uintptr_t)block + PAGE - 1) / PAGE * PAGE,
                    end = ((uintptr_t)block + n_byte) / PAGE * PAGE;
    if (n_byte >= HUGE_FROM && end > first)
        (void)madvise((char *)block + (first - (uintptr_t)block), end - first, MADV_HUGEPAGE);
#else
    (void)block;
    (void)n_byte;
#endif
}

void *dif_alloc(size_t n, size_t size)
{
    if (size != 0 && n > (SIZE_MAX - DIF_HEAD) / size)
        return NULL;
    char *base = calloc(1, n * size + DIF_HEAD);
    if (!base)
        return NULL;
    char *block = base + sizeof(void *);
    block += (DIF_ALIGN - (uintptr_t)block % DIF_ALIGN) % DIF_ALIGN;
    ((void **)block)[-1] = base;
    prefer_huge_pages(block, n * size);
    return block;
}

void dif_release(void *block)
{
    if (block)
        free(((void **)block)[-1]);
}
