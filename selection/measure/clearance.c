/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds where a needle is nearest to each object. */
#include "selection/measure/measure.h"

#include "atlas/surface/mesh.h"
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"

/* Tubes are looked for round the needle, each time so many times as far as before. */
static const double WIDER = 2;
/* Rounding may change a bound by so many mm, and by this part of it. */
static const double ROUNDING = 1e-9;

conus_status clearance_prepare(struct clearance *clearance, const conus_atlas *atlas)
{
    if (clearance->found && clearance->object_count >= atlas->object_count) {
        return CONUS_OK;
    }
    struct clearance larger = {.object_count = atlas->object_count};
    larger.found = memory_raw(atlas->object_count + 1, sizeof *larger.found);
    larger.touched = memory_raw(atlas->object_count + 1, sizeof *larger.touched);
    if (!larger.found || !larger.touched) {
        clearance_finish(&larger);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i <= atlas->object_count; i++) {
        larger.found[i].distance = INFINITY;
    }
    clearance_finish(clearance);
    *clearance = larger;
    return CONUS_OK;
}

void clearance_finish(struct clearance *clearance)
{
    memory_free(clearance->found);
    memory_free(clearance->touched);
    *clearance = (struct clearance){0};
}

/* Bricks in the making, of all objects. */
struct quarry {
    struct clearance_brick *bricks;
    size_t count, capacity;
};

/* Adds voxels of an object in a row to its brick, which is one of those from `first` on, or a new one. */
static conus_status add_run(struct quarry *quarry, size_t first, uint32_t object, const size_t at[3], size_t run)
{
    size_t i = first;
    while (i < quarry->count && quarry->bricks[i].object != object) {
        i++;
    }
    if (i == quarry->count) {
        if (!memory_reserve(&quarry->bricks, &quarry->capacity, i + 1, sizeof *quarry->bricks)) {
            return CONUS_ERROR_MEMORY;
        }
        quarry->count++;
        quarry->bricks[i] = (struct clearance_brick){.object = object, .first = {UINT32_MAX, UINT32_MAX, UINT32_MAX}};
    }
    struct clearance_brick *brick = &quarry->bricks[i];
    for (int a = 0; a < 3; a++) {
        uint32_t low = (uint32_t)at[a];
        uint32_t high = (uint32_t)(at[a] + (a ? 0 : run - 1));
        brick->first[a] = low < brick->first[a] ? low : brick->first[a];
        brick->last[a] = high > brick->last[a] ? high : brick->last[a];
    }
    return CONUS_OK;
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* Adds what is in the cube that begins at a voxel. */
static conus_status add_cube(struct quarry *quarry, const struct volume *volume, const size_t corner[3])
{
    const size_t *dim = volume->info.dim;
    size_t first = quarry->count;
    conus_status status = CONUS_OK;
    for (size_t k = corner[2]; k < smaller(corner[2] + CLEARANCE_BRICK, dim[2]); k++) {
        for (size_t j = corner[1]; j < smaller(corner[1] + CLEARANCE_BRICK, dim[1]); j++) {
            size_t end = smaller(corner[0] + CLEARANCE_BRICK, dim[0]);
            for (size_t i = corner[0]; !status && i < end;) {
                size_t voxel = i + dim[0] * (j + dim[1] * k);
                size_t run = label_run_length(volume, voxel, end - i);
                uint32_t object = volume_object(volume, voxel);
                status = object ? add_run(quarry, first, object, (const size_t[]){i, j, k}, run) : CONUS_OK;
                i += run;
            }
        }
    }
    return status;
}

static conus_status add_volume(struct quarry *quarry, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    conus_status status = CONUS_OK;
    for (size_t k = 0; k < dim[2]; k += CLEARANCE_BRICK) {
        for (size_t j = 0; j < dim[1]; j += CLEARANCE_BRICK) {
            for (size_t i = 0; !status && i < dim[0]; i += CLEARANCE_BRICK) {
                status = add_cube(quarry, volume, (const size_t[]){i, j, k});
            }
        }
    }
    return status;
}

static int by_object(const void *a, const void *b)
{
    const struct clearance_brick *x = a;
    const struct clearance_brick *y = b;
    for (int axis = 2; x->object == y->object && axis >= 0; axis--) {
        if (x->first[axis] != y->first[axis]) {
            return x->first[axis] < y->first[axis] ? -1 : 1;
        }
    }
    return (x->object > y->object) - (x->object < y->object);
}

/* The corners of the cells of a brick, in indices. */
static void corners_of(double low[3], double high[3], const struct clearance_brick *brick)
{
    for (int a = 0; a < 3; a++) {
        low[a] = brick->first[a] - 0.5;
        high[a] = brick->last[a] + 0.5;
    }
}

static uint32_t group_of(const struct clearance_question *question, uint32_t object)
{
    return question->groups ? question->groups[object] : 1;
}

static void add_point(struct clearance_index *index, const double p[3], double reach)
{
    for (int a = 0; a < 3; a++) {
        index->low[a] = fmin(index->low[a], p[a] - reach);
        index->high[a] = fmax(index->high[a], p[a] + reach);
    }
}

/* Makes the tree of the bricks from `first` to before `end`, which are one object's. */
static conus_status stack_bricks(struct clearance_index *index, const struct volume *volume, size_t first, size_t end)
{
    struct bvh_box *boxes = memory_raw(end - first, sizeof *boxes);
    if (!boxes) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = first; i < end; i++) {
        double ends[2][3];
        corners_of(ends[0], ends[1], &index->bricks[i]);
        boxes[i - first].number = (uint32_t)i;
        for (int a = 0; a < 3; a++) {
            boxes[i - first].low[a] = (float)ends[0][a];
            boxes[i - first].high[a] = (float)ends[1][a];
        }
        for (int corner = 0; corner < 8; corner++) {
            double p[3] = {ends[corner & 1][0], ends[corner >> 1 & 1][1], ends[corner >> 2][2]};
            mat4_point(p, volume->info.world_from_voxel, p);
            add_point(index, p, 0);
        }
    }
    conus_status status = bvh_init(&index->trees[index->bricks[first].object], boxes, end - first);
    memory_free(boxes);
    return status;
}

