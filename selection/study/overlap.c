/* SPDX-License-Identifier: BSD-3-Clause */
/* Counts the parts of a region's voxels in each object (Eq. 16). */
#include "selection/study/overlap.h"

#include "atlas/roi.h"
#include "atlas/space.h"
#include "atlas/surface/mesh_lines.h"
#include "base/math3.h"
#include "base/memory.h"
#include "selection/selector.h"

#include <stdlib.h>
#include <string.h>

enum { PARTS_LIMIT = 8 };            /* along an axis */
static const double PART_MM = 1;     /* the largest a part may be, whatever the atlas's voxels are */
static const double ROUNDING = 1e-4; /* of an edge's length: headers hold it in single precision */

/* What has been found of an object, as it is reported; number 0 is of nothing. */
struct tally_of_parts {
    uint64_t parts;
    uint64_t last;     /* part, from 1, that was counted last: an object that is met twice there counts once */
    size_t peak_voxel; /* where parts > 0 */
};

/* A mesh on the line under way: its crossings, of which those up to the part are behind. */
struct crossed {
    uint32_t object;
    const struct line_crossing *next, *end;
    int winding;
};

struct counting {
    const conus_selector *selector;
    const conus_roi *roi;
    struct conus_overlap *overlap;
    struct tally_of_parts *tallies; /* [object_count + 1] */
    struct mesh_lines lines; /* through the middles of the parts along k, in voxels of the region from the middle of its
                                first one's first part on, times parts */
    struct crossed *crossed; /* [object_count] */
    size_t crossed_count;
    uint64_t part; /* the one under way, from 1 */
};

/* ---- Parts ------------------------------------------------------------------------------------------------------ */

/* Along each axis as many as make them no larger than the smallest voxel of the atlas, and than PART_MM. */
static void choose_parts(struct counting *counting)
{
    const conus_atlas *atlas = counting->selector->atlas;
    const double *spacing = counting->roi->volume.info.spacing;
    double largest = PART_MM;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const double *other = atlas->volumes[i].info.spacing;
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT) {
            largest = fmin(largest, fmin(other[0], fmin(other[1], other[2])));
        }
    }
    for (int a = 0; a < 3; a++) {
        double parts = ceil(spacing[a] / largest - ROUNDING);
        counting->overlap->parts[a] = (size_t)fmax(1, fmin(parts, PARTS_LIMIT));
    }
}

/* Index coordinate, in voxels of the region, of the middle of a part. */
static double middle_of(const struct counting *counting, size_t part, int axis)
{
    return ((double)part + 0.5) / (double)counting->overlap->parts[axis] - 0.5;
}

/* ---- Meshes ----------------------------------------------------------------------------------------------------- */

/* From world mm to numbers of parts, from the first one in the region's bounds on. */
static void find_frame(double out[16], const struct counting *counting)
{
    const conus_roi *roi = counting->roi;
    double parts_from_voxel[16] = {[15] = 1};
    for (int a = 0; a < 3; a++) {
        double parts = (double)counting->overlap->parts[a];
        parts_from_voxel[5 * a] = parts;
        parts_from_voxel[12 + a] = (0.5 - (double)roi->low[a]) * parts - 0.5;
    }
    mat4_multiply(out, parts_from_voxel, roi->volume.voxel_from_world);
}

static conus_status cross_meshes(struct counting *counting)
{
    const conus_atlas *atlas = counting->selector->atlas;
    double frame[16];
    conus_status status = CONUS_OK;
    find_frame(frame, counting);
    for (int a = 0; a < 2; a++) {
        counting->lines.step[a] = 1;
        counting->lines.count[a] = (counting->roi->high[a] - counting->roi->low[a] + 1) * counting->overlap->parts[a];
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        size_t count = mesh && atlas->objects[number - 1].closed ? mesh->triangle_count : 0;
        for (size_t i = 0; !status && i < count; i++) {
            status = mesh_lines_cross(&counting->lines, number, mesh, i, frame);
        }
    }
    mesh_lines_sort(&counting->lines);
    return status;
}

/* First crossing of line `line` or a later one. */
static size_t first_crossing(const struct mesh_lines *lines, size_t line)
{
    size_t first = 0;
    for (size_t end = lines->crossing_count; first < end;) {
        size_t middle = first + (end - first) / 2;
        if (lines->crossings[middle].line < line) {
            first = middle + 1;
        } else {
            end = middle;
        }
    }
    return first;
}

