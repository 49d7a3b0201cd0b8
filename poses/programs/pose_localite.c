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
    const char *bad; /* the first fault in it */
    size_t line;
};

struct reading {
    struct job *job;
    struct pose_reading *to;
    bool lps;
    int depth;
    struct marker marker;
};

static void begin_list(struct reading *reading, const struct xml_event *event)
{
    struct job *job = reading->job;
    struct pose_space *named = &reading->to->list->space;
    const char *space = xml_attribute(event, "coordinateSpace");
    if (!text_is_one_of(text_from(event->name), "InstrumentMarkerList/TriggerMarkerList/GUMMarkerList", true)) {
        job_bad(job, "line %zu: <%.40s>, allowed are InstrumentMarkerList, TriggerMarkerList and GUMMarkerList",
                event->line, event->name);
    } else if (!space) {
        reading->lps = reading->to->options->space == CONUS_SPACE_LPS;
        *named = pose_space_named(text_from("Localite, no coordinateSpace"), POSE_BRAIN_SUBJECT);
        job_warn(job, "<%s> names no coordinateSpace; taken as %s", event->name, reading->lps ? "LPS" : "RAS");
    } else if (text_equal_ignoring_case(text_from(space), "MNI")) { /* Localite's own: RAS, by its registration */
        *named = pose_space_named(text_from("Localite MNI"), POSE_BRAIN_MNI152);
        pose_note_space(reading->to->job, reading->to->options, false);
        job_note(job, "Localite brought these positions from the patient's scan to MNI space; a list in RAS or LPS has "
                      "them as they were tracked");
    } else { /* either is of the scan that was loaded */
        reading->lps = text_equal_ignoring_case(text_from(space), "LPS");
        *named = pose_space_named(text_from(reading->lps ? "Localite LPS" : "Localite RAS"), POSE_BRAIN_SUBJECT);
        if (!reading->lps && !text_equal_ignoring_case(text_from(space), "RAS")) {
            job_bad(job, "line %zu: coordinateSpace \"%.40s\", allowed are RAS, LPS and MNI", event->line, space);
        }
        pose_note_space(reading->to->job, reading->to->options, reading->lps);
    }
}

static void read_number(struct job *job, double *out, const struct xml_event *event, const char *name)
{
    const char *value = xml_attribute(event, name);
    struct text text = text_from(value ? value : "");
    if (!text_to_double(text, out) || !isfinite(*out)) {
        (void)JOB_CALL(job, pose_no_number(name, text));
    }
}

/* dataRC: row R, column C of world_from_device. */
static void read_matrix(struct job *job, struct marker *marker, const struct xml_event *event)
{
    for (int i = 0; i < 16; i++) {
        const char name[] = {'d', 'a', 't', 'a', (char)('0' + i / 4), (char)('0' + i % 4), '\0'};
        read_number(job, &marker->m[4 * (i % 4) + i / 4], event, name);
    }
    if (job_ok(job) && marker->matrices++) {
        job_bad(job, "two matrices");
    }
}

static conus_status on_start(void *user, const struct xml_event *event)
{
    struct reading *reading = user;
    struct job *job = reading->job;
    struct marker *marker = &reading->marker;
    int depth = reading->depth++;
    if (depth == 0) {
        begin_list(reading, event);
        return job->status;
    }
    if (depth == 1) {
        *marker = (struct marker){.line = event->line, .time_ms = NAN};
        marker->is_trigger = text_equal(text_from(event->name), "TriggerMarker");
        marker->is_other = !text_mentions(text_from(event->name), "Marker");
    }
    /* Name, state and time stand at the marker or at what is in it, as the kind of list has it. */
    bool is_matrix = text_equal(text_from(event->name), "Matrix4D");
    const char *name = is_matrix ? NULL : xml_attribute(event, "description");
    const char *set = is_matrix ? NULL : xml_attribute(event, "set");
    if (name) {
        snprintf(marker->name, sizeof marker->name, "%s", name);
    }
    marker->unset = marker->unset || (set && text_equal(text_from(set), "false"));
    const struct attempt attempt = job_try(job);
    if (is_matrix) {
        read_matrix(job, marker, event);
    } else if (xml_attribute(event, "recordingTime")) {
        read_number(job, &marker->time_ms, event, "recordingTime");
    }
    const char *bad = attempt_end(job, &attempt, ATTEMPT_TRY);
    marker->bad = marker->bad ? marker->bad : bad;
    return job->status;
}

static void read_pose(conus_pose_row *row, const struct reading *reading, const struct marker *marker)
{
    struct job *job = reading->job;
    conus_axis axis = reading->to->options->axis;
    double identity[16];
    mat4_identity(identity);
    bool is_identity = mat4_is_same(marker->m, identity);
    bool is_zero = mat4_is_same(marker->m, (double[16]){0}) || mat4_is_same(marker->m, (double[16]){[15] = 1});
    if (marker->bad) {
        job_bad(job, "%s", marker->bad);
    } else if (marker->unset) {
        job_bad(job, "the marker is not set");
    } else if (!marker->matrices) {
        job_bad(job, "the marker has no Matrix4D");
    } else if (is_identity || is_zero) {
        job_bad(job, "the matrix is %s, as of a coil that was not tracked", is_zero ? "all 0" : "the identity");
    }
    (void)JOB_CALL(job, pose_of_matrix(&row->pose, marker->m, reading->lps, axis ? axis : CONUS_AXIS_PLUS_X));
}

static conus_status on_end(void *user, const struct xml_event *event)
{
    struct reading *reading = user;
    const struct marker *marker = &reading->marker;
    (void)event;
    if (--reading->depth != 1 || (marker->is_other && !marker->matrices)) {
        return CONUS_OK;
    }
    conus_pose_row row = pose_row_at(marker->line);
    row.trigger = marker->is_trigger;
    row.time_s = marker->time_ms / 1000;
    const struct attempt attempt = job_try(reading->job);
    read_pose(&row, reading, marker);
    const char *bad = attempt_end(reading->job, &attempt, ATTEMPT_TRY);
    pose_add(reading->to, &row, text_trim(text_from(marker->name)), bad);
    return reading->job->status;
}

/* Localite's markers, InstrumentMarker*.xml and TriggerMarkers*.xml. */
void pose_localite_parse(struct pose_reading *to, struct text text)
{
    struct reading reading = {.job = to->job, .to = to};
    const struct xml_handler handler = {.start = on_start, .end = on_end, .user = &reading, .notes = &to->job->notes};
    (void)JOB_CALL(to->job, xml_parse(&handler, text));
}
