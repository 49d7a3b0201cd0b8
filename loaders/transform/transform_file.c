/* SPDX-License-Identifier: BSD-3-Clause */
/* Says which format a transform is in, and reads it. */
#include "loaders/transform/transform_file.h"

#include "base/geometry/math3.h"
#include "loaders/file_kind.h"
#include "loaders/transform/transform_formats.h"
#include "loaders/volumes/nifti.h"
#include "loaders/volumes/volume_file.h"

#include <string.h>

conus_status matrix_rows_parse(double out[16], struct text *rest, size_t rows, const char *what)
{
    struct text line = {0};
    size_t row = 0;
    while (row < rows && text_line(rest, &line)) {
        struct text word;
        size_t column = 0;
        line = text_trim(line);
        if (!line.size || line.data[0] == '#') {
            continue;
        }
        while (text_word(&line, &word)) {
            if (row + 1 == rows && word.size && word.data[word.size - 1] == ';') {
                word.size--;
            }
            if (!word.size) {
                continue;
            }
            if (column == 4 || !text_to_double(word, &out[4 * column + row]) || !isfinite(out[4 * column + row])) {
                return fail(CONUS_ERROR_DATA, "%s: row %zu: \"%.*s\", four finite numbers are needed", what, row + 1,
                            TEXT_SHOW(word, 40));
            }
            column++;
        }
        if (column != 4) {
            return fail(CONUS_ERROR_DATA, "%s: row %zu: %zu numbers, four are needed", what, row + 1, column);
        }
        row++;
    }
    return row == rows ? CONUS_OK : fail(CONUS_ERROR_DATA, "%s: ends after %zu rows, %zu are needed", what, row, rows);
}

conus_status matrix_settle(double m[16], const char *what)
{
    return mat4_settle_last_row(m) ? CONUS_OK
                                   : fail(CONUS_ERROR_DATA, "%s: last row %.9g %.9g %.9g %.9g, 0 0 0 1 is needed", what,
                                          m[3], m[7], m[11], m[15]);
}

static bool is_blank_or_comment(struct text line)
{
    line = text_trim(line);
    return !line.size || line.data[0] == '#';
}

static bool matrix_text_is(struct text text)
{
    struct text line;
    struct text word;
    double number;
    while (text_line(&text, &line)) {
        if (!is_blank_or_comment(line)) {
            return text_word(&line, &word) && text_to_double(word, &number);
        }
    }
    return false;
}

/* Sixteen numbers, four in a line, the last line 0 0 0 1; lines that begin with # are comments. */
static conus_status matrix_text_parse(double out[16], struct text text)
{
    struct text line;
    conus_status status = matrix_rows_parse(out, &text, 4, "matrix");
    while (!status && text_line(&text, &line)) {
        if (!is_blank_or_comment(line)) {
            status = fail(CONUS_ERROR_DATA, "matrix: more than four rows");
        }
    }
    return status ? status : matrix_settle(out, "matrix");
}

static bool xfm_is(struct text text)
{
    return text_starts(text, "MNI Transform File");
}

/* The MNI's. */
static conus_status xfm_parse(double out[16], struct text text)
{
    struct text line;
    bool linear = false;
    bool found = false;
    while (!found && text_line(&text, &line)) {
        line = text_trim(line);
        linear = linear || (text_starts(line, "Transform_Type") && text_mentions(line, "Linear;"));
        found = text_starts(line, "Linear_Transform");
        if (text_starts(line, "Transform_Type") && !text_mentions(line, "Linear;")) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%.*s: only Linear is read", TEXT_SHOW(line, 60));
        }
    }
    if (!linear || !found) {
        return fail(CONUS_ERROR_DATA, "%s is missing", linear ? "Linear_Transform" : "Transform_Type = Linear;");
    }
    double m[16];
    mat4_identity(m);
    conus_status status = matrix_rows_parse(m, &text, 3, "Linear_Transform");
    if (!status && text_mentions(text, "Transform_Type")) {
        status = fail(CONUS_ERROR_UNSUPPORTED, "several transforms in one file, one is read");
    }
    if (!status) {
        memcpy(out, m, sizeof m);
    }
    return status;
}

