/* SPDX-License-Identifier: BSD-3-Clause */
/* conus plan --needles: several needles together. A row of the table is a question, and the needles that may answer it:
 * its cells become options, which are read by the parser of conus plan. */
#include "base/path.h"
#include "base/system/system.h"
#include "base/text.h"
#include "cli/answers/answers.h"
#include "cli/cmd_plan.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/progress.h"
#include "sources/names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct option needles_options[] = {
    {OPTION_VALUED("needles", struct needles_settings, file, "FILE"),
     .help = "plan several needles together: a table with a row for each, a column needle with its name, and columns "
             "that are called like the options above, which hold for all needles where they are given here; a row may "
             "name several needles that may answer it, with 1 in column once only one of them",
     .words = "electrodes, several, combination, SEEG",
     .excludes = "map,target-map,constraints,profile,tolerance,jitter,rank,score,infeasible",
     .because =
         "combinations have the one order that is proven, and conus plan --poses of what --poses-out writes says "
         "the rest of each needle alone",
     OPTION_READING(TEXT)},
    {OPTION_VALUED("between", struct needles_settings, between, "MM[,parts=MM]"),
     .help = "any two needles stay farther apart than MM, 0 to 100, and so do their parts from needles and parts; at 0 "
             "they do not touch",
     .standard = "0", .unit = "mm", .words = "collision, conflict, distance", .needs = "needles", .role = OPTION_ASKS},
    {OPTION_MM("entry-distance", struct needles_settings, entry_distance),
     .help = "the positions of any two needles are so far apart at least, straight, 0 to 100", .standard = "0",
     OPTION_FROM_TO(0, 100), .words = "bolt, burr hole", .needs = "needles", .role = OPTION_PLAIN},
    {OPTION_VALUED("arcs", struct needles_settings, arcs, "DEG,..."),
     .help =
         "a rig carries the needles on arcs, at least DEG apart; keys: slider=DEG (of needles on one arc; else the "
         "same), same=DEG (arc angles on one arc differ by no more, 0.5 unless given), most=N (arcs), each=N "
         "(needles on one arc), pitch=DEG (of the rig about the right-left axis, which --arc-window and --from angles "
         "count from); needles with one text in the column arc share an arc, those with another do not",
     .unit = "degrees", .words = "rig, manipulator, slider, probes", .needs = "needles", .role = OPTION_ASKS},
    {OPTION_VALUED("cover", struct needles_settings, covers, "NAME,...[,contacts=N]"),
     .help = "contacts of --contacts that are in these areas, which are one structure, are counted, of all shanks of "
             "all needles together; contacts=N: so many at least; may be repeated",
     .words = "sampling, coverage, electrodes", .needs = "needles", .role = OPTION_ASKS},
    {OPTION_VALUED("given", struct needles_settings, given, "FILE"),
     .help = "poses that are called like needles: these are where they are, the others are planned round them; with "
             "all given their plan is checked",
     .words = "fixed, placed", .needs = "needles", OPTION_READING(POSES)},
    {OPTION_VALUED("diverse", struct needles_settings, diverse, "MM[,COUNT]"),
     .help = "of several combinations (--top): each differs from those before it in COUNT needles or more, 1 unless "
             "given, which enter or end MM or more from where they did, 0 to 100",
     .unit = "mm", .words = "alternatives, variety, second best", .needs = "needles", .role = OPTION_ASKS},
    {OPTION_VALUED("effort", struct needles_settings, effort, "N"),
     .help = "end the search after N million steps, and say what no combination exceeds; 0 = never", .standard = "100",
     OPTION_FROM_TO(0, 1e9), .needs = "needles", .role = OPTION_PLAIN},
    {OPTION_VALUED("pairs", struct needles_settings, pairs, "FILE"),
     .help = "write how near each two needles come to each other, and where", .needs = "needles",
     .role = OPTION_WRITES_ROWS, .holds = HOLDS_ROWS},
    {OPTION_VALUED("candidates", struct needles_settings, candidates, "FILE"),
     .help =
         "write each needle's candidates that may be in a combination as good as the last one of the list: with the "
         "answer and its sidecar another program can prove it",
     .words = "certificate, proof, verify", .needs = "needles", .endings = ".tsv", OPTION_WRITING(POSES)},
    {0},
};

enum {
    COLUMN_LIMIT = 64,
    TABLE_LIMIT = 1 << 20,
    NEEDLE_MOST = 16,
    ROW_MOST = 64,
    FILES_MOST = 100,
    COVER_MOST = 16,
    MORE_SIZE = 96
};

/* The columns that are no options: 1 where only one needle may answer the row; which arc its needles are on. */
static const struct option row_columns[] = {{.name = "once"}, {.name = "arc"}};
enum { ONCE, ARC, ROW_COLUMNS };

/* A row of the table: a question. */
struct question_row {
    struct planner *planner;
    size_t line;
    const char *name; /* of its needles, with commas */
    uint32_t needles; /* bits of them */
    bool once;
    const char *arc; /* "" = any */
    char **words;    /* [word_count] Of a command line; owned, but for the atlas behind them */
    int word_count;
    struct arguments arguments;
    struct plan_settings settings;
    bool was_parsed, was_read;
    bool is_given_alone; /* it has no candidates: its pose is among those of --given */
    struct constraints constraints;
    struct candidates candidates;
    struct request request; /* a view: only its answerer and its stream are its own */
    struct answerer answerer;
    conus_part *parts;
    conus_contacts contacts;
    conus_plan_options options;
};

struct planner {
    const struct plan_settings *settings;
    const struct arguments *arguments;
    struct request request;
    char *text; /* of the table; its cells are in it */
    struct question_row rows[ROW_MOST];
    size_t count;
    char *names[NEEDLE_MOST]; /* of needles, in the order of their first naming */
    size_t name_count;
    conus_pose_list *given;
    conus_pose_row *places; /* those of it */
    conus_together_options options;
    char *cover_names[COVER_MOST];
    conus_cover covers[COVER_MOST];
    conus_together *together;
    conus_so_far so_far;
    char more[MORE_SIZE]; /* of the line of progress: what that says */
};

