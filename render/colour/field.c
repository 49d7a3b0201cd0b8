/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes densities and gradients of areas and of grey values. */
#include "render/colour/field.h"

#include "base/math3.h"
#include "base/memory.h"

/* A trilinear sample reaches half a voxel outside its brick; one and a half more forgive a float's rounding. */
enum { BORDER = 2, MARGIN = 3 };

void field_finish(struct field *field)
{
    memory_free(field->texels);
    memory_free(field->low);
    memory_free(field->high);
    *field = (struct field){0};
}

static size_t brick_count(const struct field *field)
{
    return field->brick_dim[0] * field->brick_dim[1] * field->brick_dim[2];
}

static conus_status start_field(struct field *field, const struct volume *volume)
{
    for (int a = 0; a < 3; a++) {
        field->dim[a] = volume->info.dim[a];
        field->brick_dim[a] = (volume->info.dim[a] + BRICKS_EDGE - 1) / BRICKS_EDGE;
    }
    field->texels = memory_raw(volume->voxel_count, 4);
    field->low = memory_raw(brick_count(field), 1);
    field->high = memory_raw(brick_count(field), 1);
    return field->texels && field->low && field->high ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Gradient in world axes and per mm, from central differences per voxel: the transpose of voxel_from_world's linear
 * part. Full density is 255. */
static void encode_gradient(uint8_t *texel, const double m[16], const double per_voxel[3])
{
    double g[3];
    for (int a = 0; a < 3; a++) {
        g[a] = vec3_dot(m + 4 * (ptrdiff_t)a, per_voxel) / (FIELD_LEVELS - 1);
    }
    double scale = 127 / (vec3_length(g) + FIELD_SOFTNESS);
    for (int a = 0; a < 3; a++) {
        texel[a] = (uint8_t)lrint(128 + g[a] * scale);
    }
}

/* Central differences of `density`, one byte per voxel, at voxel `v`, one-sided at the border. */
static void difference(double out[3], const uint8_t *density, const size_t dim[3], const size_t at[3], size_t v)
{
    const size_t stride[3] = {1, dim[0], dim[0] * dim[1]};
    for (int a = 0; a < 3; a++) {
        size_t below = at[a] > 0;
        size_t above = at[a] + 1 < dim[a];
        int change = density[v + above * stride[a]] - density[v - below * stride[a]];
        out[a] = above + below ? change / (double)(above + below) : 0;
    }
}

static void differentiate(struct field *field, const uint8_t *density, const double voxel_from_world[16])
{
    const size_t *dim = field->dim;
    uint8_t *texel = field->texels;
    size_t at[3];
    size_t v = 0;
    for (at[2] = 0; at[2] < dim[2]; at[2]++) {
        for (at[1] = 0; at[1] < dim[1]; at[1]++) {
            for (at[0] = 0; at[0] < dim[0]; at[0]++, v++, texel += 4) {
                double g[3];
                difference(g, density, dim, at, v);
                encode_gradient(texel, voxel_from_world, g);
            }
        }
    }
}

static void store_density(struct field *field, const uint8_t *density, size_t count)
{
    for (size_t v = 0; v < count; v++) {
        field->texels[4 * v + 3] = density[v];
    }
}

/* First and one past the last voxel that bear on brick `b` of an axis. */
static void find_reach(size_t *first, size_t *end, size_t b, size_t dim)
{
    size_t low = b * BRICKS_EDGE;
    *first = low > BORDER ? low - BORDER : 0;
    *end = low + BRICKS_EDGE + BORDER < dim ? low + BRICKS_EDGE + BORDER : dim;
}

static void range_of_brick(struct field *field, const size_t b[3], size_t index)
{
    size_t first[3], end[3];
    for (int a = 0; a < 3; a++) {
        find_reach(&first[a], &end[a], b[a], field->dim[a]);
    }
    uint8_t low = UINT8_MAX;
    uint8_t high = 0;
    for (size_t k = first[2]; k < end[2]; k++) {
        for (size_t j = first[1]; j < end[1]; j++) {
            const uint8_t *row = field->texels + 4 * (field->dim[0] * (j + field->dim[1] * k)) + 3;
            for (size_t i = first[0]; i < end[0]; i++) {
                uint8_t value = row[4 * i];
                low = value < low ? value : low;
                high = value > high ? value : high;
            }
        }
    }
    field->low[index] = low;
    field->high[index] = high;
}

static void find_ranges(struct field *field)
{
    size_t index = 0;
    size_t b[3];
    for (b[2] = 0; b[2] < field->brick_dim[2]; b[2]++) {
        for (b[1] = 0; b[1] < field->brick_dim[1]; b[1]++) {
            for (b[0] = 0; b[0] < field->brick_dim[0]; b[0]++) {
                range_of_brick(field, b, index++);
            }
        }
    }
}

conus_status field_of_values(struct field *out, const struct volume *volume, double low, double high)
{
    struct field field = {0};
    uint8_t *density = memory_raw(volume->voxel_count, 1);
    conus_status status = density ? start_field(&field, volume) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(density);
        field_finish(&field);
        return status;
    }
    for (size_t v = 0; v < volume->voxel_count; v++) {
        double part = ((double)volume->values[v] - low) / (high - low);
        density[v] = (uint8_t)lrint(fmin(fmax(part, 0), 1) * (FIELD_LEVELS - 1));
    }
    differentiate(&field, density, volume->voxel_from_world);
    store_density(&field, density, volume->voxel_count);
    memory_free(density);
    find_ranges(&field);
    *out = field;
    return CONUS_OK;
}

