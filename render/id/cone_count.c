/* SPDX-License-Identifier: BSD-3-Clause */
/* Sends the places of cones to the device, and takes the rows that it has counted. */
#include "render/id/cone_count.h"

#include "base/memory.h"
#include "render/gl/context.h"
#include "render/gl/program.h"
#include "render/gl/shaders.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum {
    CONE_BUFFER,
    AIM_BUFFER,
    SPOT_BUFFER,
    GROUP_BUFFER,
    KNOWN_BUFFER,
    ROW_BUFFER,
    HEAD_BUFFER,
    VALUE_BUFFER,
    BUFFER_COUNT
};
enum {
    KNOWN_SIZE = 16,
    HEADS_BEFORE = 1,
    ROWS_OF_A_PART = 8,
    VALUES = 4096
}; /* the first head is the number of rows */

struct cone_count {
    const struct id_pass *pass;
    GLuint program;
    GLuint buffers[BUFFER_COUNT];
    size_t sizes[BUFFER_COUNT]; /* bytes they have */
    GLint ray_count, has_known, is_last, first_cell, last_cell;
    GLint index[4]; /* the columns of voxel_from_world */
    double (*matrices)[16];
    size_t volumes;
    uint32_t rays; /* of a cone */
    struct cone_head *heads;
    struct cone_row *rows;
    size_t head_capacity, row_capacity; /* of these on the CPU */
};

/* Makes a buffer at least so large; what is in it is lost where it grows. */
static void reserve(struct cone_count *count, int buffer, size_t size)
{
    if (size > count->sizes[buffer]) {
        glNamedBufferData(count->buffers[buffer], (GLsizeiptr)size, NULL, GL_DYNAMIC_COPY);
        count->sizes[buffer] = size;
    }
}

static void upload(struct cone_count *count, int buffer, const void *data, size_t size)
{
    reserve(count, buffer, size);
    glNamedBufferSubData(count->buffers[buffer], 0, (GLsizeiptr)size, data);
}

static conus_status read_back(struct cone_count *count, int buffer, void *out, size_t size)
{
    glGetNamedBufferSubData(count->buffers[buffer], 0, (GLsizeiptr)size, out);
    return gl_check("reading counts");
}

static conus_status make_program(GLuint *out, bool check)
{
    const struct program_define defines[] = {
        {"SLICES", 0},
        {"PIERCE", 0},
        {"CONES", 1},
        {"CHECK", check},
        {"GROUP", CONE_PART},
        {"OBJECTS_UNIT", ID_OBJECTS_UNIT},
        {"DISTANCE_UNIT", ID_DISTANCE_UNIT},
        {"IDENTIFIER_UNIT", ID_IDENTIFIER_UNIT},
        {"CONE_BUFFER", CONE_BUFFER},
        {"AIM_BUFFER", AIM_BUFFER},
        {"SPOT_BUFFER", SPOT_BUFFER},
        {"GROUP_BUFFER", GROUP_BUFFER},
        {"KNOWN_BUFFER", KNOWN_BUFFER},
        {"ROW_BUFFER", ROW_BUFFER},
        {"HEAD_BUFFER", HEAD_BUFFER},
        {"VALUE_BUFFER", VALUE_BUFFER},
    };
    const struct program_source source = {.compute = {"id.comp.glsl", shader_id_comp},
                                          .more = {"cones.comp.glsl", shader_cones_comp},
                                          .defines = defines,
                                          .define_count = sizeof defines / sizeof defines[0]};
    return program_create(out, &source);
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
static conus_status check_rounding(struct cone_count *count, bool *out)
{
    GLuint program = 0;
    double *values = memory_raw(VALUES, sizeof *values);
    conus_status status = values ? make_program(&program, true) : CONUS_ERROR_MEMORY;
    *out = true;
    if (!status) {
        for (uint32_t i = 0; i < VALUES; i++) {
            values[i] = hard_number(i);
        }
        upload(count, VALUE_BUFFER, values, VALUES * sizeof *values);
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, VALUE_BUFFER, count->buffers[VALUE_BUFFER]);
        glUseProgram(program);
        glDispatchCompute(VALUES / CONE_PART, 1, 1);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        status = read_back(count, VALUE_BUFFER, values, VALUES * sizeof *values);
        for (uint32_t i = 0; i < VALUES && !status; i++) {
            *out = *out && values[i] == 1 / hard_number(i);
        }
    }
    glDeleteProgram(program);
    memory_free(values);
    return status;
}

static void find_uniforms(struct cone_count *count)
{
    static const char *const columns[] = {"index_x", "index_y", "index_z", "index_origin"};
    count->ray_count = program_uniform(count->program, "ray_count");
    count->has_known = program_uniform(count->program, "has_known");
    count->is_last = program_uniform(count->program, "is_last");
    count->first_cell = program_uniform(count->program, "first_cell");
    count->last_cell = program_uniform(count->program, "last_cell");
    for (int column = 0; column < 4; column++) {
        count->index[column] = program_uniform(count->program, columns[column]);
    }
}

