/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The digits of base64 (RFC 4648, section 4). */
#ifndef CONUS_BASE_FORMATS_BASE64_H
#define CONUS_BASE_FORMATS_BASE64_H

/** The value of the digit @p c, 0 to 63; -1 of any other character, '=' too. */
static inline int base64_value(char c)
{
    return c >= 'A' && c <= 'Z'   ? c - 'A'
           : c >= 'a' && c <= 'z' ? c - 'a' + 26
           : c >= '0' && c <= '9' ? c - '0' + 52
           : c == '+'             ? 62
           : c == '/'             ? 63
                                  : -1;
}

#endif
