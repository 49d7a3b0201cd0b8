/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures pairs of candidates. A row of bits is made in plain arithmetic, without branches; what that leaves open,
 * near the limit or of lines that are nearly parallel, is measured by Eq. 21. So the bits are the same on all machines.
 */
#include "selection/plan/together/together.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/status.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <string.h>

/* By so much a margin is exceeded where it holds, and missed where a distance of entries or of combinations still
 * holds, mm; likewise degrees of arcs. */
static const double TOUCH = 1e-9;
static const double DEGREES = 1e-9; /* Nearer to the right-left axis a needle has no arc angle of its own: that is 0. */

enum { ORIGIN = 0, TIP = 3, ARC = 6, SLIDER = 7, BODIES = 8, END = 0, WAY = 3, SQUARE = 6, PER_BODY = 7 };

static conus_status check_part(const conus_part *part, size_t number)
{
    const double numbers[] = {part->radius, part->low, part->high, part->x, part->y};
    bool is_fine = part->radius >= 0 && part->low <= part->high;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        is_fine = is_fine && fabs(numbers[i]) <= 1000;
    }
    return !is_fine ? fail(CONUS_ERROR_ARGUMENT,
                           "part %zu: radius %g, from %g to %g mm at %g,%g: allowed are a radius of 0 to 1000, and "
                           "ascending ends and a place of up to 1000 mm",
                           number, part->radius, part->low, part->high, part->x, part->y)
           : part->radius > 0 || part->high > part->low
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "part %zu: a point without a radius has no extent", number);
}

conus_status bodies_init(struct bodies *out, double radius, const double *shanks, size_t shank_count,
                         const conus_part *parts, size_t part_count)
{
    *out = (struct bodies){.shaft_count = shanks ? shank_count : 1};
    if (out->shaft_count > SHAFT_LIMIT || part_count > PART_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "%zu shanks and %zu parts, allowed are up to %d and %d", out->shaft_count,
                    part_count, SHAFT_LIMIT, PART_LIMIT);
    }
    for (size_t i = 0; i < out->shaft_count; i++, out->count++) {
        memcpy(out->shanks[i], shanks ? shanks + 2 * i : (const double[]){0, 0}, sizeof out->shanks[i]);
        out->radius[out->count] = radius;
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; i < part_count && !status; i++, out->count++) {
        status = check_part(&parts[i], i + 1);
        out->parts[i] = parts[i];
        out->radius[out->count] = parts[i].radius;
    }
    return status;
}

conus_status body_list_init(struct body_list *out, const struct bodies *bodies, size_t count)
{
    size_t size;
    bool fits = memory_multiply(count, BODIES + PER_BODY * bodies->count, &size);
    *out = (struct body_list){.bodies = bodies, .count = count};
    out->numbers = memory_raw(fits ? size : SIZE_MAX, sizeof *out->numbers);
    return out->numbers ? CONUS_OK : CONUS_ERROR_MEMORY;
}

void body_list_finish(struct body_list *list)
{
    memory_free(list->numbers);
    *list = (struct body_list){0};
}

/* The array of one number of all candidates. */
static double *column(const struct body_list *list, size_t number)
{
    return list->numbers + number * list->count;
}

static size_t of_body(size_t body)
{
    return BODIES + PER_BODY * body;
}

/* Both ends of a body. */
static void find_ends(double out[2][3], const struct bodies *bodies, size_t body, const conus_planned *pose)
{
    const double *m = pose->pose.world_from_device;
    bool is_part = body >= bodies->shaft_count;
    const conus_part *part = is_part ? &bodies->parts[body - bodies->shaft_count] : NULL;
    const double *beside = is_part ? (const double[]){part->x, part->y} : bodies->shanks[body];
    double from = is_part && part->from_tip ? pose->far : 0;
    const double depths[2] = {is_part ? from - part->low : pose->near, is_part ? from - part->high : pose->far};
    for (int k = 0; k < 2; k++) {
        for (size_t a = 0; a < 3; a++) {
            out[k][a] = m[12 + a] + beside[0] * m[a] + beside[1] * m[4 + a] - depths[k] * m[8 + a];
        }
    }
}

