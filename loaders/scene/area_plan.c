/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of surfaces and groups that the "areas" and the "tree" of a manifest give. */
#include "loaders/scene/area_plan.h"

#include "atlas/frame.h"
#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/brainglobe/brainglobe_metadata.h"
#include "loaders/labels/label_file.h"
#include "loaders/scene/parcellations.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void planned_area_finish(struct planned_area *area)
{
    memory_free(area->path);
    label_finish(&area->label);
}

void area_plan_finish(struct area_plan *plan)
{
    for (size_t i = 0; i < plan->count; i++) {
        planned_area_finish(&plan->areas[i]);
    }
    for (size_t i = 0; i < plan->labelled_count; i++) {
        memory_free(plan->labelled[i].path);
        vertex_labels_finish(&plan->labelled[i].labels);
    }
    memory_free(plan->labelled);
    file_sums_finish(&plan->read);
    memory_free(plan->areas);
    label_table_finish(&plan->groups);
    *plan = (struct area_plan){0};
}

/* Appends a copy of `label` with the surface `path`, which is taken over in any case. */
static conus_status area_plan_add(struct area_plan *plan, size_t entry, char *path, const struct label *label)
{
    if (!memory_reserve(&plan->areas, &plan->capacity, plan->count + 1, sizeof *plan->areas)) {
        memory_free(path);
        return CONUS_ERROR_MEMORY;
    }
    struct planned_area *area = &plan->areas[plan->count++];
    *area = (struct planned_area){.path = path, .entry = entry};
    return label_copy(&area->label, label);
}

static conus_status area_plan_add_group(struct area_plan *plan, const struct label *label)
{
    struct label *group = label_table_add(&plan->groups, label->number);
    struct label copy = {0};
    conus_status status = group ? label_copy(&copy, label) : CONUS_ERROR_MEMORY;
    if (status) {
        label_finish(&copy);
        return status;
    }
    *group = copy;
    return CONUS_OK;
}

static int compare_areas(const void *a, const void *b)
{
    return compare_unsigned(((const struct planned_area *)a)->label.number,
                            ((const struct planned_area *)b)->label.number);
}

struct planned_area *area_plan_find(const struct area_plan *plan, uint32_t label)
{
    struct planned_area key = {.label.number = label};
    return plan->count ? bsearch(&key, plan->areas, plan->count, sizeof key, compare_areas) : NULL;
}

size_t area_plan_files(const struct area_plan *plan)
{
    size_t files = plan->labelled_count;
    for (size_t i = 0; i < plan->count; i++) {
        files += !plan->areas[i].is_part;
    }
    return files;
}

/* The first whole number in the name of the file; false if there is none. */
static conus_status number_in_name(uint32_t *number, bool *found, const char *path)
{
    const char *name = path_base(path);
    size_t start = strcspn(name, "0123456789");
    size_t length = strspn(name + start, "0123456789");
    uint64_t value = 0;
    *found = length > 0;
    if (*found && (!text_to_uint((struct text){name + start, length}, UINT32_MAX, &value) || !value)) {
        return fail(CONUS_ERROR_DATA, "%s: the number in its name is %.*s, labels are 1 to 4294967295", name,
                    (int)length, name + start);
    }
    *number = (uint32_t)value;
    return CONUS_OK;
}

/* Plans "file". path is the manifest's, areas[entry] the entry. */
static conus_status plan_file(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path)
{
    struct label label = area->label;
    bool found = true;
    conus_status status = area->has_label ? CONUS_OK : number_in_name(&label.number, &found, area->file);
    if (!status && !found) {
        status = fail(CONUS_ERROR_DATA, "label is missing (there is no number in the name %s either)", area->file);
    }
    char *file = status ? NULL : file_beside(path, area->file);
    status = status || file ? status : CONUS_ERROR_MEMORY;
    return status ? status : area_plan_add(plan, entry, file, &label);
}

/* Which names of a folder match a pattern, and how they give labels. */
struct matches {
    struct names names;
    char *folder;
    bool numbered;
    struct label_table table;
};

/* Keeps the names that match; all of them or none must hold a number. */
static conus_status keep_matching(struct matches *matches, const char *pattern)
{
    struct names *names = &matches->names;
    size_t kept = 0;
    size_t numbered = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < names->count; i++) {
        char *name = names->names[i];
        if (fnmatch(pattern, name, FNM_PERIOD) != 0) {
            memory_free(name);
            continue;
        }
        uint32_t number;
        bool found = false;
        names->names[kept++] = name;
        status = status ? status : number_in_name(&number, &found, name);
        numbered += found;
    }
    names->count = kept;
    matches->numbered = numbered > 0;
    if (!status && !kept) {
        return fail(CONUS_ERROR_DATA, "files: no file matches %s", pattern);
    }
    if (!status && numbered && numbered < kept) {
        return fail(CONUS_ERROR_DATA,
                    "files: %zu of the %zu names hold a number, which gives the label: all or none must", numbered,
                    kept);
    }
    return status;
}

