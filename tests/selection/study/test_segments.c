/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 17: the segments of an axis. Volumes against a walk along sorted plane crossings; surfaces in closed form. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "mesh_scene.h"
#include "scene.h"
#include "selection/selection.h"
#include "selection/study/study.h"
#include "tables.h"
#include "test.h"
#include "test_gl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROW_LIMIT = 4096 };

static conus_table *follow(const conus_atlas *atlas, const conus_selector_options *options, const conus_pose *pose)
{
    conus_selector *selector = NULL;
    conus_table *segments = NULL;
    assert_ok(conus_selector_create(&selector, atlas, options));
    assert_ok(conus_segments(&segments, selector, pose));
    conus_selector_destroy(selector);
    return segments;
}

static conus_pose along(double x, double y, double z, double dx, double dy, double dz)
{
    conus_pose pose;
    assert_ok(conus_pose_along(&pose, (const double[]){x, y, z}, (const double[]){dx, dy, dz}, NULL));
    return pose;
}

struct wanted {
    uint32_t object;
    double entry, exit;
};

static struct wanted row_at(const conus_table *segments, size_t i)
{
    return (struct wanted){conus_table_objects(segments)[i], table_number_at(segments, "entry_mm", i),
                           table_number_at(segments, "exit_mm", i)};
}

/* Asserts the rows, all of them and in this order. Ends the segments. */
static void check_rows(conus_table *segments, const struct wanted *wanted, size_t count, double tolerance)
{
    assert_int_equal(conus_table_rows(segments), count);
    for (size_t i = 0; i < count; i++) {
        const struct wanted row = row_at(segments, i);
        assert_int_equal(row.object, wanted[i].object);
        assert_int_equal(strcmp(table_text_at(segments, "kind", i), "unassigned") == 0, wanted[i].object == 0);
        assert_int_equal(table_count_at(segments, "order", i), i + 1);
        assert_near(row.entry, wanted[i].entry, tolerance);
        if (isfinite(wanted[i].exit)) {
            assert_near(row.exit, wanted[i].exit, tolerance);
            assert_true(table_number_at(segments, "length_mm", i) == row.exit - row.entry);
        } else {
            assert_true(row.exit == INFINITY);
        }
    }
    conus_table_destroy(segments);
}

#define CHECK_ROWS(segments, wanted, tolerance)                                                                        \
    check_rows(segments, wanted, sizeof(wanted) / sizeof(wanted)[0], tolerance)

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* All crossings of an axis with the planes between a volume's cells, sorted, from 0 to beyond the last one. */
static size_t cross_planes(double *out, const struct volume *volume, const double start[3], const double step[3])
{
    size_t count = 0;
    out[count++] = 0;
    for (int a = 0; a < 3; a++) {
        for (size_t plane = 0; plane <= volume->info.dim[a]; plane++) {
            double t = ((double)plane - 0.5 - start[a]) / step[a];
            if (isfinite(t) && t > 0) {
                out[count++] = t;
            }
        }
    }
    qsort(out, count, sizeof *out, ascending);
    return count;
}

/* Object of the cell that holds an index; 0 outside. */
static uint32_t object_at(const struct volume *volume, const double start[3], const double step[3], double t)
{
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        double cell = floor(start[a] + t * step[a] + 0.5);
        if (cell < 0 || cell >= (double)volume->info.dim[a]) {
            return 0;
        }
        at[a] = (size_t)cell;
    }
    return volume_object(volume, at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]));
}

/* Between two successive crossings the axis is in one cell: that of the point halfway. */
static size_t walk(struct wanted *out, const struct volume *volume, const conus_pose *pose)
{
    static double crossings[ROW_LIMIT];
    const double *device = pose->world_from_device;
    double start[3];
    double step[3];
    size_t rows = 0;
    vec3_scale(step, device + 8, -1);
    mat4_point(start, volume->voxel_from_world, device + 12);
    mat4_direction(step, volume->voxel_from_world, step);
    size_t count = cross_planes(crossings, volume, start, step);
    for (size_t i = 0; i + 1 < count; i++) {
        uint32_t object = object_at(volume, start, step, (crossings[i] + crossings[i + 1]) / 2);
        bool goes_on = rows && out[rows - 1].object == object && out[rows - 1].exit == crossings[i];
        if (goes_on) {
            out[rows - 1].exit = crossings[i + 1];
        } else if (object) {
            out[rows++] = (struct wanted){object, crossings[i], crossings[i + 1]};
        }
    }
    return rows;
}

