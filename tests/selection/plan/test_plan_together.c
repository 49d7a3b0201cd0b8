/* SPDX-License-Identifier: BSD-3-Clause */
/* Eq. 25, Eq. 26, Eq. 27 and Eq. 28: several needles together, against all combinations, each measured by another way
 * to find the distance of two segments: the least of where their lines are nearest, if that is on both, and of each end
 * from the other segment. */
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "scene.h"
#include "test.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { NEEDLES = 5, CANDIDATES = 900 };

static const size_t DIM[3] = {40, 30, 30};
static const double CELLS[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0.5, 0.5, 0.5, 1}; /* cell i is [i, i + 1] */

/* 1: [10, 20] x [10, 16] x [10, 16]. 2: [4, 8] x [4, 8] x [4, 8]. */
static conus_atlas *boxes(void)
{
    conus_volume_info grid = scene_plain_grid(DIM, CELLS);
    uint32_t *labels = memory_zeroed(DIM[0] * DIM[1] * DIM[2], sizeof *labels);
    assert_non_null(labels);
    for (size_t k = 0; k < DIM[2]; k++) {
        for (size_t j = 0; j < DIM[1]; j++) {
            for (size_t i = 0; i < DIM[0]; i++) {
                bool in_first = i >= 10 && i < 20 && j >= 10 && j < 16 && k >= 10 && k < 16;
                bool in_second = i >= 4 && i < 8 && j >= 4 && j < 8 && k >= 4 && k < 8;
                labels[i + DIM[0] * (j + DIM[1] * k)] = in_first ? 1 : in_second ? 2 : 0;
            }
        }
    }
    conus_atlas *atlas = scene_parcellation(&grid, labels);
    memory_free(labels);
    return atlas;
}

/* The candidates of a needle: a table of poses. */
struct candidates {
    char path[1024];
};

static conus_status open_table(conus_pose_stream **out, void *user)
{
    return conus_pose_stream_open(out, ((const struct candidates *)user)->path, NULL);
}

static void write_pose(struct buffer *text, const char *id, const double from[3], const double to[3], double near,
                       double far)
{
    double way[3];
    vec3_sub(way, to, from);
    vec3_normalise(way, way);
    buffer_format(text, "%s\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\t%.17g\n", id, from[0], from[1], from[2],
                  way[0], way[1], way[2], near, far);
}

static void begin_poses(struct buffer *text)
{
    buffer_text(text, "query_id\tx\ty\tz\tdx\tdy\tdz\tnear\tfar\n");
}

static void write_candidates(struct candidates *out, const char *name, struct buffer *text)
{
    snprintf(out->path, sizeof out->path, "%s", test_scratch(name));
    assert_ok(buffer_status(text));
    assert_ok(file_write(out->path, text->data, text->size));
    buffer_finish(text);
}

/* Needles from the left to somewhere in the first box; of some seeds from few places, so that entries are equal. */
static void write_random(struct candidates *out, const char *name, size_t count, uint64_t *seed, bool is_coarse)
{
    struct buffer text = {0};
    begin_poses(&text);
    for (size_t i = 0; i < count; i++) {
        double from[3] = {test_random(seed, -20, 2), test_random(seed, 2, 24), test_random(seed, 2, 24)};
        double to[3] = {test_random(seed, 11, 19), test_random(seed, 10.5, 15.5), test_random(seed, 10.5, 15.5)};
        for (int a = 0; a < 3 && is_coarse; a++) {
            from[a] = 4 * floor(from[a] / 4);
            to[a] = floor(to[a]) + 0.5;
        }
        double way[3];
        vec3_sub(way, to, from);
        char id[32];
        snprintf(id, sizeof id, "c%zu", i + 1);
        write_pose(&text, id, from, to, 0, vec3_length(way));
    }
    write_candidates(out, name, &text);
}

/* Lists a needle's candidates, all of them. */
static conus_plan *plan_alone(const conus_question *needle)
{
    const conus_plan_options options = {.threads = 1, .top = UINT64_MAX, .rank = "leeway"};
    conus_plan *plan = NULL;
    conus_pose_stream *stream = NULL;
    assert_ok(conus_plan_create(&plan, needle->selector, needle->constraints, needle->constraint_count, &options));
    assert_ok(open_table(&stream, needle->user));
    assert_ok(conus_plan_run(plan, stream, UINT64_MAX));
    conus_pose_stream_destroy(stream);
    return plan;
}

static double point_segment(const double p[3], const double a[3], const double b[3])
{
    double ab[3], ap[3], away[3];
    vec3_sub(ab, b, a);
    vec3_sub(ap, p, a);
    double square = vec3_dot(ab, ab);
    double t = square > 0 ? fmin(1, fmax(0, vec3_dot(ap, ab) / square)) : 0;
    vec3_add_scaled(away, ap, -t, ab);
    return vec3_length(away);
}

static double segments(const double a[2][3], const double b[2][3])
{
    double u[3], v[3], r[3], n[3];
    double least = INFINITY;
    for (int i = 0; i < 2; i++) {
        least = fmin(least, fmin(point_segment(a[i], b[0], b[1]), point_segment(b[i], a[0], a[1])));
    }
    vec3_sub(u, a[1], a[0]);
    vec3_sub(v, b[1], b[0]);
    vec3_sub(r, b[0], a[0]);
    vec3_cross(n, u, v);
    double square = vec3_dot(n, n);
    if (square > 1e-14 * vec3_dot(u, u) * vec3_dot(v, v)) {
        double rv[3], ru[3];
        vec3_cross(rv, r, v);
        vec3_cross(ru, r, u);
        double s = vec3_dot(rv, n) / square;
        double t = vec3_dot(ru, n) / square;
        least = s >= 0 && s <= 1 && t >= 0 && t <= 1 ? fabs(vec3_dot(r, n)) / sqrt(square) : least;
    }
    return least <= 1e-9 ? 0 : least;
}

/* A needle's candidates that hold, with their bodies. */
struct oracle_item {
    int64_t leeway, depth;
    uint64_t number, own; /* of all of the needle's, and of its question's */
    size_t question;
    bool once;
    double at[3];
    double shaft[2][3], part[2][3];
    double radius, part_radius; /* part_radius 0 = none */
};

struct oracle_needle {
    size_t count, kin; /* alike needles have the same one */
    struct oracle_item items[CANDIDATES];
};

struct oracle {
    const conus_together_options *options;
    struct oracle_needle *needles;
    size_t count;
    bool found;
    int64_t least, sum, depth;
    size_t at[NEEDLES], best[NEEDLES];
    size_t listed[4][NEEDLES]; /* from which it has to differ */
    size_t listed_count;
};

static int64_t nm(double mm)
{
    return (int64_t)floor(1e6 * mm + 0.5);
}

struct oracle_pair {
    double slack, shafts, parts, entries;
};

