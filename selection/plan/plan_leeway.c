/* SPDX-License-Identifier: BSD-3-Clause */
/* How far the points of an axis may move, each anywhere, until a structure is no longer reached (Eq. 22). What is not
 * the structure begins at its border: faces of cells, triangles. Distances from these are convex along a line. So each
 * is nearer than delta to one interval of the axis, and what all of them leave has the length that is asked for, or
 * not.
 */
#include "selection/plan/plan.h"

#include "atlas/surface/mesh.h"
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "selection/measure/measure.h"
#include "selection/study/study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double RESOLUTION = 1e-6; /* mm of a leeway */
static const double ROUNDING = 1e-12;  /* mm along the axis */
static const double WIDER = 1 + 1e-9;  /* a bound that rounding does not pass */
static const double SKEW = 1e-5;       /* a part of a distance: more than axes that count as perpendicular change */
enum { STEP_LIMIT = 60 };

/* A face of a cell, between low and high corners in voxels; a triangle; or a segment of a streamline. */
struct plan_body {
    double corner[2][3];
    size_t triangle;
    double bound;                   /* mm from its centre to its farthest point */
    double least;                   /* mm: it is no nearer to the needle's line */
    struct plan_span taken, widest; /* where it is nearer than delta, for the last one and for one that is larger */
};

/* The part of the structure that a body takes if it takes nothing. */
static const struct plan_span NOTHING = {INFINITY, -INFINITY};

/* A part of the structure, as the axis sees it. */
struct plan_side {
    const struct plan_part *part;
    struct near_cells cells;     /* of a volume, */
    double start[3], step[3];    /* the axis in its voxels, */
    double edges[4][3];          /* half of a voxel's, mm; the first once more, so that any two are side by side */
    double toward[3];            /* and what an offset of a voxel is along the axis, mm */
    size_t first_body, body_end; /* bodies come one side after the other */
    size_t first_inside, inside_end;
    size_t first_taken, taken_end;
    size_t first_sure, sure_end;
};

void plan_leeway_finish(struct plan_leeway *leeway)
{
    memory_free(leeway->sides);
    memory_free(leeway->bodies);
    memory_free(leeway->inside.items);
    memory_free(leeway->taken.items);
    memory_free(leeway->sure.items);
    memory_free(leeway->left.items);
    *leeway = (struct plan_leeway){0};
}

static conus_status add_span(struct plan_spans *spans, double entry, double exit)
{
    if (!memory_reserve(&spans->items, &spans->capacity, spans->count + 1, sizeof *spans->items)) {
        return CONUS_ERROR_MEMORY;
    }
    spans->items[spans->count++] = (struct plan_span){entry, exit};
    return CONUS_OK;
}

static int by_entry(const void *a, const void *b)
{
    const struct plan_span *x = a;
    const struct plan_span *y = b;
    return compare_double(x->entry, y->entry);
}

/* Sorts spans from `first` on, and joins those that overlap. */
static void join(struct plan_spans *spans, size_t first)
{
    size_t count = first;
    if (spans->count > first) {
        order_sort(spans->items + first, spans->count - first, sizeof *spans->items, by_entry);
    }
    for (size_t i = first; i < spans->count; i++) {
        struct plan_span span = spans->items[i];
        if (count > first && span.entry <= spans->items[count - 1].exit) {
            spans->items[count - 1].exit = fmax(spans->items[count - 1].exit, span.exit);
        } else {
            spans->items[count++] = span;
        }
    }
    spans->count = count;
}

