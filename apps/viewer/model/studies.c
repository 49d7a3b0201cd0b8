/* SPDX-License-Identifier: BSD-3-Clause */
/* Keeps the study of the cone up to date. */
#include "viewer/model/viewer.h"

#include "viewer/model/study.h"

#include <stdlib.h>
#include <string.h>

bool studies_use(struct viewer *viewer, const struct study_settings *settings)
{
    const char *fault = study_fault(settings);
    if (fault) {
        viewer_say(viewer, "%s", fault);
        return false;
    }
    viewer->study.settings = *settings;
    viewer->version++;
    return true;
}

bool studies_is_on(const struct viewer *viewer)
{
    return viewer->study.settings.kind != STUDY_NONE && tool_has_cone(viewer, FIRST_TOOL);
}

static void find_question(struct study_question *out, const struct viewer *viewer)
{
    *out = (struct study_question){.settings = viewer->study.settings};
    out->pose = viewer->tools[FIRST_TOOL].pose;
    out->frame = viewer->frame;
    out->atlas_number = viewer->atlas_number;
    out->angle = viewer_query(&out->options, viewer, FIRST_TOOL, 0);
    out->options.level = NULL;
    memcpy(out->level, viewer->cone.level, sizeof out->level);
}

bool studies_is_old(const struct viewer *viewer)
{
    struct study_question now;
    find_question(&now, viewer);
    return !viewer->study.answer || !study_is_same(&now, &viewer->study.answer->question);
}

void studies_ask(struct viewer *viewer, struct study_state *study, const struct study_question *now)
{
    bool is_known = study->answer && study_is_same(now, &study->answer->question);
    bool is_asked = study->studier && study_is_same(now, &study->asked);
    if (is_known || is_asked) {
        return;
    }
    if (!study->studier && !studier_create(&study->studier, viewer->atlases, viewer->atlas_count, viewer->wake)) {
        viewer_say(viewer, "not enough memory");
        study->settings.kind = STUDY_NONE;
        return;
    }
    study->asked = *now;
    studier_ask(study->studier, now);
}

void studies_take(struct viewer *viewer, struct study_state *study)
{
    struct study_answer *answer = studier_take(study->studier);
    if (answer) {
        study_answer_destroy(study->answer);
        study->answer = answer;
        viewer->said++; /* a frame, but no cut anew */
    }
}

void studies_step(struct viewer *viewer)
{
    studies_take(viewer, &viewer->study);
    if (studies_is_on(viewer)) {
        struct study_question now;
        find_question(&now, viewer);
        studies_ask(viewer, &viewer->study, &now);
    }
}

const char *studies_text(struct viewer *viewer)
{
    const struct study_answer *answer = viewer->study.answer;
    if (!studies_is_on(viewer)) {
        viewer_say(viewer, viewer->tools[FIRST_TOOL].has_pose ? "there is no study: J begins one"
                                                              : "there is no cone to study");
        return NULL;
    }
    if (studies_is_old(viewer)) {
        viewer_say(viewer, "the study is not done yet");
        return NULL;
    }
    if (!answer->text) {
        viewer_say(viewer, "%s", answer->error);
    }
    return answer->text;
}
