/* SPDX-License-Identifier: BSD-3-Clause */
/* The table is freesurfer_names.inc. */
#include "loaders/labels/label_format.h"

struct fact {
    uint16_t number;
    uint32_t rgb;
    const char *name;
};

static const struct fact whole[] = {
#include "loaders/labels/freesurfer_names.inc"
};

#define FREESURFER_CORTEX
static const struct fact cortex[] = {
#include "loaders/labels/freesurfer_names.inc"
};

enum { WHOLE_COUNT = sizeof whole / sizeof whole[0], CORTEX_COUNT = sizeof cortex / sizeof cortex[0] };

/* Adds to the numbers of the cortex, and what stands before its names; white matter has the inverse colours. */
static const struct family {
    uint16_t from, to, added;
    const char *prefix;
    uint32_t inverse;
} families[] = {
    {1000, 1999, 0, "ctx-lh-", 0},          {1000, 1999, 1000, "ctx-rh-", 0},  {1000, 1999, 2000, "wm-lh-", 0xffffff},
    {1000, 1999, 3000, "wm-rh-", 0xffffff}, {11100, 11199, 0, "ctx_lh_", 0},   {11100, 11199, 1000, "ctx_rh_", 0},
    {11100, 11199, 2000, "wm_lh_", 0},      {11100, 11199, 3000, "wm_rh_", 0},
};

static const struct fact *find(const struct fact *facts, size_t count, uint32_t number)
{
    size_t i = 0;
    while (i < count && facts[i].number != number) {
        i++;
    }
    return i < count ? &facts[i] : NULL;
}

static void add(struct job *job, struct label_table *out, uint32_t number, const char *prefix, struct fact fact)
{
    struct label *label = labels_add(job, out, number);
    label->has_rgb = true;
    for (int i = 0; i < 3; i++) {
        label->rgb[i] = (uint8_t)(fact.rgb >> (16 - 8 * i));
    }
    labels_set(job, &label->name, text_from(job_format(job, "%s%s", prefix, fact.name)));
}

void freesurfer_names_add(struct job *job, struct label_table *out, const struct label_voxels *voxels)
{
    for (size_t i = 1; job_ok(job) && i < voxels->label_count; i++) { /* the first is 0 */
        const uint32_t number = voxels->labels[i];
        const struct fact *fact = find(whole, WHOLE_COUNT, number);
        if (fact) {
            add(job, out, number, "", *fact);
        }
        for (size_t k = 0; !fact && k < sizeof families / sizeof families[0]; k++) {
            const struct family *family = &families[k];
            bool could =
                number >= (uint32_t)family->from + family->added && number <= (uint32_t)family->to + family->added;
            fact = could ? find(cortex, CORTEX_COUNT, number - family->added) : NULL;
            if (fact) {
                add(job, out, number, family->prefix,
                    (struct fact){.rgb = fact->rgb ^ family->inverse, .name = fact->name});
            }
        }
    }
}
