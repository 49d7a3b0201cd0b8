/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads deformation fields, and finds out what their vectors mean. */
#include "loaders/transform/field_file.h"

#include "base/byte_order.h"
#include "base/formats/gzip.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/transform/transform_formats.h"
#include "loaders/volumes/nifti.h"
#include "loaders/volumes/volume_file.h"
#include "loaders/volumes/volume_values.h"
#include "sources/source.h"

#include <string.h>

enum { NAME_SIZE = 16 };

/* nifti1.h: a vector at each voxel. */
enum {
    INTENT_NONE = -1,
    INTENT_DISPLACEMENT = 1006,
    INTENT_VECTOR = 1007
}; /* INTENT_NONE: of NRRD in another space than LPS */

/* FSL's own. */
enum { FNIRT_FIELD = 2006, CUBIC_SPLINES = 2007, COSINES = 2008, QUADRATIC_SPLINES = 2009 };
enum { TOPUP_CUBIC = 2016, TOPUP_QUADRATIC = 2017, TOPUP_FIELD = 2018 };

conus_status field_header_parse(struct field_header *out, const uint8_t *data, size_t size)
{
    bool first = size >= 4 && (order_u32(data, false) == NIFTI1_SIZE || order_u32(data, true) == NIFTI1_SIZE);
    size_t needed = first ? NIFTI1_SIZE : FIELD_HEADER_SIZE;
    if (size < needed) {
        return fail(CONUS_ERROR_DATA, "header: found %zu bytes, %zu are needed", size, needed);
    }
    bool swapped = order_u32(data, false) != needed;
    *out = (struct field_header){.intent_code = first ? order_i16(data + 68, swapped) : order_i32(data + 504, swapped)};
    for (size_t i = 0; i < 8; i++) {
        out->dim[i] = first ? order_i16(data + 40 + 2 * i, swapped) : order_i64(data + 16 + 8 * i, swapped);
    }
    out->parameter = first ? (double)order_f32(data + 56, swapped) : order_f64(data + 80, swapped);
    memcpy(out->intent_name, data + (first ? 328 : 508), NAME_SIZE);
    return CONUS_OK;
}

/* X x Y x Z x 1 x 3, or X x Y x Z x 3. */
static conus_status field_check_shape(const struct field_header *header)
{
    const int64_t *dim = header->dim;
    bool five = dim[0] == 5 && dim[4] == 1 && dim[5] == 3;
    bool four = dim[0] == 4 && dim[4] == 3;
    if (dim[0] == 5 && dim[4] == 3 && dim[5] == 4) {
        return fail(CONUS_ERROR_UNSUPPORTED, "dim: found X x Y x Z x 3 x 4, MRtrix's warp of both ways; 'warpconvert "
                                             "-type warpfull2deformation' makes a field of it");
    }
    if (!five && !four) {
        return fail(CONUS_ERROR_DATA,
                    "dim: found %lld: %lld x %lld x %lld x %lld x %lld: this is a volume, but no deformation field, "
                    "which has 5 dimensions (X x Y x Z x 1 x 3), or 4 (X x Y x Z x 3)",
                    (long long)dim[0], (long long)dim[1], (long long)dim[2], (long long)dim[3],
                    (long long)(dim[0] > 3 ? dim[4] : 1), (long long)(dim[0] > 4 ? dim[5] : 1));
    }
    for (int i = 1; i < 4; i++) {
        if (dim[i] < 2) {
            return fail(CONUS_ERROR_DATA, "dim[%d]: found %lld, a field has 2 or more", i, (long long)dim[i]);
        }
    }
    return CONUS_OK;
}

/* A field whose numbers are mm of FSL's two images. */
static conus_status flirt_kind(enum field_kind *out, const struct field_header *header, conus_vectors vectors,
                               conus_file_space space)
{
    if (header->dim[0] == 5) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "dim: found 5, but from and to are for FSL's fields, which have 4 (X x Y x Z x 3)");
    }
    if (space) {
        return fail(CONUS_ERROR_ARGUMENT, "space= is for fields in mm of the world, from= and to= for FSL's, which are "
                                          "in mm of the two images: one of them is needed");
    }
    *out = header->intent_code == FNIRT_FIELD && !vectors ? FIELD_FNIRT : FIELD_FSL;
    return CONUS_OK;
}

