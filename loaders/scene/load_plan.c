/* SPDX-License-Identifier: BSD-3-Clause */
/* From the "areas" of a manifest to a list of surfaces: single files, the files that match a pattern, and BrainGlobe
 * folders (structures.json, metadata.json and meshes/ID.obj). */
#include "loaders/scene/load_plan.h"

#include "base/buffer.h"
#include "base/folder.h"
#include "base/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "loaders/labels/globe_metadata.h"

#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { JSON_LIMIT = 1 << 20 };

static const double micrometres = 0.001; /* BrainGlobe's unit, in mm */

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
    for (size_t i = 0; i < plan->sheet_count; i++) {
        memory_free(plan->sheets[i].path);
        vertex_labels_finish(&plan->sheets[i].labels);
    }
    memory_free(plan->sheets);
    file_sums_finish(&plan->read);
    memory_free(plan->areas);
    label_table_finish(&plan->groups);
    *plan = (struct area_plan){0};
}

static conus_status copy_text(char **out, const char *text)
{
    *out = text ? memory_text(text, strlen(text)) : NULL;
    return text && !*out ? CONUS_ERROR_MEMORY : CONUS_OK;
}

static conus_status copy_label(struct label *out, const struct label *label)
{
    *out = *label;
    out->abbreviation = NULL;
    conus_status status = copy_text(&out->name, label->name);
    return status ? status : copy_text(&out->abbreviation, label->abbreviation);
}

/* Appends a copy of `label` with the surface `path` (taken over). */
static conus_status add_area(struct area_plan *plan, size_t entry, char *path, const struct label *label)
{
    if (plan->count == plan->capacity) {
        size_t capacity = plan->capacity ? 2 * plan->capacity : 64;
        struct planned_area *areas = memory_resize(plan->areas, capacity, sizeof *areas);
        if (!areas) {
            memory_free(path);
            return CONUS_ERROR_MEMORY;
        }
        plan->areas = areas;
        plan->capacity = capacity;
    }
    struct planned_area *area = &plan->areas[plan->count++];
    *area = (struct planned_area){.path = path, .entry = entry};
    return copy_label(&area->label, label);
}

/* ---- Files --------------------------------------------------------------------------------------- */

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
    return status ? status : add_area(plan, entry, file, &label);
}

/* ---- Surfaces with labelled vertices ----------------------------------------------------------------------------- */

/* The labels that vertices have, sorted, each once. */
static conus_status list_labels(uint32_t **out, size_t *count, const struct vertex_labels *labels)
{
    uint32_t *sorted = memory_raw(labels->count, sizeof *sorted);
    size_t kept = 0;
    if (!sorted) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < labels->count; i++) {
        sorted[kept] = labels->labels[i];
        kept += sorted[kept] != 0;
    }
    *out = sorted;
    *count = u32_sort_unique(sorted, kept);
    return CONUS_OK;
}

/* Plans the part `number` of the last sheet. */
static conus_status plan_part(struct area_plan *plan, size_t entry, const struct manifest_area *area, uint32_t number)
{
    const struct planned_sheet *sheet = &plan->sheets[plan->sheet_count - 1];
    const struct label *known = label_table_find(&sheet->labels.table, number);
    struct label label = known ? *known : (struct label){0};
    if (number > UINT32_MAX - area->label_offset) {
        return fail(CONUS_ERROR_DATA, "label_offset: %u + %u is above 4294967295", area->label_offset, number);
    }
    label.number = number + area->label_offset;
    label.hemisphere = area->label.hemisphere ? area->label.hemisphere : sheet->labels.hemisphere;
    label.has_parent = area->label.has_parent;
    label.parent = area->label.parent;
    char *path = memory_text(sheet->path, strlen(sheet->path));
    conus_status status = path ? add_area(plan, entry, path, &label) : CONUS_ERROR_MEMORY;
    if (!status) {
        struct planned_area *planned = &plan->areas[plan->count - 1];
        planned->is_part = true;
        planned->sheet = plan->sheet_count - 1;
        planned->part = number;
    }
    return status;
}

