#include "tests/io_cases.h"

#include "core/io/gwy_tree.h"
#include "tests/gwy_sample.h"

static void expect_field(const gwy_file *gwy, const dif_field_request *request, double first_um, double step_um,
                         const char *title, const char *warning)
{
    dif_field_file file;
    dif_error err;
    if (parse_bytes(gwy->data, gwy->n, request, &file, &err))
        fail_msg("%s", err.text);
    assert_string_equal(file.format, "gwy");
    assert_string_equal(file.title, title);
    assert_string_equal(file.warning, warning);
    assert_int_equal(file.field.nx, 3);
    assert_int_equal(file.field.ny, 2);
    assert_near(file.field.pitch_x_um, 1.0, 4e-16, 0.0); /* a product and a division round */
    assert_near(file.field.pitch_y_um, 2.0, 4e-16, 0.0);
    for (int i = 0; i < 6; i++) /* row 0 of the file is the top; a sum and a product round */
        assert_near(file.field.z_um[i], first_um + step_um * i, 8e-16, 0.0);
    dif_field_file_free(&file);
}

static void test_read__height_channel_among_items_of_every_type(void **state)
{
    (void)state;
    gwy_file file;
    gwy_full(&file);
    expect_field(&file, NULL, 1e-3, 1e-3, "Height", "");
    dif_field_request request = dif_field_request_default();
    request.channel = "1";
    request.z_unit = "nm";
    expect_field(&file, &request, 5e-12, 1e-12, "", "");
    request.z_unit = NULL;
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_SCALE, "is in V, which is no length");
}

static void test_channels__go_by_their_numbers(void **state)
{
    (void)state;
    gwy_file file;
    dif_channels channels;
    dif_error err;
    gwy_full(&file);
    assert_int_equal(dif_field_channels_parse(file.data, file.n, "f", &channels, &err), DIF_OK);
    assert_int_equal(channels.n, 2); /* neither the mask nor the fields in a list are channels */
    assert_int_equal(channels.preferred, 1);
    assert_string_equal(channels.format, "gwy");
    assert_string_equal(channels.channel[0].name, "");
    assert_string_equal(channels.channel[0].unit, "V");
    assert_false(channels.channel[0].is_height);
    assert_string_equal(channels.channel[1].name, "Height");
    assert_string_equal(channels.channel[1].unit, "m");
    assert_true(channels.channel[1].is_height);
    assert_int_equal(channels.channel[1].nx, 3);
    assert_int_equal(channels.channel[1].ny, 2);
    dif_channels_free(&channels);
}

/* One channel under this magic and with these units. */
static gwy_file make(const char *unit_xy, const char *unit_z)
{
    gwy_file file;
    const size_t at = gwy_begin(&file, "GWYP");
    gwy_key(&file, "/0/data", 'o');
    gwy_field_object(&file, 1e-9, unit_xy, unit_z);
    gwy_close(&file, at);
    return file;
}

/* In containers of version 1 a number for the type comes before the key; objects in them are as ever. */
static void test_read__version_1(void **state)
{
    (void)state;
    gwy_file file;
    const size_t at = gwy_begin(&file, "GWYO");
    gwy_key_v1(&file, 20, "/0/flag");
    gwy_bytes(&file, "\1", 1);
    gwy_key_v1(&file, 16, "/0/letter");
    gwy_bytes(&file, "x", 1);
    gwy_key_v1(&file, 24, "/0/number");
    gwy_u32(&file, 7);
    gwy_key_v1(&file, 40, "/0/long");
    gwy_real(&file, 0.0);
    gwy_key_v1(&file, 60, "/0/real");
    gwy_real(&file, 0.0);
    gwy_key_v1(&file, 80, "/0/meta");
    const size_t inner = gwy_open(&file, "GwyContainer");
    gwy_key_v1(&file, 64, "who");
    gwy_bytes(&file, "me", 3);
    gwy_close(&file, inner);
    gwy_key_v1(&file, 80, "/0/data");
    gwy_field_object(&file, 1e-9, "m", "m");
    gwy_key_v1(&file, 64, "/0/data/title");
    gwy_bytes(&file, "Old", 4);
    gwy_close(&file, at);
    expect_field(&file, NULL, 1e-3, 1e-3, "Old", "");
    assert_int_equal(count_accepted_beginnings(file.data, file.n, NULL), 0);
    file.data[4 + 13 + 4] = 99; /* the first type */
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT, "broken items");
}

