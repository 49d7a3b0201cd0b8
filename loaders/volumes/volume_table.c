/* SPDX-License-Identifier: BSD-3-Clause */
/* Labels in a volume's own file: 3D Slicer's segments, extensions of NIfTI, text ahead of the voxels. */
#include "loaders/volumes/volumes.h"

#include "loaders/volumes/text/text_volume.h"

#include <string.h>

/* Workbench and AFNI also keep what is no label table in their extensions. In the order of their priority. */
static const struct {
    int code;
    const char *mark;
} kept[] = {
    {30, "<LabelTable"}, {4, "LABEL_DTABLE"}, {4, "ATLAS_LABEL_TABLE"}, {0, "<LabelTable"}}; /* 0: TotalSegmentator */

enum { KEPT = sizeof kept / sizeof kept[0] };

/* Fills `texts` with the texts of the file that may be tables; gives how many. */
static size_t find_texts(struct text *texts, const struct volume_file *file)
{
    size_t count = 0;
    for (size_t k = 0; texts && k < KEPT; k++) {
        for (size_t i = 0; i < file->extension_count; i++) {
            const struct volume_extension *extension = &file->extensions[i];
            struct text text = text_from_bytes(extension->data, extension->size);
            if (extension->code == kept[k].code && text_mentions(text, kept[k].mark)) {
                texts[count++] = text;
            }
        }
    }
    struct text embedded = text_from_bytes((const uint8_t *)file->embedded.data, file->embedded.size);
    if (texts && embedded.size) {
        texts[count++] = embedded;
    }
    return count;
}

/* 3D Slicer's segments. */
static struct label_table *find_segments(struct job *job, const struct volume_file *file)
{
    struct label_table *segments = labels_new(job);
    struct attempt attempt = job_try(job);
    if (file->text) {
        text_volume_labels(job, segments, file->text, file->info.volume);
    }
    if (job_ok(job) && !segments->count) {
        (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    } else {
        attempt_end(job, &attempt, ATTEMPT_KEEP);
    }
    return segments;
}

const char *volume_label_table(struct job *job, struct label_table *out, const struct volume_file *file,
                               const struct label_voxels *voxels)
{
    const char *words = "";
    struct text *texts = job_zeroed(job, KEPT * file->extension_count + 1, sizeof *texts);
    const struct label_volume volume = {.info = &file->info,
                                        .segments = find_segments(job, file),
                                        .texts = texts,
                                        .count = find_texts(texts, file),
                                        .header = volume_header_read};
    label_table_of_volume(job, out, &words, &volume, voxels);
    return words;
}
