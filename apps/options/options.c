/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a command line by a command's table of options. */
#include "options/options.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "sources/names.h"

#include <assert.h>
#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { CONTINUE = -1 };

/** An option of a command, with its place in the command's settings. */
struct found {
    const struct option *option; /* NULL if there is none */
    void *field;
    unsigned ordinal;
};

/** The words still to be read. */
struct cursor {
    struct arguments *arguments;
    void *settings;
    int next;
    bool operands_only; /* after "--" */
};

/* Option number `ordinal` of the command. */
static struct found found_at(const struct command *command, void *settings, size_t ordinal)
{
    size_t n = 0;
    for (const struct option_group *group = command->groups; group->title; group++) {
        for (const struct option *option = group->options; option->name; option++) {
            if (n++ == ordinal) {
                char *field = settings ? (char *)settings + group->offset + option->offset : NULL;
                return (struct found){option, field, (unsigned)ordinal};
            }
        }
    }
    return (struct found){0};
}

static const char *name_at(const void *command, size_t index)
{
    const struct option *option = found_at(command, NULL, index).option;
    return option ? option->name : NULL;
}

/* Whether the option is called by these letters; "_" is taken for "-", as Python has it. */
static bool is_called(const struct option *option, const char *name, size_t length)
{
    size_t i = 0;
    while (i < length && option->name[i] == (name[i] == '_' ? '-' : name[i])) {
        i++;
    }
    return i == length && !option->name[i];
}

static struct found find_name(const struct command *command, void *settings, const char *name, size_t length)
{
    struct found found;
    for (size_t i = 0; (found = found_at(command, settings, i)).option && !is_called(found.option, name, length);) {
        i++;
    }
    return found;
}

bool option_given(const struct arguments *arguments, const char *name)
{
    struct found found = find_name(arguments->command, NULL, name, strlen(name));
    assert(found.option);
    return arguments->given[found.ordinal];
}

bool option_restated(const struct arguments *arguments, const char *name)
{
    struct found found = find_name(arguments->command, NULL, name, strlen(name));
    assert(found.option);
    return arguments->restated[found.ordinal];
}

void option_warn_restated(const struct arguments *arguments, const char *name, const char *other)
{
    if (option_restated(arguments, name)) {
        print_error_line("warning: --%s %s is the default, and has no effect beside --%s", name,
                         option_standard(option_find(arguments->command, name)), other);
    }
}

const struct option *option_at(const struct command *command, size_t index)
{
    return found_at(command, NULL, index).option;
}

void *option_field(const struct command *command, void *settings, size_t index)
{
    return found_at(command, settings, index).field;
}

const struct option *option_find(const struct command *command, const char *name)
{
    return find_name(command, NULL, name, strlen(name)).option;
}

/* The last use of the option; NULL if there is none. */
static const struct option_use *find_use(const struct arguments *arguments, const char *name)
{
    const struct option_use *found = NULL;
    for (size_t i = 0; i < arguments->use_count; i++) {
        found = strcmp(arguments->uses[i].option->name, name) == 0 ? &arguments->uses[i] : found;
    }
    return found;
}

const char *option_text(const struct arguments *arguments, const char *name)
{
    const struct option_use *use = find_use(arguments, name);
    return use ? use->value : NULL;
}

const char *option_key(const struct arguments *arguments, const char *name)
{
    const struct option_use *use = find_use(arguments, name);
    return use ? use->key : NULL;
}

double option_key_number(const struct arguments *arguments, const char *name, double otherwise)
{
    double number = 0;
    const char *text = option_key(arguments, name);
    return text && number_parse(text, &number) ? number : otherwise;
}

const struct option *option_with(const struct arguments *arguments, unsigned flags)
{
    const struct option *option;
    for (size_t i = 0; (option = option_at(arguments->command, i)); i++) {
        if (arguments->given[i] && option->flags & flags) {
            return option;
        }
    }
    return NULL;
}

