/* SPDX-License-Identifier: BSD-3-Clause */
/* The direction of a transform, by its name. */
#include "loaders/transform/transform.h"

#include "base/files/file.h"

#include <string.h>

/* The value of the entity `key`, "from-"; false where the name has none. */
static bool take_entity(struct text *out, struct text name, const char *key)
{
    struct text part;
    for (bool more = true; text_field(&name, '_', &more, &part);) {
        size_t length = strlen(key);
        if (text_starts(part, key) && part.size > length) {
            *out = (struct text){part.data + length, part.size - length};
            return true;
        }
    }
    return false;
}

bool transform_name_points(struct text *from, struct text *to, const char *path)
{
    struct text name = text_from(path_base(path));
    struct text mode = {0};
    struct text first;
    struct text second;
    if (!take_entity(&first, name, "from-") || !take_entity(&second, name, "to-") || !text_mentions(name, "_xfm.")) {
        return false;
    }
    bool is_points = take_entity(&mode, name, "mode-") && text_equal(mode, "points");
    *from = is_points ? first : second;
    *to = is_points ? second : first;
    return true;
}

bool transform_name_is_mni(struct text space)
{
    return text_contains(space, text_from("MNI"));
}

enum ants_kind transform_name_ants(struct text *prefix, const char *path)
{
    static const struct {
        const char *ending;
        enum ants_kind kind;
    } endings[] = {
        {"InverseWarp.nii.gz", ANTS_INVERSE_WARP},
        {"InverseWarp.nii", ANTS_INVERSE_WARP},
        {"Warp.nii.gz", ANTS_WARP},
        {"Warp.nii", ANTS_WARP},
        {"GenericAffine.mat", ANTS_AFFINE},
        {"Affine.mat", ANTS_AFFINE},
        {"Affine.txt", ANTS_AFFINE},
        {"Rigid.mat", ANTS_AFFINE},
        {"InverseComposite.h5", ANTS_COMPOSITE},
        {"Composite.h5", ANTS_COMPOSITE},
    };
    size_t size = strlen(path);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        size_t length = strlen(endings[i].ending);
        if (size >= length && strcmp(path + size - length, endings[i].ending) == 0) {
            size -= length;
            while (size && path[size - 1] >= '0' && path[size - 1] <= '9') {
                size--;
            }
            *prefix = (struct text){path, size};
            return endings[i].kind;
        }
    }
    return ANTS_NONE;
}
