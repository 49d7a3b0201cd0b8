/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * An off-screen OpenGL 4.5 core context without a surface, from EGL: a device's display (hardware before software),
 * else Mesa's surfaceless one. No GL library is loaded before gl_context_create() is called.
 *
 * EGL displays belong to the process (an application may use the same one), so they are initialised when needed and
 * never terminated. */
#ifndef CONUS_RENDER_GL_CONTEXT_H
#define CONUS_RENDER_GL_CONTEXT_H

#include "base/status.h"
#include "render/gl/functions.h"
#include "render/gl/listener.h"

struct gl_context;

/** The context that was current on this thread, to be restored. */
struct gl_current {
    EGLDisplay display;
    EGLSurface draw, read;
    EGLContext context;
    EGLenum api;
};

/** Makes a context; it is not current afterwards. The driver's messages about our calls (KHR_debug), but for
 * remarks on speed and memory, go to @p log, one line each; NULL asks for no such messages. CONUS_ERROR_GL: the message
 * says what was tried. */
conus_status gl_context_create(struct gl_context **out, conus_log log, void *log_user);

/** NULL is fine. GL objects made in the context go with it. */
void gl_context_destroy(struct gl_context *context);

/** Makes @p context current on this thread and stores the one before in @p previous. Pair with gl_current_restore(). */
conus_status gl_context_use(struct gl_context *context, struct gl_current *previous);
void gl_current_restore(const struct gl_current *previous);

/** GL_RENDERER: "llvmpipe (LLVM 15.0.6, 256 bits)". */
const char *gl_context_renderer(const struct gl_context *context);

/** CONUS_ERROR_GL, naming @p what, when GL has recorded an error in the current context since the last check. */
conus_status gl_check(const char *what);

/** listener_tell(), once everything is drawn. Without a listener it does nothing. */
conus_status gl_tell(const struct picture_listener *listener, size_t done, size_t total);

#endif