void arc_angles(double *arc, double *slider, const conus_frame *frame, const double out[3])
{
    double v[3];
    direction_to_anatomical(v, out, frame);
    *slider = degrees_from_radians(atan2(v[0], hypot(v[1], v[2])));
    *arc = 90 - fabs(*slider) > DEGREES ? degrees_from_radians(atan2(v[1], v[2])) : 0;
}

void body_list_set(struct body_list *list, size_t index, const conus_planned *pose)
{
    const double *m = pose->pose.world_from_device;
    arc_angles(column(list, ARC) + index, column(list, SLIDER) + index, list->bodies->frame, m + 8);
    for (size_t a = 0; a < 3; a++) {
        column(list, ORIGIN + a)[index] = m[12 + a];
        column(list, TIP + a)[index] = m[12 + a] - pose->far * m[8 + a];
    }
    for (size_t body = 0; body < list->bodies->count; body++) {
        double ends[2][3];
        double square = 0;
        find_ends(ends, list->bodies, body, pose);
        for (size_t a = 0; a < 3; a++) {
            double way = ends[1][a] - ends[0][a];
            column(list, of_body(body) + END + a)[index] = ends[0][a];
            column(list, of_body(body) + WAY + a)[index] = way;
            square += way * way;
        }
        column(list, of_body(body) + SQUARE)[index] = square;
    }
}

/* mm between two points of candidates: their positions, or their far ends. */
static double points_distance(const struct body_list *list, size_t index, const struct body_list *other,
                              size_t other_index, size_t point)
{
    double way[3];
    for (size_t a = 0; a < 3; a++) {
        way[a] = column(list, point + a)[index] - column(other, point + a)[other_index];
    }
    return vec3_length(way);
}

bool bodies_are_near(const struct body_list *list, size_t index, const struct body_list *other, size_t other_index,
                     double apart)
{
    double least = apart - TOUCH;
    return (list == other && index == other_index) ||
           (points_distance(list, index, other, other_index, ORIGIN) < least &&
            points_distance(list, index, other, other_index, TIP) < least);
}

/* Degrees between two angles, the short way round. */
static double angles_distance(const struct body_list *list, size_t index, const struct body_list *other,
                              size_t other_index, size_t angle)
{
    return fabs(remainder(column(list, angle)[index] - column(other, angle)[other_index], 360));
}

bool bodies_share_arc(const struct body_list *list, size_t index, const struct body_list *other, size_t other_index,
                      const struct arcs *arcs)
{
    return angles_distance(list, index, other, other_index, ARC) <= arcs->same + TOUCH;
}

/* Whether two candidates fit on one arc, or on two, as their needles are to. */
static bool fits_arcs(const struct body_list *list, size_t index, const struct body_list *other, size_t other_index,
                      const struct arcs *arcs)
{
    const size_t own = list->bodies->arc;
    const size_t its = other->bodies->arc;
    if (!(arcs->spacing > 0)) {
        return true;
    }
    bool share = bodies_share_arc(list, index, other, other_index, arcs);
    bool is_free = !own || !its;
    double angle = angles_distance(list, index, other, other_index, share ? SLIDER : ARC);
    return (is_free || (own == its) == share) && angle >= (share ? arcs->slider : arcs->spacing) - TOUCH;
}

static void read_body(double at[3], double way[3], const struct body_list *list, size_t index, size_t body)
{
    for (size_t a = 0; a < 3; a++) {
        at[a] = column(list, of_body(body) + END + a)[index];
        way[a] = column(list, of_body(body) + WAY + a)[index];
    }
}

/* Distance of the axes of two bodies by Eq. 21. */
static double axes_distance(double at[3], double other_at[3], const struct body_list *list, size_t index, size_t body,
                            const struct body_list *other, size_t other_index, size_t other_body)
{
    struct needle needle = {.direction = {0, 0, 1}};
    double way[3];
    double ends[2][3];
    double depth;
    read_body(needle.origin, way, list, index, body);
    needle.far = vec3_length(way);
    if (needle.far > 0) {
        vec3_scale(needle.direction, way, 1 / needle.far);
    }
    read_body(ends[0], way, other, other_index, other_body);
    vec3_add_scaled(ends[1], ends[0], 1, way);
    double distance = needle_segment(&depth, other_at, &needle, ends[0], ends[1]);
    needle_point(at, &needle, depth);
    return distance <= TOUCH ? 0 : distance;
}

