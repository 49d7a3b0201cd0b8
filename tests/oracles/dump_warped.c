/* SPDX-License-Identifier: BSD-3-Clause */
/* For tests/oracles/compare_warps.py.
 *
 * dump_warped ATLAS OUT [FILE FROM TO GRID VECTORS]...: moves the atlas by the files, of which points go through the
 * first one first; "-" is none, VECTORS relative, absolute or "-". Writes raw into OUT: the labels of the first volume
 * (uint32), where the centres of its voxels are in the atlas's own space (3 doubles each), and the vertices of all
 * surfaces (3 floats each). Prints how many there are of each, the volume's place, and the notes. */
#include "atlas/atlas.h"
#include "base/geometry/math3.h"

#include <stdio.h>
#include <string.h>

static const char *given(const char *word)
{
    return strcmp(word, "-") == 0 ? NULL : word;
}

static conus_status move(conus_atlas *atlas, char **words)
{
    const conus_transform_options options = {.from = given(words[1]),
                                             .to = given(words[2]),
                                             .grid = given(words[3]),
                                             .vectors = words[4][0] == 'r'   ? CONUS_VECTORS_RELATIVE
                                                        : words[4][0] == 'a' ? CONUS_VECTORS_ABSOLUTE
                                                                             : CONUS_VECTORS_AS_STATED};
    return conus_atlas_transform(atlas, words[0], &options);
}

static void dump_volume(FILE *stream, const conus_atlas *atlas)
{
    const struct volume *volume = &atlas->volumes[0];
    const size_t *dim = volume->info.dim;
    printf("dim %zu %zu %zu\naffine", dim[0], dim[1], dim[2]);
    for (int i = 0; i < 16; i++) {
        printf(" %.17g", volume->info.world_from_voxel[4 * (i % 4) + i / 4]);
    }
    printf("\n");
    for (size_t v = 0; v < volume->voxel_count; v++) {
        uint32_t object = volume_object(volume, v);
        uint32_t label = object ? atlas->objects[object - 1].label : 0;
        fwrite(&label, sizeof label, 1, stream);
    }
    for (size_t v = 0; v < volume->voxel_count; v++) {
        const size_t k = v / dim[0] / dim[1];
        double point[3] = {(double)(v % dim[0]), (double)(v / dim[0] % dim[1]), (double)k};
        mat4_point(point, volume->info.world_from_voxel, point);
        conus_atlas_own_point(point, atlas, point);
        fwrite(point, sizeof *point, 3, stream);
    }
}

static void dump(FILE *stream, const conus_atlas *atlas)
{
    if (atlas->volume_count) {
        dump_volume(stream, atlas);
    }
    for (size_t i = 0; i < atlas->mesh_count; i++) {
        printf("vertices %zu\n", atlas->meshes[i].vertex_count);
        fwrite(atlas->meshes[i].positions, 3 * sizeof(float), atlas->meshes[i].vertex_count, stream);
    }
    for (size_t i = 0; i < atlas->notes.count; i++) {
        printf("note %s\n", atlas->notes.lines[i]);
    }
}

int main(int argc, char **argv)
{
    conus_atlas *atlas = NULL;
    if (argc < 3 || (argc - 3) % 5) {
        fprintf(stderr, "dump_warped ATLAS OUT [FILE FROM TO GRID VECTORS]...\n");
        return 2;
    }
    conus_status status = conus_atlas_load(&atlas, argv[1], NULL);
    for (int i = argc - 5; i >= 3 && !status; i -= 5) {
        status = move(atlas, argv + i);
    }
    FILE *stream = status ? NULL : fopen(argv[2], "wb");
    if (stream) {
        dump(stream, atlas);
    }
    if (status) {
        printf("error %s\n", conus_message());
    }
    bool written = stream && fclose(stream) == 0;
    conus_atlas_destroy(atlas);
    return written ? 0 : 1;
}
