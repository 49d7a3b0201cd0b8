/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes trees of boxes by halving them at the median, and searches them along rays and round needles. */
#include "atlas/surface/mesh.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

enum { LEAF = 4 };

struct bvh_node {
    float low[3], high[3];
    uint32_t at;    /* A leaf's first one in `numbers`; else the second node below. The first one follows its parent. */
    uint32_t count; /* of a leaf's boxes; 0 = no leaf */
};

struct bvh_box bvh_box_empty(uint32_t number)
{
    return (struct bvh_box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, number};
}

void bvh_box_extend(struct bvh_box *box, const float point[3])
{
    for (int a = 0; a < 3; a++) { /* fminf() and fmaxf() would be calls */
        box->low[a] = point[a] < box->low[a] ? point[a] : box->low[a];
        box->high[a] = point[a] > box->high[a] ? point[a] : box->high[a];
    }
}

struct bvh_box bvh_box_around(const struct bvh_box *boxes, size_t count)
{
    struct bvh_box out = bvh_box_empty(0);
    for (size_t i = 0; i < count; i++) {
        bvh_box_extend(&out, boxes[i].low);
        bvh_box_extend(&out, boxes[i].high);
    }
    return out;
}

int bvh_box_longest_axis(const struct bvh_box *box)
{
    int axis = 0;
    for (int a = 1; a < 3; a++) {
        axis = box->high[a] - box->low[a] > box->high[axis] - box->low[axis] ? a : axis;
    }
    return axis;
}

static float middle(const struct bvh_box *box, int axis)
{
    return box->low[axis] / 2 + box->high[axis] / 2;
}

/* One step of quickselect in boxes[first .. second]: afterwards no middle up to *first is above the pivot, and none
 * from *second on is below it. */
static void part_at(struct bvh_box *boxes, size_t *first, size_t *second, int axis)
{
    size_t i = *first;
    size_t j = *second + 1; /* one more, so that it does not fall below 0 */
    float pivot = middle(&boxes[i + (*second - i) / 2], axis);
    while (i < j) {
        while (middle(&boxes[i], axis) < pivot) {
            i++;
        }
        while (middle(&boxes[j - 1], axis) > pivot) {
            j--;
        }
        if (i < j) {
            struct bvh_box kept = boxes[i];
            boxes[i++] = boxes[j - 1];
            boxes[--j] = kept;
        }
    }
    *first = j; /* one past the lower ones */
    *second = i;
}

void bvh_halve(struct bvh_box *boxes, size_t count, size_t half, int axis)
{
    size_t low = 0;
    size_t high = count - 1;
    while (low < high) {
        size_t lower_end = low;
        size_t upper = high;
        part_at(boxes, &lower_end, &upper, axis);
        if (half < lower_end) {
            high = lower_end - 1;
        } else if (half >= upper) {
            low = upper;
        } else {
            return; /* all middles between them equal the pivot */
        }
    }
}

/* Boxes that will become a node. */
struct range {
    size_t first, count;
    struct bvh_node *parent; /* the node whose second child it is; NULL = it follows its parent, or is the root */
};

/* Makes node after node, each before those below it. With more boxes than fit into a leaf, each half has two or more:
 * so there are never more nodes than boxes. */
static void build(struct bvh_node *nodes, struct bvh_box *boxes, size_t count)
{
    struct range waiting[BVH_DEPTH] = {{.count = count}};
    struct bvh_node *node = nodes;
    for (size_t left = 1; left > 0; node++) {
        struct range range = waiting[--left];
        struct bvh_box box = bvh_box_around(boxes + range.first, range.count);
        bool leaf = range.count <= LEAF;
        memcpy(node->low, box.low, sizeof node->low);
        memcpy(node->high, box.high, sizeof node->high);
        node->at = leaf ? (uint32_t)range.first : 0;
        node->count = leaf ? (uint32_t)range.count : 0;
        if (range.parent) {
            range.parent->at = (uint32_t)(node - nodes);
        }
        if (!leaf) {
            size_t half = range.count / 2;
            bvh_halve(boxes + range.first, range.count, half, bvh_box_longest_axis(&box));
            waiting[left++] = (struct range){range.first + half, range.count - half, node};
            waiting[left++] = (struct range){range.first, half, NULL};
        }
    }
}

