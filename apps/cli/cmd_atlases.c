/* SPDX-License-Identifier: BSD-3-Clause */
/* conus atlases: lists what is installed, and where that was looked for. */
#include "cli/answers/answers.h"
#include "cli/commands.h"
#include "conus/own.h"
#include "options/messages.h"
#include "options/output.h"
#include "settings/settings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum list_format { LIST_TABLE, LIST_TSV, LIST_JSON, LIST_NAMES };

struct list_settings {
    size_t format; /* enum list_format */
    bool places;
    struct common_settings common;
};

static const char *const formats[] = {"table", "tsv", "json", "names", NULL};

static const struct option own_options[] = {
    {OPTION_VALUED("format", struct list_settings, format, "FORMAT"),
     .help = "a table for people, tab-separated values, everything as JSON, or only what may stand for ATLAS, one a "
             "line:",
     .choices = formats, .words = "export", .common = true},
    {OPTION_NAMED("places", struct list_settings, places),
     .help = "list the places in which conus looks, instead of the atlases (table, tsv)", .words = "folders",
     .common = true},
    {OPTION_NAMED("quiet", struct list_settings, common.quiet), .letter = 'q',
     .help = "print only errors and warnings on stderr, no notes", .role = OPTION_OF_RUN},
    {0},
};

static const struct option_group groups[] = {
    {"Options", own_options, 0},
    {"", plain_options, offsetof(struct list_settings, common)},
    {0},
};

enum { ATLAS_COLUMNS = 6, PLACE_COLUMNS = 4 };

static bool put_atlases(FILE *out, const void *catalogue)
{
    bool whole = true;
    fputs("name\tsource\tkind\tvoxel_mm\tpath\tlabels\n", out);
    for (size_t i = 0; i < conus_catalogue_count(catalogue); i++) {
        const conus_installed *atlas = conus_catalogue_atlas(catalogue, i);
        whole = aligned_put_cell(out, atlas->name) && whole;
        fprintf(out, "\t%s\t%s\t", atlas->source, atlas->kind);
        const double *mm = atlas->spacing;
        if (!(mm[0] > 0)) {
            fputs("n/a", out);
        } else if (fabs(mm[1] - mm[0]) < 1e-4 && fabs(mm[2] - mm[0]) < 1e-4) {
            fprintf(out, "%.4g", mm[0]);
        } else {
            fprintf(out, "%.4gx%.4gx%.4g", mm[0], mm[1], mm[2]);
        }
        fputc('\t', out);
        whole = aligned_put_cell(out, atlas->path) && whole;
        fputc('\t', out);
        whole = aligned_put_cell(out, atlas->labels) && whole;
        fputc('\n', out);
    }
    return whole;
}

static bool put_places(FILE *out, const void *catalogue)
{
    bool whole = true;
    fputs("source\tplace\tpath\tstate\n", out);
    for (size_t i = 0; i < conus_catalogue_place_count(catalogue); i++) {
        const conus_catalogue_place *place = conus_catalogue_place_at(catalogue, i);
        fprintf(out, "%s\t%s\t", place->source, place->rule);
        whole = aligned_put_cell(out, place->path) && whole;
        fprintf(out, "\t%s\n",
                place->there            ? "there"
                : place->path[0]        ? "no such folder"
                : place->rule[0] == '(' ? "no such program"
                                        : "not set");
    }
    return whole;
}

static bool put_table(FILE *out, const conus_catalogue *catalogue, bool places)
{
    static const bool right[ATLAS_COLUMNS] = {[3] = true};
    static const bool left[PLACE_COLUMNS] = {0};
    size_t count = conus_catalogue_count(catalogue);
    if (places) {
        return aligned_put(out, put_places, catalogue, PLACE_COLUMNS, left);
    }
    if (!count) {
        fputs("no atlas was found in any of these places\n\n", out);
        return aligned_put(out, put_places, catalogue, PLACE_COLUMNS, left);
    }
    bool whole = aligned_put(out, put_atlases, catalogue, ATLAS_COLUMNS, right);
    fprintf(out, "\n%zu atlas%s; a name, or source:name, may stand for ATLAS in every command\n", count,
            count == 1 ? "" : "es");
    return whole;
}

