/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens a volume: one file or a pair, packed or not, one volume of several. */
#include "loaders/volumes/volume_file.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/gzip.h"
#include "base/memory.h"
#include "loaders/brainglobe/brainglobe_metadata.h"
#include "loaders/refuse.h"
#include "loaders/tiff/tiff.h"
#include "loaders/volumes/mgh.h"
#include "loaders/volumes/minc.h"
#include "loaders/volumes/nifti.h"
#include "loaders/volumes/stored/stored_file.h"
#include "loaders/volumes/volume_header.h"
#include "loaders/volumes/volume_selector.h"
#include "loaders/volumes/volume_text.h"
#include "loaders/volumes/volume_values.h"
#include "loaders/volumes/volume_zarr.h"
#include "sources/signatures.h"
#include "sources/source.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

/* True where `path` ends in ".ext" or ".ext.gz", whatever the case; *at is where "ext" stands. */
static bool volume_pair_has(const char *path, const char *ext, size_t *at)
{
    size_t length = strlen(path);
    if (length > 3 && strcasecmp(path + length - 3, ".gz") == 0) {
        length -= 3;
    }
    size_t ending = strlen(ext);
    *at = length - ending;
    return length > ending && path[*at - 1] == '.' && strncasecmp(path + *at, ext, ending) == 0;
}

/* Path of the other half of a pair: `path` with the ending at `at` replaced by `ext` ("hdr" or "img"), in capitals
 * if this half's is; packed like this half if there is such a file, else not. NULL without memory; memory_free() it. */
static char *volume_pair_other(const char *path, size_t at, const char *ext)
{
    bool packed = path[at + 3] != '\0';
    char *other = memory_raw(at + 7, 1);
    if (!other) {
        return NULL;
    }
    for (int attempt = 0; attempt < 2; attempt++) {
        snprintf(other, at + 7, "%.*s%s%s", (int)at, path, ext, packed == (attempt == 0) ? ".gz" : "");
        for (size_t i = at; i < at + 3; i++) {
            other[i] = path[at] < 'a' ? (char)(other[i] - 'a' + 'A') : other[i];
        }
        if (file_exists(other)) {
            break;
        }
    }
    return other;
}

/* Finds the place of the stack `path`: `stated`, completed by metadata.json beside it, which then joins `read`.
 * CONUS_ERROR_DATA where voxel size or orientation are missing. */
static conus_status tiff_volume_place(struct brainglobe_metadata *out, const char *path,
                                      const struct brainglobe_metadata *stated, struct file_sums *read)
{
    bool found = false;
    bool whole = stated->orientation[0] && stated->resolution[0] > 0;
    struct brainglobe_metadata place = {0};
    conus_status status = whole ? CONUS_OK : brainglobe_metadata_read(&place, &found, path, read);
    if (stated->orientation[0]) {
        memcpy(place.orientation, stated->orientation, sizeof place.orientation);
    }
    if (stated->resolution[0] > 0) {
        memcpy(place.resolution, stated->resolution, sizeof place.resolution);
    }
    bool sized = place.resolution[0] > 0;
    if (!status && (!sized || !place.orientation[0])) {
        const char *missing = sized                  ? "no orientation"
                              : place.orientation[0] ? "no resolution"
                                                     : "no resolution and no orientation";
        status = fail(CONUS_ERROR_DATA,
                      "a TIFF stack does not say where it lies: %s %s beside it; give FILE,resolution=25,"
                      "orientation=asr (micrometres; where page, row and column start)",
                      missing, found ? "in metadata.json" : "is given, and there is no metadata.json");
    }
    if (!status) {
        *out = place;
    }
    return status;
}

