/* SPDX-License-Identifier: BSD-3-Clause */
/* conus report: what a lab shows of a result: pictures, tables, methods, references and how to repeat it. */
#include "base/path.h"
#include "base/system/system.h"
#include "cli/answers/answers.h"
#include "cli/commands.h"
#include "cli/verify/verify.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"

#include <stdlib.h>
#include <string.h>

enum { PARTS = 20, ROWS = 10 };
static const uint64_t LIMIT = UINT64_C(1) << 28; /* bytes of a result */

struct report_settings {
    struct common_settings common;
    const char *output;
};

static const struct option own_options[] = {
    {OPTION_VALUED("output", struct report_settings, output, "FOLDER"), .letter = 'o',
     .help = "folder for the files, which is made and must not be there", .required = true, .words = "save, export",
     .common = true, OPTION_WRITING(FOLDER)},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct report_settings, common)},
    {0},
};

/* A report on the way. */
struct report {
    const char *result;
    char *folder;  /* whole */
    char *sidecar; /* its path */
    struct record record;
    struct results rows;
    struct replay replay;
    char *ran; /* the folder in which conus ran */
};

/* A column of the report. Numbers have so many digits; a share is in percent. */
struct shown {
    const char *column, *head;
    bool is_share;
    int digits;
};

static const struct shown shown[] = {
    {"rank", "Rank", false, 0},
    {"name", "Area", false, 0},
    {"share", "Share", true, 1},
    {"region_fraction", "Of the region", true, 1},
    {"fraction", "Of the area", true, 1},
    {"distance_mm", "Distance, mm", false, 1},
    {"volume_mm3", "Volume in it, mm³", false, 0},
};
enum { NAME = 1, SHOWN = sizeof shown / sizeof shown[0] };

/* The cell in the column of this name; NULL where there is none, or it says nothing. */
static const char *cell(const struct report *report, size_t row, const char *name)
{
    size_t column;
    const char *text = results_column(&report->rows, name, &column) ? results_cell(&report->rows, row, column) : NULL;
    return text && *text && strcmp(text, "n/a") != 0 ? text : NULL;
}

static void put_html(FILE *out, const char *text)
{
    html_put(out, text, strlen(text));
}

static void put_number(FILE *out, const char *text, const struct shown *how)
{
    double number;
    if (!number_parse(text, &number)) {
        put_html(out, text);
    } else if (how->is_share) {
        fprintf(out, "%.*f %%", how->digits, 100 * number);
    } else {
        fprintf(out, "%.*f", how->digits, number);
    }
}

static bool is_rest(const struct report *report, size_t row)
{
    const char *kind = cell(report, row, "kind");
    return kind && strcmp(kind, "unassigned") == 0;
}

/* A part: the rows of one query and atlas, from `first` on; `best` is its first of an object, SIZE_MAX without one. */
struct part {
    size_t first, end, best;
};

static bool same_cell(const struct report *report, size_t row, size_t other, const char *name)
{
    const char *a = cell(report, row, name);
    const char *b = cell(report, other, name);
    return a && b ? strcmp(a, b) == 0 : !a && !b;
}

static struct part part_from(const struct report *report, size_t first)
{
    struct part part = {.first = first, .end = first, .best = SIZE_MAX};
    while (part.end < report->rows.rows && same_cell(report, first, part.end, "query") &&
           same_cell(report, first, part.end, "atlas")) {
        bool is_best = part.best == SIZE_MAX && !is_rest(report, part.end) && cell(report, part.end, "name");
        part.best = is_best ? part.end : part.best;
        part.end++;
    }
    return part;
}

/* ": 66.1 % of the region", by the share of a row that has one, else ": at 3.2 mm"; nothing of a rest of 0. */
static void put_share(FILE *out, const struct report *report, size_t row)
{
    const json_t *question = json_object_get(report->record.root, "Question");
    const char *region = json_string_value(json_object_get(question, "region"));
    bool is_cone = region && strcmp(region, "cone") == 0 && !option_text(&report->replay.arguments, "weight");
    const char *share = cell(report, row, "share");
    const char *part = cell(report, row, "region_fraction");
    const char *distance = cell(report, row, "distance_mm");
    double number;
    if ((share || part) && number_parse(share ? share : part, &number) && (number > 0 || !is_rest(report, row))) {
        fprintf(out, "%s%.1f %%%s", is_rest(report, row) ? "; in no area: " : ": ", 100 * number,
                !share    ? " of the region"
                : is_cone ? " of the cone"
                          : "");
    } else if (!share && !part && distance && number_parse(distance, &number) && number > 0) {
        fprintf(out, ": at %.1f mm", number);
    }
}

