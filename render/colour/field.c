/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes densities and gradients of areas and of grey values. */
#include "render/colour/colour.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/system/system.h"

#include <math.h>
#include <string.h>

void bricks_finish(struct bricks *bricks)
{
    memory_free(bricks->distance);
    *bricks = (struct bricks){0};
}

/* The least distance among the neighbours (i + di, j + dj, k + dk) with di in -1..1 and (dj, dk) as given. */
static uint8_t least_of_row(const struct bricks *bricks, size_t i, size_t j, size_t k)
{
    const uint8_t *row = bricks->distance + bricks->dim[0] * (j + bricks->dim[1] * k);
    uint8_t least = row[i];
    least = i > 0 && row[i - 1] < least ? row[i - 1] : least;
    return i + 1 < bricks->dim[0] && row[i + 1] < least ? row[i + 1] : least;
}

static uint8_t lesser(uint8_t a, uint8_t b)
{
    return a < b ? a : b;
}

/* One brick of a chessboard distance transform (Rosenfeld and Pfaltz 1968): from the half of its neighbours that the
 * pass has already been at; `back` is -1 when indices grow, +1 when they fall. */
static void relax(struct bricks *bricks, size_t i, size_t j, size_t k, int back)
{
    const size_t *dim = bricks->dim;
    size_t before_i = i + (size_t)back, before_j = j + (size_t)back, before_k = k + (size_t)back; /* may wrap: >= dim */
    uint8_t *own = &bricks->distance[i + dim[0] * (j + dim[1] * k)];
    uint8_t least = UINT8_MAX;
    if (before_i < dim[0]) {
        least = lesser(least, own[back]);
    }
    if (before_j < dim[1]) {
        least = lesser(least, least_of_row(bricks, i, before_j, k));
    }
    for (size_t y = j > 0 ? j - 1 : 0; before_k < dim[2] && y <= j + 1 && y < dim[1]; y++) {
        least = lesser(least, least_of_row(bricks, i, y, before_k));
    }
    if (least + 1 < *own) {
        *own = (uint8_t)(least + 1);
    }
}

void bricks_spread(struct bricks *bricks)
{
    for (size_t k = 0; k < bricks->dim[2]; k++) {
        for (size_t j = 0; j < bricks->dim[1]; j++) {
            for (size_t i = 0; i < bricks->dim[0]; i++) {
                relax(bricks, i, j, k, -1);
            }
        }
    }
    for (size_t k = bricks->dim[2]; k-- > 0;) {
        for (size_t j = bricks->dim[1]; j-- > 0;) {
            for (size_t i = bricks->dim[0]; i-- > 0;) {
                relax(bricks, i, j, k, 1);
            }
        }
    }
}

/* A trilinear sample reaches half a voxel outside its brick; one and a half more forgive a float's rounding. */
enum { BORDER = 2, MARGIN = 3 };

/* How often the occupancy whose gradients are taken is blurred and held on its sides, before it is blurred twice. */
enum { RELAXED = 4 };

/* Margin around the voxels that can show, so that the picture is as with a field of the whole volume. Samples lie up to
 * a voxel away, and their gradients use neighbours. Blurring n times carries zeros from the margin's end inwards by
 * less than the 2 n voxels by which it carries objects outwards: a margin of n + 1 is enough. */
enum { VALUES_MARGIN = 2, OBJECTS_MARGIN = RELAXED + 2 + 1 };

void field_finish(struct field *field)
{
    memory_free(field->density);
    memory_free(field->slopes);
    memory_free(field->low);
    memory_free(field->high);
    *field = (struct field){0};
}

static size_t brick_count(const struct field *field)
{
    return field->brick_dim[0] * field->brick_dim[1] * field->brick_dim[2];
}

/* A box of a volume's voxels. */
struct box {
    size_t first[3], end[3];
};

