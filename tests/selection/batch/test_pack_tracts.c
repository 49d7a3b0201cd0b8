/* SPDX-License-Identifier: BSD-3-Clause */
/* Tractograms in a packed atlas: they are unchanged and not copied, and no damage leads outside of the block. */
#include "atlas/atlas.h"
#include "atlas/tracts/tract_node.h"
#include "base/memory.h"
#include "conus/own.h"
#include "pack/pack.h"
#include "packed_block.h"
#include "test.h"
#include "tract_scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <zlib.h>

enum { STREAMLINES = 7, POINTS = 40, LINE = 64 };

/* Streamlines of 0, 1, 2, 4, 7, 10 and 16 points. */
static const uint64_t first[STREAMLINES + 1] = {0, 0, 1, 3, 7, 14, 24, 40};

static char *copy_text(const char *text)
{
    return memory_text(text, strlen(text));
}

static void add_scalar(struct tractogram *to, const char *name, bool per_point, uint32_t components)
{
    size_t count = (per_point ? POINTS : STREAMLINES) * (size_t)components;
    struct tract_scalar scalar = {.name = copy_text(name), .per_point = per_point, .components = components};
    scalar.values = memory_zeroed(count, sizeof *scalar.values);
    for (size_t i = 0; i < count; i++) {
        scalar.values[i] = (float)i / 4;
    }
    to->scalars = memory_resize(to->scalars, to->scalar_count + 1, sizeof *to->scalars);
    to->scalars[to->scalar_count++] = scalar;
}

static struct tractogram make_tractogram(bool halves)
{
    struct tractogram made = {.path = copy_text(halves ? "halves.trx" : "floats.trk"),
                              .format = "test",
                              .sha256 = "abc",
                              .first = memory_copy(first, STREAMLINES + 1, sizeof *first),
                              .point_count = POINTS,
                              .streamline_count = STREAMLINES,
                              .radius = 0.75};
    if (halves) {
        made.halves = memory_zeroed(POINTS, 3 * sizeof *made.halves);
    } else {
        made.points = memory_zeroed(POINTS, 3 * sizeof *made.points);
    }
    for (int i = 0; i < 3 * POINTS; i++) {
        if (halves) {
            made.halves[i] = (uint16_t)(0x3c00 + 8 * i); /* from 1 on */
        } else {
            made.points[i] = (float)(i % 17) - 3;
        }
    }
    return made;
}

/* An atlas with one bundle of all streamlines, and one with two groups, a rest, and scalars. */
static conus_atlas *make_atlas(void)
{
    static const uint32_t few[] = {1, 4, 6};
    static const uint32_t one[] = {3};
    conus_atlas *atlas = NULL;
    struct tractogram floats = make_tractogram(false);
    struct tractogram halves = make_tractogram(true);
    add_scalar(&halves, "FA", true, 1);
    add_scalar(&halves, "colour", true, 3);
    add_scalar(&halves, "weight", false, 1);
    tract_add_group(&halves, "few", few, 3);
    tract_add_group(&halves, "one", one, 1);
    assert_ok(atlas_create_empty(&atlas, "none"));
    assert_ok(atlas_add_tractogram(atlas, &floats, "all"));
    assert_ok(atlas_add_tractogram(atlas, &halves, "rest"));
    assert_int_equal(atlas->object_count, 4);
    return atlas;
}

/* Asserts that an array is equal and in the block; NULL where it is absent. */
static void assert_lent(const void *packed, const void *attached, size_t size, const struct block *block)
{
    const uint8_t *at = attached;
    assert_int_equal(!packed, !attached);
    if (packed) {
        assert_true(at >= block->memory && at + size <= block->memory + block->size);
        assert_memory_equal(packed, attached, size);
    }
}

static void assert_same_names(const struct tractogram *a, const struct tractogram *b, const struct block *block)
{
    assert_int_equal(a->scalar_count, b->scalar_count);
    for (size_t i = 0; i < a->scalar_count; i++) {
        const struct tract_scalar *x = &a->scalars[i];
        const struct tract_scalar *y = &b->scalars[i];
        assert_string_equal(x->name, y->name);
        assert_int_equal(x->per_point, y->per_point);
        assert_int_equal(x->components, y->components);
        size_t count = (x->per_point ? POINTS : STREAMLINES) * (size_t)x->components;
        assert_lent(x->values, y->values, count * sizeof *x->values, block);
    }
    assert_int_equal(a->group_count, b->group_count);
    for (size_t i = 0; i < a->group_count; i++) {
        assert_string_equal(a->groups[i].name, b->groups[i].name);
        assert_int_equal(a->groups[i].count, b->groups[i].count);
        assert_lent(a->groups[i].members, b->groups[i].members, a->groups[i].count * sizeof(uint32_t), block);
    }
}

