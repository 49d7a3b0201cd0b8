/* SPDX-License-Identifier: BSD-3-Clause */
/* Sends shapes and places of cones to the device, which makes rays of them, and takes the rows that it has counted. */
#include "render/id/id_pass.h"

#include "base/memory.h"
#include "render/gl/gl.h"
#include "render/gl/shaders.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Those up to VALUE_BUFFER are the places of blocks in shaders, too, of which OpenGL promises no more. */
enum {
    CONE_BUFFER,
    AIM_BUFFER,
    SPOT_BUFFER,
    GROUP_BUFFER,
    KNOWN_BUFFER,
    ROW_BUFFER,
    HEAD_BUFFER,
    VALUE_BUFFER,
    LISTED_AIM_BUFFER,
    LIST_BUFFER,
    BUFFER_COUNT
};
/* No rays are made and counted at once. */
enum { LIST_BLOCK = SPOT_BUFFER, RAY_BLOCK = VALUE_BUFFER };
enum {
    KNOWN_SIZE = 16,
    HEADS_BEFORE = 1, /* the first head is the number of rows */
    ROWS_OF_A_PART = 8,
    VALUES = 4096
};

/* Kinds of programs; made when first needed. */
enum kind { COUNT, MAKE, CHECK, KIND_COUNT };

/* Locations of uniforms, behind that of id_pass_bind(). */
enum { RAY_COUNT = 2, HAS_KNOWN, IS_LAST, INDEX_FROM_WORLD, LIST_COUNT };

struct cone_pass {
    struct id_pass *id_pass;
    GLuint programs[KIND_COUNT];
    GLuint buffers[BUFFER_COUNT];
    size_t sizes[BUFFER_COUNT]; /* bytes they have */
    uint32_t list_count;        /* rays that are listed, */
    uint32_t listed_rays;       /* and of each of their cones */
    size_t likely_rows;         /* of a part: as many are read before it is known how many there are */
    struct readback readback;
};

/* Makes a buffer at least so large. Its first `kept` bytes stay; where there are some, others are likely to follow. */
static void reserve(struct cone_pass *pass, int buffer, size_t kept, size_t size)
{
    if (size > pass->sizes[buffer]) {
        const GLuint old = pass->buffers[buffer];
        pass->sizes[buffer] = kept ? 2 * size : size;
        glCreateBuffers(1, &pass->buffers[buffer]);
        glNamedBufferData(pass->buffers[buffer], (GLsizeiptr)pass->sizes[buffer], NULL, GL_DYNAMIC_COPY);
        glCopyNamedBufferSubData(old, pass->buffers[buffer], 0, 0, (GLsizeiptr)kept);
        glDeleteBuffers(1, &old);
    }
}

/* Writes behind the first `kept` bytes. */
static void upload(struct cone_pass *pass, int buffer, size_t kept, const void *data, size_t size)
{
    reserve(pass, buffer, kept, kept + size);
    glNamedBufferSubData(pass->buffers[buffer], (GLintptr)kept, (GLsizeiptr)size, data);
}

static conus_status need_program(struct cone_pass *pass, enum kind kind)
{
    const struct program_define defines[] = {{"SLICES", 0},
                                             {"PIERCE", 0},
                                             {"CONES", 1},
                                             {"CHECK", kind == CHECK},
                                             {"MAKE", kind == MAKE},
                                             {"GROUP", CONE_PART},
                                             {"ID_OBJECTS_UNIT", ID_OBJECTS_UNIT},
                                             {"ID_DISTANCE_UNIT", ID_DISTANCE_UNIT},
                                             {"ID_IDENTIFIER_UNIT", ID_IDENTIFIER_UNIT},
                                             {"CONE_BUFFER", CONE_BUFFER},
                                             {"AIM_BUFFER", AIM_BUFFER},
                                             {"SPOT_BUFFER", SPOT_BUFFER},
                                             {"GROUP_BUFFER", GROUP_BUFFER},
                                             {"KNOWN_BUFFER", KNOWN_BUFFER},
                                             {"ROW_BUFFER", ROW_BUFFER},
                                             {"HEAD_BUFFER", HEAD_BUFFER},
                                             {"VALUE_BUFFER", VALUE_BUFFER},
                                             {"LIST_BUFFER", LIST_BLOCK},
                                             {"RAY_BUFFER", RAY_BLOCK}};
    const struct program_source source = {.compute = {"id.comp.glsl", shader_id_comp},
                                          .more = {"cones.comp.glsl", shader_cones_comp},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof defines[0]};
    return pass->programs[kind] ? CONUS_OK : program_create(&pass->programs[kind], &source);
}

