/* SPDX-License-Identifier: BSD-3-Clause */
/* Holds the first tool against the constraints of a plan, and words what they say of it. */
#include "viewer/model/viewer.h"

#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "settings/settings.h"
#include "viewer/model/additions.h"
#include "viewer/model/columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double ROUNDED = 1e-9; /* of a sum of shares */

bool plans_is_on(const struct viewer *viewer)
{
    return viewer->plan.task.constraints.count;
}

/* The needle, and the rays where a measure of the cone needs them. */
static conus_selector_options find_options(const struct viewer *viewer)
{
    const conus_selector_options *cone = &viewer->cone.options;
    conus_measure last = constraints_last_measure(&viewer->plan.task.constraints);
    bool has_rays = last >= CONUS_MEASURE_SHARE;
    return (conus_selector_options){.engine = CONUS_ENGINE_RAYS,
                                    .radius = cone->radius,
                                    .layers = last > CONUS_MEASURE_SHARE ? CONUS_LAYERS_ALL : CONUS_LAYERS_VISIBLE,
                                    .resolution = has_rays ? cone->resolution : 0,
                                    .aperture = has_rays ? cone->aperture : CONUS_APERTURE_CIRCLE};
}

/* The plan that tries the tool, of the atlas as it is now. */
static conus_status prepare_live(struct viewer *viewer)
{
    struct plan_state *state = &viewer->plan;
    const conus_selector_options options = find_options(viewer);
    const struct constraints *asked = &state->task.constraints;
    const conus_plan_options plan_options = {.threads = 1, .shanks = asked->shanks, .shank_count = asked->shank_count};
    if (state->live && selector_options_are_same(&state->made_with, &options)) {
        return CONUS_OK;
    }
    plan_state_drop_live(state);
    state->made_with = options;
    conus_status status = conus_selector_create(&state->selector, viewer->atlases->atlas, &options);
    return status ? status
                  : conus_plan_create(&state->live, state->selector, asked->items, asked->count, &plan_options);
}

static int read_task(struct viewer *viewer, const struct arguments *arguments, const char *poses)
{
    struct plan_state *state = &viewer->plan;
    int code = arguments ? constraints_parse(&state->task.constraints, arguments) : EXIT_DONE;
    if (code || !plans_is_on(viewer)) {
        return code;
    }
    struct named_atlas atlas = {.atlas = viewer->atlases->atlas};
    const struct pose_places places = {&viewer->frame, NULL, &(struct atlases){.items = &atlas, .count = 1},
                                       &(struct common_settings){0}};
    code = constraints_place(&state->task.constraints, &places, state->depth);
    if (!code && poses) {
        state->task.poses = strdup(poses);
        state->list.settings.kind = STUDY_PLAN;
        code = state->task.poses ? EXIT_DONE : print_no_memory();
    }
    conus_status status = code ? CONUS_OK : prepare_live(viewer);
    return status ? print_status(status) : code;
}

int plans_change(struct viewer *viewer, const struct arguments *arguments, const char *poses)
{
    struct plan_state before;
    plan_state_pause(&viewer->plan); /* its thread reads the task */
    before = viewer->plan;
    viewer->plan = (struct plan_state){.depth = before.depth, .number = before.number + 1};
    int code = read_task(viewer, arguments, poses);
    plan_state_finish(code ? &viewer->plan : &before);
    if (code) {
        viewer->plan = before;
        plan_state_resume(&viewer->plan);
    }
    viewer->version++;
    return code;
}

int plans_open(struct viewer *viewer, const struct arguments *arguments, const char *poses, double depth, double radius)
{
    viewer->cone.options.radius = radius;
    viewer->cone.options.range[1] = viewer->plan.depth = depth;
    return plans_change(viewer, arguments, poses);
}

/* The name as the value of an option: in quotes, since it may have commas. To be freed; NULL without memory. */
static char *quote(const char *name)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (!out) {
        return NULL;
    }
    fputc('"', out);
    for (; *name; name++) {
        fprintf(out, *name == '"' ? "\"\"" : "%c", *name);
    }
    fputc('"', out);
    (void)system_text_close(&text); /* whose text is then NULL */
    return text.data;
}

