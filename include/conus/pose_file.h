/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file pose_file.h
 * Files of poses: a stream reads them block by block, a list reads them whole.
 */
#ifndef CONUS_PUBLIC_POSE_FILE_H
#define CONUS_PUBLIC_POSE_FILE_H

#include <conus/atlas.h>
#include <conus/pose.h>
#include <conus/space.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

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

/** The format of a file of poses; docs/formats.md describes each. */
typedef enum conus_pose_format {
    CONUS_POSE_FORMAT_AUTO = 0,   /**< The content decides. */
    CONUS_POSE_FORMAT_TABLE,      /**< A table (TSV or CSV) whose header row names the columns. */
    CONUS_POSE_FORMAT_MATRIX,     /**< Sixteen numbers, a row-major world_from_device. */
    CONUS_POSE_FORMAT_POINTS,     /**< Lines of x y z and perhaps a name: points. */
    CONUS_POSE_FORMAT_BRAINSIGHT, /**< Brainsight's export: targets, samples, electrodes. */
    CONUS_POSE_FORMAT_LOCALITE,   /**< Localite's InstrumentMarker*.xml and TriggerMarkers*.xml. */
    CONUS_POSE_FORMAT_ELECTRODES, /**< BIDS *_electrodes.tsv, with the *_coordsystem.json beside it: points. */
    CONUS_POSE_FORMAT_MARKUPS,    /**< 3D Slicer's .mrk.json: lines, and points; .fcsv: points. */
    CONUS_POSE_FORMAT_SIMNIBS,    /**< SimNIBS's matsimnibs, in MATLAB's files or as text. */
    CONUS_POSE_FORMAT_NIBS,       /**< The proposal NIBS-BIDS: *_markers.tsv, with the *_coordsystem.json beside it. */
    CONUS_POSE_FORMAT_INVESALIUS, /**< InVesalius's markers, .mkss. */
    CONUS_POSE_FORMAT_LEAD_DBS,   /**< Lead-DBS's reconstruction: contacts in MNI space, points. */
    CONUS_POSE_FORMAT_LEAD_DBS_NATIVE, /**< The same in the patient's own space. */
    CONUS_POSE_FORMAT_IBL, /**< The International Brain Laboratory's xyz_picks.json and channel_locations.json:
                                     points, in #CONUS_SPACE_CCF or #CONUS_SPACE_BREGMA only. */
    CONUS_POSE_FORMAT_NWB, /**< Electrodes of Neurodata Without Borders: points, in the same spaces only. */
    CONUS_POSE_FORMAT_LIST /**< Lists of other programs whose columns are known by their place: points. */
} conus_pose_format;

/**
 * Names the formats, for a program's options.
 * @param index From 0, as #conus_pose_format.
 * @return "auto", "table" and so on; NULL past the last. Static.
 * @threads Any.
 * @since 0.1
 */
CONUS_API const char *conus_pose_format_name(size_t index);

struct conus_place;         /* conus/place.h, which includes this */
struct conus_place_options; /* likewise */

/** As conus_place_find(). */
typedef conus_status (*conus_place_finder)(struct conus_place *out, const conus_atlas *atlas, const char *text,
                                           const struct conus_place_options *options);

/** How files of poses are read. */
typedef struct conus_pose_options {
    size_t struct_size;       /**< Its size, as #CONUS_POSE_OPTIONS_INIT sets it; 0 = that of this version. */
    conus_space space;        /**< Space of the numbers in the file, where it does not say so itself. */
    conus_axis axis;          /**< Where the file gives rotations. */
    conus_pose_format format; /**< The format. */
    bool along_shafts;        /**< #CONUS_POSE_FORMAT_ELECTRODES: not points, but poses at the contacts that point along
                                 their shafts, each to the contact with the next higher number. */
    uint64_t max_memory;      /**< Largest file of a format that is read whole, in bytes; 0 = 1 GiB. */
    conus_log log;            /**< Receives the notes of conus_pose_stream_note(), while the file is opened and from
                                 conus_pose_stream_match() and conus_pose_list_match(); NULL = no callback. */
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
    bool any_space; /**< What titles, comments, headers and columns say of the brain is not heard. */
    bool of_mni305; /**< The atlas is of MNI 305: positions of that brain stay where they are, and are not moved to MNI
                       152. */
    bool all_rows; /**< #CONUS_POSE_FORMAT_ELECTRODES: a contact without a position (n/a) is a row with an error, for an
                      answer that has a row for each row of the table; otherwise it is passed over, with a note. */
    const conus_atlas *atlas;      /**< With @p find_place: where it finds places whose names stand in a table or a list
                                      in place of coordinates ("area,value", or a name a line), each row a point. It must
                                      outlive the stream and lie where it is asked. NULL = only names of positions of a
                                      cap are places, on the head of MNI 152. */
    conus_place_finder find_place; /**< conus_place_find() where @p atlas is given. */
    bool inward; /**< A point is a pose that points straight into the head: from a position of a cap that is called by
                    its name against the normal there, elsewhere as conus_atlas_inward() of @p atlas says. */
} conus_pose_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_POSE_OPTIONS_INIT CONUS_INIT_(conus_pose_options)

