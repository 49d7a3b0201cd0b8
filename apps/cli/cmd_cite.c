/* SPDX-License-Identifier: BSD-3-Clause */
/* conus cite: the paragraph of methods about a result, and what it should cite. */
#include "base/path.h"
#include "base/system/system.h"
#include "cli/cite/citation.h"
#include "cli/commands.h"
#include "cli/verify/verdict.h"
#include "conus/file.h"
#include "conus/version.h"
#include "options/input_file.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"
#include "settings/atlases.h"

#include <stdlib.h>
#include <string.h>

struct cite_settings {
    struct common_settings common;
    size_t format;
    const char *sidecar;
    struct option_list folders;
    uint64_t max_memory;
    bool unverified;
};

static const char *const formats[] = {"text", "bibtex", NULL};

#define FIELD(member) OPTION_AT(struct cite_settings, member)
enum { TEXT, BIBTEX, WIDTH = 100 };

static const struct option own_options[] = {
    {.name = "format",
     FIELD(format),
     .value = "FORMAT",
     .help = "a paragraph with its references, or the references as BibTeX:",
     .choices = formats,
     .words = "BibTeX, references",
     .common = true},
    {.name = "sidecar",
     FIELD(sidecar),
     .value = "FILE.json",
     .help = "the sidecar of RESULT, if it is not beside it",
     .common = true},
    {.name = "search",
     FIELD(folders),
     .value = "FOLDER",
     .help = "look here for the atlas's files, if they are no longer where they were; may be repeated",
     .common = true},
    {.name = "max-memory",
     .type = OPTION_BYTES,
     .offset = offsetof(struct cite_settings, max_memory),
     .value = "SIZE",
     .help = "largest file of ATLAS to read, like 512M or 2G (default 8G)"},
    {.name = "unverified",
     FIELD(unverified),
     .help = "go by the sidecar, without answering RESULT again, even if it was changed"},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct cite_settings, common)},
    {0},
};

/* A citation on the way. */
struct citing {
    const struct cite_settings *settings;
    const struct command *const *commands; /* of conus, up to NULL */
    const char *given;
    struct citation citation;
    struct record record;
    struct replay replay;
    struct atlases atlases; /* of ATLAS */
    char **names;           /* [citation.atlas_count] what the citation borrows */
};

/* "aal" of "aal.nii.gz"; NULL without memory. */
static char *stem_of(const char *path)
{
    char *name = strdup(path_name(path));
    static const char *const endings[] = {".gz", ".nii", ".json", ".atlas", ".xml", ".mgz", ".nrrd", ".tif", ".tiff"};
    for (size_t i = 0; name && i < sizeof endings / sizeof endings[0]; i++) {
        if (path_ends_in(name, endings[i])) {
            name[strlen(name) - strlen(endings[i])] = '\0';
        }
    }
    return name;
}

static int make_atlases(struct citing *citing, size_t count)
{
    citing->citation.atlases = calloc(count, sizeof *citing->citation.atlases);
    citing->names = calloc(count, sizeof(char *));
    citing->citation.atlas_count = citing->citation.atlases && citing->names ? count : 0;
    return citing->citation.atlas_count ? EXIT_DONE : print_no_memory();
}

/* References are looked for beside the file that was found, or beside the folder or manifest itself. */
static int look_for_references(struct citing *citing, struct cited_atlas *atlas, const char *path,
                               const struct places *places)
{
    const struct recorded_file *file = NULL;
    for (size_t i = 0; i < citing->record.input_count && !file; i++) {
        const struct recorded_file *input = &citing->record.inputs[i];
        file = strcmp(input->path, path) == 0 ? input : NULL;
    }
    struct found_file found = {.state = FILE_MISSING};
    if (file && !file_find(&found, file, places)) {
        return EXIT_DATA;
    }
    atlas->sha256 = file ? file->sha256 : NULL;
    atlas->is_here = file ? found.state == FILE_SAME || found.state == FILE_MOVED : conus_atlas_is_path(path);
    if (atlas->is_here) {
        references_find(&atlas->references, found.path ? found.path : path);
    }
    free(found.path);
    return EXIT_DONE;
}

static int list_recorded(struct citing *citing, struct places *places)
{
    const json_t *several = json_object_get(citing->record.root, "Atlases");
    int code = make_atlases(citing, several ? json_array_size(several) + !json_array_size(several) : 1);
    for (size_t i = 0; i < citing->citation.atlas_count && !code; i++) {
        struct cited_atlas *atlas = &citing->citation.atlases[i];
        const char *path = record_atlas(&citing->record, i);
        const char *name = json_string_value(json_object_get(json_array_get(several, i), "name"));
        if (!path) {
            return print_data_error("%s: Atlas: path: is missing", citing->given);
        }
        citing->names[i] = name ? strdup(name) : stem_of(path);
        atlas->name = citing->names[i];
        atlas->file = path_name(path);
        code = atlas->name ? look_for_references(citing, atlas, path, places) : print_no_memory();
    }
    return code;
}

