/* SPDX-License-Identifier: BSD-3-Clause */
/* conus page: one HTML file with the atlas, a question and its answer inside. */
#include "cli/commands.h"

#include "base/path.h"
#include "base/system/system.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include "conus/own.h"

#include <jansson.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_LIMIT = 4096, SIZE_LIMIT = 100000000, TEMPLATE_LIMIT = 1 << 28 };

/* From the program's folder: that of a release or a wheel, and an installation's. */
static const char *const template_names[] = {"page.html", "../share/conus/page.html"};
/* Where the template takes the atlas. */
static const char mark[] = "<!-- atlas -->";

static const struct option output_options[] = {
    {OPTION_VALUED("output", struct page_settings, output, "FILE.html"), .letter = 'o', .help = "the page",
     .required = true, .endings = ".html", .words = "save, export, share", .common = true, OPTION_WRITING(PAGE)},
    {0},
};

static const struct option aim_of_page[] = {
    {OPTION_VALUED("origin", struct page_settings, origin, PLACE_VALUE), .help = "where the cone begins: " PLACE_HELP,
     .role = OPTION_ASKS, .flags = OPTION_IS_PLACE, .needs = "toward", .common = true},
    {OPTION_VALUED("toward", struct page_settings, toward, PLACE_VALUE),
     .help = "a place that the cone's axis goes through", .role = OPTION_ASKS, .flags = OPTION_IS_PLACE,
     .needs = "origin", .common = true},
    {0},
};

static const struct option page_options[] = {
    {OPTION_VALUED("context", struct page_settings, context, "FILE"),
     .help = "an image that the cuts show below the areas, put into the page, too: a file, or the name of an installed "
             "one",
     .words = "T1, MRI", .role = OPTION_READS_IMAGE, .holds = HOLDS_VOLUME},
    {OPTION_VALUED("template", struct page_settings, template, "FILE.html"), .help = "the page without an atlas",
     .otherwise = "page.html beside this program, or in ../share/conus", OPTION_READING(PAGE)},
    {OPTION_NAMED("large", struct page_settings, large), .help = "write a page whose files have more than 100 MB",
     .role = OPTION_OF_RUN},
    {0},
};

static const struct option force_options[] = {
    {OPTION_NAMED("force", struct page_settings, force), .help = "replace a file", .role = OPTION_OF_RUN},
    {0},
};

static const struct option quiet_option[] = {
    {OPTION_NAMED("quiet", struct page_settings, common.quiet), .letter = 'q',
     .help = "print only errors and warnings on stderr, no notes", .role = OPTION_OF_RUN},
    {0},
};

static const struct option_group groups[] = {
    {"Options", output_options, 0},
    {"", aim_of_page, 0},
    {"", page_question_options, offsetof(struct page_settings, question)},
    {"", ray_options, offsetof(struct page_settings, question.selector)},
    {"", page_options, 0},
    {"", force_options, 0},
    {"", quiet_option, 0},
    {"", plain_options, offsetof(struct page_settings, common)},
    {0},
};

const struct option_group page_view_groups[] = {
    {"Options", aim_of_page, 0},
    {"", page_question_options, offsetof(struct page_settings, question)},
    {"", ray_options, offsetof(struct page_settings, question.selector)},
    {"", page_options, 0},
    {"", quiet_option, 0},
    {"", plain_options, offsetof(struct page_settings, common)},
    {0},
};

/* A file that was read. */
struct page_file {
    const char *path; /* by which it was read */
    char *whole;      /* the same from the root on, without "." and ".." */
    const char *name; /* in the page; within `whole` */
    bool is_context;  /* that of --context, or read with it */
};

struct page {
    const struct page_settings *settings;
    conus_atlas *atlas;
    struct page_file files[FILE_LIMIT]; /* the one to open first, and those of --context at the end */
    size_t count;
    size_t seen;                /* of all inputs of the program */
    const char *context_folder; /* what stands before the names of those */
    FILE *out;
};

/* The path from the root on, without "." and "..", as the page's file system would understand it. NULL without memory;
 * the caller frees it. */