/* "Insula_L: 66.1 % of the cone; in no area: 21.0 % of the cone" */
static void put_title(FILE *out, const struct report *report, struct part part)
{
    size_t last = part.end - 1;
    put_html(out, part.best == SIZE_MAX ? "Nothing is hit" : cell(report, part.best, "name"));
    if (part.best != SIZE_MAX) {
        put_share(out, report, part.best);
    }
    if (last != part.best && is_rest(report, last)) {
        put_share(out, report, last);
    }
}

static void put_table(FILE *out, const struct report *report, struct part part)
{
    bool says[SHOWN] = {false};
    for (size_t row = part.first; row < part.end; row++) {
        for (size_t i = 0; i < SHOWN; i++) {
            says[i] = says[i] || cell(report, row, shown[i].column);
        }
    }
    fputs("<table><tr>", out);
    for (size_t i = 0; i < SHOWN; i++) {
        fprintf(out, says[i] ? "<th>%s</th>" : "", shown[i].head);
    }
    size_t listed = 0;
    for (size_t row = part.first; row < part.end; row++) {
        if (listed >= ROWS && !is_rest(report, row)) {
            continue;
        }
        listed++;
        fputs("</tr>\n<tr>", out);
        for (size_t i = 0; i < SHOWN; i++) {
            const char *text = cell(report, row, shown[i].column);
            fputs(says[i] ? "<td>" : "", out);
            if (says[i] && text) {
                put_number(out, is_rest(report, row) && i == NAME ? "in no area" : text, &shown[i]);
            }
            fputs(says[i] ? "</td>" : "", out);
        }
    }
    fputs("</tr></table>\n", out);
    if (listed < part.end - part.first) {
        fprintf(out, "<p class=\"small\">and %zu rows more, in ", part.end - part.first - listed);
        put_html(out, path_name(report->result));
        fputs("</p>\n", out);
    }
}

/* "FOLDER/NAME"; NULL without memory. The caller frees it. */
static char *path_in(const struct report *report, const char *name)
{
    char *path = NULL;
    return asprintf(&path, "%s/%s", report->folder, name) < 0 ? NULL : path;
}

/* Copies a file into the folder, by its own name. */
static int keep_file(const struct report *report, const char *from)
{
    char *path = path_in(report, path_name(from));
    int code = !path ? print_no_memory() : file_copy(from, path) ? EXIT_DONE : print_system_error(path, "write");
    free(path);
    return code;
}

/* Closes a text, which is a file of the folder where `code` is 0. */
static int end_file(const struct report *report, const char *name, struct system_text *text, int code)
{
    char *path = path_in(report, name);
    bool is_whole = system_text_close(text) && path;
    if (!code && is_whole) {
        conus_plain_text(text->data);
        code = print_status(conus_write_file(path, text->data, strlen(text->data)));
    }
    free(path);
    return code || is_whole ? code : print_no_memory();
}

/* The picture as a part of the page. */
static int put_picture(FILE *out, const struct report *report, const char *name, const char *what)
{
    char *path = path_in(report, name);
    fprintf(out, "<img alt=\"%s\" src=\"data:image/png;base64,", what);
    int code = path ? base64_put(out, path) : print_no_memory();
    fputs("\">\n", out);
    free(path);
    return code;
}

static bool is_asked(const struct option *option)
{
    return option->role <= OPTION_ASKS || (option->role >= OPTION_READS && option->role <= OPTION_READS_POSES);
}

/* The first part of the question that conus render cannot be asked; NULL where it can. */
static const char *not_drawn(const struct report *report)
{
    const struct arguments *arguments = &report->replay.arguments;
    if (strcmp(report->replay.command->name, "query") != 0) {
        return report->replay.command->name;
    }
    for (size_t i = 0; i < arguments->use_count; i++) {
        const struct option *option = arguments->uses[i].option;
        if (is_asked(option) && !option_find(&cmd_render, option->name)) {
            return option->name;
        }
    }
    return part_from(report, 0).end < report->rows.rows ? "several poses or atlases" : NULL;
}

/* Asks conus render the recorded question, in the folder where it was asked; @p more are its last words. */
static int draw(const struct report *report, const char *name, const char *const *more)
{
    const struct arguments *asked = &report->replay.arguments;
    struct command_words words = {0};
    char *path = path_in(report, name);
    words_put(&words, NULL, "conus");
    words_put(&words, NULL, "render");
    for (size_t i = 0; i < asked->use_count; i++) {
        if (is_asked(asked->uses[i].option)) {
            words_put(&words, asked->uses[i].option->name, asked->uses[i].value);
        }
    }
    for (; *more; more++) {
        words_put(&words, NULL, *more);
    }
    words_put(&words, "output", path);
    words_put(&words, NULL, "--");
    words_put(&words, NULL, asked->operands[0]);
    int code = path ? words_run(&words, &cmd_render, *report->ran ? report->ran : ".") : print_no_memory();
    words_finish(&words);
    free(path);
    return code;
}

