/* SPDX-License-Identifier: BSD-3-Clause */
#include "cli/answer_format.h"

#include "cli/output.h"

#include <stdlib.h>
#include <string.h>

const char *const answer_formats[] = {"table", "tsv", "json", "ndjson", NULL};

conus_format answer_format(const struct arguments *arguments, size_t format, const char *output)
{
    static const struct {
        const char *ending;
        conus_format format;
    } endings[] = {{".tsv", CONUS_TSV}, {".json", CONUS_JSON}, {".ndjson", CONUS_NDJSON}, {".jsonl", CONUS_NDJSON}};
    if (option_given(arguments, "format") || output_is_stdout(output)) {
        return (conus_format)format;
    }
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends(output, endings[i].ending)) {
            return endings[i].format;
        }
    }
    return CONUS_TABLE;
}

bool answer_sidecar(char **out, conus_format format, const char *output)
{
    char *path = NULL;
    if (!output_is_stdout(output) && format == CONUS_TSV && path_ends(output, ".tsv")) {
        int stem = (int)(strlen(output) - strlen(".tsv"));
        if (asprintf(&path, "%.*s.json", stem, output) < 0) {
            return false;
        }
    }
    *out = path;
    return true;
}
