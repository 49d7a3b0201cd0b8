/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the positions of the 10-10 system on a scalp, by curves from landmark to landmark (Eq. 35). */
#include "atlas/surface/mesh.h"

#include "base/memory.h"
#include "base/order.h"

#include <assert.h>
#include <math.h>
#include <string.h>

static const double LANDMARK_FAR = 20, NORMAL_NEAR = 5, SETTLED = 0.01; /* mm */
static const double POINT_FAR = 2;                    /* mm: a section goes through its three points */
static const double HEAD_LEAST = 50, HEAD_MOST = 400; /* mm, from ear to ear and from nasion to inion */
enum { STEPS = 100 };

/* A section through three positions, and the names at its parts. In this order: each needs those above. */
static const struct curve_row {
    const char *through[3];
    size_t parts;
    const char *names[9];
} rows[] = {
    {{"Nz", "Cz", "Iz"}, 10, {"Fpz", "AFz", "Fz", "FCz", NULL, "CPz", "Pz", "POz", "Oz"}},
    {{"LPA", "Cz", "RPA"}, 10, {"T7", "C5", "C3", "C1", NULL, "C2", "C4", "C6", "T8"}},
    {{"Fpz", "T7", "Oz"}, 10, {"Fp1", "AF7", "F7", "FT7", NULL, "TP7", "P7", "PO7", "O1"}},
    {{"Fpz", "T8", "Oz"}, 10, {"Fp2", "AF8", "F8", "FT8", NULL, "TP8", "P8", "PO8", "O2"}},
    {{"F7", "Fz", "F8"}, 8, {"F5", "F3", "F1", NULL, "F2", "F4", "F6"}},
    {{"FT7", "FCz", "FT8"}, 8, {"FC5", "FC3", "FC1", NULL, "FC2", "FC4", "FC6"}},
    {{"TP7", "CPz", "TP8"}, 8, {"CP5", "CP3", "CP1", NULL, "CP2", "CP4", "CP6"}},
    {{"P7", "Pz", "P8"}, 8, {"P5", "P3", "P1", NULL, "P2", "P4", "P6"}},
    {{"AF7", "AFz", "AF8"}, 4, {"AF3", NULL, "AF4"}},
    {{"PO7", "POz", "PO8"}, 4, {"PO3", NULL, "PO4"}},
};

enum { ROWS = sizeof rows / sizeof rows[0], NASION = 0, INION, LEFT, RIGHT, LANDMARKS };

/* A corner of a section: where it crosses an edge, that of two vertices. */
struct corner {
    uint64_t edge;
    size_t segment; /* half of its index among the corners */
    double at[3];
};

/* A closed loop, its first point again at its end. */
struct loop {
    double (*points)[3];
    size_t count, capacity;
};

struct finding {
    conus_scalp *out; /* NULL: positions are only read */
    const struct mesh *mesh;
    uint32_t *first; /* [vertex_count] of mesh_find_first() */
    struct corner *corners;
    size_t corner_count, capacity;
    struct loop loop;
};

static void finding_finish(struct finding *finding)
{
    memory_free(finding->first);
    memory_free(finding->corners);
    memory_free(finding->loop.points);
}

static int compare_edges(const void *a, const void *b)
{
    const struct corner *x = a;
    const struct corner *y = b;
    int order = compare_unsigned(x->edge, y->edge);
    return order ? order : compare_unsigned(x->segment, y->segment);
}

/* Adds the two corners of each triangle that the plane cuts. A vertex in the plane lies a little in front of it. */
static conus_status cut(struct finding *finding, const double from[3], const double normal[3])
{
    const struct mesh *mesh = finding->mesh;
    finding->corner_count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double corner[3][3], height[3];
        mesh_corners(corner, mesh, t);
        for (int k = 0; k < 3; k++) {
            double way[3];
            vec3_sub(way, corner[k], from);
            height[k] = vec3_dot(way, normal);
        }
        const int in_front = (height[0] >= 0) + (height[1] >= 0) + (height[2] >= 0);
        if (in_front == 0 || in_front == 3) {
            continue;
        }
        if (!memory_reserve(&finding->corners, &finding->capacity, finding->corner_count + 2,
                            sizeof *finding->corners)) {
            return CONUS_ERROR_MEMORY;
        }
        const size_t segment = finding->corner_count / 2;
        for (size_t k = 0; k < 3; k++) {
            const size_t next = (k + 1) % 3;
            if ((height[k] >= 0) == (height[next] >= 0)) {
                continue;
            }
            const uint64_t a = finding->first[mesh->triangles[3 * t + k]];
            const uint64_t b = finding->first[mesh->triangles[3 * t + next]];
            struct corner *made = &finding->corners[finding->corner_count++];
            *made = (struct corner){.edge = a < b ? a << 32 | b : b << 32 | a, .segment = segment};
            const double part = height[k] / (height[k] - height[next]);
            for (int c = 0; c < 3; c++) {
                made->at[c] = corner[k][c] + part * (corner[next][c] - corner[k][c]);
            }
        }
    }
    order_sort(finding->corners, finding->corner_count, sizeof *finding->corners, compare_edges);
    return CONUS_OK;
}

