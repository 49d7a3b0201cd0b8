/* SPDX-License-Identifier: BSD-3-Clause */
/* For tests/oracles/compare_meshes.py and compare_cifti.py.
 *
 * dump_mesh surface FILE OUT [ras]: writes float32 positions, then uint32 vertex indices, raw, and prints the rest.
 * "ras": coordinates as they are stored. dump_mesh labels FILE OUT [SURFACE]: writes uint32 labels, raw, and prints
 * the table. dump_mesh voxels FILE OUT: the same of the voxels of a CIFTI file, with the volume's size and place.
 * dump_mesh split FILE OUT LABELS: cuts the surface FILE by the labels and prints each part. */
#include "atlas/surface/mesh.h"
#include "base/memory.h"
#include "loaders/cifti/cifti.h"
#include "loaders/surfaces/surfaces.h"
#include "tests/support/mesh_on_job.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static conus_status write_raw(FILE *stream, const void *data, size_t count)
{
    return fwrite(data, 4, count, stream) == count ? CONUS_OK : fail(CONUS_ERROR_IO, "cannot write");
}

static void print_notes(const struct notes *notes)
{
    for (size_t i = 0; i < notes->count; i++) {
        printf("note %s\n", notes->lines[i]);
    }
}

static conus_status dump_surface(FILE *stream, const char *path, bool as_stored, struct notes *notes)
{
    const struct mesh_file_options options = {.space = as_stored ? MESH_SPACE_RAS : MESH_SPACE_UNSTATED};
    struct mesh mesh = {0};
    struct label about = {0};
    conus_status status = mesh_file_read(&mesh, &about, path, &options, notes);
    status = status ? status : write_raw(stream, mesh.positions, 3 * mesh.vertex_count);
    status = status ? status : write_raw(stream, mesh.triangles, 3 * mesh.triangle_count);
    if (!status) {
        printf("vertices %zu\ntriangles %zu\nname %s\nhemisphere %c\n", mesh.vertex_count, mesh.triangle_count,
               about.name ? about.name : "", about.hemisphere ? about.hemisphere : '-');
        print_notes(notes);
    }
    label_finish(&about);
    mesh_finish(&mesh);
    return status;
}

static void print_table(const struct label_table *table)
{
    for (size_t i = 0; i < table->count; i++) {
        const struct label *label = &table->entries[i];
        printf("label %u %02x%02x%02x %s\n", label->number, label->rgb[0], label->rgb[1], label->rgb[2],
               label->name ? label->name : "");
    }
}

static conus_status dump_voxels(FILE *stream, const char *path, struct notes *notes)
{
    struct job job = {0};
    struct label_table *table = labels_new(&job);
    const struct cifti_file *file = cifti_file_open(&job, path);
    const uint32_t *labels = file ? cifti_voxels(&job, table, file->choice) : NULL;
    if (labels) {
        const struct cifti *cifti = &file->choice->cifti;
        const size_t *dim = cifti->dim;
        (void)JOB_CALL(&job, write_raw(stream, labels, dim[0] * dim[1] * dim[2]));
        printf("dim %zu %zu %zu\n", dim[0], dim[1], dim[2]);
        for (int i = 0; i < 12; i++) {
            printf("%s%.17g%s", i ? " " : "world ", cifti->world_from_voxel[4 * (i % 4) + i / 4], i == 11 ? "\n" : "");
        }
        print_table(table);
    }
    conus_status status = job_close(&job, notes, NULL);
    print_notes(notes);
    return status;
}

static conus_status dump_labels(FILE *stream, const char *path, const char *surface, struct notes *notes)
{
    struct vertex_labels labels = {0};
    const struct mesh_file_options options = {.surface = surface};
    conus_status status = vertex_labels_read(&labels, path, &options, notes);
    status = status ? status : write_raw(stream, labels.labels, labels.count);
    if (!status) {
        print_table(&labels.table);
    }
    print_notes(notes);
    vertex_labels_finish(&labels);
    return status;
}

static conus_status dump_split(const char *path, const char *labels_path, struct notes *notes)
{
    struct mesh mesh = {0};
    struct mesh_parts parts = {0};
    struct vertex_labels labels = {0};
    conus_status status = mesh_file_read(&mesh, NULL, path, NULL, notes);
    status = status ? status : vertex_labels_read(&labels, labels_path, NULL, notes);
    if (!status && labels.count != mesh.vertex_count) {
        status = fail(CONUS_ERROR_DATA, "%zu labels for %zu vertices", labels.count, mesh.vertex_count);
    }
    status = status ? status : mesh_split(&parts, &mesh, labels.labels, notes);
    for (size_t i = 0; i < parts.count; i++) {
        printf("part %u %zu %zu\n", parts.parts[i].label, parts.parts[i].mesh.vertex_count,
               parts.parts[i].mesh.triangle_count);
    }
    print_notes(notes);
    mesh_parts_finish(&parts);
    vertex_labels_finish(&labels);
    mesh_finish(&mesh);
    return status;
}

int main(int argc, char **argv)
{
    struct notes notes = {0};
    FILE *stream = argc > 3 ? fopen(argv[3], "wb") : NULL;
    if (!stream) {
        fprintf(stderr, "dump_mesh surface|labels|voxels|split FILE OUT [ras|SURFACE|LABELS]\n");
        return 2;
    }
    conus_status status = strcmp(argv[1], "surface") == 0 ? dump_surface(stream, argv[2], argc > 4, &notes)
                          : strcmp(argv[1], "labels") == 0
                              ? dump_labels(stream, argv[2], argc > 4 ? argv[4] : NULL, &notes)
                          : strcmp(argv[1], "voxels") == 0 ? dump_voxels(stream, argv[2], &notes)
                                                           : dump_split(argv[2], argc > 4 ? argv[4] : "", &notes);
    if (fclose(stream) && !status) {
        status = fail(CONUS_ERROR_IO, "%s: cannot write", argv[3]);
    }
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
    }
    notes_finish(&notes);
    return status ? EXIT_FAILURE : EXIT_SUCCESS;
}
