/* SPDX-License-Identifier: BSD-3-Clause */
/** @file In which brain the positions of a file are, and whether an atlas can be in the same. */
#ifndef CONUS_POSES_ROWS_POSE_SPACE_H
#define CONUS_POSES_ROWS_POSE_SPACE_H

#include "base/notes.h"
#include "base/text.h"

/** Which brain a space belongs to. */
enum pose_brain {
    POSE_BRAIN_UNKNOWN = 0,
    POSE_BRAIN_SUBJECT, /**< Somebody's own scan. */
    POSE_BRAIN_MNI152,
    POSE_BRAIN_TALAIRACH,
    POSE_BRAIN_TEMPLATE /**< Another template. */
};

/** All 0: the file names none. */
struct pose_space {
    char name[64]; /**< As the file has it: "NIfTI:Scanner". */
    enum pose_brain brain;
    double scale; /**< mm per unit of the file's numbers; 0 = 1. */
};

struct pose_space pose_space_named(struct text name, enum pose_brain brain);

/** CONUS_ERROR_DATA where file and atlas say of different brains; a note where one of them does not say. To an atlas
 * that was moved somebody's own scan fits; a note tells of another space. */
conus_status pose_space_match(struct notes *notes, const struct pose_space *space, const conus_atlas *atlas);

#endif
