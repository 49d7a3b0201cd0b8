/* SPDX-License-Identifier: BSD-3-Clause */
#include "base/json_text.h"

#include <stdio.h>

static conus_status fail_syntax(const json_error_t *error)
{
    char text[JSON_ERROR_TEXT_LENGTH];
    if (json_error_code(error) == json_error_out_of_memory) {
        return fail(CONUS_ERROR_MEMORY, "no memory for the JSON text");
    }
    snprintf(text, sizeof text, "%s", error->text);
    for (char *c = text; *c; c++) {
        *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
    }
    return fail(CONUS_ERROR_DATA, "line %d, column %d: %s", error->line, error->column, text);
}

conus_status json_text_load(json_t **out, struct text text)
{
    json_error_t error;
    json_t *root = json_loadb(text.data, text.size, JSON_REJECT_DUPLICATES, &error);
    if (!root) {
        return fail_syntax(&error);
    }
    *out = root;
    return CONUS_OK;
}
