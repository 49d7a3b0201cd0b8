/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads deformation fields, and finds out what their vectors mean. */
#include "loaders/transform/transform.h"

#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "loaders/volumes/volumes.h"
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

void field_header_parse(struct job *job, struct field_header *out, struct text head)
{
    const uint8_t *data = (const uint8_t *)head.data;
    bool first = head.size >= 4 && (order_u32(data, false) == NIFTI1_SIZE || order_u32(data, true) == NIFTI1_SIZE);
    size_t needed = first ? NIFTI1_SIZE : FIELD_HEADER_SIZE;
    *out = (struct field_header){0};
    if (head.size < needed) {
        job_bad(job, "header: found %zu bytes, %zu are needed", head.size, needed);
        return;
    }
    bool swapped = order_u32(data, false) != needed;
    out->intent_code = first ? order_i16(data + 68, swapped) : order_i32(data + 504, swapped);
    for (size_t i = 0; i < 8; i++) {
        out->dim[i] = first ? order_i16(data + 40 + 2 * i, swapped) : order_i64(data + 16 + 8 * i, swapped);
    }
    out->parameter = first ? (double)order_f32(data + 56, swapped) : order_f64(data + 80, swapped);
    memcpy(out->intent_name, data + (first ? 328 : 508), NAME_SIZE);
}

/* X x Y x Z x 1 x 3, or X x Y x Z x 3. */
static void check_shape(struct job *job, const struct field_header *header)
{
    const int64_t *dim = header->dim;
    bool five = dim[0] == 5 && dim[4] == 1 && dim[5] == 3;
    bool four = dim[0] == 4 && dim[4] == 3;
    if (dim[0] == 5 && dim[4] == 3 && dim[5] == 4) {
        job_refuse(job, "dim: found X x Y x Z x 3 x 4, MRtrix's warp of both ways; 'warpconvert -type "
                        "warpfull2deformation' makes a field of it");
    }
    if (!five && !four) {
        job_bad(job,
                "dim: found %lld: %lld x %lld x %lld x %lld x %lld: this is a volume, but no deformation field, "
                "which has 5 dimensions (X x Y x Z x 1 x 3), or 4 (X x Y x Z x 3)",
                (long long)dim[0], (long long)dim[1], (long long)dim[2], (long long)dim[3],
                (long long)(dim[0] > 3 ? dim[4] : 1), (long long)(dim[0] > 4 ? dim[5] : 1));
    }
    for (int i = 1; i < 4; i++) {
        if (dim[i] < 2) {
            job_bad(job, "dim[%d]: found %lld, a field has 2 or more", i, (long long)dim[i]);
        }
    }
}

/* A field whose numbers are mm of FSL's two images. */
static enum field_kind flirt_kind(struct job *job, const struct field_header *header, conus_vectors vectors,
                                  conus_file_space space)
{
    if (header->dim[0] == 5) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "dim: found 5, but from and to are for FSL's fields, which have 4 (X x Y x Z x 3)");
    } else if (space) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "space= is for fields in mm of the world, from= and to= for FSL's, which are in mm of the two "
                 "images: one of them is needed");
    }
    return header->intent_code == FNIRT_FIELD && !vectors ? FIELD_FNIRT : FIELD_FSL;
}

/* Whether the header is of NiftyReg's positions or displacements; *foreign: of its other kinds. */
static bool is_niftyreg(bool *foreign, const struct field_header *header)
{
    const double kind = header->parameter;
    bool is_reg = strcmp(header->intent_name, "NREG_TRANS") == 0 && (kind == 0 || kind == 1);
    *foreign = strncmp(header->intent_name, "NREG_", 5) == 0 && !is_reg;
    return is_reg;
}

