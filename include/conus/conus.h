/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file conus.h
 * What does this beam, probe or pointing hand reach in the brain?
 *
 * Load an atlas, aim a cone at it from a pose with six degrees of freedom, and read off the areas and pathways in
 * the cone, with shares and contact positions:
 *
 *     conus_atlas *atlas = NULL;
 *     conus_selector *selector = NULL;
 *     conus_selection *selection = NULL;
 *     conus_pose pose;
 *     conus_status status = conus_atlas_load(&atlas, "aal.nii.gz", NULL);
 *     if (!status) status = conus_selector_create(&selector, atlas, NULL);
 *     if (!status) status = conus_pose_toward(&pose, (double[]){-90, 20, 20}, (double[]){0, -10, 10}, NULL);
 *     if (!status) status = conus_select(&selection, selector, &pose, 20 * M_PI / 180);
 *     for (size_t i = 0; i < conus_selection_count(selection); i++) ...
 *     if (status) fprintf(stderr, "%s\n", conus_message());
 *     conus_selection_destroy(selection); conus_selector_destroy(selector); conus_atlas_destroy(atlas);
 *
 * CONVENTIONS (they hold for every function; exceptions are stated where they occur)
 *   Space      World is right-handed RAS+: +x right, +y anterior, +z superior, in millimetres. Angles in radians.
 *   Matrices   Column-major double[16], column vectors, last row 0 0 0 1. `a_from_b` maps b coordinates to a.
 *   Errors     A function that can fail returns conus_status; its outputs are untouched on failure, and
 *              conus_message() says in one line what was found and what is allowed.
 *   Ownership  `conus_x **out` is yours: end it with conus_x_destroy(), which accepts NULL.
 *              A returned `const T *` is borrowed: it lives as long as the object it came from.
 *   Options    A zeroed struct is the default; NULL means the same.
 *   Counting   Accessors of a NULL object count 0. Objects of an atlas are numbered from 1; 0 is "nothing".
 *   Threads    An atlas may be shared by threads once nothing is added to it any more. A selector or renderer belongs
 *              to one thread at a time; one that uses GL, to the thread that made it.
 */
#ifndef CONUS_CONUS_H
#define CONUS_CONUS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define CONUS_API __attribute__((visibility("default")))
#define CONUS_CHECKED __attribute__((visibility("default"), warn_unused_result))
#else
#define CONUS_API
#define CONUS_CHECKED
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define CONUS_VERSION "0.1.0"

typedef struct conus_atlas conus_atlas;             /**< Volumes, areas and pathways of one brain.            */
typedef struct conus_pose_list conus_pose_list;     /**< Poses read from a file.                              */
typedef struct conus_pose_stream conus_pose_stream; /**< Poses being read.                                */
typedef struct conus_selector conus_selector;       /**< An engine made ready for one atlas.                  */
typedef struct conus_selection conus_selection;     /**< The answer to one query. Immutable.                  */
typedef struct conus_tracker conus_tracker;         /**< A selector that remembers.                           */
typedef struct conus_aims conus_aims;               /**< Where poses are, and whether they look at the atlas. */
typedef struct conus_sweep conus_sweep;             /**< What a growing cone admits, and when.                */
typedef struct conus_jitter conus_jitter;           /**< An answer under errors of the pose.                  */
typedef struct conus_report conus_report;           /**< Answers collected for writing.                       */
typedef struct conus_batch conus_batch;             /**< Threads made ready to answer poses by the million.   */
typedef struct conus_renderer conus_renderer;       /**< GL objects of one atlas, for pictures.               */
typedef struct conus_cutter conus_cutter;           /**< A flat cut of one atlas that is drawn again and again. */
typedef struct conus_image conus_image;             /**< Named float and uint32 channels of one picture.      */
typedef struct conus_grid conus_grid;               /**< Numbers on an atlas's voxel grid, to be written.     */

/* ---- Status ----------------------------------------------------------------------------------------------- */

typedef enum conus_status {
    CONUS_OK = 0,
    CONUS_ERROR_ARGUMENT,    /**< An argument breaks its documented range.                                     */
    CONUS_ERROR_MEMORY,      /**< An allocation failed, or the input asks for more than the allowed memory.    */
    CONUS_ERROR_IO,          /**< The system refused to read or write.                                         */
    CONUS_ERROR_DATA,        /**< The file is damaged, contradicts itself or is not of its format.             */
    CONUS_ERROR_UNSUPPORTED, /**< Valid, but beyond this library.                                              */
    CONUS_ERROR_GL           /**< No usable OpenGL 4.5 context, or the driver failed.                          */
} conus_status;

CONUS_API const char *conus_version(void);                  /**< "0.1.0"; static.                              */
CONUS_API const char *conus_status_name(conus_status code); /**< "CONUS_ERROR_DATA"; static.                   */
/** One line about the last failure on this thread, "" if there was none. Borrowed, thread-local. */
CONUS_API const char *conus_message(void);

/* ---- Atlas ------------------------------------------------------------------------------------------------ */

/** Hears what is read now, @p path, and how far loading is: @p done of @p total files are read. The total may change
 * while files tell of others. Called on the thread that loads, before each file; @p path is valid until it returns. */
typedef void (*conus_load_progress)(void *user, const char *path, size_t done, size_t total);

typedef struct conus_load_options {
    const char *labels;  /**< Path of a label table that replaces what lies beside or inside the file; of a
                              surface, of labels of its vertices (.label.gii, .annot).                          */
    uint64_t max_memory; /**< Largest file, and largest volume unpacked, in bytes; 0 = 8 GiB.                   */
    conus_load_progress progress; /**< NULL = nobody wants to know.                                             */
    void *progress_user;
    bool labels_anyway; /**< Every value is a label, even where they look like an image's grey values.          */
} conus_load_options;

/** Loads a labelled volume: NIfTI-1/2 (.nii, .hdr/.img, each also .gz), .mgz/.mgh, or an FSL atlas XML of type Label;
 * or what a manifest NAME.atlas.json joins: parcellation, surfaces, pathways and context; or a surface (GIFTI,
 * FreeSurfer and what conus-mesh reads), cut by the labels of its vertices if there are any; or a folder of
 * surfaces or BrainGlobe folder. What a file is, its content decides.
 * @p path may end in ",volume=K" to choose volume K (from 0) of a 4-D file. docs/formats.md says how the label table is
 * found. Values must be whole numbers from 0 to 4294967295; 0 is background. A volume that looks like an image, not
 * like labels, is CONUS_ERROR_DATA unless labels_anyway; docs/formats.md says how that is told. */
CONUS_CHECKED conus_status conus_atlas_load(conus_atlas **out, const char *path, const conus_load_options *options);
CONUS_API void conus_atlas_destroy(conus_atlas *atlas);

typedef struct conus_pathway_options {
    double threshold; /**< Values at or above it are the pathway (Eq. 6); 0 = a quarter of the file's scale.   */
    const char *name; /**< NULL = its name in an FSL atlas XML near it, else the file's without its ending.     */
    uint64_t max_memory;
} conus_pathway_options;

/** Adds a scalar (probability) volume as one selectable pathway. */
CONUS_CHECKED conus_status conus_atlas_add_pathway(conus_atlas *atlas, const char *path,
                                                   const conus_pathway_options *options);

/** Changes from which value on pathway @p number is one (Eq. 6). What was made for the atlas before (selectors,
 * renderers) must be made anew. */
CONUS_CHECKED conus_status conus_atlas_set_threshold(conus_atlas *atlas, size_t number, double threshold);

typedef struct conus_context_options {
    double block_threshold; /**< Voxels with values at or above it stop what looks at the atlas: a skull, say. What is
                                 behind them is not met, and such pixels met nothing. 0 = none do.               */
    uint64_t max_memory;
} conus_context_options;

/** Sets the volume that is drawn around the areas (a T1, say), replacing one that is there; never selectable. */
CONUS_CHECKED conus_status conus_atlas_set_context(conus_atlas *atlas, const char *path,
                                                   const conus_context_options *options);

typedef enum conus_hemispheres {
    CONUS_HEMISPHERES_AS_IS = 0, /**< As the label table has them.                                             */
    CONUS_HEMISPHERES_SPLIT,     /**< Areas that lie on both sides become two, cut at world x = 0.             */
    CONUS_HEMISPHERES_MERGED     /**< Left and right areas of one name are reported as one.                    */
} conus_hemispheres;

