/* SDF surfaces, binary and text. */
#include "tests/io_cases.h"

#include <stdint.h>

typedef struct bytes {
    unsigned char data[1024];
    size_t n;
} bytes;

static void put(bytes *file, uint64_t value, int n)
{
    for (int i = 0; i < n; i++)
        file->data[file->n++] = (unsigned char)(value >> 8 * i);
}

static void put_double(bytes *file, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put(file, bits, 8);
}

typedef struct sdf_head {
    const char *magic;
    int nx, ny;
    double x_scale, y_scale, z_scale;
    int compression, type, checksum;
} sdf_head;

static const sdf_head GOOD = {"bISO-1.0", 3, 2, 2e-6, 1e-6, 1e-9, 0, 5, 0};

/* The header, 81 bytes, without samples. */
static bytes binary(const sdf_head *head)
{
    bytes file = {.n = 0};
    memcpy(file.data, head->magic, 8);
    memcpy(file.data + 8, "diffbench ", 10);
    memcpy(file.data + 18, "231120261200231120261200", 24);
    file.n = 42;
    put(&file, (uint64_t)head->nx, 2);
    put(&file, (uint64_t)head->ny, 2);
    put_double(&file, head->x_scale);
    put_double(&file, head->y_scale);
    put_double(&file, head->z_scale);
    put_double(&file, -1.0);
    put(&file, (uint64_t)head->compression, 1);
    put(&file, (uint64_t)head->type, 1);
    put(&file, (uint64_t)head->checksum, 1);
    assert_int_equal(file.n, 81);
    return file;
}

/* Samples 1 to 6 in the type of the header. */
static bytes with_samples(const sdf_head *head)
{
    static const int SIZES[] = {1, 2, 4, 4, 1, 2, 4, 8};
    bytes file = binary(head);
    for (int i = 1; i <= 6; i++) {
        const float single = (float)i;
        uint32_t bits;
        memcpy(&bits, &single, sizeof bits);
        if (head->type == 7)
            put_double(&file, i);
        else
            put(&file, head->type == 3 ? bits : (uint64_t)i, SIZES[head->type]);
    }
    return file;
}

static void expect_field(const void *data, size_t n)
{
    dif_field_file file;
    dif_error err;
    if (parse_bytes(data, n, NULL, &file, &err))
        fail_msg("%s", err.text);
    assert_string_equal(file.format, "sdf");
    assert_string_equal(file.warning, "");
    assert_int_equal(file.field.nx, 3);
    assert_int_equal(file.field.ny, 2);
    assert_near(file.field.pitch_x_um, 2.0, 4e-16, 0.0);
    assert_near(file.field.pitch_y_um, 1.0, 4e-16, 0.0);
    for (int i = 0; i < 6; i++)
        assert_near(file.field.z_um[i], 1e-3 * (i + 1), 4e-16, 0.0); /* first profile at the top */
    dif_field_file_free(&file);
}

static void test_read__every_binary_type_and_magic(void **state)
{
    (void)state;
    for (int type = 0; type < 8; type++) {
        sdf_head head = GOOD;
        head.type = type;
        head.magic = type % 2 ? "bBCR-1.0" : "bISO-1.0";
        bytes file = with_samples(&head);
        expect_field(file.data, file.n);
        memcpy(file.data + file.n, "remarks", 7); /* a trailer may follow */
        expect_field(file.data, file.n + 7);
    }
}

static const char TEXT_HEAD[] = "aISO-1.0\r\nManufacID = diffbench\r\nCreateDate = 231120261200\r\nModDate = "
                                "231120261200\r\nNumPoints = 3\r\nNumProfiles = 2\r\nXscale = 2.0E-6\r\nYscale = "
                                "1e-6\r\nZscale = 1.0e-009\r\nZresolution = -1\r\nCompression = 0\r\nDataType = "
                                "7\r\nCheckType = 0\r\n; a remark\r\nNumDataSet = 1\r\nNanPresent = 0\r\n*\r\n";

