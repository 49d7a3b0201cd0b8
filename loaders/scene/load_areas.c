/* SPDX-License-Identifier: BSD-3-Clause */
/* From planned surfaces to areas of the atlas: reading them, their notes, the area tree. */
#include "atlas/fit/fit.h"
#include "atlas/labels/labels.h"
#include "atlas/surface/mesh.h"
#include "base/files/file.h"
#include "base/order.h"
#include "loaders/labels/labels.h"
#include "loaders/scene/parts.h"
#include "loaders/surfaces/foreign/foreign.h"
#include "sources/source.h"

#include <stdlib.h>
#include <string.h>

/* All surfaces of a plan, which are read before any becomes an area. */
struct surfaces {
    struct load *load;
    struct job *job; /* the load's */
    struct area_plan *plan;
    struct mesh *meshes; /* [count], as the plan's areas */
    bool *is_foreign;    /* [count] Another program's file. Those are read together, so that one note says how many of
                            them do not state their space. */
    size_t count;
    enum mesh_space space;
    struct notes notes; /* once all are read: which no sink has had before they are gathered */
};

static void end_surfaces(void *thing)
{
    struct surfaces *surfaces = thing;
    for (size_t i = 0; i < surfaces->count; i++) {
        mesh_finish(&surfaces->meshes[i]);
    }
    notes_finish(&surfaces->notes);
}

static void name_area(struct job *job, struct planned_area *area, const struct label *said)
{
    struct label *label = &area->label;
    label->name = label->name ? label->name : said->name ? said->name : mesh_name(job, area->path);
    label->hemisphere = label->hemisphere ? label->hemisphere : said->hemisphere;
}

static void hand_out_parts(struct surfaces *surfaces, const struct labelled_surface *labelled, struct mesh_parts *parts)
{
    for (size_t i = 0; i < surfaces->count; i++) {
        struct planned_area *area = &surfaces->plan->areas.at[i];
        struct mesh_part *part = area->surface == labelled ? mesh_parts_find(parts, area->part) : NULL;
        if (part) {
            surfaces->meshes[i] = part->mesh;
            part->mesh = (struct mesh){0};
            area->label.hemisphere = area->label.hemisphere ? area->label.hemisphere : labelled->said.hemisphere;
        } else if (area->surface == labelled && !labelled->item->parts) {
            job_note(surfaces->job, "%s: label %u is on no triangle, left out", area->path, area->part);
        }
    }
}

/* Says what is in one of the surface's file of labels and on its triangles, and not in the other: labels without a
 * name, and of a surface all of whose labels are areas names without a triangle, since an area has a shape. */
static void note_missing(struct job *job, const struct labelled_surface *surface, const struct mesh_parts *parts)
{
    enum { SOME = 4 };
    const struct label_table *table = &surface->labels.table;
    const char *about = surface->item->list ? job_format(job, "%s: ", surface->path) : "";
    const char *names = "";
    size_t count = 0;
    for (size_t i = 0; i < parts->count; i++) {
        const struct label *label = label_table_find(table, parts->parts[i].label);
        if (!(label && label->name) && count++ < SOME) {
            names = job_format(job, "%s%s%u", names, count > 1 ? ", " : "", parts->parts[i].label);
        }
    }
    if (count) {
        job_warn(job, "%slabels of vertices that their table does not name: %zu (%s%s)", about, count, names,
                 count > SOME ? ", ..." : "");
    }
    names = "";
    count = 0;
    for (size_t i = 0; surface->item->parts && i < table->count; i++) {
        const char *name = table->entries[i].name;
        if (name && !mesh_parts_find(parts, table->entries[i].number) && count++ < SOME) {
            names = job_format(job, "%s%s%s", names, count > 1 ? ", " : "", name);
        }
    }
    if (count) {
        job_note(job, "%snames without a triangle: %zu (%s%s)", about, count, names, count > SOME ? ", ..." : "");
    }
}

