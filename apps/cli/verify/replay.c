/* SPDX-License-Identifier: BSD-3-Clause */
/* Rewrites a recorded command line, so that it reads what was found and writes into a folder of its own, and runs it.
 */
#include "cli/verify/replay.h"

#include "base/path.h"
#include "base/system/system.h"
#include "conus/catalogue.h"
#include "conus/version.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { OPEN_FOLDERS = 16, LEVELS = 64 };

static const char root[] = "/root"; /* of absolute paths */

/* How many components of `path` are "..". */
static size_t levels_up(const char *path)
{
    size_t count = 0;
    const char *part;
    for (size_t length; path_part(&path, &part, &length);) {
        count += length == 2 && part[0] == '.' && part[1] == '.';
    }
    return count;
}

static bool make_folder(void *user, const char *path)
{
    (void)user;
    return system_make_folder(path, true) || errno == EEXIST;
}

/* Makes every folder that `path` names before its last slash, from `from` on. */
static bool make_folders(char *path, size_t from)
{
    return path_each_folder(path, from, make_folder, NULL);
}

static bool is_no_link(void *user, const char *path)
{
    struct system_stat info;
    (void)user;
    return !system_stat_link(&info, SYSTEM_HERE, path) || info.kind != SYSTEM_LINK;
}

/* Whether a folder of the path, from `from` on, is a link: to a store, whose files are there with it. */
static bool is_in_link(char *path, size_t from)
{
    return !path_each_folder(path, from, is_no_link, NULL);
}

/* Refuses ".." behind the first folder of a path: it could lead out of the replay's folder. Paths that conus writes
 * have none there. */
bool stage_link(const struct stage *stage, const char *path, const char *target)
{
    bool absolute = path_is_whole(path);
    const char *below = absolute ? stage->folder : stage->cwd;
    char *link = NULL;
    if (absolute && levels_up(path)) {
        return refuse("%s: has \"..\" in it, and moved", path);
    }
    if (asprintf(&link, "%s%s%s", below, absolute ? root : "/", path) < 0) {
        return refuse("not enough memory");
    }
    size_t from = strlen(stage->folder) + 1;
    bool made = is_in_link(link, from) || (make_folders(link, from) && (symlink(target, link) == 0 || errno == EEXIST));
    if (!made) {
        print_error_line("%s: cannot link: %s", path, strerror(errno));
    }
    free(link);
    return made;
}

static bool make_cwd(struct stage *out, const struct record *record)
{
    size_t levels = 1;
    for (size_t i = 0; i < record->input_count; i++) {
        const char *path = record->inputs[i].path;
        size_t up = path_is_whole(path) ? 0 : 1 + levels_up(path);
        levels = up > levels ? up : levels;
    }
    if (levels > LEVELS) {
        return refuse("a path has more than %d \"..\"", LEVELS);
    }
    size_t length = strlen(out->folder);
    out->cwd = calloc(1, length + sizeof "/files" + 2 * levels + 1);
    if (!out->cwd) {
        return refuse("not enough memory");
    }
    memcpy(out->cwd, out->folder, length);
    memcpy(out->cwd + length, "/files", strlen("/files"));
    size_t end = length + strlen("/files");
    for (; levels; levels--, end += 2) {
        memcpy(out->cwd + end, "/d", 2);
    }
    out->cwd[end] = '/';
    bool made = make_folders(out->cwd, length + 1);
    out->cwd[end] = '\0';
    return made || (print_system_error(out->cwd, "make"), false);
}

bool stage_begin(struct stage *out, const char *name)
{
    const char *temporary = getenv("TMPDIR");
    *out = (struct stage){0};
    if (asprintf(&out->folder, "%s/conus-%s-XXXXXX", path_is_whole(temporary) ? temporary : "/tmp", name) < 0) {
        out->folder = NULL;
        return refuse("not enough memory");
    }
    if (!mkdtemp(out->folder)) {
        print_system_error(out->folder, "make");
        free(out->folder);
        out->folder = NULL;
        return false;
    }
    return asprintf(&out->messages, "%s/messages", out->folder) >= 0 || (out->messages = NULL);
}

bool stage_make(struct stage *out, const struct record *record, const struct found_file *found)
{
    bool made = stage_begin(out, "verify") && make_cwd(out, record);
    for (size_t i = 0; i < record->input_count; i++) {
        const char *path = record->inputs[i].path;
        char here[SYSTEM_PATH];
        bool is_found = path_is_whole(path) && found[i].path;
        out->is_moved =
            out->is_moved || (is_found && !(system_real_path(here, path) && strcmp(here, found[i].path) == 0));
    }
    for (size_t i = 0; i < record->input_count && made; i++) {
        const char *path = record->inputs[i].path;
        bool links = found[i].path && (!path_is_whole(path) || out->is_moved);
        made = !links || stage_link(out, path, found[i].path);
    }
    return made;
}

