/* SPDX-License-Identifier: BSD-3-Clause */
/* Composites of ITK in HDF5, as antsRegistration, CompositeTransformUtil and fMRIPrep write them: itk::HDF5TransformIO.
 */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/transform/transform_chain.h"
#include "loaders/transform/transform_formats.h"

#include <stdio.h>
#include <string.h>

/* One group of the file. */
struct itk_group {
    struct text type, path;
    const struct hdf5_value *parameters, *fixed; /* NULL = there are none */
};

static size_t count_of(const struct hdf5_value *value)
{
    return value ? value->count : 0;
}

/* The numbers `key`, which ITK 4 spelled without its s; NULL if the group has none. */
static conus_status take_numbers(const struct hdf5_value **out, const struct hdf5 *hdf5, struct text group,
                                 const char *key, const char *old_key)
{
    const struct hdf5_object *object = hdf5_find_in(hdf5, group, key);
    object = object ? object : hdf5_find_in(hdf5, group, old_key);
    *out = object ? &object->value : NULL;
    return !object || object->value.class == HDF5_FLOAT
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%.*s: no floating-point numbers", TEXT_SHOW(object->value.name, 80));
}

static conus_status take_group(struct itk_group *out, const struct hdf5 *hdf5, const struct hdf5_object *group)
{
    struct text path = group->value.name;
    const struct hdf5_object *type = hdf5_find_in(hdf5, path, "TransformType");
    if (!type || type->value.class != HDF5_STRING || type->value.count != 1) {
        return fail(CONUS_ERROR_DATA, "%.*s/TransformType: one text is needed", TEXT_SHOW(path, 40));
    }
    out->path = path;
    out->type = text_trim(hdf5_string(&type->value, 0));
    conus_status status = take_numbers(&out->parameters, hdf5, path, "TransformParameters", "TranformParameters");
    return status ? status
                  : take_numbers(&out->fixed, hdf5, path, "TransformFixedParameters", "TranformFixedParameters");
}

