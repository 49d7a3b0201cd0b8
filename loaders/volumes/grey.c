/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells labels from grey values by the share of neighbouring voxels that are equal. */
#include "loaders/volumes/volumes.h"

#include "base/files/file.h"
#include "base/order.h"
#include "sources/names.h"

#include <math.h>
#include <string.h>

enum {
    BLOCK = 1 << 16,     /* voxels whose counts 32 bits hold */
    LOOKS = 1 << 13,     /* voxels among which the commonest values are looked for */
    PLATEAUS = 3,        /* of them, at most, and each of at least */
    PLATEAU_SHARE = 8,   /* one voxel in eight */
    VALUES = 1 << 18,    /* voxels among which different values are counted */
    DIFFERING = 1 << 16, /* neighbours that differ, compared with others */
    FEW_VOXELS = 128,    /* and fewer tell nothing */
    INTENT_LABEL = 1002, /* NIfTI's code for "the values are labels" */
    FEW_VALUES = 6       /* besides plateaus: tissue classes, layers; never an image */
};

static const size_t small = (size_t)1 << 21; /* voxels; of a bigger volume, planes are passed over */
static const size_t planes = 64;             /* of which so many are enough */
static const double most_equal = 0.7;        /* equal neighbours, above which no image is */
static const double least_equal = 0.2;       /* below which no parcellation is */
static const double wrinkled = 2.5;          /* surface of an area over that of as many voxels in a cube */
static const double allowance = 2.0 / 3;     /* where something says that they are labels */
static const double chance = 0.55;           /* of a neighbour to be nearer in value than a voxel elsewhere */

/* The volume, and how to scan it. */
struct scan {
    const struct label_voxels *labels;
    const size_t *dim;
    size_t step;                 /* every step-th plane */
    uint32_t plateaus[PLATEAUS]; /* values that do not count, 0 where there are fewer; 0 itself does not either */
    uint32_t *block, *beside;    /* [BLOCK + 1] labels of a row, and of one beside it */
};

/* 1 or 0. */
static uint32_t value_counts(uint32_t value, const uint32_t plateaus[PLATEAUS])
{
    return (uint32_t)((value != 0) & (value != plateaus[0]) & (value != plateaus[1]) & (value != plateaus[2]));
}

/* Puts `value` with `count` voxels among the commonest. */
static void rank_value(uint32_t values[PLATEAUS], size_t ranked[PLATEAUS], uint32_t value, size_t count)
{
    for (size_t i = 0; i < PLATEAUS; i++) {
        if (count > ranked[i]) {
            memmove(values + i + 1, values + i, (PLATEAUS - 1 - i) * sizeof *values);
            memmove(ranked + i + 1, ranked + i, (PLATEAUS - 1 - i) * sizeof *ranked);
            values[i] = value;
            ranked[i] = count;
            return;
        }
    }
}

/* The commonest values of a sample. An image's background where it is not 0, saturated voxels, the inside of a phantom
 * would look like areas. */
static void find_plateaus(struct job *job, struct scan *scan, size_t count)
{
    size_t step = count / LOOKS | 1; /* odd, so that it does not stay in a column */
    size_t n = 0;
    uint32_t *sample = job_raw(job, count / step + 1, sizeof *sample);
    for (size_t i = 0; sample && i < count; i += step) {
        sample[n] = label_voxels_at(scan->labels, i);
        n += sample[n] != 0;
    }
    order_sort(sample, n, sizeof *sample, compare_u32);
    size_t ranked[PLATEAUS] = {0};
    for (size_t i = 0, start = 0; i < n; i++) {
        if (i + 1 < n && sample[i + 1] == sample[i]) {
            continue;
        }
        if (PLATEAU_SHARE * (i + 1 - start) >= n) {
            rank_value(scan->plateaus, ranked, sample[i], i + 1 - start);
        }
        start = i + 1;
    }
}

typedef void pair_visitor(void *user, const uint32_t *a, const uint32_t *b, size_t count, const uint32_t *plateaus);

