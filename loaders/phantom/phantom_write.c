/* SPDX-License-Identifier: BSD-3-Clause */
/* conus_phantom_write(): writes a phantom as files that any other program reads, and its truth. */
#include "atlas/labels/labels.h"
#include "atlas/phantom/phantom.h"
#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/options.h"
#include "conus/own.h"
#include "loaders/surfaces/surfaces.h"
#include "loaders/volumes/volumes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void surface_name(char out[64], size_t index)
{
    snprintf(out, 64, "brain-%02zu-%s.surf.gii", index + 1, phantom_brain_area(index)->abbreviation);
}

/* Writes the content, which ends here. */
static void write_text(struct job *job, const char *folder, const char *name, struct buffer *content)
{
    (void)JOB_CALL(job, file_write_in(folder, name, content)); /* checks the buffer's status */
    buffer_finish(content);
}

static void write_packed(struct job *job, const char *folder, const char *name, struct bytes file)
{
    const struct bytes packed = gzip_format(job, file.data, file.size);
    const struct buffer content = {.data = (char *)packed.data, .size = packed.size};
    (void)JOB_CALL(job, file_write_in(folder, name, &content));
}

static void write_surface(struct job *job, const char *folder, size_t index)
{
    char name[64];
    struct mesh mesh = {0};
    struct buffer file = {0};
    struct mesh_title title = {
        .label = (uint32_t)index + 1, .name = phantom_brain_area(index)->name, .space = "NIFTI_XFORM_SCANNER_ANAT"};
    palette_colour(title.rgb, index);
    surface_name(name, index);
    (void)(JOB_CALL(job, phantom_brain_mesh(&mesh, index)) &&
           JOB_CALL(job, mesh_format(&file, &mesh, &title, CONUS_MESH_GIFTI)));
    write_text(job, folder, name, &file);
    mesh_finish(&mesh);
}

static void write_brain_volume(struct job *job, const char *folder, const char *name,
                               uint16_t (*value)(const double world[3]))
{
    conus_volume_info grid;
    const struct job_mark mark = job_mark(job);
    if (!JOB_CALL(job, phantom_brain_grid(&grid))) {
        return;
    }
    size_t count = grid.dim[0] * grid.dim[1] * grid.dim[2];
    uint32_t *values = job_array(job, &count, sizeof *values);
    for (size_t i = 0; i < count; i++) {
        size_t row = i / grid.dim[0];
        size_t slice = row / grid.dim[1];
        double world[3] = {(double)(i % grid.dim[0]), (double)(row % grid.dim[1]), (double)slice};
        mat4_point(world, grid.world_from_voxel, world);
        values[i] = value(world);
    }
    write_packed(job, folder, name, nifti_format_values(job, &grid, values, SPACE_SCANNER));
    job_release(job, mark);
}

static void write_brain_manifest(struct job *job, const char *folder)
{
    struct buffer text = {0};
    buffer_text(&text, "{\n  \"conus_atlas\": 1,\n"
                       "  \"comment\": \"synthetic: conus phantom brain\",\n"
                       "  \"areas\": [\n");
    for (size_t i = 0; i < PHANTOM_BRAIN_AREAS; i++) {
        char file[64];
        uint8_t rgb[3];
        const struct phantom_brain_area *area = phantom_brain_area(i);
        surface_name(file, i);
        palette_colour(rgb, i);
        buffer_format(&text,
                      "%s    {\"file\": \"%s\", \"label\": %zu, \"name\": \"%s\", \"abbreviation\": \"%s\",\n"
                      "     \"hemisphere\": \"%c\", \"color\": \"#%02x%02x%02x\"}",
                      i ? ",\n" : "", file, i + 1, area->name, area->abbreviation, area->hemisphere, rgb[0], rgb[1],
                      rgb[2]);
    }
    buffer_text(&text, "\n  ],\n"
                       "  \"pathways\": [{\"file\": \"brain-pathway.nii.gz\", \"name\": \"Arc\"}],\n"
                       "  \"context\": {\"file\": \"brain-context.nii.gz\", \"transfer\": \"brain\"}\n}\n");
    write_text(job, folder, "brain.atlas.json", &text);
}