/** Changes how the atlas has left and right areas, once, before a selector or renderer is made; a note says what was
 * done. Splitting takes the plane x = 0 for the midline and changes the numbers of objects. Merging adds areas that the
 * pairs are reported as. docs/model.md, Eq. 10, has the rules. CONUS_ERROR_ARGUMENT where something is hidden,
 * CONUS_ERROR_DATA where nothing can be split or merged,
 * CONUS_ERROR_UNSUPPORTED for splitting meshes. The atlas is unchanged on failure. */
CONUS_CHECKED conus_status conus_atlas_set_hemispheres(conus_atlas *atlas, conus_hemispheres hemispheres);

typedef enum conus_kind {
    CONUS_AREA = 1,
    CONUS_PATHWAY,
    CONUS_UNASSIGNED /**< Of a result: what the cone's pixels hit when they hit no object, or first a context that
                          blocks. */
} conus_kind;

/** An area or a pathway. */
typedef struct conus_object {
    conus_kind kind;
    uint32_t label;           /**< The atlas's own number of the area; a pathway's ordinal, from 1.             */
    const char *name;         /**< UTF-8, one line. An area that no table names is called by its number.        */
    const char *abbreviation; /**< UTF-8; "" if the table gives none.                                           */
    char hemisphere;          /**< 'L', 'R' or 'B' (both) where the table says so, else 0.                      */
    bool named;               /**< The table has a name for it.                                                 */
    uint8_t rgb[3];           /**< sRGB, from the table or else generated.                                      */
    uint32_t parent;          /**< Number of the object that contains it in the area tree, 0 if none.           */
    uint64_t voxels;          /**< Voxels of its own (without its children's).                                  */
    double volume_mm3;        /**< The same in mm^3.                                                            */
    uint64_t triangles;       /**< Of its surface, where the area is a mesh (then voxels is 0).                      */
    bool closed;              /**< That surface bounds a solid. volume_mm3 is 0 if it does not, and if its parts overlap
                                   or face different ways, so that its volume is not known.                          */
} conus_object;

/** Areas come first: those of the parcellation and those that are meshes, each ordered by label, and those that only
 * group others; pathways follow in the order in which they were added. */
CONUS_API size_t conus_atlas_object_count(const conus_atlas *atlas);
/** Object @p number, 1 to count; NULL outside. */
CONUS_API const conus_object *conus_atlas_object(const conus_atlas *atlas, size_t number);
/** Depth of an area in the tree, as levels count it: roots have 1, merged areas that of their pair. 0 of a pathway. */
CONUS_API uint32_t conus_atlas_depth(const conus_atlas *atlas, size_t number);

/** The number of the pathway called @p name, or else of the one area with that name, abbreviation or label.
 * CONUS_ERROR_ARGUMENT, with the closest one in the message, if there is none, and if there are several. */
CONUS_CHECKED conus_status conus_atlas_find(uint32_t *out, const conus_atlas *atlas, const char *name);

/* What is hidden is as if it had never been loaded: not hit, not drawn, and it blocks nothing. Shown objects keep their
 * numbers, volumes and fractions. Selectors and cutters that were made before must be made anew, and renderers be told
 * (conus_renderer_update()). */

/** Shows all objects, or only those that @p only names, and of these hides those that @p hide names. Both are lists,
 * separated by commas, of names, abbreviations and labels; an area stands for all below it in the area tree. A name
 * with a comma stands in double quotes, @FILE for a file with one name per line. NULL = no list.
 * CONUS_ERROR_ARGUMENT, with the closest name in the message, for what is no object, and where nothing is left. */
CONUS_CHECKED conus_status conus_atlas_show(conus_atlas *atlas, const char *only, const char *hide);
/** Hides the objects that @p hidden [object count + 1] says, by number, and shows all others; NULL shows all. */
CONUS_CHECKED conus_status conus_atlas_set_hidden(conus_atlas *atlas, const bool *hidden);
CONUS_API bool conus_atlas_is_hidden(const conus_atlas *atlas, size_t number);

typedef enum conus_role { CONUS_PARCELLATION = 1, CONUS_SCALAR, CONUS_CONTEXT } conus_role;

typedef struct conus_volume_info {
    conus_role role;
    const char *path;            /**< Of the voxels, as opened: bytes, not always UTF-8.                       */
    char sha256[65];             /**< Of that file's bytes.                                                    */
    char format[48];             /**< "NIfTI-1, gzip, big-endian".                                             */
    char datatype[16];           /**< "uint8", "float64".                                                      */
    size_t dim[3];               /**< Voxels along i, j, k.                                                    */
    size_t volume, volume_count; /**< Which of how many volumes of a 4-D file.                                 */
    double world_from_voxel[16]; /**< Maps voxel indices (centres at whole numbers) to world mm.               */
    double spacing[3];           /**< Edge lengths of a voxel in mm.                                           */
    char orientation[4];         /**< Towards which i, j, k grow: "RAS", "LPI".                                */
    char transform[96];          /**< Where world_from_voxel comes from: "sform, code 4 (MNI 152)".            */
    int space_code;              /**< NIfTI's code of the space that it maps to, 4 for MNI 152; 0 if unknown.  */
    double slope, intercept;     /**< Of the stored values; 1 and 0 if unscaled.                               */
    double minimum, maximum;     /**< Of the scaled values.                                                    */
    double threshold;            /**< Of a pathway, or of a context that blocks; else 0.                       */
} conus_volume_info;

/** The parcellation comes first, if there is one; pathways and the context follow. */
CONUS_API size_t conus_atlas_volume_count(const conus_atlas *atlas);
CONUS_API const conus_volume_info *conus_atlas_volume(const conus_atlas *atlas, size_t index);

/** Paths of the other files that an atlas is made of: a manifest, surfaces, labels of their vertices, lists of what is
 * shown. */
CONUS_API size_t conus_atlas_file_count(const conus_atlas *atlas);
CONUS_API const char *conus_atlas_file(const conus_atlas *atlas, size_t index);

/** Gives all areas and pathways colours that people with any colour vision tell apart as well as can be. Renderers made
 * before keep the old ones. */
CONUS_API void conus_atlas_use_safe_colours(conus_atlas *atlas);
/** Gives them back those that they had. */
CONUS_API void conus_atlas_use_own_colours(conus_atlas *atlas);

/** The box, in world mm, around all voxels and triangles of areas and pathways that are not hidden. CONUS_ERROR_DATA if
 * there are none. */
CONUS_CHECKED conus_status conus_atlas_bounds(const conus_atlas *atlas, double low[3], double high[3]);
/** The mean position, in world mm, of the voxels or triangles of an object and of those below it in the area tree,
 * hidden or not.
 * CONUS_ERROR_DATA if there are none. */
CONUS_CHECKED conus_status conus_atlas_centre(double out[3], const conus_atlas *atlas, size_t number);

/** How many voxels of scalar or context volume @p index have values in each of @p bins equal parts of its range from
 * minimum to maximum. */
CONUS_CHECKED conus_status conus_atlas_histogram(uint64_t *counts, size_t bins, const conus_atlas *atlas, size_t index);
/** The value of scalar or context volume @p index at a world position, between its voxels' centres; NaN outside its
 * cells, and where there is no such volume. */
CONUS_API double conus_atlas_value(const conus_atlas *atlas, size_t index, const double point[3]);
/** The grey values of scalar or context volume @p index that span its contrast, without a few extremes. */
CONUS_CHECKED conus_status conus_atlas_window(double window[2], const conus_atlas *atlas, size_t index);

/** Where the names come from, in words: "ITK-SNAP labels in aal.label", "none found". */
CONUS_API const char *conus_atlas_label_source(const conus_atlas *atlas);

/** What a careful user should know about this atlas, a line each: labels without names, a guessed space, ... */
CONUS_API size_t conus_atlas_note_count(const conus_atlas *atlas);
CONUS_API const char *conus_atlas_note(const conus_atlas *atlas, size_t index);

