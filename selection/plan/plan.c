/* SPDX-License-Identifier: BSD-3-Clause */
/* Has poses of a stream tried by threads, and keeps the best of them. */
#include "selection/plan/plan.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/order.h"
#include "base/text.h"
#include "conus/own.h"
#include "poses/pose_stream.h"
#include "poses/rows/pose_row.h"
#include "selection/batch/batch.h"
#include "selection/plan/together/together.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum { CONSTRAINT_LIMIT = 100, SHANK_LIMIT = 1000, BLOCK = 32, DEFAULT_TOP = 20, SPARE = 16, REASON_SIZE = 256 };
enum { MAPS_AFTER = 2048 }; /* poses, which take as long as making the maps does */

/* A pose that is kept; its verdicts, keys and id follow it in memory. */
struct entry {
    conus_planned planned;
    const double *keys; /* [key_count] Of the rank, as they are compared. */
    size_t key_count;
};

struct entries {
    struct entry **items;
    size_t count, capacity;
};

struct block {
    struct plan_trial *trials; /* [BLOCK] */
    size_t count;
    conus_verdict *verdicts; /* theirs */
    double *keys;
    struct buffer strings;
    struct entry *listed; /* in place of the trials, once the list is known */
    struct rejected {
        uint64_t count, line;
        char why[REASON_SIZE];
    } rejected;
};

/* The best pose of each entry, or of each target. */
struct bests {
    uint64_t count;
    struct plan_best *items;
    double *keys; /* [count][rank_count] */
};

enum { OF_ENTRY, OF_TARGET, BESTS };

/* A pose that was not judged yet, or is no candidate; and one that breaks something. */
static const int64_t UNKNOWN = INT64_MIN;
static const int64_t BROKEN = INT64_MIN + 1;

/* What is known of each pose, nm: its leeway, or in -1 - m that it is not more than m, or one of the above. */
struct learnt {
    int64_t *items; /* [count] */
    size_t count, capacity;
};

/* Which poses a run is about. */
enum pass {
    PASS_ONLY,   /* all: there is one run */
    PASS_SAMPLE, /* about one of SAMPLE, wherever they are; of those that break something nothing is noted */
    PASS_ALL,    /* all that may have the least leeway or were not judged yet */
    PASS_MORE    /* all that may have it */
};

enum { SAMPLE = 16 };

struct conus_plan {
    struct plan_asked asked;
    double (*shanks)[2]; /* [options.shank_count] */
    bool was_run, is_cut, was_mapped, is_listed, is_done;
    enum pass pass;
    int64_t least; /* nm of the leeway of what is listed */
    struct learnt notes;
    uint64_t *left; /* [count + 1] The funnel. */
    struct rejected rejected;
    struct entries list;       /* Feasible poses during a run, then all that is listed. */
    struct entries infeasible; /* The first ones. */
    struct entry **misses;     /* [count] */
    struct bests bests[BESTS];
    struct plan_bar bar;
    pthread_mutex_t lock; /* of the bar, during a run */
    struct plan_worker *workers;
    struct block *blocks;     /* [ring_slots + 1] The last one is conus_plan_try()'s. */
    conus_pose_stream *poses; /* of the run */
    uint64_t start;           /* its position at first */
    uint64_t rows;            /* still to be read */
    size_t listed;            /* so many poses of the list are asked for their chances */
};

static void finish_entries(struct entries *entries)
{
    for (size_t i = 0; i < entries->count; i++) {
        memory_free(entries->items[i]);
    }
    memory_free((void *)entries->items);
    *entries = (struct entries){0};
}

static conus_status init_block(struct block *block, const conus_plan *plan)
{
    size_t key_count = 2 * plan->asked.order.rank_count;
    block->trials = memory_zeroed(BLOCK, sizeof *block->trials);
    block->verdicts = memory_zeroed(BLOCK * plan->asked.count, sizeof *block->verdicts);
    block->keys = memory_zeroed(BLOCK * key_count, sizeof *block->keys);
    if (!block->trials || !block->verdicts || !block->keys) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < BLOCK; i++) {
        block->trials[i].verdicts = block->verdicts + i * plan->asked.count;
        block->trials[i].keys = block->keys + i * key_count;
        block->trials[i].bar = block->trials[i].keys + plan->asked.order.rank_count;
    }
    return CONUS_OK;
}