/* Ring i of radius i mm has straight lines where i is odd, helices of one turn where it is even, all from z = -HALF to
 * HALF mm in SEGMENTS steps. */
enum { RINGS = 12, PER_RING = 12, SEGMENTS = 60, HALF = 30 };

static const double turn = 6.283185307179586;

static bool is_helix(int ring)
{
    return ring % 2 == 0;
}

/* The length of the polyline: chords of a helix, each of which rises by 2 HALF / SEGMENTS. */
static double length_of(int ring)
{
    double rise = 2.0 * HALF / SEGMENTS;
    double chord = is_helix(ring) ? 2.0 * ring * sin(turn / (2 * SEGMENTS)) : 0;
    return SEGMENTS * sqrt(rise * rise + chord * chord);
}

static void append_float(struct buffer *out, double value)
{
    uint8_t bytes[4];
    order_put_f32(bytes, (float)value);
    buffer_append(out, bytes, sizeof bytes);
}

static void append_end(struct buffer *out, double value)
{
    for (int i = 0; i < 3; i++) {
        append_float(out, value);
    }
}

static void append_streamline(struct buffer *out, int ring, int number)
{
    for (int i = 0; i <= SEGMENTS; i++) {
        double turns = (double)number / PER_RING + (is_helix(ring) ? (double)i / SEGMENTS : 0);
        append_float(out, ring * cos(turn * turns));
        append_float(out, ring * sin(turn * turns));
        append_float(out, -HALF + i * 2.0 * HALF / SEGMENTS);
    }
    append_end(out, (double)NAN);
}

static void append_tractogram(struct buffer *out)
{
    enum { DATA_AT = 128 };
    static const char zeros[DATA_AT];
    buffer_format(out, "mrtrix tracks\ncomment: synthetic: conus phantom bundle\ndatatype: Float32LE\ncount: %d\n",
                  RINGS * PER_RING);
    buffer_format(out, "file: . %d\nEND\n", DATA_AT);
    buffer_append(out, zeros, out->size < DATA_AT ? DATA_AT - out->size : 0);
    for (int ring = 1; ring <= RINGS; ring++) {
        for (int number = 0; number < PER_RING; number++) {
            append_streamline(out, ring, number);
        }
    }
    append_end(out, (double)INFINITY);
}

static void append_bundle_truth(struct buffer *out)
{
    double total = 0;
    for (int ring = 1; ring <= RINGS; ring++) {
        total += PER_RING * length_of(ring);
    }
    buffer_format(out, "{\n  \"phantom\": \"bundle\",\n  \"conus\": \"%s\",\n  \"space\": \"RAS+, mm\",\n",
                  conus_version());
    buffer_format(out, "  \"streamlines\": %d,\n  \"points\": %d,\n  \"length_mm\": ", RINGS * PER_RING,
                  RINGS * PER_RING * (SEGMENTS + 1));
    buffer_number(out, total);
    buffer_format(out, ",\n  \"z\": [%d, %d],\n  \"segments\": %d,\n  \"rings\": [\n", -HALF, HALF, SEGMENTS);
    for (int ring = 1; ring <= RINGS; ring++) {
        buffer_format(out, "    {\"shape\": \"%s\", \"radius\": %d, \"turns\": %d, \"count\": %d, \"length_mm\": ",
                      is_helix(ring) ? "helix" : "line", ring, is_helix(ring), PER_RING);
        buffer_number(out, length_of(ring));
        buffer_text(out, ring < RINGS ? "},\n" : "}\n");
    }
    buffer_text(out, "  ]\n}\n");
}

static void append_bundle_manifest(struct buffer *out)
{
    buffer_text(out, "{\n  \"conus_atlas\": 1,\n  \"comment\": \"synthetic: conus phantom bundle\",\n"
                     "  \"streamlines\": [{\"file\": \"bundle.tck\", \"name\": \"Bundle\"}]\n}\n");
}

