/* Gwyddion itself as the judge, where it is installed: it converts a file to its own format, and every sample of every
 * channel must be what our reader makes of the original. */
/* mkdtemp, setenv */
#define _POSIX_C_SOURCE 200809L

#include "tests/nano_sample.h"
#include "tests/x3p_sample.h"

#include <unistd.h>

static char folder[] = "/tmp/dif-gwyddion-XXXXXX";

static bool has_gwyddion(void)
{
    const bool is_here = system("command -v gwyddion >/dev/null 2>&1") == 0;
    if (!is_here)
        print_message("gwyddion is not installed: skipping\n");
    return is_here;
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) && setenv("HOME", folder, 1) == 0 ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    char command[100];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return system(command) == 0 ? 0 : -1;
}

/* Converts a file; the result is at the path `out`. */
static bool convert(const char *path, char out[100])
{
    char command[1300];
    snprintf(out, 100, "%s/out.gwy", folder);
    remove(out);
    snprintf(command, sizeof command, "gwyddion --convert-to-gwy='%s' '%s' >/dev/null 2>&1", out, path);
    return system(command) == 0 && access(out, R_OK) == 0;
}

/* Reads the i-th channel as heights whatever its unit; 1 um between samples where the file says nothing. */
static void read_any(const char *path, const dif_channels *channels, int i, dif_field_file *out)
{
    char number[16];
    dif_error err;
    dif_field_request request = dif_field_request_default();
    snprintf(number, sizeof number, "%d", i + 1);
    request.channel = number;
    request.allow_missing = true;
    if (!channels->channel[i].is_height)
        request.z_unit = "m";
    if (dif_field_read(path, &request, out, &err) == DIF_OK)
        return;
    request.pixel_um = 1.0;
    if (dif_field_read(path, &request, out, &err))
        fail_msg("%s", err.text);
}

static void expect_same_channel(const dif_field_file *got, const dif_field_file *want)
{
    const dif_field *a = &got->field, *b = &want->field;
    assert_int_equal(a->nx, b->nx);
    assert_int_equal(a->ny, b->ny);
    assert_near(a->pitch_x_um, b->pitch_x_um, 1e-15, 0.0);
    assert_near(a->pitch_y_um, b->pitch_y_um, 1e-15, 0.0);
    double largest_um = 0.0;
    for (size_t i = 0; i < dif_field_n(a); i++)
        largest_um = isnan(a->z_um[i]) ? largest_um : fmax(largest_um, fabs(a->z_um[i]));
    for (size_t i = 0; i < dif_field_n(a); i++) {
        if (isnan(a->z_um[i])) /* Gwyddion puts other values where points are missing */
            continue;
        /* up to four products in another order, and an offset that may take most of a height away */
        assert_near(a->z_um[i], b->z_um[i], 8.0 * 2.3e-16, 2.3e-16 * largest_um);
    }
}

/* Every channel of a file, in the order of both. */
static void expect_same(const char *path)
{
    char out[100];
    dif_channels mine, theirs;
    dif_error err;
    assert_true(convert(path, out));
    if (dif_field_channels(path, &mine, &err))
        fail_msg("%s", err.text);
    if (dif_field_channels(out, &theirs, &err))
        fail_msg("%s", err.text);
    assert_int_equal(mine.n, theirs.n);
    for (int i = 0; i < mine.n; i++) {
        dif_field_file got, want;
        if (mine.channel[i].name[0] && strcmp(theirs.channel[i].name, "Topography") != 0) /* its word for no name */
            assert_string_equal(mine.channel[i].name, theirs.channel[i].name);
        assert_int_equal(mine.channel[i].is_height, theirs.channel[i].is_height);
        read_any(path, &mine, i, &got);
        read_any(out, &theirs, i, &want);
        expect_same_channel(&got, &want);
        dif_field_file_free(&got);
        dif_field_file_free(&want);
    }
    print_message("%s: %d channel%s as Gwyddion has them\n", path, mine.n, mine.n == 1 ? "" : "s");
    dif_channels_free(&mine);
    dif_channels_free(&theirs);
}

static void test_read__files_of_instruments(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"di-1.di",
                                        "di-3.di",
                                        "jmarini_full_multiple_images.spm",
                                        "GwiddionReader_chip.gsf",
                                        "bipm_grating.gsf",
                                        "tuxu_test.gwy",
                                        "sdf-1.sdf",
                                        "synthetic/t_BCR_5.sdf",
                                        "synthetic/t_ISO_6.sdf",
                                        "synthetic/t_ISO_7.sdf",
                                        "synthetic/t_ISO_txt.sdf",
                                        "synthetic/t_ISO_5.sdf",
                                        "synthetic/t_gwykeys.png",
                                        "x3p/testing.x3p",
                                        "x3p/pyramid.x3p"};
    const char *data = test_data_folder();
    if (!data || !has_gwyddion())
        skip();
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/afm/%s", data, NAMES[i]);
        expect_same(path);
    }
}

static void save_and_expect(const nano_file *file, const char *name)
{
    char path[100];
    dif_error err;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(dif_file_write(path, file->data, file->n, &err), DIF_OK);
    expect_same(path);
}

