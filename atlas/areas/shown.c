/* SPDX-License-Identifier: BSD-3-Clause */
/* Hides objects, as if they had never been loaded. Readers of an atlas need not know: voxels of hidden areas hold no
 * object, hidden pathways are not hit (volume_can_be_hit()), hidden meshes are not there (atlas_object_mesh()). */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "base/memory.h"
#include "conus/own.h"

#include <string.h>

enum { NAMED = 4 }; /* names in a sentence */

static void show_voxels(struct volume *volume)
{
    for (size_t i = 0; i < volume->hidden_run_count; i++) {
        const struct hidden_run *run = &volume->hidden_runs[i];
        for (size_t v = run->first; v < run->first + run->count; v++) {
            volume_set_object(volume, v, run->object);
        }
    }
}

static void hide_voxels(struct volume *volume)
{
    for (size_t i = 0; i < volume->hidden_run_count; i++) {
        const struct hidden_run *run = &volume->hidden_runs[i];
        for (size_t v = run->first; v < run->first + run->count; v++) {
            volume_set_object(volume, v, 0);
        }
    }
}

/* The runs of one volume, as they are found. */
struct runs {
    struct hidden_run *items;
    size_t count, capacity;
};

static conus_status find_runs(struct runs *runs, const struct volume *volume, const bool *hidden)
{
    for (size_t first = 0, end; first < volume->voxel_count; first = end) {
        uint32_t object = volume_object(volume, first);
        for (end = first + 1; end < volume->voxel_count && volume_object(volume, end) == object;) {
            end++;
        }
        if (hidden[object]) {
            if (!memory_reserve(&runs->items, &runs->capacity, runs->count + 1, sizeof *runs->items)) {
                return CONUS_ERROR_MEMORY;
            }
            runs->items[runs->count++] = (struct hidden_run){first, end - first, object};
        }
    }
    return CONUS_OK;
}

/* Finds the runs of voxels to be hidden; steps have none. The voxels stay as they are, but become the volume's own. */
static conus_status plan_voxels(struct runs *runs, struct volume *volume, const bool *hidden)
{
    conus_status status = volume_own(volume);
    if (status || volume->step_count) {
        return status;
    }
    show_voxels(volume);
    status = find_runs(runs, volume, hidden);
    hide_voxels(volume);
    return status;
}

/* How many objects a volume's voxels have, and how many of these are hidden. */
struct in_volume {
    size_t count, hidden;
    bool changes; /* one is hidden that should not be, or the other way */
};

static struct in_volume look_at_volume(const conus_atlas *atlas, size_t index, const bool *hidden)
{
    struct in_volume found = {0};
    for (size_t i = 0; i < atlas->object_count; i++) {
        const struct object_place *place = &atlas->places[i];
        if (!place->is_mesh && !place->is_bundle && place->index == index) {
            found.count++;
            found.hidden += hidden[i + 1];
            found.changes = found.changes || place->is_hidden != hidden[i + 1];
        }
    }
    return found;
}

/* Whether hiding writes into a volume: voxels of a parcellation, or steps that several pathways share. */
static bool hiding_writes(const struct volume *volume, const struct in_volume *found)
{
    return found->changes && (volume->info.role == CONUS_ROLE_PARCELLATION || found->count > 1);
}

