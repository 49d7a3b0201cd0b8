/* SPDX-License-Identifier: BSD-3-Clause */
/* The progress of a plan as text: progress that is read is written the same again. */
#include "selection/plan/plan_known.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static conus_status write_again(struct buffer *out, const char *text, size_t size)
{
    struct plan_known known;
    conus_status status = plan_known_parse(&known, text, size);
    if (!status) {
        plan_known_format(out, &known);
        status = buffer_status(out);
    }
    plan_known_finish(&known);
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct buffer once = {0};
    struct buffer twice = {0};
    if (!write_again(&once, (const char *)data, size) &&
        (write_again(&twice, once.data, once.size) || once.size != twice.size ||
         memcmp(once.data, twice.data, once.size) != 0)) {
        abort();
    }
    buffer_finish(&once);
    buffer_finish(&twice);
    return 0;
}
