/* SPDX-License-Identifier: BSD-3-Clause */
/* Plans needles together: has the candidates of each listed as far down as the search asks for, and takes its answer
 * apart (Eq. 25 to 28). */
#include "conus/own.h"

#include "base/memory.h"
#include "base/options.h"
#include "base/order.h"
#include "base/status.h"
#include "selection/plan/plan.h"
#include "selection/plan/together/together.h"
#include "selection/selection.h"

#include <math.h>
#include <string.h>

/* A list has the best of its needle, at first some hundred: those that are no worse than so many of a sample. Then it
 * goes LIST_GROWTH times as far down, up to so many at last. */
enum { SAMPLE_FIRST = 32, LIST_GROWTH = 4, LIST_LAST = 1 << 17 };

static const uint64_t EFFORT = 100000000;
static const double MARGIN_LIMIT = 100; /* mm */
/* All distances of shafts or entries are between these, nm. */
static const int64_t LOWEST = -1000000000000000;
static const int64_t HIGHEST = 1000000000000000;

/* A needle, and those of its candidates that are known. */
struct needle_of {
    char *name;
    conus_selector *selector;
    conus_status (*open)(conus_pose_stream **out, void *user);
    void (*close)(conus_pose_stream *stream, void *user);
    void *user;
    conus_plan_options options;
    const conus_constraint *constraints; /* the caller's, until it returns */
    size_t constraint_count;
    struct bodies bodies;
    bool given, has_leeway;
    conus_plan *plan;
    const conus_planned *place; /* in the answer, or the one that is given */
    struct search_item *items;  /* [list.bodies.count] */
    struct search_list list;
    bool is_whole, is_full; /* the list has all that hold, or as many as it may */
    int64_t floor;          /* else all with so much leeway */
};

struct conus_together {
    struct needle_of needles[NEEDLE_LIMIT];
    struct search_list lists[NEEDLE_LIMIT];
    size_t count;
    struct pair_test test;
    conus_together_options options;
    uint64_t tried, tried_before;
    bool was_cancelled;
    bool has_answer, is_best; /* is_best: none of the candidates that are known has more */
    bool is_none;             /* likewise: there is no combination of them */
    struct search_answer answer;
    uint64_t nodes;
    int64_t cuts[NEEDLE_LIMIT];
    conus_combination combination;
    bool has_combination, has_conflict;
    conus_placed placed[NEEDLE_LIMIT];
    conus_conflict conflict;
    size_t conflicting[NEEDLE_LIMIT];
    struct pair_row *pairs; /* [pair_count] */
    size_t pair_count;
};

static const double NM = 1e-6; /* mm */

static conus_status check_margin(const char *name, double value)
{
    return value >= 0 && value <= MARGIN_LIMIT
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "%s: %g mm, allowed are 0 to %g", name, value, MARGIN_LIMIT);
}

static conus_status check_options(conus_together *together, const conus_together_options *asked)
{
    together->options = *options_of(conus_together_options, asked);
    conus_together_options *options = &together->options;
    options->effort = options->effort ? options->effort : EFFORT;
    together->test.margins = (struct margins){options->between, options->parts, options->entry_distance};
    conus_status status = check_margin("between", options->between);
    status = status ? status : check_margin("parts", options->parts);
    return status ? status : check_margin("entry_distance", options->entry_distance);
}

/* Told by the search, which tries nothing, and by plans. */
static bool show_progress(void *user, size_t done, size_t total)
{
    conus_together *together = user;
    const conus_together_options *options = &together->options;
    (void)total;
    together->tried = done ? together->tried_before + done : together->tried;
    together->was_cancelled =
        together->was_cancelled ||
        (options->progress && !options->progress(options->progress_user, (size_t)together->tried, 0));
    return !together->was_cancelled;
}

static conus_status check_plan_options(const conus_plan_options *options)
{
    bool has_other = options->top || options->infeasible || options->rank || options->score || options->progress ||
                     options->entries || options->jitter || options->targets;
    return has_other ? fail(CONUS_ERROR_ARGUMENT, "options: only threads, angle, far and shanks are a needle's")
                     : CONUS_OK;
}