/* Whether names are of one thing alone, and that is this one: as it is called, or in other words for the same object.
 */
static bool is_of_name(const struct viewer *viewer, const char *names, const char *name, const char *quoted)
{
    const conus_atlas *atlas = viewer->atlases->atlas;
    const size_t length = strlen(names);
    const bool is_quoted = length > 1 && names[0] == '"' && names[length - 1] == '"';
    char *bare = text_copy(names + is_quoted, length - 2 * (size_t)is_quoted);
    uint32_t found[2];
    const bool is = strcmp(names, name) == 0 || strcmp(names, quoted) == 0 ||
                    (bare && !strpbrk(bare, is_quoted ? "\"" : ",\"") && !conus_atlas_find(&found[0], atlas, bare) &&
                     !conus_atlas_find(&found[1], atlas, name) && found[0] == found[1]);
    free(bare);
    return is;
}

/* Whether a word asks to avoid this alone; in *is_plain whether by nothing but touching it. It is read by itself: words
 * and the constraints of the plan need not have one order. */
static bool avoids(bool *is_plain, const struct viewer *viewer, const char *value, const char *name, const char *quoted)
{
    struct option_use use = {.option = &constraint_options[CONUS_CONSTRAINT_AVOID], .value = value};
    struct constraints read = {0};
    const bool is = !constraints_parse(&read, &(struct arguments){.uses = &use, .use_count = 1}) &&
                    is_of_name(viewer, read.items[0].names, name, quoted);
    *is_plain = is && !read.items[0].measure && !read.items[0].shank;
    constraints_finish(&read);
    return is;
}

json_t *plans_ask(const struct viewer *viewer, const json_t *words, conus_constraint_kind kind, const char *name,
                  bool asks)
{
    char *quoted = quote(name);
    json_t *all = json_array();
    bool fine = all && quoted;
    bool is_there = false; /* a margin that was asked for is not lost */
    for (size_t i = 0; i < json_array_size(words) && fine; i++) {
        json_t *word = json_array_get(words, i);
        const char *value = word_value(json_string_value(word), constraint_options[kind].name);
        bool goes = value;
        if (value && kind == CONUS_CONSTRAINT_AVOID) {
            bool is_plain;
            goes = avoids(&is_plain, viewer, value, name, quoted) && !asks;
            is_there = is_there || is_plain;
        }
        fine = goes || !json_array_append(all, word);
    }
    if (fine && asks && !is_there) {
        fine = !json_array_append_new(all, json_sprintf("--%s=%s", constraint_options[kind].name, quoted));
    }
    free(quoted);
    return words_or_none(all, fine);
}

json_t *plans_put_asked(const json_t *words, const json_t *asked)
{
    const json_t *const lists[] = {words, asked};
    json_t *all = json_array();
    bool fine = all;
    for (size_t l = 0; l < 2; l++) {
        for (size_t i = 0; i < json_array_size(lists[l]) && fine; i++) {
            json_t *word = json_array_get(lists[l], i);
            const char *text = json_string_value(word);
            bool is_asked = word_value(text, "reach") || word_value(text, "avoid");
            fine = is_asked != (l == 1) || !json_array_append(all, word);
        }
    }
    return words_or_none(all, fine);
}

bool plans_asked_is_same(const json_t *a, const json_t *b)
{
    json_t *of_a = plans_put_asked(NULL, a);
    json_t *of_b = plans_put_asked(NULL, b);
    bool same = of_a && json_equal(of_a, of_b);
    json_decref(of_a);
    json_decref(of_b);
    return same;
}

bool plans_asks(const struct viewer *viewer, conus_constraint_kind kind, uint32_t object)
{
    const struct constraints *asked = &viewer->plan.task.constraints;
    const conus_object *is = conus_atlas_object(viewer->atlases->atlas, object);
    char *quoted = is ? quote(is->name) : NULL;
    bool found = false;
    for (size_t i = 0; i < asked->count && quoted; i++) {
        found = found || (asked->items[i].kind == kind && is_of_name(viewer, asked->items[i].names, is->name, quoted));
    }
    free(quoted);
    return found;
}

