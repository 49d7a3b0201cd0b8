/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the viewer's model, without a window. */
#include "atlas/warp/warp.h"
#include "base/look.h"
#include "base/memory.h"
#include "viewer/model/additions.h"
#include "viewer/model/viewer.h"
#include "viewer/session/session.h"

#include "conus/own.h"
#include "session_words.h"
#include "test.h"

#include <limits.h>
#include <math.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static conus_atlas *phantom(const char *kind, const char *file)
{
    conus_atlas *atlas = NULL;
    char path[600];
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch("phantom"));
    assert_ok(conus_phantom_write(kind, folder, NULL));
    snprintf(path, sizeof path, "%s/%s", folder, file);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    return atlas;
}

/* Creates the viewer. From here on the painter's thread reads the atlas. */
static void view(struct viewer *out, conus_atlas *atlas)
{
    assert_ok(viewer_create(out, &(struct view_source){.atlas = atlas, .path = "phantom"}, 1, NULL, NULL, NULL));
}

static void load(struct viewer *out, const char *kind, const char *file)
{
    view(out, phantom(kind, file));
}

static const double eye[3] = {0, 90, 0};
static const double back[3] = {0, -1, 0};

/* Balls of 24, 16 and 8 mm: the mouse hits the outermost that is shown. */
static void the_mouse_hits_what_is_shown(void **state)
{
    struct viewer viewer;
    double contact[3] = {0};
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    for (int ball = 0; ball < 3; ball++) {
        uint32_t hit = 0;
        assert_true(viewer_pick(&hit, contact, &viewer, eye, back, INFINITY));
        assert_true(hit > 0);
        assert_near(contact[1], 24 - 8 * ball, 1);
        assert_near(contact[0], 0, 1e-9);
        assert_true(isnan(view_atlas_value(viewer.drawn, hit, contact)));
        viewer_hide(&viewer, hit, true);
    }
    uint32_t hit;
    assert_false(viewer_pick(&hit, contact, &viewer, eye, back, INFINITY));
    viewer_hide(&viewer, 3, false);
    assert_true(viewer_pick(&hit, contact, &viewer, eye, back, INFINITY));
    const double away = eye[1] - contact[1];
    assert_true(viewer_pick(&hit, contact, &viewer, eye, back, away + 0.01));
    assert_false(viewer_pick(&hit, contact, &viewer, eye, back, away - 0.01)); /* it is not farther than that */
    assert_int_equal(hit, 0);
    assert_false(viewer_pick(&hit, contact, &viewer, eye, (double[]){0, 1, 0}, INFINITY));
    assert_int_equal(hit, 0);
    viewer_finish(&viewer);
}

static uint32_t best_of(const struct viewer *viewer)
{
    return conus_selection_result(viewer_selection(viewer), 0)->object;
}

/* Nested balls, and a device outside: the cone hits the outermost that is shown, whichever are hidden, without being
 * aimed again. */
static void hidden_areas_are_not_selected(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    viewer.tools[FIRST_TOOL].angle = 2;
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_int_equal(best_of(&viewer), 1);
    viewer_hide(&viewer, 1, true);
    assert_int_equal(best_of(&viewer), 2);
    assert_near(conus_selection_result(viewer_selection(&viewer), 0)->distance, 90 - 16, 1);
    viewer_isolate(&viewer, 3);
    assert_int_equal(best_of(&viewer), 3);
    assert_int_equal(conus_selection_count(viewer_selection(&viewer)), 2); /* and what is unassigned */
    viewer_hide(&viewer, 3, true);
    assert_int_equal(best_of(&viewer), 0);
    viewer_hide(&viewer, 2, false);
    assert_int_equal(best_of(&viewer), 2);
    viewer_show_all(&viewer);
    assert_int_equal(best_of(&viewer), 1);
    viewer_finish(&viewer);
}

/* Objects that are hidden when the atlas is loaded, for instance by --hide, can be shown. */
static void areas_hidden_by_an_option_can_be_shown(void **state)
{
    struct viewer viewer;
    conus_atlas *atlas = NULL;
    const char *folder = test_scratch("comes");
    char path[4096];
    (void)state;
    assert_ok(conus_phantom_write("nested", folder, NULL));
    snprintf(path, sizeof path, "%s/nested.nii.gz", folder);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_ok(conus_atlas_show(atlas, NULL, "1"));
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = path}, 1, NULL, NULL, NULL));
    assert_int_equal(viewer_shown(&viewer, 1), SHOWN_NOT);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_int_equal(best_of(&viewer), 2);
    viewer_hide(&viewer, 1, false);
    assert_int_equal(best_of(&viewer), 1);
    viewer_finish(&viewer);
}

