/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses Localite's XML. */
#include "poses/programs/pose_programs.h"

#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>

/* A marker, a child of the list, while it is read. */
struct marker {
    bool is_other;                /* not called a marker: <ResponseParameters> of trigger lists */
    char name[POSE_ID_LIMIT + 2]; /* a byte more than allowed, to notice longer names */
    bool unset;
    bool is_trigger;
    size_t matrices;
    double m[16];
    double time_ms;
    conus_status bad;
    char message[256]; /* of bad */
    size_t line;
};

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    bool lps;
    int depth;
    struct marker marker;
};

static conus_status begin_list(struct reading *reading, const struct xml_event *event)
{
    const char *space = xml_attribute(event, "coordinateSpace");
    if (!text_is_one_of(text_from(event->name), "InstrumentMarkerList/TriggerMarkerList/GUMMarkerList", true)) {
        return fail(CONUS_ERROR_DATA,
                    "line %zu: <%.40s>, allowed are InstrumentMarkerList, TriggerMarkerList and GUMMarkerList",
                    event->line, event->name);
    }
    if (!space) {
        reading->lps = reading->options->space == CONUS_SPACE_LPS;
        reading->list->space = pose_space_named(text_from("Localite, no coordinateSpace"), POSE_BRAIN_SUBJECT);
        return notes_warn(&reading->list->notes, "<%s> names no coordinateSpace; taken as %s", event->name,
                          reading->lps ? "LPS" : "RAS");
    }
    if (text_equal_ignoring_case(text_from(space), "MNI")) { /* Localite's own: RAS, by its registration */
        reading->list->space = pose_space_named(text_from("Localite MNI"), POSE_BRAIN_MNI152);
        conus_status status = pose_note_space(&reading->list->notes, reading->options, false);
        return status ? status
                      : notes_add(&reading->list->notes, "Localite brought these positions from the patient's scan to "
                                                         "MNI space; a list in RAS or LPS has them as they were "
                                                         "tracked");
    }
    reading->lps = text_equal_ignoring_case(text_from(space), "LPS"); /* either is of the scan that was loaded */
    reading->list->space =
        pose_space_named(text_from(reading->lps ? "Localite LPS" : "Localite RAS"), POSE_BRAIN_SUBJECT);
    return reading->lps || text_equal_ignoring_case(text_from(space), "RAS")
               ? pose_note_space(&reading->list->notes, reading->options, reading->lps)
               : fail(CONUS_ERROR_DATA, "line %zu: coordinateSpace \"%.40s\", allowed are RAS, LPS and MNI",
                      event->line, space);
}

static void note_bad(struct marker *marker, conus_status bad)
{
    if (bad && !marker->bad) {
        marker->bad = bad;
        snprintf(marker->message, sizeof marker->message, "%s", conus_message());
    }
}

static conus_status read_number(double *out, const struct xml_event *event, const char *name)
{
    const char *value = xml_attribute(event, name);
    struct text text = text_from(value ? value : "");
    return text_to_double(text, out) && isfinite(*out) ? CONUS_OK : pose_no_number(name, text);
}

/* dataRC: row R, column C of world_from_device. */
static conus_status read_matrix(struct marker *marker, const struct xml_event *event)
{
    conus_status status = CONUS_OK;
    for (int i = 0; !status && i < 16; i++) {
        const char name[] = {'d', 'a', 't', 'a', (char)('0' + i / 4), (char)('0' + i % 4), '\0'};
        status = read_number(&marker->m[4 * (i % 4) + i / 4], event, name);
    }
    return status || marker->matrices++ == 0 ? status : fail(CONUS_ERROR_DATA, "two matrices");
}

static conus_status on_start(void *user, const struct xml_event *event)
{
    struct reading *reading = user;
    struct marker *marker = &reading->marker;
    int depth = reading->depth++;
    if (depth == 0) {
        return begin_list(reading, event);
    }
    if (depth == 1) {
        *marker = (struct marker){.line = event->line, .time_ms = NAN};
        marker->is_trigger = text_equal(text_from(event->name), "TriggerMarker");
        marker->is_other = !text_mentions(text_from(event->name), "Marker");
    }
    if (text_equal(text_from(event->name), "Matrix4D")) {
        note_bad(marker, read_matrix(marker, event));
        return CONUS_OK;
    }
    /* Name, state and time stand at the marker or at what is in it, as the kind of list has it. */
    const char *name = xml_attribute(event, "description");
    const char *set = xml_attribute(event, "set");
    if (name) {
        snprintf(marker->name, sizeof marker->name, "%s", name);
    }
    marker->unset = marker->unset || (set && text_equal(text_from(set), "false"));
    if (xml_attribute(event, "recordingTime")) {
        note_bad(marker, read_number(&marker->time_ms, event, "recordingTime"));
    }
    return CONUS_OK;
}

static conus_status read_pose(conus_pose_row *row, const struct reading *reading, struct marker *marker)
{
    if (marker->bad) {
        return fail(marker->bad, "%s", marker->message);
    }
    if (marker->unset) {
        return fail(CONUS_ERROR_DATA, "the marker is not set");
    }
    if (!marker->matrices) {
        return fail(CONUS_ERROR_DATA, "the marker has no Matrix4D");
    }
    double identity[16];
    mat4_identity(identity);
    bool is_identity = true;
    for (int i = 0; i < 16; i++) {
        is_identity = is_identity && marker->m[i] == identity[i];
    }
    if (is_identity) {
        return fail(CONUS_ERROR_DATA, "the matrix is the identity, as of a coil that was not tracked");
    }
    conus_axis axis = reading->options->axis;
    return pose_of_matrix(&row->pose, marker->m, reading->lps, axis ? axis : CONUS_AXIS_PLUS_X);
}

static conus_status on_end(void *user, const struct xml_event *event)
{
    struct reading *reading = user;
    struct marker *marker = &reading->marker;
    (void)event;
    if (--reading->depth != 1 || (marker->is_other && !marker->matrices)) {
        return CONUS_OK;
    }
    conus_pose_row row = pose_row_at(marker->line);
    row.trigger = marker->is_trigger;
    row.time_s = marker->time_ms / 1000;
    conus_status bad = read_pose(&row, reading, marker);
    return pose_list_add(reading->list, &row, text_trim(text_from(marker->name)), bad ? conus_message() : NULL);
}

conus_status pose_localite_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {.list = list, .options = options};
    const struct xml_handler handler = {.start = on_start, .end = on_end, .user = &reading, .notes = &list->notes};
    return xml_parse(&handler, text);
}
