/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks at all numbers of an attached atlas that are indices, and at those that readers check. */
#include "pack/pack.h"

#include "atlas/atlas.h"
#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/threads.h"
#include "selection/engine/voxels/distance_map.h"

#include <math.h>
#include <string.h>

static conus_status refuse(const char *what, size_t index, const char *why)
{
    return fail(CONUS_ERROR_DATA, "%s %zu (from 0): %s", what, index, why);
}

/* The numbers that a volume's voxels may have beside 0: those of objects with their place in it, or of a context
 * VOLUME_BLOCKER. */
struct numbering {
    const struct volume *volume;
    uint32_t first, last; /* none: first above last */
    bool *are_allowed;    /* [from first to last]; NULL = all of these */
};

static bool is_in(const conus_atlas *atlas, size_t object, size_t index)
{
    const struct object_place *place = &atlas->places[object];
    return !place->is_mesh && !place->is_bundle && place->index == index;
}

/* CONUS_ERROR_MEMORY. memory_free() are_allowed. */
static conus_status find_numbers(struct numbering *out, const conus_atlas *atlas, size_t index)
{
    const bool is_context = atlas->volumes[index].info.role == CONUS_ROLE_CONTEXT;
    size_t count = 0;
    *out = (struct numbering){.volume = &atlas->volumes[index], .first = UINT32_MAX};
    for (size_t i = 0; i < atlas->object_count; i++) {
        if (is_in(atlas, i, index)) {
            out->first = count++ ? out->first : (uint32_t)i + 1;
            out->last = (uint32_t)i + 1;
        }
    }
    if (is_context) {
        out->last = UINT32_MAX; /* VOLUME_BLOCKER only */
    }
    if (is_context || !count || count == out->last - out->first + (size_t)1) {
        return is_context && count ? refuse("volume", index, "objects have their place in a context") : CONUS_OK;
    }
    out->are_allowed = memory_zeroed(out->last - out->first + (size_t)1, sizeof *out->are_allowed);
    for (size_t i = 0; i < atlas->object_count && out->are_allowed; i++) {
        if (is_in(atlas, i, index)) {
            out->are_allowed[i + 1 - out->first] = true;
        }
    }
    return out->are_allowed ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static bool is_allowed(const struct numbering *numbers, uint32_t number)
{
    return number >= numbers->first && number <= numbers->last &&
           (!numbers->are_allowed || numbers->are_allowed[number - numbers->first]);
}

/* Whether numbers are 0 or from `first` to `last`. In 16 bits and without a branch, so that compilers let a processor
 * compare eight and more at once. */
static bool are_between(const uint16_t *numbers, size_t count, uint16_t first, uint16_t last)
{
    const uint16_t span = (uint16_t)(last - first);
    uint16_t bad = 0;
    for (size_t i = 0; i < count; i++) {
        const uint16_t beyond = (uint16_t)(numbers[i] - first); /* of less than first above span, too */
        const uint16_t is_beyond = beyond > span ? UINT16_MAX : 0;
        const uint16_t is_one = numbers[i] ? UINT16_MAX : 0;
        bad |= (uint16_t)(is_beyond & is_one);
    }
    return !bad;
}

static bool numbers_are_sound(const void *user, size_t from, size_t to)
{
    const struct numbering *numbers = user;
    const struct volume *volume = numbers->volume;
    const uint32_t limit = volume->objects16 ? UINT16_MAX : UINT32_MAX;
    const bool is_one = numbers->first <= numbers->last && numbers->first <= limit; /* else all are 0 */
    const uint32_t first = is_one ? numbers->first : 0;
    const uint32_t last = !is_one ? 0 : numbers->last < limit ? numbers->last : limit;
    unsigned bad =
        volume->objects16 && !are_between(volume->objects16 + from, to - from, (uint16_t)first, (uint16_t)last);
    for (size_t v = from; volume->objects32 && v < to; v++) {
        uint32_t number = volume->objects32[v];
        bad |= (unsigned)(number - first > last - first) & (number != 0);
    }
    for (size_t v = from; numbers->are_allowed && !bad && v < to && (volume->objects16 || volume->objects32); v++) {
        uint32_t number = volume_object(volume, v);
        bad = number && !numbers->are_allowed[number - first];
    }
    return !bad;
}

static bool matrix_is_sound(const struct volume *volume)
{
    double inverse[16];
    conus_volume_info info = volume->info;
    bool sound = !space_describe(&info, volume->info.world_from_voxel, "matrix") &&
                 !space_invert(inverse, volume->info.world_from_voxel, "matrix");
    for (int i = 0; i < 16 && sound; i++) {
        double scale = 0; /* of its row */
        for (int k = i % 4; k < 16; k += 4) {
            scale = fmax(scale, fabs(inverse[k]));
        }
        sound = fabs(volume->voxel_from_world[i] - inverse[i]) <= 1e-9 * scale;
    }
    for (int a = 0; a < 3; a++) {
        sound = sound && fabs(volume->info.spacing[a] - info.spacing[a]) <= 1e-9 * info.spacing[a];
    }
    return sound;
}

/* Whether the box is the one around the centres of its voxels: grids are made in it. */
static bool centres_are_sound(const struct volume *volume)
{
    struct volume measured = *volume;
    bool sound = true;
    measured.distances = NULL; /* without which what is known already does not count */
    volume_measure_centres(&measured);
    for (int i = 0; i < 6; i++) {
        const double is = i < 3 ? volume->centres.low[i] : volume->centres.high[i - 3];
        const double wanted = i < 3 ? measured.centres.low[i] : measured.centres.high[i - 3];
        sound = sound && (is == wanted || fabs(is - wanted) <= 1e-9 * (1 + fabs(wanted)));
    }
    return sound;
}

static bool steps_are_sound(const struct numbering *numbers)
{
    const struct volume *volume = numbers->volume;
    bool sound = volume->hidden_runs || !volume->hidden_run_count;
    for (size_t i = 0; i < volume->step_count && sound; i++) {
        sound = is_allowed(numbers, volume->steps[i].number) && volume->steps[i].is_hidden <= 1;
    }
    for (size_t i = 0; i < volume->hidden_run_count && sound; i++) {
        const struct hidden_run *run = &volume->hidden_runs[i];
        sound = run->first <= volume->voxel_count && run->count <= volume->voxel_count - run->first &&
                is_allowed(numbers, run->object);
    }
    return sound;
}

/* What a volume of this role has, no more and no less. */
static bool has_arrays(const struct volume *volume)
{
    const bool has_objects = volume->objects16 || volume->objects32;
    switch (volume->info.role) {
    case CONUS_ROLE_PARCELLATION:
        return !volume->objects16 != !volume->objects32 && !volume->step_count && !volume->map.count;
    case CONUS_ROLE_SCALAR:
    case CONUS_ROLE_PROBABILITY:
        return !has_objects && volume->step_count && volume->map.count;
    case CONUS_ROLE_CONTEXT:
        return !volume->objects16 && volume->values && !volume->step_count;
    default:
        return false;
    }
}

enum { VOXELS_A_THREAD = 1 << 20 };

static conus_status check_volume(const conus_atlas *atlas, size_t index)
{
    const struct volume *volume = &atlas->volumes[index];
    const bool is_context = volume->info.role == CONUS_ROLE_CONTEXT;
    struct numbering numbers;
    static const char what[] = "volume";
    const bool is_late = index && atlas->volumes[index - 1].info.role != CONUS_ROLE_PARCELLATION;
    if (!has_arrays(volume) || !volume->path || (is_late && volume->info.role == CONUS_ROLE_PARCELLATION) ||
        (is_context && volume != atlas_context(atlas))) {
        return refuse(what, index, "has not what its role needs");
    }
    if (!matrix_is_sound(volume)) {
        return refuse(what, index, "its matrices are no grid's");
    }
    conus_status status = find_numbers(&numbers, atlas, index);
    if (!status && !steps_are_sound(&numbers)) {
        status = refuse(what, index, "a step or a hidden run leads to no object or voxel of it");
    }
    if (!status && !threads_check(numbers_are_sound, &numbers, volume->voxel_count, VOXELS_A_THREAD)) {
        status = refuse(what, index, "a voxel has an object that is not in it");
    }
    memory_free(numbers.are_allowed);
    if (status) {
        return status;
    }
    if (volume->distances && !centres_are_sound(volume)) {
        return refuse(what, index, "its box is not the one of its objects");
    }
    return !volume_can_be_hit(volume) == !volume->distances &&
                   (!volume->distances || distance_map_is_sound(volume->distances, volume))
               ? CONUS_OK
               : refuse(what, index, "a distance leads out of its map");
}

static conus_status check_mesh(const struct mesh *mesh, const char *what, size_t index)
{
    if (!mesh->positions || !mesh->triangles || !mesh->triangle_count || mesh->triangle_count > UINT32_MAX ||
        mesh->vertex_count > UINT32_MAX || mesh_check_numbers(mesh)) {
        return refuse(what, index, "a triangle or a vertex is none");
    }
    const struct box3 box = mesh_box(mesh); /* grids are made in it */
    bool sound = true;
    for (int a = 0; a < 3; a++) {
        sound = sound && mesh->shape.low[a] == box.low[a] && mesh->shape.high[a] == box.high[a];
    }
    return sound ? CONUS_OK : refuse(what, index, "its box is not the one of its triangles");
}

static conus_status check_tractogram(const struct tractogram *tractogram, size_t index)
{
    static const char what[] = "tractogram";
    if (!(tractogram->radius > 0 && tractogram->radius <= TRACT_RADIUS_LIMIT) ||
        tractogram->space > CONUS_FILE_SPACE_LPS) {
        return refuse(what, index, "its radius or space is none");
    }
    for (int a = 0; a < 3 && tractogram->point_count; a++) {
        if (!(tractogram->low[a] >= -TRACT_COORDINATE_LIMIT && tractogram->low[a] <= tractogram->high[a] &&
              tractogram->high[a] <= TRACT_COORDINATE_LIMIT)) {
            return refuse(what, index, "its box is none");
        }
    }
    conus_status status = tractogram_check_tree(tractogram);
    if (status) {
        return status;
    }
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        if (!tractogram->scalars[i].components) {
            return refuse(what, index, "a scalar has no numbers");
        }
    }
    return threads_check(tract_points_are_within, tractogram, (size_t)tractogram->point_count, VOXELS_A_THREAD)
               ? CONUS_OK
               : refuse(what, index, "a coordinate is not within 1e9 mm of 0");
}

