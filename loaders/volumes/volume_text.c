/* SPDX-License-Identifier: BSD-3-Clause */
/* Volumes whose header is text: NRRD, MetaImage and AFNI. */
#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/encoding.h"
#include "loaders/refuse.h"
#include "loaders/volumes/parts.h"
#include "loaders/volumes/text/text_volume.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static void fail_count(struct job *job, const char *unit, unsigned long long found, unsigned long long wanted)
{
    job_bad(job, "voxels: found %llu %s, the header asks for %llu", found, unit, wanted);
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

/* Exactly `count` numbers of `type`, with white space between them, in this machine's order. */
static uint8_t *read_numbers(struct job *job, struct text text, size_t count, struct text_type type)
{
    struct text word;
    size_t found = 0;
    if (count > text.size / 2 + 1) { /* a digit and a space each */
        fail_count(job, "bytes of numbers", text.size, count);
    }
    uint8_t *out = job_raw(job, count, type.size);
    for (; out && job_ok(job) && text_word(&text, &word); found++) {
        if (found < count && !write_number(out + found * type.size, word, type)) {
            job_bad(job, "voxels: number %zu: found \"%.*s\", which is no number of the type", found,
                    HEADER_SHOW(word));
        }
    }
    if (job_ok(job) && found != count) {
        fail_count(job, "numbers", found, count);
    }
    return out;
}

/* Exactly `count` bytes of two hexadecimal digits, with white space anywhere. */
static uint8_t *read_hex(struct job *job, struct text text, size_t count)
{
    size_t digits = 0;
    unsigned byte = 0;
    if (count > text.size / 2) {
        fail_count(job, "hexadecimal digits at most", text.size, 2 * count);
    }
    uint8_t *out = job_raw(job, count, 1);
    for (size_t i = 0; out && job_ok(job) && i < text.size; i++) {
        int digit = base16_value(text.data[i]);
        bool is_space = digit < 0 && text.data[i] && strchr(" \t\r\n\v\f", text.data[i]);
        if (digit < 0 && !is_space) {
            job_bad(job, "voxels: byte %zu is no hexadecimal digit", i);
        } else if (digit >= 0) {
            byte = byte << 4 | (unsigned)digit;
            if (digits++ / 2 < count) {
                out[(digits - 1) / 2] = (uint8_t)byte;
            }
        }
    }
    if (job_ok(job) && digits != 2 * count) {
        fail_count(job, "hexadecimal digits", digits, 2 * count);
    }
    return out;
}

/* All voxels that the file has as text, decoded. */
static const uint8_t *decode(struct job *job, struct volume_input *v, size_t total)
{
    const struct text_volume *text = v->text;
    const struct bytes bytes = volume_bytes(job, v, v->voxels);
    if (v->run.begin + v->run.skip > bytes.size) {
        job_bad(job, "byte skip: found %llu, the file has %zu bytes of voxels", (unsigned long long)text->byte_skip,
                bytes.size - (size_t)v->run.begin);
    }
    if (!job_ok(job)) {
        return NULL;
    }
    const size_t from = (size_t)(v->run.begin + v->run.skip);
    const struct text rest = {(const char *)bytes.data + from, bytes.size - from};
    return text->encoding == TEXT_HEX ? read_hex(job, rest, total)
                                      : read_numbers(job, rest, total / text->type.size, text->type);
}

/* Gives voxels that are text, or of which all volumes' values of a voxel lie together. */
static void text_read(struct job *job, struct volume_input *v, size_t first, size_t count,
                      const struct voxel_sink *sink)
{
    enum { BLOCK = 4096 };
    uint8_t block[8 * BLOCK];
    const struct text_volume *text = v->text;
    const size_t size = text->type.size;
    const size_t voxels = v->header.volume_size / size;
    const size_t volumes = (size_t)text->count;
    const bool is_raw = text->encoding < TEXT_NUMBERS;
    const uint8_t *all = is_raw ? volume_run(job, v, 0, volumes).data : decode(job, v, volumes * v->header.volume_size);
    for (size_t i = 0; all && i < count * voxels && job_ok(job); i += BLOCK) {
        const size_t n = count * voxels - i < BLOCK ? count * voxels - i : BLOCK;
        for (size_t k = 0; k < n; k++) {
            const size_t volume = first + (i + k) / voxels;
            const size_t voxel = (i + k) % voxels;
            memcpy(block + k * size,
                   all + size * (text->interleaved ? voxel * volumes + volume : volume * voxels + voxel), size);
        }
        sink->take(job, sink->user, i, block, n);
    }
}

/* Stored bytes before the voxels: the header, and lines to skip. */
static uint64_t find_begin(struct job *job, struct volume_input *v)
{
    const struct text_volume *text = v->text;
    uint64_t at = v->header.offset;
    const struct bytes bytes = text->line_skip ? volume_bytes(job, v, v->voxels) : (struct bytes){0};
    for (uint64_t line = 0; line < text->line_skip && job_ok(job); line++) {
        const uint8_t *end = at < bytes.size ? memchr(bytes.data + at, '\n', bytes.size - at) : NULL;
        if (!end) {
            job_bad(job, "line skip: found %llu, the file has %llu lines before the voxels",
                    (unsigned long long)text->line_skip, (unsigned long long)line);
            break;
        }
        at = (uint64_t)(end - bytes.data) + 1;
    }
    return at;
}

/* Where the voxels are in their file, which may be packed as a whole, unless its header says how they are packed. */
static void find_run(struct job *job, struct volume_input *v, bool may_be_packed)
{
    static const char *const words[] = {"", ", gzip", ", zlib", ", text", ", hex"};
    const struct text_volume *text = v->text;
    const bool is_packed = may_be_packed && v->voxels->is_packed;
    const uint64_t total = v->header.info.volume_count * v->header.volume_size;
    const uint64_t size = v->voxels->file.before.size;
    if (!job_ok(job)) { /* there may be no header */
        return;
    }
    if (is_packed && text->encoding != TEXT_RAW) {
        job_refuse(job, "encoding: found voxels that are packed or text, in a file that is packed as a whole; allowed "
                        "there are raw voxels");
    } else if (is_packed && (text->at_end || text->line_skip)) {
        job_refuse(job, "%s: found in a file that is packed as a whole, allowed are bytes to skip",
                   text->at_end ? "voxels at the end" : "lines to skip");
    }
    v->run = (struct voxel_run){.begin = is_packed ? 0 : find_begin(job, v),
                                .skip = text->byte_skip + (is_packed ? v->header.offset : 0),
                                .packing = text->encoding == TEXT_ZLIB                ? RUN_ZLIB
                                           : is_packed || text->encoding == TEXT_GZIP ? RUN_GZIP
                                                                                      : RUN_PLAIN,
                                .packed_size = text->packed_size};
    if (text->at_end && size >= total) {
        v->run.begin = size - total;
        v->run.skip = 0;
    }
    v->encoding = is_packed ? ", gzip" : words[text->encoding];
    v->read = text->interleaved || text->encoding >= TEXT_NUMBERS ? text_read : NULL;
    v->scratch = v->read ? total : 0;
}

typedef void text_parse(struct job *job, struct text_volume *out, struct reader r);

static void read_header(struct job *job, struct volume_input *v, const struct source *header, text_parse *parse)
{
    struct text_volume *text = job_new(job, struct text_volume);
    if (!text) {
        return;
    }
    parse(job, text, source_reader(job, header));
    const int64_t dim[7] = {text->dim[0], text->dim[1], text->dim[2], text->count, 1, 1, 1};
    const bool is_native = text->encoding == TEXT_NUMBERS || text->type.size == 1;
    v->text = text;
    v->header.swapped = !is_native && text->big_endian == BIG_ENDIAN_IS_SWAPPED;
    v->header.offset = text->file || text->brik ? 0 : text->header_size;
    v->header.info.space_code = text->space_code;
    v->header.has_unit = text->has_unit;
    if (job_ok(job)) {
        snprintf(v->header.info.format, sizeof v->header.info.format, "%s", text->format);
        volume_describe(job, v, volume_datatype_of(text->type.kind, text->type.size), dim, text->world_from_voxel,
                        text->transform);
        v->embedded = text_from(text->labels ? text->labels : "");
    }
}

/* The voxels are in another file than the header, whose bytes belong to the sum. */
static void use_file(struct job *job, struct volume_input *v, const struct source *header, const struct source *voxels)
{
    v->voxels = voxels ? voxels : v->voxels;
    (void)volume_bytes(job, v, header);
}

static void open_text(struct job *job, struct volume_input *v, text_parse *parse)
{
    read_header(job, v, v->source, parse);
    if (!job_ok(job) || v->is_header_only) {
        return;
    }
    if (v->text->file) {
        const char *path = job_beside(job, v->keys.path, v->text->file);
        if (!job_has_file(job, path)) {
            job_fail(job, CONUS_ERROR_IO, "the file of the voxels is missing: %s", path);
            return;
        }
        use_file(job, v, v->source, volume_beside(job, path));
    }
    find_run(job, v, !v->text->file);
}

static void nrrd_open(struct job *job, struct volume_input *v)
{
    open_text(job, v, nrrd_parse);
}

static void metaimage_open(struct job *job, struct volume_input *v)
{
    open_text(job, v, metaimage_parse);
}

/* The .BRIK or .BRIK.gz beside the .HEAD. */
static const struct source *find_brik(struct job *job, const char *path)
{
    const size_t length = strlen(path) - path_ending_length(path, ".HEAD");
    if (!path[length]) {
        job_bad(job, "found the header of an AFNI data set, whose name must end in .HEAD");
        return NULL;
    }
    for (int packed = 0; packed < 2; packed++) {
        const char *brik = job_format(job, "%.*s.BRIK%s", (int)length, path, packed ? ".gz" : "");
        if (job_has_file(job, brik)) {
            return volume_beside(job, brik);
        }
    }
    job_fail(job, CONUS_ERROR_IO, "the file of the voxels is missing: %.*s.BRIK or %.*s.BRIK.gz", (int)length, path,
             (int)length, path);
    return NULL;
}

static void afni_open(struct job *job, struct volume_input *v)
{
    read_header(job, v, v->source, afni_parse);
    if (!v->is_header_only && job_ok(job)) {
        use_file(job, v, v->source, find_brik(job, v->keys.path));
        find_run(job, v, true);
    }
}

/* The voxels were named: results bear the name of the header, all the same. */
static void brik_open(struct job *job, struct volume_input *v)
{
    const char *path = v->keys.path;
    const size_t length = strlen(path) - path_ending_length(path, ".BRIK/.BRIK.gz");
    v->other = volume_beside(job, job_format(job, "%.*s.HEAD", (int)length, path));
    const struct format *format = v->other ? format_find(&v->other->head, ROLE_VOLUME) : NULL;
    if (v->other && !format) {
        source_refuse(job, v->other, v->needed);
    } else if (v->other && format->id != FORMAT_AFNI) {
        job_bad(job, "content: a .HEAD beside a .BRIK must be the header of an AFNI data set");
    } else if (v->other) {
        v->path = v->other->file.path;
        read_header(job, v, v->other, afni_parse);
        use_file(job, v, v->other, v->voxels);
        find_run(job, v, true);
    }
}

const struct volume_reader nrrd_reader = {.open = nrrd_open}, metaimage_reader = {.open = metaimage_open},
                           afni_reader = {.open = afni_open}, afni_brik_reader = {.open = brik_open};
