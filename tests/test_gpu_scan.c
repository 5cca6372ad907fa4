/* The GPU against the CPU on the measured scans: tables within 2e-6 absolute, 99 of 100 within 1e-4 relative. */
#include "core/io/field_io.h"
#include "gpu_bench.h"

enum { N_ANGLE = 361, N_WAVE = 41 };

/* A table of a scan, lit from azimuth 90 degrees; the window is DESIGN's. */
static void check_scan(void **state, const char *file, double height_um)
{
    static const double TOLS[2] = {TOL_CPU, TOL_GPU};
    static double want[N_WAVE * N_ANGLE], got[N_WAVE * N_ANGLE];
    dif_gpu *gpu = gpu_of(state);
    const char *folder = test_data_folder();
    if (!folder)
        skip();
    char path[1024];
    snprintf(path, sizeof path, "%s/measured/%s", folder, file);
    dif_field_request request = dif_field_request_default();
    dif_field_file scan;
    dif_error err;
    request.size_um = 65.0;
    request.height_um = height_um;
    if (dif_field_read(path, &request, &scan, &err) != DIF_OK) {
        print_message("%s: skipping\n", err.text);
        skip();
    }
    dif_plan plan = make_plan(N_ANGLE, N_WAVE, 0.5 * DIF_PI);
    plan.fixed_rad = dif_rad_from_deg(75.0);
    const double k = DIF_TWO_PI / 0.38, share = 1.0;
    const dif_band band = {2.0 * k, 0.0, 2.0 * k};
    const dif_window window = {DIF_WINDOW_GAUSS, DIF_SIGMA_DEFAULT_UM, 0.0, 0.0};
    const dif_sheet_opts opts = {DIF_BASIS_WAVES, DIF_TERMS_FROM_TOL, false, false};
    dif_sheet *sheet[2];
    dif_evaluator side[2];
    double worst, p99;
    for (int i = 0; i < 2; i++)
        assert_int_equal(
            dif_sheet_create_line(&scan.field, &window, plan.azimuth_rad, &band, TOLS[i], &opts, sheet + i, &err),
            DIF_OK);
    dif_model model[2];
    for (int i = 0; i < 2; i++)
        model[i] = (dif_model){.kind = DIF_MODEL_SHEET,
                               .n_sheet = 1,
                               .sheet = (const dif_sheet *const *)&sheet[i],
                               .share = &share,
                               .quantity = DIF_QUANTITY_POWER,
                               .index = {1.5, 0.0}};
    assert_int_equal(dif_cpu_evaluator_open(&model[0], &side[0], &err), DIF_OK);
    assert_int_equal(dif_gpu_evaluator_open(gpu, &model[1], NULL, &side[1], &err), DIF_OK);
    assert_int_equal(side[0].table(side[0].self, &plan, want, NULL, &err), DIF_OK);
    assert_int_equal(side[1].table(side[1].self, &plan, got, NULL, &err), DIF_OK);
    compare((size_t)N_WAVE * N_ANGLE, want, got, &worst, &p99);
    print_message("%s: worst %.2g, p99 %.2g\n", file, worst, p99);
    assert_at_most(worst, 2e-6);
    assert_at_most(p99, 1e-4);
    for (int i = 0; i < 2; i++) {
        dif_evaluator_close(&side[i]);
        dif_sheet_free(sheet[i]);
    }
    dif_plan_free(&plan);
    dif_field_file_free(&scan);
}

static void test_table__xenopeltis(void **state)
{
    check_scan(state, "xenopeltis_65um.png", 0.81869);
}

static void test_table__elaphe(void **state)
{
    check_scan(state, "elaphe_65um.png", 0.375);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_table__xenopeltis),
        cmocka_unit_test(test_table__elaphe),
    };
    return cmocka_run_group_tests(tests, open_gpu, close_gpu);
}
