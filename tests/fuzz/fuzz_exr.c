/* EXR attributes and pixels, as a heightfield and as a table. */
#include "core/io/table_io.h"
#include "tests/fuzz/fuzz.h"

static void read_table(const unsigned char *file, size_t n)
{
    dif_table table;
    dif_manifest manifest;
    dif_error err = {0};
    const dif_status status = dif_table_parse(file, n, "input", &table, &manifest, &err);
    if (status) {
        FUZZ_PROMISE(strncmp(err.text, "input: ", 7) == 0);
        FUZZ_PROMISE(!table.value && !table.plan.angle_rad && !manifest.item);
    } else {
        FUZZ_PROMISE(dif_plan_check(&table.plan, &err) == DIF_OK);
    }
    dif_table_free(&table);
    dif_manifest_free(&manifest);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const unsigned char MAGIC[] = {0x76, 0x2f, 0x31, 0x01};
    if (n < 1)
        return 0;
    unsigned char *file = malloc(sizeof MAGIC + n - 1);
    FUZZ_PROMISE(file);
    memcpy(file, MAGIC, sizeof MAGIC);
    memcpy(file + sizeof MAGIC, data + 1, n - 1);
    dif_field_request request = fuzz_request(data[0]);
    if (data[0] & 16)
        request.channel = "G";
    dif_field_file field;
    (void)!fuzz_field(file, sizeof MAGIC + n - 1, &request, &field);
    dif_field_file_free(&field);
    read_table(file, sizeof MAGIC + n - 1);
    free(file);
    return 0;
}
