/* SPDX-License-Identifier: BSD-3-Clause */
/* How far a pose may be off along each degree of freedom (Eq. 23). Where a pose has a leeway, no point of its axis may
 * leave its place by as much as that; a step along a degree of freedom moves them by no more than a known rate. So
 * steps of leeway / rate never pass the place where a constraint breaks.
 */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"
#include "selection/plan/plan.h"

#include <math.h>
#include <string.h>

static const double SHIFT_LIMIT = 20;          /* mm */
static const double TURN_LIMIT = MATH3_PI / 6; /* radians */
static const double STEP = 0.01;               /* mm or degrees: of samples, and over what is grazed */
static const double RESOLUTION = 1e-6;         /* mm or degrees */
static const double FIRST_GUESS = 4;           /* mm of a leeway */
static const double TOUCH = 1e-8;              /* mm of a leeway that are left, for rounding */
enum { EVALUATION_LIMIT = 4000 };

/* A degree of freedom of a pose, to one side. */
struct motion {
    const conus_planned *from;
    bool is_turn, is_depth;
    double along[3]; /* unit direction of a shift, axis of a turn; of the depth [0] is its sign */
    double pivot[3]; /* of a turn */
    double unit;     /* a mm or a degree */
    double most;     /* the cap */
    double lever;    /* mm that a point of the axis moves at most, by 1 */
};

/* How one constraint is followed along a motion. */
struct course {
    enum { COURSE_FIXED, COURSE_MARCH, COURSE_SPAN, COURSE_SAMPLED } kind;
    double rate;   /* of COURSE_MARCH: its leeway falls by no more, by 1 */
    double guess;  /* a leeway that it may have */
    double proven; /* it holds up to here */
    double fails;  /* and breaks here; NaN = not yet known */
};

/* The pose that is off by `s`. */
static void move(conus_planned *out, const struct motion *motion, double s)
{
    double *m = out->pose.world_from_device;
    *out = *motion->from;
    if (motion->is_depth) {
        out->far += s * motion->along[0];
    } else if (!motion->is_turn) {
        vec3_add_scaled(m + 12, m + 12, s, motion->along);
    } else {
        for (int column = 0; column < 3; column++) {
            vec3_turn(m + 4 * column, m + 4 * column, motion->along, s);
        }
        vec3_sub(m + 12, m + 12, motion->pivot);
        vec3_turn(m + 12, m + 12, motion->along, s);
        vec3_add_scaled(m + 12, m + 12, 1, motion->pivot);
        out->entry_angle = isnan(out->entry_angle) ? NAN : degrees_from_radians(plan_entry_angle(out));
    }
}

static void init_motion(struct motion *out, struct plan_judge *judge, const conus_planned *pose,
                        const conus_tolerance *row, const conus_tolerance_options *options)
{
    const double *up = options->up;
    const double *m = pose->pose.world_from_device;
    const double direction[3] = {-m[8], -m[9], -m[10]};
    const conus_freedom freedom = row->freedom;
    bool is_upward = false;
    *out = (struct motion){
        .from = pose, .is_turn = freedom >= CONUS_FREEDOM_PITCH, .is_depth = freedom == CONUS_FREEDOM_DEPTH};
    out->unit = out->is_turn ? radians_from_degrees(1) : 1;
    out->most = out->is_turn ? TURN_LIMIT : SHIFT_LIMIT;
    switch (freedom) {
    case CONUS_FREEDOM_X:
    case CONUS_FREEDOM_Y:
    case CONUS_FREEDOM_Z:
        memcpy(out->along, options->shifts[freedom], sizeof out->along); /* of length 1 */
        break;
    case CONUS_FREEDOM_DEPTH:
        out->along[0] = 1;
        out->most = row->negative ? fmin(out->most, pose->far - pose->near - RESOLUTION) : out->most;
        break;
    case CONUS_FREEDOM_AZIMUTH:
        memcpy(out->along, up, sizeof out->along);
        break;
    case CONUS_FREEDOM_ELEVATION:
        vec3_cross(out->along, direction, up);
        if (vec3_length(out->along) > 1e-9) {
            is_upward = true;
            break;
        }
        memcpy(out->along, m, sizeof out->along);
        break;
    default: /* device x or y */
        memcpy(out->along, m + 4 * ((freedom - CONUS_FREEDOM_SIDE) % 2), sizeof out->along);
        break;
    }
    vec3_normalise(out->along, out->along);
    /* In a world that is a mirror image the right hand is the left one; elevation is towards up in either. */
    bool mirrored = out->is_turn && !is_upward && pose_is_mirrored(&pose->pose);
    vec3_scale(out->along, out->along, row->negative != mirrored ? -1 : 1);
    double pivot = options->pivot_at_tip ? pose->far : options->pivot;
    vec3_add_scaled(out->pivot, m + 12, pivot, direction);
    plan_judge_turn(judge, pose);
    out->lever = out->is_turn ? plan_judge_lever(judge, out->pivot, out->along) : 1;
}