/* The brain's pathway is the last object; on its surface the value is about the threshold, inside it is larger. */
static void a_pathway_has_a_value(void **state)
{
    struct viewer viewer;
    double middle[3];
    (void)state;
    load(&viewer, "brain", "brain.atlas.json");
    uint32_t pathway = (uint32_t)viewer.drawn->object_count;
    assert_int_equal(conus_atlas_object(viewer.drawn->atlas, pathway)->kind, CONUS_KIND_PATHWAY);
    assert_ok(conus_atlas_centre(middle, viewer.drawn->atlas, pathway));
    viewer_isolate(&viewer, pathway);
    bool found = false;
    for (int k = -20; k <= 20 && !found; k++) {
        double contact[3];
        double from[3] = {middle[0], 200, middle[2] + 2 * k};
        uint32_t hit;
        viewer.display.fade = 1; /* no context */
        if (viewer_pick(&hit, contact, &viewer, from, back, INFINITY)) {
            found = true;
            assert_int_equal(hit, pathway);
            double threshold = 16383.75;
            assert_true(view_atlas_value(viewer.drawn, pathway, contact) >= threshold);
            assert_true(isnan(view_atlas_value(viewer.drawn, pathway, from)));
        }
    }
    assert_true(found);
    viewer_finish(&viewer);
}

static void a_node_is_shown_whole_in_part_or_not(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    assert_int_equal(viewer_shown(&viewer, 1), SHOWN);
    viewer_hide(&viewer, 1, true);
    assert_int_equal(viewer_shown(&viewer, 1), SHOWN_NOT);
    assert_int_equal(viewer_shown(&viewer, 2), SHOWN);
    viewer_isolate(&viewer, 1);
    assert_int_equal(viewer_shown(&viewer, 1), SHOWN);
    assert_int_equal(viewer_shown(&viewer, 2), SHOWN_NOT);
    viewer_finish(&viewer);
}

/* A spinal cord of 4 x 60 x 4 mm fills 92 % of each cut's width or height, whichever it fills first: y is upward in the
 * axial one, and to the right in the sagittal one. */
static void a_long_atlas_is_in_its_cuts(void **state)
{
    static unsigned char labels[60][4][4];
    static const double filled[PLANE_COUNT] = {60.0 / 400, 4.0 / 300, 60.0 / 300};
    struct viewer viewer;
    conus_atlas *atlas = NULL;
    conus_voxels voxels = CONUS_VOXELS_INIT;
    (void)state;
    memset(labels, 1, sizeof labels);
    voxels.data = labels;
    voxels.type = CONUS_SCALAR_UINT8;
    memcpy(voxels.dim, (size_t[]){4, 60, 4}, sizeof voxels.dim);
    memcpy(voxels.stride, (ptrdiff_t[]){4, 16, 1}, sizeof voxels.stride);
    for (size_t i = 0; i < 16; i += 5) {
        voxels.world_from_voxel[i] = 1;
    }
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL));
    assert_ok(viewer_create(&viewer, &(struct view_source){.atlas = atlas, .path = "cord"}, 1, NULL, NULL, NULL));
    for (int plane = 0; plane < 3; plane++) {
        conus_cut_view view;
        cut_view(&view, &viewer, (enum plane)plane, (double[]){300, 400});
        assert_near(view.mm_per_pixel, filled[plane] / 0.92, 1e-9);
        assert_near(view.centre[1], 29.5, 1e-9);
    }
    viewer_finish(&viewer);
}

/* The device is put in front of the face, looking back through the middle, wherever it was. */
static void a_device_is_put_in_front(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "sphere", "sphere.nii.gz");
    assert_false(viewer.tools[FIRST_TOOL].has_pose);
    tool_place(&viewer, FIRST_TOOL);
    assert_true(viewer.tools[FIRST_TOOL].has_pose);
    const double *m = viewer.tools[FIRST_TOOL].pose.world_from_device;
    assert_near(m[8], 0, 1e-12);
    assert_near(m[9], 1, 1e-12);
    assert_near(m[12], viewer.centre[0], 1e-12);
    assert_true(m[13] > viewer.centre[1] + viewer.radius);
    assert_int_equal(conus_selection_result(viewer_selection(&viewer), 0)->object, 1);
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){1, 2, 80}, (double[]){0, 0, -1});
    assert_near(m[14], 80, 1e-12);
    tool_place(&viewer, FIRST_TOOL);
    assert_near(m[14], viewer.centre[2], 1e-12);
    assert_near(m[9], 1, 1e-12);
    viewer_finish(&viewer);
}

static void assert_colour(const struct viewer *viewer, uint32_t object, const uint8_t wanted[3])
{
    uint8_t rgb[3];
    viewer_colour(rgb, viewer, object);
    assert_memory_equal(rgb, wanted, sizeof rgb);
}

