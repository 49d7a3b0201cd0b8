/* SPDX-License-Identifier: BSD-3-Clause */
/* The journal of a plan: written now and then, resumed, and joined with those of other shards. */
#include "cli/plan_journal.h"

#include "base/system/system.h"
#include "base/text.h"
#include "batch/batch_record.h"
#include "conus/file.h"
#include "options/clock.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/outputs.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define FIELD(member) OPTION_AT(struct journal_settings, member)

static const char mark[] = "conus-plan 1 ";
static const double PAUSE = 1000; /* ms between two writes; writing takes a twentieth of the time at most */

const struct option journal_options[] = {
    {.name = "shard",
     FIELD(shard),
     .value = "I/N",
     .help = "try part I (from 0) of N equal parts of the poses; --merge joins them",
     .words = "split, cluster, array",
     .role = OPTION_KEPT},
    {.name = "resume",
     FIELD(resume),
     .help = "resume an interrupted run with the same settings; begin if there was none",
     .words = "continue",
     .role = OPTION_OF_RUN,
     .excludes = "force"},
    {.name = "merge",
     FIELD(merge),
     .value = "FILE",
     .help = "take over what the shard that wrote the list FILE has found; of each shard, in place of trying the poses",
     .words = "join",
     .role = OPTION_OF_RUN,
     .excludes = "shard,resume"},
    {0},
};

/* A journal that was read. */
struct journal {
    char *text;
    char *fingerprint, *state;
    size_t state_size;
    struct shard shard;
    uint64_t rows;
};

static char *path_beside(const char *list)
{
    char *path = NULL;
    return asprintf(&path, "%s.journal", list) < 0 ? NULL : path;
}

/* The first line ends in the SHA-256 of all that follows: the command line and the state. */
static bool take_apart(struct journal *out, size_t size)
{
    char sum[SHA256_TEXT];
    char *rest = out->text;
    char *line = text_next(&rest, "\n");
    if (!line || !rest || strncmp(line, mark, sizeof mark - 1) != 0) {
        return false;
    }
    provenance_hash(sum, rest, size - (size_t)(rest - out->text));
    line += sizeof mark - 1;
    out->fingerprint = text_next(&line, " ");
    const char *index = line ? text_next(&line, "/") : "";
    const char *count = line ? text_next(&line, " ") : "";
    const char *rows = line ? text_next(&line, " ") : "";
    bool fits = line && strcmp(line, sum) == 0 && count_parse(index, UINT32_MAX, &out->shard.index) &&
                count_parse(count, UINT32_MAX, &out->shard.count) && count_parse(rows, INT64_MAX, &out->rows) &&
                out->shard.index < out->shard.count;
    text_next(&rest, "\n"); /* the command line, for people */
    out->state = rest;
    out->state_size = rest ? size - (size_t)(rest - out->text) : 0;
    return fits && rest;
}

static int load(struct journal *out, const char *list)
{
    size_t size = 0;
    char *path = path_beside(list);
    *out = (struct journal){0};
    int code = path ? input_file_read(&out->text, &size, path, INPUT_FILE, UINT64_C(1) << 34) : print_no_memory();
    if (!code && !take_apart(out, size)) {
        code = print_data_error("%s: is no journal of a plan, or not whole", path);
    }
    free(path);
    return code;
}

/* Whether there is a file; *is_other: it does not begin as journals do. */
static bool is_there(bool *is_other, const char *path)
{
    char begin[sizeof mark] = "";
    FILE *file = system_stream(path, "r");
    bool found = file;
    if (file) {
        size_t size = fread(begin, 1, sizeof mark - 1, file);
        fclose(file);
        *is_other = size && strncmp(begin, mark, sizeof mark - 1) != 0;
    }
    return found;
}

bool plan_journal_is_of(const char *list)
{
    bool is_other = false;
    char *path = path_beside(list);
    bool found = path && is_there(&is_other, path);
    free(path);
    return found && !is_other;
}

int plan_journal_init(struct plan_journal *out, bool *replaces, const struct journal_settings *settings,
                      const struct request *request)
{
    const char *output = request->settings->answer.output;
    const char *poses = request->settings->aim.pose;
    const char *option = settings->shard         ? "shard"
                         : settings->resume      ? "resume"
                         : settings->merge.count ? "merge"
                                                 : NULL;
    bool is_file = !output_is_no_file(output);
    bool is_piped = poses && poses_are_no_file(poses);
    bool is_other = false;
    *out = (struct plan_journal){
        .settings = settings, .command = request->command_line, .shard = {0, 1}, .count = UINT64_MAX};
    if (option && is_piped) {
        return print_usage_error("--%s needs a file of poses, not %s", option,
                                 poses_are_stdin(poses) ? "standard input" : "a pipe");
    }
    if (option && !settings->merge.count && !is_file) {
        return print_usage_error("--%s has no effect without a file for --output", option);
    }
    for (size_t i = 0; i < settings->merge.count; i++) {
        char *journal = path_beside(settings->merge.items[i]);
        conus_inputs_add(settings->merge.items[i]);
        conus_inputs_add(journal);
        free(journal);
    }
    if (!output_spares_inputs("--output", output)) {
        return EXIT_USAGE;
    }
    int code = settings->shard ? shard_parse(&out->shard, settings->shard) : EXIT_DONE;
    if (code || settings->merge.count || is_piped || !is_file) {
        return code;
    }
    out->path = path_beside(output);
    if (!out->path) {
        return print_no_memory();
    }
    bool found = is_there(&is_other, out->path);
    if (found && is_other) {
        return print_usage_error("%s: there is a file that is no journal of a plan", out->path);
    }
    if (found && !settings->resume && !request->settings->answer.force) {
        return print_usage_error("%s: a plan has begun there; --resume continues it, --force begins anew", output);
    }
    *replaces = found;
    return EXIT_DONE;
}