void stage_finish(struct stage *stage)
{
    free(stage->cwd);
    free(stage->messages);
    *stage = (struct stage){.folder = stage->folder};
}

/* Puts the folder before each absolute path in the word: "/a.nii", "from=/a.nii", "@/names.txt". */
char *stage_word(const struct stage *stage, const char *given)
{
    struct system_text word;
    FILE *out = system_text_open(&word);
    for (const char *at = given; out && *at; at++) {
        bool begins = at == given || at[-1] == '=' || at[-1] == '@';
        if (path_is_whole(at) && begins && stage->is_moved) {
            fprintf(out, "%s%s", stage->folder, root);
        }
        fputc(*at, out);
    }
    return system_text_close(&word);
}

char *stage_output(const struct stage *stage, const char *option, const char *name)
{
    char *path = NULL;
    const char *own =
        !*name || strcmp(name, ".") == 0 || strcmp(name, "..") == 0 || !path_is_name(name) ? "rows" : name;
    if (asprintf(&path, "%s/out/%s/%s", stage->folder, option, own) < 0) {
        return NULL;
    }
    if (!make_folders(path, strlen(stage->folder) + 1)) {
        free(path);
        return NULL;
    }
    return path;
}

/* The one of two files that is no sidecar: that has ".json" behind or in place of the other's ending. */
char *stage_find_output(const char *folder, const char *option)
{
    char *path = NULL;
    char *found = NULL;
    if (!folder || asprintf(&path, "%s/out/%s", folder, option) < 0) {
        return NULL;
    }
    struct dirent **entries = NULL;
    int count = scandir(path, &entries, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        const char *name = entries[i]->d_name;
        bool is_sidecar = path_ends_in(name, ".json") && count > 3; /* with . and .. */
        if (name[0] != '.' && !is_sidecar && !found && asprintf(&found, "%s/%s", path, name) < 0) {
            found = NULL;
        }
    }
    for (int i = 0; i < count; i++) {
        free(entries[i]);
    }
    free((void *)entries);
    free(path);
    return found;
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *at)
{
    (void)info;
    (void)kind;
    (void)at;
    return remove(path);
}

void stage_remove(char *folder)
{
    if (folder) {
        nftw(folder, remove_entry, OPEN_FOLDERS, FTW_DEPTH | FTW_PHYS);
    }
    free(folder);
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
    while (*commands && !((*commands)->answers && strcmp((*commands)->name, name) == 0)) {
        commands++;
    }
    return *commands;
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

bool replay_parse(struct replay *out, const struct command *const *commands)
{
    const struct command_line *line = &out->record->line;
    bool known = line->count > 1 && (strcmp(line->words[0], "conus") == 0 || strcmp(line->words[0], "conus-mpi") == 0);
    out->command = known ? find_command(commands, line->words[1]) : NULL;
    if (!out->command || asks_for_help(line)) {
        return fail_replay(out,
                           "its command line begins with \"%.40s %.40s\": only conus query, batch, sweep, track, "
                           "overlap, connect and plan are asked again",
                           line->words[0], line->count > 1 ? line->words[1] : "");
    }
    out->settings = calloc(1, out->command->settings_size);
    if (!out->settings) {
        return fail_replay(out, "it does not fit into memory");
    }
    messages_hold(true);
    int code = options_parse(&out->arguments, out->settings, out->command, commands, (int)line->count, line->words, 2);
    messages_hold(false);
    if (code >= 0) {
        return fail_replay(out, "this conus, %s, does not take its command line: %s", conus_version(), error_line());
    }
    return true;
}

bool replay_check(struct replay *out, const struct command *const *commands)
{
    if (!replay_parse(out, commands)) {
        return false;
    }
    const struct arguments *arguments = &out->arguments;
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option_use *use = &arguments->uses[i];
        const char *name = use->option->name;
        enum option_role role = use->option->role;
        bool is_text = use->option->type == OPTION_TEXT || use->option->type == OPTION_LIST;
        if (role == OPTION_LIVE) {
            return fail_replay(out, "its poses came from a tracker (--%s), which cannot be asked again", name);
        }
        if (role == OPTION_READS_POSES && output_is_stdout(use->value)) {
            return fail_replay(out, "its poses came from standard input, which cannot be read again");
        }
        if (role == OPTION_ENDS || (role == OPTION_PLAIN && is_text)) {
            return fail_replay(out, "its command line has --%s, which is not asked again", name);
        }
    }
    return true;
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

static void put_word(struct writing *out, char *word)
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
    put_word(out, asprintf(&word, "--%s%s%s", name, value ? "=" : "", value ? value : "") < 0 ? NULL : word);
}

/* The command line is not whole if the path is NULL. */
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
    bool is_name = recorded && path_is_name(given) && strncmp(given, recorded, length) != 0;
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

