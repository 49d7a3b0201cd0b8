/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * The atlas manifest NAME.atlas.json: which files make up one scene (docs/formats.md, "Atlas manifest"). Parsing opens
 * none of them. Strict: what the schema does not know is an error, with the key's path ("pathways[2].threshold"). */
#ifndef CONUS_LOADERS_MANIFEST_MANIFEST_H
#define CONUS_LOADERS_MANIFEST_MANIFEST_H

#include "atlas/labels/labels.h"
#include "atlas/surface/mesh_space.h"
#include "base/job/job.h"

enum {
    MANIFEST_VERSION = 1,
    MANIFEST_FEW = 64,   /**< The most entries of a list whose entries are all compared with each other: parcellations,
                            transforms. */
    MANIFEST_MANY = 4096 /**< Entries of a list of files: pathways, probabilities, streamlines, contexts. */
};

/** One volume of a file. */
struct manifest_volume {
    char *file; /**< As written; NULL if the manifest names none.            */
    bool chosen;
    uint32_t volume;      /**< Which of a 4-D file's, from 0, if chosen.               */
    double resolution[3]; /**< Micrometres along page, row, column of a TIFF stack; 0 = as metadata.json says. */
    char *orientation;    /**< Where the axes of a TIFF stack start; NULL = as metadata.json says. */
};

struct manifest_parcellation {
    struct manifest_volume source;
    char *labels;          /**< NULL: as conus_atlas_load() finds them.                 */
    bool noted;            /**< The notes about the file have been given; only in a made-up manifest. */
    uint32_t label_offset; /**< Added to the labels of its voxels and of its table.     */
    char hemisphere;       /**< The side of areas whose table says none; 0 = unsaid. */
};

/** A transform of points from the space of poses to that of the areas, as --atlas-transform takes it. */
struct manifest_transform {
    char *file;
    char *from; /**< The images of FSL's matrices; NULL otherwise. */
    char *to;
    char *grid;   /**< For fields: a volume with the voxels of the moved areas; NULL = the field's. */
    bool inverse; /**< It moves points of the areas to where poses are. */
    conus_vectors vectors;
    conus_file_space space;
    size_t transform; /**< Place in a list of ITK's transforms: 1 + its number; 0 = none is chosen. */
};

struct manifest_context {
    struct manifest_volume source;
    char *transfer; /**< A preset's name or a file; NULL if none.                */
    bool transfer_is_file;
    bool moves;     /**< It is moved with the areas.                             */
    double blocks;  /**< Threshold from which on it stops rays; 0 if it does not.  */
    double opacity; /**< A surface's; 0 = the default. */
};

/** Surfaces that are areas: one file, the files that match a pattern, or a BrainGlobe folder. */
struct manifest_area {
    char *file;
    char *files;           /**< Pattern: * and ? in the last part of the path.                                      */
    char *brainglobe;      /**< Folder of structures.json and meshes/ID.obj.                                        */
    bool has_label;        /**< file: label.number is given, else the first number in the file's name.              */
    struct label label;    /**< file: what is said about it; files: hemisphere and parent of all.                   */
    char *vertex_labels;   /**< file: labels of its vertices, which cut it into areas; NULL if none.                */
    bool noted;            /**< The notes about the file of labels have been given; only in a made-up manifest. */
    char *labels;          /**< files: table that names them; NULL if none.                                         */
    uint32_t label_offset; /**< files: added to the numbers in their names, or to 1, 2, ... where there are none.   */
    double scale;          /**< brainglobe: mm per unit; 0 = 0.001.                                                 */
    char *orientation;     /**< brainglobe: three letters, where the axes start; NULL = as metadata.json says.      */
    bool all_structures;   /**< brainglobe: not only those that contain no other with a surface.                    */
};

/** The Allen CCF: the world's origin is the corner where AP, DV and ML start. */
enum manifest_ccf {
    MANIFEST_CCF_UNSTATED,
    MANIFEST_CCF_ASR, /**< At the anterior, superior and right sides. */
    MANIFEST_CCF_ASL  /**< At the anterior, superior and left sides.  */
};

/** Whether the surface or the voxels are the area where a label has both. */
enum manifest_preference { MANIFEST_PREFER_NONE, MANIFEST_PREFER_AREAS, MANIFEST_PREFER_PARCELLATION };

/** One pathway or area of probabilities, with `bands` one pathway for each of them, or with `names` or `fsl` one for
 * each volume of a 4-D file. */
struct manifest_pathway {
    struct manifest_volume source;
    char *fsl; /**< An FSL atlas XML that names the volumes of source.file, or of its own finest image.       */
    char *name;
    LIST(char *) names;
    double threshold;       /**< 0 = the manifest's, else the default.                                              */
    double scale;           /**< The probability value that means "certainly"; 0 = as the values say. */
    LIST(conus_band) bands; /**< One pathway for each instead. */
    bool moves;             /**< A pathway: it is moved with the areas. */
};

/** A tractogram: one bundle, or its groups. */
struct manifest_streamlines {
    char *file;
    char *name;    /**< NULL = the file's without its ending. */
    double radius; /**< mm; 0 = the default. */
    bool moves;    /**< It is moved with the areas. */
    conus_file_space space;
};

struct manifest {
    bool allow_outside;                               /**< Paths may leave the manifest's folder. */
    LIST(struct manifest_parcellation) parcellations; /**< By priority. */
    bool single; /**< There is one, which the manifest has as "parcellation", not in a list. */
    LIST(struct manifest_context) contexts; /**< At most one volume, and surfaces. */
    enum mesh_space space; /**< The space of the surfaces' coordinates; unstated = as each file says. */
    conus_brain brain;     /**< Whose the scene is, where poses are; 0 = unsaid. */
    enum manifest_ccf ccf;
    enum manifest_preference prefer;
    LIST(struct manifest_area) areas;
    LIST(struct label) tree;            /**< Parents, and areas without a shape that group others. */
    LIST(struct manifest_pathway) maps; /**< "probabilities", which are areas. */
    LIST(struct manifest_pathway) pathways;
    LIST(struct manifest_streamlines) streamlines;
    double threshold;                           /**< For pathways that give none; 0 = the default. */
    LIST(struct manifest_transform) transforms; /**< Points go through the first one first. */
    bool single_transform;                      /**< There is one, which is not in a list. */
};

/** True where @p text looks like a manifest: a JSON object with the key "conus_atlas". */
bool manifest_is(struct text text);

/** Parses @p text. All that the manifest has is the job's; its lists do not grow. CONUS_ERROR_DATA with the key, or
 * line and column where it is no JSON. */
void manifest_parse(struct job *job, struct manifest *out, struct text text);

/** How many files there are besides surfaces and label tables. Volumes of one file count each: they are unpacked one by
 * one. */
size_t manifest_file_count(const struct manifest *manifest);

#endif