/* Measures in the order that is given. */
static void measure_in_order(struct pair *out, const struct body_list *list, size_t index,
                             const struct body_list *other, size_t other_index, const struct margins *margins)
{
    *out = (struct pair){.slack = INFINITY, .shafts = INFINITY, .parts = INFINITY};
    for (size_t i = 0; i < list->bodies->count; i++) {
        for (size_t k = 0; k < other->bodies->count; k++) {
            struct nearest found = {.body = i, .other = k};
            found.distance = axes_distance(found.at, found.other_at, list, index, i, other, other_index, k) -
                             list->bodies->radius[i] - other->bodies->radius[k];
            bool are_shafts = i < list->bodies->shaft_count && k < other->bodies->shaft_count;
            double slack = found.distance - (are_shafts ? margins->between : margins->parts);
            out->shafts = are_shafts && found.distance < out->shafts ? found.distance : out->shafts;
            out->parts = !are_shafts && slack < out->parts ? slack : out->parts;
            if (slack < out->slack) {
                out->slack = slack;
                out->nearest = found;
            }
        }
    }
    out->entries = points_distance(list, index, other, other_index, ORIGIN);
    out->arc = angles_distance(list, index, other, other_index, ARC);
    out->slider = angles_distance(list, index, other, other_index, SLIDER);
    out->fits_arcs = fits_arcs(list, index, other, other_index, &margins->arcs);
}

static void swap_points(double a[3], double b[3])
{
    for (size_t k = 0; k < 3; k++) {
        double kept = a[k];
        a[k] = b[k];
        b[k] = kept;
    }
}

void pair_measure(struct pair *out, const struct body_list *list, size_t index, const struct body_list *other,
                  size_t other_index, const struct margins *margins)
{
    /* In one order, so that it is the same to the last bit whichever needle asks. */
    if (list < other || (list == other && index <= other_index)) {
        measure_in_order(out, list, index, other, other_index, margins);
        return;
    }
    measure_in_order(out, other, other_index, list, index, margins);
    size_t body = out->nearest.body;
    out->nearest.body = out->nearest.other;
    out->nearest.other = body;
    swap_points(out->nearest.at, out->nearest.other_at);
}

int64_t nanometres(double mm)
{
    static const double MOST = 1e12; /* beyond all bodies */
    double most = mm > MOST ? MOST : mm < -MOST ? -MOST : mm;
    return (int64_t)floor(1e6 * most + 0.5);
}

int64_t pair_value(const struct pair *pair, enum pair_quantity quantity)
{
    /* Of entries a distance that holds when it is asked for: by so much a constraint forgives. */
    return quantity == PAIR_ENTRIES ? (int64_t)floor(1e6 * (pair->entries + TOUCH))
                                    : nanometres(quantity == PAIR_LEEWAY ? pair->slack / 2 : pair->shafts);
}

static bool pair_goes(const struct pair *pair, const struct pair_test *test)
{
    bool holds_entries = test->quantity == PAIR_ENTRIES || pair->entries - test->margins.entries >= -TOUCH;
    bool holds_between = (test->quantity == PAIR_BETWEEN ? pair->parts : pair->slack) > TOUCH;
    return holds_entries && holds_between && pair->fits_arcs && pair_value(pair, test->quantity) >= test->least;
}

/* What the distance of two bodies' surfaces must be at least, about, mm. */
static double least_distance(const struct pair_test *test, bool are_shafts)
{
    double margin = are_shafts ? test->margins.between : test->margins.parts;
    double least = 1e-6 * ((double)test->least - 0.5);
    return test->quantity == PAIR_LEEWAY                  ? margin + fmax(2 * least, TOUCH)
           : test->quantity == PAIR_BETWEEN && are_shafts ? least
                                                          : margin + TOUCH;
}

/* Between which squares a distance is to be measured by Eq. 21: above it holds, below it breaks. A limit below 0 always
 * holds. */
struct band {
    double square, width;
};

static struct band band_of(double limit)
{
    return limit <= 0 ? (struct band){-INFINITY, 0} : (struct band){limit * limit, 1e-9 + 1e-9 * limit * limit};
}

static double least_of(double a, double b)
{
    return a < b ? a : b;
}

/* 1 where it surely holds, -1 where it surely breaks, 0 between. */
static double judge(double square, struct band band, double error)
{
    double more = square - band.square;
    double width = band.width + error;
    return more > width ? 1 : more < -width ? -1 : 0;
}

