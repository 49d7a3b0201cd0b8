/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the tree of a tractogram: cuts its streamlines into runs, halves their boxes at the median until a node has
 * few, and puts boxes round them. At most 81 bytes a run are in use on the way. */
#include "atlas/surface/bvh.h"
#include "atlas/tracts/tract_node.h"
#include "atlas/tracts/tractogram.h"
#include "base/math3.h"
#include "base/memory.h"

/* Far above what rounding makes of a run's thickness, which has to be no less than it is. */
#define BEND_SLACK 1e-6

/* ---- Runs ------------------------------------------------------------------------------------------------------- */

static uint64_t points_of(const struct tractogram *tractogram, size_t streamline)
{
    return tractogram->first[streamline + 1] - tractogram->first[streamline];
}

static size_t runs_of(uint64_t points)
{
    return (size_t)(points < 2 ? points : (points - 1 + TRACT_RUN - 1) / TRACT_RUN);
}

static size_t count_runs(const struct tractogram *tractogram)
{
    size_t count = 0;
    for (size_t s = 0; s < tractogram->streamline_count; s++) {
        count += runs_of(points_of(tractogram, s));
    }
    return count;
}

/* Cuts all streamlines from their first points on. */
static void cut(struct tract_run *out, const struct tractogram *tractogram)
{
    for (size_t s = 0; s < tractogram->streamline_count; s++) {
        uint64_t segments = points_of(tractogram, s) - 1; /* wraps where there is no point, and so no run */
        size_t runs = runs_of(segments + 1);
        for (size_t r = 0; r < runs; r++) {
            uint64_t done = r * TRACT_RUN;
            uint64_t left = segments - done;
            *out++ = (struct tract_run){tractogram->first[s] + done, (uint32_t)s,
                                        (uint32_t)(left < TRACT_RUN ? left : TRACT_RUN)};
        }
    }
}

static struct bvh_box box_of_run(const struct tractogram *tractogram, const struct tract_run *run, size_t number)
{
    struct bvh_box box = bvh_box_empty((uint32_t)number);
    for (uint32_t k = 0; k <= run->segments; k++) {
        double point[3];
        tractogram_point(point, tractogram, run->point + k);
        bvh_box_extend(&box, (float[3]){(float)point[0], (float)point[1], (float)point[2]});
    }
    return box;
}

/* ---- Order ------------------------------------------------------------------------------------------------------ */

/* Halves runs that are items of one node, down to single nodes above level 0. All items but the last one are full. */
static void arrange(struct bvh_box *boxes, size_t count)
{
    size_t item = 1;
    while (item * TRACT_WIDTH < count) {
        item *= TRACT_WIDTH;
    }
    if (item > 1) {
        size_t half = (count + item - 1) / item / 2 * item;
        struct bvh_box around = bvh_box_around(boxes, count);
        bvh_halve(boxes, count, half, bvh_box_longest_axis(&around));
        arrange(boxes, half);
        arrange(boxes + half, count - half);
    }
}

/* ---- Nodes ------------------------------------------------------------------------------------------------------ */

static float round_up(double thickness)
{
    return (float)(thickness * (1 + BEND_SLACK));
}

/* From the nearest point of a segment to @p point. */
static void way_from_segment(double out[3], const double point[3], const double a[3], const double b[3])
{
    double side[3];
    vec3_sub(side, b, a);
    vec3_sub(out, point, a);
    double squared = vec3_dot(side, side);
    double along = squared > 0 ? vec3_dot(out, side) / squared : 0;
    vec3_add_scaled(out, out, -(along < 0 ? 0 : along > 1 ? 1 : along), side);
}

/* The largest distance of points from a segment, and the mean way from it to them. */
static double measure_bend(double mean[3], double (*points)[3], size_t count, const double a[3], const double b[3])
{
    double largest = 0;
    memset(mean, 0, 3 * sizeof *mean);
    for (size_t k = 0; k < count; k++) {
        double way[3];
        way_from_segment(way, points[k], a, b);
        largest = fmax(largest, vec3_length(way));
        vec3_add_scaled(mean, mean, 1.0 / (double)count, way);
    }
    return largest;
}

static double fine_thickness(double (*points)[3], size_t count)
{
    double largest = 0;
    for (size_t k = 2; k < count; k += 2) {
        double unused[3];
        largest = fmax(largest, measure_bend(unused, points + k - 1, 1, points[k - 2], points[k]));
    }
    return largest;
}

static size_t take_points(double (*out)[3], const struct tractogram *tractogram, const struct tract_run *run)
{
    for (uint32_t k = 0; k <= run->segments; k++) {
        tractogram_point(out[k], tractogram, run->point + k);
    }
    return run->segments + 1;
}

/* The segment between the run's ends; or one to which both sides of a run that is bent to one side are as near. */
static void set_run(struct tract_node *node, size_t lane, const struct tractogram *tractogram,
                    const struct tract_run *run)
{
    static const double shift[] = {0, 0.75}; /* of an arc: its mean is at 2/3 of its height, the middle at 1/2 */
    double points[TRACT_RUN + 1][3];
    double mean[3] = {0};
    double thickness = INFINITY;
    size_t count = take_points(points, tractogram, run);
    for (int k = 0; k < 2; k++) {
        double ends[2][3];
        double bend[3];
        for (int a = 0; a < 3; a++) {
            ends[0][a] = (double)(float)(points[0][a] + shift[k] * mean[a]);
            ends[1][a] = (double)(float)(points[count - 1][a] + shift[k] * mean[a]);
        }
        double largest = measure_bend(bend, points, count, ends[0], ends[1]);
        for (int a = 0; a < 3 && largest < thickness; a++) {
            node->a[a][lane] = (float)ends[0][a];
            node->b[a][lane] = (float)ends[1][a];
        }
        thickness = fmin(thickness, largest);
        memcpy(mean, bend, sizeof mean);
    }
    node->thickness[lane] = round_up(thickness);
    node->fine[lane] = round_up(fine_thickness(points, count));
}

