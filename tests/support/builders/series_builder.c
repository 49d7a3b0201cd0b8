/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a packed 4-D file, its index, and opens volumes of it. */
#include "builders/series_builder.h"

#include "base/system/system.h"
#include "builders/nifti_builder.h"
#include "conus/cache.h"
#include "loaders/volumes/stored/stored_file.h"
#include "test.h"

#include <fcntl.h>
#include <libdeflate.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

uint8_t series_voxel(size_t volume, size_t i)
{
    uint64_t mixed = (i ^ volume << 32) * UINT64_C(0x9e3779b97f4a7c15);
    mixed = (mixed ^ mixed >> 29) * UINT64_C(0xbf58476d1ce4e5b9);
    return (uint8_t)((mixed >> 40) % 50);
}

void append_fast_gzip(struct buffer *out, const char *data, size_t size)
{
    struct libdeflate_compressor *compressor = libdeflate_alloc_compressor(1);
    size_t most = libdeflate_gzip_compress_bound(compressor, size);
    char *packed = malloc(most);
    size_t used = libdeflate_gzip_compress(compressor, data, size, packed, most);
    assert_true(used > 0);
    buffer_append(out, packed, used);
    free(packed);
    libdeflate_free_compressor(compressor);
}

static void fill_volumes(struct buffer *out, size_t first)
{
    for (size_t k = 0; k < SERIES_COUNT; k++) {
        uint8_t *voxels = malloc(SERIES_VOLUME);
        for (size_t i = 0; i < SERIES_VOLUME; i++) {
            voxels[i] = series_voxel(first + k, i);
        }
        buffer_append(out, voxels, SERIES_VOLUME);
        free(voxels);
    }
}

const char *series_make(const char *name, size_t first, size_t member)
{
    static const int64_t dim[3] = {SERIES_EDGE, SERIES_EDGE, SERIES_PLANES};
    struct nifti_builder builder;
    struct buffer packed = {0};
    nifti_begin(&builder, 1, false, 2 /* uint8 */, dim);
    nifti_set(&builder, "dim", 0, 4);
    nifti_set(&builder, "dim", 4, SERIES_COUNT);
    assert_int_equal(builder.bytes.size, SERIES_HEAD);
    fill_volumes(&builder.bytes, first);
    for (size_t at = 0; at < builder.bytes.size; at += member) {
        size_t left = builder.bytes.size - at;
        append_fast_gzip(&packed, builder.bytes.data + at, left < member ? left : member);
    }
    const char *path = write_bytes(name, &packed);
    buffer_finish(&builder.bytes);
    buffer_finish(&packed);
    return path;
}

#define NRRD_HEADER(more)                                                                                              \
    "NRRD0004\ntype: uchar\ndimension: 4\nspace: LPS\nsizes: 128 128 64 17\n"                                          \
    "space directions: (1,0,0) (0,1,0) (0,0,1) none\nkinds: domain domain domain list\nspace origin: (0,0,0)\n" more
#define METAIMAGE_HEADER(file)                                                                                         \
    "ObjectType = Image\nNDims = 4\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = True\n"        \
    "TransformMatrix = 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\nOffset = 0 0 0 0\nElementSpacing = 1 1 1 1\n"                  \
    "DimSize = 128 128 64 17\nElementType = MET_UCHAR\nElementDataFile = " file "\n"

