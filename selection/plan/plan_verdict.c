/* SPDX-License-Identifier: BSD-3-Clause */
/* Judges one pose by one constraint after the other (Eq. 22). */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/plan/plan.h"
#include "selection/plan/together/together.h"

#include <math.h>
#include <string.h>

static const double LOOK = 1e-5;    /* mm: closer to its limit, a measure is taken */
static const double FAR = 1e7;      /* mm: as far as a clearance is measured */
static const double DEGREES = 1e-9; /* by which an angle of a rig may be beyond its window */

conus_status plan_judge_init(struct plan_judge *out, conus_selector *selector,
                             const struct plan_constraint *constraints, const double (*offsets)[2], size_t shank_count)
{
    *out = (struct plan_judge){.constraints = constraints, .offsets = offsets, .shank_count = shank_count};
    conus_status status = selector_prepare_axis(selector);
    status = status ? status : selector_prepare_clearance(selector);
    status = status ? status : selector_share(&out->selector, selector);
    if (!status) {
        out->selector->inside_only = true;
        status = selector_prepare_clearance(out->selector);
    }
    out->shanks = memory_zeroed(shank_count, sizeof *out->shanks);
    return status || out->shanks ? status : CONUS_ERROR_MEMORY;
}

void plan_judge_finish(struct plan_judge *judge)
{
    for (size_t i = 0; judge->shanks && i < judge->shank_count; i++) {
        conus_selection_destroy(judge->shanks[i].selection);
        layers_finish(&judge->shanks[i].layers);
    }
    memory_free(judge->shanks);
    conus_selector_destroy(judge->selector);
    plan_leeway_finish(&judge->leeway);
}

void plan_judge_turn(struct plan_judge *judge, const conus_planned *pose)
{
    judge->pose = pose;
    for (size_t i = 0; i < judge->shank_count; i++) {
        struct plan_shank *shank = &judge->shanks[i];
        double *device = shank->pose.world_from_device;
        shank->pose = pose->pose;
        vec3_add_scaled(device + 12, device + 12, judge->offsets[i][0], device);
        vec3_add_scaled(device + 12, device + 12, judge->offsets[i][1], device + 4);
        shank->needle = (struct needle){.near = pose->near, .far = pose->far};
        memcpy(shank->needle.origin, device + 12, sizeof shank->needle.origin);
        vec3_scale(shank->needle.direction, device + 8, -1);
        shank->is_followed = false;
        conus_selection_destroy(shank->selection);
        shank->selection = NULL;
    }
}

double plan_judge_lever(const struct plan_judge *judge, const double pivot[3], const double along[3])
{
    double lever = 0;
    for (size_t i = 0; i < 2 * judge->shank_count; i++) { /* the farthest is an end of one */
        const struct needle *needle = &judge->shanks[i / 2].needle;
        double at[3];
        needle_point(at, needle, i % 2 ? needle->far : needle->near);
        vec3_sub(at, at, pivot);
        if (along) {
            vec3_cross(at, at, along);
        }
        lever = fmax(lever, vec3_length(at));
    }
    return lever;
}

static conus_status follow(struct plan_judge *judge)
{
    conus_status status = CONUS_OK;
    if (!judge->shank->is_followed) {
        layers_clear(&judge->shank->layers);
        status = axis_follow(&judge->shank->layers, judge->selector, &judge->shank->pose, judge->pose->far);
        judge->shank->is_followed = !status;
    }
    return status;
}

/* Finds the depths between which a constraint counts; far is no more than near where there are none. */
static void find_window(double out[2], const struct plan_judge *judge, const struct plan_constraint *constraint)
{
    const double *part = constraint->asked.part;
    bool is_all = part[0] == 0 && part[1] == 0;
    out[0] = is_all ? judge->pose->near : fmax(judge->pose->near, judge->pose->far - part[1]);
    out[1] = judge->pose->far - part[0];
}

