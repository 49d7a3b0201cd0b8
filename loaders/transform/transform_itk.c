/* SPDX-License-Identifier: BSD-3-Clause */
/* Transforms of ITK, as text and as MATLAB's level 4. The classes' parameters are documented in ITK's reference:
 * itk::MatrixOffsetTransformBase, itk::Euler3DTransform, itk::VersorRigid3DTransform, itk::Similarity3DTransform,
 * itk::BSplineTransform. */
#include "loaders/transform/transform_formats.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/memory.h"

static const double flip[3] = {-1, -1, 1}; /* between LPS and RAS */

/* Rows of R, of a turn by the unit quaternion with the vector part v and a scalar part that is not negative. */
static conus_status set_versor(double r[3][3], const double v[3])
{
    double square = vec3_dot(v, v);
    if (square > 1 + 1e-9) {
        return fail(CONUS_ERROR_DATA, "Parameters: a versor of length %g, up to 1 is allowed", sqrt(square));
    }
    double w = sqrt(fmax(0, 1 - square));
    double x = v[0], y = v[1], z = v[2];
    const double rows[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    memcpy(r, rows, sizeof rows);
    return CONUS_OK;
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

static conus_status check_fixed(const struct itk_entry *entry, size_t least, size_t most)
{
    return entry->fixed_count >= least && entry->fixed_count <= most
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "FixedParameters: %zu numbers, %.*s has %zu", entry->fixed_count,
                      (int)entry->type.size, entry->type.data, least);
}

/* Cubic ones; ITK 3's class has the same numbers. */
static bool is_spline(struct text name)
{
    return itk_is_type(name, "BSplineTransform") || itk_is_type(name, "BSplineDeformableTransform");
}

/* CONUS_OK for the types that are known. */
static conus_status check_type(struct text name)
{
    bool found = is_spline(name) || find_affine(name);
    if (!found && text_mentions(name, "DisplacementField")) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "Transform: %.*s, a field in ITK's own format, is not read; write it as a displacement field in "
                    "NIfTI, by 3D Slicer's Transforms, Convert, or by ANTs: "
                    "antsApplyTransforms -d 3 -r IMAGE -t FILE -o [FIELD.nii.gz,1]",
                    TEXT_SHOW(name, 60));
    }
    return found ? CONUS_OK
                 : fail(CONUS_ERROR_UNSUPPORTED,
                        "Transform: %.*s; read are Affine, MatrixOffsetBase, Rigid3D, Euler3D, VersorRigid3D, "
                        "Similarity3D, ScaleSkewVersor3D, QuaternionRigid, Scale, Translation, Identity and cubic "
                        "BSpline, in 3-D, and composites of them",
                        TEXT_SHOW(name, 60));
}

/* A turn by p[0..2], to which scales p[6..8] and skews p[9..14] are added: itk::ScaleSkewVersor3DTransform. */
static conus_status set_skewed(double r[3][3], const double *p)
{
    static const int place[6][2] = {{0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}};
    conus_status status = set_versor(r, p);
    for (int i = 0; !status && i < 3; i++) {
        r[i][i] += p[6 + i] - 1;
    }
    for (int i = 0; !status && i < 6; i++) {
        r[place[i][0]][place[i][1]] += p[9 + i];
    }
    return status;
}

/* The matrix of a quaternion as ITK has it: a turn, scaled by the square of the length. */
static conus_status set_quaternion(double r[3][3], const double q[4])
{
    double square = vec3_dot(q, q) + q[3] * q[3];
    double unit = (q[3] < 0 ? -1 : 1) / sqrt(square);
    const double v[3] = {unit * q[0], unit * q[1], unit * q[2]};
    conus_status status =
        square > 0 ? set_versor(r, v) : fail(CONUS_ERROR_DATA, "Parameters: a quaternion of length 0");
    for (int i = 0; !status && i < 9; i++) {
        r[i / 3][i % 3] *= square;
    }
    return status;
}