static conus_status create_plan(struct needle_of *needle, conus_together *together)
{
    conus_plan_options options = needle->options;
    options.top = SAMPLE_FIRST;
    options.progress = show_progress;
    options.progress_user = together;
    conus_status status =
        conus_plan_create(&needle->plan, needle->selector, needle->constraints, needle->constraint_count, &options);
    if (!status) {
        plan_sample(needle->plan);
    }
    return status;
}

static const conus_planned *pose_of(const struct needle_of *needle, size_t index)
{
    return needle->given ? needle->place : conus_plan_pose(needle->plan, index);
}

static void finish_list(struct needle_of *needle)
{
    memory_free(needle->items);
    body_list_finish(&needle->list.bodies);
    needle->items = NULL;
}

/* Takes the poses that its plan lists, those with so much leeway; of a given needle its place. */
static conus_status take_list(struct needle_of *needle, int64_t least)
{
    size_t count = needle->given ? 1 : conus_plan_count(needle->plan);
    finish_list(needle);
    needle->items = memory_zeroed(count, sizeof *needle->items);
    conus_status status =
        needle->items ? body_list_init(&needle->list.bodies, &needle->bodies, count) : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        struct search_item *item = &needle->items[i];
        const conus_planned *pose = pose_of(needle, i);
        *item = (struct search_item){.leeway = isnan(pose->leeway) ? 0 : nanometres(pose->leeway),
                                     .depth = nanometres(pose->far),
                                     .number = needle->given ? 1 : pose->candidate,
                                     .index = i};
    }
    needle->is_full = count == LIST_LAST;
    /* What a full list leaves out may have as much as its last one. */
    needle->floor = needle->is_full && !status ? needle->items[count - 1].leeway + 1 : least;
    needle->is_whole =
        needle->given || conus_plan_left(needle->plan, conus_plan_constraint_count(needle->plan)) == count;
    if (!status) {
        order_sort(needle->items, count, sizeof *needle->items, search_item_compare);
    }
    for (size_t i = 0; i < count && !status; i++) {
        body_list_set(&needle->list.bodies, i, pose_of(needle, needle->items[i].index));
    }
    needle->list.items = needle->items;
    plan_forget_list(needle->plan);
    return status;
}

static void close_candidates(conus_pose_stream *stream, const struct needle_of *needle)
{
    if (needle->close && stream) {
        needle->close(stream, needle->user);
    } else {
        conus_pose_stream_destroy(stream);
    }
}

/* Lists all candidates with so much leeway. */
static conus_status list_down_to(struct needle_of *needle, int64_t least)
{
    conus_pose_stream *stream = NULL;
    conus_status status = needle->open(&stream, needle->user);
    status = status ? status : plan_list_again(needle->plan, stream, least, LIST_LAST);
    close_candidates(stream, needle);
    return status ? status : take_list(needle, least);
}

/* Judges all candidates, and lists the best of them. */
static conus_status begin_list(struct needle_of *needle, conus_together *together)
{
    conus_pose_stream *stream = NULL;
    conus_status status = create_plan(needle, together);
    status = status ? status : needle->open(&stream, needle->user);
    status = status ? status : conus_plan_run(needle->plan, stream, UINT64_MAX);
    close_candidates(stream, needle);
    const conus_planned *last = status ? NULL : conus_plan_pose(needle->plan, SAMPLE_FIRST - 1);
    status = status ? status : list_down_to(needle, last && !isnan(last->leeway) ? nanometres(last->leeway) : 0);
    together->tried_before += status ? 0 : conus_plan_left(needle->plan, 0);
    return status;
}

/* Lists more candidates: LIST_GROWTH times as far down, but not below the cut. */
static conus_status extend_list(struct needle_of *needle, int64_t cut)
{
    int64_t largest = needle->items[0].leeway;
    int64_t way = largest - needle->floor > largest / 16 ? largest - needle->floor : largest / 16 + 1;
    int64_t least = largest - LIST_GROWTH * way;
    return list_down_to(needle, !needle->has_leeway ? 0 : least > cut ? least : cut);
}

