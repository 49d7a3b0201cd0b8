/* SPDX-License-Identifier: BSD-3-Clause */
/* Spaces of positions, and the place of the Allen CCF in an atlas. */
#include "atlas/atlas.h"

#include "atlas/space.h"
#include "base/geometry/math3.h"
#include "conus/own.h"

#include <string.h>

const double frame_ccf_size[3] = {13200, 8000, 11400};

static const double micrometre = 1e-3; /* mm */

/* In CCF. Mean of the voxels that five experimenters of the International Brain Laboratory picked (iblatlas,
 * "Coordinates and volumes"). */
static const double default_bregma[3] = {5400, 332, 5739};

/* A position this near to the corner, micrometres, is far outside of the brain: it must be in mm. */
static const double corner_um = 20;
/* A position this far from bregma, mm, is outside of any mouse: it must be in micrometres. */
static const double farthest_mm = 100;

enum { SPACES = CONUS_SPACE_BREGMA + 1 };

static const struct {
    const char *name, *axes[3], *unit;
} spaces[SPACES] = {
    [CONUS_SPACE_RAS] = {"ras", {"x", "y", "z"}, "mm"},
    [CONUS_SPACE_LPS] = {"lps", {"x", "y", "z"}, "mm"},
    [CONUS_SPACE_CCF] = {"ccf", {"AP", "DV", "ML"}, "um"},
    [CONUS_SPACE_BREGMA] = {"bregma", {"AP", "ML", "DV"}, "mm"},
};

const char *conus_space_name(size_t index)
{
    return index < SPACES ? spaces[index].name : NULL;
}

const char *conus_space_axis(conus_space space, size_t axis)
{
    return (size_t)space < SPACES && axis < 3 ? spaces[space].axes[axis] : NULL;
}

const char *conus_space_unit(conus_space space)
{
    return (size_t)space < SPACES ? spaces[space].unit : NULL;
}

static bool is_near(double found, double wanted)
{
    return fabs(found - wanted) <= 1e-3 * wanted;
}

bool frame_is_ccf_size(const double size[3])
{
    return is_near(size[0], frame_ccf_size[0]) && is_near(size[1], frame_ccf_size[1]) &&
           is_near(size[2], frame_ccf_size[2]);
}

/* The voxel axes along AP, DV and ML, by the size of the grid; false if it is not the CCF's. */
static bool find_axes(size_t axes[3], const conus_volume_info *info, const double world_from_voxel[16])
{
    bool used[3] = {false, false, false};
    for (size_t i = 0; i < 3; i++) {
        bool found = false;
        for (size_t axis = 0; axis < 3 && !found; axis++) {
            double size = vec3_length(world_from_voxel + 4 * axis) * (double)info->dim[axis];
            if (!used[axis] && is_near(size, frame_ccf_size[i] * micrometre)) {
                axes[i] = axis;
                used[axis] = found = true;
            }
        }
        if (!found) {
            return false;
        }
    }
    return true;
}

/* The world axis that a direction is nearest to. */
static size_t main_axis(const double direction[3])
{
    size_t most = fabs(direction[1]) > fabs(direction[0]) ? 1 : 0;
    return fabs(direction[2]) > fabs(direction[most]) ? 2 : most;
}

/* Where the CCF's grid is that of a volume. ML counts from the left, as the Allen Institute has it; but in a stack of
 * TIFF or in Zarr, which have that array as it is, whatever it calls its sides, from the first voxel. The axes of a
 * grid that is not named as anatomy has it lie as the Allen Institute writes them: AP, DV, ML, each from its first
 * voxel. */