/* Takes the value of an option: what follows "=", or the next word. Vectors and numbers may begin with one dash. */
static const char *take_value(struct cursor *cursor, const struct option *option, const char *attached)
{
    struct arguments *arguments = cursor->arguments;
    if (attached) {
        return attached;
    }
    const char *word = cursor->next < arguments->count ? arguments->words[cursor->next] : NULL;
    if (!word) {
        print_error_line("--%s needs a value: --%s %s", option->name, option->name, option->value);
        return NULL;
    }
    if (strncmp(word, "--", 2) == 0) {
        print_error_line("--%s needs a value before %s: --%s %s", option->name, word, option->name, option->value);
        return NULL;
    }
    cursor->next++;
    return word;
}

/* Cuts the key of an output off. */
static int cut_key(struct option_use *use)
{
    const struct option *option = use->option;
    struct source_keys keys;
    if (!option->keys) {
        return CONTINUE;
    }
    use->file = strdup(use->value);
    if (!option_cut_keys(&keys, option->name, use->file, option->keys)) {
        return EXIT_USAGE;
    }
    use->value = use->file;
    if (keys.count) {
        use->key = keys.values[0].text.data;
        use->key_name = keys_name(&keys.values[0]);
    }
    return CONTINUE;
}

/* Joins a place's first number with the next two words, where these are numbers, too. */
static int join_numbers(struct option_use *use, struct cursor *cursor)
{
    const struct arguments *arguments = cursor->arguments;
    char **next = arguments->words + cursor->next;
    double number;
    if (!(use->option->flags & OPTION_IS_PLACE) || cursor->next + 2 > arguments->count ||
        !number_parse(use->value, &number) || !number_parse(next[0], &number) || !number_parse(next[1], &number)) {
        return CONTINUE;
    }
    size_t size = strlen(use->value) + strlen(next[0]) + strlen(next[1]) + 3;
    use->file = malloc(size);
    if (!use->file) {
        return print_no_memory();
    }
    snprintf(use->file, size, "%s %s %s", use->value, next[0], next[1]);
    use->value = use->file;
    cursor->next += 2;
    return CONTINUE;
}

static int take_option(struct cursor *cursor, struct found found, const char *attached)
{
    struct arguments *arguments = cursor->arguments;
    const struct option *option = found.option;
    struct option_use use = {.option = option};
    if (option->type == OPTION_FLAG && attached) {
        return print_usage_error("--%s takes no value, found \"%s\"", option->name, attached);
    }
    if (arguments->given[found.ordinal] && option->type != OPTION_LIST) {
        return print_usage_error("--%s is given twice", option->name);
    }
    if (option->type != OPTION_FLAG && !(use.value = take_value(cursor, option, attached))) {
        return EXIT_USAGE;
    }
    arguments->given[found.ordinal] = true;
    struct option_use *uses = realloc(arguments->uses, (arguments->use_count + 1) * sizeof *uses);
    if (!uses) {
        return print_no_memory();
    }
    arguments->uses = uses;
    int code = attached ? CONTINUE : join_numbers(&use, cursor);
    code = code != CONTINUE ? code : cut_key(&use);
    arguments->uses[arguments->use_count++] = use;
    return code != CONTINUE || option_read(option, found.field, use.value) ? code : EXIT_USAGE;
}

/* Whether `name` is one of the words, which commas separate, in any case. */
static bool is_among(const char *words, const char *name)
{
    bool found = false;
    size_t length = strlen(name);
    for (size_t size; words && *words && !found; words += size + strspn(words + size, ", ")) {
        size = strcspn(words, ",");
        found = size == length && strncasecmp(words, name, size) == 0;
    }
    return found;
}

/* The name of another command of the family that has the option; NULL = none. */
static const char *command_with(const struct command *const *other, const char *name)
{
    for (; other && *other; other++) {
        if ((*other)->groups && find_name(*other, NULL, name, strlen(name)).option) {
            return (*other)->name;
        }
    }
    return NULL;
}

const struct command *command_of_operand(const struct command *const *family, const char *word)
{
    while (*family && !is_among((*family)->words, word)) {
        family++;
    }
    return *family;
}

