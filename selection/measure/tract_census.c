/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the streamlines in a region. */
#include "selection/measure/measure.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "selection/region/region.h"

#include <string.h>

static const double PARTS = 0x1p40; /* in a mm */

static void carry(struct tract_part *part)
{
    part->whole_mm += part->parts >> 40;
    part->parts &= ((uint64_t)1 << 40) - 1;
}

static void add_length(struct tract_part *part, double mm)
{
    int64_t whole = (int64_t)mm; /* only for numbers that are not negative; conversions with a sign are the fast ones */
    part->whole_mm += (uint64_t)whole;
    part->parts += (uint64_t)(int64_t)((mm - (double)whole) * PARTS + 0.5);
    carry(part);
}

double tract_part_length(const struct tract_part *part)
{
    return (double)part->whole_mm + (double)part->parts / PARTS;
}

/* The point of the piece s of a segment that is nearest to the origin. */
static void add_nearest(struct tract_part *part, uint64_t point, double ends[2][3], const double s[2],
                        const double origin[3])
{
    double v[3];
    double u[3];
    double at[3];
    vec3_sub(v, ends[0], origin);
    vec3_sub(u, ends[1], ends[0]);
    double square = vec3_dot(u, u);
    double foot = square > 0 ? -vec3_dot(v, u) / square : 0;
    foot = fmin(fmax(foot, s[0]), s[1]);
    vec3_add_scaled(at, v, foot, u);
    double away = vec3_dot(at, at);
    if (away < part->square) { /* segments come in order */
        part->square = away;
        part->point = point;
        part->s = foot;
        vec3_add_scaled(part->near, ends[0], foot, u);
    }
}

static void add_segment(struct tract_part *part, const struct region *region, uint64_t point, double ends[2][3],
                        const bool inside[2])
{
    double s[2];
    double step[3];
    if (region_segment(s, region, ends, inside)) {
        part->streamlines = 1;
        vec3_sub(step, ends[1], ends[0]);
        add_length(part, vec3_length(step) * (s[1] - s[0]));
        add_nearest(part, point, ends, s, region->origin);
    }
}

/* The part of the run in the region; `whole`: all of it. */
static struct tract_part measure_run(const struct tractogram *tractogram, const struct region *region,
                                     const struct tract_run *run, bool whole)
{
    struct tract_part part = {.streamline = run->streamline, .square = INFINITY};
    double points[TRACT_RUN + 1][3];
    bool inside[TRACT_RUN + 1];
    for (uint32_t i = 0; i <= run->segments; i++) {
        tractogram_point(points[i], tractogram, run->point + i);
        inside[i] = whole || region_has(region, points[i]);
    }
    for (uint32_t i = 0; i < run->segments; i++) {
        add_segment(&part, region, run->point + i, points + i, inside + i);
    }
    if (run->segments == 0 && inside[0]) { /* one point: a segment of no length */
        memcpy(points[1], points[0], sizeof points[0]);
        add_segment(&part, region, run->point, points, (const bool[]){true, true});
    }
    return part;
}

struct walk {
    const struct tractogram *tractogram;
    const struct region *region;
    tract_run_inside visit;
    void *user;
};

static enum tract_answer test_box(void *user, const double low[3], const double high[3])
{
    const struct walk *walk = user;
    return region_box(walk->region, low, high);
}

static void visit_run(void *user, const struct tract_run *run, bool inside)
{
    const struct walk *walk = user;
    struct tract_part part = measure_run(walk->tractogram, walk->region, run, inside);
    if (part.streamlines) {
        walk->visit(walk->user, run, &part);
    }
}

void tract_census_walk(const struct tractogram *tractogram, const struct region *region, tract_run_inside visit,
                       void *user)
{
    struct walk walk = {.tractogram = tractogram, .region = region, .visit = visit, .user = user};
    tract_tree_walk(tractogram, test_box, visit_run, &walk);
}

static void mark(void *user, const struct tract_run *run, const struct tract_part *part)
{
    bool *marks = user;
    (void)part;
    marks[run->streamline] = true;
}

