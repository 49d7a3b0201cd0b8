/* SPDX-License-Identifier: BSD-3-Clause */
/** @file A selection that the window and the painter hold together; it ends with the last of them. */
#ifndef CONUS_VIEWER_PICTURES_ANSWER_H
#define CONUS_VIEWER_PICTURES_ANSWER_H

#include "conus/selection.h"

struct answer;

/** Takes @p selection over. NULL without memory, and then it is the caller's still. */
struct answer *answer_create(conus_selection *selection);
struct answer *answer_keep(struct answer *answer);                    /**< NULL is fine. */
void answer_drop(struct answer *answer);                              /**< NULL is fine. */
const conus_selection *answer_selection(const struct answer *answer); /**< NULL for NULL. */

#endif
