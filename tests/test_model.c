#include "core/model.h"

#include "core/alloc.h"
#include "core/units.h"
#include "rough.h"

static const double LAMBDA_UM[] = {0.4, 0.5};

/* Something of each kind that passes. */
static dif_model sound(dif_model_kind kind)
{
    return (dif_model){.kind = kind,
                       .nmm = {.extent_um = 60.0, .lambda_min_um = 0.38, .lambda_max_um = 0.78, .n_fixed = 8},
                       .replica = {3, 4, 2.0, 5.0},
                       .stam = {2.5, (double)NAN, 0.1, 16.0},
                       .n_lambda = 2,
                       .lambda_um = LAMBDA_UM,
                       .quantity = DIF_QUANTITY_RHO,
                       .index = dif_index_default(),
                       .area_um2 = 100.0};
}

static dif_sheet *make_sheet(bool line, double azimuth_rad)
{
    dif_field field = test_rough_field(12, 12, 0.1, 0.1, 0.1, 2);
    const dif_window window = {DIF_WINDOW_FLAT, 1.0, 0.0, 0.0};
    const dif_band band = {20.0, 5.0, 30.0};
    dif_sheet *sheet;
    assert_int_equal(line ? dif_sheet_create_line(&field, &window, azimuth_rad, &band, 1e-4, NULL, &sheet, NULL)
                          : dif_sheet_create_volume(&field, &window, &band, 1e-4, NULL, &sheet, NULL),
                     DIF_OK);
    dif_field_free(&field);
    return sheet;
}

static void expect(const dif_model *model, dif_status status, const char *text)
{
    dif_error err = {DIF_OK, ""};
    assert_int_equal(dif_model_check(model, &err), status);
    assert_string_equal(err.text, text);
}

static void test_kind__has_a_name(void **state)
{
    (void)state;
    const char *const names[] = {"sheet", "nmm", "pq", "lut", "stam"};
    for (int i = 0; i < 5; i++)
        assert_string_equal(dif_model_kind_name((dif_model_kind)i), names[i]);
}

static void test_check__sheets(void **state)
{
    (void)state;
    dif_sheet *volume = make_sheet(false, 0.0), *line = make_sheet(true, 0.3), *other = make_sheet(true, 0.4);
    const dif_sheet *two[] = {volume, volume};
    double share[] = {0.25, 0.75};
    dif_model model = sound(DIF_MODEL_SHEET);
    expect(&model, DIF_ERR_ARG, "a model by sheet without sheets");
    model.n_sheet = 2;
    model.sheet = two;
    model.share = share;
    for (int kind = DIF_MODEL_SHEET; kind <= DIF_MODEL_PQ; kind++) {
        model.kind = (dif_model_kind)kind;
        expect(&model, DIF_OK, "");
    }
    share[0] = 0.3;
    expect(&model, DIF_ERR_ARG, "shares of the model's sheets add up to 1.05, want 1");
    share[0] = (double)NAN;
    expect(&model, DIF_ERR_ARG, "share 0 of the model is nan, want >= 0");
    share[0] = 0.25;
    two[1] = line;
    expect(&model, DIF_ERR_ARG, "sheet 1 of the model is of another form than the first");
    two[0] = other;
    expect(&model, DIF_ERR_ARG, "sheet 1 of the model is of another form than the first");
    two[1] = NULL;
    expect(&model, DIF_ERR_ARG, "sheet 1 of the model is missing");
    dif_sheet_free(volume);
    dif_sheet_free(line);
    dif_sheet_free(other);
}

