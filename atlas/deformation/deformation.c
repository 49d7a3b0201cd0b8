/* SPDX-License-Identifier: BSD-3-Clause */
/* Where a deformation field takes points, the way back, and what a careful user should know of it. */
#include "atlas/deformation/deformation.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

/* Within this distance of a node, in steps of the grid, only the node counts: its neighbours may be NaN. */
#define ON_NODE 1e-9

/* The eight nodes around a point. */
struct cell {
    const struct deformation *field;
    size_t corner[8]; /* where their vectors begin; bit 0: the second along i; bit 1: along j; bit 2: along k */
    double part[3];
    bool flat[3]; /* at the border, where the value does not change */
};

static void find_cell(struct cell *out, const struct deformation *field, const double q[3])
{
    size_t low[3];
    size_t high[3];
    for (int a = 0; a < 3; a++) {
        double most = (double)(field->dim[a] - 1);
        double x = fmin(fmax(q[a], 0), most);
        double cell = fmin(floor(x), most - 1);
        out->flat[a] = q[a] < 0 || q[a] > most;
        out->part[a] = x - cell;
        low[a] = (size_t)cell + (out->part[a] > 1 - ON_NODE);
        high[a] = (size_t)cell + (out->part[a] >= ON_NODE);
    }
    for (int c = 0; c < 8; c++) {
        size_t i = c & 1 ? high[0] : low[0];
        size_t j = c & 2 ? high[1] : low[1];
        size_t k = c & 4 ? high[2] : low[2];
        out->corner[c] = 3 * (i + field->dim[0] * (j + field->dim[1] * k));
    }
    out->field = field;
}

/* The number at this place among the vectors. */
static double number_at(const struct deformation *field, size_t place)
{
    double number = (double)field->vectors[place];
    return field->rest ? number + (double)field->rest[place] : number;
}

/* Component n of the vector at a corner. */
static double corner_of(const struct cell *cell, int corner, int n)
{
    return number_at(cell->field, cell->corner[corner] + (size_t)n);
}

static double between(double a, double b, double part)
{
    return a + part * (b - a);
}

/* Component n of the vector in the cell. */
static double value_in(const struct cell *cell, int n)
{
    double along[4];
    for (int c = 0; c < 4; c++) {
        along[c] = between(corner_of(cell, 2 * c, n), corner_of(cell, 2 * c + 1, n), cell->part[0]);
    }
    return between(between(along[0], along[1], cell->part[1]), between(along[2], along[3], cell->part[1]),
                   cell->part[2]);
}

/* How component n changes along an axis: the mean of the four edges by their nearness. */
static double slope_in(const struct cell *cell, int n, int axis)
{
    static const int bits[3] = {1, 2, 4};
    int u = (axis + 1) % 3;
    int v = (axis + 2) % 3;
    double edges[4];
    for (int e = 0; e < 4; e++) {
        int c = (e & 1 ? bits[u] : 0) + (e & 2 ? bits[v] : 0);
        edges[e] = corner_of(cell, c + bits[axis], n) - corner_of(cell, c, n);
    }
    return between(between(edges[0], edges[1], cell->part[u]), between(edges[2], edges[3], cell->part[u]),
                   cell->part[v]);
}

static void place_vector(double out[3], const struct deformation *field, const double q[3], const double vector[3])
{
    double base[3];
    mat4_point(base, field->base, q);
    mat4_direction(out, field->linear, vector);
    vec3_add_scaled(out, base, 1, out);
}

/* The 64 nodes around a point. */
struct knots {
    size_t first[3];
    double weight[3][4]; /* along i, j, k */
    double slope[3][4];
};

/* Cubic B-splines, C. de Boor, A Practical Guide to Splines, chapter IX, for whole numbers as knots; as
 * itk::BSplineInterpolationWeightFunction has them. */
static void find_knots(struct knots *out, const struct deformation *field, const double q[3])
{
    for (int a = 0; a < 3; a++) {
        double last = (double)(field->dim[a] - 2);
        double x = fmin(fmax(q[a], 1), last);
        double first = fmin(floor(x), last - 1) - 1;
        double t = x - first - 1;
        double u = 1 - t;
        const double weight[4] = {u * u * u / 6, (4 + t * t * (3 * t - 6)) / 6, (4 + u * u * (3 * u - 6)) / 6,
                                  t * t * t / 6};
        const double slope[4] = {-u * u / 2, t * (3 * t - 4) / 2, u * (4 - 3 * u) / 2, t * t / 2};
        out->first[a] = (size_t)first;
        memcpy(out->weight[a], weight, sizeof weight);
        memcpy(out->slope[a], slope, sizeof slope);
    }
}

