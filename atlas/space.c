/* SPDX-License-Identifier: BSD-3-Clause */
/* Describes a voxel grid: axes, codes, size of a voxel. */
#include "atlas/space.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "conus/own.h"

#include <stdio.h>
#include <string.h>

/* The most aligned pair (voxel axis, world axis) of those that are both still free. */
static void find_closest_pair(int *voxel, int *world, const double m[16], const bool voxel_done[3],
                              const bool world_done[3])
{
    double best = -1;
    for (int pair = 0; pair < 9; pair++) {
        int v = pair / 3;
        int w = pair % 3;
        double cosine = fabs(m[4 * v + w]) / vec3_length(m + 4 * v);
        if (!voxel_done[v] && !world_done[w] && cosine > best) {
            best = cosine;
            *voxel = v;
            *world = w;
        }
    }
}

/* The axes get distinct letters, as in nibabel's io_orientation for matrices without shear. */
static void name_axes(char orientation[4], const double m[16])
{
    static const char letters[2][4] = {"LPI", "RAS"};
    bool voxel_done[3] = {false};
    bool world_done[3] = {false};
    for (int pass = 0; pass < 3; pass++) {
        int v = 0;
        int w = 0;
        find_closest_pair(&v, &w, m, voxel_done, world_done);
        voxel_done[v] = world_done[w] = true;
        orientation[v] = letters[m[4 * v + w] > 0][w];
    }
    orientation[3] = '\0';
}

conus_status space_invert(double out[16], const double m[16], const char *words)
{
    double inverse[16];
    double edges = 1;
    if (!mat4_is_affine(m)) {
        return fail(CONUS_ERROR_DATA, "%s: the matrix has the last row %g %g %g %g, 0 0 0 1 is needed", words, m[3],
                    m[7], m[11], m[15]);
    }
    for (int axis = 0; axis < 3; axis++) {
        double step = hypot(hypot(m[4 * axis], m[4 * axis + 1]), m[4 * axis + 2]); /* squares may be 0, or infinite */
        edges *= step;
        if (step > 0 && !(step >= SPACE_LEAST_STEP && step <= SPACE_MOST_STEP)) {
            return fail(CONUS_ERROR_DATA, "%s: a step along axis %d is %g mm long, allowed are %g to %g", words, axis,
                        step, SPACE_LEAST_STEP, SPACE_MOST_STEP);
        }
    }
    if (!mat4_invert_affine(inverse, m) || !(fabs(mat4_determinant3(m)) >= SPACE_FLATTEST * edges)) {
        return fail(CONUS_ERROR_DATA, "%s: the matrix is singular or not finite, an invertible one is needed", words);
    }
    if (!(vec3_length(m + 12) <= SPACE_FARTHEST && vec3_length(inverse + 12) <= SPACE_FARTHEST_STEPS)) {
        return fail(CONUS_ERROR_DATA, "%s: it begins %g mm, %g steps, from the origin, allowed are up to %g mm, %g",
                    words, vec3_length(m + 12), vec3_length(inverse + 12), SPACE_FARTHEST, SPACE_FARTHEST_STEPS);
    }
    memcpy(out, inverse, sizeof inverse);
    return CONUS_OK;
}

conus_status space_describe(conus_volume_info *info, const double world_from_voxel[16], const char *transform)
{
    double inverse[16];
    conus_status status = space_invert(inverse, world_from_voxel, transform);
    if (status) {
        return status;
    }
    double reach = space_corner_distance(info->dim, world_from_voxel, (const double[16]){0});
    if (!(reach <= SPACE_FARTHEST)) {
        return fail(CONUS_ERROR_DATA, "%s: a corner of the grid is %g mm from the origin, allowed are up to %g",
                    transform, reach, SPACE_FARTHEST);
    }
    memcpy(info->world_from_voxel, world_from_voxel, sizeof info->world_from_voxel);
    snprintf(info->transform, sizeof info->transform, "%s", transform);
    for (int axis = 0; axis < 3; axis++) {
        info->spacing[axis] = vec3_length(world_from_voxel + 4 * axis);
    }
    name_axes(info->orientation, world_from_voxel);
    return CONUS_OK;
}

bool space_same_grid(const conus_volume_info *a, const conus_volume_info *b)
{
    static const double nothing[16];
    return memcmp(a->dim, b->dim, sizeof a->dim) == 0 &&
           space_corner_distance(a->dim, a->world_from_voxel, b->world_from_voxel) <=
               TOLERANCE * space_corner_distance(a->dim, a->world_from_voxel, nothing);
}

