/* SPDX-License-Identifier: BSD-3-Clause */
/* A batch: blocks of poses are read from a stream, answered by threads as rows of text, and delivered in order. */
#include "selection/batch/batch.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "poses/pose_stream.h"
#include "poses/rows/pose_row.h"
#include "selection/report/report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { ROWS_AT_ONCE = 64 };

struct block {
    struct batch_pose *poses; /* [capacity] */
    struct pose_words {
        size_t id;                          /* where in the block's strings the pose's id begins, */
        size_t error;                       /* and the reason, if it is no pose */
        size_t probe;                       /* and of a contact the name of its probe */
        const conus_probe_contact *contact; /* NULL = it is none */
        uint64_t number;                    /* of the row in the stream, from 1 */
        double time_s;
        size_t kept;   /* where its texts that are kept begin, one behind the other, */
        bool has_kept; /* if there are some */
    } * words;         /* [capacity] */
    size_t count, capacity;
    size_t rows;           /* of the stream: as many as poses, or fewer that place a probe each */
    size_t kept_count;     /* texts of a row that are kept */
    uint64_t first;        /* number of the first one in the stream, from 0 */
    struct buffer strings; /* with a NUL behind each */
    struct buffer text;    /* the rows */
    uint64_t errors;
    uint64_t error_line; /* of the first of these, */
    char error[512];     /* and why it has no answer */
};

/* The workers of one atlas. */
struct batch_atlas {
    struct batch_worker *workers; /* [threads] */
    conus_report **reports;       /* [threads]; those of the first atlas join the others' */
};

struct conus_batch {
    conus_batch_options options; /* defaults filled in */
    enum report_rows kind;       /* what the names of its report mean */
    const conus_format_info *format;
    conus_frame frame;           /* that of options.report, where it has one */
    conus_row_marks *marks;      /* [threads] those of options.report, for each thread; NULL = none */
    const char **texts;          /* [threads * the marks' count] their texts */
    struct batch_atlas *atlases; /* [atlas_count] */
    size_t atlas_count, atlas_capacity;
    struct block *blocks; /* [block_count], the slots of the ring */
    size_t block_count;
    size_t rows_at_once; /* of the stream, in a block */
    struct buffer header;
};

static void finish_atlas(struct batch_atlas *atlas, size_t threads)
{
    for (size_t i = 0; atlas->reports && i < threads; i++) {
        conus_report_destroy(atlas->reports[i]);
    }
    for (size_t i = 0; atlas->workers && i < threads; i++) {
        batch_worker_finish(&atlas->workers[i]);
    }
    memory_free((void *)atlas->reports);
    memory_free(atlas->workers);
}

/* Appends an atlas. */
static conus_status add_atlas(conus_batch *batch, conus_selector *selector, const conus_report_options *report)
{
    const conus_batch_options *options = &batch->options;
    struct batch_atlas atlas = {.workers = memory_zeroed(options->threads, sizeof *atlas.workers),
                                .reports = memory_zeroed(options->threads, sizeof(conus_report *))};
    bool fits = memory_reserve(&batch->atlases, &batch->atlas_capacity, batch->atlas_count + 1, sizeof *batch->atlases);
    double radius = selector->options.radius; /* of other programs' formats most have no place for what is only near */
    bool has_axes = report_is_of_axes(batch->kind) || batch->format->is_of_probe;
    conus_status status = fits && atlas.workers && atlas.reports ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status || !has_axes              ? status
             : batch->kind == ROWS_CLEARANCES ? selector_prepare_clearance(selector)
                                              : selector_prepare_axis(selector);
    for (uint32_t i = 0; i < options->threads && !status; i++) {
        conus_report_options own = *report;
        own.marks = batch->marks ? &batch->marks[i] : NULL;
        status = batch_worker_init(
            &atlas.workers[i], selector, options->block, options->angle,
            (struct batch_points){batch->format->is_foreign ? fmax(radius, CONUS_POINT_RADIUS) : radius,
                                  options->point_error});
        status = status ? status : conus_report_create(&atlas.reports[i], atlas.workers[i].selector, &own);
        if (!status) {
            atlas.reports[i]->options.no_voxels = true;
            atlas.workers[i].selector->frame = atlas.reports[i]->frame;
        }
    }
    for (uint32_t i = 0; i < options->threads && batch->atlas_count && !status; i++) {
        status = conus_report_join(batch->atlases[0].reports[i], atlas.reports[i]); /* all can, or the first cannot */
    }
    if (status) {
        finish_atlas(&atlas, options->threads);
    } else {
        batch->atlases[batch->atlas_count++] = atlas;
    }
    return status;
}

