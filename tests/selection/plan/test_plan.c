/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 22: feasible poses, their slacks, and the best of them. Boxes of voxels, whose measures follow by arithmetic; the
 * order against that found by comparing every two poses. */
#include "base/files/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "conus/own.h"
#include "scene.h"
#include "selection/plan/plan.h"
#include "test.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const size_t DIM[3] = {40, 30, 30};
static const double CELLS[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0.5, 1}; /* cell i is [i, i + 1] */

/* 1: [10, 20] x [10, 16] x [10, 16]. 2: [24, 30] x [10, 16] x [4, 10]. 3: [20, 22] x [10, 16] x [10, 16]. */
static conus_atlas *boxes(void)
{
    static const size_t box[3][6] = {{10, 20, 10, 16, 10, 16}, {24, 30, 10, 16, 4, 10}, {20, 22, 10, 16, 10, 16}};
    conus_volume_info grid = scene_plain_grid(DIM, CELLS);
    uint32_t *labels = memory_zeroed(DIM[0] * DIM[1] * DIM[2], sizeof *labels);
    assert_non_null(labels);
    for (uint32_t b = 0; b < 3; b++) {
        for (size_t k = box[b][4]; k < box[b][5]; k++) {
            for (size_t j = box[b][2]; j < box[b][3]; j++) {
                for (size_t i = box[b][0]; i < box[b][1]; i++) {
                    labels[i + DIM[0] * (j + DIM[1] * k)] = b + 1;
                }
            }
        }
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    memory_free(labels);
    return atlas;
}

/* A row of a table of poses; NAN = the cell is empty. */
struct needle_row {
    double at[3], along[3], near, far;
};

static void add_cell(struct buffer *text, double value)
{
    if (!isnan(value)) {
        buffer_format(text, "%.17g", value);
    }
}

static const char *write_needles(const char *name, const struct needle_row *rows, size_t count)
{
    struct buffer text = {0};
    buffer_text(&text, "query_id\tx\ty\tz\tdx\tdy\tdz\tnear\tfar\n");
    for (size_t i = 0; i < count; i++) {
        buffer_format(&text, "n%zu", i + 1);
        for (int a = 0; a < 8; a++) {
            buffer_text(&text, "\t");
            add_cell(&text, a < 3 ? rows[i].at[a] : a < 6 ? rows[i].along[a - 3] : a < 7 ? rows[i].near : rows[i].far);
        }
        buffer_text(&text, "\n");
    }
    const char *path = test_scratch(name);
    assert_ok(buffer_status(&text));
    assert_ok(file_write(path, text.data, text.size));
    buffer_finish(&text);
    return path;
}

struct asked {
    const conus_atlas *atlas;
    conus_selector_options selector;
    const conus_constraint *constraints;
    size_t count;
    conus_plan_options options;
    bool measures_all;
    const char *path;
};

struct answer {
    conus_selector *selector;
    conus_plan *plan;
};

static conus_status try_ask(struct answer *out, const struct asked *asked)
{
    conus_pose_stream *stream = NULL;
    conus_status status = conus_selector_create(&out->selector, asked->atlas, &asked->selector);
    status = status ? status
                    : conus_plan_create(&out->plan, out->selector, asked->constraints, asked->count, &asked->options);
    if (!status && asked->measures_all) {
        plan_measure_all(out->plan);
    }
    status = status ? status : conus_pose_stream_open(&stream, asked->path, NULL);
    status = status ? status : conus_plan_run(out->plan, stream, UINT64_MAX);
    conus_pose_stream_destroy(stream);
    return status;
}

static void end(struct answer *answer)
{
    conus_plan_destroy(answer->plan);
    conus_selector_destroy(answer->selector);
}

static struct answer ask(const struct asked *asked)
{
    struct answer answer = {0};
    assert_ok(try_ask(&answer, asked));
    return answer;
}

static conus_constraint reach(const char *names, double length)
{
    return (conus_constraint){.kind = CONUS_CONSTRAINT_REACH, .names = names, .limit = length};
}

static conus_constraint avoid(const char *names, double margin)
{
    return (conus_constraint){.kind = CONUS_CONSTRAINT_AVOID, .names = names, .limit = margin};
}

/* The verdict on one constraint, of a needle 0.5 mm thick along x at y = z = 13, from x = 0 to `far`. */
static conus_verdict judge_one(const conus_constraint *constraint, double far)
{
    struct needle_row row = {{0, 13, 13}, {1, 0, 0}, NAN, far};
    conus_atlas *atlas = boxes();
    struct answer answer = ask(&(struct asked){.atlas = atlas,
                                               .selector = {.radius = 0.5},
                                               .constraints = constraint,
                                               .count = 1,
                                               .options = {.infeasible = true, .threads = 1},
                                               .path = write_needles("one.tsv", &row, 1)});
    assert_int_equal(conus_plan_count(answer.plan), 1);
    const conus_planned *planned = conus_plan_pose(answer.plan, 0);
    conus_verdict verdict = planned->verdicts[0];
    assert_int_equal(planned->feasible, verdict.holds);
    assert_int_equal(planned->broken == SIZE_MAX, verdict.holds);
    assert_int_equal(conus_plan_left(answer.plan, 1), verdict.holds);
    assert_int_equal(conus_plan_left(answer.plan, 0), 1);
    assert_int_equal(planned->candidate, 1);
    assert_string_equal(planned->id, "n1");
    end(&answer);
    conus_atlas_destroy(atlas);
    return verdict;
}

static void check(conus_verdict got, bool holds, double value, double slack, double leeway)
{
    assert_int_equal(got.holds, holds);
    assert_near(got.value, value, 1e-9);
    assert_near(got.slack, slack, 1e-9);
    if (isnan(leeway)) {
        assert_true(isnan(got.leeway));
    } else {
        assert_near(got.leeway, leeway, 1e-6);
        assert_true(got.leeway <= leeway + 1e-12);
    }
}

/* In box 1 from 10 to the far end, 3 mm from its sides: with 3 >= delta all depths are left that are at least delta
 * from both ends of the box, or from one if the needle ends inside. */
static void lengths_and_their_leeways(void **state)
{
    (void)state;
    conus_constraint want = reach("1", 5);
    check(judge_one(&want, 18), true, 8, 3, 2.5); /* [10 + d, min(18, 20 - d)] is 10 - 2 d long from d = 2 on */
    want.limit = 6.5;
    check(judge_one(&want, 18), true, 8, 1.5, 1.5); /* 8 - d */
    want.limit = 2;
    check(judge_one(&want, 18), true, 8, 6, 3); /* the sides */
    want.limit = 8;
    check(judge_one(&want, 18), true, 8, 0, 0);
    want.limit = 8.5;
    check(judge_one(&want, 18), false, 8, -0.5, 0);
    want.limit = 0;
    check(judge_one(&want, 5), false, 0, 0, 0);
    conus_verdict verdict = judge_one(&want, 40);
    check(verdict, true, 10, 10, 3);
    assert_near(verdict.depth, 10, 1e-9);
}

/* Boxes 1 and 3 touch: together they are [10, 22], and the face between them is no border. */
static void a_union_has_no_inner_border(void **state)
{
    (void)state;
    conus_constraint want = reach("1,3", 8);
    check(judge_one(&want, 40), true, 12, 4, 2);
    want.part[0] = 1;
    want.part[1] = 10; /* of a needle to 21 the depths 11 to 20: 1 mm from the end before them */
    check(judge_one(&want, 21), true, 9, 1, 2);
    want.limit = 9;
    check(judge_one(&want, 21), true, 9, 0, 1);
}

static void tips_and_crossings(void **state)
{
    (void)state;
    conus_constraint want = {.kind = CONUS_CONSTRAINT_REACH, .measure = CONUS_MEASURE_TIP, .names = "1"};
    check(judge_one(&want, 12), true, 1, 0, 2);
    check(judge_one(&want, 15), true, 1, 0, 3);
    check(judge_one(&want, 20), false, 0, -1, 0); /* half-open: it is in box 3 */
    want.measure = CONUS_MEASURE_CROSSED;
    check(judge_one(&want, 40), true, 1, 0, 3);
    check(judge_one(&want, 9), false, 0, -1, 0);
    want = (conus_constraint){.kind = CONUS_CONSTRAINT_FIRST, .names = "1,2"};
    conus_verdict verdict = judge_one(&want, 40);
    check(verdict, true, 1, 0, NAN);
    assert_near(verdict.depth, 10, 1e-9);
    assert_int_equal(verdict.object, 1);
    want.names = "3";
    check(judge_one(&want, 40), false, 0, -1, NAN);
}

/* Box 2 is 3 mm below the needle from x = 24 on. */
static void clearances(void **state)
{
    (void)state;
    conus_constraint want = avoid("2", 1);
    conus_verdict verdict = judge_one(&want, 26);
    check(verdict, true, 3, 1.5, 1.5);
    assert_near(verdict.depth, 24, 1e-9);
    assert_int_equal(verdict.object, 2);
    check(judge_one(&want, 20), true, 5, 3.5, 3.5);
    want.limit = 2.5;
    check(judge_one(&want, 26), false, 3, 0, 0); /* strictly */
    want = avoid("2,3", 0);
    verdict = judge_one(&want, 19);
    check(verdict, true, 1, 0.5, 0.5);
    assert_int_equal(verdict.object, 3);
    want = avoid("1", 0);
    check(judge_one(&want, 40), false, 0, -0.5, 0);
}

static void shape_of_the_needle(void **state)
{
    (void)state;
    conus_constraint want = {.kind = CONUS_CONSTRAINT_LENGTH, .limit = 5, .most = 20};
    check(judge_one(&want, 18), true, 18, 2, NAN);
    check(judge_one(&want, 25), false, 25, -5, NAN);
    want = (conus_constraint){.kind = CONUS_CONSTRAINT_LEAN, .limit = 57, .direction = {5, 5, 0}};
    check(judge_one(&want, 18), true, 45, 57 - 45, NAN);
    want.limit = 30;
    check(judge_one(&want, 18), false, 45, 30 - 45, NAN);
    const double others[12] = {0, 100, 13, 9, 100, 13, 7, 13, 17, 7, 30, 17};
    want = (conus_constraint){.kind = CONUS_CONSTRAINT_APART, .limit = 1, .needles = others, .needle_count = 2};
    conus_verdict verdict = judge_one(&want, 18);
    check(verdict, true, 4, 3, 3);
    assert_near(verdict.depth, 7, 1e-9);
    want.limit = 4;
    check(judge_one(&want, 18), false, 4, 0, 0);
}

/* A cylinder of 4 mm through boxes 1 and 3, which are 6 mm wide: 1 hides 3. Against the results of a selection. */
static void measures_of_a_cylinder(void **state)
{
    (void)state;
    static const struct {
        conus_measure measure;
        const char *names;
    } wants[] = {{CONUS_MEASURE_SHARE, "1"},     {CONUS_MEASURE_SHARE, "3"},    {CONUS_MEASURE_PIERCED, "1,3"},
                 {CONUS_MEASURE_PIERCED, "2,3"}, {CONUS_MEASURE_VOLUME, "1,3"}, {CONUS_MEASURE_FRACTION, "1,3"}};
    enum { COUNT = sizeof wants / sizeof *wants };
    conus_constraint constraints[COUNT + 1];
    struct needle_row row = {{0, 13, 13}, {1, 0, 0}, NAN, 21};
    conus_atlas *atlas = boxes();
    conus_selector_options options = {.radius = 4, .layers = CONUS_LAYERS_ALL, .range = {0, 21}};
    for (size_t i = 0; i < COUNT; i++) {
        constraints[i] = (conus_constraint){.measure = wants[i].measure, .names = wants[i].names};
    }
    constraints[COUNT] = (conus_constraint){
        .kind = CONUS_CONSTRAINT_AVOID, .measure = CONUS_MEASURE_PIERCED, .names = "3", .limit = 0.5};
    struct answer answer = ask(&(struct asked){.atlas = atlas,
                                               .selector = options,
                                               .constraints = constraints,
                                               .count = COUNT + 1,
                                               .options = {.infeasible = true, .rank = "share,volume"},
                                               .path = write_needles("cylinder.tsv", &row, 1)});
    const conus_planned *planned = conus_plan_pose(answer.plan, 0);
    conus_selection *selection = NULL;
    assert_ok(conus_select(&selection, answer.selector, &planned->pose, 0));
    const conus_result *first = conus_selection_result(selection, 0);
    const conus_result *second = conus_selection_result(selection, 1);
    assert_int_equal(conus_selection_count(selection), 3); /* with unassigned; box 2 is 3 mm off the axis, but behind */
    assert_int_equal(first->object, 1);
    assert_int_equal(second->object, 3);
    double part = (double)first->pierced / (first->pixels + conus_selection_result(selection, 2)->pixels);
    assert_true(part > 0.5 && part < 1 && first->pierced == second->pierced);
    const double values[COUNT] = {
        first->share, 0, part, part, first->volume + second->volume, (first->volume + second->volume) / (360 + 72)};
    for (size_t i = 0; i < COUNT; i++) {
        check(planned->verdicts[i], i != 1, values[i], values[i], NAN);
        assert_false(plan_asked_of(answer.plan)->constraints[i].has_leeway);
    }
    check(planned->verdicts[COUNT], false, part, 0.5 - part, NAN);
    assert_int_equal(planned->broken, 1);
    assert_true(isnan(planned->leeway));
    conus_selection_destroy(selection);
    end(&answer);
    conus_atlas_destroy(atlas);
}

/* Rows that are no candidates are counted, and the others keep their numbers. */
static void rows_without_a_needle(void **state)
{
    (void)state;
    const struct needle_row rows[] = {
        {{0, 13, 13}, {NAN, NAN, NAN}, NAN, 18}, {{0, 13, 13}, {1, 0, 0}, NAN, NAN}, {{0, 13, 13}, {1, 0, 0}, NAN, 18}};
    conus_constraint want = reach("1", 0);
    conus_atlas *atlas = boxes();
    struct asked asked = {
        .atlas = atlas, .constraints = &want, .count = 1, .path = write_needles("faults.tsv", rows, 3)};
    struct answer answer = ask(&asked);
    conus_plan_faults faults = conus_plan_rejected(answer.plan);
    assert_int_equal(faults.count, 2);
    assert_int_equal(faults.line, 2);
    assert_true(faults.why[0] != '\0');
    assert_int_equal(conus_plan_left(answer.plan, 0), 1);
    assert_int_equal(conus_plan_pose(answer.plan, 0)->candidate, 3);
    end(&answer);
    asked.options.far = 12;
    answer = ask(&asked);
    assert_int_equal(conus_plan_left(answer.plan, 0), 2);
    assert_int_equal(conus_plan_count(answer.plan), 2);
    assert_near(conus_plan_pose(answer.plan, 0)->leeway, 3, 1e-6); /* to 18: the sides; to 12: the face at 10 */
    assert_near(conus_plan_pose(answer.plan, 1)->leeway, 2, 1e-6);
    assert_int_equal(conus_plan_pose(answer.plan, 1)->candidate, 2);
    assert_int_equal(conus_plan_pose(answer.plan, 1)->rank, 2);
    assert_null(conus_plan_pose(answer.plan, 2));
    end(&answer);
    conus_atlas_destroy(atlas);
}

/* A pose tried alone has all measures of its row in a list, among them the leeways of 2.5 and 3 mm of
 * lengths_and_their_leeways(); before and after a run. */
static void a_pose_tried_by_itself(void **state)
{
    (void)state;
    const struct needle_row needle = {{0, 13, 13}, {1, 0, 0}, NAN, 18};
    const conus_constraint wants[2] = {reach("1", 5), avoid("2", 1)};
    conus_pose_row row = {.id = "mine", .range = {NAN, 18}};
    conus_atlas *atlas = boxes();
    const conus_planned *tried = NULL;
    struct answer answer = {0};
    assert_ok(conus_pose_along(&row.pose, needle.at, needle.along, NULL));
    assert_ok(conus_selector_create(&answer.selector, atlas, &(conus_selector_options){.radius = 0.5}));
    assert_ok(conus_plan_create(&answer.plan, answer.selector, wants, 2, NULL));
    for (int time = 0; time < 2; time++) {
        assert_ok(conus_plan_try(&tried, answer.plan, &row));
        assert_string_equal(tried->id, "mine");
        assert_true(tried->feasible && tried->broken == SIZE_MAX && tried->rank == 0 && tried->candidate == 0);
        check(tried->verdicts[0], true, 8, 3, 2.5);
        check(tried->verdicts[1], true, hypot(6, 3), hypot(6, 3) - 1.5, hypot(6, 3) - 1.5);
        assert_near(tried->leeway, 2.5, 1e-6);
        assert_near(tried->slack, hypot(6, 3) - 1.5, 1e-9);
        if (time == 0) {
            conus_pose_stream *stream = NULL;
            assert_ok(conus_pose_stream_open(&stream, write_needles("tried.tsv", &needle, 1), NULL));
            assert_ok(conus_plan_run(answer.plan, stream, UINT64_MAX));
            conus_pose_stream_destroy(stream);
        }
    }
    row.range[1] = 26;
    row.range[0] = 16;
    assert_ok(conus_plan_try(&tried, answer.plan, &row));
    assert_false(tried->feasible);
    assert_int_equal(tried->broken, 0);
    check(tried->verdicts[0], false, 4, -1, 0);
    check(tried->verdicts[1], true, 3, 1.5, 1.5);
    assert_near(conus_plan_pose(answer.plan, 0)->far, 18, 0);
    row.range[1] = NAN;
    assert_fails(conus_plan_try(&tried, answer.plan, &row), CONUS_ERROR_ARGUMENT);
    row.error = "no pose";
    assert_fails(conus_plan_try(&tried, answer.plan, &row), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "no pose");
    row.error = NULL;
    row.range[1] = 26;
    row.pose.world_from_device[0] = 2;
    assert_fails(conus_plan_try(&tried, answer.plan, &row), CONUS_ERROR_ARGUMENT);
    end(&answer);
    conus_atlas_destroy(atlas);
}

/* Three shanks beside an axis at y = 13, z = 13 along x to 18: with the usual rotation (Eq. 2) the device's y is the
 * world's z and its x the world's -y. They lie at z = 13, 15 and 30: 3 mm and 1 mm inside of box 1, and outside of it;
 * the last is 14 mm above it from x = 10 on. */
static const double shanks[3][2] = {{0, 0}, {0, 2}, {0, 17}};

static conus_planned try_shanks(struct answer *answer, const conus_atlas *atlas, const conus_constraint *want)
{
    conus_pose_row row = {.id = "probe", .range = {NAN, 18}};
    const conus_planned *tried = NULL;
    assert_ok(conus_pose_along(&row.pose, (double[]){0, 13, 13}, (double[]){1, 0, 0}, NULL));
    assert_ok(conus_selector_create(&answer->selector, atlas, &(conus_selector_options){.radius = 0.5}));
    assert_ok(conus_plan_create(&answer->plan, answer->selector, want, 1,
                                &(conus_plan_options){.threads = 1, .shanks = shanks[0], .shank_count = 3}));
    assert_ok(conus_plan_try(&tried, answer->plan, &row));
    return *tried;
}

static void any_all_or_one_shank(void **state)
{
    (void)state;
    static const struct {
        conus_constraint want;
        bool holds;
        double value, slack, leeway;
        uint32_t shank;
    } cases[] = {
        /* [10 + d, 18] and the face at 20 leave 10 - 2 d from d = 2 on; the sides are 3 and 1 mm away */
        {{.names = "1", .limit = 5}, true, 8, 3, 2.5, 1},
        {{.names = "1", .limit = 5, .shank = 1}, true, 8, 3, 2.5, 1},
        {{.names = "1", .limit = 5, .shank = 2}, true, 8, 3, 1, 2},
        {{.names = "1", .limit = 5, .shank = 3}, false, 0, -5, 0, 3},
        {{.names = "1", .limit = 5, .shank = CONUS_SHANK_ALL}, false, 0, -5, 0, 3},
        {{.names = "1", .measure = CONUS_MEASURE_TIP}, true, 1, 0, 2, 1}, /* 2 mm before the face at 20 */
        {{.names = "1", .measure = CONUS_MEASURE_TIP, .shank = 2}, true, 1, 0, 1, 2},
        {{.kind = CONUS_CONSTRAINT_AVOID, .names = "1", .limit = 1}, false, 0, -1.5, 0, 1},
        {{.kind = CONUS_CONSTRAINT_AVOID, .names = "1", .limit = 1, .shank = 3}, true, 14, 12.5, 12.5, 3},
        {{.kind = CONUS_CONSTRAINT_AVOID, .names = "1", .limit = 1, .shank = CONUS_SHANK_ANY}, true, 14, 12.5, 12.5, 3},
        {{.kind = CONUS_CONSTRAINT_AVOID, .names = "3", .limit = 1}, true, 2, 0.5, 0.5, 1}, /* from 18 to 20 */
        {{.kind = CONUS_CONSTRAINT_LENGTH, .most = 20}, true, 18, 2, NAN, 1},
        {{.kind = CONUS_CONSTRAINT_LEAN, .limit = 1, .direction = {1, 0, 0}, .shank = 2}, true, 0, 1, NAN, 1},
        {{.kind = CONUS_CONSTRAINT_FIRST, .names = "1"}, false, 0, -1, NAN, 3},
        {{.kind = CONUS_CONSTRAINT_FIRST, .names = "1", .shank = CONUS_SHANK_ANY}, true, 1, 0, NAN, 1},
    };
    conus_atlas *atlas = boxes();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct answer answer = {0};
        const conus_planned planned = try_shanks(&answer, atlas, &cases[i].want);
        check(planned.verdicts[0], cases[i].holds, cases[i].value, cases[i].slack, cases[i].leeway);
        assert_int_equal(planned.verdicts[0].shank, cases[i].shank);
        assert_int_equal(planned.feasible, cases[i].holds);
        end(&answer);
    }
    conus_atlas_destroy(atlas);
}

