/* The reference evaluator: double precision, blocks of queries shared out among threads. */
#include <math.h>
#include <omp.h>
#include <string.h>

#include "core/alloc.h"
#include "core/brdf.h"
#include "core/evaluator.h"
#include "core/response.h"
#include "core/spectrum.h"
#include "core/units.h"

enum { BLOCK = 256 };

typedef struct cpu {
    const dif_model *model;
    double (*weight)[3]; /* weight[n_lambda]: colours of sheet, pq and stam                      */
    int n_thread;
    size_t n_room;           /* nmm: wavelengths that a direction may need                           */
    double scale[3];         /* nmm: of its weights                                                  */
    double *nmm_um;          /* nmm_um[n_thread][n_room]: room for a direction's wavelengths         */
    double (*nmm_weight)[3]; /* nmm_weight[n_thread][n_room]                                         */
} cpu;

static bool has_sheets(const dif_model *model)
{
    return model->kind != DIF_MODEL_STAM && model->kind != DIF_MODEL_LUT;
}

/* What turns a power into the model's quantity: rho and the BRDF hold the shadowing, the power does not. */
static double gain_of(const dif_model *model, dif_vec3 wi, dif_vec3 wo, double lambda_um)
{
    if (model->quantity == DIF_QUANTITY_POWER)
        return 1.0;
    return dif_brdf_gain(model->quantity, model->index, wi, wo, lambda_um, model->area_um2) *
           dif_shadow_factor(model->shadow, wi, wo);
}

/* Adds a sheet's powers at n <= BLOCK points. */
static void add_sheet(const dif_sheet *sheet, double share, int n, const dif_vec3 *kappa, double *power)
{
    const dif_sheet_info info = dif_sheet_info_of(sheet);
    double ks[BLOCK], kz[BLOCK], amp[BLOCK][2];
    if (info.is_line) {
        const double c = cos(info.azimuth_rad), s = sin(info.azimuth_rad);
        for (int i = 0; i < n; i++) {
            ks[i] = c * kappa[i].x + s * kappa[i].y;
            kz[i] = -kappa[i].z;
        }
        dif_response_line(sheet, (size_t)n, ks, kz, amp);
    } else {
        dif_response_volume(sheet, (size_t)n, kappa, amp);
    }
    for (int i = 0; i < n; i++)
        power[i] += share * (amp[i][0] * amp[i][0] + amp[i][1] * amp[i][1]);
}

/* Powers at n <= BLOCK points, each at its own wavelength; false if one lies outside a sheet's band. */
static bool read_powers(const dif_model *model, int n, const dif_vec3 *uvw, const double *lambda_um, double *power)
{
    dif_vec3 kappa[BLOCK];
    for (int i = 0; i < n; i++) {
        const double k = DIF_TWO_PI / lambda_um[i];
        kappa[i] = (dif_vec3){k * uvw[i].x, k * uvw[i].y, k * uvw[i].z};
        power[i] = model->kind == DIF_MODEL_STAM ? dif_stam_power(&model->stam, kappa[i].x, kappa[i].y) : 0.0;
    }
    if (!has_sheets(model))
        return true;
    for (int w = 0; w < model->n_sheet; w++) {
        for (int i = 0; i < n; i++)
            if (!dif_sheet_covers(model->sheet[w], kappa[i]))
                return false;
        add_sheet(model->sheet[w], model->share[w], n, kappa, power);
    }
    for (int i = 0; i < n && model->kind == DIF_MODEL_PQ; i++) {
        const double factor = dif_replica_factor(&model->replica, kappa[i].x, kappa[i].y);
        power[i] *= factor * factor;
    }
    return true;
}

/* The quantity at n <= BLOCK queries; nmm takes the wavelength that stands for the one asked for. */
static bool read_values(const dif_model *model, int n, const dif_query *query, double *value)
{
    dif_vec3 uvw[BLOCK];
    double at_um[BLOCK];
    if (n < 1)
        return true;
    for (int i = 0; i < n; i++) {
        uvw[i] = dif_vec3_transfer(query[i].wi, query[i].wo);
        at_um[i] = query[i].lambda_um;
        if (model->kind == DIF_MODEL_NMM)
            at_um[i] = dif_nmm_nearest_um(&model->nmm, hypot(uvw[i].x, uvw[i].y), at_um[i]);
    }
    if (!read_powers(model, n, uvw, at_um, value))
        return false;
    for (int i = 0; i < n; i++)
        value[i] *= gain_of(model, query[i].wi, query[i].wo, query[i].lambda_um);
    return true;
}

static void note_cost(double since_s, dif_eval_cost *cost)
{
    if (cost)
        *cost = (dif_eval_cost){.run_s = omp_get_wtime() - since_s};
}

static dif_status outside(dif_error *err)
{
    return dif_fail(err, DIF_ERR_ARG, "a direction or wavelength outside the band that the model was made for");
}

