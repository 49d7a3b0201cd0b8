/* SPDX-License-Identifier: BSD-3-Clause */
/* The colour pass by OpenGL: its programs, textures and draw calls. */
#include "render/colour/colour_gl.h"

#include "base/look.h"
#include "base/memory.h"
#include "render/colour/colour.h"
#include "render/gl/gl.h"
#include "render/passes/id_pass.h"

#include <string.h>

enum { TILE_BUFFER = 1 }; /* where all shaders have it */

/* Everything but the context is of it. */
struct colour_gl {
    struct colour_device device;
    struct gl_context *context;
    struct gl_current previous; /* what was current before enter() */
    GLuint programs[2][2];      /* Over one triangle on the screen, [translucent][with a context]; 0 until needed. */
    GLuint view, palette, opacities, vertices;
    GLuint tiles;              /* All that is drawn now; 0 = all of the picture. */
    struct mesh_layer *meshes; /* NULL if there are none. */
    struct target target;      /* of the last picture */
    uint8_t *looks[2];         /* put_look() of the newest picture, and room for that of the next */
    bool is_plain;             /* `target` has the newest picture, with one ray a pixel */
};

static struct colour_gl *gl_of(const struct colour_pass *pass)
{
    return (struct colour_gl *)pass->device;
}

static conus_status enter(struct colour_device *device)
{
    struct colour_gl *gl = (struct colour_gl *)device;
    return gl_context_use(gl->context, &gl->previous);
}

static void leave(struct colour_device *device)
{
    gl_current_restore(&((struct colour_gl *)device)->previous);
}

static conus_status hold(struct colour_texels *out, struct colour_device *device, enum volume_texture_kind kind,
                         const size_t dim[3], const void *texels, uint64_t *memory_left)
{
    ((struct colour_gl *)device)->is_plain = false;
    out->kind = kind;
    memcpy(out->dim, dim, sizeof out->dim);
    return volume_texture_create(&out->name, kind, dim, texels, memory_left);
}

static void fill(struct colour_texels *texels, size_t first, size_t count, const void *from)
{
    volume_texture_fill(texels->name, texels->kind, texels->dim, first, count, from);
}

/* GL ignores the number 0. */
static void release(struct colour_texels *texels)
{
    glDeleteTextures(1, &texels->name);
}

/* Bytes of all that a picture shows of the atlas as it is. */
static size_t look_size(const struct colour_pass *pass)
{
    const size_t count = 1 + pass->object_count + pass->around_count;
    return sizeof(struct colour_view_block) + sizeof(struct camera) + sizeof(double) + count * 5 * sizeof(float);
}

static void put_look(uint8_t *out, const struct colour_pass *pass, const struct colour_view *view)
{
    const size_t count = 1 + pass->object_count + pass->around_count;
    const double draft = gl_of(pass)->meshes ? view->draft : 0; /* of streamlines */
    struct colour_view_block block = {0};
    colour_view_pack(&block, pass, view);
    block.counts[1] = colour_pass_has_layers(pass, view);
    colour_pass_look(pass, view);
    memcpy(out, &block, sizeof block);
    out += sizeof block;
    memcpy(out, view->camera, sizeof *view->camera); /* the block says where it is only beside voxels, cone or marks */
    out += sizeof *view->camera;
    memcpy(out, &draft, sizeof draft);
    out += sizeof draft;
    memcpy(out, pass->shown, 4 * count * sizeof *pass->shown);
    memcpy(out + 4 * count * sizeof *pass->shown, pass->opacity, count * sizeof *pass->opacity);
}

static bool shows_context(const struct colour_pass *pass, const struct colour_view *view)
{
    return pass->may_have_context && view->fade < 1;
}

