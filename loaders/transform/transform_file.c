/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads a transform by the row of its format. */
#include "loaders/transform/transform.h"

#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/refuse.h"
#include "loaders/volumes/volumes.h"
#include "sources/source.h"

#include <string.h>

#define SINGULAR "the matrix is singular, an invertible one is needed"

enum { AFFINE_LIMIT = 1 << 20 }; /* bytes: a hundred times what an affine takes */

/* Takes the next `rows` lines of four numbers off `rest`, row by row into `out`; `what` is for messages. */
static void take_rows(struct job *job, double out[16], struct text *rest, size_t rows, const char *what)
{
    struct text line = {0};
    size_t row = 0;
    mat4_identity(out);
    for (; job_ok(job) && row < rows && transform_line(rest, &line); row++) {
        struct text word;
        size_t column = 0;
        while (job_ok(job) && text_word(&line, &word)) {
            if (row + 1 == rows && word.size && word.data[word.size - 1] == ';') {
                word.size--;
            }
            if (!word.size) {
                continue;
            }
            if (column == 4 || !text_to_double(word, &out[4 * column + row]) || !isfinite(out[4 * column + row])) {
                job_bad(job, "%s: row %zu: \"%.*s\", four finite numbers are needed", what, row + 1,
                        TEXT_SHOW(word, 40));
            }
            column++;
        }
        if (column != 4) {
            job_bad(job, "%s: row %zu: %zu numbers, four are needed", what, row + 1, column);
        }
    }
    if (row < rows) {
        job_bad(job, "%s: ends after %zu rows, %zu are needed", what, row, rows);
    }
}

/* The last row (mat4_settle_last_row()) must be 0 0 0 1. */
static void settle_matrix(struct job *job, double m[16])
{
    if (!mat4_settle_last_row(m)) {
        job_bad(job, "matrix: last row %.9g %.9g %.9g %.9g, 0 0 0 1 is needed", m[3], m[7], m[11], m[15]);
    }
}

static struct bytes bytes_of(struct job *job, struct source *source)
{
    const bool is_long = source->file.before.size >= AFFINE_LIMIT; /* a spline's */
    const struct bytes bytes = source_bytes(job, source, is_long ? memory_limit(job->max_memory) : AFFINE_LIMIT);
    source_made_of(job, source);
    return bytes;
}

static struct text text_of(struct job *job, struct source *source)
{
    const struct bytes bytes = bytes_of(job, source);
    return text_from_bytes(bytes.data, bytes.size);
}

/* Goes over the lines before the next matrix of the MNI's text: whether there is one. */
static bool take_xfm_head(struct job *job, bool *invert, struct text *rest)
{
    struct text line;
    bool linear = false;
    bool found = false;
    *invert = false;
    while (job_ok(job) && !found && text_line(rest, &line)) {
        line = text_trim(line);
        if (!line.size || line.data[0] == '%' || text_starts(line, "MNI Transform File")) {
            continue;
        }
        if (text_starts(line, "Transform_Type") && !text_mentions(line, "Linear;")) {
            job_refuse(job, "%.*s: only Linear is read", TEXT_SHOW(line, 60));
        }
        *invert = *invert || (text_starts(line, "Invert_Flag") && text_mentions(line, "True"));
        linear = linear || text_starts(line, "Transform_Type");
        found = text_starts(line, "Linear_Transform");
        if (!found && !text_starts(line, "Transform_Type") && !text_starts(line, "Invert_Flag")) {
            job_bad(job, "\"%.*s\": not a line of the MNI's transforms", TEXT_SHOW(line, 60));
        }
    }
    if (found != linear) {
        job_bad(job, "%s is missing", linear ? "Linear_Transform" : "Transform_Type = Linear;");
    }
    return found && job_ok(job);
}

/* The MNI's: the first transform of several comes first. */
static void read_xfm(struct job *job, struct transform_chain *out, struct source *source,
                     const conus_transform_options *options)
{
    struct text text = text_of(job, source);
    double m[16];
    bool invert;
    size_t count = 0;
    (void)options;
    while (take_xfm_head(job, &invert, &text)) {
        take_rows(job, m, &text, 3, "Linear_Transform");
        if (invert && !mat4_invert_affine(m, m)) {
            job_bad(job, SINGULAR);
        }
        mat4_multiply(out->matrix, m, out->matrix);
        count++;
    }
    if (!count) {
        job_bad(job, "Transform_Type = Linear; is missing");
    }
}

