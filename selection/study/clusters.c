/* SPDX-License-Identifier: BSD-3-Clause */
/* Parts a region of interest into clusters of voxels, finds what each covers, and its local maxima. */
#include "selection/study/study.h"

#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "conus/study.h"
#include "selection/selection.h"

#include <math.h>

enum { NEIGHBOURS = 26 };

/* What has come to a voxel. */
enum seen { UNSEEN, IN_CLUSTER, IN_PLATEAU, NEAR_MAXIMUM };

static const double ROUNDING = 1e-9; /* of a distance */

struct cluster {
    size_t first, count; /* among the members */
    uint64_t peak;       /* voxel */
    double height;       /* of it */
};

/* What a row is about. */
enum part {
    PART_WHOLE,    /* the cluster */
    PART_COVERAGE, /* its part in one area or pathway, or in none */
    PART_MAXIMUM   /* a local maximum of it */
};

/* A row of the table. */
struct row {
    struct coverage is; /* of the cluster: its fraction is that of the cluster; of a maximum with what has most of it */
    enum part part;
    uint32_t cluster; /* from 1 */
    uint64_t voxels;  /* of a whole cluster */
    double centre[3]; /* of a whole cluster: centre of mass, the voxels weighted by the size of their values, world */
};

/* A local maximum, and how high it is. */
struct maximum {
    uint64_t voxel;
    double height;
};

struct parting {
    const conus_selector *selector;
    const conus_roi *roi;
    struct row *rows;
    size_t row_count, row_capacity;
    uint8_t *seen;          /* [voxels of the grid] enum seen */
    float *values;          /* [voxels of the grid] of the cluster under way, else 0 */
    uint64_t *members;      /* [voxels of the region] cluster by cluster, ascending in each */
    uint64_t *plateau;      /* [likewise] connected voxels of one value */
    struct maximum *maxima; /* [likewise] of the cluster under way */
    size_t maxima_count;
    struct cluster *clusters;
    size_t count, capacity;
};

/* Value on the threshold's side: the larger, the higher. */
static double height_of(const conus_roi *roi, uint64_t voxel)
{
    double value = (double)roi->volume.values[voxel];
    return roi->volume.info.threshold < 0 ? -value : value;
}

static void place_of(size_t at[3], const conus_roi *roi, uint64_t voxel)
{
    const size_t *dim = roi->volume.info.dim;
    at[0] = (size_t)voxel % dim[0];
    at[1] = (size_t)voxel / dim[0] % dim[1];
    at[2] = (size_t)voxel / dim[0] / dim[1];
}

/* The voxels of the region with a face, an edge or a corner in common with this one. Gives their number. */
static size_t list_neighbours(uint64_t out[NEIGHBOURS], const conus_roi *roi, uint64_t voxel)
{
    const size_t *dim = roi->volume.info.dim;
    size_t at[3];
    size_t count = 0;
    place_of(at, roi, voxel);
    for (size_t n = 0; n < 27; n++) {
        const size_t step[3] = {n % 3, n / 3 % 3, n / 9}; /* less 1 */
        bool is_there = n != 13;
        for (int a = 0; a < 3; a++) {
            is_there = is_there && at[a] + step[a] > roi->low[a] && at[a] + step[a] <= roi->high[a] + 1;
        }
        size_t next =
            is_there ? at[0] + step[0] - 1 + dim[0] * (at[1] + step[1] - 1 + dim[1] * (at[2] + step[2] - 1)) : 0;
        if (is_there && roi_has(roi, next)) {
            out[count++] = next;
        }
    }
    return count;
}

/* Lists the voxels of the region that are connected with `seed`: of IN_PLATEAU those of its value, where *is_top says
 * whether no neighbour is higher. Gives their number. */
static size_t flood(uint64_t *out, bool *is_top, struct parting *parting, uint64_t seed, enum seen mark)
{
    const conus_roi *roi = parting->roi;
    double height = height_of(roi, seed);
    size_t count = 1;
    out[0] = seed;
    parting->seen[seed] = mark;
    *is_top = true;
    for (size_t i = 0; i < count; i++) {
        uint64_t next[NEIGHBOURS];
        size_t neighbours = list_neighbours(next, roi, out[i]);
        for (size_t n = 0; n < neighbours; n++) {
            double other = height_of(roi, next[n]);
            *is_top = *is_top && other <= height;
            if (parting->seen[next[n]] < mark && (mark == IN_CLUSTER || other == height)) {
                parting->seen[next[n]] = mark;
                out[count++] = next[n];
            }
        }
    }
    return count;
}