/* A cell: without quotation marks, doubled ones once; ends with a NUL in its place. */
static char *cut_cell(struct text cell, enum text_quotes quotes)
{
    char *start = (char *)cell.data;
    size_t size = 0;
    for (size_t i = 0; i < cell.size; i++) {
        start[size++] = start[i];
        i += quotes == TEXT_QUOTED && start[i] == '"' && i + 1 < cell.size && start[i + 1] == '"';
    }
    start[size] = '\0';
    return start;
}

/* Cuts a line into cells. 0 after an error. */
static size_t cut_line(char *cells[COLUMN_LIMIT], struct text line, char separator, const char *path, size_t number)
{
    bool more = true;
    size_t count = 0;
    struct text fields[COLUMN_LIMIT];
    enum text_quotes quotes[COLUMN_LIMIT];
    struct text field;
    enum text_quotes how;
    while (text_quoted_field(&line, separator, &more, &field, &how)) {
        if (how == TEXT_FOLLOWED || how == TEXT_UNCLOSED || count == COLUMN_LIMIT) {
            print_error_line(count == COLUMN_LIMIT
                                 ? "%s: line %zu: more than 64 cells"
                                 : "%s: line %zu: a quotation mark is not closed at the end of a cell",
                             path, number);
            return 0;
        }
        fields[count] = field;
        quotes[count++] = how;
    }
    for (size_t i = 0; i < count; i++) { /* once all are found: an end takes a separator's place */
        cells[i] = cut_cell(fields[i], quotes[i]);
    }
    return count;
}

/* The option of a question that has this name, or that `*index` options are before, which it counts down. */
static const struct option *question_option(size_t *index, const char *name)
{
    for (size_t t = 0; plan_question_options[t]; t++) {
        for (const struct option *option = plan_question_options[t]; option->name; option++) {
            if (strcmp(option->name, name) == 0 || !(*index)--) {
                return option;
            }
        }
    }
    return NULL;
}

static const char *question_name_at(const void *list, size_t index)
{
    (void)list;
    const struct option *option = question_option(&index, "");
    return option                 ? option->name
           : index < ROW_COLUMNS  ? row_columns[index].name
           : index == ROW_COLUMNS ? "needle"
                                  : NULL;
}

/* The option that a column is called like, "reach.1" being another "reach"; NULL of the column needle. Prints an error
 * and returns false for another one. */
static bool find_column(const struct option **out, char *name, const struct planner *planner)
{
    const char *path = planner->settings->needles.file;
    char *dot = strrchr(name, '.');
    if (dot && dot[1] && strspn(dot + 1, "0123456789") == strlen(dot + 1)) {
        *dot = '\0';
    }
    size_t all = SIZE_MAX;
    *out = question_option(&all, name);
    for (size_t i = 0; i < ROW_COLUMNS; i++) {
        *out = strcmp(name, row_columns[i].name) == 0 ? &row_columns[i] : *out;
    }
    if (*out || strcmp(name, "needle") == 0) {
        return true;
    }
    const char *near = closest_name(name, question_name_at, NULL);
    return near ? refuse("%s: column %s: did you mean %s?", path, name, near)
           : option_find(planner->arguments->command, name)
               ? refuse("%s: column %s: that is an option of all needles together", path, name)
               : refuse("%s: column %s is neither needle nor a question's option; each row is a needle, its name in "
                        "column needle, what it is to reach in column reach",
                        path, name);
}

static bool is_empty(const char *cell)
{
    return !*cell || strcmp(cell, "n/a") == 0;
}

/* Whether there is a file in the table's folder, which `path` begins with. */
static bool is_in_folder(const char *path, size_t folder, const char *cell)
{
    char file[SYSTEM_PATH];
    const bool fits = snprintf(file, sizeof file, "%.*s%s", (int)folder, path, cell) < SYSTEM_PATH;
    file[fits ? keys_file_length(file, KEYS_TARGETS) : 0] = '\0';
    return system_allows(file, 0);
}

/* Files of a table are where it is. */
static bool is_beside_table(const struct option *option, const char *cell, const char *path, size_t folder)
{
    bool is_file = (option->role == OPTION_READS && option_names_file(option, cell)) ||
                   option->role == OPTION_READS_POSES ||
                   (option->role == OPTION_READS_NAMES && (!path_is_name(cell) || is_in_folder(path, folder, cell)));
    return is_file && !path_is_whole(cell) && strcmp(cell, "-") != 0;
}

/* Appends the word --name=value. */
static bool add_word(struct question_row *row, const struct option *option, const char *folder, size_t folder_size,
                     const char *value)
{
    size_t size = strlen(option->name) + folder_size + (value ? strlen(value) : 0) + 4;
    char *word = malloc(size);
    if (word) {
        snprintf(word, size, value ? "--%s=%.*s%s" : "--%s", option->name, (int)folder_size, folder, value);
        row->words[row->word_count++] = word;
    }
    return word;
}

static bool has_word(const struct question_row *row, const char *start)
{
    bool found = false;
    for (int i = 0; i < row->word_count; i++) {
        found = found || (row->words[i] && strncmp(row->words[i], start, strlen(start)) == 0);
    }
    return found;
}

/* Makes the command line of a row: its cells, and what is given for all needles and not by a cell that may stand once.
 */