/* Marks columns along the first axis in which a voxel of the row is above `unseen`. Returns whether there is any. */
static bool mark_columns(uint8_t *restrict columns, const uint8_t *row, size_t count, uint8_t unseen)
{
    uint8_t any = 0;
    for (size_t i = 0; i < count; i++) {
        uint8_t more = row[i] > unseen;
        columns[i] |= more;
        any |= more;
    }
    return any;
}

static void include(struct box *box, size_t axis, size_t at)
{
    box->first[axis] = at < box->first[axis] ? at : box->first[axis];
    box->end[axis] = at + 1 > box->end[axis] ? at + 1 : box->end[axis];
}

/* The bounds of voxels above `unseen`: from first = dim to end = 0 if there are none. `columns` has dim[0] zeros. */
static void find_box(struct box *out, uint8_t *columns, const uint8_t *bytes, const size_t dim[3], uint8_t unseen)
{
    *out = (struct box){.first = {dim[0], dim[1], dim[2]}};
    for (size_t k = 0; k < dim[2]; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            if (mark_columns(columns, bytes + dim[0] * (j + dim[1] * k), dim[0], unseen)) {
                include(out, 1, j);
                include(out, 2, k);
            }
        }
    }
    for (size_t i = 0; i < dim[0]; i++) {
        if (columns[i]) {
            include(out, 0, i);
        }
    }
}

/* Begins a field of the box of voxels above `unseen` and a margin around it, whose bytes are moved to the front; of the
 * whole volume if `unseen` is -1. */
