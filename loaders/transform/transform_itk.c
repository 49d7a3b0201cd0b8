/* SPDX-License-Identifier: BSD-3-Clause */
/* Transforms of ITK, as text and as MATLAB's level 4. The classes' parameters are documented in ITK's reference:
 * itk::MatrixOffsetTransformBase, itk::Euler3DTransform, itk::VersorRigid3DTransform, itk::Similarity3DTransform,
 * itk::BSplineTransform. */
#include "base/geometry/math3.h"
#include "base/job/job.h"
#include "base/memory.h"
#include "loaders/transform/transform.h"
#include "sources/source.h"

#include <string.h>

static const double flip[3] = {-1, -1, 1}; /* between LPS and RAS */

/* Rows of R, of a turn by the unit quaternion with the vector part v and a scalar part that is not negative. */
static void set_versor(struct job *job, double r[3][3], const double v[3])
{
    double square = vec3_dot(v, v);
    if (square > 1 + 1e-9) {
        job_bad(job, "Parameters: a versor of length %g, up to 1 is allowed", sqrt(square));
    }
    double w = sqrt(fmax(0, 1 - square));
    double x = v[0], y = v[1], z = v[2];
    const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    memcpy(r, rows, sizeof rows);
}

static void multiply(double out[3][3], double a[3][3], double b[3][3])
{
    double product[3][3];
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            product[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    memcpy(out, product, sizeof product);
}

/* Turns by angles about x, y, z: first about y, then x, then z; or about x, then y, then z. */
static void set_euler(double r[3][3], const double angles[3], bool x_first)
{
    double turns[3][3][3];
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3;
        int last = (axis + 2) % 3;
        memset(turns[axis], 0, sizeof turns[axis]);
        turns[axis][axis][axis] = 1;
        turns[axis][next][next] = turns[axis][last][last] = cos(angles[axis]);
        turns[axis][last][next] = sin(angles[axis]);
        turns[axis][next][last] = -sin(angles[axis]);
    }
    multiply(r, turns[x_first ? 1 : 0], turns[x_first ? 0 : 1]);
    multiply(r, turns[2], r);
}

/* p' = R (p - c) + c + t, of LPS, as a matrix of RAS. */
static void itk_place(double out[16], double r[3][3], const double c[3], const double t[3])
{
    mat4_identity(out);
    for (int row = 0; row < 3; row++) {
        double moved = c[row] + t[row];
        for (int column = 0; column < 3; column++) {
            out[4 * column + row] = flip[row] * flip[column] * r[row][column];
            moved -= r[row][column] * c[column];
        }
        out[12 + row] = flip[row] * moved;
    }
}

/* "AffineTransform_double_3_3" begins with "AffineTransform_" and ends with "_3_3". */
bool itk_is_type(struct text name, const char *type)
{
    size_t length = strlen(type);
    return name.size > length + 4 && text_starts(name, type) && name.data[length] == '_' &&
           memcmp(name.data + name.size - 4, "_3_3", 4) == 0;
}

/* What the matrix of an affine follows from. */
enum linear { MATRIX, EULER, VERSOR, SKEWED, QUATERNION, SCALE, IDENTITY };

/* The affines that are read: how many parameters and fixed ones they have, and where the translation is. */
static const struct affine {
    const char *type;
    enum linear linear;
    size_t count, fixed, fixed_most, translation; /* translation = count: there is none */
} affines[] = {
    {"AffineTransform", MATRIX, 12, 3, 3, 9},
    {"MatrixOffsetTransformBase", MATRIX, 12, 3, 3, 9},
    {"Rigid3DTransform", MATRIX, 12, 3, 3, 9},
    {"Euler3DTransform", EULER, 6, 3, 4, 3},
    {"VersorRigid3DTransform", VERSOR, 6, 3, 3, 3},
    {"Similarity3DTransform", VERSOR, 7, 3, 3, 3},
    {"ScaleSkewVersor3DTransform", SKEWED, 15, 3, 3, 3},
    {"QuaternionRigidTransform", QUATERNION, 7, 3, 3, 4},
    {"ScaleTransform", SCALE, 3, 3, 3, 3},
    {"TranslationTransform", IDENTITY, 3, 0, 0, 0},
    {"IdentityTransform", IDENTITY, 0, 0, 0, 0},
};

static const struct affine *find_affine(struct text name)
{
    for (size_t i = 0; i < sizeof affines / sizeof affines[0]; i++) {
        if (itk_is_type(name, affines[i].type)) {
            return &affines[i];
        }
    }
    return NULL;
}

