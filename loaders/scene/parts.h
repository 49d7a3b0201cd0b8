/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The steps from a scene to its atlas, and what they share. */
#ifndef CONUS_LOADERS_SCENE_PARTS_H
#define CONUS_LOADERS_SCENE_PARTS_H

#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "base/files/file.h"
#include "base/job/job.h"
#include "loaders/cifti/cifti.h"
#include "loaders/manifest/manifest.h"
#include "loaders/maps/maps.h"
#include "loaders/scene/scene.h"
#include "loaders/surfaces/surfaces.h"

/* A load of conus_atlas_load(): its job, the callbacks of its options, and the atlas that it makes. */

struct load {
    struct job job; /**< Its notes and files wait there for atlas_take(). */
    const conus_load_options *options;
    conus_atlas *atlas;    /**< NULL until load_create(). */
    struct note_sink sink; /**< It gives notes to options->log, with the path of the file that is read. */
    char *path;            /**< That path, unless it is the caller's. */
};

/** Begins a load of @p path, as it was asked for, which must outlive it. End it with load_end(). */
void load_begin(struct load *out, const char *path, const conus_load_options *options);

/** Ends the load and gives the atlas away, or destroys it after a failure, or where @p out is NULL. */
conus_status load_end(conus_atlas **out, struct load *load);

/** Notes from here on are about the file @p path, which is copied. */
void load_at(struct load *load, const char *path);

/** The same, and job_report(). */
void load_report(struct load *load, const char *path, size_t files);

/** Makes the atlas of @p count volumes, as atlas_create_of() does, with the notes so far; of none an empty one. */
void load_create(struct load *load, struct labelled_volume *volumes, size_t count, const struct label_table *table,
                 const char *label_source);

/** The name mesh_file_name() of the surface @p path; NULL after a failure. */
char *mesh_name(struct job *job, const char *path);

/** Notes and files of a load that its atlas gets later: */
struct deferred_notes {
    struct notes notes;
    struct file_sums files;
};

/** puts those of the job aside, and then back, in front of those that it has got since. Both calls are made in one
 * function, also after a failure. */
struct deferred_notes load_defer_notes(struct load *load);
void load_release_notes(struct load *load, struct deferred_notes *deferred);

/* Contexts from files. */

/** Sets the volume @p path, or adds the surface, as @p item says. The atlas may be changed after a failure. */
void context_load(struct job *job, conus_atlas *atlas, const char *path, bool is_surface,
                  const struct scene_item *item);

/** Whether context_load() would have nothing to note about the volume @p path, but of its voxels: by its header. */
bool context_is_plain(struct job *job, const conus_atlas *atlas, const char *path);

/* Moves an atlas by a file. */

/** conus_atlas_transform(), but that notes are the job's, and the atlas may have some of them after a failure. */
void transform_load(struct job *job, conus_atlas *atlas, const char *path, const conus_transform_options *options);

/* Several parcellations that become one atlas: whose a label is, and whose a voxel. */

/** The parcellations of a manifest, which are the job's: each is read and shifted, then they are united, settled with
 * surfaces (area_plan_settle()), and joined. */
struct parcellations {
    struct parcellation *parts; /**< [count], earlier ones have priority; joined, one for each grid. */
    size_t count;
    struct label_table table; /**< Once united: of all, sorted; its texts are the job's. */
    const char *source;       /**< Once united: where the names come from, in words. */
};

/** @p label + @p offset; a failure where that gets too large. */
uint32_t label_raise(struct job *job, uint32_t label, uint32_t offset);

/** Adds @p offset to the labels of voxels and table; areas whose table says no hemisphere get @p hemisphere, unless it
 * is 0. CONUS_ERROR_DATA where a label gets too large. */
void parcellation_shift(struct job *job, struct parcellation *part, uint32_t offset, char hemisphere);

/** Moves tables and sources of the parts together. What a table says of a label that has voxels in another part only is
 * left out. CONUS_ERROR_DATA where two parts have voxels with one label. */
void parcellations_unite(struct job *job, struct parcellations *all);

/** Takes from each part the voxels whose centre lies in an area of an earlier one, which notes say; then parts on the
 * same grid become one. */
void parcellations_join(struct job *job, struct parcellations *all);

/** Makes the load's atlas of @p count parts. */
void parcellations_atlas(struct load *load, struct parcellation *parts, size_t count, const struct label_table *table,
                         const char *source);

/** The value of @p label, put in as 0 if it is new. Valid until the next call; a spare one after a failure. */
uint64_t *map_at(struct job *job, struct label_map *map, uint32_t label);

/* The list of surfaces that a manifest makes areas: made, settled with the parcellation, loaded. It is the job's,
 * with all texts in it. */

