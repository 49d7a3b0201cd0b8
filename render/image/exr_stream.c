/* SPDX-License-Identifier: BSD-3-Clause */
/* Memory streams for OpenEXR's C library, and its errors as ours. */
#include "render/image/exr_stream.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

/* The error of the call under way: the first message (later ones are its consequences), and whether memory was
 * short, which the library does not always pass on. Not in struct exr_stream: the library gives its allocator no user
 * data, and while it reports it holds the lock that exr_get_user_data() takes. */
static _Thread_local struct {
    char message[256];
    bool no_memory;
    bool no_library;
} trouble;

struct openexr openexr;

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

conus_status exr_stream_fail(exr_result_t code)
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

exr_result_t exr_stream_write(exr_context_t *file, struct exr_stream *stream)
{
    exr_context_initializer_t init = settings(stream);
    init.write_fn = write_at;
    return trouble.no_library ? EXR_ERR_UNKNOWN : openexr.start_write(file, "image", EXR_WRITE_FILE_DIRECTLY, &init);
}

exr_result_t exr_stream_attributes(exr_context_t file, const conus_image *image)
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

conus_status exr_stream_end(struct bytes *out, exr_context_t file, struct exr_stream *stream, exr_result_t code)
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

exr_result_t exr_stream_read(exr_context_t *file, struct exr_stream *stream)
{
    exr_context_initializer_t init = settings(stream);
    init.read_fn = read_at;
    init.size_fn = total_size;
    return trouble.no_library ? EXR_ERR_UNKNOWN : openexr.start_read(file, "image", &init);
}