/* Areas that are hit keep the colours of their ranks, which are for any colour vision, too. */
static void colours_go_and_come_back(void **state)
{
    static const uint8_t first[3] = {LOOK_RGB(LOOK_RANK_1)};
    struct viewer viewer;
    uint8_t own[3], safe[3];
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    unsigned scene = viewer.scene_number;
    viewer.display.own_colours = true;
    viewer_colour(own, &viewer, 1);
    viewer.display.own_colours = false;
    viewer_use_safe_colours(&viewer, true);
    viewer_use_safe_colours(&viewer, true);
    viewer_colour(safe, &viewer, 1);
    assert_memory_not_equal(own, safe, sizeof own);
    assert_true(viewer.scene_number > scene);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    const uint32_t hit = conus_selection_result(viewer_selection(&viewer), 0)->object;
    assert_colour(&viewer, hit, first);
    assert_colour(&viewer, 3 - hit, (const uint8_t[]){LOOK_RGB(LOOK_NOT_HIT)});
    assert_non_null(viewer_selection(&viewer));
    viewer_use_safe_colours(&viewer, false);
    assert_colour(&viewer, hit, first);
    tool_clear(&viewer);
    assert_colour(&viewer, 1, (const uint8_t[]){LOOK_RGB(LOOK_NOT_HIT)});
    viewer.display.own_colours = true;
    assert_colour(&viewer, 1, own);
    viewer_finish(&viewer);
}

/* From the left one area is hit, and the pathway is the last of those behind it: it was asked for, and has the second
 * colour in lists as in pictures. */
static void lists_have_the_colours_of_pictures(void **state)
{
    static const uint8_t ranks[][3] = {{LOOK_RGB(LOOK_RANK_1)}, {LOOK_RGB(LOOK_RANK_2)}, {LOOK_RGB(LOOK_RANK_3)}};
    struct viewer viewer;
    (void)state;
    load(&viewer, "brain", "brain.atlas.json");
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    viewer.tools[FIRST_TOOL].angle = 20;
    tool_aim_along(&viewer, FIRST_TOOL, (double[]){-90, 0, 0}, (double[]){1, 0, 0});
    const conus_selection *selection = viewer_selection(&viewer);
    const uint32_t pathway = (uint32_t)viewer.drawn->object_count;
    size_t last = conus_selection_count(selection) - 1;
    while (!conus_selection_result(selection, last)->object) {
        last--;
    }
    assert_int_equal(conus_selection_result(selection, last)->object, pathway);
    assert_colour(&viewer, conus_selection_result(selection, 0)->object, ranks[0]);
    assert_colour(&viewer, pathway, ranks[1]);
    assert_colour(&viewer, conus_selection_result(selection, 1)->object, ranks[2]);
    viewer_finish(&viewer);
}

/* What a cut shows of each kind of object without outlines, at full opacity: how many pixels have the object's own
 * colour, and how many are nearly grey. */
static void count_colours(size_t own[2], size_t grey[2], struct viewer *viewer)
{
    enum { SIDE = 120 };
    conus_cutter *cutter = NULL;
    conus_cut_view view;
    own[0] = own[1] = grey[0] = grey[1] = 0;
    viewer->display.fill = 1;
    viewer->display.no_outlines = true;
    cut_view(&view, viewer, AXIAL, (double[]){SIDE, SIDE});
    assert_ok(conus_cutter_create(&cutter, viewer->drawn->atlas));
    assert_ok(conus_cutter_draw(cutter, &view));
    for (size_t p = 0; p < (size_t)SIDE * SIDE; p++) {
        const uint8_t *rgb = conus_cutter_rgba(cutter) + 4 * p;
        const conus_object *object = conus_atlas_object(viewer->drawn->atlas, conus_cutter_shown(cutter)[p]);
        if (object) {
            const bool is_pathway = object->kind == CONUS_KIND_PATHWAY;
            own[is_pathway] += memcmp(rgb, object->rgb, 3) == 0;
            grey[is_pathway] += abs(rgb[0] - rgb[1]) < 12 && abs(rgb[1] - rgb[2]) < 12;
        }
    }
    conus_cutter_destroy(cutter);
}

/* Before there is a cone areas beside a pathway are grey in cuts and lists, and the pathway has its colour. As glass,
 * and where somebody chose the file's colours, areas have theirs. */
static void beside_fibres_areas_are_grey(void **state)
{
    struct viewer viewer;
    size_t own[2], grey[2];
    (void)state;
    load(&viewer, "brain", "brain.atlas.json");
    const uint32_t pathway = (uint32_t)viewer.drawn->object_count;
    assert_ok(conus_atlas_centre(viewer.crosshair, viewer.drawn->atlas, pathway));
    count_colours(own, grey, &viewer);
    assert_true(grey[0] > 1000 && !own[0]);
    assert_true(own[1] > 60 && grey[1] < own[1] / 4); /* a surface's line crosses it */
    assert_colour(&viewer, 1, (const uint8_t[]){LOOK_RGB(LOOK_NOT_HIT)});
    assert_colour(&viewer, pathway, conus_atlas_object(viewer.drawn->atlas, pathway)->rgb);
    viewer_set_opacity(&viewer, 0, 0.15);
    count_colours(own, grey, &viewer);
    assert_true(own[0] > 1000 && own[1] > 20);
    viewer_set_opacity(&viewer, 0, 1);
    viewer.display.own_colours = true;
    count_colours(own, grey, &viewer);
    assert_true(own[0] > 1000 && own[1] > 20);
    viewer_finish(&viewer);
}

