/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Label tables from files: read, found beside a volume, compared, and named by atlas specifications. */
#ifndef CONUS_LOADERS_LABELS_LABELS_H
#define CONUS_LOADERS_LABELS_LABELS_H

#include "atlas/labels/labels.h"
#include "base/files/file.h"
#include "base/job/job.h"
#include "base/text.h"
#include "conus/atlas.h"

/* Label tables (atlas/labels/labels.h) that a job makes. Table and texts are the job's until the table is moved out
 * of it: `*out = *table; *table = (struct label_table){0};` gives them to who calls label_table_finish(). */

/** An empty table; after a failure one that is none of the job's. */
struct label_table *labels_new(struct job *job);

/** The job finishes @p table when it ends. */
void labels_own(struct job *job, struct label_table *table);

/** As label_table_add(); after a failure a spare entry. */
struct label *labels_add(struct job *job, struct label_table *table, uint32_t number);

/** As label_set_text(). */
void labels_set(struct job *job, char **field, struct text text);

/** As label_table_sort(), with notes of the job. */
void labels_sort(struct job *job, struct label_table *table);

/** Gives all that @p table has to the empty @p out, unless the job has failed. */
void labels_move(struct job *job, struct label_table *out, struct label_table *table);

/** encoding_decode() of @p text into the job's memory. */
void labels_decode(struct job *job, struct text *text);

/** Makes the job's notes @p notes and gives those of before: so a table is read with notes of its own. */
struct notes label_notes_swap(struct job *job, struct notes notes);

/* The purpose for which a label table is read. */

/** Reads the header of the volume @p path: volume_header_read(). */
typedef void label_header_read(struct job *job, conus_volume_info *out, const char *path);

/** Zero: for no volume that is known. */
struct label_use {
    const conus_volume_info *info;     /**< The volume that the table names, or NULL. */
    const struct label_voxels *voxels; /**< Its labels as they were read, i fastest; NULL if not known. */
    label_header_read *header; /**< For the image that an FSL atlas XML counts its voxels in; NULL: it is not read. */
    const char *path;          /**< The table's file, or NULL. */
    struct text columns[2];    /**< A header row's names for number and name; empty: the usual words. */
};

/* A label table from a file. */

/** Takes @p text apart at ",label=COLUMN" and ",name=COLUMN": gives the path; @p columns lie in @p text, empty where
 * none is given. CONUS_ERROR_ARGUMENT. */
const char *label_path_split(struct job *job, struct text columns[2], const char *text);

/** Reads the label table @p path, as label_path_split() takes it apart, into the empty @p out (and, for a table without
 * colours, X.lut beside it). *format is its name in words, static. @p use may be NULL. The job's files get what was
 * read. Outputs are untouched on failure. */
void label_file_read(struct job *job, struct label_table *out, const char **format, const char *path,
                     const struct label_use *use);

/** Bytes that a file may have so that its table takes no more than the job's max_memory. */
uint64_t label_file_limit(const struct job *job);

/** The bytes of a file, at most label_file_limit(). */
struct bytes label_file_bytes(struct job *job, const char *path);

bool label_table_has_colours(const struct label_table *table);

/** Colours @p table from the .lut @p path, which the job's files get; false if it has no colours alone (MRIcron's,
 * FSLeyes's without names) or is not there. */
bool label_file_colours(struct job *job, struct label_table *table, const char *path);

/* The label table of a volume: inside the file, then beside it (docs/formats.md has the order). */

/** A volume whose table is wanted, and what its file says of labels by itself. All of it is borrowed. */
struct label_volume {
    const conus_volume_info *info;
    struct label_table *segments; /**< 3D Slicer's segments, sorted, which are taken out of it; NULL = none. */
    const struct text *texts;     /**< [count] Tables, perhaps, inside the file: the best first. */
    size_t count;
    label_header_read *header;
};

/** Finds the table of @p volume, whose labels are @p voxels (NULL: numbers are not checked): inside the file, then
 * beside it, in the documented order. Tables that contradict each other are CONUS_ERROR_DATA. Fills @p out, which is
 * empty; *source is words for it ("MRIcron text in aal.nii.txt", "none found"). No table is no error: @p out stays
 * empty. The job's files get those that the table is of, other than the volume's. A table that is damaged is an error
 * only if nothing else is found; else a note. */
void label_table_of_volume(struct job *job, struct label_table *out, const char **source,
                           const struct label_volume *volume, const struct label_voxels *voxels);

/* The candidates for a volume's label table: which is used, and whether they contradict each other. */

struct label_search;

/** Says whether @p table, from the file @p path, may be offered; notes why. */
typedef bool label_judge(struct job *job, const struct label_search *search, const struct label_table *table,
                         const char *path);

struct label_search {
    const struct label_volume *volume;
    struct label_use use;
    struct label_table *table; /**< The job's. */
    const char *source;        /**< "MRIcron text in aal.nii.txt", of the table; NULL = none was found. */
    bool proved;               /**< The table's numbers are those of the volume. */
    size_t files;              /**< Files of the job that have nothing to do with the table. */
    label_judge *judge;        /**< Called before a table is offered that only its name connects with the volume: a file
                                  that is no table, or damaged, is passed over. NULL: not called. */
    const char *why;           /**< The error of the first candidate that was damaged: an error only if nothing else is
                                  found. NULL: none. */
};

/** A table that was read, and what was noted on the way. */
struct label_offer {
    struct label_table *table;
    struct notes notes;
    const char *source;
    bool proved;
    const char *path;         /**< The table's file. */
    const struct bytes *file; /**< Its bytes; NULL for a table inside the volume's file. */
};

/** Fails where the table calls 0 an area, does not name all labels of the voxels, and would if each number were one
 * more: it counts from 0, or has another volume's names. Nothing where @p voxels is NULL. */
