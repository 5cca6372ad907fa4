/* Pictures of a comparison: a table with its axes or a disc of directions, and a ring around the worst place. */
#include <math.h>

#include "reports/figures.h"
#include "reports/html.h"

/* Where the picture lies in its SVG. */
typedef struct frame {
    double width, height, x, y, w, h;
} frame;

static const frame TABLE = {380, 240, 44, 10, 326, 194}, DISC = {260, 260, 10, 10, 240, 240};

static void write_ring(const frame *f, const json_t *at, FILE *html)
{
    const double x = dif_result_number(at, "x"), y = dif_result_number(at, "y");
    if (!isfinite(x) || !isfinite(y))
        return;
    fprintf(html,
            "<g fill=\"none\"><circle cx=\"%.1f\" cy=\"%.1f\" r=\"9\" stroke=\"#000\" stroke-opacity=\"0.7\" "
            "stroke-width=\"4\"/><circle cx=\"%.1f\" cy=\"%.1f\" r=\"9\" stroke=\"#fff\" stroke-width=\"1.8\"/></g>\n",
            f->x + x * f->w, f->y + y * f->h, f->x + x * f->w, f->y + y * f->h);
}

static void write_label(FILE *html, double x, double y, const char *anchor, const char *text)
{
    fprintf(html, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\" font-size=\"11\" fill=\"#222\">%s</text>\n", x, y,
            anchor, text);
}

/* Ends and middle of both axes. */
static void write_axes(const frame *f, const json_t *axes, FILE *html)
{
    char text[DIF_HTML_NUMBER_SIZE];
    double end[4];
    for (size_t i = 0; i < 4; i++)
        end[i] = json_number_value(json_array_get(axes, i));
    for (int i = 0; i <= 2; i++) {
        dif_html_plain(end[0] + 0.5 * i * (end[1] - end[0]), "°", text);
        write_label(html, f->x + 0.5 * i * f->w, f->y + f->h + 15, i == 0 ? "start" : i == 1 ? "middle" : "end", text);
        dif_html_plain(end[2] + 0.5 * i * (end[3] - end[2]), "", text);
        write_label(html, f->x - 5, f->y + f->h * (1.0 - 0.5 * i) + (i == 0 ? 0.0 : i == 1 ? 4.0 : 9.0), "end", text);
    }
    write_label(html, f->x + f->w, f->y + f->h + 29, "end", "angle of the detector; wavelength in nm");
    fprintf(html,
            "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" fill=\"none\" stroke=\"#444\" stroke-width=\"0.8\"/>\n",
            f->x, f->y, f->w, f->h);
}

void dif_figure_compared(const dif_picture *picture, const json_t *axes, const json_t *at, const char *label,
                         const char *prefix, FILE *html)
{
    const bool table = json_array_size(axes) == 4;
    const frame *f = table ? &TABLE : &DISC;
    const double r = 0.5 * f->w;
    fprintf(html, "<svg role=\"img\" viewBox=\"0 0 %g %g\" aria-label=\"", f->width, f->height);
    dif_html_text(html, label);
    fputs("\">\n", html);
    if (!table)
        fprintf(html, "<clipPath id=\"%s\"><circle cx=\"%g\" cy=\"%g\" r=\"%g\"/></clipPath>\n", prefix, f->x + r,
                f->y + r, r);
    fprintf(html, "<image x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" preserveAspectRatio=\"none\" ", f->x, f->y, f->w,
            f->h);
    if (!table)
        fprintf(html, "clip-path=\"url(#%s)\" ", prefix);
    fputs("style=\"image-rendering:pixelated\" href=\"data:image/png;base64,", html);
    dif_figure_base64(picture->png, picture->n, html);
    fputs("\"/>\n", html);
    if (table)
        write_axes(f, axes, html);
    else
        fprintf(html, "<circle cx=\"%g\" cy=\"%g\" r=\"%g\" fill=\"none\" stroke=\"#444\" stroke-width=\"0.8\"/>\n",
                f->x + r, f->y + r, r);
    write_ring(f, at, html);
    fputs("</svg>\n", html);
}

void dif_figure_difference_bar(double low, double high, const char *prefix, FILE *html)
{
    static const char *const colours[] = {"#000004", "#280b53", "#65156e", "#9f2a63",
                                          "#d44842", "#f57d15", "#fac228", "#fcffa4"}; /* inferno at eighths */
    const int n = sizeof colours / sizeof *colours;
    char text[DIF_HTML_NUMBER_SIZE];
    fprintf(html,
            "<svg role=\"img\" class=\"scale\" viewBox=\"0 0 380 30\" aria-label=\"scale of the difference\">"
            "<linearGradient id=\"%s\">",
            prefix);
    for (int i = 0; i < n; i++)
        fprintf(html, "<stop offset=\"%.4f\" stop-color=\"%s\"/>", (double)i / (n - 1), colours[i]);
    fprintf(html,
            "</linearGradient>\n<rect x=\"44\" y=\"2\" width=\"326\" height=\"10\" fill=\"url(#%s)\" stroke=\"#444\" "
            "stroke-width=\"0.6\"/>\n",
            prefix);
    dif_html_number(low, 1, "", text);
    write_label(html, 44, 26, "start", text);
    dif_html_number(sqrt(low * high), 1, "", text);
    write_label(html, 207, 26, "middle", text);
    dif_html_number(high, 1, "", text);
    write_label(html, 370, 26, "end", text);
    fputs("</svg>\n", html);
}
