/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes numbers of the vertices of a surface. */
#include "loaders/surfaces/vertex_map.h"

#include "atlas/sites.h"
#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/formats/gzip.h"
#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/version.h"
#include "loaders/refuse.h"
#include "loaders/surfaces/gifti.h"
#include "loaders/surfaces/mesh_file.h"
#include "loaders/surfaces/mesh_format.h"
#include "loaders/surfaces/surface_find.h"
#include "loaders/volumes/nifti_write.h"
#include "sources/map_choice.h"

#include <libdeflate.h>
#include <math.h>
#include <nettle/base64.h>
#include <stdio.h>
#include <string.h>

static bool has_numbers(const struct gifti_array *array)
{
    return array->intent == GIFTI_OTHER && array->count == array->dim[0];
}

/* *out stays NULL where a number names none of the arrays. */
static conus_status find_array(const struct gifti_array **out, const struct gifti *gifti, const char *name,
                               struct notes *notes)
{
    size_t count = 0;
    size_t chosen = 0;
    const char **names = memory_zeroed(gifti->array_count + 1, sizeof *names);
    if (!names) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < gifti->array_count; i++) {
        if (has_numbers(&gifti->arrays[i])) {
            names[count++] = gifti->arrays[i].name;
        }
    }
    conus_status status = map_choice_make(&chosen, names, count, text_from(name), "arrays of numbers", notes);
    memory_free(names);
    for (size_t i = 0; i < gifti->array_count && !status; i++) {
        if (has_numbers(&gifti->arrays[i]) && chosen-- == 0) {
            *out = &gifti->arrays[i];
        }
    }
    return status || *out
               ? status
               : fail(CONUS_ERROR_ARGUMENT, "array %s: the file has %zu of numbers (counted from 0)", name, count);
}

static conus_status take_array(struct vertex_map *out, const struct gifti *gifti, const char *name, struct notes *notes)
{
    const struct gifti_array *array = NULL;
    conus_status status = find_array(&array, gifti, name, notes);
    if (status) {
        return status;
    }
    name = array->name ? array->name : name;
    struct vertex_map map = {.values = memory_raw(array->count, sizeof *map.values),
                             .count = array->count,
                             .name = memory_text(name, strlen(name)),
                             .hemisphere = gifti->hemisphere};
    if (!map.values || !map.name) {
        vertex_map_finish(&map);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t v = 0; v < array->count; v++) {
        float value = (float)array->values[v];
        map.values[v] = isfinite(value) ? value : NAN;
    }
    *out = map;
    return CONUS_OK;
}

void vertex_map_finish(struct vertex_map *map)
{
    memory_free(map->values);
    memory_free(map->name);
    *map = (struct vertex_map){0};
}

conus_status vertex_map_read(struct vertex_map *out, const char *path, const char *name, uint64_t max_memory,
                             struct notes *notes)
{
    struct bytes bytes = {0};
    struct gifti gifti = {0};
    const struct gifti_options options = {.path = path, .max_memory = max_memory};
    conus_status status = gzip_read(&bytes, path, memory_limit(max_memory), NULL);
    if (status) {
        return status;
    }
    status = text_equal(xml_root(text_from_bytes(bytes.data, bytes.size)), "GIFTI")
                 ? gifti_parse(&gifti, bytes.data, bytes.size, &options, notes)
                 : file_refuse(path, &bytes, "numbers of vertices (GIFTI, .func.gii or .shape.gii)");
    status = status ? status : take_array(out, &gifti, name, notes);
    gifti_finish(&gifti);
    bytes_finish(&bytes);
    return status ? fail_in(status, path) : CONUS_OK;
}

/* Little-endian float32, packed by zlib, in base64. */
static conus_status append_values(struct buffer *out, const float *values, size_t count)
{
    enum { LEVEL = 6 };
    struct libdeflate_compressor *packer = libdeflate_alloc_compressor(LEVEL);
    size_t bound = packer ? libdeflate_zlib_compress_bound(packer, 4 * count) : 0;
    uint8_t *bytes = memory_raw(count, 4);
    uint8_t *packed = packer ? memory_raw(bound, 1) : NULL;
    char *text = packed ? memory_raw(BASE64_ENCODE_RAW_LENGTH(bound), 1) : NULL;
    conus_status status = bytes && text ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status) {
        for (size_t i = 0; i < count; i++) {
            order_put_f32(bytes + 4 * i, values[i]);
        }
        size_t size = libdeflate_zlib_compress(packer, bytes, 4 * count, packed, bound);
        base64_encode_raw(text, size, packed);
        buffer_append(out, text, BASE64_ENCODE_RAW_LENGTH(size));
    }
    memory_free(text);
    memory_free(packed);
    memory_free(bytes);
    libdeflate_free_compressor(packer);
    return status;
}

