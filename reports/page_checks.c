#include <math.h>
#include <string.h>

#include "reports/html.h"
#include "reports/page.h"
#include "reports/page_parts.h"

/* To n digits; 0 = as it was chosen. */
static void number(FILE *html, double value, int n_digit, const char *unit)
{
    char text[DIF_HTML_NUMBER_SIZE];
    if (n_digit > 0)
        dif_html_number(value, n_digit, unit, text);
    else
        dif_html_plain(value, unit, text);
    fputs(text, html);
}

static void row(FILE *html, const char *label, double value, int n_digit, const char *unit)
{
    fprintf(html, "<tr><th>%s</th><td class=\"n\">", label);
    number(html, value, n_digit, unit);
    fputs("</td></tr>\n", html);
}

void dif_part_accuracy(FILE *html, const json_t *doc)
{
    const json_t *check = dif_result_at(doc, "check");
    fputs("<table><tbody>\n", html);
    row(html, "Tolerance asked for (amplitude error / ΣW)", dif_result_number(doc, "plan.tol"), 2, "");
    row(html, "Bound stated by the method", dif_result_number(doc, "measure.bound"), 2, "");
    fputs("<tr class=\"strong\"><th>Largest error found against the direct sum</th><td class=\"n\">", html);
    number(html, dif_result_number(check, "worst_amplitude"), 2, "");
    fputs("</td></tr>\n</tbody></table>\n<p>Direct sum in double precision at ", html);
    number(html, dif_result_number(check, "n_sample"), 0, "");
    fputs(" random cells. The worst lies at ", html);
    number(html, dif_result_number(check, "worst_angle_deg"), 5, "°");
    fputs(", ", html);
    number(html, dif_result_number(check, "worst_lambda_nm"), 5, "nm");
    fputs(": ", html);
    number(html, dif_result_number(check, "worst_value"), 6, "");
    fputs(" in the table, ", html);
    number(html, dif_result_number(check, "worst_direct"), 6, "");
    fputs(" directly. ", html);
    dif_html_text(html, dif_result_text(doc, "measure.method_text"));
    fputs("</p>\n<p>A cell whose normalised power p is below tol² = ", html);
    const double tol = dif_result_number(doc, "plan.tol");
    number(html, tol * tol, 2, "");
    fputs(" says no more than “less than that”: there the permitted error is as large as the amplitude itself. ", html);
    number(html, 100.0 * dif_result_number(doc, "below_tol2.share"), 3, "%");
    fputs(" of the cells are below it", html);
    if (dif_result_number(doc, "below_tol2.n") > 0.0) {
        fputs(", the darkest with p = ", html);
        number(html, dif_result_number(doc, "below_tol2.p_min"), 2, "");
    }
    fputs(".</p>\n", html);
}

void dif_part_energy(FILE *html, const json_t *doc)
{
    const json_t *energy = dif_result_at(doc, "energy");
    size_t i;
    json_t *item;
    fputs("<table class=\"wide\"><thead><tr><th>θ<sub>i</sub></th><th>λ</th>"
          "<th class=\"n\">∫ f cos θ<sub>r</sub> dω, this surface</th>"
          "<th class=\"n\">reference</th><th>what the reference is</th><th "
          "class=\"n\">difference</th></tr></thead><tbody>\n",
          html);
    json_array_foreach(dif_result_at(energy, "rows"), i, item)
    {
        fputs("<tr><td>", html);
        number(html, dif_result_number(item, "theta_i_deg"), 0, "°");
        fputs("</td><td>", html);
        number(html, dif_result_number(item, "lambda_nm"), 0, "nm");
        fputs("</td><td class=\"n\">", html);
        number(html, dif_result_number(item, "albedo"), 5, "");
        fputs("</td><td class=\"n\">", html);
        number(html, dif_result_number(item, "reference"), 5, "");
        fputs("</td><td>", html);
        dif_html_text(html, dif_result_text(item, "reference_text"));
        fputs("</td><td class=\"n\">", html);
        number(html, dif_result_number(item, "albedo") - dif_result_number(item, "reference"), 2, "");
        fputs("</td></tr>\n", html);
    }
    fputs("</tbody><caption>Reflected share of the incident power, integrated over all directions, at reflectance R = "
          "1. ",
          html);
    dif_html_text(html, dif_result_text(energy, "text"));
    fputs("</caption></table>\n", html);
}

