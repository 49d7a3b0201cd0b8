/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas as one block of memory: a head, what is small, and from a cache line on what is large. One walk over the
 * atlas says where everything lies, whether the block is measured, written or read. It lies here and not in atlas/
 * because distance maps are packed, too. */
#include "selection/batch/atlas_pack.h"

#include "base/memory.h"
#include "selection/engine/voxels/distance_map.h"

#include <assert.h>
#include <errno.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { LINE = 64, BEHIND = 64 }; /* where arrays begin, and bytes behind each that may be read */

enum mode { MEASURE, PACK, WRITE, ATTACH };

/* What must be the same for a block to be read. */
struct head {
    char magic[24];
    uint64_t crc;    /* of what follows, up to the end of what is small */
    uint64_t layout; /* of this build's structures */
    uint64_t small_end, size;
};

struct walk {
    enum mode mode;
    uint8_t *memory; /* read only when attaching, NULL when measuring; when writing, only what is small */
    int file;        /* when writing */
    size_t file_at;  /* where the block begins in it */
    size_t small, small_end;
    size_t large, size;
    conus_status status;
};

static const char magic[24] = "conus-atlas " CONUS_VERSION;
static_assert(sizeof "conus-atlas " CONUS_VERSION <= sizeof magic, "name and version fit");

static uint64_t layout_of_structures(void)
{
    const size_t sizes[] = {sizeof(struct head),         sizeof(conus_atlas),         sizeof(struct volume),
                            sizeof(conus_object),        sizeof(struct object_place), sizeof(struct mesh),
                            sizeof(struct distance_map), sizeof(struct hidden_run),   sizeof(struct warp),
                            sizeof(struct tractogram)};
    uint64_t layout = 0;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        layout = 1000003 * layout + sizes[i];
    }
    return layout;
}

static conus_status fail_damaged(void)
{
    return fail(CONUS_ERROR_DATA, "the memory holds no atlas that this version of conus has packed");
}

/* ---- Steps of the walk ------------------------------------------------------------------------------------------- */

static void pass(struct walk *walk, void *data, size_t size)
{
    if (walk->status) {
        return;
    }
    if (walk->mode == ATTACH && size > walk->small_end - walk->small) {
        walk->status = fail_damaged();
        return;
    }
    if (walk->mode == PACK || walk->mode == WRITE) {
        memcpy(walk->memory + walk->small, data, size);
    } else if (walk->mode == ATTACH) {
        memcpy(data, walk->memory + walk->small, size);
    }
    walk->small += size;
}

/* A string of its own, or none. */
static void pass_text(struct walk *walk, char **text)
{
    char *given = *text;
    size_t size = walk->mode != ATTACH && given ? strlen(given) + 1 : 0;
    if (walk->mode == ATTACH) {
        *text = NULL;
    }
    pass(walk, &size, sizeof size);
    if (walk->status || size == 0) {
        return;
    }
    if (walk->mode == ATTACH) {
        bool fits = size <= walk->small_end - walk->small;
        *text = fits ? memory_text((const char *)walk->memory + walk->small, size - 1) : NULL;
        walk->status = !fits ? fail_damaged() : *text ? CONUS_OK : CONUS_ERROR_MEMORY;
        walk->small += size;
    } else {
        pass(walk, given, size);
    }
}

/* Where the next `size` bytes lie; NULL when measuring or writing, and where there are none. */
static uint8_t *pass_place(struct walk *walk, size_t size)
{
    size_t at = walk->large;
    bool in_memory = walk->mode == PACK || walk->mode == ATTACH;
    bool fits = walk->mode == MEASURE || (at <= walk->size && size <= walk->size - at);
    if (walk->status) {
        return NULL;
    }
    if (!fits) {
        walk->status = fail_damaged();
        return NULL;
    }
    walk->large += (size + BEHIND + LINE - 1) / LINE * LINE;
    return in_memory ? walk->memory + at : NULL;
}

/* Whether there is something. Not as a bool, which damage could make neither. */
static bool pass_whether(struct walk *walk, const void *thing)
{
    uint8_t is_there = thing ? 1 : 0;
    pass(walk, &is_there, sizeof is_there);
    return is_there;
}

/* To where the block has `at`. */
static void write_at(struct walk *walk, size_t at, const uint8_t *data, size_t size)
{
    while (!walk->status && size) {
        ssize_t n = pwrite(walk->file, data, size, (off_t)(walk->file_at + at));
        if (n < 0 && errno != EINTR) {
            walk->status = fail(CONUS_ERROR_IO, "cannot write a packed atlas: %s", strerror(errno));
        }
        size_t done = n > 0 ? (size_t)n : 0;
        data += done;
        at += done;
        size -= done;
    }
}