static void cut_labelled(struct surfaces *surfaces, struct labelled_surface *labelled)
{
    struct job *job = surfaces->job;
    const struct mesh_file_options options = {.space = surfaces->space};
    struct vertex_labels *labels = &labelled->labels;
    struct mesh *mesh = &labelled->mesh;
    struct mesh_parts parts = {0};
    load_report(surfaces->load, labelled->path, 1);
    if (labelled->objects.count) {
        hand_out_parts(surfaces, labelled, &labelled->objects);
        return;
    }
    if (!mesh->vertex_count) {
        surface_read(job, mesh, &labelled->said, labelled->path, &options);
    }
    if (!labelled->item->label.hemisphere) {
        mesh_file_match_sides(job, labelled->said.hemisphere, labelled->path, labels->hemisphere,
                              labelled->labels_path);
    }
    vertex_labels_extend(job, labels, mesh->vertex_count);
    if (mesh->vertex_count != labels->count) {
        job_bad(job, "%s: labels of %zu vertices, the surface %s has %zu", labelled->labels_path, labels->count,
                labelled->path, mesh->vertex_count);
    }
    (void)JOB_CALL(job, mesh_split(&parts, mesh, labels->labels, &job->notes));
    hand_out_parts(surfaces, labelled, &parts);
    note_missing(job, labelled, &parts);
    mesh_parts_finish(&parts);
    mesh_finish(mesh);
}

/* Reads other programs' files: those with a placement of their own, or those without. */
static void read_foreign(struct surfaces *surfaces, bool placed)
{
    struct planned_area *areas = surfaces->plan->areas.at;
    struct mesh *received = job_zeroed(surfaces->job, surfaces->count, sizeof *received);
    const char **paths = job_zeroed(surfaces->job, surfaces->count, sizeof *paths);
    size_t n = 0;
    for (size_t i = 0; paths && i < surfaces->count; i++) {
        if (surfaces->is_foreign[i] && areas[i].placed == placed) {
            paths[n++] = areas[i].path;
        }
    }
    if (!n) {
        return;
    }
    load_report(surfaces->load, paths[0], n);
    mesh_foreign_files(surfaces->job, received, paths, n, placed ? MESH_SPACE_RAS : surfaces->space);
    n = 0;
    for (size_t i = 0; i < surfaces->count; i++) { /* after a failure they are empty */
        if (surfaces->is_foreign[i] && areas[i].placed == placed) {
            surfaces->meshes[i] = received[n++];
            name_area(surfaces->job, &areas[i], &(struct label){0});
        }
    }
}

static void read_own(struct surfaces *surfaces, size_t i)
{
    struct planned_area *area = &surfaces->plan->areas.at[i];
    const struct mesh_file_options options = {.space = surfaces->space};
    struct label said = {0};
    const size_t mark = job_in(surfaces->job, area->item->list, area->item->index);
    load_report(surfaces->load, area->path, 1);
    surface_read(surfaces->job, &surfaces->meshes[i], &said, area->path, &options);
    said.name = job_adopt(surfaces->job, said.name);
    said.abbreviation = job_adopt(surfaces->job, said.abbreviation);
    name_area(surfaces->job, area, &said);
    job_out(surfaces->job, mark);
}

static void read_all(struct surfaces *surfaces)
{
    struct area_plan *plan = surfaces->plan;
    for (size_t i = 0; i < surfaces->count; i++) { /* the reader reports a file that is not there */
        struct planned_area *area = &plan->areas.at[i];
        if (area->surface) {
            area->state = area->surface->state;
        } else {
            (void)file_state_find(&area->state, area->path);
        }
    }
    for (size_t i = 0; i < surfaces->count; i++) {
        const struct planned_area *area = &plan->areas.at[i];
        surfaces->is_foreign[i] =
            !area->surface && mesh_format_is_foreign(source_format(surfaces->job, area->path, ROLE_SURFACE));
    }
    const size_t mark = job_in(surfaces->job, surfaces->count ? plan->areas.at[0].item->list : NULL, JOB_ALONE);
    read_foreign(surfaces, true);
    read_foreign(surfaces, false);
    for (size_t i = 0; i < plan->labelled_count && job_ok(surfaces->job); i++) {
        cut_labelled(surfaces, &plan->labelled[i]);
    }
    job_out(surfaces->job, mark);
    for (size_t i = 0; i < surfaces->count && job_ok(surfaces->job); i++) {
        if (!plan->areas.at[i].surface && !surfaces->is_foreign[i]) {
            read_own(surfaces, i);
        }
    }
}