/* Makes counting->crossed of the line's crossings. */
static void enter_line(struct counting *counting, size_t line)
{
    const struct mesh_lines *lines = &counting->lines;
    counting->crossed_count = 0;
    for (size_t i = first_crossing(lines, line); i < lines->crossing_count && lines->crossings[i].line == line; i++) {
        const struct line_crossing *crossing = &lines->crossings[i];
        struct crossed *last = &counting->crossed[counting->crossed_count ? counting->crossed_count - 1 : 0];
        if (!counting->crossed_count || last->object != crossing->object) {
            last = &counting->crossed[counting->crossed_count++];
            *last = (struct crossed){.object = crossing->object, .next = crossing};
        }
        last->end = crossing + 1;
    }
}

/* ---- Counting --------------------------------------------------------------------------------------------------- */

/* Whether the voxel's value is farther from 0 than that of the peak, or as far and earlier in the file. */
static bool is_peak(const struct counting *counting, size_t voxel, size_t peak)
{
    const float *values = counting->roi->volume.values;
    double sign = counting->roi->volume.info.threshold < 0 ? -1 : 1;
    double more = sign * ((double)values[voxel] - (double)values[peak]);
    return more > 0 || (more == 0 && voxel < peak);
}

static void count_object(struct counting *counting, uint32_t object, size_t voxel)
{
    struct tally_of_parts *tally = &counting->tallies[level_group(counting->selector->level)[object]];
    if (tally->last == counting->part) {
        return;
    }
    if (!tally->parts || is_peak(counting, voxel, tally->peak_voxel)) {
        tally->peak_voxel = voxel;
    }
    tally->last = counting->part;
    tally->parts++;
}

/* Counts the objects of volumes that hold the point. Returns whether there are any. */
static bool count_in_volumes(struct counting *counting, const double point[3], size_t voxel)
{
    const conus_atlas *atlas = counting->selector->atlas;
    bool any = false;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        size_t at;
        if (volume->info.role == CONUS_ROLE_CONTEXT || !volume_can_be_hit(volume) ||
            !volume_find_voxel(&at, volume, point)) {
            continue;
        }
        uint32_t object = volume_object(volume, at);
        if (object) {
            count_object(counting, object, voxel);
            any = true;
        }
    }
    return any;
}

/* Counts the meshes around the middle of part `k` of the line, likewise; the parts of a line come in their order. */
static bool count_in_meshes(struct counting *counting, size_t k, size_t voxel)
{
    bool any = false;
    for (size_t i = 0; i < counting->crossed_count; i++) {
        struct crossed *crossed = &counting->crossed[i];
        while (crossed->next < crossed->end && crossed->next->z <= (double)k) {
            crossed->winding += crossed->next++->side;
        }
        if (crossed->winding) {
            count_object(counting, crossed->object, voxel);
            any = true;
        }
    }
    return any;
}

/* Counts the parts of one line, which is `part` of each of the voxels of column at[0], at[1] of the region. */
static void count_line(struct counting *counting, const size_t part[2], size_t line)
{
    const conus_roi *roi = counting->roi;
    const size_t *dim = roi->volume.info.dim;
    const size_t *parts = counting->overlap->parts;
    size_t count = (roi->high[2] - roi->low[2] + 1) * parts[2];
    size_t column = part[0] / parts[0] + dim[0] * (part[1] / parts[1]);
    enter_line(counting, line);
    for (size_t k = 0; k < count; k++) {
        size_t along = k + roi->low[2] * parts[2];
        size_t voxel = column + dim[0] * dim[1] * (along / parts[2]);
        if (!roi_has(roi, voxel)) {
            continue;
        }
        double point[3] = {middle_of(counting, part[0], 0), middle_of(counting, part[1], 1),
                           middle_of(counting, along, 2)};
        mat4_point(point, roi->volume.info.world_from_voxel, point);
        counting->part++;
        bool in_volume = count_in_volumes(counting, point, voxel);
        if (!count_in_meshes(counting, k, voxel) && !in_volume) {
            count_object(counting, 0, voxel);
        }
    }
}

static void count_parts(struct counting *counting)
{
    const conus_roi *roi = counting->roi;
    const size_t *parts = counting->overlap->parts;
    const size_t *count = counting->lines.count;
    for (size_t line = 0; line < count[0] * count[1]; line++) {
        const size_t part[2] = {roi->low[0] * parts[0] + line % count[0], roi->low[1] * parts[1] + line / count[0]};
        count_line(counting, part, line);
    }
}