static void test_read__units(void **state)
{
    (void)state;
    dif_field_request request = dif_field_request_default();
    gwy_file file = make("", "");
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_SCALE,
                       "gwy has no scale in it, give --pixel-nm or --size-um, and --z-unit (nm, um, m)");
    file = make(NULL, "m");
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_SCALE, "has no lateral scale in it, give --pixel-nm");
    file = make("m", NULL);
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_SCALE, "has no height scale in it, give --z-unit");
    file = make("m", "A"); /* ampere, not Angstrom */
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT,
                       "no channel is known to hold heights: 1 (A); name one with --channel");
    file = make("m", "nm");
    expect_field(&file, NULL, 1e-3, 1e-3, "", "lengths are taken in m, although the file names 'nm'");
    request.z_unit = "um";
    file = make("m", "");
    expect_field(&file, &request, 1e-9, 1e-9, "", "");
}

/* A file whose one field holds these items in place of size, extents and samples. */
static gwy_file make_with(int32_t nx, int32_t ny, double size_x, uint32_t count, uint32_t n_real)
{
    gwy_file file;
    const size_t at = gwy_begin(&file, "GWYP");
    gwy_key(&file, "/0/data", 'o');
    const size_t field = gwy_open(&file, "GwyDataField");
    gwy_int(&file, "xres", nx);
    gwy_int(&file, "yres", ny);
    gwy_double(&file, "xreal", size_x);
    gwy_double(&file, "yreal", 1e-6);
    gwy_unit(&file, "si_unit_xy", "m");
    gwy_unit(&file, "si_unit_z", "m");
    gwy_key(&file, "data", 'D');
    gwy_u32(&file, count);
    for (uint32_t i = 0; i < n_real; i++)
        gwy_real(&file, 0.0);
    gwy_close(&file, field);
    gwy_close(&file, at);
    return file;
}

static void test_read__counts_are_held_against_the_bytes(void **state)
{
    (void)state;
    static const struct {
        int32_t nx, ny;
        uint32_t count, n_real;
        dif_status want;
        const char *text;
    } FIELDS[] = {
        {0, 2, 0, 0, DIF_ERR_FORMAT, "0 x 2 samples, want at least 1 x 1"},
        {-3, 2, 6, 6, DIF_ERR_FORMAT, "-3 x 2 samples"},
        {2147483647, 2147483647, 6, 6, DIF_ERR_SIZE, "2147483647 x 2147483647 samples, want at most"},
        {32768, 32768, 6, 6, DIF_ERR_SIZE, "32768 x 32768 samples, want at most"},
        {3, 2, 5, 5, DIF_ERR_FORMAT, "5 samples, want 3 x 2"},
        {3, 2, 7, 7, DIF_ERR_FORMAT, "7 samples, want 3 x 2"},
        {3, 2, 7, 6, DIF_ERR_FORMAT, "broken items"},
        {3, 2, 0xffffffffu, 6, DIF_ERR_FORMAT, "broken items"},
        {3, 2, 0x20000006u, 6, DIF_ERR_FORMAT, "broken items"}, /* times 8 is 48 in 32 bits */
    };
    for (size_t i = 0; i < sizeof FIELDS / sizeof *FIELDS; i++) {
        const gwy_file file = make_with(FIELDS[i].nx, FIELDS[i].ny, 1e-6, FIELDS[i].count, FIELDS[i].n_real);
        assert_parse_fails(file.data, file.n, NULL, FIELDS[i].want, FIELDS[i].text);
    }
    static const double EXTENTS[] = {0.0, -1.0, (double)INFINITY, (double)NAN};
    for (int i = 0; i < 4; i++) {
        const gwy_file file = make_with(3, 2, EXTENTS[i], 6, 6);
        assert_parse_fails(file.data, file.n, NULL, DIF_ERR_SCALE, "has no lateral scale in it, give --pixel-nm");
    }
}

static void test_read__what_is_no_container_with_images(void **state)
{
    (void)state;
    gwy_file file;
    gwy_close(&file, gwy_begin(&file, "GWYP"));
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT, "a Gwyddion file without images");
    file.n = 0;
    gwy_bytes(&file, "GWYP", 4);
    gwy_field_object(&file, 0.0, "m", "m");
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT, "Gwyddion file without a container");
    assert_parse_fails("GWYP", 4, NULL, DIF_ERR_FORMAT, "ends within its container (truncated?)");
    assert_parse_fails("GWYPGwyContainer\0\xff\xff\xff\xff", 21, NULL, DIF_ERR_FORMAT, "ends within its container");
}