static int print_unknown_option(const struct arguments *arguments, const char *word, const char *name)
{
    const struct command *command = arguments->command;
    const char *program = command->program ? command->program : "conus";
    if (command->hand_over) {
        return print_usage_error("unknown option %s of %s %s where %s-%s is not installed; %s %s --help lists those "
                                 "that it has there",
                                 word, program, command->name, program, command->name, program, command->name);
    }
    const struct command *of = arguments->family ? command_of_operand(arguments->family, name) : NULL;
    if (of == command) {
        return print_usage_error("unknown option %s; %s stands behind %s, without an option: %s %s %s %s", word,
                                 of->operands[1], of->operands[0], program, of->name, of->operands[0], of->operands[1]);
    }
    const struct option *meant = NULL; /* the option that people call by this name */
    const struct option *option;
    for (size_t i = 0; !meant && (option = option_at(command, i)); i++) {
        meant = is_among(option->words, name) ? option : NULL;
    }
    const char *near = meant ? meant->name : of ? NULL : closest_name(name, name_at, command);
    const char *other = near ? NULL : of ? of->name : command_with(arguments->family, name);
    if (meant && meant->letter) {
        return print_usage_error("unknown option %s; did you mean -%c, --%s?", word, meant->letter, near);
    }
    return near    ? print_usage_error("unknown option %s; did you mean --%s?", word, near)
           : of    ? print_usage_error("unknown option %s of %s %s; %s %s takes it as its %s", word, program,
                                       command->name, program, other, of->operands[1])
           : other ? print_usage_error("unknown option %s of %s %s; %s %s has it", word, program, command->name,
                                       program, other)
                   : print_usage_error("unknown option %s; %s %s --help lists them", word, program, command->name);
}

static int take_long(struct cursor *cursor, const char *word)
{
    const struct command *command = cursor->arguments->command;
    const char *name = word + 2;
    size_t length = strcspn(name, "=");
    struct found found = find_name(command, cursor->settings, name, length);
    if (!found.option) {
        char bare[OPTION_LIMIT];
        snprintf(bare, sizeof bare, "%.*s", (int)(length < sizeof bare ? length : 0), name);
        return print_unknown_option(cursor->arguments, word, bare);
    }
    return take_option(cursor, found, name[length] ? name + length + 1 : NULL);
}

static bool is_image(const char *path)
{
    return ending_length(path, strlen(path), ROLE_VOLUME);
}

/* A word behind all operands: a part of a vector, or a file without its option. */
static int print_unexpected(const struct arguments *arguments, const char *word)
{
    const struct found poses = find_name(arguments->command, NULL, "poses", 5);
    const struct found pose = find_name(arguments->command, NULL, "pose", 4);
    const struct found *found = poses.option ? &poses : &pose;
    const struct found point = find_name(arguments->command, NULL, "point", 5);
    const bool may_be_point = point.option && !arguments->given[point.ordinal];
    if (strspn(word, "+-.,0123456789") == strlen(word)) {
        return print_usage_error(may_be_point
                                     ? "unexpected argument \"%s\"; a point is given as --point X,Y,Z"
                                     : "unexpected argument \"%s\"; a vector is one word: X,Y,Z without spaces",
                                 word);
    }
    if (may_be_point && !strpbrk(word, "./")) {
        return print_usage_error(
            "unexpected argument \"%s\"; a place is given as --point %s, a file of poses as --%s FILE", word, word,
            found->option->name);
    }
    if (find_name(arguments->command, NULL, "streamlines", 11).option && conus_path_is_tractogram(word)) {
        return print_usage_error("unexpected argument \"%s\"; a tractogram is given as --streamlines %s", word, word);
    }
    if (find_name(arguments->command, NULL, "pathway", 7).option && is_image(word)) {
        const bool may_draw = find_name(arguments->command, NULL, "shell", 5).option;
        return print_usage_error("unexpected argument \"%s\"; --pathway %s%s what is bright in an image, and conus "
                                 "overlap asks which areas that covers",
                                 word, word, may_draw ? " --shell --style print draws" : " adds");
    }
    if (point.option && arguments->given[point.ordinal] && !strpbrk(word, "./")) {
        return print_usage_error("unexpected argument \"%s\"; a place of several words is put in quotes", word);
    }
    if (found->option && !arguments->given[found->ordinal]) {
        return print_usage_error("unexpected argument \"%s\"; a file of poses is given as --%s %s", word,
                                 found->option->name, word);
    }
    const char *of_one = arguments->command->of_one;
    return of_one ? print_usage_error("unexpected argument \"%s\"; %s %s describes it", word, of_one, word)
                  : print_usage_error("unexpected argument \"%s\"", word);
}

