/* SPDX-License-Identifier: BSD-3-Clause */
/* The planes of slice sampling, on a real atlas and on thin tubes. */
#include "atlas/phantom/phantom.h"
#include "base/geometry/math3.h"
#include "selection/engine/engine.h"
#include "test.h"
#include "test_gl.h"

#include "conus/own.h"
#include "made_atlas.h"

#include <string.h>

/* The cost of the paper's planes (Eq. 7) against the exact walk (Eq. 5): this test keeps the figures in docs/model.md
 * true. */
enum { POSES = 64, RESOLUTION = 16 };

struct engines {
    struct engine *exact;
    struct engine *slices;
};

/* Counts over the pixels of the cone in which the exact engine hits the wanted object. */
struct tally {
    size_t pixels;
    size_t missed; /* nothing on the planes     */
    size_t other;  /* another object on them    */
    double late;   /* sum of mm by which agreeing ones are too far */
};

static struct engines make_engines(const conus_atlas *atlas, uint32_t planes)
{
    struct engines engines = {0};
    const struct engine_options exact = {0};
    const struct engine_options slices = {.sampling = CONUS_SAMPLING_SLICES, .slices = 5 * planes};
    assert_ok(engine_rays_create(&engines.exact, atlas, &exact));
    assert_ok(engine_rays_create(&engines.slices, atlas, &slices));
    return engines;
}

static void destroy_engines(struct engines *engines)
{
    engine_destroy(engines->exact);
    engine_destroy(engines->slices);
}

static void count_pixel(struct tally *tally, const struct evidence *exact, const struct evidence *slices, size_t pixel)
{
    tally->pixels++;
    if (!slices->object[pixel]) {
        tally->missed++;
    } else if (slices->object[pixel] != exact->object[pixel]) {
        tally->other++;
    } else {
        tally->late += slices->distance[pixel] - exact->distance[pixel];
    }
}

/* Adds the pixels in which the exact engine hits @p object, or any for 0. */
static void count_look(struct tally *tally, const struct engines *engines, const struct cone *cone, uint32_t object)
{
    struct evidence exact, slices;
    assert_ok(evidence_init(&exact, RESOLUTION));
    assert_ok(evidence_init(&slices, RESOLUTION));
    assert_ok(engines->exact->functions->trace(engines->exact, &exact, cone));
    assert_ok(engines->slices->functions->trace(engines->slices, &slices, cone));
    for (uint32_t i = 0; i < RESOLUTION * RESOLUTION; i++) {
        if (!cone_has_pixel(cone, i % RESOLUTION, i / RESOLUTION)) {
            continue;
        }
        assert_true(exact.object[i] || !slices.object[i]);           /* planes invent nothing ... */
        assert_true(slices.distance[i] >= exact.distance[i] - 1e-9); /* ... and are never early */
        if (exact.object[i] && (!object || exact.object[i] == object)) {
            count_pixel(tally, &exact, &slices, i);
        }
    }
    evidence_finish(&exact);
    evidence_finish(&slices);
}

/* A cone from 200 mm away at the centre of a random voxel of @p object, or of any for 0. */
static struct cone aim(const conus_atlas *atlas, uint32_t object, uint64_t *random)
{
    const struct volume *volume = &atlas->volumes[0];
    const size_t *dim = volume->info.dim;
    size_t voxel;
    do {
        voxel = (size_t)test_random(random, 0, (double)volume->voxel_count);
    } while (object ? volume_object(volume, voxel) != object : !volume_object(volume, voxel));
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    double target[3] = {(double)at[0], (double)at[1], (double)at[2]};
    mat4_point(target, volume->info.world_from_voxel, target);
    double z = test_random(random, -1, 1);
    double turn = test_random(random, 0, 2 * MATH3_PI);
    double out[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
    struct cone cone = {.angle = radians_from_degrees(5), .resolution = RESOLUTION};
    vec3_add_scaled(out, target, 200, out);
    assert_ok(conus_pose_toward(&cone.pose, out, target, NULL));
    return cone;
}

static struct tally measure(const conus_atlas *atlas, uint32_t object, uint32_t planes)
{
    struct engines engines = make_engines(atlas, planes);
    struct tally tally = {0};
    uint64_t random = 2010;
    for (int pose = 0; pose < POSES; pose++) {
        struct cone cone = aim(atlas, object, &random);
        count_look(&tally, &engines, &cone, object);
    }
    destroy_engines(&engines);
    return tally;
}

/* A row of the table: in per cent of the pixels, and mm. */
struct row {
    uint32_t object, planes; /* 0 planes: N/5 */
    double missed, other, late;
};

static void check_row(const conus_atlas *atlas, const struct row *row)
{
    struct tally tally = measure(atlas, row->object, row->planes);
    double pixels = (double)tally.pixels;
    double same = pixels - (double)(tally.missed + tally.other);
    print_message("object %u, %u planes, %zu pixels: %.2f %% missed, %.2f %% another object, %.3f mm late\n",
                  row->object, row->planes, tally.pixels, 100 * (double)tally.missed / pixels,
                  100 * (double)tally.other / pixels, tally.late / same);
    assert_true(tally.pixels > 500);
    assert_near(100 * (double)tally.missed / pixels, row->missed, 0.06);
    assert_near(100 * (double)tally.other / pixels, row->other, 0.06);
    assert_near(tally.late / same, row->late, 0.006);
}

static void aal_on_planes(void **state)
{
    (void)state;
    static const struct row rows[] = {{0, 0, 0.19, 7.94, 2.427}, {0, 306, 0.04, 1.87, 0.525}};
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_load(&atlas, test_mricron("aal.nii.gz"), NULL));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        check_row(atlas, &rows[i]);
    }
    conus_atlas_destroy(atlas);
}

