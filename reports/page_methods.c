/* The BRDF map's and the methods' sections of a surface. */
#include <math.h>
#include <string.h>

#include "reports/figures.h"
#include "reports/html.h"
#include "reports/page_parts.h"

static const char *plain(const json_t *doc, const char *path, const char *unit, char text[DIF_HTML_NUMBER_SIZE])
{
    dif_html_plain(dif_result_number(doc, path), unit, text);
    return text;
}

static const char *digits(double value, int n_digit, const char *unit, char text[DIF_HTML_NUMBER_SIZE])
{
    dif_html_number(value, n_digit, unit, text);
    return text;
}

static void write_colour_caption(FILE *html, const json_t *map)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE], c[DIF_HTML_NUMBER_SIZE];
    dif_html_plain(0.01 * rint(100.0 * dif_result_number(map, "azimuth_deg")), "°", b);
    fprintf(
        html,
        "<figcaption><b>Colours of all reflected directions</b> for daylight (D65) from θ<sub>i</sub> = %s at azimuth "
        "%s (cross); the circle is the mirror direction. ",
        plain(map, "theta_i_deg", "°", a), b);
    fprintf(html,
            "A direction stands at its cosines: x to the right, y up, radius sin&nbsp;θ<sub>r</sub>, rings every 15°. "
            "Relative BRDF at %s wavelengths (every %s) to XYZ, ",
            plain(map, "n_lambda", "", a), plain(map, "lambda_nm_step", "nm", b));
    fprintf(html,
            "times %s: the brightest pixels outside the mirror beam, which hold %s of the light there, are white. ",
            digits(dif_result_number(map, "exposure"), 3, "", a),
            digits(100.0 * dif_result_number(map, "white_share"), 2, "%", c));
    const bool clip = strcmp(dif_result_text(map, "gamut"), "clip") == 0;
    fprintf(html, "sRGB; %s of the pixels shown lie outside its gamut and are %s.</figcaption>",
            digits(100.0 * dif_result_number(map, "outside_gamut"), 2, "%", a),
            clip ? "clipped" : "mixed with the grey of the same luminance until they fit");
}

dif_status dif_part_map(FILE *html, int number, const dif_result *result, dif_error *err)
{
    const json_t *map = dif_result_at(result->doc, "map");
    char prefix[32], text[DIF_HTML_NUMBER_SIZE];
    dif_picture colours = {0}, level = {0};
    if (!json_is_object(map))
        return DIF_OK;
    dif_status status = dif_picture_load(result, dif_result_text(result->doc, "files.map"), &colours, err);
    if (status == DIF_OK)
        status = dif_picture_load(result, dif_result_text(result->doc, "files.map_level"), &level, err);
    if (status == DIF_OK) {
        fprintf(html, "<h3 id=\"s%d-map\">BRDF map</h3>\n<div class=\"pair\">\n<figure>", number);
        snprintf(prefix, sizeof prefix, "s%dm", number);
        dif_figure_map(&colours, map, false, prefix, html);
        write_colour_caption(html, map);
        fputs("</figure>\n<figure>", html);
        snprintf(prefix, sizeof prefix, "s%dn", number);
        dif_figure_map(&level, map, true, prefix, html);
        fprintf(
            html,
            "<figcaption><b>Luminance of the same map</b> on a logarithmic scale, which shows what the picture on the "
            "left leaves dark; the largest is %s",
            digits(dif_result_number(map, "luminance_max"), 3, "", text));
        fprintf(html, " of a mirror’s white. Amplitudes to %s of the largest possible",
                digits(dif_result_number(map, "tol"), 1, "", text));
        if (dif_result_number(map, "n_window") > 1.0)
            fprintf(html, ", powers of %s windows averaged", plain(map, "n_window", "", text));
        fputs(".</figcaption></figure>\n</div>\n", html);
    }
    dif_picture_free(&colours);
    dif_picture_free(&level);
    return status;
}

