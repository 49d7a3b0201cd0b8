/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What the name of a file says: its ending, and the keys behind it. Programs have it beside the library. */
#ifndef CONUS_SOURCES_NAMES_H
#define CONUS_SOURCES_NAMES_H

#include "base/text.h"

#include <stdbool.h>
#include <stddef.h>

/* The endings of names: what a file may be given as, by its name alone. What it is its first bytes say (source.h). */

/** What a file is given as. The same bytes may be another thing in each. */
enum role {
    ROLE_VOLUME = 1 << 0,
    ROLE_SURFACE = 1 << 1,
    ROLE_VERTEX_LABELS = 1 << 2, /**< Also surfaces, which may have none. */
    ROLE_TRACTS = 1 << 3,
    ROLE_TRANSFORM = 1 << 4,
    ROLE_SCENE = 1 << 5,  /**< An atlas that names other files, or has several parts. */
    ROLE_REGION = 1 << 6, /**< A mesh as a region of interest. */
    ROLE_POSES = 1 << 7,  /**< Of formats without tables and lists, whose readers tell themselves apart. A row without
                             the word of one says why such a file holds none. */
    ROLES_ATLAS = ROLE_VOLUME | ROLE_SURFACE | ROLE_VERTEX_LABELS | ROLE_SCENE
};

/** The formats of volumes: ROW(ID, NAME, ENDINGS) is FORMAT_ID (source.h), whose bytes rows of rows.c know, and
 * NAME_reader of loaders/volumes/. In the order in which folders are searched. */
#define VOLUME_FORMATS(ROW, ENDING)                                                                                    \
    ROW(NIFTI, nifti, ENDING(".nii"))                                                                                  \
    ROW(IMG, nifti_image, ENDING(".hdr") ENDING(".img")) /* the voxels of a pair of NIfTI */                           \
    ROW(MGH, mgh, ENDING(".mgz") ENDING(".mgh"))                                                                       \
    ROW(NRRD, nrrd, ENDING(".seg.nrrd") ENDING(".nrrd") ENDING(".nhdr"))                                               \
    ROW(METAIMAGE, metaimage, ENDING(".mha") ENDING(".mhd"))                                                           \
    ROW(AFNI, afni, ENDING(".HEAD"))                                                                                   \
    ROW(BRIK, afni_brik, ENDING(".BRIK")) /* the voxels of AFNI, which were named instead */                           \
    ROW(TIFF, tiff, ENDING(".tiff") ENDING(".tif"))                                                                    \
    ROW(ZARR, zarr, )                                                                                                  \
    ROW(HDF5, minc, ) /* MINC 2, transforms of ITK and X5, SimNIBS, NWB */
/** Those in messages. */
#define VOLUME_NAMES "NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC"

/** Length of the longest ending of the first @p length bytes of @p name that a file of one of @p roles may have, ".gz"
 * behind it with it; 0 = it has none. Case does not count, and something stands before it. */
size_t ending_length(const char *name, size_t length, unsigned roles);

/** Length of these bytes without that ending, or without ".gz" where there is none. */
size_t stem_length(const char *name, size_t length, unsigned roles);

/** Length of @p path without the ending of a volume (.nii.gz, .mgz, ...), if it has one. */
size_t volume_stem_length(const char *path);

/** The ending behind @p ending, one of @p roles, in the order in which folders are searched; the first behind NULL.
 * NULL behind the last. Each may have ".gz" behind it. */
const char *ending_next(const char *ending, unsigned roles);

/* FILE,key=value,...: the table of keys, and what takes such a text apart.
 *
 * A file of that very name has no keys. Else known keys are cut off from the end; what is no key and stands behind one
 * is refused. Where FILE and "FILE,key=value" are both there, the text is refused, since it may mean either. Folders
 * that are there may be called anything: keys begin behind them. Behind space=IMAGE stand the keys of the image. */

/** What has keys. A row of the table holds for some of them. */
enum key_kind {
    KEYS_VOLUME = 1 << 0,   /**< A volume, or a mesh as a region. */
    KEYS_SCENE = 1 << 1,    /**< A file of an atlas: */
    KEYS_ATLAS = 1 << 2,    /**< with whose brain it is. */
    KEYS_VERTICES = 1 << 3, /**< Labels of vertices. */
    KEYS_LABELS = 1 << 4,   /**< A label table. */
    KEYS_PATHWAY = 1 << 5,
    KEYS_STREAMLINES = 1 << 6,
    KEYS_TRANSFORM = 1 << 7,
    KEYS_MAP = 1 << 8,        /**< Values of vertices that a context shows. */
    KEYS_POSES = 1 << 9,      /**< A table of poses. */
    KEYS_ENTRIES = 1 << 10,   /**< From where poses are tried, */
    KEYS_TARGETS = 1 << 11,   /**< and to where. */
    KEYS_CLEARANCE = 1 << 12, /**< From here on files that are written: what is there is not looked at. */
    KEYS_PROFILE = 1 << 13,
    KEYS_VERTEX_MAP = 1 << 14,
    KEYS_REACH = 1 << 15, /**< And names of structures, or FILE,MM. */
    KEYS_AVOID = 1 << 16,
    KEYS_APART = 1 << 17,
    KEYS_FIRST = 1 << 18,
    KEYS_WEIGHT = 1 << 19, /**< A form of weights, or a table of them; */
    KEYS_PRIOR = 1 << 20,  /**< of priors. */
    KEYS_SCALP = 1 << 21,  /**< A scalp with its landmarks. */
    KEYS_ARCS = 1 << 22,   /**< Degrees between the arcs of a rig. */
    KEYS_ANGLES = 1 << 23, /**< Its angles, from which poses are tried. */
    KEYS_COVER = 1 << 24,  /**< Names of structures that contacts are in. */
};

