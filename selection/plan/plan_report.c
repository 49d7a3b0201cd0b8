/* SPDX-License-Identifier: BSD-3-Clause */
/* Adds plans to reports: their poses, and the names and columns of their constraints. Lists constraints, and the best
 * poses of entries and targets. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"
#include "selection/plan/plan.h"
#include "selection/report/report.h"
#include "selection/table/table.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { DEPTH_LIMIT = 100000, CONSTRAINT_LIMIT = 100, NEEDLE_COLUMN_LIMIT = 200 };

/* In the order of conus_constraint_kind; behind the number in a column's name comes the ending. */
static const struct {
    const char *word, *ending, *units;
} kinds[] = {{.word = "reach"},           {.word = "avoid"},         {"length", "_mm", "mm"},
             {"lean", "_deg", "degree"},  {"apart", "_mm", "mm"},    {"first", "", NULL},
             {"angle", "_deg", "degree"}, {"arc", "_deg", "degree"}, {"slider", "_deg", "degree"}};

/* In the order of conus_measure; the last one is that of an avoided structure, by clearance. The limit stands before
 * `of`, and the structure's name behind it; `any` stands where any structure will do. */
static const struct {
    const char *word, *ending, *units, *of, *any;
} measures[] = {
    {"length", "_mm", "mm", " mm of the axis in ", "some of the axis in "},
    {"tip", "_tip", NULL, "", "the far end in "},
    {"crossed", "_crossed", NULL, "", "the axis through "},
    {"contacts", "_contacts", NULL, " contacts in ", "some contact in "},
    {"probability", "_probability", NULL, " mean probability of ", "some probability of "},
    {"share", "_share", NULL, " of the cone on ", "some of the cone on "},
    {"pierced", "_pierced", NULL, " of the pixels through ", "some pixel through "},
    {"volume", "_mm3", "mm^3", " mm^3 in the cone of ", "some volume in the cone of "},
    {"fraction", "_fraction", NULL, " of the volume of ", "some of the volume of "},
    {"streamlines", "_streamlines", NULL, " streamlines of ", "some streamline of "},
    {"clearance", "_mm", "mm", " mm of clearance from ", NULL},
};

/* Index into measures. */
static size_t measure_of(const conus_constraint *asked)
{
    bool is_clearance = asked->kind == CONUS_CONSTRAINT_AVOID && asked->measure == CONUS_MEASURE_LENGTH;
    return is_clearance ? sizeof measures / sizeof measures[0] - 1 : (size_t)asked->measure;
}

/* Appends what a constraint asks: "at least 5 mm of the axis in Hippocampus_L". */
static void say_constraint(struct buffer *out, const struct report_constraint *constraint)
{
    const conus_constraint *asked = constraint->asked;
    const size_t measure = measure_of(asked);
    const double *direction = asked->direction;
    switch (asked->kind) {
    case CONUS_CONSTRAINT_REACH:
    case CONUS_CONSTRAINT_AVOID:
        if (asked->kind == CONUS_CONSTRAINT_REACH && asked->limit == 0) {
            buffer_text(out, measures[measure].any);
        } else {
            buffer_format(out, "%s %.9g%s",
                          asked->kind == CONUS_CONSTRAINT_REACH ? "at least"
                          : report_is_clearance(constraint)     ? "more than"
                                                                : "at most",
                          asked->limit, measures[measure].of);
        }
        buffer_text(out, constraint->name);
        if (asked->part[1] > 0) {
            buffer_format(out, ", %.9g to %.9g mm before the far end", asked->part[0], asked->part[1]);
        }
        break;
    case CONUS_CONSTRAINT_LENGTH:
        buffer_format(out, "a length of %.9g to %.9g mm", asked->limit, asked->most);
        break;
    case CONUS_CONSTRAINT_LEAN:
        buffer_format(out, "at most %.9g degrees between axis and RAS direction (%.4g, %.4g, %.4g)", asked->limit,
                      direction[0], direction[1], direction[2]);
        break;
    case CONUS_CONSTRAINT_APART:
        buffer_format(out, "more than %.9g mm from each of %zu other needles", asked->limit, asked->needle_count);
        break;
    case CONUS_CONSTRAINT_FIRST:
        buffer_format(out, "%s as the first object on the axis", constraint->name);
        break;
    case CONUS_CONSTRAINT_ENTRY_ANGLE:
        buffer_format(out, "at most %.9g degrees between axis and inward normal", asked->limit);
        break;
    case CONUS_CONSTRAINT_ARC:
    case CONUS_CONSTRAINT_SLIDER:
        buffer_format(out, "%s angle of %.9g to %.9g degrees",
                      asked->kind == CONUS_CONSTRAINT_ARC ? "an arc" : "a slider", asked->limit, asked->most);
        if (asked->pitch != 0) {
            buffer_format(out, " on a rig that is pitched by %.9g", asked->pitch);
        }
        break;
    }
    if (asked->shank > 0) {
        buffer_format(out, ", shank %d", (int)asked->shank);
    } else if (asked->shank) {
        buffer_text(out, asked->shank == CONUS_SHANK_ANY ? ", any shank" : ", all shanks");
    }
}