/* Whether the file of the journal is the one behind the descriptor, which is locked. */
static int check_lock(const struct plan_journal *journal, int lock)
{
    struct system_stat own;
    struct system_stat named;
    bool is_own = lock >= 0 && system_lock(lock) && system_stat_open(&own, lock) &&
                  system_stat(&named, journal->path) && own.device == named.device && own.inode == named.inode;
    return is_own ? EXIT_DONE : print_data_error("%s: another conus is writing this file", journal->path);
}

/* Locks the file, of which each write makes a new one. */
static int lock_file(struct plan_journal *journal)
{
    int lock = system_open(journal->path, SYSTEM_READ);
    int code = check_lock(journal, lock);
    int unused = code ? lock : journal->lock;
    if (unused > 0) {
        close(unused);
    }
    journal->lock = code ? journal->lock : lock;
    return code;
}

/* Hashes all that the list depends on but paths, threads and the shard. */
static int identify(struct plan_journal *out, const struct request *request, const struct provenance *inputs)
{
    conus_report_options options = request_report_options(request);
    conus_report *report = NULL;
    const char *sidecar = NULL;
    struct system_text text;
    size_t size = 0;
    int code = EXIT_DONE;
    options.rows = CONUS_ROWS_PLAN;
    options.format = CONUS_FORMAT_TSV;
    options.command = NULL;
    FILE *asked = system_text_open(&text);
    if (!asked) {
        return print_no_memory();
    }
    for (size_t i = 0; i < request->arguments->use_count; i++) {
        const struct option_use *use = &request->arguments->uses[i];
        if (use->option->role == OPTION_PLAIN || use->option->role == OPTION_ASKS ||
            use->option->role == OPTION_READS || use->option->role == OPTION_READS_NAMES ||
            use->option->role == OPTION_READS_IMAGE) {
            fprintf(asked, "%s=%s\n", use->option->name, use->value ? use->value : "");
        }
    }
    for (size_t i = 0; i < inputs->input_count && !code; i++) {
        char sum[SHA256_TEXT];
        code = provenance_hash_file(sum, inputs->inputs[i]);
        fprintf(asked, "%s\n", code ? "" : sum);
    }
    bool failed = !system_text_close(&text);
    conus_status status = conus_report_create(&report, request->answerers[0].selector, &options);
    status = status ? status : conus_report_sidecar(&sidecar, &size, report);
    code = code ? code : failed ? print_no_memory() : print_status(status);
    code = code ? code
                : batch_fingerprint(out->fingerprint, sidecar, &request->atlases, (const char *[]){text.data, NULL});
    conus_report_destroy(report);
    free(text.data);
    return code;
}

/* Gives the plan the state in a journal, if it is of the same plan; `end` is the row behind the last one tried. */
static int take_over(uint64_t *end, conus_plan *plan, const struct journal *journal, const struct plan_journal *own,
                     const char *list)
{
    if (strcmp(journal->fingerprint, own->fingerprint) != 0 || journal->shard.count != own->shard.count) {
        return print_usage_error("%s: its journal was written with other settings, poses, atlas, shards or version%s",
                                 list, own->path ? "; --force begins anew" : "");
    }
    conus_status status = conus_plan_add_state(end, plan, journal->state, journal->state_size);
    if (status) {
        const char *why = conus_message();
        print_error_line("%s.journal: %s%s", list, why,
                         strstr(why, "needs a map of entries")   ? "; run it again with --map"
                         : strstr(why, "needs a map of targets") ? "; run it again with --target-map"
                                                                 : "");
    }
    return status ? exit_code_of(status) : EXIT_DONE;
}

static int resume(struct plan_journal *own, conus_plan *plan, const char *list)
{
    struct journal journal;
    uint64_t end = 0;
    int code = load(&journal, list);
    if (!code && journal.shard.index != own->shard.index) {
        code = print_usage_error("%s: its journal is of shard %" PRIu64 "/%" PRIu64 "; --force begins anew", list,
                                 journal.shard.index, journal.shard.count);
    }
    code = code ? code : take_over(&end, plan, &journal, own, list);
    free(journal.text);
    return code;
}

