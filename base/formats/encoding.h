/* SPDX-License-Identifier: BSD-3-Clause */
/** @file In which encoding a text is that should be UTF-8. */
#ifndef CONUS_BASE_FORMATS_ENCODING_H
#define CONUS_BASE_FORMATS_ENCODING_H

#include "base/notes.h"
#include "base/text.h"

/** Makes @p text UTF-8, which stays as it is. Else all of it is taken as Windows-1252, whose letters ISO-8859-1's are;
 * where it has letters in UTF-8, too, only the bytes that are none of them are. A note says so; NULL: nobody is told.
 * XML that declares one of the two is taken by its word, and declares UTF-8 then; a warning says where all of it is
 * UTF-8. *owned, for memory_free(), is what @p text lies in then, else NULL. CONUS_ERROR_DATA at a byte that
 * Windows-1252 has no letter for. UTF-16 with a byte order mark stays. */
conus_status encoding_decode(char **owned, struct text *text, struct notes *notes);

#endif
