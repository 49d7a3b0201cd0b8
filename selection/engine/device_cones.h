/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Cones whose rays the device makes (render/id/id_pass.h), for the gl engine. Their shapes go there as the CPU
 * has them; rows come back as counts. Needs a current context throughout. */
#ifndef CONUS_SELECTION_ENGINE_DEVICE_CONES_H
#define CONUS_SELECTION_ENGINE_DEVICE_CONES_H

#include "render/id/id_pass.h"
#include "selection/cone/cone.h"
#include "selection/evidence/evidence.h"

/** After a failure all but its end is lost. */
struct device_cones;

/** @p pass has the volumes of @p atlas. Both must outlive them. @p out is NULL on a driver that does not round as it
 * must. */
conus_status device_cones_create(struct device_cones **out, const conus_atlas *atlas, struct id_pass *pass);
/** NULL is fine. */
void device_cones_destroy(struct device_cones *cones);

/** Appends to each of @p count @p out what the pixels in its cone hit first. The cones have the pixels of @p aperture,
 * which is prepared for each angle that the device does not have. @p group [object_count + 1], as what each object is
 * reported (NULL = as itself), is that of the first call. */
conus_status device_cones_count(struct device_cones *cones, struct hit_counts *const *out, const struct cone *const *in,
                                size_t count, struct aperture *aperture, const uint32_t *group);

/** Says which rays device_cones_make_rays() makes: those of @p ray_count pixels, of which number k is pixel
 * list[k] % n^2 of cone list[k] / n^2; the cones have n x n pixels. All pixels are listed one cone after the
 * other, in an order that n tells. */
conus_status device_cones_list(struct device_cones *cones, const struct cone *const *in, size_t count,
                               const uint32_t *list, uint32_t ray_count);

/** Makes them in volume number @p volume of the pass, which takes them from there. */
conus_status device_cones_make_rays(struct device_cones *cones, size_t volume);

#endif