/* Gives a needle its place in the answer. */
static conus_status find_place(struct needle_of *needle, const struct search_item *item)
{
    conus_pose_stream *stream = NULL;
    conus_status status = needle->open(&stream, needle->user);
    status = status ? status : plan_find(&needle->place, needle->plan, stream, item->number);
    close_candidates(stream, needle);
    const conus_planned *place = needle->place;
    bool is_same = !status && place && place->feasible && nanometres(place->far) == item->depth &&
                   (isnan(place->leeway) ? 0 : nanometres(place->leeway)) == item->leeway;
    return status || is_same
               ? status
               : fail(CONUS_ERROR_DATA, "%s: its candidates are others when they are read again", needle->name);
}

static conus_status place_given(struct needle_of *needle, conus_together *together, const conus_pose_row *given)
{
    conus_pose_row row = *given;
    row.id = needle->name;
    conus_status status = create_plan(needle, together);
    status = status ? status : conus_plan_try(&needle->place, needle->plan, &row);
    return status ? status : take_list(needle, 0);
}

static conus_status init_needle(struct needle_of *out, conus_together *together, const conus_needle *asked)
{
    const conus_plan_options options = *options_of(conus_plan_options, asked->options);
    out->selector = asked->selector;
    out->open = asked->open;
    out->close = asked->close;
    out->user = asked->user;
    out->options = options;
    out->constraints = asked->constraints;
    out->constraint_count = asked->constraint_count;
    out->given = asked->given;
    conus_status status = asked->open || asked->given
                              ? check_plan_options(&options)
                              : fail(CONUS_ERROR_ARGUMENT, "open: there is none, and the needle is not given");
    status = status ? status
                    : bodies_init(&out->bodies, asked->selector->options.radius, options.shanks, options.shank_count,
                                  asked->parts, asked->part_count);
    status = status ? status : asked->given ? place_given(out, together, asked->given) : begin_list(out, together);
    for (size_t i = 0; i < asked->constraint_count && !status; i++) {
        out->has_leeway = out->has_leeway || conus_plan_has_leeway(out->plan, i);
    }
    out->list.has_leeway = out->has_leeway;
    return status;
}

static conus_status init_needles(conus_together *together, const conus_needle *needles, size_t count)
{
    size_t size = count && needles[0].struct_size ? needles[0].struct_size : sizeof *needles;
    if (!count || count > NEEDLE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "needles: %zu, allowed are 1 to %d", count, NEEDLE_LIMIT);
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < count && !status; i++) {
        const conus_needle asked = *options_of(conus_needle, (const char *)needles + i * size);
        struct needle_of *needle = &together->needles[i];
        together->count++;
        needle->name = asked.name && asked.name[0] ? memory_text(asked.name, strlen(asked.name)) : NULL;
        status = needle->name                  ? CONUS_OK
                 : asked.name && asked.name[0] ? CONUS_ERROR_MEMORY
                                               : fail(CONUS_ERROR_ARGUMENT, "needles: number %zu has no name", i + 1);
        for (size_t k = 0; k < i && !status; k++) {
            status = strcmp(together->needles[k].name, needle->name) == 0
                         ? fail(CONUS_ERROR_ARGUMENT, "needles: two are called %s", needle->name)
                         : CONUS_OK;
        }
        if (!status) {
            status = init_needle(needle, together, &asked);
            status = status == CONUS_ERROR_ARGUMENT ? fail_in(status, needle->name) : status;
        }
    }
    return status;
}