/* What a header says of vectors that are in RAS then. */
static conus_status read_statement(conus_vectors *out, const struct field_header *header)
{
    const char *name = header->intent_name;
    const double kind = header->parameter;
    bool is_reg = strcmp(name, "NREG_TRANS") == 0 && (kind == 0 || kind == 1);
    if (strncmp(name, "NREG_", 5) == 0 && !is_reg) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "intent_name: found \"%s\", intent_p1 %g, a grid or velocities of NiftyReg: 'reg_transform -ref "
                    "IMAGE -def FILE OUT' makes positions of it, which are read (0), as displacements (1) are",
                    name, kind);
    }
    bool is_absolute = is_reg ? kind == 0 : strcmp(name, "Mapping") == 0; /* as SPM calls it */
    *out = is_absolute ? CONUS_VECTORS_ABSOLUTE : is_reg ? CONUS_VECTORS_RELATIVE : CONUS_VECTORS_AS_STATED;
    return CONUS_OK;
}

/* The kind of a field in mm of the world. */
static conus_status vectors_kind(enum field_kind *out, const struct field_header *header, conus_vectors vectors,
                                 conus_file_space space)
{
    conus_vectors stated;
    const int code = header->intent_code;
    const char *name = header->intent_name;
    conus_status status = read_statement(&stated, header);
    if (status) {
        return status;
    }
    if (header->dim[0] == 4 && (code == FNIRT_FIELD || !(stated || space))) {
        return fail(CONUS_ERROR_ARGUMENT,
                    code == FNIRT_FIELD
                        ? "dim: found 4, a field of FSL's kind, whose numbers mean nothing without its two images: "
                          "from=IMAGE and to=IMAGE are needed (fields of ITK and SPM have 5 dimensions)"
                        : "dim: found 4, and nothing says whose field it is: from=IMAGE and to=IMAGE are needed for "
                          "FSL's, ',space=ras,absolute' for positions in RAS mm (MRtrix's warpconvert, EasyReg), "
                          "',space=ras,relative' for displacements (SynthMorph; VoxelMorph's if in mm, not in voxels)");
    }
    if (stated && ((vectors && vectors != stated) || space == CONUS_FILE_SPACE_LPS)) {
        bool positions = stated == CONUS_VECTORS_ABSOLUTE;
        return fail(CONUS_ERROR_ARGUMENT, "intent_name: found \"%s\", intent_p1 %g: %s in RAS, not %s", name,
                    header->parameter, positions ? "positions" : "displacements",
                    space == CONUS_FILE_SPACE_LPS ? "LPS"
                    : positions                   ? "relative"
                                                  : "absolute");
    }
    if (code == INTENT_DISPLACEMENT && stated && !vectors) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "intent_code: found 1006 (displacements), and intent_name \"%s\": ',relative' or ',absolute' is "
                    "needed",
                    name);
    }
    vectors = vectors ? vectors : stated;
    vectors = !vectors && code == INTENT_DISPLACEMENT ? CONUS_VECTORS_RELATIVE : vectors;
    bool is_ras = stated || (code == INTENT_DISPLACEMENT && vectors == CONUS_VECTORS_RELATIVE);
    space = space ? space : is_ras ? CONUS_FILE_SPACE_RAS : CONUS_FILE_SPACE_AS_STATED;
    if (space && !vectors) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "space: ',relative' (displacements) or ',absolute' (positions) is needed, too");
    }
    if (code != INTENT_VECTOR && code != INTENT_DISPLACEMENT && !vectors) {
        return code == INTENT_NONE
                   ? fail(CONUS_ERROR_ARGUMENT, "space: another than LPS, in which ITK has displacements: "
                                                "',space=ras,relative' or ',space=lps,relative' states theirs")
                   : fail(CONUS_ERROR_DATA,
                          "intent_code: found %d, fields have 1007 (vector) or 1006; ',relative' states displacements "
                          "in "
                          "LPS, as ITK has them, ',absolute' positions in RAS, as SPM has them",
                          code);
    }
    *out = vectors == CONUS_VECTORS_RELATIVE   ? (space == CONUS_FILE_SPACE_RAS ? FIELD_RAS : FIELD_ITK)
           : vectors == CONUS_VECTORS_ABSOLUTE ? (space == CONUS_FILE_SPACE_LPS ? FIELD_LPS : FIELD_SPM)
                                               : FIELD_VECTORS;
    return CONUS_OK;
}

