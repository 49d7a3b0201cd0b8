/* SPDX-License-Identifier: BSD-3-Clause */
/* Errors of poses that studies have published (Eq. 29), by name. */
#include "base/memory.h"
#include "base/status.h"
#include "base/text.h"
#include "conus/own.h"

#include <math.h>
#include <string.h>

#define CAULFIELD "Caulfield 2022 doi:10.1016/j.brs.2022.08.013 PMC10026380"
#define CARDINALE "Cardinale 2013 doi:10.1227/NEU.0b013e31827d1161"
#define LOCALISED "doi:10.1038/s41598-025-01449-6"
#define PHILIPP "Philipp 2021 doi:10.1093/neuros/nyaa428"
#define SOLLMANN "Sollmann 2013 doi:10.1186/1471-2202-14-94 PMC3774221"
#define VAN_DER_LOO "van der Loo 2017 doi:10.1007/s00701-017-3242-9 PMC5557874"

/* The name of the law by width, whose row is that of 4 degrees. */
static const char by_width[] = "vr-controller";

static const conus_pose_error errors[] = {
    {.name = "dbs",
     .shift = 1.197,
     .source = PHILIPP,
     .measured = "tip of a lead, planned to final: 1.91 mm in the mean (27 studies, all techniques)"},
    {.name = "dbs-phantom-checked",
     .shift = 0.414,
     .source = "PMC11366303",
     .measured = "tip of a microelectrode, planned to first measured: 0.66 mm in the mean (91 electrodes)"},
    {.name = "dbs-software",
     .shift = 0.804,
     .source = LOCALISED,
     .measured = "tip of a lead, localised by two programs: 1.75 mm in the median of the differences"},
    {.name = "dbs-rater",
     .shift = 0.621,
     .source = LOCALISED,
     .measured = "tip of a lead, localised by two raters: 1.35 mm in the median of the differences"},
    {.name = "dbs-rater-same",
     .shift = 0.368,
     .source = LOCALISED,
     .measured = "tip of a lead, localised twice by one rater: 0.8 mm in the median of the differences"},
    {.name = "seeg",
     .shift = 1.466,
     .source = PHILIPP,
     .measured = "tip of an electrode, planned to final: 2.34 mm in the mean (10 studies, all techniques)"},
    {.name = "seeg-frame",
     .entry = 1.308,
     .target = 1.905,
     .depth = 1.905,
     .source = VAN_DER_LOO,
     .measured = "entry and target, planned to final: 1.54 mm and 2.93 mm in the median (902 electrodes)"},
    {.name = "seeg-frame-2013",
     .entry = 1.215,
     .target = 1.749,
     .depth = 1.749,
     .source = CARDINALE,
     .measured = "entry and target, planned to final, by a frame: 1.43 mm and 2.69 mm in the median"},
    {.name = "seeg-robot",
     .entry = 0.662,
     .target = 1.151,
     .depth = 1.151,
     .source = CARDINALE,
     .measured = "entry and target, planned to final, by a robot: 0.78 mm and 1.77 mm in the median"},
    {.name = "tms-cap",
     .tilt_deg = 6.216,
     .shift = 6.680,
     .source = CAULFIELD,
     .measured = "coil, from a saved pose to one by marks on a cap: 10.66 mm and a tilt of 7.79 degrees in the mean of "
                 "42 people; the coil slides on the scalp, so along the axis this is too much"},
    {.name = "tms-navigated",
     .tilt_deg = 0.271,
     .shift = 0.188,
     .source = CAULFIELD,
     .measured = "coil, from a saved pose to one by navigation: 0.3 mm and a tilt of 0.34 degrees in the mean of 42 "
                 "people; neither registration nor tracking is in it"},
    {.name = "tms-hotspot",
     .shift = 3.589,
     .source = SOLLMANN,
     .measured =
         "hotspot of a hand muscle, mapped twice by one examiner: differences of 8.1 mm in the mean (10 people)"},
    {.name = "tms-hotspot-other",
     .shift = 4.564,
     .source = SOLLMANN,
     .measured = "hotspot of a hand muscle, mapped by two examiners: differences of 10.3 mm in the mean (10 people)"},
    {.name = "tus-optical",
     .shift = 2.444,
     .source = "Sigona 2023 doi:10.1109/ojuffc.2023.3318560 PMC10785958",
     .measured = "focus, planned to measured, through a skull cap: 3.9 mm in the mean; mostly a constant offset"},
    {.name = "tus-optical-2019",
     .shift = 2.043,
     .source = "Chaplin 2019 doi:10.1007/s11548-019-01988-0 PMC6941738",
     .measured = "focus, aimed to heated, in a phantom: 3.26 mm in the mean; mostly a constant offset"},
    {.name = "tus-optical-macaque",
     .shift = 3.008,
     .source = "PMC11983265",
     .measured = "focus, planned to found by MR-ARFI, in macaques: 4.8 mm in the mean (18 studies)"},
    {.name = "tus-mr-arfi",
     .shift = 0.877,
     .source = "PMC11983265",
     .measured = "focus, planned to found by MR-ARFI, once corrected, in macaques: 1.4 mm in the mean (18 studies)"},
    {.name = "eeg-cap",
     .shift = 5.708,
     .source = "Scrivener 2022 doi:10.1002/brb3.2476 PMC8865144",
     .measured =
         "electrode in MNI space, between people: SD 3.94, 5.55 and 7.17 mm along x, y and z in the mean of the "
         "electrodes (20 people)"},
    {.name = by_width,
     .tilt_deg = 0.589,
     .source = "arXiv:2601.03522",
     .measured =
         "endpoint of a ray about the middle of a target W degrees wide: SD 0.2130 + 0.1102 W degrees along the "
         "movement, 0.2311 + 0.0715 W across (18 people)"},
};