/* mm of the axis in the union of the structure's objects: each stretch in order of depth. */
static void measure_length(conus_verdict *out, const struct plan_judge *judge, const struct plan_constraint *constraint)
{
    double range[2];
    double entry = NAN;
    double exit = NAN;
    find_window(range, judge, constraint);
    out->value = 0;
    out->depth = NAN;
    for (size_t i = 0; i < judge->shank->layers.count && range[1] > range[0]; i++) {
        conus_interval interval = judge->shank->layers.intervals[i];
        if (!constraint->has[interval.object] || !axis_clip(&interval, judge->selector->atlas, range)) {
            continue;
        }
        if (interval.entry <= exit + AXIS_TOUCH) {
            exit = fmax(exit, interval.exit);
            continue;
        }
        out->depth = isnan(out->depth) ? interval.entry : out->depth;
        out->value += isnan(exit) ? 0 : exit - entry;
        entry = interval.entry;
        exit = interval.exit;
    }
    out->value += isnan(exit) ? 0 : exit - entry;
}

/* Whether a point of the axis is in the structure: where one ends, it is in the next one. */
static bool is_inside(const struct plan_judge *judge, const struct plan_constraint *constraint, double depth)
{
    bool is = false;
    for (size_t i = 0; i < judge->shank->layers.count && !is; i++) {
        const conus_interval *interval = &judge->shank->layers.intervals[i];
        is = constraint->has[interval->object] && interval->entry <= depth && interval->exit > depth;
    }
    return is;
}

/* The probability of the structure at a point of the axis, summed over its maps. */
static double probability_at(const struct plan_judge *judge, const struct plan_constraint *constraint, double depth)
{
    double point[3];
    double sum = 0;
    needle_point(point, &judge->shank->needle, depth);
    for (size_t i = 0; i < constraint->part_count; i++) {
        const struct volume *volume = constraint->parts[i].volume;
        size_t voxel;
        sum += volume_find_voxel(&voxel, volume, point) ? fmax((double)volume_value(volume, voxel), 0) : 0;
    }
    return sum;
}

/* How many contacts are in the structure, or their mean probability. Those of a row are at one depth. */
static void measure_contacts(conus_verdict *out, const struct plan_judge *judge,
                             const struct plan_constraint *constraint)
{
    const conus_contacts *contacts = &constraint->asked.contacts;
    bool is_mean = constraint->asked.measure == CONUS_MEASURE_PROBABILITY;
    double depth = judge->pose->far - contacts->tip;
    uint32_t left = contacts->count;
    out->value = 0;
    for (uint32_t row = 0; left && depth >= judge->pose->near; row++) {
        uint32_t count = left < contacts->columns ? left : contacts->columns;
        out->value +=
            count * (is_mean ? probability_at(judge, constraint, depth) : (double)is_inside(judge, constraint, depth));
        left -= count;
        depth = judge->pose->far - contacts->tip - (row + 1) * contacts->pitch;
    }
    out->value /= is_mean ? contacts->count : 1;
}

/* The integral of a map's values along the needle, cell by cell. */
static double sum_values(const struct volume *volume, const struct needle *needle)
{
    const double *m = volume->voxel_from_world;
    double from[3];
    double step[3]; /* cells a mm */
    double plane[3];
    double at = needle->near;
    double end = needle->far;
    double sum = 0;
    mat4_point(from, m, needle->origin);
    for (int a = 0; a < 3; a++) {
        step[a] = m[a] * needle->direction[0] + m[4 + a] * needle->direction[1] + m[8 + a] * needle->direction[2];
        double low = (-0.5 - from[a]) / step[a];
        double high = ((double)volume->info.dim[a] - 0.5 - from[a]) / step[a];
        bool moves = isfinite(low) && isfinite(high); /* beside the grid no voxel is found */
        at = moves ? fmax(at, fmin(low, high)) : at;
        end = moves ? fmin(end, fmax(low, high)) : end;
        step[a] = moves ? step[a] : 0;
    }
    for (int a = 0; a < 3; a++) { /* the next one */
        double cell = from[a] + at * step[a];
        plane[a] = step[a] > 0 ? floor(cell + 0.5) + 0.5 : ceil(cell - 0.5) - 0.5;
    }
    while (at < end) {
        double next = end;
        for (int a = 0; a < 3; a++) {
            next = step[a] != 0 ? fmin(next, (plane[a] - from[a]) / step[a]) : next;
        }
        double point[3];
        size_t voxel;
        needle_point(point, needle, at + (next - at) / 2);
        sum += next > at && volume_find_voxel(&voxel, volume, point)
                   ? (next - at) * fmax((double)volume_value(volume, voxel), 0)
                   : 0;
        at = fmax(at, next);
        for (int a = 0; a < 3; a++) {
            plane[a] += step[a] == 0 || (plane[a] - from[a]) / step[a] > at ? 0 : copysign(1, step[a]);
        }
    }
    return sum;
}