static dif_status cpu_values(void *self, size_t n, const dif_query *query, double *value, dif_eval_cost *cost,
                             dif_error *err)
{
    const cpu *c = self;
    const dif_model *model = c->model;
    const double since_s = omp_get_wtime();
    bool bad = false;
    if (model->kind == DIF_MODEL_LUT)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "a lut has colours, no values at a wavelength");
    if (has_sheets(model) && dif_sheet_info_of(model->sheet[0]).is_line)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "line sheets serve tables only");
    for (size_t i = 0; i < n; i++) {
        const dif_status status = dif_query_check(i, query + i, err);
        if (status != DIF_OK)
            return status;
    }
#pragma omp parallel for schedule(dynamic) num_threads(c->n_thread) reduction(|| : bad)
    for (size_t first = 0; first < n; first += BLOCK) {
        const int count = n - first < BLOCK ? (int)(n - first) : BLOCK;
        bad = !read_values(model, count, query + first, value + first) || bad;
    }
    note_cost(since_s, cost);
    return bad ? outside(err) : DIF_OK;
}

/* One wavelength of a table. */
static bool read_row(const dif_model *model, const dif_plan *plan, int il, double *value)
{
    dif_query query[BLOCK];
    for (int first = 0; first < plan->n_angle; first += BLOCK) {
        const int n = plan->n_angle - first < BLOCK ? plan->n_angle - first : BLOCK;
        for (int i = 0; i < n; i++) {
            dif_plan_directions(plan, first + i, &query[i].wi, &query[i].wo);
            query[i].lambda_um = plan->lambda_um[il];
        }
        if (!read_values(model, n, query, value + (size_t)il * (size_t)plan->n_angle + (size_t)first))
            return false;
    }
    return true;
}

static dif_status cpu_table(void *self, const dif_plan *plan, double *value, dif_eval_cost *cost, dif_error *err)
{
    const cpu *c = self;
    const dif_model *model = c->model;
    const double since_s = omp_get_wtime();
    bool bad = false;
    const dif_status status = dif_plan_check(plan, err);
    if (status != DIF_OK)
        return status;
    if (model->kind == DIF_MODEL_LUT)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "a lut has colours, no table over wavelengths");
    if (has_sheets(model)) {
        const dif_sheet_info info = dif_sheet_info_of(model->sheet[0]);
        if (info.is_line && fabs(info.azimuth_rad - plan->azimuth_rad) > 1e-12)
            return dif_fail(err, DIF_ERR_UNSUPPORTED, "a table at azimuth %.9g deg, the model's sheets are at %.9g deg",
                            dif_deg_from_rad(plan->azimuth_rad), dif_deg_from_rad(info.azimuth_rad));
    }
#pragma omp parallel for schedule(dynamic) num_threads(c->n_thread) reduction(|| : bad)
    for (int il = 0; il < plan->n_lambda; il++)
        bad = !read_row(model, plan, il, value) || bad;
    note_cost(since_s, cost);
    return bad ? outside(err) : DIF_OK;
}

/* n <= BLOCK directions by full sampling of the model's wavelengths. */
static bool add_spectrum(const cpu *c, int n, const dif_vec3 *uvw, double (*xyz)[3])
{
    double at_um[BLOCK], power[BLOCK];
    for (int il = 0; il < c->model->n_lambda; il++) {
        for (int i = 0; i < n; i++)
            at_um[i] = c->model->lambda_um[il];
        if (!read_powers(c->model, n, uvw, at_um, power))
            return false;
        for (int i = 0; i < n; i++)
            for (int k = 0; k < 3; k++)
                xyz[i][k] += c->weight[il][k] * power[i];
    }
    return true;
}

/* One direction by its own few wavelengths. */
static bool add_few(const cpu *c, dif_vec3 uvw, double xyz[3])
{
    const size_t room = c->n_room * (size_t)omp_get_thread_num();
    double *lambda_um = c->nmm_um + room, power[BLOCK];
    double(*weight)[3] = c->nmm_weight + room;
    const int n = dif_nmm_weights(&c->model->nmm, c->scale, hypot(uvw.x, uvw.y), lambda_um, weight);
    dif_vec3 same[BLOCK];
    for (int i = 0; i < BLOCK; i++)
        same[i] = uvw;
    for (int first = 0; first < n; first += BLOCK) {
        const int count = n - first < BLOCK ? n - first : BLOCK;
        if (!read_powers(c->model, count, same, lambda_um + first, power))
            return false;
        for (int i = 0; i < count; i++)
            for (int k = 0; k < 3; k++)
                xyz[k] += weight[first + i][k] * power[i];
    }
    return true;
}

