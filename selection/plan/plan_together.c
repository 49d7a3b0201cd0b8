/* SPDX-License-Identifier: BSD-3-Clause */
/* Plans needles together: has the candidates of each listed as far down as the search asks for, and takes its answer
 * apart (Eq. 25 to 28). */
#include "conus/own.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/order.h"
#include "base/status.h"
#include "base/text.h"
#include "poses/rows/pose_row.h"
#include "selection/plan/plan.h"
#include "selection/plan/together/together.h"
#include "selection/selection.h"

#include <math.h>
#include <string.h>

/* A list has the best of its needle, at first some hundred: those that are no worse than so many of a sample. Then it
 * goes LIST_GROWTH times as far down, up to so many at last. */
enum { SAMPLE_FIRST = 32, LIST_GROWTH = 4, LIST_LAST = 1 << 17, TOP_LIMIT = 100 };

static const uint64_t EFFORT = 100000000;
static const double MARGIN_LIMIT = 100; /* mm */
/* All distances of shafts or entries are between these, nm. */
static const int64_t LOWEST = -1000000000000000;
static const int64_t HIGHEST = 1000000000000000;

/* A question, and those of its candidates that are known. */
struct question_of {
    conus_question asked; /* what it points to is the caller's, until conus_plan_together() returns */
    char *arc;            /* NULL = any */
    struct bodies bodies;
    bool has_leeway;
    bool is_asked; /* a needle that is not given may answer it */
    size_t needles[NEEDLE_LIMIT], needle_count;
    conus_plan *plan;
    struct search_item *items; /* [list.count] */
    struct body_list list;
    struct plan_constraint *covers; /* [cover_count + 1] The last one is of all covers. */
    uint32_t *covered;              /* [list.count][cover_count + 1] */
    bool is_whole, is_full;         /* the list has all that hold, or as many as it may */
    int64_t floor;                  /* else all with so much leeway */
    conus_planned *places;          /* [place_count] those of the answer, in the order of their numbers */
    size_t place_count;
};

struct needle_of {
    char *name;
    size_t questions[QUESTION_LIMIT], question_count;
    bool given, has_leeway; /* has_leeway: all its candidates have one */
    conus_planned place;    /* the one that is given */
    uint32_t covered[COVER_LIMIT + 1];
    struct search_item item;
    struct body_list bodies;
    struct search_item *joined; /* [list.count] of several questions */
    conus_planned *above;       /* [above_count] Its candidates that are not below the cut, once they were asked for. */
    conus_chosen *candidates;   /* [above_count] */
    size_t above_count;
    struct search_list list;
};

/* A combination that is listed. */
struct entry {
    struct search_answer answer; /* its indices into the lists follow its numbers */
    uint64_t numbers[NEEDLE_LIMIT];
    int64_t bound; /* nm */
    uint64_t covered[COVER_LIMIT];
    conus_chosen chosen[NEEDLE_LIMIT];
    struct buffer leeway_of;
    conus_combination combination;
};

struct conus_together {
    struct question_of questions[QUESTION_LIMIT];
    size_t question_count;
    conus_answered answered[QUESTION_LIMIT];
    struct needle_of needles[NEEDLE_LIMIT];
    struct search_list lists[NEEDLE_LIMIT];
    size_t count;
    struct pair_test test;
    conus_together_options options;
    conus_cover covers[COVER_LIMIT]; /* of the options, whose names are its own */
    uint64_t tried, tried_before;
    bool was_cancelled;
    struct entry *entries;          /* [options.top] */
    size_t (*listed)[NEEDLE_LIMIT]; /* [options.top] indices of those that are */
    size_t entry_count;
    bool has_answer, is_best; /* of the next entry; is_best: none of the candidates that are known has more */
    bool is_none;             /* likewise: there is no combination of them */
    uint64_t nodes, limit;    /* the next entry may take so many */
    bool is_searching;
    struct search_answer known; /* of the candidates that are known, as far as the search has got */
    int64_t unknown;            /* nm; less have those that were not when that search began, */
    int64_t bound;              /* and the next entry has no more, so far */
    int64_t cuts[NEEDLE_LIMIT];
    bool has_conflict;
    conus_placed placed[NEEDLE_LIMIT];
    conus_conflict conflict;
    size_t conflicting[NEEDLE_LIMIT];
    double contacts[COVER_LIMIT]; /* of a conflict */
    struct pair_row *pairs;       /* [pair_count] */
    size_t pair_count;
};

static const double NM = 1e-6; /* mm */

static conus_status check_margin(const char *name, double value)
{
    return value >= 0 && value <= MARGIN_LIMIT
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "%s: %g mm, allowed are 0 to %g", name, value, MARGIN_LIMIT);
}

static conus_status check_list(conus_together *together)
{
    conus_together_options *options = &together->options;
    options->top = options->top ? options->top : 1;
    options->differ = options->differ ? options->differ : 1;
    if (options->top > TOP_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "top: %llu combinations, allowed are 1 to %d",
                    (unsigned long long)options->top, TOP_LIMIT);
    }
    if (options->differ > together->count) {
        return fail(CONUS_ERROR_ARGUMENT, "differ: in %llu needles, but there are %zu",
                    (unsigned long long)options->differ, together->count);
    }
    together->entries = memory_zeroed((size_t)options->top, sizeof *together->entries);
    together->listed = memory_zeroed((size_t)options->top, sizeof *together->listed);
    return together->entries && together->listed ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Fills in the defaults. Being on one arc is an equivalence, however little angles are off. */
static conus_status check_arcs(struct arcs *out, conus_together_options *options)
{
    static const double SAME = 0.5, DEGREES = 180, SLACK = 1e-6;
    bool has_other =
        options->slider > 0 || options->same > 0 || options->arcs_most || options->arcs_each || options->pitch != 0;
    if (!options->arcs && has_other) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "arcs: slider, same, arcs_most, arcs_each and pitch have no effect without them");
    }
    options->slider = options->slider ? options->slider : options->arcs;
    options->same = options->same || !options->arcs ? options->same : SAME;
    if (!(options->arcs >= 0 && options->arcs <= DEGREES && options->slider >= 0 && options->slider <= DEGREES &&
          options->same >= 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "arcs: %g degrees, slider %g, same %g, allowed are 0 to %g", options->arcs,
                    options->slider, options->same, DEGREES);
    }
    if (!(fabs(options->pitch) <= DEGREES)) {
        return fail(CONUS_ERROR_ARGUMENT, "arcs: pitch: %g degrees, allowed are -180 to 180", options->pitch);
    }
    if (options->arcs > 0 && !(2 * options->same + SLACK < options->arcs)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "arcs: same: %g degrees, allowed is less than half of the %g between two arcs", options->same,
                    options->arcs);
    }
    *out = (struct arcs){options->arcs, options->slider, options->same, (size_t)options->arcs_most,
                         (size_t)options->arcs_each};
    return CONUS_OK;
}

