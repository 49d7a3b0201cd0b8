/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes of numbers that an atlas has: areas of probability, pathways, contexts, regions of interest; and
 * which files are maps. */
#ifndef CONUS_LOADERS_MAPS_MAPS_H
#define CONUS_LOADERS_MAPS_MAPS_H

#include "atlas/atlas.h"
#include "atlas/volume.h"
#include "base/child/hdf5.h"
#include "base/job/job.h"
#include "loaders/labels/labels.h"
#include "loaders/manifest/manifest.h"
#include "loaders/volumes/volumes.h"
#include "sources/source.h"

/* An atlas to which a job adds something, and the volumes that it reads for that. */

/** How much an atlas has. */
struct atlas_mark {
    size_t notes, files, objects, volumes, context_surfaces;
};
struct atlas_mark atlas_mark(const conus_atlas *atlas);

/** Moves the notes and files that the job has so far to the atlas. */
void atlas_take(struct job *job, conus_atlas *atlas);

/** Ends @p job, whose notes and files were taken, at the border. After a failure the atlas has what it had at @p mark.
 */
conus_status atlas_close(struct job *job, conus_atlas *atlas, struct atlas_mark mark);

/** A volume file, all 0, which the job finishes; NULL after a failure. */
struct volume_file *volume_file_new(struct job *job);

/* Areas of probabilistic atlases: one volume of probabilities each. */

/** How a file says how probable something is. */
struct probability_scale {
    double value;      /**< The value that means "certainly"; 0: the largest value of each volume, which is a mask. */
    const char *words; /**< "percent", for notes. */
};

/** A volume as it was read. */
struct probability_map {
    conus_volume_info info;
    struct value_map map;
};

/** The volumes of a file, read one after the other. */
struct probability_maps {
    struct volume_file *file;        /**< Opened as a series. */
    struct probability_map *volumes; /**< [count] Those that are kept, else zeros. */
    size_t count;
    struct value_spread spread; /**< Over all that were read, */
    bool masks;                 /**< and whether each has 0 and one other value. */
};

/** None is read yet. The job's; NULL after a failure. @p file must live as long as volumes are read and added. */
struct probability_maps *probability_maps_new(struct job *job, struct volume_file *file);

/** Reads volume @p volume; keeps it only if @p kept. */
void probability_maps_read(struct job *job, struct probability_maps *maps, size_t volume, bool kept);

/** The scale of the file, of which all volumes were read. It is @p stated unless that is 0; else value_scale_of() of
 * all volumes, but for masks, which have any value. Strays below 0 or above the scale are warned of. CONUS_ERROR_DATA
 * for others (value_spread_strays()), and where there is no usual scale. */
struct probability_scale probability_scale_of(struct job *job, const struct probability_maps *maps, double stated);

/** Adds volume @p volume, which was kept and no longer is, divided by @p scale, as the area @p label, of the voxels
 * with probabilities from @p threshold on. The atlas gets the job's notes, too. */
void probability_add(struct job *job, conus_atlas *atlas, struct probability_maps *maps, size_t volume,
                     const struct label *label, const struct probability_scale *scale, double threshold);

/* Volumes whose values are numbers: pathways, the context and regions of interest. */

/** The item that @p options describe, which must outlive it; without a file. */
struct scene_item pathway_item(const conus_pathway_options *options);

/** Adds the chosen volume of @p file as a pathway, or its bands as pathways, by the threshold, name, unit and bands of
 * @p item. The atlas gets the job's notes, too. */
void pathway_add(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item);

/** Sets the chosen volume of @p file as the context. @p item says from which value on voxels block; an opacity is an
 * error. The atlas gets the job's notes, too. */
void context_set(struct job *job, conus_atlas *atlas, struct volume_file *file, const struct scene_item *item);

/** Makes a region of interest of the chosen volume of @p file; @p threshold as in conus_roi_options. @p out, the
 * caller's, is set only where all went well. */
void roi_of_volume(struct job *job, conus_roi **out, struct volume_file *file, double threshold);

/* An FSL atlas of type Probabilistic or Statistic, and the 4-D image with a volume per label. */

/** What it has is the job's. */
struct fsl_maps {
    const struct label_table *labels; /**< Sorted; label k is volume k - 1 of the image. Never NULL. */
    bool has_background;              /**< Volume 0 is called background and has no label: label k of a summary is
                                         volume k. */
    struct volume_file *image;        /**< A series; NULL after a failure. */
    struct notes *notes;              /**< Notes of opening the image, which no sink has had yet: for notes_move(). */
};

/** Reads the atlas @p xml and opens @p image, or the finest of its images where that is NULL. @p atlas gets the XML as
 * one of its files, and notes about it. Errors begin with "fsl: ". */
struct fsl_maps fsl_maps_open(struct job *job, conus_atlas *atlas, const char *xml, const char *image,
                              const conus_load_options *options);

/* A file that is an atlas of probabilities by itself: because a table names its volumes, or because its name or an
 * option states that it is one map. */

/** What it has is the job's. */
struct named_maps {
    const struct label_table *table; /**< Its numbers are those of the volumes, from 1; without the background's. Never
                                        NULL. */
    const char *source;              /**< For people: where the names come from. */
    struct notes *notes;             /**< About the table, which no sink has had yet: for notes_move(); NULL = none. */
    bool chosen;                     /**< The path chooses the one volume of the table. */
    bool is_one; /**< There is one volume, which the file or the user states to be of probabilities. */
};

/** Finds out whether all volumes of @p path, which @p source has open, are named: the file has several, ",volume=K"
 * chooses none, and the table of @p options, or one beside the file, says for certain which volume each name belongs
 * to; the job's result is made of that table then. Where a probability of @p options or the name
 * (named_maps_is_probseg()) states that they are probabilities, one volume, or the chosen one, has its file's name.
 * Otherwise, and with labels_anyway, the table is empty. CONUS_ERROR_ARGUMENT where the table of @p options does not
 * name the volumes, or nothing names stated ones. */
struct named_maps named_maps_find(struct job *job, const struct source *source, const char *path,
                                  const conus_load_options *options);

/** Refuses @p file, opened as a series, where its values may be labels, or images of one thing, and neither its name
 * nor @p asked, the probability of the options, says that they are probabilities (docs/formats.md has the
 * rule). */
void named_maps_check(struct job *job, struct volume_file *file, double asked);

/** Whether the name of the file says that its values are probabilities, as BIDS has it: X_probseg.nii.gz. */
bool named_maps_is_probseg(const char *path);

/* Meshes with fields of SimNIBS in HDF5 (Msh.write_hdf5): tetrahedra with an electric field, say. */

/** The objects of a file that simnibs_find() needs. */
extern const char *const simnibs_wanted[];
enum { SIMNIBS_WANTED = 10 };

/** Whether @p hdf5 has a mesh with nodes and elements. */
bool simnibs_is(const struct hdf5 *hdf5);

/** The tetrahedra of the mesh in @p hdf5 that has the field of @p keys, and their values: of vectors their length.
 * Without a field it is |E|: magnE, normE (as SimNIBS 3 calls it), or the length of E. Only those of their
 * tissues, if it has some. Nodes are finite and within 10 m of the origin; values are as they are. The arrays are the
 * job's. CONUS_ERROR_ARGUMENT for a field or tissue that is not there. Notes name keys->path, errors do
 * not. */
struct roi_mesh simnibs_find(struct job *job, const struct hdf5 *hdf5, const struct source_keys *keys);

#endif
