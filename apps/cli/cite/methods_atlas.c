/* SPDX-License-Identifier: BSD-3-Clause */
/* Words what a sidecar says of an atlas: its files, its place, what was an object. */
#include "cli/cite/citation.h"

#include <string.h>

enum { LISTED = 10 };

static void put_bands(FILE *out, const json_t *bands)
{
    size_t index;
    const json_t *band;
    json_array_foreach(bands, index, band)
    {
        const json_t *low = json_object_get(band, "low");
        const json_t *high = json_object_get(band, "high");
        fprintf(out, "%s%s (", index ? ", " : "", json_string_value(json_object_get(band, "name")));
        if (json_is_number(low)) {
            fprintf(out, "from %.9g", json_number_value(low));
        }
        fputs(json_is_number(low) && json_is_number(high) ? " " : "", out);
        if (json_is_number(high)) {
            fprintf(out, "to below %.9g", json_number_value(high));
        }
        fputs(json_is_number(low) || json_is_number(high) ? ")" : "all values)", out);
    }
}

static const char *name_of(const char *path)
{
    const char *slash = path ? strrchr(path, '/') : NULL;
    return slash ? slash + 1 : path ? path : "a volume";
}

/* What a volume other than of labels was taken for. */
static void put_volume(FILE *out, const json_t *volume, bool is_overlap)
{
    const char *role = json_string_value(json_object_get(volume, "role"));
    const char *file = name_of(json_string_value(json_object_get(volume, "path")));
    const json_t *bands = json_object_get(volume, "bands");
    double threshold = json_number_value(json_object_get(volume, "threshold"));
    if (role && strcmp(role, "pathway") == 0 && bands) {
        fprintf(out, " Values of %s made up ", file);
        put_bands(out, bands);
        fputs(".", out);
    } else if (role && strcmp(role, "pathway") == 0) {
        fprintf(out, " Voxels of %s with values of at least %.9g counted as a pathway.", file, threshold);
    } else if (role && strcmp(role, "probability") == 0) {
        fprintf(out, " Voxels of %s with values of at least %.9g counted as an area.", file, threshold);
    } else if (role && strcmp(role, "context") == 0 && threshold != 0 && !is_overlap) {
        fprintf(out, " Voxels of %s with values of at least %.9g blocked the rays.", file, threshold);
    }
}

/* Equal sentences of many volumes are one. */
static void put_volumes(FILE *out, const json_t *volumes, bool is_overlap)
{
    size_t size = json_array_size(volumes);
    size_t index;
    const json_t *volume;
    size_t listed = 0;
    json_array_foreach(volumes, index, volume)
    {
        const char *role = json_string_value(json_object_get(volume, "role"));
        bool is_labels = role && strcmp(role, "parcellation") == 0;
        if (!is_labels && listed++ < LISTED) {
            put_volume(out, volume, is_overlap);
        }
    }
    if (listed > LISTED) {
        fprintf(out, " So did those of %zu more of the %zu volumes, each from its own threshold on.", listed - LISTED,
                size);
    }
}

static void put_tractograms(FILE *out, const json_t *tractograms, bool has_rays)
{
    size_t size = json_array_size(tractograms);
    for (size_t i = 0; i < size && i < LISTED; i++) {
        const json_t *entry = json_array_get(tractograms, i);
        fprintf(out, " The %" JSON_INTEGER_FORMAT " streamlines of %s counted as lines",
                json_integer_value(json_object_get(entry, "streamlines")),
                name_of(json_string_value(json_object_get(entry, "path"))));
        if (has_rays) {
            fprintf(out, "; rays hit them as tubes of radius %.9g mm",
                    json_number_value(json_object_get(entry, "radius_mm")));
        }
        fputc('.', out);
    }
    if (size > LISTED) {
        fprintf(out, " So did those of %zu more tractograms%s.", size - LISTED,
                has_rays ? ", each of its own radius" : "");
    }
}