static const struct {
    const char *name, *voxels; /* of the file to open, and of another one or NULL */
    bool zlib;
    const char *header;
} forms[SERIES_FORMS] = {
    [SERIES_BRIK] = {"series+orig.HEAD", "series+orig.BRIK.gz", false,
                     "\ntype = integer-attribute\nname = DATASET_RANK\ncount = 8\n 3 17 0 0 0\n 0 0 0\n"
                     "\ntype = integer-attribute\nname = DATASET_DIMENSIONS\ncount = 5\n 128 128 64 0 0\n"
                     "\ntype = integer-attribute\nname = BRICK_TYPES\ncount = 17\n"
                     " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"
                     "\ntype = integer-attribute\nname = ORIENT_SPECIFIC\ncount = 3\n 1 2 4\n"
                     "\ntype  = float-attribute\nname  = ORIGIN\ncount = 3\n 10 20 30\n"
                     "\ntype  = float-attribute\nname  = DELTA\ncount = 3\n -2 -3 4\n"},
    [SERIES_NRRD_WHOLE] = {"whole.nrrd.gz", NULL, false, NRRD_HEADER("encoding: raw\n\n")},
    [SERIES_NRRD] = {"series.nrrd", NULL, false, NRRD_HEADER("encoding: gzip\n\n")},
    [SERIES_NRRD_APART] = {"series.nhdr", "series.raw.gz", false,
                           NRRD_HEADER("encoding: gzip\ndata file: series.raw.gz\n\n")},
    [SERIES_METAIMAGE] = {"series.mha", NULL, true, METAIMAGE_HEADER("LOCAL")},
    [SERIES_METAIMAGE_APART] = {"series.mhd", "series.zraw", true, METAIMAGE_HEADER("series.zraw")},
};

static void append_fast_zlib(struct buffer *out, const char *data, size_t size)
{
    struct libdeflate_compressor *compressor = libdeflate_alloc_compressor(1);
    size_t most = libdeflate_zlib_compress_bound(compressor, size);
    char *packed = malloc(most);
    size_t used = libdeflate_zlib_compress(compressor, data, size, packed, most);
    assert_true(used > 0);
    buffer_append(out, packed, used);
    free(packed);
    libdeflate_free_compressor(compressor);
}

/* All voxels as one stream, which is packed again only if it differs from the last one; static. */
static const struct buffer *pack_voxels(bool zlib, size_t first)
{
    static struct buffer packed[2];
    static size_t firsts[2];
    if (!packed[zlib].size || firsts[zlib] != first) {
        struct buffer voxels = {0};
        buffer_clear(&packed[zlib]);
        fill_volumes(&voxels, first);
        (zlib ? append_fast_zlib : append_fast_gzip)(&packed[zlib], voxels.data, voxels.size);
        firsts[zlib] = first;
        buffer_finish(&voxels);
    }
    return &packed[zlib];
}

const char *series_make_as(enum series_form form, size_t first)
{
    const struct buffer *voxels = pack_voxels(forms[form].zlib, first);
    struct buffer file = {0};
    const char *header = forms[form].header;
    bool apart = forms[form].voxels;
    if (form == SERIES_NRRD_WHOLE) {
        append_fast_gzip(&file, header, strlen(header)); /* a separate member */
    } else if (!apart) {
        buffer_text(&file, header);
    }
    buffer_append(&file, voxels->data, voxels->size);
    const char *path = write_bytes(apart ? forms[form].voxels : forms[form].name, &file);
    if (apart) {
        buffer_clear(&file);
        buffer_text(&file, header);
        path = write_bytes(forms[form].name, &file);
    }
    buffer_finish(&file);
    return path;
}

const char *series_voxels_of(const char *path, enum series_form form)
{
    static char voxels[8192];
    const char *name = forms[form].voxels ? forms[form].voxels : forms[form].name;
    snprintf(voxels, sizeof voxels, "%.*s/%s", (int)(strrchr(path, '/') - path), path, name);
    return voxels;
}

static time_t ahead; /* seconds that the clock of the day is */

/* Replaces the C library's. */
int clock_gettime(clockid_t clock, struct timespec *out)
{
    int code = (int)syscall(SYS_clock_gettime, clock, out);
    out->tv_sec += clock == CLOCK_REALTIME ? ahead : 0;
    return code;
}

void series_open_rested(const char *path)
{
    struct volume_file file = {0};
    ahead = 2 * (time_t)TRACE_REST_ELSEWHERE_SECONDS;
    assert_ok(series_open(&file, path, 0, true));
    ahead = 0;
    series_assert(&file, 0);
    volume_file_finish(&file);
}

