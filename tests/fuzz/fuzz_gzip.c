/* gzip archives; the first byte chooses how much may come out. */
#include "core/alloc.h"
#include "core/io/gzip.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    unsigned char *file = malloc(n > 1 ? n - 1 : 1), *out = NULL;
    FUZZ_PROMISE(file);
    memcpy(file, data + 1, n - 1);
    const dif_source source = dif_source_of(file, n - 1, "input");
    const size_t n_max = 1 + (size_t)data[0] * 4096;
    size_t n_out = 0;
    dif_error err = {0};
    const dif_status status = dif_gzip_unpack(&source, n_max, &out, &n_out, &err);
    FUZZ_PROMISE(status ? !out && n_out == 0 && status == err.status : n_out <= n_max);
    dif_release(out);
    free(file);
    return 0;
}
