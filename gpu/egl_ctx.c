/* A headless context: hardware through an EGL device if there is one, else Mesa's surfaceless platform. */
#include "gpu/egl_ctx.h"

#include <ctype.h>
#include <dlfcn.h>
#include <epoxy/egl.h>
#include <stdio.h>
#include <string.h>

#include "core/alloc.h"

enum { DEVICES_MAX = 16, PLACES_MAX = DEVICES_MAX + 1 };

/* Where a display may be had. */
typedef struct place {
    EGLenum platform;
    void *native;
    const char *name;
} place;

dif_gpu_opts dif_gpu_opts_default(void)
{
    return (dif_gpu_opts){.require_hardware = false};
}

dif_gpu_info dif_gpu_info_of(const dif_gpu *gpu)
{
    return gpu->info;
}

int dif_gpu_live(const dif_gpu *gpu)
{
    return gpu->n_live;
}

dif_status dif_egl_probe(const char *library, dif_error *err)
{
    void *handle = dlopen(library, RTLD_LAZY | RTLD_LOCAL);
    if (!handle)
        return dif_fail(err, DIF_ERR_RESOURCE,
                        "no GPU: %s cannot be loaded (Debian: libegl1, libgles2, libgl1-mesa-dri)", library);
    dlclose(handle);
    return DIF_OK;
}

bool dif_gpu_is_software(const char *renderer)
{
    static const char *const NAMES[] = {"llvmpipe", "softpipe", "swrast", "swiftshader", "software"};
    char lower[160];
    size_t n = 0;
    for (; n < sizeof lower - 1 && renderer[n]; n++)
        lower[n] = (char)tolower((unsigned char)renderer[n]);
    lower[n] = '\0';
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++)
        if (strstr(lower, NAMES[i]))
            return true;
    return false;
}

/* Displays worth trying, hardware first. */
static int find_places(place *places)
{
    EGLDeviceEXT devices[DEVICES_MAX];
    EGLint n_device = 0;
    int n = 0;
    const bool has_devices = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device") &&
                             (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base") ||
                              (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
                               epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_query")));
    if (has_devices && !eglQueryDevicesEXT(DEVICES_MAX, devices, &n_device))
        n_device = 0;
    for (int software = 0; software < 2; software++) {
        for (EGLint i = 0; i < n_device; i++) {
            const char *about = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
            if ((about && strstr(about, "EGL_MESA_device_software")) == (software == 1))
                places[n++] = (place){EGL_PLATFORM_DEVICE_EXT, devices[i], "device"};
        }
        if (software == 0 && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
            places[n++] = (place){EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, "surfaceless"};
    }
    return n;
}

/* A current context at a place, or why there is none. The display stays initialised when a context goes: it is one per
 * process and place, and another dif_gpu may live on it. */
static const char *try_place(dif_gpu *gpu, const place *at)
{
    static const EGLint WANTED[] = {EGL_CONTEXT_MAJOR_VERSION_KHR, 3, EGL_CONTEXT_MINOR_VERSION_KHR, 1, EGL_NONE};
    static const EGLint CONFIG[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_ES3_BIT_KHR, EGL_NONE};
    EGLConfig config = NULL;
    EGLint n_config = 0;
    EGLDisplay display = eglGetPlatformDisplayEXT(at->platform, at->native, NULL);
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL))
        return "no display";
    if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context"))
        return "a context needs a surface";
    if (!eglBindAPI(EGL_OPENGL_ES_API))
        return "no OpenGL ES";
    if (!epoxy_has_egl_extension(display, "EGL_KHR_no_config_context") &&
        (!eglChooseConfig(display, CONFIG, &config, 1, &n_config) || n_config < 1))
        return "no configuration for OpenGL ES 3";
    EGLContext context = eglCreateContext(display, config, EGL_NO_CONTEXT, WANTED);
    if (context == EGL_NO_CONTEXT)
        return "no OpenGL ES 3.1";
    if (!eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) {
        eglDestroyContext(display, context);
        return "the context cannot be made current";
    }
    gpu->display = display;
    gpu->context = context;
    snprintf(gpu->info.platform, sizeof gpu->info.platform, "%s", at->name);
    return NULL;
}

static void copy_string(GLenum name, size_t size, char *out)
{
    const char *text = (const char *)glGetString(name);
    snprintf(out, size, "%s", text ? text : "");
}

static void describe(dif_gpu_info *info)
{
    copy_string(GL_RENDERER, sizeof info->renderer, info->renderer);
    copy_string(GL_VENDOR, sizeof info->vendor, info->vendor);
    copy_string(GL_VERSION, sizeof info->version, info->version);
    info->software = dif_gpu_is_software(info->renderer);
    info->float_linear = epoxy_has_gl_extension("GL_OES_texture_float_linear");
    info->timer = epoxy_has_gl_extension("GL_EXT_disjoint_timer_query");
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &info->texture_max);
    glGetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &info->layers_max);
}