/* The header of the stack. A shape in `place` that is not the stack's is CONUS_ERROR_DATA. */
static conus_status tiff_volume_header(struct volume_header *out, const struct tiff *tiff,
                                       const struct brainglobe_metadata *place)
{
    const struct tiff_page *page = &tiff->pages[0];
    const int64_t dim[7] = {(int64_t)page->width, (int64_t)page->length, (int64_t)tiff->depth, 1, 1, 1, 1};
    double world[16];
    struct volume_header header = {
        .swapped = tiff->file.swapped, .footer = true, .has_unit = true, .offset = tiff->whole ? tiff->start : 0};
    header.info.slope = 1;
    snprintf(header.info.format, sizeof header.info.format, tiff->file.big ? "BigTIFF" : "TIFF");
    int datatype = volume_datatype_of("uif"[page->format - TIFF_UNSIGNED], page -> bits / 8);
    conus_status status;
    if ((status = volume_header_set_datatype(&header, datatype)) || (status = volume_header_set_dim(&header, dim))) {
        return status;
    }
    const uint64_t *shape = place->shape;
    const size_t *found = header.info.dim;
    if (shape[0] && (shape[0] != found[2] || shape[1] != found[1] || shape[2] != found[0])) {
        return fail(CONUS_ERROR_DATA,
                    "shape: metadata.json says %llu x %llu x %llu, the stack has %zu pages of %zu rows and %zu "
                    "columns",
                    (unsigned long long)shape[0], (unsigned long long)shape[1], (unsigned long long)shape[2], found[2],
                    found[1], found[0]);
    }
    if ((status = brainglobe_voxels(world, place)) ||
        (status = space_describe(&header.info, world, "resolution and orientation"))) {
        return status;
    }
    *out = header;
    return CONUS_OK;
}

static const char default_needed[] = "a volume (NIfTI, MGH, NRRD, MetaImage, AFNI, TIFF, MINC or OME-Zarr)";
enum {
    HEAD_LIMIT = 1 << 26, /* of the header file of a pair */
    HEADER_READ = 1 << 16 /* bytes that are read where only the header is needed; packed, it takes less */
};

static conus_status read_other_half(struct stored *out, const char *path, size_t at, const char *ext, uint64_t limit)
{
    char *other = volume_pair_other(path, at, ext);
    if (!other) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status;
    if (file_exists(other)) {
        status = stored_open(out, other, limit);
    } else {
        status = fail(CONUS_ERROR_IO, "%s: the other half of the pair is missing: %.*s%s or %.*s%s.gz", path, (int)at,
                      path, ext, (int)at, path, ext);
    }
    memory_free(other);
    return status;
}

/* A volume that is being opened. */
struct opening {
    struct stored voxels;
    struct stored pair_header; /* the .hdr of a pair, or a header of text, else empty */
    struct volume_header header;
    struct notes notes;
    uint64_t limit;
    const struct open_file *file; /* the named file, if it is open; else NULL */
    const char *needed;           /* in the place where the file stands; NULL: default_needed */
    struct volume_selector selector;
    bool all;                /* volumes are kept, not only the chosen one */
    bool only_grid;          /* no voxels are */
    struct tiff tiff;        /* of a TIFF stack, else no pages */
    struct volume_zarr zarr; /* of OME-Zarr, else no folder */
    struct minc minc;        /* of MINC, else no HDF5 */
    struct file_sums read;
    struct label_reader *labels; /* gets packed voxels slab by slab if that takes less memory; NULL: they are kept */
    struct volume_file like;     /* what the labels are read as, without voxels */
};

static void opening_finish(struct opening *opening)
{
    stored_finish(&opening->voxels);
    stored_finish(&opening->pair_header);
    volume_text_finish(&opening->header.text);
    notes_finish(&opening->notes);
    tiff_finish(&opening->tiff);
    volume_zarr_finish(&opening->zarr);
    minc_finish(&opening->minc);
    file_sums_finish(&opening->read);
    volume_selector_finish(&opening->selector);
}

