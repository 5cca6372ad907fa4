/* The main job's speed: an in-plane table of 1801 angles x 401 wavelengths, by the sheet transform at several
 * tolerances and by the Taylor series, against the direct sum measured on a sample of the same cells in the same run.
 * usage: speed_table [--smallest] */
#include <stdio.h>
#include <string.h>

#include "bench/scan.h"
#include "bench/speed/speed.h"
#include "core/units.h"
#include "fixtures/surfaces.h"

typedef struct job {
    const char *name;
    dif_method method;
    double tol;
} job;

static dif_plan make_plan(bool smallest, double azimuth_deg)
{
    dif_range angle, lambda;
    dif_plan plan;
    dif_error err;
    dif_speed_must(dif_range_parse(smallest ? "-45:45:9" : "-81:81:0.09", &angle, &err), &err);
    dif_speed_must(dif_range_parse(smallest ? "380:780:100" : "380:780:1", &lambda, &err), &err);
    dif_speed_must(dif_scan_plan(false, 75.0, azimuth_deg, &angle, &lambda, &plan, &err), &err);
    return plan;
}

/* One case: warm-up, runs, error against the direct sum. */
static void run(const char *surface, const dif_field *field, const dif_plan *plan, const job *what, bool smallest)
{
    dif_measure_opts opts = dif_measure_opts_default();
    dif_speed speed = {.n = 0};
    dif_measure_check check;
    dif_error err;
    opts.method = what->method;
    opts.quantity = DIF_QUANTITY_POWER;
    const int reps = smallest ? 1 : DIF_SPEED_REPS;
    for (int i = -1; i < reps; i++) {
        dif_table table;
        dif_measure_stats stats;
        dif_speed_must(dif_measure_table(field, plan, what->tol, &opts, &table, &stats, &err), &err);
        if (i >= 0)
            dif_speed_add(&speed, &stats);
        if (i == reps - 1)
            dif_speed_must(dif_measure_check_table(field, &table, &opts, smallest ? 4 : 100, 1, &check, &err), &err);
        dif_table_free(&table);
    }
    char name[96];
    snprintf(name, sizeof name, "%s %s", surface, what->name);
    dif_speed_print(&speed, name, (size_t)plan->n_angle * (size_t)plan->n_lambda, what->tol, check.worst_amplitude,
                    check.direct_s_per_sample);
}

int main(int argc, char **argv)
{
    const bool smallest = argc > 1 && strcmp(argv[1], "--smallest") == 0;
    const job jobs[] = {{"sheet", DIF_METHOD_SHEET, 1e-6},   {"sheet", DIF_METHOD_SHEET, 1e-3},
                        {"sheet", DIF_METHOD_SHEET, 1e-9},   {"sheet", DIF_METHOD_SHEET, 1e-12},
                        {"taylor", DIF_METHOD_TAYLOR, 1e-6}, {"taylor", DIF_METHOD_TAYLOR, 1e-9}};
    const struct {
        const char *name, *file;
        double height_um, azimuth_deg;
        dif_surface_kind kind;
        int n_side, n_job;
    } surfaces[] = {
        {"xenopeltis", "measured/xenopeltis_65um.png", 0.81869, 90.0, DIF_SURFACE_XENOPELTIS, 0, 6},
        {"elaphe", "measured/elaphe_65um.png", 0.375, 0.0, DIF_SURFACE_ELAPHE, 0, 2},
        {"xenopeltis at 37 deg", "measured/xenopeltis_65um.png", 0.81869, 37.0, DIF_SURFACE_XENOPELTIS, 0, 1},
        {"synthetic 4096^2", "", 0.81869, 90.0, DIF_SURFACE_XENOPELTIS, 4096, 1}};
    dif_speed_header();
    for (int s = 0; s < 4; s++) {
        dif_field field;
        const int n_side = smallest ? 64 : surfaces[s].n_side;
        dif_speed_surface(surfaces[s].file, surfaces[s].height_um, surfaces[s].kind, n_side, &field);
        dif_plan plan = make_plan(smallest, surfaces[s].azimuth_deg);
        for (int j = 0; j < surfaces[s].n_job; j++)
            run(surfaces[s].name, &field, &plan, jobs + j, smallest);
        dif_plan_free(&plan);
        dif_field_free(&field);
    }
    fprintf(stderr, "peak memory %.0f MiB\n", dif_speed_peak_mib());
    return 0;
}
