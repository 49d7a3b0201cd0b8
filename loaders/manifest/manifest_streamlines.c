/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the tractograms of a manifest. */
#include "loaders/manifest/manifest_streamlines.h"

#include "base/memory.h"

#define AT(member) offsetof(struct manifest_streamlines, member)

static conus_status read_one(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(file), true},          {"name", schema_text, AT(name), false},
        {"radius", schema_positive, AT(radius), false}, {"moves", schema_flag, AT(moves), false},
        {"comment", schema_comment, 0, false},          {0},
    };
    struct manifest_streamlines *out = field;
    return json_is_string(value) ? schema_path(&out->file, value, place) : schema_object(out, value, keys, place);
}

conus_status manifest_streamlines_read(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    return schema_list((void **)&out->streamlines, &out->streamlines_count, sizeof *out->streamlines, MANIFEST_MANY,
                       value, read_one, place);
}

void manifest_streamlines_finish(struct manifest *manifest)
{
    for (size_t i = 0; i < manifest->streamlines_count; i++) {
        memory_free(manifest->streamlines[i].file);
        memory_free(manifest->streamlines[i].name);
    }
    memory_free(manifest->streamlines);
}
