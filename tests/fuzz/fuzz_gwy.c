/* Containers of Gwyddion files, version 1 or 2 by the first byte. */
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    const char *magic = data[0] & 16 ? "GWYO" : "GWYP";
    const size_t n_magic = 4;
    unsigned char *file = malloc(n_magic + n - 1);
    FUZZ_PROMISE(file);
    memcpy(file, magic, n_magic);
    memcpy(file + n_magic, data + 1, n - 1);
    const dif_field_request request = fuzz_request(data[0]);
    dif_field_file field;
    (void)!fuzz_field(file, n_magic + n - 1, &request, &field);
    dif_field_file_free(&field);
    fuzz_channels(file, n_magic + n - 1, &request, 8);
    free(file);
    return 0;
}
