/* SPDX-License-Identifier: BSD-3-Clause */
/* Several objects of one scalar volume, by bands of its values (Eq. 6). */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "gl_pair.h"
#include "shells.h"
#include "test.h"
#include "test_gl.h"

#include "conus/own.h"

#include <math.h>
#include <string.h>

enum { DIM = SHELLS_DIM, RANDOM_DIM = 14 };

static void bands_are_objects_of_one_volume(void **state)
{
    (void)state;
    static const double outside[] = {8, 14, 20};
    conus_atlas *atlas = shells_atlas();
    uint64_t count[4] = {0};
    for (size_t v = 0; v < DIM * DIM * DIM; v++) {
        const size_t at[3] = {v % DIM, v / DIM % DIM, v / DIM / DIM};
        count[shell_of(at)]++;
        assert_int_equal(volume_object(&atlas->volumes[0], v), shell_of(at));
    }
    assert_int_equal(conus_atlas_volume_count(atlas), 1);
    assert_int_equal(conus_atlas_object_count(atlas), 3);
    for (uint32_t n = CORE; n <= OUTER; n++) {
        const conus_object *object = conus_atlas_object(atlas, n);
        double inner = n > CORE ? outside[n - 2] : 0;
        double ball = 4 * MATH3_PI / 3 * (pow(outside[n - 1], 3) - pow(inner, 3));
        assert_string_equal(object->name, shells[n - 1].name);
        assert_true(object->is_band && object->kind == CONUS_KIND_PATHWAY && object->label == n);
        assert_true(object->low == shells[n - 1].low && object->high == shells[n - 1].high && object->volume == 0);
        assert_int_equal(object->voxels, count[n]);
        assert_near(object->volume_mm3 / ball, 1, 0.02); /* volume of a shell: 4 pi / 3 (R^3 - r^3) */
    }
    conus_atlas_destroy(atlas);
}

/* Skips the test if there is no GL. */
static conus_selector *make_selector(const conus_atlas *atlas, const conus_selector_options *options)
{
    conus_selector *selector = NULL;
    assert_gl(conus_selector_create(&selector, atlas, options));
    return selector;
}

static const conus_result *result_of(const conus_selection *selection, uint32_t object)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        if (conus_selection_result(selection, i)->object == object) {
            return conus_selection_result(selection, i);
        }
    }
    fail_msg("object %u has no result", object);
    return NULL;
}

/* A thin cylinder along z in column (i, j): its rays cross the cells of that column only, each for 1 mm. */
static void check_column(const conus_atlas *atlas, conus_engine engine, size_t i, size_t j)
{
    const conus_selector_options options = {
        .engine = engine, .layers = CONUS_LAYERS_ALL, .resolution = 4, .radius = 0.25};
    conus_selector *selector = make_selector(atlas, &options);
    conus_selection *selection = NULL;
    conus_pose pose;
    const double from[3] = {(double)i - (DIM - 1) / 2.0, (double)j - (DIM - 1) / 2.0, -50};
    assert_ok(conus_pose_along(&pose, from, (double[]){0, 0, 1}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, 0));
    double path[4] = {0};
    double entry[4] = {0};
    uint32_t first = 0;
    for (size_t k = 0; k < DIM; k++) {
        uint32_t object = shell_of((size_t[]){i, j, k});
        entry[object] = path[object] > 0 ? entry[object] : 50 + (double)k - DIM / 2.0;
        path[object] += 1;
        first = first ? first : object;
    }
    for (uint32_t n = CORE; n <= OUTER; n++) {
        if (path[n] > 0) {
            const conus_result *result = result_of(selection, n);
            assert_near(result->path, path[n], 1e-9);
            assert_near(result->entry, entry[n], 1e-9);
            assert_true(result->share == (n == first ? 1 : 0));
        }
    }
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
}

static void check_columns(conus_engine engine)
{
    conus_atlas *atlas = shells_atlas();
    check_column(atlas, engine, 31, 31); /* Outer, Middle, Core, Middle, Outer */
    check_column(atlas, engine, 31, 42); /* Outer, Middle, Outer */
    check_column(atlas, engine, 20, 45); /* Outer */
    conus_atlas_destroy(atlas);
}

