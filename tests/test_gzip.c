#include "core/io/gzip.h"

#include "tests/gzip_sample.h"
#include "tests/io_cases.h"

static const char TEXT[] = "# Channel: T\n# Width: 6 um\n# Height: 2 um\n# Value units: nm\n1 2 3\n4 5 6\n";

static void expect_field(const void *data, size_t n)
{
    dif_field_file file;
    dif_error err;
    if (parse_bytes(data, n, NULL, &file, &err))
        fail_msg("%s", err.text);
    assert_string_equal(file.format, "text");
    assert_int_equal(file.field.nx * 10 + file.field.ny, 32);
    assert_near(file.field.z_um[5], 6e-3, 4e-16, 0.0);
    dif_field_file_free(&file);
}

static void test_parse__packed_files_are_read_as_what_they_hold(void **state)
{
    (void)state;
    unsigned char packed[1000];
    dif_channels channels;
    dif_error err;
    const size_t n = gzip_sample(TEXT, sizeof TEXT - 1, packed, sizeof packed);
    expect_field(packed, n);
    memset(packed + n, 0, 100); /* what fills a block of a tape */
    expect_field(packed, n + 100);
    assert_int_equal(dif_field_channels_parse(packed, n, "f", &channels, &err), DIF_OK);
    assert_int_equal(channels.n, 1);
    assert_string_equal(channels.channel[0].name, "T");
    dif_channels_free(&channels);
}

static void test_unpack__members_follow_each_other(void **state)
{
    (void)state;
    unsigned char packed[1000];
    size_t n = gzip_sample(TEXT, 70, packed, sizeof packed);
    n += gzip_sample(TEXT + 70, sizeof TEXT - 1 - 70, packed + n, sizeof packed - n);
    expect_field(packed, n);
}

static void test_unpack__large_contents_come_out_whole(void **state)
{
    (void)state;
    enum { N = 3000000 };
    unsigned char *data = malloc(N), *packed = malloc(N);
    assert_true(data && packed);
    uint64_t seed = 3;
    for (size_t i = 0; i < N; i++)
        data[i] = i < N / 2 ? 'a' : (unsigned char)(test_random_next(&seed) & 15);
    const size_t n = gzip_sample(data, N, packed, N);
    const dif_source source = dif_source_of(packed, n, "f");
    unsigned char *out = NULL;
    size_t n_out = 0;
    dif_error err;
    assert_int_equal(dif_gzip_unpack(&source, DIF_GZIP_OUT_MAX, &out, &n_out, &err), DIF_OK);
    assert_int_equal(n_out, N);
    assert_memory_equal(out, data, N);
    dif_release(out);
    free(data);
    free(packed);
}

static void test_unpack__damage_is_said(void **state)
{
    (void)state;
    unsigned char packed[1000];
    size_t n = gzip_sample(TEXT, sizeof TEXT - 1, packed, sizeof packed);
    packed[n - 6] ^= 1; /* the check sum */
    assert_parse_fails(packed, n, NULL, DIF_ERR_FORMAT, "damaged gzip archive: incorrect data check");
    packed[n - 6] ^= 1;
    memcpy(packed + n, "more", 4);
    assert_parse_fails(packed, n + 4, NULL, DIF_ERR_FORMAT, "damaged gzip archive: incorrect header check");
    packed[2] = 7;
    assert_parse_fails(packed, n, NULL, DIF_ERR_FORMAT, "damaged gzip archive: unknown compression method");
}

static void test_parse__an_archive_in_an_archive_is_refused(void **state)
{
    (void)state;
    unsigned char once[1000], twice[1000];
    const size_t n = gzip_sample(TEXT, sizeof TEXT - 1, once, sizeof once);
    const size_t n_twice = gzip_sample(once, n, twice, sizeof twice);
    assert_parse_fails(twice, n_twice, NULL, DIF_ERR_UNSUPPORTED, "a gzip archive within a gzip archive");
    const size_t n_empty = gzip_sample("", 0, once, sizeof once);
    assert_parse_fails(once, n_empty, NULL, DIF_ERR_FORMAT, "empty file");
}

/* A megabyte of zeros in a kilobyte. */
static void test_unpack__a_bomb_stops_at_the_cap(void **state)
{
    (void)state;
    enum { N = 1 << 20 };
    static unsigned char zeros[N], packed[N / 100];
    const size_t n = gzip_sample(zeros, N, packed, sizeof packed);
    const dif_source source = dif_source_of(packed, n, "f");
    unsigned char *out = NULL;
    size_t n_out = 1;
    dif_error err;
    assert_int_equal(dif_gzip_unpack(&source, N, &out, &n_out, &err), DIF_OK);
    assert_int_equal(n_out, N);
    dif_release(out);
    assert_int_equal(dif_gzip_unpack(&source, N - 1, &out, &n_out, &err), DIF_ERR_SIZE);
    assert_string_equal(err.text, "f: the gzip archive holds more than 1048575 bytes");
    assert_true(!out && n_out == 0 && test_alloc_live() == 0);
}

static void test_parse__every_beginning_is_refused(void **state)
{
    (void)state;
    unsigned char packed[1000];
    const size_t n = gzip_sample(TEXT, sizeof TEXT - 1, packed, sizeof packed);
    assert_int_equal(count_accepted_beginnings(packed, n, NULL), 0);
}

static void test_parse__failing_heap_is_said(void **state)
{
    (void)state;
    unsigned char packed[1000];
    const size_t n = gzip_sample(TEXT, sizeof TEXT - 1, packed, sizeof packed);
    assert_true(parse_with_failing_heap(packed, n, NULL) >= 3); /* zlib's own blocks, the text, the numbers */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parse__packed_files_are_read_as_what_they_hold),
        cmocka_unit_test(test_unpack__members_follow_each_other),
        cmocka_unit_test(test_unpack__large_contents_come_out_whole),
        cmocka_unit_test(test_unpack__damage_is_said),
        cmocka_unit_test(test_parse__an_archive_in_an_archive_is_refused),
        cmocka_unit_test(test_unpack__a_bomb_stops_at_the_cap),
        cmocka_unit_test(test_parse__every_beginning_is_refused),
        cmocka_unit_test(test_parse__failing_heap_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
