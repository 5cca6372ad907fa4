/* The source's studies as rows of small maps, and found periods beside its published ones. */
#include <math.h>

#include "reports/figures.h"
#include "reports/html.h"
#include "reports/page.h"
#include "reports/page_parts.h"

static const char *digits(const json_t *doc, const char *path, int n_digit, const char *unit,
                          char text[DIF_HTML_NUMBER_SIZE])
{
    dif_html_number(dif_result_number(doc, path), n_digit, unit, text);
    return text;
}

static dif_status write_item(FILE *html, const char *prefix, const dif_result *result, const json_t *item,
                             dif_error *err)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    dif_picture picture;
    const dif_status status = dif_picture_load(result, dif_result_text(item, "picture"), &picture, err);
    if (status != DIF_OK)
        return status;
    fputs("<figure>", html);
    dif_figure_small_map(&picture, dif_result_text(item, "label"), prefix, html);
    dif_picture_free(&picture);
    fputs("<figcaption><b>", html);
    dif_html_text(html, dif_result_text(item, "label"));
    fputs("</b>", html);
    if (isfinite(dif_result_number(item, "de_median")))
        fprintf(html, "<br>ΔE %s, 95 %%: %s", digits(item, "de_median", 2, "", a), digits(item, "de_p95", 2, "", b));
    if (isfinite(dif_result_number(item, "de_worst")))
        fprintf(html, "<br>worst %s", digits(item, "de_worst", 2, "", a));
    fputs("</figcaption></figure>\n", html);
    return DIF_OK;
}

dif_status dif_part_study(FILE *html, int number, const dif_result *result, dif_error *err)
{
    const json_t *study = dif_result_at(result->doc, "study");
    size_t i, k;
    json_t *row, *item;
    char prefix[64], a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    if (!json_is_object(study))
        return DIF_OK;
    dif_html_plain(dif_result_number(study, "theta_i_deg"), "°", a);
    dif_html_plain(dif_result_number(study, "lambda_nm_step"), "nm", b);
    fprintf(
        html,
        "<h3 id=\"s%d-study\">Studies</h3>\n<p>Small BRDF maps, drawn as the large one above, one condition varied at "
        "a "
        "time. What is not varied: θ<sub>i</sub> = %s, one coherence window at the centre, a wavelength every %s, the "
        "window’s own σ. ΔE is CIEDE2000 over all directions: median, 95th percentile, worst.</p>\n",
        number, a, b);
    json_array_foreach(dif_result_at(study, "rows"), i, row)
    {
        fputs("<p class=\"row\"><b>", html);
        dif_html_text(html, dif_result_text(row, "title"));
        fputs(".</b> ", html);
        dif_html_text(html, dif_result_text(row, "text"));
        fputs("</p>\n<div class=\"six\">\n", html);
        json_array_foreach(dif_result_at(row, "items"), k, item)
        {
            snprintf(prefix, sizeof prefix, "s%dw%zu-%zu", number, i, k);
            const dif_status status = write_item(html, prefix, result, item, err);
            if (status != DIF_OK)
                return status;
        }
        fputs("</div>\n", html);
    }
    return DIF_OK;
}

static void cell(FILE *html, const json_t *doc, const char *path, const char *path_sd)
{
    char text[DIF_HTML_NUMBER_SIZE];
    const double value = dif_result_number(doc, path);
    dif_html_number(value, value >= 1000.0 ? 7 : 6, "nm", text);
    fprintf(html, "<td class=\"n\">%s", text);
    if (path_sd && isfinite(dif_result_number(doc, path_sd)))
        fprintf(html, "<br><small>sd %s</small>", digits(doc, path_sd, 2, "nm", text));
    fputs("</td>", html);
}

