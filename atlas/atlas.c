/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds an atlas step by step, and implements the public accessors. */
#include "atlas/atlas.h"

#include "atlas/space.h"
#include "atlas/volume.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/text.h"
#include "conus/own.h"

#include <math.h>
#include <string.h>

static void object_finish(conus_object *object)
{
    memory_free((char *)object->name);
    memory_free((char *)object->abbreviation);
}

void conus_atlas_destroy(conus_atlas *atlas)
{
    if (!atlas) {
        return;
    }
    for (size_t i = 0; i < atlas->volume_count; i++) {
        volume_finish(&atlas->volumes[i]);
    }
    for (size_t i = 0; i < atlas->object_count; i++) {
        object_finish(&atlas->objects[i]);
    }
    memory_free(atlas->volumes);
    memory_free(atlas->objects);
    for (size_t i = 0; i < atlas->mesh_count; i++) {
        mesh_finish(&atlas->meshes[i]);
    }
    memory_free(atlas->meshes);
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        tractogram_finish(&atlas->tractograms[i]);
    }
    memory_free(atlas->tractograms);
    for (size_t i = 0; i < atlas->warp_count; i++) {
        deformation_finish(&atlas->warps[i].field);
    }
    memory_free(atlas->warps);
    memory_free(atlas->last_transform);
    atlas_cut_context_surfaces(atlas, 0);
    memory_free(atlas->context_surfaces);
    memory_free(atlas->pack);
    memory_free(atlas->places);
    name_set_finish(&atlas->taken);
    memory_free(atlas->path);
    memory_free(atlas->label_source);
    memory_free(atlas->transfer);
    file_sums_finish(&atlas->files);
    notes_finish(&atlas->notes);
    if (atlas->mapped) {
        file_unmap(atlas->mapped, atlas->mapped_size);
    }
    memory_free(atlas);
}

conus_status atlas_give(conus_atlas **out, conus_atlas *atlas, conus_status status)
{
    return GIVE(status, out, atlas, conus_atlas_destroy(atlas));
}

conus_status atlas_append_volume(conus_atlas *atlas, struct volume *volume)
{
    struct volume *volumes = memory_resize(atlas->volumes, atlas->volume_count + 1, sizeof *volumes);
    if (!volumes) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->volumes = volumes;
    volumes[atlas->volume_count++] = *volume;
    *volume = (struct volume){0};
    return CONUS_OK;
}

