/* The one door to the heap: overflow-checked, zero-filled, 64-byte aligned blocks.
 * Tests link another definition that fails the k-th call and counts live blocks.
 * Does not: report errors; a caller turns NULL into DIF_ERR_NOMEM. */
#ifndef DIF_ALLOC_H
#define DIF_ALLOC_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Block of n items of the given size, zero-filled, 64-byte aligned.
 * Returns   the block (a valid pointer also for n = 0), or NULL if n * size overflows or memory is short
 * Owns      the caller, until dif_release */
void *dif_alloc(size_t n, size_t size);

/* Gives a block back; accepts NULL. */
void dif_release(void *block);

#ifdef __cplusplus
}
#endif
#endif
