/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file candidates.h
 * Poses from entries and targets, for a plan to try (Eq. 22).
 */
#ifndef CONUS_PUBLIC_CANDIDATES_H
#define CONUS_PUBLIC_CANDIDATES_H

#include <conus/mesh.h>
#include <conus/overlap.h>
#include <conus/pose_file.h>
#include <conus/selection.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_sites conus_sites; /**< Points where needles may enter, or to which they may point. */

/** @name Sites
 * @{ */

/**
 * Makes sites of points.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param points [count][3] World mm. Copied.
 * @param count May be 0.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a point that is not finite.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_create(conus_sites **out, const double *points, size_t count);

/**
 * Makes sites of the vertices of a surface, in the order of the file, with normals: the mean of the triangles around a
 * vertex, weighted by their areas, those at its other numbers too. Of a closed surface they point outwards, by its
 * signed volume; else as its triangles are wound, with a note. Vertices without a triangle, and those whose normals
 * cancel out, are left out.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param path A surface in any format that conus_atlas_load() reads.
 * @param flip Normals point to the other side.
 * @return #CONUS_OK; the errors of conus_atlas_load() about surfaces.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_load(conus_sites **out, const char *path, bool flip);

/**
 * Makes sites of the centres of the voxels of a region that have one of another kind, or the edge of the grid, at one
 * of their six faces; in the order of the file.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param roi The region.
 * @return #CONUS_OK; #CONUS_ERROR_MEMORY.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_of_roi(conus_sites **out, const conus_roi *roi);

/** Which points of a structure are sites. */
typedef enum conus_sites_kind {
    CONUS_SITES_CENTROID = 0, /**< The mean position of its voxels and the insides of its closed surfaces, weighted by
                                 volume. A note says where it is not in the structure. */
    CONUS_SITES_DEEPEST,      /**< The centre of the voxel that is farthest from all voxels around the structure, by
                                 their centres, also those beyond the grid; of a closed surface the point inside, on a
                                 grid of 1 mm (or less, where none is inside), that is farthest from it. Of points that
                                 are equal to 1e-9 mm the nearest to the centroid, then the first. A structure that
                                 lies on both sides and says none is refused, as by conus_place_find(). */
    CONUS_SITES_VOXELS        /**< The centres of its voxels, in the order of the file. */
} conus_sites_kind;

/**
 * Finds points of a structure.
 * @param[out] out The sites; end them with conus_sites_destroy().
 * @param selector Of the atlas; its options do not matter.
 * @param names The structure, as conus_constraint.names; but for voxels with all that is hidden in it.
 * @param kind Which points.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a name that is unknown or means several, with close ones in the
 * message, and a structure without voxels, or, but for voxels, without these and a closed surface.
 * @threads One at a time for each @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_find(conus_sites **out, const conus_selector *selector, const char *names,
                                            conus_sites_kind kind);

/**
 * Keeps the sites that are in a structure, or those that are not.
 * @param sites The sites; unchanged on failure.
 * @param selector As for conus_sites_find().
 * @param names The structure: voxels and closed surfaces have an inside.
 * @param inside Whether those in it are kept.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT as of conus_sites_find().
 * @threads One at a time for each @p sites and @p selector.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_keep_named(conus_sites *sites, const conus_selector *selector, const char *names,
                                                  bool inside);

/**
 * Keeps the sites that are in the voxels of a region, or those that are not.
 * @param sites The sites.
 * @param roi The region, in their space.
 * @param inside Whether those in it are kept.
 * @threads One at a time for each @p sites.
 * @since 0.1
 */
CONUS_API void conus_sites_keep_roi(conus_sites *sites, const conus_roi *roi, bool inside);

