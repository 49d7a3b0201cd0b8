/* SPDX-License-Identifier: BSD-3-Clause */
/* The brain phantom as files: surfaces, two volumes and the manifest that joins them. */
#include "loaders/phantom/phantom_brain_write.h"

#include "atlas/labels/labels.h"
#include "atlas/phantom/phantom_brain.h"
#include "atlas/space.h"
#include "base/buffer.h"
#include "base/files/file.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/surfaces/mesh_format.h"
#include "loaders/volumes/nifti_write.h"

#include <stdio.h>
#include <string.h>

static void surface_name(char out[64], size_t index)
{
    snprintf(out, 64, "brain-%02zu-%s.surf.gii", index + 1, phantom_brain_area(index)->abbreviation);
}

static conus_status write_surface(const char *folder, size_t index)
{
    char name[64];
    struct mesh mesh = {0};
    struct buffer file = {0};
    struct mesh_title title = {
        .label = (uint32_t)index + 1, .name = phantom_brain_area(index)->name, .space = "NIFTI_XFORM_SCANNER_ANAT"};
    palette_colour(title.rgb, index);
    surface_name(name, index);
    conus_status status = phantom_brain_mesh(&mesh, index);
    status = status ? status : mesh_format(&file, &mesh, &title, CONUS_MESH_GIFTI);
    status = status ? status : file_write_in(folder, name, &file);
    buffer_finish(&file);
    mesh_finish(&mesh);
    return status;
}

static conus_status write_volume(const char *folder, const char *name, uint16_t (*value)(const double world[3]))
{
    conus_volume_info grid;
    struct bytes file = {0};
    struct bytes packed = {0};
    conus_status status = phantom_brain_grid(&grid);
    size_t count = grid.dim[0] * grid.dim[1] * grid.dim[2];
    uint32_t *values = status ? NULL : memory_raw(count, sizeof *values);
    status = status || values ? status : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        size_t row = i / grid.dim[0];
        size_t slice = row / grid.dim[1];
        double world[3] = {(double)(i % grid.dim[0]), (double)(row % grid.dim[1]), (double)slice};
        mat4_point(world, grid.world_from_voxel, world);
        values[i] = value(world);
    }
    status = status ? status : nifti_format_values(&file, &grid, values, SPACE_SCANNER);
    status = status ? status : gzip_format(&packed, file.data, file.size);
    struct buffer bytes = {.data = (char *)packed.data, .size = packed.size};
    status = status ? status : file_write_in(folder, name, &bytes);
    memory_free(values);
    bytes_finish(&packed);
    bytes_finish(&file);
    return status;
}

static void append_areas(struct buffer *out)
{
    for (size_t i = 0; i < PHANTOM_BRAIN_AREAS; i++) {
        char file[64];
        uint8_t rgb[3];
        const struct phantom_brain_area *area = phantom_brain_area(i);
        surface_name(file, i);
        palette_colour(rgb, i);
        buffer_format(out,
                      "%s    {\"file\": \"%s\", \"label\": %zu, \"name\": \"%s\", \"abbreviation\": \"%s\",\n"
                      "     \"hemisphere\": \"%c\", \"color\": \"#%02x%02x%02x\"}",
                      i ? ",\n" : "", file, i + 1, area->name, area->abbreviation, area->hemisphere, rgb[0], rgb[1],
                      rgb[2]);
    }
}

static conus_status write_manifest(const char *folder)
{
    struct buffer text = {0};
    buffer_text(&text, "{\n  \"conus_atlas\": 1,\n"
                       "  \"comment\": \"synthetic: conus phantom brain\",\n"
                       "  \"areas\": [\n");
    append_areas(&text);
    buffer_text(&text, "\n  ],\n"
                       "  \"pathways\": [{\"file\": \"brain-pathway.nii.gz\", \"name\": \"Arc\"}],\n"
                       "  \"context\": {\"file\": \"brain-context.nii.gz\", \"transfer\": \"brain\"}\n}\n");
    conus_status status = file_write_in(folder, "brain.atlas.json", &text);
    buffer_finish(&text);
    return status;
}

conus_status phantom_brain_write(const char *folder)
{
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < PHANTOM_BRAIN_AREAS; i++) {
        status = write_surface(folder, i);
    }
    status = status ? status : write_volume(folder, "brain-pathway.nii.gz", phantom_brain_pathway);
    status = status ? status : write_volume(folder, "brain-context.nii.gz", phantom_brain_context);
    return status ? status : write_manifest(folder);
}