enum { NEEDLES = 400, MANY = 2500 };

/* Needles from around the boxes towards them. */
static const char *write_random(const char *name, size_t count)
{
    static struct needle_row rows[MANY];
    uint64_t seed = 5;
    for (size_t i = 0; i < count; i++) {
        double target[3] = {test_random(&seed, 8, 24), test_random(&seed, 8, 18), test_random(&seed, 8, 18)};
        double length = 0;
        for (int a = 0; a < 3; a++) {
            rows[i].at[a] = test_random(&seed, -10, 45);
            rows[i].along[a] = target[a] - rows[i].at[a];
            length += rows[i].along[a] * rows[i].along[a];
        }
        rows[i].near = NAN;
        rows[i].far = sqrt(length) + test_random(&seed, -2, 6);
        rows[i].far = rows[i].far < 1 ? 1 : rows[i].far;
    }
    return write_needles(name, rows, count);
}

/* A whole list as text. */
static void describe(struct buffer *out, const struct answer *answer, size_t constraints)
{
    char number[TEXT_NUMBER_SIZE];
    for (size_t k = 0; k <= constraints; k++) {
        const conus_planned *miss = k < constraints ? conus_plan_miss(answer->plan, k) : NULL;
        buffer_format(out, "%llu %s\n", (unsigned long long)conus_plan_left(answer->plan, k), miss ? miss->id : "-");
    }
    for (size_t i = 0; i < conus_plan_count(answer->plan); i++) {
        const conus_planned *p = conus_plan_pose(answer->plan, i);
        buffer_format(out, "%a %s %llu %llu %d %zu %a %zu %a %a %zu %s", p->p_ok, p->id,
                      (unsigned long long)p->candidate, (unsigned long long)p->rank, p->feasible, p->broken, p->leeway,
                      p->leeway_of, p->slack, p->clearance, p->clearance_of, text_number(number, p->score));
        for (size_t k = 0; k < constraints; k++) {
            const conus_verdict *v = &p->verdicts[k];
            buffer_format(out, " %d %a %a %a %a %u %a", v->holds, v->value, v->slack, v->leeway, v->depth, v->object,
                          v->p);
        }
        buffer_text(out, "\n");
    }
    assert_ok(buffer_status(out));
}

