/* SPDX-License-Identifier: BSD-3-Clause */
/* Follows a device: ranks with a history, and confirms what the trigger selects. */
#include "base/memory.h"
#include "base/options.h"
#include "selection/selection.h"
#include "selection/study/study.h"

#include <math.h>
#include <string.h>

#define DEFAULT_WINDOW 2.0
#define DEFAULT_STICKINESS 0.5
#define DEFAULT_SNAPPINESS 0.5
#define DEFAULT_RATE 60.0
#define DEFAULT_GROWTH 7.5
#define DEFAULT_DECAY 5.0
#define DEFAULT_EXPONENT (4.0 / 5.0)
#define DEFAULT_DELAY 0.15
#define LIMIT 1e6

/* Times that differ by less are the same: what a device's clock and decimal digits make of them. */
#define MOMENT 1e-9

/* From when on an object was selected. */
struct choice {
    double time;
    uint32_t object;
};

struct conus_tracker {
    conus_selector *selector;
    conus_tracker_options options; /* defaults filled in */
    struct history history;
    struct choice *choices; /* within the window, and the last one before it; by time */
    size_t choice_count, choice_capacity;
    struct history_sample *samples;
    size_t sample_capacity;
    bool held; /* the trigger, at the last step */
};

static double value_or(double value, double standard)
{
    return value != 0 ? value : standard;
}

static conus_status check_options(const conus_tracker_options *options)
{
    const struct {
        const char *name;
        double value, high;
        bool open;
    } ranges[] = {{"window", options->window, LIMIT, false},     {"stickiness", options->stickiness, 1, true},
                  {"snappiness", options->snappiness, 1, false}, {"rate", options->rate, LIMIT, false},
                  {"growth", options->growth, LIMIT, false},     {"decay", options->decay, LIMIT, false},
                  {"exponent", options->exponent, 1, false}};
    for (size_t i = 0; i < sizeof ranges / sizeof ranges[0]; i++) {
        double value = ranges[i].value;
        double high = ranges[i].high;
        if (!(value > 0 && (ranges[i].open ? value < high : value <= high))) {
            return fail(CONUS_ERROR_ARGUMENT, "%s: %g, allowed is more than 0 and %s %g", ranges[i].name, value,
                        ranges[i].open ? "less than" : "at most", high);
        }
    }
    if (!(options->delay >= 0 && options->delay <= options->window)) {
        return fail(CONUS_ERROR_ARGUMENT, "delay: %g s, allowed is at most the window, %g s", options->delay,
                    options->window);
    }
    return CONUS_OK;
}

conus_status conus_tracker_create(conus_tracker **out, conus_selector *selector, const conus_tracker_options *options)
{
    conus_tracker_options all = *options_of(conus_tracker_options, options);
    all.window = value_or(all.window, DEFAULT_WINDOW);
    all.stickiness = value_or(all.stickiness, DEFAULT_STICKINESS);
    all.snappiness = value_or(all.snappiness, DEFAULT_SNAPPINESS);
    all.rate = value_or(all.rate, DEFAULT_RATE);
    all.growth = value_or(all.growth, DEFAULT_GROWTH);
    all.decay = value_or(all.decay, DEFAULT_DECAY);
    all.exponent = value_or(all.exponent, DEFAULT_EXPONENT);
    all.delay = all.delay < 0 ? 0 : value_or(all.delay, fmin(DEFAULT_DELAY, all.window));
    conus_status status = check_options(&all);
    if (!status && selector->options.weight) {
        status = fail(CONUS_ERROR_ARGUMENT, "weight: a track has none");
    }
    conus_tracker *tracker = status ? NULL : memory_zeroed(1, sizeof *tracker);
    if (!tracker) {
        return status ? status : CONUS_ERROR_MEMORY;
    }
    const struct history_constants constants = {.window = all.window,
                                                .intent_rate = -all.rate * log(all.stickiness),
                                                .intent_gain = all.snappiness / (1 - all.stickiness),
                                                .growth = all.growth,
                                                .decay = all.decay};
    tracker->selector = selector;
    tracker->options = all;
    status = history_init(&tracker->history, selector->atlas->object_count, &constants);
    if (status) {
        memory_free(tracker);
        return status;
    }
    *out = tracker;
    return CONUS_OK;
}

void conus_tracker_destroy(conus_tracker *tracker)
{
    if (tracker) {
        history_finish(&tracker->history);
        memory_free(tracker->choices);
        memory_free(tracker->samples);
        memory_free(tracker);
    }
}

const conus_tracker_options *tracker_options(const conus_tracker *tracker)
{
    return &tracker->options;
}

