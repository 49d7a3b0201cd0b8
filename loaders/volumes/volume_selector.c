/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes "path,key=value,..." apart by a table of keys. */
#include "loaders/volumes/volume_selector.h"

#include "base/memory.h"
#include "base/path.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool read_volume(struct volume_selector *out, struct text value)
{
    return text_to_uint(value, SIZE_MAX, &out->volume);
}

static bool read_level(struct volume_selector *out, struct text value)
{
    return text_to_uint(value, INT32_MAX, &out->level);
}

static bool read_field(struct volume_selector *out, struct text value)
{
    out->field = value;
    return value.size;
}

/* "25", or "25:20:20": page, row, column. */
static bool read_resolution(struct volume_selector *out, struct text value)
{
    double *numbers = out->place.resolution;
    struct text part;
    size_t count = 0;
    bool good = true;
    for (bool more = true; good && text_field(&value, ':', &more, &part); count++) {
        good = count < 3 && text_to_double(part, &numbers[count]) && numbers[count] > 0 && isfinite(numbers[count]);
    }
    numbers[1] = count == 1 ? numbers[0] : numbers[1];
    numbers[2] = count == 1 ? numbers[0] : numbers[2];
    return good && (count == 1 || count == 3);
}

static bool read_orientation(struct volume_selector *out, struct text value)
{
    double matrix[16];
    const double scale[3] = {1, 1, 1};
    snprintf(out->place.orientation, sizeof out->place.orientation, "%.*s", (int)value.size, value.data);
    return !brainglobe_axes(matrix, out->place.orientation, scale); /* whose message says more */
}

/* "2", or "1:2". */
static bool read_tissue(struct volume_selector *out, struct text value)
{
    struct text part;
    bool good = true;
    for (bool more = true; good && text_field(&value, ':', &more, &part); out->tissue_count++) {
        uint64_t number = 0;
        good = out->tissue_count < TISSUE_LIMIT && text_to_uint(part, UINT32_MAX, &number);
        if (good) {
            out->tissues[out->tissue_count] = (uint32_t)number;
        }
    }
    return good;
}

#define PLACED "is for TIFF stacks and OME-Zarr, this file says itself where it lies"
#define FIELDS "is for results of SimNIBS (.hdf5) as a region of interest, this file has none"
#define WHOLE "allowed are whole numbers from 0"

static const struct {
    const char *name;
    bool (*read)(struct volume_selector *out, struct text value);
    const char *allowed; /* NULL: the reader has failed with a message */
    const char *refusal; /* of a file that does not take the key */
} keys[VOLUME_KEYS] = {
    [KEY_FIELD] = {"field", read_field, "a name is needed", FIELDS},
    [KEY_TISSUE] = {"tissue", read_tissue, "allowed are up to 16 whole numbers from 0, as in 1:2", FIELDS},
    [KEY_LEVEL] = {"level", read_level, WHOLE, "is for OME-Zarr, this file has none"},
    [KEY_ORIENTATION] = {"orientation", read_orientation, NULL, PLACED},
    [KEY_RESOLUTION] = {"resolution", read_resolution,
                        "allowed are one or three (page:row:column) numbers above 0, in micrometres", PLACED},
    [KEY_VOLUME] = {"volume", read_volume, WHOLE, ""},
};

/* The key with which the text begins; VOLUME_KEYS if none does. */
static enum volume_key find_key(struct text text)
{
    size_t i = 0;
    size_t length;
    while (i < VOLUME_KEYS && !(text_starts(text, keys[i].name) && (length = strlen(keys[i].name)) < text.size &&
                                text.data[length] == '=')) {
        i++;
    }
    return (enum volume_key)i;
}

/* The first ",key=" in the name, or its end. Folders may be called anything. */
static const char *find_keys(const char *text)
{
    const char *at = strchr(path_base(text), ',');
    while (at && find_key(text_from(at + 1)) == VOLUME_KEYS) {
        at = strchr(at + 1, ',');
    }
    return at ? at : text + strlen(text);
}

static void read_key(struct job *job, struct volume_selector *out, struct text field)
{
    const enum volume_key key = find_key(field);
    if (key == VOLUME_KEYS) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "found \"%.*s\", allowed are volume, resolution, orientation, level, field and tissue",
                 (int)field.size, field.data);
        return;
    }
    const size_t length = strlen(keys[key].name) + 1;
    const struct text value = {field.data + length, field.size - length};
    if (out->given & VOLUME_KEY(key)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s is given twice", keys[key].name);
    } else if (keys[key].read(out, value)) {
        out->given |= VOLUME_KEY(key);
    } else if (!keys[key].allowed) {
        (void)JOB_CALL(job, CONUS_ERROR_ARGUMENT);
    } else if (!value.size && key == KEY_FIELD) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: %s", keys[key].name, keys[key].allowed);
    } else {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: found \"%.*s\", %s", keys[key].name, (int)value.size, value.data,
                 keys[key].allowed);
    }
}

void volume_selector_read(struct job *job, struct volume_selector *out, const char *text)
{
    const size_t place = job_in(job, text, JOB_ALONE);
    const char *at = find_keys(text);
    struct text rest = text_from(*at ? at + 1 : at);
    struct text field;
    *out = (struct volume_selector){.path = job_copy(job, (struct text){text, (size_t)(at - text)})};
    for (bool more = *at; job_ok(job) && text_field(&rest, ',', &more, &field);) {
        read_key(job, out, field);
    }
    job_out(job, place);
}

void volume_selector_refuse(struct job *job, const struct volume_selector *selector, unsigned allowed)
{
    for (size_t i = 0; i < VOLUME_KEYS; i++) {
        if (selector->given & ~allowed & VOLUME_KEY(i)) {
            job_fail(job, CONUS_ERROR_ARGUMENT, "%s %s", keys[i].name, keys[i].refusal);
        }
    }
}
