/* Files of microscopes, held against what Gwyddion reads from them: every channel of every file of the list. */
#include "tests/io_cases.h"

#include <jansson.h>

static double real_of(const json_t *channel, const char *key)
{
    const json_t *value = json_object_get(channel, key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static const char *text_of(const json_t *channel, const char *key)
{
    const char *text = json_string_value(json_object_get(channel, key));
    assert_non_null(text);
    return text;
}

/* The reference in base units: lengths in m, and V or deg by their own. As heights in um all become 1e6 times that. */
static void expect_heights(const dif_field *field, const json_t *want)
{
    dif_field_stats stats;
    dif_error err;
    const int nx = field->nx;
    const size_t n = dif_field_n(field);
    const struct {
        const char *key;
        double got_um;
    } corners[] = {{"top_left", field->z_um[0]},
                   {"top_right", field->z_um[nx - 1]},
                   {"bottom_left", field->z_um[n - (size_t)nx]},
                   {"bottom_right", field->z_um[n - 1]}};
    /* an integer times a scale of four factors, in another order than there */
    const double rel = 8.0 * 2.3e-16, range = (real_of(want, "max") - real_of(want, "min")) * 1e6;
    for (int i = 0; i < 4; i++)
        assert_near(corners[i].got_um, real_of(want, corners[i].key) * 1e6, rel, 0.0);
    assert_int_equal(dif_field_stats_of(field, &stats, &err), DIF_OK);
    assert_near(stats.min_um, real_of(want, "min") * 1e6, rel, 0.0);
    assert_near(stats.max_um, real_of(want, "max") * 1e6, rel, 0.0);
    assert_near(stats.mean_um, real_of(want, "mean") * 1e6, rel, 1e-13 * range); /* sums of 3e5 numbers */
    assert_near(stats.rms_um, real_of(want, "rms") * 1e6, 1e-12, 0.0);
}

/* Which units of the reference are lengths. */
static bool is_length(const json_t *want)
{
    return strcmp(text_of(want, "z_unit"), "m") == 0;
}

/* Reads a channel by its number, with the scale that it has not given by hand: numbers as metres. */
static void expect_channel(const char *path, const dif_channels *channels, int i, const json_t *want)
{
    const dif_channel *channel = &channels->channel[i];
    char number[16];
    dif_field_file file;
    dif_error err;
    dif_field_request request = dif_field_request_default();
    snprintf(number, sizeof number, "%d", i + 1);
    request.channel = number;
    assert_int_equal(channel->is_height, is_length(want));
    assert_int_equal(channel->nx, real_of(want, "xres"));
    assert_int_equal(channel->ny, real_of(want, "yres"));
    if (!channel->is_height) {
        assert_int_equal(dif_field_read(path, &request, &file, &err), DIF_ERR_SCALE);
        assert_non_null(strstr(err.text, "--z-unit"));
        request.z_unit = "m";
    }
    const bool has_pitch = strcmp(text_of(want, "xy_unit"), "m") == 0;
    if (!has_pitch) {
        assert_int_equal(dif_field_read(path, &request, &file, &err), DIF_ERR_SCALE);
        assert_non_null(strstr(err.text, "--pixel-nm"));
        request.pixel_um = 1e6 * real_of(want, "xreal") / real_of(want, "xres");
    }
    if (dif_field_read(path, &request, &file, &err))
        fail_msg("%s", err.text);
    const dif_field *field = &file.field;
    assert_int_equal(file.channel, i + 1);
    assert_int_equal(file.n_channel, channels->n);
    assert_string_equal(file.title, channel->name);
    assert_int_equal(field->nx, channel->nx);
    assert_int_equal(field->ny, channel->ny);
    assert_near(field->pitch_x_um * field->nx, real_of(want, "xreal") * 1e6, 1e-15, 0.0);
    assert_near(field->pitch_y_um * field->ny, real_of(want, "yreal") * 1e6, 1e-15, 0.0);
    expect_heights(field, want);
    dif_field_file_free(&file);
}

/* Gwyddion's own names where a format has none. */
static void expect_name(const dif_channels *channels, int i, const json_t *want)
{
    if (channels->channel[i].name[0])
        assert_string_equal(channels->channel[i].name, text_of(want, "title"));
    else
        assert_string_equal(text_of(want, "title"), "Topography");
}

static void test_read__every_channel_agrees_with_gwyddion(void **state)
{
    (void)state;
    const char *data = test_data_folder();
    if (!data)
        skip();
    char path[1024];
    json_error_t problem;
    snprintf(path, sizeof path, "%s/afm/REFERENCE_gwyddion.json", data);
    json_t *root = json_load_file(path, 0, &problem);
    assert_non_null(root);
    int n_file = 0;
    const char *name;
    json_t *about;
    json_object_foreach(json_object_get(root, "files"), name, about)
    {
        const json_t *want = json_object_get(about, "channels");
        dif_channels channels;
        dif_error err;
        snprintf(path, sizeof path, "%s/%s", data, name);
        const dif_status status = dif_field_channels(path, &channels, &err);
        if (status)
            fail_msg("%s", err.text);
        assert_int_equal(channels.n, json_array_size(want));
        for (int i = 0; i < channels.n; i++) {
            expect_name(&channels, i, json_array_get(want, (size_t)i));
            expect_channel(path, &channels, i, json_array_get(want, (size_t)i));
        }
        print_message("%s: %d channel%s as Gwyddion reads them\n", name, channels.n, channels.n == 1 ? "" : "s");
        dif_channels_free(&channels);
        n_file++;
    }
    assert_int_equal(n_file, 8);
    json_decref(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__every_channel_agrees_with_gwyddion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