static const char ASKED[] = "asked is ";

/* A column of constraint `index`; its name and description are appended to the words, one after the other. */
static void add_column(struct report_plan *out, size_t index, const char *const affixes[2], const char *units,
                       const char *what, size_t member)
{
    const struct report_constraint *constraint = &out->constraints[index];
    buffer_format(&out->words, "%s%s%" PRIu64 "%s", affixes[0], constraint->kind, constraint->index, affixes[1]);
    buffer_append(&out->words, "", 1);
    buffer_format(&out->words, "%s; %s", what, ASKED);
    say_constraint(&out->words, constraint);
    buffer_append(&out->words, "", 1);
    out->columns[out->column_count++] = (struct report_column){
        .units = units, .type = COLUMN_NUMBER, .offset = index * sizeof(conus_verdict) + member, .home = HOME_VERDICTS};
}

static void add_columns(struct report_plan *out, size_t index)
{
    const struct report_constraint *constraint = &out->constraints[index];
    const size_t measure = measure_of(constraint->asked);
    const conus_constraint_kind kind = constraint->asked->kind;
    bool is_clearance = report_is_clearance(constraint);
    const char *const affixes[2] = {"", constraint->measure ? measures[measure].ending : kinds[kind].ending};
    add_column(out, index, affixes, constraint->measure ? measures[measure].units : kinds[kind].units,
               is_clearance ? "distance of the axis, the radius not taken off" : "what was measured",
               offsetof(conus_verdict, value));
    if (is_clearance) {
        add_column(out, index, (const char *[2]){"", "_at_mm"}, "mm", "where the axis is nearest, from the apex",
                   offsetof(conus_verdict, depth));
    }
    if (out->jitter) {
        add_column(out, index, (const char *[2]){"p_", ""}, NULL, "probability that it holds, of a pose with errors",
                   offsetof(conus_verdict, p));
    }
}

/* The words stay where they are once all are there. */
static void point_to_words(struct report_plan *out)
{
    const char *word = out->words.data;
    for (size_t i = 0; i < out->column_count; i++) {
        struct report_column *column = &out->columns[i];
        column->name = word;
        column->description = word + strlen(word) + 1;
        word = column->description + strlen(column->description) + 1;
        out->constraints[column->offset / sizeof(conus_verdict)].words =
            strstr(column->description, ASKED) + strlen(ASKED);
    }
}

static conus_status fill(struct report_plan *out, const conus_plan *plan)
{
    out->count = conus_plan_constraint_count(plan);
    if (out->count > CONSTRAINT_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "report: %zu constraints, allowed are %d", out->count, CONSTRAINT_LIMIT);
    }
    size_t counts[sizeof kinds / sizeof kinds[0]] = {0};
    out->candidates = conus_plan_left(plan, 0);
    out->rejected = conus_plan_rejected(plan).count;
    out->jitter = plan_asked_of(plan)->jitter.errors ? &plan_asked_of(plan)->jitter.options : NULL;
    out->constraints = memory_zeroed(out->count, sizeof *out->constraints);
    out->columns = memory_zeroed(3 * out->count, sizeof *out->columns);
    for (size_t i = 0; i < out->count && out->constraints && out->columns; i++) {
        const conus_constraint *asked = conus_plan_constraint(plan, i);
        out->constraints[i] = (struct report_constraint){
            .asked = asked,
            .kind = kinds[asked->kind].word,
            .measure = asked->kind <= CONUS_CONSTRAINT_AVOID ? measures[measure_of(asked)].word : NULL,
            .name = conus_plan_name(plan, i),
            .index = ++counts[asked->kind],
            .left = conus_plan_left(plan, i + 1),
            .miss = conus_plan_miss(plan, i)};
        add_columns(out, i);
    }
    conus_status status = out->constraints && out->columns ? buffer_status(&out->words) : CONUS_ERROR_MEMORY;
    if (!status) {
        point_to_words(out);
    }
    return status;
}