conus_status conus_batch_create(conus_batch **out, conus_selector *selector, const conus_batch_options *options)
{
    conus_batch_options filled = *options_of(conus_batch_options, options);
    enum report_rows kind;
    enum report_number as;
    conus_status status = report_rows_find(&kind, filled.report.rows);
    status = status ? status : report_format_find(&as, filled.report.format);
    if (status) {
        return status;
    }
    const conus_format_info *format = conus_format_at(as);
    if (!format->of_batch && !format->is_foreign) {
        return fail(CONUS_ERROR_ARGUMENT, "format: tables for people and JSON hold all answers at once, no batch");
    }
    if (filled.report.probe && (conus_probe_count(filled.report.probe) != 1 || format->is_foreign ||
                                !isfinite(filled.report.roll) || !(filled.report.depth >= 0))) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "probe: a batch places one, in rows of its own, turned by a number of degrees "
                    "and 0 mm or more deep");
    }
    status = batch_check_options(&filled.threads, &filled.block, &filled.angle, selector);
    if (format->is_of_probe) {
        filled.threads = 1;
        filled.block = BATCH_BLOCK_LIMIT;
    }
    if (status) {
        return status;
    }
    size_t contacts = filled.report.probe ? conus_probe_contact_count(filled.report.probe) : 1;
    size_t rows = filled.block > contacts ? filled.block / contacts : 1;
    if (rows * contacts > UINT32_MAX) {
        return fail(CONUS_ERROR_ARGUMENT, "probe: %zu contacts are too many for a batch", contacts);
    }
    filled.block = (uint32_t)(rows * contacts);
    conus_batch *batch = memory_zeroed(1, sizeof *batch);
    if (!batch) {
        return CONUS_ERROR_MEMORY;
    }
    batch->options = filled;
    batch->kind = kind;
    batch->format = format;
    batch->rows_at_once = rows;
    if (filled.report.frame) { /* the caller's may end */
        batch->frame = *filled.report.frame;
        batch->options.report.frame = &batch->frame;
    }
    const conus_row_marks *marks = filled.report.marks;
    if (marks) {
        batch->marks = memory_raw(filled.threads, sizeof *batch->marks);
        batch->texts = memory_zeroed(filled.threads * marks->count, sizeof *batch->texts);
        status = batch->marks && batch->texts ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; marks && !status && i < filled.threads; i++) {
        batch->marks[i] = *marks;
        batch->marks[i].texts = batch->texts + i * batch->marks[i].count;
    }
    batch->block_count = ring_slots(filled.threads);
    batch->blocks = memory_zeroed(batch->block_count, sizeof *batch->blocks);
    status = status ? status : batch->blocks ? add_atlas(batch, selector, &batch->options.report) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < batch->block_count && !status; i++) {
        struct block *block = &batch->blocks[i];
        *block = (struct block){.poses = memory_raw(filled.block, sizeof *block->poses),
                                .words = memory_raw(filled.block, sizeof *block->words),
                                .capacity = filled.block,
                                .kept_count = marks ? marks->count : 0};
        status = block->poses && block->words ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (!status) {
        report_write_header(&batch->header, batch->atlases[0].reports[0]);
        status = buffer_status(&batch->header);
    }
    if (status) {
        conus_batch_destroy(batch);
        return status;
    }
    *out = batch;
    return CONUS_OK;
}

conus_status conus_batch_add(conus_batch *batch, conus_selector *selector, const char *atlas)
{
    conus_batch_options own = batch->options;
    conus_status status = batch_check_options(&own.threads, &own.block, &own.angle, selector);
    own.report.atlas = atlas;
    return status ? status : add_atlas(batch, selector, &own.report);
}