/* The word to type for ATLAS: the name, where it means this one. */
static void put_names(FILE *out, const conus_catalogue *catalogue)
{
    for (size_t i = 0; i < conus_catalogue_count(catalogue); i++) {
        const conus_installed *atlas = conus_catalogue_atlas(catalogue, i);
        const conus_installed *meant = NULL;
        bool alone = conus_catalogue_find(&meant, catalogue, atlas->name) == CONUS_OK;
        if (!alone) {
            fprintf(out, "%s:%s\n", atlas->source, atlas->name);
        } else if (meant == atlas) {
            fprintf(out, "%s\n", atlas->name);
        }
    }
}

static void put_json(FILE *out, const conus_catalogue *catalogue)
{
    json_t *atlases = json_array();
    json_t *notes = json_array();
    for (size_t i = 0; i < conus_catalogue_count(catalogue); i++) {
        json_array_append_new(atlases, info_json_installed(conus_catalogue_atlas(catalogue, i)));
    }
    for (size_t i = 0; i < conus_catalogue_note_count(catalogue); i++) {
        json_array_append_new(notes, info_json_bytes(conus_catalogue_note(catalogue, i)));
    }
    json_t *places = json_array();
    for (size_t i = 0; i < conus_catalogue_place_count(catalogue); i++) {
        const conus_catalogue_place *place = conus_catalogue_place_at(catalogue, i);
        json_array_append_new(places, json_pack("{s:s,s:s,s:o,s:b}", "source", place->source, "place", place->rule,
                                                "path", place->path[0] ? info_json_bytes(place->path) : json_null(),
                                                "there", place->there));
    }
    json_t *root =
        json_pack("{s:s,s:o,s:o,s:o}", "conus", conus_version(), "atlases", atlases, "places", places, "notes", notes);
    (void)json_put(out, root, JSON_INDENT(2) | JSON_REAL_PRECISION(9));
}

struct list_text {
    const conus_catalogue *catalogue;
    const struct list_settings *settings;
};

static bool put_list(FILE *out, const void *what)
{
    const struct list_text *text = what;
    const conus_catalogue *catalogue = text->catalogue;
    const struct list_settings *settings = text->settings;
    switch ((enum list_format)settings->format) {
    case LIST_TABLE:
        return put_table(out, catalogue, settings->places);
    case LIST_TSV:
        (settings->places ? put_places : put_atlases)(out, catalogue);
        break;
    case LIST_JSON:
        put_json(out, catalogue);
        break;
    case LIST_NAMES:
        put_names(out, catalogue);
        break;
    }
    return true;
}

static int run_atlases(const void *given, const struct arguments *arguments)
{
    (void)arguments;
    const struct list_settings *settings = given;
    const conus_catalogue_options options = {.log = settings->common.quiet ? log_note_quiet : log_note};
    conus_catalogue *catalogue = NULL;
    if (settings->places && settings->format != LIST_TABLE && settings->format != LIST_TSV) {
        return print_usage_error("--places is for --format table and tsv; json has the places anyway");
    }
    conus_status status = conus_catalogue_create(&catalogue, &options);
    int code = status ? print_status(status) : output_put(put_list, &(struct list_text){catalogue, settings});
    conus_catalogue_destroy(catalogue);
    return code;
}

const struct command cmd_atlases = {
    .name = "atlases",
    .summary = "list the atlases that are installed on this computer",
    .description =
        "Lists what is in the folders of $CONUS_ATLAS_PATH, and in those of mricron, FSL, FreeSurfer, BrainGlobe,\n"
        "TemplateFlow, AFNI, SPM, CAT12, nilearn and MRIcroGL; --places says which these are. A name may stand\n"
        "wherever a command takes ATLAS. A path comes first: a file of that name here hides the name.\n"
        "source:name chooses one source. Upper and lower case, and - _ . + between words, make no difference.\n\n"
        "The list is made from names, headers and FSL's XMLs, without reading voxels. A volume is listed where\n"
        "something says that it holds labels (docs/commands.md).",
    .examples = "  conus atlases\n"
                "  conus query aal --origin=-90,20,20 --toward=0,-10,10\n"
                "  conus info fsl:harvard-oxford-cortical\n"
                "  CONUS_ATLAS_PATH=~/atlases:/data/atlases conus atlases --format tsv\n",
    .of_one = "conus info",
    .groups = groups,
    .settings_size = sizeof(struct list_settings),
    .run = run_atlases,
};