/* The structure of a constraint of this kind, the one at *from or behind it; past it then. */
static const char *next_structure(size_t *from, const struct viewer *viewer, conus_constraint_kind kind)
{
    const conus_plan *plan = viewer->plan.live;
    size_t count = conus_plan_constraint_count(plan);
    const char *name = NULL;
    while (*from < count && !name) {
        name = conus_plan_constraint(plan, *from)->kind == kind ? conus_plan_name(plan, *from) : NULL;
        ++*from;
    }
    return name;
}

const char *plans_name(struct viewer *viewer, conus_constraint_kind kind)
{
    size_t from = 0;
    (void)(plans_is_on(viewer) && prepare_live(viewer)); /* where that fails there is no structure */
    return next_structure(&from, viewer, kind);
}

bool plans_is_in(const struct viewer *viewer, conus_constraint_kind kind, uint32_t object)
{
    const conus_plan *plan = viewer->drawn == viewer->atlases ? viewer->plan.live : NULL;
    bool is = false;
    for (size_t i = 0; i < conus_plan_constraint_count(plan) && !is; i++) {
        is = conus_plan_constraint(plan, i)->kind == kind && conus_plan_is_about(plan, i, object);
    }
    return is;
}

/* Less is better of `up`: then it is rounded up. */
static const char *round_number(char out[PLAN_NUMBER], double value, bool up)
{
    double scale = fabs(value) < 1 ? 100 : 10;
    double digits = value * scale;
    double nearest = round(digits); /* leeways are known to 1e-6 mm, from below */
    double shown = fabs(digits - nearest) < 1e-5 * scale ? nearest : up ? ceil(digits) : floor(digits);
    snprintf(out, PLAN_NUMBER, scale > 10 ? "%.2f" : "%.1f", shown / scale + 0.0);
    return out;
}

const char *plans_number(char out[PLAN_NUMBER], double value)
{
    return isfinite(value) ? round_number(out, value, false) : "-";
}

static void put_number(FILE *out, double value, bool up)
{
    char text[PLAN_NUMBER];
    fputs(round_number(text, value, up), out);
}

/* "1.2 of 2 mm to ": the limit stands there where it is broken. */
static void put_measure(FILE *out, const conus_verdict *verdict, double value, double limit, double unit, bool at_most,
                        const char *what)
{
    put_number(out, value / unit, at_most);
    if (!verdict->holds) {
        fprintf(out, " of %s%.6g", at_most ? "at most " : "", limit / unit);
    }
    fputs(what, out);
}