static void same_with_any_threads_and_pruning(void **state)
{
    (void)state;
    static const conus_jitter_options off = {.tilt = 1.7, .shift = 0.5, .samples = 64};
    static const conus_jitter_options ends = {.entry = 0.5, .target = 1, .depth = 0.5, .samples = 32};
    static const conus_plan_options ways[] = {
        {.top = 5},
        {.top = 5, .rank = "p_ok,-depth", .jitter = &off},
        {.top = 4, .rank = "leeway/0.5,p_ok", .jitter = &off, .infeasible = true},
        {.top = 4, .rank = "p_ok/0.25,score", .score = "p_ok * leeway", .jitter = &ends},
        {.top = 5, .rank = "slack"},
        {.top = 7, .rank = "clearance/0.5,-reach"},
        {.top = 3, .rank = "leeway/0.25,-depth", .infeasible = true},
        {.top = UINT64_MAX, .infeasible = true},
        {.top = 4, .rank = "score", .score = "leeway + 0.1 * slack - depth / 100"},
        {.top = 10, .rank = "-depth"},
    };
    conus_constraint wants[3] = {reach("1", 4), avoid("2", 1), avoid("3", 0.25)};
    conus_atlas *atlas = boxes();
    const char *path = write_random("random.tsv", NEEDLES);
    for (size_t margin = 0; margin < 2; margin++) { /* the second has no answer, but misses */
        wants[1].limit = margin ? 100 : 1;
        for (size_t w = 0; w < test_trials(sizeof ways / sizeof *ways); w++) {
            struct buffer first = {0};
            for (int way = 0; way < 4; way++) {
                struct asked asked = {.atlas = atlas, .selector = {.radius = 0.3}, .constraints = wants, .count = 3};
                asked.options = ways[w];
                asked.measures_all = way == 0;
                asked.options.threads = (const uint32_t[]){1, 1, 2, 7}[way];
                asked.path = path;
                struct answer answer = ask(&asked);
                struct buffer text = {0};
                describe(&text, &answer, 3);
                end(&answer);
                if (way == 0) {
                    first = text;
                } else {
                    assert_string_equal(text.data, first.data);
                    buffer_finish(&text);
                }
            }
            buffer_finish(&first);
        }
    }
    conus_atlas_destroy(atlas);
}