static const char style[] =
    "@page{size:33.87cm 19.05cm;margin:1cm}body{font:16px/1.4 \"Liberation Sans\",Arial,sans-serif;color:#1c2024;"
    "max-width:1200px;margin:2em auto;padding:0 1em}h1{font-size:28px;line-height:1.2;margin:0 0 .4em}"
    "h2{font-size:18px;margin:1.4em 0 .4em}img{max-width:100%;max-height:15cm;display:block}"
    ".two{display:grid;grid-template-columns:3fr 2fr;gap:1.5em;align-items:start}table{border-collapse:collapse;"
    "font-variant-numeric:tabular-nums}th,td{padding:.25em .8em;text-align:right;border-bottom:1px solid #d0d5da}"
    "th:nth-child(2),td:nth-child(2){text-align:left}.small,footer{font-size:13px;color:#50575e}"
    "code{font-size:13px;overflow-wrap:anywhere}.warning{border-left:4px solid #b42318;padding-left:.8em}"
    "@media print{section{break-after:page}body{margin:0;max-width:none}}";

static void put_warnings(FILE *out, const struct report *report)
{
    size_t i;
    const json_t *line;
    json_array_foreach(json_object_get(report->record.root, "Warnings"), i, line)
    {
        fputs("<p class=\"warning\">Warning: ", out);
        put_html(out, json_is_string(line) ? json_string_value(line) : "");
        fputs("</p>\n", out);
    }
}

static int put_parts(FILE *out, const struct report *report, bool is_drawn)
{
    int code = EXIT_DONE;
    size_t parts = 0;
    size_t left = 0;
    struct part part;
    for (size_t first = 0; !code && first < report->rows.rows; first = part.end) {
        part = part_from(report, first);
        if (++parts > PARTS) {
            left++;
            continue;
        }
        fputs("<section><h1>", out);
        for (size_t i = 0; (first || part.end < report->rows.rows) && i < 2; i++) {
            const char *which = cell(report, first, i ? "atlas" : "query");
            put_html(out, which ? which : "");
            fputs(which ? ": " : "", out);
        }
        put_title(out, report, part);
        fputs("</h1>\n", out);
        put_warnings(out, report);
        fputs(is_drawn ? "<div class=\"two\">" : "", out);
        code = is_drawn ? put_picture(out, report, "brain.png", "the cone in the brain") : EXIT_DONE;
        fputs(is_drawn ? "<div>" : "", out);
        put_table(out, report, part);
        fputs(is_drawn ? "</div></div>" : "", out);
        fputs("</section>\n", out);
    }
    if (left) {
        fprintf(out, "<p>and %zu more, in ", left);
        put_html(out, path_name(report->result));
        fputs("</p>\n", out);
    }
    if (!code && is_drawn) {
        fputs("<section><h2>Cuts through the best hit</h2>\n", out);
        code = put_picture(out, report, "cuts.png", "cuts");
        fputs("</section>\n", out);
    }
    return code;
}

static int put_page(FILE *out, const struct report *report, const char *methods, const char *undrawn)
{
    const char *end = strstr(methods, "\n\n");
    const char *references = end ? end + 2 : methods + strlen(methods);
    fprintf(out,
            "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta http-equiv=\"Content-Security-Policy\" "
            "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'\"><title>conus: ");
    put_html(out, path_name(report->result));
    fprintf(out, "</title><style>%s</style>\n", style);
    int code = put_parts(out, report, !undrawn);
    fputs("<section><h2>Methods</h2><p>", out);
    html_put(out, methods, (size_t)(references - methods));
    fputs("</p><h2>References</h2>\n", out);
    for (const char *line = references; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        fputs("<p class=\"small\">", out);
        html_put(out, line, strcspn(line, "\n"));
        fputs("</p>\n", out);
    }
    char *asked = arguments_text(&report->replay.arguments);
    fputs("<h2>To repeat</h2><p><code>", out);
    put_html(out, asked ? asked : "");
    free(asked);
    fputs("</code></p>\n<footer>", out);
    if (undrawn) {
        fputs("No picture: conus render draws one pose of conus query (here: ", out);
        put_html(out, undrawn);
        fputs("). ", out);
    }
    fprintf(out, "conus %s. Answered again before this page was made, with the same rows: <code>conus verify ",
            report->record.version);
    put_html(out, path_name(report->result));
    fputs("</code>. Not a medical device.</footer></section></html>\n", out);
    return code;
}

static int write_page(const struct report *report, const char *methods, const char *undrawn)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    int code = end_file(report, "report.html", &text, out ? put_page(out, report, methods, undrawn) : EXIT_DONE);
    free(text.data);
    return code;
}

/* Writes what conus cite says, and gives it. */
static int write_citation(char **said, const struct report *report, const char *name, bool is_bibtex)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    int code = end_file(report, name, &text, out ? cite_put(out, report->result, is_bibtex) : EXIT_DONE);
    *said = text.data;
    return code;
}