static conus_status add_sheet(struct area_plan *plan, const struct manifest_area *area, const char *path,
                              struct notes *notes)
{
    const struct mesh_file_options options = {.max_memory = plan->max_memory, .read = &plan->read};
    struct planned_sheet *sheets = memory_resize(plan->sheets, plan->sheet_count + 1, sizeof *sheets);
    char *labels = file_beside(path, area->vertex_labels);
    plan->sheets = sheets ? sheets : plan->sheets;
    if (!sheets || !labels) {
        memory_free(labels);
        return CONUS_ERROR_MEMORY;
    }
    struct planned_sheet *sheet = &sheets[plan->sheet_count++];
    *sheet = (struct planned_sheet){.path = file_beside(path, area->file)};
    conus_status status =
        sheet->path ? vertex_labels_read(&sheet->labels, labels, &options, notes) : CONUS_ERROR_MEMORY;
    memory_free(labels);
    return status;
}

static conus_status plan_sheet(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                               struct notes *notes)
{
    uint32_t *numbers = NULL;
    size_t count = 0;
    conus_status status = add_sheet(plan, area, path, notes);
    status = status ? status : list_labels(&numbers, &count, &plan->sheets[plan->sheet_count - 1].labels);
    for (size_t i = 0; !status && i < count; i++) {
        status = plan_part(plan, entry, area, numbers[i]);
    }
    memory_free(numbers);
    return status;
}

/* ---- Patterns -----------------------------------------------------------------------------------------------------
 */

/* Which names of a folder match a pattern, and how they give labels. */
struct matches {
    struct names names;
    char *folder;
    bool numbered;
    struct label_table table;
};

static void matches_finish(struct matches *matches)
{
    names_finish(&matches->names);
    memory_free(matches->folder);
    label_table_finish(&matches->table);
}

/* Keeps the names that match; all of them or none must hold a number. */
static conus_status sift_names(struct matches *matches, const char *pattern)
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

static conus_status find_matches(struct matches *matches, struct area_plan *plan, const struct manifest_area *area,
                                 const char *path, struct notes *notes)
{
    const struct label_use use = {.max_memory = plan->max_memory, .read = &plan->read};
    const char *format;
    char *pattern = file_beside(path, area->files);
    matches->folder = pattern ? path_folder(pattern) : NULL;
    conus_status status = matches->folder ? names_list(&matches->names, matches->folder, "") : CONUS_ERROR_MEMORY;
    status = status ? status : sift_names(matches, path_base(area->files));
    memory_free(pattern);
    if (!status && area->labels) {
        char *labels = file_beside(path, area->labels);
        status = labels ? label_file_read(&matches->table, &format, labels, &use, notes) : CONUS_ERROR_MEMORY;
        memory_free(labels);
    }
    return status;
}

/* The label of a file: its number, what the table says of that, what the entry says of all. */
static conus_status label_of_match(struct label *label, const struct matches *matches, size_t index,
                                   const struct manifest_area *area)
{
    bool found;
    uint32_t number = (uint32_t)index + 1;
    uint32_t offset = area->label_offset;
    conus_status status = matches->numbered ? number_in_name(&number, &found, matches->names.names[index]) : CONUS_OK;
    if (!status && number > UINT32_MAX - offset) {
        status = fail(CONUS_ERROR_DATA, "label_offset: %u + %u is above 4294967295", offset, number);
    }
    const struct label *known = label_table_find(&matches->table, number);
    *label = known ? *known : (struct label){0};
    label->number = number + offset;
    label->hemisphere = area->label.hemisphere ? area->label.hemisphere : label->hemisphere;
    label->parent = label->has_parent ? label->parent + offset : area->label.parent;
    label->has_parent = label->has_parent || area->label.has_parent;
    return status;
}

static conus_status plan_pattern(struct area_plan *plan, size_t entry, const struct manifest_area *area,
                                 const char *path, struct notes *notes)
{
    struct matches matches = {0};
    conus_status status = find_matches(&matches, plan, area, path, notes);
    for (size_t i = 0; !status && i < matches.names.count; i++) {
        struct label label;
        struct buffer file = {0};
        status = label_of_match(&label, &matches, i, area);
        buffer_format(&file, "%s%s", matches.folder, matches.names.names[i]);
        status = status ? status : buffer_status(&file);
        if (status) {
            buffer_finish(&file);
        } else {
            status = add_area(plan, entry, file.data, &label);
        }
    }
    matches_finish(&matches);
    return status;
}

/* ---- BrainGlobe ------------------------------------------------------------------------------------------------- */

/* Row and sign of the world axis that grows away from `corner`: BrainGlobe's letters name where an array axis starts.
 */
static bool read_corner(int *row, double *sign, char corner)
{
    static const char letters[] = "LRPAIS"; /* starts there: grows along +x, -x, +y, -y, +z, -z */
    const char *at = corner ? strchr(letters, corner >= 'a' ? corner - 'a' + 'A' : corner) : NULL;
    if (!at) {
        return false;
    }
    *row = (int)(at - letters) / 2;
    *sign = (at - letters) % 2 ? -1 : 1;
    return true;
}

