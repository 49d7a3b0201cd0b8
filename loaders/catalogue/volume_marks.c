/* SPDX-License-Identifier: BSD-3-Clause */
/* The marks of a labelled volume. */
#include "loaders/catalogue/catalogue.h"

#include "base/formats/packed.h"
#include "base/system/system.h"
#include "loaders/labels/label_format.h"
#include "loaders/volumes/volumes.h"
#include "sources/names.h"

#include <string.h>

enum { INTENT_LABEL = 1002 };

/* Names that programs and papers give to labelled volumes and to no image, in upper or lower case. */
static const char *const names[] = {
    "*atlas*",    "*parc*",     "*aseg*",        "*dseg*",      "*maxprob*", "*labels*",
    "*rois*",     "roi_mni*",   "schaefer2018*", "yeo2011_*",   "aal*",      "*basc_multiscale*",
    "*brodmann*", "talairach*", "julich*",       "*destrieux*", "*glasser*", NULL};
static const char *const others[] = {"*probseg*", "*_mask.*", "*_mask", "*_t1w*", "*_t2w*", NULL};

bool volume_marks_is_volume(const char *name)
{
    return name[volume_stem_length(name)] && !path_ends_in(name, ".img") && !path_ends_in(name, ".img.gz");
}

bool volume_marks_fit(const char *name, const char *const *patterns, unsigned how)
{
    while (*patterns && !text_matches(name, *patterns, how)) {
        patterns++;
    }
    return *patterns;
}

static bool has_table_beside(struct job *job, const char *path)
{
    struct text rest = text_from(job_format(job, "%s/.xml", label_endings(job, false)));
    struct text ending;
    bool found = false;
    for (bool more = true; !found && text_field(&rest, '/', &more, &ending);) {
        const char *table = job_format(job, "%.*s%.*s", (int)volume_stem_length(path), path, TEXT_SHOW(ending, 80U));
        found = !path_ends_in(table, ".json") && system_allows(table, SYSTEM_READ); /* BIDS has one beside each image */
    }
    return found;
}

bool volume_marks_find(struct job *job, double spacing[3], const char *path, bool known)
{
    static const struct volume_wish wish = {.is_header_only = true, .is_peek = true};
    bool labels = false;
    const struct job_mark mark = job_mark(job);
    const struct attempt attempt = job_try(job);
    const struct volume_input *v = volume_open(job, path, &wish);
    const conus_volume_info *info = v ? &v->header.info : NULL;
    if (v && info->volume_count == 1 && info->dim[1] > 1 && info->dim[2] > 1) { /* no values of vertices */
        const char *name = path_base(path);
        struct text text = v->source->head.bytes;
        text.size = v->header.pair ? 0 : smaller_of(text.size, v->header.offset);
        bool has_table = text_mentions(text, "<LabelTable") || text_mentions(text, "LABEL_DTABLE") ||
                         text_mentions(text, "ATLAS_LABEL_TABLE");
        bool has_name = volume_marks_fit(name, names, TEXT_ANY_CASE) && !volume_marks_fit(name, others, TEXT_ANY_CASE);
        memcpy(spacing, info->spacing, sizeof info->spacing);
        labels = known || v->header.intent_code == INTENT_LABEL || has_table || has_name || has_table_beside(job, path);
    }
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    job_release(job, mark);
    return labels;
}
