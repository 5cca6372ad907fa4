#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/info.h"
#include "bench/fit.h"
#include "core/domain.h"
#include "core/series.h"
#include "core/sheet.h"
#include "core/units.h"

enum { PEAKS_MAX = 6, N_TOL = 4, N_TRUST = 6 };
static const double TOLS[N_TOL] = {1e-3, 1e-6, 1e-9, 1e-12};
static const double THETAS_DEG[N_TRUST / 2] = {0.0, 30.0, 75.0};

/* What one accuracy costs. */
typedef struct info_cost {
    double tol;
    int n_plane, n_tap, n_taylor, n_jacobi;
} info_cost;

typedef struct info_trust {
    double theta_deg, lambda_nm;
    dif_trust trust;
    const char *line;
} info_trust;

typedef struct info_surface {
    const char *path, *fixture;
    const dif_field_file *file;
    const dif_channels *channels;
    dif_field_stats stats;
    double range_um, lambda_min_nm, lambda_max_nm;
    double lambda_finest_nm;   /* shortest wavelength that the pitch serves at any angle */
    double phase_rad;          /* largest |kappa_z h| about the middle height             */
    double taylor_digits_lost; /* decimal digits that the power series cancels            */
    int n_peak;
    dif_spectrum_peak peak[PEAKS_MAX];
    info_cost cost[N_TOL];
    info_trust trust[N_TRUST];
} info_surface;

/* The planes and taps that the sheet method really takes at one tolerance. */
static dif_status cost_of(const dif_field *field, const info_surface *info, double tol, info_cost *out, dif_error *err)
{
    const double k_rad_per_um = DIF_TWO_PI / dif_um_from_nm(info->lambda_min_nm);
    const dif_band band = {2.0 * k_rad_per_um, 0.0, 2.0 * k_rad_per_um};
    const dif_window window = {.kind = DIF_WINDOW_GAUSS, .sigma_um = DIF_SIGMA_DEFAULT_UM};
    dif_sheet *sheet = NULL;
    const dif_status status = dif_sheet_create_line(field, &window, 0.0, &band, tol, NULL, &sheet, err);
    if (status)
        return status;
    const dif_sheet_info about = dif_sheet_info_of(sheet);
    dif_sheet_free(sheet);
    *out = (info_cost){tol, about.n_plane, about.n_tap, dif_series_taylor_order(info->phase_rad, tol) + 1,
                       dif_series_jacobi_order(info->phase_rad, tol)};
    return DIF_OK;
}

/* Which rules of thumb a surface is judged by. */
static dif_relief relief_of(const char *fixture)
{
    static const char *const smooth[] = {"sine", "crossed"}, *const walls[] = {"blazed", "lamellar", "cd"};
    for (int i = 0; fixture && i < DIF_COUNT(smooth); i++)
        if (strcmp(fixture, smooth[i]) == 0)
            return DIF_RELIEF_SMOOTH;
    for (int i = 0; fixture && i < DIF_COUNT(walls); i++)
        if (strcmp(fixture, walls[i]) == 0)
            return DIF_RELIEF_WALLS;
    return DIF_RELIEF_MEASURED;
}

static void judge(info_surface *info)
{
    const double period_um = info->n_peak > 0 ? info->peak[0].period_um : (double)NAN;
    for (int i = 0; i < N_TRUST; i++) {
        info_trust *t = &info->trust[i];
        t->theta_deg = THETAS_DEG[i / 2];
        t->lambda_nm = i % 2 ? info->lambda_max_nm : info->lambda_min_nm;
        const double lambda_um = dif_um_from_nm(t->lambda_nm);
        t->trust = dif_domain_verdict(relief_of(info->fixture), period_um / lambda_um, info->range_um / lambda_um,
                                      dif_rad_from_deg(t->theta_deg), &t->line);
    }
}

