/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds and parses the *_coordsystem.json of a table of electrodes, optodes or markers, of any modality. */
#include "poses/programs/pose_programs.h"

#include "base/files/file.h"
#include "base/formats/json_text.h"
#include "base/memory.h"
#include "conus/own.h"
#include "poses/rows/pose_row.h"

#include <math.h>
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

static struct pose_space find_space(struct job *job, struct text name)
{
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        if (text_equal_ignoring_case(name, others[i])) {
            job_bad(job,
                    "CoordinateSystem \"%s\" is not the world of an image, but a head's, a device's or a "
                    "photograph's own: positions in the scan's space or in MNI are needed; another word in its place "
                    "converts nothing",
                    others[i]);
        }
    }
    return pose_space_named(name, space_brain_named(name));
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
static struct text find_modality(struct job *job, json_t *root, const char *best)
{
    struct text rest = text_from(best);
    struct text modality;
    struct text found = {"", 0};
    for (bool more = true; !found.size && text_field(&rest, '/', &more, &modality);) {
        found = value_of(root, modality, "CoordinateSystem").size ? modality : found;
    }
    bool is_best = found.size;
    const char *key;
    json_t *value;
    json_object_foreach(root, key, value)
    {
        modality = is_best ? (struct text){"", 0} : modality_of(key, value);
        if (modality.size && found.size) {
            job_bad(job,
                    "%.*sCoordinateSystem and %.*sCoordinateSystem, and no %.*sCoordinateSystem: which of them is "
                    "the table's?",
                    POSE_QUOTE(found), POSE_QUOTE(modality), (int)strcspn(best, "/"), best);
        }
        found = modality.size ? modality : found;
    }
    if (!found.size) {
        job_bad(job, "no %.*sCoordinateSystem, nor that of another modality", (int)strcspn(best, "/"), best);
    }
    return found;
}

/* What the file says of the table; its texts live as long as the job. */
struct stated {
    struct text modality, system, units;
};

static struct stated read_stated(struct job *job, struct text text, const char *modalities)
{
    json_t *root = json_text_read(job, text);
    const struct text modality = find_modality(job, root, modalities);
    return (struct stated){modality, value_of(root, modality, "CoordinateSystem"),
                           value_of(root, modality, "CoordinateUnits")};
}

struct pose_space pose_coordsystem_parse(struct job *job, struct text text, const char *modalities)
{
    const struct stated stated = read_stated(job, text, modalities);
    struct pose_space space = find_space(job, stated.system);
    space.scale = space_unit_mm(stated.units);
    if (!(space.scale > 0)) {
        job_bad(job, "%.*sCoordinateUnits \"%.*s\", allowed are mm, cm and m", POSE_QUOTE(stated.modality),
                POSE_QUOTE(stated.units));
    }
    return space;
}

enum { CANDIDATES = 5 };

/* The table's name with all entities (candidate 0), those of person, task and space (1), of person and space (2), of
 * the person only (3), or none (4): files that hold for several tables lack the rest. */
static char *system_path(struct job *job, const char *path, int candidate)
{
    struct text rest = text_from(path_base(path));
    const char *name = "";
    struct text entity;
    for (bool more = true; text_field(&rest, '_', &more, &entity);) {
        bool of_person = text_starts(entity, "sub-") || text_starts(entity, "ses-");
        bool of_task = text_starts(entity, "task-") || text_starts(entity, "stimsys-");
        bool is_kept = candidate == 0 || (candidate <= 3 && of_person) || (candidate == 1 && of_task) ||
                       (candidate <= 2 && text_starts(entity, "space-"));
        name = more && is_kept ? job_format(job, "%s%.*s_", name, (int)entity.size, entity.data) : name;
    }
    return job_beside(job, path, job_format(job, "%s%s", name, system_ending));
}

/* What the file's own name says: behind "space-", or else by words of spaces. Nothing is converted by it. */
static struct pose_space hear_path(struct job *job, const char *path)
{
    const struct text name = text_from(path_base(path));
    struct text rest = name;
    struct text entity;
    struct space_words words = {0};
    bool is_said = false;
    for (bool more = true; !is_said && text_field(&rest, '_', &more, &entity);) {
        is_said = text_starts(entity, "space-");
    }
    if (is_said) {
        enum { SKIPPED = sizeof "space-" - 1 };
        const char *end = memchr(entity.data, '.', entity.size);
        const size_t size = end ? (size_t)(end - entity.data) : entity.size;
        words.space = find_space(job, (struct text){entity.data + SKIPPED, size - SKIPPED});
    } else {
        space_words_hear_name(&words, name);
    }
    words.space.is_of_path = true;
    return words.space;
}

