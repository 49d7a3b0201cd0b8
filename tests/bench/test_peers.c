/* SPDX-License-Identifier: BSD-3-Clause */
/* VTK's pickers and its selector against conus, on a labelled volume of two slabs across the y axis: voxels of 1 mm, y
 * from 6 to 12 mm ("Slab anterior") and from -12 to -6 mm ("Slab posterior").
 *
 * From y = -100 mm along +y the posterior slab begins at a depth of 88 mm, with the voxel whose centre lies at 88.5
 * mm. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "made_atlas.h"
#include "selection/engine/engine.h"
#include "test.h"
#include "tests/bench/peer_labels.h"

enum { PIXELS = PEER_RESOLUTION * PEER_RESOLUTION, ANTERIOR = 1, POSTERIOR = 2, FIRST_ROW = 20, DEGREES = 1 };

struct view {
    struct phantom_drawing drawing;
    conus_atlas *atlas;
    struct cone cone;
};

static void open_view(struct view *out)
{
    static const double from[3] = {0, -100, 0}, along[3] = {0, 1, 0};
    *out = (struct view){.cone = {.angle = radians_from_degrees(DEGREES), .resolution = PEER_RESOLUTION}};
    assert_ok(phantom_draw(&out->drawing, "slabs", NULL));
    assert_ok(phantom_drawing_atlas(&out->atlas, &out->drawing));
    assert_ok(conus_pose_along(&out->cone.pose, from, along, NULL));
}

static void close_view(struct view *view)
{
    conus_atlas_destroy(view->atlas);
    phantom_drawing_finish(&view->drawing);
}

static const struct volume *volume_of(const struct view *view)
{
    return atlas_parcellation(view->atlas);
}

/* Depth along the axis of the point at `distance` on a pixel's ray. */
static double depth_of(const struct view *view, size_t pixel, double distance)
{
    return distance / cone_per_depth(&view->cone, (uint32_t)pixel % PEER_RESOLUTION, (uint32_t)pixel / PEER_RESOLUTION);
}

/* Index of a voxel along y. */
static uint64_t row_of(const struct view *view, uint64_t voxel)
{
    const size_t *dim = volume_of(view)->info.dim;
    return voxel / dim[0] % dim[1];
}

static void conus_answers_with_the_first_contact(void **state)
{
    (void)state;
    struct view view;
    struct engine *rays = NULL;
    struct evidence evidence;
    open_view(&view);
    assert_ok(engine_rays_create(&rays, view.atlas, &(struct engine_options){0}));
    assert_ok(evidence_init(&evidence, PEER_RESOLUTION));
    assert_ok(rays->functions->trace(rays, &evidence, &view.cone));
    for (size_t i = 0; i < PIXELS; i++) {
        assert_int_equal(evidence.object[i], POSTERIOR);
        assert_int_equal(row_of(&view, evidence.voxel[i]), FIRST_ROW);
        assert_near(depth_of(&view, i, evidence.distance[i]), 88, 1e-9);
    }
    evidence_finish(&evidence);
    engine_destroy(rays);
    close_view(&view);
}

/* Pickers interpolate between the centre of the last empty voxel, at 87.5 mm, and of the first of the slab, and stop
 * where the opacity in between reaches the isovalue. They name the voxel whose centre is nearest to that point: with
 * VTK's default, 0.05, one of the background. */
static void pickers_stop_between_voxels(void **state)
{
    static const double isovalues[] = {0.05, 0.25, 0.75, 0.95};
    struct view view;
    struct peer_labels *labels = NULL;
    struct peer_contact contacts[PIXELS];
    (void)state;
    open_view(&view);
    assert_ok(peer_labels_create(&labels, volume_of(&view), 1, false));
    for (size_t k = 0; k < 8; k++) {
        double isovalue = isovalues[k / 2];
        bool beyond_middle = isovalue > 0.5;
        enum peer_picker kind = k % 2 ? PEER_CELL_PICKER : PEER_VOLUME_PICKER;
        assert_ok(peer_labels_pick(labels, contacts, &view.cone, kind, isovalue));
        for (size_t i = 0; i < PIXELS; i++) {
            assert_near(depth_of(&view, i, contacts[i].distance_mm), 87.5 + isovalue, 1e-6);
            assert_int_equal(contacts[i].object, beyond_middle ? POSTERIOR : 0);
            assert_int_equal(row_of(&view, contacts[i].voxel), beyond_middle ? FIRST_ROW : FIRST_ROW - 1);
        }
    }
    peer_labels_destroy(labels);
    close_view(&view);
}

/* Number of samples, 1 mm apart, until less than 1/255 of the light from behind is left. */
static uint64_t samples_until_opaque(double opacity)
{
    return (uint64_t)ceil(log(1 / 255.0) / log(1 - opacity));
}

/* The selector names the sample after the one that made the ray opaque. Its voxel number counts a grid of one voxel
 * less, so that rows in the far half of the grid come out one lower. */
static uint64_t ending_row(uint64_t samples, uint64_t rows)
{
    enum { SLAB_ROWS = 6, GAP_ROWS = 12 };
    uint64_t row = FIRST_ROW + samples + (samples > SLAB_ROWS ? GAP_ROWS : 0);
    return (rows - 1) * (2 * row + 1) / (2 * rows);
}

static void the_selector_names_where_the_ray_ended(void **state)
{
    static const double opacities[] = {0.999, 0.9, 0.58};
    static const uint32_t named[] = {POSTERIOR, POSTERIOR, ANTERIOR};
    struct view view;
    struct peer_contact contacts[PIXELS];
    (void)state;
    open_view(&view);
    for (size_t k = 0; k < sizeof named / sizeof *named; k++) {
        struct peer_labels *labels = NULL;
        conus_status status = peer_labels_create(&labels, volume_of(&view), opacities[k], true);
        if (status == CONUS_ERROR_GL) {
            close_view(&view);
            print_message("skipped: %s\n", conus_message());
            skip();
        }
        assert_ok(status);
        assert_ok(peer_labels_select(labels, contacts, &view.cone));
        uint64_t row = ending_row(samples_until_opaque(opacities[k]), volume_of(&view)->info.dim[1]);
        assert_true(row > FIRST_ROW);
        for (size_t i = 0; i < PIXELS; i++) {
            assert_int_equal(contacts[i].object, named[k]);
            assert_int_equal(row_of(&view, contacts[i].voxel), row);
            assert_true(isnan(contacts[i].distance_mm));
        }
        peer_labels_destroy(labels);
    }
    close_view(&view);
}

TEST_GROUP(peers)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(conus_answers_with_the_first_contact),
        cmocka_unit_test(pickers_stop_between_voxels),
        cmocka_unit_test(the_selector_names_where_the_ray_ended),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