static conus_status begin_plan(conus_report *report, const conus_plan *plan, bool fits)
{
    if (!fits || report->plan.count) {
        return fail(CONUS_ERROR_ARGUMENT, "report: a plan, but %s",
                    fits ? "there is one already" : "its rows are of something else");
    }
    struct report_plan added = {0};
    conus_status status = fill(&added, plan);
    if (status) {
        report_plan_finish(&added);
        return status;
    }
    report->plan = added;
    return CONUS_OK;
}

/* Adds a query with `count` rows of the pose. */
static conus_status add_pose(struct report_row **rows, conus_report *report, const conus_planned *pose, size_t count)
{
    const struct report_query query = {
        .asked = {.cone = {.pose = pose->pose, .degrees = pose->angle, .range = {pose->near, pose->far}},
                  .is_axis = true}};
    conus_status status = report_append(rows, report, pose->id, &query, count);
    const double *m = pose->pose.world_from_device;
    const double axis[3] = {-m[8], -m[9], -m[10]};
    for (size_t i = 0; i < count && !status; i++) {
        struct report_planned *planned = &(*rows)[i].planned;
        *planned = (struct report_planned){.pose = pose, .depth = pose->far};
        conus_frame_direction_from_world(planned->axis, &report->frame, axis);
        for (int a = 0; a < 3; a++) {
            planned->at[a] = m[12 + a] + axis[a] * pose->far;
        }
    }
    return status;
}

/* Finds the column of a name among those of all needles so far, which it joins if it is a new one. */
static conus_status join_column(size_t *place, struct report_needles *needles, const struct report_column *column)
{
    static const char OTHERS[] = "what was measured of that constraint of the needle (Plan)";
    size_t at = 0;
    while (at < needles->column_count && strcmp(needles->columns[at].name, column->name) != 0) {
        at++;
    }
    struct report_column *joined = &needles->columns[at];
    if (at == needles->column_count) {
        *joined = *column;
        joined->offset = needles->column_count++;
        joined->home = HOME_NEEDLE;
    } else if (strcmp(joined->description, column->description) != 0) {
        joined->description = OTHERS;
    }
    *place = at;
    return needles->column_count <= NEEDLE_COLUMN_LIMIT
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "report: the constraints of all needles have more than %d columns",
                      NEEDLE_COLUMN_LIMIT);
}

/* Joins the columns of all needles. */
static conus_status join_columns(struct report_needles *needles)
{
    size_t most = 0;
    for (size_t i = 0; i < needles->question_count; i++) {
        most += needles->questions[i].plan.column_count;
    }
    needles->columns = memory_zeroed(most, sizeof *needles->columns);
    for (size_t i = 0; i < needles->question_count && needles->columns; i++) {
        struct report_question *needle = &needles->questions[i];
        needle->places = memory_raw(most, sizeof *needle->places);
        for (size_t k = 0; k < most && needle->places; k++) {
            needle->places[k] = SIZE_MAX;
        }
        for (size_t k = 0; k < needle->plan.column_count; k++) {
            size_t place = 0;
            conus_status status =
                needle->places ? join_column(&place, needles, &needle->plan.columns[k]) : CONUS_ERROR_MEMORY;
            if (status) {
                return status;
            }
            needle->places[place] = k;
        }
    }
    return needles->columns ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status fill_needles(struct report_needles *out, const conus_together *together)
{
    const size_t count = conus_together_count(together);
    size_t questions = 0;
    while (conus_together_combination(together, out->combination_count)) {
        out->combination_count++;
    }
    while (conus_together_question(together, questions)) {
        questions++;
    }
    out->asked = conus_together_asked(together);
    out->conflict = conus_together_conflict(together);
    out->questions = memory_zeroed(questions, sizeof *out->questions);
    out->at = memory_zeroed(count, sizeof(conus_placed *));
    out->combinations = memory_zeroed(out->combination_count + 1, sizeof(conus_combination *));
    conus_status status = out->questions && out->at && out->combinations ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t n = 0; n < out->combination_count && !status; n++) {
        out->combinations[n] = conus_together_combination(together, n);
    }
    for (; out->count < count && !status; out->count++) {
        out->at[out->count] = conus_together_needle(together, out->count);
    }
    for (size_t i = 0; i < questions && !status; i++) {
        out->questions[i].answered = conus_together_question(together, i);
        status = fill(&out->questions[i].plan, out->questions[i].answered->plan);
        out->question_count++;
    }
    return status ? status : join_columns(out);
}

static conus_status add_pairs(conus_report *report, const conus_together *together)
{
    conus_table *table = NULL;
    conus_status status = conus_together_pairs(&table, together);
    status = status ? status : conus_report_add_table(report, "pairs", table);
    conus_table_destroy(table);
    return status;
}

