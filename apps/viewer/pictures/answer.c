/* SPDX-License-Identifier: BSD-3-Clause */
/* A selection with a count of its holders. */
#include "viewer/pictures/answer.h"

#include <stdatomic.h>
#include <stdlib.h>

struct answer {
    conus_selection *selection;
    atomic_uint holders;
};

struct answer *answer_create(conus_selection *selection)
{
    struct answer *answer = malloc(sizeof *answer);
    if (answer) {
        answer->selection = selection;
        atomic_init(&answer->holders, 1);
    }
    return answer;
}

struct answer *answer_keep(struct answer *answer)
{
    if (answer) {
        atomic_fetch_add(&answer->holders, 1);
    }
    return answer;
}

void answer_drop(struct answer *answer)
{
    if (answer && atomic_fetch_sub(&answer->holders, 1) == 1) {
        conus_selection_destroy(answer->selection);
        free(answer);
    }
}

const conus_selection *answer_selection(const struct answer *answer)
{
    return answer ? answer->selection : NULL;
}