static struct oracle_pair measure(const struct oracle *oracle, size_t i, size_t a, size_t k, size_t b)
{
    const struct oracle_item *x = &oracle->needles[i].items[a];
    const struct oracle_item *y = &oracle->needles[k].items[b];
    struct oracle_pair pair = {.parts = INFINITY};
    pair.shafts = segments(x->shaft, y->shaft) - x->radius - y->radius;
    if (x->part_radius > 0) {
        pair.parts = fmin(pair.parts, segments(x->part, y->shaft) - x->part_radius - y->radius);
    }
    if (y->part_radius > 0) {
        pair.parts = fmin(pair.parts, segments(x->shaft, y->part) - x->radius - y->part_radius);
    }
    if (x->part_radius > 0 && y->part_radius > 0) {
        pair.parts = fmin(pair.parts, segments(x->part, y->part) - x->part_radius - y->part_radius);
    }
    pair.parts -= oracle->options->parts;
    pair.slack = fmin(pair.shafts - oracle->options->between, pair.parts);
    double way[3];
    vec3_sub(way, x->at, y->at);
    pair.entries = vec3_length(way);
    return pair;
}

static double distance(const double a[3], const double b[3])
{
    double way[3];
    vec3_sub(way, a, b);
    return vec3_length(way);
}

/* Whether a candidate enters and ends nearer to another one than apart, or is the same. */
static bool is_near(const struct oracle_item *x, const struct oracle_item *y, double apart)
{
    return (x->question == y->question && x->own == y->own) ||
           (distance(x->at, y->at) < apart - 1e-9 && distance(x->shaft[1], y->shaft[1]) < apart - 1e-9);
}

/* Whether enough needles differ: by a candidate that is near none of those that needles alike to it had. */
static bool differs(const struct oracle *oracle, const size_t *listed)
{
    uint64_t count = 0;
    for (size_t i = 0; i < oracle->count; i++) {
        bool is_other = true;
        for (size_t k = 0; k < oracle->count; k++) {
            is_other = is_other && !(oracle->needles[i].kin == oracle->needles[k].kin &&
                                     is_near(&oracle->needles[i].items[oracle->at[i]],
                                             &oracle->needles[k].items[listed[k]], oracle->options->diverse));
        }
        count += is_other;
    }
    return count >= (oracle->options->differ ? oracle->options->differ : 1);
}

/* All combinations of the needles from `next` on. */
static void enumerate(struct oracle *oracle, size_t next, int64_t least)
{
    if (next < oracle->count) {
        struct oracle_needle *needle = &oracle->needles[next];
        for (size_t c = 0; c < needle->count; c++) {
            int64_t own = needle->items[c].leeway < least ? needle->items[c].leeway : least;
            bool holds = true;
            for (size_t i = 0; i < next && holds; i++) {
                const struct oracle_item *before = &oracle->needles[i].items[oracle->at[i]];
                const struct oracle_item *item = &needle->items[c];
                if ((item->once && item->question == before->question) ||
                    (needle->kin == oracle->needles[i].kin && before->number >= item->number)) {
                    holds = false;
                    break;
                }
                struct oracle_pair pair = measure(oracle, i, oracle->at[i], next, c);
                holds = pair.slack > 1e-9 && pair.entries - oracle->options->entry_distance >= -1e-9;
                own = nm(pair.slack / 2) < own ? nm(pair.slack / 2) : own;
            }
            if (holds && (!oracle->found || own >= oracle->least)) {
                oracle->at[next] = c;
                enumerate(oracle, next + 1, own);
            }
        }
        return;
    }
    int64_t sum = 0;
    int64_t depth = 0;
    for (size_t n = 0; n < oracle->listed_count; n++) {
        if (!differs(oracle, oracle->listed[n])) {
            return;
        }
    }
    for (size_t i = 0; i < oracle->count; i++) {
        sum += oracle->needles[i].items[oracle->at[i]].leeway;
        depth += oracle->needles[i].items[oracle->at[i]].depth;
    }
    bool is_better = !oracle->found || least > oracle->least || (least == oracle->least && sum > oracle->sum) ||
                     (least == oracle->least && sum == oracle->sum && depth < oracle->depth);
    if (is_better) { /* of equal ones the first that is met has the smaller numbers */
        oracle->found = true;
        oracle->least = least;
        oracle->sum = sum;
        oracle->depth = depth;
        memcpy(oracle->best, oracle->at, sizeof oracle->best);
    }
}

/* A plan of all needles, and what it is asked by. */
struct scene {
    conus_atlas *atlas;
    conus_selector *selectors[NEEDLES];
    struct candidates candidates[NEEDLES];
    conus_question needles[NEEDLES];
    conus_part parts[NEEDLES];
    conus_plan_options plan;
    size_t count;
};

static const char *const NAMES[NEEDLES] = {"A", "B", "C", "D", "E"};

static const conus_constraint CONSTRAINTS[2] = {{.kind = CONUS_CONSTRAINT_REACH, .names = "1", .limit = 1},
                                                {.kind = CONUS_CONSTRAINT_AVOID, .names = "2", .limit = 0.5}};

static void make_scene(struct scene *out, size_t count)
{
    *out = (struct scene){.atlas = boxes(), .count = count, .plan = {.threads = 1}};
    for (size_t i = 0; i < count; i++) {
        const conus_selector_options options = {.radius = 0.2 + 0.1 * (double)i};
        assert_ok(conus_selector_create(&out->selectors[i], out->atlas, &options));
        out->needles[i] = (conus_question){.needles = NAMES[i],
                                           .selector = out->selectors[i],
                                           .constraints = CONSTRAINTS,
                                           .constraint_count = 2,
                                           .options = &out->plan,
                                           .open = open_table,
                                           .user = &out->candidates[i]};
    }
}

static void end_scene(struct scene *scene)
{
    for (size_t i = 0; i < scene->count; i++) {
        conus_selector_destroy(scene->selectors[i]);
    }
    conus_atlas_destroy(scene->atlas);
}

static void read_point(double out[3], const conus_planned *pose, double x, double y, double depth)
{
    const double *m = pose->pose.world_from_device;
    for (int a = 0; a < 3; a++) {
        out[a] = m[12 + a] + x * m[a] + y * m[4 + a] - depth * m[8 + a];
    }
}

