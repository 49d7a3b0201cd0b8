/* SPDX-License-Identifier: BSD-3-Clause */
/* The colour pass: what of an atlas is drawn, and changes of it. */
#include "render/colour/colour.h"

#include "base/geometry/math3.h"
#include "base/look.h"
#include "base/memory.h"
#include "render/image/image.h"

#include <string.h>

enum { MESH_POINTS = 100000, SLAB_VOXELS = 1 << 17 };

/* Places the box of `size` voxels from `first` on. */
static void place_volume(struct colour_volume *out, const struct volume *volume, const size_t first[3],
                         const size_t size[3])
{
    double texture_from_voxel[16];
    mat4_identity(texture_from_voxel);
    for (int a = 0; a < 3; a++) {
        out->dim[a] = volume->info.dim[a];
        out->first[a] = first[a];
        out->size[a] = size[a];
        texture_from_voxel[5 * a] = 1.0 / (double)size[a];
        texture_from_voxel[12 + a] = (0.5 - (double)first[a]) / (double)size[a];
    }
    mat4_multiply(out->texture_from_world, texture_from_voxel, volume->voxel_from_world);
    memcpy(out->world_from_voxel, volume->info.world_from_voxel, sizeof out->world_from_voxel);
}

/* Whether any of the up to eight bricks around a corner is visible. */
static bool corner_shows(const struct bricks *bricks, const size_t corner[3])
{
    bool shows = false;
    for (size_t n = 0; n < 8 && !shows; n++) {
        size_t at[3];
        bool exists = true;
        for (size_t a = 0; a < 3; a++) {
            at[a] = corner[a] - (n >> a & 1); /* before the first it wraps around */
            exists = exists && at[a] < bricks->dim[a];
        }
        shows = exists && !bricks->distance[at[0] + bricks->dim[0] * (at[1] + bricks->dim[1] * at[2])];
    }
    return shows;
}

/* Makes room for so many points more. */
static bool reserve_content(struct colour_pass *pass, size_t more)
{
    double(*points)[3] = memory_resize(pass->content, pass->content_count + more + 1, sizeof *points);
    pass->content = points ? points : pass->content;
    return points;
}

/* Appends the corners of all visible bricks, each once. */
static conus_status add_content(struct colour_pass *pass, const struct bricks *bricks,
                                const struct colour_volume *volume)
{
    const size_t dim[3] = {bricks->dim[0] + 1, bricks->dim[1] + 1, bricks->dim[2] + 1};
    size_t count = dim[0] * dim[1] * dim[2];
    if (!reserve_content(pass, count)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t c = 0; c < count; c++) {
        const size_t corner[3] = {c % dim[0], c / dim[0] % dim[1], c / dim[0] / dim[1]};
        if (corner_shows(bricks, corner)) {
            double voxel[3];
            for (int a = 0; a < 3; a++) {
                size_t edge = volume->first[a] + corner[a] * BRICKS_EDGE;
                voxel[a] = (double)(edge < volume->dim[a] ? edge : volume->dim[a]) - 0.5;
            }
            mat4_point(pass->content[pass->content_count++], volume->world_from_voxel, voxel);
        }
    }
    return CONUS_OK;
}

/* Appends the corners of the whole grid: for an atlas in which nothing is visible. */
static conus_status colour_add_corners(struct colour_pass *pass, const struct colour_volume *volume)
{
    if (!reserve_content(pass, 8)) {
        return CONUS_ERROR_MEMORY;
    }
    for (int n = 0; n < 8; n++) {
        double corner[3];
        for (int a = 0; a < 3; a++) {
            corner[a] = n >> a & 1 ? (double)volume->dim[a] - 0.5 : -0.5;
        }
        mat4_point(pass->content[pass->content_count++], volume->world_from_voxel, corner);
    }
    return CONUS_OK;
}

static conus_status hold(struct colour_texels *out, const struct colour_pass *pass, enum volume_texture_kind kind,
                         const size_t dim[3], const void *texels, uint64_t *memory_left)
{
    return pass->device->functions->hold(out, pass->device, kind, dim, texels, memory_left);
}

static conus_status check(const struct colour_pass *pass, const char *what)
{
    const struct colour_functions *functions = pass->device->functions;
    return functions->check ? functions->check(what) : CONUS_OK;
}