/* Follows the section from corner to corner, by the segments that end there, until it is closed. */
static conus_status follow(struct finding *finding, const double through[3])
{
    const size_t count = finding->corner_count;
    size_t(*ends)[2] = memory_raw(count / 2 + 1, sizeof *ends); /* of each segment its corners */
    uint8_t *given = memory_zeroed(count / 2 + 1, sizeof *given);
    size_t start = SIZE_MAX;
    double least = INFINITY;
    bool fits = ends && given;
    for (size_t i = 0; i < count && fits; i++) {
        double way[3];
        ends[finding->corners[i].segment][given[finding->corners[i].segment]++] = i;
        vec3_sub(way, finding->corners[i].at, through);
        start = vec3_length(way) < least ? i : start;
        least = fmin(least, vec3_length(way));
    }
    finding->loop.count = 0;
    for (size_t at = start, steps = 0; at != SIZE_MAX && fits && steps <= count; steps++) {
        const size_t *of = ends[finding->corners[at].segment];
        fits = memory_reserve(&finding->loop.points, &finding->loop.capacity, finding->loop.count + 2,
                              sizeof *finding->loop.points);
        if (fits) {
            memcpy(finding->loop.points[finding->loop.count++], finding->corners[at].at, sizeof(double[3]));
        }
        const size_t far = of[0] == at ? of[1] : of[0];
        const uint64_t edge = finding->corners[far].edge;
        /* the other segment that ends in this edge */
        const size_t next = far + 1 < count && finding->corners[far + 1].edge == edge ? far + 1
                            : far > 0 && finding->corners[far - 1].edge == edge       ? far - 1
                                                                                      : SIZE_MAX;
        at = next == SIZE_MAX || finding->corners[next].edge == finding->corners[start].edge ? SIZE_MAX : next;
    }
    if (fits && finding->loop.count) {
        memcpy(finding->loop.points[finding->loop.count], finding->loop.points[0], sizeof(double[3]));
    }
    memory_free(ends);
    memory_free(given);
    return fits ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* How far along the loop the point of it is that is nearest; *apart: how near. */
static double place_on(double *apart, const struct loop *loop, const double point[3])
{
    double along = 0;
    double found = 0;
    *apart = INFINITY;
    for (size_t i = 0; i < loop->count; i++) {
        double edge[3], way[3], foot[3];
        vec3_sub(edge, loop->points[i + 1], loop->points[i]);
        vec3_sub(way, point, loop->points[i]);
        const double length = vec3_length(edge);
        const double t = length > 0 ? fmin(fmax(vec3_dot(way, edge) / length, 0), length) : 0;
        vec3_add_scaled(foot, way, length > 0 ? -t / length : 0, edge);
        found = vec3_length(foot) < *apart ? along + t : found;
        *apart = fmin(*apart, vec3_length(foot));
        along += length;
    }
    return found;
}

/* The point so far along the loop, from 0 on or below. */
static void point_at(double out[3], const struct loop *loop, double whole, double at)
{
    double along = at - whole * floor(at / whole);
    for (size_t i = 0; i < loop->count && along >= 0; i++) {
        double edge[3];
        vec3_sub(edge, loop->points[i + 1], loop->points[i]);
        const double length = vec3_length(edge);
        vec3_add_scaled(out, loop->points[i], length > 0 ? fmin(along / length, 1) : 0, edge);
        along -= length;
    }
}

/* The section by the plane across which this goes, through so many points: how long it is, and where each is on it. */
static conus_status find_section(double *whole, double at[], struct finding *finding, const char *const names[3],
                                 const double *const points[], size_t count, const double across[3])
{
    double normal[3], apart = 0;
    conus_status status = vec3_normalise(normal, across) ? cut(finding, points[1], normal)
                                                         : fail(CONUS_ERROR_DATA, "scalp: %s, %s and %s lie on a line",
                                                                names[0], names[1], names[2]);
    status = status ? status : follow(finding, points[1]);
    if (status) {
        return status;
    }
    *whole = 0;
    for (size_t i = 0; i < finding->loop.count; i++) {
        double edge[3];
        vec3_sub(edge, finding->loop.points[i + 1], finding->loop.points[i]);
        *whole += vec3_length(edge);
    }
    for (size_t k = 0; k < count; k++) {
        at[k] = place_on(&apart, &finding->loop, points[k]);
        if (!(apart <= POINT_FAR)) {
            return fail(CONUS_ERROR_DATA,
                        "scalp: the section through %s, %s and %s is not one loop through them: is it the outer "
                        "surface of a head, without holes, and are the landmarks its own?",
                        names[0], names[1], names[2]);
        }
    }
    return CONUS_OK;
}

/* The section from a over m to b: where it begins on the loop, and how long it is, below 0 against the loop's way. */
struct arc {
    double start, length, whole;
};

static conus_status find_arc(struct arc *out, struct finding *finding, const char *const names[3],
                             const double *const points[3])
{
    double normal[3], ways[2][3], at[3];
    vec3_sub(ways[0], points[1], points[0]);
    vec3_sub(ways[1], points[2], points[0]);
    vec3_cross(normal, ways[0], ways[1]);
    conus_status status = find_section(&out->whole, at, finding, names, points, 3, normal);
    if (status) {
        return status;
    }
    const double over = fmod(at[1] - at[0] + out->whole, out->whole);
    const double to = fmod(at[2] - at[0] + out->whole, out->whole);
    out->start = at[0];
    out->length = over <= to ? to : to - out->whole;
    return CONUS_OK;
}

static struct scalp_position *add(conus_scalp *scalp, const char *name, const double point[3])
{
    struct scalp_position *made = &scalp->at[scalp->count++];
    *made = (struct scalp_position){.name = name, .point = {point[0], point[1], point[2]}};
    return made;
}

const struct scalp_position *scalp_find(const conus_scalp *scalp, struct text name)
{
    const struct scalp_position *found = NULL;
    for (size_t i = 0; i < scalp->count && !found; i++) {
        found = text_equal_ignoring_case(name, scalp->at[i].name) ? &scalp->at[i] : NULL;
    }
    return found;
}

/* The points between, at equal parts of a row's section. */
static conus_status add_row(struct finding *finding, const struct curve_row *row)
{
    struct arc arc;
    const double *points[3];
    for (int k = 0; k < 3; k++) {
        const struct scalp_position *found = scalp_find(finding->out, text_from(row->through[k]));
        assert(found);
        points[k] = found->point;
    }
    conus_status status = find_arc(&arc, finding, row->through, points);
    for (size_t k = 0; k + 1 < row->parts && !status; k++) {
        double point[3] = {0};
        if (row->names[k]) {
            point_at(point, &finding->loop, arc.whole, arc.start + arc.length * (double)(k + 1) / (double)row->parts);
            add(finding->out, row->names[k], point);
        }
    }
    return status;
}

/* Above the landmarks: the last crossing. */
static conus_status find_top(double out[3], const struct finding *finding, const double landmarks[LANDMARKS][3])
{
    double across[3], forward[3], up[3], middle[3] = {0};
    double farthest = -INFINITY;
    vec3_sub(across, landmarks[RIGHT], landmarks[LEFT]);
    vec3_sub(forward, landmarks[NASION], landmarks[INION]);
    vec3_cross(up, across, forward);
    for (int k = 0; k < LANDMARKS; k++) {
        vec3_add_scaled(middle, middle, 0.25, landmarks[k]);
    }
    if (!vec3_normalise(up, up)) {
        return fail(CONUS_ERROR_DATA, "scalp: the landmarks lie on a line");
    }
    for (size_t t = 0; t < finding->mesh->triangle_count; t++) {
        if (mesh_is_passed(finding->mesh, t, middle, up)) {
            farthest = fmax(farthest, mesh_distance(finding->mesh, t, middle, up));
        }
    }
    vec3_add_scaled(out, middle, farthest, up);
    return farthest > 0 ? CONUS_OK : fail(CONUS_ERROR_DATA, "scalp: there is no surface above the landmarks");
}

/* The point that is the middle of both curves over it. */
static conus_status find_vertex(double out[3], struct finding *finding, const double landmarks[LANDMARKS][3])
{
    static const char *const names[2][3] = {{"Nz", "Cz", "Iz"}, {"LPA", "Cz", "RPA"}};
    double moved = INFINITY;
    conus_status status = find_top(out, finding, landmarks);
    for (int step = 0; !status && moved >= SETTLED; step++) {
        double mean[3] = {0}, next[3], way[3];
        for (int k = 0; k < 2 && !status; k++) {
            struct arc arc;
            double middle[3] = {0};
            const double *const points[3] = {landmarks[k ? LEFT : NASION], out, landmarks[k ? RIGHT : INION]};
            status = find_arc(&arc, finding, names[k], points);
            if (!status) {
                point_at(middle, &finding->loop, arc.whole, arc.start + arc.length / 2);
                vec3_add_scaled(mean, mean, 0.5, middle);
            }
        }
        if (!status) {
            mesh_nearest(next, finding->mesh, mean, INFINITY);
            vec3_sub(way, next, out);
            moved = vec3_length(way);
            memcpy(out, next, sizeof next);
        }
        if (!status && step == STEPS) {
            status = fail(CONUS_ERROR_DATA, "scalp: no point is the middle of both curves over it");
        }
    }
    return status;
}

/* Sets the normals of at most 64 positions: areas of triangles with a corner near, as vectors. */
static conus_status find_normals(struct scalp_position *at, size_t count, const struct mesh *mesh)
{
    uint64_t *near = memory_zeroed(mesh->vertex_count, sizeof *near); /* a bit for each position */
    struct mesh_shape shape = {0};
    conus_status status = near ? mesh_measure(&shape, mesh) : CONUS_ERROR_MEMORY;
    const double side = shape.volume_mm3 < 0 ? -1 : 1; /* of a surface turned inside out */
    if (status) {
        memory_free(near);
        return status;
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *p = mesh->positions + 3 * v;
        for (size_t i = 0; i < count; i++) {
            const double way[3] = {(double)p[0] - at[i].point[0], (double)p[1] - at[i].point[1],
                                   (double)p[2] - at[i].point[2]};
            near[v] |= vec3_dot(way, way) <= NORMAL_NEAR * NORMAL_NEAR ? UINT64_C(1) << i : 0;
        }
    }
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *corners = mesh->triangles + 3 * t;
        double area[3];
        const uint64_t of = near[corners[0]] | near[corners[1]] | near[corners[2]];
        if (of) {
            mesh_normal(area, mesh, t);
        }
        for (size_t i = 0; i < count && of >> i; i++) {
            if (of >> i & 1) {
                vec3_add_scaled(at[i].outward, at[i].outward, side, area);
            }
        }
    }
    memory_free(near);
    for (size_t i = 0; i < count; i++) {
        if (!vec3_normalise(at[i].outward, at[i].outward)) {
            return fail(CONUS_ERROR_DATA, "scalp: %s has no vertex within %g mm: its triangles are too large",
                        at[i].name, NORMAL_NEAR);
        }
    }
    return CONUS_OK;
}

