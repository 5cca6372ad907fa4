/* GSF headers and samples. A field that was read is written and read again. */
#include "core/alloc.h"
#include "core/io/field_raw.h"
#include "tests/fuzz/fuzz.h"

static void go_round(const dif_field *field)
{
    unsigned char *data = NULL;
    size_t n = 0;
    dif_error err;
    dif_field_file back;
    FUZZ_PROMISE(dif_gsf_encode(field, NULL, &data, &n, &err) == DIF_OK);
    const dif_status status = fuzz_field(data, n, NULL, &back);
    /* heights near the ends of the range of floats may leave it in metres */
    FUZZ_PROMISE(status == DIF_OK || status == DIF_ERR_NONFINITE || status == DIF_ERR_FORMAT);
    if (!status)
        FUZZ_PROMISE(back.field.nx == field->nx && back.field.ny == field->ny);
    dif_field_file_free(&back);
    dif_release(data);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const char MAGIC[] = "Gwyddion Simple Field 1.0\n";
    const size_t n_magic = sizeof MAGIC - 1;
    if (n < 1)
        return 0;
    unsigned char *file = malloc(n_magic + n - 1);
    FUZZ_PROMISE(file);
    memcpy(file, MAGIC, n_magic);
    memcpy(file + n_magic, data + 1, n - 1);
    const dif_field_request request = fuzz_request(data[0]);
    dif_field_file field;
    if (fuzz_field(file, n_magic + n - 1, &request, &field) == DIF_OK)
        go_round(&field.field);
    dif_field_file_free(&field);
    free(file);
    return 0;
}
