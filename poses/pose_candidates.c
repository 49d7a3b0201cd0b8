/* SPDX-License-Identifier: BSD-3-Clause */
/* Candidates by their number: which entry, which target, which tilt, which turn (Eq. 22). */
#include "poses/pose_stream.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>
#include <string.h>

static const double ROUNDING = 1e-9; /* of a quotient that may be a whole number */

static conus_status check_points(const double *points, size_t count, const char *what)
{
    for (size_t i = 0; i < count; i++) {
        const double *p = points + 3 * i;
        if (!vec3_is_finite(p)) {
            return fail(CONUS_ERROR_ARGUMENT, "%s %zu: %g,%g,%g, allowed are finite numbers", what, i + 1, p[0], p[1],
                        p[2]);
        }
    }
    return CONUS_OK;
}

static bool has_normal(double out[3], const conus_candidates *asked, size_t entry)
{
    return asked->normals && vec3_is_finite(asked->normals + 3 * entry) &&
           vec3_normalise(out, asked->normals + 3 * entry);
}

static conus_status check_angles(const conus_candidates *asked)
{
    bool are_finite = true;
    for (size_t i = 0; i < 2 * asked->entry_count; i++) {
        are_finite = are_finite && isfinite(asked->angles[i]);
    }
    return asked->entries || asked->normals || !asked->targets
               ? fail(CONUS_ERROR_ARGUMENT, "angles: targets go with them, and neither entries nor normals")
           : !are_finite ? fail(CONUS_ERROR_ARGUMENT, "angles: finite numbers are needed")
           : asked->back > 0 && asked->back <= 500
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "back: %g mm, allowed is a number above 0, up to 500", asked->back);
}

static conus_status check(const conus_candidates *asked)
{
    conus_status status =
        asked->angles ? check_angles(asked) : check_points(asked->entries, asked->entry_count, "entry");
    status = status ? status : check_points(asked->targets, asked->target_count, "target");
    if (status) {
        return status;
    }
    if (!asked->entry_count || (asked->targets && !asked->target_count)) {
        return fail(CONUS_ERROR_ARGUMENT, "no candidate: there is no %s", asked->entry_count ? "target" : "entry");
    }
    for (size_t i = 0; i < asked->entry_count && !asked->targets; i++) {
        double normal[3];
        if (!has_normal(normal, asked, i)) {
            return fail(CONUS_ERROR_ARGUMENT, "entry %zu has no normal, which is needed where there is no target",
                        i + 1);
        }
    }
    if (!asked->targets && asked->to_target) {
        return fail(CONUS_ERROR_ARGUMENT, "depth: up to a target, but there is none");
    }
    return isfinite(asked->beyond) ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "beyond: a finite number is needed");
}

static conus_status count_rings(struct pose_candidates *out)
{
    double most = out->asked.tilt_most;
    double step = out->asked.tilt_step;
    const double least = 0.01 * (1 - ROUNDING);
    bool fits = most == 0 || (most > 0 && most <= 90 && step >= least && step <= most);
    if (!fits || (most == 0 && step != 0)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "tilt: up to %g degrees in steps of %g, allowed are up to 90 in steps from 0.01 to that", most,
                    step);
    }
    out->ring_count = most > 0 ? (size_t)(most / step + ROUNDING) + 1 : 1;
    out->rings = memory_raw(out->ring_count + 1, sizeof *out->rings);
    if (!out->rings) {
        return CONUS_ERROR_MEMORY;
    }
    out->rings[0] = 0;
    out->rings[1] = 1;
    for (size_t i = 1; i < out->ring_count; i++) {
        const double ring = radians_from_degrees(step);
        const double size = ceil(2 * MATH3_PI * sin((double)i * ring) / ring - ROUNDING);
        out->rings[i + 1] = out->rings[i] + (uint64_t)fmax(1, size);
    }
    return CONUS_OK;
}

static conus_status count_rolls(struct pose_candidates *out)
{
    double step = out->asked.roll_step;
    if (step != 0 && !(step >= 0.01 && step <= 180)) {
        return fail(CONUS_ERROR_ARGUMENT, "roll: in steps of %g degrees, allowed are 0.01 to 180", step);
    }
    out->rolls = step > 0 ? (uint64_t)ceil(2 * MATH3_PI / radians_from_degrees(step) - ROUNDING) : 1;
    return CONUS_OK;
}

conus_status pose_candidates_init(struct pose_candidates *out, const conus_candidates *asked)
{
    out->asked = *options_of(conus_candidates, asked);
    out->asked.target_count = out->asked.targets ? out->asked.target_count : 0;
    out->frame = out->asked.frame ? *out->asked.frame : (conus_frame){.space = CONUS_SPACE_RAS};
    conus_status status = check(&out->asked);
    status = status ? status : count_rings(out);
    status = status ? status : count_rolls(out);
    if (status) {
        return status;
    }
    uint64_t targets = out->asked.targets ? out->asked.target_count : 1;
    uint64_t tilts = out->rings[out->ring_count];
    double count = (double)out->asked.entry_count * (double)targets * (double)tilts * (double)out->rolls;
    if (count > (double)CONUS_CANDIDATE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "%zu entries, %zu targets, %zu tilts and %zu turns are %.3g candidates, allowed are %.3g",
                    out->asked.entry_count, (size_t)targets, (size_t)tilts, (size_t)out->rolls, count,
                    (double)CONUS_CANDIDATE_LIMIT);
    }
    out->count = out->asked.entry_count * targets * tilts * out->rolls;
    return CONUS_OK;
}

