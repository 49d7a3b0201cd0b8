/* SPDX-License-Identifier: BSD-3-Clause */
/** @file Encodings: of text that should be UTF-8, and of bytes as text. */
#ifndef CONUS_BASE_FORMATS_ENCODING_H
#define CONUS_BASE_FORMATS_ENCODING_H

#include "base/status.h"
#include "base/text.h"

/* In which encoding a text is that should be UTF-8. */

/** Makes @p text UTF-8, which stays as it is. Else all of it is taken as Windows-1252, whose letters ISO-8859-1's are;
 * where it has letters in UTF-8, too, only the bytes that are none of them are. A note says so; NULL: none.
 * XML that declares one of the two is taken by its word, and declares UTF-8 then; a warning says where all of it is
 * UTF-8. *owned, for memory_free(), is what @p text lies in then, else NULL. CONUS_ERROR_DATA at a byte that
 * Windows-1252 has no letter for. UTF-16 with a byte order mark stays. */
conus_status encoding_decode(char **owned, struct text *text, struct notes *notes);

/* The digits of base64 and base16 (RFC 4648, sections 4 and 8). */

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
