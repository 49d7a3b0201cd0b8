/* SPDX-License-Identifier: BSD-3-Clause */
#include "render/id_pass.h"

#include "base/memory.h"
#include "render/bricks.h"
#include "render/context.h"
#include "render/program.h"
#include "render/shader_list.h"
#include "render/shaders.h"
#include "render/target.h"
#include "render/volume_texture.h"

#include <assert.h>
#include <string.h>

enum { OBJECTS_UNIT, BRICKS_UNIT, NEAREST_ID_UNIT, NEAREST_T_UNIT };
enum { IDENTIFIER_BUFFER, RAY_BUFFER, PIECE_BUFFER };
enum { BRICK_SHIFT = 2, RAY_DOUBLES = sizeof(struct id_ray) / sizeof(double) };
enum { RAY_BUFFER_SIZE = 1 << 24 }; /* where one volume's rays need no more */
enum { FIRST_PIECES = 1024 };

/* What a program does with a ray: the first contact, also if it is nearer than what is there, or all layers. */
enum id_kind { FIRST, LATER, PIERCE, KIND_COUNT };

struct id_program {
    GLuint program;
    GLint resolution, first_ray;
    GLint slice_count, slice_start, slice_spacing; /* of slices only */
    GLint pixels;                                  /* of PIERCE only */
};

struct id_volume {
    GLuint objects, bricks;
    size_t dim[3];
};

struct id_pass {
    conus_sampling sampling;
    struct id_program programs[KIND_COUNT]; /* made when they are needed for the first time */
    GLuint vertices;                        /* an empty vertex array */
    GLuint identifier_buffer, ray_buffer;
    struct target target;
    struct target blank;       /* as large, without pixels: what pierces writes to the list */
    struct shader_list pieces; /* of struct id_piece */
    struct id_volume *volumes;
    size_t volume_count;
    size_t drawn; /* volumes since id_pass_begin() */
    size_t room;  /* ray_buffer holds the rays of so many volumes, from 1 */
    struct id_ray *rays;
    uint32_t *identifiers;
    float (*voxels)[4];
    double *distances;
};

static conus_status create_program(struct id_program *out, conus_sampling sampling, enum id_kind kind)
{
    bool slices = sampling == CONUS_SLICES;
    const struct program_define defines[] = {
        {"SLICES", slices},
        {"MERGE", kind == LATER},
        {"PIERCE", kind == PIERCE},
        {"BRICK_SHIFT", BRICK_SHIFT},
        {"RAY_DOUBLES", RAY_DOUBLES},
        {"OBJECTS_UNIT", OBJECTS_UNIT},
        {"BRICKS_UNIT", BRICKS_UNIT},
        {"NEAREST_ID_UNIT", NEAREST_ID_UNIT},
        {"NEAREST_T_UNIT", NEAREST_T_UNIT},
        {"IDENTIFIER_BUFFER", IDENTIFIER_BUFFER},
        {"RAY_BUFFER", RAY_BUFFER},
        {"PIECE_BUFFER", PIECE_BUFFER},
    };
    const struct program_source source = {.vertex = {"screen.vert.glsl", shader_screen_vert},
                                          .fragment = {"id.frag.glsl", shader_id_frag},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof defines[0]};
    struct id_program program = {0};
    conus_status status = program_create(&program.program, &source);
    if (status) {
        return status;
    }
    program.resolution = program_uniform(program.program, "resolution");
    program.first_ray = program_uniform(program.program, "first_ray");
    if (slices) {
        program.slice_count = program_uniform(program.program, "slice_count");
        program.slice_start = program_uniform(program.program, "slice_start");
        program.slice_spacing = program_uniform(program.program, "slice_spacing");
    }
    if (kind == PIERCE) {
        program.pixels = program_uniform(program.program, "pixels");
    }
    *out = program;
    return CONUS_OK;
}

static conus_status need_program(struct id_pass *pass, enum id_kind kind)
{
    struct id_program *program = &pass->programs[kind];
    return program->program ? CONUS_OK : create_program(program, pass->sampling, kind);
}

conus_status id_pass_create(struct id_pass **out, conus_sampling sampling, const uint32_t *identifiers,
                            size_t identifier_count)
{
    static_assert(1 << BRICK_SHIFT == BRICKS_EDGE, "the shader's bricks are those of bricks.h");
    struct id_pass *pass = memory_zeroed(1, sizeof *pass);
    if (!pass) {
        return CONUS_ERROR_MEMORY;
    }
    pass->sampling = sampling;
    conus_status status = need_program(pass, FIRST);
    if (!status) {
        glCreateVertexArrays(1, &pass->vertices);
        glCreateBuffers(1, &pass->ray_buffer);
        glCreateBuffers(1, &pass->identifier_buffer);
        glNamedBufferStorage(pass->identifier_buffer, (GLsizeiptr)(identifier_count * sizeof *identifiers), identifiers,
                             0);
        status = gl_check("identifiers");
    }
    if (status) {
        id_pass_destroy(pass);
        return status;
    }
    *out = pass;
    return CONUS_OK;
}

