#include "tests/io_cases.h"

#include <limits.h>

#include "core/io/exr_io.h"
#include "tests/exr_sample.h"

enum { N_COMPRESSION = EXR_COMPRESSION_DWAA }; /* the library's C part has no DWA */

static dif_field_request request_um(void)
{
    dif_field_request request = dif_field_request_default();
    request.pixel_um = 0.5;
    request.z_unit = "um";
    return request;
}

/* Reads the sample and compares it with channel c, to tol relative to the range of values. */
static void expect_channel(const exr_sample *sample, const char *channel, int c, double tol)
{
    dif_field_request request = request_um();
    dif_field_file file;
    dif_error err;
    request.channel = channel;
    if (parse_bytes(sample->data, sample->n, &request, &file, &err))
        fail_msg("%s", err.text);
    assert_string_equal(file.format, "exr");
    assert_string_equal(file.title, sample->names[c]);
    assert_int_equal(file.field.nx, sample->nx);
    assert_int_equal(file.field.ny, sample->ny);
    for (int iy = 0; iy < sample->ny; iy++) {
        for (int ix = 0; ix < sample->nx; ix++)
            assert_near(file.field.z_um[iy * sample->nx + ix], (double)exr_sample_value(c, ix, iy), 0.0, 64.0 * tol);
    }
    dif_field_file_free(&file);
}

static void test_read__every_compression_as_float_and_half(void **state)
{
    (void)state;
    /* Lossless ones must be exact; PXR24 keeps 15 bits of a float's mantissa, B44 is for pictures. */
    static const double TOL[N_COMPRESSION] = {
        [EXR_COMPRESSION_PXR24] = 1e-4, [EXR_COMPRESSION_B44] = 1e-2, [EXR_COMPRESSION_B44A] = 1e-2};
    for (int compression = 0; compression < N_COMPRESSION; compression++) {
        for (int half = 0; half < 2; half++) {
            exr_sample sample = exr_sample_make(37, 70);
            sample.compression = (exr_compression_t)compression;
            sample.type = half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
            exr_sample_write(&sample);
            expect_channel(&sample, NULL, 0, TOL[compression]);
        }
    }
}

static void test_read__tiles_and_shifted_windows(void **state)
{
    (void)state;
    for (int tile = 0; tile <= 64; tile += 16) {
        for (int shift = -1; shift <= 1; shift++) {
            exr_sample sample = exr_sample_make(53, 41);
            sample.tile = tile;
            sample.x0 = 1000 * shift;
            sample.y0 = 777 * shift;
            exr_sample_write(&sample);
            expect_channel(&sample, NULL, 0, 0.0);
        }
    }
}

static void test_read__chooses_the_channel(void **state)
{
    (void)state;
    exr_sample sample = exr_sample_make(20, 10);
    sample.n_channel = 4;
    sample.names[0] = "A";
    sample.names[1] = "R";
    sample.names[2] = "G";
    sample.names[3] = "B";
    for (int tile = 0; tile <= 16; tile += 16) {
        sample.tile = tile;
        exr_sample_write(&sample);
        expect_channel(&sample, NULL, 1, 0.0);
        for (int c = 0; c < 4; c++)
            expect_channel(&sample, sample.names[c], c, 0.0);
    }
    sample.n_channel = 2;
    sample.names[0] = "depth";
    sample.names[1] = "other";
    exr_sample_write(&sample);
    expect_channel(&sample, NULL, 0, 0.0);
    dif_field_request request = request_um();
    request.channel = "Q";
    assert_parse_fails(sample.data, sample.n, &request, DIF_ERR_FORMAT,
                       "no channel 'Q', it has 1 depth (no unit), 2 other (no unit)");
}

