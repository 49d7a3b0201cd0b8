/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a file of unknown kind: its description must be one line. */
#include "base/memory.h"
#include "loaders/file_kind.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const names[] = {NULL, "a.annot", "a.trx", "a.BRIK.gz", ".gz"};
    uint8_t *copy = memory_copy(data, size, 1);
    const struct bytes bytes = {copy, size};
    for (size_t i = 0; copy && i < sizeof names / sizeof names[0]; i++) {
        const struct file_kind *kind = file_kind_of(names[i], &bytes);
        if (!file_kind_fail(names[i], &bytes, "another") || strchr(conus_message(), '\n') || (kind && !kind->words)) {
            abort();
        }
    }
    if (copy && format_is_lines(&bytes) && file_kind_of(NULL, &bytes) == NULL) {
        abort();
    }
    memory_free(copy);
    return 0;
}
