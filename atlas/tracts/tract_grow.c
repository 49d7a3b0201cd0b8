/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the tree of a tractogram: cuts its streamlines into runs, halves them at the median of their middles until a
 * leaf has few, and puts boxes around them. Until then runs are stored where their leaves will be, so that no more
 * memory is in use than in the end. */
#include "atlas/tracts/tract_node.h"
#include "atlas/tracts/tractogram.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/threads.h"

/* Far above the rounding of a run's thickness, which must not be too small. */
#define BEND_SLACK 1e-6

/* A run without a place in a leaf yet, of the size that it has there. */
struct item {
    uint16_t middle[3]; /* of its box, in the cube of a range of items */
    uint16_t segments;
    uint32_t point;
};

_Static_assert(sizeof(struct item) * TRACT_LEAF == sizeof(struct tract_leaf), "runs are where their leaves will be");

/* Streamlines, runs or leaves that are worth a thread of their own. */
enum { WORTH_THREAD = 1 << 14 };

/* Segments of a run: more if points take less memory, so that the tree takes less, too. */
static uint64_t run_length(const struct tractogram *tractogram)
{
    enum { OF_FLOATS = 3, OF_HALVES = 5 };
    return tractogram->halves ? OF_HALVES : OF_FLOATS;
}

static size_t runs_of(uint64_t points, uint64_t longest)
{
    return (size_t)(points < 2 ? points : (points - 1 + longest - 1) / longest);
}

/* Number of runs of the streamlines from `from` to `end` - 1. */
static size_t count_runs(const struct tractogram *tractogram, size_t from, size_t end)
{
    size_t count = 0;
    for (size_t s = from; s < end; s++) {
        count += runs_of(tractogram->first[s + 1] - tractogram->first[s], run_length(tractogram));
    }
    return count;
}

struct box {
    float low[3], high[3];
};

static struct box no_box(void)
{
    return (struct box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

static inline void extend(struct box *box, const float low[3], const float high[3])
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = low[a] < box->low[a] ? low[a] : box->low[a];
        box->high[a] = high[a] > box->high[a] ? high[a] : box->high[a];
    }
}

/* A box, and its extent along its diagonals. */
struct hull {
    struct box box;
    double low[TRACT_DIAGONALS], high[TRACT_DIAGONALS];
};

static struct hull no_hull(void)
{
    struct hull hull = {.box = no_box()};
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        hull.low[d] = INFINITY;
        hull.high[d] = -INFINITY;
    }
    return hull;
}

static inline void extend_hull(struct hull *hull, const struct hull *by)
{
    extend(&hull->box, by->box.low, by->box.high);
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        hull->low[d] = by->low[d] < hull->low[d] ? by->low[d] : hull->low[d];
        hull->high[d] = by->high[d] > hull->high[d] ? by->high[d] : hull->high[d];
    }
}

/* Exact: floats hold halves. */
static inline void read_point(float out[3], const struct tractogram *tractogram, uint64_t index)
{
    for (uint64_t a = 0; a < 3; a++) {
        out[a] = tractogram->points ? tractogram->points[3 * index + a]
                                    : (float)tract_from_half(tractogram->halves[3 * index + a]);
    }
}

/* The box of the `count` points from `from` on. */
static inline struct box box_of_points(const struct tractogram *tractogram, uint64_t from, uint64_t count)
{
    struct box box = no_box();
    for (uint64_t i = from; i < from + count; i++) {
        float point[3];
        read_point(point, tractogram, i);
        extend(&box, point, point);
    }
    return box;
}

static inline struct hull hull_of_points(const struct tractogram *tractogram, uint64_t from, uint64_t count)
{
    struct hull hull = no_hull();
    for (uint64_t i = from; i < from + count; i++) {
        struct hull at;
        read_point(at.box.low, tractogram, i);
        memcpy(at.box.high, at.box.low, sizeof at.box.high);
        for (int d = 0; d < TRACT_DIAGONALS; d++) {
            at.low[d] = 0;
            for (int a = 0; a < 3; a++) {
                at.low[d] += tract_diagonal(d, a) * (double)at.box.low[a];
            }
            at.high[d] = at.low[d];
        }
        extend_hull(&hull, &at);
    }
    return hull;
}

