/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of poses: adding rows, ending it, and comparing the space that it names with that of an atlas. */
#include "poses/rows/pose_row.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "conus/own.h"

#include <stdio.h>
#include <string.h>

static void free_kept(conus_pose_row *row, size_t count)
{
    for (size_t i = 0; row->kept && i < count; i++) {
        memory_free((char *)row->kept[i]);
    }
    memory_free((void *)row->kept);
    row->kept = NULL;
}

size_t kept_text_put(char *out, size_t most, const struct kept_text *kept)
{
    size_t size = 0;
    for (size_t i = 0; i < kept->text.size && size < most; i++) {
        out[size++] = kept->text.data[i];
        i += kept->is_quoted && kept->text.data[i] == '"'; /* and the one behind it */
    }
    return size;
}

conus_status pose_list_keep(conus_pose_list *list, const struct kept_text *texts, size_t count)
{
    char **kept = memory_zeroed(count, sizeof *kept);
    conus_pose_row *row = &list->rows[list->count - 1];
    conus_status status = kept ? CONUS_OK : CONUS_ERROR_MEMORY;
    list->kept_count = count;
    row->kept = (const char *const *)kept;
    for (size_t i = 0; i < count && !status; i++) {
        const struct text text = texts[i].text;
        kept[i] = memory_text(text.size ? text.data : "", text.size);
        status = kept[i] ? CONUS_OK : CONUS_ERROR_MEMORY;
        if (!status) {
            kept[i][kept_text_put(kept[i], text.size, &texts[i])] = '\0';
        }
    }
    return status;
}

void pose_list_clear(conus_pose_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        memory_free((char *)list->rows[i].id);
        memory_free((char *)list->rows[i].error);
        free_kept(&list->rows[i], list->kept_count);
    }
    list->count = 0;
}

void pose_list_finish(conus_pose_list *list)
{
    pose_list_clear(list);
    memory_free(list->rows);
    memory_free(list->electrodes);
    memory_free(list->coordsystem);
    memory_free(list->name);
    notes_finish(&list->notes);
    *list = (conus_pose_list){0};
}

void conus_pose_list_destroy(conus_pose_list *list)
{
    if (list) {
        pose_list_finish(list);
        memory_free(list);
    }
}

conus_status pose_list_add(conus_pose_list *list, const conus_pose_row *row, struct text id, const char *error)
{
    char ordinal[POSE_ORDINAL_SIZE];
    conus_status status = list->is_counted ? pose_check_count(list->count + 1, list->max_memory) : CONUS_OK;
    if (status) {
        return status;
    }
    const char *bad = pose_check_id(&id, ordinal, list->count + 1);
    error = error ? error : bad;
    conus_pose_row copy = *row;
    copy.kept = NULL; /* pose_list_keep() */
    copy.id = memory_text(id.data, id.size);
    copy.error = error ? memory_text(error, text_from(error).size) : NULL;
    if (!copy.id || (error && !copy.error) ||
        !memory_reserve(&list->rows, &list->capacity, list->count + 1, sizeof *list->rows)) {
        memory_free((char *)copy.id);
        memory_free((char *)copy.error);
        return CONUS_ERROR_MEMORY;
    }
    list->rows[list->count++] = copy;
    return CONUS_OK;
}

void pose_add(const struct pose_reading *to, const conus_pose_row *row, struct text id, const char *error)
{
    (void)JOB_CALL(to->job, pose_list_add(to->list, row, id, error));
}

void pose_add_point(const struct pose_reading *to, size_t line, const double point[3], bool lps, struct text id,
                    const char *error)
{
    conus_pose_row row = pose_row_at(line);
    row.is_point = true;
    error = error || !pose_of_point(&row.pose, point) ? error : conus_message();
    if (!error && lps) {
        pose_flip_point(row.pose.world_from_device + 12);
    }
    pose_add(to, &row, id, error);
}

void pose_refuse_axis(const struct pose_reading *of, const char *what)
{
    const conus_axis axis = of->options->axis;
    if (axis != CONUS_AXIS_OF_FORMAT) {
        job_bad(of->job, "%s have no direction, so that no axis (%s) can be chosen", what, pose_axis_name(axis));
    }
}

void pose_note_absent(struct job *job, size_t count, size_t first)
{
    if (count) {
        job_note(job, "%zu rows without coordinates (n/a) passed over, the first in line %zu", count, first);
    }
}