/* The mean probability of the structure along the axis. */
static void measure_probability(conus_verdict *out, const struct plan_judge *judge,
                                const struct plan_constraint *constraint)
{
    double length = judge->shank->needle.far - judge->shank->needle.near;
    out->value = 0;
    for (size_t i = 0; i < constraint->part_count && length > 0; i++) {
        out->value += sum_values(constraint->parts[i].volume, &judge->shank->needle) / length;
    }
}

/* Whether the axis passes or crosses the structure; of FIRST, whether nothing else comes before it. */
static void measure_crossing(conus_verdict *out, const struct plan_judge *judge,
                             const struct plan_constraint *constraint)
{
    const double range[2] = {judge->pose->near, judge->pose->far};
    bool is_first = constraint->asked.kind == CONUS_CONSTRAINT_FIRST;
    out->value = 0;
    out->depth = NAN;
    out->object = 0;
    for (size_t i = 0; i < judge->shank->layers.count; i++) {
        conus_interval interval = judge->shank->layers.intervals[i];
        if ((!is_first && !constraint->has[interval.object]) || !axis_clip(&interval, judge->selector->atlas, range)) {
            continue;
        }
        bool is_sooner = !(interval.entry >= out->depth);
        if (is_sooner || (interval.entry == out->depth && constraint->has[interval.object] && out->value == 0)) {
            out->value = constraint->has[interval.object] != 0;
            out->depth = interval.entry;
            out->object = is_first ? interval.object : 0;
        }
    }
}

/* 1 if the axis is farther than `distance` from the structure, -1 if it is nearer, 0 where no map can say. */
static int look_farther(const struct plan_judge *judge, const struct plan_constraint *constraint, double distance)
{
    int farther = 1;
    for (size_t i = 0; i < constraint->part_count && farther >= 0; i++) {
        const struct plan_map *map = constraint->parts[i].map;
        int is = map ? plan_map_is_farther(map, &judge->shank->needle, distance) : 0;
        farther = is < farther ? is : farther;
    }
    return farther;
}

/* 1 if so much of the axis is surely in the structure, -1 if less is, 0 where no map can say. */
static int look_longer(const struct plan_judge *judge, const struct plan_constraint *constraint)
{
    double range[2];
    struct needle needle = judge->shank->needle;
    const struct plan_map *map = constraint->part_count == 1 ? constraint->parts[0].map : NULL;
    find_window(range, judge, constraint);
    needle.near = range[0];
    needle.far = range[1];
    double more = map ? plan_map_inside(map, &needle) - constraint->asked.limit : NAN;
    return more > LOOK ? 1 : more < -LOOK ? -1 : 0;
}

/* 1 if the constraint holds by the maps, -1 if it breaks, else 0. */
static int look(const struct plan_judge *judge, const struct plan_constraint *constraint)
{
    const conus_constraint *asked = &constraint->asked;
    bool is_length = asked->kind == CONUS_CONSTRAINT_REACH && asked->measure == CONUS_MEASURE_LENGTH;
    return !judge->leeway.uses_maps ? 0
           : is_length              ? look_longer(judge, constraint)
           : plan_is_clearance(constraint)
               ? look_farther(judge, constraint, judge->selector->options.radius + asked->limit)
               : 0;
}

