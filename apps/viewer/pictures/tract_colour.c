/* SPDX-License-Identifier: BSD-3-Clause */
/* Bundle, direction, and the numbers of all tractograms, in the order in which they come. */
#include "viewer/pictures/tract_colour.h"

#include <math.h>
#include <string.h>

static const char *const fixed[TRACT_BY_NUMBER] = {"bundle", "direction"};

static bool is_among(const char *const *names, size_t count, const char *name)
{
    for (size_t i = 0; i < count; i++) {
        if (strcmp(names[i], name) == 0) {
            return true;
        }
    }
    return false;
}

/* All of them, up to the limit. */
static size_t list(const char *names[TRACT_COLOUR_LIMIT], const conus_atlas *atlas)
{
    conus_tract_scalar scalar = CONUS_TRACT_SCALAR_INIT;
    size_t count = 0;
    while (conus_atlas_tractogram_count(atlas) && count < TRACT_BY_NUMBER) {
        names[count] = fixed[count];
        count++;
    }
    for (size_t i = 0; i < conus_atlas_tractogram_count(atlas); i++) {
        for (size_t s = 0; count < TRACT_COLOUR_LIMIT && !conus_atlas_tractogram_scalar(&scalar, atlas, i, s); s++) {
            if (scalar.components == 1 && !is_among(names, count, scalar.name)) {
                names[count++] = scalar.name;
            }
        }
    }
    return count;
}

const char *tract_colour_name(const conus_atlas *atlas, size_t colour)
{
    const char *names[TRACT_COLOUR_LIMIT];
    return colour < list(names, atlas) ? names[colour] : NULL;
}

size_t tract_colour_find(const conus_atlas *atlas, const char *name)
{
    const char *names[TRACT_COLOUR_LIMIT];
    size_t count = list(names, atlas);
    size_t colour = 0;
    while (colour < count && strcmp(names[colour], name) != 0) {
        colour++;
    }
    return colour < count ? colour : TRACT_COLOUR_LIMIT;
}

size_t tract_colour_count(const conus_atlas *atlas)
{
    const char *names[TRACT_COLOUR_LIMIT];
    return list(names, atlas);
}

static void widen(double range[2], const conus_tract_scalar *scalar, const conus_tractogram_info *info)
{
    uint64_t count = scalar->per_point ? info->points : info->streamlines;
    for (uint64_t v = 0; v < count; v++) {
        double value = (double)scalar->values[v];
        range[0] = isfinite(value) ? fmin(range[0], value) : range[0];
        range[1] = isfinite(value) ? fmax(range[1], value) : range[1];
    }
}

/* Of one tractogram the first of that name counts, as in pictures. */
bool tract_colour_range(double out[2], const conus_atlas *atlas, const char *name)
{
    double range[2] = {INFINITY, -INFINITY};
    conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
    for (size_t i = 0; !conus_atlas_tractogram(&info, atlas, i); i++) {
        conus_tract_scalar scalar = CONUS_TRACT_SCALAR_INIT;
        bool found = false;
        for (size_t s = 0; !found && !conus_atlas_tractogram_scalar(&scalar, atlas, i, s); s++) {
            found = scalar.components == 1 && strcmp(scalar.name, name) == 0;
        }
        if (found) {
            widen(range, &scalar, &info);
        }
    }
    if (range[0] > range[1]) {
        return false;
    }
    out[0] = range[0];
    out[1] = range[1];
    return true;
}