static conus_status take_covers(conus_together *together)
{
    static const uint64_t MOST = 1000000000;
    struct covers *out = &together->test.covers;
    conus_together_options *options = &together->options;
    if (options->cover_count > COVER_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "covers: %zu, allowed are up to %d", options->cover_count, COVER_LIMIT);
    }
    out->count = options->cover_count;
    for (size_t k = 0; k < out->count; k++) {
        const char *names = options->covers[k].names;
        out->least[k] = options->covers[k].contacts;
        if (!names || out->least[k] > MOST) {
            return fail(CONUS_ERROR_ARGUMENT, "covers: contacts: names and up to %llu contacts are wanted",
                        (unsigned long long)MOST);
        }
        together->covers[k] = (conus_cover){memory_text(names, strlen(names)), out->least[k]};
        if (!together->covers[k].names) {
            return CONUS_ERROR_MEMORY;
        }
    }
    options->covers = together->covers;
    return CONUS_OK;
}

static conus_status check_options(conus_together *together, const conus_together_options *asked)
{
    together->options = *options_of(conus_together_options, asked);
    conus_together_options *options = &together->options;
    options->effort = options->effort ? options->effort : EFFORT;
    together->test.margins =
        (struct margins){.between = options->between, .parts = options->parts, .entries = options->entry_distance};
    conus_status status = check_arcs(&together->test.margins.arcs, options);
    status = status ? status : take_covers(together);
    status = status ? status : check_margin("between", options->between);
    status = status ? status : check_margin("parts", options->parts);
    status = status ? status : check_margin("entry_distance", options->entry_distance);
    return status ? status : check_margin("diverse", options->diverse);
}

static bool show_progress(void *user, size_t done, size_t total);

static conus_status check_plan_options(const conus_plan_options *options)
{
    bool has_other = options->top || options->infeasible || options->rank || options->score || options->progress ||
                     options->entries || options->jitter || options->targets;
    return has_other ? fail(CONUS_ERROR_ARGUMENT, "options: only threads, angle, far and shanks are a question's")
                     : CONUS_OK;
}

static conus_status create_plan(struct question_of *question, conus_together *together)
{
    conus_plan_options options = *options_of(conus_plan_options, question->asked.options);
    options.top = SAMPLE_FIRST;
    options.progress = show_progress;
    options.progress_user = together;
    conus_status status = conus_plan_create(&question->plan, question->asked.selector, question->asked.constraints,
                                            question->asked.constraint_count, &options);
    if (!status) {
        plan_sample(question->plan);
    }
    for (size_t i = 0; i < question->asked.constraint_count && !status; i++) {
        question->has_leeway = question->has_leeway || plan_asked_of(question->plan)->constraints[i].has_leeway;
    }
    return status;
}

/* Finds the structures of covers: of each, and of all. */
static conus_status find_covers(struct question_of *question, const conus_together *together)
{
    const conus_atlas *atlas = question->asked.selector->atlas;
    const size_t count = together->test.covers.count;
    struct buffer all = {0};
    if (!count) {
        return CONUS_OK;
    }
    question->covers = memory_zeroed(count + 1, sizeof *question->covers);
    conus_status status = !question->covers ? CONUS_ERROR_MEMORY
                          : question->asked.contacts.count
                              ? contacts_check(&question->asked.contacts)
                              : fail(CONUS_ERROR_ARGUMENT, "covers: the contacts are not known");
    for (size_t k = 0; k <= count && !status; k++) {
        struct plan_constraint *cover = &question->covers[k];
        const char *names = k < count ? together->options.covers[k].names : all.data;
        if (k < count) {
            buffer_format(&all, "%s%s", k ? "," : "", names);
        }
        status = buffer_status(&all);
        status = status ? status : plan_structure_find(cover, atlas, names, false);
        cover->asked.contacts = question->asked.contacts;
    }
    buffer_finish(&all);
    return status == CONUS_ERROR_ARGUMENT ? fail_in(status, "cover") : status;
}

/* Counts the contacts of a pose in each cover, and in any. */
static conus_status count_covered(uint32_t *out, const struct question_of *question, const conus_planned *pose,
                                  size_t count)
{
    struct plan_judge *judge = plan_judge_of(question->plan);
    conus_status status = CONUS_OK;
    plan_judge_turn(judge, pose);
    for (size_t k = 0; k <= count && question->covers && !status; k++) {
        status = plan_judge_contacts(&out[k], judge, &question->covers[k]);
    }
    return status;
}

static void finish_list(struct question_of *question)
{
    memory_free(question->covered);
    question->covered = NULL;
    memory_free(question->items);
    body_list_finish(&question->list);
    question->items = NULL;
}

static struct search_item item_of(const conus_planned *pose, uint64_t number, size_t index)
{
    return (struct search_item){.leeway = isnan(pose->leeway) ? 0 : nanometres(pose->leeway),
                                .depth = nanometres(pose->far),
                                .number = number,
                                .index = index};
}

/* Takes the poses that its plan lists, those with so much leeway. */
static conus_status take_list(struct question_of *question, int64_t least, size_t covers)
{
    size_t count = conus_plan_count(question->plan);
    finish_list(question);
    question->items = memory_zeroed(count, sizeof *question->items);
    question->covered = memory_zeroed(count, (covers + 1) * sizeof *question->covered);
    conus_status status = question->items && question->covered
                              ? body_list_init(&question->list, &question->bodies, count)
                              : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        const conus_planned *pose = conus_plan_pose(question->plan, i);
        question->items[i] = item_of(pose, pose->candidate, i);
        question->items[i].covered = question->covered + i * (covers + 1);
        status = count_covered(question->covered + i * (covers + 1), question, pose, covers);
    }
    question->is_full = count == LIST_LAST;
    /* What a full list leaves out may have as much as its last one. */
    question->floor = question->is_full && !status ? question->items[count - 1].leeway + 1 : least;
    question->is_whole = conus_plan_left(question->plan, conus_plan_constraint_count(question->plan)) == count;
    if (!status) {
        order_sort(question->items, count, sizeof *question->items, search_item_compare);
    }
    for (size_t i = 0; i < count && !status; i++) {
        body_list_set(&question->list, i, conus_plan_pose(question->plan, question->items[i].index));
        question->items[i].index = i;
    }
    plan_forget_list(question->plan);
    return status;
}

static void close_candidates(conus_pose_stream *stream, const struct question_of *question)
{
    if (question->asked.close && stream) {
        question->asked.close(stream, question->asked.user);
    } else {
        conus_pose_stream_destroy(stream);
    }
}

/* Lists all candidates with so much leeway. */
static conus_status list_down_to(struct question_of *question, int64_t least, size_t covers)
{
    conus_pose_stream *stream = NULL;
    conus_status status = question->asked.open(&stream, question->asked.user);
    status = status ? status : plan_list_again(question->plan, stream, least, LIST_LAST);
    close_candidates(stream, question);
    return status ? status : take_list(question, least, covers);
}

