#include "gpu/gl_program.h"

#include <ctype.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Line l of part i (from 0) is line (i + 1) LINES_A_PART + l of the shader: what Mesa says of a part's number is always 0. */
enum { LOG_MAX = 4096, LINE_MAX_CHARS = 32, LINES_A_PART = 4000 };

typedef struct message_place {
    const char *begin, *rest;
    char separator;
    int part, line;
} message_place;

void dif_gl_shader_add(dif_gl_shader *shader, dif_gl_part part)
{
    if (shader->n_part < DIF_GL_PARTS)
        shader->part[shader->n_part++] = part;
}

const char *dif_gl_version_line(GLenum stage)
{
    return stage == GL_COMPUTE_SHADER ? "#version 310 es\n" : "#version 300 es\n";
}

/* Where the place of a message stands in a line of a log ("0:4012(5): ", "1(4012) : ", "ERROR: 0:4012: "): the part and
 * line that its line number means, the separator, and where the rest of the line begins; false if there is none. */
static bool place_in(const char *line, const dif_gl_shader *shader, message_place *out)
{
    char *after;
    out->begin = strncmp(line, "ERROR: ", 7) == 0 ? line + 7 : line;
    if (!isdigit((unsigned char)*out->begin))
        return false;
    (void)strtol(out->begin, &after, 10); /* the part's own number: not every driver keeps it */
    out->separator = *after;
    if ((*after != ':' && *after != '(') || !isdigit((unsigned char)after[1]))
        return false;
    const long number = strtol(after + 1, &after, 10);
    out->rest = after;
    out->part = (int)(number / LINES_A_PART) - 1;
    out->line = (int)(number % LINES_A_PART);
    return number > 0 && number < INT_MAX && out->part >= 0 && out->part < shader->n_part;
}

void dif_gl_log_translate(const dif_gl_shader *shader, const char *log, size_t size, char *text)
{
    size_t n = 0;
    text[0] = '\0';
    while (*log && n + 1 < size) {
        const size_t length = strcspn(log, "\n");
        const char *const newline = log[length] ? "\n" : "";
        message_place at;
        const int wrote = place_in(log, shader, &at)
                              ? snprintf(text + n, size - n, "%.*s%s%c%d%.*s%s", (int)(at.begin - log), log,
                                         shader->part[at.part].name, at.separator, at.line,
                                         (int)(length - (size_t)(at.rest - log)), at.rest, newline)
                              : snprintf(text + n, size - n, "%.*s%s", (int)length, log, newline);
        n += wrote > 0 ? (size_t)wrote : 0;
        log += length + (log[length] ? 1 : 0);
    }
    n = strlen(text);
    while (n > 0 && isspace((unsigned char)text[n - 1]))
        text[--n] = '\0';
}

/* Gives the parts to a shader object: #version, then #line and text of each. */
static void give_source(GLuint object, const dif_gl_shader *shader)
{
    char line[DIF_GL_PARTS][LINE_MAX_CHARS];
    const char *text[2 * DIF_GL_PARTS + 1];
    int n = 0;
    text[n++] = dif_gl_version_line(shader->stage);
    for (int i = 0; i < shader->n_part; i++) {
        snprintf(line[i], sizeof line[i], "\n#line %d %d\n", (i + 1) * LINES_A_PART + 1, i + 1);
        text[n++] = line[i];
        text[n++] = shader->part[i].text;
    }
    glShaderSource(object, n, text, NULL);
}

static dif_status compile(GLuint program, const dif_gl_shader *shader, dif_error *err)
{
    char log[LOG_MAX] = "", text[LOG_MAX];
    GLint good = GL_FALSE;
    for (int i = 0; i < shader->n_part; i++)
        if (!shader->part[i].text)
            return dif_fail(err, DIF_ERR_FOREIGN, "the shader source %s is not in the library", shader->part[i].name);
    const GLuint object = glCreateShader(shader->stage);
    if (!object)
        return dif_fail(err, DIF_ERR_FOREIGN, "the driver makes no shader object");
    give_source(object, shader);
    glCompileShader(object);
    glGetShaderiv(object, GL_COMPILE_STATUS, &good);
    if (good)
        glAttachShader(program, object);
    else
        glGetShaderInfoLog(object, (GLsizei)sizeof log, NULL, log);
    glDeleteShader(object); /* lives on while attached */
    if (good)
        return DIF_OK;
    dif_gl_log_translate(shader, log, sizeof text, text);
    return dif_fail(err, DIF_ERR_FOREIGN, "a shader does not compile: %s", *text ? text : "(no log)");
}

dif_status dif_gl_program_create(dif_gpu *gpu, int n_shader, const dif_gl_shader *shader, GLuint *out, dif_error *err)
{
    char log[LOG_MAX] = "";
    GLint good = GL_FALSE;
    *out = 0;
    GLuint program = glCreateProgram();
    gpu->n_live++;
    dif_status status = DIF_OK;
    for (int i = 0; i < n_shader && status == DIF_OK; i++)
        status = compile(program, shader + i, err);
    if (status == DIF_OK) {
        glLinkProgram(program);
        glGetProgramiv(program, GL_LINK_STATUS, &good);
        glGetProgramInfoLog(program, (GLsizei)sizeof log, NULL, log);
        if (!good)
            status = dif_fail(err, DIF_ERR_FOREIGN, "a shader program does not link: %s", *log ? log : "(no log)");
    }
    if (status == DIF_OK)
        status = dif_gpu_check(gpu, "making a shader program", err);
    if (status != DIF_OK)
        dif_gl_program_delete(gpu, &program);
    *out = program;
    return status;
}

void dif_gl_program_delete(dif_gpu *gpu, GLuint *program)
{
    if (!*program)
        return;
    glDeleteProgram(*program);
    *program = 0;
    gpu->n_live--;
}

void dif_gl_program_sampler(GLuint program, const char *name, int unit)
{
    glUseProgram(program);
    const GLint at = glGetUniformLocation(program, name);
    if (at >= 0)
        glUniform1i(at, unit);
}

void dif_gl_program_block(GLuint program, const char *name, GLuint binding)
{
    const GLuint at = glGetUniformBlockIndex(program, name);
    if (at != GL_INVALID_INDEX)
        glUniformBlockBinding(program, at, binding);
}

GLuint dif_gl_block_create(dif_gpu *gpu, size_t n_byte)
{
    GLuint block = 0;
    glGenBuffers(1, &block);
    gpu->n_live++;
    glBindBuffer(GL_UNIFORM_BUFFER, block);
    glBufferData(GL_UNIFORM_BUFFER, (GLsizeiptr)n_byte, NULL, GL_DYNAMIC_DRAW);
    return block;
}

void dif_gl_block_store(GLuint block, size_t n_byte, const void *data)
{
    glBindBuffer(GL_UNIFORM_BUFFER, block);
    glBufferSubData(GL_UNIFORM_BUFFER, 0, (GLsizeiptr)n_byte, data);
}

void dif_gl_block_delete(dif_gpu *gpu, GLuint *block)
{
    if (!*block)
        return;
    glDeleteBuffers(1, block);
    *block = 0;
    gpu->n_live--;
}
