/* SPDX-License-Identifier: BSD-3-Clause */
/* All layers (Eq. 10): the container of the intervals, and the rays engine's intervals. */
#include "base/geometry/math3.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/selection.h"
#include "test.h"

#include <math.h>

static conus_interval interval_of(uint32_t pixel, uint32_t object, double entry, double exit)
{
    return (conus_interval){pixel, object, entry, exit, 7};
}

static void assert_interval(const conus_interval *got, uint32_t pixel, uint32_t object, double entry, double exit)
{
    assert_int_equal(got->pixel, pixel);
    assert_int_equal(got->object, object);
    assert_near(got->entry, entry, 0);
    assert_near(got->exit, exit, 0);
}

static void intervals_are_sorted_by_pixel_entry_and_object(void **state)
{
    (void)state;
    struct layers layers = {0};
    const conus_interval given[] = {interval_of(3, 1, 5, 6), interval_of(0, 2, 1, 2), interval_of(3, 1, 2, 3),
                                    interval_of(0, 1, 1, 9), interval_of(0, 1, 1, 3)};
    for (size_t i = 0; i < 5; i++) {
        assert_ok(layers_add(&layers, &given[i]));
    }
    assert_ok(layers_sort(&layers, 4));
    assert_int_equal(layers.count, 5);
    assert_interval(&layers.intervals[0], 0, 1, 1, 3);
    assert_interval(&layers.intervals[1], 0, 1, 1, 9);
    assert_interval(&layers.intervals[2], 0, 2, 1, 2);
    assert_interval(&layers.intervals[3], 3, 1, 2, 3);
    assert_interval(&layers.intervals[4], 3, 1, 5, 6);
    layers_finish(&layers);
}

static void many_intervals_of_one_pixel_are_sorted(void **state)
{
    (void)state;
    struct layers layers = {0};
    for (uint32_t i = 0; i < 5000; i++) {
        const conus_interval interval = interval_of(0, 1, (i * 2654435761U) % 10007, 20000);
        assert_ok(layers_add(&layers, &interval));
    }
    assert_ok(layers_sort(&layers, 1));
    for (size_t i = 1; i < layers.count; i++) {
        assert_true(layers.intervals[i - 1].entry <= layers.intervals[i].entry);
    }
    layers_finish(&layers);
}

/* One pixel, whose ray is the axis: depth equals distance. */
static void a_range_cuts_intervals_and_drops_the_rest(void **state)
{
    (void)state;
    struct layers layers = {0};
    const struct cone cone = {.angle = 0.5, .resolution = 1, .range = {10, 20}};
    const conus_interval given[] = {interval_of(0, 9, 1, 9),   interval_of(0, 5, 2, 12),  interval_of(0, 4, 3, 30),
                                    interval_of(0, 3, 12, 13), interval_of(0, 2, 19, 22), interval_of(0, 1, 21, 22),
                                    interval_of(0, 6, 20, 25)};
    struct evidence evidence;
    for (size_t i = 0; i < sizeof given / sizeof given[0]; i++) {
        assert_ok(layers_add(&layers, &given[i]));
    }
    assert_ok(layers_sort(&layers, 1));
    layers_clip(&layers, &cone);
    assert_int_equal(layers.count, 5);
    assert_interval(&layers.intervals[0], 0, 4, 10, 20); /* both are cut at 10: the lower object first */
    assert_interval(&layers.intervals[1], 0, 5, 10, 12);
    assert_interval(&layers.intervals[2], 0, 3, 12, 13);
    assert_interval(&layers.intervals[3], 0, 2, 19, 20);
    assert_interval(&layers.intervals[4], 0, 6, 20, 20);
    assert_ok(evidence_init(&evidence, 1));
    assert_false(layers_first(&evidence, &layers));
    assert_int_equal(evidence.object[0], 4);
    assert_near(evidence.distance[0], 10, 0);
    evidence_finish(&evidence);
    layers_finish(&layers);
}

static void blockers_are_dropped(void **state)
{
    (void)state;
    struct layers layers = {0};
    const conus_interval given[] = {interval_of(0, VOLUME_BLOCKER, 1, 2), interval_of(0, 1, 1, 3),
                                    interval_of(1, VOLUME_BLOCKER, 0, 1)};
    for (size_t i = 0; i < 3; i++) {
        assert_ok(layers_add(&layers, &given[i]));
    }
    layers_drop_blockers(&layers);
    assert_int_equal(layers.count, 1);
    assert_interval(&layers.intervals[0], 0, 1, 1, 3);
    layers_finish(&layers);
}

static void assert_same_evidence(const struct evidence *a, const struct evidence *b)
{
    size_t pixels = (size_t)a->resolution * a->resolution;
    assert_memory_equal(a->object, b->object, pixels * sizeof *a->object);
    assert_memory_equal(a->distance, b->distance, pixels * sizeof *a->distance);
    assert_memory_equal(a->voxel, b->voxel, pixels * sizeof *a->voxel);
}