static conus_status init_shanks(conus_plan *plan)
{
    static const double axis[2] = {0, 0};
    const double *asked = plan->asked.options.shanks ? plan->asked.options.shanks : axis;
    size_t count = plan->asked.options.shanks ? plan->asked.options.shank_count : 1;
    if (!count || count > SHANK_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "shanks: %zu, allowed are 1 to %d", count, SHANK_LIMIT);
    }
    for (size_t i = 0; i < 2 * count; i++) {
        if (!(fabs(asked[i]) <= SHANK_LIMIT)) {
            return fail(CONUS_ERROR_ARGUMENT, "shanks: the one with number %zu is at %g,%g, allowed are up to %d mm",
                        i / 2 + 1, asked[i / 2 * 2], asked[i / 2 * 2 + 1], SHANK_LIMIT);
        }
    }
    plan->shanks = memory_copy(asked, count, sizeof *plan->shanks);
    plan->asked.options.shanks = NULL;
    plan->asked.options.shank_count = count;
    return plan->shanks ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Constraint `index` of an array of structs of the caller's size. */
static conus_constraint constraint_at(const conus_constraint *constraints, size_t index)
{
    size_t size = constraints->struct_size ? constraints->struct_size : sizeof *constraints;
    return *options_of(conus_constraint, (const char *)constraints + index * size);
}

static conus_status init_constraints(conus_plan *plan, const conus_constraint *constraints, size_t count)
{
    if (!count || count > CONSTRAINT_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "constraints: %zu, allowed is 1 to %d", count, CONSTRAINT_LIMIT);
    }
    plan->asked.constraints = memory_zeroed(count, sizeof *plan->asked.constraints);
    conus_status status = plan->asked.constraints ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        const conus_constraint asked = constraint_at(constraints, i);
        status = plan_constraint_init(&plan->asked.constraints[i], plan->asked.selector, &asked,
                                      plan->asked.options.shank_count);
        plan->asked.count++;
    }
    return status ? status : plan_constraints_check(plan->asked.constraints, count, plan->asked.selector->atlas);
}

