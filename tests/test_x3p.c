/* x3p surfaces: what main.xml may say and what the archive may hold. */
#include "tests/io_cases.h"
#include "tests/x3p_sample.h"

static const x3p_file DOUBLES[] = {{"bindata/data.bin", X3P_SIX, sizeof X3P_SIX}, {0}};

/* Reads 3 x 2 heights 1 ... 6 times unit plus offset, those in `missing` (bits) as NaN; the caller looks at the rest. */
static dif_field_file read_six(zip_bytes x3p, double unit_um, double offset_um, unsigned missing)
{
    dif_field_file file;
    dif_error err;
    dif_field_request request = dif_field_request_default();
    request.allow_missing = missing != 0;
    const dif_status status = parse_bytes(x3p.data, x3p.n, &request, &file, &err);
    free(x3p.data);
    if (status)
        fail_msg("%s", err.text);
    assert_string_equal(file.format, "x3p");
    assert_int_equal(file.field.nx, 3);
    assert_int_equal(file.field.ny, 2);
    assert_near(file.field.pitch_x_um, 2.0, 4e-16, 0.0);
    assert_near(file.field.pitch_y_um, 1.0, 4e-16, 0.0);
    for (int i = 0; i < 6; i++) {
        if (missing >> i & 1)
            assert_true(isnan(file.field.z_um[i]));
        else
            assert_near(file.field.z_um[i], offset_um + unit_um * (i + 1), 4e-16, 0.0); /* row 0 at the top */
    }
    return file;
}

static void expect_six(zip_bytes x3p, double unit_um, double offset_um, unsigned missing, const char *warning)
{
    dif_field_file file = read_six(x3p, unit_um, offset_um, missing);
    assert_string_equal(file.warning, warning);
    dif_field_file_free(&file);
}

static void expect_fails(zip_bytes x3p, dif_status want, const char *part)
{
    assert_parse_fails(x3p.data, x3p.n, NULL, want, part);
    free(x3p.data);
}

static void test_read__revisions_prefixes_and_encodings(void **state)
{
    (void)state;
    static const char *const REVISIONS[] = {"ISO5436 - 2000", "ISO5436 \xe2\x80\x93 2000", "\n  ISO5436 - 2000\t"};
    static const char *const PREFIXES[] = {"p:", "", "opengps:"};
    for (int i = 0; i < 3; i++) {
        x3p_head head = x3p_head_make();
        head.revision = REVISIONS[i];
        head.prefix = PREFIXES[i];
        expect_six(x3p_make(&head, DOUBLES), 1e6, 0.0, 0, "");
    }
    x3p_head head = x3p_head_make();
    head.before = "<?xml version=\"1.0\" encoding=\"ISO-8859-1\"?><!-- \xe4 -->";
    head.revision = "ISO5436 - 2000";
    expect_six(x3p_make(&head, DOUBLES), 1e6, 0.0, 0, "");
    head = x3p_head_make();
    head.revision = "something else";
    expect_six(x3p_make(&head, DOUBLES), 1e6, 0.0, 0, "main.xml names no revision of ISO5436");
}

static void test_read__every_type_with_increment_and_offset(void **state)
{
    (void)state;
    static const int16_t I[6] = {1, 2, 3, 4, 5, 6};
    static const int32_t L[6] = {1, 2, 3, 4, 5, 6};
    static const float F[6] = {1, 2, 3, 4, 5, 6};
    const struct {
        const char *type, *warning;
        const void *data;
        size_t n;
    } types[] = {{"I", "", I, sizeof I},
                 {"L", "", L, sizeof L},
                 {"F", "floating-point heights are times the file's Increment of 1e-09", F, sizeof F},
                 {"D", "floating-point heights are times the file's Increment of 1e-09", X3P_SIX, sizeof X3P_SIX}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        const x3p_file files[] = {{"bindata/data.bin", types[i].data, types[i].n}, {0}};
        x3p_head head = x3p_head_make();
        head.type = types[i].type;
        head.z_scale = "<Increment>1e-9</Increment><Offset>-2e-6</Offset>";
        expect_six(x3p_make(&head, files), 1e-3, -2.0, 0, types[i].warning);
        head.z_scale = "<Increment>1</Increment><Offset></Offset>";
        expect_six(x3p_make(&head, files), 1e6, 0.0, 0, "");
        head.z_scale = "";
        expect_six(x3p_make(&head, files), 1e6, 0.0, 0, "");
    }
}