static void paths_are_those_of_shells(void **state)
{
    (void)state;
    check_columns(CONUS_ENGINE_RAYS);
}

static void paths_are_those_of_shells_with_gl(void **state)
{
    (void)state;
    check_columns(CONUS_ENGINE_GL);
}

/* A ball of radius R at the distance D fills the cone of half angle asin(R / D), and so has this share of a cone with
 * the half angle h. */
static double share_of_ball(double radius, double distance, double h)
{
    return (1 - cos(asin(radius / distance))) / (1 - cos(h));
}

/* No point of a cell is farther than e = sqrt(3) / 2 from its centre. So the cells whose centres are in a ball of
 * radius R lie in a ball of R + e and cover one of R - e, and their shares are between those; 128 x 128 pixels add less
 * than 1 %. With some shells hidden, another one is outermost. All 110 planes, 1 mm apart at most, lose no more than
 * the cells' corners. */
static void check_share(conus_engine engine, conus_sampling sampling, double fraction, const char *hide, double radius,
                        uint32_t object)
{
    enum { D = 120 };
    const conus_selector_options options = {
        .engine = engine, .sampling = sampling, .slice_fraction = fraction, .resolution = 128};
    conus_atlas *atlas = shells_atlas();
    conus_selection *selection = NULL;
    conus_pose pose;
    double h = radians_from_degrees(15);
    if (hide) {
        assert_ok(conus_atlas_show(atlas, NULL, hide));
    }
    conus_selector *selector = make_selector(atlas, &options);
    assert_ok(conus_pose_toward(&pose, (double[]){0.6 * D, 0, 0.8 * D}, (double[]){0, 0, 0}, NULL));
    assert_ok(conus_select(&selection, selector, &pose, degrees_from_radians(2 * h)));
    double share = result_of(selection, object)->share;
    double e = sqrt(3) / 2;
    assert_true(share > 0.99 * share_of_ball(radius - e, D, h));
    assert_true(share < 1.01 * share_of_ball(radius + e, D, h));
    assert_int_equal(conus_selection_count(selection), 2); /* and the rest of the cone */
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void check_shares(conus_engine engine)
{
    check_share(engine, CONUS_SAMPLING_EXACT, 0, NULL, 20, OUTER);
    check_share(engine, CONUS_SAMPLING_EXACT, 0, "Outer", 14, MIDDLE);
    check_share(engine, CONUS_SAMPLING_EXACT, 0, "Outer,Middle", 8, CORE);
    check_share(engine, CONUS_SAMPLING_SLICES, 1, NULL, 20, OUTER);
}

static void shares_are_those_of_balls(void **state)
{
    (void)state;
    check_shares(CONUS_ENGINE_RAYS);
}

static void shares_are_those_of_balls_with_gl(void **state)
{
    (void)state;
    check_shares(CONUS_ENGINE_GL);
}

/* One row of voxels of 2 mm with these values, at y = z = 0. */
static conus_status add_row(conus_atlas *atlas, const float *values, size_t count, const conus_band *bands,
                            size_t band_count)
{
    conus_voxels voxels = {.data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {count, 1, 1}, .name = "row"};
    const conus_pathway_options options = {.bands = bands, .band_count = band_count};
    mat4_identity(voxels.world_from_voxel);
    voxels.world_from_voxel[0] = 2;
    return conus_atlas_add_pathway_voxels(atlas, &voxels, &options);
}

static conus_atlas *make_empty(void)
{
    conus_atlas *atlas = NULL;
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    return atlas;
}

/* Adjacent bands share an end without a gap or a common voxel; 0.1 is another number as a float. */
static void ends_belong_to_the_upper_band(void **state)
{
    (void)state;
    static const float row[] = {-3, 0.1F, 0.1F, NAN, 0, INFINITY, 5, -1, 7};
    static const uint32_t wanted[] = {3, 1, 1, 0, 2, 0, 1, 2, 4};
    static const conus_band bands[] = {
        {0.1, 7, "High"}, {-1, 0.1, "Middle"}, {-INFINITY, -1, "Low"}, {7, INFINITY, "Highest"}};
    conus_atlas *atlas = make_empty();
    assert_ok(add_row(atlas, row, 9, bands, 4));
    for (size_t v = 0; v < 9; v++) {
        assert_int_equal(volume_object(&atlas->volumes[0], v), wanted[v]);
    }
    assert_near(conus_atlas_volume(atlas, 0)->minimum, -3, 0); /* least of the values that are numbers */
    assert_near(conus_atlas_volume(atlas, 0)->maximum, 7, 0);
    assert_int_equal(conus_atlas_note_count(atlas), 1);
    assert_string_equal(conus_atlas_note(atlas, 0),
                        "row: 2 voxels are not finite numbers (or beyond float32) and belong to nothing");
    conus_atlas_destroy(atlas);
}

/* In a ball around all: voxels at x = 0, 2, 4, 6 have -8, -2, -2, -3. Mean -15 / 4, largest -2, centroid (0 + 2 + 4 +
 * 6) / 4 = 3: weighted by value it would be (0 - 4 - 8 - 18) / -15 = 2. */
static void values_may_be_negative(void **state)
{
    (void)state;
    static const float row[] = {-8, -2, -2, -3, 9};
    static const conus_band bands[] = {{-INFINITY, 0, "Below"}};
    conus_atlas *atlas = make_empty();
    conus_selection *selection = NULL;
    assert_ok(add_row(atlas, row, 5, bands, 1));
    conus_selector *selector = make_selector(atlas, &(conus_selector_options){0});
    assert_ok(conus_select_ball(&selection, selector, (double[]){4, 0, 0}, 30));
    const conus_result *result = result_of(selection, 1);
    assert_int_equal(result->voxels, 4);
    assert_near(result->mean_value, -15.0 / 4, 1e-12);
    assert_near(result->max_value, -2, 0);
    assert_near(result->centroid[0], 3, 1e-12);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static void what_looks_wrong_is_noted(void **state)
{
    (void)state;
    static const float row[] = {1, 2, 5};
    static const conus_band bands[] = {{3, 4, "Gap"}, {4, 5, "Top"}, {1, 3, "Fine"}};
    conus_atlas *atlas = make_empty();
    assert_ok(add_row(atlas, row, 3, bands, 3));
    assert_int_equal(conus_atlas_note_count(atlas), 2);
    assert_string_equal(conus_atlas_note(atlas, 0), "pathway Gap: no voxel has a value from 3 to below 4");
    assert_string_equal(conus_atlas_note(atlas, 1), "pathway Top: no voxel has a value from 4 to below 5");
    conus_atlas_destroy(atlas);
    atlas = make_empty();
    assert_ok(add_row(atlas, row, 3, (conus_band[]){{2, 5, "Two"}}, 1));
    assert_string_equal(conus_atlas_note(atlas, 0),
                        "pathway Two: values are below 5, the largest of the volume, whose voxels are not in it; "
                        "without an upper end they are");
    conus_atlas_destroy(atlas);
}

static void what_is_no_band_is_refused(void **state)
{
    (void)state;
    static const struct {
        conus_band bands[2];
        const char *message;
    } cases[] = {
        {{{1, 2, "A"}, {1.5, 3, "B"}}, "row: the bands A (from 1 to below 2) and B (from 1.5 to below 3) overlap"},
        {{{2, 3, "A"}, {-INFINITY, INFINITY, "B"}}, "row: the bands B (all values) and A (from 2 to below 3) overlap"},
        {{{1, 2, "A"}, {2, 3, "A"}}, "row: two bands are called A"},
        {{{1, 2, "A"}, {2, 3, "Old"}}, "row: band Old: another pathway has that name"},
        {{{1, 2, "A"}, {2, 3, ""}}, "row: the band from 2 to below 3 has no name"},
        {{{1, 2, "A"}, {2, 3, NULL}}, "row: the band from 2 to below 3 has no name"},
        {{{1, 2, "A"}, {3, 2, "B"}}, "row: band B: from 3 to below 2 holds no value, the first is to be less"},
        {{{1, 2, "A"}, {2, 2, "B"}}, "row: band B: from 2 to below 2 holds no value, the first is to be less"},
        {{{1, 2, "A"}, {NAN, 2, "B"}}, "row: band B: from nan to below 2 holds no value, the first is to be less"},
        {{{1, 2, "A"}, {2, NAN, "B"}}, "row: band B: from 2 to below nan holds no value, the first is to be less"},
        {{{1, 2, "A"}, {5.5, INFINITY, "B"}}, "row: band B: from 5.5 on, the values are from 1 to 5"},
        {{{1, 2, "A"}, {-INFINITY, 1, "B"}}, "row: band B: below 1, the values are from 1 to 5"},
    };
    static const float row[] = {1, 2, 5};
    conus_atlas *atlas = make_empty();
    assert_ok(add_row(atlas, row, 3, (conus_band[]){{1, INFINITY, "Old"}}, 1));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(add_row(atlas, row, 3, cases[i].bands, 2), CONUS_ERROR_ARGUMENT);
        assert_string_equal(conus_message(), cases[i].message);
        assert_int_equal(conus_atlas_object_count(atlas), 1);
        assert_int_equal(conus_atlas_volume_count(atlas), 1);
    }
    assert_int_equal(conus_atlas_set_threshold(atlas, 1, 2), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "Old: a band of values has no threshold");
    assert_int_equal(add_row(atlas, (const float[]){NAN, NAN}, 2, cases[0].bands, 1), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "row: no voxel has a finite value");
    conus_atlas_destroy(atlas);
}

static conus_atlas *random_bands(uint64_t *random, size_t bands)
{
    static float values[RANDOM_DIM * RANDOM_DIM * RANDOM_DIM];
    static const char *const names[] = {"A", "B", "C", "D", "E"};
    conus_voxels voxels = {
        .data = values, .type = CONUS_SCALAR_FLOAT32, .dim = {RANDOM_DIM, RANDOM_DIM, RANDOM_DIM}, .name = "random"};
    conus_band list[5];
    conus_atlas *atlas = make_empty();
    for (size_t v = 0; v < sizeof values / sizeof values[0]; v++) {
        values[v] = (float)floor(test_random(random, 0, 200)) / 10;
    }
    for (size_t i = 0; i < bands; i++) { /* from 17.5 down, so that most voxels are in none */
        list[i] = (conus_band){17 - (double)i, 17.5 - (double)i, names[i]};
    }
    mat4_identity(voxels.world_from_voxel);
    const conus_pathway_options options = {.bands = list, .band_count = bands};
    assert_ok(conus_atlas_add_pathway_voxels(atlas, &voxels, &options));
    return atlas;
}

static struct cone random_cone(uint64_t *random)
{
    struct cone cone = {.angle = test_random(random, 0.1, 1), .resolution = 14};
    double from[3];
    double to[3];
    for (size_t a = 0; a < 3; a++) {
        from[a] = test_random(random, -30, 45);
        to[a] = test_random(random, 3, 10);
    }
    assert_ok(conus_pose_toward(&cone.pose, from, to, NULL));
    return cone;
}

static void both_engines_see_bands_alike(void **state)
{
    (void)state;
    uint64_t random = 606;
    size_t hits = 0;
    for (int scene = 0; scene < 24; scene++) {
        conus_sampling sampling = scene % 2 ? CONUS_SAMPLING_SLICES : CONUS_SAMPLING_EXACT;
        conus_atlas *atlas = random_bands(&random, 1 + (size_t)scene % 5);
        if (scene % 3 == 2 && scene % 5 > 1) {
            assert_ok(conus_atlas_show(atlas, NULL, "B"));
        }
        struct gl_pair pair = gl_pair_create_slices(atlas, sampling, 0, scene % 4 / 3.0);
        for (int pose = 0; pose < 8; pose++) {
            struct cone cone = random_cone(&random);
            hits += gl_pair_same_hits(&pair, &cone);
        }
        gl_pair_destroy(&pair);
        conus_atlas_destroy(atlas);
    }
    assert_true(hits > 5000);
}

/* Asserts the voxels of the objects that are shown. */
static void check_hidden(const conus_atlas *atlas, const uint16_t *before, const bool *hidden)
{
    const struct volume *volume = &atlas->volumes[0];
    bool some = false;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        assert_int_equal(volume_object(volume, v), hidden[before[v]] ? 0 : before[v]);
        some = some || (before[v] && !hidden[before[v]]);
    }
    assert_int_equal(volume_can_be_hit(volume), some);
}

