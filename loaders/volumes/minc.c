/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads MINC 2 ("MINC 2.0 File Format Reference", McConnell Brain Imaging Centre; nibabel's minc2.py). */
#include "loaders/volumes/minc.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SPACE = 3, SWAPPED = !BIG_ENDIAN_IS_SWAPPED, BLOCK = 4096 };

/* How far from a whole number a label may be that a scale made: stored steps are not as fine as its numbers. */
static const double label_slack = 1e-3;

#define IMAGE "/minc-2.0/image/0/"
#define DIMENSIONS "/minc-2.0/dimensions/"

void minc_finish(struct minc *minc)
{
    hdf5_destroy(minc->hdf5);
    memory_free(minc->scales);
    *minc = (struct minc){0};
}

/* The attribute as @p count numbers; false where it is anything else. */
static bool get_numbers(double *out, const struct hdf5_object *object, const char *name, size_t count)
{
    const struct hdf5_value *value = hdf5_attribute(object, name);
    bool fine = value && hdf5_is_number(value) && value->count == count;
    for (size_t i = 0; fine && i < count; i++) {
        out[i] = hdf5_number(value, i);
        fine = isfinite(out[i]);
    }
    return fine;
}

/* The attribute as a text without the space around it; "" where there is none. */
static struct text get_text(const struct hdf5_object *object, const char *name)
{
    return text_trim(hdf5_text(hdf5_attribute(object, name)));
}

/* Adds axis @p column of the voxels to the transform: the dimension @p object, of so many voxels. */
static conus_status add_axis(double world[16], size_t column, const struct hdf5_object *object, uint64_t length)
{
    static const struct {
        const char *name, *wanted;
    } words[] = {{"spacing", "regular__"}, {"units", "mm"}, {"alignment", "centre"}};
    double start;
    double step;
    double counted;
    double cosines[SPACE];
    struct text name = hdf5_last_name(object->value.name);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        struct text found = get_text(object, words[i].name);
        if (found.size && !text_equal(found, words[i].wanted)) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%.*s: %s: found \"%.*s\", allowed is \"%s\"", TEXT_SHOW(name, 40U),
                        words[i].name, TEXT_SHOW(found, 40U), words[i].wanted);
        }
    }
    if (!get_numbers(&start, object, "start", 1) || !get_numbers(&step, object, "step", 1)) {
        return fail(CONUS_ERROR_DATA, "%.*s: start and step: a number each is needed", TEXT_SHOW(name, 40U));
    }
    if (get_numbers(&counted, object, "length", 1) && counted != (double)length) {
        return fail(CONUS_ERROR_DATA, "%.*s: length: found %g, the image has %llu", TEXT_SHOW(name, 40U), counted,
                    (unsigned long long)length);
    }
    if (!hdf5_attribute(object, "direction_cosines")) {
        memset(cosines, 0, sizeof cosines);
        cosines[name.data[0] - 'x'] = 1;
    } else if (!get_numbers(cosines, object, "direction_cosines", SPACE) ||
               !(fabs(vec3_length(cosines) - 1) <= 0.01)) { /* libminc writes 6 digits and more */
        return fail(CONUS_ERROR_DATA, "%.*s: direction_cosines: three numbers of length 1 are needed",
                    TEXT_SHOW(name, 40U));
    }
    vec3_scale(world + 4 * column, cosines, step);
    vec3_add_scaled(world + 12, world + 12, start, cosines); /* it counts along the cosines */
    return CONUS_OK;
}