/* Hands over the texels of `volume` as `task` makes them. Ends the task. No texels if the task is empty. */
static conus_status fill_texels(const struct colour_pass *pass, struct colour_volume *volume, struct field_task *task)
{
    struct field_slab slab;
    while (task->volume && field_task_next(&slab, task)) {
        pass->device->functions->fill(&volume->field, slab.first, slab.count, slab.texels);
    }
    field_task_end(task);
    return check(pass, "texels of a volume");
}

/* Copies the object numbers of `count` voxels from `at` on, `bytes` bytes each. */
static void copy_numbers(void *out, const struct volume *volume, size_t bytes, size_t at, size_t count)
{
    if (bytes == 1) {
        for (size_t i = 0; i < count; i++) {
            ((uint8_t *)out)[i] = (uint8_t)volume->objects16[at + i];
        }
    } else {
        const void *from = volume->objects16 ? (const void *)(volume->objects16 + at) : volume->objects32 + at;
        memcpy(out, from, count * bytes);
    }
}

enum { BRICK_OBJECTS = 8 };

struct colour_seen {
    size_t dim[3], count; /* bricks */
    size_t object_count;
    uint8_t *occupied, *distance;       /* [count] struct bricks where all areas are seen, and by the last picture */
    uint8_t *shown;                     /* [object_count + 1] areas that are seen there */
    uint32_t (*objects)[BRICK_OBJECTS]; /* [count] areas with a voxel in the brick, then 0; of more the last is MANY */
};

static const uint32_t MANY = UINT32_MAX;

static void seen_destroy(struct colour_seen *seen)
{
    if (seen) {
        memory_free(seen->occupied);
        memory_free(seen->distance);
        memory_free(seen->shown);
        memory_free(seen->objects);
        memory_free(seen);
    }
}

static void add_object(uint32_t objects[BRICK_OBJECTS], uint32_t number)
{
    size_t i = 0;
    while (i < BRICK_OBJECTS && objects[i] && objects[i] != number) {
        i++;
    }
    objects[i < BRICK_OBJECTS ? i : BRICK_OBJECTS - 1] = i < BRICK_OBJECTS ? number : MANY;
}

/* Notes which areas of `volume` are in the bricks of its box. */
static conus_status seen_create(struct colour_seen **out, const struct colour_volume *box, const struct volume *volume,
                                const struct bricks *bricks, size_t object_count)
{
    const size_t *dim = bricks->dim;
    const size_t count = dim[0] * dim[1] * dim[2];
    struct colour_seen *seen = memory_zeroed(1, sizeof *seen);
    if (!seen) {
        return CONUS_ERROR_MEMORY;
    }
    *seen = (struct colour_seen){.dim = {dim[0], dim[1], dim[2]},
                                 .count = count,
                                 .object_count = object_count,
                                 .occupied = memory_raw(count, 1),
                                 .distance = memory_raw(count, 1),
                                 .shown = memory_raw(object_count + 1, 1),
                                 .objects = memory_zeroed(count, sizeof *seen->objects)};
    if (!seen->occupied || !seen->distance || !seen->shown || !seen->objects) {
        seen_destroy(seen);
        return CONUS_ERROR_MEMORY;
    }
    memcpy(seen->occupied, bricks->distance, count);
    memset(seen->shown, true, object_count + 1);
    for (size_t row = 0; row < box->size[1] * box->size[2]; row++) {
        const size_t j = row % box->size[1], k = row / box->size[1];
        const size_t at = box->first[0] + box->dim[0] * (box->first[1] + j + box->dim[1] * (box->first[2] + k));
        uint32_t(*objects)[BRICK_OBJECTS] = seen->objects + dim[0] * (j / BRICKS_EDGE + dim[1] * (k / BRICKS_EDGE));
        for (size_t i = 0; i < box->size[0]; i++) {
            const uint32_t number = volume->objects16 ? volume->objects16[at + i] : volume->objects32[at + i];
            if (number && number != objects[i / BRICKS_EDGE][0]) {
                add_object(objects[i / BRICKS_EDGE], number);
            }
        }
    }
    *out = seen;
    return CONUS_OK;
}

