/* The GPU side: a headless OpenGL ES 3.1 context and an evaluator (core/evaluator.h) whose shaders read the same model.
 * Links libepoxy alone. Needs no window system: EGL surfaceless on Mesa, an EGL device on a vendor's driver.
 * Threads: a context belongs to the thread that opened it.
 * Does not: print, open files (shaders are compiled into the library), measure. */
#ifndef DIF_GPU_H
#define DIF_GPU_H

#include <stdbool.h>

#include "core/evaluator.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct dif_gpu dif_gpu;

typedef struct dif_gpu_opts {
    bool require_hardware; /* a software renderer is DIF_ERR_RESOURCE */
} dif_gpu_opts;

dif_gpu_opts dif_gpu_opts_default(void);

/* What was found. */
typedef struct dif_gpu_info {
    char renderer[160], vendor[96], version[96]; /* as the driver says                               */
    char platform[32];                           /* "surfaceless", "device"                          */
    bool software;                               /* llvmpipe, softpipe, swrast, SwiftShader          */
    bool float_linear;                           /* float32 textures can be filtered                 */
    bool timer;                                  /* timer queries                                    */
    int texture_max, layers_max;                 /* largest texture side, largest number of layers   */
} dif_gpu_info;

/* Opens a context.
 * Status    DIF_ERR_RESOURCE: no EGL, no OpenGL ES 3.1, software where hardware was asked for (the text says which)
 * Owns      the caller closes with dif_gpu_close, after every evaluator and renderer made from it */
DIF_MUST_USE dif_status dif_gpu_open(const dif_gpu_opts *opts, dif_gpu **out, dif_error *err);
void dif_gpu_close(dif_gpu *gpu);
dif_gpu_info dif_gpu_info_of(const dif_gpu *gpu);

typedef enum dif_gpu_path {
    DIF_GPU_COMPUTE, /* GLSL ES 3.10 compute shaders                                     */
    DIF_GPU_FRAGMENT /* GLSL ES 3.00 fragment shaders, which a browser can run, too      */
} dif_gpu_path;

/* Deliberately wrong shaders: negative controls of the comparison. */
typedef enum dif_gpu_fault {
    DIF_GPU_FAULT_NONE,
    DIF_GPU_FAULT_PLANE, /* the middle plane is not read (lut: the second map; stam: orders across, and along twice)  */
    DIF_GPU_FAULT_SIGN, /* the middle tap's imaginary part has the wrong sign (lut: the second map; stam: the place)  */
    DIF_GPU_FAULT_TAP   /* the middle tap of the lateral kernel is not read (lut: half of the first map; stam: the
                            order below, not the nearest)                                                            */
} dif_gpu_fault;

typedef struct dif_gpu_eval_opts {
    dif_gpu_path path;
    dif_gpu_fault fault;
    bool half;           /* lut: half-float texels, as a game would; else float where it can be filtered       */
    size_t budget_bytes; /* planes that stay on the device; a model of more sheets is streamed, one at least   */
} dif_gpu_eval_opts;

dif_gpu_eval_opts dif_gpu_eval_opts_default(void);

/* An evaluator on the GPU. The model must outlive it; a second one of the same gpu may live beside it.
 * Status    DIF_ERR_ARG, DIF_ERR_UNSUPPORTED, DIF_ERR_NOMEM, DIF_ERR_SIZE (a texture beyond the limit: both numbers),
 *           DIF_ERR_FOREIGN (a shader's log with our file and line; a GL error); *out zeroed on failure */
DIF_MUST_USE dif_status dif_gpu_evaluator_open(dif_gpu *gpu, const dif_model *model, const dif_gpu_eval_opts *opts,
                                               dif_evaluator *out, dif_error *err);

/* Reads a pixel that a game can afford: what an integrated table should stay within. More work, only slower. */
enum { DIF_GPU_READS_WANTED = 16 };

/* Texture reads of one colour of a model on the GPU: of its planes or maps (four numbers a read), of the lists that say
 * where, and of a table of shadowing. Needs no GPU.
 *
 * Given     n_wave  wavelengths that the direction sees: n_lambda of sheet, pq and stam, bins of nmm; a lut has none */
double dif_gpu_reads_of_colour(const dif_model *model, double n_wave);

#ifdef __cplusplus
}
#endif
#endif
