/* SPDX-License-Identifier: BSD-3-Clause */
/** @file From evidence to one result per object met. */
#ifndef CONUS_SELECTION_STATISTICS_H
#define CONUS_SELECTION_STATISTICS_H

#include "selection/evidence.h"

struct statistics {
    conus_result *results; /**< In order of object number, then what hit nothing (object 0); kind,
                              rank and score are still to be set. */
    size_t count;
};

void statistics_finish(struct statistics *statistics);

/** Gathers pixels, share (Eq. 4), nearest distance, smallest offset and contact (Eq. 11) of each object that an
 * in-cone pixel of @p evidence met first. @p object_count bounds the object numbers. */
conus_status statistics_gather(struct statistics *out, const struct evidence *evidence, const struct cone *cone,
                               size_t object_count);

/** World position of the contact of pixel column @p i, row @p j: apex + distance x ray. */
void evidence_position(double out[3], const struct evidence *evidence, const struct cone *cone, uint32_t i, uint32_t j);

#endif