static void check_fixed(struct job *job, const struct itk_entry *entry, size_t least, size_t most)
{
    if (entry->fixed.count < least || entry->fixed.count > most) {
        job_bad(job, "FixedParameters: %zu numbers, %.*s has %zu", entry->fixed.count, (int)entry->type.size,
                entry->type.data, least);
    }
}

/* Cubic ones; ITK 3's class has the same numbers. */
static bool is_spline(struct text name)
{
    return itk_is_type(name, "BSplineTransform") || itk_is_type(name, "BSplineDeformableTransform");
}

static void check_type(struct job *job, struct text name)
{
    bool found = is_spline(name) || find_affine(name);
    if (!found && text_mentions(name, "DisplacementField")) {
        job_refuse(job,
                   "Transform: %.*s, a field in ITK's own format, is not read; write it as a displacement field in "
                   "NIfTI, by 3D Slicer's Transforms, Convert, or by ANTs: "
                   "antsApplyTransforms -d 3 -r IMAGE -t FILE -o [FIELD.nii.gz,1]",
                   TEXT_SHOW(name, 60));
    } else if (!found) {
        job_refuse(job,
                   "Transform: %.*s; read are Affine, MatrixOffsetBase, Rigid3D, Euler3D, VersorRigid3D, "
                   "Similarity3D, ScaleSkewVersor3D, QuaternionRigid, Scale, Translation, Identity and cubic "
                   "BSpline, in 3-D, and composites of them",
                   TEXT_SHOW(name, 60));
    }
}

/* A turn by p[0..2], to which scales p[6..8] and skews p[9..14] are added: itk::ScaleSkewVersor3DTransform. */
static void set_skewed(struct job *job, double r[3][3], const double *p)
{
    static const int place[6][2] = {{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}};
    set_versor(job, r, p);
    for (int i = 0; i < 3; i++) {
        r[i][i] += p[6 + i] - 1;
    }
    for (int i = 0; i < 6; i++) {
        r[place[i][0]][place[i][1]] += p[9 + i];
    }
}

/* The matrix of a quaternion as ITK has it: a turn, scaled by the square of the length. */
static void set_quaternion(struct job *job, double r[3][3], const double q[4])
{
    double square = vec3_dot(q, q) + q[3] * q[3];
    double unit = (q[3] < 0 ? -1 : 1) / sqrt(square);
    const double v[3] = {unit * q[0], unit * q[1], unit * q[2]};
    if (!(square > 0)) {
        job_bad(job, "Parameters: a quaternion of length 0");
        return;
    }
    set_versor(job, r, v);
    for (int i = 0; i < 9; i++) {
        r[i / 3][i % 3] *= square;
    }
}

