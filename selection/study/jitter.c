/* SPDX-License-Identifier: BSD-3-Clause */
/* Answers many poses around one, and estimates the probability of each object. */
#include "selection/selection.h"
#include "selection/study/study.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/order.h"
#include "poses/rows/pose_row.h"

enum { DEFAULT_SAMPLES = 1024, SAMPLE_LIMIT = 1 << 20 };

/* Point `index` of the Sobol sequence along `dimension`, as a part of 2^32: primitive polynomials and initial numbers
 * are those of S. Joe and F. Kuo (2008). Points 2^k n to 2^k (n + 1) - 1 are evenly spread, for any k and n. */
static uint32_t sobol(uint32_t index, uint32_t dimension)
{
    static const struct {
        uint32_t degree, coefficients, first[3];
    } polynomials[JITTER_DIMENSIONS] = {{0, 0, {0}}, {1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}};
    uint32_t degree = polynomials[dimension].degree;
    uint32_t v[32];
    uint32_t bits = 0;
    for (uint32_t k = 0; k < 32 && index >> k; k++) {
        if (degree == 0) {
            v[k] = 1U << (31 - k);
        } else if (k < degree) {
            v[k] = polynomials[dimension].first[k] << (31 - k);
        } else {
            v[k] = v[k - degree] ^ v[k - degree] >> degree;
            for (uint32_t i = 1; i < degree; i++) {
                v[k] ^= (polynomials[dimension].coefficients >> (degree - 1 - i) & 1) * v[k - i];
            }
        }
        bits ^= (index >> k & 1) * v[k];
    }
    return bits;
}

/* The shift of all points along `dimension`, digit by digit, which keeps them even: SplitMix64. */
static uint32_t shift_of(uint32_t dimension)
{
    uint64_t z = (dimension + 1) * UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return (uint32_t)((z ^ z >> 31) >> 32);
}

/* Below which a standard normal variable is with probability p, 0 < p <= 1/2: P. Acklam's rational approximations, and
 * one step of Halley's method, which leaves rounding. */
static double quantile_of_half(double p)
{
    static const double a[] = {-39.69683028665376, 220.9460984245205,  -275.9285104469687,
                               138.3577518672690,  -30.66479806614716, 2.506628277459239};
    static const double b[] = {-54.47609879822406, 161.5858368580409, -155.6989798598866, 66.80131188771972,
                               -13.28068155288572};
    static const double c[] = {-0.007784894002430293, -0.3223964580411365, -2.400758277161838,
                               -2.549732539343734,    4.374664141464968,   2.938163982698783};
    static const double d[] = {0.007784695709041462, 0.3224671290700398, 2.445134137142996, 3.754408661907416};
    double x;
    if (p < 0.02425) {
        double q = sqrt(-2 * log(p));
        x = (((((c[0] * q + c[1]) * q + c[2]) * q + c[3]) * q + c[4]) * q + c[5]) /
            ((((d[0] * q + d[1]) * q + d[2]) * q + d[3]) * q + 1);
    } else {
        double q = p - 0.5;
        double r = q * q;
        x = (((((a[0] * r + a[1]) * r + a[2]) * r + a[3]) * r + a[4]) * r + a[5]) * q /
            (((((b[0] * r + b[1]) * r + b[2]) * r + b[3]) * r + b[4]) * r + 1);
    }
    double error = 0.5 * erfc(-x / sqrt(2)) - p;
    double step = error * sqrt(2 * MATH3_PI) * exp(x * x / 2);
    return x - step / (1 + x * step / 2);
}

static double quantile(double p)
{
    return p <= 0.5 ? quantile_of_half(p) : -quantile_of_half(1 - p);
}

void jitter_sample(double out[JITTER_DIMENSIONS], uint32_t index)
{
    for (uint32_t i = 0; i < JITTER_DIMENSIONS; i++) {
        out[i] = quantile(((sobol(index, i) ^ shift_of(i)) + 0.5) * 0x1p-32);
    }
}

