/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks NIfTI headers and extensions, and chooses between qform, sform and the plain grid. */
#include "loaders/volumes/nifti.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/geometry/math3.h"
#include "base/memory.h"
#include "base/notes.h"
#include "base/tolerance.h"
#include "sources/format.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* The header's fields about space, as stored. */
struct nifti_placement {
    double pixdim[8]; /* [0] = qfac, [1..3] = size of a voxel in `units`.                        */
    int units;        /* xyzt_units; its lowest three bits: 1 = m, 2 = mm, 3 = micrometres.       */
    int qform_code, sform_code;
    double quatern[3], qoffset[3]; /* b, c, d and the centre of voxel (0, 0, 0).                  */
    double srow[12];               /* Three rows of world_from_voxel.                            */
};

/* nifti1_io.c: what is less than this from a sum of squares of 1 is a half turn, which float32 would tilt by 0.03 deg.
 */
static const double HALF_TURN = 1e-7;

static conus_status check_pixdim(const double pixdim[8])
{
    for (int i = 1; i < 4; i++) {
        if (!(pixdim[i] > 0) || !isfinite(pixdim[i])) {
            return fail(CONUS_ERROR_DATA, "pixdim[%d]: found %g, allowed are finite numbers above 0", i, pixdim[i]);
        }
    }
    return CONUS_OK;
}

/* METHOD 1: only the sizes of voxels are known. FSL and nibabel take such grids as radiological (i grows towards the
 * left) and centred on the origin, and so does conus. */
static conus_status place_sizes(double out[16], const conus_volume_info *info, const double pixdim[8])
{
    conus_status status = check_pixdim(pixdim);
    mat4_identity(out);
    for (int i = 0; i < 3; i++) {
        double step = i == 0 ? -pixdim[1] : pixdim[i + 1];
        out[5 * i] = step;
        out[12 + i] = -step * ((double)info->dim[i] - 1) / 2;
    }
    return status;
}

/* The rotation of the quaternion (a, b, c, d), |.| = 1, columns scaled by `scale`. */
static void rotation_from(double out[16], double a, const double bcd[3], const double scale[3])
{
    double b = bcd[0];
    double c = bcd[1];
    double d = bcd[2];
    const double columns[9] = {
        a * a + b * b - c * c - d * d, 2 * (b * c + a * d),           2 * (b * d - a * c),
        2 * (b * c - a * d),           a * a + c * c - b * b - d * d, 2 * (c * d + a * b),
        2 * (b * d + a * c),           2 * (c * d - a * b),           a * a + d * d - b * b - c * c};
    for (int i = 0; i < 9; i++) {
        out[4 * (i / 3) + i % 3] = columns[i] * scale[i / 3];
    }
}

/* METHOD 2. */
static conus_status place_qform(double out[16], const struct nifti_placement *p)
{
    double qfac = p->pixdim[0];
    if (qfac < 0 ? !tolerance_same(qfac, -1) : !isfinite(qfac)) {
        return fail(CONUS_ERROR_DATA, "pixdim[0] (qfac): found %g, allowed are -1 and 1", qfac);
    }
    double squares = vec3_dot(p->quatern, p->quatern);
    if (!(squares <= 1 + 2 * TOLERANCE)) { /* each of the numbers was rounded */
        return fail(CONUS_ERROR_DATA,
                    "quatern_b, c, d: found %.9g, %.9g, %.9g, allowed are numbers whose squares sum to "
                    "at most 1",
                    p->quatern[0], p->quatern[1], p->quatern[2]);
    }
    double a = 1 - squares < HALF_TURN ? 0 : sqrt(1 - squares);
    double bcd[3];
    vec3_scale(bcd, p->quatern, a == 0 ? 1 / sqrt(squares) : 1);
    const double scale[3] = {p->pixdim[1], p->pixdim[2], qfac < 0 ? -p->pixdim[3] : p->pixdim[3]};
    mat4_identity(out);
    rotation_from(out, a, bcd, scale);
    memcpy(out + 12, p->qoffset, sizeof p->qoffset);
    return check_pixdim(p->pixdim);
}

/* The sform is in use; says so where the qform would lead elsewhere. */
static conus_status note_other(const conus_volume_info *info, const struct nifti_placement *p, double mm,
                               const double used[16], struct notes *notes)
{
    double other[16];
    if (place_qform(other, p)) {
        return notes_add(notes, "the qform (code %d) is not valid and was not used; the sform (code %d) was",
                         p->qform_code, p->sform_code);
    }
    double distance = mm * space_corner_distance(info->dim, used, other);
    return distance <= 1
               ? CONUS_OK
               : notes_add(notes,
                           "the sform (code %d, %s) and the qform (code %d, %s) put a corner of the grid %.4g mm "
                           "apart; the sform was used",
                           p->sform_code, space_code_name(p->sform_code), p->qform_code, space_code_name(p->qform_code),
                           distance);
}

