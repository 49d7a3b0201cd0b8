/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the cells of a shape by cuts through the atlas, first coarsely where it is, then finely. */
#include "base/geometry/math3.h"
#include "conus/own.h"
#include "viewer/pictures/pictures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 64 /* cells along the longest side */, SMALL_ONES = 8 /* that are looked for by their middles */ };

static const double near_mm = 0.1; /* what is not so far before the eye casts no shadow */
static const double overlap = 1.5; /* cells are drawn so many times as large: seen over edges and corners they lie
                                       up to the root of 2 of an edge apart */

/* Cells of a box, and which are inside the shape. */
struct lattice {
    double low[3], edge;
    uint32_t dim[3];
    uint8_t *inside; /* [dim[2]][dim[1]][dim[0]] */
};

/* The objects to find in an atlas. */
struct search {
    const conus_atlas *atlas;
    const bool *wanted; /* [objects + 1] */
    bool *seen;         /* likewise: those that were found */
    conus_cutter *cutter;
};

static bool is_inside(const struct lattice *lattice, long i, long j, long k)
{
    const uint32_t *n = lattice->dim;
    bool within = i >= 0 && j >= 0 && k >= 0 && i < (long)n[0] && j < (long)n[1] && k < (long)n[2];
    return within && lattice->inside[((size_t)k * n[1] + (size_t)j) * n[0] + (size_t)i];
}

/* Samples one plane across z. */
static conus_status sample_plane(struct lattice *lattice, uint32_t k, struct search *search)
{
    const uint32_t *n = lattice->dim;
    const conus_cut_view view = {.centre = {lattice->low[0] + lattice->edge * n[0] / 2,
                                            lattice->low[1] + lattice->edge * n[1] / 2,
                                            lattice->low[2] + lattice->edge * (k + 0.5)},
                                 .mm_per_pixel = lattice->edge,
                                 .width = n[0],
                                 .height = n[1],
                                 .no_outlines = true,
                                 .window = {0, 1}};
    conus_status status = conus_cutter_draw(search->cutter, &view);
    const uint32_t *objects = status ? NULL : conus_cutter_objects(search->cutter);
    for (uint32_t j = 0; objects && j < n[1]; j++) { /* the top row is the last along y */
        for (uint32_t i = 0; i < n[0]; i++) {
            uint32_t object = objects[(size_t)(n[1] - 1 - j) * n[0] + i];
            lattice->inside[((size_t)k * n[1] + j) * n[0] + i] = search->wanted[object];
            search->seen[object] = true;
        }
    }
    return status;
}

static conus_status sample(struct lattice *out, const struct box3 *box, struct search *search)
{
    const double *low = box->low;
    const double *high = box->high;
    struct lattice lattice = {.low = {low[0], low[1], low[2]}};
    double longest = fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
    lattice.edge = fmax(longest, 1e-6) / MOST; /* a point has a size, too */
    for (int a = 0; a < 3; a++) {
        double cells = fmin(fmax(ceil((high[a] - low[a]) / lattice.edge), 1), MOST);
        lattice.dim[a] = (uint32_t)cells;
    }
    lattice.inside = calloc((size_t)lattice.dim[0] * lattice.dim[1], lattice.dim[2]);
    conus_status status = lattice.inside ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (uint32_t k = 0; k < lattice.dim[2] && !status; k++) {
        status = sample_plane(&lattice, k, search);
    }
    if (status) {
        free(lattice.inside);
    } else {
        *out = lattice;
    }
    return status;
}

/* The box of what is inside, and a cell around it; empty where nothing is. */
static struct box3 find_box(const struct lattice *lattice)
{
    const uint32_t *n = lattice->dim;
    long least[3] = {MOST, MOST, MOST};
    long most[3] = {-1, -1, -1};
    struct box3 box = box3_empty();
    for (size_t cell = 0; cell < (size_t)n[0] * n[1] * n[2]; cell++) {
        const long at[3] = {(long)(cell % n[0]), (long)(cell / n[0] % n[1]), (long)(cell / n[0] / n[1])};
        for (int a = 0; a < 3 && lattice->inside[cell]; a++) {
            least[a] = at[a] < least[a] ? at[a] : least[a];
            most[a] = at[a] > most[a] ? at[a] : most[a];
        }
    }
    for (int a = 0; a < 3 && most[0] >= 0; a++) {
        box.low[a] = lattice->low[a] + lattice->edge * (double)(least[a] - 1);
        box.high[a] = lattice->low[a] + lattice->edge * (double)(most[a] + 2);
    }
    return box;
}

/* Objects that lie between the cells of the first look have their middles at least; what many of them are, whose
 * middles take long to find, is large. */
