/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as FSL atlas, Workbench and AFNI table, whatever their outermost element is. */
#include "base/memory.h"
#include "loaders/fsl_atlas.h"
#include "loaders/label_parse.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void parse_fsl(struct text text)
{
    struct fsl_atlas atlas = {0};
    struct notes notes = {0};
    if (!fsl_atlas_parse(&atlas, text, &notes)) {
        fsl_atlas_finish(&atlas);
    }
    notes_finish(&notes);
}

static void parse(const struct label_format *format, struct text text)
{
    struct label_table table = {0};
    struct notes notes = {0};
    for (size_t volume = 0; volume < 2; volume++) {
        if (!label_text_parse(&table, format, text, volume, &notes)) {
            label_table_finish(&table);
        }
    }
    notes_finish(&notes);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct text text = label_text_of(data, size);
    parse_fsl(text);
    parse(&label_format_workbench, text);
    parse(&label_format_afni, text);
    return 0;
}
