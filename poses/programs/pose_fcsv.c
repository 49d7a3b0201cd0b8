/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses 3D Slicer's lists of fiducials. */
#include "poses/programs/pose_programs.h"

#include "poses/rows/pose_columns.h"
#include "poses/rows/pose_row.h"

enum column { LABEL, X, Y, Z, COLUMNS };

static const char *const names[COLUMNS] = {"label", "x", "y", "z"};

/* The columns that Slicer assumes where a file does not name them; since 5 rows have two more than it names. */
static const char named[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID";
static const char usual[] = "id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID,positionStatus,autoCreated";
enum { FIELDS_OF_5 = 16 };
static const char usual_once[] = "label,x,y,z,sel,vis"; /* in Slicer 3 */

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    struct pose_columns columns;
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
    conus_status status = pose_columns_find(&reading->columns, text_equal(value, named) ? text_from(usual) : value);
    for (size_t i = X; !status && i <= Z; i++) {
        if (!pose_columns_has(&reading->columns, i)) {
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

/* Counts the fields of a row; *status is the last but one. */
static size_t count_fields(struct text *status, struct text line)
{
    struct text last = {"", 0};
    size_t count = 0;
    for (bool more = true, found = true; more && found;) {
        *status = last;
        enum text_quotes quotes;
        found = text_quoted_field(&line, ',', &more, &last, &quotes);
        count += found;
    }
    return count;
}

/* A row of Slicer 5 has two fields more than the header names, or none: the first says whether the point was placed
 * (vtkMRMLMarkupsNode::PositionDefined). One more, or other two, are what decimal commas make. */
static conus_status check_fields(const struct reading *reading, struct text line)
{
    struct text status = {"", 0};
    uint64_t number;
    if (reading->columns.field_count != FIELDS_OF_5) {
        return CONUS_OK;
    }
    size_t count = count_fields(&status, line);
    bool is_of_5 = count == FIELDS_OF_5 && text_to_uint(status, 9, &number);
    if (count > FIELDS_OF_5 - 2 && !is_of_5) {
        return fail(CONUS_ERROR_DATA, "%zu fields, the header has %d; decimals are written with a point", count,
                    FIELDS_OF_5 - 2);
    }
    return is_of_5 && number != 2
               ? fail(CONUS_ERROR_DATA, "position status \"%.*s\", not 2: the point was not placed", POSE_QUOTE(status))
               : CONUS_OK;
}

static conus_status read_point(struct reading *reading, struct text line, size_t number)
{
    struct text fields[COLUMNS];
    double point[3];
    conus_pose_row row = pose_row_at(number);
    row.is_point = true;
    conus_status bad = pose_columns_split(fields, &reading->columns, line);
    bad = bad ? bad : check_fields(reading, line);
    bad = bad ? bad : pose_columns_point(point, &reading->columns, fields, X, 1);
    if (!bad && reading->lps) {
        pose_flip_point(point);
    }
    bad = bad ? bad : pose_of_point(&row.pose, point);
    return pose_list_add(reading->list, &row, fields[LABEL], bad ? conus_message() : NULL);
}

conus_status pose_fcsv_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {.list = list, .options = options};
    struct text line;
    conus_status status = options->axis == CONUS_AXIS_OF_FORMAT
                              ? CONUS_OK
                              : fail(CONUS_ERROR_DATA, "fiducials have no axes, so that no axis (%s) can be chosen",
                                     pose_axis_name(options->axis));
    reading.columns = (struct pose_columns){.names = names, .count = COLUMNS, .separator = ',', .may_end_early = true};
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
