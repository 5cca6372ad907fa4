#define _POSIX_C_SOURCE 200809L
#include "reports/plot.h"

#include <errno.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/alloc.h"
#include "core/io/image_cv.h"
#include "reports/html.h"

extern char **environ;

static dif_status write_palette(FILE *script, dif_error *err)
{
    uint8_t rgb[256][3];
    const dif_status status = dif_image_colormap("viridis", rgb, err);
    if (status != DIF_OK)
        return status;
    fputs("set palette defined (", script);
    for (int i = 0; i < 256; i += 5)
        fprintf(script, "%s%d '#%02x%02x%02x'", i ? ", " : "", i, rgb[i][0], rgb[i][1], rgb[i][2]);
    fputs(")\n", script);
    return DIF_OK;
}

dif_status dif_plot_open(int width, int height, FILE **script, dif_error *err)
{
    *script = tmpfile();
    if (!*script)
        return dif_fail(err, DIF_ERR_IO, "temporary file for a plot: %s", strerror(errno));
    fprintf(*script,
            "set encoding utf8\n"
            "set terminal svg size %d,%d dynamic font 'sans-serif,13' linewidth 1 name 'plot'\n"
            "set border 31 lw 0.8 lc rgb '#444444'\n"
            "set tics textcolor rgb '#222222' scale 0.6\n"
            "set colorbox border\n"
            "unset key\n"
            "set datafile missing 'nan'\n"
            "set minussign\n"
            "set xlabel offset 0,0.5\n",
            width, height);
    const dif_status status = write_palette(*script, err);
    if (status != DIF_OK) {
        fclose(*script);
        *script = NULL;
    }
    return status;
}

void dif_plot_image(FILE *script, double x0, double dx, double y0, double dy, int nx, int ny)
{
    fprintf(script,
            "plot '-' binary array=(%d,%d) format='%%float' origin=(%.12g,%.12g) dx=%.12g dy=%.12g using 1 with image "
            "notitle",
            nx, ny, x0, y0, dx, dy);
}

/* Runs gnuplot with its three streams on files; *code is its exit code. */
static dif_status run(FILE *in, FILE *out, FILE *talk, int *code, dif_error *err)
{
    char name[] = "gnuplot", option[] = "-d"; /* -d: no settings of the user's */
    char *const argv[] = {name, option, NULL};
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return dif_fail(err, DIF_ERR_NOMEM, "starting gnuplot");
    int rc = posix_spawn_file_actions_adddup2(&actions, fileno(in), STDIN_FILENO);
    if (rc == 0)
        rc = posix_spawn_file_actions_adddup2(&actions, fileno(out), STDOUT_FILENO);
    if (rc == 0)
        rc = posix_spawn_file_actions_adddup2(&actions, fileno(talk), STDERR_FILENO);
    pid_t pid = 0;
    if (rc == 0)
        rc = posix_spawnp(&pid, name, &actions, NULL, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (rc != 0)
        return dif_fail(err, DIF_ERR_RESOURCE,
                        "gnuplot, which draws the plots, cannot be run (%s): install the package "
                        "gnuplot-nox",
                        strerror(rc));
    int state = 0;
    pid_t done;
    do
        done = waitpid(pid, &state, 0);
    while (done < 0 && errno == EINTR);
    *code = done == pid && WIFEXITED(state) ? WEXITSTATUS(state) : -1;
    return DIF_OK;
}

/* The whole of a temporary file, NUL behind it; the caller releases. */
static dif_status slurp(FILE *file, char **text, dif_error *err)
{
    long size = -1;
    if (fseek(file, 0, SEEK_END) == 0)
        size = ftell(file);
    if (size < 0)
        return dif_fail(err, DIF_ERR_IO, "temporary file of a plot: %s", strerror(errno));
    rewind(file);
    *text = dif_alloc((size_t)size + 1, 1);
    if (!*text)
        return dif_fail(err, DIF_ERR_NOMEM, "a plot of %ld bytes", size);
    if (fread(*text, 1, (size_t)size, file) != (size_t)size)
        return dif_fail(err, DIF_ERR_IO, "temporary file of a plot: short read");
    return DIF_OK;
}

/* Writes gnuplot's SVG as an inline element: no prolog, no namespaces (HTML knows them), no tooltips, own ids. */
static void write_inline(const char *svg, const char *prefix, const char *label, FILE *html)
{
    static const char *const reference[] = {"id='", "id=\"", "href='#", "url(#"};
    fputs("<svg role=\"img\" aria-label=\"", html);
    dif_html_text(html, label);
    fputc('"', html);
    svg += 4; /* "<svg" */
    while (*svg) {
        size_t n = 0;
        if (strncmp(svg, "xmlns", 5) == 0) {
            svg += strcspn(svg, "\n>");
            continue;
        }
        if (strncmp(svg, "<title>", 7) == 0 || strncmp(svg, "<desc>", 6) == 0) {
            const char *end = strstr(svg, svg[1] == 't' ? "</title>" : "</desc>");
            svg = end ? strchr(end, '>') + 1 : svg + strlen(svg);
            continue;
        }
        for (size_t i = 0; i < sizeof reference / sizeof *reference && !n; i++) {
            if (strncmp(svg, reference[i], strlen(reference[i])) == 0)
                n = strlen(reference[i]);
        }
        if (n)
            fprintf(html, "%.*s%s-", (int)n, svg, prefix);
        else
            fputc(*svg, html), n = 1;
        svg += n;
    }
}

dif_status dif_plot_close(FILE *script, const char *prefix, const char *label, FILE *html, dif_error *err)
{
    dif_status status = DIF_OK;
    char *svg = NULL, *talk = NULL;
    int code = 0;
    FILE *out = tmpfile(), *errors = tmpfile();
    if (!out || !errors)
        status = dif_fail(err, DIF_ERR_IO, "temporary file for a plot: %s", strerror(errno));
    else if (fflush(script) != 0 || ferror(script) || lseek(fileno(script), 0, SEEK_SET) != 0)
        status = dif_fail(err, DIF_ERR_IO, "temporary file for a plot: %s", strerror(errno));
    if (status == DIF_OK)
        status = run(script, out, errors, &code, err);
    if (status == DIF_OK)
        status = slurp(out, &svg, err);
    if (status == DIF_OK)
        status = slurp(errors, &talk, err);
    if (status == DIF_OK) {
        const char *start = strstr(svg, "<svg");
        const char *line = talk + strspn(talk, " \n\t^");
        if (code != 0 || !start || !strstr(start, "</svg>"))
            status = dif_fail(err, DIF_ERR_FOREIGN, "gnuplot drew nothing (exit code %d): %.*s", code,
                              (int)strcspn(line, "\n"), line);
        else
            write_inline(start, prefix, label, html);
    }
    dif_release(svg);
    dif_release(talk);
    fclose(script);
    if (out)
        fclose(out);
    if (errors)
        fclose(errors);
    return status;
}
