/* SPDX-License-Identifier: BSD-3-Clause */
/* The program conus: finds the command and runs it. */
#include "base/system/system.h"
#include "cli/commands.h"
#include "options/messages.h"
#include "options/options.h"
#include "options/output.h"
#include "pages/pages.h"

#include "conus/version.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

enum { ENOUGH = 1 << 20, STACK = 8 << 20 }; /* bytes of stack */

static const struct command *const commands[] = {
    &cmd_query,     &cmd_batch, &cmd_track,   &cmd_sweep,  &cmd_overlap, &cmd_connect,  &cmd_plan,    &cmd_calibrate,
    &cmd_positions, &cmd_info,  &cmd_atlases, &cmd_render, &cmd_mesh,    &cmd_manifest, &cmd_phantom, &cmd_diff,
    &cmd_verify,    &cmd_cite,  &cmd_report,  &cmd_pack,   &cmd_page,    &cmd_mcp,      &cmd_view,    NULL};

static const struct program program = {
    .name = "conus",
    .summary = "name the brain areas, pathways and bundles in a cone",
    .description = "Which areas, pathways and bundles of the brain lie in the cone of a pointing device?\n\n"
                   "Positions are in mm, x right, y anterior, z superior; angles in degrees. Results go to stdout,\n"
                   "messages to stderr. ATLAS is a file or a folder, or the name of one that conus atlases lists.",
    .commands = commands,
};

static const char *command_name(const void *list, size_t index)
{
    (void)list;
    return commands[index] ? commands[index]->name : NULL;
}

static const struct command *find_command(const char *name)
{
    size_t i = 0;
    while (commands[i] && strcmp(commands[i]->name, name) != 0) {
        i++;
    }
    return commands[i];
}

static int unknown_command(const char *name)
{
    const struct command *of = command_of_operand(commands, name);
    const char *near = of ? of->name : closest_name(name, command_name, NULL);
    return near ? print_usage_error("unknown command \"%s\"; did you mean %s?", name, near)
                : print_usage_error("unknown command \"%s\"; conus help lists them", name);
}

static int list_commands(FILE *out)
{
    fprintf(out, "usage: conus COMMAND [arguments]\n\n%s\n\n", program.description);
    for (size_t i = 0; commands[i]; i++) {
        fprintf(out, "  %-9s  %s\n", commands[i]->name, commands[i]->summary);
    }
    fprintf(out, "  %-9s  %s\n\nExit codes:", "help", "explain a command: conus help COMMAND [--long]");
    const char *meaning;
    for (size_t code = 0; (meaning = help_exit_code(code)); code++) {
        fprintf(out, "%s %zu %s", code ? "," : "", code, meaning);
    }
    fputs(".\n", out);
    return out == stdout ? EXIT_DONE : EXIT_USAGE;
}

static int help(int count, char **words)
{
    if (count == 0) {
        return list_commands(stdout);
    }
    const struct command *command = find_command(words[0]);
    if (!command) {
        return unknown_command(words[0]);
    }
    bool is_long = count > 1 && strcmp(words[1], "--long") == 0;
    if (count > 1 + is_long) {
        return print_usage_error("unexpected argument \"%s\"", words[1 + is_long]);
    }
    char *ask[] = {words[0], is_long ? (char[]){"--help"} : (char[]){"-h"}, NULL};
    int code = command->hand_over ? command->hand_over(ask) : -1;
    if (code >= 0) {
        return code;
    }
    (is_long ? help_command : help_brief)(stdout, command);
    return EXIT_DONE;
}

static int dispatch(int count, char **words)
{
    if (count < 2) {
        return list_commands(stderr);
    }
    int code;
    if (pages_answer(&code, &program, count, words)) {
        return code;
    }
    const char *name = words[1];
    if (strcmp(name, "help") == 0) {
        return help(count - 2, words + 2);
    }
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) {
        return list_commands(stdout);
    }
    if (strcmp(name, "--version") == 0) {
        printf("conus %s\n", conus_version());
        return EXIT_DONE;
    }
    const struct command *command = find_command(name);
    if (!command) {
        return unknown_command(name);
    }
    code = command->hand_over ? command->hand_over(words + 1) : -1;
    if (code >= 0) {
        return code;
    }
    struct arguments arguments;
    void *settings = calloc(1, command->settings_size);
    if (!settings) {
        return print_no_memory();
    }
    code = options_parse(&arguments, settings, command, commands, count, words, 2);
    if (code < 0 && !(code = outputs_begin(&arguments))) {
        code = command->run(settings, &arguments);
    }
    options_finish(settings, &arguments);
    free(settings);
    return code;
}

struct call {
    int count;
    char **words;
    int code;
};

static void *run_call(void *user)
{
    struct call *call = user;
    call->code = output_finish(dispatch(call->count, call->words));
    return NULL;
}

/* Runs the program in a thread with a stack of its own, which receives all signals. False where no thread can be
 * started. */
static bool run_on_own_stack(struct call *call)
{
    pthread_t thread;
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes)) {
        return false;
    }
    bool runs = !pthread_attr_setstacksize(&attributes, STACK) && !pthread_create(&thread, &attributes, run_call, call);
    pthread_attr_destroy(&attributes);
    return runs && system_leave_signals() && !pthread_join(thread, NULL);
}

int main(int argc, char **argv)
{
    /* A buffer for the longest help: a full disk is found, with its reason, when all is written at the end. */
    static char buffer[1 << 16];
    setvbuf(stdout, buffer, _IOFBF, sizeof buffer);
    /* A reader that went away is an error of writing, with a message and an exit code, not a sudden end; likewise a
     * file that `ulimit -f` does not let grow. */
    system_begin(&argc, &argv, true);
    struct call call = {.count = argc, .words = argv};
    /* `ulimit -s 64` leaves too little for 256 rays side by side, for Embree and for OpenGL. */
    if (!system_stack_is_below(ENOUGH) || !run_on_own_stack(&call)) {
        run_call(&call);
    }
    return call.code;
}