conus_status conus_report_add_together(conus_report *report, const conus_together *together)
{
    const enum report_rows rows = report->kind;
    if (rows < ROWS_NEEDLES || report->needles.count) {
        return fail(CONUS_ERROR_ARGUMENT, "report: several needles, but %s",
                    rows < ROWS_NEEDLES ? "its rows are of something else" : "there are some already");
    }
    struct report_needles added = {0};
    conus_status status = fill_needles(&added, together);
    if (status) {
        report_needles_finish(&added);
        return status;
    }
    report->needles = added;
    if (rows == ROWS_PAIRS) {
        return add_pairs(report, together);
    }
    for (size_t n = 0; n < added.combination_count && !status; n++) {
        for (size_t i = 0; i < added.count && !status; i++) {
            struct report_row *row;
            status = add_pose(&row, report, added.combinations[n]->chosen[i].pose, 1);
            if (!status) {
                row->planned.needle = i;
                row->planned.question = added.combinations[n]->chosen[i].question;
                row->planned.combination = n;
            }
        }
    }
    return status;
}

conus_status conus_report_add_plan(conus_report *report, conus_plan *plan)
{
    bool of_constraints = report->kind == ROWS_CONSTRAINTS;
    conus_status status = begin_plan(report, plan, of_constraints || report->kind == ROWS_PLAN);
    size_t count = of_constraints ? report->plan.count : 1;
    for (size_t i = 0; i < conus_plan_count(plan) && !status; i++) {
        struct report_row *rows;
        status = add_pose(&rows, report, conus_plan_pose(plan, i), count);
        for (size_t k = 0; k < count && !status; k++) {
            rows[k].planned.constraint = k;
        }
    }
    return status;
}

/* Adds the rows of one pose. `depths` steps lead from its near end to its far end, the last one perhaps shorter. */
static conus_status add_profile(conus_report *report, conus_plan *plan, size_t index, double step, size_t depths)
{
    const conus_planned *pose = conus_plan_pose(plan, index);
    const double *m = pose->pose.world_from_device;
    struct report_row *row;
    size_t avoided = 0;
    for (size_t k = 0; k < report->plan.count; k++) {
        avoided += report_is_clearance(&report->plan.constraints[k]);
    }
    conus_status status = add_pose(&row, report, pose, avoided * (depths + 1));
    for (size_t i = 0; i <= depths && !status; i++) {
        for (size_t k = 0; k < report->plan.count && !status; k++) {
            if (report_is_clearance(&report->plan.constraints[k])) {
                struct report_planned *planned = &row++->planned;
                planned->constraint = k;
                planned->order = i + 1;
                planned->depth = i < depths ? pose->near + (double)i * step : pose->far;
                for (int a = 0; a < 3; a++) {
                    planned->at[a] = m[12 + a] - m[8 + a] * planned->depth;
                }
                status = conus_plan_distance(&planned->distance, plan, index, k, planned->depth);
            }
        }
    }
    return status;
}

conus_status conus_report_add_tolerance(conus_report *report, conus_plan *plan, const conus_tolerance_options *options)
{
    conus_tolerance_options filled = *options_of(conus_tolerance_options, options);
    conus_status status = begin_plan(report, plan, report->kind == ROWS_TOLERANCE);
    for (int a = 0; a < 3; a++) {
        const double axis[3] = {a == 0, a == 1, a == 2};
        conus_frame_direction_to_world(filled.shifts[a], &report->frame, axis);
    }
    double axes[2][3];
    (void)pose_space_axes(axes, &report->frame);
    memcpy(filled.up, axes[0], sizeof filled.up);
    for (size_t i = 0; i < conus_plan_count(plan) && !status; i++) {
        conus_tolerance tolerances[CONUS_TOLERANCE_COUNT];
        const conus_planned *pose = conus_plan_pose(plan, i);
        struct report_row *rows;
        status = conus_plan_tolerance(tolerances, plan, pose, &filled);
        status = status ? status : add_pose(&rows, report, pose, CONUS_TOLERANCE_COUNT);
        for (size_t k = 0; k < CONUS_TOLERANCE_COUNT && !status; k++) {
            rows[k].planned.tolerance = tolerances[k];
        }
    }
    return status;
}

