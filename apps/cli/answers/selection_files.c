/* SPDX-License-Identifier: BSD-3-Clause */
/* Files that show one selection: --image, --mask with its sidecar, --streamlines-out. */
#include "cli/answers/answers.h"

#include "base/path.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const mask_contents[] = {[CONUS_GRID_MASK_OF_AREAS] = "areas",
                                            [CONUS_GRID_MASK_OF_REGION] = "all",
                                            [CONUS_GRID_MAP_OF_LABELS] = "labels",
                                            [CONUS_GRID_MAP_OF_VALUES] = "values",
                                            NULL};

const struct option selection_file_options[] = {
    {OPTION_VALUED("image", struct selection_file_settings, image, "FILE"),
     .help = "write the image seen from the device: .exr with id, X, Y, Z, t per pixel, or .png in the areas' colours",
     .words = "figure, picture", .flags = OPTION_OF_CONE | OPTION_OF_ONE_ATLAS | OPTION_OF_ONE_POSE | OPTION_IS_PICTURE,
     .endings = ".exr .png", OPTION_WRITING(PICTURE)},
    {OPTION_VALUED("mask", struct selection_file_settings, mask, "FILE.nii.gz"),
     .help = "write the voxels in the cone as a volume on the atlas's grid, with a .json beside it",
     .words = "NIfTI, volume", .flags = OPTION_OF_REGION | OPTION_OF_ONE_ATLAS | OPTION_OF_ONE_POSE,
     .endings = ".nii.gz .nii", OPTION_WRITING(VOLUME)},
    {OPTION_VALUED("mask-of", struct selection_file_settings, mask_content, "WHAT"),
     .help = "content of the mask: 1 in voxels of areas, 1 in all voxels, labels of areas, or values of a pathway:",
     .otherwise = "as the name ends: _dseg means labels, _probseg values; else areas", .choices = mask_contents,
     .needs = "mask"},
    {OPTION_VALUED("mask-object", struct selection_file_settings, mask_object, "NAME"),
     .help = "only this area with those below it in the tree, or this pathway: a name, abbreviation or label",
     .role = OPTION_ASKS, .needs = "mask"},
    {OPTION_VALUED("streamlines-out", struct selection_file_settings, streamlines, "FILE.tck"),
     .help = "write the streamlines of bundles that come into the cone or ball, whole, as a tractogram of MRtrix",
     .flags = OPTION_OF_REGION | OPTION_OF_ONE_ATLAS | OPTION_OF_ONE_POSE, .endings = ".tck", OPTION_WRITING(TRACTS)},
    {0},
};

/* Length of the path without .nii or .nii.gz, one of which it has. */
static size_t mask_stem(const char *path)
{
    return strlen(path) - strlen(path_ends_in(path, ".nii.gz") ? ".nii.gz" : ".nii");
}

static bool stem_ends(const char *path, const char *ending)
{
    size_t length = mask_stem(path);
    size_t wanted = strlen(ending);
    return length >= wanted && memcmp(path + length - wanted, ending, wanted) == 0;
}

int selection_files_init(struct selection_files *out, struct outputs *outputs,
                         const struct selection_file_settings *settings, const struct arguments *arguments)
{
    const char *path = settings->mask;
    *out = (struct selection_files){.settings = settings};
    if (!path) {
        return EXIT_DONE;
    }
    out->mask_content = option_given(arguments, "mask-of") ? (conus_grid_content)settings->mask_content
                        : stem_ends(path, "_dseg")         ? CONUS_GRID_MAP_OF_LABELS
                        : stem_ends(path, "_probseg")      ? CONUS_GRID_MAP_OF_VALUES
                                                           : CONUS_GRID_MASK_OF_AREAS;
    if (asprintf(&out->mask_sidecar, "%.*s.json", (int)mask_stem(path), path) < 0) {
        out->mask_sidecar = NULL;
        return print_no_memory();
    }
    if (sidecar_is_none(option_text(arguments, "sidecar"))) {
        int code = answer_check_no_sidecar(out->mask_sidecar);
        free(out->mask_sidecar);
        out->mask_sidecar = NULL;
        return code;
    }
    outputs_add_sidecar(outputs, "mask", out->mask_sidecar);
    return EXIT_DONE;
}

void selection_files_finish(struct selection_files *files)
{
    conus_image_destroy(files->image);
    conus_grid_destroy(files->mask);
    free(files->mask_sidecar);
    conus_streamline_list_destroy(files->streamlines);
    *files = (struct selection_files){0};
}

static int take_mask(struct selection_files *files, const conus_selection *selection, const conus_atlas *atlas)
{
    conus_grid_options options = {.content = files->mask_content};
    const char *object = files->settings->mask_object;
    conus_status status = object ? conus_atlas_find(&options.object, atlas, object) : CONUS_OK;
    status = status ? status : conus_selection_grid(&files->mask, selection, &options);
    return status == CONUS_ERROR_ARGUMENT ? print_usage_error("--mask: %s", conus_message())
           : status                       ? print_status(status)
                                          : EXIT_DONE;
}

int selection_files_take(struct selection_files *files, const conus_selection *selection, const conus_atlas *atlas)
{
    const struct selection_file_settings *settings = files->settings;
    conus_status status = settings->image ? conus_selection_image(&files->image, selection) : CONUS_OK;
    int code = status ? print_status(status) : settings->mask ? take_mask(files, selection, atlas) : EXIT_DONE;
    if (!code && settings->streamlines) {
        status = conus_selection_streamlines(&files->streamlines, selection, 0);
        code = status == CONUS_ERROR_ARGUMENT ? print_usage_error("--streamlines-out: %s", conus_message())
               : status                       ? print_status(status)
                                              : EXIT_DONE;
    }
    return code;
}

/* Writes the mask, and then its sidecar. */
static int write_mask(const struct selection_files *files, conus_report *report, const struct provenance *provenance)
{
    struct provenance own = *provenance;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_grid_write(files->mask, files->settings->mask);
    status = status ? status : conus_report_grid_sidecar(&text, &size, report, files->mask);
    if (status) {
        return print_status(status);
    }
    provenance_add_output(&own, "mask", files->settings->mask, NULL, 0);
    return files->mask_sidecar ? provenance_write(files->mask_sidecar, text, size, &own) : EXIT_DONE;
}

int selection_files_write(const struct selection_files *files, conus_report *report,
                          const struct provenance *provenance)
{
    const struct selection_file_settings *settings = files->settings;
    conus_status status = files->image ? conus_image_write(files->image, settings->image) : CONUS_OK;
    if (!status && files->streamlines) {
        status = conus_streamline_list_write(files->streamlines, settings->streamlines);
    }
    return status ? print_status(status) : files->mask ? write_mask(files, report, provenance) : EXIT_DONE;
}
