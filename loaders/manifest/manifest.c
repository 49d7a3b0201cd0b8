/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of the keys that each kind of JSON object may have drive the parser; one function per type of value. */
#include "loaders/manifest/manifest.h"

#include "base/memory.h"
#include "loaders/labels/label_cells.h"
#include "loaders/manifest/schema.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define AT(type, member) offsetof(struct type, member)

/* Readers of keys of a struct manifest_volume. */
static conus_status read_volume_number(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_volume *out = field;
    json_int_t number = json_is_integer(value) ? json_integer_value(value) : -1;
    if (number < 0 || number > UINT32_MAX) {
        return schema_fail(place, value, "a whole number from 0");
    }
    out->chosen = true;
    out->volume = (uint32_t)number;
    return CONUS_OK;
}

static conus_status read_resolution(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_volume *out = field;
    if (json_array_size(value) != 3) {
        return schema_fail(place, value, "a list of three numbers, in micrometres,");
    }
    conus_status status = CONUS_OK;
    for (size_t i = 0; !status && i < 3; i++) {
        struct schema_place inner = schema_element(place, i);
        status = schema_positive(&out->resolution[i], json_array_get(value, i), &inner);
    }
    return status;
}

static void manifest_volume_finish(struct manifest_volume *volume)
{
    memory_free(volume->file);
    memory_free(volume->orientation);
}

static conus_status read_transfer_file(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_context *context = field;
    context->transfer_is_file = true;
    return schema_path(&context->transfer, value, place);
}

static conus_status read_transfer(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_context *context = field;
    static const struct schema_field keys[] = {{"file", read_transfer_file, 0, true}, {0}};
    return json_is_object(value) ? schema_object(context, value, keys, place)
                                 : schema_text(&context->transfer, value, place);
}

static conus_status read_opacity(void *field, const json_t *value, const struct schema_place *place)
{
    double *out = field;
    *out = json_number_value(value);
    return *out > 0 && *out <= 1 ? CONUS_OK : schema_fail(place, value, "a number above 0 to 1");
}

/* Reads a path, an object, or a list of these, as schema_list() does. */
static conus_status read_one_or_list(void **entries, size_t *count, size_t size, size_t most, const json_t *value,
                                     schema_read read, const struct schema_place *place)
{
    if (json_is_array(value)) {
        return schema_list(entries, count, size, most, value, read, place);
    }
    if (!json_is_string(value) && !json_is_object(value)) {
        return schema_fail(place, value, "a path, an object or a list of these");
    }
    *entries = memory_zeroed(1, size);
    *count = *entries ? 1 : 0;
    return *entries ? read(*entries, value, place) : CONUS_ERROR_MEMORY;
}

static conus_status read_context(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(manifest_context, source.file), true},
        {"volume", read_volume_number, AT(manifest_context, source), false},
        {"resolution", read_resolution, AT(manifest_context, source), false},
        {"orientation", schema_text, AT(manifest_context, source.orientation), false},
        {"transfer", read_transfer, 0, false},
        {"blocks", schema_positive, AT(manifest_context, blocks), false},
        {"opacity", read_opacity, AT(manifest_context, opacity), false},
        {"moves", schema_flag, AT(manifest_context, moves), false},
        {0},
    };
    struct manifest_context *out = field;
    return schema_path_or_object(&out->source.file, out, value, keys, place);
}

static conus_status read_contexts(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    return read_one_or_list((void **)&out->contexts, &out->context_count, sizeof *out->contexts, MANIFEST_MANY, value,
                            read_context, place);
}

static conus_status read_streamlines(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(manifest_streamlines, file), true},
        {"name", schema_text, AT(manifest_streamlines, name), false},
        {"radius", schema_positive, AT(manifest_streamlines, radius), false},
        {"moves", schema_flag, AT(manifest_streamlines, moves), false},
        {"comment", schema_comment, 0, false},
        {0},
    };
    struct manifest_streamlines *out = field;
    return json_is_string(value) ? schema_path(&out->file, value, place) : schema_object(out, value, keys, place);
}

static conus_status read_transform_number(void *field, const json_t *value, const struct schema_place *place)
{
    uint32_t number = 0;
    conus_status status = schema_uint(&number, value, place, 0);
    *(size_t *)field = status ? 0 : (size_t)number + 1;
    return status;
}

