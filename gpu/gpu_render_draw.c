/* Frames of the real-time renderer. */
#include <math.h>

#include "core/alloc.h"
#include "gpu/gpu_eval_impl.h"
#include "gpu/gpu_render_impl.h"

/* Targets of a frame's size, attached to the renderer's framebuffer. */
static dif_status make_targets(dif_gpu_renderer *r, int nx, int ny, dif_error *err)
{
    static const GLenum BUFFERS[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    const GLenum formats[] = {GL_RGBA32F, GL_RGBA32F, GL_DEPTH_COMPONENT24};
    dif_gl_texture *const textures[] = {&r->light, &r->base, &r->depth};
    if (r->light.id && r->light.nx == nx && r->light.ny == ny)
        return DIF_OK;
    glBindFramebuffer(GL_FRAMEBUFFER, r->frame);
    for (int i = 0; i < 3; i++) {
        const dif_gl_texture wanted = {
            .target = GL_TEXTURE_2D, .format = formats[i], .nx = nx, .ny = ny, .n_layer = 1, .n_level = 1};
        dif_gl_texture_delete(r->gpu, textures[i]);
        const dif_status status = dif_gl_texture_create(r->gpu, "a frame", &wanted, textures[i], err);
        if (status != DIF_OK)
            return status;
        glFramebufferTexture2D(GL_FRAMEBUFFER, i < 2 ? BUFFERS[i] : GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, textures[i]->id,
                               0);
    }
    glDrawBuffers(2, BUFFERS);
    const GLenum state = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (state != GL_FRAMEBUFFER_COMPLETE)
        return dif_fail(err, DIF_ERR_FOREIGN, "the GPU cannot draw into floats: framebuffer status 0x%x",
                        (unsigned)state);
    dif_release(r->texels);
    dif_release(r->weight);
    r->texels = dif_alloc(4 * (size_t)nx, (size_t)ny * sizeof *r->texels);
    r->weight = dif_alloc((size_t)nx, (size_t)ny * sizeof *r->weight);
    return r->texels && r->weight ? DIF_OK : dif_fail(err, DIF_ERR_NOMEM, "a frame of %d x %d pixels", nx, ny);
}

static void put(float out[4], dif_vec3 v)
{
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

/* Nearest and farthest depth that the mesh can have. */
static void depth_range(const dif_scene *scene, const dif_projection *projection, double *near, double *far)
{
    dif_vec3 centre;
    double radius;
    dif_mesh_bounds(scene->mesh, &centre, &radius);
    const double *row = projection->row[2];
    const double middle = row[0] * centre.x + row[1] * centre.y + row[2] * centre.z + row[3];
    *far = fmax(middle + 1.01 * radius, 2.0 * projection->near_depth);
    *near = fmin(fmax(middle - 1.01 * radius, projection->near_depth), 0.5 * *far);
}

static void set_scene(dif_gpu_renderer *r, const dif_scene *scene, const dif_shade_opts *how, int nx, int ny)
{
    dif_render_block *p = &r->params;
    const dif_projection projection = dif_scene_projection(&scene->camera, (double)nx / ny);
    double near, far;
    depth_range(scene, &projection, &near, &far);
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 4; c++)
            p->row[i][c] = (float)projection.row[i][c];
    p->shift[2] = (float)((far + near) / (far - near));
    p->shift[3] = (float)(-2.0 * far * near / (far - near));
    put(p->eye, scene->camera.eye);
    for (int i = 0; i < scene->n_light; i++)
        put(p->light[i], scene->light[i]);
    p->look[0] = (float)cos(scene->groove_rad);
    p->look[1] = (float)sin(scene->groove_rad);
    p->look[2] = (float)how->cos_min;
    for (int c = 0; c < 3; c++)
        p->base[c] = (float)scene->base_rgb[c];
    p->job[0] = scene->n_light;
    p->extra[1] = 1.0f / (float)how->n_sub;
}

/* One sample of every pixel. */
static dif_status draw_sample(dif_gpu_renderer *r, int nx, int ny, double x, double y, dif_error *err)
{
    enum { N_TEXTURE = 6 };
    const dif_gl_texture *const textures[N_TEXTURE] = {&r->maps,   &r->masking, &r->albedo,
                                                       &r->relief, &r->product, &r->pyramid};
    static const float CLEAR[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    r->params.shift[0] = (float)(-2.0 * (x - 0.5) / nx);
    r->params.shift[1] = (float)(2.0 * (y - 0.5) / ny);
    dif_gl_block_store(r->block, sizeof r->params, &r->params);
    for (int i = 0; i < N_TEXTURE; i++)
        if (textures[i]->id)
            dif_gl_texture_bind(textures[i], i);
    glBindFramebuffer(GL_FRAMEBUFFER, r->frame);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, r->block);
    glViewport(0, 0, nx, ny);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_LESS);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glClearBufferfv(GL_COLOR, 0, CLEAR);
    glClearBufferfv(GL_COLOR, 1, CLEAR);
    glClearBufferfi(GL_DEPTH_STENCIL, 0, 1.0f, 0);
    glUseProgram(r->program);
    glBindVertexArray(r->mesh.array);
    glDrawElements(GL_TRIANGLES, r->mesh.n_index, GL_UNSIGNED_INT, NULL);
    glBindVertexArray(0);
    glFinish();
    return dif_gpu_check(r->gpu, "drawing a mesh", err);
}

