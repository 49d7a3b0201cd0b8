/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes man pages from tables of options. */
#include "pages/pages.h"

#include "base/system/system.h"
#include "options/options.h"

#include "conus/version.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* The escape of a character that roff gives a meaning or typesets as another one; NULL = it needs none. */
static const char *escape_of(char c)
{
    switch (c) {
    case '\\':
        return "\\e";
    case '-':
        return "\\-";
    case '"':
        return "\\(dq";
    case '^':
        return "\\(ha";
    case '~':
        return "\\(ti";
    default:
        return NULL;
    }
}

/* Writes text as it is, also where a line starts with a control character. */
static void put_roff(FILE *out, const char *text, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        const char *escape = escape_of(text[i]);
        if (strchr(".'", text[i]) && (i == 0 || text[i - 1] == '\n')) {
            fputs("\\&", out);
        }
        fputs(escape ? escape : (char[]){text[i], '\0'}, out);
    }
}

static void put_text(FILE *out, const char *text)
{
    put_roff(out, text, strlen(text));
}

/* Writes text whose empty lines part paragraphs. */
static void put_paragraphs(FILE *out, const char *text)
{
    for (const char *end; (end = strstr(text, "\n\n")); text = end + 2) {
        put_roff(out, text, (size_t)(end - text));
        fputs("\n.PP\n", out);
    }
    put_text(out, text);
    fputc('\n', out);
}

/* Writes text whose lines stay as they are. */
static void put_lines(FILE *out, const char *text)
{
    fputs(".nf\n", out);
    for (size_t length; *text; text += length) {
        length = strcspn(text, "\n") + 1;
        if (length == 1) {
            fputs(".sp\n", out);
        } else {
            put_roff(out, text, length);
        }
    }
    fputs(".fi\n", out);
}

/* Opens the page `name` with its title and one-line description. */
static void put_head(FILE *out, const char *name, const char *summary)
{
    fputs(".\\\" Written by a program from its table of options.\n.TH \"", out);
    for (const char *c = name; *c; c++) {
        fputc((toupper)((unsigned char)*c), out); /* the function: the macro hides what it does */
    }
    fprintf(out, "\" \"1\" \"\" \"conus %s\" \"User Commands\"\n.SH NAME\n", conus_version());
    put_text(out, name);
    fputs(" \\- ", out);
    put_text(out, summary);
    fputc('\n', out);
}

/* The text of a part of the help, to be freed; NULL without memory. */
static char *text_of(void (*write_help)(FILE *out, const struct command *command), const struct command *command)
{
    struct system_text words;
    if (system_text_open(&words)) {
        write_help(words.stream, command);
    }
    return system_text_close(&words);
}

static bool put_synopsis(FILE *out, const struct program *program, const struct command *command)
{
    char *usage = text_of(help_usage, command);
    if (!usage) {
        return false;
    }
    fputs(".SH SYNOPSIS\n", out);
    put_text(out, usage);
    if (program->unnamed) {
        fputs("\n.br\n", out);
        put_text(out, program->name);
        put_text(out, strchr(strchr(usage, ' ') + 1, ' '));
    }
    fputc('\n', out);
    free(usage);
    return true;
}

static void put_option(FILE *out, const struct option *option)
{
    fputs(".TP\n", out);
    if (option->letter) {
        fprintf(out, "\\fB\\-%c\\fR, ", option->letter);
    }
    fputs("\\fB\\-\\-", out);
    put_text(out, option->name);
    fputs("\\fR", out);
    if (option->value) {
        fputs(" \\fI", out);
        put_text(out, option->value);
        fputs("\\fR", out);
    }
    fputc('\n', out);
    char text[OPTION_HELP];
    option_describe(text, option, true);
    put_text(out, text);
    fputc('\n', out);
}

static void put_options(FILE *out, const struct command *command)
{
    fputs(".SH OPTIONS\n", out);
    for (const struct option_group *group = command->groups; group->title; group++) {
        if (*group->title && strcmp(group->title, "Options") != 0) {
            fputs(".SS \"", out);
            put_text(out, group->title);
            fputs("\"\n", out);
        }
        for (const struct option *option = group->options; option->name; option++) {
            put_option(out, option);
        }
    }
}

static void write_more_help(FILE *out, const struct command *command)
{
    command->more_help(out);
}

static bool put_notes(FILE *out, const struct command *command)
{
    if (!command->more_help) {
        return true;
    }
    char *notes = text_of(write_more_help, command);
    if (!notes) {
        return false;
    }
    fputs(".SH NOTES\n", out);
    put_lines(out, notes);
    free(notes);
    return true;
}

static void put_exit_status(FILE *out)
{
    fputs(".SH EXIT STATUS\n", out);
    const char *meaning;
    for (size_t code = 0; (meaning = help_exit_code(code)); code++) {
        fprintf(out, ".TP\n%zu\n%s\n", code, meaning);
    }
}

bool man_page_command(FILE *out, const struct program *program, const struct command *command)
{
    char name[64];
    bool part = program->commands[1] != NULL;
    snprintf(name, sizeof name, "%s%s%s", program->name, part ? "-" : "", part ? command->name : "");
    put_head(out, name, command->summary);
    bool complete = put_synopsis(out, program, command);
    fputs(".SH DESCRIPTION\n", out);
    put_paragraphs(out, command->description);
    put_options(out, command);
    complete = put_notes(out, command) && complete;
    put_exit_status(out);
    fputs(".SH EXAMPLES\n", out);
    put_lines(out, command->examples);
    fputs(".SH SEE ALSO\n.BR conus (1)\n", out);
    return complete;
}

void man_page_program(FILE *out, const struct program *program)
{
    put_head(out, program->name, program->summary);
    fputs(".SH SYNOPSIS\n", out);
    put_text(out, program->name);
    fputs(" COMMAND [arguments]\n.br\n", out);
    put_text(out, program->name);
    fputs(" help COMMAND\n.br\n", out);
    put_text(out, program->name);
    fputs(" \\-\\-version\n.SH DESCRIPTION\n", out);
    put_paragraphs(out, program->description);
    fputs(".SH COMMANDS\n", out);
    for (size_t i = 0; program->commands[i]; i++) {
        fprintf(out, ".TP\n.BR %s\\-%s (1)\n", program->name, program->commands[i]->name);
        put_text(out, program->commands[i]->summary);
        fputc('\n', out);
    }
    put_exit_status(out);
}
