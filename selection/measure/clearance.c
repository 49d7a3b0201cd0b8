/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds where a needle is nearest to each object. */
#include "selection/measure/clearance.h"

#include "atlas/surface/mesh_near.h"
#include "atlas/tracts/capsule.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "selection/measure/census.h"
#include "selection/measure/near.h"

/* Distances are looked for in cylinders round the needle, each so many times as wide as the one before. */
static const double WIDER = 2;
/* What rounding may do to a bound, mm, and as a part of it. */
static const double ROUNDING = 1e-9;

conus_status clearance_prepare(struct clearance *clearance, const conus_atlas *atlas)
{
    if (clearance->found && clearance->object_count >= atlas->object_count) {
        return CONUS_OK;
    }
    struct clearance larger = {.object_count = atlas->object_count};
    larger.found = memory_raw(atlas->object_count + 1, sizeof *larger.found);
    larger.touched = memory_raw(atlas->object_count + 1, sizeof *larger.touched);
    larger.open = memory_raw(atlas->object_count + 1, sizeof *larger.open);
    if (!larger.found || !larger.touched || !larger.open) {
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
    memory_free(clearance->open);
    *clearance = (struct clearance){0};
}

static void include(struct census_box *box, const struct census_box *other)
{
    for (int a = 0; a < 3; a++) {
        box->first[a] = other->first[a] < box->first[a] ? other->first[a] : box->first[a];
        box->last[a] = other->last[a] > box->last[a] ? other->last[a] : box->last[a];
    }
}

static const struct census_box EMPTY = {.first = {SIZE_MAX, SIZE_MAX, SIZE_MAX}};

/* The corners of the cells of a box, in indices. */
static void corners_of(double low[3], double high[3], const struct census_box *box)
{
    for (int a = 0; a < 3; a++) {
        low[a] = (double)box->first[a] - 0.5;
        high[a] = (double)box->last[a] + 0.5;
    }
}

static void box_voxels(struct clearance_index *index, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    for (size_t row = 0; row < dim[1] * dim[2]; row++) {
        for (size_t i = 0; i < dim[0];) {
            uint32_t object = volume_object(volume, row * dim[0] + i);
            size_t run = label_run_length(volume, row * dim[0] + i, dim[0] - i);
            if (object) {
                size_t j = row % dim[1];
                size_t k = row / dim[1];
                include(&index->boxes[object], &(struct census_box){{i, j, k}, {i + run - 1, j, k}});
            }
            i += run;
        }
    }
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

/* Whether the object has voxels that can be near: those of volumes[index] of its place. */
static bool has_voxels(const conus_atlas *atlas, uint32_t object)
{
    const struct object_place *place = &atlas->places[object - 1];
    return !place->is_mesh && !place->is_bundle && !place->is_hidden && atlas->objects[object - 1].voxels;
}

static void add_point(struct clearance_index *index, const double p[3], double reach)
{
    for (int a = 0; a < 3; a++) {
        index->low[a] = fmin(index->low[a], p[a] - reach);
        index->high[a] = fmax(index->high[a], p[a] + reach);
    }
}

static void add_object(struct clearance_index *index, const conus_atlas *atlas, uint32_t object)
{
    const struct mesh *mesh = atlas_object_mesh(atlas, object);
    const struct object_place *place = &atlas->places[object - 1];
    if (has_voxels(atlas, object) && index->boxes[object].first[0] <= index->boxes[object].last[0]) {
        double ends[2][3];
        corners_of(ends[0], ends[1], &index->boxes[object]);
        for (int corner = 0; corner < 8; corner++) {
            double p[3] = {ends[corner & 1][0], ends[corner >> 1 & 1][1], ends[corner >> 2][2]};
            mat4_point(p, atlas->volumes[place->index].info.world_from_voxel, p);
            add_point(index, p, 0);
        }
    } else if (mesh) {
        add_point(index, mesh->shape.low, 0);
        add_point(index, mesh->shape.high, 0);
    } else if (place->is_bundle && !place->is_hidden && atlas->tractograms[place->index].point_count) {
        const struct tractogram *tractogram = &atlas->tractograms[place->index];
        add_point(index, tractogram->low, tractogram->radius);
        add_point(index, tractogram->high, tractogram->radius);
    }
}

conus_status clearance_index_create(struct clearance_index **out, const conus_atlas *atlas)
{
    struct clearance_index *index = memory_zeroed(1, sizeof *index);
    conus_status status = index ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (index) {
        index->object_count = atlas->object_count;
        index->boxes = memory_raw(atlas->object_count + 1, sizeof *index->boxes);
        index->trees = memory_zeroed(atlas->object_count + 1, sizeof *index->trees);
        status = index->boxes && index->trees ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    for (size_t object = 0; !status && object <= atlas->object_count; object++) {
        index->boxes[object] = EMPTY;
    }
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(&atlas->volumes[i])) {
            box_voxels(index, &atlas->volumes[i]);
        }
    }
    for (int a = 0; !status && a < 3; a++) {
        index->low[a] = INFINITY;
        index->high[a] = -INFINITY;
    }
    for (uint32_t object = 1; !status && object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        add_object(index, atlas, object);
        status = mesh ? grow_tree(&index->trees[object], mesh) : CONUS_OK;
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
        memory_free(index->boxes);
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
    double settled; /* mm: groups within it are found, -1 = none is */
    double radius;  /* mm: up to which it goes */
};

/* What could be nearer than this is looked at. */
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

/* Whether it is the group's least so far. */
static bool note(const struct search *search, uint32_t group, const struct clearance_found *candidate)
{
    struct clearance *clearance = search->clearance;
    struct clearance_found *found = &clearance->found[group];
    if (candidate->distance > search->question->limit || !is_less(candidate, found)) {
        return false;
    }
    if (found->distance == INFINITY) {
        clearance->touched[clearance->touched_count++] = group;
    }
    *found = *candidate;
    return true;
}

/* The cells of a volume. */
struct cells {
    struct search search;
    double gram[3][3]; /* dot products of the axes, mm^2 */
    double shrink;     /* distances are no less than this part of those of perpendicular axes, for which it is 1 */
    double reach;      /* from a cell's centre to its farthest corner, mm */
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
    struct near_cells rounded;
    near_cells_init(&rounded, volume);
    for (int a = 0; a < 9; a++) {
        double dot = vec3_dot(m + 4 * (a / 3), m + 4 * (a % 3));
        bool is_rounding = fabs(dot) < 1e-13 * vec3_length(m + 4 * (a / 3)) * vec3_length(m + 4 * (a % 3));
        out->gram[a / 3][a % 3] = is_rounding ? 0 : dot;
    }
    out->reach = rounded.reach * (1 + 1e-5);
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

/* Looks at the cell of a voxel; false where it is none to be looked beyond. */
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
    for (double i = middle - 1; i >= (double)at[0]; i--) {
        voxel[0] = i;
        if (!search_cell(cells, volume, group, voxel)) {
            break;
        }
    }
    for (double i = middle + 1; i <= last; i++) {
        voxel[0] = i;
        if (!search_cell(cells, volume, group, voxel)) {
            break;
        }
    }
}

static void search_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct cells *cells = user;
    const struct search *search = &cells->search;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    for (size_t done = 0; done < count;) {
        uint32_t group = search->question->groups[volume_object(volume, first + done)];
        size_t run = label_run_length(volume, first + done, count - done);
        if (group && search->clearance->found[group].distance > search->settled) {
            search_run(cells, volume, group, (const size_t[]){at[0] + done, at[1], at[2]}, run);
        }
        done += run;
    }
}

/* The cylinder that has all points no farther than `reach` from the needle. */
static struct region region_round(const struct needle *needle, double reach)
{
    const double *axis = needle->direction;
    struct region region = {.shape = REGION_CYLINDER, .cosine = 1, .radius = reach};
    int least = fabs(axis[0]) <= fabs(axis[1]) ? 0 : 1;
    least = fabs(axis[least]) <= fabs(axis[2]) ? least : 2;
    double other[3] = {least == 0, least == 1, least == 2};
    memcpy(region.axis, axis, sizeof region.axis);
    vec3_cross(region.right, axis, other);
    vec3_normalise(region.right, region.right);
    vec3_cross(region.up, region.right, axis);
    needle_point(region.origin, needle, needle->near - reach);
    region.far = needle->far - needle->near + 2 * reach;
    return region;
}

/* Lists the objects of a volume that may be within the limit. Returns how many. */
static size_t list_open(const struct cells *cells, const struct volume *volume)
{
    const struct search *search = &cells->search;
    const struct clearance_question *question = search->question;
    const conus_atlas *atlas = question->atlas;
    size_t count = 0;
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        uint32_t group = question->groups[object];
        if (group && has_voxels(atlas, object) && &atlas->volumes[atlas->places[object - 1].index] == volume) {
            double low[3];
            double high[3];
            double depth;
            corners_of(low, high, &question->index->boxes[object]);
            double bound = cells->shrink * needle_box(&depth, &search->frame, low, high) - ROUNDING;
            if (bound <= bound_of(search, group)) {
                search->clearance->open[count++] = (struct clearance_open){object, bound};
            }
        }
    }
    return count;
}