static void bands_are_hidden_one_by_one(void **state)
{
    (void)state;
    uint64_t random = 707;
    conus_atlas *atlas = random_bands(&random, 3);
    const struct volume *volume = &atlas->volumes[0];
    uint16_t *before = memory_raw(volume->voxel_count, sizeof *before);
    for (size_t v = 0; v < volume->voxel_count; v++) {
        before[v] = (uint16_t)volume_object(volume, v);
    }
    for (unsigned bits = 0; bits < 16; bits++) { /* each set after its forerunner, and all shown at the end */
        const bool hidden[4] = {false, bits & 1, bits & 2, bits & 4};
        assert_ok(conus_atlas_set_hidden(atlas, bits < 8 ? hidden : NULL));
        check_hidden(atlas, before, bits < 8 ? hidden : (const bool[4]){false});
    }
    memory_free(before);
    conus_atlas_destroy(atlas);
}

/* Splitting the two areas of a parcellation makes them four: the bands' numbers move by two, their voxels stay. */
static void bands_stay_when_areas_change(void **state)
{
    (void)state;
    static const uint8_t labels[4] = {1, 2, 1, 2};
    static const float row[] = {1, 2, 3, 4};
    static const conus_band bands[] = {{1, 3, "Low"}, {3, INFINITY, "High"}};
    conus_voxels voxels = {.data = labels, .type = CONUS_SCALAR_UINT8, .dim = {4, 1, 1}};
    conus_atlas *atlas = NULL;
    mat4_identity(voxels.world_from_voxel);
    voxels.world_from_voxel[12] = -1.5; /* two voxels on each side of x = 0 */
    assert_ok(conus_atlas_create(&atlas, &voxels, NULL, 0, &(conus_create_options){.labels_anyway = true}));
    assert_ok(add_row(atlas, row, 4, bands, 2));
    assert_int_equal(atlas->area_count, 2);
    assert_ok(conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT));
    assert_int_equal(atlas->area_count, 4);
    for (size_t v = 0; v < 4; v++) {
        assert_int_equal(volume_object(&atlas->volumes[1], v), atlas->area_count + (v < 2 ? 1 : 2));
    }
    assert_string_equal(conus_atlas_object(atlas, atlas->area_count + 2)->name, "High");
    conus_atlas_destroy(atlas);
}