static conus_status add_side(struct plan_leeway *leeway, const struct plan_part *part)
{
    if (!memory_reserve(&leeway->sides, &leeway->side_capacity, leeway->side_count + 1, sizeof *leeway->sides)) {
        return CONUS_ERROR_MEMORY;
    }
    struct plan_side *side = &leeway->sides[leeway->side_count++];
    *side = (struct plan_side){.part = part, .first_inside = leeway->inside.count};
    if (part->volume) {
        near_cells_init(&side->cells, part->volume);
        mat4_point(side->start, part->volume->voxel_from_world, leeway->needle.origin);
        mat4_direction(side->step, part->volume->voxel_from_world, leeway->needle.direction);
        for (int a = 0; a < 3; a++) {
            side->toward[a] = vec3_dot(side->cells.gram[a], side->step);
            vec3_scale(side->edges[a], part->volume->info.world_from_voxel + 4 * a, 0.5);
        }
        memcpy(side->edges[3], side->edges[0], sizeof side->edges[0]);
    }
    return CONUS_OK;
}

static bool is_of(const struct plan_part *part, uint32_t object, const uint32_t *has, const conus_atlas *atlas)
{
    return part->volume ? has[object] && atlas_object_volume(atlas, object) == part->volume : object == part->object;
}

conus_status plan_leeway_ask(struct plan_leeway *leeway, const struct plan_constraint *constraint,
                             const conus_atlas *atlas, const struct layers *layers)
{
    conus_status status = CONUS_OK;
    leeway->has = constraint->has;
    leeway->side_count = 0;
    leeway->inside.count = 0;
    for (size_t i = 0; i < constraint->part_count && !status; i++) {
        const struct plan_part *part = &constraint->parts[i];
        if (part->mesh && !part->mesh->shape.closed) {
            continue; /* it has no inside */
        }
        status = add_side(leeway, part);
        for (size_t k = 0; k < layers->count && !status; k++) {
            const conus_interval *interval = &layers->intervals[k];
            double entry = fmax(interval->entry, leeway->needle.near);
            double exit = fmin(interval->exit, leeway->needle.far);
            if (entry <= exit && is_of(part, interval->object, constraint->has, atlas)) {
                status = add_span(&leeway->inside, entry, exit);
            }
        }
        if (!status) {
            leeway->sides[leeway->side_count - 1].inside_end = leeway->inside.count;
        }
    }
    return status;
}

/* A search for the bodies of one side that are near the needle. */
struct body_search {
    struct plan_leeway *leeway;
    struct needle needle;
    const struct plan_part *part;
    const struct plan_side *side;
    const uint32_t *has;
    double radius;
    conus_status status;
};

/* Adds a body, unless it is surely farther than the radius from the needle. `edge` has the half edges of a rectangle,
 * which limit how far it reaches towards the needle; NULL for another body. */
static conus_status add_body(const struct body_search *search, const struct plan_body *body, const double centre[3],
                             const double (*edge)[3])
{
    struct plan_leeway *leeway = search->leeway;
    const struct needle *needle = &search->needle;
    double away[3];
    double reach = search->radius + body->bound;
    vec3_sub(away, centre, needle->origin);
    double depth = vec3_dot(away, needle->direction);
    vec3_add_scaled(away, away, -depth, needle->direction);
    double beside = vec3_length(away);
    if (beside > reach || depth + reach < needle->near || depth - reach > needle->far) {
        return CONUS_OK;
    }
    double toward = edge ? fabs(vec3_dot(away, edge[0])) + fabs(vec3_dot(away, edge[1])) : body->bound * beside;
    double least = beside > 0 ? beside * (1 - SKEW) - toward / beside : 0;
    if (least > search->radius) {
        return CONUS_OK;
    }
    if (!memory_reserve(&leeway->bodies, &leeway->body_capacity, leeway->body_count + 1, sizeof *leeway->bodies)) {
        return CONUS_ERROR_MEMORY;
    }
    struct plan_body *added = &leeway->bodies[leeway->body_count++];
    double half = sqrt((reach - beside) * (reach + beside)) * WIDER + ROUNDING;
    *added = *body;
    added->least = least;
    added->widest = (struct plan_span){depth - half, depth + half};
    return CONUS_OK;
}

