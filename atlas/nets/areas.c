/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the surfaces of all areas at once: of voxels by a net that neighbours share, of meshes as they are; bands of
 * streamlines. */
#include "atlas/nets/nets.h"

#include "atlas/nets/parts.h"
#include "base/memory.h"

#include <math.h>

enum {
    ROUNDS = 6,
    STREAMLINES = 2000, /* that are shown of all bundles together, but at least one of each */
    POINTS = 40         /* of each, at most: so these are 156,000 triangles */
};

static const double STRIDE =
    0.6;                         /* the part of the way to the middle of its neighbours that a vertex goes in a round */
static const double LIMIT = 0.4; /* edges of a cube from where it began, so that thin areas stay */

static double least_spacing(const conus_atlas *atlas)
{
    double least = INFINITY;
    for (size_t v = 0; v < atlas->volume_count; v++) {
        const conus_volume_info *info = &atlas->volumes[v].info;
        for (int a = 0; a < 3 && info->role == CONUS_ROLE_PARCELLATION; a++) {
            least = fmin(least, vec3_length(info->world_from_voxel + (size_t)4 * (size_t)a));
        }
    }
    return least;
}

/* Gives each area without a point those that are nearest to its voxels. `seen` is [object_count + 1]. */
static void add_small_areas(struct net_grid *grid, const bool *seen, const conus_atlas *atlas)
{
    for (size_t v = 0; v < atlas->volume_count; v++) {
        const struct volume *volume = &atlas->volumes[v];
        const size_t end = volume->info.role == CONUS_ROLE_PARCELLATION ? volume->voxel_count : 0;
        for (size_t voxel = 0; voxel < end; voxel++) {
            const uint32_t object = volume_object(volume, voxel);
            double at[3];
            if (!object || object == VOLUME_BLOCKER || seen[object]) {
                continue;
            }
            grid_index(at, volume->info.dim, voxel);
            mat4_point(at, volume->info.world_from_voxel, at);
            size_t point = 0;
            for (int a = 0; a < 3; a++) {
                point += grid->step[a] * (size_t)lround((at[a] - grid->start[a]) / grid->edge);
            }
            grid->objects[point] = object;
        }
    }
}

static conus_status fill_grid(struct net_grid *out, const conus_atlas *atlas, uint32_t cells)
{
    double identity[16];
    struct box3 box;
    mat4_identity(identity);
    const double least = least_spacing(atlas);
    if (isinf(least) || !atlas_area_bounds(box.low, box.high, atlas, identity)) {
        return CONUS_OK; /* and there is no grid */
    }
    const double longest = fmax(fmax(box.high[0] - box.low[0], box.high[1] - box.low[1]), box.high[2] - box.low[2]);
    bool *seen = memory_zeroed(atlas->object_count + 1, sizeof *seen);
    conus_status status =
        seen ? net_grid_init(out, box.low, box.high, fmax(longest / cells, least)) : CONUS_ERROR_MEMORY;
    for (size_t point = 0; !status && point < out->count; point++) {
        double at[3];
        net_grid_middle(at, out, point);
        out->objects[point] = net_area_at(atlas, at);
        seen[out->objects[point]] = true;
    }
    bool is_whole = true;
    for (size_t i = 0; !status && i < atlas->area_count; i++) {
        is_whole = is_whole && (seen[i + 1] || !atlas->objects[i].voxels);
    }
    if (!status && !is_whole) {
        add_small_areas(out, seen, atlas);
    }
    memory_free(seen);
    return status;
}

/* Adds to each vertex's sum the places of those that it shares an edge of a square with. */
static void add_neighbours(float *sums, uint32_t *counts, const struct net *net)
{
    for (size_t i = 0; i < 4 * net->square_count; i++) {
        const uint32_t *corners = net->squares[i / 4].corners;
        const uint32_t ends[2] = {corners[i % 4], corners[(i + 1) % 4]};
        for (int e = 0; e < 2; e++) {
            for (size_t a = 0; a < 3; a++) {
                sums[3 * (size_t)ends[e] + a] += net->vertices[3 * (size_t)ends[1 - e] + a];
            }
            counts[ends[e]]++;
        }
    }
}