static int cite_result(struct citing *citing, const char *sidecar)
{
    struct places places = {.beside = {citing->given, sidecar}};
    struct citation *citation = &citing->citation;
    int code = EXIT_DONE;
    citing->replay.record = &citing->record;
    if (!replay_parse(&citing->replay, citing->commands)) {
        return print_data_error("%s: %s", sidecar, citing->replay.why);
    }
    citation->sidecar = citing->record.root;
    citation->question = citation_question(citation, &citing->replay.arguments);
    if (!citation->question) {
        return print_no_memory();
    }
    if (!citation_is_known(citation)) {
        return print_data_error("%s: Question: names rows that this conus, %s, does not know", sidecar,
                                conus_version());
    }
    citation->version = citing->record.version;
    for (size_t i = 0; i < citing->settings->folders.count && !code; i++) {
        code = places_add(&places, citing->settings->folders.items[i]);
    }
    for (size_t i = 0; i < citing->record.output_count && !places.base; i++) {
        places.base = base_folder(citing->record.outputs[i].path, citing->given);
    }
    code = code ? code : list_recorded(citing, &places);
    places_finish(&places);
    return code;
}

/* The result that a sidecar is beside, if the sidecar was given in its place. NULL if it names none, or without memory.
 */
static char *result_of(const struct citing *citing, const char *sidecar)
{
    const struct record *record = &citing->record;
    const char *path = record->output_count ? record->outputs[record->output_count - 1].path : NULL;
    char *result = NULL;
    if (strcmp(citing->given, sidecar) != 0 || (path && strcmp(path_name(path), path_name(sidecar)) == 0)) {
        return strdup(citing->given);
    }
    return path && asprintf(&result, "%.*s%s", (int)(path_name(sidecar) - sidecar), sidecar, path_name(path)) >= 0
               ? result
               : NULL;
}

/* Answers the result again: one that is not what its sidecar gives is not cited. Of one that cannot be answered again,
 * whose sidecar has its checksum, stderr says why. */
static int verify_result(const struct citing *citing, const char *sidecar)
{
    const struct verdict_settings settings = {.sidecar = sidecar, .folders = citing->settings->folders};
    struct verdict verdict = {0};
    char *result = result_of(citing, sidecar);
    if (!result || !system_allows(result, 0)) {
        print_error_line("%s: cannot be verified: the result that it is beside is not there", sidecar);
        free(result);
        return EXIT_DONE;
    }
    int code = verdict_find(&verdict, result, &settings, citing->commands);
    const char *why = verdict.why.count ? verdict.why.items[0] : "its rows differ";
    if (!code && verdict.kind == VERDICT_NONE && citing->record.is_intact) {
        verdict_print_error(&verdict);
    } else if (!code && verdict.kind != VERDICT_IDENTICAL) {
        print_error_line("%s: does not verify: %s; --unverified cites what %s says", result, why, sidecar);
        code = EXIT_DIFFERENT;
    }
    verdict_finish(&verdict);
    free(result);
    return code;
}

static int cite_atlas(struct citing *citing)
{
    const struct atlas_settings settings = {.max_memory = citing->settings->max_memory, .no_cache = true};
    struct atlas_name found;
    int code = make_atlases(citing, 1);
    code = code ? code : atlases_load(&citing->atlases, citing->given, &settings, NULL);
    code = code ? code : atlas_name_find(&found, citing->given);
    if (code) {
        return code;
    }
    struct cited_atlas *atlas = &citing->citation.atlases[0];
    citing->names[0] = found.atlas ? strdup(found.atlas->name) : stem_of(found.path);
    const conus_volume_info *info = conus_atlas_volume(citing->atlases.items[0].atlas, 0);
    const char *path = info && found.atlas ? info->path : found.path;
    references_find(&atlas->references, found.path);
    if (!atlas->references.count && path != found.path) {
        references_find(&atlas->references, path);
    }
    citing->citation.version = conus_version();
    atlas->name = citing->names[0];
    for (size_t i = 0; i < conus_atlas_volume_count(citing->atlases.items[0].atlas) && !atlas->sha256; i++) {
        const conus_volume_info *volume = conus_atlas_volume(citing->atlases.items[0].atlas, i);
        atlas->sha256 = strcmp(volume->path, path) == 0 ? volume->sha256 : NULL;
    }
    atlas->file = found.atlas && info ? path_name(info->path) : path_name(citing->given);
    atlas->is_here = true;
    atlas_name_finish(&found);
    return atlas->name ? EXIT_DONE : print_no_memory();
}

