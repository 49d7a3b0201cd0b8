/* SPDX-License-Identifier: BSD-3-Clause */
/* Tolerances (Eq. 23): a needle through boxes, by trigonometry, and random needles against scans of poses tried one by
 * one. The deviating poses are made here, from their ends. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "scene.h"
#include "test.h"

#include <math.h>
#include <string.h>

static const size_t DIM[3] = {40, 30, 30};
static const double CELLS[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0.5, 1}; /* cell i is [i, i + 1] */

/* 1: [10, 20] x [10, 16] x [10, 16]. 2: [24, 30] x [10, 16] x [4, 10]. */
static conus_atlas *boxes(void)
{
    static const size_t box[2][6] = {{10, 20, 10, 16, 10, 16}, {24, 30, 10, 16, 4, 10}};
    conus_volume_info grid = scene_plain_grid(DIM, CELLS);
    uint32_t *labels = memory_zeroed(DIM[0] * DIM[1] * DIM[2], sizeof *labels);
    assert_non_null(labels);
    for (size_t i = 0; i < DIM[0] * DIM[1] * DIM[2]; i++) {
        size_t at[3] = {i % DIM[0], i / DIM[0] % DIM[1], i / DIM[0] / DIM[1]};
        for (uint32_t b = 0; b < 2; b++) {
            bool inside = true;
            for (int a = 0; a < 3; a++) {
                inside = inside && at[a] >= box[b][2 * a] && at[a] < box[b][2 * a + 1];
            }
            labels[i] = inside ? b + 1 : labels[i];
        }
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    memory_free(labels);
    return atlas;
}

/* A needle, its device's x and y, and the plan that tries it. */
struct trial {
    conus_selector *selector;
    conus_plan *plan;
    conus_pose_row row;
    conus_tolerance_options options;
};

static struct trial begin(const conus_atlas *atlas, double radius, const conus_constraint *constraints, size_t count)
{
    struct trial trial = {.row.id = "needle"};
    assert_ok(conus_selector_create(&trial.selector, atlas, &(conus_selector_options){.radius = radius}));
    assert_ok(conus_plan_create(&trial.plan, trial.selector, constraints, count, &(conus_plan_options){.threads = 1}));
    return trial;
}

static void end(struct trial *trial)
{
    conus_plan_destroy(trial->plan);
    conus_selector_destroy(trial->selector);
}

static void aim(struct trial *trial, const double at[3], const double along[3], double near, double far)
{
    static const double up[3] = {0, 0, 1};
    trial->row.range[0] = near;
    trial->row.range[1] = far;
    assert_ok(conus_pose_along(&trial->row.pose, at, along, fabs(along[2]) < 0.9 * vec3_length(along) ? up : NULL));
}

static conus_status find(conus_tolerance rows[CONUS_TOLERANCE_COUNT], struct trial *trial)
{
    const conus_planned *tried = NULL;
    conus_status status = conus_plan_try(&tried, trial->plan, &trial->row);
    return status ? status : conus_plan_tolerance(rows, trial->plan, tried, &trial->options);
}

/* Turns a vector about an axis by half the angle, as quaternions do. */
static void turn(double v[3], const double axis[3], double angle)
{
    double unit[3];
    double once[3];
    double twice[3];
    assert_true(vec3_normalise(unit, axis));
    vec3_cross(once, unit, v);
    vec3_cross(twice, unit, once);
    vec3_add_scaled(v, v, 2 * sin(angle / 2) * cos(angle / 2), once);
    vec3_add_scaled(v, v, 2 * sin(angle / 2) * sin(angle / 2), twice);
}

/* Whether a device at a place, with an axis and two sides, is feasible: its shanks are tried by a plan of single
 * needles. One of them must reach, and each must keep clear. */
static bool is_held(conus_plan *single, const double (*shanks)[2], size_t count, conus_pose_row moved,
                    const double at[3], const double axis[3], const double (*sides)[3])
{
    bool reaches = false;
    bool is_clear = true;
    for (size_t i = 0; i < count; i++) {
        const conus_planned *tried = NULL;
        double entry[3];
        vec3_add_scaled(entry, at, shanks[i][0], sides[0]);
        vec3_add_scaled(entry, entry, shanks[i][1], sides[1]);
        assert_ok(conus_pose_along(&moved.pose, entry, axis, NULL));
        assert_ok(conus_plan_try(&tried, single, &moved));
        reaches = reaches || tried->verdicts[0].holds;
        is_clear = is_clear && tried->verdicts[1].holds;
    }
    return reaches && is_clear;
}

/* The same for the device that is off by `s`. */
static bool holds(const struct trial *trial, conus_plan *single, const double (*shanks)[2], size_t count,
                  const conus_tolerance *row, double s)
{
    const double *m = trial->row.pose.world_from_device;
    conus_pose_row moved = trial->row;
    double axis[3] = {-m[8], -m[9], -m[10]};
    double at[3] = {m[12], m[13], m[14]};
    double sides[2][3] = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}};
    double about[3] = {0, 0, 1};
    s *= row->negative ? -1 : 1;
    if (row->freedom <= CONUS_FREEDOM_Z) {
        at[row->freedom] += s;
    } else if (row->freedom == CONUS_FREEDOM_DEPTH) {
        moved.range[1] += s;
    } else if (row->freedom <= CONUS_FREEDOM_UP) {
        vec3_add_scaled(at, at, s, m + (row->freedom == CONUS_FREEDOM_UP ? 4 : 0));
    } else {
        double depth = trial->options.pivot_at_tip ? moved.range[1] : trial->options.pivot;
        if (row->freedom <= CONUS_FREEDOM_YAW) {
            memcpy(about, m + (row->freedom == CONUS_FREEDOM_YAW ? 4 : 0), sizeof about);
        } else if (row->freedom == CONUS_FREEDOM_ELEVATION) {
            vec3_cross(about, axis, (const double[]){0, 0, 1});
        }
        vec3_add_scaled(at, at, depth, axis);
        turn(axis, about, s);
        turn(sides[0], about, s);
        turn(sides[1], about, s);
        vec3_add_scaled(at, at, -depth, axis);
    }
    return is_held(single, shanks, count, moved, at, axis, (const double(*)[3])sides);
}

