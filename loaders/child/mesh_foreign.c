/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks conus-mesh or the cache for the meshes in files. */
#include "loaders/child/mesh_foreign.h"

#include "base/file.h"
#include "base/folder.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/child/mesh_cache.h"
#include "loaders/child/mesh_child.h"
#include "loaders/file_kind.h"

#include <stdio.h>
#include <string.h>

static const uint64_t default_memory = UINT64_C(8) << 30;
static const char *const endings[] = {".vtk", ".vtp", ".ply", ".stl", ".obj", NULL};

/* Counted up when conus-mesh makes something else of the same files, so that the cache forgets what it made before. */
#define READERS "readers 2"

struct reading {
    const char *const *paths;
    size_t count;
    const struct mesh_foreign_options *options;
    struct mesh *meshes; /* [count]; not used for objects */
    size_t done;
    struct mesh_parts *objects;      /* of the one file, and */
    struct label_table *names;       /* what they are called; NULL = files are read whole */
    size_t unstated, first_unstated; /* files without a word about their space */
    struct notes *notes;
    uint64_t size, largest;    /* of the files, in bytes */
    struct buffer *stream;     /* what came, for the cache; NULL when it comes from there */
    bool failed_in_file;       /* the message names it already */
    struct file_state *states; /* of the files, before their sums were taken */
};

static const char *ending_of(const char *path)
{
    for (size_t i = 0; endings[i]; i++) {
        if (path_ends_in(path, endings[i])) {
            return endings[i];
        }
    }
    return NULL;
}

bool mesh_foreign_is(const char *path)
{
    return ending_of(path) != NULL;
}

/* What the result follows from: what the files hold, and what their names say that they are. */
static conus_status append_recipe(struct buffer *out, struct reading *work)
{
    uint64_t limit = work->options->max_memory ? work->options->max_memory : default_memory;
    conus_status status = CONUS_OK;
    buffer_format(out, "conus %s " MESH_STREAM_MAGIC " " READERS " %s\n", conus_version(),
                  work->objects ? "objects" : "files");
    for (size_t i = 0; !status && i < work->count; i++) {
        struct bytes bytes = {0};
        char sum[65];
        const char *ending = ending_of(work->paths[i]);
        status = file_state_find(&work->states[i], work->paths[i]);
        status = status ? status : file_read_allowed(&bytes, work->paths[i], limit);
        if (!status) {
            file_sha256(sum, &bytes);
            buffer_format(out, "%s %s\n", sum, ending ? ending : "");
            work->size += bytes.size;
            work->largest = bytes.size > work->largest ? bytes.size : work->largest;
        }
        bytes_finish(&bytes);
    }
    return status ? status : buffer_status(out);
}

static conus_status keep_mesh(struct mesh *mesh, struct reading *work, const struct mesh_frame *frame, size_t file)
{
    static const double ras_from_lps[16] = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    enum mesh_space space = work->options->space ? work->options->space : frame->space;
    conus_status status = mesh_take_frame(mesh, frame, work->paths[file], work->notes, work->stream);
    if (!status && space == MESH_SPACE_LPS) {
        mesh_transform(mesh, ras_from_lps);
    }
    if (space == MESH_SPACE_UNSTATED && (!work->objects || !work->unstated)) {
        work->first_unstated = work->unstated++ ? work->first_unstated : file;
    }
    return status;
}

