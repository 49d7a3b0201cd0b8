/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds an atlas step by step, and answers what the public header asks of it. */
#include "atlas/atlas.h"

#include "atlas/palette.h"
#include "atlas/space.h"
#include "atlas/volume_sample.h"
#include "base/math3.h"
#include "base/memory.h"
#include "base/text.h"

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
    memory_free(atlas->places);
    memory_free(atlas->path);
    memory_free(atlas->label_source);
    memory_free(atlas->transfer);
    file_sums_finish(&atlas->files);
    notes_finish(&atlas->notes);
    memory_free(atlas);
}

/* Appends `volume` (taken over on success) and reports its index. */
static conus_status append_volume(conus_atlas *atlas, struct volume *volume, size_t *index)
{
    struct volume *volumes = memory_resize(atlas->volumes, atlas->volume_count + 1, sizeof *volumes);
    if (!volumes) {
        return CONUS_ERROR_MEMORY;
    }
    atlas->volumes = volumes;
    *index = atlas->volume_count++;
    volumes[*index] = *volume;
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

conus_status atlas_start(conus_atlas **out, const conus_volume_info *info, const char *label_source)
{
    conus_atlas *atlas = NULL;
    struct volume volume = {0};
    size_t index;
    conus_status status = volume_init(&volume, info);
    status = status ? status : atlas_create_empty(&atlas, label_source);
    status = status ? status : append_volume(atlas, &volume, &index);
    volume_finish(&volume);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
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

static conus_status areas_come_first(const conus_atlas *atlas, const conus_object *area)
{
    return atlas->object_count > atlas->area_count
               ? fail(CONUS_ERROR_ARGUMENT, "area %u: areas are added before pathways", area->label)
               : CONUS_OK;
}

conus_status atlas_add_mesh(conus_atlas *atlas, const conus_object *area, struct mesh *mesh)
{
    conus_object copy = *area;
    conus_status status = areas_come_first(atlas, area);
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
            object_finish(&atlas->objects[--atlas->object_count]);
        }
    }
    atlas->area_count = status ? atlas->area_count : atlas->object_count;
    return status;
}

conus_status atlas_add_group(conus_atlas *atlas, const conus_object *area)
{
    conus_status status = areas_come_first(atlas, area);
    status = status ? status : atlas_append_object(atlas, area, (struct object_place){.index = SIZE_MAX});
    atlas->area_count = status ? atlas->area_count : atlas->object_count;
    return status;
}

/* Makes volume->objects16 or 32 a mask of the voxels with values from the threshold on, and counts them. */
static conus_status mark_voxels(struct volume *volume, uint32_t number, uint64_t *voxels)
{
    float threshold = (float)volume->info.threshold;
    bool narrow = number <= UINT16_MAX;
    volume->objects16 = narrow ? memory_zeroed(volume->voxel_count, sizeof *volume->objects16) : NULL;
    volume->objects32 = narrow ? NULL : memory_zeroed(volume->voxel_count, sizeof *volume->objects32);
    if (!volume->objects16 && !volume->objects32) {
        return CONUS_ERROR_MEMORY;
    }
    *voxels = 0;
    for (size_t i = 0; i < volume->voxel_count; i++) {
        if (volume->values[i] >= threshold) { /* Eq. 6 */
            *voxels += 1;
            if (narrow) {
                volume->objects16[i] = (uint16_t)number;
            } else {
                volume->objects32[i] = number;
            }
        }
    }
    return CONUS_OK;
}

/* ---- Other areas ------------------------------------------------------------------------------------------------ */

/* Wider masks for the pathways whose numbers no longer fit, by volume. */
static conus_status widen_masks(uint32_t **wide, const conus_atlas *atlas, const conus_atlas *areas)
{
    size_t shift = areas->area_count - atlas->area_count;
    conus_status status = CONUS_OK;
    for (size_t i = atlas->area_count; !status && i < atlas->object_count; i++) {
        size_t index = atlas->places[i].index;
        const struct volume *volume = &atlas->volumes[index];
        if (volume->objects16 && i + 1 + shift > UINT16_MAX) {
            wide[index] = memory_zeroed(volume->voxel_count, sizeof **wide);
            status = wide[index] ? CONUS_OK : CONUS_ERROR_MEMORY;
        }
    }
    return status;
}

