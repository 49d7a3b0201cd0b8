/* SPDX-License-Identifier: BSD-3-Clause */
/* The cost of opening a large labelled volume, which is the atlas enlarged by nearest neighbour, and of conus query on
 * it. The memory is that of a separate process. */
#include "base/memory.h"
#include "bench/support/bench.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <zlib.h>

enum { PATH_SIZE = 512, ENLARGED = 3, KILOBYTE = 1024 };

/* The atlas with each voxel repeated `times` times along each axis, in the same place. */
struct enlarged {
    const conus_atlas *atlas;
    const struct volume *volume;
    size_t times;
    char path[PATH_SIZE], program[PATH_SIZE];
    conus_status status;
};

static void write_header(FILE *file, const struct enlarged *enlarged)
{
    const conus_volume_info *info = &enlarged->volume->info;
    const double *m = info->world_from_voxel;
    double n = (double)enlarged->times;
    double origin[3];
    fprintf(file,
            "NRRD0004\ntype: uint16\ndimension: 3\nspace: RAS\nencoding: gzip\nendian: little\nsizes: %zu %zu %zu",
            enlarged->times * info->dim[0], enlarged->times * info->dim[1], enlarged->times * info->dim[2]);
    fputs("\nspace directions:", file);
    for (int a = 0; a < 3; a++) {
        fprintf(file, " (%.17g,%.17g,%.17g)", m[4 * a] / n, m[4 * a + 1] / n, m[4 * a + 2] / n);
    }
    for (int r = 0; r < 3; r++) { /* the corner of the grid stays where it is */
        origin[r] = m[12 + r] + (m[r] + m[4 + r] + m[8 + r]) * (1 / n - 1) / 2;
    }
    fprintf(file, "\nspace origin: (%.17g,%.17g,%.17g)\n\n", origin[0], origin[1], origin[2]);
}

/* Plane by plane, so that this process stays small: the measured process starts with the memory of this one. */
static bool write_voxels(gzFile file, const struct enlarged *enlarged, uint8_t *plane)
{
    const size_t *dim = enlarged->volume->info.dim;
    size_t times = enlarged->times;
    size_t row = 2 * times * dim[0];
    bool written = true;
    for (size_t k = 0; k < dim[2] && written; k++) {
        uint8_t *out = plane;
        for (size_t v = 0; v < dim[0] * times * dim[1] * times; v++, out += 2) {
            size_t i = v % (dim[0] * times) / times, j = v / (dim[0] * times) / times;
            uint32_t number = volume_object(enlarged->volume, i + dim[0] * (j + dim[1] * k));
            uint32_t label = number ? enlarged->atlas->objects[number - 1].label : 0;
            out[0] = (uint8_t)label;
            out[1] = (uint8_t)(label >> 8);
        }
        for (size_t t = 0; t < times && written; t++) {
            written = gzfwrite(plane, row, dim[1] * times, file) == dim[1] * times;
        }
    }
    return written;
}

static conus_status write_enlarged(const struct enlarged *enlarged)
{
    const size_t *dim = enlarged->volume->info.dim;
    uint8_t *plane = memory_raw(2 * dim[0] * dim[1], enlarged->times * enlarged->times);
    FILE *header = plane ? fopen(enlarged->path, "w") : NULL;
    bool written = header;
    if (header) {
        write_header(header, enlarged);
        written = fclose(header) == 0;
    }
    gzFile file = written ? gzopen(enlarged->path, "ab1") : NULL;
    written = file && write_voxels(file, enlarged, plane);
    written = file && gzclose(file) == Z_OK && written;
    memory_free(plane);
    return written ? CONUS_OK : fail(CONUS_ERROR_IO, "%s: cannot write", enlarged->path);
}

static void run_query(void *data)
{
    struct enlarged *enlarged = data;
    char *arguments[] = {enlarged->program,   "query",           enlarged->path, "--origin=-90,20,20",
                         "--toward=0,-10,10", "--labels-anyway", "--quiet",      NULL};
    conus_status status = program_run(arguments);
    enlarged->status = enlarged->status ? enlarged->status : status;
}

/* Whether each area that is read back has times^3 as many voxels, and the same volume. */
static bool same_areas(const struct enlarged *enlarged)
{
    conus_atlas *atlas = NULL;
    const conus_load_options options = {.labels_anyway = true};
    uint64_t each = (uint64_t)enlarged->times * enlarged->times * enlarged->times;
    bool same = !conus_atlas_load(&atlas, enlarged->path, &options);
    size_t found = 0;
    for (size_t i = 0; same && i < enlarged->atlas->area_count; i++) {
        const conus_object *area = &enlarged->atlas->objects[i];
        for (size_t k = 0; area->voxels && k < atlas->area_count; k++) {
            const conus_object *other = &atlas->objects[k];
            found += other->label == area->label && other->voxels == each * area->voxels &&
                     fabs(other->volume_mm3 - area->volume_mm3) <= 1e-9 * area->volume_mm3;
        }
        found += !area->voxels;
    }
    same = same && found == enlarged->atlas->area_count;
    conus_atlas_destroy(atlas);
    return same;
}

static conus_status measure(struct bench *bench, struct enlarged *enlarged)
{
    struct rusage usage;
    run_query(enlarged);
    getrusage(RUSAGE_CHILDREN, &usage);
    struct bench_variant variant = {.name = "conus query, enlarged volume", .run = run_query, .data = enlarged};
    double voxels = (double)(enlarged->volume->voxel_count * enlarged->times * enlarged->times * enlarged->times);
    conus_status status = enlarged->status;
    variant.equal = !status && same_areas(enlarged);
    status = status ? status : bench_measure(bench, "open", &variant, 1, 1, 0);
    return status
               ? status
               : bench_value(bench, "open_bytes_per_voxel", (double)usage.ru_maxrss * KILOBYTE / voxels, variant.equal);
}

conus_status bench_open(struct bench *bench)
{
    struct enlarged enlarged = {.times = bench->options.check ? 1 : ENLARGED};
    conus_atlas *atlas = NULL;
    conus_status status = bench_load_labels(&atlas, bench->options.atlas);
    enlarged.atlas = atlas;
    enlarged.volume = status ? NULL : atlas_parcellation(atlas);
    snprintf(enlarged.path, sizeof enlarged.path, "%s/enlarged.nrrd", bench->folder);
    status = status ? status : write_enlarged(&enlarged);
    if (!status && program_find(enlarged.program, sizeof enlarged.program, "conus", "CONUS")) {
        conus_atlas_destroy(atlas);
        return bench_leave_out(bench, "open");
    }
    status = status ? status : measure(bench, &enlarged);
    conus_atlas_destroy(atlas);
    return status;
}
