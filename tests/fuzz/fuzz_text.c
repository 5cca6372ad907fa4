/* Text matrices, x y z lists, and what else has no magic bytes of an image. */
#include "core/io/field_raw.h"
#include "core/io/image_head.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1 || dif_image_is(data + 1, n - 1))
        return 0;
    unsigned char *file = malloc(n > 1 ? n - 1 : 1);
    FUZZ_PROMISE(file);
    memcpy(file, data + 1, n - 1);
    const bool is_packed = n > 2 && data[1] == 0x1f && data[2] == 0x8b;
    const dif_field_request request = fuzz_request(data[0]);
    dif_field_file field;
    if (fuzz_field(file, n - 1, &request, &field) == DIF_OK)
        FUZZ_PROMISE(strcmp(field.format, "text") != 0 || is_packed || dif_field_n(&field.field) <= n);
    /* every number takes a character */
    dif_field_file_free(&field);
    free(file);
    return 0;
}