/* The first hit is the first interval of each pixel, to the bit. */
static void the_first_interval_is_what_is_visible(void **state)
{
    (void)state;
    uint64_t random = 41;
    int certain = 0;
    for (int k = 0; k < 60; k++) {
        conus_atlas *atlas = scene_atlas(&random, 12, 1);
        struct cone cone = scene_cone(&random, atlas);
        const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .resolution = cone.resolution};
        const conus_selector_options plain = {.resolution = cone.resolution};
        conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
        conus_selection *visible = mesh_scene_select(atlas, &plain, &cone);
        struct evidence first;
        assert_ok(evidence_init(&first, cone.resolution));
        certain += layers_first(&first, &selection->layers);
        assert_same_evidence(&first, &visible->evidence);
        assert_same_evidence(&selection->evidence, &visible->evidence);
        evidence_finish(&first);
        conus_selection_destroy(visible);
        conus_selection_destroy(selection);
        conus_atlas_destroy(atlas);
    }
    assert_in_range(certain, 20, 60); /* else nothing is shown by layers alone */
}

/* With a range the first hit is the first of the intervals that the range has cut. The oracle is the layers, which go
 * on behind blocking contexts, too. */
static void in_a_range_the_first_interval_is_visible(void **state)
{
    (void)state;
    uint64_t random = 47;
    size_t hits[2] = {0}; /* at the near end, and behind it */
    for (int k = 0; k < 80; k++) {
        conus_atlas *atlas = scene_atlas(&random, 12, 1);
        scene_add_blockers(atlas, &random, (size_t[]){9, 9, 9}, 0.05);
        struct cone cone = scene_cone(&random, atlas);
        double near = k % 3 ? test_random(&random, 0, 25) : 0;
        conus_selector_options options = {.resolution = cone.resolution,
                                          .radius = k % 4 == 1 ? test_random(&random, 0.1, 8) : 0,
                                          .range = {near, near + test_random(&random, 0.1, 30)}};
        cone.angle = options.radius > 0 ? 0 : cone.angle;
        conus_selection *visible = mesh_scene_select(atlas, &options, &cone);
        options.layers = CONUS_LAYERS_ALL;
        conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
        assert_same_evidence(&selection->evidence, &visible->evidence);
        for (size_t p = 0; p < (size_t)cone.resolution * cone.resolution; p++) {
            double per_depth =
                cone_per_depth(&visible->cone, (uint32_t)p % cone.resolution, (uint32_t)p / cone.resolution);
            bool is_cut = visible->evidence.distance[p] == near * per_depth;
            hits[!is_cut] += visible->evidence.object[p] != 0;
        }
        conus_selection_destroy(visible);
        conus_selection_destroy(selection);
        conus_atlas_destroy(atlas);
    }
    assert_true(hits[0] > 100 && hits[1] > 1000);
}

/* Two adjacent ranges together give the answer of one over both. */
static void ranges_that_meet_add_up(void **state)
{
    (void)state;
    uint64_t random = 43;
    for (int k = 0; k < 20; k++) {
        conus_atlas *atlas = scene_atlas(&random, 12, 0);
        struct cone cone = scene_cone(&random, atlas);
        static const double ranges[3][2] = {{2, 9}, {9, 400}, {2, 400}};
        double length[3] = {0};
        for (int r = 0; r < 3; r++) {
            const conus_selector_options options = {
                .layers = CONUS_LAYERS_ALL, .range = {ranges[r][0], ranges[r][1]}, .resolution = cone.resolution};
            conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
            for (size_t i = 0; i + 1 < conus_selection_count(selection); i++) {
                const conus_result *result = conus_selection_result(selection, i);
                length[r] += result->pierced ? result->path * result->pierced : 0;
            }
            conus_selection_destroy(selection);
        }
        assert_near(length[0] + length[1], length[2], 1e-9 * (1 + length[2]));
        conus_atlas_destroy(atlas);
    }
}

