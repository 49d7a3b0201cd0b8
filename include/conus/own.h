/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file own.h
 * What only conus's own programs and its Python package call. The library exports it, nothing installs it, and it may
 * change with any commit: programs and package are of the version of the library.
 *
 * The conventions of conus.h hold, and comments say what goes beyond them. Of a conus_status, "@return" lists the
 * errors. A struct_size is 0, which is that of this version, or as the INIT of its struct sets it.
 */
#ifndef CONUS_PUBLIC_OWN_H
#define CONUS_PUBLIC_OWN_H

#include <conus/conus.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Batches: streams of poses to text, in the threads that answer */

typedef struct conus_batch conus_batch; /**< Threads made ready to answer poses by the million. */

/** How a batch answers. */
typedef struct conus_batch_options {
    size_t struct_size;
    uint32_t threads; /**< Threads that answer poses, up to 1024; 0 = as many as processors that the process may use.
                         With the gl engine one of them has the device at a time. */
    uint32_t block;   /**< Poses per block, up to 65536; 0 = 256. Memory grows with threads times block. */
    double angle;     /**< For poses that have none of their own, degrees; 0 = 10 degrees, or a cylinder's 0. */
    conus_report_options report; /**< Its format is neither "table" nor "json". A probe,
                                    "spikeglx" or "open-ephys", is one block of up to 65535
                                    contacts, whatever block says, and must be all that is in the stream. With a
                                    probe, one of a file, it is put at each pose of the stream: its contacts are asked,
                                    within the selector's radius, and called as the pose, a colon and the contact;
                                    poses are still counted as they are in the stream, and blocks have so many contacts.
                                    Formats of other programs have no place for that. */
    const char *point_error; /**< Why a pose that is a point has no answer, for its row of kind "error"; NULL = it is
                                asked what is at it, or within the selector's radius of it: conus_select_ball(). */
} conus_batch_options;
#define CONUS_BATCH_OPTIONS_INIT CONUS_INIT_(conus_batch_options)

/** A block of poses, answered. */
typedef struct conus_batch_block {
    const char *text; /**< Their rows, without the header row. */
    size_t size;      /**< Bytes of text. */
    uint64_t poses;   /**< How many poses. */
    uint64_t errors;  /**< Poses among them that have no answer but a row of kind "error". */
    uint64_t line;    /**< Line of the first of these in its file, counted from 1, */
    const char *why;  /**< and why it has no answer; NULL where errors is 0. */
} conus_batch_block;

/** Receives whole blocks in the order of the poses, on the thread that called conus_batch_run().
 * @param user The pointer that conus_batch_run() got.
 * @param block The block. Valid until the callback returns.
 * @return False ends the run with #CONUS_ERROR_CANCELLED. */
typedef bool (*conus_batch_sink)(void *user, const conus_batch_block *block);

/** Prepares to answer with a selector.
 * @param selector Must outlive the batch and is not to be used during a run.
 * @param options Its report names the format, which must be given. Its strings must outlive the batch.
 * @return #CONUS_ERROR_ARGUMENT for an option out of its range. */
CONUS_CHECKED conus_status conus_batch_create(conus_batch **out, conus_selector *selector,
                                              const conus_batch_options *options);

/** Adds another atlas: for each pose its rows come behind those of the atlases before it. Before the first run.
 * @param batch Its options have a name in report.atlas.
 * @param selector Of the atlas, with the options of the batch's but level. Must outlive the batch and is not to be used
 * during a run.
 * @param atlas Its name for the column `atlas`. Copied.
 * @return #CONUS_ERROR_ARGUMENT for a name that is missing or another's, and for a selector with other options. The
 * batch is unchanged then. */
CONUS_CHECKED conus_status conus_batch_add(conus_batch *batch, conus_selector *selector, const char *atlas);

/** Ends a batch. */
CONUS_API void conus_batch_destroy(conus_batch *batch);

/** Gives the number of threads that will be used. @return At least 1. */
CONUS_API uint32_t conus_batch_threads(const conus_batch *batch);

/** Answers poses, in memory that does not grow with them. The text is the same, byte for byte, for any number of
 * threads and any size of blocks. A pose that cannot be answered gives a row of kind "error". Another failure ends the
 * run; what comes before it has been delivered then. It may be called again, but a live stream ends with a run that the
 * sink or a failure ended.
 * @param limit Poses to answer at most.
 * @param sink Receives the blocks.
 * @return #CONUS_ERROR_ARGUMENT where @p poses keeps another number of columns than the marks of the report have;
 * #CONUS_ERROR_CANCELLED where @p sink ends the run; the errors of conus_pose_stream_read() and conus_select(). */
CONUS_CHECKED conus_status conus_batch_run(conus_batch *batch, conus_pose_stream *poses, uint64_t limit,
                                           conus_batch_sink sink, void *user);

/** Gives the findings about the poses answered so far, by their lines in their file.
 * @param index 0 is the atlas of conus_batch_create(), then those of conus_batch_add() in their order.
 * @return A copy; zero for an index that there is not. */
CONUS_API conus_pose_findings conus_batch_findings(const conus_batch *batch, size_t index);

/** Gives the header row that belongs above the rows, with its end of line. @return "" where there is none. */
CONUS_API const char *conus_batch_header(const conus_batch *batch);

/** Writes the sidecar as of conus_report_sidecar(), without the queries.
 * @param[out] text UTF-8 with a final NUL. Borrowed until the next call on the batch.
 * @param[out] size Bytes, without the NUL. */
CONUS_CHECKED conus_status conus_batch_sidecar(const char **text, size_t *size, conus_batch *batch);

/* Files of poses */

/** Finds where the words of conus_pose_options.columns begin behind a path.
 * @param path "FILE,x=COLUMN,...".
 * @return The length of FILE; that of all of @p path where there are no such words, or a file is called so. */
CONUS_API size_t conus_pose_path_length(const char *path);

/** Passes over rows without parsing them, which is much faster.
 * @param rows How many; where fewer are left, all of these.
 * @return The errors of conus_pose_stream_read(). */
CONUS_CHECKED conus_status conus_pose_stream_skip(conus_pose_stream *stream, uint64_t rows);

/** Counts all rows, those already read included.
 * @param[out] count How many rows there are.
 * @return #CONUS_ERROR_UNSUPPORTED for a live stream. */
CONUS_CHECKED conus_status conus_pose_stream_count(uint64_t *count, conus_pose_stream *stream);

/** What poses are, and what their rows may have. Texts are borrowed from the stream or list. */
typedef struct conus_pose_facts {
    const char *format; /**< As conus_pose_format_name() has it; never "auto", NULL of a list. */
    const char *space;  /**< As the file names it: "NIfTI:Scanner", "MNI152NLin2009cAsym"; "" where it names none. */
    const char *electrodes; /**< The table of electrodes (BIDS) that was read, for conus_report_options.electrodes; NULL
                               for other formats. */
    const char *coordsystem; /**< Path of the *_coordsystem.json that says what the positions of electrodes or markers
                                (BIDS) are in; "" where there is none, */
    const char *coordsystem_sha256; /**< and the SHA-256 of that file as it was read, hexadecimal. */
    const conus_pose_list *head; /**< Rows that a stream has read, for conus_places_check(): the first 64; of a format
                                    that is read whole all. It changes with conus_pose_stream_read(). */
    bool is_live;                /**< A stream that reads rows from a pipe as they come. */
    /* What a row of a stream may have. False for a table without that column and for formats without such a thing, and
     * where everything was read and no row has one. */
    bool has_times;  /**< A time_s. */
    bool has_angles; /**< An angle of its own, */
    bool has_ranges; /**< a range, by the columns near and far or targets that are ends, */
    bool has_radii;  /**< or a radius. */
    bool has_points; /**< No direction: it is a point. */
} conus_pose_facts;

/** Tells about a stream. @return As of now; of NULL what there is of no file. */
CONUS_API conus_pose_facts conus_pose_stream_facts(const conus_pose_stream *stream);

/** Tells about a list. @return The texts; of NULL what there is of no file. */
CONUS_API conus_pose_facts conus_pose_list_facts(const conus_pose_list *list);

/** Returns whether two rows may have one id.
 * @return False for a table without a column that names its rows, whose ids are their numbers, and where everything was
 * read and no two rows have one id. */
CONUS_API bool conus_pose_stream_may_repeat_ids(const conus_pose_stream *stream);

/** Computes the SHA-256 of the file of the poses: of the bytes that this stream has read, and of the rest, which it
 * reads now, so that there are no rows afterwards.
 * @param[out] out Hexadecimal with a final NUL.
 * @return #CONUS_ERROR_UNSUPPORTED for a pipe. */
CONUS_CHECKED conus_status conus_pose_stream_sha256(char out[65], conus_pose_stream *stream);

/** Names the formats, for a program's options.
 * @param index From 0.
 * @return "auto", "table" and so on; NULL past the last. Static. */
CONUS_API const char *conus_pose_format_name(size_t index);

