/* SPDX-License-Identifier: BSD-3-Clause */
/* The box around an atlas, and the centre of an object. */
#include "atlas/atlas.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "conus/own.h"

#include <string.h>

/* Whether any of `count` voxels from `first` on may hold an object; without a branch for each. */
static inline bool is_occupied(const struct volume *volume, size_t first, size_t count)
{
    uint16_t any16 = 0;
    uint32_t any32 = 0;
    if (volume->objects16) {
        for (size_t v = first; v < first + count; v++) {
            any16 |= volume->objects16[v];
        }
    } else if (volume->objects32) {
        for (size_t v = first; v < first + count; v++) {
            any32 |= volume->objects32[v];
        }
    } else {
        return volume_next(volume, first) < first + count;
    }
    return any16 || any32;
}

/* The first and last voxel with an object of a row that is_occupied(), which begins at voxel `start`; false if there is
 * none. */
static bool find_ends(size_t ends[2], const struct volume *volume, size_t start)
{
    const size_t dim = volume->info.dim[0];
    ends[0] = volume_next(volume, start) - start;
    ends[1] = dim - 1;
    while (ends[0] < dim && !volume_object(volume, start + ends[0])) {
        ends[0]++;
    }
    while (ends[0] < ends[1] && !volume_object(volume, start + ends[1])) {
        ends[1]--;
    }
    return ends[0] < dim;
}

static void find_centre(double out[3], const double m[16], size_t i, size_t j, size_t k)
{
    mat4_point(out, m, (const double[3]){(double)i, (double)j, (double)k});
}

static bool has_centre(const struct box3 *box, const double m[16], size_t i, size_t j, size_t k)
{
    double p[3];
    find_centre(p, m, i, j, k);
    return p[0] >= box->low[0] && p[0] <= box->high[0] && p[1] >= box->low[1] && p[1] <= box->high[1] &&
           p[2] >= box->low[2] && p[2] <= box->high[2];
}

/* The box around the centres of all voxels with an object, which `m` maps from their indices: along a row a coordinate
 * is extreme at one of the ends, rounded or not. So a row adds nothing that has no object but between two voxels in the
 * box. */
static struct box3 find_centres(const struct volume *volume, const double m[16])
{
    const size_t *dim = volume->info.dim;
    struct box3 box = box3_empty();
    size_t widest[2] = {SIZE_MAX, 0}; /* round the ends of all rows so far */
    for (size_t row = 0; row < dim[1] * dim[2]; row++) {
        size_t ends[2];
        size_t start = row * dim[0];
        const size_t j = row % dim[1];
        const size_t k = row / dim[1];
        const struct object_box *in = &volume->box;
        bool is_out =
            volume->step_count && (j < in->first[1] || j > in->last[1] || k < in->first[2] || k > in->last[2]);
        is_out = is_out || (has_centre(&box, m, widest[0], j, k) && has_centre(&box, m, widest[1], j, k) &&
                            !is_occupied(volume, start, widest[0]) &&
                            !is_occupied(volume, start + widest[1] + 1, dim[0] - 1 - widest[1]));
        if (!is_out && is_occupied(volume, start, dim[0]) && find_ends(ends, volume, start)) {
            for (int end = 0; end < 2; end++) {
                double centre[3];
                find_centre(centre, m, ends[end], j, k);
                box3_add(&box, centre);
            }
            widest[0] = ends[0] < widest[0] ? ends[0] : widest[0];
            widest[1] = ends[1] > widest[1] ? ends[1] : widest[1];
        }
    }
    return box;
}

/* The same, or the box that is known already. */
static struct box3 centres_of(const struct volume *volume, const double m[16])
{
    struct box3 box;
    if (!volume->distances || !mat4_is_same(m, volume->centres.m)) {
        return find_centres(volume, m);
    }
    memcpy(box.low, volume->centres.low, sizeof box.low);
    memcpy(box.high, volume->centres.high, sizeof box.high);
    return box;
}

