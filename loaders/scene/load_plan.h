/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Which surfaces a manifest's "areas" name, before any of them is read. Only loaders/load*.c include it. */
#ifndef CONUS_LOADERS_SCENE_LOAD_PLAN_H
#define CONUS_LOADERS_SCENE_LOAD_PLAN_H

#include "base/file.h"
#include "loaders/scene/load.h"
#include "loaders/scene/manifest.h"
#include "loaders/surfaces/mesh_file.h"

/** A surface that becomes an area. */
struct planned_area {
    char *path;         /**< Where it lies, seen from this process; owned.                                        */
    size_t entry;       /**< Of the manifest's list: areas[entry].                                                */
    struct label label; /**< As far as it is known: number always, name NULL where the file may have one.         */
    bool is_part;       /**< Of plan.sheets[sheet], by its label there.                                           */
    size_t sheet;
    uint32_t part;
    bool placed; /**< world_from_mesh holds; else the manifest's space, or what the file says.             */
    double world_from_mesh[16];
    struct file_state state; /**< Of the file, before it was read.                                               */
};

/** A surface that the labels of its vertices cut into areas. */
struct planned_sheet {
    char *path; /**< Of the surface; owned.                  */
    struct vertex_labels labels;
};

struct area_plan {
    struct planned_sheet *sheets;
    size_t sheet_count;
    struct planned_area *areas; /**< Sorted by label, no two with the same.                                       */
    size_t count;
    size_t capacity;
    uint64_t max_memory;       /**< For each file; 0 = the default.                                               */
    struct file_sums read;     /**< What names and labels come from.                                              */
    struct label_table groups; /**< Nodes of the area tree without a surface of their own; sorted.                */
};

void planned_area_finish(struct planned_area *area);
void area_plan_finish(struct area_plan *plan);

/** Finds the files of all entries. @p path is the manifest's. Errors name the key, not the manifest. */
conus_status area_plan_make(struct area_plan *out, const struct manifest *manifest, const char *path,
                            struct notes *notes);

/** The planned area of @p label, or NULL. */
struct planned_area *area_plan_find(const struct area_plan *plan, uint32_t label);

/** Settles who has a label that both the plan and the parcellation have, as the manifest prefers; in the parcellation
 * that remains, and in the plan, no label is there twice. A name that only the parcellation's table has is the
 * surface's. */
conus_status area_plan_settle(struct area_plan *plan, struct parcellation *parts, enum manifest_preference preference);

/** How many files area_plan_load() would read. */
size_t area_plan_files(const struct area_plan *plan);

/** Reads the surfaces and adds them to @p atlas, then the groups; links parents. */
conus_status area_plan_load(struct area_plan *plan, conus_atlas *atlas, const struct manifest *manifest,
                            const conus_load_options *options, struct load_progress *progress);

#endif