/** Gives note @p index that a careful user should know about these poses. @return One line; NULL past the last. */
CONUS_API const char *conus_pose_stream_note(const conus_pose_stream *stream, size_t index);

/** Tells how much note @p index matters. A warning says that an answer may name another place or another area than the
 * data mean.
 * @return #CONUS_SEVERITY_NOTE also past the last. */
CONUS_API conus_severity conus_pose_stream_note_severity(const conus_pose_stream *stream, size_t index);

/** Gives a note, as conus_pose_stream_note().
 * @return One line; NULL past the last.
 * @threads One at a time for each @p list. */
CONUS_API const char *conus_pose_list_note(const conus_pose_list *list, size_t index);

/** How much it matters, as of conus_pose_stream_note_severity(). */
CONUS_API conus_severity conus_pose_list_note_severity(const conus_pose_list *list, size_t index);

/** Gives the pose that conus_select_many() answers.
 * @param index Below its count.
 * @return As conus_pose_from_matrix() or conus_pose_along(). */
CONUS_CHECKED conus_status conus_pose_array_at(conus_pose *out, const conus_pose_array *poses, size_t index);

/** Checks that the file and the atlas belong to one brain. Adds a note where one of them does not name its space. A
 * file that names no space fits any atlas; a scan of one person fits an atlas that was moved (conus_atlas_move()).
 * @return #CONUS_ERROR_DATA where they name different brains, a scan of one person and a template, say. */
CONUS_CHECKED conus_status conus_pose_stream_match(conus_pose_stream *stream, const conus_atlas *atlas);

/* A window */

/** Computes the camera of an eye that sees through a window, such as that of a tracked head before a screen (Eq. 1).
 * @param[out] camera The camera, for conus_view.camera.
 * @param[out] frustum Left, right, lower and upper edge, for conus_view.frustum.
 * @param window The middle of the window, with +x to its right, +y up, +z to the side of the eye.
 * @param size Width and height of the window, mm.
 * @param eye World mm.
 * @return #CONUS_ERROR_ARGUMENT where the eye is not before the window: no edge may be more than 1000 times as far off
 * as the eye is near. */
CONUS_CHECKED conus_status conus_window_camera(conus_pose *camera, double frustum[4], const conus_pose *window,
                                               const double size[2], const double eye[3]);

/* Spaces */

/** Tells whether a text is near:AREA, so that another place has to be found before. */
CONUS_API bool conus_place_is_near(const char *text);

/** Compares where the points of a list lie with what their names say. Names count where three points or more, and at
 * least half of them, have those of areas (four fifths, with two words for the rows of the head, those of positions),
 * so that contacts "A1" of a shaft are no areas. A number is no name. Positions are compared where the atlas is known
 * to lie in MNI 152 or Colin 27.
 * @param[out] out What was found; all 0 where names say nothing.
 * @param atlas Where they are, as it lies in the world now.
 * @param list Its first 64 rows are looked at; rows with a direction are not. */
CONUS_CHECKED conus_status conus_places_check(conus_name_check *out, const conus_atlas *atlas,
                                              const conus_pose_list *list);

/** Names the spaces, for a program's options.
 * @param index From 0, as #conus_space.
 * @return "ras", "lps", "ccf" and "bregma"; NULL past the last. Static. */
CONUS_API const char *conus_space_name(size_t index);

/** Names a coordinate of a space.
 * @param axis 0 to 2.
 * @return "x", "AP" and so on; NULL where there is none. Static. */
CONUS_API const char *conus_space_axis(conus_space space, size_t axis);

/** Gives the unit of a space's positions. @return "mm", or "um" of #CONUS_SPACE_CCF. Static. */
CONUS_API const char *conus_space_unit(conus_space space);

/* Probes */

/** A contact. */
typedef struct conus_probe_contact {
    const char *id;    /**< Its contact_id, that of no other in the file: "0", "1" and so on where the file has none. In
                          a file of several probes the name of its probe and a colon stand before it: "probe2:e7". */
    const char *shank; /**< Its shank_id; "" where the file has none. */
    const char *probe; /**< Name of its probe: "probe1", "probe2", in the order of the file. */
    size_t index;      /**< Index of its probe. */
    int64_t channel; /**< The trace that it is recorded on, from 0; -1 = it is not wired, -2 = the file does not say. */
    double position[3]; /**< As in the file, micrometres; the third is NaN of a probe in two dimensions. */
    double offset[3]; /**< mm from the probe's tip in the device's frame (Eq. 2): +x as the probe's x axis, +z along the
                         shank, away from the tip. */
} conus_probe_contact;

/** Counts the probes. */
CONUS_API size_t conus_probe_count(const conus_probe *probe);

/** Counts the contacts of all probes, in the order of the file. */
CONUS_API size_t conus_probe_contact_count(const conus_probe *probe);

/** Gives contact @p index. @return NULL past the last. */
CONUS_API const conus_probe_contact *conus_probe_at(const conus_probe *probe, size_t index);

/** Gives the tip of a probe: the lowest point of its contour, in the middle of an edge that is as low; of several that
 * are as low, shanks side by side, that of the least x.
 * @param[out] out As in the file, micrometres; the third is NaN of a probe in two dimensions. Unchanged for another
 * index.
 * @param index Index of the probe, from 0. */
CONUS_API void conus_probe_tip(double out[3], const conus_probe *probe, size_t index);

/** Makes several of the one probe of a file, as if the file had them: insertions of one kind.
 * @param[out] out The probes, with these names; end them with conus_probe_destroy().
 * @param probe Of one probe.
 * @param names [count] None twice. Copied.
 * @param count From 1 to 1024.
 * @return #CONUS_ERROR_ARGUMENT for several probes, another count, a name that is there twice, and one that with that
 * of a contact has more than 255 bytes. */
CONUS_CHECKED conus_status conus_probe_repeat(conus_probe **out, const conus_probe *probe, const char *const *names,
                                              size_t count);

/* Plans */

/** Gives published errors one after the other.
 * @return NULL past the last. Text of the library. The tilt of vr-controller is that of a target 4 degrees wide. */
CONUS_API const conus_pose_error *conus_pose_error_at(size_t index);

/** Makes the list of a plan whose run was cancelled, from the poses that were tried until then: the first ones, as many
 * as conus_plan_left() and conus_plan_rejected() count. It does not ask conus_plan_options.progress.
 * @param plan The plan, whose conus_plan_run() gave #CONUS_ERROR_CANCELLED.
 * @return #CONUS_ERROR_ARGUMENT for a plan that was not run, or has its list; the errors of conus_select().
 * @threads One at a time for each @p plan, and for the selector. */
CONUS_CHECKED conus_status conus_plan_cut(conus_plan *plan);

/** Gives the candidate that breaks constraint @p index alone, by the least; of equal ones the first.
 * @return NULL where there is none, and where some candidate is feasible. */
CONUS_API const conus_planned *conus_plan_miss(const conus_plan *plan, size_t index);

/** A degree of freedom. Shifts and the depth are in mm, up to 20; turns in degrees, up to 30. */
typedef enum conus_freedom {
    CONUS_FREEDOM_X = 0,    /**< Shift along x, */
    CONUS_FREEDOM_Y,        /**< y, */
    CONUS_FREEDOM_Z,        /**< or z of the world, or of conus_tolerance_options.shifts. */
    CONUS_FREEDOM_DEPTH,    /**< The far end along the axis; the near end stays. */
    CONUS_FREEDOM_SIDE,     /**< Shift along the device's x. */
    CONUS_FREEDOM_UP,       /**< Shift along the device's y. */
    CONUS_FREEDOM_PITCH,    /**< Turn about the device's x, */
    CONUS_FREEDOM_YAW,      /**< about its y, */
    CONUS_FREEDOM_AZIMUTH,  /**< about the vertical (conus_tolerance_options.up), */
    CONUS_FREEDOM_ELEVATION /**< or towards the vertical; of an axis along it about the device's x. All turns are about
                               lines through the pivot, by the right-hand rule. */
} conus_freedom;

/** How many rows conus_plan_tolerance() fills: two for each degree of freedom. */
#define CONUS_TOLERANCE_COUNT 20

/** How a tolerance was found. */
typedef enum conus_tolerance_method {
    CONUS_TOLERANCE_EXACT = 0, /**< holds_to is proven; fails_at is no more than 1e-6 mm or degrees beyond it. */
    CONUS_TOLERANCE_SAMPLED,   /**< A constraint without a leeway was asked at steps of 0.01 mm or degrees. */
    CONUS_TOLERANCE_GRAZED     /**< holds_to is proven; from there on it is only just not broken, up to fails_at. */
} conus_tolerance_method;

