/* SPDX-License-Identifier: BSD-3-Clause */
#include "render/colour/colour.h"

#include "base/math3.h"
#include "base/memory.h"
#include "render/colour/field.h"
#include "render/colour/pathways.h"
#include "render/gl/context.h"
#include "render/gl/shaders.h"
#include "render/gl/volume_texture.h"
#include "render/image/image.h"

/* One table entry for each of four steps between neighbouring densities. */
enum { TABLE_PER_LEVEL = 4, TABLE_ENTRIES = (FIELD_LEVELS - 1) * TABLE_PER_LEVEL + 1 };

enum { MESH_POINTS = 100000 };

/* The shader's uniform block View, in std140's layout. */
struct view_block {
    float context_from_camera[16], areas_from_camera[16], world_from_camera[16];
    float context_bricks[4], areas_bricks[4];
    float lens[4], middle[4], planes[4], light[4];
    float apex[4], axis[4], cone_shape[4], cone_colour[4], line[4];
    int32_t counts[4];
    float markers[COLOUR_MARKER_LIMIT][4], marker_colours[COLOUR_MARKER_LIMIT][4];
};

/* ---- Creation ------------------------------------------------------------------------------------------------- */

static void place(struct colour_volume *out, const struct volume *volume)
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

/* Appends the corners of all bricks that show. */
static conus_status add_content(struct colour_pass *pass, const struct bricks *bricks,
                                const struct colour_volume *volume)
{
    size_t count = bricks->dim[0] * bricks->dim[1] * bricks->dim[2];
    double(*points)[3] = memory_resize(pass->content, pass->content_count + 8 * count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    pass->content = points;
    for (size_t b = 0; b < count; b++) {
        const size_t at[3] = {b % bricks->dim[0], b / bricks->dim[0] % bricks->dim[1],
                              b / bricks->dim[0] / bricks->dim[1]};
        for (int n = 0; n < 8 && !bricks->distance[b]; n++) {
            double voxel[3];
            for (int a = 0; a < 3; a++) {
                size_t edge = (at[a] + (size_t)(n >> a & 1)) * BRICKS_EDGE;
                voxel[a] = (double)(edge < volume->dim[a] ? edge : volume->dim[a]) - 0.5;
            }
            mat4_point(points[pass->content_count++], volume->world_from_voxel, voxel);
        }
    }
    return CONUS_OK;
}

/* Appends the corners of the whole grid: for an atlas in which nothing shows. */
static conus_status add_corners(struct colour_pass *pass, const struct colour_volume *volume)
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

/* Uploads a field and the distances to the bricks with densities that `visible` names. */
static conus_status upload(struct colour_pass *pass, struct colour_volume *out, const struct volume *volume,
                           const struct field *field, const bool *visible, uint64_t *memory_left)
{
    struct bricks bricks = {0};
    conus_status status = field_bricks(&bricks, field, visible, TABLE_PER_LEVEL);
    place(out, volume);
    if (!status) {
        status = add_content(pass, &bricks, out);
    }
    if (!status) {
        status = volume_texture_create(&out->field, VOLUME_TEXTURE_BYTE4, field->dim, field->texels, memory_left);
    }
    if (!status) {
        status = volume_texture_create(&out->empty, VOLUME_TEXTURE_UINT8, bricks.dim, bricks.distance, memory_left);
    }
    bricks_finish(&bricks);
    return status;
}

static conus_status upload_areas(struct colour_pass *pass, const struct volume *volume, uint64_t *memory_left)
{
    bool visible[TABLE_ENTRIES];
    for (size_t i = 0; i < TABLE_ENTRIES; i++) {
        visible[i] = i > (FIELD_SURFACE - 1) * TABLE_PER_LEVEL;
    }
    struct field field = {0};
    conus_status status = field_of_objects(&field, volume);
    if (!status) {
        status = upload(pass, &pass->areas, volume, &field, visible, memory_left);
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

/* All opaque areas would hide pathways: where there are any, they are drawn with only some areas, those in @p drawn. */
static conus_status upload_objects(struct colour_pass *pass, const conus_atlas *atlas, const bool *drawn,
                                   uint64_t *memory_left)
{
    if (!pathways_first(atlas)) {
        const struct volume *parcellation = atlas_parcellation(atlas);
        return parcellation ? upload_areas(pass, parcellation, memory_left) : CONUS_OK;
    }
    struct volume joint = {0};
    conus_status status = pathways_join(&joint, atlas, drawn);
    status = status ? status : upload_areas(pass, &joint, memory_left);
    volume_finish(&joint);
    return status;
}

/* Vertices, about MESH_POINTS of them, for the camera to frame. */
static conus_status add_mesh_content(struct colour_pass *pass, const conus_atlas *atlas)
{
    size_t vertices = 0;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        vertices += mesh ? mesh->vertex_count : 0;
    }
    size_t step = vertices / MESH_POINTS + 1;
    double(*points)[3] =
        memory_resize(pass->content, pass->content_count + vertices / step + atlas->mesh_count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    pass->content = points;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        const struct mesh *mesh = atlas_object_mesh(atlas, number);
        for (size_t v = 0; mesh && v < mesh->vertex_count; v += step) {
            for (size_t a = 0; a < 3; a++) {
                points[pass->content_count][a] = (double)mesh->positions[3 * v + a];
            }
            pass->content_count++;
        }
    }
    return CONUS_OK;
}

static conus_status upload_meshes(struct colour_pass *pass, const conus_atlas *atlas, uint64_t *memory_left)
{
    if (!atlas->mesh_count) {
        return CONUS_OK;
    }
    conus_status status = mesh_layer_create(&pass->meshes, atlas, memory_left);
    return status ? status : add_mesh_content(pass, atlas);
}

static GLuint table_texture(const float *table)
{
    GLuint texture = 0;
    glCreateTextures(GL_TEXTURE_2D, 1, &texture);
    glTextureStorage2D(texture, 1, GL_RGBA32F, TABLE_ENTRIES, 1);
    glTextureSubImage2D(texture, 0, 0, 0, TABLE_ENTRIES, 1, GL_RGBA, GL_FLOAT, table);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return texture;
}

static conus_status upload_context(struct colour_pass *pass, const struct volume *volume,
                                   const struct transfer *transfer, uint64_t *memory_left)
{
    float table[TABLE_ENTRIES * 4];
    bool visible[TABLE_ENTRIES];
    transfer_table(table, TABLE_ENTRIES, transfer);
    for (size_t i = 0; i < TABLE_ENTRIES; i++) {
        visible[i] = table[4 * i + 3] > 0;
    }
    struct field field = {0};
    double low, high;
    conus_status status = transfer_span(&low, &high, transfer, volume);
    if (!status) {
        status = field_of_values(&field, volume, low, high);
    }
    if (!status) {
        status = upload(pass, &pass->context, volume, &field, visible, memory_left);
    }
    if (!status) {
        pass->transfer = table_texture(table);
        status = gl_check("transfer function");
    }
    field_finish(&field);
    pass->has_context = true;
    return status;
}

static conus_status upload_palette(struct colour_pass *pass, const conus_atlas *atlas)
{
    pass->object_count = atlas->object_count;
    pass->colours = memory_zeroed(atlas->object_count + 1, 4 * sizeof *pass->colours);
    pass->shown = memory_zeroed(atlas->object_count + 1, 4 * sizeof *pass->shown);
    pass->drawn = memory_zeroed(atlas->object_count + 1, sizeof *pass->drawn);
    if (!pass->colours || !pass->shown || !pass->drawn) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t number = 1; number <= atlas->object_count; number++) {
        for (int c = 0; c < 3; c++) {
            double srgb = atlas->objects[number - 1].rgb[c] / 255.0;
            pass->colours[4 * number + (size_t)c] = (float)linear_from_srgb(srgb);
        }
    }
    glCreateBuffers(1, &pass->palette);
    glNamedBufferData(pass->palette, (GLsizeiptr)((atlas->object_count + 1) * 4 * sizeof *pass->colours), NULL,
                      GL_DYNAMIC_DRAW);
    glCreateBuffers(1, &pass->view);
    glNamedBufferData(pass->view, sizeof(struct view_block), NULL, GL_DYNAMIC_DRAW);
    glCreateVertexArrays(1, &pass->vertices);
    return gl_check("colour pass");
}

conus_status colour_program_create(GLuint *out, const struct program_shader *vertex, enum colour_program kind)
{
    const struct program_define defines[] = {
        {"MARKER_LIMIT", COLOUR_MARKER_LIMIT}, {"TRANSFER_ENTRIES", TABLE_ENTRIES}, {"FIELD_SURFACE", FIELD_SURFACE},
        {"PLAIN_AREAS", kind != COLOUR_RAYS},  {"SLICES", kind == COLOUR_SLICES},   {"TILE", COLOUR_TILE}};
    const struct program_source source = {.vertex = *vertex,
                                          .fragment = {"colour.frag.glsl", shader_colour_frag},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof *defines};
    return program_create(out, &source);
}

conus_status colour_pass_init(struct colour_pass *out, const conus_atlas *atlas, const struct transfer *transfer,
                              uint64_t max_memory)
{
    struct colour_pass pass = {0};
    const struct volume *context = atlas_context(atlas);
    static const struct program_shader screen = {"screen.vert.glsl", shader_screen_vert};
    static const struct program_shader tile = {"tile.vert.glsl", shader_tile_vert};
    conus_status status = colour_program_create(&pass.program, &screen, COLOUR_RAYS);
    status = status ? status : colour_program_create(&pass.tile_program, &tile, COLOUR_RAYS);
    if (!status) {
        status = upload_palette(&pass, atlas);
    }
    if (!status) {
        status = upload_objects(&pass, atlas, NULL, &max_memory);
        pass.object_points = pass.content_count;
    }
    if (!status && context) {
        status = upload_context(&pass, context, transfer, &max_memory);
    }
    if (!status) {
        status = upload_meshes(&pass, atlas, &max_memory);
    }
    if (!status && !pass.content_count && pass.has_areas) {
        status = add_corners(&pass, &pass.areas);
    }
    if (status) {
        colour_pass_finish(&pass);
        return status;
    }
    *out = pass;
    return CONUS_OK;
}

/* 0 stands for no texture. */
static void delete_textures(const struct colour_pass *pass)
{
    const GLuint textures[] = {pass->transfer,    pass->objects,       pass->areas.field,
                               pass->areas.empty, pass->context.field, pass->context.empty};
    glDeleteTextures(sizeof textures / sizeof *textures, textures);
}

/* Puts the points of @p fresh in the place of those that came from voxels' objects before. */
static conus_status exchange_content(struct colour_pass *pass, const struct colour_pass *fresh)
{
    size_t kept = pass->content_count - pass->object_points;
    size_t count = fresh->content_count + kept;
    double(*points)[3] = memory_raw(count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        bool is_fresh = i < fresh->content_count;
        const double *from =
            is_fresh ? fresh->content[i] : pass->content[i - fresh->content_count + pass->object_points];
        memcpy(points[i], from, sizeof points[i]);
    }
    memory_free(pass->content);
    pass->content = points;
    pass->content_count = count;
    pass->object_points = fresh->content_count;
    return CONUS_OK;
}

conus_status colour_pass_update(struct colour_pass *pass, const conus_atlas *atlas, uint64_t max_memory)
{
    struct colour_pass fresh = {0};
    conus_status status = upload_objects(&fresh, atlas, pass->drawn, &max_memory);
    status = status ? status : exchange_content(pass, &fresh);
    if (!status) {
        struct colour_pass old = {.areas = pass->areas, .objects = pass->objects};
        pass->areas = fresh.areas;
        pass->objects = fresh.objects;
        pass->has_areas = fresh.has_areas;
        fresh.areas = old.areas;
        fresh.objects = old.objects;
        if (pass->meshes) {
            mesh_layer_update(pass->meshes, atlas);
        }
    }
    delete_textures(&fresh);
    memory_free(fresh.content);
    return status;
}

/* Areas of voxels that stand out; false where the picture has the same already. */
static bool choose_areas(bool *out, const struct colour_pass *pass, const conus_atlas *atlas, const uint8_t *emphasis)
{
    bool other = false;
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        bool in_voxels = atlas_object_volume(atlas, number);
        out[number] = in_voxels && emphasis && emphasis[number] != EMPHASIS_PALE;
        other = other || out[number] != pass->drawn[number];
    }
    return other;
}