/* An array that stays in the block; `array` is the address of a pointer. Whether there is one is passed, too. */
static void pass_array(struct walk *walk, void *array, size_t count, size_t size)
{
    void *given;
    size_t bytes = 0;
    memcpy(&given, array, sizeof given);
    bool is_there = pass_whether(walk, given);
    if (!walk->status && !memory_multiply(count, size, &bytes)) {
        walk->status = fail_damaged();
    }
    size_t at = walk->large;
    uint8_t *place = is_there && !walk->status ? pass_place(walk, bytes) : NULL;
    if (place && walk->mode == PACK) {
        memcpy(place, given, bytes);
    } else if (is_there && walk->mode == WRITE) {
        write_at(walk, at, given, walk->status ? 0 : bytes);
    } else if (walk->mode == ATTACH) {
        memcpy(array, &place, sizeof place);
    }
}

/* Reserves memory for things that the atlas has by itself, up to the next power of two, as it does. */
static void *reserve(struct walk *walk, void *things, size_t count, size_t size)
{
    size_t capacity = 1;
    if (walk->mode != ATTACH || walk->status) {
        return things;
    }
    if (count > walk->small_end) { /* each takes a byte at least */
        walk->status = fail_damaged();
        return things;
    }
    while (capacity < count) {
        capacity *= 2;
    }
    things = memory_zeroed(capacity, size);
    walk->status = things ? CONUS_OK : CONUS_ERROR_MEMORY;
    return things;
}

/* ---- The parts of an atlas --------------------------------------------------------------------------------------- */

/* Makes the distance map, and writes it to where the block has `at`. */
static void write_distances(struct walk *walk, size_t at, const struct volume *source)
{
    size_t size = distance_map_size(source);
    uint8_t *map = memory_raw((size + LINE - 1) / LINE, LINE);
    walk->status = map ? distance_map_write(map, source) : CONUS_ERROR_MEMORY;
    write_at(walk, at, map, size);
    memory_free(map);
}

static void pass_distances(struct walk *walk, struct volume *volume, const struct volume *source)
{
    bool is_there = pass_whether(walk, walk->mode != ATTACH && volume_can_be_hit(source) ? source : NULL);
    size_t at = walk->large;
    uint8_t *place = is_there && !walk->status ? pass_place(walk, distance_map_size(volume)) : NULL;
    if (place && walk->mode == PACK) {
        walk->status = distance_map_write(place, source);
    } else if (is_there && walk->mode == WRITE && !walk->status) {
        write_distances(walk, at, source);
    } else if (walk->mode == ATTACH) {
        volume->distances = place;
    }
}

