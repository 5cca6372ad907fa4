/* The page of a comparison. */
#include <math.h>
#include <string.h>

#include "reports/compare.h"
#include "reports/figures.h"
#include "reports/html.h"
#include "reports/page.h"
#include "reports/page_compare.h"

/* Maxima and periods of the tables, where they were compared. */
static void write_tables_findings(FILE *html, const json_t *cases)
{
    size_t i;
    json_t *one;
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    fputs("<ul>\n", html);
    json_array_foreach(cases, i, one)
    {
        const json_t *peaks = dif_result_at(one, "peaks"), *fit = dif_result_at(one, "fit");
        if (!json_is_object(peaks))
            continue;
        dif_html_plain(dif_result_number(peaks, "n"), "", a);
        dif_html_number(dif_result_number(peaks, "shift_deg"), 2, "deg", b);
        fprintf(html, "<li>%s, %s: %s maxima beside the mirror beam, ", dif_result_text(one, "method"),
                dif_result_text(one, "path"), a);
        dif_html_plain(dif_result_number(peaks, "n_lost"), "", a);
        fprintf(html, "%s without a counterpart, the others within %s.", a, b);
        if (json_is_object(fit)) {
            dif_html_uncertain(dif_result_number(fit, "device_nm"), dif_result_number(fit, "device_u_nm"), "nm", a);
            dif_html_uncertain(dif_result_number(fit, "reference_nm"), dif_result_number(fit, "reference_u_nm"), "nm",
                               b);
            fprintf(html, " Fitted period: %s from the GPU’s table, %s from the CPU’s, ", a, b);
            dif_html_number(dif_result_number(fit, "device_nm") - dif_result_number(fit, "reference_nm"), 2, "nm", a);
            fprintf(html, "a difference of %s. ", a);
            dif_html_text(html, dif_result_text(fit, "text"));
        }
        fputs("</li>\n", html);
    }
    fputs("</ul>\n", html);
}

static dif_status write_pictures(FILE *html, const char *folder, int number_of, const json_t *one, dif_error *err)
{
    static const char *const keys[] = {"device", "reference", "difference"};
    static const char *const words[] = {"GPU", "CPU", "difference"};
    const json_t *pictures = dif_result_at(one, "pictures");
    const dif_result result = {.folder = folder};
    const bool colours = json_is_object(dif_result_at(one, "stats.de"));
    const json_t *at = dif_result_at(one, colours ? "stats.de.at" : "stats.abs.at");
    char prefix[64], label[200];
    if (!json_is_object(pictures))
        return DIF_OK;
    fprintf(html, "<h4>%s, %s, %s</h4>\n<div class=\"three\">\n", dif_result_text(one, "method"),
            dif_result_text(one, "question"), dif_result_text(one, "path"));
    for (int i = 0; i < 3; i++) {
        dif_picture picture;
        const dif_status status = dif_picture_load(&result, dif_result_text(pictures, keys[i]), &picture, err);
        if (status != DIF_OK)
            return status;
        snprintf(prefix, sizeof prefix, "c%d-%d", number_of, i);
        snprintf(label, sizeof label, "%s %s: %s", dif_result_text(one, "method"), dif_result_text(one, "question"),
                 words[i]);
        fputs("<figure>", html);
        dif_figure_compared(&picture, dif_result_at(pictures, "axes"), at, label, prefix, html);
        dif_picture_free(&picture);
        if (i == 2) {
            snprintf(prefix, sizeof prefix, "c%d-bar", number_of);
            dif_figure_difference_bar(dif_result_number(pictures, "difference_low"),
                                      dif_result_number(pictures, "difference_high"), prefix, html);
        }
        fprintf(html, "<figcaption><b>%s</b>", words[i]);
        if (i < 2 && !colours) {
            fputs(", six decades below ", html);
            dif_compare_number(html, pictures, "value_high", 3, "");
        } else if (i == 2) {
            fputs(colours ? ": ΔE<sub>2000</sub>; worst " : ": |Δp|; worst ", html);
            dif_compare_number(html, one, colours ? "stats.de.worst" : "stats.abs.worst", 2, "");
            fputs(" in the ring", html);
        }
        if (isfinite(dif_result_number(pictures, "lambda_nm"))) {
            fputs(", at ", html);
            dif_compare_number(html, pictures, "lambda_nm", 4, "nm");
        }
        fputs("</figcaption></figure>\n", html);
    }
    fputs("</div>\n", html);
    return DIF_OK;
}

