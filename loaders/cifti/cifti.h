/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * CIFTI-2 files of labels (.dlabel.nii): NIfTI-2 with intent code 3007, whose XML says which vertex or voxel each
 * number belongs to. Strict: what contradicts itself is refused. docs/formats.md lists what is read. */
#ifndef CONUS_LOADERS_CIFTI_CIFTI_H
#define CONUS_LOADERS_CIFTI_CIFTI_H

#include "base/files/file.h"
#include "loaders/labels/label_cells.h"

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
    uint32_t *indices;    /**< [count] vertices, ascending; or [count] voxels of the volume, i fastest.          */
};

/** A Label of a LabelTable, not yet judged. */
struct cifti_label {
    struct label_entry entry;
    struct text name;
};

struct cifti_map {
    char *name; /**< NULL if it is empty. */
    LIST(struct cifti_label) labels;
};

/** What it points to is the job's. */
struct cifti {
    LIST(struct cifti_map) maps;
    struct cifti_model *models; /**< By their first grayordinate; they follow each other without gap. */
    size_t model_count, model_capacity;
    size_t count;       /**< Grayordinates. */
    const void *values; /**< [count][maps.count], borrowed from the file's bytes. */
    int datatype;
    bool swapped;
    size_t dim[3];               /**< Size of the volume in which the voxels lie; 0 if there is none. */
    double world_from_voxel[16]; /**< RAS mm. */
};

/** Parses the whole file @p file. No array has more bytes than the job's max_memory. */
void cifti_parse(struct job *job, struct cifti *out, const struct bytes *file);

/** Makes the table of a map into the empty @p out, sorted; label 0 is nothing. */
void cifti_table(struct job *job, struct label_table *out, const struct cifti_map *map);

/** Labels of all grayordinates in map @p map, whose table is @p table: cifti->count, 0 = no area. Negative ones become
 * 0, with a note. CONUS_ERROR_DATA for one that is not whole, or that the table lacks. */
uint32_t *cifti_labels(struct job *job, const struct cifti *cifti, size_t map, const struct label_table *table);

#endif
