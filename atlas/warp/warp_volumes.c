/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes on another grid, each voxel as the nearest of the atlas's own. */
#include "atlas/atlas.h"
#include "atlas/deformation/deformation.h"
#include "atlas/space.h"
#include "atlas/warp/warp_parts.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <stdio.h>

enum { SAMPLES = 4096, NAMED = 4 };

/* The voxels from which a volume is resampled: its own where it has never been. */
static struct volume_source source_of(const conus_atlas *atlas, size_t index)
{
    const struct volume *volume = &atlas->volumes[index];
    struct volume_source source = {.objects16 = volume->objects16,
                                   .objects32 = volume->objects32,
                                   .values = volume->values,
                                   .map = volume->map,
                                   .first_warp = atlas->warp_count,
                                   .is_borrowed = volume->is_borrowed};
    memcpy(source.dim, volume->info.dim, sizeof source.dim);
    memcpy(source.voxel_from_world, volume->voxel_from_world, sizeof source.voxel_from_world);
    return volume->source ? *volume->source : source;
}

static bool is_warped(const struct volume_source *source, const struct warp_way *way)
{
    return source->first_warp < way->count;
}

static bool same_place(const struct volume_source *a, const struct volume_source *b)
{
    return a->first_warp == b->first_warp && memcmp(a->dim, b->dim, sizeof a->dim) == 0 &&
           mat4_is_same(a->voxel_from_world, b->voxel_from_world);
}

/* The source's voxel that is nearest to where a point goes; SIZE_MAX = none. */
static size_t nearest_voxel(const struct volume_source *source, const struct warp_way *way, const double point[3])
{
    double p[3];
    size_t voxel;
    const struct warp *first = &way->warps[source->first_warp];
    mat4_point(p, way->first, point);
    if (!warps_point(p, first + 1, way->count - source->first_warp - 1, p) || !deformation_point(p, &first->field, p)) {
        return SIZE_MAX;
    }
    mat4_point(p, source->voxel_from_world, p);
    return grid_find_voxel(&voxel, source->dim, p) ? voxel : SIZE_MAX;
}

/* The object of the volume whose source it is. */
static uint32_t source_object(const struct volume_source *source, const struct volume *volume, size_t voxel)
{
    return source->map.count   ? volume_object_of(volume, value_map_at(&source->map, voxel))
           : source->objects16 ? source->objects16[voxel]
           : source->objects32 ? source->objects32[voxel]
                               : 0;
}

static conus_status check_memory(const conus_atlas *atlas, const struct warp_way *way, const struct warp_plan *plan)
{
    uint64_t limit = memory_limit(plan->max_memory);
    const size_t *dim = plan->grid->dim;
    double each = 0;
    for (size_t i = 0; i < atlas->volume_count; i++) {
        struct volume_source source = source_of(atlas, i);
        each += is_warped(&source, way) ? (double)((source.objects16 ? sizeof *source.objects16 : 0) +
                                                   (source.objects32 ? sizeof *source.objects32 : 0) +
                                                   (source.values || source.map.count ? sizeof *source.values : 0))
                                        : 0;
    }
    double wanted = each * (double)dim[0] * (double)dim[1] * (double)dim[2];
    return wanted <= (double)limit
               ? CONUS_OK
               : fail(CONUS_ERROR_MEMORY,
                      "%s: the atlas on %zu x %zu x %zu voxels takes %.0f bytes, allowed are %llu (--max-memory)",
                      plan->words, dim[0], dim[1], dim[2], wanted, (unsigned long long)limit);
}

static bool make_array(void *array, const void *like, size_t count, size_t size)
{
    void *made = like ? memory_zeroed(count, size) : NULL;
    memcpy(array, &made, sizeof made);
    return made || !like;
}

