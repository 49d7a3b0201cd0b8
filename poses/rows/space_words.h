/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What titles, comments and headers say of the space and unit of positions. */
#ifndef CONUS_POSES_ROWS_SPACE_WORDS_H
#define CONUS_POSES_ROWS_SPACE_WORDS_H

#include "base/text.h"
#include "conus/space.h"
#include "poses/rows/pose_list.h"

/** What was heard so far. All 0: nothing. */
struct space_words {
    struct pose_space space; /**< A brain that is not moved by anything: pose_space_match() decides. */
    bool is_mni305;          /**< Positions are to be moved to MNI 152. */
    bool has_signs;          /**< RAS or LPS: */
    conus_space signs;
    double mm;       /**< mm per unit; 0: none was named. */
    bool are_two;    /**< Units that contradict each other. */
    const char *why; /**< Why positions cannot be taken: what they are; static. NULL: they can. */
    char heard[64];  /**< The words that decided. */
};

/** Hears a line, sentence by sentence. */
void space_words_hear(struct space_words *words, struct text line);

/** Hears what is said of coordinates alone: the cells of a column, or a word of its header. */
void space_words_hear_of(struct space_words *words, struct text word);

/** Whether positions in MNI 305 stay there: the atlas lies there, too. */
bool space_stays_in_mni305(const conus_pose_options *options);

/** Why positions in tkRAS are refused. */
extern const char space_why_tkras[];

/** Moves a point of MNI 305 to MNI 152, RAS mm (FreeSurfer's wiki, CoordinateSystems, 8b). */
void space_move_from_mni305(double p[3]);

#endif
