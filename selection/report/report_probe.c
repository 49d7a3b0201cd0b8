/* SPDX-License-Identifier: BSD-3-Clause */
/* The areas along a probe, as SpikeGLX and Open Ephys take them (docs/formats.md). Each query is a contact, each row
 * of contacts whose ids differ in the number at their end a shank; or each query is a shank with its segments, whose
 * tip is at the far end of the range. */
#include "base/geometry/math3.h"
#include "selection/report/report_writers.h"

#include <string.h>

struct shank {
    const conus_report *report;
    size_t first, end;         /* of its queries */
    double origin[3], axis[3]; /* the first contact, and from there to the last one; the axis is a unit vector or 0 */
};

static const double *position_of(const struct shank *shank, size_t query)
{
    return shank->report->queries[query].cone.pose.world_from_device + 12;
}

/* The first contact from @p query on that has an answer; shank->end if there is none. */
static size_t next_contact(const struct shank *shank, size_t query)
{
    while (query < shank->end && shank->report->queries[query].error) {
        query++;
    }
    return query;
}

/* The object with the best score at a contact; NULL if nothing is there. */
static const conus_object *best_of(const conus_report *report, size_t query)
{
    size_t row = report->queries[query].first_row;
    bool is_answer = row < report->row_count && report->rows[row].query == query && !report->queries[query].error;
    return is_answer ? conus_atlas_object(report->atlas, report->rows[row].result.object) : NULL;
}

/* Length of an id without the number at its end. */
static size_t stem_of(const char *id)
{
    size_t size = strlen(id);
    while (size && id[size - 1] >= '0' && id[size - 1] <= '9') {
        size--;
    }
    return size;
}

static struct shank find_shank(const conus_report *report, size_t first)
{
    struct shank shank = {.report = report, .first = first, .end = first + 1};
    const char *id = report->queries[first].id;
    size_t stem = stem_of(id);
    while (shank.end < report->query_count && stem_of(report->queries[shank.end].id) == stem &&
           memcmp(report->queries[shank.end].id, id, stem) == 0) {
        shank.end++;
    }
    size_t low = next_contact(&shank, first);
    size_t high = low;
    for (size_t i = low; i < shank.end; i = next_contact(&shank, i + 1)) {
        high = i;
    }
    if (low < shank.end) {
        memcpy(shank.origin, position_of(&shank, low), sizeof shank.origin);
        vec3_sub(shank.axis, position_of(&shank, high), shank.origin);
        double length = vec3_length(shank.axis);
        vec3_scale(shank.axis, shank.axis, length > 0 ? 1 / length : 0);
    }
    return shank;
}

/* Micrometres along the shank from its first contact. */
static double height_of(const struct shank *shank, size_t query)
{
    double offset[3];
    vec3_sub(offset, position_of(shank, query), shank->origin);
    return 1000 * vec3_dot(offset, shank->axis);
}

/* The abbreviation, or else the name; what these formats separate by is written as a space. */
static void write_name(struct buffer *out, const conus_object *object)
{
    const char *name = object->abbreviation[0] ? object->abbreviation : object->name;
    for (; *name; name++) {
        buffer_append(out, strchr("(),;[]", *name) ? " " : name, 1);
    }
}

/* A row of contacts with the same answer; begins at the first contact from *next on, and sets *next behind it. */
struct run {
    size_t first, last;
    const conus_object *object;
};

/* Heights in micrometres. */
static void write_region(struct buffer *out, double bottom, double top, const conus_object *object)
{
    const uint8_t *rgb = object->rgb;
    buffer_format(out, "(%.0f,%.0f,%d,%d,%d,", bottom, top, rgb[0], rgb[1], rgb[2]);
    write_name(out, object);
    buffer_text(out, ")");
}

/* Areas border halfway between contacts. */
static void write_regions(struct buffer *out, const struct shank *shank)
{
    double bottom = 0;
    for (size_t next = next_contact(shank, shank->first); next < shank->end;) {
        struct run run = {.first = next, .last = next, .object = best_of(shank->report, next)};
        size_t i = next_contact(shank, next + 1);
        for (; i < shank->end && best_of(shank->report, i) == run.object; i = next_contact(shank, i + 1)) {
            run.last = i;
        }
        next = i;
        double top = height_of(shank, run.last);
        top = next < shank->end ? (top + height_of(shank, next)) / 2 : top;
        top = fmax(top, bottom);
        if (run.object) {
            write_region(out, bottom, top, run.object);
        }
        bottom = top;
    }
}

/* A cone's rays have no place on a probe. */
static conus_status check_contacts(const conus_report *report)
{
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        if (!query->error && !(query->ball > 0) && !query->is_axis) {
            return fail(CONUS_ERROR_ARGUMENT,
                        "format: contacts of a probe are points with a radius, \"%s\" has a direction", query->id);
        }
    }
    return CONUS_OK;
}

/* A shank whose contacts all lie at one place has no length to put areas on. */
static conus_status check_length(const struct shank *shank)
{
    bool has_contact = next_contact(shank, shank->first) < shank->end;
    return !has_contact || vec3_length(shank->axis) > 0
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT,
                      "format: the shank of contact \"%s\" has no length; its contacts have names that differ in the "
                      "number at their end, and lie at different places",
                      shank->report->queries[shank->first].id);
}

/* Whether the queries are shanks. */
static bool has_axes(const conus_report *report)
{
    for (size_t i = 0; i < report->query_count; i++) {
        if (report->queries[i].is_axis) {
            return true;
        }
    }
    return false;
}

