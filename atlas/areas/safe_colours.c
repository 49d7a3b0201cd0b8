/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours of a palette: areas that touch get different ones, a left area and its right one the same. */
#include "atlas/areas/areas.h"
#include "atlas/atlas.h"
#include "atlas/labels/labels.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "conus/own.h"

#include <math.h>
#include <string.h>

enum {
    REACH = 2,             /* voxels: one that is in no area may lie between areas that touch */
    VOXEL_LIMIT = 1 << 24, /* of larger grids every so many-th slice is read */
    CELLS = 96,            /* of the box around all surfaces, along its longest edge */
    CELL_OBJECTS = 4,
    OBJECT_LIMIT = 1 << 13, /* above it colours follow the list, as those of pathways do */
    HUE_LIMIT = 80,
    SHADES = 3,
    COLOUR_LIMIT = SHADES * HUE_LIMIT
};

/* Those of Okabe and Ito ("Color Universal Design", 2008) without black. */
static const uint8_t safe[][3] = {{230, 159, 0}, {86, 180, 233}, {0, 158, 115},  {240, 228, 66},
                                  {0, 114, 178}, {213, 94, 0},   {204, 121, 167}};

/* So many hues, each plain, lighter and darker: colours [SHADES * count] that repeat from there on. */
struct palette {
    const uint8_t (*hues)[3];
    size_t count;
};

static void colour_at(uint8_t rgb[3], const struct palette *palette, size_t index)
{
    static const double towards[SHADES] = {0, 0.45, -0.35}; /* white, black */
    double part = towards[index / palette->count % SHADES];
    for (int i = 0; i < 3; i++) {
        double hue = palette->hues[index % palette->count][i];
        rgb[i] = (uint8_t)lround(part > 0 ? hue + part * (255 - hue) : hue * (1 + part));
    }
}

/* Which areas touch. A pair of a left and a right area is one node: the left one's. */
struct map {
    const conus_atlas *atlas;
    size_t count; /* of areas, and 1 */
    uint32_t *node;
    uint8_t *touches; /* [count * count] */
};

static void add_contact(struct map *map, uint32_t a, uint32_t b)
{
    if (a && b && a < map->count && b < map->count && map->node[a] != map->node[b]) {
        map->touches[map->node[a] * map->count + map->node[b]] = 1;
        map->touches[map->node[b] * map->count + map->node[a]] = 1;
    }
}

static void add_voxels(struct map *map, const struct volume *volume)
{
    const size_t *dim = volume->info.dim;
    const size_t strides[3] = {1, dim[0], dim[0] * dim[1]};
    const size_t step = volume->voxel_count / VOXEL_LIMIT + 1;
    for (size_t k = 0; k < dim[2]; k += step) {
        for (size_t j = 0; j < dim[1]; j++) {
            for (size_t i = 0; i < dim[0]; i++) {
                const size_t at[3] = {i, j, k};
                const size_t voxel = i + dim[0] * (j + dim[1] * k);
                const uint32_t object = volume_object(volume, voxel);
                for (size_t a = 0; object && a < 3; a++) {
                    for (size_t away = 1; away <= REACH && at[a] + away < dim[a]; away++) {
                        add_contact(map, object, volume_object(volume, voxel + away * strides[a]));
                    }
                }
            }
        }
    }
}

/* Cells of the box around all surfaces, and which areas have a point in each, as far as there is room. */
struct cells {
    double low[3], size;
    size_t dim[3];
    uint32_t (*objects)[CELL_OBJECTS];
};

static const struct mesh *mesh_of(const conus_atlas *atlas, size_t number)
{
    const struct object_place *place = &atlas->places[number - 1];
    return place->is_mesh ? &atlas->meshes[place->index] : NULL;
}