static void test_read__paths_of_every_kind(void **state)
{
    (void)state;
    x3p_head head = x3p_head_make();
    expect_six(x3p_make_in("a folder/", &head, DOUBLES), 1e6, 0.0, 0, "");
    expect_six(x3p_make_in("a/b/", &head, DOUBLES), 1e6, 0.0, 0, "");
    static const char *const LINKS[] = {"bindata\\data.bin", "./bindata/data.bin", "/bindata/data.bin",
                                        "BinData/DATA.BIN"};
    for (int i = 0; i < 4; i++) {
        char data[200];
        snprintf(data, sizeof data, "<DataLink><PointDataLink>%s</PointDataLink></DataLink>", LINKS[i]);
        head.data = data;
        expect_six(x3p_make(&head, DOUBLES), 1e6, 0.0, 0, "");
    }
    head = x3p_head_make();
    const x3p_file decoy[] = {DOUBLES[0], {"notes/main.xml", "<no/>", 5}, {0}};
    expect_six(x3p_make(&head, decoy), 1e6, 0.0, 0, ""); /* the shortest path wins */
}

static void test_read__lists_of_points(void **state)
{
    (void)state;
    x3p_head head = x3p_head_make();
    const x3p_file none[] = {{0}};
    head.data = "<DataList><Datum>1</Datum><Datum> 2.0 </Datum><Datum>3e0</Datum><Datum>4</Datum><Datum>5</Datum>"
                "<Datum>6</Datum></DataList>";
    expect_six(x3p_make(&head, none), 1e6, 0.0, 0, "");
    head.type = "";
    head.data = "<DataList><Datum>0;0;1</Datum><Datum>1;0;2</Datum><Datum/><Datum>0;1;4</Datum><Datum>1;1;</Datum>"
                "<Datum>2;1;6</Datum></DataList>";
    expect_six(x3p_make(&head, none), 1e6, 0.0, 1 << 2 | 1 << 4, "");
    expect_fails(x3p_make(&head, none), DIF_ERR_NONFINITE, "height at column 2, row 0 is nan");
    head.data = "<DataList><Datum>1</Datum><Datum>2</Datum></DataList>";
    expect_fails(x3p_make(&head, none), DIF_ERR_FORMAT, "2 points in main.xml, want 6 for 3 x 2 x 1");
    head.data = "<DataList><Datum>1</Datum><Datum>2;x</Datum></DataList>";
    expect_fails(x3p_make(&head, none), DIF_ERR_FORMAT, "point 2 is '2;x', want numbers");
    head.data = "<DataList><Datum>1</Datum><Datum>2</Datum><Datum>3</Datum><Datum>4</Datum><Datum>5</Datum><Datum>6"
                "</Datum><Datum>7</Datum></DataList>";
    expect_fails(x3p_make(&head, none), DIF_ERR_FORMAT, "more points in the list than SizeX SizeY SizeZ = 6");
    head.data = "";
    expect_fails(x3p_make(&head, none), DIF_ERR_FORMAT, "0 points in main.xml, want 6");
}

