/* SPDX-License-Identifier: BSD-3-Clause */
/** @file The digits of base64 and base16 (RFC 4648, sections 4 and 8). */
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

/** The value of the hexadecimal digit @p c, 0 to 15; -1 of any other character. */
static inline int base16_value(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

#endif
