/* SPDX-License-Identifier: BSD-3-Clause */
/* Puts balls round the leaves of a tractogram's tree, and packs their runs for shaders. */
#include "render/id/tract_clusters.h"

#include "atlas/tracts/tract_start.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

struct box {
    double low[3], high[3];
};

static struct box no_box(void)
{
    return (struct box){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

/* The box round the points of a leaf, as the node above it has it. */
static struct box box_of_leaf(const struct tract_tree *tree, size_t number)
{
    const struct tract_node *node = &tree->nodes[number / TRACT_WIDTH]; /* those above leaves come first */
    struct box box;
    for (int a = 0; a < 3; a++) {
        box.low[a] = (double)node->low[a][number % TRACT_WIDTH];
        box.high[a] = (double)node->high[a][number % TRACT_WIDTH];
    }
    return box;
}

static void extend(struct box *box, const struct box *by)
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = fmin(box->low[a], by->low[a]);
        box->high[a] = fmax(box->high[a], by->high[a]);
    }
}

/* The ball round a box that is grown on all sides; returns its radius. */
static double ball_round(double centre[3], const struct box *box, double grown)
{
    double half[3];
    for (int a = 0; a < 3; a++) {
        centre[a] = 0.5 * (box->low[a] + box->high[a]);
        half[a] = 0.5 * (box->high[a] - box->low[a]);
    }
    return vec3_length(half) + grown;
}

static bool is_shown(const struct tract_source *source, uint64_t point)
{
    return !source->shown || source->shown[tractogram_streamline_of(source->tractogram, point)];
}

static bool shows_any(const struct tract_source *source, const struct tract_leaf *leaf)
{
    bool any = !source->shown;
    for (size_t lane = 0; lane < leaf->count && !any; lane++) {
        any = is_shown(source, leaf->point[lane]);
    }
    return any;
}

/* About as many leaves to a group as there are groups. */
static size_t group_size(size_t leaves)
{
    size_t size = 1;
    while (size * size < leaves) {
        size *= 2;
    }
    return size;
}

/* How far capsules reach out of the boxes of their points, and then some, far above rounding. */
static double growth_of(const struct tractogram *tractogram)
{
    double reach = 0;
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fmax(fabs(tractogram->low[a]), fabs(tractogram->high[a])));
    }
    return tractogram->radius + TRACT_SLACK * (reach + tractogram->radius);
}

/* The clusters of a group, behind the others, and its ball: that of nothing where it has none. */
static void add_group(struct clusters *to, const struct tract_source *source, size_t first, size_t end)
{
    const struct tract_tree *tree = &source->tractogram->tree;
    double grown = growth_of(source->tractogram);
    size_t group = to->mesh_count++;
    size_t count = to->first_cluster[group];
    struct box all = no_box();
    for (size_t number = first; number < end; number++) {
        if (shows_any(source, &tree->leaves[number])) {
            struct cluster *cluster = &to->cluster[count++];
            struct box box = box_of_leaf(tree, number);
            extend(&all, &box);
            cluster->radius = ball_round(cluster->centre, &box, grown);
            cluster->first = (uint32_t)number;
            cluster->count = tree->leaves[number].count;
        }
    }
    double centre[3] = {0, 0, 0};
    to->ball[3][group] = count > to->first_cluster[group] ? ball_round(centre, &all, grown) : 0;
    for (int a = 0; a < 3; a++) {
        to->ball[a][group] = centre[a];
    }
    to->first_cluster[to->mesh_count] = count;
}

conus_status tract_clusters_init(struct clusters *out, const struct tract_source *source)
{
    struct clusters clusters = {0};
    size_t leaves = tract_leaf_count(source->tractogram->tree.run_count);
    size_t size = group_size(leaves);
    size_t groups = (leaves + size - 1) / size;
    bool is_whole = true;
    for (int k = 0; k < 4; k++) {
        clusters.ball[k] = memory_raw(groups, sizeof(double));
        is_whole = is_whole && clusters.ball[k];
    }
    clusters.first_cluster = memory_zeroed(groups + 1, sizeof *clusters.first_cluster);
    clusters.cluster = memory_zeroed(leaves, sizeof *clusters.cluster);
    if (!is_whole || !clusters.first_cluster || !clusters.cluster) {
        clusters_finish(&clusters);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t first = 0; first < leaves; first += size) {
        add_group(&clusters, source, first, first + size < leaves ? first + size : leaves);
    }
    *out = clusters;
    return CONUS_OK;
}

uint64_t tract_texels_size(const struct tractogram *tractogram)
{
    return (uint64_t)tract_leaf_count(tractogram->tree.run_count) * TRACT_LEAF_TEXELS * 4 * sizeof(uint32_t);
}

void tract_texels_fill(uint32_t out[TRACT_LEAF_TEXELS][4], const struct tract_source *source, size_t number)
{
    const struct tract_leaf *leaf = &source->tractogram->tree.leaves[number];
    memset(out, 0, TRACT_LEAF_TEXELS * sizeof *out);
    memcpy(out[0], leaf->low, sizeof leaf->low);
    memcpy(&out[0][3], &leaf->thickness, sizeof leaf->thickness);
    memcpy(out[1], leaf->step, sizeof leaf->step);
    for (uint32_t lane = 0; lane < leaf->count; lane++) {
        uint32_t *run = out[2 + lane / 2] + 2 * (lane % 2);
        uint32_t multiple = leaf->bend[lane] >> TRACT_SEGMENTS_BITS;
        run[0] = leaf->ends[0][0][lane] | (uint32_t)leaf->ends[0][1][lane] << 8 |
                 (uint32_t)leaf->ends[0][2][lane] << 16 | multiple << 24;
        run[1] = leaf->ends[1][0][lane] | (uint32_t)leaf->ends[1][1][lane] << 8 |
                 (uint32_t)leaf->ends[1][2][lane] << 16 | (is_shown(source, leaf->point[lane]) ? TRACT_SHOWN : 0);
    }
}
