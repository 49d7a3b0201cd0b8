/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the window's title. */
#include "viewer/window/window.h"

#include "conus/own.h"
#include "test.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void assert_titled(const struct window *window, const char *wanted)
{
    char title[TITLE_SIZE];
    title_write(title, window);
    assert_string_equal(title, wanted);
}

/* Asserts the name of the confirmed object in the list and in the table. */
static void assert_pinned(const struct viewer *viewer, const char *wanted)
{
    char title[VIEW_ATLAS_TITLE];
    char row[VIEW_ATLAS_TITLE + 2];
    assert_int_equal(viewer->pin_count, 1);
    assert_string_equal(viewer_pin_title(title, viewer, viewer->pins), wanted);
    snprintf(row, sizeof row, "\n%s\t", wanted);
    char *table = viewer_pins_text(viewer);
    assert_non_null(strstr(table, row));
    free(table);
}

/* The outermost ball has a namesake among the pathways, but no other ball has. */
static void names_of_two_kinds_are_told_apart(void **state)
{
    struct window window = {.screen.enlarged = -1};
    struct viewer viewer;
    const conus_pathway_options namesake = {.name = "Shell outer", .threshold = 1000};
    char path[600];
    conus_atlas *atlas = NULL;
    (void)state;
    snprintf(path, sizeof path, "%s/nested.nii.gz", test_scratch("phantom"));
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_ok(conus_atlas_add_pathway(atlas, path, &namesake));
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = path}, 1, NULL, NULL, NULL));
    window.viewer = &viewer;
    viewer_choose(&viewer, 3);
    assert_titled(&window, "conus - nested.nii.gz - Core (chosen)");
    viewer_choose(&viewer, (uint32_t)conus_atlas_object_count(atlas));
    assert_titled(&window, "conus - nested.nii.gz - pathway Shell outer (chosen)");
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){0, 90, 0}, (const double[]){0, -1, 0});
    assert_titled(&window, "conus - nested.nii.gz - area Shell outer (hit)");
    tool_confirm(&viewer, FIRST_TOOL);
    assert_memory_equal(viewer.message, "kept: area Shell outer, ", 24);
    assert_pinned(&viewer, "area Shell outer");
    viewer.pins[0].object = 0; /* the atlas has it no longer */
    assert_pinned(&viewer, "Shell outer");
    viewer_finish(&viewer);
}

/* A ray from y = 90 towards the balls of "nested" meets the outermost first. */
static void the_title_says_what_is_open_and_hit(void **state)
{
    struct window window = {.screen.enlarged = -1};
    struct viewer viewer;
    conus_atlas *atlas = NULL;
    char path[600];
    char folder[512];
    (void)state;
    assert_titled(&window, "conus");
    snprintf(folder, sizeof folder, "%s", test_scratch("phantom"));
    assert_ok(conus_phantom_write("nested", folder, NULL));
    snprintf(path, sizeof path, "%s/nested.nii.gz", folder);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = path}, 1, NULL, NULL, NULL));
    window.viewer = &viewer;
    assert_titled(&window, "conus - nested.nii.gz");
    viewer_choose(&viewer, 3);
    assert_titled(&window, "conus - nested.nii.gz - Core (chosen)");
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){0, 90, 0}, (const double[]){0, -1, 0});
    assert_titled(&window, "conus - nested.nii.gz - Shell outer (hit)");
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_TRACKER; /* and there is none any more */
    assert_titled(&window, "conus - nested.nii.gz - Shell outer (old answer)");
    viewer.tools[FIRST_TOOL].pointer = POINT_BY_MOUSE;
    tool_confirm(&viewer, FIRST_TOOL);
    assert_pinned(&viewer, "Shell outer");
    viewer.tools[FIRST_TOOL].held = true;
    window.history.session_path = strdup("/a/my\n.json");
    assert_titled(&window, "conus - nested.nii.gz [my .json] - Shell outer (held)");
    window.start.on = true;
    assert_titled(&window, "conus");
    free(window.history.session_path);
    viewer_finish(&viewer);
}

TEST_GROUP(title)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_title_says_what_is_open_and_hit),
        cmocka_unit_test(names_of_two_kinds_are_told_apart), /* the phantom is there */
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