static bool is_finite_matrix(const double m[16])
{
    bool is_finite = true;
    for (int i = 0; i < 16; i++) {
        is_finite = is_finite && isfinite(m[i]);
    }
    return is_finite;
}

static conus_status check_warp(const struct warp *warp, size_t index)
{
    const struct deformation *field = &warp->field;
    return is_finite_matrix(field->world_from_voxel) && is_finite_matrix(field->voxel_from_world) &&
                   is_finite_matrix(field->base) && is_finite_matrix(field->linear) && is_finite_matrix(field->start) &&
                   is_finite_matrix(warp->after)
               ? CONUS_OK
               : refuse("deformation field", index, "a matrix is not finite");
}

/* Whether an object of voxels is in a volume of its kind. */
static bool fits_volume(const conus_atlas *atlas, size_t object)
{
    const struct object_place *place = &atlas->places[object];
    const bool is_in_one = !place->is_mesh && !place->is_bundle && place->index < atlas->volume_count;
    const conus_role role = is_in_one ? atlas->volumes[place->index].info.role : CONUS_ROLE_PARCELLATION;
    return !is_in_one || (role == CONUS_ROLE_SCALAR) == (atlas->objects[object].kind == CONUS_KIND_PATHWAY);
}

static bool object_is_sound(const conus_atlas *atlas, size_t i)
{
    const conus_object *object = &atlas->objects[i];
    const struct object_place *place = &atlas->places[i];
    const bool is_area = i < atlas->area_count;
    return object->name && object->abbreviation && (!object->hemisphere || strchr("LRB", object->hemisphere)) &&
           (is_area ? object->kind == CONUS_KIND_AREA
                    : object->kind == CONUS_KIND_PATHWAY || object->kind == CONUS_KIND_BUNDLE) &&
           (object->kind == CONUS_KIND_BUNDLE) == place->is_bundle && !(place->is_mesh && place->is_bundle) &&
           object->parent <= atlas->area_count && (is_area || !object->parent) &&
           (object->volume == 0 || object->volume < atlas->volume_count) && fits_volume(atlas, i) &&
           (!place->is_mesh || place->index < atlas->mesh_count) && place->named <= atlas->object_count;
}