/* Drops what is found, or cannot be nearer than what is. Returns how many are left, and in `box` all voxels of those
 * that may be within the radius of the search. */
static size_t drop_settled(struct census_box *box, const struct search *search, size_t count)
{
    const struct clearance_question *question = search->question;
    struct clearance_open *open = search->clearance->open;
    size_t left = 0;
    *box = EMPTY;
    for (size_t i = 0; i < count; i++) {
        double found = search->clearance->found[question->groups[open[i].object]].distance;
        if (found > search->settled && found >= open[i].bound) {
            open[left++] = open[i];
            if (open[i].bound <= search->radius) {
                include(box, &question->index->boxes[open[i].object]);
            }
        }
    }
    return left;
}

static void search_volume(const struct search *all, const struct volume *volume)
{
    struct cells cells = {.search = *all};
    struct search *search = &cells.search;
    struct census_box box;
    double limit = search->question->limit;
    cells_init(&cells, volume);
    needle_frame_init(&search->frame, search->needle, volume->voxel_from_world);
    search->settled = -1;
    search->radius = fmin(WIDER * cells.reach, limit);
    size_t open = list_open(&cells, volume);
    while ((open = drop_settled(&box, search, open)) > 0) {
        struct region region = region_round(search->needle, (search->radius + cells.reach) * (1 + ROUNDING) + ROUNDING);
        census_walk_box(&region, volume, &box, search_row, &cells);
        if (search->radius >= limit) {
            break;
        }
        search->settled = search->radius;
        search->radius = fmin(WIDER * search->radius, limit);
    }
}

