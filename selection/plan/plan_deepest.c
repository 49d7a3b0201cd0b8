/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the point of a structure that is farthest from its border, and how much of it lies on which side. */
#include "selection/plan/plan.h"

#include "atlas/areas/areas.h"
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double EQUAL = 1e-9; /* mm */

/** Points that may be the deepest: all are equal to the best so far. */
struct deepest {
    struct inner_point *points;
    size_t count, capacity;
    double best;
};

static conus_status add_point(struct deepest *deepest, const struct inner_point *point)
{
    if (!(point->depth > 0) || point->depth < deepest->best - EQUAL) {
        return CONUS_OK;
    }
    deepest->count = point->depth > deepest->best + EQUAL ? 0 : deepest->count; /* those before are below the rest */
    if (!memory_reserve(&deepest->points, &deepest->capacity, deepest->count + 1, sizeof *deepest->points)) {
        return CONUS_ERROR_MEMORY;
    }
    deepest->points[deepest->count++] = *point;
    deepest->best = fmax(deepest->best, point->depth);
    return CONUS_OK;
}

/* Voxels of the structure, of a box of a volume that has one more around. */
struct depths {
    const struct volume *volume;
    size_t first[3]; /* of the box, one before it along each axis, so it may be SIZE_MAX */
    size_t dim[3];
    float *bounds; /* mm to the border at most; 0 = it is not the structure's */
};

struct filling {
    struct depths *depths;
    size_t low[3], high[3];
};

/* Number of the voxel's object, also where it is hidden: by its value, or by the runs of hidden voxels. */
static uint32_t stored_object(const struct volume *volume, size_t voxel)
{
    if (volume->step_count) {
        const struct volume_step *step = volume_step_of(volume, volume_value(volume, voxel));
        return step ? step->number : 0;
    }
    uint32_t object = volume_object(volume, voxel);
    for (size_t i = 0; i < volume->hidden_run_count && !object; i++) {
        const struct hidden_run *run = &volume->hidden_runs[i];
        object = voxel >= run->first && voxel - run->first < run->count ? run->object : 0;
    }
    return object;
}

/* Calls `act` with each voxel of the structure in a volume; hidden ones come last. */
static void each_voxel(const struct plan_constraint *structure, const struct volume *volume,
                       void (*act)(void *user, const struct volume *volume, size_t voxel), void *user)
{
    for (size_t voxel = volume_next(volume, 0); voxel < volume->voxel_count; voxel = volume_next(volume, voxel + 1)) {
        uint32_t object = volume->step_count ? stored_object(volume, voxel) : volume_object(volume, voxel);
        if (structure->has[object]) {
            act(user, volume, voxel);
        }
    }
    for (size_t i = 0; i < volume->hidden_run_count; i++) {
        const struct hidden_run *run = &volume->hidden_runs[i];
        for (size_t k = 0; k < run->count && structure->has[run->object]; k++) {
            act(user, volume, run->first + k);
        }
    }
}

bool plan_is_inside(const struct plan_constraint *structure, const double point[3])
{
    bool found = false;
    for (size_t i = 0; i < structure->part_count && !found; i++) {
        const struct plan_part *part = &structure->parts[i];
        size_t voxel;
        found = part->volume ? volume_find_voxel(&voxel, part->volume, point) &&
                                   structure->has[stored_object(part->volume, voxel)]
                             : part->mesh && part->mesh->shape.closed && fabs(mesh_winding(part->mesh, point)) > 0.5;
    }
    return found;
}

static void find_index(size_t at[3], const struct volume *volume, size_t voxel)
{
    const size_t *dim = volume->info.dim;
    at[0] = voxel % dim[0];
    at[1] = voxel / dim[0] % dim[1];
    at[2] = voxel / dim[0] / dim[1];
}

static void extend_box(void *user, const struct volume *volume, size_t voxel)
{
    struct filling *filling = user;
    size_t at[3];
    find_index(at, volume, voxel);
    for (int a = 0; a < 3; a++) {
        filling->low[a] = at[a] < filling->low[a] ? at[a] : filling->low[a];
        filling->high[a] = at[a] > filling->high[a] ? at[a] : filling->high[a];
    }
}

