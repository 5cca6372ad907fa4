#include "reports/page.h"

#include <math.h>
#include <string.h>

#include "reports/html.h"

/* Sections of a surface as the contents name them, and the part of the result that a section needs, if it may lack. */
static const struct {
    const char *id, *name, *needs;
} sections[] = {
    {"surface", "surface", NULL},      {"table", "response table", NULL}, {"period", "period", NULL},
    {"lines", "lines", NULL},          {"map", "BRDF map", "map"},        {"methods", "methods", "methods"},
    {"gpu", "GPU against CPU", "gpu"}, {"render", "rendering", "render"}, {"slopes", "slopes and views", "slopes"},
    {"accuracy", "accuracy", NULL},    {"energy", "energy", NULL},        {"trust", "trust", NULL},
    {"study", "studies", "study"},     {"provenance", "provenance", NULL}};

void dif_page_verdict(FILE *html, const json_t *verdict)
{
    const json_t *pass = dif_result_at(verdict, "pass");
    const char *kind = json_is_true(pass) ? "pass" : json_is_false(pass) ? "fail" : "none";
    const char *word = json_is_true(pass) ? "✓ pass" : json_is_false(pass) ? "✗ fail" : "– no reference";
    const double value = dif_result_number(verdict, "value"), limit = dif_result_number(verdict, "limit");
    char number[DIF_HTML_NUMBER_SIZE];
    fprintf(html, "<div class=\"v %s\"><b>%s</b>", kind, word);
    fputs(" ", html);
    dif_html_text(html, dif_result_text(verdict, "label"));
    if (isfinite(value)) {
        dif_html_number(value, 2, dif_result_text(verdict, "unit"), number);
        dif_html_text(html, number);
    }
    if (isfinite(limit)) {
        dif_html_number(limit, 2, dif_result_text(verdict, "unit"), number);
        fputs("<small>limit ", html);
        dif_html_text(html, number);
        fputs("</small>", html);
    }
    fputs("</div>", html);
}

static const json_t *verdict_named(const json_t *doc, const char *name)
{
    size_t i;
    json_t *verdict;
    json_array_foreach(dif_result_at(doc, "verdicts"), i, verdict)
    {
        if (strcmp(dif_result_text(verdict, "name"), name) == 0)
            return verdict;
    }
    return NULL;
}

/* Period cell: the fitted value, or why there is none. */
static void write_period(FILE *html, const json_t *doc)
{
    char number[DIF_HTML_NUMBER_SIZE];
    if (!dif_result_true(doc, "fit_table.ok")) {
        fputs("<td>not determined</td>", html);
        return;
    }
    dif_html_uncertain(dif_result_number(doc, "fit_table.period_nm"), dif_result_number(doc, "fit_table.u_nm"), "nm",
                       number);
    fprintf(html, "<td class=\"v\">%s</td>", number);
}

static void write_summary(FILE *html, const json_t *docs)
{
    static const char *const names[] = {"period", "error", "energy", "orders"};
    size_t i;
    json_t *doc;
    char number[DIF_HTML_NUMBER_SIZE];
    fputs("<h2 id=\"summary\">Summary</h2>\n<table class=\"wide\"><thead><tr><th>Surface</th><th>Fitted period</th>"
          "<th>Expected</th><th>Period<br>|deviation|</th><th>Amplitude error<br>against the direct sum</th>"
          "<th>Energy</th><th>Order powers<br>against closed form</th></tr></thead>\n<tbody>\n",
          html);
    json_array_foreach(docs, i, doc)
    {
        fprintf(html, "<tr><td><a href=\"#s%zu\">", i + 1);
        dif_html_text(html, dif_result_text(doc, "title"));
        fputs("</a></td>", html);
        write_period(html, doc);
        dif_html_plain(dif_result_number(doc, "known.period_nm"), "nm", number);
        const bool guide = json_is_object(dif_result_at(doc, "known")) && !dif_result_true(doc, "known.exact");
        fprintf(html, "<td class=\"v\">%s%s</td>", guide ? "about " : "", number);
        for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
            fputs("<td>", html);
            dif_page_verdict(html, verdict_named(doc, names[k]));
            fputs("</td>", html);
        }
        fputs("</tr>\n", html);
    }
    fputs(
        "</tbody><caption>Uncertainties are standard uncertainties (k&nbsp;=&nbsp;1), the largest of what the fit’s "
        "covariance, "
        "the scatter over disjoint parts of the data and the model’s own limits give. A period passes if it lies "
        "within twice its uncertainty "
        "(k&nbsp;=&nbsp;2, about 95&nbsp;%) of the value the surface was made with; an error passes if the largest one "
        "found is at most the tolerance asked for. "
        "“No reference” means that nothing independent is known to hold the number "
        "against.</caption></table>\n",
        html);
}