static double unit_of(const conus_tolerance *row)
{
    return row->freedom >= CONUS_FREEDOM_PITCH ? radians_from_degrees(1) : 1;
}

/* `expected` is mm or radians. */
static void check(const conus_tolerance *row, double expected, size_t constraint)
{
    assert_int_equal(row->method, CONUS_TOLERANCE_EXACT);
    const double unit = unit_of(row);
    assert_near(row->holds_to * unit, expected, 1.1e-6 * unit);
    assert_true(row->holds_to * unit <= expected + 1e-9);
    assert_int_equal(row->constraint, constraint);
    if (constraint == SIZE_MAX) {
        assert_true(isnan(row->fails_at) && isnan(row->depth) && isnan(row->at[0]));
    } else {
        assert_true(row->fails_at * unit >= expected - 1e-9 && row->fails_at - row->holds_to <= 1.001e-6);
    }
}

static const conus_tolerance *row_of(const conus_tolerance *rows, conus_freedom freedom, bool negative)
{
    const conus_tolerance *row = &rows[2 * freedom + negative];
    assert_int_equal(row->freedom, freedom);
    assert_int_equal(row->negative, negative);
    return row;
}

/* The root of a rising function. */
static double root(double (*function)(double), double low, double high)
{
    for (int i = 0; i < 100; i++) {
        double middle = (low + high) / 2;
        *(function(middle) < 0 ? &low : &high) = middle;
    }
    return low;
}

/* A needle to 18 mm, turned about its entry at x = 0: it leaves box 1 by the side, 3 mm off the axis, and enters at x =
 * 10. */
static double missing_length(double angle)
{
    return 5 - (fmin(18, 3 / sin(angle)) - 10 / cos(angle));
}

/* The needle is from x = 0 to 18 at y = z = 13, 3 mm from the sides of box 1. 8 mm of it are in the box, and 5 are
 * needed. */
