/* SPDX-License-Identifier: BSD-3-Clause */
/* Classifies the voxels of pathways by their transfer functions before they are interpolated: colours times extinction,
 * so that no colour bleeds from where nothing is. */
#include "render/colour/colour.h"

#include "atlas/volume.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "render/image/image.h"

#include <limits.h>
#include <string.h>

/* The values of the pathway: from where it begins to its largest. */
static void find_span(double span[2], const conus_atlas *atlas, uint32_t number)
{
    const struct volume *volume = atlas_object_volume(atlas, number);
    span[0] = INFINITY;
    span[1] = -INFINITY;
    for (size_t v = volume_next(volume, 0); v < volume->voxel_count; v = volume_next(volume, v + 1)) {
        if (volume_object(volume, v) == number) {
            span[0] = fmin(span[0], (double)volume_value(volume, v));
            span[1] = fmax(span[1], (double)volume_value(volume, v));
        }
    }
    bool is_band = atlas->objects[number - 1].is_band;
    span[0] = is_band ? span[0] : volume->info.threshold;
    if (!(span[1] > span[0])) {
        span[1] = span[0] + 1;
    }
}

static conus_status choose_one(struct haze_choice *choice, const conus_atlas *atlas, uint32_t number, const char *name)
{
    struct transfer *transfer = &choice->transfers[number];
    conus_status status;
    transfer_finish(transfer);
    if (strcmp(name, "own") == 0) { /* the pathway's own colour, thin where it begins */
        conus_transfer_point points[2] = {{0, {0, 0, 0, 0.02}}, {1, {0, 0, 0, 0.4}}};
        for (int c = 0; c < 3; c++) {
            points[0].rgba[c] = points[1].rgba[c] = atlas->objects[number - 1].rgb[c] / 255.0;
        }
        status = transfer_copy(transfer, points, 2);
        transfer->relative = true;
    } else {
        status = transfer_load(transfer, name);
    }
    if (status || !transfer->relative) {
        return status;
    }
    double span[2];
    find_span(span, atlas, number);
    for (size_t i = 0; i < transfer->count; i++) {
        transfer->points[i].value = span[0] + transfer->points[i].value * (span[1] - span[0]);
    }
    transfer->relative = false;
    return CONUS_OK;
}

static bool is_pathway(const conus_atlas *atlas, uint32_t number)
{
    const conus_object *object = conus_atlas_object(atlas, number);
    return object && object->kind == CONUS_KIND_PATHWAY;
}

/* Entries for all pathways come first, whatever their order, so that entries for one replace them. */
static conus_status choose_pass(struct haze_choice *out, const conus_atlas *atlas,
                                const conus_renderer_options *options, bool all)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < options->pathway_count && !status; i++) {
        const conus_pathway_transfer *entry = &options->pathways[i];
        if (entry->pathway && !is_pathway(atlas, entry->pathway)) {
            return fail(CONUS_ERROR_ARGUMENT, "transfer function of object %u, which is no pathway", entry->pathway);
        }
        if ((entry->pathway == 0) == all) {
            uint32_t first = all ? (uint32_t)atlas->area_count + 1 : entry->pathway;
            uint32_t last = all ? (uint32_t)atlas->object_count : entry->pathway;
            for (uint32_t number = first; number <= last && !status; number++) {
                status = is_pathway(atlas, number) ? choose_one(out, atlas, number, entry->transfer) : CONUS_OK;
            }
        }
    }
    return status;
}

conus_status haze_choose(struct haze_choice *out, const conus_atlas *atlas, const conus_renderer_options *options)
{
    if (!options->pathway_count) {
        return CONUS_OK;
    }
    bool has_pathways = false;
    for (uint32_t number = 1; number <= atlas->object_count && !has_pathways; number++) {
        has_pathways = is_pathway(atlas, number);
    }
    if (!has_pathways) {
        return fail(CONUS_ERROR_ARGUMENT, "transfer function of pathways: the atlas has none");
    }
    out->object_count = atlas->object_count;
    out->transfers = memory_zeroed(atlas->object_count + 1, sizeof *out->transfers);
    conus_status status = out->transfers ? choose_pass(out, atlas, options, true) : CONUS_ERROR_MEMORY;
    return status ? status : choose_pass(out, atlas, options, false);
}

void haze_choice_finish(struct haze_choice *choice)
{
    for (size_t n = 0; choice->transfers && n <= choice->object_count; n++) {
        transfer_finish(&choice->transfers[n]);
    }
    memory_free(choice->transfers);
    *choice = (struct haze_choice){0};
}

