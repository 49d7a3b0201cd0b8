/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes densities and gradients of areas and of grey values. */
#include "render/colour/field.h"

#include "base/math3.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

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

/* Two neighbours of each voxel of a row along an axis, and how many voxels apart they are: one at the border. */
struct pair {
    const uint8_t *below, *above;
    size_t apart;
};

/* Of the row that begins at `row`, which is number `at` of `dim` along an axis in which rows are `stride` apart. */
static struct pair pair_of_rows(const uint8_t *row, size_t at, size_t dim, size_t stride)
{
    size_t below = at > 0;
    size_t above = at + 1 < dim;
    return (struct pair){.below = row - below * stride, .above = row + above * stride, .apart = above + below};
}

static uint64_t eight_at(const uint8_t *bytes)
{
    uint64_t eight;
    memcpy(&eight, bytes, sizeof eight);
    return eight;
}

/* Whether eight voxels from `i` on, none of them at the border of the row, have no gradient. */
static bool are_flat(const uint8_t *row, const struct pair *y, const struct pair *z, size_t i)
{
    return eight_at(row + i - 1) == eight_at(row + i + 1) && eight_at(y->below + i) == eight_at(y->above + i) &&
           eight_at(z->below + i) == eight_at(z->above + i);
}

static double difference(const struct pair *pair, size_t i)
{
    return pair->apart ? (pair->above[i] - pair->below[i]) / (double)pair->apart : 0;
}

/* Central differences of `row`, one byte per voxel, one-sided at the border. */
static void differentiate_row(uint8_t *texel, const uint8_t *row, size_t count, const struct pair *y,
                              const struct pair *z, const double voxel_from_world[16])
{
    enum { AT_ONCE = 8, FLAT = 128 };
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && i + AT_ONCE < count && are_flat(row, y, z, i)) {
            for (size_t k = 0; k < AT_ONCE; k++) {
                memset(texel + 4 * (i + k), FLAT, 3);
            }
            i += AT_ONCE - 1;
            continue;
        }
        const struct pair x = pair_of_rows(row, i, count, 1);
        const double g[3] = {difference(&x, i), difference(y, i), difference(z, i)};
        encode_gradient(texel + 4 * i, voxel_from_world, g);
    }
}

