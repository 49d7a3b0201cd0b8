/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses ProbeInterface's JSON, and puts the contacts of its probes where poses say. */
#include "poses/programs/pose_programs.h"

#include "base/files/file.h"
#include "base/formats/json_text.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>
#include <string.h>

enum { PROBE_LIMIT = 1024, NAME_SIZE = 32, CHANNEL_LIMIT = INT32_MAX };

static const double FARTHEST_UM = 1e6;   /* a probe is shorter than 1 m: another unit was meant */
static const double LEVEL = 1e-6;        /* heights that differ by less, in heights of the contour, are equal */
static const double PARALLEL = 1 - 1e-6; /* cosine between equal axes */

struct one_probe {
    char name[POSE_ID_LIMIT + 1];
    double tip[3]; /* as in the file, micrometres */
};

struct conus_probe {
    struct job job; /* which owns the rest */
    conus_probe_contact *contacts;
    size_t count;
    struct one_probe *probes; /* [probe_count] */
    size_t probe_count;
};

/* One probe of the file. */
struct reading {
    struct job *job;
    conus_probe *out;
    const json_t *json;
    size_t index;        /* of the probe */
    size_t first, count; /* its contacts in out */
    size_t dims;
    double scale;      /* micrometres per unit of the file */
    double axes[3][3]; /* in the file's coordinates: across the shanks, along them to the base, and off their plane */
    double tip;        /* mm from the tip to the lowest contact; 0 = by the contour */
};

/* A key's value; NULL where it is absent or null. */
static const json_t *value_of(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);
    return json_is_null(value) ? NULL : value;
}

/* A list with an entry for each contact; NULL where it is absent. */
static const json_t *find_list(const struct reading *reading, const char *key)
{
    const json_t *list = value_of(reading->json, key);
    if (list && (!json_is_array(list) || json_array_size(list) != reading->count)) {
        job_bad(reading->job, "%s: found %zu entries, wanted is a list of %zu, one for each contact", key,
                json_array_size(list), reading->count);
    }
    return list;
}

/* The coordinates that the file has; the third is 0 of two dimensions. */
static bool read_numbers(double out[3], const json_t *list, size_t dims)
{
    out[2] = 0;
    return json_numbers(out, dims, list);
}

/* Position `i` of a list, micrometres. */
static void read_position(double out[3], const struct reading *reading, const char *key, const json_t *list, size_t i)
{
    if (!read_numbers(out, json_array_get(list, i), reading->dims)) {
        job_bad(reading->job, "%s[%zu]: %zu numbers are needed", key, i, reading->dims);
        return;
    }
    vec3_scale(out, out, reading->scale);
    double most = fmax(fmax(fabs(out[0]), fabs(out[1])), fabs(out[2]));
    if (!(most <= FARTHEST_UM)) {
        job_bad(reading->job, "%s[%zu]: found %g mm, allowed are up to 1000; is si_units right?", key, i, most / 1000);
    }
}

static void read_frame(struct reading *reading)
{
    const json_t *dims = value_of(reading->json, "ndim");
    struct text unit = json_text_of(value_of(reading->json, "si_units"));
    reading->dims = json_is_integer(dims) ? (size_t)json_integer_value(dims) : 0;
    reading->scale = 1000 * space_unit_mm(unit);
    if (reading->dims != 2 && reading->dims != 3) {
        job_bad(reading->job, "ndim: 2 or 3 is needed");
    } else if (!(reading->scale > 0)) {
        job_bad(reading->job, "si_units: \"%.*s\", allowed are um, mm, cm and m", POSE_QUOTE(unit));
    }
}

/* In three dimensions the plane of the contacts says which way the shanks run; else they run along y. In two a plane
 * that is turned may be that of the probe, or of the contacts alone. */
static void read_axes(struct reading *reading)
{
    const json_t *planes = find_list(reading, "contact_plane_axes");
    for (size_t a = 0; a < 3; a++) {
        reading->axes[0][a] = a == 0;
        reading->axes[1][a] = a == 1;
    }
    for (size_t i = 0; i < reading->count && planes && job_ok(reading->job); i++) {
        const json_t *plane = json_array_get(planes, i);
        double axes[2][3];
        bool whole = json_array_size(plane) == 2 && read_numbers(axes[0], json_array_get(plane, 0), reading->dims) &&
                     read_numbers(axes[1], json_array_get(plane, 1), reading->dims) &&
                     vec3_normalise(axes[0], axes[0]) && vec3_normalise(axes[1], axes[1]) &&
                     fabs(vec3_dot(axes[0], axes[1])) <= 1 - PARALLEL;
        if (!whole) {
            job_bad(reading->job, "contact_plane_axes[%zu]: two axes at right angles are needed", i);
        } else if (i == 0 && reading->dims == 3) {
            memcpy(reading->axes, axes, sizeof axes);
        } else if (vec3_dot(axes[1], reading->axes[1]) < PARALLEL) {
            job_bad(reading->job,
                    "contact_plane_axes[%zu]: the second axis is not %s, so that it is not known which way the "
                    "shank runs; where contacts are turned on a shank along y, leave this key out",
                    i, reading->dims == 3 ? "that of the first contact" : "y");
        }
    }
    vec3_cross(reading->axes[2], reading->axes[0], reading->axes[1]);
}

