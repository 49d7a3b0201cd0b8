/* SPDX-License-Identifier: BSD-3-Clause */
/* PNG through libpng, between an image and bytes in memory. libpng reports errors by longjmp. So variables that must
 * outlive a jump are in struct job, and functions that set the jump have no locals that change. */
#include "render/image/image.h"

#include "base/library.h"
#include "base/memory.h"

#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <stdio.h>
#include <string.h>

enum {
    LEVEL = 4,        /* with the rows' differences: a third of the time of libpng's defaults, a twelfth more bytes */
    MAX_RATIO = 1032, /* of deflate */
    SAMPLES = 1 << 16,
};

/* clang-format off */
#define PNG_FUNCTIONS(F)                                                                                               \
    F(png_, create_info_struct) F(png_, create_read_struct_2) F(png_, create_write_struct_2)                           \
    F(png_, destroy_read_struct) F(png_, destroy_write_struct) F(png_, error) F(png_, get_error_ptr)                   \
    F(png_, get_image_height) F(png_, get_image_width) F(png_, get_io_ptr) F(png_, get_mem_ptr) F(png_, get_rowbytes)  \
    F(png_, longjmp) F(png_, read_end) F(png_, read_image) F(png_, read_info) F(png_, read_update_info)                \
    F(png_, set_IHDR) F(png_, set_add_alpha) F(png_, set_compression_level) F(png_, set_expand_16) F(png_, set_filter) \
    F(png_, set_gray_to_rgb) F(png_, set_interlace_handling) F(png_, set_keep_unknown_chunks) F(png_, set_longjmp_fn)  \
    F(png_, set_pHYs) F(png_, set_read_fn) F(png_, set_sRGB) F(png_, set_swap) F(png_, set_user_limits)                \
    F(png_, set_write_fn) F(png_, write_end) F(png_, write_info) F(png_, write_row)
/* clang-format on */

LIBRARY_TABLE(libpng, PNG_FUNCTIONS);

#define JUMP_TARGET(png) (*libpng.set_longjmp_fn(png, longjmp, sizeof(jmp_buf))) /* png_jmpbuf() */

struct job {
    png_structp png;
    png_infop info;
    bool no_memory;
    char message[128];
    double dpi; /* written */
    struct buffer written;
    const uint8_t *data; /* read */
    size_t size, offset;
    uint8_t *rows; /* the whole picture in RGBA16 */
    uint8_t **row_pointers;
    conus_image *image;
};

static void jump(png_structp png, const char *message)
{
    struct job *job = libpng.get_error_ptr(png);
    snprintf(job->message, sizeof job->message, "%s", message);
    libpng.longjmp(png, 1);
}

static void ignore(png_structp png, const char *message)
{
    (void)png;
    (void)message;
}

static void *allocate(png_structp png, size_t size)
{
    struct job *job = libpng.get_mem_ptr(png);
    void *block = memory_raw(size, 1);
    job->no_memory = job->no_memory || !block;
    return block;
}

static void release(png_structp png, void *block)
{
    (void)png;
    memory_free(block);
}

static conus_status load_libpng(void)
{
    return library_load(&libpng, PNG_FUNCTIONS(LIBRARY_NAME), CONUS_PNG_FILE, "libpng16-16");
}

static conus_status fail_png(const struct job *job)
{
    return job->no_memory ? fail(CONUS_ERROR_MEMORY, "no memory for a PNG")
                          : fail(CONUS_ERROR_DATA, "PNG: %s", job->message);
}

static void write_bytes(png_structp png, png_bytep bytes, size_t size)
{
    struct job *job = libpng.get_io_ptr(png);
    buffer_append(&job->written, bytes, size);
    if (job->written.failed) {
        job->no_memory = true;
        libpng.error(png, "no memory");
    }
}

static void flush_nothing(png_structp png)
{
    (void)png;
}

