/* SPDX-License-Identifier: BSD-3-Clause */
/* The colour pass's programs, its life, its changes and its draw call. */
#include "render/colour/colour.h"

#include "base/memory.h"
#include "render/colour/colour_upload.h"
#include "render/colour/colour_view.h"
#include "render/colour/pathways.h"
#include "render/gl/context.h"
#include "render/gl/shaders.h"

#include <string.h>

conus_status colour_program_create(GLuint *out, const struct program_shader *vertex, enum colour_program kind)
{
    const struct program_define defines[] = {
        {"MARKER_LIMIT", COLOUR_MARKER_LIMIT}, {"TRANSFER_ENTRIES", COLOUR_TABLE_ENTRIES},
        {"FIELD_SURFACE", FIELD_SURFACE},      {"PLAIN_AREAS", kind == COLOUR_RAYS_PLAIN || kind == COLOUR_SLICES},
        {"SLICES", kind == COLOUR_SLICES},     {"TILE", COLOUR_TILE},
        {"TRANSLUCENT", kind == COLOUR_LAYERS}};
    const struct program_shader more = {"colour_layers.glsl", shader_colour_layers};
    const struct program_source source = {.vertex = *vertex,
                                          .fragment = {"colour.frag.glsl", shader_colour_frag},
                                          .more = kind == COLOUR_LAYERS ? more : (struct program_shader){0},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof *defines};
    return program_create(out, &source);
}

static const struct program_shader screen = {.file = "screen.vert.glsl", .text = shader_screen_vert};
static const struct program_shader tile = {.file = "tile.vert.glsl", .text = shader_tile_vert};

conus_status colour_fields_start(struct colour_fields *out, const conus_atlas *atlas, const struct transfer *transfer)
{
    *out = (struct colour_fields){.objects = colour_objects_task(atlas)};
    conus_status status = colour_context_task(&out->context, atlas_context(atlas), transfer);
    if (!status) {
        field_task_start(&out->objects);
        field_task_start(&out->context);
    }
    return status;
}

void colour_fields_end(struct colour_fields *fields)
{
    field_task_end(&fields->objects);
    field_task_end(&fields->context);
}

conus_status colour_pass_init(struct colour_pass *out, const conus_atlas *atlas, const struct transfer *transfer,
                              struct haze_choice *hazy, struct colour_fields *fields, uint64_t max_memory)
{
    struct colour_pass pass = {.hazy = *hazy};
    conus_status status = colour_program_create(&pass.program, &screen, COLOUR_RAYS);
    if (!status) {
        status = colour_upload_palette(&pass, atlas);
    }
    if (!status) {
        status = colour_upload_objects(&pass, atlas, &pass.hazy, &fields->objects, &max_memory);
        pass.object_points = pass.content_count;
    }
    if (!status && fields->context.volume) {
        status = colour_upload_context(&pass, &fields->context, transfer, &max_memory);
    }
    status = status ? status : colour_upload_texels(&pass.areas, &fields->objects);
    status = status ? status : colour_upload_texels(&pass.context, &fields->context);
    if (!status) {
        status = colour_upload_meshes(&pass, atlas, &max_memory);
    }
    if (!status && !pass.content_count && pass.has_areas) {
        status = colour_add_corners(&pass, &pass.areas);
    }
    if (status) {
        pass.hazy = (struct haze_choice){0}; /* is still the caller's */
        colour_pass_finish(&pass);
        return status;
    }
    *hazy = (struct haze_choice){0};
    *out = pass;
    return CONUS_OK;
}

static bool has_layers(const struct colour_pass *pass, const struct colour_view *view)
{
    return view->opacity || pass->has_haze || pass->around_count;
}

static conus_status need_program(GLuint *program, const struct program_shader *vertex, enum colour_program kind)
{
    return *program ? CONUS_OK : colour_program_create(program, vertex, kind);
}

