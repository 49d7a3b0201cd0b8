/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the caption of a picture. */
#include "cli/cmd_render.h"

#include "base/system/system.h"
#include "cli/cite/citation.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include "conus/own.h"

#include <stdlib.h>
#include <string.h>

int caption_take(struct caption *caption, const conus_image *image)
{
    caption->legend = caption->legend ? caption->legend : strdup(conus_image_legend(image));
    return caption->legend ? EXIT_DONE : print_no_memory();
}

int caption_ask(struct caption *caption, const conus_selector *selector, const conus_selection *selection,
                const conus_frame *frame, const struct arguments *arguments, const char *region)
{
    const conus_report_options options = {.frame = frame, .no_voxels = true};
    const struct question question = {arguments, "answers", region};
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_report_create(&report, selector, &options);
    status = status ? status : conus_report_add(report, "1", selection);
    status = status ? status : conus_report_sidecar(&text, &size, report);
    json_t *root = status ? NULL : json_loadb(text, size, 0, NULL);
    conus_report_destroy(report);
    if (status) {
        return print_status(status);
    }
    if (!root || json_object_set_new(root, "Question", question_json(&question))) {
        json_decref(root);
        return print_no_memory();
    }
    caption->sidecar = root;
    return EXIT_DONE;
}

/* From where on pathways count, which the paragraph says of a cone's. */
static void put_thresholds(FILE *out, const conus_atlas *atlas)
{
    bool some = false;
    for (size_t k = 1; k <= conus_atlas_object_count(atlas); k++) {
        const conus_object *object = conus_atlas_object(atlas, k);
        if (object->kind == CONUS_KIND_PATHWAY && !object->is_band) {
            fprintf(out, "%s: values of at least %.9g.\n", object->name,
                    conus_atlas_volume(atlas, object->volume)->threshold);
            some = true;
        }
    }
    fputs(some ? "\n" : "", out);
}

static void put_caption(FILE *out, const struct caption *caption)
{
    fprintf(out, "%s.\n\n", caption->shown);
    if (caption->legend && caption->legend[0]) {
        fprintf(out, "%s\n", caption->legend);
    }
    for (size_t i = 0; warning_line(i); i++) {
        fprintf(out, "Warning: %s\n", warning_line(i));
    }
    for (size_t i = 0; note_line(i); i++) {
        fprintf(out, "Note: %s\n", note_line(i));
    }
    fputs(warning_line(0) || note_line(0) ? "\n" : "", out);
}

int caption_write(const struct caption *caption, const char *path, const char *given, const conus_atlas *atlas)
{
    struct cited_atlas *cited = calloc(1, sizeof *cited);
    struct citation citation = {
        .sidecar = caption->sidecar, .version = conus_version(), .atlases = cited, .atlas_count = cited ? 1 : 0};
    struct system_text text;
    FILE *out = system_text_open(&text);
    struct atlas_name found = {0};
    int code = cited ? atlas_name_find(&found, given) : print_no_memory();
    code = code ? code : cited_atlas_find(cited, given, found.atlas ? found.atlas->name : NULL, found.path, atlas);
    citation.sidecar = code || (citation.sidecar && citation_is_known(&citation)) ? citation.sidecar : NULL;
    if (!code && out) {
        put_caption(out, caption);
        if (!citation.sidecar) {
            put_thresholds(out, atlas);
        }
        code = citation_text(out, &citation);
    }
    bool is_whole = system_text_close(&text);
    code = code || is_whole ? code : print_no_memory();
    if (!code) {
        conus_plain_text(text.data);
        code = output_write(path, text.data, strlen(text.data));
    }
    free(text.data);
    atlas_name_finish(&found);
    citation_finish(&citation);
    return code;
}

void caption_finish(struct caption *caption)
{
    free(caption->shown);
    free(caption->legend);
    json_decref(caption->sidecar);
}