static struct course start_course(const struct plan_constraint *constraint, const struct motion *motion,
                                  const conus_verdict *verdict)
{
    const conus_constraint *asked = &constraint->asked;
    struct course course = {.kind = COURSE_SAMPLED, .rate = motion->lever, .guess = FIRST_GUESS, .fails = NAN};
    bool is_tip = asked->kind == CONUS_CONSTRAINT_REACH && asked->measure == CONUS_MEASURE_TIP;
    bool is_direction = plan_is_of_direction(constraint);
    bool is_of_rig = plan_is_of_rig(constraint);
    if (is_of_rig && motion->is_turn) {
        return course; /* the nearer to the right-left axis, the faster the arc angle turns */
    }
    if (asked->kind == CONUS_CONSTRAINT_LENGTH || is_direction || is_of_rig) {
        course.kind = is_direction && motion->is_turn                    ? COURSE_MARCH
                      : !(is_direction || is_of_rig) && motion->is_depth ? COURSE_SPAN
                                                                         : COURSE_FIXED;
        course.rate = 1;
        course.guess = MATH3_PI;
    } else if (motion->is_depth && !is_tip) {
        /* the longer the needle, the more it meets: a constraint that breaks stays broken */
        bool has_part = asked->part[0] > 0 || asked->part[1] > 0;
        course.kind = has_part || asked->measure > CONUS_MEASURE_CROSSED ? COURSE_SAMPLED : COURSE_SPAN;
    } else if (constraint->has_leeway) {
        course.kind = COURSE_MARCH;
        course.proven = fmax(verdict->leeway - TOUCH, 0) / course.rate;
        course.guess = 2 * verdict->leeway;
    }
    return course;
}

static conus_status is_held(bool *out, struct plan_judge *judge, size_t index, const struct motion *motion, double s)
{
    conus_planned moved;
    conus_verdict verdict = {0};
    move(&moved, motion, s);
    plan_judge_turn(judge, &moved);
    conus_status status = plan_judge(&verdict, judge, index, PLAN_HOLDS);
    *out = verdict.holds;
    return status;
}

/* Looks beyond where the constraint holds, `first` and then twice as far each time, up to `step`: it then holds there,
 * as it was seen, or is known to break. */
static conus_status look_ahead(struct course *course, struct plan_judge *judge, size_t index,
                               const struct motion *motion, double first, double step)
{
    double low = course->proven;
    double high = low;
    double end = fmin(low + step, motion->most);
    bool holds = true;
    conus_status status = CONUS_OK;
    double ahead = first;
    while (!status && holds && high < end) {
        low = high;
        high = fmin(course->proven + ahead, end);
        ahead *= 2;
        status = is_held(&holds, judge, index, motion, high);
    }
    if (holds || status) {
        course->proven = high;
        return status;
    }
    while (!status && high - low > RESOLUTION * motion->unit * (1 + 1e-9)) {
        double middle = low + (high - low) / 2;
        status = is_held(&holds, judge, index, motion, middle);
        *(holds ? &low : &high) = middle;
    }
    course->proven = low;
    course->fails = high;
    return status;
}

/* Follows a constraint a step farther. `must_jump`: by a sample, whatever its leeway. */
static conus_status advance(bool *grazes, struct course *course, struct plan_judge *judge, size_t index,
                            const struct motion *motion, bool must_jump)
{
    double sample = STEP * motion->unit;
    double next = RESOLUTION * motion->unit;
    double leeway = 0;
    switch (course->kind) {
    case COURSE_FIXED:
        course->proven = motion->most;
        return CONUS_OK;
    case COURSE_SPAN:
        return look_ahead(course, judge, index, motion, motion->most, motion->most);
    case COURSE_SAMPLED:
        return look_ahead(course, judge, index, motion, sample, sample);
    default: {
        conus_planned moved;
        move(&moved, motion, course->proven);
        plan_judge_turn(judge, &moved);
        conus_status status = must_jump ? CONUS_OK : plan_judge_leeway(&leeway, judge, index, course->guess);
        double before = course->proven;
        course->guess = fmax(leeway < course->guess ? leeway : 2 * leeway, RESOLUTION);
        leeway = fmax(leeway - TOUCH, 0);
        course->proven += leeway / course->rate;
        if (!status && leeway < next * course->rate) {
            double proven = course->proven;
            course->proven = before;
            status = look_ahead(course, judge, index, motion, next, leeway == 0 ? sample : next);
            *grazes = leeway == 0 && !(course->fails < before + 2 * next);
            course->proven = isnan(course->fails) && !*grazes ? proven : course->proven;
        }
        return status;
    }
    }
}

