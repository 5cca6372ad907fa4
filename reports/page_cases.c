/* Cases of a comparison as a table. */
#include <math.h>

#include "reports/compare.h"
#include "reports/html.h"
#include "reports/page_compare.h"
#include "reports/result.h"

void dif_compare_number(FILE *html, const json_t *doc, const char *path, int n_digit, const char *unit)
{
    char text[DIF_HTML_NUMBER_SIZE];
    dif_html_number(dif_result_number(doc, path), n_digit, unit, text);
    fputs(text, html);
}

void dif_compare_mark(FILE *html, bool pass)
{
    fprintf(html, "<span class=\"v %s\"><b>%s</b></span>", pass ? "pass" : "fail", pass ? "✓ pass" : "✗ fail");
}

/* "at -33.5° and 428 nm" or "at θ 12°, φ 170°". */
static void place(FILE *html, const json_t *at)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    const double angle = dif_result_number(at, "angle_deg"), lambda = dif_result_number(at, "lambda_nm");
    dif_html_number(isfinite(angle) ? angle : dif_result_number(at, "theta_r_deg"), 4, "°", a);
    dif_html_number(dif_result_number(at, "phi_r_deg"), 4, "°", b);
    if (isfinite(angle))
        fprintf(html, "%s", a);
    else
        fprintf(html, "θ %s, φ %s", a, b);
    if (!isfinite(lambda))
        return;
    dif_html_number(lambda, 4, "nm", a);
    fprintf(html, ", %s", a);
}

static void cell(FILE *html, const json_t *one, const char *path, int n_digit)
{
    fputs("<td class=\"n\">", html);
    dif_compare_number(html, one, path, n_digit, "");
    fputs("</td>", html);
}

/* Where the worst lies, with both values: of the colour difference where there is one. */
static void write_worst(FILE *html, const json_t *one)
{
    const json_t *de = dif_result_at(one, "stats.de");
    const json_t *stat = json_is_object(de) ? de : dif_result_at(one, "stats.abs");
    fputs("<td>", html);
    place(html, dif_result_at(stat, "at"));
    fprintf(html, "<br><small>%s", json_is_object(de) ? "Y " : "");
    dif_compare_number(html, stat, "device", 7, "");
    fputs(" / ", html);
    dif_compare_number(html, stat, "reference", 7, "");
    fputs("</small></td>", html);
}

static void write_time(FILE *html, const json_t *one)
{
    const double call_s = dif_result_number(one, "timings.call_s"), run_s = dif_result_number(one, "timings.run_s");
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    dif_html_number(1e3 * call_s, 3, "ms", a);
    dif_html_number(1e3 * run_s, 3, "ms", b);
    fprintf(html, "<td class=\"n\">%s<br><small>%s</small></td>", a, b);
}

static void write_case(FILE *html, const json_t *one, bool has_time)
{
    const bool failed = !dif_result_true(one, "pass");
    size_t i;
    json_t *check;
    fprintf(html, "<tr><td>%s %s<br><small>%s</small></td><td>", dif_result_text(one, "method"),
            dif_result_text(one, "question"), dif_result_text(one, "path"));
    dif_compare_mark(html, !failed);
    json_array_foreach(dif_result_at(one, "checks"), i, check)
    {
        if (dif_result_true(check, "pass"))
            continue;
        fprintf(html, "<br><small>%s ", dif_result_text(check, "metric"));
        dif_compare_number(html, check, "value", 3, dif_result_text(check, "unit"));
        fputs(", limit ", html);
        dif_compare_number(html, check, "limit", 3, dif_result_text(check, "unit"));
        fputs("</small>", html);
    }
    fputs("</td>", html);
    if (!dif_result_true(one, "answered")) {
        fprintf(html, "<td colspan=\"%d\">no answer: ", has_time ? 9 : 8);
        dif_html_text(html, dif_result_text(one, "text"));
        fputs("</td></tr>\n", html);
        return;
    }
    cell(html, one, "maximum", 3);
    cell(html, one, "stats.abs.worst", 2);
    cell(html, one, "stats.max.worst", 2);
    cell(html, one, "stats.rel.median", 2);
    cell(html, one, "stats.rel.p99", 2);
    cell(html, one, "stats.de.p95", 2);
    cell(html, one, "stats.de.worst", 2);
    write_worst(html, one);
    if (has_time)
        write_time(html, one);
    fputs("</tr>\n", html);
}

void dif_compare_cases(FILE *html, const json_t *cases)
{
    size_t i;
    json_t *one;
    bool has_time = false;
    json_array_foreach(cases, i, one) has_time = has_time || isfinite(dif_result_number(one, "timings.call_s"));
    fprintf(html,
            "<table class=\"wide\"><thead><tr><th>Case</th><th>Verdict</th><th class=\"n\">Maximum</th><th class=\"n\">"
            "|Δ| worst</th><th class=\"n\">of the<br>maximum</th><th class=\"n\">relative<br>median</th>"
            "<th class=\"n\">relative<br>p99</th><th class=\"n\">ΔE<sub>2000</sub><br>p95</th><th class=\"n\">"
            "ΔE<sub>2000</sub><br>worst</th><th>Where the worst lies<br><small>GPU / CPU</small></th>%s</tr></thead>"
            "<tbody>\n",
            has_time ? "<th class=\"n\">Call<br><small>shaders alone</small></th>" : "");
    json_array_foreach(cases, i, one) write_case(html, one, has_time);
    fputs("</tbody></table>\n", html);
}
