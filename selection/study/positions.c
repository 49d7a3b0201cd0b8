/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists positions of the 10-10 system, and how a device stands there (Eq. 35). */
#include "atlas/surface/mesh.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/text.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"
#include "selection/study/study.h"

#include <math.h>
#include <string.h>

/* Standard deviation of the template's normals, degrees: 4.5 from those of Colin 27's scalp in the median. */
static const double NORMAL_ERROR = 3.8;
/* Cosine of 15 degrees: a normal within so much of straight back or front has no backwards beside it. */
static const double STRAIGHT = 0.9659258262890683;

struct row {
    struct table_object object; /* none */
    const char *name, *space;
    double at[3];
    double along[3], up[3]; /* NaN where no normal is known */
    double error_deg, error_mm;
};

static const struct table_field fields[] = {
    {"query_id", NULL, "the position", TABLE_OF(TEXT, struct row, name)},
    TABLE_XYZ("", "where it is", TABLE_OF, struct row, at),
    {"dx", NULL, "straight into the head, x; n/a where no normal is known", TABLE_OF(NUMBER, struct row, along[0])},
    {"dy", NULL, "the same, y", TABLE_OF(NUMBER, struct row, along[1])},
    {"dz", NULL, "the same, z", TABLE_OF(NUMBER, struct row, along[2])},
    {"ux", NULL, "the device's up, x: away from its handle", TABLE_OF(NUMBER, struct row, up[0])},
    {"uy", NULL, "the same, y", TABLE_OF(NUMBER, struct row, up[1])},
    {"uz", NULL, "the same, z", TABLE_OF(NUMBER, struct row, up[2])},
    {"error_deg", "degree", "standard deviation of the direction about two axes, between people's heads and this one",
     TABLE_OF(NUMBER, struct row, error_deg)},
    {"error_mm", "mm", "standard deviation of the position along each axis, likewise",
     TABLE_OF(NUMBER, struct row, error_mm)},
    {"space", NULL, "whose head it is on, as tables of poses say it: MNI152, or individual of a scalp",
     TABLE_OF(TEXT, struct row, space)},
};

const struct table_fields position_fields = {fields, sizeof fields / sizeof *fields};

/* -1 of a name on the left, 1 on the right, 0 on the midline: the last digit is odd, even, or a z stands there. */
static int side_of(const char *name)
{
    const char last = name[strlen(name) - 1];
    return last < '0' || last > '9' ? 0 : (last - '0') % 2 ? -1 : 1;
}

/* Up, away from a handle that points backwards, turned by so many degrees to the position's side. Seen from outside,
 * left is clockwise from backwards all over the head, also where the normal points down; from up at the back it is not.
 */
static void turn_handle(double up[3], const char *name, const double outward[3], double degrees)
{
    const bool is_up = fabs(outward[1]) > STRAIGHT;
    double back[3] = {0, is_up ? 0 : -1, is_up ? 1 : 0};
    double across[3];
    vec3_add_scaled(back, back, -vec3_dot(back, outward), outward);
    (void)vec3_normalise(back, back);
    vec3_cross(across, outward, back);
    const double turn =
        radians_from_degrees(degrees) * (outward[1] < -STRAIGHT ? 1 : -1) * (side_of(name) > 0 ? -1 : 1);
    vec3_scale(up, back, -cos(turn));
    vec3_add_scaled(up, up, -sin(turn), across);
}

conus_status conus_position_pose(conus_pose *out, const conus_place *place, const conus_position_options *options)
{
    double at[3];
    double along[3];
    double up[3];
    double outward[3];
    if (!vec3_normalise(outward, place->outward)) { /* of three digits */
        return fail(CONUS_ERROR_ARGUMENT, "the table of positions has no normal for %s", place->name);
    }
    if (!(fabs(options->off) <= 1000) || !(fabs(options->handle) <= 360)) {
        return fail(CONUS_ERROR_ARGUMENT, "%g mm off, handle %g degrees: allowed are -1000 to 1000, and -360 to 360",
                    options->off, options->handle);
    }
    vec3_add_scaled(at, place->point, options->off, outward);
    vec3_scale(along, outward, -1);
    turn_handle(up, place->name, outward, options->handle);
    return conus_pose_along(out, at, along, options->has_handle ? up : NULL);
}