static void fill_voxel(void *user, const struct volume *volume, size_t voxel)
{
    const struct depths *depths = ((struct filling *)user)->depths;
    size_t at[3];
    find_index(at, volume, voxel);
    for (int a = 0; a < 3; a++) {
        at[a] -= depths->first[a];
    }
    depths->bounds[at[0] + depths->dim[0] * (at[1] + depths->dim[1] * at[2])] = FLT_MAX;
}

/* Lets each voxel's bound be at most that of one of the 13 neighbours that were passed before, and the way there. */
static void pass_bounds(struct depths *depths, bool backward)
{
    const size_t *dim = depths->dim;
    const size_t count = dim[0] * dim[1] * dim[2];
    ptrdiff_t steps[13];
    float ways[13];
    for (int n = 0; n < 13; n++) {
        const int by[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        const double step[3] = {by[0], by[1], by[2]};
        double way[3];
        mat4_direction(way, depths->volume->info.world_from_voxel, step);
        ways[n] = (float)vec3_length(way);
        steps[n] = by[0] + (ptrdiff_t)dim[0] * (by[1] + (ptrdiff_t)dim[1] * by[2]);
    }
    for (size_t i = 0; i < count; i++) {
        size_t at = backward ? count - 1 - i : i;
        float bound = depths->bounds[at];
        for (int n = 0; n < 13 && bound > 0; n++) {
            float other = depths->bounds[(ptrdiff_t)at + (backward ? -steps[n] : steps[n])] + ways[n];
            bound = other < bound ? other : bound;
        }
        depths->bounds[at] = bound;
    }
}

static conus_status init_depths(struct depths *out, const struct plan_constraint *structure,
                                const struct volume *volume)
{
    struct filling filling = {.depths = out, .low = {SIZE_MAX, SIZE_MAX, SIZE_MAX}};
    size_t count = 1;
    *out = (struct depths){.volume = volume};
    each_voxel(structure, volume, extend_box, &filling);
    if (filling.low[0] > filling.high[0]) {
        return CONUS_OK;
    }
    for (int a = 0; a < 3; a++) {
        out->first[a] = filling.low[a] - 1;
        out->dim[a] = filling.high[a] - filling.low[a] + 3;
        count *= out->dim[a];
    }
    out->bounds = memory_zeroed(count, sizeof *out->bounds);
    if (!out->bounds) {
        return CONUS_ERROR_MEMORY;
    }
    each_voxel(structure, volume, fill_voxel, &filling);
    pass_bounds(out, false);
    pass_bounds(out, true);
    return CONUS_OK;
}

/* mm from a voxel's centre to the nearest one around the structure, looked for in one cube of voxels round the next,
 * until none that is farther out can be nearer, or `enough` is not reached. */
static double find_depth(const struct depths *depths, size_t place, double enough, double apart)
{
    const ptrdiff_t dim[3] = {(ptrdiff_t)depths->dim[0], (ptrdiff_t)depths->dim[1], (ptrdiff_t)depths->dim[2]};
    const ptrdiff_t at[3] = {(ptrdiff_t)place % dim[0], (ptrdiff_t)place / dim[0] % dim[1],
                             (ptrdiff_t)place / dim[0] / dim[1]};
    double least = INFINITY;
    for (ptrdiff_t r = 1; (double)r * apart < least && least >= enough; r++) {
        for (ptrdiff_t z = -r; z <= r; z++) {
            for (ptrdiff_t y = -r; y <= r; y++) {
                bool is_wall = z == -r || z == r || y == -r || y == r;
                for (ptrdiff_t x = -r; x <= r; x += is_wall ? 1 : 2 * r) {
                    const ptrdiff_t p[3] = {at[0] + x, at[1] + y, at[2] + z};
                    bool is_beyond =
                        p[0] < 0 || p[1] < 0 || p[2] < 0 || p[0] >= dim[0] || p[1] >= dim[1] || p[2] >= dim[2];
                    if (is_beyond || depths->bounds[p[0] + dim[0] * (p[1] + dim[1] * p[2])] == 0) {
                        const double step[3] = {(double)x, (double)y, (double)z};
                        double way[3];
                        mat4_direction(way, depths->volume->info.world_from_voxel, step);
                        least = fmin(least, vec3_length(way));
                    }
                }
            }
        }
    }
    return least;
}

static conus_status try_voxel(struct deepest *deepest, const struct depths *depths, size_t place, double apart)
{
    const size_t *dim = depths->volume->info.dim;
    size_t at[3] = {place % depths->dim[0], place / depths->dim[0] % depths->dim[1],
                    place / depths->dim[0] / depths->dim[1]};
    double index[3];
    struct inner_point point = {.depth = find_depth(depths, place, deepest->best - EQUAL, apart)};
    for (int a = 0; a < 3; a++) {
        at[a] += depths->first[a];
        index[a] = (double)at[a];
    }
    mat4_point(point.at, depths->volume->info.world_from_voxel, index);
    point.source = at[0] + dim[0] * (at[1] + dim[1] * at[2]);
    return add_point(deepest, &point);
}

/* A bound is that of a way from neighbour to neighbour, a few per cent longer than a straight one: where it is not
 * above the best depth so far, the voxel need not be looked at. */
static conus_status find_in_voxels(struct deepest *deepest, const struct plan_constraint *structure,
                                   const struct volume *volume)
{
    static const double ROUNDING = 1e-4; /* of sums in single precision, relative */
    struct depths depths;
    conus_status status = init_depths(&depths, structure, volume);
    size_t count = depths.bounds ? depths.dim[0] * depths.dim[1] * depths.dim[2] : 0;
    size_t most = 0;
    double apart = INFINITY; /* mm between two planes of voxels at least */
    for (int a = 0; a < 3; a++) {
        const double *inverse = volume->voxel_from_world + a;
        apart = fmin(apart, 1 / sqrt(inverse[0] * inverse[0] + inverse[4] * inverse[4] + inverse[8] * inverse[8]));
    }
    for (size_t i = 0; i < count; i++) {
        most = depths.bounds[i] > depths.bounds[most] ? i : most;
    }
    double before = deepest->best;
    if (count && !status && (double)depths.bounds[most] * (1 + ROUNDING) >= before - EQUAL) {
        double depth = find_depth(&depths, most, before - EQUAL, apart);
        deepest->best = fmax(before, depth - 2 * EQUAL); /* what is lower need not be looked at; it comes again */
        deepest->count = deepest->best > before + EQUAL ? 0 : deepest->count;
    }
    for (size_t i = 0; i < count && !status; i++) {
        if (depths.bounds[i] > 0 && (double)depths.bounds[i] * (1 + ROUNDING) >= deepest->best - EQUAL) {
            status = try_voxel(deepest, &depths, i, apart);
        }
    }
    memory_free(depths.bounds);
    return status;
}

/** A closed surface, and where its triangles are. */
struct closed_mesh {
    const struct mesh *mesh;
    struct bvh tree;
};

static conus_status init_solid(struct closed_mesh *out, const struct mesh *mesh)
{
    struct bvh_box *boxes = memory_raw(mesh->triangle_count, sizeof *boxes);
    *out = (struct closed_mesh){mesh, {0}};
    if (!boxes) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        boxes[i] = bvh_box_empty((uint32_t)i);
        for (int c = 0; c < 3; c++) {
            bvh_box_extend(&boxes[i], mesh->positions + 3 * (size_t)mesh->triangles[3 * i + (size_t)c]);
        }
    }
    conus_status status = bvh_init(&out->tree, boxes, mesh->triangle_count);
    memory_free(boxes);
    return status;
}