/* An atlas in the memory of several processes: one of them loads it, packs it into memory that all of them map (a file
 * of memfd_create(), POSIX shared memory, an MPI window, Python's multiprocessing.shared_memory), and all attach it
 * there. Voxels, values, vertices, triangles and what the rays engine makes of voxels are in that memory once; names
 * and the like each process has for itself, as Embree's trees over triangles, which cannot be moved. */

/** Bytes that conus_atlas_pack() needs. */
CONUS_API size_t conus_atlas_packed_size(const conus_atlas *atlas);
/** Packs the atlas as it is into @p size bytes at @p memory, a multiple of 64. They hold no pointers and may be mapped
 * elsewhere in each process, but are for this version of conus on this kind of machine: no format of files. On failure
 * what they hold is of no use. */
CONUS_CHECKED conus_status conus_atlas_pack(void *memory, size_t size, const conus_atlas *atlas);
/** The atlas that was packed there. @p memory, which is never written to, must outlive it. An atlas that is changed
 * (its thresholds, its hemispheres) gets copies of the arrays that this concerns. CONUS_ERROR_DATA where there is no
 * whole atlas of this version; the large arrays themselves are trusted. */
CONUS_CHECKED conus_status conus_atlas_attach(conus_atlas **out, const void *memory, size_t size);

/* ---- Poses ------------------------------------------------------------------------------------------------ */

/** Rigid position and orientation of a device. It looks down its own -z; +y is up (Eq. 2). */
typedef struct conus_pose {
    double world_from_device[16];
} conus_pose;

/** A device at @p origin looking along @p direction (any length but 0); @p up NULL = Eq. 2's default. */
CONUS_CHECKED conus_status conus_pose_along(conus_pose *out, const double origin[3], const double direction[3],
                                            const double up[3]);
/** A device at @p origin looking at the point @p target. */
CONUS_CHECKED conus_status conus_pose_toward(conus_pose *out, const double origin[3], const double target[3],
                                             const double up[3]);
/** From a rigid, right-handed matrix; deviations up to 1e-3 (rounded digits in files) are made exact. */
CONUS_CHECKED conus_status conus_pose_from_matrix(conus_pose *out, const double world_from_device[16]);
/** From a position and a quaternion (w, x, y, z) of any length but 0. */
CONUS_CHECKED conus_status conus_pose_from_quaternion(conus_pose *out, const double origin[3], const double wxyz[4]);

/** The viewer-centred projection (Eq. 1): the camera and the frustum (as in conus_view) of an eye that looks through a
 * window, say at a screen. @p window: its middle, +x to its right, +y up, +z to the side of the eye; @p size: its width
 * and height, mm. The eye must be before it: no edge may be more than 1000 times as far off as the eye is near. */
CONUS_CHECKED conus_status conus_look_through(conus_pose *camera, double frustum[4], const conus_pose *window,
                                              const double size[2], const double eye[3]);

typedef enum conus_space { CONUS_RAS = 0, CONUS_LPS } conus_space;

/** The axis of a device along which it looks. */
typedef enum conus_axis {
    CONUS_AXIS_OF_FORMAT = 0, /**< As the file's format has it (docs/formats.md): -z where nothing is said.       */
    CONUS_AXIS_PLUS_X,
    CONUS_AXIS_MINUS_X,
    CONUS_AXIS_PLUS_Y,
    CONUS_AXIS_MINUS_Y,
    CONUS_AXIS_PLUS_Z,
    CONUS_AXIS_MINUS_Z
} conus_axis;

/** What a file of poses is written in; docs/formats.md describes each. */
typedef enum conus_pose_format {
    CONUS_POSES_AUTO = 0,   /**< The content decides.                                                               */
    CONUS_POSES_TABLE,      /**< A table (TSV or CSV) whose header names the columns.                               */
    CONUS_POSES_MATRIX,     /**< Sixteen numbers, a row-major world_from_device.                                    */
    CONUS_POSES_POINTS,     /**< Lines of x y z and perhaps a name: points.                                         */
    CONUS_POSES_BRAINSIGHT, /**< Brainsight's export: targets, samples, electrodes.                                */
    CONUS_POSES_LOCALITE,   /**< Localite's InstrumentMarker*.xml and TriggerMarkers*.xml.                           */
    CONUS_POSES_ELECTRODES, /**< BIDS *_electrodes.tsv, with the *_coordsystem.json beside it: points.             */
    CONUS_POSES_MARKUPS /**< 3D Slicer's .mrk.json: lines, and points.                                             */
} conus_pose_format;

/** "auto", "table", ...: the name of format @p index, NULL past the last. */
CONUS_API const char *conus_pose_format_name(size_t index);

typedef struct conus_pose_options {
    conus_space space; /**< Of the numbers in the file, where it does not say so itself.                   */
    conus_axis axis;   /**< Where the file gives rotations.                                                */
    conus_pose_format format;
    bool along_shafts;   /**< CONUS_POSES_ELECTRODES: not points, but poses at the contacts that look along
                              their shafts, each to the contact with the next higher number.                 */
    uint64_t max_memory; /**< Largest file of a format that is read whole, in bytes; 0 = 1 GiB.              */
} conus_pose_options;

/** One row of a pose file. */
typedef struct conus_pose_row {
    const char *id; /**< Column query_id, or the row's number from 1. Ids may repeat.                             */
    size_t line;    /**< Line in the file, from 1; of CONUS_POSES_MARKUPS the markup.    */
    conus_pose pose;
    bool is_point;     /**< Only a position (the pose's, which is not turned), not where it looks.                */
    bool trigger;      /**< Column trigger; false if absent.                                                      */
    double angle;      /**< Column angle, full opening; 0 if absent.                                              */
    double time_s;     /**< Column time_s, seconds; NaN if absent.                                                */
    double error_deg;  /**< Column error_deg: how far off the direction may be, degrees (not radians); NaN if
                            absent.                                                                               */
    double error_mm;   /**< Column error_mm: how far off the position may be; NaN if absent.                      */
    const char *error; /**< NULL, or why the row is no pose; then only id and line are to be used.                */
} conus_pose_row;

/** Opens poses for reading one block after the other: tables and points of any length in memory that does not grow,
 * other formats whole. @p path may be a pipe; NULL or "-" is standard input. A file without any pose opens, too, unless
 * nothing in it tells what it is. A file that changes before all of it is read is CONUS_ERROR_IO. The stream belongs to
 * one thread at a time. */
CONUS_CHECKED conus_status conus_pose_stream_open(conus_pose_stream **out, const char *path,
                                                  const conus_pose_options *options);
/** Reads the next @p count of at most @p capacity rows (at least 1), fewer only at the end, 0 when there are no more.
 * A bad row is given with its error. Strings live until the next call on the stream. */
CONUS_CHECKED conus_status conus_pose_stream_read(conus_pose_stream *stream, conus_pose_row *rows, size_t capacity,
                                                  size_t *count);
/** Passes over the next @p rows rows, or those that are left, without reading what they say: much faster. */
CONUS_CHECKED conus_status conus_pose_stream_skip(conus_pose_stream *stream, uint64_t rows);
/** How many rows there are in all, those already read included. CONUS_ERROR_UNSUPPORTED for what is read as it comes
 * from a pipe. */
CONUS_CHECKED conus_status conus_pose_stream_count(conus_pose_stream *stream, uint64_t *count);
/** Whether rows are read as they come, from a pipe. */
CONUS_API bool conus_pose_stream_is_live(const conus_pose_stream *stream);
/** Ends a live stream behind the last whole line that has come, also for a thread that waits for the next one. Of
 * others it changes nothing. May be called at any time, by any thread and by a signal's handler. */
CONUS_API void conus_pose_stream_stop(conus_pose_stream *stream);
/** What the poses are written in; never CONUS_POSES_AUTO. */
CONUS_API conus_pose_format conus_pose_stream_format(const conus_pose_stream *stream);
/** The space as the file names it, "NIfTI:Scanner", "MNI152NLin2009cAsym"; "" if it names none. Borrowed. */
CONUS_API const char *conus_pose_stream_space(const conus_pose_stream *stream);
/** Whether rows may have a time_s: false of a table without that column and of formats without times, and where
 * everything was read and no row has one. */
