/* Containers of Gwyddion files, version 1 or 2 by the first byte. */
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    fuzz_after_magic(data[0] & 16 ? "GWYO" : "GWYP", 4, data, n, 8);
    return 0;
}