static conus_status index_voxels(struct clearance_index *index, const conus_atlas *atlas)
{
    struct quarry quarry = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(&atlas->volumes[i])) {
            status = add_volume(&quarry, &atlas->volumes[i]);
        }
    }
    index->bricks = quarry.bricks;
    index->brick_count = quarry.count;
    if (!status) {
        order_sort(quarry.bricks, quarry.count, sizeof *quarry.bricks, by_object);
    }
    for (size_t first = 0, end = 0; !status && first < quarry.count; first = end) {
        uint32_t object = quarry.bricks[first].object;
        while (end < quarry.count && quarry.bricks[end].object == object) {
            end++;
        }
        status = stack_bricks(index, &atlas->volumes[atlas->places[object - 1].index], first, end);
    }
    return status;
}

static conus_status grow_tree(struct bvh *out, const struct mesh *mesh)
{
    struct bvh_box *boxes = memory_raw(mesh->triangle_count, sizeof *boxes);
    if (!boxes) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        boxes[i] = bvh_box_empty((uint32_t)i);
        for (size_t c = 0; c < 3; c++) {
            bvh_box_extend(&boxes[i], mesh->positions + 3 * (size_t)mesh->triangles[3 * i + c]);
        }
    }
    conus_status status = bvh_init(out, boxes, mesh->triangle_count);
    memory_free(boxes);
    return status;
}

static conus_status index_object(struct clearance_index *index, const conus_atlas *atlas, uint32_t object)
{
    const struct mesh *mesh = atlas_object_mesh(atlas, object);
    const struct object_place *place = &atlas->places[object - 1];
    if (mesh) {
        add_point(index, mesh->shape.low, 0);
        add_point(index, mesh->shape.high, 0);
        return grow_tree(&index->trees[object], mesh);
    }
    if (place->is_bundle && !place->is_hidden && atlas->tractograms[place->index].point_count) {
        const struct tractogram *tractogram = &atlas->tractograms[place->index];
        add_point(index, tractogram->low, tractogram->radius);
        add_point(index, tractogram->high, tractogram->radius);
    }
    return CONUS_OK;
}