/* The largest leeway of a needle's candidates. */
static int64_t largest_of(const struct needle_of *needle)
{
    return needle->list.bodies.count ? needle->items[0].leeway : 0;
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

/* Below it no candidate of a needle is in a combination that is as good as the answer (Eq. 28). */
static void find_cuts(conus_together *together)
{
    const struct search_answer *answer = &together->answer;
    int64_t sum = 0;
    int64_t all = 0;
    for (size_t i = 0; i < together->count; i++) {
        all += largest_of(&together->needles[i]);
        sum += answer->found ? together->needles[i].items[answer->chosen[i]].leeway : 0;
    }
    /* Until none can have a larger least leeway, all that have more than the answer's may be in one that has. */
    bool is_largest = answer->found && answer->least >= most_of_all(together);
    for (size_t i = 0; i < together->count; i++) {
        int64_t by_sum = answer->found ? sum - (all - largest_of(&together->needles[i])) : 0;
        int64_t by_least = answer->found ? answer->least : 0;
        int64_t cut = by_sum > by_least ? by_sum : by_least;
        together->cuts[i] = is_largest || cut <= by_least ? cut : by_least + 1;
    }
}

static bool lacks_candidates(const conus_together *together, size_t needle)
{
    const struct needle_of *of = &together->needles[needle];
    return !of->is_whole && (!of->has_leeway || of->floor > together->cuts[needle]);
}

static uint64_t effort_left(const conus_together *together)
{
    return together->nodes < together->options.effort ? together->options.effort - together->nodes : 0;
}

/* Searches among the candidates that are known. */
static conus_status search_known(conus_together *together)
{
    struct search *search = NULL;
    struct search_answer answer = {0};
    bool is_best = false;
    const uint32_t all = (1U << together->count) - 1;
    for (size_t i = 0; i < together->count; i++) {
        together->lists[i] = together->needles[i].list;
    }
    conus_status status =
        joint_create(&search, together->lists, together->count, effort_left(together), show_progress, together);
    status = status ? status : joint_least(&answer, search, all, &together->test, most_of_all(together));
    bool is_least = answer.found && answer.least == answer.most;
    if (!status && answer.found) {
        status = joint_best(&answer, &is_best, search, &together->test);
    }
    if (answer.found && (!status || status == CONUS_ERROR_CANCELLED)) {
        together->answer = answer;
        together->has_answer = true;
    }
    together->is_best = !status && is_least && is_best;
    together->is_none = !status && !answer.found && answer.most < 0;
    together->answer.most = answer.most;
    together->nodes += search ? joint_nodes(search) : 0;
    joint_destroy(search);
    return status;
}

/* Lists more where the answer asks for it. *is_longer: of some needle. */
static conus_status extend_lists(bool *is_longer, conus_together *together)
{
    conus_status status = CONUS_OK;
    *is_longer = false;
    for (size_t i = 0; i < together->count && !status; i++) {
        struct needle_of *needle = &together->needles[i];
        if (lacks_candidates(together, i) && !needle->is_full) {
            status = extend_list(needle, together->cuts[i]);
            *is_longer = true;
        }
    }
    return status;
}

/* An answer's places are known again in a list that is longer. */
static conus_status follow(conus_together *together, const uint64_t numbers[NEEDLE_LIMIT])
{
    for (size_t i = 0; i < together->count && together->has_answer; i++) {
        const struct needle_of *needle = &together->needles[i];
        size_t at = 0;
        while (at < needle->list.bodies.count && needle->items[at].number != numbers[i]) {
            at++;
        }
        if (at == needle->list.bodies.count) {
            together->has_answer = false;
            return fail(CONUS_ERROR_DATA, "%s: its candidates are others when they are read again", needle->name);
        }
        together->answer.chosen[i] = at;
    }
    return CONUS_OK;
}

/* A run that is cancelled once there is an answer has that one. */
static conus_status search_all(conus_together *together)
{
    bool is_longer = true;
    conus_status status = CONUS_OK;
    while (is_longer && !status) {
        uint64_t numbers[NEEDLE_LIMIT] = {0};
        status = search_known(together);
        find_cuts(together);
        for (size_t i = 0; i < together->count && together->has_answer; i++) {
            numbers[i] = together->needles[i].items[together->answer.chosen[i]].number;
        }
        is_longer = false;
        status = status ? status : extend_lists(&is_longer, together);
        conus_status followed = follow(together, numbers);
        status = status && status != CONUS_ERROR_CANCELLED ? status : followed ? followed : status;
    }
    return status == CONUS_ERROR_CANCELLED && together->has_answer ? CONUS_OK : status;
}

static bool has_none(const struct needle_of *needle)
{
    return needle->given ? !needle->place->feasible : !needle->list.bodies.count;
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
static conus_status find_conflict(uint32_t *out, struct search *search, const conus_together *together)
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
                status = joint_any(&answer, search, set, &together->test);
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
    const struct pair_test other = {test->margins, quantity, LOWEST};
    conus_status status = joint_least(&answer, search, set, &other, HIGHEST);
    *out = answer.found && answer.least == answer.most ? NM * (double)answer.least : NAN;
    return status;
}

static conus_status explain(conus_together *together)
{
    struct search *search = NULL;
    uint32_t set = 0;
    conus_conflict *conflict = &together->conflict;
    *conflict = (conus_conflict){together->conflicting, 0, NAN, NAN};
    together->has_conflict = true;
    for (size_t i = 0; i < together->count && !set; i++) {
        set = has_none(&together->needles[i]) ? 1U << i : 0;
    }
    conus_status status =
        set ? CONUS_OK
            : joint_create(&search, together->lists, together->count, effort_left(together), show_progress, together);
    if (search) {
        status = find_conflict(&set, search, together);
        status = status || !set ? status : find_limit(&conflict->between, search, set, &together->test, PAIR_BETWEEN);
        status =
            status || !set ? status : find_limit(&conflict->entry_distance, search, set, &together->test, PAIR_ENTRIES);
    }
    for (size_t i = 0; i < together->count; i++) {
        if (set >> i & 1) {
            together->conflicting[conflict->count++] = i;
        }
    }
    joint_destroy(search);
    return status == CONUS_ERROR_CANCELLED ? CONUS_OK : status; /* what is known by then */
}

/* Sets the places of the answer, and measures its pairs. */
static conus_status place_all(conus_together *together, bool is_feasible)
{
    const size_t *chosen = together->answer.chosen;
    conus_combination *out = &together->combination;
    int64_t least = INT64_MAX;
    int64_t sum = 0;
    int64_t depth = 0;
    together->has_combination = true;
    *out = (conus_combination){
        .feasible = is_feasible, .bound = NAN, .leeway_of = {SIZE_MAX, SIZE_MAX}, .nodes = together->nodes};
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        const struct search_item *item = &needle->items[chosen[i]];
        together->placed[i].pose = needle->place;
        together->placed[i].candidate = item->number;
        sum += item->leeway;
        depth += item->depth;
        if (needle->has_leeway && item->leeway < least) {
            least = item->leeway;
            out->leeway_of[0] = i;
        }
    }
    together->pairs = memory_zeroed(together->count * together->count, sizeof *together->pairs);
    if (!together->pairs) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < together->count; i++) {
        for (size_t k = i + 1; k < together->count; k++) {
            const struct needle_of *one = &together->needles[i];
            const struct needle_of *other = &together->needles[k];
            struct pair_row *row = &together->pairs[together->pair_count++];
            *row = (struct pair_row){.combination = is_feasible, .names = {one->name, other->name}};
            pair_measure(&row->pair, &one->list.bodies, chosen[i], &other->list.bodies, chosen[k],
                         &together->test.margins);
            pair_row_name(row, &one->bodies, &other->bodies);
            bool is_broken = !(row->pair.slack > 0);
            row->leeway = is_broken ? 0 : row->pair.slack / 2;
            int64_t value = is_broken ? 0 : pair_value(&row->pair, PAIR_LEEWAY);
            if (value < least) {
                least = value;
                out->leeway_of[0] = i;
                out->leeway_of[1] = k;
            }
        }
    }
    out->sum = NM * (double)sum;
    out->depth = NM * (double)depth;
    out->leeway = least < INT64_MAX ? NM * (double)least : NAN;
    return CONUS_OK;
}