/* The transform and dimensions, by the names in dimorder, the slowest first. */
static conus_status take_axes(double world[16], int64_t dim[7], const struct hdf5 *hdf5,
                              const struct hdf5_object *image)
{
    static const char *const names[] = {"xspace", "yspace", "zspace"};
    struct text order = get_text(image, "dimorder");
    struct text name;
    size_t seen[SPACE] = {0};
    size_t found = 0;
    size_t axis = 0;
    bool more = true;
    mat4_identity(world);
    for (; text_field(&order, ',', &more, &name); axis++) {
        name = text_trim(name);
        size_t which = 0;
        while (which < SPACE && !text_equal(name, names[which])) {
            which++;
        }
        const uint64_t length = axis < image->value.rank ? image->value.dims[axis] : 0;
        if (which == SPACE && !(text_equal(name, "time") && length == 1)) {
            return fail(CONUS_ERROR_UNSUPPORTED,
                        "dimorder: found %.*s of %llu, allowed are xspace, yspace and zspace, and one time",
                        TEXT_SHOW(name, 40U), (unsigned long long)length);
        }
        if (which == SPACE) {
            continue;
        }
        const struct hdf5_object *object =
            hdf5_find_in(hdf5, (struct text){DIMENSIONS, sizeof DIMENSIONS - 2}, names[which]);
        if (seen[which]++ || !object || length < 1) {
            return fail(CONUS_ERROR_DATA, "%s: needed is one of at least one voxel, in " DIMENSIONS, names[which]);
        }
        size_t column = SPACE - ++found;
        dim[column] = (int64_t)length;
        conus_status status = add_axis(world, column, object, length);
        if (status) {
            return status;
        }
    }
    return found == SPACE && axis == image->value.rank
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "dimorder: found %zu names for %zu dimensions; xspace, yspace and zspace are needed", axis,
                      image->value.rank);
}

/* The range of stored values: what the file says, else that of their type. */
static conus_status take_range(double range[2], bool *is_all, const struct hdf5_object *image)
{
    const struct hdf5_value *value = &image->value;
    const double all[2] = {value->class == HDF5_SIGNED ? -ldexp(1, 8 * (int)value->size - 1) : 0,
                           ldexp(1, 8 * (int)value->size - (value->class == HDF5_SIGNED)) - 1};
    memcpy(range, all, sizeof all);
    if (hdf5_attribute(image, "valid_range") && !(get_numbers(range, image, "valid_range", 2) && all[0] <= range[0] &&
                                                  range[0] <= range[1] && range[1] <= all[1])) {
        return fail(CONUS_ERROR_DATA, "valid_range: two numbers from %.0f to %.0f are needed, the lower one first",
                    all[0], all[1]);
    }
    *is_all = range[0] == all[0] && range[1] == all[1];
    return CONUS_OK;
}

/* image-min or image-max: a number, or one for each place along the slowest dimensions. */
static conus_status find_limits(const struct hdf5_value **out, const struct hdf5 *hdf5, const char *path,
                                const struct hdf5_object *image)
{
    const struct hdf5_object *object = hdf5_find(hdf5, path);
    bool fine = object && hdf5_is_number(&object->value) && object->value.rank < image->value.rank;
    for (size_t i = 0; fine && i < object->value.rank && object->value.count != 1; i++) {
        fine = object->value.dims[i] == image->value.dims[i];
    }
    struct text order = fine ? get_text(object, "dimorder") : text_from("");
    struct text of_image = get_text(image, "dimorder");
    of_image.size = order.size < of_image.size ? order.size : of_image.size;
    if (!fine || text_compare(order, of_image) != 0) {
        return fail(CONUS_ERROR_DATA, "%s: a number is needed, or one for each place along the slowest dimensions",
                    path);
    }
    *out = &object->value;
    return CONUS_OK;
}

/* Slope and intercept of each slice; none where all stored values are the real ones. */
static conus_status take_scales(struct minc *minc, const struct hdf5_object *image)
{
    const struct hdf5_value *low = NULL;
    const struct hdf5_value *high = NULL;
    bool is_plain = true;
    conus_status status = take_range(minc->range, &is_plain, image);
    status = status ? status : find_limits(&low, minc->hdf5, IMAGE "image-min", image);
    status = status ? status : find_limits(&high, minc->hdf5, IMAGE "image-max", image);
    if (!status && low->count != high->count) {
        status = fail(CONUS_ERROR_DATA, "image-min and image-max: found %zu and %zu numbers", low->count, high->count);
    }
    minc->slices = status ? 0 : low->count;
    minc->scales = status ? NULL : memory_zeroed(minc->slices, 2 * sizeof *minc->scales);
    status = status || minc->scales ? status : CONUS_ERROR_MEMORY;
    const double width = minc->range[1] - minc->range[0];
    for (size_t i = 0; !status && i < minc->slices; i++) {
        double *scale = minc->scales + 2 * i;
        double least = hdf5_number(low, i);
        double step = hdf5_number(high, i) - least; /* 0: all of the slice is one value, whatever is stored */
        scale[0] = step == 0 ? 0 : step / width;
        scale[1] = step == 0 ? least : least - minc->range[0] * scale[0];
        is_plain = is_plain && scale[0] == 1 && scale[1] == 0;
        if (!isfinite(scale[0]) || !isfinite(scale[1])) {
            status = fail(CONUS_ERROR_DATA, "slice %zu: image-min %g and image-max %g are no scale of %g to %g", i,
                          least, hdf5_number(high, i), minc->range[0], minc->range[1]);
        }
    }
    if (is_plain) {
        memory_free(minc->scales);
        minc->scales = NULL;
    }
    return status;
}

