/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes reports with their sidecars. */
#include "options/answer_file.h"

#include "options/messages.h"
#include "options/output.h"

#include <stdlib.h>
#include <string.h>

static const char *option_of(const struct provenance *provenance)
{
    return provenance->option ? provenance->option : "output";
}

int answer_write_sidecar(conus_report *report, const char *path, const char *sidecar,
                         const struct provenance *provenance, const char *text, size_t size)
{
    struct provenance own = *provenance;
    const char *head = NULL;
    size_t length = 0;
    char *whole = NULL;
    if (!sidecar) {
        return EXIT_DONE;
    }
    provenance_add_output(&own, option_of(&own), output_is_stdout(path) ? NULL : path, text, size);
    conus_status status = conus_report_sidecar(&head, &length, report);
    int code = status ? print_status(status) : provenance_complete(&whole, head, length, &own);
    if (whole) {
        code = output_write(sidecar, whole, strlen(whole));
    }
    free(whole);
    return code;
}

/* The checksum is of its rows. */
int answer_write_json(const char *path, const struct provenance *provenance, const char *text, size_t size)
{
    struct provenance own = *provenance;
    const char *rows = provenance_json_rows(text, size);
    char *whole = NULL;
    provenance_add_output(&own, option_of(&own), output_is_stdout(path) ? NULL : path, rows,
                          size - (size_t)(rows - text));
    int code = provenance_complete(&whole, text, size, &own);
    if (whole) {
        code = output_write(path, whole, strlen(whole));
    }
    free(whole);
    return code;
}

int answer_write(conus_report *report, const char *path, const char *sidecar, const struct provenance *provenance)
{
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_report_text(&text, &size, report);
    if (status) {
        return print_status(status);
    }
    if (provenance_json_rows(text, size)) {
        return answer_write_json(path, provenance, text, size);
    }
    if (!sidecar) {
        return output_write_table(path, text, size);
    }
    char *kept = malloc(size + 1); /* the sidecar takes its place in the report */
    if (!kept) {
        return print_no_memory();
    }
    memcpy(kept, text, size);
    int code = answer_write_sidecar(report, path, sidecar, provenance, kept, size);
    code = code ? code : output_write_table(path, kept, size);
    free(kept);
    return code;
}