static dif_status gather(const dif_cli *cli, const dif_cli_input *input, info_surface *info, dif_error *err)
{
    const dif_field_file *file = &input->file;
    const dif_field *field = &file->field;
    info->path = cli->operand[0];
    info->file = file;
    info->channels = &input->channels;
    info->fixture = dif_cli_fixture_name(file);
    dif_status status = dif_field_stats_of(field, &info->stats, err);
    if (!status)
        status = dif_fit_spectrum_peaks(field, PEAKS_MAX, info->peak, &info->n_peak, err);
    if (status)
        return status;
    info->range_um = info->stats.max_um - info->stats.min_um;
    info->lambda_finest_nm = 4.0 * dif_nm_from_um(fmax(field->pitch_x_um, field->pitch_y_um));
    info->phase_rad = DIF_TWO_PI / dif_um_from_nm(info->lambda_min_nm) * info->range_um;
    info->taylor_digits_lost = log10(dif_series_taylor_peak(info->phase_rad));
    for (int i = 0; i < N_TOL && !status; i++)
        status = cost_of(field, info, TOLS[i], &info->cost[i], err);
    judge(info);
    return status;
}

static void print_surface(const info_surface *info)
{
    const dif_field *field = &info->file->field;
    const dif_field_stats *stats = &info->stats;
    const double slope_deg = dif_deg_from_rad(atan(stats->slope_max));
    printf("%s: %s%s%s%s\n", info->path, info->file->format, info->file->title[0] ? ", \"" : "", info->file->title,
           info->file->title[0] ? "\"" : "");
    if (info->channels->n > 1)
        dif_info_channels_print(info->channels, info->file->channel);
    printf("size       %d x %d samples, pitch %.6g x %.6g nm, %.6g x %.6g um\n", field->nx, field->ny,
           dif_nm_from_um(field->pitch_x_um), dif_nm_from_um(field->pitch_y_um), field->nx * field->pitch_x_um,
           field->ny * field->pitch_y_um);
    printf("heights    %.6g to %.6g um (range %.6g um), mean %.4g um, rms %.4g um\n", stats->min_um, stats->max_um,
           info->range_um, stats->mean_um, stats->rms_um);
    if (info->file->step_um > 0.0)
        printf("           quantised in steps of %.4g nm (%d bit)\n", dif_nm_from_um(info->file->step_um),
               info->file->bits);
    printf("slopes     rms %.4g along x, %.4g along y; steepest %.4g (%.3g deg)\n", stats->slope_x_rms,
           stats->slope_y_rms, stats->slope_max, slope_deg);
    for (int i = 0; i < info->n_peak; i++)
        printf("%s %.5g nm, groove normal at %.4g deg, %.3g %% of the variance\n", i ? "          " : "periods   ",
               dif_nm_from_um(info->peak[i].period_um), dif_deg_from_rad(info->peak[i].psi_rad),
               100.0 * info->peak[i].share);
}

static void print_use(const info_surface *info)
{
    const bool is_fine = info->lambda_finest_nm <= info->lambda_min_nm;
    printf("sampling   %s for %.6g nm: spatial frequencies up to 2/lambda must stay below 1/(2 pitch), so\n"
           "           pitch <= lambda/4 for all angles; this pitch serves wavelengths from %.4g nm\n",
           is_fine ? "fine enough" : "NOT FINE ENOUGH at grazing angles", info->lambda_min_nm, info->lambda_finest_nm);
    if (!is_fine)
        printf("           (at %.6g nm as long as |sin theta_i + sin theta_r| < %.3g)\n", info->lambda_min_nm,
               2.0 * info->lambda_min_nm / info->lambda_finest_nm);
    printf("accuracy   %8s %13s %11s %13s %19s\n", "tol", "sheet planes", "taps", "Taylor terms", "Jacobi-Anger terms");
    for (int i = 0; i < N_TOL; i++)
        printf("           %8.0e %13d %11d %13d %19d\n", info->cost[i].tol, info->cost[i].n_plane, info->cost[i].n_tap,
               info->cost[i].n_taylor, info->cost[i].n_jacobi);
    printf("           phase up to %.4g rad: the Taylor series loses %.1f decimal digits (double has 16, float 7)\n",
           info->phase_rad, info->taylor_digits_lost);
}

/* One line an angle, then each verdict's sentence once. */
static void print_trust(const info_surface *info)
{
    printf("trust      in order powers (places of maxima and periods hold in any case)\n");
    for (int i = 0; i < N_TRUST; i += 2)
        printf("           theta %2.0f deg: %s at %.4g nm, %s at %.4g nm\n", info->trust[i].theta_deg,
               dif_trust_name(info->trust[i].trust), info->trust[i].lambda_nm, dif_trust_name(info->trust[i + 1].trust),
               info->trust[i + 1].lambda_nm);
    for (int i = 0; i < N_TRUST; i++) {
        bool is_new = true;
        for (int j = 0; j < i; j++)
            is_new = is_new && info->trust[j].trust != info->trust[i].trust;
        if (is_new)
            printf("           %s: %s\n", dif_trust_name(info->trust[i].trust), info->trust[i].line);
    }
}