static bool find_in_grid(double own_from_ccf[16], const conus_volume_info *info, const double world_from_voxel[16])
{
    size_t axes[3];
    double corner[3];
    if (!find_axes(axes, info, world_from_voxel)) {
        return false;
    }
    /* named: the voxel axes of AP, DV and ML run as the anatomical names say, along y, z and x */
    bool named = main_axis(world_from_voxel + 4 * axes[0]) == 1 && main_axis(world_from_voxel + 4 * axes[1]) == 2 &&
                 main_axis(world_from_voxel + 4 * axes[2]) == 0;
    if (!named && (axes[0] != 0 || axes[1] != 1)) {
        return false;
    }
    bool is_stack = strstr(info->format, "TIFF") || strstr(info->format, "Zarr");
    mat4_identity(own_from_ccf);
    for (size_t i = 0; i < 3; i++) {
        const double *step = world_from_voxel + 4 * axes[i];
        bool grows = i == 2; /* along the world's axis; AP and DV shrink */
        bool forward = !named || (i == 2 && is_stack) || (step[main_axis(step)] > 0) == grows;
        corner[axes[i]] = forward ? -0.5 : (double)info->dim[axes[i]] - 0.5;
        double voxels = (forward ? 1 : -1) * (double)info->dim[axes[i]] / frame_ccf_size[i]; /* a micrometre */
        vec3_scale(own_from_ccf + 4 * i, step, voxels);
    }
    mat4_point(own_from_ccf + 12, world_from_voxel, corner);
    return true;
}

conus_status frame_set_ccf(conus_atlas *atlas, bool from_right)
{
    const double um = micrometre;
    const double m[16] = {0, -um, 0, 0, 0, 0, -um, 0, from_right ? -um : um, 0, 0, 0, 0, 0, 0, 1};
    double found[16];
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    bool has_grid = info && find_in_grid(found, info, info->world_from_voxel);
    for (int i = 0; i < 16 && has_grid; i++) {
        if (fabs(found[i] - m[i]) > (i < 12 ? 1e-6 : 1e-3)) {
            return fail(
                CONUS_ERROR_DATA,
                "the volume's grid is the CCF's already, but its corner is not the world's origin, or ML starts "
                "at its other side");
        }
    }
    memcpy(atlas->own_from_ccf, m, sizeof m);
    atlas->has_ccf = true;
    return CONUS_OK;
}

/* From CCF to where the atlas's files have it. */
static bool find_own(double own_from_ccf[16], const conus_atlas *atlas)
{
    double own[16];
    const conus_volume_info *info = conus_atlas_volume(atlas, 0);
    if (atlas->has_ccf) {
        memcpy(own_from_ccf, atlas->own_from_ccf, sizeof atlas->own_from_ccf);
        return true;
    }
    if (!info || atlas->warp_count) {
        return false;
    }
    if (atlas->is_moved) {
        mat4_multiply(own, atlas->own_from_world, info->world_from_voxel);
    } else {
        memcpy(own, info->world_from_voxel, sizeof own);
    }
    return find_in_grid(own_from_ccf, info, own);
}

/* Whether x = 0 is within a voxel of an edge of the areas' grid, and so counted from a corner. */
static bool begins_at_corner(const conus_atlas *atlas)
{
    const struct volume *volume = atlas_parcellation(atlas);
    double low = INFINITY;
    double high = -INFINITY;
    double voxel = 0;
    for (int corner = 0; volume && corner < 8; corner++) {
        double at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = (corner >> a & 1) ? (double)volume->info.dim[a] - 0.5 : -0.5;
        }
        mat4_point(at, volume->info.world_from_voxel, at);
        conus_atlas_own_point(at, atlas, at);
        low = fmin(low, at[0]);
        high = fmax(high, at[0]);
    }
    for (int a = 0; volume && a < 3; a++) {
        voxel = fmax(voxel, volume->info.spacing[a]);
    }
    return volume && fmin(fabs(low), fabs(high)) <= voxel;
}

void frame_midline(struct midline *out, const conus_atlas *atlas)
{
    const double um = micrometre;
    const double side_from_ccf[16] = {0, um, 0, 0, 0, 0, um, 0, um, 0, 0, 0, -um * FRAME_CCF_MIDDLE, 0, 0, 1};
    double own_from_ccf[16];
    const bool is_mirrored = atlas->is_moved && mat4_determinant3(atlas->own_from_world) < 0; /* sides exchanged */
    *out = (struct midline){0};
    mat4_identity(out->side_from_own);
    out->side_from_own[0] = is_mirrored ? -1 : 1;
    if (find_own(own_from_ccf, atlas) && mat4_invert_affine(out->side_from_own, own_from_ccf)) {
        mat4_multiply(out->side_from_own, side_from_ccf, out->side_from_own);
        out->is_ccf = true;
        out->is_turned = (own_from_ccf[8] < 0) != is_mirrored;
    }
    out->is_unknown = !out->is_ccf && conus_atlas_brain(atlas).brain <= CONUS_BRAIN_OWN && begins_at_corner(atlas);
}

