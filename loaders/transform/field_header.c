/* SPDX-License-Identifier: BSD-3-Clause */
/* Whose deformation field it is, by its header. docs/spaces.md has the sources. */
#include "loaders/transform/field_header.h"

#include "base/byte_order.h"
#include "loaders/volumes/nifti.h"

#include <string.h>

enum { NIFTI1_SIZE = 348, NAME_SIZE = 16 };

/* nifti1.h: a vector at each voxel. */
enum { INTENT_DISPLACEMENT = 1006, INTENT_VECTOR = 1007 };

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
    memcpy(out->intent_name, data + (first ? 328 : 508), NAME_SIZE);
    return CONUS_OK;
}

static conus_status refuse_coefficients(const struct field_header *header)
{
    int code = header->intent_code;
    if (code == CUBIC_SPLINES || code == COSINES || code == QUADRATIC_SPLINES) {
        return fail(CONUS_ERROR_UNSUPPORTED,
                    "intent_code: found %d, coefficients of fnirt; 'convertwarp --ref=IMAGE --warp1=FILE --out=FIELD' "
                    "makes a field of them, 'invwarp --ref=IMAGE --warp=FILE --out=FIELD' that of the other direction",
                    code);
    }
    return code == TOPUP_CUBIC || code == TOPUP_QUADRATIC || code == TOPUP_FIELD
               ? fail(CONUS_ERROR_UNSUPPORTED,
                      "intent_code: found %d, topup's, which moves no points between two images", code)
               : CONUS_OK;
}

/* X x Y x Z x 1 x 3, or X x Y x Z x 3 of FSL. */
static conus_status check_shape(const struct field_header *header, bool has_images)
{
    const int64_t *dim = header->dim;
    bool five = dim[0] == 5 && dim[4] == 1 && dim[5] == 3;
    bool four = dim[0] == 4 && dim[4] == 3;
    if (!five && !four) {
        return fail(CONUS_ERROR_DATA,
                    "dim: found %lld: %lld x %lld x %lld x %lld x %lld: this is a volume, but no deformation field, "
                    "which has 5 dimensions (X x Y x Z x 1 x 3), or 4 (X x Y x Z x 3) from FSL",
                    (long long)dim[0], (long long)dim[1], (long long)dim[2], (long long)dim[3],
                    (long long)(dim[0] > 3 ? dim[4] : 1), (long long)(dim[0] > 4 ? dim[5] : 1));
    }
    for (int i = 1; i < 4; i++) {
        if (dim[i] < 2) {
            return fail(CONUS_ERROR_DATA, "dim[%d]: found %lld, a field has 2 or more", i, (long long)dim[i]);
        }
    }
    if (four && !has_images) {
        return fail(CONUS_ERROR_ARGUMENT,
                    "dim: found 4, a field of FSL's kind, whose numbers mean nothing without its two images: "
                    "from=IMAGE and to=IMAGE are needed (fields of ITK and SPM have 5 dimensions)");
    }
    return five && has_images ? fail(CONUS_ERROR_ARGUMENT,
                                     "dim: found 5, but from and to are of FSL's fields, which have 4 (X x Y x Z x 3)")
                              : CONUS_OK;
}

/* Of five dimensions. */
static conus_status vectors_kind(enum field_kind *out, const struct field_header *header, conus_vectors vectors)
{
    bool mapping = strcmp(header->intent_name, "Mapping") == 0; /* as SPM calls it */
    int code = header->intent_code;
    if (strcmp(header->intent_name, "NREG_TRANS") == 0 && vectors != CONUS_VECTORS_ABSOLUTE) {
        return fail(CONUS_ERROR_UNSUPPORTED, "intent_name: found \"NREG_TRANS\", NiftyReg's; the positions that "
                                             "'reg_transform -def' writes are read, with ',absolute'");
    }
    if (code != INTENT_VECTOR && code != INTENT_DISPLACEMENT && !vectors) {
        return fail(CONUS_ERROR_DATA,
                    "intent_code: found %d, fields have 1007 (vector) or 1006; ',relative' states displacements in "
                    "LPS, as ITK has them, ',absolute' positions in RAS, as SPM has them",
                    code);
    }
    if (mapping && vectors == CONUS_VECTORS_RELATIVE) {
        return fail(CONUS_ERROR_ARGUMENT, "intent_name: found \"Mapping\", SPM's word for positions: not relative");
    }
    *out = vectors == CONUS_VECTORS_RELATIVE              ? FIELD_ITK
           : vectors == CONUS_VECTORS_ABSOLUTE || mapping ? FIELD_SPM
                                                          : FIELD_VECTORS;
    return CONUS_OK;
}

const char *field_header_words(bool *usable, const struct field_header *header)
{
    const int64_t *dim = header->dim;
    const int code = header->intent_code;
    bool vectors = dim[0] == 5 && dim[4] == 1 && dim[5] == 3;
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
                               conus_vectors vectors)
{
    enum field_kind kind = header->intent_code == FNIRT_FIELD && !vectors ? FIELD_FNIRT : FIELD_FSL;
    conus_status status = refuse_coefficients(header);
    status = status ? status : check_shape(header, has_images);
    status = status || has_images ? status : vectors_kind(&kind, header, vectors);
    if (!status) {
        *out = kind;
    }
    return status;
}
