/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/math3.h"
#include "base/memory.h"
#include "selection/report.h"

#include <stdlib.h>

/* A voxel that some pixels met first. */
struct met {
    uint32_t object;
    uint64_t voxel;
    double distance;
};

static int by_voxel(const void *a, const void *b)
{
    const struct met *x = a;
    const struct met *y = b;
    if (x->object != y->object) {
        return x->object > y->object ? 1 : -1;
    }
    if (x->voxel != y->voxel) {
        return x->voxel > y->voxel ? 1 : -1;
    }
    return (x->distance > y->distance) - (x->distance < y->distance);
}

static int by_distance(const void *a, const void *b)
{
    const struct met *x = a;
    const struct met *y = b;
    return x->distance != y->distance ? (x->distance > y->distance ? 1 : -1) : by_voxel(a, b);
}

static size_t collect(struct met *met, const conus_report *report, const conus_selection *selection)
{
    const struct evidence *evidence = &selection->evidence;
    size_t pixels = (size_t)evidence->resolution * evidence->resolution;
    size_t count = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t number = selection_own_object(selection, i);
        const conus_object *object = conus_atlas_object(report->atlas, number);
        if (object && selection->in_cone[i] && atlas_object_volume(report->atlas, number) &&
            (object->kind == CONUS_PATHWAY || report->options.all_voxels)) {
            met[count++] = (struct met){number, evidence->voxel[i], evidence->distance[i]};
        }
    }
    return count;
}

/* Keeps each voxel once, with its smallest distance, nearest voxel first. */
static size_t unique(struct met *met, size_t count)
{
    size_t kept = 0;
    qsort(met, count, sizeof *met, by_voxel);
    for (size_t i = 0; i < count; i++) {
        if (!kept || met[kept - 1].object != met[i].object || met[kept - 1].voxel != met[i].voxel) {
            met[kept++] = met[i];
        }
    }
    qsort(met, kept, sizeof *met, by_distance);
    return kept;
}

static void write_voxel(conus_report *report, const struct met *met)
{
    const conus_object *object = conus_atlas_object(report->atlas, met->object);
    const struct volume *volume = atlas_object_volume(report->atlas, met->object);
    const size_t *dim = volume->info.dim;
    const size_t at[3] = {met->voxel % dim[0], met->voxel / dim[0] % dim[1], met->voxel / dim[0] / dim[1]};
    double point[3] = {(double)at[0], (double)at[1], (double)at[2]};
    mat4_point(point, volume->info.world_from_voxel, point);
    report_point(report, point);
    const char *query = report->queries[report->query_count - 1].id;
    buffer_format(&report->voxels, "%s\t%s\t%zu\t%zu\t%zu", query, object->name, at[0], at[1], at[2]);
    double value = volume->values ? (double)volume->values[met->voxel] : object->label;
    const double numbers[] = {point[0], point[1], point[2], value, met->distance};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        buffer_text(&report->voxels, "\t");
        buffer_number(&report->voxels, numbers[i]);
    }
    buffer_format(&report->voxels, "\t%s\t%u\n", report_kind(object->kind), object->label);
}

conus_status report_add_voxels(conus_report *report, const conus_selection *selection)
{
    size_t pixels = (size_t)selection->evidence.resolution * selection->evidence.resolution;
    struct met *met = memory_raw(pixels, sizeof *met);
    if (!met) {
        return CONUS_ERROR_MEMORY;
    }
    size_t count = unique(met, collect(met, report, selection));
    for (size_t i = 0; i < count; i++) {
        write_voxel(report, &met[i]);
    }
    memory_free(met);
    return buffer_status(&report->voxels);
}