/* FreeSurfer's linear transforms (.lta): a matrix from source to destination, between their voxels or in RAS mm. */

enum { VOXEL_TO_VOXEL = 0, RAS_TO_RAS = 1 };

/* The geometry of one of the two images. */
struct lta_volume {
    bool has[7]; /* as the keys of take_volume_line() */
    double valid, size[3], voxel[3], axis[3][3], centre[3];
};

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

static void take_numbers(struct job *job, double *out, size_t count, struct text values, const char *key)
{
    struct text word;
    for (size_t i = 0; job_ok(job) && i < count; i++) {
        bool there = text_word(&values, &word);
        word.size -= there && i + 1 < count && word.data[word.size - 1] == ','; /* FastSurfer's "256, 256, 256" */
        if (!there || !text_to_double(word, &out[i]) || !isfinite(out[i])) {
            job_bad(job, "%s: %zu finite numbers are needed", key, count);
        }
    }
    if (text_word(&values, &word)) {
        job_bad(job, "%s: more than %zu numbers", key, count);
    }
}

/* Lines that say nothing of places. */
static void pass_line(struct job *job, struct text line)
{
    struct text word = {0};
    struct text rest = line;
    (void)text_word(&rest, &word);
    if (!text_is_one_of(word, "filename/subject/fscale/mean/sigma", true)) {
        job_bad(job, "found the line \"%.*s\", which is not known", TEXT_SHOW(line, 40));
    }
}

static void take_volume_line(struct job *job, struct lta_volume *out, struct text line)
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
            take_numbers(job, keys[i].numbers, keys[i].count, values, keys[i].key);
            return;
        }
    }
    pass_line(job, line);
}

/* cras is the middle of the voxels: of 256 of them voxel 128's. */
static void world_from_voxel(struct job *job, double out[16], const struct lta_volume *volume, const char *which)
{
    bool whole = volume->valid == 1;
    for (size_t i = 0; i < sizeof volume->has; i++) {
        whole = whole && volume->has[i];
    }
    if (!whole) {
        job_bad(job, "%s volume info: not valid or not whole, but the matrix is between voxels", which);
    }
    mat4_identity(out);
    double middle[3];
    for (int a = 0; a < 3; a++) {
        middle[a] = volume->size[a] / 2;
        vec3_scale(out + 4 * a, volume->axis[a], volume->voxel[a]);
    }
    mat4_direction(middle, out, middle);
    vec3_sub(out + 12, volume->centre, middle);
}

/* Takes what is before the matrix, whose type it gives. */
static double take_lta_head(struct job *job, struct text *rest)
{
    struct text line;
    struct text values;
    double type = -1;
    double count = -1;
    double shape[3] = {0};
    while (job_ok(job) && transform_line(rest, &line)) {
        if (lta_take_key(&values, line, "type")) {
            take_numbers(job, &type, 1, values, "type");
        } else if (lta_take_key(&values, line, "nxforms")) {
            take_numbers(job, &count, 1, values, "nxforms");
        } else if (line.data[0] >= '0' && line.data[0] <= '9') {
            take_numbers(job, shape, 3, line, "shape of the matrix");
            break;
        } else {
            pass_line(job, line);
        }
    }
    if (type != VOXEL_TO_VOXEL && type != RAS_TO_RAS) {
        job_refuse(job, "type: %g, 0 (between voxels) and 1 (RAS to RAS) are read", type);
    }
    if (count != 1 || shape[0] != 1 || shape[1] != 4 || shape[2] != 4) {
        job_refuse(job, "nxforms: one matrix of 4 x 4 is read");
    }
    return type;
}

