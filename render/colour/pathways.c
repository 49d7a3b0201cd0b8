/* SPDX-License-Identifier: BSD-3-Clause */
/* Joins pathways and some areas, or areas on several grids, into one volume of objects. */
#include "render/colour/colour.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

const struct volume *pathways_first(const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (volume_is_scalar(volume) && volume_can_be_hit(volume)) {
            return volume;
        }
    }
    return NULL;
}

bool pathways_shown(const conus_atlas *atlas)
{
    for (size_t i = atlas->area_count; i < atlas->object_count; i++) {
        if (!atlas->places[i].is_hidden) {
            return true;
        }
    }
    return false;
}

/* The areas that are drawn. */
struct choice {
    bool all;
    const uint8_t *drawn; /* [object_count + 1], if not all; NULL = none */
    const struct haze_choice *hazy;
};

/* Whether a pathway has the voxels that it shares with the area. */
static bool is_under(const struct choice *choice, uint32_t area)
{
    return !choice->all && choice->drawn && choice->drawn[area] == PATHWAYS_AREA_UNDER;
}

static bool is_drawn(const struct choice *choice, uint32_t area)
{
    return choice->all || (choice->drawn && choice->drawn[area]);
}

/* The object of the cell that holds the world point: the most probable area that is drawn, else the first pathway;
 * 0 if there is none. */
static uint32_t scalar_at(const conus_atlas *atlas, const struct choice *choice, const double world[3])
{
    uint32_t area = 0;
    uint32_t pathway = 0;
    float best = 0;
    for (size_t i = 0; i < atlas->volume_count && !pathway; i++) {
        const struct volume *volume = &atlas->volumes[i];
        size_t voxel = 0;
        bool inside = volume_is_scalar(volume) && volume_can_be_hit(volume) && volume_find_voxel(&voxel, volume, world);
        uint32_t object = inside ? volume_object(volume, voxel) : 0;
        if (object > atlas->area_count) {
            pathway = haze_is(choice->hazy, object) ? 0 : object;
        } else if (object && volume_value(volume, voxel) > best && is_drawn(choice, object)) {
            area = object;
            best = volume_value(volume, voxel);
        }
    }
    return area && !(pathway && is_under(choice, area)) ? area : pathway;
}

/* The overlap of several volumes, on the grid of one of them. */
struct joint {
    conus_volume_info info; /* that grid, extended */
    long low[3], high[3];   /* first and last voxel, by the grid's own index */
};

static void extend_joint(struct joint *joint, const struct volume *first, const struct volume *volume)
{
    for (int corner = 0; corner < 8; corner++) {
        double p[3];
        for (int a = 0; a < 3; a++) {
            p[a] = corner >> a & 1 ? (double)volume->info.dim[a] - 1 : 0;
        }
        mat4_point(p, volume->info.world_from_voxel, p);
        mat4_point(p, first->voxel_from_world, p);
        for (int a = 0; a < 3; a++) {
            joint->low[a] = (long)fmin((double)joint->low[a], floor(p[a] + 0.5));
            joint->high[a] = (long)fmax((double)joint->high[a], floor(p[a] + 0.5));
        }
    }
}

/* The grid of all pathways, and of the areas if `areas`; only that of `first` where a common one would be far larger,
 * which is false. */
static bool find_joint(struct joint *out, const conus_atlas *atlas, const struct volume *first, bool areas)
{
    enum { LARGER = 4 };
    double most = 0;
    double count = 1;
    *out = (struct joint){.info = first->info};
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        bool drawn = volume_is_scalar(volume) || (volume->info.role == CONUS_ROLE_PARCELLATION && areas);
        if (drawn && volume_can_be_hit(volume)) {
            extend_joint(out, first, volume);
            most = fmax(most, (double)volume->voxel_count);
        }
    }
    for (int a = 0; a < 3; a++) {
        count *= (double)(out->high[a] - out->low[a] + 1);
    }
    for (size_t a = 0; a < 3 && count <= LARGER * most; a++) {
        const double *m = first->info.world_from_voxel;
        vec3_add_scaled(out->info.world_from_voxel + 12, out->info.world_from_voxel + 12, (double)out->low[a],
                        m + 4 * a);
        out->info.dim[a] = (size_t)(out->high[a] - out->low[a] + 1);
    }
    return count <= LARGER * most;
}

/* The finest volume of labels whose grid holds them all without being far larger than each; else the coarsest. */
static const struct volume *find_finest(const conus_atlas *atlas)
{
    const struct volume *best = NULL;
    bool best_fits = false;
    for (size_t i = 0; i < atlas_parcellation_count(atlas); i++) {
        struct joint joint;
        const struct volume *volume = &atlas->volumes[i];
        bool fits = find_joint(&joint, atlas, volume, true);
        bool finer = best && space_voxel_mm3(&volume->info) < space_voxel_mm3(&best->info);
        if (!best || (fits && (finer || !best_fits)) || (!fits && !best_fits && !finer)) {
            best = volume;
            best_fits = fits;
        }
    }
    return best;
}

/* The first area of labels that is drawn and whose cell holds the world point, 0 if none. */
static uint32_t area_at(const conus_atlas *atlas, const struct choice *choice, const double world[3])
{
    uint32_t area = 0;
    for (size_t i = 0; i < atlas_parcellation_count(atlas) && !area; i++) {
        const struct volume *volume = &atlas->volumes[i];
        size_t voxel = 0;
        uint32_t object = volume_find_voxel(&voxel, volume, world) ? volume_object(volume, voxel) : 0;
        area = is_drawn(choice, object) ? object : 0;
    }
    return area;
}

conus_status pathways_join(struct volume *out, const conus_atlas *atlas, const uint8_t *drawn,
                           const struct haze_choice *hazy)
{
    const struct volume *first = pathways_first(atlas);
    struct joint grid;
    *out = (struct volume){0};
    const struct choice choice = {.all = !pathways_shown(atlas), .drawn = drawn, .hazy = hazy};
    const bool areas = (choice.all || drawn) && atlas_parcellation_count(atlas);
    find_joint(&grid, atlas, first ? first : find_finest(atlas), areas);
    conus_status status = volume_init(out, &grid.info);
    out->objects32 = status ? NULL : memory_raw(out->voxel_count, sizeof *out->objects32);
    status = status || out->objects32 ? status : CONUS_ERROR_MEMORY;
    for (size_t v = 0; !status && v < out->voxel_count; v++) {
        double p[3];
        grid_index(p, grid.info.dim, v);
        mat4_point(p, grid.info.world_from_voxel, p);
        uint32_t area = areas ? area_at(atlas, &choice, p) : 0;
        uint32_t scalar = area && !is_under(&choice, area) ? 0 : scalar_at(atlas, &choice, p);
        out->objects32[v] = area && scalar <= atlas->area_count ? area : scalar;
    }
    return status;
}