static conus_status init_bests(struct bests *out, uint64_t count, size_t rank_count)
{
    size_t keys = 0;
    if (!count) {
        return CONUS_OK;
    }
    if (count <= SIZE_MAX && memory_multiply((size_t)count, rank_count, &keys)) {
        out->items = memory_raw((size_t)count, sizeof *out->items);
        out->keys = memory_raw(keys, sizeof *out->keys);
    }
    for (uint64_t i = 0; out->items && i < count; i++) {
        out->items[i] = (struct plan_best){0, 0, NAN, NAN, NAN, NAN, NAN};
    }
    out->count = count;
    return out->items && out->keys ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status init_options(conus_plan *plan, const conus_jitter_options *asked)
{
    uint32_t block = BLOCK;
    double far = plan->asked.options.far;
    plan->asked.options.top = plan->asked.options.top ? plan->asked.options.top : DEFAULT_TOP;
    conus_status status = !(far >= 0 && isfinite(far))
                              ? fail(CONUS_ERROR_ARGUMENT, "far: %g mm, allowed is 0 or more", far)
                          : plan->asked.options.angle != 0 ? pose_check_angle(plan->asked.options.angle)
                                                           : CONUS_OK;
    status = status ? status
                    : batch_check_options(&plan->asked.options.threads, &block, &plan->asked.options.angle,
                                          plan->asked.selector);
    plan->asked.options.rank = plan->asked.options.score = NULL;
    plan->asked.options.jitter = NULL;
    return status ? status : plan_jitter_init(&plan->asked.jitter, asked);
}

conus_status conus_plan_create(conus_plan **out, conus_selector *selector, const conus_constraint *constraints,
                               size_t count, const conus_plan_options *options)
{
    conus_plan *plan = memory_zeroed(1, sizeof *plan);
    if (!plan) {
        return CONUS_ERROR_MEMORY;
    }
    const conus_plan_options filled = *options_of(conus_plan_options, options);
    plan->asked.selector = selector;
    plan->asked.options = filled;
    conus_status status = selector->options.weight ? fail(CONUS_ERROR_ARGUMENT, "weight: a plan has none") : CONUS_OK;
    status = status ? status : init_shanks(plan);
    status = status ? status : init_constraints(plan, constraints, count);
    status = status ? status : plan_order_init(&plan->asked.order, plan->asked.constraints, plan->asked.count, &filled);
    status = status ? status : init_options(plan, filled.jitter);
    if (!status) {
        plan->left = memory_zeroed(plan->asked.count + 1, sizeof *plan->left);
        plan->misses = memory_zeroed(plan->asked.count, sizeof(struct entry *));
        plan->workers = memory_zeroed(plan->asked.options.threads, sizeof *plan->workers);
        plan->blocks = memory_zeroed(ring_slots(plan->asked.options.threads) + 1, sizeof *plan->blocks);
        status = plan->left && plan->misses && plan->workers && plan->blocks ? plan_bar_init(&plan->bar, &plan->asked)
                                                                             : CONUS_ERROR_MEMORY;
    }
    for (size_t k = 0; k < BESTS && !status; k++) {
        status =
            init_bests(&plan->bests[k], k == OF_ENTRY ? filled.entries : filled.targets, plan->asked.order.rank_count);
    }
    for (size_t i = 0; !status && i < plan->asked.options.threads; i++) {
        status = plan_judge_init(&plan->workers[i].judge, selector, plan->asked.constraints,
                                 (const double(*)[2])plan->shanks, plan->asked.options.shank_count);
        status = status ? status : plan_bar_init(&plan->workers[i].bar, &plan->asked);
    }
    for (size_t i = 0; !status && i <= ring_slots(plan->asked.options.threads); i++) {
        status = init_block(&plan->blocks[i], plan);
    }
    if (status) {
        conus_plan_destroy(plan);
        return status;
    }
    *out = plan;
    return CONUS_OK;
}

void conus_plan_destroy(conus_plan *plan)
{
    if (!plan) {
        return;
    }
    for (size_t i = 0; plan->workers && i < plan->asked.options.threads; i++) {
        plan_judge_finish(&plan->workers[i].judge);
        plan_bar_finish(&plan->workers[i].bar);
    }
    for (size_t i = 0; plan->blocks && i <= ring_slots(plan->asked.options.threads); i++) {
        memory_free(plan->blocks[i].trials);
        memory_free(plan->blocks[i].verdicts);
        memory_free(plan->blocks[i].keys);
        buffer_finish(&plan->blocks[i].strings);
    }
    for (size_t i = 0; i < plan->asked.count; i++) {
        plan_constraint_finish(&plan->asked.constraints[i]);
        memory_free(plan->misses ? plan->misses[i] : NULL);
    }
    plan_order_finish(&plan->asked.order);
    finish_entries(&plan->list);
    finish_entries(&plan->infeasible);
    plan_bar_finish(&plan->bar);
    memory_free(plan->notes.items);
    memory_free(plan->asked.jitter.errors);
    memory_free(plan->asked.constraints);
    memory_free(plan->shanks);
    memory_free(plan->left);
    memory_free((void *)plan->misses);
    for (size_t k = 0; k < BESTS; k++) {
        memory_free(plan->bests[k].items);
        memory_free(plan->bests[k].keys);
    }
    memory_free(plan->workers);
    memory_free(plan->blocks);
    memory_free(plan);
}

static void reject(struct rejected *rejected, size_t line, const char *why)
{
    if (!rejected->count++) {
        rejected->line = line;
        snprintf(rejected->why, sizeof rejected->why, "%s", why);
        text_make_plain(rejected->why, "");
    }
}

static void add_rejected(struct rejected *sum, const struct rejected *more)
{
    uint64_t before = sum->count;
    *sum = before ? *sum : *more;
    sum->count = before + more->count;
}

static conus_status make_maps(conus_plan *plan)
{
    conus_status status = CONUS_OK;
    plan->was_mapped = true;
    for (size_t i = 0; i < plan->asked.count && !status; i++) {
        status = plan_constraint_map(&plan->asked.constraints[i], plan->asked.selector);
    }
    pthread_mutex_lock(&plan->lock);
    plan->bar.has_maps = !status;
    pthread_mutex_unlock(&plan->lock);
    return status;
}

/* Blocks are read while others are delivered, which may move the notes. */
static int64_t note_of(conus_plan *plan, uint64_t index)
{
    pthread_mutex_lock(&plan->lock);
    int64_t note = index < plan->notes.count ? plan->notes.items[index] : UNKNOWN;
    pthread_mutex_unlock(&plan->lock);
    return note;
}

/* Whether a run is about a pose. */
static bool is_asked(conus_plan *plan, uint64_t index)
{
    int64_t note = note_of(plan, index);
    bool may_have = note > BROKEN && (note < 0 ? -1 - note : note) >= plan->least;
    return plan->pass == PASS_SAMPLE ? (index * 0x9E3779B97F4A7C15 >> 32) % SAMPLE == 0
           : plan->pass == PASS_ALL  ? may_have || note == UNKNOWN
                                     : may_have || plan->pass == PASS_ONLY;
}

/* What is known of a pose. */
static void recall(struct plan_trial *trial, conus_plan *plan)
{
    int64_t note = note_of(plan, trial->planned.candidate - 1);
    trial->is_known = note > BROKEN;
    if (trial->is_known) {
        trial->planned.feasible = true;
        trial->planned.broken = SIZE_MAX;
        trial->is_measured = note >= 0;
        trial->planned.leeway = 1e-6 * (double)note;
    }
}

static conus_status read_block(void *user, size_t slot, bool *may_follow)
{
    conus_plan *plan = user;
    struct block *block = &plan->blocks[slot];
    conus_pose_row rows[BLOCK];
    conus_status status = CONUS_OK;
    size_t count = 1;
    block->count = 0;
    block->rejected = (struct rejected){0};
    buffer_clear(&block->strings);
    while (block->count < BLOCK && plan->rows && count && !status) {
        uint64_t number = pose_stream_position(plan->poses);
        size_t wanted = BLOCK - block->count;
        status = conus_pose_stream_read(rows, &count, plan->poses, wanted < plan->rows ? wanted : (size_t)plan->rows);
        plan->rows -= status ? 0 : count;
        for (size_t i = 0; i < count && !status; i++) {
            struct plan_trial *trial = &block->trials[block->count];
            if (!is_asked(plan, number + i)) {
                continue;
            }
            const char *why = plan_trial_begin(&trial->planned, &rows[i], &plan->asked);
            if (why) {
                if (plan->pass != PASS_SAMPLE && plan->pass != PASS_MORE) {
                    reject(&block->rejected, rows[i].line, why);
                }
                continue;
            }
            trial->planned.candidate = number + i + 1;
            trial->planned.verdicts = trial->verdicts;
            recall(trial, plan);
            trial->id = block->strings.size;
            buffer_append(&block->strings, rows[i].id, strlen(rows[i].id) + 1);
            block->count++;
        }
    }
    *may_follow = count && plan->rows;
    if (!status && !plan->asked.measures_all && !plan->was_mapped &&
        pose_stream_position(plan->poses) - plan->start >= MAPS_AFTER) {
        status = make_maps(plan);
    }
    return status ? status : buffer_status(&block->strings);
}

/* The best pose so far of a pose's entry or target, with its keys; NULL where it is not kept. */
static struct plan_best *best_of(double **keys, const conus_plan *plan, const struct plan_trial *trial, size_t kind)
{
    const struct bests *bests = &plan->bests[kind];
    uint64_t site = kind == OF_ENTRY ? trial->planned.entry : trial->planned.target;
    if (!site || site > bests->count) {
        return NULL;
    }
    *keys = bests->keys + (site - 1) * plan->asked.order.rank_count;
    return &bests->items[site - 1];
}

/* Sets the bar of pose `index` of a block: of the list, and of its entry and target, to which poses before it in the
 * block may come, too. */
static void set_bar(struct block *block, size_t index, const conus_plan *plan)
{
    struct plan_trial *trial = &block->trials[index];
    size_t count = plan->asked.order.rank_count;
    const double *least = plan->bar.keys;
    trial->has_bar = plan->bar.is_full;
    for (size_t k = 0; k < BESTS && trial->has_bar; k++) {
        double *keys = NULL;
        const struct plan_best *best = best_of(&keys, plan, trial, k);
        const double *most = best && best->candidate ? keys : NULL;
        for (size_t i = 0; i < index && best; i++) {
            const struct plan_trial *before = &block->trials[i];
            double *own = NULL;
            if (before->planned.feasible && before->is_measured && best_of(&own, plan, before, k) == best &&
                (!most || plan_keys_compare(before->keys, most, count) > 0)) {
                most = before->keys;
            }
        }
        trial->has_bar = !best || most;
        least = most && plan_keys_compare(most, least, count) < 0 ? most : least;
    }
    memcpy(trial->bar, least, count * sizeof *least);
}

static conus_status answer_block(void *user, size_t slot, size_t worker, const atomic_bool *stop)
{
    conus_plan *plan = user;
    struct block *block = &plan->blocks[slot];
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < block->count && !status && !atomic_load_explicit(stop, memory_order_relaxed); i++) {
        pthread_mutex_lock(&plan->lock);
        plan_bar_copy(&plan->workers[worker].bar, &plan->bar, &plan->asked);
        set_bar(block, i, plan);
        pthread_mutex_unlock(&plan->lock);
        plan->workers[worker].judge.leeway.uses_maps = plan->workers[worker].bar.has_maps;
        struct plan_trial *trial = &block->trials[i];
        status = (trial->is_known ? plan_trial_again : plan_trial_try)(trial, &plan->workers[worker], &plan->asked);
    }
    return status;
}

