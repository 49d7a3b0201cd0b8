/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the functions of libraries that are loaded when they are needed. */
#include "base/library.h"

#include "base/system/system.h"

#include <string.h>

/* Fills the table from its end on: the first function says that all are there. */
static bool find_functions(void *table, const char *names, const char *file, size_t number)
{
    if (!*names) {
        return true;
    }
    void *function = system_function(file, names);
    if (!function || !find_functions(table, names + strlen(names) + 1, file, number + 1)) {
        return false;
    }
    __atomic_store_n((void **)table + number, function, __ATOMIC_RELEASE);
    return true;
}

conus_status library_load(void *table, const char *names, const char *file, const char *package)
{
    /* Without a lock, which a process that is forked meanwhile would wait for: threads that load it at once write the
     * same functions. */
    void *first = __atomic_load_n((void **)table, __ATOMIC_ACQUIRE);
    if (!first && find_functions(table, names, file, 0)) {
        first = __atomic_load_n((void **)table, __ATOMIC_ACQUIRE);
    }
    return first ? CONUS_OK : fail(CONUS_ERROR_UNSUPPORTED, "%s cannot be loaded (Debian: %s)", file, package);
}