/* What a header says of vectors that are in RAS then. */
static conus_vectors read_statement(struct job *job, const struct field_header *header)
{
    bool foreign;
    bool is_reg = is_niftyreg(&foreign, header);
    if (foreign) {
        job_refuse(job,
                   "intent_name: found \"%s\", intent_p1 %g, a grid or velocities of NiftyReg: 'reg_transform -ref "
                   "IMAGE -def FILE OUT' makes positions of it, which are read (0), as displacements (1) are",
                   header->intent_name, header->parameter);
    }
    bool is_absolute = is_reg ? header->parameter == 0 : strcmp(header->intent_name, "Mapping") == 0; /* SPM's name */
    return is_absolute ? CONUS_VECTORS_ABSOLUTE : is_reg ? CONUS_VECTORS_RELATIVE : CONUS_VECTORS_AS_STATED;
}

static enum field_kind vectors_kind(struct job *job, const struct field_header *header, conus_vectors vectors,
                                    conus_file_space space)
{
    const int code = header->intent_code;
    const char *name = header->intent_name;
    const conus_vectors stated = read_statement(job, header);
    if (header->dim[0] == 4 && (code == FNIRT_FIELD || !(stated || space))) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 code == FNIRT_FIELD
                     ? "dim: found 4, a field of FSL's kind, whose numbers mean nothing without its two images: "
                       "from=IMAGE and to=IMAGE are needed (fields of ITK and SPM have 5 dimensions)"
                     : "dim: found 4, and nothing says whose field it is: from=IMAGE and to=IMAGE are needed for "
                       "FSL's, ',space=ras,absolute' for positions in RAS mm (MRtrix's warpconvert, EasyReg), "
                       "',space=ras,relative' for displacements (SynthMorph; VoxelMorph's if in mm, not in voxels)");
    }
    if (stated && ((vectors && vectors != stated) || space == CONUS_FILE_SPACE_LPS)) {
        bool positions = stated == CONUS_VECTORS_ABSOLUTE;
        job_fail(job, CONUS_ERROR_ARGUMENT, "intent_name: found \"%s\", intent_p1 %g: %s in RAS, not %s", name,
                 header->parameter, positions ? "positions" : "displacements",
                 space == CONUS_FILE_SPACE_LPS ? "LPS"
                 : positions                   ? "relative"
                                               : "absolute");
    }
    if (code == INTENT_DISPLACEMENT && stated && !vectors) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "intent_code: found 1006 (displacements), and intent_name \"%s\": ',relative' or ',absolute' is "
                 "needed",
                 name);
    }
    vectors = vectors ? vectors : stated;
    vectors = !vectors && code == INTENT_DISPLACEMENT ? CONUS_VECTORS_RELATIVE : vectors;
    bool is_ras = stated || (code == INTENT_DISPLACEMENT && vectors == CONUS_VECTORS_RELATIVE);
    space = space ? space : is_ras ? CONUS_FILE_SPACE_RAS : CONUS_FILE_SPACE_AS_STATED;
    if (space && !vectors) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "space: ',relative' (displacements) or ',absolute' (positions) is needed, too");
    }
    if (code == INTENT_NONE && !vectors) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "space: another than LPS, in which ITK has displacements: ',space=ras,relative' or "
                 "',space=lps,relative' states theirs");
    } else if (code != INTENT_VECTOR && code != INTENT_DISPLACEMENT && !vectors) {
        job_bad(job,
                "intent_code: found %d, fields have 1007 (vector) or 1006; ',relative' states displacements in LPS, as "
                "ITK has them, ',absolute' positions in RAS, as SPM has them",
                code);
    }
    return vectors == CONUS_VECTORS_RELATIVE   ? (space == CONUS_FILE_SPACE_RAS ? FIELD_RAS : FIELD_ITK)
           : vectors == CONUS_VECTORS_ABSOLUTE ? (space == CONUS_FILE_SPACE_LPS ? FIELD_LPS : FIELD_SPM)
                                               : FIELD_VECTORS;
}

/* Words for a file with this header ("a deformation field of SPM", static): a field that
 * conus_atlas_transform() may take, *usable, or what a program of registration writes besides. NULL where it says
 * nothing of the kind, as 4-D fields do that FSL's tools but fnirt's write. */