/* Sets world_from_voxel, spacing, orientation and transform of `info`, whose dim is set. The sform wins over the
 * qform; without either, the voxel sizes alone are used as FSL and nibabel do. Notes say what a careful user should
 * know: no transform, two that differ, units that are not millimetres. */
static conus_status nifti_place(conus_volume_info *info, const struct nifti_placement *p, struct notes *notes)
{
    static const double millimetres[8] = {1, 1000, 1, 0.001, 1, 1, 1, 1};
    double mm = millimetres[p->units & 7];
    double world[16];
    char words[sizeof info->transform];
    conus_status status = CONUS_OK;
    if (p->sform_code > 0) { /* METHOD 3 */
        snprintf(words, sizeof words, "sform, code %d (%s)", p->sform_code, space_code_name(p->sform_code));
        mat4_identity(world);
        for (int i = 0; i < 12; i++) {
            world[4 * (i % 4) + i / 4] = p->srow[i];
        }
        status = p->qform_code > 0 ? note_other(info, p, mm, world, notes) : CONUS_OK;
    } else if (p->qform_code > 0) {
        snprintf(words, sizeof words, "qform, code %d (%s)", p->qform_code, space_code_name(p->qform_code));
        status = place_qform(world, p);
    } else {
        snprintf(words, sizeof words, "none: voxel sizes only, grid centred on the origin, i towards the left");
        status = place_sizes(world, info, p->pixdim);
        status =
            status ? status
                   : notes_warn(notes, "neither sform nor qform is set: left and right, and the origin, are a "
                                       "guess (i towards the left, grid centred on the origin); an sform states them");
    }
    if (!status && mm != 1) {
        status = notes_add(notes, "xyzt_units says %s: positions were multiplied by %g to get millimetres",
                           mm > 1 ? "metres" : "micrometres", mm);
    }
    if (status) {
        return status;
    }
    for (int i = 0; i < 16; i++) {
        world[i] *= i % 4 < 3 ? mm : 1;
    }
    info->space_code = p->sform_code > 0 ? p->sform_code : p->qform_code > 0 ? p->qform_code : 0;
    return space_describe(info, world, words);
}

enum { EXTENDER_SIZE = 4, EXTENSION_HEAD_SIZE = 8, EXTENSION_UNIT = NIFTI_EXTENSION_LEAST };

/* The fields that matter, of either version. */
struct fields {
    int version;
    bool swapped;
    bool pair;
    int64_t dim[8];
    double vox_offset;
    double slope, inter;
    int datatype, bitpix, intent_code;
    struct nifti_placement placement;
};

static void read_floats(double *out, size_t count, const uint8_t *data, bool swapped)
{
    for (size_t i = 0; i < count; i++) {
        out[i] = (double)order_f32(data + 4 * i, swapped);
    }
}

static void read_doubles(double *out, size_t count, const uint8_t *data, bool swapped)
{
    for (size_t i = 0; i < count; i++) {
        out[i] = order_f64(data + 8 * i, swapped);
    }
}

/* Offsets: nifti1.h. */
static void read_fields_1(struct fields *f, const uint8_t *data)
{
    bool swapped = f->swapped;
    for (size_t i = 0; i < 8; i++) {
        f->dim[i] = order_i16(data + 40 + 2 * i, swapped);
    }
    f->intent_code = order_i16(data + 68, swapped);
    f->datatype = order_i16(data + 70, swapped);
    f->bitpix = order_i16(data + 72, swapped);
    read_floats(f->placement.pixdim, 8, data + 76, swapped);
    f->vox_offset = (double)order_f32(data + 108, swapped);
    f->slope = (double)order_f32(data + 112, swapped);
    f->inter = (double)order_f32(data + 116, swapped);
    f->placement.units = data[123];
    f->placement.qform_code = order_i16(data + 252, swapped);
    f->placement.sform_code = order_i16(data + 254, swapped);
    read_floats(f->placement.quatern, 3, data + 256, swapped);
    read_floats(f->placement.qoffset, 3, data + 268, swapped);
    read_floats(f->placement.srow, 12, data + 280, swapped);
}

/* Offsets: nifti2.h. */
static void read_fields_2(struct fields *f, const uint8_t *data)
{
    bool swapped = f->swapped;
    for (size_t i = 0; i < 8; i++) {
        f->dim[i] = order_i64(data + 16 + 8 * i, swapped);
    }
    f->datatype = order_i16(data + 12, swapped);
    f->bitpix = order_i16(data + 14, swapped);
    read_doubles(f->placement.pixdim, 8, data + 104, swapped);
    f->vox_offset = (double)order_i64(data + 168, swapped);
    f->slope = order_f64(data + 176, swapped);
    f->inter = order_f64(data + 184, swapped);
    f->placement.qform_code = order_i32(data + 344, swapped);
    f->placement.sform_code = order_i32(data + 348, swapped);
    read_doubles(f->placement.quatern, 3, data + 352, swapped);
    read_doubles(f->placement.qoffset, 3, data + 376, swapped);
    read_doubles(f->placement.srow, 12, data + 400, swapped);
    f->placement.units = order_i32(data + 500, swapped);
    f->intent_code = order_i32(data + 504, swapped);
}

