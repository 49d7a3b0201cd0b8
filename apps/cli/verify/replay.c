/* SPDX-License-Identifier: BSD-3-Clause */
/* Rewrites a recorded command line, so that it reads what was found and writes into a folder of its own, and runs it.
 */
#include "cli/verify/replay.h"

#include "cli/verify/stage.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"

#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* What becomes of an option. Of a type that is no text it is kept; a text that is not listed here is refused. */
enum fate { KEPT, READ, WRITTEN, DROPPED, REFUSED };

static const struct {
    const char *option;
    enum fate fate;
} fates[] = {
    {"angles", KEPT},
    {"jitter", KEPT},
    {"contacts", KEPT},
    {"mask-object", KEPT},
    {"score", KEPT},
    {"atlas", READ},
    {"context", READ},
    {"atlas-transform", READ},
    {"hide", READ},
    {"labels", READ},
    {"level", READ},
    {"only", READ},
    {"pathway", READ},
    {"pose", READ},
    {"poses", READ},
    {"deep", WRITTEN},
    {"image", WRITTEN},
    {"mask", WRITTEN},
    {"output", WRITTEN},
    {"segments", WRITTEN},
    {"voxels", WRITTEN},
    {"force", DROPPED},
    {"jobs", DROPPED},
    {"progress", DROPPED},
    {"quiet", DROPPED},
    {"resume", DROPPED},
    {"shard", DROPPED},
    {"sidecar", DROPPED},
    {"verbose", DROPPED},
    {"help", REFUSED},
    {"version", REFUSED},
    {"seconds", REFUSED},
    {"no-cache", DROPPED},
    {"streamlines", READ},
    {"streamlines-out", WRITTEN},
    {"endpoints", WRITTEN},
    {"connectivity", WRITTEN},
};

static enum fate fate_of(const struct option *option)
{
    for (size_t i = 0; i < sizeof fates / sizeof fates[0]; i++) {
        if (strcmp(option->name, fates[i].option) == 0) {
            return fates[i].fate;
        }
    }
    return option->type == OPTION_TEXT || option->type == OPTION_LIST ? REFUSED : KEPT;
}

static bool fail_replay(struct replay *replay, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool fail_replay(struct replay *replay, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(replay->why, sizeof replay->why, format, args);
    va_end(args);
    return false;
}

static const struct command *find_command(const struct command *const *commands, const char *name)
{
    static const char *const again[] = {"query", "batch", "sweep", "track", "overlap", "connect"};
    bool may = false;
    for (size_t i = 0; i < sizeof again / sizeof again[0]; i++) {
        may = may || strcmp(name, again[i]) == 0;
    }
    while (may && *commands && strcmp((*commands)->name, name) != 0) {
        commands++;
    }
    return may ? *commands : NULL;
}

/* --help and --version would end the parser, and print. */
static bool asks_for_help(const struct command_line *line)
{
    static const char *const words[] = {"--help", "-h", "--version"};
    for (size_t i = 0; i < line->count; i++) {
        for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
            if (strcmp(line->words[i], words[k]) == 0) {
                return true;
            }
        }
    }
    return false;
}

static bool check_uses(struct replay *out)
{
    const struct arguments *arguments = &out->arguments;
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        const char *name = use->option->name;
        if (strcmp(name, "listen") == 0 || strcmp(name, "connect") == 0) {
            return fail_replay(out, "its poses came from a tracker (--%s), which cannot be asked again", name);
        }
        if ((strcmp(name, "pose") == 0 || strcmp(name, "poses") == 0) && output_is_stdout(use->value)) {
            return fail_replay(out, "its poses came from standard input, which cannot be read again");
        }
        if (fate_of(use->option) == REFUSED) {
            return fail_replay(out, "its command line has --%s, which is not asked again", name);
        }
    }
    return true;
}

bool replay_parse(struct replay *out, const struct command *const *commands)
{
    const struct command_line *line = &out->record->line;
    bool known = line->count > 1 && (strcmp(line->words[0], "conus") == 0 || strcmp(line->words[0], "conus-mpi") == 0);
    out->command = known ? find_command(commands, line->words[1]) : NULL;
    if (!out->command || asks_for_help(line)) {
        return fail_replay(out,
                           "its command line begins with \"%.40s %.40s\": only conus query, batch, sweep, track, "
                           "overlap and connect are asked again",
                           line->words[0], line->count > 1 ? line->words[1] : "");
    }
    out->settings = calloc(1, out->command->settings_size);
    if (!out->settings) {
        return fail_replay(out, "it does not fit into memory");
    }
    messages_hold(true);
    int code = options_parse(&out->arguments, out->settings, out->command, (int)line->count, line->words, 2);
    messages_hold(false);
    if (code >= 0) {
        return fail_replay(out, "this conus, %s, does not take its command line: %s", conus_version(), error_line());
    }
    return true;
}