/* A cylinder through the whole of a box of one area: each ray is as long as the box. */
static void a_cylinder_has_parallel_rays(void **state)
{
    (void)state;
    static uint32_t labels[10 * 10 * 10];
    const conus_volume_info grid = scene_plain_grid((size_t[]){10, 10, 10}, NULL);
    struct cone cone = {.resolution = 16};
    for (size_t i = 0; i < 1000; i++) {
        labels[i] = 1;
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    assert_ok(conus_pose_along(&cone.pose, (double[]){4.5, 4.5, 50}, (double[]){0, 0, -1}, NULL));
    const conus_selector_options options = {.resolution = 16, .layers = CONUS_LAYERS_ALL, .radius = 4};
    conus_selection *selection = mesh_scene_select(atlas, &options, &cone);
    const conus_result *box = conus_selection_result(selection, 0);
    assert_int_equal(box->pixels, 208);
    assert_int_equal(box->pierced, 208);
    assert_near(box->entry, 40.5, 1e-12);
    assert_near(box->exit, 50.5, 1e-12);
    assert_near(box->path, 10, 1e-12);
    assert_near(box->share, 1, 1e-12);
    assert_near(box->offset, 0, 0);
    double lowest = 4.5;
    for (size_t pixel = 0; pixel < 256; pixel++) {
        double point[3];
        conus_selection_position(point, selection, pixel);
        lowest = fmin(lowest, point[0]);
    }
    assert_near(lowest, 4.5 - 4 * 15.0 / 16, 1e-12);
    conus_selection_destroy(selection);
    conus_atlas_destroy(atlas);
}

static void shapes_out_of_range_are_refused(void **state)
{
    (void)state;
    uint64_t random = 44;
    conus_atlas *atlas = scene_atlas(&random, 4, 0);
    conus_selector *selector = NULL;
    const conus_selector_options bad[] = {
        {.radius = -1},
        {.radius = NAN},
        {.radius = INFINITY},
        {.range = {5, 2}},
        {.range = {-1, 2}},
        {.range = {3, 3}},
        {.range = {NAN, 2}},
        {.range = {0, NAN}},
        {.range = {0, INFINITY}},
        {.layers = CONUS_LAYERS_ALL, .sampling = CONUS_SAMPLING_SLICES},
        {.range = {1, 2}, .sampling = CONUS_SAMPLING_SLICES},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_fails(conus_selector_create(&selector, atlas, &bad[i]), CONUS_ERROR_ARGUMENT);
    }
    const conus_selector_options cylinder = {.radius = 2};
    struct cone cone = scene_cone(&random, atlas);
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &cylinder));
    assert_fails(conus_select(&selection, selector, &cone.pose, degrees_from_radians(0.2)), CONUS_ERROR_ARGUMENT);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

struct trial {
    conus_atlas *atlas;
    struct cone cone;
};

static conus_status select_all(void *data)
{
    const struct trial *attempt = data;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .range = {1, 100}};
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_status status = conus_selector_create(&selector, attempt->atlas, &options);
    status = status ? status : conus_select(&selection, selector, &attempt->cone.pose, degrees_from_radians(1));
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    uint64_t random = 45;
    struct trial attempt = {.atlas = scene_atlas(&random, 8, 1)};
    attempt.cone = scene_cone(&random, attempt.atlas);
    test_every_allocation(select_all, &attempt);
    conus_atlas_destroy(attempt.atlas);
}

/* Fills the grid with areas, another one in each cell. */
static void fill_grid(conus_atlas *atlas)
{
    struct volume *volume = &atlas->volumes[0];
    for (size_t v = 0; v < volume->voxel_count && atlas->area_count; v++) {
        uint16_t number = (uint16_t)(1 + v * 7 % 11 % atlas->area_count);
        volume->objects16[v] = number;
    }
}

/* A range of all depths changes nothing, to the bit, also from corners and faces of cells. */
static void a_range_of_everything_changes_nothing(void **state)
{
    (void)state;
    uint64_t random = 43;
    for (int k = 0; k < 150; k++) {
        conus_atlas *atlas = scene_atlas(&random, 12, 1);
        struct cone cone = scene_cone(&random, atlas);
        fill_grid(atlas);
        const conus_selector_options open = {.resolution = cone.resolution};
        const conus_selector_options range = {.resolution = cone.resolution, .range = {0, 1e7}};
        conus_selection *wanted = mesh_scene_select(atlas, &open, &cone);
        conus_selection *got = mesh_scene_select(atlas, &range, &cone);
        size_t pixels = (size_t)cone.resolution * cone.resolution;
        assert_memory_equal(got->evidence.object, wanted->evidence.object, pixels * sizeof *got->evidence.object);
        assert_memory_equal(got->evidence.distance, wanted->evidence.distance, pixels * sizeof(double));
        assert_memory_equal(got->evidence.voxel, wanted->evidence.voxel, pixels * sizeof *got->evidence.voxel);
        conus_selection_destroy(wanted);
        conus_selection_destroy(got);
        conus_atlas_destroy(atlas);
    }
}

TEST_GROUP(layers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(intervals_are_sorted_by_pixel_entry_and_object),
        cmocka_unit_test(many_intervals_of_one_pixel_are_sorted),
        cmocka_unit_test(a_range_cuts_intervals_and_drops_the_rest),
        cmocka_unit_test(blockers_are_dropped),
        cmocka_unit_test(the_first_interval_is_what_is_visible),
        cmocka_unit_test(a_range_of_everything_changes_nothing),
        cmocka_unit_test(in_a_range_the_first_interval_is_visible),
        cmocka_unit_test(ranges_that_meet_add_up),
        cmocka_unit_test(a_cylinder_has_parallel_rays),
        cmocka_unit_test(shapes_out_of_range_are_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
