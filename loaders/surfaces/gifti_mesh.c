/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a surface, or labels of its vertices, of the arrays of a GIFTI file. */
#include "loaders/surfaces/parts.h"

#include "atlas/space.h"
#include "atlas/surface/mesh_space.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/tolerance.h"
#include "sources/source.h"

enum { SPACE_UNKNOWN = 0, GEOMETRY_WHOLE = (1 << 12) - 1 };

/* The n-th array of an intent, or NULL; *count becomes how many there are. */
static const struct gifti_array *find_array(const struct gifti *gifti, enum gifti_intent intent, size_t n,
                                            size_t *count)
{
    const struct gifti_array *found = NULL;
    *count = 0;
    for (size_t i = 0; i < gifti->arrays.count; i++) {
        if (gifti->arrays.at[i].intent == intent && (*count)++ == n) {
            found = &gifti->arrays.at[i];
        }
    }
    return found;
}

/* The first array of an intent, which must be a list of triples; NULL after a failure. */
static const struct gifti_array *find_triples(struct job *job, const struct gifti *gifti, enum gifti_intent intent,
                                              const char *name)
{
    size_t count;
    const struct gifti_array *array = find_array(gifti, intent, 0, &count);
    if (!array) {
        size_t labels;
        const char *way = find_array(gifti, GIFTI_LABEL, 0, &labels)
                              ? ": these are labels of vertices, give them as --labels and their surface as ATLAS"
                              : "";
        job_bad(job, "no %s array: not a surface (which has POINTSET and TRIANGLE)%s", name, way);
    } else if (array->rank != 2 || array->dim[1] != 3) {
        job_bad(job, "%s array: found %zu dimensions, Dim1 = %zu, allowed are 2 and 3", name, array->rank,
                array->dim[1]);
    } else if (count > 1) {
        job_note(job, "%zu %s arrays: the first was used", count, name);
    }
    return job_ok(job) ? array : NULL;
}

static bool gifti_is_identity(const double m[16])
{
    double largest = 0;
    for (int i = 0; i < 16; i++) {
        largest = fmax(largest, fabs(m[i] - (i % 5 == 0)));
    }
    return largest <= 2 * TOLERANCE; /* a product of two */
}

/* The space in which all matrices say that the vertices are stored. A matrix that changes nothing says it, too. */
static int find_space(struct job *job, const struct gifti_array *points)
{
    int found = SPACE_UNKNOWN;
    for (size_t i = 0; i < points->transforms.count; i++) {
        const struct gifti_transform *transform = &points->transforms.at[i];
        const int first = points->transforms.at[0].data_space;
        const int space = transform->data_space;
        if (space != first) {
            job_bad(job, "DataSpace: found \"%s\" and \"%s\" for one array", space_code_name(first),
                    space_code_name(space));
        }
        bool same = gifti_is_identity(transform->matrix);
        found = space != SPACE_UNKNOWN ? space : same && found == SPACE_UNKNOWN ? transform->transformed_space : found;
    }
    return found;
}

static void note_matrix(struct job *job, const struct gifti_array *points)
{
    for (size_t i = 0; i < points->transforms.count; i++) {
        const struct gifti_transform *transform = &points->transforms.at[i];
        if (transform->transformed_space != transform->data_space && !gifti_is_identity(transform->matrix)) {
            job_note(job, "the matrix from %s to %s space was not applied: vertices stay where they are stored",
                     space_code_name(transform->data_space), space_code_name(transform->transformed_space));
            return;
        }
    }
}

/* The first matrix into the scanner's or an aligned space, or NULL. */
static const struct gifti_transform *find_home(const struct gifti_array *points)
{
    for (size_t i = 0; i < points->transforms.count; i++) {
        const int space = points->transforms.at[i].transformed_space;
        if (space > SPACE_UNKNOWN && space <= SPACE_ALIGNED) {
            return &points->transforms.at[i];
        }
    }
    return NULL;
}

/* docs/spaces.md, GIFTI. `world` is the identity. */
static void gifti_find_place(struct job *job, double world[16], const struct gifti_array *points)
{
    const struct gifti_geometry *geometry = &points->geometry;
    const struct gifti_transform *home = find_home(points);
    const int space = find_space(job, points);
    for (size_t i = 0; i < points->transforms.count; i++) {
        if (points->transforms.at[i].is_foreign) {
            job_warn(job, "DataSpace or TransformedSpace: a name that is none of NIfTI's: taken as unknown");
        }
    }
    if (space != SPACE_UNKNOWN) {
        note_matrix(job, points);
    } else if (home) {
        double inverse[16];
        memcpy(world, home->matrix, sizeof home->matrix);
        if (!mat4_invert_affine(inverse, world)) {
            job_bad(job, "MatrixData: the matrix is singular, an invertible one is needed");
        } else if (!gifti_is_identity(world)) {
            job_note(job, "vertices were moved by the file's matrix into %s space",
                     space_code_name(home->transformed_space));
        }
    } else if (geometry->given != GEOMETRY_WHOLE) {
        note_matrix(job, points);
        job_note(job, "the surface does not say in which space it is (DataSpace is unknown): vertices were taken as "
                      "the world's" MESH_SPACE_WAY);
    } else if (freesurfer_world_from_surface(world, geometry->axes, geometry->centre)) {
        job_note(job,
                 "FreeSurfer surface coordinates were moved into the scanner's by the file's VolGeom metadata "
                 "(c_ras %g, %g, %g)",
                 geometry->centre[0], geometry->centre[1], geometry->centre[2]);
    } else {
        job_bad(job, "VolGeomX_R to VolGeomZ_S: no directions at right angles");
    }
}

