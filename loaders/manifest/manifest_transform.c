/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the transforms of a manifest. */
#include "loaders/manifest/manifest_transform.h"

#include "base/memory.h"

#define AT(member) offsetof(struct manifest_transform, member)

static conus_status read_vectors(void *field, const json_t *value, const struct schema_place *place)
{
    static const char *const words[] = {"as-stated", "relative", "absolute", NULL};
    unsigned word = 0;
    conus_status status = schema_word(&word, value, place, words);
    *(conus_vectors *)field = (conus_vectors)word;
    return status;
}

static conus_status read_one(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(file), true},  {"from", schema_path, AT(from), false},
        {"to", schema_path, AT(to), false},     {"inverse", schema_flag, AT(inverse), false},
        {"grid", schema_path, AT(grid), false}, {"vectors", read_vectors, AT(vectors), false},
        {"comment", schema_comment, 0, false},  {0},
    };
    struct manifest_transform *out = field;
    return schema_path_or_object(&out->file, out, value, keys, place);
}

conus_status manifest_transforms_read(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    if (json_is_array(value)) {
        return schema_list((void **)&out->transforms, &out->transform_count, sizeof *out->transforms, MANIFEST_FEW,
                           value, read_one, place);
    }
    if (!json_is_string(value) && !json_is_object(value)) {
        return schema_fail(place, value, "a path, an object or a list of these");
    }
    out->transforms = memory_zeroed(1, sizeof *out->transforms);
    out->transform_count = out->transforms ? 1 : 0;
    out->single_transform = true;
    return out->transforms ? read_one(out->transforms, value, place) : CONUS_ERROR_MEMORY;
}

void manifest_transforms_finish(struct manifest *manifest)
{
    for (size_t i = 0; i < manifest->transform_count; i++) {
        memory_free(manifest->transforms[i].file);
        memory_free(manifest->transforms[i].from);
        memory_free(manifest->transforms[i].to);
        memory_free(manifest->transforms[i].grid);
    }
    memory_free(manifest->transforms);
}
