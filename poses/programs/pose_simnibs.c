/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads matsimnibs, SimNIBS's world_from_coil: the coil's x, y (along the handle), z (into the head) and centre. */
#include "poses/programs/pose_programs.h"

#include "poses/rows/pose_row.h"

#include <string.h>

enum { NUMBERS = 16 };

struct reading {
    struct job *job;
    struct pose_reading *to;
    const struct matlab *matlab;
    bool found; /* a field or a variable matsimnibs */
};

/* Column by column. */
static void add_matrix(const struct reading *reading, const double m[NUMBERS], struct text id, size_t line)
{
    conus_pose_row row = pose_row_at(line);
    conus_axis axis = reading->to->options->axis;
    conus_status bad = pose_of_matrix(&row.pose, m, false, axis ? axis : CONUS_AXIS_PLUS_Z);
    pose_add(reading->to, &row, id, bad ? conus_message() : NULL);
}

/* One matrix, or several behind each other. */
static void add_array(const struct reading *reading, const struct matlab_array *array, struct text id)
{
    const size_t *rows = &reading->to->list->count;
    const char *bad = NULL;
    if (!array->count) {
        bad = "matsimnibs is empty: SimNIBS finds the coil from centre and pos_ydir only when it runs; store the "
              "matrix that it finds";
    } else if (!matlab_is_real(array) || array->rows != 4 || array->columns != 4) {
        bad = job_format(reading->job, "matsimnibs: %s with %zu x %zu, 4 x 4 numbers are needed",
                         matlab_class_name(array).text, array->rows, array->columns);
    }
    if (bad) {
        const conus_pose_row row = pose_row_at(*rows + 1);
        pose_add(reading->to, &row, id, bad);
        return;
    }
    for (size_t first = 0; job_ok(reading->job) && first < array->count; first += NUMBERS) {
        double m[NUMBERS];
        for (size_t i = 0; i < NUMBERS; i++) {
            m[i] = matlab_number(array, first + i);
        }
        add_matrix(reading, m, id, *rows + 1);
    }
}

/* Each structure with a field matsimnibs is a POSITION, wherever it lies. */
static void add_structures(struct reading *reading)
{
    for (size_t i = 0; job_ok(reading->job) && i < reading->matlab->count; i++) {
        const struct matlab_array *array = &reading->matlab->arrays[i];
        const struct matlab_array *found = NULL;
        for (size_t k = 0; job_ok(reading->job) && k < array->count &&
                           (found = matlab_field(reading->matlab, array, k, "matsimnibs"));
             k++) {
            char name[POSE_ID_LIMIT + 2]; /* a byte more than allowed, to notice longer names */
            add_array(reading, found, matlab_text(name, sizeof name, matlab_field(reading->matlab, array, k, "name")));
        }
        reading->found = reading->found || found;
    }
}

static void parse_matlab(struct reading *reading, struct text text)
{
    const struct matlab *matlab = pose_matlab(reading->to, text);
    reading->matlab = matlab;
    add_structures(reading);
    const struct matlab_array *found = matlab_variable(matlab, "matsimnibs");
    if (found) {
        char name[POSE_ID_LIMIT + 2];
        reading->found = true;
        add_array(reading, found, matlab_text(name, sizeof name, matlab_variable(matlab, "name")));
    }
    bool is_list = matlab_variable(matlab, "poslist") || matlab_variable(matlab, "pos"); /* perhaps of no position */
    for (size_t i = 0; !is_list && i < matlab->count; i++) {
        is_list = matlab_field(matlab, &matlab->arrays[i], 0, "pos") != NULL;
    }
    if (!reading->found && !is_list) {
        job_bad(reading->job, "a file of MATLAB without matsimnibs (SimNIBS) and reco (Lead-DBS): no poses");
    }
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
static void parse_text(const struct reading *reading, struct text text)
{
    struct text word;
    size_t line = 1;
    size_t first = 1;
    size_t count = 0;
    double m[NUMBERS];
    text.data = text.size ? text.data : ""; /* not NULL, to which nothing may be added */
    while (job_ok(reading->job) && next_word(&text, &line, &word)) {
        size_t i = count++ % NUMBERS;
        first = i ? first : line;
        if (!text_to_double(word, &m[4 * (i % 4) + i / 4])) {
            job_bad(reading->job, "line %zu: \"%.*s\" is no number; a matsimnibs is 16 of them", line,
                    POSE_QUOTE(word));
        } else if (i + 1 == NUMBERS) {
            add_matrix(reading, m, text_from(""), first);
        }
    }
    if (!count || count % NUMBERS) {
        job_bad(reading->job, "%zu numbers, a matsimnibs is 16", count);
    }
}

/* SimNIBS's matsimnibs: in a MAT-file of a SESSION, a TMSLIST or a POSITION, or as a text of 16 numbers each. text
 * is no longer than pose_memory(). */
void pose_simnibs_parse(struct pose_reading *to, struct text text)
{
    struct reading reading = {.job = to->job, .to = to};
    to->list->space = pose_space_named(text_from("SimNIBS head model"), POSE_BRAIN_SUBJECT);
    pose_note_space(to->job, to->options, false);
    if (matlab_is(text)) {
        parse_matlab(&reading, text);
    } else {
        parse_text(&reading, text);
    }
}