/* Judges all candidates, and lists the best of them. */
static conus_status begin_list(struct question_of *question, conus_together *together)
{
    conus_pose_stream *stream = NULL;
    conus_status status = question->asked.open(&stream, question->asked.user);
    status = status ? status : conus_plan_run(question->plan, stream, UINT64_MAX);
    close_candidates(stream, question);
    const conus_planned *last = status ? NULL : conus_plan_pose(question->plan, SAMPLE_FIRST - 1);
    status = status ? status
                    : list_down_to(question, last && !isnan(last->leeway) ? nanometres(last->leeway) : 0,
                                   together->test.covers.count);
    together->tried_before += status ? 0 : conus_plan_left(question->plan, 0);
    return status;
}

/* Lists more candidates: LIST_GROWTH times as far down, but not below the cut. */
static conus_status extend_list(struct question_of *question, int64_t cut, size_t covers)
{
    int64_t largest = question->list.count ? question->items[0].leeway : 0;
    int64_t way = largest - question->floor > largest / 16 ? largest - question->floor : largest / 16 + 1;
    int64_t least = largest - LIST_GROWTH * way;
    return list_down_to(question, !question->has_leeway ? 0 : least > cut ? least : cut, covers);
}

/* Joins the lists of a needle's questions; of a given needle there is only its place. */
static conus_status join_lists(conus_together *together, size_t index)
{
    struct needle_of *needle = &together->needles[index];
    struct search_list *list = &needle->list;
    uint64_t before = 0;
    size_t count = 0;
    list->part_count = needle->given ? 1 : needle->question_count;
    needle->has_leeway = true;
    for (size_t p = 0; p < list->part_count; p++) {
        const struct question_of *question = &together->questions[needle->questions[p]];
        list->parts[p] = (struct search_part){needle->given ? &needle->bodies : &question->list, needle->questions[p],
                                              question->asked.once, question->has_leeway};
        needle->has_leeway = needle->has_leeway && question->has_leeway;
        count += list->parts[p].bodies->count;
    }
    list->count = count;
    list->items = needle->given ? &needle->item : together->questions[needle->questions[0]].items;
    if (list->part_count == 1) {
        return CONUS_OK;
    }
    memory_free(needle->joined);
    list->items = needle->joined = memory_zeroed(count, sizeof *needle->joined);
    count = 0;
    for (size_t p = 0; p < list->part_count && needle->joined; p++) {
        const struct question_of *question = &together->questions[needle->questions[p]];
        for (size_t i = 0; i < question->list.count; i++) {
            struct search_item *item = &needle->joined[count++];
            *item = question->items[i];
            item->number += before;
            item->part = (uint32_t)p;
        }
        before += conus_plan_left(question->plan, 0);
    }
    if (needle->joined) {
        order_sort(needle->joined, count, sizeof *needle->joined, search_item_compare);
    }
    return needle->joined ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status join_all(conus_together *together)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < together->count && !status; i++) {
        status = join_lists(together, i);
    }
    return status;
}

static int compare_places(const void *a, const void *b)
{
    return compare_unsigned(((const conus_planned *)a)->candidate, ((const conus_planned *)b)->candidate);
}

/* The question that a needle answers in an entry, and the number of its candidate there. */
static struct question_of *answered_by(uint64_t *number, conus_together *together, const struct entry *entry,
                                       size_t needle)
{
    const struct search_list *list = &together->needles[needle].list;
    const struct search_item *item = &list->items[entry->answer.chosen[needle]];
    struct question_of *question = &together->questions[list->parts[item->part].question];
    *number = together->needles[needle].given ? 0 : question->items[item->index].number;
    return question;
}