static conus_status check_shanks(const conus_report *report)
{
    bool have_tips = true;
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        if (!query->error && !query->is_axis) {
            return fail(CONUS_ERROR_ARGUMENT, "format: \"%s\" is a contact, and no shank, which has a direction",
                        query->id);
        }
        have_tips = have_tips && (query->error || cone_has_range(&query->cone));
    }
    return have_tips ? CONUS_OK
                     : fail(CONUS_ERROR_ARGUMENT,
                            "range: a shank has its tip at the far end of the range, and there is none");
}

/* Open Ephys counts channels. */
static conus_status check_rows(const conus_report *report)
{
    const conus_contacts *contacts = &report->options.contacts;
    if (!contacts->count) {
        return fail(CONUS_ERROR_ARGUMENT, "contacts: Open Ephys counts those of a shank, and there are none");
    }
    uint32_t last = (contacts->count - 1) / contacts->columns;
    double height = contacts->tip + last * contacts->pitch;
    for (size_t i = 0; i < report->query_count; i++) {
        double length = report->queries[i].cone.range[1] - report->queries[i].cone.range[0];
        if (!report->queries[i].error && height > length) {
            return fail(CONUS_ERROR_ARGUMENT,
                        "contacts: the last is %g mm from the tip, but the range is only %g mm long", height, length);
        }
    }
    return CONUS_OK;
}

/* The object at a depth on a shank that was entered last, of equals the one that is left first; NULL =
 * there is none. */
static const conus_object *innermost(const conus_report *report, size_t query, double depth)
{
    const conus_segment *found = NULL;
    for (size_t i = report->queries[query].first_row; i < report_row_end(report, query); i++) {
        const conus_segment *segment = &report->rows[i].segment;
        bool holds = segment->object && segment->entry <= depth && depth < segment->exit;
        bool is_deeper =
            !found || segment->entry > found->entry; /* of equal entries the first row has the least exit */
        found = holds && is_deeper ? segment : found;
    }
    return found ? conus_atlas_object(report->atlas, found->object) : NULL;
}

/* The deepest end of a segment above a depth; that of the range if there is none. */
static double next_border(const conus_report *report, size_t query, double depth)
{
    double border = report->queries[query].cone.range[0];
    for (size_t i = report->queries[query].first_row; i < report_row_end(report, query); i++) {
        const double ends[] = {report->rows[i].segment.entry, report->rows[i].segment.exit};
        for (int k = 0; k < 2; k++) {
            border = ends[k] < depth && ends[k] > border ? ends[k] : border;
        }
    }
    return border;
}

/* How far up the shank the object at a depth reaches; and which one that is. */
static double end_of_region(const conus_object **out, const conus_report *report, size_t query, double depth)
{
    double near = report->queries[query].cone.range[0];
    double end = next_border(report, query, depth);
    *out = innermost(report, query, (depth + end) / 2);
    while (end > near) {
        double next = next_border(report, query, end);
        if (innermost(report, query, (end + next) / 2) != *out) {
            break;
        }
        end = next;
    }
    return end;
}

/* From the tip on. */
static void write_shank(struct buffer *out, const conus_report *report, size_t query)
{
    const double *range = report->queries[query].cone.range;
    double depth = range[1];
    while (depth > range[0]) {
        const conus_object *object;
        double end = end_of_region(&object, report, query, depth);
        if (object) {
            write_region(out, 1000 * (range[1] - depth), 1000 * (range[1] - end), object);
        }
        depth = end;
    }
}

static conus_status write_shanks(struct buffer *out, const conus_report *report)
{
    conus_status status = check_shanks(report);
    for (size_t i = 0; i < report->query_count && !status; i++) {
        buffer_format(out, "[0,%zu]", i);
        if (!report->queries[i].error) {
            write_shank(out, report, i);
        }
        buffer_text(out, "\n");
    }
    return status;
}

/* The object at a channel: at a query, or at one of the contacts of a shank. */
static const conus_object *object_at(const conus_report *report, size_t channel)
{
    const conus_contacts *contacts = &report->options.contacts;
    if (!contacts->count) {
        return best_of(report, channel);
    }
    size_t query = channel / contacts->count;
    size_t row = channel % contacts->count / contacts->columns;
    double height = contacts->tip + (double)row * contacts->pitch;
    return report->queries[query].error ? NULL
                                        : innermost(report, query, report->queries[query].cone.range[1] - height);
}

conus_status report_write_spikeglx(struct buffer *out, const conus_report *report)
{
    size_t first = 0;
    if (has_axes(report)) {
        return write_shanks(out, report);
    }
    conus_status status = check_contacts(report);
    for (size_t number = 0; !status && first < report->query_count; number++) {
        const struct shank shank = find_shank(report, first);
        status = check_length(&shank);
        buffer_format(out, "[0,%zu]", number);
        write_regions(out, &shank);
        buffer_text(out, "\n");
        first = shank.end;
    }
    return status;
}

conus_status report_write_open_ephys(struct buffer *out, const conus_report *report)
{
    const char *separator = "";
    bool of_contacts = !has_axes(report) && !report->options.contacts.count;
    conus_status status = of_contacts ? check_contacts(report) : check_shanks(report);
    status = status || of_contacts ? status : check_rows(report);
    size_t channels = report->query_count * (report->options.contacts.count ? report->options.contacts.count : 1);
    for (size_t i = 0; !status && i < channels;) {
        const conus_object *object = object_at(report, i);
        size_t first = i;
        while (i < channels && object_at(report, i) == object) {
            i++;
        }
        if (object) {
            buffer_format(out, "%s%zu-%zu,", separator, first, i - 1);
            write_name(out, object);
            buffer_format(out, ",%02X%02X%02X", object->rgb[0], object->rgb[1], object->rgb[2]);
            separator = ";";
        }
    }
    buffer_text(out, report->query_count ? "\n" : "");
    return status;
}
