/* Which channels a NanoScope file has, and what is refused. */
#include "tests/nano_sample.h"

/* Five channels: which is chosen, how they are listed and how each is named. */
static nano_file make_five(void)
{
    static const char *const KINDS[] = {
        "\\@2:Image Data: S [Deformation] \"Deformation\"", "\\@3:Image Data: S [Phase] \"Phase\"", NANO_HEIGHT,
        "\\@2:Image Data: S [AmplitudeError] \"Amplitude Error\"", "\\@2:Image Data: S [ZSensor] \"Height Sensor\""};
    static const char *const SCALES[] = {"\\@2:Z scale: V [Sens. ZsensSens] (0.1 V/LSB) 1 V",
                                         "\\@3:Z scale: V [Sens. Phase] (0.0055 V/LSB) 360.0 V", NANO_SCALE,
                                         "\\@2:Z scale: V [Sens. Amplitude Error] (0.06 mV/LSB) 4000 mV",
                                         "\\@2:Z scale: V [Sens. ZsensSens] (0.1 V/LSB) 10 V"};
    nano_file file;
    nano_begin(&file, NANO_MAGIC, "0x08150300");
    for (int i = 0; i < 5; i++) {
        nano_channel(&file, 2, 2);
        nano_line(&file, "\\Line Direction: %s", i % 2 ? "Retrace" : "Trace");
        nano_line(&file, "%s", KINDS[i]);
        nano_line(&file, "%s", SCALES[i]);
    }
    nano_line(&file, "\\*Ciao force image list"); /* no image */
    nano_line(&file, "\\Data offset: 40960");
    nano_end(&file, 2, NANO_SIX, 6);
    for (int i = 1; i < 5; i++) {
        memcpy(file.data + file.n, file.data + NANO_HEADER, 12);
        file.n += 12;
    }
    return file;
}

static void test_channels__are_listed_with_units_and_the_height_is_chosen(void **state)
{
    (void)state;
    static const dif_channel WANT[] = {
        {"Deformation", "Deformation", "Trace", "~m", 3, 2, true},
        {"Phase", "Phase", "Retrace", "deg", 3, 2, false},
        {"Height", "Height", "Trace", "nm", 3, 2, true},
        {"AmplitudeError", "Amplitude Error", "Retrace", "mV", 3, 2, false},
        {"ZSensor", "Height Sensor", "Trace", "~m", 3, 2, true},
    };
    const nano_file file = make_five();
    dif_channels channels;
    dif_error err;
    if (dif_field_channels_parse(file.data, file.n, "f", &channels, &err))
        fail_msg("%s", err.text);
    assert_int_equal(channels.n, 5);
    assert_int_equal(channels.preferred, 4);
    assert_string_equal(channels.format, "nanoscope");
    for (int i = 0; i < 5; i++) {
        assert_string_equal(channels.channel[i].name, WANT[i].name);
        assert_string_equal(channels.channel[i].alias, WANT[i].alias);
        assert_string_equal(channels.channel[i].note, WANT[i].note);
        assert_string_equal(channels.channel[i].unit, WANT[i].unit);
        assert_int_equal(channels.channel[i].nx, 3);
        assert_int_equal(channels.channel[i].ny, 2);
        assert_int_equal(channels.channel[i].is_height, WANT[i].is_height);
    }
    dif_channels_free(&channels);
}

static void test_read__channel_by_name_alias_and_number(void **state)
{
    (void)state;
    const nano_file file = make_five();
    assert_nano_six(&file, NULL, 10.0 * 0.5 / 65536.0);
    assert_nano_six(&file, "zsensor", 10.0 * 0.5 / 65536.0);
    assert_nano_six(&file, "height sensor", 10.0 * 0.5 / 65536.0);
    assert_nano_six(&file, "5", 10.0 * 0.5 / 65536.0);
    assert_nano_six(&file, "Height", 10.0 * 20e-3 / 65536.0);
    assert_nano_six(&file, "3", 10.0 * 20e-3 / 65536.0);
    assert_nano_six(&file, "Def", 1.0 * 0.5 / 65536.0);
}

