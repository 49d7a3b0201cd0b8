/* SPDX-License-Identifier: BSD-3-Clause */
/* Composites of ITK in HDF5, as antsRegistration, CompositeTransformUtil and fMRIPrep write them: itk::HDF5TransformIO.
 */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/transform/transform.h"

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
static const struct hdf5_value *find_numbers(struct job *job, const struct hdf5 *hdf5, struct text group,
                                             const char *key, const char *old_key)
{
    const struct hdf5_object *object = hdf5_find_in(hdf5, group, key);
    object = object ? object : hdf5_find_in(hdf5, group, old_key);
    if (object && object->value.class != HDF5_FLOAT) {
        job_bad(job, "%.*s: no floating-point numbers", TEXT_SHOW(object->value.name, 80));
    }
    return object ? &object->value : NULL;
}

static struct itk_group take_group(struct job *job, const struct hdf5 *hdf5, const struct hdf5_object *object)
{
    struct itk_group group = {.path = object->value.name};
    const struct hdf5_object *type = hdf5_find_in(hdf5, group.path, "TransformType");
    if (!type || type->value.class != HDF5_STRING || type->value.count != 1) {
        job_bad(job, "%.*s/TransformType: one text is needed", TEXT_SHOW(group.path, 40));
        return group;
    }
    group.type = text_trim(hdf5_string(&type->value, 0));
    group.parameters = find_numbers(job, hdf5, group.path, "TransformParameters", "TranformParameters");
    group.fixed = find_numbers(job, hdf5, group.path, "TransformFixedParameters", "TranformFixedParameters");
    return group;
}

static double *copy_numbers(struct job *job, size_t *count, const struct hdf5_value *value)
{
    *count = count_of(value);
    double *numbers = job_array(job, count, sizeof *numbers);
    for (size_t i = 0; numbers && value && i < *count; i++) {
        numbers[i] = hdf5_number(value, i);
        if (!isfinite(numbers[i])) {
            job_bad(job, "%.*s: number %zu is not finite", TEXT_SHOW(value->name, 80), i);
        }
    }
    return numbers;
}

static void add_other(struct job *job, struct transform_chain *chain, const struct itk_group *group)
{
    struct itk_entry entry = {.type = group->type, .has_parameters = true, .has_fixed = true};
    entry.parameters.at = copy_numbers(job, &entry.parameters.count, group->parameters);
    entry.fixed.at = copy_numbers(job, &entry.fixed.count, group->fixed);
    itk_chain_add(job, chain, &entry);
}

/* A field's fixed parameters: size, origin, spacing, direction by rows, all of LPS. */
enum { FIXED_SIZE = 0, FIXED_ORIGIN = 3, FIXED_SPACING = 6, FIXED_DIRECTION = 9, FIXED_COUNT = 18 };

static void take_grid(struct job *job, size_t dim[3], double world_from_voxel[16], const struct hdf5_value *fixed)
{
    double f[FIXED_COUNT];
    for (size_t i = 0; i < FIXED_COUNT; i++) {
        f[i] = count_of(fixed) == FIXED_COUNT ? hdf5_number(fixed, i) : NAN;
        if (!isfinite(f[i])) {
            job_bad(job, "FixedParameters: %zu numbers, a field has 18 finite ones", count_of(fixed));
        }
    }
    mat4_identity(world_from_voxel);
    for (size_t a = 0; job_ok(job) && a < 3; a++) {
        double size = f[FIXED_SIZE + a];
        double spacing = f[FIXED_SPACING + a];
        if (!(size >= 1 && size <= UINT32_MAX && size == floor(size)) || !(spacing > 0)) {
            job_bad(job, "FixedParameters: size %g and spacing %g along %c", size, spacing, "ijk"[a]);
            return;
        }
        dim[a] = (size_t)size;
        for (size_t row = 0; row < 3; row++) {
            double flip = row < 2 ? -1 : 1;
            world_from_voxel[4 * a + row] = flip * f[FIXED_DIRECTION + 3 * row + a] * spacing;
            world_from_voxel[12 + row] = flip * f[FIXED_ORIGIN + row];
        }
    }
}

static void add_field(struct job *job, struct transform_chain *chain, const struct itk_group *group)
{
    double world_from_voxel[16];
    size_t dim[3] = {0};
    size_t count = 3;
    const struct hdf5_value *parameters = group->parameters;
    bool fits = true;
    take_grid(job, dim, world_from_voxel, group->fixed);
    for (int a = 0; a < 3; a++) {
        fits = fits && memory_multiply(count, dim[a], &count);
    }
    if (!fits || count_of(parameters) != count) {
        job_bad(job, "Parameters: %zu numbers, a field of %zu x %zu x %zu nodes has three for each",
                count_of(parameters), dim[0], dim[1], dim[2]);
    }
    struct deformation *field = chain_add_field(job, chain, dim, world_from_voxel, true);
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        double number = hdf5_number(parameters, i);
        if (!chain_set_number(job, field, i, i % 3 < 2 ? -number : number)) {
            job_bad(job, "Parameters: number %zu is not finite", i);
        }
    }
}

static void add_group(struct job *job, struct transform_chain *chain, const struct itk_group *group)
{
    bool is_field = itk_is_type(group->type, "DisplacementFieldTransform") ||
                    itk_is_type(group->type, "GaussianSmoothingOnUpdateDisplacementFieldTransform") ||
                    itk_is_type(group->type, "BSplineSmoothingOnUpdateDisplacementFieldTransform");
    if (itk_is_composite(group->type)) {
        job_refuse(job, "a composite within a composite");
    }
    (is_field ? add_field : add_other)(job, chain, group);
}

const char *itk_hdf5_parse(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5)
{
    size_t count;
    const struct hdf5_object **objects = chain_groups(job, &count, hdf5);
    struct itk_group *groups = job_array(job, &count, sizeof *groups);
    if (count) {
        groups[0] = take_group(job, hdf5, objects[0]);
    }
    bool is_composite = count && itk_is_composite(groups[0].type);
    if (is_composite && count_of(groups[0].parameters)) {
        job_bad(job, "/TransformGroup/0: a composite with parameters of its own");
    } else if (is_composite && count == 1) {
        job_bad(job, "/TransformGroup: a composite of nothing");
    } else if (!is_composite && count > 1) {
        job_refuse(job, "/TransformGroup: a list of %zu, and no CompositeTransform that makes a chain of them", count);
    }
    const char *words = "of ITK, points go through";
    for (size_t i = is_composite; job_ok(job) && i < count; i++) {
        const size_t place = job_in(job, job_format(job, "%.*s", TEXT_SHOW(objects[i]->value.name, 60)), JOB_ALONE);
        groups[i] = take_group(job, hdf5, objects[i]);
        add_group(job, chain, &groups[i]);
        job_out(job, place);
    }
    for (size_t i = count; job_ok(job) && i-- > is_composite;) { /* the last one first */
        words = job_format(job, "%s%s %.*s", words, i + 1 < count ? ", then" : "", TEXT_SHOW(groups[i].type, 80));
    }
    return words;
}
