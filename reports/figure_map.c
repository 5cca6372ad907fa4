#include <math.h>

#include "core/units.h"
#include "reports/figures.h"
#include "reports/html.h"

/* The picture of a hemisphere in an SVG of WIDTH x HEIGHT: a disc of RADIUS around the middle. */
enum { WIDTH = 560, HEIGHT = 480, CENTRE_X = 248, CENTRE_Y = 240, RADIUS = 206, RING_DEG = 15, BAR_X = 530 };

void dif_figure_base64(const unsigned char *data, size_t n, FILE *html)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < n; i += 3) {
        const unsigned a = data[i], b = i + 1 < n ? data[i + 1] : 0, c = i + 2 < n ? data[i + 2] : 0;
        const char out[4] = {digits[a >> 2], digits[(a & 3) << 4 | b >> 4],
                             i + 1 < n ? digits[(b & 15) << 2 | c >> 6] : '=', i + 2 < n ? digits[c & 63] : '='};
        fwrite(out, 1, sizeof out, html);
    }
}

/* A picture clipped to a disc, with its rim. */
static void write_disc(const dif_picture *picture, const char *prefix, double cx, double cy, double r, FILE *html)
{
    fprintf(html,
            "<clipPath id=\"%s-disc\"><circle cx=\"%g\" cy=\"%g\" r=\"%g\"/></clipPath>\n"
            "<image clip-path=\"url(#%s-disc)\" x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" "
            "preserveAspectRatio=\"none\" href=\"data:image/png;base64,",
            prefix, cx, cy, r, prefix, cx - r, cy - r, 2.0 * r, 2.0 * r);
    dif_figure_base64(picture->png, picture->n, html);
    fprintf(html, "\"/>\n<circle cx=\"%g\" cy=\"%g\" r=\"%g\" fill=\"none\" stroke=\"#444\" stroke-width=\"0.8\"/>\n",
            cx, cy, r);
}

/* A number on the picture. */
static void write_mark(FILE *html, double x, double y, const char *text)
{
    fprintf(html,
            "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\" dominant-baseline=\"central\" font-size=\"10.5\" "
            "fill=\"#fff\" "
            "stroke=\"#000\" stroke-opacity=\"0.55\" stroke-width=\"2.4\" paint-order=\"stroke\">%s</text>\n",
            x, y, text);
}

/* Rings of equal polar angle, numbered across the plane of incidence, and azimuths around the rim. */
static void write_rings(double azimuth_rad, FILE *html)
{
    char text[32];
    for (int deg = RING_DEG; deg < 90; deg += RING_DEG) {
        const double r = RADIUS * sin(dif_rad_from_deg(deg)), across = azimuth_rad + 0.5 * DIF_PI;
        fprintf(html,
                "<circle cx=\"%d\" cy=\"%d\" r=\"%.2f\" fill=\"none\" stroke=\"#fff\" stroke-opacity=\"0.38\" "
                "stroke-width=\"0.7\"/>\n",
                CENTRE_X, CENTRE_Y, r);
        snprintf(text, sizeof text, "%d°", deg);
        write_mark(html, CENTRE_X + r * cos(across), CENTRE_Y - r * sin(across), text);
    }
    for (int deg = 0; deg < 360; deg += 90) {
        const double r = RADIUS + 16.0;
        fprintf(html,
                "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\" dominant-baseline=\"central\" font-size=\"12\" "
                "fill=\"#222\">%s%d°</text>\n",
                CENTRE_X + r * cos(dif_rad_from_deg(deg)), CENTRE_Y - r * sin(dif_rad_from_deg(deg)),
                deg == 0 ? "φ " : "", deg);
    }
}