/* Whether the surface winds around the point: of a closed one as a ray from there says. */
static bool is_inside(const struct bvh *tree, const struct mesh *mesh, const double point[3])
{
    static const double away[3] = {0.48, 0.6, 0.64};
    struct bvh_search search;
    uint32_t triangle;
    int winding = 0;
    for (int a = 0; a < 3; a++) {
        if (point[a] < mesh->shape.low[a] || point[a] > mesh->shape.high[a]) {
            return false;
        }
    }
    if (!mesh->shape.closed) {
        return fabs(mesh_winding(mesh, point)) >= 0.5;
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
    uint32_t group = search->question->groups[object];
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
    double bound = tubes->owners->all ? bound_of(search, search->question->groups[tubes->owners->all]) : INFINITY;
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
            uint32_t group = tubes->search.question->groups[object];
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
        uint32_t group = search->question->groups[object];
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
    for (search->radius = -1; search->radius < limit && !is_settled(search, tractogram); wider *= WIDER) {
        search->radius = fmin(wider, limit);
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
            search_volume(&search, volume);
        }
        search.source++;
    }
    needle_frame_init(&search.frame, needle, NULL);
    for (uint32_t object = 1; atlas->mesh_count && object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, object);
        if (mesh && question->groups[object]) {
            search_mesh(&search, mesh, object);
        }
        search.source++;
    }
    for (size_t i = 0; question->tracts && i < atlas->tractogram_count; i++) {
        search_tractogram(&search, &atlas->tractograms[i], &question->tracts->of[i]);
        search.source++;
    }
}