/* Notes the places of a question in all entries. */
static conus_status note_places(conus_together *together, struct question_of *question)
{
    question->places = memory_zeroed(together->entry_count * together->count, sizeof *question->places);
    for (size_t i = 0; question->places && i < together->entry_count * together->count; i++) {
        uint64_t number;
        const struct entry *entry = &together->entries[i / together->count];
        if (answered_by(&number, together, entry, i % together->count) == question && number) {
            question->places[question->place_count++].candidate = number;
        }
    }
    if (question->places) {
        order_sort(question->places, question->place_count, sizeof *question->places, compare_places);
    }
    return question->places ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Finds them, all in one reading of the candidates. */
static conus_status find_places(conus_together *together, struct question_of *question)
{
    conus_pose_stream *stream = NULL;
    conus_status status = note_places(together, question);
    if (!status && question->place_count) {
        status = question->asked.open(&stream, question->asked.user);
        status = status ? status : plan_find(question->places, question->place_count, question->plan, stream, false);
        close_candidates(stream, question);
    }
    return status;
}

static const conus_planned *place_of(conus_together *together, const struct entry *entry, size_t needle)
{
    uint64_t number;
    const struct question_of *question = answered_by(&number, together, entry, needle);
    const conus_planned *place = question->places;
    while (number && place->candidate != number) {
        place++;
    }
    return number ? place : &together->needles[needle].place;
}

/* Whether a place is as it was when it was listed. */
static bool is_same(const conus_planned *place, const struct search_item *item)
{
    const struct search_item now = item_of(place, 0, 0);
    return place->id && place->feasible && now.depth == item->depth && now.leeway == item->leeway;
}

static conus_status fail_changed(const struct needle_of *needle)
{
    return fail(CONUS_ERROR_DATA, "%s: its candidates are others when they are read again", needle->name);
}

static conus_status place_given(struct needle_of *needle, conus_together *together, const conus_pose_row *given)
{
    const size_t covers = together->test.covers.count;
    struct question_of *question = &together->questions[needle->questions[0]];
    conus_pose_row row = *given;
    const conus_planned *place = NULL;
    row.id = needle->name;
    conus_status status = conus_plan_try(&place, question->plan, &row);
    status = status ? status : plan_copy(&needle->place, question->plan, place);
    status = status ? status : body_list_init(&needle->bodies, &question->bodies, 1);
    if (!status) {
        body_list_set(&needle->bodies, 0, &needle->place);
        needle->item = item_of(&needle->place, 1, 0);
        needle->item.covered = needle->covered;
        status = count_covered(needle->covered, question, &needle->place, covers);
    }
    return status;
}

/* The number of the needle of a name; their number = there is none. */
static size_t find_needle(const conus_together *together, struct text name)
{
    size_t i = 0;
    while (i < together->count && !text_equal(name, together->needles[i].name)) {
        i++;
    }
    return i;
}

static conus_status add_needle(conus_together *together, struct text name)
{
    struct needle_of *made = &together->needles[together->count];
    made->name = memory_text(name.data, name.size);
    together->count += made->name != NULL;
    return made->name ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Reads which needles may answer a question: "A, B" */
static conus_status name_needles(conus_together *together, size_t index)
{
    struct question_of *question = &together->questions[index];
    const char *all = question->asked.needles;
    struct text rest = text_from(all);
    struct text name;
    conus_status status = CONUS_OK;
    for (bool more = true; !status && text_field(&rest, ',', &more, &name);) {
        name = text_trim(name);
        const size_t needle = find_needle(together, name);
        struct needle_of *named = &together->needles[needle];
        status = !name.size               ? fail(CONUS_ERROR_ARGUMENT, "needles: \"%s\": a needle without a name", all)
                 : needle == NEEDLE_LIMIT ? fail(CONUS_ERROR_ARGUMENT, "needles: more than %d", NEEDLE_LIMIT)
                 : needle == together->count ? add_needle(together, name)
                 : named->questions[named->question_count - 1] == index
                     ? fail(CONUS_ERROR_ARGUMENT, "needles: \"%s\": %s is named twice", all, named->name)
                     : CONUS_OK;
        if (!status) {
            named->questions[named->question_count++] = index;
            question->needles[question->needle_count++] = needle;
        }
    }
    return status;
}

/* The number of a question's arc: equal texts have the same one, 0 = any. */
static size_t arc_of(const conus_together *together, const char *arc)
{
    size_t number = 0;
    if (arc && *arc) {
        while (number < together->question_count &&
               !(together->questions[number].arc && strcmp(together->questions[number].arc, arc) == 0)) {
            number++;
        }
        number++;
    }
    return number;
}

static conus_status init_question(conus_together *together, const conus_question *asked)
{
    struct question_of *out = &together->questions[together->question_count];
    const conus_plan_options options = *options_of(conus_plan_options, asked->options);
    out->asked = *asked;
    out->asked.needles = asked->needles ? asked->needles : "";
    const size_t arc = arc_of(together, asked->arc);
    conus_status status = name_needles(together, together->question_count);
    out->arc = arc ? memory_text(asked->arc, strlen(asked->arc)) : NULL;
    together->question_count++;
    status = status || out->arc || !arc ? status : CONUS_ERROR_MEMORY;
    if (status) {
        return status;
    }
    status = check_plan_options(&options);
    status = status ? status
                    : bodies_init(&out->bodies, asked->selector->options.radius, options.shanks, options.shank_count,
                                  asked->parts, asked->part_count);
    out->bodies.frame = &together->questions[0].asked.selector->frame;
    out->bodies.arc = arc;
    status = status ? status : create_plan(out, together);
    status = status ? status : find_covers(out, together);
    return status == CONUS_ERROR_ARGUMENT ? fail_in(status, out->asked.needles) : status;
}

/* Takes the places of needles that are given. */
static conus_status take_given(conus_together *together)
{
    conus_status status = CONUS_OK;
    for (size_t n = 0; n < together->options.given_count && !status; n++) {
        const conus_pose_row *row = &together->options.given[n];
        const size_t i = find_needle(together, text_from(row->id));
        if (i == together->count || together->needles[i].given) {
            return fail(CONUS_ERROR_ARGUMENT,
                        i == together->count ? "given: %s is no needle" : "given: %s is given twice", row->id);
        }
        together->needles[i].given = true;
        status = place_given(&together->needles[i], together, row);
        status = status == CONUS_ERROR_ARGUMENT ? fail_in(status, row->id) : status;
    }
    return status;
}

/* Whether two frames call the same ways right, anterior and dorsal. */
static bool have_same_axes(const conus_frame *frame, const conus_frame *other)
{
    static const double ROUNDED = 1e-12; /* half of a square */
    bool are = true;
    for (size_t a = 0; a < 3; a++) {
        double ways[2][3];
        const double axis[3] = {a == 0, a == 1, a == 2};
        direction_to_anatomical(ways[0], axis, frame);
        direction_to_anatomical(ways[1], axis, other);
        are = are && vec3_normalise(ways[0], ways[0]) && vec3_normalise(ways[1], ways[1]) &&
              vec3_dot(ways[0], ways[1]) > 1 - ROUNDED;
    }
    return are;
}

/* Angles of arcs are in the axes of one frame. */
static conus_status check_axes(const conus_together *together)
{
    const bool has_arcs = together->options.arcs > 0;
    for (size_t q = 1; q < together->question_count && has_arcs; q++) {
        const conus_question *asked = &together->questions[q].asked;
        if (!have_same_axes(together->questions[0].bodies.frame, &asked->selector->frame)) {
            return fail(CONUS_ERROR_ARGUMENT, "arcs: %s: its space has other axes than that of %s", asked->needles,
                        together->questions[0].asked.needles);
        }
    }
    return CONUS_OK;
}

/* Finds needles that are alike, and lists what is asked of those that are not given. */
static conus_status begin_needles(conus_together *together)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < together->count; i++) {
        struct needle_of *needle = &together->needles[i];
        needle->list.kin = i;
        for (size_t k = 0; k < i && !needle->given && needle->list.kin == i; k++) {
            const struct needle_of *other = &together->needles[k];
            bool is_alike =
                !other->given && other->question_count == needle->question_count &&
                memcmp(other->questions, needle->questions, needle->question_count * sizeof *needle->questions) == 0;
            needle->list.kin = is_alike ? k : i;
        }
        for (size_t q = 0; q < needle->question_count && !needle->given; q++) {
            together->questions[needle->questions[q]].is_asked = true;
        }
    }
    for (size_t q = 0; q < together->question_count && !status; q++) {
        struct question_of *question = &together->questions[q];
        status = !question->is_asked ? CONUS_OK
                 : question->asked.open
                     ? begin_list(question, together)
                     : fail(CONUS_ERROR_ARGUMENT, "open: there is none, and the needle is not given");
        status = status == CONUS_ERROR_ARGUMENT ? fail_in(status, question->asked.needles) : status;
    }
    return status ? status : join_all(together);
}

static conus_status init_questions(conus_together *together, const conus_question *questions, size_t count)
{
    if (!count || count > QUESTION_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "questions: %zu, allowed are 1 to %d", count, QUESTION_LIMIT);
    }
    size_t size = questions[0].struct_size ? questions[0].struct_size : sizeof *questions;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        const conus_question asked = *options_of(conus_question, (const char *)questions + i * size);
        status = init_question(together, &asked);
    }
    return status;
}

/* The largest leeway of a needle's candidates. */
static int64_t largest_of(const struct needle_of *needle)
{
    return needle->list.count ? needle->list.items[0].leeway : 0;
}

/* What no least leeway exceeds. */
static int64_t most_of_all(const conus_together *together)
{
    int64_t most = nanometres(INFINITY);
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        most = needle->has_leeway && largest_of(needle) < most ? largest_of(needle) : most;
    }
    return most;
}

/* The entry that is looked for. */
static struct entry *next_entry(conus_together *together)
{
    return &together->entries[together->entry_count];
}

/* What the least leeway of the next entry does not exceed. */
static int64_t most_of_next(const conus_together *together)
{
    int64_t most = most_of_all(together);
    int64_t before = together->entry_count ? together->entries[together->entry_count - 1].bound : INT64_MAX;
    return before < most ? before : most;
}

static double known_mm(int64_t nm)
{
    return nm >= 0 && nm < HIGHEST ? NM * (double)nm : NAN;
}

/* Notes what none exceeds that may be the next entry: of candidates that are known, and of others. */
static void shrink_bound(conus_together *together)
{
    const struct search_answer *known = &together->known;
    int64_t most = known->found && known->least > known->most ? known->least : known->most;
    most = most > together->unknown ? most : together->unknown;
    together->bound = most < together->bound ? most : together->bound;
}