enum { TRANSFORM_LIMIT = 1 << 20 }; /* bytes: a hundred times what an affine takes */

static const char transform_needed[] = "an affine transform (ITK's text or .mat, FreeSurfer's .lta, the MNI's .xfm, "
                                       "FSL's matrix, or 4 x 4 numbers), or a deformation field (NIfTI)";

void flirt_from_voxel(double out[16], const conus_volume_info *info)
{
    mat4_identity(out);
    for (int a = 0; a < 3; a++) {
        out[5 * a] = info->spacing[a];
    }
    if (mat4_determinant3(info->world_from_voxel) > 0) {
        out[0] = -info->spacing[0];
        out[12] = info->spacing[0] * (double)(info->dim[0] - 1);
    }
}

static conus_status flirt_from_world(double out[16], const conus_volume_info *info)
{
    double flirt[16];
    double voxel_from_world[16];
    flirt_from_voxel(flirt, info);
    if (!mat4_invert_affine(voxel_from_world, info->world_from_voxel)) {
        return fail(CONUS_ERROR_DATA, "the matrix of an image is singular");
    }
    mat4_multiply(out, flirt, voxel_from_world);
    return CONUS_OK;
}

/* From FLIRT's matrix of both images' coordinates to one of RAS. */
static conus_status place_between(double m[16], const char *from, const char *to)
{
    conus_volume_info images[2];
    double from_world[16];
    double to_world[16];
    double world_from_to[16];
    conus_status status = volume_file_header(&images[0], from);
    status = status ? status : volume_file_header(&images[1], to);
    status = status ? status : flirt_from_world(from_world, &images[0]);
    status = status ? status : flirt_from_world(to_world, &images[1]);
    if (!status && !mat4_invert_affine(world_from_to, to_world)) {
        status = fail(CONUS_ERROR_DATA, "%s: its matrix is singular", to);
    }
    if (!status) {
        mat4_multiply(m, m, from_world);
        mat4_multiply(m, world_from_to, m);
    }
    return status;
}

static conus_status read_matrix(double out[16], struct text text, const char *path, const char *from, const char *to)
{
    size_t length = strlen(path);
    bool is_fsl = length > 4 && strcmp(path + length - 4, ".mat") == 0;
    conus_status status = matrix_text_parse(out, text);
    if (!status && !from && is_fsl) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "a matrix of FSL's kind, whose numbers mean nothing without its two images: from=IMAGE and "
                    "to=IMAGE are needed; a 4 x 4 matrix of RAS mm ends otherwise, in .txt for example");
    }
    return status || !from ? status : place_between(out, from, to);
}

enum kind { KIND_NONE, KIND_MATRIX, KIND_ITK, KIND_XFM, KIND_LTA, KIND_MATLAB };

static enum kind kind_of(const struct bytes *file, struct text text)
{
    bool readable = text_is_readable(text);
    return readable && matrix_text_is(text)        ? KIND_MATRIX
           : readable && itk_text_is(text)         ? KIND_ITK
           : readable && xfm_is(text)              ? KIND_XFM
           : readable && lta_is(text)              ? KIND_LTA
           : itk_matlab_is(file->data, file->size) ? KIND_MATLAB
                                                   : KIND_NONE;
}

/* FreeSurfer's register.dat: a name, three numbers in a line each, and four rows. */
static bool is_register_dat(struct text text)
{
    struct text line;
    double number;
    bool is = text_line(&text, &line) && !text_to_double(text_trim(line), &number);
    for (int i = 0; is && i < 3; i++) {
        is = text_line(&text, &line) && text_to_double(text_trim(line), &number);
    }
    return is && matrix_text_is(text);
}

