/* SPDX-License-Identifier: BSD-3-Clause */
/* Uploads volumes for the ID pass, runs its compute shader and reads the results. */
#include "render/id/id_pass.h"

#include "base/memory.h"
#include "render/gl/gl.h"
#include "render/gl/shaders.h"

#include <assert.h>
#include <string.h>

enum { RAY_UNIT = ID_IDENTIFIER_UNIT + 1 };
enum { OUT_BUFFER };
enum { BOX, RANGE = BOX + 2 }; /* locations of uniforms */
enum { GROUP = 64, FIRST_INTERVALS = 1024, RAY_TEXELS = sizeof(struct id_ray) / 16 };

enum { IDENTIFIERS, RAYS, HITS, BUFFER_COUNT };

/* Kinds of programs: the first contact of a ray, or all layers. */
enum id_kind { FIRST, PIERCE, KIND_COUNT };

struct id_volume {
    GLuint objects, distances; /* none with slices */
    int box[2][3];
    size_t dim[3];
    double index_from_world[16];
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
    uint32_t capacity; /* rays */
    bool has_device_rays;
    struct id_ray *rays;      /* NULL until they are asked for */
    struct readback readback; /* of hits */
};

/* Creates a program unless it is there. */
static conus_status need_program(struct id_pass *pass, enum id_kind kind)
{
    const struct program_define defines[] = {{"SLICES", pass->sampling == CONUS_SAMPLING_SLICES},
                                             {"PIERCE", kind == PIERCE},
                                             {"CONES", 0},
                                             {"GROUP", GROUP},
                                             {"ID_OBJECTS_UNIT", ID_OBJECTS_UNIT},
                                             {"ID_DISTANCE_UNIT", ID_DISTANCE_UNIT},
                                             {"ID_IDENTIFIER_UNIT", ID_IDENTIFIER_UNIT},
                                             {"RAY_UNIT", RAY_UNIT},
                                             {"OUT_BUFFER", OUT_BUFFER}};
    const struct program_source source = {.compute = {"id.comp.glsl", shader_id_comp},
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
    memcpy(made.index_from_world, volume->voxel_from_world, sizeof made.index_from_world);
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
    pass->has_device_rays = false;
    return status;
}

struct id_ray *id_pass_rays(struct id_pass *pass)
{
    pass->rays = pass->rays ? pass->rays : memory_raw(pass->capacity, sizeof *pass->rays);
    return pass->rays;
}

size_t id_pass_volume_count(const struct id_pass *pass)
{
    return pass->volume_count;
}

const double *id_pass_index_from_world(const struct id_pass *pass, size_t volume)
{
    return pass->volumes[volume].index_from_world;
}

GLuint id_pass_device_rays(struct id_pass *pass)
{
    pass->has_device_rays = true;
    return pass->buffers[RAYS];
}

static void upload_rays(const struct id_pass *pass)
{
    if (!pass->has_device_rays) {
        glNamedBufferSubData(pass->buffers[RAYS], 0, (GLsizeiptr)(pass->ray_count * sizeof *pass->rays), pass->rays);
    }
}

void id_pass_bind(const struct id_pass *pass, size_t volume)
{
    const struct id_volume *bound = &pass->volumes[volume];
    assert(volume < pass->volume_count);
    glBindTextureUnit(ID_OBJECTS_UNIT, bound->objects);
    glBindTextureUnit(ID_DISTANCE_UNIT, bound->distances);
    glBindTextureUnit(ID_IDENTIFIER_UNIT, pass->identifiers);
    if (pass->sampling == CONUS_SAMPLING_EXACT) {
        glUniform3iv(BOX, 2, bound->box[0]);
    }
}

/* Walks rays number `first` to `end` - 1 through a volume. */
static void dispatch(const struct id_pass *pass, enum id_kind kind, size_t volume, uint32_t first, uint32_t end)
{
    glUseProgram(pass->programs[kind]);
    id_pass_bind(pass, volume);
    glBindTextureUnit(RAY_UNIT, pass->ray_texels);
    glUniform3i(RANGE, (GLint)first, (GLint)end, pass->volumes_traced > 0);
    glDispatchCompute((end - first + GROUP - 1) / GROUP, 1, 1);
}

conus_status id_pass_trace(struct id_pass *pass, size_t volume)
{
    assert(volume < pass->volume_count && pass->ray_count);
    upload_rays(pass);
    if (pass->volumes_traced) {
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT); /* earlier hits are read now */
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, OUT_BUFFER, pass->buffers[HITS]);
    dispatch(pass, FIRST, volume, 0, pass->ray_count);
    pass->volumes_traced++;
    return gl_check("ID pass");
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
        dispatch(pass, PIERCE, volume, list->first, list->end);
        status = shader_list_read(list, &records, &count);
        status = status ? status : take(user, records, count);
    }
    return status;
}
