/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file atlas.h
 * An atlas: the volumes, areas, pathways and bundles of one brain. Load it, change it, read what it has, find those
 * that are installed, and keep it in a pack.
 */
#ifndef CONUS_PUBLIC_ATLAS_H
#define CONUS_PUBLIC_ATLAS_H

#include <conus/status.h>
#include <conus/table.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** @name Loading and changing
 * @{ */

typedef struct conus_atlas conus_atlas; /**< Volumes, areas, pathways and bundles of one brain. */

/** Receives what conus_atlas_load() reads next, on the thread that loads, before each file.
 * @param user The pointer that the options gave.
 * @param path The file. Valid until the callback returns.
 * @param done Files that are read.
 * @param total Files in all. It may change while files name others.
 * @return False cancels the load, which then fails with #CONUS_ERROR_CANCELLED. */
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
    conus_log log;      /**< Receives the notes of conus_atlas_list() while the atlas is loaded; NULL = no callback. */
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
 * found, and how images and labels are distinguished.
 * @param[out] out The atlas; end it with conus_atlas_destroy().
 * @param path A path, or a name of conus_list_installed(), "aal" or "mricron:aal", where it has no '/' and no file or
 * folder is called so; the labels of the list count where the options have none. It may end in ",volume=K" to choose
 * volume K (from 0) of a 4-D file, of a TIFF stack in ",resolution=R,orientation=ABC" (docs/spaces.md, "BrainGlobe"),
 * and of CIFTI labels in ",map=K" or ",map=NAME". ",template=WORD" states whose brain it is (conus_atlas_brain()):
 * mni152, colin27, mni305, or none for one person's
 * own. ",space=WORD" states how the vertices of a surface are placed, whatever its file says: "ras" or "lps" in the
 * world, or else the image in whose own mm, as FSL counts them, they are.
 * @param options NULL = defaults.
 * @return #CONUS_OK; #CONUS_ERROR_IO or #CONUS_ERROR_DATA where a file cannot be read or is damaged, and
 * #CONUS_ERROR_DATA for a volume that looks like an image unless labels_anyway is set; #CONUS_ERROR_UNSUPPORTED for a
 * valid file beyond this library; #CONUS_ERROR_MEMORY above max_memory; #CONUS_ERROR_ARGUMENT for a probability out of
 * its range, or of an atlas without areas of probabilities.
 */
CONUS_CHECKED conus_status conus_atlas_load(conus_atlas **out, const char *path, const conus_load_options *options);

/** Ends an atlas. Selectors, renderers and cutters of it must have ended before.
 * @param atlas NULL is allowed. */
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

/** Adds a scalar (probability) volume as one selectable pathway, or as one for each band of its values. Values that are
 * not finite belong to nothing.
 * @param atlas The atlas; unchanged on failure.
 * @param path The volume, as for conus_atlas_load().
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load(); #CONUS_ERROR_ARGUMENT for a threshold or a band that holds none
 * of the values, for bands that overlap, and for a band with the name of another pathway. */
CONUS_CHECKED conus_status conus_atlas_add_pathway(conus_atlas *atlas, const char *path,
                                                   const conus_pathway_options *options);

/** Changes from which value on a pathway, or an area of probabilities, is one (Eq. 6). Selectors, renderers and cutters
 * that were made before must be made anew.
 * @param atlas The atlas; unchanged on failure.
 * @param number Number of the object.
 * @param threshold In the units of the volume's scaled values.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where @p number is neither, or a band of values, or the threshold is out of
 * its range. */
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

/** Sets what is drawn around the areas and is never selectable. A volume (a T1, say) replaces the one that is there. A
 * surface (a scalp, say, or one hemisphere's pial surface), in any format that conus reads, is drawn translucent beside
 * those that are there; rays never hit it, and conus_atlas_transform() does not move it.
 * @param atlas The atlas; unchanged on failure.
 * @param path The volume or surface, as for conus_atlas_load().
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load(); #CONUS_ERROR_ARGUMENT for a surface that is to block rays, for a
 * volume with an opacity, and for an opacity that is not allowed. */
CONUS_CHECKED conus_status conus_atlas_set_context(conus_atlas *atlas, const char *path,
                                                   const conus_context_options *options);

/** Adds a surface around the areas, as conus_atlas_set_context() does with one of a file: around all areas of voxels,
 * and with a context volume around the head in it, too (a brain, where the skull was taken away). Gaps that are
 * enclosed along two of the axes are inside. It is smooth, and lies 0.84 of a 96th of the longest edge of their box
 * outside.
 * @param atlas The atlas; unchanged on failure.
 * @param opacity Above 0 to 1; 0 = 0.12.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where there are no voxels of areas or of a head, and for an opacity that is
 * not allowed. */
CONUS_CHECKED conus_status conus_atlas_add_shell(conus_atlas *atlas, double opacity);

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

/** Colours a surface that conus_atlas_set_context() has put around the areas by numbers of its vertices: from dark blue
 * over green to yellow, which people with any colour vision can tell apart. Where a number is not finite the surface
 * keeps its own colour. The map replaces the one that is there; pictures have a bar of its colours in the legend.
 * Renderers that were made before must be made anew.
 * @param atlas The atlas; unchanged on failure.
 * @param path A GIFTI file (.func.gii, .shape.gii) with as many numbers as one of the surfaces has vertices; where both
 * say which hemisphere they are, of that one.
 * @param options NULL = defaults.
 * @return #CONUS_OK; the errors of conus_atlas_load(); #CONUS_ERROR_ARGUMENT for an array that is not there, with those
 * that are, where none or several of the surfaces fit, for a range that does not rise, and for an array without any
 * number. */
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

/** Brings the atlas to where poses are, by a file that moves points from there to the atlas: an affine, a field, a
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
 * that cannot be inverted, and where the field leads to nothing of the atlas, or of a surface; #CONUS_ERROR_UNSUPPORTED
 * for another kind of transform, and for the inverse of a field; #CONUS_ERROR_ARGUMENT for FSL's files and register.dat
 * without their images, for images with another file, for a field that does not say what its vectors are, for a grid
 * where nothing is resampled, where something is hidden, for an attached atlas that a field has moved, and for one
 * without its context. */
CONUS_CHECKED conus_status conus_atlas_transform(conus_atlas *atlas, const char *path,
                                                 const conus_transform_options *options);

/** Moves the atlas to the space of poses by a matrix in memory, as conus_atlas_transform() does by a file.
 * @param atlas The atlas; unchanged on failure.
 * @param atlas_from_world Moves points from where poses are to the atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA for a matrix that has no inverse or another last row than 0 0 0 1. */
CONUS_CHECKED conus_status conus_atlas_move(conus_atlas *atlas, const double atlas_from_world[16]);

/** How an atlas has left and right areas. */
typedef enum conus_hemispheres {
    CONUS_HEMISPHERES_AS_IS = 0, /**< As the label table has them. */
    CONUS_HEMISPHERES_SPLIT,     /**< Areas that lie on both sides become two, cut at the midline. */
    CONUS_HEMISPHERES_MERGED     /**< Left and right areas of one name are reported as one. */
} conus_hemispheres;

/** Changes how the atlas has left and right areas, once, before a selector or renderer is made. A note says what was
 * done. Splitting takes the plane x = 0 of the atlas's own space for the midline (conus_atlas_own_point()), in the
 * Allen CCF ML 5700 um, and changes the numbers of objects. Merging adds the common areas that pairs are reported as.
 * docs/model.md, Eq. 10, has the rules.
 * @param atlas The atlas; unchanged on failure.
 * @param hemispheres What to do.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT where something is hidden; #CONUS_ERROR_DATA where nothing can be split or
 * merged; #CONUS_ERROR_UNSUPPORTED for splitting meshes, and the CCF where x runs against ML. */
CONUS_CHECKED conus_status conus_atlas_set_hemispheres(conus_atlas *atlas, conus_hemispheres hemispheres);

/** Mirrors an atlas whose voxels are stored from the other side than its header says: about the middle of its first
 * volume along x, so that its grid stays where it is, or without a volume about x = 0. What is in the atlas is mirrored
 * with it; whose brain it is stays known. The note of kind "exchanged" goes, and comes again if names and places
 * contradict each other then. Before conus_atlas_transform() and before a selector or renderer is made.
 * @param atlas The atlas; unchanged on failure.
 * @return #CONUS_OK; #CONUS_ERROR_MEMORY; #CONUS_ERROR_DATA where a field has moved it. */
CONUS_CHECKED conus_status conus_atlas_exchange_sides(conus_atlas *atlas);
/** @} */

/** @name Hiding
 * A hidden object is as if it had never been loaded: no ray hits it, no picture shows it, and it blocks nothing. Shown
 * objects keep their numbers, volumes and fractions. Selectors and cutters that were made before must be made anew;
 * for renderers call conus_renderer_update().
 * @{ */

/** Shows all objects, or only those that @p only names, and of these hides those that @p hide names. Both are lists,
 * separated by commas, of names, abbreviations and labels. An area stands for all below it in the area tree. A name
 * with a comma stands in double quotes. An at sign and a path stand for a file with one name per line.
 * @param atlas The atlas; unchanged on failure.
 * @param only NULL = no list.
 * @param hide NULL = no list.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT, with the closest name in the message, for a name that is no object, and
 * where nothing is left. */
CONUS_CHECKED conus_status conus_atlas_show(conus_atlas *atlas, const char *only, const char *hide);
/** @} */

/** @name Colours
 * @{ */

/** Gives all areas, pathways and bundles colours that people with any colour vision can tell apart as well as possible:
 * different ones to areas that touch, the same to the left and the right one of a pair. With more than 8191 areas, or
 * without memory, colours follow the atlas's order. Renderers that were made before keep the old ones.
 * @param atlas The atlas. */
CONUS_API void conus_atlas_use_safe_colours(conus_atlas *atlas);

/** Gives all areas, pathways and bundles colours of a palette, as conus_atlas_use_safe_colours() does: each plain, and
 * lighter and darker where areas that touch need more.
 * @param atlas The atlas.
 * @param rgb [count][3] sRGB. Copied.
 * @param count 1 to 80.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another count. */
CONUS_CHECKED conus_status conus_atlas_use_palette(conus_atlas *atlas, const uint8_t *rgb, size_t count);
/** @} */

/** @name What an atlas has
 * @{ */

/** Kind of an object or a result. */
typedef enum conus_kind {
    CONUS_KIND_AREA = 1,   /**< An area of a parcellation or of a probabilistic atlas, a mesh, or a group of areas. */
    CONUS_KIND_PATHWAY,    /**< A scalar volume from a threshold on, or in a band of values. */
    CONUS_KIND_UNASSIGNED, /**< Only of a result: the pixels that hit no object, or first a context that blocks. */
    CONUS_KIND_BUNDLE      /**< Streamlines of a tractogram: all of them, or a group. */
} conus_kind;

/** An area, a pathway or a bundle. */
typedef struct conus_object {
    conus_kind kind;          /**< #CONUS_KIND_AREA, #CONUS_KIND_PATHWAY or #CONUS_KIND_BUNDLE. */
    uint32_t label;           /**< The atlas's own number of the area; a pathway's or bundle's ordinal, from 1. */
    const char *name;         /**< UTF-8, one line. An area that no table names has its number here. */
    const char *abbreviation; /**< UTF-8; "" if the table gives none. */
    char hemisphere;          /**< 'L', 'R' or 'B' (both) where the table says so, else 0. */
    bool named;               /**< The table has a name for it. */
    uint8_t rgb[3];           /**< sRGB, from the table or else generated. */
    uint32_t parent;          /**< Number of the object that contains it in the area tree, 0 if none. */
    uint64_t voxels;          /**< Its own voxels, without those of its children. */
    double volume_mm3;        /**< The volume of these, mm^3. */
    uint64_t triangles;       /**< Triangles of its surface, where the area is a mesh (then voxels is 0). */
    bool closed;   /**< That surface bounds a solid. volume_mm3 is 0 if it does not, and if its parts overlap or face
                      different ways, so that its volume is not known. */
    bool is_band;  /**< A pathway that is a band of values; other pathways may be of the same volume. */
    size_t volume; /**< For an object with voxels: index of its volume, for conus_atlas_volume(); else 0. */
    double low;    /**< For these: the least value of its voxels, its threshold; -INFINITY = any. Else 0. */
    double high;   /**< For these: its voxels' values are below it; INFINITY = any. Else 0. */
    uint64_t streamlines; /**< For a bundle: the number of its streamlines; else 0. */
    uint64_t points;      /**< Points of these. */
    double length_mm;     /**< Total length of these, mm. */
    double radius;        /**< For a bundle: a ray hits a streamline that is nearer than this, mm (Eq. 18). Else 0. */
} conus_object;

/** Counts the objects. Areas come first: those of each volume of labels, then those that are meshes, each ordered by
 * label, then those that only group others, then those of a probabilistic atlas. Pathways and bundles follow in the
 * order in which they were added.
 * @param atlas NULL counts 0.
 * @return How many objects there are; their numbers are 1 to this. */
CONUS_API size_t conus_atlas_object_count(const conus_atlas *atlas);

/** Gives object @p number.
 * @param atlas The atlas.
 * @param number 1 to conus_atlas_object_count().
 * @return NULL for another number. Borrowed until the atlas is changed or ends. */
CONUS_API const conus_object *conus_atlas_object(const conus_atlas *atlas, size_t number);

/** Finds the pathway or bundle called @p name, or else the one area with that name, abbreviation or label.
 * @param[out] out Its number.
 * @param atlas The atlas.
 * @param name What to find.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT if there is none, with the closest one in the message, and if there are
 * several. */
CONUS_CHECKED conus_status conus_atlas_find(uint32_t *out, const conus_atlas *atlas, const char *name);

/** Role of a volume. */
typedef enum conus_role {
    CONUS_ROLE_PARCELLATION = 1, /**< Its values are labels of areas. */
    CONUS_ROLE_SCALAR,           /**< Its values make a pathway, or several. */
    CONUS_ROLE_CONTEXT,          /**< It is drawn around the areas. */
    CONUS_ROLE_PROBABILITY       /**< Its values, from 0 to 1, make an area of a probabilistic atlas. */
} conus_role;

/** A volume of an atlas. */
typedef struct conus_volume_info {
    conus_role role;     /**< Its role. */
    const char *path;    /**< Path of the voxels, or of a header of text, as opened: bytes, not always UTF-8. */
    char sha256[65];     /**< SHA-256 of that file, in hexadecimal; of a header of text with its voxels behind it. */
    char format[48];     /**< "NIfTI-1, gzip, big-endian". */
    char datatype[16];   /**< "uint8", "float64". */
    size_t dim[3];       /**< Voxels along i, j, k. */
    size_t volume;       /**< Which volume of a 4-D file, from 0. */
    size_t volume_count; /**< How many volumes the file has. */
    double world_from_voxel[16]; /**< Maps voxel indices (centres at whole numbers) to world mm. */
    double spacing[3];           /**< Edge lengths of a voxel in mm. */
    char orientation[4];         /**< Towards which i, j, k grow: "RAS", "LPI". */
    char transform[96];          /**< Where world_from_voxel comes from: "sform, code 4 (MNI 152)". */
    int space_code;              /**< NIfTI's code of the space that it maps to, 4 for MNI 152; 0 if unknown. */
    double slope;                /**< Slope of the stored values; 1 if unscaled. */
    double intercept;            /**< Intercept of the stored values; 0 if unscaled. */
    double minimum;              /**< Least of the scaled values. */
    double maximum;              /**< Largest of the scaled values. */
    double threshold; /**< Threshold of a pathway that is no band, of an area of a probabilistic atlas, or of a context
                         that blocks; else 0. */
    char unit[24];    /**< What the values of a map are, in UTF-8: "z", "probability", "% signal change", as
                         conus_pathway_options.unit, the header's intent or the file's name says; "" = not known. */
} conus_volume_info;

/** Gives volume @p index.
 * @param atlas The atlas.
 * @param index From 0.
 * @return NULL past the last. Borrowed until the atlas is changed or ends. */
CONUS_API const conus_volume_info *conus_atlas_volume(const conus_atlas *atlas, size_t index);

/** Finds where a world point is in the atlas's own space, that of its files.
 * @param[out] out mm; the point itself, unless the atlas was moved (conus_atlas_transform()); NaN where a deformation
 * field has moved it and says nothing of the point. May be @p point.
 * @param atlas The atlas.
 * @param point World mm. */
CONUS_API void conus_atlas_own_point(double out[3], const conus_atlas *atlas, const double point[3]);

/**
 * Lists what an atlas has.
 * @param[out] out The list; end it with conus_table_destroy(). Columns of
 *  - "objects": kind, index, name, abbreviation, prefix, which tells it from others of its name, side, depth and parent
 *    in the area tree, hidden; a row is the object of its number;
 *  - "surfaces", those of conus_atlas_set_context(): path, hemisphere, vertices, triangles, closed, opacity, and the
 * box around them;
 *  - "tractograms": path, format, sha256, streamlines, points, length_mm, radius_mm, bundles, scalars, half, and the
 * box around them; conus_table_objects() has the first of their bundles;
 *  - "files", other files that it is made of, a manifest, surfaces, labels, lists: path;
 *  - "notes" that a careful user should know: kind and text. A row of kind "labels" says whence the names are. One of
 *    kind "exchanged" says that left and right are, of the names or of the places: tell nobody a side of such an atlas;
 *    conus_atlas_exchange_sides() mends one whose places are. One of kind "warning" says that an answer may name
 *    another place or another area than the data mean.
 * @param atlas The atlas.
 * @param what "objects", "surfaces", "tractograms", "files" or "notes".
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another word, and where one of the two is NULL.
 */
CONUS_CHECKED conus_status conus_atlas_list(conus_table **out, const conus_atlas *atlas, const char *what);

/** Whose brain an atlas is. */
typedef enum conus_brain {
    CONUS_BRAIN_UNKNOWN = 0, /**< Nothing says. */
    CONUS_BRAIN_OWN,         /**< One person's own, in the space of that person's scan. */
    CONUS_BRAIN_MNI152,      /**< The MNI's average of 152 people, of any edition. */
    CONUS_BRAIN_COLIN27,     /**< One person's, averaged over 27 scans and brought to the MNI's space. */
    CONUS_BRAIN_MNI305,      /**< The MNI's average of 305 people, as fsaverage has it. */
    CONUS_BRAIN_TALAIRACH,   /**< That of Talairach and Tournoux. */
    CONUS_BRAIN_TEMPLATE     /**< Another template, also of an animal. */
} conus_brain;

/** Whose brain an atlas is, and how that is known. */
typedef struct conus_brain_view {
    conus_brain brain;   /**< Whose. */
    const char *edition; /**< Of MNI 152: "NLin2009", or "earlier" for those before it; "" = not known. Static. */
    const char *source;  /**< "stated", "header", "grid", "voxels", "CCF"; "" of an unknown one. Static. */
    const char *words;   /**< "MNI 152, NLin2009", "Colin 27", "one person's own". Static. */
    bool is_moved;       /**< A transform has moved it since: it lies in another space, which is unknown unless
                            stated. */
} conus_brain_view;

/** Tells whose brain an atlas is: what is stated (",template=" of conus_atlas_load(), "template" of a manifest), else
 * what the header of its first volume says (NIfTI's codes 3, 4 and 5), else what its grid says, which also tells Colin
 * 27 and editions of MNI 152 from each other, else what the voxels and names of a published atlas say (docs/spaces.md,
 * "Which atlas"). FreeSurfer's grid of 256^3 mm is anybody's. An atlas that was moved since is unknown, but one
 * person's own stays so.
 * @param atlas The atlas.
 * @return The brain. Its texts are static. */
CONUS_API conus_brain_view conus_atlas_brain(const conus_atlas *atlas);

/** Where the areas of an atlas lie: those that are not hidden, of voxels, or else of surfaces. */
typedef struct conus_placement {
    size_t struct_size; /**< Its size, as #CONUS_PLACEMENT_INIT sets it; 0 = that of this version. */
    bool is_moved;      /**< By conus_atlas_transform(), conus_atlas_move() or a manifest's "transform". */
    bool mirrors;       /**< Left and right are exchanged. */
    bool has_context;   /**< There is a context, and the last three are known: its volume, or else closed surfaces. */
    bool is_warped;     /**< By a deformation field: the matrix, growth and own box are NAN, mirrors is false. */
    double atlas_from_world[16]; /**< From where it lies to its own space, that of its files. */
    double growth;               /**< Volume here of 1 mm^3 in its own space, mm^3. */
    double own_low[3];           /**< Lowest x, y, z of the box around it in its own space, mm. */
    double own_high[3];          /**< The highest. */
    double low[3];               /**< Lowest x, y, z of the box around it here, world mm. */
    double high[3];              /**< The highest. */
    double centre[3];            /**< The mean of its voxels' centres, or of its vertices; world mm. */
    double distance_mm;          /**< How far that is from where it is in its own space. */
    double head_threshold; /**< Values of the context from this one on are the head's, with what they enclose along two
                              axes of its grid; by Otsu's method. INFINITY where all are alike. For surfaces it is
                              between 0, outside, and 1, inside. */
    double in_grid;        /**< Part of the voxels whose centre is in the grid of the context, or in the box around its
                              surfaces, 0 to 1. */
    double in_head;        /**< Part of the voxels whose centre is in the head, 0 to 1. */
} conus_placement;

/** The size of the struct that the caller was compiled with. */
#define CONUS_PLACEMENT_INIT CONUS_INIT_(conus_placement)

/** Tells where an atlas lies, where it lay in its own space, and which part of it is in the head that its context
 * shows. Parts and centre are those of 131072 voxels, or vertices, at most.
 * @param[in,out] out Its struct_size is read.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA where there are no areas; #CONUS_ERROR_MEMORY. */
CONUS_CHECKED conus_status conus_atlas_placement(conus_placement *out, const conus_atlas *atlas);

/** Finds the box around all voxels, triangles and streamlines that are not hidden.
 * @param[out] low Its lowest x, y, z, world mm.
 * @param[out] high Its highest x, y, z, world mm.
 * @param atlas The atlas.
 * @return #CONUS_OK; #CONUS_ERROR_DATA if there are none. */
CONUS_CHECKED conus_status conus_atlas_bounds(double low[3], double high[3], const conus_atlas *atlas);

/** Interpolates a scalar or context volume at a world position, between the centres of its voxels.
 * @param atlas The atlas.
 * @param index The volume.
 * @param point World mm.
 * @return The scaled value; NaN outside the volume's cells, and where there is no such volume. */
CONUS_API double conus_atlas_value(const conus_atlas *atlas, size_t index, const double point[3]);

/** By what a direction into the head was found. */
typedef enum conus_inward {
    CONUS_INWARD_SURFACE = 0, /**< Closed surfaces of the context. */
    CONUS_INWARD_IMAGE,       /**< The head in the context's image: from a threshold on by Otsu's method. */
    CONUS_INWARD_ATLAS        /**< The convex hull of what is shown of the atlas: the way to its nearest point. */
} conus_inward;

/** Finds the direction straight into the head at a point on it: against the mean normal of the head's surface within 5
 * mm, weighted by area; where the context has none there, the way to the nearest point of the atlas's convex hull.
 * @param[out] out World, of length 1.
 * @param[out] from By what; NULL = not wanted.
 * @param atlas The atlas with its context.
 * @param point World mm.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for a point in the hull and no surface near it, and for an atlas that was
 * loaded without its context; #CONUS_ERROR_MEMORY. */
CONUS_CHECKED conus_status conus_atlas_inward(double out[3], conus_inward *from, const conus_atlas *atlas,
                                              const double point[3]);
/** @} */

/** @name Names
 * The atlases that are installed on this computer, by name, and the words that options take. docs/commands.md says in
 * which folders atlases are looked for.
 * @{ */

/** Lists the atlases in the folders that the environment names: $CONUS_ATLAS_PATH, and where mricron, FSL, FreeSurfer,
 * BrainGlobe, TemplateFlow, AFNI, SPM, CAT12, nilearn and MRIcroGL keep theirs. Reads names, the headers of volumes and
 * the XMLs of FSL atlases, no voxel. A folder that cannot be read, or that holds more than is looked at, is a note.
 * @param[out] out Columns name (for conus_atlas_load(), of several of one name as "source:name"), source, kind,
 * spacing_x, spacing_y, spacing_z, path and labels; those of one source stand together, $CONUS_ATLAS_PATH comes first.
 * Its part "places" has the folders, there or not: source, rule, path, there. End it with conus_table_destroy().
 * @param log Receives the notes; NULL = no callback.
 * @param log_user Passed to @p log.
 * @return #CONUS_OK, also where nothing is found.
 * @threads Any, while none changes the environment. */
CONUS_CHECKED conus_status conus_list_installed(conus_table **out, conus_log log, void *log_user);

/** Lists the words that an option takes, or of which it is made.
 * @param[out] out Columns name and help, of which most words have none; in the order of the enum, where there is one.
 * Of "errors" name, tilt_deg, shift_mm, entry_mm, target_mm, depth_mm, measured, source (conus_pose_error). End it with
 * conus_table_destroy().
 * @param what "formats" and "rows" (conus_report_options), "pose formats" (conus_pose_options.format), "scores"
 * (conus_selector_options.score), "spaces" (#conus_space), "transfers" (presets of grey values for the context volume)
 * or "errors" that are published, of which the tilt of vr-controller is that of a target 4 degrees wide.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another word or NULL. */
CONUS_CHECKED conus_status conus_list_choices(conus_table **out, const char *what);
/** @} */

/** @name Packs
 * A loaded atlas in one file, which opens at once. conus_atlas_load() opens it like any other atlas.
 * @{ */

/** The ending of a pack's name. */
#define CONUS_PACK_ENDING ".conus"

/** How conus_atlas_save() writes. */
typedef struct conus_save_options {
    size_t struct_size;         /**< Its size, as #CONUS_SAVE_OPTIONS_INIT sets it; 0 = that of this version. */
    const char *words;          /**< How it is packed again, for people: a command line. NULL = not known. */
    const char *const *sources; /**< [source_count] Files that were read, in addition to those that the atlas knows,
                                     which lacks the voxels of a header of text. */
    size_t source_count;        /**< How many. */
} conus_save_options;

/** The size of the struct that the caller was compiled with. */
#define CONUS_SAVE_OPTIONS_INIT CONUS_INIT_(conus_save_options)

/** Writes a loaded atlas as it is to one file, whole or not at all. The file is for this machine's kind and this
 * format's builds (docs/formats.md); it has the SHA-256 of each source, and says at its opening which have changed.
 * @param path Ends in ".conus". What is there is replaced.
 * @param atlas The atlas; not one that was opened from a pack.
 * @param options NULL for all defaults.
 * @return #CONUS_OK; #CONUS_ERROR_ARGUMENT for another ending, or an atlas of a pack; #CONUS_ERROR_IO where the file
 * cannot be written, or a source is no longer as it was read. */
CONUS_CHECKED conus_status conus_atlas_save(const char *path, const conus_atlas *atlas,
                                            const conus_save_options *options);
/** @} */

#ifdef __cplusplus
}
#endif

#endif
