/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads volumes, meshes and colours of an atlas for the colour pass, and collects the points around what shows. */
#include "render/colour/colour_upload.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/colour/bricks.h"
#include "render/colour/colour_view.h"
#include "render/colour/pathways.h"
#include "render/gl/context.h"
#include "render/gl/volume_texture.h"
#include "render/image/image_srgb.h"

#include <string.h>

enum { MESH_POINTS = 100000, SLAB_VOXELS = 1 << 17 };

static void place_volume(struct colour_volume *out, const struct volume *volume)
{
    double texture_from_voxel[16];
    mat4_identity(texture_from_voxel);
    for (int a = 0; a < 3; a++) {
        out->dim[a] = volume->info.dim[a];
        texture_from_voxel[5 * a] = 1.0 / (double)out->dim[a];
        texture_from_voxel[12 + a] = 0.5 / (double)out->dim[a];
    }
    mat4_multiply(out->texture_from_world, texture_from_voxel, volume->voxel_from_world);
    memcpy(out->world_from_voxel, volume->info.world_from_voxel, sizeof out->world_from_voxel);
}

/* Whether one of the up to eight bricks round a corner shows. */
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

/* Appends the corners of all bricks that show, each once. */
static conus_status add_content(struct colour_pass *pass, const struct bricks *bricks,
                                const struct colour_volume *volume)
{
    const size_t dim[3] = {bricks->dim[0] + 1, bricks->dim[1] + 1, bricks->dim[2] + 1};
    size_t count = dim[0] * dim[1] * dim[2];
    double(*points)[3] = memory_resize(pass->content, pass->content_count + count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    pass->content = points;
    for (size_t c = 0; c < count; c++) {
        const size_t corner[3] = {c % dim[0], c / dim[0] % dim[1], c / dim[0] / dim[1]};
        if (corner_shows(bricks, corner)) {
            double voxel[3];
            for (int a = 0; a < 3; a++) {
                size_t edge = corner[a] * BRICKS_EDGE;
                voxel[a] = (double)(edge < volume->dim[a] ? edge : volume->dim[a]) - 0.5;
            }
            mat4_point(points[pass->content_count++], volume->world_from_voxel, voxel);
        }
    }
    return CONUS_OK;
}

/* Appends the corners of the whole grid: for an atlas in which nothing shows. */
conus_status colour_add_corners(struct colour_pass *pass, const struct colour_volume *volume)
{
    double(*points)[3] = memory_resize(pass->content, pass->content_count + 8, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    pass->content = points;
    for (int n = 0; n < 8; n++) {
        double corner[3];
        for (int a = 0; a < 3; a++) {
            corner[a] = n >> a & 1 ? (double)volume->dim[a] - 0.5 : -0.5;
        }
        mat4_point(points[pass->content_count++], volume->world_from_voxel, corner);
    }
    return CONUS_OK;
}

/* Texels are made a few slices at a time, which stay in the processor's cache. */
static conus_status upload_texels(GLuint *out, const struct field *field, uint64_t *memory_left)
{
    size_t slice = field->dim[0] * field->dim[1];
    size_t step = SLAB_VOXELS / slice + 1;
    uint8_t *texels = memory_raw(step * slice, 4);
    conus_status status =
        texels ? volume_texture_create(out, VOLUME_TEXTURE_BYTE4, field->dim, NULL, memory_left) : CONUS_ERROR_MEMORY;
    for (size_t first = 0; first < field->dim[2] && !status; first += step) {
        size_t count = field->dim[2] - first < step ? field->dim[2] - first : step;
        field_texels(texels, field, first, count);
        volume_texture_fill(*out, VOLUME_TEXTURE_BYTE4, field->dim, first, count, texels);
    }
    memory_free(texels);
    return status ? status : gl_check("volume texture");
}

/* Uploads a field and the distances to the bricks with densities that `visible` names. */
static conus_status upload_field(struct colour_pass *pass, struct colour_volume *out, const struct volume *volume,
                                 const struct field *field, const bool *visible, uint64_t *memory_left)
{
    struct bricks bricks = {0};
    conus_status status = field_bricks(&bricks, field, visible, TABLE_PER_LEVEL);
    place_volume(out, volume);
    if (!status) {
        status = add_content(pass, &bricks, out);
    }
    if (!status) {
        status = upload_texels(&out->field, field, memory_left);
    }
    if (!status) {
        status = volume_texture_create(&out->empty, VOLUME_TEXTURE_UINT8, bricks.dim, bricks.distance, memory_left);
    }
    bricks_finish(&bricks);
    return status;
}

/* `task` is of the volume. */
static conus_status upload_areas(struct colour_pass *pass, struct field_task *task, uint64_t *memory_left)
{
    bool visible[COLOUR_TABLE_ENTRIES];
    for (size_t i = 0; i < COLOUR_TABLE_ENTRIES; i++) {
        visible[i] = i > (FIELD_SURFACE - 1) * TABLE_PER_LEVEL;
    }
    const struct volume *volume = task->volume;
    struct field field = {0};
    conus_status status = field_task_take(&field, task);
    if (!status) {
        status = upload_field(pass, &pass->areas, volume, &field, visible, memory_left);
    }
    if (!status) {
        enum volume_texture_kind kind = volume->objects16 ? VOLUME_TEXTURE_UINT16 : VOLUME_TEXTURE_UINT32;
        const void *objects = volume->objects16 ? (const void *)volume->objects16 : volume->objects32;
        status = volume_texture_create(&pass->objects, kind, volume->info.dim, objects, memory_left);
    }
    field_finish(&field);
    pass->has_areas = true;
    return status;
}

static conus_status upload_haze(struct colour_pass *pass, const conus_atlas *atlas, const struct haze_choice *hazy,
                                uint64_t *memory_left)
{
    struct haze_field field = {0};
    struct volume grid = {0};
    conus_status status = hazy->transfers ? haze_fill(&field, atlas, hazy, *memory_left) : CONUS_OK;
    if (!status && field.texels) {
        status = volume_init(&grid, &field.info);
        status = status ? status
                        : volume_texture_create(&pass->haze.field, VOLUME_TEXTURE_HALF4, field.info.dim, field.texels,
                                                memory_left);
        if (!status) {
            place_volume(&pass->haze, &grid);
            pass->has_haze = true;
            status = colour_add_corners(pass, &pass->haze);
        }
        volume_finish(&grid);
    }
    haze_field_finish(&field);
    return status;
}

/* All opaque areas would hide pathways and bundles: where there are any, they are drawn with only some areas. */
static bool is_joint(const conus_atlas *atlas)
{
    return pathways_first(atlas) || atlas_parcellation_count(atlas) > 1 ||
           (atlas_parcellation_count(atlas) && pathways_shown(atlas));
}

struct field_task colour_objects_task(const conus_atlas *atlas)
{
    bool one = atlas_parcellation_count(atlas) && !is_joint(atlas);
    return (struct field_task){.volume = one ? &atlas->volumes[0] : NULL};
}

conus_status colour_upload_objects(struct colour_pass *pass, const conus_atlas *atlas, const struct haze_choice *hazy,
                                   struct field_task *task, uint64_t *memory_left)
{
    if (!is_joint(atlas)) {
        return task->volume ? upload_areas(pass, task, memory_left) : CONUS_OK;
    }
    struct volume joint = {0};
    conus_status status = pathways_join(&joint, atlas, pass->drawn, hazy);
    status = status ? status : upload_areas(pass, &(struct field_task){.volume = &joint}, memory_left);
    volume_finish(&joint);
    return status ? status : upload_haze(pass, atlas, hazy, memory_left);
}

/* The mesh of an object that is shown, or behind these of a surface around them; NULL if there is none. */
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
    double(*points)[3] = memory_resize(pass->content, pass->content_count + vertices / step + last + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    pass->content = points;
    for (size_t number = 1; number <= last; number++) {
        const struct mesh *mesh = shown_mesh(atlas, number);
        for (size_t v = 0; mesh && v < mesh->vertex_count; v += step) {
            for (size_t a = 0; a < 3; a++) {
                points[pass->content_count][a] = (double)mesh->positions[3 * v + a];
            }
            pass->content_count++;
        }
    }
    return CONUS_OK;
}

/* The same of the points of streamlines. */
static conus_status add_bundle_content(struct colour_pass *pass, const conus_atlas *atlas)
{
    uint64_t total = 0;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        total += atlas->tractograms[i].point_count;
    }
    uint64_t step = total / MESH_POINTS + 1;
    double(*points)[3] =
        memory_resize(pass->content, pass->content_count + total / step + atlas->tractogram_count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    pass->content = points;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        for (uint64_t at = 0; at < atlas->tractograms[i].point_count; at += step) {
            tractogram_point(points[pass->content_count++], &atlas->tractograms[i], at);
        }
    }
    return CONUS_OK;
}

conus_status colour_upload_meshes(struct colour_pass *pass, const conus_atlas *atlas, uint64_t *memory_left)
{
    if (!atlas->mesh_count && !atlas->context_surface_count && !atlas->tractogram_count) {
        return CONUS_OK;
    }
    conus_status status = mesh_layer_create(&pass->meshes, atlas, memory_left);
    status = status ? status : add_mesh_content(pass, atlas);
    return status ? status : add_bundle_content(pass, atlas);
}

static GLuint table_texture(const float *table)
{
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, GL_RGBA32F, COLOUR_TABLE_ENTRIES, 1);
    glTextureSubImage2D(texture, 0, 0, 0, COLOUR_TABLE_ENTRIES, 1, GL_RGBA, GL_FLOAT, table);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

conus_status colour_context_task(struct field_task *out, const struct volume *volume, const struct transfer *transfer)
{
    struct field_task task = {.volume = volume, .is_values = true};
    conus_status status = volume ? transfer_span(&task.low, &task.high, transfer, volume) : CONUS_OK;
    if (!status) {
        *out = task;
    }
    return status;
}

conus_status colour_upload_context(struct colour_pass *pass, struct field_task *task, const struct transfer *transfer,
                                   uint64_t *memory_left)
{
    float table[COLOUR_TABLE_ENTRIES * 4];
    bool visible[COLOUR_TABLE_ENTRIES];
    transfer_table(table, COLOUR_TABLE_ENTRIES, transfer);
    for (size_t i = 0; i < COLOUR_TABLE_ENTRIES; i++) {
        visible[i] = table[4 * i + 3] > 0;
    }
    struct field field = {0};
    conus_status status = field_task_take(&field, task);
    if (!status) {
        status = upload_field(pass, &pass->context, task->volume, &field, visible, memory_left);
    }
    if (!status) {
        pass->transfer = table_texture(table);
        status = gl_check("transfer function");
    }
    field_finish(&field);
    pass->has_context = true;
    return status;
}

/* Bone: what it is around has the colours. */
static const double around_srgb[3] = {0.86, 0.83, 0.78};

static void fill_colours(struct colour_pass *pass, const conus_atlas *atlas)
{
    for (size_t number = 1; number <= atlas->object_count + atlas->context_surface_count; number++) {
        for (size_t c = 0; c < 3; c++) {
            double srgb = number <= atlas->object_count ? atlas->objects[number - 1].rgb[c] / 255.0 : around_srgb[c];
            pass->colours[4 * number + c] = (float)linear_from_srgb(srgb);
        }
    }
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        pass->around[i] = (float)atlas->context_surfaces[i].opacity;
    }
}

conus_status colour_upload_palette(struct colour_pass *pass, const conus_atlas *atlas)
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
    fill_colours(pass, atlas);
    glCreateBuffers(1, &pass->palette);
    glNamedBufferData(pass->palette, (GLsizeiptr)(count * 4 * sizeof *pass->colours), NULL, GL_DYNAMIC_DRAW);
    glCreateBuffers(1, &pass->opacities);
    glNamedBufferData(pass->opacities, (GLsizeiptr)(count * sizeof(float)), NULL, GL_DYNAMIC_DRAW);
    glCreateBuffers(1, &pass->view);
    glNamedBufferData(pass->view, sizeof(struct colour_view_block), NULL, GL_DYNAMIC_DRAW);
    glCreateVertexArrays(1, &pass->vertices);
    return gl_check("colour pass");
}