/* Voxels have steps, areas have not. */
static conus_status smooth(struct net *net, double edge)
{
    const size_t count = 3 * net->vertex_count;
    const float limit = (float)(LIMIT * edge);
    float *start = memory_copy(net->vertices, count, sizeof *start);
    float *sums = memory_raw(count, sizeof *sums);
    uint32_t *counts = memory_raw(net->vertex_count, sizeof *counts);
    const bool has_room = start && sums && counts;
    for (int round = 0; has_room && round < ROUNDS; round++) {
        memset(sums, 0, count * sizeof *sums);
        memset(counts, 0, net->vertex_count * sizeof *counts);
        add_neighbours(sums, counts, net);
        for (size_t i = 0; i < count; i++) {
            const size_t vertex = i / 3;
            const float to = sums[i] / (float)counts[vertex];
            const float moved = net->vertices[i] + (float)STRIDE * (to - net->vertices[i]);
            net->vertices[i] = fmaxf(start[i] - limit, fminf(start[i] + limit, moved));
        }
    }
    memory_free(start);
    memory_free(sums);
    memory_free(counts);
    return has_room ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Numbers of net->squares, twice each plus the side, by the object on that side: first[k] to before first[k + 1] are of
 * object k. NULL without memory. */
static uint32_t *sort_squares(uint32_t *first, const struct net *net, size_t object_count)
{
    uint32_t *sorted = memory_raw(2 * net->square_count, sizeof *sorted);
    for (size_t i = 0; i < 2 * net->square_count; i++) {
        first[net->squares[i / 2].objects[i % 2]]++;
    }
    for (size_t object = 0; object <= object_count; object++) {
        first[object + 1] += first[object];
    }
    for (size_t i = 2 * net->square_count; sorted && i-- > 0;) { /* from the ends, which become the beginnings */
        sorted[--first[net->squares[i / 2].objects[i % 2]]] = (uint32_t)i;
    }
    return sorted;
}

static bool is_shorter(const float *vertices, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    float ab = 0;
    float cd = 0;
    for (size_t i = 0; i < 3; i++) {
        const float x = vertices[3 * (size_t)a + i] - vertices[3 * (size_t)b + i];
        const float y = vertices[3 * (size_t)c + i] - vertices[3 * (size_t)d + i];
        ab += x * x;
        cd += y * y;
    }
    return ab <= cd;
}

/* Adds the two triangles of a square of vertices of `nets`, along its shorter diagonal. */
static void add_square(struct nets *nets, const uint32_t v[4], bool is_outer)
{
    static const int halves[2][6] = {{0, 1, 3, 1, 2, 3}, {0, 1, 2, 0, 2, 3}};
    const int *corners = halves[is_shorter(nets->positions, v[0], v[2], v[1], v[3])];
    for (int i = 0; i < 6; i++) {
        nets->corners[nets->corner_count++] = v[corners[i]];
        if (is_outer) {
            nets->outer[nets->outer_count++] = v[corners[i]];
        }
    }
}

/* The object's own copy of a vertex of the net; own[v] is that vertex from 1 on, where it is this object's. */
static uint32_t own_vertex(struct nets *nets, uint32_t *own, const struct net *net, uint32_t vertex, size_t begin,
                           uint32_t object)
{
    if (own[vertex] <= begin) {
        memcpy(nets->positions + 3 * nets->vertex_count, net->vertices + 3 * (size_t)vertex, 3 * sizeof(float));
        nets->objects[nets->vertex_count++] = (uint16_t)object;
        own[vertex] = (uint32_t)nets->vertex_count;
    }
    return own[vertex] - 1;
}

/* Adds the surface of an object: the squares in sorted[] from `from` to before `to`. */
static void add_area(struct nets *nets, uint32_t *own, const struct net *net, const uint32_t *sorted, size_t from,
                     size_t to, uint32_t object)
{
    const size_t begin = nets->vertex_count;
    for (size_t i = from; i < to; i++) {
        const struct net_square *square = &net->squares[sorted[i] / 2];
        const uint32_t side = sorted[i] % 2;
        uint32_t corners[4];
        for (uint32_t c = 0; c < 4; c++) {
            corners[c] = own_vertex(nets, own, net, square->corners[side ? 3 - c : c], begin, object);
        }
        add_square(nets, corners, !square->objects[1 - side]);
    }
}

static void add_mesh(struct nets *nets, const struct mesh *mesh, uint32_t object)
{
    memcpy(nets->positions + 3 * nets->vertex_count, mesh->positions, 3 * mesh->vertex_count * sizeof(float));
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const uint32_t corner = (uint32_t)nets->vertex_count + mesh->triangles[i];
        nets->corners[nets->corner_count++] = nets->outer[nets->outer_count++] = corner;
    }
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        nets->objects[nets->vertex_count++] = (uint16_t)object;
    }
    nets->is_closed = false;
}

