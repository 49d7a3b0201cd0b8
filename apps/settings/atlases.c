/* SPDX-License-Identifier: BSD-3-Clause */
/* Names and loads several atlases, and compares their spaces. */
#include "settings/settings.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"
#include "sources/names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The name of the file or folder at `path`; NULL without memory. */
static char *name_of_path(const char *path)
{
    struct system_stat info;
    bool is_folder = system_stat(&info, path) && info.kind == SYSTEM_FOLDER;
    size_t end = is_folder ? strlen(path) : keys_file_length(path, KEYS_ATLAS);
    end = path_plain_length(path, end);
    size_t start = path_length_above(path, end);
    char *name = text_copy(path + start, end - start);
    if (name && !is_folder) {
        name[stem_length(name, strlen(name), ROLES_ATLAS)] = '\0'; /* "lh.pial" has no ending */
    }
    return name;
}

static bool is_taken(const struct atlases *atlases, size_t end, const char *name)
{
    bool taken = false;
    for (size_t i = 0; i < end && !taken; i++) {
        taken = strcmp(atlases->items[i].name, name) == 0;
    }
    return taken;
}

/* Gives atlas `index` the name, or, where another one has it, the name with "-2" behind it, and so on. Takes `name`
 * over, which is NULL without memory. */
static bool set_name(struct atlases *atlases, size_t index, char *name)
{
    char *distinct = name;
    if (name) {
        make_plain_line(name);
    }
    for (size_t n = 2; distinct && is_taken(atlases, index, distinct); n++) {
        if (distinct != name) {
            free(distinct);
        }
        distinct = asprintf(&distinct, "%s-%zu", name, n) < 0 ? NULL : distinct;
    }
    if (distinct != name) {
        free(name);
    }
    atlases->items[index].name = distinct;
    return distinct;
}

static int name_atlas(struct atlases *atlases, size_t index)
{
    struct atlas_name found;
    int code = atlas_name_find(&found, atlases->items[index].given);
    if (!code && !set_name(atlases, index, found.atlas ? strdup(found.atlas->name) : name_of_path(found.path))) {
        code = print_no_memory();
    }
    atlas_name_finish(&found);
    return code;
}

int atlases_name(struct atlases *out, const char *path, const struct atlas_settings *settings)
{
    size_t count = 1 + settings->more.count;
    int code = EXIT_DONE;
    out->items = calloc(count, sizeof *out->items);
    if (!out->items) {
        return print_no_memory();
    }
    out->count = count;
    for (size_t i = 0; i < count && !code; i++) {
        out->items[i].given = i ? settings->more.items[i - 1] : path;
        code = count > 1 ? name_atlas(out, i) : EXIT_DONE;
    }
    return code;
}

const char *atlases_prefix(char out[ATLAS_PREFIX_SIZE], const struct named_atlas *atlas)
{
    out[0] = '\0';
    if (atlas->name) {
        snprintf(out, ATLAS_PREFIX_SIZE, "%s: ", atlas->name);
    }
    return out;
}

static int load_at(struct atlases *atlases, size_t index, const struct atlas_settings *settings)
{
    struct named_atlas *item = &atlases->items[index];
    struct atlas_settings own = *settings;
    if (index && settings->sides && !settings->transforms.count) {
        return print_usage_error("--sides exchanged mirrors ATLAS alone, and not %s: ask the two one after the other",
                                 item->given);
    }
    own.shelf = atlases->shares_streamlines ? &atlases->shelf : own.shelf;
    own.asks_bundles = atlases->shares_streamlines;
    if (index) {
        own.labels = NULL;
        own.probability = 0;
        own.sides = 0;
        own.pathways = own.only = own.hide = (struct option_list){0};
        own.streamlines = atlases->shares_streamlines ? own.streamlines : (struct option_list){0};
    }
    return atlas_input_load(&item->atlas, item->given, &own);
}