static char *whole_path(const char *path)
{
    char here[SYSTEM_PATH] = "";
    bool is_known = path_is_whole(path) || system_here(here);
    size_t size = strlen(here);
    char *out = is_known ? malloc(size + strlen(path) + 2) : NULL;
    char *end = out ? (char *)memcpy(out, here, size) + size : NULL;
    const char *rest = path;
    const char *at;
    size_t length;
    while (out && path_part(&rest, &at, &length)) {
        if (length == 2 && at[0] == '.' && at[1] == '.') {
            size_t above = path_length_above(out, (size_t)(end - out));
            end = out + above - (above > 0);
        } else if (length && !(length == 1 && at[0] == '.')) {
            *end = '/';
            memcpy(end + 1, at, length);
            end += 1 + length;
        }
    }
    if (out) {
        *end = '\0';
    }
    return out;
}

/* Adds a file once by each of its names: the page asks for all of them. */
static int add_file(struct page *page, const char *path, bool is_context)
{
    char *whole = whole_path(path);
    if (!whole) {
        return print_system_error(path, "find");
    }
    for (size_t i = 0; i < page->count; i++) {
        if (page->files[i].is_context == is_context && strcmp(page->files[i].whole, whole) == 0) {
            free(whole);
            return EXIT_DONE;
        }
    }
    if (page->count == FILE_LIMIT) {
        free(whole);
        return print_data_error("a page holds at most %d files", FILE_LIMIT);
    }
    page->files[page->count++] = (struct page_file){path, whole, whole, is_context};
    return EXIT_DONE;
}

/* Whether it was looked for where the environment says: in a page it lies beside the atlas. */
static bool is_of_freesurfer(const struct page_file *file)
{
    const char *home = system_variable("FREESURFER_HOME");
    return home && *home && strncmp(file->path, home, strlen(home)) == 0;
}

/* Adds what was read since: `path`, which is opened first, and what was read with it. They keep their places below the
 * folder that all are in. */
static int list_files(struct page *page, const char *path, bool is_context)
{
    size_t first = page->count;
    const char *input;
    struct system_stat info;
    const conus_pack_info *pack = conus_atlas_pack_info(page->atlas);
    if (pack && !is_context) {
        const char *source = conus_atlas_pack_source(NULL, page->atlas, 0);
        return print_data_error("%s: a page needs the files that it was packed from: %s%s", path,
                                source ? source : "they are not known", pack->source_count > 1 ? ", ..." : "");
    }
    if (!system_stat(&info, path) || info.kind != SYSTEM_FILE) {
        return print_data_error("%s: a page opens one file, perhaps a manifest that names others; no folder, no store "
                                "and no part of a file",
                                path);
    }
    int code = add_file(page, path, is_context);
    for (; !code && (input = conus_inputs_at(page->seen)); page->seen++) {
        code = add_file(page, input, is_context);
    }
    if (code) {
        return code;
    }
    const char *whole = page->files[first].whole;
    size_t folder = (size_t)(path_name(whole) - whole);
    for (size_t i = first + 1; i < page->count; i++) {
        const struct page_file *file = &page->files[i];
        while (!is_of_freesurfer(file) && strncmp(file->whole, whole, folder) != 0) {
            folder = path_length_above(whole, folder - 1);
        }
    }
    for (size_t i = first; i < page->count; i++) {
        struct page_file *file = &page->files[i];
        file->name = is_of_freesurfer(file) ? path_name(file->whole) : file->whole + folder;
    }
    return EXIT_DONE;
}

static const char *folder_of(const struct page *page, const struct page_file *file)
{
    return file->is_context ? page->context_folder : "";
}

/* The context's files have a folder of their own where one of their names is taken. */
static void place_context(struct page *page)
{
    page->context_folder = "";
    for (size_t i = 0; i < page->count; i++) {
        for (size_t k = 0; k < i; k++) {
            bool taken = page->files[i].is_context && !page->files[k].is_context &&
                         strcmp(page->files[i].name, page->files[k].name) == 0;
            page->context_folder = taken ? "context/" : page->context_folder;
        }
    }
}