static void assert_same(const conus_atlas *packed, const conus_atlas *attached, const struct block *block)
{
    assert_int_equal(packed->tractogram_count, attached->tractogram_count);
    for (size_t i = 0; i < packed->tractogram_count; i++) {
        const struct tractogram *a = &packed->tractograms[i];
        const struct tractogram *b = &attached->tractograms[i];
        assert_string_equal(a->path, b->path);
        assert_string_equal(a->format, b->format);
        assert_string_equal(a->sha256, b->sha256);
        assert_lent(a->points, b->points, POINTS * 3 * sizeof *a->points, block);
        assert_lent(a->halves, b->halves, POINTS * 3 * sizeof *a->halves, block);
        assert_lent(a->first, b->first, sizeof first, block);
        assert_int_equal(a->tree.run_count, b->tree.run_count);
        assert_lent(a->tree.leaves, b->tree.leaves, tract_leaf_count(a->tree.run_count) * sizeof *a->tree.leaves,
                    block);
        assert_lent(a->tree.marks, b->tree.marks, tract_mark_count(POINTS) * sizeof *a->tree.marks, block);
        assert_int_equal(a->tree.node_count, b->tree.node_count);
        assert_true(b->tree.nodes && b->radius == 0.75);
        assert_memory_equal(a->low, b->low, sizeof a->low);
        assert_memory_equal(a->high, b->high, sizeof a->high);
        assert_same_names(a, b, block);
    }
    for (size_t i = 0; i < packed->object_count; i++) {
        assert_string_equal(packed->objects[i].name, attached->objects[i].name);
        assert_int_equal(packed->objects[i].streamlines, attached->objects[i].streamlines);
        assert_true(packed->objects[i].length_mm == attached->objects[i].length_mm);
        assert_int_equal(packed->places[i].group, attached->places[i].group);
    }
}

static void what_is_attached_is_what_was_packed(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    struct block block = block_pack(atlas);
    conus_atlas *attached = block_attach(&block);
    assert_same(atlas, attached, &block);
    struct block again = block_pack(attached);
    assert_int_equal(block.size, again.size);
    conus_atlas *second = block_attach(&again);
    assert_same(atlas, second, &again);
    conus_atlas_destroy(second);
    conus_atlas_destroy(attached);
    conus_atlas_destroy(atlas);
    block_drop(again);
    block_drop(block);
}

static conus_status take_part(void *user, const void *data, size_t size)
{
    buffer_append(user, data, size);
    return buffer_status(user);
}

