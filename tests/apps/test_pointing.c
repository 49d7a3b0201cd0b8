/* SPDX-License-Identifier: BSD-3-Clause */
/* The mouse's cone without a window: where it begins, when it stays, which notices it has. */
#include "viewer/model/viewer.h"
#include "viewer/session/property.h"
#include "viewer/tools/tools.h"

#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Voxels of 1 mm, whose indices from the middle are mm: x and z to HALF_SIDE, y to HALF_LENGTH. */
enum {
    HALF_SIDE = 30,
    HALF_LENGTH = 80,
    SIDE = 2 * HALF_SIDE + 1,
    LENGTH = 2 * HALF_LENGTH + 1,
    VOXELS = SIDE * LENGTH * SIDE
};

static const double eye[3] = {0, 90, 0};
static const double back[3] = {0, -1, 0};

static size_t voxel_of(int x, int y, int z)
{
    return (size_t)(x + HALF_SIDE) +
           (size_t)SIDE * ((size_t)(y + HALF_LENGTH) + (size_t)LENGTH * (size_t)(z + HALF_SIDE));
}

/* A block of the label 1 where x < 0 and 2 beside it, up to @p front voxels to each side of the middle along y. */
static conus_atlas *make_blocks(int front)
{
    conus_atlas *atlas = NULL;
    uint8_t *labels = calloc(VOXELS, 1);
    assert_non_null(labels);
    for (int z = -20; z <= 20; z++) {
        for (int y = -front; y <= front; y++) {
            for (int x = -20; x <= 20; x++) {
                labels[voxel_of(x, y, z)] = x < 0 ? 1 : 2;
            }
        }
    }
    const conus_voxels voxels = {
        .data = labels,
        .type = CONUS_SCALAR_UINT8,
        .dim = {SIDE, LENGTH, SIDE},
        .world_from_voxel = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -HALF_SIDE, -HALF_LENGTH, -HALF_SIDE, 1}};
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL));
    free(labels);
    return atlas;
}

/* A head of grey 100 where |y| is at most 40, and before it two voxels of noise, at y = 46 and 60. */
static void add_head(conus_atlas *atlas)
{
    float *grey = calloc(VOXELS, sizeof *grey);
    assert_non_null(grey);
    for (int z = -HALF_SIDE; z <= HALF_SIDE; z++) {
        for (int y = -40; y <= 40; y++) {
            for (int x = -HALF_SIDE; x <= HALF_SIDE; x++) {
                grey[voxel_of(x, y, z)] = 100;
            }
        }
    }
    grey[voxel_of(0, 46, 0)] = grey[voxel_of(0, 60, 0)] = 100;
    const conus_voxels voxels = {
        .data = grey,
        .type = CONUS_SCALAR_FLOAT32,
        .dim = {SIDE, LENGTH, SIDE},
        .world_from_voxel = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -HALF_SIDE, -HALF_LENGTH, -HALF_SIDE, 1}};
    assert_ok(conus_atlas_set_context_voxels(atlas, &voxels, NULL));
    free(grey);
}

static void open_atlases(struct viewer *out, conus_atlas *first, conus_atlas *second)
{
    const struct view_source sources[] = {{.atlas = first, .path = "a"}, {.atlas = second, .path = "b"}};
    assert_ok(viewer_create(out, sources, second ? 2 : 1, NULL, NULL, NULL));
}

/* The front faces of the voxels at y = 20 are at 20.5, which is 69.5 mm from the eye at y = 90. */
static void without_a_context_the_atlas_is_the_surface(void **state)
{
    struct viewer viewer;
    (void)state;
    open_atlases(&viewer, make_blocks(20), NULL);
    assert_near(point_depth(&viewer, eye, back), 69.5, 1e-9);
    assert_true(isinf(point_depth(&viewer, eye, (double[]){0, 1, 0})));
    assert_true(isinf(point_depth(&viewer, (double[]){-25, 90, 0}, back)));
    viewer_hide(&viewer, 2, true); /* x = 0 is in it */
    assert_true(isinf(point_depth(&viewer, eye, back)));
    assert_near(point_depth(&viewer, (double[]){-10, 90, 0}, back), 69.5, 1e-9);
    viewer_finish(&viewer);
}

