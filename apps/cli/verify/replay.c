/* SPDX-License-Identifier: BSD-3-Clause */
/* Rewrites a recorded command line, so that it reads what was found and writes into a folder of its own, and runs its
 * command. */
#include "base/path.h"
#include "base/system/system.h"
#include "cli/verify/verify.h"
#include "options/messages.h"
#include "options/output.h"
#include "sources/names.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 16 };

static bool fail_replay(struct replay *replay, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool fail_replay(struct replay *replay, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(replay->why, sizeof replay->why, format, args);
    va_end(args);
    return false;
}

static const struct command *find_command(const struct command *const *commands, const char *name)
{
    while (*commands && !((*commands)->answers && strcmp((*commands)->name, name) == 0)) {
        commands++;
    }
    return *commands;
}

/* --help and --version would end the parser, and print. */
static bool asks_for_help(const struct command_line *line)
{
    bool asks = false;
    for (size_t i = 0; i < line->count; i++) {
        const char *word = line->words[i];
        asks = asks || strcmp(word, "-h") == 0 || strcmp(word, "--help") == 0 || strcmp(word, "--version") == 0;
    }
    return asks;
}

/* Whether `word` begins with the path of a recorded file, or of its folder, behind which only keys may stand. */
static bool is_recorded(const struct record *record, const char *word)
{
    const size_t folder = path_plain_length(word, strcspn(word, ","));
    bool found = false;
    for (size_t i = 0; i < record->input_count && !found; i++) {
        const char *path = record->inputs[i].path;
        size_t length = strlen(path);
        found = (strncmp(word, path, length) == 0 && (!word[length] || word[length] == ',')) ||
                (folder && strncmp(word, path, folder) == 0 && path[folder] && strchr(SYSTEM_SEPARATORS, path[folder]));
    }
    return found;
}

/* Whether a path leads out of any folder that it may be put into. */
static bool leads_out(const char *path)
{
    const char *part;
    bool is_up = false;
    bool is_whole = path_is_whole(path);
    for (size_t length; !is_up && path_part(&path, &part, &length);) {
        is_up = length >= 2 && strncmp(part, "..", 2) == 0 && (length == 2 || part[2] == ',');
    }
    return is_up || is_whole;
}

/* Whether all files that a word of the command line may name are recorded: at its begin, where it must be one, and
 * where one of "from=FILE" or "@FILE" may be. Others could only be below the stage, where nothing else is. */
static bool names_recorded(const struct record *record, const char *word, bool is_file)
{
    bool known = !is_file || is_recorded(record, word);
    for (const char *at = word; *at && known; at++) {
        bool is_list = *at == '@' && (at == word || strchr(", ", at[-1]));
        bool may_begin = at == word || strchr("=@,", at[-1]);
        known = (!is_list || is_recorded(record, at + 1)) && (!may_begin || !leads_out(at) || is_recorded(record, at));
    }
    return known;
}

static bool parse_words(struct replay *out, const struct command *const *commands)
{
    const struct command_line *line = &out->record->line;
    bool known = line->count > 1 && strcmp(line->words[0], "conus") == 0;
    out->command = known ? find_command(commands, line->words[1]) : NULL;
    if (!out->command || asks_for_help(line)) {
        return fail_replay(out,
                           "its command line begins with \"%.40s %.40s\": only conus query, batch, sweep, track, "
                           "overlap, connect, plan, calibrate and "
                           "positions are asked again",
                           line->words[0], line->count > 1 ? line->words[1] : "");
    }
    out->settings = calloc(1, out->command->settings_size);
    if (!out->settings) {
        return fail_replay(out, "it does not fit into memory");
    }
    messages_hold(true);
    int code = options_parse(&out->arguments, out->settings, out->command, commands, (int)line->count, line->words, 2);
    messages_hold(false);
    return code < 0 ||
           fail_replay(out, "this conus, %s, does not take its command line: %s", conus_version(), error_line());
}

/* A plan that a signal ended says so in its last warning: another run would end elsewhere. */
static bool was_interrupted(const struct record *record)
{
    const json_t *warnings = json_object_get(record->root, "Warnings");
    const char *last = json_string_value(json_array_get(warnings, json_array_size(warnings) - 1));
    return last && strncmp(last, "interrupted: ", strlen("interrupted: ")) == 0;
}

bool replay_check(struct replay *out, const struct command *const *commands)
{
    if (!parse_words(out, commands)) {
        return false;
    }
    if (was_interrupted(out->record)) {
        return fail_replay(out, "its run was interrupted, and another one would not end at the same pose");
    }
    const struct arguments *arguments = &out->arguments;
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        const char *name = use->option->name;
        enum option_role role = use->option->role;
        bool is_text = use->option->type == OPTION_TEXT || use->option->type == OPTION_LIST;
        if (role == OPTION_LIVE) {
            return fail_replay(out, "its poses came from a tracker (--%s), which cannot be asked again", name);
        }
        if (role == OPTION_READS_POSES && poses_are_stdin(use->value)) {
            return fail_replay(out, "its poses came from standard input, which cannot be read again");
        }
        if (role == OPTION_ENDS || (role == OPTION_PLAIN && is_text)) {
            return fail_replay(out, "its command line has --%s, which is not asked again", name);
        }
    }
    return true;
}

