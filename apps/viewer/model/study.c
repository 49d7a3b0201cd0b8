/* SPDX-License-Identifier: BSD-3-Clause */
/* What a study asks: defaults, limits, and whether two ask the same. */
#include "viewer/model/study.h"

#include "options/angles.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

const struct study_settings study_defaults = {.angles = {2, 40, 2}, .tilt_deg = 2, .shift_mm = 1.5, .samples = 1024};

static bool is_power_of_two(double samples)
{
    int exponent;
    return samples >= 16 && samples <= 1048576 && frexp(samples, &exponent) == 0.5;
}

const char *study_fault(const struct study_settings *settings)
{
    const double *angles = settings->angles;
    size_t count = angles_count(angles);
    if (!count) {
        return "angles: from, to and by are needed, \"to\" from \"from\" on and \"by\" above 0";
    }
    if (count > ANGLE_LIMIT) {
        return "angles: there are more than 1000";
    }
    if (!(angles[0] > 0 && angles_at(angles, count - 1) < 180)) {
        return "angles: allowed is more than 0 and less than 180 degrees";
    }
    if (!(settings->tilt_deg >= 0 && settings->tilt_deg <= 90)) {
        return "jitter: a tilt of 0 to 90 degrees is needed";
    }
    if (!(settings->shift_mm >= 0 && settings->shift_mm <= 1e6)) {
        return "jitter: a shift of 0 to 1000000 mm is needed";
    }
    return is_power_of_two(settings->samples) ? NULL : "jitter: samples: a power of two from 16 to 1048576 is needed";
}

bool selector_options_are_same(const conus_selector_options *a, const conus_selector_options *b)
{
    _Static_assert(offsetof(conus_selector_options, slice_fraction) + sizeof a->slice_fraction == sizeof *a,
                   "a new option is compared here, too");
    return a->engine == b->engine && a->aperture == b->aperture && a->sampling == b->sampling &&
           a->resolution == b->resolution && a->slices == b->slices && a->layers == b->layers &&
           a->range[0] == b->range[0] && a->range[1] == b->range[1] && a->radius == b->radius && a->score == b->score &&
           a->slice_fraction == b->slice_fraction && strcmp(a->level ? a->level : "", b->level ? b->level : "") == 0;
}

bool study_has_same_selectors(const struct study_question *a, const struct study_question *b)
{
    return a->atlas_number == b->atlas_number && strcmp(a->level, b->level) == 0 &&
           selector_options_are_same(&a->options, &b->options);
}

/* The settings that the kind has. */
static bool ask_same(const struct study_settings *a, const struct study_settings *b)
{
    bool same_angles = a->angles[0] == b->angles[0] && a->angles[1] == b->angles[1] && a->angles[2] == b->angles[2];
    bool same_errors = a->tilt_deg == b->tilt_deg && a->shift_mm == b->shift_mm && a->samples == b->samples;
    return a->kind == b->kind && (a->kind == STUDY_SWEEP ? same_angles : same_errors);
}

bool study_is_same(const struct study_question *a, const struct study_question *b)
{
    bool same_pose = true;
    for (int i = 0; i < 16; i++) {
        same_pose = same_pose && a->pose.world_from_device[i] == b->pose.world_from_device[i];
    }
    return same_pose && ask_same(&a->settings, &b->settings) && study_has_same_selectors(a, b) &&
           (a->settings.kind == STUDY_SWEEP || a->angle == b->angle);
}
