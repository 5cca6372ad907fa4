#include "tests/alloc_count.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/alloc.h"

static atomic_int n_call, n_live, fail_from;

void test_alloc_fail_from(int k)
{
    n_call = 0;
    fail_from = k;
}

int test_alloc_calls(void)
{
    return n_call;
}

int test_alloc_live(void)
{
    return n_live;
}

void *dif_alloc(size_t n, size_t size)
{
    const int call = ++n_call;
    if (fail_from > 0 && call >= fail_from)
        return NULL;
    if (size != 0 && n > ((size_t)-1 - 64) / size)
        return NULL;
    const size_t n_byte = (n * size + 64) / 64 * 64;
    void *block = aligned_alloc(64, n_byte);
    if (block) {
        memset(block, 0, n_byte);
        n_live++;
    }
    return block;
}

void dif_release(void *block)
{
    if (block)
        n_live--;
    free(block);
}