/* So many needles that maps decide about the later ones. */
static void same_of_many(void **state)
{
    (void)state;
    static const uint32_t threads[3] = {2, 1, 3};
    const conus_constraint wants[3] = {reach("1", 4), avoid("2", 1), avoid("3", 0.25)};
    conus_atlas *atlas = boxes();
    struct asked asked = {.atlas = atlas,
                          .selector = {.radius = 0.3},
                          .constraints = wants,
                          .count = 3,
                          .path = write_random("many.tsv", MANY)};
    struct buffer texts[3] = {0};
    for (int way = 0; way < 3; way++) {
        asked.options = (conus_plan_options){.top = 5, .threads = threads[way]};
        asked.measures_all = way == 0;
        struct answer answer = ask(&asked);
        describe(&texts[way], &answer, 3);
        end(&answer);
        assert_string_equal(texts[way].data, texts[0].data);
    }
    for (int way = 0; way < 3; way++) {
        buffer_finish(&texts[way]);
    }
    conus_atlas_destroy(atlas);
}

/* With shanks, too, neither pruning nor threads change anything. */
static void same_of_many_shanks(void **state)
{
    (void)state;
    const conus_constraint wants[4] = {
        {.names = "1", .limit = 2},
        {.names = "1,3", .limit = 1, .shank = CONUS_SHANK_ALL},
        {.kind = CONUS_CONSTRAINT_AVOID, .names = "2", .limit = 1},
        {.kind = CONUS_CONSTRAINT_AVOID, .names = "3", .limit = 0.25, .shank = CONUS_SHANK_ANY}};
    static const double pair[2][2] = {{-1, 0}, {1, 0.5}};
    conus_atlas *atlas = boxes();
    struct asked asked = {.atlas = atlas,
                          .selector = {.radius = 0.3},
                          .constraints = wants,
                          .count = 4,
                          .path = write_random("shanks.tsv", MANY)};
    struct buffer texts[3] = {0};
    for (int way = 0; way < 3; way++) {
        asked.options =
            (conus_plan_options){.top = 5, .threads = 1 + (uint32_t)way, .shanks = pair[0], .shank_count = 2};
        asked.measures_all = way == 0;
        struct answer answer = ask(&asked);
        describe(&texts[way], &answer, 4);
        assert_int_equal(conus_plan_count(answer.plan), 5);
        end(&answer);
        assert_string_equal(texts[way].data, texts[0].data);
    }
    for (int way = 0; way < 3; way++) {
        buffer_finish(&texts[way]);
    }
    conus_atlas_destroy(atlas);
}