/* Colours of n <= BLOCK directions. */
static bool read_colours(const cpu *c, int n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3])
{
    const dif_model *model = c->model;
    dif_vec3 uvw[BLOCK];
    bool good = true;
    if (n < 1)
        return true;
    memset(xyz, 0, (size_t)n * sizeof *xyz);
    for (int i = 0; i < n; i++)
        uvw[i] = dif_vec3_transfer(wi[i], wo[i]);
    if (model->kind != DIF_MODEL_LUT && model->kind != DIF_MODEL_NMM)
        good = add_spectrum(c, n, uvw, xyz);
    for (int i = 0; i < n && good && model->kind == DIF_MODEL_NMM; i++)
        good = add_few(c, uvw[i], xyz[i]);
    for (int i = 0; i < n && model->kind == DIF_MODEL_LUT; i++)
        dif_lut_eval(model->lut, uvw[i].x, uvw[i].y, uvw[i].z, xyz[i]);
    for (int i = 0; i < n; i++) {
        const double gain = gain_of(model, wi[i], wo[i], 1.0);
        for (int k = 0; k < 3; k++)
            xyz[i][k] *= gain;
    }
    return good;
}

static dif_status check_colours(const cpu *c, dif_error *err)
{
    const dif_model *model = c->model;
    if (model->quantity == DIF_QUANTITY_BRDF)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "colours of the BRDF, want those of power or rho");
    if (has_sheets(model) && dif_sheet_info_of(model->sheet[0]).is_line)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "line sheets serve tables only");
    if (model->kind != DIF_MODEL_LUT && model->kind != DIF_MODEL_NMM && model->n_lambda < 1)
        return dif_fail(err, DIF_ERR_UNSUPPORTED, "colours of a model without wavelengths");
    return DIF_OK;
}

static dif_status cpu_colours(void *self, size_t n, const dif_vec3 *wi, const dif_vec3 *wo, double (*xyz)[3],
                              dif_eval_cost *cost, dif_error *err)
{
    const cpu *c = self;
    const double since_s = omp_get_wtime();
    bool bad = false;
    const dif_status status = check_colours(c, err);
    if (status != DIF_OK)
        return status;
    for (size_t i = 0; i < n; i++) {
        const dif_query pair = {wi[i], wo[i], 1.0};
        const dif_status one = dif_query_check(i, &pair, err);
        if (one != DIF_OK)
            return one;
    }
#pragma omp parallel for schedule(dynamic) num_threads(c->n_thread) reduction(|| : bad)
    for (size_t first = 0; first < n; first += BLOCK) {
        const int count = n - first < BLOCK ? (int)(n - first) : BLOCK;
        bad = !read_colours(c, count, wi + first, wo + first, xyz + first) || bad;
    }
    note_cost(since_s, cost);
    return bad ? outside(err) : DIF_OK;
}

static void cpu_close(void *self)
{
    cpu *c = self;
    if (!c)
        return;
    dif_release(c->weight);
    dif_release(c->nmm_um);
    dif_release(c->nmm_weight);
    dif_release(c);
}

/* Weights of the wavelengths, or room for those of each direction. */
static dif_status prepare(cpu *c, dif_error *err)
{
    const dif_model *model = c->model;
    const size_t n_lambda = (size_t)model->n_lambda, n_thread = (size_t)c->n_thread;
    if (model->kind == DIF_MODEL_NMM) {
        c->n_room = (size_t)dif_nmm_count_max(&model->nmm);
        c->nmm_um = dif_alloc(n_thread * c->n_room, sizeof *c->nmm_um);
        c->nmm_weight = dif_alloc(n_thread * c->n_room, sizeof *c->nmm_weight);
        return c->nmm_um && c->nmm_weight
                   ? dif_nmm_scale(c->scale, err)
                   : dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu wavelengths a direction", c->n_room);
    }
    if (model->kind == DIF_MODEL_LUT || model->n_lambda == 0)
        return DIF_OK;
    c->weight = dif_alloc(n_lambda, sizeof *c->weight);
    return c->weight ? dif_spectrum_weights(model->n_lambda, model->lambda_um, c->weight, err)
                     : dif_fail(err, DIF_ERR_NOMEM, "no memory for %zu wavelengths", n_lambda);
}

dif_status dif_cpu_evaluator_open(const dif_model *model, dif_evaluator *out, dif_error *err)
{
    *out = (dif_evaluator){0};
    dif_status status = dif_model_check(model, err);
    if (status != DIF_OK)
        return status;
    cpu *c = dif_alloc(1, sizeof *c);
    if (!c)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for an evaluator");
    c->model = model;
    c->n_thread = omp_get_max_threads();
    status = prepare(c, err);
    if (status != DIF_OK) {
        cpu_close(c);
        return status;
    }
    *out = (dif_evaluator){"cpu", c, cpu_values, cpu_table, cpu_colours, cpu_close};
    return DIF_OK;
}

void dif_evaluator_close(dif_evaluator *evaluator)
{
    if (evaluator->close)
        evaluator->close(evaluator->self);
    *evaluator = (dif_evaluator){0};
}