static void tell_so_far(conus_so_far *out, conus_together *together)
{
    const bool is_better = together->has_answer && next_entry(together)->answer.least > together->known.least;
    const int64_t known = together->known.found ? together->known.least : -1;
    *out = (conus_so_far){0, NAN, NAN};
    if (together->is_searching) {
        *out =
            (conus_so_far){together->entry_count + 1, known_mm(is_better ? next_entry(together)->answer.least : known),
                           known_mm(together->bound)};
    }
}

/* Told by the search, which tries nothing, and by plans. */
static bool show_progress(void *user, size_t done, size_t total)
{
    conus_together *together = user;
    const conus_together_options *options = &together->options;
    (void)total;
    if (together->is_searching) {
        shrink_bound(together);
    }
    if (options->so_far) {
        tell_so_far(options->so_far, together);
    }
    together->tried = done ? together->tried_before + done : together->tried;
    together->was_cancelled =
        together->was_cancelled ||
        (options->progress && !options->progress(options->progress_user, (size_t)together->tried, 0));
    return !together->was_cancelled;
}

/* Below it no candidate of a needle is in a combination that is as good as the next entry (Eq. 28). */
static void find_cuts(conus_together *together)
{
    const struct search_answer *answer = &next_entry(together)->answer;
    int64_t sum = 0;
    int64_t all = 0;
    for (size_t i = 0; i < together->count; i++) {
        all += largest_of(&together->needles[i]);
        sum += together->has_answer ? together->needles[i].list.items[answer->chosen[i]].leeway : 0;
    }
    /* Until none can have a larger least leeway, all that have more than the answer's may be in one that has. */
    bool is_largest = together->has_answer && answer->least >= most_of_all(together);
    for (size_t i = 0; i < together->count; i++) {
        int64_t by_sum = together->has_answer ? sum - (all - largest_of(&together->needles[i])) : 0;
        int64_t by_least = together->has_answer ? answer->least : 0;
        int64_t cut = by_sum > by_least ? by_sum : by_least;
        together->cuts[i] = is_largest || cut <= by_least ? cut : by_least + 1;
    }
}

/* Whether a question may have candidates above a cut that are not known. */
static bool lacks_above(const struct question_of *question, int64_t cut)
{
    return !question->is_whole && (!question->has_leeway || question->floor > cut);
}

static bool lacks_candidates(const conus_together *together, size_t index)
{
    const struct needle_of *needle = &together->needles[index];
    bool lacks = false;
    for (size_t q = 0; q < needle->question_count && !needle->given; q++) {
        lacks = lacks || lacks_above(&together->questions[needle->questions[q]], together->cuts[index]);
    }
    return lacks;
}

/* Begins a search among the candidates that are known, which may take so many nodes in all. */
static conus_status begin_search(struct search **out, conus_together *together, uint64_t limit)
{
    const struct search_variety variety = {.chosen = (const size_t(*)[NEEDLE_LIMIT])together->listed,
                                           .count = together->entry_count,
                                           .apart = together->options.diverse,
                                           .differ = (size_t)together->options.differ};
    for (size_t i = 0; i < together->count; i++) {
        together->lists[i] = together->needles[i].list;
    }
    uint64_t left = together->nodes < limit ? limit - together->nodes : 0;
    return joint_create(out, together->lists, together->count, &variety, left, show_progress, together);
}

/* Searches among the candidates that are known. */
static conus_status search_known(conus_together *together)
{
    struct search *search = NULL;
    struct search_answer *answer = &together->known;
    bool is_best = false;
    struct entry *entry = next_entry(together);
    const uint32_t all = (1U << together->count) - 1;
    *answer = (struct search_answer){.most = INT64_MAX};
    together->unknown = 0;
    for (size_t q = 0; q < together->question_count; q++) {
        const struct question_of *question = &together->questions[q];
        int64_t floor = question->has_leeway ? question->floor : INT64_MAX;
        bool is_more = question->is_asked && !question->is_whole && floor > together->unknown;
        together->unknown = is_more ? floor : together->unknown;
    }
    conus_status status = begin_search(&search, together, together->limit);
    status = status ? status : joint_least(answer, search, all, &together->test, most_of_next(together));
    bool is_least = answer->found && answer->least == answer->most;
    if (!status && answer->found) {
        status = joint_best(answer, &is_best, search, &together->test);
    }
    if (answer->found && (!status || status == CONUS_ERROR_CANCELLED)) {
        entry->answer = *answer;
        together->has_answer = true;
        for (size_t i = 0; i < together->count; i++) {
            entry->numbers[i] = together->needles[i].list.items[answer->chosen[i]].number;
        }
    }
    together->is_best = !status && is_least && is_best;
    together->is_none = !status && !answer->found && answer->most < 0;
    entry->answer.most = answer->most;
    together->nodes += search ? joint_nodes(search) : 0;
    joint_destroy(search);
    return status;
}

/* The least cut of the needles that are planned and may answer a question. */
static int64_t cut_of(const conus_together *together, const struct question_of *question)
{
    int64_t cut = INT64_MAX;
    for (size_t i = 0; i < question->needle_count; i++) {
        size_t needle = question->needles[i];
        cut = !together->needles[needle].given && together->cuts[needle] < cut ? together->cuts[needle] : cut;
    }
    return cut;
}

/* Lists more where the answer asks for it. *is_longer: of some question. */
static conus_status extend_lists(bool *is_longer, conus_together *together)
{
    conus_status status = CONUS_OK;
    *is_longer = false;
    for (size_t q = 0; q < together->question_count && !status; q++) {
        struct question_of *question = &together->questions[q];
        int64_t cut = cut_of(together, question);
        if (question->is_asked && !question->is_full && lacks_above(question, cut)) {
            status = extend_list(question, cut, together->test.covers.count);
            *is_longer = true;
        }
    }
    conus_status joined = join_all(together);
    return status && status != CONUS_ERROR_CANCELLED ? status : joined ? joined : status;
}

/* An entry's places are known again in lists that are longer. */
static conus_status follow(conus_together *together, size_t index)
{
    struct entry *entry = &together->entries[index];
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        size_t at = 0;
        while (at < needle->list.count && needle->list.items[at].number != entry->numbers[i]) {
            at++;
        }
        if (at == needle->list.count) {
            return fail_changed(needle);
        }
        together->listed[index][i] = entry->answer.chosen[i] = at;
    }
    return CONUS_OK;
}

/* Searches the next entry. A run that is cancelled once there is an answer has that one. */
static conus_status search_entry(conus_together *together)
{
    bool is_longer = true;
    conus_status status = CONUS_OK;
    together->has_answer = false;
    together->is_searching = true;
    together->bound = most_of_next(together); /* here, since lists that are being extended have no first item */
    while (is_longer && !status) {
        status = search_known(together);
        find_cuts(together);
        is_longer = false;
        status = status ? status : extend_lists(&is_longer, together);
        conus_status followed = CONUS_OK;
        for (size_t n = 0; n < together->entry_count + together->has_answer && !followed; n++) {
            followed = follow(together, n);
        }
        status = status && status != CONUS_ERROR_CANCELLED ? status : followed ? followed : status;
    }
    together->is_searching = false;
    return status == CONUS_ERROR_CANCELLED && together->has_answer ? CONUS_OK : status;
}