/* Adds the faces of a voxel of the structure, whose linear index is `voxel`, behind which another object is. */
static void add_faces(struct body_search *search, const size_t at[3], size_t voxel)
{
    const struct volume *volume = search->part->volume;
    const size_t *dim = volume->info.dim;
    size_t stride = 1;
    for (int axis = 0; axis < 3; stride *= dim[axis++]) {
        for (int high = 0; high < 2 && !search->status; high++) {
            size_t last = high ? dim[axis] - 1 : 0;
            if (at[axis] != last && search->has[volume_object(volume, high ? voxel + stride : voxel - stride)]) {
                continue;
            }
            struct plan_body body = {.bound = search->side->cells.reach * WIDER};
            double middle[3] = {(double)at[0], (double)at[1], (double)at[2]};
            double centre[3];
            middle[axis] += high - 0.5;
            for (int a = 0; a < 3; a++) {
                body.corner[0][a] = middle[a] - (a == axis ? 0 : 0.5);
                body.corner[1][a] = middle[a] + (a == axis ? 0 : 0.5);
            }
            mat4_point(centre, volume->info.world_from_voxel, middle);
            search->status = add_body(search, &body, centre, search->side->edges + (axis + 1) % 3);
        }
    }
}

static void face_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct body_search *search = user;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    for (size_t i = 0; i < count && !search->status; i++) {
        if (search->has[volume_object(volume, first + i)]) {
            add_faces(search, (const size_t[]){at[0] + i, at[1], at[2]}, first + i);
        }
    }
}

/* The faces between the structure's cells and others. */
static void gather_faces(struct body_search *search)
{
    const struct needle *needle = &search->needle;
    double wide = (search->radius + search->side->cells.reach) * WIDER;
    struct region around = {
        .shape = REGION_CYLINDER, .cosine = 1, .radius = wide, .far = needle->far - needle->near + 2 * wide};
    conus_pose pose;
    needle_point(around.origin, needle, needle->near - wide);
    memcpy(around.axis, needle->direction, sizeof around.axis);
    search->status = conus_pose_along(&pose, around.origin, needle->direction, NULL);
    memcpy(around.right, pose.world_from_device, sizeof around.right);
    memcpy(around.up, pose.world_from_device + 4, sizeof around.up);
    if (!search->status) {
        census_walk(&around, search->part->volume, face_row, search);
    }
}

static void gather_triangles(struct body_search *search)
{
    const struct mesh *mesh = search->part->mesh;
    for (size_t triangle = 0; triangle < mesh->triangle_count && !search->status; triangle++) {
        struct plan_body body = {.triangle = triangle};
        double corner[3][3];
        double centre[3];
        mesh_corners(corner, mesh, triangle);
        for (int a = 0; a < 3; a++) {
            centre[a] = (corner[0][a] + corner[1][a] + corner[2][a]) / 3;
        }
        for (int c = 0; c < 3; c++) {
            vec3_sub(corner[c], corner[c], centre);
            body.bound = fmax(body.bound, vec3_length(corner[c]) * WIDER);
        }
        search->status = add_body(search, &body, centre, NULL);
    }
}

static enum tract_answer is_box_near(void *user, const double low[3], const double high[3])
{
    const struct body_search *search = user;
    struct needle_frame frame;
    double depth;
    needle_frame_init(&frame, &search->needle, NULL);
    return needle_box(&depth, &frame, low, high) > search->radius * WIDER ? TRACT_OUTSIDE : TRACT_PERHAPS;
}