/* Lets the mask of a pathway say `number`; `wide` takes its place if there is one. */
static void renumber_mask(struct volume *volume, uint32_t *wide, uint32_t number)
{
    for (size_t v = 0; v < volume->voxel_count; v++) {
        bool marked = volume_object(volume, v) != 0;
        if (marked && wide) {
            wide[v] = number;
        } else if (marked && volume->objects16) {
            volume->objects16[v] = (uint16_t)number;
        } else if (marked) {
            volume->objects32[v] = number;
        }
    }
    if (wide) {
        memory_free(volume->objects16);
        volume->objects16 = NULL;
        volume->objects32 = wide;
    }
}

static void exchange_objects(conus_atlas *a, conus_atlas *b)
{
    conus_atlas held = *a;
    a->objects = b->objects;
    a->places = b->places;
    a->object_count = b->object_count;
    a->area_count = b->area_count;
    b->objects = held.objects;
    b->places = held.places;
    b->object_count = held.object_count;
    b->area_count = held.area_count;
}

conus_status atlas_exchange_areas(conus_atlas *atlas, conus_atlas *areas)
{
    uint32_t **wide = memory_zeroed(atlas->volume_count, sizeof *wide);
    conus_status status = wide ? CONUS_OK : CONUS_ERROR_MEMORY;
    areas->area_count = areas->object_count;
    for (size_t i = atlas->area_count; !status && i < atlas->object_count; i++) {
        status = atlas_append_object(areas, &atlas->objects[i], atlas->places[i]);
    }
    status = status ? status : widen_masks(wide, atlas, areas);
    for (size_t i = areas->area_count; !status && i < areas->object_count; i++) {
        size_t index = areas->places[i].index;
        renumber_mask(&atlas->volumes[index], wide[index], (uint32_t)i + 1);
        wide[index] = NULL;
    }
    if (!status) {
        exchange_objects(atlas, areas);
    }
    for (size_t i = 0; wide && i < atlas->volume_count; i++) {
        memory_free(wide[i]);
    }
    memory_free(wide);
    return status;
}

/* ---- Pathways and context --------------------------------------------------------------------------------------- */

/* Adds a volume of values as `object`, whose voxels are counted. */
static conus_status add_scalar(conus_atlas *atlas, const conus_volume_info *info, float *values, conus_object *object)
{
    struct volume volume = {0};
    size_t index;
    conus_status status = volume_init(&volume, info);
    if (!status) {
        volume.values = values;
        status = mark_voxels(&volume, (uint32_t)atlas->object_count + 1, &object->voxels);
    }
    if (!status) {
        object->volume_mm3 = (double)object->voxels * space_voxel_mm3(info);
        status = atlas_append_object(atlas, object, (struct object_place){.index = atlas->volume_count});
    }
    if (!status) {
        status = append_volume(atlas, &volume, &index);
        if (status) {
            object_finish(&atlas->objects[--atlas->object_count]);
        }
    }
    if (status) {
        volume.values = NULL; /* stays the caller's */
    }
    volume_finish(&volume);
    return status;
}

conus_status atlas_add_pathway(conus_atlas *atlas, const conus_volume_info *info, float *values, const char *name)
{
    uint32_t ordinal = (uint32_t)(atlas->object_count - atlas->area_count) + 1;
    conus_object object = {
        .kind = CONUS_KIND_PATHWAY, .label = ordinal, .name = name, .abbreviation = "", .named = true};
    palette_colour(object.rgb, 1000 + ordinal);
    return add_scalar(atlas, info, values, &object);
}

conus_status atlas_add_probabilistic_area(conus_atlas *atlas, const conus_volume_info *info, float *values,
                                          const conus_object *area)
{
    conus_object object = *area;
    conus_status status = areas_come_first(atlas, area);
    status = status ? status : add_scalar(atlas, info, values, &object);
    atlas->area_count = status ? atlas->area_count : atlas->object_count;
    return status;
}

conus_status conus_atlas_set_threshold(conus_atlas *atlas, size_t number, double threshold)
{
    if (!conus_atlas_object(atlas, number) || !atlas_object_is_scalar(atlas, (uint32_t)number)) {
        return fail(CONUS_ERROR_ARGUMENT, "object %zu is no pathway, and no area of probabilities", number);
    }
    if (!isfinite(threshold)) {
        return fail(CONUS_ERROR_ARGUMENT, "threshold: %g, a number is needed", threshold);
    }
    struct volume *volume = &atlas->volumes[atlas->places[number - 1].index];
    uint64_t voxels = 0;
    conus_status status = volume_own(volume);
    struct volume marked = {.info = volume->info, .values = volume->values, .voxel_count = volume->voxel_count};
    marked.info.threshold = threshold;
    status = status ? status : mark_voxels(&marked, (uint32_t)number, &voxels);
    if (!status) {
        memory_free(volume->objects16);
        memory_free(volume->objects32);
        volume->objects16 = marked.objects16;
        volume->objects32 = marked.objects32;
        volume->info.threshold = threshold;
        atlas->objects[number - 1].voxels = voxels;
        atlas->objects[number - 1].volume_mm3 = (double)voxels * space_voxel_mm3(&volume->info);
    }
    return status;
}

