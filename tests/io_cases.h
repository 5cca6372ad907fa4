/* What the tests of readers share: parsing from memory, cutting files short, failing allocations. */
#ifndef DIF_TEST_IO_CASES_H
#define DIF_TEST_IO_CASES_H

#include "tests/near.h"

#include <string.h>

#include "core/alloc.h"
#include "core/io/field_io.h"
#include "core/io/file.h"
#include "tests/alloc_count.h"

/* Parses bytes as a heightfield named "f"; on success the caller frees *file. */
static inline dif_status parse_bytes(const void *data, size_t n, const dif_field_request *request, dif_field_file *file,
                                     dif_error *err)
{
    err->text[0] = '\0';
    return dif_field_parse(data, n, "f", request, file, err);
}

/* Asserts a failure with this code and a text with this part in it, beginning with the file's name. */
static inline void assert_parse_fails(const void *data, size_t n, const dif_field_request *request, dif_status want,
                                      const char *part)
{
    dif_field_file file;
    dif_error err;
    assert_int_equal(parse_bytes(data, n, request, &file, &err), want);
    assert_int_equal(err.status, want);
    assert_null(file.field.z_um);
    if (strncmp(err.text, "f: ", 3) != 0 || !strstr(err.text, part))
        fail_msg("'%s' does not begin with 'f: ' and hold '%s'", err.text, part);
}

/* Every beginning of a file, in a block of its own size so that reading past it is seen, must be refused without a
 * block left over. Returns the lengths at which it was not refused. */
static inline int count_accepted_beginnings(const unsigned char *data, size_t n, const dif_field_request *request)
{
    int n_accepted = 0;
    const int n_live = test_alloc_live();
    for (size_t k = 0; k < n; k++) {
        unsigned char *part = malloc(k ? k : 1);
        assert_non_null(part);
        memcpy(part, data, k);
        dif_field_file file;
        dif_error err;
        const dif_status status = parse_bytes(part, k, request, &file, &err);
        if (status == DIF_OK)
            n_accepted++;
        else
            assert_true(strlen(err.text) > 3);
        dif_field_file_free(&file);
        free(part);
    }
    assert_int_equal(test_alloc_live(), n_live);
    return n_accepted;
}

/* Fails the k-th allocation of a parse for each k until it succeeds; returns how many calls failed. */
static inline int parse_with_failing_heap(const unsigned char *data, size_t n, const dif_field_request *request)
{
    const int n_live = test_alloc_live();
    for (int k = 1; k < 10000; k++) {
        dif_field_file file;
        dif_error err;
        test_alloc_fail_from(k);
        const dif_status status = parse_bytes(data, n, request, &file, &err);
        test_alloc_fail_from(0);
        dif_field_file_free(&file);
        assert_int_equal(test_alloc_live(), n_live);
        if (status == DIF_OK)
            return k - 1;
        if (status != DIF_ERR_NOMEM)
            fail_msg("allocation %d: status %d, %s", k, (int)status, err.text);
    }
    fail_msg("still failing after 10000 allocations");
    return 0;
}

/* The whole of a file that must be there; freed with dif_release. */
static inline unsigned char *read_whole(const char *path, size_t *n)
{
    unsigned char *data = NULL;
    dif_error err;
    if (dif_file_read(path, (size_t)1 << 30, &data, n, &err))
        fail_msg("%s", err.text);
    return data;
}

#endif