static bool same_objects(const conus_atlas *a, const conus_atlas *b)
{
    bool same = conus_atlas_object_count(a) == conus_atlas_object_count(b);
    for (size_t i = 1; same && i <= conus_atlas_object_count(a); i++) {
        same = strcmp(conus_atlas_object(a, i)->name, conus_atlas_object(b, i)->name) == 0;
    }
    return same;
}

/* Opens the atlas as a page does: where there is nothing else than the page's files, and no other program. */
static int open_as_page(struct page *page, const struct stage *stage)
{
    conus_atlas *atlas = NULL;
    char *path = NULL;
    char *context = NULL;
    const char *input = NULL;
    bool made = true;
    for (size_t i = 0; i < page->count && made; i++) {
        const struct page_file *file = &page->files[i];
        char target[SYSTEM_PATH];
        char *name = NULL;
        made = system_real_path(target, file->path) &&
               asprintf(&name, "%s%s", folder_of(page, file), file->name) >= 0 && stage_link(stage, name, target);
        if (made && (i == 0 || (file->is_context && !context))) {
            made = asprintf(i ? &context : &path, "%s/%s", stage->folder, name) >= 0;
        }
        free(name);
    }
    system_set_variable("CONUS_HDF5", "/dev/null");
    system_set_variable("FREESURFER_HOME", "");
    conus_status status = made ? conus_atlas_load(&atlas, path, NULL) : CONUS_ERROR_MEMORY;
    status = status || !context ? status : conus_atlas_set_context(atlas, context, NULL);
    int code = EXIT_DONE;
    if (status) {
        const char *why = conus_message();
        size_t length = strlen(stage->folder);
        why += strncmp(why, stage->folder, length) == 0 ? length + 1 : 0;
        code = print_data_error("%s: a page cannot open it: %s", page->files[0].path,
                                !made                       ? "its files cannot be laid out"
                                : strstr(why, "CONUS_HDF5") ? "no page reads HDF5"
                                                            : why);
    }
    for (; !code && (input = conus_inputs_at(page->seen)); page->seen++) {
        if (strncmp(input, stage->folder, strlen(stage->folder)) != 0) {
            code = print_data_error("%s: a page cannot open it: %s is named by its path from the root on; name it by "
                                    "one from the folder of its manifest",
                                    page->files[0].path, input);
        }
    }
    if (!code && !same_objects(atlas, page->atlas)) {
        code = print_data_error("%s: a page would call its areas otherwise: their names come from %s",
                                page->files[0].path, conus_atlas_label_source(page->atlas));
    }
    conus_atlas_destroy(atlas);
    free(path);
    free(context);
    return code;
}

static int check_opens(struct page *page)
{
    struct stage stage;
    int code = stage_begin(&stage, "page", 0) ? open_as_page(page, &stage) : EXIT_DATA;
    stage_end(&stage, false);
    return code;
}

static int put_file(FILE *out, const struct page_file *file, const char *folder, const char *role)
{
    fputs("<script type=\"application/octet-stream\" data-file=\"", out);
    html_put(out, folder, strlen(folder));
    html_put(out, file->name, strlen(file->name));
    fprintf(out, "\"%s>", role);
    int code = base64_put(out, file->path);
    fputs("</script>\n", out);
    return code;
}

static int check_size(const struct page *page)
{
    double sum = 0;
    for (size_t i = 0; i < page->count; i++) {
        struct system_stat state;
        sum += system_stat(&state, page->files[i].path) ? (double)state.size : 0;
    }
    if (sum > SIZE_LIMIT && !page->settings->large) {
        return print_data_error("the files have %.0f MB, 100 are allowed; --large writes the page all the same",
                                sum / 1e6);
    }
    return EXIT_DONE;
}