/* mm from a point to the surface; less than 0 outside of it. */
static double solid_depth(const struct closed_mesh *solid, const double point[3])
{
    static const double along[3] = {1, 0, 0};
    struct needle needle = {.direction = {1, 0, 0}};
    struct needle_frame frame;
    struct bvh_search search;
    uint32_t triangle;
    double least = INFINITY;
    int winding = 0;
    memcpy(needle.origin, point, sizeof needle.origin);
    needle_frame_init(&frame, &needle, NULL);
    bvh_search_round(&search, &solid->tree, &frame);
    while (bvh_search_next(&triangle, &search, least)) {
        double depth;
        double foot[3];
        least = fmin(least, mesh_needle(&depth, foot, solid->mesh, triangle, &needle));
    }
    bvh_search_init(&search, &solid->tree, point, along);
    while (bvh_search_next(&triangle, &search, INFINITY)) {
        int side = 0;
        if (mesh_is_passed(solid->mesh, triangle, point, along) &&
            mesh_crossing(&side, solid->mesh, triangle, point, along) >= 0) {
            winding += side;
        }
    }
    return winding ? least : -least;
}

/** A box of points of the grid, by their numbers along the axes. */
struct grid_box {
    long first[3], last[3];
};

enum { BOXES = 256 }; /* each step leaves one behind, and halving what 3 longs can hold takes fewer */

