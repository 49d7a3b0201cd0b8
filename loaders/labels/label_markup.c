/* SPDX-License-Identifier: BSD-3-Clause */
/* Which XML it is, by the outermost element; and Workbench's label table (NIfTI extension 30). */
#include "loaders/labels/label_format.h"

#include "base/formats/xml.h"
#include "loaders/labels/fsl_atlas.h"
#include "loaders/labels/label_cells.h"

#include <string.h>

struct workbench {
    struct label_table *out;
    struct notes *notes;
    size_t wanted;  /* volume of a 4-D file */
    bool elsewhere; /* inside another volume's VolumeInformation */
    bool in_label;  /* label is being filled */
    struct label label;
};

static conus_status workbench_start(void *user, const struct xml_event *event)
{
    struct workbench *workbench = user;
    if (strcmp(event->name, "VolumeInformation") == 0) {
        const char *index = xml_attribute(event, "Index");
        uint64_t volume;
        if (!index || !text_to_uint(text_from(index), UINT32_MAX, &volume)) {
            return fail(CONUS_ERROR_DATA, "line %zu: VolumeInformation needs Index, a whole number", event->line);
        }
        workbench->elsewhere = volume != workbench->wanted;
        return CONUS_OK;
    }
    if (strcmp(event->name, "Label") == 0 && !workbench->elsewhere) {
        workbench->in_label = true;
        return label_element(&workbench->label, event);
    }
    return CONUS_OK;
}

static conus_status workbench_end(void *user, const struct xml_event *event)
{
    struct workbench *workbench = user;
    if (strcmp(event->name, "VolumeInformation") == 0) {
        workbench->elsewhere = false;
    }
    if (strcmp(event->name, "Label") != 0 || !workbench->in_label) {
        return CONUS_OK;
    }
    workbench->in_label = false;
    conus_status status = label_set_text(&workbench->label.name, event->text);
    return label_keep(workbench->out, &workbench->label, status, workbench->notes);
}

/* Of a 4-D file the table of the volume that is asked for, else of the first. */
static conus_status parse_workbench(struct label_table *out, struct text text, const struct label_use *use,
                                    struct notes *notes)
{
    struct workbench workbench = {.out = out, .notes = notes, .wanted = use->info ? use->info->volume : 0};
    struct xml_handler handler = {.start = workbench_start, .end = workbench_end, .user = &workbench};
    return xml_parse(&handler, text);
}

static conus_status parse_fsl(struct label_table *out, struct text text, const struct label_use *use,
                              struct notes *notes)
{
    struct fsl_atlas atlas = {0};
    conus_status status = fsl_atlas_parse(&atlas, text);
    status = status ? status : fsl_atlas_number(&atlas, use, notes);
    if (!status) {
        *out = atlas.labels; /* it was empty */
        atlas.labels = (struct label_table){0};
    }
    fsl_atlas_finish(&atlas);
    return status;
}

const struct label_format label_format_workbench = {"Workbench label table", NULL, parse_workbench};
const struct label_format label_format_fsl = {"FSL atlas XML", NULL, parse_fsl};
const struct label_format label_format_spm = {"SPM atlas XML", NULL, parse_fsl};

const struct label_format *label_format_of_markup(struct text text)
{
    static const struct {
        const char *root;
        const struct label_format *format;
    } roots[] = {
        {"atlas", &label_format_fsl},
        {"CaretExtension", &label_format_workbench},
        {"CaretVolumeExtension", &label_format_workbench},
        {"LabelTable", &label_format_workbench},
        {"AFNI_attributes", &label_format_afni},
        {"AFNI_atr", &label_format_afni},
        {"VALUE_LABEL_DTABLE", &label_format_afni},
        {"ATLAS_LABEL_TABLE", &label_format_afni},
    };
    struct text root = xml_root(text);
    for (size_t i = 0; i < sizeof roots / sizeof roots[0]; i++) {
        if (text_equal(root, roots[i].root)) {
            bool spm = roots[i].format == &label_format_fsl && text_mentions(text, "<index>");
            return spm ? &label_format_spm : roots[i].format;
        }
    }
    return NULL;
}