conus_status clearance_index_create(struct clearance_index **out, const conus_atlas *atlas)
{
    struct clearance_index *index = memory_zeroed(1, sizeof *index);
    if (!index) {
        return CONUS_ERROR_MEMORY;
    }
    for (int a = 0; a < 3; a++) {
        index->low[a] = INFINITY;
        index->high[a] = -INFINITY;
    }
    index->object_count = atlas->object_count;
    index->trees = memory_zeroed(atlas->object_count + 1, sizeof *index->trees);
    conus_status status = index->trees ? index_voxels(index, atlas) : CONUS_ERROR_MEMORY;
    for (uint32_t object = 1; !status && object <= atlas->object_count; object++) {
        status = index_object(index, atlas, object);
    }
    if (status) {
        clearance_index_destroy(index);
        return status;
    }
    *out = index;
    return CONUS_OK;
}

void clearance_index_destroy(struct clearance_index *index)
{
    if (index) {
        for (size_t object = 0; index->trees && object <= index->object_count; object++) {
            bvh_finish(&index->trees[object]);
        }
        memory_free(index->bricks);
        memory_free(index->trees);
        memory_free(index);
    }
}

/* A search under way, in one volume, mesh or tractogram. */
struct search {
    struct clearance *clearance;
    const struct clearance_question *question;
    const struct needle *needle;
    struct needle_frame frame; /* of the world, or the volume */
    uint64_t source;
    double radius; /* mm: up to which tubes are looked for */
};

/* Parts that could be nearer than this are searched. */
static double bound_of(const struct search *search, uint32_t group)
{
    double best = search->clearance->found[group].distance;
    return best < search->question->limit ? best : search->question->limit;
}

static bool is_less(const struct clearance_found *a, const struct clearance_found *b)
{
    if (a->distance != b->distance || a->depth != b->depth) {
        return a->distance < b->distance || (a->distance == b->distance && a->depth < b->depth);
    }
    return a->source < b->source || (a->source == b->source && a->part < b->part);
}

/* Keeps a candidate that is the group's least so far. A distance no larger than rounding counts as touching. */
static bool note(const struct search *search, uint32_t group, const struct clearance_found *candidate)
{
    struct clearance *clearance = search->clearance;
    struct clearance_found *found = &clearance->found[group];
    struct clearance_found near = *candidate;
    near.distance = near.distance <= ROUNDING ? 0 : near.distance;
    if (near.distance > search->question->limit || !is_less(&near, found)) {
        return false;
    }
    if (found->distance == INFINITY) {
        clearance->touched[clearance->touched_count++] = group;
    }
    *found = near;
    return true;
}

/* The cells of a volume. */
struct cells {
    struct search search;
    double gram[3][3]; /* dot products of the axes, mm^2 */
    double shrink;     /* distances are no less than this part of those of perpendicular axes, for which it is 1 */
};

/* The least eigenvalue of the gram matrix with axes of unit length is no less than what is left of the discs round its
 * diagonal (Gershgorin), nor than 4/9 of its determinant, since the other two have a product of 9/4 at most. */
static double least_stretch(double gram[3][3])
{
    double c[3];
    double widest = 0;
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3;
        c[a] = fabs(gram[a][b]) / sqrt(gram[a][a] * gram[b][b]);
    }
    for (int a = 0; a < 3; a++) {
        widest = fmax(widest, c[a] + c[(a + 1) % 3]);
    }
    double sign = gram[0][1] * gram[1][2] * gram[2][0] < 0 ? -1 : 1;
    double det = 1 + 2 * sign * c[0] * c[1] * c[2] - c[0] * c[0] - c[1] * c[1] - c[2] * c[2];
    return sqrt(fmax(0, fmax(1 - widest, 4 * det / 9)));
}

static void cells_init(struct cells *out, const struct volume *volume)
{
    const double *m = volume->info.world_from_voxel;
    for (int a = 0; a < 9; a++) {
        double dot = vec3_dot(m + 4 * (a / 3), m + 4 * (a % 3));
        bool is_rounding = fabs(dot) < 1e-13 * vec3_length(m + 4 * (a / 3)) * vec3_length(m + 4 * (a % 3));
        out->gram[a / 3][a % 3] = is_rounding ? 0 : dot;
    }
    out->shrink = least_stretch(out->gram);
}

/* A cell that is no box, and that the needle does not come into: it is nearest to one of its edges, or with one of its
 * ends. `voxel` in indices. */
