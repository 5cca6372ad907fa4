#include "core/model.h"

#include <math.h>
#include <stddef.h>

static const char *const NAMES[] = {"sheet", "nmm", "pq", "lut", "stam"};
enum { N_KIND = sizeof NAMES / sizeof *NAMES };

const char *dif_model_kind_name(dif_model_kind kind)
{
    return NAMES[kind];
}

static dif_status check_sheets(const dif_model *model, dif_error *err)
{
    double sum = 0.0;
    if (!(model->n_sheet >= 1 && model->sheet && model->share))
        return dif_fail(err, DIF_ERR_ARG, "a model by %s without sheets", NAMES[model->kind]);
    for (int i = 0; i < model->n_sheet; i++) {
        if (!model->sheet[i])
            return dif_fail(err, DIF_ERR_ARG, "sheet %d of the model is missing", i);
        const dif_sheet_info info = dif_sheet_info_of(model->sheet[i]), first = dif_sheet_info_of(model->sheet[0]);
        if (info.is_line != first.is_line || fabs(info.azimuth_rad - first.azimuth_rad) > 0.0)
            return dif_fail(err, DIF_ERR_ARG, "sheet %d of the model is of another form than the first", i);
        if (!(model->share[i] >= 0.0))
            return dif_fail(err, DIF_ERR_ARG, "share %d of the model is %g, want >= 0", i, model->share[i]);
        sum += model->share[i];
    }
    if (!(fabs(sum - 1.0) < 1e-9))
        return dif_fail(err, DIF_ERR_ARG, "shares of the model's sheets add up to %.9g, want 1", sum);
    return DIF_OK;
}

static dif_status check_lut(const dif_lut *lut, dif_error *err)
{
    if (!(lut && lut->coef))
        return dif_fail(err, DIF_ERR_ARG, "a model by lut without a table");
    if (!(lut->n_azimuth >= 1 && lut->n_radius >= 2 && lut->n_map >= 1 && lut->n_map <= DIF_LUT_MAP_MAX))
        return dif_fail(err, DIF_ERR_ARG, "a table of %d azimuths x %d radii x %d maps", lut->n_azimuth, lut->n_radius,
                        lut->n_map);
    if (!(lut->s0 > 0.0 && isfinite(lut->s0)))
        return dif_fail(err, DIF_ERR_ARG, "a table whose rows begin at s0 = %g, want > 0", lut->s0);
    return DIF_OK;
}

static dif_status check_wavelengths(const dif_model *model, dif_error *err)
{
    if (model->n_lambda < 0 || (model->n_lambda > 0 && !model->lambda_um))
        return dif_fail(err, DIF_ERR_ARG, "%d wavelengths in the model", model->n_lambda);
    for (int i = 0; i < model->n_lambda; i++) {
        const double least = i > 0 ? model->lambda_um[i - 1] : 0.0;
        if (!(model->lambda_um[i] > least && model->lambda_um[i] < 1e6))
            return dif_fail(err, DIF_ERR_ARG, "wavelength %d of the model is %g um, want > %g", i, model->lambda_um[i],
                            least);
    }
    return DIF_OK;
}

static dif_status check_shadow(const dif_shadow *shadow, dif_error *err)
{
    if (!((int)shadow->kind >= DIF_SHADOWING_NONE && shadow->kind <= DIF_SHADOWING_NDF))
        return dif_fail(err, DIF_ERR_ARG, "shadowing %d is none", (int)shadow->kind);
    if (shadow->kind == DIF_SHADOWING_NONE || shadow->kind == DIF_SHADOWING_VCAVITY)
        return DIF_OK;
    if (!(shadow->g && shadow->n_row >= 2 && shadow->n_column >= 1))
        return dif_fail(err, DIF_ERR_ARG, "%s shadowing with a table of %d x %d", dif_shadowing_name(shadow->kind),
                        shadow->n_row, shadow->n_column);
    return dif_slope_check(&shadow->slopes, err);
}

static dif_status check_quantity(const dif_model *model, dif_error *err)
{
    if (!((int)model->quantity >= DIF_QUANTITY_POWER && model->quantity <= DIF_QUANTITY_BRDF))
        return dif_fail(err, DIF_ERR_ARG, "quantity %d is none", (int)model->quantity);
    if (!(model->index.n > 0.0 && model->index.kappa >= 0.0 && model->index.n < 1e6 && model->index.kappa < 1e6))
        return dif_fail(err, DIF_ERR_ARG, "refractive index %g + %gi, want n > 0 and kappa >= 0", model->index.n,
                        model->index.kappa);
    if (model->quantity != DIF_QUANTITY_BRDF)
        return DIF_OK;
    if (model->kind == DIF_MODEL_LUT)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "a lut has no absolute BRDF: its wavelengths are summed already");
    if (!(model->area_um2 > 0.0 && isfinite(model->area_um2)))
        return dif_fail(err, DIF_ERR_ARG, "an effective area of %g um^2, want > 0", model->area_um2);
    return DIF_OK;
}

dif_status dif_model_check(const dif_model *model, dif_error *err)
{
    if (!((int)model->kind >= 0 && (int)model->kind < N_KIND))
        return dif_fail(err, DIF_ERR_ARG, "model kind %d is none", (int)model->kind);
    const bool has_sheets = model->kind != DIF_MODEL_LUT && model->kind != DIF_MODEL_STAM;
    dif_status status = check_quantity(model, err);
    if (status == DIF_OK && model->shadow)
        status = check_shadow(model->shadow, err);
    if (status == DIF_OK && has_sheets)
        status = check_sheets(model, err);
    if (status == DIF_OK && model->kind == DIF_MODEL_NMM)
        status = dif_nmm_check(&model->nmm, err);
    if (status == DIF_OK && model->kind == DIF_MODEL_PQ)
        status = dif_replica_check(&model->replica, err);
    if (status == DIF_OK && model->kind == DIF_MODEL_STAM)
        status = dif_stam_check(&model->stam, err);
    if (status == DIF_OK && model->kind == DIF_MODEL_LUT)
        status = check_lut(model->lut, err);
    if (status == DIF_OK && model->kind != DIF_MODEL_LUT && model->kind != DIF_MODEL_NMM)
        status = check_wavelengths(model, err);
    return status;
}
