/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the part of the poses that a process answers: as it was told, or from the environment. */
#include "cli/batch/batch.h"

#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "options/messages.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Variables by which somebody who starts many processes tells each its number, and how many there are: `count`, or the
 * numbers of the first and the last and the step between two. Ranks are of one job; a job may be a task of an array. */
struct source {
    const char *index, *count, *with; /* `with` must be there, too */
    const char *first, *last, *step;
    uint64_t lowest; /* the first number where no variable says it */
    bool is_array;
};

static const struct source sources[] = {
    /* Open MPI comes first: below mpirun in a job of Slurm, SLURM_PROCID is 0 for all. */
    {.index = "OMPI_COMM_WORLD_RANK", .count = "OMPI_COMM_WORLD_SIZE"},
    {.index = "PMI_RANK", .count = "PMI_SIZE"}, /* MPICH, Intel MPI */
    {.index = "MV2_COMM_WORLD_RANK", .count = "MV2_COMM_WORLD_SIZE"},
    {.index = "FLUX_TASK_RANK", .count = "FLUX_JOB_SIZE"},
    /* Never SLURM_NTASKS: in a script without srun it is N, and SLURM_PROCID 0. */
    {.index = "SLURM_PROCID", .count = "SLURM_STEP_NUM_TASKS", .with = "SLURM_STEP_ID"},
    {.index = "SLURM_ARRAY_TASK_ID",
     .count = "SLURM_ARRAY_TASK_COUNT",
     .first = "SLURM_ARRAY_TASK_MIN",
     .last = "SLURM_ARRAY_TASK_MAX",
     .step = "SLURM_ARRAY_TASK_STEP",
     .is_array = true},
    {.index = "SGE_TASK_ID",
     .first = "SGE_TASK_FIRST",
     .last = "SGE_TASK_LAST",
     .step = "SGE_TASK_STEPSIZE",
     .is_array = true},
    {.index = "LSB_JOBINDEX", .last = "LSB_JOBINDEX_END", .lowest = 1, .is_array = true},
};
enum { SOURCES = sizeof sources / sizeof sources[0] };

/* Those that tell a number, and not of how many. */
static const char *const uncounted[] = {"PBS_ARRAY_INDEX", "PBS_ARRAYID", "PMIX_RANK"};
enum { UNCOUNTED = sizeof uncounted / sizeof uncounted[0], PMIX = UNCOUNTED - 1 };

/* A variable's text; NULL where there is none. SGE and LSF have words for that. */
static const char *variable(const char *name)
{
    const char *text = name ? system_variable(name) : NULL;
    bool is_none =
        text && (strcmp(text, "undefined") == 0 || (strcmp(name, "LSB_JOBINDEX") == 0 && strcmp(text, "0") == 0));
    return is_none ? NULL : text;
}

static bool read_variable(uint64_t *out, const char *name, uint64_t missing)
{
    const char *text = variable(name);
    *out = missing;
    return !text || count_parse(text, UINT32_MAX, out);
}

/* Which part a source tells. */
static int read_source(struct shard *out, const struct source *source)
{
    uint64_t index, first, last, step, count;
    bool whole = read_variable(&index, source->index, 0) && read_variable(&first, source->first, source->lowest) &&
                 read_variable(&step, source->step, 1) && read_variable(&count, source->count, 0);
    whole = whole && read_variable(&last, source->last, first + count - 1) && step && first <= last && index >= first &&
            index <= last && (index - first) % step == 0;
    uint64_t steps = whole ? (last - first) / step + 1 : 0;
    if (!whole || (count && count != steps)) {
        return print_usage_error("--shard auto: %s=%s is not one of a whole range of numbers, as an array without gaps "
                                 "has them; --shard I/N says which part of the poses to answer",
                                 source->index, variable(source->index));
    }
    *out = (struct shard){(index - first) / step, steps, false};
    return EXIT_DONE;
}

