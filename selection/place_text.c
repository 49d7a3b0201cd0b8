/* SPDX-License-Identifier: BSD-3-Clause */
/* Says how a place was understood. */
#include "conus/pose.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void conus_place_text(char out[CONUS_PLACE_TEXT], const conus_place *place, const conus_frame *frame)
{
    static const char *const kinds[] = {"", "", "the centroid of ", "nearest in ", "position "};
    conus_space space = frame ? frame->space : CONUS_SPACE_RAS;
    int decimals = space == CONUS_SPACE_CCF ? 0 : space == CONUS_SPACE_BREGMA || place->depth < 1 ? 3 : 1;
    double at[3];
    char depth[32] = "";
    char way[64] = "";
    memcpy(at, place->point, sizeof at);
    if (frame) {
        conus_frame_from_world(at, frame, place->point);
    }
    for (int a = 0; a < 3; a++) {
        double unit = pow(10, decimals);
        at[a] = round(at[a] * unit) / unit + 0; /* no -0.0 */
    }
    if (place->kind == CONUS_PLACE_INNER) {
        snprintf(depth, sizeof depth, ", %.*f mm inside", place->depth < 1 ? 3 : 1, place->depth);
    }
    if (place->toward) {
        snprintf(way, sizeof way, ", and %g mm from it towards %.16s,", place->way_mm, place->toward);
    }
    snprintf(out, CONUS_PLACE_TEXT, "%s%.240s%s%s%s(%.*f, %.*f, %.*f)%s%s%s", kinds[place->kind], place->name, way,
             place->is_on_scalp ? " on the scalp given" : "", *place->name ? ": " : "", decimals, at[0], decimals,
             at[1], decimals, at[2], depth,
             place->is_doubtful ? ", in MNI, where it is not known that the atlas lies" : "",
             !place->is_also_named                ? ""
             : place->kind == CONUS_PLACE_NUMBERS ? ", the numbers; an area is called so, too"
                                                  : ", the area; a position of a cap is called so, too (1020:)");
}
