/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of the keys that each kind of JSON object may have drive the parser; one function per type of value. */
#include "loaders/manifest/manifest.h"

#include "base/formats/json_text.h"
#include "loaders/labels/label_cells.h"
#include "loaders/manifest/schema.h"

#include <math.h>
#include <string.h>

#define AT(type, member) .offset = offsetof(struct type, member)
#define WORDS(...)                                                                                                     \
    .words = (const char *const[])                                                                                     \
    {                                                                                                                  \
        __VA_ARGS__, NULL                                                                                              \
    }

/* Readers of keys of a struct manifest_volume. */
static void read_volume_number(const struct schema_place *place, void *out, const json_t *value)
{
    struct manifest_volume *volume = out;
    volume->chosen = true;
    schema_uint(place, &volume->volume, value);
}

static void read_resolution(const struct schema_place *place, void *out, const json_t *value)
{
    struct manifest_volume *volume = out;
    bool is_triple = json_array_size(value) == 3;
    if (!is_triple) {
        schema_fail(place, value, "a list of three numbers, in micrometres,");
    }
    for (size_t i = 0; is_triple && i < 3; i++) {
        struct schema_place inner = schema_element(place, i);
        schema_positive(&inner, &volume->resolution[i], json_array_get(value, i));
    }
}

static void read_transfer_file(const struct schema_place *place, void *out, const json_t *value)
{
    struct manifest_context *context = out;
    context->transfer_is_file = true;
    schema_path(place, &context->transfer, value);
}

static const struct schema_field transfer_keys[] = {{"file", .read = read_transfer_file, .required = true}, {0}};

static void read_transfer(const struct schema_place *place, void *out, const json_t *value)
{
    struct manifest_context *context = out;
    if (json_is_object(value)) {
        schema_object(place, out, value);
    } else {
        schema_text(place, &context->transfer, value);
    }
}

static const struct schema_field context_keys[] = {
    {"file", schema_path, AT(manifest_context, source.file), .required = true},
    {"volume", read_volume_number, AT(manifest_context, source), .wanted = "a whole number from 0"},
    {"resolution", read_resolution, AT(manifest_context, source)},
    {"orientation", schema_text, AT(manifest_context, source.orientation)},
    {"transfer", .read = read_transfer, .keys = transfer_keys},
    {"blocks", schema_positive, AT(manifest_context, blocks)},
    {"opacity", schema_positive, AT(manifest_context, opacity), .most = 1, .wanted = "a number above 0 to 1"},
    {"moves", schema_flag, AT(manifest_context, moves)},
    {0},
};

static const struct schema_field streamlines_keys[] = {
    {"file", schema_path, AT(manifest_streamlines, file), .required = true},
    {"name", schema_text, AT(manifest_streamlines, name)},
    {"radius", schema_positive, AT(manifest_streamlines, radius)},
    {"space", schema_word, AT(manifest_streamlines, space), WORDS("ras", "lps"), .first = CONUS_FILE_SPACE_RAS},
    {"moves", schema_flag, AT(manifest_streamlines, moves)},
    {"comment", .read = schema_comment},
    {0},
};

static void read_streamlines(const struct schema_place *place, void *out, const json_t *value)
{
    struct manifest_streamlines *streamlines = out;
    if (json_is_string(value)) {
        schema_path(place, &streamlines->file, value);
    } else {
        schema_object(place, out, value);
    }
}

static void read_transform_number(const struct schema_place *place, void *out, const json_t *value)
{
    uint32_t number;
    schema_uint(place, &number, value);
    *(size_t *)out = (size_t)number + 1;
}

static const struct schema_field transform_keys[] = {
    {"file", schema_path, AT(manifest_transform, file), .required = true},
    {"from", schema_path, AT(manifest_transform, from)},
    {"to", schema_path, AT(manifest_transform, to)},
    {"inverse", schema_flag, AT(manifest_transform, inverse)},
    {"grid", schema_path, AT(manifest_transform, grid)},
    {"vectors", schema_word, AT(manifest_transform, vectors), WORDS("as-stated", "relative", "absolute")},
    {"space", schema_word, AT(manifest_transform, space), WORDS("ras", "lps"), .first = CONUS_FILE_SPACE_RAS},
    {"transform", read_transform_number, AT(manifest_transform, transform)},
    {"comment", .read = schema_comment},
    {0},
};

