/* x3p surfaces. Sums would stop every change of a zip archive, so the input is what stands in one: the text of main.xml,
 * a byte 0 and the file "d" of the samples. With bit 7 of the first byte the input is an
 * archive itself. */
#include <zlib.h>

#include "tests/fuzz/fuzz.h"

typedef struct archive {
    unsigned char *data; /* data[n], with room for all */
    size_t n;
} archive;

static void put(archive *zip, uint32_t value, int n)
{
    for (int i = 0; i < n; i++)
        zip->data[zip->n++] = (unsigned char)(value >> 8 * i);
}

typedef struct member {
    const char *path;
    const unsigned char *data;
    size_t n, at;
} member;

/* The part of a member's header that stands before it and in the directory. */
static void put_about(archive *zip, const member *file)
{
    put(zip, 20, 2); /* version */
    put(zip, 0, 2);
    put(zip, 0, 2); /* stored */
    put(zip, 0x21 << 16, 4);
    put(zip, (uint32_t)crc32(0, file->data, (uInt)file->n), 4);
    put(zip, (uint32_t)file->n, 4);
    put(zip, (uint32_t)file->n, 4);
    put(zip, (uint32_t)strlen(file->path), 2);
    put(zip, 0, 2);
}

static void put_bytes(archive *zip, const void *data, size_t n)
{
    if (n)
        memcpy(zip->data + zip->n, data, n);
    zip->n += n;
}

static archive pack(member *files, int n_file)
{
    size_t room = 22;
    for (int i = 0; i < n_file; i++)
        room += 76 + 2 * strlen(files[i].path) + files[i].n;
    archive zip = {.data = malloc(room)};
    FUZZ_PROMISE(zip.data);
    for (int i = 0; i < n_file; i++) {
        files[i].at = zip.n;
        put(&zip, 0x04034b50, 4);
        put_about(&zip, &files[i]);
        put_bytes(&zip, files[i].path, strlen(files[i].path));
        put_bytes(&zip, files[i].data, files[i].n);
    }
    const size_t directory = zip.n;
    for (int i = 0; i < n_file; i++) {
        put(&zip, 0x02014b50, 4);
        put(&zip, 20, 2);
        put_about(&zip, &files[i]);
        put(&zip, 0, 2);
        put(&zip, 0, 4);
        put(&zip, 0, 4);
        put(&zip, (uint32_t)files[i].at, 4);
        put_bytes(&zip, files[i].path, strlen(files[i].path));
    }
    const size_t n_directory = zip.n - directory;
    put(&zip, 0x06054b50, 4);
    put(&zip, 0, 4);
    put(&zip, (uint32_t)n_file, 2);
    put(&zip, (uint32_t)n_file, 2);
    put(&zip, (uint32_t)n_directory, 4);
    put(&zip, (uint32_t)directory, 4);
    put(&zip, 0, 2);
    FUZZ_PROMISE(zip.n == room);
    return zip;
}

static void read_it(const unsigned char *data, size_t n, int options)
{
    dif_field_request request = fuzz_request(options);
    request.channel = options & 32 ? "2" : NULL;
    dif_field_file field;
    (void)fuzz_field(data, n, &request, &field);
    dif_field_file_free(&field);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    if (data[0] & 128) {
        unsigned char *file = malloc(n + 3);
        FUZZ_PROMISE(file);
        memcpy(file, "PK\x03\x04", 4);
        memcpy(file + 4, data + 1, n - 1);
        read_it(file, n + 3, data[0]);
        free(file);
        return 0;
    }
    const unsigned char *xml = data + 1, *end = data + n;
    const unsigned char *nul = n > 1 ? memchr(xml, 0, n - 1) : NULL;
    const unsigned char *samples = nul ? nul + 1 : end;
    member files[] = {{.path = "main.xml", .data = xml, .n = (size_t)((nul ? nul : end) - xml)},
                      {.path = "d", .data = samples, .n = (size_t)(end - samples)}};
    archive zip = pack(files, 2);
    read_it(zip.data, zip.n, data[0]);
    free(zip.data);
    return 0;
}
