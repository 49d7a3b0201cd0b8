/* SPDX-License-Identifier: BSD-3-Clause */
/* A surface as an atlas: one area, or as many as its vertices have labels. */
#include "loaders/scene/load_surface.h"

#include "atlas/atlas.h"
#include "atlas/surface/mesh_split.h"
#include "base/buffer.h"
#include "base/files/folder.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/mesh_foreign.h"
#include "loaders/surfaces/mesh_file.h"

#include <stdio.h>
#include <string.h>

struct surface {
    struct mesh mesh;
    struct label about;
    struct vertex_labels labels;
    struct mesh_parts parts;
    struct notes notes;
    struct buffer source;
    struct file_sums read; /* labels that lie in a file of their own */
};

static void surface_finish(struct surface *surface)
{
    mesh_finish(&surface->mesh);
    label_finish(&surface->about);
    vertex_labels_finish(&surface->labels);
    mesh_parts_finish(&surface->parts);
    notes_finish(&surface->notes);
    buffer_finish(&surface->source);
    file_sums_finish(&surface->read);
}

/* The whole surface is one area, number 1. */
static conus_status take_whole(struct surface *surface)
{
    label_table_finish(&surface->labels.table); /* of labels that no vertex has */
    struct label *label = label_table_add(&surface->labels.table, 1);
    surface->parts.parts = memory_zeroed(1, sizeof *surface->parts.parts);
    if (!label || !surface->parts.parts) {
        return CONUS_ERROR_MEMORY;
    }
    label->name = surface->about.name ? surface->about.name : mesh_file_name(surface->mesh.path);
    surface->about.name = NULL;
    surface->parts.parts[0] = (struct mesh_part){1, surface->mesh};
    surface->parts.count = 1;
    surface->mesh = (struct mesh){0};
    return label->name ? CONUS_OK : CONUS_ERROR_MEMORY;
}

static conus_status cut_surface(struct surface *surface, const char *path)
{
    struct vertex_labels *labels = &surface->labels;
    conus_status status = vertex_labels_extend(labels, surface->mesh.vertex_count);
    if (status) {
        return status;
    }
    if (labels->count != surface->mesh.vertex_count) {
        return fail(CONUS_ERROR_DATA, "%s: labels of %zu vertices, the surface %s has %zu", path, labels->count,
                    surface->mesh.path, surface->mesh.vertex_count);
    }
    return mesh_split(&surface->parts, &surface->mesh, labels->labels, &surface->notes);
}

/* Every object of the file is an area. */
static conus_status read_objects(struct surface *out, const char *path, const conus_load_options *options)
{
    const struct mesh_foreign_options foreign = {.max_memory = options->max_memory};
    conus_status status = mesh_foreign_objects(&out->parts, &out->labels.table, path, &foreign, &out->notes);
    for (size_t i = 0; !status && i < out->labels.table.count; i++) {
        struct label *label = &out->labels.table.entries[i];
        label->name = label->name ? label->name : mesh_file_name(path);
        status = label->name ? CONUS_OK : CONUS_ERROR_MEMORY;
    }
    buffer_format(&out->source, "the name in %s", path);
    return status ? status : buffer_status(&out->source);
}

static conus_status read_surface(struct surface *out, const char *path, const conus_load_options *options)
{
    const struct mesh_file_options file_options = {.max_memory = options->max_memory};
    struct mesh_file_options label_options = {.max_memory = options->max_memory};
    label_options.read = options->labels ? &out->read : NULL;
    label_options.surface = path;
    const char *labels = options->labels ? options->labels : path;
    if (options->labels && !mesh_file_keeps_vertices(path)) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "%s: labels of vertices need a surface that numbers its vertices, as all formats but STL do", path);
    }
    if (!options->labels && mesh_file_is_foreign(path)) {
        return read_objects(out, path, options);
    }
    conus_status status = mesh_file_read(&out->mesh, &out->about, path, &file_options, &out->notes);
    status = status ? status : vertex_labels_read(&out->labels, labels, &label_options, &out->notes);
    if (status) {
        return status;
    }
    bool whole = !options->labels && !out->labels.count;
    buffer_format(&out->source, whole ? "the name in %s" : "labels of vertices in %s", labels);
    status = buffer_status(&out->source);
    return status ? status : whole ? take_whole(out) : cut_surface(out, labels);
}

static conus_status add_area(conus_atlas *atlas, const struct surface *surface, struct mesh_part *part)
{
    char digits[LABEL_DIGITS];
    const struct label *known = label_table_find(&surface->labels.table, part->label);
    char hemisphere = surface->about.hemisphere ? surface->about.hemisphere : surface->labels.hemisphere;
    struct label label = known ? *known : (struct label){.number = part->label};
    label.abbreviation = NULL;
    label.hemisphere = hemisphere;
    const conus_object area = label_object(&label, atlas->object_count, digits);
    return atlas_add_mesh(atlas, &area, &part->mesh);
}

/* Names that have no triangle are no areas, which have a shape. */
static conus_status note_missing(conus_atlas *atlas, const struct surface *surface)
{
    enum { SHOWN = 4 };
    struct buffer names = {0};
    size_t count = 0;
    for (size_t i = 0; i < surface->labels.table.count; i++) {
        const struct label *label = &surface->labels.table.entries[i];
        if (label->name && !mesh_parts_find(&surface->parts, label->number) && count++ < SHOWN) {
            buffer_format(&names, "%s%s", count > 1 ? ", " : "", label->name);
        }
    }
    conus_status status = buffer_status(&names);
    if (!status && count) {
        status = notes_add(&atlas->notes, "names without a triangle: %zu (%s%s)", count, names.data,
                           count > SHOWN ? ", ..." : "");
    }
    buffer_finish(&names);
    return status;
}

static conus_status make_atlas(conus_atlas **out, struct surface *surface)
{
    conus_atlas *atlas = NULL;
    conus_status status = atlas_create_empty(&atlas, surface->source.data);
    if (!status) {
        atlas->notes.sink = surface->notes.sink;
    }
    for (size_t i = 0; !status && i < surface->parts.count; i++) {
        status = add_area(atlas, surface, &surface->parts.parts[i]);
    }
    status = status ? status : notes_move(&atlas->notes, &surface->notes);
    status = status ? status : note_missing(atlas, surface);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    *out = atlas;
    return CONUS_OK;
}

conus_status surface_load(conus_atlas **out, const char *path, const struct load_progress *progress)
{
    struct surface surface = {.notes.sink = &progress->sink};
    struct file_state state;
    conus_atlas *atlas = NULL;
    conus_status status = file_state_find(&state, path);
    status = status ? status : read_surface(&surface, path, progress->options);
    status = status ? status : make_atlas(&atlas, &surface);
    status = status ? status : atlas_note_file(atlas, path, &state);
    status = status ? status : file_sums_move(&atlas->files, &surface.read);
    surface_finish(&surface);
    if (status) {
        conus_atlas_destroy(atlas);
        return status;
    }
    *out = atlas;
    return CONUS_OK;
}
