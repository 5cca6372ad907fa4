/* Running the steps of preparation: each says what it did, and the file remembers it. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench/cli/cli.h"
#include "bench/cli/prep.h"
#include "bench/fit.h"
#include "core/alloc.h"
#include "core/io/file.h"
#include "core/prep.h"
#include "core/units.h"

/* A plane that takes more of the variance than this is worth a hint. */
static const double TILT_TOLD = 0.1;

/* So many points are no defects. */
static const double DEFECTS_TOLD = 0.01;

/* Farther from a measured point (samples), and with a larger residual, what was filled is told to be uncertain. */
enum { REACH_TOLD = 20 };
static const double RESIDUAL_TOLD = 1e-4;

enum { NOTE_SIZE = 320 };

/* What a step works on and what it has to say. */
typedef struct work {
    const dif_cli *cli;
    const dif_cli_surface *surface;
    const char *path;
    dif_field *field;
    char note[NOTE_SIZE];
} work;

static dif_status run_level(work *w, const dif_cli_step *step, dif_error *err)
{
    int degree = step->choice;
    if (degree == DIF_LEVEL_CHOICE_NONE)
        return DIF_OK;
    if (degree != DIF_LEVEL_CHOICE_AUTO)
        return dif_prep_level(w->field, degree, err);
    const dif_status status = dif_prep_level_auto(w->field, &degree, err);
    snprintf(w->note, sizeof w->note, "polynomial of degree %d", degree);
    return status;
}

static dif_status run_lines(work *w, const dif_cli_step *step, dif_error *err)
{
    return dif_prep_lines(w->field, (dif_prep_lines_method)step->choice, err);
}

static dif_status run_defects(work *w, const dif_cli_step *step, dif_error *err)
{
    const bool is_scars = step->kind == DIF_STEP_SCARS_NM || step->kind == DIF_STEP_SCARS_SIGMA;
    const bool in_sigma = step->kind == DIF_STEP_DESPIKE_SIGMA || step->kind == DIF_STEP_SCARS_SIGMA;
    const dif_prep_limit limit = {in_sigma, in_sigma ? step->value : dif_um_from_nm(step->value)};
    size_t n = 0;
    const dif_status status = (is_scars ? dif_prep_scars : dif_prep_despike)(w->field, limit, &n, err);
    const double share = (double)n / (double)dif_field_n(w->field);
    snprintf(w->note, sizeof w->note, "%zu points replaced (%.3g %%%s)", n, 100.0 * share,
             share > DEFECTS_TOLD ? ": rather structure than defects, raise the limit" : "");
    return status;
}

static dif_status run_fill(work *w, const dif_cli_step *step, dif_error *err)
{
    dif_prep_filled filled;
    const dif_status status = dif_prep_fill(w->field, (dif_prep_fill_method)step->choice, &filled, err);
    if (filled.n == 0)
        snprintf(w->note, sizeof w->note, "nothing was missing");
    else
        snprintf(w->note, sizeof w->note,
                 "%zu points filled (%.3g %%), the farthest %d samples from a measured one%s%s", filled.n,
                 100.0 * (double)filled.n / (double)dif_field_n(w->field), filled.reach,
                 filled.reach > REACH_TOLD ? ": a guess so far in" : "",
                 filled.residual > RESIDUAL_TOLD ? ", equations not solved to the end" : "");
    return status;
}

static dif_status run_crop(work *w, const dif_cli_step *step, dif_error *err)
{
    const dif_prep_box box = {step->box[0], step->box[1], step->box[2], step->box[3]};
    return dif_prep_crop(w->field, &box, err);
}

static dif_status run_resample(work *w, const dif_cli_step *step, dif_error *err)
{
    const double pitch_um = dif_um_from_nm(step->value);
    return dif_prep_resample(w->field, pitch_um, pitch_um, err);
}

static dif_status run_rotate(work *w, const dif_cli_step *step, dif_error *err)
{
    return dif_prep_rotate(w->field, dif_rad_from_deg(step->value), err);
}

static dif_status run_highpass(work *w, const dif_cli_step *step, dif_error *err)
{
    return dif_prep_highpass(w->field, step->value, err);
}

/* The fit of the field's period; `name` says in an error what wanted it. */
static dif_status fit_period(const dif_field *field, const char *name, double start_um, double psi_rad,
                             dif_fit_surface_result *fit, dif_error *err)
{
    dif_fit_surface_opts opts = dif_fit_surface_opts_default();
    dif_error detail = {0};
    opts.period_start_um = start_um;
    opts.psi_start_rad = psi_rad;
    const dif_status status = dif_fit_surface(field, &opts, fit, &detail);
    return status ? dif_fail(err, status, "--%s needs a period: %.150s", name, detail.text) : DIF_OK;
}

