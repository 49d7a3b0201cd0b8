/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads and checks NIfTI headers and extensions, and chooses between qform, sform and the plain grid. */
#include "loaders/volumes/volumes.h"

#include "atlas/space.h"
#include "base/byte_order.h"
#include "base/formats/packed.h"
#include "base/geometry/math3.h"
#include "base/path.h"
#include "base/tolerance.h"
#include "loaders/refuse.h"
#include "loaders/volumes/parts.h"
#include "sources/source.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

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

static void check_pixdim(struct job *job, const double pixdim[8])
{
    for (int i = 1; i < 4; i++) {
        if (!(pixdim[i] > 0) || !isfinite(pixdim[i])) {
            job_bad(job, "pixdim[%d]: found %g, allowed are finite numbers above 0", i, pixdim[i]);
        }
    }
}

/* METHOD 1: only the sizes of voxels are known. FSL and nibabel take such grids as radiological (i grows towards the
 * left) and centred on the origin, and so does conus. */
static void place_sizes(struct job *job, double out[16], const conus_volume_info *info, const double pixdim[8])
{
    check_pixdim(job, pixdim);
    mat4_identity(out);
    for (int i = 0; i < 3; i++) {
        double step = i == 0 ? -pixdim[1] : pixdim[i + 1];
        out[5 * i] = step;
        out[12 + i] = -step * ((double)info->dim[i] - 1) / 2;
    }
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
static void place_qform(struct job *job, double out[16], const struct nifti_placement *p)
{
    const double qfac = p->pixdim[0];
    const double squares = vec3_dot(p->quatern, p->quatern);
    mat4_identity(out);
    if (qfac < 0 ? !tolerance_same(qfac, -1) : !isfinite(qfac)) {
        job_bad(job, "pixdim[0] (qfac): found %g, allowed are -1 and 1", qfac);
    }
    if (!(squares <= 1 + 2 * TOLERANCE)) { /* each of the numbers was rounded */
        job_bad(job, "quatern_b, c, d: found %.9g, %.9g, %.9g, allowed are numbers whose squares sum to at most 1",
                p->quatern[0], p->quatern[1], p->quatern[2]);
        return;
    }
    double a = 1 - squares < HALF_TURN ? 0 : sqrt(1 - squares);
    double bcd[3];
    vec3_scale(bcd, p->quatern, a == 0 ? 1 / sqrt(squares) : 1);
    const double scale[3] = {p->pixdim[1], p->pixdim[2], qfac < 0 ? -p->pixdim[3] : p->pixdim[3]};
    rotation_from(out, a, bcd, scale);
    memcpy(out + 12, p->qoffset, sizeof p->qoffset);
    check_pixdim(job, p->pixdim);
}

/* The sform is in use; says so where the qform would lead elsewhere. */
static void note_other(struct job *job, const conus_volume_info *info, const struct nifti_placement *p, double mm,
                       const double used[16])
{
    double other[16];
    const struct attempt attempt = job_try(job);
    place_qform(job, other, p);
    if (attempt_end(job, &attempt, ATTEMPT_TRY)) {
        job_note(job, "the qform (code %d) is not valid and was not used; the sform (code %d) was", p->qform_code,
                 p->sform_code);
        return;
    }
    double distance = mm * space_corner_distance(info->dim, used, other);
    if (distance > 1) {
        job_note(
            job,
            "the sform (code %d, %s) and the qform (code %d, %s) put a corner of the grid %.4g mm apart; the sform "
            "was used",
            p->sform_code, space_code_name(p->sform_code), p->qform_code, space_code_name(p->qform_code), distance);
    }
}

/* Sets world_from_voxel, spacing, orientation and transform of `info`, whose dim is set. The sform wins over the
 * qform; without either, the voxel sizes alone are used as FSL and nibabel do. Notes say what a careful user should
 * know: no transform, two that differ, units that are not millimetres. */
static void nifti_place(struct job *job, conus_volume_info *info, const struct nifti_placement *p)
{
    static const double millimetres[8] = {1, 1000, 1, 0.001, 1, 1, 1, 1};
    double mm = millimetres[p->units & 7];
    double world[16];
    char words[sizeof info->transform];
    if (p->sform_code > 0) { /* METHOD 3 */
        snprintf(words, sizeof words, "sform, code %d (%s)", p->sform_code, space_code_name(p->sform_code));
        mat4_identity(world);
        for (int i = 0; i < 12; i++) {
            world[4 * (i % 4) + i / 4] = p->srow[i];
        }
        if (p->qform_code > 0) {
            note_other(job, info, p, mm, world);
        }
    } else if (p->qform_code > 0) {
        snprintf(words, sizeof words, "qform, code %d (%s)", p->qform_code, space_code_name(p->qform_code));
        place_qform(job, world, p);
    } else {
        snprintf(words, sizeof words, "none: voxel sizes only, grid centred on the origin, i towards the left");
        place_sizes(job, world, info, p->pixdim);
        job_warn(job, "neither sform nor qform is set: left and right, and the origin, are a guess (i towards the "
                      "left, grid centred on the origin); an sform states them");
    }
    if (mm != 1) {
        job_note(job, "xyzt_units says %s: positions were multiplied by %g to get millimetres",
                 mm > 1 ? "metres" : "micrometres", mm);
    }
    for (int i = 0; i < 16; i++) {
        world[i] *= i % 4 < 3 ? mm : 1;
    }
    info->space_code = p->sform_code > 0 ? p->sform_code : p->qform_code > 0 ? p->qform_code : 0;
    (void)JOB_CALL(job, space_describe(info, world, words));
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

static void read_fields(struct job *job, struct fields *f, const uint8_t *data, size_t size)
{
    if (!nifti_is(data, size)) {
        job_bad(job, "sizeof_hdr: found %d, allowed are 348 (NIfTI-1) and 540 (NIfTI-2)",
                size < 4 ? 0 : order_i32(data, false));
        return;
    }
    f->version = nifti_is_version_1(data) ? 1 : 2;
    size_t needed = f->version == 1 ? NIFTI1_SIZE : NIFTI2_SIZE;
    if (size < needed) {
        job_bad(job, "header: found %zu bytes, NIfTI-%d needs %zu", size, f->version, needed);
        return;
    }
    f->pair = nifti_magic_is(data, size, "ni");
    if (!f->pair && !nifti_magic_is(data, size, "n+")) {
        job_bad(job,
                "magic: found \"%.*s\", allowed are \"n+%d\" and \"ni%d\" (ANALYZE 7.5, which has no magic, does not "
                "say which side is left)",
                4, (const char *)data + (f->version == 1 ? 344 : 4), f->version, f->version);
    }
    f->swapped = order_u32(data, false) != needed;
    (f->version == 1 ? read_fields_1 : read_fields_2)(f, data);
}

/* A slope that is 0 or not finite means "unscaled" (nifti1.h says so of 0; NaN is what many programs write). */
static void read_scaling(struct job *job, conus_volume_info *info, const struct fields *f)
{
    const bool is_scaled = f->slope != 0 && !isnan(f->slope);
    info->slope = is_scaled ? f->slope : 1;
    info->intercept = is_scaled ? f->inter : 0;
    if (isinf(f->slope)) {
        job_bad(job, "scl_slope: found %g, allowed are finite numbers", f->slope);
    } else if (!isfinite(info->intercept)) {
        job_bad(job, "scl_inter: found %g with scl_slope %g, allowed are finite numbers", f->inter, f->slope);
    }
}

/* What the values are, where the intent is that of a statistic; "" = another one. */
static const char *unit_of(int intent_code)
{
    static const char *const units[] = {[2] = "r", [3] = "t", [4] = "F", [5] = "z", [6] = "\u03c7\u00b2", [22] = "p"};
    const char *unit = intent_code >= 0 && intent_code <= 22 ? units[intent_code] : NULL;
    return unit ? unit : "";
}

/* The fields that volumes and matrices have in common. */
static void begin_header(struct job *job, struct volume_header *out, struct fields *f)
{
    *out = (struct volume_header){.swapped = f->swapped,
                                  .pair = f->pair,
                                  .header_size = f->version == 1 ? NIFTI1_SIZE : NIFTI2_SIZE,
                                  .intent_code = f->intent_code};
    snprintf(out->info.format, sizeof out->info.format, "NIfTI-%d", f->version);
    snprintf(out->info.unit, sizeof out->info.unit, "%s", unit_of(f->intent_code));
    volume_header_set_datatype(job, out, f->datatype);
    int bitpix = 8 * (int)volume_datatype_size(out->datatype);
    if (f->bitpix != bitpix) {
        job_bad(job, "bitpix: found %d, datatype %s needs %d", f->bitpix, out->info.datatype, bitpix);
    }
    if (f->dim[0] < 1 || f->dim[0] > 7) {
        job_bad(job, "dim[0]: found %lld, allowed are 1 to 7", (long long)f->dim[0]);
    }
    for (int i = 1; i < 8; i++) {
        f->dim[i] = i > f->dim[0] ? 1 : f->dim[i];
        if (f->dim[i] < 1) {
            job_bad(job, "dim[%d]: found %lld, allowed is 1 or more", i, (long long)f->dim[i]);
        }
    }
    volume_header_set_dim(job, out, f->dim + 1);
    read_scaling(job, &out->info, f);
    double least = f->pair ? 0 : (double)(out->header_size + EXTENDER_SIZE);
    if (!(f->vox_offset >= least && f->vox_offset <= 0x1p53 && f->vox_offset == floor(f->vox_offset))) {
        job_bad(job, "vox_offset: found %.9g, allowed are whole numbers from %g", f->vox_offset, least);
        return;
    }
    out->offset = (uint64_t)f->vox_offset;
}

void nifti_matrix_read(struct job *job, struct volume_header *out, size_t shape[2], const uint8_t *data, size_t size)
{
    struct fields f = {0};
    const int64_t *dim = f.dim;
    read_fields(job, &f, data, size);
    if (f.pair || !nifti_matrix_intent(data, size)) {
        job_bad(job, "not a CIFTI-2 file: a single NIfTI-2 file of an intent_code of 3000 to 3099");
    }
    begin_header(job, out, &f);
    if (dim[0] != 6 || dim[1] != 1 || dim[2] != 1 || dim[3] != 1 || dim[4] != 1) {
        job_bad(job,
                "dim: found %lld: %lld x %lld x %lld x %lld x ..., a CIFTI matrix has 6 dimensions, the first four of "
                "them 1",
                (long long)dim[0], (long long)dim[1], (long long)dim[2], (long long)dim[3], (long long)dim[4]);
    }
    shape[0] = (size_t)dim[5];
    shape[1] = (size_t)dim[6];
}

static void parse_header(struct job *job, struct volume_header *out, const struct file_head *head)
{
    struct fields f = {0};
    read_fields(job, &f, (const uint8_t *)head->bytes.data, head->bytes.size);
    if (job_ok(job) && head->intent) {
        const struct format *kind = format_find(head, 0);
        job_refuse(job, "intent_code: found %d, %s, allowed are volumes; %s", f.intent_code, kind->words, kind->way);
    }
    for (int i = 4; i <= f.dim[0] && i < 8; i++) { /* niftilib takes them for 1 */
        if (!f.dim[i]) {
            job_note(job, "dim[%d]: found 0, which was read as 1", i);
            f.dim[i] = 1;
        }
    }
    begin_header(job, out, &f);
    for (int i = 1; i < 4; i++) { /* an axis that the file does not have has a size of its own choosing */
        bool absent = i > 1 && f.dim[i] == 1 && f.placement.pixdim[i] == 0;
        f.placement.pixdim[i] = absent ? 1 : f.placement.pixdim[i];
    }
    out->has_unit = (f.placement.units & 7) != 0;
    if (job_ok(job)) {
        nifti_place(job, &out->info, &f.placement);
    }
}

size_t nifti_extensions_read(struct job *job, struct volume_extension **out, size_t *count, struct text head,
                             const struct volume_header *header)
{
    size_t at = header->header_size + EXTENDER_SIZE;
    *count = 0;
    if (head.size < at || !head.data[header->header_size]) {
        return smaller_of(at, head.size);
    }
    *out = job_zeroed(job, (head.size - at) / EXTENSION_UNIT + 1, sizeof **out);
    for (size_t left; *out && (left = head.size - at) >= EXTENSION_HEAD_SIZE;) {
        const uint8_t *start = (const uint8_t *)head.data + at;
        int32_t esize = order_i32(start, header->swapped);
        int32_t ecode = order_i32(start + 4, header->swapped);
        if (esize == 0 && ecode == 0) { /* zeros end the list */
            break;
        }
        if (esize < EXTENSION_UNIT || esize % EXTENSION_UNIT || (size_t)esize > left) {
            job_bad(
                job,
                "extension at byte %zu: found esize %d, allowed are multiples of 16 from 16 to the %zu bytes before "
                "the voxels",
                at, esize, left);
            break;
        }
        (*out)[(*count)++] =
            (struct volume_extension){ecode, start + EXTENSION_HEAD_SIZE, (size_t)esize - EXTENSION_HEAD_SIZE};
        at += (size_t)esize;
    }
    return at;
}

/* Whether `path` ends in ".ext" or ".ext.gz", whatever the case; *at is where "ext" stands. */
static bool is_half(const char *path, const char *ext, size_t *at)
{
    const size_t length = strlen(path) - (path_ends_in(path, ".gz") ? 3 : 0);
    *at = length > 3 ? length - 3 : 0;
    return length > 4 && path[*at - 1] == '.' && strncasecmp(path + *at, ext, 3) == 0;
}

/* The other half of a pair: in capitals if this half is; packed like this half if there is such a file, else not. */
static const struct source *open_other(struct job *job, const char *path, size_t at, const char *ext)
{
    const bool is_packed = path[at + 3];
    const bool is_capital = path[at] < 'a';
    const char *found = NULL;
    for (int i = 0; i < 2 && !found && job_ok(job); i++) {
        char *other = job_format(job, "%.*s%s%s", (int)at, path, ext, is_packed == !i ? ".gz" : "");
        for (size_t k = at; is_capital && job_ok(job) && k < at + 3; k++) {
            other[k] = (char)(other[k] - 'a' + 'A');
        }
        found = job_has_file(job, other) ? other : NULL;
    }
    if (!found) {
        job_fail(job, CONUS_ERROR_IO, "the other half of the pair is missing: %.*s%s or %.*s%s.gz", (int)at, path, ext,
                 (int)at, path, ext);
        return NULL;
    }
    return volume_beside(job, found);
}

static struct text trim_zeros(struct text text)
{
    while (text.size && text.data[0] == '\0') {
        text.data++;
        text.size--;
    }
    while (text.size && text.data[text.size - 1] == '\0') {
        text.size--;
    }
    return text;
}

/* What is around the header: extensions and text before the voxels, or all of the header's file of a pair. */
static void nifti_around(struct job *job, struct volume_input *v)
{
    enum { HEAD_LIMIT = 1 << 26 };
    const struct source *header = v->other ? v->other : v->source;
    job_at(job, header->file.path, JOB_ALONE);
    struct reader r = source_reader(job, header);
    const bool is_longer = v->header.pair && reader_has(&r, HEAD_LIMIT);
    const struct text head = reader_keep(&r, is_longer        ? HEAD_LIMIT
                                             : v->header.pair ? (size_t)(r.end - r.at)
                                                              : (size_t)v->header.offset);
    const size_t end = nifti_extensions_read(job, &v->extensions, &v->extension_count, head, &v->header);
    if (job_ok(job)) {
        v->embedded = trim_zeros((struct text){head.data + end, head.size - end});
    }
}

static void nifti_open(struct job *job, struct volume_input *v)
{
    size_t at;
    parse_header(job, &v->header, &v->source->head);
    v->run.skip = v->header.offset;
    if (!v->header.pair || v->is_header_only || !job_ok(job)) {
        return;
    }
    if (!is_half(v->keys.path, "hdr", &at)) {
        job_bad(job, "magic: found that of a .hdr/.img pair, but the name does not end in .hdr");
        return;
    }
    const struct source *voxels = open_other(job, v->keys.path, at, "img");
    if (voxels) {
        v->voxels = voxels;
        v->path = voxels->file.path;
        v->run.packing = voxels->is_packed ? RUN_GZIP : RUN_PLAIN;
        v->encoding = voxels->is_packed ? ", gzip" : "";
    }
}

/* The voxels of a pair, which have no mark, whatever they hold. */
static void image_open(struct job *job, struct volume_input *v)
{
    size_t at;
    const bool is_image = is_half(v->keys.path, "img", &at);
    v->other = is_image ? open_other(job, v->keys.path, at, "hdr") : NULL;
    if (!v->other) {
        return;
    }
    const struct format *format = format_find(&v->other->head, ROLE_VOLUME);
    if (!format) {
        source_refuse(job, v->other, v->needed);
    } else if (format->id == FORMAT_NIFTI) {
        parse_header(job, &v->header, &v->other->head);
    }
    v->run.skip = v->header.offset;
    if (!v->header.pair) {
        job_bad(job, "magic: found that of a single file, a .hdr beside an .img needs \"ni\"");
    }
}

const struct volume_reader nifti_reader = {.is_partial = true, .open = nifti_open, .around = nifti_around};
const struct volume_reader nifti_image_reader = {.open = image_open, .around = nifti_around};