static void finish_pixels(struct id_pass *pass)
{
    target_finish(&pass->target);
    target_finish(&pass->blank);
    memory_free(pass->rays);
    memory_free(pass->identifiers);
    memory_free(pass->voxels);
    memory_free(pass->distances);
    pass->rays = NULL;
    pass->identifiers = NULL;
    pass->voxels = NULL;
    pass->distances = NULL;
}

void id_pass_destroy(struct id_pass *pass)
{
    if (!pass) {
        return;
    }
    finish_pixels(pass);
    for (size_t i = 0; i < pass->volume_count; i++) {
        glDeleteTextures(1, &pass->volumes[i].objects);
        glDeleteTextures(1, &pass->volumes[i].bricks);
    }
    memory_free(pass->volumes);
    glDeleteBuffers(1, &pass->identifier_buffer);
    glDeleteBuffers(1, &pass->ray_buffer);
    glDeleteVertexArrays(1, &pass->vertices);
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        glDeleteProgram(pass->programs[kind].program);
    }
    shader_list_finish(&pass->pieces);
    memory_free(pass);
}

/* ---- Volumes ------------------------------------------------------------------------------------------------ */

static conus_status upload(struct id_volume *out, const struct volume *volume, uint64_t *memory_left)
{
    struct id_volume textures = {0};
    struct bricks bricks = {0};
    enum volume_texture_kind kind = volume->objects16 ? VOLUME_TEXTURE_UINT16 : VOLUME_TEXTURE_UINT32;
    const void *objects = volume->objects16 ? (const void *)volume->objects16 : volume->objects32;
    conus_status status = volume_texture_create(&textures.objects, kind, volume->info.dim, objects, memory_left);
    if (!status) {
        status = bricks_init(&bricks, volume);
    }
    if (!status) {
        status =
            volume_texture_create(&textures.bricks, VOLUME_TEXTURE_UINT8, bricks.dim, bricks.distance, memory_left);
    }
    bricks_finish(&bricks);
    if (status) {
        glDeleteTextures(1, &textures.objects);
        return status;
    }
    memcpy(textures.dim, volume->info.dim, sizeof textures.dim);
    *out = textures;
    return CONUS_OK;
}

conus_status id_pass_add_volume(struct id_pass *pass, const struct volume *volume, uint64_t *memory_left)
{
    struct id_volume *volumes = memory_resize(pass->volumes, pass->volume_count + 1, sizeof *volumes);
    if (!volumes) {
        return CONUS_ERROR_MEMORY;
    }
    pass->volumes = volumes;
    conus_status status = CONUS_OK;
    if (pass->volume_count == 1) {
        status = need_program(pass, LATER);
    }
    if (!status) {
        status = upload(&volumes[pass->volume_count], volume, memory_left);
    }
    pass->volume_count += !status;
    return status;
}

/* ---- A look ------------------------------------------------------------------------------------------------- */

static conus_status init_pixels(struct id_pass *pass, uint32_t resolution)
{
    static const struct target_attachment attachments[] = {
        {"identifier", TARGET_UINT}, {"voxel", TARGET_FLOAT4}, {"distance", TARGET_UINT2}};
    size_t pixels = (size_t)resolution * resolution;
    finish_pixels(pass);
    pass->rays = memory_raw(pixels, sizeof *pass->rays);
    pass->identifiers = memory_raw(pixels, sizeof *pass->identifiers);
    pass->voxels = memory_raw(pixels, sizeof *pass->voxels);
    pass->distances = memory_raw(pixels, sizeof *pass->distances);
    if (!pass->rays || !pass->identifiers || !pass->voxels || !pass->distances) {
        return CONUS_ERROR_MEMORY;
    }
    size_t size = pixels * sizeof *pass->rays;
    pass->room = pass->volume_count * size <= RAY_BUFFER_SIZE ? pass->volume_count : RAY_BUFFER_SIZE / size + 1;
    glNamedBufferData(pass->ray_buffer, (GLsizeiptr)(pass->room * size), NULL, GL_STREAM_DRAW);
    conus_status status = gl_check("rays");
    status = status ? status : target_init(&pass->blank, resolution, resolution, NULL, 0);
    return status ? status : target_init(&pass->target, resolution, resolution, attachments, 3);
}

conus_status id_pass_begin(struct id_pass *pass, uint32_t resolution)
{
    if (pass->target.width != resolution) {
        conus_status status = init_pixels(pass, resolution);
        if (status) {
            finish_pixels(pass);
            return status;
        }
    }
    target_clear(&pass->target);
    pass->drawn = 0;
    return CONUS_OK;
}

struct id_ray *id_pass_rays(struct id_pass *pass)
{
    return pass->rays;
}

static void bind_inputs(const struct id_pass *pass, const struct id_volume *volume)
{
    glBindTextureUnit(OBJECTS_UNIT, volume->objects);
    glBindTextureUnit(BRICKS_UNIT, volume->bricks);
    glBindTextureUnit(NEAREST_ID_UNIT, pass->drawn == 0 ? 0 : target_texture(&pass->target, "identifier"));
    glBindTextureUnit(NEAREST_T_UNIT, pass->drawn == 0 ? 0 : target_texture(&pass->target, "distance"));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, IDENTIFIER_BUFFER, pass->identifier_buffer);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RAY_BUFFER, pass->ray_buffer);
}

