/* Speed of the wavelength-integrated table: 4096 azimuths x 320 radii of measured scans, by stages, with the number of
 * maps that each tolerance needs and the error of the colours against full spectral sampling.
 * usage: speed_lut [--smallest] */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/lut_check.h"
#include "bench/measure_impl.h"
#include "bench/speed/speed.h"
#include "core/units.h"
#include "fixtures/surfaces.h"

enum { N_LAMBDA = 81, N_STAGE = 4 };
static const char *const STAGES[N_STAGE] = {"sheet", "rings", "texels", "blur"};

/* Seconds by stage. */
typedef struct stages {
    dif_stopwatch watch;
    double wall_s[N_STAGE + 1], cpu_s[N_STAGE + 1]; /* the last: before the first stage */
    int at;
} stages;

static void begin_stage(void *self, const char *name)
{
    stages *s = self;
    dif_stopwatch_lap(&s->watch, &s->wall_s[s->at], &s->cpu_s[s->at]);
    for (s->at = 0; s->at < N_STAGE - 1 && strcmp(STAGES[s->at], name) != 0;)
        s->at++;
}

static void run(const char *name, const dif_field *field, double tol, bool sun, bool smallest)
{
    double lambda_um[N_LAMBDA];
    const int n_lambda = smallest ? 5 : N_LAMBDA;
    for (int i = 0; i < n_lambda; i++)
        lambda_um[i] = dif_um_from_nm(380.0 + 400.0 * i / (n_lambda - 1));
    dif_measure_opts opts = dif_measure_opts_default();
    dif_lut_opts how = dif_lut_opts_default();
    stages s = {.at = N_STAGE, .watch = dif_stopwatch_start()};
    dif_lut_check check;
    dif_lut lut;
    dif_error err;
    int n_window;
    if (smallest) {
        how.n_azimuth = 64;
        how.n_radius = 16;
    }
    how.source_diameter_rad = sun ? dif_rad_from_deg(0.53) : 0.0;
    how.stage = begin_stage;
    how.progress_self = &s;
    dif_speed_must(dif_lut_measure(field, n_lambda, lambda_um, tol, &opts, &how, &lut, &n_window, &err), &err);
    begin_stage(&s, STAGES[0]);
    dif_speed_must(dif_lut_check_random(field, &lut, n_lambda, lambda_um, how.source_diameter_rad, &opts,
                                        smallest ? 10
                                        : sun    ? 50
                                                 : 1000,
                                        1, &check, &err),
                   &err);
    double wall_s = 0.0, cpu_s = 0.0;
    for (int i = 0; i <= N_STAGE; i++) {
        wall_s += s.wall_s[i];
        cpu_s += s.cpu_s[i];
    }
    printf("%s%s,%d,%.0e,%.2e,1,%.3f,%.3f,%.4g,%.3f", name, sun ? " sun" : "", lut.n_azimuth * lut.n_radius * lut.n_map,
           tol, check.of_peak.median, wall_s, wall_s, lut.n_azimuth * lut.n_radius * lut.n_map / wall_s, cpu_s);
    for (int i = 0; i < N_STAGE; i++)
        printf(",%.3f", s.cpu_s[i]);
    printf(",%d,%.2e,%.2e,%.2e,%.3f,%.3f\n", lut.n_map, lut.tail, check.relative.median, check.relative.p95,
           check.de.median, check.de.p95);
    fflush(stdout);
    dif_lut_free(&lut);
}

int main(int argc, char **argv)
{
    const bool smallest = argc > 1 && strcmp(argv[1], "--smallest") == 0;
    const double tols[] = {1e-4, 1e-5, 1e-6};
    const struct {
        const char *name, *file;
        double height_um;
        dif_surface_kind kind;
    } surfaces[] = {{"xenopeltis", "measured/xenopeltis_65um.png", 0.81869, DIF_SURFACE_XENOPELTIS},
                    {"elaphe", "measured/elaphe_65um.png", 0.375, DIF_SURFACE_ELAPHE}};
    printf(
        "name,n,tol,err_reached,reps,min_s,median_s,per_s,cpu_s,sheet_cpu_s,rings_cpu_s,texels_cpu_s,blur_cpu_s,maps,"
        "tail,relative_median,relative_p95,de2000_median,de2000_p95\n");
    for (int i = 0; i < 2; i++) {
        dif_field field;
        dif_speed_surface(surfaces[i].file, surfaces[i].height_um, surfaces[i].kind, smallest ? 64 : 0, &field);
        for (int t = 0; t < 3; t++)
            run(surfaces[i].name, &field, tols[t], false, smallest);
        run(surfaces[i].name, &field, 1e-4, true, smallest);
        dif_field_free(&field);
    }
    fprintf(stderr, "peak memory %.0f MiB\n", dif_speed_peak_mib());
    return 0;
}
