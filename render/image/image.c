/* SPDX-License-Identifier: BSD-3-Clause */
/* Images in memory: their channels and attributes. */
#include "render/image/image.h"

#include "base/memory.h"
#include "conus/own.h"
#include "render/draw/draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

conus_status image_create(conus_image **out, uint32_t width, uint32_t height)
{
    if (width < 1 || height < 1 || width > IMAGE_MAX_SIDE || height > IMAGE_MAX_SIDE) {
        return fail(CONUS_ERROR_DATA, "image of %u x %u pixels, allowed are 1 to %u each", width, height,
                    IMAGE_MAX_SIDE);
    }
    conus_image *image = memory_zeroed(1, sizeof *image);
    if (!image) {
        return CONUS_ERROR_MEMORY;
    }
    image->width = width;
    image->height = height;
    *out = image;
    return CONUS_OK;
}

void conus_image_destroy(conus_image *image)
{
    if (!image) {
        return;
    }
    for (size_t i = 0; i < image->channel_count; i++) {
        memory_free(image->channels[i].floats);
    }
    for (size_t i = 0; i < image->attribute_count; i++) {
        memory_free(image->attributes[i].name);
        memory_free(image->attributes[i].text);
    }
    memory_free(image->channels);
    memory_free(image->attributes);
    memory_free(image->png_rgba);
    draw_list_destroy(image->list);
    bytes_finish(&image->encoded);
    memory_free(image);
}

conus_status image_add_channel(conus_image *image, const char *name, enum image_type type, struct image_channel **out)
{
    size_t length = strlen(name);
    if (!length || length >= sizeof image->channels->name) {
        return fail(CONUS_ERROR_UNSUPPORTED, "channel name %.64s of %zu bytes, allowed are 1 to %zu", name, length,
                    sizeof image->channels->name - 1);
    }
    if (image_find(image, name)) {
        return fail(CONUS_ERROR_DATA, "two channels called %s", name);
    }
    uint64_t bytes = (uint64_t)image->width * image->height * sizeof(float);
    if (bytes * (image->channel_count + 1) > IMAGE_MAX_BYTES) {
        return fail(CONUS_ERROR_MEMORY, "image of %u x %u pixels and more than %zu channels, allowed are %llu bytes",
                    image->width, image->height, image->channel_count, (unsigned long long)IMAGE_MAX_BYTES);
    }
    struct image_channel *longer = memory_resize(image->channels, image->channel_count + 1, sizeof *longer);
    if (!longer) {
        return CONUS_ERROR_MEMORY;
    }
    image->channels = longer;
    struct image_channel channel = {.type = type,
                                    .floats = memory_zeroed((size_t)image->width * image->height, sizeof(float))};
    if (!channel.floats) {
        return CONUS_ERROR_MEMORY;
    }
    snprintf(channel.name, sizeof channel.name, "%s", name);
    longer[image->channel_count++] = channel;
    if (out) {
        *out = &longer[image->channel_count - 1];
    }
    return CONUS_OK;
}