/* NULL without memory. */
static struct entry *keep(const struct plan_trial *trial, const struct block *block, const conus_plan *plan)
{
    const char *id = block->strings.data + trial->id;
    size_t verdicts = plan->asked.count * sizeof(conus_verdict);
    size_t keys = plan->asked.order.rank_count * sizeof(double);
    size_t size = strlen(id) + 1;
    struct entry *entry = memory_raw(1, sizeof *entry + verdicts + keys + size);
    if (entry) {
        char *behind = (char *)(entry + 1);
        *entry = (struct entry){trial->planned, (double *)(behind + verdicts), plan->asked.order.rank_count};
        entry->planned.verdicts = memcpy(behind, trial->verdicts, verdicts);
        memcpy(behind + verdicts, trial->keys, keys);
        entry->planned.id = memcpy(behind + verdicts + keys, id, size);
    }
    return entry;
}

static conus_status keep_in(struct entries *entries, const struct plan_trial *trial, const struct block *block,
                            const conus_plan *plan)
{
    struct entry *entry = keep(trial, block, plan);
    if (!entry || !memory_reserve(&entries->items, &entries->capacity, entries->count + 1, sizeof(struct entry *))) {
        memory_free(entry);
        return CONUS_ERROR_MEMORY;
    }
    entries->items[entries->count++] = entry;
    return CONUS_OK;
}