/* Breaks a line at spaces. */
static void put_wrapped(FILE *out, const char *text)
{
    size_t column = 0;
    for (const char *word = text; *word;) {
        size_t length = strcspn(word, " ");
        size_t shown = 0;
        for (size_t i = 0; i < length; i++) {
            shown += ((unsigned char)word[i] & 0xc0) != 0x80;
        }
        bool breaks = column && column + 1 + shown > WIDTH;
        fprintf(out, "%s%.*s", breaks ? "\n" : column ? " " : "", (int)length, word);
        column = breaks ? shown : column + (column > 0) + shown;
        word += length;
        word += strspn(word, " ");
    }
    fputc('\n', out);
}

static int put_text(FILE *out, const struct citation *citation)
{
    struct system_text text;
    if (system_text_open(&text)) {
        citation_methods(text.stream, citation);
    }
    if (!system_text_close(&text)) {
        return print_no_memory();
    }
    put_wrapped(out, text.data);
    fputc('\n', out);
    citation_list(out, citation);
    citation_warnings(out, citation);
    free(text.data);
    return EXIT_DONE;
}

static int write_citation(const struct citing *citing)
{
    struct system_text text;
    FILE *out = system_text_open(&text);
    int code = EXIT_DONE;
    if (out && citing->settings->format == BIBTEX) {
        citation_bibtex(out, &citing->citation);
    } else if (out) {
        code = put_text(out, &citing->citation);
    }
    bool is_whole = system_text_close(&text);
    code = code || is_whole ? code : print_no_memory();
    if (!code) {
        conus_plain_text(text.data);
        code = output_write(NULL, text.data, strlen(text.data));
    }
    free(text.data);
    return code;
}

/* Whether a file is JSON that conus wrote about a result, and not an atlas. */
static bool is_sidecar(const char *path)
{
    json_t *root = provenance_load(path, RECORD_LIMIT);
    bool is = json_object_get(root, "GeneratedBy");
    json_decref(root);
    return is;
}

static int read_record(struct citing *citing, const char *sidecar)
{
    char *text = NULL;
    size_t size = 0;
    int code = input_file_read(&text, &size, sidecar, INPUT_FILE, RECORD_LIMIT);
    const char *bad = code ? NULL : record_parse(&citing->record, text, size);
    free(text);
    if (bad) {
        return print_data_error("%s: %s", sidecar, bad);
    }
    return code;
}

static int run_cite(const void *given, const struct arguments *arguments)
{
    struct citing citing = {.settings = given, .commands = arguments->family, .given = arguments->operands[0]};
    const char *named = citing.settings->sidecar;
    char *sidecar = named ? strdup(named) : sidecar_find(citing.given);
    int code = EXIT_DONE;
    if (sidecar && (named || is_sidecar(sidecar))) {
        code = read_record(&citing, sidecar);
        code = code || citing.settings->unverified ? code : verify_result(&citing, sidecar);
        code = code ? code : cite_result(&citing, sidecar);
    } else {
        code = cite_atlas(&citing);
    }
    code = code ? code : write_citation(&citing);
    for (size_t i = 0; i < citing.citation.atlas_count; i++) {
        references_finish(&citing.citation.atlases[i].references);
        free(citing.names ? citing.names[i] : NULL);
    }
    free(citing.citation.atlases);
    json_decref(citing.citation.question);
    free((void *)citing.names);
    replay_finish(&citing.replay);
    record_finish(&citing.record);
    atlases_finish(&citing.atlases);
    free(sidecar);
    return code;
}

const struct command cmd_cite = {
    .name = "cite",
    .summary = "write the methods paragraph of a result, and its references",
    .operands = {"RESULT|ATLAS"},
    .description =
        "For a RESULT with its .json beside it: writes a paragraph that says what was asked, and the references:\n"
        "conus, the method where rays were traced, and the atlas, as its own files ask. RESULT is first answered\n"
        "again, as by conus verify; one that was changed is not cited. For an ATLAS: writes how to cite it. Read it\n"
        "before you publish it: conus knows nothing of your study.",
    .examples = "  conus cite answers.tsv\n"
                "  conus cite answers.tsv --format bibtex >>paper.bib\n"
                "  conus cite aal\n",
    .groups = groups,
    .settings_size = sizeof(struct cite_settings),
    .run = run_cite,
};