static void length_in_a_box(void **state)
{
    (void)state;
    conus_tolerance rows[CONUS_TOLERANCE_COUNT];
    const conus_constraint want = {.names = "1", .limit = 5};
    const double turned = root(missing_length, 0.1, 0.5);
    const double cap = radians_from_degrees(30);
    conus_atlas *atlas = boxes();
    struct trial trial = begin(atlas, 0.5, &want, 1);
    aim(&trial, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NAN, 18);
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_X, false), 15, 0); /* [15, 20] of it are left */
    check(row_of(rows, CONUS_FREEDOM_X, true), 3, 0);
    check(row_of(rows, CONUS_FREEDOM_DEPTH, false), 20, SIZE_MAX);
    check(row_of(rows, CONUS_FREEDOM_DEPTH, true), 3, 0);
    for (int side = 0; side < 2; side++) {
        check(row_of(rows, CONUS_FREEDOM_Y, side), 3, 0);
        check(row_of(rows, CONUS_FREEDOM_Z, side), 3, 0);
        check(row_of(rows, CONUS_FREEDOM_SIDE, side), 3, 0);
        check(row_of(rows, CONUS_FREEDOM_UP, side), 3, 0);
        for (int freedom = CONUS_FREEDOM_PITCH; freedom <= CONUS_FREEDOM_ELEVATION; freedom++) {
            check(row_of(rows, (conus_freedom)freedom, side), turned, 0);
        }
    }
    /* About the tip at x = 18, 8 mm inside: min(8 / cos, 3 / sin) >= 5 up to asin(0.6), more than 30 degrees. */
    trial.options.pivot_at_tip = true;
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_YAW, false), cap, SIZE_MAX);
    /* About x = 15 the sides are as far away on both sides of the pivot; the needle is in the box for 5 / cos in front
     * of it and 3 behind. */
    trial.options = (conus_tolerance_options){.pivot = 15, .shifts = {{0, 2, 0}, {0, 0, -1}, {5, 0, 0}}};
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_PITCH, true), cap, SIZE_MAX);
    check(row_of(rows, CONUS_FREEDOM_X, true), 3, 0); /* y */
    check(row_of(rows, CONUS_FREEDOM_Z, true), 3, 0); /* x */
    check(row_of(rows, CONUS_FREEDOM_Z, false), 15, 0);
    end(&trial);
    conus_atlas_destroy(atlas);
}

/* The needle to 26 is 3 mm above the wall z = 10, x = 24 to 30: 1.5 mm more than its radius and the margin. */
static void beside_a_wall(void **state)
{
    (void)state;
    conus_tolerance rows[CONUS_TOLERANCE_COUNT];
    const conus_constraint wants[3] = {{.kind = CONUS_CONSTRAINT_AVOID, .names = "2", .limit = 1},
                                       {.kind = CONUS_CONSTRAINT_LEAN, .direction = {1, 0, 0}, .limit = 20},
                                       {.kind = CONUS_CONSTRAINT_LENGTH, .limit = 0, .most = 26 + 7}};
    conus_atlas *atlas = boxes();
    struct trial trial = begin(atlas, 0.5, wants, 3);
    aim(&trial, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NAN, 26);
    assert_ok(find(rows, &trial));
    const conus_tolerance *down = row_of(rows, CONUS_FREEDOM_Z, true);
    check(down, 1.5, 0);
    assert_int_equal(down->object, 2);
    assert_near(down->depth, 24, 1e-6);
    assert_near(down->at[2], 11.5, 2e-6);
    check(row_of(rows, CONUS_FREEDOM_Z, false), 20, SIZE_MAX);
    check(row_of(rows, CONUS_FREEDOM_DEPTH, false), 7, 2); /* the wall is beside it for as long as it is */
    check(row_of(rows, CONUS_FREEDOM_DEPTH, true), 20, SIZE_MAX);
    check(row_of(rows, CONUS_FREEDOM_ELEVATION, true), asin(1.5 / 26), 0); /* the tip, above the wall at 25.96 */
    check(row_of(rows, CONUS_FREEDOM_ELEVATION, false), radians_from_degrees(20), 1);
    /* When the needle turns about its tip, the point nearest to the wall's edge, x = 24, sinks: the line's distance
     * from the edge is 3 cos a - 2 sin a = 1.5, so a = acos(1.5 / sqrt(13)) - atan(2 / 3) > 20 degrees. */
    trial.options.pivot_at_tip = true;
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_ELEVATION, false), radians_from_degrees(20), 1);
    trial.options = (conus_tolerance_options){.pivot = 10}; /* 16 mm before the tip */
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_ELEVATION, true), asin(1.5 / 16), 0);
    end(&trial);
    conus_atlas_destroy(atlas);
}