/** How far a pose may be off. */
typedef struct conus_tolerance {
    conus_freedom freedom;         /**< Along what. */
    bool negative;                 /**< To the other side. */
    conus_tolerance_method method; /**< How that was found. */
    double holds_to;               /**< mm or degrees, at least 0: no constraint breaks up to here. */
    double fails_at;   /**< Here one does; NaN where none breaks up to 20 mm, 30 degrees, or the near end. */
    size_t constraint; /**< Index of that constraint; SIZE_MAX without one. */
    uint32_t object;   /**< Its conus_verdict.object there. */
    double depth;      /**< Its conus_verdict.depth there, mm; NaN without one. */
    double at[3];      /**< The point of the needle at that depth, there, world mm; NaN without one. */
} conus_tolerance;

/** Finds how far a pose may be off along each degree of freedom. For a pose that breaks a constraint as it is, all are
 * 0.
 * @param[out] out [#CONUS_TOLERANCE_COUNT] By degree of freedom, of each first the positive side.
 * @param pose From conus_plan_pose() or conus_plan_try() of this plan.
 * @return #CONUS_ERROR_ARGUMENT for a number out of its range; the errors of conus_select().
 * @threads One at a time for each @p plan, and for the selector; not during conus_plan_run(). */
CONUS_CHECKED conus_status conus_plan_tolerance(conus_tolerance *out, conus_plan *plan, const conus_planned *pose,
                                                const conus_tolerance_options *options);
/** Counts the constraints. */
CONUS_API size_t conus_plan_constraint_count(const conus_plan *plan);

/** Gives constraint @p index.
 * @return NULL past the last. Its names are NULL, see conus_plan_name(), and a direction has length 1. */
CONUS_API const conus_constraint *conus_plan_constraint(const conus_plan *plan, size_t index);

/** Gives the names of the structure of a constraint.
 * @return The names that were asked for, as the atlas has them: "Thalamus_L, Putamen_L"; NULL without a structure.
 * UTF-8. */
CONUS_API const char *conus_plan_name(const conus_plan *plan, size_t index);

/** Whether a constraint's structure was asked for by the name of an object, hidden or not, or of one above it.
 * @return False without a structure, and for an object that the plan's atlas has not. */
CONUS_API bool conus_plan_is_about(const conus_plan *plan, size_t index, uint32_t object);

/** Measures how far a point of a listed pose's axis is from the structure of a constraint, to draw a curve of it.
 * @param[out] out mm, the radius not taken off (Eq. 21).
 * @param pose Index in the list.
 * @param constraint Index of a REACH, AVOID or FIRST.
 * @param depth mm from the apex. Of several shanks it is the nearest one's, but the farthest one's for a REACH or FIRST
 * of all and an AVOID of any.
 * @return #CONUS_ERROR_ARGUMENT for a wrong index or depth. */
CONUS_CHECKED conus_status conus_plan_distance(double *out, conus_plan *plan, size_t pose, size_t constraint,
                                               double depth);

/** Counts the needles. */
CONUS_API size_t conus_together_count(const conus_together *together);

/** A question of several needles, and what answers it. */
typedef struct conus_answered {
    const size_t *needles;   /**< [needle_count] Indices of those that may. */
    size_t needle_count;     /**< At least 1. */
    bool once;               /**< At most one does. */
    const char *arc;         /**< NULL = any. */
    const conus_plan *plan;  /**< Its constraints, and its candidates (conus_plan_left()). */
    double radius;           /**< Of shafts, mm. */
    const double *shanks;    /**< [shank_count][2] As of conus_plan_options, also of one on the axis. */
    size_t shank_count;      /**< At least 1. */
    const conus_part *parts; /**< [part_count] */
    size_t part_count;       /**< How many there are. */
} conus_answered;

/** Gives a question. @return NULL past the last. */
CONUS_API const conus_answered *conus_together_question(const conus_together *together, size_t index);

/** Gives the options of the answer. @return With the defaults filled in. */
CONUS_API const conus_together_options *conus_together_asked(const conus_together *together);

/** Gives the candidates of a needle that are not below its cut (Eq. 28): no other one is in a combination that is as
 * good as the last that is listed, or of lists that are not known whole. Reads them again.
 * @param[out] out [*count] By question, then by number. Of each place only where it is and its leeway are known, NaN
 * where its question has none. Borrowed from the answer, until the next call.
 * @param together The answer. What its questions point to must still live.
 * @param index Of the needle.
 * @return #CONUS_ERROR_DATA where the candidates are others now; their errors. */
CONUS_CHECKED conus_status conus_together_candidates(const conus_chosen **out, size_t *count, conus_together *together,
                                                     size_t index);

/** Makes a table of all pairs of the combinations: how near the needles come to each other, and where.
 * @param[out] out A row for each two needles: combination, needle, other, slack_mm, leeway_mm, distance_mm, body,
 * other_body, x, y, z, other_x, other_y, other_z, entry_distance_mm, arc_deg, slider_deg; without a combination no
 * row. End it with conus_table_destroy().
 * @param together The answer.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected. */
CONUS_CHECKED conus_status conus_together_pairs(conus_table **out, const conus_together *together);

/* Surfaces of areas, and numbers of vertices */

/** The format of a surface. */
typedef enum conus_mesh_format {
    CONUS_MESH_GIFTI = 0, /**< GIFTI, .gii. */
    CONUS_MESH_VTP,       /**< VTK's XML poly data, .vtp. */
    CONUS_MESH_OBJ,       /**< Wavefront, .obj. */
    CONUS_MESH_PLY,       /**< Stanford, .ply. */
    CONUS_MESH_STL        /**< Stereolithography, .stl. */
} conus_mesh_format;

/** How conus_atlas_write_meshes() makes surfaces. */
typedef struct conus_mesh_options {
    size_t struct_size;
    conus_mesh_format format; /**< Format of the files. */
    uint32_t smooth;          /**< Iterations of windowed-sinc smoothing, 1 to 1000; 0 = 5. */
    double pass_band;         /**< Pass band of the smoothing, up to 2; less is smoother; 0 = 0.7. */
    bool no_smoothing;        /**< Leave the voxels' steps as they are. */
    double decimate;          /**< Part of the triangles that decimation removes, in [0, 1). */
    uint64_t max_memory;      /**< Limit for the program that makes the surfaces, bytes; 0 = 8 GiB. */
    conus_progress progress;  /**< NULL = no callback. */
    void *progress_user;      /**< Passed to @p progress. */
    conus_log log;            /**< Notes about the surfaces; NULL = silent. */
    void *log_user;           /**< Passed to @p log. */
} conus_mesh_options;
#define CONUS_MESH_OPTIONS_INIT CONUS_INIT_(conus_mesh_options)

/** Writes a closed surface of each area, LABEL_Name.gii and so on, in world mm. Areas that are meshes already are
 * written as they are. Needs the program conus-mesh, beside this one, in PATH or named by CONUS_MESH.
 * @param folder Made if missing.
 * @return #CONUS_ERROR_UNSUPPORTED without conus-mesh; #CONUS_ERROR_ARGUMENT for an option out of its range;
 * #CONUS_ERROR_IO where the system refuses. */
CONUS_CHECKED conus_status conus_atlas_write_meshes(const conus_atlas *atlas, const char *folder,
                                                    const conus_mesh_options *options);

/** A number for each vertex of a surface. */
typedef struct conus_vertex_map {
    const char *name;        /**< UTF-8, such as "leeway_mm". */
    const float *values;     /**< [vertices] NaN = none. */
    const uint64_t *numbers; /**< [vertices] In their place, values is NULL: whole numbers, 0 = none. Up to 2^24 they
                                are float32, exactly; where one is larger, this array has the numbers modulo 1000000,
                                and one more, NAME_millions, has the millions. */
} conus_vertex_map;

/** Writes numbers of vertices as a GIFTI file of float32 arrays. The same numbers give the same bytes.
 * @param path Ends in .func.gii or .shape.gii.
 * @param maps [count] An array of the file each.
 * @param count At least 1.
 * @param vertices The surface's, 1 or more.
 * @param structure What the surface is, "CortexLeft": the file's AnatomicalStructurePrimary, by which Workbench finds
 * the surface; NULL = the file does not say.
 * @return #CONUS_ERROR_ARGUMENT for another ending, and for no numbers; #CONUS_ERROR_IO where the system refuses. */
CONUS_CHECKED conus_status conus_vertex_maps_write(const char *path, const conus_vertex_map *maps, size_t count,
                                                   size_t vertices, const char *structure);

/* Sites */

/** Says whether sites are voxels of one volume, on whose grid conus_sites_write_maps() writes.
 * @return True for sites from conus_sites_of_roi(), and from conus_sites_find() except centroids and structures of
 * several volumes. */
CONUS_API bool conus_sites_have_voxels(const conus_sites *sites);

/** Writes numbers of sites of a surface as numbers of its vertices (conus_vertex_maps_write()); a vertex that is no
 * site has none. Those of sites that are voxels of one volume are written on its grid: NIfTI-1, float32, a volume for
 * each map along the fourth axis, NaN where no site is; a comment behind the header has the names, a line each.
 * @param path Ends in .func.gii or .shape.gii, or of voxels in .nii or .nii.gz.
 * @param sites Of conus_sites_load(), conus_sites_of_roi(), or conus_sites_find() of voxels.
 * @param maps [count] Their values are [conus_sites_count()].
 * @param count At least 1.
 * @param structure What the surface is; NULL = as its file says. Of voxels without meaning.
 * @param fill A vertex that is no site has the numbers of the nearest one that is nearer than this, of equal ones of
 * the first, mm; 0 = it has none. Of voxels 0.
 * @return #CONUS_ERROR_ARGUMENT for sites of neither kind; the errors of conus_vertex_maps_write() and of reading the
 * surface. */
