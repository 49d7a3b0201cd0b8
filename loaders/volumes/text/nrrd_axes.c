/* SPDX-License-Identifier: BSD-3-Clause */
/* The axes of an NRRD file. */
#include "loaders/volumes/text/nrrd_axes.h"

#include "atlas/frame.h"
#include "base/geometry/math3.h"
#include "loaders/volumes/text/header_text.h"

#include <stdio.h>
#include <string.h>

enum { AXES = 4 };

/* What the fields of each axis say. */
struct axes {
    size_t count;
    int64_t sizes[AXES];
    double directions[AXES][3];
    bool is_space[AXES]; /* it has a direction, not "none" */
    size_t list;         /* the axis of the volumes; AXES if there is none */
};

/* "none" or "(x,y,z)", which `rest` begins with. */
static bool read_vector(double out[3], bool *none, struct text *rest)
{
    *rest = text_trim(*rest);
    *none = text_starts(*rest, "none");
    if (*none) {
        *rest = (struct text){rest->data + 4, rest->size - 4};
        return true;
    }
    const char *end = rest->size && rest->data[0] == '(' ? memchr(rest->data, ')', rest->size) : NULL;
    if (!end) {
        return false;
    }
    struct text inner = {rest->data + 1, (size_t)(end - rest->data) - 1};
    struct text field;
    bool more = true;
    int count = 0;
    while (text_field(&inner, ',', &more, &field)) {
        if (count == 3 || !text_to_double(text_trim(field), &out[count])) {
            return false;
        }
        count++;
    }
    *rest = (struct text){end + 1, rest->size - (size_t)(end + 1 - rest->data)};
    return count == 3;
}

static conus_status read_sizes(struct axes *axes, const struct nrrd_header *header)
{
    int64_t dimension = 0;
    size_t count = 0;
    conus_status status = header_need(header->fields[NRRD_DIMENSION], "dimension", "allowed are 3 and 4");
    status = status ? status : header_integer(&dimension, header->fields[NRRD_DIMENSION], 1, "dimension");
    if (!status && dimension != 3 && dimension != AXES) {
        return fail(CONUS_ERROR_UNSUPPORTED, "dimension: found %lld, allowed are 3 and 4", (long long)dimension);
    }
    status = status ? status : header_need(header->fields[NRRD_SIZES], "sizes", "a number of each axis is needed");
    status = status ? status : header_integers(axes->sizes, AXES, &count, header->fields[NRRD_SIZES], 1, "sizes");
    if (!status && count != (size_t)dimension) {
        return fail(CONUS_ERROR_DATA, "sizes: found %zu numbers, the dimension is %lld", count, (long long)dimension);
    }
    axes->count = count;
    return status;
}

static conus_status read_directions(struct axes *axes, struct text value)
{
    struct text rest = value;
    size_t spaces = 0;
    axes->list = AXES;
    conus_status status = header_need(value, "space directions", "a direction of each axis, or none, is needed");
    for (size_t i = 0; !status && i < axes->count; i++) {
        bool none = false;
        if (!read_vector(axes->directions[i], &none, &rest)) {
            return fail(CONUS_ERROR_DATA, "space directions: found \"%.*s\", for each axis (x,y,z) or none is needed",
                        HEADER_SHOW(value));
        }
        axes->is_space[i] = !none;
        axes->list = none ? i : axes->list;
        spaces += !none;
    }
    if (!status && text_trim(rest).size) {
        return fail(CONUS_ERROR_DATA, "space directions: found more than the %zu axes have", axes->count);
    }
    bool middle = axes->count == AXES && axes->list != 0 && axes->list != AXES - 1;
    if (!status && (spaces != 3 || middle)) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "space directions: found \"%.*s\", needed are three directions, and none of the first or the last "
                    "axis where there are four",
                    HEADER_SHOW(value));
    }
    return status;
}

