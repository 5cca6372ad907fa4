#define _POSIX_C_SOURCE 200809L
#include "bench/speed/speed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "core/io/field_io.h"
#include "fixtures/surfaces.h"

void dif_speed_add(dif_speed *speed, const dif_measure_stats *stats)
{
    if (speed->n == DIF_SPEED_REPS)
        return;
    speed->wall_s[speed->n] = stats->build_wall_s + stats->eval_wall_s;
    speed->cpu_s[speed->n] = stats->build_cpu_s + stats->eval_cpu_s;
    speed->build_cpu_s[speed->n] = stats->build_cpu_s;
    speed->eval_cpu_s[speed->n] = stats->eval_cpu_s;
    speed->n++;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Value at a quantile (0 = smallest, 0.5 = median) of n runs. */
static double quantile(const double *value, int n, double at)
{
    double sorted[DIF_SPEED_REPS];
    memcpy(sorted, value, (size_t)n * sizeof *value);
    qsort(sorted, (size_t)n, sizeof *sorted, by_size);
    return sorted[(int)(at * (n - 1))];
}

void dif_speed_header(void)
{
    printf("name,n,tol,err_reached,reps,min_s,median_s,per_s,median_cpu_s,build_cpu_s,eval_cpu_s,times_direct\n");
}

void dif_speed_print(const dif_speed *speed, const char *name, size_t n, double tol, double err_reached,
                     double direct_s_per_sample)
{
    const double median_s = quantile(speed->wall_s, speed->n, 0.5);
    printf("%s,%zu,%.0e,%.2e,%d,%.4f,%.4f,%.4g,%.4f,%.4f,%.4f,%.4g\n", name, n, tol, err_reached, speed->n,
           quantile(speed->wall_s, speed->n, 0.0), median_s, (double)n / median_s,
           quantile(speed->cpu_s, speed->n, 0.5), quantile(speed->build_cpu_s, speed->n, 0.5),
           quantile(speed->eval_cpu_s, speed->n, 0.5), direct_s_per_sample * (double)n / median_s);
    fflush(stdout);
}

void dif_speed_must(dif_status status, const dif_error *err)
{
    if (status == DIF_OK)
        return;
    fprintf(stderr, "%s: %s\n", dif_status_text(status), err->text);
    exit(EXIT_FAILURE);
}

void dif_speed_surface(const char *file, double height_um, dif_surface_kind kind, int n_side, dif_field *out)
{
    const char *folder = getenv("DIFFBENCH_DATA");
    char path[4096];
    dif_error err = {DIF_OK, ""};
    dif_field_request request = dif_field_request_default();
    dif_field_file scan;
    request.size_um = 65.0;
    request.height_um = height_um;
    snprintf(path, sizeof path, "%s/%s", folder ? folder : "../shared/data", file);
    if (n_side == 0 && dif_field_read(path, &request, &scan, &err) == DIF_OK) {
        *out = scan.field;
        return;
    }
    dif_surface surface = dif_surface_default(kind);
    if (n_side > 0)
        surface.nx = surface.ny = n_side;
    else
        fprintf(stderr, "%s; its synthetic look-alike instead\n", err.text);
    dif_speed_must(dif_surface_make(&surface, out, &err), &err);
}

double dif_speed_peak_mib(void)
{
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_maxrss / 1024.0;
}