static int make_words(struct question_row *row, char *const *cells, const struct option *const *columns, size_t count)
{
    const struct planner *planner = row->planner;
    const struct arguments *all = planner->arguments;
    const char *path = planner->settings->needles.file;
    size_t folder = path_folder_length(path);
    bool whole = true;
    row->words = calloc(all->use_count + count + 2, sizeof *row->words);
    if (!row->words) {
        return print_no_memory();
    }
    for (size_t i = 0; i < all->use_count && whole; i++) {
        const struct option *option = all->uses[i].option;
        bool is_replaced = false;
        for (size_t k = 0; k < count; k++) {
            is_replaced = is_replaced || (columns[k] && columns[k] == option && columns[k]->type != OPTION_LIST &&
                                          !is_empty(cells[k]));
        }
        whole = is_replaced || add_word(row, option, "", 0, all->uses[i].value);
    }
    for (size_t k = 0; k < count && whole; k++) {
        if (columns[k] && columns[k] != &row_columns[ONCE] && columns[k] != &row_columns[ARC] && !is_empty(cells[k])) {
            whole = add_word(row, columns[k], path, is_beside_table(columns[k], cells[k], path, folder) ? folder : 0,
                             cells[k]);
        }
    }
    /* A needle whose pose is given needs no candidates: it is its own. */
    const char *given = planner->settings->needles.given;
    row->is_given_alone = given && !has_word(row, "--poses=") && !has_word(row, "--from=");
    whole = whole && (!row->is_given_alone || add_word(row, option_find(all->command, "poses"), "", 0, given));
    return whole ? EXIT_DONE : print_no_memory();
}

/* RADIUS,H0:H1[,X,Y][,tip] */
static bool read_part(conus_part *out, const char *text)
{
    char *copy = strdup(text);
    char *rest = copy;
    char *words[6] = {0};
    size_t count = 0;
    double ends[2];
    *out = (conus_part){0};
    while (copy && count < 6 && (words[count] = text_next(&rest, ","))) {
        count++;
    }
    out->from_tip = count > 2 && strcmp(words[count - 1], "tip") == 0;
    count -= out->from_tip;
    bool is_fine = (count == 2 || count == 4) && number_parse(words[0], &out->radius) &&
                   numbers_parse(ends, 2, words[1], ':') == 2 &&
                   (count == 2 || (number_parse(words[2], &out->x) && number_parse(words[3], &out->y)));
    if (is_fine) {
        out->low = ends[0];
        out->high = ends[1];
    }
    free(copy);
    return is_fine || refuse("--part: \"%s\" is not RADIUS,H0:H1[,X,Y][,tip]", text);
}

static int read_parts(struct question_row *row)
{
    const struct option_list *parts = &row->settings.needles.parts;
    row->parts = calloc(parts->count + 1, sizeof *row->parts);
    int code = row->parts ? EXIT_DONE : print_no_memory();
    for (size_t i = 0; row->parts && i < parts->count && !code; i++) {
        code = read_part(&row->parts[i], parts->items[i]) ? EXIT_DONE : EXIT_USAGE;
    }
    return code;
}

/* What a row asks of the angles of a rig counts from its pitch. */
static void pitch_row(struct question_row *row)
{
    const double pitch = row->planner->options.pitch;
    for (size_t i = 0; i < row->constraints.count; i++) {
        row->constraints.items[i].pitch = row->constraints.items[i].kind == CONUS_CONSTRAINT_ARC ? pitch : 0;
    }
    for (size_t i = 0; i < row->candidates.from.angle_count; i++) {
        row->candidates.from.angles[2 * i] -= pitch;
    }
}

static int parse_row(struct question_row *row)
{
    const struct arguments *all = row->planner->arguments;
    const char *atlas = all->operands[0];
    int count = row->word_count;
    /* The operand is found again behind all options, whatever it begins with. */
    char *words[2] = {"--", (char *)atlas};
    char **line = calloc((size_t)count + 2, sizeof *line);
    if (!line) {
        return print_no_memory();
    }
    memcpy(line, row->words, (size_t)count * sizeof *line);
    memcpy(line + count, words, sizeof words);
    free(row->words);
    row->words = line;
    row->was_parsed = true;
    int code = options_parse(&row->arguments, &row->settings, all->command, NULL, count + 2, line, 0);
    code = code < 0 ? plan_parse(&row->constraints, &row->candidates, &row->settings, &row->arguments) : code;
    if (!code && row->candidates.from.angles && row->planner->settings->needles.entry_distance > 0) {
        code = print_usage_error("--entry-distance has no effect with --from angles, which are at no entry");
    }
    if (!code && row->settings.request.aim.pose && poses_are_no_file(row->settings.request.aim.pose)) {
        code = print_usage_error("--poses needs a file, which is read several times");
    }
    pitch_row(row);
    code = code ? code : settings_contacts(&row->contacts, row->settings.contacts);
    if (!code && row->planner->options.cover_count && !row->contacts.count) {
        code = print_usage_error("--cover counts contacts: --contacts COUNT,COLUMNS,PITCH,TIP is needed");
    }
    return code ? code : read_parts(row);
}

/* The number of the needle of a name; their number = there is none. */
static size_t find_needle(const struct planner *planner, struct text name)
{
    size_t i = 0;
    while (i < planner->name_count && !text_equal(name, planner->names[i])) {
        i++;
    }
    return i;
}

/* Notes the needles of a row. */
static int name_needles(struct planner *planner, struct question_row *row)
{
    const char *path = planner->settings->needles.file;
    struct text rest = text_from(row->name);
    struct text name;
    int code = EXIT_DONE;
    for (bool more = true; !code && text_field(&rest, ',', &more, &name);) {
        name = text_trim(name);
        size_t at = find_needle(planner, name);
        code = !name.size || text_equal(name, "n/a") ? print_usage_error("%s: line %zu: no needle", path, row->line)
               : memchr(name.data, '/', name.size)
                   ? print_usage_error("%s: line %zu: needle %.*s: a name without \"/\"", path, row->line,
                                       (int)name.size, name.data)
               : at == NEEDLE_MOST ? print_usage_error("%s: more than %d needles", path, NEEDLE_MOST)
               : row->needles >> at & 1
                   ? print_usage_error("%s: line %zu: needle %s is named twice", path, row->line, planner->names[at])
                   : EXIT_DONE;
        row->needles |= 1U << at;
        if (!code && at == planner->name_count) {
            planner->names[at] = text_copy(name.data, name.size);
            planner->name_count += planner->names[at] != NULL;
            code = planner->names[at] ? EXIT_DONE : print_no_memory();
        }
    }
    return code;
}