static conus_status check_objects(const conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->object_count; i++) {
        if (!object_is_sound(atlas, i)) {
            return refuse("object", i, "its kind, its shape or its parent is none");
        }
    }
    return atlas_check_tree(atlas);
}

static conus_status check_numbers(const conus_atlas *atlas)
{
    const bool is_placed = (!atlas->is_moved && !atlas->is_mirrored) || is_finite_matrix(atlas->own_from_world);
    return atlas->area_count <= atlas->object_count && atlas->object_count < UINT32_MAX &&
                   atlas->first_pair <= atlas->area_count && (unsigned)atlas->hemispheres <= CONUS_HEMISPHERES_MERGED &&
                   is_placed && (!atlas->has_ccf || is_finite_matrix(atlas->own_from_ccf)) &&
                   atlas->exchanged <= atlas->notes.count && atlas->path && atlas->label_source
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "head: a count, a matrix or a text is none");
}

conus_status pack_check_atlas(const conus_atlas *atlas)
{
    conus_status status = check_numbers(atlas);
    status = status ? status : check_objects(atlas);
    for (size_t i = 0; i < atlas->warp_count && !status; i++) {
        status = check_warp(&atlas->warps[i], i);
    }
    for (size_t i = 0; i < atlas->volume_count && !status; i++) {
        status = check_volume(atlas, i);
    }
    for (size_t i = 0; i < atlas->mesh_count && !status; i++) {
        status = check_mesh(&atlas->meshes[i], "surface", i);
    }
    for (size_t i = 0; i < atlas->context_surface_count && !status; i++) {
        const struct context_surface *surface = &atlas->context_surfaces[i];
        status = check_mesh(&surface->mesh, "surface around the areas", i);
        if (!status && (!(surface->opacity > 0 && surface->opacity <= 1) ||
                        (surface->hemisphere && !strchr("LRB", surface->hemisphere)))) {
            status = refuse("surface around the areas", i, "its opacity or side is none");
        }
    }
    for (size_t i = 0; i < atlas->tractogram_count && !status; i++) {
        status = check_tractogram(&atlas->tractograms[i], i);
    }
    return status;
}
