/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas as one block of memory: a head, what is small, and from a cache line on what is large. One walk over the
 * atlas says where everything lies, whether the block is measured, written or read. It lies here and not in atlas/
 * because distance maps are packed, too. */
#include "selection/batch/atlas_pack.h"

#include "atlas/tracts/tract_node.h"
#include "base/memory.h"
#include "selection/batch/pack_tracts.h"
#include "selection/batch/pack_walk.h"
#include "selection/engine/voxels/distance_map.h"

#include <assert.h>
#include <string.h>
#include <zlib.h>

/* What must be the same for a block to be read. */
struct head {
    char magic[24];
    uint64_t crc;    /* of what follows, up to the end of what is small */
    uint64_t layout; /* of this build's structures */
    uint64_t small_end, size;
};

static const char magic[24] = "conus-atlas " CONUS_VERSION;
static_assert(sizeof "conus-atlas " CONUS_VERSION <= sizeof magic, "name and version fit");

static uint64_t layout_of_structures(void)
{
    const size_t sizes[] = {sizeof(struct head),         sizeof(conus_atlas),         sizeof(struct volume),
                            sizeof(conus_object),        sizeof(struct object_place), sizeof(struct mesh),
                            sizeof(struct distance_map), sizeof(struct hidden_run),   sizeof(struct warp),
                            sizeof(struct tractogram),   sizeof(struct tract_scalar), sizeof(struct tract_node),
                            sizeof(struct tract_leaf)};
    uint64_t layout = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        layout = 1000003 * layout + sizes[i];
    }
    return layout;
}

/* Makes the distance map, and writes it to where the block has `at`. */
static void write_distances(struct pack_walk *walk, size_t at, const struct volume *source)
{
    size_t size = distance_map_size(source);
    uint8_t *map = memory_raw((size + PACK_LINE - 1) / PACK_LINE, PACK_LINE);
    walk->status = map ? distance_map_write(map, source) : CONUS_ERROR_MEMORY;
    pack_write_at(walk, at, map, size);
    memory_free(map);
}

static void pass_distances(struct pack_walk *walk, struct volume *volume, const struct volume *source)
{
    bool is_there = pack_whether(walk, walk->mode != PACK_ATTACH && volume_can_be_hit(source) ? source : NULL);
    size_t at = walk->large;
    uint8_t *place = is_there && !walk->status ? pack_place(walk, distance_map_size(volume)) : NULL;
    if (place && walk->mode == PACK_COPY) {
        walk->status = distance_map_write(place, source);
    } else if (is_there && walk->mode == PACK_WRITE && !walk->status) {
        write_distances(walk, at, source);
    } else if (walk->mode == PACK_ATTACH) {
        volume->distances = place;
    }
}

/* Each voxel has a value or an object of some bytes in the block. */
static bool fits_block(const struct volume *volume, const struct pack_walk *walk)
{
    const size_t *dim = volume->info.dim;
    size_t count;
    uint8_t hidden; /* not as bools, which damage could make neither */
    uint8_t joined;
    memcpy(&hidden, &volume->is_hidden, sizeof hidden);
    memcpy(&joined, &volume->is_joined, sizeof joined);
    return hidden <= 1 && joined <= 1 && dim[0] && dim[1] && dim[2] && memory_multiply(dim[0], dim[1], &count) &&
           memory_multiply(count, dim[2], &count) && count == volume->voxel_count && count <= walk->size;
}

/* Numbers, and of the rest nothing: what goes into the block, and all that is taken from it. So for each kind. */
static struct volume bare_volume(const struct volume *volume)
{
    struct volume bare = *volume;
    bare.path = NULL;
    bare.info.path = NULL;
    bare.objects16 = NULL;
    bare.objects32 = NULL;
    bare.values = NULL;
    bare.hidden_runs = NULL;
    bare.distances = NULL;
    bare.source = NULL;
    bare.is_borrowed = true;
    return bare;
}

