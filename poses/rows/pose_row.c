/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks and turns what a row gives: ids, angles, points, axes, times. */
#include "poses/rows/pose_row.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/status.h"

#include <stdio.h>
#include <string.h>

uint64_t pose_memory(const conus_pose_options *options)
{
    return options->max_memory ? options->max_memory : UINT64_C(1) << 30;
}

conus_status pose_check_count(size_t count, uint64_t max_memory)
{
    enum { POSE_BYTES = 2048 }; /* a row of the list, and a selection, a query and some rows of a report */
    uint64_t most = memory_limit(max_memory) / POSE_BYTES;
    return count <= most ? CONUS_OK
                         : fail(CONUS_ERROR_MEMORY,
                                "more than %llu poses, which take %d bytes each with their answers, allowed are %llu "
                                "bytes (--max-memory); conus batch takes tables of any length",
                                (unsigned long long)most, POSE_BYTES, (unsigned long long)memory_limit(max_memory));
}

conus_pose_row pose_row_at(size_t line)
{
    return (conus_pose_row){.line = line,
                            .time_s = NAN,
                            .error_deg = NAN,
                            .error_mm = NAN,
                            .aim = {NAN, NAN, NAN},
                            .range = {NAN, NAN},
                            .normal = {NAN, NAN, NAN},
                            .target_mm = NAN,
                            .radius = NAN};
}

const char *pose_check_id(struct text *id, char ordinal[POSE_ORDINAL_SIZE], uint64_t number)
{
    const char *bad = id->size > POSE_ID_LIMIT                       ? "the name is longer than 255 bytes"
                      : id->size && memchr(id->data, '\0', id->size) ? "the name has a zero byte"
                      : id->size && !text_is_utf8(*id)               ? "the name is not UTF-8 text"
                                                                     : NULL;
    if (bad || !id->size) {
        snprintf(ordinal, POSE_ORDINAL_SIZE, "%llu", (unsigned long long)number);
        *id = text_from(ordinal);
    }
    return bad;
}

conus_status pose_no_number(const char *what, struct text field)
{
    bool has_comma = field.size && memchr(field.data, ',', field.size);
    const char *last = text_last(field, ' ');
    const struct text behind = {last ? last + 1 : "", last ? field.size - (size_t)(last + 1 - field.data) : 0};
    bool has_unit = text_is_one_of(behind, "mm/um/cm/m/deg", true);
    return fail(CONUS_ERROR_DATA, "%s: \"%.*s\" is not a finite number%s", what, POSE_QUOTE(field),
                text_mentions(field, "\xc2\xb1")
                    ? "; of two numbers with \xc2\xb1 write the one in front, of two sides two rows"
                : has_comma ? "; decimals are written with a point"
                : has_unit  ? "; a unit stands in the header, as in x (mm)"
                            : "");
}

conus_status pose_check_angle(double angle)
{
    return angle > 0 && angle < 180
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "angle: %g degrees, allowed is more than 0 and less than 180%s", angle,
                      angle == 0 ? "; 0 needs a radius" : "");
}

conus_status pose_check_range(const double range[2])
{
    return range[0] >= 0 && range[1] > range[0] && isfinite(range[1])
               ? CONUS_OK
               : fail(CONUS_ERROR_ARGUMENT, "range: %g to %g mm, allowed is NEAR from 0 on and FAR beyond it", range[0],
                      range[1]);
}

conus_status pose_row_toward(conus_pose_row *row, const double origin[3], const double target[3], const double up[3])
{
    double along[3];
    conus_status status = conus_pose_toward(&row->pose, origin, target, up);
    vec3_sub(along, target, origin);
    row->target_mm = status ? NAN : vec3_length(along);
    return status;
}

void pose_row_end(conus_pose_row *row, const conus_pose_options *options)
{
    if (row->error || row->is_point) {
        return;
    }
    bool is_own = row->range[1] == row->target_mm; /* of a file whose targets end its axes */
    if (isnan(row->range[0]) && (options->to_target || is_own)) {
        row->range[0] = options->to_target ? options->near : 0;
    }
    if (!options->to_target) {
        return;
    }
    row->range[1] = isnan(row->range[1]) || is_own ? row->target_mm + options->beyond : row->range[1];
    row->angle = row->angle == 0 && options->aperture > 0
                     ? degrees_from_radians(2 * atan(options->aperture / 2 / row->target_mm))
                     : row->angle;
    row->error = !isnan(row->range[1])
                     ? NULL
                     : "a direction alone, without the target at which the range is to end: columns tx, ty, tz";
}

void pose_flip_point(double p[3])
{
    p[0] = 0 - p[0]; /* makes no "-0" of 0 */
    p[1] = 0 - p[1];
}

void pose_flip_matrix(double m[16])
{
    for (int column = 0; column < 4; column++) {
        pose_flip_point(m + 4 * column);
    }
}

