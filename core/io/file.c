/* open, fstat, lstat, realpath, fsync, getpid */
#define _XOPEN_SOURCE 700

#include "core/io/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/alloc.h"
#include "core/io/source.h"

enum { CHUNK = 1 << 16 };

bool dif_file_ends_in(const char *path, const char *ending)
{
    const size_t n = strlen(path), n_ending = strlen(ending);
    return n > n_ending && strcmp(path + n - n_ending, ending) == 0;
}

static dif_status fail_directory(dif_error *err, const char *path, const char *want)
{
    char name[DIF_NAME_SIZE];
    dif_name_short(path, name);
    return dif_fail(err, DIF_ERR_IO, "%s: is a directory, want %s", name, want);
}

/* A buffer that grows by doubling. */
typedef struct dif_buffer {
    unsigned char *data;
    size_t n, n_room;
} dif_buffer;

static bool buffer_reserve(dif_buffer *buffer, size_t n_room)
{
    if (buffer->data && n_room <= buffer->n_room)
        return true;
    unsigned char *data = dif_alloc(n_room, 1);
    if (!data)
        return false;
    if (buffer->n)
        memcpy(data, buffer->data, buffer->n);
    dif_release(buffer->data);
    buffer->data = data;
    buffer->n_room = n_room;
    return true;
}

/* Reads on until the end of the file, over n_max or an error. */
static dif_status read_all(int fd, const char *path, size_t n_max, dif_buffer *buffer, dif_error *err)
{
    char name[DIF_NAME_SIZE];
    dif_name_short(path, name);
    for (;;) {
        if (buffer->n > n_max)
            return dif_fail(err, DIF_ERR_SIZE, "%s: larger than %zu bytes", name, n_max);
        /* one byte stays free for the NUL */
        if (buffer->n + 1 >= buffer->n_room && !buffer_reserve(buffer, 2 * buffer->n_room + CHUNK))
            return dif_fail(err, DIF_ERR_NOMEM, "%s: file of more than %zu bytes", name, buffer->n);
        size_t n_want = buffer->n_room - 1 - buffer->n;
        n_want = n_want < SSIZE_MAX / 2 ? n_want : SSIZE_MAX / 2;
        const ssize_t n_got = read(fd, buffer->data + buffer->n, n_want);
        if (n_got < 0 && errno == EINTR)
            continue;
        if (n_got < 0)
            return dif_fail_errno(err, path, "cannot read", errno);
        if (n_got == 0)
            return DIF_OK;
        buffer->n += (size_t)n_got;
    }
}

dif_status dif_file_read(const char *path, size_t n_max, unsigned char **data, size_t *n, dif_error *err)
{
    *data = NULL;
    *n = 0;
    dif_buffer buffer = {0};
    dif_status status = DIF_OK;
    struct stat about;
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0)
        return dif_fail_errno(err, path, "cannot open", errno);
    if (fstat(fd, &about) != 0) {
        status = dif_fail_errno(err, path, "cannot read", errno);
        goto cleanup;
    }
    if (S_ISDIR(about.st_mode)) {
        status = fail_directory(err, path, "a file");
        goto cleanup;
    }
    const size_t n_about = about.st_size > 0 ? (size_t)about.st_size : 0;
    if (n_about > n_max) {
        char name[DIF_NAME_SIZE];
        dif_name_short(path, name);
        status = dif_fail(err, DIF_ERR_SIZE, "%s: %zu bytes, want at most %zu", name, n_about, n_max);
        goto cleanup;
    }
    if (!buffer_reserve(&buffer, n_about + 2)) {
        status = dif_fail(err, DIF_ERR_NOMEM, "file of %zu bytes", n_about);
        dif_fail_named(err, path, status);
        goto cleanup;
    }
    status = read_all(fd, path, n_max, &buffer, err);
cleanup:
    close(fd);
    if (status) {
        dif_release(buffer.data);
        return status;
    }
    buffer.data[buffer.n] = '\0';
    *data = buffer.data;
    *n = buffer.n;
    return DIF_OK;
}

static char *join(const char *head, const char *tail)
{
    const size_t n_head = strlen(head), n_tail = strlen(tail);
    char *text = dif_alloc(n_head + n_tail + 1, 1);
    if (text) {
        memcpy(text, head, n_head);
        memcpy(text + n_head, tail, n_tail);
    }
    return text;
}

