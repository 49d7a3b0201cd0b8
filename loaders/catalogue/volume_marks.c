/* SPDX-License-Identifier: BSD-3-Clause */
/* The marks of a labelled volume. */
#include "loaders/catalogue/volume_marks.h"

#include "base/files/folder.h"
#include "base/memory.h"
#include "base/text.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_header.h"

#include <fnmatch.h>
#include <string.h>
#include <unistd.h>

enum { INTENT_LABEL = 1002 };

/* Endings of label tables that bear the volume's name. */
static const char *const tables[] = {".nii.txt", ".txt",     ".tsv", ".csv",     ".label",
                                     ".ctbl",    ".niml.lt", ".xml", ".nii.lut", ".lut"};

/* Names that programs and papers give to labelled volumes and to no image, in upper or lower case. */
static const char *const names[] = {
    "*atlas*",    "*parc*",     "*aseg*",        "*dseg*",      "*maxprob*", "*labels*",
    "*rois*",     "roi_mni*",   "schaefer2018*", "yeo2011_*",   "aal*",      "*basc_multiscale*",
    "*brodmann*", "talairach*", "julich*",       "*destrieux*", "*glasser*"};
static const char *const others[] = {"*probseg*", "*_mask.*", "*_mask", "*_t1w*", "*_t2w*"};

bool volume_marks_is_volume(const char *name)
{
    return name[volume_stem_length(name)] && !path_ends_in(name, ".img") && !path_ends_in(name, ".img.gz");
}

static bool matches_any(const char *name, const char *const *patterns, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (fnmatch(patterns[i], name, FNM_CASEFOLD) == 0) {
            return true;
        }
    }
    return false;
}

static conus_status look_beside(bool *found, const char *path)
{
    for (size_t i = 0; !*found && i < sizeof tables / sizeof tables[0]; i++) {
        char *table = path_with_ending(path, volume_stem_length(path), tables[i]);
        if (!table) {
            return CONUS_ERROR_MEMORY;
        }
        *found = access(table, R_OK) == 0;
        memory_free(table);
    }
    return CONUS_OK;
}

conus_status volume_marks_find(bool *labels, double spacing[3], const char *path, bool known)
{
    struct volume_header header = {0};
    struct bytes head = {0};
    conus_status status = volume_file_peek(&header, &head, path);
    const conus_volume_info *info = &header.info;
    *labels = false;
    if (!status && info->volume_count == 1 && info->dim[1] > 1 && info->dim[2] > 1) { /* no values of vertices */
        const char *name = path_base(path);
        const struct text text = {(const char *)head.data, head.size};
        bool has_table = text_mentions(text, "<LabelTable") || text_mentions(text, "LABEL_DTABLE") ||
                         text_mentions(text, "ATLAS_LABEL_TABLE");
        bool has_name = matches_any(name, names, sizeof names / sizeof names[0]) &&
                        !matches_any(name, others, sizeof others / sizeof others[0]);
        memcpy(spacing, info->spacing, sizeof info->spacing);
        *labels = known || header.intent_code == INTENT_LABEL || has_table || has_name;
        status = *labels ? CONUS_OK : look_beside(labels, path);
    }
    bytes_finish(&head);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
}
