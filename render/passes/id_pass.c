/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads volumes for the ID pass, draws its rays and reads the results. */
#include "render/passes/id_pass.h"

#include "base/memory.h"
#include "render/gl/gl.h"

#include <assert.h>
#include <string.h>

enum { OBJECTS_UNIT, DISTANCE_UNIT, IDENTIFIER_UNIT, RAY_UNIT };
enum { OUT_BUFFER };
enum { BOX, RANGE = BOX + 2 }; /* locations of uniforms */
enum { FIRST_INTERVALS = 1024, RAY_TEXELS = sizeof(struct id_ray) / 16 };
enum { TILE_WIDTH = 4, TILE_HEIGHT = 2, LONGEST_ROW = 64 }; /* fragments */

enum { IDENTIFIERS, RAYS, HITS, BUFFER_COUNT };

/* Kinds of programs: the first contact of a ray, or all layers. */
enum id_kind { FIRST, PIERCE, KIND_COUNT };

struct id_volume {
    GLuint objects, distances; /* none with slices */
    int box[2][3];
    size_t dim[3];
};

struct id_pass {
    conus_sampling sampling;
    GLuint programs[KIND_COUNT]; /* made when first needed */
    GLuint buffers[BUFFER_COUNT];
    GLuint identifiers, ray_texels; /* through which shaders see the first two */
    struct shader_list intervals;   /* of struct id_interval */
    struct id_volume *volumes;
    size_t volume_count;
    size_t volumes_traced; /* since id_pass_begin() */
    uint32_t ray_count;
    uint32_t capacity;        /* rays */
    struct target target;     /* without pixels: results go to the buffer */
    GLuint vertices;          /* none */
    struct id_ray *rays;      /* NULL until they are asked for */
    struct readback readback; /* of hits */
};

/* Creates a program unless it is there. */
static conus_status need_program(struct id_pass *pass, enum id_kind kind)
{
    const struct program_define defines[] = {{"SLICES", pass->sampling == CONUS_SAMPLING_SLICES},
                                             {"PIERCE", kind == PIERCE},
                                             {"OBJECTS_UNIT", OBJECTS_UNIT},
                                             {"DISTANCE_UNIT", DISTANCE_UNIT},
                                             {"IDENTIFIER_UNIT", IDENTIFIER_UNIT},
                                             {"RAY_UNIT", RAY_UNIT},
                                             {"OUT_BUFFER", OUT_BUFFER}};
    const struct program_source source = {.vertex = {"screen.vert.glsl", shader_screen_vert},
                                          .fragment = {"id.frag.glsl", shader_id_frag},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof defines[0]};
    return pass->programs[kind] ? CONUS_OK : program_create(&pass->programs[kind], &source);
}

conus_status id_pass_create(struct id_pass **out, conus_sampling sampling, const uint32_t *identifiers,
                            size_t identifier_count)
{
    static_assert(sizeof(struct id_ray) == 80 && sizeof(struct id_hit) == 24, "the shader's structs");
    struct id_pass *pass = memory_zeroed(1, sizeof *pass);
    if (!pass) {
        return CONUS_ERROR_MEMORY;
    }
    pass->sampling = sampling;
    conus_status status = need_program(pass, FIRST);
    if (!status) {
        glCreateBuffers(BUFFER_COUNT, pass->buffers);
        glNamedBufferStorage(pass->buffers[IDENTIFIERS], (GLsizeiptr)(identifier_count * sizeof *identifiers),
                             identifiers, 0);
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &pass->identifiers);
        glTextureBuffer(pass->identifiers, GL_R32UI, pass->buffers[IDENTIFIERS]);
        glCreateTextures(GL_TEXTURE_BUFFER, 1, &pass->ray_texels);
        glCreateVertexArrays(1, &pass->vertices);
        status = gl_check("identifiers");
    }
    if (status) {
        id_pass_destroy(pass);
        return status;
    }
    *out = pass;
    return CONUS_OK;
}

void id_pass_destroy(struct id_pass *pass)
{
    if (!pass) {
        return;
    }
    memory_free(pass->rays);
    for (size_t i = 0; i < pass->volume_count; i++) {
        glDeleteTextures(1, &pass->volumes[i].objects);
        glDeleteTextures(1, &pass->volumes[i].distances);
    }
    memory_free(pass->volumes);
    glDeleteTextures(1, &pass->identifiers);
    glDeleteTextures(1, &pass->ray_texels);
    glDeleteBuffers(BUFFER_COUNT, pass->buffers);
    glDeleteVertexArrays(1, &pass->vertices);
    target_finish(&pass->target);
    for (int kind = 0; kind < KIND_COUNT; kind++) {
        glDeleteProgram(pass->programs[kind]);
    }
    shader_list_finish(&pass->intervals);
    readback_finish(&pass->readback);
    memory_free(pass);
}

conus_status id_pass_add_volume(struct id_pass *pass, const struct volume *volume, const struct id_distances *distances,
                                uint64_t *memory_left)
{
    struct id_volume *volumes = memory_resize(pass->volumes, pass->volume_count + 1, sizeof *volumes);
    if (!volumes) {
        return CONUS_ERROR_MEMORY;
    }
    pass->volumes = volumes;
    struct id_volume made = {0};
    const size_t *dim = volume->info.dim;
    enum volume_texture_kind kind = volume->objects16 ? VOLUME_TEXTURE_UINT16 : VOLUME_TEXTURE_UINT32;
    const void *objects = volume->objects16 ? (const void *)volume->objects16 : volume->objects32;
    conus_status status = volume_texture_create(&made.objects, kind, dim, objects, memory_left);
    if (!status && pass->sampling == CONUS_SAMPLING_EXACT) {
        status = volume_texture_create(&made.distances, VOLUME_TEXTURE_UINT8, dim, distances->codes, memory_left);
        memcpy(made.box, distances->box, sizeof made.box);
    }
    if (status) {
        glDeleteTextures(1, &made.objects);
        return status;
    }
    memcpy(made.dim, dim, sizeof made.dim);
    volumes[pass->volume_count++] = made;
    return CONUS_OK;
}

