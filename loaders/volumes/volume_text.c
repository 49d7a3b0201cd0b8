/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes whose header is text, as volume_file.c wants them. */
#include "loaders/volumes/volume_text.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/files/folder.h"
#include "base/formats/base64.h"
#include "base/formats/gzip.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/volumes/text/header_text.h"
#include "loaders/volumes/text/text_volume.h"

#include <float.h>
#include <math.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <string.h>

/* A header and the job whose memory it is. */
struct parsed {
    struct text_volume volume;
    struct job job;
};

void volume_text_finish(struct text_volume **text)
{
    struct parsed *parsed = (struct parsed *)(void *)*text;
    if (parsed) {
        job_end(&parsed->job);
    }
    memory_free(parsed);
    *text = NULL;
}

static conus_status describe_text(struct volume_header *out, const struct text_volume *text)
{
    const int64_t dim[7] = {text->dim[0], text->dim[1], text->dim[2], text->count, 1, 1, 1};
    bool native = text->encoding == TEXT_NUMBERS || text->type.size == 1;
    out->swapped = !native && text->big_endian == BIG_ENDIAN_IS_SWAPPED;
    out->offset = text->file || text->brik ? 0 : text->header_size;
    out->info.slope = 1;
    out->info.space_code = text->space_code;
    out->has_unit = text->has_unit;
    snprintf(out->info.format, sizeof out->info.format, "%s", text->format);
    conus_status status = volume_header_set_datatype(out, volume_datatype_of(text->type.kind, text->type.size));
    status = status ? status : volume_header_set_dim(out, dim);
    return status ? status : space_describe(&out->info, text->world_from_voxel, text->transform);
}

/* Bridge: the headers of text are read on a job, which lives on in out->text. */
conus_status volume_text_parse(struct volume_header *out, enum format_id format, const struct bytes *head,
                               struct notes *notes)
{
    struct parsed *parsed = memory_zeroed(1, sizeof *parsed);
    if (!parsed) {
        return CONUS_ERROR_MEMORY;
    }
    struct volume_header header = {.text = &parsed->volume};
    struct job *job = &parsed->job;
    (format == FORMAT_NRRD   ? nrrd_parse
     : format == FORMAT_AFNI ? afni_parse
                             : metaimage_parse)(job, header.text, (struct text){(const char *)head->data, head->size});
    (void)JOB_CALL(job, describe_text(&header, header.text));
    if (job->notes.count) {
        (void)JOB_CALL(job, notes_move(notes, &job->notes));
    }
    if (!job_ok(job)) {
        conus_status status = job_close(job, notes, NULL);
        memory_free(parsed);
        return status;
    }
    *out = header;
    return CONUS_OK;
}

/* Reads the header in the first `limit` bytes of what must be unpacked, or read, for it. */
static conus_status parse_text_of(struct volume_header *out, enum format_id format, const struct stored *stored,
                                  size_t limit, struct notes *notes)
{
    struct bytes head = {0};
    conus_status status = stored_head(&head, stored, limit);
    status = status ? status : volume_text_parse(out, format, &head, notes);
    if (!status && limit < VOLUME_TEXT_HEAD && head.size == limit && out->text->header_size == limit) {
        volume_text_finish(&out->text); /* there may be more of it */
        status = CONUS_ERROR_DATA;
    }
    bytes_finish(&head);
    return status;
}

