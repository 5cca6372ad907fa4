/* One case: two answers to one question, held against each other. */
#include <math.h>
#include <string.h>

#include "bench/regress_impl.h"
#include "bench/table_cut.h"
#include "core/alloc.h"
#include "core/io/map_io.h"
#include "core/units.h"

/* Beyond this angle gains rise too fast for a ridge model. */
static const double ANGLE_FIT_MAX_RAD = 75.0 * DIF_PI / 180.0;

static dif_fit_table_opts fit_opts(const dif_field *field, const dif_regress_plan *plan, const dif_measure_opts *opts)
{
    dif_fit_table_opts how = dif_fit_table_opts_default();
    const double c = fabs(cos(plan->table->azimuth_rad)), s = fabs(sin(plan->table->azimuth_rad));
    how.line = (dif_fit_line){.known = true,
                              .window = {.kind = opts->window, .sigma_um = opts->sigma_um},
                              .size_x_um = field->nx * field->pitch_x_um,
                              .size_y_um = field->ny * field->pitch_y_um,
                              .average = opts->average,
                              .pitch_um = s < 1e-9   ? field->pitch_x_um
                                          : c < 1e-9 ? field->pitch_y_um
                                                     : (double)NAN};
    how.index = opts->index;
    how.common_period = plan->is_grating;
    if (plan->is_grating)
        how.n_ridge_max = DIF_FIT_RIDGE_MAX;
    return how;
}

/* One side's period. Running out of memory is the run's failure, anything else a result. */
static dif_status fit_side(const dif_regress_plan *plan, const dif_fit_table_opts *how, const dif_table *table,
                           dif_status *found, double *period_um, double *sd_um, char text[240], dif_error *err)
{
    dif_table part;
    dif_fit_result fit;
    dif_error why = {DIF_OK, ""};
    const dif_status status =
        dif_table_cut(table, plan->f_min_per_um, plan->f_max_per_um, ANGLE_FIT_MAX_RAD, &part, err);
    *period_um = *sd_um = (double)NAN;
    if (status != DIF_OK)
        return status;
    *found = dif_fit_table(&part, how, &fit, &why);
    dif_table_free(&part);
    if (*found == DIF_OK) {
        *period_um = fit.period_um;
        *sd_um = fit.period_uncertainty_um;
    } else if (!*text) {
        memcpy(text, why.text, sizeof why.text);
    }
    return *found == DIF_ERR_NOMEM ? dif_fail(err, DIF_ERR_NOMEM, "%s", why.text) : DIF_OK;
}

static dif_status fit_both(const dif_field *field, const dif_regress_plan *plan, const dif_measure_opts *opts,
                           const dif_table *device, const dif_table *reference, dif_regress_fit *out, dif_error *err)
{
    const dif_fit_table_opts how = fit_opts(field, plan, opts);
    dif_status status =
        fit_side(plan, &how, reference, &out->reference, &out->reference_um, &out->reference_sd_um, out->text, err);
    if (status == DIF_OK)
        status = fit_side(plan, &how, device, &out->device, &out->device_um, &out->device_sd_um, out->text, err);
    out->tried = status == DIF_OK;
    return status;
}

/* Maxima outside the mirror beam. */
static dif_status compare_peaks(const dif_regress_plan *plan, const dif_table *device, const dif_table *reference,
                                dif_regress_case *out, dif_error *err)
{
    dif_table a = {0}, b = {0};
    dif_status status = dif_table_cut(device, plan->f_min_per_um, INFINITY, 0.5 * DIF_PI, &a, err);
    if (status == DIF_OK)
        status = dif_table_cut(reference, plan->f_min_per_um, INFINITY, 0.5 * DIF_PI, &b, err);
    if (status == DIF_OK)
        status = dif_regress_peaks_of(&a, &b, plan->peak_floor_share, &out->peaks, err);
    out->has_peaks = status == DIF_OK;
    dif_table_free(&a);
    dif_table_free(&b);
    return status;
}

static dif_status judge_table(const dif_field *field, const dif_regress_plan *plan, const dif_measure_opts *opts,
                              double *device, double *reference, dif_regress_case *out, dif_error *err)
{
    const dif_table a = {*plan->table, DIF_QUANTITY_POWER, device}, b = {*plan->table, DIF_QUANTITY_POWER, reference};
    dif_status status = dif_regress_tables(&a, &b, plan->floor_share, &out->values, err);
    /* a table by few wavelengths has steps, whose maxima have no place */
    if (status == DIF_OK && out->method != DIF_REGRESS_NMM && out->method != DIF_REGRESS_NMM_LINES)
        status = compare_peaks(plan, &a, &b, out, err);
    if (status == DIF_OK && plan->fit && out->method == DIF_REGRESS_SHEET)
        status = fit_both(field, plan, opts, &a, &b, &out->fit, err);
    return status;
}

/* The exposure that a picture of the reference's map would have: what shines outside the mirror beam is seen. */
static dif_status choose_exposure(const dif_regress_plan *plan, const double *reference, double *exposure,
                                  dif_error *err)
{
    const size_t n = 3 * (size_t)plan->n_pixel * (size_t)plan->n_pixel;
    dif_map_image image = {.n_pixel = plan->n_pixel,
                           .theta_rad = acos(fmin(plan->wi.z, 1.0)),
                           .phi_rad = atan2(plan->wi.y, plan->wi.x),
                           .xyz = dif_alloc(n, sizeof(float))};
    if (!image.xyz)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for the exposure of %d pixels across", plan->n_pixel);
    for (size_t i = 0; i < n; i++)
        image.xyz[i] = isfinite(reference[i]) ? (float)reference[i] : 0.0f;
    *exposure = dif_map_exposure(&image);
    dif_release(image.xyz);
    return DIF_OK;
}

dif_status dif_regress_judge(const dif_field *field, const dif_regress_plan *plan, const dif_measure_opts *opts,
                             double *device, double *reference, dif_regress_case *out, dif_error *err)
{
    const size_t n = (size_t)plan->n_pixel * (size_t)plan->n_pixel;
    if (out->question == DIF_REGRESS_TABLE)
        return judge_table(field, plan, opts, device, reference, out, err);
    if (out->question == DIF_REGRESS_MAP)
        return dif_regress_values(n * (size_t)plan->n_layer, device, reference, plan->floor_share, &out->values, err);
    dif_status status = dif_regress_values(3 * n, device, reference, plan->floor_share, &out->values, err);
    if (status == DIF_OK)
        status = choose_exposure(plan, reference, &out->exposure, err);
    if (status == DIF_OK)
        status = dif_regress_colours(n, (double(*)[3])device, (double(*)[3])reference, out->exposure, &out->de, err);
    out->has_colours = status == DIF_OK;
    return status;
}
