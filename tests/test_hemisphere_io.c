#define _POSIX_C_SOURCE 200809L /* getpid */
#include "core/io/hemisphere_io.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "alloc_count.h"
#include "core/io/field_io.h"
#include "core/io/file.h"
#include "near.h"
#include "rough.h"

enum { N = 21 };

/* A file of this process alone. */
static const char *path_of(char path[64])
{
    snprintf(path, 64, "/tmp/dif-hemisphere-%ld.exr", (long)getpid());
    return path;
}

static dif_ndf make(float masking[N * N])
{
    dif_field field = test_rough_field(30, 30, 0.1, 0.1, 0.08, 5);
    dif_ndf ndf;
    assert_int_equal(dif_hemisphere_ndf_create(&field, N, true, &ndf, NULL), DIF_OK);
    dif_hemisphere_masking_image(&ndf, N, masking);
    dif_field_free(&field);
    return ndf;
}

static void test_write_read__gives_the_distribution_back(void **state)
{
    (void)state;
    char path[64];
    float masking[N * N];
    dif_ndf ndf = make(masking), back;
    assert_int_equal(dif_hemisphere_write(path_of(path), &ndf, masking, NULL, NULL), DIF_OK);
    assert_int_equal(dif_hemisphere_read(path_of(path), &back, NULL), DIF_OK);
    assert_int_equal(back.n, N);
    assert_near(dif_hemisphere_ndf_projected(&back), 1.0, 1e-12, 0.0);
    for (int i = 0; i < N * N; i++)
        assert_near(back.d[i], ndf.d[i], 1e-6, 0.0); /* float */
    const dif_vec3 k = dif_vec3_from_angles_rad(1.1, 0.4);
    assert_near(dif_hemisphere_masking(&back, k), dif_hemisphere_masking(&ndf, k), 1e-6, 0.0);
    dif_hemisphere_ndf_free(&back);
    dif_hemisphere_ndf_free(&ndf);
    unlink(path_of(path));
}

static void test_write__is_no_heightfield(void **state)
{
    (void)state;
    char path[64];
    float masking[N * N];
    dif_ndf ndf = make(masking);
    dif_field_file file;
    dif_error err;
    const dif_field_request request = dif_field_request_default();
    assert_int_equal(dif_hemisphere_write(path_of(path), &ndf, masking, NULL, NULL), DIF_OK);
    assert_int_equal(dif_field_read(path_of(path), &request, &file, &err), DIF_ERR_FORMAT);
    assert_non_null(strstr(err.text, ".exr: holds 'hemisphere: x, y = direction cosines', want a heightfield"));
    dif_hemisphere_ndf_free(&ndf);
    unlink(path_of(path));
}

static void test_read__bad_files_are_refused(void **state)
{
    (void)state;
    dif_error err;
    dif_ndf ndf;
    char path[64];
    assert_int_equal(dif_hemisphere_read("/tmp/none/normals.exr", &ndf, &err), DIF_ERR_IO);
    assert_int_equal(dif_file_write(path_of(path), "nonsense", 8, &err), DIF_OK);
    assert_int_equal(dif_hemisphere_read(path_of(path), &ndf, &err), DIF_ERR_FORMAT);
    assert_null(ndf.d);
    float masking[N * N];
    dif_ndf good = make(masking);
    assert_int_equal(dif_hemisphere_write("/tmp/none/normals.exr", &good, masking, NULL, &err), DIF_ERR_IO);
    test_alloc_fail_from(1);
    assert_int_equal(dif_hemisphere_write(path_of(path), &good, masking, NULL, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    dif_hemisphere_ndf_free(&good);
    unlink(path_of(path));
    assert_int_equal(test_alloc_live(), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write_read__gives_the_distribution_back),
        cmocka_unit_test(test_write__is_no_heightfield),
        cmocka_unit_test(test_read__bad_files_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
