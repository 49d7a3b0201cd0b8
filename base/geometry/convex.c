/* SPDX-License-Identifier: BSD-3-Clause */
/* Convex polyhedra as the directed edges of their faces: cut by a plane, and measured by a sum over faces. */
#include "base/geometry/math3.h"

#include "base/memory.h"

#include <string.h>

enum { BOX_EDGES = 24, TETRAHEDRON_EDGES = 12 };
static const double BESIDE = 1e-6; /* tolerance of a box's image, relative to the box */

void convex_finish(struct convex_stack *stack)
{
    memory_free(stack->edges);
    *stack = (struct convex_stack){0};
}

static bool reserve(struct convex_stack *stack, size_t count)
{
    return memory_reserve(&stack->edges, &stack->capacity, stack->count + count, sizeof *stack->edges);
}

/* Appends an edge unless it is a point: a face is closed without it. There is space. */
static void push(struct convex_stack *stack, const struct convex_edge *edge)
{
    const double *from = edge->from;
    const double *to = edge->to;
    if (from[0] != to[0] || from[1] != to[1] || from[2] != to[2]) {
        stack->edges[stack->count++] = *edge;
    }
}

static void measure_box(struct convex *box)
{
    box->volume = (box->high[0] - box->low[0]) * (box->high[1] - box->low[1]) * (box->high[2] - box->low[2]);
}

struct convex convex_box(const double low[3], const double high[3])
{
    struct convex box = {.low = {low[0], low[1], low[2]}, .high = {high[0], high[1], high[2]}};
    measure_box(&box);
    return box;
}

/* Whether m takes the box to a box. */
static bool stays_box(const struct convex *box, const double m[16])
{
    for (int row = 0; row < 3; row++) {
        double sum = 0;
        double largest = 0;
        for (int a = 0; a < 3; a++) {
            double moves = fabs(m[4 * a + row]) * (box->high[a] - box->low[a]);
            sum += moves;
            largest = fmax(largest, moves);
        }
        if (sum - largest > BESIDE) {
            return false;
        }
    }
    return true;
}

static struct convex move_box(const struct convex *box, const double m[16])
{
    struct convex out = {0};
    double low[3];
    double high[3];
    mat4_point(low, m, box->low);
    mat4_point(high, m, box->high);
    for (int a = 0; a < 3; a++) {
        out.low[a] = fmin(low[a], high[a]);
        out.high[a] = fmax(low[a], high[a]);
    }
    measure_box(&out);
    return out;
}

/* Corner `corner` of a box: bit a says which end along axis a. */
static void find_corner(double out[3], const struct convex *box, unsigned corner)
{
    for (unsigned a = 0; a < 3; a++) {
        out[a] = corner >> a & 1 ? box->high[a] : box->low[a];
    }
}

/* Appends the edges of a box. There is space. */
static void push_box(struct convex_stack *stack, const struct convex *box)
{
    for (unsigned face = 0; face < 6; face++) {
        unsigned b = 1U << (face / 2 + 1) % 3;
        unsigned c = 1U << (face / 2 + 2) % 3;
        unsigned at = face % 2 << face / 2;
        const unsigned round[] = {at, at | b, at | b | c, at | c};
        for (unsigned k = 0; k < 4; k++) {
            struct convex_edge edge = {.face = face};
            find_corner(face % 2 ? edge.from : edge.to, box, round[k]);
            find_corner(face % 2 ? edge.to : edge.from, box, round[(k + 1) % 4]);
            push(stack, &edge);
        }
    }
}

/* Computes bounds and volume of the polyhedron whose edges are the last on the stack, from out->first on. Each edge
 * makes a tetrahedron with a corner of its face and one of the polyhedron. */
static void measure(struct convex *out, const struct convex_stack *stack)
{
    const struct convex_edge *edges = stack->edges + out->first;
    const double *of_face = NULL;
    double sum = 0;
    out->count = stack->count - out->first;
    for (size_t i = 0; i < out->count; i++) {
        double from[3];
        double to[3];
        double corner[3];
        double cross[3];
        of_face = i == 0 || edges[i].face != edges[i - 1].face ? edges[i].from : of_face;
        vec3_sub(from, edges[i].from, edges[0].from);
        vec3_sub(to, edges[i].to, edges[0].from);
        vec3_sub(corner, of_face, edges[0].from);
        vec3_cross(cross, from, to);
        sum += vec3_dot(corner, cross);
        for (int a = 0; a < 3; a++) {
            out->low[a] = i ? fmin(out->low[a], edges[i].from[a]) : edges[i].from[a];
            out->high[a] = i ? fmax(out->high[a], edges[i].from[a]) : edges[i].from[a];
        }
    }
    out->volume = fabs(sum) / 6;
}

