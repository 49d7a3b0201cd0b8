/* SPDX-License-Identifier: BSD-3-Clause */
/* Streamlines in regions (Eq. 19): by the tree against every segment one by one, to the bit; the measures of bundles in
 * closed form; groups, hiding, directions; every failing allocation. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "selection/measure/measure.h"
#include "selection/region/region.h"
#include "test.h"
#include "tract_scene.h"

#include <string.h>

/* Walks with steps of 1 mm that turn a little at each, of 1 to 150 points; some of no point, and some that do not
 * move. */
static void build_walks(struct tract_builder *builder, uint64_t *seed, size_t count)
{
    tract_begin(builder);
    for (size_t k = 0; k < count; k++) {
        size_t points = k % 20 == 3 ? k % 3 : (size_t)test_random(seed, 2, 150);
        double at[3], way[3];
        for (int a = 0; a < 3; a++) {
            at[a] = test_random(seed, -60, 60);
            way[a] = test_random(seed, -1, 1);
        }
        for (size_t i = 0; i < points; i++) {
            tract_add_point(builder, at);
            for (int a = 0; a < 3; a++) {
                way[a] += test_random(seed, -0.2, 0.2);
            }
            assert_true(vec3_normalise(way, way));
            vec3_add_scaled(at, at, k % 20 == 7 ? 0 : 1, way);
        }
        tract_end_streamline(builder);
    }
}

/* Two groups that share streamlines; some are in none. */
static conus_atlas *walks_atlas(uint64_t *seed, size_t count, bool with_groups)
{
    conus_atlas *atlas = NULL;
    struct tract_builder builder;
    uint32_t *members = memory_raw(count, sizeof *members);
    assert_non_null(members);
    build_walks(&builder, seed, count);
    for (uint32_t step = 2; with_groups && step <= 3; step++) {
        size_t listed = 0;
        for (uint32_t k = 0; k < count; k += step) {
            members[listed++] = k;
        }
        tract_add_group(&builder.made, step == 2 ? "second" : "third", members, listed);
    }
    memory_free(members);
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "walks"));
    return atlas;
}

static bool is_member(const conus_atlas *atlas, uint32_t number, uint32_t k)
{
    const struct tract_group *group = atlas_bundle_group(atlas, number);
    bool found = !group;
    for (size_t i = 0; group && i < group->count; i++) {
        found = found || group->members[i] == k;
    }
    return found;
}

/* Adds one segment, in the units of parts, and finds its point nearest to the origin. */
static bool add_segment(struct tract_part *sum, const struct region *region, const struct tractogram *tractogram,
                        uint64_t point, uint64_t next)
{
    double ends[2][3], s[2], step[3], nearest[3];
    tractogram_point(ends[0], tractogram, point);
    tractogram_point(ends[1], tractogram, next);
    const bool inside[2] = {region_has(region, ends[0]), region_has(region, ends[1])};
    if (!region_segment(s, region, ends, inside)) {
        return false;
    }
    vec3_sub(step, ends[1], ends[0]);
    sum->parts += (uint64_t)(vec3_length(step) * (s[1] - s[0]) * 0x1p40 + 0.5);
    vec3_sub(nearest, region->origin, ends[0]);
    double square = vec3_dot(step, step);
    double t = square > 0 ? vec3_dot(nearest, step) / square : 0;
    t = t < s[0] ? s[0] : t > s[1] ? s[1] : t;
    vec3_add_scaled(nearest, ends[0], t, step);
    vec3_sub(step, nearest, region->origin);
    if (vec3_length(step) < sqrt(sum->square) - 1e-9) {
        sum->square = vec3_dot(step, step);
    }
    return true;
}

static struct tract_part count_one_by_one(const conus_atlas *atlas, uint32_t number, const struct region *region)
{
    const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
    struct tract_part sum = {.square = INFINITY};
    for (uint32_t k = 0; k < tractogram->streamline_count; k++) {
        uint64_t first = tractogram->first[k];
        uint64_t end = tractogram->first[k + 1];
        bool in = false;
        if (is_member(atlas, number, k) && first < end) {
            for (uint64_t i = first; i + 1 < end || i == first; i++) {
                in = add_segment(&sum, region, tractogram, i, i + 1 < end ? i + 1 : i) || in;
            }
        }
        sum.streamlines += in;
    }
    return sum;
}