const char *series_path(void)
{
    static char path[8192];
    if (!path[0]) {
        snprintf(path, sizeof path, "%s", series_make("series.nii.gz", 0, SIZE_MAX));
    }
    return path;
}

conus_status series_open(struct volume_file *out, const char *path, size_t volume, bool cache)
{
    char chosen[8300];
    struct notes notes = {0};
    snprintf(chosen, sizeof chosen, "%s,volume=%zu", path, volume);
    conus_status status = volume_file_open_cached(out, chosen, 0, cache, &notes);
    assert_true(status || notes.count == 0);
    notes_finish(&notes);
    return status;
}

void series_assert(const struct volume_file *file, size_t number)
{
    size_t wrong = 0;
    assert_int_equal(file->voxels.size, SERIES_VOLUME);
    for (size_t i = 0; i < SERIES_VOLUME; i++) {
        wrong += file->voxels.data[i] != series_voxel(number, i);
    }
    assert_int_equal(wrong, 0);
}

bool series_opens_by_index(const char *path, size_t volume)
{
    struct volume_file file = {0};
    test_limit_allocations(SERIES_MEMORY);
    conus_status status = series_open(&file, path, volume, true);
    test_limit_allocations(0);
    assert_true(!status || status == CONUS_ERROR_MEMORY);
    if (!status) {
        series_assert(&file, volume);
    }
    volume_file_finish(&file);
    return !status;
}

void series_assert_opens(const char *path, size_t volume, size_t first)
{
    struct volume_file file = {0};
    assert_ok(series_open(&file, path, volume, true));
    series_assert(&file, first + volume);
    volume_file_finish(&file);
}

void series_index(const char *path, bool rested)
{
    struct stored stored = {0};
    struct bytes out = {0};
    char sum[65];
    struct gzip_range range = {
        .from = SERIES_HEAD, .count = 10, .total = SERIES_HEAD + (size_t)SERIES_COUNT * SERIES_VOLUME};
    assert_ok(stored_open(&stored, path, UINT64_MAX, STORED_KEEP, NULL));
    stored.keeper->trace.begun.tv_sec += rested ? 2 * TRACE_REST_ELSEWHERE_SECONDS : 0;
    file_sha256(sum, &stored.bytes);
    assert_ok(stored_range(&out, &range, &stored, sum));
    bytes_finish(&out);
    stored_finish(&stored);
}

bool series_is_indexed(const char *path)
{
    struct kept_index kept;
    bool found = kept_index_open(&kept, path, NULL);
    if (found) {
        kept_index_finish(&kept);
    }
    return found;
}

const char *series_entry(void)
{
    static char path[8192];
    conus_cache *cache = NULL;
    path[0] = '\0';
    assert_ok(conus_cache_create(&cache));
    for (size_t i = 0; i < conus_cache_count(cache); i++) {
        const conus_cache_entry *entry = conus_cache_entry_at(cache, i);
        if (strcmp(entry->kind, "index") == 0) {
            snprintf(path, sizeof path, "%s/%s", conus_cache_folder(cache), entry->file);
        }
    }
    conus_cache_destroy(cache);
    return path;
}

void series_need_index(void)
{
    if (!series_is_indexed(series_path())) {
        series_index(series_path(), true);
    }
}

void overwrite_file(const char *path, const void *data, size_t size)
{
    int file = open(path, O_WRONLY | O_TRUNC | O_CLOEXEC);
    assert_true(file >= 0);
    assert_true(system_write(file, data, size));
    close(file);
}

void series_forge(const char *entry, const struct bytes *bytes, const uint8_t *packed)
{
    struct cache_entry parts;
    struct buffer forged = {0};
    assert_true(cache_entry_parse(&parts, bytes->data, bytes->size));
    parts.packed_crc = cache_crc(0, packed, parts.packed.size);
    cache_entry_write(&forged, &parts);
    buffer_append(&forged, packed, parts.packed.size);
    overwrite_file(entry, forged.data, forged.size);
    buffer_finish(&forged);
}