static conus_status start_field(struct field *field, uint8_t *bytes, const struct volume *volume, int unseen,
                                size_t margin)
{
    const size_t *dim = volume->info.dim;
    const size_t *first = field->first;
    struct box box = {.end = {dim[0], dim[1], dim[2]}};
    uint8_t *columns = memory_zeroed(dim[0], 1);
    if (!columns) {
        return CONUS_ERROR_MEMORY;
    }
    if (unseen >= 0) {
        find_box(&box, columns, bytes, dim, (uint8_t)unseen);
    }
    memory_free(columns);
    for (size_t a = 0; a < 3; a++) { /* begins with a brick; one brick where there is nothing */
        bool none = !box.end[a];
        size_t low = none || box.first[a] < margin ? 0 : box.first[a] - margin;
        size_t end = none ? BRICKS_EDGE : box.end[a] + margin;
        field->first[a] = low - low % BRICKS_EDGE;
        field->dim[a] = (end < dim[a] ? end : dim[a]) - field->first[a];
        field->brick_dim[a] = (field->dim[a] + BRICKS_EDGE - 1) / BRICKS_EDGE;
    }
    for (size_t k = 0; k < field->dim[2]; k++) {
        for (size_t j = 0; j < field->dim[1]; j++) {
            memmove(bytes + field->dim[0] * (j + field->dim[1] * k),
                    bytes + first[0] + dim[0] * (first[1] + j + dim[1] * (first[2] + k)), field->dim[0]);
        }
    }
    memcpy(field->voxel_from_world, volume->voxel_from_world, sizeof field->voxel_from_world);
    field->low = memory_raw(brick_count(field), 1);
    field->high = memory_raw(brick_count(field), 1);
    return field->low && field->high ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* lrint() for |x| < 2^31, which compilers can vectorise. */
static inline int32_t rounded(double x)
{
    const double shift = 0x1.8p52; /* doubles there are whole numbers */
    return (int32_t)(x + shift - shift);
}

/* Voxels of a row whose changes are found together, and voxels that become texels together. */
enum { STRETCH = 64, AT_ONCE = 8, FLAT = 128 };

/* Twice the change per voxel along each axis, by central differences, one-sided at the border. */
struct changes {
    int16_t twice[3][STRETCH];
};

/* Two neighbours of each voxel of a row along an axis, and how many voxels apart they are: one at the border. */
struct pair {
    const uint8_t *below, *above;
    size_t apart;
};

/* The neighbours of the row at `row`, number `at` of `dim` along an axis in which rows are `stride` apart. */
static struct pair pair_of_rows(const uint8_t *row, size_t at, size_t dim, size_t stride)
{
    size_t below = at > 0;
    size_t above = at + 1 < dim;
    return (struct pair){.below = row - below * stride, .above = row + above * stride, .apart = above + below};
}

static void subtract(int16_t *restrict out, const uint8_t *above, const uint8_t *below, size_t count, int weight)
{
    for (size_t i = 0; i < count; i++) {
        out[i] = (int16_t)((above[i] - below[i]) * weight);
    }
}

/* Differences of `count` voxels from `first` on of a row of `dim` along x. */
static void subtract_along_row(int16_t *out, const uint8_t *row, size_t first, size_t count, size_t dim)
{
    for (size_t i = 0; i < count; i++) {
        size_t at = first + i;
        if (at == 0 || at + 1 == dim) {
            out[i] = (int16_t)(dim > 1 ? 2 * (at ? row[at] - row[at - 1] : row[1] - row[0]) : 0);
        } else { /* up to the border, or the last of them */
            size_t inner = (dim - 1 - at < count - i ? dim - 1 - at : count - i);
            subtract(out + i, row + at + 1, row + at - 1, inner, 1);
            i += inner - 1;
        }
    }
}

static void subtract_rows(int16_t *out, const struct pair *rows, size_t first, size_t count)
{
    subtract(out, rows->above + first, rows->below + first, count, rows->apart == 1 ? 2 : 1);
}

/* Whether AT_ONCE voxels from `i` on have no gradient. */
static bool are_flat(const struct changes *changes, size_t i)
{
    uint64_t any = 0;
    for (size_t a = 0; a < 3; a++) {
        uint64_t twice[2];
        memcpy(twice, changes->twice[a] + i, sizeof twice);
        any |= twice[0] | twice[1];
    }
    return !any;
}

/* Gradients in world axes and per mm, from twice the changes per voxel: `m` has half the transpose of
 * voxel_from_world's linear part, of densities from 0 to 1. */
static void encode_gradients(int32_t out[3][AT_ONCE], const double m[9], const struct changes *changes, size_t i)
{
    for (size_t k = 0; k < AT_ONCE; k++) {
        double change[3] = {changes->twice[0][i + k], changes->twice[1][i + k], changes->twice[2][i + k]};
        double x = m[0] * change[0] + m[1] * change[1] + m[2] * change[2];
        double y = m[3] * change[0] + m[4] * change[1] + m[5] * change[2];
        double z = m[6] * change[0] + m[7] * change[1] + m[8] * change[2];
        double scale = 127 / (sqrt(x * x + y * y + z * z) + FIELD_SOFTNESS);
        out[0][k] = rounded(FLAT + x * scale);
        out[1][k] = rounded(FLAT + y * scale);
        out[2][k] = rounded(FLAT + z * scale);
    }
}

/* Packs AT_ONCE texels, each as one number of four bytes. */
static void fill_texels(uint8_t *texels, const int32_t code[3][AT_ONCE], const uint8_t *density)
{
    uint32_t words[AT_ONCE];
    for (size_t k = 0; k < AT_ONCE; k++) {
        uint32_t low = (uint32_t)code[0][k] | (uint32_t)code[1][k] << 8;
        words[k] = low | (uint32_t)code[2][k] << 16 | (uint32_t)density[k] << 24;
    }
    for (size_t k = 0; k < AT_ONCE && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__; k++) {
        words[k] = __builtin_bswap32(words[k]);
    }
    memcpy(texels, words, sizeof words);
}

static void fill_stretch(uint8_t *texel, const struct changes *changes, const uint8_t *density, size_t count,
                         const double m[9])
{
    for (size_t i = 0; i < count; i += AT_ONCE) {
        int32_t code[3][AT_ONCE];
        uint8_t eight[4 * AT_ONCE];
        uint8_t behind[AT_ONCE] = {0};
        bool whole = i + AT_ONCE <= count;
        if (are_flat(changes, i)) {
            for (size_t k = 0; k < AT_ONCE; k++) {
                code[0][k] = code[1][k] = code[2][k] = FLAT;
            }
        } else {
            encode_gradients(code, m, changes, i);
        }
        if (!whole) {
            memcpy(behind, density + i, count - i);
        }
        fill_texels(eight, (const int32_t(*)[AT_ONCE])code, whole ? density + i : behind);
        memcpy(texel + 4 * i, eight, 4 * (whole ? AT_ONCE : count - i));
    }
}

void field_texels(uint8_t *out, const struct field *field, size_t first, size_t count)
{
    const size_t *dim = field->dim;
    const uint8_t *slopes = field->slopes ? field->slopes : field->density;
    double m[9];
    for (size_t n = 0; n < 9; n++) {
        m[n] = 0.5 * field->voxel_from_world[4 * (n / 3) + n % 3] / (FIELD_LEVELS - 1);
    }
    for (size_t k = first; k < first + count; k++) {
        for (size_t j = 0; j < dim[1]; j++) {
            size_t at = dim[0] * (j + dim[1] * k);
            uint8_t *texel = out + 4 * (at - first * dim[0] * dim[1]);
            const struct pair y = pair_of_rows(slopes + at, j, dim[1], dim[0]);
            const struct pair z = pair_of_rows(slopes + at, k, dim[2], dim[0] * dim[1]);
            for (size_t i = 0; i < dim[0]; i += STRETCH) {
                struct changes changes;
                size_t n = dim[0] - i < STRETCH ? dim[0] - i : STRETCH;
                if (n % AT_ONCE) {
                    memset(&changes, 0, sizeof changes); /* behind the row's last voxel it is flat */
                }
                subtract_along_row(changes.twice[0], slopes + at, i, n, dim[0]);
                subtract_rows(changes.twice[1], &y, i, n);
                subtract_rows(changes.twice[2], &z, i, n);
                fill_stretch(texel + 4 * i, &changes, field->density + at + i, n, m);
            }
        }
    }
}

/* First and one past the last voxel that brick `b` samples along an axis. */
static void find_reach(size_t *first, size_t *end, size_t b, size_t dim)
{
    size_t low = b * BRICKS_EDGE;
    *first = low > BORDER ? low - BORDER : 0;
    *end = low + BRICKS_EDGE + BORDER < dim ? low + BRICKS_EDGE + BORDER : dim;
}

/* The ranges of a row of bricks, from those of each column of voxels that they sample. */
static void find_row_ranges(struct field *field, const uint8_t *lows, const uint8_t *highs, size_t index)
{
    for (size_t b = 0; b < field->brick_dim[0]; b++) {
        size_t first, end;
        uint8_t low = UINT8_MAX;
        uint8_t high = 0;
        find_reach(&first, &end, b, field->dim[0]);
        for (size_t i = first; i < end; i++) {
            low = lows[i] < low ? lows[i] : low;
            high = highs[i] > high ? highs[i] : high;
        }
        field->low[index + b] = low;
        field->high[index + b] = high;
    }
}

/* Least and largest value of each column, over all rows of voxels that the row of bricks (b[1], b[2]) samples. */
static void find_columns(uint8_t *low, uint8_t *high, const uint8_t *values, const size_t dim[3], const size_t b[3])
{
    size_t first[3], end[3];
    memset(low, UINT8_MAX, dim[0]);
    memset(high, 0, dim[0]);
    for (int a = 1; a < 3; a++) {
        find_reach(&first[a], &end[a], b[a], dim[a]);
    }
    for (size_t k = first[2]; k < end[2]; k++) {
        for (size_t j = first[1]; j < end[1]; j++) {
            const uint8_t *row = values + dim[0] * (j + dim[1] * k);
            for (size_t i = 0; i < dim[0]; i++) {
                low[i] = row[i] < low[i] ? row[i] : low[i];
                high[i] = row[i] > high[i] ? row[i] : high[i];
            }
        }
    }
}

static conus_status find_ranges(struct field *field)
{
    const size_t *dim = field->dim;
    uint8_t *low = memory_raw(dim[0], 2);
    size_t b[3] = {0};
    if (!low) {
        return CONUS_ERROR_MEMORY;
    }
    uint8_t *high = low + dim[0];
    for (b[2] = 0; b[2] < field->brick_dim[2]; b[2]++) {
        for (b[1] = 0; b[1] < field->brick_dim[1]; b[1]++) {
            find_columns(low, high, field->density, dim, b);
            find_row_ranges(field, low, high, field->brick_dim[0] * (b[1] + field->brick_dim[1] * b[2]));
        }
    }
    memory_free(low);
    return CONUS_OK;
}

conus_status field_of_values(struct field *out, const struct volume *volume, const struct field_scale *scale)
{
    uint8_t *density = memory_raw(volume->voxel_count, 1);
    *out = (struct field){.density = density};
    if (!density) {
        return CONUS_ERROR_MEMORY;
    }
    const double span = scale->high - scale->low;
    for (size_t v = 0; v < volume->voxel_count; v++) {
        double part = ((double)volume->values[v] - scale->low) / span;
        part = part > 0 ? part : 0; /* quicker than fmax() */
        part = part < 1 ? part : 1;
        density[v] = (uint8_t)rounded(part * (FIELD_LEVELS - 1));
    }
    conus_status status = start_field(out, density, volume, scale->unseen, VALUES_MARGIN);
    return status ? status : find_ranges(out);
}

static uint8_t blurred(int far_before, int before, int here, int after, int far_after)
{
    return (uint8_t)((6 * here + 4 * (before + after) + far_before + far_after + 8) / 16);
}

/* The voxel or row `n` places from the one two before `at`, clamped to the border. */
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

/* One pass of the binomial filter 1 4 6 4 1 along an axis, clamped at the border. */
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

/* Blurs `in`, which becomes scratch memory, in all three directions. */
static void blur(uint8_t *out, uint8_t *in, const size_t dim[3])
{
    blur_axis(out, in, dim, 0);
    blur_axis(in, out, dim, 1);
    blur_axis(out, in, dim, 2);
}

/* 255 for voxels of any object, else 0. */
static void find_occupied(uint8_t *restrict out, const struct volume *volume)
{
    const uint16_t *narrow = volume->objects16;
    const uint32_t *wide = narrow ? NULL : volume->objects32;
    size_t count = volume->voxel_count;
    for (size_t v = 0; narrow && v < count; v++) {
        out[v] = narrow[v] ? UINT8_MAX : 0;
    }
    for (size_t v = 0; wide && v < count; v++) {
        out[v] = wide[v] ? UINT8_MAX : 0;
    }
}

/* `blurred`, clamped to the sides of the surface on which `sides` are. */
static void hold_sides(uint8_t *restrict out, const uint8_t *sides, const uint8_t *restrict blurred, size_t count)
{
    const uint8_t least = FIELD_SURFACE + MARGIN;
    const uint8_t most = FIELD_SURFACE - MARGIN;
    for (size_t v = 0; v < count; v++) {
        uint8_t inside = blurred[v] > least ? blurred[v] : least;
        uint8_t outside = blurred[v] < most ? blurred[v] : most;
        out[v] = sides[v] >= FIELD_SURFACE ? inside : outside;
    }
}

/* Blurring leaves nothing of what is one voxel thick. Lets such voxels, which are outermost on both sides along an axis
 * and of which no neighbour is thicker, be as thick as they are: the surface lies half way to the densest neighbour
 * that is outside. `out` has `held`, what blurring left. */
static void keep_thin(uint8_t *restrict out, const uint8_t *restrict held, const size_t dim[3])
{
    const size_t step[3] = {1, dim[0], dim[0] * dim[1]};
    for (size_t v = 0; v < step[2] * dim[2]; v++) {
        uint8_t outside = 0;
        bool is_thin = held[v] == FIELD_SURFACE + MARGIN;
        bool has_two_sides = false;
        for (int a = 0; a < 3 && is_thin; a++) {
            const size_t at = v / step[a] % dim[a];
            const uint8_t other[2] = {at > 0 ? held[v - step[a]] : 0, at + 1 < dim[a] ? held[v + step[a]] : 0};
            for (int side = 0; side < 2; side++) {
                is_thin = is_thin && other[side] <= FIELD_SURFACE + MARGIN;
                outside = other[side] < FIELD_SURFACE && other[side] > outside ? other[side] : outside;
            }
            has_two_sides = has_two_sides || (other[0] < FIELD_SURFACE && other[1] < FIELD_SURFACE);
        }
        out[v] = is_thin && has_two_sides ? (uint8_t)(2 * FIELD_SURFACE - 1 - outside) : out[v];
    }
}

conus_status field_of_objects(struct field *out, const struct volume *volume)
{
    *out = (struct field){.density = memory_raw(volume->voxel_count, 1)};
    if (!out->density) {
        return CONUS_ERROR_MEMORY;
    }
    find_occupied(out->density, volume);
    conus_status status = start_field(out, out->density, volume, 0, OBJECTS_MARGIN);
    if (status) {
        return status;
    }
    size_t count = out->dim[0] * out->dim[1] * out->dim[2];
    uint8_t *once = memory_raw(count, 1);
    out->slopes = memory_raw(count, 1);
    status = once && out->slopes ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        memcpy(out->slopes, out->density, count);
        for (int n = 0; n < RELAXED; n++) {
            blur(once, out->slopes, out->dim);
            hold_sides(out->slopes, out->density, once, count);
            if (n == 0) {
                memcpy(out->density, out->slopes, count);
                keep_thin(out->density, out->slopes, out->dim);
            }
        }
        blur(once, out->slopes, out->dim);
        blur(out->slopes, once, out->dim);
        status = find_ranges(out);
    }
    memory_free(once);
    return status;
}

