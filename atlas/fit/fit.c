/* SPDX-License-Identifier: BSD-3-Clause */
/* Tries the usual mistakes: the direction of a transform, LPS for RAS, metres for millimetres. */
#include "atlas/fit/fit.h"

#include "base/geometry/math3.h"

struct fit fit_of(const struct head *head, const struct area_points *points, const double move[16])
{
    size_t in_grid = 0;
    size_t in_head = 0;
    for (size_t i = 0; i < points->count; i++) {
        double point[3];
        bool inside = false;
        mat4_point(point, move, points->at + 3 * i);
        in_grid += head_grid_has(&inside, head, point);
        in_head += inside;
    }
    const double count = (double)points->count;
    return (struct fit){(double)in_grid / count, (double)in_head / count};
}

/* Another way to read the transform. */
struct reading {
    bool inverse, lps, metres, none;
    const char *words;
};

static const struct reading readings[] = {
    {.inverse = true, .words = "in the other direction"},
    {.lps = true, .words = "with LPS in the place of RAS"},
    {.metres = true, .words = "with a translation 1000 times as long (metres)"},
    {.inverse = true, .lps = true, .words = "in the other direction and with LPS in the place of RAS"},
    {.inverse = true,
     .metres = true,
     .words = "in the other direction and with a translation 1000 times as long (metres)"},
    {.none = true, .words = "without the transform"},
};

/* The matrix from where the atlas is to where the reading would have it. False where that is out of question:
 * a matrix that cannot be inverted, or an atlas more than eight times smaller or larger than its own. */
static bool read_again(double move[16], const conus_atlas *atlas, const struct reading *reading)
{
    double own_from_there[16];
    double there_from_own[16];
    mat4_identity(own_from_there);
    if (!reading->none) {
        memcpy(own_from_there, atlas->own_from_world, sizeof own_from_there);
    }
    if (reading->lps) {
        for (size_t column = 0; column < 4; column++) {
            for (size_t row = 0; row < 4; row++) {
                own_from_there[4 * column + row] *= (column < 2) != (row < 2) ? -1 : 1;
            }
        }
    }
    for (int a = 12; reading->metres && a < 15; a++) {
        own_from_there[a] *= 1000;
    }
    double growth = fabs(mat4_determinant3(own_from_there));
    bool possible = mat4_invert_affine(there_from_own, own_from_there) && growth > 0.125 && growth < 8;
    if (possible) {
        mat4_multiply(move, reading->inverse ? own_from_there : there_from_own, atlas->own_from_world);
    }
    return possible;
}

static conus_status compare(conus_atlas *atlas, const struct head *head, const struct area_points *points)
{
    double move[16];
    const struct reading *best = NULL;
    mat4_identity(move);
    const struct fit fit = fit_of(head, points, move);
    struct fit most = fit;
    for (size_t i = 0; i < sizeof readings / sizeof readings[0] && !atlas->warp_count; i++) {
        const struct fit other = read_again(move, atlas, &readings[i]) ? fit_of(head, points, move) : (struct fit){0};
        if (other.in_head > most.in_head) {
            most = other;
            best = &readings[i];
        }
    }
    /* Clearly better: a tenth of the atlas more, and at most half as much of it outside. */
    if (best && most.in_head >= fit.in_head + 0.1 && 1 - most.in_head <= (1 - fit.in_head) / 2) {
        return notes_warn(&atlas->notes, "%.0f %% of the atlas is in the head of %s; %s it would be %.0f %%",
                          100 * fit.in_head, head->context->info.path, best->words, 100 * most.in_head);
    }
    return fit.in_head >= 0.8
               ? CONUS_OK
               : notes_warn(&atlas->notes,
                            "%.0f %% of the atlas is in the head of %s: is the transform %sof another image?",
                            100 * fit.in_head, head->context->info.path,
                            atlas->warp_count ? "of the other direction, or " : "");
}

static conus_status note_of(conus_atlas *atlas, const struct volume *context)
{
    struct area_points points = {0};
    struct head head = {0};
    conus_status status = area_points_make(&points, atlas);
    status = status ? status : head_make(&head, context);
    status = status || !points.count || !isfinite(head.threshold) ? status : compare(atlas, &head, &points);
    head_finish(&head);
    area_points_finish(&points);
    return status;
}

conus_status fit_note(conus_atlas *atlas, const conus_volume_info *info, float *values)
{
    struct volume context = {0};
    if (!atlas->is_moved) {
        return CONUS_OK;
    }
    conus_status status = volume_init(&context, info);
    context.values = values;
    status = status ? status : note_of(atlas, &context);
    context.values = NULL; /* the caller's */
    volume_finish(&context);
    return status;
}

conus_status fit_note_surfaces(conus_atlas *atlas)
{
    struct volume inside = {0};
    bool has_left = false;
    bool has_right = false;
    for (size_t i = 0; i < atlas->context_surface_count; i++) {
        has_left = has_left || atlas->context_surfaces[i].hemisphere == 'L';
        has_right = has_right || atlas->context_surfaces[i].hemisphere == 'R';
    }
    /* Much of the atlas is not in one hemisphere. */
    if (!atlas->is_moved || atlas_context(atlas) || has_left != has_right) {
        return CONUS_OK;
    }
    conus_status status = surface_head_make(&inside, atlas);
    if (!status && inside.values) {
        inside.info.path = atlas->context_surfaces[atlas->context_surface_count - 1].mesh.path;
        status = note_of(atlas, &inside);
    }
    volume_finish(&inside);
    return status;
}
