/* One pass: the parameters of each sheet, its dispatch, and the sum of all. */
#include <math.h>
#include <stddef.h>

#include "core/sheet_impl.h"
#include "core/units.h"
#include "gpu/gpu_eval_impl.h"

_Static_assert(sizeof(dif_eval_block) == 10 * 16, "std140: ten vectors");
_Static_assert(offsetof(dif_eval_block, job) == 48 && offsetof(dif_eval_block, gain) == 96, "std140");
_Static_assert(sizeof(dif_eval_lut_block) == 4 * 16 && offsetof(dif_eval_lut_block, job) == 32, "std140");

/* Moves the waves to a sheet's axes, unless they are there already. */
static void set_waves(dif_gpu_eval *eval, const dif_eval_pass *ps, const dif_sheet *sheet, const dif_sheet *last)
{
    const bool same = last && sheet && !(fabs(last->s.step - sheet->s.step) > 0.0) &&
                      !(fabs(last->y.step - sheet->y.step) > 0.0) && !(fabs(last->z.step - sheet->z.step) > 0.0);
    if (same)
        return;
    if (ps->job == DIF_JOB_IS_VALUES)
        dif_eval_waves_of_values(eval, sheet);
    else if (eval->model->kind == DIF_MODEL_NMM)
        dif_eval_waves_of_few(eval, sheet);
    else
        dif_eval_waves_of(eval, sheet, ps->n_lambda, ps->lambda_um,
                          ps->job == DIF_JOB_IS_COLOURS ? eval->weight : NULL);
}

static void set_axis(const dif_axis *axis, int out[4])
{
    out[0] = axis->first;
    out[1] = axis->n;
    out[2] = axis->period;
    out[3] = 0;
}

static void set_params(dif_gpu_eval *eval, const dif_eval_pass *ps, const dif_sheet *sheet, double share, bool add)
{
    const dif_model *model = eval->model;
    dif_eval_block *p = &eval->params;
    const float *root = eval->root;
    *p = (dif_eval_block){
        .root = {root[0], root[1], root[2], 0.0f},
        .job = {ps->n, ps->n_lambda, add, 0},
        .gain = {(float)share, (float)model->index.n, (float)model->index.kappa, (float)model->area_um2}};
    if (sheet) {
        set_axis(&sheet->s, p->axis_s);
        set_axis(&sheet->y, p->axis_y);
        set_axis(&sheet->z, p->axis_z);
    }
    if (model->kind == DIF_MODEL_PQ) {
        p->copies[0] = model->replica.nx;
        p->copies[1] = model->replica.ny;
    }
    if (model->kind == DIF_MODEL_STAM) {
        const bool across = !isnan(model->stam.period_across_um);
        const double a = DIF_TWO_PI * model->stam.sigma_um / model->stam.period_um;
        const double b = DIF_TWO_PI * model->stam.sigma_um / (across ? model->stam.period_across_um : 1.0);
        p->copies[0] = across;
        p->more[0] = (float)(a * a);
        p->more[1] = (float)(b * b);
    }
    if (model->kind == DIF_MODEL_NMM) {
        const dif_nmm *nmm = &model->nmm;
        const double step = nmm->line_area_per_um > 0.0 ? nmm->line_area_per_um : 1.0 / nmm->extent_um;
        p->few[0] = nmm->n_fixed;
        p->few[1] = 1;
        p->few[2] = nmm->jacobian;
        p->more[0] = (float)(nmm->lambda_max_um - nmm->lambda_min_um);
        p->more[1] = (float)(step * nmm->extent_um);
        for (int c = 0; c < 3; c++)
            p->scale[c] = (float)eval->scale[c];
    }
}

dif_status dif_eval_run_pass(dif_gpu_eval *eval, const dif_eval_pass *ps, int first, dif_error *err)
{
    const dif_model *model = eval->model;
    const int left = eval->has_sheets ? model->n_sheet - first : 1;
    const int n = eval->has_sheets && eval->n_slot < left ? eval->n_slot : left;
    const dif_sheet *last = NULL;
    dif_status status = DIF_OK;
    for (int i = 0; i < n && status == DIF_OK; i++) {
        const dif_sheet *sheet = eval->has_sheets ? model->sheet[first + i] : NULL;
        if (model->kind == DIF_MODEL_LUT) {
            eval->lut_params.job[0] = ps->n;
        } else {
            set_waves(eval, ps, sheet, last);
            set_params(eval, ps, sheet, sheet ? model->share[first + i] : 1.0, i > 0);
        }
        if (sheet)
            dif_gl_texture_bind(eval->slot + i, 0);
        last = sheet;
        status = dif_eval_dispatch(eval, ps->job, ps->nx, ps->ny, i % 2, err);
    }
    return status == DIF_OK ? dif_eval_fetch(eval, ps->nx, ps->ny, (n - 1) % 2, err) : status;
}