void haze_colour_at(double rgba[4], const conus_atlas *atlas, const struct haze_choice *choice, uint32_t number,
                    const double world[3])
{
    const struct volume *volume = atlas_object_volume(atlas, number);
    double place[3];
    mat4_point(place, volume->voxel_from_world, world);
    transfer_at(rgba, &choice->transfers[number], volume_trilinear(volume, place));
}

/* The pathway whose haze the voxel has, 0 if none. */
static uint32_t hazy_at(const struct volume *volume, const struct haze_choice *choice, size_t voxel)
{
    uint32_t object = volume_object(volume, voxel);
    return object && haze_is(choice, object) ? object : 0;
}

static bool is_used(const struct volume *volume)
{
    return volume_is_scalar(volume) && volume_can_be_hit(volume);
}

/* The grid of haze, by the index of the first volume that has some. */
struct extent {
    const struct volume *first;
    long low[3], high[3];
};

static void extend(struct extent *extent, const struct volume *volume, size_t voxel)
{
    double p[3];
    if (!extent->first) {
        *extent = (struct extent){volume, {LONG_MAX, LONG_MAX, LONG_MAX}, {LONG_MIN, LONG_MIN, LONG_MIN}};
    }
    grid_index(p, volume->info.dim, voxel);
    if (volume != extent->first) {
        mat4_point(p, volume->info.world_from_voxel, p);
        mat4_point(p, extent->first->voxel_from_world, p);
    }
    for (int a = 0; a < 3; a++) {
        extent->low[a] = (long)fmin((double)extent->low[a], floor(p[a]));
        extent->high[a] = (long)fmax((double)extent->high[a], ceil(p[a]));
    }
}

/* The field has one voxel more on each side. */
static conus_status init_field(struct haze_field *out, const struct extent *extent, uint64_t max_memory)
{
    double count = 1;
    double corner[3];
    for (int a = 0; a < 3; a++) {
        corner[a] = (double)extent->low[a] - 1;
        out->info.dim[a] = (size_t)(extent->high[a] - extent->low[a] + 3);
        count *= (double)out->info.dim[a];
    }
    if (count * 4 * sizeof *out->texels > (double)max_memory) {
        return fail(CONUS_ERROR_MEMORY, "haze of pathways: %.0f bytes, allowed are %llu",
                    count * 4 * sizeof *out->texels, (unsigned long long)max_memory);
    }
    memcpy(out->info.world_from_voxel, extent->first->info.world_from_voxel, sizeof out->info.world_from_voxel);
    mat4_point(out->info.world_from_voxel + 12, extent->first->info.world_from_voxel, corner);
    out->texels = memory_zeroed((size_t)count, 4 * sizeof *out->texels);
    return out->texels ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Samples the nearest voxel, as elsewhere for objects. */
static void add_volume(struct haze_field *field, const struct volume *volume, const struct haze_choice *choice)
{
    const size_t *dim = field->info.dim;
    for (size_t n = 0; n < dim[0] * dim[1] * dim[2]; n++) {
        double p[3];
        size_t voxel = 0;
        grid_index(p, dim, n);
        mat4_point(p, field->info.world_from_voxel, p);
        uint32_t object = volume_find_voxel(&voxel, volume, p) ? hazy_at(volume, choice, voxel) : 0;
        if (object) {
            float *texel = field->texels + 4 * n;
            const double value = (double)volume_value(volume, voxel);
            double rgba[4];
            transfer_at(rgba, &choice->transfers[object], value);
            const double extinction = transfer_extinction(rgba[3]);
            for (int c = 0; c < 3; c++) {
                texel[c] += (float)(extinction * linear_from_srgb(rgba[c]));
            }
            texel[3] += (float)extinction;
        }
    }
}

conus_status haze_fill(struct haze_field *out, const conus_atlas *atlas, const struct haze_choice *choice,
                       uint64_t max_memory)
{
    struct extent extent = {0};
    *out = (struct haze_field){0};
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        size_t first = is_used(volume) ? volume_next(volume, 0) : volume->voxel_count;
        for (size_t v = first; v < volume->voxel_count; v = volume_next(volume, v + 1)) {
            if (hazy_at(volume, choice, v)) {
                extend(&extent, volume, v);
            }
        }
    }
    if (!extent.first) {
        return CONUS_OK;
    }
    conus_status status = init_field(out, &extent, max_memory);
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        if (is_used(&atlas->volumes[i])) {
            add_volume(out, &atlas->volumes[i], choice);
        }
    }
    return status;
}

void haze_field_finish(struct haze_field *field)
{
    memory_free(field->texels);
    *field = (struct haze_field){0};
}