conus_status bvh_init(struct bvh *out, struct bvh_box *boxes, size_t count)
{
    struct bvh bvh = {.count = count};
    if (count) {
        bvh.nodes = memory_raw(count, sizeof *bvh.nodes);
        bvh.numbers = memory_raw(count, sizeof *bvh.numbers);
        if (!bvh.nodes || !bvh.numbers) {
            bvh_finish(&bvh);
            return CONUS_ERROR_MEMORY;
        }
        build(bvh.nodes, boxes, count);
    }
    for (size_t i = 0; i < count; i++) {
        bvh.numbers[i] = boxes[i].number;
    }
    *out = bvh;
    return CONUS_OK;
}

void bvh_finish(struct bvh *bvh)
{
    memory_free(bvh->nodes);
    memory_free(bvh->numbers);
    *bvh = (struct bvh){0};
}

static double distance_from(const struct needle_frame *needle, const struct bvh_node *node)
{
    const double low[3] = {(double)node->low[0], (double)node->low[1], (double)node->low[2]};
    const double high[3] = {(double)node->high[0], (double)node->high[1], (double)node->high[2]};
    double depth;
    return needle_box(&depth, needle, low, high);
}

/* Pushes a node if the ray hits its box at @p limit or before. By slabs: where the ray runs along a slab, both of its
 * distances are infinite, or NaN, with which every comparison is false. */
static void add_if_hit(struct bvh_search *search, size_t index, double limit)
{
    const struct bvh_node *node = &search->bvh->nodes[index];
    double enter = 0;
    double leave = limit;
    if (search->needle) {
        enter = distance_from(search->needle, node);
    }
    for (int a = 0; a < 3 && !search->needle; a++) {
        double low = ((double)node->low[a] - search->slack - search->origin[a]) * search->inverse[a];
        double high = ((double)node->high[a] + search->slack - search->origin[a]) * search->inverse[a];
        double near = search->inverse[a] < 0 ? high : low;
        double far = search->inverse[a] < 0 ? low : high;
        enter = near > enter ? near : enter;
        leave = far < leave ? far : leave;
    }
    if (enter <= leave) {
        search->visits[search->waiting++] = (struct bvh_visit){enter, (uint32_t)index};
    }
}

void bvh_search_init(struct bvh_search *out, const struct bvh *bvh, const double origin[3], const double direction[3])
{
    double reach = 0;
    out->bvh = bvh;
    out->needle = NULL;
    out->next = out->end = out->waiting = 0;
    for (int a = 0; a < 3; a++) {
        out->origin[a] = origin[a];
        out->inverse[a] = 1 / direction[a];
        reach = fmax(reach, fabs(origin[a]));
        if (bvh->count) {
            reach = fmax(reach, (double)fmaxf(fabsf(bvh->nodes->low[a]), fabsf(bvh->nodes->high[a])));
        }
    }
    out->slack = BVH_SLACK * reach;
    if (bvh->count) {
        add_if_hit(out, 0, INFINITY);
    }
}

void bvh_search_round(struct bvh_search *out, const struct bvh *bvh, const struct needle_frame *needle)
{
    out->bvh = bvh;
    out->needle = needle;
    out->next = out->end = out->waiting = 0;
    if (bvh->count) {
        add_if_hit(out, 0, INFINITY);
    }
}

/* Pushes the two children of a node, the nearer one last, so that it is visited first. */
static void go_down(struct bvh_search *search, size_t first, size_t second, double limit)
{
    struct bvh_visit *both = search->visits + search->waiting;
    size_t before = search->waiting;
    add_if_hit(search, second, limit);
    add_if_hit(search, first, limit);
    if (search->waiting == before + 2 && both[0].enter < both[1].enter) {
        struct bvh_visit kept = both[0];
        both[0] = both[1];
        both[1] = kept;
    }
}

bool bvh_search_next(uint32_t *number, struct bvh_search *search, double limit)
{
    while (search->next == search->end) {
        if (search->waiting == 0) {
            return false;
        }
        struct bvh_visit visit = search->visits[--search->waiting];
        const struct bvh_node *node = &search->bvh->nodes[visit.node];
        if (visit.enter <= limit && node->count) {
            search->next = node->at;
            search->end = search->next + node->count;
        } else if (visit.enter <= limit) {
            go_down(search, (size_t)visit.node + 1, node->at, limit);
        }
    }
    *number = search->bvh->numbers[search->next++];
    return true;
}
