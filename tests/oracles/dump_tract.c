/* SPDX-License-Identifier: BSD-3-Clause */
/* dump_tract FILE OUT: reads the tractogram FILE and writes its contents to OUT, for compare_tracts.py: lines of text,
 * an empty line, then the arrays in this machine's byte order: first, points or halves, the values of each scalar, the
 * members of each group. Notes and the message of a refusal go to standard error, each in a line. */
#include "loaders/tracts/tracts.h"

#include <stdio.h>
#include <stdlib.h>

static bool write_array(FILE *file, const void *data, size_t size, uint64_t count)
{
    return fwrite(data, size, count, file) == count;
}

static bool write_tractogram(FILE *file, const struct tractogram *t)
{
    fprintf(file, "format\t%s\nsha256\t%s\nstreamlines\t%zu\npoints\t%llu\n", t->format, t->sha256, t->streamline_count,
            (unsigned long long)t->point_count);
    for (size_t i = 0; i < t->scalar_count; i++) {
        const struct tract_scalar *s = &t->scalars[i];
        fprintf(file, "%s\t%s\t%u\n", s->per_point ? "per_point" : "per_streamline", s->name, s->components);
    }
    for (size_t i = 0; i < t->group_count; i++) {
        fprintf(file, "group\t%s\t%zu\n", t->groups[i].name, t->groups[i].count);
    }
    fputc('\n', file);
    bool fine = write_array(file, t->first, sizeof *t->first, t->streamline_count + 1) &&
                (t->halves ? write_array(file, t->halves, 3 * sizeof *t->halves, t->point_count)
                           : write_array(file, t->points, 3 * sizeof *t->points, t->point_count));
    for (size_t i = 0; fine && i < t->scalar_count; i++) {
        const struct tract_scalar *s = &t->scalars[i];
        fine = write_array(file, s->values, s->components * sizeof *s->values,
                           s->per_point ? t->point_count : t->streamline_count);
    }
    for (size_t i = 0; fine && i < t->group_count; i++) {
        fine = write_array(file, t->groups[i].members, sizeof *t->groups[i].members, t->groups[i].count);
    }
    return fine;
}

int main(int argc, char **argv)
{
    struct tractogram tractogram = {0};
    struct notes notes = {0};
    struct job job = {0};
    if (argc == 3) {
        tract_file_read(&job, &tractogram, argv[1], CONUS_FILE_SPACE_AS_STATED);
    }
    if (job_close(&job, &notes, NULL) || argc != 3) {
        fprintf(stderr, "%s\n", argc == 3 ? conus_message() : "usage: dump_tract FILE OUT");
        notes_finish(&notes);
        return EXIT_FAILURE;
    }
    for (size_t i = 0; i < notes.count; i++) {
        fprintf(stderr, "%s\n", notes.lines[i]);
    }
    FILE *file = fopen(argv[2], "wb");
    bool fine = file && write_tractogram(file, &tractogram);
    fine = file && fclose(file) == 0 && fine;
    tractogram_finish(&tractogram);
    notes_finish(&notes);
    return fine ? EXIT_SUCCESS : EXIT_FAILURE;
}