static void add_middles(struct box3 *box, double around, const struct search *search)
{
    size_t count = conus_atlas_object_count(search->atlas);
    unsigned small = 0;
    for (size_t number = 1; number <= count && small < SMALL_ONES; number++) {
        bool missed = search->wanted[number] && !search->seen[number] && !conus_atlas_is_hidden(search->atlas, number);
        double middle[3];
        small += missed;
        if (missed && !conus_atlas_centre(middle, search->atlas, number)) {
            for (int a = 0; a < 3; a++) {
                box->low[a] = fmin(box->low[a], middle[a] - around);
                box->high[a] = fmax(box->high[a], middle[a] + around);
            }
        }
    }
}

static bool is_at_surface(const struct lattice *lattice, long i, long j, long k)
{
    return is_inside(lattice, i, j, k) &&
           !(is_inside(lattice, i - 1, j, k) && is_inside(lattice, i + 1, j, k) && is_inside(lattice, i, j - 1, k) &&
             is_inside(lattice, i, j + 1, k) && is_inside(lattice, i, j, k - 1) && is_inside(lattice, i, j, k + 1));
}

static conus_status take_surface(struct cells *out, const struct lattice *lattice)
{
    const uint32_t *n = lattice->dim;
    size_t all = (size_t)n[0] * n[1] * n[2];
    struct cells cells = {.middles = malloc(all * sizeof *cells.middles), .edge = lattice->edge};
    for (size_t cell = 0; cells.middles && cell < all; cell++) {
        const long at[3] = {(long)(cell % n[0]), (long)(cell / n[0] % n[1]), (long)(cell / n[0] / n[1])};
        if (is_at_surface(lattice, at[0], at[1], at[2])) {
            double *middle = cells.middles[cells.count++];
            for (int a = 0; a < 3; a++) {
                middle[a] = lattice->low[a] + lattice->edge * ((double)at[a] + 0.5);
            }
        }
    }
    *out = cells.middles ? cells : *out;
    return cells.middles ? CONUS_OK : CONUS_ERROR_MEMORY;
}

/* Finds the box of the objects by a coarse look at the whole atlas, empty where there is none. */
static conus_status find_objects(struct box3 *out, struct search *search)
{
    struct box3 all;
    struct lattice lattice = {.inside = NULL};
    bool any = !conus_atlas_bounds(all.low, all.high, search->atlas); /* else all is hidden */
    conus_status status = any ? sample(&lattice, &all, search) : CONUS_OK;
    *out = any && !status ? find_box(&lattice) : box3_empty();
    if (any && !status) {
        add_middles(out, lattice.edge, search);
        free(lattice.inside);
    }
    return status;
}

conus_status cells_find(struct cells *out, const conus_atlas *atlas, const bool *wanted)
{
    struct box3 box;
    struct lattice lattice = {.inside = NULL};
    struct search search = {atlas, wanted, calloc(conus_atlas_object_count(atlas) + 1, sizeof *search.seen), NULL};
    *out = (struct cells){.middles = NULL};
    conus_status status = search.seen ? conus_cutter_create(&search.cutter, atlas) : CONUS_ERROR_MEMORY;
    status = status ? status : find_objects(&box, &search);
    if (!status && box.low[0] < box.high[0]) {
        status = sample(&lattice, &box, &search);
        status = status ? status : take_surface(out, &lattice);
    }
    free(lattice.inside);
    free(search.seen);
    conus_cutter_destroy(search.cutter);
    return status;
}

void cells_finish(struct cells *cells)
{
    free(cells->middles);
    *cells = (struct cells){.middles = NULL};
}

static uint32_t clamped(double pixel, uint32_t size)
{
    return (uint32_t)fmin(fmax(pixel, 0), size);
}

double cells_cast(float *nearest, uint32_t width, uint32_t height, const struct cells *cells, const struct eye *eye)
{
    double smallest = INFINITY;
    const double *m = eye->camera.world_from_device;
    const double size[2] = {width, height};
    double pixels = height / (eye->frustum[3] - eye->frustum[2]); /* of 1 mm at depth 1 mm */
    for (size_t c = 0; c < cells->count; c++) {
        const double *p = cells->middles[c];
        double offset[3];
        double at[2];
        vec3_sub(offset, p, m + 12);
        const double depth = -vec3_dot(offset, m + 8);
        const double away = vec3_length(offset);
        if (depth < near_mm || !eye_project(at, eye, size, p)) {
            continue;
        }
        double half =
            overlap * cells->edge / 2 * pixels / depth * (away / depth); /* off the middle it is seen larger */
        smallest = fmin(smallest, 2 * half);
        uint32_t left = clamped(floor(at[0] - half + 0.5), width);
        uint32_t right = clamped(floor(at[0] + half + 0.5), width);
        uint32_t bottom = clamped(floor(at[1] + half + 0.5), height);
        for (uint32_t y = clamped(floor(at[1] - half + 0.5), height); y < bottom; y++) {
            for (uint32_t x = left; x < right; x++) {
                float *pixel = nearest + (size_t)y * width + x;
                *pixel = fminf(*pixel, (float)away);
            }
        }
    }
    return isfinite(smallest) ? smallest : 0;
}
