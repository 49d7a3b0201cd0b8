/* SPDX-License-Identifier: BSD-3-Clause */
/* Tells apart the formats that need more than a few fixed bytes. */
#include "sources/source.h"

#include "base/byte_order.h"
#include "base/text.h"

#include <string.h>

bool nifti_is(const uint8_t *data, size_t size)
{
    if (size < 4) {
        return false;
    }
    uint32_t size_field = order_u32(data, false);
    uint32_t swapped = order_u32(data, true);
    return size_field == NIFTI1_SIZE || size_field == NIFTI2_SIZE || swapped == NIFTI1_SIZE || swapped == NIFTI2_SIZE;
}

bool nifti_is_version_1(const uint8_t *data)
{
    return order_u32(data, false) == NIFTI1_SIZE || order_u32(data, true) == NIFTI1_SIZE;
}

bool nifti_magic_is(const uint8_t *data, size_t size, const char *name)
{
    static const uint8_t ending[4] = {'\r', '\n', 0x1a, '\n'};
    if (nifti_is_version_1(data)) {
        return size >= NIFTI1_SIZE && memcmp(data + 344, name, 2) == 0 && data[346] == '1' && data[347] == 0;
    }
    return size >= 12 && memcmp(data + 4, name, 2) == 0 && data[6] == '2' && data[7] == 0 &&
           memcmp(data + 8, ending, sizeof ending) == 0;
}

bool nifti_has_magic(const uint8_t *data, size_t size)
{
    return nifti_is(data, size) && (nifti_magic_is(data, size, "n+") || nifti_magic_is(data, size, "ni"));
}

enum { CIFTI_LOOK = 1 << 16 }; /* where the XML says of what its columns are */

int nifti_matrix_intent(const uint8_t *data, size_t size)
{
    if (size < NIFTI2_SIZE || !nifti_has_magic(data, size) || nifti_is_version_1(data)) {
        return 0;
    }
    static const struct {
        const char *columns;
        int code;
    } kinds[] = {{"\"CIFTI_INDEX_TYPE_LABELS\"", NIFTI_DENSE_LABELS},
                 {"\"CIFTI_INDEX_TYPE_SCALARS\"", 3006},
                 {"\"CIFTI_INDEX_TYPE_SERIES\"", 3002}};
    const size_t extension = NIFTI2_SIZE + 4;
    bool swapped = order_u32(data, false) != NIFTI2_SIZE;
    int intent_code = order_i32(data + 504, swapped);
    intent_code = intent_code >= 3000 && intent_code < 3100 ? intent_code : 0;
    if (size < extension + 8 || order_i32(data + extension + 4, swapped) != NIFTI_CIFTI_XML) {
        return intent_code;
    }
    const struct text xml = {(const char *)data + extension, (size < CIFTI_LOOK ? size : CIFTI_LOOK) - extension};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0] && !text_mentions(xml, "\"CIFTI_INDEX_TYPE_PARCELS\""); i++) {
        if (text_mentions(xml, kinds[i].columns)) {
            return kinds[i].code;
        }
    }
    return intent_code;
}

static int mgh_int(const uint8_t *data, size_t offset)
{
    return order_i32(data + offset, BIG_ENDIAN_IS_SWAPPED);
}

bool mgh_is(const uint8_t *data, size_t size)
{
    return size >= 8 && mgh_int(data, 0) == 1 && data[4] == 0;
}

bool mgh_is_of_vertices(const uint8_t *data, size_t size)
{
    enum { LEAST = 642 }; /* of FreeSurfer's coarsest sphere; a volume is no such row */
    return size >= MGH_HEADER_SIZE && mgh_is(data, size) && mgh_int(data, 4) >= LEAST && mgh_int(data, 8) == 1 &&
           mgh_int(data, 12) == 1;
}

bool nrrd_is(const uint8_t *data, size_t size)
{
    return size >= 8 && text_starts((struct text){(const char *)data, size}, "NRRD00");
}

/* Lines "key = value": the first one that is no comment says what it is, or how many axes it has. */
bool metaimage_is(const uint8_t *data, size_t size)
{
    enum { HEAD = 540 };
    struct text rest = {(const char *)data, size < HEAD ? size : HEAD};
    while (rest.size) {
        const char *end = memchr(rest.data, '\n', rest.size);
        size_t length = end ? (size_t)(end - rest.data) : rest.size;
        const char *equals = memchr(rest.data, '=', length);
        struct text key = text_trim((struct text){rest.data, equals ? (size_t)(equals - rest.data) : 0});
        if (text_equal(key, "ObjectType") || text_equal(key, "NDims")) {
            return true;
        }
        if (!text_equal(key, "Comment") && !text_equal(key, "ObjectSubType")) {
            return false;
        }
        length += end != NULL;
        rest = (struct text){rest.data + length, rest.size - length};
    }
    return false;
}

