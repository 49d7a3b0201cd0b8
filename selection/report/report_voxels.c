/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of the voxels that an answer holds, and of the points of its streamlines. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "selection/report/parts.h"

/* A voxel that is listed. */
struct listed_voxel {
    uint32_t object;
    uint64_t voxel;
    double distance;
};

static int by_voxel(const void *a, const void *b)
{
    const struct listed_voxel *x = a;
    const struct listed_voxel *y = b;
    int order = compare_unsigned(x->object, y->object);
    order = order ? order : compare_unsigned(x->voxel, y->voxel);
    return order ? order : compare_double(x->distance, y->distance);
}

static int by_distance(const void *a, const void *b)
{
    const struct listed_voxel *x = a;
    const struct listed_voxel *y = b;
    int order = compare_double(x->distance, y->distance);
    return order ? order : by_voxel(a, b);
}

static bool is_listed(const conus_report *report, uint32_t number)
{
    const conus_object *object = conus_atlas_object(report->atlas, number);
    return object && (object->kind == CONUS_KIND_PATHWAY || report->options.all_voxels);
}

/* Keeps each voxel once, with its smallest distance, nearest voxel first. */
static size_t keep_unique(struct listed_voxel *hits, size_t count)
{
    size_t kept = 0;
    order_sort(hits, count, sizeof *hits, by_voxel);
    for (size_t i = 0; i < count; i++) {
        if (!kept || hits[kept - 1].object != hits[i].object || hits[kept - 1].voxel != hits[i].voxel) {
            hits[kept++] = hits[i];
        }
    }
    order_sort(hits, kept, sizeof *hits, by_distance);
    return kept;
}

/* The cells up to k. */
static void begin_row(conus_report *report, const conus_object *object)
{
    const struct report_query *query = &report->queries[report->query_count - 1];
    const conus_row_marks *marks = report_marks(report);
    buffer_format(&report->voxels, "%s%s%s\t", query->id, report->name ? "\t" : "", report->name ? report->name : "");
    if (marks && marks->has_number) {
        buffer_format(&report->voxels, "%llu\t", (unsigned long long)query->number);
    }
    buffer_text(&report->voxels, object->name);
}

/* The cells from x on; @p point in the world, @p value NAN = there is none. */
static void end_row(conus_report *report, const conus_object *object, double point[3], double value, double distance)
{
    report_point(report, point);
    const double numbers[] = {point[0], point[1], point[2], value, distance};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        buffer_text(&report->voxels, isnan(numbers[i]) ? "\tn/a" : "\t");
        if (!isnan(numbers[i])) {
            buffer_number(&report->voxels, numbers[i]);
        }
    }
    buffer_format(&report->voxels, "\t%s\t%u\n", atlas_kind_word(object->kind), object->label);
}

static void write_voxel(conus_report *report, const struct listed_voxel *voxel)
{
    const conus_object *object = conus_atlas_object(report->atlas, voxel->object);
    const struct volume *volume = atlas_object_volume(report->atlas, voxel->object);
    const size_t *dim = volume->info.dim;
    const size_t at[3] = {voxel->voxel % dim[0], voxel->voxel / dim[0] % dim[1], voxel->voxel / dim[0] / dim[1]};
    double point[3] = {(double)at[0], (double)at[1], (double)at[2]};
    mat4_point(point, volume->info.world_from_voxel, point);
    begin_row(report, object);
    buffer_format(&report->voxels, "\t%zu\t%zu\t%zu", at[0], at[1], at[2]);
    double value = volume_has_values(volume) ? (double)volume_value(volume, voxel->voxel) : object->label;
    end_row(report, object, point, value, voxel->distance);
}

static conus_status add_first_hits(conus_report *report, const conus_selection *selection)
{
    const struct evidence *evidence = &selection->evidence;
    size_t pixels = (size_t)evidence->resolution * evidence->resolution;
    size_t count = 0;
    struct listed_voxel *hits = memory_raw(pixels, sizeof *hits);
    if (!hits) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < pixels; i++) {
        uint32_t number = selection_own_object(selection, i);
        if (selection->in_cone[i] && is_listed(report, number) && atlas_object_volume(report->atlas, number)) {
            hits[count++] = (struct listed_voxel){number, evidence->voxel[i], evidence->distance[i]};
        }
    }
    count = keep_unique(hits, count);
    for (size_t i = 0; i < count; i++) {
        write_voxel(report, &hits[i]);
    }
    memory_free(hits);
    return CONUS_OK;
}

struct listing {
    const conus_report *report;
    const double *from;        /* distances are from here */
    struct listed_voxel *hits; /* NULL: only count them   */
    size_t count;
};