/* Reads a row; an error of it says where it is. */
static int read_row(struct planner *planner, char *const *cells, const struct option *const *columns, size_t count,
                    size_t line)
{
    const char *path = planner->settings->needles.file;
    if (planner->count == ROW_MOST) {
        return print_usage_error("%s: more than %d rows", path, ROW_MOST);
    }
    struct question_row *row = &planner->rows[planner->count++];
    const char *once = "";
    *row = (struct question_row){.planner = planner, .line = line, .name = "", .arc = ""};
    for (size_t i = 0; i < count; i++) {
        row->name = columns[i] ? row->name : cells[i];
        once = columns[i] == &row_columns[ONCE] ? cells[i] : once;
        row->arc = columns[i] == &row_columns[ARC] && !is_empty(cells[i]) ? cells[i] : row->arc;
    }
    if (*row->arc && !planner->settings->needles.arcs) {
        return print_usage_error("%s: line %zu: arc %s has no effect without --arcs", path, line, row->arc);
    }
    row->once = strcmp(once, "1") == 0;
    if (!row->once && !is_empty(once) && strcmp(once, "0") != 0) {
        return print_usage_error("%s: line %zu: once: %s is neither 0 nor 1", path, line, once);
    }
    int named = name_needles(planner, row);
    if (named) {
        return named;
    }
    int code = make_words(row, cells, columns, count);
    if (!code) {
        messages_hold(true);
        code = parse_row(row);
        messages_hold(false);
        char why[1024];
        snprintf(why, sizeof why, "%s", error_line());
        if (code) {
            print_error_line("%s: line %zu: %s", path, line, why);
        }
    }
    return code;
}

static int read_table(struct planner *planner)
{
    const char *path = planner->settings->needles.file;
    size_t size = 0;
    int code = input_file_read(&planner->text, &size, path, INPUT_FILE, TABLE_LIMIT);
    if (code) {
        return code;
    }
    struct text rest = text_from_bytes((const uint8_t *)planner->text, size);
    struct text line;
    const struct option *columns[COLUMN_LIMIT] = {0};
    size_t count = 0;
    size_t names = 0;
    size_t of_rows[ROW_COLUMNS] = {0};
    char separator = '\t';
    for (size_t number = 1; text_line(&rest, &line) && !code; number++) {
        char *cells[COLUMN_LIMIT];
        if (!text_trim(line).size) {
            continue;
        }
        if (!count) { /* the header */
            separator = memchr(line.data, '\t', line.size) ? '\t' : memchr(line.data, ';', line.size) ? ';' : ',';
        }
        size_t found = cut_line(cells, line, separator, path, number);
        if (!found) {
            return EXIT_USAGE;
        }
        if (count && found > count) {
            return print_usage_error("%s: line %zu: %zu cells, the header has %zu", path, number, found, count);
        }
        while (found < count) { /* empty ones at the end */
            cells[found++] = (char *)"";
        }
        for (size_t i = 0; i < found && !count && !code; i++) {
            code = find_column(&columns[i], cells[i], planner) ? EXIT_DONE : EXIT_USAGE;
            names += !columns[i];
            for (size_t k = 0; k < ROW_COLUMNS; k++) {
                of_rows[k] += columns[i] == &row_columns[k];
            }
        }
        if (!code && (names != 1 || of_rows[ONCE] > 1 || of_rows[ARC] > 1)) {
            return print_usage_error(!names              ? "%s: no column needle"
                                     : names > 1         ? "%s: two columns needle"
                                     : of_rows[ONCE] > 1 ? "%s: two columns once"
                                                         : "%s: two columns arc",
                                     path);
        }
        code = code || !count ? code : read_row(planner, cells, columns, count, number);
        count = found;
    }
    return code ? code : !planner->count ? print_usage_error("%s: no needles in it", path) : EXIT_DONE;
}

/* MM[,parts=MM] */
static bool read_between(conus_together_options *out, const char *text)
{
    static const char word[] = ",parts=";
    if (!text) {
        return true;
    }
    const char *comma = strchr(text, ',');
    char *first = comma ? text_copy(text, (size_t)(comma - text)) : strdup(text);
    bool has_word = comma && strncmp(comma, word, sizeof word - 1) == 0;
    bool is_fine = first && number_parse(first, &out->between) &&
                   (!comma || (has_word && number_parse(comma + sizeof word - 1, &out->parts)));
    free(first);
    if (!is_fine) {
        return refuse("--between: \"%s\" is not MM[,parts=MM]", text);
    }
    return (out->between >= 0 && out->between <= 100 && out->parts >= 0 && out->parts <= 100) ||
           refuse("--between: %s: allowed are 0 to 100 mm", text);
}

/* DEG[,slider=DEG][,same=DEG][,most=N][,each=N][,pitch=DEG] */
static bool read_arcs(struct planner *planner, const char *text)
{
    conus_together_options *out = &planner->options;
    struct source_keys keys;
    char *copy = text ? strdup(text) : NULL;
    if (!text || !copy || !option_cut_keys(&keys, "arcs", copy, KEYS_ARCS)) {
        free(copy);
        return !text;
    }
    double *const numbers[] = {&out->slider, &out->same};
    uint64_t *const counts[] = {&out->arcs_most, &out->arcs_each};
    for (int i = 0; i < 2; i++) {
        const struct key_value *number = keys_value(&keys, KEY_SLIDER + i);
        const struct key_value *count = keys_value(&keys, KEY_MOST + i);
        *numbers[i] = number->numbers[0];
        *counts[i] = (uint64_t)count->numbers[0];
    }
    out->pitch = keys_value(&keys, KEY_TILT_AP)->numbers[0];
    bool is_fine = number_parse(copy, &out->arcs) && out->arcs > 0 && out->arcs <= 180;
    free(copy);
    double same = out->same > 0 ? out->same : 0.5;
    return !is_fine ? refuse("--arcs: \"%s\": the degrees between two arcs are to be above 0, up to 180", text)
                    : 2 * same + 1e-6 < out->arcs ||
                          refuse("--arcs: same: %g degrees, allowed is less than half of the %g between two arcs", same,
                                 out->arcs);
}

