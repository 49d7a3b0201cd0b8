/* SPDX-License-Identifier: BSD-3-Clause */
/* The JSON of conus info. */
#include "cli/answers/answers.h"
#include "conus/own.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* False where there is nothing to show. */
static bool find_place(conus_placement *out, const conus_atlas *atlas)
{
    *out = (conus_placement)CONUS_PLACEMENT_INIT;
    return !conus_atlas_placement(out, atlas) && out->is_moved;
}

void info_drop_rounding(double *numbers, size_t count, double scale)
{
    for (size_t i = 0; i < count; i++) {
        scale = fmax(scale, fabs(numbers[i]));
    }
    for (size_t i = 0; i < count; i++) {
        numbers[i] = fabs(numbers[i]) <= 1e-7 * scale ? 0 : numbers[i];
    }
}

/* Values that "%.1f" shows as 0.0 lose their sign. */
static double tenths(double value)
{
    return fabs(value) < 0.05 ? 0 : value;
}

static void put_box(FILE *out, const char *what, const double low[3], const double high[3])
{
    fprintf(out, "  %s x %.1f to %.1f, y %.1f to %.1f, z %.1f to %.1f mm\n", what, tenths(low[0]), tenths(high[0]),
            tenths(low[1]), tenths(high[1]), tenths(low[2]), tenths(high[2]));
}

void info_put_reach(FILE *out, const double low[3], const double high[3])
{
    double ends[6];
    for (size_t a = 0; a < 6; a++) {
        ends[a] = a % 2 ? high[a / 2] : low[a / 2];
    }
    info_drop_rounding(ends, 6, 0);
    fprintf(out, "  reaches      x %.6g to %.6g, y %.6g to %.6g, z %.6g to %.6g mm\n", ends[0], ends[1], ends[2],
            ends[3], ends[4], ends[5]);
}

static void put_context(FILE *out, const conus_atlas *atlas, const conus_placement *place)
{
    bool is_volume = false;
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        is_volume = is_volume || conus_atlas_volume(atlas, i)->role == CONUS_ROLE_CONTEXT;
    }
    fprintf(out, "  in context   %.1f %% of its voxels in the %s", 100 * place->in_grid,
            is_volume ? "grid" : "box around the closed surfaces");
    if (!is_volume) {
        fprintf(out, ", %.1f %% in the head (in them, and what they enclose)", 100 * place->in_head);
    } else if (isfinite(place->head_threshold)) {
        fprintf(out, ", %.1f %% in the head (values from %.4g on, and what they enclose)", 100 * place->in_head,
                place->head_threshold);
    }
    fputc('\n', out);
}

void info_place_put(FILE *out, const conus_atlas *atlas)
{
    conus_placement place;
    if (!find_place(&place, atlas)) {
        return;
    }
    fputs("\nMoved\n", out);
    if (!place.is_warped) {
        fprintf(out, "  volume       1 mm^3 of the atlas is %.4g mm^3 here\n", place.growth);
        fprintf(out, "  sides        left and right are %s\n", place.mirrors ? "exchanged" : "kept");
    }
    fprintf(out, "  centre       %.1f, %.1f, %.1f mm, %.1f mm from where its files have it\n", tenths(place.centre[0]),
            tenths(place.centre[1]), tenths(place.centre[2]), place.distance_mm);
    if (!place.is_warped) {
        put_box(out, "areas were  ", place.own_low, place.own_high);
    }
    put_box(out, "areas are   ", place.low, place.high);
    if (place.has_context) {
        put_context(out, atlas, &place);
    }
}

static json_t *point(const double p[3])
{
    return isfinite(p[0] + p[1] + p[2]) ? json_pack("[f,f,f]", p[0], p[1], p[2]) : json_null();
}