CONUS_API bool conus_pose_stream_has_times(const conus_pose_stream *stream);
/** The table of electrodes (BIDS) that was read, for conus_report_options.electrodes; NULL of other formats. Borrowed.
 */
CONUS_API const char *conus_pose_stream_electrodes(const conus_pose_stream *stream);
/** Path of the *_coordsystem.json that says what the positions of electrodes (BIDS) are in; "" where there is none.
 * Borrowed. */
CONUS_API const char *conus_pose_stream_coordsystem(const conus_pose_stream *stream);
/** SHA-256 of that file as it was read; "" where there is none. Borrowed. */
CONUS_API const char *conus_pose_stream_coordsystem_sha256(const conus_pose_stream *stream);
/** SHA-256, in hexadecimal with a final NUL, of the file of the poses: of the bytes that this stream has read, and of
 * the rest, which it reads now, so that there are no rows afterwards. CONUS_ERROR_UNSUPPORTED for a pipe. */
CONUS_CHECKED conus_status conus_pose_stream_sha256(char out[65], conus_pose_stream *stream);
/** CONUS_ERROR_DATA where the file and the atlas say that they belong to different brains, somebody's scan and a
 * template, say; a note where one of them does not say. A file that names no space fits any atlas. */
CONUS_CHECKED conus_status conus_pose_stream_match(conus_pose_stream *stream, const conus_atlas *atlas);
/** What a careful user should know about these poses, a line each; NULL past the last. */
CONUS_API const char *conus_pose_stream_note(const conus_pose_stream *stream, size_t index);
CONUS_API void conus_pose_stream_destroy(conus_pose_stream *stream);

/** Reads all rows of conus_pose_stream_open(); there may be none. */
CONUS_CHECKED conus_status conus_pose_list_load(conus_pose_list **out, const char *path,
                                                const conus_pose_options *options);
CONUS_API size_t conus_pose_list_count(const conus_pose_list *list);
CONUS_API const conus_pose_row *conus_pose_list_row(const conus_pose_list *list, size_t index);
/** As conus_pose_stream_electrodes(). */
CONUS_API const char *conus_pose_list_electrodes(const conus_pose_list *list);
/** As conus_pose_stream_coordsystem(). */
CONUS_API const char *conus_pose_list_coordsystem(const conus_pose_list *list);
/** As conus_pose_stream_match(). */
CONUS_CHECKED conus_status conus_pose_list_match(conus_pose_list *list, const conus_atlas *atlas);
/** As conus_pose_stream_note(). */
CONUS_API const char *conus_pose_list_note(const conus_pose_list *list, size_t index);
CONUS_API void conus_pose_list_destroy(conus_pose_list *list);

/* ---- Selection -------------------------------------------------------------------------------------------- */

typedef enum conus_engine { CONUS_ENGINE_AUTO = 0, CONUS_ENGINE_RAYS, CONUS_ENGINE_GL } conus_engine;
typedef enum conus_aperture { CONUS_CIRCLE = 0, CONUS_SQUARE } conus_aperture;
typedef enum conus_sampling { CONUS_EXACT = 0, CONUS_SLICES } conus_sampling;
typedef enum conus_layers { CONUS_VISIBLE = 0, CONUS_ALL_LAYERS } conus_layers;

/** Receives a driver's or engine's messages, one line each, on the thread that called into the library. */
typedef void (*conus_log)(void *user, const char *line);

typedef struct conus_selector_options {
    conus_engine engine;     /**< auto: rays, which needs no driver and gives the pixels that gl gives.          */
    conus_aperture aperture; /**< Which pixels count as the cone (Eq. 3).                                        */
    conus_sampling sampling; /**< Exact cells (Eq. 5) or the paper's slices (Eq. 7).                             */
    uint32_t resolution;     /**< n of the n x n buffer, 1 to 1024; 0 = 16.                                      */
    uint32_t slices;         /**< N of Eq. 7; the ID pass takes N/5. 0 = default.                                */
    conus_layers layers;     /**< What the pixels meet first, or also all that their rays pass (Eq. 10).         */
    double range[2];         /**< Nearest and farthest depth along the axis, mm from the apex: what lies outside is
                                  as if it were not there. Both 0 = everything.                                  */
    double radius;           /**< mm: instead of a cone a cylinder about the axis, whose angle is 0. 0 = a cone. */
    const char *level;       /**< Areas are rolled up the area tree: to a depth ("2", roots are at 1), or to the nearest
                                  of listed areas ("Thalamus,Isocortex"; docs/commands.md has more). NULL = none are. */
    const char *score;       /**< Ranking, a name from conus_score() or a formula of them; NULL = "share".       */
    conus_log log;           /**< NULL = silent.                                                                 */
    void *log_user;
} conus_selector_options;

/** Builds the engine. The atlas must outlive the selector, and nothing may be added to it meanwhile. */
CONUS_CHECKED conus_status conus_selector_create(conus_selector **out, const conus_atlas *atlas,
                                                 const conus_selector_options *options);
CONUS_API void conus_selector_destroy(conus_selector *selector);
/** The engine in use, in words: "rays, avx512", "gl, llvmpipe (LLVM 15.0.6, 256 bits)". */
CONUS_API const char *conus_selector_engine(const conus_selector *selector);

/** Poses of one kind. */
typedef struct conus_oddity {
    uint64_t count;
    uint64_t first;  /**< The lowest number among them; then of that one: */
    uint32_t object; /**< the object that it is inside of, else 0,        */
    conus_pose pose;
    double angle;
} conus_oddity;

/** What is odd about where poses are and look, which often comes from another space or unit. */
typedef struct conus_astray {
    uint64_t poses;      /**< So many were looked at.                                                            */
    conus_oddity inside; /**< A cone's apex is in a voxel of an area or pathway, or, with exact sampling, inside a
                              closed surface; of several such surfaces @p object is the smallest.        */
    conus_oddity away;   /**< The cone or cylinder misses the box around all areas and pathways.                 */
    conus_oddity tiny;   /**< Within 1 mm of 0 in every coordinate, and not at 0.                                */
} conus_astray;

/** Counts for the atlas, aperture and radius of @p selector, which must outlive it. */
CONUS_CHECKED conus_status conus_aims_create(conus_aims **out, const conus_selector *selector);
CONUS_API void conus_aims_destroy(conus_aims *aims);
/** Counts a pose; @p number is the caller's. One that conus_select() refuses is passed over. It
 * compares the apex with boxes, and sends one ray where that lies in the box around a closed surface. */
CONUS_API void conus_aims_add(conus_aims *aims, uint64_t number, const conus_pose *pose, double angle);
/** Borrowed. */
CONUS_API const conus_astray *conus_aims_found(const conus_aims *aims);

/** Aims a cone with full opening @p angle, in (0, pi), from @p pose; or a cylinder, with @p angle 0. */
CONUS_CHECKED conus_status conus_select(conus_selection **out, conus_selector *selector, const conus_pose *pose,
                                        double angle);
/** What is at a point and within @p radius mm of it, instead of in a cone: an object with a voxel's cell or a part of
 * its surface there has a result. Volume, fraction and the like are those of voxels with their centre in the ball;
 * share is their part of all such voxels of the object's grid, NaN for a mesh, and the score; distance is that of the
 * nearest point of a cell or surface, 0 within the object, and contact that point. There are no pixels, and no picture
 * of it. CONUS_ERROR_ARGUMENT with a selector that has a range. */
CONUS_CHECKED conus_status conus_select_ball(conus_selection **out, conus_selector *selector, const double center[3],
                                             double radius);
CONUS_API void conus_selection_destroy(conus_selection *selection);

