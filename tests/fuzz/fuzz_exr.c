/* EXR attributes and pixels, as a heightfield, as a table, as a map and as an integrated table. */
#include "core/io/lut_io.h"
#include "core/io/map_io.h"
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

static void read_map(const unsigned char *file, size_t n)
{
    dif_map_image map;
    dif_manifest manifest;
    dif_error err = {0};
    if (dif_map_parse(file, n, "input", &map, &manifest, &err))
        FUZZ_PROMISE(strncmp(err.text, "input: ", 7) == 0 && !map.xyz && !map.layer && !map.lambda_um &&
                     !manifest.item);
    dif_map_image_free(&map);
    dif_manifest_free(&manifest);
}

static void read_lut(const unsigned char *file, size_t n)
{
    dif_lut lut;
    dif_manifest manifest;
    dif_error err = {0};
    double xyz[3];
    if (dif_lut_parse(file, n, "input", &lut, &manifest, &err))
        FUZZ_PROMISE(strncmp(err.text, "input: ", 7) == 0 && !lut.coef && !manifest.item);
    else
        dif_lut_eval(&lut, 0.3, -0.7, -1.1, xyz);
    dif_lut_free(&lut);
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
    read_map(file, sizeof MAGIC + n - 1);
    read_lut(file, sizeof MAGIC + n - 1);
    free(file);
    return 0;
}
