/* SPDX-License-Identifier: BSD-3-Clause */
/* Chooses the streamlines of an atlas that are drawn, their points and their colours. */
#include "render/passes/shapes.h"

#include "atlas/atlas.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

#include <string.h>

/* Dark blue, green, yellow: lighter from step to step, so that the order shows without hues, too. */
static const double ramp[TUBE_RAMP_STEPS + 1][3] = {
    {34, 46, 110}, {36, 104, 142}, {40, 156, 128}, {138, 204, 84}, {250, 230, 80}};

void tube_scalar_colour(uint8_t rgb[3], double part)
{
    if (isnan(part)) {
        memset(rgb, TUBE_UNKNOWN, 3);
        return;
    }
    double at = fmin(fmax(part, 0), 1) * TUBE_RAMP_STEPS;
    int step = at < TUBE_RAMP_STEPS ? (int)at : TUBE_RAMP_STEPS - 1;
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)(ramp[step][c] + (at - step) * (ramp[step + 1][c] - ramp[step][c]) + 0.5);
    }
}

void tube_ramp(float rgb[TUBE_RAMP_STEPS + 1][3])
{
    for (int k = 0; k < 3 * (TUBE_RAMP_STEPS + 1); k++) {
        rgb[k / 3][k % 3] = (float)ramp[k / 3][k % 3] / 255;
    }
}

void tube_direction_colour(uint8_t rgb[3], const double direction[3])
{
    double unit[3];
    if (!vec3_normalise(unit, direction)) {
        memset(rgb, TUBE_UNKNOWN, 3);
        return;
    }
    for (int c = 0; c < 3; c++) {
        rgb[c] = (uint8_t)(255 * fabs(unit[c]) + 0.5);
    }
}

static const struct tract_scalar *find_scalar(const struct tractogram *tractogram, const char *name)
{
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        if (tractogram->scalars[i].components == 1 && strcmp(tractogram->scalars[i].name, name) == 0) {
            return &tractogram->scalars[i];
        }
    }
    return NULL;
}

/* The range over all tractograms that have the number; false where none has, or no value is finite. */
static bool find_range(struct tube_colouring *out, const conus_atlas *atlas, const char *name)
{
    bool found = false;
    out->low = INFINITY;
    out->high = -INFINITY;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tract_scalar *scalar = find_scalar(&atlas->tractograms[i], name);
        size_t count =
            scalar ? (scalar->per_point ? atlas->tractograms[i].point_count : atlas->tractograms[i].streamline_count)
                   : 0;
        found = found || scalar;
        for (size_t v = 0; v < count; v++) {
            double value = (double)scalar->values[v];
            out->low = isfinite(value) ? fmin(out->low, value) : out->low;
            out->high = isfinite(value) ? fmax(out->high, value) : out->high;
        }
    }
    return found;
}

static conus_status fail_unknown(const conus_atlas *atlas, const char *name)
{
    struct buffer names = {0};
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        const struct tractogram *tractogram = &atlas->tractograms[i];
        for (size_t s = 0; s < tractogram->scalar_count; s++) {
            if (tractogram->scalars[s].components == 1) {
                buffer_format(&names, ", %s", tractogram->scalars[s].name);
            }
        }
    }
    conus_status status = buffer_status(&names);
    status = status ? status
                    : fail(CONUS_ERROR_ARGUMENT, "colour of streamlines: %s is none of bundle, direction%s", name,
                           names.data ? names.data : "");
    buffer_finish(&names);
    return status;
}

conus_status tube_colouring_choose(struct tube_colouring *out, const conus_atlas *atlas, const char *name)
{
    struct tube_colouring made = {0};
    if (name && !atlas->tractogram_count) {
        return fail(CONUS_ERROR_ARGUMENT, "colour of streamlines: the atlas has none");
    }
    if (name && strcmp(name, "direction") == 0) {
        made.by = TUBE_BY_DIRECTION;
    } else if (name && strcmp(name, "bundle") != 0) {
        if (!find_range(&made, atlas, name)) {
            return fail_unknown(atlas, name);
        }
        made.by = TUBE_BY_SCALAR;
        made.scalar = memory_text(name, strlen(name));
        if (!made.scalar) {
            return CONUS_ERROR_MEMORY;
        }
    }
    *out = made;
    return CONUS_OK;
}

void tube_colouring_finish(struct tube_colouring *colouring)
{
    memory_free(colouring->scalar);
    *colouring = (struct tube_colouring){0};
}