static conus_status keep_object(struct reading *work, const struct mesh_frame *frame)
{
    struct mesh_parts *objects = work->objects;
    struct mesh_part *parts = memory_resize(objects->parts, work->done + 1, sizeof *parts);
    if (!parts) {
        return CONUS_ERROR_MEMORY;
    }
    objects->parts = parts;
    parts[work->done] = (struct mesh_part){.label = (uint32_t)work->done + 1};
    conus_status status = keep_mesh(&parts[work->done].mesh, work, frame, 0);
    objects->count += !status;
    struct label *label = status ? NULL : label_table_add(work->names, parts[work->done].label);
    if (label && frame->text.size) {
        label->name = text_to_utf8(frame->text);
    }
    return status ? status : label && (label->name || !frame->text.size) ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Lines (streamlines) come in files of VTK's, too, and leave no triangle. */
static conus_status explain_failure(const struct reading *work)
{
    struct bytes bytes = {0};
    char said[512];
    snprintf(said, sizeof said, "%s", conus_message());
    uint64_t limit = work->options->max_memory ? work->options->max_memory : default_memory;
    bool lines = !file_read(&bytes, work->paths[work->objects ? 0 : work->done], limit) && file_kind_is_lines(&bytes);
    bytes_finish(&bytes);
    return lines ? fail(CONUS_ERROR_DATA,
                        "this is a VTK file of lines (a tractogram), not a surface: make a volume of its "
                        "density, for --pathway")
                 : fail(CONUS_ERROR_DATA, "%s", said);
}

static conus_status take_frame(void *user, const struct mesh_frame *frame)
{
    struct reading *work = user;
    if (frame->id != work->done || (work->done >= work->count && !work->objects)) {
        return fail(CONUS_ERROR_DATA, "mesh stream: file %u, %zu is next", frame->id, work->done);
    }
    conus_status status = frame->kind == MESH_FRAME_FAILURE ? fail(CONUS_ERROR_DATA, "%.*s", (int)frame->text.size,
                                                                   frame->text.size ? frame->text.data : "")
                          : work->objects                   ? keep_object(work, frame)
                                          : keep_mesh(&work->meshes[work->done], work, frame, work->done);
    if (status == CONUS_ERROR_DATA) {
        status = explain_failure(work);
    }
    if (status) {
        work->failed_in_file = true;
        return fail_in(status, work->paths[work->objects ? 0 : work->done]);
    }
    work->done++;
    return CONUS_OK;
}

static conus_status append_request(struct buffer *out, const struct reading *work)
{
    buffer_append(out, MESH_REQUEST_MAGIC, MESH_MAGIC_SIZE);
    mesh_append_u32(out, work->objects ? MESH_REQUEST_OBJECTS : MESH_REQUEST_FILES);
    mesh_append_u32(out, (uint32_t)work->count);
    for (size_t i = 0; i < work->count; i++) {
        mesh_append_u32(out, (uint32_t)strlen(work->paths[i]));
        buffer_text(out, work->paths[i]);
    }
    return buffer_status(out);
}

/* A number in a file takes 2 bytes or more, and what VTK makes of it some dozens: a file that asks for more than this
 * lies. VTK alone needs half a GiB of addresses. */
static struct mesh_child_limits limits_of(const struct reading *work)
{
    uint64_t most = work->options->max_memory ? work->options->max_memory : default_memory;
    uint64_t fair = (UINT64_C(1) << 30) + 64 * work->largest;
    uint32_t seconds = 10 + (uint32_t)(work->size / 1000000);
    return (struct mesh_child_limits){.memory = fair < most ? fair : most, .seconds = seconds, .wait = 6 * seconds};
}

/* conus-mesh must have read what the sums are of, or the cache would keep one file's surface for another's. */
static conus_status check_states(const struct reading *work)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < work->count; i++) {
        status = file_state_check(&work->states[i], work->paths[i]);
    }
    return status;
}

static conus_status run_child(struct reading *work, const char *key)
{
    struct mesh_child_request request = {0};
    struct buffer stream = {0};
    const struct mesh_child_limits limits = limits_of(work);
    work->stream = &stream;
    mesh_stream_start(&stream);
    conus_status status = append_request(&request.head, work);
    status = status ? status : mesh_child_run(&request, &limits, take_frame, work);
    if (status && !work->failed_in_file && work->done < work->count) { /* what the next file did to it */
        fail_in(status, work->paths[work->done]);
    }
    if (!status && work->done < work->count) {
        status = fail(CONUS_ERROR_DATA, "%s: conus-mesh could not read it", work->paths[work->done]);
    }
    mesh_stream_end(&stream, (uint32_t)work->done);
    status = status ? status : buffer_status(&stream);
    status = status ? status : check_states(work);
    status = status ? status : mesh_cache_keep(key, &stream);
    work->stream = NULL;
    buffer_finish(&stream);
    buffer_finish(&request.head);
    return status;
}