/* The matrix of an affine one. */
static conus_status itk_matrix(double out[16], const struct itk_entry *entry)
{
    const struct affine *affine = find_affine(entry->type);
    const double *p = entry->parameters;
    static const double zero[3] = {0, 0, 0};
    double r[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    if (entry->count != affine->count) {
        return fail(CONUS_ERROR_DATA, "Parameters: %zu numbers, %.*s has %zu", entry->count, (int)entry->type.size,
                    entry->type.data, affine->count);
    }
    conus_status status = check_fixed(entry, affine->fixed, affine->fixed_most);
    if (status) {
        return status;
    }
    switch (affine->linear) {
    case MATRIX:
        memcpy(r, p, sizeof r);
        break;
    case EULER:
        set_euler(r, p, entry->fixed_count == 4 && entry->fixed[3] != 0);
        break;
    case VERSOR:
        status = set_versor(r, p);
        for (int i = 0; affine->count == 7 && i < 9; i++) { /* with a scale */
            r[i / 3][i % 3] *= p[6];
        }
        break;
    case SKEWED:
        status = set_skewed(r, p);
        break;
    case QUATERNION:
        status = set_quaternion(r, p);
        break;
    case SCALE:
        for (int i = 0; i < 3; i++) {
            r[i][i] = p[i];
        }
        break;
    case IDENTITY:
        break;
    }
    if (!status) {
        itk_place(out, r, affine->fixed ? entry->fixed : zero,
                  affine->translation < affine->count ? p + affine->translation : zero);
    }
    return status;
}

/* The grid of a spline: fixed has its size, origin, spacing and, by rows, direction, of LPS. */
static conus_status spline_place(struct deformation *field, const double *fixed)
{
    mat4_identity(field->world_from_voxel);
    for (int a = 0; a < 3; a++) {
        if (!(fixed[a] >= 4 && fixed[a] <= UINT32_MAX && fixed[a] == floor(fixed[a]))) {
            return fail(CONUS_ERROR_DATA, "FixedParameters: size %g, 4 or more nodes are needed", fixed[a]);
        }
        if (!(fixed[6 + a] > 0)) {
            return fail(CONUS_ERROR_DATA, "FixedParameters: spacing %g, above 0 is needed", fixed[6 + a]);
        }
        field->dim[a] = (size_t)fixed[a];
        for (int row = 0; row < 3; row++) {
            field->world_from_voxel[4 * a + row] = flip[row] * fixed[9 + 3 * row + a] * fixed[6 + a];
        }
        field->world_from_voxel[12 + a] = flip[a] * fixed[3 + a];
    }
    return mat4_invert_affine(field->voxel_from_world, field->world_from_voxel)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "FixedParameters: the direction is singular");
}

static conus_status spline_make(struct deformation *out, const struct itk_entry *entry)
{
    struct deformation field = {.stays_outside = true};
    size_t count;
    conus_status status = check_fixed(entry, 18, 18);
    status = status ? status : spline_place(&field, entry->fixed);
    if (status) {
        return status;
    }
    bool fits = memory_multiply(field.dim[0], field.dim[1], &count) && memory_multiply(count, field.dim[2], &count) &&
                memory_multiply(count, 3, &count) && count == entry->count;
    if (!fits) {
        return fail(CONUS_ERROR_DATA, "Parameters: %zu numbers, a grid of %zu x %zu x %zu has 3 for each node",
                    entry->count, field.dim[0], field.dim[1], field.dim[2]);
    }
    memcpy(field.base, field.world_from_voxel, sizeof field.base);
    mat4_identity(field.linear);
    field.linear[0] = field.linear[5] = -1;
    field.coefficients = memory_copy(entry->parameters, count, sizeof *field.coefficients);
    status = field.coefficients ? deformation_measure(&field) : CONUS_ERROR_MEMORY;
    if (status) {
        deformation_finish(&field);
        return status;
    }
    *out = field;
    return CONUS_OK;
}

bool itk_is_composite(struct text name)
{
    return text_starts(name, "CompositeTransform_");
}

/* The transforms of a file, in its order. */
struct itk_list {
    struct itk_entry *items;
    size_t count, capacity;
};

static conus_status itk_list_add(struct itk_list *list, struct text type)
{
    if (!memory_reserve(&list->items, &list->capacity, list->count + 1, sizeof *list->items)) {
        return CONUS_ERROR_MEMORY;
    }
    list->items[list->count++] = (struct itk_entry){.type = type};
    return CONUS_OK;
}

static void itk_list_finish(struct itk_list *list)
{
    for (size_t i = 0; i < list->count; i++) {
        memory_free(list->items[i].parameters);
        memory_free(list->items[i].fixed);
    }
    memory_free(list->items);
    *list = (struct itk_list){0};
}

