/* SPDX-License-Identifier: BSD-3-Clause */
/* The sidecar of a part: the values that are taken from it when parts are joined are consistent. */
#include "cli/batch/parts.h"
#include "quiet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct batch_record record;
    FILE *kept = be_quiet();
    conus_pose_findings found[1] = {{0}};
    int code = batch_record_parse(&record, found, 1, "fuzz", (const char *)data, size);
    stderr = kept;
    if (!code && (record.shard.index >= record.shard.count || record.header_size > record.bytes ||
                  strlen(record.fingerprint) != sizeof record.fingerprint - 1 || !isfinite(found[0].away.angle))) {
        abort();
    }
    return 0;
}