/* A longer reach, a larger margin and one more constraint only remove poses. */
static void stricter_is_fewer(void **state)
{
    (void)state;
    conus_constraint wants[3] = {reach("1", 1), avoid("2", 0.5), avoid("3", 0)};
    conus_atlas *atlas = boxes();
    struct asked asked = {.atlas = atlas,
                          .constraints = wants,
                          .options = {.top = UINT64_MAX, .threads = 1},
                          .path = write_random("stricter.tsv", NEEDLES)};
    bool before[NEEDLES + 1];
    memset(before, true, sizeof before);
    uint64_t last = NEEDLES;
    for (int step = 0; step < 5; step++) {
        bool now[NEEDLES + 1] = {false};
        wants[0].limit = step >= 1 ? 4 : 1;
        wants[1].limit = step >= 2 ? 3 : 0.5;
        asked.count = step >= 3 ? 3 : 2;
        wants[2].limit = step >= 4 ? 1 : 0;
        struct answer answer = ask(&asked);
        for (size_t i = 0; i < conus_plan_count(answer.plan); i++) {
            uint64_t candidate = conus_plan_pose(answer.plan, i)->candidate;
            assert_true(before[candidate]);
            now[candidate] = true;
        }
        assert_int_equal(conus_plan_left(answer.plan, asked.count), conus_plan_count(answer.plan));
        assert_true(conus_plan_count(answer.plan) < last && conus_plan_count(answer.plan) > 0);
        last = conus_plan_count(answer.plan);
        memcpy(before, now, sizeof before);
        end(&answer);
    }
    conus_atlas_destroy(atlas);
}

static double printed(double value)
{
    char text[TEXT_NUMBER_SIZE];
    return strtod(text_number(text, value), NULL);
}

/* Checks the list by its text alone: no pose is followed by a better one, and equal ones are in the order of
 * candidates. */
static void ranks_by_what_is_printed(void **state)
{
    (void)state;
    conus_constraint wants[2] = {reach("1", 0), avoid("2", 0)};
    conus_atlas *atlas = boxes();
    struct answer answer = ask(
        &(struct asked){.atlas = atlas,
                        .constraints = wants,
                        .count = 2,
                        .options = {.top = UINT64_MAX, .rank = " -reach/2, score", .score = "leeway * 2 - slack / 3"},
                        .path = write_random("ranks.tsv", NEEDLES)});
    size_t count = conus_plan_count(answer.plan);
    assert_true(count > 100);
    for (size_t i = 0; i < count; i++) {
        const conus_planned *a = conus_plan_pose(answer.plan, i);
        assert_int_equal(a->rank, i + 1);
        assert_near(a->score, a->leeway * 2 - a->slack / 3, 1e-12);
        assert_near(a->leeway, fmin(a->verdicts[0].leeway, a->verdicts[1].leeway), 0);
        assert_int_equal(a->leeway_of, a->verdicts[1].leeway < a->verdicts[0].leeway);
        if (i + 1 < count) {
            const conus_planned *b = conus_plan_pose(answer.plan, i + 1);
            double steps = floor(printed(b->verdicts[0].value) / 2) - floor(printed(a->verdicts[0].value) / 2);
            assert_true(steps >= 0);
            assert_true(steps > 0 || printed(a->score) > printed(b->score) ||
                        (printed(a->score) == printed(b->score) && a->candidate < b->candidate));
        }
    }
    end(&answer);
    conus_atlas_destroy(atlas);
}

