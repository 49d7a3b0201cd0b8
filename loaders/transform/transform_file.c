/* SPDX-License-Identifier: BSD-3-Clause */
/* Says which format a transform is in, and reads it. */
#include "loaders/transform/transform_file.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/refuse.h"
#include "loaders/transform/transform_formats.h"
#include "loaders/volumes/nifti.h"
#include "loaders/volumes/volume_file.h"

#include <string.h>

/* The next line that is no comment, without white space around it. */
static bool next_line(struct text *rest, struct text *line)
{
    while (text_line(rest, line)) {
        *line = text_trim(*line);
        if (line->size && line->data[0] != '#') {
            return true;
        }
    }
    return false;
}

/* Takes the next `rows` lines of four numbers off `rest`, row by row into `out`; `what` is for messages. */
static conus_status matrix_rows_parse(double out[16], struct text *rest, size_t rows, const char *what)
{
    struct text line = {0};
    size_t row = 0;
    while (row < rows && next_line(rest, &line)) {
        struct text word;
        size_t column = 0;
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

/* Settles the last row (mat4_settle_last_row()), CONUS_ERROR_DATA where it is another than 0 0 0 1; `what` is for
 * messages. */
static conus_status matrix_settle(double m[16], const char *what)
{
    return mat4_settle_last_row(m) ? CONUS_OK
                                   : fail(CONUS_ERROR_DATA, "%s: last row %.9g %.9g %.9g %.9g, 0 0 0 1 is needed", what,
                                          m[3], m[7], m[11], m[15]);
}

static bool matrix_text_is(struct text text)
{
    struct text line;
    struct text word;
    double number;
    return next_line(&text, &line) && text_word(&line, &word) && text_to_double(word, &number);
}

/* Goes over the lines before the next matrix of the MNI's text; *found: there is one. */
static conus_status xfm_take_head(bool *found, bool *invert, struct text *rest)
{
    struct text line;
    bool linear = false;
    *found = *invert = false;
    while (!*found && text_line(rest, &line)) {
        line = text_trim(line);
        if (!line.size || line.data[0] == '%' || text_starts(line, "MNI Transform File")) {
            continue;
        }
        if (text_starts(line, "Transform_Type") && !text_mentions(line, "Linear;")) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%.*s: only Linear is read", TEXT_SHOW(line, 60));
        }
        *invert = *invert || (text_starts(line, "Invert_Flag") && text_mentions(line, "True"));
        linear = linear || text_starts(line, "Transform_Type");
        *found = text_starts(line, "Linear_Transform");
        if (!*found && !text_starts(line, "Transform_Type") && !text_starts(line, "Invert_Flag")) {
            return fail(CONUS_ERROR_DATA, "\"%.*s\": not a line of the MNI's transforms", TEXT_SHOW(line, 60));
        }
    }
    return *found == linear
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "%s is missing", linear ? "Linear_Transform" : "Transform_Type = Linear;");
}

/* The MNI's: the first transform of several comes first. */
static conus_status xfm_parse(double out[16], struct text text)
{
    double all[16];
    double m[16];
    bool found = false;
    bool invert = false;
    size_t count = 0;
    mat4_identity(all);
    conus_status status = xfm_take_head(&found, &invert, &text);
    for (; !status && found; count++) {
        mat4_identity(m);
        status = matrix_rows_parse(m, &text, 3, "Linear_Transform");
        if (!status && invert && !mat4_invert_affine(m, m)) {
            status = fail(CONUS_ERROR_DATA, "the matrix is singular, an invertible one is needed");
        }
        mat4_multiply(all, m, all);
        status = status ? status : xfm_take_head(&found, &invert, &text);
    }
    if (!status && !count) {
        status = fail(CONUS_ERROR_DATA, "Transform_Type = Linear; is missing");
    }
    if (!status) {
        memcpy(out, all, sizeof all);
    }
    return status;
}

enum { AFFINE_LIMIT = 1 << 20 }; /* bytes: a hundred times what an affine takes */

static const char transform_needed[] =
    "an affine transform (ITK's text or .mat, FreeSurfer's .lta or register.dat, the "
    "MNI's .xfm, FSL's matrix, or 4 x 4 numbers), a B-spline (ITK's), or a "
    "deformation field (NIfTI)";

/* FreeSurfer's linear transforms (.lta): a matrix from source to destination, between their voxels or in RAS mm. */

enum { VOXEL_TO_VOXEL = 0, RAS_TO_RAS = 1 };