static void thin_tubes_on_planes(void **state)
{
    (void)state;
    static const struct row rows[] = {
        {1, 0, 79.63, 0.98, 0.969},  {2, 0, 61.25, 5.11, 1.625},  {3, 0, 40.25, 6.62, 1.792},
        {4, 0, 31.81, 5.34, 2.134},  {5, 0, 18.96, 6.98, 2.497},  {6, 0, 13.95, 2.00, 2.506},
        {1, 90, 27.33, 0.69, 0.474}, {2, 90, 11.66, 1.39, 0.571}, {3, 90, 7.38, 1.83, 0.574},
        {4, 90, 5.34, 2.02, 0.588},  {5, 90, 3.15, 2.00, 0.591},  {6, 90, 3.35, 0.74, 0.595}};
    struct phantom_drawing drawing;
    conus_atlas *atlas = NULL;
    assert_ok(phantom_draw(&drawing, "tubes", &(conus_phantom_options){0}));
    assert_ok(phantom_drawing_atlas(&atlas, &drawing));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        check_row(atlas, &rows[i]);
    }
    conus_atlas_destroy(atlas);
    phantom_drawing_finish(&drawing);
}

/* Nine slabs of 1 mm with the labels 1 to 9, seen from 20 mm before the first, straight on. With N = 10 there are M =
 * floor(10 F) planes, the first of them 9 / (2 M) mm into the slabs (Eq. 7). So all pixels hit slab 1 + floor(9 / (2
 * M)) there, and none of the slabs before it. */
static conus_atlas *nine_slabs(void)
{
    static const uint8_t labels[] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    enum { WIDE = 32 };
    static uint8_t data[9][WIDE][WIDE];
    conus_voxels voxels = {.data = data, .type = CONUS_SCALAR_UINT8, .dim = {WIDE, WIDE, 9}};
    mat4_identity(voxels.world_from_voxel);
    for (size_t k = 0; k < 9; k++) {
        memset(data[k], labels[k], sizeof data[k]);
    }
    conus_atlas *atlas = NULL;
    const conus_create_options options = {.labels_anyway = true}; /* slabs look like an image's ramp */
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, &options));
    return atlas;
}

static void check_slab(const conus_atlas *atlas, conus_engine engine, double fraction, uint32_t planes)
{
    const conus_selector_options options = {.engine = engine,
                                            .sampling = CONUS_SAMPLING_SLICES,
                                            .slices = 10,
                                            .slice_fraction = fraction,
                                            .radius = 3}; /* a cylinder: all rays go straight on */
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    double depth = 9.0 / (2 * planes);
    assert_gl(conus_selector_create(&selector, atlas, &options));
    assert_ok(conus_pose_along(&pose, (double[]){15.3, 15.4, -20.5}, (double[]){0, 0, 1}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 0));
    const conus_result *first = conus_selection_result(selection, 0);
    assert_int_equal(first->object, 1 + (uint32_t)depth);
    assert_true(first->share == 1);
    assert_near(first->distance, 20 + depth, 1e-9);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
}

static void check_slabs(conus_engine engine)
{
    conus_atlas *atlas = nine_slabs();
    check_slab(atlas, engine, 0, 2); /* the paper's fifth */
    check_slab(atlas, engine, 0.2, 2);
    check_slab(atlas, engine, 0.1, 1);
    check_slab(atlas, engine, 0.05, 1); /* at least one */
    check_slab(atlas, engine, 0.3, 3);
    check_slab(atlas, engine, 0.7, 7);
    check_slab(atlas, engine, 1, 10);
    conus_atlas_destroy(atlas);
}

static void a_fraction_of_the_planes_with_rays(void **state)
{
    (void)state;
    check_slabs(CONUS_ENGINE_RAYS);
}

static void a_fraction_of_the_planes_with_gl(void **state)
{
    (void)state;
    check_slabs(CONUS_ENGINE_GL);
}

static void assert_refused(const conus_atlas *atlas, conus_sampling sampling, double fraction, const char *message)
{
    const conus_selector_options options = {.sampling = sampling, .slice_fraction = fraction};
    conus_selector *selector = NULL;
    assert_int_equal(conus_selector_create(&selector, atlas, &options), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), message);
    assert_null(selector);
}

static void a_fraction_is_of_slices_and_up_to_one(void **state)
{
    (void)state;
    conus_atlas *atlas = nine_slabs();
    assert_refused(atlas, CONUS_SAMPLING_EXACT, 0.5, "slice_fraction: 0.5 with exact sampling, which has no slices");
    assert_refused(atlas, CONUS_SAMPLING_SLICES, 1.25,
                   "slice_fraction: 1.25, allowed is more than 0 to 1 (0 = a fifth)");
    assert_refused(atlas, CONUS_SAMPLING_SLICES, -1, "slice_fraction: -1, allowed is more than 0 to 1 (0 = a fifth)");
    assert_refused(atlas, CONUS_SAMPLING_SLICES, NAN, "slice_fraction: nan, allowed is more than 0 to 1 (0 = a fifth)");
    conus_selector *selector = NULL;
    assert_fails(conus_selector_create(&selector, atlas, &(conus_selector_options){.slices = 5}), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "slices: 5 with exact sampling, which has none");
    conus_atlas_destroy(atlas);
}

TEST_GROUP(sampling)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(aal_on_planes),
        cmocka_unit_test(thin_tubes_on_planes),
        cmocka_unit_test(a_fraction_of_the_planes_with_rays),
        cmocka_unit_test(a_fraction_of_the_planes_with_gl),
        cmocka_unit_test(a_fraction_is_of_slices_and_up_to_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