static bool is_seen(const struct colour_seen *seen, size_t brick)
{
    bool found = false;
    for (size_t i = 0; i < BRICK_OBJECTS && seen->objects[brick][i] && !found; i++) {
        found = seen->objects[brick][i] == MANY || seen->shown[seen->objects[brick][i]];
    }
    return found;
}

/* Rays pass over bricks whose areas, and those of the bricks around, are all unseen. */
static void skip_unseen(const struct colour_pass *pass)
{
    struct colour_seen *seen = pass->areas.seen;
    struct colour_texels empty = pass->areas.empty;
    bool same = true, all = true;
    for (size_t number = 1; seen && number <= seen->object_count; number++) {
        const bool shows = pass->opacity[number] > 0;
        same = same && shows == seen->shown[number];
        all = all && shows;
        seen->shown[number] = shows;
    }
    if (same) {
        return;
    }
    struct bricks bricks = {.dim = {seen->dim[0], seen->dim[1], seen->dim[2]}, .distance = seen->distance};
    for (size_t b = 0; b < seen->count && !all; b++) {
        bricks.distance[b] = is_seen(seen, b) ? 0 : UINT8_MAX;
    }
    if (!all) {
        bricks_spread(&bricks);
        for (size_t b = 0; b < seen->count; b++) {
            bricks.distance[b] = bricks.distance[b] <= 1 && seen->occupied[b] == 0 ? 0 : UINT8_MAX;
        }
        bricks_spread(&bricks);
    }
    pass->device->functions->fill(&empty, 0, seen->dim[2], all ? seen->occupied : seen->distance);
}

/* Hands over object numbers in as few bytes as the highest, `last`, needs, a few slices at a time. */
static conus_status fill_numbers(struct colour_pass *pass, const struct colour_volume *box, const struct volume *volume,
                                 size_t last, uint64_t *memory_left)
{
    static const enum volume_texture_kind kinds[] = {
        [1] = VOLUME_TEXTURE_UINT8, [2] = VOLUME_TEXTURE_UINT16, [4] = VOLUME_TEXTURE_UINT32};
    const size_t bytes = !volume->objects16 ? 4 : last > UINT8_MAX ? 2 : 1;
    const size_t *dim = box->size;
    size_t step = SLAB_VOXELS / (dim[0] * dim[1]) + 1;
    uint8_t *some = memory_raw(step * dim[0] * dim[1], bytes);
    conus_status status = some ? hold(&pass->objects, pass, kinds[bytes], dim, NULL, memory_left) : CONUS_ERROR_MEMORY;
    for (size_t first = 0; first < dim[2] && !status; first += step) {
        size_t count = dim[2] - first < step ? dim[2] - first : step;
        uint8_t *row = some;
        for (size_t k = first; k < first + count; k++) {
            for (size_t j = 0; j < box->size[1]; j++, row += box->size[0] * bytes) {
                size_t at = box->first[0] + box->dim[0] * (box->first[1] + j + box->dim[1] * (box->first[2] + k));
                copy_numbers(row, volume, bytes, at, box->size[0]);
            }
        }
        pass->device->functions->fill(&pass->objects, first, count, some);
    }
    memory_free(some);
    return status ? status : check(pass, "volume texture");
}

/* Holds the field that `task` makes, and hands over the distances to bricks with densities that are
 * `visible`; and, if there are `areas`, of these. */
static conus_status begin_field(struct colour_pass *pass, struct colour_volume *out, struct field_task *task,
                                const bool *visible, size_t areas, uint64_t *memory_left)
{
    const struct field *field = NULL;
    struct bricks bricks = {0};
    conus_status status = field_task_wait(&field, task);
    status = status ? status : field_bricks(&bricks, field, visible, TABLE_PER_LEVEL);
    if (!status) {
        place_volume(out, task->volume, field->first, field->dim);
        status = add_content(pass, &bricks, out);
    }
    status = status ? status : hold(&out->field, pass, VOLUME_TEXTURE_BYTE4, field->dim, NULL, memory_left);
    status = status ? status : hold(&out->empty, pass, VOLUME_TEXTURE_UINT8, bricks.dim, bricks.distance, memory_left);
    if (!status && areas) {
        status = seen_create(&out->seen, out, task->volume, &bricks, areas);
    }
    bricks_finish(&bricks);
    return status;
}

