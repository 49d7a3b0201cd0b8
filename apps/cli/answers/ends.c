/* SPDX-License-Identifier: BSD-3-Clause */
/* Options of the ends of streamlines. */
#include "cli/answers/answers.h"

#include "conus/own.h"
#include "options/messages.h"

const struct option endpoints_options[] = {
    {OPTION_VALUED("endpoints", struct ends_settings, endpoints, "FILE"),
     .help = "write which areas the streamlines in the cone or ball connect: a row for each bundle and pair of areas",
     .role = OPTION_WRITES_ROWS, .flags = OPTION_OF_REGION, .holds = HOLDS_ROWS},
    {0},
};

const struct option connectivity_options[] = {
    {OPTION_VALUED("connectivity", struct ends_settings, connectivity, "FILE"),
     .help = "write the table, area by area, of how many streamlines connect them: .tsv, .csv, or .json; it has all "
             "areas with voxels or triangles, or those of --only in their order",
     .words = "connectome, matrix", .role = OPTION_WRITES_ROWS,
     .flags = OPTION_OF_REGION | OPTION_OF_ONE_ATLAS | OPTION_OF_ONE_POSE, .holds = HOLDS_ROWS},
    {OPTION_MM("endpoint-radius", struct ends_settings, radius),
     .help = "an end of a streamline that is in no area has the nearest one within this radius, up to 100; 0 = none",
     .standard = "2"},
    {0},
};

bool ends_check(const struct ends_settings *settings, const struct arguments *arguments)
{
    if (option_given(arguments, "endpoint-radius") && !(settings->radius >= 0 && settings->radius <= 100)) {
        return refuse("--endpoint-radius: %g mm, allowed are 0 to 100", settings->radius);
    }
    return true;
}

double ends_radius_of(const struct ends_settings *settings, const struct arguments *arguments)
{
    bool is_given = option_given(arguments, "endpoint-radius");
    return !is_given ? 0 : settings->radius > 0 ? settings->radius : -1;
}

bool ends_check_atlases(const struct atlases *atlases)
{
    bool is_hidden = false;
    for (size_t i = 0; i < atlases->count; i++) {
        const conus_object *object;
        for (uint32_t number = 1; (object = conus_atlas_object(atlases->items[i].atlas, number)); number++) {
            if (object->kind == CONUS_KIND_BUNDLE && !conus_atlas_is_hidden(atlases->items[i].atlas, number)) {
                return true;
            }
            is_hidden = is_hidden || object->kind == CONUS_KIND_BUNDLE;
        }
    }
    return is_hidden ? refuse("all streamlines are hidden: --only names the bundles to keep beside areas")
                     : refuse("there are no streamlines, --streamlines FILE adds some");
}