/* Into a volume of zeros when attaching, else from a copy. */
static void pass_volume(struct pack_walk *walk, struct volume *volume)
{
    struct volume source = *volume;
    if ((walk->mode == PACK_COPY || walk->mode == PACK_WRITE) && volume_can_be_hit(&source)) {
        volume_measure_centres(&source);
    }
    struct volume plain = bare_volume(&source);
    pack_bytes(walk, &plain, sizeof plain);
    if (!walk->status && walk->mode == PACK_ATTACH && !fits_block(&plain, walk)) {
        walk->status = pack_fail_damaged();
    }
    if (walk->status) {
        return;
    }
    if (walk->mode == PACK_ATTACH) {
        *volume = bare_volume(&plain);
    }
    pack_text(walk, &volume->path);
    volume->info.path = volume->path;
    pack_array(walk, &volume->objects16, volume->voxel_count, sizeof *volume->objects16);
    pack_array(walk, &volume->objects32, volume->voxel_count, sizeof *volume->objects32);
    pack_array(walk, &volume->values, volume->voxel_count, sizeof *volume->values);
    pack_array(walk, &volume->hidden_runs, volume->hidden_run_count, sizeof *volume->hidden_runs);
    pass_distances(walk, volume, walk->mode == PACK_ATTACH ? volume : &source);
}

static struct mesh bare_mesh(const struct mesh *mesh)
{
    struct mesh bare = *mesh;
    bare.path = NULL;
    bare.positions = NULL;
    bare.triangles = NULL;
    bare.is_borrowed = true;
    return bare;
}

static void pass_mesh(struct pack_walk *walk, struct mesh *mesh)
{
    struct mesh plain = bare_mesh(mesh);
    pack_bytes(walk, &plain, sizeof plain);
    if (walk->status) {
        return;
    }
    if (walk->mode == PACK_ATTACH) {
        *mesh = bare_mesh(&plain);
    }
    pack_text(walk, &mesh->path);
    pack_array(walk, &mesh->positions, mesh->vertex_count, 3 * sizeof *mesh->positions);
    pack_array(walk, &mesh->triangles, mesh->triangle_count, 3 * sizeof *mesh->triangles);
}

static void pass_object(struct pack_walk *walk, conus_object *object, struct object_place *place)
{
    conus_object plain = *object;
    char *name = (char *)object->name;
    char *abbreviation = (char *)object->abbreviation;
    plain.name = NULL;
    plain.abbreviation = NULL;
    pack_bytes(walk, &plain, sizeof plain);
    pack_bytes(walk, place, sizeof *place);
    pack_text(walk, &name);
    pack_text(walk, &abbreviation);
    *object = plain;
    object->name = name;
    object->abbreviation = abbreviation;
}

/* A field has its vectors in the block. */
static bool fits_field(const struct deformation *field, const struct pack_walk *walk)
{
    size_t count;
    uint8_t stays; /* not as a bool, which damage could make neither */
    memcpy(&stays, &field->stays_outside, sizeof stays);
    return stays <= 1 && field->dim[0] > 1 && field->dim[1] > 1 && field->dim[2] > 1 &&
           memory_multiply(field->dim[0], field->dim[1], &count) && memory_multiply(count, field->dim[2], &count) &&
           count <= walk->size;
}

static void pass_warp(struct pack_walk *walk, struct warp *warp)
{
    struct warp plain = *warp;
    plain.field.vectors = NULL;
    plain.field.is_borrowed = true;
    pack_bytes(walk, &plain, sizeof plain);
    if (!walk->status && walk->mode == PACK_ATTACH && !fits_field(&plain.field, walk)) {
        walk->status = pack_fail_damaged();
    }
    if (walk->status) {
        return;
    }
    if (walk->mode == PACK_ATTACH) {
        plain.field.vectors = NULL;
        plain.field.is_borrowed = true;
        *warp = plain;
    }
    const size_t *dim = plain.field.dim;
    pack_array(walk, &warp->field.vectors, dim[0] * dim[1] * dim[2], 3 * sizeof *warp->field.vectors);
    if (!walk->status && walk->mode == PACK_ATTACH && !warp->field.vectors) {
        walk->status = pack_fail_damaged();
    }
}