static conus_status parse_head(struct volume_header *out, const struct stored *stored, const char *needed,
                               struct notes *notes)
{
    struct bytes head;
    conus_status status = stored_head(&head, stored, NIFTI_HEAD_SIZE);
    if (status) {
        return status;
    }
    const enum format_id format = format_id_of(&head, ROLE_VOLUME);
    if (format == FORMAT_NIFTI) {
        status = nifti_header_parse(out, head.data, head.size, notes);
    } else if (format == FORMAT_MGH) {
        status = mgh_header_parse(out, head.data, head.size, notes);
    } else if (format == FORMAT_NRRD || format == FORMAT_METAIMAGE || format == FORMAT_AFNI) {
        status = volume_text_parse_stored(out, format, stored, notes);
    } else if (stored->packed && (format == FORMAT_TIFF || format == FORMAT_HDF5)) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "content: %s packed with gzip: unpack it",
                      format == FORMAT_TIFF ? "TIFF" : "HDF5");
    } else if (head.size || !stored->packed) {
        status = file_refuse(stored->path, &stored->bytes, needed);
    } else {
        status = fail(CONUS_ERROR_DATA, "content: the file unpacks to nothing: it is empty or cut off; needed is %s",
                      needed);
    }
    bytes_finish(&head);
    return status;
}

/* Reads the header out of `stored`. */
static conus_status volume_read_header(struct opening *o, const struct stored *stored)
{
    conus_status status = parse_head(&o->header, stored, o->needed ? o->needed : default_needed, &o->notes);
    return status ? fail_in(status, stored->path) : CONUS_OK;
}

/* True where `path` names the voxels of a pair, and does not hold a header itself. */
static conus_status is_image_half(bool *out, size_t *at, const struct stored *stored)
{
    *out = false;
    if (!volume_pair_has(stored->path, "img", at)) {
        return CONUS_OK;
    }
    struct bytes head;
    conus_status status = stored_head(&head, stored, NIFTI_HEAD_SIZE);
    if (status) {
        return fail_in(status, stored->path);
    }
    *out = !nifti_has_magic(head.data, head.size);
    bytes_finish(&head);
    return CONUS_OK;
}

static conus_status open_by_image(struct opening *o, size_t at)
{
    conus_status status;
    if ((status = read_other_half(&o->pair_header, o->voxels.path, at, "hdr", o->limit)) ||
        (status = volume_read_header(o, &o->pair_header))) {
        return status;
    }
    return o->header.pair
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s: magic: found that of a single file, a .hdr beside an .img needs \"ni\"",
                      o->pair_header.path);
}

/* The voxels of a header of text, if they lie in another file. */
static conus_status open_text_data(struct opening *o)
{
    char *path = NULL;
    conus_status status = volume_text_data_path(&path, o->header.text, o->voxels.path);
    if (!status && path) {
        o->pair_header = o->voxels;
        o->voxels = (struct stored){0};
        status = stored_open(&o->voxels, path, o->limit);
        o->voxels.packed = o->voxels.packed && !o->header.text->file; /* else its header says how they are packed */
    }
    memory_free(path);
    return status;
}

static conus_status open_by_header(struct opening *o)
{
    size_t at;
    conus_status status = volume_read_header(o, &o->voxels);
    if (status) {
        return status;
    }
    if (o->header.text) {
        return open_text_data(o);
    }
    if (!o->header.pair) {
        return CONUS_OK;
    }
    if (!volume_pair_has(o->voxels.path, "hdr", &at)) {
        return fail(CONUS_ERROR_DATA, "%s: magic: found that of a .hdr/.img pair, but the name does not end in .hdr",
                    o->voxels.path);
    }
    o->pair_header = o->voxels;
    o->voxels = (struct stored){0};
    return read_other_half(&o->voxels, o->pair_header.path, at, "img", o->limit);
}

/* Opens an AFNI data set by its voxels; its header is `head`. */
static conus_status open_by_brik(struct opening *o, const char *path, const char *head)
{
    conus_status status;
    if ((status = stored_open(&o->pair_header, head, o->limit)) || (status = volume_read_header(o, &o->pair_header))) {
        return status;
    }
    if (!o->header.text || !o->header.text->brik) {
        return fail(CONUS_ERROR_DATA, "%s: content: a .HEAD beside a .BRIK must be the header of an AFNI data set",
                    head);
    }
    return stored_open(&o->voxels, path, o->limit);
}