/* Bridge: to label tables on a job. */
static conus_status read_labels(struct label_table *out, struct area_plan *plan, const char *path, struct notes *notes)
{
    struct job job = {0};
    const char *format;
    const struct label_use use = {.max_memory = plan->max_memory};
    label_file_read(&job, out, &format, path, &use);
    return job_close(&job, notes, &plan->read);
}

static conus_status find_matches(struct matches *matches, struct area_plan *plan, const struct manifest_area *area,
                                 const char *path, struct notes *notes)
{
    const char *ending = area->files + strlen(area->files); /* the literal end, which every matching name has */
    while (ending > area->files && !strchr("*?[]\\/", ending[-1])) {
        ending--;
    }
    char *pattern = file_beside(path, area->files);
    matches->folder = pattern ? path_folder(pattern) : NULL;
    conus_status status = matches->folder ? names_list(&matches->names, matches->folder, ending) : CONUS_ERROR_MEMORY;
    status = status ? status : keep_matching(matches, path_base(area->files));
    memory_free(pattern);
    if (!status && area->labels) {
        char *labels = file_beside(path, area->labels);
        status = labels ? read_labels(&matches->table, plan, labels, notes) : CONUS_ERROR_MEMORY;
        memory_free(labels);
    }
    return status;
}

/* Takes the label `number` from the table, raised by the entry's offset, with the entry's hemisphere if it has one. */
static conus_status raise_label(struct label *out, const struct label_table *table, uint32_t number,
                                const struct manifest_area *area)
{
    const struct label *known = label_table_find(table, number);
    *out = known ? *known : (struct label){0};
    out->number = number;
    out->hemisphere = area->label.hemisphere ? area->label.hemisphere : out->hemisphere;
    return label_raise(&out->number, area->label_offset);
}

/* Plans "files", a pattern. */
static conus_status plan_pattern(struct area_plan *plan, size_t entry, const struct manifest_area *area,
                                 const char *path, struct notes *notes)
{
    struct matches matches = {0};
    conus_status status = find_matches(&matches, plan, area, path, notes);
    for (size_t i = 0; !status && i < matches.names.count; i++) {
        struct label label = {0};
        struct buffer file = {0};
        bool found;
        uint32_t number = (uint32_t)i + 1;
        status = matches.numbered ? number_in_name(&number, &found, matches.names.names[i]) : CONUS_OK;
        status = status ? status : raise_label(&label, &matches.table, number, area);
        if (label.has_parent) {
            status = status ? status : label_raise(&label.parent, area->label_offset);
        } else {
            label.parent = area->label.parent;
            label.has_parent = area->label.has_parent;
        }
        buffer_format(&file, "%s%s", matches.folder, matches.names.names[i]);
        status = status ? status : buffer_status(&file);
        if (status) {
            buffer_finish(&file);
        } else {
            status = area_plan_add(plan, entry, file.data, &label);
        }
    }
    names_finish(&matches.names);
    memory_free(matches.folder);
    label_table_finish(&matches.table);
    return status;
}

/* Plans the part `number` of the last labelled surface. */
static conus_status plan_part(struct area_plan *plan, size_t entry, const struct manifest_area *area, uint32_t number)
{
    const struct labelled_surface *surface = &plan->labelled[plan->labelled_count - 1];
    struct label label;
    conus_status status = raise_label(&label, &surface->labels.table, number, area);
    if (status) {
        return status;
    }
    label.hemisphere = area->label.hemisphere ? area->label.hemisphere : surface->labels.hemisphere;
    label.has_parent = area->label.has_parent;
    label.parent = area->label.parent;
    char *path = memory_text(surface->path, strlen(surface->path));
    status = path ? area_plan_add(plan, entry, path, &label) : CONUS_ERROR_MEMORY;
    if (!status) {
        struct planned_area *planned = &plan->areas[plan->count - 1];
        planned->is_part = true;
        planned->surface = plan->labelled_count - 1;
        planned->part = number;
    }
    return status;
}

