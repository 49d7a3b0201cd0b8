/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists what an atlas has: its objects, surfaces around it, tractograms, other files and notes. */
#include "selection/table/table.h"

#include "base/memory.h"
#include "base/status.h"
#include "conus/own.h"

#include <string.h>

struct object_row {
    struct table_object object;
    const char *prefix, *side;
    uint32_t depth, parent;
    uint64_t is_hidden;
};

static const struct table_field object_fields[] = {
    TABLE_IDENTITY,
    {"prefix", NULL, "the word that tells it from others of its name: bundle, left; n/a where no name is shared",
     TABLE_OF(TEXT, struct object_row, prefix)},
    {"side", NULL, "left or right, by the label table, a pair, the name or the area above; n/a of both and of none",
     TABLE_OF(TEXT, struct object_row, side)},
    {"depth", NULL, "depth of an area in the tree, 1 for roots; n/a of pathways and bundles",
     TABLE_OF(RANK, struct object_row, depth)},
    {"parent", NULL, "number of the object that contains it in the area tree; n/a of roots",
     TABLE_OF(RANK, struct object_row, parent)},
    {"hidden", NULL, "1 of an object that is as if it had never been loaded, else 0",
     TABLE_OF(LARGE_COUNT, struct object_row, is_hidden)},
};
static const struct table_fields object_columns = TABLE_FIELDS(object_fields);

static conus_status list_objects(conus_table **out, const conus_atlas *atlas)
{
    const size_t count = conus_atlas_object_count(atlas);
    struct object_row *rows = memory_zeroed(count, sizeof *rows);
    char *sides = memory_zeroed(count + 1, sizeof *sides);
    const char **prefixes = memory_zeroed(count + 1, sizeof *prefixes);
    conus_status status = rows && sides && prefixes ? conus_atlas_sides(sides, atlas) : CONUS_ERROR_MEMORY;
    status = status ? status : conus_atlas_prefixes(prefixes, atlas);
    for (size_t number = 1; number <= count && !status; number++) {
        const conus_object *object = conus_atlas_object(atlas, number);
        rows[number - 1] = (struct object_row){
            .object = {object->kind, (uint32_t)number},
            .prefix = prefixes[number],
            .side = sides[number] == 'L' ? "left"
                    : sides[number]      ? "right"
                                         : NULL,
            .depth = conus_atlas_depth(atlas, number),
            .parent = object->parent,
            .is_hidden = conus_atlas_is_hidden(atlas, number),
        };
    }
    memory_free(sides);
    memory_free((void *)prefixes);
    if (status) {
        memory_free(rows);
        return status;
    }
    return table_of_rows(out, atlas, &object_columns, rows, sizeof *rows, count);
}

/* The corners of the box around the points of a row. */
#define BOX_FIELDS(row)                                                                                                \
    {"low_x", "mm", "lowest x of its points, world", TABLE_OF(NUMBER, row, low[0])},                                   \
        {"low_y", "mm", "lowest y", TABLE_OF(NUMBER, row, low[1])},                                                    \
        {"low_z", "mm", "lowest z", TABLE_OF(NUMBER, row, low[2])},                                                    \
        {"high_x", "mm", "highest x", TABLE_OF(NUMBER, row, high[0])},                                                 \
        {"high_y", "mm", "highest y", TABLE_OF(NUMBER, row, high[1])},                                                 \
    {                                                                                                                  \
        "high_z", "mm", "highest z", TABLE_OF(NUMBER, row, high[2])                                                    \
    }

struct surface_row {
    struct table_object object;
    const char *path, *hemisphere;
    uint64_t vertices, triangles, is_closed;
    double opacity, low[3], high[3];
};

static const struct table_field surface_fields[] = {
    {"path", NULL, "its file: bytes, not always UTF-8", TABLE_OF(TEXT, struct surface_row, path)},
    {"hemisphere", NULL, "left, right or both, as its file says", TABLE_OF(TEXT, struct surface_row, hemisphere)},
    {"vertices", NULL, "vertices in the file", TABLE_OF(LARGE_COUNT, struct surface_row, vertices)},
    {"triangles", NULL, "triangles that have an area", TABLE_OF(LARGE_COUNT, struct surface_row, triangles)},
    {"closed", NULL, "1 where every edge is of two triangles, so that it has an inside, else 0",
     TABLE_OF(LARGE_COUNT, struct surface_row, is_closed)},
    {"opacity", NULL, "above 0 to 1", TABLE_OF(NUMBER, struct surface_row, opacity)},
    BOX_FIELDS(struct surface_row),
};
static const struct table_fields surface_columns = TABLE_FIELDS(surface_fields);

static void tell_surface(struct surface_row *row, const conus_atlas *atlas, size_t index)
{
    conus_context_surface surface = CONUS_CONTEXT_SURFACE_INIT;
    if (conus_atlas_context_surface(&surface, atlas, index)) {
        return; /* past the last */
    }
    const char side = surface.hemisphere;
    row->path = surface.path;
    row->hemisphere = side == 'L' ? "left" : side == 'R' ? "right" : side == 'B' ? "both" : NULL;
    row->vertices = surface.vertices;
    row->triangles = surface.triangles;
    row->is_closed = surface.closed;
    row->opacity = surface.opacity;
    memcpy(row->low, surface.low, sizeof row->low);
    memcpy(row->high, surface.high, sizeof row->high);
}

static conus_status list_surfaces(conus_table **out, const conus_atlas *atlas)
{
    const size_t count = conus_atlas_context_surface_count(atlas);
    struct surface_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        tell_surface(&rows[i], atlas, i);
    }
    return table_of_rows(out, atlas, &surface_columns, rows, sizeof *rows, count);
}