static void cell(FILE *html, const json_t *row, const char *key, int n_digit, const char *unit)
{
    char text[DIF_HTML_NUMBER_SIZE];
    fprintf(html, "<td class=\"n\">%s</td>", digits(dif_result_number(row, key), n_digit, unit, text));
}

/* Seconds as ms below one. */
static void cell_time(FILE *html, double s)
{
    char text[DIF_HTML_NUMBER_SIZE];
    fprintf(html, "<td class=\"n\">%s</td>", s < 1.0 ? digits(1e3 * s, 2, "ms", text) : digits(s, 2, "s", text));
}

static void write_method(FILE *html, const json_t *row, bool has_time)
{
    char a[DIF_HTML_NUMBER_SIZE];
    fputs("<tr><td><b>", html);
    dif_html_text(html, dif_result_text(row, "name"));
    fputs("</b>", html);
    if (*dif_result_text(row, "leaves_out")) {
        fputs("<br><small>leaves out ", html);
        dif_html_text(html, dif_result_text(row, "leaves_out"));
        fputs("</small>", html);
    }
    fputs("</td>", html);
    if (!dif_result_true(row, "ok")) {
        fprintf(html, "<td colspan=\"%d\">not measured: ", has_time ? 8 : 7);
        dif_html_text(html, dif_result_text(row, "text"));
        fputs("</td></tr>\n", html);
        return;
    }
    const double mean = dif_result_number(row, "maxima_nm");
    fprintf(html, "<td class=\"n\">%s", digits(mean, mean >= 1000.0 ? 6 : 5, "nm", a));
    if (isfinite(mean))
        fprintf(html, "<br><small>sd %s</small>", digits(dif_result_number(row, "maxima_sd_nm"), 2, "nm", a));
    fputs("</td>", html);
    cell(html, row, "bound", 1, "");
    cell(html, row, "error_rms", 1, "");
    cell(html, row, "error_worst", 1, "");
    cell(html, row, "de_median", 2, "");
    cell(html, row, "de_p95", 2, "");
    cell(html, row, "de_worst", 2, "");
    if (has_time)
        cell_time(html, dif_result_number(row, "wall_s"));
    fputs("</tr>\n", html);
}

static const json_t *method_named(const json_t *methods, const char *name)
{
    size_t i;
    json_t *row;
    json_array_foreach(dif_result_at(methods, "rows"), i, row)
    {
        if (strcmp(dif_result_text(row, "name"), name) == 0)
            return row;
    }
    return NULL;
}

/* What the numbers of this surface say, where they exist. */
static void write_findings(FILE *html, const json_t *methods)
{
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE], c[DIF_HTML_NUMBER_SIZE];
    const json_t *with = method_named(methods, "nmm"), *without = method_named(methods, "nmm without its Jacobian");
    const json_t *twice = method_named(methods, "taylor"), *single = method_named(methods, "taylor in float");
    if (isfinite(dif_result_number(with, "de_median")) && isfinite(dif_result_number(without, "de_median")))
        fprintf(
            html,
            " On this surface the median colour difference of <code>nmm</code> is %s with the Jacobian and %s without "
            "it, which also moves the mean chromaticity by (%s, ",
            digits(dif_result_number(with, "de_median"), 2, "", a),
            digits(dif_result_number(without, "de_median"), 2, "", b),
            digits(dif_result_number(without, "shift_x"), 2, "", c)),
            fprintf(html, "%s): towards purple if both are negative.",
                    digits(dif_result_number(without, "shift_y"), 2, "", a));
    if (isfinite(dif_result_number(single, "error_worst")) && isfinite(dif_result_number(twice, "error_worst")))
        fprintf(html, " Summed in float instead of double, the series is off by %s instead of %s.",
                digits(dif_result_number(single, "error_worst"), 1, "", a),
                digits(dif_result_number(twice, "error_worst"), 1, "", b));
}

