/* mkdtemp, mkfifo, symlink, fork */
#define _XOPEN_SOURCE 700

#include "tests/near.h"

#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/alloc.h"
#include "core/io/file.h"
#include "tests/alloc_count.h"

static char folder[64];

static int make_folder(void **state)
{
    (void)state;
    snprintf(folder, sizeof folder, "/tmp/dif-file-XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

/* Fails if a test left anything behind. */
static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

static void path_in(const char *name, char path[160])
{
    snprintf(path, 160, "%s/%s", folder, name);
}

static void expect_content(const char *path, const char *want)
{
    unsigned char *data = NULL;
    size_t n = 0;
    dif_error err;
    assert_int_equal(dif_file_read(path, 1000, &data, &n, &err), DIF_OK);
    assert_int_equal(n, strlen(want));
    assert_string_equal((const char *)data, want); /* a NUL follows */
    dif_release(data);
}

static void test_write__replaces_the_file_as_a_whole(void **state)
{
    (void)state;
    char path[160];
    dif_error err;
    path_in("a.txt", path);
    assert_int_equal(dif_file_write(path, "old", 3, &err), DIF_OK);
    dif_outfile out;
    assert_int_equal(dif_outfile_open(path, &out, &err), DIF_OK);
    assert_int_equal(dif_outfile_write(&out, "newer", 5, &err), DIF_OK);
    fflush(out.stream);
    expect_content(path, "old"); /* nothing is seen before the commit */
    assert_int_equal(dif_outfile_commit(&out, &err), DIF_OK);
    assert_null(out.path);
    expect_content(path, "newer");
    remove(path);
}

static void test_abort__leaves_the_old_file(void **state)
{
    (void)state;
    char path[160], path_tmp[200];
    dif_error err;
    path_in("a.txt", path);
    snprintf(path_tmp, sizeof path_tmp, "%s.tmp.%ld", path, (long)getpid());
    assert_int_equal(dif_file_write(path, "old", 3, &err), DIF_OK);
    dif_outfile out;
    assert_int_equal(dif_outfile_open(path, &out, &err), DIF_OK);
    assert_string_equal(out.path_tmp, path_tmp);
    assert_int_equal(access(path_tmp, F_OK), 0);
    dif_outfile_abort(&out);
    assert_int_not_equal(access(path_tmp, F_OK), 0);
    dif_outfile_abort(&out);
    expect_content(path, "old");
    remove(path);
}

static void test_reserve__commits_what_another_wrote_by_name(void **state)
{
    (void)state;
    char path[160];
    dif_error err;
    dif_outfile out;
    path_in("b.txt", path);
    assert_int_equal(dif_outfile_reserve(path, &out, &err), DIF_OK);
    assert_null(out.stream);
    FILE *other = fopen(out.path_tmp, "w");
    assert_non_null(other);
    fputs("by name", other);
    fclose(other);
    assert_int_equal(dif_outfile_commit(&out, &err), DIF_OK);
    expect_content(path, "by name");
    remove(path);
}

static void test_write__follows_a_link_and_keeps_it(void **state)
{
    (void)state;
    char path[160], link[160];
    dif_error err;
    path_in("target.txt", path);
    path_in("link.txt", link);
    assert_int_equal(dif_file_write(path, "old", 3, &err), DIF_OK);
    assert_int_equal(symlink("target.txt", link), 0);
    assert_int_equal(dif_file_write(link, "new", 3, &err), DIF_OK);
    expect_content(path, "new");
    struct stat about;
    assert_int_equal(lstat(link, &about), 0);
    assert_true(S_ISLNK(about.st_mode));
    remove(path);
    assert_int_equal(dif_file_write(link, "made", 4, &err), DIF_OK); /* a link that led nowhere */
    expect_content(path, "made");
    remove(path);
    remove(link);
}

/* A full disk: a device that takes nothing. It must be written in place, never renamed over. */
static void test_write__full_disk_is_said_and_a_device_stays(void **state)
{
    (void)state;
    dif_error err;
    struct stat about;
    if (stat("/dev/full", &about) != 0 || !S_ISCHR(about.st_mode)) {
        print_message("no /dev/full: skipping\n");
        skip();
    }
    assert_int_equal(dif_file_write("/dev/full", "x", 1, &err), DIF_ERR_IO);
    assert_string_equal(err.text, "/dev/full: cannot write: No space left on device");
    dif_outfile out;
    char block[70000] = {0};
    assert_int_equal(dif_outfile_open("/dev/full", &out, &err), DIF_OK);
    assert_int_equal(dif_outfile_write(&out, block, sizeof block, &err), DIF_ERR_IO);
    assert_string_equal(err.text, "/dev/full: cannot write: No space left on device");
    err.text[0] = '\0';
    assert_int_equal(dif_outfile_commit(&out, &err), DIF_ERR_IO); /* the earlier failure is not forgotten */
    assert_string_equal(err.text, "/dev/full: cannot write: No space left on device");
    assert_int_equal(dif_file_write("/dev/null", "x", 1, &err), DIF_OK);
    assert_int_equal(stat("/dev/null", &about), 0);
    assert_true(S_ISCHR(about.st_mode));
}

static void test_write__unwritable_places_are_said(void **state)
{
    (void)state;
    char path[160], want[300], name[5000];
    dif_error err;
    path_in("no/such/a.txt", path);
    assert_int_equal(dif_file_write(path, "x", 1, &err), DIF_ERR_IO);
    snprintf(want, sizeof want, "%s: cannot write: No such file or directory", path);
    assert_string_equal(err.text, want);
    assert_int_equal(dif_file_write(folder, "x", 1, &err), DIF_ERR_IO);
    snprintf(want, sizeof want, "%s: is a directory, want a file to write", folder);
    assert_string_equal(err.text, want);
    memset(name, 'n', sizeof name);
    name[sizeof name - 1] = '\0';
    assert_int_equal(dif_file_write(name, "x", 1, &err), DIF_ERR_IO);
    assert_non_null(strstr(err.text, "File name too long"));
}

/* A run that is killed in mid-write leaves the old file. */
static void test_write__killed_run_leaves_the_old_file(void **state)
{
    (void)state;
    char path[160], path_tmp[200];
    dif_error err;
    path_in("k.txt", path);
    assert_int_equal(dif_file_write(path, "old", 3, &err), DIF_OK);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        dif_outfile out;
        if (dif_outfile_open(path, &out, &err) || dif_outfile_write(&out, "half", 4, &err))
            _exit(1);
        fflush(out.stream);
        raise(SIGKILL);
    }
    int how = 0;
    waitpid(child, &how, 0);
    assert_true(WIFSIGNALED(how));
    expect_content(path, "old");
    snprintf(path_tmp, sizeof path_tmp, "%s.tmp.%ld", path, (long)child);
    expect_content(path_tmp, "half");
    remove(path_tmp);
    remove(path);
}

static void test_read__missing_directory_and_too_large(void **state)
{
    (void)state;
    char path[160], want[300];
    unsigned char *data = (unsigned char *)path;
    size_t n = 9;
    dif_error err;
    path_in("missing", path);
    assert_int_equal(dif_file_read(path, 10, &data, &n, &err), DIF_ERR_IO);
    snprintf(want, sizeof want, "%s: cannot open: No such file or directory", path);
    assert_string_equal(err.text, want);
    assert_null(data);
    assert_int_equal(n, 0);
    assert_int_equal(dif_file_read(folder, 10, &data, &n, &err), DIF_ERR_IO);
    snprintf(want, sizeof want, "%s: is a directory, want a file", folder);
    assert_string_equal(err.text, want);
    path_in("large", path);
    assert_int_equal(dif_file_write(path, "0123456789", 10, &err), DIF_OK);
    assert_int_equal(dif_file_read(path, 10, &data, &n, &err), DIF_OK);
    dif_release(data);
    assert_int_equal(dif_file_read(path, 9, &data, &n, &err), DIF_ERR_SIZE);
    snprintf(want, sizeof want, "%s: 10 bytes, want at most 9", path);
    assert_string_equal(err.text, want);
    remove(path);
    assert_int_equal(dif_file_read("/dev/zero", 100000, &data, &n, &err),
                     DIF_ERR_SIZE); /* says no size and never ends */
    assert_string_equal(err.text, "/dev/zero: larger than 100000 bytes");
}

static void test_read__failing_heap_leaves_nothing(void **state)
{
    (void)state;
    char path[160];
    dif_error err;
    unsigned char *data = NULL;
    size_t n = 0;
    const int n_live = test_alloc_live();
    path_in("m.txt", path);
    for (int k = 1; k <= 2; k++) {
        test_alloc_fail_from(k);
        assert_int_equal(dif_file_write(path, "x", 1, &err), DIF_ERR_NOMEM);
        assert_int_equal(test_alloc_live(), n_live);
    }
    test_alloc_fail_from(0);
    assert_int_equal(dif_file_write(path, "x", 1, &err), DIF_OK);
    test_alloc_fail_from(1);
    assert_int_equal(dif_file_read(path, 10, &data, &n, &err), DIF_ERR_NOMEM);
    test_alloc_fail_from(0);
    assert_null(data);
    assert_int_equal(test_alloc_live(), n_live);
    remove(path);
}

static void test_ends_in__wants_more_than_the_ending(void **state)
{
    (void)state;
    assert_true(dif_file_ends_in("a/f.png", ".png"));
    assert_false(dif_file_ends_in(".png", ".png"));
    assert_false(dif_file_ends_in("f.PNG", ".png"));
    assert_false(dif_file_ends_in("f.png.txt", ".png"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ends_in__wants_more_than_the_ending),
        cmocka_unit_test(test_write__replaces_the_file_as_a_whole),
        cmocka_unit_test(test_abort__leaves_the_old_file),
        cmocka_unit_test(test_reserve__commits_what_another_wrote_by_name),
        cmocka_unit_test(test_write__follows_a_link_and_keeps_it),
        cmocka_unit_test(test_write__full_disk_is_said_and_a_device_stays),
        cmocka_unit_test(test_write__unwritable_places_are_said),
        cmocka_unit_test(test_write__killed_run_leaves_the_old_file),
        cmocka_unit_test(test_read__missing_directory_and_too_large),
        cmocka_unit_test(test_read__failing_heap_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
