/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file atlas.h
 * An atlas: the volumes, areas, pathways and bundles of one brain. This header loads and changes it; atlas_info.h reads
 * it.
 */
#ifndef CONUS_PUBLIC_ATLAS_H
#define CONUS_PUBLIC_ATLAS_H

#include <conus/status.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct conus_atlas conus_atlas; /**< Volumes, areas, pathways and bundles of one brain. */

/**
 * Receives what conus_atlas_load() reads next, on the thread that loads, before each file.
 * @param user The pointer that the options gave.
 * @param path The file. Valid until the callback returns.
 * @param done Files that are read.
 * @param total Files in all. It may change while files name others.
 * @return False cancels the load, which then fails with #CONUS_ERROR_CANCELLED.
 */
typedef bool (*conus_load_progress)(void *user, const char *path, size_t done, size_t total);

/** How conus_atlas_load() reads. */
typedef struct conus_load_options {
    size_t struct_size;  /**< Its size, as #CONUS_LOAD_OPTIONS_INIT sets it; 0 = that of this version. */
    const char *labels;  /**< Label table that replaces the file's own: PATH[,label=COLUMN,name=COLUMN]. For a surface:
                            labels of its vertices (.label.gii, .annot, .label, .dlabel.nii). For a file of several
                            volumes, none of them chosen: names of these. NULL = none. */
    uint64_t max_memory; /**< Largest file, and largest volume unpacked, in bytes, of those that are held in memory: of
                            large label volumes in a plain NIfTI or MGH file only the labels are. 0 = 8 GiB. */
    conus_load_progress progress; /**< NULL = no callback. */
    void *progress_user;          /**< Passed to @p progress. */
    bool labels_anyway; /**< Each value is a label, even where the values look like the grey values of an image. */
    conus_log log;      /**< Receives the notes of conus_atlas_note() while the atlas is loaded; NULL = no callback. */
    void *log_user;     /**< Passed to @p log. */
    double probability; /**< From which probability on a voxel belongs to an area of probabilities, above 0 to 1, in
                           place of 0.25 and of a manifest's; 0 = those. */
    bool without_context; /**< Leaves out the volume that is the context of a manifest or a BrainGlobe folder, unless
                             answers need it: where it blocks rays, where a transform of the manifest moves the atlas,
                             which is compared with its head, where the atlas has no volume before it, whose header
                             says whose brain it is, and where something is to be noted about its place. An atlas that
                             lacks it refuses conus_atlas_inward() and conus_atlas_transform(), which use it. */
} conus_load_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_LOAD_OPTIONS_INIT CONUS_INIT_(conus_load_options)

/**
 * Loads an atlas. The content of the file decides what it is, not its name:
 *
 *  - a labelled volume: NIfTI-1/2 (.nii, .hdr/.img, each also .gz), .mgz/.mgh, NRRD, MetaImage, AFNI, MINC 2, a TIFF
 *    stack, or an FSL atlas XML of type Label;
 *  - an FSL atlas XML of another type, a file of several volumes with a table of their names, or one volume whose
 *    name or options.probability states it: areas of probabilities, which may overlap;
 *  - a manifest NAME.atlas.json, which joins parcellations, surfaces, pathways and a context;
 *  - a surface (GIFTI, FreeSurfer and those of other programs), cut by the labels of its vertices if there are any;
 *  - CIFTI labels (.dlabel.nii) of surfaces that lie beside the file, and of voxels;
 *  - a folder of surfaces, or a BrainGlobe folder, or the manifest.json of an atlas of its third release;
 *  - by its name, a pack, NAME.conus (conus_atlas_save()), whose labels and probabilities are those of its packing.
 *
 * Values must be whole numbers from 0 to 4294967295; 0 is background. docs/formats.md says how the label table is
 * found, and how an image is told from labels.
 * @param[out] out The atlas; end it with conus_atlas_destroy().
 * @param path May end in ",volume=K" to choose volume K (from 0) of a 4-D file, of a TIFF stack in
 * ",resolution=R,orientation=ABC" (docs/spaces.md, "BrainGlobe"), and of CIFTI labels in ",map=K" or ",map=NAME".
 * ",template=WORD" states whose brain it is (conus_atlas_brain()): mni152, colin27, mni305, or none for one person's
 * own. ",space=WORD" states how the vertices of a surface are placed, whatever its file says: "ras" or "lps" in the
 * world, or else the image in whose own mm, as FSL counts them, they are.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO or #CONUS_ERROR_DATA where a file cannot be read or is damaged, and
 * #CONUS_ERROR_DATA for a volume that looks like an image unless labels_anyway is set; #CONUS_ERROR_UNSUPPORTED for a
 * valid file beyond this library; #CONUS_ERROR_MEMORY above max_memory; #CONUS_ERROR_ARGUMENT for a probability out of
 * its range, or of an atlas without areas of probabilities.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_load(conus_atlas **out, const char *path, const conus_load_options *options);

/**
 * Ends an atlas. Selectors, renderers and cutters of it must have ended before.
 * @param atlas NULL is allowed.
 * @threads One at a time for each @p atlas.
 * @since 0.1
 */
