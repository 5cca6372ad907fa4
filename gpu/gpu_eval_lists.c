/* The lists that the shaders read: directions and waves as pairs of floats, made in double. */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "core/alloc.h"
#include "core/sheet_impl.h"
#include "core/spectrum.h"
#include "core/units.h"
#include "gpu/gpu_eval_impl.h"

enum { ROW = 1 << DIF_LIST_SHIFT, N_SPECTRUM = 401 };

void dif_eval_pair(double x, float pair[2])
{
    uint64_t bits;
    double high;
    memcpy(&bits, &x, sizeof bits);
    bits += (uint64_t)1 << 40; /* round, then keep 11 of the 52 stored bits */
    bits &= ~(((uint64_t)1 << 41) - 1);
    memcpy(&high, &bits, sizeof high);
    pair[0] = (float)high;
    pair[1] = (float)(x - high);
}

static dif_status create_list(dif_gpu_eval *eval, const char *what, size_t n_pair, dif_gl_texture *out, dif_error *err)
{
    const size_t rows = (n_pair + ROW - 1) / ROW;
    const dif_gl_texture wanted = {.target = GL_TEXTURE_2D,
                                   .format = GL_RG32F,
                                   .nx = ROW,
                                   .ny = rows < 1 << 30 ? (int)rows : 1 << 30,
                                   .n_layer = 1,
                                   .n_level = 1};
    return dif_gl_texture_create(eval->gpu, what, &wanted, out, err);
}

void dif_eval_list_upload(dif_gpu_eval *eval, const dif_gl_texture *list, size_t n_pair, const float *pairs)
{
    const double since_s = dif_eval_now_s();
    const int rows = (int)(n_pair / ROW), rest = (int)(n_pair % ROW);
    const dif_gl_box whole = {0, 0, 0, ROW, rows, 1}, last = {0, rows, 0, rest, 1, 1};
    if (rows > 0)
        dif_gl_texture_store(list, &whole, 0, pairs);
    if (rest > 0)
        dif_gl_texture_store(list, &last, 0, pairs + 2 * (size_t)rows * ROW);
    eval->cost.upload_s += dif_eval_now_s() - since_s;
}

/* nmm: the observer and D65, which the shader interpolates as core/spectrum.c does. */
static dif_status create_spectrum(dif_gpu_eval *eval, dif_error *err)
{
    float pairs[N_SPECTRUM][4];
    const dif_status status = create_list(eval, "a spectrum", 2 * (size_t)N_SPECTRUM, &eval->spectrum, err);
    if (status != DIF_OK)
        return status;
    for (int i = 0; i < N_SPECTRUM; i++) {
        const double lambda_um = 0.38 + 0.001 * i;
        double bar[3];
        dif_spectrum_observer(lambda_um, bar);
        for (int c = 0; c < 3; c++)
            pairs[i][c] = (float)bar[c];
        pairs[i][3] = (float)dif_spectrum_d65(lambda_um);
    }
    dif_eval_list_upload(eval, &eval->spectrum, 2 * (size_t)N_SPECTRUM, &pairs[0][0]);
    return DIF_OK;
}

/* nmm: how many bins a direction may see, from bin 1 on. */
static size_t bins_max(const dif_nmm *nmm)
{
    return (size_t)ceil(2.0 * nmm->extent_um / nmm->lambda_min_um) + 2;
}

static dif_status create_few(dif_gpu_eval *eval, dif_error *err)
{
    const dif_nmm *nmm = &eval->model->nmm;
    eval->ask_pairs = dif_alloc((size_t)DIF_EVAL_WAVES * DIF_ASK_STRIDE * 2, sizeof *eval->ask_pairs);
    /* the fixed waves are what a direction sees where there is no bin */
    eval->few_um = dif_alloc((size_t)dif_nmm_count_max(nmm), sizeof *eval->few_um);
    eval->few_weight = dif_alloc((size_t)dif_nmm_count_max(nmm), sizeof *eval->few_weight);
    if (!eval->ask_pairs || !eval->few_um || !eval->few_weight)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for nmm's wavelengths");
    dif_status status = dif_nmm_scale(eval->scale, err);
    if (status == DIF_OK)
        status =
            create_list(eval, "the wavelengths of a table", (size_t)DIF_EVAL_WAVES * DIF_ASK_STRIDE, &eval->asked, err);
    if (status == DIF_OK)
        status = create_spectrum(eval, err);
    if (status == DIF_OK)
        (void)dif_nmm_weights(nmm, eval->scale, 0.0, eval->few_um, eval->few_weight);
    return status;
}

