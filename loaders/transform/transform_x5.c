/* SPDX-License-Identifier: BSD-3-Clause */
/* X5, a draft of BIDS, as nitransforms writes it: RAS mm, from points of the reference to the moving image. */
#include "base/geometry/math3.h"
#include "loaders/transform/transform.h"

enum { CHAIN_LIMIT = 64 };

bool x5_is(const struct hdf5 *hdf5)
{
    const struct hdf5_object *root = hdf5_find(hdf5, "/");
    return root && text_equal(hdf5_text(hdf5_attribute(root, "Format")), "X5");
}

static void check_version(struct job *job, const struct hdf5 *hdf5)
{
    const struct hdf5_object *root = hdf5_find(hdf5, "/");
    const struct hdf5_value *version = root ? hdf5_attribute(root, "Version") : NULL;
    double number = version && hdf5_is_number(version) && version->count == 1 ? hdf5_number(version, 0) : NAN;
    if (number != 1) {
        job_refuse(job, "Version: found %g of X5, a draft, of which 1 is read", number);
    }
}

/* A matrix by rows, with the last row 0 0 0 1. */
static void take_matrix(struct job *job, double out[16], const struct hdf5_value *value, const char *what)
{
    mat4_identity(out);
    if (!value || !hdf5_is_number(value) || value->count != 16) {
        job_refuse(job, "%s: %zu values, one matrix of 4 x 4 numbers is read", what, value ? value->count : 0);
        return;
    }
    for (size_t i = 0; i < 16; i++) {
        out[4 * (i % 4) + i / 4] = hdf5_number(value, i);
    }
    if (!mat4_settle_last_row(out) || !mat4_is_affine(out)) {
        job_bad(job, "%s: no affine matrix", what);
    }
}

static const struct hdf5_value *value_in(const struct hdf5 *hdf5, struct text group, const char *name)
{
    const struct hdf5_object *object = hdf5_find_in(hdf5, group, name);
    return object ? &object->value : NULL;
}

/* A vector at each voxel of the reference: [i, j, k, 3], the last is the fastest. */
static void add_field(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5, struct text group,
                      bool displacements)
{
    const struct hdf5_value *data = value_in(hdf5, group, "Transform");
    double world_from_voxel[16];
    if (!data || data->class != HDF5_FLOAT || data->rank != 4 || data->dims[3] != 3) {
        job_bad(job, "Transform: a field of X x Y x Z x 3 numbers is needed");
        return;
    }
    const size_t dim[3] = {(size_t)data->dims[0], (size_t)data->dims[1], (size_t)data->dims[2]};
    const struct hdf5_object *mapping =
        hdf5_find(hdf5, job_format(job, "%.*s/Domain/Mapping", TEXT_SHOW(group, 100))); /* of the reference's voxels */
    take_matrix(job, world_from_voxel, mapping ? &mapping->value : NULL, "Domain/Mapping");
    struct deformation *field = chain_add_field(job, chain, dim, world_from_voxel, displacements);
    for (size_t place = 0; job_ok(job) && place < data->count; place++) {
        size_t node = place / 3;
        size_t i = node / dim[2] / dim[1];
        size_t j = node / dim[2] % dim[1];
        size_t k = node % dim[2];
        size_t to = 3 * (i + dim[0] * (j + dim[1] * k)) + place % 3;
        if (!chain_set_number(job, field, to, hdf5_number(data, place))) {
            job_bad(job, "Transform: the vector of voxel (%zu, %zu, %zu) is not finite", i, j, k);
        }
    }
}

static void add_group(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5,
                      const struct hdf5_object *group)
{
    struct text path = group->value.name;
    struct text type = hdf5_text(hdf5_attribute(group, "Type"));
    struct text kind = hdf5_text(hdf5_attribute(group, "SubType"));
    struct text form = hdf5_text(hdf5_attribute(group, "Representation"));
    bool displacements = text_equal(form, "displacements");
    bool positions = text_equal(form, "deformations");
    double m[16];
    if (text_equal(type, "linear") && (!kind.size || text_equal(kind, "affine"))) {
        take_matrix(job, m, value_in(hdf5, path, "Transform"), "Transform");
        chain_add_matrix(job, chain, m);
    } else if (text_equal(type, "nonlinear") && text_equal(kind, "densefield") && (displacements || positions)) {
        add_field(job, chain, hdf5, path, displacements);
    } else {
        job_refuse(job,
                   "Type %.*s, SubType %.*s, Representation %.*s: linear, and densefield of displacements or "
                   "deformations are read",
                   TEXT_SHOW(type, 20), TEXT_SHOW(kind, 20), TEXT_SHOW(form, 20));
    }
}

/* The groups in the order in which points go through them: "0/1". Without a chain there is one. */
static size_t take_order(struct job *job, size_t order[CHAIN_LIMIT], const struct hdf5 *hdf5, size_t count)
{
    size_t at = 0;
    size_t steps = 0;
    const struct text name = text_from("/TransformChain");
    const struct hdf5_object *chain = hdf5_next_in(hdf5, &at, name);
    if (chain && hdf5_next_in(hdf5, &at, name)) {
        job_refuse(job, "/TransformChain: several chains, one is read");
    }
    if (!chain) {
        if (count != 1) {
            job_refuse(job, "%zu transforms, and no /TransformChain of them", count);
        }
        order[0] = 0;
        return 1;
    }
    struct text rest = hdf5_text(&chain->value);
    struct text part;
    for (bool more = true; job_ok(job) && text_field(&rest, '/', &more, &part);) {
        uint64_t index = 0;
        if (steps == CHAIN_LIMIT || !text_to_uint(part, count - 1, &index)) {
            job_bad(job, "/TransformChain: \"%.*s\", up to %d numbers below %zu are needed", TEXT_SHOW(part, 20),
                    CHAIN_LIMIT, count);
        } else {
            order[steps++] = (size_t)index;
        }
    }
    if (!steps) {
        job_bad(job, "/TransformChain: no text with numbers");
    }
    return steps;
}

const char *x5_parse(struct job *job, struct transform_chain *chain, const struct hdf5 *hdf5)
{
    size_t order[CHAIN_LIMIT];
    size_t count;
    check_version(job, hdf5);
    const struct hdf5_object **groups = chain_groups(job, &count, hdf5);
    size_t steps = job_ok(job) ? take_order(job, order, hdf5, count) : 0;
    for (size_t i = steps; job_ok(job) && i-- > 0;) { /* a step goes before those added so far */
        add_group(job, chain, hdf5, groups[order[i]]);
    }
    const char *words = "of X5, points of the reference go to the moving image through";
    for (size_t i = 0; job_ok(job) && i < steps; i++) {
        struct text kind = hdf5_text(hdf5_attribute(groups[order[i]], "SubType"));
        words = job_format(job, "%s%s %.*s", words, i ? ", then" : "", TEXT_SHOW(kind, 20));
    }
    return words;
}