static conus_status read_fields(struct fields *f, const uint8_t *data, size_t size)
{
    if (!nifti_is(data, size)) {
        return fail(CONUS_ERROR_DATA, "sizeof_hdr: found %d, allowed are 348 (NIfTI-1) and 540 (NIfTI-2)",
                    size < 4 ? 0 : order_i32(data, false));
    }
    f->version = nifti_is_version_1(data) ? 1 : 2;
    size_t needed = f->version == 1 ? NIFTI1_SIZE : NIFTI2_SIZE;
    if (size < needed) {
        return fail(CONUS_ERROR_DATA, "header: found %zu bytes, NIfTI-%d needs %zu", size, f->version, needed);
    }
    f->pair = nifti_magic_is(data, size, "ni");
    if (!f->pair && !nifti_magic_is(data, size, "n+")) {
        const char *magic = (const char *)data + (f->version == 1 ? 344 : 4);
        return fail(
            CONUS_ERROR_DATA,
            "magic: found \"%.*s\", allowed are \"n+%d\" and \"ni%d\" (ANALYZE 7.5, which has no magic, does not "
            "say which side is left)",
            4, magic, f->version, f->version);
    }
    f->swapped = order_u32(data, false) != needed;
    (f->version == 1 ? read_fields_1 : read_fields_2)(f, data);
    return CONUS_OK;
}

/* A slope that is 0 or not finite means "unscaled" (nifti1.h says so of 0; NaN is what many programs write). */
static conus_status read_scaling(conus_volume_info *info, const struct fields *f)
{
    info->slope = 1;
    info->intercept = 0;
    if (isinf(f->slope)) {
        return fail(CONUS_ERROR_DATA, "scl_slope: found %g, allowed are finite numbers", f->slope);
    }
    if (f->slope == 0 || isnan(f->slope)) {
        return CONUS_OK;
    }
    if (!isfinite(f->inter)) {
        return fail(CONUS_ERROR_DATA, "scl_inter: found %g with scl_slope %g, allowed are finite numbers", f->inter,
                    f->slope);
    }
    info->slope = f->slope;
    info->intercept = f->inter;
    return CONUS_OK;
}

/* What the values are, where the intent is that of a statistic; "" = another one. */
static const char *unit_of(int intent_code)
{
    static const char *const units[] = {[2] = "r", [3] = "t", [4] = "F", [5] = "z", [6] = "\u03c7\u00b2", [22] = "p"};
    const char *unit = intent_code >= 0 && intent_code <= 22 ? units[intent_code] : NULL;
    return unit ? unit : "";
}

/* The fields that volumes and matrices have in common. */
static conus_status begin_header(struct volume_header *out, struct fields *f)
{
    *out = (struct volume_header){.swapped = f->swapped,
                                  .pair = f->pair,
                                  .header_size = f->version == 1 ? NIFTI1_SIZE : NIFTI2_SIZE,
                                  .intent_code = f->intent_code};
    snprintf(out->info.format, sizeof out->info.format, "NIfTI-%d", f->version);
    snprintf(out->info.unit, sizeof out->info.unit, "%s", unit_of(f->intent_code));
    conus_status status = volume_header_set_datatype(out, f->datatype);
    if (status) {
        return status;
    }
    int bitpix = 8 * (int)volume_datatype_size(out->datatype);
    if (f->bitpix != bitpix) {
        return fail(CONUS_ERROR_DATA, "bitpix: found %d, datatype %s needs %d", f->bitpix, out->info.datatype, bitpix);
    }
    if (f->dim[0] < 1 || f->dim[0] > 7) {
        return fail(CONUS_ERROR_DATA, "dim[0]: found %lld, allowed are 1 to 7", (long long)f->dim[0]);
    }
    for (int i = 1; i < 8; i++) {
        f->dim[i] = i > f->dim[0] ? 1 : f->dim[i];
        if (f->dim[i] < 1) {
            return fail(CONUS_ERROR_DATA, "dim[%d]: found %lld, allowed is 1 or more", i, (long long)f->dim[i]);
        }
    }
    if ((status = volume_header_set_dim(out, f->dim + 1)) || (status = read_scaling(&out->info, f))) {
        return status;
    }
    double least = f->pair ? 0 : (double)(out->header_size + EXTENDER_SIZE);
    if (!(f->vox_offset >= least && f->vox_offset <= 0x1p53 && f->vox_offset == floor(f->vox_offset))) {
        return fail(CONUS_ERROR_DATA, "vox_offset: found %.9g, allowed are whole numbers from %g", f->vox_offset,
                    least);
    }
    out->offset = (uint64_t)f->vox_offset;
    return CONUS_OK;
}

