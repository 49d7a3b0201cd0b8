/* SPDX-License-Identifier: BSD-3-Clause */
/* From planned surfaces to areas of the atlas: reading them, their notes, the area tree. */
#include "atlas/fit/box_fit.h"
#include "atlas/labels/label_voxels.h"
#include "atlas/surface/mesh_split.h"
#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/scene/area_plan.h"
#include "loaders/surfaces/foreign/mesh_foreign.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All surfaces of a plan, which are read before any becomes an area. */
struct surfaces {
    struct mesh *meshes;   /* [count], as the plan's areas */
    const char **foreign;  /* paths of other programs' files */
    struct mesh *received; /* [foreign_count] */
    size_t count, foreign_count;
    enum mesh_space space;
    uint64_t max_memory;
    struct notes *notes;
    struct load_progress *progress;
};

static void surfaces_finish(struct surfaces *surfaces)
{
    for (size_t i = 0; surfaces->meshes && i < surfaces->count; i++) {
        mesh_finish(&surfaces->meshes[i]);
    }
    for (size_t i = 0; surfaces->received && i < surfaces->foreign_count; i++) {
        mesh_finish(&surfaces->received[i]);
    }
    memory_free(surfaces->meshes);
    memory_free(surfaces->received);
    memory_free(surfaces->foreign);
}

/* Names the area by the name in the file, else by the file's name. */
static conus_status name_area(struct planned_area *area, struct label *said)
{
    if (!area->label.name && said->name) {
        area->label.name = said->name;
        said->name = NULL;
    } else if (!area->label.name) {
        area->label.name = mesh_file_name(area->path);
    }
    area->label.hemisphere = area->label.hemisphere ? area->label.hemisphere : said->hemisphere;
    return area->label.name ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Gives the parts to the areas planned for them. */
static conus_status hand_out_parts(struct surfaces *surfaces, struct area_plan *plan, size_t surface,
                                   struct mesh_parts *parts)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < plan->count; i++) {
        struct planned_area *area = &plan->areas[i];
        if (!area->is_part || area->surface != surface) {
            continue;
        }
        struct mesh_part *part = mesh_parts_find(parts, area->part);
        if (part) {
            surfaces->meshes[i] = part->mesh;
            part->mesh = (struct mesh){0};
        }
        if (!surfaces->meshes[i].triangle_count) {
            status = notes_warn(surfaces->notes, "%s: label %u is on no triangle, left out", area->path, area->part);
        }
    }
    return status;
}

static conus_status cut_labelled(struct surfaces *surfaces, struct area_plan *plan, size_t index)
{
    struct labelled_surface *labelled = &plan->labelled[index];
    const struct mesh_file_options options = {.space = surfaces->space, .max_memory = surfaces->max_memory};
    struct mesh mesh = {0};
    struct mesh_parts parts = {0};
    if (!mesh_file_keeps_vertices(labelled->path)) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "vertex_labels: %s: a surface that numbers its vertices is needed, any but STL",
                    path_base(labelled->path));
    }
    conus_status status = mesh_file_read(&mesh, NULL, labelled->path, &options, surfaces->notes);
    status = status ? status : vertex_labels_extend(&labelled->labels, mesh.vertex_count);
    if (!status && mesh.vertex_count != labelled->labels.count) {
        status = fail(CONUS_ERROR_DATA, "vertex_labels: %zu labels, %s has %zu vertices: they must be as many",
                      labelled->labels.count, path_base(labelled->path), mesh.vertex_count);
    }
    status = status ? status : mesh_split(&parts, &mesh, labelled->labels.labels, surfaces->notes);
    status = status ? status : hand_out_parts(surfaces, plan, index, &parts);
    mesh_parts_finish(&parts);
    mesh_finish(&mesh);
    return status;
}

/* Whether the surface is another program's file. Those are read together, so that one note says how many of them do not
 * state their space. */
static bool is_foreign(const struct planned_area *area)
{
    return !area->is_part && mesh_file_is_foreign(area->path);
}

