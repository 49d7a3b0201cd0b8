/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens EGL displays, creates contexts and passes on what drivers say. */
#include "render/gl/gl.h"

#include "base/memory.h"
#include "base/system/system.h"

#include <stdio.h>
#include <string.h>

enum { DEVICE_LIMIT = 32, ATTEMPTS_SIZE = 512 };

struct gl_context {
    EGLDisplay display;
    EGLContext context;
    conus_log log;
    void *log_user;
    char renderer[128];
};

conus_status gl_context_use(struct gl_context *context, struct gl_current *previous)
{
    struct gl_current current = {eglGetCurrentDisplay(), eglGetCurrentSurface(EGL_DRAW), eglGetCurrentSurface(EGL_READ),
                                 eglGetCurrentContext(), eglQueryAPI()};
    if (current.context != context->context) {
        eglBindAPI(EGL_OPENGL_API);
        if (!eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, context->context)) {
            unsigned error = (unsigned)eglGetError();
            eglBindAPI(current.api);
            return fail(CONUS_ERROR_GL,
                        "OpenGL context cannot be made current (EGL error 0x%04x): it must not be in use on another "
                        "thread, nor may a GLX context be current on this one",
                        error);
        }
    }
    *previous = current;
    return CONUS_OK;
}

void gl_current_restore(const struct gl_current *previous)
{
    EGLContext ours = eglGetCurrentContext();
    if (previous->context == ours) {
        return;
    }
    if (previous->context == EGL_NO_CONTEXT) {
        eglMakeCurrent(eglGetCurrentDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglBindAPI(previous->api);
        return;
    }
    eglBindAPI(previous->api);
    eglMakeCurrent(previous->display, previous->draw, previous->read, previous->context);
}

/* Adds a clause to `attempts`: why a display cannot be used. */
static void note_attempt(char attempts[ATTEMPTS_SIZE], const char *display, const char *reason)
{
    size_t used = strlen(attempts);
    snprintf(attempts + used, ATTEMPTS_SIZE - used, "%s%s: %s", used ? "; " : "", display, reason);
}

static bool has_word(const char *words, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = words; at && (at = strstr(at, word)); at += length) {
        if ((at == words || at[-1] == ' ') && (at[length] == ' ' || !at[length])) {
            return true;
        }
    }
    return false;
}

/* epoxy ends the process when a library that it needs is missing, so look first. */
static conus_status find_libraries(void)
{
    static const char *const needed[][2] = {{"libEGL.so.1", "libEGL.so.1"}, {"libOpenGL.so.0", "libGL.so.1"}};
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        if (!system_function(needed[i][0], NULL) && !system_function(needed[i][1], NULL)) {
            return fail(
                CONUS_ERROR_GL,
                "no OpenGL 4.5 core context: %s cannot be loaded; needed are EGL and a driver (Debian: libegl1, "
                "libopengl0, libgl1-mesa-dri), or use the rays engine",
                needed[i][0]);
        }
    }
    return CONUS_OK;
}

static void GLAPIENTRY receive_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                       const GLchar *message, const void *user)
{
    (void)source, (void)id, (void)length;
    const struct gl_context *context = user;
    char line[512];
    snprintf(line, sizeof line, "OpenGL %s%s: %s", type == GL_DEBUG_TYPE_ERROR ? "error" : "message",
             severity == GL_DEBUG_SEVERITY_HIGH ? " (high severity)" : "", message);
    for (char *at = line; *at; at++) {
        *at = (unsigned char)*at < 0x20 ? ' ' : *at;
    }
    const conus_note note = {.severity = CONUS_SEVERITY_WARNING, .line = line};
    context->log(context->log_user, &note);
}

static const char *egl_reason(char out[64], const char *what)
{
    snprintf(out, 64, "%s (EGL error 0x%04x)", what, (unsigned)eglGetError());
    return out;
}

/* Fills context->display and ->context, or says why `display` cannot be used. */
static bool open_display(struct gl_context *context, EGLDisplay display, const char *name, char attempts[ATTEMPTS_SIZE])
{
    char reason[64];
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL)) {
        note_attempt(attempts, name, egl_reason(reason, "no display"));
        return false;
    }
    const char *extensions = eglQueryString(display, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_KHR_surfaceless_context") || !has_word(extensions, "EGL_KHR_no_config_context") ||
        !eglBindAPI(EGL_OPENGL_API)) {
        note_attempt(attempts, name, "no OpenGL without a surface");
        return false;
    }
    const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION,
                             4,
                             EGL_CONTEXT_MINOR_VERSION,
                             5,
                             EGL_CONTEXT_OPENGL_PROFILE_MASK,
                             EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                             EGL_CONTEXT_OPENGL_DEBUG,
                             context->log ? EGL_TRUE : EGL_FALSE,
                             EGL_NONE};
    context->display = display;
    context->context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
    if (context->context == EGL_NO_CONTEXT) {
        note_attempt(attempts, name, egl_reason(reason, "no OpenGL 4.5 core context"));
        return false;
    }
    return true;
}

/* Checks the context's version: Mesa may promise a version that its override then takes back. Reads the renderer's name
 * and sends its messages to the log. */
