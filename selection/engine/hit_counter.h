/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Counts of first hits that the device makes (render/id/cone_count.h), for the gl engine: the shape of cones
 * goes there as an aperture has it, and rows come back as counts. Needs a current context throughout. */
#ifndef CONUS_SELECTION_ENGINE_HIT_COUNTER_H
#define CONUS_SELECTION_ENGINE_HIT_COUNTER_H

#include "render/id/id_pass.h"
#include "selection/cone/aperture.h"
#include "selection/evidence/counts.h"

struct hit_counter;

/** @p pass has @p volumes of @p atlas, of those numbers. Both must outlive the counter; @p group [object_count + 1], as
 * what each object is reported, need not (NULL = as itself). @p out is NULL on a driver that does not round as it must.
 */
conus_status hit_counter_create(struct hit_counter **out, const conus_atlas *atlas, const struct id_pass *pass,
                                const size_t *volumes, size_t volume_count, const uint32_t *group);
/** NULL is fine. */
void hit_counter_destroy(struct hit_counter *counter);

/** Appends to each of @p count @p out what the pixels in its cone hit first. The cones have the pixels of @p aperture,
 * which is prepared for each angle that the device does not have. */
conus_status hit_counter_count(struct hit_counter *counter, struct hit_counts *const *out,
                               const struct cone *const *cones, size_t count, struct aperture *aperture);

#endif