static void add_segments(void *user, const struct tract_run *run, bool inside)
{
    struct body_search *search = user;
    (void)inside;
    if (!tract_group_has(search->part->group, run->streamline)) {
        return;
    }
    uint32_t last = run->segments ? run->segments - 1 : 0; /* a run of one point is a segment of no length */
    for (uint32_t i = 0; i <= last && !search->status; i++) {
        struct plan_body body = {0};
        double centre[3];
        tractogram_point(body.corner[0], search->part->tractogram, run->point + i);
        tractogram_point(body.corner[1], search->part->tractogram, run->point + i + (run->segments ? 1 : 0));
        vec3_sub(centre, body.corner[1], body.corner[0]);
        body.bound = vec3_length(centre) / 2 * WIDER;
        vec3_add_scaled(centre, body.corner[0], 0.5, centre);
        search->status = add_body(search, &body, centre, NULL);
    }
}

/* All bodies that are no farther than `radius` from the needle; of a bundle, whose tubes are the structure, the
 * segments of tubes that the needle passes. */
static conus_status gather(struct plan_leeway *leeway, double radius)
{
    conus_status status = CONUS_OK;
    leeway->body_count = 0;
    for (size_t i = 0; i < leeway->side_count && !status; i++) {
        struct plan_side *side = &leeway->sides[i];
        struct body_search search = {.leeway = leeway,
                                     .needle = leeway->needle,
                                     .part = side->part,
                                     .side = side,
                                     .has = leeway->has,
                                     .radius = radius};
        search.needle.near = INFINITY;
        search.needle.far = 0;
        for (size_t k = side->first_inside; k < side->inside_end; k++) { /* what is beside the rest, takes nothing */
            search.needle.near = fmin(search.needle.near, leeway->inside.items[k].entry);
            search.needle.far = fmax(search.needle.far, leeway->inside.items[k].exit);
        }
        side->first_body = leeway->body_count;
        if (side->first_inside == side->inside_end) { /* the needle is not in it at all */
        } else if (side->part->volume) {
            gather_faces(&search);
        } else if (side->part->mesh) {
            gather_triangles(&search);
        } else {
            search.radius = side->part->tractogram->radius;
            tract_tree_walk(side->part->tractogram, is_box_near, add_segments, &search);
        }
        side->body_end = leeway->body_count;
        status = search.status;
    }
    return status;
}

/* mm from the axis at depth t to a body, and by how much that grows for each mm of depth. */
static double distance_at(double *slope, const struct plan_leeway *leeway, const struct plan_side *side,
                          const struct plan_body *body, double t)
{
    double distance;
    double offset[3];
    double toward; /* the way to the body, along the axis */
    if (side->part->volume) {
        double box[2][3];
        double gram[3][3];
        for (int a = 0; a < 3; a++) {
            double at = side->start[a] + t * side->step[a];
            box[0][a] = body->corner[0][a] - at;
            box[1][a] = body->corner[1][a] - at;
        }
        memcpy(gram, side->cells.gram, sizeof gram);
        distance = near_box(offset, box, gram);
        toward = vec3_dot(offset, side->toward);
    } else {
        struct needle here = leeway->needle;
        double depth;
        double at[3];
        here.near = here.far = t;
        distance = mesh_needle(&depth, offset, side->part->mesh, body->triangle, &here);
        needle_point(at, &here, t);
        vec3_sub(offset, offset, at);
        toward = vec3_dot(offset, here.direction);
    }
    *slope = distance > 0 ? -toward / distance : 0;
    return distance;
}

/* Moves `t`, where a body is delta away or more, forwards (or backwards) to where it is delta away, or to a little
 * before that: tangents never pass the root of a convex function. False where the body is farther everywhere. */
static bool approach(double *t, const struct plan_leeway *leeway, const struct plan_side *side,
                     const struct plan_body *body, double delta, double forwards)
{
    for (int i = 0; i < STEP_LIMIT; i++) {
        double slope;
        double beyond = distance_at(&slope, leeway, side, body, *t) - delta;
        if (beyond <= 0) {
            return true;
        }
        if (slope * forwards >= 0) {
            return false;
        }
        double step = beyond / -(slope * forwards);
        if (step < ROUNDING) {
            return true;
        }
        *t += step * forwards;
    }
    return true;
}

