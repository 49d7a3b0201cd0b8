/* SPDX-License-Identifier: BSD-3-Clause */
/* What the window does, without a window. */
#include "atlas/warp/warp.h"
#include "base/memory.h"
#include "viewer/model/picker.h"
#include "viewer/session/session.h"
#include "viewer/window/place.h"
#include "viewer/window/start.h"

#include "test.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void load(struct viewer *out, const char *kind, const char *file)
{
    conus_atlas *atlas = NULL;
    char path[600];
    char folder[512];
    snprintf(folder, sizeof folder, "%s", test_scratch("phantom"));
    assert_ok(conus_phantom_write(kind, folder, NULL));
    snprintf(path, sizeof path, "%s/%s", folder, file);
    assert_ok(conus_atlas_load(&atlas, path, NULL));
    assert_ok(viewer_create(out, &(struct view_source){.atlas = atlas, .path = "phantom"}, 1, NULL, NULL, NULL));
}

static const double eye[3] = {0, 90, 0};
static const double back[3] = {0, -1, 0};

/* Balls of 24, 16 and 8 mm: what is hidden is not under the mouse, what is behind it is. */
static void the_mouse_hits_what_is_shown(void **state)
{
    struct viewer viewer;
    double contact[3] = {0};
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    for (int ball = 0; ball < 3; ball++) {
        uint32_t hit = 0;
        assert_true(viewer_pick(&hit, contact, &viewer, eye, back));
        assert_true(hit > 0);
        assert_near(contact[1], 24 - 8 * ball, 1);
        assert_near(contact[0], 0, 1e-9);
        assert_true(isnan(view_atlas_value(viewer.drawn, hit, contact)));
        viewer_hide(&viewer, hit, true);
    }
    uint32_t hit;
    assert_false(viewer_pick(&hit, contact, &viewer, eye, back));
    viewer_hide(&viewer, 3, false);
    assert_true(viewer_pick(&hit, contact, &viewer, eye, back));
    assert_false(viewer_pick(&hit, contact, &viewer, eye, (double[]){0, 1, 0}));
    assert_int_equal(hit, 0);
    viewer_finish(&viewer);
}

static uint32_t best_of(const struct viewer *viewer)
{
    return conus_selection_result(viewer_selection(viewer), 0)->object;
}

/* Balls one in the other, aimed at from outside: the cone hits the outermost that is shown, whatever is hidden when,
 * without being aimed anew. */
static void what_is_hidden_is_not_selected(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    viewer.cone.angle = 2;
    viewer_aim_along(&viewer, eye, back);
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

/* What was hidden when the atlas came, by --hide, say, can be shown. */
static void what_comes_hidden_can_be_shown(void **state)
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
    viewer_aim_along(&viewer, eye, back);
    assert_int_equal(best_of(&viewer), 2);
    viewer_hide(&viewer, 1, false);
    assert_int_equal(best_of(&viewer), 1);
    viewer_finish(&viewer);
}

