/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_phantom_write(): a drawing as the files that any other program reads, and the truth behind it. */
#include "atlas/phantom/phantom.h"
#include "atlas/space.h"
#include "base/buffer.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "loaders/phantom/phantom_brain_write.h"
#include "loaders/phantom/phantom_bundle_write.h"
#include "loaders/volumes/nifti_write.h"

#include <stdio.h>
#include <string.h>

/* The columns of a BIDS _dseg.tsv. */
static void append_table(struct buffer *out, const struct phantom *phantom)
{
    buffer_text(out, "index\tname\tabbreviation\tcolor\n");
    for (size_t i = 0; i < phantom->area_count; i++) {
        const struct phantom_area *area = &phantom->areas[i];
        uint8_t rgb[3];
        phantom_area_colour(rgb, i);
        buffer_format(out, "%u\t%s\t%s\t#%02x%02x%02x\n", area->label, area->name, area->abbreviation, rgb[0], rgb[1],
                      rgb[2]);
    }
}

static void append_vector(struct buffer *out, const char *key, const double values[3])
{
    buffer_format(out, "\"%s\": [", key);
    for (int i = 0; i < 3; i++) {
        buffer_text(out, i ? ", " : "");
        buffer_number(out, values[i]);
    }
    buffer_text(out, "]");
}

static void append_number(struct buffer *out, const char *key, double value)
{
    buffer_format(out, "\"%s\": ", key);
    buffer_number(out, value);
}

static void append_grid(struct buffer *out, const conus_volume_info *grid)
{
    buffer_format(out, "  \"dim\": [%zu, %zu, %zu],\n  \"world_from_voxel\": [", grid->dim[0], grid->dim[1],
                  grid->dim[2]);
    for (int row = 0; row < 4; row++) {
        buffer_text(out, row ? ",\n                       [" : "[");
        for (int column = 0; column < 4; column++) {
            buffer_text(out, column ? ", " : "");
            buffer_number(out, grid->world_from_voxel[4 * column + row]);
        }
        buffer_text(out, "]");
    }
    buffer_text(out, "],\n");
}

static void append_areas(struct buffer *out, const struct phantom_drawing *drawing)
{
    buffer_text(out, "  \"areas\": [\n");
    for (size_t i = 0; i < drawing->phantom->area_count; i++) {
        const struct phantom_area *area = &drawing->phantom->areas[i];
        buffer_format(out, "%s    {\"index\": %u, \"name\": \"%s\", \"abbreviation\": \"%s\", ", i ? ",\n" : "",
                      area->label, area->name, area->abbreviation);
        append_number(out, "volume_mm3", phantom_area_volume(drawing, area->label));
        buffer_text(out, "}");
    }
    buffer_text(out, "\n  ],\n");
}

static void append_shape(struct buffer *out, const struct phantom_shape *shape)
{
    static const char *const names[] = {[PHANTOM_BALL] = "ball", [PHANTOM_BOX] = "box", [PHANTOM_RING] = "ring"};
    buffer_format(out, "    {\"index\": %u, \"shape\": \"%s\", ", shape->label, names[shape->kind]);
    append_vector(out, "center", shape->centre);
    buffer_text(out, ", ");
    switch (shape->kind) {
    case PHANTOM_BALL:
        append_number(out, "radius", shape->radius);
        break;
    case PHANTOM_BOX:
        append_vector(out, "half_edges", shape->half);
        break;
    case PHANTOM_RING:
        append_number(out, "radius", shape->radius);
        buffer_text(out, ", ");
        append_number(out, "tube_radius", shape->tube);
        buffer_format(out, ", \"axis\": \"%c\", ", "xyz"[shape->axis]);
        append_number(out, "from_deg", degrees_from_radians(shape->from));
        buffer_text(out, ", ");
        append_number(out, "to_deg", degrees_from_radians(shape->to));
        break;
    }
    buffer_text(out, "}");
}

