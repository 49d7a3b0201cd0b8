/* SPDX-License-Identifier: BSD-3-Clause */
/* Completions for fish. */
#include "pages/completion.h"

#include "options/options.h"

#define ATLASES "(conus atlases --quiet --format names 2>/dev/null)"

/* In fish's single quotes a backslash escapes. */
static void put_quoted(FILE *out, const char *text)
{
    completion_quote(out, text, "\\");
}

/* Begins a line that counts where `command` is the program's first word; NULL = everywhere. */
static void put_start(FILE *out, const struct program *program, const char *command)
{
    fprintf(out, "complete -c %s", program->name);
    if (command) {
        fprintf(out, " -n 'contains -- %s (commandline -opc)[2]'", command);
    }
}

static void put_option(FILE *out, const struct option *option)
{
    fprintf(out, " -l %s", option->name);
    if (option->letter) {
        fprintf(out, " -s %c", option->letter);
    }
    const char *choice;
    switch (completion_value(option)) {
    case COMPLETION_NONE:
        break;
    case COMPLETION_CHOICES:
        fputs(" -xa '", out);
        for (size_t i = 0; (choice = option_choice(option, i)); i++) {
            fprintf(out, "%s%s", i ? " " : "", choice);
        }
        fputs("'", out);
        break;
    case COMPLETION_FILE:
        fputs(" -rF", out);
        break;
    case COMPLETION_ATLAS:
        fputs(" -rF -a '" ATLASES "'", out);
        break;
    case COMPLETION_FOLDER:
        fputs(" -xa '(__fish_complete_directories)'", out);
        break;
    case COMPLETION_ANY:
        fputs(" -x", out);
        break;
    }
    fputs(" -d ", out);
    put_quoted(out, option->help);
    fputc('\n', out);
}

static void put_options(FILE *out, const struct program *program, const struct command *command)
{
    const struct option *option;
    if (completion_takes_atlas(command)) {
        put_start(out, program, program->unnamed ? NULL : command->name);
        fputs(" -a '" ATLASES "' -d 'installed atlas'\n", out);
    }
    for (size_t i = 0; (option = completion_option(command, i)); i++) {
        put_start(out, program, program->unnamed ? NULL : command->name);
        put_option(out, option);
    }
}

/* Writes the commands as first words, and as words of help. */
static void put_command_names(FILE *out, const struct program *program)
{
    static const char first[] = "test (count (commandline -opc)) -eq 1";
    for (size_t i = 0; program->commands[i]; i++) {
        const struct command *command = program->commands[i];
        fprintf(out, "complete -c %s -f -n '%s' -a %s -d ", program->name, first, command->name);
        put_quoted(out, command->summary);
        fputc('\n', out);
        if (program->commands[1]) {
            put_start(out, program, "help");
            fprintf(out, " -f -a %s\n", command->name);
        }
    }
    bool several = program->commands[1] != NULL;
    if (several) {
        fprintf(out, "complete -c %s -f -n '%s' -a help -d 'explain a command'\n", program->name, first);
    }
    fprintf(out, "complete -c %s -n '%s' -l help -d '%s'\n", program->name, first,
            several ? "list the commands" : "explain the command");
    fprintf(out, "complete -c %s -n '%s' -l version -d 'the version'\n", program->name, first);
}

void completion_fish(FILE *out, const struct program *program)
{
    fprintf(out, "# Completion of %s for fish, written by the program from its table of options.\n", program->name);
    if (!program->unnamed) {
        put_command_names(out, program);
    }
    for (size_t i = 0; program->commands[i]; i++) {
        const struct command *command = program->commands[i];
        if (command->hand_over) {
            put_start(out, program, command->name);
            fprintf(out, " -a '(complete -C \"%s-%s \"(commandline -ct))'\n", program->name, command->name);
        } else {
            put_options(out, program, command);
        }
    }
}
