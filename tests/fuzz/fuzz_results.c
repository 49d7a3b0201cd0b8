/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables for `conus diff`: every row must be found again by its own key. */
#include "cli/answers/answers.h"
#include "options/messages.h"
#include "quiet.h"

#include <stdint.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct results results;
    FILE *kept = be_quiet();
    int code = results_parse(&results, "fuzz", (const char *)data, size);
    stderr = kept;
    if (code != EXIT_DONE) {
        return 0;
    }
    for (size_t row = 0; row < results.rows; row++) {
        size_t found;
        if (!results_find(&results, &results, row, &found) || found != row) {
            abort();
        }
    }
    results_finish(&results);
    return 0;
}
