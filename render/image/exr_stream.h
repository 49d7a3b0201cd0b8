/* SPDX-License-Identifier: BSD-3-Clause */
/** @file OpenEXR's C library working on bytes in memory, with our allocator and its first message as ours. One call at
 * a time per thread. */
#ifndef CONUS_RENDER_IMAGE_EXR_STREAM_H
#define CONUS_RENDER_IMAGE_EXR_STREAM_H

#include "base/buffer.h"
#include "base/library.h"
#include "conus/image.h"
#include "render/image/image.h"

#include <openexr.h>

/* clang-format off */
#define EXR_FUNCTIONS(F)                                                                                               \
    F(exr_, add_channel) F(exr_, add_part) F(exr_, attr_set_float) F(exr_, attr_set_m44d) F(exr_, attr_set_string)     \
    F(exr_, decoding_choose_default_routines) F(exr_, decoding_destroy) F(exr_, decoding_initialize)                   \
    F(exr_, decoding_run) F(exr_, decoding_update) F(exr_, encoding_choose_default_routines)                           \
    F(exr_, encoding_destroy) F(exr_, encoding_initialize) F(exr_, encoding_run) F(exr_, encoding_update)              \
    F(exr_, finish) F(exr_, get_attribute_by_index) F(exr_, get_attribute_count) F(exr_, get_channels)                 \
    F(exr_, get_compression) F(exr_, get_count) F(exr_, get_data_window) F(exr_, get_default_error_message)            \
    F(exr_, get_scanlines_per_chunk) F(exr_, get_storage) F(exr_, initialize_required_attr_simple)                     \
    F(exr_, read_scanline_chunk_info) F(exr_, start_read) F(exr_, start_write) F(exr_, write_header)                   \
    F(exr_, write_scanline_chunk_info)
/* clang-format on */

/** exr_finish() and the others, once exr_stream_read() or exr_stream_write() has begun. */
extern struct openexr {
    EXR_FUNCTIONS(LIBRARY_MEMBER)
} openexr;

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
