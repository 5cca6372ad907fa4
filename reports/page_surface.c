#include <math.h>
#include <string.h>

#include "reports/figures.h"
#include "reports/html.h"
#include "reports/page.h"
#include "reports/page_parts.h"

static void write_title(FILE *html, int number, const json_t *doc)
{
    fprintf(html, "<section>\n<h2 id=\"s%d\">%d. ", number, number);
    dif_html_text(html, dif_result_text(doc, "title"));
    fputs("</h2>\n<p class=\"lead\">", html);
    dif_html_text(html, dif_result_text(doc, "description"));
    fputs("</p>\n", html);
}

static dif_status write_surface(FILE *html, int number, const dif_result *result, dif_figure_notes *notes,
                                dif_error *err)
{
    const json_t *doc = result->doc;
    char prefix[32], text[DIF_HTML_NUMBER_SIZE];
    fprintf(html, "<h3 id=\"s%d-surface\">Surface</h3>\n<div class=\"pair\">\n<figure>", number);
    snprintf(prefix, sizeof prefix, "s%dh", number);
    dif_status status = dif_figure_height(result, prefix, html, notes, err);
    if (status != DIF_OK)
        return status;
    dif_html_number(dif_result_number(doc, "surface.pitch_x_nm"), 5, "nm", text);
    fprintf(html,
            "<figcaption><b>Heights</b> seen from above, %d × %d samples of %s; colour is height. The arrow shows "
            "which way light %stravels across the surface.",
            result->field.nx, result->field.ny, text,
            result->table.plan.fixed_is_wo ? "of a positive angle of incidence " : "");
    if (notes->height_outside > 0.0)
        fprintf(html, " %.2g %% of the picture is lower or higher than the colour scale and takes its end colours.",
                100.0 * notes->height_outside);
    fputs("</figcaption></figure>\n<figure>", html);
    snprintf(prefix, sizeof prefix, "s%dp", number);
    status = dif_figure_profile(result, prefix, html, notes, err);
    if (status != DIF_OK)
        return status;
    dif_html_number(notes->profile_um, 3, "µm", text);
    fprintf(html,
            "<figcaption><b>Profile</b> through the centre along the plane of incidence, %s long, heights "
            "exaggerated.</figcaption></figure>\n</div>\n",
            text);
    dif_part_conditions(html, doc);
    return DIF_OK;
}

static dif_status write_table(FILE *html, int number, const dif_result *result, dif_figure_notes *notes, dif_error *err)
{
    char prefix[32], low[DIF_HTML_NUMBER_SIZE];
    fprintf(html, "<h3 id=\"s%d-table\">Response table</h3>\n<figure>", number);
    snprintf(prefix, sizeof prefix, "s%dt", number);
    const dif_status status = dif_figure_table(result, prefix, html, notes, err);
    if (status != DIF_OK)
        return status;
    const bool common = dif_result_true(result->doc, "fit_table.common_period");
    dif_html_number(notes->low, 2, "", low);
    fprintf(html,
            "<figcaption><b>Angle-wavelength response</b>, logarithmic colour scale over six decades; values below "
            "%s take the darkest colour.",
            low);
    if (notes->n_cell_x > 1 || notes->n_cell_y > 1)
        fprintf(html, " A pixel shows the largest of %d × %d table cells.", notes->n_cell_x, notes->n_cell_y);
    fprintf(html, " Dots: the %d local maxima beside the mirror beam%s.", notes->n_maximum,
            notes->n_skipped
                ? " drawn (those at the edge of the table, and the weaker ones of a crowded table, are left "
                  "out)"
                : "");
    if (notes->n_curve && common)
        fputs(" Thin curves: the grating equation sin&nbsp;θ<sub>i</sub> + sin&nbsp;θ<sub>r</sub> = mλ/d for each "
              "order m of "
              "the fitted period; their orders stand on top.",
              html);
    else if (notes->n_curve)
        fputs(" Thin curves: the grating equation for each fitted ridge, lettered as in the list below.", html);
    else
        fputs(" No grating-equation curve is drawn, because no period was fitted.", html);
    fputs("</figcaption></figure>\n", html);
    return DIF_OK;
}