static int take_short(struct cursor *cursor, const char *word)
{
    const struct command *command = cursor->arguments->command;
    struct found found;
    if (isdigit((unsigned char)word[1])) {
        return print_unexpected(cursor->arguments, word);
    }
    for (size_t i = 0; (found = found_at(command, cursor->settings, i)).option && found.option->letter != word[1];) {
        i++;
    }
    if (!found.option) {
        return print_unknown_option(cursor->arguments, word, word + 1);
    }
    cursor->arguments->is_brief = true; /* if it is -h */
    return take_option(cursor, found, word[2] ? word + 2 : NULL);
}

static int take_operand(struct cursor *cursor, const char *word)
{
    struct arguments *arguments = cursor->arguments;
    const struct command *command = arguments->command;
    bool all = arguments->operand_count == OPERAND_LIMIT || !command->operands[arguments->operand_count];
    if (command->repeats && arguments->operand_count && all) {
        if (!*word) {
            return print_usage_error("%s is empty", command->operands[arguments->operand_count - 1]);
        }
        struct option_list *more = &arguments->more;
        const char **items = realloc(more->items, (more->count + 1) * sizeof *items);
        if (!items) {
            return print_no_memory();
        }
        more->items = items;
        more->items[more->count++] = word;
        return CONTINUE;
    }
    if (all) {
        return print_unexpected(arguments, word);
    }
    arguments->operands[arguments->operand_count++] = word;
    return *word ? CONTINUE
                 : print_usage_error("%s is empty", arguments->command->operands[arguments->operand_count - 1]);
}

static int take_word(struct cursor *cursor, const char *word)
{
    if (cursor->operands_only || word[0] != '-' || word[1] == '\0') {
        return take_operand(cursor, word);
    }
    if (word[1] != '-') {
        return take_short(cursor, word);
    }
    cursor->operands_only = word[2] == '\0';
    cursor->arguments->is_brief = false;
    return cursor->operands_only ? CONTINUE : take_long(cursor, word);
}

/* Takes back what is given as it is where it is not given. */
static void drop_standards(struct arguments *arguments, void *settings)
{
    size_t kept = 0;
    for (size_t i = 0; i < arguments->use_count; i++) {
        struct option_use use = arguments->uses[i];
        struct found found = find_name(arguments->command, settings, use.option->name, strlen(use.option->name));
        if (option_is_standard(use.option, use.value, found.field)) {
            arguments->given[found.ordinal] = false;
            arguments->restated[found.ordinal] = true;
            free(use.file);
        } else {
            arguments->uses[kept++] = use;
        }
    }
    arguments->use_count = kept;
}

/* All operands and all options that must be given. */
static int check_complete(const struct arguments *arguments)
{
    const struct command *command = arguments->command;
    struct found found;
    size_t next = arguments->operand_count;
    bool is_missing = next < OPERAND_LIMIT && command->operands[next] && !command->optional;
    if (is_missing && !(command->optional_last && (next + 1 == OPERAND_LIMIT || !command->operands[next + 1]))) {
        return print_usage_error("%s is missing; %s %s --help shows how", command->operands[next],
                                 command->program ? command->program : "conus", command->name);
    }
    for (size_t i = 0; (found = found_at(command, NULL, i)).option; i++) {
        if (found.option->required && !arguments->given[i]) {
            return print_usage_error("--%s %s is missing", found.option->name, found.option->value);
        }
    }
    return CONTINUE;
}

