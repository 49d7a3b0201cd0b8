/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as an FSL atlas, a Workbench table and an AFNI table, whatever their outermost element is. */
#include "loaders/labels/label_format.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A volume of 3 x 2 x 2 labels, in which points may lie. */
static uint16_t places[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
static uint32_t labels[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
static const struct label_voxels voxels = {.count = 12, .narrow = places, .labels = labels, .label_count = 12};
static const conus_volume_info infos[2] = {{.dim = {3, 2, 2}}, {.dim = {3, 2, 2}, .volume = 1}};

static void parse(label_parse *parser, struct text text)
{
    const struct label_format format = {"XML", LABEL_MARKUP, .parse = parser};
    for (size_t volume = 0; volume < 2; volume++) {
        const struct label_use use = {.info = &infos[volume], .voxels = &voxels};
        struct job job = {0};
        label_text_parse(&job, labels_new(&job), &format, text, &use);
        job_end(&job);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct text text = text_from_bytes(data, size);
    parse(label_parse_fsl, text);
    parse(label_parse_workbench, text);
    parse(label_parse_afni, text);
    return 0;
}