/* The axis's distance from the structure, up to `limit`; beyond it infinity, and no object. */
static void measure_clearance(conus_verdict *out, struct plan_judge *judge, const struct plan_constraint *constraint,
                              double limit)
{
    struct clearance *clearance = &judge->selector->clearance;
    const struct clearance_question question = {.atlas = judge->selector->atlas,
                                                .index = judge->selector->clearance_index,
                                                .tracts = judge->selector->tract_index,
                                                .groups = constraint->has,
                                                .limit = limit};
    clearance_take(clearance, &question, &judge->shank->needle);
    out->value = INFINITY;
    out->depth = NAN;
    out->object = 0;
    for (size_t i = 0; i < clearance->touched_count; i++) {
        uint32_t object = clearance->touched[i];
        const struct clearance_found *found = &clearance->found[object];
        bool is_equal = found->distance == out->value && found->depth == out->depth;
        if (found->distance < out->value || (found->distance == out->value && found->depth < out->depth) ||
            (is_equal && object < out->object)) {
            out->value = found->distance;
            out->depth = found->depth;
            out->object = object;
        }
    }
}

static void measure_apart(conus_verdict *out, const struct plan_judge *judge, const struct plan_constraint *constraint)
{
    out->value = INFINITY;
    for (size_t i = 0; i < constraint->asked.needle_count; i++) {
        const double *ends = constraint->asked.needles + 6 * i;
        double depth;
        double point[3];
        double distance = needle_segment(&depth, point, &judge->shank->needle, ends, ends + 3);
        if (distance < out->value) {
            out->value = distance;
            out->depth = depth;
        }
    }
}

/* The angle in the turn whose middle is that of the window. */
static double measure_rig(const struct plan_judge *judge, const conus_constraint *asked)
{
    const double middle = asked->limit + (asked->most - asked->limit) / 2;
    double arc;
    double slider;
    arc_angles(&arc, &slider, &judge->selector->frame, judge->pose->pose.world_from_device + 8);
    return middle + remainder((asked->kind == CONUS_CONSTRAINT_ARC ? arc + asked->pitch : slider) - middle, 360);
}

/* The part of the cone's pixels whose ray has an interval in the structure: intervals are ordered by pixel. */
static double measure_pierced(const conus_selection *selection, const struct plan_constraint *constraint)
{
    const conus_evidence evidence = conus_selection_evidence(selection);
    size_t pixels = (size_t)evidence.resolution * evidence.resolution;
    size_t of_cone = 0;
    size_t pierced = 0;
    size_t last = SIZE_MAX;
    size_t count;
    const conus_interval *intervals = conus_selection_intervals(&count, selection);
    for (size_t i = 0; i < pixels; i++) {
        of_cone += evidence.in_cone[i];
    }
    for (size_t i = 0; i < count; i++) {
        size_t pixel = intervals[i].pixel;
        if (constraint->reported[intervals[i].object] && evidence.in_cone[pixel] && pixel != last) {
            pierced++;
            last = pixel;
        }
    }
    return (double)pierced / (double)of_cone;
}

/* The structure's results, summed in the order of their ranks. */
static void sum_results(conus_verdict *out, const struct plan_judge *judge, const struct plan_constraint *constraint)
{
    conus_measure measure = constraint->asked.measure;
    double whole = 0;
    out->value = 0;
    for (size_t i = 0; i < conus_selection_count(judge->shank->selection); i++) {
        const conus_result *result = conus_selection_result(judge->shank->selection, i);
        if (constraint->reported[result->object]) {
            out->value += measure == CONUS_MEASURE_SHARE         ? result->share
                          : measure == CONUS_MEASURE_STREAMLINES ? (double)result->streamlines
                                                                 : result->volume;
        }
    }
    if (measure == CONUS_MEASURE_FRACTION) {
        for (size_t i = 1; i <= judge->selector->atlas->object_count; i++) {
            whole += constraint->reported[i] ? judge->selector->whole[i] : 0;
        }
        out->value /= whole;
    }
}

double plan_entry_angle(const conus_planned *pose)
{
    return vec3_angle(pose->pose.world_from_device + 8, pose->normal);
}