/* NAME,...[,contacts=N] */
static bool read_covers(struct planner *planner)
{
    const struct option_list *given = &planner->settings->needles.covers;
    if (given->count > COVER_MOST) {
        return refuse("--cover: %zu of them, allowed are up to %d", given->count, COVER_MOST);
    }
    planner->options.covers = planner->covers;
    for (size_t i = 0; i < given->count; i++) {
        struct source_keys keys;
        char *names = planner->cover_names[i] = strdup(given->items[i]);
        if (!names || !option_cut_keys(&keys, "cover", names, KEYS_COVER)) {
            return names ? false : print_no_memory() == EXIT_DONE;
        }
        if (!constraint_ends_in_name("cover", names, "contacts", "is how many")) {
            return false;
        }
        planner->covers[planner->options.cover_count++] =
            (conus_cover){names, (uint64_t)keys_value(&keys, KEY_CONTACTS)->numbers[0]};
    }
    return true;
}

/* MM[,COUNT], and how many combinations. */
static bool read_list(conus_together_options *out, const struct plan_settings *settings)
{
    const char *text = settings->needles.diverse;
    double numbers[2] = {0, 1};
    out->top = 1;
    if (settings->top && (!count_parse(settings->top, 100, &out->top) || !out->top)) {
        return refuse("--top: \"%s\": of combinations 1 to 100 can be listed", settings->top);
    }
    if (!text != (out->top == 1)) {
        return refuse(text ? "--diverse has no effect without --top above 1"
                           : "--top %s of combinations: say by how much they have to differ: --diverse MM",
                      settings->top);
    }
    size_t count = text ? numbers_parse(numbers, 2, text, ',') : 0;
    out->diverse = numbers[0];
    out->differ = numbers[1] >= 1 && numbers[1] <= NEEDLE_MOST ? (uint64_t)numbers[1] : 0;
    if (text && (!count || count > 2 || !out->differ || (double)out->differ != numbers[1])) {
        return refuse("--diverse: \"%s\" is not MM[,COUNT], with a COUNT of 1 to 16 needles", text);
    }
    return (out->diverse >= 0 && out->diverse <= 100) || refuse("--diverse: %s: allowed are 0 to 100 mm", text);
}

static int open_nothing(void *user)
{
    (void)user;
    return EXIT_DONE;
}

/* Opens the candidates of a row once more. */
static int open_candidates(struct question_row *row)
{
    struct request *request = &row->request;
    const char *path = row->settings.request.aim.pose;
    if (!path) {
        return candidates_open(&row->candidates, request, &row->constraints);
    }
    const conus_pose_options options = request_pose_options(request);
    conus_status status = conus_pose_stream_open(&request->stream, path, &options);
    return status ? pose_settings_print_error(status, path, "poses", &row->arguments) : EXIT_DONE;
}

/* Called by the library, each time that it lists candidates. */
static conus_status open_again(conus_pose_stream **out, void *user)
{
    struct question_row *row = user;
    int code = row->request.stream ? EXIT_DONE : open_candidates(row);
    *out = row->request.stream;
    row->request.stream = NULL;
    return code ? CONUS_ERROR_DATA : CONUS_OK;
}

/* Called by the library once candidates were read: what is to be said of their file is said once. */
static void close_candidates(conus_pose_stream *stream, void *user)
{
    struct question_row *row = user;
    const char *path = row->settings.request.aim.pose;
    if (path && !row->was_read) {
        pose_settings_say_late(stream, path, row->request.notes_said, &row->settings.request.common);
    }
    row->was_read = true;
    conus_pose_stream_destroy(stream);
}

static bool are_same(const char *a, const char *b)
{
    return a && b ? strcmp(a, b) == 0 : a == b;
}

/* Whether the notes of a row's candidates were said by a row before it, or are by --given. */
static bool is_said(const struct question_row *row)
{
    const struct plan_settings *own = &row->settings;
    bool found = row->is_given_alone;
    for (const struct question_row *other = row->planner->rows; other < row && !found; other++) {
        found = are_same(other->settings.request.aim.pose, own->request.aim.pose) &&
                are_same(other->settings.candidates.from, own->candidates.from) &&
                are_same(other->settings.candidates.toward, own->candidates.toward);
    }
    return found;
}

/* Prepares the question of a row: its selector, its constraints, its candidates. */
static int open_row(struct question_row *row)
{
    const struct planner *planner = row->planner;
    const struct plan_settings *settings = &row->settings;
    struct request *request = &row->request;
    *request = planner->request;
    request->settings = &settings->request;
    request->arguments = &row->arguments;
    request->answerers = &row->answerer;
    request->stream = NULL;
    const struct pose_places places = {&request->frame, &settings->request.file, &request->atlases,
                                       &settings->request.common};
    double far = plan_far(settings, &row->candidates);
    int code = constraints_place(&row->constraints, &places, far);
    if (code) {
        return code;
    }
    row->settings.request.common.quiet = row->settings.request.common.quiet || is_said(row);
    conus_selector_options engine = plan_engine(settings, &row->constraints);
    engine.frame = &request->frame;
    conus_status status = conus_selector_create(&row->answerer.selector, request->atlases.items[0].atlas, &engine);
    code = status ? print_status(status) : open_candidates(row);
    if (!code && request->stream && settings->request.aim.pose) {
        code = pose_settings_match_stream(&request->notes_said, request->stream, settings->request.aim.pose,
                                          &request->atlases, &settings->request.file, &settings->request.common);
    }
    row->options = (conus_plan_options){.threads = planner->settings->threads,
                                        .angle = settings_angle(&settings->request.aim, &settings->request.engine),
                                        .far = row->candidates.far,
                                        .shanks = row->constraints.shanks,
                                        .shank_count = row->constraints.shank_count};
    return code;
}

static int open_rows(struct planner *planner)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < planner->count && !code; i++) {
        code = open_row(&planner->rows[i]);
        if (code) {
            print_error_line("%s: line %zu: that is about needle %s", planner->settings->needles.file,
                             planner->rows[i].line, planner->rows[i].name);
        }
    }
    return code;
}