static const struct source *find_source(bool is_array)
{
    for (size_t i = 0; i < SOURCES; i++) {
        const struct source *source = &sources[i];
        if (source->is_array == is_array && variable(source->index) && (!source->with || variable(source->with)) &&
            variable(is_array ? source->last : source->count)) {
            return source;
        }
    }
    return NULL;
}

static int print_uncounted(const char *name)
{
    bool is_rank = strcmp(name, uncounted[PMIX]) == 0;
    return print_usage_error("--shard auto: %s=%s does not say of how many; --shard \"%s%s%s/N\" does", name,
                             variable(name), is_rank ? "$" : "$((", name, is_rank ? "" : " - 1))");
}

static int read_environment(struct shard *out, bool quiet)
{
    const struct source *found[] = {find_source(true), find_source(false)};
    struct shard parts[] = {{0, 1, false}, {0, 1, false}};
    char from[256] = "";
    for (size_t i = 0; i < UNCOUNTED; i++) {
        if (variable(uncounted[i]) && !(i == PMIX && found[1])) {
            return print_uncounted(uncounted[i]);
        }
    }
    for (size_t i = 0; i < 2; i++) {
        int code = found[i] ? read_source(&parts[i], found[i]) : EXIT_DONE;
        if (code) {
            return code;
        }
        if (found[i]) {
            size_t length = strlen(from);
            snprintf(from + length, sizeof from - length, "%s%s=%s", length ? " and " : "", found[i]->index,
                     variable(found[i]->index));
        }
    }
    if (!*from) {
        return print_usage_error("--shard auto: the environment does not say which part this process is, as srun, "
                                 "mpirun and arrays of jobs do; --shard I/N does");
    }
    *out = (struct shard){parts[0].index * parts[1].count + parts[1].index, parts[0].count * parts[1].count, false};
    say_note(CONUS_SEVERITY_NOTE, quiet, "--shard %" PRIu64 "/%" PRIu64 ", from %s", out->index, out->count, from);
    return EXIT_DONE;
}

/* A script that divides nothing answers everything in each task. */
static void say_array(bool quiet)
{
    const struct source *array = find_source(true);
    const char *name = array                    ? array->index
                       : variable(uncounted[0]) ? uncounted[0]
                       : variable(uncounted[1]) ? uncounted[1]
                                                : NULL;
    if (name) {
        say_note(CONUS_SEVERITY_NOTE, quiet, "in an array of jobs (%s=%s); --shard %s divides the poses", name,
                 variable(name), array ? "auto" : "I/N");
    }
}

int shard_read(struct shard *out, const char *text, bool quiet)
{
    char index[32] = "";
    const char *slash = text ? strchr(text, '/') : NULL;
    size_t length = slash ? (size_t)(slash - text) : 0;
    struct shard read = {0, 1, false};
    int code = EXIT_DONE;
    snprintf(index, sizeof index, "%.*s", (int)(length < sizeof index ? length : 0), text ? text : "");
    read.all = strcmp(index, "all") == 0;
    if (text && strcmp(text, "auto") == 0) {
        code = read_environment(&read, quiet);
    } else if (text && !(slash && (read.all || count_parse(index, UINT32_MAX, &read.index)) &&
                         count_parse(slash + 1, UINT32_MAX, &read.count) && read.index < read.count)) {
        code = print_usage_error("--shard: \"%s\" is not I/N with whole numbers, I from 0 to N - 1, nor all/N nor auto",
                                 text);
    } else if (!text) {
        say_array(quiet);
    }
    if (!code && read.count > SHARD_LIMIT) {
        code = print_usage_error("--shard: %" PRIu64 " parts, allowed are %d", read.count, SHARD_LIMIT);
    }
    *out = code ? *out : read;
    return code;
}

void shard_range(uint64_t *first, uint64_t *count, struct shard shard, uint64_t total)
{
    uint64_t each = total / shard.count;
    uint64_t more = total % shard.count;
    *first = shard.index * each + (shard.index < more ? shard.index : more);
    *count = each + (shard.index < more);
}