/* Without a feasible pose, the poses that break one constraint by the least. */
static void nearest_misses(void **state)
{
    (void)state;
    const struct needle_row rows[] = {{{0, 13, 13}, {1, 0, 0}, NAN, 13}, /* 3 of 5 mm */
                                      {{0, 13, 13}, {1, 0, 0}, NAN, 14}, /* 4 of 5 mm */
                                      {{0, 13, 13}, {1, 0, 0}, NAN, 26}, /* 3 of 3.5 mm from box 2 */
                                      {{0, 13, 12}, {1, 0, 0}, NAN, 26}, /* 2 of 3.5 mm */
                                      {{0, 13, 30}, {1, 0, 0}, NAN, 26}, /* reaches nothing */
                                      {{0, 13, 12}, {1, 0, 0}, 13, 26}}; /* breaks two */
    conus_constraint wants[3] = {reach("1", 5), avoid("2", 3.5), {.kind = CONUS_CONSTRAINT_LENGTH, .most = 26}};
    conus_atlas *atlas = boxes();
    struct asked asked = {
        .atlas = atlas, .constraints = wants, .count = 3, .path = write_needles("misses.tsv", rows, 6)};
    wants[0].limit = 9.5;
    wants[1].limit = 3.5;
    struct answer answer = ask(&asked);
    assert_int_equal(conus_plan_count(answer.plan), 0);
    assert_int_equal(conus_plan_left(answer.plan, 0), 6);
    assert_int_equal(conus_plan_left(answer.plan, 1), 2);
    assert_int_equal(conus_plan_left(answer.plan, 3), 0);
    assert_string_equal(conus_plan_miss(answer.plan, 0)->id, "n2");
    assert_string_equal(conus_plan_miss(answer.plan, 1)->id, "n3");
    assert_near(conus_plan_miss(answer.plan, 1)->verdicts[1].value, 3, 1e-9);
    assert_null(conus_plan_miss(answer.plan, 2));
    end(&answer);
    wants[1].limit = 2.5; /* n3 holds all */
    answer = ask(&asked);
    assert_int_equal(conus_plan_count(answer.plan), 1);
    assert_null(conus_plan_miss(answer.plan, 0));
    double distance = 0;
    assert_ok(conus_plan_distance(&distance, answer.plan, 0, 1, 20)); /* 4 mm before box 2, and 3 above it */
    assert_near(distance, 5, 1e-9);
    assert_fails(conus_plan_distance(&distance, answer.plan, 1, 1, 20), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_plan_distance(&distance, answer.plan, 0, 2, 20), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_plan_distance(&distance, answer.plan, 0, 1, NAN), CONUS_ERROR_ARGUMENT);
    conus_pose_stream *stream = NULL;
    assert_ok(conus_pose_stream_open(&stream, asked.path, NULL));
    assert_fails(conus_plan_run(answer.plan, stream, 1), CONUS_ERROR_ARGUMENT);
    conus_pose_stream_destroy(stream);
    end(&answer);
    conus_atlas_destroy(atlas);
}