CONUS_CHECKED conus_status conus_sites_write_maps(const char *path, const conus_sites *sites,
                                                  const conus_vertex_map *maps, size_t count, const char *structure,
                                                  double fill);

/** Gives note @p index that a careful user should know about these sites. @return One line; NULL past the last. */
CONUS_API const char *conus_sites_note(const conus_sites *sites, size_t index);

/** How much it matters, as of conus_pose_stream_note_severity(). */
CONUS_API conus_severity conus_sites_note_severity(const conus_sites *sites, size_t index);

/* Regions of interest */

/** Describes the volume of a region of interest; of tetrahedra a grid of 2 mm that they lie in.
 * @return Its threshold is the one that holds, 0 of a mask. */
CONUS_API const conus_volume_info *conus_roi_volume(const conus_roi *roi);

/* Selections */

/** Gives the n of the n x n buffer. @return That of its options, or the default. */
CONUS_API uint32_t conus_selector_resolution(const conus_selector *selector);

/** Tells the place of an object among the colours that pictures give to an answer: what is hit first comes first, in
 * the order of the results, then pathways and bundles, which somebody asked for, then areas that are only behind
 * others.
 * @param object Its number, from 1. Objects that a level joins have the same place.
 * @return From 1; 0 = the cone does not reach it. */
CONUS_API size_t conus_selection_rank(const conus_selection *selection, uint32_t object);

/** Tells how much pictures show of the colour of an object, so that what has little of a cone is not as loud as what
 * has most of it: all with half of the cone or more, less with less, in eight steps, 0.4 with a fiftieth; the rest is
 * the grey of what is not hit.
 * @param object Its number, from 1.
 * @return 0.4 to 1; 1 of what is not hit first, or of a ball. */
CONUS_API double conus_selection_weight(const conus_selection *selection, uint32_t object);

/** Counts a point. One that is not finite is not counted.
 * @param number The caller's number of the point.
 * @param point World mm.
 * @param radius Of the ball around it, mm; 0 of a point without one. */
CONUS_API void conus_pose_check_add_point(conus_pose_check *check, uint64_t number, const double point[3],
                                          double radius);

/* Reports */

/** A format of reports. */
typedef struct conus_format_info {
    const char *name; /**< "tsv": as programs call it. */
    bool is_foreign;  /**< Another program reads it. */
    bool is_of_probe; /**< It is one string of a whole probe. */
    bool of_batch;    /**< conus_batch writes it. */
} conus_format_info;

/** Gives the formats of reports one after the other. @return NULL past the last. Static. */
CONUS_API const conus_format_info *conus_format_at(size_t format);

/** Names what rows of reports are of, as conus_report_options.rows. @return NULL past the last. Static. */
CONUS_API const char *conus_rows_name(size_t index);

/** Says whether a column of reports holds numbers that are measured or counted.
 * @param name Name of the column, in whatever rows and list of voxels.
 * @return False of names, kinds and labels, "name" and "index" for example, and of a column that no report has. */
CONUS_API bool conus_column_is_number(const char *name);

/** Adds the best combination of several needles. Without one it has no row.
 * @param report Of "needles", whose columns then are those of all needles' constraints, too, or of
 * "pairs". Nothing else is added to it.
 * @param together Its needles' selectors have the atlas and the frame of @p report; must outlive the last text of it.
 * @return #CONUS_ERROR_ARGUMENT in a report of other rows, for a second answer, and for needles of which the
 * constraints have too many columns together. */
CONUS_CHECKED conus_status conus_report_add_together(conus_report *report, const conus_together *together);

/** Gives the table of connected areas: names in the first row and the first column, and the number of streamlines
 * between them; in JSON also their mean lengths, and the sources.
 * @param[out] text Borrowed from the report until the next text is asked for. UTF-8.
 * @param report Of "connections", as "tsv", "csv" or "json".
 * @param table Of conus_connectivity() with pairs, as for conus_report_add_table(): its parts are written.
 * @return #CONUS_ERROR_ARGUMENT for another report; #CONUS_ERROR_UNSUPPORTED for more than 8192 areas. */
CONUS_CHECKED conus_status conus_report_matrix(const char **text, size_t *size, conus_report *report,
                                               const conus_table *table);

/** Writes the voxels hit first (with all layers, and of a ball, all with their centre in it), nearest first, as TSV:
 * query pathway i j k x y z value distance_mm kind index; behind query the column atlas, where the report has it. With
 * all layers, and of a ball, the points of bundles' streamlines in it follow, by bundle, streamline and point: i is the
 * streamline's number in its tractogram, j the point's along it, both from 0; k and value are n/a.
 * @param[out] text As of conus_report_text().
 * @param[out] size Bytes, without the NUL. */
CONUS_CHECKED conus_status conus_report_voxels(const char **text, size_t *size, conus_report *report);

/** Writes the JSON sidecar of a mask of one of the answers (docs/formats.md).
 * @param[out] text As of conus_report_text().
 * @param[out] size Bytes, without the NUL. */
CONUS_CHECKED conus_status conus_report_grid_sidecar(const char **text, size_t *size, conus_report *report,
                                                     const conus_grid *grid);

/** Writes the probes.tsv of the draft BEP032 of BIDS: for each probe the smallest area of the area tree that contains
 * all of its contacts, and their side.
 * @param[out] text UTF-8 with a final NUL. Borrowed until the next call on the report.
 * @param[out] size Bytes, without the NUL.
 * @param report Of "bep032", with all contacts.
 * @return #CONUS_ERROR_ARGUMENT for another report, and while answers are missing. */
CONUS_CHECKED conus_status conus_report_probes(const char **text, size_t *size, conus_report *report);

/** Writes the coordsystem.json of the draft BEP032 of BIDS: the space of x, y and z, and their unit.
 * @param[out] text UTF-8 with a final NUL. Borrowed until the next call on the report.
 * @param[out] size Bytes, without the NUL.
 * @param report With the option @p placed.
 * @return #CONUS_ERROR_ARGUMENT for another report. */
CONUS_CHECKED conus_status conus_report_coordsystem(const char **text, size_t *size, conus_report *report);

/** Writes the text of the answers since the last call and forgets them, for a report that goes on. The header row of
 * TSV, CSV and "bids", or of a track's table, comes once, with the first call. Not for "json"
 * and the formats of probes, which are one whole.
 * @param[out] text As of conus_report_text().
 * @param[out] size Bytes, without the NUL.
 * @return #CONUS_ERROR_ARGUMENT for a format that is one whole, and as of conus_report_text(). */
CONUS_CHECKED conus_status conus_report_take(const char **text, size_t *size, conus_report *report);

/* Weights */

/** Gives a weight at a place.
 * @param x Degrees off the axis, mm from it, or mm from a ball's centre.
 * @param z mm along the axis; nothing of a weight that does not depend on it.
 * @return 0 or more. */
CONUS_API double conus_weight_at(const conus_weight *weight, double x, double z);

/** Gives the largest weight from the axis to a place.
 * @param x As for conus_weight_at().
 * @param range Between which depths, mm; both 0 = all.
 * @return 0 or more. */
CONUS_API double conus_weight_largest(const conus_weight *weight, double x, const double range[2]);

/** Gives the shortest length in which a weight changes. @return Mm; infinity of one by angle alone, and of hard. */
CONUS_API double conus_weight_finest(const conus_weight *weight);

/** Names the region that the weight is of. @return "cone", "cylinder", "ball", or "any". */
CONUS_API const char *conus_weight_region(const conus_weight *weight);

/** Gives the standard deviation of gauss. @return Degrees; 0 of another form. */
CONUS_API double conus_weight_sigma(const conus_weight *weight);

/** Finds the path in the text of a weight or a prior.
 * @param text As for conus_weight_create(), or conus_selector_options.prior.
 * @return Bytes of the path with which it begins; 0 where it names no file. */
CONUS_API size_t conus_weight_path_length(const char *text);

/* Calibration */

/** A pose of a device, and what was aimed at or meant. */
typedef struct conus_trial {
    conus_pose pose; /**< Where the device was and pointed. */
    double aim[3];   /**< For conus_calibrate(): the point that was aimed at, world, mm. */
    double angle;    /**< For conus_reliability(): as for conus_select(), */
    double range[2]; /**< as for conus_selector_set_range(), NaN = the selector's, */
    uint32_t meant;  /**< and the object that was meant. */
} conus_trial;

