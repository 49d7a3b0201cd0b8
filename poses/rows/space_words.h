/* SPDX-License-Identifier: BSD-3-Clause */
/** @file What titles, comments and headers say of the space and unit of positions. */
#ifndef CONUS_POSES_ROWS_SPACE_WORDS_H
#define CONUS_POSES_ROWS_SPACE_WORDS_H

#include "base/text.h"
#include "conus/space.h"
#include "poses/rows/pose_row.h"

/** Axes that a line names. */
enum space_axes {
    SPACE_AXES_PLAIN,   /**< None, or x y z, R A S, L P S. */
    SPACE_AXES_ORDERED, /**< Others, or these in another order: "AP LAT VERT". */
    SPACE_AXES_TURNED,  /**< "x flipped", "left is positive". */
    SPACE_AXES_VOXELS   /**< "i j k". */
};

/** What was heard so far. All 0: nothing. */
struct space_words {
    struct pose_space space; /**< The brain: pose_space_match() decides, and space_moves() says which is moved. */
    bool has_signs;          /**< RAS or LPS: */
    conus_space signs;
    bool may_be_lps; /**< "LPS" stands there, and nothing says of what. */
    double mm;       /**< mm per unit; 0: none was named. */
    bool are_two;    /**< Units that contradict each other. */
    const char *why; /**< Why positions cannot be taken: what they are; static. NULL: they can. */
    char heard[64];  /**< The words that decided. */
    enum space_axes axes;
    int order[3]; /**< Of ordered ones: 0 is to a side, 1 to the front or back, 2 up or down. */
};

/** Hears a line, sentence by sentence. */
void space_words_hear(struct space_words *words, struct text line);

/** Whether a text is nothing but words of spaces and units, or such as stand beside them in a line that names columns:
 * "columns:", "(mm)". */
bool space_words_are_beside(struct text text);

/** Whether a text names three axes and nothing else but such words: "columns: AP LAT VERT (mm)", "x: left, y: ...". */
bool space_words_are_axes(struct text text);

/** Hears what is said of coordinates alone: the cells of a column, or a word of its header. */
void space_words_hear_of(struct space_words *words, struct text word);

/** Hears the name of a file, in which "native", "acpc" and "lps" need no word for positions beside them. */
void space_words_hear_name(struct space_words *words, struct text name);

/** Hears a cell that is nothing but words of a space, or a name of BIDS; @p strong: only words that have no other
 * meaning. False where nothing is heard. */
bool space_words_hear_cell(struct space_words *words, struct text cell, bool strong);

/** The brain of a space by its name in BIDS, or as laboratories call their own; POSE_BRAIN_UNKNOWN: of none that is
 * known. */
enum pose_brain space_brain_named(struct text name);

/** @p mm of space_unit_mm() for a unit that is known and not taken. */
#define SPACE_UNIT_REFUSED (-1.0)

/** mm of a unit by its name, in any case; 0: none, below 0: one that is not taken (inches, pixels). */
double space_unit_mm(struct text name);

/** Why such a unit is refused, and voxels. */
extern const char space_why_unit[], space_why_voxels[];

/** Why positions in tkRAS are refused. */
extern const char space_why_tkras[];

/** Whether positions of @p space are moved to MNI 152: those of MNI 305, unless the caller or the file's name says
 * otherwise. A note says so. */
bool space_moves(const struct pose_space *space, const conus_pose_options *options);
void space_note_move(struct job *job, const struct pose_space *space);

/** Moves a point of MNI 305 to MNI 152, RAS mm (FreeSurfer's wiki, CoordinateSystems, 8b). */
void space_move_from_mni305(double p[3]);

#endif
