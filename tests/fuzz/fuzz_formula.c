/* SPDX-License-Identifier: BSD-3-Clause */
/* A formula of scores from any bytes, evaluated. */
#include "selection/measure/score.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char *name_at(const void *names, size_t index)
{
    static const char *const list[] = {"share", "centre", "intenselect_plus", NULL};
    (void)names;
    return list[index];
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const double values[] = {0.5, 0, -1e300};
    char *text = calloc(size + 1, 1);
    struct formula formula;
    if (!text) {
        return 0;
    }
    if (size) {
        memcpy(text, data, size);
    }
    if (!formula_parse(&formula, text, name_at, NULL) && isinf(formula_value(&formula, values))) {
        abort(); /* a score that is not finite must be NaN */
    }
    free(text);
    return 0;
}
