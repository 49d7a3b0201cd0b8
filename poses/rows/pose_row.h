/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Shared by the readers of poses: rows, lists, spaces, axes, and positions of a cap. */
#ifndef CONUS_POSES_ROWS_POSE_ROW_H
#define CONUS_POSES_ROWS_POSE_ROW_H

#include "base/job/job.h"
#include "base/status.h"
#include "base/text.h"
#include "conus/pose.h"
#include "conus/space.h"

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

/** Writes it, with single marks and no zero behind it, up to @p most bytes; how many these are. */
size_t kept_text_put(char *out, size_t most, const struct kept_text *kept);

/** The formats of files of poses, with their words for conus_pose_options.format and, of those whose text is read as a
 * whole, the parser (pose_programs.h). Of AUTO the content decides; a row of sources/rows.c may say so. */
#define POSE_FORMAT_ROWS(LINES, WHOLE)                                                                                 \
    LINES(AUTO, "auto")                                                                                                \
    LINES(TABLE, "table")                                                                                              \
    WHOLE(MATRIX, "matrix", pose_matrix_parse)                                                                         \
    LINES(POINTS, "points")                                                                                            \
    WHOLE(BRAINSIGHT, "brainsight", pose_brainsight_parse)                                                             \
    WHOLE(LOCALITE, "localite", pose_localite_parse)                                                                   \
    WHOLE(ELECTRODES, "electrodes", pose_electrodes_parse)                                                             \
    WHOLE(MARKUPS, "markups", pose_markups_parse)                                                                      \
    WHOLE(SIMNIBS, "simnibs", pose_simnibs_parse)                                                                      \
    WHOLE(NIBS, "nibs", pose_nibs_parse)                                                                               \
    WHOLE(INVESALIUS, "invesalius", pose_invesalius_parse)                                                             \
    WHOLE(LEAD_DBS, "lead-dbs", pose_lead_dbs_parse)                                                                   \
    WHOLE(LEAD_DBS_NATIVE, "lead-dbs-native", pose_lead_dbs_parse)                                                     \
    WHOLE(IBL, "ibl", pose_ibl_parse)                                                                                  \
    WHOLE(NWB, "nwb", pose_nwb_parse)                                                                                  \
    WHOLE(LIST, "list", pose_lists_parse)

#define POSE_FORMAT_ID(id, ...) POSE_FORMAT_##id,
enum pose_format { POSE_FORMAT_ROWS(POSE_FORMAT_ID, POSE_FORMAT_ID) };

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

/** CONUS_ERROR_ARGUMENT with what is allowed, unless @p angle, in degrees, is a cone's full opening angle. */
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

/** A direction in (right, anterior, up), as the space of @p frame has these, in the world; of any length. */
void direction_from_anatomical(double out[3], const double d[3], const conus_frame *frame);

/** The other way; may be of another length. */
void direction_to_anatomical(double out[3], const double world[3], const conus_frame *frame);

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

/** A point of the CCF, micrometres AP, DV, ML, in the space of @p frame, which is of the CCF or from bregma, to the
 * world. */
conus_status pose_point_of_ccf(double world[3], const double ccf[3], const conus_frame *frame);

/** A device's matrix, in LPS if @p lps, that points along its @p axis. */
conus_status pose_of_matrix(conus_pose *out, const double m[16], bool lps, conus_axis axis);

/** Seconds since 1970-01-01 on the clock that wrote "2019-03-22" and "14:08:40.658"; NaN if that is not what they are.
 */
double pose_clock(struct text date, struct text time);

/** A note where the caller asked for LPS and the file says itself that it is RAS, by @p lps. */
void pose_note_space(struct job *job, const conus_pose_options *options, bool lps);

/** "+x" and so on; "" for CONUS_AXIS_OF_FORMAT. */
const char *pose_axis_name(conus_axis axis);

/** A pose that is only a position. */
conus_status pose_of_point(conus_pose *out, const double point[3]);

/** CONUS_ERROR_DATA: @p what, "column x" say, holds @p field, which is no number. */
conus_status pose_no_number(const char *what, struct text field);

/** TEXT_SHOW() of a field in a message. */
#define POSE_QUOTE(field) TEXT_SHOW(field, POSE_QUOTE_LIMIT)

/** One position on the scalp. */
struct position {
    const char *name;  /**< "C3". */
    const char *also;  /**< Its older name, "T3" of T7; NULL = none. */
    double point[3];   /**< MNI 152, RAS, mm. */
    double outward[3]; /**< Unit vector; all 0 where none is known. */
};

/** Position @p index, from 0; NULL past the last. Static. */
const struct position *position_at(size_t index);

/** The position called @p name, by its older name, too, in any case; NULL if there is none. Static. */
const struct position *position_find(struct text name);

