/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a plan, and keeps what a list of it shows. */
#include "conus/own.h"
#include "viewer/model/study.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *plan_nearest(const conus_plan *plan, const conus_atlas *atlas, const conus_planned *planned, size_t index)
{
    const conus_object *object = conus_atlas_object(atlas, planned->verdicts[index].object);
    const char *name = conus_plan_name(plan, index);
    return object ? object->name : name ? name : "";
}

static void take_row(struct plan_row *out, const conus_plan *plan, const conus_atlas *atlas,
                     const conus_planned *planned)
{
    *out = (struct plan_row){.pose = planned->pose,
                             .range = {planned->near, planned->far},
                             .angle = planned->angle,
                             .leeway = planned->leeway,
                             .breaks = !planned->feasible,
                             .clearance = planned->clearance};
    conus_frame_turn_pose(&out->pose, &(conus_frame){.space = CONUS_SPACE_RAS}, true); /* as a tool has it */
    snprintf(out->id, sizeof out->id, "%s", planned->id);
    if (!planned->feasible) { /* the broken constraint, if it is a clearance */
        const conus_constraint *asked = conus_plan_constraint(plan, planned->broken);
        bool is_clearance = asked->kind == CONUS_CONSTRAINT_AVOID && !asked->measure;
        out->clearance = is_clearance ? planned->verdicts[planned->broken].slack + asked->limit : NAN;
        snprintf(out->nearest, sizeof out->nearest, "breaks %s", plan_nearest(plan, atlas, planned, planned->broken));
    } else if (planned->clearance_of != SIZE_MAX) {
        snprintf(out->nearest, sizeof out->nearest, "%s", plan_nearest(plan, atlas, planned, planned->clearance_of));
    }
}

/* "3 of 4 poses hold all constraints" */
static void say(char out[PLAN_SAYS], const conus_plan *plan, size_t misses)
{
    uint64_t rejected = conus_plan_rejected(plan).count;
    uint64_t holds = conus_plan_left(plan, conus_plan_constraint_count(plan));
    int used = snprintf(out, PLAN_SAYS, "%llu of %llu poses %s all constraints%s", (unsigned long long)holds,
                        (unsigned long long)conus_plan_left(plan, 0), holds == 1 ? "holds" : "hold",
                        misses ? "; the nearest misses:" : "");
    if (holds > conus_plan_count(plan)) {
        used += snprintf(out + used, PLAN_SAYS - (size_t)used, "; the best %zu are listed", conus_plan_count(plan));
    }
    if (rejected) {
        snprintf(out + used, PLAN_SAYS - (size_t)used, "; %llu rows are no poses", (unsigned long long)rejected);
    }
}

/* The poses that hold all constraints; where none does, those that break one, each another one, by the least. */
static conus_status take_rows(struct plan_list *out, const conus_plan *plan, const conus_atlas *atlas)
{
    size_t listed = conus_plan_count(plan);
    size_t constraints = conus_plan_constraint_count(plan);
    out->rows = calloc(listed + constraints, sizeof *out->rows);
    for (size_t i = 0; i < listed + constraints && out->rows; i++) {
        const conus_planned *planned = i < listed ? conus_plan_pose(plan, i) : conus_plan_miss(plan, i - listed);
        if (planned) {
            take_row(&out->rows[out->count++], plan, atlas, planned);
        }
    }
    say(out->says, plan, out->count - listed);
    return out->rows ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status write_text(struct plan_list *out, conus_plan *plan, const conus_selector *selector,
                               const conus_frame *frame)
{
    const conus_report_options options = {.rows = "plan", .format = "tsv", .frame = frame, .no_voxels = true};
    conus_report *report = NULL;
    const char *text;
    size_t size;
    conus_status status = conus_report_create(&report, selector, &options);
    status = status ? status : conus_report_add_plan(report, plan);
    status = status ? status : conus_report_text(&text, &size, report);
    out->text = status ? NULL : strdup(text);
    conus_report_destroy(report);
    return status || out->text ? status : CONUS_ERROR_MEMORY;
}

conus_status plan_list_fill(struct plan_list *out, const struct plan_task *task, conus_selector *selector,
                            const conus_atlas *atlas, const conus_frame *frame, conus_progress progress, void *user)
{
    const struct constraints *asked = &task->constraints;
    const conus_plan_options options = {
        .shanks = asked->shanks, .shank_count = asked->shank_count, .progress = progress, .progress_user = user};
    const conus_pose_options pose_options = {.frame = frame};
    conus_plan *plan = NULL;
    conus_pose_stream *stream = NULL;
    conus_status status = conus_plan_create(&plan, selector, asked->items, asked->count, &options);
    status = status ? status : conus_pose_stream_open(&stream, task->poses, &pose_options);
    status = status ? status : conus_pose_stream_match(stream, atlas);
    status = status ? status : conus_plan_run(plan, stream, UINT64_MAX);
    status = status ? status : take_rows(out, plan, atlas);
    status = status ? status : write_text(out, plan, selector, frame);
    conus_pose_stream_destroy(stream);
    conus_plan_destroy(plan);
    return status;
}
