/* SPDX-License-Identifier: BSD-3-Clause */
/* Options become words with absolute paths, and words options again. */
#include "viewer/opening/opening.h"

#include "base/path.h"
#include "base/system/system.h"
#include "options/messages.h"
#include "viewer/model/additions.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct option scene_options[] = {
    {OPTION_VALUED("transfer", struct view_settings, transfer, "NAME|FILE"),
     .help = "transfer function of the context in 3-D, as for conus render", .holds = HOLDS_COLOURS},
    {0},
};

const struct option needle_options[] = {
    {OPTION_VALUED("pose", struct view_settings, pose, "FILE"),
     .help =
         "points and poses, such as contacts, optodes or coils: all are drawn as balls with their names, and one is "
         "chosen to be asked about",
     .role = OPTION_READS_POSES, .holds = HOLDS_POSES},
    {OPTION_VALUED("poses", struct view_settings, poses, "FILE"),
     .help = "poses to replay, on a time line; with constraints, the candidates of a plan, as for conus plan: the best "
             "are listed",
     .role = OPTION_READS_POSES, .holds = HOLDS_POSES},
    {OPTION_MM("depth", struct view_settings, depth),
     .help = "far end of the first tool, its tip, mm from the device's position (F4, F5), and that of candidates that "
             "have none in a column far",
     .low = 0, .high = 1e6, .open = true},
    {OPTION_MM("radius", struct view_settings, radius),
     .help = "the first tool is a needle of this radius, mm, in place of a cone", .low = 0, .high = 1e6, .open = true},
    {0},
};

static const struct option_group groups[] = {
    {"What is opened", context_choice_options, offsetof(struct view_settings, context)},
    {"", map_options, offsetof(struct view_settings, context)},
    {"", scene_options, 0},
    {"", atlas_options, offsetof(struct view_settings, atlas)},
    {"", side_options, offsetof(struct view_settings, atlas)},
    {"", more_atlas_options, offsetof(struct view_settings, atlas)},
    {"", space_options, offsetof(struct view_settings, space)},
    {"", constraint_options, offsetof(struct view_settings, constraints)},
    {"", shank_options, offsetof(struct view_settings, constraints)},
    {"", needle_options, 0},
    {"", plain_options, offsetof(struct view_settings, common)}, /* which options_parse() asks for */
    {0},
};

static const struct command cmd_words = {.program = "conus-view",
                                         .name = "session",
                                         .resumes = true,
                                         .groups = groups,
                                         .settings_size = sizeof(struct view_settings)};

/* Whether a session keeps the option; poses to replay are no part of it. */
static bool is_kept(const struct option *option, bool has_plan)
{
    if (strcmp(option->name, "poses") == 0) {
        return has_plan;
    }
    for (const struct option_group *group = groups; group->title; group++) {
        for (const struct option *one = group->options; one->name; one++) {
            if (one == option) {
                return group->options != plain_options && strcmp(one->name, "max-memory") != 0;
            }
        }
    }
    return false;
}

/* What may stand behind a file that holds this. */
static const enum key_kind kinds[HOLDS_TEXT + 1] = {
    [HOLDS_ATLAS] = KEYS_ATLAS,         [HOLDS_VOLUME] = KEYS_PATHWAY, [HOLDS_LABELS] = KEYS_LABELS,
    [HOLDS_POSES] = KEYS_POSES,         [HOLDS_SURFACE] = KEYS_MAP,    [HOLDS_TRACTS] = KEYS_STREAMLINES,
    [HOLDS_TRANSFORM] = KEYS_TRANSFORM,
};

/* Writes `size` bytes of `text`, a file with its keys, behind the folder where it is, if it is in this one. */
static void put_file(FILE *out, const char *text, size_t size, enum key_kind kind)
{
    char folder[SYSTEM_PATH];
    char path[SYSTEM_PATH];
    const bool fits = snprintf(path, sizeof path, "%.*s", (int)size, text) < SYSTEM_PATH;
    path[fits ? keys_file_length(path, kind) : 0] = '\0';
    const bool is_here = path[0] && !path_is_whole(path) && system_allows(path, 0) && system_here(folder);
    fprintf(out, "%s%s%.*s", is_here ? folder : "", is_here ? "/" : "", (int)size, text);
}

/* Writes "FILE,from=FILE" with absolute paths. */
static void put_absolute(FILE *out, const char *text, enum key_kind kind)
{
    struct source_keys keys;
    const bool has_keys = keys_read(&keys, text, kind);
    const char *at = text + keys_file_length(text, kind);
    put_file(out, text, (size_t)(at - text), kind);
    for (size_t i = 0; has_keys && i < keys.count; i++) {
        const struct text value = keys.values[i].text;
        if (keys_is_image(&keys.values[i])) {
            fprintf(out, "%.*s", (int)(value.data - at), at);
            put_file(out, value.data, value.size, KEYS_VOLUME);
            at = value.data + value.size;
        }
    }
    fputs(at, out);
}

