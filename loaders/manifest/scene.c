/* SPDX-License-Identifier: BSD-3-Clause */
/* The keys of a scene's items and of a manifest, one table each, and what they may not say together. */
#include "loaders/manifest/manifest.h"

#include "base/formats/json_text.h"
#include "loaders/labels/label_format.h"
#include "loaders/manifest/schema.h"

#include <math.h>
#include <string.h>

#define WORDS(...)                                                                                                     \
    .words = (const char *const[])                                                                                     \
    {                                                                                                                  \
        __VA_ARGS__, NULL                                                                                              \
    }

static void read_colour(const struct schema_place *place, void *out, const json_t *value)
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

static json_t *write_colour(struct job *job, const struct schema_field *field, const void *in)
{
    const struct label *label = in;
    const uint8_t *rgb = label->rgb;
    const char *text = job_format(job, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    return label->has_rgb ? schema_text.write(job, field, &text) : NULL;
}

static void read_side(const struct schema_place *place, void *out, const json_t *value)
{
    *(char *)out = place->field->words[schema_index(place, value)][0];
}

static json_t *write_side(struct job *job, const struct schema_field *field, const void *in)
{
    const char side[] = {*(const char *)in, '\0'};
    const char *text = side[0] ? side : NULL;
    return schema_text.write(job, field, &text);
}

static const struct schema_field band_fields[] = {
    {"name", &schema_text, offsetof(conus_band, name), .kinds = 1, .needed = 1},
    {"low", &schema_number, offsetof(conus_band, low), .kinds = 1},
    {"high", &schema_number, offsetof(conus_band, high), .kinds = 1},
    {"comment", &schema_comment, .kinds = 1},
    {0},
};

static void read_band(const struct schema_place *place, void *out, const json_t *value)
{
    *(conus_band *)out = (conus_band){.low = -INFINITY, .high = INFINITY};
    schema_read(place, out, value, band_fields, 1);
}

static json_t *write_band(struct job *job, const struct schema_field *field, const void *in)
{
    (void)field;
    return schema_write(job, in, band_fields, 1);
}

static const struct schema_field transfer_fields[] = {
    {"file", &schema_path, offsetof(struct scene_item, transfer_file), .kinds = 1, .needed = 1}, {0}};

static void read_transfer(const struct schema_place *place, void *out, const json_t *value)
{
    struct scene_item *item = out;
    if (json_is_object(value)) {
        schema_read(place, item, value, transfer_fields, 1);
    } else {
        schema_text.read(place, &item->transfer, value);
    }
}

static json_t *write_transfer(struct job *job, const struct schema_field *field, const void *in)
{
    const struct scene_item *item = in;
    return item->transfer_file ? schema_write(job, item, transfer_fields, 1)
                               : schema_text.write(job, field, &item->transfer);
}

/* A word, or the path of an image, which has an ending. */
static void read_space(const struct schema_place *place, void *out, const json_t *value)
{
    struct scene *scene = out;
    if (json_is_string(value) && strchr(json_string_value(value), '.')) {
        schema_path.read(place, &scene->image, value);
        scene->space = MESH_SPACE_RAS;
    } else {
        schema_word.read(place, &scene->space, value);
    }
}

static json_t *write_space(struct job *job, const struct schema_field *field, const void *in)
{
    const struct scene *scene = in;
    return scene->image ? schema_text.write(job, field, &scene->image) : schema_word.write(job, field, &scene->space);
}

static const struct schema_type colour = {read_colour, write_colour};
static const struct schema_type side = {read_side, write_side};
static const struct schema_type band = {read_band, write_band};
static const struct schema_type transfer = {read_transfer, write_transfer};
static const struct schema_type mesh_space = {read_space, write_space};

enum {
    MAPS = ITEM_PROBABILITIES | ITEM_PATHWAY,
    VOLUMES = ITEM_PARCELLATION | MAPS | ITEM_CONTEXT,
    FILES = ITEM_PARCELLATION | ITEM_STREAMLINES | ITEM_TRANSFORM | ITEM_CONTEXT, /* which nothing else names */
    TRANSFORM = ITEM_TRANSFORM,
    ALONE = ITEM_PARCELLATION | TRANSFORM | ITEM_CONTEXT /* of which one needs no list */
};

/* The keys of all kinds of items. One stands twice where kinds list it in another order. */
#define ITEM(key, type, member, ...)                                                                                   \
    {                                                                                                                  \
        key, &(type), offsetof(struct scene_item, member), .kinds = __VA_ARGS__                                        \
    }
static const struct schema_field item_fields[] = {
    ITEM("file", schema_path, file, FILES | ITEM_AREA | MAPS, .needed = FILES),
    ITEM("files", schema_path, file, ITEM_AREAS),
    ITEM("brainglobe", schema_path, file, ITEM_MESHES),
    ITEM("volume", schema_choice, volume, VOLUMES, .wanted = "a whole number from 0"),
    ITEM("resolution", schema_triple, resolution, VOLUMES, .wanted = "a list of three numbers, in micrometres,"),
    ITEM("orientation", schema_text, orientation, VOLUMES),
    ITEM("structures", schema_word, all_structures, ITEM_MESHES, WORDS("leaves", "all")),
    ITEM("labels", schema_path, labels, ITEM_PARCELLATION | ITEM_AREAS),
    ITEM("label", schema_uint, label.number, ITEM_AREA | ITEM_NODE, .needed = ITEM_NODE, .first = 1),
    ITEM("label_offset", schema_uint, label_offset, ITEM_PARCELLATION | ITEM_AREAS),
    ITEM("parent", schema_uint, label.parent, ITEM_AREAS | ITEM_NODE, .first = 1),
    ITEM("fsl", schema_path, fsl, MAPS),
    ITEM("name", schema_text, label.name, ITEM_AREA | ITEM_NODE | MAPS | ITEM_STREAMLINES),
    ITEM("abbreviation", schema_text, label.abbreviation, ITEM_AREA | ITEM_NODE),
    ITEM("color", colour, label, ITEM_AREA | ITEM_NODE),
    ITEM("parent", schema_uint, label.parent, ITEM_AREA, .first = 1),
    ITEM("hemisphere", side, label.hemisphere, ITEM_PARCELLATION | ITEM_AREA | ITEM_AREAS, WORDS("L", "R", "B")),
    ITEM("vertex_labels", schema_path, vertex_labels, ITEM_AREA),
    ITEM("parts", schema_flag, parts, ITEM_AREA),
    ITEM("label_offset", schema_uint, label_offset, ITEM_AREA),
    ITEM("names", schema_list, names, MAPS, .each = &schema_text, .size = sizeof(char *),
         .wanted = "a list of names, one per volume,"),
    ITEM("threshold", schema_positive, threshold, MAPS),
    ITEM("scale", schema_positive, scale, MAPS | ITEM_MESHES),
    ITEM("orientation", schema_text, orientation, ITEM_MESHES),
    ITEM("bands", schema_list, bands, MAPS, .each = &band, .size = sizeof(conus_band), .wanted = "a list of bands"),
    ITEM("radius", schema_positive, radius, ITEM_STREAMLINES),
    ITEM("from", schema_path, from, TRANSFORM),
    ITEM("to", schema_path, to, TRANSFORM),
    ITEM("inverse", schema_flag, inverse, TRANSFORM),
    ITEM("grid", schema_path, grid, TRANSFORM),
    ITEM("vectors", schema_word, vectors, TRANSFORM, WORDS("as-stated", "relative", "absolute")),
    ITEM("space", schema_word, space, ITEM_STREAMLINES | TRANSFORM, WORDS("ras", "lps"), .first = CONUS_FILE_SPACE_RAS),
    ITEM("transform", schema_choice, transform, TRANSFORM),
    {"transfer", &transfer, .kinds = ITEM_CONTEXT},
    ITEM("blocks", schema_positive, blocks, ITEM_CONTEXT),
    ITEM("opacity", schema_positive, opacity, ITEM_CONTEXT, .most = 1, .wanted = "a number above 0 to 1"),
    ITEM("moves", schema_flag, moves, MAPS | ITEM_STREAMLINES | ITEM_CONTEXT),
    {"comment", &schema_comment, .kinds = ~(unsigned)ITEM_CONTEXT},
    {0},
};

/* What kind an object of "areas" is, by the key that decides. */
static enum item_kind find_kind(const struct schema_place *place, unsigned kinds, const json_t *value)
{
    if (kinds != ITEM_SURFACES) {
        return kinds;
    }
    const bool is_file = !json_is_object(value) || json_object_get(value, "file");
    const bool is_pattern = json_object_get(value, "files");
    if (!is_file && !is_pattern && !json_object_get(value, "brainglobe")) {
        job_bad(place->job, "%s: file, files or brainglobe is missing", place->key);
    }
    return is_file ? ITEM_AREA : is_pattern ? ITEM_AREAS : ITEM_MESHES;
}

static void check_area(const struct schema_place *place, const struct scene_item *area)
{
    const struct label *label = &area->label;
    const char *many = area->vertex_labels ? "vertex_labels" : area->parts ? "parts" : NULL;
    if (area->vertex_labels && area->parts) {
        job_bad(place->job, "%s: has vertex_labels and parts, one of them is allowed", place->key);
    } else if (many && (label->number || label->name || label->abbreviation || label->has_rgb)) {
        job_bad(place->job, "%s: has %s for several areas and label, name, abbreviation or color of one", place->key,
                many);
    } else if (area->label_offset && !many) {
        job_bad(place->job, "%s.label_offset: without vertex_labels or parts, give label", place->key);
    }
}

static void check_map(const struct schema_place *place, const struct scene_item *map)
{
    struct job *job = place->job;
    const char *key = place->key;
    const char *placed = map->orientation ? "orientation" : map->resolution[0] > 0 ? "resolution" : NULL;
    const char *one = map->label.name ? "name" : map->volume ? "volume" : placed;
    const char *many = map->fsl ? "fsl" : map->names.count ? "names" : NULL;
    const char *of_all = map->label.name      ? "name" /* what bands have of their own */
                         : map->names.count   ? "names"
                         : map->fsl           ? "fsl"
                         : map->threshold > 0 ? "threshold"
                                              : NULL;
    if (map->bands.count && of_all) {
        job_bad(job, "%s: has bands and %s, one of them is allowed", key, of_all);
    } else if (map->fsl && map->names.count) {
        job_bad(job, "%s: has fsl and names, one of them is allowed", key);
    } else if (one && many) {
        job_bad(job, "%s: has %s for one pathway and %s for several, one of them is allowed", key, one, many);
    } else if (!map->file && !map->fsl) {
        job_bad(job, "%s: file or fsl is missing", key);
    } else if (map->kind == ITEM_PATHWAY && map->scale != 0) {
        job_bad(job, "%s.scale: is for probabilities, a pathway has a threshold", key);
    } else if (map->kind == ITEM_PATHWAY) {
        return;
    } else if (map->bands.count) {
        job_bad(job, "%s.bands: are for pathways, an area has a threshold", key);
    } else if (map->moves) {
        job_bad(job, "%s.moves: is for pathways and the context, areas always move", key);
    } else if (placed) {
        job_bad(job, "%s: resolution and orientation are for pathways", key);
    } else if (map->threshold > 1) {
        job_bad(job, "%s.threshold: is %g, a probability is up to 1", key, map->threshold);
    }
}

static void read_item(const struct schema_place *place, struct scene *scene, const json_t *value)
{
    struct scene_item item = {.kind = find_kind(place, place->field->items, value)};
    const bool may_be_path = item.kind != ITEM_NODE;
    if (json_is_string(value) && may_be_path) {
        schema_path.read(place, &item.file, value);
    } else if (json_is_object(value)) {
        schema_read(place, &item, value, item_fields, item.kind);
    } else {
        schema_fail(place, value, may_be_path ? "a path or an object" : "an object");
    }
    item.label.has_parent = item.label.parent;
    if (item.kind & MAPS) {
        check_map(place, &item);
    } else if (item.kind == ITEM_AREA) {
        check_area(place, &item);
    }
    *LIST_ADD(place->job, &scene->items) = item;
}

/* A list, or where it may be one, an item. */
static void read_items(const struct schema_place *place, void *out, const json_t *value)
{
    const struct schema_field *list = place->field;
    struct scene *scene = out;
    const bool is_alone = !list->most && list->items == ITEM_PARCELLATION;
    const bool may_be_one = list->items & (ITEM_TRANSFORM | ITEM_CONTEXT);
    const bool is_one = is_alone || (may_be_one && (json_is_string(value) || json_is_object(value)));
    const size_t count = is_one ? 1 : json_array_size(value);
    const size_t before = scene->items.count;
    if (!is_one && !json_is_array(value)) {
        schema_fail(place, value, may_be_one ? "a path, an object or a list of these" : "a list");
    } else if (list->most && count > list->most) {
        job_bad(place->job, "%s: %zu entries, allowed are %zu", place->key, count, list->most);
    }
    for (size_t i = 0; i < count && job_ok(place->job); i++) {
        struct schema_place inner = is_one ? *place : schema_element(place, i);
        read_item(&inner, scene, is_one ? value : json_array_get(value, i));
    }
    for (size_t i = before; i < scene->items.count; i++) {
        const bool has_index = !is_one && (count > 1 || list->items != ITEM_CONTEXT);
        scene->items.at[i].list = list->key;
        scene->items.at[i].index = has_index ? i - before : JOB_ALONE;
    }
}

static json_t *write_items(struct job *job, const struct schema_field *field, const void *in)
{
    const struct scene *scene = in;
    const size_t count = scene_count(scene, field->items);
    const bool is_one = count == 1 && field->items & ALONE;
    json_t *list = is_one ? NULL : schema_need(job, json_array());
    for (struct scene_item *item = NULL; job_ok(job) && (item = scene_next(scene, field->items, item));) {
        json_t *object = schema_write(job, item, item_fields, item->kind);
        if (is_one) {
            list = object;
        } else {
            schema_put(job, list, NULL, object);
        }
    }
    if (!count || (field->items == ITEM_PARCELLATION && is_one == (field->most > 0))) { /* of parcellations one key */
        json_decref(list);
        list = NULL;
    }
    return list;
}

static void read_version(const struct schema_place *place, void *out, const json_t *value)
{
    (void)out;
    if (!json_is_integer(value) || json_integer_value(value) != MANIFEST_VERSION) {
        schema_fail(place, value, "1, the version of this format,");
    }
}

static json_t *write_version(struct job *job, const struct schema_field *field, const void *in)
{
    (void)in;
    return schema_uint.write(job, field, &(uint32_t){MANIFEST_VERSION});
}

/* For people and conus cite: a text, or a list of them. */
static void read_references(const struct schema_place *place, void *out, const json_t *value)
{
    if (!json_is_array(value)) {
        schema_comment.read(place, out, value);
    }
    for (size_t i = 0; i < json_array_size(value); i++) {
        struct schema_place inner = schema_element(place, i);
        schema_comment.read(&inner, out, json_array_get(value, i));
    }
}

static const struct schema_type version = {read_version, write_version};
static const struct schema_type references = {.read = read_references};
static const struct schema_type items = {read_items, write_items};

#define SCENE(key, type, member, ...)                                                                                  \
    {                                                                                                                  \
        key, &(type), offsetof(struct scene, member), .kinds = __VA_ARGS__                                             \
    }
#define LISTED(key, of, limit)                                                                                         \
    {                                                                                                                  \
        key, &items, .kinds = 1, .items = (of), .most = (limit)                                                        \
    }
static const struct schema_field scene_fields[] = {
    {"conus_atlas", &version, .kinds = 1, .needed = 1},
    {"comment", &schema_comment, .kinds = 1},
    {"references", &references, .kinds = 1},
    SCENE("allow_outside", schema_flag, allow_outside, 1),
    LISTED("parcellation", ITEM_PARCELLATION, 0),
    LISTED("parcellations", ITEM_PARCELLATION, MANIFEST_FEW),
    LISTED("areas", ITEM_SURFACES, 0),
    {"space", &mesh_space, .kinds = 1, WORDS("ras", "lps"), .first = MESH_SPACE_RAS},
    SCENE("template", schema_word, brain, 1, WORDS("none", "mni152", "colin27", "mni305"), .first = CONUS_BRAIN_OWN),
    SCENE("ccf", schema_word, ccf, 1, WORDS("asr", "asl"), .first = SCENE_CCF_ASR),
    SCENE("prefer", schema_word, prefer, 1, WORDS("areas", "parcellation"), .first = SCENE_PREFER_AREAS),
    LISTED("tree", ITEM_NODE, 0),
    LISTED("probabilities", ITEM_PROBABILITIES, MANIFEST_MANY),
    LISTED("pathways", ITEM_PATHWAY, MANIFEST_MANY),
    LISTED("streamlines", ITEM_STREAMLINES, MANIFEST_MANY),
    SCENE("threshold", schema_positive, threshold, 1),
    LISTED("transform", ITEM_TRANSFORM, MANIFEST_FEW),
    LISTED("context", ITEM_CONTEXT, MANIFEST_MANY),
    {0},
};

static void check_scene(struct job *job, const struct scene *scene)
{
    const size_t areas = scene_count(scene, ITEM_SURFACES);
    const bool is_labelled = scene_count(scene, ITEM_LABELLED);
    const bool is_probable = scene_count(scene, ITEM_PROBABILITIES);
    const bool is_fixed = !scene_count(scene, ITEM_TRANSFORM);
    bool moves = is_labelled || is_probable; /* a transform needs something that moves */
    if (is_labelled && is_probable) {
        job_bad(job, "has probabilities and %s, which are areas both: one of them is allowed",
                areas ? "areas" : "a parcellation");
    } else if (!moves && !scene_count(scene, ITEM_PATHWAY | ITEM_STREAMLINES)) {
        job_bad(job, "nothing to select: parcellation, areas, probabilities, pathways or streamlines is needed");
    }
    if (scene->space && !scene_count(scene, ITEM_AREA | ITEM_AREAS)) {
        job_bad(job, "space: is of the surfaces in areas, there are none");
    }
    static const unsigned orders[] = {ITEM_PATHWAY, ITEM_STREAMLINES, ITEM_CONTEXT};
    for (size_t k = 0; k < sizeof orders / sizeof orders[0]; k++) {
        for (struct scene_item *item = NULL; (item = scene_next(scene, orders[k], item));) {
            if (item->moves && is_fixed) {
                const bool is_context = item->kind == ITEM_CONTEXT;
                job_bad(job, "%s.moves: there is no transform that could move it",
                        is_context ? item->list : job_format(job, "%s[%zu]", item->list, item->index));
            }
            moves = moves || (item->moves && item->kind != ITEM_CONTEXT);
        }
    }
    if (!moves && !is_fixed) {
        job_bad(job, "transform: there are no areas, and no pathway or streamlines say that they move");
    }
}

struct scene_item *scene_next(const struct scene *scene, unsigned kinds, const struct scene_item *item)
{
    size_t i = item ? (size_t)(item - scene->items.at) + 1 : 0;
    while (i < scene->items.count && !(scene->items.at[i].kind & kinds)) {
        i++;
    }
    return i < scene->items.count ? &scene->items.at[i] : NULL;
}

size_t scene_count(const struct scene *scene, unsigned kinds)
{
    size_t count = 0;
    for (size_t i = 0; i < scene->items.count; i++) {
        count += (scene->items.at[i].kind & kinds) != 0;
    }
    return count;
}

struct scene_item *scene_add(struct job *job, struct scene *scene, const struct scene_item *item)
{
    const struct schema_field *list = scene_fields;
    while (!(list->items & item->kind)) {
        list++;
    }
    const size_t index = item->kind & ALONE ? JOB_ALONE : scene_count(scene, list->items);
    struct scene_item *added = LIST_ADD(job, &scene->items);
    *added = *item;
    added->list = list->key;
    added->index = index;
    return added;
}

bool manifest_is(struct text text)
{
    struct text start = text_trim(text);
    return start.size && start.data[0] == '{' && text_mentions(start, "\"conus_atlas\"");
}

void scene_read(struct job *job, struct scene *out, struct text text)
{
    *out = (struct scene){0};
    const json_t *root = json_text_read(job, text);
    if (!root) {
        return;
    }
    const struct schema_place top = {.job = job, .allow_outside = json_is_true(json_object_get(root, "allow_outside"))};
    if (json_object_get(root, "parcellation") && json_object_get(root, "parcellations")) {
        job_bad(job, "has parcellation and parcellations, one of them is allowed");
    }
    schema_read(&top, out, root, scene_fields, 1);
    check_scene(job, out);
}

struct text scene_write(struct job *job, const struct scene *scene)
{
    json_t *root = schema_write(job, scene, scene_fields, 1);
    const size_t flags = JSON_INDENT(2);
    size_t size = json_dumpb(root, NULL, 0, flags);
    char *text = job_array(job, &size, 1);
    if (!size || json_dumpb(root, text, size, flags) != size) {
        schema_need(job, NULL);
    }
    json_decref(root);
    return text_from(job_format(job, "%.*s\n", (int)size, text ? text : ""));
}

size_t scene_file_count(const struct scene *scene)
{
    size_t count = 0;
    for (size_t i = 0; i < scene->items.count; i++) {
        const struct scene_item *item = &scene->items.at[i];
        const bool is_other = item->kind & (ITEM_SURFACES | ITEM_NODE | ITEM_TRANSFORM);
        count += is_other ? 0 : item->names.count ? item->names.count : 1;
    }
    return count;
}
