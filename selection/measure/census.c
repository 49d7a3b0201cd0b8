/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the voxels of each object whose centre is in a region. */
#include "selection/measure/measure.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "selection/region/region.h"

/* Axes in the order in which voxels are stored. */
static const int STORED[3] = {0, 1, 2};

/* One volume's rows against one region. */
struct walk {
    const struct region *region;
    const struct volume *volume;
    census_row row;
    void *user;
    const struct object_box *box;
    const struct label_runs *runs; /* in place of labels, for count_runs(); or NULL */
    const int *axes;               /* along which rows are, come after each other in a slice, and slices do */
    struct region_rows rows;
    int turn;
};

/* Asks for each of the voxels `first` up to `behind` of the row of the voxel `at`. */
static void ask(const struct walk *walk, const size_t at[3], uint64_t first, uint64_t behind)
{
    size_t voxel[3] = {at[0], at[1], at[2]};
    for (; first < behind; first++) {
        voxel[walk->axes[0]] = (size_t)first;
        double p[3] = {(double)voxel[0], (double)voxel[1], (double)voxel[2]};
        mat4_point(p, walk->volume->info.world_from_voxel, p);
        if (region_has(walk->region, p)) {
            walk->row(walk->user, walk->volume, voxel, 1);
        }
    }
}