conus_status tract_census_list(uint32_t **out, size_t *count, const conus_atlas *atlas, uint32_t number,
                               const struct region *region)
{
    const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
    const struct tract_group *group = atlas_bundle_group(atlas, number);
    size_t members = tract_group_count(group, tractogram);
    bool *marks = memory_zeroed(tractogram->streamline_count, sizeof *marks);
    uint32_t *list = memory_raw(members, sizeof *list);
    if (!marks || !list) {
        memory_free(marks);
        memory_free(list);
        return CONUS_ERROR_MEMORY;
    }
    tract_census_walk(tractogram, region, mark, marks);
    *count = 0;
    for (size_t i = 0; i < members; i++) {
        uint32_t k = tract_group_member(group, i);
        if (marks[k]) {
            list[(*count)++] = k;
        }
    }
    memory_free(marks);
    *out = list;
    return CONUS_OK;
}

conus_status tract_census_prepare(struct tract_census *census, const struct tract_index *index,
                                  const conus_atlas *atlas)
{
    if (census->parts) {
        return CONUS_OK;
    }
    struct tract_census fresh = {0};
    fresh.parts = memory_raw(atlas->object_count + 1, sizeof *fresh.parts);
    fresh.touched = memory_raw(atlas->object_count + 1, sizeof *fresh.touched);
    fresh.seen = memory_zeroed(index->streamline_count, sizeof *fresh.seen);
    if (!fresh.parts || !fresh.touched || !fresh.seen) {
        tract_census_finish(&fresh);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t number = 0; number <= atlas->object_count; number++) {
        fresh.parts[number].streamlines = 0;
    }
    *census = fresh;
    return CONUS_OK;
}

void tract_census_finish(struct tract_census *census)
{
    memory_free(census->parts);
    memory_free(census->touched);
    memory_free(census->seen);
    *census = (struct tract_census){0};
}

/* The tractogram of a take under way. */
struct taking {
    struct tract_census *census;
    const conus_atlas *atlas;
    const struct tract_owners *owners;
};

static void add_run(void *user, const struct tract_run *run, const struct tract_part *part)
{
    const struct taking *taking = user;
    const struct tract_owners *owners = taking->owners;
    struct tract_census *census = taking->census;
    uint32_t *seen = &census->seen[owners->before + run->streamline];
    bool is_first = *seen != census->region;
    *seen = census->region;
    uint64_t first = owners->all ? 0 : owners->first[run->streamline];
    uint64_t end = owners->all ? 1 : owners->first[run->streamline + 1];
    for (uint64_t i = first; i < end; i++) {
        uint32_t number = owners->all ? owners->all : owners->bundles[i];
        if (!taking->atlas->places[number - 1].is_hidden) {
            struct tract_part *sum = &census->parts[number];
            if (!sum->streamlines) {
                *sum = (struct tract_part){.square = INFINITY};
                census->touched[census->touched_count++] = number;
            }
            sum->streamlines += is_first;
            sum->whole_mm += part->whole_mm;
            sum->parts += part->parts;
            carry(sum);
            if (part->square < sum->square || (part->square == sum->square && part->point < sum->point)) {
                sum->square = part->square;
                sum->streamline = part->streamline;
                sum->point = part->point;
                sum->s = part->s;
                memcpy(sum->near, part->near, sizeof sum->near);
            }
        }
    }
}

void tract_census_take(struct tract_census *census, const struct tract_index *index, const conus_atlas *atlas,
                       const struct region *region)
{
    for (size_t i = 0; i < census->touched_count; i++) {
        census->parts[census->touched[i]].streamlines = 0;
    }
    census->touched_count = 0;
    if (++census->region == 0) { /* after 2^32 of them */
        memset(census->seen, 0, index->streamline_count * sizeof *census->seen);
        census->region = 1;
    }
    for (size_t i = 0; i < index->tractogram_count; i++) {
        struct taking taking = {.census = census, .atlas = atlas, .owners = &index->of[i]};
        tract_census_walk(&atlas->tractograms[i], region, add_run, &taking);
    }
    order_sort(census->touched, census->touched_count, sizeof *census->touched, compare_u32);
}