conus_status image_create_rgba(conus_image **out, uint32_t width, uint32_t height)
{
    conus_image *image = NULL;
    conus_status status = image_create(&image, width, height);
    for (const char *name = "RGBA"; !status && *name; name++) {
        status = image_add_channel(image, (char[]){*name, '\0'}, IMAGE_FLOAT, NULL);
    }
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

conus_status image_create_listed(conus_image **out, uint32_t width, uint32_t height)
{
    conus_image *image = NULL;
    conus_status status = image_create_rgba(&image, width, height);
    status = status ? status : draw_list_create(&image->list, width, height);
    if (status) {
        conus_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

conus_status image_paint(conus_image *image)
{
    const struct image_rgba rgba = image_rgba(image);
    conus_status status = draw_paint(rgba.plane, image->list);
    draw_list_destroy(image->list);
    image->list = NULL;
    return status;
}

struct image_attribute *image_find_attribute(const conus_image *image, const char *name)
{
    for (size_t i = 0; i < image->attribute_count; i++) {
        if (strcmp(image->attributes[i].name, name) == 0) {
            return &image->attributes[i];
        }
    }
    return NULL;
}

/* The attribute called `name`, put in as an empty one if it is new. */
static struct image_attribute *attribute_at(conus_image *image, const char *name)
{
    struct image_attribute *attribute = image_find_attribute(image, name);
    if (attribute) {
        return attribute;
    }
    struct image_attribute *attributes =
        memory_resize(image->attributes, image->attribute_count + 1, sizeof *attributes);
    char *copy = attributes ? memory_text(name, strlen(name)) : NULL;
    image->attributes = attributes ? attributes : image->attributes;
    if (!copy) {
        return NULL;
    }
    attributes[image->attribute_count] = (struct image_attribute){.name = copy};
    return &attributes[image->attribute_count++];
}

conus_status image_add_text(conus_image *image, const char *name, const char *text)
{
    char *copy = memory_text(text, strlen(text));
    struct image_attribute *attribute = copy ? attribute_at(image, name) : NULL;
    if (!attribute) {
        memory_free(copy);
        return CONUS_ERROR_MEMORY;
    }
    memory_free(attribute->text);
    attribute->text = copy;
    attribute->is_matrix = false;
    return CONUS_OK;
}

conus_status image_add_matrix(conus_image *image, const char *name, const double matrix[16])
{
    struct image_attribute *attribute = attribute_at(image, name);
    if (!attribute) {
        return CONUS_ERROR_MEMORY;
    }
    memory_free(attribute->text);
    attribute->text = NULL;
    attribute->is_matrix = true;
    memcpy(attribute->matrix, matrix, sizeof attribute->matrix);
    return CONUS_OK;
}

struct image_channel *image_find(const conus_image *image, const char *name)
{
    for (size_t i = 0; image && i < image->channel_count; i++) {
        if (strcmp(image->channels[i].name, name) == 0) {
            return &image->channels[i];
        }
    }
    return NULL;
}

struct image_rgba image_rgba(const conus_image *image)
{
    static const char *const names[] = {"R", "G", "B", "A"};
    struct image_rgba rgba;
    for (int i = 0; i < 4; i++) {
        struct image_channel *channel = image_find(image, names[i]);
        rgba.plane[i] = channel && channel->type == IMAGE_FLOAT ? channel->floats : NULL;
    }
    return rgba;
}

uint32_t conus_image_width(const conus_image *image)
{
    return image ? image->width : 0;
}

uint32_t conus_image_height(const conus_image *image)
{
    return image ? image->height : 0;
}

const char *conus_image_channel(const conus_image *image, size_t index)
{
    return image && index < image->channel_count ? image->channels[index].name : NULL;
}

const char *conus_image_legend(const conus_image *image)
{
    const struct image_attribute *found = image ? image_find_attribute(image, IMAGE_LEGEND) : NULL;
    return found && found->text ? found->text : "";
}

const float *conus_image_floats(const conus_image *image, const char *channel)
{
    const struct image_channel *found = image_find(image, channel);
    return found && found->type == IMAGE_FLOAT ? found->floats : NULL;
}

const uint32_t *conus_image_uints(const conus_image *image, const char *channel)
{
    const struct image_channel *found = image_find(image, channel);
    return found && found->type == IMAGE_UINT ? found->uints : NULL;
}

/* A channel that both images have. */
struct pair {
    const struct image_channel *a, *b;
    double sum_of_squares;
};

static const char *type_name(enum image_type type)
{
    return type == IMAGE_UINT ? "uint32" : "float";
}

/* Whether every channel of `a` is in `b`, too; then `pairs` (unless NULL) holds them. */
static conus_status pair_channels(struct pair *pairs, const conus_image *a, const conus_image *b, const char *lacking)
{
    for (size_t i = 0; i < a->channel_count; i++) {
        const struct image_channel *channel = &a->channels[i];
        const struct image_channel *other = image_find(b, channel->name);
        if (!other) {
            return fail(CONUS_ERROR_ARGUMENT, "channel %s is not in the %s image", channel->name, lacking);
        }
        if (other->type != channel->type) {
            return fail(CONUS_ERROR_ARGUMENT, "channel %s is %s in one image and %s in the other", channel->name,
                        type_name(channel->type), type_name(other->type));
        }
        if (pairs) {
            pairs[i] = (struct pair){.a = channel, .b = other};
        }
    }
    return CONUS_OK;
}

static double difference_at(const struct pair *pair, size_t pixel)
{
    if (pair->a->type == IMAGE_UINT) {
        return fabs((double)pair->a->uints[pixel] - (double)pair->b->uints[pixel]);
    }
    double a = (double)pair->a->floats[pixel];
    double b = (double)pair->b->floats[pixel];
    if (a == b || (isnan(a) && isnan(b))) {
        return 0;
    }
    return isfinite(a) && isfinite(b) ? fabs(a - b) : INFINITY;
}

conus_status conus_image_compare(conus_image_difference *out, const conus_image *a, const conus_image *b,
                                 double tolerance)
{
    if (!(tolerance >= 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "tolerance: %g, allowed is 0 or more", tolerance);
    }
    if (a->width != b->width || a->height != b->height) {
        return fail(CONUS_ERROR_ARGUMENT, "images of %u x %u and %u x %u pixels cannot be compared", a->width,
                    a->height, b->width, b->height);
    }
    struct pair *pairs = memory_zeroed(a->channel_count, sizeof *pairs);
    if (!pairs) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = pair_channels(pairs, a, b, "second");
    status = status ? status : pair_channels(NULL, b, a, "first");
    if (!status) {
        conus_image_difference difference = {.pixels = (uint64_t)a->width * a->height};
        for (size_t pixel = 0; pixel < difference.pixels; pixel++) {
            bool differs = false;
            for (size_t c = 0; c < a->channel_count; c++) {
                double d = difference_at(&pairs[c], pixel);
                pairs[c].sum_of_squares += d * d;
                differs = differs || d > (pairs[c].a->type == IMAGE_UINT ? 0 : tolerance);
                if (d > difference.max_difference) {
                    difference.max_difference = d;
                    memcpy(difference.channel, pairs[c].a->name, sizeof difference.channel);
                    difference.x = (uint32_t)pixel; /* of the whole image, until the end */
                }
            }
            difference.differing += differs;
        }
        for (size_t c = 0; c < a->channel_count; c++) {
            difference.rms = fmax(difference.rms, sqrt(pairs[c].sum_of_squares / (double)difference.pixels));
        }
        difference.y = difference.x / a->width;
        difference.x %= a->width;
        *out = difference;
    }
    memory_free(pairs);
    return status;
}
