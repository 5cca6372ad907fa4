/* The section of slopes, normals and distant views of a surface. */
#include <math.h>

#include "reports/figures.h"
#include "reports/html.h"
#include "reports/page_parts.h"

static const char *digits(const json_t *doc, const char *path, int n_digit, const char *unit,
                          char text[DIF_HTML_NUMBER_SIZE])
{
    dif_html_number(dif_result_number(doc, path), n_digit, unit, text);
    return text;
}

static dif_status write_figure(FILE *html, const dif_result *result, const char *name, const char *label,
                               dif_error *err)
{
    dif_picture picture;
    const dif_status status = dif_picture_load(result, name, &picture, err);
    if (status != DIF_OK)
        return status;
    fputs("<figure>", html);
    dif_figure_picture(&picture, label, html);
    dif_picture_free(&picture);
    return DIF_OK;
}

static dif_status write_slopes(FILE *html, const dif_result *result, const json_t *slopes, dif_error *err)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE], c[DIF_HTML_NUMBER_SIZE];
    const dif_status status =
        write_figure(html, result, dif_result_text(slopes, "picture"),
                     "Histograms of all slopes, of those seen, and the Gaussian that stands for them", err);
    if (status != DIF_OK)
        return status;
    dif_html_plain(dif_result_number(slopes, "theta_deg"), "°", a);
    dif_html_plain(0.01 * rint(100.0 * dif_result_number(slopes, "azimuth_deg")), "°", b);
    fprintf(html,
            "<figcaption><b>Slopes</b> of all cells of 2 × 2 samples; those of them that are seen from %s at azimuth "
            "%s, where facets turned away are hidden and those turned towards the viewer count more; and the Gaussian "
            "that mean and covariance of all slopes give for them in closed form. ",
            a, b);
    fprintf(html,
            "The two overlap by %s; the visible area per area of the mean plane is %s, by the Gaussian %s. Where they "
            "differ, slopes are not Gaussian.</figcaption></figure>\n",
            (dif_html_number(100.0 * dif_result_number(slopes, "overlap"), 3, "%", c), c),
            digits(slopes, "seen_area", 4, "", a), digits(slopes, "gaussian_area", 4, "", b));
    return DIF_OK;
}

static dif_status write_normals(FILE *html, const dif_result *result, const json_t *slopes, dif_error *err)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE], c[DIF_HTML_NUMBER_SIZE];
    const dif_status status = write_figure(html, result, dif_result_text(slopes, "picture_normals"),
                                           "Distribution of normals, its masking, and what Smith's differs", err);
    if (status != DIF_OK)
        return status;
    fprintf(html,
            "<figcaption><b>Normals</b> over the hemisphere, seen from above (direction cosines, y up), normalised so "
            "that ∫ D cos θ dω = 1; the masking G(k) = cos θ<sub>k</sub> / ∫ max(0, k·h) D(h) dω<sub>h</sub> that "
            "follows from them; and its difference from Smith’s for Gaussian slopes of the same covariance. ");
    fprintf(html,
            "Towards the direction above they are %s and %s; up to 85° they differ by at most %s. Shadowing is not "
            "part of the table above.</figcaption></figure>\n",
            digits(slopes, "masking_ndf", 4, "", a), digits(slopes, "masking_smith", 4, "", b),
            digits(slopes, "masking_worst", 2, "", c));
    return DIF_OK;
}

static dif_status write_view(FILE *html, const dif_result *result, const json_t *slopes, dif_error *err)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE], c[DIF_HTML_NUMBER_SIZE], side[DIF_HTML_NUMBER_SIZE];
    const dif_status status =
        write_figure(html, result, dif_result_text(slopes, "picture_view"), "Four views of the heights from afar", err);
    if (status != DIF_OK)
        return status;
    dif_html_plain(1.0 / dif_result_number(slopes, "zoom"), "", side);
    dif_html_plain(dif_result_number(slopes, "samples"), "", c);
    fprintf(html,
            "<figcaption><b>The heights from afar</b>, %s × %s samples a pixel: without a filter, the colour of the "
            "mean height, the mean colour of a Gaussian of the heights that a pixel covers, and %s × %s jittered "
            "samples a pixel as the truth. ",
            side, side, c, c);
    fprintf(html, "Mean difference from the truth, CIEDE2000: %s, %s and %s.</figcaption></figure>\n",
            digits(slopes, "point.de_mean", 2, "", a), digits(slopes, "mean.de_mean", 2, "", b),
            digits(slopes, "filtered.de_mean", 2, "", c));
    return DIF_OK;
}

dif_status dif_part_slopes(FILE *html, int number, const dif_result *result, dif_error *err)
{
    const json_t *slopes = dif_result_at(result->doc, "slopes");
    if (!json_is_object(slopes))
        return DIF_OK;
    fprintf(html, "<h3 id=\"s%d-slopes\">Slopes, normals and the view from afar</h3>\n", number);
    dif_status status = write_slopes(html, result, slopes, err);
    if (status == DIF_OK)
        status = write_normals(html, result, slopes, err);
    return status == DIF_OK ? write_view(html, result, slopes, err) : status;
}