/* Whether the segments have this row, to 1e-9 mm. */
static bool is_among(const struct wanted *row, const conus_table *segments)
{
    for (size_t i = 0; i < conus_table_rows(segments); i++) {
        const struct wanted found = row_at(segments, i);
        if (found.object == row->object && fabs(found.entry - row->entry) < 1e-9 &&
            fabs(found.exit - row->exit) < 1e-9) {
            return true;
        }
    }
    return false;
}

/* Rows of an object do not overlap with others of it, gaps with none, and all are in order. */
static void check_order(const conus_table *segments)
{
    for (size_t i = 0; i < conus_table_rows(segments); i++) {
        const struct wanted segment = row_at(segments, i);
        assert_true(segment.entry <= segment.exit);
        assert_true(i == 0 || row_at(segments, i - 1).entry <= segment.entry);
        for (size_t j = 0; j < i; j++) {
            const struct wanted before = row_at(segments, j);
            bool may_overlap = before.object && segment.object && before.object != segment.object;
            assert_true(may_overlap || before.exit <= segment.entry + 1e-9);
        }
    }
}

/* Random parcellations with pathways on separate grids, oblique and sheared, from inside and outside. */
static void volumes_are_walked_cell_by_cell(void **state)
{
    (void)state;
    uint64_t seed = 17;
    size_t rows = 0;
    for (int round = 0; round < 600; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 14, 2);
        const conus_pose pose = scene_generic_pose(&seed, atlas);
        conus_table *segments = follow(atlas, NULL, &pose);
        size_t found = 0;
        size_t expected = 0;
        for (size_t v = 0; v < atlas->volume_count; v++) {
            static struct wanted wanted[ROW_LIMIT];
            size_t count = walk(wanted, &atlas->volumes[v], &pose);
            for (size_t i = 0; i < count; i++) {
                assert_true(is_among(&wanted[i], segments));
            }
            expected += count;
        }
        for (size_t i = 0; i < conus_table_rows(segments); i++) {
            found += conus_table_objects(segments)[i] != 0;
        }
        assert_int_equal(found, expected);
        check_order(segments);
        rows += found;
        conus_table_destroy(segments);
        conus_atlas_destroy(atlas);
    }
    assert_true(rows > 1000);
}

/* For each object the segments sum to the path that a cylinder of one ray has with all layers. The engine and the
 * sampling of the selector do not matter to the last bit. */
static void lengths_sum_to_the_path_of_a_ray(void **state)
{
    (void)state;
    uint64_t seed = 5;
    for (int round = 0; round < 60; round++) {
        conus_atlas *atlas = scene_atlas(&seed, 12, 1);
        const conus_pose pose = scene_generic_pose(&seed, atlas);
        bool has_range = round % 3 == 0;
        conus_selector_options options = {.layers = CONUS_LAYERS_ALL, .resolution = 1, .radius = 1e-6};
        options.range[0] = has_range ? 2 : 0;
        options.range[1] = has_range ? 30 : 0;
        conus_selector *selector = NULL;
        conus_selection *selection = NULL;
        assert_ok(conus_selector_create(&selector, atlas, &options));
        assert_ok(conus_select(&selection, selector, &pose, 0));
        conus_table *segments = follow(atlas, &options, &pose);
        for (size_t r = 0; r < conus_selection_count(selection); r++) {
            const conus_result *result = conus_selection_result(selection, r);
            double length = 0;
            for (size_t i = 0; i < conus_table_rows(segments); i++) {
                bool is_its = result->object && conus_table_objects(segments)[i] == result->object;
                length += is_its ? table_number_at(segments, "length_mm", i) : 0;
            }
            assert_near(length, result->object && result->pierced ? result->path : 0, 1e-9);
        }
        conus_table_destroy(segments);
        conus_selection_destroy(selection);
        conus_selector_destroy(selector);
        conus_atlas_destroy(atlas);
    }
}

