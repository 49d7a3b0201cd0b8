/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads mesh files of other programs: the format, its parser, the space, and the objects of an OBJ. */
#include "loaders/surfaces/foreign/foreign.h"

#include "base/memory.h"
#include "loaders/refuse.h"
#include "loaders/surfaces/foreign/parts.h"
#include "sources/source.h"

#include <string.h>

struct reading {
    struct job *job;
    enum mesh_space space;      /* that is given */
    size_t unstated;            /* files without a word about their space, and */
    const char *first_unstated; /* the first of them */
};

static void parse(struct mesh_build *out, const char *path, const struct bytes *bytes)
{
    static mesh_parser *const parsers[] = {
        [FORMAT_OBJ] = obj_parse, [FORMAT_PLY] = ply_parse, [FORMAT_STL] = stl_parse, [FORMAT_OFF] = off_parse,
        [FORMAT_MZ3] = mz3_parse, [FORMAT_VTK] = vtk_parse, [FORMAT_VTP] = vtp_parse};
    const struct file_head head = head_of(path, bytes);
    const struct format *format = bytes->size ? format_find(&head, ROLE_SURFACE) : NULL;
    const size_t id = format ? format->id : FORMAT_OTHER;
    if (id < sizeof parsers / sizeof parsers[0] && parsers[id]) {
        parsers[id](&out->sink, (struct text){(const char *)bytes->data, bytes->size});
    } else {
        file_refuse(out->sink.job, path, bytes, "a surface (VTK, VTP, PLY, MZ3, or named as STL, OBJ or OFF)");
    }
}

/* Turns the mesh of the file `path` into the world and checks it. */
static void settle_mesh(struct mesh *mesh, const struct reading *work, const char *path, enum mesh_space stated)
{
    static const double ras_from_lps[16] = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    struct job *job = work->job;
    mesh->path = job_step(job) ? memory_text(path, strlen(path)) : NULL;
    if (!job_need(job, mesh->path) || !JOB_CALL(job, mesh_check_numbers(mesh))) {
        return;
    }
    if ((work->space ? work->space : stated) == MESH_SPACE_LPS) {
        mesh_transform(mesh, ras_from_lps);
    }
    (void)JOB_CALL(job, mesh_check(mesh, &job->notes));
}

static void note_space(struct reading *work, const char *path, enum mesh_space stated)
{
    if (!work->space && !stated && !work->unstated++) {
        work->first_unstated = path;
    }
}

static void say_unstated(const struct reading *work)
{
    if (work->unstated == 1) {
        job_note(work->job, "%s does not state its space; RAS was taken" MESH_SPACE_WAY, work->first_unstated);
    } else if (work->unstated) {
        job_note(work->job, "%zu mesh files do not state their space, %s the first; RAS was taken" MESH_SPACE_WAY,
                 work->unstated, work->first_unstated);
    }
}

/* Vertices of a whole, as they are numbered in a part of it. */
struct renumbering {
    uint32_t *numbers; /* [vertex_count] */
    uint32_t *parts;   /* [vertex_count] the part, from 1, that has given the number */
};

/* The triangles of object @p number, and the vertices that they use in the order in which they do. */
static void cut_object(struct mesh *out, const struct mesh_build *whole, const struct renumbering *vertices,
                       const uint32_t *triangles, size_t count, uint32_t number)
{
    struct job *job = whole->sink.job;
    const struct job_mark mark = job_mark(job);
    struct mesh_build part = mesh_build_of(job);
    for (size_t i = 0; i < 3 * count && job_ok(job); i++) {
        uint32_t vertex = whole->triangles.at[triangles[i / 3]].corners[i % 3];
        if (vertices->parts[vertex] != number + 1) {
            vertices->parts[vertex] = number + 1;
            vertices->numbers[vertex] = (uint32_t)part.sink.vertices.count;
            sink_vertex(&part.sink, whole->sink.vertices.at[vertex].at);
        }
        sink_corner(&part.sink, vertices->numbers[vertex]);
        if (i % 3 == 2) {
            sink_end(&part.sink, CELL_POLYGON);
        }
    }
    mesh_build_give(out, &part);
    job_release(job, mark);
}

/* Triangles in the order of their objects: those of object k end at (*ends)[k]. NULL after a failure. */
static uint32_t *sort_triangles(size_t **ends, const struct mesh_build *whole, size_t objects)
{
    struct job *job = whole->sink.job;
    size_t *next = job_zeroed(job, objects + 1, sizeof *next);
    uint32_t *triangles = job_raw(job, whole->triangles.count, sizeof *triangles);
    for (size_t i = 0; triangles && i < whole->triangles.count; i++) {
        next[whole->owners.at[i] + 1]++;
    }
    for (size_t k = 1; triangles && k <= objects; k++) {
        next[k] += next[k - 1];
    }
    for (size_t i = 0; triangles && i < whole->triangles.count; i++) {
        triangles[next[whole->owners.at[i]]++] = (uint32_t)i;
    }
    *ends = next;
    return triangles;
}

/* Where files go: each to a mesh, or its objects to parts with names. */
struct foreign_out {
    struct mesh *mesh;
    struct mesh_parts *parts;
    struct label_table *names;
};