/* Numbers whose inverses are hard to round: those of 2 - k 2^-52, with odd k, lie within k^2 2^-52 of half-way between
 * two doubles; and others of all sizes. */
static double hard_number(uint32_t i)
{
    double mantissa = i < VALUES / 2 ? 2 - (2 * i + 1) * 0x1p-52 : 1 + (i % 3 ? i * 0x1p-52 : i * 0x1.5a7c3p-13);
    return ldexp(i % 2 ? mantissa : -mantissa, (int)(i * 37 % 1761) - 880);
}

/* Whether the device inverts as the CPU does: then it keeps the order of operations that are `precise`, and rounds
 * each. */
static conus_status check_rounding(struct cone_pass *pass, bool *out)
{
    double values[VALUES];
    conus_status status = need_program(pass, CHECK);
    *out = true;
    if (!status) {
        for (uint32_t i = 0; i < VALUES; i++) {
            values[i] = hard_number(i);
        }
        upload(pass, VALUE_BUFFER, 0, values, sizeof values);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, VALUE_BUFFER, pass->buffers[VALUE_BUFFER]);
        glUseProgram(pass->programs[CHECK]);
        glDispatchCompute(VALUES / CONE_PART, 1, 1);
        struct readback_part made = {pass->buffers[VALUE_BUFFER], sizeof values, NULL};
        status = readback_wait(&pass->readback, &made, 1, "checking how numbers are rounded");
        for (uint32_t i = 0; i < VALUES && !status; i++) {
            *out = *out && ((const double *)made.data)[i] == 1 / values[i];
        }
    }
    return status;
}

conus_status cone_pass_create(struct cone_pass **out, struct id_pass *id_pass)
{
    static_assert(sizeof(struct cone_place) == 112 && sizeof(struct cone_aim) == 48 && sizeof(struct cone_spot) == 16 &&
                      sizeof(struct cone_row) == 48 && sizeof(struct cone_head) == 8,
                  "the shader's structs");
    bool rounds = false;
    struct cone_pass *pass = memory_zeroed(1, sizeof *pass);
    if (!pass) {
        return CONUS_ERROR_MEMORY;
    }
    pass->id_pass = id_pass;
    pass->likely_rows = ROWS_OF_A_PART;
    glCreateBuffers(BUFFER_COUNT, pass->buffers);
    reserve(pass, KNOWN_BUFFER, 0, KNOWN_SIZE); /* which one volume alone does not use */
    conus_status status = check_rounding(pass, &rounds);
    if (status || !rounds) {
        cone_pass_destroy(pass);
        pass = NULL;
    }
    *out = status ? *out : pass;
    return status;
}

void cone_pass_destroy(struct cone_pass *pass)
{
    if (pass) {
        for (int kind = 0; kind < KIND_COUNT; kind++) {
            glDeleteProgram(pass->programs[kind]);
        }
        glDeleteBuffers(BUFFER_COUNT, pass->buffers);
        readback_finish(&pass->readback);
        memory_free(pass);
    }
}

static uint32_t parts_of(uint32_t rays)
{
    return (rays + CONE_PART - 1) / CONE_PART;
}

conus_status cone_pass_set_groups(struct cone_pass *pass, const uint32_t *groups, size_t group_count)
{
    upload(pass, GROUP_BUFFER, 0, groups, group_count * sizeof *groups);
    return gl_check("groups");
}

conus_status cone_pass_add_shape(struct cone_pass *pass, const struct cone_aim *aims, const struct cone_spot *spots,
                                 size_t rays, size_t known)
{
    upload(pass, spots ? AIM_BUFFER : LISTED_AIM_BUFFER, known * rays * sizeof *aims, aims, rays * sizeof *aims);
    if (spots) {
        upload(pass, SPOT_BUFFER, known * rays * sizeof *spots, spots, rays * sizeof *spots);
    }
    return gl_check("a shape of cones");
}