/* Whether a streamline turns by more than 45 degrees at a point that has one before it and one behind it. */
static bool is_sharp(const struct tractogram *tractogram, uint64_t point)
{
    float at[3][3];
    float squares[2] = {0};
    float dot = 0;
    for (uint64_t i = 0; i < 3; i++) {
        read_point(at[i], tractogram, point + i - 1);
    }
    for (int a = 0; a < 3; a++) {
        float before = at[1][a] - at[0][a];
        float behind = at[2][a] - at[1][a];
        squares[0] += before * before;
        squares[1] += behind * behind;
        dot += before * behind;
    }
    return dot < 0 || 2 * dot * dot < squares[0] * squares[1];
}

/* Chooses where to cut near a point that has two before it and one behind it: at a sharp turn next to it, if there is
 * one, so that runs stay slim. */
static uint64_t place_of_cut(const struct tractogram *tractogram, uint64_t point, uint64_t end)
{
    if (is_sharp(tractogram, point)) {
        return point;
    }
    if (is_sharp(tractogram, point - 1)) {
        return point - 1;
    }
    return point + 2 < end && is_sharp(tractogram, point + 1) ? point + 1 : point;
}

/* Cuts streamlines from their first points on. */
static void cut(struct item *out, const struct tractogram *tractogram, size_t first, size_t last)
{
    uint64_t longest = run_length(tractogram);
    for (size_t s = first; s < last; s++) {
        uint64_t from = tractogram->first[s];
        uint64_t end = tractogram->first[s + 1];
        size_t runs = runs_of(end - from, longest);
        for (size_t k = 1; k <= runs; k++) {
            uint64_t to = k < runs ? place_of_cut(tractogram, tractogram->first[s] + k * longest, end) : end - 1;
            *out++ = (struct item){.segments = (uint16_t)(to - from), .point = (uint32_t)from};
            from = to;
        }
    }
}

static double middle(const struct box *box, int axis)
{
    return 0.5 * ((double)box->low[axis] + (double)box->high[axis]);
}

/* Gives items their middles in a cube that has the box round these. */
static void frame(struct item *items, size_t count, const struct tractogram *tractogram, const struct box *around)
{
    double size = 0;
    for (int a = 0; a < 3; a++) {
        size = fmax(size, (double)around->high[a] - (double)around->low[a]);
    }
    double scale = size > 0 ? UINT16_MAX / size : 0;
    for (size_t i = 0; i < count; i++) {
        struct box box = box_of_points(tractogram, items[i].point, items[i].segments + 1U);
        for (int a = 0; a < 3; a++) {
            items[i].middle[a] = (uint16_t)((middle(&box, a) - (double)around->low[a]) * scale);
        }
    }
}

static struct box box_of_middles(const struct item *items, size_t count, const struct tractogram *tractogram)
{
    struct box around = no_box();
    for (size_t i = 0; i < count; i++) {
        struct box box = box_of_points(tractogram, items[i].point, items[i].segments + 1U);
        const float at[3] = {(float)middle(&box, 0), (float)middle(&box, 1), (float)middle(&box, 2)};
        extend(&around, at, at);
    }
    return around;
}

/* The axis with the largest spread of middles, and the spread. */
static int longest_axis(unsigned *size, const struct item *items, size_t count)
{
    uint16_t low[3] = {UINT16_MAX, UINT16_MAX, UINT16_MAX};
    uint16_t high[3] = {0};
    int longest = 0;
    for (size_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            low[a] = items[i].middle[a] < low[a] ? items[i].middle[a] : low[a];
            high[a] = items[i].middle[a] > high[a] ? items[i].middle[a] : high[a];
        }
    }
    for (int a = 1; a < 3; a++) {
        longest = high[a] - low[a] > high[longest] - low[longest] ? a : longest;
    }
    *size = (unsigned)(high[longest] - low[longest]);
    return longest;
}

