/* SPDX-License-Identifier: BSD-3-Clause */
/* conus cache: what is kept for the next time, where, and an end to it. */
#include "base/system/system.h"
#include "cli/answers/aligned.h"
#include "cli/commands.h"
#include "conus/cache.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <inttypes.h>
#include <string.h>
#include <time.h>

struct cache_settings {
    size_t format; /* 1 = TSV */
    struct common_settings common;
};

static const char *const formats[] = {"table", "tsv", NULL};

static const struct option own_options[] = {
    {.name = "format",
     OPTION_AT(struct cache_settings, format),
     .value = "FORMAT",
     .help = "of list: a table for people, or tab-separated values:",
     .choices = formats,
     .words = "export",
     .common = true},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct cache_settings, common)},
    {0},
};

enum { COLUMNS = 4 };

static void put_tsv(FILE *out, const void *cache)
{
    fputs("kind\tbytes\tlast_used\tpath\n", out);
    for (size_t i = 0; i < conus_cache_count(cache); i++) {
        const conus_cache_entry *entry = conus_cache_entry_at(cache, i);
        char when[32] = "n/a";
        struct tm parts;
        const time_t used = (time_t)entry->last_used;
        if (system_local_time(&parts, used)) {
            strftime(when, sizeof when, "%Y-%m-%d %H:%M:%S", &parts);
        }
        fprintf(out, "%s\t%" PRIu64 "\t%s\t", entry->kind, entry->size, when);
        aligned_put_cell(out, entry->path);
        fputc('\n', out);
    }
}

static bool put_rows(FILE *out, const void *cache)
{
    put_tsv(out, cache);
    return true;
}

static bool put_table(FILE *out, const void *cache)
{
    static const bool right[COLUMNS] = {[1] = true};
    uint64_t bytes = 0;
    size_t count = conus_cache_count(cache);
    for (size_t i = 0; i < count; i++) {
        bytes += conus_cache_entry_at(cache, i)->size;
    }
    bool whole = !count || aligned_put(out, put_tsv, cache, COLUMNS, right);
    fputs(count ? "\n" : "", out);
    const char *folder = conus_cache_folder(cache);
    fprintf(out, "%zu entr%s, %" PRIu64 " bytes%s%s\n", count, count == 1 ? "y" : "ies", bytes, *folder ? ", in " : "",
            folder);
    if (!conus_cache_limit()) {
        fputs("$CONUS_CACHE: atlases are not kept, and not taken from here\n", out);
    }
    return whole;
}

static int list_cache(const struct cache_settings *settings)
{
    conus_cache *cache = NULL;
    conus_status status = conus_cache_create(&cache);
    if (status) {
        return print_status(status);
    }
    const char *problem = conus_cache_problem(cache);
    if (problem) {
        print_error_line("note: nothing is kept, since %s", problem);
    }
    int code = output_put(settings->format == 1 ? put_rows : put_table, cache);
    conus_cache_destroy(cache);
    return code;
}

static int print_folder(const struct cache_settings *settings)
{
    (void)settings;
    conus_cache *cache = NULL;
    conus_status status = conus_cache_create(&cache);
    if (status) {
        return print_status(status);
    }
    const char *folder = conus_cache_folder(cache);
    if (*folder) {
        printf("%s\n", folder);
    } else {
        print_error_line("there is no folder: %s", conus_cache_problem(cache));
    }
    int code = *folder ? EXIT_DONE : EXIT_DATA;
    conus_cache_destroy(cache);
    return code;
}

static int clear_cache(const struct cache_settings *settings)
{
    (void)settings;
    return print_status(conus_cache_clear());
}

static int run_cache(const void *given, const struct arguments *arguments)
{
    static const struct {
        const char *word;
        int (*run)(const struct cache_settings *settings);
    } words[] = {{"list", list_cache}, {"where", print_folder}, {"clear", clear_cache}};
    const char *word = arguments->operands[0];
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        if (strcmp(word, words[i].word) == 0) {
            if (i > 0 && option_given(arguments, "format")) {
                return print_usage_error("--format has no effect without list");
            }
            return words[i].run(given);
        }
    }
    return print_usage_error("\"%s\": list, where or clear is needed", word);
}

const struct command cmd_cache = {
    .name = "cache",
    .summary = "list or remove what is kept for the next time",
    .operands = {"list|where|clear"},
    .description =
        "list says which atlases are kept, how large they are and when\n"
        "they were last used; where prints the folder, $XDG_CACHE_HOME/conus, else ~/.cache/conus; clear removes\n"
        "all of it.\n\n"
        "An atlas that was loaded is kept as it is in memory, and mapped from there the next time, unless\n"
        "--no-cache is given or $CONUS_CACHE is off. $CONUS_CACHE may also be the most that atlases may have\n"
        "together, like 500M or 40G (default 4G): those unused for longest leave first.",
    .examples = "  conus cache list\n"
                "  conus cache clear\n"
                "  CONUS_CACHE=off conus query aal --origin=-90,20,20 --toward=0,-10,10\n",
    .groups = groups,
    .settings_size = sizeof(struct cache_settings),
    .run = run_cache,
};