/* Between the centres at y = 40 (100) and 41 (0) the grey falls to 20, a fifth of the cuts' window of 0 to 100, at y =
 * 40.8: 49.2 mm from the eye. The noise is brighter than that for only 1.6 mm, less than the two voxels, 2 mm, that a
 * skin needs. */
static void a_context_is_the_surface_where_its_skin_is(void **state)
{
    struct viewer viewer;
    conus_atlas *atlas = make_blocks(20);
    (void)state;
    add_head(atlas);
    open_atlases(&viewer, atlas, NULL);
    assert_near(viewer.drawn->found_grey[0], 0, 1e-9);
    assert_near(viewer.drawn->found_grey[1], 100, 1e-4);
    assert_near(point_depth(&viewer, eye, back), 49.2, 0.02);
    assert_near(point_depth(&viewer, (double[]){5, 200, 5}, back), 159.2, 0.02);
    for (int tenth = 0; tenth < 10; tenth++) { /* whatever the distance at which the steps of a voxel meet the noise */
        assert_near(point_depth(&viewer, (double[]){0, 50 + 0.1 * tenth, 0}, back), 9.2 + 0.1 * tenth, 0.02);
    }
    viewer.display.fade = 1; /* a head that is not drawn is a head still */
    assert_near(point_depth(&viewer, eye, back), 49.2, 0.02);
    viewer_finish(&viewer);
}

/* The second atlas reaches to 50.5, before the head of the first: 39.5 mm. */
static void the_nearest_atlas_is_the_surface(void **state)
{
    struct viewer viewer;
    conus_atlas *atlas = make_blocks(20);
    (void)state;
    add_head(atlas);
    open_atlases(&viewer, atlas, make_blocks(50));
    assert_near(point_depth(&viewer, eye, back), 39.5, 1e-9);
    viewer_finish(&viewer);
}

/* Aims as the command `point` of scripts does. */
static bool aim_through(struct viewer *viewer, const double from[3], const double direction[3])
{
    conus_pose pose;
    bool found = point_find(&pose, viewer, from, direction);
    if (found) {
        tool_aim(viewer, FIRST_TOOL, &pose);
    }
    return found;
}

static void the_mouse_puts_the_apex_there(void **state)
{
    struct viewer viewer;
    struct window window = {.viewer = &viewer};
    const double *m = viewer.tools[FIRST_TOOL].pose.world_from_device;
    (void)state;
    open_atlases(&viewer, make_blocks(20), NULL);
    assert_near(viewer.tools[FIRST_TOOL].angle, 5, 0);
    assert_false(aim_through(&viewer, eye, (double[]){0, 1, 0}));
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    /* before the surface, by half the radius of a small atlas: the opening counts */
    const double before = point_before(&viewer);
    assert_near(before, viewer.radius / 2, 1e-9);
    assert_true(before < 40);
    assert_true(aim_through(&viewer, eye, back));
    assert_near(m[13], 20.5 + before, 1e-9);
    assert_near(conus_selection_result(viewer_selection(&viewer), 0)->distance, before, 1e-4);
    viewer.cone.options.range[1] = 30; /* depths are told from the surface */
    assert_true(aim_through(&viewer, eye, back));
    assert_near(m[13], 20.5, 1e-9);
    viewer.cone.options.range[1] = 0;
    assert_true(aim_through(&viewer, (double[]){0, 20.5 + before / 2, 0}, back)); /* never behind the eye */
    assert_near(m[13], 20.5 + before / 2, 1e-9);
    property_set(&window, PROPERTY_START, START_SURFACE);
    assert_true(aim_through(&viewer, eye, back));
    assert_near(m[12], 0, 1e-9);
    assert_near(m[13], 20.5, 1e-9);
    assert_near(m[9], 1, 1e-9); /* it looks along -z, its third column is +y */
    assert_near(conus_selection_result(viewer_selection(&viewer), 0)->distance, 0, 1e-6);
    unsigned number = viewer.tools[FIRST_TOOL].answer_number;
    assert_false(aim_through(&viewer, eye, (double[]){0, 1, 0})); /* beside the brain it stays */
    assert_near(m[13], 20.5, 1e-9);
    assert_int_equal(viewer.tools[FIRST_TOOL].answer_number, number);
    property_set(&window, PROPERTY_START, START_EYE);
    assert_true(aim_through(&viewer, eye, (double[]){0, 1, 0}));
    assert_near(m[13], 90, 1e-9);
    assert_near(m[9], -1, 1e-9);
    viewer_finish(&viewer);
}

