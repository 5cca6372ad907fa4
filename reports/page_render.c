/* The section of a surface's rendering. */
#include "reports/figures.h"
#include "reports/html.h"
#include "reports/page_parts.h"

dif_status dif_part_render(FILE *html, int number, const dif_result *result, dif_error *err)
{
    const json_t *render = dif_result_at(result->doc, "render");
    char a[DIF_HTML_NUMBER_SIZE], b[DIF_HTML_NUMBER_SIZE], c[DIF_HTML_NUMBER_SIZE];
    dif_picture picture;
    if (!json_is_object(render))
        return DIF_OK;
    const dif_status status = dif_picture_load(result, dif_result_text(render, "picture"), &picture, err);
    if (status != DIF_OK)
        return status;
    fprintf(html, "<h3 id=\"s%d-render\">Rendering</h3>\n<figure>", number);
    dif_figure_picture(&picture, "A coiled snake that wears the surface", html);
    dif_picture_free(&picture);
    dif_html_plain(dif_result_number(render, "source_deg"), "°", a);
    dif_html_plain(dif_result_number(render, "groove_deg"), "°", b);
    dif_html_number(dif_result_number(render, "exposure"), 3, "", c);
    fprintf(
        html,
        "<figcaption><b>Worn by a coiled snake</b>, two suns of %s: the relative BRDF from the wavelength-integrated "
        "table, in the body’s tangent frame; the patch is turned by %s, so that its y axis points to the tail. ",
        a, b);
    dif_html_plain(dif_result_number(render, "azimuths"), "", a);
    dif_html_plain(dif_result_number(render, "radii"), "", b);
    fprintf(html, "Table of %s azimuths × %s radii × ", a, b);
    dif_html_plain(dif_result_number(render, "maps"), "", a);
    fprintf(html,
            "%s maps; times %s: 2&nbsp;%% of the pixels are above white. Drawn on the CPU, no cast "
            "shadows.</figcaption></figure>\n",
            a, c);
    return DIF_OK;
}