conus_status itk_chain_add(struct transform_chain *chain, const struct itk_entry *entry)
{
    double m[16];
    struct deformation field = {0};
    conus_status status = check_type(entry->type);
    if (!status && (!entry->has_parameters || !entry->has_fixed)) {
        status = fail(CONUS_ERROR_DATA, "%.*s: %s is missing", TEXT_SHOW(entry->type, 60),
                      entry->has_parameters ? "FixedParameters" : "Parameters");
    }
    if (status) {
        return status;
    }
    if (!is_spline(entry->type)) {
        status = itk_matrix(m, entry);
        return status ? status : chain_add_matrix(chain, m);
    }
    status = spline_make(&field, entry);
    status = status ? status : chain_push(chain, &field);
    deformation_finish(&field);
    return status;
}

static conus_status find_parts(size_t *first, size_t *end, const struct itk_list *list, size_t chosen)
{
    bool is_chain = list->count && itk_is_composite(list->items[0].type);
    *first = is_chain;
    *end = list->count;
    for (size_t i = *first; i < list->count; i++) {
        if (itk_is_composite(list->items[i].type)) {
            return fail(CONUS_ERROR_UNSUPPORTED, "Transform: a composite behind another transform");
        }
    }
    if (is_chain && (list->items[0].has_parameters || list->items[0].has_fixed)) {
        return fail(CONUS_ERROR_DATA, "Parameters: of a composite, which has none");
    }
    if (*first == *end) {
        return fail(CONUS_ERROR_DATA, "Transform: there is none");
    }
    if (chosen && (is_chain || chosen > list->count)) {
        return fail(CONUS_ERROR_ARGUMENT, "transform=%zu: %s", chosen - 1,
                    is_chain          ? "this is a composite, which is read as one"
                    : list->count > 1 ? "there are fewer, which count from 0"
                                      : "there is one, number 0");
    }
    if (!chosen && !is_chain && list->count > 1) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "Transform: a list of %zu, such as one for each volume of a series, and no CompositeTransform that "
                    "makes a chain of them; ',transform=K' chooses number K, from 0 to %zu",
                    list->count, list->count - 1);
    }
    *first = chosen ? chosen - 1 : *first;
    *end = chosen ? chosen : *end;
    return CONUS_OK;
}

static conus_status itk_chain_make(struct transform_chain *chain, const struct itk_list *list, size_t chosen)
{
    size_t first = 0;
    size_t end = 0;
    conus_status status = find_parts(&first, &end, list, chosen);
    for (size_t i = first; !status && i < end; i++) {
        status = itk_chain_add(chain, &list->items[i]);
    }
    return status ? status : chain_end(chain);
}