static void the_cone_is_held_freed_and_cleared(void **state)
{
    struct viewer viewer;
    (void)state;
    open_atlases(&viewer, make_blocks(20), make_blocks(50));
    tool_hold(&viewer, FIRST_TOOL);
    assert_false(viewer.tools[FIRST_TOOL].held); /* there is nothing to hold */
    aim_through(&viewer, eye, back);
    tool_hold(&viewer, FIRST_TOOL);
    assert_true(viewer.tools[FIRST_TOOL].held);
    assert_true(viewer.tools[FIRST_TOOL].has_pose);
    tool_hold(&viewer, FIRST_TOOL);
    assert_false(viewer.tools[FIRST_TOOL].held);
    tool_hold(&viewer, FIRST_TOOL);
    unsigned version = viewer.version;
    unsigned number = viewer.tools[FIRST_TOOL].answer_number;
    tool_clear(&viewer);
    assert_false(viewer.tools[FIRST_TOOL].held);
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    assert_null(viewer_selection(&viewer));
    assert_null(view_atlas_selection(&viewer.atlases[1], FIRST_TOOL));
    assert_true(viewer.version > version && viewer.tools[FIRST_TOOL].answer_number > number);
    viewer_hide(&viewer, 1, true); /* asks again only where there is a cone */
    assert_null(viewer_selection(&viewer));
    viewer_finish(&viewer);
}

static void aim_back(struct viewer *viewer, double x)
{
    tool_aim_along(viewer, FIRST_TOOL, (double[]){x, 90, 0}, back);
}

/* From y = 90 along -y the blocks reach from 20.5 to -20.5: depths of 69.5 and 110.5. Their front is flat, so every
 * first hit is as deep as that of the axis. Beside them, at x = 60, where a cone of 5 degrees reaches 5 mm to the side,
 * the place of the axis that is nearest to the middle is y = 0. */
static void a_cone_reaches_from_its_entry_to_its_deepest_hit(void **state)
{
    struct viewer viewer;
    struct extent extent;
    (void)state;
    open_atlases(&viewer, make_blocks(20), NULL);
    aim_back(&viewer, -10);
    extent_find(&extent, &viewer, FIRST_TOOL);
    assert_near(extent.entry[0], -10, 1e-9);
    assert_near(extent.entry[1], 20.5, 1e-9);
    assert_true(viewer.radius < 80); /* a small atlas */
    assert_near(extent.reach, viewer.radius / 2, 1e-9);
    assert_near(extent.near, 0, 0);
    assert_near(extent.solid, 69.5, 1e-4);
    assert_near(extent.end, 110.5, 1e-9);
    viewer.cone.options.layers = CONUS_LAYERS_ALL; /* then all counts up to the end */
    tool_reselect(&viewer);
    extent_find(&extent, &viewer, FIRST_TOOL);
    assert_near(extent.solid, 110.5, 1e-4);
    assert_near(extent.end, 110.5, 1e-4);
    viewer.cone.options.layers = CONUS_LAYERS_VISIBLE;
    viewer.cone.options.range[0] = 80;
    viewer.cone.options.range[1] = 100;
    tool_reselect(&viewer);
    extent_find(&extent, &viewer, FIRST_TOOL);
    assert_near(extent.near, 80, 0);
    assert_near(extent.solid, 80, 0.01); /* it begins inside */
    assert_near(extent.end, 100, 0);
    viewer.cone.options.range[1] = 0;
    aim_back(&viewer, 60);
    extent_find(&extent, &viewer, FIRST_TOOL);
    assert_near(extent.entry[0], 60, 1e-9);
    assert_near(extent.entry[1], viewer.centre[1], 1e-9);
    assert_near(extent.reach, 1.5 * viewer.radius, 1e-9);
    assert_near(extent.solid, extent.end, 0); /* nothing ends it */
    viewer_finish(&viewer);
}