static int better_first(const void *a, const void *b)
{
    const struct entry *x = *(struct entry *const *)a;
    const struct entry *y = *(struct entry *const *)b;
    int order = plan_keys_compare(y->keys, x->keys, x->key_count);
    return order ? order : compare_unsigned(x->planned.candidate, y->planned.candidate);
}

/* Leaves the best poses of the list, best first. */
static void cut_list(conus_plan *plan)
{
    struct entries *list = &plan->list;
    order_sort((void *)list->items, list->count, sizeof(struct entry *), better_first);
    while (list->count > plan->asked.options.top) {
        memory_free(list->items[--list->count]);
    }
}

static void take_best(conus_plan *plan, const struct plan_trial *trial, size_t kind)
{
    size_t count = plan->asked.order.rank_count;
    double *keys = NULL;
    struct plan_best *best = best_of(&keys, plan, trial, kind);
    if (!best) {
        return;
    }
    best->feasible++;
    if (trial->is_measured && (!best->candidate || plan_keys_compare(trial->keys, keys, count) > 0)) {
        const conus_planned *planned = &trial->planned;
        size_t reach = 0;
        while (reach < plan->asked.count && plan->asked.constraints[reach].asked.kind != CONUS_CONSTRAINT_REACH) {
            reach++;
        }
        *best = (struct plan_best){best->feasible,
                                   planned->candidate,
                                   planned->leeway,
                                   planned->slack,
                                   planned->far,
                                   planned->entry_angle,
                                   reach < plan->asked.count ? trial->verdicts[reach].value : NAN};
        memcpy(keys, trial->keys, count * sizeof *keys);
    }
}

static conus_status take_feasible(conus_plan *plan, const struct plan_trial *trial, const struct block *block)
{
    struct entries *list = &plan->list;
    conus_status status = CONUS_OK;
    plan->bar.has_feasible = true;
    for (size_t k = 0; k < BESTS; k++) {
        take_best(plan, trial, k);
    }
    if (trial->is_measured && (plan->pass == PASS_ONLY || trial->keys[0] >= (double)plan->least)) {
        status = keep_in(list, trial, block, plan);
    }
    if (list->count > plan->asked.options.top &&
        list->count - plan->asked.options.top > plan->asked.options.top / 4 + SPARE) {
        cut_list(plan);
        plan->bar.is_full = true;
        memcpy(plan->bar.keys, list->items[list->count - 1]->keys, plan->asked.order.rank_count * sizeof(double));
    }
    return status;
}

static conus_status take_infeasible(conus_plan *plan, const struct plan_trial *trial, const struct block *block)
{
    size_t broken = trial->planned.broken;
    conus_status status = CONUS_OK;
    if (plan->asked.options.infeasible && plan->infeasible.count < plan->asked.options.top) {
        status = keep_in(&plan->infeasible, trial, block, plan);
        plan->bar.infeasible = plan->infeasible.count;
    }
    if (trial->is_lone && trial->is_measured && !plan->bar.has_feasible &&
        -trial->verdicts[broken].slack < plan->bar.misses[broken]) {
        memory_free(plan->misses[broken]);
        plan->misses[broken] = keep(trial, block, plan);
        plan->bar.misses[broken] = -trial->verdicts[broken].slack;
        status = plan->misses[broken] ? status : CONUS_ERROR_MEMORY;
    }
    return status;
}

static conus_status report_progress(const conus_plan *plan)
{
    conus_progress progress = plan->asked.options.progress;
    size_t tried = plan->pass == PASS_MORE ? 0 : (size_t)plan->left[0];
    return progress && !progress(plan->asked.options.progress_user, tried, 0)
               ? fail(CONUS_ERROR_CANCELLED, "the plan was cancelled")
               : CONUS_OK;
}

