/* SPDX-License-Identifier: BSD-3-Clause */
/* From a tractogram to the bundles of an atlas: their radius, names and notes. */
#include "loaders/scene/load_streamlines.h"

#include "atlas/fit/tract_fit.h"
#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "base/text_number.h"
#include "conus/streamlines.h"
#include "loaders/tracts/tract_file.h"

#include <string.h>
#include <strings.h>
#include <sys/mman.h>

/* Length of a name without ".gz", and without the ending of a tractogram before it. */
static size_t stem_length(const char *name, size_t length)
{
    static const char *const endings[] = {".gz", ".tck", ".trk", ".trx", ".vtk", ".vtp", ".tt"};
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        size_t size = strlen(endings[i]);
        if (length > size && strncasecmp(name + length - size, endings[i], size) == 0) {
            length -= size;
        }
    }
    return length;
}

/* The name that is wanted, else that of the file or folder without its endings. */
static conus_status name_bundle(struct buffer *out, const char *wanted, const char *path)
{
    if (wanted && wanted[0]) {
        buffer_text(out, wanted);
        return buffer_status(out);
    }
    size_t end = strlen(path);
    while (end > 1 && path[end - 1] == '/') {
        end--;
    }
    size_t start = end;
    while (start > 0 && path[start - 1] != '/') {
        start--;
    }
    buffer_append(out, path + start, stem_length(path + start, end - start));
    return buffer_status(out);
}

size_t streamlines_stem_length(const char *name)
{
    return stem_length(name, strlen(name));
}

conus_status streamlines_radius(double *out, double wanted, const char *path)
{
    char text[TEXT_NUMBER_SIZE];
    if (!(wanted >= 0 && wanted <= TRACT_RADIUS_LIMIT)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: radius %s mm, allowed is above 0 to %g", path, text_number(text, wanted),
                    TRACT_RADIUS_LIMIT);
    }
    *out = wanted > 0 ? wanted : TRACT_RADIUS;
    return CONUS_OK;
}

conus_status streamlines_add(conus_atlas *atlas, struct tractogram *tractogram, const char *name, struct notes *notes)
{
    struct buffer chosen = {0};
    size_t note_count = atlas->notes.count;
    size_t file_count = atlas->files.count;
    conus_status status = name_bundle(&chosen, name, tractogram->path);
    status = status ? status : notes_move_in(&atlas->notes, notes, path_base(tractogram->path));
    status = status ? status : tract_fit_note(notes, atlas, tractogram, chosen.data);
    status = status ? status : notes_move(&atlas->notes, notes);
    status = status ? status : file_sums_move(&atlas->files, &tractogram->files);
    status = status ? status : atlas_add_tractogram(atlas, tractogram, chosen.data);
    if (status) {
        file_sums_cut(&atlas->files, file_count);
        notes_cut(&atlas->notes, note_count);
    }
    buffer_finish(&chosen);
    return status;
}

/* An atlas of one tractogram, which is empty; NULL without memory. */
static conus_atlas *make_alone(void)
{
    conus_atlas *atlas = memory_zeroed(1, sizeof *atlas);
    struct tractogram *tractogram = memory_zeroed(1, sizeof *tractogram);
    if (!atlas || !tractogram) {
        memory_free(atlas);
        memory_free(tractogram);
        return NULL;
    }
    atlas->tractograms = tractogram;
    atlas->tractogram_count = 1;
    return atlas;
}

/* Gives the mapped file to a tractogram that has points there, and to nobody else. */
static conus_status end_mapping(struct tractogram *tractogram, const char *path, const struct bytes *mapped,
                                const struct file_state *before)
{
    if (tractogram->is_in_file) {
        tractogram->file_mapped = mapped->data;
        tractogram->file_mapped_size = mapped->size;
    } else {
        munmap(mapped->data, mapped->size);
    }
    return file_state_check(before, path);
}

