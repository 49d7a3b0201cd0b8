/* SPDX-License-Identifier: BSD-3-Clause */
/* conus info: lists the contents of an atlas as a table, a tree or JSON. */
#include "cli/answers/answers.h"
#include "cli/commands.h"
#include "options/messages.h"
#include "options/output.h"
#include "options/provenance.h"
#include "settings/settings.h"

#include "conus/own.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** An area in the tree; number 0 is above all roots. */
struct node {
    size_t first, last, next; /* children from first to last by next; 0 = none */
    size_t below;
    double volume_mm3; /* with what is below */
    bool has_surface;  /* whose volume may be part of another, or none */
};

static void link_areas(struct node *nodes, const conus_atlas *atlas)
{
    const conus_object *object;
    for (size_t number = 1; (object = conus_atlas_object(atlas, number)) && object->kind == CONUS_KIND_AREA; number++) {
        struct node *parent = &nodes[object->parent];
        if (parent->last) {
            nodes[parent->last].next = number;
        } else {
            parent->first = number;
        }
        parent->last = number;
        for (size_t at = number; at; at = conus_atlas_object(atlas, at)->parent) {
            nodes[at].volume_mm3 += object->volume_mm3;
            nodes[at].has_surface = nodes[at].has_surface || object->triangles;
            nodes[at].below += at != number;
        }
    }
}

/* The area after `number` in the tree, as it is read from top to bottom; 0 after the last. */
static size_t next_area(const struct node *nodes, const conus_atlas *atlas, size_t number, size_t *inset)
{
    if (nodes[number].first) {
        ++*inset;
        return nodes[number].first;
    }
    while (number && !nodes[number].next) {
        number = conus_atlas_object(atlas, number)->parent;
        --*inset;
    }
    return number ? nodes[number].next : 0;
}

/* Writes the areas as a tree: children below their parent, by label, with depth and number of areas below. False
 * without memory. */
static bool info_tree(FILE *out, const conus_atlas *atlas)
{
    struct node *nodes = calloc(conus_atlas_object_count(atlas) + 1, sizeof *nodes);
    size_t inset = 0; /* how many areas are above */
    if (!nodes) {
        return false;
    }
    link_areas(nodes, atlas);
    fprintf(out, "%5s  %10s  %5s  %12s  %s\n", "depth", "label", "below", "volume_mm3", "name (abbreviation)");
    for (size_t number = nodes[0].first; number; number = next_area(nodes, atlas, number, &inset)) {
        const conus_object *area = conus_atlas_object(atlas, number);
        char volume[32] = "n/a";
        if (!nodes[number].has_surface) {
            snprintf(volume, sizeof volume, "%.9g", nodes[number].volume_mm3);
        }
        fprintf(out, "%5u  %10u  %5zu  %12s  %*s%s%s%s%s\n", conus_atlas_depth(atlas, number), area->label,
                nodes[number].below, volume, (int)(2 * inset), "", area->name, *area->abbreviation ? " (" : "",
                area->abbreviation, *area->abbreviation ? ")" : "");
    }
    free(nodes);
    return true;
}

enum info_format { INFO_TABLE, INFO_TSV, INFO_JSON, INFO_TREE };

struct info_settings {
    struct atlas_settings atlas;
    struct context_choice context;
    size_t format; /* enum info_format */
    struct common_settings common;
};

static const char *const formats[] = {"table", "tsv", "json", "tree", NULL};

static const struct option own_options[] = {
    {OPTION_VALUED("format", struct info_settings, format, "FORMAT"),
     .help = "everything as a table for people, only the areas as tab-separated values, everything as JSON, or the "
             "area tree with its depths:",
     .choices = formats, .words = "export", .common = true},
    {0},
};

static const struct option_group groups[] = {
    {"What is loaded", atlas_options, offsetof(struct info_settings, atlas)},
    {"", side_options, offsetof(struct info_settings, atlas)},
    {"", context_choice_options, offsetof(struct info_settings, context)},
    {"", own_options, 0},
    {"", plain_options, offsetof(struct info_settings, common)},
    {0},
};

/* Labels are shown to the last digit. */
static int digits_of(double value)
{
    return fabs(value) < 0x1p53 && value == floor(value) ? 17 : 9;
}