/* Words what was measured for a constraint: "1.2 of 2 mm to Insula_L", "3.8 mm to Insula_L". */
static void put_verdict(FILE *out, const struct viewer *viewer, const conus_planned *planned, size_t index)
{
    static const struct {
        double unit; /* 0: it is or it is not */
        const char *what;
    } measures[] = {[CONUS_MEASURE_LENGTH] = {1, " mm in "},
                    [CONUS_MEASURE_TIP] = {0, "the tip in "},
                    [CONUS_MEASURE_CROSSED] = {0, "through "},
                    [CONUS_MEASURE_CONTACTS] = {1, " contacts in "},
                    [CONUS_MEASURE_PROBABILITY] = {0.01, " % probability of "},
                    [CONUS_MEASURE_SHARE] = {0.01, " % of the cone on "},
                    [CONUS_MEASURE_PIERCED] = {0.01, " % of the pixels through "},
                    [CONUS_MEASURE_VOLUME] = {1, " mm\u00b3 of "},
                    [CONUS_MEASURE_FRACTION] = {0.01, " % of "},
                    [CONUS_MEASURE_STREAMLINES] = {1, " streamlines of "}};
    const struct plan_state *state = &viewer->plan;
    const conus_constraint *asked = conus_plan_constraint(state->live, index);
    const conus_verdict *verdict = &planned->verdicts[index];
    const char *name = conus_plan_name(state->live, index);
    double clearance = verdict->value - state->made_with.radius;
    switch (asked->kind) {
    case CONUS_CONSTRAINT_REACH:
    case CONUS_CONSTRAINT_AVOID:
        if (asked->kind == CONUS_CONSTRAINT_AVOID && !asked->measure) {
            name = plan_nearest(state->live, viewer->atlases->atlas, planned, index);
            if (clearance > 0) {
                put_measure(out, verdict, clearance, asked->limit, 1, false, " mm to ");
            } else {
                fputs("touches ", out);
            }
        } else if (!verdict->holds && !asked->measure && verdict->value == 0) {
            fputs("not in ", out);
        } else if ((size_t)asked->measure < sizeof measures / sizeof measures[0]) {
            const double unit = measures[asked->measure].unit;
            const char *what = measures[asked->measure].what;
            if (unit > 0) {
                put_measure(out, verdict, verdict->value, asked->limit, unit, asked->kind == CONUS_CONSTRAINT_AVOID,
                            what);
            } else {
                fprintf(out, "%s%s", verdict->holds ? "" : "not ", what);
            }
        }
        fputs(name, out);
        break;
    case CONUS_CONSTRAINT_LENGTH:
        fprintf(out, "%.1f mm long, %.6g to %.6g asked", verdict->value, asked->limit, asked->most);
        break;
    case CONUS_CONSTRAINT_APART:
        put_measure(out, verdict, verdict->value, asked->limit, 1, false, " mm to another needle");
        break;
    case CONUS_CONSTRAINT_FIRST:
        fprintf(out, "%s %s first", verdict->holds ? "passes" : "does not pass", name);
        break;
    default:
        put_measure(out, verdict, verdict->value, asked->limit, 1, true, "\u00b0 of lean");
    }
}

static void take_text(char *out, size_t size, struct system_text *text)
{
    const char *whole = system_text_close(text);
    snprintf(out, size, "%s", whole ? whole : "");
    free(text->data);
}

/* All that is to be reached, or the first that is not. */
static void put_reached(FILE *out, const struct viewer *viewer, const conus_planned *planned)
{
    const conus_plan *plan = viewer->plan.live;
    const char *missed = NULL;
    for (size_t i = 0; i < conus_plan_constraint_count(plan) && !missed; i++) {
        bool is_reach = conus_plan_constraint(plan, i)->kind == CONUS_CONSTRAINT_REACH;
        missed = is_reach && !planned->verdicts[i].holds ? conus_plan_name(plan, i) : NULL;
    }
    if (missed) {
        fprintf(out, "Does not reach %s", missed);
        return;
    }
    const char *name;
    const char *before = "Reaches ";
    for (size_t from = 0; (name = next_structure(&from, viewer, CONUS_CONSTRAINT_REACH));) {
        fprintf(out, "%s%s", before, name);
        before = ", ";
    }
}

/* How far the needle is from what it is nearest to, of all that it is to be clear of. */
static void put_cleared(FILE *out, const struct viewer *viewer, const conus_planned *planned)
{
    const conus_plan *plan = viewer->plan.live;
    size_t count = conus_plan_constraint_count(plan);
    size_t nearest = count;
    for (size_t i = 0; i < count; i++) {
        const conus_constraint *asked = conus_plan_constraint(plan, i);
        bool is_nearer = nearest == count || planned->verdicts[i].value < planned->verdicts[nearest].value;
        nearest = asked->kind == CONUS_CONSTRAINT_AVOID && !asked->measure && is_nearer ? i : nearest;
    }
    if (nearest == count) {
        return;
    }
    double clearance = planned->verdicts[nearest].value - viewer->plan.made_with.radius;
    if (clearance > 0) {
        put_number(out, clearance, false);
    }
    fprintf(out, "%s%s", clearance > 0 ? " mm from " : "touches ",
            plan_nearest(plan, viewer->atlases->atlas, planned, nearest));
}