static void check_same(const conus_atlas *atlas, const conus_pose *pose, const conus_selector_options *options)
{
    conus_selector *selector = NULL;
    conus_table *other = NULL;
    conus_table *exact = follow(atlas, NULL, pose);
    assert_gl(conus_selector_create(&selector, atlas, options));
    for (int time = 0; time < 2; time++) { /* the second time it uses the tables that the first one made */
        assert_ok(conus_segments(&other, selector, pose));
        assert_same_tables(other, exact);
        conus_table_destroy(other);
    }
    conus_table_destroy(exact);
    conus_selector_destroy(selector);
}

static void engines_and_sampling_do_not_matter(void **state)
{
    (void)state;
    uint64_t seed = 23;
    conus_atlas *atlas = scene_atlas(&seed, 14, 0);
    struct mesh ball = mesh_scene_sphere((const double[]){0.1, 0.2, 0.3}, 5, 12, 12);
    mesh_scene_add(atlas, &ball);
    const conus_pose pose = scene_generic_pose(&seed, atlas);
    check_same(atlas, &pose, &(conus_selector_options){.sampling = CONUS_SAMPLING_SLICES});
    check_same(atlas, &pose, &(conus_selector_options){.engine = CONUS_ENGINE_GL});
    check_same(atlas, &pose, &(conus_selector_options){.resolution = 64, .radius = 3, .layers = CONUS_LAYERS_ALL});
    conus_atlas_destroy(atlas);
}

/* With tables that were made once, before or after. */
static void a_shared_selector_follows_as_well(void **state)
{
    (void)state;
    uint64_t seed = 29;
    conus_atlas *atlas = scene_atlas(&seed, 10, 0);
    const conus_pose pose = scene_generic_pose(&seed, atlas);
    for (int made_before = 0; made_before < 2; made_before++) {
        conus_selector *selector = NULL;
        conus_selector *shared = NULL;
        conus_table *segments = NULL;
        conus_table *exact = follow(atlas, NULL, &pose);
        assert_ok(
            conus_selector_create(&selector, atlas, &(conus_selector_options){.sampling = CONUS_SAMPLING_SLICES}));
        assert_ok(made_before ? selector_prepare_axis(selector) : CONUS_OK);
        assert_ok(conus_selector_share(&shared, selector));
        assert_ok(conus_segments(&segments, shared, &pose));
        assert_same_tables(segments, exact);
        conus_table_destroy(segments);
        conus_table_destroy(exact);
        conus_selector_destroy(shared);
        conus_selector_destroy(selector);
    }
    conus_atlas_destroy(atlas);
}

/* 4 x 4 cells of 1 mm around whole numbers: 1 where x = y, else 2. */
static conus_atlas *diagonal(void)
{
    static const size_t dim[3] = {4, 4, 1};
    uint32_t labels[16];
    const conus_volume_info grid = scene_plain_grid(dim, NULL);
    for (size_t i = 0; i < 16; i++) {
        labels[i] = i % 4 == i / 4 ? 1 : 2;
    }
    return scene_parcellation(&grid, labels);
}

/* The axis meets every cell of label 1 at two corners, where cells of label 2 touch it: one segment of 4 diagonals. A
 * billionth of a degree off, where rounding leaves slivers, it is the same. */
static void what_only_touches_is_no_segment(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    for (int turned = -1; turned <= 1; turned++) {
        const conus_pose pose = along(-1.5, -1.5, 0, 1, 1 + turned * 1e-14, 0);
        const struct wanted wanted[] = {{0, 0, sqrt(2)}, {1, sqrt(2), 5 * sqrt(2)}};
        CHECK_ROWS(follow(atlas, NULL, &pose), wanted, 1e-9);
    }
    conus_atlas_destroy(atlas);
}

/* Along a face the axis is in the cells that begin there, since cells are half-open. Row y = 1 from x = 0 to 3 is 2, 1,
 * 2, 2; row y = 0 is 1, 2, 2, 2. Hidden, 1 is a gap. */
