/* SPDX-License-Identifier: BSD-3-Clause */
/* Deep images in memory, and as deep OpenEXR. The C library takes deep chunks packed, so ZIPS compression is done
 * here. */
#include "render/image/deep_image.h"

#include "base/memory.h"
#include "render/image/exr_stream.h"

#include <string.h>
#include <zlib.h>

static uint64_t samples_of_row(const uint32_t *counts, uint32_t width, uint32_t y)
{
    uint64_t sum = 0;
    for (uint32_t x = 0; x < width; x++) {
        sum += counts[(size_t)y * width + x];
    }
    return sum;
}

conus_status deep_image_create(struct deep_image **out, uint32_t width, uint32_t height, const uint32_t *counts)
{
    size_t pixels = (size_t)width * height;
    struct deep_image *image = memory_zeroed(1, sizeof *image);
    if (!image) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = image_create(&image->header, width, height);
    for (uint32_t y = 0; y < height && !status; y++) {
        uint64_t row = samples_of_row(counts, width, y);
        if (row > INT32_MAX) {
            status = fail(CONUS_ERROR_UNSUPPORTED, "row of %llu deep samples, allowed are %d", (unsigned long long)row,
                          INT32_MAX);
        }
        image->sample_count += row;
    }
    image->counts = status ? NULL : memory_raw(pixels, sizeof *counts);
    if (!image->counts) {
        deep_image_destroy(image);
        return status ? status : CONUS_ERROR_MEMORY;
    }
    memcpy(image->counts, counts, pixels * sizeof *counts);
    *out = image;
    return CONUS_OK;
}

void deep_image_destroy(struct deep_image *image)
{
    if (!image) {
        return;
    }
    for (size_t i = 0; i < image->channel_count; i++) {
        memory_free(image->channels[i].floats);
    }
    memory_free(image->channels);
    memory_free(image->counts);
    bytes_finish(&image->manifest);
    conus_image_destroy(image->header);
    memory_free(image);
}

conus_status deep_image_add_channel(struct deep_image *image, const char *name, enum image_type type,
                                    struct image_channel **out)
{
    conus_status status =
        image_append_channel(&image->channels, &image->channel_count, name, type, image->sample_count);
    if (status) {
        return status;
    }
    size_t at = image->channel_count - 1;
    const struct image_channel added = image->channels[at];
    for (; at > 0 && strcmp(image->channels[at - 1].name, name) > 0; at--) {
        image->channels[at] = image->channels[at - 1];
    }
    image->channels[at] = added;
    *out = &image->channels[at];
    return CONUS_OK;
}

enum {
    ZIP_LEVEL = 4, /* OpenEXR's own */
    DEEP_VERSION = 1,
};

static void put_u32(uint8_t *out, uint32_t value)
{
    for (int i = 0; i < 4; i++) {
        out[i] = (uint8_t)(value >> 8 * i);
    }
}

/* Buffers for one row: as it is, filtered, and packed. */
struct row {
    uint8_t *plain, *filtered;
    struct packed {
        uint8_t *data;
        uint64_t size;
    } counts, samples;
};

static void row_finish(struct row *row)
{
    memory_free(row->plain);
    memory_free(row->filtered);
    memory_free(row->counts.data);
    memory_free(row->samples.data);
}

static exr_result_t row_init(struct row *out, const struct deep_image *image)
{
    uint64_t largest = 0;
    for (uint32_t y = 0; y < image->header->height; y++) {
        uint64_t samples = samples_of_row(image->counts, image->header->width, y);
        largest = samples > largest ? samples : largest;
    }
    size_t counts = sizeof(uint32_t) * image->header->width;
    size_t samples = (size_t)largest * sizeof(uint32_t) * image->channel_count;
    size_t plain = counts > samples ? counts : samples;
    *out = (struct row){.plain = memory_raw(plain, 1),
                        .filtered = memory_raw(plain, 1),
                        .counts = {memory_raw(compressBound(counts), 1), 0},
                        .samples = {memory_raw(compressBound(samples), 1), 0}};
    return out->plain && out->filtered && out->counts.data && out->samples.data ? EXR_ERR_SUCCESS
                                                                                : EXR_ERR_OUT_OF_MEMORY;
}

/* ZIPS of `size` bytes of row->plain: even bytes, then odd ones, each as its difference to the one before, deflated. Or
 * the bytes themselves if that is no shorter. */