double space_voxel_mm3(const conus_volume_info *info)
{
    return fabs(mat4_determinant3(info->world_from_voxel));
}

bool space_is_guess(const conus_volume_info *info)
{
    bool same = true;
    for (int i = 0; i < 3; i++) {
        double step = i == 0 ? -info->spacing[i] : info->spacing[i];
        double guess[4] = {0};
        guess[i] = step;
        guess[3] = -step * ((double)info->dim[i] - 1) / 2;
        for (int column = 0; column < 4; column++) {
            double found = info->world_from_voxel[4 * column + i];
            same = same && fabs(found - guess[column]) <= 2 * TOLERANCE * info->spacing[i];
        }
    }
    return same;
}

const char *space_code_name(int code)
{
    static const char *const names[] = {"unknown",   "scanner", "aligned to another",
                                        "Talairach", "MNI 152", "other template"};
    return code >= 0 && code < (int)(sizeof names / sizeof names[0]) ? names[code] : "unknown";
}

static const char *const brain_words[] = {"unknown", "one person's own", "MNI 152",         "Colin 27",
                                          "MNI 305", "Talairach",        "another template"};

/* The editions of MNI 152 that differ by millimetres. Linear and NLin6 lie on the same grids. */
static const char newest[] = "NLin2009";
static const char earlier[] = "earlier";

/* Grids on which a template is published, by voxels along x, y and z, mm, and the lowest voxel centre; docs/spaces.md
 * says against what each was checked. What a person's own scan is resampled to (256^3 of FreeSurfer) is none. */
static const struct {
    uint16_t dim[3];
    double spacing, low[3];
    conus_brain brain;
    const char *edition;
} template_grids[] = {
    {{182, 218, 182}, 1, {-91, -126, -72}, CONUS_BRAIN_MNI152, earlier}, /* FSL, TemplateFlow's NLin6Asym */
    {{91, 109, 91}, 2, {-90, -126, -72}, CONUS_BRAIN_MNI152, earlier},   /* and the average that SPM and FSL have */
    {{364, 436, 364}, 0.5, {-91.5, -126, -72}, CONUS_BRAIN_MNI152, earlier},
    {{260, 311, 260}, 0.7, {-91.3, -126, -72}, CONUS_BRAIN_MNI152, earlier},
    {{227, 272, 227}, 0.8, {-90.8, -126, -72}, CONUS_BRAIN_MNI152, earlier},
    {{113, 136, 113}, 1.6, {-89.2, -126, -72}, CONUS_BRAIN_MNI152, earlier},
    {{91, 109, 91}, 2, {-90.5, -126.5, -72.5}, CONUS_BRAIN_MNI152, earlier}, /* TemplateFlow's Lin */
    {{181, 217, 181}, 1, {-90, -126, -72}, CONUS_BRAIN_MNI152, ""},          /* the MNI's Lin, and its Colin 27 */
    {{121, 145, 121}, 1.5, {-90, -126, -72}, CONUS_BRAIN_MNI152, ""},        /* SPM 12 */
    {{157, 189, 156}, 1, {-78, -112, -70}, CONUS_BRAIN_MNI152, ""},          /* the box to which SPM 12 normalises */
    {{79, 95, 79}, 2, {-78, -112, -70}, CONUS_BRAIN_MNI152, ""},
    {{157, 189, 136}, 1, {-78, -112, -50}, CONUS_BRAIN_MNI152, ""}, /* and earlier ones */
    {{79, 95, 69}, 2, {-78, -112, -50}, CONUS_BRAIN_MNI152, ""},
    {{79, 95, 68}, 2, {-78, -112, -50}, CONUS_BRAIN_MNI152, ""},
    {{193, 229, 193}, 1, {-96, -132, -78}, CONUS_BRAIN_MNI152, newest}, /* 2009c, TemplateFlow's, too */
    {{97, 115, 97}, 2, {-96.5, -132.5, -78.5}, CONUS_BRAIN_MNI152, newest},
    {{197, 233, 189}, 1, {-98, -134, -72}, CONUS_BRAIN_MNI152, newest}, /* 2009a, nilearn's, too */
    {{99, 117, 95}, 2, {-98, -134, -72}, CONUS_BRAIN_MNI152, newest},
    {{394, 466, 378}, 0.5, {-98, -134, -72}, CONUS_BRAIN_MNI152, newest}, /* 2009b */
    {{157, 197, 165}, 1, {-78, -115, -78}, CONUS_BRAIN_MNI152, newest},   /* Julich-Brain 3.1, cropped */
    {{181, 217, 181}, 1, {-90, -125, -71}, CONUS_BRAIN_COLIN27, ""},      /* MRIcron's ch2, and AAL on it */
    {{301, 370, 316}, 0.5, {-75, -107, -69.5}, CONUS_BRAIN_COLIN27, ""},  /* its ch2better */
};

