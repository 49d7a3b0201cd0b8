/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * What the CPU reads of buffers that the device writes. The device copies it into a buffer that stays mapped, so that
 * the CPU waits once for as many buffers as it likes, and copies nothing. Needs a current context throughout. */
#ifndef CONUS_RENDER_GL_READBACK_H
#define CONUS_RENDER_GL_READBACK_H

#include "base/status.h"
#include "render/gl/functions.h"

#include <stdint.h>

/** Zeroed before the first use. */
struct readback {
    GLuint buffer;
    size_t capacity; /**< Bytes. */
    const uint8_t *mapped;
};

/** The first bytes of a buffer. */
struct readback_part {
    GLuint buffer;
    size_t size;
    const void *data; /**< Out; borrowed until the next call. */
};

/** Waits for what was drawn and dispatched, and sets the data of @p count parts. Errors name @p what was done. */
conus_status readback_wait(struct readback *readback, struct readback_part *parts, size_t count, const char *what);

/** Likewise for rows of a texture of two dimensions: @p count from @p first on, @p width texels of the size that
 * @p layout and @p type say, which is @p size together. */
struct readback_rows {
    GLuint texture;
    GLsizei width, first, count;
    GLenum layout, type;
    size_t size;
};
conus_status readback_wait_for_rows(struct readback *readback, const struct readback_rows *rows, const void **data,
                                    const char *what);

void readback_finish(struct readback *readback);

#endif