conus_status colour_pass_include(struct colour_pass *pass, const conus_atlas *atlas, const uint8_t *emphasis,
                                 uint64_t max_memory)
{
    if (!pathways_first(atlas) || !atlas_parcellation(atlas)) {
        return CONUS_OK;
    }
    bool *before = pass->drawn;
    bool *drawn = memory_zeroed(atlas->object_count + 1, sizeof *drawn);
    conus_status status = drawn ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && choose_areas(drawn, pass, atlas, emphasis)) {
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
    struct colour_pass fresh = {0};
    const struct volume *context = atlas_context(atlas);
    conus_status status = context ? upload_context(&fresh, context, transfer, &max_memory) : CONUS_OK;
    if (!status && context) {
        struct colour_pass old = {.context = pass->context, .transfer = pass->transfer};
        pass->context = fresh.context;
        pass->transfer = fresh.transfer;
        fresh.context = old.context;
        fresh.transfer = old.transfer;
    }
    delete_textures(&fresh);
    memory_free(fresh.content);
    return status;
}

void colour_pass_finish(struct colour_pass *pass)
{
    const GLuint buffers[] = {pass->view, pass->palette};
    if (pass->program) { /* otherwise there may be no GL at all */
        mesh_layer_destroy(pass->meshes);
        delete_textures(pass);
        glDeleteBuffers(sizeof buffers / sizeof *buffers, buffers);
        glDeleteVertexArrays(1, &pass->vertices);
        glDeleteProgram(pass->program);
        glDeleteProgram(pass->tile_program);
    }
    memory_free(pass->colours);
    memory_free(pass->shown);
    memory_free(pass->drawn);
    memory_free(pass->content);
    *pass = (struct colour_pass){0};
}