/* Looks into ever smaller boxes, those first whose middle is deeper, unless none of its points can be the deepest. */
static conus_status search_grid(struct deepest *deepest, const struct closed_mesh *solid, double step)
{
    struct grid_box boxes[BOXES];
    size_t count = 1;
    conus_status status = CONUS_OK;
    for (int a = 0; a < 3; a++) {
        boxes[0].first[a] = (long)floor(solid->mesh->shape.low[a] / step);
        boxes[0].last[a] = (long)ceil(solid->mesh->shape.high[a] / step);
    }
    while (count && !status) {
        struct grid_box box = boxes[--count];
        struct inner_point middle = {.source = UINT64_MAX};
        double half[3];
        int longest = 0;
        for (int a = 0; a < 3; a++) {
            middle.at[a] = step * ((double)box.first[a] + (double)box.last[a]) / 2;
            half[a] = step * (double)(box.last[a] - box.first[a]) / 2;
            longest = box.last[a] - box.first[a] > box.last[longest] - box.first[longest] ? a : longest;
        }
        middle.depth = solid_depth(solid, middle.at);
        if (middle.depth + vec3_length(half) < fmax(deepest->best, 0) - EQUAL) {
            continue;
        }
        if (box.first[longest] == box.last[longest]) {
            status = add_point(deepest, &middle);
            continue;
        }
        long cut = box.first[longest] + (box.last[longest] - box.first[longest]) / 2;
        boxes[count] = boxes[count + 1] = box;
        boxes[count].first[longest] = cut + 1; /* the lower one is looked into first */
        boxes[count + 1].last[longest] = cut;
        count += 2;
    }
    return status;
}

static conus_status find_in_solid(struct deepest *deepest, const struct mesh *mesh)
{
    enum { HALVINGS = 10 }; /* of the grid's step, where no point is inside */
    struct closed_mesh solid;
    struct deepest own = {0};
    conus_status status = init_solid(&solid, mesh);
    for (int k = 0; !status && !own.count && k <= HALVINGS; k++) {
        status = search_grid(&own, &solid, ldexp(1, -k));
    }
    for (size_t i = 0; i < own.count && !status; i++) {
        status = add_point(deepest, &own.points[i]);
    }
    memory_free(own.points);
    bvh_finish(&solid.tree);
    return status;
}

/* By z, y and x, as the voxels of a file and the points of a grid are counted. */
static bool comes_first(const struct inner_point *a, const struct inner_point *b)
{
    bool is_solid = a->source == UINT64_MAX && b->source == UINT64_MAX;
    for (int axis = 2; axis >= 0 && is_solid; axis--) {
        if (a->at[axis] != b->at[axis]) {
            return a->at[axis] < b->at[axis];
        }
    }
    return a->source < b->source;
}

conus_status plan_deepest(struct inner_point *out, const struct plan_constraint *structure, const double centroid[3])
{
    struct deepest deepest = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < structure->part_count && !status; i++) {
        const struct plan_part *part = &structure->parts[i];
        if (part->volume) {
            status = find_in_voxels(&deepest, structure, part->volume);
        } else if (part->mesh && part->mesh->shape.closed) {
            status = find_in_solid(&deepest, part->mesh);
        }
    }
    struct inner_point found = {0};
    double least = INFINITY;
    for (size_t i = 0; i < deepest.count && !status; i++) {
        double way[3];
        vec3_sub(way, deepest.points[i].at, centroid);
        least = deepest.points[i].depth < deepest.best - EQUAL ? least : fmin(least, vec3_length(way));
    }
    for (size_t i = 0; i < deepest.count && !status; i++) {
        const struct inner_point *point = &deepest.points[i];
        double way[3];
        vec3_sub(way, point->at, centroid);
        if (point->depth >= deepest.best - EQUAL && vec3_length(way) <= least + EQUAL &&
            (!found.depth || comes_first(point, &found))) {
            found = *point;
        }
    }
    memory_free(deepest.points);
    if (!status) {
        *out = found;
    }
    return status;
}