/* What no public file has. */
static void test_read__synthetic_nanoscope(void **state)
{
    (void)state;
    static const long BIG[] = {-2147483647L - 1, 2147483647L, 70000, -70000, 1, 0};
    if (!has_gwyddion())
        skip();
    nano_file file;
    for (int bytes_pixel = 2; bytes_pixel <= 4; bytes_pixel += 2) {
        nano_begin(&file, NANO_MAGIC, "0x09700105");
        nano_channel(&file, 4, bytes_pixel);
        nano_line(&file, "%s", NANO_HEIGHT);
        nano_line(&file, "%s", NANO_SCALE);
        nano_end(&file, 4, BIG, 6);
        save_and_expect(&file, bytes_pixel == 2 ? "four-two.spm" : "four-four.spm");
    }
    file = nano_make("0x05120000", NANO_SCALE);
    save_and_expect(&file, "plain.000");
    file = nano_make("0x08150300", "\\@2:Z scale: V [Sens. ZsensSens] (0.0001 V/LSB) 10.00000 V");
    save_and_expect(&file, "sensor.spm");
    file = nano_make("0x04220200", "\\Z scale: 250.0 nm (0.1 nm/LSB)");
    save_and_expect(&file, "old.001");
    nano_begin(&file, "\\*EC File list", "0x05120000");
    nano_channel(&file, 2, 2);
    nano_line(&file, "%s", NANO_HEIGHT);
    nano_line(&file, "%s", NANO_SCALE);
    nano_end(&file, 2, NANO_SIX, 6);
    save_and_expect(&file, "electro.spm");
}

static void save_x3p(const x3p_head *head, const x3p_file *more, const char *name)
{
    char path[100];
    dif_error err;
    const zip_bytes x3p = x3p_make(head, more);
    snprintf(path, sizeof path, "%s/%s", folder, name);
    assert_int_equal(dif_file_write(path, x3p.data, x3p.n, &err), DIF_OK);
    free(x3p.data);
    expect_same(path);
}

static void test_read__synthetic_x3p(void **state)
{
    (void)state;
    static const int16_t SHORT[12] = {1, -2, 3, 4, 5, -32768, 7, 8, 9, 10, 11, 32767};
    const x3p_file doubles[] = {{"bindata/data.bin", X3P_SIX, sizeof X3P_SIX}, {"bindata/v", "\x35", 1}, {0}};
    const x3p_file shorts[] = {{"bindata/data.bin", SHORT, sizeof SHORT}, {0}}, none[] = {{0}};
    if (!has_gwyddion())
        skip();
    x3p_head head = x3p_head_make();
    head.z_scale = "<Increment>2e-9</Increment><Offset>1e-6</Offset>";
    save_x3p(&head, doubles, "scaled.x3p");
    head.type = "I";
    head.size = "<SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>2</SizeZ>";
    save_x3p(&head, shorts, "layers.x3p");
    head = x3p_head_make();
    head.revision = "ISO5436 \xe2\x80\x93 2000";
    head.data = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><ValidPointsLink>bindata/v</ValidPointsLink>"
                "</DataLink>";
    save_x3p(&head, doubles, "valid.x3p");
    head.data = "<DataList><Datum>0;0;1</Datum><Datum>1;0;2</Datum><Datum></Datum><Datum>4</Datum><Datum>5</Datum>"
                "<Datum>6</Datum></DataList>";
    save_x3p(&head, none, "list.x3p");
}

/* The other way round: what we write is there what it is here. */
static void test_write__opens_with_scale_and_heights(void **state)
{
    (void)state;
    static const char *const NAMES[] = {"written.png", "written.gsf"};
    uint64_t seed = 11;
    dif_field field;
    dif_manifest manifest = {0};
    dif_error err;
    if (!has_gwyddion())
        skip();
    assert_int_equal(dif_manifest_set(&manifest, "command", "diffbench convert", &err), DIF_OK);
    assert_int_equal(dif_field_create(31, 17, 0.0488, 0.061, &field, &err), DIF_OK);
    for (size_t i = 0; i < dif_field_n(&field); i++)
        field.z_um[i] = test_random(&seed, -0.2, 0.3);
    for (int i = 0; i < 2; i++) {
        char path[100], out[100];
        dif_field_file file;
        snprintf(path, sizeof path, "%s/%s", folder, NAMES[i]);
        assert_int_equal(dif_field_write(path, &field, &manifest, &err), DIF_OK);
        assert_true(convert(path, out));
        assert_int_equal(dif_field_read(out, NULL, &file, &err), DIF_OK);
        assert_string_equal(file.title, "height");
        assert_near(file.field.pitch_x_um, field.pitch_x_um, 1e-15, 0.0);
        assert_near(file.field.pitch_y_um, field.pitch_y_um, 1e-15, 0.0);
        const double allowed_um = 0.501 * dif_field_loss_of(path, &field).step_um; /* half a step, and roundings */
        for (size_t k = 0; k < dif_field_n(&field); k++)
            assert_near(file.field.z_um[k], field.z_um[k], 0.0, allowed_um);
        dif_field_file_free(&file);
    }
    dif_manifest_free(&manifest);
    dif_field_free(&field);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__files_of_instruments),
        cmocka_unit_test(test_read__synthetic_nanoscope),
        cmocka_unit_test(test_read__synthetic_x3p),
        cmocka_unit_test(test_write__opens_with_scale_and_heights),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
