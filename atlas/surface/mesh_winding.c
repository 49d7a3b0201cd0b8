/* SPDX-License-Identifier: BSD-3-Clause */
/* How often a closed mesh winds around what it encloses, along lines in z. */
#include "atlas/surface/mesh_winding.h"

#include "atlas/surface/mesh_lines.h"

enum { LINES = 64, PAIR_LIMIT = 1 << 26 };

/* The length inside, winding not 0, and that of it around which the mesh does not wind `facing` times. */
static void sum_lengths(double *inside, double *wrong, const struct mesh_lines *lines, int facing)
{
    int winding = 0;
    for (size_t i = 0; i + 1 < lines->crossing_count; i++) {
        const struct line_crossing *here = &lines->crossings[i];
        bool ends = here[1].line != here->line;
        winding = ends ? 0 : winding + here->side;
        if (winding != 0) {
            *inside += here[1].z - here->z;
            *wrong += winding != facing ? here[1].z - here->z : 0;
        }
    }
}

conus_status mesh_winds_once(bool *out, const struct mesh *mesh, const struct mesh_shape *shape)
{
    static const double tolerance = 1e-2;
    struct mesh_lines lines = {0};
    double inside = 0;
    double wrong = 0;
    conus_status status = CONUS_OK;
    /* Lines lie off the middle of their cells, since vertices of many meshes are at round numbers. */
    static const double off_middle[2] = {0.4878911, 0.5127683};
    for (int a = 0; a < 2; a++) {
        lines.count[a] = LINES;
        lines.step[a] = (shape->high[a] - shape->low[a]) / LINES;
        lines.start[a] = shape->low[a] + off_middle[a] * lines.step[a];
    }
    for (size_t i = 0; !status && lines.pairs <= PAIR_LIMIT && i < mesh->triangle_count; i++) {
        status = mesh_lines_cross(&lines, 0, mesh, i, NULL);
    }
    if (!status) {
        mesh_lines_sort(&lines);
        sum_lengths(&inside, &wrong, &lines, shape->volume_mm3 < 0 ? -1 : 1);
        *out = lines.pairs <= PAIR_LIMIT && wrong <= tolerance * inside;
    }
    mesh_lines_finish(&lines);
    return status;
}