conus_status volume_text_parse_stored(struct volume_header *out, enum format_id format, const struct stored *stored,
                                      struct notes *notes)
{
    enum { MOST = 1 << 16 }; /* headers are smaller */
    struct notes found = {0};
    if (!stored->packed) {
        return volume_text_parse(out, format, &stored->bytes, notes);
    }
    conus_status status = parse_text_of(out, format, stored, MOST, &found);
    if (!status) {
        status = notes_move(notes, &found);
        notes_finish(&found);
        return status;
    }
    notes_finish(&found);
    return status == CONUS_ERROR_MEMORY ? status : parse_text_of(out, format, stored, VOLUME_TEXT_HEAD, notes);
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

static conus_status fail_count(const char *unit, unsigned long long found, unsigned long long wanted)
{
    return fail(CONUS_ERROR_DATA, "voxels: found %llu %s, the header asks for %llu", found, unit, wanted);
}

/* Writes one number as it lies in memory. */
static bool write_number(uint8_t *to, struct text word, struct text_type type)
{
    uint64_t bits = 0; /* of a whole number, whose low bytes count */
    int64_t whole = 0;
    double real = 0;
    bool fits;
    unsigned shift = (unsigned)(8 * (8 - type.size));
    if (type.kind == 'f') {
        fits = text_to_double(word, &real) &&
               (type.size == sizeof real || !isfinite(real) || fabs(real) <= (double)FLT_MAX);
    } else if (type.kind == 'u') {
        fits = text_to_uint(word, UINT64_MAX >> shift, &bits);
    } else {
        fits = text_to_int(word, &whole) && whole >= INT64_MIN >> shift && whole <= INT64_MAX >> shift;
        bits = (uint64_t)whole;
    }
    float single = fits ? (float)real : 0;
    uint32_t half = (uint32_t)bits;
    uint16_t quarter = (uint16_t)bits;
    uint8_t byte = (uint8_t)bits;
    const void *from = type.kind == 'f' ? (type.size == 4 ? (const void *)&single : (const void *)&real)
                       : type.size == 8 ? (const void *)&bits
                       : type.size == 4 ? (const void *)&half
                       : type.size == 2 ? (const void *)&quarter
                                        : (const void *)&byte;
    memcpy(to, from, type.size);
    return fits;
}

/* Reads numbers of `type`, with white space between them, into bytes in this machine's order; keeps those of
 * `range`. range->total / type.size numbers must be there; a further one is an error. */
static conus_status text_numbers_read(struct bytes *out, struct gzip_range *range, struct text text,
                                      struct text_type type)
{
    uint64_t wanted = range->total / type.size;
    uint64_t first = range->from / type.size;
    uint64_t last = first + range->count / type.size;
    if (wanted > text.size / 2 + 1) { /* a digit and a space each */
        return fail_count("bytes of numbers", text.size, wanted);
    }
    uint8_t *kept = memory_raw(range->count, 1);
    conus_status status = kept ? CONUS_OK : CONUS_ERROR_MEMORY;
    struct text word;
    uint64_t index = 0;
    for (; !status && text_word(&text, &word); index++) {
        uint8_t other[8];
        bool inside = index >= first && index < last;
        uint8_t *to = inside ? kept + (index - first) * type.size : other;
        if (index < wanted && !write_number(to, word, type)) {
            status = fail(CONUS_ERROR_DATA, "voxels: number %llu: found \"%.*s\", which is no number of the type",
                          (unsigned long long)index, HEADER_SHOW(word));
        }
    }
    status = status || index == wanted ? status : fail_count("numbers", index, wanted);
    if (status) {
        memory_free(kept);
        return status;
    }
    *out = (struct bytes){kept, range->count};
    return CONUS_OK;
}

/* Reads bytes of two hexadecimal digits, with white space anywhere; as above. */
static conus_status text_hex_read(struct bytes *out, struct gzip_range *range, struct text text)
{
    if (range->total > text.size / 2) {
        return fail_count("hexadecimal digits at most", text.size, 2 * range->total);
    }
    uint8_t *kept = memory_raw(range->count, 1);
    conus_status status = kept ? CONUS_OK : CONUS_ERROR_MEMORY;
    uint64_t digits = 0;
    unsigned byte = 0;
    for (size_t i = 0; !status && i < text.size; i++) {
        int digit = base16_value(text.data[i]);
        if (digit < 0) {
            bool space = text.data[i] && strchr(" \t\r\n\v\f", text.data[i]);
            status = space ? CONUS_OK : fail(CONUS_ERROR_DATA, "voxels: byte %zu is no hexadecimal digit", i);
            continue;
        }
        byte = byte << 4 | (unsigned)digit;
        uint64_t at = digits++ / 2;
        if (at >= range->from && at - range->from < range->count) {
            kept[at - range->from] = (uint8_t)byte;
        }
    }
    status = status || digits == 2 * range->total ? status : fail_count("hexadecimal digits", digits, 2 * range->total);
    if (status) {
        memory_free(kept);
        return status;
    }
    *out = (struct bytes){kept, range->count};
    return CONUS_OK;
}

/* Where the voxels begin in the file as stored, after the header and the lines to skip. */
static conus_status find_start(size_t *start, const struct text_volume *volume, const struct bytes *stored)
{
    size_t at = volume->file || volume->brik ? 0 : (size_t)volume->header_size;
    for (uint64_t line = 0; line < volume->line_skip; line++) {
        const uint8_t *end = at < stored->size ? memchr(stored->data + at, '\n', stored->size - at) : NULL;
        if (!end) {
            return fail(CONUS_ERROR_DATA, "line skip: found %llu, the file has %llu lines before the voxels",
                        (unsigned long long)volume->line_skip, (unsigned long long)line);
        }
        at = (size_t)(end - stored->data) + 1;
    }
    *start = at;
    return CONUS_OK;
}

/* Raw voxels, in a file that may be packed as a whole. */
static conus_status read_raw(struct bytes *out, struct gzip_range *range, const struct text_volume *volume,
                             struct stored *stored)
{
    size_t start = 0;
    struct bytes *bytes = &stored->bytes;
    if (stored->packed && (volume->at_end || volume->line_skip)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%s: found in a file that is packed as a whole, allowed are bytes to skip",
                    volume->at_end ? "voxels at the end" : "lines to skip");
    }
    if (volume->at_end && bytes->size >= range->total) {
        range->from += bytes->size - range->total;
        range->total = bytes->size;
        return gzip_keep(out, range, bytes);
    }
    conus_status status = find_start(&start, volume, bytes);
    if (status) {
        return status;
    }
    range->from += start + volume->byte_skip;
    range->total += start + volume->byte_skip;
    return stored_range(out, range, stored);
}