/* On failure nothing is changed. */
static conus_status set_hidden(conus_atlas *atlas, const bool *hidden)
{
    struct runs *runs = memory_zeroed(atlas->volume_count + 1, sizeof *runs);
    conus_status status = runs ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t v = 0; v < atlas->volume_count && !status; v++) {
        struct in_volume found = look_at_volume(atlas, v, hidden);
        status =
            hiding_writes(&atlas->volumes[v], &found) ? plan_voxels(&runs[v], &atlas->volumes[v], hidden) : CONUS_OK;
    }
    if (!status) {
        for (size_t v = 0; v < atlas->volume_count; v++) {
            struct volume *volume = &atlas->volumes[v];
            struct in_volume found = look_at_volume(atlas, v, hidden);
            if (hiding_writes(volume, &found)) {
                show_voxels(volume);
                memory_free(volume->hidden_runs);
                volume->hidden_runs = runs[v].items;
                volume->hidden_run_count = runs[v].count;
                runs[v].items = NULL;
                hide_voxels(volume);
            }
            for (size_t s = 0; s < volume->step_count && found.count > 1; s++) {
                volume->steps[s].is_hidden = hidden[volume->steps[s].number];
            }
            volume->is_hidden = found.count > 0 && found.hidden == found.count && volume_is_scalar(volume);
        }
        for (size_t i = 0; i < atlas->object_count; i++) {
            atlas->places[i].is_hidden = hidden[i + 1];
        }
    }
    for (size_t v = 0; runs && v < atlas->volume_count; v++) {
        memory_free(runs[v].items);
    }
    memory_free(runs);
    return status;
}

conus_status conus_atlas_set_hidden(conus_atlas *atlas, const bool *hidden)
{
    size_t count = atlas->object_count + 1;
    bool *copy = hidden ? memory_copy(hidden, count, sizeof *copy) : memory_zeroed(count, sizeof *copy);
    if (!copy) {
        return CONUS_ERROR_MEMORY;
    }
    copy[0] = false; /* "nothing" cannot be hidden */
    conus_status status = set_hidden(atlas, copy);
    memory_free(copy);
    return status;
}

bool conus_atlas_is_hidden(const conus_atlas *atlas, size_t number)
{
    return conus_atlas_object(atlas, number) && atlas->places[number - 1].is_hidden;
}

bool atlas_has_hidden(const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->object_count; i++) {
        if (atlas->places[i].is_hidden) {
            return true;
        }
    }
    return false;
}

bool atlas_has_meshes(const conus_atlas *atlas)
{
    for (uint32_t number = 1; atlas->mesh_count && number <= atlas->object_count; number++) {
        if (atlas_object_mesh(atlas, number)) {
            return true;
        }
    }
    return false;
}

struct naming {
    conus_atlas *atlas;
    uint32_t *named; /* [object_count + 1] its place in the list, from 1; 0 = it is not named */
    uint32_t count;
    struct object_index index;
};

static void mark_named(struct naming *naming, uint32_t number)
{
    naming->named[number] = naming->named[number] ? naming->named[number] : ++naming->count;
}

static conus_status name_object(void *user, struct text name)
{
    struct naming *naming = user;
    uint32_t halves[2];
    uint32_t found = object_index_find(&naming->index, name);
    if (!found && area_find_halves(halves, naming->atlas, name)) {
        mark_named(naming, halves[0]);
        mark_named(naming, halves[1]);
        return CONUS_OK;
    }
    conus_status status = found ? CONUS_OK : object_find(&found, naming->atlas, name);
    if (!status) {
        mark_named(naming, found);
    }
    return status;
}

/* A list is a source of the answers, so no output may overwrite it. */
static conus_status note_list(void *user, const char *path, const struct bytes *content)
{
    struct naming *naming = user;
    return atlas_add_file(naming->atlas, path, content);
}

/* Hides the objects that @p list names, or all others, among those that are not hidden yet. `named`, of zeros, gets
 * their places in the list. */
static conus_status hide_list(bool *hidden, uint32_t *named, conus_atlas *atlas, const char *list, bool others,
                              const char *what)
{
    struct naming naming = {.atlas = atlas, .named = named};
    conus_status status = object_index_init(&naming.index, atlas);
    if (!status) {
        status = area_list_read(text_from(list), name_object, note_list, &naming);
        status = status ? fail_in(status, what) : status;
    }
    for (uint32_t number = 1; number <= atlas->object_count && !status; number++) {
        uint32_t above = number; /* an area below a named one is named, too */
        while (above && !named[above]) {
            above = atlas->objects[above - 1].parent;
        }
        hidden[number] = hidden[number] || (above != 0) != others;
    }
    object_index_finish(&naming.index);
    return status;
}