/* Where the number lies in its range; for a segment the mean of its ends. */
static double scalar_part(const struct tube_colouring *colouring, const struct tractogram *tractogram, uint32_t number,
                          uint64_t index)
{
    const struct tract_scalar *scalar = find_scalar(tractogram, colouring->scalar);
    if (!scalar) {
        return NAN;
    }
    uint64_t next = index + 1 < tractogram->first[number + 1] ? index + 1 : index;
    double value = scalar->per_point ? ((double)scalar->values[index] + (double)scalar->values[next]) / 2
                                     : (double)scalar->values[number];
    double span = colouring->high - colouring->low;
    return span > 0 || isnan(value) ? (value - colouring->low) / span : 0.5;
}

static uint32_t own_colour(const uint8_t rgb[3])
{
    return TUBE_OWN_COLOUR | rgb[0] | (uint32_t)rgb[1] << 8 | (uint32_t)rgb[2] << 16;
}

/* The colour of the segment from point index of streamline number to the next, of object. */
static uint32_t tube_colour(const struct tube_colouring *colouring, const struct tractogram *tractogram,
                            uint32_t number, uint64_t index, uint32_t object)
{
    uint8_t rgb[3];
    if (colouring->by == TUBE_BY_BUNDLE) {
        return object;
    }
    if (colouring->by == TUBE_BY_SCALAR) {
        tube_scalar_colour(rgb, scalar_part(colouring, tractogram, number, index));
        return own_colour(rgb);
    }
    double from[3], along[3];
    tractogram_point(from, tractogram, index);
    memset(along, 0, sizeof along);
    for (uint64_t next = index + 1; vec3_dot(along, along) == 0 && next < tractogram->first[number + 1]; next++) {
        tractogram_point(along, tractogram, next); /* a point may be there twice */
        vec3_sub(along, along, from);
    }
    tube_direction_colour(rgb, along);
    return own_colour(rgb);
}

/* Streamlines are taken in TURNS turns, a prime, so that no order of a file repeats with them. Each turn begins
 * SECTION, a golden section of them, behind the one before. */
enum { TURNS = 67, SECTION = 41 };

/* Many files have a point every tenth of a millimetre. Points are left out where the straight line past them stays
 * within FLATNESS radii and is no longer than LONGEST radii: the form and the colours do not suffer. */
static const double FLATNESS = 0.04;
static const double LONGEST = 4;

/* Whether all points between `from` and `to` are that near to the line between them. */
static bool is_straight(const struct tractogram *tractogram, uint64_t from, uint64_t to)
{
    double a[3];
    double step[3];
    const double radius = tractogram->radius;
    tractogram_point(a, tractogram, from);
    tractogram_point(step, tractogram, to);
    vec3_sub(step, step, a);
    double square = vec3_dot(step, step);
    bool fine = square <= LONGEST * LONGEST * radius * radius;
    for (uint64_t i = from + 1; i < to && fine; i++) {
        double p[3];
        tractogram_point(p, tractogram, i);
        vec3_sub(p, p, a);
        double s = square > 0 ? fmin(fmax(vec3_dot(p, step) / square, 0), 1) : 0;
        vec3_add_scaled(p, p, -s, step);
        fine = vec3_dot(p, p) <= FLATNESS * FLATNESS * radius * radius;
    }
    return fine;
}

/* Appends the drawn points of streamline `k` to tubes->kept. */
static conus_status keep_streamline(struct tubes *tubes, size_t *capacity, const struct tractogram *tractogram,
                                    size_t k)
{
    uint64_t end = tractogram->first[k + 1];
    for (uint64_t at = tractogram->first[k], next; at < end; at = next) {
        if (!memory_reserve(&tubes->kept, capacity, tubes->point_count + 1, sizeof *tubes->kept)) {
            return CONUS_ERROR_MEMORY;
        }
        tubes->kept[tubes->point_count++] = at;
        next = at + 1;
        while (next < end - 1 && is_straight(tractogram, at, next + 1)) {
            next++;
        }
    }
    return CONUS_OK;
}

/* Keeps points of every step-th streamline, in TURNS rounds that take every TURNS-th of them. So the first points,
 * however many, come from everywhere in the file. A draft has the same fraction of each tractogram. CONUS_ERROR_MEMORY.
 */