static void test_read__text_form_with_remarks_and_trailer(void **state)
{
    (void)state;
    static const char *const NUMBERS[] = {
        "1 2 3\r\n4 5 6\r\n*\r\n< PartName > x < / PartName >\r\n*\r\n",
        "1\t2.0\n3 4\n\n5 6.000",
        "1 2 3 ; remark 9 9\n4 5 6 *",
        "1 2 3 4 5 6\n*",
    };
    static const char *const MAGICS[] = {"aISO-1.0", "aBCR-1.0", "aBCR-0.0"};
    for (size_t i = 0; i < sizeof NUMBERS / sizeof *NUMBERS; i++) {
        for (size_t k = 0; k < 3; k++) {
            char text[800];
            const size_t n = (size_t)snprintf(text, sizeof text, "%s%s%s", MAGICS[k], TEXT_HEAD + 8, NUMBERS[i]);
            expect_field(text, n);
        }
    }
    static const char SMALL[] =
        "aBCR-1.0\nnumpoints=3\nNUMPROFILES=2\nxscale=2e-6\nyscale=1e-6\nzscale=1e-9\n*\n1 2 3 4 5 6\n*";
    expect_field(SMALL, sizeof SMALL - 1); /* order, case and the rest are free */
}

static void expect_missing(const void *data, size_t n, int at)
{
    dif_field_request request = dif_field_request_default();
    dif_field_file file;
    dif_error err;
    assert_parse_fails(data, n, &request, DIF_ERR_NONFINITE, "--fill");
    request.allow_missing = true;
    assert_int_equal(parse_bytes(data, n, &request, &file, &err), DIF_OK);
    for (int i = 0; i < 6; i++) {
        if (i == at)
            assert_true(isnan(file.field.z_um[i]));
        else
            assert_near(file.field.z_um[i], 1e-3 * (i + 1), 4e-16, 0.0);
    }
    dif_field_file_free(&file);
}

static void test_read__missing_points(void **state)
{
    (void)state;
    static const struct {
        int type, size;
        unsigned char bytes[8];
    } MARKS[] = {
        {5, 2, {0, 0x80}}, {6, 4, {0, 0, 0, 0x80}}, {3, 4, {0, 0, 0xc0, 0x7f}}, {7, 8, {0, 0, 0, 0, 0, 0, 0xf8, 0x7f}}};
    for (size_t i = 0; i < sizeof MARKS / sizeof *MARKS; i++) {
        sdf_head head = GOOD;
        head.type = MARKS[i].type;
        bytes file = with_samples(&head);
        memcpy(file.data + 81 + 4 * (size_t)MARKS[i].size, MARKS[i].bytes, (size_t)MARKS[i].size);
        expect_missing(file.data, file.n, 4);
    }
    char text[800];
    const size_t n = (size_t)snprintf(text, sizeof text, "%s1 2 3\n4 BAD 6\n*\n", TEXT_HEAD);
    expect_missing(text, n, 4);
}

static void expect_head(const sdf_head *head, dif_status want, const char *part)
{
    const bytes file = with_samples(head);
    assert_parse_fails(file.data, file.n, NULL, want, part);
}

static void test_read__refuses_bad_binary_headers(void **state)
{
    (void)state;
    sdf_head head = GOOD;
    head.compression = 1;
    expect_head(&head, DIF_ERR_UNSUPPORTED, "SDF with compression 1, want 0 (none)");
    head = GOOD;
    head.checksum = 2;
    expect_head(&head, DIF_ERR_UNSUPPORTED, "SDF with check sum of kind 2, want 0 (none)");
    head = GOOD;
    head.nx = 0;
    expect_head(&head, DIF_ERR_FORMAT, "0 x 2 samples, want at least 1 x 1");
    head.nx = 65535;
    expect_head(&head, DIF_ERR_SIZE, "65535 x 2 samples, want at most 32768 a side");
    head.nx = head.ny = 32768;
    expect_head(&head, DIF_ERR_SIZE, "want at most 268435456 together");
    head.nx = 4;
    head.ny = 2;
    expect_head(&head, DIF_ERR_FORMAT, "12 bytes of samples, want 16 for 4 x 2 (truncated?)");
    head = GOOD;
    head.x_scale = -1e-6;
    expect_head(&head, DIF_ERR_FORMAT, "Xscale, Yscale are -1e-06, 1e-06 m, want > 0");
    bytes file = with_samples(&GOOD);
    file.data[79] = 8;
    assert_parse_fails(file.data, file.n, NULL, DIF_ERR_FORMAT, "SDF with DataType 8, want 0 to 7");
}