/* The place so far from one point of the loop to another, by the shorter way. */
static conus_status walk(struct scalp_position *out, const struct finding *finding, double whole, const double at[2],
                         const struct scalp_position *from, const struct scalp_position *to, double mm)
{
    const double forward = at[1] - at[0] - whole * floor((at[1] - at[0]) / whole);
    if (!(fmin(forward, whole - forward) < whole / 3)) {
        return fail(
            CONUS_ERROR_ARGUMENT,
            "%s and %s are %.0f and %.0f mm apart on the two ways around the head: a position nearer to %s says "
            "which way",
            from->name, to->name, fmin(forward, whole - forward), fmax(forward, whole - forward), from->name);
    }
    if (!(mm > 0 && mm < whole / 2)) {
        return fail(CONUS_ERROR_ARGUMENT, "%g mm from %s: allowed are above 0, and less than %.0f, half of the section",
                    mm, from->name, whole / 2);
    }
    *out = (struct scalp_position){.name = from->name};
    point_at(out->point, &finding->loop, whole, at[0] + (2 * forward < whole ? mm : -mm));
    return find_normals(out, 1, finding->mesh);
}

/* Across the plane through both that has the mean of their normals in it, as a tape lies. */
static conus_status find_across(double out[3], const struct scalp_position *from, const struct scalp_position *to,
                                const struct mesh *mesh)
{
    struct scalp_position ends[2] = {{.name = from->name}, {.name = to->name}}; /* landmarks have no normals yet */
    memcpy(ends[0].point, from->point, sizeof from->point);
    memcpy(ends[1].point, to->point, sizeof to->point);
    conus_status status = find_normals(ends, 2, mesh);
    double way[3];
    vec3_sub(way, to->point, from->point);
    vec3_add_scaled(ends[0].outward, ends[0].outward, 1, ends[1].outward);
    vec3_cross(out, way, ends[0].outward);
    return status;
}

