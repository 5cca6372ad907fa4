/* Texture reads of a colour, counted by hand. Needs no GPU. */
#include "core/shadow.h"
#include "gpu_bench.h"

static double reads_of_lut(int n_map, dif_quantity quantity, const dif_shadow *shadow)
{
    const dif_lut lut = {.n_map = n_map};
    const dif_model model = {.kind = DIF_MODEL_LUT, .lut = &lut, .quantity = quantity, .shadow = shadow};
    return dif_gpu_reads_of_colour(&model, 0.0);
}

static void test_reads__of_a_table(void **state)
{
    (void)state;
    /* three coordinates, and 3 K numbers four to a read */
    static const int WANT[][2] = {{1, 4}, {2, 5}, {3, 6}, {4, 6}, {8, 9}, {12, 12}, {17, 16}, {18, 17}, {48, 39}};
    for (size_t i = 0; i < sizeof WANT / sizeof *WANT; i++) {
        assert_near(reads_of_lut(WANT[i][0], DIF_QUANTITY_POWER, NULL), WANT[i][1], 0.0, 0.0);
        assert_near(reads_of_lut(WANT[i][0], DIF_QUANTITY_RHO, NULL), WANT[i][1] + 1.0, 0.0, 0.0);
    }
    /* as many maps as the wanted reads allow rho */
    assert_at_most(reads_of_lut(16, DIF_QUANTITY_RHO, NULL), DIF_GPU_READS_WANTED);
    assert_true(reads_of_lut(17, DIF_QUANTITY_RHO, NULL) > DIF_GPU_READS_WANTED);
}

static void test_reads__of_shadowing(void **state)
{
    (void)state;
    const dif_shadow vcavity = {.kind = DIF_SHADOWING_VCAVITY},
                     smith = {.kind = DIF_SHADOWING_SMITH, .n_row = 3, .n_column = 1},
                     ndf = {.kind = DIF_SHADOWING_NDF, .n_row = 3, .n_column = 4};
    const double plain = reads_of_lut(8, DIF_QUANTITY_RHO, NULL);
    assert_near(reads_of_lut(8, DIF_QUANTITY_RHO, &vcavity), plain, 0.0, 0.0);
    assert_near(reads_of_lut(8, DIF_QUANTITY_RHO, &smith), plain + 2.0 + 4.0, 0.0, 0.0);
    assert_near(reads_of_lut(8, DIF_QUANTITY_RHO, &ndf), plain + 2.0 + 8.0, 0.0, 0.0);
    assert_near(reads_of_lut(8, DIF_QUANTITY_POWER, &ndf), plain - 1.0, 0.0, 0.0);
}

static void test_reads__of_sheets(void **state)
{
    (void)state;
    bench b = bench_open(NULL, test_rough_field(16, 16, 0.3, 0.3, 0.2, 1), DIF_MODEL_SHEET, (double)NAN, 2);
    bench_settle(&b);
    dif_model *model = &b.model[1];
    const double n_tap = dif_sheet_info_of(model->sheet[0]).n_tap, taps = n_tap * n_tap * n_tap;
    model->quantity = DIF_QUANTITY_POWER;
    assert_near(dif_gpu_reads_of_colour(model, 5.0), 2.0 * 5.0 * (8.0 + taps), 0.0, 0.0);
    model->kind = DIF_MODEL_PQ;
    assert_near(dif_gpu_reads_of_colour(model, 5.0), 2.0 * 5.0 * (12.0 + taps), 0.0, 0.0);
    model->kind = DIF_MODEL_NMM;
    assert_near(dif_gpu_reads_of_colour(model, 5.5), 2.0 * (2.0 + 5.5 * (10.0 + taps)), 0.0, 0.0);
    model->kind = DIF_MODEL_STAM;
    assert_near(dif_gpu_reads_of_colour(model, 5.0), 30.0, 0.0, 0.0);
    model->quantity = DIF_QUANTITY_RHO;
    assert_near(dif_gpu_reads_of_colour(model, 5.0), 34.0, 0.0, 0.0);
    bench_close(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reads__of_a_table),
        cmocka_unit_test(test_reads__of_shadowing),
        cmocka_unit_test(test_reads__of_sheets),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