static void test_read__refuses_kinds_that_hold_no_plain_floats(void **state)
{
    (void)state;
    const dif_field_request request = request_um();
    exr_sample sample = exr_sample_make(20, 10);
    sample.type = EXR_PIXEL_UINT;
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, &request, DIF_ERR_UNSUPPORTED, "channel 'height' holds integers");
    sample = exr_sample_make(20, 10);
    sample.n_part = 2;
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, &request, DIF_ERR_UNSUPPORTED, "EXR of 2 parts, want one");
    sample = exr_sample_make(20, 1);
    sample.compression = EXR_COMPRESSION_NONE;
    exr_sample_write(&sample);
    static const char NAME[] = "compression\0compression";
    size_t at = 0;
    while (memcmp(sample.data + at, NAME, sizeof NAME) != 0)
        at++;
    sample.data[at + sizeof NAME + 4] = EXR_COMPRESSION_DWAA;
    const uint32_t shorter = 40; /* packed bytes, so that something is to be unpacked */
    memcpy(sample.data + sample.n - 20 * 4 - 4, &shorter, 4);
    assert_parse_fails(sample.data, sample.n, &request, DIF_ERR_UNSUPPORTED, "EXR pixels: ");
}

static void test_read__scale_comes_from_gwyddion_keys(void **state)
{
    (void)state;
    exr_sample sample = exr_sample_make(20, 10);
    static const char *const KEYS[] = {"Gwy::XReal", "Gwy::YReal", "Gwy::XYUnit", "Gwy::ZUnit"};
    static const char *const TEXTS[] = {"4e-6", "5e-6", "m", "nm"};
    memcpy(sample.keys, KEYS, sizeof KEYS);
    memcpy(sample.texts, TEXTS, sizeof TEXTS);
    exr_sample_write(&sample);
    dif_field_file file;
    dif_error err;
    assert_int_equal(parse_bytes(sample.data, sample.n, NULL, &file, &err), DIF_OK);
    assert_near(file.field.pitch_x_um, 0.2, 4e-16, 0.0);
    assert_near(file.field.pitch_y_um, 0.5, 4e-16, 0.0);
    assert_near(file.field.z_um[3], 0.75e-3, 4e-16, 0.0);
    dif_field_file_free(&file);
    sample.texts[3] = "V";
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, NULL, DIF_ERR_SCALE, "is in V, which is no length");
    sample.texts[3] = "m";
    sample.texts[0] = "many";
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, NULL, DIF_ERR_FORMAT, "Gwy::XReal is 'many', want a finite number");
    sample.texts[0] = "-1";
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, NULL, DIF_ERR_FORMAT, "Gwy::XReal, YReal are -1e+06");
}

static void test_read__own_attributes_must_make_sense(void **state)
{
    (void)state;
    static const char *const BAD[] = {"0", "-1", "nan", "inf", "word"};
    for (int i = 0; i < 5; i++) {
        exr_sample sample = exr_sample_make(4, 4);
        sample.keys[0] = "diffbench.pitch_x_um";
        sample.texts[0] = BAD[i];
        sample.keys[1] = "diffbench.pitch_y_um";
        sample.texts[1] = "0.1";
        sample.keys[2] = "diffbench.z_unit";
        sample.texts[2] = "um";
        exr_sample_write(&sample);
        assert_parse_fails(sample.data, sample.n, NULL, DIF_ERR_FORMAT, "want finite numbers > 0");
    }
    exr_sample sample = exr_sample_make(4, 4);
    sample.keys[0] = "diffbench.z_unit";
    sample.texts[0] = "volt";
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, NULL, DIF_ERR_FORMAT, "diffbench.z_unit is 'volt', want a length unit");
    sample.keys[0] = "diffbench.fixed_angle";
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, NULL, DIF_ERR_FORMAT, "a response table, want a heightfield");
}

static void test_read__missing_scale_names_the_flags(void **state)
{
    (void)state;
    exr_sample sample = exr_sample_make(4, 4);
    exr_sample_write(&sample);
    assert_parse_fails(sample.data, sample.n, NULL, DIF_ERR_SCALE,
                       "exr has no scale in it, give --pixel-nm or --size-um, and --z-unit");
}

static dif_field make_field(int nx, int ny)
{
    dif_field field;
    dif_error err;
    uint64_t seed = 9;
    assert_int_equal(dif_field_create(nx, ny, 65.0 / 1332.0, 0.1 + 0.2, &field, &err), DIF_OK);
    for (int i = 0; i < nx * ny; i++)
        field.z_um[i] = test_random(&seed, -1.0, 1.0);
    return field;
}