void pose_coordsystem_hear_name(struct job *job, conus_pose_list *list, const char *path)
{
    const bool is_heard = path && !list->space.is_of_path;
    const struct attempt attempt =
        job_try(job); /* a name that is none of an image counts where the content is silent */
    struct pose_space said = is_heard ? hear_path(job, path) : (struct pose_space){0};
    (void)attempt_end(job, &attempt, list->space.name[0] ? ATTEMPT_DROP : ATTEMPT_KEEP);
    if (!said.name[0]) {
        return;
    }
    const bool is_other = text_equal_ignoring_case(text_from(list->space.name), "Other"); /* BIDS's word for none */
    if (!list->space.name[0] || (is_other && said.brain)) {
        if (is_other) {
            job_warn(job, "its name says space \"%s\", its coordsystem.json \"Other\": the name is taken", said.name);
        }
        said.scale = list->space.scale;
        list->space = said;
        return;
    }
    /* The content counts; a table whose name states another one may not be what it is of. */
    bool is_same = said.brain == list->space.brain || said.brain == space_brain_named(text_from(list->space.name));
    if (said.brain != POSE_BRAIN_UNKNOWN && !is_same) {
        job_warn(job, "its name says space \"%s\", but %s says \"%s\", which is taken", said.name,
                 list->coordsystem ? path_base(list->coordsystem) : "the file itself", list->space.name);
    }
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

/* The file beside a table, of whatever name; NULL without one. */
static const char *find_beside(struct job *job, const char *path)
{
    const char *beside = NULL;
    for (int candidate = 0; !beside && candidate < CANDIDATES; candidate++) {
        beside = system_path(job, path, candidate);
        beside = job_has_file(job, beside) ? beside : NULL;
    }
    return beside;
}

static bool says_nothing(struct text value)
{
    return !value.size || text_equal_ignoring_case(value, "n/a");
}

bool pose_coordsystem_hear(struct job *job, conus_pose_list *list, const char *path, bool has_unit)
{
    const char *beside = modalities_of(path) ? NULL : find_beside(job, path);
    if (!beside) {
        return false;
    }
    const struct attempt attempt = job_try(job);
    const struct bytes bytes = job_read(job, beside, FILE_LIMIT, "");
    const struct stated stated = read_stated(job, (struct text){(const char *)bytes.data, bytes.size}, "");
    if (attempt_end(job, &attempt, ATTEMPT_TRY) || says_nothing(stated.system)) {
        job_warn(job,
                 "%s beside it does not say which space is the table's: positions are taken as being in the atlas's",
                 path_base(beside));
        return true;
    }
    const size_t mark = job_in(job, beside, JOB_ALONE);
    list->space = find_space(job, stated.system);
    const double mm = space_unit_mm(stated.units);
    if (mm != 1 && !says_nothing(stated.units) && !has_unit) {
        job_bad(job, "CoordinateUnits \"%.*s\", and nothing in the table beside it: type %s%.*s%sFILE,unit=mm",
                POSE_QUOTE(stated.units), mm > 0 ? "FILE,unit=" : "", mm > 0 ? (int)stated.units.size : 0,
                stated.units.data, mm > 0 ? " or " : "");
    }
    job_out(job, mark);
    job_note(job, "the space is that of %s beside it, \"%s\"", path_base(beside), list->space.name);
    return true;
}

void pose_coordsystem_find(struct job *job, conus_pose_list *list, const char *path, bool is_needed, bool has_unit)
{
    const char *modalities = modalities_of(path);
    if (list->coordsystem) { /* it was found before */
        return;
    }
    const char *beside = modalities ? find_beside(job, path) : NULL;
    if (beside) {
        list->coordsystem = memory_text(beside, strlen(beside));
        if (!job_need(job, list->coordsystem)) {
            return;
        }
        const size_t mark = job_in(job, beside, JOB_ALONE);
        const struct bytes bytes = job_read(job, beside, FILE_LIMIT, "");
        if (job_ok(job)) {
            file_sha256(list->coordsystem_sha256, &bytes);
        }
        list->space = pose_coordsystem_parse(job, (struct text){(const char *)bytes.data, bytes.size}, modalities);
        job_out(job, mark);
    } else if (is_needed) {
        pose_coordsystem_hear_name(job, list, path);
        bool is_named = list->space.name[0];
        bool is_of_bids = modalities || strstr(path, "sub-"); /* else any script's table */
        if (!is_named && pose_coordsystem_hear(job, list, path, has_unit)) {
            return;
        }
        job_put(job, is_named || !is_of_bids ? CONUS_SEVERITY_NOTE : CONUS_SEVERITY_WARNING,
                "no *_%s beside it: positions are taken as mm, and %s%s%s", system_ending,
                is_named ? "the space is that of its name, \"" : "no space is known", list->space.name,
                is_named ? "\"" : "");
    }
}

/* In the order of conus_scalp_load(). */
static const char *const landmark_names[] = {"nas/nasion/nz", "ini/inion/iz", "lpa", "rpa"};

enum { LANDMARKS = sizeof landmark_names / sizeof landmark_names[0] };

static void read_landmark(struct job *job, double out[3], const char *name, const json_t *value, double mm)
{
    for (size_t a = 0; a < 3 && job_ok(job); a++) {
        const json_t *number = json_array_get(value, a);
        if (json_array_size(value) != 3 || !json_is_number(number)) {
            job_bad(job, "%.40s: three numbers are needed", name);
        }
        out[a] = mm * json_number_value(number);
    }
}

/* Three letters of axes at the end, "ALS", but for RAS. */
static bool are_other_axes(struct text name)
{
    static const char *const axes[] = {"RrLl", "AaPp", "SsIi"};
    bool has[3] = {false};
    for (size_t i = 0; i < 9 && name.size >= 3; i++) {
        const char letter = name.data[name.size - 3 + i / 3];
        has[i % 3] = has[i % 3] || (letter && strchr(axes[i % 3], letter));
    }
    return has[0] && has[1] && has[2] && !text_equal_ignoring_case((struct text){name.data + name.size - 3, 3}, "RAS");
}

/* The landmarks are a person's, in the world of the scan that the scalp is of. */
static void check_system(struct job *job, struct text system)
{
    const enum pose_brain brain = find_space(job, system).brain;
    const bool is_other = brain == POSE_BRAIN_OTHER && !says_nothing(system); /* such as tkRAS */
    if (is_other || brain == POSE_BRAIN_ANIMAL || brain == POSE_BRAIN_MOUSE || are_other_axes(system)) {
        job_bad(job, "the landmarks are in \"%.*s\", needed are those in the scalp's world, RAS", POSE_QUOTE(system));
    }
}

static void read_landmarks(struct job *job, double out[LANDMARKS][3], struct text text)
{
    json_t *root = json_text_read(job, text);
    const bool is_anatomical = json_object_get(root, "AnatomicalLandmarkCoordinates");
    const struct text group = text_from(is_anatomical ? "AnatomicalLandmark" : "Fiducials");
    json_t *points = json_object_get(root, is_anatomical ? "AnatomicalLandmarkCoordinates" : "FiducialsCoordinates");
    if (job_ok(job) && !json_is_object(points)) {
        job_bad(job, "no AnatomicalLandmarkCoordinates");
    }
    struct text system = value_of(root, group, "CoordinateSystem");
    struct text units = value_of(root, group, "CoordinateUnits");
    if (job_ok(job) && (says_nothing(system) || says_nothing(units))) { /* those of the electrodes */
        const struct text modality = find_modality(job, root, "iEEG/EEG/EMG");
        system = says_nothing(system) ? value_of(root, modality, "CoordinateSystem") : system;
        units = says_nothing(units) ? value_of(root, modality, "CoordinateUnits") : units;
    }
    check_system(job, system);
    const double mm = space_unit_mm(units);
    if (!(mm > 0)) {
        job_bad(job, "units \"%.*s\" of the landmarks, allowed are mm, cm and m", POSE_QUOTE(units));
    }
    const char *key;
    json_t *value;
    json_object_foreach(points, key, value)
    {
        for (size_t k = 0; k < LANDMARKS; k++) {
            double at[3] = {0};
            if (!text_is_one_of(text_from(key), landmark_names[k], false)) {
                continue;
            }
            read_landmark(job, at, key, value, mm);
            for (size_t a = 0; a < 3 && !isnan(out[k][0]); a++) {
                if (out[k][a] != at[a]) {
                    job_bad(job, "%.40s: another name of the same landmark has (%g, %g, %g) mm, and this (%g, %g, %g)",
                            key, out[k][0], out[k][1], out[k][2], at[0], at[1], at[2]);
                }
            }
            memcpy(out[k], at, sizeof at);
        }
    }
}

conus_status conus_landmarks_load(double landmarks[4][3], const char *path)
{
    struct job job = {0};
    double found[LANDMARKS][3];
    for (size_t i = 0; i < 3 * LANDMARKS; i++) {
        found[i / 3][i % 3] = NAN;
    }
    (void)job_in(&job, path, JOB_ALONE);
    const struct bytes bytes = job_read(&job, path, FILE_LIMIT, "");
    if (job_ok(&job)) {
        read_landmarks(&job, found, (struct text){(const char *)bytes.data, bytes.size});
    }
    conus_status status = job_close(&job, NULL, NULL);
    if (!status) {
        memcpy(landmarks, found, sizeof found);
    }
    return status;
}