/* Capacity for one more: it is the next power of two, so only a count that is one has to grow. */
static conus_status reserve_object(conus_atlas *atlas)
{
    size_t count = atlas->object_count ? 2 * atlas->object_count : 1;
    if (atlas->object_count & (atlas->object_count - 1)) {
        return CONUS_OK;
    }
    conus_object *objects = memory_resize(atlas->objects, count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->objects = objects;
    struct object_place *places = memory_resize(atlas->places, count, sizeof *places);
    if (!places) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->places = places;
    return CONUS_OK;
}

conus_status atlas_append_object(conus_atlas *atlas, const conus_object *object, struct object_place place)
{
    conus_status status = reserve_object(atlas);
    conus_object copy = *object;
    copy.name = status ? NULL : text_to_utf8(text_from(object->name));
    copy.abbreviation = status ? NULL : text_to_utf8(text_from(object->abbreviation));
    if (!copy.name || !copy.abbreviation) {
        object_finish(&copy);
        return CONUS_ERROR_MEMORY;
    }
    atlas->places[atlas->object_count] = place;
    atlas->objects[atlas->object_count++] = copy;
    return CONUS_OK;
}

void atlas_cut_objects(conus_atlas *atlas, size_t count)
{
    name_set_finish(&atlas->taken);
    while (atlas->object_count > count) {
        object_finish(&atlas->objects[--atlas->object_count]);
    }
}

conus_status atlas_create_empty(conus_atlas **out, const char *label_source)
{
    conus_atlas *atlas = memory_zeroed(1, sizeof *atlas);
    char *source = memory_text(label_source, strlen(label_source));
    if (!atlas || !source) {
        memory_free(atlas);
        memory_free(source);
        return CONUS_ERROR_MEMORY;
    }
    atlas->label_source = source;
    *out = atlas;
    return CONUS_OK;
}

static conus_status append_mesh(conus_atlas *atlas, struct mesh *mesh)
{
    size_t count = atlas->mesh_count;
    bool full = (count & (count - 1)) == 0; /* the capacity is the next power of two */
    struct mesh *meshes = full ? memory_resize(atlas->meshes, count ? 2 * count : 1, sizeof *meshes) : atlas->meshes;
    if (!meshes) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->meshes = meshes;
    meshes[atlas->mesh_count++] = *mesh;
    *mesh = (struct mesh){0};
    return CONUS_OK;
}

conus_status atlas_check_order(const conus_atlas *atlas, const conus_object *area)
{
    return atlas->object_count > atlas->area_count
               ? fail(CONUS_ERROR_ARGUMENT, "area %u: areas are added before pathways and streamlines", area->label)
               : CONUS_OK;
}

conus_status atlas_add_mesh(conus_atlas *atlas, const conus_object *area, struct mesh *mesh)
{
    conus_object copy = *area;
    conus_status status = atlas_check_order(atlas, area);
    status = status ? status : mesh_measure(&mesh->shape, mesh);
    if (!status) {
        copy.kind = CONUS_KIND_AREA;
        copy.triangles = mesh->triangle_count;
        copy.closed = mesh->shape.closed;
        copy.volume_mm3 = mesh->shape.has_volume ? fabs(mesh->shape.volume_mm3) : 0;
        status = atlas_append_object(atlas, &copy, (struct object_place){.is_mesh = true, .index = atlas->mesh_count});
    }
    if (!status) {
        status = append_mesh(atlas, mesh);
        if (status) {
            atlas_cut_objects(atlas, atlas->object_count - 1);
        }
    }
    atlas->area_count = status ? atlas->area_count : atlas->object_count;
    return status;
}

conus_status atlas_add_group(conus_atlas *atlas, const conus_object *area)
{
    conus_status status = atlas_check_order(atlas, area);
    status = status ? status : atlas_append_object(atlas, area, (struct object_place){.index = SIZE_MAX});
    atlas->area_count = status ? atlas->area_count : atlas->object_count;
    return status;
}

static const struct volume *grey_volume(const conus_atlas *atlas, size_t index)
{
    bool is_grey = index < atlas->volume_count && volume_has_values(&atlas->volumes[index]);
    return is_grey ? &atlas->volumes[index] : NULL;
}

double conus_atlas_value(const conus_atlas *atlas, size_t index, const double point[3])
{
    const struct volume *volume = grey_volume(atlas, index);
    double at[3];
    if (!volume) {
        return NAN;
    }
    mat4_point(at, volume->voxel_from_world, point);
    return volume_reaches(volume, at) ? volume_trilinear(volume, at) : NAN;
}

conus_status conus_atlas_histogram(uint64_t *counts, size_t bins, const conus_atlas *atlas, size_t index)
{
    const struct volume *volume = grey_volume(atlas, index);
    if (!volume || bins == 0) {
        return fail(CONUS_ERROR_ARGUMENT, "volume %zu in %zu bins: a volume of values and 1 bin are needed", index,
                    bins);
    }
    double low = volume->info.minimum;
    double scale = volume->info.maximum > low ? (double)bins / (volume->info.maximum - low) : 0;
    memset(counts, 0, bins * sizeof *counts);
    for (size_t i = 0; i < volume->voxel_count; i++) {
        double bin = ((double)volume_value(volume, i) - low) * scale;
        if (bin >= 0) { /* NaN has no place */
            counts[bin < (double)bins ? (size_t)bin : bins - 1]++;
        }
    }
    return CONUS_OK;
}

conus_status atlas_add_file(conus_atlas *atlas, const char *path, const struct bytes *content)
{
    return file_sums_add(&atlas->files, path, content);
}

conus_status atlas_note_file(conus_atlas *atlas, const char *path, const struct file_state *before)
{
    struct bytes content = {0};
    conus_status status = file_read(&content, path, UINT64_MAX);
    status = status ? status : file_state_check(before, path);
    status = status ? status : atlas_add_file(atlas, path, &content);
    bytes_finish(&content);
    return status;
}

const struct volume *atlas_context(const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role == CONUS_ROLE_CONTEXT) {
            return &atlas->volumes[i];
        }
    }
    return NULL;
}

const char *atlas_path(const conus_atlas *atlas)
{
    const struct volume *parcellation = atlas_parcellation_count(atlas) ? &atlas->volumes[0] : NULL;
    const char *own = atlas->files.count  ? atlas->files.items[0].path
                      : atlas->mesh_count ? atlas->meshes[0].path
                                          : NULL;
    const char *path = atlas->path ? atlas->path : parcellation ? parcellation->path : own;
    return path ? path : "";
}

