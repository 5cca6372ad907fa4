/* The wavelength-integrated table as a texture. */
#include <math.h>

#include "core/alloc.h"
#include "gpu/gpu_eval_impl.h"

/* The largest power of two below 2^15 / peak: half floats then hold numbers down to 2^-30 of the peak. */
static double half_scale(const dif_lut *lut)
{
    const size_t n = 3 * (size_t)lut->n_radius * (size_t)lut->n_azimuth * (size_t)lut->n_map;
    float peak = 0.0f;
    int exponent;
    for (size_t i = 0; i < n; i++)
        peak = fmaxf(peak, fabsf(lut->coef[i]));
    if (!(peak > 0.0f))
        return 1.0;
    (void)frexp((double)peak, &exponent);
    return ldexp(1.0, 15 - exponent);
}

/* One layer: numbers 4 layer ... 4 layer + 3 of every place. */
static void fill_layer(const dif_lut *lut, int layer, double scale, float *out)
{
    const size_t n_place = (size_t)lut->n_radius * (size_t)lut->n_azimuth, n_number = 3 * (size_t)lut->n_map;
    for (size_t i = 0; i < n_place; i++)
        for (size_t part = 0; part < 4; part++) {
            const size_t number = 4 * (size_t)layer + part;
            out[4 * i + part] = number < n_number ? (float)(scale * (double)lut->coef[i * n_number + number]) : 0.0f;
        }
}

dif_status dif_lut_texture_create(dif_gpu *gpu, const dif_lut *lut, bool half, dif_gl_texture *out, float shape[4],
                                  float more[2], dif_error *err)
{
    const bool stored_half = half || !gpu->info.float_linear;
    const double scale = stored_half ? half_scale(lut) : 1.0;
    const dif_gl_texture wanted = {.target = GL_TEXTURE_2D_ARRAY,
                                   .format = stored_half ? GL_RGBA16F : GL_RGBA32F,
                                   .nx = lut->n_azimuth,
                                   .ny = lut->n_radius,
                                   .n_layer = (3 * lut->n_map + 3) / 4,
                                   .n_level = 1};
    dif_status status = dif_gl_texture_create(gpu, "a wavelength-integrated table", &wanted, out, err);
    if (status != DIF_OK)
        return status;
    float *layer = dif_alloc(4 * (size_t)lut->n_radius * (size_t)lut->n_azimuth, sizeof *layer);
    if (!layer) {
        dif_gl_texture_delete(gpu, out);
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a layer of %d x %d", lut->n_azimuth, lut->n_radius);
    }
    for (int i = 0; i < wanted.n_layer; i++) {
        const dif_gl_box box = {0, 0, i, wanted.nx, wanted.ny, 1};
        fill_layer(lut, i, scale, layer);
        dif_gl_texture_store(out, &box, 0, layer);
    }
    dif_release(layer);
    dif_gl_texture_filter(out, GL_REPEAT, GL_CLAMP_TO_EDGE);
    status = dif_gpu_check(gpu, "loading a wavelength-integrated table", err);
    if (status != DIF_OK)
        dif_gl_texture_delete(gpu, out);
    const float form[4] = {(float)lut->n_azimuth, (float)lut->n_radius, (float)lut->s0, (float)dif_lut_row_step(lut)};
    for (int i = 0; i < 4; i++)
        shape[i] = form[i];
    more[0] = (float)lut->n_map;
    more[1] = (float)(1.0 / scale);
    return status;
}