static void read_version(const struct schema_place *place, void *out, const json_t *value)
{
    (void)out;
    if (!json_is_integer(value) || json_integer_value(value) != MANIFEST_VERSION) {
        schema_fail(place, value, "1, the version of this format,");
    }
}

static void read_parent(const struct schema_place *place, void *out, const json_t *value)
{
    struct label *label = out;
    label->has_parent = true;
    schema_uint(place, &label->parent, value);
}

static void read_color(const struct schema_place *place, void *out, const json_t *value)
{
    struct label *label = out;
    struct text text = text_from(json_is_string(value) ? json_string_value(value) : "");
    label->has_rgb = text.size == 7 && text.data[0] == '#' && strspn(text.data + 1, "0123456789abcdefABCDEF") == 6;
    if (label->has_rgb) {
        label_cell_colour(place->job, label->rgb, text);
    } else {
        schema_fail(place, value, "\"#rrggbb\"");
    }
}

static void read_hemisphere(const struct schema_place *place, void *out, const json_t *value)
{
    *(char *)out = place->field->words[schema_index(place, value)][0];
}

static const struct schema_field parcellation_keys[] = {
    {"file", schema_path, AT(manifest_parcellation, source.file), .required = true},
    {"volume", read_volume_number, AT(manifest_parcellation, source), .wanted = "a whole number from 0"},
    {"resolution", read_resolution, AT(manifest_parcellation, source)},
    {"orientation", schema_text, AT(manifest_parcellation, source.orientation)},
    {"labels", schema_path, AT(manifest_parcellation, labels)},
    {"label_offset", schema_uint, AT(manifest_parcellation, label_offset)},
    {"hemisphere", read_hemisphere, AT(manifest_parcellation, hemisphere), WORDS("L", "R", "B")},
    {"comment", .read = schema_comment},
    {0},
};

static void read_parcellations(const struct schema_place *place, void *out, const json_t *value)
{
    struct manifest_parcellation *const *known = out;
    if (*known) {
        job_bad(place->job, "has parcellation and parcellations, one of them is allowed");
    }
    schema_list(place, out, value);
}

static void read_end(const struct schema_place *place, void *out, const json_t *value)
{
    *(double *)out = json_number_value(value);
    if (!json_is_number(value)) {
        schema_fail(place, value, "a number");
    }
}

static const struct schema_field band_keys[] = {
    {"name", schema_text, AT(conus_band, name), .required = true},
    {"low", read_end, AT(conus_band, low)},
    {"high", read_end, AT(conus_band, high)},
    {"comment", .read = schema_comment},
    {0},
};

static void read_band(const struct schema_place *place, void *out, const json_t *value)
{
    *(conus_band *)out = (conus_band){.low = -INFINITY, .high = INFINITY};
    schema_object(place, out, value);
}

static const struct schema_field pathway_keys[] = {
    {"file", schema_path, AT(manifest_pathway, source.file)},
    {"volume", read_volume_number, AT(manifest_pathway, source), .wanted = "a whole number from 0"},
    {"resolution", read_resolution, AT(manifest_pathway, source)},
    {"orientation", schema_text, AT(manifest_pathway, source.orientation)},
    {"fsl", schema_path, AT(manifest_pathway, fsl)},
    {"name", schema_text, AT(manifest_pathway, name)},
    {"names", schema_list, SCHEMA_ENTRIES(manifest_pathway, names), .each = schema_text,
     .wanted = "a list of names, one per volume,"},
    {"threshold", schema_positive, AT(manifest_pathway, threshold)},
    {"scale", schema_positive, AT(manifest_pathway, scale)},
    {"bands", schema_list, SCHEMA_ENTRIES(manifest_pathway, bands), .each = read_band, .keys = band_keys,
     .wanted = "a list of bands"},
    {"moves", schema_flag, AT(manifest_pathway, moves)},
    {"comment", .read = schema_comment},
    {0},
};