static void a_face_belongs_to_the_cell_that_begins_there(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    const conus_pose pose = along(-2.5, 0.5, 0, 1, 0, 0);
    const struct wanted wanted[] = {{0, 0, 2}, {2, 2, 3}, {1, 3, 4}, {2, 4, 6}};
    const struct wanted without[] = {{0, 0, 2}, {2, 2, 3}, {0, 3, 4}, {2, 4, 6}};
    CHECK_ROWS(follow(atlas, NULL, &pose), wanted, 1e-12);
    assert_ok(conus_atlas_set_hidden(atlas, (const bool[]){false, true, false}));
    CHECK_ROWS(follow(atlas, NULL, &pose), without, 1e-12);
    conus_atlas_destroy(atlas);
}

static void the_range_cuts_and_is_filled(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    const conus_pose pose = along(-2.5, 0.5, 0, 1, 0, 0);
    const struct wanted cut[] = {{2, 2.5, 3}, {1, 3, 3.25}};
    const struct wanted filled[] = {{0, 1, 2}, {2, 2, 3}, {1, 3, 4}, {2, 4, 6}, {0, 6, 9}};
    const struct wanted up_to_face[] = {{0, 1, 2}, {2, 2, 3}};
    const struct wanted behind[] = {{0, 6, 9}};
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.range = {2.5, 3.25}}, &pose), cut, 1e-12);
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.range = {1, 9}}, &pose), filled, 1e-12);
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.range = {1, 3}}, &pose), up_to_face, 1e-12);
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.range = {6, 9}}, &pose), behind, 1e-12);
    conus_atlas_destroy(atlas);
}

/* The same with one selector, whose own range differs; an end that is not given is the selector's. */
static void a_query_may_have_its_range(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    conus_selector *selector = NULL;
    const conus_pose pose = along(-2.5, 0.5, 0, 1, 0, 0);
    const struct wanted cut[] = {{2, 2.5, 3}, {1, 3, 3.25}};
    const struct wanted filled[] = {{0, 1, 2}, {2, 2, 3}, {1, 3, 4}, {2, 4, 6}, {0, 6, 9}};
    const struct wanted up_to_face[] = {{0, 1, 2}, {2, 2, 3}};
    const struct wanted behind[] = {{0, 6, 9}};
    const struct {
        double range[2];
        const struct wanted *rows;
        size_t count;
    } cases[] = {{{2.5, 3.25}, cut, 2}, {{NAN, NAN}, filled, 5}, {{NAN, 3}, up_to_face, 2}, {{6, NAN}, behind, 1}};
    static const double bad[][2] = {{9, NAN}, {NAN, 1}, {-1, 2}, {2, INFINITY}, {NAN, -1}, {3, 2}};
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.range = {1, 9}}));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        conus_table *segments = NULL;
        assert_ok(conus_selector_set_range(selector, cases[i].range));
        for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) { /* refused ranges leave the last one */
            assert_fails(conus_selector_set_range(selector, bad[k]), CONUS_ERROR_ARGUMENT);
        }
        assert_ok(conus_segments(&segments, selector, &pose));
        check_rows(segments, cases[i].rows, cases[i].count, 1e-12);
    }
    conus_table *segments = NULL;
    assert_ok(conus_selector_set_range(selector, NULL));
    assert_ok(conus_segments(&segments, selector, &pose));
    CHECK_ROWS(segments, filled, 1e-12);
    conus_selector_destroy(selector);
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.sampling = CONUS_SAMPLING_SLICES}));
    assert_fails(conus_selector_set_range(selector, cases[0].range), CONUS_ERROR_ARGUMENT);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* An axis without a far end that meets no object: one row, whose exit is at infinity. */
static void an_axis_that_meets_nothing_has_one_row(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    const conus_pose pose = along(-2.5, 0.5, 0, -1, 0, 0);
    const struct wanted wanted[] = {{0, 0, INFINITY}};
    conus_table *segments = follow(atlas, NULL, &pose);
    assert_true(isnan(table_number_at(segments, "exit_x", 0)));
    assert_near(table_number_at(segments, "entry_x", 0), -2.5, 1e-12);
    CHECK_ROWS(segments, wanted, 1e-12);
    conus_atlas_destroy(atlas);
}