/* A move after which the same areas are hit first is none that cuts show, another one is. */
static void moves_are_told_from_other_changes(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    unsigned shown = viewer_cut_version(&viewer);
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    assert_int_not_equal(viewer_cut_version(&viewer), shown); /* there is a hit */
    shown = viewer_cut_version(&viewer);
    unsigned version = viewer.version;
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){eye[0] + 0.1, eye[1], eye[2]}, back);
    assert_int_not_equal(viewer.version, version);
    assert_int_equal(viewer_cut_version(&viewer), shown);
    tool_aim_along(&viewer, FIRST_TOOL, (const double[]){eye[0], -eye[1], eye[2]},
                   (const double[]){-back[0], -back[1], -back[2]}); /* the other slab */
    assert_int_not_equal(viewer_cut_version(&viewer), shown);
    shown = viewer_cut_version(&viewer);
    viewer_hide(&viewer, 1, true);
    assert_int_not_equal(viewer_cut_version(&viewer), shown);
    viewer_finish(&viewer);
}

/* Of the slabs, y from 6 to 12 and from -12 to -6, both to x = 20, rays from (50, 50, 0) at an angle t to the y axis
 * meet the anterior one first from tan t = 30 / 44 on (34.3 degrees), below that, down to 30 / 62, the posterior one
 * alone. A cone of 10 degrees around 36.5 has some of these; around 41.5 it has the posterior one only behind the
 * other. The list has the same areas in the same order, but cuts show them otherwise. */
static void an_area_that_comes_to_lie_behind_is_a_change(void **state)
{
    static const double apex[3] = {50, 50, 0};
    struct viewer viewer;
    unsigned shown[2];
    uint32_t objects[2][2];
    uint32_t pixels[2];
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    viewer.tools[FIRST_TOOL].angle = 10;
    for (int k = 0; k < 2; k++) {
        const double turn = (k ? 41.5 : 36.5) * M_PI / 180;
        tool_aim_along(&viewer, FIRST_TOOL, apex, (const double[]){-sin(turn), -cos(turn), 0});
        shown[k] = viewer_cut_version(&viewer);
        for (size_t i = 0; i < 2; i++) {
            const conus_result *result = conus_selection_result(viewer_selection(&viewer), i);
            objects[k][i] = result->object;
            pixels[k] = result->pixels; /* of the posterior one, at last */
            assert_true(result->pierced > 0);
        }
    }
    assert_memory_equal(objects[0], objects[1], sizeof objects[0]);
    assert_int_equal(conus_atlas_object(viewer.drawn->atlas, objects[0][1])->label, 300);
    assert_true(pixels[0] > 0);
    assert_int_equal(pixels[1], 0);
    assert_int_not_equal(shown[0], shown[1]);
    viewer_finish(&viewer);
}

/* As in pictures: the area that is hit first has the first rank's colour, the other one is grey, and behind that one
 * it has the second. Without a cone both are grey, and where that was chosen they have the atlas's. */
static void areas_have_the_colours_of_their_ranks(void **state)
{
    static const uint8_t first[3] = {LOOK_RGB(LOOK_RANK_1)}, second[3] = {LOOK_RGB(LOOK_RANK_2)};
    static const uint8_t not_hit[3] = {LOOK_RGB(LOOK_NOT_HIT)};
    struct viewer viewer;
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    const conus_atlas *atlas = viewer.drawn->atlas;
    assert_colour(&viewer, 1, not_hit);
    viewer.display.own_colours = true;
    assert_colour(&viewer, 1, conus_atlas_object(atlas, 1)->rgb);
    viewer.display.own_colours = false;
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    const uint32_t hit = conus_selection_result(viewer_selection(&viewer), 0)->object;
    const uint32_t other = 3 - hit;
    assert_colour(&viewer, hit, first);
    assert_colour(&viewer, other, not_hit);
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    tool_reselect(&viewer);
    assert_colour(&viewer, hit, first);
    assert_colour(&viewer, other, second);
    viewer.display.own_colours = true;
    assert_colour(&viewer, hit, conus_atlas_object(atlas, hit)->rgb);
    assert_colour(&viewer, other, conus_atlas_object(atlas, other)->rgb);
    viewer_finish(&viewer);
}