/* Whether some of the needle that is in the side's objects lies between two depths. */
static bool has_inside(const struct plan_leeway *leeway, const struct plan_side *side, double entry, double exit)
{
    for (size_t i = side->first_inside; i < side->inside_end; i++) {
        if (leeway->inside.items[i].entry <= exit && leeway->inside.items[i].exit >= entry) {
            return true;
        }
    }
    return false;
}

static bool is_within(const struct plan_span *inner, const struct plan_span *outer)
{
    return outer->entry <= inner->entry && inner->exit <= outer->exit;
}

/* Adds the span of the axis that is nearer than delta to a body, unless it is covered already; `cover` is a long span
 * that is. */
static conus_status take(struct plan_leeway *leeway, const struct plan_side *side, struct plan_body *body, double delta,
                         struct plan_span *cover)
{
    double entry = body->widest.entry;
    double exit = body->widest.exit;
    body->taken = body->widest;
    if (is_within(&body->widest, cover)) {
        return CONUS_OK;
    }
    body->taken = NOTHING;
    if (body->least <= delta && has_inside(leeway, side, entry, exit) &&
        approach(&entry, leeway, side, body, delta, 1) && approach(&exit, leeway, side, body, delta, -1) &&
        has_inside(leeway, side, entry, exit)) {
        body->taken = (struct plan_span){entry, exit};
        bool is_joined = entry <= cover->exit && cover->entry <= exit;
        *cover = is_joined ? (struct plan_span){fmin(entry, cover->entry), fmax(exit, cover->exit)}
                 : exit - entry > cover->exit - cover->entry ? body->taken
                                                             : *cover;
        return add_span(&leeway->taken, entry, exit);
    }
    return CONUS_OK;
}

/* Adds what of the needle is in the side's objects and delta or more from all of its bodies. */
static conus_status leave(struct plan_leeway *leeway, struct plan_side *side, double delta)
{
    conus_status status = CONUS_OK;
    struct plan_span cover = NOTHING;
    side->first_taken = leeway->taken.count;
    for (size_t i = side->first_sure; i < side->sure_end && !status; i++) {
        status = add_span(&leeway->taken, leeway->sure.items[i].entry, leeway->sure.items[i].exit);
    }
    for (size_t i = side->first_body; i < side->body_end && !status; i++) {
        status = take(leeway, side, &leeway->bodies[i], delta, &cover);
    }
    join(&leeway->taken, side->first_taken);
    side->taken_end = leeway->taken.count;
    for (size_t i = side->first_inside; i < side->inside_end && !status; i++) {
        double from = leeway->inside.items[i].entry;
        double to = leeway->inside.items[i].exit;
        for (size_t k = side->first_taken; k < side->taken_end && from <= to && !status; k++) {
            const struct plan_span *taken = &leeway->taken.items[k];
            if (taken->entry > from) {
                status = add_span(&leeway->left, from, fmin(taken->entry, to));
            }
            from = fmax(from, taken->exit);
        }
        status = status || from > to ? status : add_span(&leeway->left, from, to);
    }
    return status;
}

/* The same of a bundle: a point no farther from a streamline than the radius less delta is delta inside of its tube. */
static conus_status leave_tubes(struct plan_leeway *leeway, const struct plan_side *side, double delta)
{
    conus_status status = CONUS_OK;
    double radius = side->part->tractogram->radius - delta;
    for (size_t i = side->first_body; i < side->body_end && !status && radius > 0; i++) {
        const struct plan_body *body = &leeway->bodies[i];
        double span[2];
        if (capsule_interval(span, leeway->needle.origin, leeway->needle.direction, body->corner[0], body->corner[1],
                             radius)) {
            double entry = fmax(span[0], leeway->needle.near);
            double exit = fmin(span[1], leeway->needle.far);
            status = entry <= exit ? add_span(&leeway->left, entry, exit) : CONUS_OK;
        }
    }
    return status;
}