/* Without cells where there is no surface. */
static conus_status make_cells(struct cells *out, const struct map *map)
{
    double high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double longest = 0;
    size_t count = 1;
    *out = (struct cells){.low = {INFINITY, INFINITY, INFINITY}};
    for (size_t number = 1; number < map->count; number++) {
        const struct mesh *mesh = mesh_of(map->atlas, number);
        for (int a = 0; mesh && a < 3; a++) {
            out->low[a] = fmin(out->low[a], mesh->shape.low[a]);
            high[a] = fmax(high[a], mesh->shape.high[a]);
        }
    }
    for (int a = 0; a < 3; a++) {
        longest = fmax(longest, high[a] - out->low[a]);
    }
    if (longest <= 0) {
        return CONUS_OK;
    }
    out->size = longest / CELLS;
    for (int a = 0; a < 3; a++) {
        out->dim[a] = (size_t)((high[a] - out->low[a]) / out->size) + 1;
        count *= out->dim[a];
    }
    out->objects = memory_zeroed(count, sizeof *out->objects);
    return out->objects ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Adds the point's area to its cell. It touches those that have a point in this cell or in one beside it. */
static void add_point(struct map *map, const struct cells *cells, uint32_t object, const double p[3])
{
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        double cell = fmax(0, (p[a] - cells->low[a]) / cells->size);
        at[a] = cell < (double)cells->dim[a] ? (size_t)cell : cells->dim[a] - 1;
    }
    for (size_t n = 0; n < 27; n++) {
        const size_t beside[3] = {at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1}; /* -1 wraps around */
        bool exists = beside[0] < cells->dim[0] && beside[1] < cells->dim[1] && beside[2] < cells->dim[2];
        const uint32_t *objects =
            exists ? cells->objects[beside[0] + cells->dim[0] * (beside[1] + cells->dim[1] * beside[2])] : NULL;
        for (int k = 0; objects && k < CELL_OBJECTS && objects[k]; k++) {
            add_contact(map, object, objects[k]);
        }
    }
    uint32_t *own = cells->objects[at[0] + cells->dim[0] * (at[1] + cells->dim[1] * at[2])];
    int k = 0;
    while (k < CELL_OBJECTS && own[k] && own[k] != object) {
        k++;
    }
    if (k < CELL_OBJECTS) {
        own[k] = object;
    }
}

/* Adds points of a triangle, no farther from each other than a cell is wide, unless the triangle is far larger. */
static void add_triangle(struct map *map, const struct cells *cells, uint32_t object, double corners[3][3])
{
    enum { MOST = 32 };
    double along[2][3];
    double p[3];
    for (size_t k = 0; k < 2; k++) {
        vec3_sub(along[k], corners[k + 1], corners[0]);
    }
    double longest = fmax(vec3_length(along[0]), vec3_length(along[1]));
    int parts = (int)fmin(fmax(ceil(longest / cells->size), 1), MOST);
    for (int i = 0; i < parts; i++) {
        for (int j = 0; i + j < parts; j++) {
            vec3_add_scaled(p, corners[0], (i + 1 / 3.0) / parts, along[0]);
            vec3_add_scaled(p, p, (j + 1 / 3.0) / parts, along[1]);
            add_point(map, cells, object, p);
        }
    }
}

static conus_status add_surfaces(struct map *map)
{
    struct cells cells;
    conus_status status = make_cells(&cells, map);
    for (uint32_t number = 1; cells.objects && number < map->count; number++) {
        const struct mesh *mesh = mesh_of(map->atlas, number);
        for (size_t t = 0; mesh && t < mesh->triangle_count; t++) {
            double corners[3][3];
            mesh_corners(corners, mesh, t);
            add_triangle(map, &cells, number, corners);
        }
    }
    memory_free(cells.objects);
    return status;
}

/* An area without a shape stands for the areas below it in the tree: it touches what they touch. */
static bool is_group(const conus_atlas *atlas, size_t number)
{
    return !atlas->places[number - 1].is_mesh && !atlas_object_volume(atlas, (uint32_t)number);
}

static void add_groups(struct map *map)
{
    const conus_atlas *atlas = map->atlas;
    const size_t count = map->count;
    for (uint32_t a = 1; a < count; a++) {
        for (uint32_t b = 1; b < count && !is_group(atlas, a); b++) {
            if (is_group(atlas, b) || !map->touches[map->node[a] * count + map->node[b]]) {
                continue;
            }
            for (uint32_t above = atlas->objects[a - 1].parent; above; above = atlas->objects[above - 1].parent) {
                for (uint32_t other = b; other; other = atlas->objects[other - 1].parent) {
                    bool related = atlas_is_below(atlas, other, above) || atlas_is_below(atlas, above, other);
                    if (!related && is_group(atlas, above)) {
                        add_contact(map, above, other);
                    }
                }
            }
        }
    }
}

static conus_status make_map(struct map *out, const conus_atlas *atlas)
{
    uint32_t *right_of = NULL;
    struct map map = {.atlas = atlas, .count = atlas->area_count + 1};
    if (map.count > OBJECT_LIMIT) {
        return CONUS_ERROR_MEMORY;
    }
    map.node = memory_raw(map.count, sizeof *map.node);
    map.touches = memory_zeroed(map.count * map.count, 1);
    conus_status status = map.node && map.touches ? hemispheres_pair(&right_of, atlas) : CONUS_ERROR_MEMORY;
    for (uint32_t number = 0; !status && number < map.count; number++) {
        map.node[number] = number;
    }
    for (uint32_t number = 1; !status && number < map.count; number++) {
        map.node[right_of[number]] = right_of[number] ? number : 0;
    }
    for (size_t i = 0; !status && i < atlas->volume_count; i++) {
        if (volume_has_objects(&atlas->volumes[i])) {
            add_voxels(&map, &atlas->volumes[i]);
        }
    }
    status = status ? status : add_surfaces(&map);
    if (!status) {
        add_groups(&map);
    }
    memory_free(right_of);
    *out = map;
    return status;
}

