/* SPDX-License-Identifier: BSD-3-Clause */
/* The options --space and --bregma, and what they mean for atlases. */
#include "conus/own.h"
#include "options/messages.h"
#include "settings/settings.h"

#include <math.h>

const struct option space_options[] = {
    {OPTION_VALUED("space", struct space_settings, name, "NAME"),
     .help =
         "what the three numbers of all positions, given and reported, are: mm to the right, anterior, superior (ras) "
         "or left, posterior, superior (lps); of the Allen CCF, micrometres AP, DV, ML from its corner (ccf), or mm "
         "AP, ML, DV from bregma, to anterior, right, dorsal (bregma):",
     .choice_at = conus_space_name,
     .advice = "; whose brain it is the atlas says, and positions are in that without --space; --atlas-transform "
               "moves an atlas to another brain"},
    {OPTION_VALUED("bregma", struct space_settings, bregma, "AP,DV,ML"),
     .help = "with --space bregma: where bregma lies in the Allen CCF, micrometres; the default is the International "
             "Brain Laboratory's",
     .standard = "5400,332,5739", .needs = "space=bregma", .unit = "um"},
    {0},
};

bool space_settings_check(const struct arguments *arguments, const struct space_settings *settings)
{
    const double *b = settings->bregma;
    return !option_given(arguments, "bregma") || b[0] != 0 || b[1] != 0 || b[2] != 0 ||
           refuse("--bregma: 0,0,0 is the corner of the CCF's grid, AP,DV,ML in micrometres are needed");
}

bool space_settings_needs_atlas(const struct space_settings *settings)
{
    return settings->name >= CONUS_SPACE_CCF;
}

/* By an affine: where a field has moved it, the CCF is not found. */
static bool is_moved(const conus_atlas *atlas)
{
    static const double corners[4][3] = {{0, 0, 0}, {100, 0, 0}, {0, 100, 0}, {0, 0, 100}};
    bool moved = false;
    for (size_t i = 0; i < 4; i++) {
        double own[3];
        conus_atlas_own_point(own, atlas, corners[i]);
        for (size_t a = 0; a < 3; a++) {
            moved = moved || own[a] != corners[i][a];
        }
    }
    return moved;
}

int space_settings_frame(conus_frame *out, const struct atlases *atlases, const struct space_settings *settings,
                         bool quiet)
{
    const double *b = settings->bregma;
    const double *bregma = b[0] != 0 || b[1] != 0 || b[2] != 0 ? b : NULL;
    const char *name = conus_space_name(settings->name);
    conus_frame first;
    conus_status status =
        conus_frame_find(&first, atlases->count ? atlases->items[0].atlas : NULL, (conus_space)settings->name, bregma);
    for (size_t i = 1; i < atlases->count && !status; i++) {
        conus_frame frame;
        const struct named_atlas *at = &atlases->items[i];
        status = conus_frame_find(&frame, at->atlas, (conus_space)settings->name, bregma);
        bool is_one_place = true;
        for (int k = 0; k < 16 && !status; k++) {
            double difference = fabs(first.world_from_space[k] - frame.world_from_space[k]);
            is_one_place = is_one_place && difference <= (k < 12 ? 1e-6 : 1e-3);
        }
        if (!status && !is_one_place) {
            return print_data_error(
                "--space %s: the CCF lies elsewhere in atlas %s than in %s: a position would be two places", name,
                at->name, atlases->items[0].name);
        }
    }
    if (status) {
        return print_data_error("--space %s: %s", name, conus_message());
    }
    if (!quiet && space_settings_needs_atlas(settings)) {
        /* BrainGlobe's "asr" calls the side on which ML starts right, the Allen Institute left. */
        size_t ml = first.space == CONUS_SPACE_CCF ? 2 : 1;
        if (first.world_from_space[4 * ml] < 0) {
            print_error_line(
                "note: --space %s: ML grows to the right, as the Allen Institute counts; the atlas says that this "
                "side is left, and so do names, pictures and hemispheres (docs/spaces.md)",
                conus_space_name(first.space));
        }
        if (is_moved(atlases->items[0].atlas)) {
            print_error_line(
                "note: --space %s: the atlas was moved, and the CCF with it: a position is the same voxel as "
                "before, and only mm and angles are of the new place (docs/spaces.md)",
                conus_space_name(first.space));
        }
    }
    *out = first;
    return EXIT_DONE;
}
