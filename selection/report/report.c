/* SPDX-License-Identifier: BSD-3-Clause */
/* Reports: makes them, and collects what they are to say. */
#include "selection/report/report.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/text.h"
#include "conus/own.h"
#include "selection/report/parts.h"

#include <math.h>
#include <string.h>

/* Copies the level, so that the report does not need the selector. */
static conus_status keep_level(conus_report *report, const conus_selector *selector)
{
    if (!selector->level_spec) {
        return CONUS_OK;
    }
    const uint32_t *areas = level_areas(selector->level, &report->level_area_count);
    report->level = memory_text(selector->level_spec, strlen(selector->level_spec));
    report->level_areas = memory_copy(areas, report->level_area_count, sizeof *areas);
    return report->level && report->level_areas ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status check_options(const conus_report_options *options, enum report_rows rows, enum report_number format)
{
    bool foreign = conus_format_at(format)->is_foreign;
    if (rows == ROWS_SUMMARIES && format == REPORT_TABLE) {
        return fail(CONUS_ERROR_ARGUMENT, "format: summaries are not written as a table for people");
    }
    if (foreign && (rows != ROWS_ANSWERS || options->tracker)) {
        return fail(CONUS_ERROR_ARGUMENT, "format: formats of other programs hold answers, not tracks");
    }
    if (options->order && (foreign || rows != ROWS_ANSWERS || options->tracker)) {
        return fail(CONUS_ERROR_ARGUMENT, "order: by depth: only answers have it, in formats up to NDJSON, not tracks");
    }
    if (options->atlas && (foreign || !*options->atlas)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    foreign ? "atlas: formats of other programs have no such column" : "atlas: the name is empty");
    }
    if ((format == REPORT_BIDS) != (options->electrodes != NULL)) {
        return fail(CONUS_ERROR_ARGUMENT, "electrodes: BIDS needs the table, and no other format does");
    }
    if (format == REPORT_BEP032 && !options->probe) {
        return fail(CONUS_ERROR_ARGUMENT, "probe: BEP032 lists the contacts of probes, and there is none");
    }
    if (options->placed && format != REPORT_BEP032) {
        return fail(CONUS_ERROR_ARGUMENT, "placed: only BEP032 has positions on the probe otherwise");
    }
    bool of_contacts = rows == ROWS_ANSWERS || rows == ROWS_SUMMARIES;
    if (options->probe && (!of_contacts || options->tracker)) {
        return fail(CONUS_ERROR_ARGUMENT, "probe: only answers have its columns, not tracks");
    }
    if (options->marks && options->tracker) {
        return fail(CONUS_ERROR_ARGUMENT, "marks: a track has the time of its steps, and no other");
    }
    if (!(options->within >= 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "within: %g mm, allowed is 0 or more", options->within);
    }
    const conus_contacts *contacts = &options->contacts;
    if (!contacts->count) {
        return CONUS_OK;
    }
    if (format != REPORT_OPEN_EPHYS) {
        return fail(CONUS_ERROR_ARGUMENT, "contacts: Open Ephys needs them, and no other format does");
    }
    return contacts_check(contacts);
}

/* Of reports without a selector: nothing is in it. */
static const conus_atlas no_atlas;

bool report_has_atlas(const conus_report *report)
{
    return report->atlas != &no_atlas;
}

static void take_selector(conus_report *report, const conus_selector *selector)
{
    report->atlas = selector->atlas;
    report->selector = selector->options;
    report->weight = selector->options.weight ? selector->options.weight->facts : report->weight;
    report->prior = selector->prior;
    report->prior.times = NULL;
    report->selector.weight = NULL; /* which may end */
    memcpy(report->score, selector->ranking.formula.text, sizeof report->score);
    memcpy(report->engine, selector->engine->name, sizeof report->engine);
}