static conus_status reserve_rays(struct id_pass *pass, uint32_t rays)
{
    GLint limit = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &limit);
    if (rays > (uint32_t)limit / RAY_TEXELS) {
        return fail(CONUS_ERROR_GL, "%u rays at once: this OpenGL driver allows %d", rays, limit / RAY_TEXELS);
    }
    memory_free(pass->rays);
    pass->rays = NULL;
    glNamedBufferData(pass->buffers[RAYS], (GLsizeiptr)(rays * sizeof(struct id_ray)), NULL, GL_DYNAMIC_COPY);
    glNamedBufferData(pass->buffers[HITS], (GLsizeiptr)(rays * sizeof(struct id_hit)), NULL, GL_DYNAMIC_COPY);
    glTextureBuffer(pass->ray_texels, GL_RGBA32UI, pass->buffers[RAYS]);
    conus_status status = gl_check("rays");
    pass->capacity = status ? 0 : rays;
    return status;
}

conus_status id_pass_begin(struct id_pass *pass, uint32_t rays)
{
    conus_status status = rays > pass->capacity ? reserve_rays(pass, rays) : CONUS_OK;
    pass->ray_count = status ? 0 : rays;
    pass->volumes_traced = 0;
    return status;
}

struct id_ray *id_pass_rays(struct id_pass *pass)
{
    pass->rays = pass->rays ? pass->rays : memory_raw(pass->capacity, sizeof *pass->rays);
    return pass->rays;
}

static void upload_rays(const struct id_pass *pass)
{
    glNamedBufferSubData(pass->buffers[RAYS], 0, (GLsizeiptr)(pass->ray_count * sizeof *pass->rays), pass->rays);
}

/* A target with a fragment for each of so many rays, in as few rows as there may be: a driver's threads share rows. */
static conus_status need_target(struct id_pass *pass, uint32_t rays)
{
    const uint32_t tiles = (rays - 1) / (TILE_WIDTH * TILE_HEIGHT) + 1;
    const uint32_t across = tiles < LONGEST_ROW / TILE_WIDTH ? tiles : LONGEST_ROW / TILE_WIDTH;
    const uint32_t width = across * TILE_WIDTH;
    const uint32_t height = ((tiles - 1) / across + 1) * TILE_HEIGHT;
    if (pass->target.width == width && pass->target.height == height) {
        return CONUS_OK;
    }
    target_finish(&pass->target);
    return target_init(&pass->target, width, height, NULL, 0);
}

/* Walks rays number `first` to `end` - 1 through a volume. */
static conus_status draw(struct id_pass *pass, enum id_kind kind, size_t volume, uint32_t first, uint32_t end)
{
    const struct id_volume *drawn = &pass->volumes[volume];
    const GLuint textures[] = {drawn->objects, drawn->distances, pass->identifiers, pass->ray_texels};
    conus_status status = need_target(pass, end - first);
    if (status) {
        return status;
    }
    target_bind(&pass->target);
    glBindVertexArray(pass->vertices);
    glUseProgram(pass->programs[kind]);
    glBindTextures(0, RAY_UNIT + 1, textures);
    if (pass->sampling == CONUS_SAMPLING_EXACT) {
        glUniform3iv(BOX, 2, drawn->box[0]);
    }
    glUniform4i(RANGE, (GLint)first, (GLint)end, pass->volumes_traced > 0, (GLint)pass->target.width);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    return gl_check("ID pass");
}

conus_status id_pass_trace(struct id_pass *pass, size_t volume)
{
    assert(volume < pass->volume_count && pass->ray_count);
    upload_rays(pass);
    if (pass->volumes_traced) {
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT); /* earlier hits are read now */
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, OUT_BUFFER, pass->buffers[HITS]);
    conus_status status = draw(pass, FIRST, volume, 0, pass->ray_count);
    pass->volumes_traced++;
    return status;
}

conus_status id_pass_read(struct id_pass *pass, const struct id_hit **out)
{
    assert(pass->volumes_traced);
    struct readback_part part = {pass->buffers[HITS], pass->ray_count * sizeof(struct id_hit), NULL};
    conus_status status = readback_wait(&pass->readback, &part, 1, "reading the ID pass");
    if (!status) {
        *out = part.data;
    }
    return status;
}

conus_status id_pass_pierce(struct id_pass *pass, size_t volume, id_pass_take take, void *user)
{
    assert(volume < pass->volume_count && pass->ray_count && pass->sampling == CONUS_SAMPLING_EXACT);
    static_assert(sizeof(struct id_interval) == 40, "the shader's Interval");
    const size_t *dim = pass->volumes[volume].dim;
    struct shader_list *list = &pass->intervals;
    conus_status status = need_program(pass, PIERCE);
    if (!status && !list->buffer) {
        status = shader_list_init(list, sizeof(struct id_interval), FIRST_INTERVALS);
    }
    if (status) {
        return status;
    }
    upload_rays(pass);
    shader_list_begin(list, pass->ray_count, (uint32_t)(dim[0] + dim[1] + dim[2])); /* cells of any ray */
    while (!status && shader_list_next(list, OUT_BUFFER)) {
        const void *records = NULL;
        uint32_t count = 0;
        status = draw(pass, PIERCE, volume, list->first, list->end);
        status = status ? status : shader_list_read(list, &records, &count);
        status = status ? status : take(user, records, count);
    }
    return status;
}