/* The same for the areas of the volume of `task`, and their numbers, of which `last` is the highest. */
static conus_status begin_areas(struct colour_pass *pass, struct field_task *task, size_t last, uint64_t *memory_left)
{
    bool visible[COLOUR_TABLE_ENTRIES];
    for (size_t i = 0; i < COLOUR_TABLE_ENTRIES; i++) {
        visible[i] = i > (FIELD_SURFACE - 1) * TABLE_PER_LEVEL;
    }
    conus_status status = begin_field(pass, &pass->areas, task, visible, last, memory_left);
    if (!status) {
        status = fill_numbers(pass, &pass->areas, task->volume, last, memory_left);
    }
    pass->has_areas = true;
    return status;
}

/* All opaque areas would hide pathways and bundles: where there are any, they are drawn with only some areas. */
static bool is_joint(const conus_atlas *atlas)
{
    return pathways_first(atlas) || atlas_parcellation_count(atlas) > 1 ||
           (atlas_parcellation_count(atlas) && pathways_shown(atlas));
}

/* The field that colour_upload_objects() needs; empty where the field depends on which areas are drawn. */
static struct field_task colour_objects_task(const conus_atlas *atlas)
{
    bool one = atlas_parcellation_count(atlas) && !is_joint(atlas);
    return (struct field_task){.volume = one ? &atlas->volumes[0] : NULL};
}

static conus_status colour_upload_objects(struct colour_pass *pass, const conus_atlas *atlas,
                                          const struct haze_choice *hazy, struct field_task *task,
                                          uint64_t *memory_left)
{
    if (!is_joint(atlas)) {
        return task->volume ? begin_areas(pass, task, atlas->object_count, memory_left) : CONUS_OK;
    }
    struct volume joint = {0};
    conus_status status = pathways_join(&joint, atlas, pass->drawn, hazy);
    struct field_task own = {.volume = &joint};
    status = status ? status : begin_areas(pass, &own, atlas->object_count, memory_left);
    status = status ? status : fill_texels(pass, &pass->areas, &own);
    field_task_end(&own);
    volume_finish(&joint);
    if (status) {
        return status;
    }
    struct haze_field field = {0};
    struct volume grid = {0};
    status = hazy->transfers ? haze_fill(&field, atlas, hazy, *memory_left) : CONUS_OK;
    if (!status && field.texels) {
        status = volume_init(&grid, &field.info);
        status = status
                     ? status
                     : hold(&pass->haze.field, pass, VOLUME_TEXTURE_HALF4, field.info.dim, field.texels, memory_left);
        if (!status) {
            place_volume(&pass->haze, &grid, (const size_t[3]){0, 0, 0}, grid.info.dim);
            pass->has_haze = true;
            status = colour_add_corners(pass, &pass->haze);
        }
        volume_finish(&grid);
    }
    haze_field_finish(&field);
    return status;
}

/* The mesh of an object that is shown; after the objects those of the surfaces around them. NULL if there is none. */
static const struct mesh *shown_mesh(const conus_atlas *atlas, size_t number)
{
    return number <= atlas->object_count ? atlas_object_mesh(atlas, (uint32_t)number)
                                         : &atlas->context_surfaces[number - atlas->object_count - 1].mesh;
}

/* Vertices, about MESH_POINTS of them, for the camera to frame. */
static conus_status add_mesh_content(struct colour_pass *pass, const conus_atlas *atlas)
{
    size_t vertices = 0;
    size_t last = atlas->object_count + atlas->context_surface_count;
    for (size_t number = 1; number <= last; number++) {
        const struct mesh *mesh = shown_mesh(atlas, number);
        vertices += mesh ? mesh->vertex_count : 0;
    }
    size_t step = vertices / MESH_POINTS + 1;
    if (!reserve_content(pass, vertices / step + last)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t number = 1; number <= last; number++) {
        const struct mesh *mesh = shown_mesh(atlas, number);
        for (size_t v = 0; mesh && v < mesh->vertex_count; v += step) {
            for (size_t a = 0; a < 3; a++) {
                pass->content[pass->content_count][a] = (double)mesh->positions[3 * v + a];
            }
            pass->content_count++;
        }
    }
    return CONUS_OK;
}