static exr_result_t deflate_row(struct packed *out, const struct row *row, size_t size)
{
    uLongf packed = compressBound(size);
    uint8_t *filtered = row->filtered;
    for (size_t i = 0; i < size; i++) {
        filtered[i % 2 ? (size + 1) / 2 + i / 2 : i / 2] = row->plain[i];
    }
    for (size_t i = size; i-- > 1;) {
        filtered[i] = (uint8_t)(filtered[i] - filtered[i - 1] + 128);
    }
    if (size > 0 && compress2(out->data, &packed, filtered, size, ZIP_LEVEL) != Z_OK) {
        return EXR_ERR_OUT_OF_MEMORY;
    }
    bool shorter = size > 0 && packed < size;
    if (!shorter) {
        memcpy(out->data, row->plain, size);
    }
    out->size = shorter ? packed : size;
    return EXR_ERR_SUCCESS;
}

/* The table of a row: how many samples its pixels have, up to and with each. */
static exr_result_t pack_counts(struct row *row, const struct deep_image *image, uint32_t y)
{
    uint32_t width = image->header->width;
    uint32_t sum = 0;
    for (uint32_t x = 0; x < width; x++) {
        sum += image->counts[(size_t)y * width + x];
        put_u32(row->plain + sizeof sum * x, sum);
    }
    return deflate_row(&row->counts, row, sizeof sum * width);
}

/* The row's samples, channel by channel. */
static exr_result_t pack_samples(struct row *row, const struct deep_image *image, size_t first, size_t count)
{
    uint8_t *out = row->plain;
    for (size_t c = 0; c < image->channel_count; c++) {
        for (size_t i = 0; i < count; i++, out += sizeof(uint32_t)) {
            put_u32(out, image->channels[c].uints[first + i]);
        }
    }
    return deflate_row(&row->samples, row, (size_t)(out - row->plain));
}

/* Declares the attribute first: else exr_attr_set_user() of 3.1.5 crashes where there is no memory for it. OpenEXR's
 * C++ library 3.1.5 reads an `idmanifest` four bytes too far and so damages the name of the next attribute: a comment
 * comes next, lest it be the count of chunks. */
static exr_result_t write_manifest(exr_context_t file, const struct bytes *names)
{
    static const char name[] = "idManifest";
    static const char type[] = "idmanifest";
    exr_attribute_t *attribute = NULL;
    exr_result_t code = openexr.attr_declare_by_type(file, 0, name, type, &attribute);
    if (!code && !attribute) {
        code = EXR_ERR_OUT_OF_MEMORY;
    }
    code = code ? code : openexr.attr_set_user(file, 0, name, type, (int32_t)names->size, names->data);
    return code ? code : openexr.attr_set_string(file, 0, "comments", "idManifest names the numbers in its channels");
}

static exr_result_t write_header(exr_context_t file, const struct deep_image *image)
{
    size_t pixels = (size_t)image->header->width * image->header->height;
    uint32_t most = 0;
    for (size_t i = 0; i < pixels; i++) {
        most = image->counts[i] > most ? image->counts[i] : most;
    }
    int part;
    exr_result_t code = openexr.add_part(file, "conus", EXR_STORAGE_DEEP_SCANLINE, &part);
    code = code ? code
                : openexr.initialize_required_attr_simple(file, part, (int32_t)image->header->width,
                                                          (int32_t)image->header->height, EXR_COMPRESSION_ZIPS);
    code = code ? code : openexr.set_version(file, part, DEEP_VERSION);
    code = code ? code : openexr.attr_set_int(file, part, "maxSamplesPerPixel", (int32_t)most);
    for (size_t i = 0; !code && i < image->channel_count; i++) {
        const struct image_channel *channel = &image->channels[i];
        code =
            openexr.add_channel(file, 0, channel->name, channel->type == IMAGE_FLOAT ? EXR_PIXEL_FLOAT : EXR_PIXEL_UINT,
                                EXR_PERCEPTUALLY_LINEAR, 1, 1);
    }
    code = code ? code : exr_stream_attributes(file, image->header);
    if (!code && image->manifest.data) {
        code = write_manifest(file, &image->manifest);
    }
    return code ? code : openexr.write_header(file);
}

conus_status deep_image_format(struct bytes *out, const struct deep_image *image)
{
    struct exr_stream stream = {0};
    exr_context_t file = NULL;
    exr_result_t code = exr_stream_write(&file, &stream);
    code = code ? code : write_header(file, image);
    struct row row = {0};
    code = code ? code : row_init(&row, image);
    size_t first = 0;
    for (uint32_t y = 0; !code && y < image->header->height; y++) {
        size_t count = (size_t)samples_of_row(image->counts, image->header->width, y);
        code = pack_counts(&row, image, y);
        code = code ? code : pack_samples(&row, image, first, count);
        code = code ? code
                    : openexr.write_deep_scanline_chunk(file, 0, (int)y, row.samples.data, row.samples.size,
                                                        count * image->channel_count * sizeof(uint32_t),
                                                        row.counts.data, row.counts.size);
        first += count;
    }
    row_finish(&row);
    return exr_stream_end(out, file, &stream, code);
}
