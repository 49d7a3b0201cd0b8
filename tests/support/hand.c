/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulated paths of a hand, the ways of selecting, and their success (Eq. 12). */
#include "tests/support/hand.h"

#include "base/geometry/math3.h"
#include "conus/selection.h"

#include <string.h>

enum { SEED = 2005, SAMPLE_LIMIT = 256, LOOK_RESOLUTION = 64, LEAST_PIXELS = 6, TREMORS = 3 };

const struct hand_method hand_methods[HAND_METHODS] = {
    {"ray", "share", 1, -1},
    {"ray, 0.15 s before", "share", 1, 0.15},
    {"share", "share", 16, -1},
    {"share, 0.15 s before", "share", 16, 0.15},
    {"intenselect", "intenselect", 16, -1},
    {"intenselect, 0.15 s before", "intenselect", 16, 0.15},
    {"intenselect_plus", "intenselect_plus", 16, -1},
    {"intenselect_plus, 0.15 s before", "intenselect_plus", 16, 0.15},
};

struct sample {
    double time;
    conus_pose pose;
    bool trigger;
};

struct trial {
    conus_pose aim; /* without any error */
    uint32_t area;  /* the area that is meant */
    double arrival, press;
    struct sample samples[SAMPLE_LIMIT];
    size_t count;
};

struct source {
    hand_random random;
    uint64_t state;
};

static double uniform(struct source *source, double low, double high)
{
    return source->random(&source->state, low, high);
}

/* Box and Muller 1958. */
static double normal(struct source *source)
{
    double radius = sqrt(-2 * log(1 - uniform(source, 0, 1)));
    return radius * cos(2 * MATH3_PI * uniform(source, 0, 1));
}

static void find_centre(double out[3], const conus_atlas *atlas)
{
    const conus_volume_info *info = &atlas->volumes[0].info;
    for (int a = 0; a < 3; a++) {
        out[a] = 0.5 * (double)(info->dim[a] - 1);
    }
    mat4_point(out, info->world_from_voxel, out);
}