static void test_read__channel_that_is_no_height(void **state)
{
    (void)state;
    const nano_file file = make_five();
    dif_field_request request = dif_field_request_default();
    request.channel = "phase";
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_SCALE,
                       "channel 'Phase' is in deg, which is no length; to take its numbers as heights give --z-unit");
    request.z_unit = "nm";
    dif_field_file got;
    dif_error err;
    assert_int_equal(parse_bytes(file.data, file.n, &request, &got, &err), DIF_OK);
    for (int i = 0; i < 6; i++)
        assert_near(got.field.z_um[NANO_PLACE[i]], (double)NANO_SIX[i] * 360.0 / 65536.0 * 1e-3, 1e-15, 0.0);
    dif_field_file_free(&got);
    request.channel = "no such";
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_FORMAT,
                       "no channel 'no such', it has 1 Deformation (~m), 2 Phase (deg), 3 Height (nm), ");
    request.channel = "he";
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_FORMAT,
                       "2 channels begin with 'he': 1 Deformation (~m), 2 Phase (deg), 3 Height (nm), ");
    request.channel = "6";
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_FORMAT, "no channel '6', it has 1 Deformation");
    request.channel = "0";
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_FORMAT, "no channel '0'");
}

/* A length alone is no height: deformations and amplitudes are in nm, too. */
static void test_read__without_a_height_channel_the_user_names_one(void **state)
{
    (void)state;
    nano_file file;
    nano_begin(&file, NANO_MAGIC, "0x08150300");
    nano_channel(&file, 2, 2);
    nano_line(&file, "\\@2:Image Data: S [Deformation] \"Deformation\"");
    nano_line(&file, "%s", NANO_SCALE);
    nano_end(&file, 2, NANO_SIX, 6);
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT,
                       "no channel is known to hold heights: 1 Deformation (nm); name one with --channel");
    assert_nano_six(&file, "1", 10.0 * 20e-3 / 65536.0);
}

static void test_read__trace_and_retrace_are_told_apart_by_number(void **state)
{
    (void)state;
    nano_file file;
    dif_field_request request = dif_field_request_default();
    nano_begin(&file, NANO_MAGIC, "0x08150300");
    for (int i = 0; i < 2; i++) {
        nano_channel(&file, 2, 2);
        nano_line(&file, "\\Line direction: %s", i ? "Retrace" : "Trace");
        nano_line(&file, "%s", NANO_HEIGHT);
        nano_line(&file, "\\@2:Z scale: V [Sens. Zsens] (0.5000000 V/LSB) %d V", i + 1);
    }
    nano_end(&file, 2, NANO_SIX, 6);
    memcpy(file.data + file.n, file.data + NANO_HEADER, 12);
    file.n += 12;
    assert_nano_six(&file, NULL, 20e-3 / 65536.0);
    assert_nano_six(&file, "2", 40e-3 / 65536.0);
    request.channel = "Height";
    assert_parse_fails(file.data, file.n, &request, DIF_ERR_FORMAT,
                       "2 channels are called 'Height': 1 Height (nm), 2 Height (nm); give the number to --channel");
}

static void test_read__units_that_do_not_cancel_are_no_heights(void **state)
{
    (void)state;
    static const struct {
        const char *scale, *unit;
    } SCALES[] = {
        {"\\@2:Z scale: V [Sens. Zsens] (0.5 A/LSB) 10.00000 A", "is in A nm/V"},
        {"\\@2:Z scale: V [Sens. Nowhere] (0.5 nm/LSB) 10.00000 nm", "is in nm, "},
        {"\\@2:Z scale: V (0.5 \xba/LSB) 360.0 \xba", "is in deg"},
        {"\\@2:Z scale: V [Sens. Amplitude Error] 10.00000 V", "is in V"},
        {"\\@2:Z scale: V 10.00000 A", "is in A"}, /* ampere, not Angstrom */
    };
    dif_field_request request = dif_field_request_default();
    request.channel = "1";
    for (size_t i = 0; i < sizeof SCALES / sizeof *SCALES; i++) {
        const nano_file file = nano_make("0x07200000", SCALES[i].scale);
        assert_parse_fails(file.data, file.n, &request, DIF_ERR_SCALE, SCALES[i].unit);
        assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT, "no channel is known to hold heights");
    }
}

