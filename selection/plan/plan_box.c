/* SPDX-License-Identifier: BSD-3-Clause */
/* How far a pose may be off in five ways at once (Eq. 23). The box of deviations is divided until each part is proven
 * or one is found that breaks a constraint: where the pose in the middle of a part has a leeway, no constraint breaks
 * in the part if no deviation in it moves a point of the needle farther than that.
 */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "poses/rows/pose_row.h"
#include "selection/plan/plan.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double SHIFT_LIMIT = 20;          /* mm */
static const double TURN_LIMIT = MATH3_PI / 6; /* radians */
static const double TOUCH = 1e-8;              /* mm of a leeway that are left, for rounding */
static const double CLOSE = 0.99;              /* part of the refuted deviation: proving so much is enough */
enum { SHIFTS = 3, WAYS = 5, PART_LIMIT = 20000, HALVINGS = 20 };

/* Deviations: shifts along the axes, mm, then pitch and yaw, radians. */
struct part {
    double middle[WAYS], half[WAYS];
    double least; /* factor of the deviation nearest to none */
};

struct parts {
    struct part *items; /* a heap, the least first */
    size_t count, capacity;
};

struct box {
    const conus_planned *from;
    struct plan_judge *judge;
    size_t count; /* of constraints */
    size_t wary;  /* the constraint that was not proven last */
    double unit[WAYS];
    double shifts[SHIFTS][3];
    double pivot[3];
    double lever; /* mm from there to the farthest point of the needle */
    double limit; /* factor */
    double worst[WAYS];
    double fails_at; /* the factor of the worst deviation that is known to break something, INFINITY without one; */
    size_t breaks;   /* the constraint that it breaks */
};

static void move(conus_planned *out, const struct box *box, const double off[WAYS])
{
    double *m = out->pose.world_from_device;
    double hand = pose_is_mirrored(&box->from->pose) ? -1 : 1;
    *out = *box->from;
    vec3_sub(m + 12, m + 12, box->pivot);
    for (int way = SHIFTS; way < WAYS; way++) {
        const double *axis = box->from->pose.world_from_device + 4 * (way - SHIFTS);
        for (int column = 0; column < 4; column++) {
            vec3_turn(m + 4 * column, m + 4 * column, axis, hand * off[way]);
        }
    }
    vec3_add_scaled(m + 12, m + 12, 1, box->pivot);
    for (int a = 0; a < SHIFTS; a++) {
        vec3_add_scaled(m + 12, m + 12, off[a], box->shifts[a]);
    }
    out->entry_angle = isnan(out->entry_angle) ? NAN : vec3_angle(m + 8, out->normal);
}

static double factor_of(const struct box *box, const double off[WAYS])
{
    double factor = 0;
    for (int way = 0; way < WAYS; way++) {
        factor = box->unit[way] > 0 ? fmax(factor, fabs(off[way]) / box->unit[way]) : factor;
    }
    return factor;
}

/* Radians between the needle in the middle and another one of the part, at most: turns about lines that are
 * perpendicular. */
static double turn_within(const struct part *part)
{
    return hypot(part->half[3], part->half[4]);
}

/* mm by which a point of the needle in the middle is off in the part, at most. */
static double shift_within(const struct box *box, const struct part *part)
{
    double most = 0;
    for (int corner = 0; corner < 4; corner++) { /* the others are opposite */
        double sum[3];
        vec3_scale(sum, box->shifts[0], part->half[0]);
        vec3_add_scaled(sum, sum, corner & 1 ? -part->half[1] : part->half[1], box->shifts[1]);
        vec3_add_scaled(sum, sum, corner & 2 ? -part->half[2] : part->half[2], box->shifts[2]);
        most = fmax(most, vec3_length(sum));
    }
    return most + box->lever * turn_within(part);
}

/* Whether all deviations of the part keep a constraint, and whether the one in the middle does, which the judge is
 * turned to. */