/* Adds one attachment, which has its last row first. */
static void add_texels(dif_gpu_renderer *r, int attachment, double share, dif_frame *frame)
{
    float *to = attachment == 0 ? frame->light : frame->base;
    glReadBuffer(attachment == 0 ? GL_COLOR_ATTACHMENT0 : GL_COLOR_ATTACHMENT1);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glReadPixels(0, 0, frame->nx, frame->ny, GL_RGBA, GL_FLOAT, r->texels);
    for (int iy = 0; iy < frame->ny; iy++)
        for (int ix = 0; ix < frame->nx; ix++) {
            const size_t pixel = (size_t)iy * (size_t)frame->nx + (size_t)ix;
            const float *from = r->texels + 4 * ((size_t)(frame->ny - 1 - iy) * (size_t)frame->nx + (size_t)ix);
            for (size_t c = 0; c < 3; c++)
                to[3 * pixel + c] += (float)(share * (double)from[c]);
            float *sum = attachment == 0 ? frame->coverage : r->weight;
            sum[pixel] += (float)(share * (double)from[3]);
        }
}

/* Samples weigh as much as they are seen: as core/shade.c. */
static void normalise(const dif_gpu_renderer *r, dif_frame *frame)
{
    const size_t n = (size_t)frame->nx * (size_t)frame->ny;
    for (size_t i = 0; i < n; i++) {
        const float scale = r->weight[i] > 0.0f ? frame->coverage[i] / r->weight[i] : 0.0f;
        for (size_t c = 0; c < 3; c++) {
            frame->light[3 * i + c] *= scale;
            frame->base[3 * i + c] *= scale;
        }
    }
}

static dif_status check(const dif_scene *scene, const dif_shade_opts *how, dif_error *err)
{
    if (!(how->n_sub >= 1 && how->n_sub <= DIF_SUBSAMPLE_MAX))
        return dif_fail(err, DIF_ERR_ARG, "%d x %d samples a pixel, want 1 ... %d a side", how->n_sub, how->n_sub,
                        DIF_SUBSAMPLE_MAX);
    if (how->filter == DIF_FILTER_SLOPES && !how->blurred)
        return dif_fail(err, DIF_ERR_ARG, "slopes are filtered in an integrated table, and there is none");
    if (how->meso && !scene->mesh->uv)
        return dif_fail(err, DIF_ERR_ARG, "mesostructure needs texture coordinates, and the mesh has none");
    return dif_scene_check(scene, err);
}

dif_status dif_gpu_renderer_draw(dif_gpu_renderer *renderer, const dif_scene *scene, const dif_shade_opts *opts,
                                 dif_frame *frame, dif_eval_cost *cost, dif_error *err)
{
    const dif_shade_opts how = opts ? *opts : dif_shade_opts_default();
    const size_t n = (size_t)frame->nx * (size_t)frame->ny;
    const int n_sub = how.n_sub;
    dif_eval_cost spent = {0};
    dif_status status = check(scene, &how, err);
    if (status == DIF_OK)
        status = dif_gpu_begin(renderer->gpu, err);
    if (status == DIF_OK)
        status = dif_gpu_render_load_filter(renderer, &how, err);
    if (status == DIF_OK)
        status = make_targets(renderer, frame->nx, frame->ny, err);
    if (status != DIF_OK)
        return status;
    for (size_t i = 0; i < 3 * n; i++)
        frame->light[i] = frame->base[i] = 0.0f;
    for (size_t i = 0; i < n; i++)
        frame->coverage[i] = renderer->weight[i] = 0.0f;
    set_scene(renderer, scene, &how, frame->nx, frame->ny);
    for (int k = 0; k < n_sub * n_sub && status == DIF_OK; k++) {
        const double since_s = dif_eval_now_s();
        status = draw_sample(renderer, frame->nx, frame->ny, (k % n_sub + 0.5) / n_sub, (k / n_sub + 0.5) / n_sub, err);
        const double drawn_s = dif_eval_now_s();
        for (int i = 0; i < 2 && status == DIF_OK; i++)
            add_texels(renderer, i, 1.0 / (n_sub * n_sub), frame);
        spent.run_s += drawn_s - since_s;
        spent.download_s += dif_eval_now_s() - drawn_s;
    }
    normalise(renderer, frame);
    if (cost)
        *cost = spent;
    return status == DIF_OK ? dif_gpu_check(renderer->gpu, "reading a frame", err) : status;
}
