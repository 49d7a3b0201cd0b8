/* SPDX-License-Identifier: BSD-3-Clause */
/* Takes numbers off a file in VTK's legacy format. */
#include "loaders/surfaces/foreign/vtk_stream.h"

#include "base/byte_order.h"

/* vtkIdType is written as int. */
static const struct vtk_type types[] = {
    {"float", 32, VTK_REAL},
    {"double", 64, VTK_REAL},
    {"bit", 1, VTK_UNSIGNED},
    {"char", 8, VTK_INTEGER},
    {"signed_char", 8, VTK_INTEGER},
    {"unsigned_char", 8, VTK_UNSIGNED},
    {"short", 16, VTK_INTEGER},
    {"unsigned_short", 16, VTK_UNSIGNED},
    {"int", 32, VTK_INTEGER},
    {"unsigned_int", 32, VTK_UNSIGNED},
    {"long", 64, VTK_INTEGER},
    {"unsigned_long", 64, VTK_UNSIGNED},
    {"vtkidtype", 32, VTK_INTEGER},
    {"vtktypeint64", 64, VTK_INTEGER},
    {"vtktypeuint64", 64, VTK_UNSIGNED},
};

conus_status vtk_need_type(const struct vtk_type **out, struct vtk *vtk)
{
    struct text word;
    bool there = words_next(&vtk->words, &word);
    for (size_t i = 0; there && i < sizeof types / sizeof types[0]; i++) {
        if (text_equal_ignoring_case(word, types[i].name)) {
            *out = &types[i];
            return CONUS_OK;
        }
    }
    return words_fail(&vtk->words, word, "a type of numbers");
}

conus_status vtk_end_line(struct vtk *vtk)
{
    struct text line = {0};
    if (vtk->is_text) {
        return CONUS_OK;
    }
    (void)words_line(&vtk->words, &line);
    if (text_trim(line).size) {
        vtk->words.line--;
        return words_fail(&vtk->words, text_trim(line), "the end of the line");
    }
    return CONUS_OK;
}

static int64_t whole_at(const uint8_t *data, const struct vtk_type *type)
{
    const bool swapped = BIG_ENDIAN_IS_SWAPPED;
    bool is_signed = type->kind == VTK_INTEGER;
    switch (type->bits) {
    case 8:
        return is_signed ? (int8_t)*data : *data;
    case 16:
        return is_signed ? order_i16(data, swapped) : order_u16(data, swapped);
    case 32:
        return is_signed ? (int64_t)order_i32(data, swapped) : (int64_t)order_u32(data, swapped);
    default:
        return order_i64(data, swapped);
    }
}

conus_status vtk_fail_cut_off(const char *what)
{
    return fail(CONUS_ERROR_DATA, "%s: the file is cut off", what);
}

conus_status vtk_next_whole(int64_t *out, struct vtk *vtk, const struct vtk_type *type, const char *what)
{
    if (vtk->is_text) {
        return words_whole(out, &vtk->words, INT64_MIN, what);
    }
    const uint8_t *data = words_bytes(&vtk->words, type->bits / 8);
    *out = data ? whole_at(data, type) : 0;
    return data ? CONUS_OK : vtk_fail_cut_off(what);
}

conus_status vtk_next_number(float *out, struct vtk *vtk, const struct vtk_type *type, const char *what)
{
    if (vtk->is_text) {
        return vtk->place == VTK_OF_NOTHING ? words_float(out, &vtk->words, "a coordinate")
                                            : words_any_float(out, &vtk->words, "a number");
    }
    const uint8_t *data = words_bytes(&vtk->words, type->bits / 8);
    if (!data) {
        return vtk_fail_cut_off(what);
    }
    *out = type->kind != VTK_REAL ? (float)whole_at(data, type)
           : type->bits == 32     ? order_f32(data, BIG_ENDIAN_IS_SWAPPED)
                                  : (float)order_f64(data, BIG_ENDIAN_IS_SWAPPED);
    return CONUS_OK;
}