/* Adds the cluster of the voxel `seed`, behind `first` members. */
static conus_status add_cluster(struct parting *parting, size_t first, uint64_t seed)
{
    bool is_top;
    uint64_t *members = parting->members + first;
    if (!memory_reserve(&parting->clusters, &parting->capacity, parting->count + 1, sizeof *parting->clusters)) {
        return CONUS_ERROR_MEMORY;
    }
    struct cluster cluster = {.first = first, .count = flood(members, &is_top, parting, seed, IN_CLUSTER)};
    order_sort(members, cluster.count, sizeof *members, compare_u64);
    for (size_t i = 0; i < cluster.count; i++) {
        double height = height_of(parting->roi, members[i]);
        if (i == 0 || height > cluster.height) {
            cluster.peak = members[i];
            cluster.height = height;
        }
    }
    parting->clusters[parting->count++] = cluster;
    return CONUS_OK;
}

static conus_status find_clusters(struct parting *parting)
{
    const conus_roi *roi = parting->roi;
    const size_t *dim = roi->volume.info.dim;
    conus_status status = CONUS_OK;
    size_t members = 0;
    for (size_t voxel = 0; !status && voxel < dim[0] * dim[1] * dim[2] && members < roi->voxels; voxel++) {
        if (!parting->seen[voxel] && roi_has(roi, voxel)) {
            status = add_cluster(parting, members, voxel);
            members += status ? 0 : parting->clusters[parting->count - 1].count;
        }
    }
    return status;
}

static int by_size(const void *a, const void *b)
{
    const struct cluster *x = a;
    const struct cluster *y = b;
    int order = compare_unsigned(y->count, x->count);
    order = order ? order : compare_double(y->height, x->height);
    return order ? order : compare_unsigned(x->peak, y->peak);
}

static int by_height(const void *a, const void *b)
{
    const struct maximum *x = a;
    const struct maximum *y = b;
    int order = compare_double(y->height, x->height);
    return order ? order : compare_unsigned(x->voxel, y->voxel);
}

static double square_between(const conus_roi *roi, uint64_t a, uint64_t b)
{
    double one[3];
    double other[3];
    double between[3];
    roi_middle(one, roi, (size_t)a);
    roi_middle(other, roi, (size_t)b);
    vec3_sub(between, one, other);
    return vec3_dot(between, between);
}

/* Marks the voxels of the cluster under way that are too near a maximum. */
static void mark_near(struct parting *parting, uint64_t voxel)
{
    const conus_roi *roi = parting->roi;
    const size_t *dim = roi->volume.info.dim;
    const double *m = roi->volume.voxel_from_world;
    const double apart = CONUS_MAXIMA_APART * (1 - ROUNDING);
    size_t low[3];
    size_t high[3];
    place_of(low, roi, voxel);
    for (int a = 0; a < 3; a++) {
        double reach = ceil(apart * sqrt(m[a] * m[a] + m[4 + a] * m[4 + a] + m[8 + a] * m[8 + a]));
        double at = (double)low[a];
        low[a] = (size_t)fmax(at - reach, (double)roi->low[a]);
        high[a] = (size_t)fmin(at + reach, (double)roi->high[a]);
    }
    for (size_t k = low[2]; k <= high[2]; k++) {
        for (size_t j = low[1]; j <= high[1]; j++) {
            for (size_t i = low[0]; i <= high[0]; i++) {
                size_t other = i + dim[0] * (j + dim[1] * k);
                bool is_own = parting->values[other] != 0;
                if (is_own && square_between(roi, voxel, other) < apart * apart) {
                    parting->seen[other] = NEAR_MAXIMUM;
                }
            }
        }
    }
}

/* Finds the local maxima of a cluster, the highest first, and keeps those that are far enough from all before them. */
static void find_maxima(struct parting *parting, const struct cluster *cluster)
{
    const uint64_t *members = parting->members + cluster->first;
    struct maximum *maxima = parting->maxima;
    size_t count = 0;
    for (size_t i = 0; i < cluster->count; i++) {
        bool is_top = false;
        if (parting->seen[members[i]] < IN_PLATEAU) {
            (void)flood(parting->plateau, &is_top, parting, members[i], IN_PLATEAU);
        }
        if (is_top) {
            maxima[count++] = (struct maximum){members[i], height_of(parting->roi, members[i])};
        }
    }
    order_sort(maxima, count, sizeof *maxima, by_height);
    parting->maxima_count = 0;
    for (size_t i = 0; i < count; i++) {
        if (parting->seen[maxima[i].voxel] != NEAR_MAXIMUM) {
            mark_near(parting, maxima[i].voxel);
            maxima[parting->maxima_count++] = maxima[i];
        }
    }
}