/* Coordinates across, along and off the plane of the shanks. */
static void to_plane(double out[3], const struct reading *reading, const double point[3])
{
    const double at[3] = {vec3_dot(reading->axes[0], point), vec3_dot(reading->axes[1], point),
                          vec3_dot(reading->axes[2], point)};
    memcpy(out, at, sizeof at);
}

/* Entry `i` of a list of texts that tables can hold; "" where there is no list. */
static const char *read_text(const struct reading *reading, const char *key, const json_t *list, size_t i)
{
    const char *text = list ? json_string_value(json_array_get(list, i)) : "";
    bool is_plain = text && strlen(text) <= POSE_ID_LIMIT - NAME_SIZE;
    for (size_t k = 0; is_plain && text[k]; k++) {
        is_plain = (unsigned char)text[k] >= 0x20 && text[k] != 0x7f;
    }
    if (!is_plain) {
        job_bad(reading->job, "%s[%zu]: a text of up to %d bytes without control characters is needed", key, i,
                POSE_ID_LIMIT - NAME_SIZE);
    }
    return is_plain ? text : "";
}

/* NULL for a list whose texts are all empty. */
static const json_t *unless_empty(const json_t *list)
{
    bool is_empty = true;
    for (size_t i = 0; i < json_array_size(list) && is_empty; i++) {
        const char *text = json_string_value(json_array_get(list, i));
        is_empty = text && !*text;
    }
    return is_empty ? NULL : list;
}

/* "e3"; of several probes "probe2:e3". */
static void name_contact(conus_probe_contact *contact, const struct reading *reading, const json_t *ids,
                         const json_t *shanks, size_t i)
{
    struct job *job = reading->job;
    const char *id = read_text(reading, "contact_ids", ids, i);
    const char *shank = read_text(reading, "shank_ids", shanks, i);
    bool is_alone = reading->out->probe_count == 1;
    if (ids && !*id) {
        job_bad(job, "contact_ids[%zu]: empty, but others are not", i);
    }
    contact->id = job_format(job, "%s%s%s", is_alone ? "" : contact->probe, is_alone ? "" : ":",
                             ids ? id : job_format(job, "%zu", i));
    contact->shank = job_copy(job, text_from(shank));
}

static int64_t read_channel(const struct reading *reading, const json_t *channels, size_t i)
{
    const json_t *entry = json_array_get(channels, i);
    const int64_t channel = channels ? json_integer_value(entry) : -2;
    if (channels && (!json_is_integer(entry) || channel < -1 || channel > CHANNEL_LIMIT)) {
        job_bad(reading->job, "device_channel_indices[%zu]: a whole number from -1 to %d is needed", i, CHANNEL_LIMIT);
    }
    return channel;
}

static void read_contacts(struct reading *reading, const json_t *positions)
{
    const json_t *ids = find_list(reading, "contact_ids");
    const json_t *shanks = find_list(reading, "shank_ids");
    const json_t *channels = find_list(reading, "device_channel_indices");
    ids = unless_empty(ids);
    for (size_t i = 0; i < reading->count && job_ok(reading->job); i++) {
        conus_probe_contact *contact = &reading->out->contacts[reading->out->count++];
        *contact = (conus_probe_contact){.probe = reading->out->probes[reading->index].name, .index = reading->index};
        read_position(contact->position, reading, "contact_positions", positions, i);
        to_plane(contact->offset, reading, contact->position);
        name_contact(contact, reading, ids, shanks, i);
        contact->channel = read_channel(reading, channels, i);
    }
}

static bool is_level(const double *points, size_t count, size_t i, double height)
{
    return points[3 * (i % count) + 1] <= height;
}

