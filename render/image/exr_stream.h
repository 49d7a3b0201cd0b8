/* SPDX-License-Identifier: BSD-3-Clause */
/** @file OpenEXR's C library working on bytes in memory, with our allocator and its first message as ours. One call at
 * a time per thread. */
#ifndef CONUS_RENDER_IMAGE_EXR_STREAM_H
#define CONUS_RENDER_IMAGE_EXR_STREAM_H

#include "base/buffer.h"
#include "conus/image.h"
#include "render/image/image.h"

#include <openexr.h>

struct exr_stream {
    struct buffer written;
    const uint8_t *data; /**< Read. */
    size_t size;
};

/** Starts to read @p stream->data. */
exr_result_t exr_stream_read(exr_context_t *file, struct exr_stream *stream);

/** Starts to write into @p stream, which is empty. */
exr_result_t exr_stream_write(exr_context_t *file, struct exr_stream *stream);

/** Writes text and matrix attributes of @p image into the header of the one part. */
exr_result_t exr_stream_attributes(exr_context_t file, const conus_image *image);

/** Ends @p file, begun with exr_stream_write() and NULL if that failed. Returns the written bytes, which are the
 * caller's, unless @p code or the ending itself is an error. */
conus_status exr_stream_end(struct bytes *out, exr_context_t file, struct exr_stream *stream, exr_result_t code);

/** The status and message of the error in the call under way. */
conus_status exr_stream_fail(exr_result_t code);

#endif
