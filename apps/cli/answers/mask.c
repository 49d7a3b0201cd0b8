/* SPDX-License-Identifier: BSD-3-Clause */
/* --mask: takes the grid of a selection and writes it with its sidecar. */
#include "cli/answers/mask.h"

#include "options/messages.h"
#include "options/output.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const contents[] = {[CONUS_GRID_MASK_OF_AREAS] = "areas",
                                       [CONUS_GRID_MASK_OF_REGION] = "all",
                                       [CONUS_GRID_MAP_OF_LABELS] = "labels",
                                       [CONUS_GRID_MAP_OF_VALUES] = "values",
                                       NULL};

const struct option mask_options[] = {
    {.name = "mask",
     .type = OPTION_TEXT,
     .offset = offsetof(struct mask_settings, path),
     .value = "FILE.nii.gz",
     .help = "write the voxels in the cone as a volume on the atlas's grid, with a .json beside it",
     .words = "NIfTI, volume",
     .role = OPTION_WRITES,
     .flags = OPTION_OF_ONE_ATLAS | OPTION_OF_ONE_POSE,
     .endings = ".nii.gz .nii"},
    {.name = "mask-of",
     .type = OPTION_CHOICE,
     .offset = offsetof(struct mask_settings, content),
     .value = "WHAT",
     .help = "content of the mask: 1 in voxels of areas, 1 in all voxels, labels of areas, or values of a pathway; "
             "without it a name that ends in _dseg means labels, one that ends in _probseg values:",
     .choices = contents,
     .needs = "mask"},
    {.name = "mask-object",
     .type = OPTION_TEXT,
     .offset = offsetof(struct mask_settings, object),
     .value = "NAME",
     .help = "only this area with those below it in the tree, or this pathway: a name, abbreviation or label",
     .role = OPTION_ASKS,
     .needs = "mask"},
    {0},
};

/* Length of the path without .nii or .nii.gz; 0 if it has neither. */
static size_t stem_length(const char *path)
{
    size_t length = strlen(path);
    return path_ends(path, ".nii.gz") ? length - strlen(".nii.gz")
           : path_ends(path, ".nii")  ? length - strlen(".nii")
                                      : 0;
}

static bool stem_ends(const char *path, const char *ending)
{
    size_t length = stem_length(path);
    size_t wanted = strlen(ending);
    return length >= wanted && memcmp(path + length - wanted, ending, wanted) == 0;
}

static conus_grid_content content_of(const struct mask_settings *settings, const struct arguments *arguments)
{
    return option_given(arguments, "mask-of")      ? (conus_grid_content)settings->content
           : stem_ends(settings->path, "_dseg")    ? CONUS_GRID_MAP_OF_LABELS
           : stem_ends(settings->path, "_probseg") ? CONUS_GRID_MAP_OF_VALUES
                                                   : CONUS_GRID_MASK_OF_AREAS;
}

bool mask_init(struct mask *out, const struct mask_settings *settings, const struct arguments *arguments)
{
    *out = (struct mask){.settings = settings};
    if (!settings->path) {
        return true;
    }
    out->content = content_of(settings, arguments);
    if (asprintf(&out->sidecar, "%.*s.json", (int)stem_length(settings->path), settings->path) < 0) {
        out->sidecar = NULL;
        print_error_line("not enough memory");
    }
    return out->sidecar;
}

void mask_finish(struct mask *mask)
{
    conus_grid_destroy(mask->grid);
    free(mask->sidecar);
}

int mask_take(struct mask *mask, const conus_atlas *atlas, const conus_selection *selection)
{
    conus_grid_options options = {.content = mask->content};
    conus_status status = CONUS_OK;
    if (!mask->settings || !mask->settings->path || mask->grid) {
        return EXIT_DONE;
    }
    if (mask->settings->object) {
        status = conus_atlas_find(&options.object, atlas, mask->settings->object);
    }
    status = status ? status : conus_selection_grid(&mask->grid, selection, &options);
    if (status == CONUS_ERROR_ARGUMENT) {
        return print_usage_error("--mask: %s", conus_message());
    }
    return status ? print_status(status) : EXIT_DONE;
}

/* Beside the mask, which is there. */
static int write_sidecar(const struct mask *mask, conus_report *report, const struct provenance *provenance)
{
    struct provenance own = *provenance;
    const char *text = NULL;
    size_t size = 0;
    char *whole = NULL;
    provenance_add_output(&own, "mask", mask->settings->path, NULL, 0);
    conus_status status = conus_report_grid_sidecar(&text, &size, report, mask->grid);
    int code = status ? print_status(status) : provenance_complete(&whole, text, size, &own);
    if (whole) {
        code = output_write(mask->sidecar, whole, strlen(whole));
    }
    free(whole);
    return code;
}

int mask_write(const struct mask *mask, conus_report *report, const struct provenance *provenance)
{
    if (!mask->grid) {
        return EXIT_DONE;
    }
    conus_status status = conus_grid_write(mask->grid, mask->settings->path);
    return status ? print_status(status) : write_sidecar(mask, report, provenance);
}
