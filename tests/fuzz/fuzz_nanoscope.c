/* NanoScope headers and samples. */
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const char magic[] = "\\*File list\r\n";
    if (n < 1)
        return 0;
    fuzz_after_magic(magic, sizeof magic - 1, data, n, 2);
    return 0;
}