void frame_keep_ccf(conus_atlas *atlas)
{
    double own_from_ccf[16];
    if (find_own(own_from_ccf, atlas)) {
        memcpy(atlas->own_from_ccf, own_from_ccf, sizeof own_from_ccf);
        atlas->has_ccf = true;
    }
}

conus_brain_view conus_atlas_brain(const conus_atlas *atlas)
{
    conus_brain_view view = {.edition = "", .source = "", .words = "unknown"};
    double own_from_ccf[16];
    bool is_elsewhere = atlas->is_moved && !atlas->is_mirrored;
    if (atlas->brain) {
        view = space_brain_stated(atlas->brain);
    } else if (!is_elsewhere && find_own(own_from_ccf, atlas)) {
        view = (conus_brain_view){.brain = CONUS_BRAIN_TEMPLATE, .edition = "", .source = "CCF", .words = "Allen CCF"};
    } else if (atlas->volume_count && !is_elsewhere) {
        view = conus_volume_brain(&atlas->volumes[0].info);
        view = view.brain ? view : identity_brain(atlas->identified);
    }
    view.is_moved = is_elsewhere;
    return view;
}

static conus_status find_ccf(double world_from_ccf[16], const conus_atlas *atlas)
{
    double world_from_own[16];
    if (atlas && atlas->warp_count) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "%s: a deformation field moved it, so that positions in ccf or from bregma are on no straight axes",
                    atlas_path(atlas));
    }
    if (!atlas || !find_own(world_from_ccf, atlas)) {
        return fail(
            CONUS_ERROR_UNSUPPORTED,
            "%s: not known to be the Allen CCF, so that it has no positions in ccf or from bregma: neither is its "
            "grid 13.2 x 8 x 11.4 mm, nor does a manifest say \"ccf\" (docs/spaces.md)",
            atlas ? atlas_path(atlas) : "no atlas");
    }
    if (atlas->is_moved && mat4_invert_affine(world_from_own, atlas->own_from_world)) {
        mat4_multiply(world_from_ccf, world_from_own, world_from_ccf);
    }
    return CONUS_OK;
}

/* Bregma's AP, ML and DV in mm grow forward, to the right and upward; CCF's AP, DV and ML in micrometres backward,
 * downward and to the right. */
static conus_status find_bregma(double ccf_from_bregma[16], const double bregma[3])
{
    const double *b = bregma;
    for (int i = 0; i < 3; i++) {
        if (!(b[i] >= 0 && b[i] <= frame_ccf_size[i])) {
            return fail(CONUS_ERROR_ARGUMENT, "bregma: found %s %g um, allowed is 0 to %g in CCF",
                        spaces[CONUS_SPACE_CCF].axes[i], b[i], frame_ccf_size[i]);
        }
    }
    const double m[16] = {-1000, 0, 0, 0, 0, 0, 1000, 0, 0, -1000, 0, 0, b[0], b[1], b[2], 1};
    memcpy(ccf_from_bregma, m, sizeof m);
    return CONUS_OK;
}

/* A space of the CCF. */
static conus_status place_frame(conus_frame *frame, const conus_atlas *atlas, const double bregma[3])
{
    double ccf_from_bregma[16];
    memcpy(frame->bregma, bregma ? bregma : default_bregma, sizeof frame->bregma);
    conus_status status = find_bregma(ccf_from_bregma, frame->bregma);
    status = status ? status : find_ccf(frame->world_from_space, atlas);
    if (!status && frame->space == CONUS_SPACE_BREGMA) {
        mat4_multiply(frame->world_from_space, frame->world_from_space, ccf_from_bregma);
    }
    return status;
}

