/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses, copies and samples transfer functions. */
#include "render/colour/colour.h"

#include "atlas/atlas.h"
#include "base/files/file.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/path.h"
#include "base/text.h"
#include "conus/own.h"
#include "render/image/image.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { SAMPLE_LIMIT = 1 << 16, FILE_LIMIT = 1 << 20 };

/* A preset; its values are relative. */
struct transfer_preset {
    const char *name;
    conus_transfer_point points[8];
    size_t count;
};

static const struct transfer_preset presets[] = {
    /* T1: a translucent shell, through which the areas show */
    {"brain",
     {{0.12, {0.72, 0.66, 0.60, 0}},
      {0.25, {0.74, 0.68, 0.62, 0.035}},
      {0.45, {0.78, 0.72, 0.66, 0.025}},
      {0.65, {0.84, 0.79, 0.73, 0.010}},
      {1.00, {0.97, 0.95, 0.92, 0.008}}},
     5},
    /* T1 without skull: the opaque surface of the brain */
    {"surface",
     {{0.28, {0.80, 0.70, 0.62, 0}},
      {0.42, {0.84, 0.74, 0.66, 0.7}},
      {0.70, {0.88, 0.80, 0.73, 0.95}},
      {1.00, {0.98, 0.95, 0.91, 0.98}}},
     4},
    /* every value in its own grey, brighter ones denser */
    {"grey", {{0.05, {0, 0, 0, 0}}, {0.30, {0.30, 0.30, 0.30, 0.01}}, {1.00, {1, 1, 1, 0.12}}}, 3},
    /* values as heat, from thin dark red to dense yellow: probabilities */
    {"heat",
     {{0.00, {0.45, 0.02, 0.03, 0}},
      {0.35, {0.85, 0.12, 0.03, 0.05}},
      {0.70, {1, 0.62, 0.05, 0.2}},
      {1.00, {1, 0.97, 0.75, 0.6}}},
     4},
    /* only the brightest tissue: white matter in T1, vessels in angiography, bone in CT */
    {"bright", {{0.78, {0.90, 0.86, 0.78, 0}}, {0.90, {0.95, 0.92, 0.85, 0.35}}, {1.00, {1, 0.99, 0.96, 0.9}}}, 3},
    /* nothing: the volume is seen in cuts only */
    {"none", {{0, {0, 0, 0, 0}}, {1, {0, 0, 0, 0}}}, 2},
};

enum { PRESETS = sizeof presets / sizeof *presets };

const char *conus_transfer_preset(size_t index)
{
    return index < PRESETS ? presets[index].name : NULL;
}

void transfer_finish(struct transfer *transfer)
{
    memory_free(transfer->points);
    *transfer = (struct transfer){0};
}

static conus_status append(struct transfer *transfer, const conus_transfer_point *point)
{
    if (transfer->count == TRANSFER_POINT_LIMIT) {
        return fail(CONUS_ERROR_DATA, "more than %d points", TRANSFER_POINT_LIMIT);
    }
    conus_transfer_point *points = memory_resize(transfer->points, transfer->count + 1, sizeof *points);
    if (!points) {
        return CONUS_ERROR_MEMORY;
    }
    transfer->points = points;
    transfer->points[transfer->count++] = *point;
    return CONUS_OK;
}

static conus_status check_point(const struct transfer *transfer, const conus_transfer_point *point, const char *what,
                                size_t number)
{
    for (int i = 0; i < 4; i++) {
        if (!(point->rgba[i] >= 0 && point->rgba[i] <= 1)) {
            return fail(CONUS_ERROR_DATA, "%s %zu: %c = %g; allowed is 0 to 1", what, number, "rgba"[i],
                        point -> rgba[i]);
        }
    }
    if (!(fabs(point->value) <= (double)FLT_MAX)) {
        return fail(CONUS_ERROR_DATA, "%s %zu: value = %g; allowed is what fits into a float", what, number,
                    point->value);
    }
    size_t count = transfer->count;
    if (count && point->value < transfer->points[count - 1].value) {
        return fail(CONUS_ERROR_DATA, "%s %zu: value %g after %g; values may not fall", what, number, point->value,
                    transfer->points[count - 1].value);
    }
    if (count > 1 && !(point->value > transfer->points[count - 2].value)) {
        return fail(CONUS_ERROR_DATA, "%s %zu: value %g for the third time; two make a step", what, number,
                    point->value);
    }
    return CONUS_OK;
}

static conus_status parse_point(struct transfer *transfer, struct text line, size_t number)
{
    double fields[5];
    struct text word;
    size_t count = 0;
    while (text_word(&line, &word)) {
        if (count == 5 || !text_to_double(word, &fields[count])) {
            return fail(CONUS_ERROR_DATA, "line %zu: \"%.*s\" where a point has five numbers: value r g b a", number,
                        (int)(word.size < 40 ? word.size : 40), word.data);
        }
        count++;
    }
    if (count < 5) {
        return fail(CONUS_ERROR_DATA, "line %zu: %zu numbers; a point has five: value r g b a", number, count);
    }
    conus_transfer_point point = {fields[0], {fields[1], fields[2], fields[3], fields[4]}};
    conus_status status = check_point(transfer, &point, "line", number);
    return status ? status : append(transfer, &point);
}

