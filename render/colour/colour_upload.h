/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Moves an atlas into the GL objects of a colour pass. Private to the pass: only colour.c includes it.
 * @p memory_left is in bytes; each upload takes its textures off. */
#ifndef CONUS_RENDER_COLOUR_COLOUR_UPLOAD_H
#define CONUS_RENDER_COLOUR_COLOUR_UPLOAD_H

#include "render/colour/colour.h"
#include "render/colour/field_task.h"

enum {
    TABLE_PER_LEVEL = 4, /**< Entries of the transfer table for each step between neighbouring densities. */
    COLOUR_TABLE_ENTRIES = (FIELD_LEVELS - 1) * TABLE_PER_LEVEL + 1
};

/** Creates the buffers and the tables by object number. */
conus_status colour_upload_palette(struct colour_pass *pass, const conus_atlas *atlas);

/** The field that colour_upload_objects() needs; of nothing, where that depends on what is drawn. */
struct field_task colour_objects_task(const conus_atlas *atlas);

/** The one that colour_upload_context() needs; @p volume may be NULL. CONUS_ERROR_MEMORY. */
conus_status colour_context_task(struct field_task *out, const struct volume *volume, const struct transfer *transfer);

/** Uploads the parcellation, whose field @p task makes, but for its texels. In an atlas with pathways the areas would
 * hide them: then it uploads the pathways, those in
 * @p hazy as haze, and only the areas in pass->drawn (NULL = none). */
conus_status colour_upload_objects(struct colour_pass *pass, const conus_atlas *atlas, const struct haze_choice *hazy,
                                   struct field_task *task, uint64_t *memory_left);

/** Uploads the context that @p task is of, but for its texels. */
conus_status colour_upload_context(struct colour_pass *pass, struct field_task *task, const struct transfer *transfer,
                                   uint64_t *memory_left);

/** Uploads the texels of @p volume as @p task makes them, which ends with them; none where it is of nothing. */
conus_status colour_upload_texels(const struct colour_volume *volume, struct field_task *task);

conus_status colour_upload_meshes(struct colour_pass *pass, const conus_atlas *atlas, uint64_t *memory_left);

/** Adds the corners of the whole grid to the content: for an atlas in which nothing shows. */
conus_status colour_add_corners(struct colour_pass *pass, const struct colour_volume *volume);

#endif
