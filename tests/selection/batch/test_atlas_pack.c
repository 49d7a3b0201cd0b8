/* SPDX-License-Identifier: BSD-3-Clause */
/* An atlas in one block of memory answers as the original. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "mesh_scene.h"
#include "packed_block.h"
#include "scene.h"
#include "selection/engine/engine.h"
#include "selection/engine/voxels/distance_map.h"
#include "test.h"
#include "value_maps.h"

#include "conus/own.h"

#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <zlib.h>

/* Packs into pages that cannot be written to. */
static struct block pack(const conus_atlas *atlas)
{
    struct block block = block_pack(atlas);
    mprotect(block.memory, block.size, PROT_READ);
    return block;
}

static bool lies_in(const void *array, const struct block *block)
{
    const uint8_t *p = array;
    return p >= block->memory && p < block->memory + block->size;
}

static void assert_same_bounds(const conus_atlas *a, const conus_atlas *b)
{
    double low[2][3];
    double high[2][3];
    assert_ok(conus_atlas_bounds(low[0], high[0], a));
    assert_ok(conus_atlas_bounds(low[1], high[1], b));
    for (int i = 0; i < 3; i++) {
        assert_true(low[0][i] == low[1][i] && high[0][i] == high[1][i]);
    }
}

/* A parcellation, pathways and surfaces, notes and files. */
static conus_atlas *mixed_atlas(uint64_t *random, int pathways)
{
    conus_atlas *atlas = scene_atlas(random, 24, 0);
    mesh_scene_add_soups(atlas, random);
    conus_atlas *others = scene_atlas(random, 20, pathways);
    for (size_t i = 0; i < others->volume_count; i++) {
        const struct volume *volume = &others->volumes[i];
        if (volume_has_values(volume)) {
            float *values = values_copy(volume);
            assert_ok(pathway_of_values(atlas, &volume->info, values, "tract \xc3\xa9"));
        }
    }
    conus_atlas_destroy(others);
    assert_ok(notes_add(&atlas->notes, "a note"));
    atlas->exchanged = 1;
    assert_ok(atlas_add_file(atlas, "mesh.gii", &(const struct bytes){(uint8_t *)"abc", 3}));
    return atlas;
}

static void assert_same_volume(const struct volume *a, const struct volume *b)
{
    assert_int_equal(a->voxel_count, b->voxel_count);
    assert_string_equal(a->path, b->path);
    assert_ptr_equal(b->info.path, b->path);
    conus_volume_info info = a->info;
    info.path = b->info.path;
    assert_memory_equal(&info, &b->info, sizeof info);
    assert_memory_equal(a->voxel_from_world, b->voxel_from_world, sizeof a->voxel_from_world);
    for (size_t v = 0; v < a->voxel_count && volume_can_be_hit(a); v++) {
        assert_int_equal(volume_object(a, v), volume_object(b, v));
    }
    assert_int_equal(!a->values, !b->values);
    for (size_t v = 0; v < a->voxel_count && a->values; v++) {
        assert_true(a->values[v] == b->values[v]);
    }
}

static void assert_same_objects(const conus_atlas *a, const conus_atlas *b)
{
    assert_int_equal(a->object_count, b->object_count);
    assert_int_equal(a->area_count, b->area_count);
    for (size_t i = 0; i < a->object_count; i++) {
        const conus_object *x = &a->objects[i];
        const conus_object *y = &b->objects[i];
        assert_string_equal(x->name, y->name);
        assert_string_equal(x->abbreviation, y->abbreviation);
        assert_int_equal(x->kind, y->kind);
        assert_int_equal(x->label, y->label);
        assert_int_equal(x->parent, y->parent);
        assert_int_equal(x->voxels, y->voxels);
        assert_int_equal(x->triangles, y->triangles);
        assert_memory_equal(x->rgb, y->rgb, sizeof x->rgb);
        assert_true(x->volume_mm3 == y->volume_mm3 && x->named == y->named && x->hemisphere == y->hemisphere);
        assert_int_equal(a->places[i].is_mesh, b->places[i].is_mesh);
        assert_int_equal(a->places[i].index, b->places[i].index);
    }
}

