/* SPDX-License-Identifier: BSD-3-Clause */
/* conus cite: the paragraph of methods about a result, and what it should cite. */
#include "base/path.h"
#include "base/system/system.h"
#include "cli/cite/citation.h"
#include "cli/commands.h"
#include "cli/verify/verify.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"
#include "settings/settings.h"

#include <stdlib.h>
#include <string.h>

struct cite_settings {
    struct common_settings common;
    size_t format;
    const char *sidecar;
    const char *folder;
    uint64_t max_memory;
};

static const char *const formats[] = {"text", "bibtex", NULL};

enum { TEXT, BIBTEX };

static const struct option own_options[] = {
    {OPTION_VALUED("format", struct cite_settings, format, "FORMAT"),
     .help = "a paragraph with its references, or the references as BibTeX:", .choices = formats,
     .words = "BibTeX, references", .common = true},
    {OPTION_VALUED("sidecar", struct cite_settings, sidecar, "FILE.json"),
     .help = "the sidecar of RESULT, if it is not beside it", .common = true, OPTION_READING(SIDECAR)},
    {OPTION_VALUED("folder", struct cite_settings, folder, "FOLDER"),
     .help = "where the atlas's files are, if they moved or have another name", .common = true, OPTION_READING(FOLDER)},
    {OPTION_MEMORY(struct cite_settings, max_memory), .help = "largest file of ATLAS to read, like 512M or 2G",
     .standard = "8G"},
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
    const char *given;
    struct citation citation;
    struct record record;
    struct atlases atlases; /* of ATLAS */
};

static int make_atlases(struct citing *citing, size_t count)
{
    citing->citation.atlases = calloc(count, sizeof *citing->citation.atlases);
    citing->citation.atlas_count = citing->citation.atlases ? count : 0;
    return citing->citation.atlas_count ? EXIT_DONE : print_no_memory();
}

/* Files that carry no reference may still be those of a published atlas. */
static void look_in_files(const struct citing *citing, struct references *references, const char *path)
{
    const conus_load_options options = {.max_memory = citing->settings->max_memory};
    conus_atlas *atlas = NULL;
    references_find(references, path);
    if (!references->count && !conus_atlas_load(&atlas, path, &options)) {
        references_identify(references, atlas);
    }
    conus_atlas_destroy(atlas);
}

/* References are looked for beside the file that was found, or beside the folder or manifest itself. */
static int look_for_references(struct citing *citing, struct cited_atlas *atlas, const char *path, const char *ran)
{
    const struct recorded_file *file = NULL;
    for (size_t i = 0; i < citing->record.input_count && !file; i++) {
        const struct recorded_file *input = &citing->record.inputs[i];
        file = strcmp(input->path, path) == 0 ? input : NULL;
    }
    struct found_file found = {.state = FILE_MISSING};
    if (file && !file_find(&found, file, ran, citing->settings->folder)) {
        return EXIT_DATA;
    }
    atlas->sha256 = file ? file->sha256 : NULL;
    atlas->is_here = file ? found.state == FILE_SAME || found.state == FILE_MOVED : conus_atlas_is_path(path);
    if (atlas->is_here) {
        look_in_files(citing, &atlas->references, found.path ? found.path : path);
    }
    free(found.path);
    return EXIT_DONE;
}

/* The sum of a pack's source, which is no input itself. */
static const char *recorded_sum(const json_t *atlas, const char *path)
{
    size_t index;
    const json_t *volume;
    const char *sum = NULL;
    json_array_foreach(json_object_get(atlas, "volumes"), index, volume)
    {
        const char *own = json_string_value(json_object_get(volume, "path"));
        sum = !sum && own && strcmp(own, path) == 0 ? json_string_value(json_object_get(volume, "sha256")) : sum;
    }
    return sum;
}

static int list_recorded(struct citing *citing, const char *ran)
{
    const json_t *several = json_object_get(citing->record.root, "Atlases");
    if (citation_has_no_atlas(&citing->citation)) {
        return EXIT_DONE;
    }
    int code = make_atlases(citing, several ? json_array_size(several) + !json_array_size(several) : 1);
    for (size_t i = 0; i < citing->citation.atlas_count && !code; i++) {
        struct cited_atlas *atlas = &citing->citation.atlases[i];
        const char *path = record_atlas(&citing->record, i);
        const char *name = json_string_value(json_object_get(json_array_get(several, i), "name"));
        if (!path) {
            return print_data_error("%s: Atlas: path: is missing", citing->given);
        }
        atlas->name = name ? strdup(name) : cited_stem(path);
        atlas->file = path_name(path);
        code = atlas->name ? look_for_references(citing, atlas, path, ran) : print_no_memory();
        const json_t *recorded = several ? json_array_get(several, i) : json_object_get(citing->record.root, "Atlas");
        atlas->sha256 = atlas->sha256 ? atlas->sha256 : recorded_sum(recorded, path);
    }
    return code;
}

