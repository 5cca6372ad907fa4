/* Writing heightfields: each format by extension, there and back, and what it loses. */
#define _POSIX_C_SOURCE 200809L /* mkdtemp */

#include "tests/io_cases.h"

#include <unistd.h>

#include "core/io/exr_io.h"
#include "core/io/field_raw.h"
#include "core/io/image_head.h"

static const char *const EXTENSIONS[] = {"exr", "gsf", "png", "txt"};
static const char *const FORMATS[] = {"exr", "gsf", "png", "text"};
enum { N_FORMAT = 4 };

/* Heights from low to high um, rough; sides and pitches differ. */
static dif_field make_field(double low_um, double high_um)
{
    dif_field field;
    dif_error err;
    uint64_t seed = 7;
    assert_int_equal(dif_field_create(17, 11, 0.0488, 0.061, &field, &err), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] = test_random(&seed, low_um, high_um);
    return field;
}

static void go_round(const char *folder, int format, const dif_field *field, double allowed_um)
{
    char path[100];
    dif_manifest manifest = {0};
    dif_field_file file;
    dif_error err;
    /* provenance that looks like a header, and letters beyond ASCII */
    assert_int_equal(dif_manifest_set(&manifest, "command", "diffbench --Width: 5 nm \xc2\xb5", &err), DIF_OK);
    snprintf(path, sizeof path, "%s/a.%s", folder, EXTENSIONS[format]);
    assert_int_equal(dif_field_write_check(path, &err), DIF_OK);
    assert_int_equal(dif_field_write(path, field, &manifest, &err), DIF_OK);
    if (dif_field_read(path, NULL, &file, &err))
        fail_msg("%s", err.text);
    assert_string_equal(file.format, FORMATS[format]);
    assert_string_equal(file.title, "height");
    assert_string_equal(file.warning, "");
    assert_int_equal(file.field.nx, field->nx);
    assert_int_equal(file.field.ny, field->ny);
    assert_near(file.field.pitch_x_um, field->pitch_x_um, 1e-15, 0.0); /* extent and back: a few roundings */
    assert_near(file.field.pitch_y_um, field->pitch_y_um, 1e-15, 0.0);
    for (size_t i = 0; i < dif_field_n(field); i++)
        assert_near(file.field.z_um[i], field->z_um[i], 0.0, allowed_um);
    dif_field_file_free(&file);
    dif_manifest_free(&manifest);
    assert_int_equal(remove(path), 0);
}

static void test_write__comes_back_within_the_loss_that_is_stated(void **state)
{
    (void)state;
    static const double RANGES[][2] = {{-0.2, 0.3}, {16.0, 16.1}, {-1e-6, 1e-6}, {0.0, 5000.0}};
    char folder[] = "/tmp/dif-write-XXXXXX";
    assert_non_null(mkdtemp(folder));
    for (size_t k = 0; k < sizeof RANGES / sizeof *RANGES; k++) {
        dif_field field = make_field(RANGES[k][0], RANGES[k][1]);
        const double size_um = fmax(fabs(RANGES[k][0]), fabs(RANGES[k][1]));
        for (int i = 0; i < N_FORMAT; i++) {
            char name[8];
            snprintf(name, sizeof name, "a.%s", EXTENSIONS[i]);
            const dif_field_loss loss = dif_field_loss_of(name, &field);
            /* half a step, and a few roundings of the product with a unit */
            go_round(folder, i, &field, 0.501 * loss.step_um + 1e-15 * size_um);
        }
        dif_field_free(&field);
    }
    assert_int_equal(rmdir(folder), 0);
}

static void test_loss__is_said_where_it_is_coarse(void **state)
{
    (void)state;
    dif_field field = make_field(0.0, 1.0);
    field.z_um[0] = 0.0;
    field.z_um[1] = 1.0;
    dif_field_loss loss = dif_field_loss_of("a.png", &field);
    assert_near(loss.step_um, 1.0 / 65535.0, 4e-16, 0.0);
    assert_string_equal(loss.warning, "16-bit heights: one step is 0.01526 nm");
    loss = dif_field_loss_of("a.exr", &field);
    assert_near(loss.step_um, 0x1p-23, 4e-16, 0.0);
    assert_string_equal(loss.warning, "");
    loss = dif_field_loss_of("a.txt", &field);
    assert_true(loss.step_um == 0.0 && !loss.warning[0]);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] += 1000.0; /* a scan that was never levelled */
    loss = dif_field_loss_of("a.gsf", &field);
    assert_string_equal(loss.warning,
                        "the heights lie 1001 um from zero, where one step of a float is 0.1193 nm: level "
                        "them");
    dif_field_free(&field);
}