/* The number at place `half` of the ascending middles: first its high byte, then its low one. */
static unsigned find_median(const struct item *items, size_t count, size_t half, int axis)
{
    enum { BYTE = 256 };
    unsigned found = 0;
    for (unsigned shift = 8; shift <= 8; shift -= 8) {
        size_t counts[BYTE] = {0};
        for (size_t i = 0; i < count; i++) {
            unsigned at = items[i].middle[axis];
            counts[at >> shift & (BYTE - 1)] += shift || at >> 8 == found >> 8;
        }
        unsigned byte = 0;
        for (; half >= counts[byte]; byte++) {
            half -= counts[byte];
        }
        found |= byte << shift;
    }
    return found;
}

/* Moves items from `from` on that are below a limit before the others, up to the place `most`. */
static size_t put_before(struct item *items, size_t from, size_t count, size_t most, int axis, unsigned limit)
{
    size_t place = from;
    for (size_t i = from; i < count && place < most; i++) {
        struct item item = items[i];
        items[i] = items[place];
        items[place] = item;
        place += item.middle[axis] < limit;
    }
    return place;
}

/* Items that are to be arranged, by so many threads. */
struct range {
    struct item *items;
    size_t count;
    const struct tractogram *tractogram;
    size_t threads;
};

static threads_work arrange;

/* Halves runs that are items of one node, down to single leaves. All items but the last one are full. */
static void arrange(void *user, size_t piece)
{
    enum { COARSE = 64 };
    const struct range *range = (const struct range *)user + piece;
    const struct tractogram *tractogram = range->tractogram;
    struct item *items = range->items;
    size_t count = range->count;
    size_t item = TRACT_LEAF;
    if (count <= item) {
        return;
    }
    while (item * TRACT_WIDTH < count) {
        item *= TRACT_WIDTH;
    }
    unsigned size;
    int axis = longest_axis(&size, items, count);
    if (size < COARSE) { /* of all middles; these are in a small part */
        struct box around = box_of_middles(items, count, tractogram);
        frame(items, count, tractogram, &around);
        axis = longest_axis(&size, items, count);
    }
    if (size > 0) {
        size_t half = (count + item - 1) / item / 2 * item;
        unsigned median = find_median(items, count, half, axis);
        size_t place = put_before(items, 0, count, count, axis, median);
        put_before(items, place, count, half, axis, median + 1);
        size_t threads = range->threads / 2;
        struct range halves[] = {{items, half, tractogram, threads},
                                 {items + half, count - half, tractogram, range->threads - threads}};
        if (threads) {
            threads_run(arrange, halves, 2);
        } else {
            arrange(halves, 0);
            arrange(halves, 1);
        }
    }
}

/* The largest distance of the `count` points from a segment. */
static double largest_distance(double points[][3], uint32_t count, const double a[3], const double b[3])
{
    double side[3];
    double way[3];
    double most = 0;
    vec3_sub(side, b, a);
    double squared = vec3_dot(side, side);
    double inverse = squared > 0 ? 1 / squared : 0;
    for (uint32_t k = 0; k < count; k++) {
        vec3_sub(way, points[k], a);
        double along = vec3_dot(way, side) * inverse;
        vec3_add_scaled(way, way, -(along < 0 ? 0 : along > 1 ? 1 : along), side);
        double square = vec3_dot(way, way);
        most = square > most ? square : most;
    }
    return sqrt(most);
}

/* Half the vector from the chord of a run to its farthest point, if no other point is on the other side: a segment
 * moved so far is half as far from all of them. */
static void find_shift(double out[3], double points[][3], uint32_t segments)
{
    double away[TRACT_RUN][3];
    double side[3];
    double most = 0;
    uint32_t farthest = 0;
    vec3_sub(side, points[segments], points[0]);
    double squared = vec3_dot(side, side);
    double inverse = squared > 0 ? 1 / squared : 0;
    for (uint32_t k = 1; k < segments && squared > 0; k++) {
        vec3_sub(away[k], points[k], points[0]);
        vec3_add_scaled(away[k], away[k], -vec3_dot(away[k], side) * inverse, side);
        double square = vec3_dot(away[k], away[k]);
        farthest = square > most ? k : farthest;
        most = square > most ? square : most;
    }
    vec3_scale(out, side, 0);
    if (farthest) {
        vec3_scale(out, away[farthest], 0.5);
    }
    for (uint32_t k = 1; k < segments && farthest; k++) {
        if (vec3_dot(away[k], away[farthest]) < 0) {
            vec3_scale(out, side, 0);
        }
    }
}

