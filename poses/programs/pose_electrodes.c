/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses BIDS electrodes, and finds the direction of each contact along its shaft. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/pose_row.h"

#include <stdlib.h>

/* Columns that are read; the others are for other programs. */
enum column { NAME, X, Y, Z, GROUP, PROBE_NAME, COLUMNS };

static const char *const names[COLUMNS] = {"name", "x", "y", "z", "group", "probe_name"};

static const size_t NO_COLUMN = SIZE_MAX;

struct contact {
    struct text name;
    struct text shaft; /* the column group, or the name without the number at its end */
    uint64_t number;   /* at the end of the name, or else of the row */
    double position[3];
    conus_status bad;
    const char *message; /* of bad; owned */
    size_t line;
    size_t next; /* on the same shaft; itself if it is the last */
    size_t previous;
};

struct reading {
    const conus_pose_options *options;
    double scale; /* mm per unit */
    bool lps;
    size_t at[COLUMNS]; /* field of each column */
    size_t field_count;
    struct contact *contacts;
    size_t count, capacity;
};

static bool is_absent(struct text field)
{
    return !field.size || text_equal(field, "n/a");
}

/* Sets *twice where a column that is read is there twice. */
static void read_header(struct reading *reading, struct text line, bool *twice)
{
    struct text field;
    *twice = false;
    for (int i = 0; i < COLUMNS; i++) {
        reading->at[i] = NO_COLUMN;
    }
    reading->field_count = 0;
    for (bool more = true; text_field(&line, '\t', &more, &field); reading->field_count++) {
        for (int i = 0; i < COLUMNS; i++) {
            if (text_equal(text_trim(field), names[i])) {
                *twice = *twice || reading->at[i] != NO_COLUMN;
                reading->at[i] = reading->field_count;
            }
        }
    }
}

bool pose_electrodes_header(struct text line)
{
    struct reading reading;
    bool twice;
    read_header(&reading, line, &twice);
    bool all = true;
    for (int i = NAME; i <= Z; i++) {
        all = all && reading.at[i] != NO_COLUMN;
    }
    /* A column that says where a device points: the table is one of poses, with a column that it does not know. */
    static const char *const directions[] = {"tx", "dx", "qw", "m00"};
    struct text field;
    for (bool more = true; text_field(&line, '\t', &more, &field);) {
        for (size_t i = 0; i < sizeof directions / sizeof directions[0]; i++) {
            all = all && !text_equal_ignoring_case(text_trim(field), directions[i]);
        }
    }
    return all;
}

static conus_status split_row(struct text fields[COLUMNS], const struct reading *reading, struct text line)
{
    struct text field;
    size_t index = 0;
    for (int i = 0; i < COLUMNS; i++) {
        fields[i] = (struct text){"", 0};
    }
    for (bool more = true; text_field(&line, '\t', &more, &field); index++) {
        for (int i = 0; i < COLUMNS; i++) {
            fields[i] = reading->at[i] == index ? text_trim(field) : fields[i];
        }
    }
    return index == reading->field_count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%zu fields, the header has %zu", index, reading->field_count);
}

static conus_status read_position(double out[3], const struct text *fields)
{
    for (int i = 0; i < 3; i++) {
        struct text field = fields[X + i];
        if (is_absent(field)) {
            return fail(CONUS_ERROR_DATA, "%s: not known (n/a)", names[X + i]);
        }
        if (!text_to_double(field, &out[i]) || !isfinite(out[i])) {
            return pose_no_number(names[X + i], field);
        }
    }
    return CONUS_OK;
}

static conus_status read_contact(struct reading *reading, struct text line, size_t number)
{
    if (!memory_reserve(&reading->contacts, &reading->capacity, reading->count + 1, sizeof *reading->contacts)) {
        return CONUS_ERROR_MEMORY;
    }
    struct text fields[COLUMNS];
    struct contact contact = {.line = number, .next = reading->count, .previous = reading->count};
    contact.bad = split_row(fields, reading, line);
    contact.name = fields[NAME];
    contact.bad = contact.bad ? contact.bad : read_position(contact.position, fields);
    if (contact.bad) {
        contact.message = memory_text(conus_message(), text_from(conus_message()).size);
        if (!contact.message) {
            return CONUS_ERROR_MEMORY;
        }
    }
    vec3_scale(contact.position, contact.position, reading->scale);
    if (reading->lps) {
        pose_flip_point(contact.position);
    }
    struct text stem = contact.name; /* "LA12" is contact 12 of LA */
    while (stem.size && stem.data[stem.size - 1] >= '0' && stem.data[stem.size - 1] <= '9') {
        stem.size--;
    }
    struct text digits = {contact.name.data + stem.size, contact.name.size - stem.size};
    contact.shaft = is_absent(fields[GROUP]) ? stem : fields[GROUP];
    if (!text_to_uint(digits, UINT64_MAX, &contact.number)) {
        contact.number = reading->count + 1;
    }
    reading->contacts[reading->count++] = contact;
    return CONUS_OK;
}