static int write_all(const struct report *report)
{
    static const char *const brain[] = {"--size=1600x1200", "--style=print", "--quiet", NULL};
    static const char *const cuts[] = {"--cuts=axial,coronal,sagittal", "--size=1800x640", "--style=print", "--quiet",
                                       NULL};
    const char *undrawn = not_drawn(report);
    char *methods = NULL;
    char *entries = NULL;
    int code = keep_file(report, report->result);
    code = code ? code : keep_file(report, report->sidecar);
    code = code ? code : write_citation(&methods, report, "methods.txt", false);
    code = code ? code : write_citation(&entries, report, "references.bib", true);
    code = code || undrawn ? code : draw(report, "brain.png", brain);
    code = code || undrawn ? code : draw(report, "cuts.png", cuts);
    code = code ? code : write_page(report, methods, undrawn);
    free(methods);
    free(entries);
    return code;
}

/* Whether the report has another file of the result's name. */
static bool is_taken(const char *result)
{
    static const char *const own[] = {"report.html", "methods.txt", "references.bib", "brain.png", "cuts.png"};
    bool is = false;
    for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
        is = is || strcmp(path_name(result), own[i]) == 0;
    }
    return is;
}

/* Reads the result and the record of how it was made. */
static int read_result(struct report *report, const struct command *const *commands)
{
    if (is_taken(report->result)) {
        return print_data_error("%s: a report has a file of its own of this name", report->result);
    }
    char *text = NULL;
    size_t size = 0;
    int code = input_file_read(&text, &size, report->result, INPUT_FILE, LIMIT);
    code = code ? code : results_parse(&report->rows, report->result, text, size);
    free(text);
    if (code) {
        return code;
    }
    report->sidecar = sidecar_find(report->result);
    if (!report->sidecar) {
        return print_data_error("%s: no .json of conus is beside it, which says how it was made", report->result);
    }
    code = record_read(&report->record, report->sidecar);
    if (code) {
        return code;
    }
    const struct recorded_file *outputs = report->record.outputs;
    const char *written = report->record.output_count ? outputs[report->record.output_count - 1].path : NULL;
    report->ran = recorded_folder(written, report->result);
    report->replay.record = &report->record;
    if (!report->ran || !replay_check(&report->replay, commands)) {
        return print_data_error("%s: %s", report->result, report->ran ? report->replay.why : "not enough memory");
    }
    const char *name = report->replay.command->name;
    const char *kind = json_string_value(json_object_get(json_object_get(report->record.root, "Question"), "rows"));
    size_t column;
    bool answers = kind && strcmp(kind, strcmp(name, "overlap") == 0 ? "coverages" : "answers") == 0;
    return answers && results_column(&report->rows, "name", &column)
               ? EXIT_DONE
               : print_data_error("%s: a report is made of the answers of conus query, batch and overlap",
                                  report->result);
}

/* Makes the folder and keeps its whole path. */
static int make_folder(struct report *report, const char *folder)
{
    char real[SYSTEM_PATH];
    if (!system_make_folder(folder, false)) {
        return print_system_error(folder, "make");
    }
    report->folder = system_real_path(real, folder) ? strdup(real) : NULL;
    return report->folder ? EXIT_DONE : print_system_error(folder, "open");
}

static int run_report(const void *given, const struct arguments *arguments)
{
    const struct report_settings *settings = given;
    const struct verify_settings verify = {0};
    struct report report = {.result = arguments->operands[0]};
    bool is_there = system_allows(settings->output, 0);
    int code =
        is_there ? print_data_error("%s: is there already", settings->output) : read_result(&report, arguments->family);
    code = code ? code : verify_result(report.result, &verify, arguments->family, false);
    code = code ? code : make_folder(&report, settings->output);
    code = code ? code : write_all(&report);
    replay_finish(&report.replay);
    record_finish(&report.record);
    results_finish(&report.rows);
    free(report.sidecar);
    free(report.folder);
    free(report.ran);
    return code;
}

const struct command cmd_report = {
    .name = "report",
    .summary = "write a page about a result: pictures, table, methods, references",
    .operands = {"RESULT"},
    .holds = {HOLDS_ROWS},
    .form = "-o FOLDER",
    .description =
        "RESULT is a table with its .json beside it, as conus cite takes it. It is answered again first, as conus\n"
        "verify does: where that differs, there is no report. FOLDER gets report.html, which prints as pages of\n"
        "16:9, with all in one file; RESULT and its .json; methods.txt and references.bib; and of one pose of\n"
        "conus query brain.png and cuts.png.",
    .examples = "  conus report answers.tsv -o answers-report\n",
    .groups = groups,
    .settings_size = sizeof(struct report_settings),
    .run = run_report,
};
