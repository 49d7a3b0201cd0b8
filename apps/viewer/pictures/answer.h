/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A selection that the window and the painter hold together; it ends with the last of them. */
#ifndef CONUS_VIEWER_PICTURES_ANSWER_H
#define CONUS_VIEWER_PICTURES_ANSWER_H

#include "conus/selection.h"

#include <stddef.h>
#include <stdint.h>

struct answer;

/** Takes @p selection over. NULL without memory, and then it is the caller's still. */
struct answer *answer_create(conus_selection *selection);
struct answer *answer_keep(struct answer *answer);                    /**< NULL is fine. */
void answer_drop(struct answer *answer);                              /**< NULL is fine. */
const conus_selection *answer_selection(const struct answer *answer); /**< NULL for NULL. */

/** Takes most of the colour out of [count] pixels of a picture of an answer that is old. */
void answer_pale(uint8_t *rgba, size_t count);

#endif