static void add_affine(struct job *job, struct transform_chain *chain, const struct itk_entry *entry)
{
    const struct affine *affine = find_affine(entry->type);
    const double *p = entry->parameters.at;
    static const double zero[3] = {0, 0, 0};
    double m[16];
    double r[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (entry->parameters.count != affine->count) {
        job_bad(job, "Parameters: %zu numbers, %.*s has %zu", entry->parameters.count, (int)entry->type.size,
                entry->type.data, affine->count);
    }
    check_fixed(job, entry, affine->fixed, affine->fixed_most);
    if (!job_ok(job)) {
        return;
    }
    switch (affine->linear) {
    case MATRIX:
        memcpy(r, p, sizeof r);
        break;
    case EULER:
        set_euler(r, p, entry->fixed.count == 4 && entry->fixed.at[3] != 0);
        break;
    case VERSOR:
        set_versor(job, r, p);
        for (int i = 0; affine->count == 7 && i < 9; i++) { /* with a scale */
            r[i / 3][i % 3] *= p[6];
        }
        break;
    case SKEWED:
        set_skewed(job, r, p);
        break;
    case QUATERNION:
        set_quaternion(job, r, p);
        break;
    case SCALE:
        for (int i = 0; i < 3; i++) {
            r[i][i] = p[i];
        }
        break;
    case IDENTITY:
        break;
    }
    itk_place(m, r, affine->fixed ? entry->fixed.at : zero,
              affine->translation < affine->count ? p + affine->translation : zero);
    chain_add_matrix(job, chain, m);
}

/* The grid of a spline: fixed has its size, origin, spacing and, by rows, direction, of LPS. */
static void spline_place(struct job *job, struct deformation *field, const double *fixed)
{
    mat4_identity(field->world_from_voxel);
    for (int a = 0; a < 3; a++) {
        if (!(fixed[a] >= 4 && fixed[a] <= UINT32_MAX && fixed[a] == floor(fixed[a]))) {
            job_bad(job, "FixedParameters: size %g, 4 or more nodes are needed", fixed[a]);
            return;
        }
        if (!(fixed[6 + a] > 0)) {
            job_bad(job, "FixedParameters: spacing %g, above 0 is needed", fixed[6 + a]);
        }
        field->dim[a] = (size_t)fixed[a];
        for (int row = 0; row < 3; row++) {
            field->world_from_voxel[4 * a + row] = flip[row] * fixed[9 + 3 * row + a] * fixed[6 + a];
        }
        field->world_from_voxel[12 + a] = flip[a] * fixed[3 + a];
    }
    if (!mat4_invert_affine(field->voxel_from_world, field->world_from_voxel)) {
        job_bad(job, "FixedParameters: the direction is singular");
    }
}

static void add_spline(struct job *job, struct transform_chain *chain, const struct itk_entry *entry)
{
    struct deformation field = {.stays_outside = true};
    size_t count = 0;
    check_fixed(job, entry, 18, 18);
    if (job_ok(job)) {
        spline_place(job, &field, entry->fixed.at);
    }
    bool fits = memory_multiply(field.dim[0], field.dim[1], &count) && memory_multiply(count, field.dim[2], &count) &&
                memory_multiply(count, 3, &count) && count == entry->parameters.count;
    if (!fits) {
        job_bad(job, "Parameters: %zu numbers, a grid of %zu x %zu x %zu has 3 for each node", entry->parameters.count,
                field.dim[0], field.dim[1], field.dim[2]);
    }
    if (!job_step(job)) {
        return;
    }
    memcpy(field.base, field.world_from_voxel, sizeof field.base);
    mat4_identity(field.linear);
    field.linear[0] = field.linear[5] = -1;
    field.coefficients = memory_copy(entry->parameters.at, count, sizeof *field.coefficients);
    if (job_need(job, field.coefficients)) {
        (void)JOB_CALL(job, deformation_measure(&field));
    }
    chain_push(job, chain, &field);
}

bool itk_is_composite(struct text name)
{
    return text_starts(name, "CompositeTransform_");
}

/* The transforms of a file, in its order. */
struct itk_list {
    struct itk_entry *at;
    size_t count, capacity;
};

void itk_chain_add(struct job *job, struct transform_chain *chain, const struct itk_entry *entry)
{
    check_type(job, entry->type);
    if (!entry->has_parameters || !entry->has_fixed) {
        job_bad(job, "%.*s: %s is missing", TEXT_SHOW(entry->type, 60),
                entry->has_parameters ? "FixedParameters" : "Parameters");
    }
    if (job_ok(job)) {
        (is_spline(entry->type) ? add_spline : add_affine)(job, chain, entry);
    }
}

static void add_list(struct job *job, struct transform_chain *chain, const struct itk_list *list, size_t chosen)
{
    const bool is_chain = list->count && itk_is_composite(list->at[0].type);
    for (size_t i = is_chain; i < list->count; i++) {
        if (itk_is_composite(list->at[i].type)) {
            job_refuse(job, "Transform: a composite behind another transform");
        }
    }
    if (is_chain && (list->at[0].has_parameters || list->at[0].has_fixed)) {
        job_bad(job, "Parameters: of a composite, which has none");
    }
    if (list->count == is_chain) {
        job_bad(job, "Transform: there is none");
    }
    if (chosen && (is_chain || chosen > list->count)) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "transform=%zu: %s", chosen - 1,
                 is_chain          ? "this is a composite, which is read as one"
                 : list->count > 1 ? "there are fewer, which count from 0"
                                   : "there is one, number 0");
    }
    if (!chosen && !is_chain && list->count > 1) {
        job_refuse(job,
                   "Transform: a list of %zu, such as one for each volume of a series, and no CompositeTransform that "
                   "makes a chain of them; ',transform=K' chooses number K, from 0 to %zu",
                   list->count, list->count - 1);
    }
    const size_t end = chosen ? chosen : list->count;
    for (size_t i = chosen ? chosen - 1 : is_chain; job_ok(job) && i < end && list->at; i++) {
        itk_chain_add(job, chain, &list->at[i]);
    }
    chain_end(job, chain);
}

/* "KEY: values"; false for another line. */
static bool itk_take_key(struct text *values, struct text line, const char *key)
{
    size_t length = strlen(key);
    if (!text_starts(line, key) || line.size == length || line.data[length] != ':') {
        return false;
    }
    *values = text_trim((struct text){line.data + length + 1, line.size - length - 1});
    return true;
}

static void take_numbers(struct job *job, double **at, size_t *count, struct text values, const char *key)
{
    LIST(double) numbers = {0};
    struct text word;
    while (job_ok(job) && text_word(&values, &word)) {
        double number = 0;
        if (!text_to_double(word, &number) || !isfinite(number)) {
            job_bad(job, "%s: \"%.*s\", finite numbers are needed", key, TEXT_SHOW(word, 40));
        }
        *LIST_ADD(job, &numbers) = number;
    }
    *at = numbers.at;
    *count = numbers.count;
}