/* "holds, 1.8 mm to Insula_L" and ", may be off by 0.66 mm", or "breaks: 1.2 of 2 mm to Insula_L, and 1 more" */
static void word(struct plan_verdict *out, const struct viewer *viewer, const conus_planned *planned)
{
    size_t count = conus_plan_constraint_count(viewer->plan.live);
    size_t told = !planned->feasible ? planned->broken : planned->clearance_of < count ? planned->clearance_of : 0;
    size_t broken = 0;
    struct system_text texts[5];
    FILE *text = system_text_open(&texts[0]);
    FILE *details = system_text_open(&texts[1]);
    FILE *leeway = system_text_open(&texts[2]);
    FILE *reached = system_text_open(&texts[3]);
    FILE *cleared = system_text_open(&texts[4]);
    for (size_t i = 0; i < count && details; i++) {
        broken += !planned->verdicts[i].holds;
        fprintf(details, "%s%s: ", i ? "\n" : "", planned->verdicts[i].holds ? "holds" : "breaks");
        put_verdict(details, viewer, planned, i);
    }
    if (text) {
        fputs(planned->feasible ? "holds, " : "breaks: ", text);
        put_verdict(text, viewer, planned, told);
        if (broken > 1) {
            fprintf(text, ", and %zu more", broken - 1);
        } else if (leeway && !broken && !isnan(planned->leeway)) {
            fputs(", may be off by ", leeway);
            put_number(leeway, planned->leeway, false);
            fputs(" mm", leeway);
        }
    }
    if (reached && cleared) {
        put_reached(reached, viewer, planned);
        put_cleared(cleared, viewer, planned);
    }
    take_text(out->text, sizeof out->text, &texts[0]);
    take_text(out->details, sizeof out->details, &texts[1]);
    take_text(out->leeway, sizeof out->leeway, &texts[2]);
    take_text(out->reaches, sizeof out->reaches, &texts[3]);
    take_text(out->clears, sizeof out->clears, &texts[4]);
    out->state = planned->feasible ? PLAN_HOLDS : PLAN_BREAKS;
}

/* What a cone without an end, such as a coil's or a transducer's, hits of each structure that is asked for: "62 % of
 * the cone on Precentral_L". With all depths it may lie behind others. With a level areas have no answer of their own.
 */
static void judge_cone(struct plan_verdict *out, const struct viewer *viewer)
{
    const conus_plan *plan = viewer->plan.live;
    const conus_selection *selection = view_atlas_selection(viewer->atlases, FIRST_TOOL);
    struct system_text written;
    if (viewer->cone.level[0]) {
        snprintf(out->text, sizeof out->text, "not judged: the level has areas as one");
        return;
    }
    FILE *text = system_text_open(&written);
    const char *before = "";
    for (size_t i = 0; i < conus_plan_constraint_count(plan) && text; i++) {
        const conus_constraint_kind kind = conus_plan_constraint(plan, i)->kind;
        double share = 0;
        bool is_in_cone = false;
        for (size_t k = 0; k < conus_selection_count(selection); k++) {
            const conus_result *result = conus_selection_result(selection, k);
            const bool is = conus_plan_is_about(plan, i, result->object);
            share += is ? result->share : 0;
            is_in_cone = is_in_cone || is;
        }
        if (kind == CONUS_CONSTRAINT_REACH || kind == CONUS_CONSTRAINT_AVOID) {
            char part[SHARE_TEXT] = "0 %";
            if (share > 0) {
                headline_share(part, share < 1 - ROUNDED ? share : 1);
            }
            fprintf(text, "%s%s of the %s on %s%s", before, part, viewer_shape(viewer), conus_plan_name(plan, i),
                    is_in_cone && !(share > 0) ? ", which lies behind" : "");
            before = ", ";
        }
    }
    take_text(out->text, sizeof out->text, &written);
    snprintf(out->details, sizeof out->details, "lengths and margins are not judged: it has no depth");
}