conus_status pose_list_hear(conus_pose_list *list, const struct note_sink *sink)
{
    list->name = sink->path ? memory_text(sink->path, strlen(sink->path)) : NULL;
    list->sink = (struct note_sink){sink->log, sink->user, list->name};
    list->notes.sink = &list->sink;
    return sink->path && !list->name ? CONUS_ERROR_MEMORY : CONUS_OK;
}

size_t conus_pose_list_count(const conus_pose_list *list)
{
    return list ? list->count : 0;
}

const conus_pose_row *conus_pose_list_row(const conus_pose_list *list, size_t index)
{
    return list && index < list->count ? &list->rows[index] : NULL;
}

const char *conus_pose_list_note(const conus_pose_list *list, size_t index)
{
    return list && index < list->notes.count ? list->notes.lines[index] : NULL;
}

conus_severity conus_pose_list_note_severity(const conus_pose_list *list, size_t index)
{
    return notes_severity(&list->notes, index);
}

conus_pose_facts conus_pose_list_facts(const conus_pose_list *list)
{
    static const conus_pose_list none = {0};
    list = list ? list : &none;
    return (conus_pose_facts){.space = list->space.name,
                              .electrodes = list->electrodes,
                              .coordsystem = list->coordsystem ? list->coordsystem : "",
                              .coordsystem_sha256 = list->coordsystem_sha256};
}

conus_status conus_pose_list_match(conus_pose_list *list, const conus_atlas *atlas)
{
    return pose_space_match(&list->notes, &list->space, atlas);
}

struct pose_space pose_space_named(struct text name, enum pose_brain brain)
{
    struct pose_space space = {.brain = brain};
    snprintf(space.name, sizeof space.name, "%.*s",
             (int)(name.size < sizeof space.name ? name.size : sizeof space.name), name.data);
    return space;
}

/* Whose brain the atlas is, and how that is known. */
static void describe_brain(char *out, size_t size, const conus_brain_view *brain, const conus_atlas *atlas)
{
    const conus_volume_info *volume = conus_atlas_volume(atlas, 0);
    const char *transform = volume ? volume->transform : "it has no volume";
    const char *source = brain->source;
    if (!brain->brain || (strcmp(source, "header") == 0 && !brain->edition[0])) {
        snprintf(out, size, "%s", transform);
    } else if (strcmp(source, "header") == 0) {
        snprintf(out, size, "%s: %s", brain->words, transform);
    } else {
        snprintf(out, size, "%s%s", brain->words,
                 strcmp(source, "stated") == 0   ? ", as stated"
                 : strcmp(source, "grid") == 0   ? ", by its grid"
                 : strcmp(source, "voxels") == 0 ? ", by its voxels"
                                                 : "");
    }
}

/* FreeSurfer's c_ras, mm: where the header places the middle of the grid, from which tkRAS counts. False: no volume. */
static bool find_c_ras(double out[3], const conus_atlas *atlas)
{
    const conus_volume_info *volume = conus_atlas_volume(atlas, 0);
    for (int i = 0; volume && i < 3; i++) {
        const double *m = volume->world_from_voxel + i;
        out[i] = m[0] * (double)volume->dim[0] / 2 + m[4] * (double)volume->dim[1] / 2 +
                 m[8] * (double)volume->dim[2] / 2 + m[12];
    }
    return volume != NULL;
}

/* tkRAS on what may be, or is, that person's scan. */
static conus_status refuse_tkras(const char *at, const char *words, const conus_atlas *atlas)
{
    double c[3];
    char by[96] = "c_ras, which is in the header of the scan";
    if (find_c_ras(c, atlas)) {
        snprintf(by, sizeof by, "c_ras, by the atlas's header (%.2f, %.2f, %.2f) mm", c[0], c[1], c[2]);
    }
    return fail(
        CONUS_ERROR_DATA,
        "positions are in %s, FreeSurfer's surface RAS: in the scan a point p lies at p + %s; taken as it stands it "
        "would be answered at p of the atlas (%s), as far off. Save the list as scanner RAS (Freeview)",
        at, by, words);
}