/** One row of a pose file. */
typedef struct conus_pose_row {
    const char *id;    /**< Column query_id, or the row's number from 1. Ids may repeat. */
    size_t line;       /**< Line in the file, from 1; of #CONUS_POSE_FORMAT_MARKUPS the markup, of MATLAB's files
                            the row. */
    conus_pose pose;   /**< Where the device is and points. */
    bool is_point;     /**< The row has only a position, no direction: the pose is not turned. */
    bool trigger;      /**< Column trigger; false if absent. */
    double angle;      /**< Column angle, full opening, radians; 0 if absent. */
    double time_s;     /**< Column time_s, seconds; NaN if absent. */
    double error_deg;  /**< Column error_deg: how far off the direction may be, degrees (not radians); NaN if absent. */
    double error_mm;   /**< Column error_mm: how far off the position may be, mm; NaN if absent. */
    double range[2];   /**< Columns near and far, mm, as for conus_selector_set_range(); NaN if absent. */
    const char *error; /**< NULL, or why the row is no pose; then only id and line have a meaning. */
    uint64_t entry;    /**< Number of the entry, from 1, with conus_candidates_open(); 0 in a file's row. */
    uint64_t target;   /**< Likewise of the target; 0 without one. */
    double normal[3];  /**< Outward at the entry, world, of length 1; NaN where it has none. Of a position of a cap that
                            is called by its name likewise; 0 where that is not known. */
    double target_mm;  /**< How far the point is at which it points, mm; NaN where the file has only a direction. */
    const char *const *kept; /**< [conus_pose_options.keep_count] Texts of the columns that are kept, "" of an empty
                                cell; NULL without them, and in some rows with an error. */
    double radius; /**< Column radius of a point, mm: of the ball that is asked, 0 = what is at it; NaN if absent. */
} conus_pose_row;

/** @name Streams
 * A stream reads tables and points of any length in memory that does not grow, and other formats whole. It belongs to
 * one thread at a time.
 * @{ */

/**
 * Finds where the words of conus_pose_options.columns begin behind a path.
 * @param path "FILE,x=COLUMN,...".
 * @return The length of FILE; that of all of @p path where there are no such words, or a file is called so.
 * @threads Any.
 * @since 0.1
 */
CONUS_API size_t conus_pose_path_length(const char *path);

