/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The list of surfaces that a manifest makes areas: made, settled with the parcellation, loaded. It is the
 * job's, with all texts in it. */
#ifndef CONUS_LOADERS_SCENE_AREA_PLAN_H
#define CONUS_LOADERS_SCENE_AREA_PLAN_H

#include "atlas/surface/mesh_split.h"
#include "loaders/manifest/scene.h"
#include "loaders/scene/load_progress.h"
#include "loaders/surfaces/mesh_file.h"

struct parcellations;

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

#endif