static json_t *number(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

/* Row by row, as people write a matrix. */
static json_t *matrix(const double m[16])
{
    json_t *rows = json_array();
    for (size_t i = 0; i < 4; i++) {
        json_array_append_new(rows, json_pack("[f,f,f,f]", m[i], m[4 + i], m[8 + i], m[12 + i]));
    }
    return rows;
}

/* JSON's null where there is nothing to say. */
static json_t *placement(const conus_atlas *atlas)
{
    conus_placement place;
    if (!find_place(&place, atlas)) {
        return json_null();
    }
    double in_head = isfinite(place.head_threshold) ? place.in_head : NAN;
    json_t *context = !place.has_context ? json_null()
                                         : json_pack("{s:f,s:o,s:o}", "in_grid", place.in_grid, "in_head",
                                                     number(in_head), "head_threshold", number(place.head_threshold));
    return json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "atlas_from_world",
                     place.is_warped ? json_null() : matrix(place.atlas_from_world), "growth", number(place.growth),
                     "mirrors", place.is_warped ? json_null() : json_boolean(place.mirrors), "centre",
                     point(place.centre), "distance_mm", number(place.distance_mm), "own_low", point(place.own_low),
                     "own_high", point(place.own_high), "low", point(place.low), "high", point(place.high), "context",
                     context);
}

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

static json_t *tractogram(const conus_atlas *atlas, size_t index, const conus_tractogram_info *info)
{
    static const double none[3] = {NAN, NAN, NAN};
    return json_pack("{s:o,s:o,s:s,s:b,s:I,s:I,s:f,s:f,s:o,s:o,s:o,s:o}", "path", info_json_bytes(info->path), "sha256",
                     *info->sha256 ? json_string(info->sha256) : json_null(), "format", info->format, "half",
                     info->half, "streamlines", (json_int_t)info->streamlines, "points", (json_int_t)info->points,
                     "length_mm", info->length_mm, "radius_mm", info->radius, "low",
                     point(info->points ? info->low : none), "high", point(info->points ? info->high : none), "scalars",
                     scalars(atlas, index), "bundles", bundles(atlas, info));
}

static json_t *tractograms(const conus_atlas *atlas)
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

json_t *info_json_bytes(const char *bytes)
{
    json_t *text = json_string(bytes);
    char *copy = text ? NULL : calloc(strlen(bytes) + 1, 2);
    char *to = copy;
    for (const char *from = bytes; copy && *from; from++) {
        unsigned char c = (unsigned char)*from;
        *to++ = (char)(c < 0x80 ? c : 0xc0 | c >> 6);
        if (c >= 0x80) {
            *to++ = (char)(0x80 | (c & 0x3f));
        }
    }
    text = copy ? json_string(copy) : text;
    free(copy);
    return text;
}

static json_t *hemisphere(char letter)
{
    return letter ? json_pack("s#", &letter, (size_t)1) : json_null();
}

/* Labels keep all their digits, which json_real() would cut. */
static json_t *value(double number)
{
    bool whole = fabs(number) < 0x1p53 && number == floor(number);
    return whole ? json_integer((json_int_t)number) : json_real(number);
}

/* Null where a band has no end. */
static json_t *end_of(double end)
{
    return isfinite(end) ? value(end) : json_null();
}

static json_t *volume(const conus_atlas *atlas, size_t index)
{
    const conus_volume_info *info = conus_atlas_volume(atlas, index);
    json_t *bands = json_array();
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        const conus_object *object = conus_atlas_object(atlas, i);
        if (object->is_band && object->volume == index) {
            json_array_append_new(bands, json_pack("{s:s,s:o,s:o}", "name", object->name, "low", end_of(object->low),
                                                   "high", end_of(object->high)));
        }
    }
    static const char *const roles[] = {
        [CONUS_ROLE_PARCELLATION] = "parcellation",
        [CONUS_ROLE_SCALAR] = "pathway",
        [CONUS_ROLE_CONTEXT] = "context",
        [CONUS_ROLE_PROBABILITY] = "probability",
    };
    json_t *json = json_pack(
        "{s:s,s:o,s:s,s:s,s:s,s:o,s:I,s:I,s:o,s:[f,f,f],s:s,s:s,s:f,s:f,s:o,s:o}", "role", roles[info->role], "path",
        info_json_bytes(info->path), "sha256", info->sha256, "format", info->format, "datatype", info->datatype, "dim",
        json_pack("[I,I,I]", (json_int_t)info->dim[0], (json_int_t)info->dim[1], (json_int_t)info->dim[2]), "volume",
        (json_int_t)info->volume, "volume_count", (json_int_t)info->volume_count, "world_from_voxel",
        matrix(info->world_from_voxel), "spacing_mm", info->spacing[0], info->spacing[1], info->spacing[2],
        "orientation", info->orientation, "transform", info->transform, "slope", info->slope, "intercept",
        info->intercept, "minimum", value(info->minimum), "maximum", value(info->maximum));
    if (json_array_size(bands)) {
        json_object_set(json, "bands", bands);
    } else if (info->role == CONUS_ROLE_SCALAR || info->threshold != 0) {
        json_object_set_new(json, "threshold", json_real(info->threshold));
    }
    json_decref(bands);
    return json;
}

