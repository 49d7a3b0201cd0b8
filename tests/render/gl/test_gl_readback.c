/* SPDX-License-Identifier: BSD-3-Clause */
/* What is read of the device: whole, after one wait, or an error. */
#include "gl_pair.h"
#include "render/gl/gl.h"
#include "test.h"
#include "test_gl.h"

#include <string.h>

enum { PARTS = 4, LONGEST = 70000 };

static uint8_t byte_of(size_t part, size_t k)
{
    return (uint8_t)(31 * part + k % 251);
}

static GLuint make_buffer(size_t part)
{
    static uint8_t bytes[LONGEST];
    GLuint buffer = 0;
    for (size_t k = 0; k < LONGEST; k++) {
        bytes[k] = byte_of(part, k);
    }
    glCreateBuffers(1, &buffer);
    glNamedBufferData(buffer, LONGEST, bytes, GL_DYNAMIC_COPY);
    return buffer;
}

/* The beginnings of four buffers, of odd sizes, none among them, which grow and shrink. */
static void buffers_are_read_together(void **state)
{
    static const size_t sizes[][PARTS] = {
        {1, 0, 5, 16}, {17, LONGEST, 3, 0}, {0, 8, 8, 1000}, {9, 9, LONGEST, LONGEST}};
    (void)state;
    struct test_gl gl;
    struct readback readback = {0};
    struct readback_part parts[PARTS];
    test_gl_enter(&gl);
    for (size_t i = 0; i < PARTS; i++) {
        parts[i].buffer = make_buffer(i);
    }
    for (size_t round = 0; round < sizeof sizes / sizeof sizes[0]; round++) {
        const int before = gl_pair_waits();
        for (size_t i = 0; i < PARTS; i++) {
            parts[i].size = sizes[round][i];
        }
        assert_ok(readback_wait(&readback, parts, PARTS, "test"));
        assert_int_equal(gl_pair_waits() - before, 1);
        for (size_t i = 0; i < PARTS; i++) {
            assert_int_equal((uintptr_t)parts[i].data % 8, 0);
            for (size_t k = 0; k < parts[i].size; k++) {
                assert_int_equal(((const uint8_t *)parts[i].data)[k], byte_of(i, k));
            }
        }
    }
    for (size_t i = 0; i < PARTS; i++) {
        glDeleteBuffers(1, &parts[i].buffer);
    }
    readback_finish(&readback);
    readback_finish(&readback); /* it is empty again */
    test_gl_leave(&gl);
}

static PFNGLCLIENTWAITSYNCPROC driver_wait;
static int early; /* answers that the fence is still to come, before this one */
static GLenum last;

static GLenum GLAPIENTRY wait_in_vain(GLsync fence, GLbitfield flags, GLuint64 limit)
{
    GLenum answer = driver_wait(fence, flags, limit);
    return early-- > 0 ? GL_TIMEOUT_EXPIRED : last ? last : answer;
}

static conus_status read_with(struct readback_part part, int timeouts, GLenum answer)
{
    struct readback readback = {0};
    driver_wait = glClientWaitSync;
    glClientWaitSync = wait_in_vain;
    early = timeouts;
    last = answer;
    conus_status status = readback_wait(&readback, &part, 1, "test of waiting");
    glClientWaitSync = driver_wait;
    readback_finish(&readback);
    return status;
}

/* A device that takes long is waited for; one that is lost, or refuses the copy, is not taken for one that is done. */
static void a_fence_that_fails_is_an_error(void **state)
{
    (void)state;
    struct gl_context *context = test_gl_context(NULL, NULL);
    struct gl_current previous;
    assert_ok(gl_context_use(context, &previous));
    const struct readback_part part = {make_buffer(0), 100, NULL};
    const struct readback_part longer = {part.buffer, LONGEST + 1, NULL};
    assert_ok(read_with(part, 5, 0));
    assert_int_equal(early, -1);
    assert_fails(read_with(part, 0, GL_WAIT_FAILED), CONUS_ERROR_GL);
    assert_non_null(strstr(conus_message(), "test of waiting"));
    assert_fails(read_with(longer, 0, 0), CONUS_ERROR_GL);
    assert_non_null(strstr(conus_message(), "test of waiting (error 0x0501)")); /* GL_INVALID_VALUE */
    assert_ok(read_with(part, 0, 0));
    glDeleteBuffers(1, &part.buffer);
    gl_current_restore(&previous);
    gl_context_destroy(context);
}

TEST_GROUP(gl_readback)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(buffers_are_read_together),
        cmocka_unit_test(a_fence_that_fails_is_an_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