void conus_batch_destroy(conus_batch *batch)
{
    if (!batch) {
        return;
    }
    for (size_t i = 0; i < batch->atlas_count; i++) {
        finish_atlas(&batch->atlases[i], batch->options.threads);
    }
    for (size_t i = 0; batch->blocks && i < batch->block_count; i++) {
        memory_free(batch->blocks[i].poses);
        memory_free(batch->blocks[i].words);
        buffer_finish(&batch->blocks[i].strings);
        buffer_finish(&batch->blocks[i].text);
    }
    memory_free(batch->atlases);
    memory_free(batch->blocks);
    memory_free(batch->marks);
    memory_free((void *)batch->texts);
    buffer_finish(&batch->header);
    memory_free(batch);
}

uint32_t conus_batch_threads(const conus_batch *batch)
{
    return batch ? batch->options.threads : 0;
}

conus_pose_findings conus_batch_findings(const conus_batch *batch, size_t index)
{
    conus_pose_findings sum = {0};
    for (size_t i = 0; index < batch->atlas_count && i < batch->options.threads; i++) {
        pose_check_merge(&sum, &batch->atlases[index].workers[i].aims.found);
    }
    return sum;
}

const char *conus_batch_header(const conus_batch *batch)
{
    return batch && batch->header.data ? batch->header.data : "";
}

conus_status conus_batch_sidecar(const char **text, size_t *size, conus_batch *batch)
{
    return conus_report_sidecar(text, size, batch->atlases[0].reports[0]);
}

struct run {
    conus_batch *batch;
    conus_pose_stream *poses;
    uint64_t left; /* poses still to be read */
    conus_batch_sink sink;
    void *user;
};

static size_t keep_string(struct block *block, const char *string)
{
    size_t at = block->strings.size;
    buffer_append(&block->strings, string, strlen(string) + 1);
    return at;
}

static struct pose_words *add_pose(struct block *block, const conus_pose_row *row, struct batch_pose pose)
{
    struct pose_words *words = &block->words[block->count];
    block->poses[block->count++] = pose;
    *words = (struct pose_words){.number = block->first + block->rows, .time_s = row->error ? NAN : row->time_s};
    words->id = keep_string(block, row->id);
    words->has_kept = row->kept;
    words->kept = block->strings.size;
    for (size_t i = 0; row->kept && i < block->kept_count; i++) {
        keep_string(block, row->kept[i]);
    }
    return words;
}

static void add_row(struct block *block, const conus_pose_row *row, const char *error, bool is_foreign)
{
    struct batch_pose pose = {.line = row->line, .is_no_pose = error != NULL, .is_point = row->is_point};
    if (!error) {
        pose.pose = row->pose;
        pose.angle = row->angle;
        memcpy(pose.range, row->range, sizeof pose.range);
        pose.radius = is_foreign && row->radius == 0 ? CONUS_POINT_RADIUS : row->radius;
    }
    struct pose_words *words = add_pose(block, row, pose);
    words->error = error ? keep_string(block, error) : 0;
}

/* Adds the contacts of a probe that the row places. */
static conus_status add_contacts(struct block *block, const conus_pose_row *row, const conus_report_options *report)
{
    conus_pose placed = row->pose;
    double *m = placed.world_from_device;
    double depth = row->range[1] >= 0 ? row->range[1] : report->depth;
    for (int a = 0; a < 3; a++) {
        m[12 + a] -= depth * m[8 + a];
    }
    conus_status status = pose_roll(&placed, radians_from_degrees(report->roll));
    for (size_t i = 0; i < conus_probe_contact_count(report->probe) && !status; i++) {
        const conus_probe_contact *contact = conus_probe_at(report->probe, i);
        struct batch_pose pose = {.line = row->line, .is_point = true, .range = {NAN, NAN}, .radius = NAN};
        double point[3];
        mat4_point(point, m, contact->offset);
        status = pose_of_point(&pose.pose, point);
        struct pose_words *words = add_pose(block, row, pose);
        words->probe = words->id;
        words->contact = contact;
        words->id = block->strings.size;
        buffer_format(&block->strings, "%s:%s", row->id, contact->id);
        buffer_append(&block->strings, "", 1);
    }
    return status;
}

