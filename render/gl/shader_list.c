/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws until all records fit, and reads them back. */
#include "render/gl/shader_list.h"

#include "render/gl/context.h"

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

/* How many records were appended, and the first `most` of them. */
static conus_status read_list(struct shader_list *list, uint32_t most, uint32_t *count, const void **records)
{
    struct readback_part part = {list->buffer, HEADER_SIZE + most * list->record_size, NULL};
    conus_status status = readback_wait(&list->readback, &part, 1, "drawing into a list");
    if (!status) {
        *count = *(const uint32_t *)part.data;
        *records = (const uint8_t *)part.data + HEADER_SIZE;
    }
    return status;
}

/* Draws, and reads how many records were appended, and, where they fit, the records. */
static conus_status draw_range(struct shader_list *list, const struct shader_list_job *job, uint32_t first,
                               uint32_t end, uint32_t *count, const void **records)
{
    static const uint32_t header[HEADER_SIZE / sizeof(uint32_t)] = {0};
    uint32_t likely = list->likely < list->capacity ? list->likely : list->capacity;
    glNamedBufferSubData(list->buffer, 0, sizeof header, header);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, job->binding, list->buffer);
    conus_status status = job->draw(job->user, first, end);
    status = status ? status : read_list(list, likely, count, records);
    if (!status && *count > likely && *count <= list->capacity) {
        status = read_list(list, *count, count, records);
    }
    list->likely = status ? likely : *count + *count / 4;
    return status;
}

/* `count` records did not fit: raises the capacity, or lowers the number of pixels at the limit. */
static conus_status adapt(struct shader_list *list, uint32_t count, uint32_t *pixels)
{
    if (list->capacity < list->limit) {
        uint64_t wanted = count + (uint64_t)count / 4;
        return reserve_records(list, wanted < list->limit ? (uint32_t)wanted : list->limit);
    }
    uint64_t fitting = *pixels * (uint64_t)list->capacity / count;
    if (*pixels == 1) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%u intervals along one ray: the gl engine takes up to %u", count,
                    list->capacity);
    }
    *pixels = fitting > *pixels / 2 ? *pixels / 2 : fitting < 1 ? 1 : (uint32_t)fitting;
    return CONUS_OK;
}

conus_status shader_list_collect(struct shader_list *list, const struct shader_list_job *job)
{
    conus_status status = CONUS_OK;
    uint32_t most = job->per_pixel ? UINT32_MAX / job->per_pixel : 0; /* pixels that the counter can count for */
    uint32_t pixels = job->pixels < most ? job->pixels : most;
    for (uint32_t first = 0; pixels && first < job->pixels && !status;) {
        uint32_t end = job->pixels - first < pixels ? job->pixels : first + pixels;
        uint32_t count = 0;
        const void *records = NULL;
        status = draw_range(list, job, first, end, &count, &records);
        if (!status && count > list->capacity) {
            pixels = end - first;
            status = adapt(list, count, &pixels);
        } else if (!status) {
            status = job->take(job->user, records, count);
            first = end;
        }
    }
    return status;
}