/* Adds all candidates of a question that hold, in the order of their numbers. */
static void add_question(struct oracle_needle *out, const struct scene *scene, size_t index, uint64_t *before)
{
    const conus_question *question = &scene->needles[index];
    const conus_part part = question->part_count ? question->parts[0] : (conus_part){0};
    conus_plan *plan = plan_alone(question);
    for (uint64_t number = 1; number <= conus_plan_left(plan, 0); number++) {
        for (size_t i = 0; i < conus_plan_count(plan); i++) {
            const conus_planned *pose = conus_plan_pose(plan, i);
            if (pose->candidate == number) {
                struct oracle_item *item = &out->items[out->count++];
                double from = part.from_tip ? pose->far : 0;
                *item = (struct oracle_item){.leeway = nm(pose->leeway),
                                             .depth = nm(pose->far),
                                             .number = number + *before,
                                             .own = number,
                                             .question = index,
                                             .once = question->once,
                                             .radius = 0.2 + 0.1 * (double)index,
                                             .part_radius = part.radius};
                read_point(item->at, pose, 0, 0, 0);
                read_point(item->shaft[0], pose, 0, 0, pose->near);
                read_point(item->shaft[1], pose, 0, 0, pose->far);
                read_point(item->part[0], pose, part.x, part.y, from - part.low);
                read_point(item->part[1], pose, part.x, part.y, from - part.high);
            }
        }
    }
    *before += conus_plan_left(plan, 0);
    conus_plan_destroy(plan);
}

/* A needle of one question. */
static void take_needle(struct oracle_needle *out, const struct scene *scene, size_t index)
{
    uint64_t before = 0;
    *out = (struct oracle_needle){.kin = index};
    add_question(out, scene, index, &before);
}

/* Needles A, B ... by what the questions name. Returns how many there are. */
static size_t take_named(struct oracle_needle *out, const struct scene *scene)
{
    size_t count = 0;
    char order[NEEDLES + 1] = "";
    for (size_t q = 0; q < scene->count; q++) {
        for (const char *name = scene->needles[q].needles; *name; name++) {
            if (*name != ',' && *name != ' ' && !strchr(order, *name)) {
                order[count++] = *name;
            }
        }
    }
    for (size_t i = 0; i < count; i++) {
        uint64_t before = 0;
        uint32_t own = 0;
        out[i] = (struct oracle_needle){.kin = i};
        for (size_t q = 0; q < scene->count; q++) {
            if (strchr(scene->needles[q].needles, order[i])) {
                add_question(&out[i], scene, q, &before);
                own |= 1U << q;
            }
        }
        for (size_t k = 0; k < i; k++) {
            uint32_t other = 0;
            for (size_t q = 0; q < scene->count; q++) {
                other |= (uint32_t)(strchr(scene->needles[q].needles, order[k]) != NULL) << q;
            }
            out[i].kin = other == own && out[i].kin == i ? k : out[i].kin;
        }
    }
    return count;
}

/* Whether a set of needles has a combination. */
static bool has_combination(const struct oracle *whole, uint32_t set)
{
    struct oracle_needle *needles = memory_zeroed(whole->count, sizeof *needles);
    struct oracle part = {.options = whole->options, .needles = needles};
    assert_non_null(needles);
    for (size_t i = 0; i < whole->count; i++) {
        if (set >> i & 1) {
            needles[part.count++] = whole->needles[i];
        }
    }
    enumerate(&part, 0, INT64_MAX);
    memory_free(needles);
    return part.found;
}

/* The first of the smallest sets without one, by trying them all. */
static void expect_conflict(const struct oracle *oracle, const conus_conflict *conflict)
{
    uint32_t got = 0;
    assert_non_null(conflict);
    assert_true(conflict->count > 0);
    for (size_t i = 0; i < conflict->count; i++) {
        got |= 1U << conflict->needles[i];
    }
    assert_false(has_combination(oracle, got));
    for (uint32_t set = 1; set < 1U << oracle->count; set++) {
        size_t size = (size_t)__builtin_popcount(set);
        /* In the order of the table the first needle decides: the set with the lowest bit that the other one lacks. */
        uint32_t differ = set ^ got;
        bool is_before = differ && (set & differ & (~differ + 1));
        if (size < conflict->count || (size == conflict->count && is_before)) {
            assert_true(has_combination(oracle, set));
        }
    }
}

static void compare_one(const conus_combination *combination, const struct oracle *oracle)
{
    assert_true(combination->feasible && combination->proven);
    assert_near(combination->leeway, 1e-6 * (double)oracle->least, 2e-6);
    assert_near(combination->bound, combination->leeway, 0);
    assert_near(combination->sum, 1e-6 * (double)oracle->sum, 2e-6);
    assert_near(combination->depth, 1e-6 * (double)oracle->depth, 2e-6);
    for (size_t i = 0; i < oracle->count; i++) {
        const conus_chosen *chosen = &combination->chosen[i];
        const struct oracle_item *item = &oracle->needles[i].items[oracle->best[i]];
        assert_int_equal(chosen->candidate, item->number);
        assert_int_equal(chosen->pose->candidate, item->own);
        assert_int_equal(chosen->question, item->question);
    }
}

/* Each that is listed against all that differ from those before it. Returns how many are. */
static size_t compare(const conus_together *together, struct oracle *oracle)
{
    const size_t top = oracle->options->top ? (size_t)oracle->options->top : 1;
    for (size_t n = 0; n < top; n++) {
        const conus_combination *combination = conus_together_combination(together, n);
        oracle->found = false;
        enumerate(oracle, 0, INT64_MAX);
        assert_int_equal(combination != NULL, oracle->found);
        if (!combination && n) {
            assert_true(conus_together_combination(together, n - 1)->last);
        } else if (!combination) {
            expect_conflict(oracle, conus_together_conflict(together));
        }
        if (!combination) {
            return n;
        }
        assert_null(conus_together_conflict(together));
        assert_false(n + 1 == top && combination->last);
        compare_one(combination, oracle);
        memcpy(oracle->listed[oracle->listed_count++], oracle->best, sizeof oracle->best);
    }
    assert_null(conus_together_combination(together, top));
    return top;
}

/* Of a search that ended early, whatever it lists: no claim of it is wrong. Returns how many of them are proven. */
static size_t expect_no_wrong_claim(const conus_together *together, struct oracle *oracle)
{
    const conus_combination *combination;
    size_t n = 0;
    size_t proven = 0;
    bool is_over = conus_together_conflict(together);
    oracle->listed_count = 0;
    while ((combination = conus_together_combination(together, n++))) {
        oracle->found = false;
        enumerate(oracle, 0, INT64_MAX);
        assert_true(oracle->found);
        assert_true(nm(combination->leeway) <= oracle->least + 2 && oracle->least <= nm(combination->bound) + 2);
        if (combination->proven) {
            compare_one(combination, oracle);
            proven++;
        }
        for (size_t i = 0; i < oracle->count; i++) {
            size_t *at = &oracle->listed[oracle->listed_count][i];
            for (*at = 0; oracle->needles[i].items[*at].number != combination->chosen[i].candidate; ++*at) {
                assert_true(*at + 1 < oracle->needles[i].count);
            }
        }
        oracle->listed_count++;
        is_over = combination->last;
    }
    if (is_over) { /* there is none, or no other one */
        oracle->found = false;
        enumerate(oracle, 0, INT64_MAX);
        assert_false(oracle->found);
    }
    return proven;
}

