/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads mesh files of other programs: the format, its parser, the space, and the objects of an OBJ. */
#include "loaders/surfaces/foreign/mesh_foreign.h"

#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/formats/gzip.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/refuse.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"

#include <stdio.h>
#include <string.h>

static const struct mesh_foreign_options defaults;

struct reading {
    const struct mesh_foreign_options *options;
    size_t unstated;            /* files without a word about their space, and */
    const char *first_unstated; /* the first of them */
    struct notes *notes;
};

static conus_status parse(struct foreign_mesh *out, struct obj_objects *objects, const char *path,
                          const struct bytes *bytes, uint64_t limit)
{
    const struct file_head head = head_of(path, bytes);
    const struct format *format = bytes->size ? format_find(&head, ROLE_SURFACE) : NULL;
    switch (format ? format->id : FORMAT_OTHER) {
    case FORMAT_OBJ:
        return obj_parse(out, objects, bytes->data, bytes->size);
    case FORMAT_PLY:
        return ply_parse(out, bytes->data, bytes->size);
    case FORMAT_STL:
        return stl_parse(out, bytes->data, bytes->size);
    case FORMAT_OFF:
        return off_parse(out, bytes->data, bytes->size);
    case FORMAT_MZ3:
        return mz3_parse(out, bytes->data, bytes->size);
    case FORMAT_VTK:
        return vtk_parse(out, bytes->data, bytes->size);
    case FORMAT_VTP:
        return vtp_parse(out, bytes->data, bytes->size, limit);
    default:
        break;
    }
    return file_refuse(path, bytes, "a surface (VTK, VTP, PLY, MZ3, or named as STL, OBJ or OFF)");
}

/* Lines (streamlines) come in files of VTK's, too, and leave no triangle. */
static conus_status explain_failure(conus_status status, const struct bytes *bytes)
{
    if (status == CONUS_ERROR_DATA && format_is_lines(bytes)) {
        return fail(CONUS_ERROR_DATA, "this is a VTK file of lines (a tractogram), not a surface: give it as "
                                      "--streamlines, or a volume of its density as --pathway");
    }
    return status;
}

/* Turns the mesh of the file @p path into the world and checks it. */
static conus_status settle_mesh(struct mesh *mesh, const struct reading *work, const char *path, enum mesh_space stated)
{
    static const double ras_from_lps[16] = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    enum mesh_space space = work->options->space ? work->options->space : stated;
    mesh->path = memory_text(path, strlen(path));
    conus_status status = mesh->path ? mesh_check_numbers(mesh) : CONUS_ERROR_MEMORY;
    if (!status && space == MESH_SPACE_LPS) {
        mesh_transform(mesh, ras_from_lps);
    }
    return status ? status : mesh_check(mesh, work->notes);
}

static void note_space(struct reading *work, const char *path, enum mesh_space stated)
{
    if (!work->options->space && !stated && !work->unstated++) {
        work->first_unstated = path;
    }
}

static conus_status say_unstated(const struct reading *work)
{
    if (!work->unstated) {
        return CONUS_OK;
    }
    const char *path = work->first_unstated;
    return work->unstated == 1
               ? notes_add(work->notes, "%s does not state its space; RAS was taken" MESH_SPACE_WAY, path)
               : notes_add(work->notes,
                           "%zu mesh files do not state their space, %s the first; RAS was taken" MESH_SPACE_WAY,
                           work->unstated, path);
}

static conus_status foreign_take_whole(struct mesh *out, struct foreign_mesh *foreign, struct reading *work,
                                       const char *path)
{
    struct mesh mesh = {0};
    conus_status status = foreign_mesh_take(&mesh, foreign);
    status = status ? status : settle_mesh(&mesh, work, path, foreign->space);
    if (status) {
        mesh_finish(&mesh);
        return status;
    }
    *out = mesh;
    note_space(work, path, foreign->space);
    return CONUS_OK;
}

static conus_status foreign_read_file(struct mesh *out, struct reading *work, const char *path)
{
    struct bytes bytes = {0};
    struct foreign_mesh foreign = {0};
    conus_status status = gzip_read(&bytes, path, memory_limit(work->options->max_memory), NULL);
    if (status) {
        return status;
    }
    status = parse(&foreign, NULL, path, &bytes, memory_limit(work->options->max_memory));
    status = status ? status : notes_move_in(work->notes, &foreign.notes, path);
    status = status ? status : foreign_take_whole(out, &foreign, work, path);
    status = explain_failure(status, &bytes);
    foreign_mesh_finish(&foreign);
    bytes_finish(&bytes);
    return status ? fail_in(status, path) : CONUS_OK;
}

conus_status mesh_foreign_read(struct mesh *out, const char *const *paths, size_t count,
                               const struct mesh_foreign_options *options, struct notes *notes)
{
    struct reading work = {.options = options ? options : &defaults, .notes = notes};
    struct mesh *meshes = memory_zeroed(count, sizeof *meshes);
    conus_status status = meshes ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        status = foreign_read_file(&meshes[i], &work, paths[i]);
    }
    status = status ? status : say_unstated(&work);
    for (size_t i = 0; meshes && i < count; i++) {
        if (status) {
            mesh_finish(&meshes[i]);
        } else {
            out[i] = meshes[i];
        }
    }
    memory_free(meshes);
    return status;
}

/* Vertices of a whole, as they are numbered in a part of it. */
struct renumbering {
    uint32_t *numbers; /* [vertex_count] */
    uint32_t *parts;   /* [vertex_count] the part, from 1, that has given the number */
};