static int cite_result(struct citing *citing, const char *sidecar)
{
    struct citation *citation = &citing->citation;
    const struct record *record = &citing->record;
    const char *written = record->output_count ? record->outputs[record->output_count - 1].path : NULL;
    citation->sidecar = record->root;
    citation->version = record->version;
    if (!record->is_intact) {
        print_error_line("%s: was changed after conus wrote it: its Checksum does not fit; conus verify says where",
                         sidecar);
        return EXIT_DIFFERENT;
    }
    if (!citation_is_known(citation)) {
        return print_data_error("%s: Question: names no rows that this conus, %s, knows", sidecar, conus_version());
    }
    char *ran = recorded_folder(written, citing->given);
    int code = ran ? list_recorded(citing, ran) : print_no_memory();
    free(ran);
    return code;
}

static int cite_atlas(struct citing *citing)
{
    const struct atlas_settings settings = {.max_memory = citing->settings->max_memory};
    int code = make_atlases(citing, 1);
    code = code ? code : atlases_load(&citing->atlases, citing->given, &settings, NULL);
    citing->citation.version = conus_version();
    struct atlas_name found;
    code = code ? code : atlas_name_find(&found, citing->given);
    if (code) {
        return code;
    }
    code = cited_atlas_find(&citing->citation.atlases[0], citing->given, found.atlas ? found.atlas->name : NULL,
                            found.path, citing->atlases.items[0].atlas);
    atlas_name_finish(&found);
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

static int put_citation(FILE *out, struct citing *citing)
{
    const char *named = citing->settings->sidecar;
    char *sidecar = named ? strdup(named) : sidecar_find(citing->given);
    int code = EXIT_DONE;
    if (sidecar && (named || is_sidecar(sidecar))) {
        code = record_read(&citing->record, sidecar);
        code = code ? code : cite_result(citing, sidecar);
    } else if (!sidecar && path_ending_length(citing->given, ".tsv/.csv/.txt/.ndjson")) { /* rows, and no atlas */
        code = print_data_error("%s: no .json of conus is beside it, which says how it was made", citing->given);
    } else {
        code = cite_atlas(citing);
    }
    if (!code && citing->settings->format == BIBTEX) {
        citation_bibtex(out, &citing->citation);
    } else if (!code) {
        code = citation_text(out, &citing->citation);
    }
    citation_finish(&citing->citation);
    record_finish(&citing->record);
    atlases_finish(&citing->atlases);
    free(sidecar);
    return code;
}

int cite_put(FILE *out, const char *result, bool is_bibtex)
{
    const struct cite_settings settings = {.format = is_bibtex ? BIBTEX : TEXT};
    struct citing citing = {.settings = &settings, .given = result};
    return put_citation(out, &citing);
}

static int run_cite(const void *given, const struct arguments *arguments)
{
    struct citing citing = {.settings = given, .given = arguments->operands[0]};
    struct system_text text;
    FILE *out = system_text_open(&text);
    int code = out ? put_citation(out, &citing) : print_no_memory();
    if (!code) {
        return output_end(&text);
    }
    system_text_close(&text);
    free(text.data);
    return code;
}

const struct command cmd_cite = {
    .name = "cite",
    .summary = "write the methods paragraph of a result, and its references",
    .operands = {"RESULT|ATLAS"},
    .holds = {HOLDS_ROWS},
    .description =
        "For a RESULT with its .json beside it: writes a paragraph that says what was asked, and the references:\n"
        "conus, the method where rays were traced, and the atlas, as its own files ask. It says what the .json does:\n"
        "conus verify tells whether RESULT is that. For an ATLAS: writes how to cite it. Read it before you publish\n"
        "it: conus has nothing about your study.",
    .examples = "  conus cite answers.tsv\n"
                "  conus cite answers.tsv --format bibtex >>paper.bib\n"
                "  conus cite aal\n",
    .groups = groups,
    .settings_size = sizeof(struct cite_settings),
    .run = run_cite,
};