CONUS_API void conus_atlas_destroy(conus_atlas *atlas);

/** A band of values, from @p low to below @p high (Eq. 6). */
typedef struct conus_band {
    double low;       /**< The least value of it; -INFINITY = from the least of the volume. */
    double high;      /**< Values are below it; INFINITY = up to the largest of the volume, which is in the band. */
    const char *name; /**< UTF-8; that of no other pathway. */
} conus_band;

/** How conus_atlas_add_pathway() reads. */
typedef struct conus_pathway_options {
    size_t struct_size;  /**< Its size, as #CONUS_PATHWAY_OPTIONS_INIT sets it; 0 = that of this version. */
    double threshold;    /**< Values at or above it are the pathway (Eq. 6); 0 = a quarter of the file's scale. */
    const char *name;    /**< NULL = its name in an FSL atlas XML near it, else the file's name without its ending. */
    uint64_t max_memory; /**< As conus_load_options.max_memory. */
    conus_log log;       /**< As conus_load_options.log. */
    void *log_user;      /**< Passed to @p log. */
    const conus_band *bands; /**< [band_count] Each band is a pathway of its own; they have no value in common. With
                                them, threshold is 0 and name NULL. Copied. */
    size_t band_count;       /**< Up to 4096; 0 = one pathway, by the threshold. */
    const char *unit; /**< What its values are, for legends: UTF-8, up to 23 bytes; NULL = as the header or the file's
                         name says. */
} conus_pathway_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_PATHWAY_OPTIONS_INIT CONUS_INIT_(conus_pathway_options)

/**
 * Adds a scalar (probability) volume as one selectable pathway, or as one for each band of its values. Values that are
 * not finite belong to nothing.
 * @param atlas The atlas; unchanged on failure.
 * @param path The volume, as for conus_atlas_load().
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load(); #CONUS_ERROR_ARGUMENT for a threshold or a band that holds none
 * of the values, for bands that overlap, and for a band with the name of another pathway.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_add_pathway(conus_atlas *atlas, const char *path,
                                                   const conus_pathway_options *options);

/**
 * Changes from which value on a pathway, or an area of probabilities, is one (Eq. 6). Selectors, renderers and cutters
 * that were made before must be made anew.
 * @param atlas The atlas; unchanged on failure.
 * @param number Number of the object.
 * @param threshold In the units of the volume's scaled values.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where @p number is neither, or a band of values, or the threshold is out of
 * its range.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_set_threshold(conus_atlas *atlas, size_t number, double threshold);

/** How conus_atlas_set_context() reads. */
typedef struct conus_context_options {
    size_t struct_size;     /**< Its size, as #CONUS_CONTEXT_OPTIONS_INIT sets it; 0 = that of this version. */
    double block_threshold; /**< Voxels with values at or above it block rays: a skull, say. Rays do not hit what is
                               behind them, and such a pixel has no hit. 0 = no voxel blocks. */
    uint64_t max_memory;    /**< As conus_load_options.max_memory. */
    conus_log log;          /**< As conus_load_options.log. */
    void *log_user;         /**< Passed to @p log. */
    double opacity;         /**< Opacity of a surface, above 0 to 1; 0 = 0.25. A volume has its opacity in its transfer
                               function. */
} conus_context_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CONTEXT_OPTIONS_INIT CONUS_INIT_(conus_context_options)