static conus_status measure_cone(conus_verdict *out, struct plan_judge *judge, const struct plan_constraint *constraint)
{
    const double range[2] = {judge->pose->near, judge->pose->far};
    if (!judge->shank->selection) {
        conus_status status = conus_selector_set_range(judge->selector, range);
        status = status
                     ? status
                     : conus_select(&judge->shank->selection, judge->selector, &judge->shank->pose, judge->pose->angle);
        if (status) {
            return status;
        }
    }
    if (constraint->asked.measure == CONUS_MEASURE_PIERCED) {
        out->value = measure_pierced(judge->shank->selection, constraint);
    } else {
        sum_results(out, judge, constraint);
    }
    return CONUS_OK;
}

/* Value, depth and object; of a clearance that is more than `limit` the value is infinite. */
static conus_status measure(conus_verdict *out, struct plan_judge *judge, const struct plan_constraint *constraint,
                            double limit)
{
    const conus_constraint *asked = &constraint->asked;
    if (plan_is_of_cone(asked->measure)) {
        return measure_cone(out, judge, constraint);
    }
    bool needs_axis = (asked->kind == CONUS_CONSTRAINT_REACH && asked->measure != CONUS_MEASURE_PROBABILITY) ||
                      asked->kind == CONUS_CONSTRAINT_FIRST;
    conus_status status = needs_axis ? follow(judge) : CONUS_OK;
    if (status) {
        return status;
    }
    switch (asked->kind) {
    case CONUS_CONSTRAINT_REACH:
        if (asked->measure == CONUS_MEASURE_LENGTH) {
            measure_length(out, judge, constraint);
        } else if (asked->measure == CONUS_MEASURE_TIP) {
            out->value = is_inside(judge, constraint, judge->pose->far);
        } else if (asked->contacts.count) {
            measure_contacts(out, judge, constraint);
        } else if (asked->measure == CONUS_MEASURE_PROBABILITY) {
            measure_probability(out, judge, constraint);
        } else {
            measure_crossing(out, judge, constraint);
        }
        break;
    case CONUS_CONSTRAINT_AVOID:
        measure_clearance(out, judge, constraint, limit);
        break;
    case CONUS_CONSTRAINT_LENGTH:
        out->value = judge->pose->far - judge->pose->near;
        break;
    case CONUS_CONSTRAINT_LEAN:
        out->value = vec3_angle(judge->shank->needle.direction, asked->direction);
        break;
    case CONUS_CONSTRAINT_APART:
        measure_apart(out, judge, constraint);
        break;
    case CONUS_CONSTRAINT_FIRST:
        measure_crossing(out, judge, constraint);
        break;
    case CONUS_CONSTRAINT_ENTRY_ANGLE:
        out->value = plan_entry_angle(judge->pose);
        break;
    case CONUS_CONSTRAINT_ARC:
    case CONUS_CONSTRAINT_SLIDER:
        out->value = measure_rig(judge, asked);
        break;
    }
    return CONUS_OK;
}

/* Slack and verdict; angles are radians here. */
static void decide(conus_verdict *out, const struct plan_constraint *constraint, double radius)
{
    const conus_constraint *asked = &constraint->asked;
    bool may_be_equal = true;
    switch (asked->kind) {
    case CONUS_CONSTRAINT_REACH:
        may_be_equal =
            asked->limit > 0 || asked->measure == CONUS_MEASURE_TIP || asked->measure == CONUS_MEASURE_CROSSED;
        out->slack = out->value - (asked->limit == 0 && may_be_equal ? 1 : asked->limit);
        break;
    case CONUS_CONSTRAINT_AVOID:
        may_be_equal = plan_is_of_cone(asked->measure);
        out->slack = may_be_equal ? asked->limit - out->value : out->value - radius - asked->limit;
        break;
    case CONUS_CONSTRAINT_ARC:
    case CONUS_CONSTRAINT_SLIDER:
    case CONUS_CONSTRAINT_LENGTH:
        out->slack = fmin(out->value - asked->limit, asked->most - out->value);
        out->slack = plan_is_of_rig(constraint) && fabs(out->slack) <= DEGREES ? 0 : out->slack;
        break;
    case CONUS_CONSTRAINT_LEAN:
    case CONUS_CONSTRAINT_ENTRY_ANGLE:
        out->slack = radians_from_degrees(asked->limit) - out->value;
        break;
    case CONUS_CONSTRAINT_APART:
        out->slack = out->value - asked->limit;
        may_be_equal = false;
        break;
    case CONUS_CONSTRAINT_FIRST:
        out->slack = out->value - 1;
        break;
    }
    out->holds = may_be_equal ? out->slack >= 0 : out->slack > AXIS_TOUCH;
}