const char *field_header_words(bool *usable, const struct field_header *header)
{
    const int64_t *dim = header->dim;
    const int code = header->intent_code;
    conus_vectors stated;
    bool vectors = dim[0] == 5 && dim[4] == 1 && dim[5] == 3;
    if (vectors && read_statement(&stated, header)) {
        *usable = false;
        return "a grid or velocities of NiftyReg";
    }
    *usable = (vectors && (code == INTENT_VECTOR || code == INTENT_DISPLACEMENT)) ||
              (code == FNIRT_FIELD && dim[0] == 4 && dim[4] == 3);
    if (*usable) {
        return code == FNIRT_FIELD                              ? "a deformation field of fnirt"
               : strcmp(header->intent_name, "Mapping") == 0    ? "a deformation field of SPM"
               : strcmp(header->intent_name, "NREG_TRANS") == 0 ? "a deformation of NiftyReg"
                                                                : "a deformation field of ITK or SPM";
    }
    return code == CUBIC_SPLINES || code == COSINES || code == QUADRATIC_SPLINES   ? "coefficients of a field of fnirt"
           : code == TOPUP_CUBIC || code == TOPUP_QUADRATIC || code == TOPUP_FIELD ? "a field of topup"
                                                                                   : NULL;
}

conus_status field_header_kind(enum field_kind *out, const struct field_header *header, bool has_images,
                               conus_vectors vectors, conus_file_space space)
{
    int code = header->intent_code;
    if (code == CUBIC_SPLINES || code == COSINES || code == QUADRATIC_SPLINES) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "intent_code: found %d, coefficients of fnirt; 'convertwarp --ref=IMAGE --warp1=FILE --out=FIELD' "
                    "makes a field of them, 'invwarp --ref=IMAGE --warp=FILE --out=FIELD' that of the other direction",
                    code);
    }
    if (code == TOPUP_CUBIC || code == TOPUP_QUADRATIC || code == TOPUP_FIELD) {
        return fail(CONUS_ERROR_UNSUPPORTED, "intent_code: found %d, topup's, which moves no points between two images",
                    code);
    }
    conus_status status = field_check_shape(header);
    return status ? status : (has_images ? flirt_kind : vectors_kind)(out, header, vectors, space);
}

/* The text of a NRRD or MetaImage header that has three real numbers at each voxel. */
static bool has_vectors(struct text head)
{
    bool is_nrrd = text_starts(head, "NRRD");
    return is_nrrd ? text_mentions(head, "kinds: vector") || text_mentions(head, "kinds: covariant-vector") ||
                         text_mentions(head, "kinds: 3-vector")
                   : text_mentions(head, "ElementNumberOfChannels = 3") &&
                         (text_mentions(head, "MET_FLOAT") || text_mentions(head, "MET_DOUBLE"));
}

/* As ITK, elastix and 3D Slicer write displacements: in LPS, like the header. */
static conus_status read_foreign(struct field_header *out, bool *found, struct text head, const char *path)
{
    conus_volume_info info;
    conus_status status = has_vectors(head) ? volume_file_header(&info, path) : CONUS_ERROR_DATA;
    *found = has_vectors(head) && (status || info.volume_count == 3);
    if (status || !*found) {
        return *found || status == CONUS_ERROR_MEMORY ? status : CONUS_OK;
    }
    if (text_mentions(head, "displacement field type:=modeling")) {
        return fail(CONUS_ERROR_UNSUPPORTED, "displacement field type: found modeling, which moves points the other "
                                             "way; invert it in 3D Slicer and save it again");
    }
    *out = (struct field_header){.intent_code = INTENT_VECTOR, .dim = {5, 0, 0, 0, 1, 3}};
    for (int a = 0; a < 3; a++) {
        out->dim[a + 1] = (int64_t)info.dim[a];
    }
    if (text_starts(head, "NRRD") && !text_mentions(head, "space: left-posterior-superior") &&
        !text_mentions(head, "space: LPS")) {
        out->intent_code = INTENT_NONE; /* a space must be stated */
    }
    return CONUS_OK;
}

