/* SPDX-License-Identifier: BSD-3-Clause */
/* conus page: one HTML file with the atlas, a question and its answer inside. */
#include "cli/commands.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/atlas_input.h"
#include "settings/notes.h"
#include "settings/settings.h"

#include "conus/pose.h"
#include "conus/report.h"
#include "conus/version.h"

#include <dirent.h>
#include <errno.h>
#include <jansson.h>
#include <limits.h>
#include <math.h>
#include <nettle/base64.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FILE_LIMIT = 4096, SIZE_LIMIT = 100000000 };

static const char template_name[] = "share/conus/page.html";
/* Where the template takes the atlas. */
static const char mark[] = "<!-- atlas -->";

struct page_settings {
    struct common_settings common;
    const char *output;
    double origin[3], toward[3];
    double angle;
    size_t layers; /* conus_layers */
    uint32_t resolution;
    const char *context;
    const char *template;
    bool large, force;
};

static const char *const layer_names[] = {"visible", "all", NULL};

static const struct option own_options[] = {
    {.name = "output",
     .letter = 'o',
     OPTION_AT(struct page_settings, output),
     .value = "FILE.html",
     .help = "the page",
     .required = true,
     .endings = ".html",
     .words = "save, export, share",
     .common = true},
    {.name = "origin",
     OPTION_AT(struct page_settings, origin),
     .value = "X,Y,Z",
     .help = "where the cone begins, mm",
     .needs = "toward",
     .common = true},
    {.name = "toward",
     OPTION_AT(struct page_settings, toward),
     .value = "X,Y,Z",
     .help = "a point that the cone's axis goes through, mm",
     .needs = "origin",
     .common = true},
    {.name = "angle",
     OPTION_AT(struct page_settings, angle),
     .value = "DEGREES",
     .help = "full opening angle of the cone, 0.001 to 170 (default 20)",
     OPTION_FROM_TO(0.001, 170),
     .needs = "origin",
     .common = true},
    {.name = "layers",
     OPTION_AT(struct page_settings, layers),
     .value = "LAYERS",
     .help = "first hits, or all in the cone:",
     .choices = layer_names,
     .needs = "origin"},
    {.name = "resolution",
     OPTION_AT(struct page_settings, resolution),
     .value = "N",
     .help = "rays along a side of the buffer, 1 to 256 (default 16)",
     OPTION_FROM_TO(1, 256),
     .needs = "origin"},
    {.name = "context",
     OPTION_AT(struct page_settings, context),
     .value = "FILE",
     .help = "an image that the cuts show below the areas, put into the page, too",
     .words = "T1, MRI"},
    {.name = "template",
     OPTION_AT(struct page_settings, template),
     .value = "FILE.html",
     .help = "the page without an atlas (default: share/conus/page.html of this installation)"},
    {.name = "large", OPTION_AT(struct page_settings, large), .help = "write a page whose files have more than 100 MB"},
    {.name = "force", OPTION_AT(struct page_settings, force), .help = "replace a file"},
    {.name = "quiet",
     .letter = 'q',
     OPTION_AT(struct page_settings, common.quiet),
     .help = "print only errors on stderr, no notes"},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct page_settings, common)},
    {0},
};

struct page {
    const struct page_settings *settings;
    conus_atlas *atlas;
    char *files[FILE_LIMIT]; /* files of the atlas, the one to open first */
    size_t count;
    size_t folder; /* bytes of the path, with its slash, that all files begin with */
    FILE *out;
};

/* Adds a path once; NULL is none. */
static int add_file(struct page *page, const char *path)
{
    for (size_t i = 0; path && i < page->count; i++) {
        if (paths_equal(page->files[i], path)) {
            return EXIT_DONE;
        }
    }
    if (path && page->count == FILE_LIMIT) {
        return print_data_error("a page holds at most %d files", FILE_LIMIT);
    }
    char *copy = path ? strdup(path) : NULL;
    if (path && !copy) {
        return print_no_memory();
    }
    page->files[page->count] = copy;
    page->count += copy != NULL;
    return EXIT_DONE;
}

