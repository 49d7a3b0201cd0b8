/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of formats of tractograms. */
#include "loaders/tracts/tract_file.h"

#include "base/formats/gzip.h"
#include "base/memory.h"
#include "loaders/file_kind.h"
#include "loaders/tracts/tract_formats.h"

/* A format reads a stream of bytes (`read`), or opens its file or folder itself (`open`). `head` has the first bytes,
 * unpacked; none for a folder. Messages of `read` lack the path, those of `open` have it. `has_lines`, unless NULL,
 * checks further whether the file is a tractogram. `states_mm`: points are always world mm. `space`: the axes in which
 * the format has its numbers; those that a header places come out in RAS, and nobody may say otherwise. */
static const struct tract_format {
    bool (*is)(const struct bytes *head, const char *path);
    tract_reader *read;
    conus_status (*open)(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes);
    bool (*has_lines)(const char *path);
    bool states_mm;
    enum { SPACE_OF_FILE, SPACE_RAS, SPACE_PLACED } space;
} formats[] = {
    {trk_is, trk_read, NULL, NULL, false, SPACE_PLACED}, /* where it has a matrix */
    {tck_is, tck_read, NULL, NULL, true, SPACE_RAS},
    {tt_is, tt_read, NULL, NULL, true, SPACE_PLACED},
    {trx_is, NULL, trx_read, trx_is_named, true, SPACE_RAS},
    {vtk_lines_is, NULL, vtk_lines_read, vtk_lines_are_in, false, SPACE_OF_FILE},
};

static const struct tract_format *format_of(const struct bytes *head, const char *path)
{
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        if (formats[i].is(head, path)) {
            return &formats[i];
        }
    }
    return NULL;
}

/* The first bytes, unpacked; none for a folder or damaged gzip. */
static conus_status read_head(struct bytes *out, const char *path)
{
    struct bytes stored = {0};
    conus_status status = file_is_folder(path) ? CONUS_OK : file_read_head(&stored, path, FILE_KIND_HEAD);
    *out = stored;
    if (!status && gzip_is(stored.data, stored.size)) {
        *out = (struct bytes){0};
        status = gzip_head(out, stored.data, stored.size, FILE_KIND_HEAD);
        status = status == CONUS_ERROR_DATA ? CONUS_OK : status;
        bytes_finish(&stored);
    }
    return status;
}

bool tract_file_is(const char *path)
{
    struct bytes head = {0};
    const struct tract_format *format = read_head(&head, path) ? NULL : format_of(&head, path);
    bytes_finish(&head);
    return format && (!format->has_lines || format->has_lines(path));
}

static conus_status check(struct tractogram *tractogram, struct notes *notes)
{
    tractogram->radius = TRACT_RADIUS;
    for (size_t i = 0; i < tractogram->scalar_count; i++) {
        for (size_t k = 0; k < i; k++) { /* callers ask for scalars by name */
            const struct tract_scalar *a = &tractogram->scalars[i];
            const struct tract_scalar *b = &tractogram->scalars[k];
            if (a->per_point == b->per_point && strcmp(a->name, b->name) == 0) {
                return fail(CONUS_ERROR_DATA, "scalars: found '%s' twice, each needs a name of its own", a->name);
            }
        }
    }
    conus_status status = tractogram_check(tractogram, notes);
    if (status || tractogram->streamline_count) {
        return status;
    }
    return notes_add(notes, "streamlines: the file has none");
}

/* Reads a whole stream, in one of the formats that are streams. */
static conus_status read_stream(struct tractogram *out, const struct tract_format *format, struct byte_stream *stream,
                                uint64_t max_memory, struct notes *notes)
{
    conus_status status = format->read(out, stream, memory_limit(max_memory), notes);
    return status ? status : byte_stream_sum(out->sha256, stream);
}

