/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses BIDS electrodes, and finds the direction of each contact along its shaft. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/pose_columns.h"
#include "poses/rows/pose_row.h"

/* Columns that are read; the others are for other programs. */
enum column { NAME, X, Y, Z, GROUP, PROBE_NAME, COLUMNS };

static const char *const names[COLUMNS] = {"name", "x", "y", "z", "group", "probe_name"};

static const struct pose_columns table_columns = {.names = names, .count = COLUMNS, .quotes_are_plain = true};

struct contact {
    struct text name;
    struct text shaft; /* the column group, or the name without the number at its end */
    uint64_t number;   /* at the end of the name, or else of the row */
    double position[3];
    char *error; /* why it is no pose; owned, NULL = it is a pose */
    size_t line;
    size_t next; /* on the same shaft; itself if it is the last */
    size_t previous;
};

struct reading {
    const conus_pose_options *options;
    double scale; /* mm per unit */
    bool lps;
    struct pose_columns columns;
    struct contact *contacts;
    size_t count, capacity;
};

static bool is_absent(struct text field)
{
    return !field.size || text_equal(field, "n/a");
}

bool pose_electrodes_header(struct text line)
{
    struct pose_columns columns = table_columns;
    (void)pose_columns_find(&columns, line); /* a column that is there twice is an error of such a table */
    bool all = true;
    for (size_t i = NAME; i <= Z; i++) {
        all = all && pose_columns_has(&columns, i);
    }
    /* A column that says where a device points: the table is one of poses, with a column that it does not know. */
    struct text field;
    for (bool more = true; text_field(&line, '\t', &more, &field);) {
        all = all && !text_is_one_of(text_trim(field), "tx/dx/qw/m00", false);
    }
    return all;
}

static conus_status read_contact(struct reading *reading, struct text line, size_t number)
{
    if (!memory_reserve(&reading->contacts, &reading->capacity, reading->count + 1, sizeof *reading->contacts)) {
        return CONUS_ERROR_MEMORY;
    }
    struct text fields[COLUMNS];
    struct contact contact = {.line = number, .next = reading->count, .previous = reading->count};
    conus_status bad = pose_columns_split(fields, &reading->columns, line);
    contact.name = fields[NAME];
    for (size_t i = X; !bad && i <= Z; i++) {
        bad = is_absent(fields[i]) ? fail(CONUS_ERROR_DATA, "%s: not known (n/a)", names[i])
                                   : pose_columns_number(&contact.position[i - X], &reading->columns, fields, i);
    }
    contact.error = bad ? memory_text(conus_message(), text_from(conus_message()).size) : NULL;
    if (bad && !contact.error) {
        return CONUS_ERROR_MEMORY;
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
            begun = true;
            status = pose_columns_find(&reading->columns, line)
                         ? fail(CONUS_ERROR_DATA, "header: a column name, x, y, z or group twice")
                         : CONUS_OK;
        } else {
            status = fail(CONUS_ERROR_DATA, "header: the columns name, x, y and z, separated by tabs, are needed");
        }
    }
    return status;
}

/* By shaft, then outward. */
static int compare_contacts(const void *left, const void *right)
{
    const struct contact *a = *(struct contact *const *)left;
    const struct contact *b = *(struct contact *const *)right;
    int order = text_compare(a->shaft, b->shaft);
    order = order ? order : compare_unsigned(a->number, b->number);
    return order ? order : compare_unsigned(a->line, b->line);
}

/* Finds each contact's neighbours on its shaft, among contacts with positions. */
static conus_status find_neighbours(struct reading *reading)
{
    struct contact **sorted = memory_raw(reading->count, sizeof(struct contact *));
    if (!sorted) {
        return CONUS_ERROR_MEMORY;
    }
    size_t count = 0;
    for (size_t i = 0; i < reading->count; i++) {
        if (!reading->contacts[i].error) {
            sorted[count++] = &reading->contacts[i];
        }
    }
    order_sort(sorted, count, sizeof(struct contact *), compare_contacts);
    for (size_t i = 1; i < count; i++) {
        struct contact *inner = sorted[i - 1];
        struct contact *outer = sorted[i];
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
                    POSE_QUOTE(contact->shaft));
    }
    vec3_sub(direction, to->position, from->position);
    return conus_pose_along(out, contact->position, direction, NULL);
}

conus_status pose_electrodes_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {
        .options = options, .scale = list->space.scale > 0 ? list->space.scale : 1, .columns = table_columns};
    bool is_named = list->space.brain != POSE_BRAIN_UNKNOWN && list->space.brain != POSE_BRAIN_OTHER; /* it is RAS */
    reading.lps = options->space == CONUS_SPACE_LPS && !is_named;
    if (options->axis != CONUS_AXIS_OF_FORMAT) {
        return fail(CONUS_ERROR_DATA, "contacts have no axes, so that no axis (%s) is to be chosen",
                    pose_axis_name(options->axis));
    }
    conus_status status = pose_note_space(&list->notes, options, reading.lps);
    status = status ? status : read_table(&reading, text);
    if (!status && pose_columns_has(&reading.columns, PROBE_NAME) && !list->coordsystem) {
        status =
            fail(CONUS_ERROR_DATA, "column probe_name: a table of BEP032 without a *_coordsystem.json, whose x, y, z "
                                   "are micrometres on the probe; a probe is answered from its ProbeInterface file");
    }
    status = status || !options->along_shafts ? status : find_neighbours(&reading);
    for (size_t i = 0; !status && i < reading.count; i++) {
        const struct contact *contact = &reading.contacts[i];
        conus_pose_row row = pose_row_at(contact->line);
        row.is_point = !options->along_shafts;
        conus_status bad = contact->error ? CONUS_OK
                           : row.is_point ? pose_of_point(&row.pose, contact->position)
                                          : pose_along_shaft(&row.pose, &reading, i);
        status = pose_list_add(list, &row, contact->name, bad ? conus_message() : contact->error);
    }
    for (size_t i = 0; i < reading.count; i++) {
        memory_free(reading.contacts[i].error);
    }
    memory_free(reading.contacts);
    return status;
}
