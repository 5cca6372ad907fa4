/* NanoScope headers and samples. */
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const char magic[] = "\\*File list\r\n";
    const size_t n_magic = sizeof magic - 1;
    if (n < 1)
        return 0;
    unsigned char *file = malloc(n_magic + n - 1);
    FUZZ_PROMISE(file);
    memcpy(file, magic, n_magic);
    memcpy(file + n_magic, data + 1, n - 1);
    const dif_field_request request = fuzz_request(data[0]);
    dif_field_file field;
    (void)!fuzz_field(file, n_magic + n - 1, &request, &field);
    dif_field_file_free(&field);
    fuzz_channels(file, n_magic + n - 1, &request, 2);
    free(file);
    return 0;
}