/* A context that is opaque from 1 on hides everything in it; thinned, it hides less and less. */
static void an_opaque_context_is_hit_before_what_it_hides(void **state)
{
    static const conus_transfer_point opaque[] = {
        {0, {0, 0, 0, 0}}, {1, {0, 0, 0, 0}}, {1, {1, 1, 1, 0.9}}, {65535, {1, 1, 1, 0.9}}};
    struct viewer viewer;
    double bare[3];
    double hidden[3];
    uint32_t object;
    (void)state;
    load(&viewer, "brain", "brain.atlas.json");
    const double from[3] = {viewer.centre[0] + 3, viewer.centre[1] + 200, viewer.centre[2] + 3};
    viewer.display.fade = 1;
    assert_true(viewer_pick(&object, bare, &viewer, from, back, INFINITY));
    assert_true(object > 0);
    viewer.display.fade = 0;
    assert_true(painter_set_transfer(viewer.painter, opaque, 4));
    assert_true(viewer_pick(&object, hidden, &viewer, from, back, INFINITY));
    assert_int_equal(object, 0);
    assert_true(hidden[1] > bare[1]);
    const double surface = from[1] - hidden[1];
    assert_false(viewer_pick(&object, hidden, &viewer, from, back, surface));
    assert_true(viewer_pick(&object, hidden, &viewer, from, back, surface + 0.01));
    assert_int_equal(object, 0);
    viewer_finish(&viewer);
}

/* How much of the context the next picture leaves out. */
static double fade_drawn(struct viewer *viewer)
{
    struct painting what = {.eye.frustum = {-1, 1, -1, 1},
                            .width = 4,
                            .height = 4,
                            .leaves_context = viewer_leaves_context(viewer),
                            .scene_number = viewer->scene_number};
    struct painted picture = {0};
    char error[PAINTER_TEXT];
    assert_ok(conus_pose_along(&what.eye.camera, eye, back, NULL));
    painter_ask(viewer->painter, &what);
    do {
        free(picture.rgba);
        picture = (struct painted){0};
        assert_false(painter_text(error, viewer->painter, PAINTER_ERROR));
        sched_yield();
        painter_take(viewer->painter, &picture);
    } while (!picture.rgba || picture.what.scene_number != what.scene_number ||
             picture.what.leaves_context != what.leaves_context);
    free(picture.rgba);
    return viewer_fade(viewer);
}

/* An image that lies in areas through which nothing is seen is not drawn around them; it is where areas are glass or
 * hidden, and where areas are a part of it only. The thread that draws finds that out. */
static void an_image_is_left_out_around_opaque_areas(void **state)
{
    (void)state;
    for (int is_part = 0; is_part < 2; is_part++) {
        struct viewer viewer;
        char path[600];
        conus_atlas *atlas = phantom("slabs", "slabs.nii.gz");
        assert_ok(conus_phantom_write("brain", test_scratch("phantom"), NULL));
        snprintf(path, sizeof path, "%s/%s", test_scratch("phantom"),
                 is_part ? "brain-context.nii.gz" : "slabs.nii.gz");
        assert_ok(conus_atlas_set_context(atlas, path, NULL));
        view(&viewer, atlas);
        assert_near(fade_drawn(&viewer), !is_part, 0);
        viewer_set_opacity(&viewer, 0, 0.5);
        assert_near(fade_drawn(&viewer), 0, 0);
        viewer_set_opacity(&viewer, 0, 1);
        viewer_set_opacity(&viewer, 1, 0.5);
        assert_near(fade_drawn(&viewer), 0, 0);
        viewer_set_opacity(&viewer, 1, NAN);
        assert_near(fade_drawn(&viewer), !is_part, 0);
        viewer_hide(&viewer, 1, true); /* whose place the next area is near enough to */
        assert_near(fade_drawn(&viewer), !is_part, 0);
        for (uint32_t number = 2; number <= viewer.drawn->object_count; number++) {
            viewer_hide(&viewer, number, true);
        }
        assert_near(fade_drawn(&viewer), 0, 0);
        viewer_show_all(&viewer);
        assert_near(fade_drawn(&viewer), !is_part, 0);
        viewer_finish(&viewer);
    }
}

static void a_place_has_a_voxel_and_the_crosshair_stays_near(void **state)
{
    struct viewer viewer;
    long voxel[3];
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    const conus_volume_info *info = conus_atlas_volume(viewer.drawn->atlas, 0);
    for (long k = 0; k < (long)info->dim[2]; k += 7) {
        double at[3];
        const long wanted[3] = {3, 5 + k / 2, k};
        for (int a = 0; a < 3; a++) {
            const double *m = info->world_from_voxel + a;
            at[a] = m[0] * 3.2 + m[4] * ((double)wanted[1] - 0.3) + m[8] * (double)k + m[12];
        }
        assert_true(viewer_voxel(voxel, &viewer, at));
        assert_memory_equal(voxel, wanted, sizeof wanted);
    }
    assert_false(viewer_voxel(voxel, &viewer, (double[]){1e4, 0, 0}));
    viewer_cross(&viewer, (double[]){1, 1e9, -2});
    assert_near(viewer.crosshair[0], 1, 0);
    assert_near(viewer.crosshair[1], viewer.centre[1] + 1.5 * viewer.radius, 1e-9);
    assert_near(viewer.crosshair[2], -2, 0);
    viewer_finish(&viewer);
}