/* Appends points of streamlines in the same way. */
static conus_status add_bundle_content(struct colour_pass *pass, const conus_atlas *atlas)
{
    uint64_t total = 0;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        total += atlas->tractograms[i].point_count;
    }
    uint64_t step = total / MESH_POINTS + 1;
    if (!reserve_content(pass, total / step + atlas->tractogram_count)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        for (uint64_t at = 0; at < atlas->tractograms[i].point_count; at += step) {
            tractogram_point(pass->content[pass->content_count++], &atlas->tractograms[i], at);
        }
    }
    return CONUS_OK;
}

/* Finds which entries of the transfer table are visible. */
static void find_visible(bool visible[COLOUR_TABLE_ENTRIES], float table[COLOUR_TABLE_ENTRIES * 4],
                         const struct transfer *transfer)
{
    transfer_table(table, COLOUR_TABLE_ENTRIES, transfer);
    for (size_t i = 0; i < COLOUR_TABLE_ENTRIES; i++) {
        visible[i] = table[4 * i + 3] > 0;
    }
}

/* The field that colour_upload_context() needs; `volume` may be NULL. The function is not relative. */
static struct field_task colour_context_task(const struct volume *volume, const struct transfer *transfer)
{
    struct field_task task = {.volume = volume, .is_values = true};
    if (volume) {
        transfer_span(&task.scale.low, &task.scale.high, transfer);
        float table[COLOUR_TABLE_ENTRIES * 4];
        bool visible[COLOUR_TABLE_ENTRIES];
        int entry = 0;
        find_visible(visible, table, transfer);
        while (entry < COLOUR_TABLE_ENTRIES && !visible[entry]) {
            entry++;
        }
        task.scale.unseen = entry ? (entry - 1) / TABLE_PER_LEVEL : -1;
    }
    return task;
}

static conus_status colour_upload_context(struct colour_pass *pass, struct field_task *task,
                                          const struct transfer *transfer, uint64_t *memory_left)
{
    float table[COLOUR_TABLE_ENTRIES * 4];
    bool visible[COLOUR_TABLE_ENTRIES];
    find_visible(visible, table, transfer);
    conus_status status = begin_field(pass, &pass->context, task, visible, 0, memory_left);
    if (!status) {
        status = hold(&pass->transfer, pass, VOLUME_TEXTURE_FLOAT4, (const size_t[3]){COLOUR_TABLE_ENTRIES, 1, 1},
                      table, memory_left);
    }
    return status;
}

/* Bone: pale, since the areas inside have the colours. */
static const uint8_t around_rgb[3] = {LOOK_RGB(LOOK_GLASS)};

/* Makes the tables by object number. */
static conus_status make_palette(struct colour_pass *pass, const conus_atlas *atlas)
{
    size_t count = 1 + atlas->object_count + atlas->context_surface_count;
    pass->object_count = atlas->object_count;
    pass->around_count = atlas->context_surface_count;
    pass->colours = memory_zeroed(count, 4 * sizeof *pass->colours);
    pass->shown = memory_zeroed(count, 4 * sizeof *pass->shown);
    pass->opacity = memory_zeroed(count, sizeof *pass->opacity);
    pass->around = memory_zeroed(pass->around_count, sizeof *pass->around);
    pass->drawn = memory_zeroed(atlas->object_count + 1, sizeof *pass->drawn);
    if (!pass->colours || !pass->shown || !pass->opacity || !pass->around || !pass->drawn) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t number = 1; number < count; number++) {
        draw_colour(pass->colours + 4 * number,
                    number <= atlas->object_count ? atlas->objects[number - 1].rgb : around_rgb, 0);
    }
    for (size_t i = 0; i < pass->around_count; i++) {
        pass->around[i] = (float)atlas->context_surfaces[i].opacity;
    }
    const struct context_surface *mapped = atlas_mapped_surface(atlas);
    pass->mapped_opacity = mapped ? (float)mapped->opacity : 1;
    return CONUS_OK;
}

void colour_fields_start(struct colour_fields *out, const conus_atlas *atlas, const struct transfer *transfer)
{
    *out = (struct colour_fields){.objects = colour_objects_task(atlas),
                                  .context = colour_context_task(atlas_context(atlas), transfer)};
    field_task_start(&out->objects);
    field_task_start(&out->context);
}

void colour_fields_end(struct colour_fields *fields)
{
    field_task_end(&fields->objects);
    field_task_end(&fields->context);
}