/* Whether the axes of the grid are the world's, in any order and direction, with these voxels. */
static bool is_template_grid(const conus_volume_info *info, size_t which)
{
    const double *m = info->world_from_voxel;
    double spacing = template_grids[which].spacing;
    bool same = true;
    for (int world = 0; world < 3 && same; world++) {
        int voxel = 0;
        while (voxel < 2 && fabs(m[4 * voxel + world]) < spacing / 2) {
            voxel++;
        }
        double step = m[4 * voxel + world];
        double reach = step * ((double)info->dim[voxel] - 1);
        double low = m[12 + world] + (step < 0 ? reach : 0);
        same = info->dim[voxel] == template_grids[which].dim[world] && fabs(fabs(step) - spacing) < 0.001 * spacing &&
               fabs(low - template_grids[which].low[world]) < 0.01;
        for (int other = 0; other < 3; other++) {
            same = same && (other == voxel || fabs(m[4 * other + world]) < 0.001 * spacing);
        }
    }
    return same;
}

conus_brain_view space_brain_stated(conus_brain brain)
{
    return (conus_brain_view){.brain = brain, .edition = "", .source = "stated", .words = brain_words[brain]};
}

conus_brain_view conus_volume_brain(const conus_volume_info *info)
{
    static const conus_brain of_code[] = {[SPACE_TALAIRACH] = CONUS_BRAIN_TALAIRACH,
                                          [SPACE_MNI] = CONUS_BRAIN_MNI152,
                                          [SPACE_TEMPLATE] = CONUS_BRAIN_TEMPLATE};
    conus_brain_view view = {.edition = "", .source = "header"};
    bool has_code = info->space_code >= SPACE_TALAIRACH && info->space_code <= SPACE_TEMPLATE;
    view.brain = has_code ? of_code[info->space_code] : CONUS_BRAIN_UNKNOWN;
    size_t count = sizeof template_grids / sizeof template_grids[0];
    for (size_t i = 0; i < count && (view.brain == CONUS_BRAIN_UNKNOWN || view.brain == CONUS_BRAIN_MNI152); i++) {
        if (is_template_grid(info, i)) {
            view.brain = template_grids[i].brain;
            view.edition = template_grids[i].edition;
            view.source = has_code && view.brain == CONUS_BRAIN_MNI152 ? "header" : "grid";
            break;
        }
    }
    view.source = view.brain ? view.source : "";
    view.words = view.edition == newest    ? "MNI 152, NLin2009"
                 : view.edition == earlier ? "MNI 152, earlier than NLin2009"
                                           : brain_words[view.brain];
    return view;
}

static bool is_of_mni(conus_brain brain)
{
    return brain == CONUS_BRAIN_MNI152 || brain == CONUS_BRAIN_COLIN27 || brain == CONUS_BRAIN_MNI305;
}

static bool is_of_mouse(const conus_brain_view *view)
{
    return view->brain == CONUS_BRAIN_TEMPLATE && strcmp(view->source, "CCF") == 0;
}

/* The only templates that are known by their voxels are of animals. */
static bool is_of_animal(const conus_brain_view *view)
{
    return is_of_mouse(view) || (view->brain == CONUS_BRAIN_TEMPLATE && strcmp(view->source, "voxels") == 0);
}