static conus_status read_labelled(struct area_plan *plan, const struct manifest_area *area, const char *path,
                                  struct notes *notes)
{
    struct mesh_file_options options = {
        .max_memory = plan->max_memory, .read = &plan->read, .hemisphere = area->label.hemisphere};
    struct labelled_surface *surfaces = memory_resize(plan->labelled, plan->labelled_count + 1, sizeof *surfaces);
    char *labels = file_beside(path, area->vertex_labels);
    plan->labelled = surfaces ? surfaces : plan->labelled;
    if (!surfaces || !labels) {
        memory_free(labels);
        return CONUS_ERROR_MEMORY;
    }
    struct labelled_surface *surface = &surfaces[plan->labelled_count++];
    *surface = (struct labelled_surface){.path = file_beside(path, area->file)};
    options.surface = surface->path;
    struct notes again = {0};
    conus_status status = surface->path
                              ? vertex_labels_read(&surface->labels, labels, &options, area->noted ? &again : notes)
                              : CONUS_ERROR_MEMORY;
    notes_finish(&again);
    memory_free(labels);
    return status;
}

/* Plans "file" with "vertex_labels": a part for each label that vertices have. path is the manifest's, areas[entry] the
 * entry. */
static conus_status plan_labelled(struct area_plan *plan, size_t entry, const struct manifest_area *area,
                                  const char *path, struct notes *notes)
{
    conus_status status = read_labelled(plan, area, path, notes);
    if (status) {
        return status;
    }
    const struct vertex_labels *labels = &plan->labelled[plan->labelled_count - 1].labels;
    uint32_t *numbers = memory_raw(labels->count, sizeof *numbers);
    size_t count = 0;
    if (!numbers) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < labels->count; i++) {
        numbers[count] = labels->labels[i];
        count += numbers[count] != 0;
    }
    count = u32_sort_unique(numbers, count);
    for (size_t i = 0; !status && i < count; i++) {
        status = plan_part(plan, entry, area, numbers[i]);
    }
    memory_free(numbers);
    return status;
}

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
    struct buffer table = {0};
    brainglobe->folder = file_beside(path, area->brainglobe);
    conus_status status = brainglobe->folder ? CONUS_OK : CONUS_ERROR_MEMORY;
    buffer_format(&table, "%s/structures.json", status ? "" : brainglobe->folder);
    status = status ? status : buffer_status(&table);
    status = status ? status : read_labels(&brainglobe->structures, plan, table.data, notes);
    buffer_finish(&table);
    if (status) {
        return status;
    }
    const struct label_table *structures = &brainglobe->structures;
    brainglobe->meshes = memory_zeroed(structures->count, sizeof *brainglobe->meshes);
    brainglobe->contains = memory_zeroed(structures->count, sizeof *brainglobe->contains);
    status = brainglobe->meshes && brainglobe->contains ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < structures->count; i++) {
        struct buffer mesh = {0};
        buffer_format(&mesh, "%s/meshes/%u.obj", brainglobe->folder, structures->entries[i].number);
        status = buffer_status(&mesh);
        if (status || !file_exists(mesh.data)) {
            buffer_finish(&mesh);
        }
        brainglobe->meshes[i] = mesh.data;
    }
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

/* Makes the matrix from stored coordinates to the world. *orientation is the entry's, else that of metadata.json, else
 * "asr". */
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

/* Plans "brainglobe". path is the manifest's, areas[entry] the entry. */
static conus_status plan_brainglobe(struct area_plan *plan, size_t entry, const struct manifest_area *area,
                                    const char *path, struct notes *notes)
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

conus_status area_plan_make(struct area_plan *out, const struct manifest *manifest, const char *path,
                            struct notes *notes)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < manifest->area_count; i++) {
        const struct manifest_area *area = &manifest->areas[i];
        status = area->vertex_labels ? plan_labelled(out, i, area, path, notes)
                 : area->file        ? plan_file(out, i, area, path)
                 : area->files       ? plan_pattern(out, i, area, path, notes)
                                     : plan_brainglobe(out, i, area, path, notes);
        status = fail_in_entry(status, "areas", i);
    }
    if (out->count) {
        qsort(out->areas, out->count, sizeof *out->areas, compare_areas);
    }
    for (size_t i = 1; !status && i < out->count; i++) {
        const struct planned_area *a = &out->areas[i - 1];
        const struct planned_area *b = &out->areas[i];
        if (a->label.number == b->label.number) {
            return fail(CONUS_ERROR_DATA,
                        "areas[%zu]: label %u is that of %s and of %s: each needs its own (label, label_offset)",
                        b->entry, b->label.number, path_base(a->path), path_base(b->path));
        }
    }
    for (size_t i = 0; !status && i < manifest->tree_count; i++) {
        struct label *node = &manifest->tree[i];
        struct planned_area *area = area_plan_find(out, node->number);
        if (!area) {
            status = area_plan_add_group(out, node);
        } else if (node->has_parent) {
            area->label.has_parent = true;
            area->label.parent = node->parent;
        }
    }
    return status ? status : label_table_sort(&out->groups, notes);
}