/* How many streamlines of a bundle are shown, if these are every so many. */
static size_t count_shown(const conus_atlas *atlas, uint32_t object, size_t every)
{
    const bool is_hidden = atlas->places[object - 1].is_hidden;
    const struct tractogram *tractogram = is_hidden ? NULL : atlas_bundle_tractogram(atlas, object);
    return tractogram ? (tract_group_count(atlas_bundle_group(atlas, object), tractogram) + every - 1) / every : 0;
}

/* Every how manyth streamline is shown. */
static size_t find_every(const conus_atlas *atlas)
{
    size_t count = 0;
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        count += count_shown(atlas, object, 1);
    }
    return 1 + count / (STREAMLINES + 1);
}

/* The next two vertices of a band, on both sides of a point; `side`, a unit vector or 0, turns no more than the band
 * must. */
static void add_sides(struct nets *nets, double side[3], const double at[3], const double along[3], double radius,
                      uint32_t object)
{
    vec3_add_scaled(side, side, -vec3_dot(side, along), along);
    if (!vec3_normalise(side, side)) {
        vec3_cross(side, along, fabs(along[2]) < 0.9 ? (const double[]){0, 0, 1} : (const double[]){0, 1, 0});
        vec3_normalise(side, side);
    }
    for (int sign = -1; sign <= 1; sign += 2) {
        for (size_t a = 0; a < 3; a++) {
            nets->positions[3 * nets->vertex_count + a] = (float)(at[a] + sign * radius * side[a]);
        }
        nets->objects[nets->vertex_count++] = (uint16_t)object;
    }
}

/* Adds a band along a streamline, as wide as its capsules, of points that are `apart` or more, and the last one. */
static void add_band(struct nets *nets, const struct tractogram *tractogram, uint32_t streamline, uint32_t object)
{
    static const uint32_t corners[6] = {0, 1, 2, 1, 3, 2};
    const uint64_t last = tractogram->first[streamline + 1] - 1;
    const double apart = tractogram->tree.lengths[streamline] / (POINTS - 2);
    double side[3] = {0};
    double from[3];
    bool begins = true;
    tractogram_point(from, tractogram, tractogram->first[streamline]);
    for (uint64_t point = tractogram->first[streamline] + 1; point <= last; point++) {
        double at[3];
        double along[3];
        tractogram_point(at, tractogram, point);
        vec3_sub(along, at, from);
        if ((vec3_length(along) < apart && point < last) || !vec3_normalise(along, along)) {
            continue;
        }
        if (begins) {
            add_sides(nets, side, from, along, tractogram->radius, object);
        }
        add_sides(nets, side, at, along, tractogram->radius, object);
        for (int i = 0; i < 6; i++) {
            const uint32_t corner = (uint32_t)nets->vertex_count - 4 + corners[i];
            nets->corners[nets->corner_count++] = nets->outer[nets->outer_count++] = corner;
        }
        begins = false;
        memcpy(from, at, sizeof from);
    }
}

static void add_bundle(struct nets *nets, const conus_atlas *atlas, uint32_t object, size_t every)
{
    const size_t count = count_shown(atlas, object, every);
    for (size_t i = 0; i < count; i++) {
        const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, object);
        const uint32_t streamline = tract_group_member(atlas_bundle_group(atlas, object), i * every);
        if (tractogram->first[streamline] < tractogram->first[streamline + 1]) {
            add_band(nets, tractogram, streamline, object);
        }
        nets->is_closed = false;
    }
}