/* The lowest point of a closed line, in the middle of an edge that is as low; of several, that of the least x. */
static bool find_lowest(double tip[3], const double *points, size_t count)
{
    double low = INFINITY;
    double high = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        low = fmin(low, points[3 * i + 1]);
        high = fmax(high, points[3 * i + 1]);
    }
    double height = low + LEVEL * (high - low);
    tip[0] = INFINITY;
    for (size_t i = 0; i < count; i++) {
        size_t last = i;
        if (!is_level(points, count, i, height) || is_level(points, count, i + count - 1, height)) {
            continue;
        }
        while (last < i + count && is_level(points, count, last + 1, height)) {
            last++;
        }
        double middle[3];
        vec3_add_scaled(middle, points + 3 * i, 1, points + 3 * (last % count));
        vec3_scale(middle, middle, 0.5);
        if (middle[0] < tip[0]) {
            memcpy(tip, middle, sizeof middle);
        }
    }
    return isfinite(tip[0]);
}

static void tip_of_contour(double tip[3], const struct reading *reading, const json_t *contour)
{
    struct job *job = reading->job;
    size_t count = json_array_size(contour);
    if (!count) {
        job_bad(job, "probe_planar_contour: there is none, so that the tip is not known; --probe-tip says how many mm "
                     "it is from the lowest contact");
    }
    double *points = job_array(job, &count, 3 * sizeof *points);
    for (size_t i = 0; i < count && job_ok(job); i++) {
        read_position(points + 3 * i, reading, "probe_planar_contour", contour, i);
        to_plane(points + 3 * i, reading, points + 3 * i);
    }
    if (job_ok(job) && !find_lowest(tip, points, count)) {
        job_bad(job, "probe_planar_contour: has no lowest point");
    }
}

/* Below the lowest contact, of several the one of the least x, in the middle of its shank. */
static void tip_of_contacts(double tip[3], const struct reading *reading)
{
    const conus_probe_contact *contacts = reading->out->contacts + reading->first;
    const conus_probe_contact *lowest = contacts;
    double ends[2] = {INFINITY, -INFINITY};
    for (size_t i = 1; i < reading->count; i++) {
        double above = contacts[i].offset[1] - lowest->offset[1];
        lowest = above < 0 || (above == 0 && contacts[i].offset[0] < lowest->offset[0]) ? &contacts[i] : lowest;
    }
    for (size_t i = 0; i < reading->count; i++) {
        if (strcmp(contacts[i].shank, lowest->shank) == 0) {
            ends[0] = fmin(ends[0], contacts[i].offset[0]);
            ends[1] = fmax(ends[1], contacts[i].offset[0]);
        }
    }
    tip[0] = (ends[0] + ends[1]) / 2;
    tip[1] = lowest->offset[1] - 1000 * reading->tip;
    tip[2] = lowest->offset[2];
}

/* Lets the contacts count from the tip, in the device's frame; no contact is below it. */
static void find_tip(struct reading *reading)
{
    double tip[3] = {0};
    if (reading->tip > 0) {
        tip_of_contacts(tip, reading);
    } else {
        tip_of_contour(tip, reading, value_of(reading->json, "probe_planar_contour"));
    }
    for (size_t i = 0; i < reading->count && job_ok(reading->job); i++) {
        conus_probe_contact *contact = &reading->out->contacts[reading->first + i];
        const double *at = contact->offset;
        if (at[1] < tip[1]) {
            job_bad(reading->job, "contact \"%s\" lies %g um below the tip, the lowest point of probe_planar_contour",
                    contact->id, tip[1] - at[1]);
        }
        const double offset[3] = {(at[0] - tip[0]) / 1000, (tip[2] - at[2]) / 1000, (at[1] - tip[1]) / 1000};
        memcpy(contact->offset, offset, sizeof offset);
        contact->position[2] = reading->dims == 3 ? contact->position[2] : NAN;
    }
    double *out = reading->out->probes[reading->index].tip;
    for (size_t a = 0; a < 3; a++) {
        out[a] = tip[0] * reading->axes[0][a] + tip[1] * reading->axes[1][a] + tip[2] * reading->axes[2][a];
    }
    out[2] = reading->dims == 3 ? out[2] : NAN;
}

static void read_probe(struct reading *reading)
{
    conus_probe *out = reading->out;
    const json_t *positions = value_of(reading->json, "contact_positions");
    reading->count = json_array_size(positions);
    reading->first = out->count;
    snprintf(out->probes[reading->index].name, sizeof out->probes->name, "probe%zu", reading->index + 1);
    if (!reading->count) {
        job_bad(reading->job, "contact_positions: a list of at least one contact is needed");
    }
    read_frame(reading);
    if (job_ok(reading->job)) {
        read_axes(reading);
        read_contacts(reading, positions);
    }
    if (job_ok(reading->job)) {
        find_tip(reading);
    }
}