/* The geometry of one of the two images. */
struct lta_volume {
    bool has[7]; /* as the keys of take_volume_line() */
    double valid, size[3], voxel[3], axis[3][3], centre[3];
};

static bool lta_is(struct text text)
{
    struct text line;
    return next_line(&text, &line) && text_starts(line, "type") && text_mentions(line, "=");
}

/* "KEY = a b c # comment"; false for another line. */
static bool lta_take_key(struct text *values, struct text line, const char *key)
{
    struct text word;
    struct text rest = line;
    if (!text_word(&rest, &word) || !text_equal(word, key) || !text_word(&rest, &word) || !text_equal(word, "=")) {
        return false;
    }
    *values = rest;
    for (size_t i = 0; i < values->size; i++) {
        values->size = values->data[i] == '#' ? i : values->size;
    }
    return true;
}

static conus_status lta_take_numbers(double *out, size_t count, struct text values, const char *key)
{
    struct text word;
    for (size_t i = 0; i < count; i++) {
        bool there = text_word(&values, &word);
        word.size -= there && i + 1 < count && word.data[word.size - 1] == ','; /* FastSurfer's "256, 256, 256" */
        if (!there || !text_to_double(word, &out[i]) || !isfinite(out[i])) {
            return fail(CONUS_ERROR_DATA, "%s: %zu finite numbers are needed", key, count);
        }
    }
    return text_word(&values, &word) ? fail(CONUS_ERROR_DATA, "%s: more than %zu numbers", key, count) : CONUS_OK;
}

/* Lines that say nothing of places. */
static conus_status pass_line(struct text line)
{
    struct text word = {0};
    struct text rest = line;
    (void)text_word(&rest, &word);
    return text_is_one_of(word, "filename/subject/fscale/mean/sigma", true)
               ? CONUS_OK
               : fail(CONUS_ERROR_DATA, "found the line \"%.*s\", which is not known", TEXT_SHOW(line, 40));
}

static conus_status take_volume_line(struct lta_volume *out, struct text line)
{
    const struct {
        const char *key;
        double *numbers;
        size_t count;
    } keys[] = {
        {"valid", &out->valid, 1}, {"volume", out->size, 3},  {"voxelsize", out->voxel, 3}, {"cras", out->centre, 3},
        {"xras", out->axis[0], 3}, {"yras", out->axis[1], 3}, {"zras", out->axis[2], 3},
    };
    struct text values;
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        if (lta_take_key(&values, line, keys[i].key)) {
            out->has[i] = true;
            return lta_take_numbers(keys[i].numbers, keys[i].count, values, keys[i].key);
        }
    }
    return pass_line(line);
}

/* cras is the middle of the voxels: of 256 of them voxel 128's. */
static conus_status world_from_voxel(double out[16], const struct lta_volume *volume, const char *which)
{
    bool whole = volume->valid == 1;
    for (size_t i = 0; i < sizeof volume->has; i++) {
        whole = whole && volume->has[i];
    }
    if (!whole) {
        return fail(CONUS_ERROR_DATA, "%s volume info: not valid or not whole, but the matrix is between voxels",
                    which);
    }
    mat4_identity(out);
    double middle[3];
    for (int a = 0; a < 3; a++) {
        middle[a] = volume->size[a] / 2;
        vec3_scale(out + 4 * a, volume->axis[a], volume->voxel[a]);
    }
    mat4_direction(middle, out, middle);
    vec3_sub(out + 12, volume->centre, middle);
    return CONUS_OK;
}

static conus_status take_head(double *type, struct text *rest)
{
    struct text line;
    struct text values;
    double count = -1;
    double shape[3] = {0};
    conus_status status = CONUS_OK;
    *type = -1;
    while (!status && next_line(rest, &line)) {
        if (lta_take_key(&values, line, "type")) {
            status = lta_take_numbers(type, 1, values, "type");
        } else if (lta_take_key(&values, line, "nxforms")) {
            status = lta_take_numbers(&count, 1, values, "nxforms");
        } else if (line.data[0] >= '0' && line.data[0] <= '9') {
            status = lta_take_numbers(shape, 3, line, "shape of the matrix");
            break;
        } else {
            status = pass_line(line);
        }
    }
    if (!status && *type != VOXEL_TO_VOXEL && *type != RAS_TO_RAS) {
        return fail(CONUS_ERROR_UNSUPPORTED, "type: %g, 0 (between voxels) and 1 (RAS to RAS) are read", *type);
    }
    if (!status && (count != 1 || shape[0] != 1 || shape[1] != 4 || shape[2] != 4)) {
        return fail(CONUS_ERROR_UNSUPPORTED, "nxforms: one matrix of 4 x 4 is read");
    }
    return status;
}