static void add_centre(void *user, const struct volume *volume, size_t voxel)
{
    double *sum = user;
    double point[3];
    grid_index(point, volume->info.dim, voxel);
    mat4_point(point, volume->info.world_from_voxel, point);
    for (int a = 0; a < 4; a++) {
        sum[a] += a < 3 ? point[a] : 1;
    }
}

void plan_centroid(double out[4], const struct plan_constraint *structure)
{
    double sum[4] = {0};
    for (size_t i = 0; i < structure->part_count; i++) {
        const struct plan_part *part = &structure->parts[i];
        double own[4] = {0};
        double one = 0;
        if (part->volume) {
            one = fabs(mat4_determinant3(part->volume->info.world_from_voxel));
            each_voxel(structure, part->volume, add_centre, own);
        } else if (part->mesh && part->mesh->shape.closed) {
            one = fabs(part->mesh->shape.volume_mm3);
            memcpy(own, part->mesh->shape.centroid, sizeof part->mesh->shape.centroid);
            own[3] = 1;
        }
        for (int a = 0; a < 4; a++) {
            sum[a] += one * own[a];
        }
    }
    for (int a = 0; a < 3; a++) {
        out[a] = sum[3] > 0 ? sum[a] / sum[3] : 0;
    }
    out[3] = sum[3];
}

struct nearness {
    const double *from;
    double least;
    double at[3];
    size_t voxel;
    const struct volume *volume;
};

static void try_nearer(void *user, const struct volume *volume, size_t voxel)
{
    struct nearness *near = user;
    double at[4] = {0};
    double way[3];
    add_centre(at, volume, voxel);
    vec3_sub(way, at, near->from);
    double length = vec3_length(way);
    if (length < near->least || (length == near->least && volume == near->volume && voxel < near->voxel)) {
        near->least = length;
        near->voxel = voxel;
        near->volume = volume;
        memcpy(near->at, at, sizeof near->at);
    }
}

bool plan_nearest_point(double out[3], const struct plan_constraint *structure, const double from[3])
{
    struct nearness near = {.from = from, .least = INFINITY};
    for (size_t i = 0; i < structure->part_count; i++) {
        const struct plan_part *part = &structure->parts[i];
        if (part->volume) {
            each_voxel(structure, part->volume, try_nearer, &near);
        } else if (part->mesh) {
            near.least = fmin(near.least, mesh_nearest(near.at, part->mesh, from, near.least));
        }
    }
    memcpy(out, near.at, sizeof near.at);
    return isfinite(near.least);
}

/** Points, each with its object. */
struct distances {
    const conus_atlas *atlas;
    const uint32_t *objects;
    const double (*points)[3];
    size_t *next;  /* [count] The next point of the same object, + 1; 0 = there is none. */
    size_t *first; /* [object_count + 1] The first of the object, + 1. */
    double *least; /* [count] */
};

/* Calls `act` with each point whose object is this one or above it. */
static void each_point(struct distances *distances, uint32_t object,
                       void (*act)(struct distances *distances, size_t point, const void *user), const void *user)
{
    for (uint32_t above = object; above; above = distances->atlas->objects[above - 1].parent) {
        for (size_t i = distances->first[above]; i; i = distances->next[i - 1]) {
            act(distances, i - 1, user);
        }
    }
}

static void measure_to_centre(struct distances *distances, size_t point, const void *user)
{
    double way[3];
    vec3_sub(way, user, distances->points[point]);
    distances->least[point] = fmin(distances->least[point], vec3_length(way));
}

static void measure_to_voxel(void *user, const struct volume *volume, size_t voxel)
{
    double at[4] = {0};
    add_centre(at, volume, voxel);
    each_point(user, stored_object(volume, voxel), measure_to_centre, at);
}

