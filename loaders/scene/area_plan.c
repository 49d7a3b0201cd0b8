/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of surfaces and groups that the "areas" and the "tree" of a manifest give. */
#include "loaders/scene/parts.h"

#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/brainglobe/brainglobe.h"
#include "loaders/labels/labels.h"
#include "loaders/surfaces/foreign/foreign.h"
#include "loaders/transform/transform.h"
#include "loaders/volumes/volumes.h"
#include "sources/source.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What an item of the scene `path` is planned with. */
struct planning {
    struct job *job;
    struct area_plan *plan;
    const struct scene *scene;
    const char *path;
    const struct scene_item *area;
    const double *world; /* 4 x 4, from the mm of the scene's image; NULL without one */
};

static struct planned_area *add_area(const struct planning *p, const char *path, const struct label *label)
{
    struct planned_area *area = LIST_ADD(p->job, &p->plan->areas);
    area->path = path;
    area->item = p->area;
    area->label = *label;
    area->placed = p->world;
    if (p->world) {
        memcpy(area->world_from_mesh, p->world, sizeof area->world_from_mesh);
    }
    return area;
}

static void add_group(struct job *job, struct area_plan *plan, const struct label *label)
{
    struct label *group = labels_add(job, plan->groups, label->number);
    (void)JOB_CALL(job, label_copy(group, label));
}

static int compare_areas(const void *a, const void *b)
{
    return compare_unsigned(((const struct planned_area *)a)->label.number,
                            ((const struct planned_area *)b)->label.number);
}

struct planned_area *area_plan_find(const struct area_plan *plan, uint32_t label)
{
    struct planned_area key = {.label.number = label};
    return plan->areas.count ? bsearch(&key, plan->areas.at, plan->areas.count, sizeof key, compare_areas) : NULL;
}

size_t area_plan_files(const struct area_plan *plan)
{
    size_t files = plan->labelled_count;
    for (size_t i = 0; i < plan->areas.count; i++) {
        files += !plan->areas.at[i].surface;
    }
    return files;
}

/* The first whole number in the name of the file; false if there is none. */
static bool number_in_name(struct job *job, uint32_t *number, const char *path)
{
    const char *name = path_base(path);
    const char *start = name + strcspn(name, "0123456789");
    const struct text digits = {start, strspn(start, "0123456789")};
    uint64_t value = 0;
    if (digits.size && (!text_to_uint(digits, UINT32_MAX, &value) || !value)) {
        job_bad(job, "%s: the number in its name is %.*s, labels are 1 to 4294967295", name, (int)digits.size, start);
    }
    *number = (uint32_t)value;
    return digits.size > 0;
}

static void plan_file(const struct planning *p)
{
    struct label label = p->area->label;
    if (!label.number && !number_in_name(p->job, &label.number, p->area->file)) {
        job_bad(p->job, "label is missing (there is no number in the name %s either)", p->area->file);
    }
    add_area(p, job_beside(p->job, p->path, p->area->file), &label);
}

static struct label_table *read_table(const struct planning *p, const char *path)
{
    struct label_table *table = labels_new(p->job);
    const char *format;
    label_file_read(p->job, table, &format, path, NULL);
    return table;
}

struct paths {
    LIST(const char *);
};

/* Finds the files that match the entry's pattern; the names of all or none must hold a number. */
static struct paths find_matches(const struct planning *p)
{
    struct paths paths = {0};
    const char *pattern = job_beside(p->job, p->path, p->area->file);
    const char *base = path_base(pattern);
    const char *folder = base > pattern ? job_format(p->job, "%.*s", (int)(base - pattern), pattern) : "./";
    const char *ending = base + strlen(base); /* the literal end, which every matching name has */
    size_t numbered = 0;
    uint32_t number;
    while (ending > base && !strchr("*?[]\\", ending[-1])) {
        ending--;
    }
    const struct names names = job_names(p->job, folder, ending);
    for (size_t i = 0; i < names.count; i++) {
        if (text_matches(names.names[i], base, TEXT_NO_DOT)) {
            *LIST_ADD(p->job, &paths) = job_format(p->job, "%s%s", folder, names.names[i]);
            numbered += number_in_name(p->job, &number, names.names[i]);
        }
    }
    if (!paths.count) {
        job_bad(p->job, "files: no file matches %s", base);
    } else if (numbered && numbered < paths.count) {
        job_bad(p->job, "files: %zu of the %zu names hold a number, which gives the label: all or none must", numbered,
                paths.count);
    }
    return paths;
}