static uint8_t byte_of(double coordinate, double low, double step)
{
    double at = step > 0 ? (coordinate - low) / step + 0.5 : 0;
    return (uint8_t)(at > 0 ? at < UINT8_MAX ? at : UINT8_MAX : 0);
}

/* Sets a run's ends. Returns the run's distance from the segment between them, and that of the ends themselves beyond
 * rounding. */
static double set_ends(struct tract_leaf *leaf, size_t lane, const struct tractogram *tractogram)
{
    double points[TRACT_RUN + 1][3];
    double ends[2][3];
    double shift[3];
    double off[3];
    double largest = 0;
    uint32_t segments = tract_leaf_segments(leaf, lane);
    for (uint32_t k = 0; k <= segments; k++) {
        tractogram_point(points[k], tractogram, leaf->point[lane] + (uint64_t)k);
    }
    find_shift(shift, points, segments);
    for (uint32_t e = 0; e < 2; e++) {
        const double *point = points[e * segments];
        for (int a = 0; a < 3; a++) {
            leaf->ends[e][a][lane] = byte_of(point[a] + shift[a], (double)leaf->low[a], (double)leaf->step[a]);
            ends[e][a] = (double)leaf->low[a] + leaf->ends[e][a][lane] * (double)leaf->step[a];
        }
        vec3_sub(off, point, ends[e]);
        largest = fmax(largest, vec3_length(off) - tract_leaf_rounding(leaf));
    }
    return fmax(largest, largest_distance(points, segments + 1, ends[0], ends[1])) * (1 + BEND_SLACK);
}

static void set_bends(struct tract_leaf *leaf, const double bends[TRACT_LEAF])
{
    enum { LARGEST = 255 >> TRACT_SEGMENTS_BITS };
    double largest = 0;
    for (size_t lane = 0; lane < leaf->count; lane++) {
        largest = fmax(largest, bends[lane]);
    }
    leaf->thickness = (float)(largest / LARGEST * (1 + BEND_SLACK));
    for (size_t lane = 0; lane < leaf->count && leaf->thickness > 0; lane++) {
        double multiple = ceil(bends[lane] / (double)leaf->thickness);
        leaf->bend[lane] |= (uint8_t)((unsigned)multiple << TRACT_SEGMENTS_BITS);
    }
}

/* Makes a leaf of `count` items and returns its hull. */
static struct hull set_leaf(struct tract_leaf *out, const struct item *items, size_t count,
                            const struct tractogram *tractogram)
{
    struct hull around = no_hull();
    double bends[TRACT_LEAF] = {0};
    *out = (struct tract_leaf){.count = (uint32_t)count};
    for (size_t lane = 0; lane < count; lane++) {
        struct hull hull = hull_of_points(tractogram, items[lane].point, items[lane].segments + 1U);
        extend_hull(&around, &hull);
        out->point[lane] = items[lane].point;
        out->bend[lane] = (uint8_t)items[lane].segments;
    }
    for (int a = 0; a < 3; a++) {
        out->low[a] = around.box.low[a];
        out->step[a] = (float)(((double)around.box.high[a] - (double)around.box.low[a]) / UINT8_MAX);
    }
    for (size_t lane = 0; lane < count; lane++) {
        bends[lane] = set_ends(out, lane, tractogram);
    }
    set_bends(out, bends);
    return around;
}

/* Prefetches the points of a run. */
static void fetch_points(const struct tractogram *tractogram, const struct item *item)
{
    const char *from = tractogram->points ? (const char *)(tractogram->points + 3 * (uint64_t)item->point)
                                          : (const char *)(tractogram->halves + 3 * (uint64_t)item->point);
    size_t size = 3 * item->segments * (tractogram->points ? sizeof(float) : sizeof(uint16_t));
    __builtin_prefetch(from);
    __builtin_prefetch(from + size);
}

/* The place of the low corner of a lane's box along a diagonal. Returns the length of all diagonals. */
static double find_corner(double *low, const struct tract_node *node, size_t lane, int diagonal)
{
    double length = 0;
    *low = 0;
    for (int a = 0; a < 3; a++) {
        length += (double)node->high[a][lane] - (double)node->low[a][lane];
        *low += tract_diagonal(diagonal, a) > 0 ? (double)node->low[a][lane] : -(double)node->high[a][lane];
    }
    return length;
}