static conus_status open_tiff(struct opening *o)
{
    const struct stored *stored = &o->voxels;
    struct brainglobe_metadata place = {0};
    conus_status status = volume_selector_refuse_level(&o->selector, stored->path);
    if (status) {
        return status;
    }
    status = tiff_parse(&o->tiff, stored->bytes.data, stored->bytes.size);
    status = status ? status : tiff_volume_place(&place, stored->path, &o->selector.place, &o->read);
    status = status ? status : tiff_volume_header(&o->header, &o->tiff, &place);
    return status ? fail_in(status, stored->path) : CONUS_OK;
}

static bool has_fixed_header(const uint8_t *data, size_t size)
{
    return nifti_has_magic(data, size) || mgh_is(data, size); /* of an ANALYZE pair the file is no run of voxels */
}

/* Opens the files of the volume and reads its header. */
static conus_status open_and_read_header(struct opening *o, const char *path)
{
    bool image = false;
    size_t at = 0;
    char *head = NULL;
    const struct format *folder = NULL;
    conus_status status = file_is_folder(path) ? source_find(&folder, path, ROLE_VOLUME) : CONUS_OK;
    if (folder) {
        o->voxels.path = memory_text(path, strlen(path));
        return o->voxels.path ? volume_zarr_open(&o->zarr, &o->header, path, &o->selector, &o->read)
                              : CONUS_ERROR_MEMORY;
    }
    status = status ? status : volume_text_head_path(&head, path);
    if (status) {
        return status;
    }
    if (head) {
        status = volume_selector_refuse_place(&o->selector, path);
        status = status ? status : open_by_brik(o, path, head);
        memory_free(head);
        return status;
    }
    status = o->labels ? stored_open_slabs(&o->voxels, path, o->file, o->limit, has_fixed_header)
                       : stored_open(&o->voxels, path, o->limit);
    if (status) {
        return status;
    }
    const enum format_id format = format_id_of(&o->voxels.bytes, ROLE_VOLUME);
    if (format == FORMAT_TIFF) {
        return open_tiff(o);
    }
    if ((status = volume_selector_refuse_place(&o->selector, path)) ||
        (status = is_image_half(&image, &at, &o->voxels))) {
        return status;
    }
    if (format == FORMAT_HDF5) {
        status = volume_selector_refuse_level(&o->selector, path);
        status = status ? status : minc_open(&o->minc, &o->header, &o->voxels.bytes, o->limit);
        return status ? fail_in(status, path) : CONUS_OK;
    }
    return image ? open_by_image(o, at) : open_by_header(o);
}

/* Whether the reader of labels gets the voxels slab by slab: where the volume is large, and lies in a plain file or has
 * labels that take more bytes than their places. Else they are unpacked at once, which is faster, and labels take their
 * place. */
static bool goes_in_slabs(const struct opening *o)
{
    const struct volume_header *header = &o->header;
    if (o->zarr.folder || o->minc.hdf5) {
        return o->labels && !o->all;
    }
    bool is_packed = header->text ? volume_text_is_packed(header, o->voxels.packed) : o->voxels.packed;
    bool is_wide = volume_datatype_size(header->datatype) > sizeof(uint16_t);
    bool may = o->labels && !o->all && !o->tiff.pages && header->volume_size > STORED_LARGE;
    return may && (o->voxels.plain || (is_packed && is_wide));
}

/* Checks the chosen volume, and keeps all volumes only if they fit into the limit together. */
static conus_status choose_volume(struct opening *o)
{
    struct volume_header *header = &o->header;
    size_t count = header->info.volume_count;
    if (!o->selector.chosen && count > 1) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "volume: the file has %zu, choose one by adding \",volume=K\", K from 0 to %zu", count, count - 1);
    }
    if (o->selector.volume >= count) {
        return fail(CONUS_ERROR_ARGUMENT, "volume: found %llu, allowed are 0 to %zu",
                    (unsigned long long)o->selector.volume, count - 1);
    }
    uint64_t before = header->offset + volume_text_scratch(header);
    uint64_t held = goes_in_slabs(o) ? 0 : header->volume_size; /* else labels count what they take */
    if (held > o->limit || before > o->limit - held) {
        return fail(CONUS_ERROR_MEMORY,
                    "dim: %zu x %zu x %zu voxels of %s take %zu bytes unpacked, allowed are %llu "
                    "(--max-memory)",
                    header->info.dim[0], header->info.dim[1], header->info.dim[2], header->info.datatype,
                    header->volume_size, (unsigned long long)o->limit);
    }
    header->info.volume = (size_t)o->selector.volume;
    o->all = o->all && !o->zarr.folder && count <= (o->limit - before) / header->volume_size;
    return CONUS_OK;
}