static void differentiate(struct field *field, const uint8_t *density, const double voxel_from_world[16])
{
    const size_t *dim = field->dim;
    for (size_t k = 0; k < dim[2]; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            size_t first = dim[0] * (j + dim[1] * k);
            const struct pair y = pair_of_rows(density + first, j, dim[1], dim[0]);
            const struct pair z = pair_of_rows(density + first, k, dim[2], dim[0] * dim[1]);
            differentiate_row(field->texels + 4 * first, density + first, dim[0], &y, &z, voxel_from_world);
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

/* The least and the most of each column of rows. */
struct columns {
    uint8_t *low, *high;
};

static void add_row(const struct columns *columns, const uint8_t *row, size_t count)
{
    uint8_t *low = columns->low;
    uint8_t *high = columns->high;
    for (size_t i = 0; i < count; i++) {
        low[i] = row[i] < low[i] ? row[i] : low[i];
        high[i] = row[i] > high[i] ? row[i] : high[i];
    }
}

/* The ranges of a row of bricks, from that of each column of the voxels that bear on them. */
static void find_row_ranges(struct field *field, const struct columns *columns, size_t index)
{
    for (size_t b = 0; b < field->brick_dim[0]; b++) {
        size_t first, end;
        uint8_t low = UINT8_MAX;
        uint8_t high = 0;
        find_reach(&first, &end, b, field->dim[0]);
        for (size_t i = first; i < end; i++) {
            low = columns->low[i] < low ? columns->low[i] : low;
            high = columns->high[i] > high ? columns->high[i] : high;
        }
        field->low[index + b] = low;
        field->high[index + b] = high;
    }
}

/* Of all rows of voxels that bear on the row of bricks (b[1], b[2]). */
static void find_columns(const struct columns *out, const uint8_t *values, const size_t dim[3], const size_t b[3])
{
    size_t first[3], end[3];
    memset(out->low, UINT8_MAX, dim[0]);
    memset(out->high, 0, dim[0]);
    for (int a = 1; a < 3; a++) {
        find_reach(&first[a], &end[a], b[a], dim[a]);
    }
    for (size_t k = first[2]; k < end[2]; k++) {
        for (size_t j = first[1]; j < end[1]; j++) {
            add_row(out, values + dim[0] * (j + dim[1] * k), dim[0]);
        }
    }
}

/* Of `values`, one byte per voxel. */
static conus_status find_ranges(struct field *field, const uint8_t *values)
{
    const size_t *dim = field->dim;
    uint8_t *memory = memory_raw(dim[0], 2);
    size_t b[3] = {0};
    if (!memory) {
        return CONUS_ERROR_MEMORY;
    }
    const struct columns columns = {memory, memory + dim[0]};
    for (b[2] = 0; b[2] < field->brick_dim[2]; b[2]++) {
        for (b[1] = 0; b[1] < field->brick_dim[1]; b[1]++) {
            find_columns(&columns, values, dim, b);
            find_row_ranges(field, &columns, field->brick_dim[0] * (b[1] + field->brick_dim[1] * b[2]));
        }
    }
    memory_free(memory);
    return CONUS_OK;
}

static uint8_t level_of(double part)
{
    part = part > 0 ? part : 0; /* quicker than fmax() */
    part = part < 1 ? part : 1;
    return (uint8_t)lrint(part * (FIELD_LEVELS - 1));
}

conus_status field_of_values(struct field *out, const struct volume *volume, double low, double high)
{
    struct field field = {0};
    uint8_t *density = memory_raw(volume->voxel_count, 1);
    conus_status status = density ? start_field(&field, volume) : CONUS_ERROR_MEMORY;
    if (!status) {
        for (size_t v = 0; v < volume->voxel_count; v++) {
            density[v] = level_of(((double)volume->values[v] - low) / (high - low));
        }
        store_density(&field, density, volume->voxel_count);
        differentiate(&field, density, volume->voxel_from_world);
        status = find_ranges(&field, density);
    }
    memory_free(density);
    if (status) {
        field_finish(&field);
        return status;
    }
    *out = field;
    return CONUS_OK;
}

static uint8_t blurred(int far_before, int before, int here, int after, int far_after)
{
    return (uint8_t)((6 * here + 4 * (before + after) + far_before + far_after + 8) / 16);
}

/* The voxel or row `n` places from the second before that at `at`, the border held. */
static size_t place_near(size_t at, size_t n, size_t dim)
{
    size_t place = at + n < 2 ? 0 : at + n - 2;
    return place < dim ? place : dim - 1;
}

/* Blurs across five rows. */
static void blur_rows(uint8_t *restrict out, const uint8_t *const rows[5], size_t count)
{
    const uint8_t *a = rows[0];
    const uint8_t *b = rows[1];
    const uint8_t *c = rows[2];
    const uint8_t *d = rows[3];
    const uint8_t *e = rows[4];
    for (size_t i = 0; i < count; i++) {
        out[i] = blurred(a[i], b[i], c[i], d[i], e[i]);
    }
}

static void blur_within_row(uint8_t *restrict out, const uint8_t *in, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (i == 2 && count > 4) {
            const uint8_t *const shifted[] = {in, in + 1, in + 2, in + 3, in + 4};
            blur_rows(out + 2, shifted, count - 4);
            i = count - 2;
        }
        int five[5];
        for (size_t n = 0; n < 5; n++) {
            five[n] = in[place_near(i, n, count)];
        }
        out[i] = blurred(five[0], five[1], five[2], five[3], five[4]);
    }
}

/* One pass of the binomial filter 1 4 6 4 1 along an axis, the border held. */
static void blur_axis(uint8_t *restrict out, const uint8_t *in, const size_t dim[3], int axis)
{
    for (size_t k = 0; k < dim[2]; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            uint8_t *row = out + dim[0] * (j + dim[1] * k);
            const uint8_t *rows[5];
            for (size_t n = 0; n < 5; n++) {
                size_t y = axis == 1 ? place_near(j, n, dim[1]) : j;
                size_t z = axis == 2 ? place_near(k, n, dim[2]) : k;
                rows[n] = in + dim[0] * (y + dim[1] * z);
            }
            if (axis == 0) {
                blur_within_row(row, rows[2], dim[0]);
            } else {
                blur_rows(row, rows, dim[0]);
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

/* Gives the same as `out`, too. */
static void store_occupancy(struct field *field, uint8_t *out, const uint8_t *density, const struct volume *volume)
{
    for (size_t v = 0; v < volume->voxel_count; v++) {
        int value = density[v];
        if (volume_object(volume, v)) {
            value = value > FIELD_SURFACE + MARGIN ? value : FIELD_SURFACE + MARGIN;
        } else {
            value = value < FIELD_SURFACE - MARGIN ? value : FIELD_SURFACE - MARGIN;
        }
        field->texels[4 * v + 3] = out[v] = (uint8_t)value;
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
        store_occupancy(&field, other, density, volume);
        status = find_ranges(&field, other);
    }
    if (!status) {
        blur(density, other, &field);
        differentiate(&field, density, volume->voxel_from_world);
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