static void ends_are_where_the_depths_say(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    const conus_pose pose = along(-2, -1, 0.25, 3, 2, 0);
    conus_frame lps;
    assert_ok(conus_frame_find(&lps, NULL, CONUS_SPACE_LPS, NULL));
    conus_table *segments = follow(atlas, NULL, &pose);
    conus_table *turned = follow(atlas, &(conus_selector_options){.frame = &lps}, &pose);
    assert_int_equal(conus_table_rows(segments), conus_table_rows(turned));
    for (size_t i = 0; i < conus_table_rows(segments); i++) {
        const struct wanted row = row_at(segments, i);
        double at[3];
        assert_near(table_number_at(segments, "entry_x", i), -2 + row.entry * 3 / sqrt(13), 1e-12);
        assert_near(table_number_at(segments, "exit_y", i), -1 + row.exit * 2 / sqrt(13), 1e-12);
        assert_near(table_number_at(segments, "exit_z", i), 0.25, 1e-12);
        table_point_at(at, turned, "exit_", i);
        assert_near(at[0], 2 - row.exit * 3 / sqrt(13), 1e-12);
        assert_near(at[1], 1 - row.exit * 2 / sqrt(13), 1e-12);
        assert_near(at[2], 0.25, 1e-12);
    }
    conus_table_destroy(turned);
    conus_table_destroy(segments);
    conus_atlas_destroy(atlas);
}

/* A blocking context hides nothing from an axis, and is no object. */
static void a_context_blocks_nothing(void **state)
{
    (void)state;
    uint64_t seed = 31;
    conus_atlas *atlas = scene_atlas(&seed, 10, 0);
    const conus_pose pose = scene_generic_pose(&seed, atlas);
    conus_table *before = follow(atlas, NULL, &pose);
    scene_add_blockers(atlas, &seed, (const size_t[]){20, 20, 20}, 0.9);
    conus_table *behind = follow(atlas, NULL, &pose);
    assert_same_tables(before, behind);
    conus_table_destroy(before);
    conus_table_destroy(behind);
    conus_atlas_destroy(atlas);
}

static void add_box(conus_atlas *atlas, double low, double high, double half)
{
    struct mesh box =
        mesh_scene_box((const double[]){low, -half, -half}, (const double[]){high, half + 0.5, half + 0.25});
    mesh_scene_add(atlas, &box);
}

/* Boxes inside each other: the axis passes all, each from its own face to its own, and the outer ones come first. From
 * inside two of them the entry is 0, or the beginning of the range. */
static void nested_surfaces_have_a_row_each(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    add_box(atlas, -2, 3, 2);
    add_box(atlas, -10, 12, 8);
    add_box(atlas, -5, 6, 4);
    const conus_pose outside = along(-30, 0.1, 0.2, 1, 0, 0);
    const conus_pose inside = along(4, 0.1, 0.2, 1, 0, 0);
    const struct wanted all[] = {{0, 0, 20}, {2, 20, 42}, {3, 25, 36}, {1, 28, 33}};
    const struct wanted from_0[] = {{3, 0, 2}, {2, 0, 8}};
    const struct wanted cut[] = {{3, 1, 2}, {2, 1, 5}};
    CHECK_ROWS(follow(atlas, NULL, &outside), all, 1e-9);
    CHECK_ROWS(follow(atlas, NULL, &inside), from_0, 1e-9);
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.range = {1, 5}}, &inside), cut, 1e-9);
    conus_atlas_destroy(atlas);
}

/* Spheres inside each other, beside their centre: chords of 2 sqrt(R^2 - d^2). Inscribed surfaces of 256 rings are up
 * to R (1 - cos(pi/256)) inside, 0.0023 mm of 30, and a chord's end moves along the axis by R / sqrt(R^2 - d^2) of
 * that. */
static void spheres_have_their_chords(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    static const double radii[] = {30, 20, 10};
    double half[3];
    for (int i = 0; i < 3; i++) {
        struct mesh sphere = mesh_scene_sphere((const double[]){1, 2, 3}, radii[i], 256, 256);
        mesh_scene_add(atlas, &sphere);
        half[i] = sqrt(radii[i] * radii[i] - 34);
    }
    const conus_pose pose = along(1 - 50, 2 + 3, 3 - 5, 1, 0, 0); /* d^2 = 9 + 25 */
    const struct wanted wanted[] = {{0, 0, 50 - half[0]},
                                    {1, 50 - half[0], 50 + half[0]},
                                    {2, 50 - half[1], 50 + half[1]},
                                    {3, 50 - half[2], 50 + half[2]}};
    CHECK_ROWS(follow(atlas, NULL, &pose), wanted, 0.005);
    conus_atlas_destroy(atlas);
}