/* ---- Drawing -------------------------------------------------------------------------------------------------- */

static void join(struct slices *joint, const struct colour_volume *volume, const struct camera *camera)
{
    const double *m = camera->world_from_camera;
    const double forward[3] = {-m[8], -m[9], -m[10]};
    struct slices own = slices_over(volume->dim, volume->world_from_voxel, m + 12, forward, 1);
    if (own.count) {
        double end = fmax(joint->count ? joint->start + joint->spacing : 0, own.start + own.spacing);
        joint->start = joint->count ? fmin(joint->start, own.start) : own.start;
        joint->spacing = end - joint->start;
        joint->count = 1;
    }
}

struct slices colour_pass_slices(const struct colour_pass *pass, const struct camera *camera, uint32_t count)
{
    struct slices joint = {0};
    uint32_t finest = 1;
    const struct colour_volume *volumes[] = {pass->has_areas ? &pass->areas : NULL,
                                             pass->has_context ? &pass->context : NULL};
    for (int i = 0; i < 2; i++) {
        if (volumes[i]) {
            uint32_t own = slices_default(volumes[i]->dim);
            finest = own > finest ? own : finest;
            join(&joint, volumes[i], camera);
        }
    }
    if (joint.count) {
        joint.count = count ? count : finest;
        joint.spacing /= joint.count;
    }
    return joint;
}