/* Kinds of one number per voxel and volume; colours and matrices are read as no values. */
static conus_status check_kinds(const struct axes *axes, struct text value)
{
    static const struct header_key known[] = {{"domain", 1},    {"space", 1},
                                              {"???", 1},       {"none", 1},
                                              {"list", 0},      {"time", 0},
                                              {"vector", 0},    {"point", 0},
                                              {"stub", 0},      {"scalar", 0},
                                              {"2-vector", 0},  {"3-vector", 0},
                                              {"4-vector", 0},  {"covariant-vector", 0},
                                              {"normal", 0},    {"3-normal", 0},
                                              {"3-gradient", 0}};
    struct text word;
    size_t count = 0;
    for (struct text rest = value; value.data && text_word(&rest, &word); count++) {
        int kind = header_find(known, sizeof known / sizeof known[0], word);
        if (kind < 0 || (kind == 0 && count < axes->count && axes->is_space[count])) {
            return fail(CONUS_ERROR_UNSUPPORTED,
                        "kinds: found \"%.*s\", allowed are domain and space of an axis with "
                        "a direction, list, time and vectors of another",
                        HEADER_SHOW(word));
        }
    }
    return !value.data || count == axes->count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "kinds: found %zu, the dimension is %zu", count, axes->count);
}

/* Spacings beside directions say the same twice, or are nan. */
static conus_status check_spacings(const struct axes *axes, struct text value)
{
    double spacings[AXES];
    conus_status status = value.data ? header_numbers(spacings, axes->count, value, "spacings") : CONUS_OK;
    for (size_t i = 0; !status && value.data && i < axes->count; i++) {
        double length = vec3_length(axes->directions[i]);
        bool same = isnan(spacings[i]) || !axes->is_space[i] || fabs(spacings[i] - length) <= 1e-3 * length;
        if (!same) {
            return fail(CONUS_ERROR_DATA, "spacings: found %g of axis %zu, whose space direction has length %g",
                        spacings[i], i, length);
        }
    }
    return status;
}

/* The signs of x and y that lead to RAS. */
static conus_status read_space(double signs[3], const struct nrrd_header *header)
{
    static const struct header_key names[] = {{"RAS", 0}, {"right-anterior-superior", 0},
                                              {"LAS", 1}, {"left-anterior-superior", 1},
                                              {"LPS", 2}, {"left-posterior-superior", 2}};
    struct text value = header->fields[NRRD_SPACE];
    if (!value.data) {
        return fail(CONUS_ERROR_DATA,
                    "space: missing, so it is not known which side is left; allowed are RAS, LAS and LPS");
    }
    int space = header_find(names, sizeof names / sizeof names[0], value);
    if (space < 0) {
        return fail(CONUS_ERROR_UNSUPPORTED, "space: found \"%.*s\", allowed are RAS, LAS and LPS", HEADER_SHOW(value));
    }
    if (header->fields[NRRD_SPACE_DIMENSION].data) {
        return fail(CONUS_ERROR_DATA, "space dimension: found beside \"space\", allowed is one of them");
    }
    signs[0] = space > 0 ? -1 : 1;
    signs[1] = space > 1 ? -1 : 1;
    signs[2] = 1;
    return CONUS_OK;
}

/* "mm" "mm" "mm": one unit, in mm. */
static conus_status read_units(double *mm, struct text value)
{
    *mm = 1;
    for (int i = 0; value.data && i < 3; i++) {
        struct text unit;
        struct text before;
        bool more = true;
        bool found = text_field(&value, '"', &more, &before) && more && text_field(&value, '"', &more, &unit) && more;
        bool unknown = found && (!unit.size || text_equal(unit, "???"));
        double factor = unknown ? 1 : found ? header_unit(unit) : 0;
        if (factor == 0 || text_trim(before).size || (i && factor != *mm)) {
            return fail(CONUS_ERROR_UNSUPPORTED,
                        "space units: needed are three times the same, of \"mm\", \"um\", \"cm\" and \"m\"");
        }
        *mm = factor;
    }
    return CONUS_OK;
}

/* The Allen Institute's volumes count micrometres and call AP, DV and ML x, y and z: "space directions" of 25, 0, 0 and
 * so on. No other brain is that large, and they are placed as they are meant: from the corner backward, downward and to
 * the right. *done is false for others. */