static void put_volume(FILE *out, const conus_volume_info *info)
{
    fprintf(out, "  file         %s\n", info->path);
    fprintf(out, "  format       %s, %s", info->format, info->datatype);
    if (info->volume_count > 1) {
        fprintf(out, ", volume %zu of 0 to %zu", info->volume, info->volume_count - 1);
    }
    fprintf(out, "\n  size         %zu x %zu x %zu voxels of %.6g x %.6g x %.6g mm\n", info->dim[0], info->dim[1],
            info->dim[2], info->spacing[0], info->spacing[1], info->spacing[2]);
    fprintf(out, "  orientation  %s: %s\n", info->orientation, info->transform);
    fputs("  covers       ", out);
    for (size_t row = 0; row < 3; row++) {
        const double *m = info->world_from_voxel;
        double ends[2] = {m[12 + row], m[12 + row]};
        double scale = 0; /* the largest number in the sums */
        for (size_t i = 0; i < 3; i++) {
            double from = -0.5 * m[4 * i + row];
            double to = ((double)info->dim[i] - 0.5) * m[4 * i + row];
            ends[0] += from < to ? from : to;
            ends[1] += from < to ? to : from;
            scale = fmax(scale, fmax(fabs(m[12 + row]), fabs(to)));
        }
        info_drop_rounding(ends, 2, scale);
        fprintf(out, "%s%c %.6g to %.6g", row ? ", " : "", "xyz"[row], ends[0], ends[1]);
    }
    fprintf(out, " mm\n  values       %.*g to %.*g", digits_of(info->minimum), info->minimum, digits_of(info->maximum),
            info->maximum);
    if (info->slope != 1 || info->intercept != 0) {
        fprintf(out, ", stored * %.9g + %.9g", info->slope, info->intercept);
    }
    fprintf(out, "\n  sha256       %s\n", info->sha256);
}

/* The pathways, or the area, of a volume of values; the volume itself behind the first. */
static void put_objects(FILE *out, const conus_atlas *atlas, size_t volume)
{
    const conus_volume_info *info = conus_atlas_volume(atlas, volume);
    const conus_kind kind = info->role == CONUS_ROLE_PROBABILITY ? CONUS_KIND_AREA : CONUS_KIND_PATHWAY;
    size_t count = 0;
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        if (object->kind != kind || object->volume != volume) {
            continue;
        }
        fprintf(out, "%s %" PRIu32 ": %s\n", kind == CONUS_KIND_AREA ? "Area" : "Pathway", object->label, object->name);
        if (object->is_band) {
            fputs("  band        ", out);
            if (object->low > -INFINITY) {
                fprintf(out, " from %.9g%s", object->low, object->high < INFINITY ? " to" : " on");
            }
            if (object->high < INFINITY) {
                fprintf(out, " below %.9g", object->high);
            }
            fprintf(out, "%s, %" PRIu64 " voxels\n", isfinite(object->low) || isfinite(object->high) ? "" : " all",
                    object->voxels);
        }
        if (count++ == 0) {
            put_volume(out, info);
        }
        if (!object->is_band) {
            fprintf(out, "  threshold    %.9g\n", info->threshold);
        }
    }
}

/* Which published atlas it is, by its voxels. */
static void put_identity(FILE *out, const conus_atlas *atlas)
{
    const conus_atlas_identity_view identity = conus_atlas_identity(atlas);
    const conus_atlas_facts *facts = identity.facts;
    if (!*identity.sum) {
        return;
    }
    fprintf(out, "  voxels       %s\n", identity.sum);
    if (!facts) {
        fputs("  identity     unknown\n", out);
        return;
    }
    if (identity.is_verified) {
        fprintf(out, "  identity     %s, %s, on %s\n", facts->name, facts->edition, facts->space);
        fprintf(out, "  licence      %s\n", facts->licence);
    } else {
        fprintf(out, "  identity     %s by its labels and names; not verified: its voxels or their place differ\n",
                facts->name);
    }
    if (identity.has_other_names) {
        fputs("  names        others than those that were published with these voxels\n", out);
    }
    fprintf(out, "  reference    %s\n", facts->reference);
}