/* The length of a file's name before its ending. */
static size_t base_stem(const char *base)
{
    const char *dot = strrchr(base, '.');
    return dot && dot > base ? (size_t)(dot - base) : strlen(base);
}

char *shard_path(const char *path, struct shard shard)
{
    char *out = NULL;
    if (shard.count == 1) {
        return strdup(path);
    }
    const char *base = path_base(path);
    size_t stem = (size_t)(base - path) + base_stem(base);
    int digits = snprintf(NULL, 0, "%" PRIu64, shard.count - 1);
    return asprintf(&out, "%.*s.%0*" PRIu64 "-of-%" PRIu64 "%s", (int)stem, path, digits, shard.index, shard.count,
                    path + stem) < 0
               ? NULL
               : out;
}

/* Names in the folder of a file's parts. */
struct listing {
    const char *base; /* the file's name; `stem` bytes of it are before its ending */
    size_t stem;
    uint64_t count; /* of the parts that may be there */
    char other[SYSTEM_PATH];
    uint64_t other_count; /* 0 = no part of another number was found */
};

/* The number at the beginning of the text, and what is behind it; false where there is none. */
static bool read_number(uint64_t *out, const char **text)
{
    char *end;
    bool is_number = **text >= '0' && **text <= '9';
    *out = is_number ? strtoull(*text, &end, 10) : 0;
    *text = is_number ? end : *text;
    return is_number;
}

static bool look_at_name(void *user, const char *name)
{
    static const char of[] = "-of-";
    struct listing *listing = user;
    uint64_t index, count;
    if (strncmp(name, listing->base, listing->stem) != 0 || name[listing->stem] != '.') {
        return true;
    }
    const char *rest = name + listing->stem + 1;
    bool is_part = read_number(&index, &rest) && strncmp(rest, of, sizeof of - 1) == 0;
    rest += is_part ? sizeof of - 1 : 0;
    is_part = is_part && read_number(&count, &rest) && strcmp(rest, listing->base + listing->stem) == 0;
    if (is_part && count != listing->count) {
        snprintf(listing->other, sizeof listing->other, "%s", name);
        listing->other_count = count;
    }
    return !listing->other_count;
}

int shard_check_others(const char *path, uint64_t count)
{
    struct listing listing = {.base = path_base(path), .stem = base_stem(path_base(path)), .count = count};
    size_t length = path_folder_length(path);
    char *folder = length ? text_copy(path, length) : text_copy(".", 1);
    if (!folder) {
        return print_no_memory();
    }
    system_list(folder, look_at_name, &listing);
    free(folder);
    return listing.other_count
               ? print_data_error("%.*s%s: is one of %" PRIu64 " parts, not of %" PRIu64 "; --shard all/%" PRIu64
                                  " joins them, --force leaves them alone",
                                  (int)length, path, listing.other, listing.other_count, count, listing.other_count)
               : EXIT_DONE;
}

char *shard_words(const struct arguments *arguments, struct shard shard)
{
    static char behind[] = "--shard"; /* its value is the next word */
    char word[64];
    struct arguments changed = *arguments;
    changed.words = calloc((size_t)arguments->count + 1, sizeof *changed.words);
    if (!changed.words) {
        return NULL;
    }
    for (int i = 0; i < arguments->count; i++) {
        bool is_value = i && strcmp(arguments->words[i - 1], behind) == 0;
        bool is_joined = strncmp(arguments->words[i], "--shard=", strlen("--shard=")) == 0;
        changed.words[i] = is_value || is_joined ? word : arguments->words[i];
        if (is_value || is_joined) {
            snprintf(word, sizeof word, "%s%" PRIu64 "/%" PRIu64, is_joined ? "--shard=" : "", shard.index,
                     shard.count);
        }
    }
    char *text = arguments_text(&changed);
    free(changed.words);
    return text;
}