json_t *info_json_object(const conus_atlas *atlas, size_t number)
{
    const conus_object *object = conus_atlas_object(atlas, number);
    static const char *const kinds[] = {
        [CONUS_KIND_AREA] = "area", [CONUS_KIND_PATHWAY] = "pathway", [CONUS_KIND_BUNDLE] = "bundle"};
    const conus_object *parent = conus_atlas_object(atlas, object->parent);
    bool has_surface = object->triangles > 0;
    char color[8];
    snprintf(color, sizeof color, "#%02x%02x%02x", object->rgb[0], object->rgb[1], object->rgb[2]);
    json_t *json = json_pack(
        "{s:s,s:I,s:o,s:b,s:o,s:o,s:o,s:I,s:s,s:I,s:o,s:o,s:o}", "kind", kinds[object->kind], "index",
        (json_int_t)object->label, "name", info_json_bytes(object->name), "named", object->named, "abbreviation",
        *object->abbreviation ? info_json_bytes(object->abbreviation) : json_null(), "hemisphere",
        hemisphere(object->hemisphere), "parent", parent ? json_integer(parent->label) : json_null(), "depth",
        (json_int_t)conus_atlas_depth(atlas, number), "color", color, "voxels", (json_int_t)object->voxels, "triangles",
        has_surface ? json_integer((json_int_t)object->triangles) : json_null(), "closed",
        has_surface ? json_boolean(object->closed) : json_null(), "volume_mm3",
        has_surface && object->volume_mm3 == 0 ? json_null() : json_real(object->volume_mm3));
    if (object->kind == CONUS_KIND_BUNDLE &&
        (json_object_set_new(json, "streamlines", json_integer((json_int_t)object->streamlines)) ||
         json_object_set_new(json, "points", json_integer((json_int_t)object->points)) ||
         json_object_set_new(json, "length_mm", json_real(object->length_mm)))) {
        json_decref(json);
        json = NULL;
    }
    return json;
}

static json_t *around(const conus_atlas *atlas)
{
    json_t *surfaces = json_array();
    for (size_t i = 0; i < conus_atlas_context_surface_count(atlas); i++) {
        conus_context_surface surface = CONUS_CONTEXT_SURFACE_INIT;
        if (!conus_atlas_context_surface(&surface, atlas, i)) {
            const double *low = surface.low;
            const double *high = surface.high;
            json_array_append_new(surfaces,
                                  json_pack("{s:o,s:I,s:I,s:b,s:o,s:f,s:[f,f,f],s:[f,f,f]}", "path",
                                            info_json_bytes(surface.path), "vertices", (json_int_t)surface.vertices,
                                            "triangles", (json_int_t)surface.triangles, "closed", surface.closed,
                                            "hemisphere", hemisphere(surface.hemisphere), "opacity", surface.opacity,
                                            "low", low[0], low[1], low[2], "high", high[0], high[1], high[2]));
        }
    }
    return surfaces;
}

