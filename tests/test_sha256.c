#include "tests/near.h"

#include <string.h>

#include "core/io/manifest.h"
#include "core/io/sha256.h"

static void expect_sum(const void *data, size_t n, const char *want)
{
    char hex[65];
    dif_sha256_hex(data, n, hex);
    assert_string_equal(hex, want);
}

/* The examples of FIPS 180-4's companion document, and the empty message. */
static void test_hex__published_examples(void **state)
{
    (void)state;
    expect_sum("", 0, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    expect_sum("abc", 3, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    const char *two_blocks = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    expect_sum(two_blocks, strlen(two_blocks), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    static char million[1000000];
    memset(million, 'a', sizeof million);
    expect_sum(million, sizeof million, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}

/* Any cutting into pieces gives the same sum, at every length around a block. */
static void test_add__pieces_do_not_matter(void **state)
{
    (void)state;
    unsigned char data[200];
    uint64_t seed = 3;
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)test_random_next(&seed);
    for (size_t n = 0; n < sizeof data; n++) {
        char whole[65], pieces[65];
        dif_sha256_hex(data, n, whole);
        dif_sha256 sha = dif_sha256_begin();
        for (size_t at = 0; at < n;) {
            const size_t left = n - at, step = 1 + (size_t)(test_random_next(&seed) % 70);
            dif_sha256_add(&sha, data + at, step < left ? step : left);
            at += step < left ? step : left;
        }
        dif_sha256_end(&sha, pieces);
        assert_string_equal(whole, pieces);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hex__published_examples),
        cmocka_unit_test(test_add__pieces_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