/* The device turned by a vector about its x and y, radians, and moved along its axes, mm. */
static void move_pose(conus_pose *out, const conus_pose *pose, const double about[2], const double shift[3])
{
    double m[16];
    double turn[16];
    double angle = hypot(about[0], about[1]);
    double cosine = cos(angle);
    double sine = sin(angle);
    memcpy(m, pose->world_from_device, sizeof m);
    for (int a = 0; a < 3; a++) {
        vec3_add_scaled(m + 12, m + 12, shift[a], pose->world_from_device + 4 * a);
    }
    mat4_identity(turn);
    if (angle > 0) { /* Rodrigues, about (x, y, 0) */
        double x = about[0] / angle;
        double y = about[1] / angle;
        const double rotation[16] = {cosine + x * x * (1 - cosine),
                                     x * y * (1 - cosine),
                                     -y * sine,
                                     0,
                                     x * y * (1 - cosine),
                                     cosine + y * y * (1 - cosine),
                                     x * sine,
                                     0,
                                     y * sine,
                                     -x * sine,
                                     cosine,
                                     0,
                                     0,
                                     0,
                                     0,
                                     1};
        memcpy(turn, rotation, sizeof turn);
    }
    mat4_multiply(out->world_from_device, m, turn);
}

void jitter_pose(conus_pose *out, const conus_pose *pose, const conus_jitter_options *options,
                 const double errors[JITTER_DIMENSIONS])
{
    const double tilt = radians_from_degrees(options->tilt);
    const double shift = options->shift;
    move_pose(out, pose, (const double[]){tilt * errors[0], tilt * errors[1]},
              (const double[]){shift * errors[2], shift * errors[3], shift * errors[4]});
}

static bool jitter_is_of_ends(const conus_jitter_options *options)
{
    return options->entry != 0 || options->target != 0 || options->depth != 0;
}

/* The errors of both ends are a shift and a turn: by the angle between the axes, about what is across both. */
void jitter_needle(conus_pose *out, double *far, const conus_pose *pose, const conus_jitter_options *options,
                   const double errors[JITTER_DIMENSIONS])
{
    if (!jitter_is_of_ends(options)) {
        jitter_pose(out, pose, options, errors);
        return;
    }
    const double begin[2] = {options->entry * errors[0], options->entry * errors[1]};
    const double along[2] = {options->target * errors[2] - begin[0], options->target * errors[3] - begin[1]};
    double across = hypot(along[0], along[1]);
    double turn = across > 0 ? atan2(across, *far) / across : 0;
    move_pose(out, pose, (const double[]){turn * along[1], -turn * along[0]}, (const double[]){begin[0], begin[1], 0});
    *far += options->depth * errors[4];
}

conus_status jitter_check(conus_jitter_options *options)
{
    const struct {
        const char *name;
        double value;
    } lengths[] = {
        {"shift", options->shift}, {"entry", options->entry}, {"target", options->target}, {"depth", options->depth}};
    options->samples = options->samples ? options->samples : DEFAULT_SAMPLES;
    if (!(options->tilt >= 0 && options->tilt <= 90)) {
        return fail(CONUS_ERROR_ARGUMENT, "jitter: a tilt of %g degrees, allowed is 0 to 90", options->tilt);
    }
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        if (!(lengths[i].value >= 0 && lengths[i].value <= 1e6)) {
            return fail(CONUS_ERROR_ARGUMENT, "jitter: %s: %g mm, allowed is 0 to 1e6", lengths[i].name,
                        lengths[i].value);
        }
    }
    if (jitter_is_of_ends(options) && (options->tilt > 0 || options->shift > 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "jitter: errors are of the tilt and the position, or of both ends");
    }
    uint32_t samples = options->samples;
    return samples < JITTER_SETS || samples > SAMPLE_LIMIT || (samples & (samples - 1))
               ? fail(CONUS_ERROR_ARGUMENT, "samples: %u, allowed are powers of two from %d to %d", samples,
                      JITTER_SETS, SAMPLE_LIMIT)
               : CONUS_OK;
}

/* The sums over the samples for one object; number 0 is for rays that hit nothing. */
struct count {
    uint32_t hits[JITTER_SETS];
    uint32_t seen, inside;
    double share, square; /* sums */
};

