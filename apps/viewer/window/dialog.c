/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads folders; what the dialog lists and answers, without how it looks. */
#include "viewer/window/start.h"

#include "base/order.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "sources/names.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

bool folder_can_open(const char *name)
{
    return ending_length(name, strlen(name), ROLES_ATLAS | ROLE_TRACTS | ROLE_POSES);
}

bool folder_fits(const char *name, const char *text)
{
    return !*text || text_contains(text_from(name), text_from(text));
}

static bool is_folder(const char *path)
{
    struct system_stat info;
    return system_stat(&info, path) && info.kind == SYSTEM_FOLDER;
}

/* Adds an entry; false without memory. */
static bool add_entry(struct folder *folder, const char *name, bool is_folder)
{
    bool is_full = !(folder->count & (folder->count - 1)); /* at 0, 1, 2, 4 ... it doubles */
    size_t room = folder->count ? 2 * folder->count : 1;
    struct folder_entry *entries = is_full ? realloc(folder->entries, room * sizeof *entries) : folder->entries;
    folder->entries = entries ? entries : folder->entries;
    char *copy = entries ? strdup(name) : NULL;
    if (copy) {
        folder->entries[folder->count++] = (struct folder_entry){copy, is_folder};
    }
    return copy;
}

static int compare(const void *a, const void *b)
{
    const struct folder_entry *one = a;
    const struct folder_entry *other = b;
    int order = one->is_folder == other->is_folder ? strcasecmp(one->name, other->name) : 0;
    return one->is_folder != other->is_folder ? other->is_folder - one->is_folder
           : order                            ? order
                                              : strcmp(one->name, other->name);
}

static bool take_entry(void *user, const char *name)
{
    struct folder *folder = user;
    char whole[SYSTEM_PATH];
    int size = snprintf(whole, sizeof whole, "%s/%s", folder->path, name);
    bool goes_in = name[0] != '.' && size < SYSTEM_PATH && is_folder(whole);
    bool fits = goes_in || folder->filter == FOLDER_ALL ||
                (folder->filter == FOLDER_SESSIONS ? path_ends_in(name, ".json") : folder_can_open(name));
    folder->failed = name[0] != '.' && fits && !add_entry(folder, name, goes_in);
    return !folder->failed && folder->count < FOLDER_LIMIT;
}

void folder_read(struct folder *folder, const char *path, enum folder_filter filter)
{
    folder_finish(folder);
    snprintf(folder->path, sizeof folder->path, "%s", path);
    folder->filter = filter;
    folder->failed = !system_list(path, take_entry, folder) || folder->failed;
    folder->missing = folder->failed && !is_folder(path);
    order_sort(folder->entries, folder->count, sizeof *folder->entries, compare);
}

void folder_finish(struct folder *folder)
{
    for (size_t i = 0; i < folder->count; i++) {
        free(folder->entries[i].name);
    }
    free(folder->entries);
    *folder = (struct folder){.path = ""};
}

void dialog_here(char path[SYSTEM_PATH], const struct dialog *dialog)
{
    char whole[SYSTEM_PATH];
    if (!typed_path(whole, dialog->text)) {
        whole[0] = '\0';
    }
    size_t length = path_plain_length(whole, path_folder_length(whole));
    snprintf(path, SYSTEM_PATH, "%.*s", length ? (int)length : 1, length ? whole : ".");
}

void dialog_set(struct dialog *dialog, const char *text)
{
    snprintf(dialog->text, sizeof dialog->text, "%s", text);
    dialog->is_set = dialog->takes_keys = true;
    dialog->selected = SIZE_MAX;
    dialog->prefilled[0] = '\0';
    dialog_look(dialog);
}

/* Goes to a folder, so that its entries follow. */
static void go_to(struct dialog *dialog, const char *folder)
{
    char text[SYSTEM_PATH];
    size_t length = strlen(folder);
    if (snprintf(text, sizeof text, "%s%s", folder, length ? path_joint(folder, length) : "/") < SYSTEM_PATH) {
        dialog_set(dialog, text);
        memcpy(dialog->prefilled, text, strlen(text) + 1);
    }
}

