/* SPDX-License-Identifier: BSD-3-Clause */
/* Zip archives: every listed file lies inside, behind those before it by name, and has the same stored bytes both ways.
 */
#include "base/formats/packed.h"

#include <stdlib.h>
#include <string.h>

enum { LIMIT = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_bytes(const struct zip *zip, const struct zip_entry *entry)
{
    struct job job = {0};
    struct job verifying = {0};
    const struct bytes bytes = zip_unpack(&job, zip, entry, LIMIT);
    if (job_ok(&job) && bytes.size != entry->size) {
        abort();
    }
    if (!entry->is_packed && entry->size <= LIMIT) {
        zip_verify(&verifying, zip, entry);
        if (verifying.status != job.status ||
            (bytes.size && memcmp(bytes.data, zip->data + entry->at, bytes.size) != 0)) {
            abort();
        }
    }
    job_end(&verifying);
    job_end(&job);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct job job = {0};
    const struct zip zip = zip_parse(&job, data, size);
    for (size_t i = 0; i < zip.count; i++) {
        const struct zip_entry *entry = &zip.entries[i];
        if (entry->at > size || entry->stored > size - entry->at ||
            (!entry->is_packed && entry->stored != entry->size) ||
            (i && text_compare(entry[-1].name, entry->name) >= 0)) {
            abort();
        }
        check_bytes(&zip, entry);
    }
    job_end(&job);
    return 0;
}
