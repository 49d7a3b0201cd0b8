/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes whose header is text, as volume_file.c wants them. */
#include "loaders/volumes/volume_text.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/formats/signatures.h"
#include "loaders/volumes/text/text_volume.h"
#include "loaders/volumes/text/text_voxels.h"

#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

void volume_text_finish(struct text_volume **text)
{
    text_volume_finish(*text);
    memory_free(*text);
    *text = NULL;
}

static int datatype_of(struct text_type type)
{
    static const struct {
        struct text_type type;
        int datatype;
    } types[] = {{{'u', 1}, VOLUME_UINT8},  {{'i', 1}, VOLUME_INT8},   {{'u', 2}, VOLUME_UINT16},
                 {{'i', 2}, VOLUME_INT16},  {{'u', 4}, VOLUME_UINT32}, {{'i', 4}, VOLUME_INT32},
                 {{'u', 8}, VOLUME_UINT64}, {{'i', 8}, VOLUME_INT64},  {{'f', 4}, VOLUME_FLOAT32},
                 {{'f', 8}, VOLUME_FLOAT64}};
    size_t i = 0;
    while (types[i].type.kind != type.kind || types[i].type.size != type.size) { /* the parsers know no others */
        i++;
    }
    return types[i].datatype;
}

static conus_status describe(struct volume_header *header, const struct text_volume *text)
{
    const int64_t dim[7] = {text->dim[0], text->dim[1], text->dim[2], text->count, 1, 1, 1};
    bool stored_big =
        text->encoding == TEXT_NUMBERS || text->type.size == 1 ? !BIG_ENDIAN_IS_SWAPPED : text->big_endian;
    header->swapped = stored_big == BIG_ENDIAN_IS_SWAPPED;
    header->offset = text->file || text->brik ? 0 : text->header_size;
    header->info.slope = 1;
    header->info.space_code = text->space_code;
    snprintf(header->info.format, sizeof header->info.format, "%s", text->format);
    conus_status status = volume_header_set_datatype(header, datatype_of(text->type));
    status = status ? status : volume_header_set_dim(header, dim);
    return status ? status : space_describe(&header->info, text->world_from_voxel, text->transform);
}

conus_status volume_text_parse(struct volume_header *out, const struct bytes *head, struct notes *notes)
{
    struct volume_header header = {.text = memory_zeroed(1, sizeof *header.text)};
    conus_status status = header.text ? CONUS_OK : CONUS_ERROR_MEMORY;
    bool nrrd = nrrd_is(head->data, head->size);
    bool afni = afni_is(head->data, head->size);
    status = status ? status
                    : (nrrd   ? nrrd_parse
                       : afni ? afni_parse
                              : metaimage_parse)(header.text, head->data, head->size, notes);
    status = status ? status : describe(&header, header.text);
    if (status) {
        volume_text_finish(&header.text);
    } else {
        *out = header;
    }
    return status;
}

/* Reads the header in the first `limit` bytes of what must be unpacked, or read, for it. */
static conus_status parse_text_of(struct volume_header *out, const struct stored *stored, size_t limit,
                                  struct notes *notes)
{
    struct bytes head = {0};
    conus_status status = stored_head(&head, stored, limit);
    status = status ? status : volume_text_parse(out, &head, notes);
    if (!status && limit < VOLUME_TEXT_HEAD && head.size == limit && out->text->header_size == limit) {
        volume_text_finish(&out->text); /* there may be more of it */
        status = CONUS_ERROR_DATA;
    }
    bytes_finish(&head);
    return status;
}

conus_status volume_text_parse_stored(struct volume_header *out, const struct stored *stored, struct notes *notes)
{
    enum { MOST = 1 << 16 }; /* headers are smaller */
    struct notes found = {0};
    if (!stored->packed && !stored->index) {
        return volume_text_parse(out, &stored->bytes, notes);
    }
    conus_status status = parse_text_of(out, stored, MOST, &found);
    if (!status) {
        return notes_move(notes, &found);
    }
    notes_finish(&found);
    return parse_text_of(out, stored, VOLUME_TEXT_HEAD, notes);
}

