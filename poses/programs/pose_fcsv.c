/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses 3D Slicer's lists of fiducials. */
#include "poses/programs/pose_programs.h"

#include "poses/rows/named_cells.h"
#include "poses/rows/pose_row.h"

enum column { LABEL, X, Y, Z, COLUMNS };

static const char *const names[COLUMNS] = {"label", "x", "y", "z"};

/* The columns that Slicer assumes where a file does not name them; since 5 rows have two more than it names. */
static const char named[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID";
static const char usual[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID,positionStatus,autoCreated";
enum { FIELDS_OF_5 = 16, STATUS = 14 };
static const char usual_once[] = "label,x,y,z,sel,vis"; /* in Slicer 3 */

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    struct named_cells cells;
    bool has_columns, has_space, lps;
    bool is_old; /* Slicer 3, which had RAS only */
};

bool pose_fcsv_line(struct text line)
{
    static const char *const heads[] = {"# Markups fiducial file", "# Fiducial List file", "# columns = id,x,y,z",
                                        "# columns = label,x,y,z"};
    bool found = false;
    for (size_t i = 0; i < sizeof heads / sizeof heads[0]; i++) {
        found = found || text_starts(line, heads[i]);
    }
    return found;
}

/* "# KEY = value"; false for another comment. */
static bool take_key(struct text *value, struct text line, const char *key)
{
    struct text name;
    bool more = true;
    line = text_trim((struct text){line.data + 1, line.size - 1});
    if (!text_field(&line, '=', &more, &name) || !more || !text_equal(text_trim(name), key)) {
        return false;
    }
    *value = text_trim(line);
    return true;
}

static conus_status read_columns(struct reading *reading, struct text value)
{
    conus_status status = named_cells_find(&reading->cells, text_equal(value, named) ? text_from(usual) : value);
    for (size_t i = X; !status && i <= Z; i++) {
        if (!named_cells_has(&reading->cells, i)) {
            status = fail(CONUS_ERROR_DATA, "columns: \"%.*s\", x, y and z are needed", POSE_QUOTE(value));
        }
    }
    reading->has_columns = true;
    return status;
}

static conus_status read_comment(struct reading *reading, struct text line)
{
    struct text value;
    reading->is_old = reading->is_old || text_starts(line, "# Fiducial List file");
    if (!take_key(&value, line, "CoordinateSystem")) {
        return take_key(&value, line, "columns") ? read_columns(reading, value) : CONUS_OK;
    }
    bool ras = text_equal(value, "RAS") || text_equal(value, "0");
    reading->lps = text_equal(value, "LPS") || text_equal(value, "1");
    reading->has_space = true;
    return ras || reading->lps
               ? pose_note_space(&reading->list->notes, reading->options, reading->lps)
               : fail(CONUS_ERROR_DATA, "CoordinateSystem \"%.*s\", allowed are RAS, LPS, 0 and 1", POSE_QUOTE(value));
}

/* Before the first point, or at the end. */
static conus_status end_head(struct reading *reading)
{
    const char *assumed = reading->is_old ? usual_once : usual;
    conus_status status = reading->has_columns ? CONUS_OK : read_columns(reading, text_from(assumed));
    if (status || reading->has_space) {
        return status;
    }
    reading->has_space = true;
    reading->lps = !reading->is_old && reading->options->space == CONUS_SPACE_LPS;
    return reading->is_old ? pose_note_space(&reading->list->notes, reading->options, false)
                           : notes_warn(&reading->list->notes, "no line CoordinateSystem; taken as %s",
                                        reading->lps ? "LPS" : "RAS");
}

/* A row of Slicer 5 has two fields more than the header names, or none: the first says whether the point was placed
 * (vtkMRMLMarkupsNode::PositionDefined). One more, or other two, are what decimal commas make. */
static conus_status check_status(const struct named_cells *cells)
{
    const size_t count = cells->line.count;
    struct text status = count == FIELDS_OF_5 ? cells->line.cells[STATUS] : (struct text){"", 0};
    uint64_t number;
    bool is_of_5 = text_to_uint(status, 9, &number);
    if (cells->width != FIELDS_OF_5 || (count <= STATUS && !is_of_5)) {
        return CONUS_OK;
    }
    return !is_of_5 ? fail(CONUS_ERROR_DATA, "%zu fields, the header has %d; decimals are written with a point", count,
                           STATUS)
           : number != 2
               ? fail(CONUS_ERROR_DATA, "position status \"%.*s\", not 2: the point was not placed", POSE_QUOTE(status))
               : CONUS_OK;
}

static conus_status read_point(struct reading *reading, struct text line, size_t number)
{
    double point[3];
    conus_status bad = named_cells_split(&reading->cells, line);
    bad = bad ? bad : check_status(&reading->cells);
    bad = bad ? bad : named_cells_numbers(point, &reading->cells, X, 3);
    return pose_list_add_point(reading->list, number, point, reading->lps, named_cell(&reading->cells, LABEL), bad);
}

conus_status pose_fcsv_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {
        .list = list,
        .options = options,
        .cells = {.names = names, .count = COLUMNS, .table.separator = TABLE_COMMAS},
    };
    struct text line;
    conus_status status = pose_no_axis(options, "fiducials");
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        if (text_has_only(line, ",\t\r ")) {
            continue;
        }
        if (line.data[0] == '#') {
            status = read_comment(&reading, line);
        } else {
            status = end_head(&reading);
            status = status ? status : read_point(&reading, line, number);
        }
    }
    return status ? status : end_head(&reading);
}