/* The header file of a pair whole, or what lies before the voxels of a single file. */
static conus_status take_head(struct volume_file *file, const struct opening *o)
{
    if (o->tiff.pages || o->minc.hdf5) {
        return CONUS_OK; /* what lies before the voxels is no table of labels */
    }
    if (!o->header.pair) {
        return stored_head(&file->head, &o->voxels, (size_t)o->header.offset);
    }
    conus_status status = stored_head(&file->head, &o->pair_header, HEAD_LIMIT);
    if (status || !o->pair_header.packed) {
        return status;
    }
    struct bytes checked;
    struct gzip_range all = {.count = file->head.size, .total = file->head.size};
    status = gzip_unpack(&checked, &all, o->pair_header.bytes.data, o->pair_header.bytes.size);
    if (!status) { /* the same bytes, now with their checksum verified */
        bytes_finish(&checked);
    }
    return status;
}

/* Where voxels go that come slab by slab and are kept. */
struct filling {
    uint8_t *data;
    size_t done;
    size_t size;
};

static conus_status fill(void *user, const uint8_t *data, size_t size)
{
    struct filling *filling = user;
    memcpy(filling->data + filling->done, data, size);
    filling->done += size;
    return CONUS_OK;
}

/* The same into zeros: memory that gets nothing else is never touched, and the system need not have it. */
static conus_status fill_zeros(void *user, const uint8_t *data, size_t size)
{
    static const uint8_t zeros[512];
    struct filling *filling = user;
    for (size_t at = 0; at < size; at += sizeof zeros) {
        size_t count = size - at < sizeof zeros ? size - at : sizeof zeros;
        if (memcmp(data + at, zeros, count) != 0) {
            memcpy(filling->data + filling->done + at, data + at, count);
        }
    }
    filling->done += size;
    return CONUS_OK;
}

/* A zarr_sink: a row of voxels of `size` bytes. */
static conus_status fill_row(void *user, size_t first, const uint8_t *voxels, size_t count)
{
    struct filling *filling = user;
    memcpy(filling->data + first * filling->size, voxels, count * filling->size);
    return CONUS_OK;
}

/* Reads the voxels of OME-Zarr or MINC for the reader of labels, or else into `out`. */
static conus_status take_slabs(struct bytes *out, char sha256[65], const struct gzip_range *range, struct opening *o)
{
    bool is_filled = !range->sink;
    struct filling filling = {.data = is_filled ? memory_zeroed(range->count, 1) : NULL,
                              .size = volume_datatype_size(o->header.datatype)};
    if (is_filled && !filling.data) {
        return CONUS_ERROR_MEMORY;
    }
    void *user = is_filled ? &filling : range->user;
    conus_status status = o->minc.hdf5 ? minc_read(&o->minc, is_filled ? fill : range->sink, user)
                                       : volume_zarr_read(sha256, &o->zarr, o->header.info.volume, o->limit,
                                                          is_filled ? fill_row : label_reader_put, user, &o->notes);
    if (status) {
        memory_free(filling.data);
        return status;
    }
    *out = (struct bytes){filling.data, filling.data ? range->count : 0};
    return CONUS_OK;
}

