/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A volume as a file holds it: header, transform and stored voxels, for all formats alike. What its values mean
 * (labels, a probability, grey) is for the caller to decide. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_FILE_H
#define CONUS_LOADERS_VOLUMES_VOLUME_FILE_H

#include "base/files/file_sums.h"
#include "base/notes.h"
#include "base/text.h"
#include "conus/atlas_info.h"
#include "loaders/volumes/volume_header.h"

/** One NIfTI header extension. */
struct volume_extension {
    int code;
    const uint8_t *data; /**< Without the 8 bytes of esize and ecode; inside volume_file.head. */
    size_t size;
};

struct volume_file {
    conus_volume_info info; /**< role, minimum, maximum and threshold not set; info.path is this->path.       */
    char *path;             /**< File of the voxels, or a text header; without ",volume=K". */
    struct bytes head;      /**< Everything before the voxels, unpacked: header, extensions, gap.             */
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
    struct file_sums read; /**< The files that give its place: metadata.json of a TIFF stack. */
};

/** Reads @p path (NIfTI-1/2 single file or either half of a pair, MGH, and the formats of volume_text.h; each plain or
 * gzip, detected from the content; TIFF stacks), which may end in ",volume=K" with K from 0, and of TIFF in
 * ",resolution=R,orientation=ABC". Without it a 4-D file of more than one volume is an error that names the choice.
 * Facts that a careful user should know (a qform used because there is no sform, a second transform that differs) goes
 * into
 * @p notes. Errors carry path, field, value found and what is allowed. */
conus_status volume_file_open(struct volume_file *out, const char *path, uint64_t max_memory, struct notes *notes);

/** Likewise, but without voxels: out->path is NULL, and there is no SHA-256. */
conus_status volume_file_grid(conus_volume_info *out, const char *path, uint64_t max_memory, struct notes *notes);

struct label_voxels;

/** Reads the labels of the volume @p path into @p labels; @p out gets the rest, without voxels. Uses max_memory of
 * @p options. @p opened, unless NULL, is @p path, open. @p needed says in words which files are allowed here,
 * for messages. Large volumes are read slab by slab, so that their voxels are never in memory together, if the file is
 * a plain NIfTI or MGH file, or packed with voxels of more than 2 bytes. A volume with values that are no labels is
 * CONUS_ERROR_DATA, as in volume_file_labels(). */
conus_status volume_file_open_labels(struct volume_file *out, struct label_voxels *labels, const char *path,
                                     const struct open_file *opened, const conus_load_options *options,
                                     const char *needed, struct notes *notes);

/** Reads only the header of @p path: dimensions, transform, datatype; out->path is NULL. */
conus_status volume_file_header(conus_volume_info *out, const char *path);

/** The same, from @p start: the first 64 KiB of @p path, or all of it. */
conus_status volume_bytes_header(conus_volume_info *out, const char *path, const struct bytes *start);

/** The same, from the file. @p head, which the caller finishes, gets the unpacked bytes before the voxels of a single
 * file (extensions and text), as far as the file's first 64 KiB hold them. */
conus_status volume_file_peek(struct volume_header *out, struct bytes *head, const char *path);

/** Reads volume 0 of @p path, whatever it chooses; volume_file_select() gives the others. All volumes are unpacked
 * together and kept, unless that takes more than max_memory of @p options. Then each is read when it is selected. */
conus_status volume_file_open_series(struct volume_file *out, const char *path, const conus_load_options *options,
                                     struct notes *notes);

/** Makes @p volume, from 0, the chosen one, as if the file had been opened with it. A failure leaves @p file as it was;
 * a volume that is not there is CONUS_ERROR_ARGUMENT. */
conus_status volume_file_select(struct volume_file *file, size_t volume);
void volume_file_finish(struct volume_file *file);

#endif