/* A part or none, and candidates, of each question. */
static void fill_scene(struct scene *scene, uint64_t *seed, double most, bool is_coarse)
{
    for (size_t i = 0; i < scene->count; i++) {
        char name[32];
        snprintf(name, sizeof name, "small-%zu.tsv", i);
        write_random(&scene->candidates[i], name, 4 + (size_t)test_random(seed, 0, most), seed, is_coarse);
        if (test_random(seed, 0, 1) < 0.4) {
            scene->parts[i] = (conus_part){.radius = test_random(seed, 0.5, 2),
                                           .low = test_random(seed, -3, 0),
                                           .high = test_random(seed, 0, 12),
                                           .x = test_random(seed, -2, 2),
                                           .from_tip = test_random(seed, 0, 1) < 0.3};
            scene->needles[i].parts = &scene->parts[i];
            scene->needles[i].part_count = 1;
        }
    }
}

/* Needles of one question each, and then such as may answer several, are alike, or answer what only one may. */
static void small_instances(uint64_t seed, const char *const (*named)[NEEDLES], size_t kinds_named, size_t trials)
{
    size_t none = 0;
    size_t proven = 0;
    size_t unproven = 0;
    size_t kinds[4] = {0}; /* so many were listed, where three were asked for */
    for (size_t trial = 0; trial < trials; trial++) {
        struct scene scene;
        const char *const *names = named ? named[trial % kinds_named] : NULL;
        size_t count = 1 + trial % 4;
        for (count = names ? 0 : count; names && names[count];) {
            count++;
        }
        make_scene(&scene, count);
        for (size_t i = 0; i < count && names; i++) {
            scene.needles[i].needles = names[i];
            scene.needles[i].once = test_random(&seed, 0, 1) < 0.4;
        }
        struct oracle_needle *needles = memory_zeroed(NEEDLES, sizeof *needles);
        assert_non_null(needles);
        fill_scene(&scene, &seed, names ? 9 : 16, trial % 3 == 0);
        size_t needle_count = take_named(needles, &scene);
        const conus_together_options options = {.between = test_random(&seed, 0, names ? 4 : 6),
                                                .parts = test_random(&seed, 0, 1),
                                                .entry_distance = trial % 3 ? test_random(&seed, 0, 16) : 4,
                                                .top = trial / 4 % 2 ? 3 : 0,
                                                .diverse = trial % 5 ? test_random(&seed, 0, 8) : 0,
                                                .differ = 1 + (uint64_t)test_random(&seed, 0, (double)needle_count)};
        struct oracle oracle = {.options = &options, .needles = needles, .count = needle_count};
        conus_together *together = NULL;
        assert_ok(conus_plan_together(&together, scene.needles, count, &options));
        assert_int_equal(conus_together_count(together), needle_count);
        size_t listed = compare(together, &oracle);
        none += !listed;
        kinds[listed] += options.top == 3;
        conus_together_destroy(together);
        conus_together_options hasty = options;
        hasty.effort = (uint64_t)2 << trial % 11;
        assert_ok(conus_plan_together(&together, scene.needles, count, &hasty));
        size_t of_these = expect_no_wrong_claim(together, &oracle);
        proven += of_these;
        unproven += conus_together_combination(together, of_these) != NULL;
        conus_together_destroy(together);
        memory_free(needles);
        end_scene(&scene);
    }
    if (proven < trials / 12 || unproven < trials / 12) {
        fail_msg("of hasty searches %zu combinations are proven, %zu end with one that is not", proven, unproven);
    }
    if (!(none > trials / 20 && none < 2 * trials / 3)) { /* both kinds are to be tried */
        fail_msg("%zu of %zu instances have no combination", none, trials);
    }
    if (!kinds[1] || !kinds[2] || kinds[3] < trials / 12) {
        fail_msg("of lists of three %zu have one, %zu two, %zu three", kinds[1], kinds[2], kinds[3]);
    }
}

static void small_instances_are_as_all_combinations(void **state)
{
    (void)state;
    small_instances(106, NULL, 0, test_trials(200));
}

static void so_are_those_of_needles_with_several_questions(void **state)
{
    (void)state;
    static const char *const named[][NEEDLES] = {
        {"A,B"},        {"A, B ,C"},    {"A,B", "C"},     {"A", "A", "B"},
        {"A,B", "A,B"}, {"A,B", "B,C"}, {"C,A", "A,B,C"}, {"A,B,C", "A,B,C", "A,B,C"}};
    small_instances(27, named, sizeof named / sizeof named[0], test_trials(200));
}

/* More candidates than are listed at first: the best combination has some that are far down. */
static void long_lists_are_listed_as_far_as_it_takes(void **state)
{
    (void)state;
    uint64_t seed = 7;
    struct scene scene;
    make_scene(&scene, 2);
    struct oracle_needle *needles = memory_zeroed(2, sizeof *needles);
    assert_non_null(needles);
    for (size_t i = 0; i < 2; i++) {
        write_random(&scene.candidates[i], i ? "long-1.tsv" : "long-0.tsv", CANDIDATES, &seed, false);
        take_needle(&needles[i], &scene, i);
        assert_true(needles[i].count > 500);
    }
    for (size_t trial = 0; trial < 3; trial++) {
        const conus_together_options options = {.between = 1.5 + 1.5 * (double)trial,
                                                .entry_distance = 12 * (double)trial,
                                                .top = 1 + trial,
                                                .diverse = 6,
                                                .differ = 1 + trial / 2};
        struct oracle oracle = {.options = &options, .needles = needles, .count = 2};
        conus_together *together = NULL;
        assert_ok(conus_plan_together(&together, scene.needles, 2, &options));
        compare(together, &oracle);
        conus_together_destroy(together);
    }
    memory_free(needles);
    end_scene(&scene);
}

/* Needle `index` of a scene has one candidate. */
static void write_one(struct scene *scene, size_t index, const double from[3], const double to[3])
{
    struct buffer text = {0};
    double way[3];
    vec3_sub(way, to, from);
    begin_poses(&text);
    write_pose(&text, "only", from, to, 0, vec3_length(way));
    write_candidates(&scene->candidates[index], index ? "one-1.tsv" : "one-0.tsv", &text);
}

static bool is_feasible(const struct scene *scene, conus_together_options options)
{
    conus_together *together = NULL;
    assert_ok(conus_plan_together(&together, scene->needles, scene->count, &options));
    bool is = conus_together_combination(together, 0);
    conus_together_destroy(together);
    return is;
}

