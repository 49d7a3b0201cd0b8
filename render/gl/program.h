/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * GL programs out of embedded shaders. A shader's text is put together as
 *
 *     #version 450 core, defines | common.glsl | the pass's own file | perhaps a second one
 *
 * and a compile error names the .glsl file and the line in it. */
#ifndef CONUS_RENDER_GL_PROGRAM_H
#define CONUS_RENDER_GL_PROGRAM_H

#include "base/status.h"
#include "render/gl/functions.h"

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
    struct program_shader vertex, fragment; /**< Zeroed in a compute program. */
    struct program_shader compute;          /**< Zeroed in any other program. */
    struct program_shader more; /**< A second file behind the fragment or compute shader's; may be zeroed. */
    const struct program_define *defines;
    size_t define_count;
};

/** Compiles and links in the current context. *out is the caller's to glDeleteProgram(). CONUS_ERROR_GL with the first
 * line of the compile error. */
conus_status program_create(GLuint *out, const struct program_source *source);

/** Location of uniform @p name, which must be used in @p program. Call it once, after creation. */
GLint program_uniform(GLuint program, const char *name);

#endif