/** One object met by the cone. */
typedef struct conus_result {
    conus_kind kind;
    uint32_t object;   /**< Number in the atlas, as what it is reported (level); 0 for CONUS_UNASSIGNED.        */
    uint32_t rank;     /**< From 1; 0 for CONUS_UNASSIGNED.                                                     */
    double score;      /**< By the selector's score; higher is better.                                          */
    uint32_t pixels;   /**< Pixels of the cone that meet it first.                                              */
    double share;      /**< Its part of the cone's solid angle (Eq. 4); all shares sum to 1.                    */
    double center_px;  /**< Smallest distance of its pixels to the buffer's centre, in pixels.                  */
    double offset;     /**< Smallest angle of its rays to the axis, radians.                                    */
    double distance;   /**< Nearest first contact of any of its pixels, mm from the apex.                       */
    double contact[3]; /**< World position of its contact (Eq. 11); NaN if no pixel met it first.               */

    /* With CONUS_ALL_LAYERS (Eq. 10); else 0, and NaN where 0 would say something. */
    uint32_t pierced;     /**< Pixels of the cone whose ray passes it, occluded or not.                         */
    double entry, exit;   /**< Nearest entry and farthest exit of any of these rays, mm from the apex.          */
    double path;          /**< Mean length of these rays inside it, mm.                                         */
    uint64_t voxels;      /**< Its voxels whose centre is in the cone.                                          */
    double volume;        /**< Their volume, mm^3; of a mesh, estimated from the rays.                          */
    double fraction;      /**< That volume as a part of its whole one.                                          */
    double cone_fraction; /**< And as a part of the volume of all areas in the cone.                            */
    double sum_value;     /**< Of a pathway: sum of the values of these voxels,                                 */
    double mean_value;    /**< their mean,                                                                      */
    double max_value;     /**< and the largest.                                                                 */
    double centroid[3];   /**< World position: mean of these voxels' centres, weighted by a pathway's values.   */
} conus_result;

/** Results by rank, unassigned last (there even if nothing is unassigned). With CONUS_ALL_LAYERS objects that are
 * occluded, or too thin for any ray but with a voxel's centre in the cone, have results of 0 pixels. */
CONUS_API size_t conus_selection_count(const conus_selection *selection);
CONUS_API const conus_result *conus_selection_result(const conus_selection *selection, size_t index);

/** The evidence behind the results: for each of n x n pixels, row j = 0 at the device's bottom (Eq. 3). */
typedef struct conus_evidence {
    uint32_t resolution;
    const uint32_t *object; /**< [n*n] object met first, as it is reported (level), 0 if none; pixels outside the
                                 aperture too.                                                                   */
    const double *distance; /**< [n*n] mm from the apex along the ray, infinity if nothing.                      */
    const uint64_t *voxel;  /**< [n*n] linear index i + dim0 (j + dim1 k) in the volume of what is met, or
                                 the triangle of its mesh; UINT64_MAX if nothing.     */
    const bool *in_cone;    /**< [n*n] the aperture.                                                             */
} conus_evidence;

CONUS_API conus_evidence conus_selection_evidence(const conus_selection *selection);
/** World position of the contact at @p pixel (row-major index); NaN where it hit nothing, or there is no pixel. */
CONUS_API void conus_selection_position(const conus_selection *selection, size_t pixel, double out[3]);

/** A piece of a pixel's ray inside one object. */
typedef struct conus_span {
    uint32_t pixel;     /**< Index into the evidence's arrays.                                                    */
    uint32_t object;    /**< Number in the atlas, as it is reported (level): pieces of one group that touch are one. */
    double entry, exit; /**< mm from the apex; equal where the ray only touches it, or the surface is not closed. */
    uint64_t voxel;     /**< The voxel (or triangle) of the entry, as in the evidence.                            */
} conus_span;

/** With CONUS_ALL_LAYERS, all pieces of all rays, by pixel, then entry, then object; else NULL, and @p count 0. */
CONUS_API const conus_span *conus_selection_spans(const conus_selection *selection, size_t *count);

typedef struct conus_score_info {
    const char *name, *description;
    bool needs_history; /**< Only a conus_tracker has it. */
    bool needs_layers;  /**< Only with CONUS_ALL_LAYERS.  */
} conus_score_info;

/** The table of rankings (Eq. 12): entry @p index, NULL past the last. */
CONUS_API const conus_score_info *conus_score(size_t index);
/** What the ranking @p score needs: a name, or a formula of names, numbers, + - * /, a minus in front and parentheses,
 * as "0.5*share + 0.5*centre". out->name is @p score, "share" for NULL. CONUS_ERROR_ARGUMENT says what is wrong with a
 * formula. Where a name has no value, or a divisor is 0, the formula has none: such objects rank last. */
CONUS_CHECKED conus_status conus_score_parse(conus_score_info *out, const char *score);

/* ---- Tracks ----------------------------------------------------------------------------------------------- */

/** Constants of the scores that need a history (Eq. 12). */
typedef struct conus_tracker_options {
    double window;     /**< T of time and stability, s; after longer without a step all starts afresh. 0 = 2.     */
    double stickiness; /**< IntenSelect's c_s, in (0, 1), what is kept of a score in one frame. 0 = 0.5.          */
    double snappiness; /**< And c_g, up to 1, what is added of the new one. 0 = 0.5.                              */
    double rate;       /**< Hz: a frame of c_s and c_g is 1/rate. 0 = 60.                                         */
    double growth;     /**< Of IntenSelect+, 1/s. 0 = 7.5.                                                        */
    double decay;      /**< And where an object contributes less than it did, 1/s. 0 = 5.                         */
    double exponent;   /**< k of both, in (0, 1]. 0 = 4/5.                                                        */
    double delay;      /**< s before the trigger of what it confirms, up to the window. 0 = 0.15; below 0 = none. */
} conus_tracker_options;

/** Follows a device: what its selector finds, ranked with what came before. The selector must outlive it. */
CONUS_CHECKED conus_status conus_tracker_create(conus_tracker **out, conus_selector *selector,
                                                const conus_tracker_options *options);
CONUS_API void conus_tracker_destroy(conus_tracker *tracker);

/** The device at @p time_s, seconds of any clock: conus_select() with a history. Objects that left the cone stay in
 * the ranking, with 0 pixels, for as long as they have a score or could be confirmed. @p trigger: it is held down; the
 * step at which it goes down confirms what was selected `delay` ago, before the press moved the hand. A step before the
 * last one is CONUS_ERROR_ARGUMENT; after any failure the tracker is as it was, so that a lost frame is one that was
 * never there. Of two steps at one time the later one counts from there on. */
CONUS_CHECKED conus_status conus_tracker_step(conus_selection **out, conus_tracker *tracker, double time_s,
                                              const conus_pose *pose, double angle, bool trigger);
/** The object that was selected @p ago seconds before the last step, 0 to the window; 0 if none was. */
CONUS_API uint32_t conus_tracker_selected(const conus_tracker *tracker, double ago);

/** Where a selection stands in its track. */
typedef struct conus_step {
    double time_s;
    uint32_t selected;  /**< The first by rank of what is in the cone or has a score from before; 0 = none. */
    uint32_t confirmed; /**< Object that the trigger confirms at this step; 0 = none, no press. */
} conus_step;

/** NULL if the selection is not from a tracker. */
CONUS_API const conus_step *conus_selection_step(const conus_selection *selection);

/* ---- How sure is it? -------------------------------------------------------------------------------------- */

/** When a growing cone admits an object (Eq. 13). */
typedef struct conus_admission {
    conus_kind kind;
    uint32_t object;
    double angle;    /**< Full opening of the narrowest round cone that holds some of it, radians; 0 if the axis meets
                          it. Of voxels their centres count, of a mesh all its surface, and its inside where closed. */
    double margin;   /**< Further opening until the next object, NaN if there is none.                           */
    double point[3]; /**< World position of what is admitted first.                                              */
    double distance; /**< mm from the apex to there.                                                             */
    bool is_surface; /**< It is a mesh's; else a voxel's centre.                                                 */
} conus_admission;

/** Finds when a cone at @p pose that grows to the full opening @p widest, in (0, pi), admits each object. Occluded
 * objects count, and the selector's range and level. CONUS_ERROR_ARGUMENT for a selector with a square aperture or a
 * radius. */
CONUS_CHECKED conus_status conus_sweep_create(conus_sweep **out, const conus_selector *selector, const conus_pose *pose,
                                              double widest);
CONUS_API void conus_sweep_destroy(conus_sweep *sweep);
/** Admissions by angle. */
CONUS_API size_t conus_sweep_count(const conus_sweep *sweep);
CONUS_API const conus_admission *conus_sweep_admission(const conus_sweep *sweep, size_t index);