static void test_read__bitmap_of_valid_points(void **state)
{
    (void)state;
    x3p_head head = x3p_head_make();
    head.data = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><ValidPointsLink>bindata/valid.bin"
                "</ValidPointsLink></DataLink>";
    const x3p_file files[] = {DOUBLES[0], {"bindata/valid.bin", "\x35", 1}, {0}}; /* 110101: bit 0 is the first point */
    expect_six(x3p_make(&head, files), 1e6, 0.0, 1 << 1 | 1 << 3, "");
    expect_fails(x3p_make(&head, files), DIF_ERR_NONFINITE, "--fill");
    const x3p_file longer[] = {DOUBLES[0], {"bindata/valid.bin", "\x35\0\0", 4}, {0}};
    expect_six(x3p_make(&head, longer), 1e6, 0.0, 1 << 1 | 1 << 3, "");
    const x3p_file empty[] = {DOUBLES[0], {"bindata/valid.bin", "", 0}, {0}};
    expect_fails(x3p_make(&head, empty), DIF_ERR_FORMAT, "0 bytes of valid points, want 1 for 3 x 2 x 1");
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "refers to 'bindata/valid.bin', which is not in");
}

static void test_read__layers_are_channels(void **state)
{
    (void)state;
    static const double TWELVE[12] = {1, 2, 3, 4, 5, 6, 10, 20, 30, 40, 50, 60};
    const x3p_file files[] = {{"bindata/data.bin", TWELVE, sizeof TWELVE}, {"bindata/v", "\xff\x0e", 2}, {0}};
    x3p_head head = x3p_head_make();
    head.size = "<SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>2</SizeZ>";
    head.data = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><ValidPointsLink>bindata/v"
                "</ValidPointsLink></DataLink>";
    const zip_bytes x3p = x3p_make(&head, files);
    dif_channels channels;
    dif_field_file file;
    dif_error err;
    assert_int_equal(dif_field_channels_parse(x3p.data, x3p.n, "f", &channels, &err), DIF_OK);
    assert_int_equal(channels.n, 2);
    assert_string_equal(channels.channel[1].name, "layer 2");
    assert_true(channels.channel[1].is_height && channels.preferred == 0);
    dif_channels_free(&channels);
    dif_field_request request = dif_field_request_default();
    request.channel = "2";
    request.allow_missing = true;
    assert_int_equal(parse_bytes(x3p.data, x3p.n, &request, &file, &err), DIF_OK);
    assert_string_equal(file.title, "layer 2");
    assert_near(file.field.z_um[0], 10e6, 4e-16, 0.0);
    assert_true(isnan(file.field.z_um[2]) && isnan(file.field.z_um[1]) == 0); /* bits 8, 12 ... of the bitmap */
    dif_field_file_free(&file);
    expect_six(x3p, 1e6, 0.0, 0, "");
}

static void test_read__wrong_check_sums_are_warnings(void **state)
{
    (void)state;
    char xml[X3P_XML];
    x3p_head head = x3p_head_make();
    head.data = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><MD5ChecksumPointData>"
                "0123456789abcdef0123456789ABCDEF</MD5ChecksumPointData></DataLink>";
    expect_six(x3p_make(&head, DOUBLES), 1e6, 0.0, 0, "wrong MD5 check sum of the samples");
    head = x3p_head_make();
    const x3p_file files[] = {{"main.xml", xml, (size_t)x3p_xml(&head, xml)},
                              {"md5checksum.hex", "d41d8cd98f00b204e9800998ecf8427e *main.xml", 43},
                              DOUBLES[0],
                              {0}};
    expect_six(zip_make(files, ZIP_CM_STORE), 1e6, 0.0, 0, "wrong MD5 check sum of main.xml");
    const x3p_file none[] = {files[0], DOUBLES[0], {0}};
    expect_six(zip_make(none, ZIP_CM_STORE), 1e6, 0.0, 0, "");
    char sum[33], data[300];
    dif_md5 md5 = dif_md5_begin();
    dif_md5_add(&md5, X3P_SIX, sizeof X3P_SIX);
    dif_md5_hex(&md5, sum);
    for (char *c = sum; *c; c++)
        *c = (char)(*c >= 'a' ? *c - 32 : *c);
    snprintf(data, sizeof data,
             "<DataLink><PointDataLink>bindata/data.bin</PointDataLink><MD5ChecksumPointData>%s"
             "</MD5ChecksumPointData></DataLink>",
             sum);
    head.data = data;
    expect_six(x3p_make(&head, DOUBLES), 1e6, 0.0, 0, "");
}