bool convex_tetrahedron(struct convex *out, struct convex_stack *stack, const double corners[4][3])
{
    static const int faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    if (!reserve(stack, TETRAHEDRON_EDGES)) {
        return false;
    }
    struct convex tetrahedron = {.first = stack->count, .faces = 4};
    for (uint32_t face = 0; face < 4; face++) {
        for (int k = 0; k < 3; k++) {
            struct convex_edge edge = {.face = face};
            memcpy(edge.from, corners[faces[face][k]], sizeof edge.from);
            memcpy(edge.to, corners[faces[face][(k + 1) % 3]], sizeof edge.to);
            push(stack, &edge);
        }
    }
    measure(&tetrahedron, stack);
    *out = tetrahedron;
    return true;
}

bool convex_move(struct convex *out, struct convex_stack *stack, const struct convex *convex, const double m[16])
{
    if (!convex->count && stays_box(convex, m)) {
        *out = move_box(convex, m);
        return true;
    }
    if (!reserve(stack, convex->count ? convex->count : BOX_EDGES)) {
        return false;
    }
    struct convex moved = {.first = stack->count, .faces = convex->count ? convex->faces : 6};
    if (!convex->count) {
        push_box(stack, convex);
    }
    for (size_t i = 0; i < convex->count; i++) {
        push(stack, &stack->edges[convex->first + i]);
    }
    for (size_t i = moved.first; i < stack->count; i++) {
        mat4_point(stack->edges[i].from, m, stack->edges[i].from);
        mat4_point(stack->edges[i].to, m, stack->edges[i].to);
    }
    measure(&moved, stack);
    *out = moved;
    return true;
}

/* A plane, and the face under way. */
struct cut {
    int axis;
    double at;
    double side; /* 1 keeps the part above, -1 the part below */
    uint32_t face;
    bool is_crossed; /* The face: here first. */
    double crossing[3];
};

static double height(const struct cut *cut, const double p[3])
{
    return cut->side * (p[cut->axis] - cut->at);
}

/* Where the plane meets the edge between a point that is kept and one that is not: the same for both faces beside it.
 */
static void find_crossing(double out[3], const struct cut *cut, const double kept[3], const double other[3])
{
    double t = height(cut, kept) / (height(cut, kept) - height(cut, other));
    for (int a = 0; a < 3; a++) {
        out[a] = kept[a] + t * (other[a] - kept[a]);
    }
    out[cut->axis] = cut->at;
}

/* Appends the kept part of an edge that the plane meets, and the edge from its end there to the first such end of the
 * face: so the face is closed again, however often the plane meets it by rounding. */
static void cut_edge(struct convex_stack *stack, struct cut *cut, const struct convex_edge *edge, bool begins_kept)
{
    struct convex_edge kept = *edge;
    double *end = begins_kept ? kept.to : kept.from;
    find_crossing(end, cut, begins_kept ? edge->from : edge->to, begins_kept ? edge->to : edge->from);
    push(stack, &kept);
    if (!cut->is_crossed) {
        cut->is_crossed = true;
        memcpy(cut->crossing, end, sizeof cut->crossing);
        return;
    }
    struct convex_edge closing = {.face = edge->face, .is_new = true};
    memcpy(closing.from, begins_kept ? end : cut->crossing, sizeof closing.from);
    memcpy(closing.to, begins_kept ? cut->crossing : end, sizeof closing.to);
    push(stack, &closing);
}

/* Appends the new face: the edges that closed the others, reversed. */
static void close_cut(struct convex_stack *stack, struct convex *out)
{
    size_t end = stack->count;
    for (size_t i = out->first; i < end; i++) {
        struct convex_edge *edge = &stack->edges[i];
        if (edge->is_new) {
            struct convex_edge back = {.face = out->faces};
            edge->is_new = false;
            memcpy(back.from, edge->to, sizeof back.from);
            memcpy(back.to, edge->from, sizeof back.to);
            push(stack, &back);
        }
    }
    out->faces++;
}

bool convex_cut(struct convex *out, struct convex_stack *stack, const struct convex *convex, int axis, double at,
                bool above)
{
    if (!convex->count) {
        *out = *convex;
        (above ? out->low : out->high)[axis] = at;
        measure_box(out);
        return true;
    }
    if (!reserve(stack, 3 * convex->count)) { /* for each edge: its kept part, the one that closes the face, and that
                                                 one reversed */
        return false;
    }
    struct convex part = {.first = stack->count, .faces = convex->faces};
    struct cut cut = {.axis = axis, .at = at, .side = above ? 1 : -1};
    for (size_t i = 0; i < convex->count; i++) {
        const struct convex_edge *edge = &stack->edges[convex->first + i];
        bool begins_kept = height(&cut, edge->from) > 0;
        bool ends_kept = height(&cut, edge->to) > 0;
        cut.is_crossed = cut.is_crossed && edge->face == cut.face;
        cut.face = edge->face;
        if (begins_kept && ends_kept) {
            push(stack, edge);
        } else if (begins_kept || ends_kept) {
            cut_edge(stack, &cut, edge, begins_kept);
        }
    }
    close_cut(stack, &part);
    measure(&part, stack);
    *out = part;
    return true;
}
