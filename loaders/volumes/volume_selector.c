/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes "path,key=value,..." apart by a table of keys. */
#include "loaders/volumes/volume_selector.h"

#include "base/memory.h"
#include "base/path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static conus_status read_volume(struct volume_selector *out, struct text value)
{
    out->chosen = true;
    return text_to_uint(value, SIZE_MAX, &out->volume)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "volume: found \"%.*s\", allowed are whole numbers from 0", (int)value.size,
                      value.data);
}

/* "25", or "25:20:20": page, row, column. */
static conus_status read_resolution(struct volume_selector *out, struct text value)
{
    double *numbers = out->place.resolution;
    struct text rest = value;
    struct text part;
    size_t count = 0;
    bool good = true;
    for (bool more = true; good && text_field(&rest, ':', &more, &part); count++) {
        good = count < 3 && text_to_double(part, &numbers[count]) && numbers[count] > 0 && isfinite(numbers[count]);
    }
    if (!good || (count != 1 && count != 3)) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "resolution: found \"%.*s\", allowed are one or three (page:row:column) numbers above 0, in "
                    "micrometres",
                    (int)value.size, value.data);
    }
    for (size_t i = count; i < 3; i++) {
        numbers[i] = numbers[0];
    }
    return CONUS_OK;
}

static conus_status read_orientation(struct volume_selector *out, struct text value)
{
    double matrix[16];
    const double scale[3] = {1, 1, 1};
    snprintf(out->place.orientation, sizeof out->place.orientation, "%.*s", (int)value.size, value.data);
    return brainglobe_axes(matrix, out->place.orientation, scale) ? CONUS_ERROR_ARGUMENT : CONUS_OK;
}

static conus_status read_level(struct volume_selector *out, struct text value)
{
    out->leveled = true;
    return text_to_uint(value, INT32_MAX, &out->level)
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "level: found \"%.*s\", allowed are whole numbers from 0", (int)value.size,
                      value.data);
}

static conus_status read_field(struct volume_selector *out, struct text value)
{
    out->field = value;
    return value.size ? CONUS_OK : fail(CONUS_ERROR_ARGUMENT, "field: a name is needed");
}

/* "2", or "1:2". */
static conus_status read_tissue(struct volume_selector *out, struct text value)
{
    struct text rest = value;
    struct text part;
    bool good = true;
    for (bool more = true; good && text_field(&rest, ':', &more, &part); out->tissue_count++) {
        uint64_t number = 0;
        good = out->tissue_count < TISSUE_LIMIT && text_to_uint(part, UINT32_MAX, &number);
        if (good) {
            out->tissues[out->tissue_count] = (uint32_t)number;
        }
    }
    return good ? CONUS_OK
                : fail(CONUS_ERROR_ARGUMENT,
                       "tissue: found \"%.*s\", allowed are up to %d whole numbers from 0, as in 1:2", (int)value.size,
                       value.data, TISSUE_LIMIT);
}

static const struct {
    const char *key;
    conus_status (*read)(struct volume_selector *out, struct text value);
} keys[] = {
    {"volume=", read_volume}, {"resolution=", read_resolution}, {"orientation=", read_orientation},
    {"level=", read_level},   {"field=", read_field},           {"tissue=", read_tissue},
};
enum { KEYS = sizeof keys / sizeof keys[0] };

/* The first ",key=" in the name, or its end. Folders may be called anything. */
static const char *find_keys(const char *text)
{
    for (const char *at = path_base(text); (at = strchr(at, ',')); at++) {
        for (size_t i = 0; i < KEYS; i++) {
            if (strncmp(at + 1, keys[i].key, strlen(keys[i].key)) == 0) {
                return at;
            }
        }
    }
    return text + strlen(text);
}

conus_status volume_selector_parse(struct volume_selector *out, const char *text)
{
    struct volume_selector selector = {0};
    const char *at = find_keys(text);
    struct text rest = text_from(*at ? at + 1 : at);
    struct text field;
    bool given[KEYS] = {false};
    conus_status status = CONUS_OK;
    for (bool more = *at; !status && text_field(&rest, ',', &more, &field);) {
        size_t i = 0;
        while (i < KEYS && !text_starts(field, keys[i].key)) {
            i++;
        }
        size_t length = i < KEYS ? strlen(keys[i].key) : 0;
        if (!length) {
            status = fail(CONUS_ERROR_ARGUMENT,
                          "found \"%.*s\", allowed are volume, resolution, orientation, level, field and tissue",
                          (int)field.size, field.data);
        } else if (given[i]) {
            status = fail(CONUS_ERROR_ARGUMENT, "%.*s is given twice", (int)length - 1, keys[i].key);
        } else {
            given[i] = true;
            status = keys[i].read(&selector, (struct text){field.data + length, field.size - length});
        }
    }
    if (status) {
        return fail_in(status, text);
    }
    selector.path = memory_text(text, (size_t)(at - text));
    *out = selector;
    return selector.path ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void volume_selector_finish(struct volume_selector *selector)
{
    memory_free(selector->path);
}

conus_status volume_selector_refuse_place(const struct volume_selector *selector, const char *path)
{
    const struct brainglobe_metadata *place = &selector->place;
    bool given = place->orientation[0] || place->resolution[0] > 0;
    if (selector->leveled) {
        return volume_selector_refuse_level(selector, path);
    }
    return given ? fail(CONUS_ERROR_ARGUMENT,
                        "%s: %s is for TIFF stacks and OME-Zarr, this file says itself where it lies", path,
                        place->orientation[0] ? "orientation" : "resolution")
                 : CONUS_OK;
}

conus_status volume_selector_refuse_field(const struct volume_selector *selector, const char *path)
{
    return selector->field.size || selector->tissue_count
               ? fail(CONUS_ERROR_ARGUMENT,
                      "%s: %s is for results of SimNIBS (.hdf5) as a region of interest, this file has none", path,
                      selector->field.size ? "field" : "tissue")
               : CONUS_OK;
}

conus_status volume_selector_refuse_level(const struct volume_selector *selector, const char *path)
{
    return selector->leveled ? fail(CONUS_ERROR_ARGUMENT, "%s: level is for OME-Zarr, this file has none", path)
                             : CONUS_OK;
}