static void test_read__what_is_no_binary_image_is_said_so(void **state)
{
    (void)state;
    static const char FORCE[] = "\\*Force file list\r\n\\Version: 0x07200000\r\n\\*File list end\r\n";
    static const char TEXT[] = "?*File list\r\n?*File list end\r\n";
    static const char *const DAMAGED[] = {"\\*File list\n\\Version: 0x07200000\n\\*File list end\n",
                                          "\\*File list\r\r\n\\*File list end\r\r\n", "\\*EC File list\n",
                                          "\\*File list", "\\*File list\r"};
    static const char EMPTY[] = "\\*File list\r\n\\Version: 0x07200000\r\n\\*File list end\r\n";
    assert_parse_fails(FORCE, strlen(FORCE), NULL, DIF_ERR_UNSUPPORTED, "a NanoScope force curve, not an image");
    assert_parse_fails(TEXT, strlen(TEXT), NULL, DIF_ERR_UNSUPPORTED, "samples as text");
    for (size_t i = 0; i < sizeof DAMAGED / sizeof *DAMAGED; i++)
        assert_parse_fails(DAMAGED[i], strlen(DAMAGED[i]), NULL, DIF_ERR_FORMAT,
                           "changed line ends, so its samples are damaged: transfer it again as a binary file");
    assert_parse_fails(EMPTY, strlen(EMPTY) - 8, NULL, DIF_ERR_FORMAT, "header does not end (truncated?)");
    assert_parse_fails(EMPTY, strlen(EMPTY), NULL, DIF_ERR_FORMAT, "a NanoScope file without images");
}

/* Numbers that no file can hold. */
static void test_read__absurd_numbers_are_refused(void **state)
{
    (void)state;
    static const struct {
        const char *line;
        dif_status want;
        const char *text;
    } LINES[] = {
        {"\\Samps/line: 0", DIF_ERR_FORMAT, "0 x 2 samples"},
        {"\\Samps/line: -5", DIF_ERR_FORMAT, "-1 x 2 samples"},
        {"\\Samps/line: 4e9", DIF_ERR_SIZE, "4000000000 x 2 samples, want at most"},
        {"\\Samps/line: 1e15\r\n\\Number of lines: 1e15", DIF_ERR_SIZE, "1000000000000000 x 1000000000000000 samples"},
        {"\\Samps/line: 1e300", DIF_ERR_FORMAT, "-1 x 2 samples"},
        {"\\Number of lines: 1000000000000000", DIF_ERR_SIZE, "3 x 1000000000000000 samples"},
        {"\\Number of lines: 32769", DIF_ERR_SIZE, "3 x 32769 samples"},
        {"\\Data length: 1000000000000000", DIF_ERR_FORMAT, "(truncated or damaged?)"},
        {"\\Data length: -1", DIF_ERR_FORMAT, "(damaged?)"},
        {"\\Data length: 0", DIF_ERR_FORMAT, "0 bytes of samples, want 12 for 3 x 2"},
        {"\\Data offset: 1000000000000000", DIF_ERR_FORMAT, "(truncated or damaged?)"},
        {"\\Data offset: 4097", DIF_ERR_FORMAT, "4108 bytes, but channel 1 goes from byte 4097 to 4109"},
        {"\\Data offset: -4096", DIF_ERR_FORMAT, "(damaged?)"},
        {"\\Data offset: 0", DIF_ERR_FORMAT, "(damaged?)"},
        {"\\Data offset: 100", DIF_ERR_FORMAT, "(damaged?)"}, /* in the header */
        {"\\Bytes/pixel: 3", DIF_ERR_FORMAT, "Bytes/pixel is none of 1, 2, 4"},
        {"\\Bytes/pixel: 1e15", DIF_ERR_FORMAT, "Bytes/pixel is none of 1, 2, 4"},
        {"\\@2:Z scale: V [Sens. Zsens] (0.5 V/LSB) nan V", DIF_ERR_FORMAT, "no channel is known to hold heights"},
        {"\\@2:Z scale: V [Sens. Zsens (0.5 V/LSB 10 V", DIF_ERR_FORMAT, "no channel is known to hold heights"},
    };
    for (size_t i = 0; i < sizeof LINES / sizeof *LINES; i++) {
        nano_file file;
        nano_begin(&file, NANO_MAGIC, "0x07200000");
        nano_line(&file, "\\*Ciao image list");
        nano_line(&file, "%s", LINES[i].line); /* the first of two alike counts */
        file.n_data = 0;
        const size_t at = file.n;
        nano_channel(&file, 2, 2);
        memcpy(file.data + at, "\\X*Ciao image li", 15); /* no section of its own */
        nano_line(&file, "%s", NANO_HEIGHT);
        nano_line(&file, "%s", NANO_SCALE);
        nano_end(&file, 2, NANO_SIX, 6);
        assert_parse_fails(file.data, file.n, NULL, LINES[i].want, LINES[i].text);
    }
}