/* Turns to the reach whose leeway is asked for. */
static conus_status ask_leeway(struct plan_judge *judge, const struct plan_constraint *constraint)
{
    double range[2];
    find_window(range, judge, constraint);
    judge->leeway.needle = judge->shank->needle;
    judge->leeway.needle.near = range[0];
    judge->leeway.needle.far = range[1];
    judge->leeway.contacts = constraint->asked.measure == CONUS_MEASURE_TIP ? (conus_contacts){.count = 1, .columns = 1}
                             /* at the far end */
                             : constraint->asked.measure == CONUS_MEASURE_CONTACTS ? constraint->asked.contacts
                                                                                   : (conus_contacts){0};
    judge->leeway.least = fmax(constraint->asked.limit, AXIS_TOUCH); /* so much is crossed, too */
    conus_status status = follow(judge);
    return status ? status : plan_leeway_ask(&judge->leeway, constraint, judge->selector->atlas, &judge->shank->layers);
}

static conus_status find_leeway(conus_verdict *out, struct plan_judge *judge, const struct plan_constraint *constraint)
{
    bool is_reach = constraint->asked.kind == CONUS_CONSTRAINT_REACH;
    out->leeway = !constraint->has_leeway ? NAN : !out->holds ? 0 : is_reach ? NAN : out->slack;
    if (!constraint->has_leeway || !out->holds || !is_reach) {
        return CONUS_OK;
    }
    conus_status status = ask_leeway(judge, constraint);
    return status ? status : plan_leeway_find(&out->leeway, &judge->leeway);
}

static conus_status judge_shank(conus_verdict *out, struct plan_judge *judge, const struct plan_constraint *constraint,
                                enum plan_care care)
{
    double radius = judge->selector->options.radius;
    double settled = (radius + constraint->asked.limit) * (1 + 1e-9) + 1e-9; /* mm: farther, the margin is kept */
    *out = (conus_verdict){.slack = NAN, .leeway = NAN, .depth = NAN, .p = NAN};
    int seen = care == PLAN_HOLDS ? look(judge, constraint) : 0;
    if (seen) {
        out->holds = seen > 0;
        return CONUS_OK;
    }
    conus_status status = measure(out, judge, constraint, care == PLAN_HOLDS ? settled : FAR);
    if (status) {
        return status;
    }
    decide(out, constraint, radius);
    if (plan_is_of_direction(constraint)) {
        out->value = degrees_from_radians(out->value);
        out->slack = degrees_from_radians(out->slack);
    }
    return care == PLAN_ALL ? find_leeway(out, judge, constraint) : CONUS_OK;
}

conus_status plan_judge(conus_verdict *out, struct plan_judge *judge, size_t index, enum plan_care care)
{
    const struct plan_constraint *constraint = &judge->constraints[index];
    bool any = constraint->any_shank;
    conus_status status = CONUS_OK;
    for (size_t i = constraint->shanks[0]; i < constraint->shanks[1]; i++) {
        judge->shank = &judge->shanks[i];
        conus_verdict verdict;
        bool is_first = i == constraint->shanks[0];
        status = judge_shank(&verdict, judge, constraint, care);
        if (status) {
            break;
        }
        double leeway = is_first ? verdict.leeway
                        : any    ? fmax(out->leeway, verdict.leeway)
                                 : fmin(out->leeway, verdict.leeway);
        bool counts = is_first || (care == PLAN_HOLDS ? verdict.holds == any
                                   : any              ? verdict.slack > out->slack
                                                      : verdict.slack < out->slack);
        if (counts) {
            *out = verdict;
            out->shank = (uint32_t)i + 1;
        }
        out->leeway = leeway;
        if (care == PLAN_HOLDS && out->holds == any) {
            break;
        }
    }
    return status;
}