static conus_status lta_parse(double out[16], struct text text)
{
    struct lta_volume volumes[2] = {0};
    struct lta_volume *at = NULL;
    struct text line;
    double m[16];
    double type;
    conus_status status;
    if ((status = take_head(&type, &text)) || (status = matrix_rows_parse(m, &text, 4, "matrix")) ||
        (status = matrix_settle(m, "matrix"))) {
        return status;
    }
    while (next_line(&text, &line)) {
        if (text_starts(line, "src volume info") || text_starts(line, "dst volume info")) {
            at = &volumes[line.data[0] == 'd'];
        } else if ((status = at ? take_volume_line(at, line) : pass_line(line))) {
            return status;
        }
    }
    if (type == VOXEL_TO_VOXEL) {
        double from[16];
        double to[16];
        double voxel_from_world[16];
        if ((status = world_from_voxel(from, &volumes[0], "src")) ||
            (status = world_from_voxel(to, &volumes[1], "dst"))) {
            return status;
        }
        if (!mat4_invert_affine(voxel_from_world, from)) {
            return fail(CONUS_ERROR_DATA, "src volume info: its matrix is singular");
        }
        mat4_multiply(m, to, m);
        mat4_multiply(m, m, voxel_from_world);
    }
    memcpy(out, m, sizeof m);
    return CONUS_OK;
}

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

/* FreeSurfer's coordinates of surfaces ("tkregister RAS") of a voxel: axes as if the volume were conformed, the index
 * dim / 2 at 0. */
static void tkregister_from_voxel(double out[16], const conus_volume_info *info)
{
    static const int rows[3] = {0, 2, 1}; /* i runs along -x, j along -z, k along y */
    memset(out, 0, 16 * sizeof *out);
    for (int a = 0; a < 3; a++) {
        double step = a == 2 ? info->spacing[a] : -info->spacing[a];
        out[4 * a + rows[a]] = step;
        out[12 + rows[a]] = -step * (double)info->dim[a] / 2;
    }
    out[15] = 1;
}

/* How a program counts mm in an image, from voxels on. */
typedef void from_voxel(double out[16], const conus_volume_info *info);

static conus_status image_from_world(double out[16], const conus_volume_info *info, from_voxel *from)
{
    double voxel_from_world[16];
    if (!mat4_invert_affine(voxel_from_world, info->world_from_voxel)) {
        return fail(CONUS_ERROR_DATA, "the matrix of an image is singular");
    }
    from(out, info);
    mat4_multiply(out, out, voxel_from_world);
    return CONUS_OK;
}

/* From a matrix of both images' coordinates, as `coordinates` has them, to one of RAS. */
static conus_status place_between(double m[16], const conus_volume_info images[2], from_voxel *coordinates)
{
    double from_world[16];
    double to_world[16];
    double world_from_to[16];
    conus_status status = image_from_world(from_world, &images[0], coordinates);
    status = status ? status : image_from_world(to_world, &images[1], coordinates);
    if (status) {
        return status;
    }
    if (!mat4_invert_affine(world_from_to, to_world)) {
        return fail(CONUS_ERROR_DATA, "the matrix of an image is singular");
    }
    mat4_multiply(m, m, from_world);
    mat4_multiply(m, world_from_to, m);
    return CONUS_OK;
}

static conus_status read_images(conus_volume_info images[2], const char *from, const char *to)
{
    conus_status status = volume_file_header(&images[0], from);
    return status ? status : volume_file_header(&images[1], to);
}

/* FreeSurfer's register.dat: a name, voxels' edges of the movable volume in its planes and between them, an intensity,
 * a matrix, and how voxels are rounded, which moves no points. */
static bool register_take_head(struct text *rest, double edges[2])
{
    struct text line;
    double numbers[3] = {0};
    bool is_head = text_line(rest, &line) && text_trim(line).size && !text_to_double(text_trim(line), &numbers[0]);
    for (int i = 0; is_head && i < 3; i++) {
        is_head = text_line(rest, &line) && text_to_double(text_trim(line), &numbers[i]);
    }
    memcpy(edges, numbers, 2 * sizeof *edges);
    return is_head && matrix_text_is(*rest);
}