conus_status transfer_parse(struct transfer *out, const uint8_t *data, size_t size)
{
    struct transfer transfer = {0};
    struct text rest = {(const char *)data, size};
    struct text line;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&rest, &line); number++) {
        const char *comment = line.size ? memchr(line.data, '#', line.size) : NULL;
        line.size = comment ? (size_t)(comment - line.data) : line.size;
        line = text_trim(line);
        if (text_equal(line, "relative") && !transfer.count) {
            transfer.relative = true;
        } else if (line.size) {
            status = parse_point(&transfer, line, number);
        }
    }
    if (!status && !transfer.count) {
        status = fail(CONUS_ERROR_DATA, "no points; lines of \"value r g b a\" are expected");
    }
    if (status) {
        transfer_finish(&transfer);
        return status;
    }
    *out = transfer;
    return CONUS_OK;
}

conus_status transfer_copy(struct transfer *out, const conus_transfer_point *points, size_t count)
{
    struct transfer transfer = {0};
    conus_status status = count ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "transfer function without points");
    for (size_t i = 0; i < count && !status; i++) {
        status =
            check_point(&transfer, &points[i], "point", i + 1) ? CONUS_ERROR_ARGUMENT : append(&transfer, &points[i]);
    }
    if (status) {
        transfer_finish(&transfer);
        return status;
    }
    *out = transfer;
    return CONUS_OK;
}

conus_status transfer_load(struct transfer *out, const char *name)
{
    for (size_t i = 0; i < PRESETS; i++) {
        const struct transfer_preset *preset = &presets[i];
        if (strcmp(name, preset->name) == 0) {
            conus_status status = transfer_copy(out, preset->points, preset->count);
            if (!status) {
                out->relative = true;
            }
            return status;
        }
    }
    struct bytes bytes = {0};
    conus_status status = file_read(&bytes, name, FILE_LIMIT);
    if (!status) {
        status = transfer_parse(out, bytes.data, bytes.size);
        status = status ? fail_in(status, name) : status;
    } else if (path_is_name(name) && !strchr(name, '.')) {
        status = fail(CONUS_ERROR_ARGUMENT,
                      "transfer function \"%s\" is neither a file nor brain, surface, grey, heat, bright, none", name);
    }
    bytes_finish(&bytes);
    return status;
}

void transfer_at(double rgba[4], const struct transfer *transfer, double value)
{
    size_t above = 0;
    while (above < transfer->count && transfer->points[above].value <= value) {
        above++;
    }
    const conus_transfer_point *high = &transfer->points[above < transfer->count ? above : transfer->count - 1];
    const conus_transfer_point *low = &transfer->points[above ? above - 1 : 0];
    double part = high->value > low->value ? (value - low->value) / (high->value - low->value) : 0;
    for (int i = 0; i < 4; i++) {
        rgba[i] = low->rgba[i] + part * (high->rgba[i] - low->rgba[i]);
    }
}

static int by_value(const void *a, const void *b)
{
    float left = *(const float *)a;
    float right = *(const float *)b;
    return (left > right) - (left < right);
}

conus_status transfer_window(double *low, double *high, const struct volume *volume)
{
    size_t stride = volume->voxel_count / SAMPLE_LIMIT + 1;
    stride += stride % 2 == 0; /* odd, so that it does not keep to some columns of an even grid */
    float *sample = memory_raw(SAMPLE_LIMIT, sizeof *sample);
    if (!sample) {
        return CONUS_ERROR_MEMORY;
    }
    size_t count = 0;
    for (size_t i = 0; i < volume->voxel_count; i += stride) {
        if (volume_value(volume, i) > (float)volume->info.minimum) {
            sample[count++] = volume_value(volume, i);
        }
    }
    order_sort(sample, count, sizeof *sample, by_value);
    *low = volume->info.minimum;
    *high = count ? (double)sample[(count - 1) * 995 / 1000] : volume->info.maximum;
    *high = *high > *low ? *high : *low + 1;
    memory_free(sample);
    return CONUS_OK;
}

void transfer_span(double *low, double *high, const struct transfer *transfer)
{
    const double last = transfer->points[transfer->count - 1].value;
    *low = transfer->points[0].value;
    *high = last > *low ? last : *low + 1;
}

void transfer_table(float *rgbe, size_t count, const struct transfer *transfer)
{
    double first = transfer->points[0].value;
    double last = transfer->points[transfer->count - 1].value;
    for (size_t i = 0; i < count; i++) {
        double rgba[4];
        transfer_at(rgba, transfer, count > 1 ? first + (last - first) * (double)i / (double)(count - 1) : first);
        for (int c = 0; c < 3; c++) {
            rgbe[4 * i + (size_t)c] = (float)linear_from_srgb(rgba[c]);
        }
        rgbe[4 * i + 3] = (float)transfer_extinction(rgba[3]);
    }
}

conus_status conus_atlas_window(double window[2], const conus_atlas *atlas, size_t index)
{
    if (index >= atlas->volume_count || !volume_has_values(&atlas->volumes[index])) {
        return fail(CONUS_ERROR_ARGUMENT, "volume %zu: a volume of values is needed", index);
    }
    return transfer_window(&window[0], &window[1], &atlas->volumes[index]);
}