/* Words on the way. */
struct writing {
    struct replay *replay;
    struct command_words words;
    size_t atlases;  /* how many of --atlas were written */
    const char *bad; /* a word that reads a file which is not recorded; NULL = none */
    bool has_output, has_format;
};

/* An operand (no name), or an option, which may name files. */
static void put_read(struct writing *out, const char *name, const char *given, bool is_file)
{
    char *word = out->replay->is_moved ? stage_word(&out->replay->stage, given) : strdup(given);
    out->bad = names_recorded(out->replay->record, given, is_file) ? out->bad : given;
    out->words.is_lost = out->words.is_lost || !word;
    words_put(&out->words, name, word);
    free(word);
}

/* An atlas or image. What was given by its name is the recorded file, with the keys that it was given. */
static void put_named(struct writing *out, const char *name, const char *given, const char *recorded)
{
    char *keyed = NULL;
    if (!recorded || !path_is_name(given) || is_recorded(out->replay->record, given)) {
        put_read(out, name, given, true);
    } else if (asprintf(&keyed, "%.*s%s", (int)keys_file_length(recorded, KEYS_ATLAS), recorded,
                        given + keys_file_length(given, KEYS_ATLAS)) < 0) {
        out->words.is_lost = true;
    } else {
        put_read(out, name, keyed, true);
        free(keyed);
    }
}

static void put_atlas(struct writing *out, const char *name, const char *given, size_t index)
{
    put_named(out, name, given, record_atlas(out->replay->record, index));
}

/* A file of the same name in a folder of its own, with its key. */
static void put_output(struct writing *out, const struct option_use *use)
{
    const struct option *option = use->option;
    const char *given = use->value;
    const char *key = use->key;
    /* Rows beside an answer have a format by their file's ending; those that went to no file are not compared. */
    const char *no_file = option->role == OPTION_WRITES_ROWS ? "rows.tsv" : "rows";
    const char *name = output_is_no_file(given) ? no_file : path_name(given);
    const char *format;
    char *path = stage_output(&out->replay->stage, option->name, name);
    char *keyed = NULL;
    if (path && key && asprintf(&keyed, "%s,%s=%s", path, use->key_name, key) < 0) {
        keyed = NULL;
    }
    if (option->role == OPTION_WRITES_ANSWER) {
        if (!out->has_format && path && !output_format(&format, path)) { /* it went to no file */
            words_put(&out->words, "format", option->format);
        }
        out->has_output = true;
    }
    out->words.is_lost = out->words.is_lost || !path || (key && !keyed);
    words_put(&out->words, option->name, key ? keyed : path);
    free(keyed);
    free(path);
}

static void put_use(struct writing *out, const struct option_use *use)
{
    const char *name = use->option->name;
    switch (use->option->role) {
    case OPTION_PLAIN:
    case OPTION_ASKS:
    case OPTION_KEPT:
    case OPTION_READS_NAMES:
        if (!use->value) {
            words_put(&out->words, name, NULL);
        } else if (strcmp(name, "max-memory") != 0) {
            put_read(out, name, use->value, false);
        }
        break;
    case OPTION_READS:
    case OPTION_READS_POSES:
        put_read(out, name, use->value, option_names_file(use->option, use->value));
        break;
    case OPTION_READS_ATLAS:
        put_atlas(out, name, use->value, ++out->atlases);
        break;
    case OPTION_READS_IMAGE:
        put_named(out, name, use->value, record_context(out->replay->record));
        break;
    case OPTION_WRITES_ANSWER:
    case OPTION_WRITES:
    case OPTION_WRITES_ROWS:
        put_output(out, use);
        break;
    case OPTION_OF_RUN:
        if (strcmp(name, "shard") == 0) { /* the part that the result is */
            words_put(&out->words, name, use->value);
        }
        break;
    case OPTION_WRITES_SIDECAR: /* it comes beside the answer */
    case OPTION_LIVE:
    case OPTION_ENDS:
        break;
    }
}

