/* The page's section of a rendering. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "reports/page_parts.h"

static void test_render__nothing_without_a_rendering_and_an_error_without_its_picture(void **state)
{
    (void)state;
    dif_error err = {0};
    FILE *html = tmpfile();
    assert_non_null(html);
    dif_result result = {.doc = json_object()};
    assert_int_equal(dif_part_render(html, 1, &result, &err), DIF_OK);
    assert_int_equal(ftell(html), 0);
    json_object_set_new(result.doc, "render", json_pack("{s:s}", "picture", "none.render.png"));
    assert_int_not_equal(dif_part_render(html, 1, &result, &err), DIF_OK);
    assert_true(err.text[0] != '\0');
    assert_int_equal(ftell(html), 0);
    json_decref(result.doc);
    fclose(html);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_render__nothing_without_a_rendering_and_an_error_without_its_picture),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
