/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Volumes in files: headers, how voxels are read, what they mean as labels or numbers, and NIfTI that is
 * written. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUMES_H
#define CONUS_LOADERS_VOLUMES_VOLUMES_H

#include "atlas/labels/labels.h"
#include "atlas/space.h"
#include "atlas/volume.h"
#include "base/job/job.h"
#include "conus/atlas.h"
#include "conus/own.h"
#include "loaders/brainglobe/brainglobe.h"
#include "loaders/labels/labels.h"
#include "loaders/zarr/zarr.h"
#include "sources/source.h"

#include <nettle/sha2.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The header of a volume of any format, with NIfTI's datatypes. */

/** NIfTI datatype codes. */
enum volume_datatype {
    VOLUME_UINT8 = 2,
    VOLUME_INT16 = 4,
    VOLUME_INT32 = 8,
    VOLUME_FLOAT32 = 16,
    VOLUME_FLOAT64 = 64,
    VOLUME_INT8 = 256,
    VOLUME_UINT16 = 512,
    VOLUME_UINT32 = 768,
    VOLUME_INT64 = 1024,
    VOLUME_UINT64 = 1280
};

struct volume_header {
    conus_volume_info info; /**< format ("NIfTI-1"), datatype, dim, volume_count, slope, intercept and transform.  */
    int datatype;
    bool swapped;
    bool pair;          /**< The voxels lie in another file.                                                  */
    size_t header_size; /**< Bytes of the fixed part: 348, 540, 284.                                          */
    uint64_t offset;    /**< Bytes before the first volume in the file of the voxels. */
    size_t volume_size; /**< Bytes of one volume.                                                             */
    int intent_code;
    bool has_unit;      /**< The file states the unit of its grid. */
    double label_slack; /**< How far from a whole number a label may be. */
};

/** What every grid passes, whatever its format: the Allen Institute's in micrometres is placed where it is meant, one
 * of more than a metre gets a warning, and one row of as many voxels as a cortex has vertices is refused. */
void volume_header_settle(struct job *job, struct volume_header *header);

/** Bytes of a voxel of the NIfTI type @p code, 0 for a type that conus does not read. */
size_t volume_datatype_size(int code);

/** Its name, "uint8"; NULL for a code that no standard knows. */
const char *volume_datatype_name(int code);

/** The code of a type: @p kind 'u' unsigned, 'i' signed, 'f' floating point, of @p size bytes; 0 if there is none. */
int volume_datatype_of(char kind, size_t size);

/** Sets datatype and info.datatype. A type without one real number per voxel is CONUS_ERROR_UNSUPPORTED, a code that no
 * standard knows CONUS_ERROR_DATA. */
void volume_header_set_datatype(struct job *job, struct volume_header *header, int code);

/** Sets info.dim, info.volume_count and volume_size from @p dim[0..6], all at least 1; datatype must be set. Checks
 * that the bytes up to the last voxel can be counted. */
void volume_header_set_dim(struct job *job, struct volume_header *header, const int64_t dim[7]);

/* A volume in a file or folder: its header, and how its voxels are read. A format fills this in; what is done with
 * the voxels is decided in volume_input.c alone. */

struct text_volume;
struct volume_input;

/** Where voxels go, as they are stored: @p count of them, the first of which is number @p first of those asked for. */
struct voxel_sink {
    void (*take)(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count);
    void *user;
};

/** Voxels that lie in a file one after the other, all volumes. */
struct voxel_run {
    uint64_t begin; /**< Stored bytes before the run. */
    uint64_t skip;  /**< Bytes before the first voxel, unpacked. */
    enum { RUN_PLAIN, RUN_GZIP, RUN_ZLIB } packing;
    uint64_t packed_size; /**< Stored bytes of the run; 0: to the end of the file. */
    bool has_footer;      /**< Bytes behind the voxels are the format's. */
};

/** One NIfTI header extension. */
struct volume_extension {
    int code;
    const uint8_t *data; /**< Without the 8 bytes of esize and ecode. */
    size_t size;
};

/** A format. */
struct volume_reader {
    uint64_t keys;   /**< KEY_BIT() of those it takes besides volume. */
    bool is_whole;   /**< Its header takes more than the first bytes of the file. */
    bool is_partial; /**< A large file that is not packed is read in pieces, however large it is. */
    /** Reads the header, and sets v->run or v->read. Other files are opened only if v->is_header_only is not set. */
    void (*open)(struct job *job, struct volume_input *v);
    /** Takes texts that may name labels, once the volume is chosen; NULL: open() has. */
    void (*around)(struct job *job, struct volume_input *v);
};
#define VOLUME_READER(id, name, endings) extern const struct volume_reader name##_reader;
VOLUME_FORMATS(VOLUME_READER, )