/* One block that is not there spoils the others: bytes may be missing before them. */
static void test_read__one_truncated_channel_refuses_all(void **state)
{
    (void)state;
    const nano_file file = make_five();
    dif_field_request request = dif_field_request_default();
    request.channel = "1";
    assert_parse_fails(file.data, file.n - 1, &request, DIF_ERR_FORMAT,
                       "4155 bytes, but channel 5 goes from byte 4144 to 4156");
}

static void test_read__many_images_and_a_long_header_are_bounded(void **state)
{
    (void)state;
    enum { N = 400000 };
    static const char BEGIN[] = "\\*File list\r\n", SECTION[] = "\\*Image list\r\n", END[] = "\\*File list end\r\n";
    char *text = malloc(N);
    assert_non_null(text);
    size_t n = strlen(BEGIN);
    memcpy(text, BEGIN, n);
    for (int i = 0; i < 129; i++, n += strlen(SECTION))
        memcpy(text + n, SECTION, strlen(SECTION));
    memcpy(text + n, END, strlen(END));
    assert_parse_fails(text, n + strlen(END), NULL, DIF_ERR_SIZE, "more than 128 images");
    memset(text + n, '\n', N - n);
    memcpy(text + N - strlen(END), END, strlen(END));
    assert_parse_fails(text, N, NULL, DIF_ERR_FORMAT, "header does not end");
    free(text);
}

static void test_parse__every_beginning_is_refused(void **state)
{
    (void)state;
    const nano_file file = make_five();
    assert_int_equal(count_accepted_beginnings(file.data, file.n, NULL), 0);
}

static void test_parse__heap_that_fails_is_reported(void **state)
{
    (void)state;
    const nano_file file = make_five();
    assert_true(parse_with_failing_heap(file.data, file.n, NULL) >= 4); /* a list that grows, and samples */
}

/* Headers of real instruments without their samples, and one that lost bytes in its middle. */
static void test_read__real_headers(void **state)
{
    (void)state;
    static const struct {
        const char *name, *text;
    } FILES[] = {
        {"di_corrupted.di", "489346 bytes, but channel 3 goes from byte 434176 to 565248 (truncated or damaged?)"},
        {"bruker_data_header.000", "changed line ends"},
        {"bruker_data_header.001", "changed line ends"},
        {"bruker_data_header.002", "changed line ends"},
        {"bruker_data_header.003", "changed line ends"},
    };
    const char *data = test_data_folder();
    if (!data)
        skip();
    for (size_t i = 0; i < sizeof FILES / sizeof *FILES; i++) {
        char path[1024];
        size_t n = 0;
        snprintf(path, sizeof path, "%s/afm/%s", data, FILES[i].name);
        unsigned char *bytes = read_whole(path, &n);
        assert_parse_fails(bytes, n, NULL, DIF_ERR_FORMAT, FILES[i].text);
        dif_release(bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_channels__are_listed_with_units_and_the_height_is_chosen),
        cmocka_unit_test(test_read__channel_by_name_alias_and_number),
        cmocka_unit_test(test_read__channel_that_is_no_height),
        cmocka_unit_test(test_read__without_a_height_channel_the_user_names_one),
        cmocka_unit_test(test_read__trace_and_retrace_are_told_apart_by_number),
        cmocka_unit_test(test_read__units_that_do_not_cancel_are_no_heights),
        cmocka_unit_test(test_read__what_is_no_binary_image_is_said_so),
        cmocka_unit_test(test_read__absurd_numbers_are_refused),
        cmocka_unit_test(test_read__one_truncated_channel_refuses_all),
        cmocka_unit_test(test_read__many_images_and_a_long_header_are_bounded),
        cmocka_unit_test(test_parse__every_beginning_is_refused),
        cmocka_unit_test(test_parse__heap_that_fails_is_reported),
        cmocka_unit_test(test_read__real_headers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