/** Finds from trials how far off a device points, and how widely (Eq. 34).
 * @param[out] out Columns parameter, value, low, high, p, n.
 * @param trials [count]
 * @param count 5 and more.
 * @return #CONUS_ERROR_DATA for fewer trials, for trials that are all off alike, and for a device that does not point
 * towards its aim. */
CONUS_CHECKED conus_status conus_calibrate(conus_table **out, const conus_trial *trials, size_t count);

/** Finds how often the posteriors of a selector name what was meant, and how often they say that they do (Eq. 34).
 * @param[out] out Columns kind, low, high, n, said, right, right_low, right_high, log_loss, power: a row of all trials,
 * then of each bin.
 * @param selector With a prior, and not of cylinders. Its range is that of the last trial afterwards.
 * @param trials [count]
 * @param count 5 and more.
 * @param progress Called for each trial; false ends it. NULL = no callback.
 * @return #CONUS_ERROR_DATA for fewer trials, and for an object that has no row of its own; #CONUS_ERROR_ARGUMENT for
 * another selector; #CONUS_ERROR_CANCELLED; the errors of conus_select(). */
CONUS_CHECKED conus_status conus_reliability(conus_table **out, conus_selector *selector, const conus_trial *trials,
                                             size_t count, conus_progress progress, void *user);

/* Positions of caps */

/** Reads a scalp, and finds the positions of the 10-10 system on it (Eq. 35).
 * @param path A closed surface, as for conus_sites_load().
 * @param landmarks Nasion, inion, left and right ear (LPA, RPA), world, mm: at most 20 mm off it.
 * @return #CONUS_ERROR_DATA for another surface, and for landmarks that are not its own; the errors of
 * conus_sites_load(). */
CONUS_CHECKED conus_status conus_scalp_load(conus_scalp **out, const char *path, const double landmarks[4][3]);

/** Reads the landmarks of a *_coordsystem.json of BIDS: those of AnatomicalLandmarkCoordinates, or else of
 * FiducialsCoordinates, by their names (NAS, INI, LPA, RPA, and what others call them), in any unit that is stated.
 * @param[out] landmarks Nasion, inion, left and right ear, mm as in the file; NaN for one that is not there.
 * @return #CONUS_ERROR_DATA for a file that is none, and for a system that is a head's own (CTF, CapTrak) and no
 * image's world; #CONUS_ERROR_IO; #CONUS_ERROR_MEMORY. */
CONUS_CHECKED conus_status conus_landmarks_load(double landmarks[4][3], const char *path);

/** Ends a scalp. */
CONUS_API void conus_scalp_destroy(conus_scalp *scalp);

/** How a device stands at a position of a cap, straight into the head. */
typedef struct conus_position_options {
    const conus_scalp *scalp; /**< For conus_positions(): where positions are; NULL = on the head of MNI 152. */
    double off;               /**< mm off the scalp, -1000 to 1000. */
    bool has_handle;          /**< It has a handle, along its -y; without it its up is that of a pose without one. */
    double handle; /**< Degrees that the handle is turned from backwards to the position's side, on the midline to the
                      left, -360 to 360. */
} conus_position_options;

/** Finds the pose of a device at a position (Eq. 35).
 * @param place Of kind #CONUS_PLACE_POSITION.
 * @param options How it stands.
 * @return #CONUS_ERROR_ARGUMENT for a position without a normal, and a number out of its range. */
CONUS_CHECKED conus_status conus_position_pose(conus_pose *out, const conus_place *place,
                                               const conus_position_options *options);

/** Lists positions of the 10-10 system on a scalp, or on the head of MNI 152 (Eq. 35).
 * @param[out] out Columns query_id, x, y, z, dx, dy, dz, ux, uy, uz, error_deg, error_mm, world; those of a direction
 * are NaN where no normal is known. End it with conus_table_destroy().
 * @param names [count] "C3"; NULL = all.
 * @param options NULL = none is off, and no handle.
 * @return #CONUS_ERROR_ARGUMENT for another name, with the closest one, and as conus_position_pose(). */
CONUS_CHECKED conus_status conus_positions(conus_table **out, const char *const *names, size_t count,
                                           const conus_position_options *options);

/* Rankings */

/** A ranking. */
typedef struct conus_score_info {
    const char *name;        /**< For conus_selector_options.score. */
    const char *description; /**< One line. */
    bool needs_history;      /**< Only a conus_tracker has it. */
    bool needs_layers;       /**< Only with CONUS_LAYERS_ALL. */
    bool needs_weight;       /**< Only with conus_selector_options.weight. */
} conus_score_info;

/** Gives entry @p index of the table of rankings. @return NULL past the last. Static. */
CONUS_API const conus_score_info *conus_score(size_t index);

/** Gives what a ranking needs: a name, or a formula of names, numbers, + - * /, a minus in front and parentheses, as
 * "0.5*share + 0.5*centre". Where a name has no value, or a divisor is 0, the formula has none: such objects rank last.
 * @param[out] out Its name is @p score, "share" for NULL, and is borrowed from the caller.
 * @param score NULL = "share".
 * @return #CONUS_ERROR_ARGUMENT for a wrong formula; the message says what is wrong with it. */
CONUS_CHECKED conus_status conus_score_parse(conus_score_info *out, const char *score);

/* Atlases */

/** Tells as what conus_atlas_set_context() reads a file.
 * @return True where it is a surface; false for everything else, also for a file that is not there. */
CONUS_API bool conus_context_is_surface(const char *path);

/** Hides the objects that @p hidden marks and shows all others.
 * @param atlas The atlas; unchanged on failure.
 * @param hidden [object count + 1], by number; entry 0 has no meaning. NULL shows all.
 * @return #CONUS_ERROR_ARGUMENT where nothing is left. */
CONUS_CHECKED conus_status conus_atlas_set_hidden(conus_atlas *atlas, const bool *hidden);

/** Returns whether an object is hidden.
 * @param number Number of the object.
 * @return Whether it is hidden; false for a number that is no object. */
CONUS_API bool conus_atlas_is_hidden(const conus_atlas *atlas, size_t number);

/** Gives the memory that conus_atlas_pack() needs. @return Bytes. */
CONUS_API size_t conus_atlas_packed_size(const conus_atlas *atlas);

/** Packs the atlas as it is. The packed bytes hold no pointers and may be mapped at another address in each process,
 * but they are for this build of conus on this kind of machine: conus_atlas_save() makes files.
 * @param[out] memory [size], at a multiple of 64 bytes. On failure its content has no meaning.
 * @param size Bytes, at least conus_atlas_packed_size().
 * @return #CONUS_ERROR_ARGUMENT for too few bytes or another alignment; #CONUS_ERROR_MEMORY. */
CONUS_CHECKED conus_status conus_atlas_pack(void *memory, size_t size, const conus_atlas *atlas);

/** Makes an atlas of what conus_atlas_pack() wrote. An atlas that is then changed (its thresholds, its hemispheres)
 * gets its own copies of the arrays that the change concerns. The large arrays are not checked: attach only what you
 * trust.
 * @param memory The packed atlas, at a multiple of 64 bytes. It is never written to and must outlive the atlas.
 * @return #CONUS_ERROR_DATA where there is no whole atlas of this version. */
CONUS_CHECKED conus_status conus_atlas_attach(conus_atlas **out, const void *memory, size_t size);

/** Gives all areas, pathways and bundles the colours back that they had before conus_atlas_use_safe_colours() or
 * conus_atlas_use_palette(). */
CONUS_API void conus_atlas_use_own_colours(conus_atlas *atlas);

/* What an atlas has */

/** Returns whether a deformation field has moved the atlas, so that conus_atlas_own_point() is no affine. */
CONUS_API bool conus_atlas_is_warped(const conus_atlas *atlas);

/** Finds where a ray first meets a surface around the areas, from either side. Looks at every triangle.
 * @param origin World mm.
 * @param direction Of any length but 0.
 * @return How far that is from @p origin, in units of the length of @p direction; INFINITY where it meets none. */
CONUS_API double conus_atlas_context_depth(const conus_atlas *atlas, const double origin[3], const double direction[3]);

/** Tells the same of a volume alone, by its header and its grid. @return The brain. Its texts are static. */
CONUS_API conus_brain_view conus_volume_brain(const conus_volume_info *info);

/** What is published of an atlas. All texts are static. */
typedef struct conus_atlas_facts {
    const char *name;      /**< "AAL". */
    const char *edition;   /**< "116 areas, 1 mm". */
    const char *space;     /**< The brain on which it was made or to which it was brought. */
    const char *reference; /**< What its authors ask to cite, with a DOI. */
    const char *licence;   /**< Of the packages that carry these voxels. */
} conus_atlas_facts;

/** Which published atlas an atlas is. */
typedef struct conus_atlas_identity_view {
    const conus_atlas_facts *facts; /**< NULL = none that conus knows. */
    bool is_verified;               /**< By its voxels; false: by its labels and names alone. */
    bool has_other_names;           /**< It has names, but not those that were published with its voxels. */
    char sum[65];                   /**< SHA-256 of its voxels; "" where it has none of its own: surfaces, several
                                         volumes of labels, areas in halves or hidden. */
} conus_atlas_identity_view;

