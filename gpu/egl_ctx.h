/* The context behind dif_gpu, for the files of gpu/. Not installed.
 * Every entry point of the library begins with dif_gpu_begin and ends with dif_gpu_check. */
#ifndef DIF_EGL_CTX_H
#define DIF_EGL_CTX_H

#include <epoxy/gl.h>

#include "gpu/gpu.h"

struct dif_gpu {
    void *display, *context; /* EGLDisplay, EGLContext                                        */
    dif_gpu_info info;
    GLuint frame; /* framebuffer that results are drawn into and read from         */
    int n_live;   /* GL objects made through gl_program.h, gl_texture.h and not yet deleted, and the frame */
};

/* Makes the context current for this thread. Status DIF_ERR_RESOURCE. */
DIF_MUST_USE dif_status dif_gpu_begin(dif_gpu *gpu, dif_error *err);

/* Turns GL errors since the last check into DIF_ERR_NOMEM or DIF_ERR_FOREIGN; `doing` is what the text says was going on. */
DIF_MUST_USE dif_status dif_gpu_check(const dif_gpu *gpu, const char *doing, dif_error *err);

/* GL objects of ours that are alive: 1 (the frame) after opening. For tests. */
int dif_gpu_live(const dif_gpu *gpu);

/* DIF_OK if a shared library can be loaded, DIF_ERR_RESOURCE if not: epoxy ends the program where one is missing. */
DIF_MUST_USE dif_status dif_egl_probe(const char *library, dif_error *err);

/* Whether a renderer string is that of a software renderer. */
bool dif_gpu_is_software(const char *renderer);

#endif
