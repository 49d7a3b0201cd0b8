/* SPDX-License-Identifier: BSD-3-Clause */
/* The value at the contact. Each voxel of a volume has another value, which follows from its index, so a value tells
 * the voxel. The wanted one is that of the voxel whose cell holds the point a thousandth of a millimetre behind the
 * contact: the contact itself lies where the ray goes from one cell into the next. */
#include "base/geometry/math3.h"
#include "conus/arrays.h"
#include "conus/selection.h"
#include "test.h"
#include "test_gl.h"

#include <math.h>
#include <string.h>

enum { DIM = 12, POSES = 60, LOW = 1, HIGH, MORE, ABOVE = 1000 };

/* Voxels of 2 mm, x to the left, one (0, 0, 0) at (11, -11, -11) mm. */
static const double world_from_voxel[16] = {-2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, DIM - 1, 1 - DIM, 1 - DIM, 1};

/* Exact as float. */
static float value_of(uint32_t object, size_t i, size_t j, size_t k)
{
    return (float)(i + DIM * (j + DIM * k)) / 4 + (object == MORE ? ABOVE : 0);
}

/* Two bands of one volume, layers k = 2 to 4, and 8 to 11, and between them one of another volume, 5 to 7.. */
static conus_atlas *make_atlas(void)
{
    static float values[DIM * DIM * DIM];
    static float more[DIM * DIM * DIM];
    static const conus_band bands[] = {{2 * DIM * DIM / 4.0, 5 * DIM * DIM / 4.0, "Low"},
                                       {8 * DIM * DIM / 4.0, INFINITY, "High"}};
    conus_voxels voxels = {.data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {DIM, DIM, DIM}, .name = "values"};
    const conus_pathway_options options = {.bands = bands, .band_count = 2};
    conus_atlas *atlas = NULL;
    memcpy(voxels.world_from_voxel, world_from_voxel, sizeof world_from_voxel);
    for (size_t v = 0; v < DIM * DIM * DIM; v++) {
        size_t k = v / DIM / DIM;
        values[v] = value_of(LOW, v % DIM, v / DIM % DIM, k);
        more[v] = k >= 5 && k < 8 ? value_of(MORE, v % DIM, v / DIM % DIM, k) : 0;
    }
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    assert_ok(conus_atlas_add_pathway_voxels(atlas, &voxels, &options));
    voxels.data = more;
    assert_ok(
        conus_atlas_add_pathway_voxels(atlas, &voxels, &(conus_pathway_options){.threshold = ABOVE, .name = "More"}));
    return atlas;
}

/* With 16 x 16 rays where none are said. Skips the test if there is no GL. */
static conus_selector *make_selector(const conus_atlas *atlas, const conus_selector_options *options)
{
    conus_selector_options of16 = options ? *options : (conus_selector_options){0};
    conus_selector *selector = NULL;
    of16.resolution = of16.resolution ? of16.resolution : 16;
    assert_gl(conus_selector_create(&selector, atlas, &of16));
    return selector;
}

/* Value of the voxel whose cell holds the point 0.001 mm behind `contact`, seen from `from`. */
static double wanted_value(uint32_t object, const double from[3], const double contact[3])
{
    size_t index[3];
    double ray[3];
    vec3_sub(ray, contact, from);
    for (size_t a = 0; a < 3; a++) {
        double point = contact[a] + 0.001 * ray[a] / vec3_length(ray);
        index[a] = (size_t)floor((point - world_from_voxel[12 + a]) / world_from_voxel[5 * a] + 0.5);
        assert_true(index[a] < DIM);
    }
    return (double)value_of(object, index[0], index[1], index[2]);
}

/* Returns the number of results with a contact. */
static size_t check_results(const conus_selection *selection, const double from[3])
{
    size_t contacts = 0;
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->object && result->pixels) {
            assert_near(result->contact_value, wanted_value(result->object, from, result->contact), 0);
            contacts++;
        } else {
            assert_true(isnan(result->contact_value));
        }
    }
    return contacts;
}

/* A pose 40 mm from the middle, towards a point inside, so that rays cross the sides of cells at all angles. */
static void random_pose(conus_pose *pose, double from[3], uint64_t *seed)
{
    double to[3];
    for (int a = 0; a < 3; a++) {
        from[a] = test_random(seed, -40, 40);
        to[a] = test_random(seed, -8, 8);
    }
    from[2] += from[2] < 0 ? -20 : 20; /* outside */
    assert_ok(conus_pose_toward(pose, from, to, NULL));
}