static void test_encode__pitches_come_back_exactly_and_heights_as_floats(void **state)
{
    (void)state;
    static const int SIZES[][2] = {{1, 1}, {1, 33}, {100, 1}, {65, 50}, {1024, 17}};
    for (int i = 0; i < 5; i++) {
        dif_field field = make_field(SIZES[i][0], SIZES[i][1]);
        dif_field_file file;
        dif_error err;
        unsigned char *data = NULL;
        size_t n = 0;
        assert_int_equal(dif_exr_field_encode(&field, NULL, &data, &n, &err), DIF_OK);
        assert_int_equal(parse_bytes(data, n, NULL, &file, &err), DIF_OK);
        assert_string_equal(file.warning, "");
        assert_true(file.field.pitch_x_um == field.pitch_x_um && file.field.pitch_y_um == field.pitch_y_um);
        for (size_t k = 0; k < dif_field_n(&field); k++)
            assert_true(file.field.z_um[k] == (double)(float)field.z_um[k]);
        dif_release(data);
        dif_field_file_free(&file);
        dif_field_free(&field);
    }
}

static void test_encode__manifest_travels_also_under_long_names(void **state)
{
    (void)state;
    dif_field field = make_field(8, 8);
    dif_manifest manifest = {0}, back = {0};
    dif_error err;
    unsigned char *data = NULL;
    size_t n = 0;
    assert_int_equal(dif_manifest_set(&manifest, "command", "diffbench fixture --seed 1", &err), DIF_OK);
    assert_int_equal(dif_manifest_set(&manifest, "z_unit", "lies", &err), DIF_OK); /* ours wins */
    assert_int_equal(dif_manifest_set(&manifest, "a_key_that_is_longer_than_short_names_allow", "\xc2\xb5", &err),
                     DIF_OK);
    assert_int_equal(dif_exr_field_encode(&field, &manifest, &data, &n, &err), DIF_OK);
    const dif_source source = dif_source_of(data, n, "f");
    static const char *const SKIP[] = {"diffbench.z_unit", NULL};
    dif_exr *exr = NULL;
    assert_int_equal(dif_exr_open(&source, &exr, &err), DIF_OK);
    assert_string_equal(dif_exr_text(exr, "diffbench.z_unit"), "um");
    assert_null(dif_exr_text(exr, "no such"));
    assert_int_equal(dif_exr_take_manifest(exr, SKIP, &back, &err), DIF_OK);
    assert_int_equal(back.n, 2);
    assert_string_equal(dif_manifest_get(&back, "command"), "diffbench fixture --seed 1");
    assert_string_equal(dif_manifest_get(&back, "a_key_that_is_longer_than_short_names_allow"), "\xc2\xb5");
    dif_exr_close(exr);
    dif_release(data);
    dif_manifest_free(&manifest);
    dif_manifest_free(&back);
    dif_field_free(&field);
}

static void test_read__every_beginning_is_refused(void **state)
{
    (void)state;
    dif_field field = make_field(9, 20);
    dif_error err;
    unsigned char *data = NULL;
    size_t n = 0;
    assert_int_equal(dif_exr_field_encode(&field, NULL, &data, &n, &err), DIF_OK);
    assert_int_equal(count_accepted_beginnings(data, n, NULL), 0);
    const dif_field_request request = request_um();
    exr_sample sample = exr_sample_make(40, 20);
    sample.tile = 16;
    exr_sample_write(&sample);
    assert_int_equal(count_accepted_beginnings(sample.data, sample.n, &request), 0);
    dif_release(data);
    dif_field_free(&field);
}

