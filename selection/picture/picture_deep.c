/* SPDX-License-Identifier: BSD-3-Clause */
/* Everything in the cone as a deep image: a sample for each interval of a pixel's ray inside an object. */
#include "base/buffer.h"
#include "base/memory.h"
#include "base/order.h"
#include "render/image/deep_image.h"
#include "render/image/id_manifest.h"
#include "selection/picture/picture.h"

#include <stdio.h>
#include <stdlib.h>

enum { A, Z, Z_BACK, ID, OBJECT, T, T_BACK, CHANNEL_COUNT };

static const char *const CHANNELS[CHANNEL_COUNT] = {"A", "Z", "ZBack", "id", "object", "t", "tBack"};

/* `next` has the first sample of each pixel of the image. */
static void fill_channels(struct deep_image *image, const conus_selection *selection, size_t *next)
{
    uint32_t n = selection->cone.resolution;
    for (size_t i = 0; i < selection->layers.count; i++) {
        const conus_interval *interval = &selection->layers.intervals[i];
        double per_depth = cone_per_depth(&selection->cone, interval->pixel % n, interval->pixel / n);
        size_t sample = next[picture_flipped(n, interval->pixel)]++;
        image->channels[ID].uints[sample] = conus_atlas_object(selection->atlas, interval->object)->label;
        image->channels[OBJECT].uints[sample] = interval->object;
        image->channels[Z].floats[sample] = (float)(interval->entry / per_depth);
        image->channels[Z_BACK].floats[sample] = (float)(interval->exit / per_depth);
        image->channels[T].floats[sample] = (float)interval->entry;
        image->channels[T_BACK].floats[sample] = (float)interval->exit;
        image->channels[A].floats[sample] = 1;
    }
}

/* An object in the image. */
struct named {
    uint32_t number;
    const conus_object *object;
};

static struct named *list_objects(size_t *count, const conus_selection *selection)
{
    const conus_atlas *atlas = selection->atlas;
    struct named *named = memory_raw(atlas->object_count, sizeof *named);
    bool *present = memory_zeroed(atlas->object_count + 1, sizeof *present);
    if (!named || !present) {
        memory_free(named);
        memory_free(present);
        return NULL;
    }
    for (size_t i = 0; i < selection->layers.count; i++) {
        present[selection->layers.intervals[i].object] = true;
    }
    *count = 0;
    for (uint32_t number = 1; number <= atlas->object_count; number++) {
        if (present[number]) {
            named[(*count)++] = (struct named){number, conus_atlas_object(atlas, number)};
        }
    }
    memory_free(present);
    return named;
}

static int by_label(const void *a, const void *b)
{
    return compare_unsigned(((const struct named *)a)->object->label, ((const struct named *)b)->object->label);
}

/* Room for the tables of a manifest: of objects, and of labels, which are no more. */
struct names {
    uint32_t *numbers, *labels; /* [count] */
    const char **of_numbers;    /* [3 * count] name, label, kind */
    const char **of_labels;     /* [count] */
    char (*digits)[12];         /* [count] labels of the objects as texts */
    struct buffer *joined;      /* [count] names of labels */
};

static void names_finish(struct names *names, size_t count)
{
    for (size_t i = 0; names->joined && i < count; i++) {
        buffer_finish(&names->joined[i]);
    }
    memory_free(names->joined);
    memory_free(names->numbers);
    memory_free(names->labels);
    memory_free(names->of_numbers);
    memory_free(names->of_labels);
    memory_free(names->digits);
}

static conus_status names_init(struct names *out, size_t count)
{
    *out = (struct names){.numbers = memory_raw(count, sizeof *out->numbers),
                          .labels = memory_raw(count, sizeof *out->labels),
                          .of_numbers = memory_raw(3 * count, sizeof *out->of_numbers),
                          .of_labels = memory_raw(count, sizeof *out->of_labels),
                          .digits = memory_raw(count, sizeof *out->digits),
                          .joined = memory_zeroed(count, sizeof *out->joined)};
    if (!out->numbers || !out->labels || !out->of_numbers || !out->of_labels || !out->digits || !out->joined) {
        names_finish(out, count);
        return CONUS_ERROR_MEMORY;
    }
    return CONUS_OK;
}