/** Finds out which published atlas this is. The sum is that of the numbers of voxels along i, j, k (32 bits each), the
 * matrix from voxels to mm (row by row, without the last one, 32-bit floats) and the labels (32 bits each, i fastest),
 * all little-endian. It does not depend on how the file is written. Reads every voxel.
 * @return The sum and the facts. */
CONUS_API conus_atlas_identity_view conus_atlas_identity(const conus_atlas *atlas);

/** How far apart two brains are. */
typedef enum conus_brain_gap {
    CONUS_BRAIN_GAP_NONE = 0, /**< None that is known. */
    CONUS_BRAIN_GAP_SMALL,    /**< MNI 152 and Colin 27, which half of the field takes for one. */
    CONUS_BRAIN_GAP_SOME_MM,  /**< Other editions of MNI 152, NLin2009 and an earlier one, and other templates. */
    CONUS_BRAIN_GAP_OTHER     /**< Another brain. */
} conus_brain_gap;

/** Compares two brains.
 * @param a One.
 * @return #CONUS_BRAIN_GAP_NONE also where one is unknown, and of one person's own and another own one. */
CONUS_API conus_brain_gap conus_brain_compare(conus_brain_view a, conus_brain_view b);

/** Finds the mean position of the voxels or triangles of an object and of those below it in the area tree, or of the
 * points of a bundle, hidden or not.
 * @param[out] out World mm.
 * @param number Number of the object.
 * @return #CONUS_ERROR_DATA if there are none. */
CONUS_CHECKED conus_status conus_atlas_centre(double out[3], const conus_atlas *atlas, size_t number);

/** Counts the voxels of a scalar or context volume by their value.
 * @param[out] counts [bins] How many voxels have values in each of @p bins equal parts of the range from minimum to
 * maximum.
 * @param bins How many parts.
 * @return #CONUS_ERROR_ARGUMENT where there is no such volume. */
CONUS_CHECKED conus_status conus_atlas_histogram(uint64_t *counts, size_t bins, const conus_atlas *atlas, size_t index);

/** Finds the grey values that span the contrast of a scalar or context volume, without a few extremes.
 * @param[out] window The grey values of black and of white.
 * @return #CONUS_ERROR_ARGUMENT where there is no such volume. */
CONUS_CHECKED conus_status conus_atlas_window(double window[2], const conus_atlas *atlas, size_t index);

/** Finds out which areas are left and which right. The side of an area is that of the label table, or that in a pair as
 * #CONUS_HEMISPHERES_MERGED makes one, or that of a word in its name, such as "left" or "rh". An area without any of
 * these has the side of the nearest area above it in the tree that has one. Where it lies does not count.
 * @param[out] sides [conus_atlas_object_count() + 1] By number: 'L', 'R', or 0 of areas of both sides or of none that
 * is known, and of pathways and bundles; entry 0 is 0. */
CONUS_CHECKED conus_status conus_atlas_sides(char *sides, const conus_atlas *atlas);

/** Gives the depth of an area in the tree, as levels count it.
 * @param number Number of the object.
 * @return 1 for roots; a merged area has the depth of its pair; 0 for a pathway or bundle. */
CONUS_API uint32_t conus_atlas_depth(const conus_atlas *atlas, size_t number);

/** Gives the word that tells an object from others of the same name. No two pathways and bundles share a name, but an
 * area may share one with them, and so may a left and a right area whose table says which is which. Tables, legends and
 * lists say it where it is needed: "bundle Arc", "left insula".
 * @param[out] prefixes [number of objects + 1], by number: "area", "pathway", "bundle", "left", "right", "left area" or
 * "right area", and "" where no name is shared, and for 0. The texts are static. Untouched on failure. */
CONUS_API conus_status conus_atlas_prefixes(const char **prefixes, const conus_atlas *atlas);

/** Counts the volumes. Those of labels come first, one for each grid; pathways and the context follow. */
CONUS_API size_t conus_atlas_volume_count(const conus_atlas *atlas);

/** A surface that conus_atlas_set_context() has put around the areas. */
typedef struct conus_context_surface {
    size_t struct_size;
    const char *path; /**< UTF-8 where the file system has it so. Borrowed until the atlas ends. */
    size_t vertices;  /**< In the file. */
    size_t triangles; /**< Those without area are left out. */
    bool closed;      /**< Every edge is of two triangles: it has an inside. */
    char hemisphere;  /**< 'L', 'R', 'B', or 0 where the file does not say. */
    double opacity;   /**< Above 0 to 1. */
    double low[3];    /**< Lowest x, y, z of its vertices, world mm. */
    double high[3];   /**< The highest. */
} conus_context_surface;
#define CONUS_CONTEXT_SURFACE_INIT CONUS_INIT_(conus_context_surface)

/** Counts the surfaces around the areas. @return How many conus_atlas_set_context() has added. */
CONUS_API size_t conus_atlas_context_surface_count(const conus_atlas *atlas);

/** Tells about a surface around the areas.
 * @param[in,out] out Its struct_size is read; unchanged on failure.
 * @param index From 0, in the order in which they were added.
 * @return #CONUS_ERROR_ARGUMENT past the last. */
CONUS_CHECKED conus_status conus_atlas_context_surface(conus_context_surface *out, const conus_atlas *atlas,
                                                       size_t index);

/** Counts the other files that an atlas is made of: a manifest, surfaces, labels of their vertices, lists of what is
 * shown, volumes of labels that are joined with another on its grid. */
CONUS_API size_t conus_atlas_file_count(const conus_atlas *atlas);

/** Gives the path of other file @p index. @return NULL past the last. Borrowed until the atlas is changed or ends. */
CONUS_API const char *conus_atlas_file(const conus_atlas *atlas, size_t index);

/** Gives the source of the names, in words.
 * @return "ITK-SNAP labels in aal.label", "none found". Borrowed until the atlas is changed or ends. */
CONUS_API const char *conus_atlas_label_source(const conus_atlas *atlas);

/** Counts the notes that a careful user should know about this atlas: labels without names, a guessed space. */
CONUS_API size_t conus_atlas_note_count(const conus_atlas *atlas);

/** Gives note @p index. @return One line; NULL past the last. Borrowed until the atlas is changed or ends. */
CONUS_API const char *conus_atlas_note(const conus_atlas *atlas, size_t index);

/** How much it matters, as of conus_pose_stream_note_severity(). */
CONUS_API conus_severity conus_atlas_note_severity(const conus_atlas *atlas, size_t index);

/** Gives the note that left and right are exchanged, of the names or of the places. Tell nobody a side of such an
 * atlas: names say one, places the other. conus_atlas_exchange_sides() mends one whose places are.
 * @return The note: at least three pairs of a left and a right area, and three quarters of all, lie the other way
 * round. NULL where they do not. Borrowed until the atlas is changed or ends. */
CONUS_API const char *conus_atlas_exchanged(const conus_atlas *atlas);

/* Packs */

/** What a pack says of itself. */
typedef struct conus_pack_info {
    const char *path;    /**< As it was opened. */
    const char *sha256;  /**< Of all behind its head, as the head has it, in hexadecimal. */
    const char *words;   /**< How it is packed again; "" = not known. */
    const char *version; /**< The version of conus that packed it. */
    uint64_t size;       /**< Bytes. */
    size_t source_count; /**< How many files it was packed from. */
} conus_pack_info;

/** Gives the pack that an atlas was opened from. @return NULL where it was not. Borrowed until the atlas ends. */
CONUS_API const conus_pack_info *conus_atlas_pack_info(const conus_atlas *atlas);

/** What has become of a source since. */
typedef enum conus_source_state {
    CONUS_SOURCE_SAME = 0, /**< Its size and time, or its bytes, are the same. */
    CONUS_SOURCE_CHANGED,  /**< Its bytes are others. */
    CONUS_SOURCE_MISSING   /**< There is no such file. */
} conus_source_state;

/** Gives source @p index of the pack, as it was when the pack was opened.
 * @param[out] state What has become of it; unchanged where there is none. May be NULL.
 * @return Its path, as it was read; NULL past the last. Borrowed until the atlas ends. */
CONUS_API const char *conus_atlas_pack_source(conus_source_state *state, const conus_atlas *atlas, size_t index);

/* Names of atlases */

typedef struct conus_catalogue conus_catalogue; /**< The atlases found, and the places searched. */

/** How conus_catalogue_create() looks. */
typedef struct conus_catalogue_options {
    size_t struct_size;
    conus_log log;  /**< Receives the notes of conus_catalogue_note(); NULL = no callback. */
    void *log_user; /**< Passed to @p log. */
} conus_catalogue_options;
#define CONUS_CATALOGUE_OPTIONS_INIT CONUS_INIT_(conus_catalogue_options)