void label_check_zero(struct job *job, const struct label_table *table, const struct label_voxels *voxels);

/** Uses the table of @p offer if it is the first, or if only its numbers are proved and names have others. One that
 * contradicts the table in use is CONUS_ERROR_DATA, one that differs a note. Finishes the notes of @p offer. */
void label_search_offer(struct job *job, struct label_search *search, struct label_offer *offer);

/** Notes the labels that @p other, from @p other_source, names differently than @p used, from @p source, does; both
 * belong to one volume. Whether there are any. */
bool label_tables_note(struct job *job, const struct label_table *used, const char *source,
                       const struct label_table *other, const char *other_source);

/** Tries @p text, called @p path in messages, which is that of @p file or, where that is NULL, lies in the volume's. */
void label_search_text(struct job *job, struct label_search *search, const char *path, const struct bytes *file,
                       struct text text);

/** Tries the file @p path, if it exists. */
void label_search_file(struct job *job, struct label_search *search, const char *path);

/* The table beside a 4-D file that names its volumes. */

/** Fills the empty @p out with the labels of all volumes of the file in @p use (info), numbered by the
 * volumes from 1, all with names. The names come from the table @p path or, where that is NULL, from the table beside
 * the file. It stays empty, with a note, where no table says for certain which volume each name belongs to. Gives the
 * table's file without its folder, NULL where there is none; the job's files get it. A damaged table that was given is
 * CONUS_ERROR_DATA. */
const char *label_volume_table(struct job *job, struct label_table *out, const char *path, const struct label_use *use);

/** The name that the table beside the volume's file, X.txt or another, gives to the volume, and in *from the table's
 * file without its folder, which the job's files do not get. NULL, both, where there is no such table; or, with a note,
 * where it does not say for certain which volume each name belongs to. A file of one volume has no such table. */
const char *label_volume_name(struct job *job, const char **from, const conus_volume_info *info);

/* The words of a file's name that say which atlas it is. */

enum { LABEL_WORDS = 24 };

/** Words inside a name that someone else owns; a longer name has `overflow`, and can be compared with none. */
struct label_words {
    struct text items[LABEL_WORDS];
    size_t count;
    bool overflow;
};

/** The words of @p stem, a name without ending. It is cut at everything but letters and digits, between letters and
 * digits, and before a capital behind a small letter. Left out are words that any table or volume may have ("atlas",
 * "labels", "dseg"), sides ("lh"), sizes ("2mm") and BIDS's entities space-, res-, den- and tpl-. */
void label_words_find(struct label_words *out, struct text stem);

/** Whether @p all has every word of @p part; upper and lower case are the same. False of overflow. */
bool label_words_contain(const struct label_words *all, const struct label_words *part);

/** Whether both have the same words. */
bool label_words_equal(const struct label_words *a, const struct label_words *b);

/* FSL's atlas specification: one XML that names images (in several resolutions) and their labels. And SPM's, which
 * CAT12 has, too: the same outermost elements, but index and name of a label are elements of their own. */

enum { FSL_ATLAS_LIMIT = 4 << 20 }; /**< Bytes of an atlas XML. */

/** Paths as written: relative to the XML's folder although they begin with '/', and without ending. NULL = none. */
struct fsl_image {
    const char *image;   /**< Type Label: labels; else one volume per label. */
    const char *summary; /**< Type Label: the same; else labels. */
};

/** The x y z of a label: a voxel of the first image. */
struct fsl_point {
    bool given;
    double at[3];
};

struct fsl_atlas {
    const char *type; /**< As written. */
    bool is_label;    /**< Type Label: index should be the voxel value. Else the number of a volume. */
    bool is_spm;      /**< SPM's or CAT12's: index is the voxel value, always. */
    bool proved;      /**< fsl_atlas_number() found the x y z of the labels in the volume. */
    struct fsl_image *images;
    size_t image_count, image_capacity;
    struct label_table labels; /**< By index + 1, as in the file, until fsl_atlas_number(). */
    struct fsl_point *points;  /**< [point_count], of the labels until fsl_atlas_number(). */
    size_t point_count, point_capacity;
};

/** Parses the bytes of an atlas XML. All of it is the job's; after a failure an atlas without anything. */
struct fsl_atlas *fsl_atlas_parse(struct job *job, struct text text);

/** Gives the labels the numbers that they have in a volume of labels, and sorts them: index or index + 1, as their
 * points say if @p use has a volume, else as the type says (docs/formats.md). @p use->path is the XML's. */
void fsl_atlas_number(struct job *job, struct fsl_atlas *atlas, const struct label_use *use);

/* Which atlas XML of FSL or SPM names a volume, and where the images are that an XML names. */

enum fsl_use {
    FSL_LABELS, /**< The volume holds labels: a summary image, or an image of type Label. */
    FSL_VOLUMES /**< It holds one volume per label; volume k is label k + 1.              */
};

/** Called with an atlas XML, its path and its bytes; it may take what the atlas has. */
typedef void fsl_visit(struct job *job, void *user, struct fsl_atlas *atlas, const char *path,
                       const struct bytes *file);

/** Visits every atlas XML, in the folder of @p volume_path and in the one above, that names this volume for that use,
 * by name, those first whose own name the volume's begins with; for FSL_LABELS also SPM's that is called as the volume
 * is and names no other image that is there. One that is damaged is passed over. */
void fsl_atlas_each(struct job *job, const char *volume_path, enum fsl_use use, fsl_visit *visit, void *user);

/** Path of @p image as the FSL atlas @p xml_path writes it: from the XML's folder, mostly without ending; NULL if there
 * is no such file. */
char *fsl_image_find(struct job *job, const char *xml_path, const char *image);

#endif