static conus_status find_prefixes(conus_report *report)
{
    report->prefixes = memory_zeroed(report->atlas->object_count + 1, sizeof *report->prefixes);
    return report->prefixes ? conus_atlas_prefixes(report->prefixes, report->atlas) : CONUS_ERROR_MEMORY;
}

/* Makes the columns of rows of tables. */
static conus_status make_fields(conus_report *report)
{
    const struct table_fields *fields = report_fields(report->kind);
    if (!fields) {
        return CONUS_OK;
    }
    report->fields = memory_zeroed(fields->count, sizeof *report->fields);
    for (size_t i = 0; i < fields->count && report->fields; i++) {
        const struct table_field *field = &fields->at[i];
        if (table_has_field(report->atlas, field)) {
            report->fields[report->field_count] = (struct report_column){.name = field->name,
                                                                         .units = field->unit,
                                                                         .description = field->help,
                                                                         .type = field->type,
                                                                         .offset = report->field_count,
                                                                         .home = HOME_TABLE,
                                                                         .unless_zeros = field->unless_zeros};
            report->field_count++;
        }
    }
    return report->fields ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Makes the further columns of the marks. */
static conus_status make_kept(conus_report *report)
{
    const conus_row_marks *marks = report_marks(report);
    struct report_columns columns;
    if (!marks || !marks->count) {
        return CONUS_OK;
    }
    report_list_columns(&columns, report); /* without them */
    report->kept = memory_zeroed(marks->count, sizeof *report->kept);
    conus_status status = !report->kept ? CONUS_ERROR_MEMORY
                          : marks->count <= REPORT_KEPT_LIMIT
                              ? CONUS_OK
                              : fail(CONUS_ERROR_ARGUMENT, "marks: %zu further columns, allowed are up to %d",
                                     marks->count, REPORT_KEPT_LIMIT);
    for (size_t i = 0; i < marks->count && !status; i++) {
        char *name = text_to_utf8(text_from(marks->names[i]));
        report_kept_column(&report->kept[i], name, i);
        status = name ? CONUS_OK : CONUS_ERROR_MEMORY;
        for (size_t k = 0; k < columns.count && !status; k++) {
            if (strcmp(columns.at[k]->name, name) == 0) {
                status = fail(CONUS_ERROR_ARGUMENT, "a column \"%s\" cannot be kept: the answer has one itself%s", name,
                              k < columns.count - i ? "" : ", or it is named twice");
            }
        }
        columns.at[columns.count] = &report->kept[i];
        columns.count += !status;
    }
    return status;
}

conus_status conus_report_create(conus_report **out, const conus_selector *selector,
                                 const conus_report_options *options)
{
    options = options_of(conus_report_options, options);
    conus_frame frame;
    enum report_rows kind;
    enum report_number format;
    conus_status status = report_rows_find(&kind, options->rows);
    status = status ? status : report_format_find(&format, options->format);
    status = status ? status : check_options(options, kind, format);
    status = status ? status : frame_of_options(&frame, options->frame, options->space);
    if (status) {
        return status;
    }
    conus_report *report = memory_zeroed(1, sizeof *report);
    if (!report) {
        return CONUS_ERROR_MEMORY;
    }
    report->atlas = &no_atlas;
    if (selector) {
        take_selector(report, selector);
    }
    report->options = *options;
    report->kind = kind;
    report->as = format;
    report->options.frame = NULL; /* the caller's may end */
    report->options.space = frame.space;
    report->frame = frame;
    report->options.no_voxels = report->options.no_voxels || report->options.tracker;
    report->name = options->atlas ? text_to_utf8(text_from(options->atlas)) : NULL;
    status = options->atlas && !report->name ? CONUS_ERROR_MEMORY : selector ? keep_level(report, selector) : CONUS_OK;
    status = status || !report->options.electrodes ? status : report_read_electrodes(report);
    status = status || format != REPORT_TABLE ? status : find_prefixes(report);
    bool is_draft = format == REPORT_BEP032;
    status = status || !is_draft ? status : report_bep032_create(&report->bep032, report->atlas);
    status = status ? status : make_fields(report);
    status = status ? status : make_kept(report);
    if (status) {
        conus_report_destroy(report);
        return status;
    }
    *out = report;
    return CONUS_OK;
}

static void free_kept(struct report_query *query, const conus_report *report)
{
    for (size_t i = 0; query->kept && i < report->options.marks->count; i++) {
        memory_free(query->kept[i]);
    }
    memory_free(query->kept);
}

void report_clear(conus_report *report)
{
    for (size_t i = 0; i < report->query_count; i++) {
        memory_free(report->queries[i].id);
        memory_free(report->queries[i].error);
        conus_table_destroy(report->queries[i].table);
        free_kept(&report->queries[i], report);
    }
    report->query_count = 0;
    report->row_count = 0;
    buffer_clear(&report->voxels);
}

/* Whether both have the same columns, and answer the same questions in the same way. */
static bool are_alike(const conus_report *a, const conus_report *b)
{
    const conus_report_options *x = &a->options;
    const conus_report_options *y = &b->options;
    const conus_selector_options *p = &a->selector;
    const conus_selector_options *q = &b->selector;
    return a->kind == b->kind && a->as == b->as && a->frame.space == b->frame.space &&
           mat4_is_same(a->frame.world_from_space, b->frame.world_from_space) && !x->tracker == !y->tracker &&
           x->selected_only == y->selected_only && x->points == y->points && x->radii == y->radii &&
           a->atlas->is_moved == b->atlas->is_moved && strcmp(a->score, b->score) == 0 &&
           strcmp(a->engine, b->engine) == 0 && p->aperture == q->aperture && p->sampling == q->sampling &&
           p->resolution == q->resolution && p->slices == q->slices && p->slice_fraction == q->slice_fraction &&
           p->layers == q->layers && p->range[0] == q->range[0] && p->range[1] == q->range[1] &&
           p->radius == q->radius && a->weight.form == b->weight.form && a->prior.power == b->prior.power;
}

conus_status conus_report_join(conus_report *report, conus_report *more)
{
    conus_report *last = report;
    if (!report->name || !more->name || more->next || more->is_joined || more == report) {
        return fail(CONUS_ERROR_ARGUMENT, "report: only one with a column atlas can be joined, and once");
    }
    if (!are_alike(report, more)) {
        return fail(
            CONUS_ERROR_ARGUMENT,
            "report: the one of atlas %s has other options than that of atlas %s, or only one of the two was moved",
            more->name, report->name);
    }
    for (conus_report *with = report; with; with = with->next) {
        if (strcmp(with->name, more->name) == 0) {
            return fail(CONUS_ERROR_ARGUMENT, "report: two have the atlas %s", more->name);
        }
        last = with;
    }
    last->next = more;
    more->is_joined = true;
    return CONUS_OK;
}

void report_plan_finish(struct report_plan *plan)
{
    memory_free(plan->constraints);
    memory_free(plan->columns);
    buffer_finish(&plan->words);
}

void report_needles_finish(struct report_needles *needles)
{
    for (size_t i = 0; i < needles->question_count; i++) {
        report_plan_finish(&needles->questions[i].plan);
        memory_free(needles->questions[i].places);
    }
    memory_free(needles->questions);
    memory_free((void *)needles->at);
    memory_free((void *)needles->combinations);
    memory_free(needles->columns);
}

void conus_report_destroy(conus_report *report)
{
    if (!report) {
        return;
    }
    report_clear(report);
    memory_free((void *)report->prefixes);
    memory_free(report->name);
    memory_free(report->level);
    memory_free(report->level_areas);
    memory_free(report->queries);
    memory_free(report->rows);
    memory_free(report->electrode_lines);
    for (size_t i = 0; report->kept && i < report->options.marks->count; i++) {
        memory_free((char *)report->kept[i].name);
    }
    memory_free(report->kept);
    memory_free(report->fields);
    report_bep032_destroy(report->bep032);
    report_plan_finish(&report->plan);
    report_needles_finish(&report->needles);
    buffer_finish(&report->voxels);
    buffer_finish(&report->text);
    memory_free(report);
}

/* Copies what the marks say of the answer that is added; the caller frees it in any case. */
static conus_status copy_marks(struct report_query *out, const conus_report *report)
{
    const conus_row_marks *marks = report_marks(report);
    out->number = marks ? marks->number : 0;
    out->time_s = marks ? marks->time_s : NAN;
    out->kept = NULL;
    if (!marks || !marks->count) {
        return CONUS_OK;
    }
    out->kept = memory_zeroed(marks->count, sizeof *out->kept);
    bool whole = out->kept;
    for (size_t i = 0; i < marks->count && whole; i++) {
        const char *text = marks->texts ? marks->texts[i] : NULL;
        out->kept[i] = text_to_utf8(text_from(text ? text : ""));
        whole = out->kept[i];
    }
    return whole ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* What is owned is copied first, so that nothing has changed where there is no memory. */
static conus_status append_query(conus_report *report, const char *id, const struct report_query *query)
{
    const conus_probe_contact *next = conus_probe_at(report->options.probe, report->taken + report->query_count);
    if (report->options.probe && !report->contact && !next) {
        return fail(CONUS_ERROR_ARGUMENT, "probe: more answers than its %zu contacts",
                    conus_probe_contact_count(report->options.probe));
    }
    bool fits =
        memory_reserve(&report->queries, &report->query_capacity, report->query_count + 1, sizeof *report->queries);
    struct report_query copy = *query;
    copy.id = fits ? text_to_utf8(text_from(id)) : NULL;
    copy.first_voxel = report->voxels.size;
    copy.contact = report->contact ? report->contact : next;
    copy.probe = report->contact_probe;
    if (!copy.id || copy_marks(&copy, report)) {
        free_kept(&copy, report);
        memory_free(copy.id);
        return CONUS_ERROR_MEMORY;
    }
    report->queries[report->query_count++] = copy;
    return CONUS_OK;
}

static conus_status reserve_rows(conus_report *report, size_t count)
{
    return memory_reserve(&report->rows, &report->row_capacity, report->row_count + count, sizeof *report->rows)
               ? CONUS_OK
               : CONUS_ERROR_MEMORY;
}

/* Of the last query; after reserve_rows(). */
static void append_rows(struct report_row **out, conus_report *report, size_t count)
{
    *out = report->rows + report->row_count;
    for (size_t i = 0; i < count; i++) {
        (*out)[i].query = report->query_count - 1;
    }
    report->row_count += count;
}

conus_status report_append(struct report_row **rows, conus_report *report, const char *id,
                           const struct report_query *query, size_t count)
{
    struct report_query placed = *query;
    placed.first_row = report->row_count;
    conus_status status = reserve_rows(report, count);
    status = status ? status : append_query(report, id, &placed);
    if (!status) {
        append_rows(rows, report, count);
    }
    return status;
}

/* Where a row begins, mm; infinite where it is not known. */
static double depth_of(const conus_report *report, const struct report_row *row)
{
    bool by_entry = report->selector.layers && !(report->queries[row->query].asked.ball > 0);
    double depth = by_entry ? row->result.entry : row->result.distance;
    return row->result.object && isfinite(depth) ? depth : INFINITY;
}

/* Sorts rows that are in the order of their ranks, the unassigned last. */
static void sort_by_depth(struct report_row *rows, size_t count, const conus_report *report)
{
    for (size_t i = 1; i < count && rows[i].result.object; i++) {
        struct report_row row = rows[i];
        size_t place = i;
        for (; place > 0 && depth_of(report, &rows[place - 1]) > depth_of(report, &row); place--) {
            rows[place] = rows[place - 1];
        }
        rows[place] = row;
    }
}

conus_status conus_report_add(conus_report *report, const char *query_id, const conus_selection *selection)
{
    const struct statistics *statistics = &selection->statistics;
    bool is_ball = selection->region.shape == REGION_BALL;
    struct report_query query = {.asked = {.cone = selection->cone, .ball = is_ball ? selection->region.radius : 0},
                                 .step = selection->step,
                                 .is_point = selection->is_point};
    if (report->kind != ROWS_ANSWERS && report->kind != ROWS_SHARES && report->kind != ROWS_SUMMARIES) {
        return fail(CONUS_ERROR_ARGUMENT, "report: an answer, but its rows are of something else");
    }
    for (size_t i = 0; i < statistics->count; i++) {
        query.cone_pixels += statistics->results[i].pixels;
    }
    struct report_row *rows;
    conus_status status = report_append(&rows, report, query_id, &query, statistics->count);
    if (!status) {
        size_t kept = 0;
        for (size_t i = 0; i < statistics->count; i++) {
            rows[kept].result = statistics->results[i];
            const conus_step *step = &report->queries[rows[kept].query].step;
            bool is_nothing = !rows[kept].result.object && !step->selected && !step->confirmed;
            kept += !report->options.selected_only || is_nothing || report_is_selected(report, &rows[kept]) ||
                    report_is_confirmed(report, &rows[kept]);
        }
        report->row_count -= statistics->count - kept; /* rows of results that were not wanted */
        if (report->options.order == CONUS_ORDER_DEPTH) {
            sort_by_depth(rows, kept, report);
        }
    }
    return status || report->options.no_voxels ? status : report_add_voxels(report, selection);
}

/* A probe's shanks have no rows, but are made of segments. */
conus_status report_check_table(const conus_report *report, const conus_table *table)
{
    const struct table_fields *fields =
        conus_format_at(report->as)->is_of_probe ? &segment_fields : report_fields(report->kind);
    if (!table_is_of(table, fields)) {
        return fail(CONUS_ERROR_ARGUMENT, "report: a table of other rows");
    }
    if (!table_fits(table, &report->frame)) {
        return fail(CONUS_ERROR_ARGUMENT, "report: a table with positions in another space");
    }
    double within = table_question(table)->within;
    return report->kind != ROWS_CLEARANCES || report->options.within == within
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "within: clearances up to %g mm, but the report is of those up to %g mm",
                      within, report->options.within);
}

conus_status conus_report_add_table(conus_report *report, const char *query_id, conus_table *table)
{
    struct report_row *rows;
    struct report_query query = {.asked = *table_question(table)};
    conus_status status = report_check_table(report, table);
    status = status ? status : report_append(&rows, report, query_id, &query, conus_table_rows(table));
    if (status) {
        return status;
    }
    report->queries[report->query_count - 1].table = table_hold(table);
    for (size_t i = 0; i < conus_table_rows(table); i++) {
        rows[i].of_table =
            (struct report_table_row){.object = conus_table_objects(table)[i], .table = table, .index = i};
    }
    return CONUS_OK;
}

/* NULL without memory. */
static char *error_text(size_t line, const char *reason)
{
    struct buffer text = {0};
    if (line) {
        buffer_format(&text, "line %zu: ", line);
    }
    buffer_text(&text, reason);
    char *whole = buffer_status(&text) ? NULL : text_to_utf8(text_from(text.data ? text.data : ""));
    buffer_finish(&text);
    return whole;
}

conus_status conus_report_add_error(conus_report *report, const char *query_id, size_t line, const char *reason)
{
    struct report_query query = {.error = error_text(line, reason)};
    struct report_row *row;
    conus_status status = query.error ? report_append(&row, report, query_id, &query, 1) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(query.error);
        return status;
    }
    row->result = (conus_result){.kind = CONUS_KIND_UNASSIGNED};
    return CONUS_OK;
}