static conus_status describe(struct volume_header *out, struct minc *minc)
{
    const struct hdf5_object *image = hdf5_find(minc->hdf5, IMAGE "image");
    double world[16];
    int64_t dim[7] = {1, 1, 1, 1, 1, 1, 1};
    struct volume_header header = {.footer = true, .info.slope = 1};
    if (!image) {
        return fail(CONUS_ERROR_DATA, "HDF5, but no volume of MINC: there is no " IMAGE "image");
    }
    minc->image = &image->value;
    if (!hdf5_is_number(minc->image)) {
        return fail(CONUS_ERROR_UNSUPPORTED, IMAGE "image: one number for each voxel is needed");
    }
    snprintf(header.info.format, sizeof header.info.format, "MINC 2");
    conus_status status = take_axes(world, dim, minc->hdf5, image);
    status = status || minc->image->class == HDF5_FLOAT ? status : take_scales(minc, image);
    char kind = "fiu"[minc->image->class - HDF5_FLOAT];
    int datatype = minc->scales ? VOLUME_FLOAT64 : volume_datatype_of(kind, minc->image->size);
    header.swapped = !minc->scales && SWAPPED;
    header.has_unit = !status && get_text(hdf5_find(minc->hdf5, DIMENSIONS "xspace"), "units").size;
    header.label_slack = minc->scales ? label_slack : 0;
    status = status ? status : volume_header_set_datatype(&header, datatype);
    status = status ? status : volume_header_set_dim(&header, dim);
    status = status ? status : space_describe(&header.info, world, "start, step and direction_cosines");
    *out = status ? *out : header;
    return status;
}

conus_status minc_from_hdf5(struct minc *out, struct volume_header *header, struct hdf5 *hdf5)
{
    struct minc minc = {.hdf5 = hdf5};
    conus_status status = describe(header, &minc);
    if (status) {
        minc_finish(&minc);
        return status;
    }
    *out = minc;
    return CONUS_OK;
}

conus_status minc_open(struct minc *out, struct volume_header *header, const struct bytes *file, uint64_t limit)
{
    static const char *const wanted[] = {IMAGE "image", IMAGE "image-min", IMAGE "image-max", DIMENSIONS "*"};
    struct hdf5 *hdf5 = NULL;
    conus_status status = hdf5_read_bytes(&hdf5, (struct text){(const char *)file->data, file->size}, wanted,
                                          sizeof wanted / sizeof wanted[0], limit);
    return status ? status : minc_from_hdf5(out, header, hdf5);
}

conus_status minc_read(const struct minc *minc, gzip_sink *sink, void *user)
{
    const struct hdf5_value *image = minc->image;
    if (!minc->scales) {
        return sink(user, image->data, image->count * image->size);
    }
    double values[BLOCK];
    size_t each = image->count / minc->slices; /* divides it: slices lie along whole dimensions */
    conus_status status = CONUS_OK;
    for (size_t at = 0; !status && at < image->count;) {
        const double *scale = minc->scales + 2 * (at / each);
        size_t left = each - at % each;
        size_t block = left < BLOCK ? left : BLOCK;
        for (size_t i = 0; i < block; i++) {
            double stored = hdf5_number(image, at + i);
            bool is_valid = stored >= minc->range[0] && stored <= minc->range[1];
            values[i] = is_valid ? stored * scale[0] + scale[1] : NAN;
        }
        status = sink(user, (const uint8_t *)values, block * sizeof *values);
        at += block;
    }
    return status;
}
