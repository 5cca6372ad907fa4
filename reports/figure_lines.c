#include <math.h>
#include <stdlib.h>

#include "core/alloc.h"
#include "core/units.h"
#include "reports/figures.h"
#include "reports/plot.h"

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* A range that holds 97 of 100 residuals with room; a few far ones must not flatten the rest. */
static dif_status residual_range(const dif_columns *maxima, dif_figure_notes *notes, double *range, dif_error *err)
{
    double *size = dif_alloc((size_t)maxima->n_row, sizeof(double));
    if (!size)
        return dif_fail(err, DIF_ERR_NOMEM, "%d maxima", maxima->n_row);
    int n = 0;
    for (int i = 0; i < maxima->n_row; i++) {
        const double *row = maxima->value + (size_t)i * DIF_MAXIMA_N;
        if (row[DIF_MAXIMA_ON_LINE] != 0.0 && isfinite(row[DIF_MAXIMA_RESIDUAL_DEG]))
            size[n++] = fabs(row[DIF_MAXIMA_RESIDUAL_DEG]);
    }
    qsort(size, (size_t)n, sizeof(double), by_size);
    *range = n ? 1.5 * size[(int)ceil(0.97 * (n - 1))] + 1e-9 : 1.0;
    notes->n_residual = n;
    notes->n_far = 0;
    for (int i = 0; i < n; i++)
        notes->n_far += size[i] > *range;
    dif_release(size);
    return DIF_OK;
}

/* One point a maximum: x = order, spread by its wavelength; y = residual. */
static void write_residuals(const dif_result *result, FILE *script)
{
    const dif_plan *plan = &result->table.plan;
    const double l0 = dif_nm_from_um(plan->lambda_um[0]);
    const double span = fmax(dif_nm_from_um(plan->lambda_um[plan->n_lambda - 1]) - l0, 1e-9);
    fputs("$point << EOD\n", script);
    for (int i = 0; i < result->maxima.n_row; i++) {
        const double *row = result->maxima.value + (size_t)i * DIF_MAXIMA_N;
        const double residual = row[DIF_MAXIMA_RESIDUAL_DEG];
        if (row[DIF_MAXIMA_ON_LINE] != 0.0 && isfinite(residual))
            fprintf(script, "%.6g %.6g %.6g\n",
                    row[DIF_MAXIMA_ORDER] + 0.7 * ((row[DIF_MAXIMA_LAMBDA_NM] - l0) / span - 0.5), residual,
                    row[DIF_MAXIMA_LAMBDA_NM]);
    }
    fputs("nan nan nan\nEOD\n", script);
}

static void write_order_means(const dif_result *result, FILE *script)
{
    size_t i;
    json_t *order;
    fputs("$mean << EOD\n", script);
    json_array_foreach(dif_result_at(result->doc, "maxima.orders"), i, order)
    {
        const double mean = dif_result_number(order, "mean_deg"), rms = dif_result_number(order, "rms_deg");
        if (isfinite(mean) && isfinite(rms))
            fprintf(script, "%g %.6g %.6g\n", dif_result_number(order, "order"), mean,
                    sqrt(fmax(rms * rms - mean * mean, 0.0)));
    }
    fputs("nan nan nan\nEOD\n", script);
}