/* All numbers of a value, to be freed. */
static conus_status copy_numbers(double **out, const struct hdf5_value *value)
{
    size_t count = count_of(value);
    double *numbers = memory_raw(count ? count : 1, sizeof *numbers);
    for (size_t i = 0; numbers && i < count; i++) {
        numbers[i] = hdf5_number(value, i);
        if (!isfinite(numbers[i])) {
            memory_free(numbers);
            return fail(CONUS_ERROR_DATA, "%.*s: number %zu is not finite", TEXT_SHOW(value->name, 80), i);
        }
    }
    *out = numbers;
    return numbers ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* An affine or a B-spline. */
static conus_status add_other(struct transform_chain *chain, const struct itk_group *group)
{
    struct itk_entry entry = {.type = group->type,
                              .count = count_of(group->parameters),
                              .fixed_count = count_of(group->fixed),
                              .has_parameters = true,
                              .has_fixed = true};
    conus_status status = copy_numbers(&entry.parameters, group->parameters);
    status = status ? status : copy_numbers(&entry.fixed, group->fixed);
    status = status ? status : itk_chain_add(chain, &entry);
    memory_free(entry.parameters);
    memory_free(entry.fixed);
    return status;
}

/* A field's fixed parameters: size, origin, spacing, direction by rows, all of LPS. */
enum { FIXED_SIZE = 0, FIXED_ORIGIN = 3, FIXED_SPACING = 6, FIXED_DIRECTION = 9, FIXED_COUNT = 18 };

static conus_status take_grid(size_t dim[3], double world_from_voxel[16], const struct hdf5_value *fixed)
{
    double f[FIXED_COUNT];
    for (size_t i = 0; i < FIXED_COUNT; i++) {
        f[i] = count_of(fixed) == FIXED_COUNT ? hdf5_number(fixed, i) : NAN;
        if (!isfinite(f[i])) {
            return fail(CONUS_ERROR_DATA, "FixedParameters: %zu numbers, a field has 18 finite ones", count_of(fixed));
        }
    }
    mat4_identity(world_from_voxel);
    for (size_t a = 0; a < 3; a++) {
        double size = f[FIXED_SIZE + a];
        double spacing = f[FIXED_SPACING + a];
        if (!(size >= 1 && size <= UINT32_MAX && size == floor(size)) || !(spacing > 0)) {
            return fail(CONUS_ERROR_DATA, "FixedParameters: size %g and spacing %g along %c", size, spacing, "ijk"[a]);
        }
        dim[a] = (size_t)size;
        for (size_t row = 0; row < 3; row++) {
            double flip = row < 2 ? -1 : 1;
            world_from_voxel[4 * a + row] = flip * f[FIXED_DIRECTION + 3 * row + a] * spacing;
            world_from_voxel[12 + row] = flip * f[FIXED_ORIGIN + row];
        }
    }
    return CONUS_OK;
}

static conus_status add_field(struct transform_chain *chain, const struct itk_group *group, uint64_t max_memory)
{
    double world_from_voxel[16];
    size_t dim[3];
    size_t count = 3;
    const struct hdf5_value *parameters = group->parameters;
    struct deformation *field = NULL;
    conus_status status = take_grid(dim, world_from_voxel, group->fixed);
    bool fits = true;
    for (int a = 0; !status && a < 3; a++) {
        fits = fits && memory_multiply(count, dim[a], &count);
    }
    if (!status && (!fits || count_of(parameters) != count)) {
        status = fail(CONUS_ERROR_DATA, "Parameters: %zu numbers, a field of %zu x %zu x %zu nodes has three for each",
                      count_of(parameters), dim[0], dim[1], dim[2]);
    }
    status = status ? status : chain_add_field(&field, chain, dim, world_from_voxel, true, max_memory);
    for (size_t i = 0; !status && i < count; i++) {
        double number = hdf5_number(parameters, i);
        if (!chain_set_number(&status, field, i, i % 3 < 2 ? -number : number) && !status) {
            status = fail(CONUS_ERROR_DATA, "Parameters: number %zu is not finite", i);
        }
    }
    return status;
}

static conus_status add_group(struct transform_chain *chain, const struct itk_group *group, uint64_t max_memory)
{
    bool is_field = itk_is_type(group->type, "DisplacementFieldTransform") ||
                    itk_is_type(group->type, "GaussianSmoothingOnUpdateDisplacementFieldTransform") ||
                    itk_is_type(group->type, "BSplineSmoothingOnUpdateDisplacementFieldTransform");
    if (itk_is_composite(group->type)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "a composite within a composite");
    }
    return is_field ? add_field(chain, group, max_memory) : add_other(chain, group);
}

conus_status itk_hdf5_parse(struct transform_chain *chain, const struct hdf5 *hdf5, uint64_t max_memory,
                            struct buffer *words)
{
    const struct hdf5_object **groups = NULL;
    size_t count = 0;
    struct itk_group group = {0};
    conus_status status = chain_groups(&groups, &count, hdf5);
    status = status ? status : take_group(&group, hdf5, groups[0]);
    bool is_composite = !status && itk_is_composite(group.type);
    if (!status && is_composite && count_of(group.parameters)) {
        status = fail(CONUS_ERROR_DATA, "/TransformGroup/0: a composite with parameters of its own");
    }
    if (!status && is_composite && count == 1) {
        status = fail(CONUS_ERROR_DATA, "/TransformGroup: a composite of nothing");
    }
    if (!status && !is_composite && count > 1) {
        status = fail(CONUS_ERROR_UNSUPPORTED,
                      "/TransformGroup: a list of %zu, and no CompositeTransform that makes a chain of them", count);
    }
    for (size_t i = is_composite; !status && i < count; i++) {
        status = take_group(&group, hdf5, groups[i]);
        status = status ? status : add_group(chain, &group, max_memory);
        if (status) {
            char where[80];
            snprintf(where, sizeof where, "%.*s", TEXT_SHOW(groups[i]->value.name, 60));
            status = fail_in(status, where);
        }
    }
    if (!status) {
        buffer_text(words, "of ITK, points go through");
        for (size_t i = count; i-- > is_composite;) { /* the last one first */
            (void)take_group(&group, hdf5, groups[i]);
            buffer_format(words, "%s %.*s", i + 1 < count ? ", then" : "", TEXT_SHOW(group.type, 80));
        }
    }
    memory_free(groups);
    return status;
}