/* The axis from (-5, 90, 0) along (0.35, -1, 0) leaves the blocks at their side, x = 20.5, after 77.2 mm. With all
 * layers the cone ends where its deepest ray does: at the edge (20.5, -20.5, z), 0.35 * 25.5 + 110.5 over the length of
 * the direction, 1.0595, less what its 64 rays a side may miss. */
static void a_cone_through_all_reaches_its_deepest_exit(void **state)
{
    struct viewer viewer;
    struct extent extent;
    (void)state;
    open_atlases(&viewer, make_blocks(20), NULL);
    viewer.tools[FIRST_TOOL].angle = 40;
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){-5, 90, 0}, (double[]){0.35, -1, 0});
    extent_find(&extent, &viewer, FIRST_TOOL);
    assert_near(extent.end, 77.2, 0.1);
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    tool_reselect(&viewer);
    extent_find(&extent, &viewer, FIRST_TOOL);
    assert_near(extent.end, 112.7, 1);
    viewer_finish(&viewer);
}

/* Around the entry (0, 20.5, 0) the ball goes on a sphere of 40 mm. The ray along -y at x = 24 meets that at 32 mm to
 * its front, (24, 52.5, 0), and behind; the ball is in front, and so the axis is along (-0.6, -0.8, 0), and the apex,
 * which is 69.5 mm from the entry, at (41.7, 76.1, 0). The ray at x = 100 passes beside it, nearest at y = 20.5. */
static void a_cone_turns_about_its_entry(void **state)
{
    struct viewer viewer;
    struct extent extent;
    double ball[3];
    const double *m = viewer.tools[FIRST_TOOL].pose.world_from_device;
    (void)state;
    open_atlases(&viewer, make_blocks(20), NULL);
    aim_back(&viewer, 0);
    extent_find(&extent, &viewer, FIRST_TOOL);
    extent.reach = 40;
    extent_ball(ball, &extent, &viewer.tools[FIRST_TOOL].pose);
    assert_near(ball[1], 60.5, 1e-9);
    extent_turn(&viewer, FIRST_TOOL, &extent, (double[]){24, 300, 0}, back);
    assert_near(m[8], 0.6, 1e-9);
    assert_near(m[9], 0.8, 1e-9);
    assert_near(m[12], 41.7, 1e-9);
    assert_near(m[13], 76.1, 1e-9);
    assert_near(m[14], 0, 1e-9);
    extent_ball(ball, &extent, &viewer.tools[FIRST_TOOL].pose);
    assert_near(ball[0], 24, 1e-9);
    assert_near(ball[1], 52.5, 1e-9);
    extent_turn(&viewer, FIRST_TOOL, &extent, (double[]){100, 300, 0}, back);
    assert_near(m[8], 1, 1e-9);
    assert_near(m[12], 69.5, 1e-9);
    assert_near(m[13], 20.5, 1e-9);
    viewer_finish(&viewer);
}

