/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * CIFTI-2 files of labels (.dlabel.nii): NIfTI-2 with intent code 3007, whose XML says which vertex or voxel each
 * number belongs to. Strict: what contradicts itself is refused. docs/formats.md lists what is read. */
#ifndef CONUS_LOADERS_CIFTI_CIFTI_H
#define CONUS_LOADERS_CIFTI_CIFTI_H

#include "atlas/labels/labels.h"

/** Most bytes before the values: header and XML. */
enum { CIFTI_HEAD_LIMIT = 64 << 20 };

/** A brain structure of CIFTI-2, and what GIFTI calls it. */
struct cifti_structure {
    const char *word; /**< In CIFTI: "CIFTI_STRUCTURE_CORTEX_LEFT".              */
    const char *name; /**< In GIFTI's AnatomicalStructurePrimary: "CortexLeft".  */
    char side;        /**< 'L', 'R' or 0.                                        */
};

/** A BrainModel: the vertices of a surface, or the voxels, of one structure. */
struct cifti_model {
    const struct cifti_structure *structure; /**< Static.                                                        */
    bool is_surface;
    size_t offset, count; /**< Its grayordinates.                                                                */
    size_t vertex_count;  /**< Vertices of the whole surface.                                                    */
    uint32_t *indices;    /**< [count] vertices, ascending; or [count] voxels of the volume, i fastest; owned.   */
};

struct cifti_map {
    char *name;               /**< NULL if it is empty. */
    struct label_table table; /**< Sorted; label 0 is nothing. */
    struct notes notes;       /**< About the table. */
};

struct cifti {
    struct cifti_map *maps;
    size_t map_count;
    struct cifti_model *models; /**< By their first grayordinate; they follow each other without gap. */
    size_t model_count;
    size_t count;       /**< Grayordinates. */
    const void *values; /**< [count][map_count], borrowed from the file's bytes. */
    int datatype;
    bool swapped;
    size_t dim[3];               /**< Size of the volume in which the voxels lie; 0 if there is none. */
    double world_from_voxel[16]; /**< RAS mm. */
};

void cifti_finish(struct cifti *cifti);

/** Parses the whole file @p data, which must outlive @p out. No array has more than @p max_memory bytes. */
conus_status cifti_parse(struct cifti *out, const uint8_t *data, size_t size, uint64_t max_memory);

/** Labels of all grayordinates in map @p map: *out has cifti->count, 0 = no area; the caller's to memory_free().
 * Negative ones become 0, with a note. CONUS_ERROR_DATA for one that is not whole, or that the map's table lacks. */
conus_status cifti_labels(uint32_t **out, const struct cifti *cifti, size_t map, struct notes *notes);

#endif