bool afni_is(const uint8_t *data, size_t size)
{
    struct text rest = text_trim((struct text){(const char *)data, size});
    struct text word;
    return text_word(&rest, &word) && text_equal(word, "type") && text_starts(text_trim(rest), "=");
}

bool tiff_is(const uint8_t *data, size_t size)
{
    static const char *const magics[] = {"II*\0", "MM\0*", "II+\0", "MM\0+"};
    for (size_t i = 0; size >= 4 && i < sizeof magics / sizeof magics[0]; i++) {
        if (memcmp(data, magics[i], 4) == 0) {
            return true;
        }
    }
    return false;
}

bool tck_is(const uint8_t *data, size_t size)
{
    static const char magic[] = "mrtrix tracks";
    return text_starts((struct text){(const char *)data, size}, magic) &&
           (size == sizeof magic - 1 || memchr(" \t\r\n", data[sizeof magic - 1], 4));
}

bool tt_is(const uint8_t *data, size_t size)
{
    enum { HEADER_SIZE = 20 };
    static const char first[] = "dimension";
    const bool is_swapped = !BIG_ENDIAN_IS_SWAPPED; /* it writes little-endian */
    return size >= HEADER_SIZE + sizeof first && order_u32(data, is_swapped) <= 50 &&
           order_u32(data + 16, is_swapped) == sizeof first && memcmp(data + HEADER_SIZE, first, sizeof first) == 0;
}

bool freesurfer_is_surface(const uint8_t *data, size_t size)
{
    return size >= 3 && data[0] == 0xff && data[1] == 0xff && data[2] >= 0xfd;
}

bool freesurfer_is_curvature(const uint8_t *data, size_t size)
{
    enum { PER_VERTEX = 11 }; /* behind the numbers of vertices and triangles; it is always 1 */
    static const uint8_t one[4] = {0, 0, 0, 1};
    return size >= PER_VERTEX + sizeof one && freesurfer_is_surface(data, size) && data[2] == 0xff &&
           memcmp(data + PER_VERTEX, one, sizeof one) == 0;
}

bool transform_line(struct text *rest, struct text *line)
{
    while (text_line(rest, line)) {
        *line = text_trim(*line);
        if (line->size && line->data[0] != '#') {
            return true;
        }
    }
    return false;
}

bool matrix_is(const uint8_t *data, size_t size)
{
    struct text text = text_from_bytes(data, size);
    struct text line;
    struct text word;
    double number;
    return transform_line(&text, &line) && text_word(&line, &word) && text_to_double(word, &number);
}

bool itk_is(const uint8_t *data, size_t size)
{
    return text_starts(text_from_bytes(data, size), "#Insight Transform File V1.0");
}

bool xfm_is(const uint8_t *data, size_t size)
{
    return text_starts(text_from_bytes(data, size), "MNI Transform File");
}

bool lta_is(const uint8_t *data, size_t size)
{
    struct text text = text_from_bytes(data, size);
    struct text line;
    return transform_line(&text, &line) && text_starts(line, "type") && text_mentions(line, "=");
}

bool register_take_head(struct text *rest, double edges[2])
{
    struct text line;
    double numbers[3] = {0};
    bool is_head = text_line(rest, &line) && text_trim(line).size && !text_to_double(text_trim(line), &numbers[0]);
    for (int i = 0; is_head && i < 3; i++) {
        is_head = text_line(rest, &line) && text_to_double(text_trim(line), &numbers[i]);
    }
    memcpy(edges, numbers, 2 * sizeof *edges);
    return is_head && matrix_is((const uint8_t *)rest->data, rest->size);
}

bool register_is(const uint8_t *data, size_t size)
{
    struct text text = text_from_bytes(data, size);
    double edges[2];
    return register_take_head(&text, edges);
}

/* Thousands 1 = big-endian; tens 0 = double, 1 = float; both ends 0. */
bool itk_matlab_type(bool *swapped, bool *single, const uint8_t *data)
{
    uint32_t little = order_u32(data, BIG_ENDIAN_IS_SWAPPED ? false : true);
    uint32_t big = order_u32(data, BIG_ENDIAN_IS_SWAPPED);
    bool is_big = big == 1000 || big == 1010;
    uint32_t type = is_big ? big - 1000 : little;
    *swapped = is_big == BIG_ENDIAN_IS_SWAPPED;
    *single = type == 10;
    return type == 0 || type == 10;
}

bool itk_matlab_is(const uint8_t *data, size_t size)
{
    bool swapped;
    bool single;
    if (size < ITK_MATLAB_HEAD + 1 || !itk_matlab_type(&swapped, &single, data)) {
        return false;
    }
    uint32_t length = order_u32(data + 16, swapped);
    return length && length <= ITK_MATLAB_NAME_LIMIT && data[ITK_MATLAB_HEAD] >= 'A' && data[ITK_MATLAB_HEAD] <= 'Z';
}