json_t *info_json_installed(const conus_installed *atlas)
{
    const double *mm = atlas->spacing;
    return json_pack("{s:s,s:s,s:s,s:o,s:o,s:o}", "name", atlas->name, "source", atlas->source, "kind", atlas->kind,
                     "voxel_mm", mm[0] > 0 ? json_pack("[f,f,f]", mm[0], mm[1], mm[2]) : json_null(), "labels",
                     atlas->labels ? info_json_bytes(atlas->labels) : json_null(), "path",
                     info_json_bytes(atlas->path));
}

const char *const info_source_states[] = {
    [CONUS_SOURCE_SAME] = "same", [CONUS_SOURCE_CHANGED] = "changed", [CONUS_SOURCE_MISSING] = "not there"};

static json_t *pack(const conus_atlas *atlas, const conus_pack_info *info)
{
    json_t *sources = json_array();
    const char *path;
    conus_source_state state;
    for (size_t i = 0; (path = conus_atlas_pack_source(&state, atlas, i)); i++) {
        json_array_append_new(
            sources, json_pack("{s:o,s:s}", "path", info_json_bytes(path), "state", info_source_states[state]));
    }
    return json_pack("{s:o,s:s,s:o,s:s,s:I,s:o}", "path", info_json_bytes(info->path), "sha256", info->sha256, "words",
                     info_json_bytes(info->words), "version", info->version, "bytes", (json_int_t)info->size, "sources",
                     sources);
}

/* Which published atlas it is. */
static json_t *identity(const conus_atlas *atlas)
{
    const conus_atlas_identity_view view = conus_atlas_identity(atlas);
    const conus_atlas_facts *facts = view.facts;
    return !*view.sum ? json_null()
           : !facts
               ? json_pack("{s:s,s:n}", "voxels", view.sum, "name")
               : json_pack("{s:s,s:s,s:b,s:b,s:s?,s:s?,s:s,s:s?}", "voxels", view.sum, "name", facts->name, "verified",
                           view.is_verified, "other_names", view.has_other_names, "edition",
                           view.is_verified ? facts->edition : NULL, "space", view.is_verified ? facts->space : NULL,
                           "reference", facts->reference, "licence", view.is_verified ? facts->licence : NULL);
}

json_t *info_json(const conus_atlas *atlas, const conus_installed *installed)
{
    json_t *volumes = json_array();
    json_t *notes = json_array();
    json_t *objects = json_array();
    bool whole = true;
    for (size_t i = 0; i < conus_atlas_volume_count(atlas); i++) {
        whole = json_array_append_new(volumes, volume(atlas, i)) == 0 && whole;
    }
    for (size_t i = 0; i < conus_atlas_note_count(atlas); i++) {
        whole = json_array_append_new(notes, info_json_bytes(conus_atlas_note(atlas, i))) == 0 && whole;
    }
    for (size_t i = 1; i <= conus_atlas_object_count(atlas); i++) {
        whole = json_array_append_new(objects, info_json_object(atlas, i)) == 0 && whole;
    }
    conus_frame frame; /* from AP, DV, ML in micrometres; null where the atlas is not the Allen CCF */
    bool is_ccf = conus_frame_find(&frame, atlas, CONUS_SPACE_CCF, NULL) == CONUS_OK;
    const conus_brain_view brain = conus_atlas_brain(atlas);
    json_t *root = json_pack("{s:s,s:o,s:o,s:s,s:s,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "conus", conus_version(),
                             "installed", installed ? info_json_installed(installed) : json_null(), "labels",
                             info_json_bytes(conus_atlas_label_source(atlas)), "brain", brain.words, "brain_source",
                             brain.source, "identity", identity(atlas), "volumes", volumes, "tractograms",
                             tractograms(atlas), "context_surfaces", around(atlas), "world_from_ccf",
                             is_ccf ? matrix(frame.world_from_space) : json_null(), "moved", placement(atlas), "notes",
                             notes, "objects", objects);
    const conus_pack_info *info = conus_atlas_pack_info(atlas);
    whole = root && (!info || json_object_set_new(root, "pack", pack(atlas, info)) == 0) && whole;
    if (!whole) {
        json_decref(root);
    }
    return whole ? root : NULL;
}