static bool has_none(const struct needle_of *needle)
{
    return needle->given ? !needle->place.feasible : !needle->list.count;
}

static size_t bits_of(uint32_t bits)
{
    return (size_t)__builtin_popcount(bits);
}

/* The needles of a set by a number, in which the first needle is the highest bit: so the first sets are the largest. */
static uint32_t set_of(uint32_t number, size_t count)
{
    uint32_t set = 0;
    for (size_t i = 0; i < count; i++) {
        set |= (number >> (count - 1 - i) & 1) << i;
    }
    return set;
}

/* Finds the smallest set of needles without a combination, 0 where that is not known, of a whole that has none. */
static conus_status find_conflict(uint32_t *out, struct search *search, const conus_together *together,
                                  const struct pair_test *test)
{
    const uint32_t all = (1U << together->count) - 1;
    bool is_known = true;
    conus_status status = CONUS_OK;
    *out = 0;
    for (size_t size = 2; size < together->count && !*out && is_known && !status; size++) {
        for (uint32_t number = all; number && !*out && is_known && !status; number--) {
            uint32_t set = set_of(number, together->count);
            struct search_answer answer = {0};
            if (bits_of(set) == size) {
                status = joint_any(&answer, search, set, test);
                *out = !answer.found && answer.most < 0 ? set : 0;
                is_known = answer.found || *out;
            }
        }
    }
    *out = status ? 0 : !*out && is_known ? all : *out;
    return status;
}

/* The largest least distance of their shafts or entries; NaN where that is not known. */
static conus_status find_limit(double *out, struct search *search, uint32_t set, const struct pair_test *test,
                               enum pair_quantity quantity)
{
    struct search_answer answer = {0};
    const struct pair_test other = {test->margins, quantity, LOWEST, {0}};
    conus_status status = joint_least(&answer, search, set, &other, HIGHEST);
    *out = answer.found && answer.least == answer.most ? NM * (double)answer.least : NAN;
    return status;
}

/* The least number of arcs, or of needles on each, from which on there is a combination; 0 where there is none, and
 * where that is not known. `limit` is that of `test`, which is changed. */
static conus_status find_arcs(uint64_t *out, struct search *search, struct pair_test *test, size_t *limit, size_t count)
{
    conus_status status = CONUS_OK;
    bool is_known = *limit;
    for (*out = 0; is_known && !*out && ++*limit <= count && !status;) {
        struct search_answer answer = {0};
        status = joint_any(&answer, search, (1U << count) - 1, test);
        *out = answer.found ? *limit : 0;
        is_known = answer.found || answer.most < 0;
    }
    return status;
}

/* The most contacts in a cover that some combination has, all else being as it is; NaN where none has, and where that
 * is not known. */
static conus_status find_contacts(double *out, struct search *search, struct pair_test *test, size_t cover,
                                  size_t count)
{
    const uint64_t asked = test->covers.least[cover];
    uint64_t low = 0;      /* a combination with so many there may be, */
    uint64_t high = asked; /* and none with so many */
    conus_status status = CONUS_OK;
    bool is_known = asked;
    *out = NAN;
    while (low < high && is_known && !status) {
        struct search_answer answer = {0};
        uint64_t middle = isnan(*out) ? 0 : low + (high - low) / 2;
        test->covers.least[cover] = middle;
        status = joint_any(&answer, search, (1U << count) - 1, test);
        *out = answer.found ? (double)middle : *out;
        low = answer.found ? middle + 1 : low;
        high = answer.found ? high : middle;
        is_known = answer.found || answer.most < 0;
    }
    test->covers.least[cover] = asked;
    *out = is_known ? *out : NAN;
    return status;
}

/* Whether all needles have a combination but for the limits of arcs and covers, and what limits would do. */
static conus_status explain_limits(bool *is_so, struct search *search, conus_together *together)
{
    struct pair_test test = together->test;
    struct arcs *arcs = &test.margins.arcs;
    struct search_answer answer = {0};
    arcs->most = arcs->each = test.covers.count = 0;
    conus_status status = joint_any(&answer, search, (1U << together->count) - 1, &test);
    *is_so = together->conflict.by_limits = !status && answer.found;
    test = together->test;
    for (size_t k = 0; k < test.covers.count && *is_so && !status; k++) {
        status = find_contacts(&together->contacts[k], search, &test, k, together->count);
    }
    if (*is_so && !status) {
        status = find_arcs(&together->conflict.arcs_most, search, &test, &arcs->most, together->count);
        *arcs = together->test.margins.arcs;
        status =
            status ? status : find_arcs(&together->conflict.arcs_each, search, &test, &arcs->each, together->count);
    }
    return status;
}

static conus_status explain(conus_together *together)
{
    struct search *search = NULL;
    uint32_t set = 0;
    conus_conflict *conflict = &together->conflict;
    *conflict = (conus_conflict){
        .needles = together->conflicting, .between = NAN, .entry_distance = NAN, .contacts = together->contacts};
    for (size_t k = 0; k < together->test.covers.count; k++) {
        together->contacts[k] = NAN;
    }
    together->has_conflict = true;
    for (size_t i = 0; i < together->count && !set; i++) {
        set = has_none(&together->needles[i]) ? 1U << i : 0;
    }
    conus_status status = set ? CONUS_OK : begin_search(&search, together, together->options.effort);
    bool is_by_limits = false;
    struct pair_test pairs = together->test;
    if (search && (pairs.margins.arcs.most || pairs.margins.arcs.each || pairs.covers.count)) {
        status = explain_limits(&is_by_limits, search, together);
        set = is_by_limits ? (1U << together->count) - 1 : 0;
    }
    if (search && !is_by_limits && !status) {
        pairs.margins.arcs.most = pairs.margins.arcs.each = pairs.covers.count = 0;
        status = find_conflict(&set, search, together, &pairs);
        status = status || !set ? status : find_limit(&conflict->between, search, set, &pairs, PAIR_BETWEEN);
        status = status || !set ? status : find_limit(&conflict->entry_distance, search, set, &pairs, PAIR_ENTRIES);
    }
    for (size_t i = 0; i < together->count; i++) {
        if (set >> i & 1) {
            together->conflicting[conflict->count++] = i;
        }
    }
    joint_destroy(search);
    return status == CONUS_ERROR_CANCELLED ? CONUS_OK : status; /* what is known by then */
}