/* Appends "--name=value"; false without memory, or where it is not UTF-8. */
static bool add_word(json_t *words, const struct option *option, const char *value)
{
    struct system_text word;
    FILE *out = system_text_open(&word);
    if (!out) {
        return false;
    }
    /* A colour table's name is never a file, even if one is called so. */
    const bool is_colours =
        value && strcmp(option->name, "transfer") == 0 && (strchr(value, '.') || !path_is_name(value));
    const bool is_file = option->role >= OPTION_READS && option->role <= OPTION_READS_POSES;
    fprintf(out, "--%s%s", option->name, value ? "=" : "");
    if (value && (is_file || is_colours)) {
        put_absolute(out, value, kinds[option->holds]);
    } else if (value) {
        fputs(value, out);
    }
    bool fine = system_text_close(&word) && !json_array_append_new(words, json_string(word.data));
    free(word.data);
    return fine;
}

json_t *view_words(const struct arguments *arguments, const char *labels)
{
    json_t *words = json_array();
    bool has_plan = constraints_are_given(arguments);
    bool fine = words;
    for (size_t i = 0; arguments && i < arguments->use_count && fine; i++) {
        const struct option_use *use = &arguments->uses[i];
        fine = !is_kept(use->option, has_plan) || add_word(words, use->option, use->value);
    }
    assert(strcmp(atlas_options[0].name, "labels") == 0);
    if (!fine || (labels && !add_word(words, &atlas_options[0], labels))) {
        json_decref(words);
        return NULL;
    }
    return words;
}

/* Whether the word is of an option that the command line had. */
static bool is_given(const struct arguments *arguments, const char *word)
{
    for (size_t i = 0; arguments && i < arguments->use_count; i++) {
        const char *name = arguments->uses[i].option->name;
        if (word_value(word, name) || (strncmp(word, "--", 2) == 0 && strcmp(word + 2, name) == 0)) {
            return true;
        }
    }
    return false;
}

/* Joins the words of the session and of the command line, to be freed; false without memory. */
static bool join(struct worded *out, const json_t *words, const json_t *own, const struct arguments *given)
{
    size_t limit = json_array_size(words) + json_array_size(own);
    bool fine = (out->words = calloc(limit + 1, sizeof *out->words));
    for (size_t i = 0; i < limit && fine; i++) {
        bool is_own = i >= json_array_size(words);
        const char *word =
            json_string_value(is_own ? json_array_get(own, i - json_array_size(words)) : json_array_get(words, i));
        if (is_own || !is_given(given, word)) {
            char *copy = strdup(word);
            out->words[out->arguments.count] = copy;
            out->arguments.count += copy != NULL;
            fine = copy;
        }
    }
    return fine;
}

int worded_parse(struct worded *out, const json_t *words, const struct view_settings *given, bool counts)
{
    const struct arguments *arguments = counts ? given->arguments : NULL;
    json_t *own = view_words(arguments, NULL);
    *out = (struct worded){.arguments.command = &cmd_words};
    if (!own || !join(out, words, own, arguments)) {
        json_decref(own);
        print_error_line("not enough memory");
        return EXIT_DATA;
    }
    json_decref(own);
    int code = options_parse(&out->arguments, &out->read, &cmd_words, NULL, out->arguments.count, out->words, 0);
    if (code == EXIT_DONE) {
        print_error_line("a session's options say nothing of --help and --version");
    }
    code = code < 0 ? EXIT_DONE : EXIT_DATA;
    if (!code && !space_settings_check(&out->arguments, &out->read.space)) {
        code = EXIT_DATA;
    }
    /* The words say what is opened, and the rest is as it was given. */
    struct view_settings *settings = &out->settings;
    *settings = *given;
    settings->atlas = out->read.atlas;
    settings->atlas.max_memory = given->atlas.max_memory;
    settings->atlas.shelf = given->atlas.shelf;
    settings->atlas.only = given->atlas.only;
    settings->atlas.hide = given->atlas.hide;
    settings->context = out->read.context;
    settings->transfer = out->read.transfer;
    settings->space = out->read.space;
    settings->poses = out->read.poses ? out->read.poses : given->poses;
    settings->pose = out->read.pose;
    settings->depth = out->read.depth;
    settings->radius = out->read.radius;
    settings->arguments = &out->arguments;
    return code;
}

void worded_finish(struct worded *worded)
{
    int count = worded->arguments.count;
    options_finish(&worded->read, &worded->arguments);
    for (int i = 0; i < count; i++) {
        free(worded->words[i]);
    }
    free(worded->words);
    *worded = (struct worded){0};
}