conus_status streamlines_load(conus_atlas **out, const char *path, const conus_load_options *options,
                              conus_file_space space, bool maps)
{
    struct file_state before;
    struct bytes mapped = {0};
    const struct note_sink sink = {options->log, options->log_user, path};
    struct notes notes = {.sink = &sink};
    conus_atlas *atlas = make_alone();
    if (!atlas) {
        return CONUS_ERROR_MEMORY;
    }
    struct tractogram *tractogram = atlas->tractograms;
    if (maps && !file_state_find(&before, path) && (mapped.data = file_map(path, &before))) {
        mapped.size = (size_t)before.size;
    }
    conus_status status = tract_file_read(tractogram, path, &mapped, options->max_memory, space, &notes);
    status = status ? status : notes_move(&atlas->notes, &notes);
    status = status ? status : file_sums_move(&atlas->files, &tractogram->files);
    status = status ? status : bundles_ready(tractogram);
    if (mapped.data) {
        conus_status ended = end_mapping(tractogram, path, &mapped, &before);
        status = status ? status : ended;
    }
    notes_finish(&notes);
    return atlas_give(out, atlas, status);
}

/* The names are copied, since an atlas may change them; the numbers are borrowed. */
static conus_status borrow_tractogram(struct tractogram *out, const struct tractogram *from)
{
    *out = *from;
    out->has_borrowed_points = out->is_borrowed = true;
    out->mapped = out->file_mapped = NULL;
    out->files = (struct file_sums){0};
    out->path = memory_text(from->path, strlen(from->path));
    out->scalars = memory_copy(from->scalars, from->scalar_count, sizeof *out->scalars);
    out->groups = memory_copy(from->groups, from->group_count, sizeof *out->groups);
    bool failed = !out->path || !out->scalars || !out->groups;
    for (size_t i = 0; i < from->scalar_count && out->scalars; i++) {
        const char *name = from->scalars[i].name;
        out->scalars[i].name = memory_text(name, strlen(name));
        failed = failed || !out->scalars[i].name;
    }
    for (size_t i = 0; i < from->group_count && out->groups; i++) {
        const char *name = from->groups[i].name;
        out->groups[i].name = memory_text(name, strlen(name));
        failed = failed || !out->groups[i].name;
    }
    out->scalar_count = out->scalars ? from->scalar_count : 0;
    out->group_count = out->groups ? from->group_count : 0;
    return failed ? CONUS_ERROR_MEMORY : CONUS_OK;
}

conus_status streamlines_borrow(conus_atlas **out, const conus_atlas *alone)
{
    conus_atlas *atlas = make_alone();
    if (!atlas) {
        return CONUS_ERROR_MEMORY;
    }
    conus_status status = borrow_tractogram(atlas->tractograms, &alone->tractograms[0]);
    for (size_t i = 0; i < alone->notes.count && !status; i++) {
        status = notes_put(&atlas->notes, alone->notes.marks ? alone->notes.marks[i].severity : CONUS_SEVERITY_NOTE,
                           "%s", alone->notes.lines[i]);
    }
    for (size_t i = 0; i < alone->files.count && !status; i++) {
        status = file_sums_put(&atlas->files, alone->files.items[i].path, alone->files.items[i].sha256);
    }
    return atlas_give(out, atlas, status);
}

conus_status streamlines_take(conus_atlas *atlas, conus_atlas *alone, double radius,
                              const conus_streamlines_options *options)
{
    struct tractogram *tractogram = &alone->tractograms[0];
    const struct note_sink sink = {options->log, options->log_user, tractogram->path};
    struct notes notes = alone->notes;
    notes.sink = &sink;
    alone->notes = (struct notes){0};
    tractogram->radius = radius;
    tractogram->mapped = alone->mapped;
    tractogram->mapped_size = alone->mapped_size;
    alone->mapped = NULL;
    conus_status status = file_sums_move(&tractogram->files, &alone->files);
    status = status ? status : streamlines_add(atlas, tractogram, options->name, &notes);
    notes_finish(&notes);
    conus_atlas_destroy(alone);
    return status;
}

bool conus_path_is_tractogram(const char *path)
{
    return path && tract_file_is(path);
}
