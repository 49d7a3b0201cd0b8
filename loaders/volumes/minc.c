/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads MINC 2 ("MINC 2.0 File Format Reference", McConnell Brain Imaging Centre; nibabel's minc2.py). */
#include "loaders/volumes/parts.h"

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

struct minc {
    const struct hdf5 *hdf5;
    const struct hdf5_value *image;
    double *scales;  /* [slices][2], slope and intercept of stored values; NULL: they are the real ones. */
    size_t slices;   /* Along the slowest dimensions. */
    double range[2]; /* Stored values beyond it are no data. */
};

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
static void add_axis(struct job *job, double world[16], size_t column, const struct hdf5_object *object,
                     uint64_t length)
{
    static const struct {
        const char *name, *wanted;
    } words[] = {{"spacing", "regular__"}, {"units", "mm"}, {"alignment", "centre"}};
    double start = 0;
    double step = 0;
    double counted;
    double cosines[SPACE] = {0};
    struct text name = hdf5_last_name(object->value.name);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        struct text found = get_text(object, words[i].name);
        if (found.size && !text_equal(found, words[i].wanted)) {
            job_refuse(job, "%.*s: %s: found \"%.*s\", allowed is \"%s\"", TEXT_SHOW(name, 40U), words[i].name,
                       TEXT_SHOW(found, 40U), words[i].wanted);
        }
    }
    if (!get_numbers(&start, object, "start", 1) || !get_numbers(&step, object, "step", 1)) {
        job_bad(job, "%.*s: start and step: a number each is needed", TEXT_SHOW(name, 40U));
    }
    if (get_numbers(&counted, object, "length", 1) && counted != (double)length) {
        job_bad(job, "%.*s: length: found %g, the image has %llu", TEXT_SHOW(name, 40U), counted,
                (unsigned long long)length);
    }
    if (!hdf5_attribute(object, "direction_cosines")) {
        cosines[name.data[0] - 'x'] = 1;
    } else if (!get_numbers(cosines, object, "direction_cosines", SPACE) ||
               !(fabs(vec3_length(cosines) - 1) <= 0.01)) { /* libminc writes 6 digits and more */
        job_bad(job, "%.*s: direction_cosines: three numbers of length 1 are needed", TEXT_SHOW(name, 40U));
    }
    vec3_scale(world + 4 * column, cosines, step);
    vec3_add_scaled(world + 12, world + 12, start, cosines); /* it counts along the cosines */
}

/* The transform and dimensions, by the names in dimorder, the slowest first. */
static void take_axes(struct job *job, double world[16], int64_t dim[7], const struct hdf5 *hdf5,
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
    for (; job_ok(job) && text_field(&order, ',', &more, &name); axis++) {
        name = text_trim(name);
        size_t which = 0;
        while (which < SPACE && !text_equal(name, names[which])) {
            which++;
        }
        const uint64_t length = axis < image->value.rank ? image->value.dims[axis] : 0;
        if (which == SPACE && !(text_equal(name, "time") && length == 1)) {
            job_refuse(job, "dimorder: found %.*s of %llu, allowed are xspace, yspace and zspace, and one time",
                       TEXT_SHOW(name, 40U), (unsigned long long)length);
        }
        if (which == SPACE) {
            continue;
        }
        const struct hdf5_object *object =
            hdf5_find_in(hdf5, (struct text){DIMENSIONS, sizeof DIMENSIONS - 2}, names[which]);
        if (seen[which]++ || !object || length < 1) {
            job_bad(job, "%s: needed is one of at least one voxel, in " DIMENSIONS, names[which]);
            break;
        }
        size_t column = SPACE - ++found;
        dim[column] = (int64_t)length;
        add_axis(job, world, column, object, length);
    }
    if (found != SPACE || axis != image->value.rank) {
        job_bad(job, "dimorder: found %zu names for %zu dimensions; xspace, yspace and zspace are needed", axis,
                image->value.rank);
    }
}

/* The range of stored values: what the file says, else that of their type, which is true. */
static bool take_range(struct job *job, double range[2], const struct hdf5_object *image)
{
    const struct hdf5_value *value = &image->value;
    const double all[2] = {value->class == HDF5_SIGNED ? -ldexp(1, 8 * (int)value->size - 1) : 0,
                           ldexp(1, 8 * (int)value->size - (value->class == HDF5_SIGNED)) - 1};
    memcpy(range, all, sizeof all);
    if (hdf5_attribute(image, "valid_range") && !(get_numbers(range, image, "valid_range", 2) && all[0] <= range[0] &&
                                                  range[0] <= range[1] && range[1] <= all[1])) {
        job_bad(job, "valid_range: two numbers from %.0f to %.0f are needed, the lower one first", all[0], all[1]);
    }
    return range[0] == all[0] && range[1] == all[1];
}

/* image-min or image-max: a number, or one for each place along the slowest dimensions. */
static const struct hdf5_value *find_limits(struct job *job, const struct hdf5 *hdf5, const char *path,
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
        job_bad(job, "%s: a number is needed, or one for each place along the slowest dimensions", path);
        return NULL;
    }
    return &object->value;
}

