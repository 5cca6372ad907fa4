#define _POSIX_C_SOURCE 200809L /* clock_gettime */
/* Programs of the jobs, their dispatch by either path, and results back. */
#include <time.h>

#include "gpu/gpu_eval_impl.h"

double dif_eval_now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

dif_status dif_eval_program(dif_gpu_eval *eval, int job, dif_error *err)
{
    static const char *const SAMPLERS[] = {"planes",   "directions", "waves", "asked",
                                           "spectrum", "before",     "maps",  "masking"};
    if (eval->program[job])
        return DIF_OK;
    const dif_eval_variant variant = {.kind = eval->model->kind,
                                      .job = job,
                                      .quantity = eval->model->quantity,
                                      .shadowing = dif_eval_shadowing(eval->model),
                                      .path = eval->opts.path,
                                      .fault = eval->opts.fault,
                                      .sheet = eval->has_sheets ? eval->model->sheet[0] : NULL};
    dif_eval_source_make(&variant, eval->source);
    GLuint *program = eval->program + job;
    const dif_status status =
        dif_gl_program_create(eval->gpu, eval->source->n_shader, eval->source->shader, program, err);
    if (status != DIF_OK)
        return status;
    for (int i = 0; i < (int)(sizeof SAMPLERS / sizeof *SAMPLERS); i++)
        dif_gl_program_sampler(*program, SAMPLERS[i], i);
    dif_gl_program_block(*program, "dif_block", 0);
    return dif_gpu_check(eval->gpu, "setting up a shader program", err);
}

/* Textures on the units of SAMPLERS; the planes are bound by the caller. */
static void bind(const dif_gpu_eval *eval, int to)
{
    enum { N_TEXTURE = 7 };
    const dif_gl_texture *const textures[N_TEXTURE] = {&eval->directions, &eval->waves,          &eval->asked,
                                                       &eval->spectrum,   &eval->result[1 - to], &eval->maps,
                                                       &eval->masking};
    for (int i = 0; i < N_TEXTURE; i++)
        if (textures[i]->id)
            dif_gl_texture_bind(textures[i], i + 1);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, eval->block);
}

static dif_status draw(dif_gpu_eval *eval, int nx, int ny, int to, dif_error *err)
{
    const dif_status status = dif_gl_texture_target(eval->gpu, eval->result + to, err);
    if (status != DIF_OK)
        return status;
    /* a renderer of the same context may have left these on */
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glViewport(0, 0, nx, ny);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return DIF_OK;
}

static dif_status compute(dif_gpu_eval *eval, int nx, int ny, int to)
{
    const GLuint group = DIF_GROUP;
    glBindImageTexture(0, eval->result[to].id, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    glDispatchCompute(((GLuint)nx + group - 1) / group, ((GLuint)ny + group - 1) / group, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    return DIF_OK;
}

/* Seconds by the timer query, or by the clock where there is none or it was disturbed. */
static double timer_s(const dif_gpu_eval *eval, double clock_s)
{
    GLuint64 ns = 0;
    GLint disjoint = 0;
    if (!eval->timer)
        return clock_s;
    glGetQueryObjectui64vEXT(eval->timer, GL_QUERY_RESULT, &ns);
    glGetIntegerv(GL_GPU_DISJOINT_EXT, &disjoint);
    return ns > 0 && !disjoint ? 1e-9 * (double)ns : clock_s;
}

dif_status dif_eval_dispatch(dif_gpu_eval *eval, int job, int nx, int ny, int to, dif_error *err)
{
    const bool lut = eval->model->kind == DIF_MODEL_LUT;
    const double since_s = dif_eval_now_s();
    dif_gl_block_store(eval->block, lut ? sizeof eval->lut_params : sizeof eval->params,
                       lut ? (const void *)&eval->lut_params : (const void *)&eval->params);
    glUseProgram(eval->program[job]);
    glUniform2i(glGetUniformLocation(eval->program[job], "size"), nx, ny);
    bind(eval, to);
    glFinish();
    const double begin_s = dif_eval_now_s();
    eval->cost.upload_s += begin_s - since_s;
    if (eval->timer)
        glBeginQuery(GL_TIME_ELAPSED_EXT, eval->timer);
    const dif_status status =
        eval->opts.path == DIF_GPU_COMPUTE ? compute(eval, nx, ny, to) : draw(eval, nx, ny, to, err);
    if (eval->timer)
        glEndQuery(GL_TIME_ELAPSED_EXT);
    if (status != DIF_OK)
        return status;
    glFinish();
    eval->cost.run_s += timer_s(eval, dif_eval_now_s() - begin_s);
    return dif_gpu_check(eval->gpu, "evaluating", err);
}

dif_status dif_eval_fetch(dif_gpu_eval *eval, int nx, int ny, int from, dif_error *err)
{
    const double since_s = dif_eval_now_s();
    const dif_status status = dif_gl_texture_read(eval->gpu, eval->result + from, nx, ny, eval->texels, err);
    eval->cost.download_s += dif_eval_now_s() - since_s;
    return status;
}
