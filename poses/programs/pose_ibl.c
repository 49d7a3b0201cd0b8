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
    conus_pose_list *list;
    const conus_frame *frame;
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
    for (void *at = json_object_iter(root); at && !found; at = json_object_iter_next(root, at)) {
        found = is_channel(json_object_iter_key(at)) && json_is_object(json_object_iter_value(at));
    }
    return found;
}

bool pose_ibl_is(json_t *root)
{
    return json_object_get(root, picks_key) || has_channels(root);
}

/* From ML, AP, DV to the frame's space. The file counts from its own bregma, the frame perhaps from another. */
static conus_status find_point(double world[3], const struct reading *reading, const double mlapdv[3])
{
    const double *o = reading->bregma;
    const double *b = reading->frame->bregma;
    const double ccf[3] = {o[1] - mlapdv[1], o[2] - mlapdv[2], o[0] + mlapdv[0]};
    const double mm[3] = {(b[0] - ccf[0]) / 1000, (ccf[2] - b[2]) / 1000, (b[1] - ccf[1]) / 1000};
    return conus_frame_to_world(world, reading->frame, reading->frame->space == CONUS_SPACE_CCF ? ccf : mm);
}

/* Rows are numbered, for the file has no lines that matter. */
static conus_status add_point(struct reading *reading, const json_t *const values[3], struct text id)
{
    double numbers[3] = {0};
    double world[3] = {0};
    conus_status bad = CONUS_OK;
    for (int i = 0; i < 3 && !bad; i++) {
        numbers[i] = json_number_value(values[i]);
        if (!json_is_number(values[i])) {
            bad = fail(CONUS_ERROR_DATA, "%c: a number is needed, micrometres from bregma", "xyz"[i]);
        }
    }
    for (int i = 0; i < 3 && !bad; i++) {
        reading->farthest = fmax(reading->farthest, fabs(numbers[i]));
    }
    bad = bad ? bad : find_point(world, reading, numbers);
    return pose_list_add_point(reading->list, reading->list->count + 1, world, false, id, bad);
}

static conus_status read_picks(struct reading *reading, const json_t *picks)
{
    conus_status status = json_is_array(picks) ? CONUS_OK : fail(CONUS_ERROR_DATA, "%s: a list is needed", picks_key);
    for (size_t i = 0; !status && i < json_array_size(picks); i++) {
        const json_t *pick = json_array_get(picks, i);
        bool is_triple = json_array_size(pick) == 3;
        const json_t *const values[3] = {is_triple ? json_array_get(pick, 0) : NULL, json_array_get(pick, 1),
                                         json_array_get(pick, 2)};
        status = add_point(reading, values, (struct text){"", 0});
    }
    return status;
}

static conus_status read_channels(struct reading *reading, json_t *root)
{
    const json_t *origin = json_object_get(root, "origin"); /* {"bregma": [ML, AP, DV]}, where the file has it */
    const json_t *bregma = json_object_get(origin, "bregma");
    conus_status status = !origin || json_numbers(reading->bregma, 3, bregma)
                              ? CONUS_OK
                              : fail(CONUS_ERROR_DATA, "origin.bregma: three numbers are needed, ML, AP, DV in CCF, "
                                                       "micrometres");
    for (void *at = json_object_iter(root); at && !status; at = json_object_iter_next(root, at)) {
        const char *key = json_object_iter_key(at);
        const json_t *channel = json_object_iter_value(at);
        const json_t *const values[3] = {json_object_get(channel, "x"), json_object_get(channel, "y"),
                                         json_object_get(channel, "z")};
        if (is_channel(key)) {
            status = add_point(reading, values, text_from(key));
        }
    }
    return status;
}

conus_status pose_ibl_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    json_t *root = NULL;
    struct reading reading = {.list = list, .frame = options->frame, .bregma = {5739, 5400, 332}}; /* iblatlas's */
    if (options->space < CONUS_SPACE_CCF) {
        return fail(CONUS_ERROR_DATA,
                    "positions from bregma, which only an atlas of the Allen CCF can place: space ccf or "
                    "bregma is needed");
    }
    conus_status status = pose_no_axis(options, "points");
    status = status ? status : json_text_load(&root, text);
    const json_t *picks = json_object_get(root, picks_key);
    if (!status && !picks == !has_channels(root)) {
        status = fail(CONUS_ERROR_DATA, picks ? "\"xyz_picks\" and \"channel_N\": positions of IBL are one of them"
                                              : "neither \"xyz_picks\" nor \"channel_N\": not positions of IBL");
    }
    if (!status) {
        status = picks ? read_picks(&reading, picks) : read_channels(&reading, root);
    }
    if (!status && list->count && reading.farthest < nearest_um) {
        status =
            fail(CONUS_ERROR_DATA, "no position is farther than %g from bregma: micrometres are needed, not mm or m",
                 reading.farthest);
    }
    json_decref(root);
    return status;
}