/* The squared distances of one body from a body of each candidate of another list, judged; `states` gets the least. */
static void judge_bodies(double *restrict states, const double p[3], const double d[3], const double *restrict numbers,
                         size_t stride, size_t count, struct band band)
{
    static const double PARALLEL = 1e-7; /* sin^2 */
    const double *restrict qx = numbers, *restrict qy = qx + stride, *restrict qz = qy + stride;
    const double *restrict ux = qz + stride, *restrict uy = ux + stride, *restrict uz = uy + stride;
    const double *restrict squares = uz + stride;
    const double px = p[0], py = p[1], pz = p[2], dx = d[0], dy = d[1], dz = d[2];
    const double full = dx * dx + dy * dy + dz * dz;
    const double a = full > 1e-18 ? full : 1; /* a ball is nearest anywhere */
    for (size_t i = 0; i < count; i++) {
        double rx = px - qx[i], ry = py - qy[i], rz = pz - qz[i];
        double e = squares[i] > 1e-18 ? squares[i] : 1;
        double b = dx * ux[i] + dy * uy[i] + dz * uz[i];
        double c = dx * rx + dy * ry + dz * rz;
        double f = ux[i] * rx + uy[i] * ry + uz[i] * rz;
        double det = a * e - b * b;
        bool is_clear = det > PARALLEL * a * e;
        double s = (b * f - c * e) / (is_clear ? det : 1e300);
        s = s < 0 ? 0 : s > 1 ? 1 : s;
        double t = (b * s + f) / e;
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        s = (b * t - c) / a;
        s = s < 0 ? 0 : s > 1 ? 1 : s;
        double x = rx + s * dx - t * ux[i], y = ry + s * dy - t * uy[i], z = rz + s * dz - t * uz[i];
        double error = 1e-12 * (rx * rx + ry * ry + rz * rz + a + e);
        double state = judge(x * x + y * y + z * z, band, error);
        state = is_clear ? state : least_of(state, 0); /* what was found is a distance of two points, and not less */
        states[i] = least_of(states[i], state);
    }
}

static void judge_entries(double *restrict states, const double p[3], const double *restrict numbers, size_t stride,
                          size_t count, struct band band)
{
    const double px = p[0], py = p[1], pz = p[2];
    const double *restrict qx = numbers, *restrict qy = qx + stride, *restrict qz = qy + stride;
    for (size_t i = 0; i < count; i++) {
        double x = px - qx[i], y = py - qy[i], z = pz - qz[i];
        states[i] = least_of(states[i], judge(x * x + y * y + z * z, band, 0));
    }
}

void pair_row(uint64_t *bits, double *scratch, const struct body_list *list, size_t index,
              const struct body_list *other, size_t count, const struct pair_test *test)
{
    double at[3];
    double way[3];
    for (size_t i = 0; i < count; i++) {
        scratch[i] = 1;
    }
    for (size_t i = 0; i < list->bodies->count; i++) {
        read_body(at, way, list, index, i);
        for (size_t k = 0; k < other->bodies->count; k++) {
            bool are_shafts = i < list->bodies->shaft_count && k < other->bodies->shaft_count;
            double limit = least_distance(test, are_shafts) + list->bodies->radius[i] + other->bodies->radius[k];
            judge_bodies(scratch, at, way, column(other, of_body(k)), other->count, count, band_of(limit));
        }
    }
    for (size_t a = 0; a < 3; a++) {
        at[a] = column(list, ORIGIN + a)[index];
    }
    double entries = test->quantity == PAIR_ENTRIES ? 1e-6 * (double)test->least : test->margins.entries;
    judge_entries(scratch, at, column(other, ORIGIN), other->count, count, band_of(entries));
    memset(bits, 0, (count + 63) / 64 * sizeof *bits);
    for (size_t i = 0; i < count; i++) {
        struct pair pair;
        bool goes = scratch[i] > 0 && fits_arcs(list, index, other, i, &test->margins.arcs);
        if (scratch[i] == 0) {
            pair_measure(&pair, list, index, other, i, &test->margins);
            goes = pair_goes(&pair, test);
        }
        bits[i / 64] |= (uint64_t)goes << (i % 64);
    }
}