static conus_status read_vectors(void *field, const json_t *value, const struct schema_place *place)
{
    static const char *const words[] = {"as-stated", "relative", "absolute", NULL};
    unsigned word = 0;
    conus_status status = schema_word(&word, value, place, words);
    *(conus_vectors *)field = (conus_vectors)word;
    return status;
}

static conus_status read_transform(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(manifest_transform, file), true},
        {"from", schema_path, AT(manifest_transform, from), false},
        {"to", schema_path, AT(manifest_transform, to), false},
        {"inverse", schema_flag, AT(manifest_transform, inverse), false},
        {"grid", schema_path, AT(manifest_transform, grid), false},
        {"vectors", read_vectors, AT(manifest_transform, vectors), false},
        {"transform", read_transform_number, AT(manifest_transform, transform), false},
        {"comment", schema_comment, 0, false},
        {0},
    };
    struct manifest_transform *out = field;
    return schema_path_or_object(&out->file, out, value, keys, place);
}

static conus_status read_transforms(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    out->single_transform = !json_is_array(value);
    return read_one_or_list((void **)&out->transforms, &out->transform_count, sizeof *out->transforms, MANIFEST_FEW,
                            value, read_transform, place);
}

static conus_status read_version(void *field, const json_t *value, const struct schema_place *place)
{
    (void)field;
    return json_is_integer(value) && json_integer_value(value) == MANIFEST_VERSION
               ? CONUS_OK
               : schema_fail(place, value, "1, the version of this format,");
}

static conus_status read_names(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_pathway *pathway = field;
    size_t count = json_array_size(value);
    if (!count) {
        return schema_fail(place, value, "a list of names, one per volume,");
    }
    pathway->names = memory_zeroed(count, sizeof *pathway->names);
    pathway->name_count = pathway->names ? count : 0;
    conus_status status = pathway->names ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        struct schema_place inner = schema_element(place, i);
        status = schema_text(&pathway->names[i], json_array_get(value, i), &inner);
    }
    return status;
}

static conus_status read_offset(void *field, const json_t *value, const struct schema_place *place)
{
    return schema_uint(field, value, place, 0);
}

static conus_status read_label_number(void *field, const json_t *value, const struct schema_place *place)
{
    return schema_uint(&((struct label *)field)->number, value, place, 1);
}

static conus_status read_parent(void *field, const json_t *value, const struct schema_place *place)
{
    struct label *label = field;
    label->has_parent = true;
    return schema_uint(&label->parent, value, place, 1);
}

static conus_status read_color(void *field, const json_t *value, const struct schema_place *place)
{
    struct label *label = field;
    const char *text = json_string_value(value);
    label->has_rgb = text && text[0] == '#' && strlen(text) == 7 && strspn(text + 1, "0123456789abcdefABCDEF") == 6;
    return label->has_rgb ? label_cell_colour(label->rgb, text_from(text), place->key)
                          : schema_fail(place, value, "\"#rrggbb\"");
}

static conus_status read_hemisphere(void *field, const json_t *value, const struct schema_place *place)
{
    static const char *const words[] = {"L", "R", "B", NULL};
    unsigned word = 0;
    char *hemisphere = field;
    conus_status status = schema_word(&word, value, place, words);
    *hemisphere = status ? 0 : words[word][0];
    return status;
}

static conus_status read_labelled(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(manifest_parcellation, source.file), true},
        {"volume", read_volume_number, AT(manifest_parcellation, source), false},
        {"resolution", read_resolution, AT(manifest_parcellation, source), false},
        {"orientation", schema_text, AT(manifest_parcellation, source.orientation), false},
        {"labels", schema_path, AT(manifest_parcellation, labels), false},
        {"label_offset", read_offset, AT(manifest_parcellation, label_offset), false},
        {"hemisphere", read_hemisphere, AT(manifest_parcellation, hemisphere), false},
        {"comment", schema_comment, 0, false},
        {0},
    };
    struct manifest_parcellation *out = field;
    return schema_path_or_object(&out->source.file, out, value, keys, place);
}

static conus_status refuse_both(const struct manifest *manifest)
{
    return manifest->parcellations
               ? fail(CONUS_ERROR_DATA, "has parcellation and parcellations, one of them is allowed")
               : CONUS_OK;
}

