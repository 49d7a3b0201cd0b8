/* SPDX-License-Identifier: BSD-3-Clause */
/* The shaders that the bench adds, by glslang. */
#include "bench/support/frame.h"
#include "bench/torus/torus.h"
#include "shader_check.h"
#include "test.h"
#include "test_gl.h"

static void glslang_takes_those_of_the_bench(void **state)
{
    (void)state;
    shader_check_begin();
    struct torus_round round;
    assert_ok(torus_round_init(&round, 10, false));
    torus_round_finish(&round);
    struct test_gl gl;
    struct slicing slicing;
    test_gl_enter(&gl);
    assert_ok(slicing_init(&slicing, 4));
    slicing_finish(&slicing);
    test_gl_leave(&gl);
    assert_true(shader_check_saw("#define PAINT 0\n", "clip_from_world") &&
                shader_check_saw("#define PAINT 1\n", "torus"));
    assert_true(shader_check_end() >= 4);
}

TEST_GROUP(bench_shaders)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glslang_takes_those_of_the_bench),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