static bool has_edges(const conus_volume_info *image, const double edges[2])
{
    return fabs(image->spacing[0] - edges[0]) <= 0.01 * edges[0] &&
           fabs(image->spacing[2] - edges[1]) <= 0.01 * edges[1];
}

/* The matrix takes points of the anatomical volume to the movable one, each in its own tkregister RAS. */
static conus_status register_parse(double out[16], struct text text, const char *from, const char *to)
{
    conus_volume_info images[2];
    double edges[2];
    struct text line = {0};
    (void)register_take_head(&text, edges); /* which was asked before */
    conus_status status = matrix_rows_parse(out, &text, 4, "matrix");
    status = status ? status : matrix_settle(out, "matrix");
    if (!status && next_line(&text, &line) && next_line(&text, &line)) {
        status = fail(CONUS_ERROR_DATA, "\"%.*s\" behind the matrix and a word", TEXT_SHOW(line, 40));
    }
    if (!status && !from) {
        status = fail(CONUS_ERROR_ARGUMENT,
                      "FreeSurfer's register.dat, whose numbers mean nothing without its two images: from=IMAGE, the "
                      "anatomical one, and to=IMAGE, the movable one, are needed");
    }
    status = status ? status : read_images(images, from, to);
    if (!status && has_edges(&images[0], edges) && !has_edges(&images[1], edges)) {
        status = fail(CONUS_ERROR_ARGUMENT,
                      "voxels of the movable image are %g mm and %g mm apart, as those of from are, and not those of "
                      "to: from is the anatomical image",
                      edges[0], edges[1]);
    }
    return status ? status : place_between(out, images, tkregister_from_voxel);
}

static size_t count_words(struct text text)
{
    struct text line = {0};
    struct text word;
    size_t count = 0;
    (void)next_line(&text, &line);
    while (text_word(&line, &word)) {
        count++;
    }
    return count;
}

/* Sixteen numbers, four in a line, the last line 0 0 0 1; lines that begin with # are comments. */
static conus_status transform_read_matrix(double out[16], struct text text, const char *path, const char *from,
                                          const char *to)
{
    conus_volume_info images[2];
    size_t length = strlen(path);
    bool is_fsl = length > 4 && strcmp(path + length - 4, ".mat") == 0;
    struct text line;
    if (count_words(text) == 12) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "12 numbers in a line, a matrix of AFNI's (.aff12.1D), which is in LPS: needed are 4 x 4 numbers "
                    "in RAS: a b -c -d, e f -g -h, -i -j k l, 0 0 0 1 of its a to l");
    }
    conus_status status = matrix_rows_parse(out, &text, 4, "matrix");
    if (status) {
        return status;
    }
    if (next_line(&text, &line)) {
        return fail(CONUS_ERROR_DATA, "matrix: more than four rows");
    }
    status = matrix_settle(out, "matrix");
    if (status) {
        return status;
    }
    if (!from && is_fsl) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "a matrix of FSL's kind, whose numbers mean nothing without its two images: from=IMAGE and "
                    "to=IMAGE are needed; a 4 x 4 matrix of RAS mm ends otherwise, in .txt for example");
    }
    status = from ? read_images(images, from, to) : CONUS_OK;
    return status || !from ? status : place_between(out, images, flirt_from_voxel);
}

enum kind { KIND_NONE, KIND_MATRIX, KIND_ITK, KIND_XFM, KIND_LTA, KIND_REGISTER, KIND_MATLAB };

/* Says what the file is instead of a transform that can be read. */
static conus_status fail_kind(const char *path, const struct bytes *file)
{
    static const struct {
        const char *begin, *words, *inside;
    } kinds[] = {
        {"MATLAB 5.0",
         "a MATLAB file of level 5, which is not read as a transform; ITK's (level 4, as "
         "out_0GenericAffine.mat) and 4 x 4 numbers of RAS mm as text are",
         NULL},
        {"(Transform ",
         "elastix's parameters, which are not read; with (WriteITKCompositeTransform \"true\") and "
         "(ITKTransformOutputFileNameExtension \"tfm\") among its own, elastix writes ITK's text",
         "\n(Transform "},
        {"/NumWaves", "a design matrix of FSL's statistics, and no transform", NULL},
        {"Transform = \"",
         "elastix's parameters as TOML, which are not read; elastix writes ITK's text, too, with "
         "WriteITKCompositeTransform and ITKTransformOutputFileNameExtension = \"tfm\"",
         "\nTransform = \""},
    };
    const struct text text = text_from_bytes(file->data, file->size);
    struct text rest = text;
    struct text line;
    struct text words;
    if (next_line(&rest, &line) && text_has_only(line, "0123456789,-+eE \t") && text_mentions(line, ",") &&
        text_word(&line, &words) && count_words(text) == 4) {
        return fail(CONUS_ERROR_DATA, "\"%.*s\" begins a matrix: decimals are written with a point",
                    TEXT_SHOW(words, 20));
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const char *inside = kinds[i].inside; /* elastix's parameters may come in any order */
        if (text_starts(text, kinds[i].begin) || (inside && text_mentions(text, inside))) {
            return fail(CONUS_ERROR_UNSUPPORTED, "%s", kinds[i].words);
        }
    }
    return file_refuse(path, file, transform_needed);
}