/* How many contacts are in what is left. */
static double count_left(const struct plan_leeway *leeway)
{
    const conus_contacts *contacts = &leeway->contacts;
    double count = 0;
    for (uint32_t k = 0; k < contacts->count; k++) {
        uint32_t row = k / contacts->columns;
        double depth = leeway->needle.far - contacts->tip - row * contacts->pitch;
        bool is_in = false;
        for (size_t i = 0; i < leeway->left.count && !is_in; i++) {
            is_in = leeway->left.items[i].entry <= depth && depth <= leeway->left.items[i].exit;
        }
        count += is_in;
    }
    return count;
}

/* By how many mm or contacts more than the least is left, where bodies up to delta are gathered. */
static conus_status measure_rest(double *out, struct plan_leeway *leeway, double delta)
{
    conus_status status = CONUS_OK;
    leeway->taken.count = leeway->left.count = 0;
    for (size_t i = 0; i < leeway->side_count && !status; i++) {
        struct plan_side *side = &leeway->sides[i];
        status = side->part->tractogram ? leave_tubes(leeway, side, delta) : leave(leeway, side, delta);
    }
    join(&leeway->left, 0);
    double sum = 0;
    for (size_t i = 0; i < leeway->left.count; i++) {
        sum += leeway->left.items[i].exit - leeway->left.items[i].entry;
    }
    *out = (leeway->contacts.count ? count_left(leeway) : sum) - leeway->least;
    return status;
}

/* An upper bound of the mm that can be left: those that are delta or more from both ends of each stretch in the
 * structure, which are its border except where the needle ends; and, as far as a map shows it, from the rest of the
 * border. */
static double most_left(const struct plan_leeway *leeway, double delta, bool uses_maps)
{
    double sum = 0;
    for (size_t i = 0; i < leeway->side_count; i++) {
        size_t end = leeway->sides[i].inside_end;
        for (size_t k = leeway->sides[i].first_inside; k < end;) {
            struct plan_span span = leeway->inside.items[k++];
            for (; k < end && leeway->inside.items[k].entry <= span.exit + AXIS_TOUCH; k++) {
                span.exit = fmax(span.exit, leeway->inside.items[k].exit);
            }
            double from = span.entry > leeway->needle.near ? span.entry + delta : span.entry;
            double to = span.exit < leeway->needle.far ? span.exit - delta : span.exit;
            const struct plan_map *map = uses_maps ? leeway->sides[i].part->map : NULL;
            sum += map ? plan_map_most(map, &leeway->needle, from, to, delta) : fmax(to - from, 0);
        }
    }
    return sum;
}

conus_status plan_leeway_is(bool *out, struct plan_leeway *leeway, double delta)
{
    if (!leeway->contacts.count && most_left(leeway, delta, leeway->uses_maps) < leeway->least) {
        *out = false;
        return CONUS_OK;
    }
    double rest = 0;
    conus_status status = gather(leeway, delta);
    status = status ? status : measure_rest(&rest, leeway, delta);
    if (!status) {
        *out = rest >= 0;
    }
    return status;
}

/* Two deltas with the root between them. */
struct bracket {
    double low, high;
    double more, less;     /* what is left there beyond the length */
    double first, longest; /* widths: at first, and that it may have now */
};

/* Whether all that a body may still take is taken without it. */
static bool is_settled(const struct plan_leeway *leeway, const struct plan_side *side, const struct plan_body *body)
{
    bool settled = body->widest.entry > body->widest.exit;
    for (size_t i = side->first_sure; i < side->sure_end && !settled; i++) {
        settled = is_within(&body->widest, &leeway->sure.items[i]);
    }
    return settled;
}

/* Narrows what is asked next to deltas above the last one where that left enough (`is_low`), else to those below it:
 * what was taken there is taken from now on, or is the most that is. Bodies that make no difference any more are left
 * out. */