/* The question and the rows of its answer, as the page compares them with its own. */
static int put_question(struct page *page)
{
    const conus_frame frame = {.space = CONUS_SPACE_RAS,
                               .world_from_space = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
    struct named_places places = {.atlas = page->atlas, .frame = &frame};
    double o[3];
    double t[3];
    const struct page_settings *settings = page->settings;
    struct page_question question = settings->question;
    conus_selector_options options;
    conus_weight *weight = NULL;
    const conus_report_options rows = {.format = "ndjson"};
    conus_pose pose;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    int code = named_places_find_ends(o, t, &places, (const char *const[]){"origin", "toward"},
                                      (const char *const[]){settings->origin, settings->toward});
    if (!code && !settings->common.quiet) {
        named_places_say(&places);
    }
    named_places_finish(&places);
    if (code) {
        return code;
    }
    conus_status status = conus_pose_toward(&pose, o, t, NULL);
    status = status ? status : page_question_selector(&options, &weight, &question);
    question.angle = page_question_angle(&question, weight);
    status = status ? status : conus_selector_create(&selector, page->atlas, &options);
    status = status ? status : conus_select(&selection, selector, &pose, question.angle);
    status = status ? status : conus_report_create(&report, selector, &rows);
    status = status ? status : conus_report_add(report, "1", selection);
    status = status ? status : conus_report_text(&text, &size, report);
    code = print_status(status);
    if (!status) {
        struct system_text link;
        if (system_text_open(&link)) {
            fprintf(link.stream, "v=1&origin=%.17g,%.17g,%.17g&toward=%.17g,%.17g,%.17g", o[0], o[1], o[2], t[0], t[1],
                    t[2]);
            page_question_put(link.stream, &question);
        }
        json_t *asked = system_text_close(&link) ? json_pack("{s:s, s:s, s:s}", "fragment", link.data, "version",
                                                             conus_version(), "rows", text)
                                                 : NULL;
        char *json = asked ? json_dumps(asked, 0) : NULL;
        if (json) {
            fputs("<script type=\"application/json\" id=\"question\">", page->out);
            for (const char *c = json; *c; c++) { /* "<" could end a script */
                fputs(*c == '<' ? "\\u003c" : (char[]){*c, '\0'}, page->out);
            }
            fputs("</script>\n", page->out);
        }
        code = json ? EXIT_DONE : print_no_memory();
        free(json);
        json_decref(asked);
        free(link.data);
    }
    conus_report_destroy(report);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    conus_weight_destroy(weight);
    return code;
}

/* The template's text, the caller's to free. */
static int read_template(char **out, const char *given, const char *before)
{
    char path[SYSTEM_PATH];
    size_t folder = system_program(path) ? path_folder_length(path) : 0;
    bool is_there = given;
    for (size_t i = 0; !is_there && folder && i < sizeof template_names / sizeof template_names[0]; i++) {
        snprintf(path + folder, sizeof path - folder, "%s", template_names[i]);
        is_there = system_allows(path, 0);
    }
    const char *name = given ? given : path;
    char *text = NULL;
    size_t size = 0;
    if (!is_there) {
        return print_data_error("%sthe page's template is not installed: no page.html beside this program, and no %s "
                                "(Debian package conus-page); --template names one",
                                before, folder ? path : template_names[1]);
    }
    int code = input_file_read(&text, &size, name, INPUT_FILE_OR_PIPE, TEMPLATE_LIMIT);
    if (!code && !strstr(text, mark)) {
        code = print_data_error("%s: no template of a page, which has the line <!-- atlas -->", name);
    }
    if (code) {
        free(text);
        return code;
    }
    conus_inputs_add(name);
    *out = text;
    return EXIT_DONE;
}

/* Writes the page into page->out. */
static int put_page(struct page *page, const char *template, bool has_question)
{
    const char *at = strstr(template, mark) + strlen(mark);
    fwrite(template, 1, (size_t)(at - template), page->out);
    fputc('\n', page->out);
    int code = EXIT_DONE;
    for (size_t i = 0; !code && i < page->count; i++) {
        const struct page_file *file = &page->files[i];
        bool is_image = file->is_context && (i == 0 || !page->files[i - 1].is_context);
        code = put_file(page->out, file, folder_of(page, file), is_image ? " data-context" : "");
    }
    code = code || !has_question ? code : put_question(page);
    fputs(at + (*at == '\n'), page->out);
    return code;
}

/* What all who have the page can see. */
static void say_files(const struct page *page)
{
    struct system_text list;
    const char *context = page->settings->context;
    for (size_t i = 0; !context && i < conus_atlas_volume_count(page->atlas); i++) {
        const conus_volume_info *volume = conus_atlas_volume(page->atlas, i);
        context = volume->role == CONUS_ROLE_CONTEXT ? volume->path : NULL;
    }
    if (context) {
        print_error_line("note: %s: a face can be recognised in an image of a head; all who have the page see it",
                         context);
    }
    FILE *out = system_text_open(&list);
    for (size_t i = 0; out && i < page->count; i++) {
        fprintf(out, "%s%s%s", i ? ", " : "", folder_of(page, &page->files[i]), page->files[i].name);
    }
    if (system_text_close(&list)) {
        print_error_line("note: the page has inside: %s", list.data);
    }
    free(list.data);
}

int page_write(struct page_settings settings, const struct arguments *arguments, const char *before)
{
    const struct atlas_settings atlas_settings = {0};
    struct page page = {.settings = &settings};
    struct atlas_name name = {0};
    struct atlas_name context = {0};
    char *template = NULL;
    struct system_text text = {0};
    const struct option *of_rays = option_with(arguments, OPTION_OF_RAYS);
    if (of_rays && !option_given(arguments, "origin")) {
        return print_usage_error("--%s has no effect without --origin", of_rays->name);
    }
    if (!settings.force && system_allows(settings.output, 0)) {
        return print_usage_error("%s is there already; --force replaces it", settings.output);
    }
    if (!page_question_check(&settings.question)) {
        return EXIT_USAGE;
    }
    int code = read_template(&template, settings.template, before);
    while (conus_inputs_at(page.seen)) {
        page.seen++;
    }
    code = code ? code : atlas_name_find(&name, arguments->operands[0]);
    code = code ? code : atlas_input_load(&page.atlas, arguments->operands[0], &atlas_settings);
    code = code ? code : list_files(&page, name.path, false);
    code = code || !settings.context ? code : context_name_find(&context, settings.context);
    code = code ? code : atlas_input_load_context(page.atlas, context.path, 0, &atlas_settings);
    code = code || !context.path ? code : list_files(&page, context.path, true);
    place_context(&page);
    code = code || output_spares_inputs("--output", settings.output) ? code : EXIT_USAGE;
    code = code ? code : check_size(&page);
    code = code ? code : check_opens(&page);
    page.out = code ? NULL : system_text_open(&text);
    if (page.out) {
        atlas_notes_say(page.atlas, &settings.common);
        if (!settings.common.quiet) {
            say_files(&page);
        }
        code = put_page(&page, template, option_given(arguments, "origin"));
        bool is_whole = system_text_close(&text);
        code = code ? code : is_whole ? output_write(settings.output, text.data, text.size) : print_no_memory();
    }
    free(text.data);
    free(template);
    for (size_t i = 0; i < page.count; i++) {
        free(page.files[i].whole);
    }
    atlas_name_finish(&name);
    atlas_name_finish(&context);
    conus_atlas_destroy(page.atlas);
    return code;
}

static int run_page(const void *settings, const struct arguments *arguments)
{
    return page_write(*(const struct page_settings *)settings, arguments, "");
}

const struct command cmd_page = {
    .name = "page",
    .summary = "write a web page with the atlas and an answer inside",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .form = "-o FILE.html",
    .description = "Writes one HTML file that shows the atlas, and what a cone hits, in any browser: it needs no\n"
                   "network and no installation, and whoever has the file can move the cone. The page computes\n"
                   "the answer itself and says whether its rows are equal to those of this program.",
    .examples = "  conus page aal -o aal.html\n"
                "  conus page aal --origin -90,20,20 --toward 0,-10,10 --angle 20 -o answer.html\n",
    .groups = groups,
    .settings_size = sizeof(struct page_settings),
    .run = run_page,
};