static void assert_same(const conus_atlas *a, const conus_atlas *b)
{
    assert_same_objects(a, b);
    assert_int_equal(a->volume_count, b->volume_count);
    for (size_t i = 0; i < a->volume_count; i++) {
        assert_same_volume(&a->volumes[i], &b->volumes[i]);
    }
    assert_int_equal(a->mesh_count, b->mesh_count);
    for (size_t i = 0; i < a->mesh_count; i++) {
        const struct mesh *x = &a->meshes[i];
        const struct mesh *y = &b->meshes[i];
        assert_int_equal(x->vertex_count, y->vertex_count);
        assert_int_equal(x->triangle_count, y->triangle_count);
        assert_memory_equal(x->positions, y->positions, 3 * x->vertex_count * sizeof *x->positions);
        assert_memory_equal(x->triangles, y->triangles, 3 * x->triangle_count * sizeof *x->triangles);
        assert_memory_equal(&x->shape, &y->shape, sizeof x->shape);
    }
    assert_string_equal(a->label_source, b->label_source);
    assert_int_equal(a->files.count, b->files.count);
    for (size_t i = 0; i < a->files.count; i++) {
        assert_string_equal(a->files.items[i].path, b->files.items[i].path);
        assert_string_equal(a->files.items[i].sha256, b->files.items[i].sha256);
    }
    assert_int_equal(a->notes.count, b->notes.count);
    for (size_t i = 0; i < a->notes.count; i++) {
        assert_string_equal(a->notes.lines[i], b->notes.lines[i]);
    }
    assert_int_equal(a->exchanged, b->exchanged);
}

static void what_is_attached_is_what_was_packed(void **state)
{
    (void)state;
    uint64_t random = 1;
    for (int round = 0; round < 20; round++) {
        conus_atlas *attached = NULL;
        conus_atlas *atlas = mixed_atlas(&random, round % 4);
        struct block block = pack(atlas);
        assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
        assert_same(atlas, attached);
        for (size_t i = 0; i < attached->volume_count; i++) {
            const struct volume *volume = &attached->volumes[i];
            const struct value_map *map = &volume->map;
            assert_true(lies_in(volume->step_count ? (const void *)map->codes : volume->objects16, &block));
            assert_true(lies_in(volume->distances, &block));
            assert_true(!map->count || (lies_in(map->pages, &block) && lies_in(map->runs, &block)));
            assert_true(!map->table || lies_in(map->table, &block));
        }
        for (size_t i = 0; i < attached->mesh_count; i++) {
            assert_true(lies_in(attached->meshes[i].positions, &block));
            assert_true(lies_in(attached->meshes[i].triangles, &block));
        }
        conus_atlas_destroy(atlas);
        conus_atlas_destroy(attached);
        block_drop(block);
    }
}

/* The engines of both atlases give the same answers, to the bit. */
static void assert_same_answers(const conus_atlas *a, const conus_atlas *b, uint64_t *random)
{
    struct engine *engines[2];
    const struct engine_options options = {0};
    assert_ok(engine_rays_create(&engines[0], a, &options));
    assert_ok(engine_rays_create(&engines[1], b, &options));
    for (int query = 0; query < 20; query++) {
        struct cone cone = scene_cone(random, a);
        size_t pixels = (size_t)cone.resolution * cone.resolution;
        struct evidence seen[2];
        for (int i = 0; i < 2; i++) {
            assert_ok(evidence_init(&seen[i], cone.resolution));
            assert_ok(engines[i]->functions->trace(engines[i], &seen[i], &cone));
        }
        assert_memory_equal(seen[0].object, seen[1].object, pixels * sizeof *seen[0].object);
        assert_memory_equal(seen[0].distance, seen[1].distance, pixels * sizeof *seen[0].distance);
        assert_memory_equal(seen[0].voxel, seen[1].voxel, pixels * sizeof *seen[0].voxel);
        evidence_finish(&seen[0]);
        evidence_finish(&seen[1]);
    }
    engines[0]->functions->destroy(engines[0]);
    engines[1]->functions->destroy(engines[1]);
}

static void an_attached_atlas_answers_as_the_packed_one(void **state)
{
    (void)state;
    uint64_t random = 2;
    for (int round = 0; round < 20; round++) {
        conus_atlas *attached = NULL;
        conus_atlas *atlas = mixed_atlas(&random, round % 3);
        struct block block = pack(atlas);
        assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
        assert_same_answers(atlas, attached, &random);
        conus_atlas_destroy(atlas);
        conus_atlas_destroy(attached);
        block_drop(block);
    }
}

static void packing_it_again_gives_the_same(void **state)
{
    (void)state;
    uint64_t random = 3;
    conus_atlas *attached = NULL;
    conus_atlas *atlas = mixed_atlas(&random, 2);
    struct block block = pack(atlas);
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    conus_atlas_destroy(atlas);
    struct block again = pack(attached);
    conus_atlas_destroy(attached);
    assert_int_equal(again.size, block.size);
    attached = NULL;
    assert_ok(conus_atlas_attach(&attached, again.memory, again.size));
    conus_atlas *first = NULL;
    assert_ok(conus_atlas_attach(&first, block.memory, block.size));
    assert_same(first, attached);
    assert_same_answers(first, attached, &random);
    conus_atlas_destroy(first);
    conus_atlas_destroy(attached);
    block_drop(block);
    block_drop(again);
}