/* One pass of the binomial filter 1 4 6 4 1 along the axis of `stride`, the border held. */
static void blur_axis(uint8_t *out, const uint8_t *in, const size_t dim[3], int axis)
{
    const size_t stride[3] = {1, dim[0], dim[0] * dim[1]};
    const size_t step = stride[axis];
    size_t at[3];
    size_t v = 0;
    for (at[2] = 0; at[2] < dim[2]; at[2]++) {
        for (at[1] = 0; at[1] < dim[1]; at[1]++) {
            for (at[0] = 0; at[0] < dim[0]; at[0]++, v++) {
                size_t before = at[axis] < 2 ? at[axis] : 2;
                size_t after = dim[axis] - 1 - at[axis] < 2 ? dim[axis] - 1 - at[axis] : 2;
                int near = in[v - (before > 0) * step] + in[v + (after > 0) * step];
                int far = in[v - before * step] + in[v + after * step];
                out[v] = (uint8_t)((6 * in[v] + 4 * near + far + 8) / 16);
            }
        }
    }
}

/* Blurs `density` in all three directions; `other` is scratch memory of the same size. */
static void blur(uint8_t *density, uint8_t *other, const struct field *field)
{
    blur_axis(other, density, field->dim, 0);
    blur_axis(density, other, field->dim, 1);
    blur_axis(other, density, field->dim, 2);
    memcpy(density, other, field->dim[0] * field->dim[1] * field->dim[2]);
}

static void store_occupancy(struct field *field, const uint8_t *density, const struct volume *volume)
{
    for (size_t v = 0; v < volume->voxel_count; v++) {
        int value = density[v];
        if (volume_object(volume, v)) {
            value = value > FIELD_SURFACE + MARGIN ? value : FIELD_SURFACE + MARGIN;
        } else {
            value = value < FIELD_SURFACE - MARGIN ? value : FIELD_SURFACE - MARGIN;
        }
        field->texels[4 * v + 3] = (uint8_t)value;
    }
}

conus_status field_of_objects(struct field *out, const struct volume *volume)
{
    struct field field = {0};
    uint8_t *density = memory_raw(volume->voxel_count, 1);
    uint8_t *other = memory_raw(volume->voxel_count, 1);
    conus_status status = density && other ? start_field(&field, volume) : CONUS_ERROR_MEMORY;
    if (!status) {
        for (size_t v = 0; v < volume->voxel_count; v++) {
            density[v] = volume_object(volume, v) ? FIELD_LEVELS - 1 : 0;
        }
        blur(density, other, &field);
        store_occupancy(&field, density, volume);
        blur(density, other, &field);
        differentiate(&field, density, volume->voxel_from_world);
        find_ranges(&field);
        *out = field;
    } else {
        field_finish(&field);
    }
    memory_free(density);
    memory_free(other);
    return status;
}

conus_status field_bricks(struct bricks *out, const struct field *field, const bool *visible, size_t per_level)
{
    size_t entries = (FIELD_LEVELS - 1) * per_level + 1;
    uint32_t *before = memory_raw(entries + 1, sizeof *before); /* visible entries before each */
    struct bricks bricks = {.distance = memory_raw(brick_count(field), 1)};
    if (!before || !bricks.distance) {
        memory_free(before);
        bricks_finish(&bricks);
        return CONUS_ERROR_MEMORY;
    }
    memcpy(bricks.dim, field->brick_dim, sizeof bricks.dim);
    before[0] = 0;
    for (size_t i = 0; i < entries; i++) {
        before[i + 1] = before[i] + visible[i];
    }
    for (size_t b = 0; b < brick_count(field); b++) {
        bool seen = before[field->high[b] * per_level + 1] > before[field->low[b] * per_level];
        bricks.distance[b] = seen ? 0 : UINT8_MAX;
    }
    memory_free(before);
    bricks_spread(&bricks);
    *out = bricks;
    return CONUS_OK;
}