/* The second period of a crossed grating: a strong wave within 3 degrees of a right angle to the first, or NaN. */
static double find_across(const dif_field *field, double psi_rad)
{
    static const double share_min = 0.1;
    dif_spectrum_peak peak[8];
    dif_fit_surface_result fit;
    int n = 0;
    if (dif_fit_spectrum_peaks(field, DIF_COUNT(peak), peak, &n, NULL) != DIF_OK)
        return (double)NAN;
    for (int i = 0; i < n; i++)
        if (peak[i].share > share_min && fabs(cos(peak[i].psi_rad - psi_rad)) < 0.05 &&
            fit_period(field, "", peak[i].period_um, peak[i].psi_rad, &fit, NULL) == DIF_OK)
            return fit.period_um;
    return (double)NAN;
}

static dif_status run_whole_periods(work *w, const dif_cli_step *step, dif_error *err)
{
    dif_fit_surface_result fit;
    int n[2];
    dif_status status = dif_prep_state_of(w->field).n_missing
                            ? dif_fail(err, DIF_ERR_NONFINITE, "missing points: --fill before it")
                            : fit_period(w->field, dif_cli_step_name(step->kind), (double)NAN, (double)NAN, &fit, err);
    if (status)
        return status;
    const dif_prep_lattice lattice = {fit.period_um, fit.psi_rad, find_across(w->field, fit.psi_rad)};
    status = dif_prep_whole_periods(w->field, &lattice, n, err);
    snprintf(w->note, sizeof w->note, "%d periods of %.6g nm along azimuth %.4g deg", n[0],
             dif_nm_from_um(fit.period_um), dif_deg_from_rad(fit.psi_rad));
    const size_t used = strlen(w->note);
    if (n[1] > 0)
        snprintf(w->note + used, sizeof w->note - used, ", %d of %.6g nm across", n[1],
                 dif_nm_from_um(lattice.across_um));
    return status;
}

/* The calibration scan, not prepared: by its own scale, or by what was said of the surface's if it has none. */
static dif_status fit_other(work *w, const char *path, const char *name, double start_um, dif_fit_surface_result *fit,
                            char hex[65], dif_error *err)
{
    const dif_cli_prep bare = {.n = 1, .step = {{.kind = DIF_STEP_LEVEL, .choice = DIF_LEVEL_CHOICE_NONE}}};
    dif_cli_surface own = dif_cli_surface_default(), said = *w->surface;
    dif_field_file other = {0};
    unsigned char *data = NULL;
    size_t n = 0;
    own.prep = said.prep = bare;
    dif_status status = dif_file_read(path, (size_t)1 << 33, &data, &n, err);
    if (!status) {
        dif_sha256_hex(data, n, hex);
        status = dif_cli_surface_read(w->cli, path, &own, &other, err);
    }
    if (status == DIF_ERR_SCALE)
        status = dif_cli_surface_read(w->cli, path, &said, &other, err);
    if (!status)
        status = fit_period(&other.field, name, start_um, (double)NAN, fit, err);
    dif_field_file_free(&other);
    dif_release(data);
    return status;
}

static dif_status run_calibrate(work *w, const dif_cli_step *step, dif_error *err)
{
    const char *with = w->surface->prep.calibrate_with, *name = dif_cli_step_name(step->kind);
    const double known_um = dif_um_from_nm(step->value);
    char hex[65] = "";
    dif_fit_surface_result fit;
    dif_status status;
    if (with)
        status = fit_other(w, with, name, known_um, &fit, hex, err);
    else if (dif_prep_state_of(w->field).n_missing)
        status = dif_fail(err, DIF_ERR_NONFINITE, "missing points: --fill before it");
    else
        status = fit_period(w->field, name, known_um, (double)NAN, &fit, err);
    if (status)
        return status;
    const double factor = known_um / fit.period_um;
    w->field->pitch_x_um *= factor;
    w->field->pitch_y_um *= factor;
    snprintf(w->note, sizeof w->note,
             "pitch multiplied by %.8g +- %.2g (%.7g nm fitted along azimuth %.4g deg to %s%.100s%s%s%s)", factor,
             factor * fit.period_uncertainty_um / fit.period_um, dif_nm_from_um(fit.period_um),
             dif_deg_from_rad(fit.psi_rad), with ? "'" : "the surface itself", with ? with : "", with ? "'" : "",
             with ? ", sha256 " : "", hex);
    return DIF_OK;
}

static dif_status (*const RUN[])(work *w, const dif_cli_step *step, dif_error *err) = {
    [DIF_STEP_LEVEL] = run_level,         [DIF_STEP_LINES] = run_lines,
    [DIF_STEP_DESPIKE_NM] = run_defects,  [DIF_STEP_DESPIKE_SIGMA] = run_defects,
    [DIF_STEP_SCARS_NM] = run_defects,    [DIF_STEP_SCARS_SIGMA] = run_defects,
    [DIF_STEP_FILL] = run_fill,           [DIF_STEP_CROP] = run_crop,
    [DIF_STEP_RESAMPLE] = run_resample,   [DIF_STEP_ROTATE] = run_rotate,
    [DIF_STEP_HIGHPASS] = run_highpass,   [DIF_STEP_WHOLE_PERIODS] = run_whole_periods,
    [DIF_STEP_CALIBRATE] = run_calibrate,
};