void volume_measure_centres(struct volume *volume)
{
    struct box3 box = centres_of(volume, volume->info.world_from_voxel);
    memcpy(volume->centres.m, volume->info.world_from_voxel, sizeof volume->centres.m);
    memcpy(volume->centres.low, box.low, sizeof box.low);
    memcpy(volume->centres.high, box.high, sizeof box.high);
}

/* Adds the volume's cells: each reaches half a voxel along every index from its centre. */
static void add_volume(struct box3 *box, const struct volume *volume, const double m[16])
{
    struct box3 centres = centres_of(volume, m);
    for (int a = 0; a < 3; a++) {
        double reach = (fabs(m[a]) + fabs(m[4 + a]) + fabs(m[8 + a])) / 2;
        box->low[a] = fmin(box->low[a], centres.low[a] - reach);
        box->high[a] = fmax(box->high[a], centres.high[a] + reach);
    }
}

/* Adds the bundle's points and a radius around them; nothing where the object is no bundle. */
static void add_bundle(struct box3 *box, const conus_atlas *atlas, uint32_t number)
{
    const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, number);
    const struct tract_group *group = atlas_bundle_group(atlas, number);
    if (!tractogram) {
        return;
    }
    for (int a = 0; !group && a < 3; a++) { /* its points may be on the disk */
        box->low[a] = fmin(box->low[a], tractogram->low[a] - tractogram->radius);
        box->high[a] = fmax(box->high[a], tractogram->high[a] + tractogram->radius);
    }
    for (size_t i = 0; group && i < group->count; i++) {
        uint32_t k = group->members[i];
        for (uint64_t at = tractogram->first[k]; at < tractogram->first[k + 1]; at++) {
            double p[3];
            tractogram_point(p, tractogram, at);
            for (int a = 0; a < 3; a++) {
                box->low[a] = fmin(box->low[a], p[a] - tractogram->radius);
                box->high[a] = fmax(box->high[a], p[a] + tractogram->radius);
            }
        }
    }
}

conus_status conus_atlas_bounds(double low[3], double high[3], const conus_atlas *atlas)
{
    struct box3 box = box3_empty();
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT && volume_can_be_hit(&atlas->volumes[i])) {
            add_volume(&box, &atlas->volumes[i], atlas->volumes[i].info.world_from_voxel);
        }
    }
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            box3_join(&box, mesh->shape.low, mesh->shape.high);
        }
        if (!atlas->places[number - 1].is_hidden) {
            add_bundle(&box, atlas, number);
        }
    }
    if (!(box.low[0] <= box.high[0])) {
        return fail(CONUS_ERROR_DATA, "the atlas is empty");
    }
    memcpy(low, box.low, sizeof box.low);
    memcpy(high, box.high, sizeof box.high);
    return CONUS_OK;
}

bool atlas_area_bounds(double low[3], double high[3], const conus_atlas *atlas, const double from_world[16])
{
    struct box3 box = box3_empty();
    for (size_t i = 0; i < atlas->volume_count; i++) {
        const struct volume *volume = &atlas->volumes[i];
        if (atlas_volume_has_areas(volume)) {
            double m[16];
            mat4_multiply(m, from_world, volume->info.world_from_voxel);
            add_volume(&box, volume, m);
        }
    }
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        if (mesh) {
            for (size_t i = 0; i < mesh->vertex_count; i++) {
                const float *at = mesh->positions + 3 * i;
                double p[3] = {(double)at[0], (double)at[1], (double)at[2]};
                mat4_point(p, from_world, p);
                box3_add(&box, p);
            }
        }
    }
    memcpy(low, box.low, sizeof box.low);
    memcpy(high, box.high, sizeof box.high);
    return box.low[0] <= box.high[0];
}

/* Sums over the parts of an object. */
struct moment {
    double sum[3], weight;
};

static void add_voxel(struct moment *moment, const size_t dim[3], size_t voxel)
{
    double p[3];
    grid_index(p, dim, voxel);
    vec3_add_scaled(moment->sum, moment->sum, 1, p);
    moment->weight++;
}

