/* SPDX-License-Identifier: BSD-3-Clause */
/* What conus info tells about tractograms. */
#include "cli/answers/info_tracts.h"

#include "cli/answers/info_json.h"
#include "cli/answers/info_place.h"

#include <inttypes.h>

/* "FA, colour (3) of points; weight of streamlines" */
static void put_scalars(FILE *out, const conus_atlas *atlas, size_t index, bool per_point, size_t *listed)
{
    conus_tract_scalar scalar = CONUS_TRACT_SCALAR_INIT;
    size_t before = *listed;
    for (size_t i = 0; !conus_atlas_tractogram_scalar(&scalar, atlas, index, i); i++) {
        if (scalar.per_point != per_point) {
            continue;
        }
        fprintf(out, "%s%s", *listed == before ? before ? "; " : "" : ", ", scalar.name);
        if (scalar.components > 1) {
            fprintf(out, " (%" PRIu32 ")", scalar.components);
        }
        ++*listed;
    }
    if (*listed > before) {
        fputs(per_point ? " of points" : " of streamlines", out);
    }
}

static void put_tractogram(FILE *out, const conus_atlas *atlas, size_t index, const conus_tractogram_info *info)
{
    fprintf(out, "\nTractogram\n  file         %s\n", info->path);
    fprintf(out, "  format       %s%s\n", info->format, info->half ? ", half precision" : "");
    fprintf(out, "  streamlines  %" PRIu64 " with %" PRIu64 " points, %.9g mm long together\n", info->streamlines,
            info->points, info->length_mm);
    fprintf(out, "  bundles      %zu, of radius %.9g mm\n", info->bundles, info->radius);
    if (info->points) {
        info_put_reach(out, info->low, info->high);
    }
    if (info->scalars) {
        size_t listed = 0;
        fputs("  numbers      ", out);
        put_scalars(out, atlas, index, true, &listed);
        put_scalars(out, atlas, index, false, &listed);
        fputc('\n', out);
    }
    if (*info->sha256) {
        fprintf(out, "  sha256       %s\n", info->sha256);
    }
}

void info_tracts_put(FILE *out, const conus_atlas *atlas)
{
    for (size_t i = 0; i < conus_atlas_tractogram_count(atlas); i++) {
        conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
        if (!conus_atlas_tractogram(&info, atlas, i)) {
            put_tractogram(out, atlas, i, &info);
        }
    }
}

static json_t *scalars(const conus_atlas *atlas, size_t index)
{
    conus_tract_scalar scalar = CONUS_TRACT_SCALAR_INIT;
    json_t *list = json_array();
    for (size_t i = 0; !conus_atlas_tractogram_scalar(&scalar, atlas, index, i); i++) {
        json_array_append_new(list, json_pack("{s:s,s:s,s:I}", "name", scalar.name, "of",
                                              scalar.per_point ? "points" : "streamlines", "components",
                                              (json_int_t)scalar.components));
    }
    return list;
}

static json_t *bundles(const conus_atlas *atlas, const conus_tractogram_info *info)
{
    json_t *names = json_array();
    for (size_t i = 0; i < info->bundles; i++) {
        json_array_append_new(names, json_string(conus_atlas_object(atlas, info->bundle + i)->name));
    }
    return names;
}

static json_t *corner(const double point[3], bool known)
{
    return known ? json_pack("[f,f,f]", point[0], point[1], point[2]) : json_null();
}

static json_t *tractogram(const conus_atlas *atlas, size_t index, const conus_tractogram_info *info)
{
    bool known = info->points > 0;
    return json_pack("{s:o,s:o,s:s,s:b,s:I,s:I,s:f,s:f,s:o,s:o,s:o,s:o}", "path", info_json_bytes(info->path), "sha256",
                     *info->sha256 ? json_string(info->sha256) : json_null(), "format", info->format, "half",
                     info->half, "streamlines", (json_int_t)info->streamlines, "points", (json_int_t)info->points,
                     "length_mm", info->length_mm, "radius_mm", info->radius, "low", corner(info->low, known), "high",
                     corner(info->high, known), "scalars", scalars(atlas, index), "bundles", bundles(atlas, info));
}

json_t *info_tracts_json(const conus_atlas *atlas)
{
    json_t *list = json_array();
    bool whole = list;
    for (size_t i = 0; i < conus_atlas_tractogram_count(atlas); i++) {
        conus_tractogram_info info = CONUS_TRACTOGRAM_INFO_INIT;
        if (!conus_atlas_tractogram(&info, atlas, i)) {
            whole = json_array_append_new(list, tractogram(atlas, i, &info)) == 0 && whole;
        }
    }
    if (!whole) {
        json_decref(list);
    }
    return whole ? list : NULL;
}
