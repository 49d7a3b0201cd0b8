/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses BIDS electrodes, and finds the direction of each contact along its shaft. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/columns.h"
#include "poses/rows/named_cells.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>

/* Columns that are read; and those that say where a device points: such a table is one of poses. */
enum column { NAME, GROUP = NAME + 4, PROBE_NAME, DIRECTIONS, COLUMNS = DIRECTIONS + 4 };

static const char *const names[COLUMNS] = {"name",       "x",     "y",     "z",     "group",
                                           "probe_name", "tx/TX", "dx/DX", "qw/QW", "m00/M00"};

struct contact {
    conus_pose_row row;
    struct text name;
    struct text shaft; /* the column group, or the name without the number at its end */
    uint64_t number;   /* at the end of the name, or else of the row */
    char *error;       /* why it is no pose; owned, NULL = it is a pose */
    size_t next;       /* on the same shaft; itself if it is the last */
    size_t previous;
};

struct reading {
    const conus_pose_options *options;
    struct columns columns;
    struct named_cells header;
    struct contact *contacts;
    size_t count, capacity;
    size_t absent, first_absent; /* rows without a position, and the line of the first */
};

static bool find_columns(struct named_cells *out, struct text line)
{
    bool all = true;
    *out = (struct named_cells){.names = names, .count = COLUMNS, .table.quotes_are_plain = true};
    (void)named_cells_find(out, line); /* a column that is there twice is an error of such a table */
    for (size_t i = NAME; i < COLUMNS; i++) {
        all = all && (i == GROUP || i == PROBE_NAME || named_cells_has(out, i) == (i < GROUP));
    }
    return all;
}

bool pose_electrodes_header(struct text line)
{
    struct named_cells header;
    return find_columns(&header, line);
}

static conus_status add_contact(struct reading *reading, struct text line, size_t number)
{
    if (!memory_reserve(&reading->contacts, &reading->capacity, reading->count + 1, sizeof *reading->contacts)) {
        return CONUS_ERROR_MEMORY;
    }
    struct table_line cells;
    struct pose_name name = {.text = {"", 0}};
    struct contact contact = {.row = pose_row_at(number), .next = reading->count, .previous = reading->count};
    conus_status bad = CONUS_OK;
    enum columns_line kind = columns_read(&contact.row, &name, &bad, &reading->columns, line, number, reading->options);
    conus_status late =
        kind == LINE_ROW && !bad ? CONUS_OK : columns_hear_late(&reading->columns, line, number, reading->options);
    if (late || kind == LINE_NOTHING || kind == LINE_AGAIN || !table_split(&cells, &reading->columns.table, line)) {
        return late;
    }
    if (kind == LINE_ABSENT && !reading->options->all_rows) {
        reading->first_absent = reading->absent++ ? reading->first_absent : number;
        return CONUS_OK;
    }
    if (kind != LINE_ROW) { /* an answer has as many rows as the table */
        bad = fail(CONUS_ERROR_DATA, kind == LINE_ABSENT ? "x: not known (n/a)" : "no number in it");
    }
    for (size_t i = 0; i < cells.count && i < reading->columns.count; i++) {
        contact.name = reading->columns.role_of[i] == ROLE_NAME ? cells.cells[i] : contact.name;
    }
    struct text group =
        reading->header.at[GROUP] < cells.count ? cells.cells[reading->header.at[GROUP]] : text_from("");
    contact.error = bad ? memory_text(conus_message(), text_from(conus_message()).size) : NULL;
    if (bad && !contact.error) {
        return CONUS_ERROR_MEMORY;
    }
    struct text stem = contact.name; /* "LA12" is contact 12 of LA */
    while (stem.size && stem.data[stem.size - 1] >= '0' && stem.data[stem.size - 1] <= '9') {
        stem.size--;
    }
    struct text digits = {contact.name.size ? contact.name.data + stem.size : "", contact.name.size - stem.size};
    contact.shaft = columns_is_absent(group) ? stem : group;
    if (!text_to_uint(digits, UINT64_MAX, &contact.number)) {
        contact.number = reading->count + 1;
    }
    reading->contacts[reading->count++] = contact;
    return CONUS_OK;
}

static conus_status read_table(struct reading *reading, conus_pose_list *list, struct text text)
{
    bool is_short = false;
    struct text line = {"", 0};
    struct text rest = text;
    while (!text_trim(line).size && text_line(&rest, &line)) {
    }
    if (!find_columns(&reading->header, line)) {
        return fail(CONUS_ERROR_DATA, "header: the columns name, x, y and z, separated by tabs, are needed");
    }
    size_t size = text.size < TABLE_HEAD ? text.size : TABLE_HEAD;
    while (size < text.size && size && text.data[size - 1] != '\n') { /* whole lines */
        size--;
    }
    reading->columns.is_bids = true;
    conus_status status = columns_plan(&reading->columns, &is_short, &list->notes,
                                       (struct text){text.data, size ? size : text.size}, reading->options);
    if (!status && reading->columns.pairs) {
        return pairs_parse(list, &reading->columns, text, reading->options);
    }
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        status = add_contact(reading, line, number);
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
    return order ? order : compare_unsigned(a->row.line, b->row.line);
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
    vec3_sub(direction, to->row.pose.world_from_device + 12, from->row.pose.world_from_device + 12);
    return conus_pose_along(out, contact->row.pose.world_from_device + 12, direction, NULL);
}

conus_status pose_electrodes_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    bool is_named = list->space.brain != POSE_BRAIN_UNKNOWN && list->space.brain != POSE_BRAIN_OTHER; /* it is RAS */
    const conus_frame ras = {.space = CONUS_SPACE_RAS};
    conus_pose_options own = *options;
    bool is_ras = is_named || options->space != CONUS_SPACE_LPS;
    own.space = is_ras ? CONUS_SPACE_RAS : options->space;
    own.frame = is_ras ? &ras : options->frame;
    own.axis = CONUS_AXIS_OF_FORMAT;
    own.unit = list->space.scale > 0 ? list->space.scale : options->unit;
    own.any_space = options->any_space || list->coordsystem; /* which says what they are */
    own.format = CONUS_POSE_FORMAT_AUTO;
    struct reading reading = {.options = &own};
    conus_status status = pose_no_axis(options, "contacts");
    status = status ? status : pose_note_space(&list->notes, options, !is_ras);
    status = status ? status : read_table(&reading, list, text);
    if (!status && named_cells_has(&reading.header, PROBE_NAME) && !list->coordsystem) {
        status =
            fail(CONUS_ERROR_DATA, "column probe_name: a table of BEP032 without a *_coordsystem.json, whose x, y, z "
                                   "are micrometres on the probe; a probe is answered from its ProbeInterface file");
    }
    status = status ? status : pose_note_absent(&list->notes, reading.absent, reading.first_absent);
    const struct pose_space said = columns_space(&reading.columns);
    if (!list->space.name[0] || (list->space.is_of_path && said.name[0])) { /* the content counts */
        list->space = said;
    }
    status = status || !options->along_shafts ? status : find_neighbours(&reading);
    for (size_t i = 0; !status && i < reading.count; i++) {
        const struct contact *contact = &reading.contacts[i];
        conus_pose_row row = contact->row;
        row.is_point = !options->along_shafts;
        conus_status bad = contact->error || row.is_point ? CONUS_OK : pose_along_shaft(&row.pose, &reading, i);
        status = pose_list_add(list, &row, contact->name, bad ? conus_message() : contact->error);
    }
    for (size_t i = 0; i < reading.count; i++) {
        memory_free(reading.contacts[i].error);
    }
    memory_free(reading.contacts);
    return status;
}