static void check_poses(const conus_selector_options *options)
{
    conus_atlas *atlas = make_atlas();
    conus_selector *selector = make_selector(atlas, options);
    uint64_t seed = 42;
    size_t contacts = 0;
    for (int i = 0; i < POSES; i++) {
        conus_selection *selection = NULL;
        conus_pose pose;
        double from[3];
        random_pose(&pose, from, &seed);
        assert_ok(conus_select(&selection, selector, &pose, 12));
        contacts += check_results(selection, from);
        conus_selection_destroy(selection);
    }
    assert_true(contacts > POSES);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void check_engine(conus_engine engine)
{
    check_poses(&(conus_selector_options){.engine = engine});
    check_poses(&(conus_selector_options){.engine = engine, .sampling = CONUS_SAMPLING_SLICES, .slice_fraction = 1});
    check_poses(&(conus_selector_options){.engine = engine, .layers = CONUS_LAYERS_ALL});
    check_poses(&(conus_selector_options){.engine = engine, .range = {50, 100}}); /* often begins within */
}

static void it_is_that_of_the_voxel_hit(void **state)
{
    (void)state;
    check_engine(CONUS_ENGINE_RAYS);
}

static void it_is_that_of_the_voxel_hit_with_gl(void **state)
{
    (void)state;
    check_engine(CONUS_ENGINE_GL);
}

/* One ray along z through column (3, 5), from z = -50. Layer k begins at z = 2k - 12. The range begins in layer 3, at
 * the border of 3 and 4, and where layer 4, the last, ends: then the interval is a point, which touches 4. */
static void a_range_begins_in_another_voxel(void **state)
{
    (void)state;
    static const struct {
        double near;
        size_t k;
    } cases[] = {{45, 3}, {46, 4}, {47, 4}, {48, 4}};
    conus_atlas *atlas = make_atlas();
    conus_pose pose;
    const double from[3] = {DIM - 1 - 6, 1 - DIM + 10, -50};
    assert_ok(conus_pose_along(&pose, from, (double[]){0, 0, 1}, NULL));
    for (size_t c = 0; c < sizeof cases / sizeof cases[0]; c++) {
        const conus_selector_options options = {.resolution = 1, .radius = 0.1, .range = {cases[c].near, 50}};
        conus_selector *selector = make_selector(atlas, &options);
        conus_selection *selection = NULL;
        assert_ok(conus_select(&selection, selector, &pose, 0));
        const conus_result *result = conus_selection_result(selection, 0);
        assert_int_equal(result->object, 1);
        assert_near(result->contact[2], cases[c].near - 50, 1e-9);
        assert_near(result->contact_value, (double)value_of(LOW, 3, 5, cases[c].k), 0);
        conus_selection_destroy(selection);
        conus_selector_destroy(selector);
    }
    conus_atlas_destroy(atlas);
}

/* In voxel (3, 5, 4), 0.5 mm from its centre towards k = 5: Low is there, the nearest cell of More is (3, 5, 5) and
 * that of High (3, 5, 8), which begins at z = 4. */
static void a_ball_has_the_nearest_cell(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    conus_selector *selector = make_selector(atlas, NULL);
    conus_selection *selection = NULL;
    const double at[3] = {DIM - 1 - 6, 1 - DIM + 10, 1 - DIM + 8.5};
    assert_ok(conus_select_ball(&selection, selector, at, 8));
    assert_int_equal(conus_selection_count(selection), 3);
    for (size_t i = 0; i < 3; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        const size_t wanted[] = {[LOW] = 4, [HIGH] = 8, [MORE] = 5};
        assert_near(result->contact_value, (double)value_of(result->object, 3, 5, wanted[result->object]), 0);
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* Areas of a parcellation have no values, whatever pathways lie behind them; nor has a tracked object without a hit. */
static void labels_have_none(void **state)
{
    (void)state;
    static const uint8_t one[8] = {1, 1, 1, 1, 1, 1, 1, 1};
    conus_voxels voxels = {.data = one, .type = CONUS_SCALAR_UINT8, .dim = {2, 2, 2}, .name = "one"};
    conus_atlas *atlas = NULL;
    conus_selection *selection = NULL;
    conus_pose pose;
    mat4_identity(voxels.world_from_voxel);
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, NULL));
    conus_selector *selector = make_selector(atlas, NULL);
    assert_ok(conus_pose_toward(&pose, (double[]){0.5, 0.5, -9}, (double[]){0.5, 0.5, 0}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(0.1)));
    assert_int_equal(conus_selection_result(selection, 0)->object, 1);
    assert_true(isnan(conus_selection_result(selection, 0)->contact_value));
    conus_selection_destroy(selection);
    selection = NULL;
    assert_ok(conus_select_ball(&selection, selector, (double[]){0.5, 0.5, 0.5}, 1));
    assert_true(isnan(conus_selection_result(selection, 0)->contact_value));
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(contact_value)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_is_that_of_the_voxel_hit),
        cmocka_unit_test(it_is_that_of_the_voxel_hit_with_gl),
        cmocka_unit_test(a_range_begins_in_another_voxel),
        cmocka_unit_test(a_ball_has_the_nearest_cell),
        cmocka_unit_test(labels_have_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