struct volume_input {
    enum format_id format;              /**< FORMAT_OTHER: of none, */
    const struct volume_reader *reader; /**< then NULL. */
    struct source_keys keys;            /**< Whose path is the one that was given. */
    struct brainglobe_metadata place;   /**< resolution and orientation, as far as they are given. */
    const struct source *source;        /**< Of that path; NULL: a folder. */
    const struct source *other;         /**< The other half that has the header; NULL: `source` has. */
    const struct source *voxels;        /**< The file of the voxels. */
    const char *path;                   /**< The volume's in results: that of the voxels, or of a header of text. */
    struct volume_header header;        /**< info.sha256 is set once the voxels were read. */
    struct voxel_run run;
    uint64_t scratch;     /**< Bytes that reading takes beyond the voxels that are wanted. */
    const char *encoding; /**< ", gzip": how the voxels are stored; "" = as they are. */
    const char *needed;   /**< Words for what may stand here. */
    bool is_header_only;
    /** Gives the voxels of @p count volumes from @p first on; NULL: they are the run. */
    void (*read)(struct job *job, struct volume_input *v, size_t first, size_t count, const struct voxel_sink *sink);
    bool gives_slabs; /**< read() holds no more than a piece of them. */
    struct sha256_ctx sum;

    struct volume_extension *extensions;
    size_t extension_count;
    struct text embedded;     /**< Text in the file that may be a label table. */
    struct text_volume *text; /**< Names and scales of a header of text; else NULL. */
    void *own;                /**< The format's. */
};

struct volume_wish {
    const char *needed;          /**< Words for what may stand here; NULL: a volume. */
    const struct source *source; /**< The file, if it is open already; else NULL. It outlives the volume. */
    bool is_header_only;
    const struct brainglobe_metadata *place; /**< As keys would state it; NULL: they do. */
    bool is_peek; /**< A format whose header is not among the first bytes of the file is refused. */
};

/** Opens @p given, FILE,key=value,..., and reads its header. NULL after a failure. Bytes in memory are at most
 * job->max_memory. */
struct volume_input *volume_open(struct job *job, const char *given, const struct volume_wish *wish);

/** Fails where the keys choose a volume that the file does not have. */
void volume_number_check(struct job *job, const struct volume_input *v);

/** Checks the volume that the keys choose, or of a @p series the first, and that job->max_memory allows what is held:
 * all of it if @p is_held. Then takes what is around the voxels. */
void volume_choose(struct job *job, struct volume_input *v, bool is_series, bool is_held);

/** Whether all volumes of a series may be held together. */
bool volume_fits_series(const struct job *job, const struct volume_input *v);

/* A volume as a file holds it: header, transform and stored voxels, for all formats alike. What its values mean
 * (labels, a probability, grey) is for the caller to decide. */

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

/* The voxels of a volume as labels or as numbers. */

/** Decodes to labels. Refuses scaled values that are not whole (tolerance_whole()), or outside 0..4294967295, naming
 * the first such voxel. @p out is the caller's to finish, and empty after a failure. Sets info.minimum and maximum. */
void volume_labels(struct job *job, struct label_voxels *out, struct volume_file *file);

/** The same in the memory of the file's voxels, where one of them has at least 2 bytes: a second copy is never there.
 * @p file has no voxels afterwards, also after a failure. */
void volume_take_labels(struct job *job, struct label_voxels *out, struct volume_file *file);

/** Decodes labels that come in pieces. */
struct label_reader {
    const struct volume_file *file; /**< Its info, datatype, byte order and max_memory, but no voxels; borrowed. */
    struct label_coder coder;
    bool is_bad; /**< A voxel is no label: the first such is kept. */
    size_t bad_voxel;
    uint8_t bad_bytes[8];
};

/** The places go to @p memory, taken over also on failure, or where its data is NULL to memory of their own; see
 * label_coder_init(). */
void label_reader_begin(struct job *job, struct label_reader *reader, const struct volume_file *file,
                        const struct bytes *memory);

/** The take of a voxel_sink, whose user is the reader: voxels in any order, where there was no memory. */
void label_reader_take(struct job *job, void *user, size_t first, const uint8_t *voxels, size_t count);

/** Gives the labels of all voxels, and @p file their range. A voxel that is no label is CONUS_ERROR_DATA, as in
 * volume_labels(). */
void label_reader_end(struct job *job, struct label_voxels *out, struct label_reader *reader, struct volume_file *file);
void label_reader_finish(struct label_reader *reader);

/** Decodes to scaled values. Values that are not finite become 0, and a note counts them. They are the caller's to
 * memory_free(); NULL after a failure. Otherwise as volume_labels(). */
float *volume_values(struct job *job, struct volume_file *file);

/** The same, but that these become NaN, which minimum and maximum disregard. CONUS_ERROR_DATA where all are. */
float *volume_values_or_nan(struct job *job, struct volume_file *file);

/** The values as a sparse map, without all values in between. @p out is the caller's to finish, and empty after a
 * failure. */