/* Visits the voxels a[] of a row with their neighbours b[] along i, j and k, a block at a time. */
static void visit_row(const struct scan *scan, size_t j, size_t k, pair_visitor *visit, void *user)
{
    size_t row = scan->dim[0];
    size_t plane = row * scan->dim[1];
    for (size_t i = 0; i < row; i += BLOCK) {
        size_t at = k * plane + j * row + i;
        size_t count = row - i < BLOCK ? row - i : BLOCK;
        size_t pairs = i + count < row ? count : count - 1;
        label_voxels_get(scan->block, scan->labels, at, pairs + 1);
        visit(user, scan->block, scan->block + 1, pairs, scan->plateaus);
        if (j + 1 < scan->dim[1]) {
            label_voxels_get(scan->beside, scan->labels, at + row, count);
            visit(user, scan->block, scan->beside, count, scan->plateaus);
        }
        if (k + 1 < scan->dim[2]) {
            label_voxels_get(scan->beside, scan->labels, at + plane, count);
            visit(user, scan->block, scan->beside, count, scan->plateaus);
        }
    }
}

static void visit_neighbours(const struct scan *scan, pair_visitor *visit, void *user)
{
    for (size_t k = 0; k < scan->dim[2]; k += scan->step) {
        for (size_t j = 0; j < scan->dim[1]; j++) {
            visit_row(scan, j, k, visit, user);
        }
    }
}

struct tally {
    size_t pairs, equal;
};

static void count_pairs(void *user, const uint32_t *a, const uint32_t *b, size_t count, const uint32_t *plateaus)
{
    struct tally *tally = user;
    const uint32_t copies[PLATEAUS] = {plateaus[0], plateaus[1], plateaus[2]}; /* in registers */
    uint32_t pairs = 0;
    uint32_t equal = 0;
    for (size_t i = 0; i < count; i++) {
        uint32_t both = value_counts(a[i], copies) & value_counts(b[i], copies);
        pairs += both;
        equal += both & (uint32_t)(a[i] == b[i]);
    }
    tally->pairs += pairs;
    tally->equal += equal;
}

/* The values of up to VALUES voxels, sorted. */
struct values {
    uint32_t *sorted;
    size_t count;   /* of different ones, which are in front */
    size_t voxels;  /* in all planes of the scan */
    double surface; /* along one axis, of cubes, one of all the voxels of each value: the sum of n^(2/3) */
};

static size_t count_filled(const struct scan *scan)
{
    size_t plane = scan->dim[0] * scan->dim[1];
    size_t filled = 0;
    for (size_t k = 0; k < scan->dim[2]; k += scan->step) {
        for (size_t i = 0; i < plane; i++) {
            filled += value_counts(label_voxels_at(scan->labels, k * plane + i), scan->plateaus);
        }
    }
    return filled;
}

static size_t gather_values(uint32_t *out, const struct scan *scan, size_t every)
{
    size_t plane = scan->dim[0] * scan->dim[1];
    size_t seen = 0;
    size_t n = 0;
    for (size_t k = 0; k < scan->dim[2]; k += scan->step) {
        for (size_t i = 0; i < plane; i++) {
            uint32_t value = label_voxels_at(scan->labels, k * plane + i);
            if (value_counts(value, scan->plateaus) && seen++ % every == 0) {
                out[n++] = value;
            }
        }
    }
    return n;
}

static struct values find_values(struct job *job, const struct scan *scan)
{
    struct values values = {.voxels = count_filled(scan)};
    size_t every = values.voxels / VALUES + 1;
    values.sorted = job_raw(job, values.voxels / every + 1, sizeof *values.sorted);
    size_t n = values.sorted ? gather_values(values.sorted, scan, every) : 0;
    order_sort(values.sorted, n, sizeof *values.sorted, compare_u32);
    double weight = (double)(every * scan->step); /* a voxel stands for so many */
    for (size_t i = 0, start = 0; i < n; i++) {
        if (i + 1 == n || values.sorted[i + 1] != values.sorted[i]) {
            double edge = cbrt((double)(i + 1 - start) * weight);
            values.surface += edge * edge;
            values.sorted[values.count++] = values.sorted[i];
            start = i + 1;
        }
    }
    return values;
}

/* Whether the table belongs to these values: it names nine of ten, and they are half of what it names. */
static bool names_values(const struct label_table *table, const struct values *values)
{
    size_t named = 0;
    size_t entries = 0;
    for (size_t i = 0; table && i < table->count; i++) {
        entries += table->entries[i].name != NULL;
    }
    for (size_t i = 0; entries && i < values->count; i++) {
        const struct label *label = label_table_find(table, values->sorted[i]);
        named += label && label->name;
    }
    return named && 10 * named >= 9 * values->count && 2 * named >= entries;
}