conus_status nifti_matrix_parse(struct volume_header *out, size_t shape[2], const uint8_t *data, size_t size)
{
    struct fields f = {0};
    struct volume_header header;
    conus_status status = read_fields(&f, data, size);
    if (status) {
        return status;
    }
    if (f.pair || !nifti_matrix_intent(data, size)) {
        return fail(CONUS_ERROR_DATA, "not a CIFTI-2 file: a single NIfTI-2 file of an intent_code of 3000 to 3099");
    }
    status = begin_header(&header, &f);
    if (status) {
        return status;
    }
    const int64_t *dim = f.dim;
    if (dim[0] != 6 || dim[1] != 1 || dim[2] != 1 || dim[3] != 1 || dim[4] != 1) {
        return fail(CONUS_ERROR_DATA,
                    "dim: found %lld: %lld x %lld x %lld x %lld x ..., a CIFTI matrix has 6 dimensions, the first "
                    "four of them 1",
                    (long long)dim[0], (long long)dim[1], (long long)dim[2], (long long)dim[3], (long long)dim[4]);
    }
    *out = header;
    shape[0] = (size_t)dim[5];
    shape[1] = (size_t)dim[6];
    return CONUS_OK;
}

conus_status nifti_header_parse(struct volume_header *out, const uint8_t *data, size_t size, struct notes *notes)
{
    struct fields f = {0};
    conus_status status = read_fields(&f, data, size);
    if (status) {
        return status;
    }
    const int matrix = nifti_matrix_intent(data, size);
    if (matrix) {
        const struct file_head head = {.bytes = {(const char *)data, size}, .intent = matrix};
        const struct format *kind = format_find(&head, 0);
        return fail(CONUS_ERROR_UNSUPPORTED, "intent_code: found %d, %s, allowed are volumes; %s", f.intent_code,
                    kind->words, kind->way);
    }
    for (int i = 4; !status && i <= f.dim[0] && i < 8; i++) { /* niftilib takes them for 1 */
        status = f.dim[i] ? CONUS_OK : notes_add(notes, "dim[%d]: found 0, which was read as 1", i);
        f.dim[i] = f.dim[i] ? f.dim[i] : 1;
    }
    struct volume_header header;
    status = status ? status : begin_header(&header, &f);
    if (status) {
        return status;
    }
    for (int i = 1; i < 4; i++) { /* an axis that the file does not have has a size of its own choosing */
        bool absent = i > 1 && f.dim[i] == 1 && f.placement.pixdim[i] == 0;
        f.placement.pixdim[i] = absent ? 1 : f.placement.pixdim[i];
    }
    status = nifti_place(&header.info, &f.placement, notes);
    header.has_unit = (f.placement.units & 7) != 0;
    if (!status) {
        *out = header;
    }
    return status;
}

conus_status nifti_extensions_parse(struct volume_extension **out, size_t *count, size_t *end, const struct bytes *head,
                                    const struct volume_header *header)
{
    size_t at = header->header_size + EXTENDER_SIZE;
    *out = NULL;
    *count = 0;
    *end = at < head->size ? at : head->size;
    if (head->size < at || !head->data[header->header_size]) {
        return CONUS_OK;
    }
    struct volume_extension *list = memory_zeroed((head->size - at) / EXTENSION_UNIT, sizeof *list);
    if (!list) {
        return CONUS_ERROR_MEMORY;
    }
    size_t found = 0;
    for (size_t left; (left = head->size - at) >= EXTENSION_HEAD_SIZE;) {
        const uint8_t *start = head->data + at;
        int32_t esize = order_i32(start, header->swapped);
        int32_t ecode = order_i32(start + 4, header->swapped);
        if (esize == 0 && ecode == 0) { /* zeros end the list */
            break;
        }
        if (esize < EXTENSION_UNIT || esize % EXTENSION_UNIT || (size_t)esize > left) {
            memory_free(list);
            return fail(
                CONUS_ERROR_DATA,
                "extension at byte %zu: found esize %d, allowed are multiples of 16 from 16 to the %zu bytes before "
                "the voxels",
                at, esize, left);
        }
        list[found++] =
            (struct volume_extension){ecode, start + EXTENSION_HEAD_SIZE, (size_t)esize - EXTENSION_HEAD_SIZE};
        at += (size_t)esize;
    }
    *out = list;
    *count = found;
    *end = at;
    return CONUS_OK;
}