static void test_check__members_of_other_kinds(void **state)
{
    (void)state;
    const double one = 1.0;
    dif_sheet *volume = make_sheet(false, 0.0);
    const dif_sheet *const list[] = {volume};
    dif_model model = sound(DIF_MODEL_STAM);
    expect(&model, DIF_OK, "");
    model.stam.period_um = -1.0;
    expect(&model, DIF_ERR_ARG, "a period of -1 um, want > 0");
    model = sound(DIF_MODEL_NMM);
    model.n_sheet = 1;
    model.sheet = list;
    model.share = &one;
    model.n_lambda = -5; /* nmm has wavelengths of its own */
    expect(&model, DIF_OK, "");
    model.nmm.n_fixed = 0;
    expect(&model, DIF_ERR_ARG, "0 fixed wavelengths, want 1 ... 401");
    model.kind = DIF_MODEL_PQ;
    model.n_lambda = 2;
    model.replica.nx = 0;
    expect(&model, DIF_ERR_ARG, "0 replicas along x, want 1 ... 1000000");
    model = sound(DIF_MODEL_LUT);
    expect(&model, DIF_ERR_ARG, "a model by lut without a table");
    float coef[3] = {0.0f};
    dif_lut lut = {.n_azimuth = 1, .n_radius = 1, .n_map = 1, .s0 = 0.1, .coef = coef};
    model.lut = &lut;
    expect(&model, DIF_ERR_ARG, "a table of 1 azimuths x 1 radii x 1 maps");
    lut.n_radius = 2;
    lut.s0 = 0.0;
    expect(&model, DIF_ERR_ARG, "a table whose rows begin at s0 = 0, want > 0");
    dif_sheet_free(volume);
}

static void test_check__what_all_share(void **state)
{
    (void)state;
    const double unordered_um[] = {0.5, 0.5};
    dif_model model = sound(DIF_MODEL_STAM);
    model.lambda_um = unordered_um;
    expect(&model, DIF_ERR_ARG, "wavelength 1 of the model is 0.5 um, want > 0.5");
    model = sound(DIF_MODEL_STAM);
    model.index.n = 0.0;
    expect(&model, DIF_ERR_ARG, "refractive index 0 + 0i, want n > 0 and kappa >= 0");
    model = sound(DIF_MODEL_STAM);
    model.quantity = DIF_QUANTITY_BRDF;
    expect(&model, DIF_OK, "");
    model.area_um2 = 0.0;
    expect(&model, DIF_ERR_ARG, "an effective area of 0 um^2, want > 0");
    model.kind = DIF_MODEL_LUT;
    expect(&model, DIF_ERR_UNSUPPORTED, "a lut has no absolute BRDF: its wavelengths are summed already");
    model = sound((dif_model_kind)5);
    expect(&model, DIF_ERR_ARG, "model kind 5 is none");
    model = sound(DIF_MODEL_STAM);
    model.quantity = (dif_quantity)7;
    expect(&model, DIF_ERR_ARG, "quantity 7 is none");
}

static void test_check__shadowing(void **state)
{
    (void)state;
    float g[4] = {0.0f, 0.0f, 1.0f, 1.0f};
    dif_shadow shadow = {.kind = DIF_SHADOWING_VCAVITY};
    dif_model model = sound(DIF_MODEL_STAM);
    model.shadow = &shadow;
    expect(&model, DIF_OK, "");
    shadow.kind = DIF_SHADOWING_NDF;
    expect(&model, DIF_ERR_ARG, "ndf shadowing with a table of 0 x 0");
    shadow = (dif_shadow){.kind = DIF_SHADOWING_NDF, .n_row = 2, .n_column = 2, .g = g};
    expect(&model, DIF_OK, "");
    shadow.n_row = 1;
    expect(&model, DIF_ERR_ARG, "ndf shadowing with a table of 1 x 2");
    shadow.n_row = 2;
    shadow.slopes.var_x = -1.0;
    expect(&model, DIF_ERR_ARG, "slope variances (-1, 0), want >= 0");
    shadow.kind = (dif_shadowing)4;
    expect(&model, DIF_ERR_ARG, "shadowing 4 is none");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kind__has_a_name),
        cmocka_unit_test(test_check__sheets),
        cmocka_unit_test(test_check__members_of_other_kinds),
        cmocka_unit_test(test_check__what_all_share),
        cmocka_unit_test(test_check__shadowing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
