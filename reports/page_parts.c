#include "reports/page_parts.h"

#include <math.h>
#include <string.h>

#include "reports/html.h"
#include "reports/page.h"

/* <td class="n">number</td> */
static void cell(FILE *html, double value, int n_digit, const char *unit)
{
    char text[DIF_HTML_NUMBER_SIZE];
    dif_html_number(value, n_digit, unit, text);
    fprintf(html, "<td class=\"n\">%s</td>", text);
}

static void cell_whole(FILE *html, double value)
{
    char text[DIF_HTML_NUMBER_SIZE];
    dif_html_plain(value, "", text);
    fprintf(html, "<td class=\"n\">%s</td>", text);
}

/* "before N after", a dash for what is not there. */
static void say_count(FILE *html, const char *before, double value, const char *after)
{
    char text[DIF_HTML_NUMBER_SIZE];
    dif_html_plain(value, "", text);
    fprintf(html, "%s%s%s", before, text, after);
}

static void cell_uncertain(FILE *html, double value, double uncertainty, const char *unit)
{
    char text[DIF_HTML_NUMBER_SIZE];
    dif_html_uncertain(value, uncertainty, unit, text);
    fprintf(html, "<td class=\"n\">%s</td>", text);
}

static void text_row(FILE *html, const char *label, const char *text)
{
    fprintf(html, "<tr><th>%s</th><td>", label);
    dif_html_text(html, text);
    fputs("</td></tr>\n", html);
}

static void number_row(FILE *html, const char *label, const json_t *doc, const char *path, int n_digit,
                       const char *unit)
{
    char text[DIF_HTML_NUMBER_SIZE];
    dif_html_number(dif_result_number(doc, path), n_digit, unit, text);
    text_row(html, label, text);
}

static void range_row(FILE *html, const char *label, const json_t *doc, const char *name, const char *unit)
{
    static const char *const ends[] = {"min", "max", "step"};
    char path[64], number[3][DIF_HTML_NUMBER_SIZE];
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "plan.%s_%s", name, ends[i]);
        dif_html_plain(dif_result_number(doc, path), i ? unit : "", number[i]);
    }
    snprintf(path, sizeof path, "plan.n_%s", strncmp(name, "angle", 5) == 0 ? "angle" : "lambda");
    fprintf(html, "<tr><th>%s</th><td>%s … %s, every %s", label, number[0], number[1], number[2]);
    say_count(html, " (", dif_result_number(doc, path), ")</td></tr>\n");
}

static void write_surface_facts(FILE *html, const json_t *doc)
{
    char x[DIF_HTML_NUMBER_SIZE], y[DIF_HTML_NUMBER_SIZE];
    fputs("<table class=\"wide\"><tbody>\n", html);
    dif_html_plain(dif_result_number(doc, "surface.size_x_um"), "µm", x);
    dif_html_plain(dif_result_number(doc, "surface.size_y_um"), "µm", y);
    fprintf(html, "<tr><th>Patch</th><td>%s × %s</td></tr>\n", x, y);
    number_row(html, "Height range", doc, "surface.range_nm", 5, "nm");
    number_row(html, "Height rms", doc, "surface.rms_nm", 4, "nm");
    dif_html_number(dif_result_number(doc, "surface.slope_x_rms"), 3, "", x);
    dif_html_number(dif_result_number(doc, "surface.slope_y_rms"), 3, "", y);
    fprintf(html, "<tr><th>Slope rms along x, y</th><td>%s, %s</td></tr>\n", x, y);
    number_row(html, "Largest slope", doc, "surface.slope_max", 3, "");
    if (dif_result_number(doc, "surface.step_nm") > 0.0)
        number_row(html, "Quantisation step", doc, "surface.step_nm", 3, "nm");
    fputs("</tbody></table>\n", html);
}

void dif_part_conditions(FILE *html, const json_t *doc)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE];
    const bool fixed_is_i = strcmp(dif_result_text(doc, "plan.fixed"), "theta_i") == 0;
    fputs("<div class=\"pair\">\n", html);
    write_surface_facts(html, doc);
    fputs("<table class=\"wide\"><tbody>\n", html);
    dif_html_plain(dif_result_number(doc, "plan.fixed_deg"), "", a);
    dif_html_plain(dif_result_number(doc, "plan.azimuth_deg"), "", b);
    fprintf(html, "<tr><th>%s</th><td>θ<sub>%s</sub> = %s°, plane at azimuth %s°</td></tr>\n",
            fixed_is_i ? "Incidence" : "Detector", fixed_is_i ? "i" : "r", a, b);
    range_row(html, fixed_is_i ? "Reflection" : "Incidence", doc, "angle_deg", "°");
    range_row(html, "Wavelength", doc, "lambda_nm", "nm");
    text_row(html, "Quantity", dif_result_text(doc, "plan.quantity_text"));
    text_row(html, "Coherence window", dif_result_text(doc, "plan.window_text"));
    dif_html_plain(dif_result_number(doc, "plan.index_n"), "", a);
    dif_html_plain(dif_result_number(doc, "plan.index_kappa"), "", b);
    fprintf(html, "<tr><th>Refractive index</th><td>%s + %s i</td></tr>\n", a, b);
    fputs("</tbody></table>\n</div>\n", html);
}