/* From the triangles at each vertex, by their area. */
static conus_status find_normals(struct nets *nets)
{
    float *sums = memory_zeroed(3 * nets->vertex_count, sizeof *sums);
    for (size_t i = 0; sums && i < nets->corner_count; i += 3) {
        const uint32_t *corners = nets->corners + i;
        const float *p = nets->positions + 3 * (size_t)corners[0];
        const float *q = nets->positions + 3 * (size_t)corners[1];
        const float *r = nets->positions + 3 * (size_t)corners[2];
        for (size_t a = 0; a < 3; a++) {
            const size_t b = (a + 1) % 3;
            const size_t c = (a + 2) % 3;
            const float cross = (q[b] - p[b]) * (r[c] - p[c]) - (q[c] - p[c]) * (r[b] - p[b]);
            for (size_t k = 0; k < 3; k++) {
                sums[3 * (size_t)corners[k] + a] += cross;
            }
        }
    }
    for (size_t v = 0; sums && v < nets->vertex_count; v++) {
        const float *sum = sums + 3 * v;
        const float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        for (size_t a = 0; a < 3; a++) {
            nets->normals[4 * v + a] = (int8_t)lrintf(length > 0 ? 127 * sum[a] / length : 0);
        }
    }
    memory_free(sums);
    return sums ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Arrays for all areas. Each vertex of a net is a corner of three squares of an area or more. */
static conus_status reserve(struct nets *out, const uint32_t *first, const conus_atlas *atlas, size_t every)
{
    const size_t squares = first[atlas->object_count + 1] - first[1];
    size_t vertices = squares * 4 / 3;
    size_t corners = 6 * squares;
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        const size_t bands = count_shown(atlas, object, every);
        vertices += mesh ? mesh->vertex_count : 2 * POINTS * bands;
        corners += mesh ? 3 * mesh->triangle_count : 6 * (POINTS - 1) * bands;
    }
    if (!corners) {
        return fail(CONUS_ERROR_ARGUMENT, "no area of this atlas has voxels, a surface or streamlines to show");
    }
    *out = (struct nets){.positions = memory_raw(3 * vertices, sizeof *out->positions),
                         .normals = memory_zeroed(4 * vertices, sizeof *out->normals),
                         .objects = memory_raw(vertices, sizeof *out->objects),
                         .corners = memory_raw(corners, sizeof *out->corners),
                         .first = memory_zeroed(atlas->object_count + 2, sizeof *out->first),
                         .outer = memory_raw(corners, sizeof *out->outer),
                         .is_closed = true};
    return out->positions && out->normals && out->objects && out->corners && out->first && out->outer
               ? CONUS_OK
               : CONUS_ERROR_MEMORY;
}

static conus_status fill(struct nets *out, const conus_atlas *atlas, const struct net *net)
{
    uint32_t *first = memory_zeroed(atlas->object_count + 2, sizeof *first);
    uint32_t *own = memory_zeroed(net->vertex_count, sizeof *own);
    uint32_t *sorted = first ? sort_squares(first, net, atlas->object_count) : NULL;
    conus_status status = own && sorted ? CONUS_OK : CONUS_ERROR_MEMORY;
    const size_t every = find_every(atlas);
    status = status ? status : reserve(out, first, atlas, every);
    for (uint32_t object = 1; !status && object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        out->first[object] = (uint32_t)out->corner_count;
        add_area(out, own, net, sorted, first[object], first[object + 1], object);
        if (mesh) {
            add_mesh(out, mesh, object);
        }
        add_bundle(out, atlas, object, every);
        out->first[object + 1] = (uint32_t)out->corner_count;
    }
    memory_free(first);
    memory_free(own);
    memory_free(sorted);
    return status ? status : find_normals(out);
}

conus_status nets_make(struct nets *out, const conus_atlas *atlas, uint32_t cells)
{
    struct net_grid grid = {0};
    struct net net = {0};
    struct nets nets = {0};
    if (atlas->object_count > UINT16_MAX) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%zu objects; up to %d can be shown as surfaces", atlas->object_count,
                    UINT16_MAX);
    }
    conus_status status = fill_grid(&grid, atlas, cells);
    status = status || !grid.count ? status : net_find(&net, &grid);
    status = status ? status : smooth(&net, grid.edge);
    status = status ? status : fill(&nets, atlas, &net);
    net_grid_finish(&grid);
    net_finish(&net);
    return GIVE(status, out, nets, nets_finish(&nets));
}

void nets_finish(struct nets *nets)
{
    memory_free(nets->positions);
    memory_free(nets->normals);
    memory_free(nets->objects);
    memory_free(nets->corners);
    memory_free(nets->first);
    memory_free(nets->outer);
    *nets = (struct nets){0};
}