static void test_read__refuses_what_is_no_matrix_of_heights(void **state)
{
    (void)state;
    x3p_head head = x3p_head_make();
    head.feature = "PRF";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_UNSUPPORTED, "x3p with FeatureType PRF, want SUR (a surface)");
    head.feature = "PCL";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_UNSUPPORTED, "x3p with FeatureType PCL");
    head = x3p_head_make();
    head.x_axis = "A";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_UNSUPPORTED, "x3p with AxisType A along x, want I (equal steps)");
    head = x3p_head_make();
    head.y_axis = "A";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_UNSUPPORTED, "x3p with AxisType A along y");
    head = x3p_head_make();
    head.z_axis = "I";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_UNSUPPORTED, "x3p with AxisType I along z, want A (heights)");
    head = x3p_head_make();
    head.type = "X";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "the DataType of z is 'X', want I, L, F or D");
    head = x3p_head_make();
    head.x_step = "<Increment>-1e-6</Increment>";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "the increment along x is -1e-06 m, want > 0");
    head.x_step = "<Increment>wide</Increment>";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "Record1/Axes/CX/Increment is 'wide', want a finite number");
    head.x_step = "<Increment>inf</Increment>";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "Record1/Axes/CX/Increment is 'inf'");
    static const char *const NONE[] = {"", "<Increment>0</Increment>", "<Increment></Increment>"};
    for (int i = 0; i < 3; i++) {
        head.x_step = NONE[i];
        expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_SCALE, "give --pixel-nm or --size-um");
    }
    head = x3p_head_make();
    head.z_scale = "<Increment>0</Increment>";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_SCALE, "give --z-unit (nm, um, m)");
}

static void test_read__refuses_sizes_that_do_not_fit(void **state)
{
    (void)state;
    static const struct {
        const char *size, *part;
        dif_status status;
    } CASES[] = {
        {"<SizeY>2</SizeY>", "no SizeX in main.xml", DIF_ERR_FORMAT},
        {"<SizeX>3</SizeX>", "no SizeY in main.xml", DIF_ERR_FORMAT},
        {"<SizeX>0</SizeX><SizeY>2</SizeY>", "SizeX is 0, want a whole number >= 1", DIF_ERR_FORMAT},
        {"<SizeX>2.5</SizeX><SizeY>2</SizeY>", "SizeX is 2.5, want a whole number >= 1", DIF_ERR_FORMAT},
        {"<SizeX>-3</SizeX><SizeY>2</SizeY>", "SizeX is -3", DIF_ERR_FORMAT},
        {"<SizeX>3</SizeX><SizeY>32769</SizeY>", "SizeY is 32769, want at most 32768", DIF_ERR_SIZE},
        {"<SizeX>1e300</SizeX><SizeY>2</SizeY>", "SizeX is 1e+300", DIF_ERR_SIZE},
        {"<SizeX>4294967299</SizeX><SizeY>4294967298</SizeY>", "SizeX is 4.29497e+09", DIF_ERR_SIZE},
        {"<SizeX>32768</SizeX><SizeY>32768</SizeY>", "want at most 268435456 together", DIF_ERR_SIZE},
        {"<SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1000000</SizeZ>", "SizeZ is 1e+06, want at most 1024", DIF_ERR_SIZE},
        {"<SizeX>3</SizeX><SizeY>3</SizeY>", "48 bytes of samples, want 72 for 3 x 3 x 1 of type D", DIF_ERR_FORMAT},
        {"<SizeX>1</SizeX><SizeY>2</SizeY>", "48 bytes of samples, want 16", DIF_ERR_FORMAT},
        {"<SizeX>16384</SizeX><SizeY>16384</SizeY><SizeZ>1024</SizeZ>", "48 bytes of samples, want 2199023255552",
         DIF_ERR_FORMAT},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        x3p_head head = x3p_head_make();
        head.size = CASES[i].size;
        expect_fails(x3p_make(&head, DOUBLES), CASES[i].status, CASES[i].part);
    }
}