static json_t *json_lists(const info_surface *info, json_t *object)
{
    json_t *periods = json_array(), *costs = json_array(), *trusts = json_array();
    for (int i = 0; i < info->n_peak; i++)
        json_array_append_new(
            periods, json_pack("{s:f, s:f, s:f}", "period_nm", dif_nm_from_um(info->peak[i].period_um), "psi_deg",
                               dif_deg_from_rad(info->peak[i].psi_rad), "share", info->peak[i].share));
    for (int i = 0; i < N_TOL; i++)
        json_array_append_new(costs, json_pack("{s:f, s:i, s:i, s:i, s:i}", "tol", info->cost[i].tol, "sheet_planes",
                                               info->cost[i].n_plane, "sheet_taps", info->cost[i].n_tap, "taylor_terms",
                                               info->cost[i].n_taylor, "jacobi_terms", info->cost[i].n_jacobi));
    for (int i = 0; i < N_TRUST; i++)
        json_array_append_new(trusts, json_pack("{s:f, s:f, s:s, s:s}", "theta_i_deg", info->trust[i].theta_deg,
                                                "lambda_nm", info->trust[i].lambda_nm, "trust",
                                                dif_trust_name(info->trust[i].trust), "text", info->trust[i].line));
    json_object_set_new(object, "periods", periods);
    json_object_set_new(object, "accuracy", costs);
    json_object_set_new(object, "trust", trusts);
    return object;
}

static json_t *json_surface(const info_surface *info, const dif_manifest *manifest)
{
    const dif_field *field = &info->file->field;
    const dif_field_stats *stats = &info->stats;
    json_t *object = json_pack("{s:s, s:s, s:s, s:i, s:i, s:f, s:f}", "kind", "surface", "format", info->file->format,
                               "title", info->file->title, "nx", field->nx, "ny", field->ny, "pitch_x_nm",
                               dif_nm_from_um(field->pitch_x_um), "pitch_y_nm", dif_nm_from_um(field->pitch_y_um));
    json_object_set_new(object, "channels", dif_info_channels_json(info->channels, info->file->channel));
    json_object_set_new(object, "heights",
                        json_pack("{s:f, s:f, s:f, s:f, s:f, s:i}", "min_um", stats->min_um, "max_um", stats->max_um,
                                  "mean_um", stats->mean_um, "rms_um", stats->rms_um, "step_nm",
                                  dif_nm_from_um(info->file->step_um), "bits", info->file->bits));
    json_object_set_new(object, "slopes",
                        json_pack("{s:f, s:f, s:f}", "x_rms", stats->slope_x_rms, "y_rms", stats->slope_y_rms, "max",
                                  stats->slope_max));
    json_object_set_new(object, "sampling",
                        json_pack("{s:f, s:f, s:b}", "lambda_min_nm", info->lambda_min_nm, "lambda_finest_nm",
                                  info->lambda_finest_nm, "fine_enough",
                                  info->lambda_finest_nm <= info->lambda_min_nm));
    json_object_set_new(object, "phase_rad", dif_json_number(info->phase_rad));
    json_object_set_new(object, "taylor_digits_lost", dif_json_number(info->taylor_digits_lost));
    json_object_set_new(object, "provenance", dif_json_manifest(manifest));
    return json_lists(info, object);
}

dif_status dif_info_surface(const dif_cli *cli, const dif_cli_input *input, double lambda_min_nm, double lambda_max_nm,
                            dif_error *err)
{
    info_surface info = {.lambda_min_nm = lambda_min_nm, .lambda_max_nm = lambda_max_nm};
    dif_manifest manifest = {0};
    dif_status status = gather(cli, input, &info, err);
    if (!status && cli->json) {
        status = dif_cli_manifest(cli, cli->operand[0], &manifest, err);
        if (!status && dif_json_print(cli, json_surface(&info, &manifest)) != DIF_EXIT_DONE)
            status = dif_fail(err, DIF_ERR_NOMEM, "out of memory");
        dif_manifest_free(&manifest);
    } else if (!status) {
        print_surface(&info);
        print_use(&info);
        print_trust(&info);
    }
    return status;
}