static conus_status note(conus_plan *plan, const struct plan_trial *trial)
{
    struct learnt *notes = &plan->notes;
    size_t index = (size_t)trial->planned.candidate - 1;
    if (plan->pass == PASS_ONLY) {
        return CONUS_OK;
    }
    if (!memory_reserve(&notes->items, &notes->capacity, index + 1, sizeof *notes->items)) {
        return CONUS_ERROR_MEMORY;
    }
    while (notes->count <= index) {
        notes->items[notes->count++] = UNKNOWN;
    }
    notes->items[index] = !trial->planned.feasible ? BROKEN
                          : trial->is_measured     ? (int64_t)trial->keys[0]
                                                   : -1 - nanometres(trial->most);
    return CONUS_OK;
}

static conus_status deliver_block(void *user, size_t slot)
{
    conus_plan *plan = user;
    const struct block *block = &plan->blocks[slot];
    conus_status status = CONUS_OK;
    pthread_mutex_lock(&plan->lock);
    for (size_t i = 0; i < block->count && !status; i++) {
        const struct plan_trial *trial = &block->trials[i];
        bool is_feasible = trial->planned.feasible;
        if (plan->pass == PASS_SAMPLE && !is_feasible) {
            continue; /* once all are looked at */
        }
        for (size_t k = 0; k <= plan->asked.count && (k == 0 || trial->planned.broken > k - 1) && !trial->is_known;
             k++) {
            plan->left[k]++;
        }
        status = note(plan, trial);
        status = status        ? status
                 : is_feasible ? take_feasible(plan, trial, block)
                               : take_infeasible(plan, trial, block);
    }
    pthread_mutex_unlock(&plan->lock);
    add_rejected(&plan->rejected, &block->rejected);
    return status ? status : report_progress(plan);
}

static void stop_reading(void *user)
{
    conus_pose_stream_stop(((conus_plan *)user)->poses);
}

/* Makes the list from the poses that were kept. */
static conus_status make_list(conus_plan *plan)
{
    cut_list(plan);
    for (size_t i = 0; i < plan->list.count; i++) {
        plan->list.items[i]->planned.rank = i + 1;
    }
    size_t more = plan->asked.options.top - plan->list.count < plan->infeasible.count
                      ? (size_t)(plan->asked.options.top - plan->list.count)
                      : plan->infeasible.count;
    if (!memory_reserve(&plan->list.items, &plan->list.capacity, plan->list.count + more + 1, sizeof(struct entry *))) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < more; i++) {
        plan->list.items[plan->list.count++] = plan->infeasible.items[i];
        plan->infeasible.items[i] = NULL;
    }
    plan->is_listed = true;
    return CONUS_OK;
}

static conus_status read_listed(void *user, size_t slot, bool *may_follow)
{
    conus_plan *plan = user;
    plan->blocks[slot].listed = plan->list.items[plan->listed++];
    *may_follow = plan->listed < plan->list.count;
    return CONUS_OK;
}

static conus_status ask_chances(void *user, size_t slot, size_t worker, const atomic_bool *stop)
{
    conus_plan *plan = user;
    struct entry *entry = plan->blocks[slot].listed;
    conus_status status = plan_jitter_ask(&entry->planned, (conus_verdict *)(entry + 1), &plan->workers[worker].judge,
                                          plan->asked.count, &plan->asked.jitter, true, 0, !plan->asked.measures_all);
    (void)stop;
    plan_order_keys(NULL, &entry->planned, &plan->asked.order); /* the score of infeasible poses, too */
    return status;
}

static conus_status deliver_listed(void *user, size_t slot)
{
    const conus_plan *plan = user;
    (void)slot;
    return plan->is_cut ? CONUS_OK : report_progress(plan);
}

/* Adds the probabilities of all listed poses. */
static conus_status add_chances(conus_plan *plan)
{
    return !plan->list.count || !plan->asked.jitter.errors
               ? CONUS_OK
               : ring_run(&(const struct ring){.user = plan,
                                               .workers = plan->asked.options.threads,
                                               .slots = ring_slots(plan->asked.options.threads),
                                               .read = read_listed,
                                               .answer = ask_chances,
                                               .deliver = deliver_listed});
}

static conus_status complete(conus_plan *plan)
{
    conus_status status = plan->is_listed ? CONUS_OK : make_list(plan);
    plan->listed = 0;
    status = status ? status : add_chances(plan);
    plan->is_done = !status;
    return status;
}