static dif_status write_period(FILE *html, int number, const dif_result *result, dif_figure_notes *notes,
                               dif_error *err)
{
    char prefix[32];
    fprintf(html, "<h3 id=\"s%d-period\">Period</h3>\n", number);
    dif_part_periods(html, result->doc);
    snprintf(prefix, sizeof prefix, "s%dr", number);
    fputs("<figure>", html);
    const dif_status status = dif_figure_residuals(result, prefix, html, notes, err);
    if (status != DIF_OK)
        return status;
    fputs("<figcaption><b>Residuals of the maxima</b> that lie on a line of the fitted period: angle found minus the "
          "angle that the grating equation gives for "
          "the "
          "fitted period, by order. Small dots: one maximum each, coloured by wavelength. Squares: mean of the order, "
          "with its standard deviation. Plain maxima sit beside the line’s centre because gain and amplitude change "
          "across the line; the fit models that and does not use them.",
          html);
    fprintf(html, " %d of the %d maxima lie on a line.", notes->n_residual, result->maxima.n_row);
    if (notes->n_far > 0)
        fprintf(html, " %d of them lie beyond the plot.", notes->n_far);
    fputs("</figcaption></figure>\n", html);
    dif_part_orders(html, result->doc);
    return DIF_OK;
}

static dif_status write_lines(FILE *html, int number, const dif_result *result, dif_error *err)
{
    char prefix[32];
    const bool common = dif_result_true(result->doc, "fit_table.common_period");
    fprintf(html, "<h3 id=\"s%d-lines\">Spectral lines</h3>\n<figure>", number);
    snprintf(prefix, sizeof prefix, "s%dl", number);
    const dif_status status = dif_figure_lines(result, prefix, html, err);
    if (status != DIF_OK)
        return status;
    fprintf(html,
            "<figcaption><b>The table folded to spatial frequency</b>: mean normalised power of all angles and "
            "wavelengths that share one f, on which order m of a period d lies at m/d for every wavelength. "
            "Broken lines: the fitted ridges%s.</figcaption></figure>\n",
            common ? ", marked by their orders" : ", lettered as in the list below");
    dif_part_ridges(html, result->doc);
    return DIF_OK;
}

dif_status dif_page_surface(FILE *html, int number, const dif_result *result, dif_error *err)
{
    dif_figure_notes notes = {0};
    const json_t *doc = result->doc;
    write_title(html, number, doc);
    dif_status status = write_surface(html, number, result, &notes, err);
    if (status == DIF_OK)
        status = write_table(html, number, result, &notes, err);
    if (status == DIF_OK)
        status = write_period(html, number, result, &notes, err);
    if (status == DIF_OK)
        status = write_lines(html, number, result, err);
    if (status == DIF_OK)
        status = dif_part_map(html, number, result, err);
    if (status != DIF_OK)
        return status;
    if (json_is_object(dif_result_at(doc, "methods"))) {
        fprintf(html, "<h3 id=\"s%d-methods\">Methods compared</h3>\n", number);
        dif_part_methods(html, doc);
    }
    dif_part_gpu(html, number, doc);
    status = dif_part_render(html, number, result, err);
    if (status != DIF_OK)
        return status;
    status = dif_part_slopes(html, number, result, err);
    if (status != DIF_OK)
        return status;
    fprintf(html, "<h3 id=\"s%d-accuracy\">Accuracy</h3>\n", number);
    dif_part_accuracy(html, doc);
    fprintf(html, "<h3 id=\"s%d-energy\">Energy and order powers</h3>\n", number);
    dif_part_energy(html, doc);
    dif_part_order_powers(html, doc);
    fprintf(html, "<h3 id=\"s%d-trust\">How far to trust it</h3>\n", number);
    dif_part_trust(html, doc);
    dif_part_timings(html, doc);
    status = dif_part_study(html, number, result, err);
    if (status != DIF_OK)
        return status;
    fprintf(html, "<h3 id=\"s%d-provenance\">Provenance</h3>\n", number);
    dif_page_provenance(html, dif_result_at(doc, "provenance"));
    fputs("</section>\n", html);
    return DIF_OK;
}