size_t atlas_parcellation_count(const conus_atlas *atlas)
{
    size_t count = 0;
    while (count < atlas->volume_count && atlas->volumes[count].info.role == CONUS_ROLE_PARCELLATION) {
        count++;
    }
    return count;
}

const struct volume *atlas_parcellation(const conus_atlas *atlas)
{
    return atlas_parcellation_count(atlas) == 1 ? &atlas->volumes[0] : NULL;
}

const struct volume *atlas_object_volume(const conus_atlas *atlas, uint32_t number)
{
    struct object_place place = atlas->places[number - 1];
    return place.is_mesh || place.is_bundle || place.index >= atlas->volume_count ? NULL : &atlas->volumes[place.index];
}

const struct volume *atlas_only_volume(const conus_atlas *atlas, uint32_t number)
{
    const struct volume *only = NULL;
    for (uint32_t below = 1; below <= atlas->object_count; below++) {
        bool has = atlas->objects[below - 1].voxels && atlas_is_below(atlas, below, number);
        const struct volume *volume = has ? atlas_object_volume(atlas, below) : NULL;
        if (volume && only && volume != only) {
            return NULL;
        }
        only = volume ? volume : only;
    }
    return only;
}

bool atlas_object_is_scalar(const conus_atlas *atlas, uint32_t number)
{
    const struct volume *volume = atlas_object_volume(atlas, number);
    return volume && volume_is_scalar(volume);
}

bool atlas_has_probabilities(const conus_atlas *atlas)
{
    return atlas->area_count && atlas_object_is_scalar(atlas, (uint32_t)atlas->area_count); /* they come last */
}

float atlas_probability(const conus_atlas *atlas, uint32_t number, const double point[3])
{
    const struct volume *volume = atlas_object_volume(atlas, number);
    size_t voxel;
    return volume_find_voxel(&voxel, volume, point) ? volume_value(volume, voxel) : NAN;
}

const struct mesh *atlas_object_mesh(const conus_atlas *atlas, uint32_t number)
{
    struct object_place place = atlas->places[number - 1];
    return place.is_mesh && !place.is_hidden ? &atlas->meshes[place.index] : NULL;
}

const struct mesh *atlas_stored_mesh(const conus_atlas *atlas, uint32_t number)
{
    struct object_place place = atlas->places[number - 1];
    return place.is_mesh ? &atlas->meshes[place.index] : NULL;
}

bool atlas_is_below(const conus_atlas *atlas, uint32_t number, uint32_t ancestor)
{
    while (number && number != ancestor) {
        number = atlas->objects[number - 1].parent;
    }
    return number;
}

conus_status atlas_check_tree(const conus_atlas *atlas)
{
    size_t deep = 0;
    for (size_t i = 1; i <= atlas->area_count; i++) {
        uint32_t at = atlas->objects[i - 1].parent;
        size_t above = at != 0;
        while (at && at != i && above <= ATLAS_DEPTH_LIMIT) {
            at = atlas->objects[at - 1].parent;
            above += at != 0;
        }
        if (at && at == i) {
            return fail(CONUS_ERROR_DATA, "tree: label %u lies below itself", atlas->objects[i - 1].label);
        }
        deep = at && !deep ? i : deep; /* below a circle, perhaps */
    }
    return deep ? fail(CONUS_ERROR_DATA, "tree: label %u has more than %d areas above it",
                       atlas->objects[deep - 1].label, ATLAS_DEPTH_LIMIT)
                : CONUS_OK;
}

size_t conus_atlas_object_count(const conus_atlas *atlas)
{
    return atlas ? atlas->object_count : 0;
}

const conus_object *conus_atlas_object(const conus_atlas *atlas, size_t number)
{
    return atlas && number >= 1 && number <= atlas->object_count ? &atlas->objects[number - 1] : NULL;
}

uint32_t conus_atlas_depth(const conus_atlas *atlas, size_t number)
{
    const conus_object *object = conus_atlas_object(atlas, number);
    uint32_t depth = 0;
    while (object && object->kind == CONUS_KIND_AREA) {
        depth += !atlas_is_paired(atlas, (uint32_t)(object - atlas->objects) + 1);
        object = conus_atlas_object(atlas, object->parent);
    }
    return depth;
}

