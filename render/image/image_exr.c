/* SPDX-License-Identifier: BSD-3-Clause */
/* OpenEXR through its C library, between an image and bytes in memory, with our allocator and its first message as
 * ours. One call at a time per thread. */
#include "base/library.h"
#include "base/memory.h"
#include "render/image/image.h"

#include <openexr.h>
#include <stdio.h>
#include <string.h>

enum {
    MAX_CHANNELS = 1024,
    MAX_NAME = 31,      /* of attributes: what files without the long-name flag hold */
    MAX_DENSITY = 1024, /* values in a byte of file: deflated HALF reaches 516 */
};

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

/* exr_finish() and the others, once exr_stream_read() or exr_stream_write() has begun. */
static struct openexr {
    EXR_FUNCTIONS(LIBRARY_MEMBER)
} openexr;

struct exr_stream {
    struct buffer written;
    const uint8_t *data; /* read */
    size_t size;
};

/* The error of the call under way: the first message (later ones are its consequences), and whether memory was
 * short, which the library does not always pass on. Not in struct exr_stream: the library gives its allocator no user
 * data, and while it reports it holds the lock that exr_get_user_data() takes. */
static _Thread_local struct {
    char message[256];
    bool no_memory;
    bool no_library;
} trouble;

static void keep_message(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context;
    (void)code;
    if (!trouble.message[0]) {
        snprintf(trouble.message, sizeof trouble.message, "%s", text);
    }
}

static void *allocate(size_t size)
{
    void *block = memory_raw(size, 1);
    trouble.no_memory = trouble.no_memory || !block;
    return block;
}

/* Begins a call. */
static exr_context_initializer_t settings(struct exr_stream *stream)
{
    exr_context_initializer_t init = EXR_DEFAULT_CONTEXT_INITIALIZER;
    trouble.message[0] = '\0';
    trouble.no_memory = false;
    trouble.no_library = library_load(&openexr, EXR_FUNCTIONS(LIBRARY_NAME), CONUS_OPENEXR_FILE, "libopenexr-3-1-30");
    init.error_handler_fn = keep_message;
    init.alloc_fn = allocate;
    init.free_fn = memory_free;
    init.user_data = stream;
    init.max_image_width = (int)IMAGE_MAX_SIDE;
    init.max_image_height = (int)IMAGE_MAX_SIDE;
    init.flags = EXR_CONTEXT_FLAG_STRICT_HEADER | EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return init;
}

/* The status and message of the error in the call under way. */
static conus_status exr_stream_fail(exr_result_t code)
{
    if (trouble.no_library) {
        return CONUS_ERROR_UNSUPPORTED; /* library_load() has said so */
    }
    if (trouble.no_memory || code == EXR_ERR_OUT_OF_MEMORY) {
        return fail(CONUS_ERROR_MEMORY, "no memory for an OpenEXR image");
    }
    return fail(code == EXR_ERR_FEATURE_NOT_IMPLEMENTED ? CONUS_ERROR_UNSUPPORTED : CONUS_ERROR_DATA, "OpenEXR: %s",
                trouble.message[0] ? trouble.message : openexr.get_default_error_message(code));
}

static int64_t write_at(exr_const_context_t context, void *user, const void *bytes, uint64_t size, uint64_t offset,
                        exr_stream_error_func_ptr_t error)
{
    struct buffer *written = &((struct exr_stream *)user)->written;
    uint64_t over = offset < written->size ? written->size - offset : 0;
    over = over < size ? over : size;
    if (over) {
        memcpy(written->data + offset, bytes, over);
    }
    while (!written->failed && written->size < offset) {
        buffer_append(written, "", 1);
    }
    buffer_append(written, (const char *)bytes + over, size - over);
    (void)context;
    (void)error;
    trouble.no_memory = trouble.no_memory || written->failed;
    return written->failed ? -1 : (int64_t)size;
}

static exr_result_t exr_stream_write(exr_context_t *file, struct exr_stream *stream)
{
    exr_context_initializer_t init = settings(stream);
    init.write_fn = write_at;
    return trouble.no_library ? EXR_ERR_UNKNOWN : openexr.start_write(file, "image", EXR_WRITE_FILE_DIRECTLY, &init);
}

static exr_result_t exr_stream_attributes(exr_context_t file, const conus_image *image)
{
    exr_result_t code = EXR_ERR_SUCCESS;
    for (size_t i = 0; !code && i < image->attribute_count; i++) {
        const struct image_attribute *attribute = &image->attributes[i];
        if (attribute->is_matrix) {
            exr_attr_m44d_t matrix;
            memcpy(&matrix, attribute->matrix, sizeof matrix); /* Imath has row vectors: the same numbers in a row */
            code = openexr.attr_set_m44d(file, 0, attribute->name, &matrix);
        } else {
            code = openexr.attr_set_string(file, 0, attribute->name, attribute->text);
        }
    }
    if (!code && image->dpi > 0) {
        code = openexr.attr_set_float(file, 0, "xDensity", (float)image->dpi); /* OpenEXR's own: pixels per inch */
    }
    return code;
}

/* Ends a file that was begun with exr_stream_write(), NULL if that failed. */
static conus_status exr_stream_end(struct bytes *out, exr_context_t file, struct exr_stream *stream, exr_result_t code)
{
    if (file) {
        exr_result_t finished = openexr.finish(&file); /* writes the table of chunks */
        code = code ? code : finished;
    }
    if (code) {
        buffer_finish(&stream->written);
        return exr_stream_fail(code);
    }
    *out = (struct bytes){(uint8_t *)stream->written.data, stream->written.size};
    return CONUS_OK;
}

static int64_t read_at(exr_const_context_t context, void *user, void *bytes, uint64_t size, uint64_t offset,
                       exr_stream_error_func_ptr_t error)
{
    const struct exr_stream *stream = user;
    if (offset >= stream->size) {
        error(context, EXR_ERR_READ_IO, "file of %zu bytes ends too early", stream->size);
        return -1;
    }
    size_t got = stream->size - offset < size ? stream->size - offset : size; /* it asks for blocks, and checks */
    memcpy(bytes, stream->data + offset, got);
    return (int64_t)got;
}

static int64_t total_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const struct exr_stream *)user)->size;
}

static exr_result_t exr_stream_read(exr_context_t *file, struct exr_stream *stream)
{
    exr_context_initializer_t init = settings(stream);
    init.read_fn = read_at;
    init.size_fn = total_size;
    return trouble.no_library ? EXR_ERR_UNKNOWN : openexr.start_read(file, "image", &init);
}

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
