/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas as one block of memory: a head, the small things, and from a cache line on the large arrays. One walk over
 * the atlas says where everything lies, whether the block is measured, filled, written part by part, or read. */
#include "pack/pack.h"

#include "atlas/atlas.h"
#include "atlas/tracts/tract_node.h"
#include "base/memory.h"
#include "base/status.h"
#include "conus/own.h"
#include "selection/engine/voxels/distance_map.h"

#include <stddef.h>
#include <string.h>
#include <zlib.h>

enum { PACK_LINE = 64, PACK_BEHIND = 64 }; /* alignment of arrays; readable bytes behind each */

/* All is counted; or small things are copied; or large arrays are given to a sink, one after the other; or all is
 * attached. */
enum pack_mode { PACK_MEASURE, PACK_SMALL, PACK_LARGE, PACK_ATTACH };

/* A function that passes a part of an atlas serves all modes: it gives each number, text and array to one of the pack_
 * functions below, which counts it, puts it into the block, or takes it from there. After a failure they do nothing. */
struct pack_walk {
    enum pack_mode mode;
    uint8_t *memory; /* the block, which is only read; the small things; or NULL */
    pack_sink *sink;
    void *user;
    size_t small, small_end;
    size_t large, size;
    const struct tractogram *tractogram; /* whose scalars are passed */
    conus_status status;
};

static conus_status fail_damaged(void)
{
    return fail(CONUS_ERROR_DATA, "the memory holds no atlas that this version of conus has packed");
}

/* A block may hold anything: what does not fit is no atlas. */
static void pack_check(struct pack_walk *walk, bool fits)
{
    if (!walk->status && walk->mode == PACK_ATTACH && !fits) {
        walk->status = fail_damaged();
    }
}

/* To a multiple of a cache line. */
static size_t round_up(size_t size)
{
    return (size + PACK_LINE - 1) / PACK_LINE * PACK_LINE;
}

/* `size` small bytes at `data`, which are read, or written when attaching. */
static void pack_bytes(struct pack_walk *walk, void *data, size_t size)
{
    pack_check(walk, size <= walk->small_end - walk->small);
    if (walk->status) {
        return;
    }
    if (walk->mode == PACK_SMALL) {
        memcpy(walk->memory + walk->small, data, size);
    } else if (walk->mode == PACK_ATTACH) {
        memcpy(data, walk->memory + walk->small, size);
    }
    walk->small += size;
}

union item {
    conus_atlas atlas;
    conus_object object;
    struct object_place place;
    struct volume volume;
    struct mesh mesh;
    struct warp warp;
    struct tractogram tractogram;
    struct tract_scalar scalar;
    struct tract_group group;
    struct context_surface surface;
};

/* A struct without its pointers, which are NULL when it is attached, too, whatever the block has. */
static void pack_struct(struct pack_walk *walk, void *data, enum pack_kind kind)
{
    union item bare;
    memcpy(&bare, data, pack_kind_size(kind));
    pack_make_bare(&bare, kind);
    pack_bytes(walk, &bare, pack_kind_size(kind));
    pack_check(walk, pack_flags_are_sound(&bare, kind));
    if (walk->mode == PACK_ATTACH && !walk->status) {
        pack_make_bare(&bare, kind);
        memcpy(data, &bare, pack_kind_size(kind));
    }
}

/* A text of its own, or none. */
static void pack_text(struct pack_walk *walk, char **text)
{
    const bool attaches = walk->mode == PACK_ATTACH;
    size_t size = !attaches && *text ? strlen(*text) + 1 : 0;
    if (attaches) {
        *text = NULL;
    }
    pack_bytes(walk, &size, sizeof size);
    pack_check(walk, size <= walk->small_end - walk->small);
    if (!walk->status && size && attaches) {
        *text = memory_text((const char *)walk->memory + walk->small, size - 1);
        walk->status = *text ? CONUS_OK : CONUS_ERROR_MEMORY;
        walk->small += size;
    } else if (size) {
        pack_bytes(walk, *text, size);
    }
}

/* A text for people, which is plain whoever packed it. */
static void pack_words(struct pack_walk *walk, char **words)
{
    pack_text(walk, words);
    if (walk->mode == PACK_ATTACH && *words) {
        text_make_plain(*words, "");
    }
}

