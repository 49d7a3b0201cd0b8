/* SPDX-License-Identifier: BSD-3-Clause */
/* How probable it is that a pose holds its constraints when it is not exactly known (Eq. 14). */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "selection/plan/plan.h"

#include <math.h>

static const double ROUNDING = 1e-6; /* mm */

conus_status plan_jitter_init(struct plan_jitter *out, const conus_jitter_options *asked)
{
    if (!asked) {
        return CONUS_OK;
    }
    out->options = *options_of(conus_jitter_options, asked);
    conus_status status = jitter_check(&out->options);
    if (status) {
        return status;
    }
    out->errors = memory_raw(out->options.samples, sizeof *out->errors);
    for (uint32_t i = 0; out->errors && i < out->options.samples; i++) {
        jitter_sample(out->errors[i], i);
    }
    return out->errors ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* The pose with errors. It is never without a length. */
static void move(conus_planned *out, const conus_planned *pose, const struct plan_jitter *jitter, uint32_t index)
{
    *out = *pose;
    jitter_needle(&out->pose, &out->far, &pose->pose, &jitter->options, jitter->errors[index]);
    out->far = fmax(out->far, out->near + ROUNDING);
    out->entry_angle = isnan(pose->entry_angle) ? NAN : degrees_from_radians(plan_entry_angle(out));
}

/* By how many mm the points of the shanks are off at most, at equal depth: the most is at an end of one. */
static double most_off(const conus_planned *a, const conus_planned *b, const struct plan_judge *judge)
{
    double most = 0;
    for (size_t i = 0; i < 2 * judge->shank_count; i++) {
        const double *shank = judge->offsets[i / 2];
        const double at[4] = {shank[0], shank[1], i % 2 ? -a->far : -a->near, 1};
        double off[3] = {0};
        for (int k = 0; k < 4; k++) {
            vec3_add_scaled(off, off, at[k], b->pose.world_from_device + 4 * k);
            vec3_add_scaled(off, off, -at[k], a->pose.world_from_device + 4 * k);
        }
        most = fmax(most, vec3_length(off));
    }
    return a->far == b->far ? most + ROUNDING : INFINITY;
}

conus_status plan_jitter_ask(conus_planned *pose, conus_verdict *verdicts, struct plan_judge *judge, size_t count,
                             const struct plan_jitter *jitter, bool is_whole, double least, bool has_bounds)
{
    const uint32_t samples = jitter->options.samples;
    uint32_t broken = 0;
    conus_status status = CONUS_OK;
    for (size_t k = 0; k < count && is_whole; k++) {
        verdicts[k].p = 0;
    }
    for (uint32_t i = 0; i < samples && !status && samples - broken >= least * samples; i++) {
        conus_planned moved;
        bool holds_all = true;
        move(&moved, pose, jitter, i);
        plan_judge_turn(judge, &moved);
        double off = has_bounds ? most_off(pose, &moved, judge) : INFINITY;
        for (size_t k = 0; k < count && !status && (holds_all || is_whole); k++) {
            conus_verdict verdict = {.holds = verdicts[k].leeway > off};
            status = verdict.holds ? CONUS_OK : plan_judge(&verdict, judge, k, PLAN_HOLDS);
            holds_all = holds_all && verdict.holds;
            verdicts[k].p += is_whole && verdict.holds ? 1.0 / samples : 0; /* a power of two: exact */
        }
        broken += !holds_all;
    }
    pose->p_ok = (samples - broken) / (double)samples;
    return status;
}
