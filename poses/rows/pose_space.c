/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares the space of a file of poses with that of an atlas. */
#include "poses/rows/pose_space.h"

#include <stdio.h>
#include <string.h>

struct pose_space pose_space_named(struct text name, enum pose_brain brain)
{
    struct pose_space space = {.brain = brain};
    snprintf(space.name, sizeof space.name, "%.*s",
             (int)(name.size < sizeof space.name ? name.size : sizeof space.name), name.data);
    return space;
}

/* What a NIfTI header's code says; 1 and 2 are anybody's scan, and what many programs write for a template, too. */
static enum pose_brain brain_of(const char *transform)
{
    return strstr(transform, "(MNI 152)")          ? POSE_BRAIN_MNI152
           : strstr(transform, "(Talairach)")      ? POSE_BRAIN_TALAIRACH
           : strstr(transform, "(other template)") ? POSE_BRAIN_TEMPLATE
                                                   : POSE_BRAIN_UNKNOWN;
}

/* An atlas that was moved lies where its header does not say: in the space of the poses, as the caller means it. */
static conus_status match_moved(struct notes *notes, const struct pose_space *space, const char *transform)
{
    return space->brain == POSE_BRAIN_SUBJECT
               ? CONUS_OK
               : notes_warn(notes, "positions are in \"%s\"; they must be where the atlas was moved to (%s)",
                            space->name, transform);
}

conus_status pose_space_match(struct notes *notes, const struct pose_space *space, const conus_atlas *atlas)
{
    if (!space->name[0]) {
        return CONUS_OK;
    }
    const conus_volume_info *volume = conus_atlas_volume(atlas, 0);
    const char *transform = volume ? volume->transform : "it has no volume";
    if (strstr(transform, ", moved")) {
        return match_moved(notes, space, transform);
    }
    enum pose_brain brain = brain_of(transform);
    if (space->brain == POSE_BRAIN_UNKNOWN || brain == POSE_BRAIN_UNKNOWN) {
        return notes_warn(notes, "positions are in \"%s\"; it is not known whether the atlas (%s) is in the same space",
                          space->name, transform);
    }
    if (space->brain == brain && brain != POSE_BRAIN_TEMPLATE) {
        return CONUS_OK;
    }
    if (space->brain == POSE_BRAIN_TEMPLATE || (brain == POSE_BRAIN_TEMPLATE && space->brain != POSE_BRAIN_SUBJECT)) {
        return notes_warn(notes, "positions are in \"%s\", the atlas in another template (%s): some mm may lie between",
                          space->name, transform);
    }
    return fail(CONUS_ERROR_DATA,
                "positions are in \"%s\", the atlas in another space (%s): the areas named would be wrong", space->name,
                transform);
}
