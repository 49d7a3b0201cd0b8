/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads poses and checks their rows. */
#include "pose_checks.h"

#include "base/geometry/math3.h"
#include "conus/own.h"
#include "poses/pose_stream.h"
#include "test.h"

#include <stdio.h>
#include <string.h>

const double pose_target[3] = {0, -20, 10};

const char *pose_sample(const char *name)
{
    static char path[4096];
    snprintf(path, sizeof path, "%s/tests/fuzz/corpus/poses/%s", CONUS_SOURCE_DIR, name);
    return path;
}

conus_pose_list *pose_sample_load(const char *name, const conus_pose_options *options)
{
    conus_pose_list *list = NULL;
    assert_ok(conus_pose_list_load(&list, pose_sample(name), options));
    return list;
}

conus_pose_list *pose_text_parse(struct text text, const conus_pose_options *options)
{
    conus_pose_list *list = NULL;
    assert_ok(pose_list_parse(&list, text, options));
    return list;
}

void pose_text_refuse(struct text text, const conus_pose_options *options, const char *part)
{
    conus_pose_list *list = NULL;
    assert_fails(pose_list_parse(&list, text, options), CONUS_ERROR_DATA);
    if (!strstr(conus_message(), part)) {
        fail_msg("\"%s\" is not in \"%s\"", part, conus_message());
    }
}

const conus_pose_row *pose_row_of(const conus_pose_list *list, size_t index, const char *id)
{
    const conus_pose_row *row = conus_pose_list_row(list, index);
    assert_non_null(row);
    assert_string_equal(row->id, id);
    return row;
}

void assert_row_fails(const conus_pose_list *list, size_t index, const char *id, const char *part)
{
    const conus_pose_row *row = pose_row_of(list, index, id);
    if (!row->error || !strstr(row->error, part)) {
        fail_msg("\"%s\" is not in \"%s\"", part, row->error ? row->error : "");
    }
}

void assert_row_at(const conus_pose_row *row, double x, double y, double z)
{
    assert_null(row->error);
    const double point[3] = {x, y, z};
    for (int i = 0; i < 3; i++) {
        assert_near(row->pose.world_from_device[12 + i], point[i], 1e-9);
    }
}

void assert_row_along(const conus_pose_row *row, double x, double y, double z)
{
    assert_null(row->error);
    assert_false(row->is_point);
    const double beam[3] = {x, y, z};
    for (int i = 0; i < 3; i++) {
        assert_near(-row->pose.world_from_device[8 + i], beam[i], 1e-9);
    }
}

/* The beam passes the target 80 mm ahead: the device is outside the head and points at it. */
void assert_row_at_target(const conus_pose_row *row, double tolerance)
{
    const double *m = row->pose.world_from_device;
    double there[3];
    assert_null(row->error);
    assert_false(row->is_point);
    vec3_add_scaled(there, m + 12, -80, m + 8);
    vec3_sub(there, there, pose_target);
    assert_near(vec3_length(there), 0, tolerance);
    assert_near(mat4_determinant3(m), 1, 1e-9);
}

bool pose_has_note(const conus_pose_list *list, const char *part)
{
    const char *note;
    bool found = false;
    for (size_t i = 0; (note = conus_pose_list_note(list, i)); i++) {
        found = found || strstr(note, part);
    }
    return found;
}