static conus_status add_row(struct parting *parting, struct row row)
{
    if (!memory_reserve(&parting->rows, &parting->row_capacity, parting->row_count + 1, sizeof *parting->rows)) {
        return CONUS_ERROR_MEMORY;
    }
    parting->rows[parting->row_count++] = row;
    return CONUS_OK;
}

/* The region of these voxels, ascending, whose values are in parting->values. */
static conus_roi part_of(const struct parting *parting, const uint64_t *voxels, size_t count)
{
    conus_roi part = *parting->roi;
    part.volume.values = parting->values;
    part.voxels = count;
    part.mm3 = parting->roi->mm3 / (double)parting->roi->voxels * (double)count;
    for (size_t i = 0; i < count; i++) {
        size_t at[3];
        place_of(at, parting->roi, voxels[i]);
        for (int a = 0; a < 3; a++) {
            part.low[a] = i == 0 || at[a] < part.low[a] ? at[a] : part.low[a];
            part.high[a] = i == 0 || at[a] > part.high[a] ? at[a] : part.high[a];
        }
    }
    return part;
}

/* Each voxel counts as much as its value is far from 0. */
static void find_centre(double out[3], const struct parting *parting, const struct cluster *cluster)
{
    double sum[3] = {0};
    double whole = 0;
    for (size_t i = 0; i < cluster->count; i++) {
        uint64_t voxel = parting->members[cluster->first + i];
        double weight = fabs((double)parting->roi->volume.values[voxel]);
        size_t at[3];
        place_of(at, parting->roi, voxel);
        vec3_add_scaled(sum, sum, weight, (const double[]){(double)at[0], (double)at[1], (double)at[2]});
        whole += weight;
    }
    vec3_scale(sum, sum, 1 / whole);
    mat4_point(out, parting->roi->volume.info.world_from_voxel, sum);
}

static conus_status add_whole(struct parting *parting, const struct cluster *cluster, uint32_t number)
{
    const conus_roi *roi = parting->roi;
    struct row row = {.is = {.object = {.kind = CONUS_KIND_UNASSIGNED},
                             .volume = roi->mm3 / (double)roi->voxels * (double)cluster->count,
                             .fraction = NAN,
                             .roi_fraction = 1,
                             .peak = (double)roi->volume.values[cluster->peak]},
                      .part = PART_WHOLE,
                      .cluster = number,
                      .voxels = cluster->count};
    roi_middle(row.is.peak_point, roi, (size_t)cluster->peak);
    find_centre(row.centre, parting, cluster);
    return add_row(parting, row);
}

static conus_status add_coverages(struct parting *parting, const struct cluster *cluster, uint32_t number)
{
    const conus_roi part = part_of(parting, parting->members + cluster->first, cluster->count);
    struct coverage *coverages;
    size_t count;
    conus_status status = overlap_find(&coverages, &count, parting->selector, &part);
    for (size_t i = 0; !status && i < count; i++) {
        status = add_row(parting, (struct row){coverages[i], PART_COVERAGE, number, .centre = {NAN, NAN, NAN}});
    }
    memory_free(coverages);
    return status;
}

/* The row of a maximum, with what has the largest part of its voxel: of as much as is in none, the object. */
static conus_status add_maximum(struct parting *parting, const struct maximum *maximum, uint32_t number)
{
    const conus_roi part = part_of(parting, &maximum->voxel, 1);
    struct coverage *coverages;
    size_t count;
    conus_status status = overlap_find(&coverages, &count, parting->selector, &part);
    const struct coverage *most = NULL;
    for (size_t i = 0; !status && i < count; i++) {
        most = most && most->volume >= coverages[i].volume ? most : &coverages[i];
    }
    if (!status) {
        struct row row = {.is = {.object = most ? most->object : (struct table_object){CONUS_KIND_UNASSIGNED, 0},
                                 .volume = NAN,
                                 .fraction = NAN,
                                 .roi_fraction = NAN,
                                 .peak = (double)parting->values[maximum->voxel]},
                          .part = PART_MAXIMUM,
                          .cluster = number,
                          .centre = {NAN, NAN, NAN}};
        roi_middle(row.is.peak_point, parting->roi, (size_t)maximum->voxel);
        status = add_row(parting, row);
    }
    memory_free(coverages);
    return status;
}

/* Lays the values of a cluster out by themselves, or takes them away. */
static void lay_out(struct parting *parting, const struct cluster *cluster, bool are_there)
{
    for (size_t i = 0; i < cluster->count; i++) {
        uint64_t voxel = parting->members[cluster->first + i];
        parting->values[voxel] = are_there ? parting->roi->volume.values[voxel] : 0;
    }
}