/**
 * Sets what is drawn around the areas and is never selectable. A volume (a T1, say) replaces the one that is there. A
 * surface (a scalp, say, or one hemisphere's pial surface), in any format that conus reads, is drawn translucent beside
 * those that are there; rays never hit it, and conus_atlas_transform() does not move it.
 * @param atlas The atlas; unchanged on failure.
 * @param path The volume or surface, as for conus_atlas_load().
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load(); #CONUS_ERROR_ARGUMENT for a surface that is to block rays, for a
 * volume with an opacity, and for an opacity that is not allowed.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_set_context(conus_atlas *atlas, const char *path,
                                                   const conus_context_options *options);

/**
 * Adds a surface around the areas, as conus_atlas_set_context() does with one of a file: around all areas of voxels,
 * and with a context volume around the head in it, too (a brain, where the skull was taken away). Gaps that are
 * enclosed along two of the axes are inside. It is smooth, and lies 0.84 of a 96th of the longest edge of their box
 * outside.
 * @param atlas The atlas; unchanged on failure.
 * @param opacity Above 0 to 1; 0 = 0.12.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where there are no voxels of areas or of a head, and for an opacity that is
 * not allowed.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_add_shell(conus_atlas *atlas, double opacity);

/**
 * Tells as what conus_atlas_set_context() reads a file.
 * @param path The file.
 * @return True where it is a surface; false for everything else, also for a file that is not there.
 * @threads Any.
 * @since 0.1
 */
CONUS_API bool conus_context_is_surface(const char *path);

/** How conus_atlas_set_context_map() colours a surface. */
typedef struct conus_context_map_options {
    size_t struct_size;  /**< Its size, as #CONUS_CONTEXT_MAP_OPTIONS_INIT sets it; 0 = that of this version. */
    const char *array;   /**< Name of the file's array, or its number from 0; NULL = "0". */
    double range[2];     /**< Values at the ends of the colours, the lower first; both 0 = the least and the largest. */
    double opacity;      /**< Opacity of the surface from now on, above 0 to 1; 0 = 1. */
    uint64_t max_memory; /**< As conus_load_options.max_memory. */
    conus_log log;       /**< As conus_load_options.log. */
    void *log_user;      /**< Passed to @p log. */
} conus_context_map_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_CONTEXT_MAP_OPTIONS_INIT CONUS_INIT_(conus_context_map_options)

/**
 * Colours a surface that conus_atlas_set_context() has put around the areas by numbers of its vertices: from dark blue
 * over green to yellow, which people with any colour vision can tell apart. Where a number is not finite the surface
 * keeps its own colour. The map replaces the one that is there; pictures have a bar of its colours in the legend.
 * Renderers that were made before must be made anew.
 * @param atlas The atlas; unchanged on failure.
 * @param path A GIFTI file (.func.gii, .shape.gii) with as many numbers as one of the surfaces has vertices; where both
 * say which hemisphere they are, of that one.
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load(); #CONUS_ERROR_ARGUMENT for an array that is not there, with those
 * that are, where none or several of the surfaces fit, for a range that does not rise, and for an array without any
 * number.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_set_context_map(conus_atlas *atlas, const char *path,
                                                       const conus_context_map_options *options);

/** The meaning of the vectors of a deformation field. */
typedef enum conus_vectors {
    CONUS_VECTORS_AS_STATED = 0, /**< As its header says; FSL's that say nothing, as they look. */
    CONUS_VECTORS_RELATIVE,      /**< Displacements: ITK's in LPS, FSL's between its two images. */
    CONUS_VECTORS_ABSOLUTE       /**< Positions: SPM's in RAS, FSL's in the mm of the second image. */
} conus_vectors;

/** The axes in which a file has its numbers, where its user says so. */
typedef enum conus_file_space {
    CONUS_FILE_SPACE_AS_STATED = 0, /**< As the file says, or its format. */
    CONUS_FILE_SPACE_RAS,           /**< mm to the right, forwards and upwards. */
    CONUS_FILE_SPACE_LPS            /**< mm to the left, backwards and upwards. */
} conus_file_space;

/** How conus_atlas_transform() reads. */
typedef struct conus_transform_options {
    size_t struct_size;  /**< Its size, as #CONUS_TRANSFORM_OPTIONS_INIT sets it; 0 = that of this version. */
    const char *from;    /**< For FSL's files and FreeSurfer's register.dat: path of the image whose points it moves;
                            NULL otherwise. */
    const char *to;      /**< For these: path of the image to which it moves them; NULL otherwise. */
    bool inverse;        /**< The file moves points of the atlas to where poses are; of affines only. */
    const char *grid;    /**< Path of a volume, in the space from which the file takes points: voxels that a field moves
                            are resampled on its grid. NULL = on that of the field, parted until voxels are as fine as
                            the atlas's; for a B-spline from one end of it to the other, with voxels as small as the
                            atlas's smallest. */
    uint64_t max_memory; /**< As conus_load_options.max_memory, of the field and of what it resamples. */
    conus_vectors vectors; /**< For fields: the meaning of their vectors. */
    size_t transform;      /**< For a list of ITK's transforms that is no composite: K + 1 chooses number K, from 0; 0 =
                              there is one. */
    conus_file_space space; /**< For fields of NIfTI but FSL's: the axes of their vectors, mm. */
} conus_transform_options;