/* Whether candidates are asked for by a row that has none of its own; given: bits of needles. */
static int check_candidates(const struct planner *planner, const struct question_row *row, uint32_t given)
{
    uint32_t planned = row->needles & ~given;
    return planned && row->is_given_alone
               ? print_usage_error("%s: line %zu: no candidates given for %s: --poses FILE, or --from FILE "
                                   "--toward WHAT, or a pose of that name in %s",
                                   planner->settings->needles.file, row->line, planner->names[__builtin_ctz(planned)],
                                   planner->settings->needles.given)
               : EXIT_DONE;
}

/* Takes the places of --given. */
static int take_given(struct planner *planner)
{
    const char *path = planner->settings->needles.given;
    if (!path) {
        return EXIT_DONE;
    }
    const conus_pose_options options = request_pose_options(&planner->request);
    conus_status status = conus_pose_list_load(&planner->given, path, &options);
    int code = status ? print_status(status)
                      : pose_settings_match_list(planner->given, path, &planner->request.atlases,
                                                 &planner->settings->request.file, &planner->settings->request.common);
    const size_t count = conus_pose_list_count(planner->given);
    uint32_t seen = 0;
    planner->places = calloc(count + 1, sizeof *planner->places);
    if (!planner->places) {
        return print_no_memory();
    }
    for (size_t i = 0; i < count && !code; i++) {
        const conus_pose_row *row = conus_pose_list_row(planner->given, i);
        const char *why = pose_settings_row_error(row);
        size_t at = find_needle(planner, text_from(row->id));
        code = at == planner->name_count ? print_usage_error("--given: %s:%zu: %s is no needle of %s", path, row->line,
                                                             row->id, planner->settings->needles.file)
               : why                     ? print_data_error("--given: %s:%zu: %s", path, row->line, why)
               : seen >> at & 1 ? print_usage_error("--given: %s:%zu: %s is given twice", path, row->line, row->id)
                                : EXIT_DONE;
        seen |= 1U << at % NEEDLE_MOST;
        planner->places[i] = *row;
    }
    for (size_t i = 0; i < planner->count && !code; i++) {
        code = check_candidates(planner, &planner->rows[i], seen);
    }
    planner->options.given = planner->places;
    planner->options.given_count = count;
    return code;
}

static bool show_tried(void *user, size_t done, size_t total)
{
    struct planner *planner = user;
    const conus_so_far *so_far = &planner->so_far;
    char *more = planner->more;
    size_t size = 0;
    (void)total;
    *more = '\0';
    if (so_far->combination) {
        size = (size_t)snprintf(more, MORE_SIZE, "; combination %llu: ", (unsigned long long)so_far->combination);
        size += (size_t)snprintf(more + size, MORE_SIZE - size, isnan(so_far->leeway) ? "none yet" : "leeway %.2f mm",
                                 so_far->leeway);
        snprintf(more + size, MORE_SIZE - size, isnan(so_far->bound) ? "" : ", at most %.2f", so_far->bound);
    }
    progress_update(&planner->request.progress, done, 0);
    return !interrupt_signal();
}

static size_t count_listed(const struct planner *planner)
{
    size_t count = 0;
    while (conus_together_combination(planner->together, count)) {
        count++;
    }
    return count;
}

/* An answer that a signal ended is the best one by then. */
static int say_interrupted(struct planner *planner, conus_status status, int signal)
{
    if (status) {
        print_error_line("interrupted before a combination was found");
        return 128 + signal;
    }
    const size_t listed = count_listed(planner);
    const conus_combination *last = listed ? conus_together_combination(planner->together, listed - 1) : NULL;
    if (!last || !last->proven || !(last->last || listed == planner->options.top)) {
        say_warning(!last                      ? "interrupted: there is no combination, and why is not known whole"
                    : planner->options.top > 1 ? "interrupted: the combinations are the best ones by then"
                                               : "interrupted: the combination is the best one by then");
        planner->request.failed = true;
    }
    return EXIT_DONE;
}

static int search(struct planner *planner)
{
    const struct plan_settings *settings = planner->settings;
    conus_question questions[ROW_MOST] = {0};
    for (size_t i = 0; i < planner->count; i++) {
        struct question_row *row = &planner->rows[i];
        questions[i] = (conus_question){.needles = row->name,
                                        .once = row->once,
                                        .selector = row->answerer.selector,
                                        .constraints = row->constraints.items,
                                        .constraint_count = row->constraints.count,
                                        .options = &row->options,
                                        .open = open_again,
                                        .close = close_candidates,
                                        .user = row,
                                        .parts = row->parts,
                                        .arc = row->arc,
                                        .contacts = row->contacts,
                                        .part_count = row->settings.needles.parts.count};
    }
    int code = planner->options.differ <= planner->name_count
                   ? take_given(planner)
                   : print_usage_error("--diverse: in %d needles, but there are %zu", (int)planner->options.differ,
                                       planner->name_count);
    code = code ? code : request_check_outputs(&planner->request);
    if (code) {
        return code;
    }
    planner->options.progress = show_tried;
    planner->options.progress_user = planner;
    planner->options.so_far = &planner->so_far;
    progress_start(&planner->request.progress, (enum progress_kind)settings->progress, settings->request.common.quiet,
                   "poses", 0);
    planner->request.progress.more = planner->more;
    interrupt_catch(NULL);
    conus_status status = conus_plan_together(&planner->together, questions, planner->count, &planner->options);
    interrupt_release();
    progress_finish(&planner->request.progress, 0, 0);
    int signal = interrupt_signal();
    return signal && (!status || status == CONUS_ERROR_CANCELLED) ? say_interrupted(planner, status, signal)
                                                                  : print_status(status);
}

/* Whether a needle that is not given may answer a question. */
static bool is_asked(const struct planner *planner, const conus_answered *question)
{
    bool is = false;
    for (size_t i = 0; i < question->needle_count; i++) {
        is = is || !conus_together_needle(planner->together, question->needles[i])->given;
    }
    return is;
}