/* Tells where constraint `index` breaks. */
static conus_status describe(conus_tolerance *row, struct plan_judge *judge, size_t index, const struct motion *motion)
{
    conus_verdict verdict;
    conus_planned moved;
    move(&moved, motion, row->fails_at);
    plan_judge_turn(judge, &moved);
    conus_status status = plan_judge(&verdict, judge, index, PLAN_SLACKS);
    if (status) {
        return status;
    }
    row->constraint = index;
    row->object = verdict.object;
    row->depth = verdict.depth;
    needle_point(row->at, &judge->shanks[verdict.shank - 1].needle, verdict.depth);
    return CONUS_OK;
}

/* Follows all constraints along a motion, always the one that is known to hold least far. */
static conus_status follow(conus_tolerance *row, struct plan_judge *judge, struct course *courses, size_t count,
                           const struct motion *motion)
{
    conus_status status = CONUS_OK;
    double kept = INFINITY; /* up to where it was grazed first */
    for (size_t i = 0; i < count; i++) {
        courses[i] = start_course(&judge->constraints[i], motion, &motion->from->verdicts[i]);
        row->method = courses[i].kind == COURSE_SAMPLED ? CONUS_TOLERANCE_SAMPLED : row->method;
    }
    for (size_t evaluations = 0; !status; evaluations++) {
        size_t least = 0;
        for (size_t i = 1; i < count; i++) {
            least = courses[i].proven < courses[least].proven ? i : least;
        }
        struct course *course = &courses[least];
        bool grazes = false;
        double before = course->proven;
        row->holds_to = fmin(fmin(before, kept), motion->most);
        row->fails_at = course->fails;
        if (before >= motion->most || !isnan(course->fails)) {
            return isnan(course->fails) ? CONUS_OK : describe(row, judge, least, motion);
        }
        status = advance(&grazes, course, judge, least, motion, evaluations > EVALUATION_LIMIT);
        if (grazes) {
            kept = fmin(kept, before);
            row->method = CONUS_TOLERANCE_GRAZED;
        }
    }
    return status;
}

/* Checks options and fills in defaults; shifts become unit vectors. */
static conus_status fill_options(conus_tolerance_options *out, const conus_tolerance_options *options)
{
    static const double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    *out = *options_of(conus_tolerance_options, options);
    bool has_shifts = false;
    for (int i = 0; i < 9; i++) {
        has_shifts = has_shifts || out->shifts[i / 3][i % 3] != 0;
    }
    if (!has_shifts) {
        memcpy(out->shifts, axes, sizeof axes);
    }
    if (out->up[0] == 0 && out->up[1] == 0 && out->up[2] == 0) {
        out->up[2] = 1;
    }
    if (!vec3_normalise(out->up, out->up)) {
        return fail(CONUS_ERROR_ARGUMENT, "tolerance: an up without a direction");
    }
    for (int a = 0; a < 3; a++) {
        if (!vec3_normalise(out->shifts[a], out->shifts[a])) {
            return fail(CONUS_ERROR_ARGUMENT, "tolerance: a shift without a direction");
        }
    }
    return isfinite(out->pivot) ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "tolerance: a pivot at %g mm", out->pivot);
}

conus_status conus_plan_tolerance(conus_tolerance *out, conus_plan *plan, const conus_planned *pose,
                                  const conus_tolerance_options *options)
{
    struct plan_judge *judge = plan_judge_of(plan);
    size_t count = conus_plan_constraint_count(plan);
    conus_tolerance rows[CONUS_TOLERANCE_COUNT];
    conus_tolerance_options filled;
    conus_status status = fill_options(&filled, options);
    if (status) {
        return status;
    }
    struct course *courses = memory_raw(count, sizeof *courses);
    status = courses ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (int i = 0; i < CONUS_TOLERANCE_COUNT && !status; i++) {
        struct motion motion;
        rows[i] = (conus_tolerance){.freedom = (conus_freedom)(i / 2),
                                    .negative = i % 2,
                                    .constraint = SIZE_MAX,
                                    .depth = NAN,
                                    .at = {NAN, NAN, NAN}};
        init_motion(&motion, judge, pose, &rows[i], &filled);
        status = pose->feasible ? follow(&rows[i], judge, courses, count, &motion)
                                : describe(&rows[i], judge, pose->broken, &motion);
        if (motion.is_turn) {
            rows[i].holds_to = degrees_from_radians(rows[i].holds_to);
            rows[i].fails_at = degrees_from_radians(rows[i].fails_at);
        }
    }
    memory_free(courses);
    if (!status) {
        memcpy(out, rows, sizeof rows);
    }
    return status;
}