void volume_map(struct job *job, struct value_map *out, struct volume_file *file);

/** The same of volume_values_or_nan(). */
void volume_map_or_nan(struct job *job, struct value_map *out, struct volume_file *file);

/** The stored number at @p data, of the NIfTI type @p datatype, unscaled; rounded where it has more than 53 bits. */
double volume_value_at(const uint8_t *data, int datatype, bool swapped);

/* The label table of a volume: inside its file or beside it. */

/** label_table_of_volume() of the volume in @p file. Gives the words for where it comes from. */
const char *volume_label_table(struct job *job, struct label_table *out, const struct volume_file *file,
                               const struct label_voxels *voxels);

/* Whether the whole numbers of a volume are labels, or an image's grey values. docs/formats.md has the rule and how
 * it was measured. */

/** Other evidence that the numbers are labels. */
struct grey_claims {
    const struct label_table *table; /**< Sorted; NULL or empty: none.                             */
    bool stated;                     /**< The volume's name, or its own FSL atlas XML, says so. */
};

struct grey_result {
    bool grey;
    bool telling;  /**< There are voxels and values enough to tell; else grey is false.                 */
    double equal;  /**< Share of equal ones among neighbours that are neither 0 nor a plateau. */
    double needed; /**< Share that labels have at least; set where it had to be worked out, else 0.     */
};

/** Judges @p labels, i fastest; not grey after a failure. In an image most neighbours differ, and by less than voxels
 * far apart; areas are pieces, whose voxels have equal neighbours. */
struct grey_result grey_judge(struct job *job, const struct label_voxels *labels, const size_t dim[3],
                              const struct grey_claims *claims);

/** The same of the chosen volume of @p file. That is not grey where its intent code says labels, and is stated to be
 * labels where its name ends in "_dseg", as BIDS has it, or @p stated. @p table may be NULL. */
struct grey_result grey_judge_file(struct job *job, const struct volume_file *file, const struct label_voxels *labels,
                                   const struct label_table *table, bool stated);

/* NIfTI-1 and NIfTI-2 headers (nifti1.h, nifti2.h of the NIfTI Data Format Working Group). Strict: what the standard
 * does not allow is an error that names the field, because a silently repaired header moves or drops areas. */

/** Reads the fixed part of the header of a CIFTI-2 file, which has no grid and no place: @p shape becomes dim[5] and
 * dim[6], the faster index first, info.volume_count their product. */
void nifti_matrix_read(struct job *job, struct volume_header *out, size_t shape[2], const uint8_t *data, size_t size);

/** Lists the *count extensions in @p head, which holds everything before the voxels, and gives where the last one ends.
 * Broken ones are an error: labels would vanish with them. */
size_t nifti_extensions_read(struct job *job, struct volume_extension **out, size_t *count, struct text head,
                             const struct volume_header *header);

/* A folder of OME-Zarr as a volume: which array of it is meant, and where that lies. */

/** The member own of a volume_input whose reader is zarr_reader. */
struct volume_zarr {
    const char *folder; /**< Of the array. */
    struct zarr_array array;
    char orientation[4]; /**< Where OME's metadata say that its axes start, "asr"; empty = they do not. */
};

/* Volumes as NIfTI-1 (nifti1.h, https://nifti.nimh.nih.gov/nifti-1). */

/** Writes @p labels (one per voxel of @p info, i fastest) as a little-endian single file in the narrowest of uint8,
 * uint16 and uint32 that holds them all, intent "label". dim and world_from_voxel of @p info are used: the sform
 * always, with code @p code; the qform too where the matrix has no shear. Same input, same bytes: no time stamps.
 * The file is the job's; empty after a failure. CONUS_ERROR_ARGUMENT for a grid that NIfTI-1 cannot hold (1 to 32767
 * voxels an edge) or a matrix that is not finite as float. */
struct bytes nifti_format_labels(struct job *job, const conus_volume_info *info, const uint32_t *labels, int code);

/** The same without intent, for values that are no labels. */
struct bytes nifti_format_values(struct job *job, const conus_volume_info *info, const uint32_t *values, int code);

/** Writes maps of sites that are voxels of @p grid as float32: a volume for each along the fourth axis, NaN in all
 * other voxels. A comment behind the header (ecode 6) has their names, one a line. @p voxels, [site_count], has the
 * voxels of the values of @p maps, [count]. Otherwise the same. */
struct bytes nifti_format_maps(struct job *job, const conus_grid_view *grid, const conus_vertex_map *maps, size_t count,
                               const uint64_t *voxels, size_t site_count);

/** Writes a file, packed where its name ends in .gz. */
void nifti_write(struct job *job, const char *path, const struct bytes *file);

/** Whether a name ends in .nii or .nii.gz. */
bool nifti_is_name(const char *path);

/** Packs as one gzip member without name or time, into the job's memory. */
struct bytes gzip_format(struct job *job, const void *data, size_t size);

#endif