conus_status colour_program_create(GLuint *out, const struct program_shader *vertex, enum colour_program kind,
                                   const struct colour_pass *pass, bool has_context)
{
    const struct program_define defines[] = {{"MARKER_LIMIT", COLOUR_MARKER_LIMIT},
                                             {"TRANSFER_ENTRIES", COLOUR_TABLE_ENTRIES},
                                             {"FIELD_SURFACE", FIELD_SURFACE},
                                             {"PLAIN_AREAS", kind == COLOUR_RAYS_PLAIN || kind == COLOUR_SLICES},
                                             {"SLICES", kind == COLOUR_SLICES},
                                             {"TILE", COLOUR_TILE},
                                             {"TILE_BUFFER", TILE_BUFFER},
                                             {"LOOK_GLASS_EDGE", LOOK_GLASS_EDGE},
                                             {"LOOK_MARKER_EDGE", LOOK_MARKER_EDGE},
                                             {"TRANSLUCENT", kind == COLOUR_LAYERS},
                                             {"AREAS", !pass || pass->may_have_areas},
                                             {"CONTEXT", has_context},
                                             {"HAZE", !pass || pass->hazy.transfers}};
    const struct program_shader more = {"colour_layers.glsl", shader_colour_layers};
    const struct program_source source = {.vertex = *vertex,
                                          .fragment = {"colour.frag.glsl", shader_colour_frag},
                                          .more = kind == COLOUR_LAYERS ? more : (struct program_shader){0},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof *defines};
    return program_create(out, &source);
}

static conus_status need_program(struct colour_gl *gl, const struct colour_pass *pass, bool layers, bool has_context)
{
    static const struct program_shader screen = {.file = "screen.vert.glsl", .text = shader_screen_vert};
    GLuint *program = &gl->programs[layers][has_context];
    return *program ? CONUS_OK
                    : colour_program_create(program, &screen, layers ? COLOUR_LAYERS : COLOUR_RAYS, pass, has_context);
}

static conus_status prepare(struct colour_device *device, const struct colour_pass *pass)
{
    struct colour_gl *gl = (struct colour_gl *)device;
    const GLsizeiptr count = (GLsizeiptr)(1 + pass->object_count + pass->around_count);
    glCreateBuffers(1, &gl->palette);
    glNamedBufferData(gl->palette, count * 4 * (GLsizeiptr)sizeof *pass->colours, NULL, GL_DYNAMIC_DRAW);
    glCreateBuffers(1, &gl->opacities);
    glNamedBufferData(gl->opacities, count * (GLsizeiptr)sizeof *pass->opacity, NULL, GL_DYNAMIC_DRAW);
    glCreateBuffers(1, &gl->view);
    glNamedBufferData(gl->view, sizeof(struct colour_view_block), NULL, GL_DYNAMIC_DRAW);
    glCreateVertexArrays(1, &gl->vertices);
    gl->looks[0] = memory_zeroed(2, look_size(pass));
    gl->looks[1] = gl->looks[0] ? gl->looks[0] + look_size(pass) : NULL;
    return gl->looks[0] ? gl_check("colour pass") : CONUS_ERROR_MEMORY;
}

static conus_status add_meshes(struct colour_device *device, const conus_atlas *atlas, uint64_t *memory_left)
{
    return mesh_layer_create(&((struct colour_gl *)device)->meshes, atlas, memory_left);
}

static conus_status paint(struct colour_device *device, const conus_atlas *atlas,
                          const struct tube_colouring *colouring, const bool *const *is_pale)
{
    ((struct colour_gl *)device)->is_plain = false;
    return mesh_layer_update(((struct colour_gl *)device)->meshes, atlas, colouring, is_pale);
}