/* Reads other programs' files: those with a placement of their own, or those without. */
static conus_status read_foreign(struct surfaces *surfaces, struct area_plan *plan, bool placed)
{
    struct mesh_foreign_options options = {placed ? MESH_SPACE_RAS : surfaces->space, surfaces->max_memory};
    struct label nothing = {0};
    size_t n = 0;
    for (size_t i = 0; i < plan->count; i++) {
        if (plan->areas[i].placed == placed && is_foreign(&plan->areas[i])) {
            surfaces->foreign[n++] = plan->areas[i].path;
        }
    }
    if (!n) {
        return CONUS_OK;
    }
    conus_status status = load_progress_report(surfaces->progress, surfaces->foreign[0], n);
    status = status ? status : mesh_foreign_read(surfaces->received, surfaces->foreign, n, &options, surfaces->notes);
    surfaces->foreign_count = status ? 0 : n;
    n = 0;
    for (size_t i = 0; !status && i < plan->count; i++) {
        if (plan->areas[i].placed == placed && is_foreign(&plan->areas[i])) {
            surfaces->meshes[i] = surfaces->received[n];
            surfaces->received[n++] = (struct mesh){0};
            status = name_area(&plan->areas[i], &nothing);
        }
    }
    return status;
}

static conus_status read_areas(struct surfaces *surfaces, struct area_plan *plan)
{
    const struct mesh_file_options options = {.space = surfaces->space, .max_memory = surfaces->max_memory};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < plan->count; i++) {
        struct planned_area *area = &plan->areas[i];
        if (!area->is_part && !is_foreign(area)) {
            struct label said = {0};
            struct mesh *mesh = &surfaces->meshes[i];
            status = load_progress_report(surfaces->progress, area->path, 1);
            status = status ? status : mesh_file_read(mesh, &said, area->path, &options, surfaces->notes);
            status = status ? status : name_area(area, &said);
            label_finish(&said);
        }
        status = fail_in_entry(status, "areas", area->entry);
    }
    return status;
}

static conus_status read_all(struct surfaces *surfaces, struct area_plan *plan)
{
    for (size_t i = 0; i < plan->count; i++) { /* the reader reports a file that is not there */
        (void)file_state_find(&plan->areas[i].state, plan->areas[i].path);
    }
    conus_status status = read_foreign(surfaces, plan, true);
    status = status ? status : read_foreign(surfaces, plan, false);
    for (size_t i = 0; !status && i < plan->labelled_count; i++) {
        status = load_progress_report(surfaces->progress, plan->labelled[i].path, 1);
        status = status ? status : cut_labelled(surfaces, plan, i);
    }
    return status ? fail_in(status, "areas") : read_areas(surfaces, plan);
}

/* A note "path: text" about an area. */
struct said {
    const struct planned_area *area; /* NULL: it is about none */
    const char *text;
    size_t line; /* which note it is */
};

struct gathering {
    const struct planned_area **areas; /* [area_count] by path */
    size_t area_count;
    struct said *said; /* [count] by text */
    size_t count;
    bool *is_first; /* [count] of those notes that say the same */
};

static int compare_paths(const void *a, const void *b)
{
    const struct planned_area *x = *(const struct planned_area *const *)a;
    const struct planned_area *y = *(const struct planned_area *const *)b;
    int order = strcmp(x->path, y->path);
    return order ? order : (x > y) - (x < y);
}

/* Sorts notes about areas by their text, in front of all other notes. */
static int compare_said(const void *a, const void *b)
{
    const struct said *x = a;
    const struct said *y = b;
    int order = x->area && y->area ? strcmp(x->text, y->text) : (y->area != NULL) - (x->area != NULL);
    return order ? order : compare_unsigned(x->line, y->line);
}

static bool say_the_same(const struct said *a, const struct said *b)
{
    return a->area && b->area && strcmp(a->text, b->text) == 0;
}

/* The first area whose path is the first `size` bytes of `note`. */
static const struct planned_area *area_of_path(const struct gathering *gathering, const char *note, size_t size)
{
    size_t low = 0;
    size_t high = gathering->area_count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        bool below = strncmp(gathering->areas[middle]->path, note, size) < 0;
        low = below ? middle + 1 : low;
        high = below ? high : middle;
    }
    const char *path = low < gathering->area_count ? gathering->areas[low]->path : "";
    return strlen(path) == size && strncmp(path, note, size) == 0 ? gathering->areas[low] : NULL;
}

