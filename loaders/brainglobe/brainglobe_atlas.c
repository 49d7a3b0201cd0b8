/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads manifest.json, and keeps its places below the root. */
#include "loaders/brainglobe/brainglobe.h"

#include "base/formats/json_text.h"
#include "base/order.h"
#include "base/path.h"
#include "base/system/system.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { MANIFEST_LIMIT = 1 << 20, LEVELS_TO_ROOT = 3 };

bool brainglobe_atlas_is(struct job *job, const char *folder)
{
    const struct job_mark mark = job_mark(job);
    const char *path = job_format(job, "%smanifest.json", folder);
    const struct attempt attempt = job_try(job); /* an unreadable one is passed over */
    bool is = false;
    if (job_has_file(job, path)) {
        const struct bytes bytes = job_read(job, path, MANIFEST_LIMIT, "");
        is = text_mentions(text_from_bytes(bytes.data, bytes.size), "\"annotation_set\"");
    }
    (void)attempt_end(job, &attempt, ATTEMPT_DROP);
    job_release(job, mark);
    return is;
}

/* "annotation-sets/NAME/1_2", if every part of it goes down; NULL where there is none. */
static const char *read_place(struct job *job, const json_t *root, const char *key, bool is_needed)
{
    const json_t *part = json_object_get(root, key);
    const char *place = json_string_value(json_object_get(part, "location"));
    if (!place) {
        if (is_needed || part) {
            job_bad(job, "%s: an object with a location is needed", key);
        }
        return NULL;
    }
    const char *copy = job_copy(job, text_from(place + (place[0] == '/')));
    const char *rest = copy;
    struct text name;
    bool goes_down = !path_is_whole(rest) && path_base(rest)[0];
    while (path_part(&rest, &name.data, &name.size)) {
        goes_down = goes_down && name.size && name.data[0] != '.';
    }
    if (!goes_down) {
        job_bad(job, "%s.location: \"%.80s\" is no folder below the one that holds atlases/", key, place);
    }
    return copy;
}

struct brainglobe_atlas brainglobe_atlas_parse(struct job *job, struct text text)
{
    struct brainglobe_atlas atlas = {0};
    brainglobe_metadata_parse(job, &atlas.metadata, text);
    const json_t *root = json_text_read(job, text);
    atlas.annotation = read_place(job, root, "annotation_set", true);
    atlas.terminology = read_place(job, root, "terminology", true);
    const json_t *set = json_object_get(root, "annotation_set"); /* whose template BrainGlobe's API takes */
    atlas.template = read_place(job, json_object_get(set, "template") ? set : root, "template", false);
    atlas.is_symmetric = !json_is_false(json_object_get(root, "symmetric"));
    if (!(atlas.metadata.resolution[0] > 0) || !atlas.metadata.shape[0]) {
        job_bad(job, "resolution and shape: three numbers each are needed");
    }
    return atlas;
}

/* Opening it says that a place is not there. */
static void check_link(struct job *job, const char *root, const char *place)
{
    char real[SYSTEM_PATH];
    const char *path = job_format(job, "%s%s", root, place ? place : "");
    if (place && job_ok(job) && system_real_path(real, path) && strncmp(real, root, strlen(root)) != 0) {
        job_bad(job, "%s: a link leads to %s, out of that folder", path, real);
    }
}

/* The real folder above atlases/NAME/1_2, and NAME. Near "/" both are short. */
static void find_root(struct job *job, struct brainglobe_atlas *atlas, const char *folder)
{
    char real[SYSTEM_PATH] = "";
    if (job_ok(job) && !system_real_path(real, folder)) {
        job_fail(job, CONUS_ERROR_IO, "cannot open: %s", text_error(errno));
    }
    for (int i = 0; i < LEVELS_TO_ROOT; i++) {
        const char *cut = path_cut(real);
        if (cut && i == 1) {
            atlas->name = job_copy(job, text_from(cut + 1));
        }
    }
    atlas->root = job_format(job, "%s/", real);
}

struct brainglobe_atlas brainglobe_atlas_read(struct job *job, const char *folder)
{
    const char *path = job_format(job, "%smanifest.json", folder);
    const size_t place = job_in(job, path, JOB_ALONE);
    const struct bytes bytes = job_read(job, path, MANIFEST_LIMIT, "");
    struct brainglobe_atlas atlas = brainglobe_atlas_parse(job, text_from_bytes(bytes.data, bytes.size));
    find_root(job, &atlas, folder);
    check_link(job, atlas.root, atlas.annotation);
    check_link(job, atlas.root, atlas.terminology);
    check_link(job, atlas.root, atlas.template);
    job_made_of(job, path, &bytes);
    job_out(job, place);
    return atlas;
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

struct names brainglobe_versions(struct job *job, const char *folder)
{
    struct names all = job_names(job, folder, "");
    size_t count = 0;
    for (size_t i = 0; i < all.count; i++) {
        if (is_version(all.names[i]) && brainglobe_atlas_is(job, job_format(job, "%s/%s/", folder, all.names[i]))) {
            all.names[count++] = all.names[i];
        }
    }
    all.count = job_ok(job) ? count : 0;
    order_sort(all.names, all.count, sizeof *all.names, compare_versions);
    return all;
}
