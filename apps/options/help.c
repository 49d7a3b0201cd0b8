/* SPDX-License-Identifier: BSD-3-Clause */
/* The text of --help, from a command's table of options. */
#include "options/options.h"

#include "options/messages.h"

#include <assert.h>
#include <string.h>

enum { HELP_COLUMN = 30, HELP_WIDTH = 100, BRIEF_EXAMPLES = 2 };

void help_usage(FILE *out, const struct command *command)
{
    fprintf(out, "%s %s", command->program ? command->program : "conus", command->name);
    bool may_be_missing = command->optional && !command->form; /* a form is that with all operands */
    for (size_t i = 0; i < OPERAND_LIMIT && command->operands[i]; i++) {
        bool is_last = i + 1 == OPERAND_LIMIT || !command->operands[i + 1];
        bool repeats = command->repeats && is_last;
        fprintf(out, may_be_missing || (command->optional_last && is_last) ? " [%s%s]" : " %s%s", command->operands[i],
                repeats ? "..." : "");
    }
    fprintf(out, "%s%s [options]", command->form ? " " : "", command->form ? command->form : "");
}

const char *help_exit_code(size_t code)
{
    static const char *const meanings[] = {
        [EXIT_DONE] = "done",
        [EXIT_DIFFERENT] = "some queries failed or a difference was found",
        [EXIT_USAGE] = "usage",
        [EXIT_DATA] = "bad input data",
        [EXIT_NO_GL] = "no usable OpenGL",
    };
    return code < sizeof meanings / sizeof *meanings ? meanings[code] : NULL;
}

/* Writes words from HELP_COLUMN on, wrapped so that every line begins there. */
static void put_wrapped(FILE *out, const char *text)
{
    for (size_t column = HELP_COLUMN; *text;) {
        size_t length = strcspn(text, " ");
        if (column > HELP_COLUMN && column + 1 + length > HELP_WIDTH) {
            fprintf(out, "\n%*s", HELP_COLUMN, "");
            column = HELP_COLUMN;
        } else if (column > HELP_COLUMN) {
            fputc(' ', out);
            column++;
        }
        fwrite(text, 1, length, out);
        column += length;
        text += length + strspn(text + length, " ");
    }
}

/* Writes its name, and spaces up to HELP_COLUMN, on a line of its own where it is long. */
static void put_name(FILE *out, const struct option *option)
{
    char head[64];
    char letter[8] = "    ";
    if (option->letter) {
        snprintf(letter, sizeof letter, "-%c, ", option->letter);
    }
    snprintf(head, sizeof head, "  %s--%s%s%s", letter, option->name, option->value ? " " : "",
             option->value ? option->value : "");
    fputs(head, out);
    size_t column = strlen(head);
    if (column + 2 > HELP_COLUMN) {
        fputc('\n', out);
        column = 0;
    }
    fprintf(out, "%*s", (int)(HELP_COLUMN - column), "");
}

void option_describe(char out[OPTION_HELP], const struct option *option, bool choices)
{
    const char *standard = option->type == OPTION_CHOICE ? NULL : option_standard(option);
    const char *choice;
    int used = snprintf(out, OPTION_HELP, "%s", option->help);
    for (size_t i = 0; choices && option->type == OPTION_CHOICE && (choice = option_choice(option, i)); i++) {
        used += snprintf(out + used, OPTION_HELP - (size_t)used, "%s%s%s", i ? ", " : " ", choice,
                         i || option->otherwise ? "" : " (default)");
    }
    if (standard || option->otherwise) {
        used += snprintf(out + used, OPTION_HELP - (size_t)used, " (default%s %s)", standard ? "" : ":",
                         standard ? standard : option->otherwise);
    }
    if (choices && option->words) {
        used += snprintf(out + used, OPTION_HELP - (size_t)used, " (also: %s)", option->words);
    }
    assert(used < OPTION_HELP);
}

static void put_option(FILE *out, const struct option *option)
{
    char text[OPTION_HELP];
    option_describe(text, option, true);
    put_name(out, option);
    put_wrapped(out, text);
    fputc('\n', out);
}

/* How many bytes of the help say enough on one line: all, or the last clause that fits, or else what is before the last
 * comma that does; outside of brackets. */
static size_t brief_size(const char *help)
{
    const size_t width = HELP_WIDTH - HELP_COLUMN;
    size_t clause = 0;
    size_t comma = 0;
    bool outside = true;
    for (size_t i = 0; i <= width; i++) {
        if (!help[i]) {
            return i && help[i - 1] == ':' ? i - 1 : i; /* choices would follow */
        }
        clause = outside && (help[i] == ';' || help[i] == ':' || strncmp(help + i, " (", 2) == 0) ? i : clause;
        comma = outside && strncmp(help + i, ", ", 2) == 0 ? i : comma;
        outside = help[i] == '(' ? false : help[i] == ')' ? true : outside;
    }
    return clause ? clause : comma;
}

void help_brief(FILE *out, const struct command *command)
{
    fprintf(out, "%c%s\n\nusage: ", command->summary[0] - 'a' + 'A', command->summary + 1);
    help_usage(out, command);
    fputs("\n\n", out);
    for (const struct option_group *group = command->groups; group->title; group++) {
        for (const struct option *option = group->options; option->name; option++) {
            if (option->common) {
                char text[OPTION_HELP];
                option_describe(text, option, false);
                put_name(out, option);
                fprintf(out, "%.*s\n", (int)brief_size(text), text);
            }
        }
    }
    const char *end = command->examples;
    for (size_t i = 0; i < BRIEF_EXAMPLES && *end; i++) {
        end += strcspn(end, "\n") + 1;
    }
    fprintf(out, "\nExamples\n%.*s\n", (int)(end - command->examples), command->examples);
    fprintf(out, "%s %s --help has all options.\n", command->program ? command->program : "conus", command->name);
}

void help_command(FILE *out, const struct command *command)
{
    fputs("usage: ", out);
    help_usage(out, command);
    fprintf(out, "\n\n%s\n\nExamples\n%s", command->description, command->examples);
    for (const struct option_group *group = command->groups; group->title; group++) {
        if (*group->title) {
            fprintf(out, "\n%s\n", group->title);
        }
        for (const struct option *option = group->options; option->name; option++) {
            put_option(out, option);
        }
    }
    if (command->more_help) {
        fputc('\n', out);
        command->more_help(out);
    }
    if (command->see_also) {
        fprintf(out, "\nSee also\n%s", command->see_also);
    }
}