conus_status scalp_walk(struct scalp_position *out, const conus_scalp *scalp, const struct scalp_position *from,
                        const struct scalp_position *to, double mm)
{
    const char *const names[] = {from->name, to->name, "their normals"};
    struct finding finding = {.mesh = &scalp->mesh};
    struct scalp_position found;
    double whole, across[3], at[2];
    if (from == to) {
        return fail(CONUS_ERROR_ARGUMENT, "%s to %s: two positions are needed", from->name, to->name);
    }
    finding.first = memory_raw(scalp->mesh.vertex_count, sizeof(uint32_t));
    conus_status status = finding.first ? mesh_find_first(finding.first, &scalp->mesh) : CONUS_ERROR_MEMORY;
    status = status ? status : find_across(across, from, to, &scalp->mesh);
    status =
        status ? status
               : find_section(&whole, at, &finding, names, (const double *const[]){from->point, to->point}, 2, across);
    status = status ? status : walk(&found, &finding, whole, at, from, to, mm);
    finding_finish(&finding);
    if (!status) {
        *out = found;
    }
    return status;
}

/* The landmarks, on the surface: where they should be. */
static conus_status add_landmarks(double out[LANDMARKS][3], conus_scalp *scalp, const struct mesh *mesh,
                                  const double landmarks[LANDMARKS][3])
{
    static const char *const names[LANDMARKS] = {"Nz", "Iz", "LPA", "RPA"};
    for (int k = 0; k < LANDMARKS; k++) {
        const double apart = mesh_nearest(out[k], mesh, landmarks[k], INFINITY);
        if (!(apart <= LANDMARK_FAR)) {
            return fail(CONUS_ERROR_DATA, "scalp: %s is %.0f mm from the surface, allowed are %g: are both in RAS mm?",
                        names[k], apart, LANDMARK_FAR);
        }
        add(scalp, names[k], out[k]);
    }
    if (!(out[LEFT][0] < out[RIGHT][0] && out[INION][1] < out[NASION][1])) {
        return fail(CONUS_ERROR_DATA, "scalp: %s: in RAS mm x grows to the right, and y to the front",
                    out[LEFT][0] < out[RIGHT][0] ? "the inion is in front of the nasion"
                                                 : "the left ear (lpa) is on the right of the right one");
    }
    for (int k = 0; k < LANDMARKS; k += 2) {
        double way[3];
        vec3_sub(way, out[k + 1], out[k]);
        const double size = vec3_length(way);
        if (!(size >= HEAD_LEAST && size <= HEAD_MOST)) {
            return fail(CONUS_ERROR_DATA, "scalp: %s and %s are %.3g mm apart, allowed are %g to %g: are they in mm?",
                        names[k], names[k + 1], size, HEAD_LEAST, HEAD_MOST);
        }
        const bool is_across = k == LEFT;
        if (fabs(way[is_across ? 0 : 1]) < size / 2) { /* 60 degrees, as of axes in another order */
            return fail(CONUS_ERROR_DATA, "scalp: %s and %s do not lie along %s: are the landmarks in RAS mm?",
                        names[k], names[k + 1], is_across ? "x, from left to right" : "y, from front to back");
        }
    }
    return CONUS_OK;
}

conus_status scalp_make(conus_scalp *out, struct mesh *taken, const double landmarks[LANDMARKS][3])
{
    const struct mesh *mesh = &out->mesh;
    struct finding finding = {.out = out, .mesh = mesh, .first = memory_raw(taken->vertex_count, sizeof(uint32_t))};
    double on[LANDMARKS][3];
    double vertex[3];
    *out = (conus_scalp){.mesh = *taken};
    *taken = (struct mesh){0};
    conus_status status = !finding.first ? CONUS_ERROR_MEMORY
                          : mesh->shape.closed
                              ? CONUS_OK
                              : fail(CONUS_ERROR_DATA, "scalp: the surface is not closed, which sections need");
    status = status ? status : mesh_find_first(finding.first, mesh);
    status = status ? status : add_landmarks(on, out, mesh, landmarks);
    status = status ? status : find_vertex(vertex, &finding, (const double(*)[3])on);
    if (!status) {
        add(out, "Cz", vertex);
    }
    for (size_t i = 0; i < ROWS && !status; i++) {
        status = add_row(&finding, &rows[i]);
    }
    status = status ? status : find_normals(out->at + LANDMARKS, out->count - LANDMARKS, mesh);
    finding_finish(&finding);
    return status;
}