static bool set_up(struct gl_context *context, const char *name, char attempts[ATTEMPTS_SIZE])
{
    struct gl_current previous = {0};
    char reason[64];
    if (gl_context_use(context, &previous)) {
        note_attempt(attempts, name, "cannot be made current");
        return false;
    }
    GLint major = 0;
    GLint minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    int version = 10 * major + minor;
    if (version >= 45) {
        const char *renderer = (const char *)glGetString(GL_RENDERER);
        snprintf(context->renderer, sizeof context->renderer, "%s", renderer ? renderer : "unnamed renderer");
    } else {
        snprintf(reason, sizeof reason, "only OpenGL %d.%d", version / 10, version % 10);
        note_attempt(attempts, name, reason);
    }
    if (version >= 45 && context->log) {
        glEnable(GL_DEBUG_OUTPUT);
        glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        glDebugMessageControl(GL_DONT_CARE, GL_DONT_CARE, GL_DEBUG_SEVERITY_NOTIFICATION, 0, NULL, GL_FALSE);
        /* remarks on speed and memory, of any severity and at every call: nothing is wrong */
        glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_PERFORMANCE, GL_DONT_CARE, 0, NULL, GL_FALSE);
        glDebugMessageControl(GL_DONT_CARE, GL_DEBUG_TYPE_OTHER, GL_DONT_CARE, 0, NULL, GL_FALSE);
        glDebugMessageCallback(receive_message, context);
    }
    gl_current_restore(&previous);
    return version >= 45;
}

static bool try_display(struct gl_context *context, EGLDisplay display, const char *name, char attempts[ATTEMPTS_SIZE])
{
    if (!open_display(context, display, name, attempts)) {
        return false;
    }
    if (set_up(context, name, attempts)) {
        return true;
    }
    eglDestroyContext(context->display, context->context);
    context->context = EGL_NO_CONTEXT;
    return false;
}

static bool try_devices(struct gl_context *context, bool software, char attempts[ATTEMPTS_SIZE])
{
    EGLDeviceEXT devices[DEVICE_LIMIT];
    EGLint count = 0;
    if (!eglQueryDevicesEXT(DEVICE_LIMIT, devices, &count)) {
        return false;
    }
    for (EGLint i = 0; i < count; i++) {
        const char *extensions = eglQueryDeviceStringEXT(devices[i], EGL_EXTENSIONS);
        if (has_word(extensions, "EGL_MESA_device_software") != software) {
            continue;
        }
        char name[32];
        snprintf(name, sizeof name, "EGL device %d", i);
        if (try_display(context, eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL), name, attempts)) {
            return true;
        }
    }
    return false;
}

static bool try_all(struct gl_context *context, char attempts[ATTEMPTS_SIZE])
{
    const char *extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    bool has_devices =
        has_word(extensions, "EGL_EXT_platform_device") &&
        (has_word(extensions, "EGL_EXT_device_base") || has_word(extensions, "EGL_EXT_device_enumeration"));
    if (!has_devices) {
        note_attempt(attempts, "EGL devices", "not offered");
    } else if (try_devices(context, false, attempts) || try_devices(context, true, attempts)) {
        return true;
    }
    if (!has_word(extensions, "EGL_MESA_platform_surfaceless")) {
        note_attempt(attempts, "surfaceless", "not offered");
        return false;
    }
    return try_display(context, eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL),
                       "surfaceless", attempts);
}

conus_status gl_context_create(struct gl_context **out, conus_log log, void *log_user)
{
    conus_status status = find_libraries();
    status = status ? status : gl_load_functions();
    struct gl_context *context = status ? NULL : memory_zeroed(1, sizeof *context);
    if (!context) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    context->log = log;
    context->log_user = log_user;
    char attempts[ATTEMPTS_SIZE] = "";
    EGLenum api = eglQueryAPI();
    bool found = try_all(context, attempts);
    eglBindAPI(api);
    if (!found) {
        memory_free(context);
        return fail(
            CONUS_ERROR_GL,
            "no OpenGL 4.5 core context: a driver that has it is needed (a GPU's, or Mesa's libgl1-mesa-dri); tried %s",
            attempts);
    }
    *out = context;
    return CONUS_OK;
}

void gl_context_destroy(struct gl_context *context)
{
    if (!context) {
        return;
    }
    if (eglGetCurrentContext() == context->context) {
        eglMakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    eglDestroyContext(context->display, context->context);
    memory_free(context);
}

const char *gl_context_renderer(const struct gl_context *context)
{
    return context->renderer;
}

conus_status gl_check(const char *what)
{
    GLenum error = glGetError();
    if (error == GL_NO_ERROR) {
        return CONUS_OK;
    }
    for (int i = 0; i < 16 && glGetError() != GL_NO_ERROR; i++) { /* a lost context reports errors for ever */
    }
    return fail(CONUS_ERROR_GL, "OpenGL failed: %s (error 0x%04x%s)", what, error,
                error == GL_OUT_OF_MEMORY ? ", out of memory" : "");
}

conus_status gl_tell(const struct picture_listener *listener, size_t done, size_t total)
{
    if (listener->progress) {
        glFinish();
    }
    return listener_tell(listener, done, total);
}