static conus_status answer_sample(struct count *counts, conus_selector *selector, const struct table_question *asked,
                                  uint32_t index)
{
    conus_pose pose;
    conus_selection *selection = NULL;
    double errors[JITTER_DIMENSIONS];
    jitter_sample(errors, index);
    jitter_pose(&pose, &asked->cone.pose, &asked->jitter, errors);
    conus_status status = conus_select(&selection, selector, &pose, asked->cone.degrees);
    if (status) {
        return status;
    }
    uint32_t best = 0; /* the best-ranked object that any pixel hits */
    for (size_t i = 0; i < conus_selection_count(selection); i++) {
        const conus_result *result = conus_selection_result(selection, i);
        struct count *count = &counts[result->object];
        count->seen += result->pixels > 0;
        count->inside += result->kind != CONUS_KIND_BUNDLE || result->streamlines > 0; /* a ray may hit its tube only */
        count->share += result->share;
        count->square += result->share * result->share;
        best = best || !result->pixels ? best : result->object;
    }
    counts[best].hits[index / (asked->jitter.samples / JITTER_SETS)]++;
    conus_selection_destroy(selection);
    return CONUS_OK;
}

/* Mean over the sets, and its standard error were they independent; they complement each other, so it is less. */
static void estimate_probability(double out[2], const uint32_t hits[JITTER_SETS], double per_set)
{
    double sum = 0;
    double square = 0;
    for (int set = 0; set < JITTER_SETS; set++) {
        sum += hits[set] / per_set;
    }
    out[0] = sum / JITTER_SETS;
    for (int set = 0; set < JITTER_SETS; set++) {
        double off = hits[set] / per_set - out[0];
        square += off * off;
    }
    out[1] = sqrt(square / (JITTER_SETS * (JITTER_SETS - 1)));
}

/* The chances of one object: a row of the table. */
struct row {
    struct table_object object;
    uint32_t rank;          /* from 1, by hit; 0 of what is unassigned */
    uint32_t samples;       /* of the question, as tilt and shift */
    double hit;             /* probability that it is the one that the selector ranks best among those that pixels hit
                               first; of what is unassigned, that none hits any */
    double hit_error;       /* standard error of that number, from JITTER_SETS independent sets of samples */
    double seen;            /* probability that some pixel hits it first */
    double in_cone;         /* probability that it is in the cone at all, a bundle with one of its streamlines (Eq. 19);
                               NaN without all layers */
    double share;           /* mean share (Eq. 4) */
    double share_deviation; /* standard deviation of the share from sample to sample */
    double tilt, shift;
};

static const struct table_field columns[] = {
    TABLE_IDENTITY,
    {"rank", NULL, "1 is the most probable hit", TABLE_OF(RANK, struct row, rank)},
    {"p_hit", NULL, "probability that it is the one hit; of a query they sum to 1", TABLE_OF(NUMBER, struct row, hit)},
    {"p_hit_error", NULL, "standard error of p_hit, on the safe side", TABLE_OF(NUMBER, struct row, hit_error)},
    {"p_seen", NULL, "probability that some pixel hits it first", TABLE_OF(NUMBER, struct row, seen)},
    {"p_in_cone", NULL, "probability that it, or a streamline of it, is in the cone; needs all layers",
     TABLE_OF(NUMBER, struct row, in_cone)},
    {"mean_share", NULL, "mean part of the cone's solid angle; of a query they sum to 1",
     TABLE_OF(NUMBER, struct row, share)},
    {"sd_share", NULL, "standard deviation of that part from sample to sample",
     TABLE_OF(NUMBER, struct row, share_deviation)},
    {"samples", NULL, "poses that were looked from", TABLE_OF(COUNT, struct row, samples)},
    {"error_deg", "degree", "standard deviation of the tilt of the axis, about each of two axes",
     TABLE_OF(NUMBER, struct row, tilt)},
    {"error_mm", "mm", "standard deviation of the position, along each of three axes",
     TABLE_OF(NUMBER, struct row, shift)},
};

