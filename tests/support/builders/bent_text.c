/* SPDX-License-Identifier: BSD-3-Clause */
/* Text files with one changed place. */
#include "builders/bent_text.h"

#include "conus/status.h"
#include "test.h"

#include <string.h>

void append_bent(struct buffer *out, const char *text, const char *from, const char *to)
{
    const char *at = from ? strstr(text, from) : NULL;
    if (!from) {
        buffer_text(out, text);
        return;
    }
    assert_non_null(at);
    buffer_append(out, text, (size_t)(at - text));
    buffer_text(out, to);
    buffer_text(out, at + strlen(from));
}

void assert_said(const char *part)
{
    if (!strstr(conus_message(), part) || strchr(conus_message(), '\n')) {
        fail_msg("\"%s\" does not say \"%s\"", conus_message(), part);
    }
}
