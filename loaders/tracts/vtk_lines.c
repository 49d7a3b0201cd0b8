/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes streamlines of the lines of VTK's files. */
#include "loaders/tracts/tract_formats.h"

#include "base/formats/gzip.h"
#include "base/memory.h"
#include "loaders/surfaces/foreign/foreign_mesh.h"
#include "sources/format.h"

#include <stdio.h>
#include <string.h>

bool vtk_lines_are_in(const char *path)
{
    struct bytes bytes = {0};
    bool are = !gzip_read(&bytes, path, memory_limit(0), NULL) && format_is_lines(&bytes);
    bytes_finish(&bytes);
    return are;
}

/* A tractogram that is being built. */
struct building {
    struct tractogram *out;
    const struct foreign_mesh *mesh;
    struct foreign_lines *lines;
    uint64_t left; /* bytes of memory that may still be taken */
    bool in_order; /* corner k is vertex k, so that nothing need be gathered */
};

/* Numbers of vertices become numbers of the corners of lines. */
static conus_status gather(float **out, struct building *building, const float *values, size_t components)
{
    const struct corners *corners = &building->lines->corners;
    size_t numbers = 0;
    size_t size = 0;
    if (!memory_multiply(corners->count, components, &numbers) || !memory_multiply(numbers, sizeof **out, &size) ||
        size > building->left) {
        return fail(CONUS_ERROR_MEMORY, "streamlines: %zu times %zu numbers take more than is allowed (--max-memory)",
                    corners->count, components);
    }
    building->left -= size;
    *out = memory_raw(numbers, sizeof **out);
    if (!*out) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t k = 0; k < corners->count; k++) {
        memcpy(&(*out)[k * components], &values[corners->indices[k] * components], components * sizeof *values);
    }
    return CONUS_OK;
}

/* Positions of the mesh are those of the tractogram, or copied. */
static conus_status fill_points(struct building *building, struct foreign_mesh *mesh)
{
    struct tractogram *out = building->out;
    conus_status status = CONUS_OK;
    if (building->in_order) {
        out->points = mesh->positions;
        mesh->positions = NULL;
    } else {
        status = gather(&out->points, building, mesh->positions, 3);
    }
    out->point_count = status ? 0 : building->lines->corners.count;
    out->space = (unsigned char)mesh->space;
    return status;
}

static conus_status lines_fill_scalar(struct building *building, struct foreign_array *array)
{
    struct tractogram *out = building->out;
    size_t things = array->per_point ? building->mesh->vertex_count : building->lines->count;
    if (array->count / array->components != things) {
        return fail(CONUS_ERROR_DATA, "%s: %zu numbers, %zu times %u are needed", array->name, array->count, things,
                    array->components);
    }
    struct tract_scalar *scalar = &out->scalars[out->scalar_count];
    *scalar = (struct tract_scalar){NULL, array->per_point, array->components, NULL};
    if (array->per_point && !building->in_order) {
        conus_status status = gather(&scalar->values, building, array->values, array->components);
        if (status) {
            return status;
        }
    } else {
        scalar->values = array->values;
        array->values = NULL;
    }
    scalar->name = array->name;
    array->name = NULL;
    out->scalar_count++;
    return CONUS_OK;
}

/* Builds the tractogram, which takes what it can from @p mesh and @p lines. */
static conus_status lines_build(struct tractogram *out, struct foreign_mesh *mesh, struct foreign_lines *lines,
                                uint64_t max_memory, struct notes *notes)
{
    const struct corners *corners = &lines->corners;
    struct building building = {out, mesh, lines, max_memory, .in_order = corners->count == mesh->vertex_count};
    for (size_t k = 0; building.in_order && k < corners->count; k++) {
        building.in_order = corners->indices[k] == k;
    }
    if (!lines->count && mesh->triangle_count) {
        return fail(CONUS_ERROR_DATA, "a surface and no lines, streamlines are needed");
    }
    conus_status status = fill_points(&building, mesh);
    if (status) {
        return status;
    }
    out->first = memory_zeroed(lines->count + 1, sizeof *out->first);
    out->scalars = out->first ? memory_zeroed(lines->array_count, sizeof *out->scalars) : NULL;
    if (!out->scalars) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < lines->count; i++) {
        out->first[i + 1] = lines->ends[i];
    }
    out->streamline_count = lines->count;
    for (size_t i = 0; !status && i < lines->array_count; i++) {
        status = lines_fill_scalar(&building, &lines->arrays[i]);
    }
    if (!status && lines->behind) {
        status = notes_add(notes, "%zu polygons are not read", lines->behind);
    }
    return status;
}

conus_status vtk_lines_parse(struct tractogram *out, const struct bytes *bytes, uint64_t max_memory,
                             struct notes *notes)
{
    struct tractogram built = {0};
    struct foreign_lines lines = {.max_memory = max_memory};
    struct foreign_mesh mesh = {.lines = &lines};
    bool legacy = format_id_of(bytes, ROLE_TRACTS) == FORMAT_VTK;
    conus_status status =
        legacy ? vtk_parse(&mesh, bytes->data, bytes->size) : vtp_parse(&mesh, bytes->data, bytes->size, max_memory);
    status = status ? status : notes_move(notes, &mesh.notes);
    status = status ? status : lines_build(&built, &mesh, &lines, max_memory, notes);
    snprintf(built.format, sizeof built.format, legacy ? "VTK" : "VTP");
    foreign_mesh_finish(&mesh);
    foreign_lines_finish(&lines);
    if (status) {
        tractogram_finish(&built);
        return status;
    }
    *out = built;
    return CONUS_OK;
}

conus_status vtk_lines_read(struct tractogram *out, const char *path, uint64_t max_memory, struct notes *notes)
{
    struct bytes bytes = {0};
    struct file_sums sums = {0};
    conus_status status = gzip_read(&bytes, path, max_memory, &sums);
    if (!status) {
        status = vtk_lines_parse(out, &bytes, max_memory, notes);
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    if (!status) {
        memcpy(out->sha256, sums.items[0].sha256, sizeof out->sha256);
    }
    file_sums_finish(&sums);
    bytes_finish(&bytes);
    return status;
}
