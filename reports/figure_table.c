#include <math.h>

#include "core/alloc.h"
#include "core/units.h"
#include "reports/figures.h"
#include "reports/plot.h"

enum { COLUMN_MAX = 1100, ROW_MAX = 400, MAXIMUM_MAX = 3000, CURVE_POINT_N = 161 };
static const double decades = 1e-6; /* of the heat map's colour scale below the largest value */

static double largest(const dif_table *table)
{
    const size_t n = (size_t)table->plan.n_angle * (size_t)table->plan.n_lambda;
    double high = 0.0;
    for (size_t i = 0; i < n; i++) {
        if (table->value[i] > high)
            high = table->value[i];
    }
    return high > 0.0 ? high : 1.0;
}

/* Largest value of a block of cells, at least `low`; NaN if none was measured. */
static double block_max(const dif_table *table, int x0, int x1, int y0, int y1, double low)
{
    double best = NAN;
    for (int iy = y0; iy < y1; iy++) {
        for (int ix = x0; ix < x1; ix++) {
            const double value = table->value[(size_t)iy * (size_t)table->plan.n_angle + (size_t)ix];
            if (!isnan(value) && !(best >= value))
                best = value;
        }
    }
    return best < low ? low : best;
}

/* The pixels of the heat map, first row = shortest wavelength. */
static void write_cells(const dif_table *table, const dif_figure_notes *notes, FILE *script)
{
    const int nx = table->plan.n_angle, ny = table->plan.n_lambda;
    for (int y = 0; y < ny; y += notes->n_cell_y) {
        for (int x = 0; x < nx; x += notes->n_cell_x) {
            const int x1 = x + notes->n_cell_x < nx ? x + notes->n_cell_x : nx;
            const int y1 = y + notes->n_cell_y < ny ? y + notes->n_cell_y : ny;
            const float value = (float)block_max(table, x, x1, y, y1, notes->low);
            fwrite(&value, sizeof value, 1, script);
        }
    }
}

/* One curve sin(running) = f lambda - sin(fixed) within the axes, and its label above the plot. */
static int write_curve(const dif_plan *plan, double f_per_um, FILE *script)
{
    const double a0 = plan->angle_rad[0], a1 = plan->angle_rad[plan->n_angle - 1];
    const double l0 = plan->lambda_um[0], l1 = plan->lambda_um[plan->n_lambda - 1];
    int n = 0;
    for (int i = 0; i < CURVE_POINT_N; i++) {
        const double lambda_um = l0 + (l1 - l0) * i / (CURVE_POINT_N - 1);
        const double s = f_per_um * lambda_um - sin(plan->fixed_rad);
        if (fabs(s) >= 1.0 || asin(s) < a0 || asin(s) > a1)
            continue;
        fprintf(script, "%.7g %.7g\n", dif_deg_from_rad(asin(s)), dif_nm_from_um(lambda_um));
        n++;
    }
    fputs("\n", script);
    return n > 1;
}

/* Where a curve leaves the plot through the top; false if it does not. */
static bool leaves_top(const dif_plan *plan, double f_per_um, double *angle_deg)
{
    const double s = f_per_um * plan->lambda_um[plan->n_lambda - 1] - sin(plan->fixed_rad);
    if (fabs(s) >= 1.0)
        return false;
    *angle_deg = dif_deg_from_rad(asin(s));
    return asin(s) >= plan->angle_rad[0] && asin(s) <= plan->angle_rad[plan->n_angle - 1];
}

/* Where it leaves through the right side; false if it does not. */
static bool leaves_right(const dif_plan *plan, double f_per_um, double *lambda_nm)
{
    const double lambda_um = (sin(plan->angle_rad[plan->n_angle - 1]) + sin(plan->fixed_rad)) / f_per_um;
    *lambda_nm = dif_nm_from_um(lambda_um);
    return lambda_um >= plan->lambda_um[0] && lambda_um <= plan->lambda_um[plan->n_lambda - 1];
}

/* Spatial frequency of curve i: the orders of one period, or the ridges found. NaN behind the last. */
static double curve_f_per_um(const dif_result *result, bool common, int i, int *order)
{
    const json_t *ridges = dif_result_at(result->doc, "fit_table.ridges");
    if (!common) {
        const json_t *ridge = json_array_get(ridges, (size_t)i);
        *order = (int)dif_result_number(ridge, "order");
        return ridge ? dif_result_number(ridge, "f_per_um") : (double)NAN;
    }
    const double period_um = dif_um_from_nm(dif_result_number(result->doc, "fit_table.period_nm"));
    const double f_max = 2.0 / result->table.plan.lambda_um[0];
    *order = i - (int)fmin(200.0, floor(f_max * period_um));
    return *order <= f_max * period_um && *order <= 200 ? *order / period_um : (double)NAN;
}

/* Labels a curve where it leaves the plot; orders that would touch the label before are left without. */
static void write_curve_label(const dif_plan *plan, double f_per_um, const char *label, int row, double last[2],
                              FILE *script)
{
    double at;
    if (leaves_top(plan, f_per_um, &at) && fabs(at - last[0]) > 3.5) {
        fprintf(script, "set label '%s' at first %.6g, graph %g center font ',11' tc rgb '#444444'\n", label, at,
                1.03 + 0.035 * row);
        last[0] = row ? last[0] : at;
    } else if (leaves_right(plan, f_per_um, &at) && fabs(at - last[1]) > 14.0) {
        fprintf(script, "set label '%s' at graph %g, first %.6g left font ',11' tc rgb '#444444'\n", label,
                1.005 + 0.01 * row, at);
        last[1] = row ? last[1] : at;
    }
}