enum { LATTICE = 64 }; /* nodes along an axis that show what vectors are */

#define NEAR 0.01 /* mm by which the field's grid and FSL's image may differ */

/* The header of a field: of a NIfTI file what it says of vectors; *found: it is one, or another that has vectors. */
static conus_status read_header(struct field_header *out, bool *found, const char *path)
{
    struct source source;
    *found = false;
    conus_status status = source_look(&source, path);
    const struct text head = source.head.bytes;
    if (status) {
        /* it cannot be read */
    } else if (nifti_has_magic((const uint8_t *)head.data, head.size)) {
        *found = true;
        status = field_header_parse(out, (const uint8_t *)head.data, head.size);
    } else {
        status = read_foreign(out, found, head, path);
    }
    source_close(&source);
    return status;
}

conus_status field_file_is(bool *out, const char *path)
{
    struct field_header header;
    conus_status status = read_header(&header, out, path);
    return *out ? CONUS_OK : status;
}

conus_status field_file_words(const char **out, bool *usable, const char *path)
{
    struct field_header header;
    bool found;
    conus_status status = read_header(&header, &found, path);
    *usable = false;
    *out = !status && found ? field_header_words(usable, &header) : NULL;
    return found ? CONUS_OK : status;
}

static conus_status find_kind(enum field_kind *out, const char *path, const conus_transform_options *options)
{
    struct field_header header;
    bool found;
    conus_status status = read_header(&header, &found, path);
    if (!found) {
        return status;
    }
    if (!status && !options->from != !options->to) {
        status = fail(CONUS_ERROR_ARGUMENT, "%s=IMAGE is needed, too", options->from ? "to" : "from");
    }
    status = status ? status : field_header_kind(out, &header, options->from, options->vectors, options->space);
    if (!status && options->inverse) {
        status = fail(CONUS_ERROR_UNSUPPORTED,
                      "a deformation field is not inverted; the field of the other direction is needed: "
                      "1InverseWarp.nii.gz for 1Warp.nii.gz, iy_ for y_, or what FSL's 'invwarp' writes");
    }
    return status ? fail_in(status, path) : CONUS_OK;
}

static size_t count_nodes(const struct deformation *field)
{
    return field->dim[0] * field->dim[1] * field->dim[2];
}

static conus_status read_vectors(struct deformation *out, struct volume_file *file, uint64_t max_memory)
{
    memcpy(out->dim, file->info.dim, sizeof out->dim);
    memcpy(out->world_from_voxel, file->info.world_from_voxel, sizeof out->world_from_voxel);
    if (!mat4_invert_affine(out->voxel_from_world, out->world_from_voxel)) {
        return fail(CONUS_ERROR_DATA, "%s: the matrix is singular", file->info.transform);
    }
    if (file->info.volume_count != 3) {
        return fail(CONUS_ERROR_IO, FILE_CHANGED);
    }
    uint64_t limit = memory_limit(max_memory);
    if (count_nodes(out) > limit / (3 * sizeof *out->vectors)) {
        return fail(CONUS_ERROR_MEMORY, "dim: %zu vectors take %zu bytes each, allowed are %llu in all (--max-memory)",
                    count_nodes(out), 3 * sizeof *out->vectors, (unsigned long long)limit);
    }
    out->vectors = memory_raw(count_nodes(out), 3 * sizeof *out->vectors);
    conus_status status = out->vectors ? CONUS_OK : CONUS_ERROR_MEMORY;
    for (size_t n = 0; !status && n < 3; n++) {
        float *values = NULL;
        struct notes unwanted = {0}; /* about numbers that are not finite: the caller counts them */
        status = volume_file_select(file, n);
        status = status ? status : volume_file_values_or_nan(&values, file, &unwanted);
        for (size_t i = 0; !status && i < count_nodes(out); i++) {
            out->vectors[3 * i + n] = values[i];
        }
        memory_free(values);
        notes_finish(&unwanted);
    }
    return status;
}

static conus_status check_finite(const struct deformation *field)
{
    const size_t *dim = field->dim;
    for (size_t i = 0; i < 3 * count_nodes(field); i++) {
        if (!isfinite(field->vectors[i])) {
            size_t node = i / 3;
            return fail(CONUS_ERROR_DATA, "voxel (%zu, %zu, %zu): a vector that is not finite", node % dim[0],
                        node / dim[0] % dim[1], node / dim[0] / dim[1]);
        }
    }
    return CONUS_OK;
}