static conus_status read_parcellation(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    conus_status status = refuse_both(out);
    if (status) {
        return status;
    }
    out->parcellations = memory_zeroed(1, sizeof *out->parcellations);
    out->parcellation_count = out->parcellations ? 1 : 0;
    out->single = true;
    return out->parcellations ? read_labelled(out->parcellations, value, place) : CONUS_ERROR_MEMORY;
}

static conus_status read_parcellations(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    conus_status status = refuse_both(out);
    return status ? status
                  : schema_list((void **)&out->parcellations, &out->parcellation_count, sizeof *out->parcellations,
                                MANIFEST_FEW, value, read_labelled, place);
}

static conus_status read_end(void *field, const json_t *value, const struct schema_place *place)
{
    double *out = field;
    *out = json_number_value(value);
    return json_is_number(value) ? CONUS_OK : schema_fail(place, value, "a number");
}

static conus_status read_band(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"name", schema_text, AT(conus_band, name), true},
        {"low", read_end, AT(conus_band, low), false},
        {"high", read_end, AT(conus_band, high), false},
        {"comment", schema_comment, 0, false},
        {0},
    };
    conus_band *band = field;
    band->low = -INFINITY;
    band->high = INFINITY;
    return schema_object(band, value, keys, place);
}

static conus_status read_bands(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_pathway *out = field;
    if (!json_array_size(value)) {
        return schema_fail(place, value, "a list of bands");
    }
    return schema_list((void **)&out->bands, &out->band_count, sizeof *out->bands, SIZE_MAX, value, read_band, place);
}

static conus_status check_pathway(const struct manifest_pathway *pathway, const struct schema_place *place)
{
    const struct manifest_volume *source = &pathway->source;
    const char *one = pathway->name               ? "name"
                      : source->chosen            ? "volume"
                      : source->orientation       ? "orientation"
                      : source->resolution[0] > 0 ? "resolution"
                                                  : NULL;
    const char *many = pathway->fsl ? "fsl" : pathway->names ? "names" : NULL;
    const char *of_all = pathway->name            ? "name" /* what bands have of their own */
                         : pathway->names         ? "names"
                         : pathway->fsl           ? "fsl"
                         : pathway->threshold > 0 ? "threshold"
                                                  : NULL;
    if (pathway->band_count && of_all) {
        return fail(CONUS_ERROR_DATA, "%s: has bands and %s, one of them is allowed", place->key, of_all);
    }
    if (pathway->fsl && pathway->names) {
        return fail(CONUS_ERROR_DATA, "%s: has fsl and names, one of them is allowed", place->key);
    }
    if (one && many) {
        return fail(CONUS_ERROR_DATA, "%s: has %s for one pathway and %s for several, one of them is allowed",
                    place->key, one, many);
    }
    return pathway->source.file || pathway->fsl ? CONUS_OK
                                                : fail(CONUS_ERROR_DATA, "%s: file or fsl is missing", place->key);
}

static conus_status read_entry(struct manifest_pathway *out, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"file", schema_path, AT(manifest_pathway, source.file), false},
        {"volume", read_volume_number, AT(manifest_pathway, source), false},
        {"resolution", read_resolution, AT(manifest_pathway, source), false},
        {"orientation", schema_text, AT(manifest_pathway, source.orientation), false},
        {"fsl", schema_path, AT(manifest_pathway, fsl), false},
        {"name", schema_text, AT(manifest_pathway, name), false},
        {"names", read_names, 0, false},
        {"threshold", schema_positive, AT(manifest_pathway, threshold), false},
        {"scale", schema_positive, AT(manifest_pathway, scale), false},
        {"bands", read_bands, 0, false},
        {"moves", schema_flag, AT(manifest_pathway, moves), false},
        {"comment", schema_comment, 0, false},
        {0},
    };
    conus_status status = schema_path_or_object(&out->source.file, out, value, keys, place);
    return status || json_is_string(value) ? status : check_pathway(out, place);
}

static conus_status read_pathway(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_pathway *out = field;
    conus_status status = read_entry(out, value, place);
    return status || out->scale == 0
               ? status
               : fail(CONUS_ERROR_DATA, "%s.scale: is of probabilities, a pathway has a threshold", place->key);
}