static conus_status ask(bool *is_proven, bool *holds, const struct box *box, const struct part *part, size_t index)
{
    const struct plan_constraint *constraint = &box->judge->constraints[index];
    conus_constraint_kind kind = constraint->asked.kind;
    bool is_direction = kind == CONUS_CONSTRAINT_LEAN || kind == CONUS_CONSTRAINT_ENTRY_ANGLE;
    conus_verdict verdict = {0};
    *is_proven = *holds = true;
    if (kind == CONUS_CONSTRAINT_LENGTH) {
        return CONUS_OK;
    }
    if (constraint->has_leeway && !is_direction) {
        conus_status status =
            plan_judge_least(is_proven, box->judge, index, PLAN_LEEWAY, shift_within(box, part) + TOUCH);
        if (status || *is_proven) {
            return status;
        }
    }
    conus_status status = plan_judge(&verdict, box->judge, index, is_direction ? PLAN_SLACKS : PLAN_HOLDS);
    *holds = verdict.holds;
    *is_proven = *holds && !constraint->has_leeway;
    if (is_direction) {
        *is_proven = *holds && verdict.slack >= turn_within(part);
    }
    return status;
}

/* Whether a part is proven; a middle that breaks a constraint is noted. */
static conus_status judge(bool *is_proven, struct box *box, const struct part *part)
{
    conus_planned moved;
    conus_status status = CONUS_OK;
    bool holds = true;
    *is_proven = true;
    move(&moved, box, part->middle);
    plan_judge_turn(box->judge, &moved);
    for (size_t i = 0; i < box->count && *is_proven && !status; i++) {
        size_t index = (box->wary + i) % box->count;
        status = ask(is_proven, &holds, box, part, index);
        box->wary = *is_proven ? box->wary : index;
    }
    if (!status && !holds && factor_of(box, part->middle) < box->fails_at) {
        box->fails_at = factor_of(box, part->middle);
        box->breaks = box->wary;
        memcpy(box->worst, part->middle, sizeof box->worst);
    }
    return status;
}

/* Follows the ray to a corner of the box to where it first is seen to break: the worst deviations often are there. */
static conus_status follow_corner(struct box *box, int corner)
{
    struct part at = {0};
    conus_status status = CONUS_OK;
    double low = 0;
    double high = fmin(box->limit, box->fails_at);
    double factor = high;
    for (int i = 0; i < HALVINGS && !status; i++) {
        bool is_proven;
        for (int way = 0; way < WAYS; way++) {
            at.middle[way] = (corner >> way & 1 ? -factor : factor) * box->unit[way];
        }
        status = judge(&is_proven, box, &at);
        if (is_proven && i == 0) {
            return status;
        }
        *(is_proven ? &low : &high) = factor;
        factor = (low + high) / 2;
    }
    return status;
}

/* Cuts off what is known to lie beyond a deviation that breaks; false where nothing is left. */
static bool clip(struct part *part, const struct box *box)
{
    double most = fmin(box->limit, box->fails_at);
    part->least = 0;
    for (int way = 0; way < WAYS; way++) {
        double end = most * box->unit[way];
        double low = fmax(part->middle[way] - part->half[way], -end);
        double high = fmin(part->middle[way] + part->half[way], end);
        if (low > high) {
            return false;
        }
        part->middle[way] = (low + high) / 2;
        part->half[way] = (high - low) / 2;
        double nearest = low > 0 ? low : high < 0 ? -high : 0;
        part->least = box->unit[way] > 0 ? fmax(part->least, nearest / box->unit[way]) : part->least;
    }
    return part->least < most;
}

static conus_status push(struct parts *parts, const struct part *part)
{
    if (!memory_reserve(&parts->items, &parts->capacity, parts->count + 1, sizeof *parts->items)) {
        return CONUS_ERROR_MEMORY;
    }
    size_t at = parts->count++;
    for (; at && parts->items[(at - 1) / 2].least > part->least; at = (at - 1) / 2) {
        parts->items[at] = parts->items[(at - 1) / 2];
    }
    parts->items[at] = *part;
    return CONUS_OK;
}

static struct part pop(struct parts *parts)
{
    struct part first = parts->items[0];
    struct part last = parts->items[--parts->count];
    size_t at = 0;
    for (size_t next = 1; next < parts->count; next = 2 * at + 1) {
        next += next + 1 < parts->count && parts->items[next + 1].least < parts->items[next].least;
        if (last.least <= parts->items[next].least) {
            break;
        }
        parts->items[at] = parts->items[next];
        at = next;
    }
    parts->items[at] = last;
    return first;
}

