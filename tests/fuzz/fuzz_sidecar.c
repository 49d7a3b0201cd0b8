/* SPDX-License-Identifier: BSD-3-Clause */
/* A sidecar from a stranger: the values that conus verify takes from it are consistent. */
#include "cli/verify/verify.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const struct recorded_file *files, size_t count, bool are_sorted)
{
    for (size_t i = 0; i < count; i++) {
        const struct recorded_file *file = &files[i];
        bool has_path = file->path && *file->path;
        bool is_sorted = !are_sorted || !i || strcmp(files[i - 1].path, file->path) < 0;
        if ((are_sorted && !has_path) || (file->sha256 && strlen(file->sha256) != 64) || file->bytes < -1 ||
            !is_sorted) {
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct record record;
    if (record_parse(&record, (const char *)data, size)) {
        return 0;
    }
    check(record.inputs, record.input_count, true);
    check(record.outputs, record.output_count, false);
    if (!record.version || !record.line.count || record.line.words[record.line.count] ||
        (record.is_intact && !record.is_sealed)) {
        abort();
    }
    record_finish(&record);
    return 0;
}
