/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file selection.h
 * Aim a cone, a cylinder or a ball at an atlas, and read off what lies in it.
 */
#ifndef CONUS_PUBLIC_SELECTION_H
#define CONUS_PUBLIC_SELECTION_H

#include <conus/atlas_info.h>
#include <conus/pose.h>
#include <conus/space.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

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
    const char *score; /**< Ranking, a name from conus_score() or a formula of them; NULL = "share". */
    conus_log log;     /**< NULL = silent. */
    void *log_user;    /**< Passed to @p log. */
    double slice_fraction;    /**< F of Eq. 7, more than 0 to 1: which part of the slices the ID pass takes. 0 = the
                                 paper's fifth. */
    const conus_frame *frame; /**< Of positions in tables; NULL = world mm, #CONUS_SPACE_RAS. Copied. */
} conus_selector_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_SELECTOR_OPTIONS_INIT CONUS_INIT_(conus_selector_options)

/**
 * Builds the engine for an atlas.
 * @param[out] out The selector; end it with conus_selector_destroy().
 * @param atlas Must outlive the selector. Nothing may be added to it meanwhile.
 * @param options NULL = defaults. Its strings are copied.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for an option out of its range; #CONUS_ERROR_GL where the gl engine finds no
 * driver.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_selector_create(conus_selector **out, const conus_atlas *atlas,
                                                 const conus_selector_options *options);

/**
 * Makes another selector for the same atlas, so that a second thread may answer at the same time. It has the same
 * options and the same tables of the atlas, which are in memory once.
 * @param[out] out The selector; end it with conus_selector_destroy().
 * @param selector Must outlive @p out. With the gl engine one thread has the device at a time.
 * @return #CONUS_OK.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_selector_share(conus_selector **out, const conus_selector *selector);

/**
 * Gives what is asked next a range of its own: conus_select() and whatever else goes by the selector's range.
 * @param selector The selector. Its range stays as it was after a failure.
 * @param range As conus_selector_options.range; NaN = that of the options. NULL = both of the options.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for ends that are no range, and for one with the paper's slices.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_selector_set_range(conus_selector *selector, const double range[2]);

/**
 * Ends a selector. Objects made for it must be destroyed before.
 * @param selector NULL is allowed.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_API void conus_selector_destroy(conus_selector *selector);

/**
 * Names the engine in use.
 * @param selector The selector.
 * @return "rays, avx512", "gl, llvmpipe (LLVM 15.0.6, 256 bits)". Borrowed from the selector.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_API const char *conus_selector_engine(const conus_selector *selector);

/**
 * Gives the n of the n x n buffer.
 * @param selector The selector.
 * @return That of its options, or the default.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_API uint32_t conus_selector_resolution(const conus_selector *selector);

/**
 * Aims a cone, or a cylinder if the selector has a radius.
 * @param[out] out The selection; end it with conus_selection_destroy().
 * @param selector The selector.
 * @param pose Apex and axis.
 * @param angle Full opening, radians, in (0, pi); 0 for a cylinder.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another angle or a pose that is not rigid; #CONUS_ERROR_GL where the
 * driver fails.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_select(conus_selection **out, conus_selector *selector, const conus_pose *pose,
                                        double angle);

/** A ball for conus_select_ball(), mm, that stands for its centre, with nothing for what is only near. Contacts of
 * probes are asked so where no radius is given. */
#define CONUS_POINT_RADIUS 1e-6

/**
 * Finds what is at a point and near it, instead of in a cone. An object with a voxel's cell or a part of its surface in
 * the ball has a result. Volume, fraction and the like are those of voxels with their centre in the ball. Share is
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
 * #CONUS_ERROR_DATA with the radius 0 for an atlas without objects.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_select_ball(conus_selection **out, conus_selector *selector, const double centre[3],
                                             double radius);

/**
 * Gives the radius of a selection by conus_select_ball(), mm.
 * @param selection The selection.
 * @return 0 of a point without a radius, and of a cone or cylinder.
 * @threads Any.
 * @since 0.1
 */
CONUS_API double conus_selection_ball(const conus_selection *selection);

/**
 * Ends a selection.
 * @param selection NULL is allowed.
 * @threads One at a time for each @p selection.
 * @since 0.1
 */
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
    double offset;     /**< Smallest angle of its rays to the axis, radians. */
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
} conus_result;

/**
 * Counts the results. They are ordered by rank, with unassigned last (there even if nothing is unassigned). With
 * #CONUS_LAYERS_ALL an object that is occluded, or too thin for any ray but with a voxel's centre in the cone, has a
 * result of 0 pixels.
 * @param selection NULL counts 0.
 * @return How many results there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_selection_count(const conus_selection *selection);

/**
 * Gives result @p index.
 * @param selection The selection.
 * @param index From 0.
 * @return NULL past the last. Borrowed from the selection.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_result *conus_selection_result(const conus_selection *selection, size_t index);

/**
 * Tells the place of an object among the colours that pictures give to an answer: what is hit first comes first, in the
 * order of the results, then pathways and bundles, which somebody asked for, then areas that are only behind others.
 * @param selection NULL has none.
 * @param object Its number, from 1. Objects that a level joins have the same place.
 * @return From 1; 0 = the cone does not reach it.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_selection_rank(const conus_selection *selection, uint32_t object);

/**
 * Tells how much pictures show of the colour of an object, so that what has little of a cone is not as loud as what has
 * most of it: all with half of the cone or more, less with less, in eight steps, 0.4 with a fiftieth; the rest is the
 * grey of what is not hit.
 * @param selection NULL has none.
 * @param object Its number, from 1.
 * @return 0.4 to 1; 1 of what is not hit first, or of a ball.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API double conus_selection_weight(const conus_selection *selection, uint32_t object);

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

/**
 * Gives the evidence.
 * @param selection The selection.
 * @return Its arrays are borrowed from the selection; resolution is 0 where there are no pixels.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API conus_evidence conus_selection_evidence(const conus_selection *selection);

/**
 * Computes where the ray of a pixel hits.
 * @param[out] out World mm; NaN where it hit nothing, or there is no such pixel.
 * @param selection The selection.
 * @param pixel Row-major index.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API void conus_selection_position(double out[3], const conus_selection *selection, size_t pixel);

/** An interval of a pixel's ray inside one object. */
typedef struct conus_interval {
    uint32_t pixel;  /**< Index into the evidence's arrays. */
    uint32_t object; /**< Number in the atlas, as it is reported (level): intervals of one group that touch are one. */
    double entry;    /**< mm from the apex. */
    double exit; /**< mm from the apex; equal to entry where the ray only touches it, or the surface is not closed. */
    uint64_t voxel; /**< The voxel, triangle or point of the entry, as in the evidence. */
} conus_interval;

/**
 * Gives all intervals of all rays, with #CONUS_LAYERS_ALL: by pixel, then entry, then object.
 * @param[out] count How many; 0 without #CONUS_LAYERS_ALL.
 * @param selection The selection.
 * @return [count]; NULL without #CONUS_LAYERS_ALL. Borrowed from the selection.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const conus_interval *conus_selection_intervals(size_t *count, const conus_selection *selection);

#ifdef __cplusplus
}
#endif

#endif