/* Constraints on the tip, on the first object along the axis, on a part of it, and on other needles. */
static void other_constraints(void **state)
{
    (void)state;
    const double other[6] = {0, 23, 23, 40, 23, 23};
    const conus_constraint tip = {.names = "1", .measure = CONUS_MEASURE_TIP};
    const conus_constraint first = {.kind = CONUS_CONSTRAINT_FIRST, .names = "1"};
    const conus_constraint apart = {.kind = CONUS_CONSTRAINT_APART, .limit = 2, .needles = other, .needle_count = 1};
    const conus_constraint entry = {.kind = CONUS_CONSTRAINT_ENTRY_ANGLE, .limit = 25};
    const conus_constraint part = {.names = "1", .limit = 2, .part = {0, 3}};
    conus_tolerance rows[CONUS_TOLERANCE_COUNT];
    conus_atlas *atlas = boxes();
    struct trial trial = begin(atlas, 0.5, &tip, 1);
    aim(&trial, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NAN, 18);
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_DEPTH, false), 2, 0);
    check(row_of(rows, CONUS_FREEDOM_DEPTH, true), 8, 0);
    check(row_of(rows, CONUS_FREEDOM_X, false), 2, 0);
    check(row_of(rows, CONUS_FREEDOM_PITCH, false), asin(3.0 / 18), 0);
    end(&trial);

    trial = begin(atlas, 0.5, &first, 1);
    aim(&trial, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NAN, 18);
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_DEPTH, true), 8, 0);
    const conus_tolerance *sampled = row_of(rows, CONUS_FREEDOM_Y, true);
    assert_int_equal(sampled->method, CONUS_TOLERANCE_SAMPLED);
    assert_near(sampled->holds_to, 3, 1.1e-6);
    assert_near(sampled->fails_at, 3, 1.1e-6);
    assert_true(sampled->fails_at > sampled->holds_to);
    end(&trial);

    trial = begin(atlas, 0.5, &apart, 1); /* a line 10 mm to the side and 10 mm above; the radius does not count */
    aim(&trial, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NAN, 18);
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_Y, false), 20, SIZE_MAX); /* 10 mm are left */
    aim(&trial, (const double[]){0, 13, 23}, (const double[]){1, 0, 0}, NAN, 18);
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_Y, false), 8, 0);
    check(row_of(rows, CONUS_FREEDOM_YAW, false), asin(8.0 / 18), 0);
    end(&trial);

    trial = begin(atlas, 0.5, &entry, 1); /* the normal leans 10 degrees against x, towards z */
    trial.row.normal[0] = -cos(radians_from_degrees(10));
    trial.row.normal[2] = sin(radians_from_degrees(10));
    aim(&trial, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NAN, 18);
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_Z, false), 20, SIZE_MAX);
    check(row_of(rows, CONUS_FREEDOM_ELEVATION, false), radians_from_degrees(15), 0);
    check(row_of(rows, CONUS_FREEDOM_ELEVATION, true), radians_from_degrees(30), SIZE_MAX); /* 35 would be too much */
    end(&trial);

    trial = begin(atlas, 0.5, &part, 1); /* 15 to 18 of it count */
    aim(&trial, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NAN, 18);
    assert_ok(find(rows, &trial));
    check(row_of(rows, CONUS_FREEDOM_X, false), 3, 0);
    sampled = row_of(rows, CONUS_FREEDOM_DEPTH, true);
    assert_int_equal(sampled->method, CONUS_TOLERANCE_SAMPLED);
    assert_near(sampled->holds_to, 6, 1.1e-6);
    end(&trial);
    conus_atlas_destroy(atlas);
}

/* A needle that passes the edge of the wall with 5 nm to spare, and a pose that is not feasible itself. */
static void grazed_and_broken(void **state)
{
    (void)state;
    conus_tolerance rows[CONUS_TOLERANCE_COUNT];
    const conus_constraint wants[2] = {{.names = "1", .limit = 1},
                                       {.kind = CONUS_CONSTRAINT_AVOID, .names = "2", .limit = 1}};
    conus_atlas *atlas = boxes();
    struct trial trial = begin(atlas, 0.5, wants, 2);
    aim(&trial, (const double[]){0, 13, 11.5 + 5e-9}, (const double[]){1, 0, 0}, NAN, 20);
    assert_ok(find(rows, &trial));
    const conus_tolerance *along = row_of(rows, CONUS_FREEDOM_X, false);
    assert_int_equal(along->method, CONUS_TOLERANCE_GRAZED);
    assert_true(along->holds_to > 3.99 && along->holds_to < 4.01); /* the edge, less the slope there */
    assert_near(along->fails_at, 19, 2e-6);                        /* 1 mm of box 1 is left */
    assert_int_equal(along->constraint, 0);
    aim(&trial, (const double[]){0, 13, 11.5 - 1e-6}, (const double[]){1, 0, 0}, NAN, 26);
    assert_ok(find(rows, &trial));
    for (int i = 0; i < CONUS_TOLERANCE_COUNT; i++) {
        assert_true(rows[i].holds_to == 0 && rows[i].fails_at == 0);
        assert_int_equal(rows[i].constraint, 1);
        assert_int_equal(rows[i].object, 2);
    }
    trial.options.pivot = NAN;
    assert_fails(find(rows, &trial), CONUS_ERROR_ARGUMENT);
    trial.options = (conus_tolerance_options){.shifts = {{1, 0, 0}}};
    assert_fails(find(rows, &trial), CONUS_ERROR_ARGUMENT);
    end(&trial);
    conus_atlas_destroy(atlas);
}

