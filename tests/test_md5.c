#include "core/io/md5.h"

#include "tests/near.h"

#include <string.h>

/* The test suite of RFC 1321, A.5. */
static void test_hex__agrees_with_the_standard(void **state)
{
    (void)state;
    static const char *const CASES[][2] = {
        {"", "d41d8cd98f00b204e9800998ecf8427e"},
        {"a", "0cc175b9c0f1b6a831c399e269772661"},
        {"abc", "900150983cd24fb0d6963f7d28e17f72"},
        {"message digest", "f96b697d7cb7938d525a2f31aaf161d0"},
        {"abcdefghijklmnopqrstuvwxyz", "c3fcd3d76192e4007dfb496cca67e13b"},
        {"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789", "d174ab98d277d9f5a5611c2c9f419d9f"},
        {"12345678901234567890123456789012345678901234567890123456789012345678901234567890",
         "57edf4a22be3c955ac49da2e2107b67a"},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        char hex[33];
        dif_md5 sum = dif_md5_begin();
        dif_md5_add(&sum, CASES[i][0], strlen(CASES[i][0]));
        dif_md5_hex(&sum, hex);
        assert_string_equal(hex, CASES[i][1]);
    }
}

static void test_add__pieces_do_not_matter(void **state)
{
    (void)state;
    unsigned char data[300];
    char whole[33], parts[33];
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)(7 * i);
    for (size_t n = 0; n <= sizeof data; n += 13) {
        for (size_t step = 1; step < 130; step += 9) {
            dif_md5 one = dif_md5_begin(), many = dif_md5_begin();
            dif_md5_add(&one, data, n);
            for (size_t at = 0; at < n; at += step)
                dif_md5_add(&many, data + at, step < n - at ? step : n - at);
            dif_md5_hex(&one, whole);
            dif_md5_hex(&many, parts);
            assert_string_equal(whole, parts);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hex__agrees_with_the_standard),
        cmocka_unit_test(test_add__pieces_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