static const char *field_header_words(bool *usable, const struct field_header *header)
{
    const int64_t *dim = header->dim;
    const int code = header->intent_code;
    bool foreign;
    bool vectors = dim[0] == 5 && dim[4] == 1 && dim[5] == 3;
    (void)is_niftyreg(&foreign, header);
    if (vectors && foreign) {
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

enum field_kind field_header_kind(struct job *job, const struct field_header *header, bool has_images,
                                  conus_vectors vectors, conus_file_space space)
{
    int code = header->intent_code;
    if (code == CUBIC_SPLINES || code == COSINES || code == QUADRATIC_SPLINES) {
        job_refuse(job,
                   "intent_code: found %d, coefficients of fnirt; 'convertwarp --ref=IMAGE --warp1=FILE --out=FIELD' "
                   "makes a field of them, 'invwarp --ref=IMAGE --warp=FILE --out=FIELD' that of the other direction",
                   code);
    } else if (code == TOPUP_CUBIC || code == TOPUP_QUADRATIC || code == TOPUP_FIELD) {
        job_refuse(job, "intent_code: found %d, topup's, which moves no points between two images", code);
    }
    check_shape(job, header);
    return (has_images ? flirt_kind : vectors_kind)(job, header, vectors, space);
}

enum { LATTICE = 64 }; /* nodes along an axis that show what vectors are */

#define NEAR 0.01 /* mm by which the field's grid and FSL's image may differ */

static bool is_nifti(const struct source *source)
{
    return nifti_has_magic((const uint8_t *)source->head.bytes.data, source->head.bytes.size);
}

/* The header of a volume, whose reader says the path, which is the innermost place. */
static void read_info(struct job *job, conus_volume_info *out, const struct source *source)
{
    *out = (conus_volume_info){0};
    job_out(job, job->depth - 1);
    volume_header_read(job, out, source->file.path);
    job_in(job, source->file.path, JOB_ALONE);
}

bool field_is(struct job *job, const struct source *source)
{
    conus_volume_info info;
    if (is_nifti(source)) {
        return true;
    }
    read_info(job, &info, source);
    return job_ok(job) && info.volume_count == 3;
}

/* Of a NIfTI file what the header says of vectors; NRRD and MetaImage have displacements in LPS, like their header, as
 * ITK, elastix and 3D Slicer write them. */
static struct field_header read_header(struct job *job, const struct source *source)
{
    const struct text head = source->head.bytes;
    struct field_header header = {.intent_code = INTENT_VECTOR, .dim = {5, 0, 0, 0, 1, 3}};
    conus_volume_info info;
    if (is_nifti(source)) {
        field_header_parse(job, &header, head);
        return header;
    }
    if (text_mentions(head, "displacement field type:=modeling")) {
        job_refuse(job, "displacement field type: found modeling, which moves points the other way; invert it in 3D "
                        "Slicer and save it again");
    }
    read_info(job, &info, source);
    for (int a = 0; a < 3; a++) {
        header.dim[a + 1] = (int64_t)info.dim[a];
    }
    if (text_starts(head, "NRRD") && !text_mentions(head, "space: left-posterior-superior") &&
        !text_mentions(head, "space: LPS")) {
        header.intent_code = INTENT_NONE; /* a space must be stated */
    }
    return header;
}

const char *field_words(bool *usable, const struct source *source)
{
    struct field_header header;
    struct job job = {0}; /* reading the volume says what is wrong */
    *usable = false;
    field_header_parse(&job, &header, source->head.bytes);
    const char *words = is_nifti(source) && job_ok(&job) ? field_header_words(usable, &header) : NULL;
    job_end(&job);
    return words;
}

static enum field_kind find_kind(struct job *job, const struct source *source, const conus_transform_options *options)
{
    const struct field_header header = read_header(job, source);
    if (!options->from != !options->to) {
        job_fail(job, CONUS_ERROR_ARGUMENT, "%s=IMAGE is needed, too", options->from ? "to" : "from");
    }
    const enum field_kind kind = field_header_kind(job, &header, options->from, options->vectors, options->space);
    if (options->inverse) {
        job_refuse(job, "a deformation field is not inverted; the field of the other direction is needed: "
                        "1InverseWarp.nii.gz for 1Warp.nii.gz, iy_ for y_, or what FSL's 'invwarp' writes");
    }
    return kind;
}

static size_t count_nodes(const struct deformation *field)
{
    return field->dim[0] * field->dim[1] * field->dim[2];
}

static void read_vectors(struct job *job, struct deformation *out, struct volume_file *file)
{
    const uint64_t limit = memory_limit(job->max_memory);
    memcpy(out->dim, file->info.dim, sizeof out->dim);
    memcpy(out->world_from_voxel, file->info.world_from_voxel, sizeof out->world_from_voxel);
    const size_t count = count_nodes(out);
    if (!mat4_invert_affine(out->voxel_from_world, out->world_from_voxel)) {
        job_bad(job, "%s: the matrix is singular", file->info.transform);
    } else if (file->info.volume_count != 3) {
        job_fail(job, CONUS_ERROR_IO, FILE_CHANGED);
    } else if (count > limit / (3 * sizeof *out->vectors)) {
        job_fail(job, CONUS_ERROR_MEMORY,
                 "dim: %zu vectors take %zu bytes each, allowed are %llu in all (--max-memory)", count,
                 3 * sizeof *out->vectors, (unsigned long long)limit);
    }
    out->vectors = job_step(job) ? memory_raw(count, 3 * sizeof *out->vectors) : NULL;
    for (size_t n = 0; job_need(job, out->vectors) && n < 3; n++) {
        const struct attempt attempt = job_try(job);
        volume_select(job, file, n);
        float *values = volume_values_or_nan(job, file);
        attempt_end(job, &attempt, ATTEMPT_SILENT); /* about numbers that are not finite: the caller counts them */
        for (size_t i = 0; values && i < count; i++) {
            out->vectors[3 * i + n] = values[i];
        }
        memory_free(values);
    }
}

static void check_finite(struct job *job, const struct deformation *field)
{
    const size_t *dim = field->dim;
    for (size_t i = 0; job_ok(job) && i < 3 * count_nodes(field); i++) {
        if (!isfinite(field->vectors[i])) {
            size_t node = i / 3;
            job_bad(job, "voxel (%zu, %zu, %zu): a vector that is not finite", node % dim[0], node / dim[0] % dim[1],
                    node / dim[0] / dim[1]);
        }
    }
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

static void note_looks(struct job *job, const struct source *source, bool positions, bool look)
{
    if (positions != look) {
        job_warn(job, "%s: the vectors are taken for %s, but look like %s", source->file.path,
                 look ? "displacements" : "positions", look ? "positions" : "displacements");
    }
}

/* Decides between ITK's and SPM's: a field whose header does not say must not look like the other kind. Nor must one of
 * intent 1006, which ITK and 3D Slicer write for displacements, and others (VISTASOFT) for positions; @p is_stated: the
 * caller says which. */
static void set_vectors(struct job *job, struct deformation *field, enum field_kind kind, bool is_stated,
                        struct source *source)
{
    static const double flip[16] = {-1, [5] = -1, [10] = 1, [15] = 1};
    double lps[16];
    mat4_multiply(lps, flip, field->world_from_voxel);
    bool positions = look_like_positions(field, field->world_from_voxel) || look_like_positions(field, lps);
    if (kind == FIELD_VECTORS && positions) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "the vectors look like positions, and the header does not say so: ',absolute' states positions in "
                 "RAS, as SPM has them, ',relative' displacements in LPS, as ITK has them");
    } else if (kind == FIELD_RAS && positions && !is_stated) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "the header says displacements (intent_code 1006, or NiftyReg's name), and the vectors look like "
                 "positions: ',relative' or ',absolute' states which they are, both in RAS");
    }
    bool absolute = kind == FIELD_SPM || kind == FIELD_LPS;
    note_looks(job, source, absolute, positions);
    mat4_identity(field->linear);
    if (kind != FIELD_SPM && kind != FIELD_RAS) {
        field->linear[0] = field->linear[5] = -1;
    }
    if (absolute) {
        field->base[15] = 1;
        return; /* positions may be missing, as in SPM's inverses outside of the brain */
    }
    memcpy(field->base, field->world_from_voxel, sizeof field->base);
    field->stays_outside = true;
    check_finite(job, field);
}

