/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Boxes, tetrahedra and other convex polyhedra that planes across an axis cut in two (Eq. 16). */
#ifndef CONUS_BASE_CONVEX_H
#define CONUS_BASE_CONVEX_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** An edge of a face. The edges of a face lie one after the other, in any order, and run round it in one sense; the
 * face beside it has the same edge the other way round. */
struct convex_edge {
    double from[3], to[3];
    uint32_t face;
    bool is_new; /**< Only while a polyhedron is cut. */
};

/** Holds the edges of polyhedra. Those made last are dropped by setting `count` back. */
struct convex_stack {
    struct convex_edge *edges; /**< Owned. */
    size_t count, capacity;
};

struct convex {
    double low[3], high[3]; /**< Bounds. */
    double volume;
    size_t first, count; /**< Edges on the stack; none = it fills its bounds. */
    uint32_t faces;      /**< Larger than the number of any of its faces. */
};

void convex_finish(struct convex_stack *stack);

/** A box with faces across the axes. */
struct convex convex_box(const double low[3], const double high[3]);

/** The tetrahedron of these corners, in either order. False without memory. */
bool convex_tetrahedron(struct convex *out, struct convex_stack *stack, const double corners[4][3]);

/** The image of @p convex under the affine @p m. A box stays one if m maps axes to axes, within 10⁻⁶ over the box.
 * False without memory. */
bool convex_move(struct convex *out, struct convex_stack *stack, const struct convex *convex, const double m[16]);

/** The part of @p convex below @p at along @p axis or, with @p above, above it; `at` is between its bounds. False
 * without memory. */
bool convex_cut(struct convex *out, struct convex_stack *stack, const struct convex *convex, int axis, double at,
                bool above);

#endif
