#define _POSIX_C_SOURCE 200809L

#include "near.h"

#include <string.h>

#include "reports/plot.h"

/* Draws a script's rest; what is written lands in got. */
static dif_status draw(const char *rest, const char *prefix, char *got, size_t n_got, dif_error *err)
{
    FILE *script = NULL, *html = tmpfile();
    assert_non_null(html);
    assert_int_equal(dif_plot_open(300, 200, &script, err), DIF_OK);
    fputs(rest, script);
    const dif_status status = dif_plot_close(script, prefix, "A \"plot\" & more", html, err);
    rewind(html);
    got[fread(got, 1, n_got - 1, html)] = '\0';
    fclose(html);
    return status;
}

static char svg[200000];

static void test_close__one_inline_element_with_own_ids(void **state)
{
    (void)state;
    dif_error err = {0};
    assert_int_equal(draw("plot x with lines, x*x with points pt 7\n", "p7", svg, sizeof svg, &err), DIF_OK);
    assert_int_equal(strncmp(svg, "<svg role=\"img\" aria-label=\"A &quot;plot&quot; &amp; more\"", 54), 0);
    assert_null(strstr(svg + 1, "<svg"));
    assert_non_null(strstr(svg, "viewBox=\"0 0 300 200\""));
    assert_non_null(strstr(svg, "</svg>"));
    assert_null(strstr(svg, "xmlns"));
    assert_null(strstr(svg, "http"));
    assert_null(strstr(svg, "<title>"));
    assert_null(strstr(svg, "id='gpDot'"));
    assert_non_null(strstr(svg, "id='p7-gpDot'"));
    assert_non_null(strstr(svg, "href='#p7-gpPt6'"));
}

static void test_image__pixels_are_embedded(void **state)
{
    (void)state;
    dif_error err = {0};
    FILE *script = NULL, *html = tmpfile();
    assert_non_null(html);
    assert_int_equal(dif_plot_open(300, 200, &script, &err), DIF_OK);
    const float pixels[6] = {0, 1, 2, 3, 4, 5};
    dif_plot_image(script, 0.0, 1.0, 0.0, 1.0, 3, 2);
    fputc('\n', script);
    fwrite(pixels, sizeof(float), 6, script);
    assert_int_equal(dif_plot_close(script, "im", "picture", html, &err), DIF_OK);
    rewind(html);
    svg[fread(svg, 1, sizeof svg - 1, html)] = '\0';
    fclose(html);
    assert_non_null(strstr(svg, "href='data:image/png;base64,"));
}

static void test_close__same_script_same_bytes(void **state)
{
    (void)state;
    static char again[sizeof svg];
    assert_int_equal(draw("plot sin(x)\n", "a", svg, sizeof svg, NULL), DIF_OK);
    assert_int_equal(draw("plot sin(x)\n", "a", again, sizeof again, NULL), DIF_OK);
    assert_string_equal(svg, again);
}

static void test_close__refused_script_gives_gnuplots_line(void **state)
{
    (void)state;
    dif_error err = {0};
    assert_int_equal(draw("plot nonsense(\n", "a", svg, sizeof svg, &err), DIF_ERR_FOREIGN);
    assert_non_null(strstr(err.text, "gnuplot drew nothing (exit code "));
    assert_null(strchr(err.text, '\n'));
    assert_string_equal(svg, "");
}

static void test_close__missing_gnuplot_names_the_package(void **state)
{
    (void)state;
    dif_error err = {0};
    char *path = strdup(getenv("PATH"));
    assert_int_equal(setenv("PATH", "/nonexistent", 1), 0);
    const dif_status status = draw("plot x\n", "a", svg, sizeof svg, &err);
    assert_int_equal(setenv("PATH", path, 1), 0);
    free(path);
    assert_int_equal(status, DIF_ERR_RESOURCE);
    assert_string_equal(err.text, "gnuplot, which draws the plots, cannot be run (No such file or directory): install "
                                  "the package gnuplot-nox");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_close__one_inline_element_with_own_ids),
        cmocka_unit_test(test_image__pixels_are_embedded),
        cmocka_unit_test(test_close__same_script_same_bytes),
        cmocka_unit_test(test_close__refused_script_gives_gnuplots_line),
        cmocka_unit_test(test_close__missing_gnuplot_names_the_package),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