/* Names for the labels of `named`, which is sorted by them; gives how many in *labels. */
static conus_status name_labels(struct names *names, size_t *labels, const struct named *named, size_t count)
{
    conus_status status = CONUS_OK;
    *labels = 0;
    for (size_t i = 0; i < count && !status; i++) {
        const conus_object *object = named[i].object;
        const bool is_new = i == 0 || named[i - 1].object->label != object->label;
        *labels += is_new;
        struct buffer *name = &names->joined[*labels - 1];
        /* "Hippocampus / fornix": an area and a pathway may have one label. */
        buffer_format(name, "%s%s", is_new ? "" : " / ", object->name);
        names->labels[*labels - 1] = object->label;
        names->of_labels[*labels - 1] = name->data;
        status = buffer_status(name);
    }
    return status;
}

static conus_status format_names(struct bytes *out, struct names *names, struct named *named, size_t count)
{
    static const char *const components[] = {"name", "label", "kind"};
    size_t labels = 0;
    order_sort(named, count, sizeof *named, by_label);
    conus_status status = name_labels(names, &labels, named, count);
    if (status) {
        return status;
    }
    const struct id_manifest_group groups[] = {
        {"id", components, 1, names->labels, labels, names->of_labels},
        {"object", components, 3, names->numbers, count, names->of_numbers},
    };
    return id_manifest_format(out, groups, sizeof groups / sizeof groups[0]);
}

static conus_status add_names(struct deep_image *image, const conus_selection *selection)
{
    size_t count = 0;
    struct names names;
    struct named *named = list_objects(&count, selection);
    if (!named) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = names_init(&names, count);
    if (!status) {
        for (size_t i = 0; i < count; i++) {
            names.numbers[i] = named[i].number;
            names.of_numbers[3 * i] = named[i].object->name;
            names.of_numbers[3 * i + 1] = names.digits[i];
            snprintf(names.digits[i], sizeof names.digits[i], "%u", named[i].object->label);
            names.of_numbers[3 * i + 2] = atlas_kind_word(named[i].object->kind);
        }
        status = format_names(&image->manifest, &names, named, count);
        names_finish(&names, count);
    }
    memory_free(named);
    return status;
}

static conus_status create_image(struct deep_image **out, const conus_selection *selection)
{
    struct deep_image *image = NULL;
    const uint32_t n = selection->cone.resolution;
    const size_t pixels = (size_t)n * n;
    uint32_t *counts = memory_zeroed(pixels, sizeof *counts);
    size_t *first = memory_zeroed(pixels + 1, sizeof *first);
    const bool fits = counts && first;
    for (size_t i = 0; fits && i < selection->layers.count; i++) {
        counts[picture_flipped(n, selection->layers.intervals[i].pixel)]++;
    }
    for (size_t p = 0; fits && p < pixels; p++) {
        first[p + 1] = first[p] + counts[p];
    }
    conus_status status = fits ? deep_image_create(&image, n, n, counts) : CONUS_ERROR_MEMORY;
    for (int c = 0; !status && c < CHANNEL_COUNT; c++) {
        struct image_channel *channel = NULL;
        status =
            deep_image_add_channel(image, CHANNELS[c], c == ID || c == OBJECT ? IMAGE_UINT : IMAGE_FLOAT, &channel);
    }
    if (!status) {
        fill_channels(image, selection, first);
        status = add_names(image, selection);
    }
    status = status ? status : picture_add_selection(image->header, selection);
    memory_free(counts);
    memory_free(first);
    if (status) {
        deep_image_destroy(image);
        return status;
    }
    *out = image;
    return CONUS_OK;
}

conus_status conus_selection_write_deep(const conus_selection *selection, const char *path)
{
    struct deep_image *image = NULL;
    struct bytes bytes = {0};
    if (selection->region.shape == REGION_BALL) {
        return fail(CONUS_ERROR_ARGUMENT, "deep image: of a ball, which has no pixels");
    }
    if (!selection->has_layers) {
        return fail(CONUS_ERROR_ARGUMENT, "deep image: of what is visible only, a selection of all layers is needed");
    }
    conus_status status = create_image(&image, selection);
    if (!status) {
        status = deep_image_format(&bytes, image);
        status = status ? fail_in(status, path) : file_write(path, bytes.data, bytes.size);
    }
    bytes_finish(&bytes);
    deep_image_destroy(image);
    return status;
}