/* Two parallel needles along x, 4 mm apart, 0.2 and 0.3 mm thick: 3.5 mm between them (radii), entries 5 mm apart. */
static void limits_are_those_of_the_equations(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene, 2);
    write_one(&scene, 0, (const double[3]){0, 11, 13}, (const double[3]){15, 11, 13});
    write_one(&scene, 1, (const double[3]){3, 15, 13}, (const double[3]){15, 15, 13});
    assert_false(is_feasible(&scene, (conus_together_options){.between = 3.5}));
    assert_true(is_feasible(&scene, (conus_together_options){.between = 3.5 - 1e-8}));
    assert_true(is_feasible(&scene, (conus_together_options){.entry_distance = 5}));
    assert_false(is_feasible(&scene, (conus_together_options){.entry_distance = 5 + 1e-8}));
    /* A ball of 1 mm, 2 mm outside of the first one's position: (-2, 11, 13), from the second one's axis at (3, 15, 13)
     * sqrt(25 + 16) - 1 - 0.3. */
    const conus_part ball = {.radius = 1, .low = 2, .high = 2};
    const double apart = sqrt(41) - 1.3;
    scene.needles[0].parts = &ball;
    scene.needles[0].part_count = 1;
    assert_true(is_feasible(&scene, (conus_together_options){.parts = apart - 1e-8}));
    assert_false(is_feasible(&scene, (conus_together_options){.parts = apart}));
    /* From the tip, 13 mm outwards and 2 mm along y: (2, 11, 13) + 2 y; y is the world's y or z, turned by no more. */
    const conus_part beside = {.radius = 0.5, .low = 0, .high = 10, .y = 0, .from_tip = true};
    scene.needles[0].parts = &beside; /* along the shaft: 4 - 0.5 - 0.3 from the other one */
    assert_true(is_feasible(&scene, (conus_together_options){.parts = 3.2 - 1e-8}));
    assert_false(is_feasible(&scene, (conus_together_options){.parts = 3.2}));
    end_scene(&scene);
}

/* Crossing needles touch, whatever their radius; collinear ones are as far apart as their ends. */
static void crossing_and_collinear(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene, 2);
    write_one(&scene, 0, (const double[3]){0, 13, 13}, (const double[3]){12, 13, 13});
    write_one(&scene, 1, (const double[3]){11, 2, 13}, (const double[3]){11, 14, 13});
    conus_together *together = NULL;
    assert_ok(conus_plan_together(&together, scene.needles, 2, NULL));
    assert_null(conus_together_combination(together, 0));
    const conus_conflict *conflict = conus_together_conflict(together);
    assert_int_equal(conflict->count, 2);
    assert_near(conflict->between, -0.5, 1e-6); /* they overlap by both radii */
    assert_true(isnan(conflict->entry_distance));
    conus_together_destroy(together);
    write_one(&scene, 1, (const double[3]){30, 13, 13}, (const double[3]){18, 13, 13});
    assert_false(is_feasible(&scene, (conus_together_options){.between = 5.5}));
    assert_true(is_feasible(&scene, (conus_together_options){.between = 5.5 - 1e-8}));
    end_scene(&scene);
}

/* Just below the margin that the conflict names there is a combination, just above there is none (B8). */
static void a_conflict_says_how_far_it_is(void **state)
{
    (void)state;
    uint64_t seed = 12;
    size_t seen = 0;
    for (size_t trial = 0; trial < 12; trial++) {
        struct scene scene;
        make_scene(&scene, 3);
        for (size_t i = 0; i < 3; i++) {
            char name[32];
            snprintf(name, sizeof name, "conflict-%zu.tsv", i);
            write_random(&scene.candidates[i], name, 12, &seed, false);
        }
        const conus_together_options asked = {.between = 6.5, .entry_distance = trial % 2 ? 9 : 0};
        conus_together *together = NULL;
        assert_ok(conus_plan_together(&together, scene.needles, 3, &asked));
        const conus_conflict *conflict = conus_together_conflict(together);
        struct scene among = scene;
        among.count = conflict ? conflict->count : 0;
        for (size_t i = 0; i < among.count; i++) {
            among.needles[i] = scene.needles[conflict->needles[i]];
        }
        if (conflict && conflict->count > 1 && conflict->between > 0.1) {
            seen++;
            conus_together_options options = asked;
            options.between = conflict->between - 1e-6;
            assert_true(is_feasible(&among, options));
            options.between = conflict->between + 2e-6;
            assert_false(is_feasible(&among, options));
        }
        if (conflict && conflict->count > 1 && isfinite(conflict->entry_distance)) {
            conus_together_options options = asked;
            options.entry_distance = conflict->entry_distance - 1e-6;
            assert_true(is_feasible(&among, options));
            options.entry_distance = conflict->entry_distance + 2e-6;
            assert_false(is_feasible(&among, options));
        }
        conus_together_destroy(together);
        end_scene(&scene);
    }
    assert_true(seen > 3);
}

/* All points of two needles that are off by less than the pair's leeway leave them apart; towards each other by 1.05 of
 * it they are too near (B5). Parallel needles, 4 mm apart: the leeway is (3.5 - 2) / 2. */
static void the_leeway_of_a_pair(void **state)
{
    (void)state;
    struct scene scene;
    make_scene(&scene, 2);
    static const conus_constraint far_away = {
        .kind = CONUS_CONSTRAINT_REACH, .names = "1", .measure = CONUS_MEASURE_TIP};
    scene.needles[0].constraints = scene.needles[1].constraints = &far_away;
    scene.needles[0].constraint_count = scene.needles[1].constraint_count = 1;
    write_one(&scene, 0, (const double[3]){0, 11, 13}, (const double[3]){15, 11, 13});
    write_one(&scene, 1, (const double[3]){0, 15, 13}, (const double[3]){15, 15, 13});
    conus_together *together = NULL;
    conus_table *pairs = NULL;
    const conus_together_options options = {.between = 2};
    assert_ok(conus_plan_together(&together, scene.needles, 2, &options));
    assert_near(conus_together_combination(together, 0)->leeway, 0.75, 1e-6);
    assert_string_equal(conus_together_combination(together, 0)->leeway_of, "A/B");
    assert_ok(conus_together_pairs(&pairs, together));
    assert_int_equal(conus_table_rows(pairs), 1);
    assert_near(conus_table_numbers(pairs, "leeway_mm")[0], 0.75, 1e-9);
    assert_near(conus_table_numbers(pairs, "distance_mm")[0], 3.5, 1e-9);
    assert_near(conus_table_numbers(pairs, "entry_distance_mm")[0], 4, 1e-9);
    assert_near(conus_table_numbers(pairs, "other_y")[0] - conus_table_numbers(pairs, "y")[0], 4, 1e-9);
    assert_string_equal(conus_table_texts(pairs, "needle")[0], "A");
    assert_string_equal(conus_table_texts(pairs, "other_body")[0], "shaft");
    conus_table_destroy(pairs);
    conus_together_destroy(together);
    for (int i = 0; i < 2; i++) {
        double off = (i ? 1.05 : 0.999) * 0.75;
        write_one(&scene, 0, (const double[3]){0, 11 + off, 13}, (const double[3]){15, 11 + off, 13});
        write_one(&scene, 1, (const double[3]){0, 15 - off, 13}, (const double[3]){15, 15 - off, 13});
        assert_int_equal(is_feasible(&scene, options), i == 0);
    }
    end_scene(&scene);
}