static void check_pathway(const struct schema_place *place, const struct manifest_pathway *pathway)
{
    const struct manifest_volume *source = &pathway->source;
    const char *one = pathway->name               ? "name"
                      : source->chosen            ? "volume"
                      : source->orientation       ? "orientation"
                      : source->resolution[0] > 0 ? "resolution"
                                                  : NULL;
    const char *many = pathway->fsl ? "fsl" : pathway->names.count ? "names" : NULL;
    const char *of_all = pathway->name            ? "name" /* what bands have of their own */
                         : pathway->names.count   ? "names"
                         : pathway->fsl           ? "fsl"
                         : pathway->threshold > 0 ? "threshold"
                                                  : NULL;
    if (pathway->bands.count && of_all) {
        job_bad(place->job, "%s: has bands and %s, one of them is allowed", place->key, of_all);
    } else if (pathway->fsl && pathway->names.count) {
        job_bad(place->job, "%s: has fsl and names, one of them is allowed", place->key);
    } else if (one && many) {
        job_bad(place->job, "%s: has %s for one pathway and %s for several, one of them is allowed", place->key, one,
                many);
    } else if (!source->file && !pathway->fsl) {
        job_bad(place->job, "%s: file or fsl is missing", place->key);
    }
}

static void read_pathway(const struct schema_place *place, void *out, const json_t *value)
{
    const struct manifest_pathway *pathway = out;
    schema_path_or_object(place, out, value);
    check_pathway(place, pathway);
    if (pathway->scale != 0) {
        job_bad(place->job, "%s.scale: is for probabilities, a pathway has a threshold", place->key);
    }
}

static void read_map(const struct schema_place *place, void *out, const json_t *value)
{
    const struct manifest_pathway *map = out;
    schema_path_or_object(place, out, value);
    check_pathway(place, map);
    if (map->bands.count) {
        job_bad(place->job, "%s.bands: are for pathways, an area has a threshold", place->key);
    } else if (map->moves) {
        job_bad(place->job, "%s.moves: is for pathways and the context, areas always move", place->key);
    } else if (map->source.orientation || map->source.resolution[0] > 0) {
        job_bad(place->job, "%s: resolution and orientation are for pathways", place->key);
    } else if (map->threshold > 1) {
        job_bad(place->job, "%s.threshold: is %g, a probability is up to 1", place->key, map->threshold);
    }
}

static void read_area_label(const struct schema_place *place, void *out, const json_t *value)
{
    struct manifest_area *area = out;
    area->has_label = true;
    schema_uint(place, &area->label.number, value);
}

static void read_structures(const struct schema_place *place, void *out, const json_t *value)
{
    *(bool *)out = schema_index(place, value) == 1;
}

/* Each kind of entry has keys of its own; the key that decides comes first. */
static const struct schema_field file_keys[] = {
    {"file", schema_path, AT(manifest_area, file), .required = true},
    {"label", .read = read_area_label, .first = 1},
    {"name", schema_text, AT(manifest_area, label.name)},
    {"abbreviation", schema_text, AT(manifest_area, label.abbreviation)},
    {"color", read_color, AT(manifest_area, label)},
    {"parent", read_parent, AT(manifest_area, label), .first = 1},
    {"hemisphere", read_hemisphere, AT(manifest_area, label.hemisphere), WORDS("L", "R", "B")},
    {"vertex_labels", schema_path, AT(manifest_area, vertex_labels)},
    {"label_offset", schema_uint, AT(manifest_area, label_offset)},
    {"comment", .read = schema_comment},
    {0},
};
static const struct schema_field files_keys[] = {
    {"files", schema_path, AT(manifest_area, files), .required = true},
    {"labels", schema_path, AT(manifest_area, labels)},
    {"label_offset", schema_uint, AT(manifest_area, label_offset)},
    {"parent", read_parent, AT(manifest_area, label), .first = 1},
    {"hemisphere", read_hemisphere, AT(manifest_area, label.hemisphere), WORDS("L", "R", "B")},
    {"comment", .read = schema_comment},
    {0},
};
static const struct schema_field brainglobe_keys[] = {
    {"brainglobe", schema_path, AT(manifest_area, brainglobe), .required = true},
    {"structures", read_structures, AT(manifest_area, all_structures), WORDS("leaves", "all")},
    {"scale", schema_positive, AT(manifest_area, scale)},
    {"orientation", schema_text, AT(manifest_area, orientation)},
    {"comment", .read = schema_comment},
    {0},
};