static void written_results_are_the_copied_table(void **state)
{
    struct viewer viewer;
    char path[600];
    char text[4096] = "";
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    tool_aim_along(&viewer, FIRST_TOOL, eye, back);
    snprintf(path, sizeof path, "%s", test_scratch("results.tsv"));
    assert_ok(viewer_write_results(&viewer, FIRST_TOOL, path));
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    char *table = viewer_results_text(&viewer);
    assert_true(size > 0);
    assert_string_equal(table, text);
    free(table);
    viewer_finish(&viewer);
}

/* A file that was deleted, and one that was replaced, is reported once each. */
static void files_are_watched(void **state)
{
    struct viewer viewer;
    char path[600];
    char update[FILE_WATCH_TEXT];
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    snprintf(path, sizeof path, "%s", conus_atlas_volume(viewer.drawn->atlas, 0)->path);
    assert_false(file_watch_check(viewer.drawn->watch, update));
    assert_int_equal(unlink(path), 0);
    assert_true(file_watch_check(viewer.drawn->watch, update));
    assert_non_null(strstr(update, "slabs.nii.gz is gone from disk"));
    assert_false(file_watch_check(viewer.drawn->watch, update));
    assert_ok(conus_write_file(path, "other", 5));
    assert_true(file_watch_check(viewer.drawn->watch, update));
    assert_non_null(strstr(update, "slabs.nii.gz changed on disk"));
    assert_false(file_watch_check(viewer.drawn->watch, update));
    viewer_finish(&viewer);
}

/* The phantom's pathway twice, with a context. */
static void load_two_pathways(struct viewer *out)
{
    const conus_pathway_options second = {.name = "Second", .threshold = 100};
    conus_atlas *atlas = NULL;
    char folder[512];
    char path[600];
    snprintf(folder, sizeof folder, "%s", test_scratch("phantom"));
    assert_ok(conus_phantom_write("brain", folder, NULL));
    snprintf(path, sizeof path, "%s/brain.atlas.json", folder);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    snprintf(path, sizeof path, "%s/brain-pathway.nii.gz", folder);
    assert_ok(conus_atlas_add_pathway(atlas, path, &second));
    assert_ok(viewer_create(out, &(struct view_source){.atlas = atlas, .path = "phantom"}, 1, NULL, NULL, NULL));
}

/* A threshold that is no number cannot be set; the settings before it are restored. */
static void settings_of_the_atlas_are_all_set_or_none(void **state)
{
    struct viewer viewer;
    double thresholds[16] = {0};
    struct atlas_edits edits = {
        .thresholds = (double *[]){thresholds}, .safe_colours = true, .sets_transfer = true, .point_count = 1};
    (void)state;
    load_two_pathways(&viewer);
    const uint32_t last = (uint32_t)viewer.drawn->object_count;
    const double before = view_atlas_pathway(viewer.drawn, last - 1)->threshold;
    const uint64_t voxels = conus_atlas_object(viewer.drawn->atlas, last - 1)->voxels;
    assert_null(view_atlas_pathway(viewer.drawn, last - 2));
    assert_null(view_atlas_pathway(viewer.drawn, last + 1));
    thresholds[last - 1] = 2 * before;
    thresholds[last] = NAN;
    assert_int_equal(viewer_set_up(&viewer, &edits), CONUS_ERROR_ARGUMENT);
    assert_true(view_atlas_pathway(viewer.drawn, last - 1)->threshold == before);
    assert_int_equal(conus_atlas_object(viewer.drawn->atlas, last - 1)->voxels, voxels);
    assert_true(view_atlas_pathway(viewer.drawn, last)->threshold == 100);
    assert_false(viewer.display.safe_colours);
    assert_false(viewer.transfer_editor.edited);
    thresholds[last] = 200;
    assert_ok(viewer_set_up(&viewer, &edits));
    assert_true(view_atlas_pathway(viewer.drawn, last - 1)->threshold == 2 * before);
    assert_true(conus_atlas_object(viewer.drawn->atlas, last - 1)->voxels < voxels);
    assert_true(view_atlas_pathway(viewer.drawn, last)->threshold == 200);
    assert_true(viewer.display.safe_colours && viewer.transfer_editor.edited);
    viewer_finish(&viewer);
}

/* A change of the atlas starts another painter, which draws with the same transfer function. */
static void edited_points_outlive_other_changes(void **state)
{
    struct viewer viewer;
    conus_transfer_point used[EDITOR_POINTS];
    struct atlas_edits edits = {
        .sets_transfer = true, .point_count = 2, .points = {{10, {0.5, 0.25, 0, 0.01}}, {20, {1, 1, 1, 0.2}}}};
    (void)state;
    load_two_pathways(&viewer);
    assert_ok(viewer_set_up(&viewer, &edits));
    viewer_set_threshold(&viewer, (uint32_t)viewer.drawn->object_count, 300);
    viewer_use_safe_colours(&viewer, true);
    assert_int_equal(painter_transfer(viewer.painter, used, EDITOR_POINTS), 2);
    for (size_t i = 0; i < 2; i++) {
        assert_true(used[i].value == edits.points[i].value);
        assert_true(used[i].rgba[3] == edits.points[i].rgba[3]);
    }
    edits.safe_colours = true;
    edits.point_count = 0;
    assert_ok(viewer_set_up(&viewer, &edits));
    assert_false(viewer.transfer_editor.edited);
    viewer_finish(&viewer);
}