void pose_turn(conus_pose *pose, conus_axis axis)
{
    /* Columns: where the turned device's x, y, z point in the one given; -z is the axis that points. */
    static const double turns[][9] = {
        [CONUS_AXIS_PLUS_X] = {0, 0, 1, 0, 1, 0, -1, 0, 0},  [CONUS_AXIS_MINUS_X] = {0, 0, -1, 0, 1, 0, 1, 0, 0},
        [CONUS_AXIS_PLUS_Y] = {1, 0, 0, 0, 0, 1, 0, -1, 0},  [CONUS_AXIS_MINUS_Y] = {-1, 0, 0, 0, 0, 1, 0, 1, 0},
        [CONUS_AXIS_PLUS_Z] = {-1, 0, 0, 0, 1, 0, 0, 0, -1},
    };
    if (axis == CONUS_AXIS_OF_FORMAT || axis == CONUS_AXIS_MINUS_Z) {
        return;
    }
    const double *turn = turns[axis];
    double *m = pose->world_from_device;
    double columns[3][3];
    for (int i = 0; i < 3; i++) {
        mat4_direction(columns[i], m, turn + 3 * i);
    }
    for (int i = 0; i < 3; i++) {
        memcpy(m + 4 * i, columns[i], sizeof columns[i]);
    }
}

conus_status pose_roll(conus_pose *pose, double turn)
{
    const double *m = pose->world_from_device;
    double axis[3];
    double up[3];
    if (turn == 0) {
        return CONUS_OK;
    }
    if (!isfinite(turn)) {
        return fail(CONUS_ERROR_ARGUMENT, "roll: a finite number is needed");
    }
    bool mirrored = pose_is_mirrored(pose);
    vec3_scale(axis, m + 8, -1);
    vec3_scale(up, m + 4, cos(turn));
    vec3_add_scaled(up, up, sin(turn), m);
    conus_status status = conus_pose_along(pose, m + 12, axis, up);
    if (mirrored && !status) {
        pose_mirror(pose);
    }
    return status;
}

conus_status pose_point_of_ccf(double world[3], const double ccf[3], const conus_frame *frame)
{
    const double *b = frame->bregma;
    const double mm[3] = {(b[0] - ccf[0]) / 1000, (ccf[2] - b[2]) / 1000, (b[1] - ccf[1]) / 1000};
    return conus_frame_to_world(world, frame, frame->space == CONUS_SPACE_CCF ? ccf : mm);
}

conus_status pose_of_matrix(conus_pose *out, const double m[16], bool lps, conus_axis axis)
{
    double ras[16];
    memcpy(ras, m, sizeof ras);
    if (lps) {
        pose_flip_matrix(ras);
    }
    conus_status status = conus_pose_from_matrix(out, ras);
    if (!status) {
        pose_turn(out, axis);
    }
    return status;
}

const char *pose_axis_name(conus_axis axis)
{
    static const char *const names[] = {"", "+x", "-x", "+y", "-y", "+z", "-z"};
    return names[axis];
}

conus_status pose_of_point(conus_pose *out, const double point[3])
{
    if (!vec3_is_finite(point)) {
        return fail(CONUS_ERROR_ARGUMENT, "position: %g,%g,%g, allowed are finite numbers", point[0], point[1],
                    point[2]);
    }
    *out = (conus_pose){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, point[0], point[1], point[2], 1}};
    return CONUS_OK;
}

static bool read_parts(double parts[3], struct text text, char separator)
{
    struct text field;
    bool more = true;
    for (int i = 0; i < 3; i++) {
        if (!text_field(&text, separator, &more, &field) || !text_to_double(field, &parts[i]) ||
            !(parts[i] >= 0 && parts[i] < 1e4)) {
            return false;
        }
    }
    return !more;
}

/* Days from 1970-01-01 in the Gregorian calendar, whose year begins in March here (H. Hinnant, chrono-compatible
 * low-level date algorithms). */
static double days_of_date(double year, double month, double day)
{
    double y = month <= 2 ? year - 1 : year;
    double era = floor(y / 400);
    double year_of_era = y - era * 400;
    double day_of_year = floor((153 * (month + (month > 2 ? -3 : 9)) + 2) / 5) + day - 1;
    return era * 146097 + year_of_era * 365 + floor(year_of_era / 4) - floor(year_of_era / 100) + day_of_year - 719468;
}

double pose_clock(struct text date, struct text time)
{
    double d[3];
    double t[3];
    if (!read_parts(d, date, '-') || !read_parts(t, time, ':') || !(d[1] >= 1 && d[1] <= 12)) {
        return NAN;
    }
    return days_of_date(d[0], d[1], d[2]) * 86400 + t[0] * 3600 + t[1] * 60 + t[2];
}

void pose_note_space(struct job *job, const conus_pose_options *options, bool lps)
{
    static const char text[] = "the file says that its positions are RAS, and as such they are taken";
    const struct notes *notes = &job->notes;
    if (options->space == CONUS_SPACE_LPS && !lps &&
        !(notes->count && strcmp(notes->lines[notes->count - 1], text) == 0)) {
        job_note(job, "%s", text);
    }
}