/* The atlas is changed before or after packing; the block stays as it is (writing to it would be a segmentation
 * fault). */
static void changes_are_made_to_copies(void **state)
{
    (void)state;
    uint64_t random = 4;
    for (int round = 0; round < 20; round++) {
        conus_atlas *attached = NULL;
        conus_atlas *atlas = scene_atlas(&random, 24, 2);
        struct block block = pack(atlas);
        assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
        size_t pathway = atlas->object_count;
        assert_ok(conus_atlas_set_threshold(atlas, pathway, 0.25));
        assert_ok(conus_atlas_set_threshold(attached, pathway, 0.25));
        assert_null(attached->volumes[attached->places[pathway - 1].index].distances);
        conus_status status = conus_atlas_set_hemispheres(atlas, CONUS_HEMISPHERES_SPLIT);
        assert_fails(conus_atlas_set_hemispheres(attached, CONUS_HEMISPHERES_SPLIT), status);
        assert_same(atlas, attached);
        assert_same_answers(atlas, attached, &random);
        conus_atlas_destroy(atlas);
        conus_atlas_destroy(attached);
        block_drop(block);
    }
}

/* Which of a pathway's bands are hidden is written into its volume, which is a copy by then: the block is read-only. */
static void a_band_is_hidden_in_a_copy(void **state)
{
    (void)state;
    static const float row[] = {1, 2, 3, 4};
    static const conus_band bands[] = {{1, 3, "Low"}, {3, INFINITY, "High"}};
    static const bool hidden[] = {false, true, false};
    conus_voxels voxels = {.data = row, .type = CONUS_SCALAR_FLOAT32, .dim = {4, 1, 1}};
    mat4_identity(voxels.world_from_voxel);
    conus_atlas *atlas = NULL;
    conus_atlas *attached = NULL;
    assert_ok(conus_atlas_create(&atlas, NULL, NULL, 0, NULL));
    assert_ok(
        conus_atlas_add_pathway_voxels(atlas, &voxels, &(conus_pathway_options){.bands = bands, .band_count = 2}));
    struct block block = pack(atlas);
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    assert_ok(conus_atlas_set_hidden(attached, hidden));
    for (size_t v = 0; v < 4; v++) {
        assert_int_equal(volume_object(&attached->volumes[0], v), v < 2 ? 0 : 2);
    }
    conus_atlas_destroy(attached);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

/* The packed atlas knows its box; moving it, or hiding a part, makes another box. */
static void the_box_is_that_of_the_voxels(void **state)
{
    (void)state;
    uint64_t random = 11;
    static const double turned[16] = {0.6, 0.8, 0, 0, -0.8, 0.6, 0, 0, 0, 0, 1, 0, 7, -3, 2, 1};
    conus_atlas *atlas = scene_atlas(&random, 24, 1);
    struct block block = pack(atlas);
    conus_atlas *attached = NULL;
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    assert_same_bounds(atlas, attached);
    assert_ok(conus_atlas_move(atlas, turned));
    assert_ok(conus_atlas_move(attached, turned));
    assert_same_bounds(atlas, attached);
    bool *hidden = memory_zeroed(conus_atlas_object_count(atlas) + 1, sizeof *hidden);
    for (size_t number = 2; number <= conus_atlas_object_count(atlas); number++) {
        hidden[number] = true;
    }
    assert_ok(conus_atlas_set_hidden(atlas, hidden));
    assert_ok(conus_atlas_set_hidden(attached, hidden));
    assert_same_bounds(atlas, attached);
    memory_free(hidden);
    conus_atlas_destroy(attached);
    block_drop(block);
    conus_atlas_destroy(atlas);
}

static void an_attached_atlas_can_grow(void **state)
{
    (void)state;
    uint64_t random = 5;
    conus_atlas *attached = NULL;
    conus_atlas *atlas = scene_atlas(&random, 12, 3);
    struct block block = pack(atlas);
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    for (int i = 0; i < 20; i++) {
        float *values[2] = {memory_zeroed(8, sizeof(float)), memory_zeroed(8, sizeof(float))};
        conus_volume_info info = scene_grid(&random, (const size_t[]){2, 2, 2});
        info.role = CONUS_ROLE_SCALAR;
        info.threshold = 0.5;
        values[0][i % 8] = values[1][i % 8] = 1;
        assert_ok(pathway_of_values(atlas, &info, values[0], "more"));
        assert_ok(pathway_of_values(attached, &info, values[1], "more"));
    }
    assert_ok(notes_add(&atlas->notes, "more"));
    assert_ok(notes_add(&attached->notes, "more"));
    assert_same(atlas, attached);
    conus_atlas_destroy(atlas);
    conus_atlas_destroy(attached);
    block_drop(block);
}

static void surfaces_around_the_areas_are_packed(void **state)
{
    (void)state;
    uint64_t random = 12;
    conus_atlas *attached = NULL;
    conus_atlas *atlas = mixed_atlas(&random, 0);
    const struct mesh *shape = &atlas->meshes[0];
    struct context_surface surface = {.opacity = 0.5, .hemisphere = 'R', .low = 1, .high = 2};
    assert_ok(mesh_init(&surface.mesh, shape->vertex_count, shape->triangle_count));
    memcpy(surface.mesh.positions, shape->positions, 3 * shape->vertex_count * sizeof *shape->positions);
    memcpy(surface.mesh.triangles, shape->triangles, 3 * shape->triangle_count * sizeof *shape->triangles);
    surface.mesh.path = memory_text("s.gii", 5);
    surface.map_name = memory_text("map", 3);
    surface.values = memory_zeroed(shape->vertex_count, sizeof *surface.values);
    surface.values[1] = 3;
    assert_ok(atlas_add_context_surface(atlas, &surface));
    struct block block = pack(atlas);
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    assert_int_equal(conus_atlas_context_surface_count(attached), 1);
    const struct context_surface *a = &atlas->context_surfaces[0];
    const struct context_surface *b = &attached->context_surfaces[0];
    assert_true(a->opacity == b->opacity && a->low == b->low && a->high == b->high && a->hemisphere == b->hemisphere);
    assert_string_equal(a->map_name, b->map_name);
    assert_string_equal(a->mesh.path, b->mesh.path);
    assert_memory_equal(a->values, b->values, shape->vertex_count * sizeof *a->values);
    assert_memory_equal(a->mesh.positions, b->mesh.positions, 3 * shape->vertex_count * sizeof *shape->positions);
    assert_memory_equal(a->mesh.triangles, b->mesh.triangles, 3 * shape->triangle_count * sizeof *shape->triangles);
    assert_memory_equal(&a->mesh.shape, &b->mesh.shape, sizeof a->mesh.shape);
    assert_same(atlas, attached);
    conus_atlas_destroy(attached);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

static void what_is_no_packed_atlas_is_refused(void **state)
{
    (void)state;
    uint64_t random = 6;
    conus_atlas *attached = NULL;
    conus_atlas *atlas = mixed_atlas(&random, 1);
    struct block block = pack(atlas);
    mprotect(block.memory, block.size, PROT_READ | PROT_WRITE);
    for (size_t size = 0; size < block.size; size += size < 8192 ? 1 : 997) {
        assert_fails(conus_atlas_attach(&attached, block.memory, size), CONUS_ERROR_DATA);
    }
    size_t small = 0; /* the small parts end where a change is no longer seen */
    for (conus_status status = CONUS_ERROR_DATA; status && small < block.size; small++) {
        block.memory[small] ^= 0x40;
        status = conus_atlas_attach(&attached, block.memory, block.size);
        block.memory[small] ^= 0x40;
    }
    assert_in_range(small, 1000, block.size);
    conus_atlas_destroy(attached);
    attached = NULL;
    assert_fails(conus_atlas_attach(&attached, block.memory + 8, block.size - 8), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_attach(&attached, NULL, 0), CONUS_ERROR_ARGUMENT);
    assert_null(attached);
    assert_fails(conus_atlas_pack(block.memory, block.size - 1, atlas), CONUS_ERROR_ARGUMENT);
    assert_fails(conus_atlas_pack(block.memory + 8, block.size + 64, atlas), CONUS_ERROR_ARGUMENT);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

/* Every byte of the head gets every other value; and each eight bytes get numbers near the largest, which overflow
 * where they are rounded up. With a right checksum, an end of the small things that comes too early is seen, too. */
static void a_damaged_head_is_refused(void **state)
{
    (void)state;
    enum { CRC = 24, LAYOUT = 32, SMALL_END = 40, HEAD = 56 };
    uint64_t random = 8;
    conus_atlas *attached = NULL;
    conus_atlas *atlas = mixed_atlas(&random, 1);
    struct block block = pack(atlas);
    mprotect(block.memory, block.size, PROT_READ | PROT_WRITE);
    for (size_t i = 0; i < HEAD; i++) {
        uint8_t right = block.memory[i];
        for (int wrong = 1; wrong < 256; wrong++) {
            block.memory[i] = (uint8_t)(right ^ wrong);
            assert_fails(conus_atlas_attach(&attached, block.memory, block.size), CONUS_ERROR_DATA);
        }
        block.memory[i] = right;
    }
    for (size_t i = 0; i < HEAD; i += sizeof(uint64_t)) {
        uint64_t right;
        memcpy(&right, block.memory + i, sizeof right);
        for (uint64_t less = 0; less <= 128; less++) {
            memcpy(block.memory + i, &(uint64_t){UINT64_MAX - less}, sizeof right);
            assert_fails(conus_atlas_attach(&attached, block.memory, block.size), CONUS_ERROR_DATA);
        }
        memcpy(block.memory + i, &right, sizeof right);
    }
    uint64_t end;
    memcpy(&end, block.memory + SMALL_END, sizeof end);
    for (uint64_t early = end + 1; early-- > HEAD;) {
        memcpy(block.memory + SMALL_END, &early, sizeof early);
        uint64_t crc = crc32_z(0, block.memory + LAYOUT, early - LAYOUT);
        memcpy(block.memory + CRC, &crc, sizeof crc);
        if (early < end) {
            assert_fails(conus_atlas_attach(&attached, block.memory, block.size), CONUS_ERROR_DATA);
        }
    }
    memcpy(block.memory + SMALL_END, &end, sizeof end);
    uint64_t crc = crc32_z(0, block.memory + LAYOUT, end - LAYOUT);
    memcpy(block.memory + CRC, &crc, sizeof crc);
    assert_null(attached);
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    conus_atlas_destroy(attached);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

struct attempt {
    conus_atlas *atlas;
    struct block block;
};

static conus_status try_packing(void *data)
{
    struct attempt *attempt = data;
    return conus_atlas_pack(attempt->block.memory, attempt->block.size, attempt->atlas);
}

static conus_status try_attaching(void *data)
{
    struct attempt *attempt = data;
    conus_atlas *attached = NULL;
    conus_status status = conus_atlas_attach(&attached, attempt->block.memory, attempt->block.size);
    status = status ? status : conus_atlas_set_threshold(attached, attached->object_count, 0.5);
    conus_atlas_destroy(attached);
    return status;
}

/* Numbers of pages and runs are used as indices, so they are checked when an atlas is attached. */
static void a_damaged_map_is_refused(void **state)
{
    (void)state;
    uint64_t random = 46;
    conus_atlas *atlas = scene_atlas(&random, 12, 2);
    conus_atlas *attached = NULL;
    struct block block = pack(atlas);
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    const struct value_map map = attached->volumes[attached->volume_count - 1].map;
    uint32_t *const numbers[] = {map.pages, map.runs};
    assert_true(map.count > 0);
    conus_atlas_destroy(attached);
    mprotect(block.memory, block.size, PROT_READ | PROT_WRITE);
    for (size_t i = 0; i < 2; i++) {
        *numbers[i] += 1000000;
        assert_fails(conus_atlas_attach(&attached, block.memory, block.size), CONUS_ERROR_DATA);
        *numbers[i] -= 1000000;
    }
    assert_ok(conus_atlas_attach(&attached, block.memory, block.size));
    conus_atlas_destroy(attached);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

static void both_survive_every_failing_allocation(void **state)
{
    (void)state;
    uint64_t random = 7;
    struct attempt attempt = {.atlas = mixed_atlas(&random, 2)};
    attempt.block = pack(attempt.atlas);
    test_every_allocation(try_attaching, &attempt);
    mprotect(attempt.block.memory, attempt.block.size, PROT_READ | PROT_WRITE);
    test_every_allocation(try_packing, &attempt);
    conus_atlas_destroy(attempt.atlas);
    block_drop(attempt.block);
}

TEST_GROUP(atlas_pack)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_attached_is_what_was_packed),
        cmocka_unit_test(an_attached_atlas_answers_as_the_packed_one),
        cmocka_unit_test(packing_it_again_gives_the_same),
        cmocka_unit_test(changes_are_made_to_copies),
        cmocka_unit_test(a_band_is_hidden_in_a_copy),
        cmocka_unit_test(the_box_is_that_of_the_voxels),
        cmocka_unit_test(an_attached_atlas_can_grow),
        cmocka_unit_test(surfaces_around_the_areas_are_packed),
        cmocka_unit_test(what_is_no_packed_atlas_is_refused),
        cmocka_unit_test(a_damaged_head_is_refused),
        cmocka_unit_test(a_damaged_map_is_refused),
        cmocka_unit_test(both_survive_every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
