/* SPDX-License-Identifier: BSD-3-Clause */
/* Completions for bash. They need no other package, though bash-completion is what loads them. */
#include "pages/completion.h"

#include "options/options.h"

#include <stdbool.h>

static void put_function_name(FILE *out, const char *program)
{
    fputc('_', out);
    for (; *program; program++) {
        fputc(*program == '-' ? '_' : *program, out);
    }
}

static void put_command_names(FILE *out, const struct program *program)
{
    for (size_t i = 0; program->commands[i]; i++) {
        fprintf(out, "%s ", program->commands[i]->name);
    }
}

static void put_option_names(FILE *out, const struct command *command)
{
    const struct option *option;
    for (size_t i = 0; (option = completion_option(command, i)); i++) {
        fprintf(out, "%s--%s", i ? " " : "", option->name);
    }
}

/* Writes the pattern that matches the option. */
static void put_pattern(FILE *out, const struct option *option)
{
    if (option->letter) {
        fprintf(out, "-%c | ", option->letter);
    }
    fprintf(out, "--%s", option->name);
}

static void put_value_cases(FILE *out, const struct command *command)
{
    static const char *const words[] = {[COMPLETION_FILE] = "value=file",
                                        [COMPLETION_FOLDER] = "value=folder",
                                        [COMPLETION_ATLAS] = "value=atlas",
                                        [COMPLETION_ANY] = "value=any"};
    const struct option *option;
    const char *choice;
    for (size_t i = 0; (option = completion_option(command, i)); i++) {
        enum completion_value value = completion_value(option);
        if (value == COMPLETION_NONE) {
            continue;
        }
        fputs("        ", out);
        put_pattern(out, option);
        fprintf(out, ") %s", value == COMPLETION_CHOICES ? "value=word words='" : words[value]);
        for (size_t n = 0; value == COMPLETION_CHOICES && (choice = option_choice(option, n)); n++) {
            fprintf(out, "%s%s", n ? " " : "", choice);
        }
        fputs(value == COMPLETION_CHOICES ? "' ;;\n" : " ;;\n", out);
    }
}

static void put_command(FILE *out, const struct command *command)
{
    fputs("        options='", out);
    put_option_names(out, command);
    fprintf(out, "'%s\n        case $before in\n", completion_takes_atlas(command) ? " atlas=yes" : "");
    put_value_cases(out, command);
    fputs("        esac\n", out);
}

/* Lets the completion of another program answer, whose words begin one later. */
static void put_handed_over(FILE *out, const struct program *program, const struct command *command)
{
    char name[64];
    snprintf(name, sizeof name, "%s-%s", program->name, command->name);
    fputs("        declare -F ", out);
    put_function_name(out, name);
    fprintf(out,
            " >/dev/null || ! declare -F _completion_loader >/dev/null || _completion_loader %s\n"
            "        COMP_WORDS=(%s \"${COMP_WORDS[@]:2}\")\n"
            "        COMP_CWORD=$((COMP_CWORD - 1))\n"
            "        ! declare -F ",
            name, name);
    put_function_name(out, name);
    fputs(" >/dev/null || ", out);
    put_function_name(out, name);
    fputs("\n        return ;;\n", out);
}

static void put_commands(FILE *out, const struct program *program)
{
    fputs("    if [ \"$COMP_CWORD\" -eq 1 ]; then\n        mapfile -t COMPREPLY < <(compgen -W '", out);
    put_command_names(out, program);
    fprintf(out, "%s--help --version' -- \"$word\")\n        return\n    fi\n    case ${COMP_WORDS[1]} in\n",
            program->commands[1] ? "help " : "");
    if (program->commands[1]) {
        fputs("    help)\n        value=word words='", out);
        put_command_names(out, program);
        fputs("' ;;\n", out);
    }
    for (size_t i = 0; program->commands[i]; i++) {
        fprintf(out, "    %s)\n", program->commands[i]->name);
        if (program->commands[i]->hand_over) {
            put_handed_over(out, program, program->commands[i]);
        } else {
            put_command(out, program->commands[i]);
            fputs("        ;;\n", out);
        }
    }
    fputs("    esac\n", out);
}

void completion_bash(FILE *out, const struct program *program)
{
    fprintf(out, "# Completion of %s for bash, written by the program from its table of options.\n", program->name);
    put_function_name(out, program->name);
    fputs("()\n{\n"
          "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} options= value= words=\n"
          "    local atlas= name\n"
          "    COMPREPLY=()\n"
          "    if [ \"$word\" = = ]; then # --option=value is three words\n"
          "        word=\n"
          "    elif [ \"$before\" = = ]; then\n"
          "        before=${COMP_WORDS[COMP_CWORD - 2]}\n"
          "    fi\n",
          out);
    if (program->unnamed) {
        put_command(out, program->commands[0]);
    } else {
        put_commands(out, program);
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
          "}\ncomplete -F ",
          out);
    put_function_name(out, program->name);
    fprintf(out, " %s\n", program->name);
}
