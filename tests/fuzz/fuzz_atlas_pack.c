/* SPDX-License-Identifier: BSD-3-Clause */
/* A damaged packed atlas: attaching it fails, or gives an atlas that can be measured and destroyed. The input is the
 * damage, so that it fits every version's layout: how much is cut off the end (two bytes), whether the checksum is
 * corrected (one), then places (two bytes) and their new values (one). */
#include "atlas/bundles.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "tests/support/value_maps.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { LINE = 64, CRC_AT = 24, LAYOUT_AT = 32, SMALL_END_AT = 40, HEAD = 56, PIECE = 3 };

static void must(conus_status status)
{
    if (status) {
        abort();
    }
}

static void add_tetrahedron(conus_atlas *atlas)
{
    static const float positions[] = {0, 0, 0, 9, 0, 0, 0, 9, 0, 0, 0, 9};
    static const uint32_t triangles[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    const conus_object area = {.kind = CONUS_KIND_AREA, .name = "Mesh", .abbreviation = "M", .label = 9};
    struct mesh mesh;
    must(mesh_init(&mesh, 4, 4));
    memcpy(mesh.positions, positions, sizeof positions);
    memcpy(mesh.triangles, triangles, sizeof triangles);
    must(atlas_add_mesh(atlas, &area, &mesh));
}

/* Two streamlines with a scalar, one of them a group. */
static void add_streamlines(conus_atlas *atlas)
{
    static const float points[] = {0, 0, 0, 1, 0, 0, 1, 2, 0, 5, 5, 5, 6, 6, 6};
    static const uint64_t first[] = {0, 3, 5};
    struct tractogram made = {.path = memory_text("t.trk", 5),
                              .points = memory_copy(points, 15, sizeof *points),
                              .first = memory_copy(first, 3, sizeof *first),
                              .point_count = 5,
                              .streamline_count = 2,
                              .scalars = memory_zeroed(1, sizeof *made.scalars),
                              .scalar_count = 1,
                              .groups = memory_zeroed(1, sizeof *made.groups),
                              .group_count = 1,
                              .radius = 0.5};
    must(made.scalars && made.groups ? CONUS_OK : CONUS_ERROR_MEMORY);
    made.scalars[0] = (struct tract_scalar){
        .name = memory_text("FA", 2), .per_point = true, .components = 1, .values = memory_zeroed(5, sizeof(float))};
    made.groups[0] =
        (struct tract_group){.name = memory_text("one", 3), .members = memory_zeroed(1, sizeof(uint32_t)), .count = 1};
    must(atlas_add_tractogram(atlas, &made, "rest"));
}

/* Areas in voxels and one with a surface, a pathway, streamlines, a note and a file. */
static conus_atlas *make_atlas(void)
{
    static const uint32_t labels[12] = {0, 1, 1, 2, 2, 0, 0, 3, 3, 1, 0, 0};
    conus_volume_info info = {.role = CONUS_ROLE_PARCELLATION, .path = "v.nii", .dim = {3, 2, 2}, .slope = 1};
    struct label_table table = {0};
    struct notes notes = {0};
    conus_atlas *atlas = NULL;
    double m[16];
    mat4_identity(m);
    must(space_describe(&info, m, "v.nii"));
    must(atlas_create(&atlas, &info, labels, &table, "none", &notes));
    notes_finish(&notes);
    add_tetrahedron(atlas);
    float *values = memory_zeroed(12, sizeof *values);
    info.role = CONUS_ROLE_SCALAR;
    info.threshold = 0.5;
    must(values ? pathway_of_values(atlas, &info, values, "tract") : CONUS_ERROR_MEMORY);
    add_streamlines(atlas);
    must(notes_add(&atlas->notes, "a note"));
    must(atlas_add_file(atlas, "v.nii", &(const struct bytes){(uint8_t *)"abc", 3}));
    return atlas;
}

static size_t two_bytes(const uint8_t *data)
{
    return data[0] | (size_t)data[1] << 8;
}

static void fit_checksum(uint8_t *memory, size_t size)
{
    uint64_t small_end;
    memcpy(&small_end, memory + SMALL_END_AT, sizeof small_end);
    if (size >= HEAD && small_end >= HEAD && small_end <= size) {
        uint64_t crc = crc32_z(0, memory + LAYOUT_AT, small_end - LAYOUT_AT);
        memcpy(memory + CRC_AT, &crc, sizeof crc);
    }
}

static void attach(const uint8_t *memory, size_t size)
{
    conus_atlas *atlas = NULL;
    if (!conus_atlas_attach(&atlas, memory, size)) {
        if (conus_atlas_packed_size(atlas) < HEAD) {
            abort();
        }
        conus_atlas_destroy(atlas);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size < PIECE) {
        return 0;
    }
    conus_atlas *atlas = make_atlas();
    size_t packed = conus_atlas_packed_size(atlas);
    uint8_t *memory = aligned_alloc(LINE, (packed + LINE - 1) / LINE * LINE);
    must(memory ? conus_atlas_pack(memory, packed, atlas) : CONUS_ERROR_MEMORY);
    for (const uint8_t *at = data + PIECE; at + PIECE <= data + size; at += PIECE) {
        memory[two_bytes(at) % packed] = at[2];
    }
    size_t left = packed - two_bytes(data) % packed;
    if (data[2] & 1) {
        fit_checksum(memory, left);
    }
    attach(memory, left);
    free(memory);
    conus_atlas_destroy(atlas);
    return 0;
}
