/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenEXR through its C library, between an image and bytes in memory. */
#include "render/image/exr_stream.h"
#include "render/image/image_codecs.h"

#include <string.h>

enum {
    MAX_CHANNELS = 1024,
    MAX_NAME = 31,      /* of attributes: what files without the long-name flag hold */
    MAX_DENSITY = 1024, /* values in a byte of file: deflated HALF reaches 516 */
};

typedef exr_result_t (*compress_function)(exr_encode_pipeline_t *pipeline);

/* The library's own compression, but a chunk that becomes no smaller is stored as it is. The library 3.1.5 also stores
 * a packed chunk of exactly the plain size, which every reader takes for a plain one. */
static exr_result_t compress_if_smaller(exr_encode_pipeline_t *pipeline)
{
    exr_result_t code = (*(compress_function *)pipeline->encoding_user_data)(pipeline);
    if (!code && pipeline->compressed_bytes >= pipeline->packed_bytes) {
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
        pipeline->compressed_bytes = pipeline->packed_bytes;
    }
    return code;
}

static exr_result_t write_chunk(exr_context_t file, exr_encode_pipeline_t *pipeline, compress_function *compress,
                                const conus_image *image, int row)
{
    exr_chunk_info_t chunk;
    exr_result_t code = openexr.write_scanline_chunk_info(file, 0, row, &chunk);
    if (!code) {
        code = row == 0 ? openexr.encoding_initialize(file, 0, &chunk, pipeline)
                        : openexr.encoding_update(file, 0, &chunk, pipeline);
    }
    for (int i = 0; !code && i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *coded = &pipeline->channels[i];
        const float *pixels = image_find(image, coded->channel_name)->floats;
        coded->encode_from_ptr = (const uint8_t *)(pixels + (size_t)row * image->width);
        coded->user_pixel_stride = sizeof *pixels;
        coded->user_line_stride = (int32_t)(image->width * sizeof *pixels);
    }
    if (!code && row == 0) {
        code = openexr.encoding_choose_default_routines(file, 0, pipeline);
        *compress = pipeline->compress_fn;
        pipeline->encoding_user_data = compress;
        pipeline->compress_fn = compress_if_smaller;
    }
    return code ? code : openexr.encoding_run(file, 0, pipeline);
}

conus_status image_format_exr(struct bytes *out, const conus_image *image)
{
    struct exr_stream stream = {0};
    exr_context_t file = NULL;
    exr_result_t code = exr_stream_write(&file, &stream);
    if (!code) {
        int part;
        code = openexr.add_part(file, NULL, EXR_STORAGE_SCANLINE, &part);
        if (!code) {
            code = openexr.initialize_required_attr_simple(file, part, (int32_t)image->width, (int32_t)image->height,
                                                           EXR_COMPRESSION_ZIP);
        }
        for (size_t i = 0; !code && i < image->channel_count; i++) {
            const struct image_channel *channel = &image->channels[i];
            code = openexr.add_channel(file, part, channel->name,
                                       channel->type == IMAGE_FLOAT ? EXR_PIXEL_FLOAT : EXR_PIXEL_UINT,
                                       EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
        }
        code = code ? code : exr_stream_attributes(file, image);
        code = code ? code : openexr.write_header(file);
    }
    if (!code) {
        exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
        compress_function compress = NULL;
        int32_t lines = 0;
        code = openexr.get_scanlines_per_chunk(file, 0, &lines);
        for (int row = 0; !code && row < (int)image->height; row += lines) {
            code = write_chunk(file, &pipeline, &compress, image, row);
        }
        openexr.encoding_destroy(file, &pipeline);
    }
    return exr_stream_end(out, file, &stream, code);
}

static conus_status read_channels(conus_image *image, const exr_attr_chlist_t *list, exr_compression_t compression)
{
    bool b44 = compression == EXR_COMPRESSION_B44 || compression == EXR_COMPRESSION_B44A;
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        if (entry->x_sampling != 1 || entry->y_sampling != 1) {
            return fail(CONUS_ERROR_UNSUPPORTED, "channel %s has one sample in %d x %d pixels, allowed is one in each",
                        entry->name.str, entry->x_sampling, entry->y_sampling);
        }
        if (b44 && entry->pixel_type != EXR_PIXEL_HALF) { /* the C library 3.1.5 decodes those wrongly */
            return fail(CONUS_ERROR_UNSUPPORTED, "channel %s is not HALF, which B44 compression needs here",
                        entry->name.str);
        }
        enum image_type type = entry->pixel_type == EXR_PIXEL_UINT ? IMAGE_UINT : IMAGE_FLOAT;
        conus_status status = image_add_channel(image, entry->name.str, type, NULL);
        if (status) {
            return status;
        }
    }
    return CONUS_OK;
}

static conus_status read_attribute(conus_image *image, const exr_attribute_t *attribute)
{
    double matrix[16];
    if (attribute->name_length > MAX_NAME) {
        return CONUS_OK;
    }
    if (attribute->type == EXR_ATTR_M44D) {
        memcpy(matrix, attribute->m44d, sizeof matrix);
        return image_add_matrix(image, attribute->name, matrix);
    }
    if (attribute->type == EXR_ATTR_M44F) {
        for (int i = 0; i < 16; i++) {
            matrix[i] = (double)attribute->m44f->m[i];
        }
        return image_add_matrix(image, attribute->name, matrix);
    }
    bool own = strcmp(attribute->name, "name") != 0 && strcmp(attribute->name, "type") != 0; /* not of the part */
    return attribute->type == EXR_ATTR_STRING && own ? image_add_text(image, attribute->name, attribute->string->str)
                                                     : CONUS_OK;
}