bool itk_text_is(struct text text)
{
    return text_starts(text, "#Insight Transform File V1.0");
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

static conus_status itk_take_numbers(double **out, size_t *count, struct text values, const char *key)
{
    struct text word;
    size_t capacity = 0;
    while (text_word(&values, &word)) {
        if (!memory_reserve(out, &capacity, *count + 1, sizeof **out)) {
            return CONUS_ERROR_MEMORY;
        }
        if (!text_to_double(word, &(*out)[*count]) || !isfinite((*out)[*count])) {
            return fail(CONUS_ERROR_DATA, "%s: \"%.*s\", finite numbers are needed", key, TEXT_SHOW(word, 40));
        }
        ++*count;
    }
    return CONUS_OK;
}

static conus_status itk_take_line(struct itk_list *list, struct text line)
{
    struct text values;
    if (!line.size || line.data[0] == '#') {
        return CONUS_OK;
    }
    if (itk_take_key(&values, line, "Transform")) {
        return values.size ? itk_list_add(list, values) : fail(CONUS_ERROR_DATA, "Transform: has no type");
    }
    struct itk_entry *entry = list->count ? &list->items[list->count - 1] : NULL;
    bool is_parameters = itk_take_key(&values, line, "Parameters");
    bool is_fixed = itk_take_key(&values, line, "FixedParameters");
    if (!entry && (is_parameters || is_fixed)) {
        return fail(CONUS_ERROR_DATA, "Parameters: without a line Transform");
    }
    if (is_parameters && !entry->has_parameters) {
        entry->has_parameters = true;
        return itk_take_numbers(&entry->parameters, &entry->count, values, "Parameters");
    }
    if (is_fixed && !entry->has_fixed) {
        entry->has_fixed = true;
        return itk_take_numbers(&entry->fixed, &entry->fixed_count, values, "FixedParameters");
    }
    return fail(CONUS_ERROR_DATA, "\"%.*s\": Transform, Parameters or FixedParameters is needed, each once",
                TEXT_SHOW(line, 40));
}

conus_status itk_text_parse(struct transform_chain *chain, struct text text, size_t chosen)
{
    struct text line;
    struct itk_list list = {0};
    conus_status status = CONUS_OK;
    while (!status && text_line(&text, &line)) {
        status = itk_take_line(&list, text_trim(line));
    }
    status = status ? status : itk_chain_make(chain, &list, chosen);
    itk_list_finish(&list);
    return status;
}

enum { MATLAB_HEAD = 20, NAME_LIMIT = 64 };

/* Type: thousands 1 = big-endian; tens 0 = double, 1 = float; both ends 0. */
static bool take_type(bool *swapped, bool *single, const uint8_t *data)
{
    uint32_t little = order_u32(data, BIG_ENDIAN_IS_SWAPPED ? false : true);
    uint32_t big = order_u32(data, BIG_ENDIAN_IS_SWAPPED);
    bool is_big = big == 1000 || big == 1010;
    uint32_t type = is_big ? big - 1000 : little;
    *swapped = is_big == BIG_ENDIAN_IS_SWAPPED;
    *single = type == 10;
    return type == 0 || type == 10;
}

/* Takes a matrix of one column, with its name. */
static conus_status take_column(struct text *column, double **out, size_t *count, const uint8_t **data, size_t *left)
{
    bool swapped;
    bool single;
    if (*left < MATLAB_HEAD || !take_type(&swapped, &single, *data)) {
        return fail(CONUS_ERROR_DATA, "no matrix of MATLAB's level 4 %zu bytes before the end", *left);
    }
    uint32_t rows = order_u32(*data + 4, swapped);
    uint32_t columns = order_u32(*data + 8, swapped);
    uint32_t imaginary = order_u32(*data + 12, swapped);
    uint32_t length = order_u32(*data + 16, swapped);
    size_t each = single ? 4 : 8;
    if (columns > 1 || imaginary || !length || length > NAME_LIMIT ||
        *left < MATLAB_HEAD + length + (size_t)rows * columns * each) {
        return fail(CONUS_ERROR_DATA, "a matrix of %u x %u and a name of %u bytes, %zu bytes before the end", rows,
                    columns, length, *left);
    }
    const char *name = (const char *)*data + MATLAB_HEAD;
    *column = (struct text){name, strnlen(name, length)};
    *count = (size_t)rows * columns;
    *out = memory_raw(*count + 1, sizeof **out);
    const uint8_t *values = *data + MATLAB_HEAD + length;
    for (size_t i = 0; *out && i < *count; i++) {
        (*out)[i] = single ? (double)order_f32(values + i * each, swapped) : order_f64(values + i * each, swapped);
        if (!isfinite((*out)[i])) {
            return fail(CONUS_ERROR_DATA, "%.*s: a number that is not finite", (int)column->size, name);
        }
    }
    size_t used = MATLAB_HEAD + length + *count * each;
    *data += used;
    *left -= used;
    return *out ? CONUS_OK : CONUS_ERROR_MEMORY;
}

bool itk_matlab_is(const uint8_t *data, size_t size)
{
    bool swapped;
    bool single;
    if (size < MATLAB_HEAD + 1 || !take_type(&swapped, &single, data)) {
        return false;
    }
    uint32_t length = order_u32(data + 16, swapped);
    return length && length <= NAME_LIMIT && data[MATLAB_HEAD] >= 'A' && data[MATLAB_HEAD] <= 'Z';
}

conus_status itk_matlab_parse(struct transform_chain *chain, const uint8_t *data, size_t size)
{
    struct itk_entry entry = {.has_parameters = true, .has_fixed = true};
    struct text fixed;
    const char *name = (const char *)data + MATLAB_HEAD;
    size_t left = size > MATLAB_HEAD ? size - MATLAB_HEAD : 0;
    const struct text type = {name, strnlen(name, left < NAME_LIMIT ? left : NAME_LIMIT)};
    conus_status status = text_mentions(type, "Transform_") ? check_type(type) : CONUS_OK;
    status = status ? status : take_column(&entry.type, &entry.parameters, &entry.count, &data, &size);
    status = status ? status : take_column(&fixed, &entry.fixed, &entry.fixed_count, &data, &size);
    if (!status && !text_equal(fixed, "fixed")) {
        status =
            fail(CONUS_ERROR_DATA, "\"%.*s\" behind the parameters, \"fixed\" is needed", (int)fixed.size, fixed.data);
    }
    if (!status && size) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "%zu bytes behind the first transform, one is read", size);
    }
    status = status ? status : itk_chain_make(chain, &(struct itk_list){.items = &entry, .count = 1}, 0);
    memory_free(entry.parameters);
    memory_free(entry.fixed);
    return status;
}