/* Whether the answer is proven, and else what none exceeds. */
static void judge_answer(conus_together *together)
{
    conus_combination *out = &together->combination;
    int64_t most = together->answer.most > together->answer.least ? together->answer.most : together->answer.least;
    out->proven = together->is_best && !together->was_cancelled;
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        bool lacks = lacks_candidates(together, i);
        int64_t floor = needle->has_leeway ? needle->floor : INT64_MAX;
        out->proven = out->proven && !lacks;
        most = lacks && floor > most ? floor : most;
    }
    /* Lists may have grown since the last search that was whole. */
    most = together->was_cancelled ? INT64_MAX : most;
    int64_t limit = most_of_all(together);
    most = most < limit ? most : limit;
    out->bound = isnan(out->leeway) ? NAN : out->proven ? out->leeway : NM * (double)most;
}

static void describe_needles(conus_together *together)
{
    for (size_t i = 0; i < together->count; i++) {
        const struct needle_of *needle = &together->needles[i];
        bool has = needle->has_leeway && needle->list.bodies.count && !has_none(needle);
        conus_placed *placed = &together->placed[i];
        placed->name = needle->name;
        placed->given = needle->given;
        placed->plan = needle->plan;
        placed->pose = placed->pose ? placed->pose : needle->place;
        placed->radius = needle->bodies.radius[0];
        placed->shanks = needle->bodies.shanks[0];
        placed->shank_count = needle->bodies.shaft_count;
        placed->parts = needle->bodies.parts;
        placed->part_count = needle->bodies.count - needle->bodies.shaft_count;
        placed->largest = has ? NM * (double)largest_of(needle) : NAN;
        placed->cut = has && together->has_answer ? NM * (double)together->cuts[i] : NAN;
    }
}