/* The field lies on the grid of the image from which it takes points, or on another with the same mm. */
static void check_from(struct job *job, const conus_volume_info *field, const char *from)
{
    conus_volume_info image = {0};
    double a[16];
    double b[16];
    double worst = 0;
    volume_header_read(job, &image, from);
    world_from_flirt(job, a, field);
    world_from_flirt(job, b, &image);
    for (int corner = 0; job_ok(job) && corner < 8; corner++) {
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
    if (!(worst <= NEAR)) {
        job_fail(job, CONUS_ERROR_ARGUMENT,
                 "from: %s lies up to %.3g mm from where the field does: the image on whose grid the field was made "
                 "(--ref) is needed",
                 from, worst);
    }
}

static void set_flirt(struct job *job, struct deformation *field, enum field_kind kind, const conus_volume_info *grid,
                      const conus_transform_options *options, struct source *source)
{
    conus_volume_info to = {0};
    double world[16];
    double flirt[16];
    check_from(job, grid, options->from);
    volume_header_read(job, &to, options->to);
    world_from_flirt(job, world, &to);
    if (!job_ok(job)) {
        return;
    }
    flirt_from_voxel(flirt, grid);
    bool look = look_like_positions(field, flirt);
    bool stated = kind == FIELD_FNIRT || options->vectors;
    bool positions = stated ? options->vectors == CONUS_VECTORS_ABSOLUTE : look;
    note_looks(job, source, positions, look);
    if (positions && 2 * spread(field, grid->world_from_voxel) < spread(field, flirt)) {
        job_warn(job,
                 "%s: the positions look like those in RAS mm, as MRtrix has them, and not like FSL's: is "
                 "',space=ras,absolute' meant, in place of from= and to=?",
                 source->file.path);
    } else if (!positions && !stated) {
        job_note(job,
                 "%s: the header does not say whose field it is; by from= and to= it is taken for FSL's; for "
                 "displacements in RAS mm (MRtrix, SynthMorph, VoxelMorph) ',space=ras,relative' is needed in their "
                 "place",
                 source->file.path);
    }
    if (positions) {
        memset(flirt, 0, sizeof flirt);
        flirt[15] = 1;
    }
    mat4_multiply(field->base, world, flirt);
    memcpy(field->linear, world, sizeof world);
    memset(field->linear + 12, 0, 3 * sizeof *world);
    check_finite(job, field);
}

void field_read(struct job *job, struct transform_chain *out, struct source *source,
                const conus_transform_options *options)
{
    struct volume_file file = {0};
    const enum field_kind kind = find_kind(job, source, options);
    job_out(job, job->depth - 1); /* the reader of volumes says the path itself */
    volume_load_series(job, &file, source->file.path, job->max_memory);
    job_in(job, source->file.path, JOB_ALONE);
    struct deformation *field = job_step(job) ? memory_zeroed(1, sizeof *field) : NULL;
    if (job_need(job, field)) {
        out->fields = field;
        out->count = 1;
        read_vectors(job, field, &file);
        const bool is_read = job_ok(job) && field->vectors;
        if (is_read && (kind == FIELD_FSL || kind == FIELD_FNIRT)) {
            set_flirt(job, field, kind, &file.info, options, source);
        } else if (is_read) {
            set_vectors(job, field, kind, options->vectors, source);
        }
        (void)JOB_CALL(job, deformation_measure(field));
        (void)JOB_CALL(job, file_sums_put(&job->files, file.info.path, file.info.sha256));
    }
    volume_file_finish(&file);
}