enum { ERROR_COUNT = sizeof errors / sizeof errors[0] };

/* The width behind the name of the law that has one; NaN where there is none. */
static double width_of(const char *name)
{
    size_t length = strlen(by_width);
    double width = NAN;
    bool is = strncmp(name, by_width, length) == 0 && name[length] == ':';
    return is && text_to_double(text_from(name + length + 1), &width) && width >= 0 && width <= 90 ? width : NAN;
}

/* Root mean square of the standard deviations along the movement and across. */
static double tilt_of_width(double width)
{
    return hypot(0.2130 + 0.1102 * width, 0.2311 + 0.0715 * width) / sqrt(2);
}

/* Offers the names in which the word stands, else all. */
static conus_status fail_unknown(struct text word)
{
    struct buffer list = {0};
    bool all = false;
    for (int pass = word.size == 0; pass < 2 && !list.size; pass++) {
        all = pass;
        for (size_t i = 0; i < ERROR_COUNT; i++) {
            if (all || text_contains(text_from(errors[i].name), word)) {
                buffer_format(&list, "%s%s", list.size ? ", " : "", errors[i].name);
            }
        }
    }
    conus_status status = buffer_status(&list);
    status = status ? status
                    : fail(CONUS_ERROR_ARGUMENT, "\"%.*s\" is no published error; %s%s%s", TEXT_SHOW(word, 60),
                           all ? "there are " : "did you mean ", list.data, all ? "" : "?");
    buffer_finish(&list);
    return status;
}

conus_status conus_pose_error_find(conus_pose_error *out, const char *name)
{
    const struct text word = text_from(name);
    const double width = width_of(name);
    size_t least = (word.size + 1) / 3 + 1;
    const char *closest = NULL;
    for (size_t i = 0; i < ERROR_COUNT; i++) {
        size_t distance = text_distance(word, text_from(errors[i].name));
        if (errors[i].name == by_width ? !isnan(width) : distance == 0) {
            *out = errors[i];
            out->tilt_deg = isnan(width) ? out->tilt_deg : tilt_of_width(width);
            return CONUS_OK;
        }
        closest = distance < least ? errors[i].name : closest;
        least = distance < least ? distance : least;
    }
    if (closest == by_width || strncmp(name, by_width, strlen(by_width)) == 0) {
        return fail(CONUS_ERROR_ARGUMENT, "\"%.60s\": %s needs the width of the target, 0 to 90 degrees: %s:4", name,
                    by_width, by_width);
    }
    return closest ? fail(CONUS_ERROR_ARGUMENT, "\"%.60s\" is no published error; did you mean %s?", name, closest)
                   : fail_unknown(word);
}

const conus_pose_error *conus_pose_error_at(size_t index)
{
    return index < ERROR_COUNT ? &errors[index] : NULL;
}