/* A cube of n voxels shares n^(2/3) of its n neighbours along an axis with other values. */
static double needed_share(const struct values *values, const struct scan *scan, const struct grey_claims *claims)
{
    double share = 1 - wrinkled * values->surface / ((double)values->voxels * (double)scan->step);
    share = fmin(fmax(share, least_equal), most_equal);
    return claims->stated || names_values(claims->table, values) ? share * allowance : share;
}

/* Neighbours that differ. */
struct differing {
    uint32_t (*pairs)[2];
    size_t count, seen, every;
};

static void keep_differing(void *user, const uint32_t *a, const uint32_t *b, size_t count, const uint32_t *plateaus)
{
    struct differing *differing = user;
    for (size_t i = 0; i < count; i++) {
        bool differ = value_counts(a[i], plateaus) && value_counts(b[i], plateaus) && a[i] != b[i];
        if (differ && differing->seen++ % differing->every == 0) {
            differing->pairs[differing->count][0] = a[i];
            differing->pairs[differing->count++][1] = b[i];
        }
    }
}

static double value_distance(uint32_t a, uint32_t b)
{
    return fabs((double)a - (double)b);
}

/* How often a voxel's neighbour is nearer to it in value than another voxel, which differs from it, too. */
static double share_nearer(const struct differing *differing)
{
    uint64_t random = 1;
    double nearer = 0;
    size_t tried = 0;
    for (size_t i = 0; i < differing->count; i++) {
        random = random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407); /* Knuth's MMIX */
        uint32_t a = differing->pairs[i][0];
        uint32_t other = differing->pairs[(random >> 33) % differing->count][1];
        double own = value_distance(a, differing->pairs[i][1]);
        if (other != a) {
            nearer += own < value_distance(a, other) ? 1 : own > value_distance(a, other) ? 0 : 0.5;
            tried++;
        }
    }
    return tried ? nearer / (double)tried : 0;
}

static bool are_near(struct job *job, const struct scan *scan, const struct tally *tally)
{
    size_t total = tally->pairs - tally->equal;
    struct differing differing = {.every = total / DIFFERING + 1};
    differing.pairs = job_raw(job, total / differing.every + 1, sizeof *differing.pairs);
    if (differing.pairs) {
        visit_neighbours(scan, keep_differing, &differing);
    }
    return share_nearer(&differing) > chance;
}

struct grey_result grey_judge(struct job *job, const struct label_voxels *labels, const size_t dim[3],
                              const struct grey_claims *claims)
{
    const struct job_mark mark = job_mark(job);
    size_t block = (dim[0] < BLOCK ? dim[0] : BLOCK) + 1;
    struct scan scan = {.labels = labels, .dim = dim, .step = labels->count > small ? dim[2] / planes + 1 : 1};
    scan.block = job_raw(job, 2 * block, sizeof *scan.block);
    scan.beside = scan.block ? scan.block + block : NULL;
    struct tally tally = {0};
    struct grey_result result = {.equal = 1, .telling = true};
    find_plateaus(job, &scan, labels->count);
    if (scan.block) {
        visit_neighbours(&scan, count_pairs, &tally);
        result.equal = tally.pairs ? (double)tally.equal / (double)tally.pairs : 1;
    }
    if (result.equal < most_equal) { /* too few to be sure that there are areas */
        const struct values values = find_values(job, &scan);
        result.telling = values.voxels >= FEW_VOXELS && values.count > FEW_VALUES && 2 * tally.pairs >= values.voxels;
        if (result.telling) {
            result.needed = needed_share(&values, &scan, claims);
            result.grey = result.equal < result.needed && are_near(job, &scan, &tally);
        }
    }
    job_release(job, mark);
    return result;
}

struct grey_result grey_judge_file(struct job *job, const struct volume_file *file, const struct label_voxels *labels,
                                   const struct label_table *table, bool stated)
{
    static const char suffix[] = "_dseg";
    if (!job_ok(job)) { /* there may be no file */
        return (struct grey_result){0};
    }
    const size_t length = sizeof suffix - 1;
    size_t stem = volume_stem_length(file->path);
    bool is_dseg = stem > length && memcmp(file->path + stem - length, suffix, length) == 0;
    const struct grey_claims claims = {table, stated || is_dseg};
    return file->intent_code == INTENT_LABEL ? (struct grey_result){.equal = 1, .telling = true}
                                             : grey_judge(job, labels, file->info.dim, &claims);
}