struct tractogram_row {
    struct table_object object;
    const char *path, *format, *sha256;
    uint64_t streamlines, points, bundles, scalars, is_half;
    double length_mm, radius, low[3], high[3];
};

static const struct table_field tractogram_fields[] = {
    {"path", NULL, "its file: bytes, not always UTF-8", TABLE_OF(TEXT, struct tractogram_row, path)},
    {"format", NULL, "TrackVis 2, gzip; array of streamlines from memory",
     TABLE_OF(TEXT, struct tractogram_row, format)},
    {"sha256", NULL, "SHA-256 of the file; n/a of a folder and of memory",
     TABLE_OF(TEXT, struct tractogram_row, sha256)},
    {"streamlines", NULL, "how many", TABLE_OF(LARGE_COUNT, struct tractogram_row, streamlines)},
    {"points", NULL, "points in all of them", TABLE_OF(LARGE_COUNT, struct tractogram_row, points)},
    {"length_mm", "mm", "total length of all of them", TABLE_OF(NUMBER, struct tractogram_row, length_mm)},
    {"radius_mm", "mm", "a ray hits a streamline that is nearer", TABLE_OF(NUMBER, struct tractogram_row, radius)},
    {"bundles", NULL, "how many objects it is, from that of the row on",
     TABLE_OF(LARGE_COUNT, struct tractogram_row, bundles)},
    {"scalars", NULL, "how many arrays of numbers it has", TABLE_OF(LARGE_COUNT, struct tractogram_row, scalars)},
    {"half", NULL, "1 where its points have half precision, as in its file, else 0",
     TABLE_OF(LARGE_COUNT, struct tractogram_row, is_half)},
    BOX_FIELDS(struct tractogram_row),
};
static const struct table_fields tractogram_columns = TABLE_FIELDS(tractogram_fields);

static void tell_tractogram(struct tractogram_row *row, const conus_atlas *atlas, size_t index)
{
    conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
    if (conus_atlas_tractogram(&info, atlas, index)) {
        return; /* past the last */
    }
    row->object = (struct table_object){CONUS_KIND_BUNDLE, (uint32_t)info.bundle};
    row->path = info.path;
    row->format = info.format;
    row->sha256 = info.sha256;
    row->streamlines = info.streamlines;
    row->points = info.points;
    row->bundles = info.bundles;
    row->scalars = info.scalars;
    row->is_half = info.half;
    row->length_mm = info.length_mm;
    row->radius = info.radius;
    memcpy(row->low, info.low, sizeof row->low);
    memcpy(row->high, info.high, sizeof row->high);
}

static conus_status list_tractograms(conus_table **out, const conus_atlas *atlas)
{
    const size_t count = conus_atlas_tractogram_count(atlas);
    struct tractogram_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        tell_tractogram(&rows[i], atlas, i);
    }
    return table_of_rows(out, atlas, &tractogram_columns, rows, sizeof *rows, count);
}

struct text_row {
    struct table_object object;
    const char *kind, *text;
};

static const struct table_field file_fields[] = {
    {"path", NULL, "a file that the atlas is made of besides its volumes: bytes, not always UTF-8",
     TABLE_OF(TEXT, struct text_row, text)},
};
static const struct table_fields file_columns = TABLE_FIELDS(file_fields);

static conus_status list_files(conus_table **out, const conus_atlas *atlas)
{
    const size_t count = conus_atlas_file_count(atlas);
    struct text_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 0; rows && i < count; i++) {
        rows[i].text = conus_atlas_file(atlas, i);
    }
    return table_of_rows(out, atlas, &file_columns, rows, sizeof *rows, count);
}

static const struct table_field note_fields[] = {
    {"kind", NULL,
     "labels: whence the names are; exchanged: left and right are, of the names or of the places; warning: an answer "
     "may name another place or another area than the data mean; note",
     TABLE_OF(TEXT, struct text_row, kind)},
    {"text", NULL, "one line", TABLE_OF(TEXT, struct text_row, text)},
};
static const struct table_fields note_columns = TABLE_FIELDS(note_fields);

static conus_status list_notes(conus_table **out, const conus_atlas *atlas)
{
    const size_t count = 1 + conus_atlas_note_count(atlas);
    const char *exchanged = conus_atlas_exchanged(atlas);
    struct text_row *rows = memory_zeroed(count, sizeof *rows);
    for (size_t i = 1; rows && i < count; i++) {
        bool is_warning = conus_atlas_note_severity(atlas, i - 1) == CONUS_SEVERITY_WARNING;
        rows[i].text = conus_atlas_note(atlas, i - 1);
        rows[i].kind = exchanged && strcmp(rows[i].text, exchanged) == 0 ? "exchanged"
                       : is_warning                                      ? "warning"
                                                                         : "note";
    }
    if (rows) {
        rows[0].kind = "labels";
        rows[0].text = conus_atlas_label_source(atlas);
    }
    return table_of_rows(out, atlas, &note_columns, rows, sizeof *rows, count);
}

static const struct {
    const char *name;
    conus_status (*list)(conus_table **out, const conus_atlas *atlas);
} lists[] = {
    {"objects", list_objects}, {"surfaces", list_surfaces}, {"tractograms", list_tractograms},
    {"files", list_files},     {"notes", list_notes},
};

conus_status conus_atlas_list(conus_table **out, const conus_atlas *atlas, const char *what)
{
    if (!atlas || !what) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: none", atlas ? "what" : "atlas");
    }
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        if (strcmp(lists[i].name, what) == 0) {
            return lists[i].list(out, atlas);
        }
    }
    return fail(CONUS_ERROR_ARGUMENT, "what: %s, allowed are objects, surfaces, tractograms, files and notes", what);
}