static void list_row(void *user, const struct volume *volume, const size_t at[3], size_t count)
{
    struct listing *listing = user;
    size_t first = at[0] + volume->info.dim[0] * (at[1] + volume->info.dim[1] * at[2]);
    for (size_t i = 0; i < count; i++) {
        uint32_t object = volume_object(volume, first + i);
        if (!is_listed(listing->report, object)) {
            continue;
        }
        if (listing->hits) {
            double p[3] = {(double)(at[0] + i), (double)at[1], (double)at[2]};
            mat4_point(p, volume->info.world_from_voxel, p);
            vec3_sub(p, p, listing->from);
            listing->hits[listing->count] = (struct listed_voxel){object, first + i, vec3_length(p)};
        }
        listing->count++;
    }
}

static void list_voxels(struct listing *listing, const conus_selection *selection)
{
    const conus_atlas *atlas = selection->atlas;
    listing->count = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(&atlas->volumes[i])) {
            census_walk(&selection->region, &atlas->volumes[i], list_row, listing);
        }
    }
}

static conus_status add_all(conus_report *report, const conus_selection *selection)
{
    struct listing listing = {.report = report, .from = selection->region.origin};
    list_voxels(&listing, selection);
    listing.hits = memory_raw(listing.count, sizeof *listing.hits);
    if (!listing.hits) {
        return CONUS_ERROR_MEMORY;
    }
    list_voxels(&listing, selection);
    order_sort(listing.hits, listing.count, sizeof *listing.hits, by_distance);
    for (size_t i = 0; i < listing.count; i++) {
        write_voxel(report, &listing.hits[i]);
    }
    memory_free(listing.hits);
    return CONUS_OK;
}

/* The points of a tractogram that are in a region. */
struct near_points {
    const struct tractogram *tractogram;
    const struct region *region;
    uint64_t *points; /* their numbers */
    size_t count, capacity;
    bool failed;
};

/* Both ends of a run are points: the last one is the next run's, unless the streamline ends there. */
static void add_run(void *user, const struct tract_run *run, const struct tract_part *part)
{
    struct near_points *near = user;
    (void)part;
    uint64_t end = run->point + run->segments;
    end += end + 1 == near->tractogram->first[run->streamline + 1];
    if (near->failed ||
        !memory_reserve(&near->points, &near->capacity, near->count + TRACT_RUN + 1, sizeof(uint64_t))) {
        near->failed = true;
        return;
    }
    for (uint64_t i = run->point; i < end; i++) {
        double at[3];
        tractogram_point(at, near->tractogram, i);
        if (region_has(near->region, at)) {
            near->points[near->count++] = i;
        }
    }
}

static void write_bundle(conus_report *report, const struct near_points *near, uint32_t number)
{
    const struct tract_group *group = atlas_bundle_group(report->atlas, number);
    uint32_t streamline = 0;
    bool is_in = false;
    for (size_t i = 0; i < near->count; i++) {
        if (i == 0 || near->points[i] >= near->tractogram->first[streamline + 1]) {
            streamline = tractogram_streamline_of(near->tractogram, near->points[i]);
            is_in = tract_group_has(group, streamline);
        }
        if (is_in) {
            const conus_object *object = conus_atlas_object(report->atlas, number);
            double at[3];
            double away[3];
            tractogram_point(at, near->tractogram, near->points[i]);
            vec3_sub(away, at, near->region->origin);
            begin_row(report, object);
            buffer_format(&report->voxels, "\t%u\t%llu\tn/a", streamline,
                          (unsigned long long)(near->points[i] - near->tractogram->first[streamline]));
            end_row(report, object, at, NAN, vec3_length(away));
        }
    }
}

static conus_status add_points(conus_report *report, const conus_selection *selection)
{
    const conus_atlas *atlas = selection->atlas;
    struct near_points near = {.region = &selection->region};
    conus_status status = CONUS_OK;
    for (uint32_t number = (uint32_t)atlas->area_count + 1; number <= atlas->object_count && !status; number++) {
        const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
        if (!tractogram || atlas->places[number - 1].is_hidden) {
            continue;
        }
        if (tractogram != near.tractogram) { /* bundles of a tractogram follow each other */
            near.tractogram = tractogram;
            near.count = 0;
            tract_census_walk(tractogram, near.region, add_run, &near);
            order_sort(near.points, near.count, sizeof *near.points, compare_u64);
        }
        status = near.failed ? CONUS_ERROR_MEMORY : CONUS_OK;
        if (!status) {
            write_bundle(report, &near, number);
        }
    }
    memory_free(near.points);
    return status;
}

conus_status report_add_voxels(conus_report *report, const conus_selection *selection)
{
    bool all = selection->has_layers || selection->region.shape == REGION_BALL;
    conus_status status = all ? add_all(report, selection) : add_first_hits(report, selection);
    status = status || !all ? status : add_points(report, selection);
    return status ? status : buffer_status(&report->voxels);
}