/* Measures the pairs of an entry. */
static int64_t measure_pairs(conus_together *together, size_t of[2], size_t index, int64_t least)
{
    const struct entry *entry = &together->entries[index];
    const size_t *chosen = entry->answer.chosen;
    for (size_t i = 0; i < together->count; i++) {
        for (size_t k = i + 1; k < together->count; k++) {
            const struct needle_of *one = &together->needles[i];
            const struct needle_of *other = &together->needles[k];
            struct pair_row *row = &together->pairs[together->pair_count++];
            *row = (struct pair_row){.combination = entry->combination.feasible ? index + 1 : 0,
                                     .names = {one->name, other->name}};
            const struct search_item *items[2] = {&one->list.items[chosen[i]], &other->list.items[chosen[k]]};
            const struct body_list *bodies[2] = {one->list.parts[items[0]->part].bodies,
                                                 other->list.parts[items[1]->part].bodies};
            pair_measure(&row->pair, bodies[0], items[0]->index, bodies[1], items[1]->index, &together->test.margins);
            pair_row_name(row, bodies[0]->bodies, bodies[1]->bodies);
            bool is_broken = !(row->pair.slack > 0);
            row->leeway = is_broken ? 0 : row->pair.slack / 2;
            int64_t value = is_broken ? 0 : pair_value(&row->pair, PAIR_LEEWAY);
            if (value < least) {
                least = value;
                of[0] = i;
                of[1] = k;
            }
        }
    }
    return least;
}

/* Sets an entry's combination: its places, and what its needles and pairs have. */
static conus_status place_all(conus_together *together, size_t index)
{
    struct entry *entry = &together->entries[index];
    conus_combination *out = &entry->combination;
    size_t of[2] = {SIZE_MAX, SIZE_MAX};
    int64_t least = INT64_MAX;
    int64_t sum = 0;
    int64_t depth = 0;
    const size_t covers = together->test.covers.count;
    out->chosen = entry->chosen;
    out->covered = entry->covered;
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        const struct search_item *item = &needle->list.items[entry->answer.chosen[i]];
        const struct search_part *part = &needle->list.parts[item->part];
        const conus_planned *place = place_of(together, entry, i);
        if (!needle->given && !is_same(place, item)) {
            return fail_changed(needle);
        }
        entry->chosen[i] = (conus_chosen){place, item->number, part->question, item->covered[covers]};
        out->contacts += item->covered[covers];
        for (size_t k = 0; k < covers; k++) {
            entry->covered[k] += item->covered[k];
        }
        sum += item->leeway;
        depth += item->depth;
        if (part->has_leeway && item->leeway < least) {
            least = item->leeway;
            of[0] = i;
        }
    }
    least = measure_pairs(together, of, index, least);
    for (size_t i = 0; i < 2 && of[i] < SIZE_MAX; i++) {
        buffer_format(&entry->leeway_of, "%s%s", i ? "/" : "", together->needles[of[i]].name);
    }
    out->leeway_of = of[0] < SIZE_MAX ? entry->leeway_of.data : NULL;
    out->sum = NM * (double)sum;
    out->depth = NM * (double)depth;
    out->leeway = least < INT64_MAX ? NM * (double)least : NAN;
    out->bound = isnan(out->leeway) || !out->feasible ? NAN : NM * (double)entry->bound;
    return buffer_status(&entry->leeway_of);
}

/* Places all entries. */
static conus_status place_entries(conus_together *together)
{
    conus_status status = CONUS_OK;
    size_t pairs = together->count * together->count * together->entry_count + 1;
    for (size_t q = 0; q < together->question_count && !status; q++) {
        status = together->entry_count ? find_places(together, &together->questions[q]) : status;
    }
    together->pairs = status ? NULL : memory_zeroed(pairs, sizeof *together->pairs);
    status = status || together->pairs ? status : CONUS_ERROR_MEMORY;
    for (size_t n = 0; n < together->entry_count && !status; n++) {
        status = place_all(together, n);
    }
    return status;
}

/* Whether the next entry is proven, and what none exceeds. */
static void judge_entry(conus_together *together)
{
    struct entry *entry = next_entry(together);
    int64_t most = entry->answer.most > entry->answer.least ? entry->answer.most : entry->answer.least;
    bool is_proven = together->is_best && !together->was_cancelled;
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        is_proven = is_proven && !lacks_candidates(together, i);
        for (size_t q = 0; q < needle->question_count && !needle->given; q++) {
            const struct question_of *question = &together->questions[needle->questions[q]];
            int64_t floor = question->has_leeway ? question->floor : INT64_MAX;
            most = lacks_above(question, together->cuts[i]) && floor > most ? floor : most;
        }
    }
    /* Lists may have grown since the last search that was whole. */
    most = together->was_cancelled ? together->bound : most;
    int64_t limit = most_of_next(together);
    entry->bound = is_proven ? entry->answer.least : most < limit ? most : limit;
    bool are_before = !together->entry_count || entry[-1].combination.proven;
    entry->combination.feasible = true;
    entry->combination.proven = is_proven && are_before;
    entry->combination.nodes = together->nodes;
}

/* Whether a candidate of a needle is not below its cut. */
static bool is_above(const conus_together *together, size_t needle, const struct search_item *item)
{
    const struct search_part *part = &together->needles[needle].list.parts[item->part];
    return !part->has_leeway || item->leeway >= together->cuts[needle];
}

static uint64_t count_above(const conus_together *together, size_t needle)
{
    const struct search_list *list = &together->needles[needle].list;
    uint64_t count = 0;
    for (size_t i = 0; i < list->count; i++) {
        count += together->needles[needle].given || is_above(together, needle, &list->items[i]);
    }
    return count;
}

static void describe_needles(conus_together *together)
{
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        bool has = false; /* some of its candidates have a leeway */
        for (size_t p = 0; p < needle->list.part_count && needle->list.count && !has_none(needle); p++) {
            has = has || needle->list.parts[p].has_leeway;
        }
        bool has_cut = has && together->entries[0].combination.feasible;
        together->placed[i] = (conus_placed){.name = needle->name,
                                             .given = needle->given ? &needle->place : NULL,
                                             .questions = needle->questions,
                                             .question_count = needle->question_count,
                                             .largest = has ? NM * (double)largest_of(needle) : NAN,
                                             .cut = has_cut ? NM * (double)together->cuts[i] : NAN,
                                             .above = count_above(together, i)};
    }
    for (size_t q = 0; q < together->question_count; q++) {
        const struct question_of *question = &together->questions[q];
        const struct bodies *bodies = &question->bodies;
        together->answered[q] = (conus_answered){.needles = question->needles,
                                                 .needle_count = question->needle_count,
                                                 .once = question->asked.once,
                                                 .arc = question->arc,
                                                 .plan = question->plan,
                                                 .radius = bodies->radius[0],
                                                 .shanks = bodies->shanks[0],
                                                 .shank_count = bodies->shaft_count,
                                                 .parts = bodies->parts,
                                                 .part_count = bodies->count - bodies->shaft_count};
    }
}

/* Lists combinations until there are enough, or no more. All entries share the effort. */
static conus_status search_entries(conus_together *together)
{
    conus_status status = CONUS_OK;
    bool is_over = false;
    for (uint64_t left = together->options.top; left && !is_over && !status; left--) {
        int64_t cuts[NEEDLE_LIMIT];
        const uint64_t effort = together->options.effort;
        memcpy(cuts, together->cuts, sizeof cuts);
        together->limit = together->nodes + (effort > together->nodes ? effort - together->nodes : 0) / left;
        status = search_entry(together);
        for (size_t i = 0; i < together->count; i++) {
            together->is_none = together->is_none && !lacks_candidates(together, i);
        }
        if (!status && together->has_answer) {
            judge_entry(together);
            together->entry_count++;
        } else if (together->entry_count) {
            status = status == CONUS_ERROR_CANCELLED ? CONUS_OK : status;
            together->entries[together->entry_count - 1].combination.last = !status && together->is_none;
            memcpy(together->cuts, together->is_none ? together->cuts : cuts, sizeof cuts);
        }
        is_over = together->was_cancelled || !together->has_answer;
    }
    return status;
}