void dialog_look(struct dialog *dialog)
{
    char path[SYSTEM_PATH];
    enum folder_filter filter = dialog->all                      ? FOLDER_ALL
                                : dialog->purpose == DIALOG_SAVE ? (dialog->ending ? FOLDER_ALL : FOLDER_SESSIONS)
                                                                 : FOLDER_OPENABLE;
    dialog_here(path, dialog);
    if (strcmp(path, dialog->folder.path) != 0 || filter != dialog->folder.filter) {
        folder_read(&dialog->folder, path, filter);
        dialog->marked = SIZE_MAX;
    }
    if (strcmp(dialog->text, dialog->text_before) != 0) {
        memcpy(dialog->text_before, dialog->text, sizeof dialog->text);
        dialog->marked = SIZE_MAX;
        dialog->sure = false;
        dialog->why[0] = '\0';
    }
}

bool dialog_fits(const struct dialog *dialog, size_t index)
{
    const struct folder *folder = &dialog->folder;
    const char *part = path_base(dialog->text);
    bool is_taken = dialog->marked < folder->count && strcmp(folder->entries[dialog->marked].name, part) == 0;
    return dialog->purpose == DIALOG_SAVE || is_taken || folder_fits(folder->entries[index].name, part);
}

void dialog_move(struct dialog *dialog, int by)
{
    dialog_look(dialog);
    size_t count = dialog->folder.count;
    size_t step = by > 0 ? 1 : SIZE_MAX; /* adding SIZE_MAX goes one back */
    size_t from = dialog->marked < count ? dialog->marked : by > 0 ? SIZE_MAX : count;
    for (size_t i = from + step; i < count; i += step) {
        if (dialog_fits(dialog, i)) {
            dialog->marked = i;
            dialog->scrolls = true;
            return;
        }
    }
}

void dialog_leave(struct dialog *dialog)
{
    char here[SYSTEM_PATH];
    char resolved[SYSTEM_PATH];
    dialog_here(here, dialog);
    if (system_real_path(resolved, here)) {
        resolved[path_plain_length(resolved, path_folder_length(resolved))] = '\0';
        go_to(dialog, resolved);
    }
}

void dialog_take(struct dialog *dialog, size_t index)
{
    char path[SYSTEM_PATH];
    char here[SYSTEM_PATH];
    const struct folder_entry *entry = &dialog->folder.entries[index];
    dialog_here(here, dialog);
    if (snprintf(path, sizeof path, "%s%s%s", here, path_joint(here, strlen(here)), entry->name) >= SYSTEM_PATH) {
        return;
    }
    if (entry->is_folder) {
        go_to(dialog, path);
    } else {
        dialog_set(dialog, path);
        dialog->marked = index;
    }
}

void dialog_complain(struct dialog *dialog, const char *why)
{
    snprintf(dialog->why, sizeof dialog->why, "%s", why);
    make_plain_line(dialog->why);
    dialog->on = dialog->takes_keys = dialog->is_set = true;
    dialog->selected = 0;
}

static void complain(struct dialog *dialog, const char *text, const char *path)
{
    char why[DIALOG_WHY];
    snprintf(why, sizeof why, "%.300s: %s", path, text);
    dialog_complain(dialog, why);
}

/* Checks the path to save to: it has its ending, and an existing file is replaced only after a question. */
static bool answer_save(char path[SYSTEM_PATH], struct dialog *dialog)
{
    const char *ending = dialog->ending ? dialog->ending : ".json";
    if (!path_ends_in(path, ending)) {
        size_t length = strlen(path);
        if (length + strlen(ending) >= SYSTEM_PATH) {
            complain(dialog, "too long", path);
            return false;
        }
        memcpy(path + length, ending, strlen(ending) + 1);
    }
    if (!dialog->sure && system_allows(path, 0)) {
        complain(dialog, "is there already; Enter again writes over it", path);
        dialog->sure = true;
        return false;
    }
    return true;
}

