/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The list of surfaces that a manifest makes areas, before any of them is read. */
#ifndef CONUS_LOADERS_SCENE_AREA_PLAN_H
#define CONUS_LOADERS_SCENE_AREA_PLAN_H

#include "base/files/file_sums.h"
#include "loaders/surfaces/mesh_file.h"

/** A surface that becomes an area. */
struct planned_area {
    char *path;         /**< Where it lies, seen from this process; owned.                                        */
    size_t entry;       /**< Of the manifest's list: areas[entry].                                                */
    struct label label; /**< As far as it is known: number always, name NULL where the file may have one.         */
    bool is_part;       /**< Of plan.labelled[surface], by its label there. */
    size_t surface;
    uint32_t part;
    bool placed; /**< world_from_mesh holds; else the manifest's space, or what the file says.             */
    double world_from_mesh[16];
    struct file_state state; /**< Of the file, before it was read.                                               */
};

/** A surface that the labels of its vertices cut into areas. */
struct labelled_surface {
    char *path; /**< Of the surface; owned.                  */
    struct vertex_labels labels;
};

struct area_plan {
    struct labelled_surface *labelled;
    size_t labelled_count;
    struct planned_area *areas; /**< Sorted by label, no two with the same.                                       */
    size_t count;
    size_t capacity;
    uint64_t max_memory;       /**< For each file; 0 = the default.                                               */
    struct file_sums read;     /**< What names and labels come from.                                              */
    bool has_ccf;              /**< Surfaces are of the Allen CCF, whose corner is the world's origin,            */
    bool ccf_from_right;       /**< and whose ML counts from the right.                                           */
    struct label_table groups; /**< Nodes of the area tree without a surface of their own; sorted.                */
};

void planned_area_finish(struct planned_area *area);
void area_plan_finish(struct area_plan *plan);

/** Appends a copy of @p label with the surface @p path, which is taken over in any case. */
conus_status area_plan_add(struct area_plan *plan, size_t entry, char *path, const struct label *label);

/** Appends a copy of @p label to the groups. */
conus_status area_plan_add_group(struct area_plan *plan, const struct label *label);

/** Sorts the areas by label, so that area_plan_find() finds them. */
void area_plan_sort(struct area_plan *plan);

/** The planned area of @p label, or NULL. */
struct planned_area *area_plan_find(const struct area_plan *plan, uint32_t label);

/** How many files are to be read for it. */
size_t area_plan_files(const struct area_plan *plan);

#endif