static void set4(float out[4], const double xyz[3], double w)
{
    for (int i = 0; i < 3; i++) {
        out[i] = (float)xyz[i];
    }
    out[3] = (float)w;
}

static void set_volume(float from_camera[16], float bricks[4], const struct colour_volume *volume,
                       const struct camera *camera)
{
    double m[16];
    mat4_multiply(m, volume->texture_from_world, camera->world_from_camera);
    for (int i = 0; i < 16; i++) {
        from_camera[i] = (float)m[i];
    }
    for (int a = 0; a < 3; a++) {
        bricks[a] = (float)((double)volume->dim[a] / BRICKS_EDGE);
    }
    bricks[3] = 1;
}

static void set_cone(struct view_block *block, const struct colour_view *view, const double camera_from_world[16])
{
    const double *m = view->world_from_cone;
    double apex[3], axis[3];
    const double forward[3] = {-m[8], -m[9], -m[10]};
    mat4_point(apex, camera_from_world, m + 12);
    mat4_direction(axis, camera_from_world, forward);
    set4(block->apex, apex, view->cone_slope);
    set4(block->axis, axis, view->cone_length);
    set4(block->cone_shape, (double[]){view->cone_radius, view->cone_start, 0}, 1);
    set4(block->cone_colour, (double[]){1.0, 0.42, 0.02}, 0.09);
}