/* What the context must have besides OpenGL ES 3.1. */
static dif_status check_context(const dif_gpu *gpu, const dif_gpu_opts *opts, dif_error *err)
{
    if (epoxy_is_desktop_gl() || epoxy_gl_version() < 31)
        return dif_fail(err, DIF_ERR_RESOURCE, "no GPU: OpenGL ES 3.1 is needed, the driver gives %s",
                        gpu->info.version);
    if (epoxy_gl_version() < 32 && !epoxy_has_gl_extension("GL_EXT_color_buffer_float"))
        return dif_fail(err, DIF_ERR_RESOURCE, "no GPU: %s cannot render to floats (GL_EXT_color_buffer_float)",
                        gpu->info.renderer);
    if (opts->require_hardware && gpu->info.software)
        return dif_fail(err, DIF_ERR_RESOURCE, "hardware is required, and only a software renderer was found: %s",
                        gpu->info.renderer);
    return DIF_OK;
}

static dif_status open_context(dif_gpu *gpu, const dif_gpu_opts *opts, dif_error *err)
{
    place places[PLACES_MAX];
    const char *why = "EGL knows neither devices nor the surfaceless platform";
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base"))
        return dif_fail(err, DIF_ERR_RESOURCE,
                        "no GPU: EGL has no driver (EGL_EXT_platform_base is missing; Debian: libegl-mesa0)");
    const int n = find_places(places);
    for (int i = 0; i < n && !gpu->context; i++) {
        const char *failed = try_place(gpu, places + i);
        why = failed ? failed : why;
    }
    if (!gpu->context)
        return dif_fail(err, DIF_ERR_RESOURCE, "no GPU: %s", why);
    describe(&gpu->info);
    const dif_status status = check_context(gpu, opts, err);
    if (status != DIF_OK)
        return status;
    glGenFramebuffers(1, &gpu->frame);
    gpu->n_live++;
    return dif_gpu_check(gpu, "opening the context", err);
}

dif_status dif_gpu_open(const dif_gpu_opts *opts, dif_gpu **out, dif_error *err)
{
    const dif_gpu_opts defaults = dif_gpu_opts_default();
    *out = NULL;
    dif_status status = dif_egl_probe("libEGL.so.1", err);
    if (status == DIF_OK)
        status = dif_egl_probe("libGLESv2.so.2", err);
    if (status != DIF_OK)
        return status;
    dif_gpu *gpu = dif_alloc(1, sizeof *gpu);
    if (!gpu)
        return dif_fail(err, DIF_ERR_NOMEM, "no memory for a GPU context");
    status = open_context(gpu, opts ? opts : &defaults, err);
    if (status != DIF_OK) {
        dif_gpu_close(gpu);
        return status;
    }
    *out = gpu;
    return DIF_OK;
}

void dif_gpu_close(dif_gpu *gpu)
{
    if (!gpu)
        return;
    if (gpu->context) {
        if (gpu->frame && dif_gpu_begin(gpu, NULL) == DIF_OK)
            glDeleteFramebuffers(1, &gpu->frame);
        if (eglGetCurrentContext() == gpu->context)
            eglMakeCurrent(gpu->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(gpu->display, gpu->context);
    }
    dif_release(gpu);
}

dif_status dif_gpu_begin(dif_gpu *gpu, dif_error *err)
{
    if (eglGetCurrentContext() == gpu->context)
        return DIF_OK;
    if (!eglMakeCurrent(gpu->display, EGL_NO_SURFACE, EGL_NO_SURFACE, gpu->context))
        return dif_fail(err, DIF_ERR_RESOURCE, "the GPU's context cannot be made current: EGL error 0x%x",
                        (unsigned)eglGetError());
    return DIF_OK;
}

static const char *error_name(GLenum code)
{
    switch (code) {
    case GL_INVALID_ENUM:
        return "invalid enumerator";
    case GL_INVALID_VALUE:
        return "invalid value";
    case GL_INVALID_OPERATION:
        return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION:
        return "incomplete framebuffer";
    default:
        return "error";
    }
}

dif_status dif_gpu_check(const dif_gpu *gpu, const char *doing, dif_error *err)
{
    const GLenum code = glGetError();
    if (code == GL_NO_ERROR)
        return DIF_OK;
    while (glGetError() != GL_NO_ERROR) /* a context may hold several */
        continue;
    if (code == GL_OUT_OF_MEMORY)
        return dif_fail(err, DIF_ERR_NOMEM, "%s has no memory left, %s", gpu->info.renderer, doing);
    return dif_fail(err, DIF_ERR_FOREIGN, "OpenGL: %s (0x%x), %s", error_name(code), (unsigned)code, doing);
}
