/* SPDX-License-Identifier: BSD-3-Clause */
/* Completions for zsh. */
#include "pages/completion.h"

#include "options/options.h"

#include <stdbool.h>

#define ATLASES "{_files; compadd -- ${(f)\"$(conus atlases --quiet --format names 2>/dev/null)\"}}"

/* What _arguments and _describe would take for their own. */
static const char special[] = "[]:\\";

static void put_values(FILE *out, const struct option *option)
{
    static const char *const actions[] = {[COMPLETION_FILE] = "_files",
                                          [COMPLETION_FOLDER] = "_files -/",
                                          [COMPLETION_ATLAS] = ATLASES,
                                          [COMPLETION_ANY] = " "};
    enum completion_value value = completion_value(option);
    const char *choice;
    if (value == COMPLETION_NONE) {
        return;
    }
    completion_quote(out, option->value, special);
    fputs("':'", out);
    if (value != COMPLETION_CHOICES) {
        fprintf(out, "'%s'", actions[value]);
        return;
    }
    fputs("'(", out);
    for (size_t i = 0; (choice = option_choice(option, i)); i++) {
        fprintf(out, "%s%s", i ? " " : "", choice);
    }
    fputs(")'", out);
}

/* Writes one form of an option, "-o" or "--output", as a word of _arguments. */
static void put_form(FILE *out, const struct option *option, const char *form)
{
    fputs(" \\\n        ", out);
    if (option->type == OPTION_LIST) {
        fputs("'*'", out);
    } else if (option->letter) {
        fprintf(out, "'(-%c --%s)'", option->letter, option->name);
    }
    fprintf(out, "%s%s'['", form, option->value ? (form[1] == '-' ? "=" : "+") : "");
    completion_quote(out, option->help, special);
    fprintf(out, "']%s'", option->value ? ":" : "");
    put_values(out, option);
}

static void put_arguments(FILE *out, const struct command *command)
{
    fputs("_arguments -s", out);
    const struct option *option;
    for (size_t i = 0; (option = completion_option(command, i)); i++) {
        char form[64];
        if (option->letter) {
            snprintf(form, sizeof form, "-%c", option->letter);
            put_form(out, option, form);
        }
        snprintf(form, sizeof form, "--%s", option->name);
        put_form(out, option, form);
    }
    fprintf(out, " \\\n        '*:%s'", completion_takes_atlas(command) ? "atlas:" ATLASES : "file:_files");
}

static void put_commands(FILE *out, const struct program *program)
{
    fputs("local line state\nlocal -a names\nnames=(\n", out);
    for (size_t i = 0; program->commands[i]; i++) {
        fprintf(out, "    %s':'", program->commands[i]->name);
        completion_quote(out, program->commands[i]->summary, special);
        fputc('\n', out);
    }
    bool several = program->commands[1] != NULL;
    fprintf(out,
            "%s)\n_arguments -C '1: :->command' '*::argument:->rest' '(- *)--help[%s]' '(- *)--version[the version]'\n"
            "case $state in\ncommand) _describe command names ;;\nrest)\n    case $line[1] in\n%s",
            several ? "    help:'explain a command'\n" : "", several ? "list the commands" : "explain the command",
            several ? "    help) _describe command names ;;\n" : "");
    for (size_t i = 0; program->commands[i]; i++) {
        const struct command *command = program->commands[i];
        fprintf(out, "    %s)\n        ", command->name);
        if (command->hand_over) {
            fprintf(out, "(( ! $+functions[_%s-%s] )) || _%s-%s", program->name, command->name, program->name,
                    command->name);
        } else {
            put_arguments(out, command);
        }
        fputs(" ;;\n", out);
    }
    fputs("    esac ;;\nesac\n", out);
}

void completion_zsh(FILE *out, const struct program *program)
{
    fprintf(out, "#compdef %s\n# Completion of %s for zsh, written by the program from its table of options.\n",
            program->name, program->name);
    if (program->unnamed) {
        put_arguments(out, program->commands[0]);
        fputc('\n', out);
    } else {
        put_commands(out, program);
    }
}