/* Unpacks the voxels from the stored bytes, which are freed. Slabs of labels go straight to their reader. */
static conus_status take_voxels(struct volume_file *file, struct opening *o)
{
    const struct volume_header *header = &o->header;
    struct stored *stored = &o->voxels;
    bool scattered = o->tiff.pages && !o->tiff.whole;
    struct bytes *out = o->all ? &file->series : &file->voxels;
    struct gzip_range range = {.from = header->offset + (o->all ? 0 : header->info.volume * header->volume_size),
                               .count = header->volume_size * (o->all ? header->info.volume_count : 1),
                               .total = header->offset + header->info.volume_count * header->volume_size};
    struct filling series = {0};
    conus_status status = CONUS_OK;
    if (o->all && stored->packed && !header->text) { /* maps of probabilities hold little */
        series.data = memory_sparse(range.count);
        range.sink = fill_zeros;
        range.user = &series;
        status = series.data ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    if (goes_in_slabs(o)) {
        o->like = *file;
        o->like.text = header->text;
        volume_text_choose(&o->like);
        range.sink = label_reader_add;
        range.user = o->labels;
        status = label_reader_init(o->labels, &o->like, &(struct bytes){0});
    }
    status = status                           ? status
             : o->zarr.folder || o->minc.hdf5 ? take_slabs(out, file->info.sha256, &range, o)
             : scattered                      ? tiff_unpack(out, &o->tiff)
             : header->text                   ? volume_text_voxels(out, &range, header, stored, o->all)
                                              : stored_range(out, &range, stored);
    if (status) {
        memory_free(series.data);
        return status;
    }
    if (series.data) {
        *out = (struct bytes){series.data, range.count};
    }
    if (o->all) {
        file->voxels =
            (struct bytes){file->series.data + header->info.volume * header->volume_size, header->volume_size};
    }
    size_t flag = header->header_size; /* of NIfTI: whether extensions follow the header */
    if (range.extra >= NIFTI_EXTENSION_LEAST && !header->footer && !header->text && !header->pair && flag &&
        file->head.size > flag && file->head.data[flag] && header->offset < flag + 4 + NIFTI_EXTENSION_LEAST) {
        return fail(CONUS_ERROR_DATA,
                    "vox_offset: found %llu, but an extension begins there, as byte %zu says, and %llu bytes stand "
                    "after the last voxel: the voxels begin behind the extension",
                    (unsigned long long)header->offset, flag, (unsigned long long)range.extra);
    }
    if (range.extra && !header->footer) {
        status = notes_add(&o->notes, "%llu bytes after the last voxel were ignored", (unsigned long long)range.extra);
    }
    if (!status && range.junk) {
        status = notes_add(&o->notes, "%zu bytes after the end of the gzip data were ignored", range.junk);
    }
    return status;
}

/* Takes the bytes of the header's file around the header: extensions, text, a label table. */
static conus_status take_around(struct volume_file *file, struct opening *o)
{
    const struct volume_header *header = &o->header;
    if (header->text) {
        file->embedded = text_from(header->text->labels ? header->text->labels : "");
        return CONUS_OK;
    }
    if (o->zarr.folder) {
        file->head = o->zarr.labels;
        file->embedded = text_from_bytes(file->head.data, file->head.size);
        o->zarr.labels = (struct bytes){0};
        return CONUS_OK;
    }
    conus_status status = take_head(file, o);
    if (status || !file->head.size) {
        return status;
    }
    size_t end = header->header_size;
    if (header->header_size != MGH_HEADER_SIZE) {
        status = nifti_extensions_parse(&file->extensions, &file->extension_count, &end, &file->head, header);
    }
    if (status) {
        return status;
    }
    struct text text = {(const char *)file->head.data + end, file->head.size - end};
    while (text.size && text.data[0] == '\0') {
        text.data++;
        text.size--;
    }
    while (text.size && text.data[text.size - 1] == '\0') {
        text.size--;
    }
    file->embedded = text;
    return CONUS_OK;
}

/* Everything into `file`, which the caller finishes on failure. */
static conus_status volume_take_all(struct volume_file *file, struct opening *o)
{
    struct stored *first = o->pair_header.path ? &o->pair_header : &o->voxels;
    struct stored *named = o->header.text ? first : &o->voxels;
    conus_status status = take_around(file, o);
    if (status) {
        return fail_in(status, first->path);
    }
    file->info = o->header.info;
    file->datatype = o->header.datatype;
    file->swapped = o->header.swapped;
    file->label_slack = o->header.label_slack;
    file->intent_code = o->header.intent_code;
    bool big = o->header.swapped == BIG_ENDIAN_IS_SWAPPED;
    snprintf(file->info.format, sizeof file->info.format, "%.16s%s%s%s", o->header.info.format,
             o->header.pair ? " pair" : "", o->voxels.packed ? ", gzip" : volume_text_encoding(&o->header),
             big ? ", big-endian" : ", little-endian");
    if (!stored_known_sum(file->info.sha256, &o->voxels)) {
        volume_text_sha256(file->info.sha256, named == first && first != &o->voxels ? &first->bytes : NULL,
                           &o->voxels.bytes);
    }
    file->max_memory = o->limit;
    if ((status = file_sums_move(&file->read, &o->read)) || (status = take_voxels(file, o))) {
        return fail_in(status, o->voxels.path);
    }
    (void)stored_known_sum(file->info.sha256, &o->voxels); /* of a plain file, which was read now */
    file->path = named->path;
    named->path = NULL;
    file->info.path = file->path;
    file->text = o->header.text;
    o->header.text = NULL;
    volume_text_choose(file);
    return CONUS_OK;
}

/* Opens the files, chooses the volume and takes its voxels. */
static conus_status open_files(struct volume_file *file, const char *path, struct opening *o)
{
    conus_status status = open_and_read_header(o, path);
    if (status) {
        return status;
    }
    status = volume_header_settle(&o->header, &o->notes);
    status = status ? status : choose_volume(o);
    if (!status && o->only_grid) {
        file->info = o->header.info;
        return CONUS_OK;
    }
    return status ? fail_in(status, path) : volume_take_all(file, o);
}

/* Opens the volume that `o` describes, and finishes `o`. */
static conus_status open_volume(struct volume_file *out, const char *path, struct opening *o, struct notes *notes)
{
    struct volume_file file = {0};
    conus_status status = open_files(&file, path, o);
    conus_status moved = notes_move_in(notes, &o->notes, file.path ? file.path : path); /* also where it failed */
    status = status ? status : moved;
    if (status) {
        volume_file_finish(&file);
    } else {
        *out = file;
    }
    opening_finish(o);
    return status;
}

/* The header in the first bytes of a file; `head`, unless NULL, gets what stands before the voxels. */
static conus_status peek_bytes(struct volume_header *out, struct bytes *head, const char *path,
                               const struct bytes *start)
{
    const struct stored stored = {(char *)path, *start, .packed = gzip_is(start->data, start->size)};
    struct notes notes = {0};
    struct volume_header header = {0};
    conus_status status = parse_head(&header, &stored, default_needed, &notes);
    if (!status && head && !header.pair) {
        status = stored_head(head, &stored, header.offset < HEADER_READ ? (size_t)header.offset : HEADER_READ);
    }
    volume_text_finish(&header.text);
    if (!status) {
        *out = header;
    }
    notes_finish(&notes);
    return status ? fail_in(status, path) : CONUS_OK;
}

conus_status volume_file_peek(struct volume_header *out, struct bytes *head, const char *path)
{
    struct source source;
    conus_status status = source_look(&source, path);
    status = status ? status : peek_bytes(out, head, path, &source.stored);
    source_close(&source);
    return status;
}

conus_status volume_bytes_header(conus_volume_info *out, const char *path, const struct bytes *start)
{
    struct volume_header header;
    conus_status status = peek_bytes(&header, NULL, path, start);
    if (!status) {
        *out = header.info;
    }
    return status;
}

/* The header of HDF5, which has no place of its own in the file. */
static conus_status header_of_all(conus_volume_info *out, const char *path)
{
    struct volume_file file = {0};
    struct notes notes = {0};
    conus_status status = volume_file_open(&file, path, 0, &notes);
    if (!status) {
        *out = file.info;
        out->path = NULL;
    }
    volume_file_finish(&file);
    notes_finish(&notes);
    return status;
}

conus_status volume_file_header(conus_volume_info *out, const char *path)
{
    struct source source;
    conus_status status = source_look(&source, path);
    const bool is_hdf5 = !status && format_id_of(&source.stored, ROLE_VOLUME) == FORMAT_HDF5;
    status = status || is_hdf5 ? status : volume_bytes_header(out, path, &source.stored);
    source_close(&source);
    return is_hdf5 ? header_of_all(out, path) : status;
}

/* Opens `path`, which may end in a selector such as ",volume=K"; a series begins with its first volume all the same. */
static conus_status open_by_selector(struct volume_file *out, const char *path, struct opening *opening,
                                     struct notes *notes)
{
    conus_status status = volume_selector_parse(&opening->selector, path);
    opening->selector.volume = opening->all ? 0 : opening->selector.volume;
    opening->selector.chosen = opening->all || opening->selector.chosen;
    status = status ? status : volume_selector_refuse_field(&opening->selector, opening->selector.path);
    if (status) {
        volume_selector_finish(&opening->selector);
        return status;
    }
    return open_volume(out, opening->selector.path, opening, notes);
}

conus_status volume_file_open(struct volume_file *out, const char *path, uint64_t max_memory, struct notes *notes)
{
    struct opening opening = {.limit = memory_limit(max_memory)};
    return open_by_selector(out, path, &opening, notes);
}

conus_status volume_file_grid(conus_volume_info *out, const char *path, uint64_t max_memory, struct notes *notes)
{
    struct volume_file file = {0};
    struct opening opening = {.limit = memory_limit(max_memory), .only_grid = true};
    conus_status status = open_by_selector(&file, path, &opening, notes);
    if (!status) {
        *out = file.info;
    }
    volume_file_finish(&file);
    return status;
}

conus_status volume_file_open_labels(struct volume_file *out, struct label_voxels *labels, const char *path,
                                     const struct open_file *opened, const conus_load_options *options,
                                     const char *needed, struct notes *notes)
{
    struct label_reader reader = {0};
    struct volume_file file = {0};
    struct opening opening = {
        .limit = memory_limit(options->max_memory), .file = opened, .needed = needed, .labels = &reader};
    conus_status status = open_by_selector(&file, path, &opening, notes);
    if (!status) {
        status = file.voxels.data ? volume_file_take_labels(labels, &file) : label_reader_end(labels, &reader, &file);
    }
    label_reader_finish(&reader);
    if (status) {
        volume_file_finish(&file);
    } else {
        *out = file;
    }
    return status;
}

conus_status volume_file_open_series(struct volume_file *out, const char *path, const conus_load_options *options,
                                     struct notes *notes)
{
    struct opening opening = {.limit = memory_limit(options->max_memory), .all = true};
    return open_by_selector(out, path, &opening, notes);
}

conus_status volume_file_select(struct volume_file *file, size_t volume)
{
    size_t count = file->info.volume_count;
    if (volume >= count) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: volume: found %zu, allowed are 0 to %zu", file->path, volume, count - 1);
    }
    if (volume != file->info.volume && !file->series.data) {
        struct volume_file other = {0};
        struct notes notes = {0}; /* they were given when the file was first opened */
        struct opening opening = {.limit = file->max_memory, .selector = {.chosen = true, .volume = volume}};
        conus_status status = open_volume(&other, file->path, &opening, &notes);
        notes_finish(&notes);
        if (!status) {
            volume_file_finish(file);
            *file = other;
        }
        return status;
    }
    file->info.volume = volume;
    if (file->series.data) {
        file->voxels.data = file->series.data + volume * file->voxels.size;
    }
    volume_text_choose(file);
    return CONUS_OK;
}

void volume_file_finish(struct volume_file *file)
{
    memory_free(file->path);
    memory_free(file->extensions);
    volume_text_finish(&file->text);
    file_sums_finish(&file->read);
    bytes_finish(&file->head);
    bytes_finish(file->series.data ? &file->series : &file->voxels);
    *file = (struct volume_file){0};
}