/* At x = -1, 70 mm before both blocks, a cone of 30 degrees hits both; its axis hits the first. */
static void one_ray_names_one_area(void **state)
{
    struct viewer viewer;
    struct window window = {.viewer = &viewer};
    const double from[3] = {-1, 90.5, 0};
    (void)state;
    open_atlases(&viewer, make_blocks(20), NULL);
    viewer.tools[FIRST_TOOL].angle = 30;
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    tool_aim_along(&viewer, FIRST_TOOL, from, back);
    assert_int_equal(conus_selection_count(viewer_selection(&viewer)), 3); /* two areas and `unassigned` */
    property_set(&window, PROPERTY_ONE_RAY, true);
    const conus_selection *selection = viewer_selection(&viewer);
    assert_int_equal(conus_selection_count(selection), 2);
    assert_int_equal(conus_selection_result(selection, 0)->object, 1);
    assert_near(conus_selection_result(selection, 0)->share, 1, 1e-12);
    assert_near(conus_selection_result(selection, 0)->distance, 70, 1e-6);
    assert_near(conus_selection_result(selection, 0)->contact[0], -1, 1e-6);
    viewer.cone.options.radius = 5; /* a single ray is no cylinder either */
    tool_reselect(&viewer);
    assert_int_equal(conus_selection_result(viewer_selection(&viewer), 0)->pixels, 1);
    viewer.cone.options.radius = 0;
    property_set(&window, PROPERTY_ONE_RAY, false);
    assert_int_equal(conus_selection_count(viewer_selection(&viewer)), 3);
    viewer_finish(&viewer);
}

/* The tip is in front of the block, the contact on its face at 20.5. Where nothing is hit the crosshair stays. */
static void the_cuts_follow_the_chosen_place(void **state)
{
    struct viewer viewer;
    struct window window = {.viewer = &viewer};
    const double *at = viewer.crosshair;
    (void)state;
    open_atlases(&viewer, make_blocks(20), NULL);
    viewer_cross(&viewer, (double[]){1, 2, 3});
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){-3, 35, 7}, back);
    assert_near(at[1], 2, 0);
    property_set(&window, PROPERTY_FOLLOW, FOLLOW_TIP);
    assert_near(at[0], -3, 1e-9);
    assert_near(at[1], 35, 1e-9);
    assert_near(at[2], 7, 1e-9);
    property_set(&window, PROPERTY_FOLLOW, FOLLOW_CONTACT);
    assert_near(at[1], 20.5, 1e-6);
    assert_near(at[2], 7, 0.5);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){10, 35, -5}, back);
    assert_near(at[2], -5, 0.5);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){10, 35, 9}, (double[]){0, 1, 0});
    assert_near(at[2], -5, 0.5);
    property_set(&window, PROPERTY_FOLLOW, FOLLOW_NOTHING);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){-3, 35, 7}, back);
    assert_near(at[2], -5, 0.5);
    viewer_finish(&viewer);
}