static dif_status write_surface(FILE *html, const char *folder, int number_of, const json_t *surface, dif_error *err)
{
    const json_t *cases = dif_result_at(surface, "cases");
    size_t i;
    json_t *one;
    fprintf(html, "<section>\n<h2 id=\"s%d\">%d. ", number_of, number_of);
    dif_html_text(html, dif_result_text(surface, "title"));
    fputs("</h2>\n<p class=\"lead\">", html);
    dif_html_text(html, dif_result_text(surface, "description"));
    fputs("</p>\n", html);
    dif_compare_cases(html, cases);
    json_array_foreach(dif_result_at(surface, "skipped"), i, one)
    {
        fputs("<p class=\"note\">", html);
        dif_html_text(html, dif_result_text(one, "method"));
        fputs(" is left out: ", html);
        dif_html_text(html, dif_result_text(one, "text"));
        fputs("</p>\n", html);
    }
    write_tables_findings(html, cases);
    fputs("<h3>Pictures</h3>\n<p>The ring is the place where the difference is largest. Tables: angle to the right, "
          "wavelength upwards; discs: direction cosines, x to the right, y up.</p>\n",
          html);
    dif_status status = DIF_OK;
    json_array_foreach(cases, i, one)
    {
        if (status == DIF_OK)
            status = write_pictures(html, folder, 1000 * number_of + (int)i, one, err);
    }
    fputs("</section>\n", html);
    return status;
}

static void write_device(FILE *html, const json_t *doc)
{
    const char *fault = dif_result_text(doc, "device.fault");
    fputs("<p>", html);
    dif_html_text(html, dif_result_text(doc, "device.renderer"));
    fputs(dif_result_true(doc, "device.software") ? " (a software renderer)" : "", html);
    fputs("; ", html);
    dif_html_text(html, dif_result_text(doc, "device.version"));
    fputs("; EGL ", html);
    dif_html_text(html, dif_result_text(doc, "device.platform"));
    fputs(".", html);
    if (*fault && strcmp(fault, "none") != 0)
        fprintf(html, " <b>Its shaders are deliberately wrong (%s): this run must fail.</b>", fault);
    fputs("</p>\n", html);
}

/* Surfaces by methods: cases that pass of those that were asked. */
static void write_summary(FILE *html, const json_t *doc)
{
    static const char *const methods[] = {"sheet", "nmm", "nmm-lines", "pq", "lut", "stam"};
    const int n_method = sizeof methods / sizeof *methods;
    size_t i, k;
    json_t *surface, *one;
    fputs("<table><thead><tr><th>Surface</th>", html);
    for (int m = 0; m < n_method; m++)
        fprintf(html, "<th>%s</th>", methods[m]);
    fputs("</tr></thead><tbody>\n", html);
    json_array_foreach(dif_result_at(doc, "surfaces"), i, surface)
    {
        fprintf(html, "<tr><td><a href=\"#s%zu\">", i + 1);
        dif_html_text(html, dif_result_text(surface, "title"));
        fputs("</a></td>", html);
        for (int m = 0; m < n_method; m++) {
            int n = 0, n_pass = 0;
            json_array_foreach(dif_result_at(surface, "cases"), k, one)
            {
                const bool mine = strcmp(dif_result_text(one, "method"), methods[m]) == 0;
                n += mine;
                n_pass += mine && dif_result_true(one, "pass");
            }
            fputs("<td>", html);
            if (n > 0)
                dif_compare_mark(html, n == n_pass);
            fprintf(html, n > 0 ? " <small>%d of %d</small></td>" : "–</td>", n_pass, n);
        }
        fputs("</tr>\n", html);
    }
    fputs("</tbody></table>\n", html);
}

static void write_baseline(FILE *html, const json_t *baseline)
{
    size_t i;
    json_t *row;
    char text[DIF_HTML_NUMBER_SIZE];
    fputs("<h2 id=\"baseline\">Against the baseline</h2>\n<p>", html);
    dif_html_text(html, dif_result_text(baseline, "file"));
    fputs(" (", html);
    dif_html_text(html, dif_result_text(baseline, "renderer"));
    dif_html_plain(dif_result_number(baseline, "factor"), "", text);
    fprintf(html, "). A number has moved if it changed by more than a factor of %s", text);
    dif_html_plain(100.0 * dif_result_number(baseline, "noise_share"), "%", text);
    fprintf(html, " and is more than %s of its limit. ", text);
    dif_html_plain(dif_result_number(baseline, "n_same"), "", text);
    fprintf(html, "%s numbers did not move.</p>\n", text);
    if (json_array_size(dif_result_at(baseline, "rows")) == 0)
        return;
    fputs("<table><thead><tr><th>Surface</th><th>Case</th><th>Metric</th><th class=\"n\">Before</th><th class=\"n\">Now"
          "</th><th></th></tr></thead><tbody>\n",
          html);
    json_array_foreach(dif_result_at(baseline, "rows"), i, row)
    {
        const char *state = dif_result_text(row, "state");
        const bool bad = strcmp(state, "worse") == 0 || strcmp(state, "missing") == 0;
        fputs("<tr><td>", html);
        dif_html_text(html, dif_result_text(row, "surface"));
        fprintf(html, "</td><td>%s %s (%s)</td><td>%s</td>", dif_result_text(row, "method"),
                dif_result_text(row, "question"), dif_result_text(row, "path"), dif_result_text(row, "metric"));
        for (int k = 0; k < 2; k++) {
            const char *key = k ? "now" : "before";
            dif_html_number(dif_result_number(row, key), 3, "", text);
            fprintf(html, "<td class=\"n\">%s</td>", *dif_result_text(row, key) ? dif_result_text(row, key) : text);
        }
        fprintf(html, "<td><span class=\"v %s\"><b>%s</b></span></td></tr>\n", bad ? "fail" : "pass", state);
    }
    fputs("</tbody></table>\n", html);
}