/* Where to write: beside the file a link leads to, or straight into a device or pipe. */
static dif_status choose_place(const char *path, char target[PATH_MAX], bool *direct, dif_error *err)
{
    struct stat about;
    *direct = false;
    if (strlen(path) >= PATH_MAX)
        return dif_fail_errno(err, path, "cannot write", ENAMETOOLONG);
    memcpy(target, path, strlen(path) + 1);
    if (stat(path, &about) == 0) {
        if (S_ISDIR(about.st_mode))
            return fail_directory(err, path, "a file to write");
        *direct = !S_ISREG(about.st_mode);
    }
    if (!*direct && lstat(path, &about) == 0 && S_ISLNK(about.st_mode) && !realpath(path, target)) {
        memcpy(target, path, strlen(path) + 1);
        *direct = true; /* the link leads nowhere yet: opening it makes the file */
    }
    return DIF_OK;
}

dif_status dif_outfile_reserve(const char *path, dif_outfile *out, dif_error *err)
{
    *out = (dif_outfile){0};
    char target[PATH_MAX], tail[40];
    bool direct = false;
    const dif_status status = choose_place(path, target, &direct, err);
    if (status)
        return status;
    snprintf(tail, sizeof tail, ".tmp.%ld", (long)getpid());
    out->path = join(target, "");
    out->path_tmp = join(target, direct ? "" : tail);
    if (out->path && out->path_tmp)
        return DIF_OK;
    dif_outfile_abort(out);
    char name[DIF_NAME_SIZE];
    dif_name_short(path, name);
    return dif_fail(err, DIF_ERR_NOMEM, "%s: name of the temporary file", name);
}

dif_status dif_outfile_open(const char *path, dif_outfile *out, dif_error *err)
{
    dif_status status = dif_outfile_reserve(path, out, err);
    if (status)
        return status;
    out->stream = fopen(out->path_tmp, "wb");
    if (!out->stream) {
        status = dif_fail_errno(err, path, "cannot write", errno);
        dif_outfile_abort(out);
    }
    return status;
}

dif_status dif_outfile_write(dif_outfile *out, const void *data, size_t n, dif_error *err)
{
    if (n > 0 && fwrite(data, 1, n, out->stream) != n)
        return dif_fail_errno(err, out->path, "cannot write", errno);
    return DIF_OK;
}

static bool is_direct(const dif_outfile *out)
{
    return strcmp(out->path, out->path_tmp) == 0;
}

/* Brings what was written to the disk; returns errno or 0. Pipes and devices cannot sync, which is no failure. */
static int sync_stream(FILE *stream)
{
    /* An earlier write failed and its errno is lost: one byte more says why. The file is dropped anyway. */
    if (ferror(stream))
        return write(fileno(stream), "", 1) < 0 ? errno : EIO;
    if (fflush(stream) != 0)
        return errno;
    if (fsync(fileno(stream)) != 0 && errno != EINVAL && errno != EROFS && errno != ENOTSUP)
        return errno;
    return 0;
}

dif_status dif_outfile_commit(dif_outfile *out, dif_error *err)
{
    int number = 0;
    if (out->stream) {
        number = sync_stream(out->stream);
        if (fclose(out->stream) != 0 && number == 0)
            number = errno;
        out->stream = NULL;
    }
    if (number == 0 && !is_direct(out) && rename(out->path_tmp, out->path) != 0)
        number = errno;
    const dif_status status = number ? dif_fail_errno(err, out->path, "cannot write", number) : DIF_OK;
    if (!status) {
        dif_release(out->path_tmp);
        out->path_tmp = NULL; /* nothing is left to remove */
    }
    dif_outfile_abort(out);
    return status;
}

void dif_outfile_abort(dif_outfile *out)
{
    if (!out)
        return;
    if (out->stream)
        fclose(out->stream);
    if (out->path && out->path_tmp && !is_direct(out))
        remove(out->path_tmp);
    dif_release(out->path);
    dif_release(out->path_tmp);
    *out = (dif_outfile){0};
}

dif_status dif_file_write(const char *path, const void *data, size_t n, dif_error *err)
{
    dif_outfile out;
    dif_status status = dif_outfile_open(path, &out, err);
    if (status)
        return status;
    status = dif_outfile_write(&out, data, n, err);
    if (status) {
        dif_outfile_abort(&out);
        return status;
    }
    return dif_outfile_commit(&out, err);
}