/** The defaults, and the size of the struct that the caller was compiled with. */
#define CONUS_TRANSFORM_OPTIONS_INIT CONUS_INIT_(conus_transform_options)

/**
 * Brings the atlas to where poses are, by a file that moves points from there to the atlas: an affine, a field, a
 * B-spline, or a composite of these, which in HDF5 (of ITK or X5) needs the program conus-hdf5. By an affine (ITK's
 * text or .mat, FreeSurfer's .lta or register.dat, the MNI's .xfm, FSL's matrix, or 4 x 4 numbers of RAS mm) matrices
 * of voxels are composed, exactly, and vertices and streamlines are moved. By a deformation field (of ITK, SPM or FSL,
 * as NIfTI) or a B-spline (of ITK, as its affines) voxels are resampled: a voxel of the new grid gets the value of the
 * atlas's own voxel that is nearest to where its centre goes, by one search through all that moves the atlas. Vertices
 * and points of streamlines go where the field leads back to them, to 1e-6 mm before rounding to float; triangles with
 * a vertex that has no such place are left out, and so are whole streamlines with such a point; a note says so.
 * Everything in the atlas moves with it, its context too; what is added later does not. Lengths and volumes are then
 * measured where poses are. Before a selector or renderer is made, and before something is hidden;
 * conus_atlas_set_hemispheres() comes before a field. If points go through several transforms one after the other, call
 * this for the last one first. docs/spaces.md has the formats.
 * @param atlas The atlas; unchanged on failure.
 * @param path The file.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO or #CONUS_ERROR_DATA where the file cannot be read or is damaged, for a matrix
 * that cannot be inverted, and where the field leads to nothing of the atlas, or of a surface;
 * #CONUS_ERROR_UNSUPPORTED for another kind of transform, and for the inverse of a field; #CONUS_ERROR_ARGUMENT for
 * FSL's files and register.dat without their images, for images with another file, for a field that does not say what
 * its vectors are, for a grid where nothing is resampled, where something is hidden, for an attached atlas that a field
 * has moved, and for one without its context.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_transform(conus_atlas *atlas, const char *path,
                                                 const conus_transform_options *options);

/**
 * Does the same by a matrix in memory.
 * @param atlas The atlas; unchanged on failure.
 * @param atlas_from_world Moves points from where poses are to the atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA for a matrix that has no inverse or another last row than 0 0 0 1.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_move(conus_atlas *atlas, const double atlas_from_world[16]);

/** How an atlas has left and right areas. */
typedef enum conus_hemispheres {
    CONUS_HEMISPHERES_AS_IS = 0, /**< As the label table has them. */
    CONUS_HEMISPHERES_SPLIT,     /**< Areas that lie on both sides become two, cut at world x = 0. */
    CONUS_HEMISPHERES_MERGED     /**< Left and right areas of one name are reported as one. */
} conus_hemispheres;

/**
 * Changes how the atlas has left and right areas, once, before a selector or renderer is made. A note says what was
 * done. Splitting takes the plane x = 0 of the atlas's own space for the midline (conus_atlas_own_point()) and changes
 * the numbers of objects. Merging adds the common areas that pairs are reported as. docs/model.md, Eq. 10, has the
 * rules.
 * @param atlas The atlas; unchanged on failure.
 * @param hemispheres What to do.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where something is hidden; #CONUS_ERROR_DATA where nothing can be split or
 * merged; #CONUS_ERROR_UNSUPPORTED for splitting meshes.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_set_hemispheres(conus_atlas *atlas, conus_hemispheres hemispheres);

/**
 * Mirrors an atlas whose voxels are stored from the other side than its header says: about the middle of its first
 * volume along x, so that its grid stays where it is, or without a volume about x = 0. What is in the atlas is mirrored
 * with it; whose brain it is stays known. The note of conus_atlas_exchanged() goes, and comes again if names and places
 * contradict each other then. Before conus_atlas_transform() and before a selector or renderer is made.
 * @param atlas The atlas; unchanged on failure.
 * @return #CONUS_OK; #CONUS_ERROR_MEMORY; #CONUS_ERROR_DATA where a field has moved it.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_exchange_sides(conus_atlas *atlas);

/**
 * Finds out which areas are left and which right. The side of an area is that of the label table, or that in a pair as
 * #CONUS_HEMISPHERES_MERGED makes one, or that of a word in its name, such as "left" or "rh". An area without any of
 * these has the side of the nearest area above it in the tree that has one. Where it lies does not count.
 * @param[out] sides [conus_atlas_object_count() + 1] By number: 'L', 'R', or 0 of areas of both sides or of none that
 * is known, and of pathways and bundles; entry 0 is 0.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_MEMORY.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_sides(char *sides, const conus_atlas *atlas);

/** @name Hiding
 * A hidden object is as if it had never been loaded: no ray hits it, no picture shows it, and it blocks nothing. Shown
 * objects keep their numbers, volumes and fractions. Selectors and cutters that were made before must be made anew;
 * for renderers call conus_renderer_update().
 * @{ */

