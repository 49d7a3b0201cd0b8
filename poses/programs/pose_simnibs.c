/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads matsimnibs, SimNIBS's world_from_coil: the coil's x, y (along the handle), z (into the head) and centre. */
#include "poses/programs/pose_programs.h"

#include "base/formats/matlab.h"
#include "poses/rows/pose_row.h"

#include <string.h>

enum { NUMBERS = 16 };

struct reading {
    conus_pose_list *list;
    const conus_pose_options *options;
    const struct matlab *matlab;
    bool found; /* a field or a variable matsimnibs */
};

/* Column by column. */
static conus_status add_matrix(const struct reading *reading, const double m[NUMBERS], struct text id, size_t line)
{
    conus_pose_row row = pose_row_at(line);
    conus_axis axis = reading->options->axis;
    conus_status bad = pose_of_matrix(&row.pose, m, false, axis ? axis : CONUS_AXIS_PLUS_Z);
    return pose_list_add(reading->list, &row, id, bad ? conus_message() : NULL);
}

/* One matrix, or several behind each other. */
static conus_status add_array(const struct reading *reading, const struct matlab_array *array, struct text id)
{
    conus_status status = CONUS_OK;
    if (!array->count) {
        status =
            fail(CONUS_ERROR_DATA, "matsimnibs is empty: SimNIBS finds the coil from centre and pos_ydir only when it "
                                   "runs; store the matrix that it finds");
    } else if (!matlab_is_real(array) || array->rows != 4 || array->columns != 4) {
        status = fail(CONUS_ERROR_DATA, "matsimnibs: %s with %zu x %zu, 4 x 4 numbers are needed",
                      matlab_class_name(array).text, array->rows, array->columns);
    }
    if (status) {
        const conus_pose_row row = pose_row_at(reading->list->count + 1);
        return pose_list_add(reading->list, &row, id, conus_message());
    }
    for (size_t first = 0; !status && first < array->count; first += NUMBERS) {
        double m[NUMBERS];
        for (size_t i = 0; i < NUMBERS; i++) {
            m[i] = matlab_number(array, first + i);
        }
        status = add_matrix(reading, m, id, reading->list->count + 1);
    }
    return status;
}

/* Each structure with a field matsimnibs is a POSITION, wherever it lies. */
static conus_status add_structures(struct reading *reading)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < reading->matlab->count; i++) {
        const struct matlab_array *array = &reading->matlab->arrays[i];
        const struct matlab_array *found = NULL;
        for (size_t k = 0;
             !status && k < array->count && (found = matlab_field(reading->matlab, array, k, "matsimnibs")); k++) {
            char name[POSE_ID_LIMIT + 2]; /* a byte more than allowed, to notice longer names */
            struct text id = matlab_text(name, sizeof name, matlab_field(reading->matlab, array, k, "name"));
            status = add_array(reading, found, id);
        }
        reading->found = reading->found || found;
    }
    return status;
}

static conus_status parse_matlab(struct reading *reading, struct text text)
{
    struct matlab matlab = {0};
    conus_status status = matlab_parse(&matlab, text, pose_memory(reading->options) - text.size);
    if (status) {
        return status;
    }
    reading->matlab = &matlab;
    status = add_structures(reading);
    const struct matlab_array *found = status ? NULL : matlab_variable(&matlab, "matsimnibs");
    if (found) {
        char name[POSE_ID_LIMIT + 2];
        reading->found = true;
        status = add_array(reading, found, matlab_text(name, sizeof name, matlab_variable(&matlab, "name")));
    }
    bool is_list = matlab_variable(&matlab, "poslist") || matlab_variable(&matlab, "pos"); /* perhaps of no position */
    for (size_t i = 0; !is_list && i < matlab.count; i++) {
        is_list = matlab_field(&matlab, &matlab.arrays[i], 0, "pos") != NULL;
    }
    if (!status && !reading->found && !is_list) {
        status = fail(CONUS_ERROR_DATA, "a file of MATLAB without matsimnibs (SimNIBS) and reco (Lead-DBS): no poses");
    }
    reading->matlab = NULL;
    matlab_finish(&matlab);
    return status;
}

/* The next number; brackets and commas are as good as white space, and # begins a comment. */
static bool next_word(struct text *rest, size_t *line, struct text *word)
{
    static const char between[] = " \t\r\n,;[]";
    size_t at = 0;
    bool comment = false;
    while (at < rest->size &&
           (comment || rest->data[at] == '#' || memchr(between, rest->data[at], sizeof between - 1))) {
        comment = rest->data[at] != '\n' && (comment || rest->data[at] == '#');
        *line += rest->data[at++] == '\n';
    }
    size_t begin = at;
    while (at < rest->size && rest->data[at] != '#' && !memchr(between, rest->data[at], sizeof between - 1)) {
        at++;
    }
    *word = (struct text){rest->data + begin, at - begin};
    *rest = (struct text){rest->data + at, rest->size - at};
    return word->size > 0;
}

/* Row by row, one matrix behind the other. */
static conus_status parse_text(const struct reading *reading, struct text text)
{
    struct text word;
    size_t line = 1;
    size_t first = 1;
    size_t count = 0;
    double m[NUMBERS];
    conus_status status = CONUS_OK;
    text.data = text.size ? text.data : ""; /* not NULL, to which nothing may be added */
    while (!status && next_word(&text, &line, &word)) {
        size_t i = count++ % NUMBERS;
        first = i ? first : line;
        if (!text_to_double(word, &m[4 * (i % 4) + i / 4])) {
            status = fail(CONUS_ERROR_DATA, "line %zu: \"%.*s\" is no number; a matsimnibs is 16 of them", line,
                          POSE_QUOTE(word));
        } else if (i + 1 == NUMBERS) {
            status = add_matrix(reading, m, text_from(""), first);
        }
    }
    return status || (count && count % NUMBERS == 0) ? status
                                                     : fail(CONUS_ERROR_DATA, "%zu numbers, a matsimnibs is 16", count);
}

conus_status pose_simnibs_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    struct reading reading = {.list = list, .options = options};
    list->space = pose_space_named(text_from("SimNIBS head model"), POSE_BRAIN_SUBJECT);
    conus_status status = pose_note_space(&list->notes, options, false);
    return status ? status : matlab_is(text) ? parse_matlab(&reading, text) : parse_text(&reading, text);
}
