/* SPDX-License-Identifier: BSD-3-Clause */
/* Zip archives: every listed file lies inside, is found by its name, and has the same stored bytes both ways. */
#include "base/formats/zip.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 1 << 20 };

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check_bytes(const struct zip *zip, const struct zip_entry *entry)
{
    struct bytes bytes = {0};
    conus_status status = zip_unpack(&bytes, zip, entry, LIMIT);
    if (!status && bytes.size != entry->size) {
        abort();
    }
    if (!entry->is_packed && entry->size <= LIMIT &&
        (zip_verify(zip, entry) != status ||
         (!status && bytes.size && memcmp(bytes.data, zip->data + entry->at, bytes.size) != 0))) {
        abort();
    }
    bytes_finish(&bytes);
}

static void check(const struct zip *zip, const struct zip_entry *entry, size_t size)
{
    char name[256];
    if (entry->at > size || entry->stored > size - entry->at || (!entry->is_packed && entry->stored != entry->size)) {
        abort();
    }
    if (entry->name.size < sizeof name) {
        snprintf(name, sizeof name, "%.*s", (int)entry->name.size, entry->name.data);
        if (zip_find(zip, name) != entry) {
            abort();
        }
    }
    check_bytes(zip, entry);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct zip zip = {0};
    if (zip_parse(&zip, data, size) == CONUS_OK) {
        for (size_t i = 0; i < zip.count; i++) {
            check(&zip, &zip.entries[i], size);
        }
    }
    zip_finish(&zip);
    return 0;
}