/* Fills the block with the next rows, `limit` at most. */
static conus_status read_poses(struct block *block, const conus_batch *batch, conus_pose_stream *poses, uint64_t limit)
{
    conus_pose_row rows[ROWS_AT_ONCE];
    size_t wanted = limit < batch->rows_at_once ? (size_t)limit : batch->rows_at_once;
    const conus_report_options *report = &batch->options.report;
    block->count = 0;
    block->rows = 0;
    block->errors = 0;
    block->first = pose_stream_position(poses);
    buffer_clear(&block->strings);
    buffer_clear(&block->text);
    while (block->rows < wanted) {
        size_t missing = wanted - block->rows;
        size_t count = 0;
        conus_status status =
            conus_pose_stream_read(rows, &count, poses, missing < ROWS_AT_ONCE ? missing : ROWS_AT_ONCE);
        for (size_t i = 0; i < count && !status; i++) {
            bool has_probe = report->probe && !rows[i].error;
            block->rows++;
            if (has_probe && !rows[i].is_point) {
                status = add_contacts(block, &rows[i], report);
            } else {
                add_row(block, &rows[i],
                        has_probe ? "a point, without the direction that a probe needs" : rows[i].error,
                        batch->format->is_foreign);
            }
        }
        if (status || count == 0) {
            return status;
        }
    }
    return buffer_status(&block->strings);
}

static conus_status read_block(void *user, size_t slot, bool *may_follow)
{
    struct run *run = user;
    const conus_batch *batch = run->batch;
    struct block *block = &batch->blocks[slot];
    conus_status status = read_poses(block, batch, run->poses, run->left);
    bool is_all = block->first == 0 && block->rows < batch->rows_at_once && block->rows < run->left;
    if (!status && block->rows && !is_all && batch->format->is_of_probe) {
        status =
            fail(CONUS_ERROR_ARGUMENT,
                 "format: a probe is written as a whole, but these are contacts %llu to %llu, and there may be more",
                 (unsigned long long)block->first + 1, (unsigned long long)block->first + block->rows);
    }
    run->left -= block->rows;
    *may_follow = block->rows == batch->rows_at_once;
    return status;
}

struct writing {
    struct block *block;
    conus_report *report;
    bool counts;            /* a pose without an answer is one error, however many atlases have none */
    conus_row_marks *marks; /* the report's, or NULL */
};

/* Says of which pose the answer is that the report takes next, and of which contact. */
static void mark(const struct writing *writing, size_t index)
{
    const struct pose_words *words = &writing->block->words[index];
    conus_report *report = writing->report;
    if (writing->marks) {
        writing->marks->number = words->number;
        writing->marks->time_s = words->time_s;
        const char *text = writing->block->strings.data + words->kept;
        const char **texts = (const char **)writing->marks->texts;
        for (size_t i = 0; i < writing->marks->count; i++) {
            texts[i] = words->has_kept ? text : NULL;
            text += words->has_kept ? strlen(text) + 1 : 0;
        }
    }
    if (report->options.probe) { /* a row without an answer has none, and needs none */
        report->contact = words->contact ? words->contact : conus_probe_at(report->options.probe, 0);
        report->contact_probe = writing->block->strings.data + words->probe;
    }
}

static const char *id_of(const struct writing *writing, size_t index)
{
    return writing->block->strings.data + writing->block->words[index].id;
}

static conus_status add_error(const struct writing *writing, size_t index)
{
    struct block *block = writing->block;
    const struct batch_pose *pose = &block->poses[index];
    const char *why = pose->is_no_pose ? block->strings.data + block->words[index].error : conus_message();
    bool is_first = writing->counts && !block->errors;
    block->errors += writing->counts;
    if (is_first) {
        block->error_line = pose->line;
        snprintf(block->error, sizeof block->error, "%s", why);
    }
    return conus_report_add_error(writing->report, id_of(writing, index), pose->line, why);
}

