#include "core/io/zip.h"

#include "core/alloc.h"
#include "tests/alloc_count.h"
#include "tests/x3p_sample.h"

typedef struct collected {
    unsigned char data[100000];
    size_t n;
    int n_piece;
    dif_status answer;
} collected;

static dif_status collect(void *self, const unsigned char *data, size_t n, dif_error *err)
{
    collected *all = self;
    if (all->answer)
        return dif_fail(err, all->answer, "enough");
    assert_in_range(n, 1, DIF_ZIP_CHUNK);
    assert_true(all->n % DIF_ZIP_CHUNK == 0); /* only the last piece is short */
    memcpy(all->data + all->n, data, n);
    all->n += n;
    all->n_piece++;
    return DIF_OK;
}

static void test_find__compares_letters_and_slashes_loosely(void **state)
{
    (void)state;
    const x3p_file files[] = {{"top/", NULL, 0}, {"top/A/One.bin", "1", 1}, {"one.bin", "2", 1}, {0}};
    const zip_bytes bytes = zip_make(files, ZIP_CM_STORE);
    const dif_source source = dif_source_of(bytes.data, bytes.n, "f");
    dif_zip *zip = NULL;
    dif_error err;
    size_t n_folder = 99;
    assert_int_equal(dif_zip_open(&source, &zip, &err), DIF_OK);
    assert_int_equal(dif_zip_find(zip, "", 0, "top/a/ONE.bin"), 1);
    assert_int_equal(dif_zip_find(zip, "top/xx", 4, "A\\One.bin"), 1);
    assert_int_equal(dif_zip_find(zip, "top/", 4, ".\\a/one.bin"), 1);
    assert_int_equal(dif_zip_find(zip, "", 0, "two.bin"), -1);
    assert_int_equal(dif_zip_find(zip, "", 0, ""), -1);
    assert_int_equal(dif_zip_find_name(zip, "one.bin", &n_folder), 2);
    assert_int_equal(n_folder, 0);
    assert_int_equal(dif_zip_find_name(zip, "ne.bin", &n_folder), -1);
    assert_string_equal(dif_zip_path(zip, 1), "top/A/One.bin");
    dif_zip_close(zip);
    dif_zip_close(NULL);
    free(bytes.data);
}

static void test_read__pieces_make_the_whole(void **state)
{
    (void)state;
    static unsigned char data[50000];
    static collected all;
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (unsigned char)(i * i >> 3);
    const x3p_file files[] = {{"a", data, sizeof data}, {"b", data, DIF_ZIP_CHUNK}, {"c", "", 0}, {0}};
    for (int method = 0; method < 2; method++) {
        const zip_bytes bytes = zip_make(files, method ? ZIP_CM_DEFLATE : ZIP_CM_STORE);
        const dif_source source = dif_source_of(bytes.data, bytes.n, "f");
        dif_zip *zip = NULL;
        dif_error err;
        assert_int_equal(dif_zip_open(&source, &zip, &err), DIF_OK);
        for (int i = 0; i < 3; i++) {
            unsigned long long n = 0;
            memset(&all, 0, sizeof all);
            assert_int_equal(dif_zip_size(zip, i, &n, &err), DIF_OK);
            assert_int_equal(n, files[i].n);
            assert_int_equal(dif_zip_read(zip, i, collect, &all, &err), DIF_OK);
            assert_int_equal(all.n, files[i].n);
            assert_int_equal(all.n_piece, (files[i].n + DIF_ZIP_CHUNK - 1) / DIF_ZIP_CHUNK);
            assert_memory_equal(all.data, files[i].data, files[i].n);
        }
        all.answer = DIF_ERR_SIZE; /* what takes the pieces may stop */
        assert_int_equal(dif_zip_read(zip, 0, collect, &all, &err), DIF_ERR_SIZE);
        assert_string_equal(err.text, "enough");
        dif_zip_close(zip);
        free(bytes.data);
    }
}

static long find_bytes(zip_bytes bytes, const char *what, size_t n)
{
    for (size_t i = bytes.n - n; i > 0; i--) {
        if (memcmp(bytes.data + i, what, n) == 0)
            return (long)i;
    }
    return -1;
}

/* Changes the central directory's entry of the only file: n bytes at an offset within it. */
static void expect_entry(size_t offset, uint32_t value, size_t n, dif_status want, const char *part)
{
    static collected all;
    const x3p_file files[] = {{"a", "some text of 22 letters", 22}, {0}};
    const zip_bytes bytes = zip_make(files, ZIP_CM_STORE);
    const long entry = find_bytes(bytes, "PK\x01\x02", 4);
    assert_true(entry > 0);
    for (size_t i = 0; i < n; i++)
        bytes.data[(size_t)entry + offset + i] = (unsigned char)(value >> 8 * i);
    const dif_source source = dif_source_of(bytes.data, bytes.n, "f");
    dif_zip *zip = NULL;
    dif_error err = {0};
    memset(&all, 0, sizeof all);
    dif_status status = dif_zip_open(&source, &zip, &err);
    if (!status)
        status = dif_zip_read(zip, 0, collect, &all, &err);
    dif_zip_close(zip);
    free(bytes.data);
    assert_int_equal(status, want);
    if (!strstr(err.text, part))
        fail_msg("'%s' does not hold '%s'", err.text, part);
}

static void test_read__directories_that_lie_are_found_out(void **state)
{
    (void)state;
    expect_entry(16, 0xdeadbeef, 4, DIF_ERR_FORMAT, "CRC error");
    expect_entry(24, 23, 4, DIF_ERR_FORMAT, "cannot unpack from 22 to 23 bytes (damaged?)");
    expect_entry(24, 21, 4, DIF_ERR_FORMAT, "f: "); /* fewer than there are */
    expect_entry(24, 0x7fffffff, 4, DIF_ERR_FORMAT, "cannot unpack from 22 to 2147483647 bytes");
    expect_entry(20, 100000, 4, DIF_ERR_FORMAT, "f: "); /* packed bytes past the archive's end */
    expect_entry(10, 12, 2, DIF_ERR_UNSUPPORTED, "a is packed by method 12, want stored or deflate");
    expect_entry(8, 1, 2, DIF_ERR_UNSUPPORTED, "a is encrypted");
    expect_entry(0, 0, 4, DIF_ERR_FORMAT, "damaged zip archive (truncated?)");
}

static void test_open__failing_heap_is_said(void **state)
{
    (void)state;
    const x3p_file files[] = {{"a", "b", 1}, {0}};
    const zip_bytes bytes = zip_make(files, ZIP_CM_STORE);
    const dif_source source = dif_source_of(bytes.data, bytes.n, "f");
    dif_zip *zip = NULL;
    dif_error err;
    test_alloc_fail_from(1);
    assert_int_equal(dif_zip_open(&source, &zip, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_null(zip);
    assert_int_equal(test_alloc_live(), 0);
    free(bytes.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_find__compares_letters_and_slashes_loosely),
        cmocka_unit_test(test_read__pieces_make_the_whole),
        cmocka_unit_test(test_read__directories_that_lie_are_found_out),
        cmocka_unit_test(test_open__failing_heap_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