/* Whether the key is there already; adds it. */
static bool is_again(struct job *job, struct name_set *keys, const char *key)
{
    return job_ok(job) && (name_set_find(keys, key) || !JOB_CALL(job, name_set_add(keys, key, 0)));
}

/* Contacts have names of their own, and those of a probe that are wired have channels of their own. */
static void check_unique(conus_probe *probe)
{
    struct job *job = &probe->job;
    const struct job_mark mark = job_mark(job);
    struct name_set ids = {0};
    struct name_set channels = {0};
    for (size_t i = 0; i < probe->count && job_ok(job); i++) {
        const conus_probe_contact *contact = &probe->contacts[i];
        const char *key = job_format(job, "%zu:%lld", contact->index, (long long)contact->channel);
        if (is_again(job, &ids, contact->id)) {
            job_bad(job, "contact_ids: two contacts are called \"%s\"", contact->id);
        }
        if (contact->channel >= 0 && is_again(job, &channels, key)) {
            job_bad(job, "device_channel_indices: two contacts of %s have the channel %lld", contact->probe,
                    (long long)contact->channel);
        }
    }
    name_set_finish(&ids);
    name_set_finish(&channels);
    job_release(job, mark);
}

/* A probe without contacts, and room for these; NULL without memory. */
static conus_probe *new_probe(size_t probes, size_t contacts, uint64_t max_memory)
{
    conus_probe *probe = memory_zeroed(1, sizeof *probe);
    if (probe && JOB_CALL(&probe->job, pose_check_count(contacts, max_memory))) {
        probe->probe_count = probes;
        probe->probes = job_zeroed(&probe->job, probes, sizeof *probe->probes);
        probe->contacts = job_zeroed(&probe->job, contacts, sizeof *probe->contacts);
    }
    return probe;
}

static conus_status hand_over(conus_probe **out, conus_probe *probe)
{
    if (!probe || !job_ok(&probe->job)) {
        conus_status status = probe ? fail(probe->job.status, "%s", probe->job.message) : CONUS_ERROR_MEMORY;
        conus_probe_destroy(probe);
        return status;
    }
    *out = probe;
    return CONUS_OK;
}

static conus_status read_root(conus_probe **out, const json_t *root, const conus_probe_options *options)
{
    const json_t *probes = value_of(root, "probes");
    size_t count = json_array_size(probes);
    size_t contacts = 0;
    if (!text_equal(json_text_of(value_of(root, "specification")), "probeinterface")) {
        return fail(CONUS_ERROR_DATA,
                    "specification: \"probeinterface\" is needed: not a file of ProbeInterface, nor a "
                    ".ap.meta, .imro or settings.xml of a recording");
    }
    if (!count || count > PROBE_LIMIT) {
        return fail(CONUS_ERROR_DATA, "probes: found %zu, allowed are 1 to %d", count, PROBE_LIMIT);
    }
    for (size_t i = 0; i < count; i++) {
        contacts += json_array_size(value_of(json_array_get(probes, i), "contact_positions"));
    }
    conus_probe *probe = new_probe(count, contacts, options->max_memory);
    for (size_t i = 0; probe && i < count && job_ok(&probe->job); i++) {
        struct reading reading = {
            .job = &probe->job, .out = probe, .json = json_array_get(probes, i), .index = i, .tip = options->tip};
        const size_t mark = job_in(&probe->job, "probes", i);
        read_probe(&reading);
        job_out(&probe->job, mark);
    }
    if (probe && job_ok(&probe->job)) {
        check_unique(probe);
    }
    return hand_over(out, probe);
}

conus_status probe_parse(conus_probe **out, struct text text, const conus_probe_options *options)
{
    options = options_of(conus_probe_options, options);
    if (!(options->tip >= 0 && options->tip <= 1000)) {
        return fail(CONUS_ERROR_ARGUMENT, "tip: %g mm, allowed are 0 to 1000", options->tip);
    }
    json_t *root = NULL;
    struct buffer json = {0}; /* of a recording */
    conus_probe_options own = *options;
    conus_status status = CONUS_OK;
    if (probe_recording_is(text)) {
        status = probe_recording_write(&json, text, own.tip);
        own.tip = 0; /* its contour has it */
        text = (struct text){json.data, json.size};
    }
    bool is_object = !status && text_starts(text_trim(text), "{"); /* else no root is found */
    status = is_object ? json_text_load(&root, text) : status;
    status = status ? status : read_root(out, root, &own);
    json_decref(root);
    buffer_finish(&json);
    return status;
}