struct sums {
    double sum[3], squares[3], count;
};

/* A vector less x. */
static void add_vector(struct sums *sums, const float v[3], const double x[3])
{
    const double left[3] = {(double)v[0] - x[0], (double)v[1] - x[1], (double)v[2] - x[2]};
    for (int a = 0; vec3_is_finite(left) && a < 3; a++) {
        sums->sum[a] += left[a];
        sums->squares[a] += left[a] * left[a];
        sums->count += a == 0;
    }
}

/* How much some of the vectors differ from each other, after what `reference` makes of the indices was taken off: the
 * sum of the standard deviations of x, y and z. */
static double spread(const struct deformation *field, const double reference[16])
{
    struct sums sums = {0};
    const size_t *dim = field->dim;
    for (size_t k = 0; k < dim[2]; k += dim[2] / LATTICE + 1) {
        for (size_t j = 0; j < dim[1]; j += dim[1] / LATTICE + 1) {
            for (size_t i = 0; i < dim[0]; i += dim[0] / LATTICE + 1) {
                const float *v = &field->vectors[3 * (i + dim[0] * (j + dim[1] * k))];
                const double q[3] = {(double)i, (double)j, (double)k};
                double x[3];
                mat4_point(x, reference, q);
                add_vector(&sums, v, x);
            }
        }
    }
    double total = 0;
    for (int a = 0; a < 3; a++) {
        double mean = sums.sum[a] / sums.count;
        total += sqrt(fmax(0, sums.squares[a] / sums.count - mean * mean));
    }
    return total;
}

/* Positions follow the grid, displacements do not: FSL's rule where nobody says which they are. */
static bool look_like_positions(const struct deformation *field, const double reference[16])
{
    static const double nothing[16] = {[15] = 1};
    return spread(field, nothing) > spread(field, reference);
}

static conus_status note_looks(bool positions, bool look, struct notes *notes)
{
    return positions == look ? CONUS_OK
                             : notes_warn(notes, "the vectors are taken for %s, but look like %s",
                                          look ? "displacements" : "positions", look ? "positions" : "displacements");
}

/* Decides between ITK's and SPM's: a field whose header does not say must not look like the other kind. Nor must one of
 * intent 1006, which ITK and 3D Slicer write for displacements, and others (VISTASOFT) for positions; @p is_stated: the
 * caller says which. */
static conus_status set_vectors(struct deformation *field, enum field_kind kind, bool is_stated, struct notes *notes)
{
    static const double flip[16] = {-1, [5] = -1, [10] = 1, [15] = 1};
    double lps[16];
    mat4_multiply(lps, flip, field->world_from_voxel);
    bool positions = look_like_positions(field, field->world_from_voxel) || look_like_positions(field, lps);
    if (kind == FIELD_VECTORS && positions) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "the vectors look like positions, and the header does not say so: ',absolute' states positions in "
                    "RAS, as SPM has them, ',relative' displacements in LPS, as ITK has them");
    }
    if (kind == FIELD_RAS && positions && !is_stated) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "the header says displacements (intent_code 1006, or NiftyReg's name), and the "
                    "vectors look like positions: ',relative' or ',absolute' states which they "
                    "are, both in RAS");
    }
    bool absolute = kind == FIELD_SPM || kind == FIELD_LPS;
    conus_status status = note_looks(absolute, positions, notes);
    if (status) {
        return status;
    }
    mat4_identity(field->linear);
    if (kind != FIELD_SPM && kind != FIELD_RAS) {
        field->linear[0] = field->linear[5] = -1;
    }
    if (absolute) {
        field->base[15] = 1;
        return CONUS_OK; /* positions may be missing, as in SPM's inverses outside of the brain */
    }
    memcpy(field->base, field->world_from_voxel, sizeof field->base);
    field->stays_outside = true;
    return check_finite(field);
}