static void measure_edges(struct clearance_found *out, struct cells *cells, const struct volume *volume,
                          const double voxel[3])
{
    const struct needle *needle = cells->search.needle;
    const double *m = volume->info.world_from_voxel;
    out->distance = INFINITY;
    for (int end = 0; end < 2; end++) {
        double depth = end ? needle->far : needle->near;
        double point[3];
        double at[3];
        double box[2][3];
        double offset[3];
        needle_point(point, needle, depth);
        mat4_point(at, volume->voxel_from_world, point);
        for (int a = 0; a < 3; a++) {
            box[0][a] = voxel[a] - 0.5 - at[a];
            box[1][a] = voxel[a] + 0.5 - at[a];
        }
        double distance = near_box(offset, box, cells->gram);
        if (distance < out->distance) {
            out->distance = distance;
            out->depth = depth;
            mat4_direction(out->point, m, offset);
            vec3_add_scaled(out->point, point, 1, out->point);
        }
    }
    for (int edge = 0; edge < 12; edge++) {
        int axis = edge / 4;
        double ends[2][3];
        double point[3];
        double depth;
        for (int e = 0; e < 2; e++) {
            double corner[3];
            memcpy(corner, voxel, sizeof corner);
            corner[axis] += e - 0.5;
            corner[(axis + 1) % 3] += edge & 1 ? 0.5 : -0.5;
            corner[(axis + 2) % 3] += edge & 2 ? 0.5 : -0.5;
            mat4_point(ends[e], m, corner);
        }
        double distance = needle_segment(&depth, point, needle, ends[0], ends[1]);
        if (distance < out->distance || (distance == out->distance && depth < out->depth)) {
            out->distance = distance;
            out->depth = depth;
            memcpy(out->point, point, sizeof point);
        }
    }
}

/* Looks at the cell of a voxel; false where the search need not look beyond it. */
static bool search_cell(struct cells *cells, const struct volume *volume, uint32_t group, const double voxel[3])
{
    const struct search *search = &cells->search;
    const size_t *dim = volume->info.dim;
    struct clearance_found found = {.source = search->source,
                                    .part = (size_t)voxel[0] + dim[0] * ((size_t)voxel[1] + dim[1] * (size_t)voxel[2])};
    double low[3];
    double high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = voxel[a] - 0.5;
        high[a] = voxel[a] + 0.5;
    }
    found.distance = needle_box(&found.depth, &search->frame, low, high);
    bool is_box = cells->shrink == 1 || found.distance == 0;
    if (!is_box && found.distance * cells->shrink > bound_of(search, group) + ROUNDING) {
        return false;
    }
    if (is_box) {
        for (int a = 0; a < 3; a++) {
            double at = search->frame.at[a] + found.depth * search->frame.step[a];
            found.point[a] = at < low[a] ? low[a] : at > high[a] ? high[a] : at;
        }
        mat4_point(found.point, volume->info.world_from_voxel, found.point);
    } else {
        measure_edges(&found, cells, volume, voxel);
    }
    return note(search, group, &found) || !is_box;
}

/* Looks at voxels of one object in a row, from the nearest one on to both sides: away from it they are farther. */
static void search_run(struct cells *cells, const struct volume *volume, uint32_t group, const size_t at[3],
                       size_t count)
{
    const struct needle_frame *frame = &cells->search.frame;
    double voxel[3] = {(double)at[0], (double)at[1], (double)at[2]};
    double last = voxel[0] + (double)count - 1;
    double low[3];
    double high[3];
    double depth;
    for (int a = 0; a < 3; a++) {
        low[a] = voxel[a] - 0.5;
        high[a] = voxel[a] + (a ? 0.5 : (double)count - 0.5);
    }
    double distance = needle_box(&depth, frame, low, high);
    if (distance * cells->shrink > bound_of(&cells->search, group) + ROUNDING) {
        return;
    }
    double middle = floor(frame->at[0] + depth * frame->step[0] + 0.5);
    middle = middle < voxel[0] ? voxel[0] : middle > last ? last : middle;
    voxel[0] = middle;
    search_cell(cells, volume, group, voxel);
    for (int side = -1; side <= 1; side += 2) {
        voxel[0] = middle + side;
        while (voxel[0] >= (double)at[0] && voxel[0] <= last && search_cell(cells, volume, group, voxel)) {
            voxel[0] += side;
        }
    }
}