/**
 * Keeps the vertices that have a label, or those that have none.
 * @param sites Of conus_sites_load(); unchanged on failure.
 * @param path Labels of its vertices, as conus_load_options.labels of a surface; label 0 is none.
 * @param labelled Whether those with a label are kept.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for sites of no surface; #CONUS_ERROR_DATA for labels of another number of
 * vertices; the errors of conus_atlas_load() about labels.
 * @threads One at a time for each @p sites.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_keep_labelled(conus_sites *sites, const char *path, bool labelled);

/**
 * Thins sites out: in their order, one is kept unless a kept one is nearer than @p spacing.
 * @param sites The sites; unchanged on failure.
 * @param spacing mm, from 0.001 on.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a spacing out of its range.
 * @threads One at a time for each @p sites.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_space(conus_sites *sites, double spacing);

/**
 * Counts sites.
 * @param sites NULL counts 0.
 * @return How many there are.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API size_t conus_sites_count(const conus_sites *sites);

/**
 * Gives the points.
 * @param sites The sites.
 * @return [count][3] World mm. Borrowed from the sites, until they are thinned out.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const double *conus_sites_points(const conus_sites *sites);

/**
 * Gives the normals.
 * @param sites The sites.
 * @return [count][3] Of length 1; NULL but of a surface. Borrowed from the sites, until they are thinned out.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const double *conus_sites_normals(const conus_sites *sites);

/**
 * Gives the number that site @p index has where it comes from.
 * @param sites The sites.
 * @param index From 0.
 * @return From 0: of a vertex in its file, of a voxel in its volume, x fastest, of a point in the array; 0 of a
 * centroid; UINT64_MAX past the last.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API uint64_t conus_sites_source(const conus_sites *sites, size_t index);

/**
 * Says whether sites are voxels of one volume, on whose grid conus_sites_write_maps() writes.
 * @param sites NULL has none.
 * @return True for sites from conus_sites_of_roi(), and from conus_sites_find() except centroids and structures of
 * several volumes.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API bool conus_sites_have_voxels(const conus_sites *sites);

/**
 * Writes numbers of sites of a surface as numbers of its vertices (conus_vertex_maps_write()); a vertex that is no site
 * has none. Those of sites that are voxels of one volume are written on its grid: NIfTI-1, float32, a volume for each
 * map along the fourth axis, NaN where no site is; a comment behind the header has the names, a line each.
 * @param path Ends in .func.gii or .shape.gii, or of voxels in .nii or .nii.gz.
 * @param sites Of conus_sites_load(), conus_sites_of_roi(), or conus_sites_find() of voxels.
 * @param maps [count] Their values are [conus_sites_count()].
 * @param count At least 1.
 * @param structure What the surface is; NULL = as its file says. Of voxels without meaning.
 * @param fill A vertex that is no site has the numbers of the nearest one that is nearer than this, of equal ones of
 * the first, mm; 0 = it has none. Of voxels 0.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for sites of neither kind; the errors of conus_vertex_maps_write() and of
 * reading the surface.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_sites_write_maps(const char *path, const conus_sites *sites,
                                                  const conus_vertex_map *maps, size_t count, const char *structure,
                                                  double fill);

/**
 * Gives note @p index that a careful user should know about these sites.
 * @param sites The sites.
 * @param index From 0.
 * @return One line; NULL past the last. Borrowed from the sites.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API const char *conus_sites_note(const conus_sites *sites, size_t index);

/**
 * Tells how much note @p index matters. A warning says that an answer may name another place or another area than the
 * data mean.
 * @param sites The sites.
 * @param index From 0.
 * @return #CONUS_SEVERITY_NOTE also past the last.
 * @threads Any: the object does not change.
 * @since 0.1
 */
CONUS_API conus_severity conus_sites_note_severity(const conus_sites *sites, size_t index);

/**
 * Ends sites.
 * @param sites NULL is allowed.
 * @threads One at a time for each @p sites.
 * @since 0.1
 */
CONUS_API void conus_sites_destroy(conus_sites *sites);
/** @} */

/** The most candidates that a stream has, 2^40. */
#define CONUS_CANDIDATE_LIMIT (UINT64_C(1) << 40)

/** Where needles enter, where they point, and how far they are tilted. */
typedef struct conus_candidates {
    size_t struct_size;    /**< Its size, as #CONUS_CANDIDATES_INIT sets it; 0 = that of this version. */
    const double *entries; /**< [entry_count][3] Where the device is, world mm. */
    const double *normals; /**< [entry_count][3] Outward at each entry, of any length but 0; NaN where there is none.
                              NULL = there are none. */
    size_t entry_count;    /**< At least 1. */
    const double *targets; /**< [target_count][3] To which it points, world mm. NULL = against the entry's normal. */
    size_t target_count;   /**< At least 1 with targets, else 0. */
    double tilt_most;      /**< Up to which angle each direction is tilted, 0 to pi/2 radians; 0 = it is not. */
    double tilt_step;      /**< Angle between one ring of tilted directions and the next, and within a ring at most,
                              from pi/18000 radians (0.01 degrees) to tilt_most. */
    bool to_target;        /**< Rows have a far end: the target's distance from the entry plus @p beyond. */
    double beyond;         /**< mm; below 0 it ends before the target. */
    double roll_step; /**< Each is also turned about its axis: ceil(2 pi / roll_step) times, equally; from pi/18000 to
                         pi radians; 0 = not turned. */
    const conus_frame *frame;        /**< Needles are turned about their axes as its space has it, as by
                                        conus_frame_turn_pose(); copied. NULL = #CONUS_SPACE_RAS. */
    const char *const *entry_names;  /**< [entry_count] What the entries are called in ids, in place of eI, up to 64
                                        bytes each, all different; NULL = they have no names. Only entries
                                        or only targets have names with a "-", which ids have between them. */
    const char *const *target_names; /**< [target_count] Likewise, in place of tJ. */
} conus_candidates;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CANDIDATES_INIT CONUS_INIT_(conus_candidates)

/**
 * Makes a stream of all candidates, in the order of entries, of one entry in that of targets, of these two in that of
 * tilts: the direction itself, then rings at tilt_step, 2 tilt_step and so on up to tilt_most; a ring at the angle t
 * has ceil(2 pi sin(t) / tilt_step) directions, from the device's +y on towards its +x (Eq. 2); of one tilt in that of
 * turns, which move the device's +y towards its +x. No memory grows with their number. A row's id is "eI-tJ-kK-rR" with
 * the numbers or names of entry, target, tilt and turn, from 1, without those that can only be 1; its line is its own
 * number. An entry that is the target itself is a row with an error.
 * @param[out] out The stream; end it with conus_pose_stream_destroy(). Its format is #CONUS_POSE_FORMAT_TABLE.
 * @param candidates Its arrays must outlive the stream.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for no entry or target, for one that is not finite, for a normal without
 * length, for none where they are needed, for tilts and turns out of their range, for a far end at targets that there
 * are not, and for more candidates than #CONUS_CANDIDATE_LIMIT.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_candidates_open(conus_pose_stream **out, const conus_candidates *candidates);

#ifdef __cplusplus
}
#endif

#endif
