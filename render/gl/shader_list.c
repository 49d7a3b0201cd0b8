/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws until all records fit, and reads them back. */
#include "render/gl/gl.h"

enum { HEADER_SIZE = 8, SIZE_LIMIT = 1 << 24 }; /* bytes; any driver takes blocks of 2^24 */

static conus_status reserve_records(struct shader_list *list, uint32_t capacity)
{
    list->capacity = capacity;
    glNamedBufferData(list->buffer, (GLsizeiptr)(HEADER_SIZE + capacity * list->record_size), NULL, GL_DYNAMIC_COPY);
    return gl_check("list");
}

void shader_list_finish(struct shader_list *list)
{
    glDeleteBuffers(1, &list->buffer);
    readback_finish(&list->readback);
    *list = (struct shader_list){0};
}

conus_status shader_list_init(struct shader_list *out, size_t record_size, uint32_t first)
{
    *out = (struct shader_list){.record_size = record_size, .likely = first};
    out->limit = (uint32_t)((SIZE_LIMIT - HEADER_SIZE) / record_size);
    glCreateBuffers(1, &out->buffer);
    conus_status status = reserve_records(out, first);
    if (status) {
        shader_list_finish(out);
    }
    return status;
}

/* `count` records did not fit: raises the capacity, or lowers the number of pixels at the limit. */
static conus_status adapt(struct shader_list *list, uint32_t count)
{
    const uint32_t pixels = list->end - list->first;
    if (list->capacity < list->limit) {
        uint64_t wanted = count + (uint64_t)count / 4;
        return reserve_records(list, wanted < list->limit ? (uint32_t)wanted : list->limit);
    }
    uint64_t fitting = pixels * (uint64_t)list->capacity / count;
    if (pixels == 1) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%u intervals along one ray: the gl engine takes up to %u", count,
                    list->capacity);
    }
    list->together = fitting > pixels / 2 ? pixels / 2 : fitting < 1 ? 1 : (uint32_t)fitting;
    return CONUS_OK;
}

void shader_list_begin(struct shader_list *list, uint32_t pixels, uint32_t per_pixel)
{
    uint32_t most = per_pixel ? UINT32_MAX / per_pixel : 0; /* pixels that the counter can count for */
    list->first = list->end = 0;
    list->pixels = most ? pixels : 0;
    list->together = pixels < most ? pixels : most;
}

bool shader_list_next(struct shader_list *list, GLuint binding)
{
    static const uint32_t header[HEADER_SIZE / sizeof(uint32_t)] = {0};
    list->end = list->pixels - list->first < list->together ? list->pixels : list->first + list->together;
    glNamedBufferSubData(list->buffer, 0, sizeof header, header);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, list->buffer);
    return list->first < list->pixels;
}

/* How many records were appended, and the first `most` of them. */
static conus_status read_first(struct shader_list *list, uint32_t most, const void **records, uint32_t *count)
{
    struct readback_part part = {list->buffer, HEADER_SIZE + most * list->record_size, NULL};
    conus_status status = readback_wait(&list->readback, &part, 1, "drawing into a list");
    if (!status) {
        *count = *(const uint32_t *)part.data;
        *records = (const uint8_t *)part.data + HEADER_SIZE;
    }
    return status;
}

conus_status shader_list_read(struct shader_list *list, const void **records, uint32_t *count)
{
    const uint32_t likely = list->likely < list->capacity ? list->likely : list->capacity;
    conus_status status = read_first(list, likely, records, count);
    if (!status && *count > likely && *count <= list->capacity) {
        status = read_first(list, *count, records, count);
    }
    list->likely = status ? likely : *count + *count / 4;
    if (!status && *count > list->capacity) {
        status = adapt(list, *count);
        *count = 0;
    } else {
        list->first = list->end;
    }
    return status;
}