/* Adds the halves of a part, across the way that moves the needle most. */
static conus_status divide(struct parts *parts, const struct box *box, const struct part *part)
{
    conus_status status = CONUS_OK;
    int widest = 0;
    double most = -1;
    for (int way = 0; way < WAYS; way++) {
        double moves = part->half[way] * (way < SHIFTS ? 1 : box->lever);
        widest = moves > most ? way : widest;
        most = fmax(most, moves);
    }
    for (int side = -1; side <= 1 && !status; side += 2) {
        struct part half = *part;
        half.half[widest] /= 2;
        half.middle[widest] += side * half.half[widest];
        status = clip(&half, box) ? push(parts, &half) : CONUS_OK;
    }
    return status;
}

static conus_status search(double *proven, struct box *box)
{
    struct parts parts = {0};
    struct part whole = {0};
    conus_status status = CONUS_OK;
    for (int way = 0; way < WAYS; way++) {
        whole.half[way] = box->limit * box->unit[way];
    }
    for (int corner = 0; corner < 1 << WAYS && !status; corner++) {
        status = follow_corner(box, corner);
    }
    status = status || !clip(&whole, box) ? status : push(&parts, &whole);
    for (size_t i = 0; i < PART_LIMIT && parts.count && parts.items[0].least < CLOSE * box->fails_at && !status; i++) {
        struct part part = pop(&parts);
        bool is_proven = true;
        if (clip(&part, box)) {
            status = judge(&is_proven, box, &part);
            status = status || is_proven ? status : divide(&parts, box, &part);
        }
    }
    *proven = fmin(parts.count ? parts.items[0].least : INFINITY, fmin(box->limit, box->fails_at));
    memory_free(parts.items);
    return status;
}

static conus_status init_box(struct box *out, struct plan_judge *judge, const conus_planned *pose,
                             const conus_tolerance_options *options)
{
    const double *m = pose->pose.world_from_device;
    const double direction[3] = {-m[8], -m[9], -m[10]};
    *out = (struct box){.from = pose, .judge = judge, .limit = INFINITY, .fails_at = INFINITY};
    for (int way = 0; way < WAYS; way++) {
        double unit = options->box[way];
        if (!(unit >= 0 && isfinite(unit))) {
            return fail(CONUS_ERROR_ARGUMENT, "tolerance: a box of %g", unit);
        }
        out->unit[way] = unit;
        out->limit = unit > 0 ? fmin(out->limit, (way < SHIFTS ? SHIFT_LIMIT : TURN_LIMIT) / unit) : out->limit;
    }
    if (!isfinite(out->limit)) {
        return fail(CONUS_ERROR_ARGUMENT, "tolerance: a box without any extent");
    }
    memcpy(out->shifts, options->shifts, sizeof out->shifts);
    vec3_add_scaled(out->pivot, m + 12, options->pivot_at_tip ? pose->far : options->pivot, direction);
    plan_judge_turn(judge, pose);
    out->lever = plan_judge_lever(judge, out->pivot, NULL);
    return CONUS_OK;
}

conus_status conus_plan_box(conus_tolerance *out, conus_plan *plan, const conus_planned *pose,
                            const conus_tolerance_options *options)
{
    conus_tolerance_options filled;
    struct box box;
    conus_tolerance row = {.freedom = CONUS_FREEDOM_BOX, .constraint = SIZE_MAX, .depth = NAN, .at = {NAN, NAN, NAN}};
    conus_status status = plan_tolerance_fill(&filled, options);
    status = status ? status : init_box(&box, plan_judge_of(plan), pose, &filled);
    if (status) {
        return status;
    }
    box.count = conus_plan_constraint_count(plan);
    for (size_t i = 0; i < box.count; i++) {
        const struct plan_constraint *constraint = &box.judge->constraints[i];
        bool is_sampled = !constraint->has_leeway && constraint->asked.kind != CONUS_CONSTRAINT_LENGTH &&
                          constraint->asked.kind != CONUS_CONSTRAINT_LEAN &&
                          constraint->asked.kind != CONUS_CONSTRAINT_ENTRY_ANGLE;
        row.method = is_sampled ? CONUS_TOLERANCE_SAMPLED : row.method;
    }
    box.fails_at = pose->feasible ? INFINITY : 0;
    box.breaks = pose->broken;
    status = pose->feasible ? search(&row.holds_to, &box) : CONUS_OK;
    row.fails_at = isfinite(box.fails_at) ? box.fails_at : NAN;
    if (!status && isfinite(box.fails_at)) {
        conus_planned moved;
        move(&moved, &box, box.worst);
        status = plan_tolerance_describe(&row, box.judge, box.breaks, &moved);
    }
    if (!status) {
        *out = row;
    }
    return status;
}