conus_status pose_space_match(struct notes *notes, const struct pose_space *space, const conus_atlas *atlas)
{
    static const conus_brain brains[] = {
        [POSE_BRAIN_UNKNOWN] = CONUS_BRAIN_UNKNOWN,   [POSE_BRAIN_SUBJECT] = CONUS_BRAIN_OWN,
        [POSE_BRAIN_MNI152] = CONUS_BRAIN_MNI152,     [POSE_BRAIN_TALAIRACH] = CONUS_BRAIN_TALAIRACH,
        [POSE_BRAIN_TEMPLATE] = CONUS_BRAIN_TEMPLATE, [POSE_BRAIN_COLIN27] = CONUS_BRAIN_COLIN27,
        [POSE_BRAIN_MNI305] = CONUS_BRAIN_MNI305,     [POSE_BRAIN_ANIMAL] = CONUS_BRAIN_TEMPLATE,
        [POSE_BRAIN_MOUSE] = CONUS_BRAIN_TEMPLATE,    [POSE_BRAIN_OTHER] = CONUS_BRAIN_OWN,
        [POSE_BRAIN_FRAME] = CONUS_BRAIN_OWN};
    const bool is_of_frame = space->brain == POSE_BRAIN_FRAME;
    char words[192];
    char at[sizeof space->name + 32];
    double c[3];
    const bool is_tkras = space->brain == POSE_BRAIN_OTHER && !text_equal_ignoring_case(text_from(space->name), "n/a");
    const bool is_centred = is_tkras && find_c_ras(c, atlas) && vec3_length(c) <= 0.01; /* both are one */
    conus_brain brain = brains[space->brain];
    const conus_brain_view view = conus_atlas_brain(atlas);
    if (!space->name[0] || ((space->brain == POSE_BRAIN_SUBJECT || (is_centred && !view.is_moved)) &&
                            (view.brain == CONUS_BRAIN_OWN || (!view.brain && view.is_moved)))) {
        /* a moved atlas lies where its header does not say: where the poses are, as the caller means */
        return is_centred && !view.is_moved
                   ? notes_add(
                         notes,
                         "positions are in \"%s\", FreeSurfer's surface RAS: c_ras is 0 by the grid of the atlas; "
                         "it must be 0 in orig.mgz, too",
                         space->name)
                   : CONUS_OK;
    }
    describe_brain(words, sizeof words, &view, atlas);
    snprintf(at, sizeof at, "\"%s\"%s", space->name, space->is_of_path ? " (by the file's name)" : "");
    if (!view.brain && view.is_moved) {
        return notes_warn(notes, "positions are in %s; they must be where the atlas was moved to (%s)", at, words);
    }
    if (is_tkras && !is_centred && !view.is_moved && (!view.brain || view.brain == CONUS_BRAIN_OWN)) {
        return refuse_tkras(at, words, atlas);
    }
    if (!view.brain || !brain) {
        return notes_warn(
            notes, "positions are in %s; it is not known whether the atlas (%s) is in the same space%s", at, words,
            brain == CONUS_BRAIN_OWN && !is_of_frame ? "; ',template=none' behind ATLAS says that it is this person's"
                                                     : "");
    }
    if (view.brain == CONUS_BRAIN_OWN && brain == CONUS_BRAIN_OWN && !is_of_frame) {
        return notes_warn(notes, "positions are in %s; they must be in the world of the person's scan, as the atlas is",
                          at);
    }
    const conus_brain_view own = {.brain = brain,
                                  .edition = text_mentions(text_from(space->name), "2009")  ? "NLin2009"
                                             : text_mentions(text_from(space->name), "Lin") ? "earlier"
                                                                                            : "",
                                  .source = space->brain == POSE_BRAIN_MOUSE    ? "CCF"
                                            : space->brain == POSE_BRAIN_ANIMAL ? "voxels"
                                                                                : "",
                                  .words = text_mentions(text_from(view.words), space->name) ? view.words : at};
    switch (is_of_frame ? CONUS_BRAIN_GAP_OTHER : conus_brain_compare(own, view)) {
    case CONUS_BRAIN_GAP_NONE:
        return CONUS_OK;
    case CONUS_BRAIN_GAP_SMALL:
        return notes_add(notes, "positions are in %s, the atlas is %s: areas differ by some mm", at, words);
    case CONUS_BRAIN_GAP_SOME_MM:
        return notes_warn(notes, "positions are in %s, the atlas in another template (%s): some mm may lie between", at,
                          words);
    default:
        return fail(CONUS_ERROR_DATA,
                    "positions are in %s, the atlas in another space (%s): convert them to the atlas's%s", at, words,
                    is_tkras ? ": save scanner RAS (Freeview), and take the way of that scan to the template"
                    : brain != CONUS_BRAIN_OWN ? ""
                    : is_of_frame              ? ", by way of the scan"
                                               : ", or take an atlas made of that scan (ATLAS,template=none)");
    }
}
