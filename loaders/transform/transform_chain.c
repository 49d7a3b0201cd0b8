/* SPDX-License-Identifier: BSD-3-Clause */
/* Puts the steps of a chain together. */
#include "loaders/transform/transform_chain.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

enum { DIM_LIMIT = 1 << 20 };

static const double none[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

void transform_chain_finish(struct transform_chain *chain)
{
    for (size_t i = 0; i < chain->count; i++) {
        deformation_finish(&chain->fields[i]);
    }
    memory_free(chain->fields);
    *chain = (struct transform_chain){0};
}

void chain_begin(struct transform_chain *chain)
{
    *chain = (struct transform_chain){0};
    mat4_identity(chain->matrix);
}

conus_status chain_add_matrix(struct transform_chain *chain, const double m[16])
{
    double inverse[16];
    if (!mat4_invert_affine(inverse, m)) {
        return fail(CONUS_ERROR_DATA, "the matrix is singular, an invertible one is needed");
    }
    mat4_multiply(chain->matrix, chain->matrix, m);
    return CONUS_OK;
}

conus_status chain_push(struct transform_chain *chain, struct deformation *field)
{
    struct deformation *fields = memory_resize(chain->fields, chain->count + 1, sizeof *fields);
    if (!fields) {
        return CONUS_ERROR_MEMORY;
    }
    chain->fields = fields;
    deformation_fold(field, none, chain->matrix);
    mat4_identity(chain->matrix);
    fields[chain->count++] = *field;
    *field = (struct deformation){0};
    return CONUS_OK;
}

conus_status chain_add_field(struct deformation **out, struct transform_chain *chain, const size_t dim[3],
                             const double world_from_voxel[16], bool displacements, uint64_t max_memory)
{
    struct deformation field = {.stays_outside = displacements};
    size_t nodes = 1;
    for (int a = 0; a < 3; a++) {
        if (dim[a] < 2 || dim[a] > DIM_LIMIT) {
            return fail(CONUS_ERROR_DATA, "the field's size along %c: found %zu, 2 to %d are allowed", "ijk"[a], dim[a],
                        DIM_LIMIT);
        }
        field.dim[a] = dim[a];
        nodes *= dim[a]; /* below 2^60 */
    }
    if (nodes > memory_limit(max_memory) / (3 * sizeof *field.vectors)) {
        return fail(CONUS_ERROR_MEMORY, "a field of %zu vectors of %zu bytes each, allowed are %llu (--max-memory)",
                    nodes, 3 * sizeof *field.vectors, (unsigned long long)memory_limit(max_memory));
    }
    memcpy(field.world_from_voxel, world_from_voxel, sizeof field.world_from_voxel);
    conus_status status = space_invert(field.voxel_from_world, world_from_voxel, "the field's grid");
    if (status) {
        return status;
    }
    if (displacements) {
        memcpy(field.base, world_from_voxel, sizeof field.base);
    } else {
        field.base[15] = 1;
    }
    mat4_identity(field.linear);
    field.vectors = memory_raw(nodes, 3 * sizeof *field.vectors);
    status = field.vectors ? chain_push(chain, &field) : CONUS_ERROR_MEMORY;
    if (status) {
        deformation_finish(&field);
        return status;
    }
    *out = &chain->fields[chain->count - 1];
    return CONUS_OK;
}

bool chain_set_number(conus_status *status, struct deformation *field, size_t place, double number)
{
    float near = (float)number;
    float rest = (float)(number - (double)near);
    if (rest != 0 && !field->rest) {
        field->rest = memory_zeroed(field->dim[0] * field->dim[1] * field->dim[2], 3 * sizeof *field->rest);
        *status = field->rest ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    field->vectors[place] = near;
    if (field->rest) {
        field->rest[place] = rest;
    }
    return !*status && isfinite(near);
}

conus_status chain_end(struct transform_chain *chain)
{
    if (!chain->count) {
        return CONUS_OK;
    }
    struct deformation *first = &chain->fields[chain->count - 1];
    deformation_fold(first, chain->matrix, none);
    mat4_identity(chain->matrix);
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < chain->count; i++) {
        status = deformation_measure(&chain->fields[i]);
    }
    return status;
}

conus_status chain_groups(const struct hdf5_object ***out, size_t *count, const struct hdf5 *hdf5)
{
    const struct text group = text_from("/TransformGroup");
    const struct hdf5_object **groups = memory_zeroed(hdf5_count(hdf5), sizeof(struct hdf5_object *));
    const struct hdf5_object *next;
    conus_status status = groups ? CONUS_OK : CONUS_ERROR_MEMORY;
    size_t at = 0;
    size_t found = 0;
    while (!status && (next = hdf5_next_in(hdf5, &at, group))) {
        struct text name = hdf5_last_name(next->value.name);
        uint64_t number = 0;
        if (next->value.class != HDF5_GROUP || !text_to_uint(name, SIZE_MAX, &number) || number != found) {
            status = fail(CONUS_ERROR_DATA, "/TransformGroup: found \"%.*s\", the group %zu is needed",
                          TEXT_SHOW(name, 40), found);
        }
        groups[found++] = next;
    }
    if (!status && !found) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "HDF5 without transforms in /TransformGroup: neither a composite of ITK "
                                               "or ANTs, nor X5");
    }
    if (status) {
        memory_free(groups);
        return status;
    }
    *out = groups;
    *count = found;
    return CONUS_OK;
}
