/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists that shaders append to: they grow, take turns or refuse. */
#include "gl_pair.h"
#include "render/gl/gl.h"
#include "test.h"
#include "test_gl.h"

enum { EDGE = 40, PIXELS = EDGE * EDGE, BINDING = 3, MANY = 100 };

/* Pixel p appends (p, 0), (p, 1), ... : as many as `length(p)` says. */
static const char fragment[] = "layout(std430, binding = BINDING) restrict buffer List"
                               "{ uint count; uint unused; uvec2 records[]; };\n"
                               "uniform ivec2 pixels;\n"
                               "void main() {\n"
                               "int p = int(gl_FragCoord.y) * EDGE + int(gl_FragCoord.x);\n"
                               "for (int k = 0; p >= pixels.x && p < pixels.y && k < (p == 7 ? MANY : p % 5); k++) {\n"
                               "uint place = atomicAdd(count, 1u);\n"
                               "if (place < uint(records.length())) { records[place] = uvec2(p, k); }\n"
                               "} }\n";

struct drawing {
    struct test_gl gl;
    GLuint program, vertices;
    GLint pixels;
    struct target target;
    uint32_t next[PIXELS]; /* the next record expected of each pixel */
    size_t draws, portions;
};

static uint32_t length(uint32_t pixel)
{
    return pixel == 7 ? MANY : pixel % 5;
}

/* Enters GL, or skips the running test. */
static void drawing_init(struct drawing *drawing)
{
    *drawing = (struct drawing){0};
    test_gl_enter(&drawing->gl);
    const struct program_define defines[] = {{"BINDING", BINDING}, {"EDGE", EDGE}, {"MANY", MANY}};
    const struct program_source source = {.vertex = {"screen.vert.glsl", shader_screen_vert},
                                          .fragment = {"list.frag.glsl", fragment},
                                          .defines = defines,
                                          .define_count = 3};
    assert_ok(program_create(&drawing->program, &source));
    assert_ok(target_init(&drawing->target, EDGE, EDGE, NULL, 0));
    drawing->pixels = program_uniform(drawing->program, "pixels");
    glCreateVertexArrays(1, &drawing->vertices);
}

static void drawing_finish(struct drawing *drawing)
{
    glDeleteProgram(drawing->program);
    glDeleteVertexArrays(1, &drawing->vertices);
    target_finish(&drawing->target);
    test_gl_leave(&drawing->gl);
}

static void draw_records(struct drawing *drawing, uint32_t first, uint32_t end)
{
    target_bind(&drawing->target);
    glBindVertexArray(drawing->vertices);
    glUseProgram(drawing->program);
    glUniform2i(drawing->pixels, (GLint)first, (GLint)end);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    drawing->draws++;
}

/* Asserts that everything comes once, and the records of one pixel in their order. */
static void take_records(struct drawing *drawing, const uint32_t (*record)[2], uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        assert_in_range(record[i][0], 0, PIXELS - 1);
        assert_int_equal(record[i][1], drawing->next[record[i][0]]++);
    }
    drawing->portions += count > 0;
}

static conus_status collect(struct shader_list *list, struct drawing *drawing, uint32_t per_pixel)
{
    conus_status status = CONUS_OK;
    shader_list_begin(list, PIXELS, per_pixel);
    while (!status && shader_list_next(list, BINDING)) {
        const void *records = NULL;
        uint32_t count = 0;
        draw_records(drawing, list->first, list->end);
        status = shader_list_read(list, &records, &count);
        if (!status) {
            take_records(drawing, (const uint32_t(*)[2])records, count);
        }
    }
    return status;
}

static void assert_complete(struct drawing *drawing)
{
    for (uint32_t p = 0; p < PIXELS; p++) {
        assert_int_equal(drawing->next[p], length(p));
        drawing->next[p] = 0;
    }
}

static void a_list_grows_until_all_fits(void **state)
{
    (void)state;
    struct shader_list list;
    struct drawing drawing;
    drawing_init(&drawing);
    const int before = gl_pair_waits();
    assert_ok(shader_list_init(&list, 8, 1));
    assert_ok(collect(&list, &drawing, MANY));
    assert_complete(&drawing);
    assert_int_equal(drawing.draws, 2);
    assert_int_equal(drawing.portions, 1);
    assert_ok(collect(&list, &drawing, MANY)); /* once it has grown, it fits */
    assert_complete(&drawing);
    assert_int_equal(drawing.draws, 3);
    assert_int_equal(gl_pair_waits() - before, 3);
    shader_list_finish(&list);
    drawing_finish(&drawing);
}

/* No record is lost, however little the list holds. */
static void a_list_at_its_limit_takes_turns(void **state)
{
    (void)state;
    struct drawing drawing;
    drawing_init(&drawing);
    for (uint32_t limit = 100; limit < 5000; limit *= 2) {
        struct shader_list list;
        assert_ok(shader_list_init(&list, 8, 50));
        list.limit = limit;
        drawing.portions = 0;
        assert_ok(collect(&list, &drawing, MANY));
        assert_complete(&drawing);
        assert_in_range(drawing.portions, PIXELS * 2 / limit, PIXELS);
        assert_int_equal(list.capacity, limit < 3100 ? limit : list.capacity);
        shader_list_finish(&list);
    }
    drawing_finish(&drawing);
}

static void one_pixel_too_many_is_refused(void **state)
{
    (void)state;
    struct shader_list list;
    struct drawing drawing;
    drawing_init(&drawing);
    assert_ok(shader_list_init(&list, 8, 50));
    list.limit = 99;
    assert_fails(collect(&list, &drawing, MANY), CONUS_ERROR_UNSUPPORTED);
    shader_list_finish(&list);
    drawing_finish(&drawing);
}

/* The counter has 32 bits: the pixels are drawn in portions that cannot exceed it. */
static void the_counter_cannot_run_over(void **state)
{
    (void)state;
    struct shader_list list;
    struct drawing drawing;
    drawing_init(&drawing);
    assert_ok(shader_list_init(&list, 8, 500));
    assert_ok(collect(&list, &drawing, UINT32_MAX / 100));
    assert_complete(&drawing);
    assert_int_equal(drawing.portions, PIXELS / 100);
    assert_ok(collect(&list, &drawing, 0));
    assert_int_equal(drawing.portions, PIXELS / 100);
    shader_list_finish(&list);
    drawing_finish(&drawing);
}

TEST_GROUP(gl_list)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_list_grows_until_all_fits),
        cmocka_unit_test(a_list_at_its_limit_takes_turns),
        cmocka_unit_test(one_pixel_too_many_is_refused),
        cmocka_unit_test(the_counter_cannot_run_over),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
