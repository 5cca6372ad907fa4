#include "tests/near.h"

#include <string.h>

#include "core/alloc.h"

static void test_alloc__is_zero_filled_and_aligned(void **state)
{
    (void)state;
    for (size_t n = 1; n <= 300; n += 13) {
        unsigned char *block = dif_alloc(n, 7);
        assert_non_null(block);
        assert_int_equal((uintptr_t)block % 64, 0);
        for (size_t i = 0; i < 7 * n; i++)
            assert_int_equal(block[i], 0);
        memset(block, 0xa5, 7 * n); /* a sanitizer sees a block that is too short */
        dif_release(block);
    }
}

static void test_alloc__nothing_is_a_valid_block(void **state)
{
    (void)state;
    void *none = dif_alloc(0, 8);
    void *empty = dif_alloc(8, 0);
    assert_non_null(none);
    assert_non_null(empty);
    dif_release(none);
    dif_release(empty);
    dif_release(NULL);
}

static void test_alloc__overflow_is_refused(void **state)
{
    (void)state;
    const size_t half = SIZE_MAX / 2 + 1;
    assert_null(dif_alloc(half, 2));
    assert_null(dif_alloc(2, half));
    assert_null(dif_alloc(SIZE_MAX, 1)); /* rounding up to whole lines would wrap */
    assert_null(dif_alloc(SIZE_MAX / 8 + 2, 8));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_alloc__is_zero_filled_and_aligned),
        cmocka_unit_test(test_alloc__nothing_is_a_valid_block),
        cmocka_unit_test(test_alloc__overflow_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