void pose_candidates_finish(struct pose_candidates *candidates)
{
    memory_free(candidates->rings);
}

/* Turns the pose to tilt `number` of its direction. */
static conus_status tilt_pose(conus_pose *pose, const struct pose_candidates *candidates, uint64_t number)
{
    size_t ring = 0; /* the last that begins at or before it */
    for (size_t above = candidates->ring_count; above - ring > 1;) {
        size_t middle = ring + (above - ring) / 2;
        *(candidates->rings[middle] <= number ? &ring : &above) = middle;
    }
    if (!ring) {
        return CONUS_OK;
    }
    uint64_t first = candidates->rings[ring];
    double tilt = (double)ring * radians_from_degrees(candidates->asked.tilt_step);
    double turn = 2 * MATH3_PI * (double)(number - first) / (double)(candidates->rings[ring + 1] - first);
    const double *m = pose->world_from_device;
    double direction[3];
    for (int a = 0; a < 3; a++) {
        direction[a] = sin(tilt) * (cos(turn) * m[4 + a] + sin(turn) * m[a]) - cos(tilt) * m[8 + a];
    }
    conus_status status = conus_pose_along(pose, m + 12, direction, NULL);
    if (!status) {
        conus_frame_turn_pose(pose, &candidates->frame, false);
    }
    return status;
}

/* Writes "e412-t77", or names: leaves out parts that can only be 1, but not all of them. */
static void write_id(char out[POSE_CANDIDATE_ID], const struct pose_candidates *candidates, const uint64_t numbers[4])
{
    const uint64_t counts[4] = {candidates->asked.entry_count, candidates->asked.target_count,
                                candidates->rings[candidates->ring_count], candidates->rolls};
    const char *const *const names[4] = {candidates->asked.entry_names, candidates->asked.target_names};
    size_t size = 0;
    for (size_t i = 0; i < 4; i++) {
        bool is_part = counts[i] > 1 || (i == 0 && candidates->count == 1);
        if (is_part && names[i]) {
            size += (size_t)snprintf(out + size, POSE_CANDIDATE_ID - size, "%s%.64s", size ? "-" : "",
                                     names[i][numbers[i] - 1]);
        } else if (is_part) {
            size += (size_t)snprintf(out + size, POSE_CANDIDATE_ID - size, "%s%c%llu", size ? "-" : "", "etkr"[i],
                                     (unsigned long long)numbers[i]);
        }
    }
}

/* Where the device is for an entry and a target. */
static void find_entry(double out[3], const struct pose_candidates *candidates, size_t entry, const double *target)
{
    const conus_candidates *asked = &candidates->asked;
    if (!asked->angles) {
        memcpy(out, asked->entries + 3 * entry, 3 * sizeof *out);
        return;
    }
    double arc = radians_from_degrees(asked->angles[2 * entry]);
    double slider = radians_from_degrees(asked->angles[2 * entry + 1]);
    double way[3];
    direction_from_anatomical(way, (const double[]){sin(slider), cos(slider) * sin(arc), cos(slider) * cos(arc)},
                              &candidates->frame);
    (void)vec3_normalise(way, way);
    vec3_add_scaled(out, target, asked->back, way);
}

conus_status pose_candidates_row(conus_pose_row *out, char id[POSE_CANDIDATE_ID],
                                 const struct pose_candidates *candidates, uint64_t index)
{
    const conus_candidates *asked = &candidates->asked;
    uint64_t tilts = candidates->rings[candidates->ring_count];
    uint64_t tilt = index / candidates->rolls;
    uint64_t pair = tilt / tilts;
    uint64_t targets = asked->targets ? asked->target_count : 1;
    const uint64_t numbers[4] = {pair / targets + 1, pair % targets + 1, tilt % tilts + 1,
                                 index % candidates->rolls + 1};
    double entry[3];
    const double *target = asked->targets ? asked->targets + 3 * (numbers[1] - 1) : NULL;
    double inward[3];
    find_entry(entry, candidates, (size_t)numbers[0] - 1, target);
    *out = pose_row_at((size_t)index + 1);
    out->entry = numbers[0];
    out->target = target ? numbers[1] : 0;
    if (has_normal(out->normal, asked, (size_t)numbers[0] - 1)) {
        vec3_scale(inward, out->normal, -1);
    }
    write_id(id, candidates, numbers);
    conus_status status =
        target ? conus_pose_toward(&out->pose, entry, target, NULL) : conus_pose_along(&out->pose, entry, inward, NULL);
    if (!status) {
        conus_frame_turn_pose(&out->pose, &candidates->frame, false);
    }
    if (!status && target && asked->to_target) {
        double way[3];
        vec3_sub(way, target, entry);
        out->range[1] = vec3_length(way) + asked->beyond;
    }
    status = status ? status : tilt_pose(&out->pose, candidates, numbers[2] - 1);
    double turn = 2 * MATH3_PI * (double)(numbers[3] - 1) / (double)candidates->rolls;
    return status ? status : pose_roll(&out->pose, turn);
}