/* Arrays whose counts promise what the bytes behind them cannot hold, and types that do not exist. */
static void test_read__absurd_items_end_at_once(void **state)
{
    (void)state;
    static const char TYPES[] = "CIQDSOBXxZ?";
    for (size_t i = 0; i < sizeof TYPES - 1; i++) {
        gwy_file file;
        const size_t at = gwy_begin(&file, "GWYP");
        gwy_key(&file, "/0/data", 'o');
        gwy_field_object(&file, 1e-9, "m", "m");
        gwy_key(&file, "/list", TYPES[i]);
        gwy_u32(&file, 0xffffffffu);
        gwy_bytes(&file, "a\0b\0c\0d", 7);
        gwy_close(&file, at);
        assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT, "broken items (truncated or damaged?)");
    }
}

/* Containers in containers, deeper than any stack that follows them. */
static void test_read__depth_costs_nothing(void **state)
{
    (void)state;
    enum { DEPTH = 200000 };
    static const char HEAD[] = "a\0o"
                               "b"; /* an item "a" that is an object "b" */
    const size_t n_head = sizeof HEAD - 1 + 1 + 4, n = 4 + 13 + 4 + n_head * DEPTH;
    unsigned char *data = calloc(n, 1);
    assert_non_null(data);
    memcpy(data, "GWYPGwyContainer", 17);
    for (size_t i = 0; i <= DEPTH; i++) {
        unsigned char *size = data + 17 + i * n_head;
        const uint32_t left = (uint32_t)((DEPTH - i) * n_head);
        for (int k = 0; k < 4; k++)
            size[k] = (unsigned char)(left >> (8 * k));
        if (i < DEPTH)
            memcpy(size + 4, HEAD, sizeof HEAD);
    }
    assert_parse_fails(data, n, NULL, DIF_ERR_FORMAT, "a Gwyddion file without images");
    free(data);
}

static void test_read__channels_are_bounded(void **state)
{
    (void)state;
    enum { ITEM = 40 };
    unsigned char *data = calloc((DIF_CHANNELS_MAX + 2) * ITEM, 1);
    assert_non_null(data);
    size_t n = 21;
    memcpy(data, "GWYPGwyContainer", 17);
    for (int i = 0; i <= DIF_CHANNELS_MAX; i++) {
        n += (size_t)snprintf((char *)data + n, ITEM, "/%d/data", i) + 1;
        data[n++] = 'o';
        memcpy(data + n, "GwyDataField", 13);
        n += 13 + 4; /* without items */
    }
    const uint32_t size = (uint32_t)(n - 21);
    for (int k = 0; k < 4; k++)
        data[17 + k] = (unsigned char)(size >> (8 * k));
    assert_parse_fails(data, n, NULL, DIF_ERR_SIZE, "more than 1024 channels");
    free(data);
}

static void test_read__channels_of_one_name(void **state)
{
    (void)state;
    gwy_file file;
    dif_field_request request = dif_field_request_default();
    const size_t at = gwy_begin(&file, "GWYP");
    for (int i = 0; i < 2; i++) {
        gwy_key(&file, i ? "/12/data" : "/2/data", 'o');
        gwy_field_object(&file, (1 + i) * 1e-9, "m", "m");
        gwy_text(&file, i ? "/12/data/title" : "/2/data/title", "Z");
    }
    gwy_close(&file, at);
    expect_field(&file, NULL, 1e-3, 1e-3, "Z", "");
    request.channel = "2";
    expect_field(&file, &request, 2e-3, 1e-3, "Z", "");
    request.channel = "z";
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_FORMAT, "2 channels are called 'z'");
}

static void test_parse__every_beginning_is_refused(void **state)
{
    (void)state;
    gwy_file file;
    gwy_full(&file);
    assert_int_equal(count_accepted_beginnings(file.data, file.n, NULL), 0);
}

static void test_parse__heap_that_fails_is_reported(void **state)
{
    (void)state;
    gwy_file file;
    gwy_full(&file);
    assert_true(parse_with_failing_heap(file.data, file.n, NULL) >= 4); /* fields twice, channels, samples */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__height_channel_among_items_of_every_type),
        cmocka_unit_test(test_channels__go_by_their_numbers),
        cmocka_unit_test(test_read__version_1),
        cmocka_unit_test(test_read__units),
        cmocka_unit_test(test_read__counts_are_held_against_the_bytes),
        cmocka_unit_test(test_read__what_is_no_container_with_images),
        cmocka_unit_test(test_read__absurd_items_end_at_once),
        cmocka_unit_test(test_read__depth_costs_nothing),
        cmocka_unit_test(test_read__channels_are_bounded),
        cmocka_unit_test(test_read__channels_of_one_name),
        cmocka_unit_test(test_parse__every_beginning_is_refused),
        cmocka_unit_test(test_parse__heap_that_fails_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