/* One line of a step: its flag, its own note, sizes if they changed, heights if they did. */
static void describe(const work *w, const dif_cli_step *step, const dif_field *before, double rms_before_um,
                     char line[2 * NOTE_SIZE])
{
    const dif_field *after = w->field;
    const double rms_um = dif_prep_state_of(after).rms_um;
    const size_t room = 2 * NOTE_SIZE;
    const size_t n = (size_t)snprintf(line, room, "%s%s%.60s: %s", dif_cli_step_name(step->kind), step->text ? " " : "",
                                      step->text ? step->text : "", w->note);
    if (after->nx != before->nx || after->ny != before->ny || after->pitch_x_um != before->pitch_x_um)
        snprintf(line + n, room - n, "%s%d x %d samples of %.6g x %.6g nm (from %d x %d of %.6g x %.6g nm)",
                 w->note[0] ? ", " : "", after->nx, after->ny, dif_nm_from_um(after->pitch_x_um),
                 dif_nm_from_um(after->pitch_y_um), before->nx, before->ny, dif_nm_from_um(before->pitch_x_um),
                 dif_nm_from_um(before->pitch_y_um));
    else
        snprintf(line + n, room - n, "%srms %.4g nm (from %.4g nm)", w->note[0] ? ", " : "", dif_nm_from_um(rms_um),
                 dif_nm_from_um(rms_before_um));
}

static void remember(dif_field_file *file, const char *line)
{
    const size_t n = strlen(file->history);
    snprintf(file->history + n, sizeof file->history - n, "%s%s", n ? "; " : "", line);
}

static void say(const work *w, const char *line)
{
    const bool has_many = w->cli->n_operand > 1;
    dif_cli_say(w->cli, "%s%s%s", has_many ? w->path : "", has_many ? ": " : "", line);
}

/* A hint at heights that were measured and not levelled. */
static dif_status hint(const work *w, const dif_field_file *file, dif_error *err)
{
    dif_prep_tilt tilt;
    char line[200];
    for (int i = 0; i < w->surface->prep.n; i++)
        if (w->surface->prep.step[i].kind == DIF_STEP_LEVEL || w->surface->prep.step[i].kind == DIF_STEP_HIGHPASS)
            return DIF_OK;
    if (dif_cli_fixture_name(file))
        return DIF_OK;
    const dif_status status = dif_prep_tilt_of(w->field, &tilt, err);
    if (status || tilt.share < TILT_TOLD)
        return status;
    const double rms_um = dif_prep_state_of(w->field).rms_um;
    snprintf(
        line, sizeof line,
        "not levelled: a tilt of %.3g deg makes %.0f %% of the heights' variance (rms %.4g nm, %.4g nm without it); "
        "--level plane takes it off, --level none keeps it",
        dif_deg_from_rad(atan(hypot(tilt.slope_x, tilt.slope_y))), 100.0 * tilt.share, dif_nm_from_um(rms_um),
        dif_nm_from_um(rms_um * sqrt(1.0 - tilt.share)));
    say(w, line);
    return DIF_OK;
}

/* The steps, one after the other. */
static dif_status run_steps(work *w, dif_field_file *file, dif_error *err)
{
    const dif_cli_prep *prep = &w->surface->prep;
    for (int i = 0; i < prep->n; i++) {
        const dif_field before = *w->field;
        const double rms_um = dif_prep_state_of(w->field).rms_um;
        char line[2 * NOTE_SIZE];
        dif_error detail = {0};
        w->note[0] = '\0';
        const dif_status status = RUN[prep->step[i].kind](w, &prep->step[i], &detail);
        if (status)
            return dif_fail(err, status, "%.60s: %s: %.150s", w->path, dif_cli_step_name(prep->step[i].kind),
                            detail.text);
        if (prep->step[i].kind == DIF_STEP_LEVEL && prep->step[i].choice == DIF_LEVEL_CHOICE_NONE)
            continue;
        describe(w, &prep->step[i], &before, rms_um, line);
        say(w, line);
        remember(file, line);
    }
    return DIF_OK;
}

static dif_status check_calibration(const char *path, const dif_cli_prep *prep, dif_error *err)
{
    bool is_used = !prep->calibrate_with;
    for (int i = 0; i < prep->n; i++)
        is_used = is_used || prep->step[i].kind == DIF_STEP_CALIBRATE;
    return is_used ? DIF_OK : dif_fail(err, DIF_ERR_ARG, "%s: --calibrate-with needs --calibrate-nm", path);
}

dif_status dif_cli_prep_apply(const dif_cli *cli, const char *path, const dif_cli_surface *surface,
                              dif_field_file *file, dif_error *err)
{
    work w = {.cli = cli, .surface = surface, .path = path, .field = &file->field};
    dif_status status = check_calibration(path, &surface->prep, err);
    if (status || (status = run_steps(&w, file, err)))
        return status;
    const size_t n_missing = dif_prep_state_of(w.field).n_missing;
    if (n_missing > 0)
        return dif_fail(err, DIF_ERR_NONFINITE, "%s: %zu of %zu heights are missing, expected --fill", path, n_missing,
                        dif_field_n(w.field));
    return hint(&w, file, err);
}