static conus_status answer(conus_together *together)
{
    bool are_all_given = true;
    bool lacks_one = false;
    for (size_t i = 0; i < together->count; i++) {
        are_all_given = are_all_given && together->needles[i].given;
        lacks_one = lacks_one || has_none(&together->needles[i]);
    }
    conus_status status = lacks_one ? CONUS_OK : search_entries(together);
    if (status) {
        return status;
    }
    bool is_none = !together->entry_count && (lacks_one || together->is_none);
    status = is_none ? explain(together) : status;
    if (is_none && are_all_given) { /* what breaks is shown; once it is explained, since the search differs from it */
        together->entries[together->entry_count++].combination.nodes = together->nodes;
    }
    status = status ? status : place_entries(together);
    describe_needles(together);
    return status;
}

conus_status conus_plan_together(conus_together **out, const conus_question *questions, size_t count,
                                 const conus_together_options *options)
{
    conus_together *together = memory_zeroed(1, sizeof *together);
    if (!together) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = check_options(together, options);
    status = status ? status : init_questions(together, questions, count);
    status = status ? status : check_axes(together);
    status = status ? status : check_list(together);
    status = status ? status : take_given(together);
    status = status ? status : begin_needles(together);
    status = status ? status : answer(together);
    if (status) {
        conus_together_destroy(together);
        return status;
    }
    together->options.given = NULL; /* the caller's, as the next one */
    together->options.so_far = NULL;
    *out = together;
    return CONUS_OK;
}

static void forget_above(struct needle_of *needle)
{
    for (size_t i = 0; i < needle->above_count; i++) {
        plan_copy_finish(&needle->above[i]);
    }
    memory_free(needle->above);
    memory_free(needle->candidates);
    needle->above = NULL;
    needle->candidates = NULL;
    needle->above_count = 0;
}

/* Adds those of one question; `before`: so many candidates are those of the questions before it. */
static conus_status add_above(struct needle_of *needle, conus_together *together, size_t part, uint64_t before)
{
    const struct search_list *list = &needle->list;
    struct question_of *question = &together->questions[list->parts[part].question];
    const size_t index = (size_t)(needle - together->needles);
    const size_t covers = together->test.covers.count;
    conus_planned *first = needle->above + needle->above_count;
    conus_pose_stream *stream = NULL;
    size_t count = 0;
    for (size_t i = 0; i < list->count; i++) {
        const struct search_item *item = &list->items[i];
        if (item->part == part && is_above(together, index, item)) {
            first[count++] = (conus_planned){.candidate = question->items[item->index].number,
                                             .leeway = question->has_leeway ? NM * (double)item->leeway : NAN};
        }
    }
    order_sort(first, count, sizeof *first, compare_places);
    conus_status status = question->asked.open(&stream, question->asked.user);
    status = status ? status : plan_find(first, count, question->plan, stream, true);
    close_candidates(stream, question);
    for (size_t i = 0; i < count; i++) {
        uint32_t covered[COVER_LIMIT + 1] = {0};
        status = status || first[i].id ? status : fail_changed(needle);
        status = status ? status : count_covered(covered, question, &first[i], covers);
        needle->candidates[needle->above_count++] =
            (conus_chosen){&first[i], first[i].candidate + before, list->parts[part].question, covered[covers]};
    }
    return status;
}

conus_status conus_together_candidates(const conus_chosen **out, size_t *count, conus_together *together, size_t index)
{
    struct needle_of *needle = &together->needles[index];
    const size_t most = needle->list.count + 1;
    uint64_t before = 0;
    forget_above(needle);
    needle->above = memory_zeroed(most, sizeof *needle->above);
    needle->candidates = memory_zeroed(most, sizeof *needle->candidates);
    conus_status status = needle->above && needle->candidates ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && needle->given) {
        needle->candidates[0] =
            (conus_chosen){&needle->place, 1, needle->questions[0], needle->covered[together->test.covers.count]};
    }
    for (size_t p = 0; p < needle->question_count && !needle->given && !status; p++) {
        status = add_above(needle, together, p, before);
        before += conus_plan_left(together->questions[needle->questions[p]].plan, 0);
    }
    if (!status) {
        *out = needle->candidates;
        *count = needle->given ? 1 : needle->above_count;
    }
    return status;
}

void conus_together_destroy(conus_together *together)
{
    if (!together) {
        return;
    }
    for (size_t q = 0; q < together->question_count; q++) {
        struct question_of *question = &together->questions[q];
        for (size_t n = 0; n < question->place_count; n++) {
            plan_copy_finish(&question->places[n]);
        }
        memory_free(question->places);
        memory_free(question->arc);
        for (size_t k = 0; question->covers && k <= together->test.covers.count; k++) {
            plan_constraint_finish(&question->covers[k]);
        }
        memory_free(question->covers);
        conus_plan_destroy(question->plan);
        finish_list(question);
    }
    for (size_t i = 0; i < together->count; i++) {
        struct needle_of *needle = &together->needles[i];
        plan_copy_finish(&needle->place);
        forget_above(needle);
        body_list_finish(&needle->bodies);
        memory_free(needle->joined);
        memory_free(needle->name);
    }
    for (size_t n = 0; n < together->entry_count; n++) {
        buffer_finish(&together->entries[n].leeway_of);
    }
    for (size_t k = 0; k < COVER_LIMIT; k++) {
        memory_free((void *)together->covers[k].names);
    }
    memory_free(together->entries);
    memory_free(together->listed);
    memory_free(together->pairs);
    memory_free(together);
}

const conus_combination *conus_together_combination(const conus_together *together, size_t index)
{
    return together && index < together->entry_count ? &together->entries[index].combination : NULL;
}

const conus_together_options *conus_together_asked(const conus_together *together)
{
    return &together->options;
}

size_t conus_together_count(const conus_together *together)
{
    return together ? together->count : 0;
}

const conus_placed *conus_together_needle(const conus_together *together, size_t index)
{
    return index < conus_together_count(together) ? &together->placed[index] : NULL;
}

const conus_answered *conus_together_question(const conus_together *together, size_t index)
{
    return index < together->question_count ? &together->answered[index] : NULL;
}

const conus_conflict *conus_together_conflict(const conus_together *together)
{
    return together && together->has_conflict ? &together->conflict : NULL;
}

conus_status conus_together_pairs(conus_table **out, const conus_together *together)
{
    const conus_selector *selector = together->questions[0].asked.selector;
    const struct table_source source = {selector->atlas, &selector->frame};
    return table_create(out, &source, &pair_fields, &(const struct table_question){0}, together->pairs,
                        sizeof *together->pairs, together->pair_count);
}