static conus_status init_volume(struct volume *out, const struct volume *old, const struct volume_source *source,
                                const conus_volume_info *grid)
{
    struct volume volume = {0};
    conus_volume_info info = old->info;
    char words[PLACEMENT_WORDS];
    memcpy(info.dim, grid->dim, sizeof info.dim);
    placement_words(words, &old->info, ", warped");
    conus_status status = space_describe(&info, grid->world_from_voxel, words);
    info.space_code = 0;
    status = status ? status : volume_init(&volume, &info);
    if (status) {
        return status;
    }
    volume.is_joined = old->is_joined;
    if (!make_array(&volume.objects16, source->objects16, volume.voxel_count, sizeof *volume.objects16) ||
        !make_array(&volume.objects32, source->objects32, volume.voxel_count, sizeof *volume.objects32) ||
        !make_array(&volume.values, source->values ? (void *)source->values : source->map.codes, volume.voxel_count,
                    sizeof *volume.values) ||
        !make_array(&volume.source, source, 1, sizeof *volume.source)) {
        volume_finish(&volume);
        return CONUS_ERROR_MEMORY;
    }
    *out = volume;
    return CONUS_OK;
}

/* Fills the voxels from `first` on; `nearest` has their source voxels. */
static void fill_row(struct volume *volume, const struct volume *old, const struct volume_source *source,
                     uint64_t *counts, const size_t *nearest, size_t first)
{
    /* Where the atlas has no value, a voxel belongs to no pathway, and a context has nothing there. */
    const float nothing = volume_is_scalar(volume) ? NAN : (float)volume->info.minimum;
    for (size_t i = 0; i < volume->info.dim[0]; i++) {
        size_t from = nearest[i];
        uint32_t object = from == SIZE_MAX ? 0 : source_object(source, old, from);
        if (object) {
            counts[object == VOLUME_BLOCKER ? 0 : object]++;
        }
        if (object && (volume->objects16 || volume->objects32)) {
            volume_set_object(volume, first + i, object);
        }
        if (volume->values) {
            volume->values[first + i] = from == SIZE_MAX ? nothing
                                        : source->values ? source->values[from]
                                                         : value_map_at(&source->map, from);
        }
    }
}