static void write_sides(FILE *html, const json_t *doc)
{
    const json_t *published = dif_result_at(doc, "study.published"), *sides = dif_result_at(published, "sides");
    const size_t n = json_array_size(sides);
    size_t i;
    json_t *side;
    char text[DIF_HTML_NUMBER_SIZE];
    json_array_foreach(sides, i, side)
    {
        fputs("<tr>", html);
        if (i == 0) {
            fprintf(html, "<td rowspan=\"%zu\">", n);
            dif_html_text(html, dif_result_text(doc, "title"));
            if (dif_result_true(published, "stand_in"))
                fputs("<br><small>a synthetic stand-in for the scan that was published</small>", html);
            fputs("</td>", html);
        }
        dif_html_plain(dif_result_number(side, "azimuth_deg"), "°", text);
        fprintf(html, "<td class=\"n\">%s</td>", text);
        cell(html, published, "full_nm", "full_sd_nm");
        cell(html, side, "thesis_nm", "thesis_sd_nm");
        cell(html, side, "right_nm", "right_sd_nm");
        if (i == 0) {
            const bool fitted = dif_result_true(published, "same_plane"); /* else the table is of other lines */
            dif_html_uncertain(fitted ? dif_result_number(doc, "fit_table.period_nm") : (double)NAN,
                               dif_result_number(doc, "fit_table.u_nm"), "nm", text);
            fprintf(html, "<td class=\"n\" rowspan=\"%zu\">%s</td>", n, text);
        }
        cell(html, published, "nmm_nm", NULL);
        cell(html, side, "nmm_nm", NULL);
        cell(html, published, "pq_nm", NULL);
        cell(html, side, "pq_nm", NULL);
        fputs("</tr>\n", html);
    }
}

bool dif_page_has_published(const json_t *docs)
{
    size_t i;
    json_t *doc;
    json_array_foreach(docs, i, doc)
    {
        if (json_array_size(dif_result_at(doc, "study.published.sides")) > 0)
            return true;
    }
    return false;
}

void dif_page_published(FILE *html, const json_t *list, const json_t *docs)
{
    size_t i;
    json_t *doc;
    if (!dif_page_has_published(docs))
        return;
    fputs("<h2 id=\"published\">Beside the source’s published periods</h2>\n"
          "<table class=\"wide\"><thead><tr><th rowspan=\"2\">Surface</th><th class=\"n\" rowspan=\"2\">lit from</th>"
          "<th class=\"n\" colspan=\"4\">full sampling</th><th class=\"n\" colspan=\"2\">few wavelengths</th>"
          "<th class=\"n\" colspan=\"2\">replicas</th></tr>\n<tr><th class=\"n\">published</th>"
          "<th class=\"n\"><code>thesis</code></th><th class=\"n\">put right</th><th class=\"n\">fitted</th>"
          "<th class=\"n\">published</th><th class=\"n\"><code>nmm</code></th><th class=\"n\">published</th>"
          "<th class=\"n\"><code>pq</code></th></tr></thead><tbody>\n",
          html);
    const json_t *bitmap = dif_result_at(list, "source_bitmap");
    if (json_is_object(bitmap)) {
        fputs(
            "<tr><td>The source’s blazed bitmap<br><small>one period of 2500 nm in 200 pixels, 250 nm high</small></td>"
            "<td class=\"n\">0°</td>",
            html);
        cell(html, bitmap, "full_nm", "full_sd_nm");
        cell(html, bitmap, "thesis_nm", "thesis_sd_nm");
        fputs("<td class=\"n\">–</td><td class=\"n\">–</td><td class=\"n\">–</td><td class=\"n\">–</td><td "
              "class=\"n\">–</td>"
              "<td class=\"n\">–</td></tr>\n",
              html);
    }
    json_array_foreach(docs, i, doc) write_sides(html, doc);
    fputs(
        "</tbody><caption>Mean of λ/|sin&nbsp;θ<sub>i</sub> + sin&nbsp;θ<sub>r</sub>| at the largest value of each "
        "wavelength, "
        "380 to 780 nm, θ<sub>i</sub> = 75°, angles every 0.01°, one window of σ = 16.25 µm, with the standard "
        "deviation over "
        "wavelengths (which the source calls variance). “Put right” is the same statistic of an exact table; “fitted” "
        "is the "
        "ridge model’s period with its uncertainty.</caption></table>\n"
        "<p>The source’s program leaves the factor w out of the phase: the heights count as k·h in place of k·w·h, "
        "with a "
        "fixed sign, as if the light came in and left along the normal and from the other side. It has no gain, and it "
        "lays "
        "one coherence window on the corner of the endlessly tiled patch. On a perfect grating none of this moves the "
        "lines, "
        "so its period is right, though only to the grid of angles; put right, w changes across each line and draws "
        "plain "
        "maxima off its centre by some tenths of a nanometre, differently from either side of incidence, which the "
        "fitted "
        "period corrects. On a scan the phase decides which speckle is the brightest, so its number belongs to another "
        "pattern of another part of the surface: with w and a centred window the same statistic differs by per cents, "
        "and it "
        "differs between the two sides of incidence, which no period can. The expectation over windows and the fitted "
        "ridges, each with its weight, are what can be said of such a surface. The source’s replicas used N + 1 terms "
        "for N "
        "patches and a wrong imaginary part; with the exact factor they return the period that they were given.</p>\n",
        html);
}
