/* SPDX-License-Identifier: BSD-3-Clause */
/** @file OpenGL: its functions, a context without a surface, programs, targets, textures, and what the CPU reads
 * back. */
#ifndef CONUS_RENDER_GL_GL_H
#define CONUS_RENDER_GL_GL_H

#include "base/library.h"
#include "base/status.h"
#include "render/gl/camera.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdint.h>

/* OpenGL's and EGL's functions, by libepoxy. gl_load_functions() loads it when it is needed. glClear() calls a
 * variable epoxy_glClear, which is our own and which the linker knows by another name than libepoxy's. */

/* clang-format off */
#define GL_FUNCTIONS(F)                                                                                                \
    F(epoxy_, eglBindAPI) F(epoxy_, eglCreateContext) F(epoxy_, eglDestroyContext) F(epoxy_, eglGetCurrentContext)     \
    F(epoxy_, eglGetCurrentDisplay) F(epoxy_, eglGetCurrentSurface) F(epoxy_, eglGetError)                             \
    F(epoxy_, eglGetPlatformDisplayEXT) F(epoxy_, eglInitialize) F(epoxy_, eglMakeCurrent) F(epoxy_, eglQueryAPI)      \
    F(epoxy_, eglQueryDeviceStringEXT) F(epoxy_, eglQueryDevicesEXT) F(epoxy_, eglQueryString)                         \
    F(epoxy_, glAttachShader) F(epoxy_, glBeginQuery) F(epoxy_, glBindBuffer) F(epoxy_, glBindBufferBase)              \
    F(epoxy_, glBindFramebuffer) F(epoxy_, glBindTextureUnit) F(epoxy_, glBindTextures) F(epoxy_, glBindVertexArray)   \
    F(epoxy_, glBlendColor) F(epoxy_, glBlendFunc) F(epoxy_, glCheckNamedFramebufferStatus) F(epoxy_, glClearBufferfv) \
    F(epoxy_, glClearBufferuiv) F(epoxy_, glClientWaitSync) F(epoxy_, glClipControl) F(epoxy_, glColorMask)            \
    F(epoxy_, glCompileShader) F(epoxy_, glCopyImageSubData) F(epoxy_, glCopyNamedBufferSubData)                       \
    F(epoxy_, glCreateBuffers) F(epoxy_, glCreateFramebuffers) F(epoxy_, glCreateProgram) F(epoxy_, glCreateQueries)   \
    F(epoxy_, glCreateShader) F(epoxy_, glCreateTextures) F(epoxy_, glCreateVertexArrays) F(epoxy_, glCullFace)        \
    F(epoxy_, glDebugMessageCallback) F(epoxy_, glDebugMessageControl) F(epoxy_, glDebugMessageInsert)                 \
    F(epoxy_, glDeleteBuffers) F(epoxy_, glDeleteFramebuffers) F(epoxy_, glDeleteProgram) F(epoxy_, glDeleteQueries)   \
    F(epoxy_, glDeleteShader) F(epoxy_, glDeleteSync) F(epoxy_, glDeleteTextures) F(epoxy_, glDeleteVertexArrays)      \
    F(epoxy_, glDepthFunc) F(epoxy_, glDepthMask) F(epoxy_, glDisable) F(epoxy_, glDrawArrays)                         \
    F(epoxy_, glDrawArraysInstancedBaseInstance) F(epoxy_, glDrawElementsInstanced) F(epoxy_, glEnable)                \
    F(epoxy_, glEnableVertexArrayAttrib) F(epoxy_, glEndQuery) F(epoxy_, glFenceSync) F(epoxy_, glFinish)              \
    F(epoxy_, glFlush) F(epoxy_, glGetError) F(epoxy_, glGetIntegerv) F(epoxy_, glGetNamedBufferSubData)               \
    F(epoxy_, glGetProgramInfoLog) F(epoxy_, glGetProgramiv) F(epoxy_, glGetQueryObjectuiv)                            \
    F(epoxy_, glGetShaderInfoLog) F(epoxy_, glGetShaderiv) F(epoxy_, glGetString) F(epoxy_, glGetTextureImage)         \
    F(epoxy_, glGetTextureSubImage) F(epoxy_, glGetUniformLocation) F(epoxy_, glLinkProgram)                           \
    F(epoxy_, glMapNamedBufferRange) F(epoxy_, glMemoryBarrier) F(epoxy_, glMultiDrawElements)                         \
    F(epoxy_, glNamedBufferData) F(epoxy_, glNamedBufferStorage) F(epoxy_, glNamedBufferSubData)                       \
    F(epoxy_, glNamedFramebufferDrawBuffers) F(epoxy_, glNamedFramebufferParameteri)                                   \
    F(epoxy_, glNamedFramebufferTexture) F(epoxy_, glPixelStorei) F(epoxy_, glPolygonMode)                             \
    F(epoxy_, glProvokingVertex) F(epoxy_, glScissor) F(epoxy_, glShaderSource) F(epoxy_, glTextureBuffer)             \
    F(epoxy_, glTextureParameteri) F(epoxy_, glTextureStorage2D) F(epoxy_, glTextureStorage3D)                         \
    F(epoxy_, glTextureSubImage2D) F(epoxy_, glTextureSubImage3D) F(epoxy_, glUniform1f) F(epoxy_, glUniform1i)        \
    F(epoxy_, glUniform1ui) F(epoxy_, glUniform2f) F(epoxy_, glUniform2fv) F(epoxy_, glUniform2i)                      \
    F(epoxy_, glUniform3dv) F(epoxy_, glUniform3f) F(epoxy_, glUniform3fv) F(epoxy_, glUniform3iv)                     \
    F(epoxy_, glUniform4i) F(epoxy_, glUniformMatrix2x3dv) F(epoxy_, glUniformMatrix3dv) F(epoxy_, glUniformMatrix3fv) \
    F(epoxy_, glUniformMatrix4fv) F(epoxy_, glUseProgram) F(epoxy_, glVertexArrayAttribBinding)                        \
    F(epoxy_, glVertexArrayAttribFormat) F(epoxy_, glVertexArrayAttribIFormat) F(epoxy_, glVertexArrayBindingDivisor)  \
    F(epoxy_, glVertexArrayElementBuffer) F(epoxy_, glVertexArrayVertexBuffer) F(epoxy_, glViewport)
