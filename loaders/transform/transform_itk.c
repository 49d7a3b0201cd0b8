/* SPDX-License-Identifier: BSD-3-Clause */
/* Affine transforms of ITK, as text and as MATLAB's level 4. The classes' parameters are documented in ITK's reference:
 * itk::MatrixOffsetTransformBase, itk::Euler3DTransform, itk::VersorRigid3DTransform, itk::Similarity3DTransform. */
#include "loaders/transform/transform_formats.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"

enum { PARAMETERS_LIMIT = 16 };

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
    static const double flip[3] = {-1, -1, 1};
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
static bool is_type(struct text name, const char *type)
{
    size_t length = strlen(type);
    return name.size > length + 4 && text_starts(name, type) && name.data[length] == '_' &&
           memcmp(name.data + name.size - 4, "_3_3", 4) == 0;
}

static conus_status check_counts(struct text name, size_t count, size_t wanted, size_t fixed, size_t fixed_wanted,
                                 size_t fixed_most)
{
    if (count != wanted) {
        return fail(CONUS_ERROR_DATA, "Parameters: %zu numbers, %.*s has %zu", count, (int)name.size, name.data,
                    wanted);
    }
    return fixed >= fixed_wanted && fixed <= fixed_most
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "FixedParameters: %zu numbers, %.*s has %zu", fixed, (int)name.size, name.data,
                      fixed_wanted);
}

/* CONUS_OK for the types that itk_matrix() knows. */
static conus_status check_type(struct text name)
{
    static const char *const read[] = {"AffineTransform",      "MatrixOffsetTransformBase", "Rigid3DTransform",
                                       "Euler3DTransform",     "VersorRigid3DTransform",    "Similarity3DTransform",
                                       "TranslationTransform", "IdentityTransform"};
    bool found = false;
    for (size_t i = 0; i < sizeof read / sizeof read[0]; i++) {
        found = found || is_type(name, read[i]);
    }
    int size = (int)(name.size < 60 ? name.size : 60);
    if (!found && (text_mentions(name, "BSpline") || text_mentions(name, "DisplacementField"))) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "Transform: %.*s, a %s, is not read; write it as a displacement field in NIfTI, by 3D Slicer's "
                    "Transforms, Convert, or by ANTs: antsApplyTransforms -d 3 -r IMAGE -t FILE -o [FIELD.nii.gz,1]",
                    size, name.data, text_mentions(name, "BSpline") ? "B-spline" : "field in ITK's own format");
    }
    return found ? CONUS_OK
                 : fail(CONUS_ERROR_UNSUPPORTED,
                        "Transform: %.*s; read are Affine, MatrixOffsetBase, Rigid3D, Euler3D, VersorRigid3D, "
                        "Similarity3D, Translation and Identity, and composites of them",
                        size, name.data);
}