static void narrow(struct plan_leeway *leeway, bool is_low)
{
    size_t count = 0;
    if (is_low) {
        const struct plan_spans sure = leeway->taken;
        leeway->taken = leeway->sure;
        leeway->sure = sure;
    }
    for (size_t s = 0; s < leeway->side_count; s++) {
        struct plan_side *side = &leeway->sides[s];
        bool has_tubes = side->part->tractogram;
        size_t first = count;
        side->first_sure = is_low ? side->first_taken : side->first_sure;
        side->sure_end = is_low ? side->taken_end : side->sure_end;
        for (size_t i = side->first_body; i < side->body_end; i++) {
            struct plan_body body = leeway->bodies[i];
            body.widest = is_low || has_tubes ? body.widest : body.taken;
            if (has_tubes || !is_settled(leeway, side, &body)) {
                leeway->bodies[count++] = body;
            }
        }
        side->first_body = first;
        side->body_end = count;
    }
    leeway->body_count = count;
}

/* Where to look next: a little nearer to the middle than the secant's root, so that it comes to lie on its other side,
 * and so near that one step more than by halves is enough (Oliveira and Takahashi, ACM TOMS 47, 2021). */
static double look_between(const struct bracket *at)
{
    double width = at->high - at->low;
    double middle = (at->low + at->high) / 2;
    double off = at->more > 0 ? middle - at->low - width * at->more / (at->more - at->less) : 0;
    double nudge = 0.2 * width * width / at->first;
    return middle - copysign(fmin(fmax(fabs(off) - nudge, 0), (at->longest - width) / 2), off);
}

conus_status plan_leeway_guess(double *out, struct plan_leeway *leeway, double most)
{
    while (!leeway->contacts.count && most > ROUNDING && most_left(leeway, most, leeway->uses_maps) < leeway->least) {
        most /= 2;
    }
    double rest = -1;
    *out = 0;
    conus_status status = gather(leeway, most);
    while (!status && most > ROUNDING && rest < 0) {
        status = measure_rest(&rest, leeway, most);
        if (!status) {
            narrow(leeway, rest >= 0);
        }
        *out = rest >= 0 ? most : 0;
        most /= 2;
    }
    return status;
}

conus_status plan_leeway_find(double *out, struct plan_leeway *leeway)
{
    /* without maps: where it looks, and so its last digits, are the same with them and without */
    struct bracket at = {.more = leeway->contacts.count ? 1 : most_left(leeway, 0, false) - leeway->least};
    for (size_t i = 0; i < leeway->side_count; i++) {
        const struct plan_part *part = leeway->sides[i].part;
        double size = part->volume ? leeway->sides[i].cells.reach : part->mesh ? 1 : part->tractogram->radius;
        at.high = at.high == 0 ? size : fmin(at.high, size);
    }
    conus_status status = CONUS_OK;
    for (int i = 0; i < STEP_LIMIT && at.less >= 0 && !status; i++) { /* nothing is endless: once, nothing is left */
        status = gather(leeway, at.high);
        status = status ? status : measure_rest(&at.less, leeway, at.high);
        if (!status) {
            narrow(leeway, at.less >= 0);
        }
        if (at.less >= 0) {
            at.more = at.less;
            at.low = at.high;
            at.high *= 2;
        }
    }
    at.first = at.high - at.low;
    at.longest = 2 * at.first;
    while (at.high - at.low > RESOLUTION && !status) {
        double rest = 0;
        double delta = look_between(&at);
        status = measure_rest(&rest, leeway, delta);
        if (!status) {
            narrow(leeway, rest >= 0);
        }
        *(rest >= 0 ? &at.low : &at.high) = delta;
        *(rest >= 0 ? &at.more : &at.less) = rest;
        at.longest /= 2;
    }
    if (!status) {
        *out = at.low;
    }
    return status;
}
