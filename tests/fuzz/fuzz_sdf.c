/* SDF headers and samples behind each of the magics. */
#include "core/io/field_raw.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const char *const MAGICS[] = {"bBCR-1.0", "bISO-1.0", "aBCR-1.0", "aISO-1.0"};
    enum { N_MAGIC = 8 };
    if (n < 1)
        return 0;
    unsigned char *file = malloc(N_MAGIC + n - 1);
    FUZZ_PROMISE(file);
    memcpy(file, MAGICS[data[0] >> 4 & 3], N_MAGIC);
    memcpy(file + N_MAGIC, data + 1, n - 1);
    dif_field_request request = fuzz_request(data[0]);
    dif_field_file field;
    if (fuzz_field(file, N_MAGIC + n - 1, &request, &field) == DIF_OK)
        FUZZ_PROMISE(dif_field_n(&field.field) <= n); /* every sample takes a byte */
    dif_field_file_free(&field);
    free(file);
    return 0;
}