enum source_key_id {
    KEY_FIELD, /**< These in the order in which a refusal names one. */
    KEY_TISSUE,
    KEY_LEVEL,
    KEY_ORIENTATION,
    KEY_RESOLUTION,
    KEY_VOLUME,
    KEY_MAP,
    KEY_TEMPLATE,
    KEY_SPACE,
    KEY_LABEL,
    KEY_NAME,
    KEY_THRESHOLD,
    KEY_UNIT,
    KEY_BAND,
    KEY_RADIUS,
    KEY_MOVES,
    KEY_FROM,
    KEY_TO,
    KEY_INVERSE,
    KEY_RELATIVE,
    KEY_ABSOLUTE,
    KEY_GRID,
    KEY_TRANSFORM,
    KEY_ARRAY,
    KEY_RANGE,
    KEY_X,
    KEY_Y,
    KEY_Z,
    KEY_SIDES,
    KEY_PLACE,
    KEY_TILT_ML,
    KEY_TILT_AP,
    KEY_DEPTH,
    KEY_SPACING,
    KEY_WITHIN,
    KEY_WITHOUT,
    KEY_FLIP,
    KEY_OF,
    KEY_STEP,
    KEY_FILL,
    KEY_LENGTH,
    KEY_TIP,
    KEY_CROSSED,
    KEY_PART,
    KEY_CONTACTS,
    KEY_PROBABILITY,
    KEY_SHARE,
    KEY_PIERCED,
    KEY_FRACTION,
    KEY_STREAMLINES,
    KEY_MARGIN,
    KEY_SHANK,
    KEY_BIAS,
    KEY_NASION, /**< These four in this order. */
    KEY_INION,
    KEY_LPA,
    KEY_RPA,

    KEY_ABOVE,
    KEY_POWER,

    KEY_SLIDER, /**< These two in this order, and the next two. */
    KEY_SAME,
    KEY_MOST,
    KEY_EACH,
};

#define KEY_BIT(id) (UINT64_C(1) << (id))

enum { KEY_NUMBERS = 16, KEYS_MOST = 128, KEYS_WHY = 1024 };

struct source_key;

struct key_value {
    const struct source_key *row;
    enum source_key_id id;
    struct text text;            /**< In the text that was taken apart. */
    double numbers[KEY_NUMBERS]; /**< What it says, where the table says that these are numbers. */
    size_t count;
};

/** All 0: no key is given. */
struct source_keys {
    const char *path; /**< The file, of source_keys_read(). */
    size_t length;    /**< Of the file in the text. */
    uint64_t given;   /**< KEY_BIT() of each. */
    size_t count;
    struct key_value values[KEYS_MOST]; /**< As they were given. */
    char why[KEYS_WHY];                 /**< What is wrong, without the text; "" = nothing. */
};

/** Takes @p text apart; false where it is refused, keys.why says why. */
bool keys_read(struct source_keys *out, const char *text, enum key_kind kind);

/** Likewise, and ends each part in @p text with a NUL: it is FILE then, and values are strings. It stays as it was
 * where it is refused. */
bool keys_cut(struct source_keys *out, char *text, enum key_kind kind);

/** The value of keys_cut(); NULL where it is not given. */
const char *keys_string(const struct source_keys *keys, enum source_key_id id);

/** The same of @p words without a file: "key=value,key=value". */
bool keys_read_alone(struct source_keys *out, const char *words, enum key_kind kind);

/** Length of the file in @p text, whatever its keys say, and where they are none. */
size_t keys_file_length(const char *text, enum key_kind kind);

/** The first value of a key; where it is not given, one whose text is empty. */
const struct key_value *keys_value(const struct source_keys *keys, enum source_key_id id);

const char *keys_name(const struct key_value *value);

/** Whether it is the path of an image, which may have keys of its own behind it. */
bool keys_is_image(const struct key_value *value);

/** What a message says is allowed for it. */
const char *keys_allowed(const struct key_value *value);

/** Writes FILE of @p text, and behind it those of its @p keys that hold for one of @p kinds, too; none of them is a
 * flag. @p out has room for strlen(text) + 1 bytes. */
void keys_keep(char *out, const char *text, const struct source_keys *keys, unsigned kinds);

/** False where a key is given that is not among @p allowed (KEY_BIT()); @p why says it. */
bool keys_fit(char why[KEYS_WHY], const struct source_keys *keys, uint64_t allowed);

#endif
