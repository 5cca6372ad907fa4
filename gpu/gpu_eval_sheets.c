/* Planes as textures: a line sheet is one texture (plane, bin); a volume has a layer a plane, texel (bin y, bin x). */
#include "core/alloc.h"
#include "core/sheet_impl.h"
#include "core/units.h"
#include "gpu/gpu_eval_impl.h"

/* Floats that wait for their texture at a time: 16 MiB. */
enum { STAGING_FLOATS = 1 << 22 };

/* The texture that a sheet fills. */
static dif_gl_texture texture_of(const dif_sheet *sheet)
{
    if (sheet->is_line)
        return (dif_gl_texture){.target = GL_TEXTURE_2D,
                                .format = GL_RG32F,
                                .nx = sheet->z.n,
                                .ny = sheet->s.n,
                                .n_layer = 1,
                                .n_level = 1};
    return (dif_gl_texture){.target = GL_TEXTURE_2D_ARRAY,
                            .format = GL_RG32F,
                            .nx = sheet->y.n,
                            .ny = sheet->s.n,
                            .n_layer = sheet->z.n,
                            .n_level = 1};
}

static size_t bytes_of(const dif_gl_texture *texture)
{
    return 8 * (size_t)texture->nx * (size_t)texture->ny * (size_t)texture->n_layer;
}

static bool same_kernel(const dif_kernel *a, const dif_kernel *b)
{
    return a->width == b->width && a->degree == b->degree && !(a->beta < b->beta || a->beta > b->beta);
}

static int max_of(int a, int b)
{
    return a > b ? a : b;
}

/* Forms that the shader reads, and the largest texture that a sheet needs. */
static dif_status check(const dif_model *model, dif_gl_texture *largest, dif_error *err)
{
    const dif_sheet *first = model->sheet[0];
    *largest = texture_of(first);
    for (int i = 0; i < model->n_sheet; i++) {
        const dif_sheet *sheet = model->sheet[i];
        const dif_gl_texture own = texture_of(sheet);
        if (sheet->basis != DIF_BASIS_WAVES)
            return dif_fail(err, DIF_ERR_UNSUPPORTED, "the GPU reads no sheets of Taylor terms");
        if (!same_kernel(&sheet->s.kernel, &first->s.kernel) || !same_kernel(&sheet->z.kernel, &first->z.kernel) ||
            !same_kernel(&sheet->y.kernel, &first->y.kernel))
            return dif_fail(err, DIF_ERR_UNSUPPORTED, "sheet %d was made for another tolerance than the first", i);
        largest->nx = max_of(largest->nx, own.nx);
        largest->ny = max_of(largest->ny, own.ny);
        largest->n_layer = max_of(largest->n_layer, own.n_layer);
    }
    return DIF_OK;
}

dif_status dif_eval_sheets_create(dif_gpu_eval *eval, dif_error *err)
{
    const dif_model *model = eval->model;
    dif_gl_texture wanted;
    dif_status status = check(model, &wanted, err);
    if (status != DIF_OK)
        return status;
    const size_t fit = eval->opts.budget_bytes / bytes_of(&wanted);
    const int n = fit < (size_t)model->n_sheet ? max_of((int)fit, 1) : model->n_sheet;
    eval->slot_first = -1;
    eval->slot = dif_alloc((size_t)n, sizeof *eval->slot);
    eval->n_staging = eval->is_line ? 2 * (size_t)wanted.nx * (size_t)wanted.ny
                                    : (size_t)max_of(STAGING_FLOATS, 2 * wanted.nx * wanted.n_layer);
    eval->staging = dif_alloc(eval->n_staging, sizeof *eval->staging);
    if (!eval->slot || !eval->staging)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for %d sheets on their way to the GPU", n);
    for (eval->n_slot = 0; eval->n_slot < n && status == DIF_OK; eval->n_slot++)
        status = dif_gl_texture_create(eval->gpu, "a sheet", &wanted, eval->slot + eval->n_slot, err);
    return status;
}

