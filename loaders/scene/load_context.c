/* SPDX-License-Identifier: BSD-3-Clause */
/* A volume or a surface around the areas, and values of its vertices. */
#include "loaders/scene/parts.h"

#include "atlas/fit/fit.h"
#include "atlas/space.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "loaders/maps/maps.h"
#include "loaders/surfaces/surfaces.h"
#include "sources/source.h"

#include <math.h>
#include <string.h>

static const double default_opacity = 0.25;

/* Reads the surface; it is measured when it is added. */
static struct context_surface read_context(struct job *job, const char *path, const struct scene_item *item)
{
    struct context_surface out = {.opacity = item->opacity > 0 ? item->opacity : default_opacity};
    const struct mesh_file_options file = {0};
    const char *name = path_base(path);
    struct label about = {0};
    if (item->blocks != 0) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: a surface does not block rays, only voxels of a volume do", path);
    }
    if (!(item->opacity >= 0 && item->opacity <= 1)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: opacity of %g, allowed is above 0 to 1 (0 = %g)", path, item->opacity,
                 default_opacity);
    }
    surface_read(job, &out.mesh, &about, path, &file);
    out.hemisphere = about.hemisphere               ? about.hemisphere
                     : strncmp(name, "lh.", 3) == 0 ? 'L' /* FreeSurfer's surfaces say it only by their name */
                     : strncmp(name, "rh.", 3) == 0 ? 'R'
                                                    : '\0';
    label_finish(&about);
    return out;
}

static void add_context(struct job *job, conus_atlas *atlas, const char *path, const struct scene_item *item)
{
    struct file_state state;
    (void)JOB_CALL(job, file_state_find(&state, path));
    struct context_surface surface = read_context(job, path, item);
    atlas_take(job, atlas);
    if (JOB_CALL(job, atlas_add_context_surface(atlas, &surface))) {
        const struct mesh *mesh = &atlas->context_surfaces[atlas->context_surface_count - 1].mesh;
        struct box3 box;
        memcpy(box.low, mesh->shape.low, sizeof box.low);
        memcpy(box.high, mesh->shape.high, sizeof box.high);
        (void)JOB_CALL(job, fit_note_context(&atlas->notes, atlas, mesh->path, &box));
    }
    (void)JOB_CALL(job, fit_note_surfaces(atlas));
    (void)JOB_CALL(job, atlas_note_file(atlas, path, &state));
    mesh_finish(&surface.mesh);
}

bool conus_context_is_surface(const char *path)
{
    const struct format *format;
    return source_find(&format, path, ROLE_SURFACE) || format; /* without memory its reader says so */
}

void context_load(struct job *job, conus_atlas *atlas, const char *path, bool is_surface, const struct scene_item *item)
{
    struct volume_file file = {0};
    if (!job_ok(job)) {
        return; /* there may be no atlas */
    }
    if (is_surface) {
        add_context(job, atlas, path, item);
    } else {
        volume_load(job, &file, path, job->max_memory);
        if (job_ok(job)) {
            context_set(job, atlas, &file, item);
        }
        volume_file_finish(&file);
    }
}

bool context_is_plain(struct job *job, const conus_atlas *atlas, const char *path)
{
    conus_volume_info info;
    struct notes notes = {0};
    const struct attempt attempt = job_try(job); /* who reads the whole of it notes the same */
    volume_grid_read(job, &info, path);
    const bool has_notes = job->notes.count > attempt.notes;
    attempt_end(job, &attempt, ATTEMPT_SILENT);
    if (job_ok(job) && !has_notes) {
        const struct box3 grid = space_grid_box(&info);
        (void)JOB_CALL(job, fit_note_context(&notes, atlas, path, &grid));
    }
    const bool is_plain = job_ok(job) && !has_notes && !notes.count;
    notes_finish(&notes);
    return is_plain;
}

