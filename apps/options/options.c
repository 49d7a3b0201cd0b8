/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a command line by a command's table of options, and the values by their types. */
#include "options/options.h"

#include "options/messages.h"
#include "options/output.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
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

static struct found find_name(const struct command *command, void *settings, const char *name, size_t length)
{
    struct found found;
    for (size_t i = 0; (found = found_at(command, settings, i)).option; i++) {
        if (strlen(found.option->name) == length && memcmp(found.option->name, name, length) == 0) {
            break;
        }
    }
    return found;
}

static struct found find_letter(const struct command *command, void *settings, char letter)
{
    struct found found;
    for (size_t i = 0; (found = found_at(command, settings, i)).option; i++) {
        if (found.option->letter == letter) {
            break;
        }
    }
    return found;
}

bool option_given(const struct arguments *arguments, const char *name)
{
    struct found found = find_name(arguments->command, NULL, name, strlen(name));
    assert(found.option);
    return arguments->given[found.ordinal];
}

const struct option *option_at(const struct command *command, size_t index)
{
    return found_at(command, NULL, index).option;
}

const struct option *option_find(const struct command *command, const char *name)
{
    return find_name(command, NULL, name, strlen(name)).option;
}

const char *option_text(const struct arguments *arguments, const char *name)
{
    const char *text = NULL;
    for (size_t i = 0; i < arguments->use_count; i++) {
        text = strcmp(arguments->uses[i].option->name, name) == 0 ? arguments->uses[i].value : text;
    }
    return text;
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

static int keep_use(struct arguments *arguments, const struct option *option, const char *value)
{
    struct option_use *uses = realloc(arguments->uses, (arguments->use_count + 1) * sizeof *uses);
    if (!uses) {
        return print_no_memory();
    }
    arguments->uses = uses;
    arguments->uses[arguments->use_count++] = (struct option_use){option, value};
    return CONTINUE;
}

static int take_option(struct cursor *cursor, struct found found, const char *attached)
{
    struct arguments *arguments = cursor->arguments;
    const struct option *option = found.option;
    const char *value = NULL;
    if (option->type == OPTION_FLAG && attached) {
        return print_usage_error("--%s takes no value, found \"%s\"", option->name, attached);
    }
    if (arguments->given[found.ordinal] && option->type != OPTION_LIST) {
        return print_usage_error("--%s is given twice", option->name);
    }
    if (option->type != OPTION_FLAG && !(value = take_value(cursor, option, attached))) {
        return EXIT_USAGE;
    }
    arguments->given[found.ordinal] = true;
    return option_read(option, found.field, value) ? keep_use(arguments, option, value) : EXIT_USAGE;
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

/* The option that people call by this name. */
static const struct option *find_word(const struct command *command, const char *name)
{
    const struct option *option;
    for (size_t i = 0; (option = found_at(command, NULL, i).option); i++) {
        if (is_among(option->words, name)) {
            return option;
        }
    }
    return NULL;
}

/* The name of another command of the family that has the option; NULL = none. */
static const char *command_with(const struct command *command, const char *name)
{
    const struct command *const *other = command->family;
    for (; other && *other; other++) {
        if ((*other)->groups && find_name(*other, NULL, name, strlen(name)).option) {
            return (*other)->name;
        }
    }
    return NULL;
}

static int print_unknown_option(const struct command *command, const char *word, const char *name)
{
    const char *program = command->program ? command->program : "conus";
    const struct option *meant = find_word(command, name);
    const char *near = meant ? meant->name : closest_name(name, name_at, command);
    const char *other = near ? NULL : command_with(command, name);
    if (meant && meant->letter) {
        return print_usage_error("unknown option %s; did you mean -%c, --%s?", word, meant->letter, near);
    }
    return near    ? print_usage_error("unknown option %s; did you mean --%s?", word, near)
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
        return print_unknown_option(command, word, bare);
    }
    return take_option(cursor, found, name[length] ? name + length + 1 : NULL);
}

static int take_short(struct cursor *cursor, const char *word)
{
    struct found found = find_letter(cursor->arguments->command, cursor->settings, word[1]);
    if (!found.option) {
        return print_unknown_option(cursor->arguments->command, word, word + 1);
    }
    cursor->arguments->is_brief = true; /* if it is -h */
    return take_option(cursor, found, word[2] ? word + 2 : NULL);
}

static int take_another(struct option_list *list, const char *word)
{
    const char **items = realloc(list->items, (list->count + 1) * sizeof *items);
    if (!items) {
        return print_no_memory();
    }
    list->items = items;
    list->items[list->count++] = word;
    return CONTINUE;
}

/* A word behind all operands: a part of a vector, or a file of poses without its option. */
static int print_unexpected(const struct arguments *arguments, const char *word)
{
    const struct found poses = find_name(arguments->command, NULL, "poses", 5);
    const struct found pose = find_name(arguments->command, NULL, "pose", 4);
    const struct found *found = poses.option ? &poses : &pose;
    if (strchr(word, ',') || strspn(word, "+-.0123456789") == strlen(word)) {
        return print_usage_error("unexpected argument \"%s\"; a vector is one word: X,Y,Z without spaces", word);
    }
    if (found->option && !arguments->given[found->ordinal]) {
        return print_usage_error("unexpected argument \"%s\"; a file of poses is given as --%s %s", word,
                                 found->option->name, word);
    }
    return print_usage_error("unexpected argument \"%s\"", word);
}

static int take_operand(struct cursor *cursor, const char *word)
{
    struct arguments *arguments = cursor->arguments;
    const struct command *command = arguments->command;
    bool all = arguments->operand_count == OPERAND_LIMIT || !command->operands[arguments->operand_count];
    if (command->repeats && arguments->operand_count && all) {
        return *word ? take_another(&arguments->more, word)
                     : print_usage_error("%s is empty", command->operands[arguments->operand_count - 1]);
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

static int answer_help(const struct arguments *arguments)
{
    if (option_given(arguments, "help")) {
        (arguments->is_brief ? help_brief : help_command)(stdout, arguments->command);
        return EXIT_DONE;
    }
    if (option_given(arguments, "version")) {
        printf("conus %s\n", conus_version());
        return EXIT_DONE;
    }
    return CONTINUE;
}

/* All operands and all options that must be given. */
static int check_complete(const struct arguments *arguments)
{
    const struct command *command = arguments->command;
    struct found found;
    if (arguments->operand_count < OPERAND_LIMIT && command->operands[arguments->operand_count] && !command->optional) {
        return print_usage_error("%s is missing; conus %s --help shows how",
                                 command->operands[arguments->operand_count], command->name);
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

static bool exclude(const struct arguments *arguments, const char *a, const char *b)
{
    if (option_find(arguments->command, a) && option_given(arguments, a) && option_find(arguments->command, b) &&
        option_given(arguments, b)) {
        print_error_line("--%s and --%s exclude each other", a, b);
        return false;
    }
    return true;
}

static bool check_excludes(const struct arguments *arguments, const struct option *option)
{
    char name[OPTION_LIMIT];
    for (const char *at = option->excludes; at && *at; at += *at == ',') {
        size_t length = strcspn(at, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, at);
        at += length;
        if (!exclude(arguments, option->name, name)) {
            return false;
        }
    }
    return (!(option->flags & (OPTION_OF_CONE | OPTION_OF_RAYS)) || exclude(arguments, "point", option->name)) &&
           (!(option->flags & OPTION_OF_ONE_ATLAS) || exclude(arguments, "atlas", option->name));
}

static bool check_ending(const struct arguments *arguments, const struct option *option)
{
    const char *path = option->endings ? option_text(arguments, option->name) : NULL;
    char first[16];
    if (!path) {
        return true;
    }
    size_t size = strcspn(option->endings, " ");
    const char *other = option->endings[size] ? option->endings + size + 1 : NULL;
    snprintf(first, sizeof first, "%.*s", (int)size, option->endings);
    if (path_ends(path, first) || (other && path_ends(path, other))) {
        return true;
    }
    if (other) {
        print_error_line("--%s: \"%s\" ends neither in %s nor in %s", option->name, path, first, other);
    } else {
        print_error_line("--%s: \"%s\" does not end in %s", option->name, path, first);
    }
    return false;
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

int options_parse(struct arguments *out, void *settings, const struct command *command, int count, char **words,
                  int first)
{
    assert(!found_at(command, NULL, OPTION_LIMIT).option);
    *out = (struct arguments){.command = command, .count = count, .words = words};
    struct cursor cursor = {.arguments = out, .settings = settings, .next = first};
    while (cursor.next < count) {
        int code = take_word(&cursor, words[cursor.next++]);
        if (code != CONTINUE || (code = answer_help(out)) != CONTINUE) {
            return code;
        }
    }
    int code = check_complete(out);
    return code == CONTINUE ? check_relations(out) : code;
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
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) {
        return NULL;
    }
    fputs(arguments->command->program ? arguments->command->program : "conus", out);
    for (int i = 1; i < arguments->count; i++) {
        fputc(' ', out);
        put_word(out, arguments->words[i]);
    }
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}

static const char digits[] = "0123456789";

/* Sign, digits with at most one point among them, exponent: the form that strtod() reads the same in every program,
 * and none of "nan", "inf", "0x1p3" and " 1" that it would take as well. */
static bool is_decimal(const char *text)
{
    text += *text == '-' || *text == '+';
    size_t whole = strspn(text, digits);
    text += whole;
    size_t fraction = 0;
    if (*text == '.') {
        fraction = strspn(++text, digits);
        text += fraction;
    }
    if (whole + fraction == 0) {
        return false;
    }
    if (*text == 'e' || *text == 'E') {
        text++;
        text += *text == '-' || *text == '+';
        size_t exponent = strspn(text, digits);
        return exponent > 0 && text[exponent] == '\0';
    }
    return *text == '\0';
}

bool number_parse(const char *text, double *out)
{
    if (!is_decimal(text)) {
        return false;
    }
    double number = strtod(text, NULL); /* the program never leaves the C locale */
    if (!isfinite(number)) {
        return false;
    }
    *out = number;
    return true;
}

bool count_parse(const char *text, uint64_t limit, uint64_t *out)
{
    size_t length = strspn(text, digits);
    if (length == 0 || text[length]) {
        return false;
    }
    errno = 0;
    unsigned long long number = strtoull(text, NULL, 10);
    if (errno || number > limit) {
        return false;
    }
    *out = number;
    return true;
}

static bool outside(const struct option *option, double number)
{
    if (option->low == 0 && option->high == 0) {
        return false;
    }
    return (number < option->low || (number == option->low && (option->open || option->open_below))) ||
           (number > option->high || (number == option->high && option->open));
}

static bool refuse_value(const struct option *option, const char *text, const char *wanted)
{
    print_error_line("--%s: \"%s\" is not %s", option->name, text, wanted);
    return false;
}

static bool refuse_range(const struct option *option, const char *text)
{
    const char *form = option->open         ? "--%s: %s is out of range, allowed is more than %.10g and less than %.10g"
                       : option->open_below ? "--%s: %s is out of range, allowed is more than %.10g to %.10g"
                                            : "--%s: %s is out of range, allowed is %.10g to %.10g";
    print_error_line(form, option->name, text, option->low, option->high);
    return false;
}

static bool read_number(const struct option *option, double *field, const char *text)
{
    if (!number_parse(text, field)) {
        return refuse_value(option, text, "a number");
    }
    return !outside(option, *field) || refuse_range(option, text);
}

static bool read_count(const struct option *option, uint32_t *field, const char *text)
{
    uint64_t number;
    if (!count_parse(text, UINT64_MAX, &number)) {
        return refuse_value(option, text, "a whole number");
    }
    if (number > UINT32_MAX || outside(option, (double)number)) {
        return refuse_range(option, text);
    }
    *field = (uint32_t)number;
    return true;
}

enum { NUMBERS_SIZE = 256 };

/* Copies the text and cuts the copy at `separator`; false unless that gives exactly `count` parts. */
static bool split(char copy[NUMBERS_SIZE], const char *text, char separator, const char **parts, size_t count)
{
    if (snprintf(copy, NUMBERS_SIZE, "%s", text) >= NUMBERS_SIZE) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        parts[i] = copy;
        copy = strchr(copy, separator);
        if (!copy) {
            return i + 1 == count;
        }
        *copy++ = '\0';
    }
    return false;
}

static bool read_numbers(const struct option *option, double *field, size_t count, const char *text, const char *wanted)
{
    char copy[NUMBERS_SIZE];
    const char *parts[4];
    if (!split(copy, text, ',', parts, count)) {
        return refuse_value(option, text, wanted);
    }
    for (size_t i = 0; i < count; i++) {
        if (!number_parse(parts[i], &field[i])) {
            return refuse_value(option, text, wanted);
        }
        if (outside(option, field[i])) {
            return refuse_range(option, text);
        }
    }
    return true;
}

static bool read_range(const struct option *option, double field[2], const char *text)
{
    if (!read_numbers(option, field, 2, text, "two numbers LOW,HIGH without spaces")) {
        return false;
    }
    return field[0] < field[1] || refuse_value(option, text, "two numbers, the lower one first");
}

static bool read_edges(const struct option *option, double field[4], const char *text)
{
    if (!read_numbers(option, field, 4, text, "four numbers LEFT,RIGHT,LOWER,UPPER without spaces")) {
        return false;
    }
    return (field[0] < field[1] && field[2] < field[3]) ||
           refuse_value(option, text, "left before right and lower before upper");
}

static bool read_size(const struct option *option, uint32_t field[2], const char *text)
{
    char copy[NUMBERS_SIZE];
    const char *parts[2];
    if (!split(copy, text, 'x', parts, 2)) {
        return refuse_value(option, text, "a size WxH");
    }
    for (size_t i = 0; i < 2; i++) {
        uint64_t number;
        if (!count_parse(parts[i], UINT32_MAX, &number)) {
            return refuse_value(option, text, "a size WxH");
        }
        if (outside(option, (double)number)) {
            return refuse_range(option, text);
        }
        field[i] = (uint32_t)number;
    }
    return true;
}

static bool read_bytes(const struct option *option, uint64_t *field, const char *text)
{
    static const char units[] = "KMGT";
    static const char wanted[] = "a number of bytes above 0, like 512M or 2G";
    char copy[NUMBERS_SIZE];
    size_t length = strlen(text);
    if (length == 0 || length >= sizeof copy) {
        return refuse_value(option, text, wanted);
    }
    memcpy(copy, text, length + 1);
    const char *unit = strchr(units, copy[length - 1]);
    unsigned shift = unit ? 10 * (unsigned)(unit - units + 1) : 0;
    if (unit) {
        copy[length - 1] = '\0';
    }
    uint64_t number;
    if (!count_parse(copy, UINT64_MAX >> shift, &number) || number == 0) {
        return refuse_value(option, text, wanted);
    }
    *field = number << shift;
    return true;
}

const char *option_choice(const struct option *option, size_t index)
{
    return option->choices ? option->choices[index] : option->choice_at(index);
}

static const char *choice_of(const void *option, size_t index)
{
    return option_choice(option, index);
}

static bool refuse_choice(const struct option *option, const char *text)
{
    const char *near = closest_name(text, choice_of, option);
    if (near) {
        print_error_line("--%s: \"%s\" is none of its choices; did you mean %s?", option->name, text, near);
        return false;
    }
    char list[NUMBERS_SIZE] = "";
    const char *choice;
    for (size_t i = 0; (choice = option_choice(option, i)); i++) {
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", choice);
    }
    print_error_line("--%s: \"%s\" is none of its choices: %s", option->name, text, list);
    return false;
}

static bool read_choice(const struct option *option, size_t *field, const char *text)
{
    const char *choice;
    for (size_t i = 0; (choice = option_choice(option, i)); i++) {
        if (strcasecmp(choice, text) == 0) {
            *field = i;
            return true;
        }
    }
    return refuse_choice(option, text);
}

static bool read_text(const struct option *option, const char **field, const char *text)
{
    *field = text;
    return *text || refuse_value(option, text, option->value);
}

static bool read_item(const struct option *option, struct option_list *field, const char *text)
{
    const char **items = realloc(field->items, (field->count + 1) * sizeof *items);
    if (!items) {
        print_error_line("--%s: not enough memory", option->name);
        return false;
    }
    field->items = items;
    return read_text(option, &items[field->count++], text);
}

bool option_read(const struct option *option, void *field, const char *text)
{
    switch (option->type) {
    case OPTION_FLAG:
        *(bool *)field = true;
        return true;
    case OPTION_NUMBER:
        return read_number(option, field, text);
    case OPTION_COUNT:
        return read_count(option, field, text);
    case OPTION_VECTOR:
        return read_numbers(option, field, 3, text, "three numbers X,Y,Z without spaces");
    case OPTION_RANGE:
        return read_range(option, field, text);
    case OPTION_EDGES:
        return read_edges(option, field, text);
    case OPTION_SIZE:
        return read_size(option, field, text);
    case OPTION_BYTES:
        return read_bytes(option, field, text);
    case OPTION_CHOICE:
        return read_choice(option, field, text);
    case OPTION_TEXT:
        return read_text(option, field, text);
    case OPTION_LIST:
        return read_item(option, field, text);
    }
    return false;
}

bool key_left_in_file(const char *option, const char *file, const char *const *keys)
{
    const char *key = NULL;
    for (; *keys && !key; keys++) {
        key = strstr(file, *keys);
    }
    if (key) {
        print_error_line("%s: \"%s\" has a comma in it; a number has a decimal point, and a name no comma", option,
                         key + 1);
    }
    return key;
}