/** Looks for atlases in the folders that the environment names: $CONUS_ATLAS_PATH, and where mricron, FSL, FreeSurfer,
 * BrainGlobe, TemplateFlow, AFNI, SPM, CAT12, nilearn and MRIcroGL keep theirs. Reads names, the headers of volumes and
 * the XMLs of FSL atlases, no voxel. A folder that cannot be read, or that holds more than is looked at, is a note.
 * @return #CONUS_OK, also where nothing is found.
 * @threads Any, while none changes the environment. */
CONUS_CHECKED conus_status conus_catalogue_create(conus_catalogue **out, const conus_catalogue_options *options);

/** Ends a catalogue. */
CONUS_API void conus_catalogue_destroy(conus_catalogue *catalogue);

/** An atlas that is installed. */
typedef struct conus_installed {
    const char *name;   /**< "aal". UTF-8, one line, without '/'. Not always the only one of that name. */
    const char *source; /**< Whose folder it is in: "mricron", "fsl"; "own" for $CONUS_ATLAS_PATH. */
    const char *kind;   /**< "volume", "probabilities" (an FSL atlas), "surface", "surfaces" (a folder), "scene" (a
                           manifest) or "pack". */
    const char *path;   /**< For conus_atlas_load(). Bytes, not always UTF-8. */
    const char *labels; /**< For conus_load_options.labels; NULL = conus_atlas_load() finds the labels. */
    double spacing[3];  /**< Edge lengths of a voxel, mm; 0 where they are not known. */
} conus_installed;

/** Counts the atlases. */
CONUS_API size_t conus_catalogue_count(const conus_catalogue *catalogue);

/** Gives atlas @p index. Those of one source stand together; $CONUS_ATLAS_PATH comes first.
 * @return NULL past the last. */
CONUS_API const conus_installed *conus_catalogue_atlas(const conus_catalogue *catalogue, size_t index);

/** A folder in which atlases are looked for. */
typedef struct conus_catalogue_place {
    const char *source; /**< As conus_installed.source. */
    const char *rule;   /**< How it is named: "$FSLDIR/data/atlases". */
    const char *path;   /**< The folder; "" where the environment does not say which. */
    bool there;         /**< There is such a folder. */
} conus_catalogue_place;

/** Counts the places in which was looked, there or not. */
CONUS_API size_t conus_catalogue_place_count(const conus_catalogue *catalogue);

/** Gives place @p index, in the order in which they were looked at. @return NULL past the last. */
CONUS_API const conus_catalogue_place *conus_catalogue_place_at(const conus_catalogue *catalogue, size_t index);

/** Counts the notes about what was left out. */
CONUS_API size_t conus_catalogue_note_count(const conus_catalogue *catalogue);

/** Gives note @p index. @return One line; NULL past the last. */
CONUS_API const char *conus_catalogue_note(const conus_catalogue *catalogue, size_t index);

/** Finds the one atlas that is called @p name, or "source:name". If there is none, upper and lower case are taken for
 * the same, and so are names that differ only in '-', '_', '.', '+' and spaces.
 * @param name What to find.
 * @return #CONUS_ERROR_IO if there is none, with the closest names in the message; #CONUS_ERROR_ARGUMENT, with the
 * candidates in the message, if several files have that name. */
CONUS_CHECKED conus_status conus_catalogue_find(const conus_installed **out, const conus_catalogue *catalogue,
                                                const char *name);

/** Finds the one image that is called @p name, as conus_catalogue_find() finds an atlas: a volume in the folders of the
 * catalogue that counts as no labels, such as mricron's ch2 or FSL's MNI152_T1_1mm.
 * @param[out] out Borrowed from the catalogue; without labels.
 * @param name What to find: the file's name without its ending.
 * @return As conus_catalogue_find(). */
CONUS_CHECKED conus_status conus_catalogue_find_image(const conus_installed **out, const conus_catalogue *catalogue,
                                                      const char *name);

/** Says whether what a user gave as an atlas or image is a path, which then is no name: it has a '/', or there is such
 * a file or folder, also where ",volume=K", ",map=K" and the like stand behind it.
 * @param text What the user gave.
 * @return Whether it is a path for conus_atlas_load(). If not, ask conus_catalogue_find(). */
CONUS_API bool conus_atlas_is_path(const char *text);

/** Whether @p path, perhaps with keys behind it, has the ending of a file of labels of vertices. */
CONUS_API bool conus_path_is_vertex_labels(const char *path);

/* Tractograms */

/** A tractogram of an atlas. */
typedef struct conus_tractogram_info {
    size_t struct_size;
    const char *path;     /**< As opened: bytes, not always UTF-8. Borrowed, as the next two, until the atlas ends. */
    const char *format;   /**< "TrackVis 2, gzip"; "array" of streamlines from memory. */
    const char *sha256;   /**< SHA-256 of the file, in hexadecimal; "" for a folder and for memory. */
    uint64_t streamlines; /**< How many. */
    uint64_t points;      /**< In all of them. */
    double length_mm;     /**< Total length of all of them, mm. */
    double radius;        /**< mm */
    double low[3];        /**< Lowest x, y, z of its points, world mm; NAN without a point. */
    double high[3];       /**< The highest. */
    bool half;            /**< Its points have half precision, as in its file. */
    size_t scalars;       /**< How many conus_atlas_tractogram_scalar() gives. */
    size_t bundle;        /**< Number of the first of the objects that are its streamlines. */
    size_t bundles;       /**< How many follow each other there: its groups and the rest, or one for all. */
} conus_tractogram_info;
#define CONUS_TRACTOGRAM_INFO_INIT CONUS_INIT_(conus_tractogram_info)

/** Counts the tractograms. */
CONUS_API size_t conus_atlas_tractogram_count(const conus_atlas *atlas);

/** Tells about a tractogram.
 * @param[in,out] out Its struct_size is read; unchanged on failure.
 * @param index From 0, in the order in which they were added.
 * @return #CONUS_ERROR_ARGUMENT past the last. */
CONUS_CHECKED conus_status conus_atlas_tractogram(conus_tractogram_info *out, const conus_atlas *atlas, size_t index);

typedef struct conus_tractogram conus_tractogram; /**< Streamlines of a file, for several atlases. */

/** Loads a tractogram that conus_atlas_add_tractogram() adds to one atlas after the other, in memory once.
 * @param options Those that say how the file is read: max_memory and space; NULL = defaults.
 * @return As conus_atlas_add_streamlines(). */
CONUS_CHECKED conus_status conus_tractogram_load(conus_tractogram **out, const char *path,
                                                 const conus_streamlines_options *options);

/** Adds the streamlines of a loaded tractogram, as conus_atlas_add_streamlines() does those of its file.
 * @param atlas The atlas; unchanged on failure.
 * @param tractogram The tractogram. It must outlive the atlas.
 * @param options Name, radius and log; NULL = defaults.
 * @return As conus_atlas_add_streamlines(). */
CONUS_CHECKED conus_status conus_atlas_add_tractogram(conus_atlas *atlas, const conus_tractogram *tractogram,
                                                      const conus_streamlines_options *options);

/** Ends a tractogram, after the atlases that it was added to. */
CONUS_API void conus_tractogram_destroy(conus_tractogram *tractogram);

/** Tells whether a file, or a folder, begins like a tractogram that conus_atlas_add_streamlines() reads. Of VTK's files
 * those with lines and without polygons are.
 * @param path The file or folder.
 * @return True where it is one; false for everything else, also for a file that is not there. */
CONUS_API bool conus_path_is_tractogram(const char *path);

/* Files that programs read and write */

/** Makes a text that came from outside, a name or a path, harmless for a terminal, in place. A space replaces each
 * character that would steer the terminal, except line feeds and tabs. '?' replaces each byte that is not UTF-8.
 * Messages and notes of this library are plain already.
 * @param[in,out] text Ends with a NUL. */
CONUS_API void conus_plain_text(char *text);

/** Has this process remember each file that this library reads from now on, on any thread, until it ends. From then on
 * no function of this library that writes files replaces one of these, by whatever name or link: #CONUS_ERROR_ARGUMENT.
 * What it has written itself and then reads may be written again. */
CONUS_CHECKED conus_status conus_inputs_keep(void);

/** Adds a file that the program has read by itself, or is going to read.
 * @param path What is no regular file is not added. */
CONUS_API void conus_inputs_add(const char *path);

/** Finds out whether a new file @p path would take the place of a file that was read.
 * @param path The file, also by a link to it.
 * @return The name by which it was read, borrowed until the process ends; NULL where it was not. */
CONUS_API const char *conus_inputs_find(const char *path);

/** Gives the name of the file that was read, in the order of reading; a file that was read twice is there twice.
 * @return NULL past the last. Borrowed until the process ends. */
CONUS_API const char *conus_inputs_at(size_t index);

/** Writes a file that appears whole or not at all.
 * @param path The file; replaced if it exists.
 * @return #CONUS_ERROR_IO where the system refuses. */
CONUS_CHECKED conus_status conus_write_file(const char *path, const void *data, size_t size);

/* Manifests */