/* Whether it is a file, also with ",volume=K" and the like behind it, or may be the name of an installed atlas. */
static bool may_be_opened(const char *path)
{
    char file[SYSTEM_PATH];
    snprintf(file, sizeof file, "%.*s", (int)keys_file_length(path, KEYS_ATLAS), path);
    return path_is_name(path) || system_allows(file, 0);
}

bool dialog_enter(char path[SYSTEM_PATH], struct dialog *dialog)
{
    dialog_look(dialog);
    if (dialog->purpose == DIALOG_OPEN && typed_path(path, dialog->text) && !may_be_opened(path)) {
        size_t fitting = 0;
        for (size_t i = 0; i < dialog->folder.count; i++) { /* a part of a name means the one entry that has it */
            if (dialog_fits(dialog, i)) {
                dialog->marked = fitting++ ? SIZE_MAX : i;
            }
        }
    }
    if (dialog->marked < dialog->folder.count) {
        dialog_take(dialog, dialog->marked);
        if (!path_base(dialog->text)[0]) { /* a folder */
            return false;
        }
    }
    if (!typed_path(path, dialog->text) || !path_base(path)[0]) {
        dialog->takes_keys = dialog->is_set = true;
        return false;
    }
    if (is_folder(path)) {
        go_to(dialog, path);
        return false;
    }
    if (dialog->purpose == DIALOG_OPEN && !may_be_opened(path)) {
        complain(dialog, "there is no such file", path);
        return false;
    }
    return dialog->purpose == DIALOG_OPEN || answer_save(path, dialog);
}

static void add_place(struct dialog *dialog, const char *path)
{
    bool is_new = dialog->place_count < DIALOG_PLACES && strlen(path) < SYSTEM_PATH && is_folder(path);
    for (size_t i = 0; i < dialog->place_count; i++) {
        is_new = is_new && strcmp(dialog->places[i], path) != 0;
    }
    if (is_new) {
        memcpy(dialog->places[dialog->place_count++], path, strlen(path) + 1);
    }
}

static void find_places(struct dialog *dialog, const struct start *start)
{
    char here[SYSTEM_PATH];
    dialog->place_count = 0;
    for (size_t i = 0; i < start->recent.count && i + 4 < DIALOG_PLACES; i++) {
        char folder[SYSTEM_PATH];
        snprintf(folder, sizeof folder, "%s", start->recent.paths[i]);
        size_t length = path_plain_length(folder, path_folder_length(folder));
        folder[length] = '\0';
        if (length) {
            add_place(dialog, folder);
        }
    }
    if (system_here(here)) {
        add_place(dialog, here);
    }
    const char *home = getenv("HOME");
    add_place(dialog, home ? home : "/");
    for (size_t i = 0; i < conus_catalogue_place_count(start->catalogue); i++) {
        const conus_catalogue_place *place = conus_catalogue_place_at(start->catalogue, i);
        if (place->there) {
            add_place(dialog, place->path);
        }
    }
}

void dialog_show(struct dialog *dialog, enum dialog_purpose purpose, const char *path, const struct start *start)
{
    find_places(dialog, start);
    dialog->on = true;
    dialog->purpose = purpose;
    dialog->why[0] = '\0';
    dialog->sure = false;
    folder_finish(&dialog->folder); /* to be read anew */
    if (path) {                     /* a name is proposed: what is typed takes its place */
        dialog_set(dialog, path);
        dialog->selected = (size_t)(path_base(path) - path);
        memcpy(dialog->prefilled, path, dialog->selected);
        dialog->prefilled[dialog->selected] = '\0';
    } else {
        go_to(dialog, dialog->place_count ? dialog->places[0] : "/");
    }
}

void dialog_finish(struct dialog *dialog)
{
    folder_finish(&dialog->folder);
}
