/* SPDX-License-Identifier: BSD-3-Clause */
/* Workbench's label table (NIfTI extension 30). */
#include "loaders/labels/label_format.h"

#include "base/formats/xml.h"

#include <string.h>

struct workbench {
    struct job *job;
    struct label_table *out;
    size_t wanted;  /* volume of a 4-D file */
    bool elsewhere; /* inside another volume's VolumeInformation */
    bool in_label;  /* label is being filled */
    struct label label;
};

static conus_status start_element(void *user, const struct xml_event *event)
{
    struct workbench *workbench = user;
    struct job *job = workbench->job;
    if (strcmp(event->name, "VolumeInformation") == 0) {
        const char *index = xml_attribute(event, "Index");
        uint64_t volume = 0;
        if (!index || !text_to_uint(text_from(index), UINT32_MAX, &volume)) {
            job_bad(job, "line %zu: VolumeInformation needs Index, a whole number", event->line);
        }
        workbench->elsewhere = volume != workbench->wanted;
    } else if (strcmp(event->name, "Label") == 0 && !workbench->elsewhere) {
        workbench->in_label = true;
        label_element(job, &workbench->label, event);
    }
    return job->status;
}

static conus_status end_element(void *user, const struct xml_event *event)
{
    struct workbench *workbench = user;
    if (strcmp(event->name, "VolumeInformation") == 0) {
        workbench->elsewhere = false;
    } else if (strcmp(event->name, "Label") == 0 && workbench->in_label) {
        workbench->in_label = false;
        labels_keep(workbench->job, workbench->out,
                    &(struct label_row){.label = workbench->label, .name = event->text});
    }
    return workbench->job->status;
}

/* Of a 4-D file the table of the volume that is asked for, else of the first. */
void label_parse_workbench(struct job *job, struct label_table *out, struct text text, const struct label_use *use)
{
    struct workbench workbench = {.job = job, .out = out, .wanted = use->info ? use->info->volume : 0};
    static const char known[] =
        "CaretExtension/CaretVolumeExtension/Date/VolumeInformation/VolumeType/LabelTable/Label/"
        "StudyMetaDataLinkSet/StudyMetaDataLink/MetaData/MD/Name/Value/UnitString";
    const struct xml_handler handler = {
        .start = start_element, .end = end_element, .user = &workbench, .known = known, .strange = &job->notes};
    (void)JOB_CALL(job, xml_parse(&handler, text));
}