enum { EDGE = 9, PLACES = 20 };

/* A turned and flipped grid with blobs of objects 1 and 2. */
static conus_atlas *blobs(uint64_t *seed)
{
    conus_volume_info grid = scene_grid(seed, (const size_t[]){EDGE, EDGE, EDGE});
    uint32_t labels[EDGE * EDGE * EDGE];
    for (size_t i = 0; i < EDGE * EDGE * EDGE; i++) {
        const size_t index[3] = {i % EDGE, i / EDGE % EDGE, i / EDGE / EDGE};
        const double at[3] = {(double)index[0], (double)index[1], (double)index[2]};
        const double centre[2][3] = {{3, 4, 4}, {7, 4, 4}};
        labels[i] = 0;
        for (uint32_t b = 0; b < 2; b++) {
            double away[3];
            vec3_sub(away, at, centre[b]);
            labels[i] = vec3_length(away) + test_random(seed, -0.6, 0.6) < (b ? 1.5 : 3) ? b + 1 : labels[i];
        }
    }
    return scene_parcellation(&grid, labels);
}

/* Needles, and devices of three needles whose last one is aimed. */
static void random_needles(void **state)
{
    (void)state;
    static const double places[2][3][2] = {{{0, 0}}, {{0, 0}, {16, -9.5}, {18, -9}}};
    uint64_t seed = 23;
    size_t found = 0;
    const conus_constraint wants[2] = {{.names = "1", .limit = 0.4},
                                       {.kind = CONUS_CONSTRAINT_AVOID, .names = "2", .limit = 0.1}};
    for (size_t t = 0; t < test_trials(6); t++) {
        conus_tolerance rows[CONUS_TOLERANCE_COUNT];
        const conus_planned *tried = NULL;
        conus_atlas *atlas = blobs(&seed);
        struct trial trial = begin(atlas, 0.05, wants, 2);
        conus_plan *single = trial.plan;
        const double(*shanks)[2] = places[t % 2];
        const conus_plan_options options = {.threads = 1, .shanks = shanks[0], .shank_count = t % 2 ? 3 : 1};
        double *m = trial.row.pose.world_from_device;
        assert_ok(conus_plan_create(&trial.plan, trial.selector, wants, 2, &options));
        do { /* until one is feasible */
            double ends[2][3];
            double along[3];
            for (int e = 0; e < 2; e++) {
                double voxel[3];
                for (int a = 0; a < 3; a++) {
                    voxel[a] = e ? (a ? 4 : 3) + test_random(&seed, -2, 2) : test_random(&seed, -6, 14);
                }
                mat4_point(ends[e], atlas->volumes[0].info.world_from_voxel, voxel);
            }
            vec3_sub(along, ends[1], ends[0]);
            aim(&trial, ends[0], along, 0.1 * vec3_length(along), vec3_length(along));
            vec3_add_scaled(m + 12, m + 12, -shanks[options.shank_count - 1][0], m);
            vec3_add_scaled(m + 12, m + 12, -shanks[options.shank_count - 1][1], m + 4);
            assert_ok(conus_plan_try(&tried, trial.plan, &trial.row));
        } while (!tried->feasible);
        trial.options.pivot = test_random(&seed, 0, 1) * trial.row.range[1];
        assert_ok(find(rows, &trial));
        for (size_t i = t % 3; i < CONUS_TOLERANCE_COUNT; i += 3) {
            const conus_tolerance *row = &rows[i];
            for (int k = 0; k <= PLACES; k++) {
                double s = row->holds_to * unit_of(row) * k / PLACES;
                assert_true(holds(&trial, single, shanks, options.shank_count, row, s));
            }
            assert_int_equal(row->method, CONUS_TOLERANCE_EXACT);
            if (!isnan(row->fails_at)) {
                assert_false(holds(&trial, single, shanks, options.shank_count, row, row->fails_at * unit_of(row)));
                assert_true(row->fails_at - row->holds_to <= 1.001e-6);
                found++;
            }
        }
        conus_plan_destroy(single);
        end(&trial);
        conus_atlas_destroy(atlas);
    }
    assert_true(found > 5);
}