static void test_read__refuses_archives_of_something_else(void **state)
{
    (void)state;
    const x3p_file other[] = {{"word/document.xml", "<x/>", 4}, {"main.xml.bak", "<x/>", 4}, {0}};
    expect_fails(zip_make(other, ZIP_CM_DEFLATE), DIF_ERR_FORMAT, "a zip archive without main.xml: not an x3p surface");
    x3p_head head = x3p_head_make();
    const x3p_file none[] = {{0}};
    expect_fails(x3p_make(&head, none), DIF_ERR_FORMAT, "main.xml refers to 'bindata/data.bin', which is not in the");
    assert_parse_fails("PK\x03\x04", 4, NULL, DIF_ERR_FORMAT, "damaged zip archive (truncated?)");
}

static void test_read__every_beginning_is_refused(void **state)
{
    (void)state;
    x3p_head head = x3p_head_make();
    const zip_bytes x3p = x3p_make(&head, DOUBLES);
    assert_int_equal(count_accepted_beginnings(x3p.data, x3p.n, NULL), 0);
    free(x3p.data);
}

/* Every byte changed in two ways: read or refused, never past an end. The samples are stored, so zip's sums see them. */
static void test_read__damaged_bytes_are_read_or_refused(void **state)
{
    (void)state;
    x3p_head head = x3p_head_make();
    const zip_bytes x3p = x3p_make(&head, DOUBLES);
    int n_refused = 0;
    for (size_t i = 0; i < 2 * x3p.n; i++) {
        dif_field_file file;
        dif_error err;
        const unsigned char change = i % 2 ? 0xff : 0x01;
        x3p.data[i / 2] ^= change;
        const dif_status status = parse_bytes(x3p.data, x3p.n, NULL, &file, &err);
        assert_true(status || file.field.nx == 3);
        n_refused += status != DIF_OK;
        dif_field_file_free(&file);
        x3p.data[i / 2] ^= change;
    }
    assert_true(n_refused > 100); /* most of what is neither a time nor an attribute matters */
    free(x3p.data);
}

static void test_read__failing_heap_is_said(void **state)
{
    (void)state;
    x3p_head head = x3p_head_make();
    zip_bytes x3p = x3p_make(&head, DOUBLES);
    assert_true(parse_with_failing_heap(x3p.data, x3p.n, NULL) >= 10); /* expat's blocks are among them */
    free(x3p.data);
    const x3p_file none[] = {{0}};
    head.data = "<DataList><Datum>1</Datum><Datum>2</Datum><Datum>3</Datum><Datum>4</Datum><Datum>5</Datum><Datum>6"
                "</Datum></DataList>";
    x3p = x3p_make(&head, none);
    assert_true(parse_with_failing_heap(x3p.data, x3p.n, NULL) >= 10);
    free(x3p.data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__revisions_prefixes_and_encodings),
        cmocka_unit_test(test_read__every_type_with_increment_and_offset),
        cmocka_unit_test(test_read__paths_of_every_kind),
        cmocka_unit_test(test_read__lists_of_points),
        cmocka_unit_test(test_read__bitmap_of_valid_points),
        cmocka_unit_test(test_read__layers_are_channels),
        cmocka_unit_test(test_read__wrong_check_sums_are_warnings),
        cmocka_unit_test(test_read__refuses_what_is_no_matrix_of_heights),
        cmocka_unit_test(test_read__refuses_sizes_that_do_not_fit),
        cmocka_unit_test(test_read__refuses_archives_of_something_else),
        cmocka_unit_test(test_read__every_beginning_is_refused),
        cmocka_unit_test(test_read__damaged_bytes_are_read_or_refused),
        cmocka_unit_test(test_read__failing_heap_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
