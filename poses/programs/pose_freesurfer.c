/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses FreeSurfer's points: .label, the .dat of control points and way points, and Freeview's point sets (.json). */
#include "poses/programs/pose_programs.h"

#include "base/formats/json_text.h"
#include "poses/rows/pose_row.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* tkRAS counts from the middle of the image's voxels: in which world that is only the image says. */
static struct pose_space space_of(bool is_scanner)
{
    return is_scanner
               ? pose_space_named(text_from("FreeSurfer scanner RAS"), POSE_BRAIN_SUBJECT)
               : pose_space_named(text_from("FreeSurfer tkRAS (Freeview can save scanner RAS)"), POSE_BRAIN_OTHER);
}

static conus_status add_point(conus_pose_list *list, const double point[3], struct text id, size_t line,
                              conus_status bad)
{
    conus_pose_row row = pose_row_at(line);
    row.is_point = true;
    bad = bad ? bad : pose_of_point(&row.pose, point);
    return pose_list_add(list, &row, id, bad ? conus_message() : NULL);
}

/* Three words of a line. */
static conus_status read_words(double out[3], struct text *line)
{
    for (int i = 0; i < 3; i++) {
        struct text word = {"", 0};
        if (!text_word(line, &word) || !text_to_double(word, &out[i]) || !isfinite(out[i])) {
            return pose_no_number((const char[]){"xyz"[i], '\0'}, word);
        }
    }
    return CONUS_OK;
}

static conus_status check_count(const char *what, uint64_t stated, size_t count)
{
    return stated == count ? CONUS_OK
                           : fail(CONUS_ERROR_DATA, "%s: %llu, but there are %zu: the file is not whole", what,
                                  (unsigned long long)stated, count);
}

bool pose_freesurfer_line(struct text line)
{
    return text_starts(line, "#!ascii label");
}

bool pose_freesurfer_dat(struct text text)
{
    struct text line;
    bool found = false;
    while (!found && text_line(&text, &line)) {
        found = text_starts(line, "useRealRAS");
    }
    return found;
}

/* "#!ascii label , from subject bert vox2ras=scanner", a count, lines of vertex x y z value. */
static conus_status parse_label(conus_pose_list *list, struct text text)
{
    struct text line;
    uint64_t stated = 0;
    conus_status status = CONUS_OK;
    (void)text_line(&text, &line);
    list->space = space_of(text_contains(line, text_from("vox2ras=scanner")));
    if (!text_line(&text, &line) || !text_to_uint(text_trim(line), UINT64_MAX, &stated)) {
        return fail(CONUS_ERROR_DATA, "line 2: the number of points of a label is needed");
    }
    for (size_t number = 3; !status && text_line(&text, &line); number++) {
        struct text vertex = {"", 0};
        double point[3];
        if (text_word(&line, &vertex)) {
            conus_status bad = read_words(point, &line);
            status = add_point(list, point, vertex.data[0] == '-' ? text_from("") : vertex, number, bad);
        }
    }
    return status ? status : check_count("points", stated, list->count);
}

/* Lines of x y z; then "info", "numpoints N", "useRealRAS 0" or 1. */
static conus_status parse_dat(conus_pose_list *list, struct text text)
{
    struct text line;
    uint64_t stated = UINT64_MAX;
    uint64_t is_scanner = 2;
    conus_status status = CONUS_OK;
    for (size_t number = 1; !status && text_line(&text, &line); number++) {
        struct text rest = line;
        struct text word;
        double point[3];
        if (!text_word(&rest, &word) || text_equal(word, "info")) {
            continue;
        }
        uint64_t *value = text_equal(word, "numpoints") ? &stated : text_equal(word, "useRealRAS") ? &is_scanner : NULL;
        if (!value) {
            status = add_point(list, point, text_from(""), number, read_words(point, &line));
        } else if (!text_to_uint(text_trim(rest), UINT64_MAX, value)) {
            status = fail(CONUS_ERROR_DATA, "line %zu: %.*s: a number is needed", number, POSE_QUOTE(word));
        }
    }
    if (!status && is_scanner > 1) {
        status = fail(CONUS_ERROR_DATA, "useRealRAS: 0 (tkRAS) or 1 (the scanner's space) is needed");
    }
    list->space = space_of(is_scanner == 1);
    return status || stated == UINT64_MAX ? status : check_count("numpoints", stated, list->count);
}

bool pose_freesurfer_json(const json_t *root)
{
    return text_equal(json_text_of(json_object_get(root, "data_type")), "fs_pointset");
}

static conus_status parse_json(conus_pose_list *list, struct text text)
{
    json_t *root = NULL;
    conus_status status = json_text_load(&root, text);
    const json_t *points = json_object_get(root, "points");
    struct text system = json_text_of(json_object_get(root, "vox2ras"));
    bool is_scanner = text_equal(system, "scanner_ras");
    if (!status && !is_scanner && !text_equal(system, "tkreg")) {
        status = fail(CONUS_ERROR_DATA, "vox2ras \"%.*s\", allowed are scanner_ras and tkreg", POSE_QUOTE(system));
    }
    list->space = space_of(is_scanner);
    for (size_t i = 0; !status && i < json_array_size(points); i++) {
        const json_t *at = json_object_get(json_array_get(points, i), "coordinates");
        double point[3];
        conus_status bad = CONUS_OK;
        for (int k = 0; !bad && k < 3; k++) {
            const json_t *value = json_object_get(at, (const char[]){"xyz"[k], '\0'});
            point[k] = json_number_value(value);
            bad = json_is_number(value) ? CONUS_OK : fail(CONUS_ERROR_DATA, "%c: a number is needed", "xyz"[k]);
        }
        status = add_point(list, point, text_from(""), i + 1, bad);
    }
    json_decref(root);
    return status;
}

conus_status pose_freesurfer_parse(conus_pose_list *list, struct text text, const conus_pose_options *options)
{
    if (options->axis != CONUS_AXIS_OF_FORMAT) {
        return fail(CONUS_ERROR_DATA, "points have no direction, so that no axis (%s) can be chosen",
                    pose_axis_name(options->axis));
    }
    conus_status status = pose_note_space(&list->notes, options, false);
    bool is_json = text_trim(text).size && text_trim(text).data[0] == '{';
    return status                       ? status
           : pose_freesurfer_line(text) ? parse_label(list, text)
           : is_json                    ? parse_json(list, text)
                                        : parse_dat(list, text);
}
