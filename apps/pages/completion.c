/* SPDX-License-Identifier: BSD-3-Clause */
/* Completions of options, commands and atlases for bash, fish and zsh. */
#include "pages/pages.h"

#include "options/options.h"

#include <stdbool.h>
#include <string.h>

/* The words that the shell offers for the value of an option. */
enum value {
    VALUE_NONE,    /* the option has no value */
    VALUE_CHOICES, /* option_choice() lists them */
    VALUE_FILE,
    VALUE_FOLDER,
    VALUE_ATLAS, /* a file, or a name that `conus atlases --format names` lists */
    VALUE_ANY,   /* a value that only the user knows: a number, a name */
};

static enum value value_of(const struct option *option)
{
    if (option->type == OPTION_CHOICE) {
        return VALUE_CHOICES;
    }
    if (!option->value) {
        return VALUE_NONE;
    }
    return strstr(option->value, "FILE")    ? VALUE_FILE
           : strstr(option->value, "DIR")   ? VALUE_FOLDER
           : strstr(option->value, "ATLAS") ? VALUE_ATLAS
                                            : VALUE_ANY;
}

static bool takes_atlas(const struct command *command)
{
    return command->operands[0] && strcmp(command->operands[0], "ATLAS") == 0;
}

/* Writes `text` within single quotes of sh, with a backslash before each character of `special`. */
static void put_quoted(FILE *out, const char *text, const char *special)
{
    fputc('\'', out);
    for (; *text; text++) {
        if (strchr(special, *text)) {
            fputc('\\', out);
        }
        fputs(*text == '\'' ? "'\\''" : (char[]){*text, '\0'}, out);
    }
    fputc('\'', out);
}

static void put_choices(FILE *out, const struct option *option)
{
    const char *choice;
    for (size_t i = 0; (choice = option_choice(option, i)); i++) {
        fprintf(out, "%s%s", i ? " " : "", choice);
    }
}

enum { BASH_NAME = 64 };

/* "_conus_view" of "conus-view" */
static void bash_name_function(char out[BASH_NAME], const char *program)
{
    snprintf(out, BASH_NAME, "_%s", program);
    for (char *dash; (dash = strchr(out, '-'));) {
        *dash = '_';
    }
}

static void bash_put_command_names(FILE *out, const struct program *program)
{
    for (size_t i = 0; program->commands[i]; i++) {
        fprintf(out, "%s ", program->commands[i]->name);
    }
}

static void bash_put_value_cases(FILE *out, const struct command *command)
{
    static const char *const words[] = {[VALUE_CHOICES] = "value=word words='",
                                        [VALUE_FILE] = "value=file",
                                        [VALUE_FOLDER] = "value=folder",
                                        [VALUE_ATLAS] = "value=atlas",
                                        [VALUE_ANY] = "value=any"};
    const struct option *option;
    for (size_t i = 0; (option = option_at(command, i)); i++) {
        enum value value = value_of(option);
        if (value == VALUE_NONE) {
            continue;
        }
        fputs("        ", out);
        if (option->letter) {
            fprintf(out, "-%c | ", option->letter);
        }
        fprintf(out, "--%s) %s", option->name, words[value]);
        if (value == VALUE_CHOICES) {
            put_choices(out, option);
            fputc('\'', out);
        }
        fputs(" ;;\n", out);
    }
}

static void bash_put_command(FILE *out, const struct command *command)
{
    const struct option *option;
    fputs("        options='", out);
    for (size_t i = 0; (option = option_at(command, i)); i++) {
        fprintf(out, "%s--%s", i ? " " : "", option->name);
    }
    fprintf(out, "'%s\n        case $before in\n", takes_atlas(command) ? " atlas=yes" : "");
    bash_put_value_cases(out, command);
    fputs("        esac\n", out);
}

/* Lets the completion of another program answer, whose words begin one later. */
static void bash_put_handed_over(FILE *out, const struct program *program, const struct command *command)
{
    char name[BASH_NAME - 1];
    char function[BASH_NAME];
    snprintf(name, sizeof name, "%s-%s", program->name, command->name);
    bash_name_function(function, name);
    fprintf(out,
            "        declare -F %s >/dev/null || ! declare -F _completion_loader >/dev/null || _completion_loader %s\n"
            "        COMP_WORDS=(%s \"${COMP_WORDS[@]:2}\")\n"
            "        COMP_CWORD=$((COMP_CWORD - 1))\n"
            "        ! declare -F %s >/dev/null || %s\n"
            "        return ;;\n",
            function, name, name, function, function);
}