/** How far off a pose may be: independent normal errors (Eq. 14). */
typedef struct conus_jitter_options {
    double tilt;      /**< Standard deviation of the axis's tilt about the device's x, and about its y; radians, 0 to
                           pi/2.                                                                                 */
    double shift;     /**< And of the position along each of its axes, mm, 0 to 1e6.                             */
    uint32_t samples; /**< Poses to look from, a power of two from 16 to 2^20; 0 = 1024.                         */
} conus_jitter_options;

/** What an object may expect. */
typedef struct conus_chance {
    conus_kind kind;
    uint32_t object;  /**< 0 for CONUS_UNASSIGNED.                                                              */
    uint32_t rank;    /**< From 1, by hit; 0 for CONUS_UNASSIGNED.                                              */
    double hit;       /**< Probability that it is the one hit: of the objects that pixels meet first, the one that the
                           selector ranks best; CONUS_UNASSIGNED where no pixel meets any. They sum to 1.       */
    double hit_error; /**< Standard error of that number, from 16 independent sets of samples.                  */
    double seen;      /**< Probability that some pixel meets it first.                                          */
    double in_cone;   /**< Probability that it is in the cone at all; NaN without CONUS_ALL_LAYERS.             */
    double share;     /**< Mean share (Eq. 4); they sum to 1.                                                   */
    double share_deviation; /**< And its standard deviation from sample to sample.                               */
} conus_chance;

/** Looks from poses around @p pose as its errors make them, always the same ones: low-discrepancy samples without a
 * random seed. */
CONUS_CHECKED conus_status conus_jitter_create(conus_jitter **out, conus_selector *selector, const conus_pose *pose,
                                               double angle, const conus_jitter_options *options);
CONUS_API void conus_jitter_destroy(conus_jitter *jitter);
/** Chances by rank, of what is unassigned last. */
CONUS_API size_t conus_jitter_count(const conus_jitter *jitter);
CONUS_API const conus_chance *conus_jitter_chance(const conus_jitter *jitter, size_t index);

/* ---- Reports ---------------------------------------------------------------------------------------------- */

typedef enum conus_format {
    CONUS_TABLE = 0,
    CONUS_TSV,
    CONUS_CSV, /**< The columns of CONUS_TSV between commas (RFC 4180). */
    CONUS_JSON,
    CONUS_NDJSON,
    /* What other programs read, of CONUS_ANSWERS, as a whole (docs/formats.md). */
    CONUS_AFNI,      /**< The tables of AFNI's whereami -tab, of each query.                                       */
    CONUS_BIDS,      /**< A BIDS table of electrodes, with columns added.                                          */
    CONUS_SPIKEGLX,  /**< The areas along the shanks of a probe, in micrometres from the first contact.            */
    CONUS_OPEN_EPHYS /**< The areas of a probe's channels, from 0.                                                 */
} conus_format;

/** What a report has rows of; each with its own columns. */
typedef enum conus_rows {
    CONUS_ANSWERS = 0, /**< Of conus_report_add().                                                               */
    CONUS_SHARES,      /**< The same with the angle, and for people a table of shares by angle; answers in a row that
                            have one id belong together.                                                         */
    CONUS_ADMISSIONS,  /**< Of conus_report_add_sweep().                                                         */
    CONUS_CHANCES,     /**< Of conus_report_add_jitter().                                                        */
    CONUS_SUMMARIES    /**< Of conus_report_add(), one row each: the best, the runner-up, and by how much. Not as
                            CONUS_TABLE.                                                                         */
} conus_rows;

typedef struct conus_report_options {
    conus_rows rows;
    conus_format format;
    conus_space space;   /**< Of the positions written.                                                          */
    bool all_voxels;     /**< conus_report_voxels(): areas' voxels too, not only pathways'.                      */
    bool no_voxels;      /**< Do not keep any for it: quicker, and less memory.                                  */
    const char *command; /**< The command line, for the provenance; NULL = none.                                 */
    const conus_tracker *tracker; /**< Of a report on its steps, with the columns time_s, selected and confirmed; it
                                       must outlive the report. NULL = none.                             */
    bool selected_only;           /**< Of a step only what is selected or confirmed; or, if nothing is, what is
                                       unassigned.                                                       */
    const char *electrodes;       /**< For CONUS_BIDS: the text of the table of which each row is a query, errors
                                       among them. NULL = none.                                          */
} conus_report_options;

/** Starts a report on answers of @p selector. Strings of @p options must outlive the report. */
CONUS_CHECKED conus_status conus_report_create(conus_report **out, const conus_selector *selector,
                                               const conus_report_options *options);
/** Adds one answer; @p query_id is copied, as UTF-8 without control characters. */
CONUS_CHECKED conus_status conus_report_add(conus_report *report, const char *query_id,
                                            const conus_selection *selection);
/** Adds what a growing cone admits. */
CONUS_CHECKED conus_status conus_report_add_sweep(conus_report *report, const char *query_id, const conus_sweep *sweep);
/** Adds an answer under errors of the pose. */
CONUS_CHECKED conus_status conus_report_add_jitter(conus_report *report, const char *query_id,
                                                   const conus_jitter *jitter);
/** Adds a query without an answer: one row of kind "error" with "line N: " and @p reason for a name, all else missing.
 * @p line is the pose's in its file; 0 = it has none, and only the reason is written. */
CONUS_CHECKED conus_status conus_report_add_error(conus_report *report, const char *query_id, size_t line,
                                                  const char *reason);
/** The whole text in the report's format. Borrowed until the next call on the report. */
CONUS_CHECKED conus_status conus_report_text(conus_report *report, const char **text, size_t *size);
/** The same for a report that goes on: the text of the answers since the last call, which are then forgotten. The
 * heading of TSV, CSV and CONUS_BIDS, or of a track's table, comes once, with the first call. Not for CONUS_JSON and
 * the strings of probes, which are one whole. */
CONUS_CHECKED conus_status conus_report_take(conus_report *report, const char **text, size_t *size);
/** The voxels met first (with all layers, and of a ball, all with their centre in it), nearest first, as TSV: query
 * pathway i j k x y z value distance_mm kind index. Borrowed likewise. */
CONUS_CHECKED conus_status conus_report_voxels(conus_report *report, const char **text, size_t *size);
/** The JSON sidecar: columns, units, space, atlas files with SHA-256, settings, version. Borrowed likewise. */
CONUS_CHECKED conus_status conus_report_sidecar(conus_report *report, const char **text, size_t *size);
/** The JSON sidecar of a mask of one of the answers (docs/formats.md). Borrowed likewise. */
CONUS_CHECKED conus_status conus_report_grid_sidecar(conus_report *report, const conus_grid *grid, const char **text,
                                                     size_t *size);
CONUS_API void conus_report_destroy(conus_report *report);

/* ---- Masks ------------------------------------------------------------------------------------------------ */

typedef enum conus_grid_content {
    CONUS_MASK_OF_AREAS = 0, /**< 1 in every area's voxels in the region.                                      */
    CONUS_MASK_OF_REGION,    /**< 1 in all voxels in the region, background too.                                */
    CONUS_MAP_OF_LABELS,     /**< The labels of the areas as which these voxels are reported.                   */
    CONUS_MAP_OF_VALUES      /**< A pathway's values in the region, on the pathway's grid.                      */
} conus_grid_content;

typedef struct conus_grid_options {
    conus_grid_content content;
    uint32_t object; /**< Only this object and those below it in the area tree; 0 = all. A map of values needs a
                          pathway here, unless there is only one; a mask of one is made with it, too. Of the region
                          it only chooses the grid, and must be a pathway.                                      */
} conus_grid_options;

/** The voxels with their centre in a selection's cone, cylinder or ball (Eq. 10), occluded or not, on the grid of the
 * parcellation, or else of the pathway. CONUS_ERROR_ARGUMENT where there is no such grid or object. */
CONUS_CHECKED conus_status conus_selection_grid(conus_grid **out, const conus_selection *selection,
                                                const conus_grid_options *options);

typedef enum conus_number { CONUS_UINT8 = 0, CONUS_UINT16, CONUS_UINT32, CONUS_FLOAT32 } conus_number;

typedef struct conus_grid_view {
    size_t dim[3];
    double world_from_voxel[16];
    int space_code; /**< NIfTI's, as the atlas's.                                                               */
    conus_number number;
    const void *data; /**< [count] numbers, i fastest; 0 outside of the selection.                              */
    uint64_t count;
    const char *description; /**< One line.                                                                     */
} conus_grid_view;