static conus_status read_table(struct reading *reading, struct text text)
{
    struct text line;
    bool begun = false;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        if (!text_trim(line).size) {
            continue;
        }
        if (begun) {
            status = read_contact(reading, line, number);
        } else if (pose_electrodes_header(line)) {
            bool twice;
            read_header(reading, line, &twice);
            begun = true;
            status = twice ? fail(CONUS_ERROR_DATA, "header: a column name, x, y, z or group twice") : CONUS_OK;
        } else {
            status = fail(CONUS_ERROR_DATA, "header: the columns name, x, y and z, separated by tabs, are needed");
        }
    }
    return status;
}

/* A contact in the order of the shafts. */
struct place {
    struct contact *contact;
};

/* By shaft, then outward. */
static int compare_contacts(const void *left, const void *right)
{
    const struct contact *a = ((const struct place *)left)->contact;
    const struct contact *b = ((const struct place *)right)->contact;
    int order = text_compare(a->shaft, b->shaft);
    order = order ? order : compare_unsigned(a->number, b->number);
    return order ? order : compare_unsigned(a->line, b->line);
}

/* Each contact's neighbours on its shaft, of those that have positions. */
static conus_status find_neighbours(struct reading *reading)
{
    struct place *sorted = memory_raw(reading->count, sizeof *sorted);
    if (!sorted) {
        return CONUS_ERROR_MEMORY;
    }
    size_t count = 0;
    for (size_t i = 0; i < reading->count; i++) {
        if (!reading->contacts[i].bad) {
            sorted[count++].contact = &reading->contacts[i];
        }
    }
    qsort(sorted, count, sizeof *sorted, compare_contacts);
    for (size_t i = 1; i < count; i++) {
        struct contact *inner = sorted[i - 1].contact;
        struct contact *outer = sorted[i].contact;
        if (text_compare(inner->shaft, outer->shaft) == 0) {
            inner->next = (size_t)(outer - reading->contacts);
            outer->previous = (size_t)(inner - reading->contacts);
        }
    }
    memory_free(sorted);
    return CONUS_OK;
}

/* At the contact, pointing at the next one outward; the last points as its neighbour does. */
static conus_status pose_along_shaft(conus_pose *out, const struct reading *reading, size_t index)
{
    const struct contact *contact = &reading->contacts[index];
    const struct contact *from = contact->next == index ? &reading->contacts[contact->previous] : contact;
    const struct contact *to = &reading->contacts[from == contact ? contact->next : index];
    double direction[3];
    if (from == to) {
        return fail(CONUS_ERROR_DATA, "the only contact of its shaft \"%.*s\": no other gives it a direction",
                    pose_quote(contact->shaft), contact->shaft.data);
    }
    vec3_sub(direction, to->position, from->position);
    return conus_pose_along(out, contact->position, direction, NULL);
}

conus_status pose_electrodes_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {.options = options, .scale = list->space.scale > 0 ? list->space.scale : 1};
    bool is_named = list->space.brain != POSE_BRAIN_UNKNOWN; /* and by that RAS */
    reading.lps = options->space == CONUS_SPACE_LPS && !is_named;
    if (options->axis != CONUS_AXIS_OF_FORMAT) {
        return fail(CONUS_ERROR_DATA, "contacts have no axes, so that no axis (%s) is to be chosen",
                    pose_axis_name(options->axis));
    }
    conus_status status = pose_note_space(&list->notes, options, reading.lps);
    status = status ? status : read_table(&reading, text);
    if (!status && reading.at[PROBE_NAME] != NO_COLUMN && !list->coordsystem) {
        status =
            fail(CONUS_ERROR_DATA, "column probe_name: a table of BEP032 without a *_coordsystem.json, whose x, y, z "
                                   "are micrometres on the probe; --probe answers at the contacts of a probe");
    }
    status = status || !options->along_shafts ? status : find_neighbours(&reading);
    for (size_t i = 0; !status && i < reading.count; i++) {
        const struct contact *contact = &reading.contacts[i];
        conus_pose_row row = pose_row_at(contact->line);
        row.is_point = !options->along_shafts;
        conus_status bad = contact->bad   ? CONUS_OK
                           : row.is_point ? pose_of_point(&row.pose, contact->position)
                                          : pose_along_shaft(&row.pose, &reading, i);
        status = pose_list_add(list, &row, contact->name, bad ? conus_message() : contact->message);
    }
    for (size_t i = 0; i < reading.count; i++) {
        memory_free((char *)reading.contacts[i].message);
    }
    memory_free(reading.contacts);
    return status;
}