conus_status conus_report_add_profile(conus_report *report, conus_plan *plan, double step)
{
    conus_status status = begin_plan(report, plan, report->kind == ROWS_PROFILE);
    for (size_t i = 0; i < conus_plan_count(plan) && !status; i++) {
        const conus_planned *pose = conus_plan_pose(plan, i);
        double depths = ceil((pose->far - pose->near) / step - 1e-9); /* a sum of steps may be rounded */
        status = depths >= 0 && depths < DEPTH_LIMIT
                     ? add_profile(report, plan, i, step, (size_t)depths)
                     : fail(CONUS_ERROR_ARGUMENT, "step: %g mm on a needle of %g mm, allowed are up to %d depths", step,
                            pose->far - pose->near, DEPTH_LIMIT);
    }
    return status;
}

struct constraint_row {
    struct table_object object;
    const char *kind, *name, *asked, *miss;
    uint64_t left;
};

static const struct table_field constraint_fields[] = {
    {"kind", NULL, "reach, avoid, length, lean, apart, first or angle", TABLE_OF(TEXT, struct constraint_row, kind)},
    {"name", NULL, "name of its structure", TABLE_OF(TEXT, struct constraint_row, name)},
    {"asked", NULL, "what it asks", TABLE_OF(TEXT, struct constraint_row, asked)},
    {"left", NULL, "candidates that hold it and all before it", TABLE_OF(LARGE_COUNT, struct constraint_row, left)},
    {"miss", NULL, "the candidate that breaks it alone, by the least", TABLE_OF(TEXT, struct constraint_row, miss)},
};
static const struct table_fields constraint_columns = TABLE_FIELDS(constraint_fields);

static conus_status list_constraints(conus_table **out, const conus_plan *plan)
{
    const size_t count = conus_plan_constraint_count(plan);
    struct constraint_row *rows = memory_zeroed(count, sizeof *rows);
    struct buffer words = {0};
    for (size_t i = 0; rows && i < count; i++) {
        const struct report_constraint constraint = {.asked = conus_plan_constraint(plan, i),
                                                     .name = conus_plan_name(plan, i)};
        const conus_planned *miss = conus_plan_miss(plan, i);
        say_constraint(&words, &constraint);
        buffer_append(&words, "", 1);
        rows[i] = (struct constraint_row){.kind = kinds[constraint.asked->kind].word,
                                          .name = constraint.name,
                                          .miss = miss ? miss->id : NULL,
                                          .left = conus_plan_left(plan, i + 1)};
    }
    conus_status status = buffer_status(&words);
    const char *word = words.data;
    for (size_t i = 0; rows && !status && i < count; i++) {
        rows[i].asked = word;
        word += strlen(word) + 1;
    }
    if (status) {
        memory_free(rows);
    } else {
        status = table_of_rows(out, NULL, &constraint_columns, rows, sizeof *rows, count);
    }
    buffer_finish(&words);
    return status;
}

struct best_row {
    struct table_object object;
    struct plan_best best;
};

static const struct table_field best_fields[] = {
    {"feasible", NULL, "poses that break no constraint", TABLE_OF(LARGE_COUNT, struct best_row, best.feasible)},
    {"candidate", NULL, "number of the best of these; 0 = none",
     TABLE_OF(LARGE_COUNT, struct best_row, best.candidate)},
    {"leeway_mm", "mm", "by which no point of it may be off", TABLE_OF(NUMBER, struct best_row, best.leeway)},
    {"slack_mm", "mm", "least clearance, less its margin", TABLE_OF(NUMBER, struct best_row, best.slack)},
    {"depth_mm", "mm", "how deep the far end is", TABLE_OF(NUMBER, struct best_row, best.far)},
    {"entry_angle_deg", "degree", "between axis and inward normal",
     TABLE_OF(NUMBER, struct best_row, best.entry_angle)},
    {"reach1", NULL, "what the first reach measures", TABLE_OF(NUMBER, struct best_row, best.reach)},
};
static const struct table_fields best_columns = TABLE_FIELDS(best_fields);

static conus_status list_bests(conus_table **out, const conus_plan *plan, bool of_targets)
{
    size_t count;
    const struct plan_best *bests = plan_bests(&count, plan, of_targets);
    struct best_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        rows[i].best = bests[i];
    }
    return table_of_rows(out, NULL, &best_columns, rows, sizeof *rows, count);
}

conus_status conus_plan_list(conus_table **out, const conus_plan *plan, const char *what)
{
    if (what && strcmp(what, "constraints") == 0) {
        return list_constraints(out, plan);
    }
    bool of_targets = what && strcmp(what, "targets") == 0;
    if (!of_targets && (!what || strcmp(what, "entries") != 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "what: %s, allowed are constraints, entries and targets",
                    what ? what : "none");
    }
    return plan_is_done(plan) ? list_bests(out, plan, of_targets)
                              : fail(CONUS_ERROR_ARGUMENT, "plan: it has no list yet, which conus_plan_run() makes");
}
