/* SPDX-License-Identifier: BSD-3-Clause */
#include "loaders/labels/globe_metadata.h"

#include "base/json_text.h"

#include <stdio.h>

conus_status globe_metadata_parse(char out[GLOBE_ORIENTATION], struct text text)
{
    json_t *root = NULL;
    conus_status status = json_text_load(&root, text);
    const json_t *orientation = json_object_get(root, "orientation");
    if (!status && !json_is_object(root)) {
        status = fail(CONUS_ERROR_DATA, "not a JSON object");
    }
    if (!status && orientation && !json_is_string(orientation)) {
        status = fail(CONUS_ERROR_DATA, "orientation: a text of three letters is needed");
    }
    if (!status && orientation) {
        snprintf(out, GLOBE_ORIENTATION, "%s", json_string_value(orientation));
    }
    json_decref(root);
    return status;
}