static void set_markers(struct view_block *block, const struct colour_view *view, const double camera_from_world[16])
{
    size_t count = view->marker_count < COLOUR_MARKER_LIMIT ? view->marker_count : COLOUR_MARKER_LIMIT;
    block->counts[0] = (int32_t)count;
    for (size_t i = 0; i < count; i++) {
        const struct colour_marker *marker = &view->markers[i];
        double centre[3];
        mat4_point(centre, camera_from_world, marker->centre);
        set4(block->markers[i], centre, marker->radius);
        for (int c = 0; c < 3; c++) {
            block->marker_colours[i][c] = (float)linear_from_srgb(marker->rgb[c] / 255.0);
        }
    }
}

static void set_view(struct view_block *block, const struct colour_pass *pass, const struct colour_view *view)
{
    const struct camera *camera = view->camera;
    double camera_from_world[16], light[3];
    mat4_invert_affine(camera_from_world, camera->world_from_camera);
    struct slices slices = colour_pass_slices(pass, camera, view->slices);
    mat4_direction(light, camera->world_from_camera, (double[]){-0.42, 0.52, 0.74});
    vec3_normalise(light, light);
    for (int i = 0; i < 12; i++) {
        block->world_from_camera[i] = (float)camera->world_from_camera[i];
    }
    set4(block->lens, (double[]){camera->slope[0], camera->slope[1], view->width}, view->height);
    set4(block->middle, (double[]){camera->middle[0], camera->middle[1], 0}, 0);
    set4(block->planes, (double[]){slices.start, slices.count ? slices.spacing : 1, slices.count}, !view->no_skipping);
    set4(block->light, light, 1 - view->fade);
    set4(block->line, (double[]){0.5 * view->line_width, 0.5 * view->line_width, view->shift[0]}, view->shift[1]);
    if (pass->has_areas) {
        set_volume(block->areas_from_camera, block->areas_bricks, &pass->areas, camera);
    }
    if (pass->has_context && view->fade < 1) {
        set_volume(block->context_from_camera, block->context_bricks, &pass->context, camera);
    }
    if (view->world_from_cone) {
        set_cone(block, view, camera_from_world);
    }
    set_markers(block, view, camera_from_world);
    block->counts[1] = pass->meshes ? 1 : 0;
}

static void bind(const struct colour_pass *pass)
{
    const GLuint textures[] = {pass->context.field,
                               pass->context.empty,
                               pass->transfer,
                               pass->areas.field,
                               pass->areas.empty,
                               pass->objects,
                               pass->meshes ? mesh_layer_surface(pass->meshes) : 0,
                               pass->meshes ? mesh_layer_object(pass->meshes) : 0};
    glBindTextures(0, sizeof textures / sizeof *textures, textures);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, pass->view);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, pass->palette);
    glBindVertexArray(pass->vertices);
    glUseProgram(pass->program);
}

void colour_pass_prepare(const struct colour_pass *pass, const struct colour_view *view)
{
    struct view_block block = {0};
    set_view(&block, pass, view);
    for (size_t number = 0; number <= pass->object_count; number++) {
        size_t from = view->group ? view->group[number] : number;
        memcpy(pass->shown + 4 * number, pass->colours + 4 * from, 3 * sizeof *pass->shown);
        pass->shown[4 * number + 3] = view->emphasis ? (float)view->emphasis[number] : (float)EMPHASIS_FULL;
    }
    glNamedBufferSubData(pass->view, 0, sizeof block, &block);
    glNamedBufferSubData(pass->palette, 0, (GLsizeiptr)((pass->object_count + 1) * 4 * sizeof *pass->shown),
                         pass->shown);
    bind(pass);
}

conus_status colour_pass_begin(const struct colour_pass *pass, const struct colour_view *view)
{
    const struct mesh_layer_view layer = {view->camera, view->width, view->height, {view->shift[0], view->shift[1]}};
    return pass->meshes ? mesh_layer_draw(pass->meshes, &layer) : CONUS_OK;
}

conus_status colour_pass_draw(const struct colour_pass *pass, const struct colour_view *view)
{
    colour_pass_prepare(pass, view);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return gl_check("colour pass");
}