/**
 * Opens poses for reading one block after the other. A file without any pose opens, too, unless nothing in it tells
 * its format.
 * @param[out] out The stream; end it with conus_pose_stream_destroy().
 * @param path A file or a pipe; NULL or "-" is standard input. ",x=COLUMN,y=COLUMN,..." behind it is
 * conus_pose_options.columns, unless a file is called so.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO, #CONUS_ERROR_DATA or #CONUS_ERROR_UNSUPPORTED for a file that cannot be read;
 * #CONUS_ERROR_MEMORY above max_memory.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_stream_open(conus_pose_stream **out, const char *path,
                                                  const conus_pose_options *options);

/**
 * Reads the next rows. A bad row is given with its error.
 * @param[out] rows [capacity] The first @p count of them are filled. Their strings live until the next call on the
 * stream.
 * @param[out] count Rows read: fewer than @p capacity only at the end, 0 when there are no more.
 * @param stream The stream.
 * @param capacity At least 1.
 * @return #CONUS_OK; #CONUS_ERROR_IO also where the file changes before all of it is read.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_stream_read(conus_pose_row *rows, size_t *count, conus_pose_stream *stream,
                                                  size_t capacity);

/**
 * Passes over rows without parsing them, which is much faster.
 * @param stream The stream.
 * @param rows How many; where fewer are left, all of these.
 * @return #CONUS_OK; the errors of conus_pose_stream_read().
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_stream_skip(conus_pose_stream *stream, uint64_t rows);

/**
 * Counts all rows, those already read included.
 * @param[out] count How many rows there are.
 * @param stream The stream.
 * @return #CONUS_OK; #CONUS_ERROR_UNSUPPORTED for a live stream.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_stream_count(uint64_t *count, conus_pose_stream *stream);

/**
 * Returns whether the stream is live: it reads rows from a pipe as they come.
 * @param stream The stream.
 * @return Whether it is.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API bool conus_pose_stream_is_live(const conus_pose_stream *stream);

/**
 * Ends a live stream behind the last whole line that has come, also for a thread that waits for the next one. On other
 * streams it has no effect.
 * @param stream The stream.
 * @threads Any, at any time, and a signal handler.
 * @since 0.1
 */
CONUS_API void conus_pose_stream_stop(conus_pose_stream *stream);

/**
 * Gives the format of the poses.
 * @param stream The stream.
 * @return Never #CONUS_POSE_FORMAT_AUTO.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API conus_pose_format conus_pose_stream_format(const conus_pose_stream *stream);

/**
 * Gives the space as the file names it.
 * @param stream The stream.
 * @return "NIfTI:Scanner", "MNI152NLin2009cAsym"; "" if the file names none. Borrowed from the stream.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API const char *conus_pose_stream_space(const conus_pose_stream *stream);

/**
 * Returns whether rows may have a time_s.
 * @param stream The stream.
 * @return False for a table without that column and for formats without times, and where everything was read and no
 * row has one.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API bool conus_pose_stream_has_times(const conus_pose_stream *stream);

/**
 * Returns whether two rows may have one id.
 * @param stream The stream.
 * @return False for a table without a column that names its rows, whose ids are their numbers, and where everything was
 * read and no two rows have one id.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API bool conus_pose_stream_may_repeat_ids(const conus_pose_stream *stream);

/**
 * Returns whether rows may have an angle of their own.
 * @param stream The stream.
 * @return False for a table without that column and for formats without angles.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API bool conus_pose_stream_has_angles(const conus_pose_stream *stream);

/**
 * Returns whether rows may have a range of their own.
 * @param stream The stream.
 * @return False for a table without the columns near and far or targets that are ends, and where everything was read
 * and no row has one.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API bool conus_pose_stream_has_ranges(const conus_pose_stream *stream);

/**
 * Returns whether rows may have a radius of their own.
 * @param stream The stream.
 * @return False for a table without that column and for other formats.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API bool conus_pose_stream_has_radii(const conus_pose_stream *stream);

/**
 * Returns whether rows may be points, which have no direction.
 * @param stream The stream.
 * @return False for a table and a matrix, and where everything was read and no row is a point.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API bool conus_pose_stream_has_points(const conus_pose_stream *stream);

/**
 * Gives rows that it has read, for conus_places_check().
 * @param stream The stream.
 * @return The first 64; of a format that is read whole all rows. Borrowed; it changes with conus_pose_stream_read().
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API const conus_pose_list *conus_pose_stream_head(const conus_pose_stream *stream);

/**
 * Gives the table of electrodes (BIDS) that was read, for conus_report_options.electrodes.
 * @param stream The stream.
 * @return NULL for other formats. Borrowed from the stream.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API const char *conus_pose_stream_electrodes(const conus_pose_stream *stream);

/**
 * Gives the path of the *_coordsystem.json that says what the positions of electrodes or markers (BIDS) are in.
 * @param stream The stream.
 * @return "" where there is none. Borrowed from the stream.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API const char *conus_pose_stream_coordsystem(const conus_pose_stream *stream);

/**
 * Gives the SHA-256 of that file as it was read.
 * @param stream The stream.
 * @return Hexadecimal; "" where there is no such file. Borrowed from the stream.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API const char *conus_pose_stream_coordsystem_sha256(const conus_pose_stream *stream);

/**
 * Computes the SHA-256 of the file of the poses: of the bytes that this stream has read, and of the rest, which it
 * reads now, so that there are no rows afterwards.
 * @param[out] out Hexadecimal with a final NUL.
 * @param stream The stream.
 * @return #CONUS_OK; #CONUS_ERROR_UNSUPPORTED for a pipe.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_stream_sha256(char out[65], conus_pose_stream *stream);

/**
 * Checks that the file and the atlas belong to one brain. Adds a note where one of them does not name its space. A file
 * that names no space fits any atlas; a scan of one person fits an atlas that was moved (conus_atlas_move()).
 * @param stream The stream.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA where they name different brains, a scan of one person and a template, say.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_stream_match(conus_pose_stream *stream, const conus_atlas *atlas);

/**
 * Gives note @p index that a careful user should know about these poses.
 * @param stream The stream.
 * @param index From 0.
 * @return One line; NULL past the last. Borrowed from the stream.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API const char *conus_pose_stream_note(const conus_pose_stream *stream, size_t index);

/**
 * Tells how much note @p index matters. A warning says that an answer may name another place or another area than the
 * data mean.
 * @param stream The stream.
 * @param index From 0.
 * @return #CONUS_SEVERITY_NOTE also past the last.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API conus_severity conus_pose_stream_note_severity(const conus_pose_stream *stream, size_t index);

/**
 * Ends a stream.
 * @param stream NULL is allowed.
 * @threads One at a time for each @p stream.
 * @since 0.1
 */