static void bad_arguments(void **state)
{
    (void)state;
    static const conus_constraint bad[] = {
        {.kind = (conus_constraint_kind)99},
        {.names = NULL},
        {.names = "nothing"},
        {.names = "1,"},
        {.names = "1", .limit = -1},
        {.names = "1", .limit = NAN},
        {.names = "1", .measure = (conus_measure)99},
        {.names = "1", .measure = CONUS_MEASURE_TIP, .limit = 1},
        {.names = "1", .measure = CONUS_MEASURE_SHARE, .limit = 1.5},
        {.names = "1", .measure = CONUS_MEASURE_VOLUME}, /* without all layers */
        {.names = "1", .part = {2, 1}},
        {.names = "1", .part = {-1, 1}},
        {.names = "1", .measure = CONUS_MEASURE_TIP, .part = {0, 1}},
        {.kind = CONUS_CONSTRAINT_AVOID, .names = "1", .limit = 100.5},
        {.kind = CONUS_CONSTRAINT_AVOID, .names = "1", .measure = CONUS_MEASURE_TIP},
        {.kind = CONUS_CONSTRAINT_LENGTH, .limit = 2, .most = 1},
        {.kind = CONUS_CONSTRAINT_LEAN, .limit = 1},
        {.kind = CONUS_CONSTRAINT_LEAN, .limit = 181, .direction = {1}},
        {.kind = CONUS_CONSTRAINT_APART, .limit = 1},
        {.names = "1", .shank = 2},
        {.names = "1", .shank = -3},
    };
    static const struct {
        conus_constraint pair[2];
        bool fits;
    } pairs[] = {
        {{{.names = "1"}, {.kind = CONUS_CONSTRAINT_AVOID, .names = "1,2"}}, false},
        {{{.names = "1,2"}, {.kind = CONUS_CONSTRAINT_AVOID, .names = "1"}}, true},
        {{{.names = "1,2"}, {.names = "2,1", .limit = 3}}, false},
        {{{.names = "1"}, {.names = "1", .part = {0, 1}}}, true},
        {{{.kind = CONUS_CONSTRAINT_LENGTH, .most = 1}, {.kind = CONUS_CONSTRAINT_LENGTH, .most = 2}}, false},
    };
    static const double beyond[4] = {0, 0, 0, 1001};
    static const conus_plan_options options[] = {
        {.rank = "depht"},  {.rank = "reach2"}, {.rank = "depth/0"}, {.rank = "depth*2"},
        {.rank = ""},       {.rank = "share"},  {.score = "2 *"},    {.score = "score"},
        {.rank = "score"},  {.far = -1},        {.far = NAN},        {.shanks = beyond, .shank_count = 2},
        {.shanks = beyond}, {.angle = 181},     {.threads = 100000},
    };
    conus_atlas *atlas = boxes();
    conus_selector *selector = NULL;
    conus_plan *plan = NULL;
    assert_ok(conus_selector_create(&selector, atlas, NULL));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_fails(conus_plan_create(&plan, selector, &bad[i], 1, NULL), CONUS_ERROR_ARGUMENT);
        assert_null(plan);
    }
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        assert_fails(conus_plan_create(&plan, selector, pairs[i].pair, 2, NULL),
                     pairs[i].fits ? CONUS_OK : CONUS_ERROR_ARGUMENT);
        conus_plan_destroy(plan);
        plan = NULL;
    }
    for (size_t i = 0; i < sizeof options / sizeof *options; i++) {
        assert_fails(conus_plan_create(&plan, selector, pairs[0].pair, 1, &options[i]), CONUS_ERROR_ARGUMENT);
    }
    assert_fails(conus_plan_create(&plan, selector, pairs[0].pair, 0, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_plan_create(&plan, selector, &(conus_constraint){.names = "bx1"}, 1, NULL),
                 CONUS_ERROR_ARGUMENT);
    assert_true(strstr(conus_message(), "reach: ") != NULL);
    conus_plan_destroy(NULL);
    assert_int_equal(conus_plan_count(NULL), 0);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

static conus_status attempt(void *data)
{
    static const char *const lists[] = {"constraints", "entries", "targets"};
    struct answer answer = {0};
    conus_status status = try_ask(&answer, data);
    const conus_planned *tried;
    conus_pose_row row = {.id = "a name", .range = {NAN, 18}};
    status = status ? status : conus_pose_along(&row.pose, (double[]){0, 13, 13}, (double[]){1, 0, 0}, NULL);
    status = status ? status : conus_plan_try(&tried, answer.plan, &row);
    for (size_t i = 0; i < sizeof lists / sizeof *lists && !status; i++) {
        conus_table *list = NULL;
        status = conus_plan_list(&list, answer.plan, lists[i]);
        assert_true(!status == (list != NULL));
        conus_table_destroy(list);
    }
    end(&answer);
    return status;
}

static void every_failing_allocation_is_survived(void **state)
{
    (void)state;
    const struct needle_row rows[] = {{{0, 13, 13}, {1, 0, 0}, NAN, 18}, {{0, 13, 28}, {1, 0, 0}, NAN, 18}};
    const double other[6] = {0, 0, 0, 0, 0, 1};
    conus_constraint wants[3] = {
        reach("1", 5), avoid("2", 1), {.kind = CONUS_CONSTRAINT_APART, .needles = other, .needle_count = 1}};
    conus_atlas *atlas = boxes();
    struct asked asked = {.atlas = atlas,
                          .constraints = wants,
                          .count = 3,
                          .options = {.threads = 1,
                                      .infeasible = true,
                                      .score = "leeway * p_ok",
                                      .jitter = &(const conus_jitter_options){.shift = 1, .samples = 16}},
                          .path = write_needles("memory.tsv", rows, 2)};
    test_every_allocation(attempt, &asked);
    wants[1].limit = 50; /* a miss */
    test_every_allocation(attempt, &asked);
    conus_atlas_destroy(atlas);
}

static bool stop_at_once(void *user, size_t done, size_t total)
{
    *(size_t *)user = done;
    assert_int_equal(total, 0);
    return false;
}

static void progress_ends_a_run(void **state)
{
    (void)state;
    size_t done = 0;
    conus_constraint want = reach("1", 0);
    conus_atlas *atlas = boxes();
    struct answer answer = {0};
    struct asked asked = {.atlas = atlas,
                          .constraints = &want,
                          .count = 1,
                          .options = {.threads = 2, .progress = stop_at_once, .progress_user = &done},
                          .path = write_random("progress.tsv", NEEDLES)};
    assert_fails(try_ask(&answer, &asked), CONUS_ERROR_CANCELLED);
    assert_true(done > 0 && done < NEEDLES);
    assert_int_equal(conus_plan_count(answer.plan), 0);
    end(&answer);
    conus_atlas_destroy(atlas);
}

/* A plan as text: its list, its funnel, its misses and the best of each entry and target. */
static char *tell(const conus_plan *plan, const conus_plan_options *options)
{
    static const char *const lists[] = {"entries", "targets"};
    const uint64_t counts[] = {options->entries, options->targets};
    struct buffer out = {0};
    for (size_t i = 0; i < conus_plan_count(plan); i++) {
        const conus_planned *pose = conus_plan_pose(plan, i);
        buffer_format(&out, "%s %llu %zu %.17g\n", pose->id, (unsigned long long)pose->rank, pose->broken,
                      pose->leeway);
    }
    for (size_t i = 0; i <= conus_plan_constraint_count(plan); i++) {
        const conus_planned *miss = conus_plan_miss(plan, i);
        buffer_format(&out, "%llu %s\n", (unsigned long long)conus_plan_left(plan, i), miss ? miss->id : "");
    }
    for (size_t k = 0; k < 2; k++) {
        conus_table *bests = NULL;
        assert_ok(conus_plan_list(&bests, plan, lists[k]));
        assert_int_equal(conus_table_rows(bests), counts[k]);
        for (uint64_t i = 0; i < counts[k]; i++) {
            buffer_format(&out, "%llu %llu %.17g\n", (unsigned long long)conus_table_counts(bests, "feasible")[i],
                          (unsigned long long)conus_table_counts(bests, "candidate")[i],
                          conus_table_numbers(bests, "leeway_mm")[i]);
        }
        conus_table_destroy(bests);
    }
    assert_ok(buffer_status(&out));
    return out.data;
}

enum { ENTRIES = 12, TARGETS = 30, PAIRS = ENTRIES * TARGETS };

/* Needles from points below the boxes into and beside them. */
static conus_pose_stream *pairs(void)
{
    static double entries[ENTRIES][3], targets[TARGETS][3];
    conus_pose_stream *stream = NULL;
    for (size_t i = 0; i < ENTRIES; i++) {
        memcpy(entries[i], (double[]){5 + 2.1 * (double)i, 12, -3}, sizeof entries[i]);
    }
    for (size_t i = 0; i < TARGETS; i++) {
        memcpy(targets[i], (double[]){8 + 0.7 * (double)i, 9 + 0.3 * (double)i, 13}, sizeof targets[i]);
    }
    assert_ok(conus_candidates_open(&stream, &(conus_candidates){.entries = entries[0],
                                                                 .entry_count = ENTRIES,
                                                                 .targets = targets[0],
                                                                 .target_count = TARGETS,
                                                                 .to_target = true,
                                                                 .beyond = 2}));
    return stream;
}

/* Ends a run when it has asked so many times. */
struct halt {
    size_t calls, most;
};

static bool halt_after(void *user, size_t done, size_t total)
{
    struct halt *halt = user;
    (void)done;
    (void)total;
    return ++halt->calls < halt->most;
}

/* A plan of rows up to `limit` that is cancelled at question `most`, and cut then. */
static conus_plan *run_until(conus_selector *selector, const struct asked *asked, uint64_t limit, size_t most)
{
    struct halt halt = {.most = most};
    conus_plan_options options = asked->options;
    conus_pose_stream *stream = pairs();
    conus_plan *plan = NULL;
    options.progress = halt_after;
    options.progress_user = &halt;
    assert_ok(conus_plan_create(&plan, selector, asked->constraints, asked->count, &options));
    assert_fails(conus_plan_cut(plan), CONUS_ERROR_ARGUMENT);
    conus_status status = conus_plan_run(plan, stream, limit);
    assert_int_equal(status, halt.calls >= most ? CONUS_ERROR_CANCELLED : CONUS_OK);
    if (status) {
        assert_int_equal(conus_plan_count(plan), 0);
        assert_ok(conus_plan_cut(plan));
    }
    assert_fails(conus_plan_cut(plan), CONUS_ERROR_ARGUMENT);
    conus_pose_stream_destroy(stream);
    return plan;
}

/* A plan that is cut, while it tries poses or asks the listed ones for their chances, is that of the rows tried. */
static void cut_is_the_plan_of_what_was_tried(void **state)
{
    (void)state;
    const conus_constraint wants[2][2] = {{reach("1", 2), avoid("2", 3)}, {reach("1", 2), avoid("2", 90)}};
    const conus_jitter_options jitter = {.tilt = 1.2, .shift = 0.5, .samples = 16};
    const conus_plan_options options[] = {
        {.top = 5, .entries = ENTRIES, .targets = TARGETS},
        {.top = 40, .infeasible = true, .threads = 3},
        {.top = 30, .infeasible = true, .jitter = &jitter, .threads = 2},
    };
    conus_atlas *atlas = boxes();
    conus_selector *selector = NULL;
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.radius = 0.4}));
    for (size_t o = 0; o < 6; o++) {
        struct asked asked = {.constraints = wants[o & 1], .count = 2, .options = options[o / 2]};
        for (size_t most = 1; most < 40; most += 3) {
            conus_plan *plan = run_until(selector, &asked, UINT64_MAX, most);
            uint64_t rows = conus_plan_left(plan, 0) + conus_plan_rejected(plan).count;
            conus_plan *wanted = run_until(selector, &asked, rows, SIZE_MAX);
            char *told = tell(plan, &asked.options);
            char *whole = tell(wanted, &asked.options);
            assert_true(most > 4 ? rows > 4 * 20 : rows < PAIRS);
            assert_string_equal(told, whole);
            memory_free(told);
            memory_free(whole);
            conus_plan_destroy(plan);
            conus_plan_destroy(wanted);
        }
    }
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