/* Walks all rays, volume after volume; behind the last one they are counted. */
static conus_status dispatch(struct cone_pass *pass, uint32_t rays, uint32_t cones, size_t row_count)
{
    const struct cone_head none = {0};
    reserve(pass, ROW_BUFFER, 0, row_count * sizeof(struct cone_row));
    upload(pass, HEAD_BUFFER, 0, &none, sizeof none);
    for (GLuint buffer = 0; buffer < VALUE_BUFFER; buffer++) {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, buffer, pass->buffers[buffer]);
    }
    glUseProgram(pass->programs[COUNT]);
    glUniform1ui(RAY_COUNT, rays);
    const size_t volumes = id_pass_volume_count(pass->id_pass);
    for (size_t i = 0; i < volumes; i++) {
        id_pass_bind(pass->id_pass, i);
        glUniformMatrix4dv(INDEX_FROM_WORLD, 1, GL_FALSE, id_pass_index_from_world(pass->id_pass, i));
        glUniform1i(HAS_KNOWN, i > 0);
        glUniform1i(IS_LAST, i + 1 == volumes);
        glDispatchCompute(cones, parts_of(rays), 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    }
    return gl_check("counting cones");
}

/* Reads the heads, before which the number of rows stands, and so many rows. */
static conus_status read_rows(struct cone_pass *pass, const struct cone_head **heads, size_t head_count,
                              const struct cone_row **rows, size_t row_count)
{
    struct readback_part parts[] = {{pass->buffers[HEAD_BUFFER], head_count * sizeof **heads, NULL},
                                    {pass->buffers[ROW_BUFFER], row_count * sizeof **rows, NULL}};
    conus_status status = readback_wait(&pass->readback, parts, 2, "reading counts");
    *heads = parts[0].data;
    *rows = parts[1].data;
    return status;
}

conus_status cone_pass_count(struct cone_pass *pass, const struct cone_place *places, uint32_t cones, uint32_t rays,
                             const struct cone_head **heads, const struct cone_row **rows)
{
    const size_t parts = (size_t)cones * parts_of(rays);
    const size_t likely = parts * pass->likely_rows;
    conus_status status = need_program(pass, COUNT);
    if (!status) {
        upload(pass, CONE_BUFFER, 0, places, cones * sizeof *places);
        reserve(pass, HEAD_BUFFER, 0, (HEADS_BEFORE + parts) * sizeof **heads);
        if (id_pass_volume_count(pass->id_pass) > 1) {
            reserve(pass, KNOWN_BUFFER, 0, (size_t)cones * rays * KNOWN_SIZE);
        }
        status = dispatch(pass, rays, cones, likely);
    }
    status = status ? status : read_rows(pass, heads, HEADS_BEFORE + parts, rows, likely);
    const size_t row_count = status ? 0 : (*heads)->first;
    if (row_count * sizeof **rows > pass->sizes[ROW_BUFFER]) {
        status = dispatch(pass, rays, cones, row_count);
    }
    if (row_count > likely && !status) {
        status = read_rows(pass, heads, HEADS_BEFORE + parts, rows, row_count);
    }
    if (!status) {
        *heads += HEADS_BEFORE;
        pass->likely_rows = row_count / parts < ROWS_OF_A_PART ? ROWS_OF_A_PART : row_count / parts * 5 / 4;
    }
    return status;
}

conus_status cone_pass_list(struct cone_pass *pass, const struct cone_place *places, uint32_t cones, uint32_t rays,
                            const uint32_t *list, size_t known, uint32_t count)
{
    conus_status status = need_program(pass, MAKE);
    if (!status) {
        upload(pass, CONE_BUFFER, 0, places, cones * sizeof *places);
        if (known < count) {
            upload(pass, LIST_BUFFER, known * sizeof *list, list + known, (count - known) * sizeof *list);
        }
        pass->list_count = count;
        pass->listed_rays = rays;
        status = gl_check("the list of rays");
    }
    return status;
}

conus_status cone_pass_make_rays(struct cone_pass *pass, size_t volume)
{
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, CONE_BUFFER, pass->buffers[CONE_BUFFER]);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, AIM_BUFFER, pass->buffers[LISTED_AIM_BUFFER]);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, LIST_BLOCK, pass->buffers[LIST_BUFFER]);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, RAY_BLOCK, id_pass_device_rays(pass->id_pass));
    glUseProgram(pass->programs[MAKE]);
    glUniform1ui(RAY_COUNT, pass->listed_rays);
    glUniform1ui(LIST_COUNT, pass->list_count);
    glUniformMatrix4dv(INDEX_FROM_WORLD, 1, GL_FALSE, id_pass_index_from_world(pass->id_pass, volume));
    glDispatchCompute(parts_of(pass->list_count), 1, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    return gl_check("making rays");
}