/* Where the light comes from (cross) and where a mirror would send it (circle). */
static void write_light(const json_t *map, FILE *html)
{
    const double azimuth_rad = dif_rad_from_deg(dif_result_number(map, "azimuth_deg"));
    const double r = RADIUS * sin(dif_rad_from_deg(dif_result_number(map, "theta_i_deg")));
    const double dx = r * cos(azimuth_rad), dy = -r * sin(azimuth_rad);
    if (!isfinite(dx) || !isfinite(dy))
        return;
    fprintf(html,
            "<g fill=\"none\" stroke-linecap=\"round\"><g stroke=\"#000\" stroke-opacity=\"0.55\" stroke-width=\"4\">"
            "<path d=\"M%.1f,%.1fl10,10m0,-10l-10,10\"/><circle cx=\"%.1f\" cy=\"%.1f\" r=\"8\"/></g>"
            "<g stroke=\"#fff\" stroke-width=\"1.6\">"
            "<path d=\"M%.1f,%.1fl10,10m0,-10l-10,10\"/><circle cx=\"%.1f\" cy=\"%.1f\" r=\"8\"/></g></g>\n",
            CENTRE_X + dx - 5.0, CENTRE_Y + dy - 5.0, CENTRE_X - dx, CENTRE_Y - dy, CENTRE_X + dx - 5.0,
            CENTRE_Y + dy - 5.0, CENTRE_X - dx, CENTRE_Y - dy);
}

/* The scale of the luminance picture. */
static void write_bar(const json_t *map, const char *prefix, FILE *html)
{
    static const char *const colours[] = {"#440154", "#46327e", "#365c8d", "#277f8e",
                                          "#1fa187", "#4ac16d", "#a0da39", "#fde725"}; /* viridis at eighths */
    const int n = sizeof colours / sizeof *colours, top = CENTRE_Y - RADIUS + 26, height = 2 * RADIUS - 52;
    const double decades = dif_result_number(map, "level_decades");
    fprintf(html, "<linearGradient id=\"%s-bar\" x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\">", prefix);
    for (int i = 0; i < n; i++)
        fprintf(html, "<stop offset=\"%.4f\" stop-color=\"%s\"/>", (double)i / (n - 1), colours[i]);
    fprintf(
        html,
        "</linearGradient>\n<rect x=\"%d\" y=\"%d\" width=\"14\" height=\"%d\" fill=\"url(#%s-bar)\" stroke=\"#444\" "
        "stroke-width=\"0.6\"/>\n<text x=\"%d\" y=\"%d\" text-anchor=\"end\" font-size=\"12\" fill=\"#222\">Y / "
        "largest</text>\n",
        BAR_X, top, height, prefix, BAR_X + 30, top - 14);
    for (int i = 0; isfinite(decades) && i <= (int)decades && i < 16; i++) {
        const double y = top + height * i / decades;
        fprintf(html,
                "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\" dominant-baseline=\"central\" font-size=\"12\" "
                "fill=\"#222\">10<tspan dy=\"-5\" font-size=\"8.5\">%s%d</tspan></text>\n",
                BAR_X - 4, y, i ? "−" : "", i);
    }
}

void dif_figure_map(const dif_picture *picture, const json_t *map, bool is_level, const char *prefix, FILE *html)
{
    fprintf(html, "<svg role=\"img\" aria-label=\"%s\" viewBox=\"0 0 %d %d\" font-family=\"sans-serif\">\n",
            is_level ? "Luminance of every reflected direction" : "Colours of every reflected direction", WIDTH,
            HEIGHT);
    write_disc(picture, prefix, CENTRE_X, CENTRE_Y, RADIUS, html);
    const double azimuth_rad = dif_rad_from_deg(dif_result_number(map, "azimuth_deg"));
    write_rings(isfinite(azimuth_rad) ? azimuth_rad : 0.0, html);
    write_light(map, html);
    if (is_level)
        write_bar(map, prefix, html);
    fputs("</svg>\n", html);
}

void dif_figure_small_map(const dif_picture *picture, const char *label, const char *prefix, FILE *html)
{
    fputs("<svg role=\"img\" aria-label=\"BRDF map, ", html);
    dif_html_text(html, label);
    fputs("\" viewBox=\"0 0 150 150\">\n", html);
    write_disc(picture, prefix, 75.0, 75.0, 73.0, html);
    fputs("</svg>\n", html);
}

void dif_figure_picture(const dif_picture *picture, const char *label, FILE *html)
{
    fputs("<svg role=\"img\" aria-label=\"", html);
    dif_html_text(html, label);
    fprintf(html,
            "\" viewBox=\"0 0 %d %d\">\n<image x=\"0\" y=\"0\" width=\"%d\" height=\"%d\" "
            "href=\"data:image/png;base64,",
            picture->nx, picture->ny, picture->nx, picture->ny);
    dif_figure_base64(picture->png, picture->n, html);
    fputs("\"/>\n</svg>\n", html);
}