static void write_limits(FILE *html, const json_t *thresholds)
{
    size_t i;
    json_t *row;
    fputs("<h2 id=\"limits\">Limits</h2>\n<table class=\"wide\"><thead><tr><th>Metric</th><th>Method</th><th>Question"
          "</th><th class=\"n\">Limit</th><th>Reason</th></tr></thead><tbody>\n",
          html);
    json_array_foreach(dif_result_at(thresholds, "thresholds"), i, row)
    {
        fputs("<tr><td>", html);
        dif_html_text(html, dif_result_text(row, "metric"));
        fputs("</td><td>", html);
        dif_html_text(html, dif_result_text(row, "method"));
        fputs("</td><td>", html);
        dif_html_text(html, dif_result_text(row, "question"));
        fputs("</td><td class=\"n\">", html);
        if (json_is_null(dif_result_at(row, "limit")))
            fputs("not judged", html);
        else
            dif_compare_number(html, row, "limit", 3, "");
        fputs("</td><td>", html);
        dif_html_text(html, dif_result_text(row, "reason"));
        fputs("</td></tr>\n", html);
    }
    fputs(
        "</tbody><caption>The last row that fits a case counts. Relative: |a − b| / max(|a|, |b|, floor), the floor "
        "being a share of the maximum. Colours are compared at the exposure of a picture of the map, where the pixels "
        "brighter than white hold a tenth of the light outside the mirror beam; brighter ones are dimmed to white."
        "</caption></table>\n",
        html);
}

static void write_head(FILE *html, const json_t *doc)
{
    const bool pass = dif_result_true(doc, "verdict.pass");
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    dif_html_plain(dif_result_number(doc, "verdict.n"), "", a);
    dif_html_plain(dif_result_number(doc, "verdict.n_failed"), "", b);
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
          html);
    dif_html_text(html, dif_result_text(doc, "title"));
    fprintf(html,
            "</title>\n<style>\n%s.three{display:grid;grid-template-columns:1fr 1fr 1fr;gap:1.2rem;align-items:start}\n"
            ".three>*{min-width:0;margin:0 0 .6rem}svg.scale{max-width:380px}h4{margin:.8rem 0 .2rem}\n</style>\n"
            "</head>\n<body>\n<h1>",
            dif_page_style());
    dif_html_text(html, dif_result_text(doc, "title"));
    fputs("</h1>\n<p class=\"lead\">", html);
    dif_html_text(html, dif_result_text(doc, "provenance.program"));
    fputs(" ", html);
    dif_html_text(html, dif_result_text(doc, "provenance.version"));
    fputs(", ", html);
    dif_html_text(html, dif_result_text(doc, "provenance.created"));
    fputs(".</p>\n<p>", html);
    dif_compare_mark(html, pass);
    if (pass)
        fprintf(html, " All %s cases keep their limits.", a);
    else
        fprintf(html, " %s of %s cases are outside their limits.", b, a);
    fputs(" A pass says that the shaders compute the same physics as the CPU in double precision, to what float32 can "
          "hold, on these surfaces and this driver. It does not say that the physics is right: the report’s other "
          "checks do, against direct sums and closed forms.</p>\n",
          html);
}

dif_status dif_compare_page(FILE *html, const char *folder, const json_t *doc, dif_error *err)
{
    const json_t *baseline = dif_result_at(doc, "baseline");
    size_t i;
    json_t *surface;
    dif_status status = DIF_OK;
    write_head(html, doc);
    write_device(html, doc);
    write_summary(html, doc);
    if (json_is_object(baseline))
        write_baseline(html, baseline);
    json_array_foreach(dif_result_at(doc, "surfaces"), i, surface)
    {
        if (status == DIF_OK)
            status = write_surface(html, folder, (int)i + 1, surface, err);
    }
    write_limits(html, dif_result_at(doc, "thresholds"));
    fputs("<h2 id=\"conditions\">Conditions</h2>\n", html);
    dif_page_provenance(html, dif_result_at(doc, "conditions"));
    fputs("<h2 id=\"provenance\">Provenance</h2>\n", html);
    dif_page_provenance(html, dif_result_at(doc, "provenance"));
    fputs("</body>\n</html>\n", html);
    return status;
}