/* Whether one of the options that it needs, "pose|poses" or "sampling=slices", is given, or the command has none of
 * them. The message names the first that it has. */
static bool check_needs(const struct arguments *arguments, const struct option *option)
{
    char first[2 * OPTION_LIMIT] = "";
    for (const char *at = option->needs; at && *at; at += *at == '|') {
        char word[OPTION_LIMIT];
        size_t size = strcspn(at, "|");
        snprintf(word, sizeof word, "%.*s", (int)size, at);
        at += size;
        char *choice = strchr(word, '=');
        if (choice) {
            *choice++ = '\0';
        }
        if (!option_find(arguments->command, word)) {
            continue;
        }
        const char *given = option_text(arguments, word);
        if (choice ? given && strcasecmp(given, choice) == 0 : option_given(arguments, word)) {
            return true;
        }
        if (!*first) {
            snprintf(first, sizeof first, "%s%s%s", word, choice ? " " : "", choice ? choice : "");
        }
    }
    if (*first) {
        print_error_line("--%s has no effect without --%s", option->name, first);
    }
    return !*first;
}

bool option_excludes(const struct option *option, const struct option *other)
{
    return is_among(option->excludes, other->name) ||
           (option->flags & (OPTION_OF_CONE | OPTION_OF_RAYS) && strcmp(other->name, "point") == 0) ||
           (option->flags & OPTION_OF_ONE_ATLAS && strcmp(other->name, "atlas") == 0);
}

static bool check_excludes(const struct arguments *arguments, const struct option *option)
{
    const struct option *other;
    for (size_t i = 0; (other = option_at(arguments->command, i)); i++) {
        if (arguments->given[i] && option_excludes(option, other)) {
            bool by_name = is_among(option->excludes, other->name);
            return refuse("--%s and --%s exclude each other%s%s", by_name ? option->name : other->name,
                          by_name ? other->name : option->name, option->because ? ": " : "",
                          option->because ? option->because : "");
        }
    }
    return true;
}

static bool check_ending(const struct arguments *arguments, const struct option *option)
{
    const char *path = option->endings ? option_text(arguments, option->name) : NULL;
    char list[64] = "";
    size_t size = 0;
    for (const char *at = path ? option->endings : ""; *at;) {
        char ending[16];
        size_t length = strcspn(at, " ");
        snprintf(ending, sizeof ending, "%.*s", (int)length, at);
        if (path_ends_in(path, ending)) {
            return true;
        }
        at += length + (at[length] == ' ');
        size += (size_t)snprintf(list + size, sizeof list - size, "%s%s", !size ? "" : *at ? ", " : " or ", ending);
    }
    if (path) {
        print_error_line("--%s: \"%s\" does not end in %s", option->name, path, list);
    }
    return !path;
}

/* Checks the relations in the table, then the endings. */
static int check_relations(const struct arguments *arguments)
{
    const struct option *option;
    bool fits = true;
    for (size_t i = 0; fits && (option = option_at(arguments->command, i)); i++) {
        fits = !arguments->given[i] || (check_excludes(arguments, option) && check_needs(arguments, option));
    }
    for (size_t i = 0; fits && (option = option_at(arguments->command, i)); i++) {
        fits = !arguments->given[i] || check_ending(arguments, option);
    }
    return fits ? CONTINUE : EXIT_USAGE;
}

/* Says which defaults were given beside what excludes their options, of each the first. */
static void warn_of_restated(const struct arguments *arguments)
{
    const struct option *option;
    const struct option *other;
    for (size_t i = 0; (option = option_at(arguments->command, i)); i++) {
        bool is_said = !arguments->restated[i];
        for (size_t k = 0; !is_said && (other = option_at(arguments->command, k)); k++) {
            is_said = arguments->given[k] && (option_excludes(option, other) || option_excludes(other, option));
            if (is_said) {
                option_warn_restated(arguments, option->name, other->name);
            }
        }
    }
}

