/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks the catalogue for what is no path. */
#include "settings/atlas_name.h"

#include "options/messages.h"

int atlas_name_find(struct atlas_name *out, const char *text)
{
    *out = (struct atlas_name){.path = text};
    if (conus_atlas_is_path(text)) {
        return EXIT_DONE;
    }
    conus_status status = conus_catalogue_create(&out->catalogue, NULL);
    status = status ? status : conus_catalogue_find(&out->atlas, out->catalogue, text);
    if (status) {
        return print_status(status);
    }
    out->path = out->atlas->path;
    return EXIT_DONE;
}

void atlas_name_finish(struct atlas_name *name)
{
    conus_catalogue_destroy(name->catalogue);
    *name = (struct atlas_name){0};
}

const char *atlas_name_labels(const struct atlas_name *name, const char *given)
{
    return given || !name->atlas ? given : name->atlas->labels;
}