const struct table_fields jitter_fields = {columns, sizeof columns / sizeof *columns};

static struct row describe(const struct count *count, const conus_selector *selector, uint32_t number,
                           const conus_jitter_options *errors)
{
    const conus_object *object = conus_atlas_object(selector->atlas, number);
    double samples = errors->samples;
    struct row row = {.object = {object ? object->kind : CONUS_KIND_UNASSIGNED, number},
                      .samples = errors->samples,
                      .tilt = errors->tilt,
                      .shift = errors->shift};
    double hit[2];
    estimate_probability(hit, count->hits, samples / JITTER_SETS);
    row.hit = hit[0];
    row.hit_error = hit[1];
    row.seen = count->seen / samples;
    row.in_cone = object && selector->options.layers ? count->inside / samples : NAN;
    row.share = count->share / samples;
    double variance = (count->square - samples * row.share * row.share) / (samples - 1);
    row.share_deviation = variance > 0 ? sqrt(variance) : 0;
    return row;
}

/* The most probable first; what is unassigned comes last. */
static int compare(const void *a, const void *b)
{
    const struct row *x = a;
    const struct row *y = b;
    int order = !x->object.number - !y->object.number;
    order = order ? order : compare_double(y->hit, x->hit);
    order = order ? order : compare_double(y->share, x->share);
    return order ? order : compare_unsigned(x->object.number, y->object.number);
}

static conus_status tabulate(conus_table **out, const struct count *counts, const conus_selector *selector,
                             const struct table_question *asked)
{
    size_t objects = selector->atlas->object_count;
    size_t count = 0;
    struct row *rows = memory_raw(objects + 1, sizeof *rows);
    if (!rows) {
        return CONUS_ERROR_MEMORY;
    }
    for (uint32_t number = 0; number <= objects; number++) {
        if (number == 0 || counts[number].inside > 0) {
            rows[count++] = describe(&counts[number], selector, number, &asked->jitter);
        }
    }
    order_sort(rows, count, sizeof *rows, compare);
    for (size_t i = 0; i + 1 < count; i++) {
        rows[i].rank = (uint32_t)i + 1;
    }
    conus_status status = table_create(out, &(struct table_source){selector->atlas, &selector->frame}, &jitter_fields,
                                       asked, rows, sizeof *rows, count);
    memory_free(rows);
    return status;
}

static conus_status answer(conus_table **out, conus_selector *selector, const struct table_question *asked)
{
    struct count *counts = memory_zeroed(selector->atlas->object_count + 1, sizeof *counts);
    const conus_jitter_options *options = &asked->jitter;
    conus_status status = counts ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (uint32_t i = 0; !status && i < options->samples; i++) {
        status = answer_sample(counts, selector, asked, i);
        if (!status && options->progress && !options->progress(options->progress_user, i + 1, options->samples)) {
            status = fail(CONUS_ERROR_CANCELLED, "jitter: cancelled after %u of %u poses", i + 1, options->samples);
        }
    }
    status = status ? status : tabulate(out, counts, selector, asked);
    memory_free(counts);
    return status;
}

conus_status conus_jitter(conus_table **out, conus_selector *selector, const conus_pose *pose, double angle,
                          const conus_jitter_options *options)
{
    struct table_question asked = {.jitter = *options_of(conus_jitter_options, options),
                                   .cone = {.degrees = angle,
                                            .angle = radians_from_degrees(angle),
                                            .resolution = selector->options.resolution,
                                            .aperture = selector->options.aperture,
                                            .radius = selector->options.radius,
                                            .range = {selector->range[0], selector->range[1]}}};
    conus_status status = jitter_check(&asked.jitter);
    if (!status && jitter_is_of_ends(&asked.jitter)) {
        status = fail(CONUS_ERROR_ARGUMENT, "jitter: errors of an entry, a target or a depth are of needles");
    }
    status = status ? status : pose_settle(&asked.cone.pose, pose->world_from_device);
    status = status ? status : cone_check(&asked.cone);
    return status ? status : answer(out, selector, &asked);
}