static void set_hull(struct tract_node *node, size_t lane, const struct hull *hull)
{
    for (int a = 0; a < 3; a++) {
        node->low[a][lane] = hull->box.low[a];
        node->high[a][lane] = hull->box.high[a];
    }
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        double low;
        double length = find_corner(&low, node, lane, d);
        double empty[2] = {hull->low[d] - low, low + length - hull->high[d]};
        for (int e = 0; e < 2; e++) {
            double share = length > 0 ? floor(empty[e] / length * TRACT_CUTS) : 0;
            node->cut[e][d][lane] = (uint8_t)(share > 0 ? fmin(share, UINT8_MAX) : 0);
        }
    }
}

static struct hull hull_of_lane(const struct tract_node *node, size_t lane)
{
    struct hull hull;
    for (int a = 0; a < 3; a++) {
        hull.box.low[a] = node->low[a][lane];
        hull.box.high[a] = node->high[a][lane];
    }
    for (int d = 0; d < TRACT_DIAGONALS; d++) {
        double low;
        double length = find_corner(&low, node, lane, d);
        hull.low[d] = low + length * node->cut[0][d][lane] / TRACT_CUTS;
        hull.high[d] = low + length - length * node->cut[1][d][lane] / TRACT_CUTS;
    }
    return hull;
}

static struct hull hull_of_lanes(const struct tract_node *node, size_t count)
{
    struct hull hull = no_hull();
    for (size_t lane = 0; lane < count; lane++) {
        struct hull of_lane = hull_of_lane(node, lane);
        extend_hull(&hull, &of_lane);
    }
    return hull;
}

/* Replaces the items from `first` on by leaves, one by one. */
static void fill_leaves(struct tract_tree *tree, const struct item *items, const struct tractogram *tractogram,
                        size_t first, size_t end)
{
    for (size_t from = first; from < end; from += TRACT_LEAF) {
        size_t left = end - from;
        size_t count = left < TRACT_LEAF ? left : TRACT_LEAF;
        for (size_t i = 0; i < count; i++) {
            size_t ahead = from + TRACT_LEAF + i;
            fetch_points(tractogram, &items[ahead < end ? ahead : from + i]);
        }
        struct item taken[TRACT_LEAF];
        memcpy(taken, items + from, count * sizeof *taken);
        size_t number = from / TRACT_LEAF;
        struct hull hull = set_leaf(&tree->leaves[number], taken, count, tractogram);
        set_hull(&tree->nodes[number / TRACT_WIDTH], number % TRACT_WIDTH, &hull);
    }
}

/* A tree under way. Pieces of streamlines and of runs are worked on at once. */
struct growing {
    struct tractogram *tractogram;
    struct tract_tree *tree;
    struct item *items;
    struct box around;              /* of all points */
    size_t pieces;                  /* how many there are */
    struct box boxes[THREADS_MOST]; /* of the points of each */
    size_t runs[THREADS_MOST];      /* the first one of each */
};

/* Measures the streamlines of a piece. */
static void measure_piece(void *user, size_t piece)
{
    struct growing *growing = user;
    const struct tractogram *tractogram = growing->tractogram;
    size_t first = threads_begin(piece, growing->pieces, tractogram->streamline_count, 1);
    size_t last = threads_begin(piece + 1, growing->pieces, tractogram->streamline_count, 1);
    uint64_t point = tractogram->first[first];
    growing->runs[piece] = count_runs(tractogram, first, last);
    growing->boxes[piece] = box_of_points(tractogram, point, tractogram->first[last] - point);
    for (size_t s = first; s < last; s++) {
        growing->tree->lengths[s] = tractogram_length(tractogram, (uint32_t)s);
    }
}

/* Cuts the streamlines of a piece into runs. */
static void cut_piece(void *user, size_t piece)
{
    const struct growing *growing = user;
    size_t count = growing->tractogram->streamline_count;
    cut(growing->items + growing->runs[piece], growing->tractogram, threads_begin(piece, growing->pieces, count, 1),
        threads_begin(piece + 1, growing->pieces, count, 1));
}