static conus_status make_and_hide(void *data)
{
    static const float row[] = {1, 2, NAN, 4};
    static const conus_band bands[] = {{1, 2, "Low"}, {2, 4, "Middle"}, {4, INFINITY, "High"}};
    conus_atlas *atlas = NULL;
    (void)data;
    conus_status status = conus_atlas_create(&atlas, NULL, NULL, 0, NULL);
    if (!status) {
        status = add_row(atlas, row, 4, bands, 3);
        assert_int_equal(conus_atlas_object_count(atlas), status ? 0 : 3); /* all or none */
        assert_int_equal(conus_atlas_volume_count(atlas), status ? 0 : 1);
        assert_true(!status || conus_atlas_note_count(atlas) == 0);
    }
    status = status ? status : conus_atlas_show(atlas, NULL, "Middle");
    status = status ? status : conus_atlas_show(atlas, "Middle", NULL);
    conus_atlas_destroy(atlas);
    return status;
}

static void every_failing_allocation_is_reported(void **state)
{
    (void)state;
    test_every_allocation(make_and_hide, NULL);
    assert_true(test_every_primitive(make_and_hide, NULL) > 3);
}

TEST_GROUP(bands)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bands_are_objects_of_one_volume),
        cmocka_unit_test(paths_are_those_of_shells),
        cmocka_unit_test(paths_are_those_of_shells_with_gl),
        cmocka_unit_test(shares_are_those_of_balls),
        cmocka_unit_test(shares_are_those_of_balls_with_gl),
        cmocka_unit_test(ends_belong_to_the_upper_band),
        cmocka_unit_test(values_may_be_negative),
        cmocka_unit_test(what_looks_wrong_is_noted),
        cmocka_unit_test(what_is_no_band_is_refused),
        cmocka_unit_test(both_engines_see_bands_alike),
        cmocka_unit_test(bands_are_hidden_one_by_one),
        cmocka_unit_test(bands_stay_when_areas_change),
        cmocka_unit_test(every_failing_allocation_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