static void read_lta(struct job *job, struct transform_chain *out, struct source *source,
                     const conus_transform_options *options)
{
    struct text text = text_of(job, source);
    struct lta_volume volumes[2] = {0};
    struct lta_volume *at = NULL;
    struct text line;
    double *m = out->matrix;
    (void)options;
    const double type = take_lta_head(job, &text);
    take_rows(job, m, &text, 4, "matrix");
    settle_matrix(job, m);
    while (job_ok(job) && transform_line(&text, &line)) {
        if (text_starts(line, "src volume info") || text_starts(line, "dst volume info")) {
            at = &volumes[line.data[0] == 'd'];
        } else if (at) {
            take_volume_line(job, at, line);
        } else {
            pass_line(job, line);
        }
    }
    if (type == VOXEL_TO_VOXEL) {
        double from[16];
        double to[16];
        double voxel_from_world[16];
        world_from_voxel(job, from, &volumes[0], "src");
        world_from_voxel(job, to, &volumes[1], "dst");
        if (!mat4_invert_affine(voxel_from_world, from)) {
            job_bad(job, "src volume info: its matrix is singular");
            return;
        }
        mat4_multiply(m, to, m);
        mat4_multiply(m, m, voxel_from_world);
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

static void image_from_world(struct job *job, double out[16], const conus_volume_info *info, from_voxel *from)
{
    double voxel_from_world[16];
    if (!mat4_invert_affine(voxel_from_world, info->world_from_voxel)) {
        job_bad(job, "the matrix of an image is singular");
        return;
    }
    from(out, info);
    mat4_multiply(out, out, voxel_from_world);
}

/* From a matrix of both images' coordinates, as `coordinates` has them, to one of RAS. */
static void place_between(struct job *job, double m[16], const conus_volume_info images[2], from_voxel *coordinates)
{
    double from_world[16] = {0};
    double to_world[16] = {0};
    double world_from_to[16];
    if (job_ok(job)) {
        image_from_world(job, from_world, &images[0], coordinates);
        image_from_world(job, to_world, &images[1], coordinates);
    }
    if (!job_ok(job)) {
        return;
    }
    if (!mat4_invert_affine(world_from_to, to_world)) {
        job_bad(job, "the matrix of an image is singular");
        return;
    }
    mat4_multiply(m, m, from_world);
    mat4_multiply(m, world_from_to, m);
}

static void read_images(struct job *job, conus_volume_info images[2], const conus_transform_options *options)
{
    volume_header_read(job, &images[0], options->from);
    volume_header_read(job, &images[1], options->to);
}

static bool has_edges(const conus_volume_info *image, const double edges[2])
{
    return fabs(image->spacing[0] - edges[0]) <= 0.01 * edges[0] &&
           fabs(image->spacing[2] - edges[1]) <= 0.01 * edges[1];
}

/* FreeSurfer's register.dat, which ends with how voxels are rounded; that moves no points. The matrix takes points of
 * the anatomical volume to the movable one, each in its own tkregister RAS. */
static void read_register(struct job *job, struct transform_chain *out, struct source *source,
                          const conus_transform_options *options)
{
    conus_volume_info images[2] = {0};
    double edges[2];
    struct text text = text_of(job, source);
    struct text line = {0};
    (void)register_take_head(&text, edges); /* which was asked before */
    take_rows(job, out->matrix, &text, 4, "matrix");
    settle_matrix(job, out->matrix);
    (void)transform_line(&text, &line); /* the word */
    if (transform_line(&text, &line)) {
        job_bad(job, "\"%.*s\" behind the matrix and a word", TEXT_SHOW(line, 40));
    }
    if (!options->from) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "FreeSurfer's register.dat, whose numbers mean nothing without its two images: from=IMAGE, the "
                 "anatomical one, and to=IMAGE, the movable one, are needed");
    }
    read_images(job, images, options);
    if (has_edges(&images[0], edges) && !has_edges(&images[1], edges)) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "voxels of the movable image are %g mm and %g mm apart, as those of from are, and not those of "
                 "to: from is the anatomical image",
                 edges[0], edges[1]);
    }
    place_between(job, out->matrix, images, tkregister_from_voxel);
}

static size_t count_words(struct text text)
{
    struct text line = {0};
    struct text word;
    size_t count = 0;
    (void)transform_line(&text, &line);
    while (text_word(&line, &word)) {
        count++;
    }
    return count;
}

#define IN_RAS "needed are 4 x 4 numbers in RAS: a b -c -d, e f -g -h, -i -j k l, 0 0 0 1 of its a to l"

/* Refuses a matrix of which a comment says that it is in LPS: "(LPS)", "space=lps"; or not in mm: "units: m". */
static void check_comments(struct job *job, struct text text)
{
    struct text line;
    struct text word;
    while (job_ok(job) && text_line(&text, &line)) {
        const struct text all = text_trim(line);
        struct text rest = text_starts(all, "#") ? all : text_from("");
        struct text units = rest;
        while (text_token(&rest, &word)) {
            if (text_equal_ignoring_case(word, "LPS")) {
                job_bad(job, "\"%.*s\" says LPS: " IN_RAS, TEXT_SHOW(all, 60));
            }
        }
        while (text_statement(&units, "unit/units", true, &word)) {
            if (!text_is_one_of(word, TEXT_MM, false)) {
                job_bad(job, "\"%.*s\": the unit is stated as %.*s, and mm are read: one of them is wrong",
                        TEXT_SHOW(all, 60), TEXT_SHOW(word, 20));
            }
        }
    }
}