/* A note, mostly "path: text" about a surface. */
struct said {
    const char *path; /* NULL: it is about none */
    const char *text;
    size_t line;       /* which note it is */
    size_t count;      /* how many say the same, if it is the first of them; else 0 */
    const char *names; /* of their surfaces, as far as they are shown */
};

enum { SHOWN = 3 };

static int compare_with_path(const void *text, const void *path)
{
    return text_compare(*(const struct text *)text, text_from(*(const char *const *)path));
}

static int compare_lines(const void *a, const void *b)
{
    return compare_unsigned(((const struct said *)a)->line, ((const struct said *)b)->line);
}

/* Sorts notes about surfaces by their text, in front of all other notes. */
static int compare_said(const void *a, const void *b)
{
    const struct said *x = a;
    const struct said *y = b;
    return x->path && y->path ? strcmp(x->text, y->text) : (y->path != NULL) - (x->path != NULL);
}

/* Finds the surface that the note begins with, among the paths. */
static struct said read_note(const char **paths, size_t count, const char *note, size_t line)
{
    struct said said = {.line = line, .names = ""};
    for (const char *end = strstr(note, ": "); end && !said.path; end = strstr(end + 1, ": ")) {
        const struct text start = {note, (size_t)(end - note)};
        const char **path = bsearch(&start, paths, count, sizeof *paths, compare_with_path);
        said.path = path ? *path : NULL;
        said.text = end + 2;
    }
    return said;
}

/* Gathers the notes of surfaces. One that several share is kept once, at the first of them, as "N surfaces (a, b, ...):
 * text"; the log gets it with the path of that one. */
static void gather_notes(struct job *job, struct note_sink *sink, const struct surfaces *surfaces)
{
    const struct notes *from = &surfaces->notes;
    size_t path_count = surfaces->count;
    size_t count = from->count;
    const char **paths = job_array(job, &path_count, sizeof *paths);
    struct said *said = job_array(job, &count, sizeof *said);
    struct said *first = said; /* of those that say the same */
    for (size_t i = 0; i < path_count; i++) {
        paths[i] = surfaces->plan->areas.at[i].path;
    }
    if (!count || !path_count) {
        return;
    }
    order_sort(paths, path_count, sizeof *paths, compare_text_pointers);
    for (size_t i = 0; i < count; i++) {
        said[i] = read_note(paths, path_count, from->lines[i], i);
    }
    order_sort(said, count, sizeof *said, compare_said);
    for (size_t i = 0; i < count; i++) {
        const bool is_same = first->path && said[i].path && strcmp(first->text, said[i].text) == 0;
        first = is_same ? first : &said[i];
        if (first->count++ < SHOWN && first->path) {
            first->names =
                job_format(job, "%s%s%s", first->names, first->count > 1 ? ", " : "", path_base(said[i].path));
        }
    }
    order_sort(said, count, sizeof *said, compare_lines);
    for (size_t i = 0; i < count; i++) {
        const conus_severity severity = from->marks[i].severity;
        sink->path = said[i].count && said[i].path ? said[i].path : sink->path;
        if (said[i].count == 1) {
            job_put(job, severity, "%s", from->lines[i]);
        } else if (said[i].count) {
            job_put(job, severity, "%zu surfaces (%s%s): %s", said[i].count, said[i].names,
                    said[i].count > SHOWN ? ", ..." : "", said[i].text);
        }
    }
}

/* Gives the atlas and the log the notes, also of what could not be read. */
static void tell_notes(const struct surfaces *surfaces)
{
    struct load *load = surfaces->load;
    struct note_sink sink = load->sink;
    struct job telling = {.sink = &sink};
    gather_notes(&telling, &sink, surfaces);
    conus_status told = job_close(&telling, &load->atlas->notes, NULL);
    (void)JOB_CALL(surfaces->job, told);
    load_at(load, sink.path);
}

