/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads which atlas a session belongs to, and finds that atlas again. */
#include "viewer/model/additions.h"

#include "base/path.h"
#include "base/system/system.h"
#include "options/output.h"
#include "options/provenance.h"
#include "sources/names.h"

#include <stdio.h>
#include <string.h>

enum { FILE_LIMIT = 64 << 20 /* bytes */ };

const char *json_text(const json_t *object, const char *key)
{
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

bool session_file_read(struct session_file *out, const char *path)
{
    struct system_stat info;
    bool may_be =
        path_ends_in(path, ".json") && system_stat(&info, path) && info.kind == SYSTEM_FILE && info.size <= FILE_LIMIT;
    json_t *root = may_be ? json_load_file(path, JSON_REJECT_DUPLICATES, NULL) : NULL;
    const json_t *opened = json_object_get(root, "opened");
    const json_t *options = json_object_get(opened, "options");
    const char *atlas = json_text(root, "atlas");
    const char *folder = json_string_value(json_object_get(opened, "folder"));
    if (!json_is_integer(json_object_get(root, "conus_session")) || !atlas[0] || !folder) {
        json_decref(root);
        return false;
    }
    bool of_texts = json_is_array(options);
    for (size_t i = 0; i < json_array_size(options); i++) {
        of_texts = of_texts && json_is_string(json_array_get(options, i));
    }
    *out = (struct session_file){.root = root,
                                 .atlas = atlas,
                                 .folder = folder,
                                 .sha256 = json_text(opened, "sha256"),
                                 .bytes = (uint64_t)json_integer_value(json_object_get(opened, "bytes")),
                                 .options = of_texts ? options : NULL};
    return true;
}

void session_file_finish(struct session_file *file)
{
    json_decref(file->root);
    *file = (struct session_file){0};
}

/* Also with ",volume=K" and the like behind it. */
static bool is_there(const char *path)
{
    char file[SYSTEM_PATH];
    snprintf(file, sizeof file, "%.*s", (int)keys_file_length(path, KEYS_ATLAS), path);
    return file[0] && system_allows(file, SYSTEM_READ);
}

static bool put_path(char out[SYSTEM_PATH], const char *folder, const char *name)
{
    bool joins = folder[0] && !path_is_whole(name);
    int size = snprintf(out, SYSTEM_PATH, "%s%s%s", joins ? folder : "", joins ? "/" : "", name);
    return size > 0 && size < SYSTEM_PATH;
}

/* Whether it is the file, by its checksum; others are not read. */
static bool is_same_file(const struct session_file *file, const char *path)
{
    char sum[SHA256_TEXT];
    struct system_stat info;
    return file->sha256[0] && system_allows(path, SYSTEM_READ) && system_stat(&info, path) &&
           info.kind == SYSTEM_FILE && info.size == file->bytes && !provenance_hash_file(sum, path) &&
           strcmp(sum, file->sha256) == 0;
}

/* A file that is looked for in a folder. */
struct search {
    char *out; /* [SYSTEM_PATH] */
    const struct session_file *file;
    const char *folder;
    bool found;
};

static bool try_entry(void *user, const char *name)
{
    struct search *search = user;
    search->found = put_path(search->out, search->folder, name) && is_same_file(search->file, search->out);
    return !search->found;
}

static bool find_in_folder(char out[SYSTEM_PATH], const struct session_file *file, const char *folder)
{
    struct search search = {out, file, folder, false};
    system_list(folder, try_entry, &search);
    return search.found;
}

/* The folder of a file, without a '/' at its end. */
static void put_folder(char out[SYSTEM_PATH], const char *path)
{
    size_t length = path_folder_length(path);
    snprintf(out, SYSTEM_PATH, "%.*s", length > 1 ? (int)length - 1 : 1, length ? path : ".");
}

/* A file beside the session, by the same name or relative path, or with the same bytes. */
static bool find_beside(char out[SYSTEM_PATH], const struct session_file *file, const char *session)
{
    char folder[SYSTEM_PATH];
    put_folder(folder, session);
    return (put_path(out, folder, file->atlas) && is_there(out)) ||
           (put_path(out, folder, path_base(file->atlas)) && is_there(out)) || find_in_folder(out, file, folder);
}

bool session_file_find(char out[SYSTEM_PATH], const struct session_file *file, const char *session,
                       const char *const *others, size_t count)
{
    bool found = (put_path(out, file->folder, file->atlas) && is_there(out)) || /* where it was, */
                 find_beside(out, file, session);
    for (size_t i = 0; i < count && !found; i++) {
        found = put_path(out, "", others[i]) && is_same_file(file, out);
    }
    return found;
}

bool session_file_find_near(char out[SYSTEM_PATH], const struct session_file *file, const char *atlas)
{
    char folder[SYSTEM_PATH];
    put_folder(folder, atlas);
    return file->sha256[0] ? find_in_folder(out, file, folder)
                           : put_path(out, folder, path_base(file->atlas)) && is_there(out);
}