/* Says candidates that are none; a row without any is an error. */
static int check_rows(struct planner *planner)
{
    int code = EXIT_DONE;
    for (size_t i = 0; i < planner->count && !code; i++) {
        const conus_answered *question = conus_together_question(planner->together, i);
        const struct question_row *row = &planner->rows[i];
        if (is_asked(planner, question)) {
            code = plan_check_candidates(&planner->request.failed, question->plan, &row->settings, &row->candidates);
        }
    }
    return code;
}

/* Says why a needle alone has no place: of its candidates how many are left by which constraint, of a given one the
 * first constraint that it breaks. */
static int say_alone(const struct planner *planner, size_t index)
{
    const conus_placed *placed = conus_together_needle(planner->together, index);
    int code = EXIT_DONE;
    for (size_t i = 0; i < placed->question_count && !placed->given && !code; i++) {
        const conus_answered *question = conus_together_question(planner->together, placed->questions[i]);
        code = plan_say_funnel(question->plan, question->radius);
    }
    if (!placed->given) {
        return code;
    }
    const conus_answered *question = conus_together_question(planner->together, placed->questions[0]);
    conus_table *constraints = NULL;
    conus_status status = conus_plan_list(&constraints, question->plan, "constraints");
    if (!status) {
        print_error_line("%s is given, and breaks %s", placed->name,
                         conus_table_texts(constraints, "asked")[placed->given->broken]);
    }
    conus_table_destroy(constraints);
    return print_status(status);
}

/* "A, C: no combination: at most 3.2 of 5 mm between them, or entries 7.9 of 10 mm apart" */
static int say_conflict(const struct planner *planner)
{
    const conus_conflict *conflict = conus_together_conflict(planner->together);
    const size_t listed = count_listed(planner);
    char names[512] = "";
    char why[256] = "";
    size_t size = 0;
    if (!conflict) {
        if (!listed) {
            print_error_line("no combination was found, and none is proven not to be there; --effort lets the search "
                             "go on");
        } else if (listed < planner->options.top) {
            bool is_last = conus_together_combination(planner->together, listed - 1)->last;
            print_error_line(is_last ? "note: %zu of %llu combinations: no other one differs by so much"
                                     : "note: %zu of %llu combinations: no other one was found, and none is proven not "
                                       "to be there; --effort lets the search go on",
                             listed, (unsigned long long)planner->options.top);
        }
        return EXIT_DONE;
    }
    for (size_t i = 0; i < conflict->count && size < sizeof names; i++) {
        const conus_placed *placed = conus_together_needle(planner->together, conflict->needles[i]);
        size += (size_t)snprintf(names + size, sizeof names - size, "%s%s", i ? ", " : "", placed->name);
    }
    if (isfinite(conflict->between)) {
        snprintf(why, sizeof why, ": at most %.9g of %.9g mm between them", conflict->between,
                 planner->options.between);
    }
    if (isfinite(conflict->entry_distance)) {
        size = strlen(why);
        snprintf(why + size, sizeof why - size, "%s entries %.9g of %.9g mm apart", size ? ", or" : ":",
                 conflict->entry_distance, planner->options.entry_distance);
    }
    const struct {
        const char *what;
        uint64_t found, asked;
    } limits[] = {{"arcs", conflict->arcs_most, planner->options.arcs_most},
                  {"needles on an arc", conflict->arcs_each, planner->options.arcs_each}};
    for (size_t i = 0; i < 2; i++) {
        if (limits[i].found) {
            size = strlen(why);
            snprintf(why + size, sizeof why - size, "%s %llu %s are needed, %llu allowed", size ? ", or" : ":",
                     (unsigned long long)limits[i].found, limits[i].what, (unsigned long long)limits[i].asked);
        }
    }
    for (size_t i = 0; i < planner->options.cover_count && conflict->by_limits; i++) {
        if (isfinite(conflict->contacts[i])) {
            size = strlen(why);
            snprintf(why + size, sizeof why - size, "%s at most %.0f of %llu contacts in %.40s", size ? ", or" : ":",
                     conflict->contacts[i], (unsigned long long)planner->covers[i].contacts, planner->covers[i].names);
        }
    }
    if (!*why && conflict->by_limits) {
        snprintf(why, sizeof why, ": %s; no other limit of one alone was found to do",
                 !planner->options.cover_count ? "on so few arcs, with so few on each"
                 : planner->options.arcs > 0   ? "on so few arcs, with so many contacts"
                                               : "with so many contacts");
    } else if (!*why && conflict->count > 1) {
        snprintf(why, sizeof why, ": neither another margin of shafts nor another distance of entries alone would do");
    }
    print_error_line("%s%sno combination%s", names, *names ? ": " : "", why);
    return conflict->count == 1 && !conflict->by_limits ? say_alone(planner, conflict->needles[0]) : EXIT_DONE;
}

static int make_reports(struct planner *planner)
{
    struct request *request = &planner->request;
    conus_report_options options = request_report_options(request);
    options.rows = "needles";
    conus_status status = request_report(request, 0, &options);
    status = status ? status : conus_report_add_together(request->answerers[0].report, planner->together);
    struct asked asked = {.together = planner->together};
    status = status ? status : rows_files_add(&request->rows, 0, request->answerers[0].selector, NULL, &asked);
    return print_status(status);
}

static int list_inputs(struct provenance *out, const struct planner *planner)
{
    const struct plan_settings *settings = planner->settings;
    size_t apart = 0;
    request_list_inputs(out, &planner->request);
    provenance_add_input(out, settings->needles.file);
    provenance_add_input(out, settings->needles.given);
    for (size_t i = 0; i < planner->count; i++) {
        const struct question_row *row = &planner->rows[i];
        provenance_add_input(out, row->settings.request.aim.pose);
        candidates_list_inputs(out, &row->candidates);
        for (size_t k = 0; k < row->constraints.count && apart < FILES_MOST; k++) {
            if (row->constraints.items[k].kind == CONUS_CONSTRAINT_APART) {
                provenance_add_input(out, row->constraints.texts[k]);
                apart = out->input_count;
            }
        }
    }
    return apart < FILES_MOST ? EXIT_DONE
                              : print_usage_error("%s: more than %d files", settings->needles.file, FILES_MOST);
}