static void write_advice(FILE *html, const json_t *methods)
{
    fputs("<p>Trust <code>sheet</code> and, at a higher price, <code>taylor</code> in double precision: both keep the "
          "full "
          "phase k·w·h of every direction and are exact to the tolerance asked for. The series loses digits as the "
          "surface "
          "gets deeper, because its terms grow to the exponential of the largest phase before they cancel, and in "
          "float the rounding of those terms can be all that is left of a deep "
          "surface, which the result does not tell. <code>thesis</code> finds the period "
          "of a "
          "perfect grating, because its lines stand at the right spatial frequencies, but without w their powers are "
          "those of "
          "the other side of incidence, and on a scan it reads one speckle pattern, from a window on the patch’s "
          "corner; do not "
          "take a period or a colour of a scan from it. <code>nmm</code> with its Jacobian gives good colours at a "
          "fraction of "
          "the wavelengths, as long as the coherence window fades out inside the patch; without the Jacobian short "
          "wavelengths "
          "count too much and pictures turn purple. <code>pq</code> is exact for a surface that is its one period and "
          "nothing "
          "else; replicating one period of an irregular surface sharpens its lines and moves them to multiples of the "
          "period "
          "that was put in. <code>stam</code> knows where orders lie and nothing about how strong they are.",
          html);
    write_findings(html, methods);
    fputs("</p>\n", html);
}

void dif_part_methods(FILE *html, const json_t *doc)
{
    const json_t *methods = dif_result_at(doc, "methods");
    const json_t *rows = dif_result_at(methods, "rows");
    size_t i;
    json_t *row;
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE], c[DIF_HTML_NUMBER_SIZE];
    bool has_time = false;
    json_array_foreach(rows, i, row) has_time = has_time || isfinite(dif_result_number(row, "wall_s"));
    fprintf(
        html,
        "<table class=\"wide methods\"><thead><tr><th rowspan=\"2\">Method</th><th class=\"n\" rowspan=\"2\">Period "
        "from "
        "maxima</th><th class=\"n\" colspan=\"3\">Amplitude error / ΣW</th><th class=\"n\" "
        "colspan=\"3\">ΔE<sub>2000</sub>, "
        "full sampling</th>%s</tr>\n<tr><th class=\"n\">bound</th><th class=\"n\">rms</th><th class=\"n\">worst</th>"
        "<th class=\"n\">median</th><th class=\"n\">95 %%</th><th class=\"n\">worst</th></tr></thead><tbody>\n",
        has_time ? "<th class=\"n\" rowspan=\"2\">Time</th>" : "");
    json_array_foreach(rows, i, row) write_method(html, row, has_time);
    fprintf(html,
            "</tbody><caption>The same surface and one coherence window at its centre by every method. Errors against "
            "the direct sum at %s random "
            "cells; ",
            plain(methods, "n_check", "", a));
    if (dif_result_true(methods, "first_order"))
        fprintf(html,
                "the table of each method holds the first order, %s to %s, and the period is the mean of "
                "λ/|sin&nbsp;θ<sub>i"
                "</sub> + sin&nbsp;θ<sub>r</sub>| at each wavelength’s largest value, with its standard deviation over "
                "wavelengths (plain maxima, as the source reads them; the fitted period stands above). ",
                digits(dif_result_number(methods, "angle_deg_min"), 4, "°", b),
                digits(dif_result_number(methods, "angle_deg_max"), 4, "°", c));
    else
        fputs("no period is known that the maxima could be read by. ", html);
    if (isfinite(dif_result_number(methods, "period_nm")))
        fprintf(html, "<code>pq</code> and <code>stam</code> were given %s. ",
                digits(dif_result_number(methods, "period_nm"), 7, "nm", a));
    fprintf(html, "Colours along the plane of incidence, every %s to ±%s, against full sampling every %s. ",
            plain(methods, "colour_deg_step", "°", a), plain(methods, "colour_deg_max", "°", b),
            plain(methods, "colour_nm_step", "nm", c));
    if (has_time)
        fputs("Time of the table; of the direct sum, extrapolated from the checked cells.", html);
    fputs("</caption></table>\n", html);
    write_advice(html, methods);
}
