/* SPDX-License-Identifier: BSD-3-Clause */
/* Compiles and links programs, and finds the line of a compile error. */
#include "render/gl/gl.h"

#include "base/memory.h"
#include "base/text.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Line numbers of the n-th part of a text begin at n * PART_LINES, by #line: compilers repeat those, while Mesa 22.3
 * loses the number of the source string. */
enum { PART_PREAMBLE, PART_COMMON, PART_PASS, PART_MORE, PART_LINES = 10000 };

/* The first line of a log with an error, else the first line. */
static struct text worst_line(const char *log)
{
    struct text rest = text_from(log);
    struct text first = {0};
    struct text line;
    while (text_line(&rest, &line)) {
        first = first.data ? first : line;
        char copy[256];
        snprintf(copy, sizeof copy, "%.*s", (int)line.size, line.data);
        if (strstr(copy, "error")) {
            return line;
        }
    }
    return first;
}

static conus_status fail_to_compile(const struct program_source *source, const struct program_shader *shader,
                                    const char *log)
{
    const char *const parts[] = {[PART_PREAMBLE] = "preamble",
                                 [PART_COMMON] = "common.glsl",
                                 [PART_PASS] = shader->file,
                                 [PART_MORE] = source->more.file};
    char copy[512];
    struct text worst = worst_line(log);
    snprintf(copy, sizeof copy, "%.*s", (int)worst.size, worst.data ? worst.data : "");
    /* Compilers begin a line with "0:20017(5): " or "0(20017) : ": string and line. Words follow the next colon. */
    const char *at = copy + strspn(copy, "0123456789");
    char *end = NULL;
    unsigned long line = *at == ':' || *at == '(' ? strtoul(at + 1, &end, 10) : 0;
    const char *words = line / PART_LINES <= PART_MORE && end ? strchr(end, ':') : NULL;
    if (!words) {
        return fail(CONUS_ERROR_GL, "shader %s: %s", shader->file, copy);
    }
    return fail(CONUS_ERROR_GL, "shader %s:%lu%s", parts[line / PART_LINES], line % PART_LINES, words);
}

static conus_status compile(GLuint *out, GLenum stage, const struct program_source *source,
                            const struct program_shader *shader)
{
    struct buffer text = {0};
    buffer_text(&text, "#version 450 core\n");
    for (size_t i = 0; i < source->define_count; i++) {
        buffer_format(&text, "#define %s %ld\n", source->defines[i].name, source->defines[i].value);
    }
    buffer_format(&text, "#line %d\n%s\n#line %d\n%s", PART_COMMON * PART_LINES + 1, shader_common,
                  PART_PASS * PART_LINES + 1, shader->text);
    if (shader != &source->vertex && source->more.text) {
        buffer_format(&text, "#line %d\n%s", PART_MORE * PART_LINES + 1, source->more.text);
    }
    conus_status status = buffer_status(&text);
    if (!status) {
        GLuint object = glCreateShader(stage);
        const GLchar *whole = text.data;
        glShaderSource(object, 1, &whole, NULL);
        glCompileShader(object);
        GLint done = 0;
        glGetShaderiv(object, GL_COMPILE_STATUS, &done);
        if (done) {
            *out = object;
        } else {
            char log[4096] = "";
            glGetShaderInfoLog(object, sizeof log, NULL, log);
            glDeleteShader(object);
            status = fail_to_compile(source, shader, log);
        }
    }
    buffer_finish(&text);
    return status;
}

conus_status program_create(GLuint *out, const struct program_source *source)
{
    const struct {
        GLenum stage;
        const struct program_shader *shader;
    } stages[] = {{GL_VERTEX_SHADER, &source->vertex}, {GL_FRAGMENT_SHADER, &source->fragment}};
    GLuint program = glCreateProgram();
    const char *last = "";
    conus_status status = program ? CONUS_OK : fail(CONUS_ERROR_GL, "OpenGL makes no program");
    for (size_t i = 0; i < sizeof stages / sizeof stages[0] && !status; i++) {
        if (stages[i].shader->text) {
            GLuint shader = 0;
            last = stages[i].shader->file;
            status = compile(&shader, stages[i].stage, source, stages[i].shader);
            if (!status) {
                glAttachShader(program, shader);
                glDeleteShader(shader); /* lives on as long as the program */
            }
        }
    }
    if (!status) {
        GLint done = 0;
        glLinkProgram(program);
        glGetProgramiv(program, GL_LINK_STATUS, &done);
        if (!done) {
            char log[4096] = "";
            glGetProgramInfoLog(program, sizeof log, NULL, log);
            struct text line = worst_line(log);
            status =
                fail(CONUS_ERROR_GL, "shader %s does not link: %.*s", last, (int)line.size, line.data ? line.data : "");
        }
    }
    if (status) {
        glDeleteProgram(program);
        return status;
    }
    *out = program;
    return CONUS_OK;
}

GLint program_uniform(GLuint program, const char *name)
{
    GLint location = glGetUniformLocation(program, name);
    assert(location >= 0);
    return location;
}