static void put_words(struct writing *out)
{
    const struct replay *replay = out->replay;
    const struct arguments *arguments = &replay->arguments;
    char size[32];
    words_put(&out->words, NULL, "conus");
    words_put(&out->words, NULL, replay->command->name);
    words_put(&out->words, "quiet", NULL);
    out->has_format = option_given(arguments, "format");
    for (size_t i = 0; i < arguments->use_count; i++) {
        put_use(out, &arguments->uses[i]);
    }
    if (option_find(replay->command, "max-memory")) {
        snprintf(size, sizeof size, "%" PRIu64, replay->max_memory);
        words_put(&out->words, "max-memory", size);
    }
    if (!out->has_output) {
        put_output(out, &(struct option_use){.option = option_find(replay->command, "output")});
    }
    words_put(&out->words, NULL, "--"); /* since a path may begin with a dash */
    if (arguments->operand_count && replay->command->holds[0] == HOLDS_NOTHING) { /* names */
        words_put(&out->words, NULL, arguments->operands[0]);
    } else if (arguments->operand_count) {
        put_atlas(out, NULL, arguments->operands[0], 0);
    }
    for (size_t i = 1; i < arguments->operand_count; i++) {
        put_read(out, NULL, arguments->operands[i], true);
    }
    for (size_t i = 0; i < arguments->more.count; i++) {
        put_read(out, NULL, arguments->more.items[i], replay->command->holds[0] != HOLDS_NOTHING);
    }
}

/* Runs the command on the words, in the stage, without a word on stderr. */
static bool run_words(struct replay *replay, struct command_words *words)
{
    static const char warning[] = "warning: ";
    char line[sizeof replay->why];
    warnings_forget(0);
    messages_hold(true);
    int code = words_run(words, replay->command, replay->stage.cwd);
    messages_hold(false);
    warnings_forget(0);
    if (code == EXIT_DONE || code == EXIT_DIFFERENT) {
        return true;
    }
    bool is_said = strncmp(error_line(), warning, sizeof warning - 1) != 0;
    snprintf(line, sizeof line, "%s", is_said ? error_line() : "it cannot be answered again");
    message_drop_quotes(line);
    stage_leave(line, replay->stage.folder);
    return fail_replay(replay, "%s", line);
}

/* Makes the folder, and links to all files by relative paths; by whole ones, too, if one of these has moved. */
static bool make_stage(struct replay *replay)
{
    const struct record *record = replay->record;
    for (size_t i = 0; i < record->input_count; i++) {
        replay->is_moved =
            replay->is_moved || (path_is_whole(record->inputs[i].path) && replay->found[i].state == FILE_MOVED);
    }
    bool made = stage_begin(&replay->stage, "verify", LEVELS);
    for (size_t i = 0; i < record->input_count && made; i++) {
        const char *path = record->inputs[i].path;
        made = (path_is_whole(path) && !replay->is_moved) || stage_link(&replay->stage, path, replay->found[i].path);
    }
    return made;
}

bool replay_run(struct replay *replay)
{
    struct writing writing = {.replay = replay};
    messages_hold(true);
    bool made = make_stage(replay);
    messages_hold(false);
    if (!made) {
        return fail_replay(replay, "%s", error_line());
    }
    put_words(&writing);
    bool answered =
        writing.bad
            ? fail_replay(replay, "its command line reads %.200s, which is not recorded as an input", writing.bad)
            : run_words(replay, &writing.words);
    words_finish(&writing.words);
    return answered;
}

void replay_finish(struct replay *replay)
{
    if (replay->settings && replay->arguments.command) {
        options_finish(replay->settings, &replay->arguments);
    }
    free(replay->settings);
    stage_end(&replay->stage, false);
    *replay = (struct replay){0};
}