/* A file of the same name in a folder of its own, with its key (NULL = none). */
static void put_output(struct writing *out, const struct option *option, const char *given, const char *key)
{
    const char *name = output_is_stdout(given) ? "rows" : path_name(given);
    conus_format format;
    char *path = stage_output(out->stage, option->name, name);
    char *keyed = NULL;
    if (path && key && asprintf(&keyed, "%s,%s=%s", path, option->key, key) < 0) {
        keyed = NULL;
    }
    put_path(out, option->name, key ? keyed : path);
    if (option->role == OPTION_WRITES_ANSWER) {
        if (!out->has_format && path && !output_format(&format, path)) { /* it went to no file */
            put_option(out, "format", option->format);
        }
        out->has_output = true;
    }
    free(keyed);
    free(path);
}

static void put_use(struct writing *out, const struct option_use *use)
{
    const char *name = use->option->name;
    char *read = NULL;
    switch (use->option->role) {
    case OPTION_PLAIN:
    case OPTION_ASKS:
    case OPTION_KEPT:
        if (!out->replay->engine || strcmp(name, "engine") != 0) {
            put_option(out, name, use->value);
        }
        break;
    case OPTION_READS:
    case OPTION_READS_POSES:
        read = stage_word(out->stage, use->value);
        put_path(out, name, read);
        break;
    case OPTION_READS_ATLAS:
        read = atlas_word(out, use->value, ++out->atlases);
        put_path(out, name, read);
        break;
    case OPTION_WRITES_ANSWER:
    case OPTION_WRITES:
    case OPTION_WRITES_ROWS:
        put_output(out, use->option, use->value, use->key);
        break;
    case OPTION_WRITES_SIDECAR: /* it comes beside the answer */
    case OPTION_OF_RUN:
    case OPTION_LIVE:
    case OPTION_ENDS:
        break;
    }
    free(read);
}

static void put_words(struct writing *out)
{
    const struct replay *replay = out->replay;
    const struct arguments *arguments = &replay->arguments;
    char shard[64];
    put_word(out, strdup("conus"));
    put_word(out, strdup(replay->command->name));
    put_option(out, "quiet", NULL);
    out->has_format = option_given(arguments, "format");
    for (size_t i = 0; i < arguments->use_count; i++) {
        put_use(out, &arguments->uses[i]);
    }
    if (replay->engine && option_find(replay->command, "engine")) {
        put_option(out, "engine", replay->engine);
    }
    const struct option *of_batch = option_find(replay->command, "shard");
    if (of_batch && of_batch->role == OPTION_OF_RUN) { /* always, since Slurm's environment may say another one */
        snprintf(shard, sizeof shard, "%lld/%lld", (long long)replay->record->shard[0],
                 (long long)replay->record->shard[1]);
        put_option(out, "shard", shard);
    }
    if (!arguments->operand_count) { /* one row of a table of --jobs */
        const json_t *batch = json_object_get(replay->record->root, "Batch");
        const char *poses = json_string_value(json_object_get(batch, "pose_file"));
        char *read = poses ? stage_word(out->stage, poses) : NULL;
        put_path(out, "poses", read);
        put_output(out, option_find(replay->command, "output"), replay->result, NULL);
        free(read);
    } else if (!out->has_output) {
        put_output(out, option_find(replay->command, "output"), NULL, NULL);
    }
    const char *atlas = arguments->operand_count ? arguments->operands[0] : record_atlas(replay->record, 0);
    put_word(out, strdup("--")); /* since a path may begin with a dash */
    put_word(out, atlas ? atlas_word(out, atlas, 0) : NULL);
    for (size_t i = 1; i < arguments->operand_count; i++) {
        put_word(out, stage_word(out->stage, arguments->operands[i]));
    }
    for (size_t i = 0; i < arguments->more.count; i++) {
        put_word(out, stage_word(out->stage, arguments->more.items[i]));
    }
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
        return print_data_error("its command line does not fit into memory, or is not whole");
    }
    const struct command *command = replay->command;
    struct arguments arguments;
    void *settings = calloc(1, command->settings_size);
    int code = settings ? options_parse(&arguments, settings, command, replay->arguments.family, writing.count,
                                        writing.words, 2)
                        : EXIT_DATA;
    code = code < 0 ? command->run(settings, &arguments) : code;
    fflush(NULL);
    return code;
}

/* Leaves out what stands in quotation marks: words of files that the one who wrote the sidecar may not have. */
static void drop_quotes(char *line)
{
    while ((line = strchr(line, '"'))) {
        char *end = line + 1 + strcspn(line + 1, "\"");
        memmove(line + 1, end, strlen(end) + 1);
        line += 1 + (line[1] == '"');
    }
}

/* The last line that the child said, without "conus: ". */
static void take_message(struct replay *replay, const char *path)
{
    static const char name[] = "conus: ";
    char line[REPLAY_WHY];
    FILE *file = system_stream(path, "r");
    while (file && fgets(line, sizeof line, file)) {
        size_t length = strcspn(line, "\n");
        line[length] = '\0';
        drop_quotes(line);
        replay->is_said = true;
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
        setenv("CONUS_CACHE", "off", 1); /* verify asks about what the files hold now */
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
