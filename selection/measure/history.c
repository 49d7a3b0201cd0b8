/* SPDX-License-Identifier: BSD-3-Clause */
/* The history that a track keeps of its objects. */
#include "selection/measure/score.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* An object that enters or leaves. The beginning of the history finds objects inside without their having entered. */
struct change {
    double time;
    bool counts;
};

double filter_linear(double state, double rate, double from, double to, double dt)
{
    double x = rate * dt;
    if (!(x > 0)) {
        return state;
    }
    double moved = -expm1(-x); /* 1 - e^-x */
    return state + (from - state) * moved + (to - from) * (1 - moved / x);
}

/* When u - s, which is `lead` at first and follows e' = slope - rate e, becomes 0; INFINITY if it never does. */
static double crossing(double lead, double rate, double slope)
{
    bool closing = lead > 0 ? slope < 0 : slope > 0;
    return lead != 0 && closing ? log1p(-rate * lead / slope) / rate : INFINITY;
}

double filter_asymmetric(double state, double growth, double decay, double from, double to, double dt)
{
    if (!(dt > 0)) {
        return state;
    }
    double slope = (to - from) / dt;
    double lead = from - state;
    bool grows = lead != 0 ? lead > 0 : slope > 0;
    double rate = grows ? growth : decay;
    double until = crossing(lead, rate, slope);
    if (until >= dt) {
        return filter_linear(state, rate, from, to, dt);
    }
    double met = from + slope * until; /* where both are equal; from there on s follows u at the other rate */
    return filter_linear(met, grows ? decay : growth, met, to, dt - until);
}

conus_status history_init(struct history *out, size_t object_count, const struct history_constants *constants)
{
    uint32_t *slots = memory_zeroed(object_count + 1, sizeof *slots);
    if (!slots) {
        return CONUS_ERROR_MEMORY;
    }
    *out = (struct history){.constants = *constants, .slots = slots};
    return CONUS_OK;
}

void history_finish(struct history *history)
{
    for (size_t i = 0; i < history->count; i++) {
        memory_free(history->memories[i].changes);
    }
    memory_free(history->memories);
    memory_free(history->slots);
    *history = (struct history){0};
}

static struct memory *memory_of(const struct history *history, uint32_t object)
{
    uint32_t slot = history->slots[object];
    return slot ? &history->memories[slot - 1] : NULL;
}

const struct memory *history_find(const struct history *history, uint32_t object)
{
    return memory_of(history, object);
}

conus_status history_reserve(struct history *history, const struct history_sample *samples, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t object = samples[i].object;
        if (memory_of(history, object)) {
            continue;
        }
        if (!memory_reserve(&history->memories, &history->capacity, history->count + 1, sizeof *history->memories)) {
            return CONUS_ERROR_MEMORY;
        }
        history->memories[history->count++] = (struct memory){.object = object, .last_choice = -INFINITY};
        history->slots[object] = (uint32_t)history->count;
    }
    for (size_t i = 0; i < history->count; i++) {
        struct memory *memory = &history->memories[i];
        if (!memory_reserve(&memory->changes, &memory->change_capacity, memory->change_count + 1,
                            sizeof *memory->changes)) {
            return CONUS_ERROR_MEMORY;
        }
    }
    return CONUS_OK;
}

static void advance(struct memory *memory, const struct history *history, double time)
{
    const struct history_constants *constants = &history->constants;
    const struct moment last = memory->last;
    const struct moment now = memory->now;
    double dt = history->steps ? time - history->time : 0;
    double gain = constants->intent_gain;
    memory->intent =
        filter_linear(memory->intent, constants->intent_rate, gain * last.contribution, gain * now.contribution, dt);
    memory->plus =
        filter_asymmetric(memory->plus, constants->growth, constants->decay, last.contribution, now.contribution, dt);
    if (last.inside != now.inside) { /* somewhere between the two steps */
        memory->changes[memory->change_count++] = (struct change){time - dt / 2, history->steps > 0};
    }
    memory->last = now;
    size_t gone = 0;
    while (gone < memory->change_count && memory->changes[gone].time <= time - constants->window) {
        memory->inside_before = !memory->inside_before;
        gone++;
    }
    memory->change_count -= gone;
    if (gone && memory->change_count) {
        memmove(memory->changes, memory->changes + gone, memory->change_count * sizeof *memory->changes);
    }
}

static bool is_worth_keeping(const struct history *history, const struct memory *memory)
{
    return memory->last.inside || history_has_score(memory, HISTORY_ALL) ||
           memory->last_choice >= history->time - history->constants.window;
}

void history_step(struct history *history, double time, const struct history_sample *samples, size_t count)
{
    if (history->steps && time - history->time > history->constants.window) {
        /* Empty memories stay: history_reserve() has made room in them. */
        for (size_t i = 0; i < history->count; i++) {
            struct memory *memory = &history->memories[i];
            *memory = (struct memory){.object = memory->object,
                                      .last_choice = -INFINITY,
                                      .changes = memory->changes,
                                      .change_capacity = memory->change_capacity};
        }
        history->steps = 0;
    }
    for (size_t i = 0; i < history->count; i++) {
        history->memories[i].now = (struct moment){false, 0};
    }
    for (size_t i = 0; i < count; i++) {
        memory_of(history, samples[i].object)->now = (struct moment){true, samples[i].contribution};
    }
    for (size_t i = 0; i < history->count; i++) {
        advance(&history->memories[i], history, time);
    }
    history->time = time;
    history->steps++;
    for (size_t i = history->count; i-- > 0;) {
        if (!is_worth_keeping(history, &history->memories[i])) {
            struct memory *memory = &history->memories[i];
            history->slots[memory->object] = 0;
            memory_free(memory->changes);
            if (i != --history->count) { /* the last memory takes the place of the one that is forgotten */
                *memory = history->memories[history->count];
                history->slots[memory->object] = (uint32_t)i + 1;
            }
        }
    }
}

void history_choose(struct history *history, uint32_t object)
{
    struct memory *memory = memory_of(history, object);
    if (memory) {
        memory->last_choice = history->time;
    }
}

bool history_has_score(const struct memory *memory, unsigned parts)
{
    bool in_window = memory->inside_before || memory->change_count;
    return ((parts & HISTORY_WINDOW) && in_window) || ((parts & HISTORY_INTENT) && memory->intent >= HISTORY_LEAST) ||
           ((parts & HISTORY_PLUS) && memory->plus >= HISTORY_LEAST);
}

double history_time(const struct history *history, const struct memory *memory)
{
    double window = history->constants.window;
    double since = history->time - window;
    double sum = 0;
    bool inside = memory->inside_before;
    for (size_t i = 0; i < memory->change_count; i++) {
        sum += inside ? memory->changes[i].time - since : 0;
        since = memory->changes[i].time;
        inside = !inside;
    }
    sum += inside ? history->time - since : 0;
    return fmin(1, fmax(0, sum / window));
}

double history_stability(const struct history *history, const struct memory *memory)
{
    size_t crossings = 0;
    for (size_t i = 0; i < memory->change_count; i++) {
        crossings += memory->changes[i].counts;
    }
    return fmax(0, 1 - (double)crossings / (history->constants.window * HISTORY_RESTLESS));
}
