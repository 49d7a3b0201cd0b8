/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file selection.h
 * Which objects are in a cone, a cylinder or a ball, with shares and places: of one pose, of a pose with a history,
 * and of millions.
 */
#ifndef CONUS_PUBLIC_SELECTION_H
#define CONUS_PUBLIC_SELECTION_H

#include <conus/pose.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @name Selections
 * @{ */

typedef struct conus_selector conus_selector;   /**< An engine made ready for one atlas. */
typedef struct conus_selection conus_selection; /**< The answer to one query. Immutable. */

/** The engine that traces the rays of a cone's pixels, or of a picture's. */
typedef enum conus_engine {
    CONUS_ENGINE_AUTO = 0, /**< The library chooses: rays, and for pictures gl where there is a driver. */
    CONUS_ENGINE_RAYS,     /**< Rays on the CPU. Needs no driver and gives the pixels that gl gives. */
    CONUS_ENGINE_GL        /**< An OpenGL 4.5 driver. */
} conus_engine;

/** Which pixels count as the cone (Eq. 3). */
typedef enum conus_aperture {
    CONUS_APERTURE_CIRCLE = 0, /**< Those in the circle: a round cone. */
    CONUS_APERTURE_SQUARE      /**< All: a pyramid. */
} conus_aperture;

/** How a ray is followed through voxels. */
typedef enum conus_sampling {
    CONUS_SAMPLING_EXACT = 0, /**< Cell by cell (Eq. 5). */
    CONUS_SAMPLING_SLICES     /**< At the paper's slices (Eq. 7). */
} conus_sampling;

/** Which hits of a ray count. */
typedef enum conus_layers {
    CONUS_LAYERS_VISIBLE = 0, /**< The first hit of each pixel. */
    CONUS_LAYERS_ALL          /**< Also all intervals behind it (Eq. 10). */
} conus_layers;

/** Rays along a side of the buffer where no resolution is asked for. */
#define CONUS_RESOLUTION_DEFAULT 64

/** How much the rays of a cone or cylinder count (Eq. 30). Immutable. */
typedef struct conus_weight conus_weight;

/** Reads a weight.
 * @param[out] out The weight; end it with conus_weight_destroy().
 * @param text A form or the path of a table (Eq. 30); docs/commands.md, --weight, has all of them. "hard": all counts
 * alike. "gauss=2": as the axis's tilt has a standard deviation of 2 degrees about each of two axes, or
 * "gauss=vr-controller:4", by a published error of tilt alone (Eq. 29). "coil=d:w", "focus=f:l:a" and
 * "fibre=r:NA[:S:K:n]" depend on the depth. A table has columns weight and angle_deg (off the axis), offset_mm (from
 * it) or distance_mm (from a ball's centre), and perhaps depth_mm. Behind gauss and a table by angle ",bias=X:Y": the
 * device points X degrees to its right and Y degrees up of what is meant. Behind any ",above=": from which weight on a
 * place counts as above (Eq. 33).
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an unknown form and numbers out of their ranges; #CONUS_ERROR_IO;
 * #CONUS_ERROR_DATA for another table. */
CONUS_CHECKED conus_status conus_weight_create(conus_weight **out, const char *text);

/** Ends a weight.
 * @param weight NULL is allowed. */
CONUS_API void conus_weight_destroy(conus_weight *weight);

/** Gives the full opening of the cone that the weight fills, outside of which it is next to nothing.
 * @param weight The weight.
 * @return Degrees; NaN of one that fills no cone of its own. */
CONUS_API double conus_weight_angle(const conus_weight *weight);

/** Gives the radius of the cylinder or ball that the weight fills.
 * @param weight The weight.
 * @return mm; NaN of one that fills neither. */
CONUS_API double conus_weight_radius(const conus_weight *weight);

/** Gives the depths that the weight fills.
 * @param[out] out Nearest and farthest, mm; both 0 where it has none.
 * @param weight The weight.
 * @return Whether it has some. */
CONUS_API bool conus_weight_range(double out[2], const conus_weight *weight);

/** Says whether the weight depends on the depth, so that it is none of rays.
 * @param weight The weight.
 * @return Then a selector has all layers, whatever its options say. */
CONUS_API bool conus_weight_needs_layers(const conus_weight *weight);

/** How a selector answers. */
typedef struct conus_selector_options {
    size_t struct_size;      /**< Its size, as #CONUS_SELECTOR_OPTIONS_INIT sets it; 0 = that of this version. */
    conus_engine engine;     /**< The engine that traces the rays. */
    conus_aperture aperture; /**< Which pixels count as the cone (Eq. 3). */
    conus_sampling sampling; /**< Exact cells (Eq. 5) or the paper's slices (Eq. 7). */
    uint32_t resolution;     /**< n of the n x n buffer, 1 to 1024; 0 = #CONUS_RESOLUTION_DEFAULT. */
    uint32_t slices;         /**< N of Eq. 7; the ID pass takes slice_fraction of them. 0 = default. */
    conus_layers layers;     /**< Whether only the first hits of the pixels' rays count, or all (Eq. 10). */
    double range[2];   /**< Nearest and farthest depth along the axis, mm from the apex: what lies outside is as if it
                          were not there. Both 0 = everything. */
    double radius;     /**< mm: instead of a cone a cylinder about the axis, whose angle is 0. 0 = a cone. */
    const char *level; /**< Areas are rolled up the area tree: to a depth ("2"; roots are at 1), or to the nearest of
                          listed areas ("Thalamus,Isocortex"; docs/commands.md has more). NULL = none are. */
    const char *score; /**< Ranking, a name (docs/commands.md, --score) or a formula of names; NULL = "share". */
    conus_log log;     /**< NULL = silent. */
    void *log_user;    /**< Passed to @p log. */
    double slice_fraction;      /**< F of Eq. 7, more than 0 to 1: which part of the slices the ID pass takes. 0 = the
                                   paper's fifth. */
    const conus_frame *frame;   /**< Of positions in tables; NULL = world mm, #CONUS_SPACE_RAS. Copied. */
    const conus_weight *weight; /**< Of the rays, and how the device points; must outlive the selector. NULL = none. */
    const char *prior; /**< What is meant, for the posterior (Eq. 32): "equal", each object as often; "size", each
                          direction; or the path of a table with columns prior and name or index, how many times as
                          often as an object that it does not name; then perhaps ",power=G". Needs a weight. NULL =
                          "equal", if the score has the posterior. */
} conus_selector_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_SELECTOR_OPTIONS_INIT CONUS_INIT_(conus_selector_options)

/** Builds the engine for an atlas.
 * @param[out] out The selector; end it with conus_selector_destroy().
 * @param atlas Must outlive the selector. Nothing may be added to it meanwhile.
 * @param options NULL = defaults. Its strings are copied.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range; #CONUS_ERROR_GL where the gl engine finds no
 * driver. */
CONUS_CHECKED conus_status conus_selector_create(conus_selector **out, const conus_atlas *atlas,
                                                 const conus_selector_options *options);

/** Makes another selector for the same atlas, so that a second thread may answer at the same time. It has the same
 * options and the same tables of the atlas, which are in memory once.
 * @param[out] out The selector; end it with conus_selector_destroy().
 * @param selector Must outlive @p out. With the gl engine one thread has the device at a time.
 * @return #CONUS_OK. */
CONUS_CHECKED conus_status conus_selector_share(conus_selector **out, const conus_selector *selector);

/** Gives what is asked next a range of its own: conus_select() and whatever else goes by the selector's range.
 * @param selector The selector. Its range stays as it was after a failure.
 * @param range As conus_selector_options.range; NaN = that of the options. NULL = both of the options.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for ends that are no range, and for one with the paper's slices. */
CONUS_CHECKED conus_status conus_selector_set_range(conus_selector *selector, const double range[2]);

/** Ends a selector. Objects made for it must be destroyed before.
 * @param selector NULL is allowed. */
CONUS_API void conus_selector_destroy(conus_selector *selector);

/** Names the engine in use.
 * @param selector The selector.
 * @return "rays, avx512", "gl, llvmpipe (LLVM 15.0.6, 256 bits)". Borrowed from the selector. */
CONUS_API const char *conus_selector_engine(const conus_selector *selector);

/** Aims a cone, or a cylinder if the selector has a radius.
 * @param[out] out The selection; end it with conus_selection_destroy().
 * @param selector The selector.
 * @param pose Apex and axis.
 * @param angle Full opening, degrees, in (0, 180); 0 for a cylinder.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another angle or a pose that is not rigid; #CONUS_ERROR_GL where the
 * driver fails. */
CONUS_CHECKED conus_status conus_select(conus_selection **out, conus_selector *selector, const conus_pose *pose,
                                        double angle);

/** A ball for conus_select_ball(), mm, that stands for its centre, with nothing for what is only near. Contacts of
 * probes are asked so where no radius is given. */
#define CONUS_POINT_RADIUS 1e-6

/** Finds what is at a point and near it, instead of in a cone. An object with a voxel's cell or a part of its surface
 * in the ball has a result. Volume, fraction and the like are those of voxels with their centre in the ball. Share is
 * their part of all such voxels of the object's grid, NaN for a mesh, and the score. Distance is that of the nearest
 * point of a cell or surface, 0 within the object, and contact is that point. There are no pixels, and no picture.
 *
 * With the radius 0 the results are the objects that contain the point, of which a point on a border has several. Where
 * no object does, they are the nearest one, however far it is, with all that are equally near. They are ranked by
 * distance, then by number; share, volume and the like are NaN, and there is no #CONUS_KIND_UNASSIGNED.
 * @param[out] out The selection; end it with conus_selection_destroy().
 * @param selector The selector.
 * @param centre World mm.
 * @param radius mm; 0 = only the point.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a number out of its range, and with a selector that has a range;
 * #CONUS_ERROR_DATA with the radius 0 for an atlas without objects. */
CONUS_CHECKED conus_status conus_select_ball(conus_selection **out, conus_selector *selector, const double centre[3],
                                             double radius);

/** Gives the radius of a selection by conus_select_ball(), mm.
 * @param selection The selection.
 * @return 0 of a point without a radius, and of a cone or cylinder. */
CONUS_API double conus_selection_ball(const conus_selection *selection);

/** Ends a selection.
 * @param selection NULL is allowed. */
CONUS_API void conus_selection_destroy(conus_selection *selection);

/** One object in the cone. */
typedef struct conus_result {
    conus_kind kind;   /**< Its kind. */
    uint32_t object;   /**< Number in the atlas, as what it is reported (level); 0 for #CONUS_KIND_UNASSIGNED. */
    uint32_t rank;     /**< From 1; 0 for #CONUS_KIND_UNASSIGNED. */
    double score;      /**< By the selector's score; higher is better. */
    uint32_t pixels;   /**< Pixels of the cone that hit it first. */
    double share;      /**< Its part of the cone's solid angle (Eq. 4); all shares sum to 1. */
    double centre_px;  /**< Smallest distance of its pixels to the buffer's centre, in pixels. */
    double offset;     /**< Smallest angle of its rays to the axis, degrees. */
    double distance;   /**< Nearest first hit of any of its pixels, mm from the apex. */
    double contact[3]; /**< World position of its contact (Eq. 11), mm; NaN if no pixel hits it first. */

    /* With CONUS_LAYERS_ALL (Eq. 10); else 0, and NaN where 0 would say something. */
    uint32_t pierced;     /**< Pixels of the cone whose ray passes it, occluded or not. */
    double entry;         /**< Nearest entry of any of these rays, mm from the apex. */
    double exit;          /**< Farthest exit of any of these rays, mm from the apex. */
    double path;          /**< Mean length of these rays inside it, mm. */
    uint64_t voxels;      /**< Its voxels whose centre is in the cone. */
    double volume;        /**< Their volume, mm^3, or that of a closed surface's inside in the cone; of another surface
                               an estimate from the rays. */
    double fraction;      /**< That volume as a part of the object's whole volume. */
    double cone_fraction; /**< That volume as a part of the volume of all areas in the cone. */
    double sum_value;     /**< For a pathway: sum of the values of these voxels. */
    double mean_value;    /**< For a pathway: mean of these values. */
    double max_value;     /**< For a pathway: largest of these values. */
    double centroid[3];   /**< World position, mm: mean of these voxels' centres, weighted by a pathway's values. */

    double contact_value; /**< With or without layers: the value of the voxel at its contact, of a pathway in the scaled
                             values of its volume, of an area of probabilities from 0 to 1; else NaN. */

    /* For a bundle (Eq. 19), with CONUS_LAYERS_ALL or in a ball; else 0 and NaN. */
    uint64_t streamlines;       /**< Its streamlines that come into the cone. */
    uint64_t streamlines_total; /**< All of its streamlines, with or without layers. */
    double length;              /**< Length of their parts in the cone, mm. */
    double near[3];             /**< World position, mm: the point of these parts that is nearest to the apex. */
    double along; /**< How far along its streamline that is, 0 to 1 of its length; streamlines are turned so as to run
                     like the bundle's longest one. */

    /* With a weight, of a cone or cylinder; else NaN. */
    double weight;       /**< Its part of the weights of all rays (Eq. 31); all parts sum to 1. */
    double weight_error; /**< Standard error of that, of the pixels at its outline. */
    double posterior;    /**< Of what pixels of a cone hit first: the probability that it is meant (Eq. 32). */

    /* With a weight, and CONUS_LAYERS_ALL or in a ball (Eq. 33); else NaN. */
    double dose;        /**< Integral of the weight over its part in the cone, mm^3, or of a bundle along its
                             streamlines, mm, times the weight's unit. */
    double dose_share;  /**< As a part of that of the whole cone; NaN of a bundle, and where that has no end. */
    double mean_weight; /**< Dose by volume or length. */
    double max_weight;  /**< Largest weight in it; */
    double max_at[3];   /**< where, world mm. */
    double above;       /**< mm^3 of it, or of a bundle streamlines, with a weight of the level or more. */
    double above_share; /**< As a part of that of the whole cone. */
    double value_dose;  /**< For a pathway: the integral of value times weight. */
} conus_result;

/** Counts the results. They are ordered by rank, with unassigned last (there even if nothing is unassigned). With
 * #CONUS_LAYERS_ALL an object that is occluded, or too thin for any ray but with a voxel's centre in the cone, has a
 * result of 0 pixels.
 * @param selection NULL counts 0.
 * @return How many results there are. */
CONUS_API size_t conus_selection_count(const conus_selection *selection);

/** Gives result @p index.
 * @param selection The selection.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the selection. */
CONUS_API const conus_result *conus_selection_result(const conus_selection *selection, size_t index);

/** The evidence behind the results: for each of n x n pixels, row j = 0 at the device's bottom (Eq. 3). */
typedef struct conus_evidence {
    uint32_t resolution;    /**< n. */
    const uint32_t *object; /**< [n*n] Object hit first, as it is reported (level), 0 if none; of pixels outside the
                               aperture too. */
    const double *distance; /**< [n*n] mm from the apex along the ray, infinity if nothing. */
    const uint64_t *voxel;  /**< [n*n] Linear index i + dim0 (j + dim1 k) in the volume of the hit, or the triangle of
                               its mesh, or of streamlines the first point, among all of the file, of the segment;
                               UINT64_MAX if nothing. */
    const bool *in_cone;    /**< [n*n] The aperture. */
} conus_evidence;

/** Gives the evidence.
 * @param selection The selection.
 * @return Its arrays are borrowed from the selection; resolution is 0 where there are no pixels. */
CONUS_API conus_evidence conus_selection_evidence(const conus_selection *selection);

/** Computes where the ray of a pixel hits.
 * @param[out] out World mm; NaN where it hit nothing, or there is no such pixel.
 * @param selection The selection.
 * @param pixel Row-major index. */
CONUS_API void conus_selection_position(double out[3], const conus_selection *selection, size_t pixel);

/** An interval of a pixel's ray inside one object. */
typedef struct conus_interval {
    uint32_t pixel;  /**< Index into the evidence's arrays. */
    uint32_t object; /**< Number in the atlas, as it is reported (level): intervals of one group that touch are one. */
    double entry;    /**< mm from the apex. */
    double exit; /**< mm from the apex; equal to entry where the ray only touches it, or the surface is not closed. */
    uint64_t voxel; /**< The voxel, triangle or point of the entry, as in the evidence. */
} conus_interval;

/** Gives all intervals of all rays, with #CONUS_LAYERS_ALL: by pixel, then entry, then object.
 * @param[out] count How many; 0 without #CONUS_LAYERS_ALL.
 * @param selection The selection.
 * @return [count]; NULL without #CONUS_LAYERS_ALL. Borrowed from the selection. */
CONUS_API const conus_interval *conus_selection_intervals(size_t *count, const conus_selection *selection);
/** @} */

/** @name Tracks
 * Follows a device: ranks what its selector finds together with earlier steps (Eq. 12).
 * @{ */

typedef struct conus_tracker conus_tracker; /**< A selector that remembers. */

/** Constants of the scores that need a history (Eq. 12). */
typedef struct conus_tracker_options {
    size_t struct_size; /**< Its size, as #CONUS_TRACKER_OPTIONS_INIT sets it; 0 = that of this version. */
    double window;      /**< T of time and stability, s; after longer without a step all starts afresh. 0 = 2. */
    double stickiness;  /**< IntenSelect's c_s, in (0, 1), what is kept of a score in one frame. 0 = 0.5. */
    double snappiness;  /**< IntenSelect's c_g, up to 1, what is added of the new one. 0 = 0.5. */
    double rate;        /**< Hz: a frame of c_s and c_g is 1/rate. 0 = 60. */
    double growth;      /**< IntenSelect+'s, 1/s. 0 = 7.5. */
    double decay;       /**< IntenSelect+'s where an object contributes less than it did, 1/s. 0 = 5. */
    double exponent;    /**< k of both, in (0, 1]. 0 = 4/5. */
    double delay;       /**< s before the trigger of what it confirms, up to the window. 0 = 0.15; below 0 = none. */
} conus_tracker_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_TRACKER_OPTIONS_INIT CONUS_INIT_(conus_tracker_options)

/** Starts a track.
 * @param[out] out The tracker; end it with conus_tracker_destroy().
 * @param selector Must outlive the tracker.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range. */
CONUS_CHECKED conus_status conus_tracker_create(conus_tracker **out, conus_selector *selector,
                                                const conus_tracker_options *options);

/** Ends a tracker.
 * @param tracker NULL is allowed. */
CONUS_API void conus_tracker_destroy(conus_tracker *tracker);

/** Answers for the device at a time: conus_select() with a history. An object that left the cone stays in the ranking,
 * with 0 pixels, for as long as it has a score or could be confirmed. Of two steps at one time the later one counts
 * from there on. After a failure the tracker is as it was, so that a lost frame has no effect.
 * @param[out] out The selection; end it with conus_selection_destroy().
 * @param tracker The tracker.
 * @param time_s Seconds of any clock.
 * @param pose Apex and axis.
 * @param angle As for conus_select().
 * @param trigger The trigger is held down. The step at which it goes down confirms what was selected `delay` ago,
 * before the press moved the hand.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a time before the last step; the errors of conus_select(). */
CONUS_CHECKED conus_status conus_tracker_step(conus_selection **out, conus_tracker *tracker, double time_s,
                                              const conus_pose *pose, double angle, bool trigger);

/** Gives what was selected some time before the last step.
 * @param tracker The tracker.
 * @param ago Seconds, 0 to the window.
 * @return Number of the object; 0 if none was. */
CONUS_API uint32_t conus_tracker_selected(const conus_tracker *tracker, double ago);

/** Where a selection stands in its track. */
typedef struct conus_step {
    double time_s;      /**< Time of the step, s. */
    uint32_t selected;  /**< The first by rank of what is in the cone or has a score from before; 0 = none. */
    uint32_t confirmed; /**< Object that the trigger confirms at this step; 0 = none, no press. */
} conus_step;

/** Gives the step of a selection.
 * @param selection The selection.
 * @return NULL if the selection is not from a tracker. Borrowed from the selection. */
CONUS_API const conus_step *conus_selection_step(const conus_selection *selection);
/** @} */

/** @name Poses that look odd
 * Counts poses that look as if they came from another space or unit.
 * @{ */

typedef struct conus_pose_check conus_pose_check; /**< Where poses are, and whether they point at the atlas. */

/** Poses of one kind. */
typedef struct conus_pose_finding {
    uint64_t count;  /**< How many. */
    uint64_t first;  /**< The lowest number among them; the other members are of that one. */
    uint32_t object; /**< The object that it is inside of, else 0. */
    conus_pose pose; /**< Where it is and points. */
    double angle;    /**< Its full opening, degrees. */
} conus_pose_finding;

/** Findings about poses that seem to come from another space or unit. */
typedef struct conus_pose_findings {
    uint64_t poses;            /**< Poses counted. */
    conus_pose_finding inside; /**< A cone's apex is in a voxel of an area or pathway, or, with exact sampling, inside a
                            closed surface; of several such surfaces the object is the smallest. */
    conus_pose_finding away;   /**< The cone or cylinder misses the box around all objects. */
    conus_pose_finding tiny;   /**< Within 1 mm of 0 in every coordinate, and not at 0. */
    uint64_t points;           /**< Points counted. */
    conus_pose_finding far;    /**< A point is farther from that box than a quarter of its longest edge; the pose is not
                                     turned. */
    conus_pose_finding apart; /**< The ball around a point misses the box around all objects; the pose is not turned. */
} conus_pose_findings;

/** In what other way the first of some odd poses may have been meant. */
typedef struct conus_pose_suggestion {
    uint32_t object; /**< The object hit first in that case, from outside of it; 0 = there is no such way. */
    bool of_tiny; /**< It is about conus_pose_findings.tiny, and the other findings about that pose mean nothing. Else
                     it is about conus_pose_findings.away. */
    bool is_reversed;  /**< The device looks the other way; its place is as it was. */
    const char *words; /**< "with x and y negated (LPS for RAS)", text of the library; NULL if object is 0. */
    conus_pose pose;   /**< The pose, so read. */
} conus_pose_suggestion;

/** Starts to count for the atlas, aperture and radius of a selector.
 * @param[out] out The counts; end them with conus_pose_check_destroy().
 * @param selector Must outlive the counts.
 * @return #CONUS_OK; only #CONUS_ERROR_MEMORY is expected. */
CONUS_CHECKED conus_status conus_pose_check_create(conus_pose_check **out, const conus_selector *selector);

/** Ends the counts.
 * @param check NULL is allowed. */
CONUS_API void conus_pose_check_destroy(conus_pose_check *check);

/** Counts a pose. One that conus_select() refuses is not counted. It compares the apex with boxes, and sends one ray
 * where the apex lies in the box around a closed surface.
 * @param check The counts.
 * @param number The caller's number of the pose.
 * @param pose Apex and axis.
 * @param angle Full opening, degrees. */
CONUS_API void conus_pose_check_add(conus_pose_check *check, uint64_t number, const conus_pose *pose, double angle);

/** Gives the counts.
 * @param check The counts.
 * @return Borrowed; it changes with conus_pose_check_add(). */
CONUS_API const conus_pose_findings *conus_pose_check_found(const conus_pose_check *check);

/** Finds in what other way odd poses may have been meant. It tries the units metres and micrometres, the space LPS and
 * the other end of the device on the first tiny pose, or else the first that points away, and selects with each.
 * @param[out] out The first way by which that pose hits something; object 0 if there is none.
 * @param found Counts of poses.
 * @param selector That for which they were counted.
 * @return #CONUS_OK, also without such a way; only #CONUS_ERROR_MEMORY and errors of the engine are expected. */
CONUS_CHECKED conus_status conus_pose_check_suggest(conus_pose_suggestion *out, const conus_pose_findings *found,
                                                    conus_selector *selector);
/** @} */

/** @name Poses in memory
 * @{ */

/** Poses in memory: either matrices, or origins with directions, or without: points. */
typedef struct conus_pose_array {
    size_t struct_size;      /**< Its size, as #CONUS_POSE_ARRAY_INIT sets it; 0 = that of this version. */
    size_t count;            /**< How many. */
    const double *matrix;    /**< [count 16] As for conus_pose_from_matrix(); NULL = the next three. */
    const double *origin;    /**< [count 3] World mm. */
    const double *direction; /**< [count 3] Any length but 0; NULL = points, for conus_select_many() only. */
    const double *up;        /**< [count 3] As for conus_pose_along(); NULL = the default of Eq. 2. */
    const double *angle;     /**< [count] Full opening, degrees; where it is 0, and where this is NULL, the options'. */
    const double *range;     /**< [count 2] As for conus_selector_set_range(), mm; NULL = the selector's options'. */
    const conus_frame *frame; /**< Devices without matrices are turned as its space has it, as by
                                 conus_frame_turn_pose(); left-handed matrices are read where that makes them. NULL =
                                 #CONUS_SPACE_RAS. */
} conus_pose_array;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_POSE_ARRAY_INIT CONUS_INIT_(conus_pose_array)

/** How conus_select_many() answers. */
typedef struct conus_many_options {
    size_t struct_size; /**< Its size, as #CONUS_MANY_OPTIONS_INIT sets it; 0 = that of this version. */
    uint32_t threads;   /**< Threads that answer poses, up to 1024; 0 = as many as processors that the process may use.
                           With the gl engine one of them has the device at a time. */
    uint32_t block;     /**< Poses per block, up to 65536; 0 = 256. Memory grows with threads times block. */
    double angle;       /**< For poses that have none of their own, degrees; 0 = the weight's own, else 10
                           degrees, or a cylinder's 0. */
    double radius;      /**< Of points, mm, as for conus_select_ball(). */
} conus_many_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_MANY_OPTIONS_INIT CONUS_INIT_(conus_many_options)

/** Answers to poses that follow each other. */
typedef struct conus_answers {
    size_t first;                /**< Index of the first pose. */
    size_t poses;                /**< How many. */
    const size_t *starts;        /**< [poses + 1] The results of pose first + i are starts[i] to starts[i + 1] - 1. */
    const conus_result *results; /**< [starts[poses]] In the order of conus_selection_result(). */
    const conus_status *status;  /**< [poses] #CONUS_ERROR_ARGUMENT for a pose without an answer: a number that is not
                                    finite, say. conus_select() with that pose says why. */
} conus_answers;

/** Receives answers in the order of the poses, on the thread that called conus_select_many().
 * @param user The pointer that conus_select_many() got.
 * @param answers Valid until the callback returns.
 * @return False ends the run with #CONUS_ERROR_CANCELLED. */
typedef bool (*conus_answer_sink)(void *user, const conus_answers *answers);

/** Answers poses that are in memory, with threads. The answers are the same, bit for bit, for any number of threads and
 * any size of blocks, and those of conus_select(). A pose that cannot be answered has a status and no results. After a
 * failure, @p sink has received what comes before it.
 * @param[out] findings Findings about the poses, with their indices as numbers, once all are answered; NULL = not
 * wanted.
 * @param selector Its score needs no history.
 * @param poses The arrays are only read, and not copied.
 * @param options NULL = defaults.
 * @param sink Receives the answers.
 * @param user Passed to @p sink.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range, and for arrays that are missing;
 * #CONUS_ERROR_CANCELLED where @p sink ends the run; the errors of conus_select() but those of a pose. */
CONUS_CHECKED conus_status conus_select_many(conus_pose_findings *findings, conus_selector *selector,
                                             const conus_pose_array *poses, const conus_many_options *options,
                                             conus_answer_sink sink, void *user);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