/* After 2,048 poses maps replace some of the measurements. The leeways of all are the same doubles as without. */
static void pruning_changes_no_digit(void **state)
{
    (void)state;
    enum { SIDE = 54 };
    const conus_constraint wants[] = {reach("1", 0.5), avoid("2", 1)};
    double entries[SIDE][3];
    double targets[SIDE][3];
    uint64_t seed = 31;
    char *told[2];
    conus_atlas *atlas = boxes();
    conus_selector *selector = NULL;
    for (size_t i = 0; i < SIDE; i++) {
        memcpy(entries[i], (double[]){test_random(&seed, 0, 30), test_random(&seed, 0, 25), -3}, sizeof entries[i]);
        memcpy(targets[i], (double[]){test_random(&seed, 8, 30), test_random(&seed, 8, 20), 13}, sizeof targets[i]);
    }
    assert_ok(conus_selector_create(&selector, atlas, &(conus_selector_options){.radius = 0.2}));
    for (int measures_all = 0; measures_all < 2; measures_all++) {
        const conus_plan_options options = {.threads = 1, .top = UINT64_MAX};
        conus_plan *plan = NULL;
        conus_pose_stream *stream = NULL;
        assert_ok(conus_candidates_open(&stream, &(conus_candidates){.entries = entries[0],
                                                                     .entry_count = SIDE,
                                                                     .targets = targets[0],
                                                                     .target_count = SIDE,
                                                                     .to_target = true,
                                                                     .beyond = 3}));
        assert_ok(conus_plan_create(&plan, selector, wants, 2, &options));
        if (measures_all) {
            plan_measure_all(plan);
        }
        assert_ok(conus_plan_run(plan, stream, UINT64_MAX));
        assert_true(conus_plan_count(plan) > 200);
        told[measures_all] = tell(plan, &options);
        conus_pose_stream_destroy(stream);
        conus_plan_destroy(plan);
    }
    assert_string_equal(told[0], told[1]);
    memory_free(told[0]);
    memory_free(told[1]);
    conus_selector_destroy(selector);
    conus_atlas_destroy(atlas);
}

TEST_GROUP(plan)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths_and_their_leeways),
        cmocka_unit_test(a_union_has_no_inner_border),
        cmocka_unit_test(tips_and_crossings),
        cmocka_unit_test(clearances),
        cmocka_unit_test(shape_of_the_needle),
        cmocka_unit_test(measures_of_a_cylinder),
        cmocka_unit_test(rows_without_a_needle),
        cmocka_unit_test(a_pose_tried_by_itself),
        cmocka_unit_test(any_all_or_one_shank),
        cmocka_unit_test(same_of_many_shanks),
        cmocka_unit_test(same_with_any_threads_and_pruning),
        cmocka_unit_test(same_of_many),
        cmocka_unit_test(stricter_is_fewer),
        cmocka_unit_test(ranks_by_what_is_printed),
        cmocka_unit_test(nearest_misses),
        cmocka_unit_test(bad_arguments),
        cmocka_unit_test(every_failing_allocation_is_survived),
        cmocka_unit_test(progress_ends_a_run),
        cmocka_unit_test(cut_is_the_plan_of_what_was_tried),
        cmocka_unit_test(pruning_changes_no_digit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