conus_status colour_pass_need(struct colour_pass *pass, const struct colour_view *view, bool smooth)
{
    bool layers = has_layers(pass, view);
    enum colour_program kind = layers ? COLOUR_LAYERS : COLOUR_RAYS;
    conus_status status = need_program(layers ? &pass->layer_program : &pass->program, &screen, kind);
    if (!status && smooth) {
        status = need_program(layers ? &pass->layer_tile_program : &pass->tile_program, &tile, kind);
    }
    return status;
}

GLuint colour_pass_tile_program(const struct colour_pass *pass, const struct colour_view *view)
{
    return has_layers(pass, view) ? pass->layer_tile_program : pass->tile_program;
}

/* 0 stands for no texture. */
static void delete_textures(const struct colour_pass *pass)
{
    const GLuint textures[] = {pass->transfer,      pass->objects,       pass->areas.field, pass->areas.empty,
                               pass->context.field, pass->context.empty, pass->haze.field};
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
    struct colour_pass fresh = {.drawn = pass->drawn};
    struct field_task task = colour_objects_task(atlas);
    conus_status status = colour_upload_objects(&fresh, atlas, &pass->hazy, &task, &max_memory);
    status = status ? status : colour_upload_texels(&fresh.areas, &task);
    field_task_end(&task);
    status = status ? status : exchange_content(pass, &fresh);
    if (!status) {
        struct colour_pass old = {.areas = pass->areas, .objects = pass->objects, .haze = pass->haze};
        pass->areas = fresh.areas;
        pass->haze = fresh.haze;
        pass->has_haze = fresh.has_haze;
        pass->objects = fresh.objects;
        pass->has_areas = fresh.has_areas;
        fresh.areas = old.areas;
        fresh.haze = old.haze;
        fresh.objects = old.objects;
        status = colour_pass_paint_streamlines(pass, atlas, NULL, NULL);
    }
    delete_textures(&fresh);
    memory_free(fresh.content);
    return status;
}

conus_status colour_pass_paint_streamlines(struct colour_pass *pass, const conus_atlas *atlas,
                                           struct tube_colouring *colouring, const bool *const *is_pale)
{
    const struct tube_colouring *used = colouring ? colouring : &pass->streamlines;
    conus_status status = pass->meshes ? mesh_layer_update(pass->meshes, atlas, used, is_pale) : CONUS_OK;
    if (!status && colouring) {
        tube_colouring_finish(&pass->streamlines);
        pass->streamlines = *colouring;
        *colouring = (struct tube_colouring){0};
    }
    return status;
}

/* Those of them that are of voxels; false where the picture has the same already. */
static bool choose_areas(uint8_t *out, const struct colour_pass *pass, const conus_atlas *atlas, const uint8_t *areas)
{
    bool other = false;
    for (uint32_t number = 1; number <= atlas->area_count; number++) {
        bool in_voxels = atlas_object_volume(atlas, number);
        out[number] = in_voxels && areas ? areas[number] : PATHWAYS_AREA_LEFT_OUT;
        other = other || out[number] != pass->drawn[number];
    }
    return other;
}