/* Passes the next `size` bytes, of a large array, and gives where they lie in the block; NULL where there is none. */
static uint8_t *pack_place(struct pack_walk *walk, size_t size)
{
    size_t at = walk->large;
    bool fits = walk->mode != PACK_ATTACH || (at <= walk->size && size <= walk->size - at);
    pack_check(walk, fits);
    if (walk->status) {
        return NULL;
    }
    walk->large += round_up(size + PACK_BEHIND);
    return walk->mode == PACK_ATTACH ? walk->memory + at : NULL;
}

/* Whether there is something. Not as a bool, which damage could make neither. */
static bool pack_whether(struct pack_walk *walk, const void *thing)
{
    uint8_t is_there = thing ? 1 : 0;
    pack_bytes(walk, &is_there, sizeof is_there);
    return is_there;
}

/* Gives the next large array, and zeros up to the one behind it, to the sink. */
static void pack_give(struct pack_walk *walk, const void *data, size_t size)
{
    static const uint8_t zeros[PACK_LINE + PACK_BEHIND];
    if (!walk->status) {
        walk->status = walk->sink(walk->user, data, size);
        walk->status = walk->status ? walk->status : walk->sink(walk->user, zeros, round_up(size + PACK_BEHIND) - size);
    }
}

/* An array that stays in the block; `array` is the address of a pointer, which may be NULL. */
static void pack_array(struct pack_walk *walk, void *array, size_t count, size_t size)
{
    void *given;
    size_t bytes = 0;
    memcpy(&given, array, sizeof given);
    bool is_there = pack_whether(walk, given);
    pack_check(walk, memory_multiply(count, size, &bytes));
    uint8_t *place = is_there && !walk->status ? pack_place(walk, bytes) : NULL;
    if (is_there && walk->mode == PACK_LARGE) {
        pack_give(walk, given, bytes);
    } else if (walk->mode == PACK_ATTACH) {
        memcpy(array, &place, sizeof place);
    }
}

/* Reserves memory for things that the atlas owns, up to the next power of two, as it does. */
static void *pack_reserve(struct pack_walk *walk, void *things, size_t count, size_t size)
{
    size_t capacity = 1;
    if (walk->mode != PACK_ATTACH || walk->status) {
        return things;
    }
    pack_check(walk, count <= walk->small_end); /* each takes a byte at least */
    while (!walk->status && capacity < count) {
        capacity *= 2;
    }
    things = walk->status ? things : memory_zeroed(capacity, size);
    walk->status = walk->status ? walk->status : things ? CONUS_OK : CONUS_ERROR_MEMORY;
    return things;
}

typedef void pass_item(struct pack_walk *walk, void *item);

/* Passes `count` things of `size` bytes; `list` is the address of the pointer to them. Each is a copy, since the atlas
 * is only read unless it is attached: then the things begin as zeros, and `counted` are there to be destroyed. */
static void pass_list(struct pack_walk *walk, void *list, size_t *counted, size_t count, size_t size, pass_item *pass)
{
    bool attaches = walk->mode == PACK_ATTACH;
    union item item;
    void *things;
    memcpy(&things, list, sizeof things);
    things = pack_reserve(walk, things, count, size);
    memcpy(list, &things, sizeof things);
    for (size_t i = 0; i < count && !walk->status; i++) {
        char *thing = (char *)things + i * size;
        memcpy(&item, thing, size);
        pass(walk, &item);
        if (attaches) {
            memcpy(thing, &item, size);
            *counted = i + 1;
        }
    }
}

static void pass_distances(struct pack_walk *walk, struct volume *volume)
{
    bool is_there = pack_whether(walk, walk->mode != PACK_ATTACH && volume_can_be_hit(volume) ? volume : NULL);
    uint8_t *place = is_there && !walk->status ? pack_place(walk, distance_map_size(volume)) : NULL;
    if (is_there && walk->mode == PACK_LARGE && !walk->status) {
        size_t size = distance_map_size(volume);
        uint8_t *map = memory_raw((size + PACK_LINE - 1) / PACK_LINE, PACK_LINE);
        walk->status = map ? distance_map_write(map, volume) : CONUS_ERROR_MEMORY;
        pack_give(walk, map, size);
        memory_free(map);
    } else if (walk->mode == PACK_ATTACH) {
        volume->distances = place;
    }
}

/* Each page of voxels has a number in the block, if not each voxel. */
static bool volume_fits(const struct volume *volume, const struct pack_walk *walk)
{
    const size_t *dim = volume->info.dim;
    size_t count;
    return dim[0] && dim[1] && dim[2] && memory_multiply(dim[0], dim[1], &count) &&
           memory_multiply(count, dim[2], &count) && count == volume->voxel_count && count / VALUE_PAGE <= walk->size;
}

