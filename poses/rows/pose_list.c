/* SPDX-License-Identifier: BSD-3-Clause */
/* A list of poses: adding rows, ending it, and what the public header asks of it. */
#include "poses/rows/pose_list.h"

#include "base/memory.h"
#include "poses/rows/pose_row.h"

#include <string.h>

void pose_list_finish(conus_pose_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        memory_free((char *)list->rows[i].id);
        memory_free((char *)list->rows[i].error);
    }
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
    const char *bad = pose_check_id(&id, ordinal, list->count + 1);
    error = error ? error : bad;
    conus_pose_row copy = *row;
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