/** What is on the grid. Borrowed. */
CONUS_API conus_grid_view conus_grid_look(const conus_grid *grid);
/** Writes NIfTI-1, .nii or .nii.gz by ending: whole or not at all, the same bytes for the same grid. */
CONUS_CHECKED conus_status conus_grid_write(const conus_grid *grid, const char *path);
CONUS_API void conus_grid_destroy(conus_grid *grid);

/* ---- Batches ---------------------------------------------------------------------------------------------- */

typedef struct conus_batch_options {
    uint32_t threads; /**< That answer poses, up to 1024; 0 = as many as processors that the process may use. With the
                         gl engine there is one, the caller's.                                                    */
    uint32_t block;   /**< Poses per block, up to 65536; 0 = 256. Memory grows with threads times block.         */
    double angle;     /**< Of poses that have none of their own, radians; 0 = 10 degrees, or a cylinder's 0.     */
    conus_report_options report; /**< Its format is neither CONUS_TABLE nor CONUS_JSON. A probe, CONUS_SPIKEGLX or
                                      CONUS_OPEN_EPHYS, is one block of up to 65535 contacts, whatever block says,
                                      and must be all that is in the stream.                                     */
} conus_batch_options;

/** A block of poses, answered. */
typedef struct conus_batch_block {
    const char *text; /**< Their rows, without the heading.                                                      */
    size_t size;
    uint64_t poses;
    uint64_t errors; /**< Poses among them that have no answer but a row of kind "error".                        */
} conus_batch_block;

/** Receives whole blocks in the order of the poses, on the thread that called conus_batch_run(). False ends the run. */
typedef bool (*conus_batch_sink)(void *user, const conus_batch_block *block);

/** Prepares to answer with @p selector, which must outlive the batch and is not to be used during a run. Strings of
 * @p options must outlive the batch, too. */
CONUS_CHECKED conus_status conus_batch_create(conus_batch **out, conus_selector *selector,
                                              const conus_batch_options *options);
CONUS_API void conus_batch_destroy(conus_batch *batch);
/** The threads that will be used. */
CONUS_API uint32_t conus_batch_threads(const conus_batch *batch);
/** Answers the next @p limit poses of @p poses, fewer where it ends, in memory that does not grow with them. The text
 * is the same, byte for byte, for any number of threads and any size of blocks. A pose that cannot be answered gives a
 * row of kind "error". Otherwise a failure ends the run; what comes before it has been delivered then. May be called
 * again, but a live stream ends with a run that the sink or a failure ended. */
CONUS_CHECKED conus_status conus_batch_run(conus_batch *batch, conus_pose_stream *poses, uint64_t limit,
                                           conus_batch_sink sink, void *user);
/** What is odd about the poses that were answered so far, by their lines in their file. */
CONUS_API conus_astray conus_batch_astray(const conus_batch *batch);
/** The line that belongs above the rows, with its end; "" where there is none. Borrowed. */
CONUS_API const char *conus_batch_heading(const conus_batch *batch);
/** The sidecar as of conus_report_sidecar(), without the queries. Borrowed until the next call on the batch. */
CONUS_CHECKED conus_status conus_batch_sidecar(conus_batch *batch, const char **text, size_t *size);

/* ---- Pictures --------------------------------------------------------------------------------------------- */

/** Grey-value presets for the context volume: entry @p index, NULL past the last. */
CONUS_API const char *conus_transfer_preset(size_t index);

typedef struct conus_renderer_options {
    const char *transfer; /**< Preset name or TF file (docs/formats.md) of the context; NULL = the manifest's,
                              or else "brain".                                                           */
    uint64_t max_memory;  /**< Of textures, in bytes; 0 = 8 GiB.                                             */
    conus_log log;
    void *log_user;
} conus_renderer_options;

/** A point of a transfer function, which is piecewise linear between them (Eq. 8). */
typedef struct conus_transfer_point {
    double value;   /**< Grey value of the context.                                */
    double rgba[4]; /**< sRGB, and the opacity of 1 mm; 0 to 1.                    */
} conus_transfer_point;

CONUS_CHECKED conus_status conus_renderer_create(conus_renderer **out, const conus_atlas *atlas,
                                                 const conus_renderer_options *options);
CONUS_API void conus_renderer_destroy(conus_renderer *renderer);
/** "llvmpipe (LLVM 15.0.6, 256 bits)"; what GL calls its renderer. */
CONUS_API const char *conus_renderer_device(const conus_renderer *renderer);

/** The transfer function of the context; @p count 0 where there is none. Borrowed until it is changed. */
CONUS_API const conus_transfer_point *conus_renderer_transfer(const conus_renderer *renderer, size_t *count);
/** Changes it: 1 to 4096 points, values never falling. */
CONUS_CHECKED conus_status conus_renderer_set_transfer(conus_renderer *renderer, const conus_transfer_point *points,
                                                       size_t count);
/** Takes over what has been hidden and shown in the atlas since the renderer was made. */
CONUS_CHECKED conus_status conus_renderer_update(conus_renderer *renderer);

typedef struct conus_view {
    uint32_t width, height;   /**< Pixels, 1 to 16384; 0 = 1400 x 1050.                                           */
    uint32_t slices;          /**< N of Eq. 7; 0 = default.                                                       */
    double field_of_view;     /**< Vertical, radians, in (0, pi); 0 = 30 degrees.                                 */
    double frustum[4];        /**< Instead, of a camera: where its picture's left, right, lower and upper edge are at
                                   depth 1 (tangents, as glFrustum() has them at its near plane), off-axis, too.
                                   All 0 = symmetric, as wide as field_of_view says.                              */
    const conus_pose *camera; /**< NULL = one that shows the whole atlas, from the cone's side where one is drawn. */
    const conus_selection *selection; /**< NULL = none; else draws its cone, axis and contacts.                   */
    uint32_t chosen;  /**< Object that is never pale, with those below it in the area tree; 0 = none.     */
    bool no_skipping; /**< Blend every sample: the same picture, slower (for comparison).                 */
    bool no_legend;   /**< Leave out the text.                                                            */
    bool draft;       /**< Leave edges rough: quicker.                                                    */
    double fade;      /**< How much the context is thinned: 0 = as its transfer function says, 1 = gone.  */
} conus_view;

/** Draws the atlas over a light background: its areas, or its pathways where it has any (all areas would hide them),
 * and then of the areas those that the selection hits, or with CONUS_ALL_LAYERS passes. A draft has those of the
 * picture before.
 * Channels R, G, B, A: float, linear light, premultiplied; A is 1. */
CONUS_CHECKED conus_status conus_render(conus_image **out, conus_renderer *renderer, const conus_view *view);

/** A flat cut through an atlas: the context in grey, areas filled and outlined, surfaces as their contours, filled
 * where they are closed, pathways over them. Labels are looked up, never interpolated. */
typedef struct conus_cut_view {
    double centre[3];       /**< World position of the picture's middle.                                         */
    double right[3], up[3]; /**< Unit vectors, perpendicular; both 0 = +x and +y: axial, neurological.           */
    double mm_per_pixel;    /**< 0 = 1.                                                                          */
    uint32_t width, height; /**< Pixels, 1 to 16384.                                                             */
    double fill;            /**< Opacity of areas, 0 to 1; 0 leaves their outlines.                              */
    bool no_outlines;
    double window[2]; /**< Grey values of black and white; both 0 = conus_atlas_window().                  */
    const conus_selection *selection; /**< NULL = none; else its cone is drawn, areas that it meets are full, those
                                           that it only pierces hatched, and others pale.                        */
    uint32_t chosen; /**< Object that is never pale, with those below it in the area tree; 0 = none.              */
} conus_cut_view;

/** Draws on the CPU. @p rgba gets [height width 4] bytes of sRGB, @p objects (NULL = not wanted) [height width] numbers
 * of what each pixel's centre is in, 0 = nothing; top row first. */
CONUS_CHECKED conus_status conus_cut(uint8_t *rgba, uint32_t *objects, const conus_atlas *atlas,
                                     const conus_cut_view *view);

