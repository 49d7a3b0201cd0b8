/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries a pose: by as much as decides whether it is kept. */
#include "selection/plan/plan.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <string.h>

conus_status plan_bar_init(struct plan_bar *out, const struct plan_asked *asked)
{
    out->keys = memory_zeroed(asked->order.rank_count, sizeof *out->keys);
    out->misses = memory_raw(asked->count, sizeof *out->misses);
    for (size_t i = 0; out->misses && i < asked->count; i++) {
        out->misses[i] = INFINITY;
    }
    return out->keys && out->misses ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void plan_bar_finish(struct plan_bar *bar)
{
    memory_free(bar->keys);
    memory_free(bar->misses);
}

void plan_bar_copy(struct plan_bar *to, const struct plan_bar *from, const struct plan_asked *asked)
{
    double *const own[] = {to->keys, to->misses};
    *to = *from;
    to->keys = memcpy(own[0], from->keys, asked->order.rank_count * sizeof *to->keys);
    to->misses = memcpy(own[1], from->misses, asked->count * sizeof *to->misses);
}

const char *plan_trial_begin(conus_planned *out, const conus_pose_row *row, const struct plan_asked *asked)
{
    const double *range = asked->selector->options.range;
    if (row->error || row->is_point) {
        return row->error ? row->error
                          : "a point, without the direction that a needle needs; points may be entries (--from)";
    }
    bool has_angle = row->angle != 0 && asked->selector->options.radius == 0;
    bool has_normal = vec3_dot(row->normal, row->normal) > 0;
    *out = (conus_planned){.pose = row->pose,
                           .near = isnan(row->range[0]) ? range[0] : row->range[0],
                           .far = !isnan(row->range[1])    ? row->range[1]
                                  : asked->options.far > 0 ? asked->options.far
                                                           : range[1],
                           .angle = has_angle ? row->angle : asked->options.angle,
                           .has_angle = has_angle,
                           .entry = row->entry,
                           .target = row->target,
                           .p_ok = NAN};
    memcpy(out->normal, row->normal, sizeof out->normal);
    out->entry_angle = has_normal ? degrees_from_radians(plan_entry_angle(out)) : NAN;
    if (has_angle && pose_check_angle(row->angle)) {
        return conus_message();
    }
    for (size_t i = 0; i < asked->count && !has_normal; i++) {
        if (asked->constraints[i].asked.kind == CONUS_CONSTRAINT_ENTRY_ANGLE) {
            return "no normal at its entry, which the entry angle needs";
        }
    }
    return out->far == 0 ? "no far end: a column far is needed, or a depth or a range of all poses"
           : !(out->near >= 0 && out->far > out->near && isfinite(out->far)) ? "its far end is not beyond its near end"
                                                                             : NULL;
}

/* The least of all verdicts, and the keys. */
static void summarise(struct plan_trial *trial, const struct plan_asked *asked)
{
    conus_planned *planned = &trial->planned;
    double radius = asked->selector->options.radius;
    planned->leeway = planned->slack = planned->clearance = NAN;
    planned->leeway_of = planned->clearance_of = SIZE_MAX;
    for (size_t i = 0; i < asked->count; i++) {
        const conus_verdict *verdict = &trial->verdicts[i];
        if (!isnan(verdict->leeway) && !(verdict->leeway >= planned->leeway)) {
            planned->leeway = verdict->leeway;
            planned->leeway_of = i;
        }
        if (plan_is_clearance(&asked->constraints[i])) {
            planned->slack = fmin(planned->slack, verdict->slack);
            if (!(verdict->value - radius >= planned->clearance)) {
                planned->clearance = verdict->value - radius;
                planned->clearance_of = i;
            }
        }
    }
    plan_order_keys(trial->keys, planned, &asked->order);
}

conus_status plan_trial_measure(struct plan_trial *trial, struct plan_judge *judge, const struct plan_asked *asked,
                                enum plan_care care)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < asked->count && !status; i++) {
        status = plan_judge(&trial->verdicts[i], judge, i, care);
    }
    if (!status) {
        summarise(trial, asked);
        trial->is_measured = care == PLAN_ALL;
    }
    return status;
}

/* Adds the key of probability, or that it is below `least`. */
static conus_status add_chance(struct plan_trial *trial, struct plan_worker *worker, const struct plan_asked *asked,
                               double least)
{
    conus_status status = plan_jitter_ask(&trial->planned, trial->verdicts, &worker->judge, asked->count,
                                          &asked->jitter, false, least, !asked->measures_all);
    plan_order_keys(trial->keys, &trial->planned, &asked->order);
    return status;
}

