/* SPDX-License-Identifier: BSD-3-Clause */
/* Structs of options grow: a caller compiled with a smaller one gets the defaults of the members that it does not
 * have. */
#include "base/options.h"
#include "test.h"

#include <conus/own.h>

#include <string.h>

struct before {
    size_t struct_size;
    int a;
};
struct now {
    size_t struct_size;
    int a;
    double b;
};

static void of_the_same_version(void **state)
{
    (void)state;
    const struct now given = {.a = 1, .b = 2};
    const struct now *all = options_of(struct now, &given);
    assert_int_equal(all->struct_size, sizeof *all);
    assert_int_equal(all->a, 1);
    assert_true(all->b == 2);
}

static void without_options(void **state)
{
    (void)state;
    const struct now *all = options_of(struct now, NULL);
    assert_int_equal(all->struct_size, sizeof *all);
    assert_int_equal(all->a, 0);
    assert_true(all->b == 0);
}

static void of_an_older_version(void **state)
{
    (void)state;
    const struct now given = {.struct_size = sizeof(struct before), .a = 1, .b = 2};
    const struct now *all = options_of(struct now, &given);
    assert_int_equal(all->struct_size, sizeof *all);
    assert_int_equal(all->a, 1);
    assert_true(all->b == 0);
}

static void of_a_newer_version(void **state)
{
    (void)state;
    const struct {
        struct now known;
        double more;
    } given = {{.struct_size = sizeof given, .a = 1, .b = 2}, 3};
    const struct now *all = options_of(struct now, &given);
    assert_int_equal(all->struct_size, sizeof *all);
    assert_int_equal(all->a, 1);
    assert_true(all->b == 2);
}

/* A caller that knows only struct_size and space; the bytes behind them would be refused. */
static void library_reads_a_smaller_struct(void **state)
{
    (void)state;
    conus_pose_list *list = NULL;
    conus_pose_options options;
    memset(&options, 0x77, sizeof options);
    options.struct_size = offsetof(conus_pose_options, axis);
    options.space = CONUS_SPACE_LPS;
    assert_ok(conus_write_file("growth.txt", "1 2 3\n", 6));
    assert_ok(conus_pose_list_load(&list, "growth.txt", &options));
    assert_true(conus_pose_list_row(list, 0)->pose.world_from_device[12] == -1);
    conus_pose_list_destroy(list);
    options.struct_size = 0;
    assert_fails(conus_pose_list_load(&list, "growth.txt", &options), CONUS_ERROR_ARGUMENT);
}

static void initialisers_are_defaults(void **state)
{
    (void)state;
    conus_view view = CONUS_VIEW_INIT;
    conus_pose_options poses = CONUS_POSE_OPTIONS_INIT;
    assert_int_equal(view.struct_size, sizeof view);
    assert_memory_equal(&view, options_of(conus_view, NULL), sizeof view);
    assert_memory_equal(&poses, options_of(conus_pose_options, NULL), sizeof poses);
}

TEST_GROUP(growth)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_the_same_version),       cmocka_unit_test(without_options),
        cmocka_unit_test(of_an_older_version),       cmocka_unit_test(of_a_newer_version),
        cmocka_unit_test(initialisers_are_defaults), cmocka_unit_test(library_reads_a_smaller_struct),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