/* Row by row, since volumes of one grid, as those of a 4-D file, then share the way. */
static conus_status fill(struct warped_volumes *volumes, const conus_atlas *atlas, const struct warp_way *way,
                         const struct warp_plan *plan)
{
    const size_t *dim = plan->grid->dim;
    size_t *nearest = memory_raw(dim[0], sizeof *nearest);
    for (size_t first = 0; nearest && first < dim[0] * dim[1] * dim[2]; first += dim[0]) {
        struct volume_source found = {0};
        bool any = false;
        for (size_t i = 0; i < atlas->volume_count; i++) {
            struct volume_source source = source_of(atlas, i);
            if (!is_warped(&source, way)) {
                continue;
            }
            if (!any || !same_place(&source, &found)) {
                for (size_t column = 0; column < plan->grid->dim[0]; column++) {
                    double point[3];
                    grid_index(point, plan->grid->dim, first + column);
                    mat4_point(point, plan->grid->world_from_voxel, point);
                    nearest[column] = nearest_voxel(&source, way, point);
                }
                found = source;
                any = true;
            }
            fill_row(&volumes->items[i], &atlas->volumes[i], &source, volumes->voxels, nearest, first);
        }
    }
    memory_free(nearest);
    return nearest ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* The values that were filled in become a map, with the steps of the volume that is resampled. */
static conus_status make_sparse(struct volume *volume, const struct volume *old)
{
    conus_status status = value_map_of(&volume->map, volume->values, volume->voxel_count);
    uint64_t *counts = memory_zeroed(old->step_count, sizeof *counts);
    volume->steps = memory_copy(old->steps, old->step_count, sizeof *old->steps);
    status = status || (counts && volume->steps) ? status : CONUS_ERROR_MEMORY;
    if (!status) {
        memory_free(volume->values);
        volume->values = NULL;
        volume->step_count = old->step_count;
        volume_count_steps(counts, volume);
    }
    memory_free(counts);
    return status;
}

/* From voxels of a source to the first field's output, and from the last one's input to the grid. */
struct ways_back {
    double world_from_voxel[16];
    double grid_from_world[16];
};

static bool find_ways_back(struct ways_back *out, const struct volume_source *source, const struct warp_way *way,
                           const struct warp_plan *plan)
{
    double first[16];
    if (!mat4_invert_affine(out->world_from_voxel, source->voxel_from_world) ||
        !mat4_invert_affine(first, way->first) ||
        !mat4_invert_affine(out->grid_from_world, plan->grid->world_from_voxel)) {
        return false; /* does not happen: they are inverses themselves */
    }
    mat4_multiply(out->grid_from_world, out->grid_from_world, first);
    return true;
}

/* Back through the fields, from the first one's output on. */
static bool find_place(double p[3], const struct volume_source *source, const struct warp_way *way)
{
    for (size_t i = source->first_warp; i < way->count; i++) {
        double before[16];
        if (i > source->first_warp) {
            if (!mat4_invert_affine(before, way->warps[i].after)) {
                return false; /* does not happen: it was inverted when it came */
            }
            mat4_point(p, before, p);
        }
        if (deformation_find(p, &way->warps[i].field, p) == DEFORMATION_LOST || !vec3_is_finite(p)) {
            return false;
        }
    }
    return true;
}

/* Whether a voxel of the source has a place on the grid. */
static bool has_place(const struct volume_source *source, const struct warp_way *way, const struct warp_plan *plan,
                      const struct ways_back *back, size_t voxel)
{
    double p[3];
    grid_index(p, source->dim, voxel);
    mat4_point(p, back->world_from_voxel, p);
    if (!find_place(p, source, way)) {
        return false;
    }
    mat4_point(p, back->grid_from_world, p);
    for (int a = 0; a < 3; a++) {
        if (!(p[a] >= -0.5 && p[a] < (double)plan->grid->dim[a] - 0.5)) {
            return false;
        }
    }
    return true;
}

void warped_volumes_finish(struct warped_volumes *volumes, size_t count)
{
    for (size_t i = 0; volumes->items && i < count; i++) {
        volume_finish(&volumes->items[i]);
    }
    memory_free(volumes->items);
    memory_free(volumes->voxels);
    *volumes = (struct warped_volumes){0};
}

/* Counts how many of up to SAMPLES labelled voxels the field leads out of its grid. */
static void sample_places(struct warped_volumes *volumes, const struct volume *volume,
                          const struct volume_source *source, const struct warp_way *way, const struct warp_plan *plan)
{
    struct ways_back back = {0};
    size_t total = source->dim[0] * source->dim[1] * source->dim[2];
    size_t labelled = 0;
    for (size_t v = 0; v < total; v++) {
        labelled += source_object(source, volume, v) > 0;
    }
    size_t stride = labelled / SAMPLES + 1;
    size_t next = find_ways_back(&back, source, way, plan) ? 0 : SIZE_MAX;
    for (size_t v = 0, n = 0; v < total; v++) {
        if (source_object(source, volume, v) && n++ == next) {
            next += stride;
            volumes->sampled++;
            volumes->outside += !has_place(source, way, plan, &back, v);
        }
    }
}

conus_status warped_volumes_init(struct warped_volumes *out, const conus_atlas *atlas, const struct warp_way *way,
                                 const struct warp_plan *plan)
{
    struct warped_volumes volumes = {0};
    conus_status status = check_memory(atlas, way, plan);
    if (status) {
        return status;
    }
    volumes.items = memory_zeroed(atlas->volume_count, sizeof *volumes.items);
    volumes.voxels = memory_zeroed(atlas->object_count + 1, sizeof *volumes.voxels);
    status = volumes.items && volumes.voxels ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        struct volume_source source = source_of(atlas, i);
        status = is_warped(&source, way) ? init_volume(&volumes.items[i], &atlas->volumes[i], &source, plan->grid)
                                         : CONUS_OK;
    }
    status = status ? status : fill(&volumes, atlas, way, plan);
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        status = volumes.items[i].values && atlas->volumes[i].map.count
                     ? make_sparse(&volumes.items[i], &atlas->volumes[i])
                     : CONUS_OK;
    }
    if (!status) {
        bool parcellations = atlas_parcellation_count(atlas) > 0;
        for (size_t i = 0; i < atlas->volume_count; i++) {
            struct volume_source source = source_of(atlas, i);
            conus_role role = atlas->volumes[i].info.role;
            if (is_warped(&source, way) && role != CONUS_ROLE_CONTEXT &&
                (role == CONUS_ROLE_PARCELLATION || !parcellations)) {
                sample_places(&volumes, &atlas->volumes[i], &source, way, plan);
            }
        }
        uint64_t left = 0;
        for (size_t n = 1; n <= atlas->object_count; n++) {
            left += volumes.voxels[n];
        }
        status =
            left || !volumes.sampled
                ? CONUS_OK
                : fail(
                      CONUS_ERROR_DATA,
                      "%s: nothing of the atlas is where the field leads to: is it of another image, or the one of the "
                      "other direction?",
                      plan->words);
    }
    return GIVE(status, out, volumes, warped_volumes_finish(&volumes, atlas->volume_count));
}

