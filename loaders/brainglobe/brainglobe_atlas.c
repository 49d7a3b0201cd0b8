/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads manifest.json, and keeps its places below the root. */
#include "loaders/brainglobe/brainglobe_atlas.h"

#include "base/buffer.h"
#include "base/formats/json_text.h"
#include "base/memory.h"
#include "base/order.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { MANIFEST_LIMIT = 1 << 20, LEVELS_TO_ROOT = 3 };

static char *join(const char *folder, const char *name, const char *file)
{
    struct buffer path = {0};
    buffer_format(&path, "%s%s%s", folder, name, file);
    return buffer_status(&path) ? (buffer_finish(&path), NULL) : path.data;
}

conus_status brainglobe_atlas_is(bool *out, const char *folder)
{
    struct bytes bytes = {0};
    char *path = join(folder, "manifest.json", "");
    conus_status status = path ? CONUS_OK : CONUS_ERROR_MEMORY;
    *out = false;
    if (!status && file_exists(path)) {
        status = file_read(&bytes, path, MANIFEST_LIMIT);
        *out = !status && text_mentions(text_from_bytes(bytes.data, bytes.size), "\"annotation_set\"");
    }
    bytes_finish(&bytes);
    memory_free(path);
    return status == CONUS_ERROR_MEMORY ? status : CONUS_OK; /* an unreadable one is passed over */
}

/* "/annotation-sets/NAME/1_2" without its slash, if every part of it goes down. */
static conus_status copy_place(char **out, const char *key, const char *place)
{
    const char *rest = place + (place[0] == '/');
    struct text part;
    char *copy = memory_text(rest, strlen(rest));
    bool goes_down = !path_is_whole(rest) && path_base(rest)[0];
    while (path_part(&rest, &part.data, &part.size)) {
        goes_down = goes_down && part.size && part.data[0] != '.';
    }
    if (copy && goes_down) {
        *out = copy;
        return CONUS_OK;
    }
    memory_free(copy);
    return copy ? fail(CONUS_ERROR_DATA, "%s.location: \"%.80s\" is no folder below the one that holds atlases/", key,
                       place)
                : CONUS_ERROR_MEMORY;
}

static conus_status read_part(char **out, const json_t *root, const char *key, bool is_needed)
{
    const json_t *part = json_object_get(root, key);
    const char *place = json_string_value(json_object_get(part, "location"));
    if (!place && (is_needed || part)) {
        return fail(CONUS_ERROR_DATA, "%s: an object with a location is needed", key);
    }
    return place ? copy_place(out, key, place) : CONUS_OK;
}

conus_status brainglobe_atlas_parse(struct brainglobe_atlas *out, struct text text)
{
    struct brainglobe_atlas atlas = {0};
    json_t *root = NULL;
    conus_status status = brainglobe_metadata_parse(&atlas.metadata, text);
    status = status ? status : json_text_load(&root, text);
    status = status ? status : read_part(&atlas.annotation, root, "annotation_set", true);
    status = status ? status : read_part(&atlas.terminology, root, "terminology", true);
    const json_t *set = json_object_get(root, "annotation_set"); /* whose template BrainGlobe's API takes */
    status =
        status ? status : read_part(&atlas.template, json_object_get(set, "template") ? set : root, "template", false);
    atlas.is_symmetric = !json_is_false(json_object_get(root, "symmetric"));
    if (!status && (!(atlas.metadata.resolution[0] > 0) || !atlas.metadata.shape[0])) {
        status = fail(CONUS_ERROR_DATA, "resolution and shape: three numbers each are needed");
    }
    json_decref(root);
    if (status) {
        brainglobe_atlas_finish(&atlas);
        return status;
    }
    *out = atlas;
    return CONUS_OK;
}