static void set_box(struct tract_node *node, size_t lane, const struct bvh_box *box)
{
    for (int a = 0; a < 3; a++) {
        node->a[a][lane] = box->low[a];
        node->b[a][lane] = box->high[a];
    }
}

static struct bvh_box box_of_items(const struct tract_node *node, size_t count)
{
    struct bvh_box box = bvh_box_empty(0);
    for (size_t lane = 0; lane < count; lane++) {
        bvh_box_extend(&box, (float[3]){node->a[0][lane], node->a[1][lane], node->a[2][lane]});
        bvh_box_extend(&box, (float[3]){node->b[0][lane], node->b[1][lane], node->b[2][lane]});
    }
    return box;
}

/* The box of an item above level 0. */
static struct bvh_box box_of_item(const struct tract_tree *tree, const struct tract_levels *levels,
                                  const struct bvh_box *boxes, unsigned level, size_t item)
{
    size_t first = item * TRACT_WIDTH;
    size_t left = levels->items[level - 1] - first;
    size_t count = left < TRACT_WIDTH ? left : TRACT_WIDTH;
    return level == 1 ? bvh_box_around(boxes + first, count)
                      : box_of_items(&tree->nodes[levels->first[level - 1] + item], count);
}

/* Or the processor would wait for each run's. */
static void fetch_points(const struct tractogram *tractogram, const struct tract_run *run)
{
    enum { LINE = 64 };
    const char *from = tractogram->points ? (const char *)(tractogram->points + 3 * run->point)
                                          : (const char *)(tractogram->halves + 3 * run->point);
    size_t size = 3 * (run->segments + 1) * (tractogram->points ? sizeof(float) : sizeof(uint16_t));
    for (size_t at = 0; at < size; at += LINE) {
        __builtin_prefetch(from + at);
    }
}

/* Level by level: the nodes above the items of each are the items of the next. */
static void fill_nodes(const struct tract_tree *tree, const struct tract_levels *levels, const struct bvh_box *boxes,
                       const struct tractogram *tractogram)
{
    enum { AHEAD = 8 };
    for (size_t i = 0; i < tree->run_count; i++) {
        fetch_points(tractogram, &tree->runs[i + AHEAD < tree->run_count ? i + AHEAD : i]);
        set_run(&tree->nodes[i / TRACT_WIDTH], i % TRACT_WIDTH, tractogram, &tree->runs[i]);
    }
    for (unsigned level = 1; level < levels->count; level++) {
        for (size_t i = 0; i < levels->items[level]; i++) {
            struct bvh_box box = box_of_item(tree, levels, boxes, level, i);
            set_box(&tree->nodes[levels->first[level] + i / TRACT_WIDTH], i % TRACT_WIDTH, &box);
        }
    }
}

/* Makes the boxes of all runs, in the order of the leaves, and puts the runs in that order. */
static conus_status order_runs(struct bvh_box *boxes, struct tract_run **runs, size_t count,
                               const struct tractogram *tractogram)
{
    struct tract_run *ordered = memory_raw(count, sizeof *ordered);
    if (!ordered) {
        return CONUS_ERROR_MEMORY;
    }
    cut(*runs, tractogram);
    for (size_t i = 0; i < count; i++) {
        boxes[i] = box_of_run(tractogram, &(*runs)[i], i);
    }
    arrange(boxes, count);
    for (size_t i = 0; i < count; i++) {
        ordered[i] = (*runs)[boxes[i].number];
    }
    memory_free(*runs);
    *runs = ordered;
    return CONUS_OK;
}

static void keep_bounds(struct tractogram *tractogram, const struct bvh_box *boxes, size_t count)
{
    struct bvh_box around = bvh_box_around(boxes, count);
    for (int a = 0; a < 3; a++) {
        tractogram->low[a] = (double)around.low[a];
        tractogram->high[a] = (double)around.high[a];
    }
}

conus_status tractogram_grow_tree(struct tractogram *tractogram)
{
    size_t count = count_runs(tractogram);
    if (count > UINT32_MAX) {
        return fail(CONUS_ERROR_MEMORY, "%zu runs of %d segments, at most %u are allowed", count, TRACT_RUN,
                    UINT32_MAX);
    }
    struct tract_levels levels = tract_levels_of(count);
    struct bvh_box *boxes = memory_raw(count, sizeof *boxes);
    struct tract_run *runs = memory_raw(count, sizeof *runs);
    conus_status status = boxes && runs ? order_runs(boxes, &runs, count, tractogram) : CONUS_ERROR_MEMORY;
    struct tract_node *nodes = status ? NULL : memory_zeroed(levels.node_count, sizeof *nodes);
    if (!nodes) {
        memory_free(boxes);
        memory_free(runs);
        return CONUS_ERROR_MEMORY;
    }
    tractogram->tree = (struct tract_tree){nodes, levels.node_count, runs, count};
    fill_nodes(&tractogram->tree, &levels, boxes, tractogram);
    keep_bounds(tractogram, boxes, count);
    memory_free(boxes);
    return CONUS_OK;
}