/* Given needles are in their place: planned ones go round them, and a plan that is given whole is checked. */
static void given_needles(void **state)
{
    (void)state;
    static const conus_constraint any_length = {.kind = CONUS_CONSTRAINT_LENGTH, .most = 100};
    uint64_t seed = 3;
    struct scene scene;
    make_scene(&scene, 2);
    write_one(&scene, 0, (const double[3]){0, 13, 13}, (const double[3]){15, 13, 13});
    conus_pose_list *list = NULL;
    assert_ok(conus_pose_list_load(&list, scene.candidates[0].path, NULL));
    write_random(&scene.candidates[1], "round.tsv", 40, &seed, false);
    conus_together_options options = {.between = 0.5, .entry_distance = 2};
    conus_together *planned = NULL;
    conus_together *round = NULL;
    assert_ok(conus_plan_together(&planned, scene.needles, 2, &options));
    conus_pose_row given[3] = {*conus_pose_list_row(list, 0), *conus_pose_list_row(list, 0)};
    given[0].id = "A";
    given[1].id = given[2].id = "B"; /* both in one place */
    options.given = given;
    options.given_count = 1;
    assert_ok(conus_plan_together(&round, scene.needles, 2, &options));
    assert_true(conus_together_needle(round, 0)->given);
    assert_string_equal(conus_together_needle(round, 0)->given->id, "A");
    assert_int_equal(conus_together_combination(round, 0)->chosen[1].candidate,
                     conus_together_combination(planned, 0)->chosen[1].candidate);
    assert_near(conus_together_combination(round, 0)->leeway, conus_together_combination(planned, 0)->leeway, 0);
    conus_together_destroy(round);
    options.given_count = 2;
    assert_ok(conus_plan_together(&round, scene.needles, 2, &options));
    const conus_combination *checked = conus_together_combination(round, 0);
    assert_non_null(checked);
    assert_false(checked->feasible || checked->proven);
    assert_int_equal(conus_together_conflict(round)->count, 2);
    assert_true(isnan(conus_together_conflict(round)->entry_distance)); /* they overlap wherever they are */
    conus_together_destroy(round);
    /* Of three that are given the last two are in one place: that others are to be listed, too, is not in their way. */
    struct scene three;
    make_scene(&three, 3);
    for (size_t i = 0; i < 3; i++) {
        three.candidates[i] = scene.candidates[0];
    }
    given[2] = given[0];
    given[0].id = "C";
    given[2].pose.world_from_device[13] = 40;
    three.needles[0].constraints = &any_length;
    three.needles[0].constraint_count = 1;
    options = (conus_together_options){.given = given, .given_count = 3, .top = 3, .differ = 2};
    assert_ok(conus_plan_together(&round, three.needles, 3, &options));
    assert_int_equal(conus_together_conflict(round)->count, 2);
    assert_int_equal(conus_together_conflict(round)->needles[0], 1);
    assert_int_equal(conus_together_conflict(round)->needles[1], 2);
    assert_near(conus_together_conflict(round)->between, -0.7, 1e-6); /* both radii */
    conus_together_destroy(round);
    end_scene(&three);
    given[0] = given[1];
    given[0].id = "A";
    given[2].id = "B";
    options = (conus_together_options){.given = given};
    round = NULL;
    options.given_count = 3;
    assert_fails(conus_plan_together(&round, scene.needles, 2, &options), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "given: B is given twice");
    given[1].id = "C";
    assert_fails(conus_plan_together(&round, scene.needles, 2, &options), CONUS_ERROR_ARGUMENT);
    assert_string_equal(conus_message(), "given: C is no needle");
    conus_together_destroy(planned);
    conus_pose_list_destroy(list);
    end_scene(&scene);
}

static void answers_do_not_depend_on_threads(void **state)
{
    (void)state;
    static const uint32_t threads[3] = {1, 2, 7};
    uint64_t seed = 31;
    struct scene scene;
    make_scene(&scene, 4);
    for (size_t i = 0; i < 4; i++) {
        char name[32];
        snprintf(name, sizeof name, "threads-%zu.tsv", i);
        write_random(&scene.candidates[i], name, 700, &seed, true);
    }
    for (int effort = 0; effort < 2; effort++) {
        const conus_together_options options = {
            .between = 1, .entry_distance = 6, .effort = effort ? 9 : 0, .top = 3, .diverse = 5, .differ = 2};
        conus_combination first[3] = {0};
        uint64_t numbers[3][4] = {0};
        for (size_t t = 0; t < 3; t++) {
            conus_together *together = NULL;
            scene.plan.threads = threads[t];
            assert_ok(conus_plan_together(&together, scene.needles, 4, &options));
            for (size_t n = 0; n < 3; n++) {
                const conus_combination *listed = conus_together_combination(together, n);
                conus_combination combination = listed ? *listed : (conus_combination){0};
                for (size_t i = 0; i < 4 && listed; i++) {
                    numbers[n][i] = t ? numbers[n][i] : listed->chosen[i].candidate;
                    assert_int_equal(numbers[n][i], listed->chosen[i].candidate);
                }
                combination.chosen = NULL;
                combination.leeway_of = NULL;
                combination.covered = NULL;
                first[n] = t ? first[n] : combination;
                assert_memory_equal(&first[n], &combination, sizeof combination);
                assert_true(effort || combination.proven);
            }
            conus_together_destroy(together);
        }
    }
    end_scene(&scene);
}

/* Candidates are read several times, and some of them are looked at first: what is said of them is what a plan of all
 * says. Every tenth row is none, being a point; of the second needle nothing holds. */