/* The label `number` of the table, raised by the entry's offset, with the entry's hemisphere if it has one. */
static struct label raise_label(const struct planning *p, const struct label_table *table, uint32_t number)
{
    const struct label *known = label_table_find(table, number);
    struct label label = known ? *known : (struct label){0};
    label.number = label_raise(p->job, number, p->area->label_offset);
    label.hemisphere = p->area->label.hemisphere ? p->area->label.hemisphere : label.hemisphere;
    return label;
}

static void plan_pattern(const struct planning *p)
{
    const struct label *of_all = &p->area->label;
    const struct paths paths = find_matches(p);
    const struct label_table *table =
        p->area->labels ? read_table(p, job_beside(p->job, p->path, p->area->labels)) : labels_new(p->job);
    for (size_t i = 0; i < paths.count && job_ok(p->job); i++) {
        uint32_t number;
        number = number_in_name(p->job, &number, paths.at[i]) ? number : (uint32_t)i + 1;
        struct label label = raise_label(p, table, number);
        label.parent = label.has_parent ? label_raise(p->job, label.parent, p->area->label_offset) : of_all->parent;
        label.has_parent = label.has_parent || of_all->has_parent;
        add_area(p, paths.at[i], &label);
    }
}

static void end_labelled(void *thing)
{
    struct labelled_surface *surface = thing;
    vertex_labels_finish(&surface->labels);
    mesh_parts_finish(&surface->objects);
    mesh_finish(&surface->mesh);
    label_finish(&surface->said);
}

/* Reads the labels of the item's surface, without the notes that have been made of them before. */
static void read_labels(const struct planning *p, struct labelled_surface *surface)
{
    struct job *job = p->job;
    const struct scene_item *item = p->area;
    const struct mesh_file_options options = {
        .is_made_of = item->vertex_labels, .surface = surface->path, .hemisphere = item->label.hemisphere};
    const struct attempt attempt = job_try(job);
    surface->labels_path = item->vertex_labels ? job_beside(job, p->path, item->vertex_labels) : surface->path;
    surface_labels_read(job, &surface->labels, surface->labels_path, &options);
    if (item->noted) {
        notes_cut(&job->notes, attempt.notes);
    }
    attempt_end(job, &attempt, ATTEMPT_KEEP);
    p->plan->names = job_format(job, "labels of vertices in %s", surface->labels_path);
}

/* Makes the surface, which no labels cut, its only object. */
static void take_whole(struct job *job, struct labelled_surface *surface)
{
    struct label_table *table = &surface->labels.table;
    struct mesh_part *part = job_step(job) ? memory_zeroed(1, sizeof *part) : NULL;
    label_table_finish(table); /* of labels that no vertex has */
    struct label *label = part ? label_table_add(table, 1) : NULL;
    if (!job_need(job, label)) {
        memory_free(part);
        return;
    }
    *part = (struct mesh_part){.label = 1, .mesh = surface->mesh};
    surface->objects = (struct mesh_parts){part, 1};
    surface->mesh = (struct mesh){0};
    label->name = surface->said.name;
    surface->said.name = NULL;
    surface->labels.hemisphere = surface->said.hemisphere;
}