/* Sixteen numbers, four in a line, the last line 0 0 0 1; lines that begin with # are comments. */
static void read_matrix(struct job *job, struct transform_chain *out, struct source *source,
                        const conus_transform_options *options)
{
    conus_volume_info images[2] = {0};
    struct text text = text_of(job, source);
    struct text line;
    const char *path = source->file.path;
    size_t length = strlen(path);
    bool is_fsl = length > 4 && strcmp(path + length - 4, ".mat") == 0;
    if (count_words(text) == 12) {
        job_refuse(job, "12 numbers in a line, a matrix of AFNI's (.aff12.1D), which is in LPS: " IN_RAS);
    }
    check_comments(job, text);
    take_rows(job, out->matrix, &text, 4, "matrix");
    if (transform_line(&text, &line)) {
        job_bad(job, "matrix: more than four rows");
    }
    settle_matrix(job, out->matrix);
    if (!options->from && is_fsl) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "a matrix of FSL's kind, whose numbers mean nothing without its two images: from=IMAGE and to=IMAGE "
                 "are needed; a 4 x 4 matrix of RAS mm ends otherwise, in .txt for example");
    }
    if (options->from) {
        read_images(job, images, options);
        place_between(job, out->matrix, images, flirt_from_voxel);
    }
}

static void read_itk(struct job *job, struct transform_chain *out, struct source *source,
                     const conus_transform_options *options)
{
    itk_text_parse(job, out, text_of(job, source), options->transform);
}

static void read_itk_matlab(struct job *job, struct transform_chain *out, struct source *source,
                            const conus_transform_options *options)
{
    const struct bytes bytes = bytes_of(job, source);
    (void)options;
    if (job_ok(job)) {
        itk_matlab_parse(job, out, bytes.data, bytes.size);
    }
}

/* Composites of ITK, and X5. */
static void read_hdf5(struct job *job, struct transform_chain *out, struct source *source,
                      const conus_transform_options *options)
{
    static const char *const wanted[] = {"/",
                                         "/TransformGroup/*",
                                         "/TransformGroup/*/TransformType",
                                         "/TransformGroup/*/TransformParameters",
                                         "/TransformGroup/*/TranformParameters",
                                         "/TransformGroup/*/TransformFixedParameters",
                                         "/TransformGroup/*/TranformFixedParameters",
                                         "/TransformGroup/*/Transform",
                                         "/TransformGroup/*/Domain/*",
                                         "/TransformChain/*"};
    (void)options;
    const struct hdf5 *hdf5 = hdf5_open(job, &source->file, wanted, sizeof wanted / sizeof wanted[0]);
    const char *words = (x5_is(hdf5) ? x5_parse : itk_hdf5_parse)(job, out, hdf5);
    chain_end(job, out);
    (void)JOB_CALL(job, notes_add(&job->notes, "%s: %s", source->file.path, words));
    source_made_of(job, source);
}

/* What a kind takes or is: from= and to=; transform=; vectors. */
enum { IMAGES = 1, LIST = 2, FIELD = 4, MAY_BE_LONG = 8, MAY_BE_PACKED = 16 };

static const struct kind {
    enum format_id id;
    unsigned has;
    void (*read)(struct job *job, struct transform_chain *out, struct source *source,
                 const conus_transform_options *options);
} kinds[] = {
    {FORMAT_NIFTI, FIELD | MAY_BE_LONG | MAY_BE_PACKED, field_read},
    {FORMAT_NRRD, FIELD | MAY_BE_LONG | MAY_BE_PACKED, field_read},
    {FORMAT_METAIMAGE, FIELD | MAY_BE_LONG | MAY_BE_PACKED, field_read},
    {FORMAT_HDF5, MAY_BE_LONG | MAY_BE_PACKED, read_hdf5},
    {FORMAT_MATRIX, IMAGES, read_matrix},
    {FORMAT_ITK, LIST | MAY_BE_LONG, read_itk},
    {FORMAT_XFM, 0, read_xfm},
    {FORMAT_LTA, 0, read_lta},
    {FORMAT_REGISTER, IMAGES, read_register},
    {FORMAT_ITK_MATLAB, MAY_BE_LONG, read_itk_matlab},
};