/* The vector, or how it changes along `axis`; -1 = the vector. */
static void spline_vector(double out[3], const struct deformation *field, const struct knots *knots, int axis)
{
    const size_t *dim = field->dim;
    const double *along[3];
    for (int a = 0; a < 3; a++) {
        along[a] = a == axis ? knots->slope[a] : knots->weight[a];
    }
    for (size_t n = 0; n < 3; n++) {
        out[n] = 0;
        for (size_t jk = 0; jk < 16; jk++) {
            size_t row = knots->first[1] + jk % 4 + dim[1] * (knots->first[2] + jk / 4 + dim[2] * n);
            const double *c = field->coefficients + knots->first[0] + dim[0] * row;
            double sum = c[0] * along[0][0] + c[1] * along[0][1] + c[2] * along[0][2] + c[3] * along[0][3];
            out[n] += sum * along[1][jk % 4] * along[2][jk / 4];
        }
    }
}

void deformation_at(double out[3], const struct deformation *field, const double q[3])
{
    double vector[3];
    if (field->coefficients) {
        struct knots knots;
        find_knots(&knots, field, q);
        spline_vector(vector, field, &knots, -1);
    } else {
        struct cell cell;
        find_cell(&cell, field, q);
        for (int n = 0; n < 3; n++) {
            vector[n] = value_in(&cell, n);
        }
    }
    place_vector(out, field, q, vector);
}

void deformation_slope(double out[3], double columns[3][3], const struct deformation *field, const double q[3])
{
    struct cell cell = {0};
    struct knots knots;
    if (field->coefficients) {
        find_knots(&knots, field, q);
    } else {
        find_cell(&cell, field, q);
    }
    for (int axis = 0; axis < 3; axis++) {
        double change[3] = {0};
        if (field->coefficients) {
            spline_vector(change, field, &knots, axis);
        }
        for (int n = 0; !field->coefficients && !cell.flat[axis] && n < 3; n++) {
            change[n] = slope_in(&cell, n, axis);
        }
        mat4_direction(change, field->linear, change);
        vec3_add_scaled(columns[axis], field->base + (ptrdiff_t)4 * axis, 1, change);
    }
    deformation_at(out, field, q);
}

/* Where the grid begins and ends along an axis. */
static double first_index(const struct deformation *field)
{
    return field->coefficients ? 1 : -0.5;
}

static double last_index(const struct deformation *field, int axis)
{
    return (double)field->dim[axis] - (field->coefficients ? 2 : 0.5);
}

bool deformation_holds(const struct deformation *field, const double q[3])
{
    for (int a = 0; a < 3; a++) {
        double last = last_index(field, a);
        if (!(q[a] >= first_index(field) && (q[a] < last || (field->coefficients && q[a] == last)))) {
            return false;
        }
    }
    return true;
}

/* Where no vector is, points stay, unless an affine is a part of the field. */
static bool has_affine(const struct deformation *field)
{
    return !mat4_is_same(field->base, field->world_from_voxel);
}

bool deformation_point(double out[3], const struct deformation *field, const double p[3])
{
    double q[3];
    mat4_point(q, field->voxel_from_world, p);
    if (deformation_holds(field, q)) {
        deformation_at(out, field, q);
    } else if (field->stays_outside && has_affine(field)) {
        mat4_point(out, field->base, q);
    } else if (field->stays_outside) {
        memmove(out, p, 3 * sizeof *out);
    } else {
        out[0] = out[1] = out[2] = NAN;
    }
    return vec3_is_finite(out);
}

bool warps_point(double out[3], const struct warp *warps, size_t count, const double p[3])
{
    bool goes = true;
    memmove(out, p, 3 * sizeof *out);
    for (size_t i = count; i-- > 0 && goes;) {
        goes = deformation_point(out, &warps[i].field, out);
        mat4_point(out, warps[i].after, out);
    }
    return goes;
}

void deformation_finish(struct deformation *field)
{
    if (!field->is_borrowed) {
        memory_free(field->vectors);
        memory_free(field->coefficients);
        memory_free(field->rest);
    }
    *field = (struct deformation){0};
}