/* The notice for each state of each source. An answer is old if its tracker no longer sees the tool. */
static void notices_explain_a_missing_cone(void **state)
{
    static const struct {
        enum pointer pointer;
        bool has_pose, frozen, has_source;
        enum station_state state;
        const char *part; /* of the text; NULL = no text */
        bool is_trouble, is_old;
    } cases[] = {
        {POINT_BY_MOUSE, false, false, false, 0, "move the mouse", false, false},
        {POINT_BY_MOUSE, true, false, false, 0, NULL, false, false},
        {POINT_BY_MOUSE, true, true, false, 0, "held", false, false},
        {POINT_BY_WAND, false, false, false, 0, "press W", false, false},
        {POINT_BY_WAND, true, true, false, 0, NULL, false, false},
        {POINT_BY_REPLAY, false, false, false, 0, "--poses", true, false},
        {POINT_BY_REPLAY, false, false, true, 0, "choose a row", false, false},
        {POINT_BY_REPLAY, true, false, true, 0, NULL, false, false},
        {POINT_BY_TRACKER, false, false, false, 0, "no tracker: connect one", true, false},
        {POINT_BY_TRACKER, true, false, false, 0, "there is no tracker", true, true},
        {POINT_BY_TRACKER, false, false, true, STATION_WAITING, "no tracker", true, false},
        {POINT_BY_TRACKER, false, false, true, STATION_LOST, "does not see", true, false},
        {POINT_BY_TRACKER, true, false, true, STATION_WAITING, "no tracker is connected", true, true},
        {POINT_BY_TRACKER, true, false, true, STATION_SILENT, "no pose of the tool", true, true},
        {POINT_BY_TRACKER, true, false, true, STATION_LOST, "the tool is lost", true, true},
        {POINT_BY_TRACKER, true, false, true, STATION_STALE, "the tool is silent", true, true},
        {POINT_BY_TRACKER, false, false, true, STATION_SEEN, "tracking", false, false},
        {POINT_BY_TRACKER, true, false, true, STATION_SEEN, NULL, false, false},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct viewer viewer = {
            .tools = {{.pointer = cases[i].pointer, .has_pose = cases[i].has_pose, .held = cases[i].frozen}}};
        struct inputs inputs = {.update.state = cases[i].state};
        inputs.station = cases[i].has_source ? (struct station *)&inputs : NULL; /* only whether it is there counts */
        inputs.replay.poses = cases[i].has_source ? (conus_pose_list *)&inputs : NULL;
        struct notice notice;
        inputs_notice(&notice, &inputs, &viewer, FIRST_TOOL);
        if (!cases[i].part) {
            assert_null(notice.text);
        } else if (!notice.text || !strstr(notice.text, cases[i].part)) {
            fail_msg("case %zu: %s", i, notice.text ? notice.text : "nothing");
        }
        assert_int_equal(notice.is_trouble, cases[i].is_trouble);
        assert_int_equal(notice.is_old, cases[i].is_old);
    }
}

/* Poses that are dropped since the tool's newest one are the reason why there is none. */
static void dropped_poses_are_explained(void **state)
{
    const struct viewer viewer = {.tools = {{.pointer = POINT_BY_TRACKER, .has_pose = true}}};
    struct inputs inputs = {.update.state = STATION_STALE, .seen.refused = 2, .seen.mirrored = 1};
    struct notice notice;
    (void)state;
    inputs.station = (struct station *)&inputs; /* only whether it is there counts */
    inputs.update.counts = inputs.seen;
    inputs_notice(&notice, &inputs, &viewer, FIRST_TOOL);
    assert_string_equal(notice.text, "the tool is silent");
    inputs.update.counts.refused = 3;
    inputs_notice(&notice, &inputs, &viewer, FIRST_TOOL);
    assert_string_equal(notice.text, "poses are dropped: scaled, or no numbers");
    inputs.update.counts.mirrored = 2;
    inputs_notice(&notice, &inputs, &viewer, FIRST_TOOL);
    assert_string_equal(notice.text, "poses are dropped: they are mirrored");
    assert_true(notice.is_trouble && notice.is_old);
    inputs.update.state = STATION_SEEN;
    inputs_notice(&notice, &inputs, &viewer, FIRST_TOOL);
    assert_null(notice.text);
}

TEST_GROUP(pointing)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_a_context_the_atlas_is_the_surface),
        cmocka_unit_test(a_context_is_the_surface_where_its_skin_is),
        cmocka_unit_test(the_nearest_atlas_is_the_surface),
        cmocka_unit_test(the_mouse_puts_the_apex_there),
        cmocka_unit_test(the_cone_is_held_freed_and_cleared),
        cmocka_unit_test(a_cone_reaches_from_its_entry_to_its_deepest_hit),
        cmocka_unit_test(a_cone_through_all_reaches_its_deepest_exit),
        cmocka_unit_test(a_cone_turns_about_its_entry),
        cmocka_unit_test(one_ray_names_one_area),
        cmocka_unit_test(the_cuts_follow_the_chosen_place),
        cmocka_unit_test(notices_explain_a_missing_cone),
        cmocka_unit_test(dropped_poses_are_explained),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