static bool has_shape(const conus_object *object)
{
    return object->voxels || object->triangles || object->streamlines;
}

conus_status conus_atlas_show(conus_atlas *atlas, const char *only, const char *hide)
{
    size_t files = atlas->files.count;
    size_t count = atlas->object_count + 1;
    bool *hidden = memory_zeroed(count, sizeof *hidden);
    uint32_t *named = memory_zeroed(2 * count, sizeof *named); /* of only, then of hide */
    conus_status status = hidden && named ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = !status && only ? hide_list(hidden, named, atlas, only, true, "only") : status;
    status = !status && hide ? hide_list(hidden, named + count, atlas, hide, false, "hide") : status;
    bool is_something_left = !only && !hide;
    for (size_t i = 0; !status && i < atlas->object_count; i++) {
        is_something_left = is_something_left || (!hidden[i + 1] && has_shape(&atlas->objects[i]));
    }
    if (!status && !is_something_left) {
        status = fail(CONUS_ERROR_ARGUMENT,
                      "everything is hidden: nothing is left that has voxels, triangles or streamlines");
    }
    status = status ? status : set_hidden(atlas, hidden);
    for (size_t i = 0; !status && i < atlas->object_count; i++) {
        atlas->places[i].named = named[i + 1];
    }
    if (status) {
        file_sums_cut(&atlas->files, files);
    }
    memory_free(hidden);
    memory_free(named);
    return status;
}

/* Groups have nothing to hide. */
static bool is_listed(const conus_atlas *atlas, size_t number, conus_kind kind)
{
    const conus_object *object = &atlas->objects[number - 1];
    return atlas->places[number - 1].is_hidden && object->kind == kind && has_shape(object);
}

/* Lists the labels of one kind, which `words` names. */
static void list_labels(struct buffer *out, const conus_atlas *atlas, conus_kind kind, const char *words)
{
    const char *before = out->size ? "; " : "";
    for (size_t number = 1; number <= atlas->object_count; number++) {
        size_t end = number;
        uint32_t label = atlas->objects[number - 1].label;
        if (!is_listed(atlas, number, kind)) {
            continue;
        }
        while (end < atlas->object_count && is_listed(atlas, end + 1, kind) &&
               atlas->objects[end].label == label + (uint32_t)(end + 1 - number)) {
            end++;
        }
        buffer_format(out, "%s%s%u", before, words, label);
        if (end > number) {
            buffer_format(out, "-%u", atlas->objects[end - 1].label);
        }
        before = ",";
        words = "";
        number = end;
    }
}

void atlas_list_hidden(struct buffer *out, const conus_atlas *atlas)
{
    struct buffer list = {0};
    list_labels(&list, atlas, CONUS_KIND_AREA, "areas ");
    list_labels(&list, atlas, CONUS_KIND_PATHWAY, "pathways ");
    list_labels(&list, atlas, CONUS_KIND_BUNDLE, "bundles ");
    out->failed = out->failed || list.failed;
    buffer_text(out, list.data ? list.data : "");
    buffer_finish(&list);
}

void atlas_describe_shown(struct buffer *out, const conus_atlas *atlas)
{
    size_t count[2] = {0}; /* of those that are shown and hidden */
    for (size_t i = 0; i < atlas->object_count; i++) {
        count[atlas->places[i].is_hidden] += has_shape(&atlas->objects[i]);
    }
    bool hidden = count[1] <= count[0]; /* names the smaller group */
    size_t named = 0;
    buffer_text(out, !count[1] ? "" : hidden ? "all but" : "only");
    for (size_t i = 0; i < atlas->object_count && count[1] && named < NAMED; i++) {
        if (has_shape(&atlas->objects[i]) && atlas->places[i].is_hidden == hidden) {
            buffer_format(out, "%s %s", named ? "," : "", atlas->objects[i].name);
            named++;
        }
    }
    if (count[1] && count[hidden] > named) {
        buffer_format(out, " and %zu more", count[hidden] - named);
    }
}