/* Number 2 * at + part of the planes. */
static float number_at(const dif_sheet *sheet, size_t at)
{
    return sheet->info.single ? ((const float *)sheet->planes)[at] : (float)((const double *)sheet->planes)[at];
}

static void load_line(dif_gpu_eval *eval, const dif_sheet *sheet, const dif_gl_texture *texture)
{
    const size_t n_plane = (size_t)sheet->z.n, stride = (size_t)sheet->stride;
    for (size_t bin = 0; bin < (size_t)sheet->s.n; bin++)
        for (size_t i = 0; i < 2 * n_plane; i++)
            eval->staging[2 * bin * n_plane + i] = number_at(sheet, 2 * bin * stride + i);
    const dif_gl_box box = {0, 0, 0, sheet->z.n, sheet->s.n, 1};
    dif_gl_texture_store(texture, &box, 0, eval->staging);
}

/* Bins x first ... first + n - 1 of all planes: planes are innermost in memory and outermost in the texture. */
static void load_rows(dif_gpu_eval *eval, const dif_sheet *sheet, const dif_gl_texture *texture, int first, int n)
{
    const size_t n_y = (size_t)sheet->y.n, stride = (size_t)sheet->stride, layer = n_y * (size_t)n;
    for (size_t x = 0; x < (size_t)n; x++)
        for (size_t y = 0; y < n_y; y++) {
            const size_t from = 2 * ((size_t)first + x) * n_y * stride + 2 * y * stride;
            float *to = eval->staging + 2 * (x * n_y + y);
            for (size_t l = 0; l < (size_t)sheet->z.n; l++) {
                to[2 * l * layer] = number_at(sheet, from + 2 * l);
                to[2 * l * layer + 1] = number_at(sheet, from + 2 * l + 1);
            }
        }
    const dif_gl_box box = {0, first, 0, sheet->y.n, n, sheet->z.n};
    dif_gl_texture_store(texture, &box, 0, eval->staging);
}

static void load_volume(dif_gpu_eval *eval, const dif_sheet *sheet, const dif_gl_texture *texture)
{
    const size_t row = 2 * (size_t)sheet->y.n * (size_t)sheet->z.n;
    const int step = (int)(eval->n_staging / row);
    for (int first = 0; first < sheet->s.n; first += step)
        load_rows(eval, sheet, texture, first, sheet->s.n - first < step ? sheet->s.n - first : step);
}

dif_status dif_eval_sheets_load(dif_gpu_eval *eval, int first, dif_error *err)
{
    const dif_model *model = eval->model;
    if (eval->slot_first == first)
        return DIF_OK;
    const double since_s = dif_eval_now_s();
    for (int i = 0; i < eval->n_slot && first + i < model->n_sheet; i++) {
        const dif_sheet *sheet = model->sheet[first + i];
        (sheet->is_line ? load_line : load_volume)(eval, sheet, eval->slot + i);
    }
    glFinish();
    eval->cost.upload_s += dif_eval_now_s() - since_s;
    const dif_status status = dif_gpu_check(eval->gpu, "loading sheets", err);
    eval->slot_first = status == DIF_OK ? first : -1;
    return status;
}

dif_status dif_eval_sheets_cover(const dif_gpu_eval *eval, const dif_eval_reach *reach, dif_error *err)
{
    for (int i = 0; i < eval->model->n_sheet && eval->has_sheets; i++) {
        const dif_sheet *sheet = eval->model->sheet[i];
        const double c = cos(sheet->info.azimuth_rad), s = sin(sheet->info.azimuth_rad);
        for (int end = 0; end < 2; end++) {
            /* axes are covered one by one, so two corners of the box tell; a line has its own lateral one alone */
            const double *at = end ? reach->max : reach->min;
            const dif_vec3 kappa = {sheet->is_line ? c * at[0] : at[0], sheet->is_line ? s * at[0] : at[1], -at[2]};
            if (!dif_sheet_covers(sheet, kappa))
                return dif_fail(err, DIF_ERR_ARG,
                                "a direction or wavelength outside the band that the model was made for");
        }
    }
    return DIF_OK;
}