/* Maps whose numbers are all float32. */
struct plain_maps {
    conus_vertex_map *items;
    size_t count;
    float *values; /* of whole numbers */
    char *names;   /* NAME_LIMIT bytes each */
};

enum { NAME_LIMIT = 64, EXACT = 1 << 24, MILLION = 1000000 };

static void plain_maps_finish(struct plain_maps *maps)
{
    memory_free(maps->items);
    memory_free(maps->values);
    memory_free(maps->names);
}

static void add_whole(struct plain_maps *out, const conus_vertex_map *map, float *values, size_t vertices)
{
    uint64_t most = 0;
    for (size_t v = 0; v < vertices; v++) {
        most = map->numbers[v] > most ? map->numbers[v] : most;
    }
    uint64_t part = most > EXACT ? MILLION : UINT64_MAX;
    for (size_t v = 0; v < vertices; v++) {
        uint64_t number = map->numbers[v];
        uint64_t parts = number / part;
        values[v] = number ? (float)(number % part) : NAN;
        if (most > EXACT) {
            values[vertices + v] = number ? (float)parts : NAN;
        }
    }
    out->items[out->count++] = (conus_vertex_map){.name = map->name, .values = values};
    if (most > EXACT) {
        char *name = out->names + out->count * NAME_LIMIT;
        snprintf(name, NAME_LIMIT, "%s_millions", map->name);
        out->items[out->count++] = (conus_vertex_map){.name = name, .values = values + vertices};
    }
}

static conus_status plain_maps_init(struct plain_maps *out, const conus_vertex_map *maps, size_t count, size_t vertices)
{
    size_t whole = 0;
    for (size_t k = 0; k < count; k++) {
        whole += maps[k].numbers != NULL;
    }
    struct plain_maps plain = {.items = memory_raw(count + whole, sizeof *plain.items),
                               .values = memory_raw(2 * whole, vertices * sizeof *plain.values),
                               .names = memory_raw(count + whole, NAME_LIMIT)};
    if (!plain.items || !plain.values || !plain.names) {
        plain_maps_finish(&plain);
        return CONUS_ERROR_MEMORY;
    }
    for (size_t k = 0, n = 0; k < count; k++) {
        if (maps[k].numbers) {
            add_whole(&plain, &maps[k], plain.values + 2 * vertices * n++, vertices);
        } else {
            plain.items[plain.count++] = maps[k];
        }
    }
    *out = plain;
    return CONUS_OK;
}

static conus_status write_gifti(const char *path, const conus_vertex_map *maps, size_t count, size_t vertices,
                                const char *structure)
{
    bool is_shape = path && path_ends_in(path, ".shape.gii");
    if (!path || !(is_shape || path_ends_in(path, ".func.gii"))) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the name of a surface's map ends in .func.gii or .shape.gii",
                    path ? path : "");
    }
    if (!count || !vertices || vertices > INT32_MAX) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: %zu arrays of %zu numbers, one of 1 to %d is needed", path, count,
                    vertices, INT32_MAX);
    }
    struct buffer file = {0};
    conus_status status = CONUS_OK;
    buffer_format(&file,
                  "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<GIFTI Version=\"1.0\" NumberOfDataArrays=\"%zu\">\n"
                  "  <MetaData>\n",
                  count);
    if (structure) {
        gifti_append_pair(&file, "AnatomicalStructurePrimary", structure);
    }
    gifti_append_pair(&file, "Creator", "conus " CONUS_VERSION);
    buffer_text(&file, "  </MetaData>\n  <LabelTable/>\n");
    for (size_t i = 0; i < count && !status; i++) {
        buffer_format(&file,
                      "  <DataArray Intent=\"NIFTI_INTENT_%s\" DataType=\"NIFTI_TYPE_FLOAT32\" "
                      "ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"1\" Dim0=\"%zu\" "
                      "Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" "
                      "ExternalFileOffset=\"\">\n    <MetaData>\n",
                      is_shape ? "SHAPE" : "NONE", vertices);
        gifti_append_pair(&file, "Name", maps[i].name);
        buffer_text(&file, "    </MetaData>\n    <Data>");
        status = append_values(&file, maps[i].values, vertices);
        buffer_text(&file, "</Data>\n  </DataArray>\n");
    }
    buffer_text(&file, "</GIFTI>\n");
    status = status ? status : buffer_status(&file);
    status = status ? status : file_write(path, file.data, file.size);
    buffer_finish(&file);
    return status;
}

