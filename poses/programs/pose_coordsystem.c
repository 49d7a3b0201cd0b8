/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds and parses the *_coordsystem.json of a table of electrodes, optodes or markers, of any modality. */
#include "poses/programs/pose_programs.h"

#include "base/buffer.h"
#include "base/files/file.h"
#include "base/files/folder.h"
#include "base/formats/json_text.h"
#include "base/memory.h"
#include "poses/rows/pose_row.h"
#include "poses/rows/space_words.h"

#include <stdio.h>
#include <string.h>

/* Tables of positions, and whose system theirs is where a file has several, the first best. */
static const struct {
    const char *ending, *modalities;
} tables[] = {{"electrodes", "iEEG/EEG/EMG"}, {"optodes", "NIRS"}, {"markers", "NIBS"}};

enum { TABLES = sizeof tables / sizeof tables[0] };

static const char system_ending[] = "coordsystem.json";

enum { FILE_LIMIT = 1 << 20 };

/* Systems of a head or a helmet, with origins and axes of their own, and pixels: no image's world. */
static const char *const others[] = {"Pixels",     "CTF",     "ElektaNeuromag", "4DBti",    "KitYokogawa",
                                     "ChietiItab", "CapTrak", "EEGLAB",         "EEGLAB-HJ"};

static conus_status set_space(struct pose_space *out, struct text name)
{
    *out = pose_space_named(name, space_brain_named(name));
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        if (text_equal_ignoring_case(name, others[i])) {
            return fail(CONUS_ERROR_DATA,
                        "CoordinateSystem \"%s\" is not the world of an image, but a head's, a device's or a "
                        "photograph's own: positions in the scan's space or in MNI are needed",
                        others[i]);
        }
    }
    return CONUS_OK;
}

/* The modality of a key such as "EEGCoordinateSystem" with a text: "EEG". "" of others, and of points that are in no
 * table. */
static struct text modality_of(const char *key, const json_t *value)
{
    static const char ending[] = "CoordinateSystem";
    const size_t size = strlen(key);
    const size_t skipped = sizeof ending - 1;
    struct text modality = {key, size > skipped && strcmp(key + size - skipped, ending) == 0 ? size - skipped : 0};
    bool is_of_table = json_is_string(value) &&
                       !text_is_one_of(modality, "Fiducials/AnatomicalLandmark/HeadCoil/DigitizedHeadPoints", true);
    return is_of_table ? modality : (struct text){"", 0};
}

/* "" where there is no such text. */
static struct text value_of(const json_t *root, struct text modality, const char *key)
{
    char name[64];
    snprintf(name, sizeof name, "%.*s%s", TEXT_SHOW(modality, POSE_QUOTE_LIMIT), key);
    return json_text_of(json_object_get(root, name));
}

/* The modality whose system is that of the table: of the first of @p best that there is, or else the only one. */
static conus_status find_modality(struct text *out, json_t *root, const char *best)
{
    struct text rest = text_from(best);
    struct text modality;
    struct text found = {"", 0};
    for (bool more = true; !found.size && text_field(&rest, '/', &more, &modality);) {
        found = value_of(root, modality, "CoordinateSystem").size ? modality : found;
    }
    bool is_best = found.size;
    for (void *at = json_object_iter(root); at && !is_best; at = json_object_iter_next(root, at)) {
        modality = modality_of(json_object_iter_key(at), json_object_iter_value(at));
        if (modality.size && found.size) {
            return fail(CONUS_ERROR_DATA,
                        "%.*sCoordinateSystem and %.*sCoordinateSystem, and no %.*sCoordinateSystem: which of them is "
                        "the table's?",
                        POSE_QUOTE(found), POSE_QUOTE(modality), (int)strcspn(best, "/"), best);
        }
        found = modality.size ? modality : found;
    }
    *out = found;
    return found.size ? CONUS_OK
                      : fail(CONUS_ERROR_DATA, "no %.*sCoordinateSystem, nor that of another modality",
                             (int)strcspn(best, "/"), best);
}

conus_status pose_coordsystem_parse(struct pose_space *out, struct text text, const char *modalities)
{
    json_t *root = NULL;
    struct pose_space space = {0};
    struct text modality = {"", 0};
    conus_status status = json_text_load(&root, text);
    status = status ? status : find_modality(&modality, root, modalities);
    status = status ? status : set_space(&space, value_of(root, modality, "CoordinateSystem"));
    struct text units = status ? (struct text){"", 0} : value_of(root, modality, "CoordinateUnits");
    space.scale = space_unit_mm(units);
    if (!status && !(space.scale > 0)) {
        status = fail(CONUS_ERROR_DATA, "%.*sCoordinateUnits \"%.*s\", allowed are mm, cm and m", POSE_QUOTE(modality),
                      POSE_QUOTE(units));
    }
    json_decref(root);
    *out = status ? *out : space;
    return status;
}

enum { CANDIDATES = 4 };