static void search_brick(struct cells *cells, const struct volume *volume, uint32_t group,
                         const struct clearance_brick *brick)
{
    const size_t *dim = volume->info.dim;
    for (size_t k = brick->first[2]; k <= brick->last[2]; k++) {
        for (size_t j = brick->first[1]; j <= brick->last[1]; j++) {
            for (size_t i = brick->first[0]; i <= brick->last[0];) {
                size_t voxel = i + dim[0] * (j + dim[1] * k);
                size_t run = label_run_length(volume, voxel, brick->last[0] + 1 - i);
                if (volume_object(volume, voxel) == brick->object) {
                    search_run(cells, volume, group, (const size_t[]){i, j, k}, run);
                }
                i += run;
            }
        }
    }
}

static void search_volume(const struct search *all, size_t number)
{
    const struct clearance_question *question = all->question;
    const conus_atlas *atlas = question->atlas;
    const struct volume *volume = &atlas->volumes[number];
    struct cells cells = {.search = *all};
    cells_init(&cells, volume);
    needle_frame_init(&cells.search.frame, all->needle, volume->voxel_from_world);
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        const struct object_place *place = &atlas->places[object - 1];
        uint32_t group = group_of(question, object);
        if (group && !place->is_mesh && !place->is_bundle && place->index == number) {
            struct bvh_search near;
            uint32_t brick;
            bvh_search_round(&near, &question->index->trees[object], &cells.search.frame);
            while (bvh_search_next(&brick, &near, (bound_of(all, group) + ROUNDING) / cells.shrink)) {
                search_brick(&cells, volume, group, &question->index->bricks[brick]);
            }
        }
    }
}

/* Whether the point is inside a closed surface, as a ray from there says. Another one has no inside: what has one at
 * one place and none beside it would let a leeway promise too much. */
static bool is_inside(const struct bvh *tree, const struct mesh *mesh, const double point[3])
{
    static const double away[3] = {0.48, 0.6, 0.64};
    struct bvh_search search;
    uint32_t triangle;
    int winding = 0;
    bool may_be = mesh->shape.closed;
    for (int a = 0; a < 3; a++) {
        may_be = may_be && point[a] >= mesh->shape.low[a] && point[a] <= mesh->shape.high[a];
    }
    if (!may_be) {
        return false;
    }
    bvh_search_init(&search, tree, point, away);
    while (bvh_search_next(&triangle, &search, INFINITY)) {
        int side = 0;
        if (mesh_is_passed(mesh, triangle, point, away) && mesh_crossing(&side, mesh, triangle, point, away) >= 0) {
            winding += side;
        }
    }
    return winding != 0;
}

static void search_mesh(const struct search *search, const struct mesh *mesh, uint32_t object)
{
    const struct needle *needle = search->needle;
    const struct bvh *tree = &search->question->index->trees[object];
    uint32_t group = group_of(search->question, object);
    struct clearance_found found = {.source = search->source, .depth = needle->near};
    struct bvh_search near;
    uint32_t triangle;
    needle_point(found.point, needle, needle->near);
    if (is_inside(tree, mesh, found.point)) {
        note(search, group, &found);
        return;
    }
    bvh_search_round(&near, tree, &search->frame);
    while (bvh_search_next(&triangle, &near, bound_of(search, group) + ROUNDING)) {
        found.part = triangle;
        found.distance = mesh_needle(&found.depth, found.point, mesh, triangle, needle);
        note(search, group, &found);
    }
}

/* The streamlines of a tractogram. */
struct tubes {
    struct search search;
    const struct tractogram *tractogram;
    const struct tract_owners *owners;
};

static enum tract_answer test_box(void *user, const double low[3], const double high[3])
{
    const struct tubes *tubes = user;
    const struct search *search = &tubes->search;
    double bound = tubes->owners->all ? bound_of(search, group_of(search->question, tubes->owners->all)) : INFINITY;
    double depth;
    double most = fmin(bound, search->radius) + tubes->tractogram->radius + ROUNDING;
    return needle_box(&depth, &tubes->search.frame, low, high) > most ? TRACT_OUTSIDE : TRACT_PERHAPS;
}

