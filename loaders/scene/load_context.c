/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_atlas_set_context(): a volume or a surface around the areas. */
#include "atlas/fit/box_fit.h"
#include "atlas/fit/fit.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/options.h"
#include "loaders/maps/load_scalar.h"
#include "loaders/surfaces/mesh_file.h"
#include "loaders/surfaces/vertex_map.h"

#include <math.h>
#include <string.h>

static const double default_opacity = 0.25;

/* Reads the surface; it is measured when it is added. */
static conus_status read_context(struct context_surface *out, const char *path, const conus_context_options *options,
                                 struct notes *notes)
{
    const struct mesh_file_options file = {.max_memory = options->max_memory};
    const char *name = path_base(path);
    struct label about = {0};
    if (options->block_threshold != 0) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: a surface does not block rays, only voxels of a volume do", path);
    }
    if (!(options->opacity >= 0 && options->opacity <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: opacity of %g, allowed is above 0 to 1 (0 = %g)", path, options->opacity,
                    default_opacity);
    }
    conus_status status = mesh_file_read(&out->mesh, &about, path, &file, notes);
    out->opacity = options->opacity > 0 ? options->opacity : default_opacity;
    out->hemisphere = about.hemisphere               ? about.hemisphere
                      : strncmp(name, "lh.", 3) == 0 ? 'L' /* FreeSurfer's surfaces say it only by their name */
                      : strncmp(name, "rh.", 3) == 0 ? 'R'
                                                     : '\0';
    label_finish(&about);
    return status;
}

/* On failure the atlas is as before. */
static conus_status add_context(conus_atlas *atlas, const char *path, const conus_context_options *options,
                                struct notes *notes)
{
    struct context_surface surface = {0};
    struct file_state state;
    size_t count = atlas->context_surface_count;
    size_t note_count = atlas->notes.count;
    conus_status status = file_state_find(&state, path);
    status = status ? status : read_context(&surface, path, options, notes);
    status = status ? status : notes_move(&atlas->notes, notes);
    status = status ? status : atlas_add_context_surface(atlas, &surface);
    if (!status) {
        const struct mesh *mesh = &atlas->context_surfaces[count].mesh;
        struct fit_box box;
        memcpy(box.low, mesh->shape.low, sizeof box.low);
        memcpy(box.high, mesh->shape.high, sizeof box.high);
        status = fit_note_context(atlas, mesh->path, &box);
    }
    status = status ? status : fit_note_surfaces(atlas);
    status = status ? status : atlas_note_file(atlas, path, &state);
    if (status) {
        atlas_cut_context_surfaces(atlas, count);
        notes_cut(&atlas->notes, note_count);
        mesh_finish(&surface.mesh);
    }
    return status;
}

bool conus_context_is_surface(const char *path)
{
    return mesh_file_is(path);
}

conus_status conus_atlas_set_context(conus_atlas *atlas, const char *path, const conus_context_options *options)
{
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_set_context: an atlas and a path are needed");
    }
    options = options_of(conus_context_options, options);
    const struct note_sink sink = {options->log, options->log_user, path};
    struct notes notes = {.sink = &sink};
    conus_status status;
    if (mesh_file_is(path)) {
        status = add_context(atlas, path, options, &notes);
    } else {
        struct volume_file file = {0};
        status = volume_file_open_cached(&file, path, options->max_memory, options->cache, &notes);
        status = status ? status : context_set(atlas, &file, options, &notes);
        volume_file_finish(&file);
    }
    notes_finish(&notes);
    return status;
}

/* Finds the one surface to whose vertices the numbers belong. */
static conus_status find_surface(struct context_surface **out, conus_atlas *atlas, const struct vertex_map *map)
{
    size_t found = 0;
    const struct context_surface *other = NULL; /* of another number of vertices */
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        struct context_surface *surface = &atlas->context_surfaces[i];
        bool fits = surface->mesh.vertex_count == map->count && mesh_file_keeps_vertices(surface->mesh.path) &&
                    (!surface->hemisphere || !map->hemisphere || surface->hemisphere == map->hemisphere);
        *out = fits ? surface : *out;
        found += fits;
        other = fits || other ? other : surface;
    }
    if (found == 1) {
        return CONUS_OK;
    }
    if (found || !other) {
        return fail(CONUS_ERROR_ARGUMENT, "%zu numbers: %zu surfaces of the context have so many vertices, one must",
                    map->count, found);
    }
    return fail(CONUS_ERROR_ARGUMENT, "%zu numbers, but %s has %zu vertices%s", map->count, path_base(other->mesh.path),
                other->mesh.vertex_count,
                other->mesh.vertex_count == map->count ? ", of another hemisphere or without an order" : "");
}

/* The range that is asked for, or that of the numbers. */
static conus_status find_map_range(double *low, double *high, const struct vertex_map *map, const double asked[2])
{
    *low = asked[0];
    *high = asked[1];
    if (*low != 0 || *high != 0) {
        return *low < *high && isfinite(*high - *low)
                   ? CONUS_OK
                   : fail(CONUS_ERROR_ARGUMENT, "range: %g to %g, the second must be larger", *low, *high);
    }
    *low = INFINITY;
    *high = -INFINITY;
    for (size_t v = 0; v < map->count; v++) {
        *low = fmin(*low, (double)map->values[v]);
        *high = fmax(*high, (double)map->values[v]);
    }
    return *low <= *high ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "no vertex has a number in this array");
}

conus_status conus_atlas_set_context_map(conus_atlas *atlas, const char *path, const conus_context_map_options *options)
{
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_set_context_map: an atlas and a path are needed");
    }
    options = options_of(conus_context_map_options, options);
    const char *array = options->array ? options->array : "0";
    const struct note_sink sink = {options->log, options->log_user, path};
    struct notes notes = {.sink = &sink};
    struct vertex_map map = {0};
    struct context_surface *surface = NULL;
    struct file_state state;
    double low;
    double high;
    if (!(options->opacity >= 0 && options->opacity <= 1)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: opacity of %g, allowed is above 0 to 1", path, options->opacity);
    }
    conus_status status = file_state_find(&state, path);
    status = status ? status : vertex_map_read(&map, path, array, options->max_memory, &notes);
    if (!status) {
        status = find_map_range(&low, &high, &map, options->range);
        status = status ? status : find_surface(&surface, atlas, &map);
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    status = status ? status : atlas_note_file(atlas, path, &state);
    notes_finish(&notes);
    if (status) {
        vertex_map_finish(&map);
        return status;
    }
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        memory_free(atlas->context_surfaces[i].values);
        memory_free(atlas->context_surfaces[i].map_name);
        atlas->context_surfaces[i].values = NULL;
        atlas->context_surfaces[i].map_name = NULL;
    }
    surface->values = map.values;
    surface->map_name = map.name;
    surface->low = low;
    surface->high = high;
    surface->opacity = options->opacity > 0 ? options->opacity : 1;
    return CONUS_OK;
}