conus_status conus_probe_load(conus_probe **out, const char *path, const conus_probe_options *options)
{
    options = options_of(conus_probe_options, options);
    struct bytes bytes = {0};
    const conus_pose_options limit = {.max_memory = options->max_memory};
    conus_status status = file_read_allowed(&bytes, path, pose_memory(&limit));
    if (status) {
        return status;
    }
    status = probe_parse(out, text_from_bytes(bytes.data, bytes.size), options);
    bytes_finish(&bytes);
    return status ? fail_in(status, path) : CONUS_OK;
}

void conus_probe_destroy(conus_probe *probe)
{
    if (probe) {
        job_end(&probe->job);
        memory_free(probe);
    }
}

size_t conus_probe_count(const conus_probe *probe)
{
    return probe ? probe->probe_count : 0;
}

size_t conus_probe_contact_count(const conus_probe *probe)
{
    return probe ? probe->count : 0;
}

const conus_probe_contact *conus_probe_at(const conus_probe *probe, size_t index)
{
    return probe && index < probe->count ? &probe->contacts[index] : NULL;
}

void conus_probe_tip(double out[3], const conus_probe *probe, size_t index)
{
    if (probe && index < probe->probe_count) {
        memcpy(out, probe->probes[index].tip, sizeof probe->probes[index].tip);
    }
}

/* A contact of probe `index` of `out` is like this one. */
static void repeat_contact(conus_probe *out, size_t index, const conus_probe_contact *contact)
{
    conus_probe_contact *copy = &out->contacts[out->count++];
    const char *name = out->probes[index].name;
    *copy = *contact;
    copy->index = index;
    copy->probe = name;
    copy->id = job_format(&out->job, "%s:%s", name, contact->id);
    copy->shank = job_copy(&out->job, text_from(contact->shank));
    if (strlen(copy->id) > POSE_ID_LIMIT) {
        job_fail(&out->job, CONUS_ERROR_ARGUMENT,
                 "names: \"%.40s...\" is too long: with the name of a contact 255 bytes are allowed", name);
    }
}

conus_status conus_probe_repeat(conus_probe **out, const conus_probe *probe, const char *const *names, size_t count)
{
    if (probe->probe_count != 1 || !count || count > PROBE_LIMIT) {
        return fail(CONUS_ERROR_ARGUMENT, "probes: %zu of a file of %zu, allowed are 1 to %d of a file of one", count,
                    probe->probe_count, PROBE_LIMIT);
    }
    conus_probe *made = new_probe(count, count * probe->count, 0);
    for (size_t i = 0; made && i < count && job_ok(&made->job); i++) {
        made->probes[i] = probe->probes[0];
        snprintf(made->probes[i].name, sizeof made->probes->name, "%s", names[i]);
        for (size_t k = 0; k < probe->count && job_ok(&made->job); k++) {
            repeat_contact(made, i, &probe->contacts[k]);
        }
    }
    if (made && job_ok(&made->job)) {
        check_unique(made);
    }
    conus_status status = hand_over(out, made);
    return status == CONUS_ERROR_DATA ? CONUS_ERROR_ARGUMENT : status; /* by names */
}

conus_status conus_probe_place(conus_pose_list **out, const conus_probe *probe, const conus_pose *poses, size_t count,
                               double roll)
{
    if (count != probe->probe_count) {
        return fail(CONUS_ERROR_ARGUMENT, "poses: found %zu, wanted are %zu: each probe of the file has one of its own",
                    count, probe->probe_count);
    }
    struct job job = {0};
    conus_pose_list *list = memory_zeroed(1, sizeof *list);
    conus_pose *turned = job_array(&job, &count, sizeof *turned);
    (void)job_need(&job, list);
    for (size_t i = 0; i < count; i++) {
        turned[i] = poses[i];
        (void)JOB_CALL(&job, pose_roll(&turned[i], radians_from_degrees(roll)));
    }
    for (size_t i = 0; i < probe->count && job_ok(&job); i++) {
        const conus_probe_contact *contact = &probe->contacts[i];
        double point[3];
        conus_pose_row row = pose_row_at(i + 1);
        row.is_point = true;
        mat4_point(point, turned[contact->index].world_from_device, contact->offset);
        (void)(JOB_CALL(&job, pose_of_point(&row.pose, point)) &&
               JOB_CALL(&job, pose_list_add(list, &row, text_from(contact->id), NULL)));
    }
    conus_status status = job_close(&job, NULL, NULL);
    if (status) {
        conus_pose_list_destroy(list);
        return status;
    }
    *out = list;
    return CONUS_OK;
}