/* Says what the file is instead of a transform that can be read. */
static conus_status fail_kind(const char *path, const struct bytes *file)
{
    static const struct {
        const char *begin, *words;
        const char *tail; /* behind the path; NULL = neither */
    } kinds[] = {
        {"\x89HDF\r\n\x1a\n",
         "an HDF5 file, which is not read; ANTs takes a composite apart, into PREFIX and the like: "
         "CompositeTransformUtil --disassemble ",
         " PREFIX"},
        {"MATLAB 5.0",
         "a MATLAB file of level 5, which is not read as a transform; ITK's (level 4, as "
         "out_0GenericAffine.mat) and 4 x 4 numbers of RAS mm as text are",
         NULL},
        {"(Transform ",
         "elastix's parameters, which are not read; with (WriteITKCompositeTransform \"true\") and "
         "(ITKTransformOutputFileNameExtension \"tfm\") among its own, elastix writes ITK's text",
         NULL},
        {"/NumWaves", "a design matrix of FSL's statistics, and no transform", NULL},
    };
    const struct text text = {(const char *)file->data, file->size};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (text_starts(text, kinds[i].begin) || (kinds[i].begin[0] == '(' && text_mentions(text, "\n(Transform "))) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%s%s%s", kinds[i].words, kinds[i].tail ? path : "",
                        kinds[i].tail ? kinds[i].tail : "");
        }
    }
    return text_is_readable(text) && is_register_dat(text)
               ? fail(CONUS_ERROR_UNSUPPORTED, "FreeSurfer's register.dat, whose numbers mean nothing without its two "
                                               "images; an .lta of it is read: "
                                               "lta_convert --inreg FILE --outlta OUT.lta --src IMAGE --trg IMAGE")
               : file_kind_fail(path, file, transform_needed);
}

static conus_status parse_kind(double out[16], const struct bytes *file, const char *path, const char *from,
                               const char *to)
{
    struct text text = text_from_bytes(file->data, file->size);
    switch (kind_of(file, text)) {
    case KIND_MATRIX:
        return read_matrix(out, text, path, from, to);
    case KIND_ITK:
        return itk_text_parse(out, text);
    case KIND_XFM:
        return xfm_parse(out, text);
    case KIND_LTA:
        return lta_parse(out, text);
    case KIND_MATLAB:
        return itk_matlab_parse(out, file->data, file->size);
    case KIND_NONE:
        break;
    }
    return fail_kind(path, file);
}

conus_status transform_parse(double out[16], const struct bytes *file, const char *path, const char *from,
                             const char *to)
{
    enum kind kind = kind_of(file, text_from_bytes(file->data, file->size));
    double m[16] = {0};
    double inverse[16];
    if (!from != !to) {
        return fail(CONUS_ERROR_ARGUMENT, "%s=IMAGE is needed, too", from ? "to" : "from");
    }
    if (from && kind != KIND_MATRIX && kind != KIND_NONE) {
        return fail(CONUS_ERROR_ARGUMENT, "from and to are of FSL's matrices, and this is none");
    }
    conus_status status = parse_kind(m, file, path, from, to);
    if (!status && !mat4_invert_affine(inverse, m)) {
        status = fail(CONUS_ERROR_DATA, "the matrix is singular, an invertible one is needed");
    }
    if (!status) {
        memcpy(out, m, sizeof m);
    }
    return status;
}

conus_status transform_file_read(double out[16], const char *path, const char *from, const char *to,
                                 struct file_sums *read)
{
    struct bytes file = {0};
    double m[16];
    conus_status status = file_read_head(&file, path, TRANSFORM_LIMIT);
    if (status) {
        return status;
    }
    status = file.size == TRANSFORM_LIMIT ? fail_kind(path, &file) : transform_parse(m, &file, path, from, to);
    status = status ? fail_in(status, path) : file_sums_add(read, path, &file);
    bytes_finish(&file);
    if (!status) {
        memcpy(out, m, sizeof m);
    }
    return status;
}
