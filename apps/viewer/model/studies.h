/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The study of the viewer's cone: sweep, jitter or none. */
#ifndef CONUS_VIEWER_MODEL_STUDIES_H
#define CONUS_VIEWER_MODEL_STUDIES_H

#include "viewer/model/viewer.h"

/** Studies so from now on. False: it was said why not, and all stays as it was. */
bool studies_use(struct viewer *viewer, const struct study_settings *settings);

/** Asks for the study of the cone as it is now, unless that is known or under way, and takes what is answered. To be
 * called whenever something may have changed. */
void studies_step(struct viewer *viewer);
/** Asks @p study, of the cone or of a plan, unless the answer is known or under way. */
void studies_ask(struct viewer *viewer, struct study_state *study, const struct study_question *now);
/** Takes its newest answer. */
void studies_take(struct viewer *viewer, struct study_state *study);
/** Whether there is a study, of a cone that is there. */
bool studies_is_on(const struct viewer *viewer);
/** Whether the answer (viewer->study.answer) is missing, or one of another cone, atlas or setting. */
bool studies_is_old(const struct viewer *viewer);
/** The table that conus sweep prints of the cone as it is now, borrowed; NULL = there is none, and it was said why. */
const char *studies_text(struct viewer *viewer);

#endif