/* A torus of 30 and 8 mm, crossed four times by a line 1 mm above and 1 mm beside its middle: at rho = 30 +- sqrt(63)
 * from the axis of the torus, x = +- sqrt(rho^2 - 1). Inscribed: within 0.02 mm. */
static void a_torus_is_crossed_four_times(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh torus = mesh_scene_torus(30, 8, 256, 128);
    double outer = sqrt((30 + sqrt(63)) * (30 + sqrt(63)) - 1);
    double inner = sqrt((30 - sqrt(63)) * (30 - sqrt(63)) - 1);
    mesh_scene_add(atlas, &torus);
    const conus_pose pose = along(-50, 1, 1, 1, 0, 0);
    const struct wanted wanted[] = {
        {0, 0, 50 - outer}, {1, 50 - outer, 50 - inner}, {0, 50 - inner, 50 + inner}, {1, 50 + inner, 50 + outer}};
    CHECK_ROWS(follow(atlas, NULL, &pose), wanted, 0.02);
    conus_atlas_destroy(atlas);
}

/* Boxes that touch or lie inside each other have one segment with their parent, without a seam. Boxes apart stay two
 * rows. */
static void a_level_joins_what_touches(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    const conus_pose pose = along(-10, 0.1, 0.2, 1, 0, 0);
    add_box(atlas, 0, 2, 1);
    add_box(atlas, 2, 5, 2);
    add_box(atlas, 7, 8, 1);
    add_box(atlas, 3, 4, 1);
    assert_ok(atlas_add_group(atlas,
                              &(conus_object){.kind = CONUS_KIND_AREA, .label = 9, .name = "all", .abbreviation = ""}));
    atlas->objects[0].parent = atlas->objects[1].parent = atlas->objects[2].parent = atlas->objects[3].parent = 5;
    const struct wanted leaves[] = {{0, 0, 10}, {1, 10, 12}, {2, 12, 15}, {4, 13, 14}, {0, 15, 17}, {3, 17, 18}};
    const struct wanted whole[] = {{0, 0, 10}, {5, 10, 15}, {0, 15, 17}, {5, 17, 18}};
    CHECK_ROWS(follow(atlas, NULL, &pose), leaves, 1e-9);
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.level = "1"}, &pose), whole, 1e-9);
    conus_atlas_destroy(atlas);
}

/* Past an edge of a closed box, past a corner, and along a face, whose triangles are then edge-on: none of these makes
 * a row of length 0. */
static void a_closed_surface_that_is_grazed_has_no_point(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((const double[]){0, -1, -1}, (const double[]){3, 1.5, 1.25});
    mesh_scene_add(atlas, &box);
    const conus_pose grazing[] = {along(-10, -8.5, 0.2, 1, 1, 0), along(-10, -8.5, -8.75, 1, 1, 1),
                                  along(-10, 1.5, 0.2, 1, 0, 0),  along(-10, 1.5, 1.25, 1, 0, 0),
                                  along(0, 0.1, -10, 0, 0, 1),    along(-7, 11.5, 0.2, 1, -1, 0)};
    for (size_t i = 0; i < sizeof grazing / sizeof grazing[0]; i++) {
        conus_table *segments = follow(atlas, NULL, &grazing[i]);
        for (size_t k = 0; k < conus_table_rows(segments); k++) {
            assert_true(table_number_at(segments, "length_mm", k) > 0);
        }
        conus_table_destroy(segments);
    }
    conus_atlas_destroy(atlas);
}

/* A box without its face at x = 3, two triangles of mesh_scene_box(): the axis enters and never leaves it. The row has
 * length 0, with the gap on both sides of it; outside of the range there is no row. */