static void test_write__a_flat_field_stays_flat(void **state)
{
    (void)state;
    char folder[] = "/tmp/dif-write-XXXXXX";
    assert_non_null(mkdtemp(folder));
    dif_field field = make_field(0.0, 1.0);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] = 0.25;
    for (int i = 0; i < N_FORMAT; i++)
        go_round(folder, i, &field, 0.25 * 0x1p-24); /* of a float */
    dif_field_free(&field);
    assert_int_equal(rmdir(folder), 0);
}

static void test_write__png_carries_the_keys_and_the_provenance(void **state)
{
    (void)state;
    static const struct {
        const char *key, *want;
    } KEYS[] = {{"Gwy::XReal", "8.296e-07"}, {"Gwy::YReal", "6.71e-07"}, {"Gwy::XYUnit", "m"},    {"Gwy::ZUnit", "m"},
                {"Gwy::ZMin", "-5e-07"},     {"Gwy::ZMax", "1e-06"},     {"Gwy::Title", "height"}};
    dif_field field = make_field(-0.5, 1.0);
    dif_manifest manifest = {0};
    unsigned char *png = NULL;
    size_t n = 0;
    char text[100];
    dif_error err;
    field.z_um[3] = -0.5;
    field.z_um[4] = 1.0;
    assert_int_equal(dif_manifest_set(&manifest, "version", "9.9", &err), DIF_OK);
    assert_int_equal(dif_png_field_encode(&field, &manifest, &png, &n, &err), DIF_OK);
    assert_int_equal(png[24], 16); /* bits */
    assert_int_equal(png[25], 0);  /* grey */
    for (size_t i = 0; i < sizeof KEYS / sizeof *KEYS; i++) {
        assert_true(dif_png_text(png, n, KEYS[i].key, text, sizeof text));
        assert_string_equal(text, KEYS[i].want);
    }
    int n_found = 0;
    for (size_t i = 0; i + 17 < n; i++)
        n_found += memcmp(png + i, "iTXtdiffbench.version", 21) == 0;
    assert_int_equal(n_found, 1);
    assert_int_equal(count_accepted_beginnings(png, n, NULL), 0);
    dif_release(png);
    dif_manifest_free(&manifest);
    dif_field_free(&field);
}

/* Other programs see Gwyddion's keys alone: lengths as doubles, units as strings. */
static void test_write__exr_says_the_same_in_gwyddion_keys(void **state)
{
    (void)state;
    dif_field field = make_field(-1.0, 1.0);
    dif_field_file file;
    dif_error err;
    dif_exr *exr = NULL;
    unsigned char *data = NULL;
    size_t n = 0;
    double value = 0.0;
    assert_int_equal(dif_exr_field_encode(&field, NULL, &data, &n, &err), DIF_OK);
    const dif_source source = dif_source_of(data, n, "f");
    assert_int_equal(dif_exr_open(&source, &exr, &err), DIF_OK);
    assert_null(dif_exr_text(exr, "Gwy::XReal"));
    assert_true(dif_exr_number(exr, "Gwy::XReal", &value));
    assert_near(value, 17 * field.pitch_x_um * 1e-6, 4e-16, 0.0);
    assert_true(dif_exr_number(exr, "Gwy::YReal", &value));
    assert_near(value, 11 * field.pitch_y_um * 1e-6, 4e-16, 0.0);
    assert_string_equal(dif_exr_text(exr, "Gwy::XYUnit"), "m");
    assert_string_equal(dif_exr_text(exr, "Gwy::ZUnit"), "um");
    dif_exr_close(exr);
    int n_hidden = 0;
    for (size_t i = 0; i + 10 < n; i++) {
        if (memcmp(data + i, "diffbench.", 10) == 0) {
            data[i] = 'x';
            n_hidden++;
        }
    }
    assert_int_equal(n_hidden, 3); /* both pitches and the unit of heights */
    assert_int_equal(parse_bytes(data, n, NULL, &file, &err), DIF_OK);
    assert_near(file.field.pitch_x_um, field.pitch_x_um, 1e-15, 0.0);
    assert_near(file.field.pitch_y_um, field.pitch_y_um, 1e-15, 0.0);
    for (size_t k = 0; k < dif_field_n(&field); k++)
        assert_true(file.field.z_um[k] == (double)(float)field.z_um[k]);
    dif_field_file_free(&file);
    dif_release(data);
    dif_field_free(&field);
}