/* Brings points into RAS: from the axes that the user states, which count before those of the file. */
static conus_status settle_space(struct tractogram *tractogram, const struct tract_format *format,
                                 conus_file_space given, struct notes *notes)
{
    static const char *const names[] = {"", "RAS", "LPS"};
    unsigned char own = format->space == SPACE_OF_FILE ? tractogram->space : CONUS_FILE_SPACE_RAS;
    tractogram->space = given ? (unsigned char)given : own;
    if (given == CONUS_FILE_SPACE_LPS && format->space == SPACE_PLACED) {
        return fail(CONUS_ERROR_ARGUMENT, "space: found lps, but the header of this format places its points: RAS is "
                                          "allowed, or nothing");
    }
    if (tractogram->space == CONUS_FILE_SPACE_LPS) {
        tractogram_from_lps(tractogram);
    }
    return given && own && given != own
               ? notes_warn(notes, "points are taken for %s, as is stated, but the %s says %s", names[given],
                            format->space == SPACE_OF_FILE ? "file" : "format", names[own])
           : given || own ? CONUS_OK
                          : notes_add(notes, "the file does not state its space; RAS was taken (,space=lps states LPS, "
                                             "which DIPY writes)");
}

static conus_status read_format(struct tractogram *out, const struct tract_format *format, const char *path,
                                uint64_t max_memory, conus_file_space space, struct notes *notes)
{
    struct tractogram tractogram = {0};
    conus_status status;
    if (format->open) {
        status = format->open(&tractogram, path, memory_limit(max_memory), notes);
    } else {
        struct byte_stream stream = {0};
        status = byte_stream_open(&stream, path);
        status = status ? status : read_stream(&tractogram, format, &stream, max_memory, notes);
        byte_stream_finish(&stream);
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    if (!status) {
        tractogram.states_mm = tractogram.states_mm || format->states_mm;
        status = settle_space(&tractogram, format, space, notes);
        status = status ? status : check(&tractogram, notes);
        tractogram.path = status ? NULL : memory_text(path, strlen(path));
        status = status || tractogram.path ? status : CONUS_ERROR_MEMORY;
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    if (status) {
        tractogram_finish(&tractogram);
        return status;
    }
    *out = tractogram;
    return CONUS_OK;
}

conus_status tract_file_read(struct tractogram *out, const char *path, uint64_t max_memory, conus_file_space space,
                             struct notes *notes)
{
    struct bytes head = {0};
    conus_status status = read_head(&head, path);
    const struct tract_format *format = status ? NULL : format_of(&head, path);
    bytes_finish(&head);
    if (status) {
        return status;
    }
    if (format) {
        return read_format(out, format, path, max_memory, space, notes);
    }
    struct bytes stored = {0};
    status = file_read_head(&stored, path, FILE_KIND_HEAD);
    if (!status) { /* says what the file is instead; its name does not count, which may well be that of a tractogram */
        status = fail_in(
            file_kind_fail(NULL, &stored, "a tractogram: TrackVis, MRtrix, DSI Studio, TRX or polylines of VTK"), path);
    }
    bytes_finish(&stored);
    return status;
}

conus_status tract_file_parse(struct tractogram *out, const uint8_t *data, size_t size, uint64_t max_memory,
                              struct notes *notes)
{
    struct tractogram tractogram = {0};
    struct byte_stream stream = {0};
    conus_status status = byte_stream_of(&stream, data, size);
    status = status ? status : byte_stream_need(&stream, size < FILE_KIND_HEAD ? size : FILE_KIND_HEAD);
    const struct bytes head = {(uint8_t *)stream.data, stream.size};
    const struct tract_format *format = status ? NULL : format_of(&head, NULL);
    if (!status && !(format && format->read)) {
        status = fail(CONUS_ERROR_DATA, "content: no tractogram");
    }
    status = status ? status : read_stream(&tractogram, format, &stream, max_memory, notes);
    status = status ? status : check(&tractogram, notes);
    byte_stream_finish(&stream);
    if (status) {
        tractogram_finish(&tractogram);
        return status;
    }
    *out = tractogram;
    return CONUS_OK;
}
