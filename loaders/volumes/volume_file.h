/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A volume as a file holds it: header, transform and stored voxels, for all formats alike. What its values mean
 * (labels, a probability, grey) is for the caller to decide. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_FILE_H
#define CONUS_LOADERS_VOLUMES_VOLUME_FILE_H

#include "loaders/volumes/volume_input.h"

struct volume_file {
    conus_volume_info info; /**< role, minimum, maximum and threshold not set; info.path is this->path.       */
    char *path;             /**< File of the voxels, or a text header; without ",volume=K". */
    struct bytes voxels;    /**< The chosen volume's voxels, stored form, unpacked, i fastest.                */
    int datatype;           /**< NIfTI datatype code (DT_UINT8 = 2, ...), for MGH translated.                 */
    bool swapped;           /**< Stored in the other byte order than this machine's.                         */
    double label_slack;     /**< How far from a whole number a label may be: of MINC, where scales make them. */
    struct volume_extension *extensions;
    size_t extension_count;
    struct text embedded; /**< Between the last extension (or header) and the voxels, NULs at both ends left out. */
    int intent_code;      /**< NIfTI intent, 0 if none.                                                    */
    struct bytes series;  /**< The voxels of all volumes, in which `voxels` lies; empty where only those are kept. */
    struct text_volume *text; /**< Names and scales from a text header; else NULL. */
    const char *title;        /**< The chosen volume's name in `text`; NULL if it has none. */
    uint64_t max_memory;
    struct file_sums read;        /**< The files that give its place: metadata.json of a TIFF stack. */
    struct volume_opened *opened; /**< What it is read from, which has all that it points to but the voxels; NULL: an
                                     array, which has its path. */
};

/** Reads @p path (NIfTI-1/2 single file or either half of a pair, MGH, NRRD, MetaImage, AFNI; each plain or gzip,
 * detected from the content; TIFF stacks, MINC, OME-Zarr), which may end in ",volume=K" with K from 0, and of TIFF in
 * ",resolution=R,orientation=ABC". Without it a 4-D file of more than one volume is an error that names the choice.
 * Facts that a careful user should know (a qform used because there is no sform, a second transform that differs) are
 * notes, behind the path. Errors carry path, field, value found and what is allowed. @p out is the caller's to finish,
 * and as it was after a failure. */
void volume_load(struct job *job, struct volume_file *out, const char *path, uint64_t max_memory);

/** The same without voxels, on a job, whose notes do not name the path: what is refused of a volume is refused here,
 * too. out->path is NULL, and there is no SHA-256. */
void volume_grid_read(struct job *job, conus_volume_info *out, const char *path);

/** Reads only the header of @p path, without notes: dimensions, transform, datatype. Other files are not looked for,
 * and no volume needs to be chosen. out->path is NULL. */
void volume_header_read(struct job *job, conus_volume_info *out, const char *path);

struct label_voxels;

/** Reads the labels of the volume @p path into @p labels; @p out gets the rest, without voxels. Uses max_memory of
 * @p options. @p opened, unless NULL, is @p path, open. @p needed says in words which files are allowed here,
 * for messages. Large volumes are read in pieces, so that their voxels are never in memory together, if the file is
 * a plain NIfTI or MGH file, or packed with voxels of more than 2 bytes, or of a format of pieces. A volume with values
 * that are no labels is CONUS_ERROR_DATA, as in volume_labels(). */
void volume_load_labels(struct job *job, struct volume_file *out, struct label_voxels *labels, const char *path,
                        const struct source *opened, const conus_load_options *options, const char *needed);

/** Reads volume 0 of @p path, whatever it chooses; volume_select() gives the others. All volumes are unpacked together
 * and kept, unless that takes more than @p max_memory. Then each is read when it is selected. */
void volume_load_series(struct job *job, struct volume_file *out, const char *path, uint64_t max_memory);

/** Makes @p volume, from 0, the chosen one, as if the file had been opened with it. A failure leaves @p file as it was;
 * a volume that is not there is CONUS_ERROR_ARGUMENT. */
void volume_select(struct job *job, struct volume_file *file, size_t volume);

void volume_file_finish(struct volume_file *file);

#endif