static void measure_to_mesh(struct distances *distances, size_t point, const void *user)
{
    double at[3];
    distances->least[point] =
        fmin(distances->least[point], mesh_nearest(at, user, distances->points[point], distances->least[point]));
}

static void measure_inside(struct distances *distances, size_t point, const void *user)
{
    const struct volume *volume = user;
    size_t voxel;
    uint32_t object = volume_find_voxel(&voxel, volume, distances->points[point]) ? stored_object(volume, voxel) : 0;
    while (object && object != distances->objects[point]) {
        object = distances->atlas->objects[object - 1].parent;
    }
    distances->least[point] = object ? 0 : distances->least[point];
}

/* A point in its object is not measured again: where all are, as in a list that is right, no voxel is. */
static void measure_volume(struct distances *distances, const struct plan_constraint *below, size_t count,
                           const struct volume *volume)
{
    size_t inside = 0;
    for (size_t i = 0; i < count; i++) {
        measure_inside(distances, i, volume);
        inside += distances->least[i] == 0;
    }
    if (inside < count) {
        each_voxel(below, volume, measure_to_voxel, distances);
    }
}

conus_status plan_distances(double *out, const conus_atlas *atlas, const uint32_t *objects, const double (*points)[3],
                            size_t count)
{
    struct distances distances = {.atlas = atlas,
                                  .objects = objects,
                                  .points = points,
                                  .next = memory_zeroed(count, sizeof *distances.next),
                                  .first = memory_zeroed(atlas->object_count + 1, sizeof *distances.first),
                                  .least = out};
    struct plan_constraint below = {.has = memory_zeroed(atlas->object_count + 1, sizeof *below.has)};
    conus_status status = distances.next && distances.first && below.has ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < count && !status; i++) {
        out[i] = INFINITY;
        distances.next[i] = distances.first[objects[i]];
        distances.first[objects[i]] = i + 1;
    }
    for (uint32_t object = 1; object <= atlas->object_count && !status; object++) {
        uint32_t above = object;
        while (above && !distances.first[above]) {
            above = atlas->objects[above - 1].parent;
        }
        below.has[object] = above;
        const struct mesh *mesh = above ? atlas_stored_mesh(atlas, object) : NULL;
        if (mesh) {
            each_point(&distances, object, measure_to_mesh, mesh);
        }
    }
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT) {
            measure_volume(&distances, &below, count, &atlas->volumes[i]);
        }
    }
    memory_free(distances.next);
    memory_free(distances.first);
    memory_free(below.has);
    return status;
}

/* The atlas's own position, with x counted from the midline, less than 0 to the left of it. */
static void place_by_midline(double out[3], const struct midline *midline, const conus_atlas *atlas,
                             const double point[3])
{
    conus_atlas_own_point(out, atlas, point);
    mat4_point(out, midline->side_from_own, out);
}

struct side_count {
    const conus_atlas *atlas;
    const struct midline *midline;
    double sides[2];
    double one; /* mm^3 of a voxel */
};

static void count_side(void *user, const struct volume *volume, size_t voxel)
{
    struct side_count *count = user;
    const bool is_rounded = count->atlas->is_moved || count->midline->is_ccf;
    double at[4] = {0};
    double own[3];
    add_centre(at, volume, voxel);
    place_by_midline(own, count->midline, count->atlas, at);
    count->sides[own[0] < -(is_rounded ? FRAME_MIDLINE_ROUNDING : 0) ? 0 : 1] += count->one;
}

/* The flux of (x, 0, 0) out of the part of a triangle where x has the sign: its share in the volume there. */
static double flux_on_side(double corner[3][3], double sign)
{
    double cut[4][3];
    int count = 0;
    for (int c = 0; c < 3; c++) {
        const double *a = corner[c];
        const double *b = corner[(c + 1) % 3];
        if (sign * a[0] >= 0) {
            memcpy(cut[count++], a, sizeof cut[0]);
        }
        if ((a[0] < 0) != (b[0] < 0) && a[0] != 0 && b[0] != 0) {
            double t = a[0] / (a[0] - b[0]);
            for (int k = 0; k < 3; k++) {
                cut[count][k] = a[k] + t * (b[k] - a[k]);
            }
            count++;
        }
    }
    double flux = 0;
    for (int c = 2; c < count; c++) {
        const double area = ((cut[c - 1][1] - cut[0][1]) * (cut[c][2] - cut[0][2]) -
                             (cut[c - 1][2] - cut[0][2]) * (cut[c][1] - cut[0][1])) /
                            2;
        flux += area * (cut[0][0] + cut[c - 1][0] + cut[c][0]) / 3;
    }
    return flux;
}

