/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a surface, or labels of its vertices, of the arrays of a GIFTI file. */
#include "loaders/surfaces/gifti.h"

#include "atlas/space.h"
#include "atlas/surface/mesh_space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "loaders/surfaces/freesurfer_surface.h"
#include "sources/map_choice.h"

enum { SPACE_UNKNOWN = 0, GEOMETRY_WHOLE = (1 << 12) - 1 };

/* The n-th array of an intent, or NULL; *count becomes how many there are. */
static const struct gifti_array *find_array(const struct gifti *gifti, enum gifti_intent intent, size_t n,
                                            size_t *count)
{
    const struct gifti_array *found = NULL;
    *count = 0;
    for (size_t i = 0; i < gifti->array_count; i++) {
        if (gifti->arrays[i].intent == intent && (*count)++ == n) {
            found = &gifti->arrays[i];
        }
    }
    return found;
}

/* The first array of an intent, which must be a list of triples. */
static conus_status find_triples(const struct gifti_array **out, const struct gifti *gifti, enum gifti_intent intent,
                                 const char *name, struct notes *notes)
{
    size_t count;
    const struct gifti_array *array = find_array(gifti, intent, 0, &count);
    if (!array) {
        const char *way = find_array(gifti, GIFTI_LABEL, 0, &count)
                              ? ": these are labels of vertices, give them as --labels and their surface as ATLAS"
                              : "";
        return fail(CONUS_ERROR_DATA, "no %s array: not a surface (which has POINTSET and TRIANGLE)%s", name, way);
    }
    if (array->rank != 2 || array->dim[1] != 3) {
        return fail(CONUS_ERROR_DATA, "%s array: found %zu dimensions, Dim1 = %zu, allowed are 2 and 3", name,
                    array->rank, array->dim[1]);
    }
    *out = array;
    return count > 1 ? notes_add(notes, "%zu %s arrays: the first was used", count, name) : CONUS_OK;
}

static bool gifti_is_identity(const double m[16])
{
    double largest = 0;
    for (int i = 0; i < 16; i++) {
        largest = fmax(largest, fabs(m[i] - (i % 5 == 0)));
    }
    return largest <= 2 * TOLERANCE; /* a product of two */
}

/* Finds the space in which all matrices say that the vertices are stored. A matrix that changes nothing says it, too.
 */
static conus_status find_space(int *out, const struct gifti_array *points)
{
    *out = SPACE_UNKNOWN;
    for (size_t i = 0; i < points->transform_count; i++) {
        int space = points->transforms[i].data_space;
        if (i && space != points->transforms[0].data_space) {
            return fail(CONUS_ERROR_DATA, "DataSpace: found \"%s\" and \"%s\" for one array",
                        space_code_name(points->transforms[0].data_space), space_code_name(space));
        }
        bool same = gifti_is_identity(points->transforms[i].matrix);
        *out = space != SPACE_UNKNOWN          ? space
               : same && *out == SPACE_UNKNOWN ? points->transforms[i].transformed_space
                                               : *out;
    }
    return CONUS_OK;
}

static conus_status note_matrix(const struct gifti_array *points, struct notes *notes)
{
    for (size_t i = 0; i < points->transform_count; i++) {
        const struct gifti_transform *transform = &points->transforms[i];
        if (transform->transformed_space != transform->data_space && !gifti_is_identity(transform->matrix)) {
            return notes_add(notes,
                             "the matrix from %s to %s space was not applied: vertices stay where they are stored",
                             space_code_name(transform->data_space), space_code_name(transform->transformed_space));
        }
    }
    return CONUS_OK;
}