CONUS_API void conus_pose_stream_destroy(conus_pose_stream *stream);
/** @} */

/** @name Lists
 * A list holds all rows of a file.
 * @{ */

/**
 * Reads all rows of conus_pose_stream_open(); there may be none.
 * @param[out] out The list; end it with conus_pose_list_destroy().
 * @param path As for conus_pose_stream_open().
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_pose_stream_open() and conus_pose_stream_read().
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_list_load(conus_pose_list **out, const char *path,
                                                const conus_pose_options *options);

/**
 * Counts the rows.
 * @param list NULL counts 0.
 * @return How many rows there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_pose_list_count(const conus_pose_list *list);

/**
 * Gives row @p index.
 * @param list The list.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the list.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_pose_row *conus_pose_list_row(const conus_pose_list *list, size_t index);

/**
 * Gives the table of electrodes, as conus_pose_stream_electrodes().
 * @param list The list.
 * @return NULL for other formats. Borrowed from the list.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const char *conus_pose_list_electrodes(const conus_pose_list *list);

/**
 * Gives the path of the coordinate system, as conus_pose_stream_coordsystem().
 * @param list The list.
 * @return "" where there is none. Borrowed from the list.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const char *conus_pose_list_coordsystem(const conus_pose_list *list);

/**
 * Gives the space that the file names, as conus_pose_stream_space().
 * @param list The list.
 * @return "" where it names none. Borrowed from the list.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const char *conus_pose_list_space(const conus_pose_list *list);

/**
 * Checks that the file and the atlas belong to one brain, as conus_pose_stream_match().
 * @param list The list.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA where they name different brains.
 * @threads One at a time for each @p list.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_pose_list_match(conus_pose_list *list, const conus_atlas *atlas);

/**
 * Gives a note, as conus_pose_stream_note().
 * @param list The list.
 * @param index From 0.
 * @return One line; NULL past the last. Borrowed from the list.
 * @threads One at a time for each @p list.
 * @since 0.1
 */
CONUS_API const char *conus_pose_list_note(const conus_pose_list *list, size_t index);

/**
 * Tells how much note @p index matters. A warning says that an answer may name another place or another area than the
 * data mean.
 * @param list The list.
 * @param index From 0.
 * @return #CONUS_SEVERITY_NOTE also past the last.
 * @threads One at a time for each @p list.
 * @since 0.1
 */
CONUS_API conus_severity conus_pose_list_note_severity(const conus_pose_list *list, size_t index);

/**
 * Ends a list.
 * @param list NULL is allowed.
 * @threads One at a time for each @p list.
 * @since 0.1
 */
CONUS_API void conus_pose_list_destroy(conus_pose_list *list);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
