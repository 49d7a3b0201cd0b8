/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether what a text may name lies in folders that may be read. */
#include "base/path.h"
#include "base/system/system.h"
#include "cli/mcp/mcp.h"
#include "conus/own.h"
#include "options/messages.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static bool add_folder(struct mcp_roots *roots, const char *folder)
{
    char **grown = realloc(roots->folders, (roots->count + 1) * sizeof *grown);
    char *copy = strdup(folder);
    roots->folders = grown ? grown : roots->folders;
    if (grown && copy) {
        roots->folders[roots->count++] = copy;
        return true;
    }
    free(copy);
    return false;
}

static int add_places(struct mcp_roots *roots)
{
    conus_catalogue *catalogue = NULL;
    int code = print_status(conus_catalogue_create(&catalogue, NULL));
    for (size_t i = 0; !code && i < conus_catalogue_place_count(catalogue); i++) {
        const conus_catalogue_place *place = conus_catalogue_place_at(catalogue, i);
        char real[SYSTEM_PATH];
        bool is_known = !place->there || !system_real_path(real, place->path) || add_folder(roots, real);
        code = is_known ? code : print_no_memory();
    }
    conus_catalogue_destroy(catalogue);
    return code;
}

int mcp_roots_begin(struct mcp_roots *out, const struct option_list *folders)
{
    const char *here[] = {"."};
    const struct option_list none = {here, 1};
    const struct option_list *list = folders->count ? folders : &none;
    *out = (struct mcp_roots){0};
    for (size_t i = 0; i < list->count; i++) {
        char real[SYSTEM_PATH];
        struct system_stat info;
        if (!system_real_path(real, list->items[i]) || !system_stat(&info, real)) {
            return print_system_error(list->items[i], "open");
        }
        if (info.kind != SYSTEM_FOLDER) {
            return print_data_error("%s: is no folder", list->items[i]);
        }
        if (!add_folder(out, real)) {
            return print_no_memory();
        }
    }
    return system_enter(out->folders[0]) ? add_places(out) : print_system_error(out->folders[0], "enter");
}

void mcp_roots_finish(struct mcp_roots *roots)
{
    for (size_t i = 0; i < roots->count; i++) {
        free(roots->folders[i]);
    }
    free(roots->folders);
    *roots = (struct mcp_roots){0};
}

static bool lies_within(const struct mcp_roots *roots, const char *real)
{
    bool lies = false;
    for (size_t i = 0; i < roots->count && !lies; i++) {
        const char *folder = roots->folders[i];
        size_t length = path_plain_length(folder, strlen(folder));
        lies = strncmp(real, folder, length) == 0 && (!real[length] || strchr(SYSTEM_SEPARATORS, real[length]) ||
                                                      strchr(SYSTEM_SEPARATORS, real[length - 1]));
    }
    return lies;
}

static bool has_way_up(const char *path)
{
    const char *part;
    bool is_up = false;
    for (size_t length; !is_up && path_part(&path, &part, &length);) {
        is_up = length == 2 && strncmp(part, "..", 2) == 0;
    }
    return is_up;
}

/* Of what is not there counts the lowest folder that is; a link to what is not there leads out. */
static bool leads_in(const struct mcp_roots *roots, char *path)
{
    char real[SYSTEM_PATH];
    struct system_stat info;
    if (system_real_path(real, path)) {
        return lies_within(roots, real);
    }
    bool is_there = !has_way_up(path);
    bool is_real = is_there && system_real_path(real, strchr(SYSTEM_SEPARATORS, *path) ? "/" : ".");
    for (size_t end = 1; is_there && is_real && path[end - 1]; end++) {
        const char after = path[end];
        if (!after || strchr(SYSTEM_SEPARATORS, after)) {
            path[end] = '\0';
            is_there = system_stat_link(&info, path);
            is_real = !is_there || system_real_path(real, path);
            path[end] = after;
        }
    }
    return is_real && lies_within(roots, real);
}

/* What may stand in a path without being the end of another word. */
static bool is_of_path(char c)
{
    return isalnum((unsigned char)c) || (unsigned char)c >= 0x80 || strchr("._-" SYSTEM_SEPARATORS, c);
}

/* Whether a word may begin at text[at], also by what stands in no path but this one. None does behind what ends a part
 * of a name, as in "study (1)/x" and "50%/x"; "a / b" is a quotient. */
static bool may_begin(const char *text, size_t at)
{
    return !at || (!is_of_path(text[at - 1]) && !strchr(")]}%!", text[at - 1]) && strncmp(text + at, "/ ", 2) != 0);
}

bool mcp_roots_have(const struct mcp_roots *roots, const char *text)
{
    char piece[SYSTEM_PATH];
    size_t pieces = 0;
    bool have = strlen(text) < sizeof piece;
    for (size_t i = 0; have && text[i]; i++) {
        pieces += !is_of_path(text[i]);
    }
    have = have && pieces < MCP_PIECES;
    for (size_t begin = 0; have && text[begin]; begin++) {
        for (size_t end = begin + 1; have && may_begin(text, begin) && end <= strlen(text); end++) {
            if (!text[end] || !is_of_path(text[end])) {
                snprintf(piece, sizeof piece, "%.*s", (int)(end - begin), text + begin);
                have = leads_in(roots, piece);
            }
        }
    }
    return have;
}
