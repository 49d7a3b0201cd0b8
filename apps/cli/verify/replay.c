/* SPDX-License-Identifier: BSD-3-Clause */
/* Rewrites a recorded command line, so that it reads what was found and writes into a folder of its own, and runs it.
 */
#include "cli/verify/replay.h"

#include "base/child/process.h"
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "conus/catalogue.h"
#include "conus/version.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 64, TRIES = 8, COPIED_AT_ONCE = 1 << 16 };

static const char root[] = "/root";     /* of absolute paths */
static const char drives[] = "/drive/"; /* of those that begin with one: "C/a" of "C:/a" */

/* Writes the folder of an absolute path in the stage; gives what of the path belongs behind it. */
static const char *put_folder(FILE *out, const struct stage *stage, const char *path)
{
    bool has_drive = path[0] != '/' && path[1] == ':';
    fprintf(out, "%s%s%.*s", stage->folder, has_drive ? drives : root, has_drive, path);
    return path + (has_drive ? 2 : 0);
}

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

/* Whether there is no other way to have a file in the stage than a copy. */
static bool cannot_link(void)
{
    return errno == ENOSYS || errno == EPERM;
}

/* What is there already stays, as it does where links are. */
static bool copy_file(const char *from, const char *to)
{
    char bytes[COPIED_AT_ONCE];
    int in = system_open(from, SYSTEM_READ);
    int out = in < 0 ? SYSTEM_NO_FILE : system_open(to, SYSTEM_WRITE | SYSTEM_MAKE | SYSTEM_NEW);
    bool is_there = in >= 0 && out < 0 && errno == EEXIST;
    bool copied = out >= 0;
    ptrdiff_t size = 1;
    for (uint64_t at = 0; copied && size > 0; at += size > 0 ? (uint64_t)size : 0) {
        size = system_read_at(in, bytes, sizeof bytes, at);
        copied = size >= 0 && system_write(out, bytes, (size_t)size);
    }
    int error = errno;
    if (in >= 0) {
        close(in);
    }
    if (out >= 0 && close(out)) {
        copied = false;
    }
    errno = copied ? errno : error;
    return copied || is_there;
}

struct copying {
    const char *from, *to;
    int levels; /* of folders that may follow */
    bool done;
};

static bool copy_any(const char *from, const char *to, int levels);

static bool copy_entry(void *user, const char *name)
{
    struct copying *copying = user;
    char from[SYSTEM_PATH];
    char to[SYSTEM_PATH];
    if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0) {
        errno = ENAMETOOLONG;
        copying->done = snprintf(from, sizeof from, "%s/%s", copying->from, name) < SYSTEM_PATH &&
                        snprintf(to, sizeof to, "%s/%s", copying->to, name) < SYSTEM_PATH &&
                        copy_any(from, to, copying->levels);
    }
    return copying->done;
}

static bool copy_any(const char *from, const char *to, int levels)
{
    struct system_stat info;
    struct copying copying = {.from = from, .to = to, .levels = levels - 1, .done = true};
    if (!system_stat(&info, from)) {
        return false;
    }
    if (info.kind != SYSTEM_FOLDER) {
        return copy_file(from, to);
    }
    return levels && make_folder(NULL, to) && system_list(from, copy_entry, &copying) && copying.done;
}

/* Refuses ".." behind the first folder of a path: it could lead out of the replay's folder. Paths that conus writes
 * have none there. */