static conus_status has_least(bool *out, struct plan_judge *judge, const struct plan_constraint *constraint,
                              enum plan_quantity quantity, double least)
{
    conus_status status = CONUS_OK;
    *out = true;
    if (plan_is_clearance(constraint)) {
        double radius = judge->selector->options.radius;
        double wanted = radius + (quantity == PLAN_CLEARANCE ? 0 : constraint->asked.limit) + least;
        conus_verdict verdict;
        int farther = judge->leeway.uses_maps ? look_farther(judge, constraint, wanted) : 0;
        *out = farther > 0;
        if (!farther) {
            measure_clearance(&verdict, judge, constraint, wanted);
            *out = verdict.value >= wanted;
        }
    } else if (quantity == PLAN_LEEWAY && constraint->has_leeway && constraint->asked.kind == CONUS_CONSTRAINT_REACH) {
        status = ask_leeway(judge, constraint);
        status = status ? status : plan_leeway_is(out, &judge->leeway, least);
    }
    return status;
}

conus_status plan_judge_least(bool *out, struct plan_judge *judge, size_t index, enum plan_quantity quantity,
                              double least)
{
    const struct plan_constraint *constraint = &judge->constraints[index];
    for (size_t i = constraint->shanks[0]; i < constraint->shanks[1]; i++) {
        judge->shank = &judge->shanks[i];
        conus_status status = has_least(out, judge, constraint, quantity, least);
        if (status || *out == constraint->any_shank) {
            return status;
        }
    }
    return CONUS_OK;
}

static conus_status guess_leeway(double *out, struct plan_judge *judge, const struct plan_constraint *constraint,
                                 double most)
{
    double radius = judge->selector->options.radius;
    conus_verdict verdict = {0};
    if (constraint->asked.kind == CONUS_CONSTRAINT_REACH) {
        conus_status status = ask_leeway(judge, constraint);
        return status ? status : plan_leeway_guess(out, &judge->leeway, most);
    }
    conus_status status = measure(&verdict, judge, constraint, radius + constraint->asked.limit + most);
    decide(&verdict, constraint, radius);
    *out = verdict.holds ? fmin(verdict.slack, most) : 0;
    return status;
}

conus_status plan_judge_leeway(double *out, struct plan_judge *judge, size_t index, double most)
{
    const struct plan_constraint *constraint = &judge->constraints[index];
    bool any = constraint->any_shank;
    conus_status status = CONUS_OK;
    *out = any ? 0 : most;
    for (size_t i = constraint->shanks[0]; i < constraint->shanks[1]; i++) {
        judge->shank = &judge->shanks[i];
        double leeway = 0;
        status = guess_leeway(&leeway, judge, constraint, any ? most : *out);
        *out = any ? fmax(*out, leeway) : leeway;
        if (status || *out == (any ? most : 0)) {
            break;
        }
    }
    return status;
}

conus_status plan_judge_contacts(uint32_t *out, struct plan_judge *judge, const struct plan_constraint *cover)
{
    uint32_t count = 0;
    for (size_t i = 0; i < judge->shank_count; i++) {
        conus_verdict verdict;
        judge->shank = &judge->shanks[i];
        conus_status status = follow(judge);
        if (status) {
            return status;
        }
        measure_contacts(&verdict, judge, cover);
        count += (uint32_t)verdict.value;
    }
    *out = count;
    return CONUS_OK;
}

double plan_judge_distance(struct plan_judge *judge, size_t index)
{
    const struct plan_constraint *constraint = &judge->constraints[index];
    bool is_avoid = constraint->asked.kind == CONUS_CONSTRAINT_AVOID;
    bool takes_farthest = constraint->any_shank == is_avoid;
    double distance = takes_farthest ? 0 : INFINITY;
    for (size_t i = constraint->shanks[0]; i < constraint->shanks[1]; i++) {
        judge->shank = &judge->shanks[i];
        conus_verdict verdict;
        measure_clearance(&verdict, judge, constraint, FAR);
        distance = takes_farthest ? fmax(distance, verdict.value) : fmin(distance, verdict.value);
    }
    return distance;
}