/* The columns of a BIDS _dseg.tsv. */
static void append_table(struct buffer *out, const struct phantom *phantom)
{
    buffer_text(out, "index\tname\tabbreviation\tcolor\n");
    for (size_t i = 0; i < phantom->area_count; i++) {
        const struct phantom_area *area = &phantom->areas[i];
        uint8_t rgb[3];
        palette_colour(rgb, i);
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

/* The volume comes last: where it is, its table and truth are. */
static void write_drawing(struct job *job, const char *folder, const struct phantom_drawing *drawing)
{
    const char *kind = drawing->phantom->info.name;
    struct buffer table = {0};
    struct buffer truth = {0};
    append_table(&table, drawing->phantom);
    append_truth(&truth, drawing);
    (void)JOB_CALL(job, file_make_folder(folder));
    write_text(job, folder, job_format(job, "%s.tsv", kind), &table);
    write_text(job, folder, job_format(job, "%s.json", kind), &truth);
    write_packed(job, folder, job_format(job, "%s.nii.gz", kind),
                 nifti_format_labels(job, &drawing->grid, drawing->labels, SPACE_SCANNER));
}

/* Writes the brain phantom (atlas/phantom/phantom.h): the surfaces brain-NN-ABBREVIATION.surf.gii,
 * brain-context.nii.gz, brain-pathway.nii.gz and, last, brain.atlas.json. */
static void write_brain(struct job *job, const char *folder, const conus_phantom_options *options)
{
    if (options->spacing[0] != 0 || options->spacing[1] != 0 || options->spacing[2] != 0) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "brain: spacing: it has one grid, of 1 mm");
    }
    if (options->size || options->oblique != 0 || options->flip[0] || options->flip[1] || options->flip[2]) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "brain: size, oblique and flip: it has one grid, of 151 x 188 x 154 voxels");
    }
    (void)JOB_CALL(job, file_make_folder(folder));
    for (size_t i = 0; job_ok(job) && i < PHANTOM_BRAIN_AREAS; i++) {
        write_surface(job, folder, i);
    }
    write_brain_volume(job, folder, "brain-pathway.nii.gz", phantom_brain_pathway);
    write_brain_volume(job, folder, "brain-context.nii.gz", phantom_brain_context);
    write_brain_manifest(job, folder);
}

/* Writes the bundle phantom: bundle.tck, the truth bundle.json and, last, the manifest bundle.atlas.json.
 * docs/formats.md has its shapes. */
static void write_bundle(struct job *job, const char *folder, const conus_phantom_options *options)
{
    static const struct {
        const char *name;
        void (*append)(struct buffer *out);
    } files[] = {{"bundle.tck", append_tractogram},
                 {"bundle.json", append_bundle_truth},
                 {"bundle.atlas.json", append_bundle_manifest}};
    bool has_grid = options->size || options->oblique != 0;
    for (int a = 0; a < 3; a++) {
        has_grid = has_grid || options->flip[a] || options->spacing[a] != 0;
    }
    if (has_grid) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "bundle: size, spacing, oblique and flip: it has no grid");
    }
    (void)JOB_CALL(job, file_make_folder(folder));
    for (size_t i = 0; job_ok(job) && i < sizeof files / sizeof files[0]; i++) {
        struct buffer content = {0};
        files[i].append(&content);
        write_text(job, folder, files[i].name, &content);
    }
}

conus_status conus_phantom_write(const char *kind, const char *folder, const conus_phantom_options *options)
{
    struct job job = {0};
    struct phantom_drawing drawing;
    options = options_of(conus_phantom_options, options);
    if (!folder || !folder[0]) {
        job_fail(&job, CONUS_ERROR_ARGUMENT, "folder: empty, a path is needed");
    } else if (kind && strcmp(kind, "brain") == 0) {
        write_brain(&job, folder, options);
    } else if (kind && strcmp(kind, "bundle") == 0) {
        write_bundle(&job, folder, options);
    } else if (JOB_CALL(&job, phantom_draw(&drawing, kind, options))) {
        write_drawing(&job, folder, &drawing);
        phantom_drawing_finish(&drawing);
    }
    return job_close(&job, NULL, NULL);
}