/**
 * Shows all objects, or only those that @p only names, and of these hides those that @p hide names. Both are lists,
 * separated by commas, of names, abbreviations and labels. An area stands for all below it in the area tree. A name
 * with a comma stands in double quotes. An at sign and a path stand for a file with one name per line.
 * @param atlas The atlas; unchanged on failure.
 * @param only NULL = no list.
 * @param hide NULL = no list.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT, with the closest name in the message, for a name that is no object, and
 * where nothing is left.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_show(conus_atlas *atlas, const char *only, const char *hide);

/**
 * Hides the objects that @p hidden marks and shows all others.
 * @param atlas The atlas; unchanged on failure.
 * @param hidden [object count + 1], by number; entry 0 has no meaning. NULL shows all.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where nothing is left.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_set_hidden(conus_atlas *atlas, const bool *hidden);

/**
 * Returns whether an object is hidden.
 * @param atlas The atlas.
 * @param number Number of the object.
 * @return Whether it is hidden; false for a number that is no object.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API bool conus_atlas_is_hidden(const conus_atlas *atlas, size_t number);
/** @} */

/**
 * Gives all areas, pathways and bundles colours that people with any colour vision can tell apart as well as possible:
 * different ones to areas that touch, the same to the left and the right one of a pair. With more than 8191 areas, or
 * without memory, colours follow the atlas's order. Renderers that were made before keep the old ones.
 * @param atlas The atlas.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_API void conus_atlas_use_safe_colours(conus_atlas *atlas);

/**
 * Gives all areas, pathways and bundles colours of a palette, as conus_atlas_use_safe_colours() does: each plain, and
 * lighter and darker where areas that touch need more.
 * @param atlas The atlas.
 * @param rgb [count][3] sRGB. Copied.
 * @param count 1 to 80.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another count.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_use_palette(conus_atlas *atlas, const uint8_t *rgb, size_t count);

/**
 * Gives all areas, pathways and bundles the colours back that they had before conus_atlas_use_safe_colours() or
 * conus_atlas_use_palette().
 * @param atlas The atlas.
 * @threads One at a time, while no other thread uses the atlas.
 * @since 0.1
 */
CONUS_API void conus_atlas_use_own_colours(conus_atlas *atlas);

/** @name Sharing between processes
 * One process loads an atlas and packs it into memory that all processes map: a file of memfd_create(), POSIX shared
 * memory, an MPI window, Python's multiprocessing.shared_memory. All processes attach it there. Voxels, values,
 * vertices, triangles, streamlines with their trees and the tables that the rays engine makes of voxels are in that
 * memory once. Each process has its own names, and its own trees over triangles, which Embree cannot move.
 * @{ */

/**
 * Gives the memory that conus_atlas_pack() needs.
 * @param atlas The atlas.
 * @return Bytes.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_API size_t conus_atlas_packed_size(const conus_atlas *atlas);

/**
 * Packs the atlas as it is. The packed bytes hold no pointers and may be mapped at another address in each process, but
 * they are for this build of conus on this kind of machine: conus_atlas_save() makes files.
 * @param[out] memory [size], at a multiple of 64 bytes. On failure its content has no meaning.
 * @param size Bytes, at least conus_atlas_packed_size().
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for too few bytes or another alignment; #CONUS_ERROR_MEMORY.
 * @threads Any, while none changes the atlas.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_pack(void *memory, size_t size, const conus_atlas *atlas);

/**
 * Makes an atlas of what conus_atlas_pack() wrote. An atlas that is then changed (its thresholds, its hemispheres) gets
 * its own copies of the arrays that the change concerns. The large arrays are not checked: attach only what you trust.
 * @param[out] out The atlas; end it with conus_atlas_destroy().
 * @param memory The packed atlas, at a multiple of 64 bytes. It is never written to and must outlive the atlas.
 * @param size Bytes.
 * @return #CONUS_OK; #CONUS_ERROR_DATA where there is no whole atlas of this version.
 * @threads Any.
 * @since 0.1
 */
CONUS_CHECKED conus_status conus_atlas_attach(conus_atlas **out, const void *memory, size_t size);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