static conus_status run(conus_plan *plan, conus_pose_stream *poses, uint64_t limit)
{
    plan->was_run = true;
    plan->poses = poses;
    plan->rows = limit;
    plan->start = pose_stream_position(poses);
    pthread_mutex_init(&plan->lock, NULL);
    conus_status status = ring_run(&(const struct ring){.user = plan,
                                                        .workers = plan->asked.options.threads,
                                                        .slots = ring_slots(plan->asked.options.threads),
                                                        .read = read_block,
                                                        .answer = answer_block,
                                                        .deliver = deliver_block,
                                                        .interrupt = stop_reading});
    pthread_mutex_destroy(&plan->lock);
    return status ? status : complete(plan);
}

conus_status conus_plan_run(conus_plan *plan, conus_pose_stream *poses, uint64_t limit)
{
    return plan->was_run ? fail(CONUS_ERROR_ARGUMENT, "a plan is run once") : run(plan, poses, limit);
}

void plan_sample(conus_plan *plan)
{
    plan->pass = PASS_SAMPLE;
    plan->asked.order.in_nanometres = true;
    plan->asked.order.rank[0].step = 1e-6;
}

void plan_forget_list(conus_plan *plan)
{
    finish_entries(&plan->list);
}

conus_status plan_list_again(conus_plan *plan, conus_pose_stream *poses, int64_t least, uint64_t most)
{
    plan_forget_list(plan);
    plan->pass = plan->pass == PASS_SAMPLE ? PASS_ALL : PASS_MORE;
    plan->is_listed = plan->is_done = false;
    plan->least = least;
    plan->asked.options.top = most;
    plan->bar.is_full = true;
    plan->bar.keys[0] = (double)least;
    plan->bar.keys[1] = -INFINITY;
    return run(plan, poses, UINT64_MAX);
}

conus_status conus_plan_cut(conus_plan *plan)
{
    if (!plan->was_run || plan->is_done) {
        return fail(CONUS_ERROR_ARGUMENT, "a plan is cut once its run was cancelled");
    }
    plan->is_cut = true;
    return complete(plan);
}

size_t conus_plan_count(const conus_plan *plan)
{
    return plan && plan->is_done ? plan->list.count : 0;
}

const conus_planned *conus_plan_pose(const conus_plan *plan, size_t index)
{
    return index < conus_plan_count(plan) ? &plan->list.items[index]->planned : NULL;
}

bool plan_is_done(const conus_plan *plan)
{
    return plan && plan->is_done;
}

const struct plan_best *plan_bests(size_t *count, const conus_plan *plan, bool of_targets)
{
    const struct bests *bests = &plan->bests[of_targets ? OF_TARGET : OF_ENTRY];
    *count = bests->count;
    return bests->items;
}

uint64_t conus_plan_left(const conus_plan *plan, size_t constraints)
{
    return plan && constraints <= plan->asked.count ? plan->left[constraints] : 0;
}

const conus_planned *conus_plan_miss(const conus_plan *plan, size_t index)
{
    bool has_miss = plan->is_done && !plan->left[plan->asked.count] && index < plan->asked.count && plan->misses[index];
    return has_miss ? &plan->misses[index]->planned : NULL;
}

conus_plan_faults conus_plan_rejected(const conus_plan *plan)
{
    return (conus_plan_faults){plan->rejected.count, plan->rejected.line, plan->rejected.why};
}

const struct plan_asked *plan_asked_of(const conus_plan *plan)
{
    return &plan->asked;
}

void plan_measure_all(conus_plan *plan)
{
    plan->asked.measures_all = true;
}

struct plan_judge *plan_judge_of(conus_plan *plan)
{
    return &plan->workers[0].judge;
}

/* Tries a pose that is settled. */
static conus_status try_row(const conus_planned **out, conus_plan *plan, const conus_pose_row *row, uint64_t number)
{
    struct block *block = &plan->blocks[ring_slots(plan->asked.options.threads)];
    struct plan_trial *trial = block->trials;
    struct plan_judge *judge = plan_judge_of(plan);
    const char *why = plan_trial_begin(&trial->planned, row, &plan->asked);
    if (why) {
        return why == conus_message() ? CONUS_ERROR_ARGUMENT : fail(CONUS_ERROR_ARGUMENT, "%s", why);
    }
    buffer_clear(&block->strings);
    buffer_text(&block->strings, row->id ? row->id : "");
    conus_status status = buffer_status(&block->strings);
    trial->planned.candidate = number;
    trial->planned.id = block->strings.data;
    trial->planned.verdicts = trial->verdicts;
    trial->planned.broken = SIZE_MAX;
    plan_judge_turn(judge, &trial->planned);
    status = status ? status : plan_trial_measure(trial, judge, &plan->asked, PLAN_ALL);
    if (!status && plan->asked.jitter.errors) {
        status = plan_jitter_ask(&trial->planned, trial->verdicts, judge, plan->asked.count, &plan->asked.jitter, true,
                                 0, true);
        plan_order_keys(NULL, &trial->planned, &plan->asked.order);
    }
    for (size_t i = plan->asked.count; i-- > 0;) {
        trial->planned.broken = trial->verdicts[i].holds ? trial->planned.broken : i;
    }
    trial->planned.feasible = trial->planned.broken == SIZE_MAX;
    if (!status) {
        *out = &trial->planned;
    }
    return status;
}