/* From FSL's mm of an image to the world. */
static conus_status world_from_flirt(double out[16], const conus_volume_info *info)
{
    double flirt[16];
    double voxel[16];
    flirt_from_voxel(flirt, info);
    if (!mat4_invert_affine(voxel, flirt)) {
        return fail(CONUS_ERROR_DATA, "the matrix of an image is singular");
    }
    mat4_multiply(out, info->world_from_voxel, voxel);
    return CONUS_OK;
}

/* The field lies on the grid of the image from which it takes points, or on another with the same mm. */
static conus_status check_from(const conus_volume_info *field, const char *from)
{
    conus_volume_info image;
    double a[16];
    double b[16];
    double worst = 0;
    conus_status status = volume_file_header(&image, from);
    status = status ? status : world_from_flirt(a, field);
    status = status ? status : world_from_flirt(b, &image);
    for (int corner = 0; !status && corner < 8; corner++) {
        double p[3];
        double q[3];
        for (int i = 0; i < 3; i++) {
            p[i] = corner >> i & 1 ? (double)field->dim[i] * field->spacing[i] : 0;
        }
        mat4_point(q, b, p);
        mat4_point(p, a, p);
        vec3_sub(p, p, q);
        worst = fmax(worst, vec3_length(p));
    }
    return status || worst <= NEAR ? status
                                   : fail(CONUS_ERROR_ARGUMENT,
                                          "from: %s lies up to %.3g mm from where the field does: the image on whose "
                                          "grid the field was made (--ref) is needed",
                                          from, worst);
}

static conus_status set_flirt(struct deformation *field, enum field_kind kind, const conus_volume_info *grid,
                              const conus_transform_options *options, struct notes *notes)
{
    conus_volume_info to;
    double world[16];
    double flirt[16];
    conus_status status;
    if ((status = check_from(grid, options->from)) || (status = volume_file_header(&to, options->to)) ||
        (status = world_from_flirt(world, &to))) {
        return status;
    }
    flirt_from_voxel(flirt, grid);
    bool look = look_like_positions(field, flirt);
    bool stated = kind == FIELD_FNIRT || options->vectors;
    bool positions = stated ? options->vectors == CONUS_VECTORS_ABSOLUTE : look;
    status = note_looks(positions, look, notes);
    if (!status && positions && 2 * spread(field, grid->world_from_voxel) < spread(field, flirt)) {
        status =
            notes_warn(notes, "the positions look like those in RAS mm, as MRtrix has them, and not like FSL's: is "
                              "',space=ras,absolute' meant, in place of from= and to=?");
    } else if (!status && !positions && !stated) {
        status = notes_add(notes, "the header does not say whose field it is; by from= and to= it is taken for FSL's; "
                                  "for displacements in RAS mm (MRtrix, SynthMorph, VoxelMorph) ',space=ras,relative' "
                                  "is needed in their place");
    }
    if (status) {
        return status;
    }
    if (positions) {
        memset(flirt, 0, sizeof flirt);
        flirt[15] = 1;
    }
    mat4_multiply(field->base, world, flirt);
    memcpy(field->linear, world, sizeof world);
    memset(field->linear + 12, 0, 3 * sizeof *world);
    return check_finite(field);
}

conus_status field_file_read(struct deformation *out, const char *path, const conus_transform_options *options,
                             struct file_sums *read, struct notes *notes)
{
    struct volume_file file = {0};
    struct deformation field = {0};
    struct notes found = {0};
    enum field_kind kind = FIELD_VECTORS;
    const conus_load_options alike = {.max_memory = options->max_memory};
    conus_status status = find_kind(&kind, path, options);
    status = status ? status : volume_file_open_series(&file, path, &alike, notes);
    if (status) {
        return status;
    }
    bool is_flirt = kind == FIELD_FSL || kind == FIELD_FNIRT;
    status = read_vectors(&field, &file, options->max_memory);
    status = status     ? status
             : is_flirt ? set_flirt(&field, kind, &file.info, options, &found)
                        : set_vectors(&field, kind, options->vectors, &found);
    status = status ? status : deformation_measure(&field);
    status = status ? fail_in(status, path) : file_sums_put(read, file.info.path, file.info.sha256);
    status = status ? status : notes_move_in(notes, &found, path);
    if (!status) {
        *out = field;
    } else {
        deformation_finish(&field);
    }
    notes_finish(&found);
    volume_file_finish(&file);
    return status;
}
