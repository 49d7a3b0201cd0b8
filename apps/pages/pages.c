/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a program's man pages and completions to a folder. */
#include "pages/pages.h"

#include "base/system/system.h"
#include "options/messages.h"

#include <errno.h>
#include <string.h>

/* Opens folder/name; NULL after an error message. */
static FILE *open_page(char path[SYSTEM_PATH], const char *folder, const char *name)
{
    int length = snprintf(path, SYSTEM_PATH, "%s/%s", folder, name);
    errno = ENAMETOOLONG;
    FILE *out = length < SYSTEM_PATH ? system_stream(path, "w") : NULL;
    if (!out) {
        print_system_error(folder, "write");
    }
    return out;
}

static int close_page(FILE *out, const char *path)
{
    int failed = ferror(out);
    return fclose(out) || failed ? print_system_error(path, "write") : EXIT_DONE;
}

static int write_completions(const struct program *program, const char *folder)
{
    static const struct {
        const char *before, *after;
        void (*write)(FILE *out, const struct program *program);
    } shells[] = {{"", ".bash", completion_bash}, {"", ".fish", completion_fish}, {"_", "", completion_zsh}};
    int code = EXIT_DONE;
    for (size_t i = 0; !code && i < sizeof shells / sizeof *shells; i++) {
        char name[64], path[SYSTEM_PATH];
        snprintf(name, sizeof name, "%s%s%s", shells[i].before, program->name, shells[i].after);
        FILE *out = open_page(path, folder, name);
        if (!out) {
            return EXIT_DATA;
        }
        shells[i].write(out, program);
        code = close_page(out, path);
    }
    return code;
}

/* Writes the page of `command`, or of the program where that is NULL. */
static int write_man_page(const struct program *program, const struct command *command, const char *folder)
{
    char name[64], path[SYSTEM_PATH];
    bool part = command && program->commands[1];
    snprintf(name, sizeof name, "%s%s%s.1", program->name, part ? "-" : "", part ? command->name : "");
    FILE *out = open_page(path, folder, name);
    if (!out) {
        return EXIT_DATA;
    }
    bool complete = true;
    if (command) {
        complete = man_page_command(out, program, command);
    } else {
        man_page_program(out, program);
    }
    int code = close_page(out, path);
    if (!complete) {
        errno = ENOMEM;
        return print_system_error(path, "write");
    }
    return code;
}

static int write_man_pages(const struct program *program, const char *folder)
{
    int code = program->commands[1] ? write_man_page(program, NULL, folder) : EXIT_DONE;
    for (size_t i = 0; !code && program->commands[i]; i++) {
        if (!program->commands[i]->hand_over) {
            code = write_man_page(program, program->commands[i], folder);
        }
    }
    return code;
}

bool pages_answer(int *code, const struct program *program, int count, char **words)
{
    if (count == 3 && strcmp(words[1], "help") == 0 && strcmp(words[2], "--json") == 0) {
        *code = pages_put_rows(stdout, program);
        return true;
    }
    if (count != 3 || strcmp(words[1], "--write-pages") != 0) {
        return false;
    }
    const char *folder = words[2];
    if (!system_make_folder(folder, false) && errno != EEXIST) {
        *code = print_system_error(folder, "make");
        return true;
    }
    *code = write_man_pages(program, folder);
    *code = *code ? *code : write_completions(program, folder);
    return true;
}