/* The box, which sizes follow from, holds voxels, or none. */
static bool steps_are_sound(const struct volume *volume)
{
    const struct object_box *box = &volume->box;
    bool is_sound = (volume->step_count == 0) == !volume->steps && (!volume->step_count || volume->map.count);
    for (int a = 0; a < 3; a++) {
        is_sound = is_sound && (box->first[a] > box->last[a] || box->last[a] < volume->info.dim[a]);
    }
    return is_sound;
}

static void pass_map(struct pack_walk *walk, struct volume *volume)
{
    struct value_map *map = &volume->map;
    size_t width = map->width * VALUE_RUN; /* of a run */
    pack_array(walk, &volume->steps, volume->step_count, sizeof *volume->steps);
    pack_array(walk, &map->pages, value_map_pages(map->count), sizeof *map->pages);
    pack_array(walk, &map->runs, map->page_count, VALUE_RUNS * sizeof *map->runs);
    pack_array(walk, &map->codes, map->run_count, width);
    pack_array(walk, &map->table, map->table_count, sizeof *map->table);
    pack_check(walk, (!map->count || value_map_is_sound(map, volume->voxel_count)) && steps_are_sound(volume));
}

static void pass_volume(struct pack_walk *walk, void *item)
{
    struct volume *volume = item;
    if (walk->mode == PACK_SMALL && volume_can_be_hit(volume)) {
        volume_measure_centres(volume);
    }
    pack_struct(walk, volume, PACK_VOLUME);
    pack_check(walk, volume_fits(volume, walk));
    if (walk->status) {
        return;
    }
    pack_text(walk, &volume->path);
    volume->info.path = volume->path;
    pack_array(walk, &volume->objects16, volume->voxel_count, sizeof *volume->objects16);
    pack_array(walk, &volume->objects32, volume->voxel_count, sizeof *volume->objects32);
    pack_array(walk, &volume->values, volume->voxel_count, sizeof *volume->values);
    pass_map(walk, volume);
    pack_array(walk, &volume->hidden_runs, volume->hidden_run_count, sizeof *volume->hidden_runs);
    pass_distances(walk, volume);
}

static void pass_mesh(struct pack_walk *walk, void *item)
{
    struct mesh *mesh = item;
    pack_struct(walk, mesh, PACK_MESH);
    pack_text(walk, &mesh->path);
    pack_array(walk, &mesh->positions, mesh->vertex_count, 3 * sizeof *mesh->positions);
    pack_array(walk, &mesh->triangles, mesh->triangle_count, 3 * sizeof *mesh->triangles);
}

/* Counts that arrays in the block can have, and texts that end. */
static bool tractogram_fits(const struct tractogram *plain, const struct pack_walk *walk)
{
    return plain->point_count <= walk->size && plain->streamline_count < UINT32_MAX &&
           plain->streamline_count <= walk->size && plain->tree.run_count <= walk->size &&
           plain->tree.run_count <= UINT32_MAX;
}

static void pass_scalar(struct pack_walk *walk, void *item)
{
    struct tract_scalar *scalar = item;
    pack_struct(walk, scalar, PACK_SCALAR);
    size_t count = scalar->per_point ? walk->tractogram->point_count : walk->tractogram->streamline_count;
    pack_words(walk, &scalar->name);
    pack_array(walk, &scalar->values, count, scalar->components * sizeof *scalar->values);
    pack_check(walk, scalar->name && (!count || scalar->values));
}

static void pass_group(struct pack_walk *walk, void *item)
{
    struct tract_group *group = item;
    pack_bytes(walk, &group->count, sizeof group->count);
    pack_words(walk, &group->name);
    pack_array(walk, &group->members, group->count, sizeof *group->members);
    pack_check(walk, group->name && (!group->count || group->members));
}

static bool has_arrays(const struct tractogram *tractogram)
{
    const struct tract_tree *tree = &tractogram->tree;
    return tractogram->first && (tree->lengths || !tractogram->streamline_count) &&
           (tree->leaves || !tree->run_count) && (tree->marks || !tractogram->point_count) &&
           (tree->nodes || !tree->node_count) && (tractogram->points || tractogram->halves || !tractogram->point_count);
}