/* Uploads the rays and returns the number of the first. Each draw has a place of its own: Mesa 22.3's llvmpipe lets a
 * write overtake the draws that still read the buffer. */
static GLint upload_rays(struct id_pass *pass)
{
    size_t pixels = (size_t)pass->target.width * pass->target.height;
    size_t place = pass->drawn % pass->room;
    if (pass->drawn && place == 0) {
        glFinish();
    }
    glNamedBufferSubData(pass->ray_buffer, (GLintptr)(place * pixels * sizeof *pass->rays),
                         (GLsizeiptr)(pixels * sizeof *pass->rays), pass->rays);
    return (GLint)(place * pixels);
}

conus_status id_pass_draw(struct id_pass *pass, size_t volume, const struct slices *slices)
{
    assert(volume < pass->volume_count && pass->rays);
    if (pass->sampling == CONUS_SLICES && slices->count == 0) {
        return CONUS_OK;
    }
    const struct id_program *program = &pass->programs[pass->drawn == 0 ? FIRST : LATER];
    GLint first_ray = upload_rays(pass);
    if (pass->drawn) {
        glTextureBarrier(); /* the pixels drawn before are now read */
    }
    bind_inputs(pass, &pass->volumes[volume]);
    target_bind(&pass->target);
    glBindVertexArray(pass->vertices);
    glUseProgram(program->program);
    glUniform1i(program->resolution, (GLint)pass->target.width);
    glUniform1i(program->first_ray, first_ray);
    if (pass->sampling == CONUS_SLICES) {
        glUniform1i(program->slice_count, (GLint)slices->count);
        glUniform1d(program->slice_start, slices->start);
        glUniform1d(program->slice_spacing, slices->spacing);
    }
    glDrawArrays(GL_TRIANGLES, 0, 3);
    pass->drawn++;
    return gl_check("ID pass");
}

/* The shader wrote a double as its low and high word. */
static void join_words(double *distances, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t words[2];
        memcpy(words, &distances[i], sizeof words);
        uint64_t bits = (uint64_t)words[1] << 32 | words[0];
        memcpy(&distances[i], &bits, sizeof bits);
    }
}

conus_status id_pass_read(struct id_pass *pass, struct id_pixels *out)
{
    conus_status status = target_read(&pass->target, "identifier", pass->identifiers);
    if (!status) {
        status = target_read(&pass->target, "voxel", pass->voxels);
    }
    if (!status) {
        status = target_read(&pass->target, "distance", pass->distances);
    }
    if (status) {
        return status;
    }
    join_words(pass->distances, (size_t)pass->target.width * pass->target.height);
    *out = (struct id_pixels){pass->identifiers, (const float(*)[4])pass->voxels, pass->distances};
    return CONUS_OK;
}

/* ---- All layers ----------------------------------------------------------------------------------------------- */

struct piercing {
    struct id_pass *pass;
    size_t volume;
    GLint first_ray;
    id_pass_take take;
    void *user;
};

static conus_status draw_pieces(void *user, uint32_t first, uint32_t end)
{
    const struct piercing *piercing = user;
    struct id_pass *pass = piercing->pass;
    const struct id_program *program = &pass->programs[PIERCE];
    bind_inputs(pass, &pass->volumes[piercing->volume]);
    target_bind(&pass->blank);
    glBindVertexArray(pass->vertices);
    glUseProgram(program->program);
    glUniform1i(program->resolution, (GLint)pass->blank.width);
    glUniform1i(program->first_ray, piercing->first_ray);
    glUniform2i(program->pixels, (GLint)first, (GLint)end);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return gl_check("ID pass of all layers");
}

static conus_status take_pieces(void *user, const void *records, uint32_t count)
{
    const struct piercing *piercing = user;
    return piercing->take(piercing->user, records, count);
}

conus_status id_pass_pierce(struct id_pass *pass, size_t volume, id_pass_take take, void *user)
{
    assert(volume < pass->volume_count && pass->rays && pass->sampling == CONUS_EXACT);
    static_assert(sizeof(struct id_piece) == 40, "the shader's Piece");
    struct piercing piercing = {pass, volume, 0, take, user};
    conus_status status = need_program(pass, PIERCE);
    if (!status && !pass->pieces.buffer) {
        status = shader_list_init(&pass->pieces, sizeof(struct id_piece), FIRST_PIECES);
    }
    if (status) {
        return status;
    }
    const size_t *dim = pass->volumes[volume].dim;
    const struct shader_list_job job = {.binding = PIECE_BUFFER,
                                        .draw = draw_pieces,
                                        .take = take_pieces,
                                        .user = &piercing,
                                        .pixels = pass->blank.width * pass->blank.height,
                                        .per_pixel = (uint32_t)(dim[0] + dim[1] + dim[2])}; /* cells of any ray */
    piercing.first_ray = upload_rays(pass);
    return shader_list_collect(&pass->pieces, &job);
}