static void take_line(struct job *job, struct itk_list *list, struct text line)
{
    struct text values;
    struct itk_entry *entry = list->count ? &list->at[list->count - 1] : NULL;
    if (!line.size || line.data[0] == '#') {
        return;
    }
    if (itk_take_key(&values, line, "Transform")) {
        if (!values.size) {
            job_bad(job, "Transform: has no type");
        }
        LIST_ADD(job, list)->type = values;
        return;
    }
    bool is_parameters = itk_take_key(&values, line, "Parameters");
    bool is_fixed = itk_take_key(&values, line, "FixedParameters");
    if (!entry && (is_parameters || is_fixed)) {
        job_bad(job, "Parameters: without a line Transform");
    } else if (is_parameters && !entry->has_parameters) {
        entry->has_parameters = true;
        take_numbers(job, &entry->parameters.at, &entry->parameters.count, values, "Parameters");
    } else if (is_fixed && !entry->has_fixed) {
        entry->has_fixed = true;
        take_numbers(job, &entry->fixed.at, &entry->fixed.count, values, "FixedParameters");
    } else {
        job_bad(job, "\"%.*s\": Transform, Parameters or FixedParameters is needed, each once", TEXT_SHOW(line, 40));
    }
}

void itk_text_parse(struct job *job, struct transform_chain *chain, struct text text, size_t chosen)
{
    struct text line;
    struct itk_list list = {0};
    while (job_ok(job) && text_line(&text, &line)) {
        take_line(job, &list, text_trim(line));
    }
    add_list(job, chain, &list, chosen);
}

/* Takes a matrix of one column, whose name it gives. */
static struct text take_column(struct job *job, double **at, size_t *count, struct reader *r)
{
    bool single = false;
    const size_t left = (size_t)(r->end - r->at);
    if (left < ITK_MATLAB_HEAD || !itk_matlab_type(&r->swapped, &single, r->at)) {
        job_bad(job, "no matrix of MATLAB's level 4 %zu bytes before the end", left);
    }
    reader_skip(r, 4);
    const uint32_t rows = reader_u32(r);
    const uint32_t columns = reader_u32(r);
    const uint32_t imaginary = reader_u32(r);
    const uint32_t length = reader_u32(r);
    const size_t each = single ? 4 : 8;
    if (columns > 1 || imaginary || !length || length > ITK_MATLAB_NAME_LIMIT ||
        left < ITK_MATLAB_HEAD + length + (size_t)rows * columns * each) {
        job_bad(job, "a matrix of %u x %u and a name of %u bytes, %zu bytes before the end", rows, columns, length,
                left);
    }
    const char *name = (const char *)reader_take(r, length);
    const struct text column = {name, name ? strnlen(name, length) : 0};
    *count = (size_t)rows * columns;
    *at = job_array(job, count, sizeof **at);
    for (size_t i = 0; i < *count; i++) {
        (*at)[i] = single ? reader_f32(r) : reader_f64(r);
        if (!isfinite((*at)[i])) {
            job_bad(job, "%.*s: a number that is not finite", (int)column.size, name);
        }
    }
    return column;
}

void itk_matlab_parse(struct job *job, struct transform_chain *chain, const uint8_t *data, size_t size)
{
    struct itk_entry entry = {.has_parameters = true, .has_fixed = true};
    struct reader r = reader_of(job, (struct text){(const char *)data, size});
    const char *name = (const char *)data + ITK_MATLAB_HEAD;
    size_t left = size > ITK_MATLAB_HEAD ? size - ITK_MATLAB_HEAD : 0;
    const struct text type = {name, strnlen(name, left < ITK_MATLAB_NAME_LIMIT ? left : ITK_MATLAB_NAME_LIMIT)};
    if (text_mentions(type, "Transform_")) {
        check_type(job, type);
    }
    entry.type = take_column(job, &entry.parameters.at, &entry.parameters.count, &r);
    const struct text fixed = take_column(job, &entry.fixed.at, &entry.fixed.count, &r);
    if (job_ok(job) && !text_equal(fixed, "fixed")) {
        job_bad(job, "\"%.*s\" behind the parameters, \"fixed\" is needed", (int)fixed.size, fixed.data);
    }
    if (reader_has(&r, 1)) {
        job_refuse(job, "%zu bytes behind the first transform, one is read", (size_t)(r.end - r.at));
    }
    add_list(job, chain, &(struct itk_list){.at = &entry, .count = 1}, 0);
}