/* The journal of shard `index`; NULL, after an error message, where not one has it. */
static const struct journal *find_shard(const struct journal *journals, const struct option_list *lists, uint64_t index)
{
    const struct journal *found = NULL;
    for (size_t i = 0; i < lists->count; i++) {
        if (journals[i].shard.index == index && found) {
            print_error_line("%s and %s are both shard %" PRIu64 " of %" PRIu64, lists->items[found - journals],
                             lists->items[i], index, found->shard.count);
            return NULL;
        }
        found = journals[i].shard.index == index ? &journals[i] : found;
    }
    if (!found) {
        print_error_line("shard %" PRIu64 " of %" PRIu64 " is missing (%s is one of them)", index,
                         journals[0].shard.count, lists->items[0]);
    }
    return found;
}

static int join(struct plan_journal *own, conus_plan *plan, uint64_t rows)
{
    const struct option_list *lists = &own->settings->merge;
    struct journal *journals = calloc(lists->count, sizeof *journals);
    int code = EXIT_DONE;
    if (!journals) {
        return print_no_memory();
    }
    for (size_t i = 0; i < lists->count && !code; i++) {
        code = load(&journals[i], lists->items[i]);
    }
    uint64_t count = code ? 0 : journals[0].shard.count;
    own->shard.count = count;
    for (uint64_t index = 0; index < count && !code; index++) {
        const struct journal *journal = find_shard(journals, lists, index);
        uint64_t end = 0, first, wanted;
        if (!journal) {
            code = EXIT_DATA;
            continue;
        }
        const char *list = lists->items[journal - journals];
        code = take_over(&end, plan, journal, own, list);
        shard_range(&first, &wanted, (struct shard){index, count}, rows);
        if (!code && (end != first + wanted || journal->rows != rows)) {
            code = print_data_error("%s: this shard is not finished; --resume continues it", list);
        }
    }
    own->shard = (struct shard){0, 1};
    for (size_t i = 0; i < lists->count; i++) {
        free(journals[i].text);
    }
    free(journals);
    return code;
}

int plan_journal_open(struct plan_journal *journal, conus_plan *plan, const struct request *request,
                      const struct provenance *inputs)
{
    bool is_merged = journal->settings->merge.count;
    bool is_counted = is_merged || journal->settings->shard || journal->settings->resume;
    const char *list = request->settings->answer.output;
    uint64_t first = 0;
    if (!journal->path && !is_merged) {
        return EXIT_DONE;
    }
    int code = identify(journal, request, inputs);
    conus_status status = code || !is_counted ? CONUS_OK : conus_pose_stream_count(&journal->rows, request->stream);
    if (!code && !status && is_counted) {
        shard_range(&first, &journal->count, journal->shard, journal->rows);
        status = first ? conus_pose_stream_skip(request->stream, first) : CONUS_OK;
    }
    if (code || status) {
        return code ? code : print_status(status);
    }
    bool is_kept = journal->settings->shard || journal->settings->resume;
    journal->next = clock_ms() + (is_kept ? 0 : PAUSE);
    if (is_merged) {
        return join(journal, plan, journal->rows);
    }
    bool is_begun = system_allows(journal->path, 0);
    code = is_begun ? lock_file(journal) : EXIT_DONE;
    return code                                    ? code
           : journal->settings->resume && is_begun ? resume(journal, plan, list)
           : is_kept                               ? plan_journal_write(journal, plan, true) /* to lock it */
                                                   : EXIT_DONE;
}

int plan_journal_write(struct plan_journal *journal, conus_plan *plan, bool now)
{
    double begun = clock_ms();
    const char *state = NULL;
    size_t size = 0;
    char *body = NULL;
    char *text = NULL;
    char sum[SHA256_TEXT];
    if (!journal->path || !(now || begun >= journal->next)) {
        return EXIT_DONE;
    }
    if (journal->lock && check_lock(journal, journal->lock)) {
        return EXIT_DATA;
    }
    conus_status status = conus_plan_state(&state, &size, plan);
    if (status) {
        return print_status(status);
    }
    int length = asprintf(&body, "%s\n%s", journal->command, state);
    if (length >= 0) {
        provenance_hash(sum, body, (size_t)length);
        length = asprintf(&text, "%s%s %" PRIu64 "/%" PRIu64 " %" PRIu64 " %s\n%s", mark, journal->fingerprint,
                          journal->shard.index, journal->shard.count, journal->rows, sum, body);
        free(body);
    }
    int code = length < 0 ? print_no_memory() : output_write(journal->path, text, (size_t)length);
    if (length >= 0) {
        free(text);
    }
    journal->next = clock_ms() + PAUSE + 20 * (clock_ms() - begun);
    return code ? code : lock_file(journal);
}

void plan_journal_end(const struct plan_journal *journal, bool knows_poses)
{
    bool is_needed = knows_poses && (journal->settings->shard || journal->settings->resume);
    if (journal->path && !is_needed) {
        system_remove(journal->path);
    }
}

void plan_journal_finish(struct plan_journal *journal)
{
    if (journal->lock) {
        close(journal->lock);
    }
    free(journal->path);
    *journal = (struct plan_journal){0};
}