static struct region random_region(uint64_t *seed, int shape)
{
    struct cone cone = {.resolution = 16};
    struct region region;
    double origin[3], direction[3];
    for (int a = 0; a < 3; a++) {
        origin[a] = test_random(seed, -70, 70);
        direction[a] = test_random(seed, -1, 1);
    }
    if (shape == 0) {
        region_ball(&region, origin, pow(10, test_random(seed, -1, 1.7)));
        return region;
    }
    assert_ok(conus_pose_along(&cone.pose, origin, direction, NULL));
    cone.aperture = shape % 4 == 3 ? CONUS_APERTURE_SQUARE : CONUS_APERTURE_CIRCLE;
    cone.angle = shape % 2 ? radians_from_degrees(test_random(seed, 0.5, 100)) : 0;
    cone.radius = shape % 2 ? 0 : pow(10, test_random(seed, -1, 1.3));
    cone.range[0] = shape > 2 ? test_random(seed, 0, 40) : 0;
    cone.range[1] = shape > 2 ? cone.range[0] + test_random(seed, 0, 60) : 0;
    region_from_cone(&region, &cone);
    return region;
}

static void check_part(const struct tract_part *part, const struct tract_part *wanted, const struct region *region)
{
    double away[3];
    assert_int_equal(part->streamlines, wanted->streamlines);
    assert_true(part->whole_mm == wanted->parts >> 40);
    assert_true(part->parts == (wanted->parts & (((uint64_t)1 << 40) - 1)));
    assert_near(sqrt(part->square), sqrt(wanted->square), 1e-9);
    vec3_sub(away, part->near, region->origin);
    assert_near(vec3_length(away), sqrt(part->square), 1e-9);
}

static void check_list(const conus_atlas *atlas, uint32_t number, const struct region *region, size_t wanted)
{
    uint32_t *list = NULL;
    size_t count = 0;
    assert_ok(tract_census_list(&list, &count, atlas, number, region));
    assert_int_equal(count, wanted);
    for (size_t i = 0; i < count; i++) {
        assert_true(is_member(atlas, number, list[i]) && (i == 0 || list[i] > list[i - 1]));
    }
    memory_free(list);
}

/* Tries every region with one census, which has to forget the last one; one bundle of two is hidden in the second
 * half. */
static void check_regions(const conus_atlas *atlas, uint64_t *seed, int regions, size_t found[2])
{
    struct tract_census census = {0};
    struct tract_index *index = NULL;
    assert_ok(tract_index_create(&index, atlas));
    assert_ok(tract_census_prepare(&census, index, atlas));
    for (int i = 0; i < regions; i++) {
        struct region region = random_region(seed, i % 7);
        tract_census_take(&census, index, atlas, &region);
        size_t at = 0;
        for (uint32_t number = 1; number <= atlas->object_count; number++) {
            struct tract_part wanted = count_one_by_one(atlas, number, &region);
            found[wanted.streamlines > 0]++;
            if (wanted.streamlines) {
                assert_true(at < census.touched_count);
                assert_int_equal(census.touched[at++], number);
                check_part(&census.parts[number], &wanted, &region);
            }
            if (i % 10 == 0) {
                check_list(atlas, number, &region, wanted.streamlines);
            }
        }
        assert_int_equal(census.touched_count, at);
    }
    tract_census_finish(&census);
    tract_index_destroy(index);
}

static void test_tree_and_no_tree(void **state)
{
    (void)state;
    uint64_t seed = 1;
    size_t found[2] = {0};
    for (int groups = 0; groups < 2; groups++) {
        conus_atlas *atlas = walks_atlas(&seed, groups ? 70 : 200, groups);
        assert_int_equal(atlas->object_count, groups ? 3 : 1);
        check_regions(atlas, &seed, groups ? 200 : 400, found);
        conus_atlas_destroy(atlas);
    }
    print_message("%zu bundles in a region, %zu not\n", found[1], found[0]);
    assert_true(found[1] > 300 && found[0] > 100);
}

/* Result of an object in a selection with all layers; object 0 where there is none. */
static conus_result result_of(const conus_selection *selection, uint32_t number)
{
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        if (conus_selection_result(selection, i)->object == number) {
            return *conus_selection_result(selection, i);
        }
    }
    return (conus_result){0};
}