static struct said read_note(const struct gathering *gathering, const char *note, size_t line)
{
    struct said said = {.line = line};
    for (const char *end = strstr(note, ": "); end && !said.area; end = strstr(end + 1, ": ")) {
        said.area = area_of_path(gathering, note, (size_t)(end - note));
        said.text = end + 2;
    }
    return said;
}

static conus_status gathering_init(struct gathering *out, const struct area_plan *plan, const struct notes *from)
{
    out->areas = memory_raw(plan->count, sizeof(void *));
    out->said = memory_raw(from->count, sizeof *out->said);
    out->is_first = memory_zeroed(from->count, sizeof *out->is_first);
    if (!out->areas || !out->said || !out->is_first) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < plan->count; i++) {
        out->areas[out->area_count++] = &plan->areas[i];
    }
    qsort(out->areas, out->area_count, sizeof(void *), compare_paths);
    for (size_t i = 0; i < from->count; i++) {
        out->said[out->count++] = read_note(out, from->lines[i], i);
    }
    qsort(out->said, out->count, sizeof *out->said, compare_said);
    for (size_t i = 0; i < out->count; i++) {
        out->is_first[out->said[i].line] = !i || !say_the_same(&out->said[i - 1], &out->said[i]);
    }
    return CONUS_OK;
}

/* Adds `note`, or if others say the same about other surfaces "N surfaces (a, b, ...): text". The log gets it with the
 * path of the first surface. `said` has `left` entries from that one on. */
static conus_status add_gathered(struct notes *to, const struct said *said, size_t left, conus_severity severity,
                                 const char *note, struct load_progress *progress)
{
    enum { SHOWN = 3 };
    struct buffer names = {0};
    size_t count = 0;
    for (; count < left && (!count || say_the_same(said, &said[count])); count++) {
        if (count < SHOWN && said->area) {
            buffer_format(&names, "%s%s", count ? ", " : "", path_base(said[count].area->path));
        }
    }
    conus_status status = buffer_status(&names);
    status = status || !said->area ? status : load_progress_at(progress, said->area->path);
    status = status       ? status
             : count == 1 ? notes_put(to, severity, "%s", note)
                          : notes_put(to, severity, "%zu surfaces (%s%s): %s", count, names.data,
                                      count > SHOWN ? ", ..." : "", said->text);
    buffer_finish(&names);
    return status;
}

/* Moves the notes to `to`. A note that several surfaces share is kept once, at the first of them. */
static conus_status gather_notes(struct notes *to, const struct area_plan *plan, struct notes *from,
                                 struct load_progress *progress)
{
    struct gathering gathering = {0};
    conus_status status = gathering_init(&gathering, plan, from);
    size_t *at = status ? NULL : memory_raw(from->count, sizeof *at); /* where a note is in said */
    status = status || at ? status : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < gathering.count; i++) {
        at[gathering.said[i].line] = i;
    }
    for (size_t i = 0; !status && i < from->count; i++) {
        if (gathering.is_first[i]) {
            status = add_gathered(to, gathering.said + at[i], gathering.count - at[i], from->marks[i].severity,
                                  from->lines[i], progress);
        }
    }
    memory_free(at);
    memory_free(gathering.areas);
    memory_free(gathering.said);
    memory_free(gathering.is_first);
    return status;
}

static conus_status add_surfaces(struct area_plan *plan, struct surfaces *surfaces, conus_atlas *atlas)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < plan->count; i++) {
        const struct planned_area *area = &plan->areas[i];
        char digits[LABEL_DIGITS];
        conus_object object = label_object(&area->label, atlas->object_count, digits);
        if (!surfaces->meshes[i].triangle_count) { /* a label on no triangle */
            continue;
        }
        if (area->placed) {
            mesh_transform(&surfaces->meshes[i], area->world_from_mesh);
        }
        bool repeated = area->is_part && i && strcmp(plan->areas[i - 1].path, area->path) == 0;
        status = atlas_add_mesh(atlas, &object, &surfaces->meshes[i]);
        status = status || repeated ? status : atlas_note_file(atlas, area->path, &area->state);
    }
    return status;
}

