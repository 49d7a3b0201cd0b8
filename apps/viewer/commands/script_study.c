/* SPDX-License-Identifier: BSD-3-Clause */
/* Sweeps and jitter by words. */
#include "viewer/commands/script_study.h"

#include "options/messages.h"
#include "viewer/commands/script_words.h"
#include "viewer/model/studies.h"

#include <string.h>

static bool use_study(struct viewer *viewer, const struct study_settings *settings)
{
    bool fine = studies_use(viewer, settings);
    if (!fine) {
        print_error_line("%s", viewer->message);
    }
    return fine;
}

static bool ends_study(char *const *arguments, size_t count)
{
    return count == 1 && strcmp(arguments[0], "off") == 0;
}

bool script_sweep(struct viewer *viewer, char *const *arguments, size_t count)
{
    struct study_settings study = viewer->study.settings;
    bool ends = ends_study(arguments, count);
    bool fine = ends || count == 3;
    for (size_t i = 0; i < 3 && fine && !ends; i++) {
        fine = script_number(&study.angles[i], arguments[i]);
    }
    study.kind = ends ? STUDY_NONE : STUDY_SWEEP;
    return fine && use_study(viewer, &study);
}

bool script_jitter(struct viewer *viewer, char *const *arguments, size_t count)
{
    struct study_settings study = viewer->study.settings;
    double *const numbers[3] = {&study.tilt_deg, &study.shift_mm, &study.samples};
    bool ends = ends_study(arguments, count);
    bool fine = ends || (count >= 2 && count <= 3);
    for (size_t i = 0; i < count && fine && !ends; i++) {
        fine = script_number(numbers[i], arguments[i]);
    }
    study.kind = ends ? STUDY_NONE : STUDY_JITTER;
    return fine && use_study(viewer, &study);
}

bool script_study(struct viewer *viewer, const char *path)
{
    const char *text = studies_text(viewer);
    if (!text) {
        print_error_line("%s", viewer->message);
        return false;
    }
    conus_status status = conus_write_file(path, text, strlen(text));
    if (status) {
        print_error_line("%s", conus_message());
    }
    return !status;
}
