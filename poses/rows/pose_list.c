/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of poses: adding rows, ending it, and comparing the space that it names with that of an atlas. */
#include "poses/rows/pose_list.h"

#include "base/memory.h"
#include "conus/atlas_info.h"
#include "poses/rows/pose_row.h"

#include <stdio.h>
#include <string.h>

void pose_list_clear(conus_pose_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        memory_free((char *)list->rows[i].id);
        memory_free((char *)list->rows[i].error);
        memory_free((char *)list->rows[i].kept);
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
    copy.id = memory_text(id.data, id.size);
    copy.error = error ? memory_text(error, text_from(error).size) : NULL;
    copy.kept = row->kept ? memory_text(row->kept, strlen(row->kept)) : NULL;
    if (!copy.id || (error && !copy.error) || (row->kept && !copy.kept) ||
        !memory_reserve(&list->rows, &list->capacity, list->count + 1, sizeof *list->rows)) {
        memory_free((char *)copy.id);
        memory_free((char *)copy.error);
        memory_free((char *)copy.kept);
        return CONUS_ERROR_MEMORY;
    }
    list->rows[list->count++] = copy;
    return CONUS_OK;
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

const char *conus_pose_list_electrodes(const conus_pose_list *list)
{
    return list ? list->electrodes : NULL;
}

const char *conus_pose_list_coordsystem(const conus_pose_list *list)
{
    return list && list->coordsystem ? list->coordsystem : "";
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

conus_status pose_space_match(struct notes *notes, const struct pose_space *space, const conus_atlas *atlas)
{
    if (!space->name[0]) {
        return CONUS_OK;
    }
    const conus_volume_info *volume = conus_atlas_volume(atlas, 0);
    const char *transform = volume ? volume->transform : "it has no volume";
    if (strstr(transform, ", moved") || strstr(transform, ", warped")) {
        /* A moved atlas lies where its header does not say: in the space of the poses, as the caller means it. */
        return space->brain == POSE_BRAIN_SUBJECT
                   ? CONUS_OK
                   : notes_warn(notes, "positions are in \"%s\"; they must be where the atlas was moved to (%s)",
                                space->name, transform);
    }
    /* From a NIfTI header's code. 1 and 2 are anybody's scan, but many programs write them for a template, too. */
    enum pose_brain brain = strstr(transform, "(MNI 152)")          ? POSE_BRAIN_MNI152
                            : strstr(transform, "(Talairach)")      ? POSE_BRAIN_TALAIRACH
                            : strstr(transform, "(other template)") ? POSE_BRAIN_TEMPLATE
                                                                    : POSE_BRAIN_UNKNOWN;
    if (space->brain == POSE_BRAIN_UNKNOWN || brain == POSE_BRAIN_UNKNOWN) {
        return notes_warn(notes, "positions are in \"%s\"; it is not known whether the atlas (%s) is in the same space",
                          space->name, transform);
    }
    if (space->brain == brain && brain != POSE_BRAIN_TEMPLATE) {
        return CONUS_OK;
    }
    bool is_own = space->brain == POSE_BRAIN_SUBJECT || space->brain == POSE_BRAIN_OTHER;
    if (space->brain == POSE_BRAIN_TEMPLATE || (brain == POSE_BRAIN_TEMPLATE && !is_own)) {
        return notes_warn(notes, "positions are in \"%s\", the atlas in another template (%s): some mm may lie between",
                          space->name, transform);
    }
    return fail(CONUS_ERROR_DATA,
                "positions are in \"%s\", the atlas in another space (%s): the areas named would be wrong", space->name,
                transform);
}