static void test_write__text_is_as_gwyddion_exports_it(void **state)
{
    (void)state;
    static const char WANT[] = "# Channel: height\n# Width: 1 \xc2\xb5m\n# Height: 0.5 \xc2\xb5m\n# Value units: m\n"
                               "# diffbench.version: 9.9\n5e-07\t-2e-06\n0\t1e-06\n";
    double z_um[4] = {0.5, -2.0, 0.0, 1.0};
    const dif_field field = {2, 2, 0.5, 0.25, z_um};
    dif_manifest manifest = {0};
    unsigned char *text = NULL;
    size_t n = 0;
    dif_error err;
    assert_int_equal(dif_manifest_set(&manifest, "version", "9.9", &err), DIF_OK);
    assert_int_equal(dif_text_field_encode(&field, &manifest, &text, &n, &err), DIF_OK);
    assert_int_equal(n, sizeof WANT - 1);
    assert_memory_equal(text, WANT, n);
    dif_release(text);
    dif_manifest_free(&manifest);
}

static void test_write__refuses_what_it_cannot_write(void **state)
{
    (void)state;
    dif_field field = make_field(0.0, 1.0);
    dif_error err;
    assert_int_equal(dif_field_write("a.tif", &field, NULL, &err), DIF_ERR_ARG);
    assert_string_equal(err.text, "a.tif: heightfields are written as .exr, .gsf, .png or .txt");
    assert_int_equal(dif_field_write_check("png", &err), DIF_ERR_ARG);
    assert_int_equal(dif_field_write("/no/such/place.png", &field, NULL, &err), DIF_ERR_IO);
    assert_string_equal(err.text, "/no/such/place.png: cannot write: No such file or directory");
    field.z_um[7] = NAN;
    for (int i = 0; i < N_FORMAT; i++) {
        char path[30];
        snprintf(path, sizeof path, "/no/such/a.%s", EXTENSIONS[i]);
        assert_int_equal(dif_field_write(path, &field, NULL, &err), DIF_ERR_NONFINITE);
    }
    dif_field_free(&field);
}

static void test_write__failing_heap_leaves_nothing(void **state)
{
    (void)state;
    char folder[] = "/tmp/dif-write-XXXXXX", path[64];
    assert_non_null(mkdtemp(folder));
    dif_field field = make_field(0.0, 1.0);
    const int n_live = test_alloc_live();
    for (int i = 0; i < N_FORMAT; i++) {
        int k = 1;
        dif_status status = DIF_ERR_NOMEM;
        snprintf(path, sizeof path, "%s/a.%s", folder, EXTENSIONS[i]);
        for (; status; k++) {
            dif_error err;
            test_alloc_fail_from(k);
            status = dif_field_write(path, &field, NULL, &err);
            test_alloc_fail_from(0);
            assert_int_equal(test_alloc_live(), n_live);
            if (status && status != DIF_ERR_NOMEM)
                fail_msg("%s: allocation %d: %s", EXTENSIONS[i], k, err.text);
            assert_int_equal(access(path, F_OK) == 0, status == DIF_OK);
        }
        assert_true(k > 2);
        remove(path);
    }
    assert_int_equal(rmdir(folder), 0);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write__comes_back_within_the_loss_that_is_stated),
        cmocka_unit_test(test_loss__is_said_where_it_is_coarse),
        cmocka_unit_test(test_write__a_flat_field_stays_flat),
        cmocka_unit_test(test_write__png_carries_the_keys_and_the_provenance),
        cmocka_unit_test(test_write__exr_says_the_same_in_gwyddion_keys),
        cmocka_unit_test(test_write__text_is_as_gwyddion_exports_it),
        cmocka_unit_test(test_write__refuses_what_it_cannot_write),
        cmocka_unit_test(test_write__failing_heap_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