static void pass_warps(struct pack_walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->warps = pack_reserve(walk, atlas->warps, counts->warp_count, sizeof *atlas->warps);
    for (size_t i = 0; i < counts->warp_count && !walk->status; i++) {
        struct warp warp = walk->mode == PACK_ATTACH ? (struct warp){0} : atlas->warps[i];
        pass_warp(walk, &warp);
        if (walk->mode == PACK_ATTACH) {
            atlas->warps[i] = warp;
            atlas->warp_count = i + 1;
        }
    }
}

static void pass_shapes(struct pack_walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->volumes = pack_reserve(walk, atlas->volumes, counts->volume_count, sizeof *atlas->volumes);
    for (size_t i = 0; i < counts->volume_count && !walk->status; i++) {
        struct volume volume = walk->mode == PACK_ATTACH ? (struct volume){0} : atlas->volumes[i];
        pass_volume(walk, &volume);
        if (walk->mode == PACK_ATTACH) {
            atlas->volumes[i] = volume;
            atlas->volume_count = i + 1;
        }
    }
    atlas->meshes = pack_reserve(walk, atlas->meshes, counts->mesh_count, sizeof *atlas->meshes);
    for (size_t i = 0; i < counts->mesh_count && !walk->status; i++) {
        struct mesh mesh = walk->mode == PACK_ATTACH ? (struct mesh){0} : atlas->meshes[i];
        pass_mesh(walk, &mesh);
        if (walk->mode == PACK_ATTACH) {
            atlas->meshes[i] = mesh;
            atlas->mesh_count = i + 1;
        }
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
}

static void pass_lists(struct pack_walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->files.items = pack_reserve(walk, atlas->files.items, counts->files.count, sizeof *atlas->files.items);
    for (size_t i = 0; i < counts->files.count && !walk->status; i++) {
        atlas->files.count = i + 1;
        pack_bytes(walk, atlas->files.items[i].sha256, sizeof atlas->files.items[i].sha256);
        pack_text(walk, &atlas->files.items[i].path);
    }
    atlas->notes.lines = pack_reserve(walk, atlas->notes.lines, counts->notes.count, sizeof *atlas->notes.lines);
    for (size_t i = 0; i < counts->notes.count && !walk->status; i++) {
        atlas->notes.count = i + 1;
        pack_text(walk, &atlas->notes.lines[i]);
    }
}

static conus_atlas bare_atlas(const conus_atlas *atlas)
{
    conus_atlas bare = *atlas;
    bare.volumes = NULL;
    bare.meshes = NULL;
    bare.tractograms = NULL;
    bare.warps = NULL;
    bare.objects = NULL;
    bare.places = NULL;
    bare.path = NULL;
    bare.label_source = NULL;
    bare.files.items = NULL;
    bare.files.paths = (struct name_set){0};
    bare.taken = (struct name_set){0};
    bare.transfer = NULL;
    bare.context_surfaces = NULL;
    bare.context_surface_count = 0;
    bare.notes.lines = NULL;
    bare.notes.marks = NULL;
    bare.notes.sink = NULL;
    bare.mapped = NULL;
    bare.mapped_size = 0;
    return bare;
}

/* Into an atlas of zeros when attaching, which has at every moment what conus_atlas_destroy() may end. */
static void pass_atlas(struct pack_walk *walk, conus_atlas *atlas)
{
    conus_atlas plain = bare_atlas(atlas);
    pack_bytes(walk, &plain, sizeof plain);
    const conus_atlas counts = plain;
    if (walk->mode == PACK_ATTACH && !walk->status) {
        *atlas = bare_atlas(&plain);
        atlas->volume_count = atlas->mesh_count = atlas->tractogram_count = atlas->object_count = atlas->files.count =
            atlas->notes.count = atlas->warp_count = 0;
    }
    pack_text(walk, &atlas->path);
    pack_text(walk, &atlas->label_source);
    pack_text(walk, &atlas->transfer);
    if (!walk->status) {
        pass_warps(walk, atlas, &counts);
        pass_shapes(walk, atlas, &counts);
        pack_tractograms(walk, atlas, counts.tractogram_count);
        pass_objects(walk, atlas, &counts);
        pack_check_bundles(walk, atlas);
        pass_lists(walk, atlas, &counts);
    }
}

static size_t round_up(size_t size)
{
    return (size + PACK_LINE - 1) / PACK_LINE * PACK_LINE;
}

/* The walk over an atlas that is only read: the walk writes to copies of its parts, and to them only what is there. */
static struct pack_walk walk_over(const conus_atlas *atlas, struct pack_walk walk)
{
    conus_atlas copy = *atlas;
    walk.small = sizeof(struct head);
    walk.small_end = walk.large;
    pass_atlas(&walk, &copy);
    return walk;
}

/* How large everything is. */
static struct pack_walk measure(const conus_atlas *atlas)
{
    return walk_over(atlas, (struct pack_walk){.mode = PACK_MEASURE});
}

size_t conus_atlas_packed_size(const conus_atlas *atlas)
{
    struct pack_walk walk = measure(atlas);
    return round_up(walk.small) + walk.large;
}

static uint64_t crc_of(const uint8_t *memory, size_t small_end)
{
    size_t from = offsetof(struct head, layout);
    return crc32_z(0, memory + from, small_end - from);
}

static void write_head(uint8_t *memory, size_t small_end, size_t size)
{
    struct head head = {.layout = layout_of_structures(), .small_end = small_end, .size = size};
    memcpy(head.magic, magic, sizeof magic);
    memcpy(memory, &head, sizeof head);
    head.crc = crc_of(memory, small_end);
    memcpy(memory, &head, sizeof head);
}

conus_status conus_atlas_pack(void *memory, size_t size, const conus_atlas *atlas)
{
    struct pack_walk measured = measure(atlas);
    size_t needed = round_up(measured.small) + measured.large;
    if (!memory || (uintptr_t)memory % PACK_LINE || size < needed) {
        return fail(CONUS_ERROR_ARGUMENT, "%zu bytes at %p for an atlas: %zu at a multiple of %d are needed", size,
                    memory, needed, PACK_LINE);
    }
    struct pack_walk walk = walk_over(
        atlas,
        (struct pack_walk){.mode = PACK_COPY, .memory = memory, .large = round_up(measured.small), .size = needed});
    write_head(memory, walk.small, needed);
    return walk.status;
}

conus_status atlas_pack_write(int descriptor, size_t at, const conus_atlas *atlas)
{
    struct pack_walk measured = measure(atlas);
    size_t small = round_up(measured.small);
    uint8_t *memory = memory_zeroed(small, 1);
    if (!memory) {
        return CONUS_ERROR_MEMORY;
    }
    struct pack_walk walk = walk_over(atlas, (struct pack_walk){.mode = PACK_WRITE,
                                                                .memory = memory,
                                                                .file = descriptor,
                                                                .file_at = at,
                                                                .large = small,
                                                                .size = small + measured.large});
    write_head(memory, walk.small, walk.size);
    pack_write_at(&walk, 0, memory, small);
    memory_free(memory);
    return walk.status;
}

static bool is_whole(const struct head *head, const uint8_t *memory, size_t size)
{
    return memcmp(head->magic, magic, sizeof magic) == 0 && head->layout == layout_of_structures() &&
           head->size <= size && head->small_end >= sizeof *head && head->small_end <= head->size &&
           round_up(head->small_end) <= head->size && crc_of(memory, head->small_end) == head->crc;
}

conus_status conus_atlas_attach(conus_atlas **out, const void *memory, size_t size)
{
    struct head head;
    if (!memory || (uintptr_t)memory % PACK_LINE) {
        return fail(CONUS_ERROR_ARGUMENT, "memory %p of an atlas: a multiple of %d is needed", memory, PACK_LINE);
    }
    memcpy(&head, memory, size < sizeof head ? 0 : sizeof head);
    if (size < sizeof head || !is_whole(&head, memory, size)) {
        return pack_fail_damaged();
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
    if (walk.status) {
        conus_atlas_destroy(atlas);
        return walk.status;
    }
    *out = atlas;
    return CONUS_OK;
}