static int write_poses(const struct planner *planner)
{
    const size_t needles = conus_together_count(planner->together);
    const size_t count = count_listed(planner) * needles;
    struct written_pose *poses = calloc(count + 1, sizeof *poses);
    bool whole = poses;
    for (size_t i = 0; i < count && whole; i++) {
        const conus_chosen *chosen = &conus_together_combination(planner->together, i / needles)->chosen[i % needles];
        const struct constraints *constraints = &planner->rows[chosen->question].constraints;
        const char *needle = conus_together_needle(planner->together, i % needles)->name;
        size_t size = strlen(needle) + 8;
        char *name = malloc(size);
        poses[i] = (struct written_pose){
            .id = name, .pose = chosen->pose, .shanks = constraints->shanks, .shank_count = constraints->shank_count};
        whole = name;
        if (name && planner->options.top > 1) {
            snprintf(name, size, "%zu-%s", i / needles + 1, needle);
        } else if (name) {
            snprintf(name, size, "%s", needle);
        }
    }
    int code = whole ? candidates_write(planner->settings->poses_out, poses, count, &planner->request.frame)
                     : print_no_memory();
    for (size_t i = 0; poses && i < count; i++) {
        free((char *)poses[i].id);
    }
    free(poses);
    return code;
}

static int write_candidates(const struct planner *planner)
{
    const size_t needles = conus_together_count(planner->together);
    struct written_pose *poses = NULL;
    size_t count = 0;
    int code = EXIT_DONE;
    for (size_t i = 0; i < needles && !code; i++) {
        const conus_chosen *chosen = NULL;
        size_t more = 0;
        code = print_status(conus_together_candidates(&chosen, &more, planner->together, i));
        struct written_pose *longer = code ? NULL : realloc(poses, (count + more + 1) * sizeof *poses);
        poses = longer ? longer : poses;
        code = code || longer ? code : print_no_memory();
        for (size_t k = 0; k < more && longer; k++) {
            poses[count++] = (struct written_pose){.id = chosen[k].pose->id,
                                                   .pose = chosen[k].pose,
                                                   .needle = conus_together_needle(planner->together, i)->name,
                                                   .row = chosen[k].question + 1,
                                                   .number = chosen[k].candidate,
                                                   .counts_contacts = planner->options.cover_count,
                                                   .contacts = chosen[k].contacts};
        }
    }
    code = code ? code : candidates_write(planner->settings->needles.candidates, poses, count, &planner->request.frame);
    free(poses);
    return code;
}

static int write_all(struct planner *planner)
{
    struct request *request = &planner->request;
    const struct plan_settings *settings = planner->settings;
    struct provenance provenance = {0};
    int code = list_inputs(&provenance, planner);
    provenance.question.region = "axis";
    code = code ? code : rows_files_write(&request->rows, &provenance);
    code = code || !settings->poses_out ? code : write_poses(planner);
    code = code || !settings->needles.candidates ? code : write_candidates(planner);
    provenance.question.rows = "needles";
    return code ? code : request_write_answer(request, &provenance);
}

static int answer(struct planner *planner)
{
    struct request *request = &planner->request;
    const struct plan_settings *settings = planner->settings;
    int code = request_load(request, open_nothing, NULL);
    code = code ? code : open_rows(planner);
    if (code) {
        return code;
    }
    const conus_selector_options engine = plan_engine(settings, &planner->rows[0].constraints);
    code = print_status(request_start(request, &engine));
    code = code ? code : search(planner);
    code = code ? code : check_rows(planner);
    code = code ? code : make_reports(planner);
    if (code) {
        return code;
    }
    request_say_notes(request);
    code = say_conflict(planner);
    if (!code && !settings->request.common.quiet) {
        print_error_line("note: a plan is a list to be checked; conus is no medical device");
    }
    return request_code(request, code ? code : write_all(planner));
}

static void finish_row(struct question_row *row)
{
    conus_pose_stream_destroy(row->request.stream);
    constraints_finish(&row->constraints);
    candidates_finish(&row->candidates);
    conus_selector_destroy(row->answerer.selector);
    if (row->was_parsed) {
        options_finish(&row->settings, &row->arguments);
    }
    for (int i = 0; i < row->word_count; i++) {
        free(row->words[i]);
    }
    free(row->words);
    free(row->parts);
}

int plan_needles(const struct plan_settings *settings, const struct arguments *arguments)
{
    struct planner *planner = calloc(1, sizeof *planner);
    if (!planner) {
        return print_no_memory();
    }
    planner->settings = settings;
    planner->arguments = arguments;
    planner->options =
        (conus_together_options){.entry_distance = settings->needles.entry_distance,
                                 .effort = !option_given(arguments, "effort") ? 0
                                           : settings->needles.effort ? UINT64_C(1000000) * settings->needles.effort
                                                                      : UINT64_MAX};
    bool fits = read_between(&planner->options, settings->needles.between) &&
                read_arcs(planner, settings->needles.arcs) && read_covers(planner) &&
                read_list(&planner->options, settings) && space_settings_check(arguments, &settings->request.aim.space);
    int code = fits ? read_table(planner) : EXIT_USAGE;
    code = code ? code : request_init(&planner->request, &settings->request, arguments);
    code = code ? code : answer(planner);
    conus_together_destroy(planner->together);
    for (size_t i = 0; i < planner->count; i++) {
        finish_row(&planner->rows[i]);
    }
    request_finish(&planner->request);
    for (size_t i = 0; i < planner->name_count; i++) {
        free(planner->names[i]);
    }
    for (size_t i = 0; i < COVER_MOST; i++) {
        free(planner->cover_names[i]);
    }
    free(planner->places);
    conus_pose_list_destroy(planner->given);
    free(planner->text);
    free(planner);
    return code;
}