bool replay_check(struct replay *out, const struct command *const *commands)
{
    return replay_parse(out, commands) && check_uses(out);
}

/* Words on the way, in the child. */
struct writing {
    const struct replay *replay;
    const struct stage *stage;
    char *words[COMMAND_WORDS + 16];
    int count;
    size_t atlases; /* how many of --atlas were written */
    bool has_output, has_format, whole;
};

static void put(struct writing *out, char *word)
{
    out->whole = out->whole && word && out->count < COMMAND_WORDS + 8;
    if (out->whole) {
        out->words[out->count++] = word;
    } else {
        free(word);
    }
}

static void put_option(struct writing *out, const char *name, const char *value)
{
    char *word = NULL;
    put(out, asprintf(&word, "--%s%s%s", name, value ? "=" : "", value ? value : "") < 0 ? NULL : word);
}

/* Without a path the command line is not whole. */
static void put_path(struct writing *out, const char *name, const char *path)
{
    out->whole = out->whole && path;
    if (path) {
        put_option(out, name, path);
    }
}

/* An atlas that was given by its name: if that means another file here, or none, the recorded file. */
static char *atlas_word(const struct writing *out, const char *given, size_t index)
{
    const char *recorded = record_atlas(out->replay->record, index);
    size_t length = recorded ? strlen(recorded) : 0;
    bool is_name = recorded && !strchr(given, '/') && strncmp(given, recorded, length) != 0;
    if (is_name) {
        const conus_installed *atlas = NULL;
        conus_catalogue *catalogue = NULL;
        bool same = !conus_catalogue_create(&catalogue, NULL) && !conus_catalogue_find(&atlas, catalogue, given) &&
                    strcmp(atlas->path, recorded) == 0 && !out->stage->is_moved;
        conus_catalogue_destroy(catalogue);
        given = same ? given : recorded;
    }
    return stage_word(out->stage, given);
}

/* A file of the same name in a folder of its own. */
static void put_output(struct writing *out, const char *option, const char *given)
{
    const char *slash = given ? strrchr(given, '/') : NULL;
    const char *name = !given || output_is_stdout(given) ? "rows" : slash ? slash + 1 : given;
    conus_format format;
    char *path = stage_output(out->stage, option, name);
    bool is_rows = strcmp(option, "output") == 0;
    put_path(out, option, path);
    if (is_rows && !out->has_format && path && !output_format(&format, path)) { /* it went to no file */
        put_option(out, "format", strcmp(out->replay->command->name, "batch") == 0 ? "tsv" : "table");
    }
    out->has_output = out->has_output || is_rows;
    free(path);
}

static void put_use(struct writing *out, const struct option_use *use)
{
    const char *name = use->option->name;
    bool is_atlas = strcmp(name, "atlas") == 0;
    char *read = NULL;
    switch (fate_of(use->option)) {
    case KEPT:
        if (!out->replay->engine || strcmp(name, "engine") != 0) {
            put_option(out, name, use->value);
        }
        break;
    case READ:
        read = is_atlas ? atlas_word(out, use->value, ++out->atlases) : stage_word(out->stage, use->value);
        put_path(out, name, read);
        break;
    case WRITTEN:
        put_output(out, name, use->value);
        break;
    case DROPPED:
    case REFUSED:
        break;
    }
    free(read);
}

/* Of --jobs, one row of the table. */
static void put_job(struct writing *out)
{
    const struct record *record = out->replay->record;
    const char *poses = json_string_value(json_object_get(json_object_get(record->root, "Batch"), "pose_file"));
    char *read = poses ? stage_word(out->stage, poses) : NULL;
    put_path(out, "poses", read);
    put_output(out, "output", out->replay->result);
    free(read);
}

/* Behind "--": a path may begin with a dash. */
static void put_operands(struct writing *out)
{
    const struct arguments *arguments = &out->replay->arguments;
    const char *atlas = arguments->operand_count ? arguments->operands[0] : record_atlas(out->replay->record, 0);
    put(out, strdup("--"));
    put(out, atlas ? atlas_word(out, atlas, 0) : NULL);
    for (size_t i = 1; i < arguments->operand_count; i++) {
        put(out, stage_word(out->stage, arguments->operands[i]));
    }
    for (size_t i = 0; i < arguments->more.count; i++) {
        put(out, stage_word(out->stage, arguments->more.items[i]));
    }
}

