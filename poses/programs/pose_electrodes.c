/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses BIDS electrodes, and finds the direction of each contact along its shaft. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/columns.h"
#include "poses/rows/named_cells.h"
#include "poses/rows/pose_row.h"

#include <string.h>

/* Columns that are read; and those that say where a device points: such a table is one of poses. */
enum column { NAME, GROUP = NAME + 4, PROBE_NAME, DIRECTIONS, COLUMNS = DIRECTIONS + 4 };

static const char *const names[COLUMNS] = {"name",       "x",     "y",     "z",     "group",
                                           "probe_name", "tx/TX", "dx/DX", "qw/QW", "m00/M00"};

/* A contact with a position. */
struct contact {
    struct text shaft; /* the column group, or the name without the number at its end */
    uint64_t number;   /* at the end of the name, or else of the row */
    size_t row;        /* in the list */
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

/* "LA12" is contact 12 of LA, unless it has a group. */
static conus_status add_contact(struct reading *reading, struct text name, struct text group, size_t row)
{
    struct contact contact = {.shaft = name, .row = row};
    if (!memory_reserve(&reading->contacts, &reading->capacity, reading->count + 1, sizeof *reading->contacts)) {
        return CONUS_ERROR_MEMORY;
    }
    while (contact.shaft.size && strchr("0123456789", contact.shaft.data[contact.shaft.size - 1])) {
        contact.shaft.size--;
    }
    struct text digits = {name.size ? name.data + contact.shaft.size : "", name.size - contact.shaft.size};
    contact.number = text_to_uint(digits, UINT64_MAX, &contact.number) ? contact.number : row + 1;
    contact.shaft = columns_is_absent(group) ? contact.shaft : group;
    reading->contacts[reading->count++] = contact;
    return CONUS_OK;
}

static conus_status read_line(struct reading *reading, conus_pose_list *list, struct text line, size_t number)
{
    const conus_pose_options *options = reading->options;
    const struct columns *columns = &reading->columns;
    struct table_line cells;
    struct pose_name name = {.text = {"", 0}};
    struct text whole = {"", 0}; /* with the marks that belong to it */
    conus_pose_row row = pose_row_at(number);
    conus_status bad = CONUS_OK;
    enum columns_line kind = columns_read(&row, &name, &bad, columns, line, number, options);
    conus_status status = kind == LINE_ROW && !bad ? CONUS_OK : columns_hear_late(columns, line, number, options);
    if (status || kind == LINE_NOTHING || kind == LINE_AGAIN || !table_split(&cells, &columns->table, line)) {
        return status;
    }
    if (kind == LINE_ABSENT && !options->all_rows) {
        reading->first_absent = reading->absent++ ? reading->first_absent : number;
        return CONUS_OK;
    }
    if (kind != LINE_ROW) { /* an answer has as many rows as the table */
        bad = fail(CONUS_ERROR_DATA, kind == LINE_ABSENT ? "x: not known (n/a)" : "no number in it");
    }
    for (size_t i = 0; i < cells.count && i < columns->count; i++) {
        whole = columns->role_of[i] == ROLE_NAME ? cells.cells[i] : whole;
    }
    size_t group = reading->header.at[GROUP];
    row.is_point = !options->along_shafts;
    status = pose_list_add(list, &row, whole, bad ? conus_message() : NULL);
    return status || bad || row.is_point
               ? status
               : add_contact(reading, whole, group < cells.count ? cells.cells[group] : text_from(""), list->count - 1);
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
        status = read_line(reading, list, line, number);
    }
    return status;
}

/* By shaft, then outward. */
static int compare_contacts(const void *left, const void *right)
{
    const struct contact *a = left;
    const struct contact *b = right;
    int order = text_compare(a->shaft, b->shaft);
    order = order ? order : compare_unsigned(a->number, b->number);
    return order ? order : compare_unsigned(a->row, b->row);
}

/* Whether contact @p index, of those in order, is on the shaft of the one before. */
static bool goes_on(const struct reading *reading, size_t index)
{
    return index > 0 && index < reading->count &&
           text_compare(reading->contacts[index - 1].shaft, reading->contacts[index].shaft) == 0;
}

/* Each points at the next one outward; the last one of a shaft as its neighbour does. */
static conus_status point_along_shafts(conus_pose_list *list, struct reading *reading)
{
    const struct contact *contacts = reading->contacts;
    conus_status status = CONUS_OK;
    order_sort(reading->contacts, reading->count, sizeof *contacts, compare_contacts);
    for (size_t i = 0; !status && i < reading->count; i++) {
        conus_pose_row *row = &list->rows[contacts[i].row];
        size_t from = goes_on(reading, i + 1) ? i : i - 1;
        bool has_other = from == i || goes_on(reading, i);
        const double origin[3] = {row->pose.world_from_device[12], row->pose.world_from_device[13],
                                  row->pose.world_from_device[14]};
        double direction[3];
        if (has_other) {
            vec3_sub(direction, list->rows[contacts[from + 1].row].pose.world_from_device + 12,
                     list->rows[contacts[from].row].pose.world_from_device + 12);
        }
        conus_status bad =
            has_other ? conus_pose_along(&row->pose, origin, direction, NULL)
                      : fail(CONUS_ERROR_DATA, "the only contact of its shaft \"%.*s\": no other gives it a direction",
                             POSE_QUOTE(contacts[i].shaft));
        if (bad && !row->error) {
            row->error = memory_text(conus_message(), strlen(conus_message()));
            status = row->error ? CONUS_OK : CONUS_ERROR_MEMORY;
        }
    }
    return status;
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
    status = status || !options->along_shafts ? status : point_along_shafts(list, &reading);
    memory_free(reading.contacts);
    return status;
}
