/* SPDX-License-Identifier: BSD-3-Clause */
/* A shard's sidecar: the values that conus merge takes from it are consistent. */
#include "batch/batch_record.h"
#include "quiet.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct batch_record record;
    FILE *kept = be_quiet();
    int code = batch_record_parse(&record, "fuzz", (const char *)data, size);
    stderr = kept;
    if (!code && (record.shard.index >= record.shard.count || record.header_size > record.bytes ||
                  strlen(record.fingerprint) != sizeof record.fingerprint - 1)) {
        abort();
    }
    return 0;
}