static conus_status keep_points(struct tubes *tubes)
{
    size_t capacity = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < tubes->range_count && !status; i++) {
        const struct tractogram *tractogram = &tubes->atlas->tractograms[i];
        size_t before = tubes->point_count;
        for (size_t turn = 0; turn < TURNS; turn++) {
            size_t k = turn * SECTION % TURNS * tubes->step;
            for (; k < tractogram->streamline_count && !status; k += TURNS * tubes->step) {
                status = keep_streamline(tubes, &capacity, tractogram, k);
            }
        }
        tubes->ranges[i] = (struct tube_range){
            .first = before, .count = tubes->point_count - before, .radius = (float)tractogram->radius};
    }
    double part = fmin(1, TUBE_DRAFT_LIMIT / fmax(1, (double)tubes->point_count));
    for (size_t i = 0; i < tubes->range_count; i++) {
        tubes->ranges[i].draft = (size_t)ceil(part * (double)tubes->ranges[i].count);
    }
    return status;
}

void tubes_points(float (*points)[3], const struct tubes *tubes)
{
    for (size_t i = 0; i < tubes->range_count; i++) {
        const struct tube_range *range = &tubes->ranges[i];
        for (size_t n = range->first; n < range->first + range->count; n++) {
            double p[3];
            tractogram_point(p, &tubes->atlas->tractograms[i], tubes->kept[n]);
            for (int a = 0; a < 3; a++) {
                points[n][a] = points[n + 1][a] = (float)p[a];
            }
        }
    }
}

/* Takes what points and colours need off `memory_left`. */
static conus_status take_memory(const struct tubes *tubes, uint64_t *memory_left)
{
    size_t count = tubes->point_count;
    uint64_t size = (uint64_t)count * (3 * sizeof(float) + sizeof(uint32_t));
    if (size > *memory_left || count > INT32_MAX - 1) {
        return fail(CONUS_ERROR_MEMORY, "streamlines of %zu points: %llu bytes, allowed are %llu more", count,
                    (unsigned long long)size, (unsigned long long)*memory_left);
    }
    *memory_left -= size;
    return CONUS_OK;
}

conus_status tubes_init(struct tubes *out, const conus_atlas *atlas, uint64_t *memory_left)
{
    struct tubes tubes = {.atlas = atlas, .range_count = atlas->tractogram_count};
    uint64_t count = 0;
    for (size_t i = 0; i < atlas->tractogram_count; i++) {
        count += atlas->tractograms[i].point_count;
    }
    tubes.step = count / TUBE_POINT_LIMIT + 1;
    tubes.ranges = memory_zeroed(tubes.range_count, sizeof *tubes.ranges);
    conus_status status = tubes.ranges ? keep_points(&tubes) : CONUS_ERROR_MEMORY;
    status = status ? status : take_memory(&tubes, memory_left);
    if (status) {
        tubes_finish(&tubes);
        return status;
    }
    *out = tubes;
    return CONUS_OK;
}

void tubes_finish(struct tubes *tubes)
{
    memory_free(tubes->kept);
    memory_free(tubes->ranges);
    *tubes = (struct tubes){0};
}

/* No tube begins at a streamline's last point; a streamline of one point is a ball. */
static conus_status paint_tractogram(uint32_t *paints, const struct tubes *tubes, size_t index,
                                     const struct tube_colouring *colouring, const bool *is_pale)
{
    const struct tractogram *tractogram = &tubes->atlas->tractograms[index];
    const struct tube_range *range = &tubes->ranges[index];
    uint32_t *objects = memory_zeroed(tractogram->streamline_count, sizeof *objects);
    if (!objects) {
        return CONUS_ERROR_MEMORY;
    }
    bundles_find_objects(objects, tubes->atlas, tractogram);
    for (size_t n = range->first; n < range->first + range->count; n++) {
        uint64_t at = tubes->kept[n];
        uint32_t k = tractogram_streamline_of(tractogram, at);
        uint64_t last = tractogram->first[k + 1] - 1;
        uint32_t ball = tractogram->first[k] == last ? TUBE_BALL : 0;
        bool is_drawn = objects[k] && (at != last || ball);
        uint32_t paint = is_drawn ? ball | tube_colour(colouring, tractogram, k, at, objects[k]) : 0;
        paints[n] = paint && is_pale && is_pale[k] ? paint | TUBE_PALE : paint;
    }
    memory_free(objects);
    return CONUS_OK;
}

conus_status tubes_paint(uint32_t *paints, const struct tubes *tubes, const struct tube_colouring *colouring,
                         const bool *const *is_pale)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < tubes->range_count && !status; i++) {
        status = paint_tractogram(paints, tubes, i, colouring, is_pale ? is_pale[i] : NULL);
    }
    return status;
}