static conus_status read_map(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_pathway *out = field;
    conus_status status = read_entry(out, value, place);
    if (!status && out->band_count) {
        return fail(CONUS_ERROR_DATA, "%s.bands: are of pathways, an area has a threshold", place->key);
    }
    if (!status && out->moves) {
        return fail(CONUS_ERROR_DATA, "%s.moves: is of pathways and the context, areas always move", place->key);
    }
    if (!status && (out->source.orientation || out->source.resolution[0] > 0)) {
        return fail(CONUS_ERROR_DATA, "%s: resolution and orientation are of pathways", place->key);
    }
    return status || out->threshold <= 1
               ? status
               : fail(CONUS_ERROR_DATA, "%s.threshold: is %g, a probability is up to 1", place->key, out->threshold);
}

static conus_status read_area_label(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_area *area = field;
    area->has_label = true;
    return read_label_number(&area->label, value, place);
}

static conus_status read_structures(void *field, const json_t *value, const struct schema_place *place)
{
    static const char *const words[] = {"leaves", "all", NULL};
    unsigned word = 0;
    conus_status status = schema_word(&word, value, place, words);
    ((struct manifest_area *)field)->all_structures = word == 1;
    return status;
}

/* Each kind of entry has keys of its own; the key that decides comes first. */
static const struct schema_field file_keys[] = {
    {"file", schema_path, AT(manifest_area, file), true},
    {"label", read_area_label, 0, false},
    {"name", schema_text, AT(manifest_area, label.name), false},
    {"abbreviation", schema_text, AT(manifest_area, label.abbreviation), false},
    {"color", read_color, AT(manifest_area, label), false},
    {"parent", read_parent, AT(manifest_area, label), false},
    {"hemisphere", read_hemisphere, AT(manifest_area, label.hemisphere), false},
    {"vertex_labels", schema_path, AT(manifest_area, vertex_labels), false},
    {"label_offset", read_offset, AT(manifest_area, label_offset), false},
    {"comment", schema_comment, 0, false},
    {0},
};
static const struct schema_field files_keys[] = {
    {"files", schema_path, AT(manifest_area, files), true},
    {"labels", schema_path, AT(manifest_area, labels), false},
    {"label_offset", read_offset, AT(manifest_area, label_offset), false},
    {"parent", read_parent, AT(manifest_area, label), false},
    {"hemisphere", read_hemisphere, AT(manifest_area, label.hemisphere), false},
    {"comment", schema_comment, 0, false},
    {0},
};
static const struct schema_field brainglobe_keys[] = {
    {"brainglobe", schema_path, AT(manifest_area, brainglobe), true},
    {"structures", read_structures, 0, false},
    {"scale", schema_positive, AT(manifest_area, scale), false},
    {"orientation", schema_text, AT(manifest_area, orientation), false},
    {"comment", schema_comment, 0, false},
    {0},
};

static conus_status read_area(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field *const kinds[] = {file_keys, files_keys, brainglobe_keys};
    const struct schema_field *keys = NULL;
    struct manifest_area *out = field;
    for (size_t i = 0; !keys && i < sizeof kinds / sizeof kinds[0]; i++) {
        keys = json_object_get(value, kinds[i]->key) ? kinds[i] : NULL;
    }
    if (json_is_object(value) && !keys) {
        return fail(CONUS_ERROR_DATA, "%s: file, files or brainglobe is missing", place->key);
    }
    conus_status status = schema_path_or_object(&out->file, out, value, keys, place);
    if (status || json_is_string(value)) {
        return status;
    }
    bool single = out->has_label || out->label.name || out->label.abbreviation || out->label.has_rgb;
    if (out->vertex_labels && single) {
        return fail(CONUS_ERROR_DATA,
                    "%s: has vertex_labels for several areas and label, name, abbreviation or color of one",
                    place->key);
    }
    if (out->file && out->label_offset && !out->vertex_labels) {
        return fail(CONUS_ERROR_DATA, "%s.label_offset: without vertex_labels, give label", place->key);
    }
    return CONUS_OK;
}

static conus_status read_node(void *field, const json_t *value, const struct schema_place *place)
{
    static const struct schema_field keys[] = {
        {"label", read_label_number, 0, true},
        {"parent", read_parent, 0, false},
        {"name", schema_text, AT(label, name), false},
        {"abbreviation", schema_text, AT(label, abbreviation), false},
        {"color", read_color, 0, false},
        {"comment", schema_comment, 0, false},
        {0},
    };
    return schema_object(field, value, keys, place);
}

