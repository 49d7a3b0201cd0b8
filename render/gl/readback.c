/* SPDX-License-Identifier: BSD-3-Clause */
/* Copies on the device into memory that the CPU sees, behind a fence. */
#include "render/gl/gl.h"

enum { ALIGNMENT = 16, MAPPING = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT };

static size_t place_behind(size_t place, size_t size)
{
    return (place + size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
}

void readback_finish(struct readback *readback)
{
    glDeleteBuffers(1, &readback->buffer); /* ends its mapping, too */
    *readback = (struct readback){0};
}

static conus_status reserve(struct readback *readback, size_t size)
{
    if (size <= readback->capacity) {
        return CONUS_OK;
    }
    size_t doubled = 2 * readback->capacity;
    GLsizeiptr capacity = (GLsizeiptr)(size < doubled ? doubled : size);
    readback_finish(readback);
    glCreateBuffers(1, &readback->buffer);
    glNamedBufferStorage(readback->buffer, capacity, NULL, MAPPING | GL_CLIENT_STORAGE_BIT);
    readback->mapped = glMapNamedBufferRange(readback->buffer, 0, capacity, MAPPING);
    conus_status status = gl_check("mapping a buffer");
    readback->capacity = status ? 0 : (size_t)capacity;
    return status;
}

/* A fence that is long in coming is waited for; one of a lost context is an error. */
static conus_status wait_for_device(const char *what)
{
    const GLuint64 second = 1000000000; /* ns */
    GLsync fence = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    GLenum answer = GL_TIMEOUT_EXPIRED;
    while (answer == GL_TIMEOUT_EXPIRED) {
        answer = glClientWaitSync(fence, GL_SYNC_FLUSH_COMMANDS_BIT, second);
    }
    glDeleteSync(fence);
    conus_status status = gl_check(what);
    return !status && answer == GL_WAIT_FAILED ? fail(CONUS_ERROR_GL, "OpenGL failed: %s", what) : status;
}

conus_status readback_wait(struct readback *readback, struct readback_part *parts, size_t count, const char *what)
{
    size_t size = 0;
    for (size_t i = 0; i < count; i++) {
        size = place_behind(size, parts[i].size);
    }
    conus_status status = reserve(readback, size);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    for (size_t i = 0, place = 0; i < count && !status; place = place_behind(place, parts[i++].size)) {
        glCopyNamedBufferSubData(parts[i].buffer, readback->buffer, 0, (GLintptr)place, (GLsizeiptr)parts[i].size);
        parts[i].data = readback->mapped + place;
    }
    return status ? status : wait_for_device(what);
}

conus_status readback_wait_for_rows(struct readback *readback, const struct readback_rows *rows, const void **data,
                                    const char *what)
{
    conus_status status = reserve(readback, rows->size);
    if (!status) {
        glPixelStorei(GL_PACK_ALIGNMENT, 4);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, readback->buffer);
        glGetTextureSubImage(rows->texture, 0, 0, rows->first, 0, rows->width, rows->count, 1, rows->layout, rows->type,
                             (GLsizei)rows->size, NULL);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
        status = wait_for_device(what);
        *data = readback->mapped;
    }
    return status;
}
