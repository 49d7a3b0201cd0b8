/* SPDX-License-Identifier: BSD-3-Clause */
/* dump_points FILE: moves the points on stdin, three doubles each, by a file of transforms, to doubles on stdout; NaN
 * for a point without an image. RAS mm. For tests/oracles/compare_composites.py. The kind of the file goes to
 * stderr. */
#include "base/geometry/math3.h"
#include "loaders/transform/transform.h"

#include <stdio.h>

static conus_status read_file(struct transform_chain *chain, const char *path)
{
    struct notes notes = {0};
    struct job job = {0};
    transform_read(&job, chain, source_open(&job, path), &(conus_transform_options){0});
    conus_status status = job_close(&job, &notes, NULL);
    for (size_t i = 0; i < notes.count; i++) {
        fprintf(stderr, "%s\n", notes.lines[i]);
    }
    notes_finish(&notes);
    return status;
}

int main(int argc, char **argv)
{
    struct transform_chain chain = {0};
    double p[3];
    conus_status status = argc == 2 ? read_file(&chain, argv[1]) : CONUS_ERROR_ARGUMENT;
    if (status) {
        fprintf(stderr, "%s\n", conus_message());
        return (int)status;
    }
    while (fread(p, sizeof p, 1, stdin) == 1) {
        for (size_t i = chain.count; i-- > 0;) {
            (void)deformation_point(p, &chain.fields[i], p);
        }
        if (!chain.count) {
            mat4_point(p, chain.matrix, p);
        }
        fwrite(p, sizeof p, 1, stdout);
    }
    transform_chain_finish(&chain);
    return 0;
}
