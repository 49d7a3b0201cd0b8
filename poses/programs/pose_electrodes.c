/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses BIDS electrodes, and finds the direction of each contact along its shaft. */
#include "poses/programs/pose_programs.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/order.h"
#include "poses/rows/columns.h"
#include "poses/rows/pose_row.h"

#include <string.h>

/* Columns that are read, or whose three say a space beside x y z; and those that say where a device points: such a
 * table is one of poses. */
enum column { NAME, GROUP = NAME + 4, PROBE_NAME, OF_SPACE, DIRECTIONS, COLUMNS = DIRECTIONS + 4 };

static const char *const names[COLUMNS] = {
    "name",
    "x",
    "y",
    "z",
    "group",
    "probe_name",
    "mni_x/MNI_X/MNI_x/mni152_x/MNI152_X/MNI152_x/x_mni/X_MNI/x_MNI/mni x/MNI X/mniX/mnix",
    "tx/TX",
    "dx/DX",
    "qw/QW",
    "m00/M00"};

/* A contact with a position. */
struct contact {
    struct text shaft; /* the column group, or the name without the number at its end */
    uint64_t number;   /* at the end of the name, or else of the row */
    size_t row;        /* in the list */
};

struct reading {
    struct job *job;
    struct pose_reading to;
    struct columns columns;
    struct named_cells header;
    LIST(struct contact) contacts;
    size_t absent, first_absent; /* rows without a position, and the line of the first */
};

static bool find_columns(struct named_cells *out, struct text line)
{
    bool all = true;
    *out = (struct named_cells){.names = names, .count = COLUMNS, .table.quotes_are_plain = true};
    named_cells_find(NULL, out, line); /* a column that is there twice is an error of such a table */
    for (size_t i = NAME; i < COLUMNS; i++) {
        all = all && ((i >= GROUP && i < DIRECTIONS) || named_cells_has(out, i) == (i < GROUP));
    }
    return all;
}

bool pose_electrodes_header(struct text line, bool with_two)
{
    struct named_cells header;
    return find_columns(&header, line) && (!with_two || named_cells_has(&header, OF_SPACE));
}

/* "LA12" is contact 12 of LA, unless it has a group. */
static void add_contact(struct reading *reading, struct text name, struct text group)
{
    const size_t row = reading->to.list->count - 1;
    struct contact contact = {.shaft = name, .row = row};
    while (contact.shaft.size && strchr("0123456789", contact.shaft.data[contact.shaft.size - 1])) {
        contact.shaft.size--;
    }
    struct text digits = {name.size ? name.data + contact.shaft.size : "", name.size - contact.shaft.size};
    contact.number = text_to_uint(digits, UINT64_MAX, &contact.number) ? contact.number : row + 1;
    contact.shaft = columns_is_absent(group) ? contact.shaft : group;
    *LIST_ADD(reading->job, &reading->contacts) = contact;
}

static void read_line(struct reading *reading, struct text line, size_t number)
{
    const conus_pose_options *options = reading->to.options;
    const struct columns *columns = &reading->columns;
    struct table_line cells;
    struct pose_name name = {.text = {"", 0}};
    struct text whole = {"", 0}; /* with the marks that belong to it */
    conus_pose_row row = pose_row_at(number);
    conus_status bad = CONUS_OK;
    enum columns_line kind = columns_read(&row, &name, &bad, columns, line, number, options);
    const char *error = kind == LINE_ABSENT ? "x: not known (n/a)"
                        : kind != LINE_ROW  ? "no number in it"
                        : bad               ? conus_message()
                                            : NULL; /* an answer has as many rows as the table */
    if (error && !JOB_CALL(reading->job, columns_hear_late(columns, line, number, options))) {
        return;
    }
    if (kind == LINE_NOTHING || kind == LINE_AGAIN || !table_split(&cells, &columns->table, line)) {
        return;
    }
    if (kind == LINE_ABSENT && !options->all_rows) {
        reading->first_absent = reading->absent++ ? reading->first_absent : number;
        return;
    }
    for (size_t i = 0; i < cells.count && i < columns->count; i++) {
        whole = columns->role_of[i] == ROLE_NAME ? cells.cells[i] : whole;
    }
    size_t group = reading->header.at[GROUP];
    row.is_point = !options->along_shafts;
    pose_add(&reading->to, &row, whole, error);
    if (job_ok(reading->job) && !error && !row.is_point) {
        add_contact(reading, whole, group < cells.count ? cells.cells[group] : text_from(""));
    }
}