static void put_volumes(FILE *out, const conus_atlas *atlas)
{
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        const conus_volume_info *info = conus_atlas_volume(atlas, i);
        fputs(i ? "\n" : "", out);
        if (info->role == CONUS_ROLE_PARCELLATION) {
            fputs("Atlas\n", out);
            put_volume(out, info);
            /* Names of all volumes of labels have one source, which stands with the last. */
            const conus_volume_info *next = conus_atlas_volume(atlas, i + 1);
            if (!next || next->role != CONUS_ROLE_PARCELLATION) {
                const conus_brain_view brain = conus_atlas_brain(atlas);
                fprintf(out, "  labels       %s\n", conus_atlas_label_source(atlas));
                fprintf(out, "  brain        %s%s%s\n", brain.words, brain.brain ? ", by " : "",
                        strcmp(brain.source, "stated") == 0   ? "what is stated"
                        : strcmp(brain.source, "grid") == 0   ? "its grid"
                        : strcmp(brain.source, "voxels") == 0 ? "its voxels"
                        : brain.brain                         ? "its header"
                                                              : "");
                put_identity(out, atlas);
            }
        } else if (info->role != CONUS_ROLE_CONTEXT) {
            put_objects(out, atlas, i);
        } else {
            fputs("Context\n", out);
            put_volume(out, info);
            if (info->threshold > 0) {
                fprintf(out, "  blocks       from %.9g on\n", info->threshold);
            } else if (i && !conus_atlas_brain(atlas).is_moved) { /* conus_load_options.without_context */
                fputs("  answers      do not need it, without --inward or --atlas-transform\n", out);
            }
        }
    }
}

static void put_surfaces(FILE *out, const conus_atlas *atlas)
{
    size_t surfaces = 0;
    size_t closed = 0;
    unsigned long long triangles = 0;
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        surfaces += object->triangles > 0;
        closed += object->closed;
        triangles += object->triangles;
    }
    if (surfaces) {
        fprintf(out, "%sSurfaces\n  %zu, of them %zu closed; %llu triangles\n",
                conus_atlas_volume_count(atlas) ? "\n" : "", surfaces, closed, triangles);
    }
}

/* The surfaces of the context. */
static void put_around(FILE *out, const conus_atlas *atlas)
{
    for (size_t i = 0; i < conus_atlas_context_surface_count(atlas); i++) {
        conus_context_surface surface = CONUS_CONTEXT_SURFACE_INIT;
        if (conus_atlas_context_surface(&surface, atlas, i)) {
            continue;
        }
        fprintf(out, "\nContext, a surface\n  file         %s\n", surface.path);
        fprintf(out, "  triangles    %zu, %s\n", surface.triangles,
                surface.closed ? "closed" : "not closed: it does not say what is in the head");
        info_put_reach(out, surface.low, surface.high);
        fprintf(out, "  opacity      %.9g\n", surface.opacity);
    }
}

/* The columns of the list of areas, with the keys of info_json_object(); the last one only with bundles. */
static const char *const columns[] = {"kind",  "index",  "name",      "abbreviation", "hemisphere", "parent",
                                      "color", "voxels", "triangles", "closed",       "volume_mm3", "streamlines"};
enum {
    COLUMN_COUNT = sizeof columns / sizeof columns[0],
    INDEX = 1,
    PARENT = 5,
    VOXELS = 7,
    TRIANGLES,
    MM3 = 10,
    STREAMLINES
};
/* Those that are aligned by their ends. */
static const bool right[COLUMN_COUNT] = {
    [INDEX] = true, [PARENT] = true, [VOXELS] = true, [TRIANGLES] = true, [MM3] = true, [STREAMLINES] = true};