/* clang-format on */

#define GL_PRAGMA(words) _Pragma(#words)
#define GL_RENAME(prefix, name) GL_PRAGMA(redefine_extname prefix##name conus_##name)
GL_FUNCTIONS(GL_RENAME)

/** CONUS_ERROR_UNSUPPORTED without libepoxy. */
conus_status gl_load_functions(void);

/* An off-screen OpenGL 4.5 core context without a surface, from EGL: a device's display (hardware before software),
 * else Mesa's surfaceless one. No GL library is loaded before gl_context_create() is called.
 *
 * EGL displays belong to the process (an application may use the same one), so they are initialised when needed and
 * never terminated. */

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

/* GL programs out of embedded shaders. A shader's text is put together as
 *
 *     #version 450 core, defines | common.glsl | the pass's own file | perhaps a second one
 *
 * and a compile error names the .glsl file and the line in it. */

/** `#define name value`, so that shaders see the constants of C. */
struct program_define {
    const char *name;
    long value;
};

struct program_shader {
    const char *file; /**< "tube.frag.glsl", for messages. */
    const char *text; /**< shader_tube_frag.              */
};

struct program_source {
    struct program_shader vertex, fragment;
    struct program_shader more; /**< A second file behind the fragment shader's; may be zeroed. */
    const struct program_define *defines;
    size_t define_count;
};

/** Compiles and links in the current context. *out is the caller's to glDeleteProgram(). CONUS_ERROR_GL with the first
 * line of the compile error. */
conus_status program_create(GLuint *out, const struct program_source *source);

/** Location of uniform @p name, which must be used in @p program. Call it once, after creation. */
GLint program_uniform(GLuint program, const char *name);

/* What the CPU reads of buffers that the device writes. The device copies it into a buffer that stays mapped, so
 * that the CPU waits once for as many buffers as it likes, and copies nothing. Needs a current context throughout. */

/** Zeroed before the first use. */
struct readback {
    GLuint buffer;
    size_t capacity; /**< Bytes. */
    const uint8_t *mapped;
};

/** The first bytes of a buffer. */
struct readback_part {
    GLuint buffer;
    size_t size;
    const void *data; /**< Out; borrowed until the next call. */
};

/** Waits for what was drawn and dispatched, and sets the data of @p count parts. Errors name @p what was done. */
conus_status readback_wait(struct readback *readback, struct readback_part *parts, size_t count, const char *what);

/** Likewise for rows of a texture of two dimensions: @p count from @p first on, @p width texels of the size that
 * @p layout and @p type say, which is @p size together. */
struct readback_rows {
    GLuint texture;
    GLsizei width, first, count;
    GLenum layout, type;
    size_t size;
};
conus_status readback_wait_for_rows(struct readback *readback, const struct readback_rows *rows, const void **data,
                                    const char *what);

void readback_finish(struct readback *readback);

/* A list that shaders append to: a storage buffer
 *
 *     layout(std430, binding = ...) restrict buffer List { uint count; uint unused; Record records[]; };
 *
 * in which a fragment takes the place atomicAdd(count, 1u) and writes its record if that is below records.length().
 * A draw that appends more records than the capacity is repeated, with a larger capacity or for fewer pixels at once.
 * So the list on the device stays small. Needs a current context throughout. To draw:
 *
 *     shader_list_begin();
 *     while (shader_list_next()) { draw those pixels; shader_list_read(); take the records; } */

