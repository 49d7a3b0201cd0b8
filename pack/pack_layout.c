/* SPDX-License-Identifier: BSD-3-Clause */
/* The members of packed structures: where each lies, what a block has of it, and which must be looked at before the
 * structure is used. */
#include "pack/pack.h"

#include "atlas/atlas.h"
#include "atlas/tracts/tract_node.h"
#include "selection/engine/voxels/distance_map.h"

#include <string.h>

/* In a block a pointer is NULL and a MEMBER_TRUE is true; a MEMBER_PART is a pointer in a member before it. */
enum member_kind { MEMBER_OTHER, MEMBER_FLAG, MEMBER_TEXT, MEMBER_POINTER, MEMBER_PART, MEMBER_TRUE };

struct member {
    size_t at, size;
    enum member_kind kind;
};

#define KIND_OF(member)                                                                                                \
    _Generic(&(member),                                                                                                \
        bool *: MEMBER_FLAG,                                                                                           \
        default: _Generic((member), char *: MEMBER_TEXT, default: MEMBER_OTHER))
#define K(type, member, kind)                                                                                          \
    {                                                                                                                  \
        offsetof(type, member), sizeof(((type *)0)->member), kind                                                      \
    }
#define M(type, member) K(type, member, KIND_OF(((type *)0)->member))
#define P(type, member) K(type, member, MEMBER_POINTER)

#define ATLAS(T)                                                                                                       \
    P(T, volumes), M(T, volume_count), P(T, meshes), M(T, mesh_count), P(T, tractograms), M(T, tractogram_count),      \
        P(T, objects), P(T, places), M(T, object_count), P(T, taken), M(T, area_count), M(T, first_pair),              \
        M(T, hemispheres), M(T, half_step), M(T, has_other_colours), M(T, has_palette), M(T, is_moved),                \
        M(T, is_mirrored), M(T, own_from_world), P(T, warps), M(T, warp_count), P(T, last_transform),                  \
        M(T, last_is_inverse), M(T, brain), M(T, identified), M(T, has_ccf), M(T, own_from_ccf), P(T, path),           \
        P(T, label_source), M(T, files), P(T, transfer), M(T, notes), M(T, exchanged), M(T, lacks_context),            \
        P(T, context_surfaces), M(T, context_surface_count), P(T, mapped), P(T, mapped_size), P(T, pack),              \
        K(T, files.items, MEMBER_PART), K(T, files.paths, MEMBER_PART), K(T, notes.lines, MEMBER_PART),                \
        K(T, notes.marks, MEMBER_PART), K(T, notes.sink, MEMBER_PART)
#define INFO(T)                                                                                                        \
    M(T, info.role), P(T, info.path), M(T, info.sha256), M(T, info.format), M(T, info.datatype), M(T, info.dim),       \
        M(T, info.volume), M(T, info.volume_count), M(T, info.world_from_voxel), M(T, info.spacing),                   \
        M(T, info.orientation), M(T, info.transform), M(T, info.space_code), M(T, info.slope), M(T, info.intercept),   \
        M(T, info.minimum), M(T, info.maximum), M(T, info.threshold), M(T, info.unit)
#define VOLUME(T)                                                                                                      \
    INFO(T), P(T, path), M(T, voxel_from_world), M(T, voxel_count), P(T, objects16), P(T, objects32), P(T, values),    \
        M(T, map.count), M(T, map.page_count), M(T, map.run_count), M(T, map.table_count), M(T, map.width),            \
        P(T, map.pages), P(T, map.runs), P(T, map.codes), P(T, map.table), P(T, steps), M(T, step_count),              \
        M(T, box.first), M(T, box.last), M(T, is_hidden), P(T, hidden_runs), M(T, hidden_run_count), M(T, is_joined),  \
        K(T, is_borrowed, MEMBER_TRUE), P(T, source), M(T, centres.m), M(T, centres.low), M(T, centres.high),          \
        P(T, distances)
#define MESH(T)                                                                                                        \
    P(T, path), P(T, positions), M(T, vertex_count), P(T, triangles), M(T, triangle_count),                            \
        K(T, is_borrowed, MEMBER_TRUE), M(T, shape.low), M(T, shape.high), M(T, shape.volume_mm3),                     \
        M(T, shape.centroid), M(T, shape.closed), M(T, shape.has_volume)
#define SURFACE(T)                                                                                                     \
    P(T, mesh), M(T, opacity), M(T, is_shell), M(T, hemisphere), P(T, values), P(T, map_name), M(T, low), M(T, high)
#define WARP(T)                                                                                                        \
    M(T, field.dim), M(T, field.world_from_voxel), M(T, field.voxel_from_world), M(T, field.base), M(T, field.linear), \
        P(T, field.vectors), P(T, field.rest), P(T, field.coefficients), M(T, field.stays_outside),                    \
        K(T, field.is_borrowed, MEMBER_TRUE), M(T, field.start), M(T, field.low), M(T, field.high), M(T, after)
