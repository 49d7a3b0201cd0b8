/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A volume as a file holds it: header, transform and stored voxels, for all formats alike. What its values mean
 * (labels, a probability, grey) is for the caller to decide. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_FILE_H
#define CONUS_LOADERS_VOLUMES_VOLUME_FILE_H

#include "base/files/file_sums.h"
#include "base/notes.h"
#include "base/text.h"
#include "loaders/volumes/volume_header.h"

/** One NIfTI header extension. */
struct volume_extension {
    int code;
    const uint8_t *data; /**< Without the 8 bytes of esize and ecode; inside volume_file.head. */
    size_t size;
};

struct volume_file {
    conus_volume_info info; /**< role, minimum, maximum and threshold not set; info.path is this->path.       */
    char *path;             /**< Of the voxels, or of a header of text, without ",volume=K".                  */
    struct bytes head;      /**< Everything before the voxels, unpacked: header, extensions, gap.             */
    struct bytes voxels;    /**< The chosen volume's voxels, stored form, unpacked, i fastest.                */
    int datatype;           /**< NIfTI datatype code (DT_UINT8 = 2, ...), for MGH translated.                 */
    bool swapped;           /**< Stored in the other byte order than this machine's.                         */
    struct volume_extension *extensions;
    size_t extension_count;
    struct text embedded; /**< Between the last extension (or header) and the voxels, NULs at both ends left out. */
    int intent_code;      /**< NIfTI intent, 0 if none.                                                    */
    struct bytes series;  /**< The voxels of all volumes, in which `voxels` lies; empty where only those are kept. */
    struct text_volume *text; /**< Of a format whose header is text: names, scales; else NULL, of which        */
    const char *title;        /**< ... the chosen volume's name; NULL if it has none.                          */
    uint64_t max_memory;
    bool cache;            /**< Whether volumes that are read later may use and make an index. */
    struct file_sums read; /**< What its place follows from: metadata.json of a TIFF stack. */
};

/** Reads @p path (NIfTI-1/2 single file or either half of a pair, MGH, and the formats of volume_text.h; each plain or
 * gzip, detected from the content; TIFF stacks), which may end in ",volume=K" with K from 0, and of TIFF in
 * ",resolution=R,orientation=ABC". Without it a 4-D file of more than one volume is an error that names the choice.
 * What a careful user should know (a qform used because there is no sform, a second transform that differs) goes into
 * @p notes. Errors carry path, field, value found and what is allowed. */
conus_status volume_file_open(struct volume_file *out, const char *path, uint64_t max_memory, struct notes *notes);

/** The same. If @p cache, one of many volumes of a packed file is found by an index of it in the user's cache folder,
 * which is put there when there is none. */
conus_status volume_file_open_cached(struct volume_file *out, const char *path, uint64_t max_memory, bool cache,
                                     struct notes *notes);

struct label_voxels;

/** Likewise, by max_memory and cache of @p options, of @p path, which @p opened is where it is not NULL, where other
 * files than volumes would do as well, as @p needed says in words; gives its labels, whose places in @p labels take the
 * place of its voxels: @p out has none. Those of a NIfTI or MGH file that is not packed, and packed ones of more than 2
 * bytes, never lie in memory together if they are many. A volume with other values than labels is CONUS_ERROR_DATA, as
 * of volume_file_labels(). */
conus_status volume_file_open_labels(struct volume_file *out, struct label_voxels *labels, const char *path,
                                     const struct open_file *opened, const conus_load_options *options,
                                     const char *needed, struct notes *notes);

/** Reads only the header of @p path: dimensions, transform, datatype; out->path is NULL. */
conus_status volume_file_header(conus_volume_info *out, const char *path);

/** The same of @p start, the first 64 KiB of @p path, or all. */
conus_status volume_bytes_header(conus_volume_info *out, const char *path, const struct bytes *start);

/** The same of the file, and gives in @p head, the caller's to finish, what stands before the voxels of a single file,
 * unpacked, as far as the file's first 64 KiB hold it: extensions and text. */
conus_status volume_file_peek(struct volume_header *out, struct bytes *head, const char *path);

/** Reads @p path as above, but takes it whole for a name: volume 0, and the others for volume_file_select(). They are
 * unpacked together and kept, unless that takes more than max_memory of @p options: then each is read when selected,
 * with its cache by an index. */
conus_status volume_file_open_series(struct volume_file *out, const char *path, const conus_load_options *options,
                                     struct notes *notes);

/** Makes @p volume, from 0, the chosen one, as if the file had been opened with it. A failure leaves @p file as it was;
 * a volume that is not there is CONUS_ERROR_ARGUMENT. */
conus_status volume_file_select(struct volume_file *file, size_t volume);
void volume_file_finish(struct volume_file *file);

#endif