/* Into a tractogram of zeros when attaching, which has at every moment what tractogram_finish() may end. */
static void pass_tractogram(struct pack_walk *walk, void *item)
{
    struct tractogram *tractogram = item;
    struct tract_tree *tree = &tractogram->tree;
    bool attaches = walk->mode == PACK_ATTACH;
    pack_struct(walk, tractogram, PACK_TRACTOGRAM);
    const size_t scalar_count = tractogram->scalar_count, group_count = tractogram->group_count;
    if (attaches) {
        tractogram->scalar_count = tractogram->group_count = 0;
    }
    pack_check(walk, tractogram_fits(tractogram, walk));
    if (walk->status) {
        return;
    }
    pack_text(walk, &tractogram->path);
    pack_array(walk, &tractogram->points, tractogram->point_count, 3 * sizeof *tractogram->points);
    pack_array(walk, &tractogram->halves, tractogram->point_count, 3 * sizeof *tractogram->halves);
    pack_array(walk, &tractogram->first, tractogram->streamline_count + 1, sizeof *tractogram->first);
    pack_array(walk, &tree->nodes, tree->node_count, sizeof *tree->nodes);
    pack_array(walk, &tree->leaves, tract_leaf_count(tree->run_count), sizeof *tree->leaves);
    pack_array(walk, &tree->marks, tract_mark_count(tractogram->point_count), sizeof *tree->marks);
    pack_array(walk, &tree->lengths, tractogram->streamline_count, sizeof *tree->lengths);
    walk->tractogram = tractogram;
    pass_list(walk, &tractogram->scalars, &tractogram->scalar_count, scalar_count, sizeof *tractogram->scalars,
              pass_scalar);
    pass_list(walk, &tractogram->groups, &tractogram->group_count, group_count, sizeof *tractogram->groups, pass_group);
    pack_check(walk, tractogram->path && has_arrays(tractogram));
}

static bool bundle_is_sound(const conus_atlas *atlas, size_t object)
{
    const struct object_place *place = &atlas->places[object];
    return !place->is_bundle ||
           (place->index < atlas->tractogram_count &&
            (place->group == BUNDLE_OF_ALL || place->group < atlas->tractograms[place->index].group_count));
}

static void pass_object(struct pack_walk *walk, conus_object *object, struct object_place *place)
{
    char *name = (char *)object->name;
    char *abbreviation = (char *)object->abbreviation;
    pack_struct(walk, object, PACK_OBJECT);
    pack_struct(walk, place, PACK_PLACE);
    pack_words(walk, &name);
    pack_words(walk, &abbreviation);
    object->name = name;
    object->abbreviation = abbreviation;
}

/* A field has its vectors, or coefficients, in the block. */
static bool field_fits(const struct deformation *field, const struct pack_walk *walk)
{
    size_t count;
    return field->dim[0] > 1 && field->dim[1] > 1 && field->dim[2] > 1 &&
           memory_multiply(field->dim[0], field->dim[1], &count) && memory_multiply(count, field->dim[2], &count) &&
           count <= walk->size;
}

static void pass_warp(struct pack_walk *walk, void *item)
{
    struct warp *warp = item;
    const size_t *dim = warp->field.dim;
    pack_struct(walk, warp, PACK_WARP);
    pack_check(walk, field_fits(&warp->field, walk));
    if (walk->status) {
        return;
    }
    size_t nodes = dim[0] * dim[1] * dim[2];
    pack_array(walk, &warp->field.vectors, nodes, 3 * sizeof *warp->field.vectors);
    pack_array(walk, &warp->field.rest, nodes, 3 * sizeof *warp->field.rest);
    pack_array(walk, &warp->field.coefficients, nodes, 3 * sizeof *warp->field.coefficients);
    bool is_spline = warp->field.coefficients;
    pack_check(walk, is_spline ? dim[0] > 3 && dim[1] > 3 && dim[2] > 3 : warp->field.vectors != NULL);
}