/* Length of `path` without the ending "HEAD", or "BRIK" perhaps with ".gz"; 0 if it has another. */
static size_t dataset_length(const char *path, const char *ending)
{
    size_t length = strlen(path);
    length -= length > 3 && strcmp(path + length - 3, ".gz") == 0 && ending[0] == 'B' ? 3 : 0;
    bool known = length > 5 && path[length - 5] == '.' && strncmp(path + length - 4, ending, 4) == 0;
    return known ? length - 4 : 0;
}

conus_status volume_text_head_path(char **out, const char *path)
{
    size_t length = dataset_length(path, "BRIK");
    *out = length ? path_with_ending(path, length, "HEAD") : NULL;
    return length && !*out ? CONUS_ERROR_MEMORY : CONUS_OK;
}

/* The .BRIK or .BRIK.gz beside the .HEAD `path`. */
static conus_status find_brik(char **out, const char *path)
{
    size_t length = dataset_length(path, "HEAD");
    if (!length) {
        return fail(CONUS_ERROR_DATA, "%s: found the header of an AFNI data set, whose name must end in .HEAD", path);
    }
    for (int packed = 0; packed < 2; packed++) {
        char *found = path_with_ending(path, length, packed ? "BRIK.gz" : "BRIK");
        if (!found || file_exists(found)) {
            *out = found;
            return found ? CONUS_OK : CONUS_ERROR_MEMORY;
        }
        memory_free(found);
    }
    return fail(CONUS_ERROR_IO, "%s: the file of the voxels is missing: %.*sBRIK or %.*sBRIK.gz", path, (int)length,
                path, (int)length, path);
}

conus_status volume_text_data_path(char **out, const struct text_volume *text, const char *path)
{
    *out = NULL;
    if (text->brik) {
        return find_brik(out, path);
    }
    if (!text->file) {
        return CONUS_OK;
    }
    char *found = file_beside(path, text->file);
    if (found && !file_exists(found)) {
        conus_status status = fail(CONUS_ERROR_IO, "%s: the file of the voxels is missing: %s", path, found);
        memory_free(found);
        return status;
    }
    *out = found;
    return found ? CONUS_OK : CONUS_ERROR_MEMORY;
}

uint64_t volume_text_scratch(const struct volume_header *header)
{
    bool whole = header->text && header->text->interleaved;
    return whole ? (uint64_t)header->volume_size * header->info.volume_count : 0; /* below 2^62, as was checked */
}

bool volume_text_is_packed(const struct volume_header *header, bool packed)
{
    const struct text_volume *text = header->text;
    return !text->interleaved && (packed || text->encoding == TEXT_GZIP || text->encoding == TEXT_ZLIB);
}

const char *volume_text_encoding(const struct volume_header *header)
{
    static const char *const words[] = {"", ", gzip", ", zlib", ", text", ", hex"};
    return words[header->text ? header->text->encoding : TEXT_RAW];
}

conus_status volume_text_voxels(struct bytes *out, struct gzip_range *range, const struct volume_header *header,
                                struct stored *stored, bool all, const char *sha256)
{
    struct text_range wanted = {.volume_size = header->volume_size,
                                .volume = header->info.volume,
                                .all = all,
                                .sha256 = header->text->interleaved ? NULL : sha256,
                                .stored = *range};
    conus_status status = text_voxels_read(out, &wanted, header->text, stored);
    *range = wanted.stored;
    return status;
}

struct text volume_text_table(const struct text_volume *text)
{
    return text_from(text->labels ? text->labels : "");
}

void volume_text_sha256(char out[65], const struct bytes *header, const struct bytes *voxels)
{
    struct sha256_ctx context;
    sha256_init(&context);
    if (header) {
        sha256_update(&context, header->size, header->data);
    }
    sha256_update(&context, voxels->size, voxels->data);
    file_sha256_end(out, &context);
}

void volume_text_choose(struct volume_file *file)
{
    const struct text_volume *text = file->text;
    size_t volume = file->info.volume;
    file->title = text && text->titles ? text->titles[volume] : NULL;
    file->info.slope = text && text->slopes ? text->slopes[volume] : file->info.slope;
}