/* Plans a part of the surface for each of the sorted numbers but 0. */
static void add_parts(const struct planning *p, const struct labelled_surface *surface, const uint32_t *numbers,
                      size_t count)
{
    const struct label *of_all = &p->area->label;
    for (size_t i = count && !numbers[0]; i < count; i++) {
        struct label label = raise_label(p, &surface->labels.table, numbers[i]);
        label.name = label.name || !surface->objects.count ? label.name : mesh_name(p->job, surface->path);
        label.hemisphere = of_all->hemisphere ? of_all->hemisphere : surface->labels.hemisphere;
        label.has_parent = of_all->has_parent;
        label.parent = of_all->parent;
        struct planned_area *part = add_area(p, surface->path, &label);
        part->surface = surface;
        part->part = numbers[i];
    }
}

/* Plans "file" with "vertex_labels" or "parts": a part for each label that vertices have, or for each object. A surface
 * of neither is one area. */
static void plan_labelled(const struct planning *p)
{
    struct job *job = p->job;
    struct labelled_surface *surface = &p->plan->labelled[p->plan->labelled_count++];
    surface->item = p->area;
    surface->path = job_beside(job, p->path, p->area->file);
    (void)file_state_find(&surface->state, surface->path); /* the reader reports a file that is not there */
    job_own(job, end_labelled, surface);
    const struct format *format = source_format(job, surface->path, ROLE_SURFACE);
    const bool has_labels = p->area->vertex_labels;
    if (has_labels && job_ok(job) && !mesh_format_keeps_vertices(format)) {
        job_refuse(job, "%s: labels of vertices need a surface that numbers its vertices, as all formats but STL do",
                   surface->path);
    }
    if (!has_labels && mesh_format_is_foreign(format)) {
        mesh_foreign_objects(job, &surface->objects, &surface->labels.table, surface->path, p->scene->space);
    } else {
        if (p->area->parts) {
            surface_read(job, &surface->mesh, &surface->said, surface->path,
                         &(struct mesh_file_options){.space = p->scene->space});
        }
        read_labels(p, surface);
        if (!has_labels && !surface->labels.count) {
            take_whole(job, surface);
        }
    }
    const bool has_objects = surface->objects.count;
    size_t count = has_objects ? surface->objects.count : surface->labels.count;
    uint32_t *numbers = job_array(job, &count, sizeof *numbers);
    for (size_t i = 0; i < count; i++) {
        numbers[i] = has_objects ? surface->objects.parts[i].label : surface->labels.labels[i];
    }
    add_parts(p, surface, numbers, u32_sort_unique(numbers, count));
    p->plan->names = has_objects ? job_format(job, "the name in %s", surface->path) : p->plan->names;
}

/* The world's mm from those of the scene's image; NULL without one. */
static const double *place_surfaces(struct job *job, const struct scene *scene)
{
    conus_volume_info image;
    double *world = scene->image ? job_raw(job, 16, sizeof *world) : NULL;
    if (world) {
        volume_header_read(job, &image, scene->image);
    }
    if (world && job_ok(job)) {
        world_from_flirt(job, world, &image);
    }
    return world;
}

static const double micrometres = 0.001; /* BrainGlobe's unit, in mm */

/* Marks everything above each structure that has a mesh. */
static void mark_containers(bool *contains, const struct label_table *table, const char *const *meshes, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct label *at = meshes[i] ? &table->entries[i] : NULL;
        while (at && at->has_parent) {
            at = label_table_find(table, at->parent);
            bool *above = at ? &contains[at - table->entries] : NULL;
            at = above && !*above ? at : NULL; /* else all above it is marked */
            if (at) {
                *above = true;
            }
        }
    }
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

/* What the folder says of its axes: the entry's orientation, else metadata.json, else "asr". */
static struct brainglobe_metadata find_axes(const struct planning *p, const char *folder)
{
    struct brainglobe_metadata metadata = {.orientation = "asr"};
    if (p->area->orientation) {
        snprintf(metadata.orientation, sizeof metadata.orientation, "%s", p->area->orientation);
    } else {
        const char *inside = job_format(p->job, "%s/", folder);
        (void)brainglobe_metadata_take(p->job, &metadata, inside);
    }
    find_ccf(p->plan, &metadata);
    return metadata;
}