static void put_value(FILE *out, const json_t *value)
{
    if (json_is_integer(value)) {
        fprintf(out, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    } else if (json_is_real(value)) {
        fprintf(out, "%.9g", json_real_value(value));
    } else if (json_is_boolean(value)) {
        fputs(json_is_true(value) ? "yes" : "no", out);
    } else {
        fputs(json_string_length(value) ? json_string_value(value) : "n/a", out);
    }
}

static size_t column_count(const conus_atlas *atlas)
{
    return conus_atlas_tractogram_count(atlas) ? COLUMN_COUNT : COLUMN_COUNT - 1;
}

static bool put_tsv(FILE *out, const void *atlas)
{
    size_t count = column_count(atlas);
    bool whole = true;
    for (size_t c = 0; c < count; c++) {
        fprintf(out, "%s%s", c ? "\t" : "", columns[c]);
    }
    fputc('\n', out);
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        json_t *object = info_json_object(atlas, i);
        whole = object && whole;
        bool is_bundle = json_object_get(object, "streamlines");
        bool is_surface = json_is_integer(json_object_get(object, "triangles"));
        for (size_t c = 0; c < count; c++) {
            fputs(c ? "\t" : "", out);
            bool is_none = (is_bundle && (c == VOXELS || c == MM3)) || (is_surface && c == VOXELS);
            put_value(out, is_none ? NULL : json_object_get(object, columns[c]));
        }
        fputc('\n', out);
        json_decref(object);
    }
    return whole;
}

/* Where the Allen CCF lies in it, if it is one. */
static void put_ccf(FILE *out, const conus_atlas *atlas)
{
    conus_frame ccf;
    conus_frame bregma;
    if (conus_frame_find(&ccf, atlas, CONUS_SPACE_CCF, NULL) ||
        conus_frame_find(&bregma, atlas, CONUS_SPACE_BREGMA, NULL)) {
        return;
    }
    double at[6];
    memcpy(at, ccf.world_from_space + 12, 3 * sizeof *at);
    memcpy(at + 3, bregma.world_from_space + 12, 3 * sizeof *at);
    info_drop_rounding(at, 6, 0);
    bool to_right = ccf.world_from_space[8] > 0;
    fprintf(out, "Allen CCF\n  corner       x %.6g, y %.6g, z %.6g mm\n", at[0], at[1], at[2]);
    fprintf(out, "  bregma       x %.6g, y %.6g, z %.6g mm: AP %.6g, DV %.6g, ML %.6g um\n", at[3], at[4], at[5],
            bregma.bregma[0], bregma.bregma[1], bregma.bregma[2]);
    fprintf(out, "  ML grows     to the %s\n", to_right ? "right" : "left, by what the atlas says of its sides");
}

/* How many objects of each kind there are, and how deep the area tree is. */
static void put_counts(FILE *out, const conus_atlas *atlas)
{
    size_t areas = 0;
    size_t nameless = 0;
    size_t empty = 0;
    size_t bundles = 0;
    size_t depth = 0; /* of the deepest area, roots having 1 */
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        bool is_area = object->kind == CONUS_KIND_AREA;
        size_t own_depth = conus_atlas_depth(atlas, i);
        areas += is_area;
        nameless += is_area && !object->named;
        empty += is_area && object->voxels == 0 && object->triangles == 0;
        bundles += object->kind == CONUS_KIND_BUNDLE;
        depth = own_depth > depth ? own_depth : depth;
    }
    size_t pathways = conus_atlas_object_count(atlas) - areas - bundles;
    fprintf(out, "\n%zu area%s (%zu without a name, %zu without a shape), %zu pathway%s", areas, areas == 1 ? "" : "s",
            nameless, empty, pathways, pathways == 1 ? "" : "s");
    if (bundles) {
        fprintf(out, ", %zu bundle%s", bundles, bundles == 1 ? "" : "s");
    }
    fputc('\n', out);
    if (depth > 1) {
        fprintf(out, "area tree of %zu depths; --format tree shows it\n", depth);
    }
}

/* A pack and its sources; its sum is computed anew. */
static bool put_pack(FILE *out, const conus_atlas *atlas)
{
    const conus_pack_info *pack = conus_atlas_pack_info(atlas);
    const char *source;
    conus_source_state state;
    char sum[SHA256_TEXT];
    if (!pack) {
        return true;
    }
    if (provenance_hash_file(sum, pack->path)) {
        return false;
    }
    fprintf(out, "Pack\n  file         %s\n  size         %" PRIu64 " bytes\n", pack->path, pack->size);
    fprintf(out, "  sha256       %s%s\n", sum, strcmp(sum, pack->sha256) == 0 ? "" : ": its head has another one");
    fprintf(out, "  packed by    conus %s%s%s\n", pack->version, *pack->words ? ": " : "", pack->words);
    for (size_t i = 0; (source = conus_atlas_pack_source(&state, atlas, i)); i++) {
        fprintf(out, "  %-12s %s\n", info_source_states[state], source);
    }
    fputc('\n', out);
    return true;
}