bool stage_link(const struct stage *stage, const char *path, const char *target)
{
    struct system_text text;
    if (path_is_whole(path) && levels_up(path)) {
        return refuse("%s: has \"..\" in it, and moved", path);
    }
    FILE *out = system_text_open(&text);
    if (out && path_is_whole(path)) {
        fputs(put_folder(out, stage, path), out);
    } else if (out) {
        fprintf(out, "%s/%s", stage->cwd, path);
    }
    char *link = system_text_close(&text);
    if (!link) {
        return refuse("not enough memory");
    }
    size_t from = strlen(stage->folder) + 1;
    bool made = is_in_link(link, from) ||
                (make_folders(link, from) &&
                 (system_link(target, link) || errno == EEXIST || (cannot_link() && copy_any(target, link, LEVELS))));
    if (!made) {
        print_error_line("%s: cannot link: %s", path, text_error(errno));
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
    const char *temporary = system_variable("TMPDIR");
    char path[SYSTEM_PATH];
    char real[SYSTEM_PATH];
    uint8_t random[3];
    *out = (struct stage){0};
    do {
        errno = ENAMETOOLONG;
        bool fits =
            system_random(random, sizeof random) &&
            snprintf(path, sizeof path, "%s/conus-%s-%02x%02x%02x", path_is_whole(temporary) ? temporary : "/tmp", name,
                     random[0], random[1], random[2]) < SYSTEM_PATH;
        if (fits && system_make_folder(path, true)) {
            out->folder = strdup(system_real_path(real, path) ? real : path);
            return out->folder || refuse("not enough memory");
        }
    } while (errno == EEXIST);
    print_system_error(path, "make");
    return false;
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
    *stage = (struct stage){.folder = stage->folder};
}

/* Puts the folder before each absolute path in the word: "/a.nii", "from=/a.nii", "@/names.txt". */
char *stage_word(const struct stage *stage, const char *given)
{
    struct system_text word;
    FILE *out = system_text_open(&word);
    for (const char *at = given; out && *at;) {
        bool begins = at == given || at[-1] == '=' || at[-1] == '@';
        at = begins && path_is_whole(at) && stage->is_moved ? put_folder(out, stage, at) : at;
        if (*at) { /* a drive alone has nothing behind it */
            fputc(*at++, out);
        }
    }
    return system_text_close(&word);
}

void stage_leave(char *text, const char *folder)
{
    const size_t length = strlen(folder);
    for (char *at = text; (at = strstr(at, folder));) {
        const char *behind = at + length;
        size_t drive = strlen(drives);
        if (strncmp(behind, root, strlen(root)) == 0) {
            behind += strlen(root);
        } else if (strncmp(behind, drives, drive) == 0 && behind[drive]) {
            *at++ = behind[drive];
            *at++ = ':';
            behind += drive + 1;
        } else {
            at += length;
        }
        memmove(at, behind, strlen(behind) + 1);
    }
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

/* Files in a folder: how many, and the first by name, with and without a sidecar's. */
struct listed {
    char first[SYSTEM_NAME + 1], other[SYSTEM_NAME + 1];
    size_t count;
};

static void keep_first(char *first, const char *name)
{
    if (!*first || strcmp(name, first) < 0) {
        snprintf(first, SYSTEM_NAME + 1, "%s", name);
    }
}

static bool list_file(void *user, const char *name)
{
    struct listed *listed = user;
    if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0) {
        listed->count++;
    }
    if (name[0] != '.') {
        keep_first(listed->first, name);
    }
    if (name[0] != '.' && !path_ends_in(name, ".json")) {
        keep_first(listed->other, name);
    }
    return true;
}

/* The one of two files that is no sidecar: that has ".json" behind or in place of the other's ending. */
char *stage_find_output(const char *folder, const char *option)
{
    char *path = NULL;
    char *found = NULL;
    struct listed listed = {0};
    if (!folder || asprintf(&path, "%s/out/%s", folder, option) < 0) {
        return NULL;
    }
    (void)system_list(path, list_file, &listed);
    const char *name = listed.count > 1 ? listed.other : listed.first;
    if (*name && asprintf(&found, "%s/%s", path, name) < 0) {
        found = NULL;
    }
    free(path);
    return found;
}

static void remove_folder(char *path);

static bool remove_entry(void *user, const char *name)
{
    char path[SYSTEM_PATH];
    struct system_stat info;
    if (strcmp(name, ".") != 0 && strcmp(name, "..") != 0 &&
        snprintf(path, sizeof path, "%s/%s", (const char *)user, name) < SYSTEM_PATH &&
        system_stat_link(&info, SYSTEM_HERE, path)) {
        if (info.kind == SYSTEM_FOLDER) {
            remove_folder(path);
        } else {
            (void)system_remove(path);
        }
    }
    return true;
}

/* Some systems leave out names of a folder from which others are removed meanwhile. */
static void remove_folder(char *path)
{
    for (size_t i = 0; i < TRIES && !system_remove_folder(path); i++) {
        (void)system_list(path, remove_entry, path);
    }
}

void stage_remove(char *folder)
{
    if (folder) {
        remove_folder(folder);
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
    bool known = line->count > 1 && strcmp(line->words[0], "conus") == 0;
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
        if (role == OPTION_READS_POSES && poses_are_stdin(use->value)) {
            return fail_replay(out, "its poses came from standard input, which cannot be read again");
        }
        if (role == OPTION_ENDS || (role == OPTION_PLAIN && is_text)) {
            return fail_replay(out, "its command line has --%s, which is not asked again", name);
        }
    }
    return true;
}

/* Words on the way. */
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

typedef conus_status (*catalogue_search)(const conus_installed **out, const conus_catalogue *catalogue,
                                         const char *name);

/* What was given by its name: if that means another file here, or none, the recorded file. */
static char *named_word(const struct writing *out, const char *given, const char *recorded, catalogue_search find)
{
    size_t length = recorded ? strlen(recorded) : 0;
    bool is_name = recorded && path_is_name(given) && strncmp(given, recorded, length) != 0;
    if (is_name) {
        const conus_installed *atlas = NULL;
        conus_catalogue *catalogue = NULL;
        bool same = !conus_catalogue_create(&catalogue, NULL) && !find(&atlas, catalogue, given) &&
                    strcmp(atlas->path, recorded) == 0 && !out->stage->is_moved;
        conus_catalogue_destroy(catalogue);
        given = same ? given : recorded;
    }
    return stage_word(out->stage, given);
}

static char *atlas_word(const struct writing *out, const char *given, size_t index)
{
    return named_word(out, given, record_atlas(out->replay->record, index), conus_catalogue_find);
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
    case OPTION_READS_IMAGE:
        read = named_word(out, use->value, record_context(out->replay->record), conus_catalogue_find_image);
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
    if (of_batch && of_batch->role == OPTION_OF_RUN) { /* that of the rows */
        snprintf(shard, sizeof shard, "%lld/%lld", (long long)replay->record->shard[0],
                 (long long)replay->record->shard[1]);
        put_option(out, "shard", shard);
    }
    if (!out->has_output) {
        put_output(out, option_find(replay->command, "output"), NULL, NULL);
    }
    put_word(out, strdup("--")); /* since a path may begin with a dash */
    put_word(out, atlas_word(out, arguments->operands[0], 0));
    for (size_t i = 1; i < arguments->operand_count; i++) {
        put_word(out, stage_word(out->stage, arguments->operands[i]));
    }
    for (size_t i = 0; i < arguments->more.count; i++) {
        put_word(out, stage_word(out->stage, arguments->more.items[i]));
    }
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

/* What the process says, line by line. */
struct saying {
    struct replay *replay;
    char line[REPLAY_WHY];
    size_t length;
};

/* A message: of several the last counts, without "conus: ". Warnings are none. */
static void take_line(struct saying *saying)
{
    static const char name[] = "conus: ";
    char *line = saying->line;
    line[saying->length] = '\0';
    saying->length = 0;
    drop_quotes(line);
    line += strncmp(line, name, strlen(name)) ? 0 : strlen(name);
    if (strncmp(line, "warning: ", strlen("warning: ")) == 0) {
        return; /* which is said under --quiet, too */
    }
    saying->replay->is_said = true;
    snprintf(saying->replay->why, sizeof saying->replay->why, "%s", line);
}

static void take_bytes(struct saying *saying, const char *bytes, size_t size)
{
    for (size_t i = 0; i < size; i++) {
        if (bytes[i] != '\n') {
            saying->line[saying->length++] = bytes[i];
        }
        if (bytes[i] == '\n' || saying->length == sizeof saying->line - 1) {
            take_line(saying);
        }
    }
}

/* Runs this program with the words, until it has ended. */
static bool run_again(struct replay *replay, const struct stage *stage, char *const *words)
{
    char program[SYSTEM_PATH];
    char rows[4096]; /* that were asked for on stdout: of none is there use */
    char messages[4096];
    struct process process;
    struct process_end end = {0};
    struct process_part parts[2] = {{.data = rows, .capacity = sizeof rows},
                                    {.data = messages, .capacity = sizeof messages}};
    struct saying saying = {.replay = replay};
    const struct process_start start = {.path = program,
                                        .words = words,
                                        .folder = stage->cwd,
                                        .given = system_is_terminal(STDERR_FILENO) ? STDERR_FILENO : SYSTEM_NO_FILE};
    system_set_variable("CONUS_CACHE", "off"); /* verify asks about what the files hold now */
    system_set_variable(PROGRESS_VARIABLE, "3");
    if (!system_program(program) || !process_begin(&process, &start)) {
        return fail_replay(replay, errno == ENOSYS ? "WebAssembly has no process for it" : "no process for it");
    }
    fail_replay(replay, "it cannot be answered again");
    while (process_writes(&process) && process_read(parts, &process, INFINITY) == PROCESS_CAME) {
        take_bytes(&saying, messages, parts[PROCESS_ERR].got);
    }
    if (saying.length) {
        take_line(&saying);
    }
    bool ended = process_wait(&end, &process, INFINITY);
    process_finish(&process);
    if (ended && end.kind != PROCESS_EXITED) {
        replay->is_said = false;
        return fail_replay(replay, "%.*s ended it", (int)strcspn(end.how, ","), end.how);
    }
    return ended && (end.code == EXIT_DONE || end.code == EXIT_DIFFERENT);
}

static bool answer_again(struct replay *replay, const struct stage *stage)
{
    struct writing writing = {.replay = replay, .stage = stage, .whole = true};
    put_words(&writing);
    bool answered = writing.whole && run_again(replay, stage, writing.words);
    if (!writing.whole) {
        replay->is_said = true;
        fail_replay(replay, "its command line does not fit into memory, or is not whole");
    }
    for (int i = 0; i < writing.count; i++) {
        free(writing.words[i]);
    }
    return answered;
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
    bool answered = answer_again(replay, &stage);
    replay->is_moved = stage.is_moved;
    stage_finish(&stage);
    return answered;
}

void replay_finish(struct replay *replay)
{
    if (replay->settings && replay->arguments.command) {
        options_finish(replay->settings, &replay->arguments);
    }
    free(replay->settings);
    stage_remove(replay->folder);
    *replay = (struct replay){0};
}
