/* SPDX-License-Identifier: BSD-3-Clause */
/* The message of the last failure, one per thread. */
#include "base/status.h"

#include "base/text.h"
#include "conus/version.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#undef fail
#undef fail_in

enum { MESSAGE_SIZE = 1024 };

static _Thread_local char message[MESSAGE_SIZE];

conus_status fail(conus_status status, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    text_make_plain(message, ""); /* file names and label texts are in it: it stays one line */
    return status;
}

conus_status fail_in(conus_status status, const char *where)
{
    char inner[MESSAGE_SIZE];
    memcpy(inner, message, sizeof inner);
    return fail(status, "%s: %s", where, inner);
}

const char *conus_message(void)
{
    return message;
}

const char *conus_status_name(conus_status status)
{
    static const char *const names[] = {
        [CONUS_OK] = "CONUS_OK",
        [CONUS_ERROR_ARGUMENT] = "CONUS_ERROR_ARGUMENT",
        [CONUS_ERROR_MEMORY] = "CONUS_ERROR_MEMORY",
        [CONUS_ERROR_IO] = "CONUS_ERROR_IO",
        [CONUS_ERROR_DATA] = "CONUS_ERROR_DATA",
        [CONUS_ERROR_UNSUPPORTED] = "CONUS_ERROR_UNSUPPORTED",
        [CONUS_ERROR_GL] = "CONUS_ERROR_GL",
        [CONUS_ERROR_CANCELLED] = "CONUS_ERROR_CANCELLED",
    };
    return (unsigned)status < sizeof names / sizeof names[0] ? names[status] : "CONUS_ERROR_UNKNOWN";
}

const char *conus_version(void)
{
    return CONUS_VERSION;
}
