/* SPDX-License-Identifier: BSD-3-Clause */
/* The areas along a probe, as SpikeGLX and Open Ephys take them (docs/formats.md). Each query is a contact, each row
 * of contacts whose ids differ in the number at their end a shank; or each query is a shank with its segments, whose
 * tip is at the far end of the range; or the queries are the contacts of the report's probes, which say themselves
 * where they are and which channels they have. */
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "conus/own.h"
#include "selection/report/parts.h"

#include <stdlib.h>
#include <string.h>

/* A contact of the report's probes. */
struct site {
    const conus_probe_contact *contact;
    size_t query;
    int64_t channel; /* of its probe; -1 = not wired */
};

struct shank {
    const conus_report *report;
    const struct site *sites;  /* NULL = its contacts are queries */
    size_t first, end;         /* of its queries or sites */
    double origin[3], axis[3]; /* the first contact, and from there to the last one; the axis is a unit vector or 0 */
};

static size_t query_of(const struct shank *shank, size_t place)
{
    return shank->sites ? shank->sites[place].query : place;
}

static const double *position_of(const struct shank *shank, size_t query)
{
    return shank->report->queries[query].asked.cone.pose.world_from_device + 12;
}

/* The first contact from @p place on that has an answer; shank->end if there is none. */
static size_t next_contact(const struct shank *shank, size_t place)
{
    while (place < shank->end && shank->report->queries[query_of(shank, place)].error) {
        place++;
    }
    return place;
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

/* Micrometres along the shank from its first contact, or from the tip. */
static double height_of(const struct shank *shank, size_t place)
{
    double offset[3];
    if (shank->sites) {
        return 1000 * shank->sites[place].contact->offset[2];
    }
    vec3_sub(offset, position_of(shank, place), shank->origin);
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
    size_t next = next_contact(shank, shank->first);
    double bottom = next < shank->end ? height_of(shank, next) : 0;
    while (next < shank->end) {
        struct run run = {.first = next, .last = next, .object = best_of(shank->report, query_of(shank, next))};
        size_t i = next_contact(shank, next + 1);
        for (; i < shank->end && best_of(shank->report, query_of(shank, i)) == run.object;
             i = next_contact(shank, i + 1)) {
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

/* By probe, shank and height; contacts side by side stay in order of their queries. */
static int by_height(const void *a, const void *b)
{
    const struct site *x = a;
    const struct site *y = b;
    int order = compare_unsigned(x->contact->index, y->contact->index);
    order = order ? order : strcmp(x->contact->shank, y->contact->shank);
    return order ? order : compare_double(x->contact->offset[2], y->contact->offset[2]);
}

/* By probe and channel. */
static int by_channel(const void *a, const void *b)
{
    const struct site *x = a;
    const struct site *y = b;
    int order = compare_unsigned(x->contact->index, y->contact->index);
    return order ? order : (x->channel > y->channel) - (x->channel < y->channel);
}

/* [query_count], sorted. Where the file names no channels, they are in its order. */
static conus_status sort_sites(struct site **out, const conus_report *report, order_compare *compare)
{
    struct site *sites = memory_raw(report->query_count, sizeof *sites);
    if (!sites) {
        return CONUS_ERROR_MEMORY;
    }
    int64_t place = 0;
    for (size_t i = 0; i < report->query_count; i++) {
        const conus_probe_contact *contact = report->queries[i].contact;
        place = i && sites[i - 1].contact->index == contact->index ? place + 1 : 0;
        sites[i] = (struct site){contact, i, contact->channel < -1 ? place : contact->channel};
    }
    order_sort(sites, report->query_count, sizeof *sites, compare);
    *out = sites;
    return CONUS_OK;
}

/* A line for each shank of each probe, from the tip. A shank that is called by a number has that one. */
static conus_status write_heights(struct buffer *out, const conus_report *report)
{
    struct site *sites;
    conus_status status = sort_sites(&sites, report, by_height);
    size_t number = 0;
    for (size_t first = 0, end; !status && first < report->query_count; first = end) {
        const conus_probe_contact *contact = sites[first].contact;
        uint64_t named;
        bool is_same_probe = first && sites[first - 1].contact->index == contact->index;
        number = is_same_probe ? number + 1 : 0;
        number = text_to_uint(text_from(contact->shank), INT32_MAX, &named) ? (size_t)named : number;
        for (end = first + 1; end < report->query_count && sites[end].contact->index == contact->index &&
                              strcmp(sites[end].contact->shank, contact->shank) == 0;) {
            end++;
        }
        const struct shank shank = {.report = report, .sites = sites, .first = first, .end = end};
        buffer_format(out, "[%zu,%zu]", contact->index, number);
        write_regions(out, &shank);
        buffer_text(out, "\n");
    }
    if (!status) {
        memory_free(sites);
    }
    return status;
}

static void write_channels(struct buffer *out, int64_t first, int64_t last, const conus_object *object)
{
    buffer_format(out, "%lld-%lld,", (long long)first, (long long)last);
    write_name(out, object);
    buffer_format(out, ",%02X%02X%02X", object->rgb[0], object->rgb[1], object->rgb[2]);
}

/* A line for each probe. Contacts that are not wired have no place in it. */
static conus_status write_wired(struct buffer *out, const conus_report *report)
{
    struct site *sites;
    conus_status status = sort_sites(&sites, report, by_channel);
    const char *separator = "";
    for (size_t first = 0, end; !status && first < report->query_count; first = end) {
        const struct site *site = &sites[first];
        const conus_object *object = best_of(report, site->query);
        for (end = first + 1; end < report->query_count && sites[end].contact->index == site->contact->index &&
                              sites[end].channel == sites[end - 1].channel + (site->channel >= 0) &&
                              (site->channel < 0 || best_of(report, sites[end].query) == object);) {
            end++;
        }
        if (object && site->channel >= 0) {
            buffer_text(out, separator);
            write_channels(out, site->channel, sites[end - 1].channel, object);
            separator = ";";
        }
        if (end == report->query_count || sites[end].contact->index != site->contact->index) {
            buffer_text(out, "\n");
            separator = "";
        }
    }
    if (!status) {
        memory_free(sites);
    }
    return status;
}

/* A cone's rays have no place on a probe. */
static conus_status check_contacts(const conus_report *report)
{
    for (size_t i = 0; i < report->query_count; i++) {
        const struct report_query *query = &report->queries[i];
        if (!query->error && !(query->asked.ball > 0) && !query->asked.is_axis) {
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
        if (report->queries[i].asked.is_axis) {
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
        if (!query->error && !query->asked.is_axis) {
            return fail(CONUS_ERROR_ARGUMENT, "format: \"%s\" is a contact, and no shank, which has a direction",
                        query->id);
        }
        have_tips = have_tips && (query->error || cone_has_range(&query->asked.cone));
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
        double length = report->queries[i].asked.cone.range[1] - report->queries[i].asked.cone.range[0];
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
    const conus_table *segments = report->queries[query].table;
    const uint32_t *objects = conus_table_objects(segments);
    const double *entries = conus_table_numbers(segments, "entry_mm");
    const double *exits = conus_table_numbers(segments, "exit_mm");
    size_t found = SIZE_MAX;
    for (size_t i = 0; i < conus_table_rows(segments); i++) {
        bool holds = objects[i] && entries[i] <= depth && depth < exits[i];
        bool is_deeper =
            found == SIZE_MAX || entries[i] > entries[found]; /* of equal entries the first row has the least exit */
        found = holds && is_deeper ? i : found;
    }
    return found < SIZE_MAX ? conus_atlas_object(report->atlas, objects[found]) : NULL;
}

/* The deepest end of a segment above a depth; that of the range if there is none. */
static double next_border(const conus_report *report, size_t query, double depth)
{
    const conus_table *segments = report->queries[query].table;
    double border = report->queries[query].asked.cone.range[0];
    for (int k = 0; k < 2; k++) {
        const double *ends = conus_table_numbers(segments, k ? "exit_mm" : "entry_mm");
        for (size_t i = 0; i < conus_table_rows(segments); i++) {
            border = ends[i] < depth && ends[i] > border ? ends[i] : border;
        }
    }
    return border;
}

/* How far up the shank the object at a depth reaches; and which one that is. */
static double end_of_region(const conus_object **out, const conus_report *report, size_t query, double depth)
{
    double near = report->queries[query].asked.cone.range[0];
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
    const double *range = report->queries[query].asked.cone.range;
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
                                        : innermost(report, query, report->queries[query].asked.cone.range[1] - height);
}

static conus_status write_spikeglx(struct buffer *out, const conus_report *report)
{
    size_t first = 0;
    if (has_axes(report)) {
        return write_shanks(out, report);
    }
    conus_status status = check_contacts(report);
    if (report->options.probe) {
        return status ? status : write_heights(out, report);
    }
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

static conus_status write_open_ephys(struct buffer *out, const conus_report *report)
{
    const char *separator = "";
    bool of_contacts = !has_axes(report) && !report->options.contacts.count;
    conus_status status = of_contacts ? check_contacts(report) : check_shanks(report);
    status = status || of_contacts ? status : check_rows(report);
    if (report->options.probe) {
        return status ? status : write_wired(out, report);
    }
    size_t channels = report->query_count * (report->options.contacts.count ? report->options.contacts.count : 1);
    for (size_t i = 0; !status && i < channels;) {
        const conus_object *object = object_at(report, i);
        size_t first = i;
        while (i < channels && object_at(report, i) == object) {
            i++;
        }
        if (object) {
            buffer_text(out, separator);
            write_channels(out, (int64_t)first, (int64_t)i - 1, object);
            separator = ";";
        }
    }
    buffer_text(out, report->query_count ? "\n" : "");
    return status;
}

const struct report_format report_format_spikeglx = {.part = write_spikeglx};
const struct report_format report_format_open_ephys = {.part = write_open_ephys};