static conus_status answer(conus_together *together)
{
    bool are_all_given = true;
    bool lacks_one = false;
    for (size_t i = 0; i < together->count; i++) {
        are_all_given = are_all_given && together->needles[i].given;
        lacks_one = lacks_one || has_none(&together->needles[i]);
        together->lists[i] = together->needles[i].list;
    }
    conus_status status = lacks_one ? CONUS_OK : search_all(together);
    if (status) {
        return status;
    }
    bool is_none = lacks_one || together->is_none;
    for (size_t i = 0; i < together->count; i++) {
        is_none = is_none && (lacks_one || !lacks_candidates(together, i));
    }
    for (size_t i = 0; i < together->count && together->has_answer && !status; i++) {
        struct needle_of *needle = &together->needles[i];
        status = needle->given ? status : find_place(needle, &needle->items[together->answer.chosen[i]]);
    }
    if (!status && (together->has_answer || are_all_given)) {
        status = place_all(together, together->has_answer);
    }
    if (!status && together->has_answer) {
        judge_answer(together);
    }
    describe_needles(together);
    return status || together->has_answer || !is_none ? status : explain(together);
}

conus_status conus_plan_together(conus_together **out, const conus_needle *needles, size_t count,
                                 const conus_together_options *options)
{
    conus_together *together = memory_zeroed(1, sizeof *together);
    if (!together) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = check_options(together, options);
    status = status ? status : init_needles(together, needles, count);
    status = status ? status : answer(together);
    if (status) {
        conus_together_destroy(together);
        return status;
    }
    *out = together;
    return CONUS_OK;
}

void conus_together_destroy(conus_together *together)
{
    for (size_t i = 0; together && i < together->count; i++) {
        memory_free(together->needles[i].name);
        conus_plan_destroy(together->needles[i].plan);
        finish_list(&together->needles[i]);
    }
    memory_free(together ? together->pairs : NULL);
    memory_free(together);
}

const conus_combination *conus_together_combination(const conus_together *together)
{
    return together->has_combination ? &together->combination : NULL;
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

const conus_conflict *conus_together_conflict(const conus_together *together)
{
    return together->has_conflict ? &together->conflict : NULL;
}

conus_status conus_together_pairs(conus_table **out, const conus_together *together)
{
    const conus_selector *selector = together->needles[0].selector;
    const struct table_source source = {selector->atlas, &selector->frame};
    return table_create(out, &source, &pair_fields, &(const struct table_question){0}, together->pairs,
                        sizeof *together->pairs, together->pair_count);
}