/* Warns if the sizes of the surfaces and of the areas of voxels differ too much. */
static conus_status note_size(conus_atlas *atlas)
{
    bool said;
    const struct fit_box surfaces = fit_box_of_areas(atlas, false, true);
    const struct fit_box voxels = fit_box_of_areas(atlas, true, false);
    return fit_note_size(&said, &atlas->notes, "surfaces", &surfaces, &voxels);
}

/* Adds the groups that are no area yet. */
static conus_status add_groups(struct area_plan *plan, conus_atlas *atlas, struct label_map *map)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < plan->groups.count; i++) {
        const struct label *group = &plan->groups.entries[i];
        uint64_t *number = label_map_at(map, group->number);
        if (!number) {
            return CONUS_ERROR_MEMORY;
        }
        if (*number) {
            continue;
        }
        char digits[LABEL_DIGITS];
        conus_object object = label_object(group, atlas->object_count, digits);
        if (!group->name) {
            return fail(CONUS_ERROR_DATA, "tree: label %u is no area, and a new one needs a name", group->number);
        }
        status = atlas_add_group(atlas, &object);
        *number = atlas->object_count;
    }
    return status;
}

static conus_status link_parent(conus_atlas *atlas, struct label_map *map, const struct label *label)
{
    if (!label->has_parent) {
        return CONUS_OK;
    }
    uint64_t *child = label_map_at(map, label->number);
    uint64_t child_number = child ? *child : 0;
    uint64_t *parent = label_map_at(map, label->parent);
    if (!child || !parent) {
        return CONUS_ERROR_MEMORY;
    }
    if (!child_number) { /* left out */
        return CONUS_OK;
    }
    if (!*parent) {
        return fail(CONUS_ERROR_DATA, "label %u: its parent %u is no area (tree may name one)", label->number,
                    label->parent);
    }
    atlas->objects[child_number - 1].parent = (uint32_t)*parent;
    return CONUS_OK;
}

static conus_status grow_tree(struct area_plan *plan, conus_atlas *atlas)
{
    struct label_map map = {0}; /* label -> number of the area or group */
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < atlas->area_count; i++) {
        uint64_t *number = label_map_at(&map, atlas->objects[i].label);
        status = number ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (number) {
            *number = i + 1;
        }
    }
    status = status ? status : add_groups(plan, atlas, &map);
    for (size_t i = 0; !status && i < plan->count; i++) {
        status = link_parent(atlas, &map, &plan->areas[i].label);
    }
    for (size_t i = 0; !status && i < plan->groups.count; i++) {
        status = link_parent(atlas, &map, &plan->groups.entries[i]);
    }
    label_map_finish(&map);
    return status ? status : atlas_check_tree(atlas);
}

conus_status area_plan_load(struct area_plan *plan, conus_atlas *atlas, enum mesh_space space,
                            const conus_load_options *options, struct load_progress *progress)
{
    struct notes notes = {0};
    struct surfaces surfaces = {.meshes = memory_zeroed(plan->count, sizeof *surfaces.meshes),
                                .foreign = memory_zeroed(plan->count, sizeof *surfaces.foreign),
                                .received = memory_zeroed(plan->count, sizeof *surfaces.received),
                                .count = plan->count,
                                .space = space,
                                .max_memory = options->max_memory,
                                .notes = &notes,
                                .progress = progress};
    bool made = surfaces.meshes && surfaces.foreign && surfaces.received;
    conus_status status = made ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : read_all(&surfaces, plan);
    conus_status gathered = gather_notes(&atlas->notes, plan, &notes, progress); /* also of what cannot be read */
    status = status ? status : gathered;
    status = status ? status : add_surfaces(plan, &surfaces, atlas);
    status = status ? status : note_size(atlas);
    status = status ? status : grow_tree(plan, atlas);
    surfaces_finish(&surfaces);
    notes_finish(&notes);
    return status;
}
