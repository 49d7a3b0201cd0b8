/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the tables of options as JSON, for what is made of them beside the program: documents, forms, descriptors. */
#include "base/system/system.h"
#include "conus/version.h"
#include "options/messages.h"
#include "options/provenance.h"
#include "pages/pages.h"

#include <stdlib.h>
#include <string.h>

static const char *const types[] = {
    [OPTION_FLAG] = "flag",     [OPTION_NUMBER] = "number", [OPTION_COUNT] = "count", [OPTION_VECTOR] = "vector",
    [OPTION_RANGE] = "range",   [OPTION_EDGES] = "edges",   [OPTION_SIZE] = "size",   [OPTION_BYTES] = "bytes",
    [OPTION_CHOICE] = "choice", [OPTION_TEXT] = "text",     [OPTION_LIST] = "list",
};

static const char *const roles[] = {
    [OPTION_PLAIN] = "asks",
    [OPTION_ASKS] = "asks",
    [OPTION_KEPT] = "limits",
    [OPTION_OF_RUN] = "runs",
    [OPTION_LIVE] = "tracks",
    [OPTION_READS] = "reads",
    [OPTION_READS_NAMES] = "reads names",
    [OPTION_READS_ATLAS] = "reads",
    [OPTION_READS_IMAGE] = "reads",
    [OPTION_READS_POSES] = "reads",
    [OPTION_WRITES_ANSWER] = "writes",
    [OPTION_WRITES_SIDECAR] = "writes",
    [OPTION_WRITES] = "writes",
    [OPTION_WRITES_ROWS] = "writes",
    [OPTION_ENDS] = "ends",
};

static const char *const contents[] = {
    [HOLDS_NOTHING] = NULL,      [HOLDS_ATLAS] = "atlas",   [HOLDS_VOLUME] = "volume",
    [HOLDS_LABELS] = "labels",   [HOLDS_POSES] = "poses",   [HOLDS_PROBE] = "probe",
    [HOLDS_SURFACE] = "surface", [HOLDS_TRACTS] = "tracts", [HOLDS_TRANSFORM] = "transform",
    [HOLDS_NAMES] = "names",     [HOLDS_ROWS] = "rows",     [HOLDS_PICTURE] = "picture",
    [HOLDS_COLOURS] = "colours", [HOLDS_FOLDER] = "folder", [HOLDS_SIDECAR] = "sidecar",
    [HOLDS_SESSION] = "session", [HOLDS_PAGE] = "page",     [HOLDS_PACK] = "pack",
    [HOLDS_TEXT] = "text",
};

/* The texts between separators, of which only options of the command count; NULL where there are none. */
static json_t *list_of(const char *text, const char *separator, const struct command *command)
{
    json_t *list = NULL;
    for (size_t size; text && *text; text += size + strspn(text + size, " ,|")) {
        char name[OPTION_LIMIT];
        size = strcspn(text, separator);
        snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "=|, "), text);
        if (!command || option_find(command, name)) {
            list = list ? list : json_array();
            json_array_append_new(list, json_stringn(text, size));
        }
    }
    return list;
}

/* All that it cannot stand beside, whichever row says so; NULL for nothing. */
static json_t *excluded(const struct command *command, const struct option *option)
{
    json_t *list = NULL;
    const struct option *other;
    for (size_t i = 0; (other = option_at(command, i)); i++) {
        if (option_excludes(option, other) || option_excludes(other, option)) {
            list = list ? list : json_array();
            json_array_append_new(list, json_string(other->name));
        }
    }
    return list;
}

static json_t *choices_of(const struct option *option)
{
    json_t *list = option->type == OPTION_CHOICE ? json_array() : NULL;
    const char *choice;
    for (size_t i = 0; list && (choice = option_choice(option, i)); i++) {
        json_array_append_new(list, json_string(choice));
    }
    return list;
}

static json_t *range_of(const struct option *option)
{
    bool has_range = option->low != 0 || option->high != 0;
    return has_range ? json_pack("{s:f, s:f, s:b, s:b}", "low", option->low, "high", option->high, "above",
                                 option->open || option->open_below, "below", option->open)
                     : NULL;
}

