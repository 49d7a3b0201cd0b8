/* SPDX-License-Identifier: BSD-3-Clause */
/* The streamlines in a selection's region (Eq. 19), and files of them. The lines are those of tract_scene.h: 0 and 1
 * pass the axis z at z = 30, 0 and 3 mm beside it; 2 and 3 are far away. */
#include "atlas/phantom/phantom.h"
#include "conus/own.h"
#include "loaders/tracts/tracts.h"
#include "made_atlas.h"
#include "test.h"
#include "tract_scene.h"

#include <string.h>
#include <unistd.h>

struct scene {
    conus_atlas *atlas;
    conus_selector *selector;
    conus_selection *selection;
};

/* A cylinder along the axis z, without layers; a radius of 0 makes it a ball without streamlines. */
static struct scene scene_of(double radius)
{
    struct scene scene = {.atlas = tract_lines_atlas()};
    const conus_selector_options options = {.radius = radius};
    conus_pose pose;
    assert_ok(conus_selector_create(&scene.selector, scene.atlas, &options));
    assert_ok(conus_pose_along(&pose, (double[]){0, 0, 0}, (double[]){0, 0, 1}, NULL));
    assert_ok(radius > 0 ? conus_select(&scene.selection, scene.selector, &pose, 0)
                         : conus_select_ball(&scene.selection, scene.selector, (double[]){0, 50, 0}, 1));
    return scene;
}

static void scene_end(struct scene *scene)
{
    conus_selection_destroy(scene->selection);
    conus_selector_destroy(scene->selector);
    conus_atlas_destroy(scene->atlas);
}

static conus_streamline_list *list_of(const struct scene *scene, uint32_t object)
{
    conus_streamline_list *list = NULL;
    assert_ok(conus_selection_streamlines(&list, scene->selection, object));
    return list;
}

static void what_comes_in_is_listed(void **state)
{
    (void)state;
    struct scene scene = scene_of(5);
    for (uint32_t object = 0; object < 2; object++) {
        conus_streamline_list *list = list_of(&scene, object);
        conus_streamline_list_view view = conus_streamline_list_data(list);
        assert_int_equal(view.count, 2);
        assert_int_equal(view.points, 4);
        for (uint32_t i = 0; i < 2; i++) {
            assert_int_equal(view.tractogram[i], 0);
            assert_int_equal(view.number[i], i);
        }
        conus_streamline_list_destroy(list);
    }
    conus_streamline_list *none = list_of(&scene, 2);
    assert_int_equal(conus_streamline_list_data(none).count, 0);
    assert_int_equal(conus_streamline_list_data(NULL).count, 0);
    conus_streamline_list_destroy(none);
    conus_streamline_list_destroy(NULL);
    scene_end(&scene);
    scene = scene_of(2); /* only that on the axis */
    conus_streamline_list *one = list_of(&scene, 0);
    assert_int_equal(conus_streamline_list_data(one).count, 1);
    assert_int_equal(conus_streamline_list_data(one).number[0], 0);
    conus_streamline_list_destroy(one);
    scene_end(&scene);
}

static void refuse(const struct scene *scene, uint32_t object, const char *message)
{
    conus_streamline_list *list = NULL;
    assert_fails(conus_selection_streamlines(&list, scene->selection, object), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), message);
    assert_null(list);
}

static void what_is_no_bundle_is_refused(void **state)
{
    (void)state;
    struct scene scene = scene_of(5);
    const bool hidden[3] = {false, true, false};
    refuse(&scene, 3, "object: 3, allowed is up to 2");
    assert_ok(conus_atlas_set_hidden(scene.atlas, hidden));
    refuse(&scene, 1, "streamlines: near is hidden");
    conus_streamline_list *shown = list_of(&scene, 0); /* without those of the hidden one */
    assert_int_equal(conus_streamline_list_data(shown).count, 0);
    conus_streamline_list_destroy(shown);
    scene_end(&scene);
    struct scene balls = {0};
    const conus_phantom_options options = {.size = 16};
    struct phantom_drawing drawing;
    assert_ok(phantom_draw(&drawing, "sphere", &options));
    assert_ok(phantom_drawing_atlas(&balls.atlas, &drawing));
    phantom_drawing_finish(&drawing);
    assert_ok(conus_selector_create(&balls.selector, balls.atlas, NULL));
    assert_ok(conus_select_ball(&balls.selection, balls.selector, (double[]){0, 0, 0}, 1));
    refuse(&balls, 0, "streamlines: there is no bundle");
    refuse(&balls, 1, "streamlines: Sphere is an area, a bundle is needed");
    scene_end(&balls);
}

