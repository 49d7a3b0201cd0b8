/* SPDX-License-Identifier: BSD-3-Clause */
/* A selection with a count of its holders. */
#include "viewer/pictures/pictures.h"

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

void answer_pale(uint8_t *rgba, size_t count)
{
    enum { KEPT = 3, OF = 10 }; /* of the colour */
    for (uint8_t *pixel = rgba; pixel < rgba + 4 * count; pixel += 4) {
        int grey = (3 * pixel[0] + 6 * pixel[1] + pixel[2]) / 10;
        for (int c = 0; c < 3; c++) {
            pixel[c] = (uint8_t)(grey + (pixel[c] - grey) * KEPT / OF);
        }
    }
}