static conus_status orient(double world_from_mesh[16], const char *orientation, double scale)
{
    bool used[3] = {false, false, false};
    memset(world_from_mesh, 0, 16 * sizeof *world_from_mesh);
    world_from_mesh[15] = 1;
    for (int axis = 0; axis < 3; axis++) {
        int row = 0;
        double sign = 0;
        if (strlen(orientation) != 3 || !read_corner(&row, &sign, orientation[axis]) || used[row]) {
            return fail(CONUS_ERROR_DATA,
                        "orientation: found \"%.8s\", one letter each of R or L, A or P, S or I is needed",
                        orientation);
        }
        used[row] = true;
        world_from_mesh[4 * axis + row] = sign * scale;
    }
    return CONUS_OK;
}

/* The orientation in metadata.json, "asr" without one. */
static conus_status read_orientation(char out[GLOBE_ORIENTATION], const char *folder, struct file_sums *read)
{
    struct bytes bytes = {0};
    struct buffer path = {0};
    buffer_format(&path, "%s/metadata.json", folder);
    conus_status status = buffer_status(&path);
    snprintf(out, GLOBE_ORIENTATION, "asr");
    if (!status && file_exists(path.data) && !(status = file_read(&bytes, path.data, JSON_LIMIT))) {
        status = globe_metadata_parse(out, (struct text){(const char *)bytes.data, bytes.size});
        status = status ? fail_in(status, path.data) : file_sums_add(read, path.data, &bytes);
    }
    bytes_finish(&bytes);
    buffer_finish(&path);
    return status;
}

/* A BrainGlobe folder while it is looked through. */
struct globe {
    char *folder;
    struct label_table structures;
    char **meshes;  /* [structures.count] paths, NULL where there is no file */
    bool *contains; /* [structures.count] another one with a mesh */
};

static void globe_finish(struct globe *globe)
{
    for (size_t i = 0; globe->meshes && i < globe->structures.count; i++) {
        memory_free(globe->meshes[i]);
    }
    memory_free(globe->meshes);
    memory_free(globe->contains);
    memory_free(globe->folder);
    label_table_finish(&globe->structures);
}

static conus_status find_globe_meshes(struct globe *globe)
{
    struct label_table *table = &globe->structures;
    globe->meshes = memory_zeroed(table->count, sizeof *globe->meshes);
    globe->contains = memory_zeroed(table->count, sizeof *globe->contains);
    conus_status status = globe->meshes && globe->contains ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < table->count; i++) {
        struct buffer path = {0};
        buffer_format(&path, "%s/meshes/%u.obj", globe->folder, table->entries[i].number);
        status = buffer_status(&path);
        if (status || !file_exists(path.data)) {
            buffer_finish(&path);
        }
        globe->meshes[i] = path.data;
    }
    return status;
}

/* Marks everything above each structure that has a mesh. */
static void mark_containers(struct globe *globe)
{
    struct label_table *table = &globe->structures;
    for (size_t i = 0; i < table->count; i++) {
        const struct label *at = &table->entries[i];
        for (size_t steps = 0; globe->meshes[i] && at && at->has_parent && steps < table->count; steps++) {
            at = label_table_find(table, at->parent);
            if (at) {
                globe->contains[at - table->entries] = true;
            }
        }
    }
}

static conus_status open_globe(struct globe *globe, struct area_plan *plan, const struct manifest_area *area,
                               const char *path, struct notes *notes)
{
    const struct label_use use = {.max_memory = plan->max_memory, .read = &plan->read};
    const char *format;
    struct buffer table = {0};
    globe->folder = file_beside(path, area->brainglobe);
    conus_status status = globe->folder ? CONUS_OK : CONUS_ERROR_MEMORY;
    buffer_format(&table, "%s/structures.json", status ? "" : globe->folder);
    status = status ? status : buffer_status(&table);
    status = status ? status : label_file_read(&globe->structures, &format, table.data, &use, notes);
    status = status ? status : find_globe_meshes(globe);
    buffer_finish(&table);
    if (!status) {
        mark_containers(globe);
    }
    return status;
}

static conus_status add_group(struct area_plan *plan, const struct label *label)
{
    struct label *group = label_table_add(&plan->groups, label->number);
    struct label copy = {0};
    conus_status status = group ? copy_label(&copy, label) : CONUS_ERROR_MEMORY;
    if (status) {
        label_finish(&copy);
        return status;
    }
    *group = copy;
    return CONUS_OK;
}