static bool is_identity(const json_t *matrix)
{
    bool is = true;
    for (size_t i = 0; i < 16; i++) {
        const json_t *row = json_array_get(matrix, i / 4);
        is = is && json_number_value(json_array_get(row, i % 4)) == (i % 5 == 0 ? 1 : 0);
    }
    return is;
}

/* How the atlas came to where it was asked. */
static void put_way(FILE *out, const json_t *atlas)
{
    size_t fields = 0;
    size_t affines = 0;
    size_t index;
    const json_t *step;
    json_array_foreach(json_object_get(atlas, "way_to_atlas"), index, step)
    {
        const json_t *matrix = json_object_get(step, "matrix");
        fields += json_object_get(step, "field") != NULL;
        affines += matrix && !is_identity(matrix);
    }
    if (fields) {
        fprintf(out, " It was brought into the space of the positions by %s%s.",
                fields == 1 ? "a deformation field" : "several deformation fields",
                affines ? " and affine transforms" : "");
        fputs(json_array_size(json_object_get(atlas, "volumes"))
                  ? " Its voxels were resampled by the nearest neighbour."
                  : "",
              out);
    } else if (json_object_get(atlas, "atlas_from_world")) {
        fputs(" It was brought into the space of the positions by an affine transform, without resampling.", out);
    }
}

static void put_treatment(FILE *out, const struct citation *citation, const json_t *atlas)
{
    const char *hemispheres = json_string_value(json_object_get(atlas, "hemispheres"));
    const char *hidden = json_string_value(json_object_get(atlas, "hidden"));
    const char *level = json_string_value(json_object_get(atlas, "level"));
    level = level ? level : json_string_value(citation_setting(citation, "level"));
    put_volumes(out, json_object_get(atlas, "volumes"), citation_is_of(citation, "overlap"));
    put_tractograms(out, json_object_get(atlas, "tractograms"), citation_has_rays(citation));
    if (level) {
        fprintf(out, " Areas were joined along the area tree to the level \"%s\".", level);
    }
    if (hidden) {
        fputs(" Some of its objects were left out, as if they were not there", out);
        fprintf(out, "%s%s.", strlen(hidden) < 200 ? ", by label: " : "; the sidecar lists them",
                strlen(hidden) < 200 ? hidden : "");
    }
    if (hemispheres && strcmp(hemispheres, "split") == 0) {
        fputs(" Areas on both sides were cut in two at x = 0 of the atlas.", out);
    } else if (hemispheres && strcmp(hemispheres, "merged") == 0) {
        fputs(" Left and right areas of one name were joined.", out);
    }
    put_way(out, atlas);
}

/* "sform, code 1 (scanner)", "the Allen CCF's grid", "none: voxel sizes only, ..." */
static void put_place(FILE *out, const char *transform)
{
    static const char none[] = "none: ";
    bool is_none = strncmp(transform, none, sizeof none - 1) == 0;
    bool is_its = !is_none && strncmp(transform, "the ", 4) != 0;
    if (*transform) {
        fprintf(out, ", placed by %s%s", is_its ? "its " : "", transform + (is_none ? sizeof none - 1 : 0));
    }
}

void citation_atlas(FILE *out, const struct citation *citation, size_t index)
{
    const struct cited_atlas *atlas = &citation->atlases[index];
    const json_t *several = json_object_get(citation->sidecar, "Atlases");
    const json_t *own = several ? json_array_get(several, index) : json_object_get(citation->sidecar, "Atlas");
    const json_t *volume = json_array_get(json_object_get(own, "volumes"), 0);
    const char *transform = json_string_value(json_object_get(volume, "transform"));
    fprintf(out, " %s %s (file %s", index ? "Another atlas, asked by itself, was" : "The atlas was", atlas->name,
            atlas->file);
    if (atlas->sha256) {
        fprintf(out, ", SHA-256 %.8s…", atlas->sha256);
    }
    put_place(out, transform ? transform : "");
    fputs(atlas->references.count ? "; see the references)." : ").", out);
    put_treatment(out, citation, own);
}