/* One fit: period with both uncertainties and the stated one. */
static void write_fit_row(FILE *html, const json_t *doc, const char *name, const char *label)
{
    char path[64];
    const json_t *fit = dif_result_at(doc, name);
    fprintf(html, "<tr><td>%s", label);
    snprintf(path, sizeof path, "%s.note", name);
    if (*dif_result_text(doc, path)) {
        fputs("<br><small>", html);
        dif_html_text(html, dif_result_text(doc, path));
        fputs("</small>", html);
    }
    fputs("</td>", html);
    if (!dif_result_true(fit, "ok")) {
        const bool has_known = isfinite(dif_result_number(doc, "known.period_nm"));
        fprintf(html, "<td colspan=\"%d\">no period: ", has_known ? 6 : 4);
        dif_html_text(html, dif_result_text(fit, "text"));
        fputs("</td></tr>\n", html);
        return;
    }
    const double period = dif_result_number(fit, "period_nm"), u = dif_result_number(fit, "u_nm");
    cell_uncertain(html, period, u, "nm");
    cell(html, dif_result_number(fit, "u_covariance_nm"), 2, "nm");
    cell(html, dif_result_number(fit, "u_scatter_nm"), 2, "nm");
    cell(html, dif_result_number(fit, "u_model_nm"), 2, "nm");
    const double off = period - dif_result_number(doc, "known.period_nm");
    if (isfinite(off)) {
        cell(html, off, 2, "nm");
        cell(html, dif_result_true(doc, "known.exact") ? fabs(off) / u : (double)NAN, 2, "");
    }
    fputs("</tr>\n", html);
}

static void write_first_order_row(FILE *html, const json_t *doc)
{
    const json_t *first = dif_result_at(doc, "maxima.first_order");
    if (!json_is_object(first))
        return;
    fputs("<tr><td>Mean of |m|λ/|sin θ<sub>i</sub> + sin θ<sub>r</sub>| at each wavelength’s largest value", html);
    say_count(html, " (", dif_result_number(first, "n"), ")");
    say_count(html, ", with m = ", dif_result_number(first, "order"), "</td>");
    const double period = dif_result_number(first, "mean_nm"), sd = dif_result_number(first, "sd_nm");
    cell(html, period, 6, "nm");
    fputs("<td class=\"n\">–</td>", html);
    char text[DIF_HTML_NUMBER_SIZE];
    dif_html_number(sd, 2, "nm", text);
    fprintf(html, "<td class=\"n\">sd %s</td><td class=\"n\">–</td>", text);
    const double off = period - dif_result_number(doc, "known.period_nm");
    if (isfinite(off)) {
        cell(html, off, 2, "nm");
        fputs("<td class=\"n\">–</td>", html);
    }
    fputs("</tr>\n", html);
}

void dif_part_periods(FILE *html, const json_t *doc)
{
    char text[DIF_HTML_NUMBER_SIZE];
    const double known = dif_result_number(doc, "known.period_nm");
    if (isfinite(known)) {
        dif_html_plain(known, "nm", text);
        fprintf(html, "<p>The surface was made with a period of <b>%s</b>%s.</p>\n", text,
                dif_result_true(doc, "known.exact") ? ""
                                                    : " on average; its rows are deliberately irregular, so this is a "
                                                      "guide and not a reference");
    }
    fprintf(html,
            "<table class=\"wide\"><thead><tr><th>Method</th><th class=\"n\">Period (stated)</th>"
            "<th class=\"n\">u, covariance</th><th class=\"n\">u, scatter</th><th class=\"n\">u, "
            "model</th>%s</tr></thead><tbody>\n",
            isfinite(known) ? "<th class=\"n\">deviation</th><th class=\"n\">|deviation| / u</th>" : "");
    write_fit_row(html, doc, "fit_table", "Ridge model on the table");
    write_fit_row(html, doc, "fit_surface", "Harmonic model on the heights");
    write_first_order_row(html, doc);
    fputs("</tbody><caption>", html);
    if (dif_result_true(doc, "fit_table.ok")) {
        dif_html_number(dif_result_number(doc, "fit_table.residual_share"), 2, "", text);
        say_count(html, "Ridge model: ", dif_result_number(doc, "fit_table.n_data"), " data, ");
        say_count(html, "", dif_result_number(doc, "fit_table.n_parameter"), " parameters, ridges: ");
        say_count(html, "", dif_result_number(doc, "fit_table.n_ridge"), ", ");
        say_count(html, "", dif_result_number(doc, "fit_table.n_iteration"), " iterations; residual rms ");
        fprintf(html, "%s of the data’s rms, recomputed outside the solver; ", text);
        say_count(html, "scatter over ", dif_result_number(doc, "fit_table.n_part"), " bands of wavelength; ");
        dif_html_number(dif_result_number(doc, "fit_table.f_min_per_um"), 2, "µm⁻¹", text);
        fprintf(html, "fitted without the mirror beam, |f| from %s", text);
        dif_html_number(dif_result_number(doc, "fit_table.f_max_per_um"), 2, "µm⁻¹", text);
        if (isfinite(dif_result_number(doc, "fit_table.f_max_per_um")))
            fprintf(html, " to %s", text);
        fputs(", ", html);
        say_count(html, "and up to ", dif_result_number(doc, "fit_table.angle_max_deg"), "°. ");
    }
    if (dif_result_true(doc, "fit_surface.ok")) {
        dif_html_uncertain(dif_result_number(doc, "fit_surface.psi_deg"),
                           dif_result_number(doc, "fit_surface.u_psi_deg"), "°", text);
        say_count(html, "Harmonic model, order ", dif_result_number(doc, "fit_surface.n_harmonic"), "");
        fprintf(html, ": groove normal at %s, residual rms ", text);
        dif_html_number(dif_result_number(doc, "fit_surface.residual_rms_nm"), 3, "nm", text);
        fputs(text, html);
        say_count(html, "; scatter over ", dif_result_number(doc, "fit_surface.n_part"), " bands of the scan. ");
    }
    fputs("The stated uncertainty is the largest of the three; “model” is what the last refinement of the ridge "
          "model moved the period by, or the covariance that counts a misfit common to all lines of a scan "
          "once.</caption></table>\n",
          html);
}