static void write_contents(FILE *html, const json_t *docs)
{
    size_t i;
    json_t *doc;
    fputs("<nav aria-label=\"Contents\"><h2 id=\"contents\">Contents</h2><ol>\n", html);
    json_array_foreach(docs, i, doc)
    {
        fprintf(html, "<li><a href=\"#s%zu\">", i + 1);
        dif_html_text(html, dif_result_text(doc, "title"));
        fputs("</a><ol>", html);
        for (size_t k = 0; k < sizeof sections / sizeof *sections; k++) {
            if (!sections[k].needs || json_is_object(dif_result_at(doc, sections[k].needs)))
                fprintf(html, "<li><a href=\"#s%zu-%s\">%s</a></li>", i + 1, sections[k].id, sections[k].name);
        }
        fputs("</ol></li>\n", html);
    }
    if (dif_page_has_published(docs))
        fputs("<li><a href=\"#published\">Beside the source’s published periods</a></li>\n", html);
    fputs("<li><a href=\"#conventions\">Conventions</a></li>\n"
          "<li><a href=\"#provenance\">Provenance of this report</a></li>\n</ol></nav>\n",
          html);
}

void dif_page_head(FILE *html, const json_t *list, const json_t *docs)
{
    const char *title = dif_result_text(list, "title");
    fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
          "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>",
          html);
    dif_html_text(html, title);
    fprintf(html, "</title>\n<style>\n%s</style>\n</head>\n<body>\n<h1>", dif_page_style());
    dif_html_text(html, title);
    fprintf(html, "</h1>\n<p class=\"lead\">Virtual diffraction measurement of %zu surface%s by scalar wave optics. ",
            json_array_size(docs), json_array_size(docs) == 1 ? "" : "s");
    dif_html_text(html, dif_result_text(list, "provenance.program"));
    fputs(" ", html);
    dif_html_text(html, dif_result_text(list, "provenance.version"));
    fputs(", ", html);
    dif_html_text(html, dif_result_text(list, "provenance.created"));
    fputs(".</p>\n", html);
    write_summary(html, docs);
    write_contents(html, docs);
}

void dif_page_provenance(FILE *html, const json_t *provenance)
{
    const char *key;
    json_t *value;
    char number[DIF_HTML_NUMBER_SIZE];
    fputs("<table class=\"prov\"><tbody>\n", html);
    json_object_foreach((json_t *)provenance, key, value)
    {
        fputs("<tr><th>", html);
        dif_html_text(html, key);
        fputs("</th><td>", html);
        if (json_is_number(value)) {
            dif_html_plain(json_number_value(value), "", number);
            dif_html_text(html, number);
        } else {
            dif_html_text(html, json_is_string(value) ? json_string_value(value) : "–");
        }
        fputs("</td></tr>\n", html);
    }
    fputs("</tbody></table>\n", html);
}

void dif_page_tail(FILE *html, const json_t *list)
{
    fputs(
        "<h2 id=\"conventions\">Conventions</h2>\n"
        "<p>Pictures are seen from above: x to the right, y up, row 0 of a file on top, z towards the viewer. Both "
        "angles "
        "are measured from the surface normal, signed within the plane of incidence, and positive towards the plane's "
        "azimuth; the mirror direction of light from θ<sub>i</sub> is θ<sub>r</sub> = −θ<sub>i</sub>. Orders follow "
        "sin θ<sub>i</sub> + sin θ<sub>m</sub> = mλ/d. The normalised power is p = |P/ΣW|², with the Kirchhoff sum "
        "P = Σ W exp(i k (u x + v y + w h)), the coherence window W and (u, v, w) = −(ω<sub>i</sub> + ω<sub>r</sub>). "
        "The relative BRDF is ρ = C p, where C holds the Fresnel reflectance relative to normal incidence and the "
        "Kirchhoff geometry factor; it has no unit.</p>\n"
        "<h2 id=\"provenance\">Provenance of this report</h2>\n",
        html);
    dif_page_provenance(html, dif_result_at(list, "provenance"));
    fputs("</body>\n</html>\n", html);
}