dif_status dif_eval_lists_create(dif_gpu_eval *eval, dif_error *err)
{
    const dif_model *model = eval->model;
    dif_status status = DIF_OK;
    eval->n_wave_max = model->n_lambda > DIF_EVAL_WAVES ? (size_t)model->n_lambda : DIF_EVAL_WAVES;
    if (model->kind == DIF_MODEL_NMM) {
        eval->n_wave_max = (size_t)model->nmm.n_fixed + bins_max(&model->nmm);
        status = create_few(eval, err);
    } else if (model->kind != DIF_MODEL_LUT && model->n_lambda > 0) {
        eval->weight = dif_alloc((size_t)model->n_lambda, sizeof *eval->weight);
        status = eval->weight ? dif_spectrum_weights(model->n_lambda, model->lambda_um, eval->weight, err)
                              : dif_fail(err, DIF_ERR_NOMEM, "no memory for %d wavelengths", model->n_lambda);
    }
    if (status != DIF_OK)
        return status;
    eval->pairs = dif_alloc((size_t)DIF_EVAL_ITEMS * DIF_DIR_STRIDE * 2, sizeof *eval->pairs);
    eval->wave_pairs = dif_alloc(eval->n_wave_max * DIF_WAVE_STRIDE * 2, sizeof *eval->wave_pairs);
    if (!eval->pairs || !eval->wave_pairs)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for lists of directions and %zu waves", eval->n_wave_max);
    status = create_list(eval, "a list of directions", (size_t)DIF_EVAL_ITEMS * DIF_DIR_STRIDE, &eval->directions, err);
    if (status == DIF_OK)
        status = create_list(eval, "a list of waves", eval->n_wave_max * DIF_WAVE_STRIDE, &eval->waves, err);
    return status;
}

static void put(float *entry, int at, double x)
{
    dif_eval_pair(x, entry + 2 * (size_t)at);
}

static void put_floats(float *entry, int at, double x, double y)
{
    entry[2 * (size_t)at] = (float)x;
    entry[2 * (size_t)at + 1] = (float)y;
}

/* What gains and shadowing read. */
static void put_pair_of_directions(float *entry, dif_vec3 wi, dif_vec3 wo)
{
    put_floats(entry, DIF_DIR_COSINES, wi.z, wo.z);
    put_floats(entry, DIF_DIR_WI, wi.x, wi.y);
    put_floats(entry, DIF_DIR_WO, wo.x, wo.y);
}

/* Coordinates on the axes: along and across the grooves for stam, along the plane of a line, else x and y. */
static void axes_of(const dif_gpu_eval *eval, double x, double y, double azimuth_rad, double *s, double *t)
{
    const bool turned = eval->model->kind == DIF_MODEL_STAM || eval->is_line;
    const double turn_rad = eval->model->kind == DIF_MODEL_STAM ? eval->model->stam.psi_rad : azimuth_rad;
    const double c = turned ? cos(turn_rad) : 1.0, sine = turned ? sin(turn_rad) : 0.0;
    *s = c * x + sine * y;
    *t = eval->is_line ? 0.0 : c * y - sine * x;
}

void dif_eval_put_direction(dif_gpu_eval *eval, size_t i, dif_vec3 wi, dif_vec3 wo, double azimuth_rad)
{
    float *entry = eval->pairs + i * DIF_DIR_STRIDE * 2;
    const dif_vec3 uvw = dif_vec3_transfer(wi, wo);
    double s, t;
    axes_of(eval, uvw.x, uvw.y, azimuth_rad, &s, &t);
    put(entry, 0, s);
    put(entry, 1, t);
    put(entry, 2, -uvw.z);
    put_pair_of_directions(entry, wi, wo);
    put(entry, DIF_DIR_MORE, uvw.x);
    put(entry, DIF_DIR_MORE + 1, uvw.y);
    if (eval->model->kind != DIF_MODEL_NMM)
        return;
    const double length = hypot(uvw.x, uvw.y);
    int first = 0;
    const int n = dif_nmm_bins(&eval->model->nmm, length, &first);
    put_floats(entry, DIF_DIR_BINS, first, n);
    put(entry, DIF_DIR_REACH, eval->model->nmm.extent_um * length);
    put(entry, DIF_DIR_MORE, n > 0 ? s / length : 0.0);
    put(entry, DIF_DIR_MORE + 1, n > 0 ? t / length : 0.0);
    put(entry, DIF_DIR_MORE + 2, n > 0 ? -uvw.z / length : 0.0);
}

void dif_eval_put_query(dif_gpu_eval *eval, size_t i, const dif_query *query)
{
    float *entry = eval->pairs + i * DIF_DIR_STRIDE * 2;
    const dif_vec3 uvw = dif_vec3_transfer(query->wi, query->wo);
    double at_um = query->lambda_um, s, t;
    if (eval->model->kind == DIF_MODEL_NMM)
        at_um = dif_nmm_nearest_um(&eval->model->nmm, hypot(uvw.x, uvw.y), at_um);
    const double k = DIF_TWO_PI / at_um;
    axes_of(eval, k * uvw.x, k * uvw.y, 0.0, &s, &t);
    put(entry, 0, s);
    put(entry, 1, t);
    put(entry, 2, -k * uvw.z);
    put_pair_of_directions(entry, query->wi, query->wo);
    put(entry, DIF_DIR_MORE, k * uvw.x);
    put(entry, DIF_DIR_MORE + 1, k * uvw.y);
    /* the gain is of the wavelength asked for, the coordinates of the one that stands for it */
    put_floats(entry, DIF_DIR_BINS, at_um, 0.0);
    put_floats(entry, DIF_DIR_REACH, query->lambda_um, 0.0);
}