/* Row `r` of those that were cut, stored in a row. */
static void walk_row(const struct walk *walk, const struct region_cut *cut, size_t r, size_t j, size_t k)
{
    size_t at[3] = {(size_t)cut->sure[0][r], j, k};
    uint64_t behind = cut->maybe[1][r] + 1;
    if (cut->sure[0][r] <= cut->sure[1][r]) {
        ask(walk, at, cut->maybe[0][r], cut->sure[0][r]);
        walk->row(walk->user, walk->volume, at, (size_t)(cut->sure[1][r] - cut->sure[0][r] + 1));
        ask(walk, at, cut->sure[1][r] + 1, behind);
    } else {
        ask(walk, at, cut->maybe[0][r], behind);
    }
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* The rows of slice k, from j on, that are cut at a time. */
struct piece {
    size_t j, k, count;
    struct region_cut cut;
};

/* The labels of a row lie in a few lines of memory, which come while the rows before are walked. */
static void fetch_rows(const struct walk *walk, const struct piece *piece)
{
    const size_t *dim = walk->volume->info.dim;
    for (size_t r = 0; r < piece->count && volume_can_be_hit(walk->volume); r++) {
        size_t row = piece->j + r + dim[walk->axes[1]] * piece->k;
        if (walk->runs) {
            label_runs_fetch(walk->runs, row);
        } else {
            volume_fetch(walk->volume, dim[0] * row + (size_t)piece->cut.maybe[0][r]);
            volume_fetch(walk->volume, dim[0] * row + (size_t)piece->cut.maybe[1][r]);
        }
    }
}

/* `count` voxels of one object in a row along axes[0]; `at` is where they begin along each of the axes. */
static void add_run(struct census *census, uint32_t object, const int axes[3], const size_t at[3], size_t count)
{
    struct census_count *sum = &census->counts[object];
    if (!sum->voxels && object) {
        census->touched[census->touched_count++] = object;
    }
    sum->voxels += count;
    sum->index[axes[0]] += count * at[0] + count * (count - 1) / 2;
    sum->index[axes[1]] += count * at[1];
    sum->index[axes[2]] += count * at[2];
}

/* The areas of one parcellation, in a region. */
struct areas {
    struct census *census;
    size_t counted; /* voxels without runs */
};

/* Voxels of rows of one slice that lie in the region: `first` up to `behind` of row j, in the runs `run` to `last`.
 * There is room for one more, which is read. */
struct stretches {
    size_t count;
    size_t runs; /* of all */
    struct stretch {
        uint32_t first, behind, j, run[2];
    } of[REGION_ROWS + 1];
};

/* Lists the voxels that are surely in the region, and checks those that may be. */
static void list_stretches(struct stretches *out, const struct walk *walk, const struct piece *piece)
{
    const struct region_cut *cut = &piece->cut;
    size_t row = piece->j + walk->volume->info.dim[walk->axes[1]] * piece->k;
    out->count = out->runs = 0;
    for (size_t r = 0; r < piece->count; r++) {
        struct stretch *stretch = &out->of[out->count];
        if (cut->maybe[0][r] != cut->sure[0][r] || cut->maybe[1][r] != cut->sure[1][r]) {
            bool is_none_sure = cut->sure[0][r] > cut->sure[1][r];
            size_t at[3] = {0};
            at[walk->axes[1]] = piece->j + r;
            at[walk->axes[2]] = piece->k;
            ask(walk, at, cut->maybe[0][r], is_none_sure ? cut->maybe[1][r] + 1 : cut->sure[0][r]);
            ask(walk, at, is_none_sure ? cut->maybe[1][r] + 1 : cut->sure[1][r] + 1, cut->maybe[1][r] + 1);
        }
        if (cut->sure[0][r] <= cut->sure[1][r]) {
            stretch->first = (uint32_t)cut->sure[0][r];
            stretch->behind = (uint32_t)cut->sure[1][r] + 1;
            stretch->j = (uint32_t)(piece->j + r);
            label_runs_between(stretch->run, walk->runs, row + r, stretch->first, stretch->behind - 1);
            out->runs += stretch->run[1] - stretch->run[0] + 1;
            out->count++;
        }
    }
    out->of[out->count] = (struct stretch){0};
}

/* Run after run, whatever row it is in: rows of a few runs would be loops whose end the processor cannot guess. */
static void count_runs(const struct walk *walk, const struct piece *piece)
{
    const struct label_runs *runs = walk->runs;
    struct census *census = ((const struct areas *)walk->user)->census;
    struct stretches stretches;
    list_stretches(&stretches, walk, piece);
    const struct stretch *stretch = stretches.of;
    uint32_t run = stretch->run[0];
    uint32_t i = stretch->first;
    for (size_t left = stretches.runs; left > 0; left--) {
        bool ends = run == stretch->run[1];
        uint32_t next = ends ? stretch->behind : runs->starts[run + 1];
        add_run(census, runs->objects[run], walk->axes, (const size_t[]){i, stretch->j, piece->k}, next - i);
        stretch += ends;
        run = ends ? stretch->run[0] : run + 1;
        i = ends ? stretch->first : next;
    }
}

static void walk_piece(const struct walk *walk, const struct piece *piece)
{
    if (walk->runs) {
        count_runs(walk, piece);
        return;
    }
    for (size_t r = 0; r < piece->count; r++) {
        walk_row(walk, &piece->cut, r, piece->j + r, piece->k);
    }
}

/* Cuts the rows of a slice, and walks those that were cut before: two pieces take turns. */
static void cut_slice(struct walk *walk, struct piece pieces[2], size_t first, size_t last, size_t k)
{
    const size_t limit[2] = {walk->box->first[walk->axes[0]], walk->box->last[walk->axes[0]]};
    for (size_t j = first; j <= last; j += REGION_ROWS) {
        struct piece *piece = &pieces[walk->turn];
        walk->turn = !walk->turn;
        piece->j = j;
        piece->k = k;
        piece->count = smaller(last - j + 1, REGION_ROWS);
        walk->rows.cut(&piece->cut, &walk->rows, j, piece->count, limit);
        fetch_rows(walk, piece);
        walk_piece(walk, &pieces[walk->turn]);
    }
}

static void walk_slices(struct walk *walk)
{
    const struct volume *volume = walk->volume;
    const struct object_box *box = walk->box;
    const size_t *dim = volume->info.dim;
    const int in_slice = walk->axes[1];
    const int across = walk->axes[2];
    struct piece pieces[2];
    struct region_bounds bounds;
    size_t slices[2];
    for (size_t i = 0; i < 2; i++) {
        pieces[i].j = pieces[i].k = pieces[i].count = 0;
    }
    region_rows_init(&walk->rows, walk->region, volume, walk->axes);
    region_bounds_init(&bounds, walk->region, volume);
    if (bounds.depth[0] > bounds.depth[1] || box->last[0] < box->first[0] ||
        !region_bounds_range(slices, &bounds, across, bounds.depth, dim[across])) {
        return;
    }
    for (size_t k = larger(slices[0], box->first[across]); k <= smaller(slices[1], box->last[across]); k++) {
        double depth[2] = {bounds.depth[0], bounds.depth[1]};
        size_t rows[2];
        if (region_bounds_plane(depth, &bounds, across, (double)k) &&
            region_bounds_range(rows, &bounds, in_slice, depth, dim[in_slice])) {
            rows[0] = larger(rows[0], box->first[in_slice]);
            rows[1] = smaller(rows[1], box->last[in_slice]);
            region_rows_place(&walk->rows, k);
            if (region_rows_narrow(rows, &walk->rows)) {
                cut_slice(walk, pieces, rows[0], rows[1], k);
            }
        }
    }
    walk_piece(walk, &pieces[!walk->turn]);
}

void census_walk_box(const struct region *region, const struct volume *volume, const struct object_box *box,
                     census_row row, void *user)
{
    struct walk walk = {.region = region, .volume = volume, .row = row, .user = user, .box = box, .axes = STORED};
    walk_slices(&walk);
}

static struct object_box whole_box(const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    return (struct object_box){.last = {dim[0] - 1, dim[1] - 1, dim[2] - 1}};
}

void census_walk(const struct region *region, const struct volume *volume, census_row row, void *user)
{
    const struct object_box all = whole_box(volume);
    census_walk_box(region, volume, &all, row, user);
}

conus_status census_labels_create(struct census_labels **out, const conus_atlas *atlas)
{
    struct census_labels *labels = memory_zeroed(atlas->volume_count, sizeof *labels);
    if (!labels) {
        return CONUS_ERROR_MEMORY;
    }
    *out = labels;
    return CONUS_OK;
}

void census_labels_destroy(struct census_labels *labels, size_t count)
{
    for (size_t i = 0; labels && i < count; i++) {
        for (int a = 0; a < 3; a++) {
            label_runs_finish(&labels[i].runs[a]);
        }
    }
    memory_free(labels);
}

conus_status census_prepare(struct census *census, const conus_atlas *atlas, struct census_labels *labels)
{
    if (census->counts && census->object_count >= atlas->object_count) {
        return CONUS_OK;
    }
    struct census fresh = {.object_count = atlas->object_count, .labels = labels};
    fresh.counts = memory_zeroed(atlas->object_count + 1, sizeof *fresh.counts);
    fresh.touched = memory_raw(atlas->object_count + 1, sizeof *fresh.touched);
    if (!fresh.counts || !fresh.touched) {
        census_finish(&fresh);
        return CONUS_ERROR_MEMORY;
    }
    census_finish(census);
    *census = fresh;
    return CONUS_OK;
}

void census_finish(struct census *census)
{
    memory_free(census->counts);
    memory_free(census->touched);
    *census = (struct census){0};
}

static void add_areas(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct areas *areas = user;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    areas->counted += count;
    for (size_t done = 0; done < count;) {
        uint32_t object = volume_object(volume, first + done);
        size_t run = label_run_length(volume, first + done, count - done);
        add_run(areas->census, object, STORED, (const size_t[]){at[0] + done, at[1], at[2]}, run);
        done += run;
    }
}

static void add_values(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct census *census = user;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    for (size_t i = 0; i < count; i++) {
        i = volume_next(volume, first + i) - first;
        float stored = i < count ? volume_value(volume, first + i) : NAN;
        uint32_t object = volume_object_of(volume, stored);
        if (object) {
            const size_t voxel[3] = {at[0] + i, at[1], at[2]};
            add_run(census, object, STORED, voxel, 1);
            struct census_count *sum = &census->counts[object];
            double value = (double)stored;
            sum->maximum = sum->voxels > 1 ? fmax(sum->maximum, value) : value;
            sum->value += value;
            for (int a = 0; a < 3; a++) {
                sum->moment[a] += value * (double)voxel[a];
            }
        }
    }
}

static void count_areas(struct census *census, const struct region *region, const struct volume *volume,
                        struct census_labels *labels)
{
    struct areas areas = {.census = census};
    const struct object_box all = whole_box(volume);
    struct walk walk = {.region = region, .volume = volume, .row = add_areas, .user = &areas, .box = &all};
    double most = -1;
    double along[3];
    mat4_direction(along, volume->voxel_from_world, region->axis);
    for (int a = 0; a < 3 && atomic_load_explicit(&labels->has_runs, memory_order_acquire); a++) {
        if (labels->runs[a].rows && fabs(along[a]) > most) {
            most = fabs(along[a]);
            walk.runs = &labels->runs[a]; /* along the axis nearest to the region's own there are fewest rows */
        }
    }
    walk.axes = walk.runs ? walk.runs->axes : STORED;
    walk_slices(&walk);
    if (!walk.runs) {
        /* The thread that has counted as many voxels without runs, with all others, as the volume has, finds them,
         * which takes about as long. */
        size_t before = atomic_fetch_add(&labels->counted, areas.counted);
        if (before < volume->voxel_count && before + areas.counted >= volume->voxel_count) {
            for (int a = 0; a < 3; a++) {
                label_runs_init(&labels->runs[a], volume, a);
            }
            atomic_store_explicit(&labels->has_runs, true, memory_order_release);
        }
    }
}

void census_take(struct census *census, const conus_atlas *atlas, const struct region *region)
{
    for (size_t i = 0; i < census->touched_count; i++) {
        census->counts[census->touched[i]] = (struct census_count){0};
    }
    census->counts[0] = (struct census_count){0};
    census->touched_count = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (volume->info.role == CONUS_ROLE_PARCELLATION) {
            count_areas(census, region, volume, &census->labels[i]);
        } else if (volume_is_scalar(volume) && volume_can_be_hit(volume)) {
            census_walk_box(region, volume, &volume->box, add_values, census);
        }
    }
    order_sort(census->touched, census->touched_count, sizeof *census->touched, compare_u32);
}

bool census_is_weighted(const conus_atlas *atlas, uint32_t object)
{
    return volume_has_values(atlas_object_volume(atlas, object)) && !atlas->objects[object - 1].is_band;
}

void census_centroid(double out[3], const struct census *census, const conus_atlas *atlas, uint32_t object)
{
    const struct census_count *count = &census->counts[object];
    const struct volume *volume = atlas_object_volume(atlas, object);
    bool weighted = census_is_weighted(atlas, object);
    double index[3];
    for (int a = 0; a < 3; a++) {
        index[a] = weighted ? count->moment[a] / count->value : (double)count->index[a] / (double)count->voxels;
    }
    mat4_point(out, volume->info.world_from_voxel, index);
}