/* docs/spaces.md, GIFTI. */
static conus_status gifti_find_place(double world[16], const struct gifti_array *points, struct notes *notes)
{
    int space;
    const struct gifti_geometry *geometry = &points->geometry;
    conus_status status = find_space(&space, points);
    mat4_identity(world);
    for (size_t i = 0; !status && i < points->transform_count; i++) {
        if (points->transforms[i].is_foreign) {
            status =
                notes_warn(notes, "DataSpace or TransformedSpace: a name that is none of NIfTI's: taken as unknown");
        }
    }
    if (status) {
        return status;
    }
    if (space != SPACE_UNKNOWN) {
        return note_matrix(points, notes);
    }
    for (size_t i = 0; i < points->transform_count; i++) { /* the first one into the scanner's or an aligned space */
        const struct gifti_transform *home = &points->transforms[i];
        if (home->transformed_space <= SPACE_UNKNOWN || home->transformed_space > SPACE_ALIGNED) {
            continue;
        }
        double inverse[16];
        memcpy(world, home->matrix, sizeof home->matrix);
        return !mat4_invert_affine(inverse, world)
                   ? fail(CONUS_ERROR_DATA, "MatrixData: the matrix is singular, an invertible one is needed")
               : gifti_is_identity(world) ? CONUS_OK
                                          : notes_add(notes, "vertices were moved by the file's matrix into %s space",
                                                      space_code_name(home->transformed_space));
    }
    if (geometry->given == GEOMETRY_WHOLE) {
        return freesurfer_world_from_surface(world, geometry->axes, geometry->centre)
                   ? notes_add(notes,
                               "FreeSurfer surface coordinates were moved into the scanner's by the file's VolGeom "
                               "metadata (c_ras %g, %g, %g)",
                               geometry->centre[0], geometry->centre[1], geometry->centre[2])
                   : fail(CONUS_ERROR_DATA, "VolGeomX_R to VolGeomZ_S: no directions at right angles");
    }
    status = note_matrix(points, notes);
    return status
               ? status
               : notes_add(notes, "the surface does not say in which space it is (DataSpace is unknown): vertices were "
                                  "taken as the world's" MESH_SPACE_WAY);
}

conus_status gifti_mesh(struct mesh *out, const struct gifti *gifti, bool as_stored, struct notes *notes)
{
    const struct gifti_array *points = NULL;
    const struct gifti_array *triangles = NULL;
    struct mesh mesh = {0};
    double world[16];
    conus_status status;
    if ((status = find_triples(&points, gifti, GIFTI_POINTSET, "POINTSET", notes)) ||
        (status = find_triples(&triangles, gifti, GIFTI_TRIANGLE, "TRIANGLE", notes)) ||
        (!as_stored && (status = gifti_find_place(world, points, notes))) ||
        (status = mesh_init(&mesh, points->dim[0], triangles->dim[0]))) {
        return status;
    }
    for (size_t i = 0; i < points->count; i++) {
        mesh.positions[i] = (float)points->values[i];
    }
    for (size_t i = 0; i < triangles->count; i++) {
        double index = triangles->values[i];
        if (!(index >= 0 && index < (double)mesh.vertex_count) || index != floor(index)) {
            status = fail(CONUS_ERROR_DATA, "triangle %zu: vertex index %.9g, allowed are whole numbers from 0 to %zu",
                          i / 3, index, mesh.vertex_count - 1);
            mesh_finish(&mesh);
            return status;
        }
        mesh.triangles[i] = (uint32_t)index;
    }
    if (!as_stored && !gifti_is_identity(world)) {
        mesh_transform(&mesh, world);
    }
    *out = mesh;
    return CONUS_OK;
}

static conus_status gifti_fill_labels(uint32_t *labels, const struct gifti_array *array,
                                      const struct label_table *table, struct notes *notes)
{
    size_t negative = 0;
    for (size_t i = 0; i < array->count; i++) {
        double value = tolerance_whole(array->values[i], fabs(array->values[i]));
        if (value != floor(value) || value > UINT32_MAX) {
            return fail(CONUS_ERROR_DATA, "vertex %zu: label %.9g, allowed are whole numbers up to 4294967295", i,
                        value);
        }
        labels[i] = value > 0 ? (uint32_t)value : 0;
        negative += value < 0;
    }
    conus_status status = array->is_single ? label_table_check_singles(table, labels, array->count,
                                                                       TOLERANCE_SINGLE_END, "LABEL array", notes)
                                           : CONUS_OK;
    return status || !negative ? status
                               : notes_add(notes, "%zu vertices have labels below 0 and belong to no area", negative);
}