/* ---- Rows ------------------------------------------------------------------------------------------------------- */

static conus_coverage describe(const struct counting *counting, uint32_t object)
{
    const struct tally_of_parts *tally = &counting->tallies[object];
    const struct volume *volume = &counting->roi->volume;
    const size_t *dim = volume->info.dim;
    size_t voxel = tally->peak_voxel;
    const size_t at[3] = {voxel % dim[0], voxel / dim[0] % dim[1], voxel / dim[0] / dim[1]};
    double part_of_region = (double)tally->parts / (double)counting->part;
    double whole = object ? counting->selector->whole[object] : 0;
    conus_coverage row = {.kind = object ? conus_atlas_object(counting->selector->atlas, object)->kind
                                         : CONUS_KIND_UNASSIGNED,
                          .object = object,
                          .volume = part_of_region * counting->overlap->volume_mm3,
                          .roi_fraction = part_of_region,
                          .peak = (double)volume->values[voxel]};
    row.fraction = whole > 0 ? fmin(row.volume / whole, 1) : NAN;
    for (int a = 0; a < 3; a++) {
        row.peak_point[a] = (double)at[a];
    }
    mat4_point(row.peak_point, volume->info.world_from_voxel, row.peak_point);
    return row;
}

static int compare_rows(const void *a, const void *b)
{
    const conus_coverage *x = a;
    const conus_coverage *y = b;
    if (!x->object != !y->object) {
        return x->object ? -1 : 1;
    }
    if (x->volume != y->volume) {
        return x->volume > y->volume ? -1 : 1;
    }
    return (x->object > y->object) - (x->object < y->object);
}

static void fill_rows(struct counting *counting)
{
    struct conus_overlap *overlap = counting->overlap;
    for (uint32_t object = 0; object <= counting->selector->atlas->object_count; object++) {
        if (counting->tallies[object].parts) {
            overlap->rows[overlap->count++] = describe(counting, object);
        }
    }
    qsort(overlap->rows, overlap->count, sizeof *overlap->rows, compare_rows);
}

static conus_status build(struct conus_overlap *overlap, const conus_selector *selector, const conus_roi *roi)
{
    const conus_volume_info *info = &roi->volume.info;
    size_t count = selector->atlas->object_count + 1;
    struct counting counting = {.selector = selector, .roi = roi, .overlap = overlap};
    overlap->threshold = info->threshold;
    overlap->volume = info->volume;
    overlap->volume_mm3 = (double)roi->voxels * space_voxel_mm3(info);
    memcpy(overlap->sha256, info->sha256, sizeof overlap->sha256);
    overlap->path = memory_text(info->path, strlen(info->path));
    overlap->rows = memory_raw(count, sizeof *overlap->rows);
    counting.tallies = memory_zeroed(count, sizeof *counting.tallies);
    counting.crossed = memory_raw(count, sizeof *counting.crossed);
    bool fits = overlap->path && overlap->rows && counting.tallies && counting.crossed;
    choose_parts(&counting);
    conus_status status = fits ? cross_meshes(&counting) : CONUS_ERROR_MEMORY;
    if (!status) {
        count_parts(&counting);
        fill_rows(&counting);
    }
    mesh_lines_finish(&counting.lines);
    memory_free(counting.tallies);
    memory_free(counting.crossed);
    return status;
}

conus_status conus_overlap_create(conus_overlap **out, const conus_selector *selector, const conus_roi *roi)
{
    if (!out || !selector || !roi) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_overlap_create: a result, a selector and a region are needed");
    }
    conus_overlap *overlap = memory_zeroed(1, sizeof *overlap);
    conus_status status = overlap ? build(overlap, selector, roi) : CONUS_ERROR_MEMORY;
    if (status) {
        conus_overlap_destroy(overlap);
        return status;
    }
    *out = overlap;
    return CONUS_OK;
}

void conus_overlap_destroy(conus_overlap *overlap)
{
    if (overlap) {
        memory_free(overlap->rows);
        memory_free(overlap->path);
        memory_free(overlap);
    }
}

size_t conus_overlap_count(const conus_overlap *overlap)
{
    return overlap ? overlap->count : 0;
}

const conus_coverage *conus_overlap_coverage(const conus_overlap *overlap, size_t index)
{
    return overlap && index < overlap->count ? &overlap->rows[index] : NULL;
}