/* The reader reads what was written, point by point, and the bytes before the points are these. */
static void a_file_has_the_whole_streamlines(void **state)
{
    (void)state;
    static const char header[] = "mrtrix tracks\ndatatype: Float32LE\ncount: 0000000002\nfile: . 68\nEND\n";
    static const float points[] = {-50, 0, 30, 50, 0, 30, 70, 3, 30, -30, 3, 30};
    struct scene scene = scene_of(5);
    conus_streamline_list *list = list_of(&scene, 0);
    struct tractogram read;
    struct notes notes = {0};
    struct bytes file;
    const char *path = test_scratch("two.tck");
    float copied[12];
    uint64_t first[3];
    assert_ok(conus_streamline_list_write(list, path));
    assert_ok(file_read(&file, path, 1000));
    assert_int_equal(file.size, 68 + 12 * (4 + 2 + 1));
    assert_memory_equal(file.data, header, sizeof header);
    bytes_finish(&file);
    assert_ok(tract_read(&read, path, 0, &notes));
    assert_int_equal(read.streamline_count, 2);
    assert_int_equal(read.first[1], 2);
    assert_memory_equal(read.points, points, sizeof points);
    tractogram_finish(&read);
    notes_finish(&notes);
    conus_streamline_list_points(copied, first, list);
    assert_memory_equal(copied, points, sizeof points);
    assert_true(first[0] == 0 && first[1] == 2 && first[2] == 4);
    conus_streamline_list_points(copied, NULL, list);
    conus_streamline_list_destroy(list);
    scene_end(&scene);
}

static void a_file_may_have_none(void **state)
{
    (void)state;
    struct scene scene = scene_of(0);
    conus_streamline_list *list = list_of(&scene, 0);
    struct tractogram read;
    struct notes notes = {0};
    const char *path = test_scratch("none.tck");
    assert_ok(conus_streamline_list_write(list, path));
    assert_ok(tract_read(&read, path, 0, &notes));
    assert_int_equal(read.streamline_count, 0);
    tractogram_finish(&read);
    notes_finish(&notes);
    conus_streamline_list_destroy(list);
    scene_end(&scene);
}

static void files_that_cannot_be_are_refused(void **state)
{
    (void)state;
    struct scene scene = scene_of(5);
    conus_streamline_list *list = list_of(&scene, 0);
    const char *path = test_scratch("two.trk");
    assert_fails(conus_streamline_list_write(list, path), CONUS_ERROR_ARGUMENT);
    assert_int_equal(access(path, F_OK), -1);
    assert_fails(conus_streamline_list_write(list, test_scratch("absent/two.tck")), CONUS_ERROR_IO);
    conus_streamline_list_destroy(list);
    scene_end(&scene);
}

static conus_status attempt(void *data)
{
    const struct scene *scene = data;
    conus_streamline_list *list = NULL;
    conus_status status = conus_selection_streamlines(&list, scene->selection, 0);
    status = status ? status : conus_streamline_list_write(list, test_scratch("again.tck"));
    conus_streamline_list_destroy(list);
    return status;
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    struct scene scene = scene_of(5);
    test_every_allocation(attempt, &scene);
    scene_end(&scene);
}

TEST_GROUP(streamline_list)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_comes_in_is_listed),          cmocka_unit_test(what_is_no_bundle_is_refused),
        cmocka_unit_test(a_file_has_the_whole_streamlines), cmocka_unit_test(a_file_may_have_none),
        cmocka_unit_test(files_that_cannot_be_are_refused), cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