static void plan_of_brainglobe(const struct planning *p)
{
    const double scale = p->area->scale > 0 ? p->area->scale : micrometres;
    const double scales[3] = {scale, scale, scale};
    const size_t before = p->plan->areas.count;
    const char *folder = job_beside(p->job, p->path, p->area->file);
    const struct label_table *table = read_table(p, job_format(p->job, "%s/structures.json", folder));
    size_t count = table->count;
    bool *contains = job_zeroed(p->job, count, sizeof *contains); /* another structure with a mesh */
    const char **meshes = job_array(p->job, &count, sizeof *meshes);
    double world_from_mesh[16];
    for (size_t i = 0; i < count; i++) {
        meshes[i] = job_format(p->job, "%s/meshes/%u.obj", folder, table->entries[i].number);
        meshes[i] = job_has_file(p->job, meshes[i]) ? meshes[i] : NULL;
    }
    mark_containers(contains, table, meshes, count);
    const struct brainglobe_metadata metadata = find_axes(p, folder);
    (void)JOB_CALL(p->job, brainglobe_axes(world_from_mesh, metadata.orientation, scales));
    for (size_t i = 0; i < count && job_ok(p->job); i++) {
        if (meshes[i] && (p->area->all_structures || !contains[i])) {
            struct planned_area *area = add_area(p, meshes[i], &table->entries[i]);
            area->placed = true;
            memcpy(area->world_from_mesh, world_from_mesh, sizeof area->world_from_mesh);
        } else if (contains[i]) {
            add_group(p->job, p->plan, &table->entries[i]);
        }
    }
    const size_t added = p->plan->areas.count - before;
    if (!added) {
        job_bad(p->job, "brainglobe: %s/meshes holds no ID.obj of structures.json", p->area->file);
    }
    job_note(p->job, "%s: %zu surfaces, stored times %g is mm, axes start at \"%s\"; the world's origin is that corner",
             folder, added, scale, metadata.orientation);
}

/* Sorts the areas by label, of which no two may have the same. */
static void sort_areas(struct job *job, struct area_plan *plan)
{
    order_sort(plan->areas.at, plan->areas.count, sizeof *plan->areas.at, compare_areas);
    for (size_t i = 1; i < plan->areas.count; i++) {
        const struct planned_area *a = &plan->areas.at[i - 1];
        const struct planned_area *b = &plan->areas.at[i];
        if (a->label.number == b->label.number) {
            job_bad(job, "areas[%zu]: label %u is that of %s and of %s: each needs its own (label, label_offset)",
                    b->item->index, b->label.number, path_base(a->path), path_base(b->path));
        }
    }
}

void area_plan_make(struct job *job, struct area_plan *out, const struct scene *scene, const char *path)
{
    out->groups = labels_new(job);
    out->labelled = job_zeroed(job, scene_count(scene, ITEM_AREA), sizeof *out->labelled);
    const double *world = place_surfaces(job, scene);
    struct scene_item *item = NULL;
    while (job_ok(job) && (item = scene_next(scene, ITEM_SURFACES, item))) {
        const struct planning planning = {job, out, scene, path, item, world};
        const size_t mark = job_in(job, item->list, item->index);
        (item->vertex_labels || item->parts ? plan_labelled
         : item->kind == ITEM_AREA          ? plan_file
         : item->kind == ITEM_AREAS         ? plan_pattern
                                            : plan_of_brainglobe)(&planning);
        job_out(job, mark);
    }
    sort_areas(job, out);
    while ((item = scene_next(scene, ITEM_NODE, item))) {
        const struct label *node = &item->label;
        struct planned_area *area = area_plan_find(out, node->number);
        if (!area) {
            add_group(job, out, node);
        } else if (node->has_parent) {
            area->label.has_parent = true;
            area->label.parent = node->parent;
        }
    }
    labels_sort(job, out->groups);
}