/* gzip or zlib data behind the header, from `start` on. */
static conus_status read_packed(struct bytes *out, struct gzip_range *range, const struct text_volume *volume,
                                struct stored *stored, size_t start)
{
    const uint8_t *data = stored->bytes.data + start;
    size_t size = stored->bytes.size - start;
    if (volume->packed_size > size) {
        return fail(CONUS_ERROR_DATA, "CompressedDataSize: found %llu, the file has %zu bytes of voxels",
                    (unsigned long long)volume->packed_size, size);
    }
    size = volume->packed_size ? (size_t)volume->packed_size : size;
    range->zlib = volume->encoding == TEXT_ZLIB && !gzip_is(data, size);
    if (!range->zlib && !gzip_is(data, size)) {
        return fail(CONUS_ERROR_DATA, "encoding: found gzip in the header, but the voxels are not packed so");
    }
    conus_status status = gzip_unpack(out, range, data, size);
    if (status != CONUS_ERROR_DATA || size == stored->bytes.size - start) {
        return status;
    }
    char why[200];
    snprintf(why, sizeof why, "%s", conus_message());
    return fail(status, "CompressedDataSize: found %zu, the file has %zu bytes of voxels: %s", size,
                stored->bytes.size - start, why);
}

/* Voxels that are text, or packed apart from their header. */
static conus_status read_coded(struct bytes *out, struct gzip_range *range, const struct text_volume *volume,
                               struct stored *stored)
{
    size_t start = 0;
    if (stored->packed) {
        return fail(CONUS_ERROR_UNSUPPORTED, "encoding: found voxels that are packed or text, in a file that is packed "
                                             "as a whole; allowed there are raw voxels");
    }
    bool is_stream = volume->encoding == TEXT_GZIP || volume->encoding == TEXT_ZLIB;
    range->from += is_stream ? volume->byte_skip : 0;
    range->total += is_stream ? volume->byte_skip : 0;
    conus_status status = find_start(&start, volume, &stored->bytes);
    if (status) {
        return status;
    }
    if (is_stream) {
        return read_packed(out, range, volume, stored, start);
    }
    const uint8_t *data = stored->bytes.data + start;
    size_t size = stored->bytes.size - start;
    if (volume->byte_skip > size) {
        return fail(CONUS_ERROR_DATA, "byte skip: found %llu, the file has %zu bytes of voxels",
                    (unsigned long long)volume->byte_skip, size);
    }
    struct text text = {(const char *)data + volume->byte_skip, size - (size_t)volume->byte_skip};
    return volume->encoding == TEXT_HEX ? text_hex_read(out, range, text)
                                        : text_numbers_read(out, range, text, volume->type);
}

/* From "all volumes of voxel 0, all of voxel 1, ..." to one volume behind the other; `out` has the wanted ones. */
static conus_status take_apart(struct bytes *out, const struct volume_header *header, bool all)
{
    size_t size = header->text->type.size;
    size_t count = (size_t)header->text->count;
    size_t first = all ? 0 : header->info.volume;
    size_t last = all ? count : first + 1;
    struct bytes whole = *out;
    uint8_t *apart = memory_raw(last - first, header->volume_size);
    if (!apart) {
        return CONUS_ERROR_MEMORY;
    }
    uint8_t *to = apart;
    for (size_t k = first; k < last; k++) {
        for (size_t at = k * size; at < whole.size; at += count * size, to += size) {
            memcpy(to, whole.data + at, size);
        }
    }
    bytes_finish(&whole);
    *out = (struct bytes){apart, (last - first) * header->volume_size};
    return CONUS_OK;
}

conus_status volume_text_voxels(struct bytes *out, struct gzip_range *range, const struct volume_header *header,
                                struct stored *stored, bool all)
{
    const struct text_volume *text = header->text;
    bool whole = all || text->interleaved;                    /* all unpacked bytes are needed then */
    size_t total = header->volume_size * (size_t)text->count; /* checked with the header */
    struct bytes voxels = {0};
    *range = (struct gzip_range){.sink = range->sink,
                                 .user = range->user,
                                 .from = whole ? 0 : header->info.volume * header->volume_size,
                                 .count = whole ? total : header->volume_size,
                                 .total = total};
    conus_status status = (text->encoding == TEXT_RAW ? read_raw : read_coded)(&voxels, range, text, stored);
    if (!status && text->interleaved) {
        status = take_apart(&voxels, header, all);
    }
    if (status) {
        bytes_finish(&voxels);
    } else {
        *out = voxels;
    }
    return status;
}