/* Whether an object's voxels are resampled. */
static bool is_resampled(const struct warped_volumes *volumes, const conus_atlas *atlas, size_t object)
{
    const struct object_place *place = &atlas->places[object];
    return !place->is_mesh && !place->is_bundle && place->index < atlas->volume_count &&
           volumes->items[place->index].voxel_count;
}

/* "A, B, C, D and 3 more" */
static conus_status note_lost(const struct warped_volumes *volumes, conus_atlas *atlas, const char *words)
{
    struct buffer names = {0};
    size_t count = 0;
    for (size_t i = 0; i < atlas->object_count; i++) {
        bool lost = is_resampled(volumes, atlas, i) && atlas->objects[i].voxels && !volumes->voxels[i + 1];
        if (lost && count++ < NAMED) {
            buffer_format(&names, "%s%s", names.size ? ", " : "", atlas->objects[i].name);
        }
    }
    if (count > NAMED) {
        buffer_format(&names, " and %zu more", count - NAMED);
    }
    conus_status status = buffer_status(&names);
    status = status || !count ? status : notes_warn(&atlas->notes, "%s: no voxel is left of %s", words, names.data);
    buffer_finish(&names);
    return status;
}

conus_status warped_volumes_note(const struct warped_volumes *volumes, conus_atlas *atlas, const char *words)
{
    double part = volumes->sampled ? 100 * (double)volumes->outside / (double)volumes->sampled : 0;
    conus_status status = CONUS_OK;
    if (part > 0) {
        status = notes_add(&atlas->notes, "%s: %.2g %% of the atlas's voxels lie outside of the field, and are lost",
                           words, part);
    }
    return status ? status : note_lost(volumes, atlas, words);
}

/* The old voxels are kept as the source. */
static void exchange(struct volume *volume, struct volume *with)
{
    struct volume old = *volume;
    if (old.source) {
        memory_free(with->source);
        with->source = old.source;
        old.source = NULL;
    } else { /* it is a copy of these arrays */
        old.objects16 = NULL;
        old.objects32 = NULL;
        old.values = NULL;
        old.map = (struct value_map){0};
    }
    *volume = *with;
    *with = old;
}

void warped_volumes_take(struct warped_volumes *volumes, conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->object_count; i++) {
        if (is_resampled(volumes, atlas, i)) {
            const conus_volume_info *info = &volumes->items[atlas->places[i].index].info;
            atlas->objects[i].voxels = volumes->voxels[i + 1];
            atlas->objects[i].volume_mm3 = (double)volumes->voxels[i + 1] * space_voxel_mm3(info);
        }
    }
    for (size_t i = 0; i < atlas->volume_count; i++) {
        struct volume *made = &volumes->items[i];
        if (made->voxel_count) {
            *made->source = source_of(atlas, i);
            exchange(&atlas->volumes[i], made);
        }
    }
}
