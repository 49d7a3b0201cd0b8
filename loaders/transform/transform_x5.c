/* SPDX-License-Identifier: BSD-3-Clause */
/* X5, a draft of BIDS, as nitransforms writes it: RAS mm, from points of the reference to the moving image. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/transform/transform_chain.h"

#include <stdio.h>
#include <string.h>

enum { CHAIN_LIMIT = 64 };

bool x5_is(const struct hdf5 *hdf5)
{
    const struct hdf5_object *root = hdf5_find(hdf5, "/");
    return root && text_equal(hdf5_text(hdf5_attribute(root, "Format")), "X5");
}

static conus_status check_version(const struct hdf5 *hdf5)
{
    const struct hdf5_value *version = hdf5_attribute(hdf5_find(hdf5, "/"), "Version");
    double number = version && hdf5_is_number(version) && version->count == 1 ? hdf5_number(version, 0) : NAN;
    return number == 1 ? CONUS_OK
                       : fail(CONUS_ERROR_UNSUPPORTED, "Version: found %g of X5, a draft, of which 1 is read", number);
}

/* A matrix by rows, with the last row 0 0 0 1. */
static conus_status take_matrix(double out[16], const struct hdf5_value *value, const char *what)
{
    if (!value || !hdf5_is_number(value) || value->count != 16) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s: %zu values, one matrix of 4 x 4 numbers is read", what,
                    value ? value->count : 0);
    }
    for (size_t i = 0; i < 16; i++) {
        out[4 * (i % 4) + i / 4] = hdf5_number(value, i);
    }
    return mat4_settle_last_row(out) && mat4_is_affine(out) ? CONUS_OK
                                                            : fail(CONUS_ERROR_DATA, "%s: no affine matrix", what);
}

static const struct hdf5_value *value_in(const struct hdf5 *hdf5, struct text group, const char *name)
{
    const struct hdf5_object *object = hdf5_find_in(hdf5, group, name);
    return object ? &object->value : NULL;
}

/* Where the reference's voxels are. */
static conus_status take_mapping(double out[16], const struct hdf5 *hdf5, struct text group)
{
    char path[128];
    snprintf(path, sizeof path, "%.*s/Domain/Mapping", TEXT_SHOW(group, 100));
    const struct hdf5_object *mapping = hdf5_find(hdf5, path);
    return take_matrix(out, mapping ? &mapping->value : NULL, "Domain/Mapping");
}

/* A vector at each voxel of the reference: [i, j, k, 3], the last is the fastest. */
static conus_status add_field(struct transform_chain *chain, const struct hdf5 *hdf5, struct text group,
                              bool displacements, uint64_t max_memory)
{
    const struct hdf5_value *data = value_in(hdf5, group, "Transform");
    double world_from_voxel[16];
    struct deformation *field = NULL;
    if (!data || data->class != HDF5_FLOAT || data->rank != 4 || data->dims[3] != 3) {
        return fail(CONUS_ERROR_DATA, "Transform: a field of X x Y x Z x 3 numbers is needed");
    }
    const size_t dim[3] = {(size_t)data->dims[0], (size_t)data->dims[1], (size_t)data->dims[2]};
    conus_status status = take_mapping(world_from_voxel, hdf5, group);
    status = status ? status : chain_add_field(&field, chain, dim, world_from_voxel, displacements, max_memory);
    for (size_t place = 0; !status && place < data->count; place++) {
        size_t node = place / 3;
        size_t i = node / dim[2] / dim[1];
        size_t j = node / dim[2] % dim[1];
        size_t k = node % dim[2];
        size_t to = 3 * (i + dim[0] * (j + dim[1] * k)) + place % 3;
        if (!chain_set_number(&status, field, to, hdf5_number(data, place)) && !status) {
            status = fail(CONUS_ERROR_DATA, "Transform: the vector of voxel (%zu, %zu, %zu) is not finite", i, j, k);
        }
    }
    return status;
}

static conus_status add_group(struct transform_chain *chain, const struct hdf5 *hdf5, const struct hdf5_object *group,
                              uint64_t max_memory)
{
    struct text path = group->value.name;
    struct text type = hdf5_text(hdf5_attribute(group, "Type"));
    struct text kind = hdf5_text(hdf5_attribute(group, "SubType"));
    struct text form = hdf5_text(hdf5_attribute(group, "Representation"));
    bool displacements = text_equal(form, "displacements");
    bool positions = text_equal(form, "deformations");
    double m[16];
    if (text_equal(type, "linear") && (!kind.size || text_equal(kind, "affine"))) {
        conus_status status = take_matrix(m, value_in(hdf5, path, "Transform"), "Transform");
        return status ? status : chain_add_matrix(chain, m);
    }
    if (text_equal(type, "nonlinear") && text_equal(kind, "densefield") && (displacements || positions)) {
        return add_field(chain, hdf5, path, displacements, max_memory);
    }
    return fail(CONUS_ERROR_UNSUPPORTED,
                "Type %.*s, SubType %.*s, Representation %.*s: linear, and densefield of displacements or deformations "
                "are read",
                TEXT_SHOW(type, 20), TEXT_SHOW(kind, 20), TEXT_SHOW(form, 20));
}

/* The groups in the order in which points go through them: "0/1". Without a chain there is one. */
static conus_status take_order(size_t order[CHAIN_LIMIT], size_t *steps, const struct hdf5 *hdf5, size_t count)
{
    size_t at = 0;
    const struct text name = text_from("/TransformChain");
    const struct hdf5_object *chain = hdf5_next_in(hdf5, &at, name);
    if (chain && hdf5_next_in(hdf5, &at, name)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "/TransformChain: several chains, one is read");
    }
    if (!chain) {
        order[0] = 0;
        *steps = 1;
        return count == 1 ? CONUS_OK
                          : fail(CONUS_ERROR_UNSUPPORTED, "%zu transforms, and no /TransformChain of them", count);
    }
    struct text rest = hdf5_text(&chain->value);
    struct text part;
    *steps = 0;
    for (bool more = true; text_field(&rest, '/', &more, &part);) {
        uint64_t index;
        if (*steps == CHAIN_LIMIT || !text_to_uint(part, count - 1, &index)) {
            return fail(CONUS_ERROR_DATA, "/TransformChain: \"%.*s\", up to %d numbers below %zu are needed",
                        TEXT_SHOW(part, 20), CHAIN_LIMIT, count);
        }
        order[(*steps)++] = (size_t)index;
    }
    return *steps ? CONUS_OK : fail(CONUS_ERROR_DATA, "/TransformChain: no text with numbers");
}

conus_status x5_parse(struct transform_chain *chain, const struct hdf5 *hdf5, uint64_t max_memory, struct buffer *words)
{
    const struct hdf5_object **groups = NULL;
    size_t order[CHAIN_LIMIT];
    size_t steps = 0;
    size_t count = 0;
    conus_status status = check_version(hdf5);
    status = status ? status : chain_groups(&groups, &count, hdf5);
    status = status ? status : take_order(order, &steps, hdf5, count);
    for (size_t i = steps; !status && i-- > 0;) { /* a step goes before those added so far */
        status = add_group(chain, hdf5, groups[order[i]], max_memory);
    }
    buffer_text(words, "of X5, points of the reference go to the moving image through");
    for (size_t i = 0; !status && i < steps; i++) {
        struct text kind = hdf5_text(hdf5_attribute(groups[order[i]], "SubType"));
        buffer_format(words, "%s %.*s", i ? ", then" : "", TEXT_SHOW(kind, 20));
    }
    memory_free(groups);
    return status;
}
