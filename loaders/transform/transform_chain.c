/* SPDX-License-Identifier: BSD-3-Clause */
/* Puts the steps of a chain together. */
#include "loaders/transform/transform.h"

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

void chain_add_matrix(struct job *job, struct transform_chain *chain, const double m[16])
{
    double inverse[16];
    if (job_ok(job) && !mat4_invert_affine(inverse, m)) {
        job_bad(job, "the matrix is singular, an invertible one is needed");
    }
    if (job_ok(job)) {
        mat4_multiply(chain->matrix, chain->matrix, m);
    }
}

void chain_push(struct job *job, struct transform_chain *chain, struct deformation *field)
{
    struct deformation *fields = job_step(job) ? memory_resize(chain->fields, chain->count + 1, sizeof *fields) : NULL;
    if (!job_need(job, fields)) {
        deformation_finish(field);
        return;
    }
    chain->fields = fields;
    deformation_fold(field, none, chain->matrix);
    mat4_identity(chain->matrix);
    fields[chain->count++] = *field;
}

struct deformation *chain_add_field(struct job *job, struct transform_chain *chain, const size_t dim[3],
                                    const double world_from_voxel[16], bool displacements)
{
    struct deformation field = {.stays_outside = displacements};
    const uint64_t limit = memory_limit(job->max_memory);
    size_t nodes = 1;
    for (int a = 0; job_ok(job) && a < 3; a++) {
        if (dim[a] < 2 || dim[a] > DIM_LIMIT) {
            job_bad(job, "the field's size along %c: found %zu, 2 to %d are allowed", "ijk"[a], dim[a], DIM_LIMIT);
        }
        field.dim[a] = dim[a];
        nodes *= dim[a]; /* below 2^60 */
    }
    if (nodes > limit / (3 * sizeof *field.vectors)) {
        job_fail(job, CONUS_ERROR_MEMORY, "a field of %zu vectors of %zu bytes each, allowed are %llu (--max-memory)",
                 nodes, 3 * sizeof *field.vectors, (unsigned long long)limit);
    }
    if (!JOB_CALL(job, space_invert(field.voxel_from_world, world_from_voxel, "the field's grid"))) {
        return NULL;
    }
    memcpy(field.world_from_voxel, world_from_voxel, sizeof field.world_from_voxel);
    if (displacements) {
        memcpy(field.base, world_from_voxel, sizeof field.base);
    } else {
        field.base[15] = 1;
    }
    mat4_identity(field.linear);
    field.vectors = memory_raw(nodes, 3 * sizeof *field.vectors);
    job_need(job, field.vectors);
    chain_push(job, chain, &field);
    return job_ok(job) ? &chain->fields[chain->count - 1] : NULL;
}

bool chain_set_number(struct job *job, struct deformation *field, size_t place, double number)
{
    float near = (float)number;
    float rest = (float)(number - (double)near);
    if (rest != 0 && !field->rest) {
        field->rest = memory_zeroed(field->dim[0] * field->dim[1] * field->dim[2], 3 * sizeof *field->rest);
        job_need(job, field->rest);
    }
    field->vectors[place] = near;
    if (field->rest) {
        field->rest[place] = rest;
    }
    return isfinite(near);
}

void chain_end(struct job *job, struct transform_chain *chain)
{
    if (!chain->count || !job_ok(job)) {
        return;
    }
    deformation_fold(&chain->fields[chain->count - 1], chain->matrix, none);
    mat4_identity(chain->matrix);
    for (size_t i = 0; i < chain->count; i++) {
        (void)JOB_CALL(job, deformation_measure(&chain->fields[i]));
    }
}

const struct hdf5_object **chain_groups(struct job *job, size_t *count, const struct hdf5 *hdf5)
{
    const struct text group = text_from("/TransformGroup");
    const struct hdf5_object **groups = job_zeroed(job, hdf5_count(hdf5), sizeof(struct hdf5_object *));
    const struct hdf5_object *next;
    size_t at = 0;
    *count = 0;
    while (job_ok(job) && (next = hdf5_next_in(hdf5, &at, group))) {
        struct text name = hdf5_last_name(next->value.name);
        uint64_t number = 0;
        if (next->value.class != HDF5_GROUP || !text_to_uint(name, SIZE_MAX, &number) || number != *count) {
            job_bad(job, "/TransformGroup: found \"%.*s\", the group %zu is needed", TEXT_SHOW(name, 40), *count);
        }
        groups[(*count)++] = next;
    }
    if (!*count) {
        job_refuse(job, "HDF5 without transforms in /TransformGroup: neither a composite of ITK or ANTs, nor X5");
    }
    *count = job_ok(job) ? *count : 0;
    return groups;
}

void flirt_from_voxel(double out[16], const conus_volume_info *info)
{
    mat4_identity(out);
    for (int a = 0; a < 3; a++) {
        out[5 * a] = info->spacing[a];
    }
    if (mat4_determinant3(info->world_from_voxel) > 0) {
        out[0] = -info->spacing[0];
        out[12] = info->spacing[0] * (double)(info->dim[0] - 1);
    }
}

void world_from_flirt(struct job *job, double out[16], const conus_volume_info *info)
{
    double flirt[16];
    double voxel[16];
    flirt_from_voxel(flirt, info);
    if (!mat4_invert_affine(voxel, flirt)) {
        job_bad(job, "the matrix of an image is singular");
        return;
    }
    mat4_multiply(out, info->world_from_voxel, voxel);
}