/* The files beside `file` that the source of the names mentions: "MRIcron text in aal.nii.txt". */
static int add_label_tables(struct page *page, const char *file)
{
    const char *source = conus_atlas_label_source(page->atlas);
    char path[PATH_MAX];
    int length = (int)(path_name(file) - file);
    snprintf(path, sizeof path, "%.*s", length ? length : 1, length ? file : ".");
    DIR *list = source ? opendir(path) : NULL;
    int code = EXIT_DONE;
    for (struct dirent *entry; list && !code && (entry = readdir(list));) {
        const char *found = strstr(source, entry->d_name);
        const char *end = found ? found + strlen(entry->d_name) : NULL;
        bool is_whole = found && (found == source || strchr(" /(", found[-1])) && (!*end || strchr(" ,;:)", *end));
        if (is_whole && entry->d_name[0] != '.' &&
            snprintf(path, sizeof path, "%.*s%s", length, file, entry->d_name) < (int)sizeof path) {
            code = add_file(page, path);
        }
    }
    if (list) {
        closedir(list);
    }
    return code;
}

/* The atlas's files, with the folder that all are in: the page keeps their places below it. */
static int list_files(struct page *page, const char *path)
{
    int code = add_file(page, path);
    for (size_t i = 0; !code && i < conus_atlas_volume_count(page->atlas); i++) {
        const conus_volume_info *volume = conus_atlas_volume(page->atlas, i);
        code = volume->role == CONUS_ROLE_CONTEXT ? EXIT_DONE : add_file(page, volume->path);
    }
    for (size_t i = 0; !code && i < conus_atlas_file_count(page->atlas); i++) {
        code = add_file(page, conus_atlas_file(page->atlas, i));
    }
    for (size_t i = 0, files = page->count; !code && i < files; i++) {
        code = add_label_tables(page, page->files[i]);
    }
    if (code) {
        return code;
    }
    page->folder = (size_t)(path_name(page->files[0]) - page->files[0]);
    for (size_t i = 1; i < page->count; i++) {
        while (page->folder && strncmp(page->files[i], page->files[0], page->folder) != 0) {
            page->folder--;
            while (page->folder && page->files[0][page->folder - 1] != '/') {
                page->folder--;
            }
        }
    }
    return EXIT_DONE;
}

/* Writes text into the page. It escapes <, which could end a script or a tag, and in HTML also " and &. */
static void put_text(FILE *out, const char *text, bool is_json)
{
    for (; *text; text++) {
        if (*text == '<') {
            fputs(is_json ? "\\u003c" : "&lt;", out);
        } else if (!is_json && (*text == '"' || *text == '&')) {
            fputs(*text == '"' ? "&quot;" : "&amp;", out);
        } else {
            fputc(*text, out);
        }
    }
}

static int put_file(FILE *out, const char *path, const char *name, const char *role)
{
    unsigned char piece[3 << 14]; /* of a multiple of 3 bytes, so that only the last is padded */
    char digits[BASE64_ENCODE_RAW_LENGTH(sizeof piece)];
    FILE *in = fopen(path, "rb");
    if (!in) {
        return print_data_error("%s: %s", path, strerror(errno));
    }
    fputs("<script type=\"application/octet-stream\" data-file=\"", out);
    put_text(out, name, false);
    fprintf(out, "\"%s>", role);
    for (size_t size; (size = fread(piece, 1, sizeof piece, in));) {
        base64_encode_raw(digits, size, piece);
        fwrite(digits, 1, BASE64_ENCODE_RAW_LENGTH(size), out);
    }
    fputs("</script>\n", out);
    bool failed = ferror(in);
    fclose(in);
    if (failed) {
        print_error_line("%s: cannot be read", path);
    }
    return failed ? EXIT_DATA : EXIT_DONE;
}