static conus_status fill_row(struct row *row, const conus_place *place, const conus_position_options *options)
{
    conus_pose pose;
    conus_pose_error error;
    const bool has_normal = vec3_length(place->outward) > 0;
    *row = (struct row){.name = place->name,
                        .space = options->scalp ? "individual" : "MNI152",
                        .along = {NAN, NAN, NAN},
                        .up = {NAN, NAN, NAN},
                        .error_deg = has_normal && !options->scalp ? NORMAL_ERROR : NAN,
                        .error_mm = NAN};
    memcpy(row->at, place->point, sizeof row->at);
    conus_status status = conus_pose_error_find(&error, "eeg-cap");
    status = status || !has_normal ? status : conus_position_pose(&pose, place, options);
    if (!status && !options->scalp) {
        row->error_mm = error.shift;
    }
    for (int a = 0; a < 3 && !has_normal && options->off != 0; a++) {
        row->at[a] = NAN; /* which is off, and nothing says whereto */
    }
    for (int a = 0; a < 3 && !status && has_normal; a++) {
        row->at[a] = pose.world_from_device[12 + a];
        row->along[a] = 0 - pose.world_from_device[8 + a];
        row->up[a] = pose.world_from_device[4 + a] + 0;
    }
    return status;
}

static conus_place place_of_position(const struct position *position)
{
    conus_place place = {.kind = CONUS_PLACE_POSITION, .name = position->name, .depth = NAN};
    memcpy(place.point, position->point, sizeof place.point);
    memcpy(place.outward, position->outward, sizeof place.outward);
    return place;
}

conus_status position_on_scalp(struct position *out, const conus_scalp *scalp, const struct position *position)
{
    const struct scalp_position *found = scalp_find(scalp, text_from(position->name));
    if (!found) {
        return fail(CONUS_ERROR_ARGUMENT, "%s lies below the ring of 10 %%, for which there is no rule on a scalp",
                    position->name);
    }
    *out = *position;
    memcpy(out->point, found->point, sizeof out->point);
    memcpy(out->outward, found->outward, sizeof out->outward);
    return CONUS_OK;
}

conus_status position_way_find(struct position *out, struct position_way *way, const conus_scalp *scalp,
                               struct text text)
{
    struct position ends[2];
    struct scalp_position found;
    conus_status status = position_way_read(way, text);
    if (status || !way->from) {
        return status;
    }
    if (!scalp) {
        return fail(CONUS_ERROR_ARGUMENT, "%s>%s:%g: a way is measured on somebody's own scalp (--scalp)",
                    way->from->name, way->to->name, way->mm);
    }
    status = position_on_scalp(&ends[0], scalp, way->from);
    status = status ? status : position_on_scalp(&ends[1], scalp, way->to);
    status = status ? status
                    : scalp_walk(&found, scalp, scalp_find(scalp, text_from(ends[0].name)),
                                 scalp_find(scalp, text_from(ends[1].name)), way->mm);
    if (!status) {
        *out = ends[0];
        memcpy(out->point, found.point, sizeof out->point);
        memcpy(out->outward, found.outward, sizeof out->outward);
    }
    return status;
}

static conus_status find_position(conus_place *out, const char *name, const conus_scalp *scalp)
{
    struct position_way way;
    struct position end;
    conus_status status = position_way_find(&end, &way, scalp, text_from(name));
    if (status) {
        return status;
    }
    if (way.from) {
        *out = place_of_position(&end);
        out->name = name;
        return CONUS_OK;
    }
    const struct position *found = position_find(text_from(name));
    const char *closest = NULL;
    size_t least = strlen(name);
    for (size_t i = 0; !found && position_at(i); i++) {
        const size_t distance = text_distance(text_from(name), text_from(position_at(i)->name));
        closest = distance < least ? position_at(i)->name : closest;
        least = distance < least ? distance : least;
    }
    if (!found) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.40s\" is no position of the 10-10 system%s%s%s", name,
                    closest ? "; did you mean " : "", closest ? closest : "", closest ? "?" : "");
    }
    struct position position = *found;
    status = scalp ? position_on_scalp(&position, scalp, found) : CONUS_OK;
    *out = place_of_position(&position);
    return status;
}

conus_status conus_positions(conus_table **out, const char *const *names, size_t count,
                             const conus_position_options *options)
{
    const conus_position_options own = options ? *options : (conus_position_options){0};
    conus_frame world = {.space = CONUS_SPACE_RAS};
    size_t all = 0;
    while (own.scalp ? all < own.scalp->count : position_at(all) != NULL) {
        all++;
    }
    const size_t rows_count = names ? count : all;
    struct row *rows = memory_raw(rows_count, sizeof *rows);
    conus_status status = rows ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; i < rows_count && !status; i++) {
        conus_place place;
        const char *name = names ? names[i] : own.scalp ? own.scalp->at[i].name : position_at(i)->name;
        status = find_position(&place, name, own.scalp);
        status = status ? status : fill_row(&rows[i], &place, &own);
    }
    mat4_identity(world.world_from_space);
    status = status ? status
                    : table_create(out, &(struct table_source){NULL, &world}, &position_fields,
                                   &(struct table_question){0}, rows, sizeof *rows, rows_count);
    memory_free(rows);
    return status;
}