static void place_device(double out[3], const double centre[3], struct source *source)
{
    double z = uniform(source, -1, 1);
    double turn = uniform(source, 0, 2 * MATH3_PI);
    const double outward[3] = {sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
    vec3_add_scaled(out, centre, uniform(source, 350, 500), outward);
}

/* The pixel of the area that is closest to the middle of its visible part. */
static size_t middle_pixel(const conus_evidence *seen, uint32_t area)
{
    double sum[3] = {0};
    size_t best = 0;
    double least = INFINITY;
    for (size_t row = 0; row < LOOK_RESOLUTION; row++) {
        for (size_t column = 0; column < LOOK_RESOLUTION; column++) {
            bool is_here = seen->object[row * LOOK_RESOLUTION + column] == area;
            sum[0] += is_here ? (double)column : 0;
            sum[1] += is_here ? (double)row : 0;
            sum[2] += is_here;
        }
    }
    for (size_t row = 0; row < LOOK_RESOLUTION; row++) {
        for (size_t column = 0; column < LOOK_RESOLUTION; column++) {
            size_t pixel = row * LOOK_RESOLUTION + column;
            double away = hypot((double)column - sum[0] / sum[2], (double)row - sum[1] / sum[2]);
            if (seen->object[pixel] == area && away < least) {
                best = pixel;
                least = away;
            }
        }
    }
    return best;
}

/* Chooses any of the areas of which enough is visible, each with the same probability. */
static bool choose_area(struct trial *trial, double target[3], const conus_selection *selection, struct source *source)
{
    uint32_t areas[SAMPLE_LIMIT];
    size_t count = 0;
    for (size_t i = 0; i < conus_selection_count(selection) && count < SAMPLE_LIMIT; i++) {
        const conus_result *result = conus_selection_result(selection, i);
        if (result->kind == CONUS_KIND_AREA && result->pixels >= LEAST_PIXELS) {
            areas[count++] = result->object;
        }
    }
    if (!count) {
        return false;
    }
    trial->area = areas[(size_t)uniform(source, 0, (double)count)];
    const conus_evidence seen = conus_selection_evidence(selection);
    conus_selection_position(target, selection, middle_pixel(&seen, trial->area));
    return true;
}

static conus_status choose(struct trial *trial, conus_selector *chooser, const double centre[3], struct source *source)
{
    bool chosen = false;
    conus_status status = CONUS_OK;
    while (!status && !chosen) {
        double origin[3];
        double target[3];
        conus_selection *selection = NULL;
        place_device(origin, centre, source);
        status = conus_pose_toward(&trial->aim, origin, centre, NULL);
        status = status ? status : conus_select(&selection, chooser, &trial->aim, 40);
        chosen = !status && choose_area(trial, target, selection, source);
        conus_selection_destroy(selection);
        if (chosen) {
            status = conus_pose_toward(&trial->aim, origin, target, NULL);
        }
    }
    return status;
}

/* Part of a movement after a part of its time, without a jerk at either end (Flash and Hogan 1985). */
static double minimum_jerk(double part)
{
    double t = fmin(1, fmax(0, part));
    return t * t * t * (10 + t * (6 * t - 15));
}

/* The errors of one angle or of one coordinate over time. */
struct wobble {
    double drift;
    double frequency[TREMORS], phase[TREMORS];
};

static struct wobble start_wobble(struct source *source)
{
    struct wobble wobble = {.drift = HAND_DRIFT * normal(source)};
    for (int i = 0; i < TREMORS; i++) {
        wobble.frequency[i] = uniform(source, 8, 12);
        wobble.phase[i] = uniform(source, 0, 2 * MATH3_PI);
    }
    return wobble;
}

/* Tremor with a root mean square of 1. */
static double tremor(const struct wobble *wobble, double time)
{
    double sum = 0;
    for (int i = 0; i < TREMORS; i++) {
        sum += sin(2 * MATH3_PI * wobble->frequency[i] * time + wobble->phase[i]);
    }
    return sum * sqrt(2.0 / TREMORS);
}

static void drift(struct wobble *wobble, double dt, struct source *source)
{
    double kept = exp(-dt / HAND_DRIFT_TIME);
    wobble->drift = wobble->drift * kept + HAND_DRIFT * sqrt(1 - kept * kept) * normal(source);
}

/* The pose @p aim turned by yaw and pitch, degrees, and moved. */
static conus_status deviate(conus_pose *out, const conus_pose *aim, const double angles[2], const double shift[3])
{
    const double *m = aim->world_from_device;
    double origin[3];
    double direction[3] = {-m[8], -m[9], -m[10]};
    vec3_add_scaled(origin, m + 12, 1, shift);
    vec3_add_scaled(direction, direction, tan(radians_from_degrees(angles[0])), m);
    vec3_add_scaled(direction, direction, tan(radians_from_degrees(angles[1])), m + 4);
    return conus_pose_along(out, origin, direction, NULL);
}

static conus_status record_trial(struct trial *trial, double start, struct source *source)
{
    struct wobble yaw = start_wobble(source);
    struct wobble pitch = start_wobble(source);
    struct wobble place[3] = {start_wobble(source), start_wobble(source), start_wobble(source)};
    const double far = uniform(source, 6, 10);
    const double from = uniform(source, 0, 2 * MATH3_PI);
    const double jerk = uniform(source, HAND_JERK_LOW, HAND_JERK_HIGH);
    const double sideways = jerk * uniform(source, -0.5, 0.5);
    conus_status status = CONUS_OK;
    trial->arrival = start + HAND_APPROACH;
    trial->press = trial->arrival + uniform(source, HAND_DWELL_LOW, HAND_DWELL_HIGH);
    trial->count = 0;
    for (int i = 0; !status && trial->count < SAMPLE_LIMIT; i++) {
        double time = start + i / HAND_RATE;
        double away = far * (1 - minimum_jerk((time - start) / HAND_APPROACH));
        double pressed = minimum_jerk((time - trial->press + HAND_JERK_BEFORE) / HAND_JERK_RISE);
        const double angles[2] = {away * cos(from) + yaw.drift + HAND_TREMOR * tremor(&yaw, time) + pressed * sideways,
                                  away * sin(from) + pitch.drift + HAND_TREMOR * tremor(&pitch, time) - pressed * jerk};
        double shift[3];
        for (int a = 0; a < 3; a++) {
            shift[a] = HAND_POSITION * tremor(&place[a], time);
        }
        drift(&yaw, 1 / HAND_RATE, source);
        drift(&pitch, 1 / HAND_RATE, source);
        if (time > trial->press + 0.1) {
            break;
        }
        bool is_first_press = time >= trial->press && trial->count && !trial->samples[trial->count - 1].trigger;
        if (is_first_press || uniform(source, 0, 1) > 0.02) {
            struct sample *sample = &trial->samples[trial->count++];
            *sample = (struct sample){.time = time, .trigger = time >= trial->press};
            status = deviate(&sample->pose, &trial->aim, angles, shift);
        }
    }
    return status;
}

static conus_status follow(struct hand_outcome *out, size_t method, conus_tracker *tracker, const struct trial *trial)
{
    uint32_t before = 0;
    uint32_t confirmed = 0;
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < trial->count; i++) {
        const struct sample *sample = &trial->samples[i];
        conus_selection *selection = NULL;
        status = conus_tracker_step(&selection, tracker, sample->time, &sample->pose, 10, sample->trigger);
        const conus_step *step = conus_selection_step(selection);
        if (step) {
            bool counts = sample->time > trial->arrival && !sample->trigger && i > 0;
            out->changes[method] += counts && step->selected != before;
            before = step->selected;
            confirmed = step->confirmed ? step->confirmed : confirmed;
        }
        conus_selection_destroy(selection);
    }
    out->hits[method] += confirmed == trial->area;
    return status;
}