conus_status gifti_labels(uint32_t **labels, size_t *count, const struct gifti *gifti, size_t map, struct notes *notes)
{
    size_t arrays;
    size_t sparse;
    const struct gifti_array *array = find_array(gifti, GIFTI_LABEL, map, &arrays);
    if (!arrays && !map) {
        *labels = NULL;
        *count = 0;
        return CONUS_OK;
    }
    if (!array) {
        return fail(CONUS_ERROR_DATA, "LABEL array %zu: the file has %zu (counted from 0)", map, arrays);
    }
    if (find_array(gifti, GIFTI_NODE_INDEX, 0, &sparse)) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "labels of only some vertices (NODE_INDEX array), all vertices are needed");
    }
    size_t longest = 0; /* N, N x 1 or 1 x N */
    for (size_t d = 0; d < array->rank; d++) {
        longest = array->dim[d] > longest ? array->dim[d] : longest;
    }
    if (longest != array->count) {
        return fail(CONUS_ERROR_DATA, "LABEL array: found %zu numbers for %zu vertices, one each is needed",
                    array->count, array->dim[0]);
    }
    uint32_t *out = memory_raw(array->count, sizeof *out);
    conus_status status = out ? gifti_fill_labels(out, array, &gifti->labels, notes) : CONUS_ERROR_MEMORY;
    if (status) {
        memory_free(out);
        return status;
    }
    *labels = out;
    *count = array->count;
    return CONUS_OK;
}

/* Whether each number of the array is 0 or one of the table's. */
static bool is_of_table(const struct gifti_array *array, const struct label_table *table)
{
    bool is = table->count && array->count && array->values;
    for (size_t i = 0; is && i < array->count; i++) {
        double value = array->values[i];
        is = value == 0 ||
             (value > 0 && value <= UINT32_MAX && value == floor(value) && label_table_find(table, (uint32_t)value));
    }
    return is;
}

conus_status gifti_find_labels(struct gifti *gifti, struct notes *notes)
{
    size_t count[3];
    (void)find_array(gifti, GIFTI_LABEL, 0, &count[0]);
    (void)find_array(gifti, GIFTI_POINTSET, 0, &count[1]);
    const struct gifti_array *other = find_array(gifti, GIFTI_OTHER, 0, &count[2]);
    if (count[0] || count[1] || !other) {
        return CONUS_OK;
    }
    if (count[2] == 1 && is_of_table(other, &gifti->labels)) {
        gifti->arrays[other - gifti->arrays].intent = GIFTI_LABEL;
        return notes_add(notes, "no array has the intent LABEL: the only one is taken, whose numbers are all in the "
                                "LabelTable");
    }
    return fail(CONUS_ERROR_DATA, "no array has the intent LABEL, but others (NONE, SHAPE, TIME_SERIES, ...): these "
                                  "are values of vertices, or labels that were saved as such");
}

conus_status gifti_map_find(size_t *out, const struct gifti *gifti, struct text wanted, struct notes *notes)
{
    size_t count = 0;
    const char **names = memory_zeroed(gifti->array_count, sizeof *names);
    if (!names) {
        return CONUS_ERROR_MEMORY;
    }
    for (size_t i = 0; i < gifti->array_count; i++) {
        if (gifti->arrays[i].intent == GIFTI_LABEL) {
            names[count++] = gifti->arrays[i].name;
        }
    }
    conus_status status = map_choice_make(out, names, count, wanted, "LABEL arrays", notes);
    memory_free(names);
    return status;
}