static void what_is_said_of_candidates(void **state)
{
    (void)state;
    static const conus_constraint never_held[2] = {{.kind = CONUS_CONSTRAINT_REACH, .names = "1", .limit = 0.5},
                                                   {.kind = CONUS_CONSTRAINT_LENGTH, .limit = 500, .most = 600}};
    uint64_t seed = 16;
    struct scene scene;
    make_scene(&scene, 2);
    scene.needles[1].constraints = never_held;
    for (size_t i = 0; i < 2; i++) {
        struct buffer text = {0};
        begin_poses(&text);
        for (int k = 0; k < 3000; k++) {
            double from[3] = {test_random(&seed, -20, 2), test_random(&seed, 2, 24), test_random(&seed, 2, 24)};
            double to[3] = {test_random(&seed, 11, 19), test_random(&seed, 9, 17), test_random(&seed, 9, 17)};
            if (k % 10 == 3) {
                buffer_format(&text, "point\t1\t2\t3\tn/a\tn/a\tn/a\tn/a\tn/a\n");
            } else {
                write_pose(&text, "needle", from, to, 0, floor(test_random(&seed, 20, 30)));
            }
        }
        write_candidates(&scene.candidates[i], i ? "said-1.tsv" : "said-0.tsv", &text);
    }
    conus_together *together = NULL;
    assert_ok(conus_plan_together(&together, scene.needles, 2, NULL));
    assert_null(conus_together_combination(together, 0));
    assert_int_equal(conus_together_conflict(together)->needles[0], 1);
    for (size_t i = 0; i < 2; i++) {
        conus_plan *alone = plan_alone(&scene.needles[i]);
        const conus_answered *placed = conus_together_question(together, i);
        for (size_t k = 0; k <= 2; k++) {
            assert_int_equal(conus_plan_left(placed->plan, k), conus_plan_left(alone, k));
            const conus_planned *miss = conus_plan_miss(alone, k);
            const conus_planned *found = conus_plan_miss(placed->plan, k);
            assert_int_equal(miss != NULL, found != NULL);
            assert_int_equal(miss ? miss->candidate : 0, found ? found->candidate : 0);
        }
        assert_int_equal(conus_plan_left(alone, 0), 2700);
        assert_int_equal(conus_plan_left(alone, 2) == 0, i == 1);
        assert_int_equal(conus_plan_rejected(placed->plan).count, 300);
        assert_int_equal(conus_plan_rejected(placed->plan).line, conus_plan_rejected(alone).line);
        conus_plan_destroy(alone);
    }
    assert_non_null(conus_plan_miss(conus_together_question(together, 1)->plan, 1));
    conus_together_destroy(together);
    end_scene(&scene);
}

/* A file that has other needles when it is read once more. */
static conus_status open_another(conus_pose_stream **out, void *user)
{
    static const double at[3] = {0, 12, 12};
    static const double to[3] = {15, 12, 12};
    struct buffer text = {0};
    begin_poses(&text);
    write_pose(&text, "another", at, to, 0, 15);
    conus_status status = open_table(out, user);
    write_candidates(user, "another.tsv", &text);
    return status;
}

static void candidates_that_change_are_refused(void **state)
{
    (void)state;
    uint64_t seed = 17;
    struct scene scene;
    make_scene(&scene, 1);
    write_random(&scene.candidates[0], "before.tsv", 40, &seed, false);
    scene.needles[0].open = open_another;
    conus_together *together = NULL;
    assert_fails(conus_plan_together(&together, scene.needles, 1, NULL), CONUS_ERROR_DATA);
    assert_string_equal(conus_message(), "A: its candidates are others when they are read again");
    end_scene(&scene);
}

/* What an answer says of covers is there when the caller's words are not. */
static void covers_are_its_own(void **state)
{
    (void)state;
    uint64_t seed = 7;
    struct scene scene;
    make_scene(&scene, 2);
    for (size_t i = 0; i < 2; i++) {
        write_random(&scene.candidates[i], i ? "cover-1.tsv" : "cover-0.tsv", 5, &seed, false);
        scene.needles[i].contacts = (conus_contacts){.count = 2, .columns = 1, .pitch = 2};
    }
    char names[] = "1,2";
    conus_cover covers[17] = {{names, 3}};
    conus_together_options options = {.covers = covers, .cover_count = 1};
    conus_together *together = NULL;
    assert_ok(conus_plan_together(&together, scene.needles, 2, &options));
    memset(names, 'x', 3);
    covers[0] = (conus_cover){0};
    assert_string_equal(conus_together_asked(together)->covers[0].names, "1,2");
    assert_int_equal(conus_together_asked(together)->covers[0].contacts, 3);
    conus_together_destroy(together);
    together = NULL;
    assert_fails(conus_plan_together(&together, scene.needles, 2, &options), CONUS_ERROR_ARGUMENT); /* no names */
    options.cover_count = 17;
    assert_fails(conus_plan_together(&together, scene.needles, 2, &options), CONUS_ERROR_ARGUMENT);
    options.cover_count = 1;
    covers[0] = (conus_cover){"3", 1};
    assert_fails(conus_plan_together(&together, scene.needles, 2, &options), CONUS_ERROR_ARGUMENT);
    covers[0].names = "1";
    scene.needles[1].contacts.count = 0;
    assert_fails(conus_plan_together(&together, scene.needles, 2, &options), CONUS_ERROR_ARGUMENT);
    assert_non_null(strstr(conus_message(), "the contacts are not known"));
    assert_null(together);
    end_scene(&scene);
}

static void what_is_not_allowed(void **state)
{
    (void)state;
    uint64_t seed = 5;
    struct scene scene;
    make_scene(&scene, 2);
    for (size_t i = 0; i < 2; i++) {
        write_random(&scene.candidates[i], i ? "bad-1.tsv" : "bad-0.tsv", 5, &seed, false);
    }
    conus_together *together = NULL;
    static const conus_together_options bad[] = {{.between = -1},
                                                 {.between = 101},
                                                 {.between = NAN},
                                                 {.parts = -1},
                                                 {.parts = 101},
                                                 {.parts = NAN},
                                                 {.entry_distance = -1},
                                                 {.entry_distance = 101},
                                                 {.entry_distance = NAN},
                                                 {.top = 101},
                                                 {.diverse = -1},
                                                 {.diverse = 101},
                                                 {.diverse = NAN},
                                                 {.differ = 3},
                                                 {.arcs = -1},
                                                 {.arcs = 181},
                                                 {.arcs = NAN},
                                                 {.slider = 1},
                                                 {.same = 1},
                                                 {.arcs_most = 1},
                                                 {.arcs_each = 1},
                                                 {.arcs = 1},
                                                 {.arcs = 9, .same = 4.5},
                                                 {.arcs = 9, .slider = -1},
                                                 {.arcs = 9, .slider = NAN},
                                                 {.arcs = 9, .same = NAN}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_fails(conus_plan_together(&together, scene.needles, 2, &bad[i]), CONUS_ERROR_ARGUMENT);
    }
    static const conus_part parts[] = {{.radius = -1, .high = 1},
                                       {.radius = NAN},
                                       {.radius = 1001},
                                       {.radius = 0, .low = 2, .high = 2},
                                       {.radius = 1, .low = 2, .high = 1},
                                       {.radius = 1, .high = INFINITY},
                                       {.radius = 1, .x = 1001},
                                       {.radius = 1, .y = NAN},
                                       {.radius = 1, .low = -1001}};
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        scene.needles[1].parts = &parts[i];
        scene.needles[1].part_count = 1;
        assert_fails(conus_plan_together(&together, scene.needles, 2, NULL), CONUS_ERROR_ARGUMENT);
        assert_memory_equal(conus_message(), "B: part 1: ", 11);
    }
    scene.needles[1].part_count = 0;
    const conus_plan_options others[] = {{.top = 1},         {.infeasible = true}, {.rank = "depth"},
                                         {.score = "depth"}, {.entries = 1},       {.targets = 1}};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        scene.needles[1].options = &others[i];
        assert_fails(conus_plan_together(&together, scene.needles, 2, NULL), CONUS_ERROR_ARGUMENT);
    }
    scene.needles[1].options = &scene.plan;
    static const char *const names[] = {"A,A", "A, ", ",", " ", "A,B,C,D,E,F,G,H,I,J,K,L,M,N,O,P,Q"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        scene.needles[1].needles = names[i];
        assert_fails(conus_plan_together(&together, scene.needles, 2, NULL), CONUS_ERROR_ARGUMENT);
        assert_memory_equal(conus_message(), "needles: ", 9);
    }
    scene.needles[1].needles = "";
    assert_fails(conus_plan_together(&together, scene.needles, 2, NULL), CONUS_ERROR_ARGUMENT);
    scene.needles[1].needles = "B";
    assert_fails(conus_plan_together(&together, scene.needles, 0, NULL), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_plan_together(&together, scene.needles, 65, NULL), CONUS_ERROR_ARGUMENT);
    scene.needles[1].constraint_count = 0;
    assert_fails(conus_plan_together(&together, scene.needles, 2, NULL), CONUS_ERROR_ARGUMENT);
    assert_null(together);
    assert_int_equal(conus_together_count(NULL), 0);
    conus_together_destroy(NULL);
    end_scene(&scene);
}

