/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and writes numbers of the vertices of a surface. */
#include "loaders/surfaces/surfaces.h"

#include "atlas/atlas.h"
#include "base/byte_order.h"
#include "base/files/file.h"
#include "base/formats/xml.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"
#include "loaders/refuse.h"
#include "loaders/surfaces/parts.h"
#include "loaders/volumes/volumes.h"
#include "sources/source.h"

#include <libdeflate.h>
#include <math.h>
#include <nettle/base64.h>
#include <stdio.h>
#include <string.h>

static bool has_numbers(const struct gifti_array *array)
{
    return array->intent == GIFTI_OTHER && array->count == array->dim[0];
}

/* NULL after a failure. */
static const struct gifti_array *find_array(struct job *job, const struct gifti *gifti, const char *name)
{
    size_t count = 0;
    size_t chosen = 0;
    const struct gifti_array *found = NULL;
    const size_t arrays = gifti ? gifti->arrays.count : 0;
    const char **names = job_zeroed(job, arrays, sizeof *names);
    for (size_t i = 0; names && i < arrays; i++) {
        if (has_numbers(&gifti->arrays.at[i])) {
            names[count++] = gifti->arrays.at[i].name;
        }
    }
    (void)JOB_CALL(job, map_choice_make(&chosen, names, count, text_from(name), "arrays of numbers", &job->notes));
    for (size_t i = 0; i < arrays && job_ok(job); i++) {
        if (has_numbers(&gifti->arrays.at[i]) && chosen-- == 0) {
            found = &gifti->arrays.at[i];
        }
    }
    if (!found) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "array %s: the file has %zu of numbers (counted from 0)", name, count);
    }
    return found;
}

static struct vertex_map take_array(struct job *job, const struct gifti *gifti, const char *name)
{
    struct vertex_map map = {0};
    const struct gifti_array *array = find_array(job, gifti, name);
    float *values = array ? job_raw(job, array->count, sizeof *values) : NULL;
    if (!values) {
        return map;
    }
    for (size_t v = 0; v < array->count; v++) {
        float value = (float)array->values[v];
        values[v] = isfinite(value) ? value : NAN;
    }
    name = array->name ? array->name : name;
    map = (struct vertex_map){.values = job_give(job, values, array->count * sizeof *values),
                              .count = array->count,
                              .name = job_give(job, job_copy(job, text_from(name)), strlen(name) + 1),
                              .hemisphere = gifti->hemisphere};
    if (!job_ok(job)) {
        vertex_map_finish(&map);
    }
    return map;
}

void vertex_map_finish(struct vertex_map *map)
{
    memory_free(map->values);
    memory_free(map->name);
    *map = (struct vertex_map){0};
}

struct vertex_map vertex_map_read(struct job *job, const char *path, const char *name)
{
    const struct job_mark mark = job_mark(job);
    const size_t place = job_in(job, path, JOB_ALONE);
    const struct bytes bytes = source_whole(job, source_open(job, path));
    const struct text document = text_from_bytes(bytes.data, bytes.size);
    if (!text_equal(xml_root(document), "GIFTI")) {
        file_refuse(job, path, &bytes, "numbers of vertices (GIFTI, .func.gii or .shape.gii)");
    }
    struct vertex_map map = take_array(job, gifti_read(job, document, NULL), name);
    job_out(job, place);
    job_release(job, mark);
    return map;
}

/* Little-endian float32, packed by zlib, in base64. */
static void append_values(struct job *job, struct buffer *out, const float *values, size_t count)
{
    enum { LEVEL = 6 };
    const struct job_mark mark = job_mark(job);
    struct libdeflate_compressor *packer = libdeflate_alloc_compressor(LEVEL);
    if (!packer) {
        job_fail(job, CONUS_ERROR_MEMORY, "no memory to pack");
    }
    size_t bound = packer ? libdeflate_zlib_compress_bound(packer, 4 * count) : 0;
    uint8_t *bytes = job_raw(job, count, 4);
    uint8_t *packed = job_raw(job, bound, 1);
    char *text = job_raw(job, BASE64_ENCODE_RAW_LENGTH(bound), 1);
    if (text) {
        for (size_t i = 0; i < count; i++) {
            order_put_f32(bytes + 4 * i, values[i]);
        }
        size_t size = libdeflate_zlib_compress(packer, bytes, 4 * count, packed, bound);
        base64_encode_raw(text, size, packed);
        buffer_append(out, text, BASE64_ENCODE_RAW_LENGTH(size));
    }
    libdeflate_free_compressor(packer);
    job_release(job, mark);
}

/* Maps whose numbers are all float32. */
struct plain_maps {
    conus_vertex_map *items;
    size_t count;
    char *names; /* NAME_LIMIT bytes each */
};

enum { NAME_LIMIT = 64, EXACT = 1 << 24, MILLION = 1000000 };

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

static struct plain_maps make_plain(struct job *job, const conus_vertex_map *maps, size_t count, size_t vertices)
{
    size_t whole = 0;
    for (size_t k = 0; k < count; k++) {
        whole += maps[k].numbers != NULL;
    }
    struct plain_maps plain = {.items = job_raw(job, count + whole, sizeof *plain.items),
                               .names = job_raw(job, count + whole, NAME_LIMIT)};
    float *values = job_raw(job, 2 * whole, vertices * sizeof *values); /* of whole numbers */
    for (size_t k = 0, n = 0; values && k < count; k++) {
        if (maps[k].numbers) {
            add_whole(&plain, &maps[k], values + 2 * vertices * n++, vertices);
        } else {
            plain.items[plain.count++] = maps[k];
        }
    }
    return plain;
}