static void an_open_surface_is_crossed_where_it_is(void **state)
{
    (void)state;
    conus_atlas *atlas = mesh_scene_atlas();
    struct mesh box = mesh_scene_box((const double[]){0, -1, -1}, (const double[]){3, 1.5, 1.25});
    size_t kept = 0;
    for (size_t i = 0; i < box.triangle_count; i++) {
        const uint32_t *corners = &box.triangles[3 * i];
        const float *x = box.positions;
        if (x[3 * corners[0]] < 3 || x[3 * corners[1]] < 3 || x[3 * corners[2]] < 3) {
            memmove(&box.triangles[3 * kept++], corners, 3 * sizeof *corners);
        }
    }
    assert_int_equal(kept, 10);
    box.triangle_count = kept;
    mesh_scene_add(atlas, &box);
    const conus_pose in = along(-10, 0.1, 0.2, 1, 0, 0);
    const conus_pose through = along(1, 0.1, -10, 0, 0, 1);
    const struct wanted once[] = {{0, 0, 10}, {1, 10, 10}};
    const struct wanted on_both_sides[] = {{0, 5, 10}, {1, 10, 10}, {0, 10, 20}};
    const struct wanted before[] = {{0, 5, 10}};
    const struct wanted both_faces[] = {{0, 0, 9}, {1, 9, 11.25}};
    CHECK_ROWS(follow(atlas, NULL, &in), once, 1e-9);
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.range = {5, 20}}, &in), on_both_sides, 1e-9);
    CHECK_ROWS(follow(atlas, &(conus_selector_options){.range = {5, 10}}, &in), before, 1e-9);
    CHECK_ROWS(follow(atlas, NULL, &through), both_faces, 1e-9);
    conus_atlas_destroy(atlas);
}

static void what_is_no_pose_is_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    conus_selector *selector = NULL;
    conus_table *segments = NULL;
    conus_pose pose = along(0, 0, 0, 1, 0, 0);
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    pose.world_from_device[0] = NAN;
    assert_fails(conus_segments(&segments, selector, &pose), CONUS_ERROR_ARGUMENT);
    assert_null(segments);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_status make_segments(void *data)
{
    const conus_pose pose = along(-10, 0.1, 0.2, 1, 0, 0);
    conus_selector *selector = NULL;
    conus_table *segments = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status =
        conus_selector_create(&selector, data, &(conus_selector_options){.sampling = CONUS_SAMPLING_SLICES});
    status = status ? status : conus_segments(&segments, selector, &pose);
    status = status ? status : conus_report_create(&report, selector, &(conus_report_options){.rows = "segments"});
    status = status ? status : conus_report_add_table(report, "probe", segments);
    status = status ? status : conus_report_text(&text, &size, report);
    conus_report_destroy(report);
    conus_table_destroy(segments);
    conus_selector_destroy(selector);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    conus_atlas *atlas = diagonal();
    add_box(atlas, 0, 2, 1);
    test_every_allocation(make_segments, atlas);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(segments)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volumes_are_walked_cell_by_cell),
        cmocka_unit_test(lengths_sum_to_the_path_of_a_ray),
        cmocka_unit_test(engines_and_sampling_do_not_matter),
        cmocka_unit_test(a_shared_selector_follows_as_well),
        cmocka_unit_test(what_only_touches_is_no_segment),
        cmocka_unit_test(a_face_belongs_to_the_cell_that_begins_there),
        cmocka_unit_test(the_range_cuts_and_is_filled),
        cmocka_unit_test(a_query_may_have_its_range),
        cmocka_unit_test(an_axis_that_meets_nothing_has_one_row),
        cmocka_unit_test(ends_are_where_the_depths_say),
        cmocka_unit_test(a_context_blocks_nothing),
        cmocka_unit_test(nested_surfaces_have_a_row_each),
        cmocka_unit_test(spheres_have_their_chords),
        cmocka_unit_test(a_torus_is_crossed_four_times),
        cmocka_unit_test(a_level_joins_what_touches),
        cmocka_unit_test(a_closed_surface_that_is_grazed_has_no_point),
        cmocka_unit_test(an_open_surface_is_crossed_where_it_is),
        cmocka_unit_test(what_is_no_pose_is_refused),
        cmocka_unit_test(every_failing_allocation_is_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
