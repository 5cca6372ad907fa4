/* Shader programs from parts of source text. Not installed.
 * A shader is the concatenation of `#version`, then its parts, each numbered for the compiler, so that a message names our
 * file and line. */
#ifndef DIF_GL_PROGRAM_H
#define DIF_GL_PROGRAM_H

#include <epoxy/gl.h>

#include "gpu/egl_ctx.h"

enum { DIF_GL_PARTS = 10 };

typedef struct dif_gl_part {
    const char *name; /* file name, for messages */
    const char *text;
} dif_gl_part;

typedef struct dif_gl_shader {
    GLenum stage; /* GL_COMPUTE_SHADER: GLSL ES 3.10; GL_VERTEX_SHADER, GL_FRAGMENT_SHADER: 3.00 */
    int n_part;
    dif_gl_part part[DIF_GL_PARTS];
} dif_gl_shader;

/* A file of gpu/shaders or core/shared.h, compiled into the library; the text is NULL if there is none of that name. */
dif_gl_part dif_shader_part(const char *name);

/* Appends a part. */
void dif_gl_shader_add(dif_gl_shader *shader, dif_gl_part part);

/* The first line of a shader's source, with its newline. */
const char *dif_gl_version_line(GLenum stage);

/* Rewrites the first lines of a driver's log with the places of the parts: file name and line. Gives text[size]. */
void dif_gl_log_translate(const dif_gl_shader *shader, const char *log, size_t size, char *text);

/* Compiles and links. Status DIF_ERR_FOREIGN with the log, DIF_ERR_NOMEM; *out 0 on failure.
 * Owns      the caller deletes with dif_gl_program_delete */
DIF_MUST_USE dif_status dif_gl_program_create(dif_gpu *gpu, int n_shader, const dif_gl_shader *shader, GLuint *out,
                                              dif_error *err);
void dif_gl_program_delete(dif_gpu *gpu, GLuint *program);

/* Points a sampler at a texture unit; one that the program does not use is ignored. The program becomes current. */
void dif_gl_program_sampler(GLuint program, const char *name, int unit);

/* Points a uniform block at a binding; one that the program does not use is ignored. */
void dif_gl_program_block(GLuint program, const char *name, GLuint binding);

/* A buffer for a uniform block of n_byte bytes. */
GLuint dif_gl_block_create(dif_gpu *gpu, size_t n_byte);
void dif_gl_block_store(GLuint block, size_t n_byte, const void *data);
void dif_gl_block_delete(dif_gpu *gpu, GLuint *block);

#endif
