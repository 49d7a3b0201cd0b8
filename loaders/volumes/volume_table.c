/* SPDX-License-Identifier: BSD-3-Clause */
/* Labels in a volume's own file: 3D Slicer's segments, extensions of NIfTI, text ahead of the voxels. */
#include "loaders/volumes/volume_table.h"

#include "base/memory.h"
#include "loaders/volumes/text/text_volume.h"

/* Workbench and AFNI also keep what is no label table in their extensions. In the order of their priority. */
static const struct {
    int code;
    const char *mark;
} kept[] = {{30, "<LabelTable"}, {4, "LABEL_DTABLE"}, {4, "ATLAS_LABEL_TABLE"}};

enum { KEPT = sizeof kept / sizeof kept[0] };

conus_status volume_label_table(struct label_table *out, char **source, const struct volume_file *file,
                                const struct label_voxels *voxels, struct file_sums *read, struct notes *notes)
{
    struct label_volume volume = {.info = &file->info,
                                  .max_memory = file->max_memory,
                                  .texts = memory_zeroed(KEPT * file->extension_count + 1, sizeof *volume.texts),
                                  .header = volume_file_header};
    conus_status status = volume.texts ? CONUS_OK : CONUS_ERROR_MEMORY;
    if (!status && file->text) {
        status = text_volume_labels(&volume.segments, file->text, file->info.volume, &volume.notes);
    }
    for (size_t k = 0; !status && k < KEPT; k++) {
        for (size_t i = 0; i < file->extension_count; i++) {
            const struct volume_extension *extension = &file->extensions[i];
            struct text text = text_from_bytes(extension->data, extension->size);
            if (extension->code == kept[k].code && text_mentions(text, kept[k].mark)) {
                volume.texts[volume.count++] = text;
            }
        }
    }
    if (!status) {
        struct text embedded = text_from_bytes((const uint8_t *)file->embedded.data, file->embedded.size);
        if (embedded.size) {
            volume.texts[volume.count++] = embedded;
        }
        status = label_table_of_volume(out, source, &volume, voxels, read, notes);
    }
    label_volume_finish(&volume);
    return status;
}