/** A surface that the labels of its vertices, or its objects, cut into areas; or a whole one, its own only object. */
struct labelled_surface {
    const struct scene_item *item;
    const char *path;        /**< The surface's. */
    const char *labels_path; /**< NULL where its objects are the areas. */
    struct vertex_labels labels;
    struct mesh_parts objects; /**< With the table of `labels`; none where vertices have labels. */
    struct mesh mesh;          /**< Once it is read, until it is cut, */
    struct label said;         /**< and what its file says of it. */
    struct file_state state;   /**< As of a planned area. */
};

/** A surface that becomes an area. */
struct planned_area {
    const char *path; /**< Where it lies, seen from this process. */
    const struct scene_item *item;
    struct label label; /**< As far as it is known: number always, name NULL where the file may have one. */
    const struct labelled_surface *surface; /**< The one of which it is the part `part`; NULL: it is no part. */
    uint32_t part;
    bool placed; /**< world_from_mesh holds; else the manifest's space, or what the file says. */
    double world_from_mesh[16];
    struct file_state state; /**< State of the file before it was read. */
};

struct area_plan {
    struct labelled_surface *labelled; /**< [labelled_count] */
    size_t labelled_count;
    LIST(struct planned_area) areas; /**< Sorted by label, no two with the same. */
    bool has_ccf;                    /**< Surfaces are of the Allen CCF, whose corner is the world's origin, */
    bool ccf_from_right;             /**< and whose ML counts from the right. */
    const char *names;               /**< Where the names of the last item's areas come from, in words. */
    struct label_table *groups;      /**< Nodes of the area tree without a surface of their own; sorted. */
};

/** The planned area of @p label, or NULL. */
struct planned_area *area_plan_find(const struct area_plan *plan, uint32_t label);

/** How many files are to be read for it. */
size_t area_plan_files(const struct area_plan *plan);

/** Finds the files of all surfaces of @p scene, whose path is @p path. Errors name the key, not the manifest. */
void area_plan_make(struct job *job, struct area_plan *out, const struct scene *scene, const char *path);

/** Gives each label that both the plan and the united parcellations have to the surface or to the voxels, as the
 * manifest prefers; after that no label is there twice. A surface without a name takes that of the parcellation's
 * table. */
void area_plan_settle(struct job *job, struct area_plan *plan, struct parcellations *all,
                      enum scene_preference preference);

/** Reads the surfaces, whose coordinates are in @p space where nothing else says so, and adds them to the atlas, then
 * the groups; links parents. */
void area_plan_load(struct load *load, struct area_plan *plan, enum mesh_space space);

/* An atlas of BrainGlobe's third release as a scene. */

/** Makes the scene of the atlas whose manifest.json is in @p folder (with '/' at its end): the annotation's level of
 * its resolution is the parcellation, named by terminology.csv, and the template's the context, if it was downloaded.
 * Names in it count from *root, a folder with '/' at its end. The job is made of manifest.json then. An annotation that
 * was not downloaded is CONUS_ERROR_IO, whose message says how to do so. What @p out (zeroed) has is the job's. */
void plan_brainglobe(struct job *job, struct scene *out, const char **root, const char *folder);

/* A .dlabel.nii with the surfaces beside it as a scene. */

/** Makes the scene of the map that @p file has chosen: its voxels are the parcellation, each of its surfaces an
 * entry of areas, with the surface beside it that docs/formats.md chooses. Structures without a label in the map are
 * left out. A surface that shares labels with the voxels or with a surface before it gets a label_offset. Names in it
 * are relative to the file's folder. Notes say which surfaces were taken. Errors carry the path. What @p out
 * (zeroed) has is the job's. */
void plan_cifti(struct job *job, struct scene *out, const struct cifti_file *file);

/* From a scene to the atlas that it describes. */

/** Loads what the manifest in @p file, the bytes of @p path, names. What the job has noted and read before comes behind
 * the atlas's own. */
void manifest_load(struct load *load, const char *path, const struct bytes *file);

/** Loads @p scene, which was made up for the file or folder (with '/' at its end) @p path, likewise. @p names says
 * where the names of its surfaces come from. NULL: it is one file that is ATLAS, which no message calls a manifest. */
void scene_load(struct load *load, const struct scene *scene, const char *path, const char *names);

/** Loads the volumes of @p path that @p maps names as areas of probabilities, if their values are some. */
void named_maps_load(struct load *load, const char *path, const struct named_maps *maps);

/** Loads the FSL atlas XML @p path, of another type than Label: its labels are areas of probabilities, of the finest
 * image. */
void probabilities_load(struct load *load, const char *path);

#endif