/* Defines a reader of a list of a struct manifest, whose entries `read` reads. */
#define DEFINE_LIST(name, entries, count, most, read)                                                                  \
    static conus_status name(void *field, const json_t *value, const struct schema_place *place)                       \
    {                                                                                                                  \
        struct manifest *out = field;                                                                                  \
        return schema_list((void **)&out->entries, &out->count, sizeof *out->entries, most, value, read, place);       \
    }

DEFINE_LIST(read_pathways, pathways, pathway_count, MANIFEST_MANY, read_pathway)
DEFINE_LIST(read_maps, maps, map_count, MANIFEST_MANY, read_map)
DEFINE_LIST(read_areas, areas, area_count, SIZE_MAX, read_area)
DEFINE_LIST(read_tree, tree, tree_count, SIZE_MAX, read_node)
DEFINE_LIST(read_all_streamlines, streamlines, streamlines_count, MANIFEST_MANY, read_streamlines)

static conus_status read_space(void *field, const json_t *value, const struct schema_place *place)
{
    static const char *const words[] = {"ras", "lps", NULL};
    unsigned word = 0;
    conus_status status = schema_word(&word, value, place, words);
    ((struct manifest *)field)->space = word ? MESH_SPACE_LPS : MESH_SPACE_RAS;
    return status;
}

static conus_status read_ccf(void *field, const json_t *value, const struct schema_place *place)
{
    static const char *const words[] = {"asr", "asl", NULL};
    unsigned word = 0;
    conus_status status = schema_word(&word, value, place, words);
    ((struct manifest *)field)->ccf = word ? MANIFEST_CCF_ASL : MANIFEST_CCF_ASR;
    return status;
}

static conus_status read_prefer(void *field, const json_t *value, const struct schema_place *place)
{
    static const char *const words[] = {"areas", "parcellation", NULL};
    unsigned word = 0;
    conus_status status = schema_word(&word, value, place, words);
    ((struct manifest *)field)->prefer = word ? MANIFEST_PREFER_PARCELLATION : MANIFEST_PREFER_AREAS;
    return status;
}

/* For people and conus cite: a text, or a list of them. */
static conus_status read_references(void *field, const json_t *value, const struct schema_place *place)
{
    conus_status status = json_is_array(value) ? CONUS_OK : schema_comment(field, value, place);
    for (size_t i = 0; !status && i < json_array_size(value); i++) {
        struct schema_place inner = schema_element(place, i);
        status = schema_comment(field, json_array_get(value, i), &inner);
    }
    return status;
}

static const struct schema_field manifest_keys[] = {
    {"conus_atlas", read_version, 0, true},
    {"comment", schema_comment, 0, false},
    {"references", read_references, 0, false},
    {"allow_outside", schema_flag, AT(manifest, allow_outside), false},
    {"parcellation", read_parcellation, 0, false},
    {"parcellations", read_parcellations, 0, false},
    {"areas", read_areas, 0, false},
    {"space", read_space, 0, false},
    {"ccf", read_ccf, 0, false},
    {"prefer", read_prefer, 0, false},
    {"tree", read_tree, 0, false},
    {"probabilities", read_maps, 0, false},
    {"pathways", read_pathways, 0, false},
    {"streamlines", read_all_streamlines, 0, false},
    {"threshold", schema_positive, AT(manifest, threshold), false},
    {"transform", read_transforms, 0, false},
    {"context", read_contexts, 0, false},
    {0},
};

static conus_status check_manifest(const struct manifest *manifest)
{
    static const char why[] = "moves: there is no transform that could move it";
    bool labelled = manifest->parcellation_count || manifest->area_count;
    if (labelled && manifest->map_count) {
        return fail(CONUS_ERROR_DATA, "has probabilities and %s, which are areas both: one of them is allowed",
                    manifest->area_count ? "areas" : "a parcellation");
    }
    bool moves = labelled || manifest->map_count; /* a transform needs something that moves */
    if (!moves && !manifest->pathway_count && !manifest->streamlines_count) {
        return fail(CONUS_ERROR_DATA,
                    "nothing to select: parcellation, areas, probabilities, pathways or streamlines is needed");
    }
    for (size_t i = 0; i < manifest->pathway_count; i++) {
        if (manifest->pathways[i].moves && !manifest->transform_count) {
            return fail(CONUS_ERROR_DATA, "pathways[%zu].%s", i, why);
        }
        moves = moves || manifest->pathways[i].moves;
    }
    for (size_t i = 0; i < manifest->streamlines_count; i++) {
        if (manifest->streamlines[i].moves && !manifest->transform_count) {
            return fail(CONUS_ERROR_DATA, "streamlines[%zu].%s", i, why);
        }
        moves = moves || manifest->streamlines[i].moves;
    }
    for (size_t i = 0; i < manifest->context_count; i++) {
        if (manifest->contexts[i].moves && !manifest->transform_count) {
            return fail(CONUS_ERROR_DATA, "context.%s", why);
        }
    }
    return moves || !manifest->transform_count
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA,
                      "transform: there are no areas, and no pathway or streamlines say that they move");
}