/** A way from one position towards another: "C3>F3:50". */
struct position_way {
    const struct position *from, *to; /**< Static. */
    double mm;
};

/** Reads a way; its start is NULL where the text is none: it does not begin with a position and '>'.
 * CONUS_ERROR_ARGUMENT where it does and what follows is no position, a colon and a number. */
conus_status position_way_read(struct position_way *out, struct text text);

/** Which brain a space belongs to. */
enum pose_brain {
    POSE_BRAIN_UNKNOWN = 0,
    POSE_BRAIN_SUBJECT, /**< Somebody's own scan. */
    POSE_BRAIN_MNI152,
    POSE_BRAIN_TALAIRACH,
    POSE_BRAIN_TEMPLATE, /**< Another template, of people. */
    POSE_BRAIN_COLIN27,
    POSE_BRAIN_MNI305,
    POSE_BRAIN_ANIMAL, /**< A template of another animal than the mouse. */
    POSE_BRAIN_MOUSE,
    POSE_BRAIN_FRAME, /**< The axes of a stereotactic frame or of a head, which no image has. */
    POSE_BRAIN_OTHER  /**< Somebody's own, but not, or not surely, in the world of its scan: tkRAS, n/a. */
};

/** All 0: the file names none. */
struct pose_space {
    char name[64]; /**< As the file has it: "NIfTI:Scanner". */
    enum pose_brain brain;
    double scale;    /**< mm per unit of the file's numbers; 0 = 1. */
    bool is_of_path; /**< The file's name says it, by which nothing is converted. */
};

struct pose_space pose_space_named(struct text name, enum pose_brain brain);

/** CONUS_ERROR_DATA where file and atlas (conus_atlas_brain()) are of different brains; a warning where one of them is
 * unknown, and where some mm lie between two templates; a note between MNI 152 and Colin 27. A subject's own scan fits
 * an atlas that is one person's, or was moved; a warning names another space. */
conus_status pose_space_match(struct notes *notes, const struct pose_space *space, const conus_atlas *atlas);

struct conus_pose_list {
    conus_pose_row *rows; /**< Strings are owned. */
    size_t count;
    size_t capacity;
    bool is_counted;     /**< pose_check_count() holds for it, by `max_memory`. */
    uint64_t max_memory; /**< 0 = the default. */
    struct notes notes;
    struct note_sink sink; /**< Where the notes go. */
    char *name;            /**< Path of the sink; owned, NULL while it is the stream's. */
    struct pose_space space;
    bool is_cap;       /**< Of electrodes, which is checked when it is whole (cap_check()). */
    size_t kept_count; /**< Of each row that has some. */
    char *electrodes;  /**< The text of a table of electrodes; owned, NULL of other formats. */
    char *coordsystem; /**< Path of the file that says what the space is; owned, NULL if there is none. */
    char coordsystem_sha256[65];
};

/** Adds a row with copies of its strings. An @p id that is empty becomes the row's number; one that is too long or not
 * UTF-8, too, and then the row has an error. @p error NULL: none. */
conus_status pose_list_add(conus_pose_list *list, const conus_pose_row *row, struct text id, const char *error);

/** Gives the last row copies of texts that are kept. All rows of a list have as many. */
conus_status pose_list_keep(conus_pose_list *list, const struct kept_text *texts, size_t count);

/** Gives the sink the notes of the list, which keeps a copy of the sink and of its path. */
conus_status pose_list_hear(conus_pose_list *list, const struct note_sink *sink);

/** @name Files that are read as a whole
 * @{ */
struct pose_reading {
    struct job *job;       /**< Its notes become the list's. */
    conus_pose_list *list; /**< Gets the rows; a bad pose is a row with its error. */
    const conus_pose_options *options;
    const char *path;            /**< NULL: of no file. */
    struct text parsed;          /**< By pose_json() or pose_matlab(), as: */
    struct json_t *json;         /**< the job's; */
    const struct matlab *matlab; /**< likewise. */
};

/** As pose_list_add(). */
void pose_add(const struct pose_reading *to, const conus_pose_row *row, struct text id, const char *error);

/** Adds a point, in LPS if @p lps, or a row with the @p error; NULL: there is none. */
void pose_add_point(const struct pose_reading *to, size_t line, const double point[3], bool lps, struct text id,
                    const char *error);

/** A failure where the caller chooses an axis: @p what, "contacts" say, have none. */
void pose_refuse_axis(const struct pose_reading *of, const char *what);

/** A note that @p count rows without a position were passed over, the first in line @p first; of 0 none. */
void pose_note_absent(struct job *job, size_t count, size_t first);
/** @} */

/** Takes all rows out, and keeps their memory for the next ones. */
void pose_list_clear(conus_pose_list *list);

/** Frees what is in it. */
void pose_list_finish(conus_pose_list *list);