void conus_atlas_use_safe_colours(conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->object_count && !atlas->has_safe_colours; i++) {
        memcpy(atlas->places[i].own_rgb, atlas->objects[i].rgb, sizeof atlas->objects[i].rgb);
        palette_safe_colour(atlas->objects[i].rgb, i);
    }
    atlas->has_safe_colours = true;
}

void conus_atlas_use_own_colours(conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->object_count && atlas->has_safe_colours; i++) {
        memcpy(atlas->objects[i].rgb, atlas->places[i].own_rgb, sizeof atlas->objects[i].rgb);
    }
    atlas->has_safe_colours = false;
}

static const struct volume *grey_volume(const conus_atlas *atlas, size_t index)
{
    bool is_grey = index < atlas->volume_count && atlas->volumes[index].values;
    return is_grey ? &atlas->volumes[index] : NULL;
}

double conus_atlas_value(const conus_atlas *atlas, size_t index, const double point[3])
{
    const struct volume *volume = grey_volume(atlas, index);
    double at[3];
    size_t voxel;
    if (!volume || !volume_find_voxel(&voxel, volume, point)) {
        return NAN;
    }
    mat4_point(at, volume->voxel_from_world, point);
    return volume_trilinear(volume, at);
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
        double bin = ((double)volume->values[i] - low) * scale;
        if (bin >= 0) { /* NaN has no place */
            counts[bin < (double)bins ? (size_t)bin : bins - 1]++;
        }
    }
    return CONUS_OK;
}

conus_status atlas_set_context(conus_atlas *atlas, const conus_volume_info *info, float *values)
{
    struct volume volume = {0};
    struct volume *old = (struct volume *)atlas_context(atlas);
    uint64_t voxels;
    size_t index;
    conus_status status = volume_init(&volume, info);
    volume.values = values;
    if (!status && info->threshold > 0) {
        status = mark_voxels(&volume, VOLUME_BLOCKER, &voxels);
    }
    if (!status && old) {
        volume_finish(old);
        *old = volume;
        return CONUS_OK;
    }
    status = status ? status : append_volume(atlas, &volume, &index);
    if (status) {
        volume.values = NULL; /* stays the caller's */
    }
    volume_finish(&volume);
    return status;
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
    const struct volume *parcellation = atlas_parcellation(atlas);
    const char *own = atlas->files.count  ? atlas->files.items[0].path
                      : atlas->mesh_count ? atlas->meshes[0].path
                                          : NULL;
    const char *path = atlas->path ? atlas->path : parcellation ? parcellation->path : own;
    return path ? path : "";
}

const struct volume *atlas_parcellation(const conus_atlas *atlas)
{
    bool has = atlas->volume_count && atlas->volumes[0].info.role == CONUS_ROLE_PARCELLATION;
    return has ? &atlas->volumes[0] : NULL;
}

const struct volume *atlas_object_volume(const conus_atlas *atlas, uint32_t number)
{
    struct object_place place = atlas->places[number - 1];
    return place.is_mesh || place.index >= atlas->volume_count ? NULL : &atlas->volumes[place.index];
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
    return volume_find_voxel(&voxel, volume, point) ? volume->values[voxel] : NAN;
}

const conus_volume_info *conus_atlas_volume_of(const conus_atlas *atlas, size_t number)
{
    const struct volume *volume =
        conus_atlas_object(atlas, number) ? atlas_object_volume(atlas, (uint32_t)number) : NULL;
    return volume ? &volume->info : NULL;
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

size_t conus_atlas_note_count(const conus_atlas *atlas)
{
    return atlas ? atlas->notes.count : 0;
}

const char *conus_atlas_note(const conus_atlas *atlas, size_t index)
{
    return atlas && index < atlas->notes.count ? atlas->notes.lines[index] : NULL;
}