static void bash_put_commands(FILE *out, const struct program *program)
{
    fputs("    if [ \"$COMP_CWORD\" -eq 1 ]; then\n        mapfile -t COMPREPLY < <(compgen -W '", out);
    bash_put_command_names(out, program);
    fprintf(out, "%s--help --version' -- \"$word\")\n        return\n    fi\n    case ${COMP_WORDS[1]} in\n",
            program->commands[1] ? "help " : "");
    if (program->commands[1]) {
        fputs("    help)\n        value=word words='", out);
        bash_put_command_names(out, program);
        fputs("' ;;\n", out);
    }
    for (size_t i = 0; program->commands[i]; i++) {
        fprintf(out, "    %s)\n", program->commands[i]->name);
        if (program->commands[i]->hand_over) {
            bash_put_handed_over(out, program, program->commands[i]);
        } else {
            bash_put_command(out, program->commands[i]);
            fputs("        ;;\n", out);
        }
    }
    fputs("    esac\n", out);
}

void completion_bash(FILE *out, const struct program *program)
{
    char function[BASH_NAME];
    bash_name_function(function, program->name);
    fprintf(out, "# Completion of %s for bash, written by the program from its table of options.\n%s()\n{\n",
            program->name, function);
    fputs("    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} options= value= words=\n"
          "    local atlas= name\n"
          "    COMPREPLY=()\n"
          "    if [ \"$word\" = = ]; then # --option=value is three words\n"
          "        word=\n"
          "    elif [ \"$before\" = = ]; then\n"
          "        before=${COMP_WORDS[COMP_CWORD - 2]}\n"
          "    fi\n",
          out);
    if (program->unnamed) {
        bash_put_command(out, program->commands[0]);
    } else {
        bash_put_commands(out, program);
    }
    fputs("    case ${value:-none}:$word in\n"
          "    any:*) ;;\n"
          "    word:*) mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\") ;;\n"
          "    folder:*) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -d -- \"$word\") ;;\n"
          "    none:-*) mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$word\") ;;\n"
          "    *) compopt -o filenames 2>/dev/null; mapfile -t COMPREPLY < <(compgen -f -- \"$word\") ;;\n"
          "    esac\n"
          "    [ \"$atlas:$value\" = yes: ] || [ \"$value\" = atlas ] || return 0\n"
          "    local source= # \"source:name\" is three words\n"
          "    if [ \"$word\" = : ]; then\n"
          "        source=$before: word=\n"
          "    elif [ \"$before\" = : ]; then\n"
          "        source=${COMP_WORDS[COMP_CWORD - 2]}:\n"
          "    fi\n"
          "    while IFS= read -r name; do # names are never expanded: they come from files\n"
          "        [[ $name != \"$source$word\"* ]] || COMPREPLY+=(\"${name#\"$source\"}\")\n"
          "    done < <(conus atlases --quiet --format names 2>/dev/null)\n"
          "}\n",
          out);
    fprintf(out, "complete -F %s %s\n", function, program->name);
}

#define FISH_ATLASES "(conus atlases --quiet --format names 2>/dev/null)"

/* Characters that fish's single quotes give a meaning. */
static const char fish_special[] = "\\";

/* Begins a line that counts where `command` is the program's first word; NULL = everywhere. */
static void fish_put_start(FILE *out, const struct program *program, const char *command)
{
    fprintf(out, "complete -c %s", program->name);
    if (command) {
        fprintf(out, " -n 'contains -- %s (commandline -opc)[2]'", command);
    }
}

static void fish_put_option(FILE *out, const struct option *option)
{
    fprintf(out, " -l %s", option->name);
    if (option->letter) {
        fprintf(out, " -s %c", option->letter);
    }
    switch (value_of(option)) {
    case VALUE_NONE:
        break;
    case VALUE_CHOICES:
        fputs(" -xa '", out);
        put_choices(out, option);
        fputc('\'', out);
        break;
    case VALUE_FILE:
        fputs(" -rF", out);
        break;
    case VALUE_ATLAS:
        fputs(" -rF -a '" FISH_ATLASES "'", out);
        break;
    case VALUE_FOLDER:
        fputs(" -xa '(__fish_complete_directories)'", out);
        break;
    case VALUE_ANY:
        fputs(" -x", out);
        break;
    }
    char text[OPTION_HELP];
    option_describe(text, option, false);
    fputs(" -d ", out);
    put_quoted(out, text, fish_special);
    fputc('\n', out);
}