/* All that a step may need, so that it cannot fail half way. */
static conus_status reserve(conus_tracker *tracker, conus_selection *selection, size_t *sample_count)
{
    struct statistics *statistics = &selection->statistics;
    if (!memory_reserve(&tracker->samples, &tracker->sample_capacity, statistics->count, sizeof *tracker->samples) ||
        !memory_reserve(&tracker->choices, &tracker->choice_capacity, tracker->choice_count + 1,
                        sizeof *tracker->choices)) {
        return CONUS_ERROR_MEMORY;
    }
    *sample_count = statistics->count - 1; /* the last is CONUS_KIND_UNASSIGNED */
    for (size_t i = 0; i < *sample_count; i++) {
        const conus_result *result = &statistics->results[i];
        double contribution = score_contribution(result, &selection->cone, tracker->options.exponent);
        tracker->samples[i] = (struct history_sample){result->object, contribution};
    }
    conus_status status = history_reserve(&tracker->history, tracker->samples, *sample_count);
    conus_result *results = NULL;
    if (!status) {
        results = memory_resize(statistics->results, statistics->count + tracker->history.count, sizeof *results);
    }
    if (!results) {
        return CONUS_ERROR_MEMORY;
    }
    statistics->results = results;
    return CONUS_OK;
}

/* An object in the cone counts, and one that left it while its score lasts. */
static bool counts(const conus_tracker *tracker, const struct memory *memory)
{
    return memory->last.inside || history_has_score(memory, tracker->selector->ranking.history);
}

/* Puts objects that are not in the cone, but stay in the ranking, in front of the last result, CONUS_KIND_UNASSIGNED.
 */
static void add_absent(conus_selection *selection, const conus_tracker *tracker)
{
    struct statistics *statistics = &selection->statistics;
    const struct choice *last = tracker->choice_count ? &tracker->choices[tracker->choice_count - 1] : NULL;
    for (size_t i = 0; i < tracker->history.count; i++) {
        const struct memory *memory = &tracker->history.memories[i];
        bool can_be_confirmed = (last && last->object == memory->object) || /* up to now */
                                memory->last_choice >= tracker->history.time - tracker->options.delay - MOMENT;
        if (!memory->last.inside && (counts(tracker, memory) || can_be_confirmed)) {
            conus_result absent = statistics_empty_result(memory->object);
            absent.kind = conus_atlas_object(tracker->selector->atlas, memory->object)->kind;
            statistics->results[statistics->count] = statistics->results[statistics->count - 1];
            statistics->results[statistics->count++ - 1] = absent;
        }
    }
}

static void choose(conus_tracker *tracker, uint32_t object)
{
    if (tracker->history.steps == 1) { /* started afresh */
        tracker->choice_count = 0;
    }
    uint32_t last = tracker->choice_count ? tracker->choices[tracker->choice_count - 1].object : 0;
    if (!tracker->choice_count || last != object) {
        tracker->choices[tracker->choice_count++] = (struct choice){tracker->history.time, object};
    }
    history_choose(&tracker->history, last); /* it was the choice up to now */
    history_choose(&tracker->history, object);
    double since = tracker->history.time - tracker->options.window - MOMENT;
    size_t gone = 0;
    while (gone + 1 < tracker->choice_count && tracker->choices[gone + 1].time <= since) {
        gone++;
    }
    tracker->choice_count -= gone;
    if (gone) {
        memmove(tracker->choices, tracker->choices + gone, tracker->choice_count * sizeof *tracker->choices);
    }
}

uint32_t conus_tracker_selected(const conus_tracker *tracker, double ago)
{
    if (!tracker || !tracker->choice_count) {
        return 0;
    }
    double time = tracker->history.time - ago + MOMENT;
    uint32_t object = tracker->choices[0].object;
    for (size_t i = 0; i < tracker->choice_count && tracker->choices[i].time <= time; i++) {
        object = tracker->choices[i].object;
    }
    return object;
}

conus_status conus_tracker_step(conus_selection **out, conus_tracker *tracker, double time_s, const conus_pose *pose,
                                double angle, bool trigger)
{
    conus_selection *selection = NULL;
    size_t count = 0;
    if (!isfinite(time_s)) {
        return fail(CONUS_ERROR_ARGUMENT, "time_s: %g, allowed are finite numbers", time_s);
    }
    if (tracker->history.steps && time_s < tracker->history.time) {
        return fail(CONUS_ERROR_ARGUMENT, "time_s: %.10g is before the last step, %.10g", time_s,
                    tracker->history.time);
    }
    conus_status status = selection_trace(&selection, tracker->selector, pose, angle);
    status = status ? status : reserve(tracker, selection, &count);
    if (status) {
        conus_selection_destroy(selection);
        return status;
    }
    history_step(&tracker->history, time_s, tracker->samples, count);
    add_absent(selection, tracker);
    selection_rank(selection, tracker->selector, &tracker->history);
    uint32_t first = 0;                                                      /* object that counts and has a score */
    for (size_t i = 0; i + 1 < selection->statistics.count && !first; i++) { /* the last is CONUS_KIND_UNASSIGNED */
        const conus_result *result = &selection->statistics.results[i];
        bool has_score = !isnan(result->score);
        first = has_score && counts(tracker, history_find(&tracker->history, result->object)) ? result->object : 0;
    }
    choose(tracker, first);
    bool pressed = trigger && !tracker->held;
    tracker->held = trigger;
    selection->is_step = true;
    selection->step = (conus_step){.time_s = time_s,
                                   .selected = conus_tracker_selected(tracker, 0),
                                   .confirmed = pressed ? conus_tracker_selected(tracker, tracker->options.delay) : 0};
    *out = selection;
    return CONUS_OK;
}