/* Finds the one surface to whose vertices the numbers belong; NULL after a failure. */
static struct context_surface *find_surface(struct job *job, conus_atlas *atlas, const struct vertex_map *map)
{
    size_t found = 0;
    struct context_surface *fitting = NULL;
    const struct context_surface *other = NULL; /* of another number of vertices */
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        struct context_surface *surface = &atlas->context_surfaces[i];
        bool fits = surface->mesh.vertex_count == map->count &&
                    mesh_format_keeps_vertices(source_format(job, surface->mesh.path, ROLE_SURFACE)) &&
                    (!surface->hemisphere || !map->hemisphere || surface->hemisphere == map->hemisphere);
        fitting = fits ? surface : fitting;
        found += fits;
        other = fits || other ? other : surface;
    }
    if (found > 1 || (!found && !other)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%zu numbers: %zu surfaces of the context have so many vertices, one must",
                 map->count, found);
    } else if (!found) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%zu numbers, but %s has %zu vertices%s", map->count,
                 path_base(other->mesh.path), other->mesh.vertex_count,
                 other->mesh.vertex_count == map->count ? ", of another hemisphere or without an order" : "");
    }
    return job_ok(job) ? fitting : NULL;
}

static void find_map_range(struct job *job, double range[2], const struct vertex_map *map, const double asked[2])
{
    if (asked[0] != 0 || asked[1] != 0) {
        memcpy(range, asked, 2 * sizeof *range);
        if (!(range[0] < range[1] && isfinite(range[1] - range[0]))) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "range: %g to %g, the second must be larger", range[0], range[1]);
        }
        return;
    }
    range[0] = INFINITY;
    range[1] = -INFINITY;
    for (size_t v = 0; v < map->count; v++) {
        range[0] = fmin(range[0], (double)map->values[v]);
        range[1] = fmax(range[1], (double)map->values[v]);
    }
    if (!(range[0] <= range[1])) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "no vertex has a number in this array");
    }
}

static void set_map(conus_atlas *atlas, struct context_surface *surface, struct vertex_map *map, const double range[2],
                    double opacity)
{
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        memory_free(atlas->context_surfaces[i].values);
        memory_free(atlas->context_surfaces[i].map_name);
        atlas->context_surfaces[i].values = NULL;
        atlas->context_surfaces[i].map_name = NULL;
    }
    surface->values = map->values;
    surface->map_name = map->name;
    surface->low = range[0];
    surface->high = range[1];
    surface->opacity = opacity > 0 ? opacity : 1;
    *map = (struct vertex_map){0};
}

static void load_map(struct job *job, conus_atlas *atlas, const char *path, const conus_context_map_options *options)
{
    const char *array = options->array ? options->array : "0";
    struct vertex_map map = {0};
    struct context_surface *surface = NULL;
    struct file_state state;
    double range[2];
    if (!(options->opacity >= 0 && options->opacity <= 1)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: opacity of %g, allowed is above 0 to 1", path, options->opacity);
    }
    (void)JOB_CALL(job, file_state_find(&state, path));
    map = vertex_map_read(job, path, array);
    if (job_ok(job)) {
        size_t place = job_in(job, path, JOB_ALONE);
        find_map_range(job, range, &map, options->range);
        surface = find_surface(job, atlas, &map);
        job_out(job, place);
    }
    if (surface && JOB_CALL(job, atlas_note_file(atlas, path, &state))) {
        set_map(atlas, surface, &map, range, options->opacity);
    }
    vertex_map_finish(&map);
}

conus_status conus_atlas_set_context_map(conus_atlas *atlas, const char *path, const conus_context_map_options *options)
{
    if (!atlas || !path) {
        return fail(CONUS_ERROR_ARGUMENT, "conus_atlas_set_context_map: an atlas and a path are needed");
    }
    options = options_of(conus_context_map_options, options);
    const struct note_sink sink = {options->log, options->log_user, path};
    struct job job = {.sink = &sink, .max_memory = options->max_memory};
    load_map(&job, atlas, path, options);
    return job_close(&job, NULL, NULL);
}
