/* main.xml of x3p surfaces that is broken or means harm. */
#include "tests/io_cases.h"
#include "tests/x3p_sample.h"

static const x3p_file DOUBLES[] = {{"bindata/data.bin", X3P_SIX, sizeof X3P_SIX}, {0}};

static void expect_fails(zip_bytes x3p, dif_status want, const char *part)
{
    assert_parse_fails(x3p.data, x3p.n, NULL, want, part);
    free(x3p.data);
}

static void test_read__refuses_broken_xml(void **state)
{
    (void)state;
    static const struct {
        const char *xml, *part;
    } CASES[] = {
        {"", "main.xml, line 1: no element found"},
        {"<ISO5436_2>", "main.xml, line 1: no element found"},
        {"<ISO5436_2>\n</Record1>", "main.xml, line 2: mismatched tag"},
        {"<html><body/></html>", "main.xml is a 'html', want ISO5436_2"},
        {"<ISO5436_2>&what;</ISO5436_2>", "main.xml, line 1: undefined entity"},
        {"<?xml version=\"1.0\" encoding=\"klingon\"?><ISO5436_2/>", "main.xml, line 1: unknown encoding"},
        {"<ISO5436_2/>", "no SizeX in main.xml"},
    };
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        const x3p_file files[] = {{"main.xml", CASES[i].xml, strlen(CASES[i].xml)}, {0}};
        expect_fails(zip_make(files, ZIP_CM_DEFLATE), DIF_ERR_FORMAT, CASES[i].part);
    }
    char deep[9000] = "<ISO5436_2>";
    size_t n = strlen(deep);
    while (n < 4000)
        n += (size_t)snprintf(deep + n, sizeof deep - n, "<a>");
    const x3p_file files[] = {{"main.xml", deep, n}, {0}};
    expect_fails(zip_make(files, ZIP_CM_DEFLATE), DIF_ERR_FORMAT, "main.xml is nested too deeply");
    x3p_head head = x3p_head_make();
    char name[400];
    memset(name, 'I', sizeof name);
    name[sizeof name - 1] = '\0';
    head.type = name;
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "/Record1/Axes/CZ/DataType of main.xml has more than 199");
}

/* Ten entities of ten entities of ...: a kilobyte that would be gigabytes. */
static void test_read__entities_are_refused_unread(void **state)
{
    (void)state;
    char before[1500] = "<!DOCTYPE lol [<!ENTITY a0 \"lollollollol\">";
    size_t n = strlen(before);
    for (int i = 1; i < 10; i++) {
        n += (size_t)snprintf(before + n, sizeof before - n, "<!ENTITY a%d \"", i);
        for (int k = 0; k < 10; k++)
            n += (size_t)snprintf(before + n, sizeof before - n, "&a%d;", i - 1);
        n += (size_t)snprintf(before + n, sizeof before - n, "\">");
    }
    snprintf(before + n, sizeof before - n, "]>");
    x3p_head head = x3p_head_make();
    head.before = before;
    head.revision = "&a9;";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "main.xml declares a document type, which is not read");
    head.before = "<!DOCTYPE ISO5436_2 SYSTEM \"file:///etc/passwd\">";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "main.xml declares a document type");
}

/* An archive of a main.xml that is mostly `fill`, n bytes of it, between head and tail. */
static zip_bytes make_bomb(const char *head, char fill, size_t n, const char *tail)
{
    const size_t n_head = strlen(head), n_tail = strlen(tail);
    char *xml = malloc(n_head + n + n_tail);
    assert_non_null(xml);
    memcpy(xml, head, n_head);
    memset(xml + n_head, fill, n);
    memcpy(xml + n_head + n, tail, n_tail);
    const x3p_file files[] = {{"main.xml", xml, n_head + n + n_tail}, {0}};
    const zip_bytes x3p = zip_make(files, ZIP_CM_DEFLATE);
    free(xml);
    assert_true(x3p.n < n / 100);
    return x3p;
}

static void test_read__bombs_stop_at_a_cap(void **state)
{
    (void)state;
    expect_fails(make_bomb("<ISO5436_2>", ' ', 20 << 20, "</ISO5436_2>"), DIF_ERR_SIZE,
                 "main.xml has more than 16777216 bytes, which is the most for 0 points");
    expect_fails(make_bomb("<ISO5436_2><!--", '>', 3 << 20, "--></ISO5436_2>"), DIF_ERR_SIZE,
                 "main.xml, line 1: one token of more than 1048576 bytes");
    expect_fails(make_bomb("<!--", 'a', 3 << 20, "--><ISO5436_2/>"), DIF_ERR_SIZE, "one token of more than 1048576");
    expect_fails(make_bomb("<ISO5436_2 a=\"", '>', 3 << 20, "\"/>"), DIF_ERR_SIZE, "one token of more than 1048576");
    expect_fails(make_bomb("<ISO5436_2>", ' ', 3 << 20, "</ISO5436_2>"), DIF_ERR_FORMAT, "no SizeX in main.xml");
    /* samples that the packed bytes cannot hold are seen before memory is asked for */
    x3p_head head = x3p_head_make();
    head.size = "<SizeX>16384</SizeX><SizeY>16384</SizeY>";
    head.type = "D";
    expect_fails(x3p_make(&head, DOUBLES), DIF_ERR_FORMAT, "48 bytes of samples, want 2147483648");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_read__refuses_broken_xml),
        cmocka_unit_test(test_read__entities_are_refused_unread),
        cmocka_unit_test(test_read__bombs_stop_at_a_cap),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
