/* SPDX-License-Identifier: BSD-3-Clause */
/* The key "context" of a manifest, and which volume of a file an entry is. */
#include "loaders/manifest/manifest_context.h"

#include "base/memory.h"

#include <stddef.h>

#define AT(type, member) offsetof(struct type, member)

conus_status manifest_volume_number_read(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_volume *out = field;
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < 0 || number > UINT32_MAX) {
        return schema_fail(place, value, "a whole number from 0");
    }
    out->chosen = true;
    out->volume = (uint32_t)number;
    return CONUS_OK;
}

conus_status manifest_resolution_read(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_volume *out = field;
    if (json_array_size(value) != 3) {
        return schema_fail(place, value, "a list of three numbers, in micrometres,");
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 3; i++) {
        struct schema_place inner = schema_element(place, i);
        status = schema_positive(&out->resolution[i], json_array_get(value, i), &inner);
    }
    return status;
}

void manifest_volume_finish(struct manifest_volume *volume)
{
    memory_free(volume->file);
    memory_free(volume->orientation);
}

static conus_status read_transfer_file(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_context *context = field;
    context->transfer_is_file = true;
    return schema_path(&context->transfer, value, place);
}

static conus_status read_transfer(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_context *context = field;
    static const struct schema_field keys[] = {{"file", read_transfer_file, 0, true}, {0}};
    return json_is_object(value) ? schema_object(context, value, keys, place)
                                 : schema_text(&context->transfer, value, place);
}

static conus_status read_opacity(void *field, const json_t *value, const struct schema_place *place)
{
    double *out = field;
    *out = json_number_value(value);
    return *out > 0 && *out <= 1 ? CONUS_OK : schema_fail(place, value, "a number above 0 to 1");
}

static conus_status read_one(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(manifest_context, source.file), true},
        {"volume", manifest_volume_number_read, AT(manifest_context, source), false},
        {"resolution", manifest_resolution_read, AT(manifest_context, source), false},
        {"orientation", schema_text, AT(manifest_context, source.orientation), false},
        {"transfer", read_transfer, 0, false},
        {"blocks", schema_positive, AT(manifest_context, blocks), false},
        {"opacity", read_opacity, AT(manifest_context, opacity), false},
        {"moves", schema_flag, AT(manifest_context, moves), false},
        {0},
    };
    struct manifest_context *out = field;
    return schema_path_or_object(&out->source.file, out, value, keys, place);
}

conus_status manifest_contexts_read(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    if (json_is_array(value)) {
        return schema_list((void **)&out->contexts, &out->context_count, sizeof *out->contexts, MANIFEST_MANY, value,
                           read_one, place);
    }
    if (!json_is_string(value) && !json_is_object(value)) {
        return schema_fail(place, value, "a path, an object or a list of these");
    }
    out->contexts = memory_zeroed(1, sizeof *out->contexts);
    out->context_count = out->contexts ? 1 : 0;
    return out->contexts ? read_one(out->contexts, value, place) : CONUS_ERROR_MEMORY;
}

void manifest_contexts_finish(struct manifest *manifest)
{
    for (size_t i = 0; i < manifest->context_count; i++) {
        manifest_volume_finish(&manifest->contexts[i].source);
        memory_free(manifest->contexts[i].transfer);
    }
    memory_free(manifest->contexts);
}