static void frame_piece(void *user, size_t piece)
{
    const struct growing *growing = user;
    size_t first = threads_begin(piece, growing->pieces, growing->tree->run_count, 1);
    size_t end = threads_begin(piece + 1, growing->pieces, growing->tree->run_count, 1);
    frame(growing->items + first, end - first, growing->tractogram, &growing->around);
}

static void fill_piece(void *user, size_t piece)
{
    enum { OF_NODE = TRACT_LEAF * TRACT_WIDTH };
    const struct growing *growing = user;
    size_t count = growing->tree->run_count;
    fill_leaves(growing->tree, growing->items, growing->tractogram,
                threads_begin(piece, growing->pieces, count, OF_NODE),
                threads_begin(piece + 1, growing->pieces, count, OF_NODE));
}

static void fill_marks(uint32_t *out, const struct tractogram *tractogram)
{
    uint64_t next = 0;
    for (size_t s = 0; s < tractogram->streamline_count; s++) {
        for (; next < tractogram->first[s + 1]; next += TRACT_MARK) {
            *out++ = (uint32_t)s;
        }
    }
}

/* Makes leaves and nodes, for which there is memory. */
static void grow(struct growing *growing, const struct tract_levels *levels)
{
    struct tractogram *tractogram = growing->tractogram;
    struct tract_tree *tree = growing->tree;
    size_t runs = 0;
    growing->around = no_box();
    growing->pieces = threads_for(tractogram->streamline_count, WORTH_THREAD);
    threads_run(measure_piece, growing, growing->pieces);
    for (size_t i = 0; i < growing->pieces; i++) {
        size_t count = growing->runs[i];
        growing->runs[i] = runs;
        runs += count;
        extend(&growing->around, growing->boxes[i].low, growing->boxes[i].high);
    }
    for (int a = 0; a < 3; a++) {
        tractogram->low[a] = (double)growing->around.low[a];
        tractogram->high[a] = (double)growing->around.high[a];
    }
    threads_run(cut_piece, growing, growing->pieces);
    growing->pieces = threads_for(tree->run_count, WORTH_THREAD);
    threads_run(frame_piece, growing, growing->pieces);
    struct range all = {growing->items, tree->run_count, tractogram, growing->pieces};
    arrange(&all, 0);
    threads_run(fill_piece, growing, growing->pieces);
    for (unsigned level = 1; level < levels->count; level++) {
        for (size_t i = 0; i < levels->items[level]; i++) {
            size_t left = levels->items[level - 1] - i * TRACT_WIDTH;
            struct hull hull =
                hull_of_lanes(&tree->nodes[levels->first[level - 1] + i], left < TRACT_WIDTH ? left : TRACT_WIDTH);
            set_hull(&tree->nodes[levels->first[level] + i / TRACT_WIDTH], i % TRACT_WIDTH, &hull);
        }
    }
}

conus_status tractogram_grow_tree(struct tractogram *tractogram)
{
    if (tractogram->point_count > UINT32_MAX) {
        return fail(CONUS_ERROR_DATA, "points of streamlines: found %llu, at most %u are allowed",
                    (unsigned long long)tractogram->point_count, UINT32_MAX);
    }
    struct tract_tree tree = {.run_count = count_runs(tractogram, 0, tractogram->streamline_count)};
    struct tract_levels levels = tract_levels_of(tree.run_count);
    tree.node_count = levels.node_count;
    tree.nodes = memory_zeroed(tree.node_count, sizeof *tree.nodes);
    tree.leaves = memory_raw(tract_leaf_count(tree.run_count), sizeof *tree.leaves);
    tree.marks = memory_raw(tract_mark_count(tractogram->point_count), sizeof *tree.marks);
    tree.lengths = memory_raw(tractogram->streamline_count, sizeof *tree.lengths);
    if (!tree.nodes || !tree.leaves || !tree.marks || !tree.lengths) {
        tract_tree_finish(&tree);
        return CONUS_ERROR_MEMORY;
    }
    struct growing growing = {.tractogram = tractogram, .tree = &tree, .items = (void *)tree.leaves};
    fill_marks(tree.marks, tractogram);
    grow(&growing, &levels);
    tractogram->tree = tree;
    return CONUS_OK;
}