static conus_status parse_kind(struct transform_chain *out, enum kind kind, const struct bytes *file, const char *path,
                               const conus_transform_options *options)
{
    struct text text = text_from_bytes(file->data, file->size);
    switch (kind) {
    case KIND_MATRIX:
        return transform_read_matrix(out->matrix, text, path, options->from, options->to);
    case KIND_ITK:
        return itk_text_parse(out, text, options->transform);
    case KIND_XFM:
        return xfm_parse(out->matrix, text);
    case KIND_LTA:
        return lta_parse(out->matrix, text);
    case KIND_REGISTER:
        return register_parse(out->matrix, text, options->from, options->to);
    case KIND_MATLAB:
        return itk_matlab_parse(out, file->data, file->size);
    case KIND_NONE:
        break;
    }
    return fail_kind(path, file);
}

conus_status transform_parse(struct transform_chain *out, const struct bytes *file, const char *path,
                             const conus_transform_options *options)
{
    const struct text text = text_from_bytes(file->data, file->size);
    struct text rest = text;
    double edges[2];
    bool readable = text_is_readable(text);
    enum kind kind = readable && matrix_text_is(text)                      ? KIND_MATRIX
                     : readable && itk_text_is(text)                       ? KIND_ITK
                     : readable && text_starts(text, "MNI Transform File") ? KIND_XFM
                     : readable && lta_is(text)                            ? KIND_LTA
                     : readable && register_take_head(&rest, edges)        ? KIND_REGISTER
                     : itk_matlab_is(file->data, file->size)               ? KIND_MATLAB
                                                                           : KIND_NONE;
    double inverse[16];
    struct transform_chain made;
    if (!options->from != !options->to) {
        return fail(CONUS_ERROR_ARGUMENT, "%s=IMAGE is needed, too", options->from ? "to" : "from");
    }
    if (options->from && kind != KIND_MATRIX && kind != KIND_REGISTER && kind != KIND_NONE) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "from and to are for FSL's matrices and FreeSurfer's register.dat, and this is neither");
    }
    if (options->transform && kind != KIND_ITK && kind != KIND_NONE) {
        return fail(CONUS_ERROR_ARGUMENT, "transform is for lists in ITK's text, and this is none");
    }
    chain_begin(&made);
    conus_status status = parse_kind(&made, kind, file, path, options);
    if (!status && !mat4_invert_affine(inverse, made.matrix)) {
        status = fail(CONUS_ERROR_DATA, "the matrix is singular, an invertible one is needed");
    }
    if (status) {
        transform_chain_finish(&made);
        return status;
    }
    *out = made;
    return CONUS_OK;
}

conus_status transform_file_read(struct transform_chain *out, const char *path, const conus_transform_options *options,
                                 struct file_sums *read)
{
    struct bytes file = {0};
    struct transform_chain made = {0};
    conus_status status = file_read_head(&file, path, AFFINE_LIMIT);
    if (status) {
        return status;
    }
    bool is_long = file.size == AFFINE_LIMIT;
    if (is_long && (itk_text_is(text_from_bytes(file.data, file.size)) || itk_matlab_is(file.data, file.size))) {
        bytes_finish(&file); /* a spline's */
        status = file_read_allowed(&file, path, memory_limit(options->max_memory));
        is_long = false;
    }
    if (status) {
        return status;
    }
    status = is_long ? fail_kind(path, &file) : transform_parse(&made, &file, path, options);
    status = status ? fail_in(status, path) : file_sums_add(read, path, &file);
    bytes_finish(&file);
    if (status) {
        transform_chain_finish(&made);
        return status;
    }
    *out = made;
    return CONUS_OK;
}
