/* SPDX-License-Identifier: BSD-3-Clause */
/* dump_mesh SURFACE POSITIONS TRIANGLES [ras]: writes float32 positions and uint32 vertex indices raw, and what else
 * was read to stdout, for tests/oracles/compare_meshes.py. "ras": coordinates as they are stored. */
#include "base/memory.h"
#include "loaders/mesh_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static conus_status write_raw(const char *path, const void *data, size_t count)
{
    FILE *stream = fopen(path, "wb");
    bool written = stream && fwrite(data, 4, count, stream) == count;
    written = stream && fclose(stream) == 0 && written;
    return written ? CONUS_OK : fail(CONUS_ERROR_IO, "%s: cannot write", path);
}

static void print_notes(const struct notes *notes)
{
    for (size_t i = 0; i < notes->count; i++) {
        printf("note %s\n", notes->lines[i]);
    }
}

static conus_status dump(char **argv, const struct mesh_file_options *options, struct notes *notes)
{
    struct mesh mesh = {0};
    struct label about = {0};
    conus_status status = mesh_file_read(&mesh, &about, argv[1], options, notes);
    status = status ? status : write_raw(argv[2], mesh.positions, 3 * mesh.vertex_count);
    status = status ? status : write_raw(argv[3], mesh.triangles, 3 * mesh.triangle_count);
    if (!status) {
        printf("vertices %zu\ntriangles %zu\nname %s\nhemisphere %c\n", mesh.vertex_count, mesh.triangle_count,
               about.name ? about.name : "", about.hemisphere ? about.hemisphere : '-');
        print_notes(notes);
    }
    memory_free(about.name);
    mesh_finish(&mesh);
    return status;
}

int main(int argc, char **argv)
{
    struct notes notes = {0};
    bool as_stored = argc == 5 && strcmp(argv[4], "ras") == 0;
    if (argc != 4 && !as_stored) {
        fprintf(stderr, "dump_mesh SURFACE POSITIONS TRIANGLES [ras]\n");
        return 2;
    }
    const struct mesh_file_options options = {.space = as_stored ? MESH_SPACE_RAS : MESH_SPACE_UNSTATED};
    conus_status status = dump(argv, &options, &notes);
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
    }
    notes_finish(&notes);
    return status ? EXIT_FAILURE : EXIT_SUCCESS;
}