static void read_table(struct reading *reading, struct text text)
{
    bool is_short = false;
    struct text line = {"", 0};
    struct text rest = text;
    while (!text_trim(line).size && text_line(&rest, &line)) {
    }
    if (!find_columns(&reading->header, line)) {
        job_bad(reading->job, "header: the columns name, x, y and z, separated by tabs, are needed");
    }
    size_t size = text.size < TABLE_HEAD ? text.size : TABLE_HEAD;
    while (size < text.size && size && text.data[size - 1] != '\n') { /* whole lines */
        size--;
    }
    const struct text head = {text.data, size ? size : text.size};
    struct columns *columns = &reading->columns;
    columns->is_bids = true;
    columns_plan(reading->job, columns, &is_short, head, reading->to.options);
    if (job_ok(reading->job) && columns->pairs) {
        pairs_parse(&reading->to, columns, text);
        return;
    }
    for (size_t number = 1; job_ok(reading->job) && text_line(&text, &line); number++) {
        read_line(reading, line, number);
    }
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
    const struct contact *contacts = reading->contacts.at;
    return index > 0 && index < reading->contacts.count &&
           text_compare(contacts[index - 1].shaft, contacts[index].shaft) == 0;
}

/* Each points at the next one outward; the last one of a shaft as its neighbour does. */
static void point_along_shafts(struct reading *reading)
{
    const conus_pose_list *list = reading->to.list;
    const struct contact *contacts = reading->contacts.at;
    const size_t count = job_ok(reading->job) ? reading->contacts.count : 0;
    order_sort(reading->contacts.at, count, sizeof *contacts, compare_contacts);
    for (size_t i = 0; i < count; i++) {
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
            (void)job_need(reading->job, row->error);
        }
    }
}

/* Electrodes of BIDS, *_electrodes.tsv, in units of list->space: points, or poses along their shafts. */
void pose_electrodes_parse(struct pose_reading *to, struct text text)
{
    conus_pose_list *list = to->list;
    const conus_pose_options *options = to->options;
    bool is_named = list->space.brain != POSE_BRAIN_UNKNOWN && list->space.brain != POSE_BRAIN_OTHER; /* it is RAS */
    const conus_frame ras = {.space = CONUS_SPACE_RAS};
    conus_pose_options own = *options;
    bool is_ras = is_named || options->space != CONUS_SPACE_LPS;
    own.space = is_ras ? CONUS_SPACE_RAS : options->space;
    own.frame = is_ras ? &ras : options->frame;
    own.axis = CONUS_AXIS_OF_FORMAT;
    own.unit = list->space.scale > 0 ? list->space.scale : options->unit;
    own.any_space = options->any_space || list->coordsystem; /* which says what they are */
    own.format = NULL;
    struct reading reading = {.job = to->job, .to = {.job = to->job, .list = list, .options = &own}};
    pose_refuse_axis(to, "contacts");
    pose_note_space(to->job, to->options, !is_ras);
    read_table(&reading, text);
    if (named_cells_has(&reading.header, PROBE_NAME) && !list->coordsystem) {
        job_bad(to->job, "column probe_name: a table of BEP032 without a *_coordsystem.json, whose x, y, z "
                         "are micrometres on the probe; a probe is answered from its ProbeInterface file");
    }
    pose_note_absent(to->job, reading.absent, reading.first_absent);
    const struct pose_space said = columns_space(&reading.columns);
    if (!list->space.name[0] || (list->space.is_of_path && said.name[0])) { /* the content counts */
        list->space = said;
    }
    if (options->along_shafts) {
        point_along_shafts(&reading);
    }
}