bool manifest_is(struct text text)
{
    struct text start = text_trim(text);
    return start.size && start.data[0] == '{' && text_mentions(start, "\"conus_atlas\"");
}

conus_status manifest_parse(struct manifest *out, struct text text)
{
    json_t *root = NULL;
    struct manifest manifest = {0};
    conus_status status = json_text_load(&root, text);
    struct schema_place place = {.allow_outside = json_is_true(json_object_get(root, "allow_outside"))};
    status = status ? status : schema_object(&manifest, root, manifest_keys, &place);
    status = status ? status : check_manifest(&manifest);
    json_decref(root);
    if (status) {
        manifest_finish(&manifest);
        return status;
    }
    *out = manifest;
    return CONUS_OK;
}

static void pathway_finish(struct manifest_pathway *pathway)
{
    for (size_t i = 0; i < pathway->name_count; i++) {
        memory_free(pathway->names[i]);
    }
    for (size_t i = 0; i < pathway->band_count; i++) {
        memory_free((char *)pathway->bands[i].name);
    }
    memory_free(pathway->bands);
    memory_free(pathway->names);
    memory_free(pathway->name);
    memory_free(pathway->fsl);
    manifest_volume_finish(&pathway->source);
}

void manifest_finish(struct manifest *manifest)
{
    for (size_t i = 0; i < manifest->area_count; i++) {
        struct manifest_area *area = &manifest->areas[i];
        memory_free(area->file);
        memory_free(area->files);
        memory_free(area->brainglobe);
        label_finish(&area->label);
        memory_free(area->vertex_labels);
        memory_free(area->labels);
        memory_free(area->orientation);
    }
    for (size_t i = 0; i < manifest->tree_count; i++) {
        label_finish(&manifest->tree[i]);
    }
    memory_free(manifest->areas);
    memory_free(manifest->tree);
    for (size_t i = 0; i < manifest->map_count; i++) {
        pathway_finish(&manifest->maps[i]);
    }
    memory_free(manifest->maps);
    for (size_t i = 0; i < manifest->pathway_count; i++) {
        pathway_finish(&manifest->pathways[i]);
    }
    memory_free(manifest->pathways);
    for (size_t i = 0; i < manifest->parcellation_count; i++) {
        manifest_volume_finish(&manifest->parcellations[i].source);
        memory_free(manifest->parcellations[i].labels);
    }
    memory_free(manifest->parcellations);
    for (size_t i = 0; i < manifest->streamlines_count; i++) {
        memory_free(manifest->streamlines[i].file);
        memory_free(manifest->streamlines[i].name);
    }
    memory_free(manifest->streamlines);
    for (size_t i = 0; i < manifest->context_count; i++) {
        manifest_volume_finish(&manifest->contexts[i].source);
        memory_free(manifest->contexts[i].transfer);
    }
    memory_free(manifest->contexts);
    for (size_t i = 0; i < manifest->transform_count; i++) {
        memory_free(manifest->transforms[i].file);
        memory_free(manifest->transforms[i].from);
        memory_free(manifest->transforms[i].to);
        memory_free(manifest->transforms[i].grid);
    }
    memory_free(manifest->transforms);
    *manifest = (struct manifest){0};
}

size_t manifest_file_count(const struct manifest *manifest)
{
    size_t files = manifest->parcellation_count + manifest->context_count + manifest->streamlines_count;
    for (size_t i = 0; i < manifest->map_count; i++) {
        files += manifest->maps[i].names ? manifest->maps[i].name_count : 1;
    }
    for (size_t i = 0; i < manifest->pathway_count; i++) {
        files += manifest->pathways[i].names ? manifest->pathways[i].name_count : 1;
    }
    return files;
}
