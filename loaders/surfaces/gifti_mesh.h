/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Surfaces and labels of vertices from the arrays of a GIFTI file. */
#ifndef CONUS_LOADERS_SURFACES_GIFTI_MESH_H
#define CONUS_LOADERS_SURFACES_GIFTI_MESH_H

#include "atlas/surface/mesh.h"
#include "loaders/surfaces/gifti.h"

/** The surface of the first POINTSET and the first TRIANGLE array, in world mm, not yet checked by mesh_check().
 * @p as_stored: coordinates are taken as they are; else they are placed as docs/spaces.md says, with a note where
 * the file leaves doubt. */
conus_status gifti_mesh(struct mesh *out, const struct gifti *gifti, bool as_stored, struct notes *notes);

/** Labels of the vertices in LABEL array @p map (of those, from 0): *labels has *count, 0 = no area; the caller's to
 * memory_free(). Negative ones become 0, with a note. None (NULL, 0) where the file has no LABEL array and @p map is 0.
 */
conus_status gifti_labels(uint32_t **labels, size_t *count, const struct gifti *gifti, size_t map, struct notes *notes);

/** The LABEL array that @p wanted, a number from 0 or a name, is of @p gifti. The first if it is empty; a note names
 * the others then, if there are any. CONUS_ERROR_ARGUMENT for a name that none or several have; a number is checked by
 * gifti_labels(). */
conus_status gifti_map_find(size_t *out, const struct gifti *gifti, struct text wanted, struct notes *notes);

#endif
