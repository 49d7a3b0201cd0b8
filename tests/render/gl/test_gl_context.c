/* SPDX-License-Identifier: BSD-3-Clause */
/* Contexts, programs, targets and textures, and their errors. */
#include "base/memory.h"
#include "render/gl/gl.h"
#include "test.h"
#include "test_gl.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char *const gl_libraries[] = {"libGL",         "libEGL",  "libOpenGL", "libGLX",
                                           "libGLdispatch", "gallium", "_dri"};

static bool is_gl_mapped(void)
{
    FILE *maps = fopen("/proc/self/maps", "r");
    assert_non_null(maps);
    char line[1024];
    bool found = false;
    while (fgets(line, sizeof line, maps)) {
        for (size_t i = 0; i < sizeof gl_libraries / sizeof gl_libraries[0]; i++) {
            found = found || strstr(line, gl_libraries[i]);
        }
    }
    assert_int_equal(fclose(maps), 0);
    return found;
}

/* Runs first: no library for pictures is loaded at the start; making a context loads OpenGL. */
static void no_gl_library_is_loaded_before_a_context(void **state)
{
    (void)state;
    assert_false(is_gl_mapped());
    struct gl_context *context = test_gl_context(NULL, NULL);
    assert_true(is_gl_mapped());
    gl_context_destroy(context);
}

static void context_says_what_it_is(void **state)
{
    (void)state;
    struct gl_context *context = test_gl_context(NULL, NULL);
    struct gl_current previous;
    assert_ok(gl_context_use(context, &previous));
    GLint major = 0;
    GLint minor = 0;
    glGetIntegerv(GL_MAJOR_VERSION, &major);
    glGetIntegerv(GL_MINOR_VERSION, &minor);
    assert_true(10 * major + minor >= 45);
    assert_string_equal(gl_context_renderer(context), (const char *)glGetString(GL_RENDERER));
    gl_current_restore(&previous);
    gl_context_destroy(context);
}

/* The context that was current is so again afterwards: none, or another one, also when uses nest. */
static void use_puts_back_what_was_current(void **state)
{
    (void)state;
    struct gl_context *a = test_gl_context(NULL, NULL);
    struct gl_context *b = test_gl_context(NULL, NULL);
    struct gl_current none, in_a, in_b;
    assert_ok(gl_context_use(a, &none));
    EGLContext a_is = eglGetCurrentContext();
    assert_ok(gl_context_use(b, &in_a));
    EGLContext b_is = eglGetCurrentContext();
    assert_ptr_not_equal(a_is, b_is);
    assert_ok(gl_context_use(b, &in_b));
    gl_current_restore(&in_b);
    assert_ptr_equal(eglGetCurrentContext(), b_is);
    gl_current_restore(&in_a);
    assert_ptr_equal(eglGetCurrentContext(), a_is);
    gl_context_destroy(b); /* leaves the display, and so a, alone */
    glFinish();
    assert_int_equal(glGetError(), GL_NO_ERROR);
    gl_current_restore(&none);
    assert_ptr_equal(eglGetCurrentContext(), EGL_NO_CONTEXT);
    gl_context_destroy(a);
    gl_context_destroy(NULL);
}

/* Mesa's override, which is read once per process, makes a driver without 4.5. It is set in a child, before GL is
 * loaded here. */
static void old_gl_is_refused_in_words(void **state)
{
    (void)state;
    int ends[2];
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        struct gl_context *context = NULL;
        setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
        conus_status status = gl_context_create(&context, NULL, NULL);
        const char *words = status ? conus_message() : gl_context_renderer(context);
        bool sent = write(ends[1], words, strlen(words)) > 0;
        _exit(sent ? (int)status : 100);
    }
    char words[1024] = "";
    int status = 0;
    assert_int_equal(close(ends[1]), 0);
    assert_true(read(ends[0], words, sizeof words - 1) > 0);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(close(ends[0]), 0);
    assert_true(WIFEXITED(status));
    if (WEXITSTATUS(status) == CONUS_OK) {
        assert_null(strstr(words, "llvmpipe"));
        print_message("skipped: %s is not Mesa's\n", words);
        skip();
    }
    assert_int_equal(WEXITSTATUS(status), CONUS_ERROR_GL);
    assert_non_null(strstr(words, "OpenGL 4.5"));
    assert_non_null(strstr(words, "tried"));
    assert_null(strchr(words, '\n'));
}

struct lines {
    int count;
    conus_severity severity;
    char last[512];
};

static void keep_line(void *user, const conus_note *note)
{
    struct lines *lines = user;
    lines->count++;
    lines->severity = note->severity;
    snprintf(lines->last, sizeof lines->last, "%s", note->line);
    assert_null(note->path);
}

