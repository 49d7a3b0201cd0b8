/* SPDX-License-Identifier: BSD-3-Clause */
/* The Cryptomatte channels and manifest of an image of object numbers. */
#include "selection/picture/cryptomatte.h"

#include "base/buffer.h"
#include "base/memory.h"
#include "render/image/image.h"
#include "selection/picture/picture.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

#define LAYER "CryptoObject"

static uint32_t rotate(uint32_t x, int bits)
{
    return x << bits | x >> (32 - bits);
}

/* A. Appleby, MurmurHash3, x86 32-bit variant. */
static uint32_t murmur3(const char *text, size_t size)
{
    uint32_t hash = 0;
    for (size_t i = 0; i < size; i += 4) {
        uint32_t block = 0;
        size_t length = size - i < 4 ? size - i : 4;
        for (size_t k = 0; k < length; k++) {
            block |= (uint32_t)(unsigned char)text[i + k] << 8 * k;
        }
        hash ^= rotate(block * 0xcc9e2d51U, 15) * 0x1b873593U;
        if (length == 4) {
            hash = rotate(hash, 13) * 5 + 0xe6546b64U;
        }
    }
    hash ^= (uint32_t)size;
    hash = (hash ^ hash >> 16) * 0x85ebca6bU;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35U;
    return hash ^ hash >> 16;
}

uint32_t cryptomatte_hash(const char *name)
{
    uint32_t hash = murmur3(name, strlen(name));
    uint32_t exponent = hash >> 23 & 255;
    return exponent == 0 || exponent == 255 ? hash ^ 1U << 23 : hash;
}

/* Objects hit anywhere in the image, and what each is called there. */
struct layer {
    json_t *manifest;  /* {"name": "8 hexadecimal digits"} */
    uint32_t *hash_of; /* [object_count + 1]; 0 = not named yet */
};

static conus_status name_object(struct layer *layer, const conus_object *object, uint32_t number)
{
    char hexadecimal[9];
    size_t size = strlen(object->name) + 16;
    char *name = memory_raw(size, 1);
    if (!name) {
        return CONUS_ERROR_MEMORY;
    }
    snprintf(name, size, "%s", object->name);
    if (json_object_get(layer->manifest, name)) {
        snprintf(name, size, "%s (%u)", object->name, object->label);
    }
    layer->hash_of[number] = cryptomatte_hash(name);
    snprintf(hexadecimal, sizeof hexadecimal, "%08x", layer->hash_of[number]);
    int kept = json_object_set_new(layer->manifest, name, json_string(hexadecimal));
    memory_free(name);
    return kept ? fail(CONUS_ERROR_MEMORY, "no memory for the names in the image") : CONUS_OK;
}

static void fill_channels(conus_image *image, const struct layer *layer, const conus_selection *selection)
{
    float *id = image_find(image, LAYER "00.R")->floats;
    float *coverage = image_find(image, LAYER "00.G")->floats;
    for (size_t to = 0; to < (size_t)image->width * image->height; to++) {
        uint32_t number = selection->evidence.object[picture_flipped(selection->evidence.resolution, to)];
        memcpy(&id[to], &layer->hash_of[number], sizeof id[to]);
        coverage[to] = number ? 1 : 0;
    }
}

static int append(const char *text, size_t size, void *buffer)
{
    buffer_append(buffer, text, size);
    return 0;
}

static conus_status add_attributes(conus_image *image, const struct layer *layer)
{
    char key[8];
    char name[64];
    struct buffer manifest = {0};
    snprintf(key, sizeof key, "%07x", cryptomatte_hash(LAYER) >> 4);
    bool whole = json_dump_callback(layer->manifest, append, &manifest, JSON_COMPACT) == 0;
    conus_status status = whole ? buffer_status(&manifest) : fail(CONUS_ERROR_MEMORY, "no memory for the names");
    const char *const pairs[][2] = {
        {"name", LAYER}, {"hash", "MurmurHash3_32"}, {"conversion", "uint32_to_float32"}, {"manifest", manifest.data}};
    for (size_t i = 0; !status && i < sizeof pairs / sizeof pairs[0]; i++) {
        snprintf(name, sizeof name, "cryptomatte/%s/%s", key, pairs[i][0]);
        status = image_add_text(image, name, pairs[i][1]);
    }
    buffer_finish(&manifest);
    return status;
}

conus_status cryptomatte_add(conus_image *image, const conus_selection *selection)
{
    struct layer layer = {.manifest = json_object(),
                          .hash_of = memory_zeroed(selection->atlas->object_count + 1, sizeof *layer.hash_of)};
    conus_status status = layer.manifest && layer.hash_of ? CONUS_OK : CONUS_ERROR_MEMORY;
    const struct evidence *evidence = &selection->evidence;
    for (size_t i = 0; !status && i < (size_t)evidence->resolution * evidence->resolution; i++) {
        uint32_t number = evidence->object[i];
        if (number && !layer.hash_of[number]) {
            status = name_object(&layer, conus_atlas_object(selection->atlas, number), number);
        }
    }
    static const char *const names[] = {LAYER "00.R", LAYER "00.G", LAYER "00.B", LAYER "00.A"};
    for (size_t c = 0; !status && c < 4; c++) {
        struct image_channel *channel; /* which lasts only until the next is added */
        status = image_add_channel(image, names[c], IMAGE_FLOAT, &channel);
    }
    if (!status) {
        fill_channels(image, &layer, selection);
        status = add_attributes(image, &layer);
    }
    json_decref(layer.manifest);
    memory_free(layer.hash_of);
    return status;
}
