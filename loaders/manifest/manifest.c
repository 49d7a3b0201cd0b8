/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of the keys that each kind of JSON object may have drive the parser; one function per type of value. */
#include "loaders/manifest/manifest.h"

#include "base/memory.h"
#include "loaders/labels/label_cells.h"
#include "loaders/manifest/schema.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define AT(type, member) .offset = offsetof(struct type, member)
#define WORDS(...)                                                                                                     \
    .words = (const char *const[])                                                                                     \
    {                                                                                                                  \
        __VA_ARGS__, NULL                                                                                              \
    }

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

static conus_status read_transfer_file(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_context *context = field;
    context->transfer_is_file = true;
    return schema_path(&context->transfer, value, place);
}

static conus_status read_transfer(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_context *context = field;
    static const struct schema_field keys[] = {{"file", read_transfer_file, .required = true}, {0}};
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

static const struct schema_field context_keys[] = {
    {"file", schema_path, AT(manifest_context, source.file), .required = true},
    {"volume", read_volume_number, AT(manifest_context, source)},
    {"resolution", read_resolution, AT(manifest_context, source)},
    {"orientation", schema_text, AT(manifest_context, source.orientation)},
    {"transfer", .read = read_transfer},
    {"blocks", schema_positive, AT(manifest_context, blocks)},
    {"opacity", read_opacity, AT(manifest_context, opacity)},
    {"moves", schema_flag, AT(manifest_context, moves)},
    {0},
};

static conus_status read_context(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_context *out = field;
    return schema_path_or_object(&out->source.file, out, value, context_keys, place);
}

static conus_status read_contexts(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest *out = field;
    return read_one_or_list((void **)&out->contexts, &out->context_count, sizeof *out->contexts, MANIFEST_MANY, value,
                            read_context, place);
}

static const struct schema_field streamlines_keys[] = {
    {"file", schema_path, AT(manifest_streamlines, file), .required = true},
    {"name", schema_text, AT(manifest_streamlines, name)},
    {"radius", schema_positive, AT(manifest_streamlines, radius)},
    {"space", WORDS("ras", "lps"), .first = CONUS_FILE_SPACE_RAS, AT(manifest_streamlines, space)},
    {"moves", schema_flag, AT(manifest_streamlines, moves)},
    {"comment", .read = schema_comment},
    {0},
};

static conus_status read_streamlines(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_streamlines *out = field;
    return json_is_string(value) ? schema_path(&out->file, value, place)
                                 : schema_object(out, value, streamlines_keys, place);
}

static conus_status read_transform_number(void *field, const json_t *value, const struct schema_place *place)
{
    uint32_t number = 0;
    conus_status status = schema_uint(&number, value, place, 0);
    *(size_t *)field = status ? 0 : (size_t)number + 1;
    return status;
}

static const struct schema_field transform_keys[] = {
    {"file", schema_path, AT(manifest_transform, file), .required = true},
    {"from", schema_path, AT(manifest_transform, from)},
    {"to", schema_path, AT(manifest_transform, to)},
    {"inverse", schema_flag, AT(manifest_transform, inverse)},
    {"grid", schema_path, AT(manifest_transform, grid)},
    {"vectors", WORDS("as-stated", "relative", "absolute"), AT(manifest_transform, vectors)},
    {"space", WORDS("ras", "lps"), .first = CONUS_FILE_SPACE_RAS, AT(manifest_transform, space)},
    {"transform", read_transform_number, AT(manifest_transform, transform)},
    {"comment", .read = schema_comment},
    {0},
};

static conus_status read_transform(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_transform *out = field;
    return schema_path_or_object(&out->file, out, value, transform_keys, place);
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
    if (!label->has_rgb) {
        return schema_fail(place, value, "\"#rrggbb\"");
    }
    struct job job = {0}; /* Bridge: to label tables on a job. */
    label_cell_colour(&job, label->rgb, text_from(text));
    return job_close(&job, NULL, NULL);
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

static const struct schema_field parcellation_keys[] = {
    {"file", schema_path, AT(manifest_parcellation, source.file), .required = true},
    {"volume", read_volume_number, AT(manifest_parcellation, source)},
    {"resolution", read_resolution, AT(manifest_parcellation, source)},
    {"orientation", schema_text, AT(manifest_parcellation, source.orientation)},
    {"labels", schema_path, AT(manifest_parcellation, labels)},
    {"label_offset", read_offset, AT(manifest_parcellation, label_offset)},
    {"hemisphere", read_hemisphere, AT(manifest_parcellation, hemisphere)},
    {"comment", .read = schema_comment},
    {0},
};

static conus_status read_labelled(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_parcellation *out = field;
    return schema_path_or_object(&out->source.file, out, value, parcellation_keys, place);
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
        {"name", schema_text, AT(conus_band, name), .required = true},
        {"low", read_end, AT(conus_band, low)},
        {"high", read_end, AT(conus_band, high)},
        {"comment", .read = schema_comment},
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

static const struct schema_field pathway_keys[] = {
    {"file", schema_path, AT(manifest_pathway, source.file)},
    {"volume", read_volume_number, AT(manifest_pathway, source)},
    {"resolution", read_resolution, AT(manifest_pathway, source)},
    {"orientation", schema_text, AT(manifest_pathway, source.orientation)},
    {"fsl", schema_path, AT(manifest_pathway, fsl)},
    {"name", schema_text, AT(manifest_pathway, name)},
    {"names", .read = read_names},
    {"threshold", schema_positive, AT(manifest_pathway, threshold)},
    {"scale", schema_positive, AT(manifest_pathway, scale)},
    {"bands", .read = read_bands},
    {"moves", schema_flag, AT(manifest_pathway, moves)},
    {"comment", .read = schema_comment},
    {0},
};

static conus_status read_entry(struct manifest_pathway *out, const json_t *value, const struct schema_place *place)
{
    conus_status status = schema_path_or_object(&out->source.file, out, value, pathway_keys, place);
    return status || json_is_string(value) ? status : check_pathway(out, place);
}

static conus_status read_pathway(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_pathway *out = field;
    conus_status status = read_entry(out, value, place);
    return status || out->scale == 0
               ? status
               : fail(CONUS_ERROR_DATA, "%s.scale: is for probabilities, a pathway has a threshold", place->key);
}

static conus_status read_map(void *field, const json_t *value, const struct schema_place *place)
{
    struct manifest_pathway *out = field;
    conus_status status = read_entry(out, value, place);
    if (!status && out->band_count) {
        return fail(CONUS_ERROR_DATA, "%s.bands: are for pathways, an area has a threshold", place->key);
    }
    if (!status && out->moves) {
        return fail(CONUS_ERROR_DATA, "%s.moves: is for pathways and the context, areas always move", place->key);
    }
    if (!status && (out->source.orientation || out->source.resolution[0] > 0)) {
        return fail(CONUS_ERROR_DATA, "%s: resolution and orientation are for pathways", place->key);
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
    {"file", schema_path, AT(manifest_area, file), .required = true},
    {"label", .read = read_area_label},
    {"name", schema_text, AT(manifest_area, label.name)},
    {"abbreviation", schema_text, AT(manifest_area, label.abbreviation)},
    {"color", read_color, AT(manifest_area, label)},
    {"parent", read_parent, AT(manifest_area, label)},
    {"hemisphere", read_hemisphere, AT(manifest_area, label.hemisphere)},
    {"vertex_labels", schema_path, AT(manifest_area, vertex_labels)},
    {"label_offset", read_offset, AT(manifest_area, label_offset)},
    {"comment", .read = schema_comment},
    {0},
};
static const struct schema_field files_keys[] = {
    {"files", schema_path, AT(manifest_area, files), .required = true},
    {"labels", schema_path, AT(manifest_area, labels)},
    {"label_offset", read_offset, AT(manifest_area, label_offset)},
    {"parent", read_parent, AT(manifest_area, label)},
    {"hemisphere", read_hemisphere, AT(manifest_area, label.hemisphere)},
    {"comment", .read = schema_comment},
    {0},
};
static const struct schema_field brainglobe_keys[] = {
    {"brainglobe", schema_path, AT(manifest_area, brainglobe), .required = true},
    {"structures", .read = read_structures},
    {"scale", schema_positive, AT(manifest_area, scale)},
    {"orientation", schema_text, AT(manifest_area, orientation)},
    {"comment", .read = schema_comment},
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

static const struct schema_field node_keys[] = {
    {"label", read_label_number, .required = true},
    {"parent", .read = read_parent},
    {"name", schema_text, AT(label, name)},
    {"abbreviation", schema_text, AT(label, abbreviation)},
    {"color", .read = read_color},
    {"comment", .read = schema_comment},
    {0},
};

static conus_status read_node(void *field, const json_t *value, const struct schema_place *place)
{
    return schema_object(field, value, node_keys, place);
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
    {"conus_atlas", read_version, .required = true},
    {"comment", .read = schema_comment},
    {"references", .read = read_references},
    {"allow_outside", schema_flag, AT(manifest, allow_outside)},
    {"parcellation", .read = read_parcellation},
    {"parcellations", .read = read_parcellations},
    {"areas", .read = read_areas},
    {"space", WORDS("ras", "lps"), .first = MESH_SPACE_RAS, AT(manifest, space)},
    {"ccf", WORDS("asr", "asl"), .first = MANIFEST_CCF_ASR, AT(manifest, ccf)},
    {"prefer", WORDS("areas", "parcellation"), .first = MANIFEST_PREFER_AREAS, AT(manifest, prefer)},
    {"tree", .read = read_tree},
    {"probabilities", .read = read_maps},
    {"pathways", .read = read_pathways},
    {"streamlines", .read = read_all_streamlines},
    {"threshold", schema_positive, AT(manifest, threshold)},
    {"transform", .read = read_transforms},
    {"context", .read = read_contexts},
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

static void finish_names(struct manifest_pathway *pathways, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        struct manifest_pathway *pathway = &pathways[k];
        for (size_t i = 0; i < pathway->name_count; i++) {
            memory_free(pathway->names[i]);
        }
        for (size_t i = 0; i < pathway->band_count; i++) {
            memory_free((char *)pathway->bands[i].name);
        }
        memory_free(pathway->bands);
        memory_free(pathway->names);
    }
}

void manifest_finish(struct manifest *manifest)
{
    const struct {
        void *entries;
        size_t count, size;
        const struct schema_field *keys;
    } lists[] = {
        {manifest->parcellations, manifest->parcellation_count, sizeof *manifest->parcellations, parcellation_keys},
        {manifest->areas, manifest->area_count, sizeof *manifest->areas, file_keys},
        {manifest->areas, manifest->area_count, sizeof *manifest->areas, files_keys},
        {manifest->areas, manifest->area_count, sizeof *manifest->areas, brainglobe_keys},
        {manifest->tree, manifest->tree_count, sizeof *manifest->tree, node_keys},
        {manifest->maps, manifest->map_count, sizeof *manifest->maps, pathway_keys},
        {manifest->pathways, manifest->pathway_count, sizeof *manifest->pathways, pathway_keys},
        {manifest->streamlines, manifest->streamlines_count, sizeof *manifest->streamlines, streamlines_keys},
        {manifest->transforms, manifest->transform_count, sizeof *manifest->transforms, transform_keys},
        {manifest->contexts, manifest->context_count, sizeof *manifest->contexts, context_keys},
    };
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        schema_finish(lists[i].entries, lists[i].count, lists[i].size, lists[i].keys);
    }
    for (size_t i = 0; i < manifest->context_count; i++) {
        memory_free(manifest->contexts[i].transfer);
    }
    finish_names(manifest->maps, manifest->map_count);
    finish_names(manifest->pathways, manifest->pathway_count);
    memory_free(manifest->parcellations);
    memory_free(manifest->areas);
    memory_free(manifest->tree);
    memory_free(manifest->maps);
    memory_free(manifest->pathways);
    memory_free(manifest->streamlines);
    memory_free(manifest->transforms);
    memory_free(manifest->contexts);
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