static void put_words(struct writing *out)
{
    const struct replay *replay = out->replay;
    const struct arguments *arguments = &replay->arguments;
    bool is_batch = strcmp(replay->command->name, "batch") == 0;
    char shard[64];
    put(out, strdup("conus"));
    put(out, strdup(replay->command->name));
    put_option(out, "quiet", NULL);
    for (size_t i = 0; i < arguments->use_count; i++) {
        out->has_format = out->has_format || strcmp(arguments->uses[i].option->name, "format") == 0;
    }
    for (size_t i = 0; i < arguments->use_count; i++) {
        put_use(out, &arguments->uses[i]);
    }
    if (replay->engine && strcmp(replay->command->name, "overlap") != 0) {
        put_option(out, "engine", replay->engine);
    }
    if (is_batch) { /* always, since Slurm's environment may say another one */
        snprintf(shard, sizeof shard, "%lld/%lld", (long long)replay->record->shard[0],
                 (long long)replay->record->shard[1]);
        put_option(out, "shard", shard);
    }
    if (!arguments->operand_count) {
        put_job(out);
    } else if (!out->has_output) {
        put_output(out, "output", NULL);
    }
    put_operands(out);
}

static bool redirect(const char *path, int flags, int descriptor)
{
    int file = open(path, flags | O_CLOEXEC, 0600);
    bool done = file >= 0 && dup2(file, descriptor) >= 0;
    if (file >= 0 && file != descriptor) {
        close(file);
    }
    return done;
}

static int run_words(const struct command *command, int count, char **words)
{
    struct arguments arguments;
    void *settings = calloc(1, command->settings_size);
    int code = settings ? options_parse(&arguments, settings, command, count, words, 2) : EXIT_DATA;
    return code < 0 ? command->run(settings, &arguments) : code;
}

static int answer_in_child(const struct replay *replay, const struct stage *stage)
{
    static struct writing writing;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGINT, SIG_DFL);
    progress_redirect(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
    if (!redirect("/dev/null", O_RDONLY, STDIN_FILENO) || !redirect("/dev/null", O_WRONLY, STDOUT_FILENO) ||
        !redirect(stage->messages, O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO) || chdir(stage->cwd)) {
        return EXIT_DATA;
    }
    writing = (struct writing){.replay = replay, .stage = stage, .whole = true};
    put_words(&writing);
    if (!writing.whole) {
        print_error_line("its command line does not fit into memory, or is not whole");
        return EXIT_DATA;
    }
    int code = run_words(replay->command, writing.count, writing.words);
    fflush(NULL);
    return code;
}

/* The last line that the child said, without "conus: ". */
static void take_message(struct replay *replay, const char *path)
{
    static const char name[] = "conus: ";
    char line[REPLAY_WHY];
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file)) {
        size_t length = strcspn(line, "\n");
        line[length] = '\0';
        snprintf(replay->why, sizeof replay->why, "%s", strncmp(line, name, strlen(name)) ? line : line + strlen(name));
    }
    if (file) {
        fclose(file);
    }
}

static bool wait_for(struct replay *replay, pid_t child, const char *messages)
{
    int status = 0;
    struct sigaction before;
    struct sigaction ignore = {.sa_handler = SIG_IGN};
    sigaction(SIGINT, &ignore, &before); /* the child ends, and this process removes its folder */
    pid_t ended = waitpid(child, &status, 0);
    sigaction(SIGINT, &before, NULL);
    if (ended == child && WIFEXITED(status) &&
        (WEXITSTATUS(status) == EXIT_DONE || WEXITSTATUS(status) == EXIT_DIFFERENT)) {
        return true;
    }
    if (ended == child && WIFSIGNALED(status)) {
        return fail_replay(replay, "signal %d ended it", WTERMSIG(status));
    }
    fail_replay(replay, "it cannot be answered again");
    take_message(replay, messages);
    return false;
}

bool replay_run(struct replay *replay)
{
    struct stage stage = {0};
    messages_hold(true);
    bool made = stage_make(&stage, replay->record, replay->found);
    messages_hold(false);
    replay->folder = stage.folder;
    if (!made) {
        fail_replay(replay, "%s", error_line());
        stage_finish(&stage);
        return false;
    }
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        setenv("CONUS_CACHE", "off", 1); /* what is verified is what the files hold now */
        _exit(answer_in_child(replay, &stage));
    }
    bool answered = child > 0 ? wait_for(replay, child, stage.messages) : fail_replay(replay, "no process for it");
    replay->root = stage.is_moved ? stage_word(&stage, "/") : NULL;
    if (replay->root) {
        replay->root[strlen(replay->root) - 1] = '\0'; /* the slash that is the path's own */
    }
    answered = answered && (!stage.is_moved || replay->root || fail_replay(replay, "it does not fit into memory"));
    stage_finish(&stage);
    return answered;
}

char *replay_output(const struct replay *replay, const char *option)
{
    return stage_find_output(replay->folder, option);
}

void replay_finish(struct replay *replay)
{
    if (replay->settings && replay->arguments.command) {
        options_finish(replay->settings, &replay->arguments);
    }
    free(replay->settings);
    free(replay->root);
    stage_remove(replay->folder);
    *replay = (struct replay){0};
}