/* The brain's pathway is the last object; on its surface the value is about the threshold, within it more. */
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
        if (viewer_pick(&hit, contact, &viewer, from, back)) {
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

/* In front of the face, looking back through the middle; a pose that is there stays. */
static void a_device_without_a_pose_is_put_in_front(void **state)
{
    struct viewer viewer;
    (void)state;
    load(&viewer, "sphere", "sphere.nii.gz");
    assert_false(viewer.cone.has_pose);
    viewer_place(&viewer);
    assert_true(viewer.cone.has_pose);
    const double *m = viewer.cone.pose.world_from_device;
    assert_near(m[8], 0, 1e-12);
    assert_near(m[9], 1, 1e-12);
    assert_near(m[12], viewer.centre[0], 1e-12);
    assert_true(m[13] > viewer.centre[1] + viewer.radius);
    assert_int_equal(conus_selection_result(viewer_selection(&viewer), 0)->object, 1);
    viewer_aim_along(&viewer, (double[]){1, 2, 80}, (double[]){0, 0, -1});
    viewer_place(&viewer);
    assert_near(m[14], 80, 1e-12);
    viewer_finish(&viewer);
}

static void colours_go_and_come_back(void **state)
{
    struct viewer viewer;
    uint8_t own[3], safe[3], again[3];
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    unsigned scene = viewer.scene_number;
    viewer_aim_along(&viewer, eye, back);
    viewer_colour(own, &viewer, 1);
    viewer_use_safe_colours(&viewer, true);
    viewer_use_safe_colours(&viewer, true);
    viewer_colour(safe, &viewer, 1);
    assert_memory_not_equal(own, safe, sizeof own);
    assert_true(viewer.scene_number > scene);
    assert_non_null(viewer_selection(&viewer));
    viewer_use_safe_colours(&viewer, false);
    viewer_colour(again, &viewer, 1);
    assert_memory_equal(own, again, sizeof own);
    viewer_finish(&viewer);
}

/* Of a file that the window keeps, in a folder of this run. */
static void find_state(char path[PATH_MAX], const char *name)
{
    char here[512];
    assert_non_null(getcwd(here, sizeof here)); /* relative ones do not count */
    snprintf(path, PATH_MAX, "%s/%s", here, test_scratch("state"));
    setenv("XDG_STATE_HOME", path, 1);
    snprintf(path, PATH_MAX, "%s/%s/conus/%s", here, test_scratch("state"), name);
}

static void assert_same_place(const struct place *a, const struct place *b)
{
    const int found[] = {a->width, a->height, a->x, a->y, a->known};
    const int wanted[] = {b->width, b->height, b->x, b->y, b->known};
    assert_memory_equal(found, wanted, sizeof found);
    assert_near(a->zoom, b->zoom, 1e-12);
}

static void the_window_finds_its_place_again(void **state)
{
    const struct place left = {.width = 900, .height = 700, .known = true, .x = 11, .y = -22, .zoom = 1.25};
    struct place found = {.width = 1, .height = 2};
    char path[PATH_MAX];
    (void)state;
    find_state(path, "window.json");
    place_load(&found);
    assert_int_equal(found.width, 1);
    place_save(&left);
    place_load(&found);
    assert_same_place(&found, &left);
    place_save(&(struct place){.width = 1, .height = 700}); /* one that nobody could use */
    place_load(&found);
    assert_int_equal(found.width, 900);
    static const char *const bad[] = {"",
                                      "{}",
                                      "[1]",
                                      "{\"width\": 900, \"height\": 1e9, \"x\": 0, \"y\": 0}",
                                      "{\"width\": 99999, \"height\": 700, \"x\": 0, \"y\": 0}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"zoom\": 9}",
                                      "{\"width\": 900, \"height\": 700, \"x\": 0, \"y\": 0, \"zoom\": \"1\"}",
                                      "{\"width\": \"900\", \"height\": 700, \"x\": 0, \"y\": 0}"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        found = (struct place){.width = 5};
        assert_ok(conus_write_file(path, bad[i], strlen(bad[i])));
        place_load(&found);
        assert_int_equal(found.width, 5);
        assert_false(found.known);
    }
}

static void a_window_fits_its_screen(void **state)
{
    static const int area[4] = {100, 30, 1280, 770};
    static const struct {
        struct place before, after;
    } cases[] = {
        {{.width = 900, .height = 700, .x = 150, .y = 40}, {.width = 900, .height = 700, .x = 150, .y = 40}},
        {{.width = 1500, .height = 940, .x = 0, .y = 0}, {.width = 1280, .height = 770, .x = 100, .y = 30}},
        {{.width = 900, .height = 700, .x = 9000, .y = 50}, {.width = 900, .height = 700, .x = 480, .y = 50}},
        {{.width = 900, .height = 700, .x = -900, .y = 900}, {.width = 900, .height = 700, .x = 100, .y = 100}},
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct place place = cases[i].before;
        place_fit(&place, area);
        assert_same_place(&place, &cases[i].after);
    }
}

/* Inches are 25.4 mm: 1920 pixels on 344 mm are 141.8 to the inch, 1.477 times 96; 3840 on 294 mm 331.8, 3.46 times;
 * 2560 on 597 mm 108.9, 1.13 times. */
static void texts_are_as_large_as_the_screen_is_dense(void **state)
{
    (void)state;
    assert_near(place_scale(1, 1920, 344), 1.25, 0);
    assert_near(place_scale(1, 3840, 294), 3, 0);
    assert_near(place_scale(1, 2560, 597), 1, 0);
    assert_near(place_scale(1, 1280, 1280), 1, 0); /* a wall */
    assert_near(place_scale(1, 1920, 0), 1, 0);    /* it does not say */
    assert_near(place_scale(1, 1920, 16), 1, 0);   /* 16 x 9 cm in cm, as some say */
    assert_near(place_scale(2, 1920, 600), 2, 0);  /* the desktop knows */
}

static const char three[] = "{\"conus_recent\": 1, \"atlases\": [\"/a\", \"/b/\\u001b.nii\", \"/c,volume=2\"]}";

/* Nothing but what was written: no piece of it, no other form, no path that is relative or too long. */
static void only_a_whole_list_is_read(void **state)
{
    static const char *const bad[] = {
        "[]",
        "{}",
        "{\"conus_recent\": 1}",
        "{\"conus_recent\": 2, \"atlases\": []}",
        "{\"conus_recent\": 1, \"atlases\": {}}",
        "{\"conus_recent\": 1, \"atlases\": [], \"more\": 1}",
        "{\"conus_recent\": 1, \"atlases\": [], \"atlases\": []}",
        "{\"conus_recent\": 1, \"atlases\": [\"a\"]}",
        "{\"conus_recent\": 1, \"atlases\": [\"/a\", \"\"]}",
        "{\"conus_recent\": 1, \"atlases\": [\"/a\", 5]}",
        "{\"conus_recent\": 1, \"atlases\": [\"/a\\u0000b\"]}",
        "{\"conus_recent\":1,\"atlases\":[\"/\",\"/\",\"/\",\"/\",\"/\",\"/\",\"/\",\"/\",\"/\"]}"};
    struct recent recent = {.count = 5};
    (void)state;
    for (size_t size = 0; size < strlen(three); size++) {
        assert_false(recent_parse(&recent, three, size));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_false(recent_parse(&recent, bad[i], strlen(bad[i])));
    }
    assert_int_equal(recent.count, 5);
    assert_true(recent_parse(&recent, three, strlen(three)));
    assert_int_equal(recent.count, 3);
    assert_string_equal(recent.paths[1], "/b/\x1b.nii");
    assert_string_equal(recent.paths[2], "/c,volume=2");
    for (int length = PATH_MAX - 1; length <= PATH_MAX; length++) { /* the longest, and one more */
        char text[PATH_MAX + 64];
        int size = snprintf(text, sizeof text, "{\"conus_recent\": 1, \"atlases\": [\"/%0*d\"]}", length - 1, 0);
        assert_int_equal(recent_parse(&recent, text, (size_t)size), length < PATH_MAX);
    }
}

static void what_is_opened_comes_first(void **state)
{
    struct recent recent;
    char path[PATH_MAX];
    char here[PATH_MAX];
    (void)state;
    find_state(path, "recent.json");
    recent_load(&recent);
    assert_int_equal(recent.count, 0);
    recent_add("/\xff"); /* no UTF-8 */
    recent_add("/folder//");
    recent_load(&recent);
    assert_int_equal(recent.count, 1);
    assert_string_equal(recent.paths[0], "/folder");
    for (int i = 1; i <= RECENT_LIMIT; i++) {
        snprintf(path, sizeof path, "/%d", i);
        recent_add(path);
    }
    recent_add("/3");
    recent_load(&recent);
    assert_int_equal(recent.count, RECENT_LIMIT); /* 3 8 7 6 5 4 2 1 */
    assert_string_equal(recent.paths[0], "/3");
    assert_string_equal(recent.paths[1], "/8");
    assert_string_equal(recent.paths[5], "/4");
    assert_string_equal(recent.paths[6], "/2");
    assert_string_equal(recent.paths[7], "/1");
    recent_add("./b.nii");
    recent_load(&recent);
    assert_non_null(getcwd(here, sizeof here));
    assert_memory_equal(recent.paths[0], here, strlen(here));
    assert_string_equal(recent.paths[0] + strlen(here), "/b.nii");
    assert_string_equal(recent.paths[7], "/2");
    find_state(path, "recent.json");
    assert_ok(conus_write_file(path, three, strlen(three) - 1)); /* damaged: it begins anew */
    recent_add("/a");
    recent_load(&recent);
    assert_int_equal(recent.count, 1);
}

static void the_start_page_shows_no_escapes(void **state)
{
    struct start start = {.typed = "~/a~/b"};
    char words[PATH_MAX];
    char path[PATH_MAX];
    (void)state;
    find_state(path, "recent.json");
    assert_ok(conus_write_file(path, three, strlen(three)));
    setenv("XDG_DATA_DIRS", "relative:/none", 1);
    start_look(&start);
    assert_string_equal(start_path(&start, 1), "/b/\x1b.nii");
    assert_string_equal(start_words(words, &start, 1), " .nii");
    assert_string_equal(words, "/b/ .nii");
    assert_null(start_path(&start, 3));
    setenv("HOME", "/home/me", 1);
    assert_true(start_typed(path, &start));
    assert_string_equal(path, "/home/me/a~/b");
    memcpy(start.typed, "~a", 3);
    assert_true(start_typed(path, &start));
    assert_string_equal(path, "~a");
    start.typed[0] = '\0';
    assert_false(start_typed(path, &start));
}

/* Opaque from 1 on, the brain phantom's context hides all in it; thinned, less and less. */
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
    assert_true(viewer_pick(&object, bare, &viewer, from, back));
    assert_true(object > 0);
    viewer.display.fade = 0;
    assert_true(painter_set_transfer(viewer.painter, opaque, 4));
    assert_true(viewer_pick(&object, hidden, &viewer, from, back));
    assert_int_equal(object, 0);
    assert_true(hidden[1] > bare[1]);
    viewer_finish(&viewer);
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

static void what_was_selected_is_a_table(void **state)
{
    struct viewer viewer;
    char path[600];
    char text[4096] = "";
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    viewer_aim_along(&viewer, eye, back);
    snprintf(path, sizeof path, "%s", test_scratch("results.tsv"));
    assert_ok(viewer_write_results(&viewer, path));
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

/* Of a file that is gone, and of one that is another, it is said once. */
static void files_are_watched(void **state)
{
    struct viewer viewer;
    char path[600];
    char news[WATCH_NEWS];
    (void)state;
    load(&viewer, "slabs", "slabs.nii.gz");
    snprintf(path, sizeof path, "%s", conus_atlas_volume(viewer.drawn->atlas, 0)->path);
    assert_false(watch_look(viewer.drawn->watch, news));
    assert_int_equal(unlink(path), 0);
    assert_true(watch_look(viewer.drawn->watch, news));
    assert_non_null(strstr(news, "slabs.nii.gz is gone from disk"));
    assert_false(watch_look(viewer.drawn->watch, news));
    assert_ok(conus_write_file(path, "other", 5));
    assert_true(watch_look(viewer.drawn->watch, news));
    assert_non_null(strstr(news, "slabs.nii.gz changed on disk"));
    assert_false(watch_look(viewer.drawn->watch, news));
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

/* A threshold that is no number cannot be set: what was set before it goes back. */
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

/* Changes of the atlas start another painter, which draws with the same points. */
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

/* Cone and pins would be of other places: the atlas has moved by 7 mm since. */
static void a_session_is_of_where_the_atlas_lay(void **state)
{
    struct viewer viewer;
    struct window window = {.enlarged = -1, .viewer = &viewer};
    const double right[16] = {[0] = 1, [5] = 1, [10] = 1, [12] = 7, [15] = 1};
    char why[SESSION_REASON];
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    char *before = session_text(&window);
    assert_true(session_parse(&window, before, strlen(before), why));
    assert_ok(conus_atlas_move(viewer.drawn->atlas, right));
    assert_false(session_parse(&window, before, strlen(before), why));
    assert_non_null(strstr(why, "--atlas-transform"));
    char *moved = session_text(&window);
    assert_true(session_parse(&window, moved, strlen(moved), why));
    free(before);
    free(moved);
    viewer_finish(&viewer);
}

/* Positions for points with x from 10 to 70 mm, `shift` to the right; of the origin the field says nothing. */
static void warp_atlas(conus_atlas *atlas, double shift)
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
    assert_ok(atlas_warp(atlas, &field, &plan));
}

/* The same where a field has moved the atlas, which says nothing of some of the points that are compared. */
static void a_session_is_of_the_field_that_moved_the_atlas(void **state)
{
    struct viewer viewer;
    struct window window = {.enlarged = -1, .viewer = &viewer};
    char why[SESSION_REASON];
    (void)state;
    load(&viewer, "nested", "nested.nii.gz");
    char *plain = session_text(&window);
    warp_atlas((conus_atlas *)viewer.drawn->atlas, -40);
    char *warped = session_text(&window);
    assert_true(session_parse(&window, warped, strlen(warped), why));
    assert_false(session_parse(&window, plain, strlen(plain), why));
    viewer_finish(&viewer);
    load(&viewer, "nested", "nested.nii.gz");
    warp_atlas((conus_atlas *)viewer.drawn->atlas, -41);
    assert_false(session_parse(&window, warped, strlen(warped), why));
    assert_non_null(strstr(why, "--atlas-transform"));
    free(plain);
    free(warped);
    viewer_finish(&viewer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mouse_hits_what_is_shown),
        cmocka_unit_test(what_is_hidden_is_not_selected),
        cmocka_unit_test(what_comes_hidden_can_be_shown),
        cmocka_unit_test(a_pathway_has_a_value),
        cmocka_unit_test(an_opaque_context_is_hit_before_what_it_hides),
        cmocka_unit_test(a_place_has_a_voxel_and_the_crosshair_stays_near),
        cmocka_unit_test(what_was_selected_is_a_table),
        cmocka_unit_test(files_are_watched),
        cmocka_unit_test(a_node_is_shown_whole_in_part_or_not),
        cmocka_unit_test(colours_go_and_come_back),
        cmocka_unit_test(settings_of_the_atlas_are_all_set_or_none),
        cmocka_unit_test(edited_points_outlive_other_changes),
        cmocka_unit_test(the_window_finds_its_place_again),
        cmocka_unit_test(a_window_fits_its_screen),
        cmocka_unit_test(texts_are_as_large_as_the_screen_is_dense),
        cmocka_unit_test(only_a_whole_list_is_read),
        cmocka_unit_test(what_is_opened_comes_first),
        cmocka_unit_test(the_start_page_shows_no_escapes),
        cmocka_unit_test(a_device_without_a_pose_is_put_in_front),
        cmocka_unit_test(a_session_is_of_where_the_atlas_lay),
        cmocka_unit_test(a_session_is_of_the_field_that_moved_the_atlas),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
