/* SPDX-License-Identifier: BSD-3-Clause */
/* Answers the poses of a block with one selector, those of an engine that can trace many at once together. */
#include "selection/batch/batch.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/status.h"
#include "base/system/system.h"
#include "conus/own.h"
#include "selection/selection.h"

enum { THREAD_LIMIT = 1024, DEFAULT_BLOCK = 256, DEFAULT_ANGLE = 10 };

conus_status batch_check_options(uint32_t *threads, uint32_t *block, double *angle, const conus_selector *selector)
{
    if (*threads > THREAD_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "threads: %u, allowed is 1 to %d", *threads, THREAD_LIMIT);
    }
    if (*block > BATCH_BLOCK_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "block: %u, allowed is 1 to %d", *block, BATCH_BLOCK_LIMIT);
    }
    if (selector->ranking.info.needs_history) { /* each pose is answered on its own */
        return fail(CONUS_ERROR_ARGUMENT, "score: %s needs a history, which a batch does not have",
                    selector->ranking.formula.text);
    }
    if (!*threads) { /* as many as processors that the process may use: a job's share of a cluster's node, say */
        size_t count = system_processors();
        *threads = count > THREAD_LIMIT ? THREAD_LIMIT : (uint32_t)count;
    }
    *block = *block ? *block : DEFAULT_BLOCK;
    if (*angle == 0 && selector->options.radius == 0) {
        const conus_weight *weight = selector->options.weight;
        const double own = weight ? conus_weight_angle(weight) : NAN;
        *angle = isnan(own) ? DEFAULT_ANGLE : own;
    }
    return CONUS_OK;
}

conus_status batch_worker_init(struct batch_worker *out, conus_selector *selector, size_t block, double angle,
                               struct batch_points points)
{
    *out = (struct batch_worker){.angle = angle, .points = points, .at_once = selections_at_once(selector)};
    out->at_once = out->at_once < block ? out->at_once : block;
    (void)selector_prepare_box(selector); /* for all workers; an empty atlas has none */
    conus_status status = selector_share(&out->selector, selector);
    out->begun = status ? NULL : memory_zeroed(out->at_once, sizeof(conus_selection *));
    if (!out->begun) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    out->selector->inside_only = true;
    pose_check_init(&out->aims, out->selector);
    return CONUS_OK;
}

void batch_worker_finish(struct batch_worker *worker)
{
    conus_selector_destroy(worker->selector);
    memory_free((void *)worker->begun);
}

static double angle_of(const struct batch_worker *worker, const struct batch_pose *pose)
{
    return pose->angle != 0 ? pose->angle : worker->angle;
}

static double radius_of(const struct batch_worker *worker, const struct batch_pose *pose)
{
    return isnan(pose->radius) ? worker->points.radius : pose->radius;
}

/* A cone, or for a point what is at it or near it. */
static conus_status select_pose(conus_selection **out, struct batch_worker *worker, const struct batch_pose *pose)
{
    const struct batch_points *points = &worker->points;
    conus_status status = conus_selector_set_range(worker->selector, pose->range);
    if (status) {
        return status;
    }
    if (!pose->is_point) {
        return conus_select(out, worker->selector, &pose->pose, angle_of(worker, pose));
    }
    return points->error
               ? fail(CONUS_ERROR_ARGUMENT, "%s", points->error)
               : conus_select_ball(out, worker->selector, pose->pose.world_from_device + 12, radius_of(worker, pose));
}

/* A call of batch_worker_answer(). */
struct answering {
    struct batch_worker *worker;
    const struct batch_pose *poses;
    batch_take *take;
    void *user;
};

static conus_status answer_one(const struct answering *answering, size_t index)
{
    conus_selection *selection = NULL;
    const struct batch_pose *pose = &answering->poses[index];
    conus_status status = pose->is_no_pose ? CONUS_OK : select_pose(&selection, answering->worker, pose);
    if (status == CONUS_ERROR_ARGUMENT) { /* the pose's own fault */
        status = CONUS_OK;
    }
    status = status ? status : answering->take(answering->user, index, selection);
    conus_selection_destroy(selection);
    return status;
}

/* answer_one() for poses number `first` to first + count - 1, at most at_once of them. A pose without a selection is
 * answered again alone, so that conus_message() is of it. */
static conus_status answer_together(const struct answering *answering, size_t first, size_t count)
{
    struct batch_worker *worker = answering->worker;
    const struct batch_pose *poses = answering->poses + first;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        if (!poses[i].is_no_pose && !poses[i].is_point) {
            status = conus_selector_set_range(worker->selector, poses[i].range);
            status = status ? status
                            : selection_begin(&worker->begun[i], worker->selector, &poses[i].pose,
                                              angle_of(worker, &poses[i]));
            status = status == CONUS_ERROR_ARGUMENT ? CONUS_OK : status;
        }
    }
    status = status ? status : selections_trace(worker->begun, count, worker->selector);
    for (size_t i = 0; i < count; i++) {
        conus_selection *selection = worker->begun[i];
        if (selection && !status) {
            status = selection_complete(selection, worker->selector);
        }
        if (selection && !status) {
            selection_rank(selection, worker->selector, NULL);
            status = answering->take(answering->user, first + i, selection);
        } else if (!status) {
            status = answer_one(answering, first + i);
        }
        conus_selection_destroy(selection);
        worker->begun[i] = NULL;
    }
    return status;
}

static void count_aims(struct batch_worker *worker, const struct batch_pose *poses, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!poses[i].is_no_pose && !poses[i].is_point) {
            conus_pose_check_add(&worker->aims, poses[i].line, &poses[i].pose, angle_of(worker, &poses[i]));
        } else if (!poses[i].is_no_pose && !worker->points.error) {
            conus_pose_check_add_point(&worker->aims, poses[i].line, poses[i].pose.world_from_device + 12,
                                       radius_of(worker, &poses[i]));
        }
    }
}

conus_status batch_worker_answer(struct batch_worker *worker, const struct batch_pose *poses, size_t count,
                                 const atomic_bool *stop, batch_take *take, void *user)
{
    const struct answering answering = {worker, poses, take, user};
    conus_status status = CONUS_OK;
    for (size_t i = 0, together; i < count && !status && !atomic_load_explicit(stop, memory_order_relaxed);
         i += together) {
        together = count - i < worker->at_once ? count - i : worker->at_once;
        status = together == 1 ? answer_one(&answering, i) : answer_together(&answering, i, together);
    }
    if (!status) {
        count_aims(worker, poses, count);
    }
    return status;
}

conus_status batch_worker_answer_axes(struct batch_worker *worker, const struct batch_pose *poses, size_t count,
                                      const atomic_bool *stop, const double *within, batch_take_axis *take, void *user)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status && !atomic_load_explicit(stop, memory_order_relaxed); i++) {
        conus_table *table = NULL;
        if (poses[i].is_point) {
            status = fail(CONUS_ERROR_ARGUMENT, "a point, without the direction that an axis needs");
        } else if (!poses[i].is_no_pose) {
            status = conus_selector_set_range(worker->selector, poses[i].range);
            status = status   ? status
                     : within ? conus_clearance(&table, worker->selector, &poses[i].pose, *within)
                              : conus_segments(&table, worker->selector, &poses[i].pose);
        }
        status = status == CONUS_ERROR_ARGUMENT ? CONUS_OK : status; /* the pose's own fault */
        status = status ? status : take(user, i, table);
        conus_table_destroy(table);
    }
    if (!status) {
        count_aims(worker, poses, count);
        worker->aims.found.inside = (conus_pose_finding){0}; /* a shank may begin inside */
    }
    return status;
}