static void release_all(struct colour_pass *pass)
{
    void (*const release)(struct colour_texels *) = pass->device->functions->release;
    release(&pass->transfer);
    release(&pass->objects);
    release(&pass->areas.field);
    release(&pass->areas.empty);
    seen_destroy(pass->areas.seen);
    release(&pass->context.field);
    release(&pass->context.empty);
    release(&pass->haze.field);
}

static void free_tables(struct colour_pass *pass)
{
    memory_free(pass->colours);
    memory_free(pass->shown);
    memory_free(pass->opacity);
    memory_free(pass->around);
    memory_free(pass->drawn);
    memory_free(pass->content);
    haze_choice_finish(&pass->hazy);
    tube_colouring_finish(&pass->streamlines);
}

conus_status colour_pass_init(struct colour_pass *out, struct colour_device *device, const conus_atlas *atlas,
                              const struct transfer *transfer, struct haze_choice *hazy, struct colour_fields *fields,
                              uint64_t max_memory)
{
    struct colour_pass pass = {.device = device, .hazy = *hazy, .may_have_context = fields->context.volume};
    pass.may_have_areas = atlas->volume_count > pass.may_have_context;
    conus_status status = make_palette(&pass, atlas);
    status = status ? status : device->functions->prepare(device, &pass);
    if (!status) {
        status = colour_upload_objects(&pass, atlas, &pass.hazy, &fields->objects, &max_memory);
        pass.object_points = pass.content_count;
    }
    if (!status && fields->context.volume) {
        status = colour_upload_context(&pass, &fields->context, transfer, &max_memory);
    }
    status = status ? status : fill_texels(&pass, &pass.areas, &fields->objects);
    status = status ? status : fill_texels(&pass, &pass.context, &fields->context);
    if (!status && (atlas->mesh_count || atlas->context_surface_count || atlas->tractogram_count)) {
        pass.has_meshes = true;
        status = device->functions->add_meshes(device, atlas, &max_memory);
        status = status ? status : add_mesh_content(&pass, atlas);
        status = status ? status : add_bundle_content(&pass, atlas);
    }
    if (!status && !pass.content_count && pass.has_areas) {
        status = colour_add_corners(&pass, &pass.areas);
    }
    if (status) {
        pass.hazy = (struct haze_choice){0}; /* is still the caller's, as the device is */
        release_all(&pass);
        free_tables(&pass);
        return status;
    }
    *hazy = (struct haze_choice){0};
    *out = pass;
    return CONUS_OK;
}

bool colour_pass_has_layers(const struct colour_pass *pass, const struct colour_view *view)
{
    return view->opacity || pass->has_haze || pass->around_count;
}

/* Replaces the points that came from voxels before by those of `fresh`, which has the old ones then. */
static conus_status exchange_content(struct colour_pass *pass, struct colour_pass *fresh)
{
    double(*old)[3] = pass->content;
    size_t count = fresh->content_count;
    if (!reserve_content(fresh, pass->content_count - pass->object_points)) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = pass->object_points; i < pass->content_count; i++) {
        memcpy(fresh->content[count++], old[i], sizeof *old);
    }
    pass->content = fresh->content;
    pass->content_count = count;
    pass->object_points = fresh->content_count;
    fresh->content = old;
    return CONUS_OK;
}

conus_status colour_pass_update(struct colour_pass *pass, const conus_atlas *atlas, uint64_t max_memory)
{
    struct colour_pass fresh = {.device = pass->device, .drawn = pass->drawn};
    struct field_task task = colour_objects_task(atlas);
    conus_status status = colour_upload_objects(&fresh, atlas, &pass->hazy, &task, &max_memory);
    status = status ? status : fill_texels(&fresh, &fresh.areas, &task);
    field_task_end(&task);
    status = status ? status : exchange_content(pass, &fresh);
    memory_free(fresh.content);
    if (status) {
        release_all(&fresh);
        return status;
    }
    struct colour_pass old = {
        .device = pass->device, .areas = pass->areas, .objects = pass->objects, .haze = pass->haze};
    pass->areas = fresh.areas;
    pass->haze = fresh.haze;
    pass->has_haze = fresh.has_haze;
    pass->objects = fresh.objects;
    pass->has_areas = fresh.has_areas;
    release_all(&old);
    return colour_pass_paint_streamlines(pass, atlas, NULL, NULL);
}

