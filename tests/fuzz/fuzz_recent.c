/* SPDX-License-Identifier: BSD-3-Clause */
/* The list of recent files: paths in a list that parses are absolute; one that does not parse changes nothing. */
#include "viewer/window/start.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct recent recent;
    recent.count = 77;
    bool fine = recent_parse(&recent, (const char *)data, size);
    if (fine ? recent.count > RECENT_LIMIT : recent.count != 77) {
        abort();
    }
    for (size_t i = 0; fine && i < recent.count; i++) {
        if (recent.paths[i][0] != '/' || !memchr(recent.paths[i], '\0', SYSTEM_PATH)) {
            abort();
        }
    }
    return 0;
}
