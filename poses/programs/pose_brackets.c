/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses numbers in brackets, as Python prints and stores them and MATLAB writes them: lists of points or matrices, and
 * JSON whose names or objects are points. */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <string.h>

enum { MATRIX = 16, ROW = 4 };

/* Behind "NAME =" and white space, the first bracket; an empty text where there is none. */
static struct text opened(struct text text)
{
    static const char name[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
    struct text rest = text_trim(text);
    const char *equals = rest.size ? memchr(rest.data, '=', rest.size) : NULL;
    struct text before = {rest.data, equals ? (size_t)(equals - rest.data) : 0};
    if (equals && text_has_only(text_trim(before), name)) {
        rest = text_trim((struct text){equals + 1, rest.size - before.size - 1});
    }
    return rest.size && rest.data[0] == '[' ? rest : (struct text){"", 0};
}

bool pose_brackets_begin(struct text text)
{
    struct text rest = opened(text);
    while (rest.size && memchr("[ \t\r\n", rest.data[0], 5)) {
        rest = (struct text){rest.data + 1, rest.size - 1};
    }
    return rest.size && memchr("+-.0123456789", rest.data[0], 13);
}

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    double numbers[MATRIX];
    size_t count, width; /* numbers of this row; of each, 0 = not known yet */
    size_t rows;
};

static conus_status add_point(conus_pose_list *list, const conus_pose_options *options, const double point[3],
                              struct text id, conus_status bad)
{
    conus_pose_row row = pose_row_at(list->count + 1);
    double world[3];
    row.is_point = true;
    bad = bad ? bad : conus_frame_to_world(world, options->frame, point);
    bad = bad ? bad : pose_of_point(&row.pose, world);
    return pose_list_add(list, &row, id, bad ? conus_message() : NULL);
}

/* Three numbers are a point; four rows of four a matrix. */
static conus_status end_row(struct reading *reading)
{
    size_t width = reading->width == ROW ? reading->count - ROW * (reading->rows % ROW) : reading->count;
    conus_status status = CONUS_OK;
    if (width == 0) { /* brackets around rows */
        return CONUS_OK;
    }
    if ((width != 3 && width != ROW) || (reading->width && width != reading->width)) {
        return fail(CONUS_ERROR_DATA,
                    "row %zu in brackets has %zu numbers; points have three, matrices four rows of four",
                    reading->rows + 1, width);
    }
    reading->width = width;
    reading->rows++;
    if (width == 3) {
        status = add_point(reading->list, reading->options, reading->numbers, text_from(""), CONUS_OK);
        reading->count = 0;
    } else if (reading->rows % ROW == 0) {
        conus_pose_row row = pose_row_at(reading->rows / ROW);
        double m[MATRIX];
        for (size_t i = 0; i < MATRIX; i++) {
            m[i] = reading->numbers[4 * (i % 4) + i / 4];
        }
        conus_status bad =
            pose_of_matrix(&row.pose, m, reading->options->space == CONUS_SPACE_LPS, reading->options->axis);
        status = pose_list_add(reading->list, &row, text_from(""), bad ? conus_message() : NULL);
        reading->count = 0;
    }
    return status;
}

static conus_status add_number(struct reading *reading, struct text word)
{
    double number;
    if (text_find(word, "...")) {
        return fail(CONUS_ERROR_DATA, "\"...\" in brackets: what was printed is not all of it; save it as a file "
                                      "(numpy.savetxt, writematrix)");
    }
    if (!text_to_double(word, &number) || !isfinite(number)) {
        return fail(CONUS_ERROR_DATA, "\"%.*s\" in brackets is no number", POSE_QUOTE(word));
    }
    if (reading->count == MATRIX) {
        return fail(CONUS_ERROR_DATA,
                    "a row in brackets of more than 16 numbers; points have three, matrices four rows "
                    "of four");
    }
    reading->numbers[reading->count++] = number;
    return CONUS_OK;
}

