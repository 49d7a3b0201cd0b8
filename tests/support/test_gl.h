/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Contexts for tests of the GL part. */
#ifndef CONUS_TESTS_SUPPORT_TEST_GL_H
#define CONUS_TESTS_SUPPORT_TEST_GL_H

#include "render/gl/gl.h"
#include "test.h"

/** A context, or the running test is skipped, saying why. Not for a set-up: cmocka takes a skip there for a failure. */
static inline struct gl_context *test_gl_context(conus_log log, void *log_user)
{
    struct gl_context *context = NULL;
    if (gl_context_create(&context, log, log_user)) {
        print_message("skipped: %s\n", conus_message());
        skip();
    }
    return context;
}

/** Skips the running test, saying why, where there is no OpenGL 4.5. */
static inline void test_need_gl(void)
{
    gl_context_destroy(test_gl_context(NULL, NULL));
}

/** Fails unless the status is CONUS_OK, or skips the running test where there is no OpenGL 4.5: a driver that is there
 * and refuses a shader fails it. */
#define assert_gl(status) test_gl_status((status), #status, __FILE__, __LINE__)
static inline void test_gl_status(conus_status status, const char *what, const char *file, int line)
{
    if (status == CONUS_ERROR_GL) {
        test_need_gl();
    }
    test_status(status, CONUS_OK, what, file, line);
}

/** A current context and its driver's messages, without remarks. */
struct test_gl {
    struct gl_context *context;
    struct gl_current previous;
    int messages;
};

static inline void test_gl_count(void *user, const conus_note *note)
{
    struct test_gl *gl = user;
    gl->messages += note->severity >= CONUS_SEVERITY_WARNING;
    print_message("%s\n", note->line);
}

/** Makes a context current, or skips the running test. Pair with test_gl_leave(). */
static inline void test_gl_enter(struct test_gl *gl)
{
    *gl = (struct test_gl){0};
    gl->context = test_gl_context(test_gl_count, gl);
    assert_ok(gl_context_use(gl->context, &gl->previous));
}

/** Ends it; fails if the driver found anything wrong. */
static inline void test_gl_leave(struct test_gl *gl)
{
    gl_current_restore(&gl->previous);
    gl_context_destroy(gl->context);
    assert_int_equal(gl->messages, 0);
}

#endif
