/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
 * A volume in a file or folder: its header, and how its voxels are read. A format fills this in; what is done with the
 * voxels is decided in volume_input.c alone. */
#ifndef CONUS_LOADERS_VOLUMES_VOLUME_INPUT_H
#define CONUS_LOADERS_VOLUMES_VOLUME_INPUT_H

#include "loaders/brainglobe/brainglobe_metadata.h"
#include "loaders/volumes/volume_header.h"
#include "sources/source.h"

#include <nettle/sha2.h>

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
    enum format_id id;
    uint64_t keys;   /**< KEY_BIT() of those it takes besides volume. */
    bool is_whole;   /**< Its header takes more than the first bytes of the file. */
    bool is_partial; /**< A large file that is not packed is read in pieces, however large it is. */
    /** Reads the header, and sets v->run or v->read. Other files are opened only if v->is_header_only is not set. */
    void (*open)(struct job *job, struct volume_input *v);
    /** Takes texts that may name labels, once the volume is chosen; NULL: open() has. */
    void (*around)(struct job *job, struct volume_input *v);
};
extern const struct volume_reader nifti_reader, nifti_image_reader, mgh_reader, nrrd_reader, metaimage_reader,
    afni_reader, afni_brik_reader, tiff_reader, minc_reader, zarr_reader;

struct volume_input {
    const struct volume_reader *reader;
    struct source_keys keys;          /**< Whose path is the one that was given. */
    struct brainglobe_metadata place; /**< resolution and orientation, as far as they are given. */
    const struct source *source;      /**< Of that path; NULL: a folder. */
    const struct source *other;       /**< The other half that has the header; NULL: `source` has. */
    const struct source *voxels;      /**< The file of the voxels. */
    const char *path;                 /**< The volume's in results: that of the voxels, or of a header of text. */
    struct volume_header header;      /**< info.sha256 is set once the voxels were read. */
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

#endif
