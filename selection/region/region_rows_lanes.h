/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * Cuts rows of voxels to a region, half of LANES at a time: the body of one instruction set's kernel. Its source
 * defines LANES and KERNEL (the function's name), includes this once, and is compiled with that set's flags. Every
 * kernel gives the same bits. */
#include "base/simd/lanes.h"
#include "selection/region/region.h"

/* The rows under way at t = 0. */
struct start {
    doubles depth, width, across[3];
};

/* The t for which they are in the region; nothing unless `left`. */
struct cut {
    doubles low, high;
    halves left;
};

static INLINE struct start start_at(const struct region_rows *rows, size_t j)
{
    struct start start;
    doubles step = all_doubles((double)j);
    for (int l = 0; l < HALF; l++) {
        step[l] += l;
    }
    start.depth = rows->row.depth[0] + step * rows->column.depth[1];
    start.width = rows->row.width[0] + step * rows->column.width[1];
    EACH_AXIS
    for (int a = 0; a < 3; a++) {
        start.across[a] = rows->row.across[0][a] + step * rows->column.across[1][a];
    }
    return start;
}

static INLINE void raise_low(struct cut *cut, doubles low)
{
    cut->low = choose_doubles(less_doubles(cut->low, low), low, cut->low);
}

static INLINE void lower_high(struct cut *cut, doubles high)
{
    cut->high = choose_doubles(less_doubles(high, cut->high), high, cut->high);
}

/* To a + b t >= 0; `per` is 1 / b. */
static INLINE void clip_half(struct cut *cut, doubles a, double b, double per)
{
    if (b > 0) {
        raise_low(cut, -a * per);
    } else if (b < 0) {
        lower_high(cut, -a * per);
    } else {
        cut->left &= ~less_doubles(a, all_doubles(0));
    }
}

/* The same where b is not one for all. */
static INLINE void clip_halves(struct cut *cut, doubles a, doubles b)
{
    doubles t = -a / b;
    halves rises = less_doubles(all_doubles(0), b);
    halves falls = less_doubles(b, all_doubles(0));
    cut->low = choose_doubles(rises & less_doubles(cut->low, t), t, cut->low);
    cut->high = choose_doubles(falls & less_doubles(t, cut->high), t, cut->high);
    cut->left &= rises | falls | ~less_doubles(a, all_doubles(0));
}

/* Where the width w + width[1] t is 0 or more, to (w + width[1] t)^2 >= |across|^2: what is left is one piece. */
static INLINE void clip_round(struct cut *cut, const struct region_rows *rows, const struct start *start, doubles w)
{
    const struct region_line *row = &rows->row;
    double a = rows->curve;
    doubles b = w * row->width[1];
    doubles c = w * w;
    EACH_AXIS
    for (int i = 0; i < 3; i++) {
        b -= start->across[i] * row->across[1][i];
        c -= start->across[i] * start->across[i];
    }
    if (a == 0) {
        clip_halves(cut, c, 2 * b);
        return;
    }
    doubles d = b * b - a * c;
    halves misses = less_doubles(d, all_doubles(0));
    doubles root = root_of_doubles(choose_doubles(misses, all_doubles(0), d));
    doubles q = choose_doubles(less_doubles(b, all_doubles(0)), root - b, -root - b);
    halves zero = at_most_doubles(q, all_doubles(0)) & at_most_doubles(all_doubles(0), q);
    doubles one = q * rows->per_curve;
    doubles other = choose_doubles(zero, all_doubles(0), c / q);
    halves in_order = less_doubles(one, other);
    doubles low = choose_doubles(in_order, one, other);
    doubles high = choose_doubles(in_order, other, one);
    if (a < 0) {
        cut->left &= ~misses;
        raise_low(cut, low);
        lower_high(cut, high);
    } else if (row->width[1] > 0) {
        raise_low(cut, high);
    } else {
        lower_high(cut, low);
    }
}

static INLINE void clip_square(struct cut *cut, const struct region_rows *rows, const struct start *start, doubles w)
{
    for (int side = 0; side < 4; side++) {
        double sign = side & 1 ? 1 : -1;
        double per_t = rows->row.width[1] + sign * rows->row.across[1][side >> 1];
        clip_half(cut, w + sign * start->across[side >> 1], per_t, 1 / per_t);
    }
}

/* To the region grown by `margin` mm (shrunk where negative). Rounded: a border is met within 1e-7 of the coordinates'
 * size, in mm. */
static INLINE void clip(struct cut *cut, const struct region_rows *rows, const struct start *start, double margin)
{
    const struct region *region = rows->region;
    const double per_t = rows->row.depth[1];
    doubles w = start->width + margin;
    clip_half(cut, start->depth - region->near + margin, per_t, rows->per_depth);
    if (region->far < (double)INFINITY) {
        clip_half(cut, region->far - start->depth + margin, -per_t, -rows->per_depth);
    }
    clip_half(cut, w, rows->row.width[1], rows->per_width);
    if (region->square) {
        clip_square(cut, rows, start, w);
    } else {
        clip_round(cut, rows, start, w);
    }
}

/* First and last whole number of a cut of numbers from 0 on, which it becomes. */
static INLINE void make_whole(uint64_t *first, uint64_t *last, struct cut *cut)
{
    cut->left &= at_most_doubles(cut->low, cut->high);
    cut->low = choose_doubles(cut->left, ceiling_of_doubles(cut->low), all_doubles(1));
    cut->high = choose_doubles(cut->left, floor_of_doubles(cut->high), all_doubles(0));
    store_longs(first, longs_from_doubles(cut->low));
    store_longs(last, longs_from_doubles(cut->high));
}

void KERNEL(struct region_cut *out, const struct region_rows *rows, size_t j, size_t count, const size_t limit[2])
{
    for (size_t r = 0; r < count; r += HALF) {
        struct start start = start_at(rows, j + r);
        struct cut cut = {.low = all_doubles((double)limit[0]), .high = all_doubles((double)limit[1])};
        cut.left = at_most_doubles(all_doubles(0), all_doubles(0));
        clip(&cut, rows, &start, rows->margin);
        make_whole(out->maybe[0] + r, out->maybe[1] + r, &cut);
        clip(&cut, rows, &start, -rows->margin);
        make_whole(out->sure[0] + r, out->sure[1] + r, &cut);
    }
}