static void write_gifti(struct job *job, const char *path, const struct plain_maps *maps, size_t vertices,
                        const char *structure)
{
    bool is_shape = path && path_ends_in(path, ".shape.gii");
    if (!path || !(is_shape || path_ends_in(path, ".func.gii"))) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: the name of a surface's map ends in .func.gii or .shape.gii",
                 path ? path : "");
    }
    if (!maps->count || !vertices || vertices > INT32_MAX) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: %zu arrays of %zu numbers, one of 1 to %d is needed", path,
                 maps->count, vertices, INT32_MAX);
    }
    struct buffer file = {0};
    buffer_format(&file,
                  "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<GIFTI Version=\"1.0\" NumberOfDataArrays=\"%zu\">\n"
                  "  <MetaData>\n",
                  maps->count);
    if (structure) {
        gifti_append_pair(&file, "AnatomicalStructurePrimary", structure);
    }
    gifti_append_pair(&file, "Creator", "conus " CONUS_VERSION);
    buffer_text(&file, "  </MetaData>\n  <LabelTable/>\n");
    for (size_t i = 0; i < maps->count && job_ok(job); i++) {
        buffer_format(&file,
                      "  <DataArray Intent=\"NIFTI_INTENT_%s\" DataType=\"NIFTI_TYPE_FLOAT32\" "
                      "ArrayIndexingOrder=\"RowMajorOrder\" Dimensionality=\"1\" Dim0=\"%zu\" "
                      "Encoding=\"GZipBase64Binary\" Endian=\"LittleEndian\" ExternalFileName=\"\" "
                      "ExternalFileOffset=\"\">\n    <MetaData>\n",
                      is_shape ? "SHAPE" : "NONE", vertices);
        gifti_append_pair(&file, "Name", maps->items[i].name);
        buffer_text(&file, "    </MetaData>\n    <Data>");
        append_values(job, &file, maps->items[i].values, vertices);
        buffer_text(&file, "</Data>\n  </DataArray>\n");
    }
    buffer_text(&file, "</GIFTI>\n");
    (void)JOB_CALL(job, buffer_status(&file));
    (void)JOB_CALL(job, file_write(path, file.data, file.size));
    buffer_finish(&file);
}

conus_status conus_vertex_maps_write(const char *path, const conus_vertex_map *maps, size_t count, size_t vertices,
                                     const char *structure)
{
    struct job job = {0};
    const struct plain_maps plain = make_plain(&job, maps, count, vertices);
    write_gifti(&job, path, &plain, vertices, structure);
    return job_close(&job, NULL, NULL);
}

/* The site whose numbers each vertex has; SIZE_MAX = none. */
static void find_sites(struct job *job, size_t *out, const conus_sites *sites, double fill)
{
    struct mesh mesh = {0};
    struct site_cubes cubes = {0};
    const struct mesh_file_options options = {.external = true};
    surface_read(job, &mesh, NULL, sites->path, &options);
    if (mesh.vertex_count != sites->vertex_count) {
        job_bad(job, "%s: the file has changed meanwhile", sites->path);
    }
    if (fill > 0) {
        (void)JOB_CALL(job, site_cubes_init(&cubes, fill, sites->count));
    }
    for (size_t i = 0; i < sites->count && cubes.first; i++) {
        site_cubes_add(&cubes, sites->points[i]);
    }
    for (size_t v = 0; mesh.positions && v < sites->vertex_count && job_ok(job); v++) {
        const float *p = mesh.positions + 3 * v;
        const double point[3] = {(double)p[0], (double)p[1], (double)p[2]};
        out[v] = cubes.first ? site_cubes_nearest(&cubes, sites, point) : SIZE_MAX;
    }
    for (size_t i = 0; i < sites->count && job_ok(job); i++) {
        out[sites->sources[i]] = i;
    }
    site_cubes_finish(&cubes);
    mesh_finish(&mesh);
}

static void write_on_surface(struct job *job, const char *path, const conus_sites *sites, const struct plain_maps *maps,
                             const char *structure, double fill)
{
    size_t vertices = sites->vertex_count;
    size_t *from = job_raw(job, vertices, sizeof *from);
    float *values = job_raw(job, vertices, maps->count * sizeof *values);
    find_sites(job, from, sites, fill);
    structure = structure ? structure : surface_about_of(job, sites->path).structure;
    for (size_t k = 0; k < maps->count && job_ok(job); k++) {
        for (size_t v = 0; v < vertices; v++) {
            values[k * vertices + v] = from[v] == SIZE_MAX ? NAN : maps->items[k].values[from[v]];
        }
        maps->items[k].values = values + k * vertices;
    }
    write_gifti(job, path, maps, vertices, structure);
}

static void write_on_grid(struct job *job, const char *path, const conus_sites *sites, const struct plain_maps *maps)
{
    if (!nifti_is_name(path)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s: the name of a map of voxels ends in .nii or .nii.gz", path);
    }
    const size_t place = job_in(job, path, JOB_ALONE);
    const struct bytes file =
        nifti_format_maps(job, &sites->grid, maps->items, maps->count, sites->sources, sites->count);
    job_out(job, place);
    nifti_write(job, path, &file);
}

conus_status conus_sites_write_maps(const char *path, const conus_sites *sites, const conus_vertex_map *maps,
                                    size_t count, const char *structure, double fill)
{
    struct job job = {0};
    if (!sites->vertex_count && !sites->grid.count) {
        job_fail(&job, CONUS_ERROR_ARGUMENT,
                 "%s: the points are neither vertices of a surface nor voxels of one volume", path);
    }
    const struct plain_maps plain = make_plain(&job, maps, count, sites->count);
    if (sites->vertex_count) {
        write_on_surface(&job, path, sites, &plain, structure, fill);
    } else {
        write_on_grid(&job, path, sites, &plain);
    }
    return job_close(&job, NULL, NULL);
}