conus_status field_bricks(struct bricks *out, const struct field *field, const bool *visible, size_t per_level)
{
    size_t entries = (FIELD_LEVELS - 1) * per_level + 1;
    uint32_t *before = memory_raw(entries + 1, sizeof *before); /* visible entries before each */
    *out = (struct bricks){.distance = memory_raw(brick_count(field), 1)};
    if (!before || !out->distance) {
        memory_free(before);
        return CONUS_ERROR_MEMORY;
    }
    memcpy(out->dim, field->brick_dim, sizeof out->dim);
    before[0] = 0;
    for (size_t i = 0; i < entries; i++) {
        before[i + 1] = before[i] + visible[i];
    }
    for (size_t b = 0; b < brick_count(field); b++) {
        bool seen = before[field->high[b] * per_level + 1] > before[field->low[b] * per_level];
        out->distance[b] = seen ? 0 : UINT8_MAX;
    }
    memory_free(before);
    bricks_spread(out);
    return CONUS_OK;
}

/* A slab of SLAB_TEXELS stays in the processor's cache. Up to SLABS of them are made ahead. */
enum { SLAB_TEXELS = 1 << 17, SLABS = 16 };

static size_t slice_of(const struct field *field)
{
    return field->dim[0] * field->dim[1];
}

/* Slices of a slab. */
static size_t step_of(const struct field *field)
{
    return SLAB_TEXELS / slice_of(field) + 1;
}