static void read_area(const struct schema_place *place, void *out, const json_t *value)
{
    static const struct schema_field kinds[] = {{.keys = file_keys}, {.keys = files_keys}, {.keys = brainglobe_keys}};
    enum { KINDS = sizeof kinds / sizeof kinds[0] };
    const struct manifest_area *area = out;
    struct schema_place inner = *place;
    size_t kind = 0;
    while (kind < KINDS && !json_object_get(value, kinds[kind].keys->key)) {
        kind++;
    }
    if (json_is_object(value) && kind == KINDS) {
        job_bad(place->job, "%s: file, files or brainglobe is missing", place->key);
    }
    inner.field = &kinds[kind % KINDS];
    schema_path_or_object(&inner, out, value);
    bool single = area->has_label || area->label.name || area->label.abbreviation || area->label.has_rgb;
    if (area->vertex_labels && single) {
        job_bad(place->job, "%s: has vertex_labels for several areas and label, name, abbreviation or color of one",
                place->key);
    } else if (area->file && area->label_offset && !area->vertex_labels) {
        job_bad(place->job, "%s.label_offset: without vertex_labels, give label", place->key);
    }
}

static const struct schema_field node_keys[] = {
    {"label", schema_uint, AT(label, number), .first = 1, .required = true},
    {"parent", .read = read_parent, .first = 1},
    {"name", schema_text, AT(label, name)},
    {"abbreviation", schema_text, AT(label, abbreviation)},
    {"color", .read = read_color},
    {"comment", .read = schema_comment},
    {0},
};

/* For people and conus cite: a text, or a list of them. */
static void read_references(const struct schema_place *place, void *out, const json_t *value)
{
    if (!json_is_array(value)) {
        schema_comment(place, out, value);
    }
    for (size_t i = 0; i < json_array_size(value); i++) {
        struct schema_place inner = schema_element(place, i);
        schema_comment(&inner, out, json_array_get(value, i));
    }
}

static const struct schema_field manifest_keys[] = {
    {"conus_atlas", .read = read_version, .required = true},
    {"comment", .read = schema_comment},
    {"references", .read = read_references},
    {"allow_outside", schema_flag, AT(manifest, allow_outside)},
    {"parcellation", read_parcellations, SCHEMA_ENTRIES(manifest, parcellations), .each = schema_path_or_object,
     .keys = parcellation_keys, .many = SCHEMA_ONE},
    {"parcellations", read_parcellations, SCHEMA_ENTRIES(manifest, parcellations), .each = schema_path_or_object,
     .keys = parcellation_keys, .most = MANIFEST_FEW},
    {"areas", schema_list, SCHEMA_ENTRIES(manifest, areas), .each = read_area},
    {"space", schema_word, AT(manifest, space), WORDS("ras", "lps"), .first = MESH_SPACE_RAS},
    {"template", schema_word, AT(manifest, brain), WORDS("none", "mni152", "colin27", "mni305"),
     .first = CONUS_BRAIN_OWN},
    {"ccf", schema_word, AT(manifest, ccf), WORDS("asr", "asl"), .first = MANIFEST_CCF_ASR},
    {"prefer", schema_word, AT(manifest, prefer), WORDS("areas", "parcellation"), .first = MANIFEST_PREFER_AREAS},
    {"tree", schema_list, SCHEMA_ENTRIES(manifest, tree), .each = schema_object, .keys = node_keys},
    {"probabilities", schema_list, SCHEMA_ENTRIES(manifest, maps), .each = read_map, .keys = pathway_keys,
     .most = MANIFEST_MANY},
    {"pathways", schema_list, SCHEMA_ENTRIES(manifest, pathways), .each = read_pathway, .keys = pathway_keys,
     .most = MANIFEST_MANY},
    {"streamlines", schema_list, SCHEMA_ENTRIES(manifest, streamlines), .each = read_streamlines,
     .keys = streamlines_keys, .most = MANIFEST_MANY},
    {"threshold", schema_positive, AT(manifest, threshold)},
    {"transform", schema_list, SCHEMA_ENTRIES(manifest, transforms), .each = schema_path_or_object,
     .keys = transform_keys, .most = MANIFEST_FEW, .many = SCHEMA_ONE_OR_LIST},
    {"context", schema_list, SCHEMA_ENTRIES(manifest, contexts), .each = schema_path_or_object, .keys = context_keys,
     .most = MANIFEST_MANY, .many = SCHEMA_ONE_OR_LIST},
    {0},
};

