/* SPDX-License-Identifier: BSD-3-Clause */
/* Areas of a manifest that are the structures of a BrainGlobe folder: structures.json, metadata.json and
 * meshes/ID.obj. */
#include "loaders/scene/plan_brainglobe.h"

#include "atlas/frame.h"
#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/brainglobe/brainglobe_metadata.h"
#include "loaders/labels/label_file.h"

#include <stdio.h>
#include <string.h>

static const double micrometres = 0.001; /* BrainGlobe's unit, in mm */

/* A BrainGlobe folder while it is looked through. */
struct brainglobe {
    char *folder;
    struct label_table structures;
    char **meshes;  /* [structures.count] paths, NULL where there is no file */
    bool *contains; /* [structures.count] another one with a mesh */
};

static void brainglobe_finish(struct brainglobe *brainglobe)
{
    for (size_t i = 0; brainglobe->meshes && i < brainglobe->structures.count; i++) {
        memory_free(brainglobe->meshes[i]);
    }
    memory_free(brainglobe->meshes);
    memory_free(brainglobe->contains);
    memory_free(brainglobe->folder);
    label_table_finish(&brainglobe->structures);
}

static conus_status find_meshes(struct brainglobe *brainglobe)
{
    struct label_table *table = &brainglobe->structures;
    brainglobe->meshes = memory_zeroed(table->count, sizeof *brainglobe->meshes);
    brainglobe->contains = memory_zeroed(table->count, sizeof *brainglobe->contains);
    conus_status status = brainglobe->meshes && brainglobe->contains ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < table->count; i++) {
        struct buffer path = {0};
        buffer_format(&path, "%s/meshes/%u.obj", brainglobe->folder, table->entries[i].number);
        status = buffer_status(&path);
        if (status || !file_exists(path.data)) {
            buffer_finish(&path);
        }
        brainglobe->meshes[i] = path.data;
    }
    return status;
}

/* Marks everything above each structure that has a mesh. */
static void mark_containers(struct brainglobe *brainglobe)
{
    struct label_table *table = &brainglobe->structures;
    for (size_t i = 0; i < table->count; i++) {
        const struct label *at = brainglobe->meshes[i] ? &table->entries[i] : NULL;
        while (at && at->has_parent) {
            at = label_table_find(table, at->parent);
            bool *contains = at ? &brainglobe->contains[at - table->entries] : NULL;
            at = contains && !*contains ? at : NULL; /* else all above it is marked */
            if (at) {
                *contains = true;
            }
        }
    }
}

static conus_status open_brainglobe(struct brainglobe *brainglobe, struct area_plan *plan,
                                    const struct manifest_area *area, const char *path, struct notes *notes)
{
    const struct label_use use = {.max_memory = plan->max_memory, .read = &plan->read};
    const char *format;
    struct buffer table = {0};
    brainglobe->folder = file_beside(path, area->brainglobe);
    conus_status status = brainglobe->folder ? CONUS_OK : CONUS_ERROR_MEMORY;
    buffer_format(&table, "%s/structures.json", status ? "" : brainglobe->folder);
    status = status ? status : buffer_status(&table);
    status = status ? status : label_file_read(&brainglobe->structures, &format, table.data, &use, notes);
    status = status ? status : find_meshes(brainglobe);
    buffer_finish(&table);
    if (!status) {
        mark_containers(brainglobe);
    }
    return status;
}

static conus_status plan_structures(struct area_plan *plan, size_t entry, struct brainglobe *brainglobe, bool all,
                                    const double world_from_mesh[16])
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < brainglobe->structures.count; i++) {
        const struct label *label = &brainglobe->structures.entries[i];
        if (brainglobe->meshes[i] && (all || !brainglobe->contains[i])) {
            status = area_plan_add(plan, entry, brainglobe->meshes[i], label);
            brainglobe->meshes[i] = NULL;
            if (!status) {
                struct planned_area *area = &plan->areas[plan->count - 1];
                area->placed = true;
                memcpy(area->world_from_mesh, world_from_mesh, sizeof area->world_from_mesh);
            }
        } else if (brainglobe->contains[i]) {
            status = area_plan_add_group(plan, label);
        }
    }
    return status;
}

/* Whether the folder says by its name or by the size of its grid that it is the Allen CCF, with axes as that has. */
static void find_ccf(struct area_plan *plan, const struct brainglobe_metadata *metadata)
{
    double size[3];
    for (int i = 0; i < 3; i++) {
        size[i] = (double)metadata->shape[i] * metadata->resolution[i];
    }
    bool is_asr = text_equal_ignoring_case(text_from(metadata->orientation), "asr");
    bool is_asl = text_equal_ignoring_case(text_from(metadata->orientation), "asl");
    plan->has_ccf = (is_asr || is_asl) && (metadata->is_allen_mouse || frame_is_ccf_size(size));
    plan->ccf_from_right = is_asr;
}

/* From stored coordinates to the world; *orientation is that of the entry, else of metadata.json, else "asr". */
static conus_status place_meshes(double world_from_mesh[16], char orientation[BRAINGLOBE_ORIENTATION], double scale,
                                 const struct brainglobe *brainglobe, const struct manifest_area *area,
                                 struct area_plan *plan)
{
    bool found = false;
    struct buffer folder = {0};
    struct brainglobe_metadata metadata = {.orientation = "asr"};
    const double scales[3] = {scale, scale, scale};
    buffer_format(&folder, "%s/", brainglobe->folder);
    conus_status status = buffer_status(&folder);
    if (!status && area->orientation) {
        snprintf(metadata.orientation, sizeof metadata.orientation, "%s", area->orientation);
    } else {
        status = status ? status : brainglobe_metadata_read(&metadata, &found, folder.data, &plan->read);
    }
    buffer_finish(&folder);
    memcpy(orientation, metadata.orientation, BRAINGLOBE_ORIENTATION);
    find_ccf(plan, &metadata);
    return status ? status : brainglobe_axes(world_from_mesh, orientation, scales);
}

conus_status plan_brainglobe(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                             struct notes *notes)
{
    struct brainglobe brainglobe = {0};
    char orientation[BRAINGLOBE_ORIENTATION];
    double world_from_mesh[16];
    double scale = area->scale > 0 ? area->scale : micrometres;
    size_t before = plan->count;
    conus_status status = open_brainglobe(&brainglobe, plan, area, path, notes);
    status = status ? status : place_meshes(world_from_mesh, orientation, scale, &brainglobe, area, plan);
    status = status ? status : plan_structures(plan, entry, &brainglobe, area->all_structures, world_from_mesh);
    if (!status && plan->count == before) {
        status = fail(CONUS_ERROR_DATA, "brainglobe: %s/meshes holds no ID.obj of structures.json", area->brainglobe);
    }
    if (!status) {
        status = notes_add(notes,
                           "%s: %zu surfaces, stored times %g is mm, axes start at \"%s\"; the world's origin is that "
                           "corner",
                           brainglobe.folder, plan->count - before, scale, orientation);
    }
    brainglobe_finish(&brainglobe);
    return status;
}
