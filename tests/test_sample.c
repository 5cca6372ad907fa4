#include "core/io/sample.h"

#include "tests/near.h"

/* Bytes of each kind and what they are. */
static const struct {
    dif_sample_kind kind;
    size_t size;
    unsigned char bytes[16]; /* two samples */
    double want[2];
} KINDS[] = {
    {DIF_SAMPLE_U8, 1, {0x7f, 0xff}, {127, 255}},
    {DIF_SAMPLE_S8, 1, {0x7f, 0x80}, {127, -128}},
    {DIF_SAMPLE_U16, 2, {0x01, 0x02, 0xff, 0xff}, {513, 65535}},
    {DIF_SAMPLE_S16, 2, {0xfe, 0xff, 0x00, 0x80}, {-2, -32768}},
    {DIF_SAMPLE_U32, 4, {1, 0, 0, 0x80, 0xff, 0xff, 0xff, 0xff}, {2147483649.0, 4294967295.0}},
    {DIF_SAMPLE_S32, 4, {1, 0, 0, 0x80, 0xff, 0xff, 0xff, 0xff}, {-2147483647.0, -1}},
    {DIF_SAMPLE_F32, 4, {0, 0, 0x80, 0x3f, 0, 0, 0x20, 0xc1}, {1.0, -10.0}},
    {DIF_SAMPLE_F64, 8, {0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0x9a, 0x99, 0x99, 0x99, 0x99, 0x99, 0xb9, 0xbf}, {1.0, -0.1}},
};

static void test_read__each_kind_is_exact(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof KINDS / sizeof *KINDS; i++) {
        double got[2];
        assert_int_equal(dif_sample_size(KINDS[i].kind), KINDS[i].size);
        dif_sample_read(KINDS[i].kind, KINDS[i].bytes, 2, got);
        assert_true(got[0] == KINDS[i].want[0] && got[1] == KINDS[i].want[1]);
    }
    assert_int_equal(sizeof KINDS / sizeof *KINDS, DIF_SAMPLE_KINDS);
}

static void test_read__non_finite_floats_stay_so(void **state)
{
    (void)state;
    static const unsigned char SINGLE[] = {0, 0, 0xc0, 0x7f, 0, 0, 0x80, 0xff};
    double got[2];
    dif_sample_read(DIF_SAMPLE_F32, SINGLE, 2, got);
    assert_true(isnan(got[0]) && got[1] == -(double)INFINITY);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__each_kind_is_exact),
        cmocka_unit_test(test_read__non_finite_floats_stay_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
