/* Tables and queries as CSV. */
#include <math.h>

#include "core/alloc.h"
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
        for (int i = 1; i < table.plan.n_angle; i++)
            FUZZ_PROMISE(table.plan.angle_rad[i] > table.plan.angle_rad[i - 1]);
        for (size_t i = 0; i < (size_t)table.plan.n_angle * (size_t)table.plan.n_lambda; i++)
            FUZZ_PROMISE(!isinf(table.value[i]));
    }
    dif_table_free(&table);
    dif_manifest_free(&manifest);
}

static void read_queries(const unsigned char *file, size_t n)
{
    size_t n_query = 0;
    dif_query *query = NULL;
    double(*degrees)[5] = NULL;
    dif_error err = {0};
    const dif_status status = dif_queries_parse(file, n, "input", &n_query, &query, &degrees, &err);
    FUZZ_PROMISE(status == DIF_OK ? n_query > 0 && query && degrees : n_query == 0 && !query && !degrees);
    if (status)
        FUZZ_PROMISE(strncmp(err.text, "input: ", 7) == 0);
    for (size_t i = 0; i < n_query; i++)
        FUZZ_PROMISE(query[i].wi.z > 0.0 && query[i].wo.z > 0.0 && query[i].lambda_um > 0.0);
    dif_release(query);
    dif_release(degrees);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    if (n < 1)
        return 0;
    unsigned char *file = malloc(n > 1 ? n - 1 : 1);
    FUZZ_PROMISE(file);
    memcpy(file, data + 1, n - 1);
    if (data[0] % 2)
        read_queries(file, n - 1);
    else
        read_table(file, n - 1);
    free(file);
    return 0;
}