/* Nothing changes the arrays of a surface around the areas, but its values are its own. */
static void pass_surface(struct pack_walk *walk, void *item)
{
    struct context_surface *surface = item;
    float *values = surface->values;
    pack_struct(walk, surface, PACK_SURFACE);
    pass_mesh(walk, &surface->mesh);
    pack_words(walk, &surface->map_name);
    pack_array(walk, &values, surface->mesh.vertex_count, sizeof *values);
    if (walk->mode == PACK_ATTACH && !walk->status && values) {
        surface->values = memory_copy(values, surface->mesh.vertex_count, sizeof *values);
        walk->status = surface->values ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
}

static void pass_objects(struct pack_walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->objects = pack_reserve(walk, atlas->objects, counts->object_count, sizeof *atlas->objects);
    atlas->places = pack_reserve(walk, atlas->places, counts->object_count, sizeof *atlas->places);
    for (size_t i = 0; i < counts->object_count && !walk->status; i++) {
        conus_object object = walk->mode == PACK_ATTACH ? (conus_object){0} : atlas->objects[i];
        pass_object(walk, &object, &atlas->places[i]);
        if (walk->mode == PACK_ATTACH) {
            atlas->objects[i] = object;
            atlas->object_count = i + 1;
        }
    }
    for (size_t i = 0; i < atlas->object_count && walk->mode == PACK_ATTACH && !walk->status; i++) {
        pack_check(walk, bundle_is_sound(atlas, i));
    }
}

static void pass_files_and_notes(struct pack_walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->files.items = pack_reserve(walk, atlas->files.items, counts->files.count, sizeof *atlas->files.items);
    for (size_t i = 0; i < counts->files.count && !walk->status; i++) {
        atlas->files.count = i + 1;
        pack_bytes(walk, atlas->files.items[i].sha256, sizeof atlas->files.items[i].sha256);
        pack_text(walk, &atlas->files.items[i].path);
        const struct file_sum *file = &atlas->files.items[i];
        pack_check(walk, file->path && memchr(file->sha256, 0, sizeof file->sha256));
    }
    struct notes *notes = &atlas->notes;
    notes->lines = pack_reserve(walk, notes->lines, counts->notes.count, sizeof *notes->lines);
    notes->marks = pack_reserve(walk, notes->marks, counts->notes.count, sizeof *notes->marks);
    for (size_t i = 0; i < counts->notes.count && !walk->status; i++) {
        uint8_t severity = walk->mode == PACK_ATTACH ? 0 : (uint8_t)notes->marks[i].severity;
        pack_bytes(walk, &severity, 1);
        pack_check(walk, severity >= CONUS_SEVERITY_NOTE && severity <= CONUS_SEVERITY_WARNING);
        if (walk->mode == PACK_ATTACH && !walk->status) {
            notes->marks[i] = (struct note_mark){(conus_severity)severity, true};
        }
        notes->count = i + 1;
        pack_words(walk, &notes->lines[i]);
        pack_check(walk, notes->lines[i]);
    }
}

/* Into an atlas of zeros when attaching, which has at every moment what conus_atlas_destroy() may end. */
static void pass_atlas(struct pack_walk *walk, conus_atlas *atlas)
{
    pack_struct(walk, atlas, PACK_ATLAS);
    pack_check(walk, (unsigned)atlas->brain <= CONUS_BRAIN_TEMPLATE);
    const conus_atlas counts = *atlas;
    if (walk->mode == PACK_ATTACH) {
        atlas->volume_count = atlas->mesh_count = atlas->tractogram_count = atlas->object_count = atlas->files.count =
            atlas->notes.count = atlas->warp_count = atlas->context_surface_count = 0;
    }
    pack_text(walk, &atlas->path);
    pack_words(walk, &atlas->label_source);
    pack_text(walk, &atlas->transfer);
    if (walk->status) {
        return;
    }
    pass_list(walk, &atlas->warps, &atlas->warp_count, counts.warp_count, sizeof *atlas->warps, pass_warp);
    pass_list(walk, &atlas->volumes, &atlas->volume_count, counts.volume_count, sizeof *atlas->volumes, pass_volume);
    pass_list(walk, &atlas->meshes, &atlas->mesh_count, counts.mesh_count, sizeof *atlas->meshes, pass_mesh);
    pass_list(walk, &atlas->tractograms, &atlas->tractogram_count, counts.tractogram_count, sizeof *atlas->tractograms,
              pass_tractogram);
    pass_list(walk, &atlas->context_surfaces, &atlas->context_surface_count, counts.context_surface_count,
              sizeof *atlas->context_surfaces, pass_surface);
    pass_objects(walk, atlas, &counts);
    pass_files_and_notes(walk, atlas, &counts);
}

/* Must be the same for a block to be read. */
struct head {
    char magic[24];
    uint64_t crc;    /* checksum of the bytes that follow, up to the end of the small arrays */
    uint64_t layout; /* of this build's structures */
    uint64_t small_end, size;
};

static const char magic[24] = "conus atlas";

/* The walk over an atlas that is only read: the walk writes to copies of its parts, and to them only what is there. */
static struct pack_walk walk_over(const conus_atlas *atlas, struct pack_walk walk)
{
    conus_atlas copy = *atlas;
    walk.small = sizeof(struct head);
    walk.small_end = walk.large;
    pass_atlas(&walk, &copy);
    return walk;
}

size_t conus_atlas_packed_size(const conus_atlas *atlas)
{
    struct pack_walk walk = walk_over(atlas, (struct pack_walk){.mode = PACK_MEASURE});
    return round_up(walk.small) + walk.large;
}

static uint64_t crc_of(const uint8_t *memory, size_t small_end)
{
    size_t from = offsetof(struct head, layout);
    return crc32_z(0, memory + from, small_end - from);
}

static void write_head(uint8_t *memory, size_t small_end, size_t size)
{
    struct head head = {.layout = pack_layout(), .small_end = small_end, .size = size};
    memcpy(head.magic, magic, sizeof magic);
    memcpy(memory, &head, sizeof head);
    head.crc = crc_of(memory, small_end);
    memcpy(memory, &head, sizeof head);
}

conus_status atlas_pack_give(const conus_atlas *atlas, pack_sink *sink, void *user)
{
    struct pack_walk measured = walk_over(atlas, (struct pack_walk){.mode = PACK_MEASURE});
    size_t small = round_up(measured.small);
    uint8_t *memory = memory_zeroed(small, 1);
    if (!memory) {
        return CONUS_ERROR_MEMORY;
    }
    struct pack_walk walk = {.mode = PACK_SMALL,
                             .memory = memory,
                             .large = small,
                             .size = small + measured.large,
                             .sink = sink,
                             .user = user};
    struct pack_walk filled = walk_over(atlas, walk);
    write_head(memory, filled.small, walk.size);
    conus_status status = filled.status ? filled.status : sink(user, memory, small);
    memory_free(memory);
    if (!status) {
        walk.mode = PACK_LARGE;
        walk.memory = NULL;
        status = walk_over(atlas, walk).status;
    }
    return status;
}

/* A pack_sink: behind what has been copied. */
static conus_status copy_on(void *user, const void *data, size_t size)
{
    uint8_t **at = user;
    memcpy(*at, data, size);
    *at += size;
    return CONUS_OK;
}

conus_status conus_atlas_pack(void *memory, size_t size, const conus_atlas *atlas)
{
    const size_t needed = conus_atlas_packed_size(atlas);
    uint8_t *at = memory;
    if (!memory || (uintptr_t)memory % PACK_LINE || size < needed) {
        return fail(CONUS_ERROR_ARGUMENT, "%zu bytes at %p for an atlas: %zu at a multiple of %d are needed", size,
                    memory, needed, PACK_LINE);
    }
    return atlas_pack_give(atlas, copy_on, &at);
}

/* Whether `size` bytes at `memory` are a block of this build's, undamaged in what is small. */
static bool is_whole(const struct head *head, const uint8_t *memory, size_t size)
{
    return memcmp(head->magic, magic, sizeof magic) == 0 && head->layout == pack_layout() && head->size <= size &&
           head->small_end >= sizeof *head && head->small_end <= head->size &&
           round_up(head->small_end) <= head->size && crc_of(memory, head->small_end) == head->crc;
}

conus_status atlas_attach_verified(conus_atlas **out, const void *memory, size_t size)
{
    struct head head;
    if (!memory || (uintptr_t)memory % PACK_LINE) {
        return fail(CONUS_ERROR_ARGUMENT, "memory %p of an atlas: a multiple of %d is needed", memory, PACK_LINE);
    }
    memcpy(&head, memory, size < sizeof head ? 0 : sizeof head);
    if (size < sizeof head || !is_whole(&head, memory, size)) {
        return fail_damaged();
    }
    conus_atlas *atlas = memory_zeroed(1, sizeof *atlas);
    struct pack_walk walk = {.mode = PACK_ATTACH,
                             .memory = (uint8_t *)memory, /* is only read */
                             .small = sizeof head,
                             .small_end = head.small_end,
                             .large = round_up(head.small_end),
                             .size = head.size};
    if (!atlas) {
        return CONUS_ERROR_MEMORY;
    }
    pass_atlas(&walk, atlas);
    return atlas_give(out, atlas, walk.status);
}

conus_status conus_atlas_attach(conus_atlas **out, const void *memory, size_t size)
{
    conus_atlas *atlas = NULL;
    conus_status status = atlas_attach_verified(&atlas, memory, size);
    for (size_t i = 0; !status && i < atlas->tractogram_count; i++) {
        status = tractogram_check_tree(&atlas->tractograms[i]);
        status = status == CONUS_ERROR_DATA ? fail_damaged() : status;
    }
    return atlas_give(out, atlas, status);
}