/* Places have a tenth of a mm in spaces of human brains, whole micrometres in the CCF, a thousandth of a mm from
 * bregma; a value that rounds to 0 has no sign. The frames' matrices are the identity, so that the numbers are those
 * given; LPS negates the first two. */
static void places_are_written_in_their_space(void **state)
{
    static const struct {
        conus_space space;
        double world[3];
        const char *text;
    } cases[] = {{CONUS_SPACE_RAS, {1.26, -0.04, -12.34}, "1.3, 0.0, -12.3 mm RAS"},
                 {CONUS_SPACE_LPS, {1.26, 0.04, -0.06}, "-1.3, 0.0, -0.1 mm LPS"},
                 {CONUS_SPACE_CCF, {1234.6, -0.4, -0.6}, "AP 1235, DV 0, ML -1 um"},
                 {CONUS_SPACE_BREGMA, {1.2346, -0.0004, -0.0006}, "AP 1.235, ML 0.000, DV -0.001 mm"}};
    struct viewer viewer;
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[VIEWER_PLACE_TEXT];
        viewer.frame = (conus_frame){cases[i].space, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, {0}};
        assert_string_equal(viewer_place_text(text, &viewer, cases[i].world), cases[i].text);
    }
    viewer_finish(&viewer);
}

/* A single ray has first hits only and no radius. The level applies to the first atlas. */
static void a_question_follows_from_the_cone(void **state)
{
    struct viewer viewer;
    conus_selector_options options;
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    viewer.cone.options.layers = CONUS_LAYERS_ALL;
    viewer.cone.options.radius = 2;
    viewer.cone.options.resolution = 32;
    viewer.tools[FIRST_TOOL].angle = 30;
    snprintf(viewer.cone.level, sizeof viewer.cone.level, "2");
    assert_near(viewer_query(&options, &viewer, FIRST_TOOL, 0), 0, 0);
    assert_int_equal(options.layers, CONUS_LAYERS_ALL);
    assert_string_equal(options.level, "2");
    assert_near(viewer_query(&options, &viewer, FIRST_TOOL, 1), 0, 0);
    assert_null(options.level);
    viewer.cone.one_ray = true;
    assert_near(viewer_query(&options, &viewer, FIRST_TOOL, 0), 0.1, 0);
    assert_int_equal(options.layers, CONUS_LAYERS_VISIBLE);
    assert_int_equal(options.resolution, 1);
    assert_near(options.radius, 0, 0);
    viewer_finish(&viewer);
}

/* One pin too many drops the oldest; all others stay in their order. */
static void the_oldest_pin_makes_room(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    for (int i = 0; i <= PIN_LIMIT; i++) {
        viewer_pin(&viewer, (struct pin){.object = 1, .share = 0.5, .distance = i});
    }
    assert_int_equal(viewer.pin_count, PIN_LIMIT);
    for (int i = 0; i < PIN_LIMIT; i++) {
        assert_near(viewer.pins[i].distance, i + 1, 0);
    }
    viewer_finish(&viewer);
}

/* Contacts at (0, 0, 0), (3, 4, 0) and (3, 4, 12): each is as far from the one before as 3-4-5 and 12 say. */
static void a_pin_says_how_far_the_one_before_is(void **state)
{
    struct viewer viewer;
    static const double contacts[3][3] = {{0, 0, 0}, {3, 4, 0}, {3, 4, 12}};
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    for (int i = 0; i < 3; i++) {
        const double *at = contacts[i];
        viewer_pin(&viewer, (struct pin){.object = 1, .share = 0.5, .distance = 10, .contact = {at[0], at[1], at[2]}});
    }
    char *text = viewer_pins_text(&viewer);
    assert_non_null(text);
    const char *line = text;
    static const char *const endings[] = {"\tapart_mm\tentry_x\tentry_y\tentry_z", "\tn/a\tn/a\tn/a\tn/a",
                                          "\t5\tn/a\tn/a\tn/a", "\t12\tn/a\tn/a\tn/a"};
    for (int i = 0; i < 4; i++) {
        const char *end = strchr(line, '\n');
        assert_non_null(end);
        assert_memory_equal(end - strlen(endings[i]), endings[i], strlen(endings[i]));
        line = end + 1;
    }
    assert_string_equal(line, "");
    free(text);
    viewer_finish(&viewer);
}

/* A session of an atlas that has been moved since, here by 7 mm, is refused: its cone and pins would be at other
 * places. */
