/* SPDX-License-Identifier: BSD-3-Clause */
/* Any bytes as a file of unknown kind: its description must be one line. */
#include "base/memory.h"
#include "loaders/refuse.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const char *const names[] = {NULL, "a.annot", "a.trx", "a.BRIK.gz", ".gz"};
    uint8_t *copy = memory_copy(data, size, 1);
    const struct bytes bytes = {copy, size};
    for (size_t i = 0; copy && i < sizeof names / sizeof names[0]; i++) {
        const struct file_head head = head_of(names[i], &bytes);
        const struct format *format = format_nearest(&head);
        for (unsigned role = ROLE_VOLUME; role <= ROLE_POSES; role <<= 1) {
            const struct format *found = format_find(&head, role);
            if (found && !(found->roles & role)) {
                abort();
            }
        }
        struct job job = {0};
        file_refuse(&job, names[i], &bytes, "another");
        if (job_ok(&job) || strchr(job.message, '\n') || (format && !format->words)) {
            abort();
        }
        job_end(&job);
    }
    const struct file_head nameless = head_of(NULL, &bytes);
    if (copy && format_is_lines(&bytes) && format_nearest(&nameless) == NULL) {
        abort();
    }
    memory_free(copy);
    return 0;
}