conus_status conus_plan_try(const conus_planned **out, conus_plan *plan, const conus_pose_row *row)
{
    conus_pose_row asked = *row;
    conus_status status = row->error ? CONUS_OK : pose_settle(&asked.pose, row->pose.world_from_device);
    return status ? status : try_row(out, plan, &asked, 0);
}

conus_status plan_copy(conus_planned *out, const conus_plan *plan, const conus_planned *pose)
{
    char *id = memory_text(pose->id, strlen(pose->id));
    conus_verdict *verdicts = id ? memory_zeroed(plan->asked.count, sizeof *verdicts) : NULL;
    if (!verdicts) {
        memory_free(id);
        return CONUS_ERROR_MEMORY;
    }
    if (pose->verdicts) {
        memcpy(verdicts, pose->verdicts, plan->asked.count * sizeof *verdicts);
    }
    *out = *pose;
    out->id = id;
    out->verdicts = verdicts;
    return CONUS_OK;
}

void plan_copy_finish(conus_planned *copy)
{
    memory_free((void *)copy->id);
    memory_free((void *)copy->verdicts);
}

/* Where the pose of a row is, which was a candidate. */
static conus_status place_row(conus_planned *out, const conus_plan *plan, const conus_pose_row *row,
                              const conus_planned *known)
{
    const char *why = plan_trial_begin(out, row, &plan->asked);
    out->id = row->id ? row->id : "";
    out->candidate = known->candidate;
    out->leeway = known->leeway;
    return why ? fail(CONUS_ERROR_DATA, "%s", why) : CONUS_OK;
}

conus_status plan_find(conus_planned *copies, size_t count, conus_plan *plan, conus_pose_stream *poses, bool untried)
{
    conus_pose_row rows[BLOCK];
    size_t read = 1;
    size_t found = 0;
    conus_status status = CONUS_OK;
    while (read && found < count && !status) {
        uint64_t before = pose_stream_position(poses);
        status = conus_pose_stream_read(rows, &read, poses, BLOCK);
        while (!status && found < count && copies[found].candidate - before <= read) {
            const uint64_t number = copies[found].candidate;
            const conus_pose_row *row = &rows[number - before - 1];
            conus_planned place;
            const conus_planned *pose = &place;
            status = untried ? place_row(&place, plan, row, &copies[found]) : try_row(&pose, plan, row, number);
            status = status ? status : plan_copy(&copies[found++], plan, pose);
        }
    }
    return status;
}

conus_status conus_plan_distance(double *out, conus_plan *plan, size_t pose, size_t constraint, double depth)
{
    const conus_planned *planned = conus_plan_pose(plan, pose);
    if (!planned || constraint >= plan->asked.count || !plan->asked.constraints[constraint].has || !isfinite(depth)) {
        return fail(CONUS_ERROR_ARGUMENT, "pose %zu, constraint %zu, %g mm: no such pose, structure or depth", pose,
                    constraint, depth);
    }
    conus_planned point = *planned;
    point.near = point.far = depth;
    plan_judge_turn(plan_judge_of(plan), &point);
    *out = plan_judge_distance(plan_judge_of(plan), constraint);
    return CONUS_OK;
}

size_t conus_plan_constraint_count(const conus_plan *plan)
{
    return plan ? plan->asked.count : 0;
}

const conus_constraint *conus_plan_constraint(const conus_plan *plan, size_t index)
{
    return index < plan->asked.count ? &plan->asked.constraints[index].asked : NULL;
}

const char *conus_plan_name(const conus_plan *plan, size_t index)
{
    return index < plan->asked.count ? plan->asked.constraints[index].name : NULL;
}

bool conus_plan_is_about(const conus_plan *plan, size_t index, uint32_t object)
{
    const bool *named = index < plan->asked.count ? plan->asked.constraints[index].named : NULL;
    const conus_atlas *atlas = plan->asked.selector->atlas;
    while (named && object && object <= atlas->object_count && !named[object]) {
        object = atlas->objects[object - 1].parent;
    }
    return named && object && object <= atlas->object_count;
}