static void write_trial(struct buffer *record, size_t number, const struct trial *trial)
{
    for (size_t i = 0; i < trial->count; i++) {
        const struct sample *sample = &trial->samples[i];
        const double *m = sample->pose.world_from_device;
        buffer_format(record, "%zu\t%.4f\t%d", number, sample->time, sample->trigger);
        for (int a = 0; a < 3; a++) {
            buffer_format(record, "\t%.3f", m[12 + a]);
        }
        for (int a = 0; a < 3; a++) {
            buffer_format(record, "\t%.6f", 0 - m[8 + a]);
        }
        buffer_text(record, "\n");
    }
}

struct crew {
    conus_selector *chooser, *selectors[HAND_METHODS];
    conus_tracker *trackers[HAND_METHODS];
};

static void dismiss(struct crew *crew)
{
    conus_selector_destroy(crew->chooser);
    for (size_t i = 0; i < HAND_METHODS; i++) {
        conus_tracker_destroy(crew->trackers[i]);
        conus_selector_destroy(crew->selectors[i]);
    }
}

static conus_status hire(struct crew *crew, const conus_atlas *atlas)
{
    conus_status status = conus_selector_create(&crew->chooser, atlas,
                                                &(conus_selector_options){.engine = CONUS_ENGINE_RAYS,
                                                                          .resolution = LOOK_RESOLUTION,
                                                                          .aperture = CONUS_APERTURE_SQUARE});
    for (size_t i = 0; !status && i < HAND_METHODS; i++) {
        const struct hand_method *method = &hand_methods[i];
        const conus_selector_options options = {
            .engine = CONUS_ENGINE_RAYS, .resolution = method->resolution, .score = method->score};
        const conus_tracker_options constants = {.delay = method->delay};
        status = conus_selector_create(&crew->selectors[i], atlas, &options);
        status = status ? status : conus_tracker_create(&crew->trackers[i], crew->selectors[i], &constants);
    }
    return status;
}

conus_status hand_run(struct hand_outcome *out, const conus_atlas *atlas, size_t trials, hand_random random,
                      struct buffer *record)
{
    struct source source = {random, SEED};
    struct crew crew = {0};
    struct trial trial;
    double centre[3];
    conus_status status = hire(&crew, atlas);
    *out = (struct hand_outcome){0};
    find_centre(centre, atlas);
    if (record) {
        buffer_text(record, "query_id\ttime_s\ttrigger\tx\ty\tz\tdx\tdy\tdz\n");
    }
    for (size_t t = 0; !status && t < trials; t++) {
        status = choose(&trial, crew.chooser, centre, &source);
        status = status ? status : record_trial(&trial, 10.0 * (double)t, &source); /* far apart: all start afresh */
        for (size_t i = 0; !status && i < HAND_METHODS; i++) {
            status = follow(out, i, crew.trackers[i], &trial);
        }
        out->seconds += trial.press - trial.arrival;
        if (record && !status) {
            write_trial(record, t + 1, &trial);
        }
    }
    dismiss(&crew);
    return status;
}
