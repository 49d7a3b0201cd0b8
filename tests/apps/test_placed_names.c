/* SPDX-License-Identifier: BSD-3-Clause */
/* Names in a pane: no name lies on another, whatever the places, and each object has one name. */
#include "viewer/window/window.h"

#include "test.h"

enum { TRIALS = 400, NAMES = 9 };

static bool meet(const struct ui_box *a, const struct ui_box *b)
{
    return a->x < b->x + b->width && b->x < a->x + a->width && a->y < b->y + b->height && b->y < a->y + a->height;
}

static void names_never_overlap(void **state)
{
    const struct ui_box pane = {60, 20, 500, 400};
    size_t placed = 0;
    uint64_t random = 5;
    (void)state;
    for (int trial = 0; trial < TRIALS; trial++) {
        struct labels labels = {.count = 0};
        const struct ui_box kept = {60, 20, 300, 30};
        labels_reserve(&labels, kept);
        for (uint32_t object = 1; object <= NAMES; object++) { /* all within a few pixels: the worst case */
            const float at[2] = {(float)test_random(&random, 200, 260), (float)test_random(&random, 200, 230)};
            const float size[2] = {(float)test_random(&random, 60, 180), 18};
            struct ui_box box;
            if (labels_place(&box, &labels, &pane, at, size, object % 2, object)) {
                placed++;
                assert_true(box.x >= pane.x && box.x + box.width <= pane.x + pane.width);
                assert_true(box.y >= pane.y && box.y + box.height <= pane.y + pane.height);
                assert_false(at[0] > box.x && at[0] < box.x + box.width && at[1] > box.y && at[1] < box.y + box.height);
            }
        }
        for (size_t i = 0; i < labels.count; i++) {
            for (size_t k = 0; k < i; k++) {
                assert_false(meet(&labels.items[i].box, &labels.items[k].box));
            }
        }
    }
    assert_true(placed > TRIALS * NAMES * 9 / 10); /* there is room for nearly all */
}

/* Another area lies from x = 200 on; of object 3 all is another one's. */
static bool is_left(void *user, const struct ui_box *box, uint32_t object)
{
    (*(size_t *)user)++;
    return object != 3 && box->x + box->width <= 200;
}

/* The first place would be to the right of the point, which is taken where nothing is said against it. */
static void names_lie_where_they_may(void **state)
{
    const struct ui_box pane = {0, 0, 400, 300};
    const float at[2] = {190, 100};
    const float size[2] = {80, 18};
    size_t asked = 0;
    struct labels labels = {.allows = is_left, .user = &asked};
    struct ui_box box;
    (void)state;
    assert_true(labels_place(&box, &labels, &pane, at, size, false, 7));
    assert_true(box.x + box.width < at[0]);
    assert_true(asked > 1);
    assert_false(labels_place(&box, &labels, &pane, at, size, false, 3));
    assert_false(labels_has(&labels, 3));
    labels = (struct labels){.count = 0};
    assert_true(labels_place(&box, &labels, &pane, at, size, false, 7));
    assert_true(box.x > at[0]);
}

static void an_object_has_one_name(void **state)
{
    const struct ui_box pane = {0, 0, 400, 300};
    const float size[2] = {80, 18};
    struct labels labels = {.count = 0};
    struct ui_box box = {.x = -1};
    (void)state;
    assert_false(labels_has(&labels, 7));
    assert_true(labels_place(&box, &labels, &pane, (float[]){100, 100}, size, false, 7));
    assert_true(box.x == 118 && box.y == 91); /* beside it, at its height */
    assert_true(labels_has(&labels, 7));
    box.x = -1;
    assert_false(labels_place(&box, &labels, &pane, (float[]){300, 200}, size, false, 7));
    assert_true(box.x == -1);
    assert_true(labels_place(&box, &labels, &pane, (float[]){300, 200}, size, true, 8));
    assert_true(box.x == 260 && box.y + box.height < 200); /* above it, in the middle */
    assert_false(labels_place(&box, &labels, &(struct ui_box){0, 0, 60, 300}, (float[]){30, 30}, size, false, 9));
}

TEST_GROUP(placed_names)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_never_overlap),
        cmocka_unit_test(names_lie_where_they_may),
        cmocka_unit_test(an_object_has_one_name),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