const char *atlas_kind_word(conus_kind kind)
{
    static const char *const words[] = {
        [CONUS_KIND_AREA] = "area", [CONUS_KIND_PATHWAY] = "pathway", [CONUS_KIND_BUNDLE] = "bundle"};
    bool known = (size_t)kind < sizeof words / sizeof words[0] && words[kind];
    return known ? words[kind] : "unassigned";
}

/* By name. */
static int compare_names(const void *a, const void *b)
{
    const conus_object *const *one = a;
    const conus_object *const *other = b;
    return strcmp((*one)->name, (*other)->name);
}

const conus_object **atlas_by_name(const conus_atlas *atlas, size_t count)
{
    const conus_object **named = memory_raw(count + 1, sizeof(void *));
    for (size_t i = 0; named && i < count; i++) {
        named[i] = &atlas->objects[i];
    }
    order_sort((void *)named, named ? count : 0, sizeof(void *), compare_names);
    return named;
}

/* The words that tell objects of one name apart. */
static void set_prefixes(const char **out, const conus_atlas *atlas, const conus_object *const *named, size_t count)
{
    static const char *const words[2][3] = {{"", "left", "right"}, {"area", "left area", "right area"}};
    size_t areas = 0, sides[2] = {0};
    for (size_t i = 0; i < count; i++) {
        bool is_area = named[i]->kind == CONUS_KIND_AREA;
        areas += is_area;
        sides[0] += is_area && named[i]->hemisphere == 'L';
        sides[1] += is_area && named[i]->hemisphere == 'R';
    }
    for (size_t i = 0; i < count; i++) {
        const char side = named[i]->hemisphere;
        int word = sides[0] && sides[1] ? (side == 'L') + 2 * (side == 'R') : 0;
        out[named[i] - atlas->objects + 1] = named[i]->kind == CONUS_KIND_AREA ? words[areas < count][word]
                                             : areas                           ? atlas_kind_word(named[i]->kind)
                                                                               : "";
    }
}

conus_status conus_atlas_prefixes(const char **prefixes, const conus_atlas *atlas)
{
    const conus_object **named = atlas_by_name(atlas, atlas->object_count);
    if (!named) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t first = 0, end; first < atlas->object_count; first = end) {
        for (end = first + 1; end < atlas->object_count && strcmp(named[first]->name, named[end]->name) == 0;) {
            end++;
        }
        set_prefixes(prefixes, atlas, named + first, end - first);
    }
    prefixes[0] = "";
    memory_free((void *)named);
    return CONUS_OK;
}

size_t conus_atlas_volume_count(const conus_atlas *atlas)
{
    return atlas ? atlas->volume_count : 0;
}

const conus_volume_info *conus_atlas_volume(const conus_atlas *atlas, size_t index)
{
    return atlas && index < atlas->volume_count ? &atlas->volumes[index].info : NULL;
}

const char *conus_atlas_label_source(const conus_atlas *atlas)
{
    return atlas ? atlas->label_source : "";
}

size_t conus_atlas_file_count(const conus_atlas *atlas)
{
    return atlas ? atlas->files.count : 0;
}

const char *conus_atlas_file(const conus_atlas *atlas, size_t index)
{
    return atlas && index < atlas->files.count ? atlas->files.items[index].path : NULL;
}

const conus_pack_info *conus_atlas_pack_info(const conus_atlas *atlas)
{
    return atlas && atlas->pack ? &atlas->pack->info : NULL;
}

const char *conus_atlas_pack_source(conus_source_state *state, const conus_atlas *atlas, size_t index)
{
    if (!atlas || !atlas->pack || index >= atlas->pack->info.source_count) {
        return NULL;
    }
    const struct pack_source *source = &atlas->pack->sources[index];
    if (state) {
        *state = source->state;
    }
    return source->path;
}

size_t conus_atlas_note_count(const conus_atlas *atlas)
{
    return atlas ? atlas->notes.count : 0;
}

const char *conus_atlas_note(const conus_atlas *atlas, size_t index)
{
    return atlas && index < atlas->notes.count ? atlas->notes.lines[index] : NULL;
}

conus_severity conus_atlas_note_severity(const conus_atlas *atlas, size_t index)
{
    return notes_severity(&atlas->notes, index);
}

void atlas_note_move(conus_atlas *atlas)
{
    atlas->is_moved = true;
    atlas->is_mirrored = false;
    atlas->brain = atlas->brain == CONUS_BRAIN_OWN ? CONUS_BRAIN_OWN : CONUS_BRAIN_UNKNOWN;
}