/* Finds what is asked of an area that the atlas does not show, or does not have any more. */
static void find_lost(struct plan_verdict *out, const struct viewer *viewer)
{
    const struct plan_state *state = &viewer->plan;
    for (size_t i = 0; i < state->task.constraints.count && state->selector && !out->lost; i++) {
        const conus_constraint *asked = &state->task.constraints.items[i];
        conus_plan *alone = NULL;
        const conus_status status = asked->kind <= CONUS_CONSTRAINT_AVOID
                                        ? conus_plan_create(&alone, state->selector, asked, 1, NULL)
                                        : CONUS_OK;
        if (status && status != CONUS_ERROR_MEMORY) {
            out->lost = asked;
        }
        conus_plan_destroy(alone);
    }
}

/* Judges the tool as it is now. */
static void judge(struct plan_verdict *out, struct viewer *viewer)
{
    const struct tool *tool = &viewer->tools[FIRST_TOOL];
    const double *range = viewer->cone.options.range;
    const conus_planned *planned = NULL;
    *out = (struct plan_verdict){.state = PLAN_UNKNOWN};
    const bool has_axis = tool_has_cone(viewer, FIRST_TOOL);
    conus_status status = prepare_live(viewer); /* what is lost is said before there is a needle, too */
    const bool is_of_list =
        viewer->chosen_point || tool->pointer == POINT_BY_REPLAY; /* which has the depths of needles */
    if (!status && has_axis && !(range[1] > 0) && is_of_list) {
        judge_cone(out, viewer);
        return;
    }
    if (!status && (!has_axis || !(range[1] > 0))) {
        snprintf(out->text, sizeof out->text, "%s",
                 !has_axis ? "no pose yet: point at the brain" : "no depth yet: F5 sets the tip");
        return;
    }
    conus_pose_row row = {.id = "",
                          .pose = tool->pose,
                          .angle = viewer->cone.options.radius > 0 ? 0 : tool->angle,
                          .range = {range[0], range[1]}};
    conus_frame_turn_pose(&row.pose, &viewer->frame, true);
    status = status ? status : conus_plan_try(&planned, viewer->plan.live, &row);
    if (status) {
        out->state = PLAN_FAILED;
        snprintf(out->text, sizeof out->text, "not judged: %s",
                 status == CONUS_ERROR_MEMORY ? "not enough memory" : conus_message());
        find_lost(out, viewer);
    } else {
        word(out, viewer, planned);
    }
}

const struct plan_verdict *plans_verdict(struct viewer *viewer)
{
    struct plan_state *state = &viewer->plan;
    unsigned now = viewer->tools[FIRST_TOOL].answer_number;
    if (!state->judged || state->judged_after != now) {
        judge(&state->verdict, viewer);
        state->judged = true;
        state->judged_after = now;
    }
    return &state->verdict;
}

void plans_line(char out[PLAN_LINE], struct viewer *viewer, bool with_leeway)
{
    const struct tool *tool = &viewer->tools[FIRST_TOOL];
    const struct plan_verdict *verdict = plans_verdict(viewer);
    bool is_elsewhere = tool->held && tool->pointer == POINT_BY_TRACKER;
    snprintf(out, PLAN_LINE, "%s%s%s", is_elsewhere ? "held, not tracked: " : "", verdict->text,
             with_leeway ? verdict->leeway : "");
}

bool plans_has_needle(struct viewer *viewer)
{
    const struct plan_verdict *verdict = plans_is_on(viewer) ? plans_verdict(viewer) : NULL;
    return verdict && (verdict->reaches[0] || verdict->clears[0]);
}

void plans_keep(struct viewer *viewer)
{
    const struct plan_verdict *verdict = plans_verdict(viewer);
    const double *m = viewer->tools[FIRST_TOOL].pose.world_from_device;
    const double *range = viewer->cone.options.range;
    struct pin pin = {.share = NAN, .distance = range[1]};
    snprintf(pin.name, sizeof pin.name, "needle: %s%s%s", verdict->reaches,
             verdict->reaches[0] && verdict->clears[0] ? ", " : "", verdict->clears);
    for (int a = 0; a < 3; a++) {
        pin.entry[a] = m[12 + a] - range[0] * m[8 + a];
        pin.contact[a] = m[12 + a] - range[1] * m[8 + a];
    }
    viewer_pin(viewer, pin);
    viewer_say(viewer, "kept: %s", pin.name);
}