/** How conus_manifest_write() reads. */
typedef struct conus_manifest_options {
    size_t struct_size;
    uint64_t max_memory; /**< Largest file, in bytes; 0 = 8 GiB. */
    conus_log log;       /**< Receives as what each file was taken, a line each; NULL = silent. */
    void *log_user;      /**< Passed to @p log. */
} conus_manifest_options;
#define CONUS_MANIFEST_OPTIONS_INIT CONUS_INIT_(conus_manifest_options)

/** Writes a first manifest (docs/formats.md) of what lies in the folder of @p path and the folders in it: volumes, FSL
 * atlases, surfaces, BrainGlobe folders. It guesses what a volume is for. A file that is there is never replaced.
 * @param path NAME.atlas.json.
 * @return #CONUS_ERROR_IO where the system refuses, or the file is there; #CONUS_ERROR_DATA where the folder holds
 * nothing for a manifest. */
CONUS_CHECKED conus_status conus_manifest_write(const char *path, const conus_manifest_options *options);

/* Synthetic atlases */

/** The grid of a phantom. */
typedef struct conus_phantom_options {
    size_t struct_size;
    uint32_t size; /**< Voxels along the longest edge, 16 to 512; 0 = 64. Size times the smallest spacing is the cube
                      around the origin for which the shapes are made: 64 mm, or scaled. */
    double spacing[3]; /**< mm; zeros = 1, 1, 1. At least 4 voxels must fit along every edge. */
    double oblique;    /**< Turns the grid about (1, 1, 1) by this angle, degrees. */
    bool flip[3];      /**< Lets i, j, k grow towards left, posterior, inferior. */
} conus_phantom_options;
#define CONUS_PHANTOM_OPTIONS_INIT CONUS_INIT_(conus_phantom_options)

/** A kind of phantom. */
typedef struct conus_phantom_info {
    const char *name;        /**< For conus_phantom_write(). */
    const char *description; /**< One line. */
} conus_phantom_info;

/** Gives entry @p index of the table of phantoms. @return NULL past the last. Static. */
CONUS_API const conus_phantom_info *conus_phantom(size_t index);

/** Writes a phantom: KIND.nii.gz, its label table KIND.tsv, and KIND.json with the shapes in world mm; of the kinds
 * brain and bundle, which take no options, other files (docs/formats.md).
 * @param kind A name of conus_phantom().
 * @param folder Made if missing.
 * @return #CONUS_ERROR_ARGUMENT for another kind or an option out of its range; #CONUS_ERROR_IO where the system
 * refuses. */
CONUS_CHECKED conus_status conus_phantom_write(const char *kind, const char *folder,
                                               const conus_phantom_options *options);

/* Images */

/** Says what the colours of a picture mean: its legend in words, with the names that the atlas has, a line each row.
 * @return UTF-8; "" if there is nothing to say. */
CONUS_API const char *conus_image_legend(const conus_image *image);

/** Makes an image with the channels R, G, B, A from bytes.
 * @param rgba [height width 4] sRGB and opacity, top row first. Copied.
 * @param width Pixels.
 * @param height Pixels.
 * @return #CONUS_ERROR_ARGUMENT for a size out of its range. */
CONUS_CHECKED conus_status conus_image_from_bytes(conus_image **out, const uint8_t *rgba, uint32_t width,
                                                  uint32_t height);

/** Reads OpenEXR (flat scan lines, one part) or PNG (as linear, premultiplied R, G, B, A). The content decides.
 * @return #CONUS_ERROR_IO, #CONUS_ERROR_DATA or #CONUS_ERROR_UNSUPPORTED for a file that cannot be read. */
CONUS_CHECKED conus_status conus_image_load(conus_image **out, const char *path);

/** How two images differ. In a float channel NaN equals NaN and infinity itself; one of them against anything else
 * differs by infinity. */
typedef struct conus_image_difference {
    uint64_t pixels;    /**< Width times height. */
    uint64_t differing; /**< Pixels in which a float channel differs by more than the tolerance, or a uint32 channel at
                           all. */
    double max_difference; /**< Largest difference in any channel. */
    double rms;            /**< Largest root mean square difference of a channel. */
    char channel[32];      /**< The channel of max_difference, "" if there is no difference. */
    uint32_t x;            /**< Column of its first pixel, from the left. */
    uint32_t y;            /**< Row of its first pixel, from the top. */
} conus_image_difference;

/** Compares two images channel by channel; attributes do not count.
 * @param tolerance 0 or more.
 * @return #CONUS_ERROR_ARGUMENT unless both have the same size and the same channels, in whatever order. */
CONUS_CHECKED conus_status conus_image_compare(conus_image_difference *out, const conus_image *a, const conus_image *b,
                                               double tolerance);

/* Pictures */

typedef struct conus_cutter conus_cutter; /**< A flat cut of one atlas that is drawn again and again. */

/** Says whether areas hide the context volume from outside: they lie at or less than 8 mm behind its first bright voxel
 * in 92 of 100 columns that look at it along its axes, from six sides.
 * @param[out] out False without a context, or without areas of voxels that are not hidden.
 * @return The errors of conus_atlas_window(). */
CONUS_CHECKED conus_status conus_context_is_covered(bool *out, const conus_atlas *atlas);

/** Draws the points of a view alone, as conus_render() has them over its drawing, or conus_render_cuts() over a cut:
 * for windows, which lay them over a picture of their own.
 * @param[out] out Channels R, G, B, A, as of conus_render(): transparent but for balls, lines and names. End it with
 * conus_image_destroy().
 * @param atlas What lies far from its box is not drawn, and what lies behind its middle is pale.
 * @param view Its width, height, camera, frustum, field_of_view, dpi, no_legend and points count; of the background
 * whether it is dark; of the selection and own_colours which colours points have.
 * @param cut Where the cut is, and its mm_per_pixel; NULL = the view is in space, and has a camera.
 * @param chosen Index of the point whose name has a place before all others; SIZE_MAX = none.
 * @return #CONUS_ERROR_ARGUMENT for a view or cut out of its range; #CONUS_ERROR_DATA for an atlas without anything
 * that shows; #CONUS_ERROR_MEMORY. */
CONUS_CHECKED conus_status conus_points_image(conus_image **out, const conus_atlas *atlas, const conus_view *view,
                                              const conus_cut_view *cut, size_t chosen);

/** Prepares to draw one cut after the other, as windows do. The pictures are those of conus_cut(), but voxels and
 * surfaces are read again only where a view lies elsewhere. Another selection over the same place costs little.
 * @param atlas Must outlive the cutter and must not change: after conus_atlas_set_threshold(), conus_atlas_set_hidden()
 * or other colours, make another cutter. */
CONUS_CHECKED conus_status conus_cutter_create(conus_cutter **out, const conus_atlas *atlas);

/** Ends a cutter. */
CONUS_API void conus_cutter_destroy(conus_cutter *cutter);

/** Draws a cut into the cutter.
 * @param view What to draw.
 * @return #CONUS_ERROR_ARGUMENT for a view out of its range. */
CONUS_CHECKED conus_status conus_cutter_draw(conus_cutter *cutter, const conus_cut_view *view);

/** Gives the pixels that were drawn last.
 * @return [height width 4] As conus_cut() fills them; NULL before the first picture. Borrowed until the next
 * conus_cutter_draw(), and without a meaning where that failed. */
CONUS_API const uint8_t *conus_cutter_rgba(const conus_cutter *cutter);

/** Gives the numbers of objects of the pixels that were drawn last.
 * @return [height width] As of conus_cutter_rgba(). */
CONUS_API const uint32_t *conus_cutter_objects(const conus_cutter *cutter);

/** Gives the numbers of the objects that the pixels were drawn with: those of conus_cutter_objects() with smooth
 * borders.
 * @return [height width] As of conus_cutter_rgba(). */
CONUS_API const uint32_t *conus_cutter_shown(const conus_cutter *cutter);

/** Names preset @p index of grey values for the context volume. @return NULL past the last. Static. */
CONUS_API const char *conus_transfer_preset(size_t index);

/** Draws a cut as a figure: with letters of directions at its edges where they are within 15 degrees of them, a scale
 * bar, and with a selection its legend, as conus_render() has them.
 * @param[out] out Channels R, G, B, A, as of conus_render(). End it with conus_image_destroy().
 * @param view What to draw. Its width and height are the figure's. A legend on the right takes some of the width; where
 * the cut then becomes narrower than high, mm_per_pixel grows, so that its shorter side shows as much.
 * @param sheet Its legend, background, dpi, no_legend, frame, shapes, measured, listed, points, title and own_colours
 * count; the background is seen beside the cut only. NULL = defaults.
 * @return #CONUS_ERROR_ARGUMENT for a view or sheet out of its range; #CONUS_ERROR_MEMORY for more than 8 GiB, at 32
 * bytes per pixel. */
CONUS_CHECKED conus_status conus_cut_image(conus_image **out, const conus_atlas *atlas, const conus_cut_view *view,
                                           const conus_view *sheet);

#ifdef __cplusplus
}
#endif

#endif
