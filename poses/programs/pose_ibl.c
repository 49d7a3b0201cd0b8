/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses JSON of the International Brain Laboratory's tools (iblapps, "Preparing data for ephys GUI"). */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "base/geometry/math3.h"
#include "poses/rows/pose_row.h"

#include <string.h>

static const char picks_key[] = "xyz_picks";
static const char channel_key[] = "channel_";

/* Positions of a brain, micrometres: all of a file nearer to bregma than this are in mm or metres. */
static const double nearest_um = 20;

struct reading {
    struct job *job;
    struct pose_reading *to;
    double bregma[3]; /* ML, AP, DV in CCF, micrometres */
    double farthest;  /* of all coordinates, micrometres */
};

static bool is_channel(const char *key)
{
    uint64_t number;
    return strncmp(key, channel_key, sizeof channel_key - 1) == 0 &&
           text_to_uint(text_from(key + sizeof channel_key - 1), UINT64_MAX, &number);
}

static bool has_channels(json_t *root)
{
    bool found = false;
    const char *key;
    json_t *value;
    json_object_foreach(root, key, value)
    {
        found = found || (is_channel(key) && json_is_object(value));
    }
    return found;
}

bool pose_ibl_is(json_t *root)
{
    return json_object_get(root, picks_key) || has_channels(root);
}

/* Rows are numbered, for the file has no lines that matter. */
static void add_point(struct reading *reading, const json_t *const values[3], struct text id)
{
    double numbers[3] = {0};
    double world[3] = {0};
    const struct attempt attempt = job_try(reading->job);
    for (int i = 0; i < 3; i++) {
        numbers[i] = json_number_value(values[i]);
        if (!json_is_number(values[i])) {
            job_bad(reading->job, "%c: a number is needed, micrometres from bregma", "xyz"[i]);
        }
    }
    for (int i = 0; i < 3 && job_ok(reading->job); i++) {
        reading->farthest = fmax(reading->farthest, fabs(numbers[i]));
    }
    const double *o = reading->bregma; /* the file's own, the frame perhaps counts from another */
    const double ccf[3] = {o[1] - numbers[1], o[2] - numbers[2], o[0] + numbers[0]};
    (void)JOB_CALL(reading->job, pose_point_of_ccf(world, ccf, reading->to->options->frame));
    const char *bad = attempt_end(reading->job, &attempt, ATTEMPT_TRY);
    pose_add_point(reading->to, reading->to->list->count + 1, world, false, id, bad);
}

static void read_picks(struct reading *reading, const json_t *picks)
{
    if (!json_is_array(picks)) {
        job_bad(reading->job, "%s: a list is needed", picks_key);
    }
    for (size_t i = 0; job_ok(reading->job) && i < json_array_size(picks); i++) {
        const json_t *pick = json_array_get(picks, i);
        bool is_triple = json_array_size(pick) == 3;
        const json_t *const values[3] = {is_triple ? json_array_get(pick, 0) : NULL, json_array_get(pick, 1),
                                         json_array_get(pick, 2)};
        add_point(reading, values, (struct text){"", 0});
    }
}

static void read_channels(struct reading *reading, json_t *root)
{
    const json_t *origin = json_object_get(root, "origin"); /* {"bregma": [ML, AP, DV]}, where the file has it */
    if (origin && !json_numbers(reading->bregma, 3, json_object_get(origin, "bregma"))) {
        job_bad(reading->job, "origin.bregma: three numbers are needed, ML, AP, DV in CCF, micrometres");
    }
    const char *key;
    json_t *channel;
    json_object_foreach(root, key, channel)
    {
        const json_t *const values[3] = {json_object_get(channel, "x"), json_object_get(channel, "y"),
                                         json_object_get(channel, "z")};
        if (job_ok(reading->job) && is_channel(key)) {
            add_point(reading, values, text_from(key));
        }
    }
}

/* The International Brain Laboratory's xyz_picks.json, points, or channel_locations.json, channels: micrometres ML,
 * AP, DV from bregma, to the right, anterior, dorsal. They need a frame in CCF or from bregma. */
void pose_ibl_parse(struct pose_reading *to, struct text text)
{
    struct job *job = to->job;
    struct reading reading = {.job = job, .to = to, .bregma = {5739, 5400, 332}}; /* iblatlas's */
    if (to->options->space < CONUS_SPACE_CCF) {
        job_bad(job, "positions from bregma, which only an atlas of the Allen CCF can place: space ccf or bregma is "
                     "needed");
    }
    pose_refuse_axis(to, "points");
    json_t *root = pose_json(to, text);
    const json_t *picks = json_object_get(root, picks_key);
    if (!picks == !has_channels(root)) {
        job_bad(job, picks ? "\"xyz_picks\" and \"channel_N\": positions of IBL are one of them"
                           : "neither \"xyz_picks\" nor \"channel_N\": not positions of IBL");
    }
    if (job_ok(job) && picks) {
        read_picks(&reading, picks);
    } else if (job_ok(job)) {
        read_channels(&reading, root);
    }
    if (to->list->count && reading.farthest < nearest_um) {
        job_bad(job, "no position is farther than %g from bregma: micrometres are needed, not mm or m",
                reading.farthest);
    }
}