#define TRACTOGRAM(T)                                                                                                  \
    P(T, path), M(T, format), M(T, states_mm), M(T, sha256), M(T, space), P(T, files), P(T, points), P(T, halves),     \
        M(T, point_count), P(T, first), M(T, streamline_count), P(T, scalars), M(T, scalar_count), P(T, groups),       \
        M(T, group_count), M(T, radius), P(T, tree.nodes), M(T, tree.node_count), P(T, tree.leaves),                   \
        M(T, tree.run_count), P(T, tree.lengths), P(T, tree.marks), M(T, low), M(T, high),                             \
        K(T, is_ready, MEMBER_TRUE), K(T, has_borrowed_points, MEMBER_TRUE), K(T, is_borrowed, MEMBER_TRUE)
#define SCALAR(T) P(T, name), M(T, per_point), M(T, components), P(T, values)
#define OBJECT(T)                                                                                                      \
    M(T, kind), M(T, label), P(T, name), P(T, abbreviation), M(T, hemisphere), M(T, named), M(T, rgb), M(T, parent),   \
        M(T, voxels), M(T, volume_mm3), M(T, triangles), M(T, closed), M(T, is_band), M(T, volume), M(T, low),         \
        M(T, high), M(T, streamlines), M(T, points), M(T, length_mm), M(T, radius)
#define PLACE(T) M(T, is_mesh), M(T, is_bundle), M(T, is_hidden), M(T, named), M(T, index), M(T, group), M(T, own_rgb)
#define STEP(T) M(T, low), M(T, high), M(T, number), M(T, is_hidden)
#define HIDDEN_RUN(T) M(T, first), M(T, count), M(T, object)
#define DISTANCES(T)                                                                                                   \
    M(T, dim), M(T, base), M(T, lines), M(T, first), M(T, last), M(T, codes), M(T, block), M(T, shift), M(T, least)
#define NODE(T) M(T, low), M(T, high), M(T, cut)
#define LEAF(T) M(T, low), M(T, step), M(T, thickness), M(T, count), M(T, ends), M(T, bend), M(T, point)

#define STRUCT(type, MEMBERS)                                                                                          \
    {                                                                                                                  \
        sizeof(type), (const struct member[]){MEMBERS(type)},                                                          \
            sizeof((struct member[]){MEMBERS(type)}) / sizeof(struct member)                                           \
    }

/* NOLINTBEGIN(bugprone-sizeof-expression): of pointers, too */
static const struct {
    size_t size;
    const struct member *members;
    size_t count;
} structs[PACK_KINDS] = {
    [PACK_ATLAS] = STRUCT(conus_atlas, ATLAS),
    [PACK_VOLUME] = STRUCT(struct volume, VOLUME),
    [PACK_MESH] = STRUCT(struct mesh, MESH),
    [PACK_SURFACE] = STRUCT(struct context_surface, SURFACE),
    [PACK_WARP] = STRUCT(struct warp, WARP),
    [PACK_TRACTOGRAM] = STRUCT(struct tractogram, TRACTOGRAM),
    [PACK_SCALAR] = STRUCT(struct tract_scalar, SCALAR),
    [PACK_OBJECT] = STRUCT(conus_object, OBJECT),
    [PACK_PLACE] = STRUCT(struct object_place, PLACE),
    [PACK_STEP] = STRUCT(struct volume_step, STEP),
    [PACK_HIDDEN_RUN] = STRUCT(struct hidden_run, HIDDEN_RUN),
    [PACK_DISTANCES] = STRUCT(struct distance_map, DISTANCES),
    [PACK_NODE] = STRUCT(struct tract_node, NODE),
    [PACK_LEAF] = STRUCT(struct tract_leaf, LEAF),
};
/* NOLINTEND(bugprone-sizeof-expression) */

size_t pack_kind_size(enum pack_kind kind)
{
    return structs[kind].size;
}

void pack_make_bare(void *data, enum pack_kind kind)
{
    for (size_t i = 0; i < structs[kind].count; i++) {
        const struct member *member = &structs[kind].members[i];
        if (member->kind >= MEMBER_POINTER) {
            memset((uint8_t *)data + member->at, member->kind == MEMBER_TRUE, member->size);
        }
    }
}

bool pack_flags_are_sound(const void *data, enum pack_kind kind)
{
    const uint8_t *bytes = data;
    bool sound = true;
    for (size_t i = 0; i < structs[kind].count; i++) {
        const struct member *member = &structs[kind].members[i];
        bool is_flag = member->kind == MEMBER_FLAG || member->kind == MEMBER_TRUE;
        sound = sound && (!is_flag || bytes[member->at] <= 1) &&
                (member->kind != MEMBER_TEXT || memchr(bytes + member->at, 0, member->size));
    }
    return sound;
}

uint64_t pack_layout(void)
{
    uint64_t layout = 0;
    for (int kind = 0; kind < PACK_KINDS; kind++) {
        layout = 1000003 * layout + structs[kind].size;
        for (size_t i = 0; i < structs[kind].count && structs[kind].members[i].kind != MEMBER_PART; i++) {
            layout = 1000003 * layout + structs[kind].members[i].at;
            layout = 1000003 * layout + structs[kind].members[i].size;
        }
    }
    return layout;
}