static conus_selection *selection_of(conus_selector **selector, const conus_atlas *atlas,
                                     const conus_selector_options *options, const double origin[3], double degrees)
{
    conus_selection *selection = NULL;
    conus_pose pose;
    assert_ok(conus_selector_create(selector, atlas, options));
    assert_ok(conus_pose_along(&pose, origin, (double[]){0, 0, 1}, NULL));
    assert_ok(conus_select(&selection, *selector, &pose, degrees));
    return selection;
}

/* In a cone of 60 degrees the first line has 2 * 30 tan 30 = 34.64 mm, the second, a hyperbola's chord,
 * 2 sqrt((30 tan 30)^2 - 3^2) = 34.10. The nearest point is (0, 0, 30), in the middle of the first. */
static void test_lines_in_a_cone(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    conus_selector *selector = NULL;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .score = "streamlines"};
    conus_selection *selection = selection_of(&selector, atlas, &options, (double[]){0, 0, 0}, 60);
    conus_result result = result_of(selection, 1);
    assert_near(result.score, 2 / 3.0, 1e-15);
    double rim = 30 * tan(radians_from_degrees(30));
    assert_int_equal(result.kind, CONUS_KIND_BUNDLE);
    assert_int_equal(result.streamlines, 2);
    assert_int_equal(result.streamlines_total, 3);
    assert_near(result.length, 2 * rim + 2 * sqrt(rim * rim - 9), 1e-9);
    assert_near(result.near[0], 0, 1e-12);
    assert_near(result.near[1], 0, 0);
    assert_near(result.near[2], 30, 0);
    assert_near(result.along, 0.5, 1e-12);
    assert_true(isnan(result.volume) && isnan(result.fraction));
    assert_int_equal(result_of(selection, 2).object, 0);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* A cylinder of 2 mm holds 4 mm of the second line at x = 0. The line runs from x = 70 to -30, against the longest
 * streamline, which defines the direction (Eq. 20): it is met after 70 of its 100 mm, so at 0.3. A range that ends
 * before the line holds nothing. */
static void test_directions(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    conus_selector *selector = NULL;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = 2};
    conus_selection *selection = selection_of(&selector, atlas, &options, (double[]){0, 3, 0}, 0);
    conus_result result = result_of(selection, 1);
    assert_int_equal(result.streamlines, 1);
    assert_near(result.length, 4, 1e-9);
    assert_near(result.along, 0.3, 1e-7); /* 1 - 70 / 100 */
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    const conus_selector_options before = {.layers = CONUS_LAYERS_ALL, .radius = 2, .range = {0, 25}};
    selection = selection_of(&selector, atlas, &before, (double[]){0, 3, 0}, 0);
    assert_int_equal(result_of(selection, 1).object, 0);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_atlas *atlas_of_lines(const double lines[][2][3], size_t count)
{
    conus_atlas *atlas = NULL;
    struct tract_builder builder;
    tract_begin(&builder);
    for (size_t k = 0; k < count; k++) {
        tract_add_point(&builder, lines[k][0]);
        if (lines[k][0][0] != lines[k][1][0]) { /* all lines here run along x */
            tract_add_point(&builder, lines[k][1]);
        }
        tract_end_streamline(&builder);
    }
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &builder.made, "lines"));
    return atlas;
}

/* Two streamlines of 100 mm in opposite directions: the first one defines the direction (Eq. 20). A device at x = 20
 * meets it after 70 of its 100 mm; the second one, met after 30 mm, is turned, so at 0.7 as well. */
static void test_first_of_equally_long_ones_leads(void **state)
{
    (void)state;
    static const double lines[2][2][3] = {{{-50, 0, 30}, {50, 0, 30}}, {{50, 3, 30}, {-50, 3, 30}}};
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = 1};
    conus_atlas *atlas = atlas_of_lines(lines, 2);
    for (int line = 0; line < 2; line++) {
        conus_selector *selector = NULL;
        conus_selection *selection = selection_of(&selector, atlas, &options, (double[]){20, 3 * line, 0}, 0);
        assert_int_equal(result_of(selection, 1).streamlines, 1);
        assert_near(result_of(selection, 1).along, 0.7, 1e-7);
        conus_selection_destroy(selection);
        conus_selector_destroy(selector);
    }
    conus_atlas_destroy(atlas);
}

