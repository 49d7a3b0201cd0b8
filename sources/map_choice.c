/* SPDX-License-Identifier: BSD-3-Clause */
/* Chooses one of the maps of a file by number or name. */
#include "sources/source.h"

#include "base/memory.h"

enum { SHOWN = 8, WIDTH = 60 };

/* "0 "aparc", 1 "yeo"", of the first maps. */
static void list_maps(struct buffer *out, const char *const *names, size_t count)
{
    for (size_t i = 0; i < count && i < SHOWN; i++) {
        buffer_format(out, "%s%zu \"%.*s\"", i ? ", " : "", i, WIDTH, names[i] ? names[i] : "");
    }
    buffer_text(out, count > SHOWN ? ", ..." : "");
}

static conus_status find_named(size_t *out, const char *const *names, size_t count, struct text wanted,
                               const char *kind)
{
    struct buffer maps = {0};
    size_t map = 0;
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        if (names[i] && text_equal(wanted, names[i])) {
            map = i;
            found++;
        }
    }
    if (found == 1) {
        *out = map;
        return CONUS_OK;
    }
    list_maps(&maps, names, count);
    conus_status status = buffer_status(&maps);
    status = status ? status
                    : fail(CONUS_ERROR_ARGUMENT, "map: %zu %s are called \"%.*s\", one is needed of %s", found, kind,
                           wanted.size < WIDTH ? (int)wanted.size : WIDTH, wanted.data, count ? maps.data : "none");
    buffer_finish(&maps);
    return status;
}

conus_status map_choice_make(size_t *out, const char *const *names, size_t count, struct text wanted, const char *kind,
                             struct notes *notes)
{
    uint64_t number = 0;
    if (wanted.size && !text_to_uint(wanted, SIZE_MAX, &number)) {
        return find_named(out, names, count, wanted, kind);
    }
    *out = (size_t)number;
    if (wanted.size || count < 2) {
        return CONUS_OK;
    }
    struct buffer maps = {0};
    list_maps(&maps, names, count);
    conus_status status = buffer_status(&maps);
    status = status ? status
                    : notes_add(notes,
                                "%zu %s: number 0 (from 0) was used, \"%.*s\"; add \",map=K\" or \",map=NAME\" to "
                                "the file of labels for another of %s",
                                count, kind, WIDTH, names[0] ? names[0] : "", maps.data);
    buffer_finish(&maps);
    return status;
}