/* Slope and intercept of each slice; none where all stored values are the real ones. */
static void take_scales(struct job *job, struct minc *minc, const struct hdf5_object *image)
{
    bool is_plain = take_range(job, minc->range, image);
    const struct hdf5_value *low = find_limits(job, minc->hdf5, IMAGE "image-min", image);
    const struct hdf5_value *high = find_limits(job, minc->hdf5, IMAGE "image-max", image);
    if (low && high && low->count != high->count) {
        job_bad(job, "image-min and image-max: found %zu and %zu numbers", low->count, high->count);
    }
    minc->slices = low && high ? low->count : 0;
    double *scales = job_zeroed(job, minc->slices, 2 * sizeof *scales);
    const double width = minc->range[1] - minc->range[0];
    for (size_t i = 0; scales && job_ok(job) && i < minc->slices; i++) {
        double *scale = scales + 2 * i;
        double least = hdf5_number(low, i);
        double step = hdf5_number(high, i) - least; /* 0: all of the slice is one value, whatever is stored */
        scale[0] = step == 0 ? 0 : step / width;
        scale[1] = step == 0 ? least : least - minc->range[0] * scale[0];
        is_plain = is_plain && scale[0] == 1 && scale[1] == 0;
        if (!isfinite(scale[0]) || !isfinite(scale[1])) {
            job_bad(job, "slice %zu: image-min %g and image-max %g are no scale of %g to %g", i, least,
                    hdf5_number(high, i), minc->range[0], minc->range[1]);
        }
    }
    minc->scales = is_plain ? NULL : scales;
}

/* A value beyond the valid range is NaN. */
static void minc_read(struct job *job, struct volume_input *v, size_t first, size_t count,
                      const struct voxel_sink *sink)
{
    const struct minc *minc = v->own;
    const struct hdf5_value *image = minc->image;
    double values[BLOCK];
    (void)first;
    (void)count;
    if (!minc->scales) {
        sink->take(job, sink->user, 0, image->data, image->count);
        return;
    }
    const size_t each = image->count / minc->slices; /* divides it: slices lie along whole dimensions */
    for (size_t at = 0, block; job_ok(job) && at < image->count; at += block) {
        const double *scale = minc->scales + 2 * (at / each);
        const size_t left = each - at % each;
        block = left < BLOCK ? left : BLOCK;
        for (size_t i = 0; i < block; i++) {
            const double stored = hdf5_number(image, at + i);
            const bool is_valid = stored >= minc->range[0] && stored <= minc->range[1];
            values[i] = is_valid ? stored * scale[0] + scale[1] : NAN;
        }
        sink->take(job, sink->user, at, (const uint8_t *)values, block);
    }
}

void minc_from_hdf5(struct job *job, struct volume_input *v, const struct hdf5 *hdf5)
{
    const struct hdf5_object *image = hdf5_find(hdf5, IMAGE "image");
    struct minc *minc = job_new(job, struct minc);
    double world[16];
    int64_t dim[7] = {1, 1, 1, 1, 1, 1, 1};
    if (!image) {
        job_bad(job, "HDF5, but no volume of MINC: there is no " IMAGE "image");
    } else if (!hdf5_is_number(&image->value)) {
        job_refuse(job, IMAGE "image: one number for each voxel is needed");
    }
    if (!job_ok(job) || !minc) {
        return;
    }
    *minc = (struct minc){.hdf5 = hdf5, .image = &image->value};
    v->own = minc;
    v->read = minc_read;
    v->gives_slabs = true;
    snprintf(v->header.info.format, sizeof v->header.info.format, "MINC 2");
    take_axes(job, world, dim, hdf5, image);
    if (image->value.class != HDF5_FLOAT && job_ok(job)) {
        take_scales(job, minc, image);
    }
    if (!job_ok(job)) {
        return;
    }
    const char kind = "fiu"[image->value.class - HDF5_FLOAT];
    v->header.swapped = !minc->scales && SWAPPED;
    v->header.has_unit = get_text(hdf5_find(hdf5, DIMENSIONS "xspace"), "units").size;
    v->header.label_slack = minc->scales ? label_slack : 0;
    volume_describe(job, v, minc->scales ? VOLUME_FLOAT64 : volume_datatype_of(kind, image->value.size), dim, world,
                    "start, step and direction_cosines");
}

static void minc_open(struct job *job, struct volume_input *v)
{
    static const char *const wanted[] = {IMAGE "image", IMAGE "image-min", IMAGE "image-max", DIMENSIONS "*"};
    if (v->source->is_packed) {
        job_refuse(job, "content: HDF5 packed with gzip: unpack it");
    }
    const struct bytes file = volume_bytes(job, v, v->source);
    const struct text text = {(const char *)file.data, file.size};
    const struct hdf5 *hdf5 = hdf5_of_bytes(job, text, wanted, sizeof wanted / sizeof wanted[0], job->max_memory);
    memory_free(job_give(job, file.data, file.size));
    minc_from_hdf5(job, v, hdf5);
}

const struct volume_reader minc_reader = {.is_whole = true, .open = minc_open};
