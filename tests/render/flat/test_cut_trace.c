/* SPDX-License-Identifier: BSD-3-Clause */
/* Outlines of a cut: for every pattern of pixels the outline covers exactly the pixels that border on another
 * number. */
#include "render/flat/cut.h"

#include "test.h"

#include <math.h>
#include <string.h>

enum { SIDE = 12, TRIALS = 400 };

static const conus_object list[] = {{.rgb = {255, 0, 0}}, {.rgb = {0, 0, 255}}};

static struct draw_list *trace(const uint32_t *objects, const bool *skips)
{
    struct draw_list *lines = NULL;
    assert_ok(draw_list_create(&lines, 1, 1));
    const struct cut_lines to = {.out = lines, .list = list, .width = 1, .at = {100, 200}};
    assert_ok(cut_trace_areas(&to, objects, SIDE, SIDE, skips));
    assert_false(lines->failed);
    return lines;
}

/* Marks the pixels whose centres a loop passes; all its lines are along the axes. */
static void mark(uint8_t marks[SIDE * SIDE], const struct draw_item *loop)
{
    for (size_t k = 0; k < loop->count; k++) {
        const double *from = loop->points[k];
        const double *to = loop->points[(k + 1) % loop->count];
        double step[2] = {to[0] - from[0], to[1] - from[1]};
        double length = fabs(step[0]) + fabs(step[1]);
        assert_true(step[0] == 0 || step[1] == 0);
        for (long s = 0; s <= lrint(length); s++) {
            double part = length > 0 ? (double)s / length : 0;
            size_t column = (size_t)(from[0] + part * step[0] - 100);
            size_t row = (size_t)(from[1] + part * step[1] - 200);
            assert_true(column < SIDE && row < SIDE);
            marks[SIDE * row + column] = 1;
        }
    }
}

static bool is_at(const uint32_t *objects, size_t pixel, int right, int down, uint32_t object)
{
    int column = (int)(pixel % SIDE) + right;
    int row = (int)(pixel / SIDE) + down;
    return column >= 0 && row >= 0 && column < SIDE && row < SIDE && objects[SIDE * row + column] == object;
}

/* Whether one of the four neighbours, or with `corners` of the eight, has another number. */
static bool borders(const uint32_t *objects, size_t pixel, bool corners)
{
    for (int down = -1; down <= 1; down++) {
        for (int right = -1; right <= 1; right++) {
            bool counts = corners || right == 0 || down == 0;
            if (counts && !is_at(objects, pixel, right, down, objects[pixel])) {
                return true;
            }
        }
    }
    return false;
}

/* Pixels that touch another number only at a corner may be covered, where the line turns. */
static void outlines_cover_the_outermost_pixels(void **state)
{
    (void)state;
    uint64_t random = 7;
    for (int trial = 0; trial < TRIALS; trial++) {
        uint32_t objects[SIDE * SIDE];
        uint8_t marks[2][SIDE * SIDE] = {{0}};
        for (int i = 0; i < SIDE * SIDE; i++) {
            objects[i] = test_random(&random, 0, 100) < trial % 90 ? (uint32_t)test_random(&random, 1, 3) : 0;
        }
        struct draw_list *lines = trace(objects, NULL);
        for (size_t i = 0; i < lines->count; i++) {
            assert_int_equal(lines->items[i].kind, DRAW_LOOP);
            mark(marks[lines->items[i].rgba[2] > 0], &lines->items[i]);
        }
        for (size_t i = 0; i < SIDE * SIDE; i++) {
            for (uint32_t n = 1; n <= 2; n++) {
                bool is_one = objects[i] == n;
                assert_true(!marks[n - 1][i] || (is_one && borders(objects, i, true)));
                assert_true(marks[n - 1][i] || !is_one || !borders(objects, i, false));
            }
        }
        draw_list_destroy(lines);
    }
}

static void a_hole_has_a_loop_and_what_is_skipped_has_none(void **state)
{
    (void)state;
    uint32_t objects[SIDE * SIDE] = {0};
    for (int row = 2; row < 9; row++) {
        for (int column = 1; column < 8; column++) {
            objects[SIDE * row + column] = row == 5 && column == 4 ? 2 : 1;
        }
    }
    struct draw_list *lines = trace(objects, NULL);
    assert_int_equal(lines->count, 3);
    assert_int_equal(lines->items[0].count, 4);
    static const double corners[4][2] = {{107.5, 202.5}, {107.5, 208.5}, {101.5, 208.5}, {101.5, 202.5}};
    assert_memory_equal(lines->items[0].points, corners, sizeof corners);
    draw_list_destroy(lines);
    lines = trace(objects, (const bool[]){false, true, false});
    assert_int_equal(lines->count, 1);
    assert_int_equal(lines->items[0].rgba[2], 1);
    draw_list_destroy(lines);
}

/* Two cuts of a cone: through its apex along the axis, and across it 20 mm away, where it is a circle. */
static void the_line_of_a_cone_is_where_its_wall_is(void **state)
{
    (void)state;
    const double matrix[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    const struct cut_cone cone = {.world_from_cone = matrix, .slope = 0.25, .far = INFINITY};
    struct cut_place place = {
        .centre = {0, 0, -20}, .right = {1, 0, 0}, .up = {0, 1, 0}, .mm_per_pixel = 0.1, .width = 160, .height = 160};
    struct draw_list *lines = trace((const uint32_t[SIDE *SIDE]){0}, NULL);
    cut_trace_cone(&(struct cut_lines){.out = lines, .width = 1}, &place, &cone);
    assert_int_equal(lines->count, 2); /* a dark edge under the amber line, as long and wider */
    assert_true(lines->items[0].count > 100 && lines->items[1].count == lines->items[0].count);
    assert_true(lines->items[0].width > 1.5 * lines->items[1].width && lines->items[0].rgba[0] < 0.3F);
    for (size_t k = 0; k < lines->items[0].count; k++) {
        const double *p = lines->items[0].points[k];
        assert_near(hypot(p[0] - 80, p[1] - 80), 50, 0.1);
    }
    draw_list_destroy(lines);
}

TEST_GROUP(cut_trace)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_cover_the_outermost_pixels),
        cmocka_unit_test(a_hole_has_a_loop_and_what_is_skipped_has_none),
        cmocka_unit_test(the_line_of_a_cone_is_where_its_wall_is),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