static void add_surfaces(const struct surfaces *surfaces)
{
    conus_atlas *atlas = surfaces->load->atlas;
    const struct planned_area *areas = surfaces->plan->areas.at;
    for (size_t i = 0; i < surfaces->count && job_ok(surfaces->job); i++) {
        const struct planned_area *area = &areas[i];
        struct mesh *mesh = &surfaces->meshes[i];
        char digits[LABEL_DIGITS];
        const conus_object object = label_object(&area->label, atlas->object_count, digits);
        if (area->placed) {
            mesh_transform(mesh, area->world_from_mesh);
        }
        if (mesh->triangle_count) { /* else it is a label on no triangle */
            (void)JOB_CALL(surfaces->job, atlas_add_mesh(atlas, &object, mesh));
        }
        if (!area->surface || !i || strcmp(areas[i - 1].path, area->path) != 0) {
            (void)JOB_CALL(surfaces->job, atlas_note_file(atlas, area->path, &area->state));
        }
    }
}

/* Warns if the sizes of the surfaces and of the areas of voxels differ too much. */
static void note_size(struct job *job, conus_atlas *atlas)
{
    bool said;
    const struct box3 surfaces = fit_box_of_areas(atlas, false, true);
    const struct box3 voxels = fit_box_of_areas(atlas, true, false);
    (void)JOB_CALL(job, fit_note_size(&said, &atlas->notes, "surfaces", &surfaces, &voxels));
}

/* Adds the groups that are no area yet. `map` is from labels to numbers of areas and groups. */
static void add_groups(struct job *job, const struct area_plan *plan, conus_atlas *atlas, struct label_map *map)
{
    for (size_t i = 0; job_ok(job) && i < plan->groups->count; i++) {
        const struct label *group = &plan->groups->entries[i];
        uint64_t *number = map_at(job, map, group->number);
        char digits[LABEL_DIGITS];
        const conus_object object = label_object(group, atlas->object_count, digits);
        if (*number) {
            continue;
        }
        if (!group->name) {
            job_bad(job, "tree: label %u is no area, and a new one needs a name", group->number);
        }
        (void)JOB_CALL(job, atlas_add_group(atlas, &object));
        *number = atlas->object_count;
    }
}

static void link_parent(struct job *job, conus_atlas *atlas, struct label_map *map, const struct label *label)
{
    const uint64_t child = label->has_parent ? *map_at(job, map, label->number) : 0;
    const uint64_t parent = label->has_parent ? *map_at(job, map, label->parent) : 0;
    if (child && parent) {
        atlas->objects[child - 1].parent = (uint32_t)parent;
    } else if (child) { /* else it was left out */
        job_bad(job, "label %u: its parent %u is no area (tree may name one)", label->number, label->parent);
    }
}

static void grow_tree(struct job *job, const struct area_plan *plan, conus_atlas *atlas)
{
    struct label_map map = {0};
    for (size_t i = 0; i < atlas->area_count && job_ok(job); i++) {
        *map_at(job, &map, atlas->objects[i].label) = i + 1;
    }
    add_groups(job, plan, atlas, &map);
    for (size_t i = 0; i < plan->areas.count && job_ok(job); i++) {
        link_parent(job, atlas, &map, &plan->areas.at[i].label);
    }
    for (size_t i = 0; job_ok(job) && i < plan->groups->count; i++) {
        link_parent(job, atlas, &map, &plan->groups->entries[i]);
    }
    label_map_finish(&map);
    (void)JOB_CALL(job, atlas_check_tree(atlas));
}

void area_plan_load(struct load *load, struct area_plan *plan, enum mesh_space space)
{
    struct job *job = &load->job;
    struct surfaces *surfaces = job_new(job, struct surfaces);
    if (!surfaces) {
        return;
    }
    *surfaces = (struct surfaces){.load = load, .job = job, .plan = plan, .space = space};
    surfaces->meshes = job_zeroed(job, plan->areas.count, sizeof *surfaces->meshes);
    surfaces->is_foreign = job_zeroed(job, plan->areas.count, sizeof *surfaces->is_foreign);
    surfaces->count = surfaces->is_foreign ? plan->areas.count : 0;
    job_own(job, end_surfaces, surfaces);
    if (job_step(job)) {
        const struct attempt attempt = job_try(job);
        read_all(surfaces);
        surfaces->notes = label_notes_swap(job, (struct notes){0}); /* of the attempt: the atlas has those before */
        attempt_end(job, &attempt, ATTEMPT_KEEP);
        tell_notes(surfaces);
    }
    if (job_step(job)) {
        add_surfaces(surfaces);
        note_size(job, load->atlas);
        grow_tree(job, plan, load->atlas);
    }
}