static void what_is_given_part_by_part_has_the_same_bytes(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    struct block block = block_pack(atlas);
    struct buffer given = {0};
    assert_ok(atlas_pack_give(atlas, take_part, &given));
    assert_int_equal(given.size, block.size);
    assert_memory_equal(given.data, block.memory, block.size);
    buffer_finish(&given);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

/* The block stays as it is: writing to it would be a segmentation fault. */
static void moving_it_changes_copies(void **state)
{
    (void)state;
    static const double aside[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -8, 0, 1};
    conus_atlas *atlas = make_atlas();
    struct block block = block_pack(atlas);
    mprotect(block.memory, block.size, PROT_READ);
    conus_atlas *attached = block_attach(&block);
    assert_ok(conus_atlas_move(attached, aside));
    for (size_t i = 0; i < 2; i++) {
        double points[2][3];
        tractogram_point(points[0], &atlas->tractograms[i], 5);
        tractogram_point(points[1], &attached->tractograms[i], 5);
        assert_true(points[1][0] == points[0][0] && points[1][1] == points[0][1] + 8 && points[1][2] == points[0][2]);
    }
    conus_atlas_destroy(attached);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

static void assert_refused(struct block *block)
{
    conus_atlas *attached = NULL;
    assert_fails(conus_atlas_attach(&attached, block->memory, block->size), CONUS_ERROR_DATA);
    assert_null(attached);
}

/* Arrays have no checksum, so every number in them that is used as an index is checked. Each is made too large here. */
static void damaged_arrays_are_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    struct block block = block_pack(atlas);
    conus_atlas *attached = block_attach(&block);
    struct tractogram *one = &attached->tractograms[1];
    size_t runs = one->tree.run_count;
    for (size_t i = 0; i <= STREAMLINES; i++) {
        uint64_t right = one->first[i];
        one->first[i] = i ? POINTS + 1 : 1;
        assert_refused(&block);
        one->first[i] = right;
    }
    struct tract_leaf *leaf = one->tree.leaves;
    size_t last = 0;
    for (size_t i = 0; i < runs; i++) {
        const uint32_t point = leaf->point[i];
        const uint64_t end = first[tractogram_streamline_of(one, point) + 1];
        leaf->point[i] = POINTS;
        assert_refused(&block);
        leaf->point[i] = point;
        if (point + tract_leaf_segments(leaf, i) + 1 == end) { /* one segment more is one too many */
            leaf->bend[i]++;
            assert_refused(&block);
            leaf->bend[i]--;
            last++;
        }
    }
    assert_int_equal(last, STREAMLINES - 1); /* the first one has no point */
    leaf->count++;
    assert_refused(&block);
    leaf->count--;
    one->tree.marks[0]++;
    assert_refused(&block);
    one->tree.marks[0] = STREAMLINES;
    assert_refused(&block);
    one->tree.marks[0] = 1; /* again: the first streamline has no point */
    one->groups[0].members[2] = STREAMLINES;
    assert_refused(&block);
    one->groups[0].members[2] = 4; /* again */
    assert_refused(&block);
    one->groups[0].members[2] = 6;
    conus_atlas_destroy(attached);
    conus_atlas_destroy(block_attach(&block));
    conus_atlas_destroy(atlas);
    block_drop(block);
}

/* The group was missing when the atlas was packed, so the checksum fits. */
static void a_group_that_is_not_there_is_refused(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    struct object_place *few = &atlas->places[1];
    assert_string_equal(atlas->objects[1].name, "few");
    few->group = atlas->tractograms[few->index].group_count;
    struct block block = block_pack(atlas);
    assert_refused(&block);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

static void fit_checksum(struct block *block)
{
    enum { CRC_AT = 24, LAYOUT_AT = 32, SMALL_END_AT = 40 };
    uint64_t small_end;
    memcpy(&small_end, block->memory + SMALL_END_AT, sizeof small_end);
    uint64_t crc = crc32_z(0, block->memory + LAYOUT_AT, small_end - LAYOUT_AT);
    memcpy(block->memory + CRC_AT, &crc, sizeof crc);
}

/* Each byte of the small parts becomes 0xff, with a valid checksum: the atlas is refused, or can be used. */
static void damage_with_a_fitting_checksum_does_no_harm(void **state)
{
    (void)state;
    enum { HEAD = 56, SMALL_END_AT = 40 };
    conus_atlas *atlas = make_atlas();
    struct block block = block_pack(atlas);
    uint64_t small_end;
    size_t refused = 0;
    memcpy(&small_end, block.memory + SMALL_END_AT, sizeof small_end);
    for (size_t i = HEAD; i < small_end; i++) {
        conus_atlas *attached = NULL;
        uint8_t right = block.memory[i];
        block.memory[i] = 0xff;
        fit_checksum(&block);
        if (conus_atlas_attach(&attached, block.memory, block.size)) {
            refused++;
        } else {
            assert_true(conus_atlas_packed_size(attached) > HEAD);
        }
        conus_atlas_destroy(attached);
        block.memory[i] = right;
    }
    assert_in_range(refused, 50, small_end - HEAD);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

static conus_status try_attaching(void *data)
{
    const struct block *block = data;
    conus_atlas *attached = NULL;
    conus_status status = conus_atlas_attach(&attached, block->memory, block->size);
    conus_atlas_destroy(attached);
    return status;
}

static void attaching_survives_every_failing_allocation(void **state)
{
    (void)state;
    conus_atlas *atlas = make_atlas();
    struct block block = block_pack(atlas);
    test_every_allocation(try_attaching, &block);
    conus_atlas_destroy(atlas);
    block_drop(block);
}

TEST_GROUP(pack_tracts)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_attached_is_what_was_packed),
        cmocka_unit_test(what_is_given_part_by_part_has_the_same_bytes),
        cmocka_unit_test(moving_it_changes_copies),
        cmocka_unit_test(damaged_arrays_are_refused),
        cmocka_unit_test(a_group_that_is_not_there_is_refused),
        cmocka_unit_test(damage_with_a_fitting_checksum_does_no_harm),
        cmocka_unit_test(attaching_survives_every_failing_allocation),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