/* Each voxel has a value or an object of some bytes in the block. */
static bool fits_block(const struct volume *volume, const struct walk *walk)
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
static void pass_volume(struct walk *walk, struct volume *volume)
{
    struct volume source = *volume;
    if ((walk->mode == PACK || walk->mode == WRITE) && volume_can_be_hit(&source)) {
        volume_measure_centres(&source);
    }
    struct volume plain = bare_volume(&source);
    pass(walk, &plain, sizeof plain);
    if (!walk->status && walk->mode == ATTACH && !fits_block(&plain, walk)) {
        walk->status = fail_damaged();
    }
    if (walk->status) {
        return;
    }
    if (walk->mode == ATTACH) {
        *volume = bare_volume(&plain);
    }
    pass_text(walk, &volume->path);
    volume->info.path = volume->path;
    pass_array(walk, &volume->objects16, volume->voxel_count, sizeof *volume->objects16);
    pass_array(walk, &volume->objects32, volume->voxel_count, sizeof *volume->objects32);
    pass_array(walk, &volume->values, volume->voxel_count, sizeof *volume->values);
    pass_array(walk, &volume->hidden_runs, volume->hidden_run_count, sizeof *volume->hidden_runs);
    pass_distances(walk, volume, walk->mode == ATTACH ? volume : &source);
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

static void pass_mesh(struct walk *walk, struct mesh *mesh)
{
    struct mesh plain = bare_mesh(mesh);
    pass(walk, &plain, sizeof plain);
    if (walk->status) {
        return;
    }
    if (walk->mode == ATTACH) {
        *mesh = bare_mesh(&plain);
    }
    pass_text(walk, &mesh->path);
    pass_array(walk, &mesh->positions, mesh->vertex_count, 3 * sizeof *mesh->positions);
    pass_array(walk, &mesh->triangles, mesh->triangle_count, 3 * sizeof *mesh->triangles);
}

static void pass_object(struct walk *walk, conus_object *object, struct object_place *place)
{
    conus_object plain = *object;
    char *name = (char *)object->name;
    char *abbreviation = (char *)object->abbreviation;
    plain.name = NULL;
    plain.abbreviation = NULL;
    pass(walk, &plain, sizeof plain);
    pass(walk, place, sizeof *place);
    pass_text(walk, &name);
    pass_text(walk, &abbreviation);
    *object = plain;
    object->name = name;
    object->abbreviation = abbreviation;
}

/* A field has its vectors in the block. */
static bool fits_field(const struct deformation *field, const struct walk *walk)
{
    size_t count;
    uint8_t stays; /* not as a bool, which damage could make neither */
    memcpy(&stays, &field->stays_outside, sizeof stays);
    return stays <= 1 && field->dim[0] > 1 && field->dim[1] > 1 && field->dim[2] > 1 &&
           memory_multiply(field->dim[0], field->dim[1], &count) && memory_multiply(count, field->dim[2], &count) &&
           count <= walk->size;
}

static void pass_warp(struct walk *walk, struct warp *warp)
{
    struct warp plain = *warp;
    plain.field.vectors = NULL;
    plain.field.is_borrowed = true;
    pass(walk, &plain, sizeof plain);
    if (!walk->status && walk->mode == ATTACH && !fits_field(&plain.field, walk)) {
        walk->status = fail_damaged();
    }
    if (walk->status) {
        return;
    }
    if (walk->mode == ATTACH) {
        plain.field.vectors = NULL;
        plain.field.is_borrowed = true;
        *warp = plain;
    }
    const size_t *dim = plain.field.dim;
    pass_array(walk, &warp->field.vectors, dim[0] * dim[1] * dim[2], 3 * sizeof *warp->field.vectors);
    if (!walk->status && walk->mode == ATTACH && !warp->field.vectors) {
        walk->status = fail_damaged();
    }
}

static void pass_warps(struct walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->warps = reserve(walk, atlas->warps, counts->warp_count, sizeof *atlas->warps);
    for (size_t i = 0; i < counts->warp_count && !walk->status; i++) {
        struct warp warp = walk->mode == ATTACH ? (struct warp){0} : atlas->warps[i];
        pass_warp(walk, &warp);
        if (walk->mode == ATTACH) {
            atlas->warps[i] = warp;
            atlas->warp_count = i + 1;
        }
    }
}

static void pass_shapes(struct walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->volumes = reserve(walk, atlas->volumes, counts->volume_count, sizeof *atlas->volumes);
    for (size_t i = 0; i < counts->volume_count && !walk->status; i++) {
        struct volume volume = walk->mode == ATTACH ? (struct volume){0} : atlas->volumes[i];
        pass_volume(walk, &volume);
        if (walk->mode == ATTACH) {
            atlas->volumes[i] = volume;
            atlas->volume_count = i + 1;
        }
    }
    atlas->meshes = reserve(walk, atlas->meshes, counts->mesh_count, sizeof *atlas->meshes);
    for (size_t i = 0; i < counts->mesh_count && !walk->status; i++) {
        struct mesh mesh = walk->mode == ATTACH ? (struct mesh){0} : atlas->meshes[i];
        pass_mesh(walk, &mesh);
        if (walk->mode == ATTACH) {
            atlas->meshes[i] = mesh;
            atlas->mesh_count = i + 1;
        }
    }
}

static void pass_objects(struct walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->objects = reserve(walk, atlas->objects, counts->object_count, sizeof *atlas->objects);
    atlas->places = reserve(walk, atlas->places, counts->object_count, sizeof *atlas->places);
    for (size_t i = 0; i < counts->object_count && !walk->status; i++) {
        conus_object object = walk->mode == ATTACH ? (conus_object){0} : atlas->objects[i];
        pass_object(walk, &object, &atlas->places[i]);
        if (walk->mode == ATTACH) {
            atlas->objects[i] = object;
            atlas->object_count = i + 1;
        }
    }
}

static void pass_lists(struct walk *walk, conus_atlas *atlas, const conus_atlas *counts)
{
    atlas->files.items = reserve(walk, atlas->files.items, counts->files.count, sizeof *atlas->files.items);
    for (size_t i = 0; i < counts->files.count && !walk->status; i++) {
        atlas->files.count = i + 1;
        pass(walk, atlas->files.items[i].sha256, sizeof atlas->files.items[i].sha256);
        pass_text(walk, &atlas->files.items[i].path);
    }
    atlas->notes.lines = reserve(walk, atlas->notes.lines, counts->notes.count, sizeof *atlas->notes.lines);
    for (size_t i = 0; i < counts->notes.count && !walk->status; i++) {
        atlas->notes.count = i + 1;
        pass_text(walk, &atlas->notes.lines[i]);
    }
}

static conus_atlas bare_atlas(const conus_atlas *atlas)
{
    conus_atlas bare = *atlas;
    bare.volumes = NULL;
    bare.meshes = NULL;
    bare.warps = NULL;
    bare.objects = NULL;
    bare.places = NULL;
    bare.path = NULL;
    bare.label_source = NULL;
    bare.files.items = NULL;
    bare.transfer = NULL;
    bare.notes.lines = NULL;
    bare.notes.marks = NULL;
    bare.notes.sink = NULL;
    bare.mapped = NULL;
    bare.mapped_size = 0;
    return bare;
}

/* Into an atlas of zeros when attaching, which has at every moment what conus_atlas_destroy() may end. */
static void pass_atlas(struct walk *walk, conus_atlas *atlas)
{
    conus_atlas plain = bare_atlas(atlas);
    pass(walk, &plain, sizeof plain);
    const conus_atlas counts = plain;
    if (walk->mode == ATTACH && !walk->status) {
        *atlas = bare_atlas(&plain);
        atlas->volume_count = atlas->mesh_count = atlas->object_count = atlas->files.count = atlas->notes.count =
            atlas->warp_count = 0;
    }
    pass_text(walk, &atlas->path);
    pass_text(walk, &atlas->label_source);
    pass_text(walk, &atlas->transfer);
    if (!walk->status) {
        pass_warps(walk, atlas, &counts);
        pass_shapes(walk, atlas, &counts);
        pass_objects(walk, atlas, &counts);
        pass_lists(walk, atlas, &counts);
    }
}

/* ---- Blocks ------------------------------------------------------------------------------------------------------ */

static size_t round_up(size_t size)
{
    return (size + LINE - 1) / LINE * LINE;
}

/* The walk over an atlas that is only read: the walk writes to copies of its parts, and to them only what is there. */
static struct walk walk_over(const conus_atlas *atlas, struct walk walk)
{
    conus_atlas copy = *atlas;
    walk.small = sizeof(struct head);
    walk.small_end = walk.large;
    pass_atlas(&walk, &copy);
    return walk;
}

/* How large everything is. */
static struct walk measure(const conus_atlas *atlas)
{
    return walk_over(atlas, (struct walk){.mode = MEASURE});
}

size_t conus_atlas_packed_size(const conus_atlas *atlas)
{
    struct walk walk = measure(atlas);
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
    struct walk measured = measure(atlas);
    size_t needed = round_up(measured.small) + measured.large;
    if (!memory || (uintptr_t)memory % LINE || size < needed) {
        return fail(CONUS_ERROR_ARGUMENT, "%zu bytes at %p for an atlas: %zu at a multiple of %d are needed", size,
                    memory, needed, LINE);
    }
    struct walk walk = walk_over(
        atlas, (struct walk){.mode = PACK, .memory = memory, .large = round_up(measured.small), .size = needed});
    write_head(memory, walk.small, needed);
    return walk.status;
}

conus_status atlas_pack_write(int descriptor, size_t at, const conus_atlas *atlas)
{
    struct walk measured = measure(atlas);
    size_t small = round_up(measured.small);
    uint8_t *memory = memory_zeroed(small, 1);
    if (!memory) {
        return CONUS_ERROR_MEMORY;
    }
    struct walk walk = walk_over(atlas, (struct walk){.mode = WRITE,
                                                      .memory = memory,
                                                      .file = descriptor,
                                                      .file_at = at,
                                                      .large = small,
                                                      .size = small + measured.large});
    write_head(memory, walk.small, walk.size);
    write_at(&walk, 0, memory, small);
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
    if (!memory || (uintptr_t)memory % LINE) {
        return fail(CONUS_ERROR_ARGUMENT, "memory %p of an atlas: a multiple of %d is needed", memory, LINE);
    }
    memcpy(&head, memory, size < sizeof head ? 0 : sizeof head);
    if (size < sizeof head || !is_whole(&head, memory, size)) {
        return fail_damaged();
    }
    conus_atlas *atlas = memory_zeroed(1, sizeof *atlas);
    struct walk walk = {.mode = ATTACH,
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
