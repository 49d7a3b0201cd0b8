/* SPDX-License-Identifier: BSD-3-Clause */
/* Looks through a deformation field. */
#include "atlas/deformation/deformation_facts.h"

#include "base/geometry/math3.h"
#include "base/memory.h"

/* Where the nodes of two layers go, of which `far` is the second. */
struct layers {
    const struct deformation *field;
    double (*near)[3]; /* [dim[0] dim[1]] */
    double (*far)[3];
};

static void visit_layer(struct deformation_facts *out, struct layers *layers, size_t k)
{
    const struct deformation *field = layers->field;
    for (size_t n = 0; n < field->dim[0] * field->dim[1]; n++) {
        const size_t node[3] = {n % field->dim[0], n / field->dim[0], k};
        const double q[3] = {(double)node[0], (double)node[1], (double)node[2]};
        double way[3];
        deformation_node(layers->far[n], field, node);
        mat4_point(way, field->world_from_voxel, q);
        vec3_sub(way, layers->far[n], way);
        out->nodes++;
        out->unstated += !vec3_is_finite(way);
        out->farthest = fmax(out->farthest, vec3_length(way)); /* NaN is passed over */
    }
}

/* Whether the map turns over at one of the corners of the cell that begins at node n of the near layer. `turn` is 1 or
 * -1. */
static bool folds_at(const struct layers *layers, size_t n, double turn)
{
    const double *x[8];
    for (unsigned c = 0; c < 8; c++) {
        x[c] = (c & 4 ? layers->far : layers->near)[n + (c & 1) + (c >> 1 & 1) * layers->field->dim[0]];
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

static void find_directions(struct deformation_facts *out, const struct deformation *field)
{
    double x_from_voxel[16];
    double turned[16];
    if (mat4_invert_affine(x_from_voxel, field->start)) { /* as deformation_measure() has found */
        mat4_multiply(turned, x_from_voxel, field->voxel_from_world);
        out->growth = fabs(mat4_determinant3(turned));
        out->mirrors = mat4_determinant3(turned) < 0;
        out->half_turn = turned[0] < 0 && turned[5] < 0 && turned[10] > 0;
    }
}

conus_status deformation_facts_find(struct deformation_facts *out, const struct deformation *field)
{
    struct deformation_facts facts = {0};
    double turn = mat4_determinant3(field->start) < 0 ? -1 : 1;
    size_t nodes = field->dim[0] * field->dim[1];
    struct layers layers = {field, memory_raw(nodes, sizeof *layers.near), memory_raw(nodes, sizeof *layers.far)};
    bool enough = layers.near && layers.far;
    for (size_t k = 0; enough && k < field->dim[2]; k++) {
        double(*last)[3] = layers.near;
        layers.near = layers.far;
        layers.far = last;
        visit_layer(&facts, &layers, k);
        if (k > 0) {
            const size_t *dim = layers.field->dim;
            for (size_t j = 0; j + 1 < dim[1]; j++) {
                for (size_t i = 0; i + 1 < dim[0]; i++) {
                    facts.cells++;
                    facts.folds += folds_at(&layers, i + dim[0] * j, turn);
                }
            }
        }
    }
    if (enough) {
        find_directions(&facts, field);
        *out = facts;
    }
    memory_free(layers.near);
    memory_free(layers.far);
    return enough ? CONUS_OK : CONUS_ERROR_MEMORY;
}