/* The matrix of an ITK transform of type `name`. */
static conus_status itk_matrix(double out[16], struct text name, const double *p, size_t count, const double *fixed,
                               size_t fixed_count)
{
    static const double zero[3] = {0, 0, 0};
    double r[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const double *t = p + 9;
    conus_status status = check_type(name);
    if (status) {
        return status;
    }
    if (is_type(name, "Euler3DTransform")) {
        status = check_counts(name, count, 6, fixed_count, 3, 4);
        t = p + 3;
        if (!status) {
            set_euler(r, p, fixed_count == 4 && fixed[3] != 0);
        }
    } else if (is_type(name, "VersorRigid3DTransform") || is_type(name, "Similarity3DTransform")) {
        bool scaled = is_type(name, "Similarity3DTransform");
        status = check_counts(name, count, scaled ? 7 : 6, fixed_count, 3, 3);
        status = status ? status : set_versor(r, p);
        t = p + 3;
        for (int i = 0; !status && scaled && i < 9; i++) {
            r[i / 3][i % 3] *= p[6];
        }
    } else if (is_type(name, "TranslationTransform")) {
        status = check_counts(name, count, 3, fixed_count, 0, 0);
        t = p;
    } else if (is_type(name, "IdentityTransform")) {
        status = check_counts(name, count, 0, fixed_count, 0, 0);
        t = zero;
    } else { /* a matrix and a translation */
        status = check_counts(name, count, 12, fixed_count, 3, 3);
        for (int i = 0; !status && i < 9; i++) {
            r[i / 3][i % 3] = p[i];
        }
    }
    if (!status) {
        itk_place(out, r, fixed_count >= 3 ? fixed : zero, t);
    }
    return status;
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

static conus_status itk_take_numbers(double out[PARAMETERS_LIMIT], size_t *count, struct text values, const char *key)
{
    struct text word;
    for (*count = 0; text_word(&values, &word); ++*count) {
        if (*count == PARAMETERS_LIMIT || !text_to_double(word, &out[*count]) || !isfinite(out[*count])) {
            return fail(CONUS_ERROR_DATA, "%s: \"%.*s\", up to %d finite numbers are needed", key, TEXT_SHOW(word, 40),
                        PARAMETERS_LIMIT);
        }
    }
    return CONUS_OK;
}

/* One transform of a file. */
struct itk_entry {
    struct text name; /* empty = none yet */
    double parameters[PARAMETERS_LIMIT], fixed[PARAMETERS_LIMIT];
    size_t count, fixed_count;
    bool has_parameters, has_fixed;
};

static bool is_composite(struct text name)
{
    return text_starts(name, "CompositeTransform_");
}

/* Puts what the entry does before what is there: points go through the last entry first. */
static conus_status close_entry(double out[16], struct itk_entry *entry)
{
    double m[16];
    if (!entry->name.size || is_composite(entry->name)) {
        return entry->has_parameters || entry->has_fixed
                   ? fail(CONUS_ERROR_DATA, "Parameters: without a line Transform, or of a composite")
                   : CONUS_OK;
    }
    if (!entry->has_parameters || !entry->has_fixed) {
        return fail(CONUS_ERROR_DATA, "%.*s: %s is missing", TEXT_SHOW(entry->name, 60),
                    entry->has_parameters ? "FixedParameters" : "Parameters");
    }
    conus_status status = itk_matrix(m, entry->name, entry->parameters, entry->count, entry->fixed, entry->fixed_count);
    if (!status) {
        mat4_multiply(out, out, m);
    }
    return status;
}

static conus_status itk_take_line(double out[16], struct itk_entry *entry, struct text line)
{
    struct text values;
    conus_status status = CONUS_OK;
    if (!line.size || line.data[0] == '#') {
        return CONUS_OK;
    }
    if (itk_take_key(&values, line, "Transform")) {
        status = close_entry(out, entry);
        *entry = (struct itk_entry){.name = values};
        status = status || values.size ? status : fail(CONUS_ERROR_DATA, "Transform: has no type");
        return status || is_composite(values) ? status : check_type(values);
    }
    if (itk_take_key(&values, line, "Parameters") && !entry->has_parameters) {
        entry->has_parameters = true;
        return itk_take_numbers(entry->parameters, &entry->count, values, "Parameters");
    }
    if (itk_take_key(&values, line, "FixedParameters") && !entry->has_fixed) {
        entry->has_fixed = true;
        return itk_take_numbers(entry->fixed, &entry->fixed_count, values, "FixedParameters");
    }
    return fail(CONUS_ERROR_DATA, "\"%.*s\": Transform, Parameters or FixedParameters is needed, each once",
                TEXT_SHOW(line, 40));
}

conus_status itk_text_parse(double out[16], struct text text)
{
    struct text line;
    struct itk_entry entry = {0};
    double m[16];
    size_t count = 0;
    bool is_chain = false;
    conus_status status = CONUS_OK;
    mat4_identity(m);
    while (!status && text_line(&text, &line)) {
        line = text_trim(line);
        status = itk_take_line(m, &entry, line);
        is_chain = is_chain || is_composite(entry.name);
        count += text_starts(line, "Transform:") && !is_composite(entry.name);
    }
    status = status ? status : close_entry(m, &entry);
    if (!status && !count) {
        status = fail(CONUS_ERROR_DATA, "Transform: there is none");
    }
    if (!status && count > 1 && !is_chain) {
        status =
            fail(CONUS_ERROR_UNSUPPORTED,
                 "Transform: a list of %zu, such as one for each volume of a series, and no CompositeTransform that"
                 " makes a chain of them; a file with the one that is meant is needed",
                 count);
    }
    if (!status) {
        memcpy(out, m, sizeof m);
    }
    return status;
}

enum { MATLAB_HEAD = 20, NAME_LIMIT = 64 };

/* A matrix of one column. */
struct matlab_column {
    struct text name;
    double values[PARAMETERS_LIMIT];
    size_t count;
};

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

static conus_status take_column(struct matlab_column *out, const uint8_t **data, size_t *left)
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
    if (rows > PARAMETERS_LIMIT || columns > 1 || imaginary || !length || length > NAME_LIMIT ||
        *left < MATLAB_HEAD + length + rows * columns * each) {
        return fail(CONUS_ERROR_DATA, "a matrix of %u x %u and a name of %u bytes, %zu bytes before the end", rows,
                    columns, length, *left);
    }
    const char *name = (const char *)*data + MATLAB_HEAD;
    out->name = (struct text){name, strnlen(name, length)};
    out->count = (size_t)rows * columns;
    const uint8_t *values = *data + MATLAB_HEAD + length;
    for (size_t i = 0; i < out->count; i++) {
        out->values[i] = single ? (double)order_f32(values + i * each, swapped) : order_f64(values + i * each, swapped);
        if (!isfinite(out->values[i])) {
            return fail(CONUS_ERROR_DATA, "%.*s: a number that is not finite", (int)out->name.size, name);
        }
    }
    size_t used = MATLAB_HEAD + length + out->count * each;
    *data += used;
    *left -= used;
    return CONUS_OK;
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

conus_status itk_matlab_parse(double out[16], const uint8_t *data, size_t size)
{
    struct matlab_column parameters;
    struct matlab_column fixed;
    const char *name = (const char *)data + MATLAB_HEAD;
    size_t left = size > MATLAB_HEAD ? size - MATLAB_HEAD : 0;
    const struct text type = {name, strnlen(name, left < NAME_LIMIT ? left : NAME_LIMIT)};
    conus_status status;
    if ((text_mentions(type, "Transform_") && (status = check_type(type))) ||
        (status = take_column(&parameters, &data, &size)) || (status = take_column(&fixed, &data, &size))) {
        return status;
    }
    if (!text_equal(fixed.name, "fixed")) {
        return fail(CONUS_ERROR_DATA, "\"%.*s\" behind the parameters, \"fixed\" is needed", (int)fixed.name.size,
                    fixed.name.data);
    }
    if (size) {
        return fail(CONUS_ERROR_UNSUPPORTED, "%zu bytes behind the first transform, one is read", size);
    }
    return itk_matrix(out, parameters.name, parameters.values, parameters.count, fixed.values, fixed.count);
}