/* The slab's place among the texels in memory, and its slices. Behind the last slab the count is 0. */
static uint8_t *place_slab(struct field_slab *out, const struct field_task *task, size_t number)
{
    size_t step = step_of(&task->field);
    size_t slot = task->has_thread ? number % SLABS : 0;
    uint8_t *place = task->texels + 4 * slot * step * slice_of(&task->field);
    size_t left = task->field.dim[2] > number * step ? task->field.dim[2] - number * step : 0;
    *out = (struct field_slab){.texels = place, .first = number * step, .count = left < step ? left : step};
    return place;
}

static conus_status make(struct field_task *task)
{
    conus_status status = task->is_values ? field_of_values(&task->field, task->volume, &task->scale)
                                          : field_of_objects(&task->field, task->volume);
    if (!status) {
        size_t slabs = task->has_thread ? SLABS : 1;
        task->texels = memory_raw(slabs * step_of(&task->field) * slice_of(&task->field), 4);
    }
    return status || task->texels ? status : CONUS_ERROR_MEMORY;
}

/* Waits until there is space for another slab. False if no more are wanted. */
static bool wait_for_room(struct field_task *task)
{
    pthread_mutex_lock(&task->lock);
    while (!task->stop && task->ready - task->released == SLABS) {
        pthread_cond_wait(&task->changed, &task->lock);
    }
    bool goes_on = !task->stop;
    pthread_mutex_unlock(&task->lock);
    return goes_on;
}