void deformation_fold(struct deformation *field, const double before[16], const double after[16])
{
    double world[16];
    if (mat4_invert_affine(world, before)) { /* the caller has tried */
        mat4_multiply(field->world_from_voxel, world, field->world_from_voxel);
        mat4_multiply(field->voxel_from_world, field->voxel_from_world, before);
    }
    mat4_multiply(field->base, after, field->base);
    for (int column = 0; column < 3; column++) {
        mat4_direction(field->linear + (ptrdiff_t)4 * column, after, field->linear + (ptrdiff_t)4 * column);
    }
}

/* Places where a field is looked at: its nodes, or every half step between the ends of a grid of splines. */
struct lattice {
    size_t dim[3];
    double first, step;
};

static struct lattice lattice_of(const struct deformation *field)
{
    struct lattice lattice = {.step = 1};
    memcpy(lattice.dim, field->dim, sizeof lattice.dim);
    for (int a = 0; field->coefficients && a < 3; a++) {
        lattice.first = first_index(field);
        lattice.step = 0.5;
        lattice.dim[a] = 2 * (field->dim[a] - 3) + 1;
    }
    return lattice;
}

/* Where a place of the lattice goes; *q is where it is. */
static void find_image(double out[3], double q[3], const struct deformation *field, const struct lattice *lattice,
                       const size_t place[3])
{
    for (int a = 0; a < 3; a++) {
        q[a] = lattice->first + lattice->step * (double)place[a];
    }
    if (field->coefficients) {
        deformation_at(out, field, q);
    } else {
        const size_t v = 3 * (place[0] + field->dim[0] * (place[1] + field->dim[1] * place[2]));
        const double vector[3] = {number_at(field, v), number_at(field, v + 1), number_at(field, v + 2)};
        place_vector(out, field, q, vector);
    }
}

/* Finds where two layers of the lattice go; `far` is the second. */
struct layers {
    struct lattice lattice;
    double (*near)[3]; /* [dim[0] dim[1]] */
    double (*far)[3];
};

/* Whether the map turns over at one of the corners of the cell that begins at node n of the near layer. `turn` is 1 or
 * -1. */
static bool folds_at(const struct layers *layers, size_t n, double turn)
{
    const double *x[8];
    for (unsigned c = 0; c < 8; c++) {
        x[c] = (c & 4 ? layers->far : layers->near)[n + (c & 1) + (c >> 1 & 1) * layers->lattice.dim[0]];
    }
    for (unsigned c = 0; c < 8; c++) {
        double edges[3][3];
        double across[3];
        for (unsigned a = 0; a < 3; a++) { /* along axis a through corner c */
            vec3_sub(edges[a], x[c | 1U << a], x[c & ~(1U << a)]);
        }
        vec3_cross(across, edges[1], edges[2]);
        if (turn * vec3_dot(edges[0], across) <= 0) {
            return true;
        }
    }
    return false;
}

conus_status deformation_facts_find(struct deformation_facts *out, const struct deformation *field)
{
    struct deformation_facts facts = {0};
    double turn = mat4_determinant3(field->start) < 0 ? -1 : 1;
    const struct lattice lattice = lattice_of(field);
    const size_t *dim = lattice.dim;
    size_t nodes = dim[0] * dim[1];
    struct layers layers = {lattice, memory_raw(nodes, sizeof *layers.near), memory_raw(nodes, sizeof *layers.far)};
    bool enough = layers.near && layers.far;
    for (size_t k = 0; enough && k < dim[2]; k++) {
        double(*last)[3] = layers.near;
        layers.near = layers.far;
        layers.far = last;
        for (size_t n = 0; n < nodes; n++) {
            const size_t node[3] = {n % dim[0], n / dim[0], k};
            double q[3];
            double way[3];
            find_image(layers.far[n], q, field, &lattice, node);
            mat4_point(way, field->world_from_voxel, q);
            vec3_sub(way, layers.far[n], way);
            facts.nodes++;
            facts.unstated += !vec3_is_finite(way);
            facts.farthest = fmax(facts.farthest, vec3_length(way)); /* NaN is passed over */
        }
        if (k > 0) {
            for (size_t j = 0; j + 1 < dim[1]; j++) {
                for (size_t i = 0; i + 1 < dim[0]; i++) {
                    facts.cells++;
                    facts.folds += folds_at(&layers, i + dim[0] * j, turn);
                }
            }
        }
    }
    if (enough) {
        double x_from_voxel[16];
        double turned[16];
        if (mat4_invert_affine(x_from_voxel, field->start)) { /* invertible, or deformation_measure() had failed */
            mat4_multiply(turned, x_from_voxel, field->voxel_from_world);
            facts.growth = fabs(mat4_determinant3(turned));
            facts.mirrors = mat4_determinant3(turned) < 0;
            facts.half_turn = turned[0] < 0 && turned[5] < 0 && turned[10] > 0;
        }
        *out = facts;
    }
    memory_free(layers.near);
    memory_free(layers.far);
    return enough ? CONUS_OK : CONUS_ERROR_MEMORY;
}

