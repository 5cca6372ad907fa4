#include "bench/model_build.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "bench/lut_check.h"
#include "bench/measure_impl.h"
#include "core/alloc.h"

/* What a built model points to. */
struct dif_model_own {
    dif_window_set set;
    dif_readout *reader;     /* reader[set.n]: one a window, which owns its sheet */
    int n_reader;            /* open ones                                         */
    const dif_sheet **sheet; /* sheet[set.n]                                      */
    double *lambda_um;
    dif_lut lut;
};

static const dif_method METHODS[] = {
    [DIF_MODEL_SHEET] = DIF_METHOD_SHEET, [DIF_MODEL_NMM] = DIF_METHOD_NMM,   [DIF_MODEL_PQ] = DIF_METHOD_PQ,
    [DIF_MODEL_LUT] = DIF_METHOD_SHEET,   [DIF_MODEL_STAM] = DIF_METHOD_STAM,
};
enum { N_KIND = sizeof METHODS / sizeof *METHODS };

dif_model_reach dif_model_reach_default(void)
{
    return (dif_model_reach){.s_max = 2.0, .c_min = 0.0, .c_max = 2.0};
}

dif_model_reach dif_model_reach_of_fixed(dif_vec3 fixed)
{
    return (dif_model_reach){.s_max = 1.0 + hypot(fixed.x, fixed.y), .c_min = fixed.z, .c_max = 1.0 + fixed.z};
}

void dif_model_built_free(dif_model_built *built)
{
    struct dif_model_own *own = built->own;
    if (own) {
        for (int i = 0; i < own->n_reader; i++)
            dif_readout_close(own->reader + i);
        dif_window_set_free(&own->set);
        dif_release(own->reader);
        dif_release(own->sheet);
        dif_release(own->lambda_um);
        dif_lut_free(&own->lut);
        dif_release(own);
    }
    *built = (dif_model_built){0};
}

/* Checks, and the part that all kinds share. */
static dif_status begin(const dif_field *field, dif_model_kind kind, double tol, const dif_measure_opts *opts,
                        dif_measure_opts *own_opts, dif_model_built *out, dif_error *err)
{
    *out = (dif_model_built){0};
    if (!((int)kind >= 0 && (int)kind < N_KIND))
        return dif_fail(err, DIF_ERR_ARG, "model kind %d is none", (int)kind);
    *own_opts = opts ? *opts : dif_measure_opts_default();
    own_opts->method = METHODS[kind];
    const dif_status status = dif_measure_check_opts(field, tol, own_opts, err);
    if (status != DIF_OK)
        return status;
    out->own = dif_alloc(1, sizeof *out->own);
    if (!out->own)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a model");
    out->model =
        (dif_model){.kind = kind, .quantity = own_opts->quantity, .index = own_opts->index, .shadow = own_opts->shadow};
    return DIF_OK;
}

static dif_status open_readers(const dif_field *field, double tol, const dif_measure_opts *opts, const dif_reach *reach,
                               dif_model_built *out, dif_error *err)
{
    struct dif_model_own *own = out->own;
    dif_measure_stats stats = {0};
    dif_status status = dif_window_set_make(field, opts, &own->set, err);
    if (status != DIF_OK)
        return status;
    own->reader = dif_alloc((size_t)own->set.n, sizeof *own->reader);
    own->sheet = dif_alloc((size_t)own->set.n, sizeof(void *));
    if (!own->reader || !own->sheet)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d windows", own->set.n);
    for (; own->n_reader < own->set.n; own->n_reader++) {
        dif_readout *reader = own->reader + own->n_reader;
        status = dif_readout_open(field, own->set.window + own->n_reader, opts, tol, reach, reader, &stats, err);
        if (status != DIF_OK)
            return status;
        own->sheet[own->n_reader] = reader->sheet;
        dif_measure_progress(opts, (own->n_reader + 1.0) / own->set.n);
    }
    out->bound = stats.bound;
    out->n_window = own->set.n;
    out->model.area_um2 = own->set.area_um2;
    out->model.nmm = own->reader->nmm;
    out->model.replica = own->reader->replica;
    out->model.stam = own->reader->stam;
    if (own->reader->sheet) {
        out->model.n_sheet = own->set.n;
        out->model.sheet = own->sheet;
        out->model.share = own->set.share;
    }
    return DIF_OK;
}

