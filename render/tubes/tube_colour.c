/* SPDX-License-Identifier: BSD-3-Clause */
/* Colours of streamlines: by object, by direction, by a number. */
#include "render/tubes/tube_colour.h"

#include "base/buffer.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

/* Dark blue, green, yellow: lighter from step to step, so that the order shows without hues, too. */
static const double ramp[][3] = {{34, 46, 110}, {36, 104, 142}, {40, 156, 128}, {138, 204, 84}, {250, 230, 80}};
enum { STEPS = sizeof ramp / sizeof ramp[0] - 1 };

void tube_scalar_colour(uint8_t rgb[3], double part)
{
    if (isnan(part)) {
        rgb[0] = rgb[1] = rgb[2] = 128;
        return;
    }
    double at = fmin(fmax(part, 0), 1) * STEPS;
    int step = at < STEPS ? (int)at : STEPS - 1;
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)(ramp[step][c] + (at - step) * (ramp[step + 1][c] - ramp[step][c]) + 0.5);
    }
}

void tube_direction_colour(uint8_t rgb[3], const double direction[3])
{
    double unit[3] = {0, 0, 0};
    (void)vec3_normalise(unit, direction);
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)(255 * fabs(unit[c]) + 0.5);
    }
}

static const struct tract_scalar *find_scalar(const struct tractogram *tractogram, const char *name)
{
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        if (tractogram->scalars[i].components == 1 && strcmp(tractogram->scalars[i].name, name) == 0) {
            return &tractogram->scalars[i];
        }
    }
    return NULL;
}

/* Of all tractograms that have the number; false where none has, or no value is finite. */
static bool find_range(struct tube_colouring *out, const conus_atlas *atlas, const char *name)
{
    bool found = false;
    out->low = INFINITY;
    out->high = -INFINITY;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tract_scalar *scalar = find_scalar(&atlas->tractograms[i], name);
        size_t count =
            scalar ? (scalar->per_point ? atlas->tractograms[i].point_count : atlas->tractograms[i].streamline_count)
                   : 0;
        found = found || scalar;
        for (size_t v = 0; v < count; v++) {
            double value = (double)scalar->values[v];
            out->low = isfinite(value) ? fmin(out->low, value) : out->low;
            out->high = isfinite(value) ? fmax(out->high, value) : out->high;
        }
    }
    return found;
}

static conus_status fail_unknown(const conus_atlas *atlas, const char *name)
{
    struct buffer names = {0};
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tractogram *tractogram = &atlas->tractograms[i];
        for (size_t s = 0; s < tractogram->scalar_count; s++) {
            if (tractogram->scalars[s].components == 1) {
                buffer_format(&names, ", %s", tractogram->scalars[s].name);
            }
        }
    }
    conus_status status = buffer_status(&names);
    status = status ? status
                    : fail(CONUS_ERROR_ARGUMENT, "colour of streamlines: %s is none of bundle, direction%s", name,
                           names.data ? names.data : "");
    buffer_finish(&names);
    return status;
}

conus_status tube_colouring_choose(struct tube_colouring *out, const conus_atlas *atlas, const char *name)
{
    struct tube_colouring made = {0};
    if (name && !atlas->tractogram_count) {
        return fail(CONUS_ERROR_ARGUMENT, "colour of streamlines: the atlas has none");
    }
    if (name && strcmp(name, "direction") == 0) {
        made.by = TUBE_BY_DIRECTION;
    } else if (name && strcmp(name, "bundle") != 0) {
        if (!find_range(&made, atlas, name)) {
            return fail_unknown(atlas, name);
        }
        made.by = TUBE_BY_SCALAR;
        made.scalar = memory_text(name, strlen(name));
        if (!made.scalar) {
            return CONUS_ERROR_MEMORY;
        }
    }
    *out = made;
    return CONUS_OK;
}

void tube_colouring_finish(struct tube_colouring *colouring)
{
    memory_free(colouring->scalar);
    *colouring = (struct tube_colouring){0};
}

/* Where the number lies in its range: of a segment the mean of its ends. */
static double scalar_part(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                          uint64_t index)
{
    const struct tract_scalar *scalar = find_scalar(tractogram, colouring->scalar);
    if (!scalar) {
        return NAN;
    }
    uint64_t next = index + 1 < tractogram->first[number + 1] ? index + 1 : index;
    double value = scalar->per_point ? ((double)scalar->values[index] + (double)scalar->values[next]) / 2
                                     : (double)scalar->values[number];
    double span = colouring->high - colouring->low;
    return span > 0 || isnan(value) ? (value - colouring->low) / span : 0.5;
}

static uint32_t own_colour(const uint8_t rgb[3])
{
    return TUBE_OWN_COLOUR | rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16;
}

uint32_t tube_colour(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                     uint64_t index, uint32_t object)
{
    uint8_t rgb[3];
    if (colouring->by == TUBE_BY_BUNDLE) {
        return object;
    }
    if (colouring->by == TUBE_BY_SCALAR) {
        tube_scalar_colour(rgb, scalar_part(colouring, tractogram, number, index));
        return own_colour(rgb);
    }
    double from[3], along[3];
    uint64_t next = index + 1 < tractogram->first[number + 1] ? index + 1 : index;
    tractogram_point(from, tractogram, index);
    tractogram_point(along, tractogram, next);
    vec3_sub(along, along, from);
    tube_direction_colour(rgb, along);
    return own_colour(rgb);
}