conus_brain_gap conus_brain_compare(conus_brain_view a, conus_brain_view b)
{
    if (!a.brain || !b.brain) {
        return CONUS_BRAIN_GAP_NONE;
    }
    if (a.brain == CONUS_BRAIN_MNI152 && b.brain == CONUS_BRAIN_MNI152) {
        return a.edition[0] && b.edition[0] && strcmp(a.edition, b.edition) != 0 ? CONUS_BRAIN_GAP_SOME_MM
                                                                                 : CONUS_BRAIN_GAP_NONE;
    }
    if (a.brain == b.brain && a.brain != CONUS_BRAIN_TEMPLATE) {
        return CONUS_BRAIN_GAP_NONE;
    }
    if (is_of_mni(a.brain) && is_of_mni(b.brain)) {
        bool has_305 = a.brain == CONUS_BRAIN_MNI305 || b.brain == CONUS_BRAIN_MNI305;
        return has_305 ? CONUS_BRAIN_GAP_SOME_MM : CONUS_BRAIN_GAP_SMALL;
    }
    if (is_of_mouse(&a) != is_of_mouse(&b) || a.brain == CONUS_BRAIN_OWN || b.brain == CONUS_BRAIN_OWN) {
        return CONUS_BRAIN_GAP_OTHER;
    }
    bool is_named = !a.source[0] || !b.source[0]; /* no atlas, but a space that positions name: of people */
    if ((a.brain != b.brain || is_named) && (is_of_animal(&a) || is_of_animal(&b))) {
        return CONUS_BRAIN_GAP_OTHER;
    }
    if (is_of_animal(&a) && is_of_animal(&b)) { /* "the macaque INIA19" */
        return is_of_mouse(&a) || strcmp(a.words, b.words) == 0 ? CONUS_BRAIN_GAP_NONE : CONUS_BRAIN_GAP_OTHER;
    }
    bool has_template = a.brain == CONUS_BRAIN_TEMPLATE || b.brain == CONUS_BRAIN_TEMPLATE;
    return has_template ? CONUS_BRAIN_GAP_SOME_MM : CONUS_BRAIN_GAP_OTHER;
}

const char *space_brain_word(conus_brain stated)
{
    static const char *const words[] = {[CONUS_BRAIN_OWN] = "none",
                                        [CONUS_BRAIN_MNI152] = "mni152",
                                        [CONUS_BRAIN_COLIN27] = "colin27",
                                        [CONUS_BRAIN_MNI305] = "mni305"};
    return stated < sizeof words / sizeof words[0] ? words[stated] : NULL;
}

conus_brain space_brain_parse(struct text word)
{
    conus_brain brain = CONUS_BRAIN_MNI305;
    while (brain && !text_equal(word, space_brain_word(brain))) {
        brain--;
    }
    return brain;
}

conus_grid_view space_grid(const conus_volume_info *info)
{
    conus_grid_view view = {.count = info->dim[0] * info->dim[1] * info->dim[2]};
    memcpy(view.dim, info->dim, sizeof view.dim);
    memcpy(view.world_from_voxel, info->world_from_voxel, sizeof view.world_from_voxel);
    view.space_code = info->space_code || space_is_guess(info) ? info->space_code : SPACE_ALIGNED;
    return view;
}

conus_status grid_create(conus_grid **out, const conus_volume_info *info, conus_number number, const char *description)
{
    static const size_t sizes[] = {
        [CONUS_NUMBER_UINT8] = 1, [CONUS_NUMBER_UINT16] = 2, [CONUS_NUMBER_UINT32] = 4, [CONUS_NUMBER_FLOAT32] = 4};
    conus_grid *grid = memory_zeroed(1, sizeof *grid);
    if (!grid) {
        return CONUS_ERROR_MEMORY;
    }
    conus_grid_view *view = &grid->view;
    *view = space_grid(info);
    view->number = number;
    view->description = memory_text(description, strlen(description));
    grid->size = sizes[number];
    view->data = grid->data = memory_zeroed(view->count, grid->size);
    conus_status status = view->description && grid->data ? CONUS_OK : CONUS_ERROR_MEMORY;
    return GIVE(status, out, grid, conus_grid_destroy(grid));
}

conus_grid_view conus_grid_data(const conus_grid *grid)
{
    return grid ? grid->view : (conus_grid_view){.description = ""};
}

void conus_grid_destroy(conus_grid *grid)
{
    if (grid) {
        memory_free((void *)grid->view.description);
        memory_free(grid->data);
        memory_free(grid);
    }
}

double space_corner_distance(const size_t dim[3], const double a[16], const double b[16])
{
    double largest = 0;
    for (int corner = 0; corner < 8; corner++) {
        double voxel[3];
        double at[2][3];
        for (int i = 0; i < 3; i++) {
            voxel[i] = corner >> i & 1 ? (double)dim[i] - 0.5 : -0.5;
        }
        mat4_point(at[0], a, voxel);
        mat4_point(at[1], b, voxel);
        vec3_sub(at[0], at[0], at[1]);
        largest = fmax(largest, vec3_length(at[0]));
    }
    return largest;
}

struct box3 space_grid_box(const conus_volume_info *info)
{
    const size_t *dim = info->dim;
    const struct box3 cells = {{-0.5, -0.5, -0.5}, {(double)dim[0] - 0.5, (double)dim[1] - 0.5, (double)dim[2] - 0.5}};
    return box3_image(&cells, info->world_from_voxel);
}