/* The curves and their labels: orders of one period, or the letters of the ridges in two rows. */
static int write_curves(const dif_result *result, FILE *script)
{
    const dif_plan *plan = &result->table.plan;
    const bool common = dif_result_true(result->doc, "fit_table.common_period");
    int n = 0, order = 0;
    double f_per_um, last[2] = {-1e9, -1e9};
    char label[16];
    fputs("$curve << EOD\n", script);
    if (dif_result_true(result->doc, "fit_table.ok")) {
        for (int i = 0; !isnan(f_per_um = curve_f_per_um(result, common, i, &order)); i++)
            n += write_curve(plan, f_per_um, script);
    }
    fputs("nan nan\nEOD\n", script);
    for (int i = 0; n && !isnan(f_per_um = curve_f_per_um(result, common, i, &order)); i++) {
        if (common)
            snprintf(label, sizeof label, "%d", order);
        else
            snprintf(label, sizeof label, "%c", 'A' + i % 26);
        if (!common)
            last[0] = last[1] = -1e9;
        write_curve_label(plan, f_per_um, label, common ? 0 : i % 2, last, script);
    }
    return n;
}

/* Draws all maxima if they are few enough, else the largest of each wavelength. */
static void write_maxima(const dif_columns *maxima, FILE *script, dif_figure_notes *notes)
{
    int n_inside = 0;
    for (int i = 0; i < maxima->n_row; i++)
        n_inside += maxima->value[i * DIF_MAXIMA_N + DIF_MAXIMA_AT_EDGE] == 0.0;
    fputs("$maxima << EOD\n", script);
    notes->n_maximum = 0;
    for (int i = 0; i < maxima->n_row; i++) {
        const double *row = maxima->value + (size_t)i * DIF_MAXIMA_N;
        if (row[DIF_MAXIMA_AT_EDGE] != 0.0 || (n_inside > MAXIMUM_MAX && row[DIF_MAXIMA_IS_GLOBAL] == 0.0))
            continue;
        fprintf(script, "%.7g %.7g\n", row[DIF_MAXIMA_ANGLE_DEG], row[DIF_MAXIMA_LAMBDA_NM]);
        notes->n_maximum++;
    }
    fputs("nan nan\nEOD\n", script);
    notes->n_skipped = maxima->n_row - notes->n_maximum;
}

dif_status dif_figure_table(const dif_result *result, const char *prefix, FILE *html, dif_figure_notes *notes,
                            dif_error *err)
{
    const dif_table *table = &result->table;
    const dif_plan *plan = &table->plan;
    FILE *script;
    const dif_status status = dif_plot_open(1080, 500, &script, err);
    if (status != DIF_OK)
        return status;
    notes->n_cell_x = (plan->n_angle + COLUMN_MAX - 1) / COLUMN_MAX;
    notes->n_cell_y = (plan->n_lambda + ROW_MAX - 1) / ROW_MAX;
    notes->high = largest(table);
    notes->low = notes->high * decades;
    notes->n_curve = write_curves(result, script);
    write_maxima(&result->maxima, script, notes);
    const double a0 = dif_deg_from_rad(plan->angle_rad[0]), l0 = dif_nm_from_um(plan->lambda_um[0]);
    const double a1 = dif_deg_from_rad(plan->angle_rad[plan->n_angle - 1]);
    const double l1 = dif_nm_from_um(plan->lambda_um[plan->n_lambda - 1]);
    const double da = plan->n_angle > 1 ? (a1 - a0) / (plan->n_angle - 1) : 1.0;
    const double dl = plan->n_lambda > 1 ? (l1 - l0) / (plan->n_lambda - 1) : 1.0;
    const char *unit = table->quantity == DIF_QUANTITY_BRDF  ? "BRDF / sr^{-1}"
                       : table->quantity == DIF_QUANTITY_RHO ? "relative BRDF ρ"
                                                             : "normalised power p";
    fprintf(script,
            "set lmargin at screen 0.07\nset rmargin at screen 0.87\nset bmargin at screen 0.13\n"
            "set tmargin at screen 0.93\n"
            "set xlabel '%s θ_%s / °'\nset ylabel 'wavelength λ / nm'\nset cblabel '%s'\n"
            "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\nset tics out nomirror\n"
            "set logscale cb\nset cbrange [%.6g:%.6g]\nset format cb '10^{%%L}'\n"
            "set label '%s' at screen 0.062, graph 1.03 right font ',11' tc rgb '#444444'\n",
            plan->fixed_is_wo ? "angle of incidence" : "angle of reflection", plan->fixed_is_wo ? "i" : "r", unit,
            a0 - 0.5 * da, a1 + 0.5 * da, l0 - 0.5 * dl, l1 + 0.5 * dl, notes->low, notes->high,
            dif_result_true(result->doc, "fit_table.common_period") ? "m" : "");
    dif_plot_image(script, a0 + 0.5 * da * (notes->n_cell_x - 1), da * notes->n_cell_x,
                   l0 + 0.5 * dl * (notes->n_cell_y - 1), dl * notes->n_cell_y,
                   (plan->n_angle + notes->n_cell_x - 1) / notes->n_cell_x,
                   (plan->n_lambda + notes->n_cell_y - 1) / notes->n_cell_y);
    fputs(", $curve using 1:2 with lines lw 0.7 lc rgb '#55ffffff' notitle"
          ", $maxima using 1:2 with points pt 7 ps 0.22 lc rgb '#d55e00' notitle\n",
          script);
    write_cells(table, notes, script);
    return dif_plot_close(script, prefix, "Angle-wavelength response table as a heat map", html, err);
}