conus_status conus_frame_find(conus_frame *out, const conus_atlas *atlas, conus_space space, const double bregma[3])
{
    conus_frame frame = {.space = space};
    if ((size_t)space >= SPACES) {
        return fail(CONUS_ERROR_ARGUMENT, "space: %d is none", (int)space);
    }
    mat4_identity(frame.world_from_space);
    if (space == CONUS_SPACE_LPS) {
        frame.world_from_space[0] = frame.world_from_space[5] = -1;
    }
    conus_status status = space >= CONUS_SPACE_CCF ? place_frame(&frame, atlas, bregma) : CONUS_OK;
    *out = status ? *out : frame;
    return status;
}

conus_status frame_of_options(conus_frame *out, const conus_frame *given, conus_space space)
{
    if (!given) {
        return conus_frame_find(out, NULL, space, NULL);
    }
    if ((size_t)given->space >= SPACES) {
        return fail(CONUS_ERROR_ARGUMENT, "frame: its space is none");
    }
    *out = *given;
    return CONUS_OK;
}

/* LPS to RAS and back, which makes no "-0" of 0. */
static void flip(double out[3], const double in[3])
{
    out[0] = 0 - in[0];
    out[1] = 0 - in[1];
    out[2] = in[2];
}

conus_status conus_frame_to_world(double world[3], const conus_frame *frame, const double point[3])
{
    double most = fmax(fmax(fabs(point[0]), fabs(point[1])), fabs(point[2]));
    if (!vec3_is_finite(point)) {
        return fail(CONUS_ERROR_ARGUMENT, "position: %g,%g,%g, allowed are finite numbers", point[0], point[1],
                    point[2]);
    }
    if (frame->space == CONUS_SPACE_CCF && most < corner_um) {
        return fail(
            CONUS_ERROR_ARGUMENT,
            "position: %g,%g,%g um in CCF is the corner of its grid: positions there are in micrometres, not mm",
            point[0], point[1], point[2]);
    }
    if (frame->space == CONUS_SPACE_BREGMA && most > farthest_mm) {
        return fail(
            CONUS_ERROR_ARGUMENT,
            "position: %g,%g,%g mm from bregma is far from any mouse: positions there are in mm, not micrometres",
            point[0], point[1], point[2]);
    }
    if (frame->space == CONUS_SPACE_RAS) {
        memmove(world, point, 3 * sizeof *world);
    } else if (frame->space == CONUS_SPACE_LPS) {
        flip(world, point);
    } else {
        mat4_point(world, frame->world_from_space, point);
    }
    return CONUS_OK;
}

/* Maps a direction if `linear`, else a position. */
static void from_world(double out[3], const conus_frame *frame, const double world[3], bool linear)
{
    double space_from_world[16];
    if (frame->space == CONUS_SPACE_RAS) {
        memmove(out, world, 3 * sizeof *out);
    } else if (frame->space == CONUS_SPACE_LPS) {
        flip(out, world);
    } else if (!mat4_invert_affine(space_from_world, frame->world_from_space)) {
        out[0] = out[1] = out[2] = NAN; /* nothing that conus_frame_find() gives */
    } else if (linear) {
        mat4_direction(out, space_from_world, world);
    } else {
        mat4_point(out, space_from_world, world);
    }
}

void conus_frame_from_world(double point[3], const conus_frame *frame, const double world[3])
{
    from_world(point, frame, world, false);
}

void conus_frame_direction_to_world(double world[3], const conus_frame *frame, const double direction[3])
{
    if (frame->space == CONUS_SPACE_RAS) {
        memmove(world, direction, 3 * sizeof *world);
    } else if (frame->space == CONUS_SPACE_LPS) {
        flip(world, direction);
    } else {
        mat4_direction(world, frame->world_from_space, direction);
    }
}

void conus_frame_direction_from_world(double direction[3], const conus_frame *frame, const double world[3])
{
    from_world(direction, frame, world, true);
    if (frame->space >= CONUS_SPACE_CCF) {
        (void)vec3_normalise(direction, direction);
    }
}
