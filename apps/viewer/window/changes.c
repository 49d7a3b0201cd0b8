/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of states, and a place in it. */
#include "viewer/window/window.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

void changes_add(struct changes *changes, char *state)
{
    if (changes->count && strcmp(changes->states[changes->at], state) == 0) {
        free(state);
        return;
    }
    while (changes->count > changes->at + 1) { /* those behind the place */
        free(changes->states[--changes->count]);
    }
    if (changes->count == CHANGES_LIMIT) {
        free(changes->states[0]);
        changes->count--;
        memmove(changes->states, changes->states + 1, changes->count * sizeof *changes->states);
    }
    changes->at = changes->count;
    changes->states[changes->count++] = state;
}

void changes_renew(struct changes *changes, char *state)
{
    if (!changes->count) {
        changes_add(changes, state);
        return;
    }
    free(changes->states[changes->at]);
    changes->states[changes->at] = state;
}

bool changes_reach(const struct changes *changes, int by)
{
    return by < 0 ? changes->at > 0 : changes->at + 1 < changes->count;
}

const char *changes_step(struct changes *changes, int by)
{
    bool is_there = changes_reach(changes, by);
    if (is_there) {
        changes->at = by < 0 ? changes->at - 1 : changes->at + 1;
    }
    return is_there ? changes->states[changes->at] : NULL;
}

void changes_finish(struct changes *changes)
{
    for (size_t i = 0; i < changes->count; i++) {
        free(changes->states[i]);
    }
    *changes = (struct changes){.count = 0};
}
