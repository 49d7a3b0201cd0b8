/* SPDX-License-Identifier: BSD-3-Clause */
/* The table of formats of tractograms. */
#include "loaders/tracts/tract_file.h"

#include "base/memory.h"
#include "loaders/refuse.h"
#include "loaders/tracts/tract_formats.h"
#include "sources/source.h"

/* A format reads a stream of bytes (`read`), or opens its file or folder itself (`open`). Messages of `read` lack the
 * path, those of `open` have it. `has_lines`, unless NULL, checks further whether the file is a tractogram.
 * `states_mm`: points are always world mm. `space`: the axes in which the format has its numbers; those that a header
 * places come out in RAS, and nobody may say otherwise. */
static const struct tract_format {
    enum format_id id;
    tract_reader *read;
    conus_status (*open)(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes);
    bool (*has_lines)(const char *path);
    bool states_mm;
    enum { SPACE_OF_FILE, SPACE_RAS, SPACE_PLACED } space;
} formats[] = {
    {FORMAT_TRK, trk_read, NULL, NULL, false, SPACE_PLACED}, /* where it has a matrix */
    {FORMAT_TCK, tck_read, NULL, NULL, true, SPACE_RAS},
    {FORMAT_TT, tt_read, NULL, NULL, true, SPACE_PLACED},
    {FORMAT_TRX, NULL, trx_read, trx_is_named, true, SPACE_RAS},
    {FORMAT_VTK, NULL, vtk_lines_read, vtk_lines_are_in, false, SPACE_OF_FILE},
    {FORMAT_VTP, NULL, vtk_lines_read, vtk_lines_are_in, false, SPACE_OF_FILE},
};

static const struct tract_format *format_reader(const struct format *format)
{
    for (size_t i = 0; format && i < sizeof formats / sizeof formats[0]; i++) {
        if (formats[i].id == format->id) {
            return &formats[i];
        }
    }
    return NULL;
}

bool tract_file_is(const char *path)
{
    const struct format *found;
    const struct tract_format *format = source_find(&found, path, ROLE_TRACTS) ? NULL : format_reader(found);
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
    struct source source;
    const struct format *found;
    conus_status status = source_find(&found, path, ROLE_TRACTS);
    if (status || found) {
        return status ? status : read_format(out, format_reader(found), path, max_memory, space, notes);
    }
    status = source_look(&source, path);
    if (!status) { /* says what it is instead; its name does not count, which may well be a tractogram's */
        status = fail_in(
            file_refuse(NULL, &source.stored, "a tractogram: TrackVis, MRtrix, DSI Studio, TRX or polylines of VTK"),
            path);
    }
    source_close(&source);
    return status;
}

conus_status tract_file_parse(struct tractogram *out, const uint8_t *data, size_t size, uint64_t max_memory,
                              struct notes *notes)
{
    struct tractogram tractogram = {0};
    struct byte_stream stream = {0};
    conus_status status = byte_stream_of(&stream, data, size);
    status = status ? status : byte_stream_need(&stream, size < HEAD_SIZE ? size : HEAD_SIZE);
    const struct file_head head = head_of(NULL, &(struct bytes){(uint8_t *)stream.data, stream.size});
    const struct tract_format *format = status ? NULL : format_reader(format_find(&head, ROLE_TRACTS));
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