int atlases_load_all(struct atlases *atlases, const struct atlas_settings *settings,
                     const struct context_settings *context)
{
    int code = EXIT_DONE;
    double began = clock_ms();
    for (size_t i = 0; i < atlases->count && !code; i++) {
        if (!atlases->items[i].atlas) {
            code = load_at(atlases, i, settings);
            code = code || !context
                       ? code
                       : atlas_input_load_context(atlases->items[i].atlas, context->path, context->blocks, settings);
        }
    }
    atlases->opening_ms = clock_ms() - began;
    return code;
}

int atlases_load(struct atlases *out, const char *path, const struct atlas_settings *settings,
                 const struct context_settings *context)
{
    int code = atlases_name(out, path, settings);
    return code ? code : atlases_load_all(out, settings, context);
}

void atlases_finish(struct atlases *atlases)
{
    for (size_t i = 0; i < atlases->count; i++) {
        conus_atlas_destroy(atlases->items[i].atlas);
        free(atlases->items[i].name);
    }
    tract_shelf_finish(&atlases->shelf);
    free(atlases->items);
    *atlases = (struct atlases){0};
}

int atlases_check_names(const struct atlases *atlases)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < atlases->count; i++) {
        const conus_atlas *atlas = atlases->items[i].atlas;
        for (size_t k = 0; k < conus_atlas_file_count(atlas) && !code; k++) {
            code = outputs_check_name(conus_atlas_file(atlas, k));
        }
    }
    return code;
}

/* Whether a header names its space. Code 0 is unknown, and code 2, "aligned to another", does not say to which. */
static bool is_named(const conus_volume_info *info)
{
    return info && info->space_code != 0 && info->space_code != 2;
}

bool spaces_differ(const conus_volume_info *a, const conus_volume_info *b)
{
    return is_named(a) && is_named(b) && a->space_code != b->space_code;
}

static bool overlap(const conus_atlas *a, const conus_atlas *b)
{
    double low[2][3];
    double high[2][3];
    bool is = true;
    if (conus_atlas_bounds(low[0], high[0], a) || conus_atlas_bounds(low[1], high[1], b)) {
        return true; /* there is nothing to compare */
    }
    for (int i = 0; i < 3; i++) {
        is = is && low[0][i] < high[1][i] && low[1][i] < high[0][i];
    }
    return is;
}

void atlases_say_spaces(const struct atlases *atlases, const struct common_settings *settings)
{
    const struct named_atlas *first = &atlases->items[0];
    const conus_brain_view own = conus_atlas_brain(first->atlas);
    const conus_volume_info *a = conus_atlas_volume(first->atlas, 0);
    for (size_t i = 1; i < atlases->count; i++) {
        const struct named_atlas *other = &atlases->items[i];
        const conus_brain_view brain = conus_atlas_brain(other->atlas);
        const conus_volume_info *b = conus_atlas_volume(other->atlas, 0);
        conus_brain_gap gap = conus_brain_compare(own, brain);
        if (gap) {
            say_note(gap == CONUS_BRAIN_GAP_SMALL ? CONUS_SEVERITY_NOTE : CONUS_SEVERITY_WARNING, settings->quiet,
                     "%s (%s) and %s (%s) are different brains: %s", first->name, own.words, other->name, brain.words,
                     gap == CONUS_BRAIN_GAP_OTHER ? "one pose fits one of them only"
                                                  : "a pose may be some mm off in one");
        } else if ((!own.brain || !brain.brain) && spaces_differ(a, b)) {
            say_note(CONUS_SEVERITY_NOTE, settings->quiet,
                     "%s (%s) and %s (%s) name different spaces: one pose may not fit both", first->name, a->transform,
                     other->name, b->transform);
        }
        if (!gap && !overlap(first->atlas, other->atlas)) {
            say_warning("%s and %s do not overlap: are they in one space?", first->name, other->name);
        }
    }
}