/* A place as people write it: numbers, or words that need an atlas or a cap to become a point. */

enum place_form {
    PLACE_NUMBERS,  /**< Three numbers. */
    PLACE_NAME,     /**< An area, or else a position. */
    PLACE_CENTROID, /**< centroid:AREA */
    PLACE_NEAR,     /**< near:AREA */
    PLACE_LABEL,    /**< index:17, the area with this label. */
    PLACE_CAP       /**< 1020:C3, a position by the user's word. */
};

/** A place, taken apart. It borrows from the text. */
struct place_words {
    enum place_form form;
    struct text name;       /**< What stands behind the prefix, or all of it; not empty. */
    struct numbers numbers; /**< PLACE_NUMBERS: as of numbers_read(). PLACE_NAME: why it is none, if it has three. */
    uint64_t label;         /**< PLACE_LABEL */
};

/** Takes a place apart. It knows no atlas. CONUS_ERROR_ARGUMENT for an empty one, one that is no text, and a label that
 * is no number. */
conus_status place_read(struct place_words *out, struct text text);

/** Why the text is no three numbers, where it has that many and is no name either. */
conus_status place_fail_numbers(const struct place_words *words);

/* What titles, comments and headers say of the space and unit of positions. */

/** Axes that a line names. */
enum space_axes {
    SPACE_AXES_PLAIN,   /**< None, or x y z, R A S, L P S. */
    SPACE_AXES_ORDERED, /**< Others, or these in another order: "AP LAT VERT". */
    SPACE_AXES_TURNED,  /**< "x flipped", "left is positive". */
    SPACE_AXES_VOXELS   /**< "i j k". */
};

/** What was read so far. All 0: nothing. */
struct space_words {
    struct pose_space space; /**< The brain: pose_space_match() decides, and space_moves() says which is moved. */
    bool says_mni;           /**< MNI is named, perhaps beside another brain. */
    bool has_signs;          /**< RAS or LPS: */
    conus_space signs;
    bool may_be_lps; /**< "LPS" stands there, and nothing says of what. */
    double mm;       /**< mm per unit; 0: none was named. */
    bool are_two;    /**< Units that contradict each other. */
    const char *why; /**< Why positions cannot be taken: what they are; static. NULL: they can. */
    char heard[64];  /**< The words that decided. */
    enum space_axes axes;
    int order[3]; /**< Of ordered ones: 0 is to a side, 1 to the front or back, 2 up or down. */
};

/** Reads a line, sentence by sentence. */
void space_words_hear(struct space_words *words, struct text line);

/** Whether a text is nothing but words of spaces and units, or such as stand beside them in a line that names columns:
 * "columns:", "(mm)". */
bool space_words_are_beside(struct text text);

/** Whether a text names three axes and nothing else but such words: "columns: AP LAT VERT (mm)", "x: left, y: ...". */
bool space_words_are_axes(struct text text);

/** Reads what is said of coordinates alone: the cells of a column, or a word of its header. */
void space_words_hear_of(struct space_words *words, struct text word);

/** Reads the name of a file, in which "native", "acpc" and "lps" need no word for positions beside them. */
void space_words_hear_name(struct space_words *words, struct text name);

/** Reads a cell that is nothing but words of a space, or a name of BIDS; @p strong: only words that have no other
 * meaning. False where nothing is read. */
bool space_words_hear_cell(struct space_words *words, struct text cell, bool strong);

/** The brain of a space by its name in BIDS, or as laboratories call their own; POSE_BRAIN_UNKNOWN: of none that is
 * known. */
enum pose_brain space_brain_named(struct text name);

/** @p mm of space_unit_mm() for a unit that is known and not taken. */
#define SPACE_UNIT_REFUSED (-1.0)

/** mm of a unit by its name, in any case; 0: none, below 0: one that is not taken (inches, pixels). */
double space_unit_mm(struct text name);

/** Why such a unit is refused, and voxels. */
extern const char space_why_unit[], space_why_voxels[], space_why_dura[];

/** When --any-space is right for positions of @p space: "only if they are RAS mm of the atlas (...), type ...". */
const char *space_any(conus_space space);

enum { SPACE_WHY = 256 };

/** words->why; of a code of axes what its two readings make of a point, which may be written to @p out. */
const char *space_words_why(char out[SPACE_WHY], const struct space_words *words);

/** Whether positions of @p space are moved to MNI 152: those of MNI 305, unless the caller or the file's name says
 * otherwise. A note says so. */
bool space_moves(const struct pose_space *space, const conus_pose_options *options);
void space_note_move(struct job *job, const struct pose_space *space);

/** Moves a point of MNI 305 to MNI 152, RAS mm (FreeSurfer's wiki, CoordinateSystems, 8b). */
void space_move_from_mni305(double p[3]);

#endif