static dif_status keep_wavelengths(int n, const double *lambda_um, dif_model_built *out, dif_error *err)
{
    out->own->lambda_um = dif_alloc((size_t)n, sizeof *lambda_um);
    if (!out->own->lambda_um)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d wavelengths", n);
    memcpy(out->own->lambda_um, lambda_um, (size_t)n * sizeof *lambda_um);
    out->model.n_lambda = n;
    out->model.lambda_um = out->own->lambda_um;
    return DIF_OK;
}

static dif_status finish(dif_status status, dif_model_built *out, dif_error *err)
{
    if (status == DIF_OK)
        status = dif_model_check(&out->model, err);
    if (status != DIF_OK)
        dif_model_built_free(out);
    return status;
}

dif_status dif_model_build_table(const dif_field *field, dif_model_kind kind, const dif_plan *plan, double tol,
                                 const dif_measure_opts *opts, dif_model_built *out, dif_error *err)
{
    dif_measure_opts own;
    dif_status status = begin(field, kind, tol, opts, &own, out, err);
    if (status == DIF_OK && kind == DIF_MODEL_LUT)
        status = dif_fail(err, DIF_ERR_UNSUPPORTED, "a lut has colours, no table over wavelengths");
    if (status == DIF_OK)
        status = dif_plan_check(plan, err);
    if (status == DIF_OK) {
        const dif_reach reach = dif_reach_of_plan(plan);
        const int threads = dif_measure_threads(&own);
        status = open_readers(field, tol, &own, &reach, out, err);
        omp_set_num_threads(threads);
    }
    return finish(status, out, err);
}

static dif_status check_volume(int n_lambda, const double *lambda_um, const dif_model_reach *reach, dif_error *err)
{
    if (n_lambda < 1)
        return dif_fail(err, DIF_ERR_ARG, "%d wavelengths, want at least one", n_lambda);
    for (int i = 0; i < n_lambda; i++)
        if (!(lambda_um[i] > (i > 0 ? lambda_um[i - 1] : 0.0) && lambda_um[i] < 1e6))
            return dif_fail(err, DIF_ERR_ARG, "wavelength %d is %g um, want > 0 and ascending", i, lambda_um[i]);
    if (!(reach->s_max > 0.0 && reach->s_max <= 2.0 && reach->c_min >= 0.0 && reach->c_min <= reach->c_max &&
          reach->c_max <= 2.0))
        return dif_fail(err, DIF_ERR_ARG, "a reach of |(u, v)| up to %g and -w of %g ... %g, want all within 0 ... 2",
                        reach->s_max, reach->c_min, reach->c_max);
    return DIF_OK;
}

dif_status dif_model_build_volume(const dif_field *field, dif_model_kind kind, int n_lambda, const double *lambda_um,
                                  const dif_model_reach *reach, double tol, const dif_measure_opts *opts,
                                  const dif_lut_opts *lut, dif_model_built *out, dif_error *err)
{
    const dif_model_reach any = dif_model_reach_default(), *r = reach ? reach : &any;
    dif_measure_opts own;
    dif_status status = begin(field, kind, tol, opts, &own, out, err);
    if (status == DIF_OK)
        status = check_volume(n_lambda, lambda_um, r, err);
    if (status == DIF_OK)
        status = keep_wavelengths(n_lambda, lambda_um, out, err);
    if (status == DIF_OK && kind == DIF_MODEL_LUT) {
        status = dif_lut_measure(field, n_lambda, lambda_um, tol, &own, lut, &out->own->lut, &out->n_window, err);
        out->model.lut = &out->own->lut;
        out->bound = (double)NAN;
    } else if (status == DIF_OK) {
        const dif_reach full = {.s_max = r->s_max,
                                .c_min = r->c_min,
                                .c_max = r->c_max,
                                .u_min = -r->s_max,
                                .u_max = r->s_max,
                                .v_min = -r->s_max,
                                .v_max = r->s_max,
                                .lambda_min_um = lambda_um[0],
                                .lambda_max_um = lambda_um[n_lambda - 1]};
        const int threads = dif_measure_threads(&own);
        status = open_readers(field, tol, &own, &full, out, err);
        omp_set_num_threads(threads);
    }
    return finish(status, out, err);
}
