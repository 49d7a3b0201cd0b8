/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Shared by the readers of poses: rows, spaces and axes. */
#ifndef CONUS_POSES_ROWS_POSE_ROW_H
#define CONUS_POSES_ROWS_POSE_ROW_H

#include "base/notes.h"
#include "base/text.h"
#include "conus/pose_file.h"

enum {
    POSE_ID_LIMIT = 255,    /**< Longest id, in bytes.                  */
    POSE_QUOTE_LIMIT = 40,  /**< How much of a field a message quotes.  */
    POSE_ORDINAL_SIZE = 24, /**< A row's number as text.                */
    POSE_KEPT_LIMIT = 64    /**< Most columns whose texts are kept.     */
};

/** A cell that is kept. */
struct kept_text {
    struct text text;
    bool is_quoted; /**< Its marks are doubled. */
};

/** The formats of a text of poses, for messages. */
#define POSE_FORMATS                                                                                                   \
    "a header line and one line per pose, a 4 x 4 matrix, lines of x y z, or another program's file (docs/formats.md)"

/** Bytes that a file that is read whole may take: what @p options say, or 1 GiB. */
uint64_t pose_memory(const conus_pose_options *options);

/** CONUS_ERROR_MEMORY where @p count poses, each with its answer, take more than @p max_memory bytes, 0 = the default
 * of memory_limit(). */
conus_status pose_check_count(size_t count, uint64_t max_memory);

/** A row that says nothing yet: no times, no errors, no angle, no range. */
conus_pose_row pose_row_at(size_t line);

/** Lets @p id be the number of the row, written into @p ordinal, unless it is a name that can be used. Says what is
 * wrong with it, NULL if nothing is; not to have one is fine. */
const char *pose_check_id(struct text *id, char ordinal[POSE_ORDINAL_SIZE], uint64_t number);

/** CONUS_ERROR_ARGUMENT with what is allowed, unless @p angle, in radians, is a cone's full opening angle. */
conus_status pose_check_angle(double angle);

/** CONUS_ERROR_ARGUMENT with what is allowed, unless @p range is of two depths, mm. */
conus_status pose_check_range(const double range[2]);

/** LPS to RAS and back: x and y change sign. */
void pose_flip_point(double p[3]);
/** The same for a matrix that maps into that space. */
void pose_flip_matrix(double m[16]);

/** Whether the device's frame is left-handed, as in a world that is a mirror image of a space (Eq. 2). */
bool pose_is_mirrored(const conus_pose *pose);

/** Turns the device's x around, so that its frame has the other hand. */
void pose_mirror(conus_pose *pose);

/** As conus_pose_from_matrix(), but a left-handed matrix stays so. */
conus_status pose_settle(conus_pose *out, const double world_from_device[16]);

/** As conus_pose_from_matrix(), but left-handed ones are taken, too, where the world is a mirror image of the frame's
 * space. NULL = RAS. */
conus_status pose_settle_in(conus_pose *out, const double world_from_device[16], const conus_frame *frame);

/** Where up and forward of a space lead in the world, unit vectors: superior and anterior. Returns whether the world is
 * a mirror image of the space. */
bool pose_space_axes(double upward_forward[2][3], const conus_frame *frame);

/** Turns @p pose, whose device points along its @p axis, so that it points along its -z (Eq. 2): by a half turn about y
 * for +z and quarter turns about y for +-x, so that +y stays up, and with +z up for +-y. */
void pose_turn(conus_pose *pose, conus_axis axis);

/** Turns the device about its axis by @p turn radians, its +y towards its +x (Eq. 22). */
conus_status pose_roll(conus_pose *pose, double turn);

/** conus_pose_toward() of a row, which keeps how far its target is. */
conus_status pose_row_toward(conus_pose_row *row, const double origin[3], const double target[3], const double up[3]);

/** Ends the row's range at its target, where @p options say so: a row that has none gets an error. A range that the
 * file ends at the target begins where they say, or at the device. */
void pose_row_end(conus_pose_row *row, const conus_pose_options *options);

/** Eq. 24: a device at @p origin, world mm, whose tip leans by @p tilt_ml to the side and by @p tilt_ap to the front of
 * straight down, radians, each as seen along the other axis. Sides and axes are those of @p frame's space: the midline
 * is x = 0, or bregma's. CONUS_ERROR_ARGUMENT for an angle of 90 degrees or more, and for a tilt to the side of a
 * device on the midline; and as conus_pose_along(). */
conus_status pose_along_tilts(conus_pose *out, const double origin[3], double tilt_ml, double tilt_ap,
                              const conus_frame *frame);

/** Eq. 24: likewise, with the International Brain Laboratory's azimuth @p phi and polar angle @p theta of its far end,
 * radians: theta = 0 points straight down. */
conus_status pose_along_phi_theta(conus_pose *out, const double origin[3], double phi, double theta,
                                  const conus_frame *frame);

/** A device's matrix, in LPS if @p lps, that points along its @p axis. */
conus_status pose_of_matrix(conus_pose *out, const double m[16], bool lps, conus_axis axis);

/** Seconds since 1970-01-01 on the clock that wrote "2019-03-22" and "14:08:40.658"; NaN if that is not what they are.
 */
double pose_clock(struct text date, struct text time);

/** A note where the caller asked for LPS and the file says itself that it is RAS, by @p lps. */
conus_status pose_note_space(struct notes *notes, const conus_pose_options *options, bool lps);

/** A note that @p count rows without a position were passed over, the first in line @p first; of 0 none. */
conus_status pose_note_absent(struct notes *notes, size_t count, size_t first);

/** "+x" and so on; "" for CONUS_AXIS_OF_FORMAT. */
const char *pose_axis_name(conus_axis axis);

/** CONUS_ERROR_DATA where the caller chooses an axis: @p what, "contacts" say, have none. */
conus_status pose_no_axis(const conus_pose_options *options, const char *what);

/** A pose that is only a position. */
conus_status pose_of_point(conus_pose *out, const double point[3]);

/** CONUS_ERROR_DATA: @p what, "column x" say, holds @p field, which is no number. */
conus_status pose_no_number(const char *what, struct text field);

/** TEXT_SHOW() of a field in a message. */
#define POSE_QUOTE(field) TEXT_SHOW(field, POSE_QUOTE_LIMIT)

#endif