static bool put_table(FILE *out, const conus_atlas *atlas, const conus_installed *installed)
{
    if (installed) {
        fprintf(out, "Installed atlas\n  name         %s:%s\n  file         %s\n", installed->source, installed->name,
                installed->path);
        if (installed->labels) {
            fprintf(out, "  labels       %s\n", installed->labels);
        }
        fputc('\n', out);
    }
    bool is_whole = put_pack(out, atlas);
    put_volumes(out, atlas);
    put_surfaces(out, atlas);
    info_tracts_put(out, atlas);
    put_around(out, atlas);
    put_ccf(out, atlas);
    info_place_put(out, atlas);
    size_t notes = conus_atlas_note_count(atlas);
    fputs(notes ? "\nNotes\n" : "", out);
    for (size_t i = 0; i < notes; i++) {
        fprintf(out, "  %s\n", conus_atlas_note(atlas, i));
    }
    put_counts(out, atlas);
    return aligned_put(out, put_tsv, atlas, column_count(atlas), right) && is_whole;
}

/* The forms in which an atlas is described. */
struct atlas_text {
    const conus_atlas *atlas;
    const conus_installed *installed;
    enum info_format format;
};

static bool put_atlas(FILE *out, const void *what)
{
    const struct atlas_text *text = what;
    switch (text->format) {
    case INFO_JSON:
        return json_put(out, info_json(text->atlas, text->installed), JSON_INDENT(2) | JSON_REAL_PRECISION(9));
    case INFO_TABLE:
        return put_table(out, text->atlas, text->installed);
    case INFO_TREE:
        return info_tree(out, text->atlas);
    default:
        return put_tsv(out, text->atlas);
    }
}

static int load_and_write(const struct atlas_name *name, const struct info_settings *settings)
{
    struct atlas_settings wanted = settings->atlas;
    conus_atlas *atlas = NULL;
    wanted.labels = atlas_name_labels(name, wanted.labels);
    int code = atlas_input_load(&atlas, name->path, &wanted);
    if (code) {
        return code;
    }
    code = context_choice_load(atlas, &settings->context, &settings->atlas);
    if (settings->format == INFO_TSV || settings->format == INFO_TREE) { /* which have no place for them */
        atlas_notes_say(atlas, &settings->common);
    }
    if (!code) {
        code = output_put(put_atlas, &(struct atlas_text){atlas, name->atlas, (enum info_format)settings->format});
    }
    conus_atlas_destroy(atlas);
    return code;
}

static int run_info(const void *given, const struct arguments *arguments)
{
    struct atlas_name name;
    int code = atlas_name_find(&name, arguments->operands[0]);
    code = code ? code : load_and_write(&name, given);
    atlas_name_finish(&name);
    return code;
}

const struct command cmd_info = {
    .name = "info",
    .summary = "show what an atlas contains and how it was read",
    .operands = {"ATLAS"},
    .holds = {HOLDS_ATLAS},
    .description =
        "Shows file, size, orientation and transform of every volume, where the names come from, and the\n"
        "areas, pathways and bundles. ATLAS is a labelled volume: .nii, .hdr/.img, .mgz, .nrrd, .mha, .HEAD or an FSL\n"
        "atlas .xml; for a 4-D file, FILE,volume=K chooses volume K from 0; FILE,resolution=25,orientation=asr\n"
        "says where a TIFF stack lies, unless metadata.json beside it does. Or it is a manifest, .atlas.json,\n"
        "that joins the files of a scene; info then checks all that it names. Surfaces, folders of them, and\n"
        "CIFTI labels (.dlabel.nii) beside their surfaces are atlases, too; FILE,map=K or FILE,map=NAME chooses\n"
        "one of several maps. Or it is the name of an installed atlas, which conus atlases lists; a file that is\n"
        "there comes first.",
    .examples = "  conus info aal.nii.gz\n"
                "  conus info aal\n"
                "  conus info aal.nii.gz --labels my_names.txt --format tsv\n",
    .groups = groups,
    .settings_size = sizeof(struct info_settings),
    .run = run_info,
};