static void fish_put_options(FILE *out, const struct program *program, const struct command *command)
{
    const struct option *option;
    if (takes_atlas(command)) {
        fish_put_start(out, program, program->unnamed ? NULL : command->name);
        fputs(" -a '" FISH_ATLASES "' -d 'installed atlas'\n", out);
    }
    for (size_t i = 0; (option = option_at(command, i)); i++) {
        fish_put_start(out, program, program->unnamed ? NULL : command->name);
        fish_put_option(out, option);
    }
}

/* Writes the commands as first words, and as words of help. */
static void fish_put_command_names(FILE *out, const struct program *program)
{
    static const char first[] = "test (count (commandline -opc)) -eq 1";
    for (size_t i = 0; program->commands[i]; i++) {
        const struct command *command = program->commands[i];
        fprintf(out, "complete -c %s -f -n '%s' -a %s -d ", program->name, first, command->name);
        put_quoted(out, command->summary, fish_special);
        fputc('\n', out);
        if (program->commands[1]) {
            fish_put_start(out, program, "help");
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
        fish_put_command_names(out, program);
    }
    for (size_t i = 0; program->commands[i]; i++) {
        const struct command *command = program->commands[i];
        if (command->hand_over) {
            fish_put_start(out, program, command->name);
            fprintf(out, " -a '(complete -C \"%s-%s \"(commandline -ct))'\n", program->name, command->name);
        } else {
            fish_put_options(out, program, command);
        }
    }
}

#define ZSH_ATLASES "{_files; compadd -- ${(f)\"$(conus atlases --quiet --format names 2>/dev/null)\"}}"

/* Characters that _arguments and _describe give a meaning. */
static const char zsh_special[] = "[]:\\";

static void zsh_put_values(FILE *out, const struct option *option)
{
    static const char *const actions[] = {
        [VALUE_FILE] = "_files", [VALUE_FOLDER] = "_files -/", [VALUE_ATLAS] = ZSH_ATLASES, [VALUE_ANY] = " "};
    enum value value = value_of(option);
    if (!option->value) {
        return;
    }
    put_quoted(out, option->value, zsh_special);
    fputs("':'", out);
    if (value != VALUE_CHOICES) {
        fprintf(out, "'%s'", actions[value]);
        return;
    }
    fputs("'(", out);
    put_choices(out, option);
    fputs(")'", out);
}

/* Writes one form of an option, "-o" or "--output", as a word of _arguments. */
static void zsh_put_form(FILE *out, const struct option *option, const char *form)
{
    char text[OPTION_HELP];
    option_describe(text, option, false);
    fputs(" \\\n        ", out);
    if (option->type == OPTION_LIST) {
        fputs("'*'", out);
    } else if (option->letter) {
        fprintf(out, "'(-%c --%s)'", option->letter, option->name);
    }
    fprintf(out, "%s%s'['", form, option->value ? (form[1] == '-' ? "=" : "+") : "");
    put_quoted(out, text, zsh_special);
    fprintf(out, "']%s'", option->value ? ":" : "");
    zsh_put_values(out, option);
}

static void zsh_put_arguments(FILE *out, const struct command *command)
{
    fputs("_arguments -s", out);
    const struct option *option;
    for (size_t i = 0; (option = option_at(command, i)); i++) {
        char form[64];
        if (option->letter) {
            snprintf(form, sizeof form, "-%c", option->letter);
            zsh_put_form(out, option, form);
        }
        snprintf(form, sizeof form, "--%s", option->name);
        zsh_put_form(out, option, form);
    }
    fprintf(out, " \\\n        '*:%s'", takes_atlas(command) ? "atlas:" ZSH_ATLASES : "file:_files");
}

static void zsh_put_commands(FILE *out, const struct program *program)
{
    fputs("local line state\nlocal -a names\nnames=(\n", out);
    for (size_t i = 0; program->commands[i]; i++) {
        fprintf(out, "    %s':'", program->commands[i]->name);
        put_quoted(out, program->commands[i]->summary, zsh_special);
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
            zsh_put_arguments(out, command);
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
        zsh_put_arguments(out, program->commands[0]);
        fputc('\n', out);
    } else {
        zsh_put_commands(out, program);
    }
}