/* What turns a coordinate times k into bins of the axes and turns of a period: entry i of the waves. */
static void put_wave(dif_gpu_eval *eval, const dif_sheet *sheet, size_t i, double k_rad_per_um)
{
    float *entry = eval->wave_pairs + i * DIF_WAVE_STRIDE * 2;
    const dif_model *model = eval->model;
    const double turns = k_rad_per_um / DIF_TWO_PI;
    put(entry, 0, sheet ? k_rad_per_um / sheet->s.step : 0.0);
    put(entry, 1, sheet && !sheet->is_line ? k_rad_per_um / sheet->y.step : 0.0);
    put(entry, 2, sheet ? k_rad_per_um / sheet->z.step : 0.0);
    if (model->kind == DIF_MODEL_PQ) {
        put(entry, DIF_WAVE_TURNS, turns * model->replica.period_x_um);
        put(entry, DIF_WAVE_TURNS + 1, turns * model->replica.period_y_um);
    } else if (model->kind == DIF_MODEL_STAM) {
        const double across_um = model->stam.period_across_um;
        put(entry, DIF_WAVE_TURNS, turns * model->stam.period_um);
        put(entry, DIF_WAVE_TURNS + 1, turns * (isnan(across_um) ? 1.0 : across_um));
    }
}

static void put_weight(dif_gpu_eval *eval, size_t i, const double weight[3], double lambda_um)
{
    float *entry = eval->wave_pairs + i * DIF_WAVE_STRIDE * 2;
    put_floats(entry, DIF_WAVE_XY, weight[0], weight[1]);
    put_floats(entry, DIF_WAVE_Z, weight[2], lambda_um);
}

void dif_eval_waves_of(dif_gpu_eval *eval, const dif_sheet *sheet, int n, const double *lambda_um, double (*weight)[3])
{
    static const double NONE[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < n; i++) {
        put_wave(eval, sheet, (size_t)i, DIF_TWO_PI / lambda_um[i]);
        put_weight(eval, (size_t)i, weight ? weight[i] : NONE, lambda_um[i]);
    }
    dif_eval_list_upload(eval, &eval->waves, (size_t)n * DIF_WAVE_STRIDE, eval->wave_pairs);
}

void dif_eval_waves_of_few(dif_gpu_eval *eval, const dif_sheet *sheet)
{
    static const double NONE[3] = {0.0, 0.0, 0.0};
    const dif_nmm *nmm = &eval->model->nmm;
    const size_t n_fixed = (size_t)nmm->n_fixed;
    for (size_t i = 0; i < eval->n_wave_max; i++) {
        const bool fixed = i < n_fixed;
        const double bin = 1.0 + (double)i - (double)n_fixed;
        put_wave(eval, sheet, i, fixed ? DIF_TWO_PI / eval->few_um[i] : DIF_TWO_PI * bin / nmm->extent_um);
        put_weight(eval, i, fixed ? eval->few_weight[i] : NONE, fixed ? eval->few_um[i] : 0.0);
    }
    dif_eval_list_upload(eval, &eval->waves, eval->n_wave_max * DIF_WAVE_STRIDE, eval->wave_pairs);
}

void dif_eval_waves_of_values(dif_gpu_eval *eval, const dif_sheet *sheet)
{
    put_wave(eval, sheet, 0, 1.0);
    dif_eval_list_upload(eval, &eval->waves, DIF_WAVE_STRIDE, eval->wave_pairs);
}

void dif_eval_asks_of(dif_gpu_eval *eval, int n, const double *lambda_um)
{
    const dif_nmm *nmm = &eval->model->nmm;
    for (int i = 0; i < n; i++) {
        float *entry = eval->ask_pairs + (size_t)i * DIF_ASK_STRIDE * 2;
        const double fixed_um = dif_nmm_nearest_um(nmm, 0.0, lambda_um[i]);
        int at = 0;
        while (at < nmm->n_fixed - 1 && eval->few_um[at] < fixed_um)
            at++;
        put(entry, 0, 1.0 / lambda_um[i]);
        put_floats(entry, 1, at, lambda_um[i]);
    }
    dif_eval_list_upload(eval, &eval->asked, (size_t)n * DIF_ASK_STRIDE, eval->ask_pairs);
}