conus_status cone_count_create(struct cone_count **out, const struct id_pass *pass, const uint32_t *groups,
                               size_t group_count, const double *const *voxel_from_world, size_t volumes)
{
    static_assert(sizeof(struct cone_place) == 112 && sizeof(struct cone_aim) == 48 && sizeof(struct cone_spot) == 16 &&
                      sizeof(struct cone_row) == 48 && sizeof(struct cone_head) == 8,
                  "the shader's structs");
    bool rounds = false;
    struct cone_count *count = memory_zeroed(1, sizeof *count);
    if (!count) {
        return CONUS_ERROR_MEMORY;
    }
    count->pass = pass;
    count->volumes = volumes;
    count->matrices = memory_raw(volumes, sizeof *count->matrices);
    conus_status status = count->matrices ? make_program(&count->program, false) : CONUS_ERROR_MEMORY;
    if (!status) {
        find_uniforms(count);
        for (size_t i = 0; i < volumes; i++) {
            memcpy(count->matrices[i], voxel_from_world[i], sizeof count->matrices[i]);
        }
        glCreateBuffers(BUFFER_COUNT, count->buffers);
        status = check_rounding(count, &rounds);
    }
    if (!status && rounds) {
        upload(count, GROUP_BUFFER, groups, group_count * sizeof *groups);
        reserve(count, KNOWN_BUFFER, KNOWN_SIZE); /* which one volume alone does not use */
        status = gl_check("cones");
    }
    if (status || !rounds) {
        cone_count_destroy(count);
        count = NULL;
    }
    *out = status ? *out : count;
    return status;
}

void cone_count_destroy(struct cone_count *count)
{
    if (count) {
        glDeleteProgram(count->program);
        glDeleteBuffers(BUFFER_COUNT, count->buffers);
        memory_free(count->matrices);
        memory_free(count->heads);
        memory_free(count->rows);
        memory_free(count);
    }
}

/* Uploads what is behind the first `known` bytes, or all, where these are lost. */
static void extend(struct cone_count *count, int buffer, const void *data, size_t known, size_t size)
{
    if (size > count->sizes[buffer]) {
        reserve(count, buffer, known ? 2 * size : size);
        known = 0;
    }
    glNamedBufferSubData(count->buffers[buffer], (GLintptr)known, (GLsizeiptr)(size - known),
                         (const uint8_t *)data + known);
}

conus_status cone_count_set_shapes(struct cone_count *count, const struct cone_aim *aims, const struct cone_spot *spots,
                                   uint32_t rays, size_t known, size_t shapes)
{
    if (known < shapes) {
        extend(count, AIM_BUFFER, aims, known * rays * sizeof *aims, shapes * rays * sizeof *aims);
        extend(count, SPOT_BUFFER, spots, known * rays * sizeof *spots, shapes * rays * sizeof *spots);
    }
    count->rays = rays;
    return gl_check("the shapes of cones");
}

/* Walks all rays, volume after volume; behind the last one they are counted. */
static conus_status dispatch(struct cone_count *count, uint32_t cones, uint32_t parts)
{
    const struct cone_head none = {0};
    glNamedBufferSubData(count->buffers[HEAD_BUFFER], 0, sizeof none, &none);
    for (GLuint buffer = 0; buffer < BUFFER_COUNT; buffer++) {
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, buffer, count->buffers[buffer]);
    }
    glUseProgram(count->program);
    glUniform1ui(count->ray_count, count->rays);
    for (size_t i = 0; i < count->volumes; i++) {
        id_pass_bind(count->pass, i, count->first_cell, count->last_cell);
        for (int column = 0; column < 4; column++) {
            glUniform3dv(count->index[column], 1, count->matrices[i] + 4 * column);
        }
        glUniform1i(count->has_known, i > 0);
        glUniform1i(count->is_last, i + 1 == count->volumes);
        glDispatchCompute(cones, parts, 1);
        glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    }
    return gl_check("counting cones");
}

conus_status cone_count_run(struct cone_count *count, const struct cone_place *places, uint32_t cones,
                            const struct cone_head **heads, const struct cone_row **rows)
{
    uint32_t parts = (count->rays + CONE_PART - 1) / CONE_PART;
    size_t head_count = HEADS_BEFORE + (size_t)cones * parts;
    uint32_t row_count = 0;
    if (!memory_reserve(&count->heads, &count->head_capacity, head_count, sizeof *count->heads)) {
        return CONUS_ERROR_MEMORY;
    }
    upload(count, CONE_BUFFER, places, cones * sizeof *places);
    reserve(count, HEAD_BUFFER, head_count * sizeof *count->heads);
    reserve(count, ROW_BUFFER, (size_t)cones * parts * ROWS_OF_A_PART * sizeof *count->rows);
    if (count->volumes > 1) {
        reserve(count, KNOWN_BUFFER, (size_t)cones * count->rays * KNOWN_SIZE);
    }
    conus_status status = gl_check("cones");
    for (bool fits = false; !status && !fits;) {
        status = dispatch(count, cones, parts);
        status = status ? status : read_back(count, HEAD_BUFFER, count->heads, head_count * sizeof *count->heads);
        if (!status) {
            row_count = count->heads[0].first;
            fits = row_count * sizeof *count->rows <= count->sizes[ROW_BUFFER];
            reserve(count, ROW_BUFFER, row_count * sizeof *count->rows);
        }
    }
    if (!status && !memory_reserve(&count->rows, &count->row_capacity, row_count, sizeof *count->rows)) {
        status = CONUS_ERROR_MEMORY;
    }
    status = status ? status : read_back(count, ROW_BUFFER, count->rows, row_count * sizeof *count->rows);
    if (status) {
        memset(count->sizes, 0, sizeof count->sizes); /* who knows which buffers the driver has made */
        return status;
    }
    *heads = count->heads + HEADS_BEFORE;
    *rows = count->rows;
    return CONUS_OK;
}