void colour_gl_prepare(const struct colour_pass *pass, const struct colour_view *view)
{
    const struct colour_gl *gl = gl_of(pass);
    const struct mesh_layer *meshes = gl->meshes;
    const struct mesh_layer_peels peels = meshes ? mesh_layer_peels(meshes) : (struct mesh_layer_peels){0};
    const bool layers = colour_pass_has_layers(pass, view);
    const GLsizeiptr count = (GLsizeiptr)(1 + pass->object_count + pass->around_count);
    struct colour_view_block block = {0};
    colour_view_pack(&block, pass, view);
    block.counts[1] = meshes ? 1 : 0;
    block.counts[2] = (int32_t)peels.count;
    block.counts[3] = gl->tiles ? 1 : 0;
    colour_pass_look(pass, view);
    glNamedBufferSubData(gl->view, 0, sizeof block, &block);
    glNamedBufferSubData(gl->palette, 0, count * 4 * (GLsizeiptr)sizeof *pass->shown, pass->shown);
    if (layers) {
        glNamedBufferSubData(gl->opacities, 0, count * (GLsizeiptr)sizeof *pass->opacity, pass->opacity);
    }
    const GLuint textures[] = {pass->context.field.name,
                               pass->context.empty.name,
                               pass->transfer.name,
                               pass->areas.field.name,
                               pass->areas.empty.name,
                               pass->objects.name,
                               meshes ? mesh_layer_surface(meshes) : 0,
                               meshes ? mesh_layer_object(meshes) : 0,
                               pass->haze.field.name,
                               peels.surface,
                               peels.object};
    glBindTextures(0, sizeof textures / sizeof *textures, textures);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, gl->view);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, gl->palette);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, TILE_BUFFER, gl->tiles ? gl->tiles : gl->palette); /* any, not read */
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, gl->opacities);
    glBindVertexArray(gl->vertices);
    glUseProgram(gl->programs[layers][shows_context(pass, view)]);
}

conus_status colour_gl_draw(const struct colour_pass *pass, const struct colour_view *view)
{
    conus_status status =
        need_program(gl_of(pass), pass, colour_pass_has_layers(pass, view), shows_context(pass, view));
    if (status) {
        return status;
    }
    colour_gl_prepare(pass, view);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return gl_check("colour pass");
}

/* Draws the meshes into textures of their own, which the rays then find. */
static conus_status draw_meshes(struct mesh_layer *meshes, const struct colour_pass *pass,
                                const struct colour_view *view)
{
    colour_pass_look(pass, view);
    const struct mesh_layer_view layer = {.camera = view->camera,
                                          .width = view->width,
                                          .height = view->height,
                                          .shift = {view->shift[0], view->shift[1]},
                                          .opacity = colour_pass_has_layers(pass, view) ? pass->opacity : NULL,
                                          .draft = view->draft,
                                          .listener = view->listener};
    return meshes ? mesh_layer_draw(meshes, &layer) : CONUS_OK;
}

/* Draws into `target`: over what is there where only tiles are drawn, by that part of all rays. */
static conus_status draw_rays(struct colour_gl *gl, const struct target *target, const struct colour_pass *pass,
                              const struct colour_view *view, float part)
{
    conus_status status = draw_meshes(gl->meshes, pass, view);
    if (status) {
        return status;
    }
    target_bind(target);
    if (gl->tiles) {
        glEnable(GL_BLEND);
        glBlendColor(0, 0, 0, part);
        glBlendFunc(GL_CONSTANT_ALPHA, GL_ONE);
    }
    status = colour_gl_draw(pass, view);
    glDisable(GL_BLEND);
    return status;
}

static conus_status resize_target(struct target *target, const struct colour_view *view)
{
    static const struct target_attachment colour = {"colour", TARGET_FLOAT4};
    if (target->width == view->width && target->height == view->height) {
        return CONUS_OK;
    }
    target_finish(target);
    return target_init(target, view->width, view->height, &colour, 1);
}