/* Beside a line that leaves the ball of 5 mm there are streamlines of one point just inside and just outside, where the
 * tree's rounded boxes cannot decide: sqrt(3^2 + 3.999^2) = 4.9992, sqrt(3^2 + 4.001^2) = 5.0008. 2 of 3 streamlines, 5
 * mm. */
static void test_points_beside_a_line(void **state)
{
    (void)state;
    static const double lines[3][2][3] = {
        {{0, 0, 30}, {80, 0, 30}}, {{3, 3.999, 30}, {3, 3.999, 30}}, {{3, 4.001, 30}, {3, 4.001, 30}}};
    conus_atlas *atlas = atlas_of_lines(lines, 3);
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_select_ball(&selection, selector, (double[]){0, 0, 30}, 5));
    assert_int_equal(result_of(selection, 1).streamlines, 2);
    assert_near(result_of(selection, 1).length, 5, 1e-9);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* A streamline of length 0 has no place along it: `along` is NaN. */
static void test_along_a_point(void **state)
{
    (void)state;
    static const double lines[1][2][3] = {{{1, 0, 30}, {1, 0, 30}}};
    conus_atlas *atlas = atlas_of_lines(lines, 1);
    conus_selector *selector = NULL;
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .radius = 2};
    conus_selection *selection = selection_of(&selector, atlas, &options, (double[]){0, 0, 0}, 0);
    assert_int_equal(result_of(selection, 1).streamlines, 1);
    assert_near(result_of(selection, 1).length, 0, 0);
    assert_true(isnan(result_of(selection, 1).along));
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* A ball of 5 mm about (0, 4, 30): chords of 2 * 3 mm of the line at 4 mm and 2 sqrt(24) of that at 1 mm. */
static void test_lines_in_a_ball(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    conus_selector *selector = NULL;
    conus_selector *shared = NULL;
    conus_selection *selection = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    assert_ok(conus_selector_share(&shared, selector));
    for (int i = 0; i < 2; i++) {
        assert_ok(conus_select_ball(&selection, i ? shared : selector, (double[]){0, 4, 30}, 5));
        conus_result result = result_of(selection, 1);
        assert_int_equal(result.streamlines, 2);
        assert_near(result.length, 6 + 2 * sqrt(24), 1e-9);
        assert_near(result.distance, 1, 1e-12);
        assert_near(result.contact[1], 3, 0);
        assert_near(result.near[0], 0, 1e-6);
        assert_true(isnan(result.share) && isnan(result.volume));
        conus_selection_destroy(selection);
    }
    conus_selector_destroy(shared);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* A hidden bundle is as if it had never been loaded. */
static void test_hidden_bundles(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    conus_selector *selector = NULL;
    const bool hidden[3] = {false, true, false};
    const conus_selector_options options = {.layers = CONUS_LAYERS_ALL};
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    conus_selection *selection = selection_of(&selector, atlas, &options, (double[]){0, 0, 0}, 60);
    assert_int_equal(conus_selection_count(selection), 1);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_status attempt(void *data)
{
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    const conus_atlas *atlas = data;
    uint32_t *list = NULL;
    size_t count = 0;
    struct region region;
    region_ball(&region, (double[]){0, 4, 30}, 5);
    conus_status status = conus_selector_create(&selector, atlas, NULL);
    status = status ? status : conus_select_ball(&selection, selector, region.origin, region.radius);
    status = status ? status : tract_census_list(&list, &count, atlas, 1, &region);
    memory_free(list);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return status;
}

static void test_allocations(void **state)
{
    (void)state;
    conus_atlas *atlas = tract_lines_atlas();
    test_every_allocation(attempt, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(tract_census)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tree_and_no_tree),     cmocka_unit_test(test_lines_in_a_cone),
        cmocka_unit_test(test_directions),           cmocka_unit_test(test_first_of_equally_long_ones_leads),
        cmocka_unit_test(test_points_beside_a_line), cmocka_unit_test(test_along_a_point),
        cmocka_unit_test(test_lines_in_a_ball),      cmocka_unit_test(test_hidden_bundles),
        cmocka_unit_test(test_allocations),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