/* Most contacts first, but what is only a group last. */
struct turn {
    uint32_t node;
    bool last;
    size_t contacts;
};

static int by_contacts(const void *a, const void *b)
{
    const struct turn *one = a;
    const struct turn *other = b;
    if (one->last != other->last) {
        return one->last ? 1 : -1;
    }
    return compare_unsigned(other->contacts, one->contacts);
}

/* Chooses a colour that no touching area has: a plain one first, and among those the one that fewest areas have. */
static size_t choose(const struct palette *palette, const size_t *near, const size_t *used)
{
    size_t best = 0;
    for (size_t c = 1; c < SHADES * palette->count; c++) {
        bool same_row = c / palette->count == best / palette->count;
        bool better = near[c] < near[best] || (near[c] == near[best] && same_row && used[c] < used[best]);
        best = better ? c : best;
    }
    return best;
}

/* Colours one after the other, each by those before it: [count] of the palette. */
static conus_status colour_nodes(uint8_t *colours, const struct map *map, const struct palette *palette)
{
    size_t used[COLOUR_LIMIT] = {0};
    size_t count = 0;
    struct turn *turns = memory_zeroed(map->count, sizeof *turns);
    if (!turns) {
        return CONUS_ERROR_MEMORY;
    }
    memset(colours, COLOUR_LIMIT, map->count);
    for (uint32_t number = 1; number < map->count; number++) {
        if (map->node[number] == number) {
            struct turn *turn = &turns[count++];
            *turn = (struct turn){.node = number, .last = is_group(map->atlas, number)};
            for (size_t other = 1; other < map->count; other++) {
                turn->contacts += map->touches[number * map->count + other];
            }
        }
    }
    order_sort(turns, count, sizeof *turns, by_contacts);
    for (size_t n = 0; n < count; n++) {
        size_t near[COLOUR_LIMIT] = {0};
        for (size_t other = 1; other < map->count; other++) {
            if (map->touches[turns[n].node * map->count + other] && colours[other] < COLOUR_LIMIT) {
                near[colours[other]]++;
            }
        }
        size_t colour = choose(palette, near, used);
        colours[turns[n].node] = (uint8_t)colour;
        used[colour]++;
    }
    memory_free(turns);
    return CONUS_OK;
}

/* Over other colours of a palette, too. */
static void use(conus_atlas *atlas, const struct palette *palette)
{
    struct map map = {0};
    uint8_t *colours = memory_zeroed(atlas->area_count + 1, 1);
    conus_status status = colours ? make_map(&map, atlas) : CONUS_ERROR_MEMORY;
    status = status ? status : colour_nodes(colours, &map, palette);
    for (size_t i = 0; i < atlas->object_count; i++) {
        bool has_node = !status && i < atlas->area_count;
        if (!atlas->has_other_colours) {
            memcpy(atlas->places[i].own_rgb, atlas->objects[i].rgb, sizeof atlas->objects[i].rgb);
        }
        colour_at(atlas->objects[i].rgb, palette, has_node ? colours[map.node[i + 1]] : i);
    }
    atlas->has_other_colours = true;
    atlas->has_palette = palette->hues != safe;
    memory_free(map.node);
    memory_free(map.touches);
    memory_free(colours);
}

void conus_atlas_use_safe_colours(conus_atlas *atlas)
{
    use(atlas, &(struct palette){safe, sizeof safe / sizeof *safe});
}

conus_status conus_atlas_use_palette(conus_atlas *atlas, const uint8_t *rgb, size_t count)
{
    if (!count || count > HUE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "palette of %zu colours; allowed is 1 to %d", count, HUE_LIMIT);
    }
    use(atlas, &(struct palette){(const uint8_t(*)[3])rgb, count});
    return CONUS_OK;
}

void conus_atlas_use_own_colours(conus_atlas *atlas)
{
    for (size_t i = 0; i < atlas->object_count && atlas->has_other_colours; i++) {
        memcpy(atlas->objects[i].rgb, atlas->places[i].own_rgb, sizeof atlas->objects[i].rgb);
    }
    atlas->has_palette = atlas->has_other_colours = false;
}