void dif_part_orders(FILE *html, const json_t *doc)
{
    const json_t *orders = dif_result_at(doc, "maxima.orders");
    size_t i;
    json_t *order;
    if (json_array_size(orders) == 0)
        return;
    fputs("<table><thead><tr><th class=\"n\">Order m</th><th class=\"n\">maxima</th><th class=\"n\">mean residual</th>"
          "<th class=\"n\">rms</th><th class=\"n\">worst</th><th class=\"n\">period from the maxima</th>"
          "<th class=\"n\">sd</th></tr></thead><tbody>\n",
          html);
    json_array_foreach(orders, i, order)
    {
        fputs("<tr>", html);
        cell_whole(html, dif_result_number(order, "order"));
        cell_whole(html, dif_result_number(order, "n"));
        cell(html, dif_result_number(order, "mean_deg"), 3, "°");
        cell(html, dif_result_number(order, "rms_deg"), 3, "°");
        cell(html, dif_result_number(order, "worst_deg"), 3, "°");
        cell(html, dif_result_number(order, "period_mean_nm"), 7, "nm");
        cell(html, dif_result_number(order, "period_sd_nm"), 2, "nm");
        fputs("</tr>\n", html);
    }
    fputs("</tbody><caption>Statistics of these maxima by order.</caption></table>\n", html);
}

void dif_part_ridges(FILE *html, const json_t *doc)
{
    const json_t *ridges = dif_result_at(doc, "fit_table.ridges");
    const bool common = dif_result_true(doc, "fit_table.common_period");
    size_t i;
    json_t *ridge;
    if (json_array_size(ridges) == 0) {
        fputs("<p class=\"note\">No ridge was fitted.</p>\n", html);
        return;
    }
    fprintf(html,
            "<table class=\"wide\"><thead><tr>%s<th class=\"n\">order</th><th class=\"n\">f</th>"
            "<th class=\"n\">period</th><th class=\"n\">u, covariance</th><th class=\"n\">u, scatter</th>"
            "<th class=\"n\">rms width in f</th><th class=\"n\">weight</th></tr></thead><tbody>\n",
            common ? "" : "<th>Ridge</th>");
    json_array_foreach(ridges, i, ridge)
    {
        const double covariance = dif_result_number(ridge, "u_covariance_nm");
        const double scatter = dif_result_number(ridge, "u_scatter_nm");
        fputs("<tr>", html);
        if (!common)
            fprintf(html, "<td>%c</td>", 'A' + (int)(i % 26));
        cell_whole(html, dif_result_number(ridge, "order"));
        cell_uncertain(html, dif_result_number(ridge, "f_per_um"), dif_result_number(ridge, "u_f_per_um"), "µm⁻¹");
        cell_uncertain(html, dif_result_number(ridge, "period_nm"), fmax(covariance, scatter), "nm");
        cell(html, covariance, 2, "nm");
        cell(html, scatter, 2, "nm");
        cell(html, dif_result_number(ridge, "width_per_um"), 3, "µm⁻¹");
        cell(html, 100.0 * dif_result_number(ridge, "weight"), 3, "%");
        fputs("</tr>\n", html);
    }
    fputs(
        "</tbody><caption>Fitted ridges, strongest first; weight is the share of the fitted power.</caption></table>\n",
        html);
}