static bool never(void *user, size_t done, size_t total)
{
    (void)user;
    (void)done;
    (void)total;
    return false;
}

static void a_run_is_cancelled(void **state)
{
    (void)state;
    uint64_t seed = 5;
    struct scene scene;
    make_scene(&scene, 2);
    for (size_t i = 0; i < 2; i++) {
        write_random(&scene.candidates[i], i ? "stop-1.tsv" : "stop-0.tsv", 5, &seed, false);
    }
    conus_together *together = NULL;
    const conus_together_options options = {.progress = never};
    assert_fails(conus_plan_together(&together, scene.needles, 2, &options), CONUS_ERROR_CANCELLED);
    assert_null(together);
    end_scene(&scene);
}

/* Ends the run once the search has told three times that nothing more was tried. What is said of it: a bound that never
 * rises, of what is found. */
struct patience {
    size_t done, calls;
    conus_so_far so_far;
    double bound;
};

static bool until_it_searches(void *user, size_t done, size_t total)
{
    struct patience *patience = user;
    const conus_so_far *so_far = &patience->so_far;
    (void)total;
    if (so_far->combination) {
        assert_int_equal(so_far->combination, 1);
        assert_true(isnan(so_far->leeway) || so_far->leeway <= so_far->bound);
        assert_true(so_far->bound <= patience->bound);
        patience->bound = so_far->bound;
    } else {
        assert_true(isnan(so_far->leeway) && isnan(so_far->bound));
    }
    patience->calls = done == patience->done ? patience->calls + 1 : 0;
    patience->done = done;
    return patience->calls < 3;
}

/* A packing of five needles in one small box, which takes millions of nodes: the best one by then is the answer, and
 * none has more than its bound. */
static void a_search_that_is_cancelled_has_an_answer(void **state)
{
    (void)state;
    uint64_t seed = 8;
    struct scene scene;
    make_scene(&scene, NEEDLES);
    for (size_t i = 0; i < NEEDLES; i++) {
        char name[32];
        snprintf(name, sizeof name, "packed-%zu.tsv", i);
        write_random(&scene.candidates[i], name, 500, &seed, false);
    }
    struct patience patience = {.bound = INFINITY};
    const conus_together_options options = {.between = 2.6,
                                            .effort = UINT64_MAX,
                                            .progress = until_it_searches,
                                            .progress_user = &patience,
                                            .so_far = &patience.so_far};
    conus_together *together = NULL;
    assert_ok(conus_plan_together(&together, scene.needles, NEEDLES, &options));
    const conus_combination *combination = conus_together_combination(together, 0);
    assert_non_null(combination);
    assert_true(combination->feasible && !combination->proven);
    assert_true(combination->bound >= combination->leeway);
    assert_true(combination->leeway >= patience.so_far.leeway && combination->bound <= patience.bound + 1e-9);
    assert_null(conus_together_conflict(together));
    conus_together_destroy(together);
    end_scene(&scene);
}

static conus_status try_once(void *data)
{
    struct scene *scene = data;
    conus_together *together = NULL;
    conus_table *pairs = NULL;
    conus_status status = conus_plan_together(&together, scene->needles, scene->count,
                                              &(conus_together_options){.between = 1, .top = 3, .diverse = 2});
    status = status ? status : conus_together_pairs(&pairs, together);
    conus_table_destroy(pairs);
    conus_together_destroy(together);
    together = NULL;
    static const conus_cover covers[2] = {{"1", 1}, {"1,2", 0}};
    const conus_together_options covering = {.covers = covers, .cover_count = 2};
    status = status ? status : conus_plan_together(&together, scene->needles, scene->count, &covering);
    conus_together_destroy(together);
    together = NULL;
    /* On arcs: there is a combination but for their limits. */
    const conus_together_options limited = {.arcs = 1e-3, .same = 1e-4, .slider = 1e-9, .arcs_most = 1};
    status = status ? status : conus_plan_together(&together, scene->needles, scene->count, &limited);
    if (!status) {
        assert_true(conus_together_conflict(together)->by_limits);
    }
    conus_together_destroy(together);
    return status;
}

static void every_failing_allocation_is_clean(void **state)
{
    (void)state;
    uint64_t seed = 5;
    struct scene scene;
    make_scene(&scene, 2);
    for (size_t i = 0; i < 2; i++) {
        write_random(&scene.candidates[i], i ? "memory-1.tsv" : "memory-0.tsv", 5, &seed, false);
    }
    scene.needles[0].arc = "a";
    scene.needles[0].contacts = scene.needles[1].contacts = (conus_contacts){.count = 2, .columns = 1, .pitch = 2};
    test_every_allocation(try_once, &scene);
    end_scene(&scene);
}

TEST_GROUP(plan_together)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_instances_are_as_all_combinations),
        cmocka_unit_test(so_are_those_of_needles_with_several_questions),
        cmocka_unit_test(long_lists_are_listed_as_far_as_it_takes),
        cmocka_unit_test(limits_are_those_of_the_equations),
        cmocka_unit_test(crossing_and_collinear),
        cmocka_unit_test(a_conflict_says_how_far_it_is),
        cmocka_unit_test(the_leeway_of_a_pair),
        cmocka_unit_test(given_needles),
        cmocka_unit_test(answers_do_not_depend_on_threads),
        cmocka_unit_test(what_is_said_of_candidates),
        cmocka_unit_test(candidates_that_change_are_refused),
        cmocka_unit_test(covers_are_its_own),
        cmocka_unit_test(what_is_not_allowed),
        cmocka_unit_test(a_run_is_cancelled),
        cmocka_unit_test(a_search_that_is_cancelled_has_an_answer),
        cmocka_unit_test(every_failing_allocation_is_clean),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