static void find_question(struct study_question *out, const struct viewer *viewer)
{
    const struct plan_state *state = &viewer->plan;
    *out = (struct study_question){
        .settings = state->list.settings,
        .options = {.engine = CONUS_ENGINE_RAYS, .radius = viewer->cone.options.radius, .range = {0, state->depth}},
        .frame = viewer->frame,
        .atlas_number = viewer->atlas_number,
        .plan = &state->task};
}

void plans_step(struct viewer *viewer)
{
    struct study_state *list = &viewer->plan.list;
    studies_take(viewer, list);
    if (list->settings.kind == STUDY_PLAN) {
        struct study_question now;
        find_question(&now, viewer);
        studies_ask(viewer, list, &now);
    }
}

bool plans_is_behind(const struct viewer *viewer)
{
    const struct study_state *list = &viewer->plan.list;
    struct study_question now;
    find_question(&now, viewer);
    return list->settings.kind == STUDY_PLAN && !(list->answer && study_is_same(&now, &list->answer->question));
}

/* What to do in the window where no candidates were given. */
static const char *find_next_step(const struct viewer *viewer)
{
    const bool has_points = viewer->points.count;
    return plans_is_on(viewer) ? (has_points ? "choose a row in Points, or aim by hand: the answer above judges it; F5 "
                                               "sets a needle's depth"
                                             : "aim by hand, or open a file of needles or coils (Ctrl+O) and choose a "
                                               "row in Points: the answer above judges it; F5 sets a needle's depth")
                               : (has_points ? "no target yet: choose an area and, under Area, \"Set as target\", or "
                                               "\"Avoid\"; then choose a row in Points"
                                             : "no target yet: choose an area and, under Area, \"Set as target\", or "
                                               "\"Avoid\"; then aim by hand, or open a file of needles or coils "
                                               "(Ctrl+O)");
}

const struct plan_list *plans_list(const struct viewer *viewer, const char **why)
{
    const struct study_state *list = &viewer->plan.list;
    *why = list->settings.kind != STUDY_PLAN ? find_next_step(viewer)
           : !list->answer                   ? "trying the poses"
                                             : list->answer->error;
    return list->answer && list->answer->plan.text ? &list->answer->plan : NULL;
}

size_t plans_at(const struct viewer *viewer)
{
    const char *why;
    const struct plan_list *list = plans_list(viewer, &why);
    const double *range = viewer->cone.options.range;
    for (size_t i = 0; list && viewer->tools[FIRST_TOOL].has_pose && i < list->count; i++) {
        const struct plan_row *row = &list->rows[i];
        if (pose_is_same(&row->pose, &viewer->tools[FIRST_TOOL].pose) && row->range[0] == range[0] &&
            row->range[1] == range[1]) {
            return i;
        }
    }
    return SIZE_MAX;
}

bool plans_go(struct viewer *viewer, size_t index)
{
    const char *why;
    const struct plan_list *list = plans_list(viewer, &why);
    struct tool *tool = &viewer->tools[FIRST_TOOL];
    if (!list || index >= list->count) {
        viewer_say(viewer, "%s", list ? "the plan has no such row" : why);
        return false;
    }
    const struct plan_row *row = &list->rows[index];
    const double *m = row->pose.world_from_device;
    if (!query_set_range(viewer, row->range[0], row->range[1])) {
        return false;
    }
    if (row->angle > 0 && constraints_last_measure(&viewer->plan.task.constraints) >= CONUS_MEASURE_SHARE) {
        tool->angle = row->angle;
    }
    tool->held = true;
    tool_aim(viewer, FIRST_TOOL, &row->pose);
    viewer_cross(viewer,
                 (double[]){m[12] - row->range[1] * m[8], m[13] - row->range[1] * m[9], m[14] - row->range[1] * m[10]});
    viewer_say(viewer, "%zu of the plan: %s, %.1f mm deep; the cuts go through its tip", index + 1, row->id,
               row->range[1]);
    return true;
}