static void driver_messages_go_to_the_log(void **state)
{
    (void)state;
    struct lines lines = {0};
    struct gl_context *context = test_gl_context(keep_line, &lines);
    struct gl_current previous;
    assert_ok(gl_context_use(context, &previous));
    glBindFramebuffer(GL_FRAMEBUFFER, 12345); /* no such framebuffer */
    assert_int_equal(lines.count, 1);
    assert_non_null(strstr(lines.last, "OpenGL error"));
    assert_int_equal(lines.severity, CONUS_SEVERITY_WARNING);
    assert_null(strchr(lines.last, '\n'));
    assert_fails(gl_check("a test"), CONUS_ERROR_GL);
    assert_non_null(strstr(conus_message(), "a test"));
    assert_ok(gl_check("a test"));
    gl_current_restore(&previous);
    gl_context_destroy(context);
}

static void say(GLenum type, GLenum severity, GLuint id)
{
    glDebugMessageInsert(GL_DEBUG_SOURCE_APPLICATION, type, id, severity, -1, "words");
}

/* What is wrong is a warning, each time. Remarks are not heard, whatever their severity. */
static void remarks_are_no_errors(void **state)
{
    static const struct {
        GLenum type, severity;
        GLuint id;
        int lines;
    } cases[] = {
        {GL_DEBUG_TYPE_PERFORMANCE, GL_DEBUG_SEVERITY_MEDIUM, 131186, 0},
        {GL_DEBUG_TYPE_PERFORMANCE, GL_DEBUG_SEVERITY_HIGH, 131218, 0},
        {GL_DEBUG_TYPE_OTHER, GL_DEBUG_SEVERITY_HIGH, 131186, 0},
        {GL_DEBUG_TYPE_OTHER, GL_DEBUG_SEVERITY_NOTIFICATION, 131185, 0},
        {GL_DEBUG_TYPE_ERROR, GL_DEBUG_SEVERITY_HIGH, 131186, 3},
        {GL_DEBUG_TYPE_ERROR, GL_DEBUG_SEVERITY_MEDIUM, 131186, 3},
        {GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR, GL_DEBUG_SEVERITY_MEDIUM, 1, 3},
        {GL_DEBUG_TYPE_DEPRECATED_BEHAVIOR, GL_DEBUG_SEVERITY_MEDIUM, 2, 3},
        {GL_DEBUG_TYPE_PORTABILITY, GL_DEBUG_SEVERITY_MEDIUM, 3, 3},
    };
    (void)state;
    struct lines lines = {0};
    struct gl_context *context = test_gl_context(keep_line, &lines);
    struct gl_current previous;
    assert_ok(gl_context_use(context, &previous));
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        lines = (struct lines){0};
        for (int n = 0; n < 3; n++) {
            say(cases[i].type, cases[i].severity, cases[i].id);
        }
        assert_int_equal(lines.count, cases[i].lines);
        assert_true(!lines.count || lines.severity == CONUS_SEVERITY_WARNING);
    }
    assert_string_equal(lines.last, "OpenGL message: words");
    gl_current_restore(&previous);
    gl_context_destroy(context);
}

static conus_status create_and_destroy(void *data)
{
    (void)data;
    struct gl_context *context = NULL;
    conus_status status = gl_context_create(&context, NULL, NULL);
    gl_context_destroy(context);
    return status;
}

static void failing_allocations_are_reported(void **state)
{
    (void)state;
    test_need_gl();
    test_every_allocation(create_and_destroy, NULL);
}

static struct program_source with_fragment(const char *text)
{
    return (struct program_source){.vertex = {"screen.vert.glsl", shader_screen_vert},
                                   .fragment = {"broken.frag.glsl", text}};
}

static void compile_errors_name_file_and_line(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    struct program_source source = with_fragment("out uint id;\n\nvoid main() { id = missing; }\n");
    GLuint program = 0;
    assert_fails(program_create(&program, &source), CONUS_ERROR_GL);
    assert_int_equal(program, 0);
    assert_non_null(strstr(conus_message(), "broken.frag.glsl:3"));
    assert_non_null(strstr(conus_message(), "missing"));
    gl.messages = 0; /* the compiler's */
    test_gl_leave(&gl);
}