static conus_status add_to_report(void *user, size_t index, const conus_selection *selection)
{
    const struct writing *writing = user;
    mark(writing, index);
    return selection ? conus_report_add(writing->report, id_of(writing, index), selection) : add_error(writing, index);
}

static conus_status add_axis_to_report(void *user, size_t index, conus_table *table)
{
    const struct writing *writing = user;
    mark(writing, index);
    return table ? conus_report_add_table(writing->report, id_of(writing, index), table) : add_error(writing, index);
}

/* Whether axes are asked about: of a probe, where its poses have one. */
static conus_status find_axes(bool *out, const struct block *block, const conus_report *report)
{
    size_t with[2] = {0};
    for (size_t i = 0; i < block->count && conus_format_at(report->as)->is_of_probe; i++) {
        with[block->poses[i].is_point] += !block->poses[i].is_no_pose;
    }
    if (with[0] && with[1]) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "format: of the poses %zu have a direction, as shanks do, and %zu are contacts", with[0], with[1]);
    }
    *out = with[0] || report_is_of_axes(report->kind);
    return CONUS_OK;
}

/* Answers the block's poses as text, by worker `worker` of each atlas. Gives up once `stop`. */
static conus_status answer_block(void *user, size_t slot, size_t worker, const atomic_bool *stop)
{
    conus_batch *batch = ((struct run *)user)->batch;
    struct block *block = &batch->blocks[slot];
    conus_report *first = batch->atlases[0].reports[worker];
    bool of_axes = false;
    const double *within = first->kind == ROWS_CLEARANCES ? &first->options.within : NULL;
    conus_status status = find_axes(&of_axes, block, first);
    for (size_t i = 0; i < batch->atlas_count && !status; i++) {
        const struct batch_atlas *atlas = &batch->atlases[i];
        struct writing writing = {block, atlas->reports[worker], i == 0, batch->marks ? &batch->marks[worker] : NULL};
        struct batch_worker *asked = &atlas->workers[worker];
        status = of_axes ? batch_worker_answer_axes(asked, block->poses, block->count, stop, within, add_axis_to_report,
                                                    &writing)
                         : batch_worker_answer(asked, block->poses, block->count, stop, add_to_report, &writing);
    }
    if (!status) {
        first->taken = (size_t)block->first;
        status = report_write_part(&block->text, first);
        status = status ? status : buffer_status(&block->text);
    }
    for (size_t i = 0; i < batch->atlas_count; i++) {
        report_clear(batch->atlases[i].reports[worker]);
    }
    return status;
}

static conus_status deliver_block(void *user, size_t slot)
{
    struct run *run = user;
    const struct block *block = &run->batch->blocks[slot];
    const conus_batch_block answers = {.text = block->text.data ? block->text.data : "",
                                       .size = block->text.size,
                                       .poses = block->rows,
                                       .errors = block->errors,
                                       .line = block->errors ? block->error_line : 0,
                                       .why = block->errors ? block->error : NULL};
    return !block->rows || run->sink(run->user, &answers) ? CONUS_OK
                                                          : fail(CONUS_ERROR_CANCELLED, "the sink ended the run");
}

static void stop_reading(void *user)
{
    conus_pose_stream_stop(((struct run *)user)->poses);
}

conus_status conus_batch_run(conus_batch *batch, conus_pose_stream *poses, uint64_t limit, conus_batch_sink sink,
                             void *user)
{
    struct run run = {.batch = batch, .poses = poses, .left = limit, .sink = sink, .user = user};
    size_t wanted = batch->blocks[0].kept_count;
    size_t kept = pose_stream_kept_count(poses);
    if (kept != wanted) {
        return fail(CONUS_ERROR_ARGUMENT, "keep: the poses have %zu columns, the marks of the report %zu", kept,
                    wanted);
    }
    return ring_run(&(const struct ring){.user = &run,
                                         .workers = batch->options.threads,
                                         .slots = batch->block_count,
                                         .read = read_block,
                                         .answer = answer_block,
                                         .deliver = deliver_block,
                                         .interrupt = stop_reading});
}