static const struct kind *find_kind(struct job *job, const struct source *source, const struct format *format)
{
    for (size_t i = 0; format && i < sizeof kinds / sizeof kinds[0]; i++) {
        if (kinds[i].id == format->id) {
            bool is = (kinds[i].has & MAY_BE_LONG || source->file.before.size < AFFINE_LIMIT) &&
                      (kinds[i].has & MAY_BE_PACKED || !source->is_packed) &&
                      (!(kinds[i].has & FIELD) || field_is(job, source));
            return is ? &kinds[i] : NULL;
        }
    }
    return NULL;
}

static void refuse(struct job *job, const struct source *source, const struct format *format)
{
    struct text text = text_from_bytes(source->stored.data, source->stored.size);
    struct text rest = text;
    struct text line;
    struct text words;
    if (transform_line(&rest, &line) && text_has_only(line, "0123456789,-+eE \t") && text_mentions(line, ",") &&
        text_word(&line, &words) && count_words(text) == 4) {
        job_bad(job, "\"%.*s\" begins a matrix: decimals are written with a point", TEXT_SHOW(words, 20));
    }
    if (format && format->words && format->is_hidden && !source->is_packed) {
        job_refuse(job, "%s, %s", format->words, format->way);
    }
    (void)JOB_CALL(job, format_refuse(format_nearest(&source->head), &source->stored,
                                      "an affine transform (ITK's text or .mat, FreeSurfer's .lta or register.dat, the "
                                      "MNI's .xfm, FSL's matrix, or 4 x 4 numbers), a B-spline (ITK's), or a "
                                      "deformation field (NIfTI)"));
}

static void check_options(struct job *job, const struct kind *kind, const conus_transform_options *options)
{
    const bool is_field = kind && kind->has & FIELD;
    const bool is_hdf5 = kind && kind->id == FORMAT_HDF5;
    const bool states = options->vectors || options->space;
    const char *problem = NULL;
    if (kind && options->transform && !(kind->has & LIST)) {
        problem = "transform is for lists in ITK's text, and this is none";
    } else if (is_hdf5 && (options->from || options->to || states)) {
        problem =
            "from, to, relative and absolute are for files of FSL, ITK and SPM that are not HDF5, and so is space";
    } else if (!is_field && states) {
        problem = "relative and absolute are for deformation fields, as space is, and this is none";
    } else if (!is_field && !options->from != !options->to) {
        problem = options->from ? "to=IMAGE is needed, too" : "from=IMAGE is needed, too";
    } else if (kind && options->from && !(kind->has & (IMAGES | FIELD))) {
        problem = "from and to are for FSL's matrices and FreeSurfer's register.dat, and this is neither";
    }
    if (problem) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s", problem);
    }
}

void transform_read(struct job *job, struct transform_chain *out, struct source *source,
                    const conus_transform_options *options)
{
    double inverse[16];
    chain_begin(out);
    if (!job_ok(job)) {
        return; /* there may be no source */
    }
    const struct job_mark mark = job_mark(job);
    const size_t place = job_in(job, source->file.path, JOB_ALONE);
    const struct format *format = format_find(&source->head, ROLE_TRANSFORM);
    const struct kind *kind = find_kind(job, source, format);
    check_options(job, kind, options);
    if (!kind) {
        refuse(job, source, format);
    } else if (job_ok(job)) {
        kind->read(job, out, source, options);
    }
    if (!mat4_invert_affine(inverse, out->matrix)) {
        job_bad(job, SINGULAR);
    } else if (options->inverse && out->count) {
        job_refuse(job, kind && kind->id == FORMAT_HDF5
                            ? "a chain with a deformation field is not inverted; the file of the other direction is "
                              "needed: InverseComposite.h5 for Composite.h5 (ANTs), from-B_to-A for from-A_to-B "
                              "(fMRIPrep)"
                            : "a B-spline is not inverted; that of the other direction is needed");
    } else if (options->inverse) {
        memcpy(out->matrix, inverse, sizeof inverse);
    }
    job_out(job, place);
    job_release(job, mark);
}