/* Adds a part, whose mesh the caller makes; NULL after a failure. */
static struct mesh *add_part(struct job *job, const struct foreign_out *out, struct text name)
{
    struct mesh_parts *parts = out->parts;
    struct mesh_part *list = job_step(job) ? memory_resize(parts->parts, parts->count + 1, sizeof *list) : NULL;
    if (!job_need(job, list)) {
        return NULL;
    }
    parts->parts = list;
    list[parts->count] = (struct mesh_part){.label = (uint32_t)parts->count + 1};
    struct label *label = label_table_add(out->names, list[parts->count].label);
    if (label && name.size) {
        label->name = text_to_utf8(name);
    }
    return job_need(job, label && (label->name || !name.size) ? label : NULL) ? &list[parts->count++].mesh : NULL;
}

static void take_whole(struct mesh *out, struct mesh_build *build, struct reading *work, const char *path)
{
    const enum mesh_space stated = build->sink.space;
    mesh_build_give(out, build);
    settle_mesh(out, work, path, stated);
    note_space(work, path, stated);
}

static void take_objects(const struct foreign_out *out, struct mesh_build *whole, struct reading *work,
                         const char *path)
{
    struct job *job = work->job;
    const struct mesh_objects objects = mesh_build_objects(whole);
    size_t *ends;
    if (objects.count < 2) {
        struct mesh *mesh = add_part(job, out, objects.count ? objects.names[0] : (struct text){0});
        if (mesh) {
            take_whole(mesh, whole, work, path);
        }
        return;
    }
    note_space(work, path, whole->sink.space);
    const uint32_t *sorted = sort_triangles(&ends, whole, objects.count);
    const struct renumbering vertices = {job_raw(job, whole->sink.vertices.count, sizeof *vertices.numbers),
                                         job_zeroed(job, whole->sink.vertices.count, sizeof *vertices.parts)};
    for (size_t k = 0; k < objects.count && job_ok(job); k++) {
        struct mesh *mesh = add_part(job, out, objects.names[k]);
        const size_t from = k ? ends[k - 1] : 0;
        if (mesh) {
            cut_object(mesh, whole, &vertices, sorted + from, ends[k] - from, (uint32_t)k);
            settle_mesh(mesh, work, path, whole->sink.space);
        }
    }
}

static void read_file(const struct foreign_out *out, struct reading *work, const char *path)
{
    struct job *job = work->job;
    const struct job_mark mark = job_mark(job);
    const size_t place = job_in(job, path, JOB_ALONE);
    struct source *source = source_open(job, path);
    const struct bytes bytes = source_whole(job, source);
    struct mesh_build build = mesh_build_of(job);
    const struct attempt attempt = job_try(job);
    parse(&build, path, &bytes);
    struct notes *said = attempt_notes(job, &attempt); /* parsers do not know the path */
    if (said) {
        (void)JOB_CALL(job, notes_move_in(&job->notes, said, path));
    }
    if (out->parts) {
        take_objects(out, &build, work, path);
    } else {
        take_whole(out->mesh, &build, work, path);
    }
    if (job->status == CONUS_ERROR_DATA && format_is_lines(&bytes)) { /* which leave no triangle */
        (void)attempt_end(job, &attempt, ATTEMPT_DROP);
        job_bad(job, "this is a VTK file of lines (a tractogram), not a surface: give it as --streamlines, or a volume "
                     "of its density as --pathway");
    } else {
        (void)attempt_end(job, &attempt, said ? ATTEMPT_KEEP : ATTEMPT_SILENT);
    }
    job_out(job, place);
    job_release(job, mark);
}

void mesh_foreign_files(struct job *job, struct mesh *out, const char *const *paths, size_t count,
                        enum mesh_space space)
{
    struct reading work = {.job = job, .space = space};
    struct mesh *meshes = job_zeroed(job, count, sizeof *meshes);
    for (size_t i = 0; i < count && job_ok(job); i++) {
        read_file(&(struct foreign_out){.mesh = &meshes[i]}, &work, paths[i]);
    }
    say_unstated(&work);
    for (size_t i = 0; meshes && i < count; i++) {
        if (job_ok(job)) {
            out[i] = meshes[i];
        } else {
            mesh_finish(&meshes[i]);
        }
    }
}

/* Says a problem once: mostly all objects share it. */
static void move_notes(struct job *job, struct notes *from)
{
    for (size_t i = 0; from && i < from->count; i++) {
        bool repeated = false;
        for (size_t k = 0; k < i && !repeated; k++) {
            repeated = strcmp(from->lines[k], from->lines[i]) == 0;
        }
        if (!repeated) {
            job_put(job, from->marks[i].severity, "%s", from->lines[i]);
        }
    }
}

void mesh_foreign_objects(struct job *job, struct mesh_parts *parts, struct label_table *names, const char *path,
                          enum mesh_space space)
{
    struct reading work = {.job = job, .space = space};
    struct mesh_parts objects = {0};
    const struct attempt attempt = job_try(job);
    read_file(&(struct foreign_out){.parts = &objects, .names = names}, &work, path);
    say_unstated(&work);
    move_notes(job, attempt_notes(job, &attempt));
    (void)attempt_end(job, &attempt, ATTEMPT_KEEP);
    if (job_ok(job)) {
        *parts = objects;
    } else {
        mesh_parts_finish(&objects);
        label_table_finish(names);
    }
}