enum { STEPS = 100, HALVINGS = 20, LATTICE = 10 }; /* LATTICE: nodes along an axis that are tried as a start */

static const double inside = 1e-9; /* from the ends of the grid, for rounding */

static void hold_inside(double q[3], const struct deformation *field)
{
    for (int a = 0; a < 3; a++) {
        q[a] = fmin(fmax(q[a], first_index(field) + inside), last_index(field, a) - inside);
    }
}

/* Newton's step, from the residual in mm to indices; false where the map is singular. */
static bool newton_step(double out[3], double columns[3][3], const double residual[3])
{
    double m[16] = {[15] = 1};
    double inverse[16];
    for (int a = 0; a < 3; a++) {
        memcpy(m + (ptrdiff_t)4 * a, columns[a], sizeof columns[a]);
    }
    if (!mat4_invert_affine(inverse, m)) {
        return false;
    }
    mat4_direction(out, inverse, residual);
    return true;
}

/* Takes `step`, or a fraction of it, such that the residual decreases. */
static bool go_along(double q[3], double residual[3], const struct deformation *field, const double target[3],
                     const double step[3])
{
    double length = vec3_length(residual);
    for (int i = 0; i < HALVINGS; i++) {
        double part = ldexp(1, -i);
        double next[3];
        double left[3];
        vec3_add_scaled(next, q, part, step);
        hold_inside(next, field);
        deformation_at(left, field, next);
        vec3_sub(left, target, left);
        if (vec3_length(left) <= length * (1 - part / 1000)) { /* false for NaN */
            memcpy(q, next, sizeof next);
            memcpy(residual, left, sizeof left);
            return true;
        }
    }
    return false;
}

/* Improves the indices q up to those of the target; false if the search ends before. */
static bool search(double q[3], const struct deformation *field, const double target[3])
{
    double residual[3];
    hold_inside(q, field);
    deformation_at(residual, field, q);
    vec3_sub(residual, target, residual);
    for (int i = 0; i < STEPS && vec3_length(residual) > DEFORMATION_TOLERANCE; i++) {
        double at[3];
        double step[3];
        double columns[3][3];
        deformation_slope(at, columns, field, q);
        bool goes = newton_step(step, columns, residual) && go_along(q, residual, field, target, step);
        if (!goes) { /* the field as a whole has an inverse */
            mat4_direction(step, field->start, residual);
            goes = go_along(q, residual, field, target, step);
        }
        if (!goes) {
            break;
        }
    }
    return vec3_length(residual) <= DEFORMATION_TOLERANCE;
}

/* The one of some nodes that goes nearest to the target; false where none goes anywhere. */
static bool nearest_node(double out[3], const struct deformation *field, const double target[3])
{
    double best = INFINITY;
    const struct lattice lattice = lattice_of(field);
    double step[3];
    for (int a = 0; a < 3; a++) {
        step[a] = (double)(lattice.dim[a] - 1) / (LATTICE - 1);
    }
    for (int n = 0; n < LATTICE * LATTICE * LATTICE; n++) {
        const int at[3] = {n % LATTICE, n / LATTICE % LATTICE, n / LATTICE / LATTICE};
        double q[3];
        double x[3];
        for (int a = 0; a < 3; a++) {
            q[a] = lattice.first + lattice.step * floor(at[a] * step[a]);
        }
        deformation_at(x, field, q);
        vec3_sub(x, target, x);
        if (vec3_length(x) < best) {
            best = vec3_length(x);
            memcpy(out, q, sizeof q);
        }
    }
    return best < INFINITY;
}

static bool is_at_border(const double q[3], const struct deformation *field)
{
    for (int a = 0; a < 3; a++) {
        if (!(q[a] > first_index(field) + inside && q[a] < last_index(field, a) - inside)) {
            return true;
        }
    }
    return false;
}

/* The range of the nodes' positions, and as far beyond as half a step at the border may reach. */
static bool is_within_reach(const struct deformation *field, const double target[3])
{
    for (int a = 0; a < 3; a++) {
        double more = (field->high[a] - field->low[a]) / 2;
        if (!(target[a] >= field->low[a] - more && target[a] <= field->high[a] + more)) {
            return false;
        }
    }
    return true;
}