static int check_size(const struct page *page)
{
    const char *context = page->settings->context;
    double sum = 0;
    for (size_t i = 0; i < page->count + (context != NULL); i++) {
        struct stat state;
        sum += stat(i < page->count ? page->files[i] : context, &state) ? 0 : (double)state.st_size;
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
    const struct page_settings *settings = page->settings;
    const conus_selector_options options = {.resolution = settings->resolution,
                                            .layers = (conus_layers)settings->layers};
    const conus_report_options rows = {.format = CONUS_FORMAT_NDJSON};
    conus_pose pose;
    conus_selector *selector = NULL;
    conus_selection *selection = NULL;
    conus_report *report = NULL;
    const char *text = NULL;
    size_t size = 0;
    conus_status status = conus_pose_toward(&pose, settings->origin, settings->toward, NULL);
    status = status ? status : conus_selector_create(&selector, page->atlas, &options);
    status = status ? status : conus_select(&selection, selector, &pose, settings->angle * M_PI / 180);
    status = status ? status : conus_report_create(&report, selector, &rows);
    status = status ? status : conus_report_add(report, "1", selection);
    status = status ? status : conus_report_text(&text, &size, report);
    int code = print_status(status);
    if (!status) {
        char fragment[512];
        const double *o = settings->origin;
        const double *t = settings->toward;
        snprintf(fragment, sizeof fragment,
                 "v=1&origin=%.17g,%.17g,%.17g&toward=%.17g,%.17g,%.17g&angle=%.17g&layers=%s&resolution=%u"
                 "&cut=%.17g,%.17g,%.17g",
                 o[0], o[1], o[2], t[0], t[1], t[2], settings->angle, layer_names[settings->layers],
                 settings->resolution, t[0], t[1], t[2]);
        json_t *asked = json_pack("{s:s, s:s, s:s}", "fragment", fragment, "version", conus_version(), "rows", text);
        char *json = asked ? json_dumps(asked, 0) : NULL;
        if (json) {
            fputs("<script type=\"application/json\" id=\"question\">", page->out);
            put_text(page->out, json, true);
            fputs("</script>\n", page->out);
        }
        code = json ? EXIT_DONE : print_no_memory();
        free(json);
        json_decref(asked);
    }
    conus_report_destroy(report);
    conus_selection_destroy(selection);
    conus_selector_destroy(selector);
    return code;
}

/* The template's text, the caller's to free. */
static int read_template(char **out, const char *given)
{
    char path[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - sizeof template_name - 4);
    path[length > 0 ? length : 0] = '\0';
    char *slash = strrchr(path, '/');
    if (slash) {
        snprintf(slash, sizeof path - (size_t)(slash - path), "/../%s", template_name);
    }
    const char *name = given ? given : path;
    FILE *in = fopen(name, "rb");
    char *text = NULL;
    size_t size = 0;
    if (!in && !given) {
        return print_data_error(
            "the page's template is not installed: no %s (Debian package conus-page); --template names one", name);
    }
    if (!in || getdelim(&text, &size, '\0', in) < 0 || !strstr(text, mark)) {
        print_error_line("%s: %s", name,
                         in ? "no template of a page, which has the line <!-- atlas -->" : strerror(errno));
        if (in) {
            fclose(in);
        }
        free(text);
        return EXIT_DATA;
    }
    fclose(in);
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
        code = put_file(page->out, page->files[i], page->files[i] + page->folder, "");
    }
    const char *context = page->settings->context;
    if (context && !code) {
        code = put_file(page->out, context, path_name(context), " data-context");
    }
    code = code || !has_question ? code : put_question(page);
    fputs(at + (*at == '\n'), page->out);
    return code;
}

static int run_page(const void *given, const struct arguments *arguments)
{
    struct page_settings settings = *(const struct page_settings *)given;
    const struct atlas_settings atlas_settings = {0};
    struct page page = {.settings = &settings};
    struct atlas_name name = {0};
    char *template = NULL;
    char *text = NULL;
    size_t size = 0;
    settings.angle = settings.angle > 0 ? settings.angle : 20;
    settings.resolution = settings.resolution ? settings.resolution : 16;
    if (!settings.force && access(settings.output, F_OK) == 0) {
        return print_usage_error("%s is there already; --force replaces it", settings.output);
    }
    int code = read_template(&template, settings.template);
    code = code ? code : atlas_name_find(&name, arguments->operands[0]);
    code = code ? code : atlas_input_load(&page.atlas, arguments->operands[0], &atlas_settings);
    code = code ? code : atlas_input_load_context(page.atlas, settings.context, 0, &atlas_settings);
    code = code ? code : list_files(&page, name.path);
    code = code ? code : check_size(&page);
    page.out = code ? NULL : open_memstream(&text, &size);
    if (page.out) {
        atlas_notes_say(page.atlas, &settings.common);
        if (settings.context && !settings.common.quiet) {
            print_error_line("note: %s: a face can be recognised in an image of a head; all who have the page see it",
                             settings.context);
        }
        code = put_page(&page, template, option_given(arguments, "origin"));
        bool is_whole = fclose(page.out) == 0;
        code = code ? code : is_whole ? output_write(settings.output, text, size) : print_no_memory();
    }
    free(text);
    free(template);
    for (size_t i = 0; i < page.count; i++) {
        free(page.files[i]);
    }
    atlas_name_finish(&name);
    conus_atlas_destroy(page.atlas);
    return code;
}

const struct command cmd_page = {
    .name = "page",
    .summary = "write a web page with the atlas and an answer inside",
    .operands = {"ATLAS"},
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