/* The triangles of object @p number, and the vertices that they use in the order in which they do. */
static conus_status cut_object(struct mesh *out, const struct foreign_mesh *whole, const struct renumbering *vertices,
                               const uint32_t *triangles, size_t count, uint32_t number)
{
    struct foreign_mesh part = {0};
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 3 * count; i++) {
        uint32_t vertex = whole->triangles[3 * (size_t)triangles[i / 3] + i % 3];
        if (vertices->parts[vertex] != number + 1) {
            vertices->parts[vertex] = number + 1;
            vertices->numbers[vertex] = (uint32_t)part.vertex_count;
            status = foreign_add_vertex(&part, &whole->positions[3 * (size_t)vertex]);
        }
        status = status ? status : foreign_add_corner(&part, vertices->numbers[vertex]);
        if (!status && i % 3 == 2) {
            status = foreign_end_polygon(&part);
        }
    }
    status = status ? status : foreign_mesh_take(out, &part);
    foreign_mesh_finish(&part);
    return status;
}

/* Triangles in the order of their objects: those of object k end at ends[k]. */
static conus_status sort_triangles(uint32_t **sorted, size_t **ends, const struct obj_objects *objects, size_t count)
{
    size_t *next = memory_zeroed(objects->count + 1, sizeof *next);
    uint32_t *triangles = memory_raw(count, sizeof *triangles);
    if (!next || !triangles) {
        memory_free(next);
        memory_free(triangles);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        next[objects->owners[i] + 1]++;
    }
    for (size_t k = 1; k <= objects->count; k++) {
        next[k] += next[k - 1];
    }
    for (size_t i = 0; i < count; i++) {
        triangles[next[objects->owners[i]]++] = (uint32_t)i;
    }
    *sorted = triangles;
    *ends = next;
    return CONUS_OK;
}

/* Adds a part, whose mesh the caller makes; NULL without memory. */
static struct mesh *add_part(struct mesh_parts *parts, struct label_table *names, struct text name)
{
    struct mesh_part *list = memory_resize(parts->parts, parts->count + 1, sizeof *list);
    if (!list) {
        return NULL;
    }
    parts->parts = list;
    list[parts->count] = (struct mesh_part){.label = (uint32_t)parts->count + 1};
    struct label *label = label_table_add(names, list[parts->count].label);
    if (label && name.size) {
        label->name = text_to_utf8(name);
    }
    return label && (label->name || !name.size) ? &list[parts->count++].mesh : NULL;
}

static conus_status cut_objects(struct mesh_parts *parts, struct label_table *names, const struct foreign_mesh *whole,
                                const struct obj_objects *objects, const struct reading *work, const char *path)
{
    uint32_t *sorted = NULL;
    size_t *ends = NULL;
    const struct renumbering vertices = {memory_raw(whole->vertex_count, sizeof *vertices.numbers),
                                         memory_zeroed(whole->vertex_count, sizeof *vertices.parts)};
    conus_status status = vertices.numbers && vertices.parts ? CONUS_OK : CONUS_ERROR_MEMORY;
    status = status ? status : sort_triangles(&sorted, &ends, objects, whole->triangle_count);
    for (size_t k = 0; !status && k < objects->count; k++) {
        struct mesh *mesh = add_part(parts, names, objects->names[k]);
        size_t from = k ? ends[k - 1] : 0;
        status =
            mesh ? cut_object(mesh, whole, &vertices, sorted + from, ends[k] - from, (uint32_t)k) : CONUS_ERROR_MEMORY;
        status = status ? status : settle_mesh(mesh, work, path, whole->space);
    }
    memory_free(sorted);
    memory_free(ends);
    memory_free(vertices.numbers);
    memory_free(vertices.parts);
    return status;
}

/* Reports a problem once: mostly all objects share it. */
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

static conus_status read_objects(struct mesh_parts *parts, struct label_table *names, struct reading *work,
                                 const char *path)
{
    struct bytes bytes = {0};
    struct foreign_mesh foreign = {0};
    struct obj_objects objects = {0};
    conus_status status = gzip_read(&bytes, path, memory_limit(work->options->max_memory), NULL);
    if (status) {
        return status;
    }
    status = parse(&foreign, &objects, path, &bytes, memory_limit(work->options->max_memory));
    status = status ? status : notes_move_in(work->notes, &foreign.notes, path);
    if (!status && objects.count > 1) {
        note_space(work, path, foreign.space);
        status = cut_objects(parts, names, &foreign, &objects, work, path);
    } else if (!status) {
        struct mesh *mesh = add_part(parts, names, objects.count ? objects.names[0] : (struct text){0});
        status = mesh ? foreign_take_whole(mesh, &foreign, work, path) : CONUS_ERROR_MEMORY;
    }
    status = explain_failure(status, &bytes);
    obj_objects_finish(&objects);
    foreign_mesh_finish(&foreign);
    bytes_finish(&bytes);
    return status ? fail_in(status, path) : CONUS_OK;
}

conus_status mesh_foreign_objects(struct mesh_parts *parts, struct label_table *names, const char *path,
                                  const struct mesh_foreign_options *options, struct notes *notes)
{
    struct mesh_parts objects = {0};
    struct notes own = {0};
    struct reading work = {.options = options ? options : &defaults, .notes = &own};
    conus_status status = read_objects(&objects, names, &work, path);
    status = status ? status : say_unstated(&work);
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
