/* The section of a surface's comparison of GPU and CPU. */
#include "reports/compare.h"
#include "reports/html.h"
#include "reports/page_compare.h"
#include "reports/page_parts.h"

void dif_part_gpu(FILE *html, int number, const json_t *doc)
{
    const json_t *gpu = dif_result_at(doc, "gpu");
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    if (!json_is_object(gpu))
        return;
    fprintf(html, "<h3 id=\"s%d-gpu\">GPU against CPU</h3>\n<p>", number);
    if (*dif_result_text(gpu, "text")) {
        fputs("Not compared: ", html);
        dif_html_text(html, dif_result_text(gpu, "text"));
        fputs("</p>\n", html);
        return;
    }
    dif_compare_mark(html, dif_result_true(gpu, "verdict.pass"));
    dif_html_plain(dif_result_number(gpu, "verdict.n") - dif_result_number(gpu, "verdict.n_failed"), "", a);
    dif_html_plain(dif_result_number(gpu, "verdict.n"), "", b);
    fprintf(html, " %s of %s cases keep their limits: the shaders of ", a, b);
    dif_html_text(html, dif_result_text(gpu, "device.renderer"));
    fprintf(
        html,
        "%s against the CPU in double precision, one coherence window at the centre. <code>diffbench compare</code> "
        "says more, and holds the integrated table against full sampling.</p>\n",
        dif_result_true(gpu, "device.software") ? " (a software renderer)" : "");
    dif_compare_cases(html, dif_result_at(gpu, "cases"));
}