/* The leeway of four contacts of seven is the fourth largest leeway of as many tips: needles that end at the contacts
 * are tried. */
static void contacts_are_as_many_tips(void **state)
{
    (void)state;
    static const conus_contacts contacts = {7, 2, 0.9, 0.3};
    const conus_constraint wants[2] = {
        {.names = "1", .measure = CONUS_MEASURE_CONTACTS, .limit = 4, .contacts = contacts},
        {.names = "1", .measure = CONUS_MEASURE_TIP}};
    uint64_t seed = 29;
    size_t held = 0;
    for (size_t t = 0; t < test_trials(12); t++) {
        conus_atlas *atlas = blobs(&seed);
        struct trial trial = begin(atlas, 0, wants, 1);
        struct trial tip = begin(atlas, 0, wants + 1, 1);
        const conus_planned *tried = NULL;
        double leeways[7];
        double ends[2][3];
        for (int e = 0; e < 2; e++) {
            double voxel[3];
            for (int a = 0; a < 3; a++) {
                voxel[a] = (a ? 4 : 3) + test_random(&seed, -2, 2);
            }
            mat4_point(ends[e], atlas->volumes[0].info.world_from_voxel, voxel);
        }
        vec3_sub(ends[0], ends[1], ends[0]);
        vec3_add_scaled(ends[1], ends[1], -8 / vec3_length(ends[0]), ends[0]);
        aim(&trial, ends[1], ends[0], 6, test_random(&seed, 8, 11));
        tip.row = trial.row;
        tip.row.range[0] = 0;
        for (int k = 0; k < 7; k++) {
            const int of_two = k / 2;
            tip.row.range[1] = trial.row.range[1] - 0.3 - of_two * 0.9;
            assert_ok(conus_plan_try(&tried, tip.plan, &tip.row));
            bool counts = tried->feasible && tried->far >= trial.row.range[0];
            int at = k; /* the largest first */
            for (; at && leeways[at - 1] < (counts ? tried->leeway : 0); at--) {
                leeways[at] = leeways[at - 1];
            }
            leeways[at] = counts ? tried->leeway : 0;
        }
        assert_ok(conus_plan_try(&tried, trial.plan, &trial.row));
        assert_int_equal(tried->feasible, leeways[3] > 0);
        assert_near(tried->verdicts[0].leeway, leeways[3], 2e-6);
        held += tried->feasible;
        end(&trial);
        end(&tip);
        conus_atlas_destroy(atlas);
    }
    assert_true(held > 0);
}

struct asked {
    const conus_atlas *atlas;
    const conus_constraint *wants;
};

static conus_status attempt(void *data)
{
    const struct asked *asked = data;
    struct trial trial = {.row.id = "needle"};
    conus_tolerance rows[CONUS_TOLERANCE_COUNT];
    conus_status status = conus_selector_create(&trial.selector, asked->atlas, NULL);
    status = status
                 ? status
                 : conus_plan_create(&trial.plan, trial.selector, asked->wants, 1, &(conus_plan_options){.threads = 1});
    trial.row.range[1] = 12;
    status = status ? status
                    : conus_pose_along(&trial.row.pose, (const double[]){0, 13, 13}, (const double[]){1, 0, 0}, NULL);
    status = status ? status : find(rows, &trial);
    end(&trial);
    return status;
}

/* Fails each of the first allocations, then ever fewer: a tolerance takes thousands of verdicts. */
static void failing_allocations_are_survived(void **state)
{
    (void)state;
    const conus_constraint want = {.names = "1", .limit = 1.99};
    conus_atlas *atlas = boxes();
    bool failed = true;
    for (long n = 0; failed; n += 1 + n / 8) {
        test_fail_allocation(n);
        conus_status status = attempt(&(struct asked){atlas, &want});
        failed = test_allocation_failed();
        test_fail_allocation(-1);
        assert_true(failed || status == CONUS_OK);
        assert_true(status == CONUS_OK || status == CONUS_ERROR_MEMORY);
    }
    conus_atlas_destroy(atlas);
}

TEST_GROUP(plan_tolerance)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(length_in_a_box),
        cmocka_unit_test(beside_a_wall),
        cmocka_unit_test(other_constraints),
        cmocka_unit_test(grazed_and_broken),
        cmocka_unit_test(random_needles),
        cmocka_unit_test(contacts_are_as_many_tips),
        cmocka_unit_test(failing_allocations_are_survived),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