conus_status conus_vertex_maps_write(const char *path, const conus_vertex_map *maps, size_t count, size_t vertices,
                                     const char *structure)
{
    struct plain_maps plain = {0};
    conus_status status = plain_maps_init(&plain, maps, count, vertices);
    status = status ? status : write_gifti(path, plain.items, plain.count, vertices, structure);
    plain_maps_finish(&plain);
    return status;
}

/* The site whose numbers each vertex has; SIZE_MAX = none. */
static conus_status find_sites(size_t *out, const conus_sites *sites, double fill)
{
    struct mesh mesh = {0};
    struct notes notes = {0};
    struct site_cubes cubes = {0};
    conus_status status =
        mesh_file_read(&mesh, NULL, sites->path, &(const struct mesh_file_options){.external = true}, &notes);
    notes_finish(&notes);
    if (!status && mesh.vertex_count != sites->vertex_count) {
        status = fail(CONUS_ERROR_DATA, "%s: the file has changed meanwhile", sites->path);
    }
    status = status || !(fill > 0) ? status : site_cubes_init(&cubes, fill, sites->count);
    for (size_t i = 0; i < sites->count && cubes.first; i++) {
        site_cubes_add(&cubes, sites->points[i]);
    }
    for (size_t v = 0; v < sites->vertex_count && !status; v++) {
        const float *p = mesh.positions + 3 * v;
        const double point[3] = {(double)p[0], (double)p[1], (double)p[2]};
        out[v] = cubes.first ? site_cubes_nearest(&cubes, sites, point) : SIZE_MAX;
    }
    for (size_t i = 0; i < sites->count && !status; i++) {
        out[sites->sources[i]] = i;
    }
    site_cubes_finish(&cubes);
    mesh_finish(&mesh);
    return status;
}

static conus_status write_on_surface(const char *path, const conus_sites *sites, const struct plain_maps *maps,
                                     const char *structure, double fill)
{
    size_t vertices = sites->vertex_count;
    size_t *from = memory_raw(vertices, sizeof *from);
    float *values = memory_raw(vertices, maps->count * sizeof *values);
    struct surface_about about = {0};
    conus_status status = from && values ? find_sites(from, sites, fill) : CONUS_ERROR_MEMORY;
    status = status || structure ? status : surface_about_read(&about, sites->path, memory_limit(0));
    for (size_t k = 0; k < maps->count && !status; k++) {
        for (size_t v = 0; v < vertices; v++) {
            values[k * vertices + v] = from[v] == SIZE_MAX ? NAN : maps->items[k].values[from[v]];
        }
        maps->items[k].values = values + k * vertices;
    }
    structure = structure ? structure : about.structure;
    status = status ? status : write_gifti(path, maps->items, maps->count, vertices, structure);
    surface_about_finish(&about);
    memory_free(values);
    memory_free(from);
    return status;
}

static conus_status write_on_grid(const char *path, const conus_sites *sites, const struct plain_maps *maps)
{
    struct bytes file = {0};
    if (!nifti_is_name(path)) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the name of a map of voxels ends in .nii or .nii.gz", path);
    }
    conus_status status =
        nifti_format_maps(&file, &sites->grid, maps->items, maps->count, sites->sources, sites->count);
    status = status ? fail_in(status, path) : nifti_write(path, &file);
    bytes_finish(&file);
    return status;
}

conus_status conus_sites_write_maps(const char *path, const conus_sites *sites, const conus_vertex_map *maps,
                                    size_t count, const char *structure, double fill)
{
    struct plain_maps plain = {0};
    if (!sites->vertex_count && !sites->grid.count) {
        return fail(CONUS_ERROR_ARGUMENT, "%s: the points are neither vertices of a surface nor voxels of one volume",
                    path);
    }
    conus_status status = plain_maps_init(&plain, maps, count, sites->count);
    status = status                ? status
             : sites->vertex_count ? write_on_surface(path, sites, &plain, structure, fill)
                                   : write_on_grid(path, sites, &plain);
    plain_maps_finish(&plain);
    return status;
}
