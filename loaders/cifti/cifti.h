/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * CIFTI-2 files of labels (.dlabel.nii): NIfTI-2 with intent code 3007, whose XML says which vertex or voxel each
 * number belongs to. Strict: what contradicts itself is refused. docs/formats.md lists what is read. */
#ifndef CONUS_LOADERS_CIFTI_CIFTI_H
#define CONUS_LOADERS_CIFTI_CIFTI_H

#include "base/files/file.h"
#include "loaders/labels/label_format.h"

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

/* A .dlabel.nii as a file, one map of it, and what that says of vertices and voxels. */

/** One map of a file. What it points to is the job's. */
struct cifti_choice {
    struct cifti cifti; /**< Without values. */
    size_t map;
    struct label_table table; /**< Of the map, sorted; label 0 is nothing. */
    uint32_t *labels;         /**< [cifti.count] of the grayordinates; 0 = no area. */
};

/** Parses @p file and takes the map @p wanted (map_choice_make()). NULL after a failure. */
struct cifti_choice *cifti_choose(struct job *job, const struct bytes *file, struct text wanted);

/** The surface that GIFTI calls @p structure, or NULL. */
const struct cifti_model *cifti_choice_surface(const struct cifti_choice *choice, const char *structure);

/** Whether the file has voxels. */
bool cifti_choice_has_voxels(const struct cifti_choice *choice);

/** The labels that @p model has, or all voxels where that is NULL: *count, sorted, each once, without 0. */
uint32_t *cifti_list(struct job *job, size_t *count, const struct cifti_choice *choice,
                     const struct cifti_model *model);

/** Labels of all vertices of the surface @p model: [model->vertex_count], 0 for those that the file leaves out. The
 * empty @p table gets what the map says of those that there are. NULL after a failure. */
uint32_t *cifti_vertices(struct job *job, struct label_table *table, const struct cifti_choice *choice,
                         const struct cifti_model *model);

/** Labels of all voxels of the volume, [dim[0] dim[1] dim[2]], i fastest, likewise. The hemisphere of a label is that
 * of the structures that have it, if it is one. */
uint32_t *cifti_voxels(struct job *job, struct label_table *table, const struct cifti_choice *choice);

/** A file, opened by its path with ",map=K" or ",map=NAME" behind it. */
struct cifti_file {
    const char *path; /**< Without what chooses the map. */
    char sha256[65];  /**< SHA-256 of the file as it is stored. */
    struct cifti_choice *choice;
};

/** Opens @p path, a .dlabel.nii (FORMAT_CIFTI), plain or gzip. Notes and errors carry the path. NULL after a failure.
 */
struct cifti_file *cifti_file_open(struct job *job, const char *path);

#endif