int options_parse(struct arguments *out, void *settings, const struct command *command,
                  const struct command *const *family, int count, char **words, int first)
{
    assert(!found_at(command, NULL, OPTION_LIMIT).option);
    *out = (struct arguments){.command = command, .family = family, .count = count, .words = words};
    struct cursor cursor = {.arguments = out, .settings = settings, .next = first};
    while (cursor.next < count) {
        int code = take_word(&cursor, words[cursor.next++]);
        if (code != CONTINUE) {
            return code;
        }
        if (option_given(out, "help")) {
            (out->is_brief ? help_brief : help_command)(stdout, command);
            return EXIT_DONE;
        }
        if (option_given(out, "version")) {
            printf("conus %s\n", conus_version());
            return EXIT_DONE;
        }
    }
    if (!command->resumes) {
        drop_standards(out, settings);
    }
    int code = check_complete(out);
    code = code == CONTINUE ? check_relations(out) : code;
    if (code == CONTINUE) {
        warn_of_restated(out);
    }
    return code;
}

void options_finish(void *settings, struct arguments *arguments)
{
    const struct command *command = arguments->command;
    struct found found;
    for (size_t i = 0; (found = found_at(command, settings, i)).option; i++) {
        struct option_list *list = found.field;
        if (list && found.option->type == OPTION_LIST) {
            free(list->items);
        }
    }
    for (size_t i = 0; i < arguments->use_count; i++) {
        free(arguments->uses[i].file);
    }
    free(arguments->uses);
    arguments->uses = NULL;
    arguments->use_count = 0;
    free(arguments->more.items);
    arguments->more = (struct option_list){0};
}

/* Writes a word in single quotes unless it is made of harmless characters. */
static void put_word(FILE *out, const char *word)
{
    static const char harmless[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=+.,/:@%";
    if (*word && strspn(word, harmless) == strlen(word)) {
        fputs(word, out);
        return;
    }
    fputc('\'', out);
    for (; *word; word++) {
        fputs(*word == '\'' ? "'\\''" : (char[]){*word, '\0'}, out);
    }
    fputc('\'', out);
}

char *arguments_text(const struct arguments *arguments)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    if (!out) {
        return NULL;
    }
    fputs(arguments->command->program ? arguments->command->program : "conus", out);
    for (int i = 1; i < arguments->count; i++) {
        fputc(' ', out);
        put_word(out, arguments->words[i]);
    }
    return system_text_close(&text);
}

void words_put(struct command_words *words, const char *option, const char *value)
{
    char *word = NULL;
    char **grown = realloc(words->items, (words->count + 2) * sizeof *grown);
    words->items = grown ? grown : words->items;
    if (!grown || asprintf(&word, "%s%s%s%s", option ? "--" : "", option ? option : "", option && value ? "=" : "",
                           value ? value : "") < 0) {
        words->is_lost = true;
        return;
    }
    words->items[words->count++] = word;
    words->items[words->count] = NULL;
}

void words_finish(struct command_words *words)
{
    for (size_t i = 0; i < words->count; i++) {
        free(words->items[i]);
    }
    free(words->items);
    *words = (struct command_words){0};
}

int words_run(struct command_words *words, const struct command *command, const char *folder)
{
    char here[SYSTEM_PATH];
    struct arguments arguments = {.command = command};
    void *settings = calloc(1, command->settings_size);
    if (!settings || words->is_lost) {
        free(settings);
        return print_no_memory();
    }
    if (!system_here(here) || !system_enter(folder)) {
        free(settings);
        return print_system_error(folder, "enter");
    }
    int code = options_parse(&arguments, settings, command, NULL, (int)words->count, words->items, 2);
    code = code >= 0 ? code : command->run(settings, &arguments);
    options_finish(settings, &arguments);
    free(settings);
    return system_enter(here) ? code : print_system_error(here, "enter");
}