conus_status colour_pass_paint_streamlines(struct colour_pass *pass, const conus_atlas *atlas,
                                           struct tube_colouring *colouring, const bool *const *is_pale)
{
    const struct tube_colouring *used = colouring ? colouring : &pass->streamlines;
    conus_status status =
        pass->has_meshes ? pass->device->functions->paint(pass->device, atlas, used, is_pale) : CONUS_OK;
    if (!status && colouring) {
        tube_colouring_finish(&pass->streamlines);
        pass->streamlines = *colouring;
        *colouring = (struct tube_colouring){0};
    }
    return status;
}

conus_status colour_pass_include(struct colour_pass *pass, const conus_atlas *atlas, const uint8_t *areas,
                                 uint64_t max_memory)
{
    if (!pathways_shown(atlas)) {
        return CONUS_OK;
    }
    uint8_t *before = pass->drawn;
    uint8_t *drawn = memory_zeroed(atlas->object_count + 1, sizeof *drawn);
    if (!drawn) {
        return CONUS_ERROR_MEMORY;
    }
    bool differs = false;
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        bool in_voxels = atlas_object_volume(atlas, number);
        drawn[number] = in_voxels && areas ? areas[number] : PATHWAYS_AREA_LEFT_OUT;
        differs = differs || drawn[number] != before[number];
    }
    conus_status status = CONUS_OK;
    if (differs) {
        pass->drawn = drawn;
        status = colour_pass_update(pass, atlas, max_memory);
        pass->drawn = status ? before : drawn;
        drawn = status ? drawn : before;
    }
    memory_free(drawn);
    return status;
}

conus_status colour_pass_set_transfer(struct colour_pass *pass, const conus_atlas *atlas,
                                      const struct transfer *transfer, uint64_t max_memory)
{
    struct colour_pass fresh = {.device = pass->device};
    struct field_task task = colour_context_task(atlas_context(atlas), transfer);
    conus_status status = task.volume ? colour_upload_context(&fresh, &task, transfer, &max_memory) : CONUS_OK;
    status = status ? status : fill_texels(&fresh, &fresh.context, &task);
    field_task_end(&task);
    if (!status && task.volume) {
        const struct colour_pass made = fresh;
        fresh.context = pass->context;
        fresh.transfer = pass->transfer;
        pass->context = made.context;
        pass->transfer = made.transfer;
    }
    release_all(&fresh);
    memory_free(fresh.content);
    return status;
}

void colour_pass_finish(struct colour_pass *pass)
{
    if (pass->device && !colour_pass_enter(pass)) {
        release_all(pass);
        colour_pass_leave(pass);
    }
    if (pass->device) {
        pass->device->functions->destroy(pass->device);
    }
    free_tables(pass);
    *pass = (struct colour_pass){0};
}

/* Those that the view asks for, and of the surfaces around the areas the context's. */
static void find_opacities(const struct colour_pass *pass, const struct colour_view *view)
{
    size_t count = pass->object_count + 1;
    for (size_t number = 0; number < count; number++) {
        pass->opacity[number] = view->opacity ? view->opacity[number] : 1;
    }
    for (size_t i = count; i < count + pass->around_count; i++) {
        pass->opacity[i] = pass->around[i - count] * (float)(1 - view->fade);
    }
    pass->opacity[0] = pass->mapped_opacity * (float)(1 - view->fade);
}

void colour_pass_look(const struct colour_pass *pass, const struct colour_view *view)
{
    size_t count = 1 + pass->object_count + pass->around_count;
    for (size_t number = 0; number < count; number++) {
        bool is_object = number <= pass->object_count;
        size_t from = view->group && is_object ? view->group[number] : number;
        memcpy(pass->shown + 4 * number, pass->colours + 4 * from, 3 * sizeof *pass->shown);
        if (view->rgb && is_object) {
            draw_colour(pass->shown + 4 * number, view->rgb[number], 0);
        }
        enum emphasis own = is_object ? EMPHASIS_FULL : EMPHASIS_GLASS;
        enum emphasis shown = view->emphasis && is_object ? view->emphasis[number] : own;
        pass->shown[4 * number + 3] = (float)shown;
    }
    find_opacities(pass, view);
    skip_unseen(pass);
}