static bool write_png(struct job *job, const uint8_t *rgba, uint32_t width, uint32_t height)
{
    if (setjmp(JUMP_TARGET(job->png))) {
        return false;
    }
    libpng.set_write_fn(job->png, job, write_bytes, flush_nothing);
    libpng.set_IHDR(job->png, job->info, width, height, 8, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE,
                    PNG_COMPRESSION_TYPE_BASE, PNG_FILTER_TYPE_BASE);
    libpng.set_filter(job->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    libpng.set_compression_level(job->png, LEVEL);
    libpng.set_sRGB(job->png, job->info, PNG_sRGB_INTENT_RELATIVE);
    if (job->dpi > 0) {
        png_uint_32 per_metre = (png_uint_32)lrint(job->dpi / 0.0254);
        libpng.set_pHYs(job->png, job->info, per_metre, per_metre, PNG_RESOLUTION_METER);
    }
    libpng.write_info(job->png, job->info);
    for (uint32_t y = 0; y < height; y++) {
        libpng.write_row(job->png, rgba + (size_t)y * width * 4);
    }
    libpng.write_end(job->png, NULL);
    return true;
}

static conus_status format_rows(struct bytes *out, const uint8_t *rgba, uint32_t width, uint32_t height, double dpi)
{
    struct job job = {.dpi = dpi};
    conus_status status = load_libpng();
    if (status) {
        return status;
    }
    job.png = libpng.create_write_struct_2(PNG_LIBPNG_VER_STRING, &job, jump, ignore, &job, allocate, release);
    job.info = job.png ? libpng.create_info_struct(job.png) : NULL;
    job.no_memory = !job.info;
    status = job.info && write_png(&job, rgba, width, height) ? CONUS_OK : fail_png(&job);
    libpng.destroy_write_struct(&job.png, &job.info);
    if (status) {
        buffer_finish(&job.written);
        return status;
    }
    *out = (struct bytes){(uint8_t *)job.written.data, job.written.size};
    return CONUS_OK;
}

conus_status image_format_png(struct bytes *out, const conus_image *image)
{
    if (image->png_rgba) {
        return format_rows(out, image->png_rgba, image->png_width, image->png_height, 0);
    }
    uint8_t *rgba = NULL;
    conus_status status = image_srgb_bytes(&rgba, image);
    status = status ? status : format_rows(out, rgba, image->width, image->height, image->dpi);
    memory_free(rgba);
    return status;
}

static void read_bytes(png_structp png, png_bytep bytes, size_t size)
{
    struct job *job = libpng.get_io_ptr(png);
    if (size > job->size - job->offset) {
        libpng.error(png, "file ends too early");
    }
    memcpy(bytes, job->data + job->offset, size);
    job->offset += size;
}

static bool read_head(struct job *job)
{
    if (setjmp(JUMP_TARGET(job->png))) {
        return false;
    }
    libpng.set_user_limits(job->png, IMAGE_MAX_SIDE, IMAGE_MAX_SIDE);
    /* else libpng allocates what they claim */
    libpng.set_keep_unknown_chunks(job->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
    libpng.set_read_fn(job->png, job, read_bytes);
    libpng.read_info(job->png, job->info);
    uint64_t unpacked =
        (uint64_t)libpng.get_rowbytes(job->png, job->info) * libpng.get_image_height(job->png, job->info);
    if (unpacked / MAX_RATIO > job->size) {
        libpng.error(job->png, "more pixels than a file of this size can hold");
    }
    libpng.set_expand_16(job->png); /* palette, few bits and transparent colours too */
    libpng.set_gray_to_rgb(job->png);
    libpng.set_add_alpha(job->png, 0xffff, PNG_FILLER_AFTER);
    libpng.set_swap(job->png);
    libpng.set_interlace_handling(job->png);
    libpng.read_update_info(job->png, job->info);
    return true;
}

static bool read_picture(struct job *job)
{
    if (setjmp(JUMP_TARGET(job->png))) {
        return false;
    }
    libpng.read_image(job->png, job->row_pointers);
    libpng.read_end(job->png, NULL);
    return true;
}

static conus_status allocate_rows(struct job *job)
{
    uint32_t width = libpng.get_image_width(job->png, job->info);
    uint32_t height = libpng.get_image_height(job->png, job->info);
    size_t row = libpng.get_rowbytes(job->png, job->info);
    if (row != (size_t)width * 8) {
        return fail(CONUS_ERROR_UNSUPPORTED, "PNG: %zu bytes in a row of %u pixels, 8 for each expected", row, width);
    }
    conus_status status = image_create_rgba(&job->image, width, height);
    if (status) {
        return status;
    }
    job->rows = memory_zeroed(height, row);
    job->row_pointers = job->rows ? memory_raw(height, sizeof *job->row_pointers) : NULL;
    if (!job->row_pointers) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t y = 0; y < height; y++) {
        job->row_pointers[y] = job->rows + y * row;
    }
    return CONUS_OK;
}

static conus_status convert_picture(struct job *job)
{
    float *linear = memory_raw(SAMPLES, sizeof *linear);
    if (!linear) {
        return CONUS_ERROR_MEMORY;
    }
    for (int i = 0; i < SAMPLES; i++) {
        linear[i] = (float)linear_from_srgb(i / 65535.0);
    }
    const struct image_rgba rgba = image_rgba(job->image);
    size_t count = (size_t)job->image->width * job->image->height;
    for (size_t i = 0; i < count; i++) {
        uint16_t pixel[4];
        memcpy(pixel, job->rows + 8 * i, sizeof pixel);
        float opacity = (float)pixel[3] / 65535;
        for (int c = 0; c < 3; c++) {
            rgba.plane[c][i] = linear[pixel[c]] * opacity;
        }
        rgba.plane[3][i] = opacity;
    }
    memory_free(linear);
    return CONUS_OK;
}

conus_status image_parse_png(conus_image **out, const uint8_t *data, size_t size)
{
    struct job job = {.data = data, .size = size};
    conus_status status = load_libpng();
    if (status) {
        return status;
    }
    job.png = libpng.create_read_struct_2(PNG_LIBPNG_VER_STRING, &job, jump, ignore, &job, allocate, release);
    job.info = job.png ? libpng.create_info_struct(job.png) : NULL;
    job.no_memory = !job.info;
    status = job.info && read_head(&job) ? allocate_rows(&job) : fail_png(&job);
    if (!status) {
        status = read_picture(&job) ? convert_picture(&job) : fail_png(&job);
    }
    libpng.destroy_read_struct(&job.png, &job.info, NULL);
    memory_free(job.rows);
    memory_free(job.row_pointers);
    if (status) {
        conus_image_destroy(job.image);
        return status;
    }
    *out = job.image;
    return CONUS_OK;
}
