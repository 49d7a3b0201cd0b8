/* SPDX-License-Identifier: BSD-3-Clause */
/* Stands between the program and the driver, and shows glslang what passes. */
#include "shader_check.h"

#include "test_gl.h"

#include "conus/own.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHADER_LIMIT = 1024, OUTPUT_SIZE = 1 << 14 };

static struct {
    PFNGLSHADERSOURCEPROC source;
    PFNGLATTACHSHADERPROC attach;
    PFNGLLINKPROGRAMPROC link;
} driver;

static struct {
    GLuint names[SHADER_LIMIT];
    char *texts[SHADER_LIMIT];
    size_t shaders, programs, refused;
    char files[256]; /* of the shaders that are attached, for the command line */
} seen;

static void need_glslang(void)
{
    if (system("glslangValidator --version >/dev/null 2>&1") != 0) {
        print_message("skipped: no glslangValidator (Debian: glslang-tools)\n");
        skip();
    }
}

/* Prints its errors and warnings. */
static bool glslang_takes(const char *files)
{
    char command[512], line[512];
    snprintf(command, sizeof command, "cd '%s' && glslangValidator -l %s 2>&1", test_scratch(""), files);
    FILE *said = popen(command, "r");
    assert_non_null(said);
    bool takes = true;
    while (fgets(line, sizeof line, said)) {
        if (strstr(line, "ERROR") || strstr(line, "WARNING")) {
            print_message("glslang: %s", line);
            takes = false;
        }
    }
    return pclose(said) == 0 && takes;
}

bool shader_check_takes(const char *vertex, const char *fragment)
{
    need_glslang();
    assert_ok(conus_write_file(test_scratch("one.vert"), vertex, strlen(vertex)));
    assert_ok(conus_write_file(test_scratch("one.frag"), fragment, strlen(fragment)));
    return glslang_takes("one.vert one.frag");
}

static void GLAPIENTRY keep_source(GLuint shader, GLsizei count, const GLchar *const *text, const GLint *sizes)
{
    assert_true(count == 1 && !sizes && seen.shaders < SHADER_LIMIT);
    seen.names[seen.shaders] = shader;
    seen.texts[seen.shaders++] = strdup(text[0]);
    driver.source(shader, count, text, sizes);
}

static void GLAPIENTRY keep_attached(GLuint program, GLuint shader)
{
    GLint stage = 0;
    char name[32];
    size_t at = seen.shaders - 1, used = strlen(seen.files);
    glGetShaderiv(shader, GL_SHADER_TYPE, &stage);
    assert_int_equal(seen.names[at], shader); /* the program attaches each when it is compiled */
    snprintf(name, sizeof name, "%zu.%s", at,
             stage == GL_VERTEX_SHADER     ? "vert"
             : stage == GL_FRAGMENT_SHADER ? "frag"
                                           : "comp");
    snprintf(seen.files + used, sizeof seen.files - used, " %s", name);
    assert_ok(conus_write_file(test_scratch(name), seen.texts[at], strlen(seen.texts[at])));
    driver.attach(program, shader);
}

static void GLAPIENTRY check_linked(GLuint program)
{
    seen.programs++;
    seen.refused += !glslang_takes(seen.files);
    seen.files[0] = 0;
    driver.link(program);
}

void shader_check_begin(void)
{
    test_need_gl();
    need_glslang();
    for (size_t i = 0; i < seen.shaders; i++) {
        free(seen.texts[i]);
    }
    memset(&seen, 0, sizeof seen);
    driver.source = glShaderSource;
    driver.attach = glAttachShader;
    driver.link = glLinkProgram;
    glShaderSource = keep_source;
    glAttachShader = keep_attached;
    glLinkProgram = check_linked;
}

size_t shader_check_end(void)
{
    glShaderSource = driver.source;
    glAttachShader = driver.attach;
    glLinkProgram = driver.link;
    assert_int_equal(seen.refused, 0);
    return seen.programs;
}

bool shader_check_saw(const char *define, const char *text)
{
    for (size_t i = 0; i < seen.shaders; i++) {
        if (strstr(seen.texts[i], define) && strstr(seen.texts[i], text)) {
            return true;
        }
    }
    return false;
}