/* A row ends at its own bracket, or in the only one at a semicolon or the line's end. */
static conus_status parse_numbers(struct reading *reading, struct text text)
{
    static const char marks[] = "[] \t\r\n,;";
    size_t depth = 0;
    conus_status status = CONUS_OK;
    for (size_t at = 0; !status && at < text.size;) {
        const char c = text.data[at];
        size_t size = 0;
        while (at + size < text.size && !memchr(marks, text.data[at + size], sizeof marks - 1)) {
            size++;
        }
        if (size) {
            status = depth ? add_number(reading, (struct text){text.data + at, size})
                           : fail(CONUS_ERROR_DATA, "\"%.*s\" behind the brackets",
                                  POSE_QUOTE(((struct text){text.data + at, size})));
        } else if (c == ']' || (depth == 1 && (c == ';' || c == '\n'))) {
            status = c == ']' && !depth ? fail(CONUS_ERROR_DATA, "a bracket ] that was not opened") : end_row(reading);
        }
        depth = c == '[' ? depth + 1 : c == ']' && depth ? depth - 1 : depth;
        at += size ? size : 1;
    }
    if (!status && (depth || reading->count)) {
        status = fail(CONUS_ERROR_DATA, depth ? "a bracket [ that is not closed" : "the last matrix is not whole");
    }
    return status;
}

/* Three numbers of a list. */
static conus_status read_triple(double point[3], const json_t *list)
{
    bool fine = json_array_size(list) == 3;
    for (size_t k = 0; fine && k < 3; k++) {
        point[k] = json_number_value(json_array_get(list, k));
        fine = json_is_number(json_array_get(list, k));
    }
    return fine ? CONUS_OK : fail(CONUS_ERROR_DATA, "three numbers are needed");
}

bool pose_brackets_json(json_t *root)
{
    bool all = json_object_size(root) > 0;
    double point[3];
    for (void *at = json_object_iter(root); all && at; at = json_object_iter_next(root, at)) {
        all = read_triple(point, json_object_iter_value(at)) == CONUS_OK;
    }
    return all;
}

/* {"name": "M1", "x": 1, "y": 2, "z": 3}, in any case; another key of a direction would be lost. */
static conus_status read_object(double point[3], struct text *id, json_t *object)
{
    static const char *const names[] = {"x", "y", "z"};
    bool found[3] = {false, false, false};
    for (void *at = json_object_iter(object); at; at = json_object_iter_next(object, at)) {
        struct text key = text_from(json_object_iter_key(at));
        const json_t *value = json_object_iter_value(at);
        for (size_t k = 0; k < 3; k++) {
            if (text_equal_ignoring_case(key, names[k]) && json_is_number(value)) {
                point[k] = json_number_value(value);
                found[k] = true;
            }
        }
        *id = text_is_one_of(key, "name/label/id", false) && json_is_string(value) ? json_text_of(value) : *id;
        if (text_is_one_of(key, "tx/dx/nx/qw/qx/angle/depth", false)) {
            return fail(CONUS_ERROR_DATA, "an object with the key \"%.*s\": save these poses as a table",
                        POSE_QUOTE(key));
        }
    }
    return found[0] && found[1] && found[2] ? CONUS_OK : fail(CONUS_ERROR_DATA, "the numbers x, y and z are needed");
}

conus_status pose_brackets_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    json_t *root = NULL;
    struct reading reading = {.list = list, .options = options};
    if (pose_brackets_begin(text)) {
        return parse_numbers(&reading, opened(text));
    }
    conus_status status = json_text_load(&root, text);
    for (void *at = json_object_iter(root); !status && at; at = json_object_iter_next(root, at)) {
        double point[3] = {0};
        conus_status bad = read_triple(point, json_object_iter_value(at));
        status = add_point(list, options, point, text_from(json_object_iter_key(at)), bad);
    }
    for (size_t i = 0; !status && i < json_array_size(root); i++) {
        struct text id = {"", 0};
        double point[3] = {0};
        conus_status bad = read_object(point, &id, json_array_get(root, i));
        status = add_point(list, options, point, id, bad);
    }
    json_decref(root);
    return status;
}