static void add_solid_sides(struct side_count *count, const struct mesh *mesh)
{
    double sum[2] = {0};
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double corner[3][3];
        double own[3][3];
        mesh_corners(corner, mesh, i);
        for (int c = 0; c < 3; c++) {
            place_by_midline(own[c], count->midline, count->atlas, corner[c]);
        }
        sum[0] += flux_on_side(own, -1);
        sum[1] += flux_on_side(own, 1);
    }
    count->sides[0] += fabs(sum[0]);
    count->sides[1] += fabs(sum[1]);
}

/* mm^3 of voxels and insides of closed surfaces to the left and to the right of the midline. */
static void plan_sides(double out[2], const struct plan_constraint *structure, const struct midline *midline,
                       const conus_atlas *atlas)
{
    struct side_count count = {.atlas = atlas, .midline = midline};
    for (size_t i = 0; i < structure->part_count; i++) {
        const struct plan_part *part = &structure->parts[i];
        if (part->volume) {
            count.one = fabs(mat4_determinant3(part->volume->info.world_from_voxel));
            each_voxel(structure, part->volume, count_side, &count);
        } else if (part->mesh && part->mesh->shape.closed) {
            add_solid_sides(&count, part->mesh);
        }
    }
    memcpy(out, count.sides, sizeof count.sides);
}

conus_status plan_check_sides(const struct plan_constraint *structure, const struct inner_point *inner,
                              const conus_atlas *atlas, uint32_t number)
{
    static const double LEAST_PART = 0.2; /* of the structure, on either side */
    enum { SHOWN = 80 };
    const conus_object *object = &atlas->objects[number - 1];
    char *sides = memory_zeroed(atlas->object_count + 1, 1);
    conus_status status = sides ? conus_atlas_sides(sides, atlas) : CONUS_ERROR_MEMORY;
    struct side_word word;
    bool is_sided = status || sides[number] ||
                    (object->kind != CONUS_KIND_AREA && side_word_find(&word, text_from(object->name), 0));
    bool has_sides = false;
    for (size_t i = 1; i <= atlas->area_count && !status; i++) {
        has_sides = has_sides || sides[i];
    }
    memory_free(sides);
    if (status || is_sided) {
        return status;
    }
    double parts[2];
    double own[3];
    struct midline midline;
    frame_midline(&midline, atlas);
    if (midline.is_unknown) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "%s may lie on both sides: x = 0 is an edge of the atlas's grid, and so it is not known where left "
                    "ends; choose a side by a point of it",
                    object->name);
    }
    plan_sides(parts, structure, &midline, atlas);
    place_by_midline(own, &midline, atlas, inner->at);
    bool is_on_both = fmin(parts[0], parts[1]) >= LEAST_PART * (parts[0] + parts[1]);
    bool is_in_middle = has_sides && fabs(own[0]) < inner->depth / 2;
    if (!is_on_both || is_in_middle) {
        return CONUS_OK;
    }
    bool is_split =
        object->kind == CONUS_KIND_AREA && atlas_parcellation(atlas) && !atlas->half_step && !midline.is_turned;
    char way[2 * SHOWN + 64] = "";
    if (is_split) {
        snprintf(way, sizeof way, "; type --hemispheres split, and as the name \"%.*s left\" or \"%.*s right\"", SHOWN,
                 object->name, SHOWN, object->name);
    } else if (midline.is_ccf) {
        snprintf(way, sizeof way, "; choose one by a point of it");
    }
    const char *unit = midline.is_ccf ? "mm3" : "cm3"; /* of mice, of people */
    const double mm3 = midline.is_ccf ? 1 : 1000;
    return fail(CONUS_ERROR_ARGUMENT, "%s lies on both sides: %.2f %s left, %.2f %s right%s", object->name,
                parts[0] / mm3, unit, parts[1] / mm3, unit, way);
}