/* The table's name with all entities (candidate 0), those of person, task and space (1), of person and space (2), or of
 * the person only (3): files that hold for several tables lack the rest. NULL without memory. */
static char *system_path(const char *path, int candidate)
{
    struct text rest = text_from(path_base(path));
    struct buffer name = {0};
    struct text entity;
    for (bool more = true; text_field(&rest, '_', &more, &entity);) {
        bool of_person = text_starts(entity, "sub-") || text_starts(entity, "ses-");
        bool of_task = text_starts(entity, "task-") || text_starts(entity, "stimsys-");
        bool is_kept = candidate == 0 || of_person || (candidate == 1 && of_task) ||
                       (candidate <= 2 && text_starts(entity, "space-"));
        if (more && is_kept) {
            buffer_format(&name, "%.*s_", (int)entity.size, entity.data);
        }
    }
    buffer_text(&name, system_ending);
    char *found = buffer_status(&name) ? NULL : file_beside(path, name.data);
    buffer_finish(&name);
    return found;
}

static conus_status load_system(conus_pose_list *list, const char *path, const char *modalities)
{
    struct bytes bytes = {0};
    conus_status status = file_read(&bytes, path, FILE_LIMIT);
    if (!status) {
        file_sha256(list->coordsystem_sha256, &bytes);
        status = pose_coordsystem_parse(&list->space, (struct text){(const char *)bytes.data, bytes.size}, modalities);
        status = status ? fail_in(status, path) : CONUS_OK;
    }
    bytes_finish(&bytes);
    return status;
}

/* What the file's own name says: behind "space-", or else by words of spaces. Nothing is converted by it. */
static conus_status hear_path(struct pose_space *out, const char *path)
{
    const struct text name = text_from(path_base(path));
    struct text rest = name;
    struct text entity;
    struct space_words words = {0};
    *out = (struct pose_space){0};
    for (bool more = true; text_field(&rest, '_', &more, &entity);) {
        if (text_starts(entity, "space-")) {
            enum { SKIPPED = sizeof "space-" - 1 };
            const char *end = memchr(entity.data, '.', entity.size);
            entity.size = end ? (size_t)(end - entity.data) : entity.size;
            conus_status status = set_space(out, (struct text){entity.data + SKIPPED, entity.size - SKIPPED});
            out->is_of_path = true;
            return status;
        }
    }
    space_words_hear_name(&words, name);
    *out = words.space;
    out->is_of_path = true;
    return CONUS_OK;
}

conus_status pose_coordsystem_hear_name(conus_pose_list *list, const char *path)
{
    struct pose_space said = {0};
    conus_status status = path && !list->space.is_of_path ? hear_path(&said, path) : CONUS_OK;
    if (!said.name[0]) {
        return status;
    }
    if (list->space.name[0]) { /* the content counts; a table whose name states another one may not be what it is of */
        bool is_same = said.brain == list->space.brain || said.brain == space_brain_named(text_from(list->space.name));
        return said.brain == POSE_BRAIN_UNKNOWN || is_same
                   ? CONUS_OK
                   : notes_warn(&list->notes, "its name says space \"%s\", but %s says \"%s\", which is taken",
                                said.name, list->coordsystem ? path_base(list->coordsystem) : "the file itself",
                                list->space.name);
    }
    said.scale = list->space.scale;
    list->space = said;
    return status;
}

/* Of a table that its name says to be one of BIDS, whatever its case and extension; NULL of others. */
static const char *modalities_of(const char *path)
{
    const char *base = path_base(path);
    const char *last = strrchr(base, '_');
    const char *suffix = last ? last + 1 : base;
    const struct text name = {suffix, strcspn(suffix, ".")};
    const char *modalities = NULL;
    for (size_t i = 0; i < TABLES; i++) {
        modalities = text_equal_ignoring_case(name, tables[i].ending) ? tables[i].modalities : modalities;
    }
    return modalities;
}

conus_status pose_coordsystem_find(conus_pose_list *list, const char *path, bool is_needed)
{
    const char *modalities = modalities_of(path);
    for (int candidate = 0; modalities && candidate < CANDIDATES; candidate++) {
        char *beside = system_path(path, candidate);
        if (!beside) {
            return CONUS_ERROR_MEMORY;
        }
        if (file_exists(beside)) {
            list->coordsystem = beside;
            conus_status status = load_system(list, beside, modalities);
            return status;
        }
        memory_free(beside);
    }
    if (!is_needed) {
        return CONUS_OK;
    }
    conus_status status = pose_coordsystem_hear_name(list, path);
    bool is_named = list->space.name[0];
    return status ? status
                  : notes_put(&list->notes, is_named ? CONUS_SEVERITY_NOTE : CONUS_SEVERITY_WARNING,
                              "no *_%s beside it: positions are taken as mm, and %s%s%s", system_ending,
                              is_named ? "the space is that of its name, \"" : "no space is known", list->space.name,
                              is_named ? "\"" : "");
}