struct shader_list {
    GLuint buffer;
    size_t record_size; /**< Bytes. */
    uint32_t capacity;  /**< Records that fit.                            */
    uint32_t limit;     /**< The largest capacity.                         */
    uint32_t likely;    /**< Records that are read before it is known how many there are. */
    struct readback readback;
    uint32_t first, end; /**< Pixels that are drawn now. */
    uint32_t pixels;     /**< In all. */
    uint32_t together;   /**< So many are drawn at once. */
};

/** An empty list of records of @p record_size bytes; @p first of them fit before it grows. */
conus_status shader_list_init(struct shader_list *out, size_t record_size, uint32_t first);
void shader_list_finish(struct shader_list *list);

/** Begins to draw @p pixels pixels, none of which appends more than @p per_pixel records. */
void shader_list_begin(struct shader_list *list, uint32_t pixels, uint32_t per_pixel);

/** Whether there are more: then an empty list is bound to @p binding for pixels number list->first to list->end - 1. */
bool shader_list_next(struct shader_list *list, GLuint binding);

/** Reads the @p count records that these have appended, in any order, but those of one shader in theirs. They are
 * borrowed until the next call. None are given where they did not fit: the pixels come again. */
conus_status shader_list_read(struct shader_list *list, const void **records, uint32_t *count);

/* An off-screen framebuffer with named attachments. Everything happens in the current context; no multisampling,
 * blending or dithering ever touches a target of integers. */

enum { TARGET_ATTACHMENT_LIMIT = 4 };

enum target_format {
    TARGET_UINT = 1, /**< R32UI: one uint32_t per pixel.         */
    TARGET_UINT2,    /**< RG32UI: two.                           */
    TARGET_FLOAT4,   /**< RGBA32F: four floats.                  */
    TARGET_DEPTH     /**< DEPTH_COMPONENT32F: one float.         */
};

struct target_attachment {
    const char *name; /**< Static. */
    enum target_format format;
};

struct target {
    GLuint framebuffer;
    uint32_t width, height;
    struct target_attachment attachments[TARGET_ATTACHMENT_LIMIT]; /**< Colours are outputs 0, 1, ... in this order. */
    GLuint textures[TARGET_ATTACHMENT_LIMIT];                      /**< One per attachment, NEAREST.               */
    size_t count;
    struct readback readback; /**< Of target_read(). */
};

/** Makes a target; at most one attachment is a depth, the last; without any, shaders write to buffers. CONUS_ERROR_GL
 * when the driver has no such framebuffer or no memory for it. */
conus_status target_init(struct target *out, uint32_t width, uint32_t height,
                         const struct target_attachment *attachments, size_t count);
void target_finish(struct target *target);

/** Binds the target for drawing, whatever state was left behind: viewport over all of it, no blending, dithering,
 * culling, multisampling, scissors or masks; a depth test if it has a depth. */
void target_bind(const struct target *target);

/** target_bind(), and sets colours to 0 and depth to 1. */
void target_clear(const struct target *target);

/** Texture of the attachment called @p name, which must be there. */
GLuint target_texture(const struct target *target, const char *name);

/** Copies attachment @p name to @p pixels, bottom row first, waiting for the drawing: width * height * the format's
 * size in bytes. */
conus_status target_read(struct target *target, const char *name, void *pixels);

/* Voxels as a 3-D texture: texel (i, j, k) is voxel (i, j, k). */

/** Uploads @p voxels (i fastest; NULL = volume_texture_fill() will) in the current context. *out is the caller's to
 * glDeleteTextures(). @p memory_left is what may still be used, in bytes; this texture's size is taken off it. Errors:
 * CONUS_ERROR_MEMORY above that, CONUS_ERROR_GL when an edge is longer than the driver allows or the driver has no
 * memory. */
conus_status volume_texture_create(GLuint *out, enum volume_texture_kind kind, const size_t dim[3], const void *voxels,
                                   uint64_t *memory_left);

/** Uploads @p count slices of voxels, from @p first on, into a texture of that kind and size. */
void volume_texture_fill(GLuint texture, enum volume_texture_kind kind, const size_t dim[3], size_t first, size_t count,
                         const void *voxels);

/* The shaders of render/shaders/, embedded by the build: NAME.glsl is shader_NAME, dots as underscores. */

extern const char shader_colour_frag[];
extern const char shader_colour_layers[];
extern const char shader_common[];
extern const char shader_id_frag[];
extern const char shader_mesh_frag[];
extern const char shader_mesh_hits_frag[];
extern const char shader_mesh_id_frag[];
extern const char shader_mesh_id_vert[];
extern const char shader_mesh_vert[];
extern const char shader_screen_vert[];
extern const char shader_tube_frag[];
extern const char shader_tube_vert[];

#endif