/* Whether all constraints have so much: clearances, which are cheaper, are asked first. */
static conus_status have_least(bool *out, struct plan_worker *worker, const struct plan_asked *asked,
                               enum plan_quantity quantity, double least)
{
    conus_status status = CONUS_OK;
    for (int of_clearance = 1; of_clearance >= 0; of_clearance--) {
        for (size_t i = 0; i < asked->count && *out && !status; i++) {
            if (plan_is_clearance(&asked->constraints[i]) == of_clearance) {
                status = plan_judge_least(out, &worker->judge, i, quantity, least);
            }
        }
    }
    return status;
}

/* Whether a feasible pose may be better than its bar: it is measured no more than that takes. What a
 * pose before it has for its keys is enough to be before it. */
static conus_status may_enter(bool *out, struct plan_trial *trial, struct plan_worker *worker,
                              const struct plan_asked *asked)
{
    const struct plan_key *first = &asked->order.rank[0];
    enum plan_quantity quantity = asked->order.names[first->name].quantity;
    conus_status status = CONUS_OK;
    *out = true;
    if (!trial->has_bar) {
        return CONUS_OK;
    }
    double least = trial->bar[0] * (first->step > 0 ? first->step : 1); /* less what nine digits may hide */
    least -= 1e-8 * fabs(least) + 1e-9 + (asked->order.in_nanometres ? first->step / 2 : 0);
    bool has_least = !first->smaller && least > 0 && quantity <= PLAN_CHANCE;
    if (has_least && quantity < PLAN_CHANCE) {
        trial->most = least;
        status = have_least(out, worker, asked, quantity, least);
    }
    if (*out && !status) {
        status = plan_trial_measure(trial, &worker->judge, asked, asked->order.needs_leeway ? PLAN_ALL : PLAN_SLACKS);
        if (!status && asked->order.needs_chance &&
            plan_keys_compare(trial->keys, trial->bar, asked->order.sure_count) >= 0) {
            status = add_chance(trial, worker, asked, has_least && quantity == PLAN_CHANCE ? least : 0);
        }
        *out = plan_keys_compare(trial->keys, trial->bar, asked->order.rank_count) > 0;
        trial->is_measured = trial->is_measured && (*out || !asked->order.needs_chance);
    }
    return status;
}

conus_status plan_trial_try(struct plan_trial *trial, struct plan_worker *worker, const struct plan_asked *asked)
{
    size_t breaks = 0;
    size_t enough = worker->bar.has_feasible ? 1 : 2; /* a miss breaks one constraint */
    enough = asked->measures_all ? SIZE_MAX : enough;
    conus_status status = CONUS_OK;
    trial->planned.broken = SIZE_MAX;
    trial->is_measured = false;
    plan_judge_turn(&worker->judge, &trial->planned);
    for (size_t i = 0; i < asked->count && breaks < enough && !status; i++) {
        status = plan_judge(&trial->verdicts[i], &worker->judge, i, PLAN_HOLDS);
        if (!trial->verdicts[i].holds && breaks++ == 0) {
            trial->planned.broken = i;
        }
    }
    trial->planned.feasible = !breaks;
    trial->is_lone = breaks == 1 && enough > 1;
    bool is_wanted = asked->measures_all;
    if (!status && !is_wanted && trial->planned.feasible) {
        status = may_enter(&is_wanted, trial, worker, asked);
    } else if (!status && !is_wanted) {
        is_wanted = asked->options.infeasible && worker->bar.infeasible < asked->options.top;
    }
    if (!status && !is_wanted && trial->is_lone) {
        conus_verdict *broken = &trial->verdicts[trial->planned.broken];
        status = plan_judge(broken, &worker->judge, trial->planned.broken, PLAN_SLACKS);
        is_wanted = -broken->slack < worker->bar.misses[trial->planned.broken];
    }
    if (status || !is_wanted) {
        return status;
    }
    status = trial->is_measured ? CONUS_OK : plan_trial_measure(trial, &worker->judge, asked, PLAN_ALL);
    bool is_due = asked->order.needs_chance && trial->planned.feasible && isnan(trial->planned.p_ok);
    return status || !is_due ? status : add_chance(trial, worker, asked, 0);
}

conus_status plan_trial_again(struct plan_trial *trial, struct plan_worker *worker, const struct plan_asked *asked)
{
    bool is_wanted;
    if (trial->is_measured) {
        plan_order_keys(trial->keys, &trial->planned, &asked->order);
        return CONUS_OK;
    }
    plan_judge_turn(&worker->judge, &trial->planned);
    return may_enter(&is_wanted, trial, worker, asked);
}