static void fill_triangles(struct job *job, struct mesh *mesh, const struct gifti_array *triangles)
{
    for (size_t i = 0; i < triangles->count; i++) {
        double index = triangles->values[i];
        if (!(index >= 0 && index < (double)mesh->vertex_count) || index != floor(index)) {
            job_bad(job, "triangle %zu: vertex index %.9g, allowed are whole numbers from 0 to %zu", i / 3, index,
                    mesh->vertex_count - 1);
            return;
        }
        mesh->triangles[i] = (uint32_t)index;
    }
}

void gifti_surface(struct job *job, struct mesh *out, const struct gifti *gifti, bool as_stored)
{
    double world[16];
    if (!job_step(job)) { /* there is no document */
        return;
    }
    const struct gifti_array *points = find_triples(job, gifti, GIFTI_POINTSET, "POINTSET");
    const struct gifti_array *triangles = find_triples(job, gifti, GIFTI_TRIANGLE, "TRIANGLE");
    mat4_identity(world);
    if (triangles && !as_stored) {
        gifti_find_place(job, world, points);
    }
    if (!triangles || !JOB_CALL(job, mesh_init(out, points->dim[0], triangles->dim[0]))) {
        return;
    }
    for (size_t i = 0; i < points->count; i++) {
        out->positions[i] = (float)points->values[i];
    }
    fill_triangles(job, out, triangles);
    if (!gifti_is_identity(world)) {
        mesh_transform(out, world);
    }
}

static void gifti_fill_labels(struct job *job, uint32_t *labels, const struct gifti_array *array,
                              const struct label_table *table)
{
    size_t negative = 0;
    for (size_t i = 0; i < array->count; i++) {
        double value = tolerance_whole(array->values[i], fabs(array->values[i]));
        if (value != floor(value) || value > UINT32_MAX) {
            job_bad(job, "vertex %zu: label %.9g, allowed are whole numbers up to 4294967295", i, value);
            return;
        }
        labels[i] = value > 0 ? (uint32_t)value : 0;
        negative += value < 0;
    }
    if (array->is_single) {
        (void)JOB_CALL(job, label_table_check_singles(table, labels, array->count, TOLERANCE_SINGLE_END, "LABEL array",
                                                      &job->notes));
    }
    if (negative) {
        job_note(job, "%zu vertices have labels below 0 and belong to no area", negative);
    }
}

uint32_t *gifti_vertices(struct job *job, size_t *count, const struct gifti *gifti, size_t map)
{
    size_t arrays = 0;
    size_t sparse;
    size_t longest = 0; /* N, N x 1 or 1 x N */
    *count = 0;
    const struct gifti_array *array = job_step(job) ? find_array(gifti, GIFTI_LABEL, map, &arrays) : NULL;
    if (!job_ok(job) || (!arrays && !map)) {
        return NULL;
    }
    if (!array) {
        job_bad(job, "LABEL array %zu: the file has %zu (counted from 0)", map, arrays);
        return NULL;
    }
    if (find_array(gifti, GIFTI_NODE_INDEX, 0, &sparse)) {
        job_refuse(job, "labels of only some vertices (NODE_INDEX array), all vertices are needed");
    }
    for (size_t d = 0; d < array->rank; d++) {
        longest = array->dim[d] > longest ? array->dim[d] : longest;
    }
    if (longest != array->count) {
        job_bad(job, "LABEL array: found %zu numbers for %zu vertices, one each is needed", array->count,
                array->dim[0]);
    }
    *count = array->count;
    uint32_t *labels = job_array(job, count, sizeof *labels);
    if (labels) {
        gifti_fill_labels(job, labels, array, &gifti->labels);
    }
    *count = job_ok(job) ? *count : 0;
    return *count ? labels : NULL;
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

void gifti_settle_labels(struct job *job, struct gifti *gifti)
{
    size_t count[3];
    if (!job_step(job)) {
        return;
    }
    (void)find_array(gifti, GIFTI_LABEL, 0, &count[0]);
    (void)find_array(gifti, GIFTI_POINTSET, 0, &count[1]);
    const struct gifti_array *other = find_array(gifti, GIFTI_OTHER, 0, &count[2]);
    if (count[0] || count[1] || !other) {
        return;
    }
    if (count[2] == 1 && is_of_table(other, &gifti->labels)) {
        gifti->arrays.at[other - gifti->arrays.at].intent = GIFTI_LABEL;
        job_note(job, "no array has the intent LABEL: the only one is taken, whose numbers are all in the LabelTable");
    } else {
        job_bad(job, "no array has the intent LABEL, but others (NONE, SHAPE, TIME_SERIES, ...): these are values of "
                     "vertices, or labels that were saved as such");
    }
}

size_t gifti_map(struct job *job, const struct gifti *gifti, struct text wanted)
{
    size_t map = 0;
    size_t count = 0;
    const size_t arrays = gifti ? gifti->arrays.count : 0;
    const char **names = job_zeroed(job, arrays, sizeof *names);
    for (size_t i = 0; names && i < arrays; i++) {
        if (gifti->arrays.at[i].intent == GIFTI_LABEL) {
            names[count++] = gifti->arrays.at[i].name;
        }
    }
    (void)JOB_CALL(job, map_choice_make(&map, names, count, wanted, "LABEL arrays", &job->notes));
    return map;
}