static void check_manifest(struct job *job, const struct manifest *manifest)
{
    static const char why[] = "moves: there is no transform that could move it";
    bool labelled = manifest->parcellations.count || manifest->areas.count;
    bool moves = labelled || manifest->maps.count; /* a transform needs something that moves */
    bool fixed = !manifest->transforms.count;
    if (labelled && manifest->maps.count) {
        job_bad(job, "has probabilities and %s, which are areas both: one of them is allowed",
                manifest->areas.count ? "areas" : "a parcellation");
    } else if (!moves && !manifest->pathways.count && !manifest->streamlines.count) {
        job_bad(job, "nothing to select: parcellation, areas, probabilities, pathways or streamlines is needed");
    }
    for (size_t i = 0; i < manifest->pathways.count; i++) {
        if (manifest->pathways.at[i].moves && fixed) {
            job_bad(job, "pathways[%zu].%s", i, why);
        }
        moves = moves || manifest->pathways.at[i].moves;
    }
    for (size_t i = 0; i < manifest->streamlines.count; i++) {
        if (manifest->streamlines.at[i].moves && fixed) {
            job_bad(job, "streamlines[%zu].%s", i, why);
        }
        moves = moves || manifest->streamlines.at[i].moves;
    }
    for (size_t i = 0; i < manifest->contexts.count; i++) {
        if (manifest->contexts.at[i].moves && fixed) {
            job_bad(job, "context.%s", why);
        }
    }
    if (!moves && !fixed) {
        job_bad(job, "transform: there are no areas, and no pathway or streamlines say that they move");
    }
}

bool manifest_is(struct text text)
{
    struct text start = text_trim(text);
    return start.size && start.data[0] == '{' && text_mentions(start, "\"conus_atlas\"");
}

void manifest_parse(struct job *job, struct manifest *out, struct text text)
{
    static const struct schema_field whole = {.keys = manifest_keys};
    json_t *root = NULL;
    *out = (struct manifest){0};
    if (!JOB_CALL(job, json_text_load(&root, text))) {
        return;
    }
    const json_t *transform = json_object_get(root, "transform");
    const struct schema_place top = {
        .job = job, .field = &whole, .allow_outside = json_is_true(json_object_get(root, "allow_outside"))};
    schema_object(&top, out, root);
    check_manifest(job, out);
    out->single = json_object_get(root, "parcellation");
    out->single_transform = transform && !json_is_array(transform);
    json_decref(root);
}

static size_t count_volumes(const struct manifest_pathway *pathways, size_t count)
{
    size_t volumes = 0;
    for (size_t i = 0; i < count; i++) {
        volumes += pathways[i].names.count ? pathways[i].names.count : 1;
    }
    return volumes;
}

size_t manifest_file_count(const struct manifest *manifest)
{
    return manifest->parcellations.count + manifest->contexts.count + manifest->streamlines.count +
           count_volumes(manifest->maps.at, manifest->maps.count) +
           count_volumes(manifest->pathways.at, manifest->pathways.count);
}