void dif_part_order_powers(FILE *html, const json_t *doc)
{
    const json_t *orders = dif_result_at(doc, "orders");
    size_t i;
    json_t *item;
    if (json_array_size(dif_result_at(orders, "rows")) == 0)
        return;
    fputs("<table><thead><tr><th class=\"n\">Order m</th><th class=\"n\">θ<sub>m</sub></th>"
          "<th class=\"n\">|c<sub>m</sub>|² of the sampled surface</th><th class=\"n\">closed form</th>"
          "<th class=\"n\">difference</th><th class=\"n\">limit</th><th class=\"n\">efficiency at R = "
          "1</th></tr></thead><tbody>\n",
          html);
    json_array_foreach(dif_result_at(orders, "rows"), i, item)
    {
        static const struct {
            const char *key, *unit;
            int n_digit;
        } columns[] = {{"order", "", 0},      {"angle_deg", "°", 5}, {"sampled", "", 6},   {"closed", "", 6},
                       {"difference", "", 2}, {"limit", "", 2},      {"efficiency", "", 4}};
        fputs("<tr>", html);
        for (size_t k = 0; k < sizeof columns / sizeof *columns; k++) {
            fputs("<td class=\"n\">", html);
            number(html, dif_result_number(item, columns[k].key), columns[k].n_digit, columns[k].unit);
            fputs("</td>", html);
        }
        fputs("</tr>\n", html);
    }
    fputs("</tbody><caption>Powers of the orders at ", html);
    number(html, dif_result_number(orders, "lambda_nm"), 0, "nm");
    fputs(", flat window over the whole patch, against the closed scalar form of the profile. ", html);
    dif_html_text(html, dif_result_text(orders, "text"));
    fputs("</caption></table>\n", html);
}

void dif_part_trust(FILE *html, const json_t *doc)
{
    size_t i;
    json_t *item;
    fputs("<ul class=\"trust\">\n", html);
    json_array_foreach(dif_result_at(doc, "domain"), i, item)
    {
        const char *level = dif_result_text(item, "level");
        const bool known = strcmp(level, "good") == 0 || strcmp(level, "caution") == 0 || strcmp(level, "beyond") == 0;
        fprintf(html, "<li class=\"%s\"><b>", known ? level : "caution");
        dif_html_text(html, level);
        fputs("</b>", html);
        dif_html_text(html, dif_result_text(item, "text"));
        fputs("</li>\n", html);
    }
    fputs("</ul>\n", html);
}

void dif_part_timings(FILE *html, const json_t *doc)
{
    const json_t *rows = dif_result_at(doc, "timings.rows");
    size_t i;
    json_t *item;
    double longest = 0.0;
    json_array_foreach(rows, i, item) longest = fmax(longest, dif_result_number(item, "wall_s"));
    if (!(longest > 0.0))
        return;
    fputs("<h3>Time</h3>\n<table class=\"wide\"><thead><tr><th>Stage</th><th class=\"n\">wall</th><th "
          "class=\"n\">CPU</th>"
          "<th style=\"width:40%\"></th></tr></thead><tbody>\n",
          html);
    json_array_foreach(rows, i, item)
    {
        const double wall_s = dif_result_number(item, "wall_s");
        fputs("<tr><td>", html);
        dif_html_text(html, dif_result_text(item, "stage"));
        fputs("</td><td class=\"n\">", html);
        number(html, 1e3 * wall_s, 3, "ms");
        fputs("</td><td class=\"n\">", html);
        number(html, 1e3 * dif_result_number(item, "cpu_s"), 3, "ms");
        fprintf(html, "</td><td><span class=\"bar\" style=\"width:%.1f%%\"></span></td></tr>\n",
                100.0 * wall_s / longest);
    }
    fputs("</tbody><caption>", html);
    dif_html_text(html, dif_result_text(doc, "timings.text"));
    fputs("</caption></table>\n", html);
}