/* Makes the image that the header speaks of. */
static conus_status read_header(conus_image **out, exr_const_context_t file, const struct exr_stream *stream)
{
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    exr_attr_box2i_t window = {0};
    const exr_attr_chlist_t *list = NULL;
    exr_compression_t compression = EXR_COMPRESSION_NONE;
    if (openexr.get_count(file, &parts) || openexr.get_storage(file, 0, &storage) ||
        openexr.get_data_window(file, 0, &window) || openexr.get_channels(file, 0, &list) ||
        openexr.get_compression(file, 0, &compression)) {
        return exr_stream_fail(EXR_ERR_FILE_BAD_HEADER);
    }
    if (parts != 1 || storage != EXR_STORAGE_SCANLINE) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "OpenEXR file of %d parts, the first %s: allowed is one of flat scan lines", parts,
                    storage == EXR_STORAGE_SCANLINE ? "of scan lines" : "tiled or deep");
    }
    int64_t width = (int64_t)window.max.x - window.min.x + 1;
    int64_t height = (int64_t)window.max.y - window.min.y + 1;
    if (width < 1 || height < 1 || width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE ||
        list->num_channels > MAX_CHANNELS) {
        return fail(CONUS_ERROR_DATA, "OpenEXR: %lld x %lld pixels of %d channels, allowed are %u x %u of %d",
                    (long long)width, (long long)height, list->num_channels, IMAGE_MAX_SIDE, IMAGE_MAX_SIDE,
                    MAX_CHANNELS);
    }
    uint64_t values = (uint64_t)(width * height) * (uint64_t)list->num_channels;
    if (values / MAX_DENSITY > stream->size) {
        return fail(CONUS_ERROR_DATA, "OpenEXR: %zu bytes cannot hold %lld x %lld pixels of %d channels", stream->size,
                    (long long)width, (long long)height, list->num_channels);
    }
    conus_image *image = NULL;
    conus_status status = image_create(&image, (uint32_t)width, (uint32_t)height);
    status = status ? status : read_channels(image, list, compression);
    if (!status) {
        int32_t count = 0;
        status = openexr.get_attribute_count(file, 0, &count) ? CONUS_ERROR_DATA : CONUS_OK;
        for (int32_t i = 0; !status && i < count; i++) {
            const exr_attribute_t *attribute = NULL;
            if (openexr.get_attribute_by_index(file, 0, EXR_ATTR_LIST_FILE_ORDER, i, &attribute) == EXR_ERR_SUCCESS) {
                status = read_attribute(image, attribute);
            }
        }
    }
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

static exr_result_t read_chunk(exr_const_context_t file, exr_decode_pipeline_t *pipeline, conus_image *image, int first,
                               int row)
{
    exr_chunk_info_t chunk;
    exr_result_t code = openexr.read_scanline_chunk_info(file, 0, first + row, &chunk);
    if (!code && (chunk.start_y != first + row || chunk.width != (int)image->width || chunk.height < 1 ||
                  chunk.height > (int)image->height - row)) {
        code = EXR_ERR_BAD_CHUNK_LEADER;
    }
    if (!code) {
        code = row == 0 ? openexr.decoding_initialize(file, 0, &chunk, pipeline)
                        : openexr.decoding_update(file, 0, &chunk, pipeline);
    }
    for (int i = 0; !code && i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *coded = &pipeline->channels[i];
        const struct image_channel *channel = image_find(image, coded->channel_name);
        coded->decode_to_ptr = (uint8_t *)(channel->floats + (size_t)row * image->width);
        coded->user_pixel_stride = sizeof *channel->floats;
        coded->user_line_stride = (int32_t)(image->width * sizeof *channel->floats);
        coded->user_bytes_per_element = sizeof *channel->floats;
        coded->user_data_type = channel->type == IMAGE_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
    }
    if (!code && row == 0) {
        code = openexr.decoding_choose_default_routines(file, 0, pipeline);
    }
    return code ? code : openexr.decoding_run(file, 0, pipeline);
}

conus_status image_parse_exr(conus_image **out, const uint8_t *data, size_t size)
{
    struct exr_stream stream = {.data = data, .size = size};
    exr_context_t file = NULL;
    exr_result_t code = exr_stream_read(&file, &stream);
    if (code) {
        return exr_stream_fail(code);
    }
    conus_image *image = NULL;
    conus_status status = read_header(&image, file, &stream);
    if (!status && image) {
        exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
        exr_attr_box2i_t window;
        int32_t lines = 0;
        code = openexr.get_data_window(file, 0, &window);
        code = code ? code : openexr.get_scanlines_per_chunk(file, 0, &lines);
        for (int row = 0; !code && row < (int)image->height; row += lines) {
            code = read_chunk(file, &pipeline, image, window.min.y, row);
        }
        openexr.decoding_destroy(file, &pipeline);
        status = code ? exr_stream_fail(code) : CONUS_OK;
    }
    openexr.finish(&file);
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}