static void *run(void *user)
{
    struct field_task *task = user;
    struct field_slab slab;
    conus_status status = make(task);
    pthread_mutex_lock(&task->lock);
    task->status = status;
    task->is_made = true;
    pthread_cond_signal(&task->changed);
    pthread_mutex_unlock(&task->lock);
    for (size_t n = 0; !status && wait_for_room(task); n++) {
        uint8_t *place = place_slab(&slab, task, n);
        if (!slab.count) {
            break;
        }
        field_texels(place, &task->field, slab.first, slab.count);
        pthread_mutex_lock(&task->lock);
        task->ready++;
        pthread_cond_signal(&task->changed);
        pthread_mutex_unlock(&task->lock);
    }
    return NULL;
}

void field_task_start(struct field_task *task)
{
    if (!task->volume) {
        return;
    }
    pthread_mutex_init(&task->lock, NULL);
    pthread_cond_init(&task->changed, NULL);
    task->has_thread = true;
    if (!system_thread(&task->thread, 0, run, task)) {
        task->has_thread = false;
        pthread_cond_destroy(&task->changed);
        pthread_mutex_destroy(&task->lock);
    }
}

/* Messages belong to the thread that fails. */
conus_status field_task_wait(const struct field **out, struct field_task *task)
{
    if (!task->has_thread) {
        task->status = make(task);
    } else {
        pthread_mutex_lock(&task->lock);
        while (!task->is_made) {
            pthread_cond_wait(&task->changed, &task->lock);
        }
        pthread_mutex_unlock(&task->lock);
        if (task->status) {
            return fail(task->status, "no memory for the field of a volume");
        }
    }
    *out = task->status ? *out : &task->field;
    return task->status;
}

bool field_task_next(struct field_slab *out, struct field_task *task)
{
    struct field_slab slab;
    uint8_t *place = place_slab(&slab, task, task->taken);
    if (!slab.count) {
        return false;
    }
    if (task->has_thread) {
        pthread_mutex_lock(&task->lock);
        task->released = task->taken; /* the slab before may be overwritten */
        pthread_cond_signal(&task->changed);
        while (task->ready <= task->taken) {
            pthread_cond_wait(&task->changed, &task->lock);
        }
        pthread_mutex_unlock(&task->lock);
    } else {
        field_texels(place, &task->field, slab.first, slab.count);
    }
    task->taken++;
    *out = slab;
    return true;
}

void field_task_end(struct field_task *task)
{
    if (task->has_thread) {
        pthread_mutex_lock(&task->lock);
        task->stop = true;
        pthread_cond_signal(&task->changed);
        pthread_mutex_unlock(&task->lock);
        pthread_join(task->thread, NULL);
        pthread_cond_destroy(&task->changed);
        pthread_mutex_destroy(&task->lock);
        task->has_thread = false;
    }
    field_finish(&task->field);
    memory_free(task->texels);
    task->texels = NULL;
}