/* A place that is not there is whoever opens it to say. */
static conus_status check_link(const char *root, const char *place)
{
    char real[SYSTEM_PATH];
    char *path = place ? join(root, place, "") : NULL;
    bool leaves = path && system_real_path(real, path) && strncmp(real, root, strlen(root)) != 0;
    conus_status status = place && !path ? CONUS_ERROR_MEMORY : CONUS_OK;
    memory_free(path);
    return leaves ? fail(CONUS_ERROR_DATA, "%s%s: a link leads to %s, out of that folder", root, place, real) : status;
}

/* The real folder above atlases/NAME/1_2, and NAME. Near "/" both are short. */
static conus_status find_root(char **out, char **name, const char *folder)
{
    char real[SYSTEM_PATH];
    if (!system_real_path(real, folder)) {
        return fail(CONUS_ERROR_IO, "cannot open: %s", text_error(errno));
    }
    for (int i = 0; i < LEVELS_TO_ROOT; i++) {
        const char *cut = path_cut(real);
        if (cut && i == 1) {
            *name = memory_text(cut + 1, strlen(cut + 1));
        }
    }
    *out = join(real, "/", "");
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

conus_status brainglobe_atlas_read(struct brainglobe_atlas *out, char **root, const char *folder,
                                   struct file_sums *read)
{
    struct brainglobe_atlas atlas = {0};
    struct bytes bytes = {0};
    char *above = NULL;
    char *path = join(folder, "manifest.json", "");
    conus_status status = path ? file_read(&bytes, path, MANIFEST_LIMIT) : CONUS_ERROR_MEMORY;
    if (!status) {
        status = brainglobe_atlas_parse(&atlas, text_from_bytes(bytes.data, bytes.size));
        status = status ? status : find_root(&above, &atlas.name, folder);
        status = status ? status : check_link(above, atlas.annotation);
        status = status ? status : check_link(above, atlas.terminology);
        status = status ? status : check_link(above, atlas.template);
        status = status ? fail_in(status, path) : file_sums_add(read, path, &bytes);
    }
    bytes_finish(&bytes);
    memory_free(path);
    if (status) {
        memory_free(above);
        brainglobe_atlas_finish(&atlas);
        return status;
    }
    *root = above;
    *out = atlas;
    return CONUS_OK;
}

void brainglobe_atlas_finish(struct brainglobe_atlas *atlas)
{
    memory_free(atlas->name);
    memory_free(atlas->annotation);
    memory_free(atlas->terminology);
    memory_free(atlas->template);
    *atlas = (struct brainglobe_atlas){0};
}

static bool is_version(const char *name)
{
    return name[0] >= '0' && name[0] <= '9' && !name[strspn(name, "0123456789_")];
}

/* By the numbers between '_', one after the other. */
static int compare_versions(const void *a, const void *b)
{
    const char *one = *(char *const *)a;
    const char *other = *(char *const *)b;
    while (*one && *other) {
        char *one_end;
        char *other_end;
        unsigned long long left = strtoull(one, &one_end, 10);
        unsigned long long right = strtoull(other, &other_end, 10);
        if (left != right) {
            return left < right ? -1 : 1;
        }
        one = one_end + (*one_end == '_');
        other = other_end + (*other_end == '_');
    }
    return (*one != '\0') - (*other != '\0');
}

conus_status brainglobe_versions(struct names *out, const char *folder)
{
    struct names all = {0};
    conus_status status = names_list(&all, folder, "");
    for (size_t i = 0; !status && i < all.count; i++) {
        bool is = false;
        struct buffer path = {0};
        if (!is_version(all.names[i])) {
            continue;
        }
        buffer_format(&path, "%s/%s/", folder, all.names[i]);
        status = buffer_status(&path);
        status = status ? status : brainglobe_atlas_is(&is, path.data);
        status = status || !is ? status : names_add(out, all.names[i]);
        buffer_finish(&path);
    }
    order_sort(out->names, out->count, sizeof *out->names, compare_versions);
    names_finish(&all);
    return status;
}