/** Draws one cut after the other, as windows do: the same pictures as conus_cut(), but voxels and surfaces are looked
 * at again only where a view lies elsewhere. Another selection over the same place costs little. The atlas must not
 * change; after conus_atlas_set_threshold(), conus_atlas_set_hidden() or other colours, make
 * another cutter. */
CONUS_CHECKED conus_status conus_cutter_create(conus_cutter **out, const conus_atlas *atlas);
CONUS_API void conus_cutter_destroy(conus_cutter *cutter);
CONUS_CHECKED conus_status conus_cutter_draw(conus_cutter *cutter, const conus_cut_view *view);
/** What was drawn last: [height width 4] bytes of sRGB, and [height width] numbers of objects, as conus_cut() fills
 * them; NULL before that. Valid up to the next conus_cutter_draw(), and of no picture where that failed. */
CONUS_API const uint8_t *conus_cutter_rgba(const conus_cutter *cutter);
CONUS_API const uint32_t *conus_cutter_objects(const conus_cutter *cutter);

/** What the device saw: channels id (uint32: the atlas's own label), object (uint32), X, Y, Z, t (float, world mm),
 * top row first as in every image, with atlas and pose as attributes. Where it saw nothing, id and object are 0, X, Y,
 * Z are NaN and t is infinity. Channels CryptoObject00.R, .G, .B, .A hold the same as Cryptomatte 1.2.0. A PNG of it is
 * magnified, in the areas' colours, with a legend. */
CONUS_CHECKED conus_status conus_image_of_selection(conus_image **out, const conus_selection *selection);

/** Writes everything in the cone as a deep OpenEXR image: for each piece of a pixel's ray inside an object, by entry,
 * id (uint32: the atlas's own label), object (uint32), Z and ZBack (float: depths along the axis where it begins and
 * ends), t and tBack (distances from the apex), A (1). The attribute idManifest names the objects. The file appears
 * whole or not at all. CONUS_ERROR_ARGUMENT unless @p selection is of CONUS_ALL_LAYERS. */
CONUS_CHECKED conus_status conus_selection_write_deep(const conus_selection *selection, const char *path);

CONUS_API uint32_t conus_image_width(const conus_image *image);
CONUS_API uint32_t conus_image_height(const conus_image *image);
/** Name of channel @p index, NULL past the last. */
CONUS_API const char *conus_image_channel(const conus_image *image, size_t index);
/** Pixels of a float channel, row-major, top row first; NULL if there is none of that name and type. */
CONUS_API const float *conus_image_floats(const conus_image *image, const char *channel);
/** Pixels of a uint32 channel, likewise. */
CONUS_API const uint32_t *conus_image_uints(const conus_image *image, const char *channel);
/** An image of R, G, B, A from [height width 4] bytes of sRGB and opacity, top row first. */
CONUS_CHECKED conus_status conus_image_from_bytes(conus_image **out, const uint8_t *rgba, uint32_t width,
                                                  uint32_t height);
/** Reads OpenEXR (flat scan lines, one part) or PNG (as linear, premultiplied R, G, B, A); the content decides. */
CONUS_CHECKED conus_status conus_image_load(conus_image **out, const char *path);
/** Writes by ending: .exr all channels, .png 8-bit sRGB of R, G, B and A (A not premultiplied). */
CONUS_CHECKED conus_status conus_image_write(const conus_image *image, const char *path);
CONUS_API void conus_image_destroy(conus_image *image);

/** How two images differ. Of a float channel, NaN equals NaN and infinity itself; one of them against anything else
 * differs by infinity. */
typedef struct conus_image_difference {
    uint64_t pixels;       /**< Width times height.                                                              */
    uint64_t differing;    /**< Pixels in which a float channel differs by more than the tolerance, or a uint32
                                channel at all.                                                                  */
    double max_difference; /**< Largest difference in any channel.                                               */
    double rms;            /**< Largest root mean square difference of a channel.                                */
    char channel[32];      /**< The channel of max_difference, "" if there is no difference.                     */
    uint32_t x, y;         /**< Its first pixel, from the top left.                                              */
} conus_image_difference;

/** Compares channel by channel; attributes do not count. CONUS_ERROR_ARGUMENT unless both have the same size and the
 * same channels, in whatever order. @p tolerance is 0 or more. */
CONUS_CHECKED conus_status conus_image_compare(conus_image_difference *out, const conus_image *a, const conus_image *b,
                                               double tolerance);

/* ---- Meshes ----------------------------------------------------------------------------------------------- */

typedef enum conus_mesh_format { CONUS_GIFTI = 0, CONUS_VTP, CONUS_OBJ, CONUS_PLY, CONUS_STL } conus_mesh_format;

/** Hears that @p done of @p total steps are done, on the thread that called into the library. */
typedef void (*conus_progress)(void *user, size_t done, size_t total);

typedef struct conus_mesh_options {
    conus_mesh_format format;
    uint32_t smooth;     /**< Iterations of windowed-sinc smoothing, 1 to 1000; 0 = 5.                          */
    double pass_band;    /**< Of the smoothing, up to 2; less is smoother; 0 = 0.7.                             */
    bool no_smoothing;   /**< Leave the voxels' steps as they are.                                              */
    double decimate;     /**< Part of the triangles that decimation removes, in [0, 1).                         */
    uint64_t max_memory; /**< Of the program that makes the surfaces, in bytes; 0 = 8 GiB.                      */
    conus_progress progress;
    void *progress_user;
    conus_log log; /**< Notes about the surfaces; NULL = silent.                                                */
    void *log_user;
} conus_mesh_options;

/** Writes a closed surface of each area into the folder @p folder (made if missing), LABEL_Name.gii and so on, in world
 * mm. Areas that are meshes already are written as they are. Needs the program conus-mesh, beside this one, in PATH or
 * named by CONUS_MESH (else CONUS_ERROR_UNSUPPORTED); what it makes is kept in the user's cache folder. */
CONUS_CHECKED conus_status conus_atlas_write_meshes(const conus_atlas *atlas, const char *folder,
                                                    const conus_mesh_options *options);

/* ---- Phantoms and files ----------------------------------------------------------------------------------- */

typedef struct conus_phantom_options {
    uint32_t size;     /**< Voxels along the longest edge, 16 to 512; 0 = 64. Size times the smallest spacing
                            is the cube around the origin for which the shapes are made: 64 mm, or scaled.      */
    double spacing[3]; /**< mm; zeros = 1, 1, 1. At least 4 voxels must fit along every edge.                   */
    double oblique;    /**< Turns the grid about (1, 1, 1) by this angle, radians.                              */
    bool flip[3];      /**< Lets i, j, k grow towards left, posterior, inferior.                                */
} conus_phantom_options;

typedef struct conus_phantom_info {
    const char *name, *description;
} conus_phantom_info;

/** The table of phantoms: entry @p index, NULL past the last. */
CONUS_API const conus_phantom_info *conus_phantom(size_t index);
/** Writes phantom @p kind into the folder @p folder (made if missing): KIND.nii.gz, its label table KIND.tsv, and
 * KIND.json with the shapes in world mm, from which every answer follows in closed form (docs/formats.md). */
CONUS_CHECKED conus_status conus_phantom_write(const char *kind, const char *folder,
                                               const conus_phantom_options *options);

typedef struct conus_manifest_options {
    uint64_t max_memory;
    conus_log log; /**< Hears how each file was taken, a line each; NULL = silent. */
    void *log_user;
} conus_manifest_options;

/** Writes a first manifest (docs/formats.md) of what lies in the folder of @p path and the folders in it: volumes, FSL
 * atlases, surfaces, BrainGlobe folders. What a volume is for, is guessed. A file that is there is never replaced. */
CONUS_CHECKED conus_status conus_manifest_write(const char *path, const conus_manifest_options *options);

/** Makes a text that came from outside, a name or a path, harmless for a terminal, in place: a space for each character
 * that would steer it but line feeds and tabs, '?' for each byte that is no UTF-8. Messages and notes are plain
 * already. */
CONUS_API void conus_plain_text(char *text);

/** Writes a file that appears whole or not at all. */
CONUS_CHECKED conus_status conus_write_file(const char *path, const void *data, size_t size);

#ifdef __cplusplus
}
#endif

#endif