static conus_status place_ccf(struct text_volume *out, bool *done, struct notes *notes)
{
    double *m = out->world_from_voxel;
    double size[3];
    double inverse[16];
    bool plain = m[12] == 0 && m[13] == 0 && m[14] == 0 && mat4_invert_affine(inverse, m);
    for (size_t i = 0; i < 3; i++) {
        const double *step = m + 4 * i;
        double length = vec3_length(step);
        plain = plain && (fabs(step[0]) == length || fabs(step[1]) == length || fabs(step[2]) == length);
        size[i] = length * (double)out->dim[i];
    }
    *done = plain && frame_is_ccf_size(size);
    if (!*done) {
        return CONUS_OK;
    }
    double steps[3];
    for (size_t i = 0; i < 3; i++) {
        steps[i] = size[i] / (double)out->dim[i] / 1000;
    }
    const double placed[16] = {
        0, -steps[0], 0, 0, 0, 0, -steps[1], 0, steps[2], 0, 0, 0, steps[2] / 2, -steps[0] / 2, -steps[1] / 2, 1};
    memcpy(m, placed, sizeof placed);
    snprintf(out->transform, sizeof out->transform, "the Allen CCF's grid");
    return notes_add(notes,
                     "space directions: the grid is the Allen CCF's in micrometres, and is placed as that one: x = "
                     "ML, y = -AP, z = -DV from its corner, in mm");
}

/* A brain is not larger than a metre: such a file means something else by its numbers. */
static conus_status note_size(const struct text_volume *out, struct notes *notes)
{
    static const double most = 1000;
    double largest = 0;
    for (int i = 0; i < 3; i++) {
        largest = fmax(largest, vec3_length(out->world_from_voxel + 4 * (size_t)i) * (double)out->dim[i]);
    }
    return largest > most ? notes_warn(notes,
                                       "space directions: the grid is %g mm long: are they micrometres? The header "
                                       "has no \"space units\", so they were taken as millimetres",
                                       largest)
                          : CONUS_OK;
}

static conus_status place(struct text_volume *out, const struct axes *axes, const struct nrrd_header *header,
                          struct notes *notes)
{
    double signs[3];
    double origin[3];
    double mm;
    bool none = false;
    struct text rest = header->fields[NRRD_ORIGIN];
    conus_status status = read_space(signs, header);
    status = status ? status : read_units(&mm, header->fields[NRRD_SPACE_UNITS]);
    status = status ? status : header_need(rest, "space origin", "a point (x,y,z) is needed");
    if (!status && (!read_vector(origin, &none, &rest) || none || text_trim(rest).size)) {
        return fail(CONUS_ERROR_DATA, "space origin: found \"%.*s\", a point (x,y,z) is needed",
                    HEADER_SHOW(header->fields[NRRD_ORIGIN]));
    }
    if (status) {
        return status;
    }
    mat4_identity(out->world_from_voxel);
    size_t axis = axes->list == 0;
    for (size_t column = 0; column < 4; column++, axis++) {
        for (size_t row = 0; row < 3; row++) {
            out->world_from_voxel[4 * column + row] =
                (column < 3 ? axes->directions[axis][row] : origin[row]) * signs[row] * mm;
        }
    }
    snprintf(out->transform, sizeof out->transform, "space directions, %.*s", HEADER_SHOW(header->fields[NRRD_SPACE]));
    bool done = false;
    status = header->fields[NRRD_SPACE_UNITS].data ? CONUS_OK : place_ccf(out, &done, notes);
    return status || done || header->fields[NRRD_SPACE_UNITS].data ? status : note_size(out, notes);
}

conus_status nrrd_axes_read(struct text_volume *out, const struct nrrd_header *header, struct notes *notes)
{
    struct axes axes = {0};
    conus_status status = read_sizes(&axes, header);
    status = status || header->fields[NRRD_SPACE].data ? status : read_space((double[3]){0}, header); /* its words */
    status = status ? status : read_directions(&axes, header->fields[NRRD_DIRECTIONS]);
    status = status ? status : check_kinds(&axes, header->fields[NRRD_KINDS]);
    status = status ? status : check_spacings(&axes, header->fields[NRRD_SPACINGS]);
    if (status) {
        return status;
    }
    size_t first = axes.list == 0;
    for (size_t i = 0; i < 3; i++) {
        out->dim[i] = axes.sizes[first + i];
    }
    out->count = axes.list < AXES ? axes.sizes[axes.list] : 1;
    out->interleaved = first && out->count > 1;
    return place(out, &axes, header, notes);
}