static void add_voxels(struct moment *all, const conus_atlas *atlas, const struct volume *volume, uint32_t number)
{
    bool has_grids = atlas_parcellation_count(atlas) > 1; /* whose voxels may differ in size */
    struct moment voxels = {0};
    uint32_t last = 0; /* neighbours are mostly of one object */
    bool is_mine = false;
    for (size_t v = volume_next(volume, 0); v < volume->voxel_count; v = volume_next(volume, v + 1)) {
        const struct volume_step *step = volume->step_count ? volume_step_of(volume, volume_value(volume, v)) : NULL;
        uint32_t here = step ? step->number : volume->step_count ? 0 : volume_object(volume, v); /* hidden or not */
        if (here != last) {
            last = here;
            is_mine = here && here != VOLUME_BLOCKER && atlas_is_below(atlas, here, number);
        }
        if (is_mine) {
            add_voxel(&voxels, volume->info.dim, v);
        }
    }
    for (size_t h = 0; h < volume->hidden_run_count; h++) {
        const struct hidden_run *run = &volume->hidden_runs[h];
        size_t count = atlas_is_below(atlas, run->object, number) ? run->count : 0;
        for (size_t v = run->first; v < run->first + count; v++) {
            add_voxel(&voxels, volume->info.dim, v);
        }
    }
    if (voxels.weight > 0) {
        double weight = voxels.weight * (has_grids ? space_voxel_mm3(&volume->info) : 1);
        vec3_scale(voxels.sum, voxels.sum, 1 / voxels.weight);
        mat4_point(voxels.sum, volume->info.world_from_voxel, voxels.sum);
        vec3_add_scaled(all->sum, all->sum, weight, voxels.sum);
        all->weight += weight;
    }
}

/* By the triangles' areas. */
static void add_mesh(struct moment *all, const struct mesh *mesh)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3];
        double normal[3];
        double middle[3];
        mesh_normal(normal, mesh, t);
        mesh_corners(p, mesh, t);
        for (int a = 0; a < 3; a++) {
            middle[a] = (p[0][a] + p[1][a] + p[2][a]) / 3;
        }
        double area = vec3_length(normal) / 2;
        vec3_add_scaled(all->sum, all->sum, area, middle);
        all->weight += area;
    }
}

static void add_points(struct moment *all, const struct tractogram *tractogram, const struct tract_group *group)
{
    size_t count = tract_group_count(group, tractogram);
    for (size_t i = 0; i < count; i++) {
        uint32_t k = tract_group_member(group, i);
        for (uint64_t at = tractogram->first[k]; at < tractogram->first[k + 1]; at++) {
            double p[3];
            tractogram_point(p, tractogram, at);
            vec3_add_scaled(all->sum, all->sum, 1, p);
            all->weight++;
        }
    }
}

conus_status conus_atlas_centre(double out[3], const conus_atlas *atlas, size_t number)
{
    struct moment all = {0};
    if (number < 1 || number > atlas->object_count) {
        return fail(CONUS_ERROR_ARGUMENT, "object %zu, allowed is 1 to %zu", number, atlas->object_count);
    }
    for (size_t i = 0; i < atlas->volume_count; i++) {
        if (atlas->volumes[i].info.role != CONUS_ROLE_CONTEXT) {
            add_voxels(&all, atlas, &atlas->volumes[i], (uint32_t)number);
        }
    }
    for (uint32_t object = 1; object <= atlas->object_count; object++) {
        const struct mesh *mesh = atlas_stored_mesh(atlas, object);
        if (mesh && atlas_is_below(atlas, object, (uint32_t)number)) {
            add_mesh(&all, mesh);
        }
    }
    const struct tractogram *tractogram = atlas_bundle_tractogram(atlas, (uint32_t)number);
    if (tractogram) {
        add_points(&all, tractogram, atlas_bundle_group(atlas, (uint32_t)number));
    }
    if (!(all.weight > 0)) {
        return fail(CONUS_ERROR_DATA, "%s has no voxels, triangles or streamlines", atlas->objects[number - 1].name);
    }
    vec3_scale(out, all.sum, 1 / all.weight);
    return CONUS_OK;
}