conus_status colour_pass_include(struct colour_pass *pass, const conus_atlas *atlas, const uint8_t *areas,
                                 uint64_t max_memory)
{
    if (!pathways_shown(atlas)) {
        return CONUS_OK;
    }
    uint8_t *before = pass->drawn;
    uint8_t *drawn = memory_zeroed(atlas->object_count + 1, sizeof *drawn);
    conus_status status = drawn ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && choose_areas(drawn, pass, atlas, areas)) {
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
    struct field_task task = {0};
    conus_status status = colour_context_task(&task, atlas_context(atlas), transfer);
    status = status || !task.volume ? status : colour_upload_context(&fresh, &task, transfer, &max_memory);
    status = status ? status : colour_upload_texels(&fresh.context, &task);
    field_task_end(&task);
    if (!status && task.volume) {
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
    const GLuint buffers[] = {pass->view, pass->palette, pass->opacities};
    if (pass->program) { /* otherwise there may be no GL at all */
        mesh_layer_destroy(pass->meshes);
        tube_colouring_finish(&pass->streamlines);
        delete_textures(pass);
        glDeleteBuffers(sizeof buffers / sizeof *buffers, buffers);
        glDeleteVertexArrays(1, &pass->vertices);
        glDeleteProgram(pass->program);
        glDeleteProgram(pass->tile_program);
        glDeleteProgram(pass->layer_program);
        glDeleteProgram(pass->layer_tile_program);
    }
    memory_free(pass->colours);
    memory_free(pass->shown);
    memory_free(pass->opacity);
    memory_free(pass->around);
    memory_free(pass->drawn);
    memory_free(pass->content);
    haze_choice_finish(&pass->hazy);
    *pass = (struct colour_pass){0};
}

static void bind_pass(const struct colour_pass *pass, bool layers)
{
    const GLuint textures[] = {pass->context.field,
                               pass->context.empty,
                               pass->transfer,
                               pass->areas.field,
                               pass->areas.empty,
                               pass->objects,
                               pass->meshes ? mesh_layer_surface(pass->meshes) : 0,
                               pass->meshes ? mesh_layer_object(pass->meshes) : 0,
                               pass->haze.field,
                               pass->meshes ? mesh_layer_peel_surface(pass->meshes) : 0,
                               pass->meshes ? mesh_layer_peel_object(pass->meshes) : 0};
    glBindTextures(0, sizeof textures / sizeof *textures, textures);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, pass->view);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, pass->palette);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, pass->opacities);
    glBindVertexArray(pass->vertices);
    glUseProgram(layers ? pass->layer_program : pass->program);
}

/* Of all numbers: what the view asks for of objects, and what is left of the surfaces around them. */
static const float *find_opacities(const struct colour_pass *pass, const struct colour_view *view)
{
    size_t count = pass->object_count + 1;
    for (size_t number = 0; number < count; number++) {
        pass->opacity[number] = view->opacity ? view->opacity[number] : 1;
    }
    for (size_t i = count; i < count + pass->around_count; i++) {
        pass->opacity[i] = pass->around[i - count] * (float)(1 - view->fade);
    }
    return pass->opacity;
}

void colour_pass_prepare(const struct colour_pass *pass, const struct colour_view *view)
{
    struct colour_view_block block = {0};
    colour_view_pack(&block, pass, view);
    size_t count = 1 + pass->object_count + pass->around_count;
    for (size_t number = 0; number < count; number++) {
        bool is_object = number <= pass->object_count;
        size_t from = view->group && is_object ? view->group[number] : number;
        memcpy(pass->shown + 4 * number, pass->colours + 4 * from, 3 * sizeof *pass->shown);
        pass->shown[4 * number + 3] = (float)(view->emphasis && is_object ? view->emphasis[number] : EMPHASIS_FULL);
    }
    glNamedBufferSubData(pass->view, 0, sizeof block, &block);
    glNamedBufferSubData(pass->palette, 0, (GLsizeiptr)(count * 4 * sizeof *pass->shown), pass->shown);
    if (has_layers(pass, view)) {
        const float *opacity = find_opacities(pass, view);
        glNamedBufferSubData(pass->opacities, 0, (GLsizeiptr)(count * sizeof *opacity), opacity);
    }
    bind_pass(pass, has_layers(pass, view));
}

conus_status colour_pass_begin(const struct colour_pass *pass, const struct colour_view *view)
{
    const float *opacity = has_layers(pass, view) ? find_opacities(pass, view) : NULL;
    const struct mesh_layer_view layer = {view->camera, view->width, view->height,  {view->shift[0], view->shift[1]},
                                          opacity,      view->draft, view->listener};
    return pass->meshes ? mesh_layer_draw(pass->meshes, &layer) : CONUS_OK;
}

conus_status colour_pass_draw(const struct colour_pass *pass, const struct colour_view *view)
{
    colour_pass_prepare(pass, view);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return gl_check("colour pass");
}
