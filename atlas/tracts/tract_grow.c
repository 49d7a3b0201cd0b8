/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the tree of a tractogram: cuts its streamlines into runs, halves them at the median of their middles until a
 * leaf has few, and puts boxes around them. Until then runs are stored where their leaves will be, so that no more
 * memory is in use than in the end. */
#include "atlas/tracts/tract_leaf.h"
#include "atlas/tracts/tractogram.h"
#include "base/memory.h"
#include "base/simd/processor.h"
#include "base/threads.h"

#include <assert.h>

/* A run without a place in a leaf yet, of the size that it has there. */
struct item {
    uint16_t middle[3]; /* of its box, in the cube of a range of items */
    uint16_t segments;
    uint32_t point; /* its first one */
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

static double middle(const struct box *box, int axis)
{
    return 0.5 * ((double)box->low[axis] + (double)box->high[axis]);
}

/* A cube that has a box, and how many steps of a middle a mm has there. */
struct cube {
    const float *low;
    double scale;
};

static struct cube cube_of(const struct box *around)
{
    double size = 0;
    for (int a = 0; a < 3; a++) {
        size = fmax(size, (double)around->high[a] - (double)around->low[a]);
    }
    return (struct cube){around->low, size > 0 ? UINT16_MAX / size : 0};
}

/* Gives an item its middle in a cube. */
static inline void frame(struct item *item, const struct tractogram *tractogram, const struct cube *cube)
{
    struct box box = box_of_points(tractogram, item->point, item->segments + 1U);
    for (int a = 0; a < 3; a++) {
        item->middle[a] = (uint16_t)((middle(&box, a) - (double)cube->low[a]) * cube->scale);
    }
}

enum { BLOCK = 128 }; /* points of a streamline that are looked at together */

/* Whether a streamline turns by more than 45 degrees at each of the `count` points from `from` on, at most BLOCK, that
 * have one before them and one behind. */
static void find_sharp(uint32_t *out, const struct tractogram *tractogram, uint64_t from, size_t count)
{
    float at[3][BLOCK + 2];
    assert(count <= BLOCK);
    for (size_t i = 0; i < count + 2; i++) {
        float point[3];
        read_point(point, tractogram, from + i - 1);
        for (int a = 0; a < 3; a++) {
            at[a][i] = point[a];
        }
    }
    for (size_t i = 0; i < count; i++) {
        float squares[2] = {0};
        float dot = 0;
        for (int a = 0; a < 3; a++) {
            float before = at[a][i + 1] - at[a][i];
            float behind = at[a][i + 2] - at[a][i + 1];
            squares[0] += before * before;
            squares[1] += behind * behind;
            dot += before * behind;
        }
        out[i] = (dot < 0) | (2 * dot * dot < squares[0] * squares[1]);
    }
}

/* Cuts streamlines from their first points on, and gives the runs their middles. Where a run of full length ends, a
 * point before or behind is taken instead if the streamline turns sharply there and not here. So runs are slim. */
static void cut(struct item *out, const struct tractogram *tractogram, size_t first, size_t last,
                const struct cube *cube)
{
    uint32_t sharp[BLOCK];
    uint64_t longest = run_length(tractogram);
    for (size_t s = first; s < last; s++) {
        uint64_t begin = tractogram->first[s];
        uint64_t from = begin;
        uint64_t end = tractogram->first[s + 1];
        uint64_t known[2] = {0}; /* points of which `sharp` tells */
        size_t runs = runs_of(end - from, longest);
        for (size_t k = 1; k <= runs; k++) {
            uint64_t to = k < runs ? begin + k * longest : end - 1;
            if (k < runs) {
                uint64_t next = to + 2 < end ? to + 1 : to;
                if (next >= known[1]) {
                    known[0] = to - 1;
                    known[1] = end - 1 - known[0] < BLOCK ? end - 1 : known[0] + BLOCK;
                    find_sharp(sharp, tractogram, known[0], (size_t)(known[1] - known[0]));
                }
                const uint32_t *here = &sharp[to - known[0]];
                if (!here[0]) {
                    to = here[-1] ? to - 1 : here[next - to] ? next : to;
                }
            }
            *out = (struct item){.segments = (uint16_t)(to - from), .point = (uint32_t)from};
            frame(out++, tractogram, cube);
            from = to;
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
        struct cube cube = cube_of(&around);
        for (size_t i = 0; i < count; i++) {
            frame(&items[i], tractogram, &cube);
        }
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

/* Lanes without a run have the first one. */
static void load_runs(struct tract_runs *runs, const struct item *items, size_t count,
                      const struct tractogram *tractogram)
{
    assert(count > 0);
    runs->longest = 1;
    for (size_t lane = 0; lane < count; lane++) {
        uint32_t segments = items[lane].segments;
        runs->longest = segments > runs->longest ? segments : runs->longest;
    }
    for (size_t lane = 0; lane < TRACT_LEAF; lane++) {
        const struct item *item = &items[lane < count ? lane : 0];
        uint32_t segments = item->segments;
        float point[3];
        for (uint32_t k = 0; k < runs->longest; k++) {
            read_point(point, tractogram, item->point + (uint64_t)(k < segments ? k : 0));
            for (int a = 0; a < 3; a++) {
                runs->points[k][a][lane] = point[a];
            }
        }
        read_point(point, tractogram, item->point + (uint64_t)segments);
        for (int a = 0; a < 3; a++) {
            runs->last[a][lane] = point[a];
        }
    }
}

static void set_bends(struct tract_leaf *leaf, const double bends[TRACT_LEAF])
{
    enum { LARGEST = 255 >> TRACT_SEGMENTS_BITS };
    double largest = 0;
    for (size_t lane = 0; lane < leaf->count; lane++) {
        largest = fmax(largest, bends[lane]);
    }
    leaf->thickness = (float)(largest / LARGEST * (1 + TRACT_BEND_SLACK));
    for (size_t lane = 0; lane < leaf->count && leaf->thickness > 0; lane++) {
        double multiple = ceil(bends[lane] / (double)leaf->thickness);
        leaf->bend[lane] |= (uint8_t)((unsigned)multiple << TRACT_SEGMENTS_BITS);
    }
}

static tract_leaf_kernel *fastest_kernel(void)
{
#if defined(__x86_64__)
    if (processor_has_avx2()) {
        return tract_leaf_set_avx2;
    }
#endif
    return tract_leaf_set_plain;
}

/* Makes a leaf of `count` items and returns its hull. */
static struct hull set_leaf(struct tract_leaf *out, const struct item *items, size_t count,
                            const struct tractogram *tractogram, tract_leaf_kernel *kernel)
{
    struct tract_runs runs;
    struct hull hull;
    *out = (struct tract_leaf){.count = (uint32_t)count};
    load_runs(&runs, items, count, tractogram);
    kernel(out, &hull, &runs);
    for (size_t lane = 0; lane < count; lane++) {
        out->point[lane] = items[lane].point;
        out->bend[lane] = (uint8_t)items[lane].segments;
    }
    for (size_t lane = count; lane < TRACT_LEAF; lane++) {
        for (int a = 0; a < 3; a++) {
            out->ends[0][a][lane] = out->ends[1][a][lane] = 0;
        }
    }
    set_bends(out, runs.bends);
    return hull;
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

/* Replaces the items from `first` on by leaves, one by one. */
static void fill_leaves(const struct growing *growing, size_t first, size_t end)
{
    const struct tractogram *tractogram = growing->tractogram;
    const struct item *items = growing->items;
    struct tract_tree *tree = growing->tree;
    tract_leaf_kernel *kernel = fastest_kernel();
    for (size_t from = first; from < end; from += TRACT_LEAF) {
        size_t left = end - from;
        size_t count = left < TRACT_LEAF ? left : TRACT_LEAF;
        for (size_t i = 0; i < count; i++) {
            size_t ahead = from + TRACT_LEAF + i;
            const struct item *item = &items[ahead < end ? ahead : from + i];
            tract_fetch_points(tractogram, item->point, item->segments);
        }
        struct item taken[TRACT_LEAF];
        memcpy(taken, items + from, count * sizeof *taken);
        size_t number = from / TRACT_LEAF;
        struct hull hull = set_leaf(&tree->leaves[number], taken, count, tractogram, kernel);
        set_hull(&tree->nodes[number / TRACT_WIDTH], number % TRACT_WIDTH, &hull);
    }
}

/* Measures the streamlines of a piece. */
static void measure_piece(void *user, size_t piece)
{
    struct growing *growing = user;
    const struct tractogram *tractogram = growing->tractogram;
    size_t first = threads_begin(piece, growing->pieces, tractogram->streamline_count, 1);
    size_t last = threads_begin(piece + 1, growing->pieces, tractogram->streamline_count, 1);
    uint64_t begin = tractogram->first[first];
    growing->runs[piece] = count_runs(tractogram, first, last);
    growing->boxes[piece] = box_of_points(tractogram, begin, tractogram->first[last] - begin);
    for (size_t s = first; s < last; s++) {
        growing->tree->lengths[s] = tractogram_length(tractogram, (uint32_t)s);
    }
}

/* Cuts the streamlines of a piece into runs. */
static void cut_piece(void *user, size_t piece)
{
    const struct growing *growing = user;
    size_t count = growing->tractogram->streamline_count;
    struct cube cube = cube_of(&growing->around);
    cut(growing->items + growing->runs[piece], growing->tractogram, threads_begin(piece, growing->pieces, count, 1),
        threads_begin(piece + 1, growing->pieces, count, 1), &cube);
}

static void fill_piece(void *user, size_t piece)
{
    enum { OF_NODE = TRACT_LEAF * TRACT_WIDTH };
    const struct growing *growing = user;
    size_t count = growing->tree->run_count;
    fill_leaves(growing, threads_begin(piece, growing->pieces, count, OF_NODE),
                threads_begin(piece + 1, growing->pieces, count, OF_NODE));
}

/* The streamline of every TRACT_MARK-th point. */
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
