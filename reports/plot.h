/* Plots: a script for gnuplot in, one inline SVG element out. gnuplot runs as a child process without a shell.
 * Does not: know what is drawn. */
#ifndef DIF_PLOT_H
#define DIF_PLOT_H

#include <stdio.h>

#include "core/status.h"

/* Starts a script: terminal of the given size, font, colour map (viridis), fine grey axes.
 * Status    DIF_ERR_IO (no temporary file), DIF_ERR_FOREIGN */
DIF_MUST_USE dif_status dif_plot_open(int width, int height, FILE **script, dif_error *err);

/* Writes "plot '-' ... with image": nx * ny floats, first row at y0, must follow the end of that line. */
void dif_plot_image(FILE *script, double x0, double dx, double y0, double dy, int nx, int ny);

/* Runs the script, closes it and writes <svg role="img" aria-label="LABEL">...</svg> to html; `prefix` makes the ids of
 * the element unique on the page.
 * Status    DIF_ERR_RESOURCE (no gnuplot), DIF_ERR_FOREIGN (gnuplot refused, with its line), DIF_ERR_IO, DIF_ERR_NOMEM */
DIF_MUST_USE dif_status dif_plot_close(FILE *script, const char *prefix, const char *label, FILE *html, dif_error *err);

#endif
