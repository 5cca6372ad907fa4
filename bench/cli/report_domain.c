#include <math.h>
#include <stdarg.h>
#include <stdio.h>

#include "bench/cli/report_job.h"
#include "core/domain.h"
#include "core/units.h"

/* Appends {"level", "text"}; false if memory is short. */
static bool say(json_t *list, const char *level, const char *format, ...) DIF_PRINTF(3, 4);

static bool say(json_t *list, const char *level, const char *format, ...)
{
    char text[DIF_REPORT_TEXT];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return json_array_append_new(list, json_pack("{s:s, s:s}", "level", level, "text", text)) == 0;
}

/* Is the pitch fine enough for the largest spatial frequency that the table asks for? */
static bool say_pitch(json_t *list, const dif_report_job *job)
{
    const dif_plan *plan = &job->plan;
    double sin_max = 0.0, sin_sum, cos_sum;
    for (int i = 0; i < plan->n_angle; i++) {
        dif_plan_transfer(plan, i, &sin_sum, &cos_sum);
        sin_max = fmax(sin_max, fabs(sin_sum));
    }
    const double f_max = sin_max / plan->lambda_um[0];
    const double pitch_um = fmax(job->field.pitch_x_um, job->field.pitch_y_um);
    const bool fine = pitch_um * f_max <= 0.5;
    return say(
        list, fine ? "good" : "beyond",
        "Sampling: the pitch of %.4g nm carries spatial frequencies up to %.3g per µm; the table asks for up to %.3g "
        "per µm (λ = %g nm)%s.",
        dif_nm_from_um(pitch_um), 0.5 / pitch_um, f_max, dif_nm_from_um(plan->lambda_um[0]),
        fine ? "" : ", where the surface is not known and the answer is an alias of lower frequencies");
}

/* The main period and the height against the wavelength, judged by core/domain.h. */
static bool say_scale(json_t *list, const dif_report_job *job, const dif_report_data *data)
{
    static const char *const levels[] = {
        [DIF_TRUST_NONE] = "beyond", [DIF_TRUST_DOMINANT] = "caution", [DIF_TRUST_SHARES] = "good"};
    const dif_plan *plan = &job->plan;
    const double shortest = plan->lambda_um[0], longest = plan->lambda_um[plan->n_lambda - 1];
    double period_um = job->known_period_um;
    if (!isfinite(period_um))
        period_um = data->fit_status == DIF_OK ? data->fit.period_um : data->surface.period_um;
    const double height_um = job->has_grating ? job->grating.height_um : data->field.max_um - data->field.min_um;
    if (!(period_um > 0.0))
        return say(list, "caution",
                   "No period was determined, so the ratio of period to wavelength cannot be judged. "
                   "Height over wavelength: %.2g to %.2g.",
                   height_um / longest, height_um / shortest);
    dif_relief relief = DIF_RELIEF_MEASURED;
    if (job->has_grating)
        relief = job->grating.profile == DIF_PROFILE_SINE || job->grating.profile == DIF_PROFILE_TRIANGLE
                     ? DIF_RELIEF_SMOOTH
                     : DIF_RELIEF_WALLS;
    double theta_rad = fabs(plan->fixed_rad);
    for (int i = 0; plan->fixed_is_wo && i < plan->n_angle; i++)
        theta_rad = fmax(theta_rad, fabs(plan->angle_rad[i]));
    const char *line = "";
    const dif_trust trust = dif_domain_verdict(relief, period_um / longest, height_um / shortest, theta_rad, &line);
    return say(list, levels[trust],
               "Powers: period over wavelength is %.2g to %.2g, height over wavelength %.2g to %.2g, incidence up to "
               "%.3g°. %s",
               period_um / longest, period_um / shortest, height_um / longest, height_um / shortest,
               dif_deg_from_rad(theta_rad), line);
}

/* Slopes that the light, or the detector, at this angle does not see: the model has no shadows. */
static bool say_slopes(json_t *list, const dif_report_job *job, const dif_report_data *data)
{
    const double limit = 1.0 / tan(fmax(fabs(job->plan.fixed_rad), 1e-6));
    const double rms = hypot(data->field.slope_x_rms, data->field.slope_y_rms);
    const char *level = data->field.slope_max <= limit ? "good" : rms <= 0.5 * limit ? "caution" : "beyond";
    return say(
        list, level,
        "Slopes: rms %.2g, largest %.2g. At %.3g° every slope above %.2g that faces away is in shadow; the model has "
        "no shadows and no second reflections%s.",
        rms, data->field.slope_max, dif_deg_from_rad(fabs(job->plan.fixed_rad)), limit,
        data->field.slope_max <= limit ? ", and needs none here" : "");
}

static bool say_grazing(json_t *list, const dif_report_job *job)
{
    const dif_plan *plan = &job->plan;
    const double first = fabs(plan->angle_rad[0]), last = fabs(plan->angle_rad[plan->n_angle - 1]);
    const double steepest = dif_deg_from_rad(fmax(first, last));
    if (steepest <= 75.0)
        return say(list, "good", "Grazing angles: the table ends at %.3g°.", steepest);
    return say(
        list, "caution",
        "Grazing angles: beyond about 75° the Kirchhoff factor 1/cos θ grows without limit and polarisation matters; "
        "the table goes to %.3g°. The places of the lines hold there, the powers do not.",
        steepest);
}

static bool say_speckle(json_t *list, const dif_report_job *job, const dif_report_data *data)
{
    if (job->is_grating)
        return true;
    if (data->stats.n_window > 1)
        return say(list, "good",
                   "Speckle: the powers of %d windows are averaged, an estimate of the expectation; its "
                   "relative scatter is about 1/√%d at best.",
                   data->stats.n_window, data->stats.n_window);
    return say(list, "caution",
               "Speckle: one window is one realisation. Its single maxima are places of constructive "
               "interference, not periods of the surface.");
}

static bool say_steps(json_t *list, const dif_report_job *job)
{
    if (!(job->step_um > 0.0))
        return true;
    const double share = job->step_um / job->plan.lambda_um[0];
    return say(
        list, share <= 0.01 ? "good" : "caution",
        "Quantisation: heights come in steps of %.3g nm, 1/%.0f of the shortest wavelength; a step turns the phase by "
        "up to %.2g turns.",
        dif_nm_from_um(job->step_um), 1.0 / share, 2.0 * share);
}

json_t *dif_report_domain(const dif_report_job *job, const dif_report_data *data)
{
    json_t *list = json_array();
    const bool ok = list && say_pitch(list, job) && say_scale(list, job, data) && say_slopes(list, job, data) &&
                    say_grazing(list, job) && say_speckle(list, job, data) && say_steps(list, job);
    if (ok)
        return list;
    json_decref(list);
    return NULL;
}