static void constants_of_c_are_defines(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    const struct program_define defines[] = {{"ANSWER", 42}};
    struct program_source source = with_fragment("out uint id;\nuniform uint more;\n"
                                                 "void main() { id = uint(ANSWER) + more; }\n");
    source.defines = defines;
    source.define_count = 1;
    GLuint program = 0;
    assert_ok(program_create(&program, &source));
    const struct target_attachment attachments[] = {{"id", TARGET_UINT}, {"depth", TARGET_DEPTH}};
    struct target target;
    assert_ok(target_init(&target, 3, 2, attachments, 2));
    target_bind(&target);
    target_clear(&target);
    GLuint empty = 0;
    glCreateVertexArrays(1, &empty);
    glBindVertexArray(empty);
    glUseProgram(program);
    glUniform1ui(program_uniform(program, "more"), 4000000000u);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    uint32_t pixels[6] = {0};
    assert_ok(target_read(&target, "id", pixels));
    for (int i = 0; i < 6; i++) {
        assert_int_equal(pixels[i], 4000000042u);
    }
    target_clear(&target);
    assert_ok(target_read(&target, "id", pixels));
    assert_int_equal(pixels[5], 0);
    target_finish(&target);
    glDeleteVertexArrays(1, &empty);
    glDeleteProgram(program);
    test_gl_leave(&gl);
}

/* In two strips, the second shorter; and whole. */
static void a_target_is_read_strip_by_strip(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{1024, 1100}, {16000, 70}, {1, 3}};
    const struct target_attachment attachments[] = {{"other", TARGET_UINT}, {"pairs", TARGET_UINT2}};
    struct test_gl gl;
    test_gl_enter(&gl);
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        const size_t count = (size_t)2 * sizes[i][0] * sizes[i][1];
        struct target target;
        uint32_t *wanted = memory_raw(count, sizeof *wanted);
        uint32_t *pixels = memory_zeroed(count, sizeof *pixels);
        assert_true(wanted && pixels);
        for (size_t k = 0; k < count; k++) {
            wanted[k] = (uint32_t)(k * 2654435761U);
        }
        assert_ok(target_init(&target, sizes[i][0], sizes[i][1], attachments, 2));
        glTextureSubImage2D(target_texture(&target, "pairs"), 0, 0, 0, (GLsizei)sizes[i][0], (GLsizei)sizes[i][1],
                            GL_RG_INTEGER, GL_UNSIGNED_INT, wanted);
        assert_ok(target_read(&target, "pairs", pixels));
        assert_memory_equal(pixels, wanted, count * sizeof *wanted);
        target_finish(&target);
        memory_free(wanted);
        memory_free(pixels);
    }
    test_gl_leave(&gl);
}

static void integer_textures_keep_every_bit(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    const uint32_t voxels[6] = {0, 1, 65535, 65536, 16777217, 4294967295u};
    const size_t dim[3] = {3, 2, 1};
    uint64_t left = 24;
    GLuint texture = 0;
    assert_ok(volume_texture_create(&texture, VOLUME_TEXTURE_UINT32, dim, voxels, &left));
    assert_int_equal(left, 0);
    uint32_t back[6];
    glGetTextureImage(texture, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, sizeof back, back);
    assert_memory_equal(back, voxels, sizeof back);
    glDeleteTextures(1, &texture);
    test_gl_leave(&gl);
}

static void textures_beyond_memory_or_driver_are_refused(void **state)
{
    (void)state;
    struct test_gl gl;
    test_gl_enter(&gl);
    const size_t dim[3] = {3, 2, 1};
    const uint16_t voxels[6] = {0};
    uint64_t left = 11;
    GLuint texture = 0;
    assert_fails(volume_texture_create(&texture, VOLUME_TEXTURE_UINT16, dim, voxels, &left), CONUS_ERROR_MEMORY);
    assert_int_equal(left, 11);
    GLint limit = 0;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &limit);
    const size_t long_edge[3] = {(size_t)limit + 1, 1, 1};
    left = UINT64_MAX;
    assert_fails(volume_texture_create(&texture, VOLUME_TEXTURE_UINT8, long_edge, voxels, &left), CONUS_ERROR_GL);
    assert_non_null(strstr(conus_message(), "driver"));
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
    const struct target_attachment attachments[] = {{"id", TARGET_UINT}};
    struct target target;
    assert_fails(target_init(&target, (uint32_t)limit + 1, 1, attachments, 1), CONUS_ERROR_GL);
    assert_int_equal(texture, 0);
    test_gl_leave(&gl);
}

TEST_GROUP(gl_context)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(old_gl_is_refused_in_words),
        cmocka_unit_test(no_gl_library_is_loaded_before_a_context),
        cmocka_unit_test(context_says_what_it_is),
        cmocka_unit_test(use_puts_back_what_was_current),
        cmocka_unit_test(driver_messages_go_to_the_log),
        cmocka_unit_test(remarks_are_no_errors),
        cmocka_unit_test(failing_allocations_are_reported),
        cmocka_unit_test(compile_errors_name_file_and_line),
        cmocka_unit_test(constants_of_c_are_defines),
        cmocka_unit_test(a_target_is_read_strip_by_strip),
        cmocka_unit_test(integer_textures_keep_every_bit),
        cmocka_unit_test(textures_beyond_memory_or_driver_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