static conus_status plan_structures(struct area_plan *plan, size_t entry, struct globe *globe, bool all,
                                    const double world_from_mesh[16])
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < globe->structures.count; i++) {
        const struct label *label = &globe->structures.entries[i];
        if (globe->meshes[i] && (all || !globe->contains[i])) {
            status = add_area(plan, entry, globe->meshes[i], label);
            globe->meshes[i] = NULL;
            if (!status) {
                struct planned_area *area = &plan->areas[plan->count - 1];
                area->placed = true;
                memcpy(area->world_from_mesh, world_from_mesh, sizeof area->world_from_mesh);
            }
        } else if (globe->contains[i]) {
            status = add_group(plan, label);
        }
    }
    return status;
}

static conus_status plan_globe(struct area_plan *plan, size_t entry, const struct manifest_area *area, const char *path,
                               struct notes *notes)
{
    struct globe globe = {0};
    char orientation[GLOBE_ORIENTATION];
    double world_from_mesh[16];
    double scale = area->scale > 0 ? area->scale : micrometres;
    size_t before = plan->count;
    conus_status status = open_globe(&globe, plan, area, path, notes);
    if (!status && area->orientation) {
        snprintf(orientation, sizeof orientation, "%s", area->orientation);
    } else {
        status = status ? status : read_orientation(orientation, globe.folder, &plan->read);
    }
    status = status ? status : orient(world_from_mesh, orientation, scale);
    status = status ? status : plan_structures(plan, entry, &globe, area->all_structures, world_from_mesh);
    if (!status && plan->count == before) {
        status = fail(CONUS_ERROR_DATA, "brainglobe: %s/meshes holds no ID.obj of structures.json", area->brainglobe);
    }
    if (!status) {
        status = notes_add(notes,
                           "%s: %zu surfaces, stored times %g is mm, axes start at \"%s\"; the world's origin is that "
                           "corner",
                           globe.folder, plan->count - before, scale, orientation);
    }
    globe_finish(&globe);
    return status;
}

/* ---- The whole list --------------------------------------------------------------------------------------------- */

static int compare_areas(const void *a, const void *b)
{
    return compare_unsigned(((const struct planned_area *)a)->label.number,
                            ((const struct planned_area *)b)->label.number);
}

static conus_status refuse_twins(const struct area_plan *plan)
{
    for (size_t i = 1; i < plan->count; i++) {
        const struct planned_area *a = &plan->areas[i - 1];
        const struct planned_area *b = &plan->areas[i];
        if (a->label.number == b->label.number) {
            return fail(CONUS_ERROR_DATA,
                        "areas[%zu]: label %u is that of %s and of %s: each needs its own (label, label_offset)",
                        b->entry, b->label.number, path_base(a->path), path_base(b->path));
        }
    }
    return CONUS_OK;
}

static conus_status add_tree(struct area_plan *plan, const struct manifest *manifest)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < manifest->tree_count; i++) {
        struct label *node = &manifest->tree[i];
        struct planned_area *area = area_plan_find(plan, node->number);
        if (!area) {
            status = add_group(plan, node);
        } else if (node->has_parent) {
            area->label.has_parent = true;
            area->label.parent = node->parent;
        }
    }
    return status;
}

conus_status area_plan_make(struct area_plan *out, const struct manifest *manifest, const char *path,
                            struct notes *notes)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < manifest->area_count; i++) {
        char key[48];
        const struct manifest_area *area = &manifest->areas[i];
        status = area->vertex_labels ? plan_sheet(out, i, area, path, notes)
                 : area->file        ? plan_file(out, i, area, path)
                 : area->files       ? plan_pattern(out, i, area, path, notes)
                                     : plan_globe(out, i, area, path, notes);
        snprintf(key, sizeof key, "areas[%zu]", i);
        status = status ? fail_in(status, key) : CONUS_OK;
    }
    if (!status && out->count) {
        qsort(out->areas, out->count, sizeof *out->areas, compare_areas);
    }
    status = status ? status : refuse_twins(out);
    status = status ? status : add_tree(out, manifest);
    return status ? status : label_table_sort(&out->groups, notes);
}

struct planned_area *area_plan_find(const struct area_plan *plan, uint32_t label)
{
    struct planned_area key = {.label.number = label};
    return plan->count ? bsearch(&key, plan->areas, plan->count, sizeof key, compare_areas) : NULL;
}
