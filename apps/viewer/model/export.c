/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the answers by the writers of conus query. */
#include "viewer/model/export.h"

#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"

#include <stdio.h>
#include <stdlib.h>

static int write_reports(struct viewer *viewer, conus_report **reports, const char *path, conus_format format)
{
    const struct provenance provenance = {0};
    char *sidecar = format == CONUS_FORMAT_JSON ? NULL : provenance_path(path); /* JSON is its own */
    bool whole = sidecar || format == CONUS_FORMAT_JSON;
    conus_status status = whole ? viewer_report(reports, viewer, format, NULL) : CONUS_ERROR_MEMORY;
    int code = status ? print_status(status) : answer_write(reports[0], path, sidecar, &provenance);
    free(sidecar);
    return code;
}

bool export_results(struct viewer *viewer, const char *path, char why[EXPORT_WHY])
{
    conus_format format;
    if (!output_format(&format, path)) {
        snprintf(why, EXPORT_WHY, "%s ends in none of .tsv, .csv and .json", path);
        return false;
    }
    conus_report **reports = calloc(viewer->atlas_count, sizeof(conus_report *));
    messages_hold(true);
    int code = reports ? write_reports(viewer, reports, path, format) : print_status(CONUS_ERROR_MEMORY);
    messages_hold(false);
    for (size_t i = 0; reports && i < viewer->atlas_count; i++) {
        conus_report_destroy(reports[i]);
    }
    free((void *)reports);
    if (code) {
        snprintf(why, EXPORT_WHY, "%s", error_line());
    }
    return !code;
}
