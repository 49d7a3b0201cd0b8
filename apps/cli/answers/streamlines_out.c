/* SPDX-License-Identifier: BSD-3-Clause */
/* --streamlines-out: takes the streamlines of a selection and writes them. */
#include "cli/answers/streamlines_out.h"

#include "options/messages.h"

const struct option streamlines_out_options[] = {
    {.name = "streamlines-out",
     .type = OPTION_TEXT,
     .offset = offsetof(struct streamlines_out_settings, path),
     .value = "FILE.tck",
     .help = "write the streamlines of bundles that come into the cone or ball, whole, as a tractogram of MRtrix",
     .role = OPTION_WRITES,
     .flags = OPTION_OF_ONE_ATLAS | OPTION_OF_ONE_POSE,
     .endings = ".tck"},
    {0},
};

int streamlines_out_take(conus_streamline_list **out, const struct streamlines_out_settings *settings,
                         const conus_selection *selection)
{
    conus_status status = settings->path ? conus_selection_streamlines(out, selection, 0) : CONUS_OK;
    if (status == CONUS_ERROR_ARGUMENT) {
        return print_usage_error("--streamlines-out: %s", conus_message());
    }
    return status ? print_status(status) : EXIT_DONE;
}

int streamlines_out_write(const conus_streamline_list *list, const struct streamlines_out_settings *settings)
{
    conus_status status = settings->path ? conus_streamline_list_write(list, settings->path) : CONUS_OK;
    return status ? print_status(status) : EXIT_DONE;
}