dif_status dif_figure_residuals(const dif_result *result, const char *prefix, FILE *html, dif_figure_notes *notes,
                                dif_error *err)
{
    FILE *script;
    double range = 1.0;
    dif_status status = residual_range(&result->maxima, notes, &range, err);
    if (status == DIF_OK)
        status = dif_plot_open(1080, 360, &script, err);
    if (status != DIF_OK)
        return status;
    const dif_plan *plan = &result->table.plan;
    const int n = notes->n_residual;
    write_residuals(result, script);
    write_order_means(result, script);
    fprintf(script,
            "set lmargin at screen 0.07\nset rmargin at screen 0.87\nset bmargin at screen 0.17\n"
            "set xlabel 'order m (points of one order run from the shortest to the longest wavelength)'\n"
            "set ylabel 'residual / °'\nset cblabel 'wavelength λ / nm'\n"
            "set xtics 1\nset grid y lt 1 lw 0.5 lc rgb '#dddddd'\nset tics out nomirror\n"
            "set cbrange [%.9g:%.9g]\nset yrange [%.6g:%.6g]\n",
            dif_nm_from_um(plan->lambda_um[0]), dif_nm_from_um(plan->lambda_um[plan->n_lambda - 1]) + 1e-6, -range,
            range);
    if (n)
        fputs("set offsets 0.6, 0.6, 0, 0\n"
              "plot 0 with lines lw 0.8 lc rgb '#444444' notitle, \\\n"
              "  $point using 1:2:3 with points pt 7 ps 0.3 lc palette notitle, \\\n"
              "  $mean using 1:2:3 with yerrorbars pt 5 ps 0.6 lw 1.4 lc rgb '#d55e00' notitle\n",
              script);
    else
        fputs("set xrange [-1:1]\nset label 'no maximum has an order: no period was fitted' at graph 0.5, 0.5 center\n"
              "plot 0 with lines lw 0.8 lc rgb '#444444' notitle\n",
              script);
    return dif_plot_close(script, prefix, "Residuals of the maxima against the grating equation by order", html, err);
}

/* The fitted ridges as vertical lines with their orders; two rows of labels so that neighbours stay legible. */
static void write_ridges(const dif_result *result, FILE *script)
{
    size_t i;
    json_t *ridge;
    const bool common = dif_result_true(result->doc, "fit_table.common_period");
    json_array_foreach(dif_result_at(result->doc, "fit_table.ridges"), i, ridge)
    {
        const double f = dif_result_number(ridge, "f_per_um");
        if (!isfinite(f))
            continue;
        fprintf(script,
                "set arrow from first %.8g, graph 0 to first %.8g, graph 1 nohead back lw 1 dt 2 lc rgb '#d55e00'\n", f,
                f);
        if (common)
            fprintf(script, "set label '%d' at first %.8g, graph 1.04 center font ',11' tc rgb '#d55e00'\n",
                    (int)dif_result_number(ridge, "order"), f);
        else
            fprintf(script, "set label '%c' at first %.8g, graph %g center font ',11' tc rgb '#d55e00'\n",
                    'A' + (int)(i % 26), f, i % 2 ? 1.09 : 1.04);
    }
}

dif_status dif_figure_lines(const dif_result *result, const char *prefix, FILE *html, dif_error *err)
{
    FILE *script;
    const dif_status status = dif_plot_open(1080, 380, &script, err);
    if (status != DIF_OK)
        return status;
    double high = 0.0;
    fputs("$line << EOD\n", script);
    for (int i = 0; i < result->lines.n_row; i++) {
        const double *row = result->lines.value + (size_t)i * DIF_LINES_N;
        if (row[DIF_LINES_N_CELL] > 0.0 && row[DIF_LINES_POWER_MEAN] > 0.0) {
            fprintf(script, "%.7g %.5g\n", row[DIF_LINES_F_PER_UM], row[DIF_LINES_POWER_MEAN]);
            high = fmax(high, row[DIF_LINES_POWER_MEAN]);
        }
    }
    fputs(high > 0.0 ? "EOD\n" : "0 1\nEOD\nset label 'no power anywhere' at graph 0.5, 0.5 center\n", script);
    if (dif_result_true(result->doc, "fit_table.ok"))
        write_ridges(result, script);
    high = high > 0.0 ? high : 1.0;
    fprintf(script,
            "set lmargin at screen 0.07\nset rmargin at screen 0.97\nset bmargin at screen 0.17\n"
            "set tmargin at screen 0.88\n"
            "set xlabel 'spatial frequency f = (sin θ_i + sin θ_r)/λ / µm^{−1}'\nset ylabel 'mean power p'\n"
            "set grid lt 1 lw 0.5 lc rgb '#dddddd'\nset tics out nomirror\n"
            "set logscale y\nset format y '10^{%%L}'\nset yrange [%.6g:%.6g]\nset autoscale xfix\n"
            "plot $line using 1:2 with lines lw 1.2 lc rgb '#31688e' notitle\n",
            high * 1e-7, high * 2.0);
    return dif_plot_close(script, prefix, "Mean power over spatial frequency", html, err);
}
