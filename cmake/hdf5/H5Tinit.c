/* SPDX-License-Identifier: BSD-3-Clause */
/* What libhdf5's program H5detect would find out: the types of numbers of the processors that scripts/libraries builds
 * for. They have their least byte first, and lie at multiples of their size. */
#include "H5Tmodule.h"

#include "H5private.h"

#include "H5Iprivate.h"
#include "H5Tpkg.h"

/* A row: where libhdf5 keeps the type and its alignment, its size, its sign, and of a float the digits in base 2. */
#define NUMBER(name, type, digits)                                                                                     \
    {                                                                                                                  \
        &H5T_NATIVE_##name##_g, &H5T_NATIVE_##name##_ALIGN_g, sizeof(type), (type)-1 < (type)1, digits                 \
    }
#define PAIR(name, type) NUMBER(name, type, 0), NUMBER(U##name, u##type, 0)
#define PAIRS(bits)                                                                                                    \
    PAIR(INT##bits, int##bits##_t), PAIR(INT_LEAST##bits, int_least##bits##_t), PAIR(INT_FAST##bits, int_fast##bits##_t)

enum { DIGITS_X87 = 64 }; /* of 80 bits in 16 bytes, the only float whose first digit is stored */

static void describe_float(H5T_atomic_t *out, size_t digits)
{
    bool has_all = digits == DIGITS_X87;
    size_t stored = has_all ? digits : digits - 1;
    out->prec = has_all ? 80 : out->prec;
    out->u.f.sign = out->prec - 1;
    out->u.f.mpos = 0;
    out->u.f.msize = stored;
    out->u.f.epos = stored;
    out->u.f.esize = out->prec - 1 - stored;
    out->u.f.ebias = (UINT64_C(1) << (out->u.f.esize - 1)) - 1;
    out->u.f.norm = has_all ? H5T_NORM_NONE : H5T_NORM_IMPLIED;
    out->u.f.pad = H5T_PAD_ZERO;
}

herr_t H5T__init_native(void)
{
    const struct {
        hid_t *type;
        size_t *align;
        size_t size;
        bool is_signed;
        size_t digits;
    } numbers[] = {
        NUMBER(SCHAR, signed char, 0),
        NUMBER(UCHAR, unsigned char, 0),
        NUMBER(SHORT, short, 0),
        NUMBER(USHORT, unsigned short, 0),
        NUMBER(INT, int, 0),
        NUMBER(UINT, unsigned, 0),
        NUMBER(LONG, long, 0),
        NUMBER(ULONG, unsigned long, 0),
        NUMBER(LLONG, long long, 0),
        NUMBER(ULLONG, unsigned long long, 0),
        PAIRS(8),
        PAIRS(16),
        PAIRS(32),
        PAIRS(64),
        NUMBER(FLOAT, float, FLT_MANT_DIG),
        NUMBER(DOUBLE, double, DBL_MANT_DIG),
        NUMBER(LDOUBLE, long double, LDBL_MANT_DIG),
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        H5T_t *type = H5T__alloc();
        if (!type) {
            return FAIL;
        }
        type->shared->state = H5T_STATE_IMMUTABLE;
        type->shared->type = numbers[i].digits ? H5T_FLOAT : H5T_INTEGER;
        type->shared->size = numbers[i].size;
        H5T_atomic_t *atomic = &type->shared->u.atomic;
        atomic->order = H5T_ORDER_LE;
        atomic->prec = 8 * numbers[i].size;
        atomic->offset = 0;
        atomic->lsb_pad = atomic->msb_pad = H5T_PAD_ZERO;
        if (numbers[i].digits) {
            describe_float(atomic, numbers[i].digits);
        } else {
            atomic->u.i.sign = numbers[i].is_signed ? H5T_SGN_2 : H5T_SGN_NONE;
        }
        *numbers[i].type = H5I_register(H5I_DATATYPE, type, false);
        if (*numbers[i].type < 0) {
            return FAIL;
        }
        *numbers[i].align = numbers[i].size;
    }
    H5T_native_order_g = H5T_ORDER_LE;
    H5T_NATIVE_SCHAR_COMP_ALIGN_g = sizeof(char);
    H5T_NATIVE_SHORT_COMP_ALIGN_g = sizeof(short);
    H5T_NATIVE_INT_COMP_ALIGN_g = sizeof(int);
    H5T_NATIVE_LONG_COMP_ALIGN_g = sizeof(long);
    H5T_NATIVE_LLONG_COMP_ALIGN_g = sizeof(long long);
    H5T_NATIVE_FLOAT_COMP_ALIGN_g = sizeof(float);
    H5T_NATIVE_DOUBLE_COMP_ALIGN_g = sizeof(double);
    H5T_NATIVE_LDOUBLE_COMP_ALIGN_g = sizeof(long double);
    H5T_POINTER_COMP_ALIGN_g = sizeof(void *);
    H5T_HVL_COMP_ALIGN_g = sizeof(void *);
    H5T_HOBJREF_COMP_ALIGN_g = sizeof(hobj_ref_t);
    H5T_HDSETREGREF_COMP_ALIGN_g = 1;
    return SUCCEED;
}