static enum deformation_found outside(double out[3], const struct deformation *field, const double target[3])
{
    double q[3];
    double p[3];
    double voxel_from_image[16];
    bool moves = has_affine(field) && mat4_invert_affine(voxel_from_image, field->base);
    mat4_point(q, moves ? voxel_from_image : field->voxel_from_world, target);
    mat4_point(p, field->world_from_voxel, q);
    bool stays = field->stays_outside && !deformation_holds(field, q);
    for (int a = 0; a < 3; a++) {
        out[a] = !stays ? NAN : moves ? p[a] : target[a];
    }
    return DEFORMATION_OUTSIDE;
}

enum deformation_found deformation_find(double out[3], const struct deformation *field, const double target[3])
{
    double q[3];
    double goal[3];
    memcpy(goal, target, sizeof goal);
    if (!is_within_reach(field, goal)) {
        return outside(out, field, goal);
    }
    mat4_point(q, field->start, goal);
    if (search(q, field, goal) || (nearest_node(q, field, goal) && search(q, field, goal))) {
        mat4_point(out, field->world_from_voxel, q);
        return DEFORMATION_FOUND;
    }
    return is_at_border(q, field) ? outside(out, field, goal) : DEFORMATION_LOST;
}

enum deformation_found deformations_find(double out[3], const struct deformation *fields, size_t count,
                                         const double target[3])
{
    enum deformation_found found = DEFORMATION_FOUND;
    memmove(out, target, 3 * sizeof *out);
    for (size_t i = 0; i < count && found != DEFORMATION_LOST && vec3_is_finite(out); i++) {
        enum deformation_found step = deformation_find(out, &fields[i], out);
        found = step == DEFORMATION_FOUND ? found : step;
    }
    return found;
}

enum { MEASURED = 64 }; /* nodes along an axis that are enough */

/* Sums over nodes. */
struct sums {
    double count;
    double q[3], qq[3]; /* of indices and their squares */
    double x[3];        /* of where nodes go */
    double xq[3][3];    /* [axis of q][axis of x] */
};

static void add_node(struct sums *sums, struct deformation *field, const struct lattice *lattice, const size_t node[3])
{
    double q[3];
    double x[3];
    find_image(x, q, field, lattice, node);
    if (!vec3_is_finite(x)) {
        return;
    }
    sums->count++;
    for (int a = 0; a < 3; a++) {
        field->low[a] = fmin(field->low[a], x[a]);
        field->high[a] = fmax(field->high[a], x[a]);
        sums->q[a] += q[a];
        sums->qq[a] += q[a] * q[a];
        sums->x[a] += x[a];
        vec3_add_scaled(sums->xq[a], sums->xq[a], q[a], x);
    }
}

/* A line fit along each axis of indices by itself: on a whole grid these are independent, and a start needs no more. */
static void fit(double out[16], const struct sums *sums)
{
    mat4_identity(out);
    for (int b = 0; b < 3; b++) {
        out[12 + b] = sums->x[b] / sums->count;
    }
    for (int a = 0; a < 3; a++) {
        double mean = sums->q[a] / sums->count;
        double spread = sums->qq[a] - sums->count * mean * mean;
        for (int b = 0; b < 3; b++) {
            out[4 * a + b] = (sums->xq[a][b] - mean * sums->x[b]) / spread;
            out[12 + b] -= out[4 * a + b] * mean;
        }
    }
}

conus_status deformation_measure(struct deformation *field)
{
    const struct lattice lattice = lattice_of(field);
    struct sums sums = {0};
    double near[16];
    size_t node[3];
    size_t step[3];
    for (int a = 0; a < 3; a++) {
        step[a] = lattice.dim[a] / MEASURED + 1;
        field->low[a] = INFINITY;
        field->high[a] = -INFINITY;
    }
    for (node[2] = 0; node[2] < lattice.dim[2]; node[2] += step[2]) {
        for (node[1] = 0; node[1] < lattice.dim[1]; node[1] += step[1]) {
            for (node[0] = 0; node[0] < lattice.dim[0]; node[0] += step[0]) {
                add_node(&sums, field, &lattice, node);
            }
        }
    }
    fit(near, &sums);
    return mat4_invert_affine(field->start, near)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "the field takes all points to a plane, or nowhere");
}