/* The tube round a segment: where the needle comes into it, it is 0 mm away from there on. */
static void measure_tube(struct clearance_found *out, const struct tubes *tubes, const double a[3], const double b[3])
{
    const struct needle *needle = tubes->search.needle;
    double radius = tubes->tractogram->radius;
    double at[3];
    double interval[2];
    double distance = needle_segment(&out->depth, out->point, needle, a, b);
    out->distance = distance > radius ? distance - radius : 0;
    if (out->distance == 0 && capsule_interval(interval, needle->origin, needle->direction, a, b, radius) &&
        interval[0] < out->depth) {
        out->depth = interval[0] > needle->near ? interval[0] : needle->near;
    }
    needle_point(at, needle, out->depth);
    vec3_sub(out->point, out->point, at);
    vec3_add_scaled(out->point, at, distance > radius ? out->distance / distance : 0, out->point);
}

static void visit_run(void *user, const struct tract_run *run, bool inside)
{
    struct tubes *tubes = user;
    const struct tract_owners *owners = tubes->owners;
    const conus_atlas *atlas = tubes->search.question->atlas;
    uint64_t first = owners->all ? 0 : owners->first[run->streamline];
    uint64_t end = owners->all ? 1 : owners->first[run->streamline + 1];
    uint32_t segments = run->segments ? run->segments : 1; /* one point is a segment of no length */
    (void)inside;
    for (uint32_t i = 0; i < segments; i++) {
        struct clearance_found found = {.source = tubes->search.source, .part = run->point + i};
        double a[3];
        double b[3];
        tractogram_point(a, tubes->tractogram, run->point + i);
        tractogram_point(b, tubes->tractogram, run->point + i + (run->segments > 0));
        measure_tube(&found, tubes, a, b);
        for (uint64_t k = first; k < end; k++) {
            uint32_t object = owners->all ? owners->all : owners->bundles[k];
            uint32_t group = group_of(tubes->search.question, object);
            if (group && !atlas->places[object - 1].is_hidden) {
                note(&tubes->search, group, &found);
            }
        }
    }
}

/* Whether no bundle of the tractogram can be nearer outside of the radius. */
static bool is_settled(const struct search *search, const struct tractogram *tractogram)
{
    const conus_atlas *atlas = search->question->atlas;
    for (uint32_t object = (uint32_t)atlas->area_count + 1; object <= atlas->object_count; object++) {
        const struct object_place *place = &atlas->places[object - 1];
        uint32_t group = group_of(search->question, object);
        if (place->is_bundle && !place->is_hidden && &atlas->tractograms[place->index] == tractogram && group &&
            search->clearance->found[group].distance > search->radius) {
            return false;
        }
    }
    return true;
}

static void search_tractogram(const struct search *all, const struct tractogram *tractogram,
                              const struct tract_owners *owners)
{
    struct tubes tubes = {.search = *all, .tractogram = tractogram, .owners = owners};
    struct search *search = &tubes.search;
    double limit = search->question->limit;
    double wider = WIDER * tractogram->radius;
    search->radius = -1;
    while (search->radius < limit && !is_settled(search, tractogram)) {
        search->radius = fmin(wider, limit);
        wider *= WIDER;
        tract_tree_walk(tractogram, test_box, visit_run, &tubes);
    }
}

void clearance_take(struct clearance *clearance, const struct clearance_question *question, const struct needle *needle)
{
    const conus_atlas *atlas = question->atlas;
    struct search search = {.clearance = clearance, .question = question, .needle = needle};
    for (size_t i = 0; i < clearance->touched_count; i++) {
        clearance->found[clearance->touched[i]].distance = INFINITY;
    }
    clearance->touched_count = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (volume->info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(volume)) {
            search_volume(&search, i);
        }
        search.source++;
    }
    needle_frame_init(&search.frame, needle, NULL);
    for (uint32_t object = 1; atlas->mesh_count && object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        if (mesh && group_of(question, object)) {
            search_mesh(&search, mesh, object);
        }
        search.source++;
    }
    for (size_t i = 0; question->tracts && i < atlas->tractogram_count; i++) {
        search_tractogram(&search, &atlas->tractograms[i], &question->tracts->of[i]);
        search.source++;
    }
}