static conus_status draw_tiles(void *user, float *drawn, const uint32_t *tiles, const struct colour_view *view,
                               const struct colour_edges *edges)
{
    const struct colour_pass *pass = user;
    struct colour_gl *gl = gl_of(pass);
    struct target target = {0};
    conus_status status = resize_target(&target, view);
    if (status) {
        return status;
    }
    glCreateBuffers(1, &gl->tiles);
    glNamedBufferData(gl->tiles, (GLsizeiptr)(edges_across(view->width) * edges_across(view->height) * sizeof *tiles),
                      tiles, GL_STREAM_DRAW);
    target_clear(&target);
    for (size_t n = 0; n < edges->count && !status; n++) {
        struct colour_view shifted = *view;
        memcpy(shifted.shift, edges->shifts[n], sizeof shifted.shift);
        status = gl_tell(&view->listener, n, edges->count);
        status = status ? status : draw_rays(gl, &target, pass, &shifted, 1.0F / (float)edges->count);
    }
    glDeleteBuffers(1, &gl->tiles);
    gl->tiles = 0;
    status = status ? status : target_read(&target, "colour", drawn);
    target_finish(&target);
    return status;
}

/* Draws one ray a pixel, unless that is what the target has: a picture that becomes smooth was drawn plain before. */
static conus_status draw_plain(struct colour_gl *gl, const struct colour_pass *pass, const struct colour_view *view)
{
    put_look(gl->looks[1], pass, view);
    if (gl->is_plain && memcmp(gl->looks[0], gl->looks[1], look_size(pass)) == 0) {
        return CONUS_OK;
    }
    memcpy(gl->looks[0], gl->looks[1], look_size(pass));
    target_clear(&gl->target);
    return draw_rays(gl, &gl->target, pass, view, 1);
}

static conus_status draw(float *rgba, struct colour_device *device, const struct colour_pass *pass,
                         const struct colour_view *view, const struct colour_edges *edges)
{
    struct colour_gl *gl = (struct colour_gl *)device;
    conus_status status = resize_target(&gl->target, view);
    if (status) {
        gl->is_plain = false;
        return status;
    }
    status = draw_plain(gl, pass, view);
    gl->is_plain = !status;
    status = status ? status : target_read(&gl->target, "colour", rgba);
    return status || !edges ? status : edges_smooth(rgba, view, edges, draw_tiles, (void *)pass);
}

static const char *name(const struct colour_device *device)
{
    return gl_context_renderer(colour_gl_context(device));
}

static void destroy(struct colour_device *device)
{
    struct colour_gl *gl = (struct colour_gl *)device;
    if (gl->view && !enter(device)) { /* otherwise there may be no GL at all */
        const GLuint buffers[] = {gl->view, gl->palette, gl->opacities};
        mesh_layer_destroy(gl->meshes);
        target_finish(&gl->target);
        glDeleteBuffers(sizeof buffers / sizeof *buffers, buffers);
        glDeleteVertexArrays(1, &gl->vertices);
        for (int n = 0; n < 4; n++) {
            glDeleteProgram(gl->programs[n / 2][n % 2]);
        }
        leave(device);
    }
    gl_context_destroy(gl->context);
    memory_free(gl->looks[0]);
    memory_free(gl);
}

conus_status colour_gl_create(struct colour_device **out, conus_log log, void *log_user)
{
    static const struct colour_functions functions = {.enter = enter,
                                                      .leave = leave,
                                                      .hold = hold,
                                                      .fill = fill,
                                                      .release = release,
                                                      .check = gl_check,
                                                      .prepare = prepare,
                                                      .add_meshes = add_meshes,
                                                      .paint = paint,
                                                      .draw = draw,
                                                      .name = name,
                                                      .destroy = destroy};
    struct colour_gl *gl = memory_zeroed(1, sizeof *gl);
    conus_status status = gl ? gl_context_create(&gl->context, log, log_user) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(gl);
        return status;
    }
    gl->device.functions = &functions;
    *out = &gl->device;
    return CONUS_OK;
}

struct gl_context *colour_gl_context(const struct colour_device *device)
{
    return ((const struct colour_gl *)device)->context;
}
