/* The text of the evaluating shaders: files, switches, and the kernels of a sheet as polynomials with constant coefficients. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/sheet_impl.h"
#include "gpu/gpu_eval_impl.h"

_Static_assert(DIF_MODEL_SHEET == DIF_KIND_IS_SHEET && DIF_MODEL_NMM == DIF_KIND_IS_NMM &&
                   DIF_MODEL_PQ == DIF_KIND_IS_PQ && DIF_MODEL_LUT == DIF_KIND_IS_LUT &&
                   DIF_MODEL_STAM == DIF_KIND_IS_STAM,
               "core/shared.h");
_Static_assert(DIF_QUANTITY_POWER == DIF_QUANTITY_IS_POWER && DIF_QUANTITY_RHO == DIF_QUANTITY_IS_RHO &&
                   DIF_QUANTITY_BRDF == DIF_QUANTITY_IS_BRDF,
               "core/shared.h");
_Static_assert(DIF_GPU_FAULT_NONE == DIF_FAULT_IS_NONE && DIF_GPU_FAULT_PLANE == DIF_FAULT_IS_PLANE &&
                   DIF_GPU_FAULT_SIGN == DIF_FAULT_IS_SIGN && DIF_GPU_FAULT_TAP == DIF_FAULT_IS_TAP,
               "core/shared.h");

/* Text that grows in a fixed room; what does not fit makes the shader fail to compile, which is said. */
typedef struct text {
    char *at;
    size_t n, size;
} text;

static void add(text *t, const char *string)
{
    const int wrote = snprintf(t->at + t->n, t->size - t->n, "%s", string);
    t->n += wrote > 0 && (size_t)wrote < t->size - t->n ? (size_t)wrote : 0;
}

/* A float as GLSL reads it: nine digits, a point whatever the locale. */
static void add_float(text *t, double value)
{
    char number[40];
    bool marked = false;
    snprintf(number, sizeof number, "%.9g", (double)(float)value);
    for (char *c = number; *c; c++) {
        if (!strchr("+-0123456789e", *c))
            *c = '.';
        marked = marked || *c == '.' || *c == 'e';
    }
    add(t, number);
    add(t, marked ? "" : ".0");
}

/* The coefficients of power k of taps first ... first + 3. */
static void add_vec4(text *t, const dif_kernel *kernel, int k, int first)
{
    add(t, "vec4(");
    for (int i = first; i < first + 4; i++) {
        add_float(t, i < kernel->width && k <= kernel->degree ? kernel->coef[k][i] : 0.0);
        add(t, i < first + 3 ? ", " : ")");
    }
}

/* Horner in x = t^2 over the powers of one parity. */
static void add_horner(text *t, const dif_kernel *kernel, int parity, int first)
{
    int k = kernel->degree - (kernel->degree + parity) % 2;
    add(t, parity ? "    o = " : "    e = ");
    add_vec4(t, kernel, k, first);
    add(t, ";\n");
    for (k -= 2; k >= 0; k -= 2) {
        add(t, parity ? "    o = o * x + " : "    e = e * x + ");
        add_vec4(t, kernel, k, first);
        add(t, ";\n");
    }
}

/* dif_taps_<axis>(t, tap): tap i at -t is tap width - 1 - i at t, so that half of the polynomials do: four at a time,
 * even and odd powers apart. */
static void add_kernel(text *t, char axis, char macro, const dif_kernel *kernel)
{
    char line[160];
    snprintf(line, sizeof line, "#define DIF_WIDTH_%c %d\nvoid dif_taps_%c(float t, out float tap[%d])\n{\n", macro,
             kernel->width, axis, kernel->width);
    add(t, line);
    add(t, "    float x = t * t;\n    vec4 e, o;\n");
    for (int first = 0; first < (kernel->width + 1) / 2; first += 4) {
        add_horner(t, kernel, 0, first);
        add_horner(t, kernel, 1, first);
        for (int i = first; i < first + 4 && i < (kernel->width + 1) / 2; i++) {
            const char part = "xyzw"[i - first];
            snprintf(line, sizeof line, "    tap[%d] = e.%c - t * o.%c;\n    tap[%d] = e.%c + t * o.%c;\n",
                     kernel->width - 1 - i, part, part, i, part, part);
            add(t, line);
        }
    }
    add(t, "}\n");
}

static void make_kernels(const dif_sheet *sheet, char *room, size_t size)
{
    text t = {room, 0, size};
    room[0] = '\0';
    if (!sheet)
        return;
    add_kernel(&t, 's', 'S', &sheet->s.kernel);
    if (!sheet->is_line)
        add_kernel(&t, 'y', 'Y', &sheet->y.kernel);
    add_kernel(&t, 'z', 'Z', &sheet->z.kernel);
}

void dif_eval_source_make(const dif_eval_variant *variant, dif_eval_source *out)
{
    const bool compute = variant->path == DIF_GPU_COMPUTE, lut = variant->kind == DIF_MODEL_LUT;
    snprintf(out->defines, sizeof out->defines,
             "%s#define DIF_KIND %d\n#define DIF_JOB %d\n#define DIF_QUANTITY %d\n#define DIF_FAULT %d\n"
             "#define DIF_SHADOWING %d\n",
             compute ? "#define DIF_COMPUTE\n" : "", (int)variant->kind, variant->job, (int)variant->quantity,
             (int)variant->fault, (int)variant->shadowing);
    make_kernels(variant->sheet, out->kernels, sizeof out->kernels);
    dif_gl_shader main_shader = {.stage = compute ? GL_COMPUTE_SHADER : GL_FRAGMENT_SHADER};
    dif_gl_shader_add(&main_shader, dif_shader_part("prelude.glsl"));
    dif_gl_shader_add(&main_shader, dif_shader_part("shared.h"));
    dif_gl_shader_add(&main_shader, (dif_gl_part){"(switches)", out->defines});
    dif_gl_shader_add(&main_shader, (dif_gl_part){"(kernels)", out->kernels});
    dif_gl_shader_add(&main_shader, dif_shader_part("eval.glsl"));
    dif_gl_shader_add(&main_shader, dif_shader_part("shadow.glsl"));
    dif_gl_shader_add(&main_shader, dif_shader_part(lut ? "evaluate_lut.glsl" : "evaluate.glsl"));
    dif_gl_shader_add(&main_shader, dif_shader_part("store.glsl"));
    out->n_shader = compute ? 1 : 2;
    out->shader[0] = main_shader;
    out->shader[1] = (dif_gl_shader){.stage = GL_VERTEX_SHADER};
    dif_gl_shader_add(&out->shader[1], dif_shader_part("whole.vert"));
}