static json_t *option_json(const struct command *command, const struct option *option, const char *group)
{
    const char letter[] = {option->letter, '\0'};
    bool is_place = option->flags & OPTION_IS_PLACE;
    bool is_text = option->type == OPTION_TEXT || option->type == OPTION_LIST;
    bool reads = option->role == OPTION_PLAIN && is_text && option->holds;
    return json_pack("{s:s, s:s*, s:s, s:s, s:s, s:s*, s:b, s:s, s:s*, s:s*, s:s*, s:s*, s:b, s:b, s:o*, s:o*, s:o*, "
                     "s:o*, s:o*, s:o*}",
                     "name", option->name, "letter", option->letter ? letter : NULL, "group", group, "type",
                     is_place ? "place" : types[option->type], "help", option->help, "value", option->value, "repeats",
                     option->type == OPTION_LIST, "role", reads ? "reads" : roles[option->role], "holds",
                     contents[option->holds], "unit", option->unit, "default", option_standard(option), "otherwise",
                     option->otherwise, "required", option->required, "common", option->common, "range",
                     range_of(option), "choices", choices_of(option), "needs", list_of(option->needs, "|", command),
                     "excludes", excluded(command, option), "endings", list_of(option->endings, " ", NULL), "words",
                     list_of(option->words, ",", NULL));
}

static json_t *operands_of(const struct command *command)
{
    json_t *list = json_array();
    for (size_t i = 0; i < OPERAND_LIMIT && command->operands[i]; i++) {
        bool is_last = i + 1 == OPERAND_LIMIT || !command->operands[i + 1];
        json_array_append_new(list, json_pack("{s:s, s:s*, s:b, s:b}", "name", command->operands[i], "holds",
                                              contents[command->holds[i]], "repeats", command->repeats && is_last,
                                              "optional", command->optional || (command->optional_last && is_last)));
    }
    return list;
}

static void put_more_help(FILE *out, const struct command *command)
{
    command->more_help(out);
}

/* A part of the help. */
static json_t *text_of(void (*put)(FILE *out, const struct command *command), const struct command *command)
{
    struct system_text text;
    if (system_text_open(&text)) {
        put(text.stream, command);
    }
    json_t *words = json_string(system_text_close(&text));
    free(text.data);
    return words;
}

json_t *pages_options(const struct command *command)
{
    json_t *options = json_array();
    const char *title = "";
    for (const struct option_group *group = command->groups; group && group->title; group++) {
        title = *group->title ? group->title : title;
        for (const struct option *option = group->options; option->name; option++) {
            json_array_append_new(options, option_json(command, option, title));
        }
    }
    return options;
}

json_t *pages_command(const struct command *command)
{
    return json_pack("{s:s, s:s, s:s, s:o, s:s*, s:b, s:b, s:b, s:o*, s:s, s:o*, s:o}", "name", command->name,
                     "summary", command->summary, "description", command->description, "operands", operands_of(command),
                     "form", command->form, "answers", command->answers, "resumes", command->resumes, "other",
                     command->hand_over != NULL, "usage", text_of(help_usage, command), "examples", command->examples,
                     "notes", command->more_help ? text_of(put_more_help, command) : NULL, "options",
                     pages_options(command));
}

bool pages_answer(int *code, const struct program *program, int count, char **words)
{
    if (count != 3 || strcmp(words[1], "help") != 0 || strcmp(words[2], "--json") != 0) {
        return false;
    }
    json_t *commands = json_array();
    json_t *exits = json_array();
    const char *meaning;
    for (size_t i = 0; program->commands[i]; i++) {
        json_array_append_new(commands, pages_command(program->commands[i]));
    }
    for (size_t i = 0; (meaning = help_exit_code(i)); i++) {
        json_array_append_new(exits, json_string(meaning));
    }
    json_t *root =
        json_pack("{s:s, s:s, s:s*, s:s*, s:o, s:o}", "program", program->name, "version", conus_version(), "summary",
                  program->summary, "description", program->description, "exit_codes", exits, "commands", commands);
    *code = json_put(stdout, root, JSON_INDENT(1) | JSON_REAL_PRECISION(9)) ? EXIT_DONE : print_no_memory();
    return true;
}
