/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file pose.h
 * The position and orientation of a device, a beam, a probe, a pointing hand, a camera: by numbers, from files, from
 * what people call places, and of the contacts of a probe.
 */
#ifndef CONUS_PUBLIC_POSE_H
#define CONUS_PUBLIC_POSE_H

#include <conus/atlas.h>
#include <conus/space.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @name Poses
 * @{ */

/** Rigid position and orientation of a device. It points along its own -z; +y is up (Eq. 2). Left-handed only where
 * conus_frame_turn_pose() made it so. */
typedef struct conus_pose {
    double world_from_device[16]; /**< Column-major; maps device mm to world mm. */
} conus_pose;

/** Makes a device at @p origin that points along @p direction.
 * @param[out] out The pose.
 * @param origin World mm.
 * @param direction Any length but 0.
 * @param up Upwards of the device; NULL = the default of Eq. 2.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a number that is not finite, and for a direction of length 0 or along @p
 * up. */
CONUS_CHECKED conus_status conus_pose_along(conus_pose *out, const double origin[3], const double direction[3],
                                            const double up[3]);

/** Makes a device at @p origin that points at a point.
 * @param[out] out The pose.
 * @param origin World mm.
 * @param target World mm.
 * @param up As for conus_pose_along().
 * @return #CONUS_OK; as conus_pose_along(). */
CONUS_CHECKED conus_status conus_pose_toward(conus_pose *out, const double origin[3], const double target[3],
                                             const double up[3]);

/** Makes a pose from a rigid, right-handed matrix. Deviations up to 2e-3 (three decimals in files) are made exact: the
 * axis is kept as given.
 * @param[out] out The pose.
 * @param world_from_device Column-major; maps device mm to world mm.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another matrix. */
CONUS_CHECKED conus_status conus_pose_from_matrix(conus_pose *out, const double world_from_device[16]);

/** Makes a pose from a position and a quaternion.
 * @param[out] out The pose.
 * @param origin World mm.
 * @param wxyz w, x, y, z; any length but 0.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a number that is not finite, and for a quaternion of length 0. */
CONUS_CHECKED conus_status conus_pose_from_quaternion(conus_pose *out, const double origin[3], const double wxyz[4]);

/** Turns a device about its axis as its space has it (Eq. 2): its frame is made in the axes of the space. Up is dorsal
 * there, and not the world's z. Where the atlas's world is a mirror image of the space, as that of BrainGlobe's folders
 * is of #CONUS_SPACE_CCF, the device's x comes to lie on the other side: the pose is then left-handed. Such a pose is
 * the same device at the same place in each form of an atlas; all functions that take a pose take it. In
 * #CONUS_SPACE_RAS and #CONUS_SPACE_LPS a pose of conus_pose_along() stays as it is.
 * @param[in,out] pose As conus_pose_along() and conus_pose_toward() make it.
 * @param frame The frame.
 * @param has_up It was made with an up vector, which is kept. */
CONUS_API void conus_frame_turn_pose(conus_pose *pose, const conus_frame *frame, bool has_up);
/** @} */

/** @name Files of poses
 * @{ */

typedef struct conus_pose_list conus_pose_list;     /**< Poses read from a file. */
typedef struct conus_pose_stream conus_pose_stream; /**< Poses being read. */

/** The axis of a device along which it points. */
typedef enum conus_axis {
    CONUS_AXIS_OF_FORMAT = 0, /**< As the file's format has it (docs/formats.md): -z where nothing is said. */
    CONUS_AXIS_PLUS_X,        /**< +x. */
    CONUS_AXIS_MINUS_X,       /**< -x. */
    CONUS_AXIS_PLUS_Y,        /**< +y. */
    CONUS_AXIS_MINUS_Y,       /**< -y. */
    CONUS_AXIS_PLUS_Z,        /**< +z. */
    CONUS_AXIS_MINUS_Z        /**< -z. */
} conus_axis;

struct conus_place;         /* below */
struct conus_place_options; /* below */

/** As conus_place_find(). */
typedef conus_status (*conus_place_finder)(struct conus_place *out, const conus_atlas *atlas, const char *text,
                                           const struct conus_place_options *options);

typedef struct conus_scalp conus_scalp; /**< Somebody's scalp, with the positions of the 10-10 system on it. */

/** How files of poses are read. */
typedef struct conus_pose_options {
    size_t struct_size;       /**< Its size, as #CONUS_POSE_OPTIONS_INIT sets it; 0 = that of this version. */
    conus_space space;        /**< Space of the numbers in the file, where it does not say so itself. */
    conus_axis axis;          /**< Where the file gives rotations. */
    const char *format;       /**< The format (docs/formats.md), a name of conus_list_choices(): "table", "matrix",
                                 "brainsight" and so on; NULL = "auto", the content decides. */
    bool along_shafts;        /**< "electrodes": not points, but poses at the contacts that point along
                                 their shafts, each to the contact with the next higher number. */
    uint64_t max_memory;      /**< Largest file of a format that is read whole, in bytes; 0 = 1 GiB. */
    conus_log log;            /**< Receives what a careful user should know, while the file is opened and from
                                 conus_pose_list_match(); NULL = no callback. */
    void *log_user;           /**< Passed to @p log; must outlive the stream or list. */
    const conus_frame *frame; /**< Where the space of the numbers in the file lies, instead of @p space; copied. NULL =
                                 @p space, which then is #CONUS_SPACE_RAS or #CONUS_SPACE_LPS. In #CONUS_SPACE_CCF and
                                 #CONUS_SPACE_BREGMA a file has no rotations. */
    bool to_target;           /**< A row's range ends where it has its target (conus_pose_row.target_mm) unless the row
                                 says otherwise; one with a direction alone has an error. Not of candidates. */
    double near;              /**< With @p to_target: where the range begins, mm, */
    double beyond;            /**< and how far behind the target it ends, mm. */
    double aperture;          /**< With @p to_target: a row without an angle of its own has that of a cone that is so
                                 wide, mm, where it has its target; 0 = none. */
    const char *const *keep;  /**< [keep_count] Names of columns of a table whose texts are in conus_pose_row.kept. They
                                 must live until the file is opened. */
    size_t keep_count;        /**< How many, up to 64; 0 = none. Another format than a table with a header has none. */
    double longest; /**< Longest edge of the atlas, mm, by which numbers of tables and lists are judged (micrometres,
                       centimetres, sides); 0 = not known: what needs it is not asked of a table. */
    const char *columns; /**< Of a table, beating what is said below and in the file: "x=COLUMN,y=COLUMN,z=COLUMN" of
                            points, "name=COLUMN", "place=COLUMN" (of names of places), "unit=mm" (um, cm, m),
                            "depth=um" and "radius=um" (of these columns), "tilt_ml=COLUMN", "tilt_ap=COLUMN" (the other
                            one is 0), "sides=anyway", with commas between, in any order; NULL = none. A path may end in
                            it, too: "FILE,x=COLUMN,...". */
    double unit;    /**< mm per unit of the numbers in a table, as the caller knows it; 0 = as the file says, or that of
                       the space. */
    bool any_space; /**< Ignore what titles, comments, headers and columns say of the brain. */
    bool of_mni305; /**< The atlas is of MNI 305: positions of that brain stay where they are, and are not moved to MNI
                       152. */
    bool all_rows;  /**< "electrodes": a contact without a position (n/a) is a row with an error, for an
                       answer that has a row for each row of the table; otherwise it is passed over, with a note. */
    const conus_atlas *atlas;      /**< With @p find_place: where it finds places whose names stand in a table or a list
                                      in place of coordinates ("area,value", or a name a line), each row a point. It must
                                      outlive the stream and lie where it is asked. NULL = only names of positions of a
                                      cap are places, on the head of MNI 152. */
    conus_place_finder find_place; /**< conus_place_find() where @p atlas is given. */
    bool inward; /**< A point is a pose that points straight into the head: from a position of a cap that is called by
                    its name against the normal there, elsewhere as conus_atlas_inward() of @p atlas says. */
    const conus_scalp *scalp; /**< With @p find_place: where positions of a cap lie; it must outlive the stream. NULL =
                                 on the head of MNI 152. */
} conus_pose_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_POSE_OPTIONS_INIT CONUS_INIT_(conus_pose_options)

/** One row of a pose file. */
typedef struct conus_pose_row {
    const char *id;    /**< Column query_id, or the row's number from 1. Ids may repeat. */
    size_t line;       /**< Line in the file, from 1; of "markups" the markup, of MATLAB's files
                            the row. */
    conus_pose pose;   /**< Where the device is and points. */
    bool is_point;     /**< The row has only a position, no direction: the pose is not turned. */
    bool trigger;      /**< Column trigger; false if absent. */
    double angle;      /**< Column angle, full opening, degrees; 0 if absent. */
    double time_s;     /**< Column time_s, seconds; NaN if absent. */
    double error_deg;  /**< Column error_deg: how far off the direction may be, degrees; NaN if absent. */
    double error_mm;   /**< Column error_mm: how far off the position may be, mm; NaN if absent. */
    double range[2];   /**< Columns near and far, mm, as for conus_selector_set_range(); NaN if absent. */
    const char *error; /**< NULL, or why the row is no pose; then only id and line have a meaning. */
    uint64_t entry;    /**< Number of the entry, from 1, with conus_candidates_open(); 0 in a file's row. */
    uint64_t target;   /**< Number of the target, from 1, with conus_candidates_open(); 0 without one. */
    double normal[3];  /**< Outward at the entry, world, of length 1; NaN where it has none. Of a position of a cap that
                            is called by its name the normal there; 0 where that is not known. */
    double target_mm;  /**< How far the point is at which it points, mm; NaN where the file has only a direction. */
    const char *const *kept; /**< [conus_pose_options.keep_count] Texts of the columns that are kept, "" of an empty
                                cell; NULL without them, and in some rows with an error. */
    double radius; /**< Column radius of a point, mm: of the ball that is asked, 0 = what is at it; NaN if absent. */
    double aim[3]; /**< Columns aim_x, aim_y, aim_z: the point that was aimed at, world, mm; NaN if absent. */
} conus_pose_row;
/** @} */

/** @name Streams
 * A stream reads tables and points of any length in memory that does not grow, and other formats whole. It belongs to
 * one thread at a time.
 * @{ */

/** Opens poses for reading one block after the other. A file without any pose opens, too, unless nothing in it tells
 * its format.
 * @param[out] out The stream; end it with conus_pose_stream_destroy().
 * @param path A file or a pipe; NULL or "-" is standard input. ",x=COLUMN,y=COLUMN,..." behind it is
 * conus_pose_options.columns, unless a file is called so.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO, #CONUS_ERROR_DATA or #CONUS_ERROR_UNSUPPORTED for a file that cannot be read;
 * #CONUS_ERROR_MEMORY above max_memory. */
CONUS_CHECKED conus_status conus_pose_stream_open(conus_pose_stream **out, const char *path,
                                                  const conus_pose_options *options);

/** Reads the next rows. A bad row is given with its error.
 * @param[out] rows [capacity] The first @p count of them are filled. Their strings live until the next call on the
 * stream.
 * @param[out] count Rows read: fewer than @p capacity only at the end, 0 when there are no more.
 * @param stream The stream.
 * @param capacity At least 1.
 * @return #CONUS_OK; #CONUS_ERROR_IO also where the file changes before all of it is read. */
CONUS_CHECKED conus_status conus_pose_stream_read(conus_pose_row *rows, size_t *count, conus_pose_stream *stream,
                                                  size_t capacity);

/** Ends a live stream behind the last whole line that has come, also for a thread that waits for the next one. On other
 * streams it has no effect.
 * @param stream The stream.
 * @threads Any, at any time, and a signal handler. */
CONUS_API void conus_pose_stream_stop(conus_pose_stream *stream);

/** Ends a stream.
 * @param stream NULL is allowed. */
CONUS_API void conus_pose_stream_destroy(conus_pose_stream *stream);
/** @} */

/** @name Lists
 * A list holds all rows of a file.
 * @{ */

/** Reads all rows of conus_pose_stream_open(); there may be none.
 * @param[out] out The list; end it with conus_pose_list_destroy().
 * @param path As for conus_pose_stream_open().
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_pose_stream_open() and conus_pose_stream_read(). */
CONUS_CHECKED conus_status conus_pose_list_load(conus_pose_list **out, const char *path,
                                                const conus_pose_options *options);

/** Counts the rows.
 * @param list NULL counts 0.
 * @return How many rows there are. */
CONUS_API size_t conus_pose_list_count(const conus_pose_list *list);

/** Gives row @p index.
 * @param list The list.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the list. */
CONUS_API const conus_pose_row *conus_pose_list_row(const conus_pose_list *list, size_t index);

/** Checks that the file and the atlas belong to one brain. Adds a note where one of them does not name its space. A
 * file that names no space fits any atlas; a scan of one person fits an atlas that was moved (conus_atlas_move()).
 * @param list The list.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA where they name different brains, a scan of one person and a template, say. */
CONUS_CHECKED conus_status conus_pose_list_match(conus_pose_list *list, const conus_atlas *atlas);

/** Ends a list.
 * @param list NULL is allowed. */
CONUS_API void conus_pose_list_destroy(conus_pose_list *list);
/** @} */

/** @name Places
 * Points as people say them: numbers, a voxel, an area by its name, a position of the 10-20 system of caps.
 * @{ */

/** What a place is. */
typedef enum conus_place_kind {
    CONUS_PLACE_NUMBERS = 0, /**< Three numbers. */
    CONUS_PLACE_INNER,       /**< The inner point of an area: #CONUS_SITES_DEEPEST. */
    CONUS_PLACE_CENTROID,    /**< The centroid of an area, which lies in it. */
    CONUS_PLACE_NEAR,        /**< The point of an area that is nearest to another place. */
    CONUS_PLACE_POSITION     /**< A position of the 10-10 system, on the scalp of MNI 152. */
} conus_place_kind;

/** A point, and how its words were understood. */
typedef struct conus_place {
    conus_place_kind kind; /**< Which kind. */
    double point[3];       /**< World mm. */
    uint32_t object;       /**< Number of the area or pathway; 0 = none. */
    double depth;          /**< #CONUS_PLACE_INNER: mm from the point to what is not the area; else NaN. */
    const char *name;      /**< Name of the area, borrowed from the atlas, or of the position, static; else "". */
    double outward[3];     /**< #CONUS_PLACE_POSITION: the direction away from the head, world, of length 1; all 0 where
                              it is not known, and of other kinds. */
    bool is_also_named;    /**< The words also name something else: numbers an area, an area a position. */
    bool is_doubtful;      /**< They say MNI, and it is not known whether the atlas lies there. */
    bool is_on_scalp;      /**< #CONUS_PLACE_POSITION: found on a scalp, not on the head of MNI 152. */
    const char *toward;    /**< Of a way along the scalp from the position: that towards which it goes, static; else
                              NULL. */
    double way_mm;         /**< How far it goes; 0 where there is none. */
} conus_place;

/** How conus_place_find() reads. */
typedef struct conus_place_options {
    size_t struct_size;       /**< Its size, as #CONUS_PLACE_OPTIONS_INIT sets it; 0 = that of this version. */
    const conus_frame *frame; /**< Space and unit of numbers; NULL = the world. */
    const double *other;      /**< [3] World mm: the place to which near:AREA is nearest; NULL = there is none. */
    bool has_axis;            /**< There is another end, so that messages may advise near:AREA. */
    const conus_scalp *scalp; /**< Where positions lie, on the head of the atlas; NULL = on the head of MNI 152. */
} conus_place_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_PLACE_OPTIONS_INIT CONUS_INIT_(conus_place_options)

/** Bytes of conus_place_text(), whose declaration has the number: Python reads declarations, and no macros. */
#define CONUS_PLACE_TEXT 512

/**
 * Finds the point that a text means:
 *
 *  - three numbers as people paste them, in the space of the frame: "-42,-20,50", "(-42 -20 50)", "42L 20P 50S";
 *  - an area or pathway, as conus_atlas_find() finds it, or as "index:17" by its label: its inner point, whether it is
 *    hidden or not. An area of which 20 % or more lie on each side, and whose name says none, has none, unless it is
 *    nearer to the midline than half its depth in an atlas some of whose areas have a side; nor has one without a side
 *    where the midline is not known: x = 0 is an edge of the areas' grid, and the brain is none that conus knows;
 *  - "centroid:AREA": its centroid, if that lies in it;
 *  - "near:AREA": the centre of its voxel, or the point of its surface, that is nearest to another place;
 *  - a position of the 10-10 system, "C3", where the atlas is known to lie in MNI 152 or Colin 27 and none of its areas
 *    is called so, or "1020:C3" where its brain is not known;
 *  - with a scalp "C3>F3:50": 50 mm from C3 towards F3, and on, along the scalp as a tape lies (Eq. 35).
 * @param[out] out The point.
 * @param atlas Where it is, as it lies in the world now.
 * @param text UTF-8.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a text that means nothing or several things, with these and the words
 * that choose; #CONUS_ERROR_DATA for numbers that conus_frame_to_world() refuses; #CONUS_ERROR_MEMORY.
 */
CONUS_CHECKED conus_status conus_place_find(conus_place *out, const conus_atlas *atlas, const char *text,
                                            const conus_place_options *options);

/** Says how a place was understood: "Hippocampus_L: (-27.0, -13.0, -15.0), 6.0 mm inside".
 * @param[out] out [#CONUS_PLACE_TEXT] The text, without a line's end, cut where it is too long.
 * @param place The place.
 * @param frame Space and unit of the numbers; NULL = the world. */
CONUS_API void conus_place_text(char out[512], const conus_place *place, const conus_frame *frame);

/** Points whose names say where they are, and how far from there they lie. */
typedef struct conus_name_gap {
    size_t named;       /**< How many. */
    double median;      /**< mm; of an even number the greater of the two in the middle. 0 where there are none. */
    size_t farthest;    /**< Index of the row that is farthest, */
    double farthest_mm; /**< and how far it is. */
    bool is_far;        /**< The median is over 15 mm for areas, or 40 mm for positions: another space or unit, other
                           axes or sides. */
} conus_name_gap;

/** What the names of a list of points say. */
typedef struct conus_name_check {
    conus_name_gap areas;     /**< Names of areas and pathways: mm to them, 0 inside. */
    conus_name_gap positions; /**< Names of positions of the 10-10 system: mm to these. */
} conus_name_check;
/** @} */

/** @name Probes
 * @{ */

typedef struct conus_probe conus_probe; /**< The probes of a file of ProbeInterface or of a recording. Immutable. */

/** How conus_probe_load() reads. */
typedef struct conus_probe_options {
    size_t struct_size;  /**< Its size, as #CONUS_PROBE_OPTIONS_INIT sets it; 0 = that of this version. */
    double tip;          /**< mm from the tip of each probe to its lowest contact, up to 1000, in place of its contour;
                            0 = by the contour, which it then must have. Of a recording to the lowest row of the probe,
                            recorded or not; 0 = by its part number. */
    uint64_t max_memory; /**< Largest file, bytes; 0 = 1 GiB. */
} conus_probe_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_PROBE_OPTIONS_INIT CONUS_INIT_(conus_probe_options)

/** Loads a file of ProbeInterface, or the probes of a recording: SpikeGLX's .ap.meta or .imro, Open Ephys's
 * settings.xml (docs/formats.md).
 * @param[out] out The probes; end them with conus_probe_destroy().
 * @param path A file.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO or #CONUS_ERROR_DATA for a file that cannot be read, contradicts itself or has no
 * contour, where that is needed; #CONUS_ERROR_ARGUMENT for a tip out of its range; #CONUS_ERROR_MEMORY above
 * max_memory. */
CONUS_CHECKED conus_status conus_probe_load(conus_probe **out, const char *path, const conus_probe_options *options);

/** Ends the probes.
 * @param probe NULL is allowed. */
CONUS_API void conus_probe_destroy(conus_probe *probe);

/** Lists the contacts, in the order of the file.
 * @param[out] out Columns id (that of no other in the file: "e7", of several probes "probe2:e7"), probe, number (of the
 * probe, from 1), shank_id, channel, x_um, y_um, z_um (as in the file), offset_x, offset_y, offset_z (mm from the
 * probe's tip in the device's frame, Eq. 2). Its part "tips" has x_um, y_um, z_um of each probe's tip: the lowest point
 * of its contour, in the middle of an edge that is as low; of several that are as low, shanks side by side, that of the
 * least x. End it with conus_table_destroy().
 * @param probe The probes.
 * @return #CONUS_OK; #CONUS_ERROR_MEMORY. */
CONUS_CHECKED conus_status conus_probe_table(conus_table **out, const conus_probe *probe);

/** Puts the contacts where poses say: the tip at the pose's position, the shank along its axis, from base to tip, and
 * the probe's x axis along the device's +x.
 * @param[out] out A point for each contact, with its id; its line is its number from 1. End it with
 * conus_pose_list_destroy().
 * @param probe The probes.
 * @param poses [count] One for each probe.
 * @param count As many as there are probes.
 * @param roll Turns each probe about its axis, its +y towards its +x, degrees: as conus_candidates.roll_step.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another number of poses, and for a turn or a pose that is not finite. */
CONUS_CHECKED conus_status conus_probe_place(conus_pose_list **out, const conus_probe *probe, const conus_pose *poses,
                                             size_t count, double roll);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