static conus_status read_all(struct reading *work)
{
    char key[MESH_CACHE_KEY_SIZE];
    struct buffer recipe = {0};
    struct bytes cached = {0};
    conus_status status = append_recipe(&recipe, work);
    if (!status) {
        mesh_cache_key(key, &recipe);
        status = mesh_cache_find(&cached, key, work->notes);
    }
    if (!status) {
        status = cached.data ? mesh_stream_read(cached.data, cached.size, take_frame, work) : run_child(work, key);
    }
    bytes_finish(&cached);
    buffer_finish(&recipe);
    return status;
}

static conus_status note_unstated(const struct reading *work)
{
    if (!work->unstated) {
        return CONUS_OK;
    }
    const char *path = work->paths[work->first_unstated];
    return work->unstated == 1
               ? notes_warn(work->notes, "%s does not state its space; RAS was taken", path)
               : notes_warn(work->notes, "%zu mesh files do not state their space, %s the first; RAS was taken",
                            work->unstated, path);
}

conus_status mesh_foreign_read(struct mesh *out, const char *const *paths, size_t count,
                               const struct mesh_foreign_options *options, struct notes *notes)
{
    static const struct mesh_foreign_options defaults;
    struct reading work = {.paths = paths, .count = count, .options = options ? options : &defaults, .notes = notes};
    if (!count) {
        return CONUS_OK;
    }
    work.meshes = memory_zeroed(count, sizeof *work.meshes);
    work.states = memory_zeroed(count, sizeof *work.states);
    conus_status status = work.meshes && work.states ? read_all(&work) : CONUS_ERROR_MEMORY;
    status = status ? status : note_unstated(&work);
    for (size_t i = 0; work.meshes && i < count; i++) {
        if (status) {
            mesh_finish(&work.meshes[i]);
        } else {
            out[i] = work.meshes[i];
        }
    }
    memory_free(work.meshes);
    memory_free(work.states);
    return status;
}

/* Objects have what is wrong with them in common, mostly: it is said once. */
static void drop_repeated(struct notes *notes)
{
    size_t kept = 0;
    for (size_t i = 0; i < notes->count; i++) {
        bool repeated = false;
        for (size_t k = 0; k < kept && !repeated; k++) {
            repeated = strcmp(notes->lines[k], notes->lines[i]) == 0;
        }
        if (repeated) {
            memory_free(notes->lines[i]);
        } else {
            notes->marks[kept] = notes->marks[i];
            notes->lines[kept++] = notes->lines[i];
        }
    }
    notes->count = kept;
}

conus_status mesh_foreign_objects(struct mesh_parts *parts, struct label_table *names, const char *path,
                                  const struct mesh_foreign_options *options, struct notes *notes)
{
    static const struct mesh_foreign_options defaults;
    struct mesh_parts objects = {0};
    struct file_state state = {0};
    struct notes own = {0};
    struct reading work = {
        .paths = &path, .count = 1, .options = options ? options : &defaults, .notes = &own, .objects = &objects};
    work.names = names;
    work.states = &state;
    conus_status status = read_all(&work);
    status = status ? status : note_unstated(&work);
    drop_repeated(&own);
    conus_status moved = notes_move(notes, &own);
    status = status ? status : moved;
    notes_finish(&own);
    if (status) {
        mesh_parts_finish(&objects);
        label_table_finish(names);
        return status;
    }
    *parts = objects;
    return CONUS_OK;
}