static conus_status describe(struct parting *parting, uint32_t number)
{
    const struct cluster *cluster = &parting->clusters[number - 1];
    lay_out(parting, cluster, true);
    conus_status status = add_whole(parting, cluster, number);
    status = status ? status : add_coverages(parting, cluster, number);
    if (!status && parting->roi->volume.info.threshold != 0) {
        find_maxima(parting, cluster);
        for (size_t i = 0; !status && i < parting->maxima_count; i++) {
            status = add_maximum(parting, &parting->maxima[i], number);
        }
    }
    lay_out(parting, cluster, false);
    return status;
}

static struct cell kind(const struct table_source *source, const void *of, size_t index)
{
    const struct row *row = of;
    return row->part == PART_COVERAGE ? table_kind(source, row, index)
                                      : text_cell(row->part == PART_WHOLE ? "cluster" : "maximum");
}

static struct cell name(const struct table_source *source, const void *of, size_t index)
{
    const struct row *row = of;
    return row->part == PART_WHOLE ? no_cell() : table_object_name(source, row, index);
}

static struct cell voxels(const struct table_source *source, const void *of, size_t index)
{
    const struct row *row = of;
    (void)source;
    (void)index;
    return row->part == PART_WHOLE ? integer_cell(row->voxels) : no_cell();
}

static const struct table_field columns[] = {
    {"cluster", NULL, "number of the cluster, 1 is the largest", TABLE_OF(COUNT, struct row, cluster)},
    {"kind", NULL, "cluster: all of it; area, pathway or unassigned: its part there; maximum: a local maximum",
     TABLE_NAME_BY(kind)},
    {"index", NULL, "the atlas's own label of the area, or the ordinal of the pathway", TABLE_LABEL_BY(table_index)},
    {"name", NULL, "name of the area or pathway; of a maximum that with most of its voxel", TABLE_NAME_BY(name)},
    {"volume_mm3", "mm^3", "volume of the cluster, or of the part of it that is there",
     TABLE_OF(NUMBER, struct row, is.volume)},
    {"fraction", NULL, "that part of the area or pathway, 0 to 1", TABLE_OF(NUMBER, struct row, is.fraction)},
    {"cluster_fraction", NULL, "that part of the cluster, 0 to 1", TABLE_OF(NUMBER, struct row, is.roi_fraction)},
    {"peak", NULL, "the value farthest from 0 there; of a maximum its value", TABLE_OF(NUMBER, struct row, is.peak)},
    TABLE_XYZ("peak_", "centre of the voxel that has it", TABLE_OF, struct row, is.peak_point),
    {"voxels", NULL, "voxels of the cluster", TABLE_COUNT_BY(voxels)},
    TABLE_XYZ("centre_", "centre of mass of the cluster, its voxels weighted by value", TABLE_OF, struct row, centre),
    {"volume_error_mm3", "mm^3", COVERAGE_ERROR, TABLE_OF(NUMBER, struct row, is.volume_error), .unless_zeros = true},
};

const struct table_fields clusters_fields = {columns, sizeof columns / sizeof *columns};

conus_status conus_clusters(conus_table **out, const conus_selector *selector, const conus_roi *roi)
{
    if (!out || !selector || !roi) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_clusters: a result, a selector and a region are needed");
    }
    if (roi->nodes) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: clusters are of voxels, and this region is of tetrahedra",
                    roi->volume.info.path);
    }
    const size_t *dim = roi->volume.info.dim;
    size_t cells = dim[0] * dim[1] * dim[2];
    size_t count = (size_t)roi->voxels;
    struct parting parting = {.selector = selector,
                              .roi = roi,
                              .seen = memory_zeroed(cells, sizeof *parting.seen),
                              .values = memory_zeroed(cells, sizeof *parting.values),
                              .members = memory_raw(count, sizeof *parting.members),
                              .plateau = memory_raw(count, sizeof *parting.plateau),
                              .maxima = memory_raw(count, sizeof *parting.maxima)};
    bool fits = parting.seen && parting.values && parting.members && parting.plateau && parting.maxima;
    conus_status status = fits ? find_clusters(&parting) : CONUS_ERROR_MEMORY;
    if (!status) {
        order_sort(parting.clusters, parting.count, sizeof *parting.clusters, by_size);
    }
    for (uint32_t number = 1; !status && number <= parting.count; number++) {
        status = describe(&parting, number);
    }
    status = status ? status
                    : overlap_table(out, selector, &clusters_fields, roi, parting.rows, sizeof *parting.rows,
                                    parting.row_count);
    memory_free(parting.seen);
    memory_free(parting.values);
    memory_free(parting.members);
    memory_free(parting.plateau);
    memory_free(parting.maxima);
    memory_free(parting.clusters);
    memory_free(parting.rows);
    return status;
}