static void a_session_fits_an_unmoved_atlas_only(void **state)
{
    struct viewer viewer;
    struct window window = {.screen.enlarged = -1, .viewer = &viewer};
    const double right[16] = {[0] = 1, [5] = 1, [10] = 1, [12] = 7, [15] = 1};
    char why[PROPERTY_REASON];
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    char *before = session_text(&window);
    assert_true(session_parse(&window, before, strlen(before), why));
    viewer_finish(&viewer);
    conus_atlas *atlas = phantom("nested", "nested.nii.gz");
    assert_ok(conus_atlas_move(atlas, right));
    view(&viewer, atlas);
    assert_false(session_parse(&window, before, strlen(before), why));
    assert_non_null(strstr(why, "--atlas-transform"));
    char *moved = session_text(&window);
    assert_true(session_parse(&window, moved, strlen(moved), why));
    free(before);
    free(moved);
    viewer_finish(&viewer);
}

/* The nested balls moved by a field that has positions for points with x from 10 to 70 mm, `shift` to the right; it has
 * none at the origin. */
static conus_atlas *warped_phantom(double shift)
{
    const conus_volume_info grid = {
        .dim = {15, 15, 15},
        .spacing = {4, 4, 4},
        .transform = "by hand",
        .world_from_voxel = {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0, 12, -28, -28, 1},
    };
    struct deformation field = {.dim = {2, 2, 2}, .vectors = memory_zeroed(24, sizeof(float))};
    struct warp_plan plan = {.words = "a field", .grid = &grid};
    const double place[16] = {60, 0, 0, 0, 0, 60, 0, 0, 0, 0, 60, 0, 40, -30, -30, 1};
    const double from[16] = {1.0 / 60, 0, 0, 0, 0, 1.0 / 60, 0, 0, 0, 0, 1.0 / 60, 0, -40.0 / 60, 0.5, 0.5, 1};
    for (int i = 0; i < 16; i++) {
        field.world_from_voxel[i] = field.base[i] = place[i];
        field.voxel_from_world[i] = from[i];
        field.linear[i] = i % 5 == 0;
    }
    for (size_t node = 0; node < 8; node++) {
        field.vectors[3 * node] = (float)shift;
    }
    assert_ok(deformation_measure(&field));
    conus_atlas *atlas = phantom("nested", "nested.nii.gz");
    assert_ok(atlas_warp(atlas, &field, 1, &plan));
    return atlas;
}

/* The same for an atlas that a field has moved. The field has no positions for some of the points that are compared. */
static void a_session_fits_the_same_field_only(void **state)
{
    struct viewer viewer;
    struct window window = {.screen.enlarged = -1, .viewer = &viewer};
    char why[PROPERTY_REASON];
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    char *plain = session_text(&window);
    viewer_finish(&viewer);
    view(&viewer, warped_phantom(-40));
    char *warped = session_text(&window);
    assert_true(session_parse(&window, warped, strlen(warped), why));
    assert_false(session_parse(&window, plain, strlen(plain), why));
    viewer_finish(&viewer);
    view(&viewer, warped_phantom(-41));
    assert_false(session_parse(&window, warped, strlen(warped), why));
    assert_non_null(strstr(why, "--atlas-transform"));
    free(plain);
    free(warped);
    viewer_finish(&viewer);
}

TEST_GROUP(viewer)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mouse_hits_what_is_shown),
        cmocka_unit_test(hidden_areas_are_not_selected),
        cmocka_unit_test(areas_hidden_by_an_option_can_be_shown),
        cmocka_unit_test(a_pathway_has_a_value),
        cmocka_unit_test(areas_have_the_colours_of_their_ranks),
        cmocka_unit_test(an_image_is_left_out_around_opaque_areas),
        cmocka_unit_test(an_opaque_context_is_hit_before_what_it_hides),
        cmocka_unit_test(a_place_has_a_voxel_and_the_crosshair_stays_near),
        cmocka_unit_test(written_results_are_the_copied_table),
        cmocka_unit_test(files_are_watched),
        cmocka_unit_test(a_node_is_shown_whole_in_part_or_not),
        cmocka_unit_test(colours_go_and_come_back),
        cmocka_unit_test(lists_have_the_colours_of_pictures),
        cmocka_unit_test(beside_fibres_areas_are_grey),
        cmocka_unit_test(moves_are_told_from_other_changes),
        cmocka_unit_test(an_area_that_comes_to_lie_behind_is_a_change),
        cmocka_unit_test(settings_of_the_atlas_are_all_set_or_none),
        cmocka_unit_test(edited_points_outlive_other_changes),
        cmocka_unit_test(a_device_is_put_in_front),
        cmocka_unit_test(a_long_atlas_is_in_its_cuts),
        cmocka_unit_test(places_are_written_in_their_space),
        cmocka_unit_test(a_question_follows_from_the_cone),
        cmocka_unit_test(the_oldest_pin_makes_room),
        cmocka_unit_test(a_pin_says_how_far_the_one_before_is),
        cmocka_unit_test(a_session_fits_an_unmoved_atlas_only),
        cmocka_unit_test(a_session_fits_the_same_field_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