static void test_read__a_scale_of_zero_names_the_flag(void **state)
{
    (void)state;
    const double none[] = {0.0, NAN, INFINITY};
    for (int i = 0; i < 3; i++) {
        sdf_head head = GOOD;
        head.y_scale = none[i];
        expect_head(&head, DIF_ERR_SCALE, "give --pixel-nm or --size-um");
        head.y_scale = 1e-6;
        head.z_scale = none[i];
        expect_head(&head, DIF_ERR_SCALE, "give --z-unit (nm, um, m)");
    }
}

static void expect_text(const char *from, const char *to, const char *numbers, dif_status want, const char *part)
{
    char text[800];
    const char *at = strstr(TEXT_HEAD, from);
    assert_non_null(at);
    const int n =
        snprintf(text, sizeof text, "%.*s%s%s%s", (int)(at - TEXT_HEAD), TEXT_HEAD, to, at + strlen(from), numbers);
    assert_parse_fails(text, (size_t)n, NULL, want, part);
}

static void test_read__refuses_bad_texts(void **state)
{
    (void)state;
    expect_text("NumPoints", "NumPints", "1 2 3 4 5 6", DIF_ERR_FORMAT, "no NumPoints in the SDF header");
    expect_text("= 3", "= 3.5", "1 2 3 4 5 6", DIF_ERR_FORMAT, "NumPoints is 3.5, want a whole number");
    expect_text("= 3", "= 1e300", "1 2 3 4 5 6", DIF_ERR_FORMAT, "NumPoints is 1e+300, want a whole number");
    expect_text("= 3", "= nan", "1 2 3 4 5 6", DIF_ERR_FORMAT, "no NumPoints");
    expect_text("= 3", "= -3", "1 2 3 4 5 6", DIF_ERR_FORMAT, "-3 x 2 samples");
    expect_text("= 3", "= 32769", "1 2 3 4 5 6", DIF_ERR_SIZE, "32769 x 2 samples");
    expect_text("= 3", "= 16000", "1 2 3 4 5 6", DIF_ERR_FORMAT, "11 bytes of numbers, too few for 16000 x 2");
    expect_text("= 3", "= three", "1 2 3 4 5 6", DIF_ERR_FORMAT, "SDF header line 'NumPoints = three', want a number");
    expect_text("NumDataSet = 1", "what is this", "1 2 3 4 5 6", DIF_ERR_FORMAT,
                "SDF header line 'what is this', want key = value");
    expect_text("DataType = 7", "DataType = 7.5", "1 2 3 4 5 6", DIF_ERR_FORMAT, "SDF with DataType 7.5");
    expect_text("*\r\n", "\r\n", "NumPoints = 3", DIF_ERR_FORMAT, "does not end with a line '*' (truncated?)");
    expect_text("aISO", "aISO", "1 2 3 4 5 \n*         ", DIF_ERR_FORMAT, "5 numbers, want 6 for 3 x 2 (truncated?)");
    expect_text("aISO", "aISO", "1 2 3 4 5 6 7", DIF_ERR_FORMAT, "'7' after 6 numbers, want a line '*'");
    expect_text("aISO", "aISO", "1 2 3 4,5 5 6", DIF_ERR_FORMAT, "number 4 is '4,5', want a number or BAD");
}

static void test_read__beginnings_never_read_past_their_end(void **state)
{
    (void)state;
    const bytes file = with_samples(&GOOD);
    assert_int_equal(count_accepted_beginnings(file.data, file.n, NULL), 0);
    char text[800];
    const size_t n = (size_t)snprintf(text, sizeof text, "%s1 2 3\n4 5 67\n*\n", TEXT_HEAD);
    /* after "6", "67" and each of the two line ends and the star all six numbers are there */
    assert_int_equal(count_accepted_beginnings((const unsigned char *)text, n, NULL), 4);
}

static void test_read__failing_heap_is_said(void **state)
{
    (void)state;
    const bytes file = with_samples(&GOOD);
    assert_int_equal(parse_with_failing_heap(file.data, file.n, NULL), 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__every_binary_type_and_magic),
        cmocka_unit_test(test_read__text_form_with_remarks_and_trailer),
        cmocka_unit_test(test_read__missing_points),
        cmocka_unit_test(test_read__refuses_bad_binary_headers),
        cmocka_unit_test(test_read__a_scale_of_zero_names_the_flag),
        cmocka_unit_test(test_read__refuses_bad_texts),
        cmocka_unit_test(test_read__beginnings_never_read_past_their_end),
        cmocka_unit_test(test_read__failing_heap_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