/* The data window stands behind the attribute's name and type as four little-endian numbers. */
static void test_read__sizes_that_lie_are_refused(void **state)
{
    (void)state;
    static const struct {
        int32_t x1, y1;
    } LIES[] = {{INT_MAX - 1, INT_MAX - 1}, {100000, 9}, {40, 40}, {-2, 5}, {19, 200000}, {32767, 32767}};
    const dif_field_request request = request_um();
    for (size_t i = 0; i < sizeof LIES / sizeof *LIES; i++) {
        exr_sample sample = exr_sample_make(20, 10);
        exr_sample_write(&sample);
        static const char NAME[] = "dataWindow\0box2i";
        size_t at = 0;
        while (memcmp(sample.data + at, NAME, sizeof NAME) != 0)
            at++;
        at += sizeof NAME + 4 + 8;
        memcpy(sample.data + at, &LIES[i].x1, 4);
        memcpy(sample.data + at + 4, &LIES[i].y1, 4);
        dif_field_file file;
        dif_error err;
        const dif_status status = parse_bytes(sample.data, sample.n, &request, &file, &err);
        assert_true(status == DIF_ERR_FORMAT || status == DIF_ERR_SIZE);
    }
}

static void test_read__damaged_bytes_never_crash(void **state)
{
    (void)state;
    const dif_field_request request = request_um();
    uint64_t seed = 21;
    int n_refused = 0;
    for (int i = 0; i < 3000; i++) {
        exr_sample sample = exr_sample_make(12, 9);
        sample.compression = (exr_compression_t)(i % N_COMPRESSION);
        exr_sample_write(&sample);
        unsigned char *copy = malloc(sample.n);
        assert_non_null(copy);
        memcpy(copy, sample.data, sample.n);
        for (int k = 0; k < 3; k++)
            copy[test_random_next(&seed) % sample.n] = (unsigned char)test_random_next(&seed);
        dif_field_file file;
        dif_error err;
        if (parse_bytes(copy, sample.n, &request, &file, &err))
            n_refused++;
        dif_field_file_free(&file);
        free(copy);
    }
    assert_true(n_refused > 300);
}

static void test_read__failing_heap_is_said(void **state)
{
    (void)state;
    dif_field field = make_field(70, 70);
    dif_error err;
    unsigned char *data = NULL;
    size_t n = 0;
    assert_int_equal(dif_exr_field_encode(&field, NULL, &data, &n, &err), DIF_OK);
    assert_true(parse_with_failing_heap(data, n, NULL) > 5);
    dif_release(data);
    dif_field_free(&field);
}

static void test_encode__failing_heap_is_said(void **state)
{
    (void)state;
    dif_field field = make_field(70, 70);
    const int n_live = test_alloc_live();
    dif_status status = DIF_ERR_NOMEM;
    int k = 0;
    while (status) {
        dif_error err;
        unsigned char *data = NULL;
        size_t n = 0;
        test_alloc_fail_from(++k);
        status = dif_exr_field_encode(&field, NULL, &data, &n, &err);
        test_alloc_fail_from(0);
        assert_true(status == DIF_OK || (status == DIF_ERR_NOMEM && !data));
        dif_release(data);
        assert_int_equal(test_alloc_live(), n_live);
        assert_true(k < 5000);
    }
    assert_true(k > 5);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__every_compression_as_float_and_half),
        cmocka_unit_test(test_read__tiles_and_shifted_windows),
        cmocka_unit_test(test_read__chooses_the_channel),
        cmocka_unit_test(test_read__refuses_kinds_that_hold_no_plain_floats),
        cmocka_unit_test(test_read__scale_comes_from_gwyddion_keys),
        cmocka_unit_test(test_read__own_attributes_must_make_sense),
        cmocka_unit_test(test_read__missing_scale_names_the_flags),
        cmocka_unit_test(test_encode__pitches_come_back_exactly_and_heights_as_floats),
        cmocka_unit_test(test_encode__manifest_travels_also_under_long_names),
        cmocka_unit_test(test_read__every_beginning_is_refused),
        cmocka_unit_test(test_read__sizes_that_lie_are_refused),
        cmocka_unit_test(test_read__damaged_bytes_never_crash),
        cmocka_unit_test(test_read__failing_heap_is_said),
        cmocka_unit_test(test_encode__failing_heap_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