static void append_truth(struct buffer *out, const struct phantom_drawing *drawing)
{
    buffer_format(out, "{\n  \"phantom\": \"%s\",\n  \"description\": \"%s\",\n  \"conus\": \"%s\",\n",
                  drawing->phantom->info.name, drawing->phantom->info.description, conus_version());
    buffer_text(out, "  \"space\": \"RAS+, mm\",\n"
                     "  \"rule\": \"a voxel has the index of the last shape that contains its centre, else 0\",\n");
    append_grid(out, &drawing->grid);
    append_areas(out, drawing);
    buffer_text(out, "  \"shapes\": [\n");
    for (size_t i = 0; i < drawing->phantom->shape_count; i++) {
        buffer_text(out, i ? ",\n" : "");
        append_shape(out, &drawing->shapes[i]);
    }
    buffer_text(out, "\n  ]\n}\n");
}

static conus_status write_beside(const char *folder, const char *kind, const char *ending, const struct buffer *content)
{
    struct buffer name = {0};
    buffer_format(&name, "%s%s", kind, ending);
    conus_status status = buffer_status(&name);
    status = status ? status : file_write_in(folder, name.data, content);
    buffer_finish(&name);
    return status;
}

static conus_status write_volume(const char *folder, const struct phantom_drawing *drawing)
{
    struct bytes file = {0};
    struct bytes packed = {0};
    conus_status status = nifti_format_labels(&file, &drawing->grid, drawing->labels, SPACE_SCANNER);
    status = status ? status : gzip_format(&packed, file.data, file.size);
    const struct buffer content = {.data = (char *)packed.data, .size = packed.size};
    status = status ? status : write_beside(folder, drawing->phantom->info.name, ".nii.gz", &content);
    bytes_finish(&packed);
    bytes_finish(&file);
    return status;
}

/* The volume comes last: where it is, its table and truth are. */
static conus_status write_drawing(const char *folder, const struct phantom_drawing *drawing)
{
    const char *kind = drawing->phantom->info.name;
    struct buffer table = {0};
    struct buffer truth = {0};
    append_table(&table, drawing->phantom);
    append_truth(&truth, drawing);
    conus_status status = file_make_folder(folder);
    status = status ? status : write_beside(folder, kind, ".tsv", &table);
    status = status ? status : write_beside(folder, kind, ".json", &truth);
    status = status ? status : write_volume(folder, drawing);
    buffer_finish(&truth);
    buffer_finish(&table);
    return status;
}

/* A phantom that is no drawing. */
static conus_status write_brain(const char *folder, const conus_phantom_options *options)
{
    if (options && (options->spacing[0] != 0 || options->spacing[1] != 0 || options->spacing[2] != 0)) {
        return fail(CONUS_ERROR_ARGUMENT, "brain: spacing: it has one grid, of 1 mm");
    }
    if (options &&
        (options->size || options->oblique != 0 || options->flip[0] || options->flip[1] || options->flip[2])) {
        return fail(CONUS_ERROR_ARGUMENT, "brain: size, oblique and flip: it has one grid, of 151 x 188 x 154 voxels");
    }
    conus_status status = file_make_folder(folder);
    return status ? status : phantom_brain_write(folder);
}

/* Nor is it. */
static conus_status write_bundle(const char *folder, const conus_phantom_options *options)
{
    bool has_grid = options->size || options->oblique != 0;
    for (int a = 0; a < 3; a++) {
        has_grid = has_grid || options->flip[a] || options->spacing[a] != 0;
    }
    if (has_grid) {
        return fail(CONUS_ERROR_ARGUMENT, "bundle: size, spacing, oblique and flip: it has no grid");
    }
    conus_status status = file_make_folder(folder);
    return status ? status : phantom_bundle_write(folder);
}

conus_status conus_phantom_write(const char *kind, const char *folder, const conus_phantom_options *options)
{
    struct phantom_drawing drawing;
    options = options_of(conus_phantom_options, options);
    if (kind && strcmp(kind, "brain") == 0 && folder && folder[0]) {
        return write_brain(folder, options);
    }
    if (kind && strcmp(kind, "bundle") == 0 && folder && folder[0]) {
        return write_bundle(folder, options);
    }
    if (!folder || !folder[0]) {
        return fail(CONUS_ERROR_ARGUMENT, "folder: empty, a path is needed");
    }
    conus_status status = phantom_draw(&drawing, kind, options);
    if (!status) {
        status = write_drawing(folder, &drawing);
        phantom_drawing_finish(&drawing);
    }
    return status;
}
